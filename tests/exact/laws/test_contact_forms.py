"""The contact forms written by hand are the laws': the code itself runs on formulas, and what it makes is compared.

The plain state calls nothing but the laws' formulas. It is held against the derivation; all others against it: the
instant, and where each circle is then and how it flies on, whatever its clock.
"""

from __future__ import annotations

from functools import cache

import pytest
from contact_worlds import (
    FACE,
    PAIR,
    STEPS,
    WALLS,
    along,
    at_wall,
    either,
    plain,
    same,
    scene_of,
    scene_with_wall,
    stand,
    steps_of,
    there,
    two,
    wall_world,
)
from indeterminates import World, balls_are, stub
from sympy import lambdify

from truebreak.exact.laws import derivation as law
from truebreak.exact.replay import deviations as carrying
from truebreak.exact.replay.ball_state import BallState, LoneContacts
from truebreak.exact.replay.centred_state import CentredState, LoneCentred
from truebreak.exact.replay.contact import Flight, Pair
from truebreak.exact.replay.state import Go, Kick, ReplayState
from truebreak.scenarios import Scene


@cache
def derived(name: str):
    symbols = (law.a_x, law.a_y, law.a_vx, law.a_vy, law.a_m, law.b_x, law.b_y, law.b_vx, law.b_vy, law.b_m)
    return lambdify(symbols, getattr(law, name)()[1])


@cache
def derived_wall():
    return lambdify((law.a_vx, law.a_vy, law.w_x0, law.w_y0, law.w_x1, law.w_y1), law.wall_velocities())


# -- the plain state, against the derivation


@either
def test_the_plain_contact_of_two_is_the_derived_one(younger):
    world = two(younger)
    state = steps_of(plain(world), PAIR, (0, 1))
    before = [there(flight, state.instant) for flight in world.flights]
    (ax, ay, avx, avy), (bx, by, bvx, bvy) = before
    dx, dy, vx, vy = bx - ax, by - ay, bvx - avx, bvy - avy
    assert dx * dx + dy * dy == world.R * world.R
    assert (dx * vx + dy * vy).near < 0  # the earlier of the two times
    wa, wb = world.masses
    # the derivation divides by |d|^2 = R^2: put so that no root is left
    after = derived("pair_velocities")(ax, ay, avx, avy, 1 / wa, bx, by, bvx, bvy, 1 / wb)
    found = [there(body.flight, state.instant) for body in state.bodies.values()]
    assert [number for body in found for number in body[2:]] == list(after)
    assert [body[:2] for body in found] == [body[:2] for body in before]


@pytest.mark.parametrize("kind", WALLS)
def test_the_plain_contact_with_a_wall_is_the_derived_one(kind):
    world = wall_world(kind)
    state = steps_of(at_wall(ReplayState(scene_with_wall(), world), world), FACE, (0,))
    x, y, vx, vy = there(world.flights[0], state.instant)
    seen = world.seen
    assert (x - seen.x0) * seen.nx + (y - seen.y0) * seen.ny == world.r * seen.length
    after = derived_wall()(vx, vy, seen.x0, seen.y0, seen.x0 + seen.ny, seen.y0 - seen.nx)
    assert there(state.bodies[0].flight, state.instant) == (x, y, *after)


# -- balls, by the two steps


def in_balls(world: World, make=BallState, scene: Scene | None = None) -> BallState:
    return stand(make(scene or scene_of(world)), world)


@either
@pytest.mark.parametrize("masses", ["one", "two"])
def test_the_contact_of_two_in_balls(younger, masses, monkeypatch):
    """`_meeting`, `_bounce_first`, and `push` where the clock stands beside the instant."""
    world = two(younger, masses)
    balls_are(world, monkeypatch)
    same(steps_of(in_balls(world), PAIR, (0, 1)), steps_of(plain(world), PAIR, (0, 1)))


def beside_fixed(still: int, younger: int, monkeypatch) -> tuple[World, BallState]:
    """A circle that flies and one of inverse mass 0, at rest, whose flight may be the younger; and balls of them."""
    world = two(younger, fixed=(still == 0, still == 1))
    world.masses = tuple(world.zero if k == still else w for k, w in enumerate(world.masses))
    flight = world.flights[still]
    zero = world.zero
    moved = tuple(f._replace(vx=f.vx - flight.vx, vy=f.vy - flight.vy) for f in world.flights)
    world.flights = tuple(f._replace(vx=zero, vy=zero, rest=True) if k == still else f for k, f in enumerate(moved))
    balls_are(world, monkeypatch)
    return world, in_balls(world)


@pytest.mark.parametrize("still", [0, 1])
def test_the_contact_with_a_fixed_circle_in_balls(still, monkeypatch):
    """Of inverse mass 0, at rest."""
    world, balls = beside_fixed(still, 1 - still, monkeypatch)
    bodies = (1 - still,)
    ours, other = steps_of(balls, PAIR, bodies), steps_of(plain(world), PAIR, bodies)
    assert ours.instant == other.instant
    mine, expected = (there(state.bodies[1 - still].flight, other.instant) for state in (ours, other))
    assert mine == expected


@either
@pytest.mark.parametrize("still", [0, 1])
def test_the_contact_with_a_fixed_circle_in_one_go(still, younger, monkeypatch):
    """`LoneContacts._off_fixed`, whatever of the two flights is the younger."""
    world, balls = beside_fixed(still, younger, monkeypatch)
    assert LoneContacts(balls).strike(PAIR, 300, STEPS) is not None
    same(balls, steps_of(plain(world), PAIR, (0, 1)))


@either
@pytest.mark.parametrize("steep", [False, True])
@pytest.mark.parametrize("backward", [False, True])
def test_the_head_on_contact_of_two_in_balls(younger, steep, backward, monkeypatch):
    """`_head_on` and `_mix`: d is a multiple of v, which is not along an axis."""
    slope = 2.5 if steep else 0.4
    world = two(younger, share=-2.75, vx=1.5 if backward else -1.5, slope=slope)
    w = world
    vy = w.vx * w.slope
    dx, dy = w.share * w.vx, w.share * vy
    a, b = world.flights
    bvx, bvy = w.avx + w.vx, w.avy + vy
    lag = w.at - b.t
    b = b._replace(x=w.ax + dx - bvx * lag, y=w.ay + dy - bvy * lag, vx=bvx, vy=bvy)
    world.flights = (a, b)
    balls_are(world, monkeypatch)
    ours = in_balls(world)
    ours.steps_done = STEPS
    ours.do(Go(PAIR, (0, 1)))
    assert ours._straight
    ours.do(Kick((PAIR,), (PAIR,)))
    same(ours, steps_of(plain(world), PAIR, (0, 1)))


@pytest.mark.parametrize("kind", WALLS)
def test_the_contact_with_a_wall_in_balls(kind, monkeypatch):
    """`bounce_wall`: the line is mirrored, and its clock stands beside the instant."""
    world = wall_world(kind)
    balls_are(world, monkeypatch)
    ours = at_wall(BallState(scene_with_wall()), world)
    same(steps_of(ours, FACE, (0,)), steps_of(at_wall(ReplayState(scene_with_wall(), world), world), FACE, (0,)))


def test_a_reversal_beside_the_instant_leaves_the_places_at_it(monkeypatch):
    """`flip`: at the instant each is where it was, and flies back."""
    world = two(0)
    balls_are(world, monkeypatch)
    state = in_balls(world)
    state.do(Go(PAIR, (0, 1)))
    instant = state.instant
    before = [there(body.flight, instant) for body in state.bodies.values()]
    state.flip()
    for body, (x, y, vx, vy) in zip(state.bodies.values(), before, strict=True):
        assert there(body.flight, instant) == (x, y, -vx, -vy)


# -- balls, a contact alone in one go


@either
@pytest.mark.parametrize("masses", ["one", "two"])
def test_the_contact_of_two_in_one_go(younger, masses, monkeypatch):
    """`LoneContacts._bounce`."""
    world = two(younger, masses)
    balls_are(world, monkeypatch)
    state = in_balls(world)
    assert LoneContacts(state).strike(PAIR, 300, STEPS) is not None
    same(state, steps_of(plain(world), PAIR, (0, 1)))


@either
@pytest.mark.parametrize("level", [True, False])
@pytest.mark.parametrize("backward", [True, False])
@pytest.mark.parametrize("masses", ["one", "two"])
def test_the_contact_of_two_on_a_line_in_one_go(younger, level, backward, masses, monkeypatch):
    """`LoneContacts._on_line`; that its two enclosures of a place are of one number is asserted by `intersection`."""
    world = along(younger, level, backward, masses)
    balls_are(world, monkeypatch)
    state = in_balls(world)
    lone = LoneContacts(state)
    called = []
    on_line = lone._on_line
    monkeypatch.setattr(lone, "_on_line", lambda *given: called.append(given) or on_line(*given))
    assert lone.strike(PAIR, 300, STEPS) is not None
    assert called
    same(state, steps_of(plain(world), PAIR, (0, 1)))


@pytest.mark.parametrize("kind", WALLS)
def test_the_contact_with_a_wall_in_one_go(kind, monkeypatch):
    """`LoneContacts._rebound`, and what `Unchanging` makes of a wall."""
    world = wall_world(kind)
    balls_are(world, monkeypatch)
    state = at_wall(BallState(scene_with_wall()), world)
    assert LoneContacts(state).strike(FACE, 300, STEPS) is not None
    same(state, steps_of(at_wall(ReplayState(scene_with_wall(), world), world), FACE, (0,)))


# -- midpoints, a contact alone in one go


class Landing:
    """Stands for `Deviations`: keeps the new midpoints, and carries no deviations."""

    def __init__(self, world: World) -> None:
        self.mid = {i: (*flight[:5], flight.last) for i, flight in enumerate(world.flights)}
        self.unit, self.place, self.weights = 1.0, {0: 0, 1: 1}, [float(w) for w in world.masses]
        self.errors = stub(meet=lambda *given: None, fly=lambda *given: None)
        self.met = ()

    def collision(self, state, link, met, *rest):
        self.met = met
        return None, 0.0

    def face(self, state, link):
        return stub(mirror=None)

    def wall_time(self, *given):
        return 0.0

    def recentre(self, moved, clock, step):
        return 0.0, []


def centred(state: BallState, world: World, link, monkeypatch) -> Landing:
    """Carries a contact out on midpoints: the state has their flights then."""
    monkeypatch.setattr(carrying, "steps", None)
    monkeypatch.setattr(carrying, "_landed", lambda held, moved, doubles, spread, beside, clock: clock)
    lone, held = LoneCentred(state), Landing(world)

    def land(held, moved, clock, when, step, bits):
        instant, late = when
        for body, x, y, vx, vy in moved:
            body.flight = Flight(x, y, vx, vy, clock, instant, late, step, False)
        state.stand(instant, late, step + 1)

    lone._land = land
    (lone._bounce if isinstance(link, Pair) else lone._rebound)(held, link, 300, STEPS + 1)
    return held


@either
@pytest.mark.parametrize("masses", ["one", "two"])
def test_the_contact_of_two_on_midpoints(younger, masses, monkeypatch):
    """`LoneCentred._bounce`; and d, v and -d.v at the hit, of which the derivative is made."""
    world = two(younger, masses)
    balls_are(world, monkeypatch)
    state = in_balls(world, CentredState)
    held = centred(state, world, PAIR, monkeypatch)
    same(state, steps_of(plain(world), PAIR, (0, 1)))
    (ax, ay, *_), (bx, by, *_) = (there(flight, state.instant) for flight in world.flights)
    dx, dy = bx - ax, by - ay
    assert held.met == (dx, dy, world.vx, world.vy, -(dx * world.vx + dy * world.vy))


@pytest.mark.parametrize("kind", WALLS)
def test_the_contact_with_a_wall_on_midpoints(kind, monkeypatch):
    """`LoneCentred._rebound`."""
    world = wall_world(kind)
    balls_are(world, monkeypatch)
    state = at_wall(CentredState(scene_with_wall()), world)
    centred(state, world, FACE, monkeypatch)
    same(state, steps_of(at_wall(ReplayState(scene_with_wall(), world), world), FACE, (0,)))
