"""What a server's refusal means, by its status and its own words, and when it is asked again.

Refusals come with a status of HTTP, or with status 200 and words instead of an answer as the body
(LM Studio, OpenRouter and other proxies, which answer before they know how it ends). Gateways also
answer 500 where a key or a model is wrong. Each becomes one of our errors: passing ones (asked
again), refusals of this question, and wrong URLs, keys or models.
"""

import json
import logging
import math
import re
import time
from collections import Counter
from collections.abc import Callable, Iterator
from http import HTTPStatus
from typing import Any, TypeVar

from hypernav.core.errors import (
    ChatError,
    ChatTimeoutError,
    ChatTransportError,
    ModelRejectedError,
    ModelSetupError,
    ModelUnavailableError,
)
from hypernav.io.bounded_http import Deadline, Reply
from hypernav.search.models.chat.answer_parsing import shortened
from hypernav.search.models.chat.config import ChatConfig

_Result = TypeVar("_Result")
_log = logging.getLogger(__name__)
_LEAST_S = 0.001
"""Time that must be left for another attempt, seconds: waits add up with rounding errors."""

_RETRYABLE_STATUSES = {408, 409, 425, 429, 498, 499}
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
    r"rate.?limit|overloaded|temporar|try again|retry|time[ds]?.?out|unavailable|loading"
    r"|restarting|busy|capacity|too many requests|internal.server.error|server_error",
    re.I,
)
_LOADING = re.compile(r"loading (?:the )?model|models? (?:is |are )?(?:still |being )*load", re.I)
_RATE = re.compile(r"rate.?limit|per.?(?:second|minute|hour)|retry|try again", re.I)
_USED_UP = re.compile(
    r"insufficient_quota|exceeded_current_quota|credit balance|billing_hard_limit"
    r"|insufficient (?:credits?|balance|funds)",
    re.I,
)
_NO_CREDIT = re.compile(
    r"payment required|(?:out of|not enough|no) credits?\b|insufficient quota|in arrears"
    r"|quota (?:is |was |has been )?(?:exhausted|exceeded|used up)"
    r"|(?:exceeded|exhausted|used up) (?:your |the )?(?:\w+ )?quota",
    re.I,
)
_WRONG_KEY = re.compile(
    r"(?:invalid|incorrect|wrong|missing|expired|unknown|no|provide an?)[\s_]"
    r"(?:auth\w*[\s_])?(?:api.?key|(?:access|auth\w*|bearer|api).token|credentials)"
    r"|api.?key\b.{0,60}?\b(?:not valid|invalid|incorrect|expired|missing|required|not found)"
    r"|\binvalid key\b(?!\s*(?:['\"`:]|in\b|for\b|of\b))"
    r"|unauthori[sz]ed|unauthenticated|not authenticated|authentication (?:failed|required)",
    re.I,
)
_WRONG_MODEL = re.compile(
    r"model_not_found|\b(?:no such|unknown) model\b|invalid model (?:name|id)\b|not a valid model"
    r"|\bmodels?\b(?:[:/ ]+\S{1,120})?[ ,]+(?:(?:is|was|could|can) ?)?"
    r"(?:not (?:be )?(?:found|exist)|does(?: not|n't) exist)",
    re.I,
)
_WRONG_ADDRESS = re.compile(r"unexpected endpoint|unknown endpoint|route .*not found", re.I)
_INNER = ("error", "errors", "message", "detail", "msg", "error_msg")
"""Names under which servers put their words, or an object that holds them."""
_CODES = ("code", "status", "status_code", "statusCode")
_RESULTS = ("choices", "data", "answers")
_MOST_WORDS = 10_000
"""Characters of an error in which its meaning is searched."""
NEEDS_LOGIN = (
    "the proxy wants a login: write it into the proxy's URL in the environment, as in "
    "https_proxy=http://NAME:PASSWORD@HOST:PORT"
)
_CHOOSE_ANOTHER = "this model cannot see, choose another (llama.cpp: serve it with its --mmproj)"
_ADVICE = (
    (
        CONTEXT,
        "the question with its images needs a larger context than the server has: serve with one "
        "(llama.cpp: -c 16384, vLLM: --max-model-len 16384, Ollama: OLLAMA_CONTEXT_LENGTH=16384)",
    ),
    (
        _LOADING,
        "wait: the server is up and loads its model; its log shows how far it is",
    ),
    (
        re.compile(r"at most \d+ image", re.I),
        "serve with more images per question (vLLM: --limit-mm-per-prompt '{\"image\": 8}')",
    ),
    (
        re.compile(r"api.?version", re.I),
        "Azure: end the URL in /openai/v1, or in /openai/deployments/NAME?api-version=VERSION",
    ),
    (
        re.compile(r"no endpoints found", re.I),
        "no provider takes this question for this model: choose another model, or allow more "
        "providers in the settings of the account",
    ),
)
_ADVICE_BY_STATUS = {
    401: "set the environment variable HYPERNAV_API_KEY to the server's key",
    402: "the account has no credit for this, and waiting does not help: add some, or take another "
    "key or model",
    403: "set the environment variable HYPERNAV_API_KEY to the server's key",
    407: NEEDS_LOGIN,
    503: "wait: the server is up, but cannot answer now; its log says why",
}


class RetryLaterError(ChatTransportError):
    """A server that is reachable but cannot answer now; it may say how long to wait.

    Attributes:
        wait_s: Wait that the server asks for; None if it does not say.
        status: HTTP status code.
    """

    def __init__(
        self, message: str, wait_s: float | None = None, *, status: int = 503, remedy: str = ""
    ) -> None:
        """Store wait and status with the message."""
        super().__init__(message, remedy=remedy)
        self.wait_s = wait_s
        self.status = status


class Retry:
    """Repeats lost or timed-out attempts until one succeeds or ``patience_s`` has passed.

    Of the waits between attempts the first is ``first_wait_s`` and each is twice the one before,
    up to ``longest_wait_s``.
    """

    def __init__(
        self,
        config: ChatConfig,
        *,
        sleep: Callable[[float], None] = time.sleep,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Prepare.

        Args:
            config: Timeouts, waits and ``patience_s``.
            sleep: Function that waits for a number of seconds.
            clock: Function that returns monotonic seconds.
        """
        self._config = config
        self._sleep = sleep
        self._clock = clock

    def begin(self) -> Deadline:
        """The deadline for a question that is asked now."""
        return Deadline(self._config.patience_s, self._clock)

    def call(
        self, attempt: Callable[[Deadline], _Result], *, who: str, patience: Deadline
    ) -> tuple[_Result, Counter[str]]:
        """Attempt until one succeeds.

        Args:
            attempt: Function of one attempt; takes the moment at which it has to be over.
            who: Name of the server, for messages.
            patience: Result of `begin`; all that belongs to one question shares it.

        Returns:
            The result, and how many attempts before it were lost to "transport" and "timeout".

        Raises:
            ModelUnavailableError: No attempt succeeded within ``patience_s``. Where the last one
                ended without a word, its message has the last words of the server besides.
        """
        config = self._config
        wait = config.first_wait_s
        lost: Counter[str] = Counter()
        told: ChatTransportError | None = None
        while True:
            is_patient = config.patience_s > 0.0
            limit_s = config.timeout_s
            try:
                within = patience.within(limit_s) if is_patient else Deadline(limit_s, self._clock)
                return attempt(within), lost
            except (ChatTransportError, ChatTimeoutError) as error:
                lost["timeout" if isinstance(error, ChatTimeoutError) else "transport"] += 1
                told = error if isinstance(error, ChatTransportError) else told
                asked_for = error.wait_s if isinstance(error, RetryLaterError) else None
                # A server may ask for a longer wait than ours, never for a shorter one.
                pause = min(max(wait, asked_for or 0.0), config.longest_wait_s)
                if pause + _LEAST_S >= patience.seconds_left:
                    attempts = lost.total()
                    times = f"{attempts} {'attempt' if attempts == 1 else 'attempts'}"
                    if config.patience_s > 0.0:
                        times += f" within a patience of {config.patience_s:g} s"
                    before = "" if told in (None, error) else f"; before that: {told}"
                    unavailable = ModelUnavailableError(
                        f"{who} gave no answer in {times}; last: {error}{before}"
                    )
                    # The message has it already.
                    unavailable.remedy = error.remedy or (told.remedy if told else "")
                    raise unavailable from error
                _log.warning(
                    "%s; asking again in %.1f s (attempt %d)", error, pause, lost.total() + 1
                )
                self._sleep(pause)
                wait = min(wait * 2.0, config.longest_wait_s)


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


def error_in_body(reply: Reply, body: object, where: str) -> ChatError | None:
    """The error that a reply with a good status holds; None if it holds none.

    Args:
        reply: The reply.
        body: Its JSON; None if it is none.
        where: Address that was asked, for the message.
    """
    what = f"{where} answered {reply.status} with an error"
    if not isinstance(body, dict | list):  # words alone count only where they say what is wrong
        said = _text(reply).strip()
        is_known = _meaning(200, body, said) in _ADVICE_BY_STATUS.keys() | {404}
        return _error(200, said, what, reply, body) if is_known else None
    fields: dict[str, Any] = body if isinstance(body, dict) else {}
    choices = fields.get("choices")
    choice = choices[0] if isinstance(choices, list) and choices else None
    told = choice.get("error") if isinstance(choice, dict) else None
    if not told and _is_without_answer(choice):
        told = fields.get("error") or fields.get("errors") or fields.get("error_msg")
        is_result = any(fields.get(name) for name in _RESULTS)
        is_error = fields.get("object") == "error" or (not is_result and _message(body))
        told = body if is_error and not told else told
    if not told:
        return None
    said = _message(told) or shortened(json.dumps(told), LONGEST_MESSAGE)
    return _error(200, said, what, reply, told)


def _is_without_answer(choice: object) -> bool:
    """Whether a choice is missing, or empty as those are that proxies add to an error."""
    if not isinstance(choice, dict):
        return True
    message = choice.get("message")
    is_empty = not (isinstance(message, dict) and message.get("content"))
    return is_empty or choice.get("finish_reason") == "error"


def _error(http_status: int, said: str, what: str, reply: Reply, body: object) -> ChatError:
    message, said = f"{what}: {shortened(said, LONGEST_MESSAGE)}", said[:_MOST_WORDS]
    if _NO_VISION.search(said):  # llama.cpp answers 500, OpenRouter 404, LM Studio 200
        return ModelSetupError(message, remedy=_CHOOSE_ANOTHER)
    status = _meaning(http_status, body, said)
    remedy = next((advice for pattern, advice in _ADVICE if pattern.search(said)), "")
    remedy = remedy or _ADVICE_BY_STATUS.get(status, "")
    if status in _REFUSING_STATUSES:
        return RefusedError(message, status=http_status, remedy=remedy)
    if status in _RETRYABLE_STATUSES or status >= 500 or status < 200:
        return RetryLaterError(message, _retry_after(reply), status=status, remedy=remedy)
    if status < 400:
        target = shortened(reply.headers.get("location", "nowhere"), 240)
        return ModelSetupError(
            f"{what}: the server points to {target}", remedy="write its own URL after openai:"
        )
    kind = NotFoundError if status == 404 else ModelSetupError
    return kind(message, remedy=remedy)


def _meaning(status: int, body: object, said: str) -> int:
    """The status that an error has by its own code and words, where HTTP's status says little."""
    layers = list(_layers(body))
    codes = [str(layer.get(key, "")) for layer in layers for key in _CODES]
    if status < 300 or status >= 500:
        status = next((int(code) for code in codes if re.fullmatch("[45][0-9]{2}", code)), status)
    if status == 501:  # never an outage, whatever words come with it
        return status
    kinds = [str(layer.get("type", "")) for layer in layers]
    words = " ".join([said[:_MOST_WORDS], *kinds, *codes])[: 2 * _MOST_WORDS]
    if status == 429:  # a limit per minute, unless it says more
        return 402 if _USED_UP.search(words) else status
    if 300 <= status < 500 and status not in {400, 422}:
        return status
    if status >= 500 and _PASSING.search(said):
        return status
    if _USED_UP.search(words) or (_NO_CREDIT.search(words) and not _RATE.search(words)):
        return 402
    if _WRONG_KEY.search(words):
        return 401
    if _WRONG_MODEL.search(words) or _WRONG_ADDRESS.search(words):
        return 404
    if status == 200:
        return 503 if _PASSING.search(words) else 400
    return status


def _layers(body: object) -> Iterator[dict[str, Any]]:
    """The objects that an error consists of, from the outermost."""
    for _ in range(_MOST_LAYERS):
        if isinstance(body, str):
            body = _json(body) if body.lstrip().startswith("{") else None
        if isinstance(body, list):
            body = body[0] if body else None
        if not isinstance(body, dict):
            return
        yield body
        body = next((body[key] for key in _INNER if body.get(key)), None)


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
            found = (body.get(key) for key in _INNER)
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
