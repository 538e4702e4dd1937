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


RIGHT, OBTUSE = ("1", "0"), ("4/5", "3/5")
"""From the striker's centre to the disc that it meets at t = 3, as it meets the peg below it."""


def told_together(e: str, line: tuple[str, str], first: int, wrong: int | None = None, by: float = 1.0) -> bool | None:
    """What the audit says of an engine that takes two contacts of one instant in an order, and tells them together.

    Args:
        line: to the disc.
        first: 1 where it begins with the peg, 2 with the disc.
        wrong: the contact whose pushes are `by` times what they should be.
    """
    striker = Circle("-6", "3", vx=2, vy=-1, m=2, id="striker")
    peg = Circle(0, -2, m="oo", id="peg")
    disc = Circle(f"2*{line[0]}-3/2", f"2*{line[1]}+1/2", vx="1/2", vy="-1/6", m=3, id="disc")
    scene = Scene([striker, peg, disc], restitution=e)
    speeds, weights = np.array([[2.0, -1.0], [0.0, 0.0], [0.5, -1 / 6]]), (1 / 2, 0.0, 1 / 3)
    towards = np.array([float(scene.circles[2].x) + 1.5, float(scene.circles[2].y) - 0.5])
    normals = {1: np.array([0.0, -1.0]), 2: towards / 2}
    told: list[tuple[str, str]] = []
    other = first
    while (opening := float((speeds[other] - speeds[0]) @ normals[other])) < -1e-12 or len(told) < 2:
        if opening < -1e-12:
            push = -(1 + float(scene.restitution)) * opening / (weights[0] + weights[other])
            push *= by if other == wrong else 1.0
            speeds[0] -= weights[0] * push * normals[other]
            speeds[other] += weights[other] * push * normals[other]
            told.append(("striker", str(scene.ids[other])))
        other = 3 - other
    recording = Recording(scene, "log")
    rows = {"striker": (0.0, 0.0, *map(float, speeds[0])), "disc": (*map(float, towards), *map(float, speeds[2]))}
    recording.hits(3.0, told, rows)
    recording.end(3.0)
    engine = LogEngine(recording)
    return audit_run(engine.run(scene), engine).kept


@pytest.mark.parametrize("first", [1, 2])
@pytest.mark.parametrize("e", ["1", "9/10", "1/2", "1/50", "0"])
def test_pushes_at_right_angles_are_each_that_of_a_contact_alone(e: str, first: int) -> None:
    """Told together, they may not take more of the energy than restitution does, nor less, nor one for the other."""
    assert told_together(e, RIGHT, first) is True
    for contact in (1, 2):
        for by in (0.99, 1.01):
            assert told_together(e, RIGHT, first, contact, by) is False, (contact, by)


@pytest.mark.parametrize(("e", "first", "off"), [("1", 1, 0.1), ("1", 2, 0.1), ("9/10", 2, 0.2), ("1/2", 1, 0.5)])
def test_at_other_angles_pushes_and_energy_are_within_what_orders_make_of_them(e: str, first: int, off: float) -> None:
    assert told_together(e, OBTUSE, first) is True
    for contact in (1, 2):
        for by in (1 - off, 1 + off):
            assert told_together(e, OBTUSE, first, contact, by) is False, (contact, by)
