"""Open-vocabulary detectors: Grounding DINO, MM-Grounding-DINO, LLMDet, OWLv2.

Source: huggingface.co/docs/transformers, ``AutoModelForZeroShotObjectDetection``; Grounding DINO
expects lower-case text, OWLv2 was trained on "a photo of a …".
"""

from hypernav.core.components.registry import require
from hypernav.core.errors import ModelError
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import label_for
from hypernav.core.observation import Observation
from hypernav.search.models.config import ZeroShotConfig
from hypernav.search.models.network_loading import (
    EXTRA,
    choose_device,
    choose_dtype,
    load_network,
    load_pretrained,
    moved_to_device,
)

_MIN_SIDE_PX = 4.0
"""Boxes with a shorter side are dropped."""


class ZeroShotDetector:
    """Detects objects of any name."""

    def __init__(self, path: str, config: ZeroShotConfig | None = None) -> None:
        """Load a model from disk.

        Args:
            path: A folder, or the id of a model in the local Hugging Face cache.
            config: Thresholds, device and dtype.

        Raises:
            MissingExtraError: torch or transformers is not installed.
            ModelError: There are no such weights here, they are no such detector, or there is no
                room for them.
        """
        self.config = config or ZeroShotConfig()
        self._torch = require("torch", extra=EXTRA)
        self._path = path
        self._device = choose_device(self.config.device)
        self._dtype = choose_dtype(self._device, self.config.dtype)
        self._model = load_network(
            "AutoModelForZeroShotObjectDetection", path, self._device, self._dtype
        )
        self._processor = load_pretrained("AutoProcessor", path)
        if not hasattr(self._processor, "post_process_grounded_object_detection"):
            raise ModelError(f"'{path}' has no processor for text and boxes")

    @property
    def name(self) -> str:
        """Name in traces and reports."""
        return f"zero-shot:{self._path}"

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        """All things that fit the goal's text, best first."""
        height, width = observation.rgb.shape[:2]
        inputs = self._processor(
            images=observation.rgb, text=[[self._text(goal)]], return_tensors="pt"
        )
        with self._torch.inference_mode():
            outputs = self._model(**moved_to_device(inputs, self._device, self._dtype))
        for exact in ("logits", "pred_boxes"):  # bfloat16 has only 256 edges in an image
            outputs[exact] = outputs[exact].float()
        (found,) = self._processor.post_process_grounded_object_detection(
            outputs,
            threshold=self.config.score_threshold,
            target_sizes=[(height, width)],
            **({"input_ids": inputs["input_ids"]} if self._is_grounding_dino else {}),
        )
        detections = []
        for score, corners in zip(found["scores"].tolist(), found["boxes"].tolist(), strict=True):
            box = Box(*corners).clipped(width, height)
            if min(box.x_max - box.x_min, box.y_max - box.y_min) >= _MIN_SIDE_PX:
                detections.append(Detection(box, min(max(score, 0.0), 1.0), label_for(goal)))
        return sorted(detections, key=lambda detection: -detection.score)

    @property
    def _is_grounding_dino(self) -> bool:
        return "grounding-dino" in str(self._model.config.model_type)

    def _text(self, goal: Goal) -> str:
        name = goal.text.strip().lower()
        return name if self._is_grounding_dino else f"a photo of a {name}"
