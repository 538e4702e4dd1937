"""Walls that fall, faces and pegs in doubles: what is said is true of every state that its doubles may stand for.

Each double is given as far off as it may be, two units, one way or the other. So bounds that are ten times too small
are found, one by one, as are signs that are wrong: see the planted faults.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator
from fractions import Fraction as Q
from random import Random
from typing import Any, NamedTuple

from flint import arb
from quartic_referee import first_fall

from truebreak.exact.certified import filtered_falls
from truebreak.exact.certified.filtered_falls import FloatFall, FloatPeg, fall_in_doubles, peg_in_doubles
from truebreak.exact.replay.contact import Body, Flight

U = Q(1, 2**53)
ROOM = Q(195, 100)
"""How many units doubles are off, before they are rounded."""


def off(rng: Random, number: Q) -> float:
    """A double as far from a number as it may be."""
    return float(number * (1 + rng.choice([-1, 1]) * ROOM * U * Q(1, 2)) * (1 + rng.choice([-1, 1]) * U * Q(45, 100)))


def root(number: Q, bits: int = 600) -> Q:
    """A square root, from below, to so many bits."""
    scale = 1 << bits
    return Q(math.isqrt(number.numerator * scale * scale // number.denominator), scale)


def some(rng: Random, most: int = 8) -> Q:
    return Q(rng.randint(-most * 1009, most * 1009), rng.choice([1009, 1013, 997]))


def faint(rng: Random) -> Q:
    """Next to nothing, from what doubles do not tell to what they do."""
    return rng.choice([-1, 1]) * Q(1, 2 ** rng.randint(30, 60))


# -- Walls and faces.


class Case(NamedTuple):
    """A circle and a wall at the clock t: exact numbers. The flight begins `late` after the clock."""

    x: Q
    y: Q
    vx: Q
    vy: Q
    t: Q
    late: Q
    x0: Q
    y0: Q
    nx: Q
    ny: Q
    offset: Q
    half: Q
    drift: Q
    bend: Q
    is_face: bool
    stands: bool

    def gap(self) -> tuple[Q, Q, Q]:
        """The gap as a polynomial of the time from the clock."""
        reached = self.nx * (self.x - self.x0) + self.ny * (self.y - self.y0) - self.offset
        sunk = (self.half * self.t - self.drift) * self.t
        return (
            reached + sunk,
            self.nx * self.vx + self.ny * self.vy + 2 * self.half * self.t - self.drift,
            self.half,
        )

    def foot(self) -> tuple[Q, Q, Q]:
        """Where along the face it is, likewise."""
        along = (self.x - self.x0) * self.ny - (self.y - self.y0) * self.nx + self.bend * self.t**2
        return along, self.vx * self.ny - self.vy * self.nx + 2 * self.bend * self.t, self.bend

    def meeting(self) -> Q | None:
        """The time of the meeting, by high-school algebra, to hundreds of bits."""
        g, a, k = self.gap()
        now = a + 2 * k * self.late
        if self.stands:
            if k >= 0:
                return None
            wait = self.late - now / k
        elif k == 0:
            if a >= 0 or g <= 0:
                return None
            wait = -g / a
        else:
            disc = a * a - 4 * g * k
            if disc <= 0:
                return None
            wait = (-a - root(disc)) / (2 * k)
        if wait <= self.late or (k > 0 and now >= 0):
            return None
        if self.is_face:
            along, slide, bend = self.foot()
            place = along + (slide + bend * wait) * wait
            if not 0 < place < self.nx**2 + self.ny**2:
                return None
        return self.t + wait


def drawn_case(rng: Random) -> Case | None:
    """A case; often a graze, a touch, or a foot beside an end."""
    is_face, stands = rng.random() < 0.5, rng.random() < 0.2
    far = rng.choice([1, 1, 30])
    c = Case(
        *(some(rng) for _ in range(4)),
        abs(some(rng)) * far,
        rng.choice([Q(0), Q(0), faint(rng), faint(rng) * Q(1, 2**60)]),
        *(some(rng) for _ in range(4)),
        abs(some(rng, 1)),
        rng.choice([Q(0), some(rng, 2), some(rng, 2)]),
        Q(0) if is_face or rng.random() < 0.5 else some(rng, 2),
        some(rng, 2) if is_face else Q(0),
        is_face,
        stands,
    )
    if not c.nx and not c.ny:
        return None
    g, a, k = c.gap()
    kind = rng.choice(["free", "graze", "touch", "slow", "end"])
    if stands:  # the gap is 0 at the instant
        c = c._replace(offset=c.offset + g + a * c.late + k * c.late**2)
    elif kind == "graze" and k:
        c = c._replace(offset=c.offset + g - (a * a / (4 * k)) * (1 + faint(rng)))
    elif kind == "touch":
        c = c._replace(offset=c.offset + g - faint(rng) * rng.choice([1, 2**20]))
    elif kind == "slow":
        n = c.nx if c.nx else c.ny
        shift = (a - faint(rng)) / n
        c = c._replace(vx=c.vx - shift) if c.nx else c._replace(vy=c.vy - shift)
    elif kind == "end" and is_face and (when := c._replace(is_face=False).meeting()) is not None:
        along, slide, bend = c.foot()
        wait, nn = when - c.t, c.nx**2 + c.ny**2
        by = Q(
            round(((along + (slide + bend * wait) * wait) / nn - rng.choice([0, 1]) * (1 + faint(rng))) * 2**80), 2**80
        )
        c = c._replace(x0=c.x0 + by * c.ny, y0=c.y0 - by * c.nx)
    g, a, k = c.gap()
    if c.stands:
        return c if a + 2 * k * c.late > 0 else None
    return c if is_face or g + a * c.late + k * c.late**2 > 0 else None


def judged(case: Case, rng: Random, fall: Callable[..., Any]) -> str:
    """What doubles say of a case; `wrong` where that is not so."""
    x, y, vx, vy, t, x0, y0, nx, ny, offset, half, drift, bend = (
        off(rng, number) for number in (*case[:5], *case[6:14])
    )
    late = float(abs(case.late)) * (1 + 2.0**-50)
    norm = abs(nx) + abs(ny)
    size = norm * (abs(x0) + abs(y0)) + abs(offset)
    line = FloatFall(7, -1, case.is_face, x0, y0, nx, ny, offset, norm, size, half, drift, bend)
    unit = filtered_falls.UNIT
    flat, far = 16 * unit * max(abs(vx), abs(vy)), 32 * unit * max(abs(x), abs(y))
    told, truth = fall((x, y, vx, vy, t, late), line, flat, far, case.stands), case.meeting()
    if told is True:
        return "unclear"
    if told is False:
        return "none" if truth is None else "wrong"
    return "met" if truth is not None and Q(told[0]) <= truth <= Q(told[1]) else "wrong"


def cases(seed: str, count: int) -> Iterator[tuple[Case, Random]]:
    rng = Random(seed)
    for _ in range(count):
        case = drawn_case(rng)
        if case is not None:
            yield case, rng


def test_what_is_said_of_walls_and_faces_is_true() -> None:
    found = Counter(judged(case, rng, fall_in_doubles) for case, rng in cases("walls", 5_000))
    assert found["wrong"] == 0
    assert min(found["met"], found["none"]) > 300
    assert found["unclear"] < 0.4 * found.total()


def test_of_plain_cases_nothing_is_unclear() -> None:
    """A filter that said nothing would be true, and of no use."""
    plain = [
        (c, rng) for c, rng in cases("plain", 4_000) if c.late == 0 and all(abs(g) > Q(1, 1000) for g in c.gap()[:2])
    ]
    found = Counter(judged(case, rng, fall_in_doubles) for case, rng in plain if not case.stands)
    assert found["unclear"] < 0.25 * found.total()


# -- Circles that stand.


class PegCase(NamedTuple):
    """A circle and one that stands at the clock t: exact numbers; X and V are those of the falling frame."""

    x: Q
    y: Q
    vx: Q
    vy: Q
    t: Q
    late: Q
    px: Q
    py: Q
    reach: Q
    hx: Q
    hy: Q
    stood: bool

    def gap(self) -> list[Q]:
        """The gap as a polynomial of the time from the instant."""
        t = self.t + self.late
        ex, ey = (
            self.x + self.vx * self.late - self.px + self.hx * t**2,
            self.y + self.vy * self.late - self.py + self.hy * t**2,
        )
        ux, uy = self.vx + 2 * self.hx * t, self.vy + 2 * self.hy * t
        return [
            ex * ex + ey * ey - self.reach**2,
            2 * (ex * ux + ey * uy),
            ux * ux + uy * uy + 2 * (ex * self.hx + ey * self.hy),
            2 * (ux * self.hx + uy * self.hy),
            self.hx**2 + self.hy**2,
        ]


def drawn_peg(rng: Random) -> PegCase | None:
    c = PegCase(
        *(some(rng) for _ in range(4)),
        abs(some(rng)),
        rng.choice([Q(0), Q(0), faint(rng) * Q(1, 2**20)]),
        some(rng),
        some(rng),
        abs(some(rng, 2)) + Q(1, 8),
        rng.choice([Q(0), some(rng, 1)]),
        -abs(some(rng, 2)) - Q(1, 100),
        False,
    )
    kind = rng.choice(["free", "aimed", "graze", "touch", "stood"])
    p = c.gap()
    if kind in ("aimed", "graze"):
        s = abs(some(rng, 3)) + Q(1, 50)
        t = c.t + c.late
        x, y = c.x + c.vx * (c.late + s) + c.hx * (t + s) ** 2, c.y + c.vy * (c.late + s) + c.hy * (t + s) ** 2
        ux, uy = c.vx + 2 * c.hx * (t + s), c.vy + 2 * c.hy * (t + s)
        if not ux and not uy:
            return None
        speed = root(ux * ux + uy * uy, 200)
        away = c.reach * (1 + faint(rng)) if kind == "graze" else c.reach * Q(rng.randint(0, 99), 100)
        c = c._replace(px=x - uy / speed * away, py=y + ux / speed * away)
    elif kind == "touch":
        far = root(p[0] + c.reach**2, 200)
        c = c._replace(reach=far * (1 - abs(faint(rng))))
    elif kind == "stood":
        scale = 2**20
        a, b = rng.randint(-scale, scale), rng.randint(1, scale)
        ux, uy = Q(2 * a * b, a * a + b * b), Q(b * b - a * a, a * a + b * b)
        t = c.t + c.late
        px = c.x + c.vx * c.late + c.hx * t**2 - c.reach * ux
        c = c._replace(px=px, py=c.y + c.vy * c.late + c.hy * t**2 - c.reach * uy, stood=True)
    p = c.gap()
    if c.reach <= 0 or (p[1] <= 0 if c.stood else p[0] <= 0):
        return None
    return c


def judged_peg(case: PegCase, rng: Random, fall: Callable[..., Any]) -> str:
    """As `judged`."""
    x, y, vx, vy, t, px, py, reach, hx, hy = (off(rng, number) for number in (*case[:5], *case[6:11]))
    late = float(abs(case.late)) * (1 + 2.0**-50)
    body = Body(3, Flight(*[arb(0)] * 6), arb(1), arb(0))
    told = fall((x, y, vx, vy, t, late), FloatPeg(body, px, py, reach, hx, hy), math.inf, case.stood)
    if told is True:
        return "unclear"
    p = case.gap()[1:] if case.stood else case.gap()
    truth = first_fall(p, Q(1, 2**150))
    if told is False:
        return "none" if truth is None else "wrong"
    if truth is None:
        return "wrong"
    begun = case.t + case.late
    return "met" if Q(told[0]) <= begun + truth[0] and begun + truth[1] <= Q(told[1]) else "wrong"


def pegs(seed: str, count: int) -> Iterator[tuple[PegCase, Random]]:
    rng = Random(seed)
    for _ in range(count):
        case = drawn_peg(rng)
        if case is not None:
            yield case, rng


def test_what_is_said_of_pegs_is_true() -> None:
    found = Counter(judged_peg(case, rng, peg_in_doubles) for case, rng in pegs("pegs", 1_200))
    assert found["wrong"] == 0
    assert min(found["met"], found["none"]) > 200
    assert found["unclear"] < 0.4 * found.total()


def test_a_peg_that_the_flight_ends_before_is_none() -> None:
    body = Body(3, Flight(*[arb(0)] * 6), arb(1), arb(0))
    peg = FloatPeg(body, 0.0, 0.0, 1.0, 0.0, -0.5)
    low, high = peg_in_doubles((0.0, 3.0, 0.0, 0.0, 0.0, 0.0), peg, math.inf, False)
    assert low < 2.0 < high < low + 1e-12
    assert peg_in_doubles((0.0, 3.0, 0.0, 0.0, 0.0, 0.0), peg, 1.0, False) is False
    assert peg_in_doubles((0.0, 3.0, 0.0, 0.0, 4.0, 0.0), peg, 3.5, False) is False
