"""Zero-shot object-goal navigation with hybrid perception: camera image and top-down map."""

import importlib
import logging
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hypernav.evaluation.checks.agents import check_agent
    from hypernav.evaluation.checks.worlds import check_world

__all__ = ["check_agent", "check_world"]

_MODULES = {
    "check_agent": "hypernav.evaluation.checks.agents",
    "check_world": "hypernav.evaluation.checks.worlds",
}

logging.getLogger("hypernav").addHandler(logging.NullHandler())


def __getattr__(name: str) -> Any:
    """Load a public name when it is asked for, so that ``import hypernav`` stays light."""
    if name in _MODULES:
        return getattr(importlib.import_module(_MODULES[name]), name)
    raise AttributeError(f"module 'hypernav' has no attribute '{name}'")
