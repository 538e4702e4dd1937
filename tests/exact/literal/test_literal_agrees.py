"""The literal SymPy engine and the exact engine share no formula, number or decision, and tell one history."""

from __future__ import annotations

from typing import Any

import pytest
from flint import arb

from truebreak.exact import ExactEngine, SymbolicEngine
from truebreak.scenarios import Circle, Quantity, Scene, StopReason, Trajectory, Wall, catalogue

AGREED_BITS = 900
"""Bits to which numbers agree that are too deep to be written out; they are asked for to 100 more."""

POLICIES = ("simultaneous", "sequential:order=scene", "sequential:seed=1", "sequential:seed=2")

TIED = {
    "lee": 10,
    "cradle:gap=0": 8,
    "cradle:gap=0,r=3/10,n=3": 10,
    "sizes": 12,
    "sizes:n=4,ratio=7/2": 10,
    "corner:angle=90": 8,
    "corner:angle=72": 6,
    "corner:angle=60": 12,
    "corner:angle=45": 6,
    "corner:angle=36": 6,
    "corner:angle=60,skew=1/3": 6,
    "rack:rows=2": 6,
    "inscribed:n=3,spin=0": 8,
    "inscribed:n=4": 5,
    "magic-masses": 3,
    "magic-masses:a=1/2": 3,
    "beads:e=1/5": 1,
    "beads:n=3,e=1/2": 1,
    "cradle:gap=0,e=1/2,n=3": 5,
}
"""Scenes in which several contacts fall on one instant, and how many instants are compared."""

SINGLE = {
    **{f"article:figure={figure}": 5 for figure in ("approach", "apart", "head-on", "diagonal", "giant")},
    "article:figure=floor": 5,
    "article:figure=slope": 5,
    "cradle": 20,
    "cradle:e=9/10": 12,
    "cooling:n=3": 2,
    "bounce": 5,
    "drop-pair": 4,
    "falling-line:n=2": 4,
    "wedge": 4,
    "gas-under-gravity:n=2": 3,
    "closing-wall": 6,
    "piston:n=2": 3,
    "collapse": 5,
    "stadium": 2,
    "mushroom": 3,
    "lemon": 2,
    "round-table:n=6": 4,
    "tennis": 20,
    "tennis:big=2": 20,
    "tennis:big=sqrt(5)": 10,
    "galperin:n=0": 10,
    "galperin": 40,
    "near-tie": 10,
    "near-tie:k=100,first=right": 10,
    "rack:rows=1": 20,
    "rack:rows=2,gap=1/100": 4,
    "rack:rows=2,jitter=1/1000": 2,
    "gas:n=1": 20,
    "gas:n=3": 3,
    "gas:n=2,mixed=yes": 3,
    "triangle:vy=1/3": 4,
    "barrier:vy=1/3": 4,
    "wind-tree:rows=1,vy=2/3": 4,
    "funnel:discs=2": 3,
    "breakout:columns=1,rows=1": 3,
    "ghost:segments=3": 1,
    "corner-hit": 1,
    "corner-hit:off=0": 1,
    "pinball": 20,
    "pinball:r=0": 20,
    "pinball:discs=3": 15,
    "pinball:offset=10**-30": 3,
    "lorentz:rows=2": 3,
    "lorentz:rows=2,r=0": 4,
    "point": 6,
    "grazing:angle=0": 10,
    "grazing:angle=45": 6,
    "grazing:miss=-10**-40": 4,
    "siam:t=1": 1,
    "hexagon:d=4": 1,
    "two-in-a-box": 2,
    "three-disc:seed=3": 2,
    "free-discs": 2,
    "cross": 2,
    "ramp": 4,
    "ski-jump": 4,
    "platforms": 1,
    "paddle": 4,
}
"""Scenes without such instants, or almost, under their own policy."""

DEEP = {
    "galperin": 160,
    "inscribed:n=3": 20,
    "inscribed:n=5": 2,
    "inscribed:n=6": 6,
    "inscribed:n=6,spin=0": 6,
    "inscribed:n=8": 4,
    "grazing:angle=72": 40,
    "rack:rows=2": 16,
    "rack:rows=3": 8,
    "rack:rows=4": 5,
    "corner:angle=72,skew=1/3": 40,
    "sizes:n=5,ratio=7/2": 40,
}
"""Scenes that take the literal engine seconds."""


def written(value: Any) -> Quantity | None:
    """An exact engine's number as a quantity; None if it is too deep."""
    if isinstance(value, Quantity):
        return value
    text = value.text()
    return None if text is None else Quantity.of(text)


def assert_equal(value: Any, literal: Any) -> None:
    """The numbers are equal: proved where the first can be written out, else to `AGREED_BITS` bits."""
    quantity = written(value)
    if quantity is not None:
        assert quantity == literal
    else:
        bits = AGREED_BITS + 100
        assert (value.ball(bits) - literal.ball(bits)).abs_upper() < arb(2) ** -AGREED_BITS


def assert_same_history(exact: Trajectory, literal: Trajectory) -> None:
    assert [e.contacts for e in exact.events] == [e.contacts for e in literal.events]
    assert [e.impulses for e in exact.events] == [e.impulses for e in literal.events]
    assert [e.coupled for e in exact.events] == [e.coupled for e in literal.events]
    assert exact.stop.reason is literal.stop.reason
    for mine, theirs in zip(exact.events, literal.events, strict=True):
        assert_equal(mine.time, theirs.time)
    for mine, theirs in zip(exact.final.circles, literal.final.circles, strict=True):
        for name in ("x", "y", "vx", "vy"):
            assert_equal(getattr(mine, name), getattr(theirs, name))


def check(scene: Scene, events: int) -> Trajectory:
    exact = ExactEngine().run(scene, events=events)
    assert exact.certified
    assert exact.stop.reason in (StopReason.EVENTS, StopReason.QUIET)
    assert_same_history(exact, SymbolicEngine().run(scene, events=events))
    return exact


@pytest.mark.parametrize("policy", POLICIES)
@pytest.mark.parametrize("spec", TIED)
def test_they_agree_on_ties_under_every_policy(spec: str, policy: str) -> None:
    run = check(catalogue.build(spec).with_changes(tie_policy=policy), TIED[spec])
    assert any(len(event.contacts) > 1 for event in run.events)


@pytest.mark.parametrize("spec", SINGLE)
def test_they_agree_on_the_catalogue(spec: str) -> None:
    check(catalogue.build(spec), SINGLE[spec])


@pytest.mark.slow
@pytest.mark.parametrize("policy", ["simultaneous", "sequential:order=scene", "sequential:seed=7"])
@pytest.mark.parametrize("spec", DEEP)
def test_they_agree_on_deeper_scenes(spec: str, policy: str) -> None:
    check(catalogue.build(spec).with_changes(tie_policy=policy), DEEP[spec])


@pytest.mark.parametrize("when", [{"reverse_after": 3}, {"reverse_at": 7}])
@pytest.mark.parametrize("spec", ["cradle:n=2", "corner:angle=90,skew=1/3", "pinball:discs=3"])
def test_they_agree_on_a_reversal(spec: str, when: dict[str, int]) -> None:
    run = check(catalogue.build(spec).with_changes(**when), 6)
    assert run.reversal is not None


def has_quartics(scene: Scene) -> bool:
    """Whether something round stands under gravity, where SymPy's engine may go no further."""
    return scene.gravity is not None and bool(scene.surfaces.pegs)


def test_every_scene_of_the_catalogue_is_compared() -> None:
    compared = {spec.partition(":")[0] for spec in (*TIED, *SINGLE)}
    others = {"reversal", "echo", "bumper"}  # a gas, reversed; balls that go out of play, which SymPy has not
    others |= {
        name for name in catalogue.names() if has_quartics(catalogue.build(name)) or catalogue.build(name).settle
    }
    assert compared | others == set(catalogue.names())


# -- points

POINT = {"r": 0, "point": True}


@pytest.mark.parametrize("engine", [ExactEngine(), SymbolicEngine()], ids=lambda engine: engine.name)
def test_two_points_never_collide(engine: Any) -> None:
    """Head on, at an angle, and at rest in each other's way: where they meet, no direction is defined."""
    circles = [
        Circle(0, 0, vx=1, **POINT),
        Circle(4, 0, vx=-1, **POINT),
        Circle(2, 2, vy=-1, **POINT),
        Circle(1, 0, m="oo", **POINT),
    ]
    run = engine.run(Scene(circles, [Wall(9, 0, 9, 1)]), until=10)
    assert [(float(e.time), e.contacts) for e in run.events] == [(9.0, (("c1", "w1"),))]


def test_they_agree_on_points_among_discs_and_walls() -> None:
    circles = [Circle(0, 0, vx=1, vy="1/3", **POINT), Circle(5, 2), Circle(3, 4, vy="-1/2", **POINT)]
    check(Scene(circles, [Wall(0, 5, 1, 5), Wall(9, 0, 9, 1), Wall(0, -2, 1, -2), Wall(-1, 0, -1, 1)]), 5)


FLOOR = Wall(0, 0, 1, 0, id="floor")

CLOSING = Wall(0, 0, 0, 1, id="left"), Wall(9, 0, 9, 1, id="right", vx=-2)


def falling(*circles: Circle, walls: tuple[Wall, ...] = (FLOOR,), e: str = "1/16") -> Scene:
    return Scene([Circle(0, 6, id="ball"), *circles], walls, gravity=(0, -10), restitution=e)


ENDING = {
    "on a floor": (falling(e="1/2"), StopReason.ACCUMULATION),
    "at an instant with roots": (
        falling(walls=(Wall(0, "-sqrt(2)", 1, "-sqrt(2)"),), e="1/8"),
        StopReason.ACCUMULATION,
    ),
    "on a slope": (falling(walls=(Wall(0, 0, 2, 1),)), StopReason.ACCUMULATION),
    "on a floor that rises": (falling(walls=(Wall(0, 0, 1, 0, vy="1/2"),)), StopReason.ACCUMULATION),
    "with another far away": (falling(Circle(900, 6, vx=1)), StopReason.ACCUMULATION),
    "not while another may come": (falling(Circle("21/10", 6)), None),
    "not onto another wall": (falling(walls=(FLOOR, Wall("11/10", 0, "11/10", 1))), None),
    "between two walls": (Scene([Circle(3, 0, vx=1)], CLOSING), StopReason.CRUSHED),
    "over a third wall": (Scene([Circle(3, 0, vx=1)], [*CLOSING, Wall(0, -2, 1, -2)]), StopReason.CRUSHED),
    "with none beside": (Scene([Circle(3, 0, vx=1), Circle(4, 90, vx=1)], CLOSING), StopReason.CRUSHED),
    "at once": (Scene([Circle(0, 0)], [Wall(-2, 0, -2, 1, vx=1), Wall(2, 0, 2, 1, vx=-1)]), StopReason.CRUSHED),
}


@pytest.mark.parametrize("name", ENDING)
def test_infinitely_many_hits_end_both_at_one_instant(name: str) -> None:
    scene, reason = ENDING[name]
    exact, literal = (engine.run(scene, events=120) for engine in (ExactEngine(), SymbolicEngine()))
    if reason is not None:
        assert exact.stop.reason is reason
    assert_same_history(exact, literal)
    if exact.stop.reason is not StopReason.EVENTS:
        assert literal.stop.message == exact.stop.message
    if reason in (StopReason.ACCUMULATION, StopReason.CRUSHED):
        assert_equal(exact.ending, literal.ending)
