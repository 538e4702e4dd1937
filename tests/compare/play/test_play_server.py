"""The server of `truebreak play` answers its own page and nobody else, one run at a time, and ends with Ctrl-C."""

from __future__ import annotations

import http.client
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time as clock
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from truebreak.compare.play.page_files import page_files
from truebreak.compare.play.play_server import MOST_BYTES, TOKEN_HEADER, PlayServer
from truebreak.scenarios import catalogue

LEE, GAS = catalogue.build("lee").data(), catalogue.build("gas").data()


@pytest.fixture(scope="module")
def server() -> Iterator[PlayServer]:
    with PlayServer(page_files("server")) as made:
        thread = threading.Thread(target=made.serve_forever, kwargs={"poll_interval": 0.05})
        thread.start()
        yield made
        made.shutdown()
        thread.join()


def fetched(
    server: PlayServer, path: str = "/ask", body: bytes | None = None, *, method: str = "POST", **fields: str | None
) -> tuple[int, list[dict[str, Any]] | bytes, http.client.HTTPMessage]:
    """Status, lines of JSON or content, and headers; fields of the request by name, None leaves one out."""
    headers: dict[str, str | None] = {"Host": server.own, "Origin": f"http://{server.own}", TOKEN_HEADER: server.token}
    headers |= {name.replace("_", "-"): value for name, value in fields.items()}
    if body is not None and "Content-Length" not in headers:
        headers["Content-Length"] = str(len(body))
    link = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=60)
    try:
        link.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
        for name, value in headers.items():
            if value is not None:
                link.putheader(name, value)
        link.endheaders(body)
        answer = link.getresponse()
        content = answer.read()
    finally:
        link.close()
    is_page = method not in ("POST",)
    lines = content if is_page else [json.loads(line) for line in content.splitlines()]
    return answer.status, lines, answer.headers


def ask(server: PlayServer, message: Any, **fields: str | None) -> tuple[int, dict[str, Any]]:
    """Status and last answer."""
    status, lines, _ = fetched(server, body=json.dumps(message).encode(), **fields)
    assert isinstance(lines, list)
    return status, lines[-1]


def test_a_run_is_answered_line_by_line(server: PlayServer) -> None:
    status, found = ask(server, {"kind": "run", "scene": LEE})
    assert (status, found["kind"]) == (200, "ran")
    assert found["exact"]["proved"]


@pytest.mark.parametrize("message", [{"kind": "run"}, {"kind": "sing"}, {}, {"kind": "run", "scene": {"circle": []}}])
def test_what_cannot_be_run_is_400(server: PlayServer, message: dict[str, Any]) -> None:
    status, found = ask(server, message)
    assert (status, found["kind"]) == (400, "refused") and found["error"]


@pytest.mark.parametrize("body", [b"", b"{", b"\xff", b"[" * 100_000, b"[]", b"3", b"null"])
def test_what_is_no_message_is_400(server: PlayServer, body: bytes) -> None:
    assert fetched(server, body=body)[0] == 400


@pytest.mark.parametrize(
    "fields",
    [
        {"Host": "evil.example"},
        {"Host": "localhost"},
        {"Host": None},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": None},
        {TOKEN_HEADER.replace("-", "_"): "guess"},
        {TOKEN_HEADER.replace("-", "_"): None},
        {TOKEN_HEADER.replace("-", "_"): "\u00e9"},
    ],
    ids=str,
)
def test_who_is_not_the_own_page_is_403(server: PlayServer, fields: dict[str, str | None]) -> None:
    own = {name.replace("_", "-"): value for name, value in fields.items()}
    status, found = ask(server, {"kind": "names"}, **own)
    assert (status, found["kind"]) == (403, "refused")


def test_another_host_gets_no_file_either(server: PlayServer) -> None:
    assert fetched(server, "/", method="GET", Host="evil.example")[0] == 403
    assert fetched(server, "/", method="GET")[0] == 200


@pytest.mark.parametrize(
    "path",
    [
        "/../pyproject.toml",
        "/%2e%2e/pyproject.toml",
        "//etc/passwd",
        "/index.html",
        "/play.py",
        "/?x",
        "*",
        "/a" * 4000,
    ],
)
def test_there_is_no_other_file(server: PlayServer, path: str) -> None:
    assert fetched(server, path, method="GET")[0] == 404
    assert fetched(server, path, b"{}")[0] == 404


def test_a_message_has_a_length_and_it_is_small(server: PlayServer) -> None:
    for length in (str(MOST_BYTES + 1), "9" * 400):
        assert fetched(server, body=b"", **{"Content-Length": length})[0] == 413
    for length in ("-1", "x", "1e3", "\u0663", None):
        sent = None if length is None else length.encode().decode("latin-1")
        assert fetched(server, body=b"", **{"Content-Length": sent})[0] == 400
    assert fetched(server, body=b"0\r\n\r\n", **{"Transfer-Encoding": "chunked"})[0] == 400
    assert fetched(server, body=b" " * 900_000 + b"[]")[0] == 400


def test_other_methods_are_not_there(server: PlayServer) -> None:
    for method in ("PUT", "DELETE", "OPTIONS", "TRACE"):
        assert fetched(server, "/ask", b"{}", method=method)[0] == 501


LONG = {"kind": "run", "scene": catalogue.build("lorentz").data(), "events": 5000, "seconds": 50, "engines": ["quad"]}
"""Its numbers grow to 16,000 bits: some three seconds, and it says how far it is after .2."""


def test_one_run_at_a_time_and_stop_ends_it(server: PlayServer) -> None:
    told: list[tuple[int, dict[str, Any]]] = []
    running = threading.Thread(target=lambda: told.append(ask(server, LONG)))
    running.start()
    until = clock.monotonic() + 20
    while not server.busy.locked() and clock.monotonic() < until:
        clock.sleep(0.01)
    status, found = ask(server, {"kind": "run", "scene": LEE})
    assert status == 429 and "stop" in found["error"]
    assert ask(server, {"kind": "stop"})[0] == 200
    running.join(40)
    assert not running.is_alive()
    assert told[0][1]["kind"] == "stopped"
    assert ask(server, {"kind": "run", "scene": LEE})[1]["kind"] == "ran"


def test_a_page_that_goes_away_stops_its_run(server: PlayServer) -> None:
    body = json.dumps(LONG).encode()
    head = (
        f"POST /ask HTTP/1.1\r\nHost: {server.own}\r\nOrigin: http://{server.own}\r\n{TOKEN_HEADER}: {server.token}\r\n"
    )
    with socket.create_connection(("127.0.0.1", server.server_port)) as link:
        link.sendall(f"{head}Content-Length: {len(body)}\r\n\r\n".encode() + body)
        assert link.recv(100).startswith(b"HTTP/1.0 200")
    until = clock.monotonic() + 20
    while server.busy.locked() and clock.monotonic() < until:
        clock.sleep(0.05)
    assert not server.busy.locked()


def test_every_answer_keeps_to_the_page(server: PlayServer) -> None:
    for path in server.files:
        status, content, headers = fetched(server, path, method="GET")
        assert status == 200 and server.token.encode() not in bytes(content if isinstance(content, bytes) else b"")
        assert "default-src 'none'" in headers["Content-Security-Policy"]
        assert "unsafe-inline" not in headers["Content-Security-Policy"]
        assert headers["X-Content-Type-Options"] == "nosniff" and headers["Cache-Control"] == "no-store"
        assert headers["Cross-Origin-Resource-Policy"] == "same-origin"
        assert not [name for name in headers if name.lower().startswith("access-control")]


def test_it_listens_on_this_computer_alone(server: PlayServer) -> None:
    assert server.server_address[0] == "127.0.0.1"


def test_a_slow_request_holds_nobody_up(server: PlayServer) -> None:
    with socket.create_connection(("127.0.0.1", server.server_port)) as link:
        link.sendall(b"POST /ask HTTP/1.1\r\n")
        assert ask(server, {"kind": "scene", "name": "lee"})[0] == 200


# -- The command.


@pytest.mark.skipif(os.name != "posix", reason="signals as POSIX has them")
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_ctrl_c_ends_the_command_and_its_engines(number: int, code: int, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text('[[circle]]\nid = "</script>"\nx = 0\ny = 0\nr = 1\nvx = 1\n', "utf-8")
    command = [sys.executable, "-m", "truebreak", "play", "mine.toml", "--no-browser"]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None and process.stderr is not None
        address, _, token = process.stdout.readline().strip().partition("/#token=")
        host = address.removeprefix("http://")
        link = http.client.HTTPConnection(host, timeout=60)
        link.request("GET", "/")
        page = link.getresponse().read().decode()
        assert '"id":"\\u003c/script>"' in page and page.count("</script>") == 3
        link = http.client.HTTPConnection(host, timeout=60)
        link.request("POST", "/ask", json.dumps(LONG), {"Origin": address, TOKEN_HEADER: token})
        kind = json.loads(link.getresponse().readline())["kind"]
        if kind != "progress":
            process.kill()
        assert kind == "progress"
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        started = children.read_text().split() if children.exists() else []
        process.send_signal(number)
        assert process.wait(20) == code
        assert "Traceback" not in process.stderr.read()
        assert not [pid for pid in started if Path(f"/proc/{pid}").exists()]


def test_a_port_that_is_taken_is_one_line(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        for port in (str(taken.getsockname()[1]), "99999"):
            command = [sys.executable, "-m", "truebreak", "play", "--no-browser", "--port", port]
            done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=60)
            assert done.returncode == 2
            assert done.stderr.count("\n") == 1 and f"port {port}" in done.stderr and "--port" in done.stderr
