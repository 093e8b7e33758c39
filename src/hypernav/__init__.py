"""Zero-shot object-goal navigation with hybrid perception: camera picture and top-down map."""

import importlib
import logging
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hypernav.evaluation.checks import check_agent, check_world

__all__ = ["check_agent", "check_world"]

logging.getLogger("hypernav").addHandler(logging.NullHandler())


def __getattr__(name: str) -> Any:
    """Load the checkers when they are asked for, so that `import hypernav` stays light."""
    if name in __all__:
        return getattr(importlib.import_module("hypernav.evaluation.checks"), name)
    raise AttributeError(f"module 'hypernav' has no attribute '{name}'")
