"""Families of vision-language models: their coordinates, image sizes and words.

A family is a convention; `MODEL_LINES` names the models that follow one, each with the page of its
makers that says so. A model without such a page is in no family: it is not guessed.
"""

import math
import re
from dataclasses import dataclass, replace
from functools import partial
from importlib.resources import files
from typing import Literal

import cv2
import numpy as np
from jaxtyping import UInt8

from hypernav.core.chat import Image
from hypernav.core.errors import ConfigError, ModelError
from hypernav.core.geometry.boxes import Box
from hypernav.search.models.chat.config import FamilyName

SIDES = {"thousandths": 1000.0, "percent": 100.0, "bins": 1024.0, "unit": 1.0}
"""The image's sides in every relative space."""

_LONGEST_RATIO = 200.0


@dataclass(frozen=True)
class VlmFamily:
    """Box coordinates and image size of a family of models.

    Attributes:
        name: Name in configuration and reports.
        space: Unit of its coordinates: "pixels" of the image as it was sent, "thousandths" or
            "percent" of the image's sides, "bins" (1024 of a side), or "unit" (0 to 1).
        side_multiple: The image is sent with sides that are multiples of this, so that the
            server need not resize it and pixels mean the same on both sides; 0 sends it unchanged.
        min_pixels: Smallest area of the sent image.
        max_pixels: Largest area of the sent image.
        token_px: Side of the square of the image that is one token, where the number of tokens
            tells at which size the model saw it; 0 where it doesn't.
        least_tokens: Tokens below which the server enlarges an image; it is sent as it would be.
        rows_first: Whether boxes are ``(y_min, x_min, y_max, x_max)``, and points ``(y, x)``.
        box_key: Key of a box in its JSON.
        points: Whether it is asked for points instead of boxes.
        asks: Words to ask it with, where it does not answer in JSON; ``{goal}`` is filled in.
    """

    name: FamilyName
    space: Literal["pixels", "thousandths", "percent", "bins", "unit"]
    side_multiple: int = 0
    min_pixels: int = 56 * 56
    max_pixels: int = 16384 * 28 * 28
    token_px: int = 0
    least_tokens: int = 0
    rows_first: bool = False
    box_key: str = "bbox_2d"
    points: bool = False
    asks: str = ""

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
        fit = partial(smart_resize, multiple=self.side_multiple, max_pixels=self.max_pixels)
        sent = fit(width, height, min_pixels=self.min_pixels)
        return fit(*sent, min_pixels=self.least_tokens * self.token_px**2)

    def extent(self, width: int, height: int) -> tuple[float, float]:
        """The largest x and y in the model's coordinates for an image of this size."""
        match self.space:
            case "pixels":
                sent = self.sent_size(width, height)
                return float(sent[0]), float(sent[1])
            case _:
                side = SIDES[self.space]
                return side, side

    def tokens(self, width: int, height: int) -> int:
        """Number of tokens of an image of this size, once it is sent; 0 where it isn't known."""
        sent = self.sent_size(width, height)
        return sent[0] * sent[1] // self.token_px**2 if self.token_px else 0

    def with_least_tokens(self, least: int) -> "VlmFamily":
        """The family at a server that enlarges images of fewer tokens."""
        return replace(self, least_tokens=least)

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


_POINT_TO = "Point to every {goal} in the picture. If there is none, say: There are none."
_POINT_AT = (
    "Locate every {goal} in the picture. Answer with one point on each, in pixels, as "
    "<point>[[x1, y1], [x2, y2], ...]</point>. If there is no {goal} in the picture, answer []."
)
_IN_PIXELS = (
    "Locate every {goal} in the picture and report the bounding boxes in pixel coordinates, in "
    'JSON format, for example [{{"bbox_2d": [x1, y1, x2, y2], "label": "{goal}"}}]. If there is no '
    "{goal} in the picture, answer []."
)

FAMILIES: dict[str, VlmFamily] = {
    family.name: family
    for family in (
        VlmFamily("qwen2.5-vl", "pixels", side_multiple=28, token_px=28),
        VlmFamily("qwen2-vl", "thousandths"),
        VlmFamily("qwen3-vl", "thousandths"),
        VlmFamily("glm-v", "thousandths"),
        VlmFamily("gemini", "thousandths", rows_first=True, box_key="box_2d"),
        # Images of up to 1568 pixels a side and about 1.15 megapixels are not resized.
        VlmFamily("claude", "pixels", side_multiple=28, max_pixels=1_150_000, asks=_IN_PIXELS),
        VlmFamily(
            "embodied-r1", "pixels", side_multiple=28, token_px=28, points=True, asks=_POINT_AT
        ),
        VlmFamily("molmo", "percent", points=True, asks=_POINT_TO),
        VlmFamily("molmo2", "thousandths", points=True, asks=_POINT_TO),
        VlmFamily("paligemma", "bins", rows_first=True, asks="detect {goal}"),
        VlmFamily("florence-2", "thousandths", asks="<OPEN_VOCABULARY_DETECTION>{goal}"),
        VlmFamily("deepseek-vl2", "thousandths", asks="<|ref|>{goal}<|/ref|>."),
        VlmFamily("pixels", "pixels"),
        VlmFamily("thousandths", "thousandths"),
        VlmFamily("unit", "unit"),
    )
}


@dataclass(frozen=True)
class ModelLine:
    """A line of models whose coordinates are documented.

    Attributes:
        name: Its name, for people.
        spelling: Regular expression that is in the names of its models, whatever their case.
        family: Its convention.
        source: Who says so, and where.
    """

    name: str
    spelling: str
    family: FamilyName
    source: str


def _parsed(table: str) -> tuple[ModelLine, ...]:
    rows = (re.split(" {2,}", line) for line in table.splitlines())
    return tuple(
        ModelLine(name, spelling, FAMILIES[family].name, source)
        for name, family, spelling, source in rows
    )


MODEL_LINES = _parsed(
    files("hypernav.search.models.chat").joinpath("model_lines.txt").read_text("utf-8")
)
"""The lines of models that are known by name (``model_lines.txt``: name, family, spelling and
source, with two spaces or more between them); the first whose spelling fits counts."""


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
    for line in MODEL_LINES:
        # Behind a hyphen it is what another model was made of, and of 4b the 4 is a size.
        if re.search(rf"(?<![a-z0-9-])(?:{line.spelling})(?![.\d]*b\b)", model, re.IGNORECASE):
            return FAMILIES[line.family]
    raise ConfigError(
        f"it is not known in which coordinates '{model}' answers; name its family: "
        f"{', '.join(FAMILIES)} (hypernav doctor finds out with a drawn shape)"
    )
