"""A contact alone, carried out in one go, comes to what its two steps come to."""

from __future__ import annotations

import pytest

from truebreak.exact import ExactEngine
from truebreak.exact.numbers import ball
from truebreak.exact.replay import centred_state
from truebreak.exact.replay.ball_state import BallState, LoneContacts
from truebreak.exact.replay.centred_state import CentredState, LoneCentred
from truebreak.exact.replay.deviations import _landed
from truebreak.exact.replay.state import Go, Kick
from truebreak.scenarios import Circle, catalogue

FEW, MANY = 500, 4096


@pytest.mark.parametrize("clocks", ["of all bits", "short"])
def test_a_contact_in_one_go_is_in_its_balls_too(scene, clocks, request, monkeypatch):
    """Contacts that stand alone, of circles that move, are carried out in one go where there is a set: every number and
    every instant holds the truth, and is known to nearly as many bits as by the two steps. So they are with the clocks
    of long numbers, which stand beside their instants."""
    if clocks == "short":
        monkeypatch.setattr(centred_state, "LONG_NUMBERS", 0)
    steps = ExactEngine().run(scene, events=150).motion.log.steps
    with ball.precision(MANY):
        true = BallState(scene)
    with ball.precision(FEW):
        ours, plain = CentredState(scene), CentredState(scene)
    lone, struck, k = LoneCentred(ours), 0, 0
    for body in ours.bodies.values():
        body.acc = FEW
    while k < len(steps):
        step, after = steps[k], steps[k + 1] if k + 1 < len(steps) else None
        count = 2 if isinstance(step, Go) and isinstance(after, Kick) and after.links == (step.source,) else 1
        for state, bits in ((plain, FEW), (true, MANY)):
            ball.use_bits(bits)
            for each in steps[k : k + count]:
                state.do(each)
        accuracy = lone.strike(after.links[0], FEW, k) if count == 2 else None
        if accuracy is None:
            ball.use_bits(FEW)
            ours.steps_done = k
            for each in steps[k : k + count]:
                ours.do(each)
        else:
            struck += 1
            clock = ours.bodies[after.links[0].circles[0]].flight.t
            assert (clock.bits() <= centred_state.CLOCK_BITS) is (clocks == "short") or clock.bits() < FEW // 2
            assert accuracy >= min(FEW, plain.instant.rel_accuracy_bits()) - 60
        k += count
        ball.use_bits(MANY)
        assert ours.instant.overlaps(true.instant)
        for mine, exact in zip(ours.bodies.values(), true.bodies.values(), strict=True):
            one, other = mine.flight, exact.flight
            lag = one.t - other.t
            assert (other.x + other.vx * lag - one.x).contains(0)
            assert (other.y + other.vy * lag - one.y).contains(0)
            assert (other.vx - one.vx).contains(0)
            assert (other.vy - one.vy).contains(0)
            if one.late is not None:
                assert (one.t + one.late).overlaps(true.bodies[mine.index].flight.instant)
    assert struck > len(steps) // 10 or "pinball" in request.node.name


def touched(state):
    """Of each circle that falls: what stands and was at gap zero as its flight began."""
    return {
        i: frozenset(link for link in links if state.on_peg(link))
        for i, (last, links) in state.contacts.items()
        if last == state.bodies[i].flight.last and any(state.on_peg(link) for link in links)
    }


@pytest.mark.parametrize("name", ["galton:e=1,rows=8,seed=3", "plinko", "gas:n=4,seed=2"])
def test_a_fall_onto_something_fixed_in_one_go_comes_to_what_its_two_steps_do(name):
    """Under gravity: on balls, every number of every body, and what is noted of touches, after each contact."""
    scene = catalogue.build(name)
    if name.startswith("gas"):
        post = Circle(1, 1, "1/2", m="oo", id="post")
        scene = scene.with_changes(until=None, gravity=(0, "-1/10"), circles=[post, *scene.circles])
    steps = ExactEngine().run(scene, events=80).motion.log.steps
    states = []
    for bits in (FEW, FEW, MANY):
        with ball.precision(bits):
            states.append(BallState(scene.surfaces))
    ours, plain, true = states
    lone, k, onto = LoneContacts(ours), 0, 0
    for body in ours.bodies.values():
        body.acc = FEW
    while k < len(steps):
        step, after = steps[k], steps[k + 1] if k + 1 < len(steps) else None
        count = 2 if isinstance(step, Go) and isinstance(after, Kick) and after.links == (step.source,) else 1
        for state, bits in ((plain, FEW), (true, MANY)):
            ball.use_bits(bits)
            state.steps_done = k
            for each in steps[k : k + count]:
                state.do(each)
        if count == 2:
            accuracy = lone.strike(after.links[0], FEW, k)
            if ours.stands and ours.on_peg(after.links[0]):
                onto += accuracy is not None
                assert accuracy is not None
                assert accuracy >= min(FEW, plain.instant.rel_accuracy_bits()) - 60
        if count == 1 or accuracy is None:
            ball.use_bits(FEW)
            ours.steps_done = k
            for each in steps[k : k + count]:
                ours.do(each)
        k += count
        ball.use_bits(MANY)
        assert ours.instant.overlaps(true.instant)
        assert touched(ours) == touched(plain) == touched(true)
        for mine, exact in zip(ours.bodies.values(), true.bodies.values(), strict=True):
            one, other = mine.flight, exact.flight
            lag = one.t - other.t
            for value, drift, speed in ((other.x - one.x, other.vx, one.vx), (other.y - one.y, other.vy, one.vy)):
                assert (value + drift * lag).contains(0)
                assert (drift - speed).contains(0)
            assert (one.last, one.rest) == (other.last, other.rest)
    assert onto > 3


def test_a_velocity_that_is_zero_in_its_midpoints_alone_is_no_rest():
    with ball.precision(FEW):
        state = CentredState(catalogue.build("gas:n=3,seed=2"))
        body, held = state.bodies[0], state._begin()
        state._deviations = held
        moved = ((body, body.flight.x, body.flight.y, ball.ZERO, ball.ZERO),)
        _, doubles = held.recentre(moved, body.flight.t, 1)
        carried = _landed(held, moved, doubles, 1.0, 0.0, ball.ZERO)
        lone = LoneCentred(state)
        lone._land(held, moved, carried, (ball.ZERO, ball.ZERO), 1, FEW)
    assert not body.flight.rest
    assert not body.flight.vx.is_zero()
    assert body.flight.vy.contains(0)
    assert lone.landed is not None
    assert lone.landed[0][2] is None
