"""HTTP client of an OpenAI-compatible server, on top of the OpenAI SDK."""

import json
import os
import re
from collections.abc import Mapping
from typing import Any
from urllib.parse import urlsplit

import openai

from hypernav.core.errors import (
    ChatTimeoutError,
    ChatTransportError,
    ConfigError,
    ModelRejectedError,
)
from hypernav.models.chat.answer_parsing import shortened
from hypernav.models.chat.config import ChatConfig
from hypernav.models.chat.server.retry import RetryLaterError

_RETRYABLE_STATUSES = {408, 409, 425, 429}
_NO_VISION = re.compile(
    r"image input is not supported|mmproj|does not support (?:image|vision)", re.I
)
_LOCAL_HOSTS = {"localhost", "127.0.0.1", "::1"}


class BadRequestError(ModelRejectedError):
    """The server understood the address but not the request (400, 413, 422)."""


class HttpClient:
    """Sends JSON and receives JSON; every failure becomes one of our errors.

    The SDK's own retries are off: they would be neither counted nor bounded by `Retry`. The
    key comes from the environment only and never shows in messages: ``HYPERNAV_API_KEY`` goes to
    any server, ``OPENAI_API_KEY`` only over https or within this machine.
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
        self._client = openai.OpenAI(
            base_url=self.url, api_key=self._key or "none", max_retries=0, timeout=config.timeout_s
        )

    def post(self, path: str, body: dict[str, Any], *, limit_s: float) -> Any:
        """Send and receive JSON.

        Raises:
            ChatTimeoutError: No answer within the limit.
            ChatTransportError: No connection, a server's fault, or a broken answer.
            ModelRejectedError: The server rejects the request for good.
        """
        return self._exchange("POST", path, body, limit_s)

    def get(self, path: str, *, limit_s: float) -> Any:
        """Receive JSON; raises what `post` raises."""
        return self._exchange("GET", path, None, limit_s)

    def _exchange(self, method: str, path: str, body: dict[str, Any] | None, limit_s: float) -> Any:
        timeout = openai.Timeout(limit_s, connect=min(limit_s, self._config.connect_timeout_s))
        client = self._client.with_options(timeout=timeout)
        try:
            if method == "GET":
                reply = client.get(path, cast_to=object)
            else:
                reply = client.post(path, cast_to=object, body=body)
        except openai.APITimeoutError as error:
            raise ChatTimeoutError(f"{self.url}: no answer within {limit_s:.3g} s") from error
        except openai.APIStatusError as error:
            raise self._status_error(error, path) from error
        except openai.APIConnectionError as error:
            cause = self._without_key(str(error.__cause__ or error))
            raise ChatTransportError(
                f"{self.url}: {cause}; is the server running? try: hypernav doctor --vlm "
                f"openai:{self.url}"
            ) from error
        except (openai.APIResponseValidationError, ValueError) as error:
            raise ChatTransportError(f"{self.url}: the answer is not JSON: {error}") from error
        if not isinstance(reply, dict):
            found = self._without_key(str(reply))
            raise ChatTransportError(f"{self.url}{path}: expected JSON, found '{found}'")
        return reply

    def _status_error(self, error: openai.APIStatusError, path: str) -> Exception:
        said = self._without_key(_message(error))
        where = f"{self.url}{path} answered {error.status_code}"
        if _NO_VISION.search(said):  # llama.cpp answers 500
            return ModelRejectedError(f"{where}: {said}; this model cannot see, choose another")
        if error.status_code in _RETRYABLE_STATUSES or error.status_code >= 500:
            return RetryLaterError(
                f"{where}: {said}", _retry_after(error), status=error.status_code
            )
        if error.status_code in {401, 403}:
            hint = "set the environment variable HYPERNAV_API_KEY to the server's key"
            return ModelRejectedError(f"{where}: {said}; {hint}")
        if error.status_code in {400, 413, 422}:
            return BadRequestError(f"{where}: {said}")
        return ModelRejectedError(f"{where}: {said}")

    def _without_key(self, text: str) -> str:
        return shortened(text.replace(self._key, "***") if self._key else text, 240)


def _checked(url: str) -> str:
    try:
        parts = urlsplit(url)
        host, _ = parts.hostname, parts.port
    except ValueError as error:
        raise ConfigError(f"'{url}' is not a server's URL: {error}") from error
    if parts.scheme not in {"http", "https"} or not host:
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


def _message(error: openai.APIStatusError) -> str:
    """The server's own words: OpenAI's form, FastAPI's, or whatever it sent."""
    text = error.response.text
    try:
        body = json.loads(text)
    except (ValueError, RecursionError):
        return text or error.message
    for key in ("error", "message", "detail"):
        if isinstance(body, dict) and body.get(key):
            body = body[key]
    return body if isinstance(body, str) else json.dumps(body)


def _retry_after(error: openai.APIStatusError) -> float | None:
    try:
        return float(error.response.headers.get("retry-after", ""))
    except ValueError:
        return None
