"""Makes the torchvision of the package index usable with the CPU build of torch.

Its compiled parts are linked to CUDA and cannot be loaded, but the image processors of transformers
use only its Python parts. What these miss at import are two operators' names; what they miss at run
time is the decoder of image files, for which Pillow stands in.
"""

import io
from typing import Any

import numpy as np
from PIL import Image

_SCHEMA = "(Tensor dets, Tensor scores, float iou_threshold) -> Tensor"


def prepare() -> None:
    """Declare the operators and replace the decoder, unless torchvision works as it is."""
    import torch

    if hasattr(torch.ops.torchvision, "nms"):
        return
    for name in ("nms", "qnms"):
        torch.library.define(f"torchvision::{name}", _SCHEMA)
    import torchvision

    if not torchvision.extension._has_ops():
        torchvision.io.decode_image = _decode_image


def _decode_image(data: Any, mode: Any = None, apply_exif_orientation: bool = False) -> Any:
    import torch

    file = data if isinstance(data, str) else io.BytesIO(data.numpy().tobytes())
    pixels = np.array(Image.open(file).convert("RGB"))
    return torch.from_numpy(pixels).permute(2, 0, 1)
