"""What two runs of one engine have to do with each other, whatever the truth is: metamorphic relations, by name."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from random import Random
from typing import Any

from flint import arb  # type: ignore[attr-defined]

from fuzz.check import GAVE_UP, expect
from fuzz.draft import Case
from fuzz.ingredients import Mixed
from fuzz.maps import BITS, MAPS, Map, _ball, _precision, check_cut, check_interval, check_map, same, same_history
from truebreak.exact import ExactEngine
from truebreak.exact.certified import certified_decider as bits_of_a_run
from truebreak.exact.certified.cascade import NestedRoots
from truebreak.exact.numbers.system import Undecided
from truebreak.exact.replay import refinable
from truebreak.exact.simulation import cells as grid
from truebreak.floating import IntervalEngine
from truebreak.scenarios import Circle, Quantity, Trajectory, Wall
from truebreak.scenarios.numbers.precision import decimals_of

FEW_CELLS = 3
"""Circles from which on there are cells in a scene with a crowd."""
DEEP_BITS = BITS + 3000
"""Bits of a number that is 10**-700 times as large as the one that it is compared with."""
PAST_WORK = 20_000
"""Work for a question in the relation of the past: more bits prove no zero."""
FORM_WORK = 60_000
"""Work for a question in the relation of forms, for which they need little."""
MOST_BACK = 200
"""Events of a run there and back: a point in a wedge may have thousands more just after the last one asked for."""
LITTLE_WORK = (3_000, 30_000)
"""Work for a question in the relation of little work."""


@contextmanager
def cells_from(count: int) -> Iterator[None]:
    """Cells from so many circles on."""
    before, grid.FEWEST = grid.FEWEST, count
    try:
        yield
    finally:
        grid.FEWEST = before


@contextmanager
def midpoints_from(bits: int) -> Iterator[None]:
    """Midpoints with a set of deviations from so many bits on."""
    before, bits_of_a_run.LONG_BITS = bits_of_a_run.LONG_BITS, bits
    try:
        yield
    finally:
        bits_of_a_run.LONG_BITS = before


@contextmanager
def without_roots() -> Iterator[None]:
    """No number is proved zero in nested roots."""
    before, NestedRoots.sign = NestedRoots.sign, lambda *_: (None, "nested roots were left out")
    try:
        yield
    finally:
        NestedRoots.sign = before


@contextmanager
def field_up_to(bits: int) -> Iterator[None]:
    """Circles leave the scene's field with the first blow after which their numbers have more bits."""
    before, refinable.FIELD_BITS = refinable.FIELD_BITS, bits
    try:
        yield
    finally:
        refinable.FIELD_BITS = before


def again(case: Case, engine: Any) -> Trajectory:
    """The run of a case."""
    return engine.run(case.scene, until=case.until, events=case.events)


def the_same(run: Trajectory, other: Trajectory, where: str) -> bool:
    """Two runs of one scene: all of the history, the order of impulses and the final state.

    False where one of them gave up.
    """
    if {run.stop.reason.name, other.stop.reason.name} & set(GAVE_UP):
        return False
    with _precision(BITS):
        same_history(run, other, lambda time: time, where)
        mine, theirs = ([e.impulses for e in r.events] for r in (run, other))
        expect(mine == theirs, f"{where}: impulses {theirs}, not {mine}")
        for one in run.final.circles:
            for key in ("x", "y", "vx", "vy"):
                theirs_ = getattr(other.final[one.id], key).ball(BITS)
                same(theirs_, getattr(one, key).ball(BITS), f"{where}: final {one.id}.{key}")
    return True


# -- the relations


def resumed(run: Trajectory, mix: Mixed, draw: Random, engine: Any) -> bool:
    """Broken off after some events, or at a time between, and resumed: the same as in one go."""
    case = mix.case
    turns = mix.case.scene.reverse_at is not None or mix.case.scene.reverse_after is not None
    if len(run.events) < 2 or (turns and case.until is None and case.events is None):
        return False
    k = draw.randrange(1, len(run.events))
    limits: dict[str, Any] = {"events": k}
    if draw.random() >= 0.5:  # a double may lie past thousands of events that are closer to each other than doubles
        limits = {"until": _between(run, k), "events": len(run.events)}
    first = engine.run(case.scene, **limits)
    if first.stop.reason.name in GAVE_UP or not first.events or len(first.events) >= len(run.events):
        return False
    limits = {"until": case.until, "events": case.events}
    if case.until is None and case.events is None:
        limits = {"until": case.scene.until, "events": case.scene.events or 10**6}
    return the_same(run, engine.resume(first, **limits), f"resumed after {len(first.events)} events")


def resumed_on_the_way(run: Trajectory, case: Case, draw: Random, engine: Any) -> bool:
    """Broken off after some events of the way out, and resumed to the last event: the same as in one go; False where
    there is too little of it.

    Raises:
        Difference: where the two differ.
    """
    out = run.reversal.after if run.reversal else len(run.events) - 1
    if not 1 <= out < len(run.events) or run.stop.reason.name in GAVE_UP:
        return False
    limits, k = {"events": len(run.events)}, draw.randrange(max(1, out // 2), out + 1)
    first = engine.run(case.scene, events=k)
    if first.stop.reason.name in GAVE_UP:
        return False
    whole, rest = engine.run(case.scene, **limits), engine.resume(first, **limits)
    expect(rest.stop.reason == whole.stop.reason, f"resumed after {k} events: stops with {rest.stop}")
    return the_same(whole, rest, f"resumed after {k} events")


def with_one_at_rest(run: Trajectory, case: Case, engine: Any) -> bool:
    """With a small circle at rest beside all others, listed last: the same; False where it is met.

    Raises:
        Difference: where the two differ.
    """
    scene = case.scene
    x, y = (max(abs(getattr(circle, key)) + circle.r for circle in scene.circles) + 9 for key in ("x", "y"))
    aside = Circle(x, y, Quantity.of("1/64"), id="aside")
    if scene.walls or scene.pockets or any(circle.id == "aside" for circle in scene.circles):
        return False
    other = again(replace(case, scene=scene.with_changes(circles=[*scene.circles, aside])), engine)
    if any("aside" in contact for event in other.events for contact in event.contacts):
        return False
    return the_same(run, other, "with one at rest")


def _between(run: Trajectory, k: int) -> Quantity:
    """A time between two events, or of the first of them where doubles tell none."""
    early, late = (float(run.events[j].time) for j in (k - 1, k))
    middle = Quantity.of((early + late) / 2)
    return middle if early < float(middle) < late else Quantity.of(max(late, 1e-3))


def scaled(run: Trajectory, mix: Mixed, _: Random, engine: Any) -> bool:
    """In units beyond the doubles: the history of the scene, in these units."""
    length, time, mass = (Quantity.of(10) ** power for power in mix.reach)
    by = Map("beyond doubles", stretch=length, pace=1 / time, weight=mass)
    image = again(by.case(mix.case), engine)
    if {run.stop.reason.name, image.stop.reason.name} & set(GAVE_UP):
        return False
    where = f"scaled by 10**{mix.reach}"
    with _precision(2 * DEEP_BITS):
        times, lengths = time.ball(DEEP_BITS), length.ball(DEEP_BITS)
        expect(run.stop.reason == image.stop.reason, f"{where}: stops with {image.stop}, not {run.stop}")
        expect(len(run.events) == len(image.events), f"{where}: {len(image.events)} events, not {len(run.events)}")
        for mine, other in zip(run.events, image.events, strict=True):
            expect(set(mine.contacts) == set(other.contacts), f"{where}: event {mine.index} has {other.contacts}")
            same(other.time.ball(DEEP_BITS) / times, mine.time.ball(BITS), f"{where}: time of event {mine.index}")
            digits = other.time.digits(20)
            expect((digits == "0") == (mine.time.digits(20) == "0"), f"{where}: digits {digits}")
        entries = [[(p.circle, p.pocket) for p in r.pocketings] for r in (run, image)]
        expect(entries[0] == entries[1], f"{where}: pocketings {entries[1]}, not {entries[0]}")
        for one in run.final.circles:
            for key, unit in (("x", lengths), ("y", lengths), ("vx", lengths / times), ("vy", lengths / times)):
                value = getattr(image.final[one.id], key).ball(DEEP_BITS) / unit
                same(value, getattr(one, key).ball(BITS), f"{where}: final {one.id}.{key}")
    return True


def mapped(run: Trajectory, mix: Mixed, draw: Random, engine: Any) -> bool:
    """Under an exact map (turned, mirrored, scaled, shifted, boosted, in another order): the mapped history."""
    by = draw.choice([m for m in MAPS if m.fits(mix.case.scene)])
    return check_map(run, mix.case, by, engine)


def cut_in_two(run: Trajectory, mix: Mixed, draw: Random, engine: Any) -> bool:
    """The state at a time written as text, and played on: the rest."""
    return check_cut(run, mix.case, draw, engine)


def by_intervals(run: Trajectory, mix: Mixed, draw: Random, _: Any) -> bool:
    """The interval engine contradicts nothing before it stops."""
    if run.stop.reason.name in GAVE_UP:
        return False
    return check_interval(run, mix.case, IntervalEngine(bits=draw.choice([53, 120, 300]))) > 0


def without_cells(run: Trajectory, mix: Mixed, _: Random, engine: Any) -> bool:
    """With cells from three circles on, or with none: the same."""
    had = run.plan.get("cells crossed", 0) > 0
    with cells_from(10**9 if had else FEW_CELLS):
        return the_same(run, again(mix.case, engine), "without cells" if had else "with cells")


def with_midpoints(run: Trajectory, mix: Mixed, _: Random, engine: Any) -> bool:
    """With midpoints and deviations from few bits on: the same."""
    with midpoints_from(300):
        return the_same(run, again(mix.case, engine), "with midpoints")


def beside_deep_numbers(run: Trajectory, mix: Mixed, draw: Random, engine: Any) -> bool:
    """Beside a fixed circle far away, whose number is too deep for a field, so that all is in balls: the same."""
    scene = mix.case.scene
    x = Quantity.of("sqrt(2 + sqrt(3 + sqrt(5 + sqrt(7 + sqrt(11)))))") + 10**60 + draw.randrange(9)
    y = Quantity.of(10**60 + draw.randrange(1, 9) * 10**59)
    if any(c.id == "far" for c in scene.circles) or not all(_far_from(wall, x, y) for wall in scene.walls):
        return False
    far = Circle(x, y, m="oo", id="far")
    other = again(replace(mix.case, scene=scene.with_changes(circles=[*scene.circles, far])), engine)
    return the_same(run, other, "beside deep numbers")


def _far_from(wall: Wall, x: Quantity, y: Quantity) -> bool:
    """Whether a place is 10**50 and more from a wall's line."""
    along = (wall.x1 - wall.x0, wall.y1 - wall.y0)
    cross, length = along[0] * (y - wall.y0) - along[1] * (x - wall.x0), abs(along[0]) + abs(along[1])
    return abs(cross) > length * 10**50


def by_form(run: Trajectory, mix: Mixed, draw: Random, engine: Any) -> bool:
    """Out of the field from the first blow on, so that ties are proved by the form of the past: the same, also if
    broken off and resumed."""
    with field_up_to(0):
        less = ExactEngine(work=FORM_WORK) if isinstance(engine, ExactEngine) else engine
        found = the_same(run, other := again(mix.case, less), "by form")
        if found and "resume" in mix.row:
            resumed(other, mix, draw, less)
        return found


def by_past(run: Trajectory, mix: Mixed, draw: Random, engine: Any) -> bool:
    """As `form`, and without nested roots: what the way back and the form of the past prove, or nothing proves. As far
    as that goes, the same."""
    if run.stop.reason.name in GAVE_UP:
        return False
    less = ExactEngine(work=PAST_WORK) if isinstance(engine, ExactEngine) else engine
    with field_up_to(0), without_roots():
        other = again(mix.case, less)
    expect(len(other.events) <= len(run.events), "by the past: more events than there are")
    with _precision(BITS):
        for mine, theirs in zip(run.events, other.events, strict=False):
            expect(mine.contacts == theirs.contacts, f"by the past: event {mine.index} has {theirs.contacts}")
            expect(mine.impulses == theirs.impulses, f"by the past: impulses {theirs.impulses}, not {mine.impulses}")
            same(theirs.time.ball(BITS), mine.time.ball(BITS), f"by the past: time of event {mine.index}")
    return the_same(run, other, "by the past")


def prefix(run: Trajectory, mix: Mixed, draw: Random, engine: Any) -> bool:
    """A run to fewer events has the first of them, and the reversal if it comes before the last."""
    scene, turned = mix.case.scene, run.reversal.after if run.reversal else 0
    if len(run.events) < 2 or run.stop.reason.name in GAVE_UP:
        return False
    k = turned if turned and draw.random() < 0.5 else draw.randrange(1, len(run.events))
    short = engine.run(scene, events=k)
    if short.stop.reason.name in GAVE_UP:
        return False
    expect(bool(short.reversal) == (run.reversal is not None and turned < k), f"prefix: reversal {short.reversal}")
    for mine, other in zip(run.events[:k], short.events, strict=True):
        expect(mine.contacts == other.contacts, f"prefix: event {mine.index} has {other.contacts}, not {mine.contacts}")
        expect(mine.time.digits(40) == other.time.digits(40), f"prefix: time of event {mine.index}")
    return True


def there_and_back(run: Trajectory, mix: Mixed, _: Random, engine: Any) -> bool:
    """Turned back at the end: home again with opposite velocities, where no tie lets an order choose."""
    scene = mix.case.scene
    if scene.reverse_at or scene.reverse_after or run.stop.reason.name in GAVE_UP or not run.events:
        return False
    if run.pocketings or any(len(event.contacts) > 1 for event in run.events):
        return False
    half = Quantity.of(float(run.events[-1].time) + 0.125)
    if half <= 0 or (len(run.events) > 1 and float(half) > 1e9):
        return False
    back = engine.run(scene.with_changes(reverse_at=half), until=2 * half, events=MOST_BACK)
    if back.stop.reason.name in (*GAVE_UP, "EVENTS") or any(len(event.contacts) > 1 for event in back.events):
        return False
    if back.pocketings:  # after the last event that was asked for
        return False
    with _precision(BITS):
        if back.events and not back.events[-1].time.ball(BITS) < _ball(2 * half):
            return False  # what touches at time 0, and parts, comes back to touch at that very time
        for one, start in zip(back.final.circles, scene.circles, strict=True):
            for key, value in (("x", start.x), ("y", start.y), ("vx", -start.vx), ("vy", -start.vy)):
                same(getattr(one, key).ball(BITS), _ball(value), f"there and back: {one.id}.{key}")
    return True


def little_work(run: Trajectory, mix: Mixed, draw: Random, _: Any) -> bool:
    """With little work for a question a scene and its quarter turn end at one place, and what is there is right."""
    engine = ExactEngine(work=draw.choice(LITTLE_WORK))
    turned = next(m for m in MAPS if m.name == "turn 90").case(mix.case)
    one, other = again(mix.case, engine), again(turned, engine)
    expect(one.stop.reason == other.stop.reason, f"little work: {other.stop} a quarter turn on, not {one.stop}")
    expect(len(one.events) == len(other.events), f"little work: {len(other.events)} events, not {len(one.events)}")
    if run.stop.reason.name not in GAVE_UP:
        for mine, theirs in zip(run.events, one.events, strict=False):
            expect(mine.contacts == theirs.contacts, f"little work: event {mine.index} has {theirs.contacts}")
        expect(len(one.events) <= len(run.events), "little work: more events than there are")
    return True


def digits(run: Trajectory, mix: Mixed, draw: Random, engine: Any) -> bool:
    """Digits, balls, doubles and texts of one number agree, and those of two runs are the same."""
    other = again(mix.case, engine)
    if {run.stop.reason.name, other.stop.reason.name} & set(GAVE_UP):
        return False
    for mine, theirs in zip(run.final.circles[:6], other.final.circles, strict=False):
        for key in ("x", "y", "vx", "vy"):
            one, two, count = getattr(mine, key), getattr(theirs, key), draw.choice([3, 17, 40])
            try:
                one.digits(2)
                told = two.digits(count) if draw.random() < 0.5 else (two.ball(900), two.digits(count))[1]
            except Undecided:  # it may be zero, or half-way between two decimals, and is not proved to be
                unclear = [decimals_of(one.ball(900), most) is None for most in (2, count)]
                expect(any(unclear), f"digits: those of {mine.id}.{key} are undecided")
                continue
            expect(one.digits(count) == told, f"digits: {mine.id}.{key} is {told}, not {one.digits(count)}")
            value = Quantity.of(told.replace("e+", "*10**").replace("e", "*10**"))
            with _precision(BITS):
                off = abs(value.ball(BITS) - one.ball(BITS))
                least = abs(one.ball(BITS)) * arb(10) ** (1 - count) + arb(2) ** -BITS
                expect(not off > least, f"digits: {told} of {mine.id}.{key} are not those of its ball")
                expect((told == "0") == (one.digits(2) == "0"), f"digits: zero of {mine.id}.{key}")
                low, high = one.bounds()
                expect(not (arb(low) > one.ball(BITS) or arb(high) < one.ball(BITS)), f"digits: {key} out of bounds")
                expect(low <= float(one) <= high, f"digits: the double of {mine.id}.{key}")
            if (text := one.text()) is not None and len(text) < 200:
                expect((Quantity.of(text).sign() == 0) == (told == "0"), f"digits: text {text} beside {told}")
    return True


Relation = Callable[[Trajectory, Mixed, Random, Any], bool]
RELATIONS: dict[str, Relation] = {
    "map": mapped,
    "resume": resumed,
    "scale": scaled,
    "cut": cut_in_two,
    "interval": by_intervals,
    "cells": without_cells,
    "midpoints": with_midpoints,
    "deep": beside_deep_numbers,
    "form": by_form,
    "past": by_past,
    "prefix": prefix,
    "back": there_and_back,
    "work": little_work,
    "digits": digits,
}
EVERY = ("resume", "scale")
"""Those that are ingredients: checked where a row has them."""
PROVED = {"reversal", "twin"}
"""What lets zeros be proved by the way back and by symmetry: rows with these have the relation of the past."""


def wanted_of(row: frozenset[str], seed: int) -> tuple[str, ...]:
    """The relations of a row: those that are its ingredients, one more by turns, that of forms, and that of the past
    where a row has what proves zeros then."""
    others = [name for name in RELATIONS if name not in (*EVERY, "past")]
    named = [*(name for name in EVERY if name in row), *(("past",) if row & PROVED else ())]
    return tuple(dict.fromkeys([*named, others[seed % len(others)], "form"]))


def check_relations(run: Trajectory, mix: Mixed, seed: int, engine: Any) -> frozenset[str]:
    """Checks those that a row has, and one more by turns; the names of those that applied.

    Raises:
        Difference: where one of them does not hold.
    """
    found = set[str]()
    for name in wanted_of(mix.row, seed):
        if RELATIONS[name](run, mix, Random(f"{name}:{seed}"), engine):
            found.add(name)
    return frozenset(found)
