"""Segmentation by box or point with the SAM family, through transformers.

The Auto class selects the model for each checkpoint: SAM and SlimSAM (``SamModel``), SAM 2
(``Sam2Model``), EdgeTAM (``EdgeTamModel``), HQ-SAM (``SamHQModel``). All but SAM need torchvision
for their images.

Source: Kirillov et al., "Segment Anything", 2023; huggingface.co/docs/transformers/model_doc/sam.
"""

from typing import Any, Literal

import numpy as np
from jaxtyping import Bool

from hypernav.core.components.extras import require
from hypernav.core.config import RoomConfig
from hypernav.core.errors import ModelError
from hypernav.core.geometry.boxes import Box
from hypernav.core.observation import Observation
from hypernav.models.torch_device import (
    EXTRA,
    choose_device,
    choose_dtype,
    load_network,
    load_pretrained,
    moved_to_device,
)


class SamConfig(RoomConfig):
    """How a SAM model is used.

    Attributes:
        device: "auto", "cpu", "cuda", "mps".
        dtype: "auto" is bfloat16 if the device supports it.
    """

    device: str = "auto"
    dtype: Literal["auto", "bfloat16", "float16", "float32"] = "auto"


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
