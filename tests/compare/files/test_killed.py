"""Stores, caches and saved files withstand kill -9 at any point: what is resumed ends with the same bytes."""

from __future__ import annotations

import os
import random
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import truebreak as tb
from truebreak.compare.ensemble.rows.row import SweepJob, rows_of
from truebreak.compare.ensemble.rows.store import Store as SweepStore
from truebreak.compare.ensemble.rows.table import csv_text
from truebreak.compare.ensemble.sweep import plan as sweep_plan
from truebreak.compare.files import cache
from truebreak.compare.files.saved import load_run, save_run, saved_run
from truebreak.compare.stress.plan import carry_out
from truebreak.compare.stress.plan import plan as stress_plan
from truebreak.compare.stress.store import Store as StressStore
from truebreak.compare.suites.survey import survey
from truebreak.compare.suites.surveys.survey_store import SurveyStore, survey_settings
from truebreak.scenarios import SceneError
from truebreak.scenarios.disk import UNFINISHED

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes that are forked, and killed")

KILLS = 12
"""Of each store in the ordinary tests; 200 behind `slow`."""


def child(action: Callable[[], None]) -> int:
    """A process of its own that does something, and nothing of the tests' after that."""
    number = os.fork()
    if number == 0:
        try:
            action()
        finally:
            os._exit(0)
    return number


def killed(action: Callable[[], None], seconds: float) -> bool:
    """Begins something in a process, kills that after so many seconds, and says whether it was still at it."""
    number = child(action)
    time.sleep(seconds)
    os.kill(number, signal.SIGKILL)
    return os.WIFSIGNALED(os.waitpid(number, 0)[1])


def withstands(action: Callable[[], None], check: Callable[[], None], kills: int, seed: int) -> None:
    """Kills an action so often, at any point of it; `check` looks at what is there after each.

    It is begun anew where it has ended; a quarter of the kills and more come in its middle.
    """
    draw = random.Random(seed)
    began = time.perf_counter()
    number = child(action)
    os.waitpid(number, 0)
    whole = time.perf_counter() - began
    middle = 0
    for _ in range(kills):
        middle += killed(action, draw.uniform(0, whole))
        check()
    assert middle >= 1  # how many hit the middle is chance, and the machine's load


@pytest.fixture(params=[KILLS, pytest.param(200, marks=pytest.mark.slow)])
def kills(request: pytest.FixtureRequest) -> int:
    return request.param


def test_a_store_of_a_sweep(kills: int, tmp_path: Path) -> None:
    """Rows that are there stay, and are whole; what is resumed gives the same table."""
    asked = sweep_plan("gas:n=3", ["seed=1..30"], ["single"], events=5)
    jobs: list[SweepJob] = [asked.job(k) for k in range(30)]
    rows = [rows_of(job) for job in jobs]

    def write(path: Path) -> None:
        store = SweepStore(str(path), asked.settings)
        there = store.done()
        for k in range(30):
            if k not in there:
                store.add(k, rows[k], 0.0)
        store.close()

    def table(path: Path) -> str:
        store = SweepStore(str(path), None)
        try:
            return csv_text(store.rows(), ["seed"])
        finally:
            store.close()

    write(tmp_path / "whole.db")
    whole = table(tmp_path / "whole.db")
    path, seen = tmp_path / "s.db", [0]

    def check() -> None:
        if path.exists() and path.stat().st_size:
            try:
                store = SweepStore(str(path), asked.settings)
            except SceneError:
                raise AssertionError("a store that a kill left is refused") from None
            there = len(store.done())
            store.close()
            assert there >= seen[0]
            seen[0] = there
            if there == 30:
                assert table(path) == whole
                path.unlink()
                seen[0] = 0

    withstands(lambda: write(path), check, kills, 1)
    write(path)
    assert table(path) == whole


def test_a_store_of_a_stress_map(kills: int, tmp_path: Path) -> None:
    asked = stress_plan(["near-ties", "corners"], ["double"], levels="14..17")
    places = list(asked.places())
    carry_out(asked, StressStore(str(tmp_path / "whole.jsonl"), asked.settings, places))
    whole = (tmp_path / "whole.jsonl").read_bytes()
    rows = StressStore(str(tmp_path / "whole.jsonl")).rows
    path = tmp_path / "map.jsonl"

    def write() -> None:
        store = StressStore(str(path), asked.settings, places)
        for row in rows[len(store.rows) :]:
            store.add(row)

    def check() -> None:
        data = path.read_bytes() if path.exists() else b""
        assert whole.startswith(data)
        if data == whole:
            path.unlink()

    withstands(write, check, kills, 2)
    write()
    assert path.read_bytes() == whole


def test_a_store_of_a_survey(kills: int, tmp_path: Path) -> None:
    """The bytes that are there are those of one that was never killed, as far as they go."""
    settings = survey_settings(causes=False, advice=False, max_seconds=None)
    found = survey(["double", "quad", "single"], ["lee", "near-tie"], causes=False, advice=False)

    def write(path: Path) -> None:
        store = SurveyStore(str(path), settings)
        for entry in found.entries:
            if (entry.label, entry.name) not in store.entries:
                store.add(entry)

    write(tmp_path / "whole.jsonl")
    whole = (tmp_path / "whole.jsonl").read_bytes()
    path = tmp_path / "rows.jsonl"

    def check() -> None:
        data = path.read_bytes() if path.exists() else b""
        assert whole.startswith(data)
        if data == whole:
            path.unlink()

    withstands(lambda: write(path), check, kills, 4)
    write(path)
    assert path.read_bytes() == whole


def test_two_processes_do_not_write_one_stress_map(tmp_path: Path) -> None:
    """The second is told; once the first has been killed, it goes on."""
    asked = stress_plan(["near-ties"], ["double"], levels="14..15")
    path = tmp_path / "map.jsonl"

    def hold() -> None:
        store = StressStore(str(path), asked.settings, list(asked.places()))
        (tmp_path / "held").touch()
        time.sleep(60)
        del store

    number = child(hold)
    while not (tmp_path / "held").exists():
        time.sleep(0.01)
    try:
        with pytest.raises(SceneError, match="another process writes there"):
            StressStore(str(path), asked.settings, list(asked.places()))
    finally:
        os.kill(number, signal.SIGKILL)
        os.waitpid(number, 0)
    assert StressStore(str(path), asked.settings, list(asked.places())).rows == []


def test_a_saved_run_and_a_kept_one(kills: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """There is the old one or the new one, whole, and nothing else once the next has been written."""
    runs: list[Any] = [tb.run(tb.scene("gas:n=4"), events=count) for count in (5, 9)]
    texts = [saved_run(run) for run in runs]
    path = tmp_path / "run.json"
    save_run(runs[0], path)
    monkeypatch.setenv(cache.FOLDER, str(tmp_path / "kept"))
    engine = cache.CachedEngine()
    kept = engine._path(tmp_path / "kept", runs[0].scene, None, 5)

    def write() -> None:
        for k in range(20):
            save_run(runs[k % 2], path)
            cache._keep(kept, runs[0])

    def check() -> None:
        assert path.read_text("utf-8") in texts
        load_run(path)
        if kept.exists():
            again = cache._kept(kept, runs[0].scene)
            assert again is not None
            assert saved_run(again) == texts[0]

    withstands(write, check, kills, 3)
    write()
    left = [file for folder in (tmp_path, kept.parent) for file in folder.iterdir() if UNFINISHED.fullmatch(file.name)]
    assert left == []


def test_a_folder_that_may_only_be_read_is_one_line(tmp_path: Path) -> None:
    """Root may write anywhere, but not where a file is in the folder's place."""
    (tmp_path / "not-a-folder").write_text("")
    run = tb.run(tb.scene("lee"))
    with pytest.raises(SceneError, match="choose another place to write to") as error:
        save_run(run, tmp_path / "not-a-folder" / "run.json")
    assert "\n" not in str(error.value)
    asked = sweep_plan("gas:n=3", ["seed=1..2"], ["single"], events=5)
    with pytest.raises(SceneError, match="create it first"):
        SweepStore(str(tmp_path / "not-a-folder" / "s.db"), asked.settings)
