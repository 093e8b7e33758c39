"""Chat models behind an OpenAI-compatible server: vLLM, SGLang, Ollama, llama.cpp, hosted APIs."""

import logging
import os
import reprlib
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from hypernav.core.chat import Answer, Question, Usage
from hypernav.core.errors import ChatTransportError, ModelRejectedError, ModelSetupError
from hypernav.core.network.bounded_http import Deadline
from hypernav.models.chat.answer_parsing import parse_answer
from hypernav.models.chat.config import ChatConfig
from hypernav.models.chat.image_encoding import jpeg_data_url
from hypernav.models.chat.server.answer_probabilities import answer_probabilities, parse_logprobs
from hypernav.models.chat.server.decision_api import (
    accepts_question,
    decision_request,
    parse_decision,
)
from hypernav.models.chat.server.detection import ServerInfo, detect_server, with_known_models
from hypernav.models.chat.server.dialects import Constraint, constraint_for
from hypernav.models.chat.server.http_client import HttpClient
from hypernav.models.chat.server.reply_fields import read_content, read_usage
from hypernav.models.chat.server.retry import Retry

_log = logging.getLogger(__name__)
_DETECTION_LIMIT_S = 10.0


@dataclass(frozen=True)
class _Reply:
    """Reply to one question, before it is checked against the question."""

    text: str
    usage: Usage
    probabilities: Mapping[str, float]
    refused: bool
    is_cut: bool = False


class OpenAiChat:
    """Asks a server over HTTP. Safe to share between threads.

    Optional fields that a server does not understand are left out from then on: if it rejects a
    request with such fields (a decision, label probabilities, a constraint, sampling), the same
    question is asked without them, one kind at a time. Answers are checked here in any case.
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
        self._dropped: tuple[str, ...] = ()

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
        """Kinds of optional fields that the server has rejected so far."""
        return self._dropped

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
        try:
            reply, lost = self._retry.call(
                lambda deadline: self._attempt(server, question, deadline),
                who=self._who(),
                patience=patience,
            )
        except (ModelRejectedError, ModelSetupError) as error:
            raise with_known_models(error, server, self.url) from error
        return parse_answer(
            question,
            reply.text,
            model=server.model,
            usage=reply.usage,
            seconds=self._clock() - begin,
            lost=lost,
            probabilities=reply.probabilities,
            refused=reply.refused,
            is_cut=reply.is_cut,
        )

    def _who(self) -> str:
        return f"openai:{self.url}" + (f"#{self._wanted}" if self._wanted else "")

    def _detect_server(self, deadline: Deadline) -> ServerInfo:
        within = deadline.within(_DETECTION_LIMIT_S)
        return detect_server(self._client, self._wanted, self.config, within)

    def _attempt(self, server: ServerInfo, question: Question, deadline: Deadline) -> _Reply:
        """One attempt; a rejected request is repeated at once with fewer optional fields."""
        dropped = self._dropped
        while True:
            optional = self._optional(server, question, dropped)
            try:
                if "decision" in optional:
                    reply = self._decide(server, question, deadline)
                else:
                    reply = self._complete(server, question, optional, deadline)
            except (ModelRejectedError, ModelSetupError) as error:
                # 404 for an optional endpoint means only that it is missing.
                forgiven = isinstance(error, ModelRejectedError) or "decision" in optional
                if not forgiven or not optional:
                    raise
                _log.warning("%s; asking without %s", error, optional[0])
                dropped = (*dropped, optional[0])
            else:
                self._dropped = dropped
                return reply

    def _optional(
        self, server: ServerInfo, question: Question, dropped: tuple[str, ...]
    ) -> tuple[str, ...]:
        """The kinds of optional fields of this question; the first is left out first."""
        dialect = server.dialect
        kinds = []
        if self.config.decisions and accepts_question(dialect.decision, question):
            kinds.append("decision")
        if self.config.logprobs and dialect.logprobs and question.allowed:
            kinds.append("logprobs")
        if constraint_for(dialect, question).fields:
            kinds.append("constraint")
        if self.config.temperature is not None or self.config.seed is not None:
            kinds.append("sampling")
        return tuple(kind for kind in kinds if kind not in dropped)

    def _decide(self, server: ServerInfo, question: Question, deadline: Deadline) -> _Reply:
        endpoint = server.dialect.decision
        body = decision_request(endpoint, server.model, question, quality=self.config.jpeg_quality)
        reply = self._client.post(endpoint, body, deadline)
        text, probabilities, usage, refused = parse_decision(endpoint, reply, question)
        return _Reply(text, usage, probabilities, refused)

    def _complete(
        self, server: ServerInfo, question: Question, optional: tuple[str, ...], deadline: Deadline
    ) -> _Reply:
        constraint = Constraint({})
        if "constraint" in optional:
            constraint = constraint_for(server.dialect, question)
        body: dict[str, Any] = {
            "model": server.model,
            "messages": [{"role": "user", "content": self._content(question, constraint.note)}],
            server.dialect.token_limit: question.max_tokens + constraint.extra_tokens,
            **constraint.fields,
        }
        if "logprobs" in optional:
            body |= {"logprobs": True, "top_logprobs": server.dialect.logprobs}
        if "sampling" in optional:
            sampling = {"temperature": self.config.temperature, "seed": self.config.seed}
            body |= {key: value for key, value in sampling.items() if value is not None}
        reply = self._client.post("chat/completions", body, deadline)
        return _parse_completion(reply, question, wrapped=constraint.wrapped)

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


def _parse_completion(reply: dict[str, Any], question: Question, *, wrapped: bool) -> _Reply:
    """Parse a chat completion; an incomplete one counts as a transport error."""
    choices = reply.get("choices")
    choice = choices[0] if isinstance(choices, list) and choices else None
    message = choice.get("message") if isinstance(choice, dict) else None
    if not isinstance(choice, dict) or not isinstance(message, dict):
        raise ChatTransportError(f"the server sent no choice: {reprlib.repr(reply)}")
    text, refusal = read_content(message.get("content")), message.get("refusal")
    refused = bool(refusal) or choice.get("finish_reason") == "content_filter"
    probabilities: dict[str, float] = {}
    logprobs = choice.get("logprobs")
    if question.allowed and isinstance(logprobs, dict):
        tokens = parse_logprobs(logprobs.get("content"))
        probabilities = answer_probabilities(tokens, question.allowed, wrapped=wrapped)
    if refused and not text and isinstance(refusal, str):
        text = refusal
    is_cut = choice.get("finish_reason") == "length"
    return _Reply(text, read_usage(reply.get("usage")), probabilities, refused, is_cut)
