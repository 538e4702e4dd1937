"""Maps of a scene that must map its history: turns, mirrors, scales, shifts, boosts, permutations, and cuts in two."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from random import Random
from typing import Any

import mpmath
from flint import arb, ctx  # type: ignore[attr-defined]

from fuzz.check import GAVE_UP, Difference, expect, rational
from fuzz.draft import ROOT2, ROOT3, Case, F, Number, Vector
from truebreak.scenarios import Circle, Pocket, Quantity, Scene, Trajectory, Wall
from truebreak.scenarios.errors import SceneError

BITS = 320
CLOSE = arb((1, -200))
LONGEST = 300
"""Characters of the longest number with which a scene is cut in two: past that, reading it takes too long."""


@dataclass(frozen=True)
class Map:
    """Lengths times `stretch`, then turned by cosine c and sine s; times over `pace`; masses times `weight`.

    Attributes:
        shift: added to every place.
        boost: added to every velocity.
        order: seed of a new order of circles and of walls.
    """

    name: str
    c: Number = 1
    s: Number = 0
    mirror: bool = False
    stretch: Number = 1
    pace: Number = 1
    weight: Number = 1
    shift: Vector = (0, 0)
    boost: Vector = (0, 0)
    order: int | None = None

    def fits(self, scene: Scene) -> bool:
        """Whether the map keeps the history of a scene."""
        if self.boost != (0, 0):
            fixed = any(c.fixed for c in scene.circles)
            return not (scene.walls or scene.pockets or fixed or scene.reverse_at or scene.reverse_after)
        return self.order is None or scene.tie_policy.name == "simultaneous"

    def turn(self, x: Any, y: Any, of: Callable[[Number], Any] = Quantity.of) -> tuple[Any, Any]:
        """A difference of places."""
        c, s, k = of(self.c), of(self.s), of(self.stretch)
        y = -y if self.mirror else y
        return k * (c * x - s * y), k * (s * x + c * y)

    def place(self, x: Any, y: Any, of: Callable[[Number], Any] = Quantity.of) -> tuple[Any, Any]:
        """A place at time 0."""
        x, y = self.turn(x, y, of)
        return x + of(self.shift[0]), y + of(self.shift[1])

    def velocity(self, x: Any, y: Any, of: Callable[[Number], Any] = Quantity.of) -> tuple[Any, Any]:
        """A velocity."""
        (x, y), k = self.turn(x, y, of), of(self.pace)
        return k * x + of(self.boost[0]), k * y + of(self.boost[1])

    def time(self, value: Quantity | None) -> Quantity | None:
        """A time."""
        return None if value is None else value / Quantity.of(self.pace)

    def case(self, case: Case) -> Case:
        """The mapped scene and limits."""
        scene = case.scene
        circles = []
        for c in scene.circles:
            m = c.m if c.fixed else c.m * Quantity.of(self.weight)
            r = c.r * Quantity.of(self.stretch)
            circles.append(Circle(*self.place(c.x, c.y), r, *self.velocity(c.vx, c.vy), m, c.id, c.point))
        walls = [Wall(*self.place(w.x0, w.y0), *self.place(w.x1, w.y1), w.id) for w in scene.walls]
        if self.order is not None:
            draw = Random(self.order)
            draw.shuffle(circles)
            draw.shuffle(walls)
        pockets = [Pocket(*self.place(p.x, p.y), p.r * Quantity.of(self.stretch), p.id) for p in scene.pockets]
        mapped = scene.with_changes(
            circles=circles, walls=walls, pockets=pockets, reverse_at=self.time(scene.reverse_at)
        )
        return Case(mapped, self.time(case.until), case.events)


MAPS: tuple[Map, ...] = (
    Map("turn 3-4-5", F(3, 5), F(4, 5)),
    Map("turn 5-12-13", F(5, 13), F(-12, 13)),
    Map("turn 30", ROOT3 / 2, F(1, 2)),
    Map("turn 45", ROOT2 / 2, ROOT2 / 2),
    Map("turn 60", F(1, 2), ROOT3 / 2),
    Map("turn 90", 0, 1),
    Map("mirror", mirror=True),
    Map("mirror, turn 3-4-5", F(3, 5), F(4, 5), mirror=True),
    Map("length", stretch=F(10**9, 7)),
    Map("length, a root", stretch=ROOT3),
    Map("time", pace=F(7, 10**6)),
    Map("time, a root", pace=ROOT2),
    Map("mass", weight=F(3, 7)),
    Map("mass, a root", weight=ROOT2),
    Map("shift", shift=(F(22, 7), F(-355, 113))),
    Map("shift by roots", shift=(ROOT2, ROOT3 / 3)),
    Map("boost", boost=(F(2, 3), F(-5, 7))),
    Map("boost by roots", boost=(ROOT2 / 2, 1)),
    Map("order", order=1),
    Map("another order", order=2),
)


def check_map(run: Trajectory, case: Case, by: Map, engine: Any) -> bool:
    """Holds the run of a mapped scene against the mapped run; False where one of them gave up.

    Raises:
        Difference: where they disagree.
    """
    mapped = by.case(case)
    image = engine.run(mapped.scene, until=mapped.until, events=mapped.events)
    if image.stop.reason.name in GAVE_UP or run.stop.reason.name in GAVE_UP:
        return False
    where = f"map {by.name}"
    with _precision(BITS):
        k = _ball(by.pace)
        same_history(run, image, lambda t: t / k, where)
        for circle in run.final.circles:
            other = image.final[circle.id]
            x, y, vx, vy = (getattr(circle, key).ball(BITS) for key in ("x", "y", "vx", "vy"))
            x, y = by.place(x, y, _ball)
            vx, vy = by.velocity(vx, vy, _ball)
            late = image.final_time.ball(BITS)
            x, y = x + _ball(by.boost[0]) * late, y + _ball(by.boost[1]) * late
            for key, value in (("x", x), ("y", y), ("vx", vx), ("vy", vy)):
                same(getattr(other, key).ball(BITS), value, f"{where}: final {circle.id}.{key}")
    return True


def check_cut(run: Trajectory, case: Case, draw: Random, engine: Any) -> bool:
    """Runs to a time, takes the state there as a new scene, and goes on: the rest is the same; False if not asked.

    Raises:
        Difference: where the two histories disagree.
    """
    scene = case.scene
    unlimited = case.until is None and case.events is None
    if unlimited or scene.tie_policy.seed is not None or run.stop.reason.name in GAVE_UP or not run.events:
        return False
    at = _cutting_time(run, draw)
    if at is None or (case.until is not None and not at < case.until):
        return False
    first = engine.run(scene, until=at)
    done = len(first.events)
    taken = scene.capture and first.pocketings
    if taken or first.stop.reason.name in GAVE_UP or (case.events is not None and done >= case.events):
        return False
    texts = [{k: getattr(c, k).text() for k in ("x", "y", "vx", "vy")} for c in first.final.circles]
    if any(text is None or len(text) > LONGEST for row in texts for text in row.values()):
        return False
    turned = first.reversal is not None
    try:
        rest = scene.with_changes(
            circles=[
                Circle(r=c.r, m=c.m, id=c.id, point=c.point, **row) for c, row in zip(scene.circles, texts, strict=True)
            ],
            reverse_at=None if turned or scene.reverse_at is None else scene.reverse_at - at,
            reverse_after=None if turned or scene.reverse_after is None else scene.reverse_after - done,
        )
    except SceneError as error:
        if any(c.point for c in scene.circles):  # a point that touches a wall cannot start there
            return False
        raise Difference(f"cut at {at}: the state there is no scene: {error}") from None
    until = None if case.until is None else case.until - at
    then = engine.run(rest, until=until, events=None if case.events is None else case.events - done)
    if then.stop.reason.name in GAVE_UP:
        return False
    where = f"cut at {at}"
    with _precision(BITS):
        offset = at.ball(BITS)
        expect(then.stop.reason == run.stop.reason, f"{where}: stops with {then.stop}, not {run.stop}")
        same_events(run.events[done:], then.events, lambda t: t - offset, where)
        entries = [(p.circle, p.pocket) for p in run.pocketings[len(first.pocketings) :]]
        again = [(p.circle, p.pocket) for p in then.pocketings if p.time.ball(BITS) > 0]
        expect(entries == again, f"{where}: pocketings {again}, not {entries}")
        if run.stop.reason.name != "QUIET":
            for mine, other in zip(run.final.circles, then.final.circles, strict=True):
                for key in ("x", "y", "vx", "vy"):
                    same(getattr(other, key).ball(BITS), getattr(mine, key).ball(BITS), f"{where}: {mine.id}.{key}")
    return True


def _cutting_time(run: Trajectory, draw: Random) -> Quantity | None:
    """At an event of rational time, or halfway between two things."""
    if draw.random() < 0.5:
        texts = [text for event in run.events if (text := rational(event.time)) is not None and text != "0"]
        return Quantity.of(draw.choice(texts)) if texts else None
    times = sorted({0.0, *(float(event.time) for event in run.events), float(run.final_time)})
    if len(times) < 2:
        return None
    k = draw.randrange(len(times) - 1)
    middle = F((times[k] + times[k + 1]) / 2).limit_denominator(1000)
    return Quantity.of(middle) if times[k] < middle < times[k + 1] else None


def check_interval(run: Trajectory, case: Case, engine: Any) -> int:
    """An interval engine never contradicts the exact history before it stops; the number of events that it knows.

    Raises:
        Difference: where it does.
    """
    other = engine.run(case.scene, until=case.until, events=case.events)
    certain = run.stop.reason.name not in GAVE_UP
    expect(not certain or len(other.events) <= len(run.events), "interval: more events than there are")
    pairs = list(zip(run.events, other.events, strict=False))
    for mine, theirs in pairs:
        where = f"interval event {theirs.index}"
        expect(set(mine.contacts) == set(theirs.contacts), f"{where}: {theirs.contacts}, not {mine.contacts}")
        _enclosed(mine.time, theirs.time, f"{where}: time")
    if certain and other.stop.reason == run.stop.reason:
        expect(len(other.events) == len(run.events), f"interval: {len(other.events)} events, not {len(run.events)}")
        _enclosed(run.final_time, other.final_time, "interval final_time")
        entries = [[(p.circle, p.pocket) for p in r.pocketings] for r in (run, other)]
        expect(entries[0] == entries[1], f"interval pocketings {entries[1]}, not {entries[0]}")
        for mine, theirs in zip(run.final.circles, other.final.circles, strict=True):
            for key in ("x", "y", "vx", "vy"):
                _enclosed(getattr(mine, key), getattr(theirs, key), f"interval final {mine.id}.{key}")
    return len(pairs)


def _enclosed(mine: Any, theirs: Any, where: str) -> None:
    ball = mine.ball(1500)
    low, high = _bounds(theirs)
    expect(not (ball < low or ball > high), f"{where}: {ball.str(20, radius=False)} is not in {theirs}")


def _bounds(value: Any) -> tuple[arb, arb]:
    """The ends of a number of the interval engine; the time of a limit is exact, other times are mpmath's intervals."""
    if hasattr(value, "ball"):
        ball = value.ball(1500)
        return ball.lower(), ball.upper()
    if hasattr(value, "low"):
        return arb(value.low), arb(value.high)
    low, high = (mpmath.mp.make_mpf(end) for end in value._mpi_)
    return _exact(low), _exact(high)


def _exact(value: mpmath.mpf) -> arb:
    mantissa, exponent = value.man_exp
    return arb((int(mantissa), int(exponent)))


# -- two runs of one history


def same_history(run: Trajectory, image: Trajectory, time: Callable[[arb], arb], where: str) -> None:
    """Events, entries, reversal and the end of two runs, times mapped."""
    expect(run.stop.reason == image.stop.reason, f"{where}: stops with {image.stop}, not {run.stop}")
    same_events(run.events, image.events, time, where)
    entries = [sorted((p.circle, p.pocket) for p in r.pocketings) for r in (run, image)]
    expect(entries[0] == entries[1], f"{where}: pocketings {entries[1]}, not {entries[0]}")
    for mine, other in zip(run.pocketings, image.pocketings, strict=True):
        same(other.time.ball(BITS), time(mine.time.ball(BITS)), f"{where}: time of pocketing {mine.circle}")
    expect((run.reversal is None) == (image.reversal is None), f"{where}: reversal {image.reversal}")
    if run.reversal and image.reversal:
        expect(run.reversal.after == image.reversal.after, f"{where}: reversal after {image.reversal.after} events")
        same(image.reversal.time.ball(BITS), time(run.reversal.time.ball(BITS)), f"{where}: reversal")
    same(image.final_time.ball(BITS), time(run.final_time.ball(BITS)), f"{where}: final_time")


def same_events(run: Iterable[Any], image: Iterable[Any], time: Callable[[arb], arb], where: str) -> None:
    """Contacts whatever the order of circles, and times."""
    run, image = list(run), list(image)
    for mine, other in zip(run, image, strict=False):
        sets = [{frozenset(contact) for contact in event.contacts} for event in (mine, other)]
        expect(sets[0] == sets[1], f"{where}: event {mine.index} has {other.contacts}, not {mine.contacts}")
        same(other.time.ball(BITS), time(mine.time.ball(BITS)), f"{where}: time of event {mine.index}")
    expect(len(run) == len(image), f"{where}: {len(image)} events, not {len(run)}")


def same(mine: arb, theirs: arb, where: str) -> None:
    """Two enclosures of one number."""
    off = abs(mine - theirs)
    names = [ball.str(20, radius=False) for ball in (mine, theirs)]
    expect(not off > CLOSE * (1 + abs(theirs)), f"{where}: {names[0]}, not {names[1]}")


def _ball(value: Number) -> arb:
    return Quantity.of(value).ball(BITS)


class _precision:
    """The working precision of flint within a block."""

    def __init__(self, bits: int) -> None:
        self.bits = bits

    def __enter__(self) -> None:
        self.saved, ctx.prec = ctx.prec, self.bits

    def __exit__(self, *_: object) -> None:
        ctx.prec = self.saved
