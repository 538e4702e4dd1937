"""Scenes among edges, each with some of the older ingredients, against the referee: resumable, counted.

python tests/edge_campaign.py --scenes 20000 --out edges.jsonl   # a second call goes on
python tests/edge_campaign.py --arcs --scenes 4000 --out bows.jsonl   # of arcs
python tests/edge_campaign.py --report --out edges.jsonl         # the counts so far
python tests/edge_campaign.py --replay 17                        # one scene, as TOML, and what differs

A scene of `segment_scenes`, `polygon_scenes` or `joint_scenes`, or with `--arcs` of `arc_scenes`, is taken, and each of
`INGREDIENTS` is added to it by chance. Two are checked beside the referee: a run that is broken off and resumed, and
one with cells.
"""

from __future__ import annotations

import argparse
import json
import signal
import sys
from collections import Counter
from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from itertools import combinations
from math import inf
from pathlib import Path
from random import Random

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parent)

import segment_referee as sharp
from arc_referee import ArcReferee
from arc_scenes import scene_of as bows
from fuzz.relations import cells_from
from joint_scenes import scene_of as joints
from mpmath import mpf
from polygon_scenes import scene_of as polygons
from segment_referee import Disc, Referee, falls, number
from segment_scenes import scene_of as segments

from truebreak.exact import ExactEngine
from truebreak.exact.numbers.system import Undecided
from truebreak.scenarios import Arc, Circle, Pocket, Polygon, Quantity, Scene, SceneError, Segment, Trajectory, Wall
from truebreak.scenarios.files import dump_toml

UNTIL, EVENTS = 20, 10
FINE = 320, mpf(10) ** -160
"""The referee's digits, and what it takes for zero: an offset of 10**-25 is squared more than once in these scenes."""
BASES: dict[str, Callable[[int], Scene | None]] = {"segments": segments, "polygons": polygons, "joints": joints}


class OlderReferee(Referee):
    """The referee, with pockets and a reversal: one instant after the other, in the order that policies.md states."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        self.pockets = [(p.id, number(p.x), number(p.y), number(p.r)) for p in scene.pockets]
        self.capture = scene.capture
        self.turn_after = scene.reverse_after
        self.turn_at = None if scene.reverse_at is None else number(scene.reverse_at)
        self.entries: list[tuple[mpf, str, str]] = []
        self.turned: tuple[int, mpf] | None = None
        self.out: list[Disc] = []
        self.all = list(self.discs)

    def enter(self) -> None:
        """Centres on a rim whose velocity points inward; on two rims at once, both are entered."""
        for disc in list(self.discs):
            entered = []
            for name, x, y, r in self.pockets:
                dx, dy = x - disc.x, y - disc.y
                inward = dx * disc.vx + dy * disc.vy
                if abs(dx * dx + dy * dy - r * r) < sharp.SAME and inward > sharp.SAME:
                    entered.append((self.now, disc.id, name))
            self.entries += entered
            if self.capture and entered:
                self.discs.remove(disc)
                disc.vx = disc.vy = mpf(0)

    def settle(self) -> None:
        """Contacts, then entries."""
        happened = self.resolve()
        if happened.approaching:
            self.told.append(happened)
        self.enter()

    def next_instant(self) -> tuple[mpf, bool] | None:
        """The time until something comes that may change something."""
        found = self.next_time()
        waits = [] if found is None else [found]
        for disc in self.discs:
            for _, x, y, r in self.pockets:
                hit = falls(x - disc.x, y - disc.y, -disc.vx, -disc.vy, r)
                if hit is not None and hit[1] and hit[0] > sharp.SAME:
                    waits.append((hit[0], False))
        if self.turn_at is not None and self.turned is None:
            waits.append((self.turn_at - self.now, False))
        first = min((t for t, _ in waits), default=None)
        return None if first is None else (first, any(blunt for t, blunt in waits if t < first + sharp.SAME))

    def play(self, until: mpf, events: int) -> bool:
        """To a time, or a number of events; whether that ended it at a point that hits an end."""
        self.told = []
        while True:
            self.settle()
            due = len(self.told) == self.turn_after or (
                self.turn_at is not None and abs(self.turn_at - self.now) < sharp.SAME
            )
            if len(self.told) < events and self.turned is None and due:
                self.turned = len(self.told), self.now
                for disc in self.discs:
                    disc.vx, disc.vy = -disc.vx, -disc.vy
                self.settle()
            if len(self.told) >= events:
                return False
            coming = self.next_instant()
            if coming is None or self.now + coming[0] > until + sharp.SAME:
                self.fly(until - self.now)
                return False
            self.fly(coming[0])
            assert self.clear(), "the referee let a disc into a segment"
            if coming[1]:
                return True


class NotForThis(Exception):
    """The referee cannot tell what happens next; what it has said until then stands."""


class OlderArcReferee(OlderReferee, ArcReferee):
    """The same among arcs. A disc that flies along the inside of one is let into it, and nothing is said from there."""

    def clear(self) -> bool:
        if not super().clear():
            raise NotForThis("a disc is let into an arc")
        return True


# -- The older ingredients.


@dataclass(frozen=True)
class Aged:
    """A scene, how far it is played, and what was added to it."""

    scene: Scene
    until: Quantity
    ingredients: tuple[str, ...] = ()


def _mapped(scene: Scene, place: Callable[[Quantity, Quantity], tuple[Quantity, Quantity]], speed, size) -> Scene:
    """A scene with every point, velocity and length mapped."""

    def two(thing):
        return (*place(thing.x0, thing.y0), *place(thing.x1, thing.y1))

    def bow(a):
        begins, ends = (a.x0, a.y0), (a.x1, a.y1)
        o, east, north = (place(Quantity.of(x), Quantity.of(y)) for x, y in ((0, 0), (1, 0), (0, 1)))
        spin = (east[0] - o[0]) * (north[1] - o[1]) - (east[1] - o[1]) * (north[0] - o[0])
        both = (begins, ends) if spin.sign() > 0 else (ends, begins)  # in a mirror it goes the other way round
        points = () if a.full else (*place(*both[0]), *place(*both[1]))
        return Arc(*place(a.x, a.y), a.r * size, *points, id=a.id, full=a.full)

    circles = []
    for c in scene.circles:
        (x, y), (vx, vy) = place(c.x, c.y), speed(c.vx, c.vy)
        circles.append(Circle(x, y, r=c.r * size, vx=vx, vy=vy, m=c.m, id=c.id, point=c.point))
    return scene.with_changes(
        circles=circles,
        walls=[Wall(*two(w), id=w.id) for w in scene.walls],
        segments=[Segment(*two(s), id=s.id, r=s.r * size) for s in scene.segments],
        polygons=[Polygon([place(x, y) for x, y in p.points], id=p.id, r=p.r * size) for p in scene.polygons],
        pockets=[Pocket(*place(p.x, p.y), p.r * size, id=p.id) for p in scene.pockets],
        arcs=[bow(a) for a in scene.arcs],
    )


def _turned(aged: Aged, rng: Random) -> Aged:
    """By the angle of a right triangle, or 30 degrees; mirrored, now and then."""
    cos, sin = ((Quantity.of(a), Quantity.of(b)) for a, b in [rng.choice(
        [("3/5", "4/5"), ("-5/13", "12/13"), ("sqrt(3)/2", "1/2"), ("0", "1")])]).__next__()  # fmt: skip
    flip = rng.choice((1, -1))

    def turn(x, y):
        return cos * x - sin * y * flip, sin * x + cos * y * flip

    return replace(aged, scene=_mapped(aged.scene, turn, turn, 1))


def _far(aged: Aged, rng: Random) -> Aged:
    """A thousand to a million million from the origin."""
    x, y = (Quantity.of(rng.choice((1, -1)) * 10 ** rng.choice((3, 6, 12)) + rng.randint(0, 9)) for _ in range(2))
    return replace(aged, scene=_mapped(aged.scene, lambda a, b: (a + x, b + y), lambda a, b: (a, b), 1))


def _scaled(aged: Aged, rng: Random) -> Aged:
    """Lengths and times in other units."""
    size, time = Quantity.of(10) ** rng.choice((-2, 2, 0)), Quantity.of(10) ** rng.choice((-5, 5, 0))
    scene = _mapped(
        aged.scene, lambda a, b: (a * size, b * size), lambda a, b: (a * size / time, b * size / time), size
    )
    if scene.reverse_at is not None:
        scene = scene.with_changes(reverse_at=scene.reverse_at * time)
    return replace(aged, scene=scene, until=aged.until * time)


def _with_one(aged: Aged, rng: Random, change: Callable[[Circle], Circle]) -> Aged:
    circles = list(aged.scene.circles)
    movable = [k for k, c in enumerate(circles) if not c.fixed]
    k = rng.choice(movable)
    circles[k] = change(circles[k])
    return replace(aged, scene=aged.scene.with_changes(circles=circles))


def _again(c: Circle, **changes) -> Circle:
    known = {"x": c.x, "y": c.y, "r": c.r, "vx": c.vx, "vy": c.vy, "m": c.m, "id": c.id, "point": c.point}
    return Circle(**{**known, **changes})


def _heavy(aged: Aged, rng: Random) -> Aged:
    return _with_one(aged, rng, lambda c: _again(c, m=Quantity.of(10) ** rng.choice((7, -7, 12, -12))))


def _swift(aged: Aged, rng: Random) -> Aged:
    fast = 10 ** rng.choice((5, 9))
    return _with_one(aged, rng, lambda c: _again(c, vx=c.vx * fast, vy=c.vy * fast))


def _gap(aged: Aged, rng: Random) -> Aged:
    off = rng.choice((1, -1)) * Quantity.of(10) ** -rng.choice((12, 18, 25))
    axis = rng.choice(("x", "y", "vx", "vy"))
    return _with_one(aged, rng, lambda c: _again(c, **{axis: getattr(c, axis) + off}))


def _nested(aged: Aged, rng: Random) -> Aged:
    root = Quantity.of(rng.choice(("sqrt(2 + sqrt(3))", "sqrt(2 + sqrt(2))/2", "1 + sqrt(3 - sqrt(2))")))
    if rng.random() < 0.5:
        return _with_one(aged, rng, lambda c: _again(c, vx=c.vx * root, vy=c.vy * root))
    scene = _mapped(aged.scene, lambda a, b: (a, b), lambda a, b: (a * root, b * root), 1)
    return replace(aged, scene=scene)


def _fixed(aged: Aged, rng: Random) -> Aged:
    x, y, r = rng.randint(-6, 6), rng.randint(-6, 6), rng.choice(("1", "1/2", "0"))
    post = Circle(x, y, r=r, m="oo", id="post", point=r == "0")
    return replace(aged, scene=aged.scene.with_changes(circles=[*aged.scene.circles, post]))


def _raft(aged: Aged, rng: Random) -> Aged:
    """One that touches another and flies with it."""
    host = rng.choice([c for c in aged.scene.circles if not c.fixed])
    nx, ny = rng.choice(((1, 0), (0, 1), (-1, 0), ("3/5", "-4/5")))
    r = Quantity.of(rng.choice(("1", "1/2")))
    far = host.r + r
    x, y = host.x + Quantity.of(nx) * far, host.y + Quantity.of(ny) * far
    mate = Circle(x, y, r=r, vx=host.vx, vy=host.vy, id="mate")
    return replace(aged, scene=aged.scene.with_changes(circles=[*aged.scene.circles, mate]))


def _twin(aged: Aged, rng: Random) -> Aged:
    """The scene and its mirror image, beyond a line; without walls."""
    bare, axis = aged.scene.with_changes(walls=[]), 30

    def mirror(x, y):
        return 2 * axis - x, y

    image = _mapped(bare, mirror, lambda x, y: (-x, y), 1)

    def copied(a, **changes):
        points = () if a.full else (a.x0, a.y0, a.x1, a.y1)
        return Arc(a.x, a.y, a.r, *points, full=a.full, **changes)

    def named(things, make):
        return [make(thing, f"{thing.id}'") for thing in things]

    return replace(aged, scene=bare.with_changes(
        circles=[*bare.circles, *named(image.circles, lambda c, n: _again(c, id=n))],
        segments=[*bare.segments,
                  *named(image.segments, lambda s, n: Segment(s.x0, s.y0, s.x1, s.y1, id=n, r=s.r))],
        polygons=[*bare.polygons, *named(image.polygons, lambda p, n: Polygon(p.points, id=n, r=p.r))],
        arcs=[*bare.arcs, *named(image.arcs, lambda a, n: copied(a, id=n))],
    ))  # fmt: skip


def _pockets(aged: Aged, rng: Random) -> Aged:
    pockets = [
        Pocket(rng.randint(-7, 7), rng.randint(-7, 7), rng.choice(("1", "1/2", "2")), id=f"p{k}")
        for k in range(rng.randint(1, 3))
    ]
    return replace(aged, scene=aged.scene.with_changes(pockets=pockets))


def _capture(aged: Aged, rng: Random) -> Aged:
    return replace(_pockets(aged, rng), scene=_pockets(aged, rng).scene.with_changes(capture=True))


def _reversal(aged: Aged, rng: Random) -> Aged:
    if rng.random() < 0.5:
        return replace(aged, scene=aged.scene.with_changes(reverse_after=rng.randint(1, 4)))
    return replace(aged, scene=aged.scene.with_changes(reverse_at=Quantity.of(rng.randint(1, 16)) / 2))


def _restitution(aged: Aged, rng: Random) -> Aged:
    return replace(aged, scene=aged.scene.with_changes(restitution=rng.choice(("1/2", "9/10", "sqrt(2)/2"))))


def _limit(aged: Aged, rng: Random) -> Aged:
    """Ends at a whole time, on which events of scenes on a grid fall."""
    return replace(aged, until=Quantity.of(rng.randint(1, 7)))


INGREDIENTS: dict[str, Callable[[Aged, Random], Aged]] = {
    "raft": _raft, "fixed": _fixed, "pocket": _pockets, "capture": _capture, "reversal": _reversal,
    "restitution": _restitution, "mass": _heavy, "swift": _swift, "gap": _gap, "nested": _nested, "twin": _twin,
    "turned": _turned, "far": _far, "scale": _scaled, "limit": _limit,
}  # fmt: skip
CHECKS = ("resume", "crowd")
SHARE = 0.2
"""How often each takes part, where it can."""


@dataclass(frozen=True)
class Campaign:
    """What is drawn, and who is asked.

    Args:
        name: of the file, and of the random numbers.
        bases: one scene of each in turn.
        ingredients: each is added by chance, in this order.
        referee: of a scene.
        exclusive: pairs of ingredients that no scene has.
        ends: reasons at which the motion itself ends, beside what the engine cannot prove.
        digits: the referee's, and what it takes for zero.
        shares: how often an ingredient takes part, where it is not `SHARE`.
    """

    name: str
    bases: dict[str, Callable[[int], Scene | None]]
    ingredients: dict[str, Callable[[Aged, Random], Aged]]
    referee: Callable[[Scene], OlderReferee]
    exclusive: tuple[tuple[str, str], ...] = ()
    ends: tuple[str, ...] = ()
    digits: tuple[int, mpf] = FINE
    shares: Mapping[str, float] = field(default_factory=dict)


EDGES = Campaign("edges", BASES, INGREDIENTS, OlderReferee, (("restitution", "reversal"),))
BOWS = Campaign("bows", {"arcs": bows}, INGREDIENTS, OlderArcReferee, (("restitution", "reversal"),))


def scene_of(seed: int, campaign: Campaign = EDGES) -> Aged | None:
    """The scene of a seed; None where what it draws is refused."""
    rng = Random(f"{campaign.name} {seed}")
    bases = list(campaign.bases.values())
    scene = bases[seed % len(bases)](seed)
    if scene is None:
        return None
    aged = Aged(scene, Quantity.of(UNTIL))
    for name, add in campaign.ingredients.items():
        if rng.random() < campaign.shares.get(name, SHARE):
            try:
                aged = replace(add(aged, rng), ingredients=(*aged.ingredients, name))
            except SceneError:
                continue
    more = tuple(name for name in CHECKS if rng.random() < SHARE)
    return replace(aged, ingredients=aged.ingredients + more)


# -- One scene, looked at.


def _event(run: Trajectory) -> list[tuple[object, ...]]:
    return [(e.time.digits(40), e.contacts, e.impulses) for e in run.events]


def examined(aged: Aged, campaign: Campaign = EDGES) -> tuple[str, str, int]:
    """What came of it, what to say of it, and how many events it had.

    "ok"; "undecided" and "endless" (impulses of one instant without a last one), right as far as they go; "no normal";
    the name of an end of the motion; "long" (the referee alone gives up); "failure".
    """
    crowd = cells_from(2) if "crowd" in aged.ingredients else nullcontext()
    engine = ExactEngine()
    with crowd:
        run = engine.run(aged.scene, until=aged.until, events=EVENTS)
        if "resume" in aged.ingredients and len(run.events) > 1:
            short = engine.run(aged.scene, until=aged.until, events=len(run.events) // 2)
            whole = engine.resume(short, until=aged.until, events=EVENTS)
            if _event(whole) != _event(run):
                return "failure", "resumed, it is another run", len(run.events)
    referee, count = campaign.referee(aged.scene), len(run.events)
    reason = run.stop.reason.name
    gave_up = reason in ("UNDECIDED", "BUDGET", *campaign.ends)
    try:
        blunt = referee.play(number(aged.until), EVENTS)
    except NotForThis as error:
        told = _compared(run, referee, True)
        same = reason in campaign.ends and len(referee.told) == count
        ended = reason.lower() if same else "undecided" if gave_up else "long"
        return "failure" if told else ended, told or str(error), count
    except AssertionError as error:
        endless = str(error) == "no end"
        if not endless and not (gave_up and len(referee.told) >= count):
            raise
        told = _compared(run, referee, True)
        return (
            "failure" if told else "endless" if endless and gave_up else "undecided" if gave_up else "long",
            told,
            count,
        )
    told = _compared(run, referee, gave_up)
    if told:
        return "failure", told, count
    if blunt and gave_up and "no normal" not in run.stop.message:  # refused by another name: along an arc, to its end
        return "undecided", run.stop.message, count
    if "no normal" in run.stop.message or blunt:
        same = "no normal" in run.stop.message and blunt and len(referee.told) == count
        return ("no normal" if same else "failure"), "" if same else "a point at an end", count
    if gave_up:
        return reason.lower() if reason in campaign.ends else "undecided", run.stop.message, count
    if len(referee.told) != count:
        return "failure", f"{count} events, not {len(referee.told)}", count
    told = _ends(run, referee)
    return ("failure" if told else "ok"), told, count


def _near(mine, theirs: mpf, size: mpf, power: int) -> bool:
    try:
        known = mpf(mine.digits(90))
    except Undecided:  # zero, as it seems, but too deep to be proved so
        known = mpf(mine.ball(400).mid().str(100, radius=False))
    return abs(known - theirs) <= mpf(10) ** -power * (1 + abs(theirs) + size)


def _compared(run: Trajectory, referee: OlderReferee, gave_up: bool) -> str:
    """Where the events and the entries part, as far as both go; empty where they do not.

    Args:
        gave_up: whether one of the two did: then entries count up to the last event that both have.
    """
    for mine, theirs in zip(referee.told, run.events, strict=False):
        if not _near(theirs.time, mine.time, mpf(0), 45):
            return f"event {theirs.index} at {float(theirs.time)}, not {float(mine.time)}"
        names = {tuple(pair) for pair in theirs.contacts}
        if not mine.approaching <= names <= mine.touching:
            return f"event {theirs.index}: {sorted(names)}, not {sorted(mine.approaching)}"
    both = min(len(referee.told), len(run.events))
    last = inf if not gave_up else float(run.events[both - 1].time) if both else 0.0
    entries = sorted((t, e.circle, e.pocket) for e in run.pocketings if (t := float(e.time)) < last)
    theirs = sorted((t, circle, pocket) for at, circle, pocket in referee.entries if (t := float(at)) < last)
    if [e[1:] for e in entries] != [e[1:] for e in theirs]:
        return f"entries {entries}, not {theirs}"
    return ""


def _ends(run: Trajectory, referee: OlderReferee) -> str:
    """Whether the final states agree."""
    fastest = max(max(abs(d.vx), abs(d.vy)) for d in referee.all)
    for circle, disc in zip(run.final.circles, referee.all, strict=True):
        pairs = zip((circle.x, circle.y, circle.vx, circle.vy), (disc.x, disc.y, disc.vx, disc.vy), strict=True)
        if not all(_near(a, b, fastest, 40) for a, b in pairs):
            return f"{circle.id} ends elsewhere"
    if (run.reversal is None) != (referee.turned is None):
        return "one is turned back, the other is not"
    return ""


class TooLong(Exception):
    """A scene takes more processor time than is given to one."""


def verdict(seed: int, campaign: Campaign = EDGES, patience: float = 60.0) -> dict[str, object] | None:
    """A row of the file; None where there is no such scene."""
    aged = scene_of(seed, campaign)
    if aged is None:
        return None

    def stop(*_: object) -> None:
        raise TooLong

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, patience)
    try:
        outcome, message, events = examined(aged, campaign)
    except TooLong:
        outcome, message, events = "long", f"no end in {patience:g} seconds of processor time", 0
    except Exception as error:
        outcome, message, events = "failure", f"{type(error).__name__}: {error}", 0
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)
    return {
        "seed": seed,
        "outcome": outcome,
        "events": events,
        "message": message,
        "ingredients": [list(campaign.bases)[seed % len(campaign.bases)], *aged.ingredients],
    }


def report(rows: list[dict], campaign: Campaign = EDGES) -> str:
    """The counts."""
    bases = set(campaign.bases)
    kinds = sorted([*campaign.ingredients, *CHECKS, *bases])
    lines = [f"{len(rows):,} scenes, {sum(row['events'] for row in rows):,} events"]
    lines += [f"  {outcome}: {count:,}" for outcome, count in Counter(row["outcome"] for row in rows).most_common()]
    agreed = [sorted(row["ingredients"]) for row in rows if row["outcome"] == "ok"]
    pairs = Counter(pair for ingredients in agreed for pair in combinations(ingredients, 2))
    shown = [pair for pair in combinations(kinds, 2) if not set(pair) <= bases and pair not in campaign.exclusive]
    count, pair = min((pairs[pair], pair) for pair in shown)
    lines.append(f"  each pair of ingredients at least {count} times among those that agree ({' and '.join(pair)})")
    bad = [row for row in rows if row["outcome"] in ("failure", "long")]
    lines += [f"  seed {row['seed']}: {row['outcome']} {row['message']}" for row in bad]
    return "\n".join(lines)


def main(campaign: Campaign = EDGES) -> int:
    """The campaign; the exit status, 1 after a failure."""
    parser = argparse.ArgumentParser(description="Scenes and what is added to them against the referee.")
    parser.add_argument("--scenes", type=int, default=1000)
    parser.add_argument("--out", default=f"{campaign.name}.jsonl")
    parser.add_argument("--first", type=int, default=0, help="the seed to begin with")
    parser.add_argument("--report", action="store_true")
    parser.add_argument("--arcs", action="store_true", help="scenes of arcs")
    parser.add_argument("--replay", type=int, default=None)
    options = parser.parse_args()
    sharp.DIGITS, sharp.SAME = campaign.digits
    if options.replay is not None:
        aged = scene_of(options.replay, campaign)
        if aged is not None:
            print(
                dump_toml(aged.scene), aged.until.text(), aged.ingredients, verdict(options.replay, campaign), sep="\n"
            )
        return 0
    path = Path(options.out)
    rows = [json.loads(line) for line in path.read_text().splitlines() if line.endswith("}")] if path.exists() else []
    if not options.report:
        seed = rows[-1]["seed"] + 1 if rows else options.first
        with path.open("a") as file:
            while len(rows) < options.scenes:
                row = verdict(seed, campaign)
                seed += 1
                if row is not None:
                    rows.append(row)
                    file.write(json.dumps(row) + "\n")
                    file.flush()
    print(report(rows, campaign))
    return int(any(row["outcome"] == "failure" for row in rows))


if __name__ == "__main__":
    sys.exit(main(BOWS) if "--arcs" in sys.argv[1:] else main())
