"""Causes in scenes in which walls carry what comes to rest: by runs and the audit, with no displacement over them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from other_runs import rounded_scene
from refuting import ARITHMETIC, FLIGHTS, INPUT, Said, refute, settled

from truebreak.compare import compare, engine
from truebreak.compare.candidate import Candidate
from truebreak.compare.causes.other_settings import exact_zero
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine, plain
from truebreak.scenarios import Circle, Scene, Wall

FLOOR = Wall(0, 0, 1, 0, id="floor")


def parted(seed: int, name: str, **more: Any) -> Candidate:
    found = compare(settled(seed), [name], events=40, **more).candidates[0]
    assert found.verdict == "diverged"
    assert found.diagnosis is not None
    return found


def names(found: Candidate) -> list[str]:
    assert found.diagnosis is not None
    return [cause.value for cause in found.diagnosis.causes]


@pytest.mark.parametrize(("seed", "name"), [(21, "single"), (9, "rounded:bits=16"), (50, "rounded:bits=12")])
def test_rounding_of_its_own_is_named_where_the_input_alone_changes_nothing(seed: int, name: str) -> None:
    found = parted(seed, name)
    diagnosis = found.diagnosis
    assert diagnosis is not None
    assert names(found) == ["arithmetic rounding"]
    assert {row.cause.name: row.suffices for row in diagnosis.experiments}["INPUT"] is False
    assert diagnosis.displacement is None
    assert not diagnosis.shares
    assert "keeps the law, and input rounding by itself changes nothing, so its own rounding does" in diagnosis.finding
    assert "no displacement is known: a wall " in diagnosis.finding
    assert not refute(settled(seed), engine(name), found)


def test_input_rounding_is_named_by_a_run() -> None:
    found = parted(47, "rounded:bits=12")
    assert names(found) == ["input rounding"]
    assert found.diagnosis is not None
    assert "the exact law on the scene in numbers of 12 bits decides as rounded:bits=12 does" in found.diagnosis.finding
    assert not refute(settled(47), engine("rounded:bits=12"), found)


def test_false_causes_are_refuted() -> None:
    """That the input suffices where the run of it passes; that arithmetic does where the input alone does the same."""
    by_rounding, by_input = parted(21, "single"), parted(47, "rounded:bits=12")
    for found, seed, name, claim in (
        (by_rounding, 21, "single", INPUT),
        (by_input, 47, "rounded:bits=12", ARITHMETIC),
        (by_rounding, 21, "single", FLIGHTS),
    ):
        said = Said((claim,), frozenset({claim}), closed=False)
        assert refute(settled(seed), engine(name), found, said), (claim, name)
    assert by_rounding.laws is not None
    unknown = replace(by_rounding, laws=replace(by_rounding.laws, kept=None))
    said = Said((ARITHMETIC,), frozenset({ARITHMETIC}), closed=False)
    assert refute(settled(21), engine("single"), unknown, said)


def test_nothing_is_named_where_no_audit_says_that_the_law_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    from truebreak.compare import comparison

    monkeypatch.setattr(comparison, "_audited", lambda *_: None)
    assert names(parted(21, "single")) == ["not determined"]


def test_nothing_is_named_where_the_rounded_scene_takes_a_third_way() -> None:
    found = parted(21, "rounded:bits=16")
    assert names(found) == ["not determined"]
    assert found.diagnosis is not None
    assert "a wall" in found.diagnosis.finding


def test_input_that_is_exact_is_not_rounded() -> None:
    """One slides to another at rest in numbers of few bits: what that one rounds is of its arithmetic alone."""
    found = compare(rounded_scene(settled(21), 24), ["single"], events=40).candidates[0]
    assert found.verdict == "diverged"
    assert names(found) == ["arithmetic rounding"]
    assert found.diagnosis is not None
    rows = {row.cause.name: row.result for row in found.diagnosis.experiments}
    assert rows["INPUT"] == "the scene is exact in numbers of 24 bits, so no input was rounded"


@pytest.mark.parametrize(("name", "cause"), [("double", "not determined"), ("single", "input rounding")])
def test_an_instant_of_what_is_carried_is_not_run_again_as_if_it_fell(name: str, cause: str) -> None:
    """Two slide onto one at rest from both sides at once; rounding has one of them come first."""
    discs = [
        Circle(0, 1, id="sits"), Circle("-7/3", 1, vx="1/3", id="left"), Circle("21/10", 1, vx="-1/10", id="right"),
    ]  # fmt: skip
    scene = Scene(discs, [FLOOR], gravity=(0, -1), settle=True)
    found = compare(scene, [name], until=40).candidates[0]
    assert found.verdict == "diverged"
    assert names(found) == [cause]
    assert not refute(scene, engine(name), found)


def test_no_margin_is_read_off_flights_that_do_not_fall() -> None:
    found = parted(50, "rounded:bits=12")
    assert found.diagnosis is not None
    assert "a wall has carried one of those that meet" in found.diagnosis.finding
    assert found.margin is not None
    assert found.margin.distance is None
    assert found.margin.gap is None


@pytest.mark.parametrize("factor", [0.0, 0.5])
def test_a_law_that_is_broken_by_what_is_carried_outranks_all(factor: float, monkeypatch: pytest.MonkeyPatch) -> None:
    class Braked(plain.PlainState[Any]):
        def settle(self, index: int, wall: int, slides: bool, bounces: bool, other: int = -1) -> None:
            super().settle(index, wall, slides, bounces, other)
            flight = self.bodies[index].flight
            self.bodies[index].flight = flight._replace(vx=flight.vx * factor)

    discs = [Circle(0, 3, vx=1, id="a"), Circle(9, 1, id="b"), Circle(9, 80, id="c")]
    scene = Scene(discs, [FLOOR], gravity=(0, -2), restitution=0, settle=True)
    assert compare(scene, [DoubleEngine()], until=20).candidates[0].verdict == "agree"
    monkeypatch.setattr(plain, "PlainState", Braked)
    found = compare(scene, [DoubleEngine()], until=20).candidates[0]
    assert found.verdict == "diverged"
    assert names(found) == ["law not kept"]
    assert found.laws is not None
    assert found.laws.kept is False


def test_what_has_nothing_to_do_with_what_is_carried_has_an_account() -> None:
    """A disc lies far away, while another meets one that falls beside it by a hair, which rounding takes away."""
    far, ball = Circle(90, 1, id="far"), Circle(0, 40, vx=1, id="ball")
    scene = Scene([far, ball, Circle(10, "42 - 1/10**9", id="other")], [FLOOR], gravity=(0, "-1/4"), settle=True)
    found = compare(scene, ["single"], until=12).candidates[0]
    assert found.verdict == "diverged"
    assert names(found) == ["input rounding"]
    assert found.diagnosis is not None
    assert found.diagnosis.displacement == pytest.approx(1e-9, rel=1e-3)
    assert found.margin is not None
    assert found.margin.distance is not None


def test_no_zero_is_proved_of_what_is_carried_as_if_it_fell() -> None:
    """In the frame that falls the one would graze the other, which does not fall."""
    discs = [Circle(5, 1, id="sits"), Circle(0, 3, vx=1, id="falls")]
    scene = Scene(discs, [FLOOR], gravity=(0, -1), settle=True)
    run = ExactEngine().run(scene, until=3)
    assert [s.circle for s in run.settlings] == ["sits"]
    assert exact_zero(run, 0) is None


def test_runs_that_stop_say_why() -> None:
    found = compare(settled(1), ["interval"], events=30).candidates[0]
    assert found.verdict == "undecided"
    assert found.diagnosis is not None
    assert names(found) != ["not determined"], found.diagnosis
