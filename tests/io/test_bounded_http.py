"""Exchanges that end in time and stay small, over real sockets."""

import gzip
import socket
import ssl
import threading
import time
import zlib
from collections.abc import Callable
from contextlib import closing, suppress
from pathlib import Path

import pytest

from hypernav.io import bounded_http
from hypernav.io.bounded_http import Deadline, Reply, ReplyTooLargeError, Session, environment_proxy
from servers.faulty import Act, FaultyServer, Talk

LIMIT_S = 0.4
LARGEST_REPLY_BYTES = 4 * 2**20
OK = b"HTTP/1.1 200 OK\r\n"
_CERTIFICATE = Path(__file__).parents[1] / "servers" / "localhost.pem"


def post(url: str, limit_s: float = 5.0, body: bytes = b"{}") -> Reply:
    proxy = environment_proxy(url)
    with closing(Session(largest_reply_bytes=LARGEST_REPLY_BYTES, proxy=proxy)) as session:
        return session.exchange(
            "POST",
            f"{url}/chat/completions",
            headers={"Content-Type": "application/json"},
            body=body,
            deadline=Deadline(limit_s),
            connect_limit_s=5.0,
        )


def answered(act: Act, limit_s: float = 5.0) -> Reply:
    with FaultyServer(act) as server:
        return post(server.url, limit_s)


SLOW: dict[str, Act] = {
    "a body byte by byte": lambda talk: (
        talk.send(OK + b"content-length: 99999\r\n\r\n"),
        talk.repeat(b" ", 0.02),
    )[0],
    "headers without end": lambda talk: (talk.send(OK), talk.repeat(b"x: y\r\n", 0.05))[0],
    "a header byte by byte": lambda talk: (talk.send(OK + b"x: "), talk.repeat(b"y", 0.02))[0],
    "a status line byte by byte": lambda talk: talk.repeat(b"H", 0.02),
    "100 Continue again and again": lambda talk: talk.repeat(
        b"HTTP/1.1 100 Continue\r\n\r\n", 0.02
    ),
    "100 Continue at full speed": lambda talk: talk.repeat(b"HTTP/1.1 100 Continue\r\n\r\n" * 1000),
    "chunks of one byte": lambda talk: (
        talk.send(OK + b"transfer-encoding: chunked\r\n\r\n"),
        talk.repeat(b"1\r\nx\r\n", 0.02),
    )[0],
    "trailers without end": lambda talk: (
        talk.send(OK + b"transfer-encoding: chunked\r\n\r\n0\r\n"),
        talk.repeat(b"x: y\r\n", 0.02),
    )[0],
    "silence": lambda talk: talk.wait(),
}


@pytest.mark.parametrize("name", SLOW)
def test_everything_ends_at_the_deadline(name: str):
    with FaultyServer(SLOW[name]) as server:
        begin = time.monotonic()
        with pytest.raises(TimeoutError):
            post(server.url, LIMIT_S)
        assert time.monotonic() - begin >= LIMIT_S


def test_a_request_that_nobody_reads_ends_at_the_deadline():
    with socket.create_server(("127.0.0.1", 0)) as listener, pytest.raises(TimeoutError):
        post(f"http://127.0.0.1:{listener.getsockname()[1]}", LIMIT_S, body=b"x" * 50_000_000)


def test_a_name_that_is_not_found_in_time(monkeypatch: pytest.MonkeyPatch):
    over = threading.Event()

    def never(*_: object, **__: object) -> None:
        over.wait(30.0)
        raise socket.gaierror("no such name")

    monkeypatch.setattr(socket, "getaddrinfo", never)
    try:
        with pytest.raises(TimeoutError):
            post("http://lab/v1", LIMIT_S)
    finally:
        over.set()


def test_after_a_late_reply_the_next_exchange_has_a_connection_of_its_own():
    def answer(talk: Talk) -> None:
        talk.wait(0.8 if talk.number == 0 else 0.0)
        talk.reply(str(talk.number).encode())

    with FaultyServer(answer) as server, closing(Session(largest_reply_bytes=100)) as session:
        said: list[bytes | str] = []
        for limit_s in (LIMIT_S, 5.0, 5.0):
            try:
                reply = session.exchange(
                    "POST",
                    f"{server.url}/chat/completions",
                    headers={},
                    body=b"{}",
                    deadline=Deadline(limit_s),
                    connect_limit_s=5.0,
                )
                said.append(reply.body)
            except TimeoutError:
                said.append("late")
    assert said == ["late", b"1", b"2"]


def test_a_key_that_is_no_header_does_not_show():
    with (
        FaultyServer(lambda talk: talk.reply(b"{}")) as server,
        closing(Session(largest_reply_bytes=100)) as session,
        pytest.raises(ValueError, match="characters that HTTP does not allow") as caught,
    ):
        session.exchange(
            "GET",
            server.url,
            headers={"Authorization": "Bearer secret\nkey"},
            body=None,
            deadline=Deadline(5.0),
            connect_limit_s=5.0,
        )
    assert "secret" not in str(caught.value)


def chunked(talk: Talk) -> None:
    talk.send(OK + b"transfer-encoding: chunked\r\n\r\n")
    talk.repeat(b"10000\r\n" + b"x" * 65536 + b"\r\n")


BOMBS: dict[str, Act] = {
    "a body without end": lambda talk: (talk.send(OK + b"\r\n"), talk.repeat(b" " * 65536))[0],
    "a body that says how large it is": lambda talk: (
        talk.send(OK + b"content-length: 1000000000000\r\n\r\n"),
        talk.repeat(b" " * 65536),
    )[0],
    "chunks without end": chunked,
    "a gzip bomb": lambda talk: talk.reply(
        gzip.compress(bytes(200_000_000), 1), content_encoding="gzip"
    ),
    "a deflate bomb": lambda talk: talk.reply(
        zlib.compress(bytes(200_000_000), 1), content_encoding="deflate"
    ),
}


@pytest.mark.parametrize("name", BOMBS)
def test_nothing_is_larger_than_the_limit(name: str):
    with pytest.raises(ReplyTooLargeError, match="4 MiB"):
        answered(BOMBS[name], 60.0)


@pytest.mark.parametrize("size", [0, 1, 100_000, LARGEST_REPLY_BYTES - 1000])
@pytest.mark.parametrize(
    ("coding", "pack"),
    [("identity", bytes), ("gzip", gzip.compress), ("deflate", zlib.compress)],
)
def test_what_is_not_too_large_comes_whole(size: int, coding: str, pack: Callable[[bytes], bytes]):
    body = b"x" * size
    assert answered(lambda talk: talk.reply(pack(body), content_encoding=coding)).body == body


@pytest.mark.parametrize("coding", ["br", "zstd", "gzip, gzip", "\x1b[31m"])
def test_unknown_packings_are_refused(coding: str):
    with pytest.raises(ValueError, match="packed"):
        answered(lambda talk: talk.reply(b"{}", content_encoding=coding))


def test_a_broken_packing_is_refused():
    with pytest.raises(ValueError, match="cannot be unpacked"):
        answered(lambda talk: talk.reply(b"not gzip", content_encoding="gzip"))


@pytest.mark.parametrize(
    "garbage", [b"", b"SSH-2.0-OpenSSH_9.6\r\n", b"HTTP/1.1 abc\r\n\r\n", b"\x16\x03\x01" * 99]
)
def test_what_is_not_http(garbage: bytes):
    with pytest.raises((OSError, ValueError)):
        answered(lambda talk: talk.send(garbage))


@pytest.mark.parametrize("location", ["http://127.0.0.1:1/v1", "\x1b[31m"])
def test_redirections_are_not_followed(location: str):
    reply = answered(lambda talk: talk.reply(b"", 307, location=location))
    assert (reply.status, reply.headers["location"]) == (307, location)


def test_a_server_that_hangs_up_early_may_say_why():
    def refuse(connection: socket.socket) -> None:
        with connection:
            connection.recv(1000)
            connection.sendall(b"HTTP/1.1 413 Too Large\r\ncontent-length: 0\r\n\r\n")
            connection.shutdown(socket.SHUT_WR)
            while connection.recv(65536):
                pass

    with socket.create_server(("127.0.0.1", 0)) as listener:
        thread = threading.Thread(target=lambda: refuse(listener.accept()[0]))
        thread.start()
        reply = post(f"http://127.0.0.1:{listener.getsockname()[1]}", body=b"x" * 5_000_000)
        thread.join()
    assert reply.status == 413


def test_a_proxy_of_the_environment_is_used(monkeypatch: pytest.MonkeyPatch):
    seen: list[str] = []

    def proxy(connection: socket.socket) -> None:
        with connection:
            seen.append(connection.recv(65536).decode())
            connection.sendall(b"HTTP/1.1 200 OK\r\ncontent-length: 2\r\n\r\n{}")

    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
        monkeypatch.setenv("http_proxy", f"http://me:secret@127.0.0.1:{port}")
        monkeypatch.setenv("no_proxy", "")
        thread = threading.Thread(target=lambda: proxy(listener.accept()[0]))
        thread.start()
        assert post("http://lab.example/v1").body == b"{}"
        thread.join()
    assert seen[0].startswith("POST http://lab.example/v1/chat/completions HTTP/1.1")
    assert "Proxy-Authorization: Basic bWU6c2VjcmV0" in seen[0]


def test_a_tunnel_through_a_proxy_that_refuses(monkeypatch: pytest.MonkeyPatch):
    def proxy(connection: socket.socket) -> None:
        with connection:
            assert connection.recv(65536).startswith(b"CONNECT lab.example:443 HTTP/1.1")
            connection.sendall(b"HTTP/1.1 407 Who are you\r\n\r\n")

    with socket.create_server(("127.0.0.1", 0)) as listener:
        monkeypatch.setenv("https_proxy", f"127.0.0.1:{listener.getsockname()[1]}")
        monkeypatch.setenv("no_proxy", "")
        thread = threading.Thread(target=lambda: proxy(listener.accept()[0]))
        thread.start()
        with pytest.raises(OSError, match="the proxy answered 407"):
            post("https://lab.example/v1")
        thread.join()


def test_a_server_that_does_not_answer_a_handshake():
    with FaultyServer(lambda talk: None) as server, pytest.raises(TimeoutError):
        post(server.url.replace("http:", "https:"), LIMIT_S)


def over_tls(monkeypatch: pytest.MonkeyPatch, *, trusted: bool) -> Reply:
    """An exchange with a server whose certificate only this test may trust."""
    served = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    served.load_cert_chain(_CERTIFICATE)
    if trusted:
        trusting = ssl.create_default_context(cafile=_CERTIFICATE)
        monkeypatch.setattr(bounded_http, "_tls", lambda: trusting)

    def serve(connection: socket.socket) -> None:
        with suppress(ssl.SSLError), served.wrap_socket(connection, server_side=True) as safe:
            received = b""
            while not received.endswith(b"{}"):
                received += safe.recv(65536)
            safe.sendall(OK + b"content-length: 2\r\n\r\n{}")

    with socket.create_server(("127.0.0.1", 0)) as listener:
        thread = threading.Thread(target=lambda: serve(listener.accept()[0]))
        thread.start()
        try:
            return post(f"https://localhost:{listener.getsockname()[1]}/v1")
        finally:
            thread.join()


def test_a_certificate_that_is_trusted(monkeypatch: pytest.MonkeyPatch):
    assert over_tls(monkeypatch, trusted=True).body == b"{}"


def test_a_certificate_that_nobody_trusts(monkeypatch: pytest.MonkeyPatch):
    with pytest.raises(OSError, match="CERTIFICATE_VERIFY_FAILED"):
        over_tls(monkeypatch, trusted=False)
