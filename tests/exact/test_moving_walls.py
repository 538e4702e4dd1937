"""Walls that move: against a referee in true coordinates, what the laws say, faults that must be found."""

from __future__ import annotations

from random import Random

import pytest
from gravity_referee import GravityReferee, TieMet
from mpmath import mpf, workdps

from truebreak.exact import ExactEngine
from truebreak.exact.replay import wall_flights
from truebreak.exact.replay.state import Flights, ReplayState
from truebreak.exact.replay.wall_flights import SeenWall
from truebreak.exact.simulation import prediction
from truebreak.scenarios import Circle, Quantity, Scene, SceneError, StopReason, Wall

UNTIL, EVENTS = 12, 14

PULLS = (None, None, None, (0, -10), (0, -1), ("1/3", "-1/2"), (3, 0), ("-sqrt(2)", "1/7"), (0, "1/100"))

PACES = ((0, 1), (0, -1), ("1/3", 0), ("-2/7", "5/11"), ("sqrt(2)/9", "-1/10"), (-3, "1/2"), (0, 0), (0, 0))

LOSSES = ("1", "1", "1", "9/10", "1/2", "99/100", "sqrt(2)/2")


def _draw(rng: Random, low: int, high: int, under: int) -> Quantity:
    return Quantity.of(f"{rng.randint(low * under, high * under)}/{under}")


def scene_of(seed: int) -> Scene | None:
    """Discs off any grid, walls that move, gravity, restitution; None where what it draws is refused."""
    rng = Random(f"moving {seed}")
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
    floor = rng.choice(([0, -6, 1, -6], [-9, -8, 9, -7], [-9, -6, 9, "-13/2"], [9, -6, -9, "-13/2"]))
    right = [7, 0, "29/4" if rng.random() < 0.5 else 7, 9]
    kinds = {
        "floor": {"floor": floor},
        "box": {"floor": floor, "top": [0, 6, 1, 6], "left": [-7, 0, -7, 1], "right": right},
        "wedge": {"up": [0, -9, 5, -4], "down": [0, -9, -4, -4]},
        "shaft": {"left": [-6, 0, -6, 1], "right": [6, 0, 6, 1]},
    }
    lines = kinds[rng.choice(("floor", "box", "box", "wedge", "shaft"))]
    walls = []
    for name, points in lines.items():
        vx, vy = rng.choice(PACES)
        walls.append(Wall(*points, id=name, vx=vx, vy=vy))
    try:
        return Scene(discs, walls, gravity=rng.choice(PULLS), restitution=rng.choice(LOSSES), name=f"moving {seed}")
    except SceneError:
        return None


def differs(scene: Scene, events: int = EVENTS, until: int = UNTIL) -> str | None:
    """How the exact engine and the referee part; empty where they agree, None where the referee does not take it."""
    try:
        told = GravityReferee(scene).run(mpf(until), events)
    except TieMet:
        return None
    run = ExactEngine().run(scene, until=until, events=events)
    if run.stop.reason is StopReason.CRUSHED:
        del told.hits[len(run.events) :]
    elif not run.certified:
        return run.stop.message
    with workdps(60):
        for mine, theirs in zip(told.hits, run.events, strict=False):
            if [tuple(pair) for pair in theirs.contacts] != [mine.pair]:
                return f"event {theirs.index}: {theirs.contacts}, not {mine.pair}"
            if abs(mpf(theirs.time.digits(60)) - mine.time) > mpf(10) ** -40:
                return f"event {theirs.index} at {float(theirs.time)}, not {float(mine.time)}"
        if len(told.hits) != len(run.events):
            return f"{len(run.events)} events, not {len(told.hits)}: {run.stop.message}"
        if run.stop.reason is StopReason.CRUSHED:
            return ""
        for circle, disc in zip(run.final.circles, told.bodies, strict=True):
            pairs = zip((circle.x, circle.y, circle.vx, circle.vy), (disc.x, disc.y, disc.vx, disc.vy), strict=True)
            if any(abs(mpf(a.digits(60)) - b) > mpf(10) ** -35 for a, b in pairs):
                return f"{circle.id} ends elsewhere"
    return ""


SEEDS = range(120)


def test_scenes_agree_with_the_referee():
    found = {seed: told for seed in SEEDS if (scene := scene_of(seed)) and (told := differs(scene)) is not None}
    assert len(found) > 100
    assert {seed: told for seed, told in found.items() if told} == {}


# -- Faults that the comparison must find.


def _paces(change):
    """Other velocities of walls than the scene's."""

    def spoil(monkeypatch):
        known = Flights.__init__

        def made(self, scene, numbers, only=None):
            known(self, scene, numbers, only)
            self.drifts = {k: change(*pace) for k, pace in self.drifts.items()}

        monkeypatch.setattr(Flights, "__init__", made)

    return spoil


def _place(change):
    """Another place of a wall at a time."""
    return lambda monkeypatch: monkeypatch.setattr(SeenWall, "moved", change)


def _bounce(share):
    """An impulse in which the wall's velocity counts so often."""

    def spoil(monkeypatch):
        plain = ReplayState.bounce_wall

        def bounced(state, link):
            plain(state, link)
            drift = state.drifts.get(link.wall)
            if drift is not None:
                body, line = state.bodies[link.circle], state.line(*link[:2])
                more = (line.nx * drift[0] + line.ny * drift[1]) * (share - 1) / line.nn
                more = more + more if state.share is None else (more + more) * state.share
                state._turn(body, line.nx * more, line.ny * more)

        monkeypatch.setattr(ReplayState, "bounce_wall", bounced)

    return spoil


def _other_zero(monkeypatch):
    """Of two zeros the one at which the gap grows."""
    for place in (prediction, wall_flights):
        monkeypatch.setattr(place, "fall_time_back", lambda approach, half, root: (root - approach) / (half + half))


FAULTS = {
    "the other sign of u": _paces(lambda ux, uy: (-ux, -uy)),
    "u along y alone": _paces(lambda ux, uy: (ux - ux, uy)),
    "u off by 1e-9": _paces(lambda ux, uy: (ux + ux / 10**9, uy + uy / 10**9)),
    "half of u": _paces(lambda ux, uy: (ux / 2, uy / 2)),
    "a wall that stands, and pushes as if it moved": _place(lambda self, drift, time: self),
    "a wall that moves twice as far": _place(
        lambda self, u, t: self._replace(x0=self.x0 + (u[0] + u[0]) * t, y0=self.y0 + (u[1] + u[1]) * t)
    ),
    "a wall that moves backwards": _place(
        lambda self, u, t: self._replace(x0=self.x0 - u[0] * t, y0=self.y0 - u[1] * t)
    ),
    "u forgotten in the impulse": _bounce(0),
    "u twice in the impulse": _bounce(2),
    "the other zero": _other_zero,
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_found(fault: str, monkeypatch: pytest.MonkeyPatch):
    FAULTS[fault](monkeypatch)
    assert any(_found(scene) for seed in range(60) if (scene := scene_of(seed)))


def _found(scene: Scene) -> bool:
    try:
        return bool(differs(scene, events=8))
    except (AssertionError, ArithmeticError):
        return True
