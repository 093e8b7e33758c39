"""An answer that comes piece by piece, as server-sent events, put together to a whole one.

Source: OpenAI's "Chat completion chunk object" and WHATWG's "Server-sent events"; llama.cpp sends
its progress with the prompt besides, and comments (lines that begin with a colon) as signs of life.
"""

import json
from typing import Any

from hypernav.search.models.chat.message_parts import read_content

CHUNK = "chat.completion.chunk"
_END = b"data: [DONE]"
_TEXTS = ("reasoning", "reasoning_content", "thinking", "refusal")


def joined(body: bytes) -> dict[str, Any]:
    """The completion that a stream of events holds, or the error that it ends with.

    Args:
        body: The whole stream.

    Returns:
        A completion in OpenAI's form, whose ``object`` is still that of a chunk.

    Raises:
        ValueError: An event is not a JSON object, or the stream breaks off before its end.
    """
    whole: dict[str, Any] = {"object": CHUNK, "choices": [], "usage": None}
    choice: dict[str, Any] = {"index": 0, "message": {"content": ""}, "finish_reason": None}
    for event in _events(body):
        if event.get("error") or event.get("object") == "error":
            return event
        whole["usage"] = event.get("usage") or whole["usage"]
        choices = event.get("choices")
        piece = choices[0] if isinstance(choices, list) and choices else None
        if isinstance(piece, dict) and not piece.get("index"):
            whole["choices"] = [choice]
            whole["usage"] = piece.get("usage") or whole["usage"]
            _add(choice, piece)
    if choice["finish_reason"] is None and _END not in body:
        raise ValueError("the stream breaks off before the end of the answer")
    return whole


def _events(body: bytes) -> list[dict[str, Any]]:
    lines = [line[5:].strip() for line in body.splitlines() if line.startswith(b"data:")]
    events = [json.loads(line) for line in lines if line and line != b"[DONE]"]
    if not all(isinstance(event, dict) for event in events):
        raise ValueError("an event of the stream is no JSON object")
    return events


def _add(choice: dict[str, Any], piece: dict[str, Any]) -> None:
    """Add a piece to the choice, in place."""
    message, delta = choice["message"], piece.get("delta") or piece.get("message")
    if isinstance(delta, dict):
        message["content"] += read_content(delta.get("content"))
        for name in _TEXTS:
            if isinstance(delta.get(name), str):
                message[name] = message.get(name, "") + delta[name]
    logprobs = piece.get("logprobs")
    content = logprobs.get("content") if isinstance(logprobs, dict) else None
    if isinstance(content, list):
        choice.setdefault("logprobs", {"content": []})["content"] += content
    for name in ("finish_reason", "error"):
        choice[name] = piece.get(name) or choice.get(name)
