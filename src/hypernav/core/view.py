"""The contract of whatever shows a search: page and video, rerun, Foxglove, a page in the browser.

The loop of a search tells each of its views the same: every step as it was taken, and the result. A
view changes nothing; agents and worlds know of none.
"""

import math
from collections.abc import Mapping
from typing import Any, Protocol, runtime_checkable

from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.observation import Observation
from hypernav.core.trace import StepTrace


@runtime_checkable
class View(Protocol):
    """A file or a screen on which a search is shown."""

    def add(
        self, step: StepTrace, grid: OccupancyGrid | None, observation: Observation | None
    ) -> None:
        """Show a step.

        Args:
            step: Trace of the step.
            grid: The agent's map, which changes with the next step; None if it has none.
            observation: What the agent was given; None if nobody kept it.

        Raises:
            OutputError: It cannot be written; what was shown before is kept.
        """
        ...

    def finish(self, result: Mapping[str, Any]) -> None:
        """Show how the search ended.

        Args:
            result: Content of ``result.json``; lengths may be infinite, see `json_values`.

        Raises:
            OutputError: It cannot be written.
        """
        ...

    def close(self) -> None:
        """Let go of files and connections, however the search ended; files can be read then."""
        ...


@runtime_checkable
class WatchedView(View, Protocol):
    """A view that others connect to, and that is there as long as this program runs."""

    @property
    def address(self) -> str:
        """What to open, in words that follow on "open"."""
        ...

    def has_watcher(self) -> bool:
        """Whether anybody has connected yet."""
        ...


def json_values(result: Mapping[str, Any]) -> dict[str, Any]:
    """The content of ``result.json``, where an infinite length is null."""
    return {
        key: None if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in result.items()
    }
