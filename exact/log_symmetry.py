"""What the form of a run's log proves: isometries of pasts and of scenes, the way back of a reversed run."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache
from math import inf
from typing import TypeAlias

from flint import arb, fmpq

from ..scenarios.lazy import frozen
from ..scenarios.scene import Scene
from .isometry import Isometry, Matrix, SceneData, Vector, from_vectors, minus, scene_data, turned
from .laws.formulas import wall_mirror
from .numbers.ball import LeavesField, field_ball
from .question import BeforeTime, Discriminant, Moment, Question, Sooner
from .replay.contact import AtWall, Body, Link, Pair, Touch, can_push, is_flat, is_pair
from .replay.refinable import Projection
from .replay.state import Flip, Go, Kick, Leave, Lift, Settle, Step, Take

# -- The causal past of a run as a graph: for each circle, the rounds of impulses that it took part in, in order.

FLIP, TAKE, LIFT, SETTLE = "flip", "take", "lift", "settle"


class Block:
    """What one round did to circles that hang together through movable circles: one node of the graph.

    Attributes:
        number: its place among all blocks, in the order of the log.
        instant: the number of the instant that it belongs to.
        kind: "" for impulses; FLIP for the negation of one circle's velocity; TAKE for its capture, which no isometry
            is known to map; LIFT and SETTLE for where a wall ends to carry it, or begins to, the latter with whether
            it slides, and has bounced.
        among: the contacts whose law it is (see `Kick`), or with the walls that carry it.
        links: those of them that push.
        places: for each movable circle in it, its place in that circle's row.
    """

    __slots__ = ("among", "instant", "kind", "links", "number", "places")

    def __init__(
        self, number: int, instant: int, among: frozenset[Touch], links: frozenset[Touch], kind: str = ""
    ) -> None:
        self.number = number
        self.instant = instant
        self.kind = kind
        self.among = among
        self.links = links
        self.places: dict[int, int] = {}


class Past:
    """The graph, brought up to the end of the log whenever it is asked for.

    Args:
        movable: for each circle, whether its mass is finite. A fixed circle has data and no past.
        steps: the log, which only grows.

    Attributes:
        rows: for each circle, its blocks in order.
    """

    def __init__(self, movable: Sequence[bool], steps: Sequence[Step]) -> None:
        self.movable = tuple(movable)
        self.n = len(self.movable)
        self.rows: list[list[Block]] = [[] for _ in self.movable]
        self._steps = steps
        self._done = 0
        self._starts, self._instants = array("q", [0]), array("q", [0])
        self._place = 0
        self._count = 0

    def begin(self, instant: int) -> None:
        """Told, before the steps of an instant, its number."""
        self._starts.append(len(self._steps))
        self._instants.append(instant)

    def catch_up(self) -> list[Block]:
        """Adds the steps that the log has gained; the blocks that they make."""
        blocks: list[Block] = []
        starts = self._starts
        while self._done < len(self._steps):
            while self._place + 1 < len(starts) and starts[self._place + 1] <= self._done:
                self._place += 1
            blocks += self._blocks(self._steps[self._done], self._instants[self._place])
            self._done += 1
        return blocks

    def _blocks(self, step: Step, instant: int) -> list[Block]:
        if isinstance(step, Go | Leave):
            return []
        if isinstance(step, Kick):
            if len(step.among) == 1:
                alone = frozenset(step.among)
                return [self._add(instant, alone, alone, step.among[0].circles)]
            pushing = set(step.links)
            return [self._add(instant, among, among & pushing, bodies) for bodies, among in self._apart(step.among)]
        if isinstance(step, Take | Lift):
            kind = TAKE if isinstance(step, Take) else LIFT
            return [self._add(instant, frozenset(), frozenset(), (step.body,), kind)]
        if isinstance(step, Settle):
            walls = (step.wall,) if step.other < 0 else (step.wall, step.other)
            among = frozenset(AtWall(step.body, wall) for wall in walls)
            kind = f"{SETTLE} {step.slides:d}{step.bounces:d}"
            return [self._add(instant, among, frozenset(), (step.body,), kind)]
        assert isinstance(step, Flip)
        movers = (i for i in range(self.n) if self.movable[i])
        return [self._add(instant, frozenset(), frozenset(), (i,), FLIP) for i in movers]

    def _add(
        self, instant: int, among: frozenset[Touch], links: frozenset[Touch], bodies: Iterable[int], kind: str = ""
    ) -> Block:
        block = Block(self._count, instant, among, links, kind)
        self._count += 1
        for i in bodies:
            if self.movable[i]:
                block.places[i] = len(self.rows[i])
                self.rows[i].append(block)
        return block

    def _apart(self, links: Iterable[Touch]) -> list[tuple[set[int], frozenset[Touch]]]:
        """Contacts that share movable circles, directly or through others; no block reaches beyond them."""
        groups: list[tuple[set[int], set[Touch]]] = []
        for link in links:
            bodies, mine = {i for i in link.circles if self.movable[i]}, {link}
            apart: list[tuple[set[int], set[Touch]]] = []
            for others, theirs in groups:
                if others & bodies:
                    bodies, mine = bodies | others, mine | theirs
                else:
                    apart.append((others, theirs))
            groups = [*apart, (bodies, mine)]
        return [(bodies, frozenset(mine)) for bodies, mine in groups]


# -- The way back of a reversed run: which of its events are those of the way out, in reverse.
#
# After the one reversal at time T, a circle retraces its way as long as each block that it takes part in undoes the
# last block of the way out that is not undone. An impulse is a linear map of velocities that is its own inverse at
# the same places, so, by induction over the blocks, the circle's flight is then that of the way out with its velocity
# negated, and every contact of two such circles comes at 2 T less the time at which it parted on the way out. What
# was one instant on the way out is one on the way back; what was earlier is later.


class Retrace:
    """What the way out tells of the way back.

    Args:
        past: the blocks, as they are logged.
        touching: the contacts at gap zero at time 0.

    Attributes:
        levels: after the reversal, for each circle: how many blocks of its way out are not undone yet; None once it
            has left its way. Empty before the reversal.
    """

    def __init__(self, past: Past, touching: Iterable[Touch]) -> None:
        self.past = past
        self.levels: list[int | None] = []
        self._gathered: dict[int, frozenset[Touch]] = {0: frozenset(touching)}
        self._grazes: set[tuple[Link, tuple[int, ...]]] = set()

    # -- noting

    def gathered(self, instant: int, links: Iterable[Touch]) -> None:
        """Notes what stands at gap zero at an instant of the way out, once its impulses are done."""
        if not self.levels:
            self._gathered[instant] = self._gathered.get(instant, frozenset()) | frozenset(links)

    def grazes(self, link: Link) -> bool:
        """Notes a pair proved to graze on its flights of now; tells whether that is new, and of use on the way back."""
        graze = link, self._heights(link)
        new = -1 not in graze[1] and graze not in self._grazes
        if new:
            self._grazes.add(graze)
        return new

    def note(self, blocks: Iterable[Block]) -> None:
        """Notes new blocks of the log."""
        for block in blocks:
            if block.kind == FLIP:
                self.levels = self.levels or [0] * self.past.n
                self.levels = [block.places.get(i, level) for i, level in enumerate(self.levels)]
            elif self.levels:
                self._undo(block)

    def _undo(self, block: Block) -> None:
        met = [self._undoing(i) for i in block.places]
        whole = met[0]
        if whole is not None and all(other is whole for other in met):
            same = whole.links == block.links and whole.places.keys() == block.places.keys()
            if same and not block.kind and not whole.kind:
                for i in block.places:
                    self.levels[i] = whole.places[i]
                return
        for i in block.places:
            self.levels[i] = None

    def _undoing(self, i: int) -> Block | None:
        """The last block of a circle's way out that is not undone yet."""
        level = self.levels[i]
        return self.past.rows[i][level - 1] if level else None

    # -- asking

    @property
    def home(self) -> bool:
        """Whether every circle has undone its whole way, so that the state is the first one with velocities negated."""
        movable = self.past.movable
        return bool(self.levels) and all(level == 0 for i, level in enumerate(self.levels) if movable[i])

    def sign(self, question: Question) -> int | None:
        """What the way out tells of a question asked on the way back; None if nothing."""
        if isinstance(question, Discriminant):
            return 0 if self._grazed(question.link) else None
        if not self.levels:
            return None
        if isinstance(question, Sooner):
            first, second = self._parted(question.first), self._parted(question.second)
            return None if first is None or second is None else (first < second) - (first > second)
        if isinstance(question, BeforeTime) and question.time is None:
            instant = self._parted(question.moment)
            return None if instant is None else -1 if instant > 0 else 0
        return None

    def _heights(self, link: Link) -> tuple[int, ...]:
        """How many blocks of the way out the two have behind them; -1 for a circle that has left it."""

        def height(i: int) -> int:
            if not self.levels:
                return len(self.past.rows[i])
            level = self.levels[i]
            return -1 if level is None else level

        return tuple(height(i) for i in link.circles)

    def _grazed(self, link: Link) -> bool:
        heights = self._heights(link)
        return -1 not in heights and (link, heights) in self._grazes

    def _parted(self, moment: Moment) -> int | None:
        """The instant of the way out at which the two of a contact, on their flights of now, stood at gap zero."""
        link = moment.link
        if not can_push(link):
            return None
        latest, met = 0, self._gathered[0]
        for i in link.circles:
            if self.past.movable[i]:
                level = self.levels[i]
                if level is None:
                    return None
                if level:
                    block = self.past.rows[i][level - 1]
                    if block.instant > latest:
                        latest, met = block.instant, self._gathered.get(block.instant, frozenset())
                    if block.instant == latest:
                        met = met | block.among
        return latest if link in met else None


# -- Proofs that a number of a run is zero, from the form of its past: isometries of logged histories.
#
# A number of a run is a log, its logged causal past, on data, the circles and walls at time 0. If an isometry g of
# the plane maps the one past to the other, data and blocks, it maps the flights that come of it to each other. The
# argument, by induction over the blocks of the log (`Past`):
#
# 1. Data: g maps place, velocity, radius and mass of each circle in the past to those of its image, and each wall
#    and fixed circle to its image. So it maps the first flights.
# 2. A block's time follows from the flights before it: each of its contacts approaches at the block's instant, at
#    gap zero. The gap of two straight flights is a convex quadratic in time (of a wall, linear), and has one zero at
#    which it falls; under gravity it is the first such zero since both flights began, as one before would be a block.
#    So the times of a block and of its image are equal, whatever the log says of clocks.
# 3. The velocities after a block follow from the flights at its time and from `among`, by laws that know no direction.
#    Circles that share no movable circle do not couple, so a block is one connected part of a round; a fixed circle
#    has data and no past, and a stranger that hits it changes nothing.
# 4. A reversal's instant is one number, shared by both pasts.
# 5. That a wall begins to carry a circle, or two do, falls on the instant of the block before it in the circle's row,
#    or on time 0: a circle that was let fall is pushed at that instant, or is carried again, its way as if it had been
#    all along. How it goes on follows from its flight, and from the walls that g maps with their pull.
#
# So if g maps the circles and walls of one meeting to those of another, and their pasts, the two fall on one instant:
# at any depth, under any tie policy, whatever the rest of the scene is like. A past that is mapped to itself makes
# zero what g negates: the velocity along a wall's normal, if g is the mirror parallel to the wall through the
# circle's centre; the relative velocity of two circles, if g is the shift from one to the other.
#
# Each isometry remembers which blocks it maps, and the log only grows, so each block is compared once per isometry.

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
        assert self._data is not None
        if self.same(first, second):
            return True
        known, image = list(self._known.values()), self._data.one_of(second)
        if any(g.link(first) == image and self._all_follow(g, first) for g in known):
            return True
        if (first, second) not in self._candidates:
            self._candidates[first, second] = self._between(first, second)
        return any(g.link(first) == image and self._all_follow(g, first) for g in self._candidates[first, second])

    def same(self, first: Link, second: Link) -> bool:
        """See `Form`."""
        assert self._data is not None
        if is_flat(first) and is_flat(second) and first.circle == second.circle:
            return self._data.line_of(first) == self._data.line_of(second)
        return self._data.one_of(first) == self._data.one_of(second)

    def _all_follow(self, g: Isometry, link: Link) -> bool:
        return all(self.follows(g, i) for i in link.circles)

    def alike(self, link: Link) -> bool:
        """See `Form`."""
        if is_pair(link):
            return self._fixes(IDENTITY, link.a, link.b)
        return is_flat(link) and self._along(link.circle, link.wall)  # n.v is zero, and so is n.u

    def _along(self, i: int, wall: int) -> bool:
        """Whether the mirror parallel to a wall through a circle's centre keeps the circle and its past."""
        assert self._data is not None
        if self._data.paces[wall] != 0:
            return False
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
        if is_pair(second):
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
        assert self._data is not None
        images: set[Link | None] = {g.link(link) for link in a.among}
        if len(a.among) != len(b.among) or images != set(map(self._data.one_of, b.among)):
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


# -- Mirrors and rotations that map a scene to itself, found exactly.
#
# They are candidates for isometries that map the past of a circle to itself (`symmetry.held`), and what `--symmetric`
# asks for. That a history keeps a symmetry is proved on its log (`symmetry.log_symmetry`).

NEAR = 1e-6
"""How far, relatively, an image may be from its target in doubles and still be looked at exactly; it only spares
exact work on candidates that are plainly none."""


Likely: TypeAlias = tuple[int, bool, int, bool]
"""A circle, whether by its velocity (else by its place), the circle whose velocity or place is its image; mirror?"""


@frozen
class Symmetry:
    """An isometry that maps the scene to itself.

    Attributes:
        matrix: its linear part (a, b, c, d): (x, y) becomes (a x + b y, c x + d y), about `centre`.
        centre: a point that it leaves in place, the mean of the circles' centres.
        circles: for each circle, the index of its image.
        walls, sides: for each wall, and each side of an arc, the index of its image.
        mirror: whether it is a reflection (else a rotation).
    """

    matrix: Matrix
    centre: Vector
    circles: tuple[int, ...]
    walls: tuple[int, ...]
    sides: tuple[int, ...]
    mirror: bool


@lru_cache(maxsize=8)
def symmetries(scene: Scene) -> tuple[Symmetry, ...]:
    """All mirrors and rotations of a scene, without the identity; none if its numbers are too deep to tell.

    Of a scene with segments, polygons or arcs those of its `surfaces` are to be asked for: of itself none are given.

    >>> from truebreak.scenarios import Circle, Scene
    >>> [s.circles for s in symmetries(Scene([Circle(0, 3, vx=1), Circle(0, -3, vx=1), Circle(9, 0, vx=-1)]))]
    [(1, 0, 2)]
    """
    alone = len(scene.circles) < 2 and not (scene.walls or scene.arc_sides)
    if scene.surfaces is not scene or alone:
        return ()
    rough = _Rough(scene)
    if not rough.usable:
        return ()
    wanted = list(rough.candidates())
    try:
        return tuple(_exactly(scene, wanted)) if wanted else ()
    except LeavesField:
        return ()


class _Rough:
    """The scene in doubles: picks the isometries worth an exact check."""

    def __init__(self, scene: Scene) -> None:
        try:
            self.rows: list[tuple[float, ...]] = [
                (float(c.x), float(c.y), float(c.vx), float(c.vy), float(c.r), float(c.inverse_mass))
                for c in scene.circles
            ]
        except OverflowError:
            self.usable = False
            return
        n = len(self.rows)
        cx, cy = sum(row[0] for row in self.rows) / n, sum(row[1] for row in self.rows) / n
        self.rows = [(x - cx, y - cy, *rest) for x, y, *rest in self.rows]
        self.size = max(abs(value) for row in self.rows for value in row[:2]) or 1.0
        self.speed = max(abs(value) for row in self.rows for value in row[2:4]) or 1.0
        self.usable = True

    def candidates(self) -> Iterator[Likely]:
        """Isometries that nearly fit."""
        rows = self.rows
        reference = max(range(len(rows)), key=lambda i: abs(rows[i][0]) + abs(rows[i][1]))
        by_velocity = abs(rows[reference][0]) + abs(rows[reference][1]) < NEAR * self.size or len(rows) == 1
        if by_velocity:
            reference = max(range(len(rows)), key=lambda i: abs(rows[i][2]) + abs(rows[i][3]))
            if rows[reference][2] == 0.0 == rows[reference][3]:
                return
        at = 2 if by_velocity else 0
        ux, uy = rows[reference][at : at + 2]
        square = ux * ux + uy * uy
        if not 0.0 < square < inf:
            return
        for j, row in enumerate(rows):
            if row[4:] != rows[reference][4:]:
                continue
            wx, wy = row[at : at + 2]
            if abs(wx * wx + wy * wy - square) > NEAR * square:
                continue
            for mirror in (False, True):
                if not mirror and j == reference:
                    continue
                c = (ux * wx - uy * wy if mirror else ux * wx + uy * wy) / square
                s = (ux * wy + uy * wx if mirror else ux * wy - uy * wx) / square
                if self._fits((c, s if mirror else -s, s, -c if mirror else c)):
                    yield reference, by_velocity, j, mirror

    def _fits(self, m: tuple[float, float, float, float]) -> bool:
        a, b, c, d = m
        near, slow = NEAR * self.size, NEAR * self.speed
        for x, y, vx, vy, r, w in self.rows:
            gx, gy, hx, hy = a * x + b * y, c * x + d * y, a * vx + b * vy, c * vx + d * vy
            if not any(
                abs(gx - p) <= near and abs(gy - q) <= near and abs(hx - s) <= slow and abs(hy - t) <= slow
                for p, q, s, t, r2, w2 in self.rows
                if r2 == r and w2 == w
            ):
                return False
        return True


def _exactly(scene: Scene, wanted: Iterable[Likely]) -> Iterator[Symmetry]:
    """Those of the candidates that map the scene to itself."""
    data = scene_data(scene)
    x, y = (sum((place[k] for place in data.places[1:]), start=data.places[0][k]) / data.n for k in (0, 1))
    centre = (x, y)
    arms = [minus(place, centre) for place in data.places]
    for circle, by_velocity, image, mirror in wanted:
        vectors = data.speeds if by_velocity else arms
        matrices = list(from_vectors([vectors[circle]], [vectors[image]]))
        if not matrices:
            continue
        matrix = matrices[mirror]
        g = Isometry(data, matrix, minus(centre, turned(matrix, centre)))
        if (
            (circles := _all_apart(g.circle, data.n)) is not None
            and (walls := _all_apart(g.wall, len(data.walls))) is not None
            and (sides := _all_apart(g.arc, len(data.arcs))) is not None
            and (not scene.capture or all(g.pocket(k) is not None for k in range(len(data.pockets))))
        ):
            yield Symmetry(matrix, centre, circles, walls, sides, mirror)


def _all_apart(image: Callable[[int], int | None], count: int) -> tuple[int, ...] | None:
    """The images of so many things, if each has one of its own; the first without one is the last looked at."""
    found: dict[int, None] = {}
    for k in range(count):
        at = image(k)
        if at is None or at in found:
            return None
        found[at] = None
    return tuple(found)


# -- Circles that an isometry of their own past holds to a line or a point.

AXIS_BITS = 256
"""Precision of a mirror line's place: where it is not exact in so many bits, circles are projected."""


class FixedProjections:
    """Tells, of a circle, the projection on what the symmetries of its past leave in place.

    The mirrors and rotations of the scene at time 0 are the candidates; that one maps a circle's past to itself is
    proved on the log each time (`LogSymmetry`), so neither an order chosen nor a flaw elsewhere makes it wrong. The
    circle's place and velocity then lie on the mirror line, or at the centre: in the image of the projection, which
    is the mean of the linear parts, those of a group.
    """

    def __init__(self, scene: Scene, log: LogSymmetry) -> None:
        self._log = log
        self._own: dict[int, list[tuple[Symmetry, Isometry]]] = {}
        self._means: dict[tuple[int, ...], Projection] = {}
        for symmetry in symmetries(scene):
            isometry = log.isometry_about(symmetry.matrix, symmetry.centre)
            for i, image in enumerate(symmetry.circles):
                if image == i and isometry is not None:
                    self._own.setdefault(i, []).append((symmetry, isometry))

        self._axes = {i: axis for i, own in self._own.items() if (axis := _axis(own)) is not None}

    def __bool__(self) -> bool:
        """Whether there is any circle that a symmetry of the scene leaves in place."""
        return bool(self._own)

    def stands(self, body: Body[arb]) -> bool:
        """Whether a body's balls have it exactly on its one mirror line, along an axis: there is nothing to hold."""
        axis = self._axes.get(body.index)
        if axis is None:
            return False
        (level, offset), flight = axis, body.flight
        if level:
            return flight.vy.is_zero() and (flight.y - offset).is_zero()
        return flight.vx.is_zero() and (flight.x - offset).is_zero()

    def __call__(self, i: int) -> Projection | None:
        """The projection for a circle, or None if nothing is known to hold it."""
        own = self._own.get(i)
        if own is None:
            return None
        kept = [symmetry for symmetry, isometry in own if self._log.follows(isometry, i)]
        if not kept:
            return None
        key = tuple(id(symmetry) for symmetry in kept)
        if key not in self._means:
            self._means[key] = _mean(kept)
        return self._means[key]


def _axis(own: list[tuple[Symmetry, Isometry]]) -> tuple[bool, arb] | None:
    """Whether the one mirror of a circle is level (else it may be upright), and the line's other coordinate."""
    (symmetry, _), *more = own
    if more or symmetry.matrix not in {(1, 0, 0, -1), (-1, 0, 0, 1)}:
        return None
    level = symmetry.matrix[0] == 1
    return level, field_ball(symmetry.centre[1 if level else 0], AXIS_BITS)


def _mean(kept: list[Symmetry]) -> Projection:
    """The mean of linear parts and the identity, and the centre."""
    totals = [sum((s.matrix[k] for s in kept[1:]), start=kept[0].matrix[k] + (k in (0, 3))) for k in range(4)]
    return tuple(total / (len(kept) + 1) for total in totals), kept[0].centre
