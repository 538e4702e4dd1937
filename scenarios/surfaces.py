"""What a circle meets of segments and polygons: open faces, each met from its own side, and round ends."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import hypot, isfinite
from typing import Any, NamedTuple

from .errors import SceneError
from .neighbours import LARGEST, TINIEST, shown_amount
from .numbers.quantity import ZERO, Quantity
from .things import FIXED, Arc, Circle, MovingEnd, Point, Polygon, Segment, Wall, box_of, boxes_meet, crossing

# -- A segment of half thickness r is the sum of a line from p0 to p1 and a disc of radius r. A circle of radius R meets
# it where its centre comes within r + R of that line: over the open line that is as far as a straight wall that is
# moved by r towards the circle, at its ends as far as a fixed circle of radius r. So a segment is two faces, walls
# that are met from one side alone and where the foot of the circle's centre lies strictly between the ends, and two
# ends, fixed circles, of radius 0 too. A corner belongs to its end: faces are open. An end that segments share is one.
#
# A polygon has, for each side, the one face that looks outward, and at each convex corner an end. What is outside of a
# concave one lies in an angle below a half-turn, and a circle there that is not nearer than R + r to either side is
# farther than that from the corner: it is met by a point alone, where r is 0, which nothing keeps off both sides.


@dataclass(frozen=True, init=False)
class SegmentFace(Wall):
    """One side of a segment or polygon: a wall that only what lies on its left meets, strictly between its points."""

    is_face = True

    def side(self, x: Quantity, y: Quantity) -> int:
        """The left one, whatever starts where."""
        return 1

    def is_met(self, gap: int) -> bool:
        """From its own side alone."""
        return gap > 0

    @classmethod
    def of(cls, segment: Segment, back: bool) -> SegmentFace:
        """The left side of a segment, or its right side, which is the left one of the way back.

        >>> face = SegmentFace.of(Segment(0, 0, 3, 4, id="s", r=5), back=False)
        >>> face.x0.text(), face.y0.text(), face.x1.text(), face.y1.text(), face.id
        ('-4', '3', '-1', '7', 's')
        """
        x0, y0, x1, y1 = segment.x0, segment.y0, segment.x1, segment.y1
        if back:
            x0, y0, x1, y1 = x1, y1, x0, y0
        pace = segment.vx, segment.vy
        face = cls(x0, y0, x1, y1, segment.id, *pace)
        if segment.r.sign() == 0:
            return face
        nx, ny = face.normal
        scale = segment.r / (nx * nx + ny * ny).sqrt()
        dx, dy = scale * nx, scale * ny
        return cls(x0 + dx, y0 + dy, x1 + dx, y1 + dy, segment.id, *pace)


def faces_of(segments: Sequence[Segment], polygons: Sequence[Polygon] = ()) -> Iterator[SegmentFace]:
    """The faces: two of each segment, then one of each side of the polygons."""
    for segment in segments:
        for back in (False, True):
            yield SegmentFace.of(segment, back)
    for polygon in polygons:
        for side in sides_of(polygon):
            yield SegmentFace.of(side, back=False)


def sides_of(polygon: Polygon) -> list[Segment]:
    """The sides of a polygon as segments as thick, each with what is outside to its left."""
    return [Segment(*a, *b, polygon.id, polygon.r, polygon.vx, polygon.vy) for a, b in polygon.sides()]


def ends_of(
    segments: Sequence[Segment], polygons: Sequence[Polygon] = (), points: bool = False, arcs: Sequence[Arc] = ()
) -> tuple[Circle, ...]:
    """The ends as fixed circles, with the greatest r there, each named by the first thing that has that.

    What moves has ends of its own (`MovingEnd`), which only what moves with the same velocity shares.

    Args:
        points: whether there are circles of radius 0, which meet concave corners too.

    >>> [end.x.text() for end in ends_of([], [Polygon([(0, 0), (2, 0), (1, 1), (1, 3)], id="dart")])]
    ['1', '2', '0']
    """
    found: dict[tuple[Point, Point], tuple[Quantity, str | None]] = {}

    def take(place: Point, r: Quantity, name: str | None, drift: Point = Circle.drift) -> None:
        known = found.get((place, drift))
        if known is None or r > known[0]:
            found[place, drift] = r, name

    for segment in segments:
        for place in ((segment.x0, segment.y0), (segment.x1, segment.y1)):
            take(place, segment.r, segment.id, (segment.vx, segment.vy))
    for polygon in polygons:
        sides = polygon.sides()
        for (a, b), (_, c) in zip(sides, (*sides[1:], sides[0]), strict=True):
            turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            if turn.sign() < 0 or (points and polygon.r.sign() == 0):
                take(b, polygon.r, polygon.id, (polygon.vx, polygon.vy))
    for arc in arcs:
        for place in arc.ends:
            take(place, ZERO, arc.id)
    return tuple(
        Circle(*place, r=r, m=FIXED, id=name, point=r.sign() == 0)
        if drift == Circle.drift
        else MovingEnd(place, r, drift, name)
        for (place, drift), (r, name) in found.items()
    )


# -- Checks of segments and polygons, exactly, after doubles with a bound on their rounding have told what is far.

FAR = 2.0**-40
"""A share of all coordinates and radii that is more than what doubles lose of a distance from a segment."""


def check_surfaces(
    circles: Sequence[Circle],
    walls: Sequence[Wall],
    segments: Sequence[Segment],
    polygons: Sequence[Polygon],
    ends: Sequence[Circle],
) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """Refuses what lies on each other or overlaps, and circles across a segment or in a polygon; touching is fine.

    What moves with another velocity than the other is not refused, as it goes through it then, before or after.

    Args:
        ends: as `ends_of` gives them.

    Returns:
        The pairs at gap zero: by index in `Scene.ids`, and by index in the lowered scene.

    Raises:
        SceneError: naming both, and the remedy.

    >>> bar = Segment(-1, 0, 1, 0, id="s")
    >>> check_surfaces([Circle(0, 1), Circle(2, 0)], [], [bar], [], ends_of([bar]))
    ([(0, 2), (1, 2)], [(0, 4), (1, 3)])
    """
    for k, segment in enumerate(segments):
        for other in segments[:k]:
            if _go_together(other, segment) and _run_on(other, segment):
                raise SceneError(f"segment {segment.id!r}: lies on segment {other.id!r}; make them one")
    sides = [sides_of(polygon) for polygon in polygons]
    _check_polygons(segments, polygons, sides)
    known = {(end.x, end.y, end.drift): len(circles) + k for k, end in enumerate(ends)}
    first, first_face = len(circles) + len(walls), len(circles) + len(ends) + len(walls)
    # each bar with the index of its thing, the words for that, and the index of its faces: a side has but one
    bars = [(bar, first + k, "segment", first_face + 2 * k) for k, bar in enumerate(segments)]
    first_face += 2 * len(segments)
    for k, bar in ((k, bar) for k, mine in enumerate(sides) for bar in mine):
        bars.append((bar, first + len(segments) + k, "polygon", first_face))
        first_face += 1
    _check_outside(circles, polygons)
    outer: set[tuple[int, int]] = set()
    inner: set[tuple[int, int]] = set()
    rough = [_rough(bar) for bar, *_ in bars]
    for i, circle in enumerate(circles):
        for bar, thing, kind, face in (bars[k] for k in _near(circle, rough)):
            part = _touched(circle, bar, kind)
            end = (*part, (bar.vx, bar.vy)) if isinstance(part, tuple) else None
            if end is not None and end not in known:  # a concave corner: the circle lies across a side of it
                continue
            if part is not None and not circle.fixed:
                outer.add((i, thing))
                inner.add((i, known[end] if end is not None else face + (part if isinstance(part, int) else 0)))
    return sorted(outer), sorted(inner)


def _check_outside(circles: Sequence[Circle], polygons: Sequence[Polygon]) -> None:
    """Refuses circles whose centre is inside of a polygon; what is across a side is found elsewhere."""
    boxes = [box_of(polygon.points) for polygon in polygons]
    for circle in circles if boxes else ():
        place = box_of([(circle.x, circle.y)])
        for polygon, box in zip(polygons, boxes, strict=True):
            if boxes_meet(place, box) and polygon.around(circle.x, circle.y):
                raise SceneError(f"circle {circle.id!r}: its centre is in polygon {polygon.id!r}; move it out")


def _check_polygons(
    segments: Sequence[Segment], polygons: Sequence[Polygon], sides: Sequence[Sequence[Segment]]
) -> None:
    """Refuses polygons that overlap, and segments that lie on a side of one."""
    boxes = [box_of(polygon.points) for polygon in polygons]
    spans = [_spans(polygon) for polygon in polygons]
    for k, polygon in enumerate(polygons):
        for segment in segments:
            if _go_together(polygon, segment) and any(_run_on(side, segment) for side in sides[k]):
                raise SceneError(f"segment {segment.id!r}: lies on a side of polygon {polygon.id!r}; leave it out")
        for j in range(k):
            if (
                not _go_together(polygon, polygons[j])
                or not boxes_meet(boxes[j], boxes[k])
                or any(a[1] <= b[0] or b[1] <= a[0] for a, b in zip(spans[j], spans[k], strict=True))
            ):
                continue  # a line lies between them, or both touch it
            if _overlap(polygons[j], polygon, sides[j], sides[k]):
                names = f"polygon {polygon.id!r}: overlaps polygon {polygons[j].id!r}"
                raise SceneError(f"{names}; make them one, or move it")


def _go_together(one: Segment | Polygon, other: Segment | Polygon) -> bool:
    """Whether two have one velocity."""
    return one.vx == other.vx and one.vy == other.vy


def _spans(polygon: Polygon) -> tuple[tuple[Quantity, Quantity], tuple[Quantity, Quantity]]:
    """The least and the greatest x, and y, of its points."""
    xs, ys = zip(*polygon.points, strict=True)
    return (min(xs), max(xs)), (min(ys), max(ys))


def _overlap(a: Polygon, b: Polygon, mine: Sequence[Segment], theirs: Sequence[Segment]) -> bool:
    """Whether two polygons cross, lie on each other, or one has a corner of the other inside; touching is fine."""
    if any(crossing(way, other) for way in a.sides() for other in b.sides()):
        return True
    for one in mine:
        for other in theirs:
            along = (one.x1 - one.x0) * (other.x1 - other.x0) + (one.y1 - one.y0) * (other.y1 - other.y0)
            if along.sign() > 0 and _run_on(one, other):
                return True
    return _has_inside(a, b, mine) or _has_inside(b, a, theirs)


def _has_inside(around: Polygon, polygon: Polygon, sides: Sequence[Segment]) -> bool:
    """Whether a corner of a polygon is inside of another, and not on a side of it."""
    on = [[_beside(side, *place) for side in sides] for place in polygon.corners()]
    return any(around.around(*place) for place, told in zip(polygon.corners(), on, strict=True) if not any(told))


def _beside(side: Segment, x: Quantity, y: Quantity) -> bool:
    """Whether a point lies on a side, its ends included."""
    ux, uy, dx, dy = side.x1 - side.x0, side.y1 - side.y0, x - side.x0, y - side.y0
    along = dx * ux + dy * uy
    return (ux * dy - uy * dx).sign() == 0 and along.sign() >= 0 and (ux * ux + uy * uy - along).sign() >= 0


def _rough(segment: Segment) -> tuple[float, float, float, float, float] | None:
    try:
        numbers = tuple(float(q) for q in (segment.x0, segment.y0, segment.x1, segment.y1, segment.r))
    except OverflowError:
        return None
    x0, y0, x1, y1, r = numbers
    length = hypot(x1 - x0, y1 - y0)
    return (x0, y0, x1, y1, r) if max(map(abs, numbers)) < LARGEST and length > 1 / LARGEST else None


def _near(circle: Circle, rough: Sequence[tuple[float, float, float, float, float] | None]) -> Iterator[int]:
    """The segments from which doubles do not tell a circle to be apart."""
    try:
        x, y, radius = float(circle.x), float(circle.y), float(circle.r)
    except OverflowError:
        yield from range(len(rough))
        return
    for k, row in enumerate(rough):
        if row is not None:
            x0, y0, x1, y1, r = row
            ux, uy = x1 - x0, y1 - y0
            share = max(0.0, min(1.0, ((x - x0) * ux + (y - y0) * uy) / (ux * ux + uy * uy)))
            away = hypot(x - x0 - share * ux, y - y0 - share * uy)
            size = abs(x) + abs(y) + abs(x0) + abs(y0) + abs(x1) + abs(y1) + radius + r
            if isfinite(size) and away > radius + r + FAR * size + TINIEST:
                continue
        yield k


def _touched(circle: Circle, segment: Segment, kind: str) -> Point | int | None:
    """The end that a circle touches, or the face (0 or 1); None where they are apart.

    Args:
        kind: what the segment is, or is a side of.

    Raises:
        SceneError: where they overlap.
    """
    ux, uy = segment.x1 - segment.x0, segment.y1 - segment.y0
    dx, dy = circle.x - segment.x0, circle.y - segment.y0
    square, foot, height = ux * ux + uy * uy, dx * ux + dy * uy, ux * dy - uy * dx
    reach = circle.r + segment.r
    part: Point | int
    if foot.sign() > 0 and (square - foot).sign() > 0:
        part, away2 = (0 if height.sign() > 0 else 1), height * height / square
    else:
        part = (segment.x0, segment.y0) if foot.sign() <= 0 else (segment.x1, segment.y1)
        away2 = (circle.x - part[0]) * (circle.x - part[0]) + (circle.y - part[1]) * (circle.y - part[1])
    sign = (away2 - reach * reach).sign()
    if away2.sign() == 0:
        raise SceneError(f"circle {circle.id!r}: its centre lies on {kind} {segment.id!r}; move it to one side")
    if sign < 0:
        overlap = shown_amount(reach - away2.sqrt())
        raise SceneError(
            f"circle {circle.id!r}: lies across {kind} {segment.id!r}, by {overlap} at time 0; move it, or reduce r"
        )
    return part if sign == 0 else None


def _run_on(a: Segment, b: Segment) -> bool:
    """Whether two segments on one line have more than a point in common."""
    ux, uy = a.x1 - a.x0, a.y1 - a.y0
    places: list[Quantity] = []
    for x, y in ((b.x0, b.y0), (b.x1, b.y1)):
        dx, dy = x - a.x0, y - a.y0
        if (ux * dy - uy * dx).sign() != 0:
            return False
        places.append(dx * ux + dy * uy)
    low, high = max(min(places), ZERO), min(max(places), ux * ux + uy * uy)
    return (high - low).sign() > 0


# -- Which faces and ends are of which thing.


class ThingParts(NamedTuple):
    """What a thing of several parts is made of: faces, ends and sides of an arc, by index in `Scene.surfaces`.

    Of a convex one what recedes from its nearest part recedes for ever; of another it may come to a part farther on.
    """

    faces: tuple[int, ...]
    ends: tuple[int, ...]
    convex: bool = True
    sides: tuple[int, ...] = ()


@lru_cache(maxsize=64)
def parts_of(scene: Any) -> Mapping[int, ThingParts]:
    """The parts of every thing that has several, by its place in `Scene.ids`; of a `Scene`, which imports this module.

    >>> from truebreak.scenarios import Scene
    >>> parts_of(Scene([Circle(0, 5)], [Wall(0, -9, 1, -9)], segments=[Segment(-1, 0, 1, 0)]))
    {2: ThingParts(faces=(1, 2), ends=(1, 2), convex=True, sides=())}
    >>> parts_of(Scene([Circle(0, 5)], polygons=[Polygon([(0, 0), (2, 0), (1, 1), (1, 3)])]))
    {1: ThingParts(faces=(0, 1, 2, 3), ends=(1, 2, 3), convex=False, sides=())}
    >>> parts_of(Scene([Circle(0, 0)], arcs=[Arc(0, 0, 5, full=True)]))
    {1: ThingParts(faces=(), ends=(), convex=False, sides=(0, 1))}
    """
    whole, before = scene.surfaces, len(scene.circles) + len(scene.walls)
    ends = {((circle := whole.circles[k]).x, circle.y, circle.drift): k for k in whole.ends}
    found: dict[int, ThingParts] = {}
    face = whole.faces.start
    for k, segment in enumerate(scene.segments, start=before):
        drift = segment.vx, segment.vy
        both = ends[segment.x0, segment.y0, drift], ends[segment.x1, segment.y1, drift]
        found[k] = ThingParts((face, face + 1), both)
        face += 2
    for k, polygon in enumerate(scene.polygons, start=before + len(scene.segments)):
        sides = polygon.sides()
        corners = (ends.get((*end, (polygon.vx, polygon.vy))) for _, end in sides)
        faces = tuple(range(face, face + len(sides)))
        found[k] = ThingParts(faces, tuple(end for end in corners if end is not None), polygon.convex)
        face += len(sides)
    for k, arc in enumerate(scene.arcs):
        place = before + len(scene.segments) + len(scene.polygons) + k
        found[place] = ThingParts((), tuple(ends[(*end, Circle.drift)] for end in arc.ends), False, (2 * k, 2 * k + 1))
    return found
