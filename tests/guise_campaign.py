"""One scene in many guises, which all must have the same history: no referee is needed, and no fault of one is shared.

python tests/guise_campaign.py --scenes 4000 --first 0      # counts, and every scene that differs
python tests/guise_campaign.py --replay 17                  # one scene, as TOML, and what differs

A guise is the scene with one velocity more of everything, in a mirror, turned, in other units of length and of time,
with discs and walls in another order, or begun a little later; and the same scene in
intervals, which certify what they say.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from random import Random
from typing import Any

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parent)

from arc_scenes import falls_to_arcs
from arc_scenes import scene_of as bows
from edge_campaign import scene_of
from falling_campaign import FALLING
from mpmath import mp, mpf
from settle_campaign import drawn

from truebreak.exact import ExactEngine
from truebreak.exact.numbers.system import Undecided
from truebreak.floating import IntervalEngine
from truebreak.scenarios import Arc, Quantity, Scene, SceneError, StopReason, Trajectory
from truebreak.scenarios.files import dump_toml

EVENTS, UNTIL, WORK = 10, Quantity.of(20), 400_000
NEAR = mpf(10) ** -22
ONE, NONE = Quantity.of(1), Quantity.of(0)
Two = tuple[Quantity, Quantity]

GUISED = replace(
    FALLING,
    name="guises",
    bases={
        **FALLING.bases,
        "arcs": bows,
        "bowls": falls_to_arcs,
        "floors": drawn,
    },
)
"""The scenes of what falls, and of arcs and of discs that settle."""


@dataclass(frozen=True)
class Guise:
    """A scene that must have the history of another.

    Args:
        scene: the other one.
        units: how many of its units of time one of the first is.
        after: how much later it begins, in the first's time.
        ordered: whether impulses of one instant are made in the same order.
    """

    scene: Scene
    units: Quantity = ONE
    after: Quantity = NONE
    ordered: bool = True


def mapped(scene: Scene, place: Callable[[Two], Two], speed: Callable[[Two], Two], pull: Any, size: Quantity) -> Scene:
    """A scene with its places, velocities, pull and lengths mapped; what stands stands on."""
    o, east, north = (place((Quantity.of(x), Quantity.of(y))) for x, y in ((0, 0), (1, 0), (0, 1)))
    mirror = ((east[0] - o[0]) * (north[1] - o[1]) - (east[1] - o[1]) * (north[0] - o[0])).sign() < 0

    def at(thing: Any, *names: str) -> dict[str, Quantity]:
        found: dict[str, Quantity] = {}
        for x, y in zip(names[::2], names[1::2], strict=True):
            change = speed if x == "vx" else place
            found[x], found[y] = change((getattr(thing, x), getattr(thing, y)))
        return found

    def bow(a: Any) -> Arc:
        ends = map(place, () if a.full else ((a.x0, a.y0), (a.x1, a.y1)))
        points = [value for end in (reversed(list(ends)) if mirror else ends) for value in end]
        return Arc(*place((a.x, a.y)), a.r * size, *points, id=a.id, full=a.full)

    four, velocity = ("x0", "y0", "x1", "y1"), ("vx", "vy")
    return scene.with_changes(
        circles=[replace(c, r=c.r * size, **at(c, "x", "y", *(() if c.fixed else velocity))) for c in scene.circles],
        walls=[replace(w, **at(w, *four, *velocity)) for w in scene.walls],
        segments=[replace(s, r=s.r * size, **at(s, *four, *velocity)) for s in scene.segments],
        polygons=[
            replace(p, points=[place(q) for q in p.points], r=p.r * size, **at(p, *velocity)) for p in scene.polygons
        ],
        arcs=[bow(a) for a in scene.arcs],
        pockets=[replace(p, r=p.r * size, **at(p, "x", "y")) for p in scene.pockets],
        gravity=None if scene.gravity is None else pull(scene.gravity),
    )


def turned_scene(scene: Scene) -> Scene:
    """A scene turned by 60 degrees, in other units of length: in a field of its own."""
    cos, sin, size = (Quantity.of(text) for text in ("1/2", "sqrt(3)/2", "3/7"))

    def turn(two: Two) -> Two:
        return size * (cos * two[0] - sin * two[1]), size * (sin * two[0] + cos * two[1])

    return mapped(scene, turn, turn, turn, size)


def _same(two: Two) -> Two:
    return two


def guises(scene: Scene, rng: Random, wait: Quantity | None) -> Iterator[tuple[str, Guise]]:
    """Each by name.

    Args:
        scene: the first.
        rng: draws velocities, angles and units.
        wait: a time before which nothing happens in it; None where there is none.
    """
    stands = (
        scene.arcs
        or scene.settle
        or scene.pockets
        or any(c.fixed for c in scene.circles)
        or scene.reverse_at is not None
        or scene.reverse_after is not None
    )
    if not stands:
        ux, uy = map(Quantity.of, rng.choice((("1/2", 0), (0, "1/3"), ("-2/7", "sqrt(2)/3"), (0, -1), (3, "1/9"))))
        yield "velocity", Guise(mapped(scene, _same, lambda v: (v[0] + ux, v[1] + uy), _same, ONE))

    def mirror(two: Two) -> Two:
        return -two[0], two[1]

    yield "mirror", Guise(mapped(scene, mirror, mirror, mirror, ONE))
    cos, sin = map(Quantity.of, rng.choice((("3/5", "4/5"), ("-5/13", "12/13"), (0, 1), ("sqrt(3)/2", "1/2"))))

    def turn(two: Two) -> Two:
        return cos * two[0] - sin * two[1], sin * two[0] + cos * two[1]

    yield "turned", Guise(mapped(scene, turn, turn, turn, ONE))
    size, time = Quantity.of(rng.choice(("3/2", "1/7", "1000"))), Quantity.of(rng.choice(("1/3", "5", "1/100")))

    def by(factor: Quantity) -> Callable[[Two], Two]:
        return lambda two: (two[0] * factor, two[1] * factor)

    other = mapped(scene, by(size), by(size / time), by(size / time / time), size)
    if scene.reverse_at is not None:
        other = other.with_changes(reverse_at=scene.reverse_at * time)
    yield "units", Guise(other, time)
    backward = scene.with_changes(circles=scene.circles[::-1], walls=scene.walls[::-1])  # ends bear the first's name
    yield "order", Guise(backward, ordered=False)
    if wait is not None:
        yield "later", Guise(_later(scene, wait), after=wait)


def _later(scene: Scene, wait: Quantity) -> Scene:
    """The scene as it is a little later, before anything happened."""
    gx, gy = scene.gravity or (NONE, NONE)

    def flown(thing: Any, *names: str, falls: bool = False) -> Any:
        found: dict[str, Quantity] = {}
        for x, y in zip(names[::2], names[1::2], strict=True):
            fall = wait * wait / 2 if falls else NONE
            found[x] = getattr(thing, x) + thing.vx * wait + gx * fall
            found[y] = getattr(thing, y) + thing.vy * wait + gy * fall
        if falls:
            found["vx"], found["vy"] = thing.vx + gx * wait, thing.vy + gy * wait
        return replace(thing, **found)

    turned = {} if scene.reverse_at is None else {"reverse_at": scene.reverse_at - wait}
    four = ("x0", "y0", "x1", "y1")
    return scene.with_changes(
        circles=[c if c.fixed else flown(c, "x", "y", falls=True) for c in scene.circles],
        walls=[flown(w, *four) for w in scene.walls],
        segments=[flown(s, *four) for s in scene.segments],
        polygons=[replace(p, points=[(x + p.vx * wait, y + p.vy * wait) for x, y in p.points]) for p in scene.polygons],
        **turned,
    )


def _time(value: Any) -> mpf:
    try:
        return mpf(value.digits(40))
    except Undecided:  # zero, as it seems, but too deep to be proved so
        return mpf(value.ball(400).mid().str(40, radius=False))


def _rows(run: Trajectory) -> list[tuple[mpf, frozenset[tuple[str, ...]], Counter[tuple[str, ...]]]]:
    """What happens at each instant: its time, who pushes whom, and how often."""
    rows: list[tuple[mpf, frozenset[tuple[str, ...]], Counter[tuple[str, ...]]]] = []
    for event in run.events:
        pushed = Counter(tuple(sorted(pair)) for pair in event.impulses)
        time = _time(event.time)
        if rows and rows[-1][0] == time:
            pushed = rows.pop()[2] + pushed
        rows.append((time, frozenset(pushed), pushed))
    return rows


def differs(one: Trajectory, other: Trajectory, guise: Guise) -> str:
    """Where two certified runs contradict each other; empty where neither does."""
    units, after = _time(guise.units), _time(guise.after)
    open_ends = (StopReason.UNDECIDED, StopReason.BUDGET, StopReason.ACCUMULATION, StopReason.CRUSHED)
    named = (one.stop.reason, other.stop.reason)  # an end may be seen earlier in one of them: both are right
    mine, theirs = _rows(one), _rows(other)

    def near(a: mpf, b: mpf) -> bool:
        return abs((a - after) * units - b) <= NEAR * (1 + abs(b))

    for k, (a, b) in enumerate(zip(mine, theirs, strict=False)):
        last = k + 1 in (len(mine), len(theirs))  # of what happens at once one may have a part
        if not near(a[0], b[0]):
            return f"event {k} at {float(a[0])}, not {float(b[0])} / {float(units)} + {float(after)}"
        if a[2] != b[2] and (guise.ordered or len(a[2]) == len(b[2]) == 1) and not last:
            return f"event {k}: {dict(a[2])}, not {dict(b[2])}"
        if not guise.ordered and max(sum(a[2].values()), sum(b[2].values())) > 1:
            return ""  # who pushes first depends on the order
        if last and not (a[1] <= b[1] or b[1] <= a[1]):
            return f"event {k}: {sorted(a[1])}, not {sorted(b[1])}"
    if (len(set(named)) == 2 and set(named).intersection(open_ends)) or StopReason.UNDECIDED in named:
        return ""
    if (len(one.events), one.stop.reason) != (len(other.events), other.stop.reason):
        return (
            f"{len(one.events)} events to {one.stop.reason.name}, not {len(other.events)} to {other.stop.reason.name}"
        )
    for name, thing in (("settlings", "wall"), ("pocketings", "pocket")):
        rows = [
            sorted((_time(s.time), s.circle, getattr(s, thing)) for s in getattr(run, name)) for run in (one, other)
        ]
        if [r[1:] for r in rows[0]] != [r[1:] for r in rows[1]] or not all(
            near(a[0], b[0]) for a, b in zip(*rows, strict=True)
        ):
            return f"{name} {rows[0]}, not {rows[1]}"
    return ""


def examined(seed: int, counts: Counter[str], kinds: Sequence[str] = ()) -> Iterator[str]:
    """What differs in one scene, guise by guise."""
    aged = scene_of(seed, GUISED)
    if aged is None:
        return
    scene, until, rng = aged.scene, aged.until, Random(f"guise {seed}")
    engine = ExactEngine(work=WORK)
    try:
        run = engine.run(scene, until=until, events=EVENTS)
    except SceneError:  # what has been added does not go with the rest
        counts["no scene"] += 1
        return
    counts["scenes"] += 1
    counts["events"] += len(run.events)
    counts["ends " + run.stop.reason.name] += 1
    first = min((float(e.time) for e in (*run.events, *run.pocketings, *run.settlings)), default=0.0)
    turned = float(scene.reverse_at) if scene.reverse_at is not None else first
    wait = Quantity.of(f"{int(min(first, turned) * 500)}/1000") if 0.01 < min(first, turned) < 10**6 else None
    for name, guise in guises(scene, rng, wait):
        if kinds and name not in kinds:
            continue
        try:
            again = engine.run(guise.scene, until=(until - guise.after) * guise.units, events=EVENTS)
        except SceneError as error:
            yield f"{seed} {name}: refused: {error}"
            continue
        counts[name] += 1
        counts[f"{name} events"] += min(len(run.events), len(again.events))
        if found := differs(run, again, guise):
            yield f"{seed} {name}: {found} {aged.ingredients}"
    if not kinds or "intervals" in kinds:
        try:
            bounds = IntervalEngine(bits=120).run(scene, until=until, events=EVENTS)
        except SceneError:
            return
        counts["intervals"] += 1
        for a, b in zip(run.events, bounds.events, strict=False):
            if {frozenset(c) for c in a.contacts} != {frozenset(c) for c in b.contacts}:
                yield f"{seed} intervals: event {a.index}: {a.contacts}, not {b.contacts} {aged.ingredients}"
                break
            counts["intervals events"] += 1


def main() -> int:
    """Runs a span of seeds; 1 where something differs."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--scenes", type=int, default=200, help="seeds to go through")
    parser.add_argument("--first", type=int, default=0, help="the seed to begin with")
    parser.add_argument("--kinds", default="", help="guises, separated by commas (default: all)")
    parser.add_argument("--replay", type=int, default=None, help="print this scene, and what differs")
    given = parser.parse_args()
    counts, bad, mp.dps = Counter[str](), 0, 60
    kinds = tuple(filter(None, given.kinds.split(",")))
    if given.replay is not None:
        aged = scene_of(given.replay, GUISED)
        print("no scene" if aged is None else dump_toml(aged.scene))
    seeds = range(given.first, given.first + given.scenes) if given.replay is None else [given.replay]
    for seed in seeds:
        try:
            for found in examined(seed, counts, kinds):
                bad += 1
                print(found, flush=True)
        except Exception as error:
            bad += 1
            print(f"{seed}: {type(error).__name__}: {error}", flush=True)
    for name, count in counts.most_common():
        print(f"{count:8} {name}")
    print(f"{bad} differ")
    return bool(bad)


if __name__ == "__main__":
    sys.exit(main())
