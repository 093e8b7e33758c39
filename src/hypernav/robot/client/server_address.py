"""The address of a robot's server, and the token that it asks for."""

from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urlsplit

from hypernav.core.errors import RobotLinkError


@dataclass(frozen=True)
class ServerAddress:
    """Where the server is, and the token for it.

    Attributes:
        host: Name or address of the machine.
        port: Port of the server.
        path: Prefix of all request paths; usually empty.
        is_secure: Whether the connection is encrypted (``https``).
        token: Token of the server; None sends none.
    """

    host: str
    port: int
    path: str = ""
    is_secure: bool = False
    token: str | None = field(default=None, repr=False)

    @staticmethod
    def of(url: str, token_file: Path | None = None) -> "ServerAddress":
        """Read an address such as ``http://192.168.1.5:8765``.

        Raises:
            RobotLinkError: The text is no such address, or the token file cannot be read.
        """
        try:
            parts = urlsplit(url)
            port = parts.port
        except ValueError as error:
            raise RobotLinkError(f"address of the server '{url:.100}': {error}") from error
        if parts.scheme not in ("http", "https") or not parts.hostname:
            raise RobotLinkError(
                f"address of the server '{url:.100}': expected one such as http://192.168.1.5:8765"
            )
        secure = parts.scheme == "https"
        token = None
        if token_file is not None:
            try:
                token = token_file.read_text(encoding="utf-8").strip()
            except (OSError, UnicodeDecodeError) as error:
                raise RobotLinkError(f"{token_file}: cannot read the token: {error}") from error
        return ServerAddress(
            parts.hostname, port or (443 if secure else 80), parts.path.rstrip("/"), secure, token
        )

    @property
    def headers(self) -> dict[str, str]:
        """The headers of every request."""
        return {} if self.token is None else {"Authorization": f"Bearer {self.token}"}

    def __str__(self) -> str:
        """The address for people, without the token."""
        return f"http{'s' * self.is_secure}://{self.host}:{self.port}{self.path}"
