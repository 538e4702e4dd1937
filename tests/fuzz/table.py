"""The referee's table: all circles of a scene at one time, looked at anew whenever something is asked."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations
from random import Random
from typing import Any

from flint import arb, fmpq, fmpz  # type: ignore[attr-defined]

from truebreak.scenarios import Scene

Link = tuple[int, int]
"""(i, j) two circles, i < j; (i, n + k) circle i and wall k of a scene of n circles. Its order is the scene's."""

Row = tuple[fmpz, fmpz, fmpz, fmpz]
"""x, y, vx, vy of one circle."""

ROUNDS = 600
"""Impulses of one instant are taken to be endless after so many rounds."""
MOST_TOGETHER = 11
"""Most contacts whose impulses are found by trying every set of pushing ones."""


class Doubt(ArithmeticError):
    """A number is neither plainly zero nor plainly not."""


class TooLong(ArithmeticError):
    """There are more events, or more contacts at once, than brute force cares to play."""


class Endless(ArithmeticError):
    """The impulses of one instant do not come to an end."""


@dataclass(frozen=True)
class Blow:
    """One event: all impulses of one cluster-by-cluster settling.

    Attributes:
        contacts: the links that approach at the start or in some round.
        impulses: the links that push, round by round.
        unique: whether the laws leave no choice of who pushes (velocities never have one).
        coupled: whether pushes at two of the contacts act on a common circle otherwise than at right angles.
    """

    time: fmpz
    contacts: frozenset[Link]
    impulses: tuple[Link, ...]
    unique: bool
    coupled: bool


@dataclass(frozen=True)
class Entry:
    """Circle and pocket by index, and when."""

    circle: int
    pocket: int
    time: fmpz


def fixed(value: Any, bits: int) -> fmpz:
    """The whole number next to value * 2**bits, for anything with an exact `ball`."""
    rational = getattr(value, "rational", None)
    if isinstance(rational, fmpq):
        return (rational.p << bits) // rational.q
    work = bits + 64
    while True:
        ball = value.ball(work)
        if ball.rad() < arb((1, -bits - 8)):
            return shifted(ball, bits)
        if work > 16 * bits + 4096:
            raise Doubt(f"{float(value)} is not enclosed sharply by {work} bits")
        work *= 2


def shifted(ball: arb, bits: int) -> fmpz:
    """The middle of a ball, times 2**bits, as a whole number."""
    mantissa, exponent = ball.mid().man_exp()
    shift = int(exponent) + bits
    return mantissa << shift if shift >= 0 else mantissa >> -shift


class Table:
    """All circles of a scene at one time."""

    def __init__(self, scene: Scene, bits: int) -> None:
        self.bits, self.nil, self.sure = bits, bits - 4 * bits // 5, bits - bits // 2
        self.one = fmpz(1) << bits
        self.scene, self.n, self.now = scene, len(scene.circles), fmpz(0)
        self.x, self.y, self.vx, self.vy, self.r = (
            [self.read(getattr(c, key)) for c in scene.circles] for key in ("x", "y", "vx", "vy", "r")
        )
        self.w = [fmpz(0) if c.fixed else self.one * self.one // self.read(c.m) for c in scene.circles]
        self.free = [not c.fixed for c in scene.circles]
        self.reach = {}
        for i, j in combinations(range(self.n), 2):
            if (self.free[i] or self.free[j]) and not (scene.circles[i].point and scene.circles[j].point):
                self.reach[i, j] = self.r[i] + self.r[j]
        self.sides = {(i, self.n + k): side for k in range(len(scene.walls)) for i, side in self._sides(k)}
        self.links = sorted([*self.reach, *self.sides])
        self.holes = [(self.read(p.x), self.read(p.y), self.read(p.r)) for p in scene.pockets]
        self.random = None if scene.tie_policy.seed is None else Random(scene.tie_policy.seed)

    def read(self, quantity: Any) -> fmpz:
        return fixed(quantity, self.bits)

    def _sides(self, k: int) -> Iterable[tuple[int, tuple[fmpz, fmpz, fmpz]]]:
        """For every free circle: the unit normal of wall k that points to it, and the wall's place along it."""
        wall = self.scene.walls[k]
        nx, ny = (self.read(c) for c in wall.normal)
        length = (nx * nx + ny * ny).isqrt()
        nx, ny = (nx << self.bits) // length, (ny << self.bits) // length
        level = (self.read(wall.x0) * nx + self.read(wall.y0) * ny) >> self.bits
        for i in range(self.n):
            if self.free[i]:
                height = ((self.x[i] * nx + self.y[i] * ny) >> self.bits) - level
                yield i, (nx, ny, level) if self.sign(height) > 0 else (-nx, -ny, -level)

    def sign(self, value: fmpz) -> int:
        """-1, 0 or 1.

        Raises:
            Doubt: for what is too small to be a number and too large to be rounding.
        """
        size = value.bit_length()
        if size > self.sure:
            return 1 if value > 0 else -1
        if size < self.nil:
            return 0
        raise Doubt(f"a number of {size - self.bits} bits at {self.bits}")

    # -- looking

    def gap(self, link: Link) -> fmpz:
        """Zero where the two touch: the height above a wall, or distance squared less reach squared."""
        i, j = link
        if j >= self.n:
            nx, ny, level = self.sides[link]
            return ((self.x[i] * nx + self.y[i] * ny) >> self.bits) - level - self.r[i]
        dx, dy, reach = self.x[j] - self.x[i], self.y[j] - self.y[i], self.reach[link]
        return (dx * dx + dy * dy - reach * reach) >> self.bits

    def normal(self, link: Link) -> tuple[fmpz, fmpz]:
        """The unit vector from a wall to the circle, or from the first circle to the second."""
        i, j = link
        if j >= self.n:
            return self.sides[link][:2]
        dx, dy = self.x[j] - self.x[i], self.y[j] - self.y[i]
        length = (dx * dx + dy * dy).isqrt()
        return (dx << self.bits) // length, (dy << self.bits) // length

    def growing(self, link: Link) -> fmpz:
        """How fast the gap grows, times the distance for two circles: negative where they approach."""
        i, j = link
        if j >= self.n:
            nx, ny, _ = self.sides[link]
            return (self.vx[i] * nx + self.vy[i] * ny) >> self.bits
        dx, dy = self.x[j] - self.x[i], self.y[j] - self.y[i]
        return (dx * (self.vx[j] - self.vx[i]) + dy * (self.vy[j] - self.vy[i])) >> self.bits

    def wait(self, dx: fmpz, dy: fmpz, ux: fmpz, uy: fmpz, reach: fmpz) -> fmpz | None:
        """When |d + u t| falls to the reach from above, passing through; None if it does not."""
        b = (dx * ux + dy * uy) >> self.bits
        if b >= 0:
            return None
        c = (dx * dx + dy * dy - reach * reach) >> self.bits
        if self.sign(b) == 0 or self.sign(c) <= 0:
            return None
        square = b * b - ((ux * ux + uy * uy) >> self.bits) * c
        if self.sign(square >> self.bits) <= 0:
            return None
        return (c << self.bits) // (square.isqrt() - b)

    def next_wait(self) -> fmpz | None:
        """The time to the first contact or entry from here; None if there is none."""
        waits = []
        for link in self.links:
            i, j = link
            if j < self.n:
                found = self.wait(
                    self.x[j] - self.x[i], self.y[j] - self.y[i],
                    self.vx[j] - self.vx[i], self.vy[j] - self.vy[i], self.reach[link],
                )  # fmt: skip
            else:
                speed = self.growing(link)
                gap = self.gap(link) if speed < 0 and self.sign(speed) < 0 else fmpz(0)
                found = (gap << self.bits) // -speed if gap > 0 and self.sign(gap) > 0 else None
            if found is not None:
                waits.append(found)
        for i in range(self.n):
            if self.free[i] and (self.vx[i] or self.vy[i]):
                for x, y, r in self.holes:
                    found = self.wait(self.x[i] - x, self.y[i] - y, self.vx[i], self.vy[i], r)
                    if found is not None:
                        waits.append(found)
        return min(waits, default=None)

    # -- moving and kicking

    def advance(self, time: fmpz) -> None:
        dt = time - self.now
        self.now = time
        for i in range(self.n):
            self.x[i] += (self.vx[i] * dt) >> self.bits
            self.y[i] += (self.vy[i] * dt) >> self.bits

    def rows(self) -> tuple[Row, ...]:
        return tuple(zip(self.x, self.y, self.vx, self.vy, strict=True))

    def flip(self) -> None:
        self.vx, self.vy = [-v for v in self.vx], [-v for v in self.vy]

    def blow(self) -> Blow | None:
        """Settles all contacts of the instant; None if none approaches."""
        touching = [link for link in self.links if self.sign(self.gap(link)) == 0]
        coming = {link for link in touching if self.sign(self.growing(link)) < 0}
        if not coming:
            return None
        contacts: set[Link] = set()
        impulses: list[Link] = []
        unique = True
        clusters = [cluster for cluster in self.clusters(touching) if coming & set(cluster)]
        for cluster in sorted(clusters, key=lambda cluster: min(coming & set(cluster))):
            for _ in range(ROUNDS):
                approaching = [link for link in cluster if self.sign(self.growing(link)) < 0]
                if not approaching:
                    break
                contacts |= set(approaching)
                pushing, sure = self.kick(self.choose(approaching))
                impulses += pushing
                unique = unique and sure
            else:
                raise Endless(f"over {ROUNDS} rounds at one instant")
        arms = [self.arms(link) for link in contacts]
        coupled = any(self.sign(self.coupling(a, b)) != 0 for a, b in combinations(arms, 2))
        return Blow(self.now, frozenset(contacts), tuple(impulses), unique, coupled)

    def clusters(self, touching: list[Link]) -> list[list[Link]]:
        """The touching links, those that share circles together, each in scene order."""
        label = list(range(self.n))
        for i, j in touching:
            if j < self.n and label[i] != label[j]:
                label = [label[i] if k == label[j] else k for k in label]
        groups: dict[int, list[Link]] = {}
        for link in touching:
            groups.setdefault(label[link[0]], []).append(link)
        return list(groups.values())

    def choose(self, approaching: list[Link]) -> list[Link]:
        """The links that the tie policy kicks next."""
        if self.scene.tie_policy.name == "simultaneous":
            return approaching
        if self.random is None or len(approaching) == 1:
            return approaching[:1]
        return [approaching[self.random.randrange(len(approaching))]]

    def arms(self, link: Link) -> dict[int, tuple[fmpz, fmpz]]:
        """The directions in which an impulse at a link pushes its circles."""
        nx, ny = self.normal(link)
        return {link[0]: (-nx, -ny), link[1]: (nx, ny)} if link[1] < self.n else {link[0]: (nx, ny)}

    def kick(self, links: list[Link]) -> tuple[list[Link], bool]:
        """Impulses s >= 0 with G s + 2 u >= 0 and s (G s + 2 u) = 0; who pushes, and whether only these can."""
        bits, arms = self.bits, [self.arms(link) for link in links]
        speeds = [sum((self.vx[i] * x + self.vy[i] * y for i, (x, y) in arm.items()), fmpz(0)) >> bits for arm in arms]
        matrix = [[self.coupling(a, b) for b in arms] for a in arms]
        strengths, unique = self.solve(matrix, [-2 * u for u in speeds])
        for arm, s in zip(arms, strengths, strict=True):
            for i, (x, y) in arm.items():
                push = s * self.w[i] >> bits
                self.vx[i] += push * x >> bits
                self.vy[i] += push * y >> bits
        return [link for link, s in zip(links, strengths, strict=True) if self.sign(s) > 0], unique

    def coupling(self, a: dict[int, tuple[fmpz, fmpz]], b: dict[int, tuple[fmpz, fmpz]]) -> fmpz:
        shared = a.keys() & b.keys()
        return sum((self.w[i] * (a[i][0] * b[i][0] + a[i][1] * b[i][1]) for i in shared), fmpz(0)) >> 2 * self.bits

    def solve(self, matrix: list[list[fmpz]], wanted: list[fmpz]) -> tuple[list[fmpz], bool]:
        """The linear complementarity problem, by trying every set of pushing contacts, the whole first."""
        places = range(len(wanted))
        if len(wanted) > MOST_TOGETHER:
            raise TooLong(f"{len(wanted)} contacts at once are too many to try")
        unique = True
        for size in reversed(range(1, len(wanted) + 1)):
            for pushing in combinations(places, size):
                found = self.linear([[matrix[a][b] for b in pushing] for a in pushing], [wanted[a] for a in pushing])
                if found is None:
                    unique = unique and size < len(wanted)
                    continue
                if any(self.sign(s) < 0 for s in found):
                    continue
                strengths = [fmpz(0)] * len(wanted)
                for a, s in zip(pushing, found, strict=True):
                    strengths[a] = s
                others = (a for a in places if a not in pushing)
                if all(self.sign((_dot(matrix[a], strengths) >> self.bits) - wanted[a]) >= 0 for a in others):
                    return strengths, unique
        raise AssertionError("no impulses keep the contacts apart")

    def linear(self, matrix: list[list[fmpz]], wanted: list[fmpz]) -> list[fmpz] | None:
        """The solution of a symmetric positive semidefinite system; None if it is singular."""
        size = len(wanted)
        rows = [[*row, value] for row, value in zip(matrix, wanted, strict=True)]
        for k in range(size):
            pivot = rows[k]
            if self.sign(pivot[k]) == 0:  # semidefinite: the rest of the row is zero too
                return None
            for row in rows[k + 1 :]:
                factor = (row[k] << self.bits) // pivot[k]
                for c in range(k, size + 1):
                    row[c] -= factor * pivot[c] >> self.bits
        solution = [fmpz(0)] * size
        for k in reversed(range(size)):
            rest = rows[k][size] - (_dot(rows[k][k + 1 : size], solution[k + 1 :]) >> self.bits)
            solution[k] = (rest << self.bits) // rows[k][k]
        return solution

    def enter(self) -> list[Entry]:
        """The entries of the instant; with capture, what entered is taken out of play."""
        entries = []
        for i in range(self.n):
            if not self.free[i] or not (self.vx[i] or self.vy[i]):
                continue
            for k, (hx, hy, r) in enumerate(self.holes):
                dx, dy = self.x[i] - hx, self.y[i] - hy
                if self.sign((dx * dx + dy * dy - r * r) >> self.bits) == 0:
                    inward = (dx * self.vx[i] + dy * self.vy[i]) >> self.bits
                    if self.sign(inward) < 0:
                        entries.append(Entry(i, k, self.now))
        if self.scene.capture:
            for i in {entry.circle for entry in entries}:
                self.vx[i] = self.vy[i] = fmpz(0)
                self.free[i] = False
                self.links = [link for link in self.links if i not in link]
        return entries


def _dot(a: list[fmpz], b: list[fmpz]) -> fmpz:
    return sum((x * y for x, y in zip(a, b, strict=True)), fmpz(0))
