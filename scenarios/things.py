"""Circles, walls, segments, polygons, arcs and pockets: frozen, exact, checked each by itself."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import inf, nextafter
from typing import Any, Literal, NamedTuple, TypeAlias, cast

from .errors import SceneError, cut
from .lazy import frozen, kept
from .numbers.parsing import is_sympy
from .numbers.quantity import ZERO, Quantity, QuantityLike
from .settings import checked_truth

FIXED = "oo"
"""The mass of a circle that never moves."""

Point: TypeAlias = tuple[Quantity, Quantity]

INFINITE = (FIXED, "inf", "+inf", "Infinity")
"""How it may be written: as SymPy, TOML and Python's JSON write it."""

MAX_ID = 64


def _exact(kind: str, name: str | None, key: str, value: QuantityLike) -> Quantity:
    """The value of one key as a Quantity; an error names the thing, the key, the value and the reason."""
    try:
        return Quantity.of(value)
    except SceneError as error:
        raise SceneError(f"{_label(kind, name)}: {key} = {error}") from None


def _label(kind: str, name: str | None) -> str:
    return f"{kind} {name!r}" if name is not None else kind


def _checked_id(kind: str, name: Any) -> None:
    if name is None:
        return
    if not isinstance(name, str) or not name or len(name) > MAX_ID or not name.isprintable():
        raise SceneError(f"{kind}: id = {str(name)[:MAX_ID]!r} is not usable; write 1 to {MAX_ID} printable characters")


@frozen
class Circle:
    """A hard disc: centre (x, y), radius r, velocity (vx, vy), mass m.

    Every number is exact (see `Quantity.of`). `m = "oo"` fixes the circle in place (an obstacle): the bounce is
    the limit of infinite mass; `m = "inf"` and `fixed=True` say the same. `point=True` allows the radius 0 of a
    point ball. A missing id is filled in by the scene (`c1`, `c2`, ...).

    Raises:
        SceneError: for a radius or mass that is not positive, or a moving obstacle.

    >>> Circle(x=0, y="sqrt(2)", r=1, vx="1/2", vy=0).m
    Quantity('1')
    """

    x: Quantity
    y: Quantity
    r: Quantity
    vx: Quantity
    vy: Quantity
    m: Quantity | Literal["oo"]
    id: str | None
    point: bool

    drift = (ZERO, ZERO)
    """The velocity of an end of a segment that moves: see `MovingEnd`."""

    def __init__(
        self,
        x: QuantityLike,
        y: QuantityLike,
        r: QuantityLike = 1,
        vx: QuantityLike = 0,
        vy: QuantityLike = 0,
        m: QuantityLike = 1,
        id: str | None = None,
        point: bool = False,
        fixed: bool | None = None,
    ) -> None:
        _checked_id("circle", id)
        put = object.__setattr__
        put(self, "id", id)
        if fixed is not None:
            m = _fixed_mass(id, fixed, m)
        put(self, "point", checked_truth(f"{_label('circle', id)}: point", point))
        for key, value in (("x", x), ("y", y), ("r", r), ("vx", vx), ("vy", vy)):
            put(self, key, _exact("circle", id, key, value))
        put(self, "m", FIXED if _is_infinite(m) else _exact("circle", id, "m", m))
        self._validate()

    def _validate(self) -> None:
        label = _label("circle", self.id)
        sign = self.r.sign()
        if sign < 0 or (sign == 0 and not self.point):
            hint = "; a point ball says point = true" if sign == 0 else ""
            raise SceneError(f"{label}: r = {self.r.brief()}: a radius must be positive{hint}")
        if sign > 0 and self.point:
            raise SceneError(f"{label}: r = {self.r.brief()}: a point ball has r = 0; leave out point, or set r = 0")
        if isinstance(self.m, Quantity) and self.m.sign() <= 0:
            raise SceneError(f'{label}: m = {self.m.brief()}: a mass must be positive (or "oo" for a fixed circle)')
        if self.fixed and (self.vx.sign() or self.vy.sign()):
            raise SceneError(
                f"{label}: m = oo with velocity ({self.vx.brief()}, {self.vy.brief()}): a fixed circle never moves; "
                "set vx = vy = 0, or give a finite mass"
            )

    @property
    def fixed(self) -> bool:
        """Whether the circle is an obstacle of infinite mass."""
        return not isinstance(self.m, Quantity)

    @property
    def inverse_mass(self) -> Quantity:
        """1/m; zero for a fixed circle."""
        return 1 / self.m if isinstance(self.m, Quantity) else ZERO

    @property
    def at_rest(self) -> bool:
        """Whether the velocity is exactly zero."""
        return self.vx.sign() == 0 and self.vy.sign() == 0


@frozen
class MovingEnd(Circle):
    """An end of a segment, or a corner of a polygon, that moves with it, whatever meets it; none is in a scene's file.

    It is where it is at time 0, and at rest, as fixed circles are; its velocity is `drift`.

    >>> end = MovingEnd((ZERO, ZERO), Quantity.of(1), (ZERO, Quantity.of(2)), "shelf")
    >>> end.fixed, end.drift[1].text()
    (True, '2')
    """

    drift: Point

    def __init__(self, place: Point, r: Quantity, drift: Point, id: str | None) -> None:
        super().__init__(*place, r=r, m=FIXED, id=id, point=r.sign() == 0)
        object.__setattr__(self, "drift", drift)


def _fixed_mass(id: str | None, fixed: Any, m: QuantityLike) -> QuantityLike:
    """The mass of a circle that is said to be fixed, or not to be.

    Raises:
        SceneError: if its mass, 1 by default, says otherwise.
    """
    label = _label("circle", id)
    if checked_truth(f"{label}: fixed", fixed) == _is_infinite(m):
        return m
    if fixed:
        mass = _exact("circle", id, "m", m)
        if mass == 1:
            return FIXED
        told = f"{label}: fixed = true with m = {mass.brief()}"
        raise SceneError(f"{told}: a fixed circle has no finite mass; keep one of them")
    raise SceneError(f"{label}: fixed = false with m = {cut(m)}: an infinite mass fixes it; keep one of them")


def _is_infinite(m: Any) -> bool:
    if isinstance(m, str):
        return m.strip() in INFINITE
    if isinstance(m, float):
        return m == inf
    return is_sympy(m) and str(m) == FIXED


@frozen
class Wall:
    """An infinitely long straight wall through (x0, y0) and (x1, y1), hard on both sides.

    It moves with the velocity (vx, vy), for ever; the points are those of time 0.

    Raises:
        SceneError: if the two points are one.

    >>> Wall(0, 0, 1, 0, id="floor").id, Wall(0, 9, 1, 9, vy=-1).moves
    ('floor', True)
    """

    x0: Quantity
    y0: Quantity
    x1: Quantity
    y1: Quantity
    id: str | None
    vx: Quantity
    vy: Quantity

    is_face = False
    """Whether it is one side of a segment, which ends: see `scenarios.surfaces`."""

    kind = "wall"
    """Which of `WALL_KINDS` it is: each says from where it is seen, and what of what comes to it is met."""

    def __init__(
        self,
        x0: QuantityLike,
        y0: QuantityLike,
        x1: QuantityLike,
        y1: QuantityLike,
        id: str | None = None,
        vx: QuantityLike = 0,
        vy: QuantityLike = 0,
    ) -> None:
        _checked_id("wall", id)
        put = object.__setattr__
        put(self, "id", id)
        for key, value in (("x0", x0), ("y0", y0), ("x1", x1), ("y1", y1), ("vx", vx), ("vy", vy)):
            put(self, key, _exact("wall", id, key, value))
        if self.x0 == self.x1 and self.y0 == self.y1:
            raise SceneError(
                f"{_label('wall', id)}: both points are ({self.x0.brief()}, {self.y0.brief()}); "
                "a wall needs two distinct points"
            )

    @property
    def normal(self) -> tuple[Quantity, Quantity]:
        """A vector at right angles to the wall, as long as its two points are apart."""
        return self.y0 - self.y1, self.x1 - self.x0

    @property
    def moves(self) -> bool:
        """Whether it has a velocity; one along itself counts, as it is given though it changes nothing."""
        return self.vx.sign() != 0 or self.vy.sign() != 0

    def along(self, x: Quantity, y: Quantity) -> tuple[Quantity, Quantity]:
        """The part along the wall of a vector, such as gravity: what is left where the wall bears the rest.

        >>> [part.text() for part in Wall(0, 0, 4, -3, id="slope").along(*map(Quantity.of, (0, -10)))]
        ['24/5', '-18/5']
        """
        nx, ny = self.normal
        share = (nx * x + ny * y) / (nx * nx + ny * ny)
        return x - nx * share, y - ny * share

    def height(self, x: Quantity, y: Quantity) -> Quantity:
        """Signed distance of a point from the wall, times the length of `normal`."""
        nx, ny = self.normal
        return nx * (x - self.x0) + ny * (y - self.y0)

    def side(self, x: Quantity, y: Quantity) -> int:
        """1 where a circle that starts at (x, y) meets the side to which `normal` points, -1 where the other."""
        return self.height(x, y).sign()

    def is_met(self, gap: int) -> bool:
        """Whether a circle that comes nearer is met, by the sign of its gap as its flight begins.

        Above zero it always is. At or below it, at a plain wall, is nothing but by rounding, which is met at once.
        """
        return True


class Squeeze(NamedTuple):
    """A circle between two parallel walls that close: by place in the scene, and when they leave no room for it."""

    circle: int
    walls: tuple[int, int]
    time: Quantity


@frozen
class Segment:
    """A straight segment from (x0, y0) to (x1, y1), hard on both sides, `r` thick to each side, with round ends.

    It moves with the velocity (vx, vy), for ever; the points are those of time 0.

    Raises:
        SceneError: if the two points are one, or r is negative.

    >>> Segment(0, 0, 1, 0, id="shelf").r, Segment(0, 0, 1, 0, vy=2).moves
    (Quantity('0'), True)
    """

    x0: Quantity
    y0: Quantity
    x1: Quantity
    y1: Quantity
    id: str | None
    r: Quantity
    vx: Quantity
    vy: Quantity

    def __init__(
        self,
        x0: QuantityLike,
        y0: QuantityLike,
        x1: QuantityLike,
        y1: QuantityLike,
        id: str | None = None,
        r: QuantityLike = 0,
        vx: QuantityLike = 0,
        vy: QuantityLike = 0,
    ) -> None:
        _checked_id("segment", id)
        put = object.__setattr__
        put(self, "id", id)
        for key, value in (("x0", x0), ("y0", y0), ("x1", x1), ("y1", y1), ("r", r), ("vx", vx), ("vy", vy)):
            put(self, key, _exact("segment", id, key, value))
        if self.x0 == self.x1 and self.y0 == self.y1:
            raise SceneError(
                f"{_label('segment', id)}: both points are ({self.x0.brief()}, {self.y0.brief()}); "
                "a segment needs two distinct points, or write a fixed circle"
            )
        if self.r.sign() < 0:
            raise SceneError(f"{_label('segment', id)}: r = {self.r.brief()}: half a thickness is 0 or more")

    @property
    def moves(self) -> bool:
        """Whether it has a velocity."""
        return self.vx.sign() != 0 or self.vy.sign() != 0


MAX_POINTS = 1_000
"""Of one polygon: each of its sides is compared with every other."""


@frozen
class Polygon:
    """A solid polygon, rounded by `r`: all that is within r of what its sides enclose; nothing is inside of it.

    It moves with the velocity (vx, vy), for ever, and does not turn; the points are those of time 0.

    Attributes:
        points: its corners in order, either way round; it need not be convex.

    Raises:
        SceneError: for fewer than three points, sides that meet elsewhere than at a corner, or a negative r.

    >>> Polygon([(0, 0), (3, 0), (0, 4)], id="wedge").corners()
    ((Quantity('0'), Quantity('0')), (Quantity('0'), Quantity('4')), (Quantity('3'), Quantity('0')))
    """

    points: tuple[Point, ...]
    id: str | None
    r: Quantity
    vx: Quantity
    vy: Quantity

    def __init__(
        self,
        points: Iterable[tuple[QuantityLike, QuantityLike]],
        id: str | None = None,
        r: QuantityLike = 0,
        vx: QuantityLike = 0,
        vy: QuantityLike = 0,
    ) -> None:
        _checked_id("polygon", id)
        put = object.__setattr__
        put(self, "id", id)
        put(self, "points", tuple(_point(id, k, point) for k, point in enumerate(points, start=1)))
        for key, value in (("r", r), ("vx", vx), ("vy", vy)):
            put(self, key, _exact("polygon", id, key, value))
        label = _label("polygon", id)
        if self.r.sign() < 0:
            raise SceneError(f"{label}: r = {self.r.brief()}: the radius of its corners is 0 or more")
        if len(self.points) < 3:
            told = f"{len(self.points)} point{'s' * (len(self.points) != 1)}"
            raise SceneError(f"{label}: has {told}; a polygon needs three or more, or write a segment")
        if len(self.points) > MAX_POINTS:
            raise SceneError(f"{label}: has {len(self.points)} points; at most {MAX_POINTS}: write it as several")
        _check_simple(label, self.points)

    @property
    def moves(self) -> bool:
        """Whether it has a velocity."""
        return self.vx.sign() != 0 or self.vy.sign() != 0

    def sides(self) -> tuple[tuple[Point, Point], ...]:
        """Each corner with the next one, in the order of `corners`: what is outside lies to the left."""
        corners = self.corners()
        return tuple(pairwise((*corners, corners[0])))

    def corners(self) -> tuple[Point, ...]:
        """The points, clockwise from the first of them that is a corner; one between two sides on one line is none."""
        return self._corners

    @kept
    def _corners(self) -> tuple[Point, ...]:
        points = self.points
        n = len(points)
        found = [points[k] for k in range(n) if _turn(points[k - 1], points[k], points[(k + 1) % n]).sign() != 0]
        double_area = sum((a[0] * b[1] - a[1] * b[0] for a, b in zip(found, found[1:] + found[:1], strict=True)), ZERO)
        return tuple(found) if double_area.sign() < 0 else (found[0], *reversed(found[1:]))

    @property
    def convex(self) -> bool:
        """Whether no corner turns inward."""
        sides = self.sides()
        return all(_turn(a, b, c).sign() < 0 for (a, b), (_, c) in zip(sides, (*sides[1:], sides[0]), strict=True))

    def around(self, x: Quantity, y: Quantity) -> bool:
        """Whether a point that is on none of the sides is inside: a ray to the right crosses an odd number of them.

        >>> Polygon([(0, 0), (3, 0), (0, 4)]).around(Quantity.of(1), Quantity.of(1))
        True
        """
        crossed = False
        for (x0, y0), (x1, y1) in self.sides():
            if ((y0 - y).sign() > 0) != ((y1 - y).sign() > 0):
                turn = _turn((x0, y0), (x1, y1), (x, y)).sign()
                crossed ^= turn > 0 if (y1 - y0).sign() > 0 else turn < 0
        return crossed


def _point(name: str | None, number: int, point: Any) -> Point:
    """A corner of a polygon."""
    label = f"{_label('polygon', name)}: point {number}"
    pair = cast("Sequence[Any]", point) if isinstance(point, Sequence) and not isinstance(point, str | bytes) else ()
    if len(pair) != 2:
        raise SceneError(f"{label} = {cut(str(cast('object', point)))} is not a pair; write [x, y]")
    found: list[Quantity] = []
    for key, value in zip("xy", pair, strict=True):
        try:
            found.append(Quantity.of(value))
        except SceneError as error:
            raise SceneError(f"{label}: {key} = {error}") from None
    return found[0], found[1]


def _turn(a: Point, b: Point, c: Point) -> Quantity:
    """Positive where c is to the left of the way from a to b."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def crossing(a: tuple[Point, Point], b: tuple[Point, Point]) -> bool:
    """Whether the insides of two straight ways cross in one point.

    >>> one = Quantity.of(1)
    >>> crossing(((-one, -one), (one, one)), ((-one, one), (one, -one)))
    True
    """
    sides = [_turn(*way, point).sign() for way, other in ((a, b), (b, a)) for point in other]
    return sides[0] * sides[1] < 0 and sides[2] * sides[3] < 0


def _on(point: Point, way: tuple[Point, Point]) -> bool:
    """Whether a point lies on a straight way, its ends included."""
    (x0, y0), (x1, y1) = way
    if _turn(*way, point).sign() != 0:
        return False
    ux, uy = x1 - x0, y1 - y0
    along = (point[0] - x0) * ux + (point[1] - y0) * uy
    return along.sign() >= 0 and (ux * ux + uy * uy - along).sign() >= 0


def _check_simple(label: str, points: tuple[Point, ...]) -> None:
    """Refuses sides that meet elsewhere than at the corner between two that follow each other."""
    n = len(points)
    seen: dict[Point, int] = {}
    for k, point in enumerate(points, start=1):
        if point in seen:
            raise SceneError(f"{label}: point {k} is point {seen[point]} again; leave it out, or write two polygons")
        seen[point] = k
    ways = [(points[k], points[(k + 1) % n]) for k in range(n)]
    boxes = [box_of(way) for way in ways]
    for k, way in enumerate(ways):
        for j in range(k + 1, n):
            other = ways[j]
            if not boxes_meet(boxes[k], boxes[j]):
                continue
            if j == k + 1 or (k == 0 and j == n - 1):
                before, after = (way, other) if j == k + 1 else (other, way)
                met = _on(before[0], after) or _on(after[1], before)
            else:
                met = crossing(way, other) or any(_on(p, other) for p in way) or any(_on(p, way) for p in other)
            if met:
                raise SceneError(f"{label}: its sides {k + 1} and {j + 1} meet; order the points so that no two do")


Box: TypeAlias = tuple[float, float, float, float]


def box_of(points: Sequence[Point]) -> Box:
    """Doubles between which all points surely lie: least and greatest x, least and greatest y.

    >>> box_of([(Quantity.of(0), Quantity.of(1)), (Quantity.of(3), Quantity.of(2))])
    (-5e-324, 3.0000000000000004, 0.9999999999999999, 2.0000000000000004)
    """
    try:
        xs, ys = [float(x) for x, _ in points], [float(y) for _, y in points]
    except OverflowError:
        return -inf, inf, -inf, inf
    return nextafter(min(xs), -inf), nextafter(max(xs), inf), nextafter(min(ys), -inf), nextafter(max(ys), inf)


def boxes_meet(a: Box, b: Box) -> bool:
    """Whether two boxes have a point in common."""
    return a[0] <= b[1] and b[0] <= a[1] and a[2] <= b[3] and b[2] <= a[3]


_ONE = Quantity.of(1)


@frozen
class Arc:
    """The part of a circle counter-clockwise from one direction to another, hard on both sides; `full` for all of it.

    Attributes:
        x, y, r: the circle.
        x0, y0, x1, y1: points in whose directions, seen from its centre, the arc begins and ends; they need not lie on
            the circle. Those of a full circle are its centre.
        full: whether it is the whole circle.

    Raises:
        SceneError: for a radius that is not positive, and for directions that are missing, one, or none.

    >>> arc = Arc(0, 0, 5, 3, 4, -1, 0, id="bow")
    >>> [[place.text() for place in point] for point in arc.ends]
    [['3', '4'], ['-5', '0']]
    """

    x: Quantity
    y: Quantity
    r: Quantity
    x0: Quantity
    y0: Quantity
    x1: Quantity
    y1: Quantity
    id: str | None
    full: bool

    def __init__(
        self,
        x: QuantityLike,
        y: QuantityLike,
        r: QuantityLike,
        x0: QuantityLike | None = None,
        y0: QuantityLike | None = None,
        x1: QuantityLike | None = None,
        y1: QuantityLike | None = None,
        id: str | None = None,
        full: bool = False,
    ) -> None:
        _checked_id("arc", id)
        put, label = object.__setattr__, _label("arc", id)
        put(self, "id", id)
        put(self, "full", checked_truth(f"{label}: full", full))
        for key, value in (("x", x), ("y", y), ("r", r)):
            put(self, key, _exact("arc", id, key, value))
        if self.r.sign() <= 0:
            raise SceneError(f"{label}: r = {self.r.brief()}: a radius must be positive")
        points = (("x0", x0), ("y0", y0), ("x1", x1), ("y1", y1))
        missing = [key for key, value in points if value is None]
        if self.full:
            if len(missing) < len(points):
                raise SceneError(f"{label}: full = true has no ends; leave out x0, y0, x1 and y1, or full")
            points = (("x0", self.x), ("y0", self.y), ("x1", self.x), ("y1", self.y))
        elif missing:
            raise SceneError(f"{label}: {missing[0]} is missing; write where it begins and ends, or full = true")
        for key, value in points:
            put(self, key, _exact("arc", id, key, ZERO if value is None else value))
        if self.full:
            return
        for point in ("0", "1"):
            if getattr(self, f"x{point}") == self.x and getattr(self, f"y{point}") == self.y:
                where = f"({self.x.brief()}, {self.y.brief()})"
                raise SceneError(f"{label}: x{point}, y{point} is its centre {where}; write a point in its direction")
        e0, e1 = self.directions
        if e0 == e1:
            raise SceneError(f"{label}: begins and ends in one direction; write full = true for all of the circle")

    @kept
    def directions(self) -> tuple[Point, Point]:
        """Unit vectors from the centre to where it begins and ends; of a full circle both (1, 0)."""
        if self.full:
            return (_ONE, ZERO), (_ONE, ZERO)
        found: list[Point] = []
        for px, py in ((self.x0, self.y0), (self.x1, self.y1)):
            dx, dy = px - self.x, py - self.y
            length = (dx * dx + dy * dy).sqrt()
            found.append((dx / length, dy / length))
        return found[0], found[1]

    @property
    def ends(self) -> tuple[Point, ...]:
        """Where it begins and ends; nothing for a full circle."""
        if self.full:
            return ()
        return tuple((self.x + self.r * ex, self.y + self.r * ey) for ex, ey in self.directions)

    @kept
    def chord(self) -> tuple[Quantity, Quantity, Quantity]:
        """(nx, ny, h): a direction e of length 1 is within the arc where n.e > h; (0, 0, -1) for a full circle."""
        if self.full:
            return ZERO, ZERO, -_ONE
        (ax, ay), (bx, by) = self.directions
        nx, ny = by - ay, ax - bx
        return nx, ny, nx * ax + ny * ay


@frozen
class Pocket:
    """A round pocket: a circle's centre that comes within r of (x, y) has entered it."""

    x: Quantity
    y: Quantity
    r: Quantity
    id: str | None

    def __init__(self, x: QuantityLike, y: QuantityLike, r: QuantityLike, id: str | None = None) -> None:
        _checked_id("pocket", id)
        object.__setattr__(self, "id", id)
        for key, value in (("x", x), ("y", y), ("r", r)):
            object.__setattr__(self, key, _exact("pocket", id, key, value))
        if self.r.sign() <= 0:
            raise SceneError(f"{_label('pocket', id)}: r = {self.r.brief()}: a radius must be positive")
