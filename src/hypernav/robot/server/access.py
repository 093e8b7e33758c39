"""Who may use the server: by its address, the page that asks, and the token."""

import hmac
import ipaddress
from dataclasses import dataclass
from urllib.parse import urlsplit

from starlette.datastructures import Headers

from hypernav.core.errors import RequestRefusedError

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
