"""A log whose engine breaks a law is seen to, whatever its history; one that keeps it is not."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from command_line import said
from lawless import Events
from logs import lines_of, written

from truebreak.compare import compare
from truebreak.compare.audit.audit import audit_run
from truebreak.compare.foreign import LogEngine
from truebreak.compare.report.schema import schema
from truebreak.compare.saved_comparisons import comparison_of, saved_comparison
from truebreak.scenarios import catalogue

SCENES = ("gas:seed=3", "gas:n=3", "sizes", "tennis")


def log_of(engine: Events, name: str, events: int, path: Path, *, states: bool = True) -> str:
    run = engine.run(catalogue.build(name), events=events + 5)
    return written(path, lines_of(run, states=states))


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("limits", [{"events": 7}, {"until": 35}])
def test_what_keeps_the_laws_is_said_to_wherever_it_ends(name: str, limits: dict[str, int]) -> None:
    engine = Events()
    run = engine.run(catalogue.build(name), **limits)
    found = audit_run(run, engine)
    assert found.kept, found.sentence
    assert found.impacts == sum(len(event.impulses) for event in run.events) > 0


@pytest.mark.parametrize("restitution", [0.98, 0.999])
@pytest.mark.parametrize("name", SCENES)
def test_a_log_of_another_restitution_exits_with_1(
    name: str, restitution: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = log_of(Events(restitution), name, 3, tmp_path / "log.jsonl")
    code, out, _ = said(capsys, "judge", name, path, "--events", "3", "--json")
    data = json.loads(out)
    jsonschema.Draft202012Validator(schema("comparison-5")).validate(data)
    assert (code, data["verdict"]) == (1, "agree")
    (laws,) = [candidate["laws"] for candidate in data["candidates"]]
    assert laws["kept"] is False
    assert laws["fit"]["kind"] == "restitution"
    assert laws["fit"]["value"] == pytest.approx(restitution, rel=1e-9)
    assert laws["fit"]["explained"] == laws["fit"]["of"] == laws["impacts"]
    assert laws["first"] == laws["violations"][0]
    assert laws["first"]["size"] > laws["first"]["bound"] > 0
    right = log_of(Events(), name, 3, tmp_path / "right.jsonl")
    assert said(capsys, "judge", name, right, "--events", "3")[0] == 0


def test_a_log_of_masses_taken_for_equal_exits_with_1(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = log_of(Events(equal=True), "sizes", 5, tmp_path / "log.jsonl")
    code, out, _ = said(capsys, "judge", "sizes", path, "--events", "5", "--json")
    (laws,) = [candidate["laws"] for candidate in json.loads(out)["candidates"]]
    assert (code, laws["kept"], laws["fit"]["kind"]) == (1, False, "mass")


def test_without_states_nothing_is_said_of_the_law(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = log_of(Events(0.999), "gas:n=3", 3, tmp_path / "log.jsonl", states=False)
    code, out, _ = said(capsys, "judge", "gas:n=3", path, "--events", "3", "--json")
    (laws,) = [candidate["laws"] for candidate in json.loads(out)["candidates"]]
    assert (code, laws["kept"], laws["fit"], laws["first"]) == (0, None, None, None)
    assert "no states" in laws["reason"]


@pytest.mark.parametrize("turned", [False, True])
def test_a_change_of_the_law_is_told(turned: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old = log_of(Events(), "gas:n=3", 3, tmp_path / "old.jsonl")
    new = log_of(Events(0.999), "gas:n=3", 3, tmp_path / "new.jsonl")
    logs = (new, old) if turned else (old, new)
    code, out, _ = said(capsys, "judge", "gas:n=3", *logs, "--events", "3", "--json")
    data = json.loads(out)
    jsonschema.Draft202012Validator(schema("comparison-5")).validate(data)
    (change,) = data["changes"]
    assert (code, change["laws_changed"], change["verdict_changed"]) == (1, True, False)
    assert f"{new} does not keep the law: restitution 0.999 fits 3 of 3 impacts" in change["sentence"]
    assert f"{old} keeps the law in all of its 3 impacts" in change["sentence"]
    (same,) = json.loads(said(capsys, "judge", "gas:n=3", old, old, "--events", "3", "--json")[1])["changes"]
    assert not same["laws_changed"]


@pytest.mark.parametrize("engine", [Events(0.98), Events(equal=True), Events(states=False), Events()])
def test_an_audit_is_saved_and_had_again(engine: Events, tmp_path: Path) -> None:
    path = log_of(engine, "sizes", 4, tmp_path / "log.jsonl", states=engine.states)
    scene = catalogue.build("sizes")
    found = compare(scene, [LogEngine.of(path, scene), "pymunk:dt=1/64"], events=4, causes=False)
    again: Any = comparison_of(saved_comparison(found))
    assert [c.laws for c in again.candidates] == [c.laws for c in found.candidates]
    assert found.candidates[1].laws is not None
    assert found.candidates[1].laws.defects
