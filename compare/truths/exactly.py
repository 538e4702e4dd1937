"""Published numbers that a certified run gives exactly: items whose statement is one of exact motion."""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cache
from itertools import takewhile

from ...exact.exact_engine import ExactEngine
from ...exact.numbers import ball
from ...scenarios import catalogue
from ...scenarios.catalogue.article import EE_AND_LEE, MURPHY
from ...scenarios.catalogue.billiards import CHALLENGE, PINBALL
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.settings import TiePolicy
from ...scenarios.things import Circle, Wall
from ..orders.all_orders import all_orders
from ..repeller.expansion import ladder, settled
from ..repeller.orbits import BITS, orbit, pinball
from ..tangent.growth import certified_growth
from .truth import OURS, Measured, NotReproduced, Truth, near, only, same

SIAM_DIGITS = "0.9952629194433541608903118094267216210294669227341543498032088580729861796228306"

ESCAPE_RATE = "0.4103384077693464893384613078192"

LETTERS = 12
"""Cycles of so many bounces settle the escape rate of three discs at distance 6 to more digits than are published."""

REPELLER = "python -m truebreak.compare.repeller"
CHAOSBOOK = (
    "P. Cvitanovic and others, ChaosBook (recalled); the method: P. Cvitanovic, B. Eckhardt, Symmetry decomposition of "
    "chaotic dynamics, Nonlinearity 6 (1993), 277"
)
GALPERIN = "G. Galperin, Playing pool with pi, Regular and Chaotic Dynamics 8 (2003), 375"
IMAGES = "the method of images"
ONTO_TWO = "-1/5, 0; 3/5, 1/5*sqrt(3); 3/5, -1/5*sqrt(3) / -1/8, -1/8*sqrt(3); 3/4, 1/4*sqrt(3); 3/8, -1/8*sqrt(3)"
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


def _ratios() -> Measured:
    counts = []
    for ratio in (2, 3, 5, 7, 10, 50):
        circles = [Circle(2, 0, id="small"), Circle(6, 0, r=2, vx=-1, m=ratio, id="big")]
        counts.append(ExactEngine().run(Scene(circles, [Wall(0, 0, 0, 1)])).collisions)
    return same(", ".join(map(str, counts)), "5, 5, 7, 8, 10, 22")


def _onto_two() -> Measured:
    far = Quantity.of("3 + sqrt(3)")
    circles = [Circle(0, 0, vx=1, id="cue"), Circle(far, 1, id="up"), Circle(far, -1, id="down")]
    told: list[str] = []
    for policy in (TiePolicy(), TiePolicy("sequential")):
        run = ExactEngine().run(Scene(circles, tie_policy=policy), events=1)
        told.append("; ".join(f"{c.vx.text()}, {c.vy.text()}" for c in run.final.circles))
    return same(" / ".join(told), ONTO_TWO)


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
    told = orbit(pinball(Quantity.of(6)), "1")
    with ball.precision(BITS):
        return same(abs(told.multiplier).str(20, radius=False), "11.771455196385560606")


@cache
def _repeller() -> dict[str, str]:
    """Digits of the repeller's averages, cut off where the last two orders of the cycle expansion part."""
    *_, before, told = ladder(Quantity.of(6), LETTERS)
    return {name: settled(getattr(before, name), getattr(told, name)) for name in ("escape", "exponent", "entropy")}


def _averages(name: str, published: str) -> Measured:
    """Every published digit; the last may be rounded."""
    ours = _repeller()[name]
    digits = len(published) - 2
    if len(ours) <= len(published):
        raise NotReproduced(f"{ours} has fewer digits than {published}")
    same(str(round(Fraction(ours), digits)), str(Fraction(published)))
    return ours, "none"


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
    Truth("SIAM 100-Digit Challenge, problem 2: distance at t = 10", SIAM_DIGITS, CHALLENGE, only("100-Digit"),
          _siam),
    Truth("Galperin: collisions for a mass ratio of 100**n, n = 0 to 3", "3, 31, 314, 3141", GALPERIN,
          "truebreak run galperin:n=2", _galperin),
    Truth("Collisions for mass ratios 2, 3, 5, 7, 10, 50: ceil(pi/arctan(1/sqrt(ratio))) - 1", "5, 5, 7, 8, 10, 22",
          f"{GALPERIN} (recalled)", only("mass ratios"), _ratios),
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
          only("bounce on the triangle"), _triangle),
    Truth("Three fixed discs at distance 6: escape rate, by cycle expansion", ESCAPE_RATE, CHAOSBOOK, REPELLER,
          lambda: _averages("escape", ESCAPE_RATE)),
    Truth("Three fixed discs at distance 6: mean Lyapunov exponent of the repeller", "0.5775525788", OURS, REPELLER,
          lambda: _averages("exponent", "0.5775525788")),
    Truth("Three fixed discs at distance 6: entropy, the exponent less the escape rate", "0.1672141710", OURS, REPELLER,
          lambda: _averages("entropy", "0.1672141710")),
    Truth("Lee's three balls: final velocities under both orders", "-11/5, -8/25, -3/25; -8/5, -39/25, 1/25", LEE,
          "truebreak orders lee", _lee),
    Truth("A ball onto two that touch: velocities, simultaneous / sequential", ONTO_TWO, OURS, only("onto two"),
          _onto_two),
    Truth("Corner of pi/n: bounces for n = 2, 3, 4, 5", "2, 3, 4, 5", IMAGES,
          "truebreak run corner:angle=60,skew=1/10,tie=sequential", _corner),
)  # fmt: skip
"""Items that hold exactly, or to the last digit of a double."""
