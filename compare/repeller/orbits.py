"""Periodic orbits of a point between three fixed discs of radius 1, each proved, with its length and multiplier."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import atan2
from typing import TypeAlias

from flint import arb, arb_mat

from ...exact.numbers import ball
from ...scenarios import catalogue
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ..tangent.growth import Displacements, unit_rows
from ..tangent.impacts import Impact

BITS = 320
"""Precision of the search; the proof leaves some three quarters of it."""

MOST_ROUNDS = 40
"""Newton steps in which every orbit here is found: from a start that is right to a tenth, digits double each time."""

LEAST_DISTANCE = Quantity.of("4/sqrt(3)")
"""Beyond it the third disc lies clear of the strip between two others, so that it cuts off no path."""

Vector: TypeAlias = tuple[arb, arb]


class NotProved(ValueError):
    """Newton's method did not enclose an orbit."""


@dataclass(frozen=True)
class Orbit:
    """A periodic orbit, up to the symmetries of the triangle: after one period a symmetry maps it to its beginning.

    Attributes:
        word: a letter for each bounce: 0 where the point goes back to the disc it came from, 1 where it goes on to the
            third.
        length: of one period, the time at speed 1; a ball that holds it.
        multiplier: the factor by which the period stretches a displacement across the orbit; negative where it turns
            it over too. A ball.
        points: where the bounces are, in balls.
        discs: the discs of these bounces, and the two that follow, by number.
    """

    word: str
    length: arb
    multiplier: arb
    points: tuple[Vector, ...]
    discs: tuple[int, ...]


def words(most: int) -> Iterator[str]:
    """Every cycle of 0 and 1 of up to so many letters, once: the words that are before all of their rotations.

    J.-P. Duval, Theoret. Comput. Sci. 60 (1988), 255.

    >>> list(words(3))
    ['0', '001', '01', '011', '1']
    """
    word = [-1]
    while word:
        word[-1] += 1
        yield "".join(map(str, word))
        count = len(word)
        while len(word) < most:
            word.append(word[-count])
        while word and word[-1] == 1:
            word.pop()


def pinball(distance: Quantity) -> Scene:
    """The scene of the catalogue, with discs far enough apart.

    Raises:
        SceneError: if a disc may stand in the way of two others.
    """
    if distance <= LEAST_DISTANCE:
        raise SceneError(f"distance = {distance}: some paths may be cut off; it must be above 4/sqrt(3)")
    return catalogue.build(f"three-disc:distance={distance}")


def visited(word: str) -> tuple[int, ...]:
    """The discs of a word's bounces, from 0 and 1 on, and the two after them.

    >>> visited("0"), visited("1"), visited("01")
    ((0, 1, 0), (0, 1, 2), (0, 1, 0, 2))
    """
    discs = [0, 1]
    for letter in word:
        before, here = discs[-2:]
        discs.append(before if letter == "0" else 3 - before - here)
    return tuple(discs[: len(word) + 2])


class _Path:
    """The closed path of a word: its length as a function of the places of its bounces, and that function's slopes.

    An orbit is where the length is stationary. All is evaluated in balls at the working precision.
    """

    def __init__(self, scene: Scene, word: str) -> None:
        self.count = len(word)
        self.discs = visited(word)
        self.centres: list[Vector] = [(ball.constant(c.x), ball.constant(c.y)) for c in scene.circles[1:]]
        self.turn = self._symmetry()

    def _symmetry(self) -> arb_mat:
        """The matrix that maps the first two discs to the two after the last bounce, and so the third to the third."""
        first, last = ([self.centres[i] for i in pair] for pair in (self.discs[:2], self.discs[self.count :]))
        start, end = (arb_mat([[one[k], two[k]] for k in (0, 1)]) for one, two in (first, last))
        return end * start.inv()

    def turned(self, vector: Vector) -> Vector:
        x, y = vector
        return self.turn[0, 0] * x + self.turn[0, 1] * y, self.turn[1, 0] * x + self.turn[1, 1] * y

    def start(self) -> list[arb]:
        """Angles of the bounces, each facing the middle of the discs before and after it."""
        before = self.discs[self.count - 1]
        image = self.discs[self.count : self.count + 2]
        previous = {b: a for a, b in zip(self.discs[:2], image, strict=True)}.get(before, 2)
        chain = [previous, *self.discs[: self.count + 1]]
        angles: list[arb] = []
        for one, here, two in zip(chain, chain[1:], chain[2:], strict=False):
            (ax, ay), (cx, cy), (bx, by) = ((float(v) for v in self.centres[i]) for i in (one, here, two))
            angles.append(arb(atan2((ay + by) / 2 - cy, (ax + bx) / 2 - cx)))
        return angles

    def normals(self, angles: Sequence[arb]) -> list[Vector]:
        """The directions out of the discs, of the bounces and of the first one's image."""
        out = [(angle.cos(), angle.sin()) for angle in angles]
        return [*out, self.turned(out[0])]

    def points(self, normals: Sequence[Vector]) -> list[Vector]:
        """The bounces, and the first one's image."""
        return [
            (self.centres[i][0] + x, self.centres[i][1] + y) for i, (x, y) in zip(self.discs, normals, strict=False)
        ]

    def legs(self, points: Sequence[Vector]) -> list[tuple[arb, Vector]]:
        """Of each flight its length and its direction."""
        told: list[tuple[arb, Vector]] = []
        for (ax, ay), (bx, by) in pairwise(points):
            dx, dy = bx - ax, by - ay
            length = (dx * dx + dy * dy).sqrt()
            told.append((length, (dx / length, dy / length)))
        return told

    def slopes(self, angles: Sequence[arb]) -> tuple[arb_mat, arb_mat]:
        """The length's first and second derivatives: of each flight by the angles at its two ends."""
        normals = self.normals(angles)
        tangents = [(-y, x) for x, y in normals[:-1]]
        tangents.append(self.turned(tangents[0]))
        count = self.count
        first, second = [arb(0)] * count, [[arb(0)] * count for _ in range(count)]
        for k, (length, u) in enumerate(self.legs(self.points(normals))):
            i, j = k, (k + 1) % count
            here, there = _dot(u, tangents[k]), _dot(u, tangents[k + 1])
            first[i] -= here
            first[j] += there
            second[i][i] += (1 - here * here) / length + _dot(u, normals[k])
            second[j][j] += (1 - there * there) / length - _dot(u, normals[k + 1])
            mixed = (_dot(tangents[k], tangents[k + 1]) - here * there) / length
            second[i][j] -= mixed
            second[j][i] -= mixed
        return arb_mat([[value] for value in first]), arb_mat(second)


def _dot(a: Vector, b: Vector) -> arb:
    return a[0] * b[0] + a[1] * b[1]


def orbit(scene: Scene, word: str, bits: int = BITS) -> Orbit:
    """The orbit of a word in a scene of three fixed discs: found by Newton's method, and proved.

    The proof is an interval Newton step (R. Krawczyk, Computing 4, 1969, 187): a box of angles whose image lies inside
    it holds one place at which the length is stationary, which is the law of reflection at every bounce. That the point
    hits each disc from outside, and leaves it outward, is checked in the same balls; no other disc is near the flights
    (see `LEAST_DISTANCE`). The multiplier is read off the tangent map of the laws: its trace over one period is
    2 + multiplier + 1/multiplier.

    Raises:
        NotProved: if no box is proved, which more bits may remedy.

    >>> told = orbit(pinball(Quantity.of(6)), "0")
    >>> told.length.str(20, radius=False), told.multiplier.str(20, radius=False)
    ('4.0000000000000000000', '9.8989794855663561964')
    """
    with ball.precision(bits):
        path = _Path(scene, word)
        angles = _proved(path, _found(path, word, bits), word, bits)
        normals = path.normals(angles)
        points, legs = path.points(normals), path.legs(path.points(normals))
        for k, (_, u) in enumerate(legs):
            if not (_dot(u, normals[k]) > 0 and _dot(u, normals[k + 1]) < 0):
                raise NotProved(f"{word}: a flight runs through a disc")
        length = sum((leg for leg, _ in legs), arb(0))
        return Orbit(word, length, _multiplier(scene, path, legs, normals), tuple(points[:-1]), path.discs)


def _found(path: _Path, word: str, bits: int) -> list[arb]:
    angles = path.start()
    for _ in range(MOST_ROUNDS):
        first, second = path.slopes(angles)
        step = second.solve(first)
        angles = [(angle - step[k, 0]).mid() for k, angle in enumerate(angles)]
        if all(abs(step[k, 0]) < arb(2) ** (-bits * 4 // 5) for k in range(path.count)):
            return angles
    raise NotProved(f"{word}: Newton's method found no orbit in {MOST_ROUNDS} steps")


def _proved(path: _Path, angles: Sequence[arb], word: str, bits: int) -> list[arb]:
    """The angles as balls that hold the orbit."""
    room = arb(0, arb(2) ** (-bits * 3 // 4))
    box = [angle + room for angle in angles]
    first, second = path.slopes(angles)
    inverse = second.inv().mid()
    slopes = path.slopes(box)[1]
    size = path.count
    left = arb_mat(size, size, [int(i == j) for i in range(size) for j in range(size)]) - inverse * slopes
    image = inverse * first
    spread = left * arb_mat([[room] for _ in angles])
    told = [angle - image[k, 0] + spread[k, 0] for k, angle in enumerate(angles)]
    if not all(outer.contains_interior(inner) for outer, inner in zip(box, told, strict=True)):
        raise NotProved(f"{word}: the orbit is not enclosed with {bits} bits")
    return told


def _multiplier(scene: Scene, path: _Path, legs: Sequence[tuple[arb, Vector]], normals: Sequence[Vector]) -> arb:
    carried = Displacements(scene, unit_rows(scene))
    time = arb(0)
    for (length, (ux, uy)), (nx, ny), disc in zip(legs, normals[1:], path.discs[1:], strict=False):
        time += length
        carried.through([Impact(time, 0, disc + 1, -nx, -ny, -ux, -uy, arb(1), arb(1), arb(0))])
    back = path.turn.inv()
    columns = carried.columns[0]
    trace = sum((back[i, j] * columns[2 * half + j][0, 2 * half + i]
                 for half in (0, 1) for i in (0, 1) for j in (0, 1)), arb(0))  # fmt: skip
    rest = trace - 2
    root = (rest * rest - 4).sqrt()
    return (rest + root if rest > 0 else rest - root) / 2
