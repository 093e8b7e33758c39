"""PicoDet: boxes as distributions over distances, exported to ONNX without NMS.

Source: Yu et al., "PP-PicoDet: A Better Real-Time Object Detector on Mobile Devices", 2021; Li et
al., "Generalized Focal Loss", 2020; and the reference code PaddlePaddle/PaddleDetection
(``ppdet/modeling/heads/pico_head.py``, ``configs/picodet/_base_/picodet_416_reader.yml``).
"""

from math import ceil

import cv2
import numpy as np
from jaxtyping import Float32, UInt8

from hypernav.search.models.onnx_detector import OnnxDetector, RawBoxes

_STRIDES = (8, 16, 32, 64)
_BINS = 8  # of a distance
_MEAN = np.array([0.485, 0.456, 0.406], dtype=np.float32)
_DEVIATION = np.array([0.229, 0.224, 0.225], dtype=np.float32)


class PicodetDetector(OnnxDetector):
    """A PicoDet.

    For each stride one output holds the scores of all classes, and one the distances from the
    cell's middle to left, top, right and bottom, each as a distribution over whole numbers of
    strides; a distance is its mean.
    """

    kind = "picodet"
    family = "PicoDet"
    _nms_iou = 0.6  # PicoDet's configuration

    def _blob(
        self, rgb: UInt8[np.ndarray, "height width 3"]
    ) -> tuple[Float32[np.ndarray, "1 3 input_height input_width"], float, float]:
        """The image stretched to the input, in RGB, normalised as ImageNet is."""
        size = (self._width, self._height)
        stretched = cv2.resize(rgb, size, interpolation=cv2.INTER_CUBIC).astype(np.float32)
        normal = (stretched / np.float32(255.0) - _MEAN) / _DEVIATION
        blob = np.ascontiguousarray(normal.transpose(2, 0, 1)[None], dtype=np.float32)
        return blob, self._width / rgb.shape[1], self._height / rgb.shape[0]

    def _decode(self, outputs: list[Float32[np.ndarray, "..."]]) -> RawBoxes:
        found = [
            self._decode_stride(stride, scores[0], distances[0])
            for stride, scores, distances in zip(
                _STRIDES, outputs[: len(_STRIDES)], outputs[len(_STRIDES) :], strict=True
            )
        ]
        return RawBoxes(
            np.concatenate([one.corners for one in found]),
            np.concatenate([one.scores for one in found]),
            np.concatenate([one.classes for one in found]),
        )

    def _decode_stride(
        self,
        stride: int,
        scores: Float32[np.ndarray, "cells classes"],
        distances: Float32[np.ndarray, "cells four_times_bins"],
    ) -> RawBoxes:
        classes = scores.argmax(axis=1)
        best = np.clip(scores[np.arange(len(scores)), classes].astype(np.float64), 0.0, 1.0)
        kept = np.flatnonzero(best >= self.config.score_threshold)
        rows, columns = np.divmod(kept, ceil(self._width / stride))
        middles = (np.stack([columns, rows], axis=1) + 0.5) * stride
        shares = distances[kept].reshape(len(kept), 4, _BINS).astype(np.float64)
        shares = np.exp(shares - shares.max(axis=2, keepdims=True))
        means = (shares @ np.arange(_BINS)) / shares.sum(axis=2)
        low, high = middles - means[:, :2] * stride, middles + means[:, 2:] * stride
        return RawBoxes(np.concatenate([low, high], axis=1), best[kept], classes[kept])

    def _output_shapes(self) -> list[tuple[int, ...]]:
        cells = [ceil(self._height / one) * ceil(self._width / one) for one in _STRIDES]
        return [
            (1, count, values)
            for values in (len(self.config.classes), 4 * _BINS)
            for count in cells
        ]
