"""Causes at polygons: the number that decides, margins known by construction, and accounts that close."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest
from polygon_faults import PolygonFault
from polygon_scenes import scene_of

from truebreak.compare import compare
from truebreak.compare.causes.decision import DecidingNumber, Pairing, RunReader
from truebreak.compare.causes.given_scene import rounded
from truebreak.exact import ExactEngine
from truebreak.exact.numbers import ball
from truebreak.scenarios import Circle, Polygon, Quantity, Scene, SceneError

SMALL = Quantity.of(Fraction(1, 2**60))
HIT = DecidingNumber("hit", Pairing("disc", "g", {"disc": None}))
HOOK = [(0, 0), (6, 0), (6, 6), (0, 6), (0, 4), (4, 4), (4, 2), (0, 2)]  # open to the left, a notch two wide


@pytest.mark.parametrize("r", ["0", "1/2"])
@pytest.mark.parametrize("hollow", [False, True])
def test_a_corner_hit_by_less_than_rounding_is_lost_by_the_input(r: str, hollow: bool) -> None:
    points = [(0, 0), (4, 0), (4, 4), (0, 4)] if not hollow else HOOK
    disc = Circle(-1 - Quantity.of(r) + SMALL, -5, vy=1, id="disc")
    scene = Scene([disc, Circle(30, 30, id="far")], polygons=[Polygon(points, "g", r)])
    found = compare(scene, ["double"], until=20)["double"]
    assert found.diagnosis is not None
    assert found.margin is not None
    assert [cause.name for cause in found.diagnosis.causes] == ["INPUT"]
    assert found.margin.distance == pytest.approx((-(2.0**-60), -(2.0**-60)), rel=1e-12)


def test_what_leaves_a_notch_meets_nothing_of_what_it_covers() -> None:
    """Its nearest part recedes, and another may be approached: only the flight itself says what comes."""

    def aside(x: str, y: str, vx: str, vy: str) -> float | None:
        scene = Scene([Circle(x, y, r="1/2", vx=vx, vy=vy, id="disc")], polygons=[Polygon(HOOK, "g")])
        run, value = ExactEngine().run(scene, until=90), RunReader(ExactEngine().run(scene, until=90)).value(HIT)
        assert value is not None
        assert (ball.sign_of(value) == -1) is bool(run.events)
        return float(value)

    assert aside("2", "3", "-1", "0") == pytest.approx(0.5)  # out of the notch, between its jaws
    assert aside("-9", "3", "1", "0") == pytest.approx(-3.5)  # in: it passes beside all of it
    assert aside("2", "5/2", "-1", "1/9") > 0  # away from what it touches, and out
    assert aside("3", "5/2", "-1", "1") < 0  # away from what it touches, at the other jaw


@pytest.mark.parametrize("seed", range(40))
def test_moved_aside_by_the_margin_a_disc_hits_or_misses(seed: int) -> None:
    """The number that decides is where the answer changes: moved by less it stays, by a little more it turns."""
    rng = Random(seed)
    at = lambda low, high: Quantity.of(Fraction(rng.randint(1000 * low, 1000 * high), 1000))  # noqa: E731
    points: list = HOOK
    if seed % 3:
        while True:
            points = [(at(-4, 4), at(-4, 4)) for _ in range(rng.randint(3, 6))]
            try:
                Polygon(points)
            except SceneError:
                continue
            break
    solid = Polygon(points, "g", rng.choice(("0", "1/3")))
    x, y = Quantity.of(rng.choice((-9, 13))), at(-5, 8)
    vx, vy = (2 - x) / 4, at(-4, 6) - y
    size = (vx * vx + vy * vy).sqrt()

    def scene(aside: Quantity) -> Scene:
        disc = Circle(x - aside * vy / size, y + aside * vx / size, r="3/4", vx=vx, vy=vy, id="disc")
        return Scene([disc], polygons=[solid])

    run = ExactEngine().run(scene(Quantity.of(0)), until=50, events=1)
    hit = bool(run.events)
    value = RunReader(run).value(HIT)
    assert value is not None
    assert (ball.sign_of(value) == -1) is hit
    shares = (Fraction(10**9 + sign, 10**9) for sign in (-1, 1))
    moved = [Quantity.of(share * Fraction(float(value))) for share in shares]
    hits = [[bool(ExactEngine().run(scene(sign * by), until=50, events=1).events) for sign in (-1, 1)] for by in moved]
    assert hits[0] == [hit, hit]
    assert sorted(hits[1]) == [False, True]


def test_accounts_close_among_polygons() -> None:
    closed = diverged = 0
    for seed in range(30):
        scene = scene_of(seed)
        if scene is None:
            continue
        for found in compare(scene, ["rounded:bits=20", "rounded:bits=12"], until=200, events=30).candidates:
            if found.diagnosis is None or found.verdict != "diverged":
                continue
            diverged += 1
            assert found.laws is not None
            assert found.laws.kept is True
            known = [e.displacement for e in found.diagnosis.experiments if e.displacement is not None]
            if found.diagnosis.displacement is not None:
                closed += 1
                assert sum(known) == pytest.approx(found.diagnosis.displacement, rel=1e-6)
    assert diverged > 10
    assert closed > 0.75 * diverged


@pytest.mark.parametrize("fault", ["no corners", "no thickness", "a side lost", "inside out"])
def test_a_planted_fault_outranks_rounding(fault: str) -> None:
    seen = 0
    for seed in range(40):
        scene = scene_of(seed)
        if scene is None or any(c.point for c in scene.circles) or len(scene.polygons) > 1:
            continue  # of two with a common side the one or the other is met within rounding of their corner
        (found,) = compare(scene, [PolygonFault(fault=fault)], until=20, events=20).candidates
        if found.verdict == "diverged":
            seen += 1
            assert found.diagnosis is not None
            assert [cause.name for cause in found.diagnosis.causes] == ["LAW"], (seed, found.diagnosis)
    assert seen > 1


def test_a_scene_is_rounded_with_its_polygons() -> None:
    scene = Scene([Circle(0, -9)], polygons=[Polygon([(0, 0), ("1/3", 0), (0, "1/3")], "g", "1/3")])
    given = rounded(scene, 2)
    assert [point.text() for point in given.polygons[0].points[1]] == ["3/8", "0"]
    assert given.polygons[0].r.text() == "3/8"


@pytest.mark.parametrize("x", ["2", "9/4"])
def test_a_joint_of_two_polygons_is_one_end_whatever_it_is_called(x: str) -> None:
    """Pymunk names the second of the two; with the first one's name its history is the exact one. Beside the joint
    there is nothing of the kind."""
    boxes = [Polygon([(0, 0), (2, 0), (2, 2), (0, 2)], id="a"), Polygon([(2, 0), (4, 0), (4, 2), (2, 2)], id="b")]
    discs = [Circle(x, 6, vy=-1, id="c"), Circle(x, 9, vy=-1, id="d")]
    found = compare(Scene(discs, polygons=boxes, until=12), ["pymunk:dt=1/256"])["pymunk:dt=1/256"]
    if x != "2":
        assert found.verdict == "agree"
        return
    assert found.diagnosis is not None
    assert [cause.name for cause in found.diagnosis.causes] == ["TIE"]
    assert "a and b share the point that c meets: one end" in found.diagnosis.finding
