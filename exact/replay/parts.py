"""Things of several parts, segments, polygons and arcs: to which part a circle is nearest, at places of a run."""

from __future__ import annotations

from math import hypot, inf
from typing import Any, Generic, NamedTuple

from ...scenarios.scene import Scene
from ...scenarios.surfaces import parts_of
from ..laws.formulas import face_along
from ..numbers.system import Arithmetic, N
from .contact import AtArc, AtWall, Pair, Touch, is_pair
from .landings import faces_arc
from .state import Flights

# -- What is met of a thing is told by the run's own places, whatever the gap there: no engine in finite precision has
# gap zero at a contact. Beside the place where a face becomes an end, the two have the same gap but for what is of
# second order in how far the foot of the centre is from it, and the same normal but for what is of first order.

SAME_GAP = 2.0**-40
"""A share of the coordinates: gaps that differ by less are not told apart, and what is approached is met."""


def _double(value: Any) -> float:
    """The double nearest to a number, or to the middle of an enclosure."""
    return float(value)


def _certainly_above(value: Any, other: Any) -> bool:
    """Whether a number is above another; of enclosures, whether all of it is."""
    return bool(value > other)


ONE_WAY = 2.0**-9
"""A share of a push: what of it is not along a normal, at most, where one face alone has pushed."""


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


class _PartSeen(NamedTuple, Generic[N]):
    """A part as it is seen from a circle: the size of the gap, whether it is approached, how thick both are."""

    away: float
    approached: bool
    thick: float
    part: NearestPart[N]


class PartsNear(Generic[N]):
    """The faces and ends of a scene's things, and the sides of its arcs, in one number system.

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
        found, size = self._near(circle, thing, x, y, vx, vy)
        first = found[0]
        if first.approached:
            return first.part
        for row in found:
            behind = _double(row.part.nx * first.part.nx + row.part.ny * first.part.ny) < 0.0
            far = first.away + max(first.thick, row.thick) + SAME_GAP * size
            if row.approached and behind and not is_pair(row.part.link) and row.away <= far:
                return row.part
        return first.part

    def pushing(
        self,
        circle: int,
        thing: int,
        x: N,
        y: N,
        vx: N,
        vy: N,
        push: tuple[N, N],
        count: int = 1,
        room: float = 0.0,
        turn: float = SAME_GAP,
        blur: float = 0.0,
    ) -> list[Touch]:
        """The parts of a thing that have pushed a circle at (x, y) by some change of its velocity (vx, vy) before.

        In a concave corner a circle touches two faces at once, and a report says only whom they are of. Beside the
        place where a face becomes an end, rounding leaves open which of the two it is, though their normals differ by
        its root. It is the one along whose normal the push is; of several the one that it is as strong as, by the law;
        where it is along none, all of those that are near.

        Args:
            count: how many contacts with the thing are reported.
            room: by how much more than the nearest one another may be away, as rounding or a time step may make it.
            turn: the same of the direction of a push, as an angle.
            blur: by how much rounding may have changed the push, as a speed; 0 where strengths are not to be looked at.

        >>> from truebreak.floating.double import DOUBLES
        >>> from truebreak.scenarios import Circle, Polygon
        >>> nook = Polygon([(-9, -9), (9, -9), (9, 0), (0, 0), (0, 9), (-9, 9)], id="nook")
        >>> near = PartsNear(Scene([Circle(5, 5)], polygons=[nook]), DOUBLES)
        >>> push = lambda dx, dy: near.pushing(0, 1, 1.0, 1.0, -1.0, -2.0, (dx, dy))
        >>> push(2.0, 0.0), push(0.0, 4.0), len(push(2.0, 4.0))
        ([AtWall(circle=0, wall=2, kind='wall')], [AtWall(circle=0, wall=3, kind='wall')], 2)
        """
        nearest = self.part(circle, thing, x, y, vx, vy)
        found, size = self._near(circle, thing, x, y, vx, vy)
        most = abs(_double(nearest.gap)) + room + SAME_GAP * size
        parts = [nearest, *(row.part for row in found if row.away <= most and row.part.link != nearest.link)]
        if len(parts) == 1:
            return [nearest.link] * count
        dx, dy = map(_double, push)
        strength = hypot(dx, dy)
        ways = [(_double(part.nx) * dx + _double(part.ny) * dy, part) for part in parts]
        off = [abs(_double(p.nx) * dy - _double(p.ny) * dx) / (strength or 1.0) if w > 0.0 else inf for w, p in ways]
        links = [part.link for way, part in ways if way > 0.0]
        if count > 1 and len(links) == 1 and min(off) > ONE_WAY:  # two normals at a right angle or more: it is of both
            links = [part.link for part in parts]
        links = links[:count] if count > 1 or self.things[thing].convex else links  # the nearest ones
        if strength > 0.0 and count == 1 and min(off) <= ONE_WAY:
            turn += blur / strength
            along = [part for part, by in zip(parts, off, strict=True) if by <= min(off) + turn]
            if not blur or len(along) == 1:
                return [along[0].link]  # the nearest
            change = 1.0 + float(self._flights.scene.restitution)
            return [min(along, key=lambda p: abs(strength + change * _double(p.nx * vx + p.ny * vy))).link]
        links = links or [nearest.link]
        return [*links, *(links[0] for _ in range(count - len(links)))]

    def comes_to(self, circle: int, thing: int, x: N, y: N, vx: N, vy: N) -> bool:
        """Whether a straight flight from (x, y) may come to some part of a thing: what doubles leave open, it may.

        >>> from truebreak.floating.double import DOUBLES
        >>> from truebreak.scenarios import Circle, Polygon
        >>> nook = Polygon([(-9, -9), (9, -9), (9, 0), (0, 0), (0, 9), (-9, 9)], id="nook")
        >>> near = PartsNear(Scene([Circle(5, 5)], polygons=[nook]), DOUBLES)
        >>> near.comes_to(0, 1, 5.0, 1.0, -1.0, 1.0), near.comes_to(0, 1, 5.0, 1.0, 1.0, 1.0)
        (True, False)
        """
        parts = self.things[thing]
        part = self.part(circle, thing, x, y, vx, vy)
        if parts.convex:
            return _double(part.nx * vx + part.ny * vy) < 0.0
        r, (fx, fy, ux, uy) = _double(self._flights.bodies[circle].r), map(_double, (x, y, vx, vy))
        speed = hypot(ux, uy)
        for wall in parts.faces:
            line = self._flights.line(circle, wall)
            x0, y0, nx, ny, length = map(_double, (line.x0, line.y0, line.nx, line.ny, line.length))
            size = SAME_GAP * (abs(fx) + abs(fy) + abs(x0) + abs(y0) + r + length)
            height, fall = (nx * (fx - x0) + ny * (fy - y0)) / length, -(nx * ux + ny * uy) / length
            if fall <= 0.0 or height < -size:
                continue
            wait = max(0.0, height - r) / fall
            foot = face_along(fx + wait * ux, fy + wait * uy, x0, y0, nx, ny) / length
            blur = size * (1.0 + speed / fall)
            if -blur <= foot <= length + blur:
                return True
        for end in parts.ends:
            body = self._flights.bodies[end]
            dx, dy, reach = fx - _double(body.flight.x), fy - _double(body.flight.y), r + _double(body.r)
            size = SAME_GAP * (abs(fx) + abs(fy) + hypot(dx, dy) + reach)
            if dx * ux + dy * uy < 0.0 and abs(dx * uy - dy * ux) <= (reach + size) * speed:
                return True
        return speed > 0.0 and any(self._comes_to_side(AtArc(circle, side), fx, fy, ux, uy) for side in parts.sides)

    def _comes_to_side(self, link: AtArc, x: float, y: float, vx: float, vy: float) -> bool:
        """The same for a side of an arc: whether a flight leads to its circle, at a place that may be within it."""
        a, b = link.ends(self._flights)
        r, reach = abs(_double(b.r)), abs(_double(a.r + b.r))
        if link.hollow and not _double(a.r + b.r) < 0.0:
            return False
        dx, dy, speed = x - _double(b.flight.x), y - _double(b.flight.y), hypot(vx, vy)
        size = SAME_GAP * (abs(x) + abs(y) + hypot(dx, dy) + r + _double(a.r))
        ahead, aside = -(dx * vx + dy * vy) / speed, abs(dx * vy - dy * vx) / speed
        if aside > reach + size or (not link.hollow and (hypot(dx, dy) < r - size or ahead < 0.0)):
            return False
        half = max(0.0, (reach - aside) * (reach + aside)) ** 0.5
        way = ahead + (half if link.hollow else -half)
        blur = size * (1.0 + (2.0 * reach / (half or size)) ** 0.5) if half < size else size * (1.0 + reach / half)
        if way < -blur:
            return False
        side = self._flights.scene.arc_sides[link.arc]
        nx, ny, h = map(float, (side.nx, side.ny, side.h))
        within = nx * (dx + way * vx / speed) + ny * (dy + way * vy / speed) - h * reach
        return side.full or within >= -hypot(nx, ny) * 2.0 * blur

    def near(self, circle: int, thing: int, x: N, y: N, vx: N, vy: N, room: float) -> list[NearestPart[N]]:
        """The parts of a thing no farther away than `room`: of a convex one its nearest part alone."""
        nearest = self.part(circle, thing, x, y, vx, vy)
        if self.things[thing].convex:
            return [nearest] if _double(nearest.gap) <= room else []
        found, _ = self._near(circle, thing, x, y, vx, vy)
        others = [row.part for row in found if row.away <= room and row.part.link != nearest.link]
        return [nearest, *others] if _double(nearest.gap) <= room else others

    def _near(self, circle: int, thing: int, x: N, y: N, vx: N, vy: N) -> tuple[list[_PartSeen[N]], float]:
        """The parts that a circle is over or beside, nearest first; and the size of the coordinates."""
        parts, r, zero = self.things[thing], self._flights.bodies[circle].r, self._flights.zero
        found: list[_PartSeen[N]] = []
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
            part = NearestPart[N](AtWall(circle, wall), nx, ny, gap)
            found.append(_PartSeen(abs(_double(gap)), towards, _double(r), part))
        for end in parts.ends:
            body = self._flights.bodies[end]
            dx, dy, reach = x - body.flight.x, y - body.flight.y, body.r + r
            square = dx * dx + dy * dy
            span = self._root(square) if _double(square) > 0.0 else zero
            nx, ny = (dx / span, dy / span) if _double(span) > 0.0 else (self._flights.one, zero)
            size = max(size, abs(_double(body.flight.x)) + abs(_double(body.flight.y)))
            towards = _double(nx * vx + ny * vy) < 0.0
            part = NearestPart[N](Pair(circle, end), nx, ny, span - reach)
            found.append(_PartSeen(abs(_double(part.gap)), towards, _double(reach), part))
        for side in parts.sides:
            seen = self._side(AtArc(circle, side), x, y, vx, vy)
            if seen is not None:
                body = self._flights.arcs[side]
                size = max(size, abs(_double(body.flight.x)) + abs(_double(body.flight.y)) + abs(_double(body.r)))
                found.append(seen)
        return sorted(found, key=lambda row: row.away), size

    def _side(self, link: AtArc, x: N, y: N, vx: N, vy: N) -> _PartSeen[N] | None:
        """A side of an arc, where a circle is within its range, and has room in it."""
        a, b = link.ends(self._flights)
        side, zero = self._flights.scene.arc_sides[link.arc], self._flights.zero
        dx, dy, reach = x - b.flight.x, y - b.flight.y, a.r + b.r
        square = dx * dx + dy * dy
        far = self._root(square) if _double(square) > 0.0 else zero
        if (link.hollow and not _double(reach) < 0.0) or not (_double(far) > 0.0 or side.full):
            return None
        if not _certainly_above(faces_arc(self._flights, link, -dx, -dy), zero):
            return None
        nx, ny = (dx / far, dy / far) if _double(far) > 0.0 else (self._flights.one, zero)
        gap = far - reach
        if link.hollow:  # towards the middle; r is below zero there
            nx, ny, gap = -nx, -ny, -reach - far
        towards = _double(nx * vx + ny * vy) < 0.0
        return _PartSeen(abs(_double(gap)), towards, _double(a.r), NearestPart[N](link, nx, ny, gap))

    def name_of(self, circle: int, thing: int, x: N, y: N, vx: N, vy: N) -> int:
        """The thing by which what a circle is nearest to of a thing is named: an end that things share has one name.

        Where that may as well be a face, to rounding, it is the thing itself.

        >>> from truebreak.floating.double import DOUBLES
        >>> from truebreak.scenarios import Circle, Segment
        >>> scene = Scene([Circle(0, 9)], segments=[Segment(-4, 0, 0, 0, id="a"), Segment(0, 0, 4, 0, id="b")])
        >>> near = PartsNear(scene, DOUBLES)
        >>> [near.name_of(0, thing, 0.0, 1.0, 0.0, -1.0) for thing in (1, 2)]
        [1, 1]
        """
        found, size = self._near(circle, thing, x, y, vx, vy)
        links = [row.part.link for row in found if row.away <= found[0].away + SAME_GAP * size]
        return thing if not all(map(is_pair, links)) else self._named[links[0][1]]
