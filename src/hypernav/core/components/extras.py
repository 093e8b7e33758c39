"""Optional packages."""

import importlib
from types import ModuleType

from hypernav.core.errors import MissingExtraError


def require(module: str, *, extra: str) -> ModuleType:
    """Import an optional module; if it is missing, raise an error that says how to install it.

    Args:
        module: Import name, for example ``"onnxruntime"``.
        extra: The extra of this package that brings it.

    Raises:
        MissingExtraError: The module is not installed.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        raise MissingExtraError(
            f"this needs the package '{module}', which is not installed; "
            f"try: pip install 'hypernav[{extra}]'"
        ) from error
