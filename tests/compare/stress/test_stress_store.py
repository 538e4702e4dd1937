"""The file of a stress map: it goes on after any end, ends the same, and no other file is taken for it."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import time as clock
from pathlib import Path

import pytest

from truebreak.compare.stress.plan import Done, Plan, carry_out, plan
from truebreak.compare.stress.store import Store
from truebreak.scenarios import SceneError

SMALL = plan(["near-ties", "corners"], ["double"], levels="14..17")


def opened(path: Path | None, asked: Plan = SMALL) -> Store:
    return Store(None if path is None else str(path), asked.settings, list(asked.places()))


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The file of a map that nothing interrupted."""
    path = tmp_path_factory.mktemp("whole") / "map.jsonl"
    carry_out(SMALL, opened(path))
    return path.read_bytes()


def test_a_file_holds_what_memory_holds(whole: bytes, tmp_path: Path) -> None:
    path = tmp_path / "map.jsonl"
    path.write_bytes(whole)
    rows = carry_out(SMALL, opened(None))
    assert len(rows) == 16
    assert opened(path).rows == rows
    assert Store(str(path)).rows == rows
    assert Store(str(path)).settings == opened(None).settings
    assert path.read_bytes() == whole


@pytest.mark.parametrize("share", [0, 0.01, 0.03, 0.2, 0.5, 0.77, 0.999])
def test_a_file_cut_anywhere_ends_the_same(whole: bytes, tmp_path: Path, share: float) -> None:
    path = tmp_path / "map.jsonl"
    path.write_bytes(whole[: int(share * len(whole))])
    there = opened(path).rows
    fresh: list[Done] = []
    carry_out(SMALL, opened(path), progress=fresh.append)
    assert path.read_bytes() == whole
    assert len(there) + len(fresh) == 16
    assert [done.there for done in fresh] == list(range(len(there) + 1, 17))


def test_rows_are_lost_no_sooner_than_their_line_is(whole: bytes, tmp_path: Path) -> None:
    """A cut after n lines leaves n - 1 rows, a cut within the next line no fewer."""
    path, lines = tmp_path / "map.jsonl", whole.splitlines(keepends=True)
    for count in (1, 2, 9):
        for more in (0, 1, len(lines[count]) - 1):
            path.write_bytes(b"".join(lines[:count]) + lines[count][:more])
            assert len(opened(path).rows) == count - 1


def test_several_workers_write_the_same_file(whole: bytes, tmp_path: Path) -> None:
    path = tmp_path / "map.jsonl"
    carry_out(SMALL, opened(path), jobs=2)
    assert path.read_bytes() == whole


def test_a_finished_map_runs_nothing(whole: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from truebreak.compare.stress import plan as planning

    path = tmp_path / "map.jsonl"
    path.write_bytes(whole)
    monkeypatch.setattr(planning, "row_of", None)
    assert len(carry_out(SMALL, opened(path))) == 16


def killed(folder: Path, kills: int) -> None:
    """A map that is killed with SIGKILL again and again has the file of one that never was."""
    words = ["stress", "near-ties", "grazes", "--levels", "10..19", "--engines", "double", "--store"]
    command = [sys.executable, "-P", "-m", "truebreak", *words]
    full, broken = folder / "whole.jsonl", folder / "broken.jsonl"
    assert subprocess.run([*command, str(full)], capture_output=True, check=False).returncode == 0
    deaths, before = 0, 0
    for turn in range(1, kills + 1):
        child = subprocess.Popen([*command, str(broken)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        goal = full.stat().st_size * turn // (kills + 1)
        while child.poll() is None and (not broken.exists() or broken.stat().st_size < goal):
            clock.sleep(0.002)
        child.send_signal(signal.SIGKILL)
        deaths += child.wait() == -signal.SIGKILL
        there = len(Store(str(broken)).rows)
        assert there >= before
        before = there
    assert deaths == kills
    assert 0 < before < 40
    assert subprocess.run([*command, str(broken)], capture_output=True, check=False).returncode == 0
    assert broken.read_bytes() == full.read_bytes()


def test_a_map_that_is_killed_twice_has_the_same_file(tmp_path: Path) -> None:
    killed(tmp_path, 2)


@pytest.mark.slow
def test_a_map_that_is_killed_ten_times_has_the_same_file(tmp_path: Path) -> None:
    killed(tmp_path, 10)


def flipped(data: bytes, place: int) -> bytes:
    return data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :]


def test_a_damaged_file_is_refused_and_left_as_it_is(whole: bytes, tmp_path: Path) -> None:
    path, lines = tmp_path / "map.jsonl", whole.splitlines(keepends=True)
    cases = {
        "is damaged at line 3": [
            b"".join([*lines[:2], flipped(lines[2], len(lines[2]) // 2), *lines[3:]]),
            b"".join([*lines[:2], *lines[3:]]),
            b"".join([*lines[:2], b"\n", *lines[2:]]),
            b"".join([*lines[:2], lines[3], lines[2], *lines[4:]]),
            b"".join([*lines[:2], b"[1]\n", *lines[2:]]),
        ],
        "is no store of a stress map": [
            b"something of mine, without a line's end",
            b"something of mine\n",
            b"{}\n",
            b'{"says":{},"sum":"0123456789abcdef"}\n',
            b"\xff\xfe\n",
            flipped(whole, 30),
            b"".join(lines[1:]),
        ],
    }
    for message, files in cases.items():
        for data in files:
            path.write_bytes(data)
            for read in (lambda: opened(path), lambda: Store(str(path))):
                with pytest.raises(SceneError, match=message):
                    read()
            assert path.read_bytes() == data


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (plan(["near-ties"], ["double"], levels="14..17"), "its families = "),
        (plan(["near-ties", "corners"], ["quad"], levels="14..17"), "its engines = "),
        (plan(["near-ties", "corners"], ["double"], levels="14..18"), "its levels = "),
        (plan(["near-ties", "corners"], ["double"], short=True), "its levels = "),
    ],
)
def test_the_file_of_another_map_is_refused(whole: bytes, tmp_path: Path, other: Plan, message: str) -> None:
    path = tmp_path / "map.jsonl"
    path.write_bytes(whole)
    with pytest.raises(SceneError, match=f"holds another map: {message}"):
        opened(path, other)
    assert path.read_bytes() == whole


def test_the_file_of_another_version_is_refused(whole: bytes, tmp_path: Path) -> None:
    path = tmp_path / "map.jsonl"
    path.write_bytes(whole)
    with pytest.raises(SceneError, match="its versions = "):
        Store(str(path), {**SMALL.settings, "versions": "truebreak 9"}, list(SMALL.places()))


def test_a_worker_that_is_ended_ends_the_map_with_one_line(whole: bytes, tmp_path: Path) -> None:
    """By SIGKILL, after the first row; the next call goes on."""
    path = tmp_path / "map.jsonl"

    def kill(done: Done) -> None:
        for child in multiprocessing.active_children() if done.there == 1 else ():
            os.kill(child.pid or 0, signal.SIGKILL)

    long = plan(["near-ties", "corners"], ["double"], levels="1..40")
    with pytest.raises(SceneError, match="a worker process was ended; call again"):
        carry_out(long, opened(path, long), jobs=2, progress=kill)
    assert 1 <= len(opened(path, long).rows) < 160


def test_a_family_that_has_changed_since_is_noticed(
    whole: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from dataclasses import replace

    from truebreak.compare.stress.families import corners

    path = tmp_path / "map.jsonl"
    path.write_bytes(whole)
    old = corners.FAMILY
    monkeypatch.setattr(corners, "FAMILY", replace(old, make=lambda k, side, seed: old.make(k + 1, side, seed)))
    with pytest.raises(SceneError, match="line 10 is of another scene than corners has now"):
        opened(path)


def test_a_file_with_rows_of_other_places_is_refused(whole: bytes, tmp_path: Path) -> None:
    path = tmp_path / "map.jsonl"
    path.write_bytes(whole)
    with pytest.raises(SceneError, match="line 2 is of another place"):
        Store(str(path), SMALL.settings, list(SMALL.places())[1:])
    with pytest.raises(SceneError, match="line 17 is of another place"):
        Store(str(path), SMALL.settings, list(SMALL.places())[:-1])


def test_what_is_no_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="is no regular file"):
        opened(tmp_path)
    with pytest.raises(SceneError, match="there is no such file"):
        Store(str(tmp_path / "none.jsonl"))
    with pytest.raises(SceneError, match="No such file"):
        opened(tmp_path / "nowhere" / "map.jsonl")


def test_a_full_disk_ends_it_with_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "map.jsonl"
    store, real, calls = opened(path), os.fsync, []

    def full(descriptor: int) -> None:
        calls.append(descriptor)
        if len(calls) == 3:
            raise OSError(28, "No space left on device")
        real(descriptor)

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(SceneError, match="No space left on device; mend that, and call again"):
        carry_out(SMALL, store)
    monkeypatch.setattr(os, "fsync", real)
    assert 2 <= len(opened(path).rows) <= 3
