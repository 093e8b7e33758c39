"""A server of robots in a process of its own, as the command starts it."""

import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

HYPERNAV = [sys.executable, "-c", "from hypernav.app.cli.main import main; main()"]


@contextmanager
def serving_process(state: Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """The process and its address, as soon as it listens."""
    command = [*HYPERNAV, "serve", "--port", "0", "--state", str(state)]
    server = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    assert server.stderr is not None
    address = ""
    for line in server.stderr:
        if "serving at" in line:
            address = line.split("serving at ")[1].split(",")[0]
            break
    reader = threading.Thread(target=server.stderr.read, daemon=True)
    reader.start()
    try:
        yield server, address
    finally:
        server.send_signal(signal.SIGCONT)
        server.terminate()
        server.wait(60.0)
        reader.join(5.0)
        server.stderr.close()


def simulate(scene: Path, address: str, *options: str) -> list[str]:
    """The command of a simulated robot that looks for the bed."""
    start = ["--start", "4.0", "-1.0", "180"]
    return [
        *[*HYPERNAV, "robot", "simulate", "bed", "--scene", str(scene)],
        *["--server", address, *start, *options],
    ]
