"""Exchanges over HTTP that end in time and stay small, whatever the server does.

The timeouts of httpx hold for a single wait on the socket. A server that sends a byte now and then,
headers without end or ``100 Continue`` again and again keeps such a client for ever, as does a
look-up of a name. Here httpx works in a thread of its own, and whoever waits for it waits until one
deadline; then the connection is cut, which ends the thread too.
"""

import functools
import importlib.util
import ipaddress
import ssl
import threading
import time
import urllib.request
import zlib
from collections.abc import Callable, Mapping
from contextlib import closing, suppress
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from socket import SHUT_RDWR, socket
from typing import Any
from urllib.parse import SplitResult, urlsplit

import httpx
import truststore

LONGEST_WORK_S = 600.0
"""Time by which work can put a deadline off: signs of life alone are no answer."""
_SCHEMES = {"http", "https", "socks5", "socks5h"}


def is_loopback(host: str) -> bool:
    """Whether a host is this machine, by its name or its address."""
    name = host.casefold().rstrip(".")
    if name == "localhost" or name.endswith(".localhost"):
        return True
    address = _address(name)
    return address is not None and (address.is_loopback or address.is_unspecified)


def environment_proxy(url: str) -> str | None:
    """The proxy that the environment names (``http_proxy``, ``https_proxy``, ``no_proxy``).

    Loopback addresses are never asked through a proxy; this machine's own name or network address
    is, unless ``no_proxy`` holds it. That may hold names and networks (``10.0.0.0/8``).

    Raises:
        ValueError: The proxy cannot be used.
    """
    parts, proxies = urlsplit(url), urllib.request.getproxies()
    host, proxy = parts.hostname or "", proxies.get(parts.scheme) or proxies.get("all")
    if not proxy or is_loopback(host) or _is_excepted(host, proxies.get("no", "")):
        return None
    if urllib.request.proxy_bypass(parts.netloc):
        return None
    proxy = proxy if "://" in proxy else f"http://{proxy}"
    found = _parts(proxy)
    if found.scheme not in _SCHEMES or not found.hostname:
        raise ValueError(
            f"the environment names a proxy of an unknown kind ({found.scheme}://); expected "
            f"http://, https:// or socks5://, or no_proxy={host} to ask the server itself"
        )
    if found.scheme.startswith("socks") and importlib.util.find_spec("socksio") is None:
        raise ValueError(
            f"the environment names a SOCKS proxy ({without_password(proxy)}), which needs a "
            f"package: pip install 'httpx[socks]', or set no_proxy={host} to ask the server itself"
        )
    return proxy


def _parts(proxy: str) -> SplitResult:
    """The parts of a proxy's URL.

    Raises:
        ValueError: It is malformed, or its port is.
    """
    try:
        parts = urlsplit(proxy)
        _ = parts.port
    except ValueError as error:
        raise ValueError(
            f"the environment names a proxy whose URL is malformed ({error}); expected something "
            "like http://proxy:3128"
        ) from None
    return parts


def without_password(proxy: str) -> str:
    """The URL of a proxy for messages, without name and password."""
    parts = urlsplit(proxy)
    return parts._replace(netloc=parts.netloc.rpartition("@")[2]).geturl()


def _is_excepted(host: str, exceptions: str) -> bool:
    """Whether ``no_proxy`` holds a network with this address, which urllib doesn't look for."""
    address = _address(host)
    for entry in exceptions.split(","):
        try:
            network = ipaddress.ip_network(entry.strip().strip("[]"), strict=False)
        except ValueError:
            continue
        if address is not None and address in network:
            return True
    return False


def _address(host: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return None
    return getattr(address, "ipv4_mapped", None) or address


class Deadline:
    """A moment that everything done for one purpose shares, however many waits it takes.

    Attributes:
        limit_s: Time from the beginning to the deadline, seconds.
        whole: The deadline of which this is a part; None for one that is no part of another.
    """

    def __init__(
        self,
        limit_s: float,
        clock: Callable[[], float] = time.monotonic,
        whole: "Deadline | None" = None,
    ) -> None:
        """Begin now.

        Args:
            limit_s: Time until the deadline, seconds.
            clock: Function that returns monotonic seconds.
            whole: The deadline of which this is a part.
        """
        self.limit_s = limit_s
        self.whole = whole
        self._clock = clock
        self._end = clock() + limit_s
        self._latest = self._end + LONGEST_WORK_S

    @property
    def seconds_left(self) -> float:
        """Time until the deadline; 0 once it has passed."""
        return max(self._end - self._clock(), 0.0)

    def within(self, limit_s: float) -> "Deadline":
        """The sooner of this deadline and a new one that begins now, as a part of this one."""
        return Deadline(min(limit_s, self.seconds_left), self._clock, self)

    def put_off(self, work_s: float) -> None:
        """Leave time in which the other side worked out of account, here and in the whole."""
        self._end = min(self._end + work_s, self._latest)
        if self.whole is not None:
            self.whole.put_off(work_s)


class ReplyTooLargeError(OSError):
    """A reply is larger than the session allows."""


@dataclass(frozen=True)
class Reply:
    """The reply of a server.

    Attributes:
        status: HTTP status code.
        headers: Headers; names are compared without regard to case.
        body: Body, unpacked.
    """

    status: int
    headers: Mapping[str, str]
    body: bytes


class Session:
    """Exchanges with one server, over a connection that is opened anew where it ended.

    One thread at a time may use it.
    """

    def __init__(self, *, largest_reply_bytes: int, proxy: str | None = None) -> None:
        """Prepare; the first exchange connects.

        Args:
            largest_reply_bytes: Largest body that a reply may have, packed or unpacked.
            proxy: URL of a proxy (see `proxies.environment_proxy`); None asks the server itself.
        """
        self._largest = largest_reply_bytes
        self._proxy = proxy
        self._connection = _Connection(proxy)

    def exchange(
        self,
        method: str,
        url: str,
        *,
        headers: Mapping[str, str],
        body: bytes | None,
        deadline: Deadline,
        connect_limit_s: float,
        is_alive: Callable[[], bool] | None = None,
    ) -> Reply:
        """Send a request and receive its reply. Redirections are not followed.

        Args:
            method: HTTP method.
            url: URL, ``http://`` or ``https://``.
            headers: Headers of the request.
            body: Body of the request; None for none.
            deadline: Moment at which all of it has to be over.
            connect_limit_s: Longest wait for one of the server's addresses to connect, seconds.
            is_alive: Whether the server still answers anything. With it, lines of the reply's body
                put the deadline off, and while it is true the wait goes on until the whole of which
                the deadline is a part.

        Raises:
            TimeoutError: It was not over in time.
            OSError: No connection, a lost one, or (`ReplyTooLargeError`) too large a reply.
            ValueError: The reply is not HTTP, or packed in an unknown way.
        """
        connection, left_s = self._connection, deadline.seconds_left
        if not left_s:  # a socket that may not wait at all tells of no timeout
            raise TimeoutError(f"not done within {deadline.limit_s:.3g} s")
        whole = deadline.whole if is_alive and deadline.whole else deadline
        timeout = httpx.Timeout(whole.seconds_left, connect=min(connect_limit_s, left_s))
        done: SimpleQueue[Reply | Exception | None] = SimpleQueue()

        def tell_of_a_line() -> None:
            if is_alive:
                done.put(None)

        def work() -> None:
            ask = (method, url, headers, body, timeout, self._largest, tell_of_a_line)
            done.put(connection.outcome(*ask))
            if connection.given_up.is_set():
                connection.close()

        threading.Thread(target=work, daemon=True).start()
        is_over = False
        try:
            found = _awaited(done, deadline, whole, is_alive)
            is_over = True
        finally:
            if not is_over:  # late, or Ctrl-C
                self._connection = _Connection(self._proxy)
                connection.give_up()
                if not done.empty():  # it ended just now, perhaps before it could notice
                    connection.close()
        if isinstance(found, Exception):
            raise found
        return found

    def close(self) -> None:
        """End the connection."""
        self._connection.close()


def _awaited(
    done: SimpleQueue[Reply | Exception | None],
    deadline: Deadline,
    whole: Deadline,
    is_alive: Callable[[], bool] | None,
) -> Reply | Exception:
    """What a thread has found; None tells of work in between.

    Raises:
        TimeoutError: It finds nothing in time.
    """
    begin_s = whole.seconds_left
    while True:
        try:
            found = done.get(timeout=deadline.seconds_left)
        except Empty:
            if deadline is whole or not whole.seconds_left or not (is_alive and is_alive()):
                raise TimeoutError(f"not done within {deadline.limit_s:.3g} s") from None
            deadline = whole
            continue
        if found is not None:
            return found
        deadline.put_off(begin_s - whole.seconds_left)
        begin_s = whole.seconds_left


class _Connection:
    """What the thread of an exchange uses, and keeps for itself where nobody waits any more."""

    def __init__(self, proxy: str | None) -> None:
        # A client would look at redirections, and refuse a reply for a malformed one.
        self._transport = httpx.HTTPTransport(verify=_tls(), trust_env=False, proxy=proxy)
        self._socket: socket | None = None
        self._is_new = True
        self.given_up = threading.Event()

    def outcome(
        self,
        method: str,
        url: str,
        headers: Mapping[str, str],
        body: bytes | None,
        timeout: httpx.Timeout,
        largest: int,
        tell_of_a_line: Callable[[], None],
    ) -> Reply | Exception:
        """The reply, or what went wrong in terms of Python."""
        headers = {"Accept-Encoding": "identity", "User-Agent": "hypernav", **headers}
        self._is_new = False
        packed, options = bytearray(), {"timeout": timeout.as_dict(), "trace": self._watch}
        try:
            request = httpx.Request(method, url, headers=headers, content=body, extensions=options)
            with closing(self._transport.handle_request(request)) as response:
                for chunk in response.iter_raw():
                    packed += chunk
                    _check_size(len(packed), largest)
                    if b"\n" in chunk:
                        tell_of_a_line()
            coding = response.headers.get("content-encoding", "")
            return Reply(response.status_code, response.headers, _unpacked(packed, coding, largest))
        except httpx.TimeoutException as error:
            return TimeoutError(str(error))
        except httpx.ProxyError as error:
            return OSError(f"the proxy answered {error}")
        except (httpx.RemoteProtocolError, httpx.NetworkError) as error:
            if not self._is_new:  # the server may have closed it because nobody used it for a while
                ask = (method, url, headers, body, timeout, largest, tell_of_a_line)
                return self.outcome(*ask)
            return _system_error(error)
        except httpx.LocalProtocolError:  # its words show the header, which may be the key
            return ValueError("a header of the request holds characters that HTTP does not allow")
        except (httpx.HTTPError, httpx.InvalidURL) as error:
            return ValueError(str(error))
        except (OSError, ValueError) as error:
            return error

    def give_up(self) -> None:
        """Cut the connection; the thread, which notices, closes it."""
        self.given_up.set()
        if self._socket is not None:
            with suppress(OSError):  # it has ended by itself
                self._socket.shutdown(SHUT_RDWR)

    def close(self) -> None:
        """Close the connection, which no thread uses; may be called again."""
        self._transport.close()
        copy, self._socket = self._socket, None
        if copy is not None:
            copy.close()

    def _watch(self, event: str, info: dict[str, Any]) -> None:
        """Called by httpx before and after each part of an exchange."""
        if event.endswith(".connect_tcp.started"):  # of "connection", or of "socks"
            self._is_new = True
        if event.endswith(".connect_tcp.complete"):
            if self._socket is not None:
                self._socket.close()
            # A copy, for TLS takes the socket itself over.
            self._socket = info["return_value"].get_extra_info("socket").dup()
        if event.endswith("send_request_headers.started") and self.given_up.is_set():
            raise TimeoutError("given up")  # connected too late: nothing is sent


def _unpacked(packed: bytes | bytearray, coding: str, largest: int) -> bytes:
    """The body without its content coding. None is asked for, but some proxies pack anyway."""
    match coding.strip().lower():
        case "" | "identity":
            return bytes(packed)
        case "gzip" | "x-gzip" | "deflate":
            unpacker = zlib.decompressobj(zlib.MAX_WBITS | 32)  # 32: either header
            try:
                body = unpacker.decompress(packed, largest + 1)
            except zlib.error as error:
                raise ValueError(f"the reply cannot be unpacked: {error}") from error
            _check_size(len(body), largest)
            return body
    raise ValueError(f"the reply is packed as '{coding}', which was not asked for")


def _check_size(count: int, largest: int) -> None:
    if count > largest:
        raise ReplyTooLargeError(
            f"the reply is larger than {largest // 2**20} MiB, which no answer needs"
        )


def _system_error(error: httpx.RemoteProtocolError | httpx.NetworkError) -> OSError | ValueError:
    """The system's own error, which httpx and httpcore wrap, or what is wrong with the reply."""
    cause: BaseException | None = error
    while cause is not None:
        if isinstance(cause, OSError):
            return cause
        cause = cause.__cause__ or cause.__context__
    return ValueError(str(error)) if isinstance(error, httpx.ProtocolError) else OSError(str(error))


@functools.cache
def _tls() -> ssl.SSLContext:
    """TLS as the system trusts it."""
    return truststore.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
