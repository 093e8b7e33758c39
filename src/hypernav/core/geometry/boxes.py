"""Boxes in an image, and detections."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool


@dataclass(frozen=True)
class Box:
    """A rectangle in pixels, ``(x_min, y_min, x_max, y_max)``, maximum exclusive."""

    x_min: float
    y_min: float
    x_max: float
    y_max: float

    @property
    def area(self) -> float:
        """Area in square pixels; 0 for an inverted box."""
        return max(self.x_max - self.x_min, 0.0) * max(self.y_max - self.y_min, 0.0)

    def clipped(self, width: int, height: int) -> "Box":
        """The part inside an image of this size (may have no area)."""
        return Box(
            min(max(self.x_min, 0.0), float(width)),
            min(max(self.y_min, 0.0), float(height)),
            min(max(self.x_max, 0.0), float(width)),
            min(max(self.y_max, 0.0), float(height)),
        )

    def iou(self, other: "Box") -> float:
        """Intersection over union, 0 to 1."""
        overlap = Box(
            max(self.x_min, other.x_min),
            max(self.y_min, other.y_min),
            min(self.x_max, other.x_max),
            min(self.y_max, other.y_max),
        ).area
        union = self.area + other.area - overlap
        return overlap / union if union > 0.0 else 0.0

    def pixels(self) -> tuple[int, int, int, int]:
        """Whole-pixel bounds ``(x_min, y_min, x_max, y_max)`` that cover the box."""
        return (
            math.floor(self.x_min),
            math.floor(self.y_min),
            math.ceil(self.x_max),
            math.ceil(self.y_max),
        )

    def mask(self, width: int, height: int) -> Bool[np.ndarray, "height width"]:
        """The pixels of the box in an image of this size."""
        x_min, y_min, x_max, y_max = self.clipped(width, height).pixels()
        mask = np.zeros((height, width), dtype=bool)
        mask[y_min:y_max, x_min:x_max] = True
        return mask


@dataclass(frozen=True, eq=False)
class Detection:
    """One object that a detector reports.

    Attributes:
        box: Bounding box in the colour image.
        score: Confidence, 0 to 1.
        label: The detector's word for the object.
        mask: Mask of the object's pixels, from detectors that segment as well; else a segmenter is
            asked.
        point: Point ``(x, y)`` on the object in pixels, from detectors that point; the box is then
            a guess around it.
        is_goal: Whether the object satisfies the goal. A detector that knows other labels may
            return such objects, too, as evidence that the goal is not there.
    """

    box: Box
    score: float
    label: str
    mask: Bool[np.ndarray, "height width"] | None = None
    point: tuple[float, float] | None = None
    is_goal: bool = True
