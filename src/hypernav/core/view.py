"""The contract of views of a search: page and video, rerun, Foxglove, a page in the browser.

The loop of a search gives the same to each of its views: every step when it is taken, and the
result. A view changes nothing, and agents and worlds do not know of views.
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
            observation: What the agent was given; None if it was not kept.

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
        """Close files and connections, however the search ended; then the files can be read."""
        ...


@runtime_checkable
class WatchedView(View, Protocol):
    """A view that others connect to while this program runs."""

    @property
    def address(self) -> str:
        """What to open, in words that can follow "open"."""
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
