"""Impulses upon circles in doubles: by the laws, at given places; or inferred from velocities that have changed."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from flint import arb, arb_mat

from ...exact.replay.contact import Sides
from ...exact.replay.parts import NearestPart, PartsNear
from ...floating.double import DOUBLES
from ...floating.knots import DoubleKnot, EndlessBounces
from ...scenarios.lazy import Later, kept
from ...scenarios.surfaces import parts_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ...scenarios.scene import Scene
else:
    np = Later("numpy")

Row: TypeAlias = tuple[float, float, float, float]
"""(x, y, vx, vy) of one circle."""

Indices: TypeAlias = tuple[int, int]
"""Two touching things by their places in `scene.ids`; a wall is last."""

MOST_ROUNDS = 10_000
"""Rounds of impulses at one instant, as in the exact engine."""

SOLVED = 2.0**-44
"""What is left of a system of impulses, as a share of what it began with, once it is solved: some hundred operations in
doubles leave this much."""


TOUCHING = 2.0**-36
"""A share of the coordinates: what is no farther away touches, however little a state at a contact was rounded."""


class Normal(NamedTuple):
    """The line of centres of two things that touch.

    Attributes:
        x, y: of length 1, from the second to the first.
        gap: distance of the two surfaces; negative: an overlap.
    """

    x: float
    y: float
    gap: float


class Impacts:
    """The circles, walls and things of several parts of a scene in doubles, and the laws of impact upon them.

    Args:
        scene: the scene.

    Attributes:
        count: of circles.
        things: what has several parts, by place in `scene.ids`; a contact with one is with what is nearest of it.
    """

    def __init__(self, scene: Scene) -> None:
        self._change = 1.0 + float(scene.restitution)
        self._gravity = (0.0, 0.0) if scene.gravity is None else (float(scene.gravity[0]), float(scene.gravity[1]))
        self.things = tuple(parts_of(scene))
        self._near = PartsNear(scene, DOUBLES) if self.things else None
        self.count = len(scene.circles)
        self._inverse_masses = [float(c.inverse_mass) for c in scene.circles]
        self._radii = [float(c.r) for c in scene.circles]
        self._walls: list[tuple[float, float, float, float]] = []
        for wall in scene.walls:
            nx, ny = (float(n) for n in wall.normal)
            length = math.hypot(nx, ny)
            self._walls.append((float(wall.x0), float(wall.y0), nx / length, ny / length))
        self._paces = [(float(wall.vx), float(wall.vy)) for wall in scene.walls]
        self._sides = [[1.0 if w.height(c.x, c.y).sign() >= 0 else -1.0 for w in scene.walls] for c in scene.circles]

    @kept
    def weights(self) -> NDArray[np.float64]:
        """1/m of each circle."""
        return np.array(self._inverse_masses)

    def normal(self, link: Indices, rows: Sequence[Row], time: float) -> Normal:
        """The line of centres, at given places, and where walls that move are at a time."""
        (i, j), (x, y) = link, rows[link[0]][:2]
        if self._near is not None and j in self._near.things:
            return _normal(self._near.part(i, j, *rows[i]))
        if j >= self.count:
            x0, y0, nx, ny = self._walls[j - self.count]
            side, (ux, uy) = self._sides[i][j - self.count], self._paces[j - self.count]
            height = nx * (x - x0 - ux * time) + ny * (y - y0 - uy * time)
            return Normal(side * nx, side * ny, side * height - self._radii[i])
        dx, dy = x - rows[j][0], y - rows[j][1]
        length = math.hypot(dx, dy)
        if length == 0.0:
            return Normal(1.0, 0.0, -self._radii[i] - self._radii[j])
        return Normal(dx / length, dy / length, length - self._radii[i] - self._radii[j])

    def contacts(self, links: Sequence[Indices], rows: Sequence[Row], time: float) -> list[tuple[Indices, Normal]]:
        """Contacts with their lines of centres; one that is reported twice, in a concave corner, has two of them."""
        found: list[tuple[Indices, Normal]] = []
        for link, times in Counter(links).items():
            if times == 1 or self._near is None or link[1] not in self._near.things:
                found.append((link, self.normal(link, rows, time)))
            else:
                parts = self._near.near(*link, *rows[link[0]], math.inf)
                found += [(link, _normal(part)) for part in parts[:times]]
        return found

    def opening(self, link: Indices, rows: Sequence[Row], normal: Normal) -> float:
        """The speed at which two part; negative: they approach."""
        (i, j) = link
        vx, vy = rows[i][2:]
        if j < self.count:
            vx, vy = vx - rows[j][2], vy - rows[j][3]
        elif j - self.count < len(self._paces):
            vx, vy = vx - self._paces[j - self.count][0], vy - self._paces[j - self.count][1]
        return vx * normal.x + vy * normal.y

    def bounce(self, links: Sequence[Indices], rows: Sequence[Row], time: float) -> list[Row] | None:
        """The rows after impacts at one instant, in rounds, each of which all that approach share.

        None if none of the contacts approaches, or if the rounds have no end.
        """
        after, contacts, still = list(rows), self.contacts(links, rows, time), 0.0
        for done in range(MOST_ROUNDS):
            opening = [self.opening(link, after, normal) for link, normal in contacts]
            closing = [k for k, speed in enumerate(opening) if speed < still]
            if self._change == 1.0:  # what has met stays closed, but for rounding
                still = min(still, SOLVED * min(opening))
            if not closing:
                return after if done else None
            matrix = self.matrix([contacts[k] for k in closing])
            strengths = least(matrix @ matrix.T, np.array([-self._change * opening[k] for k in closing]))
            if not strengths.any():
                return None
            after = self._pushed(after, matrix, strengths)
        return None

    def inferred(
        self, rows: Sequence[Row], before: Sequence[Row], room: float, time: float, way: float | None = None
    ) -> tuple[list[Indices], float]:
        """The contacts that explain how velocities have changed, and the part of the change that they leave.

        Of all pairs no farther apart than `room` of which one has changed, those whose impulses, none of them
        pulling, come nearest to the change; of those alone that touch, if they explain all of it.

        Args:
            rows: the circles now.
            before: where they would be without the change.
            room: the largest gap of a contact.
            time: now.
            way: how long ago two may have met; their line of centres is then taken as it was at the meeting of their
                flights before, if that explains more.
        """
        change = np.array([[r[2] - v[2], r[3] - v[3]] for r, v in zip(rows, before, strict=True)])
        moved = [k for k in range(self.count) if change[k].any()]
        there = [(*row[:2], *was[2:]) for row, was in zip(rows, before, strict=True)]  # as they came, where they are
        near = [(link, n) for link in self._pairs(moved) for n in self._normals(link, there, room, time)]
        near = self._nearest(near) if self.things else near
        close = TOUCHING * max((abs(value) for k in moved for value in rows[k][:2]), default=0.0)
        touching = [(link, n) for link, n in near if abs(n.gap) <= close]
        found = self._explaining(touching, change)
        if found[1] <= SOLVED:
            return found
        found = self._explaining(near, change)
        if way is None or found[1] <= SOLVED:
            return found
        met = [(link, self._met(link, before, way) or normal) for link, normal in near]
        return min(self._explaining(met, change), found, key=lambda told: told[1])

    def _normals(self, link: Indices, rows: Sequence[Row], room: float, time: float) -> list[Normal]:
        """The lines of centres of two things no farther apart than `room`: of a concave one, of each part of it."""
        if self._near is not None and link[1] in self._near.things:
            return [_normal(part) for part in self._near.near(*link, *rows[link[0]], room)]
        normal = self.normal(link, rows, time)
        return [normal] if normal.gap <= room else []

    def _nearest(self, near: Sequence[tuple[Indices, Normal]]) -> list[tuple[Indices, Normal]]:
        """Of walls and things that push a circle in the same direction, the one that it touches best."""
        kept: list[tuple[Indices, Normal]] = []
        for link, normal in sorted(near, key=lambda told: abs(told[1].gap)):
            beside = (n for other, n in kept if other[0] == link[0] and other[1] >= self.count)
            if link[1] < self.count or all(n.x * normal.x + n.y * normal.y < 1.0 - SOLVED for n in beside):
                kept.append((link, normal))
        return sorted(kept, key=lambda told: told[0])

    def _met(self, link: Indices, rows: Sequence[Row], way: float) -> Normal | None:
        """The line of centres at which two circles that flew straight on met, no longer ago than `way`.

        Under gravity two that move fly straight as seen from each other; of one that stands no line is known.
        """
        i, j = link
        if j >= self.count or (any(self._gravity) and self.moves(i) != self.moves(j)):
            return None
        dx, dy, vx, vy = (one - other for one, other in zip(rows[i], rows[j], strict=True))
        reach, speed, near = self._radii[i] + self._radii[j], vx * vx + vy * vy, dx * vx + dy * vy
        root = speed * reach * reach - (dx * vy - dy * vx) ** 2
        if root < 0.0 or speed == 0.0 or not 0.0 <= (near + math.sqrt(root)) / speed <= way:
            return None
        ago = (near + math.sqrt(root)) / speed
        return Normal((dx - ago * vx) / reach, (dy - ago * vy) / reach, 0.0)

    def _explaining(
        self, near: Sequence[tuple[Indices, Normal]], change: NDArray[np.float64]
    ) -> tuple[list[Indices], float]:
        """Those contacts of some whose impulses come nearest to a change, and the part of it that they leave."""
        if not near:
            return [], 1.0
        matrix, wanted, strengths = self._nearest_to(near, change)
        size = float(np.linalg.norm(wanted))
        left = float(np.linalg.norm(wanted - matrix.T @ strengths)) / size
        reach = np.linalg.norm(matrix, axis=1) * strengths
        return [link for (link, _), part in zip(near, reach, strict=True) if part > SOLVED * size], left

    def strengths(
        self, links: Sequence[Indices], rows: Sequence[Row], after: Sequence[Row], time: float
    ) -> dict[Indices, float]:
        """How strong the impulses of contacts are, none of them pulling, that come nearest to a change.

        >>> from truebreak.scenarios import Circle, Scene, Wall
        >>> impacts = Impacts(Scene([Circle(0, 1, m=3)], [Wall(0, 0, 1, 0)]))
        >>> impacts.strengths([(0, 1)], [(0.0, 1.0, 0.0, -2.0)], [(0.0, 1.0, 0.0, 2.0)], 0.0)
        {(0, 1): 12.0}
        """
        contacts = [(link, self.normal(link, rows, time)) for link in dict.fromkeys(links)]
        change = np.array([[r[2] - v[2], r[3] - v[3]] for r, v in zip(after, rows, strict=True)])
        _, _, found = self._nearest_to(contacts, change)
        return {link: float(strength) for (link, _), strength in zip(contacts, found, strict=True)}

    def _nearest_to(
        self, near: Sequence[tuple[Indices, Normal]], change: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """What unit impulses do, the change of velocities in the same units, and how strong they come nearest to it."""
        with np.errstate(divide="ignore", invalid="ignore"):
            wanted = np.where(self.weights[:, None] > 0, change / np.sqrt(self.weights)[:, None], 0.0).reshape(-1)
        matrix = self.matrix(near)
        return matrix, wanted, least(matrix @ matrix.T, matrix @ wanted)

    def _pairs(self, moved: Sequence[int]) -> list[Indices]:
        """Every pair of which one is among the circles given."""
        found = {(min(i, j), max(i, j)) for i in moved for j in range(self.count) if i != j}
        fixed = [*range(self.count, self.count + len(self._walls)), *self.things]
        return [*sorted(found), *((i, place) for i in moved for place in fixed)]

    def named(self, links: Sequence[Indices], rows: Sequence[Row]) -> list[Indices]:
        """The same contacts, those with an end that several things share by the thing that names it.

        Each is there once, but for one with two faces of a concave thing.
        """
        near = self._near
        if near is None:
            return list(links)
        found: dict[Indices, int] = {}
        for (i, j), times in Counter(links).items():
            name = (i, near.name_of(i, j, *rows[i]) if j in near.things else j)
            concave = j in near.things and not near.things[j].convex
            found[name] = max(found.get(name, 1), times if concave else 1)
        return [link for link, times in found.items() for _ in range(times)]

    def matrix(self, contacts: Sequence[tuple[Indices, Normal]]) -> NDArray[np.float64]:
        """Shape (contacts, 2 * circles): what each unit impulse does, in velocities times the root of the mass."""
        rows = np.zeros((len(contacts), self.count, 2))
        for k, ((i, j), normal) in enumerate(contacts):
            rows[k, i] += (normal.x, normal.y)
            if j < self.count:
                rows[k, j] -= (normal.x, normal.y)
        return (rows * np.sqrt(self.weights)[:, None]).reshape(len(contacts), -1)

    def _pushed(self, rows: list[Row], matrix: NDArray[np.float64], strengths: NDArray[np.float64]) -> list[Row]:
        gain = (matrix.T @ strengths).reshape(self.count, 2) * np.sqrt(self.weights)[:, None]
        return [
            (x, y, vx + float(gx), vy + float(gy)) if gx or gy else (x, y, vx, vy)
            for (x, y, vx, vy), (gx, gy) in zip(rows, gain, strict=True)
        ]

    def moves(self, place: int) -> bool:
        """Whether a place in `scene.ids` is that of a circle which can move."""
        return place < self.count and self.weights[place] > 0

    def coupled(self, links: Sequence[Indices], rows: Sequence[Row], time: float) -> bool:
        """Whether a moving circle has two of the contacts, not at right angles: then their order may matter."""
        lines: dict[int, list[Normal]] = {}
        for link, normal in self.contacts(links, rows, time):
            for k in filter(self.moves, link):
                others = lines.setdefault(k, [])
                if any(abs(normal.x * other.x + normal.y * other.y) > SOLVED for other in others):
                    return True
                others.append(normal)
        return False

    def quiet(self, rows: Sequence[Row], time: float, room: float | None = None) -> bool:
        """Whether no two circles, and no circle and wall or thing, come nearer to each other: then none ever will.

        Under gravity only where it pulls no circle to a wall, and nothing round stands.

        Args:
            room: of circles that all lie on walls, how fast they may come nearer by rounding.
        """
        walls = range(self.count, self.count + len(self._walls))
        links = [(i, j) for i in range(self.count) for j in (*range(i + 1, self.count), *walls)]
        normals = {link: self.normal(link, rows, time) for link in links}
        if not all(self.opening(link, rows, normal) >= -(room or 0.0) for link, normal in normals.items()):
            return False
        gx, gy = self._gravity
        if room is not None:
            return not self.things
        if gx or gy:
            if self.things or not all(map(self.moves, range(self.count))):
                return False
            return all(n.x * gx + n.y * gy >= 0.0 for (_, j), n in normals.items() if j >= self.count)
        near = self._near
        return near is None or not any(near.comes_to(i, j, *rows[i]) for i in range(self.count) for j in near.things)


class Shelf(NamedTuple):
    """A line that can carry a circle.

    Attributes:
        place: of the wall, segment or polygon in `scene.ids`.
        x, y: a point of it; of a face, where it begins.
        nx, ny: of length 1, to the circle.
        ux, uy: of length 1, along it, from its first point to its second.
        length: of a face; infinite of a wall.
        slope: half of what there is of gravity along it, where it is not level.
    """

    place: int
    x: float
    y: float
    nx: float
    ny: float
    ux: float
    uy: float
    length: float
    slope: tuple[float, float] | None


class Supports:
    """The walls and faces that can carry the circles of a scene, or that they slide down: those to which gravity pulls.

    >>> from truebreak.scenarios import Circle, Scene, Wall
    >>> scene = Scene([Circle(0, 3)], [Wall(0, 0, 1, 0), Wall(0, -9, 1, -8)], gravity=(0, -1), settle=True)
    >>> supports = Supports(scene)
    >>> [supports.under(0, (5.0, 1.0, 2.0, vy), 2.0**-40, 2.0**-50) for vy in (0.0, 0.5)]
    [1, None]
    """

    def __init__(self, scene: Scene) -> None:
        whole, count = scene.surfaces, len(scene.circles)
        self._radii = [float(c.r) for c in scene.circles]
        self.shelves: list[list[Shelf]] = [[] for _ in scene.circles]
        if not scene.settle:
            return
        sides = Sides(whole)
        owners = {wall: place for place, parts in parts_of(scene).items() for wall in parts.faces}
        for w, wall in enumerate(whole.walls):
            hx, hy = map(float, wall.along(*(part / 2 for part in scene.gravity or ())))
            slope = None if sides.level(w) else (hx, hy)
            x0, y0, x1, y1 = (float(v) for v in (wall.x0, wall.y0, wall.x1, wall.y1))
            length, place = math.hypot(x1 - x0, y1 - y0), owners.get(w, count + w)
            for k in range(count):
                if sides.pull(k, w) < 0:
                    sign = -1.0 if sides.negative(k, w) else 1.0
                    ux, uy = (x1 - x0) / length, (y1 - y0) / length
                    ends = length if w in whole.faces else math.inf
                    self.shelves[k].append(Shelf(place, x0, y0, -sign * uy, sign * ux, ux, uy, ends, slope))

    def under(self, k: int, row: Row, share: float, still: float, flown: float = 0.0) -> int | None:
        """The place of what a circle lies on or slides along; None where it neither touches such a thing nor stays.

        Args:
            share: by what share of themselves places may be off.
            still: a speed across the line that is no more than rounding.
            flown: a way, by a share of which places may be off, too.
        """
        x, y, vx, vy = row
        for place, x0, y0, nx, ny, ux, uy, length, _ in self.shelves[k]:
            size = abs(x) + abs(y) + abs(x0) + abs(y0) + self._radii[k] + flown
            foot, off = ux * (x - x0) + uy * (y - y0), nx * (x - x0) + ny * (y - y0) - self._radii[k]
            if (
                (math.isinf(length) or 0.0 < foot < length)
                and abs(off) <= share * size
                and abs(nx * vx + ny * vy) <= still
            ):
                return place
        return None

    def slope(self, k: int, place: int, row: Row) -> tuple[float, float] | None:
        """Half of what there is of gravity along what a circle stands on; None where that is level, or nothing known.

        Args:
            place: of the wall, segment or polygon.
            row: x, y, vx, vy: of several faces the nearest one counts.
        """
        shelf = self._nearest(k, place, row)
        return None if shelf is None else shelf.slope

    def bounces(self, k: int, place: int, knot: DoubleKnot, until: float, e: float) -> EndlessBounces | None:
        """Those that a circle goes on with after a bounce on a wall, up to when they end; None if it does not leave it.

        Args:
            knot: its time, and x, y, vx, vy as it leaves the wall.
        """
        time, *row = knot
        shelf = self._nearest(k, place, (row[0], row[1], row[2], row[3]))
        speed = 0.0 if shelf is None else shelf.nx * row[2] + shelf.ny * row[3]
        if shelf is None or not (0.0 < e < 1.0 and speed > 0.0 and time < until):
            return None
        return EndlessBounces(time, until, shelf.nx, shelf.ny, speed, e)

    def _nearest(self, k: int, place: int, row: Row) -> Shelf | None:
        x, y, radius = *row[:2], self._radii[k]
        near = [
            (abs(s.nx * (x - s.x) + s.ny * (y - s.y) - radius), n)
            for n, s in enumerate(self.shelves[k])
            if s.place == place
        ]
        return self.shelves[k][min(near)[1]] if near else None


def _normal(part: NearestPart[float]) -> Normal:
    return Normal(part.nx, part.ny, part.gap)


def least(square: NDArray[np.float64], wanted: NDArray[np.float64]) -> NDArray[np.float64]:
    """The s >= 0 that makes s.G.s / 2 - b.s least: what no contact pulls at (Lawson and Hanson, 1974, chapter 23).

    Args:
        square: G, symmetric and positive semidefinite.
        wanted: b.

    >>> least(np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([1.0, -1.0])).tolist()
    [0.5, 0.0]
    """
    count = len(wanted)
    found, kept = np.zeros(count), np.zeros(count, dtype=bool)
    floor = SOLVED * float(np.abs(wanted).max(initial=0.0))
    for _ in range(3 * count + 3):
        slack = np.where(kept, -np.inf, wanted - square @ found)
        if not count or slack.max() <= floor:
            break
        kept[int(np.argmax(slack))] = True
        while True:
            trial = np.zeros(count)
            trial[kept] = np.linalg.lstsq(square[np.ix_(kept, kept)], wanted[kept], rcond=None)[0]
            if not (trial[kept] <= 0.0).any():
                break
            low = np.flatnonzero(kept & (trial <= 0.0))
            shares = found[low] / np.maximum(found[low] - trial[low], math.ulp(0.0))
            first = int(low[int(np.argmin(shares))])
            found = found + float(shares.min()) * (trial - found)
            found[first], kept[first] = 0.0, False
        found = trial
    return found


# -- strengths of the contacts of one instant, from the change of velocities

MOST_SWEEPS = 200
"""Sweeps of coordinate descent over the contacts of one instant, which find those that push."""

MOST_DROPPED = 40
"""How often contacts that would pull are left out before the strengths are taken as they are."""


def strengths_of(
    columns: Sequence[dict[int, tuple[float, float]]], wanted: dict[int, tuple[float, float]]
) -> list[float]:
    """Strengths s >= 0 of some contacts that come nearest to a change, by least squares.

    Coordinate descent finds which of them push; the normal equations of these are solved in `AUDIT_BITS`. Contacts of
    which one more is there than can be told apart (a raft of discs) share their strength.

    Args:
        columns: for each contact, what a unit of it does to each circle.
        wanted: the change of each circle.

    >>> strengths_of([{0: (1.0, 0.0)}, {0: (0.0, 1.0)}], {0: (2.0, -1.0)})
    [2.0, 0.0]
    """
    found = _descent(columns, wanted)
    pushing = [c for c, strength in enumerate(found) if strength > 0.0]
    for _ in range(MOST_DROPPED):
        sharp = solved([columns[c] for c in pushing], wanted)
        pulling = [c for c, strength in zip(pushing, sharp, strict=True) if strength < 0.0]
        if not pulling:
            found = [0.0] * len(columns)
            for c, strength in zip(pushing, sharp, strict=True):
                found[c] = strength
            break
        pushing = [c for c in pushing if c not in pulling]
    return found


def _descent(columns: Sequence[dict[int, tuple[float, float]]], wanted: dict[int, tuple[float, float]]) -> list[float]:
    """Strengths by coordinate descent, each kept from pulling."""
    left = {k: [x, y] for k, (x, y) in wanted.items()}
    squares = [sum(x * x + y * y for x, y in column.values()) for column in columns]
    found = [0.0] * len(columns)
    for _ in range(MOST_SWEEPS):
        moved = False
        for c, column in enumerate(columns):
            if not squares[c]:
                continue
            pull = sum(left[k][0] * x + left[k][1] * y for k, (x, y) in column.items()) / squares[c]
            step = max(-found[c], pull)
            if abs(step) > 2.0**-56 * found[c]:
                moved = True
                found[c] += step
                for k, (x, y) in column.items():
                    left[k][0] -= step * x
                    left[k][1] -= step * y
        if not moved:
            break
    return found


def solved(columns: Sequence[dict[int, tuple[float, float]]], wanted: dict[int, tuple[float, float]]) -> list[float]:
    """The strengths of contacts all of which push: G s = b, with a 2**-100th of G's trace on its diagonal."""
    count = len(columns)
    if not count:
        return []
    rows = [[arb(0)] * count for _ in range(count)]
    for c, one in enumerate(columns):
        for d in range(c, count):
            other = columns[d]
            total = arb(0)
            for k in one.keys() & other.keys():
                total += arb(one[k][0]) * other[k][0] + arb(one[k][1]) * other[k][1]
            rows[c][d] = rows[d][c] = total
    trace = sum((rows[c][c] for c in range(count)), arb(0))
    for c in range(count):
        rows[c][c] += trace * arb(2) ** -100
    right = [
        [sum((arb(wanted[k][0]) * x + arb(wanted[k][1]) * y for k, (x, y) in one.items()), arb(0))] for one in columns
    ]
    try:
        told = arb_mat(rows).solve(arb_mat(right))
    except ZeroDivisionError:
        return [0.0] * count
    return [float(told[c, 0].mid()) for c in range(count)]


def left_of(
    k: int, weight: arb, change: tuple[arb, arb], links: Sequence[tuple[int, int]], strengths: Sequence[arb],
    normals: Mapping[tuple[int, int], tuple[arb, arb]],
) -> tuple[arb, arb]:  # fmt: skip
    """What pushes of these strengths leave of a circle's change of velocity.

    Args:
        weight: its inverse mass.
        normals: of each pair, from the first to the second.
    """
    x, y = change
    for link, strength in zip(links, strengths, strict=True):
        if k in link:
            push = strength * weight * (1 if k == link[1] else -1)
            x, y = x - push * normals[link][0], y - push * normals[link][1]
    return x, y


def sharpened(
    rough: Sequence[float], columns: Sequence[dict[int, tuple[float, float]]], links: Sequence[tuple[int, int]],
    normals: Mapping[tuple[int, int], tuple[arb, arb]], change: Mapping[int, tuple[arb, arb]],
    weights: Mapping[int, arb], bits: float,
) -> list[arb]:  # fmt: skip
    """Strengths to so many bits: what those in doubles leave is explained by the same contacts again."""
    strengths = [arb(strength) for strength in rough]
    pushing = [c for c, strength in enumerate(rough) if strength > 0.0]
    for _ in range(math.ceil(max(0.0, bits - DOUBLE_BITS) / BITS_GAINED) if pushing else 0):
        left: dict[int, tuple[float, float]] = {}
        for k in change:
            root = math.sqrt(float(weights[k]))
            x, y = left_of(k, weights[k], change[k], links, strengths, normals)
            left[k] = float(x.mid()) / root, float(y.mid()) / root
        for c, more in zip(pushing, solved([columns[c] for c in pushing], left), strict=True):
            strengths[c] += arb(more)
    return strengths


BITS_GAINED = 40
"""Bits that one more round in doubles gains of strengths, at least, where contacts can be told apart."""

DOUBLE_BITS = 53


class PushLimits(NamedTuple):
    """What restitution asks of the pushes of one instant, whatever their order: see `limits_of_pushes`.

    Attributes:
        beyond: by what speed each contact's push is beyond its limits; of one within them 0.
        rooms: what of that may come of changes of velocity that are off.
        least, most: the energy that is lost.
        room: what of these may come of changes of velocity that are off.
    """

    beyond: list[arb]
    rooms: list[float]
    least: arb
    most: arb
    room: float


def limits_of_pushes(
    links: Sequence[tuple[int, int]], times: Sequence[int], approaches: Sequence[arb], strengths: Sequence[arb],
    normals: Mapping[tuple[int, int], tuple[arb, arb]], weights: Mapping[int, arb], restitution: arb, off: float,
) -> PushLimits | None:  # fmt: skip
    """Between what the pushes of one instant are, of contacts that collide one after the other, or several together.

    With A_lm for what a unit of push at m opens l by: as l collides it pushes by (1 + e) times the speed of approach
    that it has by then, less what those that collide together with it open it by. Of these, and of those before,
    only such as A_lm > 0 can take from its approach g_l, and only such as A_lm < 0 add to it. So over all rounds

        g_l - sum max(0, A_lm) S_m  <=  A_ll S_l / (1 + e)  <=  g_l + sum max(0, -A_lm) S_m,

    which is an equality where all are at right angles. Pushes s that are made together lose (1 - e) / (2 (1 + e)) times
    s.A.s; of a contact that collides n times the squares sum up to S^2 / n at least, and to S^2 at most.

    Args:
        links: the contacts.
        times: how often each collides.
        approaches: of each, before the instant.
        strengths: S, of each in all.
        normals: of each pair, from the first to the second.
        weights: the inverse mass of each circle that moves.
        restitution: e.
        off: by what the changes of velocity may be off, times the root of the mass.

    Returns:
        None where the strengths cannot be told from the changes of velocity: more contacts than these have directions.

    >>> links, walls = [(0, 1), (0, 2)], {(0, 1): (arb(1), arb(0)), (0, 2): (arb(0), arb(1))}
    >>> pushes = [arb(3), arb("1.5")], walls, {0: arb(1)}, arb("0.5"), 0.0
    >>> found = limits_of_pushes(links, [1, 1], [arb(2), arb(2)], *pushes)
    >>> [float(speed) for speed in found.beyond], *(round(float(lost), 12) for lost in (found.least, found.most))
    ([0.0, 1.0], 1.875, 1.875)
    """
    count = len(links)
    square = [[_opened(one, other, normals, weights) for other in links] for one in links]
    sizes = [math.sqrt(float(square[c][c].mid())) for c in range(count)]
    if not all(sizes):
        return None
    try:
        inverse = arb_mat(square).inv()
    except ZeroDivisionError:
        return None
    moved = [off * sum(abs(float(inverse[c, d].mid())) * sizes[d] for d in range(count)) for c in range(count)]
    if any(moved[c] * sizes[c] > 1e6 * off for c in range(count)):
        return None
    beyond, rooms = list[arb](), list[float]()
    least, most, room = arb(0), arb(0), 0.0
    lost = (1 - restitution) / (1 + restitution) / 2
    for c in range(count):
        low = high = approaches[c]
        loose = sizes[c] ** 2 * moved[c]
        for d in range(count):
            if d != c:
                pushed = square[c][d] * strengths[d]
                loose += abs(float(square[c][d].mid())) * moved[d]
                low, high = low - pushed.max(arb(0)), high - pushed.min(arb(0))
                least, most = (
                    least + lost * pushed.min(arb(0)) * strengths[c],
                    most + lost * pushed.max(arb(0)) * strengths[c],
                )
            room += 2 * float((lost * abs(square[c][d]) * strengths[d]).mid()) * moved[c]
        has = square[c][c] * strengths[c] / (1 + restitution)
        beyond.append((has - high).max(low - has).max(arb(0)))
        rooms.append(loose)
        own = lost * square[c][c] * strengths[c] ** 2
        least, most = least + own / times[c], most + own
    return PushLimits(beyond, rooms, least, most, room)


def _opened(
    one: tuple[int, int], other: tuple[int, int],
    normals: Mapping[tuple[int, int], tuple[arb, arb]], weights: Mapping[int, arb],
) -> arb:  # fmt: skip
    """By what speed a unit of push at one contact opens another."""
    total = arb(0)
    for k in {*one} & {*other} & weights.keys():
        same = 1 if (k == one[1]) == (k == other[1]) else -1
        total += same * weights[k] * (normals[one][0] * normals[other][0] + normals[one][1] * normals[other][1])
    return total
