"""Detectors of a closed set of classes that are ONNX files: all but the form of their outputs."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar

import cv2
import numpy as np
from jaxtyping import Float32, Float64, Int64, UInt8

from hypernav.core.config import Curve
from hypernav.core.errors import ModelError
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.score_weights import MISSED
from hypernav.search.models.closed_set import class_for
from hypernav.search.models.config import OnnxDetectorConfig
from hypernav.search.models.network_loading import open_session
from hypernav.search.models.reliability import reliability_of

_THREADS = 2
_MIN_BOX_PX = 2.0
"""Boxes with a shorter side are dropped."""
_FREE_INPUT_PX = 640
"""Side of the input for an export whose own input size is not fixed; YOLOX's own."""
_GREY = 114


@dataclass(frozen=True, eq=False)
class RawBoxes:
    """Boxes of one image before suppression.

    Attributes:
        corners: ``(x_min, y_min, x_max, y_max)``, pixels.
        scores: Score of the best class, 0 to 1.
        classes: Number of that class.
    """

    corners: Float64[np.ndarray, "n 4"]
    scores: Float64[np.ndarray, " n"]
    classes: Int64[np.ndarray, " n"]


class OnnxDetector(ABC):
    """Detects objects of a closed set of classes (by default COCO's 80).

    A subclass knows one form of inputs and outputs: it prepares the image (`_blob`), and decodes
    what the network says about it (`_decode`).
    """

    kind: ClassVar[str]
    """Name on the command line, before the file's."""
    family: ClassVar[str]
    """Name in error messages."""
    _nms_iou: ClassVar[float]
    """Overlap of two boxes of one class above which only the better one is kept."""

    def __init__(self, path: Path | str, config: OnnxDetectorConfig | None = None) -> None:
        """Load the network.

        Raises:
            MissingExtraError: onnxruntime is not installed.
            ModelError: No such file, no ONNX model, or one of another form.
        """
        self.config = config or OnnxDetectorConfig()
        self.path = Path(path)
        self._session = open_session(self.path, threads=_THREADS)
        self._input_name, self._height, self._width = self._read_input()
        self._check_output()
        self.reliability = reliability_of(self.path)

    @property
    def name(self) -> str:
        """Name in traces and reports."""
        return f"{self.kind}:{self.path.name}"

    @property
    def score_weights(self) -> Curve:
        """What its scores are worth, as measured of this very file; empty if that is not known."""
        return () if self.reliability is None else self.reliability.boxes

    @property
    def missed_weight(self) -> float:
        """What it is worth that it sees nothing, as measured of this very file."""
        return MISSED if self.reliability is None else self.reliability.missed

    def check_goal(self, goal: Goal) -> str:
        """The class that will be looked for.

        Raises:
            GoalError: The network cannot see such a thing; the message names the closest classes.
        """
        return self.config.classes[class_for(goal, self.config.classes)]

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        """All things, best first; those of other classes are marked as not being the goal.

        Raises:
            GoalError: The network cannot see such a thing.
        """
        wanted = self.check_goal(goal)
        found = self.detect_all(observation.rgb)
        return [replace(one, is_goal=one.label == wanted) for one in found]

    def things_in(
        self, observation: Observation, detections: Sequence[Detection]
    ) -> list[Detection]:
        """All that `detect` found: one run of the network sees all classes."""
        return list(detections)

    def detect_all(self, rgb: UInt8[np.ndarray, "height width 3"]) -> list[Detection]:
        """Everything the network sees, of all classes, best first."""
        blob, scale_x, scale_y = self._blob(rgb)
        raw = self._decode(self._run(blob))
        corners = raw.corners / (scale_x, scale_y, scale_x, scale_y)
        detections = []
        for index in keep_best_boxes(corners, raw.scores, raw.classes, self._nms_iou):
            box = Box(*(float(edge) for edge in corners[index])).clipped(rgb.shape[1], rgb.shape[0])
            sides = (box.x_max - box.x_min, box.y_max - box.y_min)
            if min(sides) >= _MIN_BOX_PX:
                label = self.config.classes[int(raw.classes[index])]
                detections.append(Detection(box, float(raw.scores[index]), label))
        return detections

    @abstractmethod
    def _blob(
        self, rgb: UInt8[np.ndarray, "height width 3"]
    ) -> tuple[Float32[np.ndarray, "1 3 input_height input_width"], float, float]:
        """The network's input, and its pixels per pixel of the image, along x and y."""

    @abstractmethod
    def _decode(self, outputs: list[Float32[np.ndarray, "..."]]) -> RawBoxes:
        """Boxes in pixels of the input with their scores, those above the threshold."""

    @abstractmethod
    def _output_shapes(self) -> list[tuple[int, ...]]:
        """Shapes of the outputs for the input's size."""

    def _in_the_corner(
        self, rgb: UInt8[np.ndarray, "height width 3"]
    ) -> tuple[UInt8[np.ndarray, "input_height input_width 3"], float]:
        """The image in the upper left of the input, as large as it fits, and its scale."""
        ratio = min(self._height / rgb.shape[0], self._width / rgb.shape[1])
        size = (max(int(rgb.shape[1] * ratio), 1), max(int(rgb.shape[0] * ratio), 1))
        canvas = np.full((self._height, self._width, 3), _GREY, dtype=np.uint8)
        canvas[: size[1], : size[0]] = cv2.resize(rgb, size, interpolation=cv2.INTER_LINEAR)
        return canvas, ratio

    def _run(
        self, blob: Float32[np.ndarray, "1 3 input_height input_width"]
    ) -> list[Float32[np.ndarray, "..."]]:
        """The outputs, without numbers that are none."""
        outputs = self._session.run(None, {self._input_name: blob})
        return [
            np.nan_to_num(np.asarray(one, np.float32), nan=0.0, posinf=0.0, neginf=0.0)
            for one in outputs
        ]

    def _read_input(self) -> tuple[str, int, int]:
        inputs = self._session.get_inputs()
        if len(inputs) != 1 or len(inputs[0].shape) != 4 or inputs[0].type != "tensor(float)":
            found = ", ".join(f"{one.name} {one.shape} {one.type}" for one in inputs)
            raise ModelError(
                f"{self.path} is not a {self.family} export: expected one float input "
                f"[1, 3, height, width], found {found}"
            )
        sides = [side if isinstance(side, int) else _FREE_INPUT_PX for side in inputs[0].shape[2:]]
        return inputs[0].name, sides[0], sides[1]

    def _check_output(self) -> None:
        """Run the network once, because the declared shape may be symbolic."""
        grey = np.full((self._height, self._width, 3), _GREY, dtype=np.uint8)
        found = [np.shape(one) for one in self._run(self._blob(grey)[0])]
        expected = self._output_shapes()
        if found != expected:
            raise ModelError(
                f"{self.path} is not a {self.family} with {len(self.config.classes)} classes: "
                f"expected {_shapes(expected)} for an input of {self._width}×{self._height}, "
                f"found {_shapes(found)}; begin with yolox:, yolov8: or picodet: as the file "
                "is, export it without suppression, or name its classes in onnx_detector.classes"
            )


def _shapes(shapes: Sequence[tuple[int, ...]]) -> str:
    said = ", ".join(str(list(shape)) for shape in shapes)
    return f"an output of {said}" if len(shapes) == 1 else f"outputs of {said}"


def keep_best_boxes(
    boxes: Float64[np.ndarray, "n 4"],
    scores: Float64[np.ndarray, " n"],
    classes: Int64[np.ndarray, " n"],
    max_iou: float,
) -> list[int]:
    """Non-maximum suppression within each class.

    Args:
        boxes: ``(x_min, y_min, x_max, y_max)``.
        scores: Higher is better; ties go to the earlier box.
        classes: Boxes of different classes never suppress each other.
        max_iou: Largest overlap of two kept boxes of one class.

    Returns:
        Indices of the boxes to keep, best first.
    """
    areas = np.prod(np.maximum(boxes[:, 2:] - boxes[:, :2], 0.0), axis=1)
    alive = np.ones(len(boxes), dtype=bool)
    kept: list[int] = []
    for index in np.argsort(-scores, kind="stable"):
        if not alive[index]:
            continue
        kept.append(int(index))
        corner_min = np.maximum(boxes[index, :2], boxes[:, :2])
        corner_max = np.minimum(boxes[index, 2:], boxes[:, 2:])
        overlap = np.prod(np.maximum(corner_max - corner_min, 0.0), axis=1)
        union = np.maximum(areas[index] + areas - overlap, 1e-12)
        alive &= ~((classes == classes[index]) & (overlap / union > max_iou))
    return kept
