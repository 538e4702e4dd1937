"""Scenes in which discs settle, are struck and leave, against a referee of their own.

python tests/settle_campaign.py --scenes 2000 --first 0      # counts, and every scene that differs
python tests/settle_campaign.py --scenes 2000 --engines      # engines of finite precision against the certified run
python tests/settle_campaign.py --scenes 2000 --guises       # mirrored, in another order, seen from another frame
python tests/settle_campaign.py --scenes 2000 --corners      # in corners of two slopes at right angles
python tests/settle_campaign.py --scenes 2000 --bounces      # with bounces that come to an end; for each of these
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from random import Random
from typing import TypeAlias

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parent)

from gravity_referee import DIGITS, Body, number
from mpmath import mpf, nstr, workdps
from peg_referee import NotForThis
from settle_referee import SettleReferee

from truebreak.exact import ExactEngine
from truebreak.exact.simulation import endings
from truebreak.floating import DoubleEngine, IntervalEngine, QuadEngine, RoundedEngine, SingleEngine
from truebreak.scenarios import Circle, Quantity, Scene, SceneError, Wall
from truebreak.scenarios.numbers.quantity import Real
from truebreak.scenarios.trajectory import StopReason, Trajectory

EVENTS, MORE = 24, 200
NEAR, AFTER = mpf(10) ** -30, mpf(10) ** -45

AMID = mpf("0.37")
"""Share of the time of bounces that are not listed after which places are compared, too."""

FINE = mpf(10) ** -16
"""Bounces that end in less are not for the referee, nor events so soon after others, nor what follows: where hits of
discs come ever faster, and between any two of them are infinitely many bounces, it soon takes the one for the other."""


def drawn(seed: int) -> Scene | None:
    """Discs that fall onto a floor, or start on it, beside walls and fixed discs; now and then gravity is aslant."""
    rng = Random(f"settle {seed}")

    def some(low: int, high: int) -> str:
        return f"{rng.randint(low * 100, high * 100)}/100"

    e = rng.choice(("0", "0", "0", "1", "1/2", "1/5", "sqrt(2)/4"))
    circles: list[Circle] = []
    for k in range(rng.choice((1, 2, 2, 3, 3, 4))):
        r = rng.choice(("1/2", "1", "1/4", "3/4", "sqrt(2)/2"))
        y = r if rng.random() < 0.3 else some(2, 14)
        vx = rng.choice(("0", some(-2, 2), some(-2, 2)))
        vy = "0" if y == r else rng.choice(("0", some(-3, 3)))
        circles.append(Circle(some(-6, 6), y, r, vx, vy, rng.choice(("1", "2", "1/3")), id=f"b{k}"))
    circles += [
        Circle(some(-7, 7), some(0, 6), rng.choice(("1/2", "1/3", "1")), m="oo", id=f"peg{k}")
        for k in range(rng.choice((0, 0, 1, 2)))
    ]
    walls = [Wall(0, 0, 1, 0, id="floor")]
    walls += [Wall(x, 0, x, 1, id=f"side{x}") for x in (-8, 8) if rng.random() < 0.6]
    if rng.random() < 0.2:
        walls.append(Wall(9, 0, 12, 4, id="tilted"))
    if rng.random() < 0.5:
        circles = circles[::-1]
    gravity = ("0", "-10") if rng.random() < 0.8 else ("0", rng.choice(("-1", "-sqrt(3)", "-981/100")))
    try:
        return Scene(circles, walls, gravity=gravity, restitution=e, settle=True)
    except SceneError:
        return None


def cornered(seed: int) -> Scene | None:
    """Discs that lie in a corner of two slopes at right angles, or fall into it, and others that come to them."""
    rng = Random(f"cornered {seed}")
    p, q, size = rng.choice(((3, 4, 5), (4, 3, 5), (5, 12, 13), (1, 1, 0), (8, 15, 17), (12, 5, 13)))
    length = f"{size}" if size else "sqrt(2)"
    r = Quantity.of(rng.choice(("1/2", "1", "3/4")))
    middle = [Quantity.of(f"({part})/{length}") * r for part in (q - p, p + q)]
    circles = [Circle(*middle, r, id="low")] if rng.random() < 0.6 else []
    if not circles or rng.random() < 0.5:
        over = Quantity.of(f"{rng.randint(0, 40)}/100") if circles or rng.random() < 0.5 else Quantity.of(0)
        high = 3 + len(circles) * 2 + Quantity.of(f"{rng.randint(0, 300)}/100")
        circles.append(Circle(middle[0] + over, middle[1] + high, r, 0, 0, rng.choice(("1", "2", "1/3")), id="falls"))
    if rng.random() < 0.4:
        side = f"{rng.randint(-200, 200)}/100"
        circles.append(Circle(side, f"{rng.randint(900, 1400)}/100", "1/2", "1/3", -1, id="other"))
    walls = [Wall(0, 0, -p, q, id="left"), Wall(0, 0, q, p, id="right")]
    if rng.random() < 0.5:
        circles = circles[::-1]
    e = rng.choice(("0", "1/2", "1/2", "1/5", "3/10", "1"))
    try:
        return Scene(circles, walls[:: rng.choice((1, -1))], gravity=("0", "-10"), restitution=e, settle=True)
    except SceneError:
        return None


def bouncing(seed: int) -> Scene | None:
    """The same with a restitution at which bounces come to an end soon."""
    scene = drawn(seed)
    e = Random(f"bouncing {seed}").choice(("1/2", "1/5", "1/10", "3/10", "sqrt(2)/4"))
    return None if scene is None else scene.with_changes(restitution=e)


def differs(run: Trajectory, scene: Scene) -> str:
    """What of a certified run is otherwise in the referee's; nothing where all is as it is there."""
    with workdps(DIGITS):
        end = mpf(run.final_time.digits(DIGITS)) if hasattr(run.final_time, "digits") else mpf(str(run.final_time))
        e = number(scene.restitution)
        rests = [(mpf(s.since.digits(80)), mpf(s.time.digits(80)), s) for s in run.settlings if s.since is not None]
        times = [mpf(0), *(mpf(event.time.digits(60)) for event in run.events)]
        fine = [since - (rest - since) * (1 / e - 1) / 2 for since, rest, _ in rests if rest - since < FINE]
        fine += [
            (before + now) / 2
            for before, now, then in zip(times, times[1:], times[2:], strict=False)
            if 0 < then - now < FINE
        ]
        end = min([end, *fine])
        did = SettleReferee(scene).run(
            end + AFTER, len(run.events) + (8 if scene.restitution.sign() == 0 else 600 + 29 * len(run.events))
        )
        pushes = [{tuple(sorted(link)) for link in event.impulses} for event in run.events]
        mine = [row for row in zip(times[1:], pushes, strict=True) if row[0] <= end + AFTER]
        untold = [  # from midway between two bounces
            (since + (rest - since) * (1 - e) / 2, rest + NEAR, tuple(sorted((s.circle, wall))))
            for since, rest, s in rests
            for wall in {s.wall, s.other or s.wall}
        ]
        for i, who in enumerate(
            str(circle.id) for circle in scene.circles
        ):  # bounces that are not listed, and go on as the run ends
            met = [(time, link) for time, links in mine for link in links if who in link]
            if met and not fine and run.motion.carries(i, run.final_time):
                time, _ = met[-1]
                if not any(s.circle == who and rest > time - NEAR for _, rest, s in rests):
                    untold += [(time + NEAR, end + 1, both) for then, both in met if then == time]
        theirs = [
            (time, found)
            for time, links in did.hits
            if time <= end + AFTER
            and (
                found := {
                    link
                    for link in map(tuple, map(sorted, links))
                    if not any(since < time < rest and link == both for since, rest, both in untold)
                }
            )
        ]
        for k, (one, other) in enumerate(zip(mine, theirs, strict=False)):
            if abs(one[0] - other[0]) > NEAR or one[1] != other[1]:
                return f"event {k}: {float(one[0])!r} {one[1]} against {float(other[0])!r} {other[1]}"
        if len(mine) != len(theirs):
            return f"{len(mine)} events against {len(theirs)}"
        settled = [(mpf(s.time.digits(60)), s.circle, s.wall) for s in run.settlings]
        settled = [row for row in settled if row[0] <= end + AFTER]
        theirs_settled = [row for row in did.settled if row[0] <= end + AFTER]
        if [row[1:] for row in settled] != [row[1:] for row in theirs_settled]:
            return f"settled {[row[1:] for row in settled]} against {[row[1:] for row in theirs_settled]}"
        if any(abs(a[0] - b[0]) > NEAR for a, b in zip(settled, theirs_settled, strict=True)):
            return f"settled at {[float(row[0]) for row in settled]}, not {[float(row[0]) for row in theirs_settled]}"
        if run.stop.reason is StopReason.HORIZON and not fine and (off := misplaced(run, run.final_time, did.bodies)):
            return f"at the end: {off}"
        for since, rest, _ in [row for row in rests if row[1] < end][:2]:
            time = nstr(since + (rest - since) * AMID, 45)
            there = SettleReferee(scene).run(mpf(time), 700 + 29 * len(run.events))
            if off := misplaced(run, Quantity.of(time), there.bodies):
                return f"amid bounces, at {time}: {off}"
    return ""


def misplaced(run: Trajectory, time: Real, bodies: list[Body]) -> str:
    """Who is not where the referee has it, or not as fast."""
    for row, body in zip(run.at(time).circles, bodies, strict=True):
        for name in ("x", "y", "vx", "vy"):
            value = getattr(row, name).ball(128)
            off = mpf(value.mid().str(60, radius=False)) - getattr(body, name)
            if abs(off) > NEAR:
                return f"{row.id}.{name} is {float(value)} against {float(getattr(body, name))}, {off}"
    return ""


def examined(seed: int, counts: Counter[str], draw: Callable[[int], Scene | None] = drawn) -> str:
    """What differs in one scene; its stop is counted."""
    scene = draw(seed)
    if scene is None:
        counts["no scene"] += 1
        return ""
    run = ExactEngine(work=300_000).run(scene, until=12, events=EVENTS if draw is drawn else MORE)
    counts[run.stop.reason.name] += 1
    counts["settlings"] += len(run.settlings)
    counts["after infinitely many bounces"] += sum(s.since is not None for s in run.settlings)
    counts["events"] += len(run.events)
    if run.stop.reason is StopReason.UNDECIDED:
        counts["undecided: " + run.stop.message.split("proved: ")[1].split(",")[0][:40]] += 1
    try:
        found = differs(run, scene)
    except NotForThis as reason:
        counts[f"not for the referee: {reason}"] += 1
        return ""
    counts["compared"] += 1
    return found


FLOATS = DoubleEngine(), SingleEngine(), QuadEngine(), RoundedEngine(bits=40)
INTERVALS = IntervalEngine(), IntervalEngine(200)

LATE, AWAY = 2.0**-8, 2.0**-4
"""How late an event of single precision may be, and how far off a circle: more is no rounding in so few events."""

FEW = 6
"""Events of engines of less than 53 bits: errors grow beyond all bounds in more."""

Told: TypeAlias = tuple[float, frozenset[tuple[str, ...]]]


def told(run: Trajectory) -> list[Told]:
    """When each event is, and what pushes."""
    return [(float(event.time), frozenset(tuple(sorted(link)) for link in event.impulses)) for event in run.events]


def strays(run: Trajectory, true: Trajectory, late: float = LATE) -> str:
    """What of a run is otherwise than in the certified one, up to where the first of them ends.

    Rounding may part what pushes at one instant, or let more push; so events are compared up to the first in which the
    certified run has, or this one adds, more than one push.
    """
    whole = True
    for k, (mine, theirs) in enumerate(zip(told(run), told(true), strict=False)):
        if abs(mine[0] - theirs[0]) > late or mine[1] != theirs[1]:
            if len(theirs[1]) > 1 or len(mine[1]) > 1:
                whole = False
                break
            return f"event {k}: {mine} against {theirs}"
    if not whole:
        return ""
    end = min(float(run.final_time), float(true.final_time)) - late
    settled = [[(s.circle, s.wall) for s in r.settlings if float(s.time) < end] for r in (run, true)]
    if settled[0] != settled[1]:
        return f"settled {settled[0]} against {settled[1]}"
    for share in (0.3, 0.6, 0.9):
        if end <= 0 or any(abs(event.time.__float__() - end * share) < late for event in true.events):
            continue
        for mine, theirs in zip(run.at(end * share).circles, true.at(end * share).circles, strict=True):
            off = max(abs(float(getattr(mine, name)) - float(getattr(theirs, name))) for name in ("x", "y"))
            if off > (AWAY if late == LATE else 1e-6):
                return f"{mine.id} at {end * share}: off by {off}"
    return ""


def contradicts(run: Trajectory, true: Trajectory) -> str:
    """What of a run in intervals does not hold what the certified run has."""
    for k, (mine, theirs) in enumerate(zip(run.events, true.events, strict=False)):
        links = [{tuple(sorted(link)) for link in event.impulses} for event in (mine, theirs)]
        if links[0] != links[1] or not mine.time.low <= float(theirs.time) <= mine.time.high:
            return f"event {k}: {mine} against {theirs}"
    if len(run.events) > len(true.events) and true.stop.reason is not StopReason.EVENTS:
        return f"{len(run.events)} events against {len(true.events)}"
    for mine, theirs in zip(run.settlings, true.settlings, strict=False):
        same = (mine.circle, mine.wall) == (theirs.circle, theirs.wall)
        if not same or not mine.time.low <= float(theirs.time) <= mine.time.high:
            return f"settled: {mine} against {theirs}"
    if run.events and len(run.events) <= len(true.events):
        last, number = run.events[-1], len(run.events) - 1
        for mine, theirs in zip(run.at(last.time).circles, true.after(number).circles, strict=True):
            for name in ("x", "y", "vx", "vy"):
                value = getattr(mine, name)
                if not value.low <= float(getattr(theirs, name)) <= value.high:
                    return f"{mine.id}.{name} after event {number}: {value} against {getattr(theirs, name)}"
    return ""


def engines_differ(seed: int, counts: Counter[str], draw: Callable[[int], Scene | None] = drawn) -> str:
    """What engines of finite precision have otherwise than the certified run, in one scene."""
    scene = draw(seed)
    if scene is None:
        return ""
    most = EVENTS if draw is drawn else MORE
    true, found = ExactEngine(work=300_000).run(scene, until=12, events=most), list[str]()
    for engine in FLOATS:
        run = engine.run(scene, until=12, events=most if engine.bits >= 53 else FEW)
        counts[f"{engine.name}: {run.stop.reason.name}"] += 1
        counts[f"{engine.name}: settlings"] += len(run.settlings)
        if what := strays(run, true, LATE if engine.name == "single" else 1e-5):
            found.append(f"{engine.name}: {what}")
    for engine in INTERVALS:
        run = engine.run(scene, until=12, events=most)
        name = f"interval of {engine.bits} bits"
        counts[f"{name}: {run.stop.reason.name}"] += 1
        counts[f"{name}: events"] += len(run.events)
        if what := contradicts(run, true):
            found.append(f"{name}: {what}")
    return "; ".join(found)


def guises_differ(seed: int, counts: Counter[str], draw: Callable[[int], Scene | None] = drawn) -> str:
    """What of a certified run is otherwise in the mirror, in another order, or seen from another frame."""
    scene = draw(seed)
    if scene is None:
        return ""
    most = EVENTS if draw is drawn else MORE
    run = ExactEngine(work=300_000).run(scene, until=6, events=most)
    mirrored = scene.with_changes(
        circles=[replace(c, x=-c.x, vx=-c.vx) for c in scene.circles],
        walls=[replace(w, x0=-w.x0, x1=-w.x1) for w in scene.walls],
    )
    guises = {"mirrored": mirrored, "reversed": scene.with_changes(circles=scene.circles[::-1])}
    if len(scene.walls) == 1 and not any(circle.fixed for circle in scene.circles):
        pace = Quantity.of("7/5")
        guises["moving"] = scene.with_changes(circles=[replace(c, vx=c.vx + pace) for c in scene.circles])
    for name, guise in guises.items():
        other = ExactEngine(work=300_000).run(guise, until=6, events=most)
        if StopReason.UNDECIDED in (run.stop.reason, other.stop.reason):
            counts[f"{name}: undecided"] += 1
            continue
        counts[name] += 1
        mine, theirs = (
            [(e.time.digits(25), frozenset(map(frozenset, e.impulses))) for e in r.events] for r in (run, other)
        )
        if mine != theirs:
            return f"{name}: {len(mine)} events against {len(theirs)}, or others"
        rests = [sorted((s.circle, s.wall, s.time.digits(25)) for s in r.settlings) for r in (run, other)]
        if rests[0] != rests[1]:
            return f"{name}: settled {rests[0]} against {rests[1]}"
    return ""


def main() -> int:
    """Runs a span of seeds."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--engines", action="store_true", help="engines of finite precision, too")
    parser.add_argument("--guises", action="store_true", help="scenes in other guises")
    parser.add_argument("--corners", action="store_true", help="in corners of two slopes")
    parser.add_argument("--bounces", action="store_true", help="with bounces that come to an end")
    parser.add_argument(
        "--early", action="store_true", help="and settle as soon as it is proved that nothing else comes"
    )
    given = parser.parse_args()
    look = engines_differ if given.engines else guises_differ if given.guises else examined
    if given.early:
        endings.SHRUNK = 2
    if given.bounces or given.corners:
        look = partial(look, draw=cornered if given.corners else bouncing)
    counts, bad = Counter[str](), 0
    for seed in range(given.first, given.first + given.scenes):
        found = look(seed, counts)
        if found:
            bad += 1
            print(f"{seed}: {found}", flush=True)
    for name, count in counts.most_common():
        print(f"{count:8} {name}")
    print(f"{bad} differ")
    return bool(bad)


if __name__ == "__main__":
    sys.exit(main())
