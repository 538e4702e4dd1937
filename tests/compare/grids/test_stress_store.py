"""The store of a stress map: it goes on after any end, ends the same, and no other is taken for it."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import time as clock
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from truebreak.compare.grids import stress_families
from truebreak.compare.grids.grid import Done, carry_out
from truebreak.compare.grids.row import Row
from truebreak.compare.grids.store import Store, merged
from truebreak.compare.grids.stress_map import StressJob, StressMap
from truebreak.compare.grids.stress_map import stress_plan as plan
from truebreak.scenarios import SceneError

SMALL = plan(["near-ties", "corners"], ["double"], levels="14..17")


def opened(path: Path | None, asked: StressMap = SMALL) -> Store:
    return Store(":memory:" if path is None else str(path), asked.settings)


def places(rows: Sequence[Row]) -> int:
    return sum(row.engine == "exact" for row in rows)


@pytest.fixture(scope="module")
def whole() -> list[Row]:
    """The rows of a map that nothing interrupted."""
    store = opened(None)
    carry_out(SMALL, store, jobs=1)
    return list(store)


def test_several_workers_make_the_same_rows(whole: list[Row], tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    store = opened(path)
    carry_out(SMALL, store, jobs=2)
    assert list(store) == whole
    assert places(whole) == 16
    assert merged([str(path)]) == whole


def test_a_map_that_is_interrupted_goes_on_and_ends_the_same(whole: list[Row], tmp_path: Path) -> None:
    path, fresh = tmp_path / "map.db", list[Done]()

    def stop(done: Done) -> None:
        if done.there == 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        carry_out(SMALL, opened(path), jobs=1, progress=stop)
    assert places(opened(path)) == 5
    carry_out(SMALL, opened(path), jobs=1, progress=fresh.append)
    assert [done.there for done in fresh] == list(range(6, 17))
    assert opened(path) == whole


def test_a_finished_map_runs_nothing(whole: list[Row], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "map.db"
    carry_out(SMALL, opened(path), jobs=1)
    monkeypatch.setattr(StressJob, "rows", None)
    carry_out(SMALL, opened(path), jobs=1)
    assert opened(path) == whole


def there(path: Path) -> int:
    """How many places a store holds, which another process may be writing to."""
    try:
        return Store(str(path)).scenes
    except SceneError:
        return 0


def killed(folder: Path, kills: int) -> None:
    """A map that is killed with SIGKILL again and again has the rows of one that never was."""
    words = ["stress", "near-ties", "grazes", "--levels", "1..40", "--engines", "double", "--jobs", "1", "--store"]
    command = [sys.executable, "-P", "-m", "truebreak", *words]
    full, broken = folder / "whole.db", folder / "broken.db"
    assert subprocess.run([*command, str(full)], capture_output=True, check=False).returncode == 0
    deaths, before = 0, 0
    for _ in range(kills):
        child = subprocess.Popen([*command, str(broken)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while child.poll() is None and there(broken) <= before:
            clock.sleep(0.01)
        child.send_signal(signal.SIGKILL)
        deaths += child.wait() == -signal.SIGKILL
        assert there(broken) >= before
        before = there(broken)
    assert deaths > 0
    assert subprocess.run([*command, str(broken)], capture_output=True, check=False).returncode == 0
    assert merged([str(broken)]) == merged([str(full)])


def test_a_map_that_is_killed_twice_has_the_same_rows(tmp_path: Path) -> None:
    killed(tmp_path, 2)


@pytest.mark.slow
def test_a_map_that_is_killed_ten_times_has_the_same_rows(tmp_path: Path) -> None:
    killed(tmp_path, 10)


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (plan(["near-ties"], ["double"], levels="14..17"), "its families is "),
        (plan(["near-ties", "corners"], ["quad"], levels="14..17"), "its engines is "),
        (plan(["near-ties", "corners"], ["double"], levels="14..18"), "its levels is "),
        (plan(["near-ties", "corners"], ["double"], short=True), "its levels is "),
    ],
)
def test_the_store_of_another_map_is_refused(tmp_path: Path, other: StressMap, message: str) -> None:
    path = tmp_path / "map.db"
    opened(path).close()
    before = path.read_bytes()
    with pytest.raises(SceneError, match=f"holds another stress map: {message}"):
        opened(path, other)
    assert path.read_bytes() == before


def test_the_store_of_another_version_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "map.db"
    opened(path).close()
    with pytest.raises(SceneError, match="its versions is "):
        Store(str(path), {**SMALL.settings, "versions": "truebreak 9"})


def test_a_file_of_before_is_refused_and_left_as_it_is(tmp_path: Path) -> None:
    path, old = (
        tmp_path / "map.jsonl",
        b'{"says":{"format":"truebreak/stress-store-2"},"sum":"0123456789abcdef"}\n' * 99,
    )
    path.write_bytes(old)
    with pytest.raises(SceneError, match="is no store of a grid, or damaged"):
        opened(path)
    assert path.read_bytes() == old


def test_a_place_whose_worker_is_ended_is_made_again(tmp_path: Path) -> None:
    """By SIGKILL, after the first row."""
    path, long = tmp_path / "map.db", plan(["near-ties"], ["double"], levels="1..40")

    def kill(done: Done) -> None:
        for child in multiprocessing.active_children() if done.there == 1 else ():
            os.kill(child.pid or 0, signal.SIGKILL)

    store = opened(path, long)
    carry_out(long, store, jobs=2, progress=kill)
    assert places(store) == 80
    assert store.failures() and not store.failures(undone=True)


def test_places_of_a_family_that_has_changed_since_are_made_again(
    whole: list[Row], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, fresh = tmp_path / "map.db", list[Done]()
    carry_out(SMALL, opened(path), jobs=1)
    old = stress_families.FAMILIES["corners"]
    later = replace(old, make=lambda k, side, seed: old.make(k + 1, side, seed))
    monkeypatch.setitem(stress_families.FAMILIES, "corners", later)
    carry_out(SMALL, opened(path), jobs=1, progress=fresh.append)
    assert len(fresh) == 8
    corners = [row for row in opened(path) if row.index >= 8]
    assert [row.digest for row in corners] != [row.digest for row in whole if row.index >= 8]
    assert list(opened(path))[:16] == whole[:16]


def test_what_is_no_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="is a folder"):
        opened(tmp_path)
    with pytest.raises(SceneError, match="there is no such file"):
        Store(str(tmp_path / "none.db"))
    with pytest.raises(SceneError, match="there is no folder"):
        opened(tmp_path / "nowhere" / "map.db")
