"""Walls that fall, faces, pegs and arcs in doubles: what is said is true of every state that its doubles may stand for.

Each double is given as far off as it may be, two units, one way or the other; signs and terms that are wrong are
found: see the planted faults.
"""

from __future__ import annotations

import inspect
import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction as Q
from random import Random
from typing import Any, NamedTuple

import pytest
from flint import arb
from quartic_referee import falls, first_fall

from truebreak.exact.certified import filtered_arcs, filtered_falls
from truebreak.exact.certified.filtered_arcs import FallenSide, side_in_doubles, within_in_doubles
from truebreak.exact.certified.filtered_falls import FloatFall, FloatPeg, fall_in_doubles, peg_in_doubles, seen_from
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


WIDTH = Q(1, 2**110)
"""How far zeros are told by the referee."""


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


def drawn_peg(rng: Random, outside: bool = True) -> PegCase | None:
    """A case; often aimed, a graze, a touch, or after a contact."""
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
    if c.reach <= 0 or (outside and (p[1] <= 0 if c.stood else p[0] <= 0)):
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
    assert low < 2.0 < high < low + 1e-11
    assert peg_in_doubles((0.0, 3.0, 0.0, 0.0, 0.0, 0.0), peg, 1.0, False) is False
    assert peg_in_doubles((0.0, 3.0, 0.0, 0.0, 4.0, 0.0), peg, 3.5, False) is False


# -- Sides of arcs, and rims.


class SideCase(NamedTuple):
    """As a `PegCase`, of a circle of which a part stands: where n.(e - edge) is above 0; e is from its middle."""

    peg: PegCase
    hollow: bool
    full: bool
    nx: Q
    ny: Q
    edge: Q

    def gap(self) -> list[Q]:
        """As it is divided out; positive where they are apart."""
        p = self.peg.gap()[1:] if self.peg.stood else self.peg.gap()
        return [-value for value in p] if self.hollow else p

    def beyond(self, s: Q) -> Q:
        """How far beyond the chord the circle is so long after the instant."""
        c, t = self.peg, self.peg.t + self.peg.late
        x = c.x + c.vx * (c.late + s) + c.hx * (t + s) ** 2 - c.px
        y = c.y + c.vy * (c.late + s) + c.hy * (t + s) ** 2 - c.py
        return self.nx * x + self.ny * y - self.edge


def drawn_side(rng: Random) -> SideCase | None:
    """A case; often at the end of the range."""
    peg = drawn_peg(rng, outside=False)
    if peg is None:
        return None
    if rng.random() < 0.2 and not peg.stood:  # from within
        far = root(peg.gap()[0] + peg.reach**2, 200)
        peg = peg._replace(reach=far * (1 + abs(some(rng, 1))))
    thrown = rng.random() < 0.4 and not peg.stood
    if thrown:  # up through the circle, from within or from below; and down again
        t, h = peg.t, abs(peg.hx) + abs(peg.hy)
        ux, uy = (-half / h * abs(some(rng, 9)) + some(rng, 1) * Q(1, 9) for half in (peg.hx, peg.hy))
        below = rng.choice([Q(0), Q(5, 2)])
        ex, ey = (half / h * peg.reach * below + some(rng, 1) * peg.reach * Q(1, 3) for half in (peg.hx, peg.hy))
        peg = peg._replace(vx=ux - 2 * peg.hx * t, vy=uy - 2 * peg.hy * t)
        px, py = peg.x + peg.vx * peg.late + peg.hx * t**2 - ex, peg.y + peg.vy * peg.late + peg.hy * t**2 - ey
        peg = peg._replace(px=px, py=py)
    case = SideCase(peg, rng.random() < 0.6, rng.random() < 0.2, some(rng), some(rng), Q(0))
    case = case._replace(edge=some(rng, 1) * peg.reach * (abs(case.nx) + abs(case.ny)) * Q(2, 3))
    found = [*falls(case.gap(), WIDTH)]
    if found and rng.random() < 0.3:
        low, _ = rng.choice(found)
        case = case._replace(edge=case.edge + case.beyond(low) * (1 + faint(rng)))
    return case if case.gap()[0] > 0 or (case.gap()[0] < 0 and not peg.stood) else None


def judged_side(case: SideCase, rng: Random, fall: Callable[..., Any]) -> str:
    """As `judged`."""
    c = case.peg
    x, y, vx, vy, t, px, py, reach, hx, hy = (off(rng, number) for number in (*c[:5], *c[6:11]))
    nx, ny, edge = (off(rng, number) for number in case[3:])
    late = float(abs(c.late)) * (1 + 2.0**-50)
    side = FallenSide(3, case.full, px, py, -reach if case.hollow else reach, hx, hy, nx, ny, edge, abs(nx) + abs(ny))
    told = fall((x, y, vx, vy, t, late), side, math.inf, c.stood)
    if told is True:
        return "unclear"
    for low, high in falls(case.gap(), WIDTH):
        place = case.beyond(low)
        if not case.full and place * case.beyond(high) <= 0:
            return "wrong"  # right at the end: not to be told
        if case.full or place > 0:
            begun = c.t + c.late
            return "met" if told and Q(told[0]) <= begun + low and begun + high <= Q(told[1]) else "wrong"
    return "none" if told is False else "wrong"


def sides(seed: str, count: int) -> Iterator[tuple[SideCase, Random]]:
    rng = Random(seed)
    for _ in range(count):
        case = drawn_side(rng)
        if case is not None:
            yield case, rng


def test_what_is_said_of_sides_of_arcs_is_true() -> None:
    found, later = Counter[str](), 0
    for case, rng in sides("sides", 600):
        told = judged_side(case, rng, side_in_doubles)
        found[told] += 1
        later += told == "met" and case.beyond(next(falls(case.gap(), WIDTH))[0]) < 0 and not case.full
    assert found["wrong"] == 0
    assert min(found["met"], found["none"]) > 100
    assert later > 5  # at a second zero
    assert found["unclear"] < 0.4 * found.total()


def test_a_side_that_the_flight_ends_before_is_none() -> None:
    """A ball in a bowl of reach 2 about (0, 0) that is thrown up out of it, and comes back at 2."""
    bowl = FallenSide(3, False, 0.0, 0.0, -2.0, 0.0, -5.0, 0.0, -1.0, 0.0, 1.0)
    flight = (1.0, 0.0, 0.0, 10.0, 0.0, 0.0)
    low, high = side_in_doubles(flight, bowl, math.inf, False)
    assert low < 1 + math.sqrt(1 + math.sqrt(3) / 5) < high < low + 1e-11
    assert side_in_doubles(flight, bowl, 2.0, False) is False
    assert side_in_doubles(flight, bowl._replace(full=True), 2.0, False)[1] < 1.0


# -- Planted faults: the same functions with one thing changed.


def spoiled(functions: Sequence[Callable[..., Any]], right: str, wrong: str) -> Callable[..., Any]:
    """The first of some functions of the filter, with one piece of the text of one of them changed, in Python."""
    text = "\n\n".join(inspect.getsource(function) for function in functions)
    assert right in text
    names = {**vars(filtered_falls), **vars(filtered_arcs), "predictions": None}
    exec(compile(f"from __future__ import annotations\n{text.replace(right, wrong, 1)}", "spoiled", "exec"), names)
    return names[functions[0].__name__]


FAULTS = [
    ("half * t\n", "-half * t\n"),
    ("(lift - drift) * t", "(lift + drift) * t"),
    ("(lift - drift) * t", "lift - drift"),
    ("2.0 * lift - drift", "lift - drift"),
    ("2.0 * lift - drift", "2.0 * lift + drift"),
    ("square - depth", "square + depth"),
    ("root - speed", "root + speed"),
    ("+ bend * t * t", "- bend * t * t"),
    ("2.0 * bend * t", "bend * t"),
    ("slide + arch", "slide + 2.0 * arch"),
    ("if half >= 0.0 and speed > turn", "if half >= 0.0 and speed > -turn"),
    ("gap < -early and (half >= 0.0 or speed < -turn)", "gap < -early"),
    ("disc < -blur_disc and", "disc < blur_disc and"),
    ("blur / -half + late + 8", "blur / -half + 0.1 * late + 8"),
    ("2.0 * blur_wait + 8 * UNIT * (t + wait)\n    if", "0.2 * blur_wait + 0.8 * UNIT * (t + wait)\n    if"),
]


@pytest.mark.parametrize(("right", "wrong"), FAULTS)
def test_a_planted_fault_in_walls_is_found(right: str, wrong: str) -> None:
    fault = spoiled([fall_in_doubles], right, wrong)
    assert any(judged(case, rng, fault) == "wrong" for case, rng in cases("faults", 6_000))


PEG_FAULTS = [
    ("wx * t, y", "-wx * t, y"),
    ("2.0 * wy", "wy"),
    ("reach * reach,\n", "reach,\n"),
    ("2.0 * (ex * ux + ey * uy)", "ex * ux + ey * uy"),
    ("2.0 * (ex * hx + ey * hy)", "-2.0 * (ex * hx + ey * hy)"),
    ("2.0 * (ux * hx + uy * hy)", "-2.0 * (ux * hx + uy * hy)"),
    ("hx * hx + hy * hy,", "hx * hx - hy * hy,"),
]


@pytest.mark.parametrize(("right", "wrong"), PEG_FAULTS)
def test_a_planted_fault_in_pegs_is_found(right: str, wrong: str) -> None:
    fault = spoiled([peg_in_doubles, seen_from], right, wrong)
    assert any(judged_peg(case, rng, fault) == "wrong" for case, rng in pegs("faults", 400))


SIDE_FAULTS = [
    ("if side.reach < 0.0", "if side.reach > 0.0"),
    ("(seen.ux + hx * s) * s", "(seen.ux - hx * s) * s"),
    ("nx * x + ny * y - edge", "nx * x + ny * y + edge"),
    ("nx * x + ny * y - edge", "nx * x - ny * y - edge"),
    ("if within is False:\n                continue", "if within is False:\n                return False"),
    ("if changes == 0 or (changes == 1 and not above)", "if changes == 0 or (changes == 1 and above)"),
    ("int(b[0] > 0.0)", "1"),
    ("side, low, high) is False:\n            continue", "side, low, high) is not True:\n            continue"),
    ("* spread\n", "* 0.1 * spread\n"),
    ("found > off", "found > -off"),
    ("0.5 * (high - low) + 4", "0.01 * (high - low) + 4"),
    ("c, off = c[1:], off[1:]", "c, off = c[:-1], off[:-1]"),
]


@pytest.mark.parametrize(("right", "wrong"), SIDE_FAULTS)
def test_a_planted_fault_in_sides_of_arcs_is_found(right: str, wrong: str) -> None:
    fault = spoiled([side_in_doubles, within_in_doubles], right, wrong)
    assert any(judged_side(case, rng, fault) == "wrong" for case, rng in sides("faults", 2_000))
