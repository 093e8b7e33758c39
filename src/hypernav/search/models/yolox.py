"""YOLOX detectors, exported to ONNX, and which of COCO's 80 classes a goal names.

Source: Ge et al., "YOLOX: Exceeding YOLO Series in 2021", and the reference code
Megvii-BaseDetection/YOLOX (``yolox/data/data_augment.py::preproc``, ``yolox/utils/demo_utils.py``).
"""

import difflib
import math
from collections.abc import Sequence
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Float32, Float64, Int64, UInt8
from pydantic import Field

from hypernav.core.config import RoomConfig
from hypernav.core.errors import GoalError, ModelError
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.goal import Goal
from hypernav.core.labels import ObjectLabel, canonical
from hypernav.core.observation import Observation
from hypernav.search.models.network_loading import open_session

COCO_CLASSES: tuple[str, ...] = tuple(
    files("hypernav.search.models").joinpath("coco_classes.txt").read_text("utf-8").splitlines()
)

_THREADS = 2
_PADDING = 114
_NMS_IOU = 0.45
"""Overlap of two boxes of one class above which only the better one is kept (YOLOX's demo)."""
_CLOSER_TIMES = 2.5
"""Side of the part of the image that is looked at more closely, in sides of the box."""
_CLOSER_PX = 96.0
"""Smallest side of such a part, pixels."""
_MOST_CLOSER = 3
"""Largest number of such parts in one image."""
_SAME_BOX_IOU = 0.3
"""Overlap from which on a box in such a part is the one that it was made for."""
_MIN_BOX_PX = 2.0
"""Boxes with a shorter side are dropped."""
_FREE_INPUT_PX = 640
"""Side of the input for an export whose own input size is not fixed; YOLOX's own."""


def class_for(goal: Goal, classes: tuple[str, ...]) -> int:
    """The class of a closed set that a goal names.

    Synonyms are accepted ("sofa" is COCO's "couch"), and so is a bare head noun ("table" is
    "dining table"). Attributes and places are not: a closed-set detector that is asked for a
    "red chair" would stop at any chair.

    Raises:
        GoalError: The goal is none of the classes; the message names the closest ones.
    """
    wanted = canonical(goal.text)
    for number, name in enumerate(classes):
        if canonical(name) == wanted:
            return number
    for number, name in enumerate(classes):
        if ObjectLabel(name).is_named(goal.text):
            return number
    raise GoalError(
        f"this detector knows {len(classes)} kinds of things and '{goal.text}' is none of them; "
        f"closest: {', '.join(_closest(wanted, classes))}"
    )


def _closest(wanted: str, classes: tuple[str, ...]) -> list[str]:
    """Up to three class names: those that the goal contains, then those with a similar spelling."""
    by_name = {canonical(name): name for name in classes}
    contained = [name for key, name in by_name.items() if f" {key} " in f" {wanted} "]
    alike = [by_name[key] for key in difflib.get_close_matches(wanted, list(by_name), 3, 0.4)]
    found = list(dict.fromkeys(contained + alike))[:3]
    return found or sorted(classes)[:3]


class YoloxConfig(RoomConfig):
    """How a YOLOX export is used.

    Attributes:
        score_threshold: Score below which detections are dropped; objectness times class score.
        look_closer_below: Score of the goal below which the network looks once more, at the part of
            the image around the box, enlarged; the score is then the mean of both, and may be below
            `score_threshold`. 0 never looks closer.
        classes: Names in the order of the network's outputs.
    """

    score_threshold: float = Field(default=0.1, ge=0.0, le=1.0)
    look_closer_below: float = Field(default=0.6, ge=0.0, le=1.0)
    classes: tuple[str, ...] = COCO_CLASSES


class YoloxDetector:
    """Detects objects of a closed set of classes (by default COCO's 80).

    Reads both kinds of export: the raw head, which is decoded here, and one with the decoding
    built in (``--decode_in_inference``).
    """

    def __init__(self, path: Path | str, config: YoloxConfig | None = None) -> None:
        """Load the network.

        Raises:
            MissingExtraError: onnxruntime is not installed.
            ModelError: No such file, no ONNX model, or no YOLOX.
        """
        self.config = config or YoloxConfig()
        self.path = Path(path)
        self._session = open_session(self.path, threads=_THREADS)
        self._input_name, self._height, self._width = self._read_input()
        self._grid, self._strides = self._anchors()
        self._check_output()

    @property
    def name(self) -> str:
        """Name in traces and reports."""
        return f"yolox:{self.path.name}"

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
        found = [
            replace(one, is_goal=one.label == wanted) for one in self.detect_all(observation.rgb)
        ]
        weak = [one for one in found if one.is_goal and one.score < self.config.look_closer_below]
        closer = {id(one): self._looked_closer(one, observation.rgb) for one in weak[:_MOST_CLOSER]}
        found = [closer.get(id(one), one) for one in found]
        return sorted(found, key=lambda one: -one.score)

    def things_in(
        self, observation: Observation, detections: Sequence[Detection]
    ) -> list[Detection]:
        """All that `detect` found: one run of the network sees all classes."""
        return list(detections)

    def _looked_closer(
        self, weak: Detection, rgb: UInt8[np.ndarray, "height width 3"]
    ) -> Detection:
        """A detection with the mean of its score and that in an enlarged part of the image."""
        height, width = rgb.shape[:2]
        box = weak.box
        side = max(_CLOSER_TIMES * max(box.x_max - box.x_min, box.y_max - box.y_min), _CLOSER_PX)
        x = int(np.clip((box.x_min + box.x_max - side) / 2.0, 0.0, max(width - side, 0.0)))
        y = int(np.clip((box.y_min + box.y_max - side) / 2.0, 0.0, max(height - side, 0.0)))
        part = rgb[y : y + math.ceil(side), x : x + math.ceil(side)]
        if part.shape == rgb.shape:
            return weak
        inside = Box(box.x_min - x, box.y_min - y, box.x_max - x, box.y_max - y)
        same = [one for one in self.detect_all(part) if one.label == weak.label]
        best = max(same, key=lambda one: one.box.iou(inside), default=None)
        is_same = best is not None and best.box.iou(inside) >= _SAME_BOX_IOU
        again = best.score if best is not None and is_same else 0.0
        return replace(weak, score=(weak.score + again) / 2.0)

    def detect_all(self, rgb: UInt8[np.ndarray, "height width 3"]) -> list[Detection]:
        """Everything the network sees, of all classes, best first."""
        blob, ratio = self._letterbox(rgb)
        output = self._session.run(None, {self._input_name: blob})[0][0]
        boxes, scores, classes = self._decode(np.asarray(output, dtype=np.float32))
        boxes /= ratio
        detections = []
        for index in keep_best_boxes(boxes, scores, classes, _NMS_IOU):
            box = Box(*(float(edge) for edge in boxes[index])).clipped(rgb.shape[1], rgb.shape[0])
            sides = (box.x_max - box.x_min, box.y_max - box.y_min)
            if min(sides) >= _MIN_BOX_PX:
                label = self.config.classes[int(classes[index])]
                detections.append(Detection(box, float(scores[index]), label))
        return detections

    def _letterbox(
        self, rgb: UInt8[np.ndarray, "height width 3"]
    ) -> tuple[Float32[np.ndarray, "1 3 input_height input_width"], float]:
        """The image in the upper left of the input, in BGR from 0 to 255, and its scale."""
        ratio = min(self._height / rgb.shape[0], self._width / rgb.shape[1])
        size = (max(int(rgb.shape[1] * ratio), 1), max(int(rgb.shape[0] * ratio), 1))
        canvas = np.full((self._height, self._width, 3), _PADDING, dtype=np.uint8)
        resized = cv2.resize(rgb, size, interpolation=cv2.INTER_LINEAR)
        canvas[: size[1], : size[0]] = resized[..., ::-1]
        return np.ascontiguousarray(canvas.transpose(2, 0, 1)[None], dtype=np.float32), ratio

    def _decode(
        self, output: Float32[np.ndarray, "anchors values"]
    ) -> tuple[
        Float64[np.ndarray, "kept 4"], Float64[np.ndarray, " kept"], Int64[np.ndarray, " kept"]
    ]:
        """Boxes (input pixels), scores and classes above the threshold."""
        output = np.nan_to_num(output, nan=0.0, posinf=0.0, neginf=0.0).astype(np.float64)
        classes = output[:, 5:].argmax(axis=1)
        scores = output[:, 4] * output[np.arange(len(output)), 5 + classes]
        centres, sizes = output[:, :2], output[:, 2:4]
        # A raw centre is an offset of about one cell; decoded centres are spread over the input.
        if np.median(np.abs(centres[:, 0])) < self._width / 8.0:
            centres = (centres + self._grid) * self._strides
            sizes = np.exp(np.clip(sizes, -20.0, 20.0)) * self._strides
        keep = scores >= self.config.score_threshold
        half = sizes[keep] / 2.0
        boxes = np.concatenate([centres[keep] - half, centres[keep] + half], axis=1)
        return boxes, scores[keep], classes[keep]

    def _read_input(self) -> tuple[str, int, int]:
        inputs = self._session.get_inputs()
        if len(inputs) != 1 or len(inputs[0].shape) != 4 or inputs[0].type != "tensor(float)":
            found = ", ".join(f"{one.name} {one.shape} {one.type}" for one in inputs)
            raise ModelError(
                f"{self.path} is not a YOLOX export: expected one float input "
                f"[1, 3, height, width], found {found}"
            )
        sides = [side if isinstance(side, int) else _FREE_INPUT_PX for side in inputs[0].shape[2:]]
        return inputs[0].name, sides[0], sides[1]

    def _anchors(self) -> tuple[Float64[np.ndarray, "anchors 2"], Float64[np.ndarray, "anchors 1"]]:
        """Cell ``(x, y)`` and stride of every output row."""
        cells, strides = [], []
        for stride in (8, 16, 32):
            y, x = np.mgrid[: self._height // stride, : self._width // stride]
            cells.append(np.stack([x.ravel(), y.ravel()], axis=1).astype(np.float64))
            strides.append(np.full((x.size, 1), float(stride)))
        return np.concatenate(cells), np.concatenate(strides)

    def _check_output(self) -> None:
        """Run the network once, because the declared shape may be symbolic."""
        blank = np.full((1, 3, self._height, self._width), float(_PADDING), dtype=np.float32)
        output = self._session.run(None, {self._input_name: blank})[0]
        expected = (1, len(self._grid), 5 + len(self.config.classes))
        if np.shape(output) != expected:
            raise ModelError(
                f"{self.path} is not a YOLOX with {len(self.config.classes)} classes: expected an "
                f"output of {list(expected)} for an input of {self._width}×{self._height}, found "
                f"{list(np.shape(output))}"
            )


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
