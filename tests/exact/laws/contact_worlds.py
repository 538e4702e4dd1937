"""Two circles, or a circle and a wall, in symbols, and what states make of their contact."""

from __future__ import annotations

import pytest
from indeterminates import World

from truebreak.exact.replay.contact import AtWall, Flight, Pair
from truebreak.exact.replay.state import Go, Kick, ReplayState
from truebreak.exact.replay.wall_flights import SeenWall
from truebreak.scenarios import Circle, Scene, Wall

either = pytest.mark.parametrize("younger", [0, 1])
"""Which of the two flights began last."""

PAIR, FACE = Pair(0, 1), AtWall(0, 0)
STEPS = 7
"""Of the log, before the contact."""


def two(younger: int, masses: str = "two", fixed: tuple[bool, bool] = (False, False), **changed: float) -> World:
    """Two circles that will meet: d, v at the later clock, a's numbers, the time between the clocks.

    d and v are symbols, and b's place and speed made of them, so that nothing is lost of the generality, and formulas
    stay short.
    """
    values = {
        "dx": 4.0,
        "dy": 1.25,
        "vx": -1.5,
        "vy": -0.25,
        "ax": 0.5,
        "ay": -0.75,
        "avx": 0.625,
        "avy": 0.375,
        "at": 2.0,
    }
    world = World(**(values | changed), lag=0.5, r=0.75, R=2.0, wa=0.5, wb=1.25)
    w = world
    world.fixed, world.masses = fixed, (w.wa, w.wa if masses == "one" else w.wb)
    bvx, bvy = w.avx + w.vx, w.avy + w.vy
    if younger == 0:
        a = (w.ax, w.ay, w.avx, w.avy, w.at)
        b = (w.ax + w.dx - bvx * w.lag, w.ay + w.dy - bvy * w.lag, bvx, bvy, w.at - w.lag)
    else:
        a = (w.ax - w.avx * w.lag, w.ay - w.avy * w.lag, w.avx, w.avy, w.at - w.lag)
        b = (w.ax + w.dx, w.ay + w.dy, bvx, bvy, w.at)
    world.flights = (Flight(*a, a[4], None, 3 - younger, False), Flight(*b, b[4], None, 2 + younger, False))
    return world


def along(younger: int, level: bool, backward: bool = False, masses: str = "two") -> World:
    """As `two`, on one level or upright line; or a on the other side."""
    world = two(younger, masses, **({"dx": -4.0, "vx": 1.5} if backward else {}))
    w, zero = world, world.zero
    made = []
    for flight in world.flights:
        place, speed = (flight.x, flight.vx)
        numbers = (place, w.ay, speed, zero) if level else (w.ay, place, zero, speed)
        made.append(flight._replace(**dict(zip(("x", "y", "vx", "vy"), numbers, strict=True))))
    world.flights = tuple(made)
    return world


def stand(state: ReplayState, world: World) -> ReplayState:
    """Gives a state the circles of a world."""
    for body, flight, w, r in zip(
        state.bodies.values(), world.flights, world.masses, (world.r, world.R - world.r), strict=False
    ):
        body.flight, body.w, body.r = flight, w, r
    return state


def scene_of(world: World, walls: tuple[Wall, ...] = ()) -> Scene:
    fixed = getattr(world, "fixed", (False,))
    circles = [Circle(9 * k, 0, m="oo" if still else 1) for k, still in enumerate(fixed)]
    return Scene(circles, walls)


def plain(world: World) -> ReplayState:
    return stand(ReplayState(scene_of(world), world), world)


def steps_of(state: ReplayState, link, bodies: tuple[int, ...]) -> ReplayState:
    state.steps_done = STEPS
    state.do(Go(link, bodies))
    state.do(Kick((link,), (link,)))
    return state


def there(flight: Flight, instant):
    """Where a flight is at an instant, and how fast."""
    lag = instant - flight.t
    return flight.x + flight.vx * lag, flight.y + flight.vy * lag, flight.vx, flight.vy


def same(ours: ReplayState, plain: ReplayState) -> None:
    """One instant; on it, one place and velocity of each circle; the clock and what is late make up the instant."""
    assert ours.instant == plain.instant
    assert ours.steps_done == plain.steps_done == STEPS + 2
    for mine, other in zip(ours.bodies.values(), plain.bodies.values(), strict=True):
        flight = mine.flight
        assert flight.instant == plain.instant
        assert flight.t + (0 if flight.late is None else flight.late) == plain.instant
        for number, expected in zip(there(flight, plain.instant), there(other.flight, plain.instant), strict=True):
            assert number == expected


def wall_world(kind: str) -> World:
    """A circle and a wall: seen as an oblique one with a normal of any length, or along an axis, from either side."""
    values = {"ax": 0.5, "ay": 2.0, "avx": 0.625, "avy": -0.375, "at": 2.0, "x0": -1.0, "y0": -0.5, "nx": 0.5}
    values["ny"] = 1.5
    if kind == "level below":
        values |= {"ay": -3.0, "avy": 0.375, "ny": -1.5}
    if kind == "upright":
        values |= {"ax": 2.0, "avx": -0.625}
    if kind == "upright left":
        values |= {"ax": -4.0, "avx": 0.625, "nx": -0.5}
    world = w = World(**values, r=0.75, wa=0.5)
    nx, ny = (w.zero if kind.startswith("level") else w.nx), (w.zero if kind.startswith("upright") else w.ny)
    nn = nx * nx + ny * ny
    length = w.root(nn) if kind == "oblique" else abs(ny) if kind.startswith("level") else abs(nx)
    world.seen = SeenWall(w.x0, w.y0, nx, ny, nn, length)
    world.R, world.masses = w.r + w.r, (w.wa,)
    world.flights = (Flight(w.ax, w.ay, w.avx, w.avy, w.at, w.at, None, 3, False),)
    return world


WALLS = ("oblique", "level", "level below", "upright", "upright left")


def at_wall(state: ReplayState, world: World) -> ReplayState:
    """Gives a state the circle and the wall of a world, as the circle sees it."""
    state._lines[0] = (world.seen, world.seen)
    return stand(state, world)


def scene_with_wall() -> Scene:
    return Scene([Circle(0, 5)], [Wall(-9, 0, 9, 0)])
