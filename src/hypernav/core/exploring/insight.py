"""What an explorer looked at when it chose, for videos and pages."""

import base64
import zlib
from typing import ClassVar

import numpy as np
from jaxtyping import Float32, UInt8
from pydantic import BaseModel, ConfigDict, Field

_WORST, _BEST = 1, 255
"""Grades of the values 0 and 1; 0 is no value."""


class _Part(BaseModel):
    model_config: ClassVar[ConfigDict] = ConfigDict(frozen=True, extra="forbid")


class ImageMark(_Part):
    """A numbered mark in the camera image, and whether it was chosen."""

    number: int
    pixel: tuple[float, float]
    chosen: bool = False


class ImageWindow(_Part):
    """A part of the camera image ``(u_min, v_min, u_max, v_max)``, pixels, and its name."""

    box: tuple[float, float, float, float]
    label: str


class ValueImage(_Part):
    """Values of the floor, 0 to 1, in the ``map`` frame.

    Attributes:
        x_min: Lower left corner of the first cell, metres.
        y_min: Lower left corner of the first cell, metres.
        cell_m: Side of a cell, metres.
        rows: Number of rows, along y.
        packed: Grades of the cells, row by row: bytes, deflated, in base 64.
    """

    x_min: float
    y_min: float
    cell_m: float
    rows: int
    packed: str

    @staticmethod
    def of(
        values: Float32[np.ndarray, "rows columns"], origin: tuple[float, float], cell_m: float
    ) -> "ValueImage":
        """Pack values.

        Args:
            values: Values of the cells, NaN where there is none.
            origin: Lower left corner of the first cell, metres.
            cell_m: Side of a cell, metres.
        """
        grades = np.clip(np.rint(_WORST + (_BEST - _WORST) * values), _WORST, _BEST)
        content = np.where(np.isnan(values), 0.0, grades).astype(np.uint8).tobytes()
        return ValueImage(
            x_min=origin[0],
            y_min=origin[1],
            cell_m=cell_m,
            rows=len(values),
            packed=base64.b64encode(zlib.compress(content)).decode("ascii"),
        )

    @property
    def grades(self) -> UInt8[np.ndarray, "rows columns"]:
        """Grades of the cells: 0 where there is no value, else 1 for 0 to 255 for 1."""
        content = zlib.decompress(base64.b64decode(self.packed))
        return np.frombuffer(content, dtype=np.uint8).reshape(self.rows, -1)


class RememberedThing(_Part):
    """A thing on the map, metres, and whether the reasoner is told about it."""

    label: str
    position: tuple[float, float]
    told: bool = False


class ThingGraph(_Part):
    """Things, and pairs of them, by their indices, that are near each other."""

    things: list[RememberedThing]
    near: list[tuple[int, int]] = Field(default_factory=list)


class Insight(_Part):
    """What an explorer looked at when it chose; each method fills in what it has.

    Attributes:
        marks: Numbered marks in the camera image.
        foot: Image coordinates from which lines lead to the marks; None for marks alone.
        window: Part of the camera image that was chosen.
        values: Values of the floor.
        graph: Things that are remembered.
    """

    marks: list[ImageMark] = Field(default_factory=list)
    foot: tuple[float, float] | None = None
    window: ImageWindow | None = None
    values: ValueImage | None = None
    graph: ThingGraph | None = None
