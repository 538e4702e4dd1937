"""Runs that the user ends by Ctrl-C, and questions that end at their counted work. What is shown is whole."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from command_line import done, interrupted, start
from ended import unlike_twins
from test_interruption import ENDLESS, assert_beginning, endless, finished, patience

from truebreak.compare import compare, trajectory_json
from truebreak.compare.deadline import uninterrupted
from truebreak.compare.files.saved import load_run
from truebreak.compare.grids.store import Store
from truebreak.exact import ExactEngine
from truebreak.exact.exact_engine import DEFAULT_WORK
from truebreak.scenarios import SceneError, StopReason, catalogue
from truebreak.scenarios.files import load_scene
from truebreak.scenarios.trajectory import Progress

# -- Ctrl-C


@pytest.mark.parametrize("name", [name for name in ENDLESS if name != "sympy"])  # it is ended by the same loop
def test_an_interrupted_run_shows_what_it_has(name: str) -> None:
    for times in (1 / 4, 1 / 2, 1, 3, 9):  # a slow machine has nothing to show at first
        seconds = times * (2 + float(patience(name)))
        code, out, err = interrupted("run", endless(name), "--engine", name, *ENDLESS[name], "--json", after=seconds)
        if not err:
            break
    assert (code, err) == (130, "")
    told = json.loads(out)
    count = len(told["events"])
    assert told["stop"] == {"reason": "interrupted", "message": f"interrupted: after {count} events"}
    if count and "interval" not in name:
        assert_beginning(told, finished(name, told, catalogue.build(endless(name))))


@pytest.mark.parametrize(
    "words",
    [
        ["compare", "gas", "--events", "10000000", "--html"],
        ["compare", "gas", "--events", "200", "--engines", "pymunk:dt=1/1000000", "--html"],
        ["compare", "gas", "--events", "200", "--engines", "interval:bits=100000", "--html"],
        ["compare", "gas", "--events", "10000000", "--reference", "double", "--html"],
        ["orders", "gas", "--events", "10000000"],
        ["orders", "rack:rows=5", "--events", "60", "--cap", "1000000"],
    ],
    ids=" ".join,
)
def test_an_interrupted_comparison_or_search_is_one_line(words: list[str], tmp_path: Path) -> None:
    file = [str(tmp_path / "report.html")] if words[-1] == "--html" else []
    code, out, err = interrupted(*words, *file)
    assert (code, out, err) == (130, "", "truebreak: interrupted\n")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_other_signals_end_a_run_as_ctrl_c_does(number: int, tmp_path: Path) -> None:
    """What is there is saved and shown; a second one, as services and terminals send, changes nothing."""
    file = tmp_path / "run.json"
    words = ("run", "gas", "--events", "10000000", "--json", "--save", str(file))
    code, out, err = interrupted(*words, by=(number, signal.SIGTERM))
    assert (code, err) == (128 + number, "")
    kept = load_run(file)
    assert kept.stop.reason is StopReason.INTERRUPTED
    assert trajectory_json(kept) == json.loads(out)
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_other_signals_end_what_has_nothing_to_show_in_one_line(number: int) -> None:
    code, out, err = interrupted("orders", "gas", "--events", "10000000", by=(number,))
    assert (code, out, err) == (128 + number, "", f"truebreak: ended by {signal.Signals(number).name}\n")


def test_nohup_is_honoured() -> None:
    words = ("run", "gas", "--events", "10000000", "--json")
    code, out, err = interrupted(*words, by=(signal.SIGHUP, signal.SIGTERM), before=("nohup",))
    assert code == 128 + signal.SIGTERM
    assert json.loads(out)["stop"]["reason"] == "interrupted"
    assert "nohup" in err or err == ""


def test_a_signal_keeps_the_rows_of_a_sweep(tmp_path: Path) -> None:
    """Those that are there, in a store that the next call goes on with; no worker stays behind."""
    store = tmp_path / "gas.db"
    running = start("sweep", "gas:n=3", "--vary", "seed=1..4000", "--jobs", "1", "--store", str(store))
    while not store.exists() or len(rows_in(store)) < 3:
        assert running.poll() is None
        time.sleep(0.05)
    running.send_signal(signal.SIGTERM)
    out, err = running.communicate(timeout=60)
    assert (running.returncode, out, err) == (143, "", "truebreak: ended by SIGTERM\n")
    assert 3 <= len(rows_in(store)) < 4000
    for _ in range(100):  # the last of its processes tidies up, and ends too
        try:
            os.killpg(running.pid, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    pytest.fail("a process of it is still there")


def rows_in(store: Path) -> list[Any]:
    """What a sweep has kept by now; nothing while it makes its store."""
    try:
        return list(Store(str(store)))
    except SceneError:
        return []


def test_an_interrupted_run_is_no_result() -> None:
    def progress(state: Progress) -> None:
        raise KeyboardInterrupt

    run = ExactEngine().run(catalogue.build("gas"), events=10**7, progress=progress)
    assert run.stop.reason is StopReason.INTERRUPTED
    with pytest.raises(KeyboardInterrupt):
        uninterrupted(run)
    with pytest.raises(KeyboardInterrupt):
        compare(catalogue.build("gas"), ["double"], events=10**7, progress=progress)
    with pytest.raises(KeyboardInterrupt):
        compare(catalogue.build("gas"), ["pymunk"], reference="double", until=10**6, progress=progress)


# -- counted work


@contextmanager
def busy() -> Iterator[None]:
    """Processes that leave the others little of the machine."""
    others = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2 * (os.cpu_count() or 1))]
    try:
        yield
    finally:
        for other in others:
            other.kill()
            other.wait()


@pytest.mark.parametrize(
    ("scene", "work", "reason"),
    [
        (unlike_twins(10), "50000", "undecided"),
        (unlike_twins(3), str(DEFAULT_WORK), "quiet"),
        (unlike_twins(10), "1", "budget"),
    ],
    ids=["too deep", "decided", "no work"],
)
def test_a_run_says_the_same_on_a_loaded_machine(scene: dict[str, Any], work: str, reason: str, tmp_path: Path) -> None:
    """Also one that stops because its work is spent."""
    path = tmp_path / "twins.json"
    path.write_text(json.dumps(scene), encoding="utf-8")
    words = ["run", str(path), "--exact", "--json", "--work", work]
    idle = done(*words)
    with busy():
        loaded = done(*words)
    told = json.loads(idle.stdout)
    assert told["stop"]["reason"] == reason
    assert (loaded.returncode, loaded.stdout) == (0 if reason == "quiet" else 4, idle.stdout)
    assert told["engine"]["parameters"]["work"] == int(work)
    if reason == "undecided":
        assert re.search(rf"\d+ units of work of {work} \(--work\)", told["stop"]["message"])


def test_deep_texts_are_the_same_on_a_loaded_machine() -> None:
    words = ["run", "gas:n=4", "--events", "40", "--exact", "--json"]
    idle = done(*words)
    with busy():
        loaded = done(*words)
    assert (idle.returncode, loaded.stdout) == (0, idle.stdout)
    assert "definitions" in json.loads(idle.stdout)


def test_more_work_decides_more(tmp_path: Path) -> None:
    """The tie of unlike twins is proved in nested roots where they are few, if that is allowed to take its time."""
    path = tmp_path / "twins.json"
    path.write_text(json.dumps(unlike_twins(5)), encoding="utf-8")
    scene = load_scene(path)
    little, much = (ExactEngine(work=work).run(scene) for work in (2000, DEFAULT_WORK))
    assert little.stop.reason is StopReason.UNDECIDED
    assert much.stop.reason is StopReason.QUIET
    assert len(much.events) > len(little.events)


def test_the_default_of_work_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    for command in ("run", "compare", "orders"):
        assert f"({DEFAULT_WORK:,})" in " ".join(done(command, "--help").stdout.split())
