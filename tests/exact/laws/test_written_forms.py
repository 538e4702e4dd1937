"""Forms written by hand elsewhere are the laws' too: predictions in doubles, questions, the flat loop, derivatives.

As in `test_contact_forms.py` the code itself runs on formulas. Where it bounds roundings, the unit of rounding is set
to 0 here: what is left is the formula; that the bounds hold is the matter of `tests/exact/certified`, and of
docs/error-bound.md.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import count
from math import inf

import numpy as np
import pytest
from contact_worlds import (
    FACE,
    PAIR,
    STEPS,
    WALLS,
    at_wall,
    either,
    plain,
    scene_with_wall,
    steps_of,
    two,
    wall_world,
)
from indeterminates import Formula, World, root_of, stub

from truebreak.exact.certified import filtered as double_filter
from truebreak.exact.laws import formulas
from truebreak.exact.question import (
    BeforeTime,
    Coupling,
    Discriminant,
    Endless,
    Falling,
    Moment,
    Pivot,
    RelativeSpeed,
    Share,
    Slack,
    Sooner,
    Strength,
)
from truebreak.exact.replay.contact import AtWall, Body, Flight, Pair
from truebreak.exact.replay.state import Go, ReplayState
from truebreak.exact.simulation import prediction
from truebreak.floating import pocket_entries as pockets
from truebreak.floating.flat import flying
from truebreak.floating.knots import DoubleMotion
from truebreak.scenarios import Circle, Quantity, Scene, Wall


def hit_of(world: World, link=PAIR, bodies=(0, 1)) -> ReplayState:
    state = plain(world) if link is PAIR else at_wall(ReplayState(scene_with_wall(), world), world)
    state.steps_done = STEPS
    state.do(Go(link, bodies))
    return state


def filtered(world: World, monkeypatch) -> tuple[double_filter.DoubleFilter, list[Body]]:
    """A filter without roundings, and the bodies of a world as it has them."""
    monkeypatch.setattr(double_filter, "UNIT", 0)
    monkeypatch.setattr(double_filter, "sqrt", root_of)
    monkeypatch.setattr(double_filter, "isfinite", lambda value: True)
    monkeypatch.setattr(double_filter, "predictions", None)  # which gives the same bits: tests/exact/compiled
    filter_, bodies = double_filter.DoubleFilter(), []
    for i, (flight, w) in enumerate(zip(world.flights, world.masses, strict=True)):
        body = Body(i, flight, world.r, w)
        filter_.take(body, (*flight[:5], 0.0))
        bodies.append(body)
    return filter_, bodies


# -- the filter in doubles


@either
def test_the_filter_tells_the_time_of_the_hit_of_two(younger, monkeypatch):
    world = two(younger)
    filter_, (a, b) = filtered(world, monkeypatch)
    ((low, high, other),), unclear = filter_.pairs(a, [b], [world.R])
    assert (other, unclear) == (b, [])
    assert low == high == hit_of(world).instant


@pytest.mark.parametrize("kind", WALLS)
def test_the_filter_tells_the_time_of_the_hit_of_a_wall(kind, monkeypatch):
    world = wall_world(kind)
    filter_, (body,) = filtered(world, monkeypatch)
    x0, y0, nx, ny, _, length = world.seen
    line = double_filter.FloatLine(0, x0, y0, nx, ny, world.r * length, abs(nx) + abs(ny), world.one)
    ((low, high, wall),), unclear = filter_.walls(body, [line])
    assert (wall, unclear) == (0, [])
    assert low == high == hit_of(world, FACE, (0,)).instant


def slid(world: World, inside: bool):
    """The line of a world's wall, moved along itself so that the circle meets it between its points, or beyond."""
    x0, y0, nx, ny, nn, _ = world.seen
    wait = hit_of(world, FACE, (0,)).instant - world.at
    along = (world.ax + world.avx * wait - x0) * ny - (world.ay + world.avy * wait - y0) * nx
    by = int(along.near // nn.near) + (0 if inside else 2)
    world.seen = world.seen._replace(x0=x0 + by * ny, y0=y0 - by * nx)
    return world.seen


@pytest.mark.parametrize("inside", [True, False])
@pytest.mark.parametrize("kind", WALLS)
def test_the_filter_tells_the_time_of_the_hit_of_a_face_between_its_ends(kind, inside, monkeypatch):
    world = wall_world(kind)
    x0, y0, nx, ny, _, length = slid(world, inside)
    filter_, (body,) = filtered(world, monkeypatch)
    line = double_filter.FloatLine(0, x0, y0, nx, ny, world.r * length, abs(nx) + abs(ny), world.one)
    found, unclear = filter_.faces(body, [line])
    instant = hit_of(world, FACE, (0,)).instant
    assert unclear == []
    assert len(found) == inside
    assert all(low == high == instant and wall == 0 for low, high, wall in found)


def test_the_filter_weighs_a_rim_by_the_gap(monkeypatch):
    """A sign alone comes out: at whole numbers, of which doubles lose nothing, on the rim and on either side."""
    world = two(0)
    filter_, (a, b) = filtered(world, monkeypatch)
    a.f, b.f = (1.0, 2.0, 1.0, 1.0, 0.0, 0.0), (4.0, -2.0, 0.0, 0.0, 0.0, 0.0)
    filter_.largest = filter_.fastest = 1.0
    assert [filter_.apart(a, b, r) for r in (4.0, 5.0, 6.0)] == [True, False, True]


def test_the_earliest_time_of_a_doubtful_meeting_is_the_gap_over_the_speed(monkeypatch):
    """|d| - R over |v|, and n.p - r |n| over n.v."""
    world, seen = two(0), []
    state = plain(world)
    prediction.earliest_possible(state, PAIR, lambda value: seen.append(value) or (float(value), float(value)))
    gap, speed, clock = seen
    assert (gap + world.R) * (gap + world.R) == world.dx * world.dx + world.dy * world.dy
    assert (gap + world.R).near > 0
    assert speed * speed == world.vx * world.vx + world.vy * world.vy
    assert speed.near > 0
    assert clock == world.at
    world, seen = wall_world("oblique"), []
    state = at_wall(ReplayState(scene_with_wall(), world), world)
    prediction.earliest_possible(state, FACE, lambda value: seen.append(value) or (float(value), float(value)))
    assert seen[0] / seen[1] == state.wall_hit(FACE)[1]


# -- questions


def square_roots(state: ReplayState, question) -> Formula:
    """What a question's sum of roots comes to."""
    a, b, d1, c, d2 = question.sum_of_roots(state)
    return a + sum((k * state.root(d) for k, d in ((b, d1), (c, d2)) if not d.is_zero()), state.zero)


@either
def test_a_question_of_time_is_the_same_number_in_either_form(younger):
    """The textbook root, which adds none to a comparison, and the stable one, which keeps its digits."""
    world = two(younger)
    hit, graze = Moment(PAIR), Moment(PAIR, graze=True)
    for question in (BeforeTime(hit, Quantity.of(3)), Sooner(hit, graze), Sooner(graze, hit), Sooner(hit, hit)):
        state = plain(world)
        assert question.value(state) == square_roots(state, question)
    state = plain(world)
    assert BeforeTime(hit, Quantity.of(3)).value(state) == hit_of(world).instant - 3
    assert BeforeTime(hit, None).value(state) == hit_of(world).instant - state.flip_time * 2
    root = state.root(Discriminant(PAIR).value(state))
    nearest = sum(graze.wait(state), world.zero) - sum(hit.wait(state), world.zero)
    assert nearest * RelativeSpeed(PAIR).value(state) == root
    assert RelativeSpeed(PAIR).value(state) == world.vx * world.vx + world.vy * world.vy
    assert Discriminant(PAIR).value(state) == formulas.pair_discriminant(
        world.dx, world.dy, world.vx, world.vy, world.R
    )


@pytest.mark.parametrize("kind", WALLS)
def test_a_question_of_time_at_a_wall(kind):
    world = wall_world(kind)
    state = at_wall(ReplayState(scene_with_wall(), world), world)
    question = BeforeTime(Moment(FACE), Quantity.of(3))
    assert question.value(state) == square_roots(state, question) == hit_of(world, FACE, (0,)).instant - 3


def row() -> tuple[ReplayState, tuple[Pair | AtWall, ...]]:
    """Three circles that touch, the middle one both others, and the last a wall: any places and masses, and velocities,
    as one sees them who flies with the middle one."""
    values = {"px": 2.0, "py": 0.25, "qx": 1.75, "qy": 1.0, "ux": 1.0, "uy": 0.5, "wx": -0.75, "wy": 0.25}
    world = World(**values, wa=0.5, wb=1.25, wc=0.75, nx=-1.5, ny=0.5, time=1.0, share=0.75)
    w, zero = world, world.zero
    world.masses, world.r, world.R = (w.wa, w.wb, w.wc), w.one, w.one + w.one
    places = ((zero, zero), (w.px, w.py), (w.px + w.qx, w.py + w.qy))
    speeds = ((w.ux, w.uy), (zero, zero), (w.wx, w.wy))
    world.flights = tuple(
        Flight(*place, *speed, w.time, w.time, None, 1, False) for place, speed in zip(places, speeds, strict=True)
    )
    scene = Scene([Circle(9 * k, 5) for k in range(3)], [Wall(-9, 0, 99, 0)])
    state = ReplayState(scene, world)
    for body, flight, mass in zip(state.bodies.values(), world.flights, world.masses, strict=True):
        body.flight, body.w = flight, mass
    seen = stub(x0=zero, y0=zero, nx=w.nx, ny=w.ny, nn=w.nx * w.nx + w.ny * w.ny)
    state._lines[0] = (seen, seen)
    return state, (Pair(0, 1), Pair(1, 2), AtWall(2, 0))


def energy(state: ReplayState) -> Formula:
    """Twice the kinetic energy."""
    flights = [(body.flight, body.w) for body in state.bodies.values()]
    return sum(((f.vx * f.vx + f.vy * f.vy) / w for f, w in flights), state.zero)


def test_impulses_together_keep_energy_and_momentum_and_turn_every_approach():
    """The statement of a collision (`derivation.pair_collision`), for several contacts of one instant."""
    state, links = row()
    before = energy(state), [link.closing(state) for link in links]
    momenta = [sum((b.flight[k] / b.w for b in state.bodies.values()), state.zero) for k in (2, 3)]
    first = Strength(links[:2], links[0]).value(state)
    (px, py), wa, (_, _, ux, uy, *_) = state.span(links[0]), state.bodies[0].w, state.bodies[0].flight
    state.kick(links[:2])
    after = energy(state), [link.closing(state) for link in links]
    assert after[0] == before[0]
    assert after[1][:2] == [-speed for speed in before[1][:2]]
    assert momenta == [sum((b.flight[k] / b.w for b in state.bodies.values()), state.zero) for k in (2, 3)]
    assert (state.bodies[0].flight.vx, state.bodies[0].flight.vy) == (ux - wa * first * px, uy - wa * first * py)


@pytest.mark.parametrize("together", [slice(0, 1), slice(2, 3), slice(0, 2)], ids=["two", "a wall", "several"])
def test_with_a_restitution_contacts_separate_e_times_as_fast(together):
    """`derivation.pair_restitution`: what else it states, momentum and the velocity across, is each impulse's own."""
    state, links = row()
    share = state.share = state.one * 7 / 8
    if together.start == 0 and together.stop == 1:
        dx, dy = state.span(links[0])
        for body in list(state.bodies.values())[:2]:
            body.r = state.root(dx * dx + dy * dy) / 2
    before = [link.closing(state) for link in links[together]]
    state.kick(links[together])
    assert [link.closing(state) for link in links[together]] == [-(share * 2 - 1) * speed for speed in before]


def test_pushes_in_turns_are_those_of_the_question_whether_they_end():
    """Two pushes in turn: z**2 - (1 + e) c z + e, whose discriminant and half sum of zeros are asked for."""
    state, (one, other, _) = row()
    share = state.share = state.one * 7 / 8
    e, ((aa, ab), (_, bb)) = share * 2 - 1, state.contact_system((one, other))[0]
    assert Endless(one, other).value(state) * 4 == (1 + e) * (1 + e) * ab * ab - 4 * e * aa * bb
    p, q = -one.closing(state), other.closing(state)
    ahead = Falling(one, other).value(state)
    dx, dy = state.span(one)
    for index in one:
        state.bodies[index].r = state.root(dx * dx + dy * dy) / 2
    state.kick((one,))
    assert -other.closing(state) == -(1 + e) * ab / aa * p - q
    assert ahead * 2 == aa * (-other.closing(state) - q)


def test_a_slack_is_what_a_contact_outside_separates_by_beyond_its_approach():
    state, links = row()
    slack = Slack(links[:2], links[2]).value(state)
    before = links[2].closing(state)
    state.kick(links[:2])
    assert slack == links[2].closing(state) + before


def test_one_contact_kicked_together_has_the_derived_impulse():
    """R is |d| at contact."""
    state, links = row()
    dx, dy = state.span(links[0])
    strength = Strength(links[:1], links[0]).value(state)
    reach = state.root(dx * dx + dy * dy)
    a, b = (state.bodies[i] for i in links[0])
    between = b.flight.vx - a.flight.vx, b.flight.vy - a.flight.vy
    assert (strength * dx, strength * dy) == formulas.pair_impulse(dx, dy, *between, reach, a.w, b.w)
    nx, ny = (state.line(2, 0).nx, state.line(2, 0).ny)
    strength = Strength(links[2:], links[2]).value(state)
    c = state.bodies[2]
    bounced = formulas.wall_bounce(c.flight.vx, c.flight.vy, nx, ny, nx * nx + ny * ny)
    assert (c.flight.vx + c.w * strength * nx, c.flight.vy + c.w * strength * ny) == bounced


def test_pivot_and_share_tell_whether_a_push_is_made_of_others():
    """With the Gram matrix of the pushes: a share solves it, and the pivot is the ratio of two determinants."""
    state, links = row()
    matrix, _ = state.contact_system(links)
    (aa, ab, ac), (_, bb, bc), (_, _, cc) = matrix
    shares = [Share(links[:2], link, links[2]).value(state) for link in links[:2]]
    assert aa * shares[0] + ab * shares[1] == ac
    assert ab * shares[0] + bb * shares[1] == bc
    inner = aa * bb - ab * ab
    whole = cc * inner - ac * (ac * bb - ab * bc) - bc * (aa * bc - ab * ac)
    assert Pivot(links[:2], links[2]).value(state) * inner == whole


def test_a_coupling_is_what_one_push_does_to_the_other_contact():
    """How fast the second separates more for a push of strength 1 through the first."""
    state, (first, second, _) = row()
    before = second.closing(state)
    coupling = Coupling(first, second).value(state)
    for index, jx, jy in first.arms(state):
        state.push(state.bodies[index], jx, jy)
    assert second.closing(state) - before == coupling


# -- the flat loop


def flat(world: World, steps: int = STEPS):
    """The flights of a world as the flat loop keeps them."""
    radii = (world.r, world.R - world.r)
    places = 3
    return stub(
        n=2,
        flights=[(*flight[:5], r, i) for i, (flight, r) in enumerate(zip(world.flights, radii, strict=False))],
        weights=[(mass, False) for mass in world.masses],
        until=[inf] * places,
        serial=[0] * places,
        last=[0] * places,
        heap=[],
        tick=count(1).__next__,
        steps=steps,
        unsure=None,
        share=None,
    )


SHARES = pytest.mark.parametrize("share", [None, Fraction(7, 8)], ids=["elastic", "restitution 3/4"])


@SHARES
def test_the_flat_loop_predicts_and_carries_out_the_contact_of_two(share, monkeypatch):
    world = two(0)
    monkeypatch.setattr(flying, "sqrt", root_of)
    f = flat(world)
    flying.pairs(f, 0, [f.flights[1]], ())
    ((time, _, i, j, _, _, wait, graze),) = f.heap
    assert (i, j, graze) == (0, 1, False)
    state = plain(world)
    f.share = state.share = share and world.number(share)
    state = steps_of(state, PAIR, (0, 1))
    assert time == state.instant
    flying.strike(f, 0, 1, time, wait)
    for (x, y, vx, vy, t, *_), body in zip(f.flights, state.bodies.values(), strict=True):
        assert (x, y, vx, vy, t) == body.flight[:5]


@SHARES
@pytest.mark.parametrize("kind", WALLS)
def test_the_flat_loop_predicts_and_carries_out_the_contact_with_a_wall(kind, share):
    world = wall_world(kind)
    f = flat(world)
    x0, y0, nx, ny, nn, length = world.seen
    f.n, line = 1, (1, x0, y0, nx, ny, world.r * length, nn, False)
    f.lines = lambda i: (line,)
    flying.walls(f, 0, [line], ())
    ((time, _, i, wall, _, _, wait, graze),) = f.heap
    assert (i, wall, graze) == (0, 1, False)
    state = at_wall(ReplayState(scene_with_wall(), world), world)
    f.share = state.share = share and world.number(share)
    state = steps_of(state, FACE, (0,))
    assert time == state.instant
    flying.rebound(f, 0, 1, time, wait)
    assert f.flights[0][:5] == state.bodies[0].flight[:5]


@pytest.mark.parametrize("inside", [True, False])
@pytest.mark.parametrize("kind", WALLS)
def test_the_flat_loop_meets_a_face_where_the_general_one_does(kind, inside):
    """As it does a wall, if both `face_foot` are positive; from behind it does not."""
    world = wall_world(kind)
    x0, y0, nx, ny, nn, length = slid(world, inside)
    state = at_wall(ReplayState(scene_with_wall(), world), world)
    assert all(state.face_foot(FACE, far).near > 0 for far in (False, True)) is inside
    f = flat(world)
    f.n, line = 1, (1, x0, y0, nx, ny, world.r * length, nn, True)
    flying.walls(f, 0, [line], ())
    assert [entry[0] for entry in f.heap] == [hit_of(world, FACE, (0,)).instant] * inside
    behind = flat(world)
    behind.n, far = 1, 100 * world.one
    flying.walls(behind, 0, [(1, x0 + far * nx, y0 + far * ny, *line[3:])], ())
    assert behind.heap == []


def test_the_game_engine_s_time_into_a_pocket_is_that_of_a_hit(monkeypatch):
    world = two(0)
    monkeypatch.setattr(pockets, "math", stub(sqrt=root_of))
    w = world
    wait = pockets.time_to_enter(w.dx, w.dy, w.vx, w.vy, w.R)
    root = world.root(formulas.pair_discriminant(w.dx, w.dy, w.vx, w.vy, w.R))
    approach = formulas.pair_approach(w.dx, w.dy, w.vx, w.vy)
    assert wait == formulas.pair_hit_time(formulas.pair_gap(w.dx, w.dy, w.R), approach, root)


def test_flights_between_knots_are_those_of_the_law():
    """Of engines that take nothing from the exact ones, so that they call no formula of the laws."""
    w = World(t=1.0, x=2.0, y=3.0, vx=0.5, vy=0.25)
    told = DoubleMotion([[(w.t, w.x, w.y, w.vx, w.vy)]]).state(3.0)
    lag = 3 - w.t
    assert told == [(formulas.advance(w.x, w.vx, lag), formulas.advance(w.y, w.vy, lag), w.vx, w.vy)]


def test_flights_sampled_all_at_once_are_those_of_the_law(monkeypatch):
    """Of the knot that holds at each time, which is the last up to it."""
    w = World(t=1.0, x=2.0, y=3.0, vx=0.5, vy=0.25, s=2.0, p=4.0, q=5.0, wx=-0.5, wy=0.75)
    empty = np.empty
    monkeypatch.setattr(np, "float64", object)
    monkeypatch.setattr(np, "empty", lambda shape: empty(shape, dtype=object))
    motion = DoubleMotion([[(w.t, w.x, w.y, w.vx, w.vy), (w.s, w.p, w.q, w.wx, w.wy)]])
    for time, (t, x, y, vx, vy) in ((1.5, motion.knots[0][0]), (2.0, motion.knots[0][1]), (3.0, motion.knots[0][1])):
        lag = time - t
        expected = [formulas.advance(x, vx, lag), formulas.advance(y, vy, lag), vx, vy]
        assert motion.sample([time])[0, 0].tolist() == expected
