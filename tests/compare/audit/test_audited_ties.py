"""Audits where a disc meets two things at one instant, of engines that find both contacts over one long flight."""

from __future__ import annotations

import math

import numpy as np
import pytest

from truebreak.compare.audit.audit import audit_run
from truebreak.compare.foreign import LogEngine, Recording
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Scene, Wall

LONG = [("38", ("-4", "8/7")), ("100/7", ("-3", "11/7")), ("1000/3", ("-1", "1/3"))]


def onto_two_pegs(time: str, velocity: tuple[str, str]) -> Scene:
    """A small disc that meets two pegs at right angles after a long flight."""
    vx, vy = velocity
    ball = Circle(f"-3-({vx})*{time}", f"-58/7-({vy})*{time}", "1/10", vx, vy, id="ball")
    one = Circle("-3-(1/10+1)*3/5", "-58/7+(1/10+1)*4/5", 1, m="oo", id="a")
    other = Circle("-3-(1/10+1/50)*4/5", "-58/7-(1/10+1/50)*3/5", "1/50", m="oo", id="b")
    return Scene([ball, one, other])


def textbook(scene: Scene, off: float = 0.0) -> LogEngine:
    """The log of an engine that finds both contacts at the start: the second is told where the first left the disc.

    Args:
        off: how far beside where it is the disc is said to be at the second.
    """
    ball, *pegs = scene.circles
    place, speed = np.array([float(ball.x), float(ball.y)]), np.array([float(ball.vx), float(ball.vy)])
    found = []
    for peg in pegs:
        apart, reach = np.array([float(peg.x), float(peg.y)]) - place, float(peg.r) + float(ball.r)
        b, a, c = float(apart @ speed), float(speed @ speed), float(apart @ apart) - reach * reach
        found.append(((b - math.sqrt(max(0.0, b * b - a * c))) / a, peg))
    recording, now = Recording(scene, "log"), 0.0
    for time, peg in sorted(found, key=lambda pair: pair[0]):
        when = now or time  # what is in touch by rounding collides at once
        place = place + speed * (when - now) + (off if now else 0.0)
        now = when
        normal = np.array([float(peg.x), float(peg.y)]) - place
        normal /= math.hypot(*normal)
        speed = speed - 2.0 * float(speed @ normal) * normal
        recording.hit(now, "ball", str(peg.id), {"ball": [*map(float, place), *map(float, speed)]})
    recording.end(now + 1.0)
    return LogEngine(recording)


@pytest.mark.parametrize(("time", "velocity"), LONG)
def test_the_second_contact_of_an_instant_may_be_found_before_the_first(time: str, velocity: tuple[str, str]) -> None:
    """16 u (D^2 / R + R) is granted to its gap over the flight before both; no more than that."""
    scene = onto_two_pegs(time, velocity)
    engine = textbook(scene)
    audit = audit_run(engine.run(scene), engine)
    assert audit.kept and audit.impacts == 2, audit.sentence
    engine = textbook(scene, 1e-8)
    assert audit_run(engine.run(scene), engine).kept is False


@pytest.mark.parametrize("e", ["1/2", "1/10"])
def test_speeds_whose_squares_are_below_all_numbers_are_audited_as_others(e: str) -> None:
    """A room for an impulse was below 0 there, and a sample's divided by 0."""
    walls = [Wall(0, 0, 7, 1, id="a"), Wall(0, 0, 2, 7, id="b"), Wall(0, 30, 1, 30, id="n"), Wall(30, 0, 30, 1, id="e")]
    scene = Scene([Circle(3, "5/3", "1/3", "2/3", "-5/3", id="ball")], walls, restitution=e)
    run = DoubleEngine().run(scene, events=1500)
    audit = audit_run(run, DoubleEngine())
    assert audit.kept, audit.sentence
