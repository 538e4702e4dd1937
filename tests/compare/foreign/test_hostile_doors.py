"""Engines that hang, fork, exit, eat memory or print do no harm to `judge`, `check` and `survey`."""

from __future__ import annotations

import json
import os
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest
from command_line import said

import truebreak as tb
from truebreak.compare.foreign import isolated, isolation
from truebreak.compare.foreign.isolation import EngineWarning
from truebreak.compare.grids import engine_survey as surveys
from truebreak.compare.testing.check import NotDecided
from truebreak.compare.validation import EngineError

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="memory is limited there only")

ENGINES = """\
import os, time
from truebreak.floating import DoubleEngine

def leave_alone(deed):
    while True:
        try:
            time.sleep(60)
        except BaseException:
            pass

DEEDS = {
    "Hangs": leave_alone,
    "Forks": lambda _: os.fork(),
    "Exits": lambda _: os._exit(3),
    "Eats": lambda _: [bytearray(1 << 20) for _ in iter(int, 1)],
    "Prints": lambda _: print("hello"),
}

class Hostile(DoubleEngine):
    def run(self, scene, **limits):
        DEEDS[type(self).__name__](None)
        return super().run(scene, **limits)

for deed in DEEDS:
    globals()[deed] = type(deed, (Hostile,), {"__module__": __name__})
"""

ENDS = {
    "Hangs": "did not end by itself, and was ended",
    "Forks": "run began another process by fork, which is refused",
    "Exits": "run ended its process, with exit code 3",
    "Eats": "run needed more than 100 MB of memory (--max-memory)",
}
"""What is said of each."""

LIMITS = {"Hangs": ("--max-seconds", "2"), "Eats": ("--max-memory", "100")}
"""Limits by which they are isolated; the others are by --isolate."""

SCENE = "galperin:n=0"


def limited(deed: str) -> tuple[str, ...]:
    return LIMITS.get(deed, ("--isolate",))


@pytest.fixture(autouse=True)
def hostile(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A module of such engines, that can be imported."""
    (tmp_path / "hostile_engines.py").write_text(ENGINES, "utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(isolation, "_warned", set())
    before = children()
    yield
    sys.modules.pop("hostile_engines", None)
    for child in children() - before:
        assert b"multiprocessing" in Path(f"/proc/{child}/cmdline").read_bytes()  # none of theirs is left


def children() -> set[str]:
    """The processes below this one, such as a checker that other tests go on asking."""
    return {*Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children").read_text("ascii").split()}


# -- judge: the reference may be anybody's


@pytest.fixture
def log(tmp_path: Path) -> str:
    """What the engine in doubles records of the scene."""
    run = tb.run(tb.scene(SCENE), "double")
    rows = [{"time": float(e.time), "contacts": [list(c) for c in e.contacts]} for e in run.events]
    path = tmp_path / "log.jsonl"
    path.write_text("".join(json.dumps(row) + "\n" for row in [*rows, {"end": 99.0, "quiet": True}]), "utf-8")
    return str(path)


@pytest.mark.parametrize("deed", ENDS)
def test_judge_outlives_its_reference(deed: str, log: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = said(capsys, "judge", SCENE, log, "--reference", f"hostile_engines:{deed}", *limited(deed))
    assert (code, out) == (4 if deed == "Hangs" else 2, "")
    assert ENDS[deed] in err
    assert err.startswith("truebreak: ")
    assert err.count("\n") == 1


def test_judge_leaves_out_what_its_reference_prints(log: str, capsys: pytest.CaptureFixture[str]) -> None:
    words = ("judge", SCENE, log, "--reference", "hostile_engines:Prints", "--json")
    code, out, err = said(capsys, *words, "--isolate")
    assert code == 0, err
    assert json.loads(out)["candidates"][0]["verdict"] == "agree"
    assert "printed 1 line that is left out: 'hello'" in err


# -- check


@pytest.mark.parametrize("deed", ENDS)
def test_check_outlives_its_engine(deed: str) -> None:
    """One that hangs has its seconds; no limit of its own is asked of the others."""
    megabytes = 100 if deed == "Eats" else None
    with isolated(max_memory=megabytes), pytest.raises(NotDecided if deed == "Hangs" else EngineError) as error:
        tb.check(f"hostile_engines:{deed}", SCENE, max_seconds=2 if deed == "Hangs" else None)
    assert ENDS[deed] in str(error.value)


def test_seconds_alone_isolate_what_is_checked() -> None:
    with pytest.raises(NotDecided, match="did not end by itself, and was ended"):
        tb.check("hostile_engines:Hangs", SCENE, max_seconds=2)


def test_check_leaves_out_what_its_engine_prints(capfd: pytest.CaptureFixture[str]) -> None:
    with isolated(), pytest.warns(EngineWarning, match="printed 1 line that is left out: 'hello'"):
        checked = tb.check("hostile_engines:Prints", SCENE)
    assert checked.asserted
    assert capfd.readouterr() == ("", "")


# -- survey


@pytest.mark.parametrize("deed", [*ENDS, "Prints"])
@pytest.mark.parametrize("more", [(), ("--no-causes", "--no-advice")], ids=["whole", "quick"])
def test_survey_outlives_what_it_surveys(
    deed: str, more: tuple[str, ...], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its first run of each engine, which warms it up and is told nowhere, too."""
    offered = Path("hostile-1.dist-info")  # as of a package that is installed: it is run in a worker process
    offered.mkdir()
    (offered / "METADATA").write_text("Metadata-Version: 2.1\nName: hostile\nVersion: 1\n", "utf-8")
    (offered / "entry_points.txt").write_text(f"[truebreak.engines]\nhostile = hostile_engines:{deed}\n", "utf-8")
    rows = [surveys.Surveyed("hostile", "math", "", "harm", "", ("",)), surveys.SURVEYED[0]]
    monkeypatch.setattr(surveys, "SURVEYED", tuple(rows))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EngineWarning)
        words = ("survey", "--scenes", "cradle, apart", "--jobs", "1", "--json", *more, *limited(deed))
        code, out, err = said(capsys, *words)
    assert code == 0, err
    first, second = json.loads(out)["rows"]
    assert second["verdict"] in ("agree", "diverged")
    assert "hello" not in out
    if deed == "Prints":
        assert first["verdict"] == second["verdict"]
    else:
        assert first["verdict"] == ("undecided" if deed == "Hangs" else "failed")
        assert ENDS[deed] in f"{first['ended']} {first['note']}"
