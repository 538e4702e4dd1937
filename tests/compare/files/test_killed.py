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
from truebreak.compare.files import cache
from truebreak.compare.files.saved import load_run, save_run, saved_run
from truebreak.compare.grids.family_sweep import csv_parts
from truebreak.compare.grids.family_sweep import plan as sweep_plan
from truebreak.compare.grids.store import Store, merged
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


def test_a_store_of_a_grid(kills: int, tmp_path: Path) -> None:
    """Rows that are there stay, and are whole; what is resumed gives the same table."""
    asked = sweep_plan("gas:n=3", ["seed=1..30"], ["single"], events=5)
    rows = [asked.job(k).rows() for k in range(30)]

    def write(path: Path) -> None:
        store = Store(str(path), asked.settings)
        there = store.done(asked.key)
        for k in range(30):
            if k not in there:
                store.add(k, "", rows[k], 1.0)
        store.close()

    def table(path: Path) -> str:
        return "".join(csv_parts(merged([str(path)]), ["seed"]))

    write(tmp_path / "whole.db")
    whole = table(tmp_path / "whole.db")
    path, seen = tmp_path / "s.db", [0]

    def check() -> None:
        if path.exists() and path.stat().st_size:
            try:
                store = Store(str(path), asked.settings)
                store.verify()
            except SceneError:
                raise AssertionError("a store that a kill left is refused") from None
            there = len(store.done(asked.key))
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


def test_a_store_in_which_another_process_writes_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Once the other has been killed, it goes on, and nothing of what was half written is there."""
    asked = sweep_plan("gas:n=3", ["seed=1..2"], ["single"], events=5)
    path, (row,) = tmp_path / "s.db", asked.job(0).rows()
    Store(str(path), asked.settings).close()

    def hold() -> None:
        store = Store(str(path), asked.settings)
        store.add(0, "", [row], 0.0)
        (tmp_path / "held").touch()
        time.sleep(60)

    number = child(hold)
    while not (tmp_path / "held").exists():
        time.sleep(0.01)
    second = Store(str(path), asked.settings)
    second.base.execute("PRAGMA busy_timeout = 10")
    try:
        with pytest.raises(SceneError, match="database is locked; see that it is free"):
            second.add(1, "", [row], 1.0)
    finally:
        os.kill(number, signal.SIGKILL)
        os.waitpid(number, 0)
    second.add(1, "", [row], 1.0)
    second.close()
    assert len(merged([str(path)])) == 1


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
        Store(str(tmp_path / "not-a-folder" / "s.db"), asked.settings)
