"""Things of several parts, as segments are: to which face or end a circle is nearest, at places that a run has."""

from __future__ import annotations

from typing import Any, Generic, NamedTuple

from ...scenarios.scene import Scene
from ...scenarios.surfaces import parts_of
from ..laws.formulas import face_along
from ..numbers.system import Arithmetic, N
from .contact import AtWall, Pair, Touch
from .state import Flights

# -- What is met of a thing is told by the run's own places, whatever the gap there: no engine in finite precision has
# gap zero at a contact. Beside the place where a face becomes an end, the two have the same gap and the same normal but
# for what is of second order in how far the foot of the centre is from it, so that either tells the same contact.

SAME_GAP = 2.0**-40
"""A share of the coordinates: gaps that differ by less are not told apart, and what is approached is met."""


def _double(value: Any) -> float:
    """The double nearest to a number, or to the middle of an enclosure."""
    return float(value)


def _certainly_above(value: Any, other: Any) -> bool:
    """Whether a number is above another; of enclosures, whether all of it is."""
    return bool(value > other)


class NearestPart(NamedTuple, Generic[N]):
    """What a circle is nearest to of a thing.

    Attributes:
        link: the contact, by index in `Scene.surfaces`.
        nx, ny: unit vector from the part to the circle's centre; (1, 0) where the centre lies on an end's.
        gap: between the surfaces; negative where they overlap.
    """

    link: Touch
    nx: N
    ny: N
    gap: N


class PartsNear(Generic[N]):
    """The faces and ends of a scene's things, in one number system.

    Args:
        scene: the scene.
        numbers: the system.
        flights: where the things are, of `Scene.surfaces`; by default where the scene says.

    >>> from truebreak.floating.double import DOUBLES
    >>> from truebreak.scenarios import Circle, Segment
    >>> near = PartsNear(Scene([Circle(0, 9)], segments=[Segment(0, 0, 4, 0, r="1/2")]), DOUBLES)
    >>> below = near.part(0, 1, 1.0, -2.0, 0.0, 1.0)
    >>> below.link.wall, below.ny, below.gap
    (1, -1.0, 0.5)
    >>> near.part(0, 1, 7.0, 0.0, -1.0, 0.0).link
    Pair(a=0, b=2)
    """

    def __init__(self, scene: Scene, numbers: Arithmetic[N], flights: Flights[N] | None = None) -> None:
        self._flights = flights or Flights(scene.surfaces, numbers)
        self._root = numbers.root
        self.things = parts_of(scene)
        places = {scene.ids[place]: place for place in self.things}
        self._named = {end: places[str(scene.surfaces.circles[end].id)] for end in scene.surfaces.ends}

    def part(self, circle: int, thing: int, x: N, y: N, vx: N, vy: N) -> NearestPart[N]:
        """The part of a thing that a circle at (x, y), with velocity (vx, vy) before it is pushed, is nearest to.

        Of two sides of a thin thing it is the one that the circle approaches, where rounding or a time step has carried
        the centre to the other.

        Args:
            thing: by place in `Scene.ids`.
        """
        parts, r, zero = self.things[thing], self._flights.bodies[circle].r, self._flights.zero
        found: list[tuple[float, bool, float, NearestPart[N]]] = []  # |gap|, approached, how thick, what
        size = abs(_double(x)) + abs(_double(y))
        for wall in parts.faces:
            line = self._flights.line(circle, wall)
            along = face_along(x, y, line.x0, line.y0, line.nx, line.ny)
            if not (_certainly_above(along, zero) and _certainly_above(line.nn - along, zero)):
                continue
            nx, ny = line.nx / line.length, line.ny / line.length
            gap = nx * (x - line.x0) + ny * (y - line.y0) - r
            size = max(size, abs(_double(line.x0)) + abs(_double(line.y0)))
            towards = _double(nx * vx + ny * vy) < 0.0
            found.append((abs(_double(gap)), towards, _double(r), NearestPart(AtWall(circle, wall), nx, ny, gap)))
        for end in parts.ends:
            body = self._flights.bodies[end]
            dx, dy, reach = x - body.flight.x, y - body.flight.y, body.r + r
            square = dx * dx + dy * dy
            span = self._root(square) if _double(square) > 0.0 else zero
            nx, ny = (dx / span, dy / span) if _double(span) > 0.0 else (self._flights.one, zero)
            size = max(size, abs(_double(body.flight.x)) + abs(_double(body.flight.y)))
            towards = _double(nx * vx + ny * vy) < 0.0
            gap = span - reach
            found.append((abs(_double(gap)), towards, _double(reach), NearestPart(Pair(circle, end), nx, ny, gap)))
        away, approached, thick, nearest = min(found, key=lambda row: row[0])
        if approached:
            return nearest
        for other, towards, far, part in sorted(found, key=lambda row: row[0]):
            behind = _double(part.nx * nearest.nx + part.ny * nearest.ny) < 0.0
            if towards and behind and part.link.flat and other <= away + max(thick, far) + SAME_GAP * size:
                return part
        return nearest

    def name_of(self, circle: int, thing: int, x: N, y: N, vx: N, vy: N) -> int:
        """The thing by which what a circle is nearest to of a thing is named: an end that things share has one name.

        >>> from truebreak.floating.double import DOUBLES
        >>> from truebreak.scenarios import Circle, Segment
        >>> scene = Scene([Circle(0, 9)], segments=[Segment(-4, 0, 0, 0, id="a"), Segment(0, 0, 4, 0, id="b")])
        >>> near = PartsNear(scene, DOUBLES)
        >>> [near.name_of(0, thing, 0.0, 1.0, 0.0, -1.0) for thing in (1, 2)]
        [1, 1]
        """
        link = self.part(circle, thing, x, y, vx, vy).link
        return thing if link.flat else self._named[link[1]]
