"""Similarity of an image and a text: CLIP, SigLIP, SigLIP 2 and BLIP-2's two heads.

Sources: Radford et al. 2021 (CLIP: cosine of two embeddings), Zhai et al. 2023 (SigLIP: a
probability by a sigmoid; its text is padded to 64 tokens, as it was trained), Li et al. 2023
(BLIP-2: image-text matching, a probability, and image-text contrast, a cosine).
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Float32

from hypernav.core.chat import Image
from hypernav.core.components.registry import require
from hypernav.core.errors import ModelError
from hypernav.search.models.config import SimilarityConfig, SimilarityScorerConfig
from hypernav.search.models.network_loading import (
    EXTRA,
    choose_device,
    choose_dtype,
    load_network,
    load_pretrained,
    moved_to_device,
)

_SIGLIP_TOKENS = 64
_NO_TEXT = ("",)
_NO_IMAGE = np.zeros((32, 32, 3), np.uint8)


class ImageTextSimilarity:
    """Compares images with texts."""

    def __init__(self, path: str, config: SimilarityConfig | None = None) -> None:
        """Load a model from disk.

        Args:
            path: A folder, or the id of a model in the local Hugging Face cache.
            config: Device and dtype.

        Raises:
            MissingExtraError: torch or transformers is not installed.
            ModelError: There are no such weights here, they compare nothing, or there is no room
                for them.
        """
        config = config or SimilarityConfig()
        self._torch = require("torch", extra=EXTRA)
        self._device = choose_device(config.device)
        self._dtype = choose_dtype(self._device, config.dtype)
        self._kind = str(load_pretrained("AutoConfig", path).model_type)
        if self._kind not in {"clip", "siglip", "siglip2", "blip-2"}:
            raise ModelError(
                f"'{path}' is a '{self._kind}' model; expected CLIP, SigLIP, SigLIP 2 or BLIP-2"
            )
        blip2 = self._kind == "blip-2"
        auto_class = "Blip2ForImageTextRetrieval" if blip2 else "AutoModel"
        self._model = load_network(auto_class, path, self._device, self._dtype)
        self._processor = load_pretrained("AutoProcessor", path)
        self._matches = config.head == "itm"
        self._path = path

    def similarity(self, image: Image, text: str) -> float:
        """Similarity from 0 (none) to 1; comparable only between answers of the same model."""
        with self._torch.inference_mode():
            outputs = self._run(self._inputs(image, (text,)))
        return min(max(outputs, 0.0), 1.0)

    def image_vectors(self, image: Image) -> Float32[np.ndarray, "n size"]:
        """Unit vectors of an image: one, or BLIP-2's several, of which the best one counts.

        Raises:
            ModelError: The model's head has no vectors.
        """
        return self._vectors(image, _NO_TEXT)[0]

    def text_vectors(self, texts: Sequence[str]) -> Float32[np.ndarray, "texts size"]:
        """Unit vector of each text.

        Raises:
            ModelError: The model's head has no vectors.
        """
        return self._vectors(_NO_IMAGE, texts)[1]

    def _vectors(self, image: Image, texts: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
        """The vectors of an image, and of texts: neither depend on the other side."""
        if self._kind == "blip-2" and self._matches:
            raise ModelError(
                f"'{self._path}' with its head \"itm\" compares pairs of an image and a text, and "
                'has no vectors of either; use the head "itc"'
            )
        with self._torch.inference_mode():
            outputs = self._model(**self._inputs(image, texts))
        of_image, of_texts = (
            one.float().reshape(-1, one.shape[-1]).cpu().numpy()
            for one in (outputs.image_embeds, outputs.text_embeds)
        )
        return of_image, of_texts

    def _inputs(self, image: Image, texts: Sequence[str]) -> dict[str, Any]:
        siglip = self._kind.startswith("siglip")
        length = {"padding": "max_length", "max_length": _SIGLIP_TOKENS} if siglip else {}
        inputs = self._processor(
            images=image,
            text=list(texts),
            return_tensors="pt",
            truncation=True,
            **({"padding": True} | length),
        )
        return moved_to_device(inputs, self._device, self._dtype)

    def _run(self, inputs: dict[str, Any]) -> float:
        if self._kind == "blip-2":
            outputs = self._model(**inputs, use_image_text_matching_head=self._matches)
            logits = outputs.logits_per_image.float()
            return float(logits.softmax(-1)[0, 1] if self._matches else logits[0, 0])
        outputs = self._model(**inputs)
        if self._kind == "clip":
            cosine = (outputs.image_embeds * outputs.text_embeds).float().sum()
            return float((cosine + 1.0) / 2.0)
        return float(outputs.logits_per_image.float().sigmoid()[0, 0])


def load_similarity(path: str, config: SimilarityScorerConfig | None = None) -> ImageTextSimilarity:
    """Load a model that compares images with texts.

    Args:
        path: A folder, or the id of a model in the local Hugging Face cache.
        config: Use of the model; the sentence is for scores of views.

    Raises:
        MissingExtraError: torch or transformers is not installed.
        ModelError: There are no such weights, or they compare nothing.
    """
    return ImageTextSimilarity(path, (config or SimilarityScorerConfig()).similarity)
