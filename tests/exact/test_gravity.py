"""Uniform gravity: against a referee in true coordinates, its laws, and faults that must be found."""

from __future__ import annotations

from random import Random

import pytest
from gravity_referee import GravityReferee, TieMet
from mpmath import mpf, workdps

from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Quantity, Scene, SceneError, Wall

UNTIL, EVENTS = 12, 14

LOSSES = ("1", "1", "1", "9/10", "1/2", "99/100", "sqrt(2)/2")

PULLS = ((0, -10), (0, -1), ("1/3", "-1/2"), (3, 0), ("-sqrt(2)", "1/7"), (0, "1/100"), ("1/1000", "-9"))


def _draw(rng: Random, low: int, high: int, under: int) -> Quantity:
    return Quantity.of(f"{rng.randint(low * under, high * under)}/{under}")


def scene_of(seed: int) -> Scene | None:
    """Discs off any grid, under gravity between walls, some of them oblique; None where what it draws is refused."""
    rng = Random(f"gravity {seed}")
    discs = [
        Circle(
            3 * (k % 3) - 3 + _draw(rng, -1, 1, 97) / 2,
            3 * (k // 3) - 2 + _draw(rng, -1, 1, 89) / 2,
            r=f"{rng.randint(30, 100)}/101",
            m=rng.choice(("1", "2", "1/3")),
            vx=rng.choice((0, _draw(rng, -3, 3, 31))),
            vy=rng.choice((0, _draw(rng, -3, 3, 37))),
            id=f"c{k}",
        )
        for k in range(rng.randint(1, 5))
    ]
    floor = rng.choice(([0, -6, 1, -6], [-9, -8, 9, -7], [-9, -6, 9, "-13/2"]))
    kinds = {
        "floor": [Wall(*floor, id="floor")],
        "box": [
            Wall(*floor, id="floor"),
            Wall(0, 6, 1, 6, id="top"),
            Wall(-7, 0, -7, 1, id="left"),
            Wall(7, 0, "29/4" if rng.random() < 0.5 else 7, 9, id="right"),
        ],
        "wedge": [Wall(0, -9, 5, -4, id="up"), Wall(0, -9, -4, -4, id="down")],
        "shaft": [Wall(-6, 0, -6, 1, id="left"), Wall(6, 0, 6, 1, id="right")],
    }
    try:
        return Scene(
            discs, kinds[rng.choice(("floor", "box", "box", "wedge", "shaft"))],
            gravity=rng.choice(PULLS), restitution=rng.choice(LOSSES), name=f"gravity {seed}",
        )
    except SceneError:
        return None


def differs(scene: Scene, events: int = EVENTS, until: int = UNTIL) -> str | None:
    """How the exact engine and the referee part; empty where they agree, None where the referee does not take it."""
    try:
        told = GravityReferee(scene).run(mpf(until), events)
    except TieMet:
        return None
    run = ExactEngine().run(scene, until=until, events=events)
    if not run.certified:
        return run.stop.message
    with workdps(60):
        for mine, theirs in zip(told.hits, run.events, strict=False):
            if [tuple(pair) for pair in theirs.contacts] != [mine.pair]:
                return f"event {theirs.index}: {theirs.contacts}, not {mine.pair}"
            if abs(mpf(theirs.time.digits(60)) - mine.time) > mpf(10) ** -40:
                return f"event {theirs.index} at {float(theirs.time)}, not {float(mine.time)}"
        if len(told.hits) != len(run.events):
            return f"{len(run.events)} events, not {len(told.hits)}: {run.stop.message}"
        for circle, disc in zip(run.final.circles, told.bodies, strict=True):
            pairs = zip((circle.x, circle.y, circle.vx, circle.vy), (disc.x, disc.y, disc.vx, disc.vy), strict=True)
            if any(abs(mpf(a.digits(60)) - b) > mpf(10) ** -35 for a, b in pairs):
                return f"{circle.id} ends elsewhere"
    return ""
