"""One exchange over HTTP that ends in time and stays small, whatever the server does.

The timeouts of HTTP libraries hold for a single wait on the socket. A server that sends a byte now
and then, headers without end or ``100 Continue`` again and again keeps such a client for ever. Here
every wait, from the look-up of the name to the last byte, ends at one deadline, and what comes in
is counted before and after it is unpacked.

A connection serves one exchange: a robot asks every few seconds, and servers close idle connections
sooner (vLLM after 5 s).
"""

import base64
import functools
import http.client
import io
import queue
import socket
import ssl
import threading
import urllib.request
import zlib
from collections.abc import Mapping
from contextlib import closing, suppress
from dataclasses import dataclass
from typing import Any, cast
from urllib.parse import SplitResult, unquote, urlsplit

import truststore

from hypernav.models.chat.server.deadline import Deadline

LARGEST_REPLY_BYTES = 4 * 2**20
"""Limit of a reply with its headers, and of its unpacked body: an answer has a few kilobytes, one
with probabilities or a long list of models about one megabyte. Parsing the worst takes a second."""

_PORTS = {"http": 80, "https": 443}


class ReplyTooLargeError(OSError):
    """A reply is larger than `LARGEST_REPLY_BYTES`."""


@dataclass(frozen=True)
class Reply:
    """The reply of a server.

    Attributes:
        status: HTTP status code.
        headers: Headers; names are compared without regard to case.
        body: Body, unpacked.
    """

    status: int
    headers: http.client.HTTPMessage
    body: bytes


def exchange(
    method: str,
    url: str,
    *,
    headers: Mapping[str, str],
    body: bytes | None,
    deadline: Deadline,
    connect_limit_s: float,
) -> Reply:
    """Send a request and receive its reply. Redirections are not followed.

    A proxy that the environment names (``http_proxy``, ``https_proxy``, ``no_proxy``) is used.

    Args:
        method: HTTP method.
        url: URL, ``http://`` or ``https://``.
        headers: Headers of the request.
        body: Body of the request; None for none.
        deadline: Moment at which all of it has to be over.
        connect_limit_s: Longest time for the connection to be made, seconds.

    Raises:
        TimeoutError: It was not over in time.
        OSError: No connection, a lost one, or (`ReplyTooLargeError`) too large a reply.
        http.client.HTTPException: The reply is not HTTP.
        ValueError: The reply is not HTTP, or packed in an unknown way.
    """
    parts = urlsplit(url)
    proxy = _proxy_for(parts)
    headers = {"Host": parts.netloc, "Connection": "close", **headers}
    target = parts.path or "/"
    with closing(_connect(proxy or parts, deadline.within(connect_limit_s))) as plain:
        sock = plain
        if proxy is not None and parts.scheme == "http":
            target, headers = url, headers | _proxy_headers(proxy)
        elif proxy is not None:
            _open_tunnel(_Wire(sock, deadline), parts, _proxy_headers(proxy))
        if parts.scheme == "https":
            sock.settimeout(deadline.timeout())
            sock = _tls().wrap_socket(sock, server_hostname=parts.hostname)
        with closing(sock):
            return _converse(_Wire(sock, deadline), method, target, headers, body)


class _Wire(io.RawIOBase):
    """What `http.client` needs of a socket: every wait ends at the deadline, bytes are counted.

    Closing it does nothing, for `http.client` closes before it has read; `exchange` closes.
    """

    def __init__(self, sock: socket.socket, deadline: Deadline) -> None:
        self._sock = sock
        self._deadline = deadline
        self._received = 0

    def sendall(self, data: bytes) -> None:
        view = memoryview(data)
        while view:
            self._sock.settimeout(self._deadline.timeout())
            view = view[self._sock.send(view) :]

    def makefile(self, mode: str) -> io.BufferedReader:
        return io.BufferedReader(self)

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        self._sock.settimeout(self._deadline.timeout())
        count = self._sock.recv_into(buffer)
        self._received += count
        _check_size(self._received)
        return count

    def close(self) -> None:
        pass


def _converse(
    wire: _Wire, method: str, target: str, headers: Mapping[str, str], body: bytes | None
) -> Reply:
    """Send a request and receive its reply over an open connection."""
    connection = http.client.HTTPConnection("unused")
    connection.sock = cast(socket.socket, wire)
    # A server that has heard enough may still say why before it hangs up.
    with suppress(BrokenPipeError, ConnectionResetError):
        connection.request(method, target, body, dict(headers))
    response = connection.getresponse()
    packed = b"" if method == "CONNECT" else response.read(LARGEST_REPLY_BYTES + 1)
    _check_size(len(packed))
    coding = response.headers.get("content-encoding", "")
    return Reply(response.status, response.headers, _unpacked(packed, coding))


def _unpacked(packed: bytes, coding: str) -> bytes:
    """The body without its content coding. None is asked for, but some proxies pack anyway."""
    match coding.strip().lower():
        case "" | "identity":
            return packed
        case "gzip" | "x-gzip" | "deflate":
            unpacker = zlib.decompressobj(zlib.MAX_WBITS | 32)  # 32: either header
            try:
                body = unpacker.decompress(packed, LARGEST_REPLY_BYTES + 1)
            except zlib.error as error:
                raise ValueError(f"the reply cannot be unpacked: {error}") from error
            _check_size(len(body))
            return body
    raise ValueError(f"the reply is packed as '{coding}', which was not asked for")


def _check_size(count: int) -> None:
    if count > LARGEST_REPLY_BYTES:
        limit = LARGEST_REPLY_BYTES // 2**20
        raise ReplyTooLargeError(f"the reply is larger than {limit} MiB, which no answer needs")


def _connect(parts: SplitResult, deadline: Deadline) -> socket.socket:
    """Connect to the first address of the host that takes the connection."""
    host, port = parts.hostname or "", parts.port or _PORTS[parts.scheme]
    addresses = _addresses(host, port, deadline)
    failed = OSError(f"{host} has no address")
    for number, (family, kind, protocol, _, address) in enumerate(addresses):
        sock = socket.socket(family, kind, protocol)
        try:
            sock.settimeout(deadline.timeout() / (len(addresses) - number))
            sock.connect(address)
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        except OSError as error:
            sock.close()
            failed = error
        else:
            return sock
    raise failed


def _addresses(host: str, port: int, deadline: Deadline) -> list[Any]:
    """Addresses of a host. The system's look-up knows no timeout, so a thread does it."""
    found: queue.SimpleQueue[list[Any] | Exception] = queue.SimpleQueue()

    def look_up() -> None:
        try:
            found.put(socket.getaddrinfo(host, port, type=socket.SOCK_STREAM))
        except (OSError, ValueError) as error:
            found.put(error)

    threading.Thread(target=look_up, daemon=True).start()
    try:
        result = found.get(timeout=deadline.timeout())
    except queue.Empty:
        raise TimeoutError(f"the address of {host} was not found in time") from None
    if isinstance(result, Exception):
        raise result
    return result


def _proxy_for(parts: SplitResult) -> SplitResult | None:
    """The proxy that the environment names for a server."""
    proxies = urllib.request.getproxies()
    proxy = proxies.get(parts.scheme) or proxies.get("all")
    if not proxy or urllib.request.proxy_bypass(parts.netloc):
        return None
    found = urlsplit(proxy if "://" in proxy else f"http://{proxy}")
    if found.scheme != "http" or not found.hostname:
        raise ValueError(f"the environment names a proxy that is not http:// ({found.scheme}://)")
    return found


def _proxy_headers(proxy: SplitResult) -> dict[str, str]:
    if proxy.username is None:
        return {}
    user = f"{unquote(proxy.username)}:{unquote(proxy.password or '')}"
    return {"Proxy-Authorization": f"Basic {base64.b64encode(user.encode()).decode('ascii')}"}


def _open_tunnel(wire: _Wire, parts: SplitResult, headers: dict[str, str]) -> None:
    """Have a proxy pass bytes on to the server."""
    server = f"{parts.hostname}:{parts.port or _PORTS[parts.scheme]}"
    reply = _converse(wire, "CONNECT", server, {"Host": server, **headers}, None)
    if reply.status != 200:
        raise OSError(f"the proxy answered {reply.status}")


@functools.cache
def _tls() -> ssl.SSLContext:
    """TLS as the system trusts it."""
    return truststore.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
