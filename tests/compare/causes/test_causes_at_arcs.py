"""Causes at arcs: margins known by construction, accounts that close, and the number that decides."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest
from arc_faults import ArcFault
from arc_scenes import scene_of

from truebreak.compare import compare
from truebreak.compare.causes.decision import DecidingNumber, Pairing, RunReader
from truebreak.compare.causes.other_settings import exact_zero
from truebreak.exact import ExactEngine
from truebreak.exact.numbers import ball
from truebreak.scenarios import Arc, Circle, Quantity, Scene, SceneError, catalogue

HIT = DecidingNumber("hit", Pairing("disc", "bow", {"disc": None}))


def test_the_stadium_says_why() -> None:
    found = compare(catalogue.build("stadium"), ["double"])["double"]
    assert found.verdict == "diverged"
    assert found.laws is not None
    assert found.laws.kept is True
    assert found.diagnosis is not None
    assert found.diagnosis.causes[0].name in ("INPUT", "FLIGHTS", "IMPACTS", "ARITHMETIC")
    assert found.diagnosis.displacement is not None
    known = [e.displacement for e in found.diagnosis.experiments if e.displacement is not None]
    assert sum(known) == pytest.approx(found.diagnosis.displacement, rel=1e-6)


def test_the_outside_grazed_by_less_than_rounding_is_lost_by_the_input() -> None:
    small = Quantity.of(Fraction(1, 2**60))
    disc = Circle(3 - small, -5, vy=1, id="disc")
    scene = Scene([disc, Circle(9, 30, id="far")], arcs=[Arc(0, 0, 2, 0, -2, 0, 2, id="bow")])
    found = compare(scene, ["double"], until=9)["double"]
    assert found.diagnosis is not None
    assert found.margin is not None
    assert [cause.name for cause in found.diagnosis.causes] == ["INPUT"]
    assert found.margin.distance == pytest.approx((-(2.0**-60), -(2.0**-60)), rel=1e-12)


@pytest.mark.parametrize("seed", range(60))
def test_moved_aside_by_the_margin_a_disc_hits_or_misses(seed: int) -> None:
    """The number that decides is where the answer changes: moved by less it stays, by a little more it turns."""
    rng = Random(seed)
    turns = ((1, 0), (3, 4), (-4, 3), (0, -1), (-5, 12), (12, -5), (-1, 0), (0, 1))
    (ax, ay), (bx, by) = rng.sample(turns, 2)
    r, within = rng.choice((2, 3)), rng.random() < 0.5
    bow = Arc(0, 0, r, ax, ay, bx, by, id="bow")
    at = lambda most: Quantity.of(Fraction(rng.randint(-1000 * most, 1000 * most), 1000))  # noqa: E731
    if within:
        x, y, vx, vy = at(1), at(1), at(2), at(2) + Fraction(1, 7777)
    else:
        x, y = Quantity.of(rng.choice((-9, 9))), at(3)
        vx, vy = -x / 4, at(3) - y
    size = (vx * vx + vy * vy).sqrt()

    def scene(aside: Quantity) -> Scene:
        disc = Circle(x - aside * vy / size, y + aside * vx / size, r="1/4", vx=vx, vy=vy, id="disc")
        return Scene([disc], arcs=[bow])

    run = ExactEngine().run(scene(Quantity.of(0)), until=50, events=1)
    hit = bool(run.events)
    value = RunReader(run).value(HIT)
    assert value is not None
    assert (ball.sign_of(value) == -1) is hit
    shares = (Fraction(10**9 + sign, 10**9) for sign in (-1, 1))
    moved = [Quantity.of(share * Fraction(float(value))) for share in shares]
    if within and abs(float(value)) > 0.7:  # so far aside it would begin somewhere else
        return
    hits = [[bool(ExactEngine().run(scene(sign * by), until=50, events=1).events) for sign in (-1, 1)] for by in moved]
    assert hits[0] == [hit, hit]
    assert sorted(hits[1]) == [False, True]


def test_accounts_close_among_arcs() -> None:
    closed = diverged = 0
    for seed in range(40):
        scene = scene_of(seed)
        if scene is None or not scene.elastic:
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
    assert closed > 0.85 * diverged


@pytest.mark.parametrize("fault", ["no ends", "the rest of the circle", "too wide within", "no range"])
def test_a_planted_fault_outranks_rounding(fault: str) -> None:
    seen = 0
    for seed in range(50):
        scene = scene_of(seed)
        if scene is None or not scene.elastic or any(c.point for c in scene.circles):
            continue
        try:
            (found,) = compare(scene, [ArcFault(fault=fault)], until=20, events=20).candidates
        except SceneError:  # a circle lies across the rest of the circle
            continue
        if found.verdict == "diverged" and found.alignment.divergence is not None:
            if found.alignment.divergence.kind.name == "TIE":  # an exact tie, which comes before the fault
                continue
            seen += 1
            assert found.diagnosis is not None
            assert [cause.name for cause in found.diagnosis.causes] == ["LAW"], (seed, found.diagnosis)
    assert seen > 3


def test_where_intervals_stop_is_named() -> None:
    def zero(scene: Scene) -> str | None:
        return exact_zero(ExactEngine().run(scene, until=9), 0)

    half = Arc(0, 0, 2, 0, -2, 0, 2, id="bow")
    assert zero(Scene([Circle("9/4", -5, r="1/4", vy=1, id="disc")], arcs=[half])) == "disc grazes bow"
    east = Arc(0, 0, 2, 1, -1, 1, 1, id="bow")
    assert (
        zero(Scene([Circle("7/4", -5, r="1/4", vy=1, id="disc")], arcs=[east]))
        == "disc touches bow from within, along it"
    )
    joint = Scene([Circle(0, -1, r="1/4", vy=1, id="disc")], arcs=[half])
    assert zero(joint) == "disc meets bow where it ends"
