"""Families of vision-language models: their box coordinates and image sizes.

Sources:

- Qwen2.5-VL: "we will output absolute coordinates based on the actual input size of the image …
  this is the size after processer" (its makers, github.com/QwenLM/Qwen3-VL/issues/676 and 866);
  the resizing is ``smart_resize`` in ``qwen-vl-utils/src/qwen_vl_utils/vision_process.py`` with
  patches of 14 pixels merged two by two, hence multiples of 28.
- Qwen2-VL and Qwen3-VL: relative, 0 to 1000 (github.com/QwenLM/Qwen3-VL/issues/866 and 1486).
- GLM-V: relative, 0 to 1000 (zai-org's glmv-grounding skill).
- Gemini: relative, 0 to 1000, rows first: ``box_2d: [ymin, xmin, ymax, xmax]``
  (ai.google.dev/gemini-api/docs/image-understanding).
"""

import math
import re
from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np
from jaxtyping import UInt8

from hypernav.core.chat import Image
from hypernav.core.errors import ConfigError, ModelError
from hypernav.core.geometry.boxes import Box

FamilyName = Literal[
    "qwen2.5-vl", "qwen2-vl", "qwen3-vl", "glm-v", "gemini", "pixels", "thousandths", "unit"
]

_LONGEST_RATIO = 200.0


@dataclass(frozen=True)
class VlmFamily:
    """Box coordinates and image size of a family of models.

    Attributes:
        name: Name in configuration and reports.
        space: Unit of its coordinates: "pixels" of the image as it was sent, "thousandths" of the
            image's sides, or "unit" (0 to 1).
        side_multiple: The image is sent with sides that are multiples of this, so that the
            server need not resize it and pixels mean the same on both sides; 0 sends it unchanged.
        min_pixels: Smallest area of the sent image.
        max_pixels: Largest area of the sent image.
        rows_first: Whether boxes are ``(y_min, x_min, y_max, x_max)``.
        box_key: Key of a box in its JSON.
    """

    name: FamilyName
    space: Literal["pixels", "thousandths", "unit"]
    side_multiple: int = 0
    min_pixels: int = 56 * 56
    max_pixels: int = 16384 * 28 * 28
    rows_first: bool = False
    box_key: str = "bbox_2d"

    def prepared(self, image: Image) -> UInt8[np.ndarray, "sent_height sent_width 3"]:
        """The image resized for sending."""
        height, width = image.shape[:2]
        new_width, new_height = self.sent_size(width, height)
        if (new_width, new_height) == (width, height):
            return image
        shrinks = new_width * new_height < width * height
        method = cv2.INTER_AREA if shrinks else cv2.INTER_CUBIC
        resized = cv2.resize(image, (new_width, new_height), interpolation=method)
        return resized.astype(image.dtype, copy=False)

    def sent_size(self, width: int, height: int) -> tuple[int, int]:
        """Width and height of the sent image."""
        if not self.side_multiple:
            return width, height
        return smart_resize(
            width,
            height,
            multiple=self.side_multiple,
            min_pixels=self.min_pixels,
            max_pixels=self.max_pixels,
        )

    def extent(self, width: int, height: int) -> tuple[float, float]:
        """The largest x and y in the model's coordinates for an image of this size."""
        match self.space:
            case "pixels":
                sent = self.sent_size(width, height)
                return float(sent[0]), float(sent[1])
            case "thousandths":
                return 1000.0, 1000.0
            case "unit":
                return 1.0, 1.0

    def to_image(self, box: Box, width: int, height: int) -> Box:
        """Convert a box from the model's coordinates to pixels of an image of this size."""
        extent_x, extent_y = self.extent(width, height)
        x, y = width / extent_x, height / extent_y
        return Box(box.x_min * x, box.y_min * y, box.x_max * x, box.y_max * y)

    def from_image(self, box: Box, width: int, height: int) -> Box:
        """The inverse of `to_image`."""
        extent_x, extent_y = self.extent(width, height)
        x, y = extent_x / width, extent_y / height
        return Box(box.x_min * x, box.y_min * y, box.x_max * x, box.y_max * y)


def smart_resize(
    width: int, height: int, *, multiple: int = 28, min_pixels: int, max_pixels: int
) -> tuple[int, int]:
    """Qwen's resizing: sides to the nearest multiple, area within bounds, ratio nearly kept.

    With multiples of 28, 640×480 becomes 644×476.

    Source: ``smart_resize`` in qwen-vl-utils (Apache-2.0).

    Returns:
        Width and height.

    Raises:
        ModelError: One side is more than 200 times the other.
    """
    if max(width, height) > _LONGEST_RATIO * min(width, height):
        raise ModelError(f"an image of {width}×{height} is too narrow for this family of models")
    new_width = max(multiple, round(width / multiple) * multiple)
    new_height = max(multiple, round(height / multiple) * multiple)
    if new_width * new_height > max_pixels:
        shrink = math.sqrt(width * height / max_pixels)
        new_width = max(multiple, math.floor(width / shrink / multiple) * multiple)
        new_height = max(multiple, math.floor(height / shrink / multiple) * multiple)
    elif new_width * new_height < min_pixels:
        grow = math.sqrt(min_pixels / (width * height))
        new_width = math.ceil(width * grow / multiple) * multiple
        new_height = math.ceil(height * grow / multiple) * multiple
    return new_width, new_height


FAMILIES: dict[str, VlmFamily] = {
    family.name: family
    for family in (
        VlmFamily("qwen2.5-vl", "pixels", side_multiple=28),
        VlmFamily("qwen2-vl", "thousandths"),
        VlmFamily("qwen3-vl", "thousandths"),
        VlmFamily("glm-v", "thousandths"),
        VlmFamily("gemini", "thousandths", rows_first=True, box_key="box_2d"),
        VlmFamily("pixels", "pixels"),
        VlmFamily("thousandths", "thousandths"),
        VlmFamily("unit", "unit"),
    )
}

_SPELLINGS: tuple[tuple[str, str], ...] = (
    (r"qwen[-_. ]?2[._-]?5[-_. ]?(?:vl|omni)", "qwen2.5-vl"),
    (r"qwen[-_. ]?2[-_. ]?vl", "qwen2-vl"),
    (r"qwen[-_. ]?3", "qwen3-vl"),
    (r"glm[-_. ]?4[._-]?\d?v|glm[-_. ]?\d+[._-]?\d*v", "glm-v"),
    (r"gemini", "gemini"),
)


def family_named(name: str) -> VlmFamily:
    """A family by its name.

    Raises:
        ConfigError: There is none; the message lists those that exist.
    """
    if name not in FAMILIES:
        raise ConfigError(
            f"there is no model family '{name}'; choose auto or {', '.join(FAMILIES)}"
        )
    return FAMILIES[name]


def family_of(model: str) -> VlmFamily:
    """The family of a model, by its name.

    Raises:
        ConfigError: The name shows no family; guessing would put every box in a wrong position.
    """
    for pattern, name in _SPELLINGS:
        if re.search(pattern, model, re.IGNORECASE):
            return FAMILIES[name]
    raise ConfigError(
        f"it is not known in which coordinates '{model}' answers; name its family: "
        f"{', '.join(FAMILIES)} (hypernav doctor finds out with a drawn shape)"
    )
