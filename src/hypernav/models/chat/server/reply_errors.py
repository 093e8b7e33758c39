"""What a server's refusal means, by its status and its own words.

Refusals come with a status of HTTP, or with status 200 and ``{"error": …}`` as the body (LM Studio,
OpenRouter and other proxies, which answer before they know how it ends). Each becomes one of our
errors: passing ones (asked again), refusals of this question, and wrong URLs, keys or models.
"""

import json
import math
import re
from http import HTTPStatus
from typing import Any

from hypernav.core.errors import ChatError, ModelRejectedError, ModelSetupError
from hypernav.core.network.bounded_http import Reply
from hypernav.models.chat.answer_parsing import shortened
from hypernav.models.chat.server.retry import RetryLaterError

_RETRYABLE_STATUSES = {408, 409, 425, 429}
_REFUSING_STATUSES = {400, 413, 422, 501}
LONGEST_MESSAGE = 1000
"""Characters of a server's words that are shown: proxies wrap the reason in several layers."""
_MOST_LAYERS = 8

CONTEXT = re.compile(
    r"context (?:size|length|window)|context_length_exceeded|exceed_context|maximum context|n_ctx",
    re.I,
)
_NO_VISION = re.compile(
    r"image input is not supported|mmproj|does not support (?:image|vision|multimodal)"
    r"|support image input|vision add-on|not a multimodal model|unknown variant `image_url`"
    r"|image_url is only supported|unexpected image",
    re.I,
)
_PASSING = re.compile(
    r"rate.?limit|overloaded|temporar|try again|retry|time[ds]?.?out|unavailable|loading model"
    r"|busy|capacity|too many requests|internal.server.error|server_error",
    re.I,
)
_WRONG_ADDRESS = re.compile(r"unexpected endpoint|unknown endpoint|route .*not found", re.I)
_USED_UP = re.compile(r"insufficient_quota|credit balance|billing_hard_limit", re.I)
_CHOOSE_ANOTHER = "this model cannot see, choose another (llama.cpp: serve it with its --mmproj)"
_ADVICE = (
    (
        CONTEXT,
        "the question with its images needs a larger context than the server has: serve with one "
        "(llama.cpp: -c 16384, vLLM: --max-model-len 16384, Ollama: OLLAMA_CONTEXT_LENGTH=16384)",
    ),
    (
        re.compile(r"at most \d+ image", re.I),
        "serve with more images per question (vLLM: --limit-mm-per-prompt '{\"image\": 8}')",
    ),
    (
        re.compile(r"api.?version", re.I),
        "Azure: end the URL in /openai/v1, or in /openai/deployments/NAME?api-version=VERSION",
    ),
)


class RefusedError(ModelRejectedError):
    """A server understands the address but not the request.

    Attributes:
        status: Status of HTTP; 200 if the error came in the body of a good reply.
    """

    def __init__(self, message: str, *, status: int = 400, remedy: str = "") -> None:
        """Keep the status."""
        super().__init__(message, remedy=remedy)
        self.status = status


class NotFoundError(ModelSetupError):
    """The server has nothing at this address, or no such model (404)."""


def error_of_status(reply: Reply, where: str) -> ChatError:
    """The error that a reply with a status other than 2xx means.

    Args:
        reply: The reply; keys that it repeats are removed already.
        where: Address that was asked, for the message.
    """
    body = _json(_text(reply))
    said = _message(body) or _text(reply).strip() or _reason_phrase(reply.status)
    return _error(reply.status, said, f"{where} answered {reply.status}", reply, body)


def error_in_body(reply: Reply, body: dict[str, Any], where: str) -> ChatError | None:
    """The error that a reply with a good status holds; None if it holds none."""
    choices = body.get("choices")
    choice = choices[0] if isinstance(choices, list) and choices else None
    told = choice.get("error") if isinstance(choice, dict) else None
    if not told and _is_without_answer(choice):
        is_error = body.get("object") == "error" or {"code", "message"} <= body.keys()
        told = (
            body if is_error else body.get("error") or body.get("errors") or body.get("error_msg")
        )
    if not told:
        return None
    said = _message(told) or shortened(json.dumps(told), LONGEST_MESSAGE)
    code = str(told.get("code", "")) if isinstance(told, dict) else ""
    if re.fullmatch(r"[45][0-9]{2}", code):
        status = int(code)
    else:
        kinds = (
            [str(told.get(key, "")) for key in ("type", "code")] if isinstance(told, dict) else []
        )
        words = " ".join([said, *kinds])
        status = 503 if _PASSING.search(words) else 404 if _WRONG_ADDRESS.search(words) else 400
    return _error(status, said, f"{where} answered {reply.status} with an error", reply, told)


def _is_without_answer(choice: object) -> bool:
    """Whether a choice is missing, or empty as those are that proxies add to an error."""
    if not isinstance(choice, dict):
        return True
    message = choice.get("message")
    is_empty = not (isinstance(message, dict) and message.get("content"))
    return is_empty or choice.get("finish_reason") == "error"


def _error(status: int, said: str, what: str, reply: Reply, body: object) -> ChatError:
    message = f"{what}: {shortened(said, LONGEST_MESSAGE)}"
    if _NO_VISION.search(said):  # llama.cpp answers 500, OpenRouter 404, LM Studio 200
        return ModelSetupError(message, remedy=_CHOOSE_ANOTHER)
    if status == 429 and _USED_UP.search(f"{said} {json.dumps(body)}"):
        return ModelSetupError(message, remedy="the account is used up; waiting does not help")
    remedy = next((advice for pattern, advice in _ADVICE if pattern.search(said)), "")
    if status in _REFUSING_STATUSES:
        return RefusedError(message, status=reply.status, remedy=remedy)
    if status in _RETRYABLE_STATUSES or status >= 500 or status < 200:
        return RetryLaterError(message, _retry_after(reply), status=status, remedy=remedy)
    if status < 400:
        target = shortened(reply.headers.get("location", "nowhere"), 240)
        return ModelSetupError(
            f"{what}: the server points to {target}", remedy="write its own URL after openai:"
        )
    if status == 404:
        return NotFoundError(message, remedy=remedy)
    if status in {401, 403}:
        remedy = remedy or "set the environment variable HYPERNAV_API_KEY to the server's key"
    return ModelSetupError(message, remedy=remedy)


def _message(body: object, layers: int = _MOST_LAYERS) -> str:
    """The server's own words: OpenAI's form, FastAPI's, Google's list, or OpenRouter's layers."""
    if layers == 0:
        return ""
    match body:
        case str():
            inner = _json(body) if body.lstrip().startswith("{") else None
            return (_message(inner, layers - 1) if inner is not None else "") or body
        case [dict() as first, *_] if "error" in first:
            return _message(first, layers - 1)
        case list():  # FastAPI: which fields, and what is wrong with them
            told = [one for one in body if isinstance(one, dict) and one.get("msg")]
            return "; ".join(
                f"{'.'.join(map(str, one.get('loc', ())))}: {one['msg']}" for one in told
            )
        case dict():
            found = (body.get(key) for key in ("error", "errors", "message", "detail", "msg"))
            said = next(
                (words for one in found if one and (words := _message(one, layers - 1))), ""
            )
            metadata = body.get("metadata")
            raw = metadata.get("raw") if isinstance(metadata, dict) else None
            param = body.get("param")
            if raw and (deeper := _message(raw, layers - 1)) not in said:
                said = f"{said}: {deeper}" if said else deeper
            if isinstance(param, str) and param and param not in said:
                said = f"{said} ({param})"
            return said
        case _:
            return ""


def _json(text: str) -> object:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return None


def _text(reply: Reply) -> str:
    return reply.body.decode("utf-8", "replace")


def _reason_phrase(status: int) -> str:
    try:
        return HTTPStatus(status).phrase
    except ValueError:
        return "no reason given"


def _retry_after(reply: Reply) -> float | None:
    """Seconds that the server asks to wait; None where it names none, or a date, or nonsense."""
    try:
        wait_s = float(reply.headers.get("retry-after", ""))
    except ValueError:
        return None
    return wait_s if math.isfinite(wait_s) and wait_s >= 0.0 else None
