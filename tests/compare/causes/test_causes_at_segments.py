"""Causes at segments: margins known by construction, accounts that close, and the number that decides."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest
from segment_faults import SegmentFault
from segment_scenes import scene_of

from truebreak.compare import compare
from truebreak.compare.causes.decision import DecidingNumber, Pairing, RunReader
from truebreak.compare.causes.other_settings import exact_zero
from truebreak.exact import ExactEngine
from truebreak.exact.numbers import ball
from truebreak.scenarios import Circle, Quantity, Scene, Segment

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
