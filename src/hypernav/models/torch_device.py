"""Device and dtype of networks in this process, and loading of their weights."""

from pathlib import Path
from typing import Any

from hypernav.core.components.extras import require
from hypernav.core.errors import ConfigError, ModelError

EXTRA = "local-vlm"


def choose_device(wanted: str = "auto") -> Any:
    """A ``torch.device``: the named one, or the best that there is.

    Raises:
        ConfigError: There is no such device.
        MissingExtraError: torch is not installed.
    """
    torch = require("torch", extra=EXTRA)
    if wanted == "auto":
        if torch.cuda.is_available():
            return torch.device("cuda")
        return torch.device("mps" if torch.backends.mps.is_available() else "cpu")
    try:
        device = torch.device(wanted)
    except RuntimeError as error:
        raise ConfigError(f"'{wanted}' is not a device; try auto, cpu or cuda") from error
    if device.type == "cuda" and not torch.cuda.is_available():
        raise ConfigError(f"device '{wanted}' was asked for, but torch sees no GPU; try auto")
    return device


def choose_dtype(device: Any, wanted: str = "auto") -> Any:
    """A ``torch.dtype``: the named one, or the fastest that keeps quality on the device."""
    torch = require("torch", extra=EXTRA)
    if wanted != "auto":
        return getattr(torch, wanted)
    if device.type == "cuda":
        return torch.bfloat16 if torch.cuda.is_bf16_supported() else torch.float16
    return torch.float16 if device.type == "mps" else torch.float32


def load_pretrained(auto_class: str, path: str, **options: Any) -> Any:
    """Load through a transformers Auto class, from disk only: nothing is ever downloaded.

    Args:
        auto_class: Name of the class, for example ``"AutoModelForImageTextToText"``.
        path: A folder, or the id of a model in the local Hugging Face cache.
        **options: Keyword arguments of ``from_pretrained``.

    Raises:
        ModelError: There are no such weights here, or they are of another kind.
        MissingExtraError: transformers is not installed.
    """
    transformers = require("transformers", extra=EXTRA)
    loader = getattr(transformers, auto_class, None)
    if loader is None:
        raise ModelError(
            f"transformers {transformers.__version__} has no {auto_class}; "
            f"try: pip install -U 'hypernav[{EXTRA}]'"
        )
    try:
        return loader.from_pretrained(path, local_files_only=True, **options)
    except OSError as error:
        if Path(path).is_dir():
            raise ModelError(f"{path} does not hold a complete model: {error}") from error
        raise ModelError(
            f"no weights of '{path}' in the local cache; fetch them first: hf download {path}"
        ) from error
    except (ValueError, KeyError, ImportError) as error:
        raise ModelError(f"'{path}' is not a model for {auto_class}: {error}") from error


def moved_to_device(inputs: Any, device: Any, dtype: Any) -> dict[str, Any]:
    """A processor's tensors on the device; those with fractions also in the model's dtype."""
    return {
        key: value.to(device, dtype if value.is_floating_point() else value.dtype)
        for key, value in inputs.items()
    }
