"""Segmentation by box or point with the SAM family, through transformers or exported to ONNX.

The Auto class selects the model for each checkpoint: SAM and SlimSAM (``SamModel``), SAM 2
(``Sam2Model``), EdgeTAM (``EdgeTamModel``), HQ-SAM (``SamHQModel``). All but SAM need torchvision
for their images.

Source: Kirillov et al., "Segment Anything", 2023; huggingface.co/docs/transformers/model_doc/sam.

In ONNX, for example MobileSAM's, the decoder is the one that the authors of SAM and MobileSAM
export (``SamOnnxModel`` in ``segment_anything/utils/onnx.py``): it takes box corners as two points
with the labels 2 and 3, and a point on the object, with the label 1, together with a point that
pads, with the label -1. The encoder is either the plain image encoder, which expects a normalised
and padded image (``[1, 3, 1024, 1024]``), or one that does that itself (``[height, width, 3]``, 0
to 255).

Source: facebookresearch/segment-anything, ``notebooks/onnx_model_example.ipynb``, and
ChaoningZhang/MobileSAM, ``scripts/export_onnx_model.py``.
"""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from jaxtyping import Bool, Float32

from hypernav.core.chat import Image
from hypernav.core.components.registry import require
from hypernav.core.errors import ModelError
from hypernav.core.geometry.boxes import Box
from hypernav.core.observation import Observation
from hypernav.search.models.config import OnnxSamConfig, SamConfig
from hypernav.search.models.network_loading import (
    EXTRA,
    choose_device,
    choose_dtype,
    load_network,
    load_pretrained,
    moved_to_device,
    open_session,
)

_MEAN = np.array([123.675, 116.28, 103.53], dtype=np.float32)
_DEVIATION = np.array([58.395, 57.12, 57.375], dtype=np.float32)
_MASK_SIDE_PX = 256
"""Side of the decoder's mask input, in all exports of SAM and MobileSAM."""
_CORNER_LABELS = np.array([[2.0, 3.0]], dtype=np.float32)
_POINT_LABELS = np.array([[1.0, -1.0]], dtype=np.float32)
_DECODER_INPUTS = {
    "image_embeddings",
    "point_coords",
    "point_labels",
    "mask_input",
    "has_mask_input",
    "orig_im_size",
}


class SamSegmenter:
    """Finds the pixels of the object in a box."""

    def __init__(self, path: str, config: SamConfig | None = None) -> None:
        """Load a model from disk.

        Args:
            path: A folder, or the id of a model in the local Hugging Face cache.
            config: Device and dtype.

        Raises:
            MissingExtraError: torch or transformers is not installed.
            ModelError: There are no such weights here, they are no SAM, or there is no room for
                them.
        """
        self.config = config or SamConfig()
        self._torch = require("torch", extra=EXTRA)
        self._device = choose_device(self.config.device)
        self._dtype = choose_dtype(self._device, self.config.dtype)
        self._model = load_network("AutoModelForMaskGeneration", path, self._device, self._dtype)
        self._processor = load_pretrained("AutoProcessor", path)
        if not hasattr(self._processor, "post_process_masks"):
            raise ModelError(f"'{path}' has no processor for boxes and masks; is it a SAM?")

    def segment(self, observation: Observation, box: Box) -> Bool[np.ndarray, "height width"]:
        """The object's pixels; all False for a box outside the image."""
        height, width = observation.rgb.shape[:2]
        box = box.clipped(width, height)
        if box.area <= 0.0:
            return np.zeros((height, width), dtype=bool)
        corners = [[[box.x_min, box.y_min, box.x_max, box.y_max]]]
        return clipped_to_box(self._mask(observation, input_boxes=corners), box)

    def segment_point(
        self, observation: Observation, x: float, y: float
    ) -> Bool[np.ndarray, "height width"]:
        """The pixels of the object at a point."""
        return self._mask(observation, input_points=[[[[x, y]]]], input_labels=[[[1]]])

    def _mask(self, observation: Observation, **prompt: Any) -> Bool[np.ndarray, "height width"]:
        height, width = observation.rgb.shape[:2]
        inputs = self._processor(images=observation.rgb, return_tensors="pt", **prompt)
        sizes = [inputs.pop("original_sizes")]
        if "reshaped_input_sizes" in inputs:  # SAM and HQ-SAM pad, the later ones don't
            sizes.append(inputs.pop("reshaped_input_sizes"))
        with self._torch.inference_mode():
            outputs = self._model(
                **moved_to_device(inputs, self._device, self._dtype), multimask_output=False
            )
        masks = self._processor.post_process_masks(outputs.pred_masks.float().cpu(), *sizes)
        return masks[0].reshape(-1, height, width)[0].numpy().astype(bool)


def clipped_to_box(
    mask: Bool[np.ndarray, "height width"], box: Box
) -> Bool[np.ndarray, "height width"]:
    """The part of a mask inside a box."""
    x_min, y_min, x_max, y_max = box.pixels()
    inside = np.zeros_like(mask)
    rows, columns = slice(max(y_min, 0), max(y_max, 0)), slice(max(x_min, 0), max(x_max, 0))
    inside[rows, columns] = mask[rows, columns]
    return inside


class OnnxSamSegmenter:
    """Finds the pixels of the object in a box. An image is encoded once for all its boxes."""

    def __init__(
        self, encoder: Path | str, decoder: Path | str, config: OnnxSamConfig | None = None
    ) -> None:
        """Load both networks.

        Raises:
            MissingExtraError: onnxruntime is not installed.
            ModelError: A file is missing, is not an ONNX model, or not part of a SAM.
        """
        self.config = config or OnnxSamConfig()
        self._encoder = open_session(Path(encoder), threads=self.config.threads)
        self._decoder = open_session(Path(decoder), threads=self.config.threads)
        self._check(Path(encoder), Path(decoder))
        self._encoded: tuple[Image, Any] | None = None

    def segment(self, observation: Observation, box: Box) -> Bool[np.ndarray, "height width"]:
        """The object's pixels; all False for a box outside the image."""
        height, width = observation.rgb.shape[:2]
        box = box.clipped(width, height)
        if box.area <= 0.0:
            return np.zeros((height, width), dtype=bool)
        corners = [[box.x_min, box.y_min], [box.x_max, box.y_max]]
        return clipped_to_box(self._mask(observation, corners, _CORNER_LABELS), box)

    def segment_point(
        self, observation: Observation, x: float, y: float
    ) -> Bool[np.ndarray, "height width"]:
        """The pixels of the object at a point."""
        return self._mask(observation, [[x, y], [0.0, 0.0]], _POINT_LABELS)

    def _mask(
        self,
        observation: Observation,
        points: list[list[float]],
        labels: Float32[np.ndarray, "1 points"],
    ) -> Bool[np.ndarray, "height width"]:
        height, width = observation.rgb.shape[:2]
        scale, side = self.config.side_px / max(height, width), _MASK_SIDE_PX
        masks, qualities = self._decoder.run(
            ["masks", "iou_predictions"],
            {
                "image_embeddings": self._embedding(observation.rgb),
                "point_coords": np.array([points], dtype=np.float32) * np.float32(scale),
                "point_labels": labels,
                "mask_input": np.zeros((1, 1, side, side), dtype=np.float32),
                "has_mask_input": np.zeros(1, dtype=np.float32),
                "orig_im_size": np.array([height, width], dtype=np.float32),
            },
        )
        best = int(np.argmax(np.asarray(qualities)[0]))
        mask = np.asarray(masks)[0, best] > 0.0
        if mask.shape != (height, width):
            raise ModelError(
                f"the SAM decoder gave a mask of {mask.shape} for an image of {(height, width)}"
            )
        return mask

    def _embedding(self, image: Image) -> Any:
        if self._encoded is None or self._encoded[0] is not image:
            blob = self._blob(image)
            name = self._encoder.get_inputs()[0].name
            self._encoded = (image, self._encoder.run(None, {name: blob})[0])
        return self._encoded[1]

    def _blob(self, image: Image) -> Float32[np.ndarray, "..."]:
        """The image in the encoder's input format."""
        side = self.config.side_px
        scale = side / max(image.shape[:2])
        size = (round(image.shape[1] * scale), round(image.shape[0] * scale))
        resized = cv2.resize(image, size, interpolation=cv2.INTER_LINEAR).astype(np.float32)
        if len(self._encoder.get_inputs()[0].shape) == 3:
            return resized
        blob = np.zeros((1, 3, side, side), dtype=np.float32)
        normalised = (resized - _MEAN) / _DEVIATION
        blob[0, :, : size[1], : size[0]] = normalised.transpose(2, 0, 1)
        return blob

    def _check(self, encoder: Path, decoder: Path) -> None:
        inputs = self._encoder.get_inputs()
        if len(inputs) != 1 or len(inputs[0].shape) not in {3, 4}:
            found = ", ".join(f"{one.name} {one.shape}" for one in inputs)
            raise ModelError(
                f"{encoder} is not a SAM encoder: expected one image "
                f"[1, 3, {self.config.side_px}, {self.config.side_px}] or [height, width, 3], "
                f"found {found}"
            )
        names = {one.name for one in self._decoder.get_inputs()}
        outputs = {one.name for one in self._decoder.get_outputs()}
        if names != _DECODER_INPUTS or not {"masks", "iou_predictions"} <= outputs:
            raise ModelError(
                f"{decoder} is not a SAM decoder as its authors export it: expected the inputs "
                f"{', '.join(sorted(_DECODER_INPUTS))}, found {', '.join(sorted(names))}"
            )
