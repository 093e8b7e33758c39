"""Makes the torchvision of the package index usable with the CPU build of torch.

Its compiled parts are linked to CUDA and cannot be loaded, but the image processors of transformers
use only its Python parts. What these miss at import are two operators' names; what they miss at run
time is the decoder of image files, for which Pillow stands in.
"""

import io
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

_SCHEMA = "(Tensor dets, Tensor scores, float iou_threshold) -> Tensor"


@cache
def prepare() -> None:
    """Declare the operators and replace the decoder, unless torchvision works as it is."""
    import torch

    package = find_spec("torchvision")
    if package is None or _loads(torch, Path(str(package.origin)).with_name("_C.so")):
        return
    for name in ("nms", "qnms"):
        torch.library.define(f"torchvision::{name}", _SCHEMA)
    import torchvision

    torchvision.io.decode_image = _decode_image


def _loads(torch: Any, compiled: Path) -> bool:
    try:
        torch.ops.load_library(compiled)
    except OSError:
        return False
    return True


def _decode_image(data: Any, mode: Any = None, apply_exif_orientation: bool = False) -> Any:
    import torch

    file = data if isinstance(data, str) else io.BytesIO(data.numpy().tobytes())
    pixels = np.array(Image.open(file).convert("RGB"))
    return torch.from_numpy(pixels).permute(2, 0, 1)
