"""Model servers as their makers ship them, with models of random weights."""

import os
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import pytest

_HERE = Path(__file__).parent


class LlamaServer:
    """A running server of llama.cpp.

    Attributes:
        root: Its URL without a path.
        process: Its process.
    """

    def __init__(self, port: int, process: subprocess.Popen, log: Path) -> None:
        """Keep them."""
        self.root = f"http://127.0.0.1:{port}"
        self.url = f"{self.root}/v1"
        self.spec = f"openai:{self.url}"
        self.process = process
        self._log = log

    def said(self) -> str:
        """Its log."""
        return self._log.read_text()

    def wait(self) -> None:
        """Wait until its model is loaded."""
        end = time.monotonic() + 60.0
        while time.monotonic() < end and self.process.poll() is None:
            try:
                urllib.request.urlopen(f"{self.root}/health", timeout=2.0).close()
            except OSError:
                time.sleep(0.05)
            else:
                return
        pytest.fail(f"llama.cpp's server did not start: {self.said()[-2000:]}")


Start = Callable[..., AbstractContextManager[LlamaServer]]


@pytest.fixture(scope="session")
def start_llamacpp(tmp_path_factory: pytest.TempPathFactory) -> Start:
    """Starts a server; takes its ``--image-min-tokens``, if any."""
    for package in ("xllamacpp", "gguf"):
        pytest.importorskip(package, reason="needs llama.cpp: pip install xllamacpp gguf")
    from tiny_gguf import write_model

    folder = tmp_path_factory.mktemp("llamacpp")
    files = [str(one) for one in write_model(folder)]

    @contextmanager
    def start(*min_tokens: str) -> Iterator[LlamaServer]:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        log = folder / f"{port}.log"
        with log.open("w") as said:
            process = subprocess.Popen(
                [sys.executable, _HERE / "serve_llamacpp.py", str(port), *files, *min_tokens],
                stdout=said,
                stderr=subprocess.STDOUT,
                env={**os.environ, "OMP_NUM_THREADS": "1"},
            )
            try:
                yield LlamaServer(port, process, log)
            finally:
                process.kill()
                process.wait(timeout=20.0)

    return start


@pytest.fixture(scope="session")
def llamacpp(start_llamacpp: Start) -> Iterator[LlamaServer]:
    """One server for all tests that don't stop it."""
    with start_llamacpp() as server:
        server.wait()
        yield server
