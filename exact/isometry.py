"""Isometries of the plane that map some data of a scene to other data of it, exactly."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import TypeAlias

from ..scenarios.numbers.quantity import ZERO
from ..scenarios.scene import Scene
from .numbers.ball import Field, FieldNumber, LeavesField, field_sign
from .replay.contact import AtArc, AtWall, Entry, Link, Pair, Sides, can_push, is_arc, is_flat, is_pair

Vector: TypeAlias = tuple[FieldNumber, FieldNumber]
Matrix: TypeAlias = tuple[FieldNumber, FieldNumber, FieldNumber, FieldNumber]


class SceneData:
    """The data of a scene in its field, and tables that find a thing by its data.

    Raises:
        LeavesField: if the scene's numbers are nested too deeply for a field, or a segment or polygon moves, of which
            no isometry is looked for.
    """

    def __init__(self, scene: Scene) -> None:
        if scene.moving_ends:
            raise LeavesField
        constant = Field().constant
        self.n = len(scene.circles)
        self.places: list[Vector] = [(constant(c.x), constant(c.y)) for c in scene.circles]
        self.speeds: list[Vector] = [(constant(c.vx), constant(c.vy)) for c in scene.circles]
        self.kinds = [(constant(c.r), constant(c.inverse_mass)) for c in scene.circles]
        self.walls: list[tuple[Vector, Vector]] = [
            ((constant(w.x0), constant(w.y0)), (constant(w.normal[0]), constant(w.normal[1]))) for w in scene.walls
        ]
        self.paces: list[FieldNumber] = [
            constant(w.normal[0] * w.vx + w.normal[1] * w.vy) if w.moves else constant(ZERO) for w in scene.walls
        ]
        self._sides = Sides(scene)
        g = scene.gravity
        self.gravity: Vector | None = None if g is None else (constant(g[0]), constant(g[1]))
        self.pockets = [((constant(p.x), constant(p.y)), constant(p.r)) for p in scene.pockets]
        self.circle_of = {(*self.places[i], *self.speeds[i], *self.kinds[i]): i for i in range(self.n)}
        self.ends = [(constant(w.x1), constant(w.y1)) if k in scene.faces else None for k, w in enumerate(scene.walls)]
        self.wall_of = {
            wall_key(*wall, end, pace): k
            for k, (wall, end, pace) in enumerate(zip(self.walls, self.ends, self.paces, strict=True))
        }
        self.pocket_of = {(*place, r): k for k, (place, r) in enumerate(self.pockets)}
        self.arcs: list[tuple[Vector, FieldNumber, Vector, FieldNumber]] = [
            ((constant(s.x), constant(s.y)), constant(s.r), (constant(s.nx), constant(s.ny)), constant(s.h))
            for s in scene.arc_sides
        ]
        self.arc_of = {arc: k for k, arc in enumerate(self.arcs)}
        self.alone = len(self.wall_of) == len(self.walls) and len(self.pocket_of) == len(self.pockets)

    def kind_of(self, link: Link) -> tuple[object, ...]:
        """What of a contact an isometry leaves as it is."""
        if is_pair(link):
            return Pair, self.kinds[link.a], self.kinds[link.b]
        if is_arc(link):
            return AtArc, self.kinds[link.circle], self.arcs[link.arc][1]
        return type(link), self.kinds[link.circle], self.pockets[link.pocket][1] if not can_push(link) else None

    def vectors(self, link: Link) -> list[Vector]:
        """What of a contact an isometry turns: the velocities of its circles, and the way from the first on."""
        first = self.speeds[link[0]]
        if is_flat(link):
            return [first, self.foot(*link[:2])]
        if is_arc(link):
            return [first, minus(self.arcs[link.arc][0], self.places[link.circle])]
        if not can_push(link):
            return [first, minus(self.pockets[link.pocket][0], self.places[link.circle])]
        return [first, minus(self.places[link.b], self.places[link.a]), self.speeds[link.b]]

    def one_of(self, link: Link) -> Link:
        """The contact with the wall that stands for all on one line, or the pocket for all at one place."""
        if self.alone or is_pair(link) or is_arc(link):
            return link
        if is_flat(link):
            k = link.wall
            return AtWall(link.circle, self.wall_of[wall_key(*self.walls[k], self.ends[k], self.paces[k])])
        place, r = self.pockets[link.pocket]
        return Entry(link.circle, self.pocket_of[*place, r])

    def line_of(self, link: AtWall) -> tuple[object, ...]:
        """The line of a wall or a face, how it moves, and on which side of it the circle is: that tells its gap."""
        point, normal = self.walls[link.wall]
        points = field_sign(normal[0]) or field_sign(normal[1])
        return *line_key(point, normal, self.paces[link.wall]), (points > 0) is not self._sides.negative(*link[:2])

    def foot(self, i: int, wall: int) -> Vector:
        """The vector from a wall to a circle's centre, at right angles to the wall; never zero."""
        (x0, y0), (nx, ny) = self.walls[wall]
        x, y = self.places[i]
        scale = (nx * (x - x0) + ny * (y - y0)) / (nx * nx + ny * ny)
        return scale * nx, scale * ny


@lru_cache(maxsize=8)
def scene_data(scene: Scene) -> SceneData:
    """The data of a scene, read once.

    Raises:
        LeavesField: as `SceneData`.
    """
    return SceneData(scene)


def line_key(point: Vector, normal: Vector, pace: FieldNumber) -> tuple[FieldNumber | int, ...]:
    """A line's normal form: n.p = c + n.u t with the first component of n that is not zero made 1; `pace` is n.u."""
    nx, ny = normal
    offset = nx * point[0] + ny * point[1]
    if field_sign(nx) != 0:
        return 1, ny / nx, offset / nx, pace / nx
    return 0, 1, offset / ny, pace / ny


def wall_key(point: Vector, normal: Vector, end: Vector | None, pace: FieldNumber) -> tuple[object, ...]:
    """What tells walls apart: of one without ends its line and how that moves, of a face its two ends and its side."""
    return line_key(point, normal, pace) if end is None else (frozenset((point, end)), normal)


class Isometry:
    """(x, y) becomes (a x + b y + p, c x + d y + q), orthogonal linear part; knows what it maps to what.

    Attributes:
        matrix: the linear part (a, b, c, d).
        shift: (p, q).
        matched: for blocks of a past, by number: whether the block's own past is mapped to its image's.
    """

    def __init__(self, data: SceneData, matrix: Matrix, shift: Vector) -> None:
        self._data = data
        self.matrix = matrix
        self.shift = shift
        self.matched: dict[int, bool] = {}
        self._keeps_gravity = data.gravity is None or turned(matrix, data.gravity) == data.gravity
        self._circles: dict[int, int | None] = {}
        self._walls: dict[int, int | None] = {}

    @property
    def key(self) -> tuple[FieldNumber, ...]:
        """Equal for equal isometries of one scene."""
        return (*self.matrix, *self.shift)

    def turn(self, v: Vector) -> Vector:
        """The image of a direction."""
        return turned(self.matrix, v)

    def move(self, point: Vector) -> Vector:
        """The image of a point."""
        x, y = self.turn(point)
        return x + self.shift[0], y + self.shift[1]

    def circle(self, i: int) -> int | None:
        """The circle whose data at time 0 are the image of circle i's; None if there is none.

        One that turns gravity takes no fall to a fall, and so no circle to any."""
        if i not in self._circles and not self._keeps_gravity:
            self._circles[i] = None
        elif i not in self._circles:
            data = self._data
            key = (*self.move(data.places[i]), *self.turn(data.speeds[i]), *data.kinds[i])
            self._circles[i] = data.circle_of.get(key)
        return self._circles[i]

    def wall(self, k: int) -> int | None:
        """The wall on the image of wall k's line, which stands for all that are on it."""
        if k not in self._walls:
            (point, normal), end = self._data.walls[k], self._data.ends[k]
            pace = self._data.paces[k]  # n.u, which turns with both
            key = wall_key(self.move(point), self.turn(normal), None if end is None else self.move(end), pace)
            self._walls[k] = self._data.wall_of.get(key)
        return self._walls[k]

    def arc(self, k: int) -> int | None:
        """The side of an arc on the image of side k."""
        place, r, chord, h = self._data.arcs[k]
        return self._data.arc_of.get((self.move(place), r, self.turn(chord), h))

    def pocket(self, k: int) -> int | None:
        """The pocket at the image of pocket k."""
        place, r = self._data.pockets[k]
        return self._data.pocket_of.get((*self.move(place), r))

    def link(self, link: Link) -> Link | None:
        """The image of a contact, or of an entry, as `SceneData.one_of` names it; None if there is none."""
        a = self.circle(link[0])
        if a is None:
            return None
        if not can_push(link):
            k = self.pocket(link.pocket)
            return None if k is None else Entry(a, k)
        if is_arc(link):
            k = self.arc(link.arc)
            return None if k is None else AtArc(a, k)
        b = self.wall(link.wall) if is_flat(link) else self.circle(link.b)
        if b is None:
            return None
        return AtWall(a, b) if is_flat(link) else Pair(min(a, b), max(a, b))


def from_vectors(sources: Sequence[Vector], images: Sequence[Vector]) -> Iterator[Matrix]:
    """The orthogonal linear maps, two at most, that take each vector to its image: the rotation, then the
    mirror, where both do; none where all are zero.

    >>> from flint import fmpq
    >>> one, zero = fmpq(1), fmpq(0)
    >>> [tuple(map(int, m)) for m in from_vectors([(one, zero), (one, one)], [(zero, one), (one, one)])]
    [(0, 1, 1, 0)]
    """
    for source, image in zip(sources, images, strict=True):
        (ux, uy), (wx, wy) = source, image
        square = ux * ux + uy * uy
        if field_sign(square - (wx * wx + wy * wy)) != 0:
            return
        if field_sign(square) != 0:
            break
    else:
        return
    along, across = (ux * wx + uy * wy) / square, (ux * wy - uy * wx) / square
    mirrored, skew = (ux * wx - uy * wy) / square, (ux * wy + uy * wx) / square
    for matrix in ((along, -across, across, along), (mirrored, skew, skew, -mirrored)):
        if all(turned(matrix, u) == w for u, w in zip(sources, images, strict=True)):
            yield matrix


def turned(matrix: Matrix, v: Vector) -> Vector:
    """A vector's image under a linear map."""
    a, b, c, d = matrix
    return a * v[0] + b * v[1], c * v[0] + d * v[1]


def minus(a: Vector, b: Vector) -> Vector:
    """a - b."""
    return a[0] - b[0], a[1] - b[1]
