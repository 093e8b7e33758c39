"""JSON over HTTP with an OpenAI-compatible server; every failure is one of our errors."""

import json
import os
import re
import time
from collections.abc import Mapping
from contextlib import closing
from dataclasses import replace
from typing import Any
from urllib.parse import urljoin, urlsplit

from hypernav.core.errors import (
    ChatTimeoutError,
    ChatTransportError,
    ConfigError,
    ModelSetupError,
)
from hypernav.io.bounded_http import (
    Deadline,
    Reply,
    ReplyTooLargeError,
    Session,
    environment_proxy,
    is_loopback,
    without_password,
)
from hypernav.io.secret import Secret
from hypernav.search.models.chat.answer_parsing import shortened
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.server.reply_errors import (
    LONGEST_MESSAGE,
    NEEDS_LOGIN,
    error_in_body,
    error_of_status,
)
from hypernav.search.models.chat.server.streamed import joined

_PLAIN = re.compile(r"[!-~]+")
_QUERY = re.compile(r"(?:api-version=[\w.-]+)?")
_ENDPOINT = re.compile(r"/+(?:(?:chat/)?completions|responses)/*$")
"""An endpoint of the API, which many pages show as the end of its URL."""
_MOST_CONTAINERS = 200_000
_WANTS_LOGIN = re.compile(r"the proxy answered (?:407|invalid username|requested .* but got)", re.I)
_REFUSES = re.compile(r"the proxy answered 4(?!08|29)\d\d")

_CONNECT_LIMIT_S = 5.0
"""Longest wait for one of the server's addresses to connect."""

LARGEST_REPLY_BYTES = 8 * 2**20
"""Limit of a reply: an answer has a few kilobytes, one with probabilities or a long list of models
about one megabyte, and a stream with the longest thoughts four. Parsing the worst takes a second.
"""


class HttpClient:
    """Sends JSON and receives JSON within a deadline.

    The key comes from the environment only and never shows in messages: ``HYPERNAV_API_KEY`` goes
    to any server, ``OPENAI_API_KEY`` only over https or to a loopback address.
    """

    def __init__(
        self, url: str, config: ChatConfig, environment: Mapping[str, str] = os.environ
    ) -> None:
        """Prepare; nothing is sent yet.

        Raises:
            ConfigError: The URL is malformed or holds a password, or no request can carry the key.
        """
        self.url, self._query = _checked(url)
        self._key = _key_for(self.url, environment)
        self._secret = Secret(self._key)
        self._config = config

    def post(self, path: str, body: dict[str, Any], deadline: Deadline) -> dict[str, Any]:
        """Send a JSON object, and receive one, whole or as a stream of events.

        While the server is there, an answer is waited for until the whole of the deadline, and what
        comes of a stream puts that off: asked again, the server would only have two to answer. An
        answer that is given up is given up with its connection, which tells the server to stop.

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
        if self._key and self._query:  # Azure's older form has a header of its own
            headers["api-key"] = self._key
        elif self._key:
            headers["Authorization"] = f"Bearer {self._key}"
        try:
            proxy = environment_proxy(url)
        except ValueError as error:
            raise ModelSetupError(f"{self.url}: {error}") from error
        asked = f" through the proxy {without_password(proxy)}" if proxy else ""

        def exchange(method: str, url: str, body: bytes | None, deadline: Deadline) -> Reply:
            with closing(Session(largest_reply_bytes=LARGEST_REPLY_BYTES, proxy=proxy)) as session:
                return session.exchange(
                    method,
                    url + self._query,
                    headers=headers,
                    body=body,
                    deadline=deadline,
                    connect_limit_s=_CONNECT_LIMIT_S,
                    is_alive=is_alive if body is not None else None,
                )

        def is_alive() -> bool:
            try:
                exchange("GET", f"{self.url}/models", None, Deadline(quick_s))
            except (OSError, ValueError):
                return False
            return True

        begin, quick_s = time.monotonic(), min(_CONNECT_LIMIT_S, deadline.limit_s)
        try:
            reply = exchange(method, url, body, deadline)
            if reply.headers.get("content-type", "").startswith("text/event-stream"):
                reply = replace(reply, body=json.dumps(self._joined(reply)).encode())
        except TimeoutError as error:
            waited_s = max(time.monotonic() - begin, deadline.limit_s)
            raise ChatTimeoutError(
                f"{self.url}{asked}: no answer within {waited_s:.1f} s"
            ) from error
        except (ReplyTooLargeError, ValueError) as error:
            raise ChatTransportError(f"{url}{asked}: {self._told(error)}") from error
        except OSError as error:
            host, told = urlsplit(url).hostname, f"{self.url}{asked}: {self._told(error)}"
            if _WANTS_LOGIN.search(told):
                raise ModelSetupError(told, remedy=NEEDS_LOGIN) from error
            if proxy:
                remedy = f"is the proxy right? no_proxy={host} asks the server without it"
                kind = ModelSetupError if _REFUSES.search(told) else ChatTransportError
                raise kind(told, remedy=remedy) from error
            raise ChatTransportError(
                f"{told}; is the server running? try: hypernav doctor --vlm openai:{self.url}"
            ) from error
        headers = {name: self._secret.blanked(value) for name, value in reply.headers.items()}
        body = self._secret.blanked_bytes(_as_utf8(reply.body))
        reply = replace(reply, headers=headers, body=body)
        if not 200 <= reply.status < 300:
            raise error_of_status(reply, f"{url}{asked}")
        return self._parsed(reply, f"{url}{asked}")

    def _joined(self, reply: Reply) -> dict[str, Any]:
        _check_containers(reply.body)
        try:
            return joined(reply.body)
        except RecursionError as error:
            raise ValueError("an event of the stream is nested too deeply") from error

    def _parsed(self, reply: Reply, url: str) -> dict[str, Any]:
        try:
            _check_containers(reply.body)
        except ValueError as error:
            raise ChatTransportError(f"{url}: {error}") from error
        found = shortened(reply.body.decode("utf-8", "replace"), LONGEST_MESSAGE)
        parsed, fault = None, f"expected a JSON object, found '{found}'"
        try:
            parsed = json.loads(reply.body)
        except (ValueError, RecursionError) as error:
            cause = self._without_key(str(error))
            fault = f"the answer is not JSON ({cause}): '{found}'"
        if (told := error_in_body(reply, parsed, url)) is not None:
            raise told
        if not isinstance(parsed, dict):
            raise ChatTransportError(f"{url}: {fault}")
        return parsed

    def _told(self, error: Exception) -> str:
        # Systems number their errors differently, and the words say it all.
        words = error.strerror if isinstance(error, OSError) else None
        return self._without_key(words or str(error) or type(error).__name__)

    def _without_key(self, text: str) -> str:
        return shortened(self._secret.blanked(text), LONGEST_MESSAGE)


def _as_utf8(body: bytes) -> bytes:
    # JSON may come in UTF-16 or UTF-32, in which a key looks different.
    encoding = json.detect_encoding(body)
    return body if encoding.startswith("utf-8") else body.decode(encoding, "replace").encode()


def _check_containers(body: bytes) -> None:
    # Each costs fifty times its bytes, and the garbage collector looks at all of them.
    if body.count(b"[") + body.count(b"{") > _MOST_CONTAINERS:
        raise ValueError(f"the answer holds more than {_MOST_CONTAINERS:,} lists and objects")


def _checked(url: str) -> tuple[str, str]:
    """The URL without endpoint and query, and the query, which may only hold Azure's version."""
    try:
        parts = urlsplit(url)
        host, _ = parts.hostname, parts.port
    except ValueError as error:
        raise ConfigError(f"'{url}' is not a server's URL: {error}") from error
    if parts.scheme not in {"http", "https"} or not host or not _PLAIN.fullmatch(url):
        raise ConfigError(
            f"'{url}' is not a server's URL; expected something like http://localhost:8000/v1"
        )
    if parts.username or parts.password or not _QUERY.fullmatch(parts.query):
        raise ConfigError(
            f"the URL of {parts.scheme}://{host} holds a name, password or query; put the key into "
            "the environment variable HYPERNAV_API_KEY instead"
        )
    query = f"?{parts.query}" if parts.query else ""
    return _ENDPOINT.sub("", url.removesuffix(query)).rstrip("/"), query


def _key_for(url: str, environment: Mapping[str, str]) -> str:
    key = environment.get("HYPERNAV_API_KEY", "")
    parts = urlsplit(url)
    if not key and (parts.scheme == "https" or is_loopback(parts.hostname or "")):
        key = environment.get("OPENAI_API_KEY", "")
    if not (key.isascii() and key.isprintable()):
        raise ConfigError("the key in the environment holds characters that HTTP does not allow")
    return key
