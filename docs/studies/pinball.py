"""The pinball of three discs: its periodic orbits, proved; what they give for the repeller; certified escape.

`python docs/studies/pinball.py` prints escape rate, mean exponent and entropy of the repeller by cycle expansion, and
with `--runs N` the escape rate of N certified runs.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, takewhile
from math import atan2
from typing import TypeAlias

from flint import arb, arb_mat

from truebreak.compare.tangent.growth import Displacements, unit_rows
from truebreak.compare.tangent.impacts import Impact
from truebreak.exact.exact_engine import ExactEngine
from truebreak.exact.numbers import ball
from truebreak.scenarios import catalogue
from truebreak.scenarios.errors import SceneError
from truebreak.scenarios.numbers.quantity import Quantity
from truebreak.scenarios.scene import Scene
from truebreak.scenarios.things import Circle
from truebreak.scenarios.trajectory import StopReason

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


STEPS = 60
"""Newton steps in which a simple zero is found to all bits."""


@dataclass(frozen=True)
class Averages:
    """What the expansion up to cycles of so many letters gives.

    Attributes:
        order: letters of the longest cycles.
        orbits: how many there are.
        escape: the escape rate per unit time, at speed 1 and radius 1.
        exponent: the mean Lyapunov exponent per unit time on the repeller.
    """

    order: int
    orbits: int
    escape: arb
    exponent: arb

    @property
    def entropy(self) -> arb:
        """The Kolmogorov-Sinai entropy per unit time: the exponent less the escape rate.

        H. Kantz, P. Grassberger, Physica D 17 (1985), 75.
        """
        with ball.precision(BITS):
            return self.exponent - self.escape


def determinant(orbits: Sequence[Orbit], order: int, s: arb) -> tuple[arb, arb, arb]:
    """The spectral determinant, cut off after cycles of `order` letters, and its slopes in s and in b.

    exp(-sum over cycles p and repeats r of exp(r (b ln|M| - s T)) / (r |1 - M**r| |1 - M**-r|)), expanded in the
    number of letters; T is a cycle's period, M its multiplier; the slopes are those at b = 0. This is the factor of
    functions that are symmetric under all of the triangle.

    Sources: P. Cvitanovic, B. Eckhardt, Symmetry decomposition of chaotic dynamics, Nonlinearity 6 (1993), 277; the
    recursion of the coefficients is Newton's, from power sums.
    """
    sums = [[arb(0)] * 3 for _ in range(order + 1)]
    for told in orbits:
        letters, stretched = len(told.word), abs(told.multiplier).log()
        for repeat in range(1, order // letters + 1):
            power = told.multiplier**repeat
            weight = letters * (-s * told.length * repeat).exp() / abs((1 - power) * (1 - 1 / power))
            mine = sums[letters * repeat]
            for k, factor in enumerate((arb(1), -told.length * repeat, stretched * repeat)):
                mine[k] += weight * factor
    terms = [[arb(1), arb(0), arb(0)]]
    for k in range(1, order + 1):
        new = [arb(0)] * 3
        for j in range(1, k + 1):
            (c, cs, cb), (f, fs, fb) = sums[j], terms[k - j]
            new[0] -= c * f / k
            new[1] -= (cs * f + c * fs) / k
            new[2] -= (cb * f + c * fb) / k
        terms.append(new)
    value, by_s, by_b = (sum((term[i] for term in terms), arb(0)) for i in range(3))
    return value, by_s, by_b


def averages(orbits: Sequence[Orbit], order: int) -> Averages:
    """The averages from the cycles of up to `order` letters.

    The escape rate is -s at the determinant's zero that is nearest below s = 0, where Newton's method begins; how that
    zero moves with b is the mean exponent.
    """
    used = [told for told in orbits if len(told.word) <= order]
    with ball.precision(BITS):
        s = arb(0)
        for _ in range(STEPS):
            value, slope, _ = determinant(used, order, s)
            step = (value / slope).mid()
            s = (s - step).mid()
            if abs(step) < arb(2) ** (-BITS // 2):
                break
        value, slope, tilt = determinant(used, order, s)
        return Averages(order, len(used), value / slope - s, -tilt / slope)


def ladder(distance: Quantity, most: int) -> Iterator[Averages]:
    """The averages by cycles of up to 1, 2, ... letters.

    Raises:
        SceneError: if the discs stand too close for every word to have its orbit.

    >>> *_, told = ladder(Quantity.of(6), 5)
    >>> told.orbits, told.escape.str(13, radius=False), told.exponent.str(10, radius=False)
    (14, '0.4103384077696', '0.5775525788')
    """
    scene = pinball(distance)
    orbits = [orbit(scene, word) for word in words(most)]
    for order in range(1, most + 1):
        yield averages(orbits, order)


def settled(one: arb, two: arb) -> str:
    """The digits that two orders have in common, cut off.

    >>> settled(arb("0.41033"), arb("0.41056"))
    '0.410'
    """
    with ball.precision(BITS):
        texts = [value.str(60, radius=False) for value in (one, two)]
    return "".join(a for a, _ in takewhile(lambda pair: pair[0] == pair[1], zip(*texts, strict=False)))


FIRST = 2
"""Bounces after which a fan is all but forgotten: at distance 6 the rate from the second to the third bounce is 0.16 %
too low, from the third to the fourth 0.006 % (of 400,000 directions, in doubles)."""


@dataclass(frozen=True)
class Escape:
    """What a fan of certified runs says.

    Attributes:
        runs: how many.
        survivors: of them, how many bounce at least once, twice, ...
        rate: escape rate per unit time, from those of two bounces to those of three.
        room: what it may be off by because the fan tells the width of a window of directions to one direction only.
    """

    runs: int
    survivors: tuple[int, ...]
    rate: float
    room: float


def fan(distance: Quantity, count: int) -> Iterator[Scene]:
    """A point in the middle, in directions evenly spread in the tangent of half their angle.

    They reach from the middle of the first disc to its rim, or near it; the rest of the circle is their mirror image.

    >>> [scene.circles[0].vx**2 + scene.circles[0].vy**2 == 1 for scene in fan(Quantity.of(6), 2)]
    [True, True]
    """
    scene = pinball(distance)
    start, *discs = scene.circles
    last = Quantity.of("9/10") / distance
    for k in range(count):
        t = last * (2 * k + 1) / (2 * count)
        square = 1 + t * t
        flying = Circle(0, 0, r=0, vx=(1 - t * t) / square, vy=2 * t / square, id=start.id, point=True)
        yield scene.with_changes(circles=[flying, *discs])


def bounces(scene: Scene) -> list[float]:
    """When the point bounces, until it has escaped.

    Raises:
        SceneError: if its run is not certified to the end.
    """
    run = ExactEngine().run(scene)
    if not run.certified or run.stop.reason is not StopReason.QUIET:
        raise SceneError(f"{scene.name!r}: its run is not certified to its escape ({run.stop.message})")
    return [float(event.time) for event in run.events]


def rate_between(early: Sequence[float], late: Sequence[float]) -> float:
    """The rate g at which the sum of exp(g t) over the later times is that over the earlier ones.

    Among those that stay, a bounce later is as likely as it is short: where the starts are forgotten, this sum stays
    the same from bounce to bounce.

    Raises:
        SceneError: if nothing survives.

    >>> round(rate_between([1.0] * 8, [3.0] * 2), 6) == round(math.log(4) / 2, 6)
    True
    """
    if not late:
        raise SceneError("no run bounces often enough; take more of them")
    low, high = 0.0, 1.0
    while _surplus(high, early, late) < 0:
        high *= 2
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if _surplus(middle, early, late) < 0 else (low, middle)
    return low


def _surplus(rate: float, early: Sequence[float], late: Sequence[float]) -> float:
    return sum(math.exp(rate * time) for time in late) - sum(math.exp(rate * time) for time in early)


def escape(distance: Quantity, count: int, progress: Callable[[int, int], None] | None = None) -> Escape:
    """Runs the fan, each direction certified until it has escaped.

    Args:
        progress: called after each run with how many are done, of how many.

    Raises:
        SceneError: as `pinball`, `bounces` and `rate_between`.

    >>> told = escape(Quantity.of(6), 60)
    >>> told.survivors, abs(told.rate - 0.41034) < told.room
    ((59, 12, 2), True)
    """
    times: list[list[float]] = []
    for done, scene in enumerate(fan(distance, count), 1):
        times.append(bounces(scene))
        if progress is not None:
            progress(done, count)
    longest = max(map(len, times))
    survivors = tuple(sum(len(mine) > k for mine in times) for k in range(longest))
    early, late = ([mine[k - 1] for mine in times if len(mine) >= k] for k in (FIRST, FIRST + 1))
    rate = rate_between(early, late)
    apart = sum(late) / len(late) - sum(early) / len(early)
    windows = [2 ** max(k - 2, 0) for k in (FIRST, FIRST + 1)]
    return Escape(count, survivors, rate, (windows[0] / len(early) + windows[1] / len(late)) / apart)


DIGITS = 32
"""Decimals of a line of the table: one more than are published."""


def table(distance: Quantity, order: int) -> str:
    """The averages by cycles of up to 1, 2, ... letters, and the digits that the last two orders agree on.

    >>> print(table(Quantity.of(6), 4).splitlines()[-1])
    The last two orders agree on: escape rate 0.410338, exponent 0.577552, entropy 0.167214
    """
    rungs = list(ladder(distance, order))
    lines = ["| letters | orbits | escape rate | mean exponent | entropy |", "|---|---|---|---|---|"]
    for told in rungs:
        figures = (value.str(DIGITS, radius=False) for value in (told.escape, told.exponent, told.entropy))
        lines.append(f"| {told.order} | {told.orbits} | {' | '.join(figures)} |")
    if len(rungs) > 1:
        one, two = rungs[-2:]
        lines += ["", f"The last two orders agree on: escape rate {settled(one.escape, two.escape)}, "
                      f"exponent {settled(one.exponent, two.exponent)}, "
                      f"entropy {settled(one.entropy, two.entropy)}"]  # fmt: skip
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Prints the table and, asked for, the experiment; the exit status."""
    parser = argparse.ArgumentParser(
        prog="python docs/studies/pinball.py", description="Escape rate, exponent and entropy of the repeller."
    )
    parser.add_argument("--distance", default="6", metavar="D", help="of the discs' centres, in radii (6)")
    parser.add_argument("--letters", type=int, default=12, metavar="N", help="cycles of up to N bounces (12)")
    parser.add_argument("--runs", type=int, metavar="N", help="let N certified runs escape too")
    options = parser.parse_args(arguments)
    try:
        if options.letters < 1 or (options.runs is not None and options.runs < 1):
            raise SceneError("--letters and --runs: must be whole numbers from 1")
        distance = _distance(options.distance)
        print(table(distance, options.letters))
        if options.runs is not None:
            told = escape(distance, options.runs, _progress if sys.stderr.isatty() else None)
            print(f"\n{told.runs:,} certified runs: {', '.join(f'{n:,}' for n in told.survivors)} bounce once, twice, "
                  f"...; escape rate {told.rate:.5f} +- {told.room:.5f}")  # fmt: skip
    except SceneError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def _distance(text: str) -> Quantity:
    try:
        return Quantity.of(text)
    except SceneError as error:
        raise SceneError(f"--distance: {error}") from None


def _progress(done: int, total: int) -> None:
    if done % 100 == 0 or done == total:
        print(f"\r{done:,} of {total:,} runs", end="\n" if done == total else "", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
