"""Detectors of Ultralytics' YOLO from version 8 on, exported to ONNX without NMS.

YOLOv8, YOLOv9, YOLO11 and YOLO12 share one output. Source: the reference code
ultralytics/ultralytics (``nn/modules/head.py::Detect``, ``data/augment.py::LetterBox``).
"""

import numpy as np
from jaxtyping import Float32, UInt8

from hypernav.search.models.onnx_detector import OnnxDetector, RawBoxes

_STRIDES = (8, 16, 32)


class Yolov8Detector(OnnxDetector):
    """A YOLO whose output has a column for each cell: a box, and the score of each class.

    A box is ``(x, y, width, height)`` around its middle, pixels of the input.
    """

    kind = "yolov8"
    family = "YOLOv8"
    _nms_iou = 0.7  # Ultralytics' default

    def _blob(
        self, rgb: UInt8[np.ndarray, "height width 3"]
    ) -> tuple[Float32[np.ndarray, "1 3 input_height input_width"], float, float]:
        """The image in the upper left of the input, in RGB from 0 to 1."""
        canvas, ratio = self._in_the_corner(rgb)
        blob = np.ascontiguousarray(canvas.transpose(2, 0, 1)[None], dtype=np.float32)
        return blob / np.float32(255.0), ratio, ratio

    def _decode(self, outputs: list[Float32[np.ndarray, "..."]]) -> RawBoxes:
        output = outputs[0][0].T.astype(np.float64)
        classes = output[:, 4:].argmax(axis=1)
        scores = np.clip(output[np.arange(len(output)), 4 + classes], 0.0, 1.0)
        keep = scores >= self.config.score_threshold
        middles, half = output[keep, :2], output[keep, 2:4] / 2.0
        corners = np.concatenate([middles - half, middles + half], axis=1)
        return RawBoxes(corners, scores[keep], classes[keep])

    def _output_shapes(self) -> list[tuple[int, ...]]:
        cells = sum((self._height // stride) * (self._width // stride) for stride in _STRIDES)
        return [(1, 4 + len(self.config.classes), cells)]
