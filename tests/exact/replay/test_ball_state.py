"""Laws of the ball machine: its enclosures hold the numbers of the plain machine, and lose few bits."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
from flint import arb, ctx

from truebreak.exact import ExactEngine
from truebreak.exact.exact_engine import ExactEngine as Engine
from truebreak.exact.numbers import ball
from truebreak.exact.replay.ball_state import BallState
from truebreak.exact.replay.contact import Pair
from truebreak.exact.replay.refinable import RefinableState
from truebreak.exact.replay.state import Go, Kick, ReplayState, replay
from truebreak.scenarios import Circle, Scene, Wall, catalogue


def states(machine, when):
    ctx.prec = 2000
    rows = []
    for body in machine.bodies.values():
        x, y, vx, vy, t, *_ = body.flight
        lag = arb(when) - t
        rows += [x + vx * lag, y + vy * lag, vx, vy]
    return rows


def slanted(seed: int, e: str = "1") -> Scene:
    draw = random.Random(seed)
    circles = [
        Circle(
            x=3 * k,
            y=f"{draw.randrange(-50, 50)}/100",
            vx=f"{draw.randrange(-99, 99)}/70",
            vy=f"{draw.randrange(-99, 99)}/70",
            m=f"{draw.randrange(1, 50)}/7",
        )
        for k in range(5)
    ]
    walls = [Wall(-9, -20, -8, 20), Wall(22, -20, 20, 20), Wall(-9, 9, 20, 11), Wall(-9, -10, 20, -8)]
    return Scene(circles, walls, restitution=e)


@pytest.mark.parametrize(
    "scene",
    [slanted(1), slanted(2), slanted(3, "9/10"), slanted(4, "1/5"), catalogue.build("gas:n=8,seed=5,mixed=yes")],
    ids=str,
)
def test_the_two_forms_enclose_the_same_numbers(scene):
    """The matrix and contact forms against the plain formulas, both in balls: the same log, overlapping states."""
    run = ExactEngine().run(scene, events=60)
    steps = run.motion.log.steps
    ctx.prec = 2000
    ours, plain = BallState(scene), ReplayState(scene, ball.BALLS)
    replay(ours, steps, range(len(steps)))
    ctx.prec = 2000
    replay(plain, steps, range(len(steps)))
    when = float(run.final_time) + 1
    for one, other in zip(states(ours, when), states(plain, when), strict=True):
        assert one.overlaps(other)
        assert one.rad() < arb(2) ** -1500
        assert other.rad() < arb(2) ** -1000


def test_it_loses_fewer_bits_than_the_plain_form():
    scene = catalogue.build("gas:n=10,seed=1")
    run = ExactEngine().run(scene, events=400)
    steps = run.motion.log.steps
    widths = []
    for make in (lambda: BallState(scene), lambda: ReplayState(scene, ball.BALLS)):
        ctx.prec = 2000
        machine = make()
        replay(machine, steps, range(len(steps)))
        widths.append(max(float(row.rad().log() / arb(2).log()) for row in states(machine, float(run.final_time))))
    assert widths[0] < widths[1] - 30


def test_galperin_loses_next_to_nothing():
    """In one dimension the contact form is exact, so no bits go: 3,141 collisions fit in the first precision."""
    run = Engine().run(catalogue.build("galperin:n=3"), events=4000)
    assert (run.collisions, run.plan["bits"]) == (3141, 256)


def late_starters(seed: int) -> Scene:
    """A circle from afar sends another head on into a wedge: no place is rounded before, every clock is."""
    draw = random.Random(seed)
    far, tip = 2 ** draw.choice([20, 30, 40]), 4 + Fraction(draw.randrange(1, 100), 101)
    floor = -Fraction(draw.randrange(200, 300), 103)
    circles = [Circle(x=-far, y=0, vx=1, vy=0), Circle(x=0, y=0, vx=0, vy=0)]
    return Scene(circles, [Wall(tip - 3, 3, tip + 3, -3), Wall(-9, floor, 20, floor)])


@pytest.mark.parametrize("bits", [64, 100, 200])
@pytest.mark.parametrize("seed", range(4))
def test_instants_of_few_bits_hold_those_of_many(seed, bits):
    """Also where a clock, of few bits at a late time, stands beside its instant by more than the instant's radius."""
    scene = late_starters(seed)
    steps = ExactEngine().run(scene, events=12).motion.log.steps

    def instants(precision):
        found = []
        ctx.prec = precision
        machine = BallState(scene)
        for step in steps:
            machine.do(step)
            found.append(machine.instant)
        return found

    for few, many in zip(instants(bits), instants(3000), strict=True):
        ctx.prec = 3000
        assert few.contains(many)


def test_more_bits_leave_exact_circles_where_they_are():
    """Balls of circles that are still exact are copied anew: they are not those of time 0."""
    state = RefinableState(Scene([Circle(0, 0, vx=1), Circle(4, 0), Circle(9, 9)]), 256)
    link = Pair(0, 1)
    state.do(Go(link, link))
    state.do(Kick((link,), (link,)))
    state.sync((0, 1, 2))
    before = [body.flight for body in state.bodies.values()]
    state.rise(512)
    assert state.exact == [True] * 3
    assert [body.flight for body in state.bodies.values()] == before
    assert [flight.rest for flight in before] == [True, False, True]
