"""Scenes by a covering array: every pair of 23 ingredients together, in one instant where they can meet there.

A row of the array is a set of ingredients. Its scene is built around one instant, at which as many of them as can take
part do, and led back to time 0. What of a row then came about is measured on the referee's history (`exercised`), not
taken for granted.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations, pairwise
from random import Random
from typing import Any

from flint import fmpz  # type: ignore[attr-defined]

from fuzz.draft import (
    AXES,
    DIAGONALS,
    HEX,
    POLICIES,
    PYTHAGOREAN,
    ROOT2,
    ROOT3,
    ROOT5,
    TRIPLES,
    Body,
    Case,
    Draft,
    F,
    Number,
    Vector,
    flaw,
    has_room,
    mass,
    size,
    span,
    speed,
    velocity,
)
from fuzz.kinds.brinks import rims
from fuzz.kinds.brinks import spoil as faintly_spoilt
from fuzz.kinds.symmetry import spoil
from fuzz.referee import Told
from fuzz.table import Doubt, Row, Table
from truebreak.scenarios import Quantity, Scene, Trajectory
from truebreak.scenarios.errors import SceneError

INGREDIENTS: dict[str, str] = {
    "point": "a point meets something",
    "pocket": "a centre enters a pocket",
    "capture": "what enters a pocket is taken out of play",
    "fixed": "a fixed circle is met",
    "wall": "a wall is met",
    "oblique": "a wall that is along no axis is met",
    "corner": "one circle meets two walls at one instant",
    "graze": "two touch without pushing: a double root",
    "tie": "several contacts fall on one instant",
    "raft": "circles that touch fly together for a while, and are met",
    "lasting": "a circle slides along a wall",
    "reversal": "all velocities are turned round, at a time or after an event",
    "mass": "masses differ by 10**7 to 10**30, and meet",
    "swift": "a circle 10**9 to 10**15 times as fast as the others meets something",
    "far": "all of it is 10**12 to 10**40 from the origin",
    "gap": "two things are apart by 10**-20 to 10**-100, in space or in time",
    "nested": "a number of the scene is a root of a root, and takes part",
    "crowd": "circles come to other cells",
    "resume": "the run is broken off and resumed",
    "limit": "the run ends at the very time of an event",
    "policy": "impulses of one instant one after the other",
    "twin": "a part of the scene and its image do the same at one time, or nearly so",
    "scale": "lengths, times and masses are beyond the doubles",
}
PAIRS: tuple[tuple[str, str], ...] = tuple(combinations(INGREDIENTS, 2))
ROWS = 28
"""Rows of one covering array; every pass has an array of its own, so that triples vary."""
FEWEST, MOST = 4, 8
"""Ingredients of a row, before those that others need."""
AT_ONCE = 0.08
"""Share of scenes whose instant is time 0."""
RIMS = 0.15
"""Share of scenes with a pocket and a wall that come of the kind `rims`: what is struck onto an axis of symmetry comes
to a rim that has no image just as it comes to a wall, or nearly."""
FAINT = 0.15
"""Share of twins of which one half has a datum that is off by less than balls tell at first: a mass, a radius too."""
LOOSE = 0.35
"""Share of scenes in a box, with bystanders of any velocity and more events: most of these stand alone, in balls."""
NEEDS = {"capture": ("pocket",), "oblique": ("wall",), "corner": ("wall", "tie"), "policy": ("tie",)}
NESTED = (
    "sqrt(2 + sqrt(3))",
    "sqrt(2 + sqrt(2))/2",
    "1 + sqrt(3 - sqrt(2))",
    "sqrt(5 + 2*sqrt(6))",
    "sqrt(1 + sqrt(5))",
)
ANGLES: list[Vector] = [*TRIPLES, *TRIPLES, HEX[1], (ROOT3 / 2, F(1, 2)), (ROOT2 / 2, ROOT2 / 2)]


@cache
def array(number: int) -> tuple[frozenset[str], ...]:
    """A covering array of strength two: sets of ingredients of which every pair is in some set."""
    draw, names = Random(f"array:{number}"), list(INGREDIENTS)
    left, rows = {(a, b) for a in range(len(names)) for b in range(a)}, list[frozenset[str]]()
    while len(rows) < ROWS:
        tried = [_greedy(left, len(names), draw) for _ in range(12)]
        best = max(tried, key=lambda row: sum((a, b) in left for a in row for b in row))
        rows.append(frozenset(names[a] for a in best))
        left -= {(a, b) for a in best for b in best}
    assert not left, f"array {number} leaves {len(left)} pairs out"
    return tuple(rows)


def _greedy(left: set[tuple[int, int]], count: int, draw: Random) -> list[int]:
    """A set that begins with a pair still left, and grows by what brings most of those that are."""
    chosen = list(draw.choice(sorted(left))) if left else draw.sample(range(count), 2)
    wanted = draw.randint(FEWEST, MOST)
    while len(chosen) < wanted:
        others = [a for a in range(count) if a not in chosen]
        draw.shuffle(others)
        chosen.append(max(others, key=lambda a: sum((max(a, b), min(a, b)) in left for b in chosen)))
    return chosen


def _pairs(row: frozenset[str]) -> Iterator[tuple[str, str]]:
    """The pairs of a row, in the order of the table."""
    return combinations([name for name in INGREDIENTS if name in row], 2)


def row_of(seed: int) -> frozenset[str]:
    """The ingredients wanted of the scene of a seed, with those that they need."""
    row = set(array(seed // ROWS)[seed % ROWS])
    for name in list(row):
        row.update(NEEDS.get(name, ()))
    return frozenset(row)


@dataclass(frozen=True)
class Mixed:
    """The scene of a row.

    Attributes:
        row: what is wanted of it.
        halves: for each circle, the half of a twin that it belongs to, or 0.
        reach: as a power of ten: by what lengths, times and masses are multiplied for `scale`.
    """

    row: frozenset[str]
    case: Case
    halves: tuple[int, ...]
    reach: tuple[int, int, int]


def mixed(seed: int) -> Mixed:
    """The scene of a seed: always the same one."""
    draw, row, rim = Random(f"mixed:{seed}"), row_of(seed), Random(f"rims:{seed}")
    rim = rim if {"pocket", "wall"} <= row and rim.random() < RIMS else None
    faint = Random(f"faint:{seed}")
    faint = faint if faint.random() < FAINT else None
    for attempt in range(300):
        if attempt % 60 == 59:  # too much at once: one thing less
            row -= {draw.choice(sorted(row))}
        try:
            if rim is not None and attempt < 60:
                draft = _limited(rims(rim), row, rim)
            else:
                draft, time = _instant(row, draw)
                draft = _led_back(draft, time, row, draw)
            if draw.random() < LOOSE and "crowd" not in row:
                _loosen(draft, row, draw)
            draft = _finished(draft, row, draw, faint)
            scene = draft.scene(f"mixed {seed}")
        except SceneError:
            continue
        until = None if draft.until is None else Quantity.of(draft.until)
        reach = (draw.choice([400, -400, 330, -350]), draw.choice([0, 0, 500, -380]), draw.choice([0, 0, 700, -700]))
        return Mixed(row, Case(scene, until, draft.events), tuple(b.half for b in draft.bodies), reach)
    raise AssertionError(f"mixed {seed}: no draft is a scene")


def _limited(draft: Draft, row: frozenset[str], draw: Random) -> Draft:
    """A draft of another kind, with what a row says of pockets and of turning back."""
    draft.capture = "capture" in row
    if "reversal" in row and draft.reverse_at is None and draft.reverse_after is None:
        draft.reverse_after = draw.choice([1, 2, 3])
    return draft


# -- the instant


class _Stage:
    """What is at one instant: the circle in the middle, and what is placed around it."""

    def __init__(self, row: frozenset[str], draw: Random) -> None:
        self.row, self.draw = row, draw
        self.ways = list(draw.choice([AXES, PYTHAGOREAN, PYTHAGOREAN, HEX, DIAGONALS + AXES]))
        draw.shuffle(self.ways)
        self.draft = Draft([])
        self.middle = Body(0, 0, size(draw), m=mass(draw))
        if "point" in row and draw.random() < 0.25:
            self.middle.r, self.middle.point = 0, True
        self.bodies = self.draft.bodies
        self.bodies.append(self.middle)

    def free(self, r: Number, ahead: Vector | None = None) -> tuple[Vector, Number, Number] | None:
        """A direction in which a circle of a radius has room beside the middle, and its place; ahead of a velocity."""
        for nx, ny in self.ways:
            x, y = nx * (self.middle.r + r), ny * (self.middle.r + r)
            if ahead is not None and float(nx) * float(ahead[0]) + float(ny) * float(ahead[1]) < 1e-9:
                continue
            if has_room(self.bodies, x, y, r) and all(self.clear(wall, x, y, r) for wall in self.draft.walls):
                return (nx, ny), x, y
        return None

    @staticmethod
    def clear(wall: tuple[Number, ...], x: Number, y: Number, r: Number) -> bool:
        x0, y0, x1, y1 = (float(value) for value in wall)
        nx, ny = y0 - y1, x1 - x0
        length = (nx * nx + ny * ny) ** 0.5
        return ((float(x) - x0) * nx + (float(y) - y0) * ny) / length < 1e-9 - float(r)

    def wall(self, nx: Number, ny: Number, away: Number = 0) -> None:
        """A wall in a direction of the middle, which touches it; its other side is where nobody is."""
        far = self.middle.r + away
        x, y = nx * far, ny * far
        self.draft.walls.append((x, y, x + ny, y - nx))

    def beside(self, velocity: Vector, r: Number, m: Number, way: Vector, x: Number, y: Number) -> Body:
        """A circle that touches the middle."""
        body = Body(x, y, r, *velocity, m, point=r == 0)
        self.bodies.append(body)
        self.ways.remove(way)
        return body

    def radius(self) -> Number:
        """The radius of something beside the middle: a point, where points are wanted and the middle is none."""
        if "point" in self.row and not self.middle.point and self.draw.random() < 0.7:
            return 0
        return size(self.draw)


def _instant(row: frozenset[str], draw: Random) -> tuple[Draft, Number]:
    """A cluster at one instant, with as much of a row as can be there, and the time of that instant."""
    stage = _Stage(row, draw)
    middle, draft = stage.middle, stage.draft
    time: Number = 0 if draw.random() < AT_ONCE else span(draw)
    if time and "nested" in row and draw.random() < 0.5:
        time = Quantity.of(draw.choice(NESTED))
    fast = 10 ** draw.choice([9, 12, 15]) if "swift" in row else 1
    whose = draw.choice(["striker", "striker", "middle", "graze"]) if "swift" in row else ""
    pace = speed(draw) * (fast if whose == "middle" else 1)
    way = draw.choice(stage.ways) if "lasting" not in row else (1, 0)
    moving = {"wall", "fixed", "corner", "lasting"} & row or draw.random() < 0.5
    middle.vx, middle.vy = (way[0] * pace, way[1] * pace) if moving else (0, 0)
    _statics(stage, way)
    strikers = (1 if not {"wall", "fixed", "corner"} & row or draw.random() < 0.6 else 0) + ("tie" in row)
    for k in range(strikers):
        r = stage.radius()
        if (found := stage.free(r)) is None:
            break
        (nx, ny), x, y = found
        s = speed(draw) * (fast if whose == "striker" and k == 0 else 1)
        t = draw.choice([0, 0, s, -s / F(2)])
        stage.beside((middle.vx - nx * s - ny * t, middle.vy - ny * s + nx * t), r, mass(draw), (nx, ny), x, y)
    if "graze" in row:
        r = stage.radius()
        if (found := stage.free(r)) is not None:
            (nx, ny), x, y = found
            s = draw.choice([1, -1]) * speed(draw) * (fast if whose == "graze" else 1)
            stage.beside((middle.vx - ny * s, middle.vy + nx * s), r, mass(draw), (nx, ny), x, y)
    if "raft" in row:
        for _ in range(draw.choice([1, 1, 2])):
            r = size(draw)
            if (found := stage.free(r)) is not None:
                stage.beside((middle.vx, middle.vy), r, mass(draw), *found)
    if {"raft", "graze", "tie"} & row and draw.random() < 0.5:
        _chain(stage)
    if middle.point and draw.random() < 0.4:  # two points pass through each other
        draft.bodies.append(Body(0, 0, 0, *velocity(draw), point=True))
    _pockets(stage)
    if "mass" in row:
        heavy = [b for b in stage.bodies if b.m != "oo"]
        draw.choice(heavy[:2]).m = F(10) ** (draw.choice([1, -1]) * draw.choice([7, 12, 30]))
    if "tie" in row and draw.random() < 0.45:  # one elsewhere, at the very same time
        nx, ny = draw.choice(AXES)
        draft.bodies += [Body(60, 9, 1), Body(60 + 2 * nx, 9 + 2 * ny, 1, -nx, -ny)]
    if "gap" in row:
        _gap(stage)
    return draft, time


def _statics(stage: _Stage, way: Vector) -> None:
    """What does not move: a wall, two at a corner, a fixed circle, a wall that the middle slides along."""
    row, draw, middle = stage.row, stage.draw, stage.middle
    velocity = (middle.vx, middle.vy)
    if "lasting" in row:
        stage.wall(0, -1)
    if "corner" in row:
        first = way if "lasting" in row or draw.random() < 0.5 else draw.choice(stage.ways)
        turned = [(float(a) * float(first[0]) + float(b) * float(first[1]), (a, b)) for a, b in stage.ways]
        others = [w for dot, w in turned if -0.9 < dot < 0.9]
        ahead = [w for w in others if float(w[0]) * float(way[0]) + float(w[1]) * float(way[1]) > -1e-9]
        stage.wall(*first)
        if "lasting" not in row and ahead:
            second = draw.choice(ahead)
            stage.wall(*second)
            middle.vx, middle.vy = (
                middle.vx + second[0] * speed(draw),
                middle.vy + second[1] * speed(draw),
            )
    elif "wall" in row and "lasting" not in row:
        away = draw.choice([0, 0, 0, 2, 3])
        stage.wall(*(way if draw.random() < 0.6 else draw.choice(stage.ways)), away)
    elif "wall" in row:
        stage.wall(1, 0, draw.choice([0, 0, 3]))
    if "fixed" in row:
        r = stage.radius()
        found = stage.free(r, velocity) or stage.free(r)
        if found is not None:
            (nx, ny), x, y = found
            stage.beside((0, 0), r, "oo", (nx, ny), x, y)


def _chain(stage: _Stage) -> None:
    """What touches a neighbour of the middle, not the middle: flies with it, grazes it, or comes to it."""
    draw = stage.draw
    for _ in range(draw.choice([1, 1, 2])):
        host, r = draw.choice(stage.bodies[1:] or stage.bodies), size(draw)
        for nx, ny in draw.sample(PYTHAGOREAN + HEX, 12):
            x, y = host.x + nx * (host.r + r), host.y + ny * (host.r + r)
            if has_room(stage.bodies, x, y, r) and all(stage.clear(wall, x, y, r) for wall in stage.draft.walls):
                s, along = draw.choice([(0, 0), (0, 1), (0, -1), (1, 0), (1, 1)])
                vx, vy = host.vx - nx * s - ny * along, host.vy - ny * s + nx * along
                stage.bodies.append(Body(x, y, r, vx, vy, mass(draw)))
                break


def _pockets(stage: _Stage) -> None:
    """Pockets whose rims pass a centre at the instant, just before it, or later."""
    row, draw = stage.row, stage.draw
    if "pocket" not in row:
        return
    stage.draft.capture = "capture" in row
    movers = [b for b in stage.bodies if b.m != "oo" and (b.vx or b.vy)] or stage.bodies
    first, together = draw.choice([0, 0, flaw(draw), F(-1, 2), F(-1, 3), F(1, 4), 1]), draw.random() < 0.6
    for _ in range(draw.choice([1, 1, 2, 2, 3])):
        b, r = draw.choice(movers), draw.choice([1, 2, F(1, 2), 3])
        ways = [(float(w[0]) * float(b.vx) + float(w[1]) * float(b.vy), w) for w in PYTHAGOREAN]
        late = first + draw.choice([0, 0, 0, flaw(draw)]) if together else draw.choice([0, flaw(draw), F(-1, 3), 1])
        which = draw.random()
        if which < 0.12 and (along := [w for dot, w in ways if abs(dot) < 1e-9]):  # it only touches the rim
            ways, late = [(1.0, w) for w in along], draw.choice([0, 0, F(1, 4)])
        elif which < 0.2 and (still := [one for one in stage.bodies if not (one.vx or one.vy)]):  # it stands on the rim
            b = draw.choice(still)
        nx, ny = draw.choice([w for dot, w in ways if dot > 1e-9] or PYTHAGOREAN)
        stage.draft.pockets.append((b.x + b.vx * late + nx * r, b.y + b.vy * late + ny * r, r))


def _gap(stage: _Stage) -> None:
    """A flaw: in one place or one speed, between two that fly together, at a wall, or in a pocket."""
    draw, tiny = stage.draw, flaw(stage.draw)
    choice = draw.random()
    if choice < 0.15:  # it comes to the middle so slowly that it was never far
        r = size(draw)
        if (found := stage.free(r)) is not None:
            way, x, y = found
            nx, ny = way
            slow = abs(tiny), mass(draw)
            stage.beside((stage.middle.vx - nx * slow[0], stage.middle.vy - ny * slow[0]), r, slow[1], way, x, y)
            return
    if choice < 0.3:
        r = size(draw)
        if (found := stage.free(r)) is not None:
            way, x, y = found
            nx, ny = way
            stage.beside((stage.middle.vx, stage.middle.vy), r, 1, way, x + nx * abs(tiny), y + ny * abs(tiny))
            return
    if choice < 0.45 and stage.draft.walls:
        x0, y0, x1, y1 = stage.draft.walls[-1]
        nx, ny = y0 - y1, x1 - x0
        stage.draft.walls[-1] = (x0 - nx * abs(tiny), y0 - ny * abs(tiny), x1 - nx * abs(tiny), y1 - ny * abs(tiny))
        return
    spoil(stage.draft, draw)


# -- led back, and round it


def _led_back(draft: Draft, time: Number, row: frozenset[str], draw: Random) -> Draft:
    """The scene at time 0 of what is at an instant, or comes about there again after a reversal."""
    instant = time
    if "reversal" in row and draw.random() < 0.4:
        draft.reverse_at = span(draw)
        draft.bodies = [replace(b, vx=-b.vx, vy=-b.vy).back(-time) for b in draft.bodies]
        instant = 2 * draft.reverse_at + time
    else:
        draft.bodies = [b.back(time) for b in draft.bodies]
        if "reversal" in row:
            if draw.random() < 0.5:
                draft.reverse_after = draw.choice([1, 1, 2, 3])
            else:
                draft.reverse_at = instant + draw.choice([0, 0, abs(flaw(draw)), F(1, 2), 1])
            draft.endless = draw.random() < 0.3 and "limit" not in row
    draft.events = draw.choice([2, 3, 4, 5])
    if draft.reverse_after is not None and draw.random() < (0.5 if "tie" in row else 0.2):
        draft.events = draft.reverse_after
    if draft.endless:
        draft.events = None
    if "limit" in row and instant:
        draft.until, draft.events = instant, draw.choice([None, 5, 8, draft.reverse_after])
    elif draw.random() < 0.2:
        draft.until = instant + draw.choice([1, 3])
    return draft


def _loosen(draft: Draft, row: frozenset[str], draw: Random) -> None:
    """Puts a scene in a box, with bystanders of any velocity, and asks for more events."""
    for _ in range(draw.choice([2, 3])):
        x, y, r = draw.randrange(-9, 10), draw.randrange(-9, 10), size(draw)
        if has_room(draft.bodies, x, y, r):
            draft.bodies.append(Body(x, y, r, *(F(draw.randrange(-9, 10), 7) for _ in "xy"), mass(draw)))
    near = [b for b in draft.bodies if abs(float(b.x)) + abs(float(b.y)) < 60]
    far = 3 + int(max(abs(float(value)) + float(b.r) for b in near for value in (b.x, b.y)))
    draft.walls += [(far, 0, far, 1), (-far, 0, -far, 1)]
    if "twin" not in row:
        draft.walls += [(0, far, 1, far), (0, -far, 1, -far)]
    if draft.events is not None:
        draft.events = draw.randrange(5, 12)
    if "reversal" in row and "limit" not in row and draw.random() < 0.7:  # home, or as far as it gets
        if draft.reverse_at is None:
            draft.reverse_after = draw.randrange(3, 8)
        draft.events, draft.until, draft.endless = draw.choice([None, None, 16]), None, True


def _finished(draft: Draft, row: frozenset[str], draw: Random, faint: Random | None) -> Draft:
    """Doubled, among others, turned, shifted, in another order, under a policy; `faint` spoils one half of a twin."""
    if "twin" in row:
        c, s = draw.choice([(1, 0), (1, 0), (-1, 0), (0, 1), (F(3, 5), F(4, 5))])
        other = draft.moved(c, s, 0, 160, mirror=draw.random() < 0.5)
        start = len(draft.bodies)
        draft.bodies = [replace(b, half=1) for b in draft.bodies] + [replace(b, half=2) for b in other.bodies]
        if draw.random() < 0.25 and (odd := draw.choice(draft.bodies[start:])).m != "oo":
            odd.m *= 2  # as alike as can be, but for one mass
        walls = other.walls if draw.random() < 0.7 else []
        pockets = other.pockets if draw.random() < 0.7 else []
        draft.walls, draft.pockets = draft.walls + walls, draft.pockets + pockets
        if draw.random() < (0.6 if "gap" in row else 0.2):
            draft = spoil(draft, draw, start)
        if faint is not None:
            draft = faintly_spoilt(draft, faint, start)
    if "crowd" in row:
        _crowd(draft, draw)
    if "oblique" in row or draw.random() < 0.15:
        c, s = draw.choice(ANGLES)
        draft = draft.moved(c, s, 0, 0)
    shift: Vector = (0, 0)
    if "far" in row:
        power = draw.choice([12, 16, 30, 40])
        shift = draw.choice([(10**power, 0), (F(10**power, 7), -(10**power)), (ROOT2 * 10**power, F(1, 3))])
    if "nested" in row and draw.random() < 0.7:
        deep = Quantity.of(draw.choice(NESTED))
        shift = (shift[0] + deep, shift[1] + draw.choice([0, ROOT5, -deep]))
    if shift != (0, 0):
        draft = draft.moved(1, 0, *shift, mirror=draw.random() < 0.5)
    if draw.random() < 0.6:
        draft = draft.shuffled(draw)
    if "policy" in row:
        draft.policy = draw.choice(["sequential:order=scene", f"sequential:seed={draw.randrange(99)}"])
    elif draw.random() < 0.1:
        draft.policy = draw.choice(POLICIES)
    return draft


def _crowd(draft: Draft, draw: Random) -> None:
    """Others all around, some of which move; seldom as many as there are cells for by themselves."""
    many = 60 if draw.random() < 0.04 else draw.choice([5, 7, 9])
    places = [(6 * a - 30, 6 * b - 30) for a in range(11) for b in range(11)]
    draw.shuffle(places)
    for x, y in places:
        if many == 0:
            break
        if has_room(draft.bodies, x, y, 3):
            vx, vy = draw.choice([(0, 0), (0, 0), (1, 0), (0, -1), (F(3, 5), F(-4, 5)), (2, 1)])
            draft.bodies.append(Body(x, y, F(1, 2), vx, vy))
            many -= 1


# -- what came about


def exercised(mix: Mixed, told: Told, run: Trajectory, checks: frozenset[str]) -> frozenset[str]:
    """Which ingredients took part, as measured on the referee's history, and for `crowd` on the engine's plan.

    Args:
        checks: names of the relations that were checked.
    """
    found, scene, n = set[str](), mix.case.scene, len(mix.case.scene.circles)
    if not told.events and not told.entries:
        return frozenset()
    links = {link for event in told.events for link in event.contacts}
    met = {i for link in links for i in link if i < n}
    walls = {j - n for _, j in links if j >= n}
    circles = [scene.circles[i] for i in met]
    segments = list(_segments(told))
    found |= {"point"} if any(c.point for c in circles) else set()
    found |= {"fixed"} if any(c.fixed for c in circles) else set()
    found |= {"pocket"} if told.entries else set()
    found |= {"capture"} if told.entries and scene.capture else set()
    found |= {"wall"} if walls else set()
    found |= {"oblique"} if any(_oblique(scene.walls[k].normal) for k in walls) else set()
    for event in told.events:
        at_walls = [i for i, j in event.contacts if j >= n]
        found |= {"corner"} if len(set(at_walls)) < len(at_walls) else set()
        found |= {"tie"} if len(event.contacts) > 1 else set()
        found |= {"policy"} if len(event.contacts) > 1 and scene.tie_policy.name == "sequential" else set()
        halves = {mix.halves[i] for link in event.contacts for i in link if i < n}
        found |= {"twin"} if {1, 2} <= halves else set()
    if told.reversal is not None:
        found.add("reversal")
    masses = [float(c.m) for c in circles if not c.fixed]
    found |= {"mass"} if masses and max(masses) >= 1e6 * min(masses) else set()
    found |= {"far"} if any(abs(float(c.x)) >= 1e11 for c in scene.circles if abs(float(c.vx)) < 1e3) else set()
    found |= {"nested"} if any(_depth(q) > 1 for c in circles for q in (c.x, c.y, c.vx, c.vy, c.r)) else set()
    if told.stop == "HORIZON" and told.events and _same(told.events[-1].time, told.final_time, told):
        found.add("limit")
    if run.plan.get("cells crossed", 0) > 0:
        found.add("crowd")
    found |= {"resume", "scale"} & checks
    found |= _along(scene, told, segments, met)
    times = [when for when, _ in told.knots]
    if any(0 < b - a < told_unit(told) >> 60 and not _same(a, b, told) for a, b in pairwise(times)):
        found.add("gap")
    return frozenset(found)


def told_unit(told: Told) -> fmpz:
    """One, as the referee writes it."""
    return fmpz(1) << told.bits


def _same(a: fmpz, b: fmpz, told: Told) -> bool:
    """Whether two times are one to the referee."""
    return bool(abs(a - b) < fmpz(1) << (told.bits // 2))


def _segments(told: Told) -> Iterator[tuple[tuple[Row, ...], fmpz, bool]]:
    """States after the instants, how long they last, and whether that is for a while."""
    for (when, rows), (then, _) in pairwise(told.knots):
        yield rows, then - when, not _same(when, then, told)


def _along(scene: Scene, told: Told, segments: list[Any], met: set[int]) -> set[str]:
    """Grazes, contacts that last, rafts, swift ones and gaps: what is seen between two instants."""
    found, table, n = set[str](), Table(scene, told.bits), len(scene.circles)
    moving = [i for i in met if table.free[i]]
    first = [*_first(scene, told)]
    for rows, wait, lasts in [*first, *segments]:
        for i, (x, y, vx, vy) in enumerate(rows):
            table.x[i], table.y[i], table.vx[i], table.vy[i] = x, y, vx, vy
        if any(abs(table.vx[i]) + abs(table.vy[i]) > table.one * 10**8 for i in moving):
            found.add("swift")
        for link in table.links:
            i, j = link
            if not {i, j} & met or not lasts:
                continue
            try:
                gap, growing = table.gap(link), table.growing(link)
                touching = table.sign(gap) == 0
                if not touching and abs(gap) < table.one >> 50:
                    found.add("gap")
                if touching and table.sign(growing) == 0:
                    if j >= n:
                        found |= {"lasting"} if table.vx[i] or table.vy[i] else set()
                    elif _still(table, i, j):
                        found |= {"raft"} if table.vx[i] or table.vy[i] else set()
                if j < n and _grazes(table, i, j, wait):
                    found.add("graze")
            except Doubt:
                continue
    return found


def _first(scene: Scene, told: Told) -> Iterator[tuple[tuple[Row, ...], fmpz, bool]]:
    """The state at time 0, where the first instant comes later."""
    when, _ = told.knots[0]
    if not _same(when, fmpz(0), told):
        yield Table(scene, told.bits).rows(), when, True


def _still(table: Table, i: int, j: int) -> bool:
    """Whether two have one velocity."""
    return table.sign(table.vx[i] - table.vx[j]) == 0 and table.sign(table.vy[i] - table.vy[j]) == 0


def _grazes(table: Table, i: int, j: int, wait: fmpz) -> bool:
    """Whether two touch without pushing before so long has passed, or just then."""
    bits = table.bits
    dx, dy = table.x[j] - table.x[i], table.y[j] - table.y[i]
    ux, uy = table.vx[j] - table.vx[i], table.vy[j] - table.vy[i]
    b, square = (dx * ux + dy * uy) >> bits, (ux * ux + uy * uy) >> bits
    if b >= 0 or table.sign(b) == 0 or table.sign(square) == 0:
        return False
    if (i, j) not in table.reach:
        return False
    cross, reach = (dx * uy - dy * ux) >> bits, table.reach[i, j]
    if table.sign((cross * cross - (reach * reach >> bits) * square) >> bits) != 0:
        return False
    return bool(-b * table.one <= (wait + (table.one >> 40)) * square)


def _oblique(normal: tuple[Any, Any]) -> bool:
    return all(float(part) != 0 for part in normal)


def _depth(quantity: Any) -> int:
    """Roots within roots of a number as it is written."""
    if getattr(quantity, "rational", None) is not None:
        return 0
    inner = max((_depth(q) for q in quantity.args), default=0)
    return inner + (quantity.op == "sqrt")
