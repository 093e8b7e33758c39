"""Configuration of chat models: connection, retries, sampling and image quality."""

from typing import Literal

from pydantic import Field

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


class ChatConfig(RoomConfig):
    """Settings that all chat models share.

    Attributes:
        published_model: Vision-language model of the published method (paper: QwenVL-7B). Results
            and reports name it beside the model in use, unless this has its name.
        timeout_s: Longest wait for one attempt, during which a robot stands still.
        patience_s: Time after which an unanswered question is given up. Failed attempts are
            repeated until then; 0 asks once.
        first_wait_s: Wait between the first two attempts; doubled each time.
        longest_wait_s: Longest wait between two attempts. A server's own ``Retry-After`` is cut to
            it, too.
        dialect: API dialect in which the server accepts a set of allowed answers; "auto" detects
            it.
        temperature: Sampling temperature; 0 is the most repeatable. None leaves it to the server,
            which some hosted reasoning models require.
        seed: Seed for servers that sample. None sends none.
        logprobs: Whether to request the probabilities of allowed answers.
        decisions: Whether to use the server's decision endpoint, if it has one, which answers
            closed questions with a probability for every allowed answer.
        jpeg_quality: JPEG quality of the images that are sent (colour is not subsampled).
        device: Device of a model in this process: "auto", "cpu", "cuda", "cuda:1", "mps".
        dtype: Number format of a model in this process: "auto" is bfloat16 where supported.
    """

    published_model: str = ""
    timeout_s: float = Field(default=60.0, gt=0.0, le=86_400.0)
    patience_s: float = Field(default=120.0, ge=0.0, le=86_400.0)
    first_wait_s: float = Field(default=0.5, ge=0.0, le=3600.0)
    longest_wait_s: float = Field(default=8.0, gt=0.0, le=3600.0)
    dialect: Literal["auto", DialectName] = "auto"
    temperature: float | None = Field(default=0.0, ge=0.0, le=10.0)
    seed: int | None = Field(default=0, ge=0, le=MOST_SEED)
    logprobs: bool = True
    decisions: bool = True
    jpeg_quality: int = Field(default=95, ge=1, le=100)
    device: str = "auto"
    dtype: Literal["auto", "bfloat16", "float16", "float32"] = "auto"
