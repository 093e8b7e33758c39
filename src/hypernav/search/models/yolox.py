"""YOLOX detectors, exported to ONNX.

Source: Ge et al., "YOLOX: Exceeding YOLO Series in 2021", and the reference code
Megvii-BaseDetection/YOLOX (``yolox/data/data_augment.py::preproc``, ``yolox/utils/demo_utils.py``).
"""

import numpy as np
from jaxtyping import Float32, Float64, UInt8

from hypernav.search.models.onnx_detector import OnnxDetector, RawBoxes

_STRIDES = (8, 16, 32)


class YoloxDetector(OnnxDetector):
    """A YOLOX.

    Reads both kinds of export: the raw head, which is decoded here, and one with the decoding
    built in (``--decode_in_inference``). A score is objectness times class score.
    """

    kind = "yolox"
    family = "YOLOX"
    _nms_iou = 0.45  # YOLOX's demo

    def _blob(
        self, rgb: UInt8[np.ndarray, "height width 3"]
    ) -> tuple[Float32[np.ndarray, "1 3 input_height input_width"], float, float]:
        """The image in the upper left of the input, in BGR from 0 to 255."""
        canvas, ratio = self._in_the_corner(rgb)
        blob = np.ascontiguousarray(canvas[..., ::-1].transpose(2, 0, 1)[None], dtype=np.float32)
        return blob, ratio, ratio

    def _decode(self, outputs: list[Float32[np.ndarray, "..."]]) -> RawBoxes:
        output = outputs[0][0].astype(np.float64)
        classes = output[:, 5:].argmax(axis=1)
        scores = output[:, 4] * output[np.arange(len(output)), 5 + classes]
        centres, sizes = output[:, :2], output[:, 2:4]
        # A raw centre is an offset of about one cell; decoded centres are spread over the input.
        if np.median(np.abs(centres[:, 0])) < self._width / 8.0:
            cells, strides = self._anchors()
            centres = (centres + cells) * strides
            sizes = np.exp(np.clip(sizes, -20.0, 20.0)) * strides
        keep = scores >= self.config.score_threshold
        half = sizes[keep] / 2.0
        corners = np.concatenate([centres[keep] - half, centres[keep] + half], axis=1)
        return RawBoxes(corners, scores[keep], classes[keep])

    def _anchors(self) -> tuple[Float64[np.ndarray, "anchors 2"], Float64[np.ndarray, "anchors 1"]]:
        """Cell ``(x, y)`` and stride of every output row."""
        cells, strides = [], []
        for stride in _STRIDES:
            y, x = np.mgrid[: self._height // stride, : self._width // stride]
            cells.append(np.stack([x.ravel(), y.ravel()], axis=1).astype(np.float64))
            strides.append(np.full((x.size, 1), float(stride)))
        return np.concatenate(cells), np.concatenate(strides)

    def _output_shapes(self) -> list[tuple[int, ...]]:
        cells = sum((self._height // stride) * (self._width // stride) for stride in _STRIDES)
        return [(1, cells, 5 + len(self.config.classes))]
