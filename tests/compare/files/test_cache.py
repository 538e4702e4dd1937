"""Kept runs: the same run at less cost, never a damaged one, never more than there is room for."""

from __future__ import annotations

import gzip
import json
import multiprocessing
import os
import subprocess
import sys
import warnings
from pathlib import Path

import pytest
from command_line import said

from truebreak.compare import trajectory_json
from truebreak.compare.files import cache as certified_cache
from truebreak.compare.files.cache import CachedEngine, CacheWarning, cache_folder, cached, kept_value
from truebreak.compare.files.saved import saved_run
from truebreak.compare.testing.check import check
from truebreak.compare.tolerances.reach import ErrorWalk
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine, PymunkEngine
from truebreak.scenarios import Scene, Trajectory, catalogue


@pytest.fixture(name="folder")
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of kept runs, in which even cheap ones are kept."""
    monkeypatch.setenv("TRUEBREAK_CACHE", str(tmp_path / "kept"))
    monkeypatch.setattr(certified_cache, "LEAST_SECONDS", 0.0)
    monkeypatch.setattr(certified_cache, "SHARE", 0)
    return tmp_path / "kept"


@pytest.fixture(name="runs")
def _runs(monkeypatch: pytest.MonkeyPatch) -> list[Scene]:
    """The scenes that were really run."""
    made: list[Scene] = []
    run = ExactEngine.run_with

    def noted(self: ExactEngine, scene: Scene, *words: object, **more: object) -> Trajectory:
        made.append(scene)
        return run(self, scene, *words, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(ExactEngine, "run_with", noted)
    return made


LEE = catalogue.build("lee")


def test_a_run_is_made_once(folder: Path, runs: list[Scene]) -> None:
    first = CachedEngine().run(LEE, events=2)
    again = CachedEngine().run(LEE, events=2)
    assert (len(runs), len(list(folder.iterdir()))) == (1, 1)
    assert trajectory_json(again, exact=True) == trajectory_json(first, exact=True)
    assert saved_run(again) == saved_run(first)


def test_a_scene_of_another_name_is_the_same_run(folder: Path, runs: list[Scene]) -> None:
    CachedEngine().run(LEE, events=2)
    again = CachedEngine().run(LEE.with_changes(name="other"), events=2)
    assert (len(runs), again.scene.name) == (1, "other")
    assert json.loads(saved_run(again))["scene"]["name"] == "other"
    assert trajectory_json(again)["scene"]["name"] == "other"
    assert len(list(folder.iterdir())) == 1


def test_all_that_decides_a_run_tells_it_from_others(monkeypatch: pytest.MonkeyPatch) -> None:
    engine = CachedEngine()
    keys = [
        engine.key(LEE, events=2),
        engine.key(LEE, events=3),
        engine.key(LEE, until=2),
        engine.key(LEE, until="sqrt(2)"),
        engine.key(LEE, until=2, events=2),
        engine.key(LEE.with_changes(tie_policy="sequential:seed=1"), events=2),
        engine.key(LEE.with_changes(tie_policy="sequential:seed=2"), events=2),
        engine.key(LEE.with_changes(reverse_after=1, until=None, events=None)),
        engine.key(catalogue.build("cradle"), events=2),
        CachedEngine(work=9).key(LEE, events=2),
        CachedEngine(max_bits=512).key(LEE, events=2),
        CachedEngine(ties="assume:90").key(LEE, events=2),
    ]
    monkeypatch.setattr(certified_cache, "VERSION", "9.9")
    keys.append(engine.key(LEE, events=2))
    assert len(set(keys)) == len(keys)


DAMAGE = {
    "cut short": lambda data: data[:-20],
    "one bit": lambda data: data[:200] + bytes([data[200] ^ 1]) + data[201:],
    "empty": lambda data: b"",
    "something else": lambda data: b"hello",
    "another text": lambda data: gzip.compress(b"{}"),
    "a number changed": lambda data: gzip.compress(gzip.decompress(data).replace(b'"-2"', b'"-9"', 1)),
    "of another version": lambda data: gzip.compress(gzip.decompress(data).replace(b'"version":"', b'"version":"9', 1)),
    "not a text": lambda data: gzip.compress(b"\xff\xfe\x00"),
}


@pytest.mark.parametrize("kind", DAMAGE)
def test_a_damaged_one_is_told_and_made_again(kind: str, folder: Path, runs: list[Scene]) -> None:
    first = CachedEngine().run(LEE, events=2)
    (path,) = folder.iterdir()
    whole = path.read_bytes()
    path.write_bytes(DAMAGE[kind](whole))
    with pytest.warns(CacheWarning, match="a kept run is damaged") as told:
        again = CachedEngine().run(LEE, events=2)
    assert (len(told), len(runs)) == (1, 2)
    assert "\n" not in str(told[0].message)
    assert trajectory_json(again) == trajectory_json(first)
    assert path.read_bytes() == whole
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        CachedEngine().run(LEE, events=2)
    assert len(runs) == 2


def test_a_run_of_another_scene_in_its_place_is_told(folder: Path) -> None:
    CachedEngine().run(catalogue.build("cradle"), events=2)
    (path,) = folder.iterdir()
    path.rename(folder / f"{CachedEngine().key(LEE, events=2)}.json.gz")
    with pytest.warns(CacheWarning, match="another scene"):
        run = CachedEngine().run(LEE, events=2)
    assert run.scene.digest == LEE.digest


def test_what_ended_by_the_clock_is_not_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from truebreak.exact.simulation.instant import Gatherer

    def interrupted(self: Gatherer, last: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Gatherer, "gather", interrupted)
    assert CachedEngine().run(LEE, events=2).stop.reason.name == "INTERRUPTED"
    assert not folder.exists()


def test_cheap_runs_are_not_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TRUEBREAK_CACHE", str(tmp_path / "kept"))
    monkeypatch.setattr(certified_cache, "LEAST_SECONDS", 1e9)
    CachedEngine().run(LEE, events=2)
    assert not (tmp_path / "kept").exists()


def test_there_is_room_for_the_latest(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for events in (1, 2):
        CachedEngine().run(LEE, events=events)
    sizes = {path: path.stat().st_size for path in folder.iterdir()}
    old = folder / f"{CachedEngine().key(LEE, events=1)}.json.gz"
    os.utime(old, (1, 1))
    monkeypatch.setattr(certified_cache, "LARGEST_SHARE", 1)
    monkeypatch.setattr(certified_cache, "MOST_BYTES", sum(sizes.values()) + 100)
    CachedEngine().run(LEE, until=1)
    assert not old.exists()
    assert sum(path.stat().st_size for path in folder.iterdir()) <= certified_cache.MOST_BYTES
    monkeypatch.setattr(certified_cache, "MOST_BYTES", 100)
    before = set(folder.iterdir())
    CachedEngine().run(LEE, until=2)
    assert set(folder.iterdir()) == before


def test_a_place_that_cannot_be_written_to_is_told(folder: Path) -> None:
    folder.write_text("a file")
    with pytest.warns(CacheWarning) as told:
        run = CachedEngine().run(LEE, events=2)
    assert (len(run.events), len(told)) == (1, 1)
    assert all("\n" not in str(one.message) for one in told)


def test_only_the_exact_engine_is_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert isinstance(cached(ExactEngine(work=7)), CachedEngine)
    assert cached(ExactEngine(work=7)).work == 7  # type: ignore[attr-defined]
    assert isinstance(cached(DoubleEngine()), DoubleEngine)
    monkeypatch.setenv("TRUEBREAK_CACHE", "")
    assert type(cached(ExactEngine())) is ExactEngine
    monkeypatch.delenv("TRUEBREAK_CACHE")
    place = cache_folder()
    assert place is not None
    assert place.name == "truebreak"


def _one(events: int) -> str:
    return saved_run(CachedEngine().run(catalogue.build("gas:n=3"), events=events))


def test_several_processes_at_once(folder: Path) -> None:
    with multiprocessing.get_context("fork").Pool(4) as pool:
        told = pool.map(_one, [5, 6] * 8)
    assert len(set(told)) == 2
    assert len(list(folder.iterdir())) == 2


def test_the_command_line(folder: Path, runs: list[Scene], capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    words = ("run", "lee", "--events", "2", "--json")
    plain = said(capsys, *words, "--no-cache")
    assert not folder.exists()
    assert said(capsys, *words) == said(capsys, *words) == plain
    assert len(runs) == 2
    (path,) = folder.iterdir()
    path.write_bytes(b"hello")
    code, out, err = said(capsys, *words)
    assert (code, out) == plain[:2]
    assert err.startswith(f"truebreak: warning: {path}: a kept run is damaged")
    assert err.count("\n") == 1
    log = tmp_path / "log.jsonl"
    log.write_text('{"time": 1.0, "contacts": [["left", "middle"], ["middle", "right"]]}\n')
    for command in (("compare", "lee", "--engines", "double"), ("judge", "lee", str(log))):
        begun = len(list(folder.iterdir()))
        first = said(capsys, *command, "--events", "1")[:2]
        had, made = len(list(folder.iterdir())), len(runs)
        assert had > begun or command[0] == "judge"
        assert said(capsys, *command, "--events", "1")[0] == first[0]
        assert len(runs) == made
        said(capsys, *command, "--events", "1", "--no-cache")
        assert len(runs) > made


def test_tests_leave_the_users_own_alone() -> None:
    assert os.environ["TRUEBREAK_CACHE"] == ""
    code = "from truebreak.compare.files.cache import cache_folder; print(cache_folder())"
    out = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, check=True).stdout
    assert out == "None\n"


def test_a_value_is_computed_once_and_again_where_anything_that_decides_it_is_another(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(certified_cache, "VALUE_SECONDS", 0.0)
    made: list[float] = []

    def value(*key: object) -> object:
        return kept_value(key, lambda: made.append(0.1) or [0.1, float("inf"), {"a": None}])

    assert value("one", 2) == value("one", 2) == [0.1, float("inf"), {"a": None}] and len(made) == 1
    value("one", 3)
    monkeypatch.setattr(certified_cache, "_code", lambda: "changed")
    value("one", 2)
    assert len(made) == 3
    for path in folder.glob("value-*"):
        path.write_bytes(b"nonsense")
    with pytest.warns(CacheWarning, match="damaged"):
        value("one", 2)
    (named,) = (path for path in folder.glob("value-*") if path.read_bytes() != b"nonsense")
    for path in folder.glob("value-*"):  # a file in another's place is none of its own
        path.write_bytes(named.read_bytes())
    assert value("one", 3) and len(made) == 5


def test_a_warm_check_says_the_same_and_walks_no_more(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = catalogue.build("gas")
    cold = check("double", scene)
    assert list(folder.glob("value-*"))
    monkeypatch.setattr(ErrorWalk, "walked", lambda walk: pytest.fail("walked again"))
    warm = check("double", scene)
    assert str(warm) == str(cold) and warm.reach == cold.reach


def test_the_lateness_of_an_engine_whose_library_no_key_names_is_measured_anew(folder: Path) -> None:
    class Later(PymunkEngine):
        pass

    check("pymunk", catalogue.build("gas:n=3"))
    kept = len(list(folder.glob("value-*")))
    check(Later(), catalogue.build("gas:n=3"))
    assert kept and len(list(folder.glob("value-*"))) == kept
