"""Causes at segments: margins known by construction, accounts that close, and the number that decides."""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import Any

import pytest
from segment_faults import SegmentFault
from segment_scenes import scene_of

from truebreak.compare import compare
from truebreak.compare.causes import other_settings
from truebreak.compare.causes.decision import DecidingNumber, Pairing, RunReader
from truebreak.compare.causes.other_settings import exact_zero
from truebreak.compare.study import Study
from truebreak.exact import ExactEngine
from truebreak.exact.numbers import ball
from truebreak.scenarios import Arc, Circle, Pocket, Quantity, Scene, Segment, Wall
from truebreak.scenarios.engine import Engine
from truebreak.scenarios.trajectory import Trajectory

SMALL = Quantity.of(Fraction(1, 2**60))


def beside_an_end(off: Quantity, thick: str, *, left: bool, up: bool) -> Scene:
    """A disc that flies along the y axis, `off` less than touching an end of a segment deep."""
    half = Quantity.of(thick)
    x, side = (-1 - half + off, -1) if left else (3 + half - off, 1)
    bar = (2, 0, 0, 0) if up else (0, 0, 2, 0)
    disc = Circle(x, -5 if up else 5, vy=1 if up else -1, id="disc")
    return Scene([disc, Circle(9 * side, 30, id="far")], segments=[Segment(*bar, id="bar", r=thick)])


@pytest.mark.parametrize("left", [False, True])
@pytest.mark.parametrize("up", [False, True])
@pytest.mark.parametrize("thick", ["0", "1/2"])
def test_an_end_hit_by_less_than_rounding_is_lost_by_the_input(left: bool, up: bool, thick: str) -> None:
    found = compare(beside_an_end(SMALL, thick, left=left, up=up), ["double"], until=9)["double"]
    assert found.diagnosis is not None
    assert found.margin is not None
    assert [cause.name for cause in found.diagnosis.causes] == ["INPUT"]
    assert found.margin.distance == pytest.approx((-(2.0**-60), -(2.0**-60)), rel=1e-12)
    (row,) = [e for e in found.diagnosis.experiments if e.cause.name == "INPUT"]
    assert row.displacement == pytest.approx(2.0**-60, rel=1e-12)
    assert row.suffices is True


def test_an_end_missed_by_little_has_that_margin() -> None:
    scene = beside_an_end(-SMALL, "0", left=False, up=False)
    run = ExactEngine().run(scene, until=9)
    assert not run.events
    value = RunReader(run).value(DecidingNumber("hit", Pairing("disc", "bar", {"disc": None})))
    assert value is not None
    assert float(value) == pytest.approx(2.0**-60, rel=1e-12)


@pytest.mark.parametrize("seed", range(40))
def test_moved_aside_by_the_margin_a_disc_hits_or_misses(seed: int) -> None:
    """The number that decides is where the answer changes: moved by less it stays, by a little more it turns."""
    rng = Random(seed)
    at = lambda: Quantity.of(Fraction(rng.randint(-4000, 4000), 1000))  # noqa: E731
    bar = Segment(at(), at(), at(), at(), id="bar", r=rng.choice(("0", "1/3")))
    x, y = Quantity.of(rng.choice((-9, 9))), at()
    vx, vy = -x / 4, at() - y
    size = (vx * vx + vy * vy).sqrt()

    def scene(aside: Quantity) -> Scene:
        disc = Circle(x - aside * vy / size, y + aside * vx / size, r="3/4", vx=vx, vy=vy, id="disc")
        return Scene([disc], segments=[bar])

    run = ExactEngine().run(scene(Quantity.of(0)), until=50)
    hit = bool(run.events)
    value = RunReader(run).value(DecidingNumber("hit", Pairing("disc", "bar", {"disc": None})))
    assert value is not None
    assert (ball.sign_of(value) == -1) is hit
    shares = (Fraction(10**9 + sign, 10**9) for sign in (-1, 1))
    moved = [Quantity.of(share * Fraction(float(value))) for share in shares]
    hits = [[bool(ExactEngine().run(scene(sign * by), until=50).events) for sign in (-1, 1)] for by in moved]
    assert hits[0] == [hit, hit]
    assert sorted(hits[1]) == [False, True]


def test_accounts_close_among_segments() -> None:
    closed = diverged = 0
    for seed in range(40):
        scene = scene_of(seed)
        if scene is None:
            continue
        for found in compare(scene, ["rounded:bits=20", "rounded:bits=12"], until=200, events=60).candidates:
            if found.diagnosis is None or found.verdict != "diverged":
                continue
            diverged += 1
            assert found.laws is not None
            assert found.laws.kept is True
            known = [e.displacement for e in found.diagnosis.experiments if e.displacement is not None]
            if found.diagnosis.displacement is not None:
                closed += 1
                assert sum(known) == pytest.approx(found.diagnosis.displacement, rel=1e-6)
    assert diverged > 15
    assert closed > 0.9 * diverged


@pytest.mark.parametrize("fault", ["no ends", "no thickness", "the range on the wrong side"])
def test_a_planted_fault_outranks_rounding(fault: str) -> None:
    seen = 0
    for seed in range(40):
        scene = scene_of(seed)
        if scene is None or any(c.point for c in scene.circles):
            continue
        (found,) = compare(scene, [SegmentFault(fault=fault)], until=20, events=20).candidates
        if found.verdict == "diverged":
            seen += 1
            assert found.diagnosis is not None
            assert [cause.name for cause in found.diagnosis.causes] == ["LAW"], (seed, found.diagnosis)
    assert seen > 3


def test_where_intervals_stop_is_named() -> None:
    bar = [Segment(0, 0, 2, 0, id="bar")]
    corner = Scene([Circle("2", "1/3 + 5", r="1/3", vy=-1, id="disc")], segments=bar)
    run = ExactEngine().run(corner, until=9)
    assert exact_zero(run, 0) == "disc meets bar where a face becomes an end"
    graze = Scene([Circle(3, 5, vy=-1, id="disc")], segments=bar)
    assert exact_zero(ExactEngine().run(graze, until=9), 0) == "disc grazes an end of bar"


FALL: dict[str, Any] = {"gravity": (0, -8), "events": 3}
BELOW = [Wall(0, -9, 1, -9, id="below")]
TIES = {
    "disc grazes the rim of hole": Scene(
        [Circle(0, 5, "1/2", id="disc")], BELOW, pockets=[Pocket(1, 0, 1, id="hole")], **FALL
    ),
    "disc grazes an end of bar": Scene(
        [Circle("-5/2", 2, "1/2", id="disc")], BELOW, segments=[Segment(-2, 0, 2, 0, id="bar")], **FALL
    ),
    "disc meets bar where a face becomes an end": Scene(
        [Circle("1/3", 5, "1/2", vx="2/3", id="disc")],
        BELOW,
        segments=[Segment("4/3", "-9/2", 7, "-9/2", id="bar")],
        **FALL,
    ),
    "disc and bar touch and do not approach": Scene(
        [Circle("-5/2", 0, "1/2", vy=1, id="disc")], BELOW, segments=[Segment(-2, 0, 2, 0, id="bar")], **FALL
    ),
    "disc grazes ring": Scene(
        [Circle("-5/2", 2, "1/2", id="disc")], BELOW, arcs=[Arc(0, 0, 2, full=True, id="ring")], **FALL
    ),
    "disc grazes peg": Scene([Circle("-5/2", 2, "1/2", id="disc"), Circle(-1, 0, fixed=True, id="peg")], BELOW, **FALL),
}


def widths_tried(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The bits of all runs of intervals from now on, beside a study's own."""
    tried: list[int] = []
    whole_run = Study.whole_run

    def noted(self: Study, engine: Engine, *args: Any) -> Trajectory:
        tried.append(engine.bits or 0)
        return whole_run(self, engine, *args)

    monkeypatch.setattr(Study, "whole_run", noted)
    return tried


@pytest.mark.parametrize("told", TIES)
def test_no_width_is_raised_where_a_zero_is_proved_under_gravity(told: str, monkeypatch: pytest.MonkeyPatch) -> None:
    tried = widths_tried(monkeypatch)
    found = compare(TIES[told], ["interval"]).candidates[0].diagnosis
    assert found is not None
    assert [cause.name for cause in found.causes] == ["ZERO"]
    assert told in found.finding
    assert tried == [106, 848]


def test_what_is_beyond_the_next_event_is_no_zero_that_leads_to_it() -> None:
    scene = TIES["disc grazes the rim of hole"]
    above = scene.with_changes(walls=[Wall(0, 3, 1, 3, id="above")])
    run = ExactEngine().run(above)
    assert float(run.events[0].time) < 1
    assert exact_zero(run, 0) is None


def test_widths_are_raised_by_counted_work_and_what_is_left_out_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(other_settings, "exact_zero", lambda *_: None)
    tried = widths_tried(monkeypatch)
    found = compare(TIES["disc grazes an end of bar"], ["interval"]).candidates[0].diagnosis
    assert found is not None
    assert tried[-1] == 13568
    assert "with 13568 bits it stops there too; more were not tried: the work that may be done" in found.finding


def test_the_bits_that_lead_to_the_end_are_not_looked_for_past_a_tie(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = widths_tried(monkeypatch)
    high, bar = Segment(-3, 5, -1, 5, id="high"), Segment(0, 0, 3, 0, id="bar")
    early, late = Circle("-7/2 - 10**-30", 9, "1/2", id="misses"), Circle("7/2", 20, "1/2", id="grazes")
    scene = TIES["disc grazes an end of bar"].with_changes(circles=[early, late], segments=[high], events=None, until=4)
    (found,) = compare(scene, ["interval"], bits=True).candidates
    assert found.diagnosis is not None
    assert "with 212 it comes to the end, with 106 it does not" in found.diagnosis.finding
    tried.clear()
    (found,) = compare(scene.with_changes(segments=[high, bar]), ["interval"], bits=True).candidates
    assert found.diagnosis is not None
    told = "with 424 it does not come to the end; at event 1 it stops however wide: grazes grazes an end of bar"
    assert told in found.diagnosis.finding
    assert max(tried) == 424
