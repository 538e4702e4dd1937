"""Proofs that a number of a run is zero, from the form of its past: isometries of logged histories.

A number of a run is a log, its logged causal past, on data, the circles and walls at time 0. If an isometry g
of the plane maps the one past to the other, data and blocks, it maps the flights that come of it to each other. The
argument, by induction over the blocks of the log (`Past`):

1. Data: g maps place, velocity, radius and mass of each circle in the past to those of its image, and each wall
   and fixed circle to its image. So it maps the first flights.
2. A block's time follows from the flights before it: each of its contacts approaches at the block's instant, at
   gap zero. The gap of two straight flights is a convex quadratic in time (of a wall, linear), and has one zero at
   which it falls. So the times of a block and of its image are equal, whatever the log says of clocks.
3. The velocities after a block follow from the flights at its time and from `among`, by laws that know no direction.
   Circles that share no movable circle do not couple, so a block is one connected part of a round; a fixed circle
   has data and no past, and a stranger that hits it changes nothing.
4. A reversal's instant is one number, shared by both pasts.

So if g maps the circles and walls of one meeting to those of another, and their pasts, the two fall on one instant:
at any depth, under any tie policy, whatever the rest of the scene is like. A past that is mapped to itself makes
zero what g negates: the velocity along a wall's normal, if g is the mirror parallel to the wall through the
circle's centre; the relative velocity of two circles, if g is the shift from one to the other.

Each isometry remembers which blocks it maps, and the log only grows, so each block is compared once per isometry.
"""

from __future__ import annotations

from flint import fmpq

from ...scenarios.scene import Scene
from ..laws.formulas import wall_mirror
from ..numbers.field import LeavesField
from ..predicates.question import Question
from ..replay.contact import AtWall, Link, Pair
from .isometry import Isometry, Matrix, SceneData, Vector, from_vectors, minus, scene_data, turned
from .past import TAKE, Block, Past

IDENTITY: Matrix = (fmpq(1), fmpq(0), fmpq(0), fmpq(1))

MOST_ISOMETRIES = 256
"""Isometries remembered for one scene. A scene of n circles that is symmetric has 2 n at most; pasts of single
circles among strangers may have more, of which those found first are kept."""


class LogSymmetry:
    """Answers whether the form of the past proves a number zero.

    Args:
        scene: the scene that runs.
        past: its blocks, as they are logged.
    """

    def __init__(self, scene: Scene, past: Past) -> None:
        self.past = past
        self._scene = scene
        self._data: SceneData | None = None
        self._usable = True
        self._known: dict[tuple[object, ...], Isometry] = {}
        self._candidates: dict[tuple[Link, Link], list[Isometry]] = {}

    def proves_zero(self, question: Question) -> bool:
        """Whether the number asked about is zero because of the form of its past; False says nothing."""
        return self._ready() and question.is_zero_by(self)

    def follows(self, g: Isometry, i: int) -> bool:
        """Whether g maps all that circle i depends on to all that its image depends on."""
        k = g.circle(i)
        if k is None:
            return False
        if not self.past.movable[i]:
            return True
        mine, theirs = self.past.rows[i], self.past.rows[k]
        if len(mine) != len(theirs):
            return False
        return not mine or self._matches(g, mine[-1], theirs[-1])

    def _ready(self) -> bool:
        """Whether the scene's data are to be had in its field; they are read when first needed."""
        if self._data is None and self._usable:
            try:
                self._data = scene_data(self._scene)
            except LeavesField:
                self._usable = False
        return self._usable

    def isometry_about(self, matrix: Matrix, centre: Vector) -> Isometry | None:
        """The isometry of a linear part that leaves a centre in place; None for a scene without a field."""
        return self.isometry(matrix, centre, centre) if self._ready() else None

    def isometry(self, matrix: Matrix, point: Vector, image: Vector) -> Isometry:
        """The isometry of a linear part that takes a point to an image, with what is known of it if it has been met."""
        assert self._data is not None
        made = Isometry(self._data, matrix, minus(image, turned(matrix, point)))
        if len(self._known) >= MOST_ISOMETRIES:
            return self._known.get(made.key, made)
        return self._known.setdefault(made.key, made)

    # -- the questions

    def together(self, first: Link, second: Link) -> bool:
        """See `Form`."""
        known = list(self._known.values())
        if any(g.link(first) == second and self._all_follow(g, first) for g in known):
            return True
        if (first, second) not in self._candidates:
            self._candidates[first, second] = self._between(first, second)
        return any(g.link(first) == second and self._all_follow(g, first) for g in self._candidates[first, second])

    def _all_follow(self, g: Isometry, link: Link) -> bool:
        return all(self.follows(g, i) for i in link.circles)

    def alike(self, link: Link) -> bool:
        """See `Form`."""
        if isinstance(link, Pair):
            return self._fixes(IDENTITY, link.a, link.b)
        return isinstance(link, AtWall) and self._along(link.circle, link.wall)

    def _along(self, i: int, wall: int) -> bool:
        """Whether the mirror parallel to a wall through a circle's centre keeps the circle and its past."""
        assert self._data is not None
        _, (nx, ny) = self._data.walls[wall]
        xx, xy, yy = wall_mirror(nx, ny, nx * nx + ny * ny)
        return self._fixes((xx, xy, xy, yy), i, i)

    def _fixes(self, matrix: Matrix, i: int, j: int) -> bool:
        """Whether the isometry of this linear part that takes centre i to centre j maps past i to past j."""
        assert self._data is not None
        g = self.isometry(matrix, self._data.places[i], self._data.places[j])
        return g.circle(i) == j and self.follows(g, i)

    # -- isometries between two meetings

    def _between(self, first: Link, second: Link) -> list[Isometry]:
        """The few isometries that map the data of one meeting to those of another."""
        found = self._mapping(first, second)
        if isinstance(second, Pair):
            found += self._mapping(first, Pair(second.b, second.a))
        return found

    def _mapping(self, first: Link, second: Link) -> list[Isometry]:
        """Those that take the first of one contact to that of another, and the second to the second."""
        data, i, k = self._data, first[0], second[0]
        assert data is not None
        if data.kind_of(first) != data.kind_of(second):
            return []
        matrices = from_vectors(data.vectors(first), data.vectors(second))
        return [self.isometry(matrix, data.places[i], data.places[k]) for matrix in matrices]

    # -- blocks

    def _matches(self, g: Isometry, block: Block, image: Block) -> bool:
        """Whether g maps a block and all that it depends on to another and all that that depends on."""
        known = g.matched
        stack = [(block, image)]
        while stack:
            a, b = stack[-1]
            if a.number in known:
                stack.pop()
                continue
            before = self._before(g, a, b)
            if before is None or any(known.get(p.number) is False for p, _ in before):
                known[a.number] = False
                continue
            unknown = [pair for pair in before if pair[0].number not in known]
            if unknown:
                stack += unknown
            else:
                known[a.number] = True
        return known[block.number]

    def _before(self, g: Isometry, a: Block, b: Block) -> list[tuple[Block, Block]] | None:
        """The blocks just before two blocks, in pairs; None if g does not map the one block to the other."""
        if a.kind != b.kind or a.kind == TAKE or len(a.places) != len(b.places):
            return None
        images: set[Link | None] = {g.link(link) for link in a.among}
        if images != {*b.among}:
            return None
        rows = self.past.rows
        found: list[tuple[Block, Block]] = []
        for i, place in a.places.items():
            k = g.circle(i)
            if k is None or b.places.get(k) != place:
                return None
            if place:
                found.append((rows[i][place - 1], rows[k][place - 1]))
        return found
