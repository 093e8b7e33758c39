"""Vectors of goals, which ZSON's policy compares images with, read from safetensors."""

import numpy as np
from jaxtyping import Float32

from hypernav.core.components.extras import require
from hypernav.core.errors import ConfigError, ModelError
from hypernav.models.policies.network import EXTRA


def read_vectors(path: str, size: int) -> dict[str, Float32[np.ndarray, "n"]]:
    """Vectors of goals, by their names, each of length 1.

    Args:
        path: File of vectors, safetensors.
        size: Number of values of each vector.

    Raises:
        ConfigError: No file is named.
        MissingExtraError: safetensors is not installed.
        ModelError: The file can't be read, or holds something else.
    """
    if not path:
        raise ConfigError(
            "zson compares images with vectors of goals: name a file of them, safetensors with a "
            f"vector of {size} numbers (CLIP RN50, of the bare words) for each goal, "
            "--set policy.goals=FILE"
        )
    safetensors = require("safetensors", extra=EXTRA)
    reader = require("safetensors.numpy", extra=EXTRA)
    try:
        vectors = reader.load_file(path)
    except (OSError, safetensors.SafetensorError) as error:
        raise ModelError(f"{path} can't be read as safetensors: {error}") from error
    for name, vector in vectors.items():
        if vector.shape != (size,) or not np.linalg.norm(vector) > 0.0:
            raise ModelError(
                f"{path}: '{name}' has the shape {vector.shape}; expected a vector of "
                f"{size} numbers that are not all 0"
            )
    return {
        name: (vector / np.linalg.norm(vector)).astype(np.float32)
        for name, vector in vectors.items()
    }
