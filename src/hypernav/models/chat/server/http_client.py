"""JSON over HTTP with an OpenAI-compatible server; every failure is one of our errors."""

import json
import math
import os
import re
from collections.abc import Mapping
from contextlib import closing
from typing import Any
from urllib.parse import urljoin, urlsplit

import httpx

from hypernav.core.errors import (
    ChatTimeoutError,
    ChatTransportError,
    ConfigError,
    ModelRejectedError,
    ModelSetupError,
)
from hypernav.core.network.bounded_http import (
    Deadline,
    Reply,
    ReplyTooLargeError,
    Session,
    environment_proxy,
)
from hypernav.models.chat.answer_parsing import shortened
from hypernav.models.chat.config import ChatConfig
from hypernav.models.chat.server.retry import RetryLaterError

_RETRYABLE_STATUSES = {408, 409, 425, 429}
_NO_VISION = re.compile(
    r"image input is not supported|mmproj|does not support (?:image|vision)", re.I
)
_PLAIN = re.compile(r"[!-~]+")
_MOST_CONTAINERS = 200_000
_LOCAL_HOSTS = {"localhost", "127.0.0.1", "::1"}

_CONNECT_LIMIT_S = 5.0
"""Longest wait for one of the server's addresses to connect."""

LARGEST_REPLY_BYTES = 4 * 2**20
"""Limit of a reply: an answer has a few kilobytes, one with probabilities or a long list of models
about one megabyte. Parsing the worst takes a second."""


class NotFoundError(ModelSetupError):
    """The server has nothing at this address, or no such model (404)."""


class HttpClient:
    """Sends JSON and receives JSON within a deadline.

    The key comes from the environment only and never shows in messages: ``HYPERNAV_API_KEY`` goes
    to any server, ``OPENAI_API_KEY`` only over https or within this machine.
    """

    def __init__(
        self, url: str, config: ChatConfig, environment: Mapping[str, str] = os.environ
    ) -> None:
        """Prepare; nothing is sent yet.

        Raises:
            ConfigError: The URL is malformed, or holds a password.
        """
        self.url = _checked(url)
        self._key = _key_for(self.url, environment)
        self._config = config

    def post(self, path: str, body: dict[str, Any], deadline: Deadline) -> dict[str, Any]:
        """Send and receive a JSON object.

        Args:
            path: Path below the API's URL, or from the root of the server if it begins with "/".
            body: Object to send.
            deadline: Moment at which the answer has to be here.

        Raises:
            ChatTimeoutError: No answer in time.
            ChatTransportError: No connection, a server's fault, or a broken answer.
            ModelRejectedError: The server understands the address but not the request.
            ModelSetupError: URL, key or choice of the model are wrong.
        """
        return self._exchange("POST", path, json.dumps(body).encode("utf-8"), deadline)

    def get(self, path: str, deadline: Deadline) -> dict[str, Any]:
        """Receive a JSON object; raises what `post` raises."""
        return self._exchange("GET", path, None, deadline)

    def _exchange(
        self, method: str, path: str, body: bytes | None, deadline: Deadline
    ) -> dict[str, Any]:
        url = urljoin(f"{self.url}/", path)
        headers = {"Accept": "application/json", "Content-Type": "application/json"}
        # Questions come seconds apart; servers close idle connections sooner (vLLM after 5 s).
        headers["Connection"] = "close"
        if self._key:
            headers["Authorization"] = f"Bearer {self._key}"
        try:
            proxy = environment_proxy(url)
            with closing(Session(largest_reply_bytes=LARGEST_REPLY_BYTES, proxy=proxy)) as session:
                reply = session.exchange(
                    method,
                    url,
                    headers=headers,
                    body=body,
                    deadline=deadline,
                    connect_limit_s=_CONNECT_LIMIT_S,
                )
        except TimeoutError as error:
            raise ChatTimeoutError(
                f"{self.url}: no answer within {deadline.limit_s:.3g} s"
            ) from error
        except (ReplyTooLargeError, ValueError) as error:
            raise ChatTransportError(f"{url}: {self._told(error)}") from error
        except OSError as error:
            raise ChatTransportError(
                f"{self.url}: {self._told(error)}; is the server running? "
                f"try: hypernav doctor --vlm openai:{self.url}"
            ) from error
        if not 200 <= reply.status < 300:
            raise self._status_error(reply, url)
        return self._parsed(reply, url)

    def _parsed(self, reply: Reply, url: str) -> dict[str, Any]:
        # Each costs fifty times its bytes, and the garbage collector looks at all of them.
        if reply.body.count(b"[") + reply.body.count(b"{") > _MOST_CONTAINERS:
            raise ChatTransportError(
                f"{url}: the answer holds more than {_MOST_CONTAINERS:,} lists and objects"
            )
        try:
            parsed = json.loads(reply.body)
        except (ValueError, RecursionError) as error:
            cause = self._without_key(str(error))
            raise ChatTransportError(f"{url}: the answer is not JSON: {cause}") from error
        if not isinstance(parsed, dict):
            found = self._without_key(_text(reply))
            raise ChatTransportError(f"{url}: expected a JSON object, found '{found}'")
        return parsed

    def _status_error(self, reply: Reply, url: str) -> Exception:
        status, said = reply.status, self._without_key(_message(reply))
        where = f"{url} answered {status}"
        if _NO_VISION.search(said):  # llama.cpp answers 500
            return ModelSetupError(f"{where}: {said}; this model cannot see, choose another")
        if status in _RETRYABLE_STATUSES or status >= 500 or status < 200:
            return RetryLaterError(f"{where}: {said}", _retry_after(reply), status=status)
        if status < 400:
            target = shortened(reply.headers.get("location", "nowhere"), 240)
            return ModelSetupError(
                f"{where}: the server points to {target}; write its own URL after openai:"
            )
        if status in {400, 413, 422}:
            return ModelRejectedError(f"{where}: {said}")
        if status == 404:
            return NotFoundError(f"{where}: {said}")
        hint = "; set the environment variable HYPERNAV_API_KEY to the server's key"
        return ModelSetupError(f"{where}: {said}{hint if status in {401, 403} else ''}")

    def _told(self, error: Exception) -> str:
        # Systems number their errors differently, and the words say it all.
        words = error.strerror if isinstance(error, OSError) else None
        return self._without_key(words or str(error) or type(error).__name__)

    def _without_key(self, text: str) -> str:
        return shortened(text.replace(self._key, "***") if self._key else text, 240)


def _checked(url: str) -> str:
    try:
        parts = urlsplit(url)
        host, _ = parts.hostname, parts.port
    except ValueError as error:
        raise ConfigError(f"'{url}' is not a server's URL: {error}") from error
    if parts.scheme not in {"http", "https"} or not host or not _PLAIN.fullmatch(url):
        raise ConfigError(
            f"'{url}' is not a server's URL; expected something like http://localhost:8000/v1"
        )
    if parts.username or parts.password or parts.query:
        raise ConfigError(
            f"the URL of {parts.scheme}://{host} holds a name, password or query; put the key into "
            "the environment variable HYPERNAV_API_KEY instead"
        )
    return url.rstrip("/")


def _key_for(url: str, environment: Mapping[str, str]) -> str:
    own = environment.get("HYPERNAV_API_KEY", "")
    parts = urlsplit(url)
    if own or not (parts.scheme == "https" or parts.hostname in _LOCAL_HOSTS):
        return own
    return environment.get("OPENAI_API_KEY", "")


def _message(reply: Reply) -> str:
    """The server's own words: OpenAI's form, FastAPI's, or whatever it sent."""
    text = _text(reply)
    try:
        body = json.loads(text)
    except (ValueError, RecursionError):
        return text or httpx.codes.get_reason_phrase(reply.status) or "no reason given"
    for key in ("error", "message", "detail"):
        if isinstance(body, dict) and body.get(key):
            body = body[key]
    return body if isinstance(body, str) else text


def _text(reply: Reply) -> str:
    return reply.body.decode("utf-8", "replace")


def _retry_after(reply: Reply) -> float | None:
    """Seconds that the server asks to wait; None where it names none, or a date, or nonsense."""
    try:
        wait_s = float(reply.headers.get("retry-after", ""))
    except ValueError:
        return None
    return wait_s if math.isfinite(wait_s) and wait_s >= 0.0 else None
