"""The store of a sweep: resumed, merged, damaged, full; workers that die, and sweeps that are killed."""

from __future__ import annotations

import gc
import multiprocessing
import os
import signal
import sqlite3
import subprocess
import sys
import time as clock
from collections.abc import Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from truebreak.compare.cli import main
from truebreak.compare.grids.family_sweep import SweepJob, csv_parts, plan, sweep
from truebreak.compare.grids.grid import Done
from truebreak.compare.grids.grid import carry_out as run
from truebreak.compare.grids.row import Row
from truebreak.compare.grids.store import Store, merged
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine
from truebreak.scenarios import SceneError


@pytest.fixture
def thread() -> Iterator[Executor]:
    with ThreadPoolExecutor(1) as executor:
        yield executor


# -- the store


def rows(store: str) -> bytes:
    told = merged([store])
    return "".join(csv_parts(told, [text.partition("=")[0] for text in told.settings["vary"]])).encode()


def test_a_store_goes_on_where_it_stopped(tmp_path: Path, thread: Executor) -> None:
    path, seen = str(tmp_path / "s.db"), []

    class Enough(Exception):
        pass

    def stop(done: Done) -> None:
        if done.there == 2:
            raise Enough

    asked = plan("gas:n=3", ["seed=1..5"], ["single"], events=40)
    base = Store(path, asked.settings)
    with pytest.raises(Enough):
        run(asked, base, executor=thread, progress=stop)
    base.close()
    base = Store(path, asked.settings)
    assert len(base.done(asked.key)) == 2
    run(asked, base, executor=thread, progress=seen.append)
    base.close()
    assert [done.fresh for done in seen] == [1, 2, 3]
    whole = sweep("gas:n=3", ["seed=1..5"], ["single"], events=40, executor=thread)
    assert merged([path]) == whole


def test_shards_make_one_table(tmp_path: Path, thread: Executor) -> None:
    whole = sweep("gas:n=3", ["seed=1..5"], ["single", "double"], events=40, executor=thread)
    paths = [str(tmp_path / f"{k}.db") for k in (1, 2, 3)]
    for k, path in enumerate(paths, start=1):
        sweep("gas:n=3", ["seed=1..5"], ["single", "double"], events=40, executor=thread, store=path, shard=f"{k}/3")
    assert merged(reversed(paths)) == whole


def test_a_shard_that_is_left_out_is_told(tmp_path: Path, thread: Executor, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(tmp_path / "1.db")
    sweep("gas:n=3", ["seed=1..5"], ["single"], events=20, executor=thread, store=path, shard="1/2")
    with pytest.raises(SystemExit) as stop:
        main(["sweep", "--store", path])
    assert not stop.value.code
    assert capsys.readouterr().err.startswith("truebreak: 3 of 5 scenes are there; the others are in another shard's")


def test_stores_of_other_sweeps_are_refused(tmp_path: Path, thread: Executor) -> None:
    path, other = str(tmp_path / "s.db"), str(tmp_path / "t.db")
    sweep("gas:n=3", ["seed=1..2"], ["single"], events=20, executor=thread, store=path)
    with pytest.raises(SceneError, match="holds another sweep: its events is 20, here it is 30"):
        Store(path, plan("gas:n=3", ["seed=1..2"], ["single"], events=30).settings)
    sweep("gas:n=3", ["seed=1..2"], ["single"], events=30, executor=thread, store=other)
    with pytest.raises(SceneError, match="of another sweep"):
        merged([path, other])


def test_bad_stores_are_refused(tmp_path: Path) -> None:
    settings = plan("gas").settings
    text = tmp_path / "notes.txt"
    text.write_text("no database at all, but long enough to be looked at " * 40, "utf-8")
    with pytest.raises(SceneError, match="is no store of a grid, or damaged"):
        Store(str(text), settings)
    with pytest.raises(SceneError, match="there is no such file"):
        Store(str(tmp_path / "none.db"), None)
    (tmp_path / "empty.db").touch()
    with pytest.raises(SceneError, match="the file is empty"):
        Store(str(tmp_path / "empty.db"), None)
    with pytest.raises(SceneError, match="is a folder; name a file in it"):
        Store(str(tmp_path), settings)
    old = tmp_path / "old.db"
    Store(str(old), settings).close()
    with sqlite3.connect(old) as base:
        base.execute("UPDATE meta SET value = 'truebreak/sweep-store-3' WHERE key = 'format'")
    with pytest.raises(SceneError, match="is truebreak/sweep-store-3, and this is truebreak/grid-store-1"):
        Store(str(old), settings)
    with pytest.raises(SceneError, match=r"there is no folder .*no'; create it first"):
        Store(str(tmp_path / "no" / "folder.db"), settings)


def test_a_damaged_store_is_refused(tmp_path: Path, thread: Executor) -> None:
    path = tmp_path / "s.db"
    sweep("gas:n=3", ["seed=1..8"], ["single"], events=20, executor=thread, store=str(path))
    data = bytearray(path.read_bytes())
    data[4096:] = b"\xff" * (len(data) - 4096)
    path.write_bytes(data)
    with pytest.raises(SceneError, match=r"damaged|malformed"):
        merged([str(path)])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("DELETE FROM meta WHERE key = 'settings'", "is damaged: it holds"),
        ("UPDATE meta SET value = '{bad' WHERE key = 'settings'", "is damaged: it holds"),
        ("UPDATE meta SET value = '[1]' WHERE key = 'settings'", "is damaged: it holds"),
        ("UPDATE rows SET row = '[1]' WHERE job = 1", "is damaged: it holds"),
        ("UPDATE rows SET row = '{}' WHERE job = 1", "is damaged: it holds"),
        ("UPDATE rows SET row = replace(row, '0', '1') WHERE job = 1", "is damaged: it holds"),
        ("UPDATE rows SET job = 7 WHERE job = 1", "is damaged: it holds"),
        ("UPDATE meta SET value = x'ff' WHERE key = 'settings'", "is damaged: it holds"),
        ("UPDATE meta SET value = replace(value, '10', '11') WHERE key = 'settings'", "is damaged: it holds"),
        ("DROP TABLE meta", "is no store"),
        ("DROP TABLE rows", "is no store"),
    ],
)
def test_a_store_that_somebody_changed_is_refused(change: str, message: str, tmp_path: Path, thread: Executor) -> None:
    path = str(tmp_path / "s.db")
    sweep("gas:n=2", ["seed=1..3"], ["rounded:bits=8"], events=10, executor=thread, store=path)
    with sqlite3.connect(path) as base:
        assert base.execute(change).rowcount != 0
    with pytest.raises(SceneError, match=message):
        merged([path])


def test_a_store_in_which_bytes_have_changed_gives_its_table_or_none(tmp_path: Path, thread: Executor) -> None:
    path, near = tmp_path / "s.db", tmp_path / "near.db"
    sweep("gas:n=2", ["seed=1..3"], ["single"], events=10, executor=thread, store=str(path))
    good, data, draw, refused = rows(str(path)), path.read_bytes(), np.random.default_rng(5), 0
    for _ in range(200):
        at = int(draw.integers(len(data)))
        near.write_bytes(data[:at] + draw.bytes(3) + data[at + 3 :])
        try:
            assert rows(str(near)) == good
        except SceneError:
            refused += 1
    assert refused > 20


def test_a_scene_without_all_of_its_rows_is_run_again(tmp_path: Path, thread: Executor) -> None:
    path = str(tmp_path / "s.db")
    args: dict[str, Any] = {"events": 10, "executor": thread, "store": path}
    whole = sweep("gas:n=2", ["seed=1..3"], ["single", "double"], **args)
    with sqlite3.connect(path) as base:
        base.execute("DELETE FROM rows WHERE job = 1 AND place = 1")
    assert sweep("gas:n=2", ["seed=1..3"], ["single", "double"], **args) == whole


def test_a_store_left_in_the_middle_of_a_write_is_read_as_it_was_before(tmp_path: Path, thread: Executor) -> None:
    """As `kill -9` leaves it: pages of a row written, and the journal that takes them back."""
    path, left = tmp_path / "s.db", tmp_path / "left.db"
    whole = sweep("gas:n=2", ["seed=1..4"], ["single"], events=10, executor=thread, store=str(path))
    base = sqlite3.connect(path)
    base.execute("PRAGMA cache_size = 1")
    base.execute("BEGIN")
    base.execute("DELETE FROM rows WHERE job < 3")
    text = '"' + "x" * 3000 + '"'
    base.executemany("INSERT INTO rows (job, place, row) VALUES (?, 0, ?)", [(k, text) for k in range(10, 60)])
    for end in ("", "-journal"):
        Path(f"{left}{end}").write_bytes(Path(f"{path}{end}").read_bytes())
    base.close()
    assert left.stat().st_size > 100_000, "nothing of the change had been written yet"
    assert merged([str(left)]) == whole


def test_a_store_is_read_while_another_process_writes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = str(tmp_path / "a.store")
    monkeypatch.setattr("truebreak.compare.grids.store.PATIENCE", 0.01)
    writer = Store(path, {"grid": "sweep"})
    writer.add(0, "k", [Row(0, "lee", "double")], 1)
    reader, tried = Store(path), list[str]()

    def between(statement: str) -> None:
        """Another scene comes once the reader has read the rows, and before it counts the scenes."""
        if statement.startswith("SELECT count(*) FROM jobs"):
            try:
                writer.add(1, "k", [Row(1, "lee", "double")], 1)
            except SceneError as error:  # it would wait, in another process
                tried.append(str(error))

    reader.base.set_trace_callback(between)
    reader.verify()
    assert len(tried) == 1
    assert "locked" in tried[0]
    reader.base.set_trace_callback(None)
    writer.keep()
    reader.verify()
    assert len(reader) == 2


def test_a_full_disk_loses_nothing(tmp_path: Path) -> None:
    """SQLite is told that the file may grow no further: the error is that of a full disk."""
    path = str(tmp_path / "s.db")
    asked = plan("gas:n=3", ["seed=1..40"], ["single"], events=10)
    base = Store(path, asked.settings)
    (row,) = asked.job(0).rows()
    (pages,) = base.base.execute("PRAGMA page_count").fetchone()
    base.base.execute(f"PRAGMA max_page_count = {pages + 3}")
    kept = 0
    with pytest.raises(SceneError, match="database or disk is full; make room, and call again"):
        for index in range(40):
            base.add(index, "", [replace(row, index=index)], 0.0)
            base.keep()
            kept += 1
    base.close()
    assert kept > 0
    assert [r.index for r in merged([path])] == list(range(kept))


# -- workers


class Failing(Executor):
    """Carries jobs out at once, but for some, which it fails so many times."""

    def __init__(self, failing: dict[int, int]) -> None:
        self.failing = dict(failing)

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        (job,) = args
        if self.failing.get(job.index, 0) > 0:
            self.failing[job.index] -= 1
            future.set_exception(MemoryError("no room"))
        else:
            future.set_result(fn(job))
        return future


def test_what_fails_is_tried_again_and_noted_beside_the_table(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(tmp_path / "s.db")
    asked = plan("gas:n=3", ["seed=1..5"], ["single"], events=20)
    base = Store(path, asked.settings)
    run(asked, base, executor=Failing({1: 1, 3: 2}))
    assert [row.index for row in base] == [0, 1, 2, 4]
    noted = [(1, 1, "MemoryError: no room"), (3, 1, "MemoryError: no room"), (3, 2, "MemoryError: no room")]
    assert base.failures() == noted
    assert read(path, capsys) == (4, ["; another attempt was done", "no room", "no room"])
    run(asked, base, executor=Failing({}))
    assert [row.index for row in base] == [0, 1, 2, 3, 4]
    assert base.failures() == noted
    assert read(path, capsys) == (0, ["; another attempt was done"] * 3)
    base.close()


def read(path: str, capsys: pytest.CaptureFixture[str]) -> tuple[int, list[str]]:
    """The exit code of a store that is read, and how each line on its failures ends."""
    with pytest.raises(SystemExit) as stop:
        main(["sweep", "--store", path])
    lines = [line for line in capsys.readouterr().err.splitlines() if "came to nothing" in line]
    return int(stop.value.code or 0), [line.rpartition("MemoryError: ")[2].removeprefix("no room") or "no room"
                                       for line in lines]  # fmt: skip


def test_a_worker_that_is_killed_costs_nothing_but_time() -> None:
    """A real pool, whose only worker is killed twice."""
    asked = plan("gas:n=3", ["seed=1..6"], ["single"], events=30)
    base, killed = Store(":memory:", asked.settings), []

    def kill(done: Done) -> None:
        if done.there in (1, 4) and done.there not in killed:
            killed.append(done.there)
            for child in multiprocessing.active_children():
                os.kill(child.pid or 0, signal.SIGKILL)

    run(asked, base, jobs=1, progress=kill)
    with ThreadPoolExecutor(1) as one:
        assert base == sweep("gas:n=3", ["seed=1..6"], ["single"], events=30, executor=one)
    assert killed == [1, 4]
    told = base.failures()
    assert told
    assert all(attempt == 1 and "BrokenProcessPool" in note for _, attempt, note in told)


def killed_again_and_again(folder: Path, kills: int, scenes: int) -> None:
    """A sweep that is killed with SIGKILL at moments all over its course has the table of one that never was."""
    command = [sys.executable, "-P", "-m", "truebreak", "sweep", "gas:n=3", "--vary", f"seed=1..{scenes}", "--engines",
               "single,double", "--events", "60", "--jobs", "2", "--store"]  # fmt: skip
    whole = str(folder / "whole.db")
    assert subprocess.run([*command, whole], capture_output=True, check=False).returncode == 0
    draw = np.random.default_rng(kills)
    for turn in range(20):
        broken = str(folder / f"broken-{turn}.db")
        if all(_killed([*command, broken], broken, draw, scenes / kills) for _ in range(kills)):
            break
    else:
        raise AssertionError("a sweep was always over before it was killed")
    done = subprocess.run([*command, broken], capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert rows(broken) == rows(whole)


def _killed(command: list[str], store: str, draw: np.random.Generator, most: float) -> bool:
    """Kills a sweep once it has stored so many more scenes at most; whether it was under way still, which a machine
    that stalls does not grant."""
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    goal = _there(store) + int(draw.integers(0, max(int(most), 1) + 1))
    while child.poll() is None and _there(store) < goal:
        clock.sleep(0.01)
    clock.sleep(float(draw.uniform(0, 0.05)))
    child.send_signal(signal.SIGKILL)
    return child.wait() == -signal.SIGKILL


def _there(path: str) -> int:
    """How many scenes a store holds, which another process may be writing to."""
    if not Path(path).exists():
        return 0
    try:
        base = sqlite3.connect(f"file:{path}?mode=ro", uri=True)
        (count,) = base.execute("SELECT count(*) FROM jobs").fetchone()
        base.close()
    except sqlite3.Error:
        return 0
    return count


def test_a_sweep_that_is_killed_twice_has_the_same_table(tmp_path: Path) -> None:
    killed_again_and_again(tmp_path, 2, 8)


@pytest.mark.slow
def test_a_sweep_that_is_killed_20_times_has_the_same_table(tmp_path: Path) -> None:
    killed_again_and_again(tmp_path, 20, 80)


# -- how much is handed out, held and run


class Crowd(Executor):
    """So many workers that each waits until all have a job."""

    def __init__(self, workers: int) -> None:
        self.workers, self.waiting = workers, list[tuple[Future[Any], Any]]()

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        self.waiting.append((future, fn(*args)))
        if len(self.waiting) == self.workers:
            for one, result in self.waiting:
                one.set_result(result)
            self.waiting.clear()
        return future


def test_an_executor_of_the_caller_s_is_kept_busy_whatever_its_size(monkeypatch: pytest.MonkeyPatch) -> None:
    """It would wait for ever for the last of its workers to be given a job."""
    monkeypatch.setattr(SweepJob, "rows", lambda job: [Row(job.index, job.scene, "double", "agree")])
    rows = sweep("gas:n=3", ["seed=1..2000"], executor=Crowd(1000))
    assert [row.index for row in rows] == list(range(2000))


def test_no_rows_are_held_while_a_sweep_runs(monkeypatch: pytest.MonkeyPatch, thread: Executor) -> None:
    held: list[int] = []

    def count(done: Done) -> None:
        if done.there % 500 == 0:
            held.append(sum(type(one) is Row for one in gc.get_objects()))

    monkeypatch.setattr(SweepJob, "rows", lambda job: [Row(job.index, job.scene, "double", "agree", settings={})])
    gc.collect()
    before = sum(type(one) is Row for one in gc.get_objects())
    asked = plan("gas:n=3", ["seed=1..3000"])
    store = Store(":memory:", asked.settings)
    run(asked, store, executor=thread, jobs=4, progress=count)
    assert len(held) == 6
    assert max(held) - before < 100
    total = 0
    for row in store:
        total += row.index
    assert total == 3000 * 2999 // 2


def test_a_scene_is_run_once_by_the_exact_engine_and_once_by_each_other(monkeypatch: pytest.MonkeyPatch) -> None:
    """And once more at most where what comes at the end has to be settled; forecasts are made if they are asked for."""
    runs: dict[str, int] = {}

    def counted(kind: type) -> None:
        real = kind.run

        def run_counted(self: Any, scene: Any, **limits: Any) -> Any:
            runs[kind.__name__] = runs.get(kind.__name__, 0) + 1
            return real(self, scene, **limits)

        monkeypatch.setattr(kind, "run", run_counted)

    counted(ExactEngine)
    counted(DoubleEngine)
    asked: list[Any] = []
    monkeypatch.setattr("truebreak.compare.grids.family_sweep.Forecast", asked.append)
    for spec in ("gas:seed=2", "gas:n=3,seed=2", "pinball", "rack:rows=3,gap=1/50"):
        runs.clear()
        SweepJob(0, spec, {}, ("double",), 80).rows()
        assert runs["ExactEngine"] <= 2 and runs["DoubleEngine"] <= 2, (spec, runs)
    assert asked == []
