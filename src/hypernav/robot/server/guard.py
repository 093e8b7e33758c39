"""The guard in front of the application: access, rate limits and size limits.

It is plain ASGI, so that it sees a request before any of it is read or parsed. Access is decided
by the server's address, the page that asks, and the token.
"""

import asyncio
import hmac
import ipaddress
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from hypernav.core.errors import RequestRefusedError
from hypernav.robot.server.limits import Allowances, ServerLimits
from hypernav.robot.wire.frames import MOST_BODY_BYTES
from hypernav.robot.wire.replies import ErrorBody
from hypernav.robot.wire.values import repeated_key

API = "/v1"


@dataclass(frozen=True)
class Access:
    """Who may use the server.

    Attributes:
        host: Address that the server is bound to.
        token: Token that every request must carry; None requires none.
    """

    host: str
    token: str | None = None

    @property
    def is_local(self) -> bool:
        """Whether only programs on this machine can reach the server."""
        return _is_loopback(self.host)

    def check(self, path: str, headers: Headers) -> None:
        """Refuse a request from elsewhere, or without the token.

        Args:
            path: Path that is asked for.
            headers: Headers of the request.

        Raises:
            RequestRefusedError: It may not use the server.
        """
        self._check_origin(headers)
        if path.startswith(API):
            self._check_token(headers)

    def _check_origin(self, headers: Headers) -> None:
        """Refuse requests from pages of other sites in a browser on this machine."""
        host = headers.get("host", "")
        if self.is_local and not _is_loopback(_name_of(host)):
            raise RequestRefusedError(
                f"this server answers to localhost only, not to the host {host[:80]!a}",
                error="forbidden",
                status=403,
            )
        origin = headers.get("origin")
        if origin is not None and _netloc_of(origin) != host:
            raise RequestRefusedError(
                f"pages of other sites may not use this server, got the origin {origin[:80]!a}",
                error="forbidden",
                status=403,
            )

    def _check_token(self, headers: Headers) -> None:
        if self.token is None:
            return
        scheme, _, given = headers.get("authorization", "").partition(" ")
        expected = self.token.encode()
        # The time of the comparison does not depend on the token's content.
        is_right = hmac.compare_digest(given.strip().encode(), expected)
        if scheme.lower() != "bearer" or not is_right:
            raise RequestRefusedError(
                "expected the server's token in the header 'Authorization: Bearer TOKEN'",
                error="unauthorised",
                status=401,
            )


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def _netloc_of(origin: str) -> str:
    try:
        return urlsplit(origin).netloc
    except ValueError:
        return ""


def _name_of(host: str) -> str:
    """The host of ``host:port``, without the brackets of IPv6."""
    try:
        return urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return ""


_OBSERVATIONS, _STREAM, _STOP = "/observations", "/stream", "/stop"
_STOP_BODY_S = 0.3
"""Longest wait for the body of a STOP, which only says the reason."""
_OF_ONE_SEARCH = 4
"""Observations and streams of one search at once: what its robot sends again meets the first."""
MOST_HEAD_BYTES = 16_384
_MOST_JSON_BYTES = 64_000
_POLICY_VIOLATION = 1008


class Guard:
    """Middleware that refuses requests that are not allowed, and passes on only complete bodies."""

    def __init__(
        self, app: ASGIApp, access: Access, limits: ServerLimits, allowances: Allowances
    ) -> None:
        """Stand before an application.

        Args:
            app: Application.
            access: Who may use the server.
            limits: Limits of the server.
            allowances: Requests that each address may still make.
        """
        self._app = app
        self._access = access
        self._limits = limits
        self._allowances = allowances
        self._at_once = Counter[str]()
        self._arriving: dict[asyncio.Timeout, str] = {}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if is_stop := _is_stop(scope):
            scope = {**scope, "path": _plain(scope["path"])}
        kind = _kind_of(scope)
        self._at_once[kind] += 1
        try:
            self._access.check(scope["path"], Headers(scope=scope))
            if is_stop:
                body, is_whole = await _stop_body(receive)
                receive, send = _giving(body, receive), send if is_whole else _closing(send)
            else:
                self._check_load(scope, kind)
                if scope["type"] == "http":
                    receive = _giving(await self._body(scope, receive), receive)
        except RequestRefusedError as refused:
            await _refuse(refused, scope, receive, send)
            return
        else:
            await self._app(scope, receive, send)
        finally:
            self._at_once[kind] -= 1
            if self._at_once[kind] == 0:
                del self._at_once[kind]

    def _check_load(self, scope: Scope, kind: str) -> None:
        """Refuse a request that is too large, or one too many."""
        if sum(len(name) + len(value) for name, value in scope["headers"]) > MOST_HEAD_BYTES:
            raise RequestRefusedError(
                f"the headers have more than {MOST_HEAD_BYTES:,} bytes",
                error="too-large",
                status=431,
            )
        is_robot = kind not in _KINDS
        self._allowances.take(_address_of(scope), is_robot=is_robot)
        most = _OF_ONE_SEARCH if is_robot else self._limits.requests_at_once
        if self._at_once[kind] > most:
            raise RequestRefusedError(
                f"{most} requests of this kind are under way, as many as there may be; try again",
                error="busy",
                status=429,
            )

    async def _body(self, scope: Scope, receive: Receive) -> bytes:
        """The whole body, of limited size and in limited time."""
        is_json = not scope["path"].endswith(_OBSERVATIONS)
        most = _MOST_JSON_BYTES if is_json else MOST_BODY_BYTES
        headers = Headers(scope=scope)
        announced = headers.get("content-length", "0")
        if "content-length" in headers and "transfer-encoding" in headers:
            raise RequestRefusedError(  # a proxy may read the body differently
                "a body has either a content-length or a transfer-encoding, got both",
                error="invalid",
                status=400,
            )
        if announced.isdecimal() and int(announced) > most:
            raise _too_large(most)
        body, timeout = bytearray(), asyncio.timeout(self._limits.body_s)
        try:
            async with timeout:
                self._arriving[timeout] = _address_of(scope)
                self._make_room()
                while True:
                    message = await receive()
                    if message["type"] == "http.disconnect":
                        raise RequestRefusedError(
                            "the connection ended within the body", error="invalid", status=400
                        )
                    body += message.get("body", b"")
                    if len(body) > most:
                        raise _too_large(most)
                    if not message.get("more_body", False):
                        break
        except TimeoutError:
            raise RequestRefusedError(
                f"the body did not arrive within {self._limits.body_s:g} s, or others needed the "
                "room before",
                error="too-slow",
                status=408,
            ) from None
        finally:
            self._arriving.pop(timeout, None)
        if is_json and (key := repeated_key(bytes(body))) is not None:
            raise RequestRefusedError(
                f"the body has the key {key[:80]!a} twice", error="invalid", status=422
            )
        return bytes(body)

    def _make_room(self) -> None:
        """If too many bodies are arriving, give up the oldest of the address with most of them."""
        if len(self._arriving) <= self._limits.requests_at_once:
            return
        ((address, _),) = Counter(self._arriving.values()).most_common(1)
        oldest = next(one for one, of in self._arriving.items() if of == address)
        del self._arriving[oldest]
        oldest.reschedule(asyncio.get_running_loop().time())


def refusal(error: str, message: str, status: int, expected: int | None = None) -> JSONResponse:
    """The response of every refusal."""
    body = ErrorBody(error=error, message=message, expected=expected)
    headers = {"www-authenticate": "Bearer"} if status == 401 else {}
    if status == 429:
        headers["retry-after"] = "1"
    return JSONResponse(body.model_dump(mode="json"), status, headers=headers)


def _plain(path: str) -> str:
    """A path without empty parts, as in ``//v1/stop/``."""
    return "/" + "/".join(part for part in path.split("/") if part)


def _is_stop(scope: Scope) -> bool:
    if scope["type"] != "http" or scope["method"] != "POST":
        return False
    path = _plain(scope["path"])
    return path.startswith(f"{API}/") and path.endswith(_STOP)


_KINDS = frozenset({"stop", "waits", "other"})


def _kind_of(scope: Scope) -> str:
    """What a request shares its room with: for a robot's observations, those of its search."""
    path: str = scope["path"]
    if path.startswith(API) and path.endswith((_OBSERVATIONS, _STREAM)):
        return path
    if _is_stop(scope):
        return "stop"
    waits = b"wait_s=" in scope["query_string"] or "/replies/" in path
    return "waits" if waits else "other"


def _address_of(scope: Scope) -> str:
    client = scope.get("client")
    return client[0] if client else ""


async def _stop_body(receive: Receive) -> tuple[bytes, bool]:
    """What comes of a STOP's body within a moment, and whether that is all."""
    body = bytearray()
    with suppress(TimeoutError):
        async with asyncio.timeout(_STOP_BODY_S):
            while len(body) <= _MOST_JSON_BYTES:
                message = await receive()
                body += message.get("body", b"")
                if not message.get("more_body", False):
                    return bytes(body), True
    return bytes(body[:_MOST_JSON_BYTES]), False


def _closing(send: Send) -> Send:
    """A send function for a request whose rest isn't read: the connection can't be used again."""

    async def give(message: Message) -> None:
        if message["type"] == "http.response.start":
            message["headers"] = [*message["headers"], (b"connection", b"close")]
        await send(message)

    return give


def _giving(body: bytes, receive: Receive) -> Receive:
    """A receive function that gives the body first, then the messages that follow."""
    is_given = False

    async def give() -> Message:
        nonlocal is_given
        if is_given:
            return await receive()
        is_given = True
        return {"type": "http.request", "body": body, "more_body": False}

    return give


async def _refuse(refused: RequestRefusedError, scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "websocket":
        # Closing before accepting: the client's handshake is answered by 403.
        await send({"type": "websocket.close", "code": _POLICY_VIOLATION})
        return
    response = refusal(refused.error, str(refused), refused.status, refused.expected)
    response.headers["connection"] = "close"
    await response(scope, receive, send)


def _too_large(most: int) -> RequestRefusedError:
    return RequestRefusedError(
        f"the body has more than {most:,} bytes, which is all that is read here",
        error="too-large",
        status=413,
    )
