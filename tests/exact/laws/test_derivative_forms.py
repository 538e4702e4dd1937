"""Derivatives written by hand are those of the laws: what carries small deviations through flights and contacts.

The code runs on formulas (see `indeterminates.py`), and is held against `tangent_formulas.py`, which is proved. That
the bounds of deviations hold besides is the matter of docs/error-bound.md and its tests.
"""

from __future__ import annotations

import numpy as np
from indeterminates import Formula, World, root_of
from sympy import diff, solve, symbols

from truebreak.compare.tangent.growth import Displacements
from truebreak.compare.tangent.impacts import Impact
from truebreak.exact.laws import formulas
from truebreak.exact.laws.tangent_formulas import fall_turn, pair_tangent
from truebreak.exact.replay import error_bounds as derivatives
from truebreak.exact.replay import error_set
from truebreak.exact.replay.error_bounds import Collision, Mirror
from truebreak.scenarios import Circle, Scene


def contact() -> World:
    """Two circles at their contact, and a displacement of each."""
    values = {"dx": 1.5, "dy": -0.75, "vx": -1.0, "vy": 0.5, "wa": 0.5, "wb": 1.25, "flown_a": 0.5}
    moves = {f"{kind}{axis}_{who}": 0.5 for who in "ab" for kind in "pq" for axis in "xy"}
    world = World(**values, **moves, unit=2.0, flown_b=0.25)
    w = world
    world.square = w.dx * w.dx + w.dy * w.dy
    world.reach = world.root(world.square)
    world.strength = -2 / (world.square * (w.wa + w.wb))
    world.a, world.b = ([getattr(w, f"{name}_{who}") for name in ("px", "py", "qx", "qy")] for who in "ab")
    return world


def after_impact(world: World, a: list[Formula], b: list[Formula]) -> tuple[list[Formula], list[Formula]]:
    """Two displacements after the collision, by the derived map; a fixed one has none."""
    w = world
    gain = pair_tangent(w.dx, w.dy, w.vx, w.vy, w.reach, w.wa, w.wb, *(q - p for p, q in zip(a, b, strict=True)))
    return (
        [p - w.wa * g for p, g in zip(a, gain, strict=True)],
        [p + w.wb * g for p, g in zip(b, gain, strict=True)],
    )


class Objects:
    """numpy, with arrays of objects where it would make arrays of doubles."""

    def __getattr__(self, name: str):
        return getattr(np, name)

    @staticmethod
    def zeros(shape):
        return np.full(shape, 0, dtype=object)

    empty = zeros


def test_a_block_s_matrix_is_the_derived_map_of_flights_and_a_collision(monkeypatch):
    """`_blocks` and `_maps`: velocities counted in a unit of time."""
    world = w = contact()
    monkeypatch.setattr(error_set, "np", Objects())
    legs = [error_set._then(error_set.STILL, flown / w.unit, Mirror()) for flown in (w.flown_a, w.flown_b)]
    speed = -(w.dx * w.vx + w.dy * w.vy)
    hit = Collision(0.0, 0.0, 0.0, w.dx, w.dy, w.vx, w.vy, speed, w.strength)
    hits = np.array([[*legs[0], *legs[1], w.wa, w.wb, *hit[3:]]], dtype=object)
    (matrix,) = error_set._maps(hits, error_set._blocks(hits, w.unit))
    scaled = [p * k for p, k in zip((*w.a, *w.b), (1, 1, w.unit, w.unit) * 2, strict=True)]
    told = [sum((entry * value for entry, value in zip(line, scaled, strict=True)), world.zero) for line in matrix]
    flown = [[px + qx * lag, py + qy * lag, qx, qy] for (px, py, qx, qy), lag in ((w.a, w.flown_a), (w.b, w.flown_b))]
    one, other = after_impact(world, *flown)
    expected = [p * k for p, k in zip((*one, *other), (1, 1, w.unit, w.unit) * 2, strict=True)]
    assert told == expected


def test_a_flight_between_walls_is_mirrored_and_flown(monkeypatch):
    """`_then` and `_flown`: two flights, each ended by a mirror."""
    w = World(nx=1.5, ny=0.5, mx=-0.25, my=1.0, s=0.5, t=0.25, x=1.0, y=2.0, vx=0.5, vy=0.75)
    monkeypatch.setattr(error_set, "np", Objects())
    legs, place, speed = error_set.STILL, (w.x, w.y), (w.vx, w.vy)
    for lag, nx, ny in ((w.s, w.nx, w.ny), (w.t, w.mx, w.my)):
        nn = nx * nx + ny * ny
        legs = error_set._then(legs, lag, Mirror(*formulas.wall_mirror(nx, ny, nn), 0.0))
        flown = [formulas.advance(p, v, lag) for p, v in zip(place, speed, strict=True)]
        place, speed = (formulas.wall_bounce(*pair, nx, ny, nn) for pair in (flown, speed))
    (matrix,) = error_set._flown(np.array([legs], dtype=object))
    given = (w.x, w.y, w.vx, w.vy)
    told = [sum((k * v for k, v in zip(line, given, strict=True)), w.zero) for line in matrix]
    assert told == [*place, *speed]


def test_a_block_s_matrix_is_the_derived_map_of_a_bounce_off_a_wall_that_falls(monkeypatch):
    """`fall_derivative`, `_blocks` and `_maps`: what `wall_bounce` and `fall_turn` make of a displacement flown on."""
    w = World(nx=1.5, ny=0.5, speed=2.0, pull=-0.75, share=0.75, unit=2.0, lag=0.5, px=1.0, py=2.0, qx=0.5, qy=0.75)
    monkeypatch.setattr(error_set, "np", Objects())
    monkeypatch.setattr(derivatives, "UP", 1)
    monkeypatch.setattr(derivatives, "sqrt", root_of)
    nn, small = w.nx * w.nx + w.ny * w.ny, w.number(1e-30)
    found = derivatives.fall_derivative(
        w.nx, w.ny, w.speed, -(w.share + w.share) / nn, w.pull, w.unit, small, small, derivatives.CLOSE
    )
    legs = error_set._then(error_set.STILL, w.lag / w.unit, Mirror())
    hits = np.array([[*legs, *error_set.STILL, w.number(1), w.zero, *found[3:]]], dtype=object)
    (matrix,) = error_set._maps(hits, error_set._blocks(hits, w.unit))
    place, speed = [w.px + w.qx * w.lag, w.py + w.qy * w.lag], [w.qx, w.qy]
    mirrored = [formulas.wall_bounce(*pair, w.nx, w.ny, nn) for pair in (place, speed)]
    place_after, turned = (
        [formulas.damped(p, q, w.share) for p, q in zip(*of, strict=True)]
        for of in zip((place, speed), mirrored, strict=True)
    )
    more = fall_turn(w.nx, w.ny, nn, -w.speed, w.pull, *place)
    expected = [*place_after, *((q + w.share * m) * w.unit for q, m in zip(turned, more, strict=True))]
    scaled = [w.px, w.py, w.qx * w.unit, w.qy * w.unit]
    assert [sum((k * v for k, v in zip(line[:4], scaled, strict=True)), w.zero) for line in matrix[:4]] == expected
    assert found.turn * w.speed == w.share * w.unit * abs(w.pull)
    assert found.steep * w.speed == w.root(nn)


def test_a_block_s_matrix_is_the_derived_map_of_a_fall_onto_something_round(monkeypatch):
    """`pair_derivative`, `_blocks` and `_maps`: `pair_tangent` and `fall_turn`, of one that falls onto the other."""
    w = contact()
    ax, ay = w.number(0.75), w.number(-1.25)
    monkeypatch.setattr(error_set, "np", Objects())
    monkeypatch.setattr(derivatives, "UP", 1)
    monkeypatch.setattr(derivatives, "sqrt", root_of)
    approach, small, strength = w.dx * w.vx + w.dy * w.vy, w.number(1e-30), -2 / (w.square * w.wb)
    found = derivatives.pair_derivative(
        w.dx, w.dy, w.vx, w.vy, -approach, strength, w.unit, small, small, derivatives.CLOSE, ax, ay
    )
    legs = error_set._then(error_set.STILL, w.flown_b / w.unit, Mirror())
    hits = np.array([[*error_set.STILL, *legs, w.zero, w.wb, *found[3:]]], dtype=object)
    (matrix,) = error_set._maps(hits, error_set._blocks(hits, w.unit))
    px, py, qx, qy = w.b
    flown = [px + qx * w.flown_b, py + qy * w.flown_b, qx, qy]
    gain = pair_tangent(w.dx, w.dy, w.vx, w.vy, w.reach, w.zero, w.wb, *flown)
    more = fall_turn(w.dx, w.dy, w.square * w.wb, approach, w.dx * ax + w.dy * ay, *flown[:2])
    gain = [*gain[:2], *(one + other for one, other in zip(gain[2:], more, strict=True))]
    scale = (1, 1, w.unit, w.unit)
    expected = [(p + w.wb * g) * k for p, g, k in zip(flown, gain, scale, strict=True)]
    scaled = [p * k for p, k in zip(w.b, scale, strict=True)]
    assert [sum((k * v for k, v in zip(line[4:], scaled, strict=True)), w.zero) for line in matrix[4:]] == expected
    bend = w.root(ax * ax + ay * ay)
    assert found.turn * -approach == w.unit * (w.vx * w.vx + w.vy * w.vy + bend * w.reach)


def test_the_bounds_of_a_derivative_are_the_norms_of_the_derived_one(monkeypatch):
    """|d| + |v| t = R, differentiated: the instant moves by -d.p / d.v at most, for |p| = 1 by |d| / |d.v|."""
    w = contact()
    monkeypatch.setattr(derivatives, "UP", 1)
    monkeypatch.setattr(derivatives, "sqrt", root_of)
    speed = -(w.dx * w.vx + w.dy * w.vy)
    found = derivatives.pair_derivative(
        w.dx, w.dy, w.vx, w.vy, speed, w.strength, w.unit, w.number(1e-9), w.number(1e-9), 1.0
    )
    dx, dy, vx, vy, px, py, wait, small, R = symbols("dx dy vx vy px py wait small R")
    there_x, there_y = (formulas.advance(p, v, small * wait) for p, v in ((dx + small * px, vx), (dy + small * py, vy)))
    grown = diff(formulas.pair_gap(there_x, there_y, R), small).subs(small, 0)
    (delay,) = solve(grown, wait)
    assert (delay + (dx * px + dy * py) / (dx * vx + dy * vy)).simplify() == 0
    assert found.steep * speed == w.reach
    assert found.turn * speed == w.unit * (w.vx * w.vx + w.vy * w.vy)
    fast = w.root(w.vx * w.vx + w.vy * w.vy)
    assert found.apart == (1 + fast * found.steep) * 1e-9


def test_the_steepness_of_a_wall_bounds_the_derivative_of_its_hit(monkeypatch):
    """The instant moves by -n.p / n.v; |n| is at most the sum of its components."""
    monkeypatch.setattr(derivatives, "STEEPER", 1)
    world = w = World(nx=1.5, ny=-0.5, vx=-1.0, vy=0.5)
    assert derivatives.wall_steepness(w.nx, w.ny, w.vx, w.vy) * -(w.nx * w.vx + w.ny * w.vy) == w.nx - w.ny
    assert world.nx.near > 0 > world.ny.near


def test_displacements_go_through_a_contact_by_the_derived_map():
    """`compare/tangent/growth.py`: a flight, a collision, a flight and a wall."""
    world = w = contact()
    columns = np.array([w.a, w.b], dtype=object).reshape(2, 4, 1)
    carried = Displacements(Scene([Circle(0, 0), Circle(9, 0)]), columns, w.flown_b)
    carried.through([Impact(w.flown_b + w.flown_a, 0, 1, w.dx, w.dy, w.vx, w.vy, w.reach, w.wa, w.wb)])
    flown = [[px + qx * w.flown_a, py + qy * w.flown_a, qx, qy] for px, py, qx, qy in (w.a, w.b)]
    one, other = after_impact(world, *flown)
    assert list(carried.columns[0, :, 0]) == one
    assert list(carried.columns[1, :, 0]) == other
    carried.through([Impact(carried.time, 0, None, w.dx, w.dy, w.vx, w.vy, w.reach, w.zero, w.zero)])
    mirrored = [formulas.wall_bounce(*pair, w.dx, w.dy, w.square) for pair in (one[:2], one[2:])]
    assert [*carried.columns[0, :, 0]] == [*mirrored[0], *mirrored[1]]
