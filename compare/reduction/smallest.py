"""The smallest scene that still shows something: what can be left out, and what a search for it comes to."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from enum import Enum
from fractions import Fraction
from itertools import chain, pairwise
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.things import Arc, Circle, Pocket, Polygon, Segment, Wall

if TYPE_CHECKING:
    from ..candidate import Candidate
    from ..comparison import Comparison

Item = TypeVar("Item")
Thing: TypeAlias = Circle | Wall | Segment | Polygon | Arc | Pocket


def ddmin(items: Sequence[Item], still: Callable[[Sequence[Item]], bool], parts: int = 2) -> list[Item]:
    """A part of `items` on which `still` holds, and from which no single item can be left out.

    The list is cut into parts; a part that is enough by itself is taken, else what is enough without one part; else
    the parts are halved. At the finest cut only what is left without one item is asked for. `still` is taken to hold
    on all of `items`; of n items it is asked n**2 + 3 n times at most.

    Args:
        parts: into how many the list is cut at first; as many as there are items: each is left out by itself.

    Source: A. Zeller and R. Hildebrandt, *Simplifying and isolating failure-inducing input*, IEEE Transactions on
    Software Engineering 28 (2002), 183-200: algorithm ddmin.

    >>> ddmin(range(1, 9), lambda kept: {1, 7, 8} <= {*kept})
    [1, 7, 8]
    >>> ddmin("abc", lambda kept: True)
    []
    """
    kept = list(items)
    if not kept or still([]):
        return []
    parts = max(2, min(parts, len(kept)))
    while len(kept) >= 2:
        pieces = cut(kept, parts)
        smaller = next((p for p in pieces if still(p)), None) if parts < len(kept) else None
        if smaller is not None:
            kept, parts = smaller, 2
            continue
        rests = ([*chain(*pieces[:k], *pieces[k + 1 :])] for k in range(parts))
        smaller = next((rest for rest in rests if still(rest)), None)
        if smaller is not None:
            kept, parts = smaller, max(parts - 1, 2)
        elif parts < len(kept):
            parts = min(2 * parts, len(kept))
        else:
            break
    return kept


def cut(items: Sequence[Item], parts: int) -> list[list[Item]]:
    """A list in so many runs of about the same length.

    >>> cut([1, 2, 3, 4, 5], 2)
    [[1, 2], [3, 4, 5]]
    """
    ends = [len(items) * k // parts for k in range(parts + 1)]
    return [list(items[low:high]) for low, high in pairwise(ends)]


# ----------------------------------------
# What a scene is made of, so that it can be left out: things, settings, and the digits of numbers.

THINGS = ("circles", "walls", "segments", "polygons", "arcs", "pockets")

SETTINGS = ("reverse_after", "reverse_at", "capture", "until")

KEYS = {
    "circles": ("x", "y", "r", "vx", "vy", "m"),
    "walls": ("x0", "y0", "x1", "y1"),
    "segments": ("x0", "y0", "x1", "y1", "r"),
    "pockets": ("x", "y", "r"),
}
"""The numbers of a thing; `id` and `point` are not numbers. A polygon has r, and x1, y1, x2, ... of its points; an arc
x, y, r, and x0, y0, x1, y1 where it is not all of its circle."""

DENOMINATORS = tuple(10**k for k in (0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 40))
"""Largest denominators of the fractions that a number is rounded to, the shortest first: a double has 16 digits, and
scenes closer to a tie than doubles can tell have more."""

ROOT_DIGITS = 60
"""Digits of a number with roots that are looked at before it is rounded: more than the longest fraction has."""


@dataclass(frozen=True)
class SceneParts:
    """Items of a scene, any of which may be left out.

    Attributes:
        kind: what they are called.
        items: their names.
        keeping: the scene with these of them alone.
            It raises a `SceneError` where that is no scene.
    """

    kind: str
    items: tuple[str, ...]
    keeping: Callable[[Sequence[str]], Scene]


def things(scene: Scene, kind: str) -> SceneParts:
    """The circles, the walls, the segments, the polygons, the arcs or the pockets by their ids.

    >>> parts = things(Scene([Circle(0, 0, id="a"), Circle(4, 0, id="b")]), "circles")
    >>> parts.items, parts.keeping(["b"]).ids
    (('a', 'b'), ('b',))
    """
    all_of: tuple[Any, ...] = getattr(scene, kind)

    def keeping(ids: Sequence[str]) -> Scene:
        return scene.with_changes(**{kind: [thing for thing in all_of if thing.id in ids]})

    return SceneParts(kind, tuple(str(thing.id) for thing in all_of), keeping)


def corners(scene: Scene) -> SceneParts:
    """The corners at which two segments end, and no third, and those of polygons: without one it goes straight on.

    >>> bars = [Segment(0, 0, 1, 1, id="up"), Segment(1, 1, 2, 0, id="down")]
    >>> parts = corners(Scene([Circle(0, 9)], segments=bars))
    >>> parts.items, [(s.id, s.x1.text(), s.y1.text()) for s in parts.keeping([]).segments]
    (('up/down',), [('up', '2', '0')])
    >>> box = corners(Scene([Circle(0, 9)], polygons=[Polygon([(0, 0), (1, 0), (1, 1), (0, 1)], "box")]))
    >>> box.items, len(box.keeping(["box.1", "box.2", "box.4"]).polygons[0].points)
    (('box.1', 'box.2', 'box.3', 'box.4'), 3)
    """
    at: dict[tuple[Quantity, ...], list[Segment]] = {}
    for segment in scene.segments:
        for place in ((segment.x0, segment.y0), (segment.x1, segment.y1)):
            at.setdefault((*place, segment.vx, segment.vy), []).append(segment)
    joints = {f"{pair[0].id}/{pair[1].id}": place for place, pair in at.items() if len(pair) == 2}
    points = [(f"{g.id}.{k}", g) for g in scene.polygons for k in range(1, len(g.points) + 1)]

    def keeping(kept: Sequence[str]) -> Scene:
        left, solids = list(scene.segments), list[Polygon]()
        for g in scene.polygons:
            places = [place for k, place in enumerate(g.points, start=1) if f"{g.id}.{k}" in kept]
            solids.append(g if len(places) == len(g.points) else Polygon(places, g.id, g.r, g.vx, g.vy))
        for name, place in joints.items():
            if name in kept:
                continue
            spot, pace = place[:2], place[2:]
            one, other = (
                k for k, s in enumerate(left) if spot in ((s.x0, s.y0), (s.x1, s.y1)) and pace == (s.vx, s.vy)
            )
            first, second = left[one], left.pop(other)
            ends = [end for s in (first, second) for end in ((s.x0, s.y0), (s.x1, s.y1)) if end != spot]
            left[one] = Segment(*ends[0], *ends[1], first.id, first.r, first.vx, first.vy)
        return scene.with_changes(segments=left, polygons=solids)

    return SceneParts("corners", (*joints, *(name for name, _ in points)), keeping)


def settings(scene: Scene) -> SceneParts:
    """The scene's reversal, its capture in pockets and its limit in time, where it has any.

    >>> settings(Scene([Circle(0, 0)], reverse_at=3)).items
    ('reverse_at',)
    """

    def keeping(names: Sequence[str]) -> Scene:
        gone = {name: False if name == "capture" else None for name in SETTINGS if name not in names}
        return scene.with_changes(**gone)

    return SceneParts("settings", tuple(name for name in SETTINGS if getattr(scene, name)), keeping)


def digits(scene: Scene, denominator: int) -> SceneParts:
    """The numbers that are shorter once they are rounded to a fraction of at most this denominator.

    Without one of them is: with it rounded.

    >>> parts = digits(Scene([Circle("22/7", 0)]), 1)
    >>> parts.items, parts.keeping([]).circles[0].x
    (('c1.x',), Quantity('3'))
    """
    shorter = {
        (kind, k, key): value
        for kind, k, key, number in numbers(scene)
        if (value := rounded(number, denominator)) is not None
    }
    names = {place: f"{getattr(scene, place[0])[place[1]].id}.{place[2]}" for place in shorter}

    def keeping(kept: Sequence[str]) -> Scene:
        changed: dict[str, list[Thing]] = {}
        for (kind, k, key), value in shorter.items():
            if names[kind, k, key] not in kept:
                row = changed.setdefault(kind, list(getattr(scene, kind)))
                row[k] = with_number(row[k], kind, key, value)
        return scene.with_changes(**changed)

    return SceneParts("digits", tuple(names.values()), keeping)


def numbers(scene: Scene) -> Iterator[tuple[str, int, str, Quantity]]:
    """Every number of every thing: its kind, its place, its key and its value. A mass that is infinite is none."""
    for kind, keys in KEYS.items():
        for k, thing in enumerate(getattr(scene, kind)):
            for key in keys:
                value = getattr(thing, key)
                if isinstance(value, Quantity):
                    yield kind, k, key, value
    for k, polygon in enumerate(scene.polygons):
        yield "polygons", k, "r", polygon.r
        for n, place in enumerate(polygon.points, start=1):
            yield from (("polygons", k, f"{axis}{n}", value) for axis, value in zip("xy", place, strict=True))
    for k, arc in enumerate(scene.arcs):
        yield from (("arcs", k, key, getattr(arc, key)) for key in arc_keys(arc))


def arc_keys(arc: Arc) -> tuple[str, ...]:
    """The numbers of an arc."""
    return KEYS["pockets"] if arc.full else (*KEYS["pockets"], *KEYS["walls"])


def with_number(thing: Thing, kind: str, key: str, value: Quantity) -> Thing:
    """The thing with another number in one place; it is checked as any other.

    Raises:
        SceneError: if it must not have that number.
    """
    if isinstance(thing, Polygon):
        points = [list(place) for place in thing.points]
        others = {name: getattr(thing, name) for name in ("r", "vx", "vy")}
        if key in others:
            others[key] = value
        else:
            points[int(key[1:]) - 1]["xy".index(key[0])] = value
        return Polygon([(x, y) for x, y in points], thing.id, **others)
    names = arc_keys(thing) if isinstance(thing, Arc) else KEYS[kind]
    given = {name: getattr(thing, name) for name in names} | {key: value, "id": thing.id}
    if isinstance(thing, Arc):
        given["full"] = thing.full
    if isinstance(thing, Circle):
        given["point"] = thing.point
    return type(thing)(**given)


def rounded(number: Quantity, denominator: int) -> Quantity | None:
    """The nearest fraction of at most this denominator; None if it is no shorter to write.

    >>> rounded(Quantity.of("7799/1000"), 10), rounded(Quantity.of("sqrt(2)"), 10), rounded(Quantity.of("1/3"), 10)
    (Quantity('39/5'), Quantity('7/5'), None)
    """
    value = number.fraction
    if value is None:
        value = Fraction(number.digits(ROOT_DIGITS))
    told = Quantity.of(value.limit_denominator(denominator))
    return told if written(told) < written(number) else None


def written(number: Quantity) -> int:
    """How long a number is to write: its characters, without its sign; none for zero.

    >>> written(Quantity.of("-22/7")), written(Quantity.of("sqrt(2)")), written(Quantity.of(0))
    (4, 7, 0)
    """
    return len(number.text().removeprefix("-")) if number.sign() else 0


def length(scene: Scene) -> int:
    """How long all of a scene's numbers are to write.

    >>> length(Scene([Circle("1/3", 0)]))
    5
    """
    return sum(written(number) for *_, number in numbers(scene))


# ----------------------------------------
# What a search for the smallest scene comes to.


class End(Enum):
    """Why a search ended; the value is what a person reads."""

    MINIMAL = "1-minimal: nothing more can be left out by itself"
    RUNS = "the limit on comparisons was reached: more might be left out"
    SECONDS = "the seconds were over: more might be left out"
    INTERRUPTED = "interrupted: more might be left out"


@dataclass(frozen=True)
class Reduction:
    """One scene that still shows a divergence, or a law not kept, and what was left out for it.

    Attributes:
        kind: what was left out: circles, walls, segments, polygons, arcs, pockets, corners, settings, events or digits.
        removed: ids of things; of corners those of the two segments that became one, or a polygon's and a number;
            names of settings, `ID.KEY` of numbers that were rounded; of events, where the run ends.
        comparison: of what is left: the engine compared with the certified run.
        runs: comparisons made by then.
    """

    kind: str
    removed: tuple[str, ...]
    comparison: Comparison = field(repr=False)
    runs: int

    @property
    def change(self) -> str:
        """What was left out, in words.

        >>> Reduction("circles", ("a", "b"), None, 3).change, Reduction("events", ("12",), None, 4).change
        ('circles a, b', 'events after 12')
        >>> Reduction("circles", ("a",), None, 5).change
        'circle a'
        """
        if self.kind == "events":
            return f"events after {self.removed[0]}"
        if self.kind == "digits":
            return f"digits of {', '.join(self.removed)}"
        return f"{self.kind if len(self.removed) > 1 else self.kind.removesuffix('s')} {', '.join(self.removed)}"


@dataclass(frozen=True)
class SceneSize:
    """How large a scene is: its things, the limit on its instants, and the characters of its numbers."""

    circles: int
    walls: int
    pockets: int
    events: int | None
    characters: int
    segments: int = 0
    polygons: int = 0
    arcs: int = 0

    @staticmethod
    def of(scene: Scene) -> SceneSize:
        """The size of a scene."""
        counts = len(scene.circles), len(scene.walls), len(scene.pockets)
        solids = len(scene.segments), len(scene.polygons), len(scene.arcs)
        return SceneSize(*counts, scene.events, length(scene), *solids)


@dataclass(frozen=True)
class Smallest:
    """The smallest scene found on which an engine diverges, or breaks a law.

    Attributes:
        original: the scene that it comes from, with the limits that were asked for.
        comparison: of the smallest scene: the engine compared with the certified run.
        steps: what was left out, in this order.
        runs: comparisons made in the search; one more, of the last scene, tells its cause.
        end: why the search ended.
        law: whether it was for a law not kept, and not for a divergence.
    """

    original: Scene = field(repr=False)
    comparison: Comparison
    steps: tuple[Reduction, ...] = field(repr=False)
    runs: int
    end: End
    law: bool = False

    @property
    def scene(self) -> Scene:
        """The smallest scene; its limits are its own, so that `compare` needs none."""
        return self.comparison.scene

    @property
    def minimal(self) -> bool:
        """Whether it is 1-minimal: without any one circle, wall, segment, polygon, pocket, corner, setting, its
        last event, or the digits that
        any one number has beyond the next shorter rounding, the divergence (or the breach of the law) is gone, or the
        scene is none."""
        return self.end is End.MINIMAL

    @property
    def candidate(self) -> Candidate:
        """The engine's side of the comparison."""
        return self.comparison.candidates[0]
