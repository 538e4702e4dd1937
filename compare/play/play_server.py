"""The server of `truebreak play`: the page and the engines for one person, on this computer alone.

It listens on 127.0.0.1 and answers nobody else: the name asked for must be its own (another could be made to lead
here), and whoever asks the engines must come from its own page and know a token, which only the address that is
opened has.
There is no file that it reads on demand: what it hands out is made before it starts.
"""

from __future__ import annotations

import json
import secrets
import threading
from collections.abc import Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from .engine_process import EngineProcess
from .messages import MOST_SECONDS
from .page_files import POLICY, PageFile

MOST_BYTES = 1_000_000
"""Of a message: a scene of the largest size that is played has a tenth of that."""

PATIENCE = 10.0
"""Seconds for which the server waits for the rest of a request."""

MOST_CONNECTIONS = 32
"""At one time; what comes beyond that is closed."""

TOKEN_HEADER = "X-Truebreak-Token"

HOST = "127.0.0.1"


class PlayServer(ThreadingHTTPServer):
    """Serves the files of the page, and passes messages on to the engines, one run at a time.

    Args:
        files: what can be fetched, by path.
        port: 0 for any that is free.

    Attributes:
        token: what the page has to know.
        address: what to open in a browser.
    """

    daemon_threads = True
    request_queue_size = 16

    def __init__(self, files: Mapping[str, PageFile], port: int = 0) -> None:
        self.files, self.token, self.engines = dict(files), secrets.token_urlsafe(24), EngineProcess()
        self.busy = threading.Lock()
        self._connections = threading.BoundedSemaphore(MOST_CONNECTIONS)
        super().__init__((HOST, port), PlayHandler)

    @property
    def own(self) -> str:
        """Its name, as a browser writes it."""
        return f"{HOST}:{self.server_port}"

    @property
    def address(self) -> str:
        """The page, with the token where no server is sent it."""
        return f"http://{self.own}/#token={self.token}"

    def process_request(self, request: Any, client_address: Any) -> None:
        """A thread for each connection, as long as there are few."""
        if self._connections.acquire(blocking=False):
            super().process_request(request, client_address)
        else:
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Answers one connection."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._connections.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A connection that breaks off is nobody's error."""

    def server_close(self) -> None:
        """Ends the engines too."""
        super().server_close()
        self.engines.stop()


class PlayHandler(BaseHTTPRequestHandler):
    """One request."""

    server: PlayServer  # pyright: ignore[reportIncompatibleVariableOverride]
    timeout = PATIENCE
    server_version = "truebreak"
    sys_version = ""

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing is logged: an address bar has what one plays with."""

    def do_GET(self) -> None:
        """A file of the page."""
        if self.headers.get("Host") != self.server.own:
            return self._refuse(403, "another host was asked for")
        found = self.server.files.get(self.path)
        if found is None:
            return self._refuse(404, "there is no such file")
        self._head(200, found.kind, len(found.content))
        self.wfile.write(found.content)

    def do_POST(self) -> None:
        """A message to the engines; the answers are lines of JSON."""
        server, headers = self.server, self.headers
        given = headers.get(TOKEN_HEADER, "")
        known = secrets.compare_digest(given.encode(), server.token.encode())
        if headers.get("Host") != server.own or headers.get("Origin") != f"http://{server.own}" or not known:
            return self._refuse(403, "only the page that truebreak play opened may ask")
        if self.path != "/ask":
            return self._refuse(404, "there is nothing to ask here")
        length = headers.get("Content-Length", "")
        if not (length.isascii() and length.isdecimal()) or headers.get("Transfer-Encoding"):
            return self._refuse(400, "the length of the message is missing")
        if len(length) > 12 or int(length) > MOST_BYTES:
            return self._refuse(413, f"a message has at most {MOST_BYTES:,} bytes")
        try:
            message = json.loads(self.rfile.read(int(length)))
        except (ValueError, RecursionError):
            return self._refuse(400, "the message is not JSON")
        if not isinstance(message, dict):
            return self._refuse(400, "a message is an object with a kind")
        if message.get("kind") == "stop":
            server.engines.stop()
            return self._lines(200, {"kind": "stopped"})
        if not server.busy.acquire(blocking=False):
            return self._refuse(429, "a run is under way; stop it first, or wait for it")
        try:
            self._pass_on(message)
        finally:
            server.busy.release()

    def _pass_on(self, message: dict[str, Any]) -> None:
        """Answers with what the engines say: 400 where they refuse, before anything else."""
        begun = False
        for found in self.server.engines.ask(message, MOST_SECONDS):
            try:
                if begun:
                    self.wfile.write(_line(found))
                else:
                    self._lines(400 if found["kind"] == "refused" else 200, found)
                    begun = True
                self.wfile.flush()
            except OSError:  # nobody listens any more
                self.server.engines.stop()
                return

    def _lines(self, code: int, first: dict[str, Any]) -> None:
        self._head(code, "application/x-ndjson", None)
        self.wfile.write(_line(first))

    def _refuse(self, code: int, reason: str) -> None:
        content = _line({"kind": "refused", "error": reason})
        self.close_connection = True
        self._head(code, "application/json", len(content))
        self.wfile.write(content)

    def _head(self, code: int, kind: str, length: int | None) -> None:
        self.send_response(code)
        fields = {
            "Content-Type": kind,
            "Content-Security-Policy": f"{POLICY}; frame-ancestors 'none'",
            "X-Content-Type-Options": "nosniff",
            "Referrer-Policy": "no-referrer",
            "Cross-Origin-Resource-Policy": "same-origin",
            "Cross-Origin-Opener-Policy": "same-origin",
            "Cache-Control": "no-store",
        }
        if length is not None:
            fields["Content-Length"] = str(length)
        for name, value in fields.items():
            self.send_header(name, value)
        self.end_headers()


def _line(found: dict[str, Any]) -> bytes:
    return json.dumps(found, allow_nan=False, separators=(",", ":")).encode() + b"\n"
