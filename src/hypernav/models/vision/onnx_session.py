"""ONNX inference sessions, with clear errors for unusable files."""

from pathlib import Path
from typing import Any

from hypernav.core.components.extras import require
from hypernav.core.errors import ModelError
from hypernav.core.files.reading import check_file


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
