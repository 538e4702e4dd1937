"""What a circle meets of a segment: two open faces, each met from its own side, and two round ends."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import hypot, isfinite
from typing import TYPE_CHECKING, NamedTuple

from .errors import SceneError
from .neighbours import LARGEST, TINIEST, shown_amount
from .numbers.quantity import ZERO, Quantity
from .things import FIXED, Circle, Segment, Wall

if TYPE_CHECKING:
    from .scene import Scene

# -- A segment of half thickness r is the sum of a line from p0 to p1 and a disc of radius r. A circle of radius R meets
# it where its centre comes within r + R of that line: over the open line that is as far as a straight wall that is
# moved by r towards the circle, at its ends as far as a fixed circle of radius r. So a segment is two faces, walls
# that are met from one side alone and where the foot of the circle's centre lies strictly between the ends, and two
# ends, fixed circles, of radius 0 too. A corner belongs to its end: faces are open. An end that segments share is one.


@dataclass(frozen=True, init=False)
class SegmentFace(Wall):
    """One side of a segment: a wall that only what lies on its left meets, strictly between its two points."""

    is_face = True

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
        face = cls(x0, y0, x1, y1, id=segment.id)
        if segment.r.sign() == 0:
            return face
        nx, ny = face.normal
        scale = segment.r / (nx * nx + ny * ny).sqrt()
        dx, dy = scale * nx, scale * ny
        return cls(x0 + dx, y0 + dy, x1 + dx, y1 + dy, id=segment.id)


def ends_of(segments: Sequence[Segment]) -> tuple[Circle, ...]:
    """The ends of segments as fixed circles, with the greatest r there, named by the first segment that has that."""
    found: dict[tuple[Quantity, Quantity], tuple[Quantity, str | None]] = {}
    for segment in segments:
        for place in ((segment.x0, segment.y0), (segment.x1, segment.y1)):
            r, name = found.get(place, (segment.r, segment.id))
            found[place] = (segment.r, segment.id) if segment.r > r else (r, name)
    return tuple(Circle(*place, r=r, m=FIXED, id=name, point=r.sign() == 0) for place, (r, name) in found.items())


# -- Checks of segments, exactly, after doubles with a bound on their rounding have told what is far.

FAR = 2.0**-40
"""A share of all coordinates and radii that is more than what doubles lose of a distance from a segment."""


def check_segments(
    circles: Sequence[Circle], walls: Sequence[Wall], segments: Sequence[Segment]
) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """Refuses segments that lie on each other, and circles across a segment; touching is fine.

    Returns:
        The pairs at gap zero: by index in `Scene.ids`, and by index in the lowered scene.

    Raises:
        SceneError: naming both, and the remedy.

    >>> check_segments([Circle(0, 1), Circle(2, 0)], [], [Segment(-1, 0, 1, 0, id="s")])
    ([(0, 2), (1, 2)], [(0, 4), (1, 3)])
    """
    for k, segment in enumerate(segments):
        for other in segments[:k]:
            _check_beside(other, segment)
    known = {(end.x, end.y): len(circles) + k for k, end in enumerate(ends_of(segments))}
    first_face = len(circles) + len(known) + len(walls)
    outer: list[tuple[int, int]] = []
    inner: list[tuple[int, int]] = []
    rough = [_rough(segment) for segment in segments]
    for i, circle in enumerate(circles):
        for k in _near(circle, rough):
            part = _touched(circle, segments[k])
            if part is not None and not circle.fixed:
                outer.append((i, len(circles) + len(walls) + k))
                inner.append((i, known[part] if isinstance(part, tuple) else first_face + 2 * k + part))
    return outer, sorted(set(inner))


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


def _touched(circle: Circle, segment: Segment) -> tuple[Quantity, Quantity] | int | None:
    """The end that a circle touches, or the face (0 or 1); None where they are apart.

    Raises:
        SceneError: where they overlap.
    """
    ux, uy = segment.x1 - segment.x0, segment.y1 - segment.y0
    dx, dy = circle.x - segment.x0, circle.y - segment.y0
    square, foot, height = ux * ux + uy * uy, dx * ux + dy * uy, ux * dy - uy * dx
    reach = circle.r + segment.r
    part: tuple[Quantity, Quantity] | int
    if foot.sign() > 0 and (square - foot).sign() > 0:
        part, away2 = (0 if height.sign() > 0 else 1), height * height / square
    else:
        part = (segment.x0, segment.y0) if foot.sign() <= 0 else (segment.x1, segment.y1)
        away2 = (circle.x - part[0]) * (circle.x - part[0]) + (circle.y - part[1]) * (circle.y - part[1])
    sign = (away2 - reach * reach).sign()
    if away2.sign() == 0:
        raise SceneError(f"circle {circle.id!r}: its centre lies on segment {segment.id!r}; move it to one side")
    if sign < 0:
        overlap = shown_amount(reach - away2.sqrt())
        raise SceneError(
            f"circle {circle.id!r}: lies across segment {segment.id!r}, by {overlap} at time 0; move it, or reduce r"
        )
    return part if sign == 0 else None


def _check_beside(a: Segment, b: Segment) -> None:
    """Refuses two segments on one line that have more than a point in common."""
    ux, uy = a.x1 - a.x0, a.y1 - a.y0
    places: list[Quantity] = []
    for x, y in ((b.x0, b.y0), (b.x1, b.y1)):
        dx, dy = x - a.x0, y - a.y0
        if (ux * dy - uy * dx).sign() != 0:
            return
        places.append(dx * ux + dy * uy)
    low, high = max(min(places), ZERO), min(max(places), ux * ux + uy * uy)
    if (high - low).sign() > 0:
        raise SceneError(f"segment {b.id!r}: lies on segment {a.id!r}; make them one")


# -- Which faces and ends are of which thing.


class ThingParts(NamedTuple):
    """What a thing of several parts is made of: its faces and its ends, by index in `Scene.surfaces`."""

    faces: tuple[int, ...]
    ends: tuple[int, ...]


@lru_cache(maxsize=64)
def parts_of(scene: Scene) -> Mapping[int, ThingParts]:
    """The parts of every thing that has several, by its place in `Scene.ids`.

    >>> from truebreak.scenarios import Scene
    >>> parts_of(Scene([Circle(0, 5)], [Wall(0, -9, 1, -9)], segments=[Segment(-1, 0, 1, 0)]))
    {2: ThingParts(faces=(1, 2), ends=(1, 2))}
    """
    whole, before = scene.surfaces, len(scene.circles) + len(scene.walls)
    ends = {(whole.circles[k].x, whole.circles[k].y): k for k in whole.ends}
    return {
        before + k: ThingParts(
            (whole.faces.start + 2 * k, whole.faces.start + 2 * k + 1),
            (ends[segment.x0, segment.y0], ends[segment.x1, segment.y1]),
        )
        for k, segment in enumerate(scene.segments)
    }
