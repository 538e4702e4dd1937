"""Engines named by their class, or by an entry point."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pytest
from command_line import said

from truebreak.compare import engine
from truebreak.scenarios import SceneError

MODULE = """
from dataclasses import dataclass, replace
from truebreak.floating import DoubleEngine
from truebreak.compare.foreign import RecordedEngine
from truebreak.scenarios import Declared

@dataclass(frozen=True)
class Mine(Declared):
    name: str = "own"
    wrong: bool = False
    def run(self, scene, **limits):
        if self.wrong:
            raise ZeroDivisionError("a mass")
        return replace(DoubleEngine().run(scene, **limits), engine=self.name)

class Plain(Declared):
    name = "plain"
    def run(self, scene, **limits):
        return DoubleEngine().run(scene, **limits)

class Hangs(Plain):
    def run(self, scene, **limits):
        while True:
            pass

class Stuck(RecordedEngine):
    name = "stuck"
    def play(self, scene, recording):
        recording.hits(1.0, [("left", "middle"), ("middle", "right")])
        while recording.open:
            pass

class Unmade(Plain):
    def __init__(self, depth):
        pass

def made():
    return Plain()

class Nothing:
    pass
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "ownengines.py").write_text(MODULE, "utf-8")
    (tmp_path / "brokenengines.py").write_text("1 / 0", "utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.delitem(sys.modules, "ownengines", raising=False)
    return tmp_path


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    ("text", "labels"),
    [
        ("ownengines:Mine", ["ownengines:Mine"]),
        ("double,mine=ownengines:Mine:wrong=no", ["double", "mine"]),
        ("ownengines:Plain,ownengines:made", ["ownengines:Plain", "ownengines:made"]),
    ],
)
def test_engines_are_named_by_their_class(text: str, labels: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = said(capsys, "compare", "lee", "--engines", text, "--json")
    assert code == 0, err
    assert [row["engine"] for row in json.loads(out)["candidates"]] == labels


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("nowhere:Mine", "engine 'nowhere:Mine': ModuleNotFoundError"),
        ("brokenengines:Mine", "engine 'brokenengines:Mine': ZeroDivisionError: division by zero"),
        ("ownengines:Mien", "ownengines has no 'Mien'"),
        ("ownengines:Mine:wrnog=yes", "has no parameter 'wrnog'; did you mean 'wrong'?"),
        ("ownengines:Plain:a=1", "takes no parameters"),
        ("ownengines:Unmade", "cannot be made: TypeError"),
        ("ownengines:Nothing", "declares no name"),
        ("ownengines:Mine:wrong=yes", "engine 'own': run raised ZeroDivisionError: a mass"),
        ("ownengine", "engine 'ownengine' is not known"),
    ],
)
def test_an_engine_that_cannot_be_had_is_one_line(text: str, told: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = said(capsys, "compare", "lee", "--engines", text)
    assert (code, out) == (2, "")
    assert told in err
    assert err.count("\n") == 1


@pytest.mark.usefixtures("folder")
def test_an_engine_that_hangs_is_ended(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = said(capsys, "compare", "lee", "--engines", "ownengines:Hangs", "--max-seconds", "1")
    assert code == 4
    assert "(--max-seconds)" in out


@pytest.mark.usefixtures("folder")
def test_a_recorded_engine_that_hangs_keeps_what_it_has(capsys: pytest.CaptureFixture[str]) -> None:
    for seconds in ("1", "4", "16"):  # a slow machine has not begun after one
        code, out, _ = said(capsys, "run", "lee", "--engine", "ownengines:Stuck", "--max-seconds", seconds, "--json")
        if out:
            break
    data = json.loads(out)
    assert (code, data["stop"]["reason"], len(data["events"])) == (4, "budget", 1)


def test_an_entry_point_is_a_name(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    info = folder / "own-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: own\nVersion: 1.0\n", "utf-8")
    (info / "entry_points.txt").write_text("[truebreak.engines]\nown = ownengines:Mine\nlost = none:X\n", "utf-8")
    monkeypatch.syspath_prepend(str(folder))
    chosen: Any = engine("own:wrong=yes")
    assert (chosen.name, chosen.wrong) == ("own", True)
    with pytest.raises(SceneError, match="engine 'lost', offered as none:X: ModuleNotFoundError"):
        engine("lost")
