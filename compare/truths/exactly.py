"""Published numbers that a certified run gives exactly: items whose statement is one of exact motion."""

from __future__ import annotations

import math
from itertools import takewhile

from ...exact.engine import ExactEngine
from ...exact.numbers import ball
from ...exact.policies.all_orders import all_orders
from ...exact.results.growth import certified_growth
from ...scenarios import catalogue
from ...scenarios.catalogue.scenes.billiards import CHALLENGE, PINBALL
from ...scenarios.catalogue.scenes.impacts import EE_AND_LEE, MURPHY
from .truth import OURS, Measured, NotReproduced, Truth, near, same

SIAM_DIGITS = "0.9952629194433541608903118094267216210294669227341543498032088580729861796228306"

GALPERIN = "G. Galperin, Playing pool with pi, Regular and Chaotic Dynamics 8 (2003), 375"
IMAGES = "the method of images"
LEE = "E. A. Lee, Fundamental limits of cyber-physical systems modeling, ACM Trans. Cyber-Phys. Syst. 1 (2016), 3"


def siam(t: int = 10, digits: int = 79) -> str:
    """The photon's distance from the origin at time t, to so many decimals, cut off.

    >>> siam(10, 12)
    '0.995262919443'
    """
    run = ExactEngine().run(catalogue.build("siam", t=t))
    photon = run.final["photon"]
    bits = int((digits + 10) * math.log2(10)) + 64
    with ball.precision(bits):
        x, y = photon.x.ball(bits), photon.y.ball(bits)
        text = (x * x + y * y).sqrt().str(digits + 5, radius=False)
    whole, _, decimals = text.partition(".")
    return f"{whole}.{decimals[:digits]}"


def _siam() -> Measured:
    return same(siam(digits=len(SIAM_DIGITS) - 2), SIAM_DIGITS)


def _galperin() -> Measured:
    counts = [ExactEngine().run(catalogue.build("galperin", n=n)).collisions for n in range(4)]
    return same(", ".join(map(str, counts)), "3, 31, 314, 3141")


def _magic() -> Measured:
    outcomes = []
    for a in ("1", "sqrt(2) - 1", "sqrt(5) - 2", "1/2", "1/5"):
        tree = all_orders(ExactEngine(), catalogue.build("magic-masses", a=a))
        if not tree.complete:
            raise NotReproduced(f"not all orders were followed for a = {a}")
        outcomes.append(str(len(tree.outcomes)))
    return same(", ".join(outcomes), "1, 1, 1, 2, 2")


def _whole_momentum() -> Measured:
    run = ExactEngine().run(catalogue.build("magic-masses:start=one"))
    ends = ", ".join(str(circle.vx.text()) for circle in run.final.circles)
    return same(f"{run.collisions} collisions, then {ends}", "4 collisions, then 0, 0, 1")


def _free(n: int, collisions: int) -> Measured:
    run = ExactEngine().run(catalogue.build("free-discs", n=n))
    if run.stop.reason.name != "QUIET":
        raise NotReproduced(f"the run is not over: {run.stop.message}")
    return same(str(run.collisions), str(collisions))


def multiplier(scene: str, bounces: int = 40) -> float:
    """The factor by which one bounce more lengthens the worst displacement, along an unstable periodic orbit."""
    run = ExactEngine().run(catalogue.build(scene), events=bounces + 1)
    one, two = (certified_growth(run, events) for events in (bounces, bounces + 1))
    return 2.0 ** ((two.low + two.high - one.low - one.high) / 2)


def _two_discs() -> Measured:
    return near(multiplier("pinball:r=0"), 5 + 2 * math.sqrt(6), 1e-9, 11)


def _triangle() -> Measured:
    return near(multiplier("pinball:discs=3,r=0"), 11.771455196385560606, 1e-9, 11)


def _lee() -> Measured:
    outcomes = all_orders(ExactEngine(), catalogue.build("lee")).outcomes
    ends = sorted(", ".join(str(c.vx.text()) for c in outcome.trajectory.final.circles) for outcome in outcomes)
    return same("; ".join(ends), "-11/5, -8/25, -3/25; -8/5, -39/25, 1/25")


def _corner() -> Measured:
    counts = []
    for angle in (90, 60, 45, 36):
        run = ExactEngine().run(catalogue.build(f"corner:angle={angle},skew=1/10,tie=sequential"))
        impulses = [pair.second for event in run.events for pair in event.impulses]
        counts.append(str(len(list(takewhile(lambda wall: wall != "end", impulses)))))
    return same(", ".join(counts), "2, 3, 4, 5")


EXACT = (
    Truth("SIAM 100-Digit Challenge, problem 2: distance at t = 10", SIAM_DIGITS, CHALLENGE, "truebreak run siam",
          _siam),
    Truth("Galperin: collisions for a mass ratio of 100**n, n = 0 to 3", "3, 31, 314, 3141", GALPERIN,
          "truebreak run galperin:n=2", _galperin),
    Truth("Masses 1, a, 1: outcomes of all orders for a = 1/cos(pi/k) - 1, k = 3, 4, 5, and for a = 1/2, 1/5",
          "1, 1, 1, 2, 2", EE_AND_LEE, "truebreak orders magic-masses", _magic),
    Truth("Masses 1, sqrt(5) - 2, 1: one ball hands on all of its momentum", "4 collisions, then 0, 0, 1",
          OURS, "truebreak run magic-masses:start=one --exact", _whole_momentum),
    Truth("Three equal discs in the open: collisions of a witness", "4", MURPHY, "truebreak run free-discs",
          lambda: _free(3, 4)),
    Truth("Four equal discs in the open: collisions of a witness", "10", OURS,
          "truebreak run free-discs:n=4", lambda: _free(4, 10)),
    Truth("Two fixed discs at distance 6: multiplier of a bounce, 5 + 2 sqrt(6)", "9.8989794856", PINBALL,
          "truebreak chaos pinball:r=0", _two_discs),
    Truth("Three fixed discs at distance 6: multiplier of a bounce on the triangle", "11.771455196385560606", PINBALL,
          "truebreak chaos pinball:discs=3,r=0", _triangle),
    Truth("Lee's three balls: final velocities under both orders", "-11/5, -8/25, -3/25; -8/5, -39/25, 1/25", LEE,
          "truebreak orders lee", _lee),
    Truth("Corner of pi/n: bounces for n = 2, 3, 4, 5", "2, 3, 4, 5", IMAGES,
          "truebreak run corner:angle=60,skew=1/10,tie=sequential", _corner),
)  # fmt: skip
"""Items that hold exactly, or to the last digit of a double."""
