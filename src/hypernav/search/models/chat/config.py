"""Configuration of chat models: connection, retries, sampling and image quality."""

import json
from typing import Any, Literal

from pydantic import Field, field_validator

from hypernav.core.config import MOST_SEED, RoomConfig

DialectName = Literal[
    "vllm",
    "vllm-guided",
    "sglang",
    "ollama",
    "llamacpp",
    "openai",
    "transformers",
    "decisions",
    "plain",
]
FamilyName = Literal[
    "qwen2.5-vl",
    "qwen2-vl",
    "qwen3-vl",
    "glm-v",
    "gemini",
    "claude",
    "embodied-r1",
    "molmo",
    "molmo2",
    "paligemma",
    "florence-2",
    "deepseek-vl2",
    "pixels",
    "thousandths",
    "unit",
]

_MOST_EXTRA = 10_000


class ChatConfig(RoomConfig):
    """Settings that all chat models share.

    Attributes:
        published_model: Vision-language model of the published method (paper: QwenVL-7B). Results
            and reports name it beside the model in use, unless this has its family and size.
        timeout_s: Silence after which an attempt is given up, unless the server still answers when
            it is asked for its models; of a model that streams, every piece ends the silence.
        patience_s: Silence after which a question is given up; a robot stands still meanwhile.
            Failed attempts are repeated until then; 0 asks once.
        first_wait_s: Wait between the first two attempts; doubled each time.
        longest_wait_s: Longest wait between two attempts. A server's own ``Retry-After`` is cut to
            it, too.
        dialect: API dialect in which the server accepts a set of allowed answers; "auto" detects
            it.
        temperature: Sampling temperature; 0 is the most repeatable. None leaves it to the server,
            which some hosted reasoning models require.
        seed: Seed for servers that sample. None sends none.
        thinking: Whether the model may think before it answers: "off" and "low" are sent in the
            server's own dialect and checked by what comes back; "auto" leaves it to the model. A
            model that thinks all the same gets room for it.
        extra_body: Fields that every question sends besides, as a JSON object; they come before
            ours of the same name, and are never left out.
        jpeg_quality: JPEG quality of the images that are sent (colour is not subsampled).
        device: Device of a model in this process: "auto", "cpu", "cuda", "cuda:1", "mps".
        dtype: Number format of a model in this process: "auto" is bfloat16 on NVIDIA GPUs
            with it.
    """

    published_model: str = ""
    timeout_s: float = Field(default=60.0, gt=0.0, le=86_400.0)
    patience_s: float = Field(default=120.0, ge=0.0, le=86_400.0)
    first_wait_s: float = Field(default=0.5, ge=0.0, le=3600.0)
    longest_wait_s: float = Field(default=8.0, gt=0.0, le=3600.0)
    dialect: Literal["auto", DialectName] = "auto"
    temperature: float | None = Field(default=0.0, ge=0.0, le=10.0)
    seed: int | None = Field(default=0, ge=0, le=MOST_SEED)
    thinking: Literal["auto", "off", "low"] = "auto"
    extra_body: dict[str, Any] = Field(default_factory=dict)
    jpeg_quality: int = Field(default=95, ge=1, le=100)
    device: str = "auto"
    dtype: Literal["auto", "bfloat16", "float16", "float32"] = "auto"

    @field_validator("thinking", mode="before")
    @classmethod
    def _as_a_word(cls, value: Any) -> Any:
        """YAML reads a bare ``off`` as false."""
        return "off" if value is False else value

    @field_validator("extra_body")
    @classmethod
    def _is_a_request(cls, value: dict[str, Any]) -> dict[str, Any]:
        """Refuse what would change the question, or what JSON cannot hold."""
        ours = sorted({"model", "messages", "stream", "n"} & value.keys())
        if ours:
            raise ValueError(f"'{ours[0]}' is set by the question itself; leave it out")
        try:
            size = len(json.dumps(value, allow_nan=False))
        except (TypeError, ValueError, RecursionError) as error:
            raise ValueError(f"it cannot be sent as JSON ({error})") from error
        if size > _MOST_EXTRA:
            raise ValueError(f"it has {size:,} characters; at most {_MOST_EXTRA:,} are sent")
        return value
