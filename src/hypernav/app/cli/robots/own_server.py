"""Starts a server for a robot, simulated or on ROS 2, if the command names none."""

import re
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from hypernav.core.errors import RobotLinkError

_MAIN = "from hypernav.app.cli.main import main; main()"


@contextmanager
def server_at(url: str | None, options: Sequence[str] = ()) -> Iterator[str]:
    """The address of a server: the given one, or one that runs only during the block.

    Args:
        url: The given address.
        options: Options of ``hypernav serve`` for a server that is started here.
    """
    if url is not None:
        yield url
        return
    with tempfile.TemporaryDirectory() as state:
        command = [sys.executable, "-c", _MAIN, "serve", "--port", "0", "--state", state, *options]
        server = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        assert server.stderr is not None
        said, drain = "", threading.Thread(target=server.stderr.read, daemon=True)
        try:
            for line in server.stderr:
                said += line
                if match := re.search(r"serving at (http://[^,\s]+)", line):
                    # Read its other output, too: a full pipe would block it.
                    drain.start()
                    yield match[1]
                    return
            reason = said.strip().removeprefix("hypernav: ")
            raise RobotLinkError(f"hypernav serve did not start: {reason[-300:]}")
        finally:
            server.terminate()
            server.wait()
            if drain.ident is not None:
                drain.join()
            server.stderr.close()
