"""The engines in the browser itself: the same histories as here, in few bytes, and without a network after a visit."""

from __future__ import annotations

import ast
import gzip
import json
import shutil
import signal
import subprocess
import sys
import threading
import urllib.request
from collections.abc import Iterator
from http.server import ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest
from browser import Browser, found
from playing import PagePlayed
from test_messages import NAMES, asked, cut_short

from truebreak.scenarios import catalogue

ROOT = Path(__file__).resolve().parent.parent.parent.parent
sys.path.append(str(ROOT / "docs" / "site"))

from playground import DIGESTS, NUMBERS, NotToBeHad, bare, served, sources, write_playground  # noqa: E402


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page with its engines, where their parts can be fetched."""
    folder = tmp_path_factory.mktemp("site")
    try:
        write_playground(folder, ROOT / "build" / "play-parts")
    except NotToBeHad as error:
        pytest.skip(f"no engines for the browser here: {error}")
    return folder


def in_wasm(site: Path, messages: list[dict[str, Any]]) -> list[tuple[float, dict[str, Any]]]:
    """Seconds of CPU, and the answer, for each message."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("no node here")
    script = Path(__file__).with_name("in_node.mjs")
    asking = site.parent / f"{site.name}-messages.jsonl"
    asking.write_text("\n".join(map(json.dumps, messages)), "utf-8")
    done = subprocess.run([node, str(script), str(site), str(asking)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return [tuple(json.loads(line)) for line in done.stdout.splitlines()[1:]]


def test_histories_are_the_same_bytes_as_here(site: Path) -> None:
    """Every event of both runs with its time, where they part, the verdict and why, over the whole catalogue."""
    messages = [
        {"kind": "run", "scene": catalogue.build(name).data(), "events": 40, "seconds": 60, "why": True}
        for name in NAMES
        if name != "beads"  # undecided before its first event
    ]
    messages.append({"kind": "run", "scene": catalogue.build("gas").data(), "events": 300, "seconds": 60})
    for message, (_, mine) in zip(messages, in_wasm(site, messages), strict=True):
        theirs = asked(**message)
        told = [
            (
                one["verdict"],
                one["exact"],
                [(o["events"], o["agreed"]) for o in one["others"]],
                [
                    (run["events"], run["times"], run.get("divergence"))
                    for run in (one["recording"] or {"runs": []})["runs"]
                ],
                one["why"] and one["why"]["where"],
            )
            for one in (mine, theirs)
        ]
        assert json.dumps(told[0]) == json.dumps(told[1])
        if mine["why"]:  # NumPy, by which growth is measured, is not there
            why = mine["why"]["why"].removesuffix(" Whether errors grow on the way is not known.")
            assert theirs["why"]["why"].startswith(why)


def test_a_certificate_made_there_is_verified_here(site: Path) -> None:
    from truebreak.compare.certificate.certified import verdict

    ((_, told),) = in_wasm(site, [{"kind": "certificate", "scene": catalogue.build("gas").data(), "events": 30}])
    assert told["kind"] == "certificate", told
    assert verdict(told["text"])[0] == 0


def test_a_run_is_cut_there_too(site: Path) -> None:
    message = {"kind": "run", "scene": catalogue.build("echo").data(), "events": 5000, "seconds": 0.02}
    ((_, found),) = in_wasm(site, [message])
    cut_short(found)


def test_it_is_small(site: Path) -> None:
    packed = {path.name: len(gzip.compress(path.read_bytes(), 9)) for path in site.rglob("*") if path.is_file()}
    assert sum(packed.values()) < 15_000_000
    own = sum(size for name, size in packed.items() if name not in DIGESTS and name != "flint.zip")
    assert own < 500_000


def test_the_kinds_of_numbers_that_are_loaded_are_those_that_are_taken() -> None:
    """Of python-flint: a name that a module imports and the page's copy does not hand on would fail in the browser."""
    taken = {
        name.name
        for source in sources().values()
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.ImportFrom) and node.module == "flint"
        for name in node.names
    }
    assert taken == set(NUMBERS)


def test_it_is_served_until_ctrl_c(site: Path, tmp_path: Path) -> None:
    """`make play`: prints where it is, answers there, and ends without a word."""
    script, command = ROOT / "docs" / "site" / "playground.py", [str(tmp_path / "play"), "--serve"]
    with subprocess.Popen(
        [sys.executable, str(script), *command], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as run:
        assert run.stdout is not None and run.stderr is not None
        assert b" files, " in run.stdout.readline()
        address = run.stdout.readline().decode().split()[0]
        assert urllib.request.urlopen(f"{address}worker.js").headers["Content-Type"] == "text/javascript"
        run.send_signal(signal.SIGINT)
        assert (run.wait(), run.stderr.read()) == (0, b"")


def test_a_part_that_is_another_is_refused(site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import playground

    def fetch(folder: Path) -> None:
        modules = folder / "node_modules" / "pyodide"
        modules.mkdir(parents=True)
        for name in DIGESTS:
            (modules / name).write_bytes(b"something else")
            (folder / name).write_bytes(b"something else")

    monkeypatch.setattr(playground, "_fetch", fetch)
    with pytest.raises(NotToBeHad, match="another SHA-256"):
        write_playground(tmp_path / "site", tmp_path / "cache")
    assert not (tmp_path / "site").exists()


def test_what_is_left_out_of_a_module_is_words() -> None:
    source = '"""What it is."""\nX: int = 1\n"""What X is."""\n\nclass A:\n    """Nothing more."""\n'
    assert bare(source) == b"X: int = 1\n\nclass A:\n    pass"


# -- In a real browser.


@pytest.fixture
def visited(site: Path) -> Iterator[tuple[ThreadingHTTPServer, PagePlayed]]:
    with served(site) as server, Browser() as browser:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05})
        thread.start()
        browser.media(prefers_reduced_motion="reduce")
        browser.size(1200)
        try:
            yield server, PagePlayed(browser, f"http://127.0.0.1:{server.server_port}/")
        finally:
            server.shutdown()
            thread.join()


@pytest.mark.skipif(found() is None, reason="no chromium here: apt-get install chromium")
def test_it_runs_stops_and_needs_no_network_after_a_visit(
    visited: tuple[ThreadingHTTPServer, PagePlayed], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("playing.PATIENCE", 240.0)
    server, page = visited
    page.open("scene=gas")
    assert "every decision proved" in (page.run() and page.text("exactness"))
    assert page.text("verdict") == asked(kind="run", scene=catalogue.build("gas").data(), events=300)["verdict"]
    own = page.address.partition("#")[0]
    assert all(url.startswith((own, "blob:", "data:", "about:")) for url in page.browser.requests)
    assert page.browser.messages == []
    page.value("events", "5000")
    page.value("seconds", "60")
    page.press("go")
    page.wait("/events$/.test(document.getElementById('progress').textContent)")
    page.press("stop")
    assert page.says("progress", "^Stopped after")
    page.wait("navigator.serviceWorker.ready.then(() => true)")
    server.shutdown()
    server.server_close()
    page.open("scene=lee")
    assert page.run()
