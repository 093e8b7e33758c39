"""Parts of messages: images as they are sent, and the fields of a reply, checked."""

import base64
import hashlib
import json
import math
from typing import Any

import cv2
import numpy as np

from hypernav.core.chat import Image, Usage
from hypernav.core.errors import ModelError

_MOST_TOKENS = 10_000_000
"""More than any model's context; a larger count is an error of the server."""


def jpeg_bytes(image: Image, *, quality: int = 95) -> bytes:
    """The image as a JPEG file without colour subsampling."""
    done, data = cv2.imencode(
        ".jpg",
        image[..., ::-1],
        [
            cv2.IMWRITE_JPEG_QUALITY,
            quality,
            cv2.IMWRITE_JPEG_SAMPLING_FACTOR,
            cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444,
        ],
    )
    if not done:
        raise ModelError(f"an image of {image.shape} could not be encoded as JPEG")
    return data.tobytes()


def jpeg_base64(image: Image, *, quality: int = 95) -> str:
    """The JPEG file in base64."""
    return base64.b64encode(jpeg_bytes(image, quality=quality)).decode("ascii")


def jpeg_data_url(image: Image, *, quality: int = 95) -> str:
    """The JPEG file as a data URL, the form in which chat APIs take images."""
    return f"data:image/jpeg;base64,{jpeg_base64(image, quality=quality)}"


def content_hash(image: Image) -> str:
    """Hash of an image, equal exactly when size and all pixels are equal."""
    pixels = np.ascontiguousarray(image)
    digest = hashlib.sha256(f"{pixels.shape[1]}x{pixels.shape[0]}:".encode())
    digest.update(pixels.tobytes())
    return digest.hexdigest()


def finite_number(value: object) -> float | None:
    """A JSON number as a float; None if it is not a number, not finite, or too large."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if math.isfinite(number) else None


def read_usage(value: object) -> Usage:
    """Token counts by the names of either API; 0 if missing or impossible."""
    if not isinstance(value, dict):
        return Usage()
    return Usage(
        _tokens(value.get("prompt_tokens", value.get("input_tokens"))),
        _tokens(value.get("completion_tokens", value.get("output_tokens"))),
    )


def _tokens(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        return 0
    return value if 0 <= value <= _MOST_TOKENS else 0


def read_content(content: Any) -> str:
    """Text of a message: a string, or a list of parts of which those with text are joined."""
    if isinstance(content, str):
        return content
    parts = content if isinstance(content, list) else []
    texts = [part.get("text") for part in parts if isinstance(part, dict) and not _thinks(part)]
    return "".join(text for text in texts if isinstance(text, str))


def read_reasoning(message: dict[str, Any]) -> str:
    """Thoughts that a server tells apart from the answer; never an answer."""
    for name in ("reasoning", "reasoning_content", "thinking"):
        if isinstance(message.get(name), str) and message[name].strip():
            return message[name]
    content = message.get("content")
    parts = content if isinstance(content, list) else []
    thoughts = [part for part in parts if isinstance(part, dict) and _thinks(part)]
    return json.dumps(thoughts) if thoughts else ""


def thinking_tokens(usage: object) -> int:
    """Tokens that went into thinking; 0 where the server doesn't tell.

    Gemini's compatible endpoint counts them in the total alone.
    """
    if not isinstance(usage, dict):
        return 0
    details = usage.get("completion_tokens_details")
    told = _tokens(details.get("reasoning_tokens")) if isinstance(details, dict) else 0
    known = read_usage(usage)
    hidden = _tokens(usage.get("total_tokens")) - known.tokens_in - known.tokens_out
    return told or (max(hidden, 0) if known.tokens_in else 0)


def _thinks(part: dict[str, Any]) -> bool:
    """Whether a part of a message is no part of the answer: only texts are."""
    return bool(part.get("thought")) or str(part.get("type", "text")) not in {"text", "output_text"}
