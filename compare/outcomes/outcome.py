"""Outcomes: what a history comes to, as functions of a trajectory."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Mapping
from functools import cache, lru_cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

from ...exact.replay.landings import told_falling_zero
from ...exact.replay.round_falls import gap_quartic
from ...floating.pocket_entries import time_to_enter
from ...scenarios.trajectory import StopReason
from ..alignment.walk import history
from ..files.amounts import plain

if TYPE_CHECKING:
    from ...scenarios.numbers.quantity import Quantity
    from ...scenarios.scene import Scene
    from ...scenarios.things import Pocket
    from ...scenarios.trajectory import Pocketing, Trajectory
    from ..alignment.align import Alignment, Span
    from ..alignment.walk import Patience

Outcome: TypeAlias = "Callable[[Trajectory], Any]"
"""An outcome takes a trajectory and gives a value of plain data: numbers, text, lists and dicts; None where
it says nothing about the scene. Two runs have the same outcome when the values are equal."""


OUTCOMES: dict[str, str] = {
    "collisions": "outcome:collisions",
    "collisions_per_ball": "outcome:collisions_per_ball",
    "who_hit_whom": "outcome:who_hit_whom",
    "moved": "outcome:moved",
    "break_pattern": "outcome:break_pattern",
    "pocketed": "outcome:pocketed",
    "symmetry": "outcome:symmetry",
    "final_velocities": "outcome:final_velocities",
}
"""The outcomes that every comparison reports, by module and function. A new one is its own file, and one line here;
`compare` takes more through its argument `outcomes`."""


def outcome(name: str) -> Outcome:
    """The outcome of that name.

    Raises:
        KeyError: for an unknown name.
    """
    return _loaded(OUTCOMES[name])


@cache
def _loaded(place: str) -> Outcome:
    module, _, function = place.partition(":")
    return getattr(import_module(f".{module}", __package__), function)


def outcomes_of(trajectory: Trajectory, more: Mapping[str, Outcome] | None = None) -> dict[str, Any]:
    """Every outcome of a trajectory by name, those that say nothing left out."""
    table = {**{name: outcome(name) for name in OUTCOMES}, **(more or {})}
    values = {name: function(trajectory) for name, function in table.items()}
    return {name: value for name, value in values.items() if value is not None}


SAME_NUMBER = 1e-6
"""Share of the largest number of an outcome by which its numbers may differ and still be the same: far above the
rounding of a run that agrees, far below any other event."""

ATOMS = frozenset({bool, int, str})
"""Types of what has no error and no parts."""


def same_outcome(a: Any, b: Any, room: float = 0.0) -> bool:
    """Whether two values are the same outcome: equal, but for an error of numbers that are not whole.

    >>> same_outcome({"a": 1.0}, {"a": 1.0 + 1e-12}, 1e-6), same_outcome([1], [2])
    (True, False)
    """
    if isinstance(a, float) and isinstance(b, float):
        return abs(a - b) <= room or a == b
    if type(a) is type(b) and type(a) in ATOMS:
        return bool(a == b)
    if isinstance(a, dict | Mapping) and isinstance(b, dict | Mapping):
        return a.keys() == b.keys() and all(same_outcome(a[key], b[key], room) for key in a)
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(same_outcome(x, y, room) for x, y in zip(a, b, strict=True))
    return plain(a) == plain(b)


def changed_outcomes(reference: Mapping[str, Any], candidate: Mapping[str, Any], *, agrees: bool = False) -> list[str]:
    """Names of the outcomes that differ.

    Args:
        agrees: whether the two histories agree: then numbers that are not whole differ by error alone.

    >>> changed_outcomes({"collisions": 3, "moved": ["a"]}, {"collisions": 4, "moved": ["a"]})
    ['collisions']
    """
    names = [*reference, *(name for name in candidate if name not in reference)]
    return [
        name
        for name in names
        if not same_outcome(
            reference.get(name),
            candidate.get(name),
            math.inf if agrees else room_of(reference.get(name)),
        )
    ]


def room_of(value: Any) -> float:
    """How far numbers may differ from those of a reference's outcome and be the same.

    >>> room_of({"a": [0.0, -2.0], "b": [1.0, 0.0]}) == 2 * SAME_NUMBER
    True
    """
    return SAME_NUMBER * _largest(value)


def _largest(value: Any) -> float:
    """The largest number of an outcome."""
    if isinstance(value, bool) or value is None or isinstance(value, str):
        return 0.0
    if isinstance(value, dict | Mapping):
        return max(map(_largest, value.values()), default=0.0)
    if isinstance(value, list | tuple):
        return max(map(_largest, value), default=0.0)
    return abs(float(value)) if isinstance(value, int | float) else 0.0


# ----------------------------------------
# What a history comes to in numbers: collisions, who hit whom, who moved, and how fast all are at the end.


def collisions(trajectory: Trajectory) -> int:
    """Number of collisions: of pairwise impulses."""
    return trajectory.collisions


def collisions_per_ball(trajectory: Trajectory) -> dict[str, int]:
    """Number of impulses that each circle took part in, in scene order; circles without any are left out."""
    counts = Counter(name for event in trajectory.events for pair in event.impulses for name in pair)
    return {str(c.id): counts[str(c.id)] for c in trajectory.scene.circles if counts[str(c.id)]}


def who_hit_whom(trajectory: Trajectory) -> dict[str, int]:
    """Number of impulses between each pair, under `first-second` in scene order."""
    place = {name: number for number, name in enumerate(trajectory.scene.ids)}
    counts = Counter(pair for event in trajectory.events for pair in event.impulses)
    ordered = sorted(counts.items(), key=lambda item: (place[item[0][0]], place[item[0][1]]))
    return {f"{first}-{second}": count for (first, second), count in ordered}


def moved(trajectory: Trajectory) -> list[str]:
    """Ids of the circles that moved: those that did at the start, and those that were hit."""
    hit = {name for event in trajectory.events for pair in event.impulses for name in pair}
    return [str(c.id) for c in trajectory.scene.circles if not c.at_rest or (str(c.id) in hit and not c.fixed)]


def final_velocities(trajectory: Trajectory) -> dict[str, list[float]]:
    """The velocity (vx, vy) with which each circle that can move ends, as doubles."""
    movable = {str(c.id) for c in trajectory.scene.circles if not c.fixed}
    return {c.id: [float(c.vx), float(c.vy)] for c in trajectory.final.circles if c.id in movable}


# ----------------------------------------
# Whether a history keeps the mirror symmetry that its scene starts with.

Axis: TypeAlias = Literal["x", "y"]

LINEAR_PARTS: dict[Axis, tuple[int, int, int, int]] = {"y": (1, 0, 0, -1), "x": (-1, 0, 0, 1)}
"""Of the mirror whose line is a value of the axis: (x, y) becomes (a x + b y, c x + d y)."""


def symmetry(trajectory: Trajectory) -> dict[str, Any] | None:
    """Whether each ball keeps meeting the mirror images of what its own image meets.

    Looks for a mirror line parallel to an axis through the centre of the circles, exactly; None if there is
    none. Then compares partners only, so that a late rounding of positions counts for nothing until it
    changes whom a ball meets.

    Returns:
        `line` (such as `y = 21`), `kept`, and `lost_at`, the time of the first meeting without an image.
    """
    for axis in ("y", "x"):
        found = mirror(trajectory.scene, axis)
        if found is None:
            continue
        line, image = found
        lost = _lost_at(trajectory, image)
        return {"line": f"{axis} = {line.text()}", "kept": lost is None, "lost_at": lost}
    return None


@lru_cache(maxsize=8)
def mirror(scene: Scene, axis: Axis) -> tuple[Quantity, dict[str, str]] | None:
    """A mirror line `axis = constant` of the whole scene, with the image of every circle, wall and thing; else None.

    The exact engine's own isometries are looked through; a lone circle has none worth telling. Where segments or
    polygons share an end, which one of them names, names tell nothing of images: there is none.

    >>> from truebreak.scenarios import Circle, Scene
    >>> mirror(Scene([Circle(0, 2, id="a"), Circle(0, -2, id="b")]), "y")[1]
    {'a': 'b', 'b': 'a'}
    """
    from ...exact.log_symmetry import symmetries
    from ...scenarios.numbers.quantity import ZERO
    from ...scenarios.surfaces import parts_of

    ends = [end for thing in parts_of(scene).values() for end in thing.ends]
    if len(scene.circles) < 2 or len({*ends}) < len(ends):
        return None
    scene = scene.surfaces
    circles = scene.circles
    found = next((s for s in symmetries(scene) if s.mirror and s.matrix == LINEAR_PARTS[axis]), None)
    if found is None:
        return None
    line = sum((getattr(c, axis) for c in circles), ZERO) / len(circles)
    image = {str(c.id): str(circles[place].id) for c, place in zip(circles, found.circles, strict=True)}
    image |= {str(w.id): str(scene.walls[place].id) for w, place in zip(scene.walls, found.walls, strict=True)}
    sides = scene.arc_sides
    image |= {str(side.id): str(sides[place].id) for side, place in zip(sides, found.sides, strict=True)}
    return line, image


def _lost_at(trajectory: Trajectory, image: dict[str, str]) -> float | None:
    """Time of the first meeting whose mirror image does not take place."""
    seen = history(trajectory)
    lost: list[float] = []
    for body, meetings in seen.meetings.items():
        mine = [(name, m.event) for m in meetings for name in sorted(image[p] for p in m.partners)]
        theirs = [(name, m.event) for m in seen.meetings[image[body]] for name in sorted(m.partners)]
        for (a, event), (b, other) in zip(mine, theirs, strict=False):
            if a != b:
                lost.append(min(seen.times[event], seen.times[other]))
                break
        else:
            longer = mine if len(mine) > len(theirs) else theirs
            if abs(len(mine) - len(theirs)) > 1:  # one may lie beyond the end by rounding
                lost.append(seen.times[longer[min(len(mine), len(theirs))][1]])
    return min(lost, default=None)


# ----------------------------------------
# Which balls enter a pocket, and when; which of these entries two runs share, and which one of them only has later.


def pocketed(trajectory: Trajectory) -> dict[str, Any] | None:
    """For each circle whose centre enters a pocket, the first pocket and the instant, to a double's precision.

    None for a scene without pockets.
    """
    scene = trajectory.scene
    if not scene.pockets:
        return None
    first = {p.circle: {"pocket": p.pocket, "time": float(p.time)} for p in reversed(trajectory.pocketings)}
    return {str(c.id): first[str(c.id)] for c in scene.circles if str(c.id) in first}


class Entries:
    """The entries of a run beside those of the reference.

    Two entries are the same where one circle enters one pocket in a flight that both runs have: after the same meeting
    of it, on the same side of the reversal.
    """

    def __init__(self, run: Trajectory, reference: Trajectory, alignment: Alignment, patience: Patience) -> None:
        self.run, self.reference, self.patience = run, reference, patience
        self._met = {id(told): _meetings(told) for told in (run, reference)}
        self._matched = {
            name: {c: m for m, c in sorted(walked.pairs)} for name, walked in alignment.walks.items()
        }  # of several of the reference's, the last
        known = {self._flight(reference, entry): m for m, entry in enumerate(reference.pocketings)}
        flights = {k: self._flight(run, entry) for k, entry in enumerate(run.pocketings)}
        self.same = {k: known[flight] for k, flight in flights.items() if flight in known}

    def inside(self, span: Span) -> tuple[Pocketing, ...]:
        """The run's over the span. One that both have counts by where the reference has it, and so does one that the
        reference, where it ends, has yet to come to."""
        return tuple(entry for k, entry in enumerate(self.run.pocketings) if self._holds(span, k, entry))

    def expected(self, span: Span) -> dict[int, Pocketing]:
        """The reference's over the span, by their number."""
        return {m: entry for m, entry in enumerate(self.reference.pocketings) if span.holds(entry.time)}

    def shared(self, span: Span) -> dict[int, Pocketing]:
        """Those of `expected` that the run has too."""
        both = set(self.same.values())
        return {m: entry for m, entry in self.expected(span).items() if m in both}

    def certain(self, span: Span) -> dict[int, Pocketing]:
        """Those of `expected` that the run has too, or will not come to: for the others it may only be late."""
        both = set(self.same.values())
        return {
            m: entry
            for m, entry in self.expected(span).items()
            if m in both or not self._awaited(self.run, entry, self.reference)
        }

    def _holds(self, span: Span, k: int, entry: Pocketing) -> bool:
        if k in self.same:
            return span.holds(self.reference.pocketings[self.same[k]].time)
        if not span.holds(entry.time) or self._awaited(self.reference, entry, self.run):
            return False
        return self.run.stop.reason is StopReason.QUIET or float(entry.time) < float(self.run.final_time)

    def _awaited(self, run: Trajectory, entry: Pocketing, other: Trajectory) -> bool:
        """Whether a run ends in the very flight of an entry of the other, and that flight comes to it, if late; or at
        the entry's own time, of which it may not have told all."""
        if run.stop.reason is StopReason.QUIET:
            return False
        if float(entry.time) == float(run.final_time):
            return True
        state = run.final[entry.circle]
        x, y, vx, vy = (float(value) for value in (state.x, state.y, state.vx, state.vy))
        pocket = next(pocket for pocket in run.scene.pockets if pocket.id == entry.pocket)
        wait = wait_to_enter(run.scene, pocket, (x, y, vx, vy))
        if wait is None or float(run.final_time) + wait > self.patience.latest(float(entry.time)):
            return False
        here, there = self._flight(run, entry, math.inf), self._flight(other, entry)
        return here == there

    def _flight(
        self, run: Trajectory, entry: Pocketing, time: float | None = None
    ) -> tuple[str, str, int | None, bool]:
        """Who enters what, the reference's number of the last meeting of it before, and whether velocities had been
        reversed; -1 for a meeting that the reference does not have."""
        now = float(entry.time) if time is None else time
        times, indices = self._met[id(run)].get(entry.circle, ((), ()))
        place = bisect_right(times, now)
        last = indices[place - 1] if place else None
        if last is not None and run is self.run:
            last = self._matched[entry.circle].get(last, -1)
        turned = run.reversal is not None and float(run.reversal.time) <= now
        return entry.circle, entry.pocket, last, turned


def wait_to_enter(scene: Scene, pocket: Pocket, row: tuple[float, float, float, float]) -> float | None:
    """The time until a centre at (x, y), with velocity (vx, vy), enters a pocket, under gravity too.

    >>> from truebreak.scenarios import Circle, Pocket, Scene
    >>> scene = Scene([Circle(0, 6)], pockets=[Pocket(0, 0, 1)], gravity=(0, -10))
    >>> round(wait_to_enter(scene, scene.pockets[0], (0.0, 6.0, 0.0, 0.0)), 12)
    1.0
    """
    dx, dy, r, (_, _, vx, vy) = row[0] - float(pocket.x), row[1] - float(pocket.y), float(pocket.r), row
    if scene.gravity is None or dx * dx + dy * dy < r * r:
        return time_to_enter(dx, dy, vx, vy, r)
    gx, gy = map(float, scene.gravity)
    return told_falling_zero(gap_quartic(dx, dy, vx, vy, -gx / 2, -gy / 2, r))


def _meetings(run: Trajectory) -> dict[str, tuple[list[float], list[int]]]:
    """When each circle is struck, and in which events; nothing where there are no pockets."""
    met: dict[str, tuple[list[float], list[int]]] = {}
    for event in run.events if run.scene.pockets else ():
        for name in {name for pair in event.impulses for name in pair}:
            times, indices = met.setdefault(name, ([], []))
            times.append(float(event.time))
            indices.append(event.index)
    return met


# ----------------------------------------
# The break pattern: for each ball, whom it met and where on the table it ended.

COLUMNS, ROWS = 5, 3
"""The cells of a table. Both numbers are odd, so that no mirror line of a table parts two cells: a ball on
it would be in one or the other by rounding alone."""


class WallTable(NamedTuple):
    """The rectangle that the axis-parallel walls of a scene enclose."""

    left: float
    bottom: float
    right: float
    top: float

    def cell(self, x: float, y: float) -> str:
        """The cell of a place: a letter from the left and a number from the bottom.

        >>> WallTable(0, 0, 4, 2).cell(0.5, 0.5), WallTable(0, 0, 4, 2).cell(3.5, 1.5)
        ('A1', 'E3')
        """
        column = int((x - self.left) / (self.right - self.left) * COLUMNS)
        row = int((y - self.bottom) / (self.top - self.bottom) * ROWS)
        return f"{chr(ord('A') + min(max(column, 0), COLUMNS - 1))}{min(max(row, 0), ROWS - 1) + 1}"


def table(scene: Scene) -> WallTable | None:
    """The rectangle between the outermost axis-parallel walls; None unless there are two of each
    direction."""
    upright = [float(w.x0) for w in scene.walls if w.x0 == w.x1]
    level = [float(w.y0) for w in scene.walls if w.y0 == w.y1]
    if len(set(upright)) < 2 or len(set(level)) < 2:
        return None
    return WallTable(min(upright), min(level), max(upright), max(level))


def is_break(scene: Scene) -> bool:
    """Whether a scene is one of a break: it has pockets, or a table on which all balls but one are at rest.

    >>> from truebreak.scenarios import catalogue
    >>> is_break(catalogue.build("rack:rows=2,pockets=no")), is_break(catalogue.build("gas"))
    (True, False)
    """
    movable = [c for c in scene.circles if not c.fixed]
    struck = [c for c in movable if not c.at_rest]
    return len(movable) > 1 and table(scene) is not None and (bool(scene.pockets) or len(struck) == 1)


def break_pattern(trajectory: Trajectory) -> dict[str, Any] | None:
    """For each circle that can move, the partners that it met and the cell (or pocket) that it ended in.

    Cells are those of a grid of 5 by 3 on the table, A1 at the lower left. None unless the scene is one of a break.
    """
    return pattern(trajectory) if is_break(trajectory.scene) else None


def pattern(trajectory: Trajectory) -> dict[str, Any]:
    """For each circle that can move, the partners that it met; on a table, where it ended too."""
    scene = trajectory.scene
    bounds = table(scene)
    met: dict[str, set[str]] = {str(c.id): set() for c in scene.circles if not c.fixed}
    for event in trajectory.events:
        for first, second in event.impulses:
            if first in met:
                met[first].add(second)
            if second in met:
                met[second].add(first)
    pockets = pocketed(trajectory) or {}
    found: dict[str, Any] = {}
    for circle in trajectory.final.circles:
        if circle.id not in met:
            continue
        found[circle.id] = {"met": [name for name in scene.ids if name in met[circle.id]]}
        if bounds is not None:
            entry = pockets.get(circle.id)
            place = bounds.cell(float(circle.x), float(circle.y))
            found[circle.id]["ended"] = entry["pocket"] if entry else place
    return found
