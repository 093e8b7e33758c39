"""A proxy that keeps what it passes on, and gives the server another owner, as many proxies do."""

import json
import threading
import urllib.error
import urllib.request
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any


class Forwarder:
    """The proxy. Use as a context manager."""

    def __init__(self, target: str, *, owner: str = "") -> None:
        """Prepare.

        Args:
            target: URL of the server, without a path.
            owner: What the list of models says in place of ``llamacpp``; empty leaves it.
        """
        self.questions: list[dict[str, Any]] = []
        self.paths: list[str] = []
        keep = self

        class Handler(BaseHTTPRequestHandler):
            def log_message(self, format: str, *args: Any) -> None:
                pass

            def do_GET(self) -> None:
                keep.paths.append(self.path)
                body = self.rfile.read(int(self.headers.get("content-length") or 0))
                if self.path == "/v1/chat/completions":
                    keep.questions.append(json.loads(body))
                headers = {"Content-Type": "application/json"}
                asked = urllib.request.Request(
                    target + self.path, body or None, headers, method=self.command
                )
                try:
                    reply, status = urllib.request.urlopen(asked), 200
                except urllib.error.HTTPError as error:
                    reply, status = error, error.code
                said = reply.read()
                if owner:
                    said = said.replace(b'"owned_by":"llamacpp"', f'"owned_by":"{owner}"'.encode())
                self.send_response(status)
                self.send_header("Content-Type", reply.headers["Content-Type"])
                self.end_headers()
                self.wfile.write(said)

            do_POST = do_GET

        self._server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.url = f"http://127.0.0.1:{self._server.server_address[1]}/v1"

    def __enter__(self) -> "Forwarder":
        threading.Thread(target=self._server.serve_forever, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self._server.shutdown()
        self._server.server_close()
