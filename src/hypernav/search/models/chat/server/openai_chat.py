"""Chat models behind an OpenAI-compatible server: vLLM, SGLang, Ollama, llama.cpp, hosted APIs."""

import copy
import json
import logging
import os
import re
import threading
import time
from collections import Counter
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal

from hypernav.core.chat import Answer, Question, Usage
from hypernav.core.errors import (
    ChatError,
    ChatTimeoutError,
    ChatTransportError,
    ModelRejectedError,
    ModelSetupError,
    ModelUnavailableError,
)
from hypernav.io.bounded_http import Deadline
from hypernav.search.models.chat.answer_parsing import final_answer, parse_answer, shortened
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.message_parts import jpeg_data_url, read_usage
from hypernav.search.models.chat.server.answer_probabilities import (
    accepts_question,
    answer_probabilities,
    decision_request,
    parse_decision,
    parse_logprobs,
    tokens_of_answer,
)
from hypernav.search.models.chat.server.dialects import (
    Constraint,
    ServerInfo,
    check_name,
    constraint_for,
    detect_server,
    with_known_models,
    without_decision,
)
from hypernav.search.models.chat.server.http_client import HttpClient
from hypernav.search.models.chat.server.refusals import (
    DECISION,
    LIMIT_NAMES,
    OPTIONAL,
    PROGRESS,
    STREAM,
    TOKEN_LIMIT,
    UNKNOWN,
    Refusals,
    is_of_the_question,
)
from hypernav.search.models.chat.server.reply_errors import (
    LONGEST_MESSAGE,
    RefusedError,
    Retry,
    RetryLaterError,
)
from hypernav.search.models.chat.server.streamed import CHUNK
from hypernav.search.models.chat.server.thinking import (
    ENDLESS,
    PROBES,
    Thinking,
    Written,
    babbles,
    read_written,
    switches,
)

_log = logging.getLogger(__name__)
_DETECTION_LIMIT_S = 10.0
_OF_THOUGHTS = re.compile("think|thought|reason", re.I)
_SLOW_THOUGHTS = "the model thinks long: try --set chat.thinking=off, or a larger chat.timeout_s"


@dataclass(frozen=True)
class _Reply:
    """Reply to one question, before it is checked against the question.

    It is uncounted if it came as a stream that leaves the number of tokens out.
    """

    text: str
    usage: Usage
    probabilities: Mapping[str, float]
    refused: bool
    written: Written | None = None
    is_uncounted: bool = False


@dataclass(frozen=True)
class _Request:
    """What is sent: a body of OpenAI's API, or, without one, the question of a decision."""

    body: Mapping[str, Any]
    constraint: Constraint
    decides: bool


class OpenAiChat:
    """Asks a server over HTTP. Safe to share between threads.

    What a server refuses by name is renamed, made smaller or left out from then on
    (`Refusals`), and a model that thinks before it answers gets room for it (`Thinking`); the
    same question is then asked again at once. Answers are checked here in any case.
    """

    def __init__(
        self,
        url: str,
        model: str | None = None,
        config: ChatConfig | None = None,
        *,
        environment: Mapping[str, str] = os.environ,
        sleep: Callable[[float], None] = time.sleep,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Prepare; the server is first contacted with the first question.

        Args:
            url: URL of the API, for example ``http://localhost:8000/v1``.
            model: Name of the model on the server; None takes the server's only one.
            config: Timeouts, retries, dialect.
            environment: Environment variables, which hold the key.
            sleep: Function that waits for a number of seconds.
            clock: Function that returns monotonic seconds.

        Raises:
            ConfigError: The URL is malformed, or holds a password.
        """
        self.config = config or ChatConfig()
        self._client = HttpClient(url, self.config, environment)
        self._wanted = model
        self._retry = Retry(self.config, sleep=sleep, clock=clock)
        self._clock = clock
        self._server: ServerInfo | None = None
        self._lock = threading.Lock()
        self._refusals = Refusals()
        self._thinking = Thinking(level=self.config.thinking)

    @property
    def url(self) -> str:
        """URL of the API."""
        return self._client.url

    def identify(self) -> str:
        """The model's name on the server.

        Raises:
            ModelUnavailableError: It was not named and the server cannot be asked.
            ModelSetupError: It was not named and cannot be chosen.
        """
        return self._wanted or self.server().model

    @property
    def dropped(self) -> tuple[str, ...]:
        """Fields that the server has refused so far, and that are not sent any more."""
        return self._refusals.dropped

    @property
    def thinking(self) -> Thinking:
        """What is known so far of the model's thinking."""
        return self._thinking

    def with_thinking(self, level: Literal["auto", "off", "low"]) -> "OpenAiChat":
        """The same server with another ``chat.thinking``; what was learned of fields is kept."""
        other = copy.copy(self)
        other.config = self.config.model_copy(update={"thinking": level})
        other._thinking = Thinking(level=level)
        return other

    def server(self) -> ServerInfo:
        """Model and dialect of the server; detected once.

        Raises:
            ModelUnavailableError: It cannot be reached.
            ModelSetupError: URL or key are wrong, or no model can be chosen.
        """
        return self._server_within(self._retry.begin())

    def _server_within(self, patience: Deadline) -> ServerInfo:
        with self._lock:
            if self._server is None:
                self._server, _ = self._retry.call(
                    self._detect_server, who=self._who(), patience=patience
                )
            return self._server

    def ask(self, question: Question) -> Answer:
        """Ask, wait, read and check.

        Raises:
            ModelUnavailableError: The server gave no answer within ``patience_s``,
                or (`ModelRejectedError`) will never accept the request.
            ModelSetupError: URL, key or model are wrong.
        """
        begin = self._clock()
        patience = self._retry.begin()
        server = self._server_within(patience)
        check_name(server, self.url)
        try:
            reply, lost = self._answered(server, question, patience)
        except (ModelRejectedError, ModelSetupError) as error:
            raise with_known_models(error, server, self.url) from error
        except ModelUnavailableError as error:
            if self._thinking.room and isinstance(error.__cause__, ChatTimeoutError):
                raise ModelUnavailableError(str(error), remedy=_SLOW_THOUGHTS) from error
            raise
        return parse_answer(
            question,
            reply.text,
            model=server.model,
            usage=reply.usage,
            seconds=self._clock() - begin,
            lost=lost,
            probabilities=reply.probabilities,
            refused=reply.refused,
            is_cut=reply.written is not None and reply.written.is_cut,
        )

    def _who(self) -> str:
        return f"openai:{self.url}" + (f"#{self._wanted}" if self._wanted else "")

    def _detect_server(self, deadline: Deadline) -> ServerInfo:
        within = deadline.within(_DETECTION_LIMIT_S)
        return detect_server(self._client, self._wanted, self.config, within)

    def _answered(
        self, server: ServerInfo, question: Question, patience: Deadline
    ) -> tuple[_Reply, Counter[str]]:
        """A reply, asked for again where the model thinks and was not meant to, or had no room."""
        lost: Counter[str] = Counter()
        last_switch = len(switches(self._thinking.level, server.dialect.name)) - 1
        while True:
            thinking = self._thinking
            reply, again = self._retry.call(
                partial(self._attempt, server, question, thinking),
                who=self._who(),
                patience=patience,
            )
            lost += again
            if reply.written is None:
                return reply, lost
            written, following = reply.written, thinking.after(reply.written, last_switch)
            self._learn(following)
            is_plain = not written.is_cut or written.is_thought_only
            if following.asks_like(thinking) and (
                is_plain or not self._thinks_unseen(server, question, patience)
            ):
                if following.is_endless:
                    _log.warning("%s: %s", self._who(), ENDLESS.format(room=thinking.room))
                return reply, lost
            _log.info("%s: asking again: %s", self._who(), self._thinking)

    def _thinks_unseen(self, server: ServerInfo, question: Question, patience: Deadline) -> bool:
        """Whether an answer that was cut was thought without a mark; the first one tells."""
        known = self._thinking
        if known.is_probed or known.is_prefilled:
            return False
        self._learn(replace(known, is_probed=True))
        if not self._may_begin_with_thoughts(server, patience):
            return False
        for room in PROBES:
            try:
                reply, _ = self._retry.call(
                    partial(self._attempt, server, question, replace(known, room=room)),
                    who=self._who(),
                    patience=patience,
                )
            except ModelUnavailableError as error:
                _log.info("%s: a longer answer does not come: %s", self._who(), error)
                return False
            written = reply.written
            if written is not None and written.has_closed_only:
                self._learn(replace(known, room=room, is_seen=True, is_prefilled=True))
                return True
            if written is None or not written.is_cut or babbles(written.text):
                return False
        # No answer to these questions is as long as that.
        self._learn(replace(known, room=PROBES[-1], is_seen=True, is_prefilled=True))
        return True

    def _may_begin_with_thoughts(self, server: ServerInfo, patience: Deadline) -> bool:
        """Whether the chat template may begin the thoughts; only llama.cpp's server shows it."""
        if server.dialect.name != "llamacpp":
            return True
        try:
            properties = self._client.get("/props", patience.within(_DETECTION_LIMIT_S))
        except ChatError:
            return True
        template = properties.get("chat_template")
        return not isinstance(template, str) or bool(_OF_THOUGHTS.search(template))

    def _learn(self, thinking: Thinking) -> None:
        with self._lock:
            self._thinking = self._thinking.merged(thinking)

    def _attempt(
        self, server: ServerInfo, question: Question, thinking: Thinking, deadline: Deadline
    ) -> _Reply:
        """One attempt; a refused request is repeated at once as the refusal teaches."""
        refusals = known = self._refusals
        ask = partial(self._ask_once, server, question, thinking, deadline)
        reply, said = None, None
        try:
            while reply is None:
                try:
                    reply = ask(refusals)
                except (ModelRejectedError, ModelSetupError, RetryLaterError) as error:
                    said, sent = error, self._request(server, question, thinking, refusals)
                    learned = _learned(refusals, error, sent, self.config.extra_body)
                    if learned is None:
                        reply, learned = _tried(ask, _trials(refusals, error, sent), error)
                    else:
                        _log.warning("%s; asking otherwise from now on", error)
                    refusals = learned
            if reply.is_uncounted:
                refusals = replace(refusals, dropped=(*refusals.dropped, *STREAM))
                reply = ask(refusals)
        except ChatTimeoutError as error:
            if said is None:
                raise
            raise ChatTimeoutError(f"{error}; before that: {said}") from error
        if refusals != known:
            self._refusals = refusals
        return reply

    def _ask_once(
        self,
        server: ServerInfo,
        question: Question,
        thinking: Thinking,
        deadline: Deadline,
        refusals: Refusals,
    ) -> _Reply:
        sent = self._request(server, question, thinking, refusals)
        if sent.decides:
            return self._decide(server, question, deadline)
        fitted = refusals.fitted(sent.body) | self.config.extra_body
        reply = self._client.post("chat/completions", fitted, deadline)
        is_prefilled = thinking.is_prefilled
        return _parse_completion(reply, question, sent.constraint, is_prefilled=is_prefilled)

    def _request(
        self, server: ServerInfo, question: Question, thinking: Thinking, refusals: Refusals
    ) -> _Request:
        if DECISION in refusals.dropped:
            server = replace(server, dialect=without_decision(server.dialect))
        endpoint = server.dialect.decision
        decides = DECISION not in refusals.dropped and accepts_question(endpoint, question)
        constraint = constraint_for(server.dialect, question)
        if decides or set(constraint.fields) & set(refusals.dropped):
            constraint = Constraint({})
        body = {} if decides else self._body(server, question, constraint, thinking)
        return _Request(body, constraint, decides)

    def _decide(self, server: ServerInfo, question: Question, deadline: Deadline) -> _Reply:
        endpoint = server.dialect.decision
        body = decision_request(endpoint, server.model, question, quality=self.config.jpeg_quality)
        reply = self._client.post(endpoint, body, deadline)
        text, probabilities, usage, refused = parse_decision(endpoint, reply, question)
        return _Reply(text, usage, probabilities, refused)

    def _body(
        self, server: ServerInfo, question: Question, constraint: Constraint, thinking: Thinking
    ) -> dict[str, Any]:
        """The request as OpenAI's API has it, without what `ChatConfig.extra_body` holds."""
        config, dialect = self.config, server.dialect
        body: dict[str, Any] = {
            "model": server.model,
            "messages": [{"role": "user", "content": self._content(question, constraint.note)}],
            TOKEN_LIMIT: question.max_tokens + constraint.extra_tokens + thinking.room,
            **constraint.fields,
            "temperature": config.temperature,
            "seed": config.seed,
            **switches(thinking.level, dialect.name)[thinking.switch],
        }
        if dialect.logprobs and question.allowed:
            body |= {"logprobs": True, "top_logprobs": dialect.logprobs}
        if dialect.streams:
            body |= STREAM
        if dialect.name == "llamacpp":
            body[PROGRESS] = True
        own = set(config.extra_body)
        if own & LIMIT_NAMES:
            own.add(TOKEN_LIMIT)
        return {name: one for name, one in body.items() if one is not None and name not in own}

    def _content(self, question: Question, note: str) -> str | list[dict[str, Any]]:
        text = f"{question.text}\n\n{note}" if note else question.text
        if not question.images:
            return text
        quality = self.config.jpeg_quality
        images = [
            {"type": "image_url", "image_url": {"url": jpeg_data_url(image, quality=quality)}}
            for image in question.images
        ]
        return [*images, {"type": "text", "text": text}]


def _learned(
    refusals: Refusals, error: ChatError, sent: _Request, own: Mapping[str, Any]
) -> Refusals | None:
    """What an error teaches about the fields of the next request; None if it names none.

    Raises:
        ModelRejectedError: It names a field of the user's own.
    """
    said = _said(error)
    if sent.decides:  # a 404 or 501 means only that the optional endpoint is missing
        is_refused = isinstance(error, RefusedError) and error.status != 501
        is_missing = not (is_refused or isinstance(error, RetryLaterError))
        return replace(refusals, dropped=(*refusals.dropped, DECISION)) if is_missing else None
    is_failing = isinstance(error, RetryLaterError) and error.status == 500  # as some refuse
    names_a_field = UNKNOWN.search(said) and refusals.names(said, sent.body)
    if not (isinstance(error, RefusedError) or (is_failing and names_a_field)):
        return None
    named = [name for name in own if re.search(rf"(?<!\w){re.escape(name)}(?!\w)", said)]
    if named:
        remedy = f"'{named[0]}' comes from chat.extra_body"
        raise ModelRejectedError(str(error), remedy=remedy) from error
    return refusals.after(said, sent.body)


def _trials(refusals: Refusals, error: ChatError, sent: _Request) -> list[Refusals]:
    """What to try after a refusal that names no field; empty where no field can be to blame."""
    if not isinstance(error, RefusedError):
        return []
    if sent.decides:
        return refusals.trials(OPTIONAL)
    said = _said(error)
    # An error in a good reply may be about anything; a known cause is no field's fault.
    has_cause = error.status == 200 or error.remedy or is_of_the_question(said)
    return [] if has_cause or refusals.names(said, sent.body) else refusals.trials(sent.body)


def _tried(
    ask: Callable[[Refusals], _Reply], trials: list[Refusals], error: ChatError
) -> tuple[_Reply, Refusals]:
    """The first reply to the fullest request that a server takes, and what that teaches.

    Raises:
        ChatError: The given one: nothing is to be tried, or the plain question is refused, too.
    """
    if not trials:
        raise error
    _log.warning("%s; asking without optional fields", error)
    plain, *fuller = trials
    try:
        reply = ask(plain)
    except RefusedError:
        raise error from None
    for trial in fuller:
        with suppress(RefusedError):
            return ask(trial), trial
    return reply, plain


def _said(error: ChatError) -> str:
    """A server's own words, without its address."""
    return str(error).partition(" answered ")[2] or str(error)


def _parse_completion(
    reply: dict[str, Any], question: Question, constraint: Constraint, *, is_prefilled: bool
) -> _Reply:
    """Parse a chat completion; an incomplete one counts as a transport error."""
    choices = reply.get("choices")
    choice = choices[0] if isinstance(choices, list) and choices else None
    message = choice.get("message") if isinstance(choice, dict) else None
    if not isinstance(choice, dict) or not isinstance(message, dict):
        found = shortened(json.dumps(reply), LONGEST_MESSAGE)
        raise ChatTransportError(f"the server sent no choice: {found}")
    usage, refusal = reply.get("usage"), message.get("refusal")
    written = read_written(choice, usage, is_prefilled=is_prefilled)
    text = written.text
    refused = bool(refusal) or choice.get("finish_reason") == "content_filter"
    probabilities: dict[str, float] = {}
    logprobs = choice.get("logprobs")
    if question.allowed and isinstance(logprobs, dict):
        tokens = parse_logprobs(logprobs.get("content"))
        said = final_answer(text)
        if written.has_thoughts or said != text.strip():
            tokens = tokens_of_answer(tokens, said)
        probabilities = answer_probabilities(tokens, question.allowed, wrapped=constraint.wrapped)
    if refused and not text and isinstance(refusal, str):
        text = refusal
    is_uncounted = reply.get("object") == CHUNK and not usage
    return _Reply(text, read_usage(usage), probabilities, refused, written, is_uncounted)
