"""Single first meetings, drawn from a seed, each with the answer that the exact engine certifies.

A vector is one question that every engine of discs asks: two things fly, when do they first meet? Every number of a
question is a double, so that no program rounds it; the answer is whether they meet, when, and where on the thing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from random import Random

from ...exact.exact_engine import ExactEngine
from ...exact.numbers import ball
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.surfaces import Segment
from ...scenarios.things import Arc, Circle, Wall
from ...scenarios.trajectory import CircleState, OnProgress, Progress, StopReason

THINGS = ("disc", "wall", "segment", "arc")
"""What the disc may meet; a vector has its place here as `thing`."""

KINDS = ("hit", "miss", "near hit", "near miss", "graze", "touching", "scale")
"""What a vector tries; a vector has its place here as `kind`."""

DIGITS = 40
"""Decimal digits of a certified time."""

LEVELS, WIDE_LEVELS = range(3, 41), range(3, 23)
"""The k of hits and misses by 2**-k of the sum of radii; of those whose numbers have 20 bits, so that squares of them
are rounded: all are doubles."""

SCALES = range(-300, 301, 50)
"""The powers of two by which lengths, times or both are scaled."""

TRIPLES = ((3, 4, 5), (4, 3, 5), (5, 12, 13), (12, 5, 13), (8, 15, 17), (15, 8, 17), (7, 24, 25), (20, 21, 29))
"""Directions whose length is a whole number, so that a graze is one in doubles."""

Numbers = tuple[float, float, float, float, float]
"""x, y, r, vx, vy of a disc; x0, y0, x1, y1 and 0 of a wall; x0, y0, x1, y1, r of a segment."""

ArcNumbers = tuple[float, float, float, float, float, float, float]
"""x, y, r, x0, y0, x1, y1 of an arc; of a full circle both points are its middle."""


@dataclass(frozen=True)
class MeetingQuestion:
    """A disc, what it may meet, and what is tried by it.

    Attributes:
        thing: one of `THINGS`.
        kind: one of `KINDS`.
        disc: x, y, r, vx, vy.
        other: the numbers of the thing.
        level: the k of 2**-k or of 2**k, where there is one.
    """

    thing: str
    kind: str
    disc: Numbers
    other: Numbers | ArcNumbers
    level: int | None = None

    @property
    def scene(self) -> Scene:
        """The scene of these two, which ends at their first meeting.

        Raises:
            SceneError: where they overlap.
        """
        discs, walls, segments = [Circle(*self.disc, id="disc")], list[Wall](), list[Segment]()
        if self.thing == "disc":
            discs.append(Circle(*self.other[:5], id="other"))
        elif self.thing == "wall":
            walls.append(Wall(*self.other[:4], id="other"))
        elif self.thing == "segment":
            segments.append(Segment(*self.other[:4], id="other", r=self.other[4]))
        return Scene(discs, walls, segments=segments, arcs=[self.arc] if self.thing == "arc" else [], events=1)

    @property
    def arc(self) -> Arc:
        """The arc, where `thing` is one."""
        x, y, r, *points = self.other
        full = points == [x, y, x, y]
        return Arc(x, y, r, id="other", full=True) if full else Arc(x, y, r, *points, id="other")


@dataclass(frozen=True)
class Vector:
    """A question with its certified answer.

    Attributes:
        question: who may meet what.
        meets: whether they meet.
        time: the double nearest to the time of it; 0 where they do not meet.
        rest: the time less that double, as the nearest double: both together have some 106 bits.
        digits: the time in `DIGITS` decimals; "" where they do not meet.
        part: `face` or `end`, of a segment that is met; `outside`, `inside` or `end`, of an arc.
    """

    question: MeetingQuestion
    meets: bool
    time: float = 0.0
    rest: float = 0.0
    digits: str = ""
    part: str = ""


def answered(question: MeetingQuestion) -> Vector:
    """The certified answer.

    Raises:
        SceneError: where the two overlap at the start, which is no question.

    >>> head_on = MeetingQuestion("disc", "hit", (0.0, 0.0, 1.0, 1.0, 0.0), (4.0, 0.0, 1.0, 0.0, 0.0))
    >>> answered(head_on).meets, answered(head_on).time
    (True, 2.0)
    """
    run = ExactEngine().run(question.scene)
    if run.stop.reason not in (StopReason.EVENTS, StopReason.QUIET):
        raise AssertionError(f"{question}: {run.stop.message}")
    if not run.events:
        return Vector(question, False)
    event = run.events[0]
    time = float(event.time)
    with ball.precision(160):
        rest = float(event.time.ball(160) - Quantity.of(time).ball(160)) if math.isfinite(time) else 0.0
    return Vector(question, True, time, rest, event.time.digits(DIGITS), _part(question, run.after(0)["disc"]))


def _part(question: MeetingQuestion, state: CircleState) -> str:
    """Which part of a segment or arc the disc has met: an end, where its centre lies beyond its two points."""
    bits = 400
    x, y = state.x.ball(bits), state.y.ball(bits)
    if question.thing == "segment":
        x0, y0, x1, y1 = (Fraction(value) for value in question.other[:4])
        along, length = (x1 - x0, y1 - y0), (x1 - x0) ** 2 + (y1 - y0) ** 2
        foot = (x - Quantity.of(x0).ball(bits)) * Quantity.of(along[0]).ball(bits)
        foot += (y - Quantity.of(y0).ball(bits)) * Quantity.of(along[1]).ball(bits)
        inside = foot > 0 and foot < Quantity.of(length).ball(bits)
        return "face" if inside else "end"
    if question.thing == "arc":
        arc = question.arc
        dx, dy, r = x - arc.x.ball(bits), y - arc.y.ball(bits), arc.r.ball(bits)
        nx, ny, h = (value.ball(bits) for value in arc.chord)
        with ball.precision(bits):
            far = ball.root(dx * dx + dy * dy)
            if not arc.full and not nx * dx + ny * dy > h * far:
                return "end"
            return "inside" if far < r else "outside"
    return ""


# -- what is drawn


def questions(seed: int = 1) -> Iterator[MeetingQuestion]:
    """Questions without end, drawn from a seed: every thing and kind in turn.

    >>> first = next(questions(7))
    >>> first.thing, first.kind
    ('disc', 'hit')
    """
    draw = Random(seed)
    while True:
        for kind in KINDS:
            for thing in THINGS:
                yield DRAWS[thing](draw, kind)


def vectors(count: int, seed: int = 1, progress: OnProgress | None = None) -> Iterator[Vector]:
    """So many vectors of a seed; questions whose two things overlap are left out.

    >>> [(v.question.thing, v.question.kind, v.meets) for v in vectors(4)][2:]
    [('segment', 'hit', True), ('arc', 'hit', True)]
    """
    made = 0
    for question in questions(seed):
        if made >= count:
            return
        try:
            vector = answered(question)
        except SceneError:
            continue
        made += 1
        if progress is not None:
            progress(Progress(made, 0.0))
        yield vector


def _even(draw: Random, low: float, high: float) -> float:
    """A multiple of 2**-20, so that sums and products of a few stay doubles."""
    return round((low + (high - low) * draw.random()) * 2**20) / 2**20


def _turned(draw: Random) -> tuple[int, int, int]:
    """A direction whose length is whole: p, q, and that length."""
    p, q, h = draw.choice(TRIPLES)
    return draw.choice((1, -1)) * p, draw.choice((1, -1)) * q, h


@dataclass(frozen=True)
class _Pass:
    """How a disc passes a place: from d, at velocity v, so that it comes within `c` times the length of (p, q).

    Attributes:
        reach: the sum of radii, in the same unit.
    """

    dx: float
    dy: float
    vx: float
    vy: float
    reach: float
    level: int | None
    p: int
    q: int
    side: int


def _pass(draw: Random, kind: str) -> _Pass:
    """A flight past a place at the origin; `reach` is a sum of radii whose half is a double too."""
    p, q, h = _turned(draw)
    wide = draw.random() < 0.5
    unit, away, speed = (draw.randrange(1, 2**20) / 2**k for k in (18, 15, 17)) if wide else _short(draw)
    side, level = draw.choice((1, -1)), None
    away += 4 * unit  # the reach is unit * h
    by = unit * (draw.randrange(0, 900) / 1000 if kind in ("hit", "scale") else 1.0)
    if kind == "miss":
        by = unit * draw.randrange(1100, 3000) / 1000
    elif kind in ("near hit", "near miss"):
        level = draw.choice(WIDE_LEVELS if wide else LEVELS)
        by = unit * (1 + math.ldexp(1 if kind == "near miss" else -1, -level))
    if kind in ("hit", "miss", "scale"):
        by = round(by * 2**20) / 2**20
    by *= side
    if kind == "touching":
        away, by = 0.0, unit * side
        speed, turn = draw.randrange(-8, 9) / 8, draw.randrange(-8, 9) / 8
        if draw.random() < 0.3:
            level = draw.choice(LEVELS)
            turn = math.ldexp(draw.choice((1, -1)), -level)
        return _Pass(-by * q, by * p, speed * p + turn * q, speed * q - turn * p, unit * h, level, p, q, side)
    return _Pass(-away * p - by * q, -away * q + by * p, speed * p, speed * q, unit * h, level, p, q, side)


def _short(draw: Random) -> tuple[float, float, float]:
    """Numbers of few bits, whose products are doubles."""
    return draw.randrange(1, 17) / 8, draw.randrange(40, 200) / 4, draw.randrange(1, 32) / 8


def _scaled(
    draw: Random, kind: str, disc: Numbers, other: Numbers | ArcNumbers, moves: bool
) -> tuple[Numbers, Numbers | ArcNumbers, int | None]:
    """Lengths, and speeds, times powers of two, for the kind that tries that."""
    if kind != "scale":
        return disc, other, None
    length, time = draw.choice(SCALES), draw.choice((0, 0, -100, 100))
    x, y, r, vx, vy = disc
    made = *(math.ldexp(n, length) for n in (x, y, r)), *(math.ldexp(n, length - time) for n in (vx, vy))
    speeds = (math.ldexp(n, length - (time if moves else 0)) for n in other[3:])
    return made, (*(math.ldexp(n, length) for n in other[:3]), *speeds), length  # pyright: ignore[reportReturnType]


def _two_discs(draw: Random, kind: str) -> MeetingQuestion:
    """Two discs, both of which fly."""
    found = _pass(draw, kind)
    r = found.reach * draw.randrange(1, 8) / 8
    vx, vy = draw.randrange(-16, 17) / 8, draw.randrange(-16, 17) / 8
    x = y = 0.0
    if kind in ("hit", "miss"):
        x, y = _even(draw, -50, 50), _even(draw, -50, 50)
    disc = found.dx + x, found.dy + y, found.reach - r, found.vx + vx, found.vy + vy
    disc, other, scale = _scaled(draw, kind, disc, (x, y, r, vx, vy), moves=True)
    return MeetingQuestion("disc", kind, disc, other, found.level if scale is None else scale)


def _one_wall(draw: Random, kind: str) -> MeetingQuestion:
    """A wall through (x0, y0) and (x1, y1), and a disc that comes, leaves, or flies along it."""
    p, q, h = _turned(draw)
    r, away = draw.randrange(1, 33) / 8, draw.randrange(4, 200) / 8
    along, across, level = draw.randrange(-16, 17) / 8, -draw.randrange(1, 33) / 8, None
    if kind == "miss":
        across = -across if draw.random() < 0.7 else 0.0
    elif kind in ("near hit", "near miss"):
        level = draw.choice(LEVELS)
        across = math.ldexp(-1 if kind == "near hit" else 1, -level)
    elif kind in ("graze", "touching"):
        away = 0.0
        across = 0.0 if kind == "graze" else across * draw.choice((1, -1))
        along = along or 1.0
    height = (r + away) / h if kind not in ("graze", "touching") else None
    # the centre stands r + away above the line, whose normal is (-q, p) / h: in doubles where that divides
    if height is None or not (height * 2**20).is_integer():
        r = draw.randrange(1, 17) / 8 * h
        away = 0.0 if height is None else draw.randrange(1, 40) / 8 * h
        height = (r + away) / h
    disc = -height * q, height * p, r, along * p - across * q, along * q + across * p
    x0, x1 = -draw.randrange(1, 9), draw.randrange(1, 9)
    wall = float(x0 * p), float(x0 * q), float(x1 * p), float(x1 * q), 0.0
    disc, wall, scale = _scaled(draw, kind, disc, wall, moves=False)
    return MeetingQuestion("wall", kind, disc, wall, level if scale is None else scale)


def _one_segment(draw: Random, kind: str) -> MeetingQuestion:
    """A segment with round ends: its face is met, or the disc passes close to an end."""
    found = _pass(draw, kind)
    r = draw.choice((0.0, found.reach / 8, found.reach / 2))
    p, q, side = found.p, found.q, found.side
    length, slant = draw.randrange(8, 80) / 8, draw.randrange(-8, 9) / 16 * (kind not in ("graze", "touching"))
    if kind in ("hit", "scale") and draw.random() < 0.6:  # across the way, so that a face is met
        side *= draw.choice((1, -1))
        begin = length * draw.randrange(1, 8) / 8
        x0, y0 = side * q * begin, -side * p * begin
    else:
        x0 = y0 = 0.0
    # away from the flight's line, so that the end at (0, 0) is what comes nearest
    x1, y1 = side * q * length + slant * p * length, -side * p * length + slant * q * length
    ends = [(x0, y0), (x1 if not x0 else -x1, y1 if not y0 else -y1)]
    draw.shuffle(ends)
    disc = found.dx, found.dy, found.reach - r, found.vx, found.vy
    disc, other, scale = _scaled(draw, kind, disc, (*ends[0], *ends[1], r), moves=False)
    return MeetingQuestion("segment", kind, disc, other, found.level if scale is None else scale)


def _one_arc(draw: Random, kind: str) -> MeetingQuestion:
    """An arc that is met from outside, from within, or at an end."""
    where = draw.choice(("outside", "inside", "end"))
    if where == "inside" and kind not in ("near miss", "graze"):  # what is within cannot pass
        disc, other, level = _within_arc(draw, kind)
    else:
        found = _pass(draw, kind)
        p, q, reach, level = found.p, found.q, found.reach, found.level
        if where == "outside":
            r = reach * draw.choice((1, 2, 3, 5, 6, 7)) / 8  # not as wide as the disc
            rho, other = reach - r, (0.0, 0.0, r, *_range(draw, -p, -q, wide=kind not in ("hit", "scale")))
        else:
            rho, other = reach, _arc_from_origin(draw, found.side * q, -found.side * p)
        disc = found.dx, found.dy, rho, found.vx, found.vy
    disc, other, scale = _scaled(draw, kind, disc, other, moves=False)
    return MeetingQuestion("arc", kind, disc, other, level if scale is None else scale)


def _range(draw: Random, p: float, q: float, *, wide: bool) -> tuple[float, float, float, float]:
    """Two points about the origin between which, counter-clockwise, are all directions at up to 64 degrees from (p, q).

    With `wide` all at up to a right angle, and more. Now and then the full circle.
    """
    if draw.random() < 0.3:
        return 0.0, 0.0, 0.0, 0.0
    if wide or draw.random() < 0.5:  # all but what is nearest to -(p, q)
        return -2.0 * p + q, -2.0 * q - p, -2.0 * p - q, -2.0 * q + p
    return p + 3.0 * q, q - 3.0 * p, p - 3.0 * q, q + 3.0 * p


def _within_arc(draw: Random, kind: str) -> tuple[Numbers, ArcNumbers, int | None]:
    """A disc inside of an arc, which it meets from within, or which it leaves by the opening."""
    p, q, h = _turned(draw)
    unit, speed = draw.randrange(1, 17) / 8, draw.randrange(1, 32) / 8
    side, level = draw.choice((1, -1)), None
    by, ahead = unit * draw.randrange(0, 28) / 32, unit * draw.randrange(-9, 10) / 32
    turn = 0.0
    if kind == "near hit":  # it almost flies along the arc, up to the end of so short a chord
        level = draw.choice(LEVELS)
        by, ahead = unit * (1 - math.ldexp(1.0, -level)), 0.0
    elif kind == "touching":
        by, ahead = unit, 0.0
        speed, turn = draw.randrange(-8, 9) / 8, draw.choice((-1, 1)) * draw.randrange(1, 9) / 8
    elif kind == "miss":
        speed = -speed
        ahead = -abs(ahead)
    by *= side
    rho = unit * h * draw.randrange(1, 8) / 8
    if kind == "miss":  # an opening that it leaves by
        points = p + 3.0 * q, q - 3.0 * p, p - 3.0 * q, q + 3.0 * p
    elif kind == "touching":
        points = _range(draw, -by * q, by * p, wide=True)
    else:
        points = _range(draw, p, q, wide=level is not None)
    disc = ahead * p - by * q, ahead * q + by * p, rho, speed * p - turn * q, speed * q + turn * p
    return disc, (0.0, 0.0, unit * h + rho, *points), level


def _arc_from_origin(draw: Random, ax: float, ay: float) -> ArcNumbers:
    """A half-circle with an end at the origin, on the side of the line through it to which (ax, ay) points."""
    c, s, h = draw.choice(TRIPLES)
    s *= draw.choice((1, -1))
    times = draw.randrange(1, 65, 2) / 16
    x, y = times * (ax * c - ay * s), times * (ax * s + ay * c)  # a middle whose distance is a double
    begins, ends = (0.0, 0.0), (2.0 * x, 2.0 * y)
    if y * ax - x * ay < 0.0:  # it would begin on the other side
        begins, ends = ends, begins
    return x, y, times * h * math.isqrt(round(ax * ax + ay * ay)), *begins, *ends


DRAWS: dict[str, Callable[[Random, str], MeetingQuestion]] = {
    "disc": _two_discs,
    "wall": _one_wall,
    "segment": _one_segment,
    "arc": _one_arc,
}
"""How each of `THINGS` is drawn."""
