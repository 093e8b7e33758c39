"""A model server that sends raw bytes: all that no HTTP framework would send, and slowly.

What it does with a request is a function of the talk, the open connection with the request that
came in. Whatever else it is asked is answered well unless told otherwise.
"""

import json
import socket
import struct
import threading
from collections.abc import Callable
from typing import Any

MODEL = "faulty/Qwen2.5-VL-7B"
_TEST_IS_OVER_S = 60.0


class HungUpError(Exception):
    """The client has closed the connection, or the server is being stopped."""


class Talk:
    """One request and the open connection on which it is answered."""

    def __init__(self, connection: socket.socket, stopped: threading.Event, number: int) -> None:
        self._connection = connection
        self._stopped = stopped
        self.number = number
        self.method, self.path, self.headers, self.body = self._request()

    def _request(self) -> tuple[str, str, dict[str, str], Any]:
        data = b""
        while b"\r\n\r\n" not in data:
            data += self._receive()
        head, _, body = data.partition(b"\r\n\r\n")
        first, *lines = head.decode("latin-1").split("\r\n")
        method, path, _ = first.split(" ")
        headers = {k.lower(): v.strip() for k, _, v in (line.partition(":") for line in lines)}
        while len(body) < int(headers.get("content-length", 0)):
            body += self._receive()
        return method, path, headers, json.loads(body) if body else None

    def _receive(self) -> bytes:
        if not (data := self._connection.recv(65536)):
            raise HungUpError
        return data

    def send(self, data: bytes) -> None:
        """Send bytes as they are."""
        if self._stopped.is_set():
            raise HungUpError
        self._connection.sendall(data)

    def wait(self, seconds: float = _TEST_IS_OVER_S) -> None:
        """Do nothing."""
        if self._stopped.wait(seconds):
            raise HungUpError

    def drip(self, data: bytes, every_s: float = 0.05) -> None:
        """Send byte for byte."""
        for byte in data:
            self.send(bytes([byte]))
            self.wait(every_s)

    def repeat(self, data: bytes, every_s: float = 0.0) -> None:
        """Send the same again and again, without end."""
        while True:
            self.send(data)
            if every_s:
                self.wait(every_s)

    def reset(self) -> None:
        """Cut the connection as a crash does."""
        self._connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        raise HungUpError

    def reply(self, body: bytes | Any, status: object = 200, **headers: str) -> None:
        """Send a whole reply; what is not bytes is sent as JSON."""
        data = body if isinstance(body, bytes) else json.dumps(body).encode()
        named = {"content-type": "application/json", "content-length": str(len(data))}
        named |= {name.replace("_", "-"): value for name, value in headers.items()}
        lines = "".join(f"{name}: {value}\r\n" for name, value in named.items())
        self.send(f"HTTP/1.1 {status} Whatever\r\n{lines}\r\n".encode("latin-1") + data)

    def say(self, content: Any, **changes: Any) -> None:
        """Send a chat completion."""
        self.reply(completion(content) | changes)


def completion(content: Any, **choice: Any) -> dict[str, Any]:
    """A chat completion with this content."""
    message = {"role": "assistant", "content": content}
    return {
        "choices": [{"index": 0, "message": message, "finish_reason": "stop", **choice}],
        "usage": {"prompt_tokens": 100, "completion_tokens": 5},
    }


Act = Callable[[Talk], None]


def list_models(talk: Talk) -> None:
    """A list of the one model, as vLLM sends it."""
    talk.reply({"object": "list", "data": [{"id": MODEL, "owned_by": "vllm"}]})


def answer_version(talk: Talk) -> None:
    """The version of vLLM, and that there is nothing else."""
    if talk.path == "/version":
        talk.reply({"version": "0.12.1"})
    else:
        talk.reply({"detail": "Not Found"}, 404)


class FaultyServer:
    """The server, in threads of its own. Use as a context manager."""

    def __init__(self, act: Act, *, models: Act = list_models, other: Act = answer_version) -> None:
        """Prepare.

        Args:
            act: What it does with a question.
            models: What it does when asked for its models.
            other: What it does with any other request.
        """
        self._act = act
        self._other = other
        self._models = models
        self._stopped = threading.Event()
        self._listener = socket.create_server(("127.0.0.1", 0), backlog=64)
        self.port: int = self._listener.getsockname()[1]
        self.questions = 0

    @property
    def url(self) -> str:
        """URL of its API."""
        return f"http://127.0.0.1:{self.port}/v1"

    def __enter__(self) -> "FaultyServer":
        threading.Thread(target=self._accept, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stopped.set()
        self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()

    def _accept(self) -> None:
        while not self._stopped.is_set():
            try:
                connection, _ = self._listener.accept()
            except OSError:
                return
            threading.Thread(target=self._serve, args=(connection,), daemon=True).start()

    def _serve(self, connection: socket.socket) -> None:
        with connection:
            try:
                talk = Talk(connection, self._stopped, self.questions)
                match talk.method, talk.path:
                    case "GET", "/v1/models":
                        self._models(talk)
                    case "POST", "/v1/chat/completions":
                        self.questions += 1
                        self._act(talk)
                    case _:
                        self._other(talk)
            except (HungUpError, OSError):
                pass
