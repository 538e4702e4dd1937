"""Scenes in which discs settle, are struck and leave, against a referee of their own.

python tests/settle_campaign.py --scenes 2000 --first 0      # counts, and every scene that differs
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path
from random import Random

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parent)

from gravity_referee import DIGITS
from mpmath import mpf, workdps
from peg_referee import NotForThis
from settle_referee import SettleReferee

from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Scene, SceneError, Wall
from truebreak.scenarios.trajectory import StopReason, Trajectory

EVENTS = 24
NEAR, AFTER = mpf(10) ** -30, mpf(10) ** -45


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


def differs(run: Trajectory, scene: Scene) -> str:
    """What of a certified run is otherwise in the referee's; nothing where all is as it is there."""
    with workdps(DIGITS):
        end = mpf(run.final_time.digits(DIGITS)) if hasattr(run.final_time, "digits") else mpf(str(run.final_time))
        did = SettleReferee(scene).run(end + AFTER, len(run.events) + 8)
        mine = [(mpf(event.time.digits(60)), {tuple(sorted(link)) for link in event.impulses}) for event in run.events]
        theirs = [(time, {tuple(sorted(link)) for link in links}) for time, links in did.hits if time <= end + AFTER]
        for k, (one, other) in enumerate(zip(mine, theirs, strict=False)):
            if abs(one[0] - other[0]) > NEAR or one[1] != other[1]:
                return f"event {k}: {float(one[0])!r} {one[1]} against {float(other[0])!r} {other[1]}"
        if len(mine) != len(theirs):
            return f"{len(mine)} events against {len(theirs)}"
        settled = [(mpf(s.time.digits(60)), s.circle, s.wall) for s in run.settlings]
        theirs_settled = [row for row in did.settled if row[0] <= end + AFTER]
        if [row[1:] for row in settled] != [row[1:] for row in theirs_settled]:
            return f"settled {[row[1:] for row in settled]} against {[row[1:] for row in theirs_settled]}"
        if any(abs(a[0] - b[0]) > NEAR for a, b in zip(settled, theirs_settled, strict=True)):
            return f"settled at {[float(row[0]) for row in settled]}, not {[float(row[0]) for row in theirs_settled]}"
        if run.stop.reason is StopReason.HORIZON:
            for row, body in zip(run.at(run.final_time).circles, did.bodies, strict=True):
                for name in ("x", "y", "vx", "vy"):
                    value = getattr(row, name).ball(128)
                    off = mpf(value.mid().str(60, radius=False)) - getattr(body, name)
                    if abs(off) > NEAR:
                        return f"{row.id}.{name} at the end: {float(value)} against {float(getattr(body, name))}, {off}"
    return ""


def examined(seed: int, counts: Counter[str]) -> str:
    """What differs in one scene; its stop is counted."""
    scene = drawn(seed)
    if scene is None:
        counts["no scene"] += 1
        return ""
    run = ExactEngine(work=300_000).run(scene, until=12, events=EVENTS)
    counts[run.stop.reason.name] += 1
    counts["settlings"] += len(run.settlings)
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


def main() -> int:
    """Runs a span of seeds."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    given = parser.parse_args()
    counts, bad = Counter[str](), 0
    for seed in range(given.first, given.first + given.scenes):
        found = examined(seed, counts)
        if found:
            bad += 1
            print(f"{seed}: {found}", flush=True)
    for name, count in counts.most_common():
        print(f"{count:8} {name}")
    print(f"{bad} differ")
    return bool(bad)


if __name__ == "__main__":
    sys.exit(main())
