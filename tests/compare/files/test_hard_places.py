"""What is kept withstands a full disk, a folder that is only read, two processes at once, a clock that goes back."""

from __future__ import annotations

import contextlib
import gzip
import os
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

import truebreak as tb
from truebreak.compare.files import cache
from truebreak.compare.files.saved import save_run
from truebreak.compare.grids.family_sweep import csv_parts
from truebreak.compare.grids.family_sweep import plan as sweep_plan
from truebreak.compare.grids.store import Store, merged
from truebreak.compare.saved_comparisons import save_comparison
from truebreak.scenarios import SceneError
from truebreak.scenarios.disk import UNFINISHED, Lines

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes that are forked, and limits of theirs")

DONE, REFUSED = 0, 10
"""Exit codes of a writer: all is there; or one line said why not. Any other is a failure."""


@dataclass(frozen=True)
class Kept:
    """One kind of what is kept.

    Attributes:
        write: writes it all, or goes on where it was left.
        told: what is in it, byte by byte; None where times differ from run to run, which are left out of it.
        lasting: whether part of it may stay, to be gone on from.
    """

    write: Callable[[Path], None]
    told: Callable[[Path], bytes]
    lasting: bool


@pytest.fixture(scope="module")
def kinds() -> dict[str, Kept]:
    asked = sweep_plan("gas:n=3", ["seed=1..12"], ["single"], events=5)
    rows = [asked.job(k).rows() for k in range(12)]

    def sweep(path: Path) -> None:
        store = Store(str(path), asked.settings)
        try:
            for k in sorted(set(range(12)) - store.done(asked.key)):
                store.add(k, "", rows[k], 1.0)
        finally:
            store.close()

    def table(path: Path) -> bytes:
        return "".join(csv_parts(merged([str(path)]), ["seed"])).encode()

    run = tb.run(tb.scene("gas:n=4"), events=40)
    compared = tb.comparison(tb.scene("lee"), ["double"], events=2)

    def kept(path: Path) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("error", cache.CacheWarning)
            try:
                cache._keep(path, run)
            except cache.CacheWarning as error:
                raise SceneError(str(error)) from None

    whole = Path.read_bytes
    return {
        "sweep": Kept(sweep, table, True),
        "run": Kept(lambda path: save_run(run, path), whole, False),
        "comparison": Kept(lambda path: save_comparison(compared, path), whole, False),
        "kept run": Kept(kept, lambda path: gzip.decompress(path.read_bytes()), False),
    }


@pytest.fixture(params=["sweep", "run", "comparison", "kept run"])
def kind(request: pytest.FixtureRequest, kinds: dict[str, Kept]) -> Kept:
    return kinds[request.param]


@pytest.fixture
def whole(kind: Kept, tmp_path: Path) -> bytes:
    """What is in it when nothing is in the way."""
    (tmp_path / "whole").mkdir()
    kind.write(tmp_path / "whole" / "file")
    return kind.told(tmp_path / "whole" / "file")


def apart(action: Callable[[], Any]) -> int:
    """Begins something in a process of its own; its number."""
    number = os.fork()
    if number == 0:
        code = 1
        try:
            action()
            code = DONE
        except SceneError as error:
            code = REFUSED if "\n" not in str(error) else 11
        finally:
            os._exit(code)
    return number


def code_of(number: int) -> int:
    return os.waitstatus_to_exitcode(os.waitpid(number, 0)[1])


def test_a_full_disk(kind: Kept, whole: bytes, tmp_path: Path) -> None:
    """Files may have but so many bytes: what was there stays, and once there is room, all of it comes to be there."""
    import resource

    path, size = tmp_path / "file", (tmp_path / "whole" / "file").stat().st_size

    def write(most: int) -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, resource.RLIM_INFINITY))
        kind.write(path)

    codes = []
    for k in range(12):
        codes.append(code_of(apart(lambda k=k: write(k * size // 12))))
        assert not [file for file in tmp_path.iterdir() if UNFINISHED.fullmatch(file.name)]
        if not kind.lasting:
            assert not path.exists()
    assert set(codes) == {REFUSED}
    kind.write(path)
    assert kind.told(path) == whole


def test_a_full_disk_leaves_what_was_there(kind: Kept, whole: bytes, tmp_path: Path) -> None:
    import resource

    path = tmp_path / "file"
    kind.write(path)

    def write() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1, resource.RLIM_INFINITY))
        with contextlib.suppress(SceneError):  # a store that has all asks for no room
            kind.write(path)

    assert code_of(apart(write)) == DONE
    assert kind.told(path) == whole


@pytest.mark.parametrize("rights", [0o555, 0o000])
def test_a_folder_that_may_only_be_read(kind: Kept, rights: int) -> None:
    """Or not even that, by somebody who is not root, who may write anywhere."""
    with tempfile.TemporaryDirectory() as name:
        place, folder = Path(name), Path(name) / "folder"
        place.chmod(0o755)
        folder.mkdir()
        folder.chmod(rights)

        def write() -> None:
            if os.getuid() == 0:
                os.setgroups([])
                os.setegid(65534)
                os.seteuid(65534)
            kind.write(folder / "file")

        code = code_of(apart(write))
        folder.chmod(0o755)
        assert list(folder.iterdir()) == []
    assert code == REFUSED


def test_two_processes_at_once(kind: Kept, whole: bytes, tmp_path: Path) -> None:
    """Either may be told that the other is at it; what there is in the end is what one would have written."""
    for k in range(6):
        path = tmp_path / f"file-{k}"
        numbers = [apart(lambda path=path: kind.write(path)) for _ in range(3)]
        codes = {code_of(number) for number in numbers}
        assert DONE in codes
        assert codes <= {DONE, REFUSED}
        kind.write(path)
        assert kind.told(path) == whole
    assert not [file for file in tmp_path.iterdir() if UNFINISHED.fullmatch(file.name)]


@pytest.fixture
def clock_of_before(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The clock goes back an hour each time it is looked at."""
    told = [time.time()]

    def earlier() -> float:
        told[0] -= 3600
        return told[0]

    monkeypatch.setattr(time, "time", earlier)
    yield


@pytest.mark.usefixtures("clock_of_before")
def test_a_clock_that_goes_back(kind: Kept, whole: bytes, tmp_path: Path) -> None:
    """What is there is of ten years ahead; what is unfinished, and nobody's any more, is removed all the same."""
    path = tmp_path / "file"
    number = apart(lambda: kind.write(path))
    time.sleep(0.01)
    with contextlib.suppress(OSError):
        os.kill(number, 9)
    os.waitpid(number, 0)
    (tmp_path / ".truebreak-0123456789abcdef.part").touch()
    for file in tmp_path.iterdir():
        os.utime(file, (4e9, 4e9))
    kind.write(path)
    assert kind.told(path) == whole
    if not kind.lasting:
        assert not [file for file in tmp_path.iterdir() if UNFINISHED.fullmatch(file.name)]


# -- what a kill may have left, each exactly


def test_a_database_that_a_kill_left_empty_is_taken_up(kinds: dict[str, Kept], tmp_path: Path) -> None:
    """Its file is there, with a page, but no table is: the kill came while it was made."""
    import sqlite3

    path = tmp_path / "file"
    base = sqlite3.connect(path)
    base.executescript("CREATE TABLE t (x); DROP TABLE t;")
    base.close()
    assert path.stat().st_size
    kinds["sweep"].write(path)
    assert len(kinds["sweep"].told(path).splitlines()) == 13


def test_a_line_that_cannot_be_written_leaves_nothing_and_may_be_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = Lines(tmp_path / "file")
    lines.add(b"one\n")
    sync, full = os.fsync, [True]

    def failing(descriptor: int) -> None:
        if full[0]:
            raise OSError(28, "No space left on device")
        sync(descriptor)

    monkeypatch.setattr(os, "fsync", failing)
    with pytest.raises(OSError, match="No space left"):
        lines.add(b"a longer line\n")
    assert (tmp_path / "file").read_bytes() == b"one\n"
    full[0] = False
    lines.add(b"two\n")
    assert (tmp_path / "file").read_bytes() == b"one\ntwo\n"
