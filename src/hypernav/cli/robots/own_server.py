"""A server of the command's own, for a simulated robot that is given none."""

import re
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from hypernav.core.errors import RobotLinkError

_MAIN = "from hypernav.cli.main import main; main()"


@contextmanager
def server_at(url: str | None) -> Iterator[str]:
    """The address of a server: the given one, or one that is started here and ended again.

    Raises:
        RobotLinkError: It did not start.
    """
    if url is not None:
        yield url
        return
    with tempfile.TemporaryDirectory() as state:
        command = [sys.executable, "-c", _MAIN, "serve", "--port", "0", "--state", state]
        server = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        assert server.stderr is not None
        said = ""
        try:
            for line in server.stderr:
                said += line
                if match := re.search(r"serving at (http://[^,\s]+)", line):
                    # What else it says must go somewhere, or it would wait for ever to say it.
                    threading.Thread(target=server.stderr.read, daemon=True).start()
                    yield match[1]
                    return
            raise RobotLinkError(f"hypernav serve did not start: {said.strip()[-300:]}")
        finally:
            server.terminate()
            server.wait()
