"""A file is there whole or not at all, and nothing is left beside it, whoever is killed and whatever the clock says."""

from __future__ import annotations

import os
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

from truebreak.scenarios import disk
from truebreak.scenarios.disk import UNFINISHED, text_of, write_file

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals and locks of POSIX")

WRITER = """\
import sys, time
from pathlib import Path
from truebreak.scenarios import disk
moved = Path.replace
def late(self, target):
    print("written", flush=True)
    time.sleep(60)
    return moved(self, target)
Path.replace = late
disk.write_file(Path(sys.argv[1]), b"new")
"""
"""Writes all but the last step, and waits there."""


def writing(target: Path) -> subprocess.Popen[str]:
    """A process that has written, and not moved."""
    process = subprocess.Popen([sys.executable, "-c", WRITER, str(target)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "written\n"
    return process


def unfinished(folder: Path) -> list[Path]:
    return [path for path in folder.iterdir() if UNFINISHED.fullmatch(path.name)]


def test_what_a_killed_writer_left_is_removed_by_the_next(tmp_path: Path) -> None:
    target = tmp_path / "report.html"
    target.write_bytes(b"old")
    process = writing(target)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert len(unfinished(tmp_path)) == 1
    assert target.read_bytes() == b"old"
    os.utime(unfinished(tmp_path)[0], (time.time() + 10**6,) * 2)  # a clock that went back since
    write_file(tmp_path / "other.html", b"other")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["other.html", "report.html"]


def test_what_a_live_writer_has_is_left_to_it(tmp_path: Path) -> None:
    target = tmp_path / "report.html"
    process = writing(target)
    os.utime(unfinished(tmp_path)[0], (0, 0))
    write_file(target, b"mine")
    assert len(unfinished(tmp_path)) == 1
    process.kill()
    process.wait()
    disk.clear(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]


def test_a_file_of_the_users_own_is_never_removed(tmp_path: Path) -> None:
    names = [".report.html.x7f3", ".truebreak-1.part", ".truebreak-0123456789abcdef.part.bak", "x.part", ".part"]
    for name in names:
        (tmp_path / name).write_bytes(b"")
    write_file(tmp_path / "a", b"")
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*names, "a"])


def test_a_writer_whose_file_was_cleared_before_it_had_the_lock_takes_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert disk.fcntl is not None
    locked, lock = [], disk.fcntl.flock

    def stolen(file: object, how: int) -> None:
        if not locked:
            (path,) = unfinished(tmp_path)
            path.unlink()
        locked.append(1)
        lock(file, how)  # pyright: ignore[reportArgumentType]

    monkeypatch.setattr(disk.fcntl, "flock", stolen)
    write_file(tmp_path / "a", b"whole")
    assert len(locked) == 2
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"whole"]


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_what_fails_leaves_what_was_there(
    error: BaseException, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def failing(descriptor: int) -> None:
        raise error

    target = tmp_path / "a"
    target.write_bytes(b"old")
    monkeypatch.setattr(os, "fsync", failing)
    with pytest.raises(type(error)):
        write_file(target, b"new")
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"old"]


def test_what_matters_is_synced_before_it_is_moved_and_the_folder_after(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[str] = []
    sync, moved = os.fsync, Path.replace

    def noted(descriptor: int) -> None:
        done.append("folder" if stat.S_ISDIR(os.fstat(descriptor).st_mode) else "file")
        sync(descriptor)

    def noted_move(self: Path, target: Path) -> Path:
        done.append("move")
        return moved(self, target)

    monkeypatch.setattr(os, "fsync", noted)
    monkeypatch.setattr(Path, "replace", noted_move)
    write_file(tmp_path / "a", b"x")
    assert done == ["file", "move", "folder"]
    write_file(tmp_path / "a", b"x", lasting=False)
    assert done[3:] == ["move"]


def test_a_file_has_the_rights_that_the_user_gives_new_files(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        write_file(tmp_path / "a", b"")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "a").stat().st_mode) == 0o640


def test_a_name_may_be_as_long_as_the_system_takes(tmp_path: Path) -> None:
    path = tmp_path / ("é" * 127)
    write_file(path, "ü".encode())
    assert text_of(str(path)) == "ü"
