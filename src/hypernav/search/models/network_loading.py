"""Networks in this process: torch's device and dtype, loading of weights, ONNX sessions."""

from pathlib import Path
from typing import Any

from hypernav.core.components.registry import require
from hypernav.core.errors import ConfigError, MissingExtraError, ModelError
from hypernav.io.reading import check_file

EXTRA = "local-vlm"


def choose_device(wanted: str = "auto") -> Any:
    """A ``torch.device``: the named one, or the best available.

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
    count = torch.cuda.device_count() if torch.cuda.is_available() else 0
    if device.type == "cuda" and (device.index or 0) >= count:
        seen = f"only cuda:0 to cuda:{count - 1}" if count else "no GPU"
        raise ConfigError(f"device '{wanted}' was asked for, but torch sees {seen}; try auto")
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
        MissingExtraError: transformers is not installed, or lacks a package for this model.
    """
    transformers = require("transformers", extra=EXTRA)
    try:
        loader = getattr(transformers, auto_class, None)
        if loader is None:
            raise ModelError(
                f"transformers {transformers.__version__} has no {auto_class}; "
                f"try: pip install -U 'hypernav[{EXTRA}]'"
            )
        return loader.from_pretrained(path, local_files_only=True, **options)
    except ImportError as error:
        reason = " ".join(str(error).split())
        raise MissingExtraError(
            f"transformers cannot load '{path}' with the packages that are installed: {reason} "
            f"Try: pip install -U 'hypernav[{EXTRA}]'"
        ) from error
    except OSError as error:
        if Path(path).is_dir():
            raise ModelError(f"{path} does not hold a complete model: {error}") from error
        raise ModelError(
            f"no weights of '{path}' in the local cache; fetch them first: hf download {path}"
        ) from error
    except (ValueError, KeyError) as error:
        raise ModelError(f"'{path}' is not a model for {auto_class}: {error}") from error


def load_network(auto_class: str, path: str, device: Any, dtype: Any) -> Any:
    """A network on its device, ready to be asked.

    Args:
        auto_class: Name of the class, as for `load_pretrained`.
        path: A folder, or the id of a model in the local Hugging Face cache.
        device: Device, from `choose_device`.
        dtype: Format of the weights, from `choose_dtype`.

    Raises:
        ModelError: There are no such weights here, they are of another kind, or they do not fit
            into the device's memory.
        MissingExtraError: transformers is not installed, or lacks a package for this model.
    """
    torch = require("torch", extra=EXTRA)
    network = load_pretrained(auto_class, path, dtype=dtype)
    try:
        return network.to(device).eval()
    except torch.OutOfMemoryError as error:
        size = sum(weights.numel() * weights.element_size() for weights in network.parameters())
        raise ModelError(
            f"the weights of '{path}' take {size / 2**30:.1f} GiB, and {device} has no room for "
            "them; use a smaller model, a server, or fewer --workers: each loads its own"
        ) from error


def moved_to_device(inputs: Any, device: Any, dtype: Any) -> dict[str, Any]:
    """A processor's tensors on the device; images also in the model's dtype.

    Coordinates of boxes keep their dtype: between 512 and 1024, bfloat16 has only every fourth
    pixel.
    """
    return {
        key: value.to(device, dtype if key == "pixel_values" else value.dtype)
        for key, value in inputs.items()
    }


def open_session(path: Path, *, threads: int = 2) -> Any:
    """A deterministic ``onnxruntime.InferenceSession`` on the CPU.

    Args:
        path: An ``.onnx`` file.
        threads: Threads within one operator. A navigating robot needs its other cores for itself.

    Raises:
        MissingExtraError: onnxruntime is not installed.
        ModelError: The file is missing, or onnxruntime cannot read it.
    """
    onnxruntime = require("onnxruntime", extra="onnx")
    states = require("onnxruntime.capi.onnxruntime_pybind11_state", extra="onnx")
    try:
        check_file(path)
    except FileNotFoundError as error:
        raise ModelError(f"model file not found: {path}; give the path of an .onnx file") from error
    except OSError as error:
        raise ModelError(f"{path}: cannot be read ({error.strerror or error})") from error
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.inter_op_num_threads = 1
    options.use_deterministic_compute = True
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    options.log_severity_level = 3
    unreadable = (
        states.Fail,
        states.InvalidArgument,
        states.InvalidGraph,
        states.InvalidProtobuf,
        states.NoModel,
        states.NotImplemented,
        states.RuntimeException,
    )
    try:
        return onnxruntime.InferenceSession(
            str(path), sess_options=options, providers=["CPUExecutionProvider"]
        )
    except unreadable as error:
        raise ModelError(
            f"{path} is not an ONNX model that onnxruntime can run: {str(error).splitlines()[0]}"
        ) from error
