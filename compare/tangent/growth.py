"""How small displacements grow along a run: its tangent map, impact by impact, in doubles or in balls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, log2, nextafter
from typing import TYPE_CHECKING, Any

from flint import arb, arb_mat

from ...exact.exact_motion import motion_of
from ...exact.laws.formulas import damped, pair_approach, wall_approach, wall_bounce
from ...exact.laws.tangent_formulas import fall_turn, pair_tangent, pair_tangent_blocks
from ...exact.numbers import ball
from .impacts import LEAST_BITS, Impact, NoTangentMap, Real, as_doubles, impacts, moving

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory

RESCALED = 2.0**256
"""Displacements in doubles that are larger than this are scaled down, and the scale is noted: a double ends at
2**1024."""


class Displacements:
    """Displacements of the circles that can move, carried along a run; all stand at one time.

    Args:
        scene: what ran.
        columns: k displacements of x, y, vx, vy at a time: an array of shape (moving circles, 4, k), of doubles or of
            objects; or, for each moving circle, four rows (1 by k) of balls, as `unit_rows` makes them.
        time: where they stand; by default 0.

    Attributes:
        scale: log2 of what they have been divided by; other than in doubles always 0.
        time: where they stand, in their own kind of number.
    """

    def __init__(self, scene: Scene, columns: Any, time: Real | None = None) -> None:
        self._rows: Any = [list(own) for own in columns] if isinstance(columns, list) else columns.copy()
        self.scale = 0.0
        self.in_doubles = getattr(columns, "dtype", object) in ("float64",)
        start = 0.0 if self.in_doubles else arb(0)
        self.time: Real = start if time is None else time
        self._flown: list[Real] = [self.time] * len(self._rows)
        self._row: dict[int | None, int] = {i: row for row, i in enumerate(moving(scene))}
        number = float if self.in_doubles else ball.constant
        self._share: Any = None if scene.elastic else number((scene.restitution + 1) / 2)
        self._pull: Any = None if scene.gravity is None else (number(scene.gravity[0]), number(scene.gravity[1]))

    @property
    def columns(self) -> Any:
        """The displacements at `time`, divided by 2**scale."""
        if self.in_doubles:
            self._fly_together()
            return self._rows
        for row in range(len(self._rows)):
            self._of(row)
        return self._rows

    def _fly_together(self) -> None:
        """Carries all of them, in doubles, to `time` at once: the same products and sums as one by one."""
        import numpy as np

        late = [row for row, flown in enumerate(self._flown) if flown is not self.time]
        if not late:
            return
        waits = np.array([float(self.time - self._flown[row]) for row in late])[:, None, None]
        self._rows[late, :2] += waits * self._rows[late, 2:]
        for row in late:
            self._flown[row] = self.time

    def of(self, circle: int) -> Any:
        """The displacements of one circle that can move, at `time`, divided by 2**scale."""
        return self._of(self._row[circle])

    @columns.setter
    def columns(self, columns: Any) -> None:
        self._rows, self._flown = columns, [self.time] * len(columns)

    def fly(self, time: Real) -> None:
        """Carries them to a time, in flight; each circle's are moved when they are next looked at.

        Gravity bends what is displaced as it bends what is not.
        """
        self.time = time

    def through(self, struck: Sequence[Impact]) -> None:
        """Carries them through the impacts of one event, which must be the next."""
        for impact in struck:
            hit = in_doubles(impact) if self.in_doubles else impact
            self.fly(hit.time)
            if hit.b is None:
                self._bounce(self._of(self._row[hit.a]), hit)
            else:
                self._collide(hit)
        if self.in_doubles:
            self._rescale()

    def _bounce(self, own: Any, hit: Impact) -> None:
        square = hit.reach * hit.reach
        places = wall_bounce(own[0], own[1], hit.dx, hit.dy, square)
        speeds = wall_bounce(own[2], own[3], hit.dx, hit.dy, square)
        if self._pull is not None:
            gx, gy = self._pull
            approach, pull = wall_approach(hit.vx, hit.vy, hit.dx, hit.dy), wall_approach(gx, gy, hit.dx, hit.dy)
            fallen = fall_turn(hit.dx, hit.dy, square, approach, pull, own[0], own[1])
            speeds = speeds[0] + fallen[0], speeds[1] + fallen[1]
        for k, after in enumerate((*places, *speeds)):
            own[k] = after if self._share is None else damped(own[k], after, self._share)

    def _collide(self, hit: Impact) -> None:
        a, b = self._of(self._row.get(hit.a)), self._of(self._row.get(hit.b))
        between = [second - first for first, second in zip(a, b, strict=True)]
        tangent = _by_blocks if isinstance(self._rows, list) else pair_tangent
        gain = tangent(hit.dx, hit.dy, hit.vx, hit.vy, hit.reach, hit.wa, hit.wb, *between)
        if self._pull is not None and (hit.a in self._row) != (hit.b in self._row):  # one of them falls, one stands
            gx, gy = self._pull if hit.b in self._row else (-self._pull[0], -self._pull[1])
            approach, pull = pair_approach(hit.dx, hit.dy, hit.vx, hit.vy), pair_approach(hit.dx, hit.dy, gx, gy)
            weight = hit.reach * hit.reach * (hit.wa + hit.wb)
            fallen = fall_turn(hit.dx, hit.dy, weight, approach, pull, between[0], between[1])
            gain = gain[0], gain[1], gain[2] + fallen[0], gain[3] + fallen[1]
        if self._share is not None:
            gain = tuple(part * self._share for part in gain)
        for k in range(4):
            a[k], b[k] = a[k] - hit.wa * gain[k], b[k] + hit.wb * gain[k]

    def _of(self, row: int | None) -> Any:
        """The displacements of a circle, flown to `time`; a fixed one has none."""
        if row is None:
            return [own * 0 for own in self._rows[0]]
        own = self._rows[row]
        if self._flown[row] is not self.time:
            late, self._flown[row] = self.time - self._flown[row], self.time
            own[0], own[1] = own[0] + late * own[2], own[1] + late * own[3]
        return own

    def _rescale(self) -> None:
        largest = float(abs(self._rows).max(initial=0.0))
        if largest > RESCALED:
            self._rows /= largest
            self.scale += log2(largest)

    @property
    def matrix(self) -> Any:
        """Of 4 * moving circles rows and k columns: an array, or a matrix of balls."""
        if isinstance(self.columns, list):
            return arb_mat([row.entries() for own in self.columns for row in own])
        return self.columns.reshape(-1, self.columns.shape[-1])


def _by_blocks(dx: Real, dy: Real, vx: Real, vy: Real, reach: Real, wa: Real, wb: Real, *rows: Any) -> tuple[Any, ...]:
    """`pair_tangent` of rows of balls, by its matrix: twelve products with a row in place of nineteen."""
    px, py, qx, qy = rows
    approach, cross, square = dx * vx + dy * vy, dx * vy - dy * vx, vx * vx + vy * vy
    share = -2 / (reach * reach * (wa + wb))
    bxx, bxy, byy, axx, axy, ayx, ayy = pair_tangent_blocks(dx, dy, approach, cross, square, share)
    places = px * bxx + py * bxy, px * bxy + py * byy
    return *places, px * axx + py * axy + qx * bxx + qy * bxy, px * ayx + py * ayy + qx * bxy + qy * byy


def in_doubles(impact: Impact) -> Impact:
    """An impact in doubles."""
    return Impact(float(impact.time), *as_doubles(impact), impact.wall)


def unit_displacements(scene: Scene) -> NDArray[np.float64]:
    """Shape (moving circles, 4, 4 * moving circles): one for each coordinate that can be displaced."""
    import numpy as np

    count = len(moving(scene))
    return np.eye(4 * count).reshape(count, 4, 4 * count)


def unit_rows(scene: Scene) -> list[list[arb_mat]]:
    """The same in balls: for each moving circle four rows."""
    size = 4 * len(moving(scene))
    rows = [arb_mat([[int(k == place) for k in range(size)]]) for place in range(size)]
    return [rows[place : place + 4] for place in range(0, size, 4)]


def error_growth(trajectory: Trajectory, events: int) -> float | None:
    """Bits an event by which the largest displacement grows over the first `events` of a run.

    The norm of the tangent map; its logarithm over the number of events tends to the largest Lyapunov exponent.
    None where there is no tangent map (see `impacts`), no event, or no NumPy.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, "1/2")])
    >>> round(error_growth(ExactEngine().run(scene), 1), 3)
    2.003
    """
    if not 0 < events <= len(trajectory.events):
        return None
    try:
        import numpy as np
    except ModuleNotFoundError:
        return None
    try:
        struck = impacts(trajectory, events)
    except NoTangentMap:
        return None
    carried = Displacements(trajectory.scene, unit_displacements(trajectory.scene))
    for event in struck:
        carried.through(event)
    gram = (
        carried.matrix.T @ carried.matrix
    )  # its largest eigenvalue, to a double; singular values take a hundred times as long
    return (carried.scale + log2(float(np.linalg.eigvalsh(gram)[-1])) / 2) / events


@dataclass(frozen=True)
class CertifiedGrowth:
    """The norm of a run's tangent map from time 0 to one of its events, enclosed.

    Attributes:
        events: how many events it leads through.
        low, high: log2 of the norm lies between them: bits by which the displacement that grows most has grown.
        bits: the precision of the balls that told.
    """

    events: int
    low: float
    high: float
    bits: int


TOLD_BITS = 40
"""Accuracy of the norm's square at which an enclosure is told: beyond what its doubles show."""

BEYOND_BITS = 128
"""Bits that displacements are carried with beyond those to which the time of an impact is known: of a long run the bits
that are known fall from event to event, and what is computed with more tells nothing."""

POWER = 5
"""Squarings of the Gram matrix: the trace of its power 2**POWER exceeds the largest entry of its spectrum by a factor
of its size at most, and so the norm by the size to the power of 2**-(POWER + 1)."""


def certified_growth(
    trajectory: Trajectory, events: int, struck: Sequence[Sequence[Impact]] | None = None
) -> CertifiedGrowth:
    """Encloses the norm of the tangent map from time 0 to just after an event, along a certified run.

    The product of the maps of all flights and impacts is taken in balls along the run's log, with as many bits as it
    takes; what comes out is proved. Norms are Euclidean, over positions and velocities in the scene's own units.

    With G the product's Gram matrix and s its norm, trace(G**k) lies between s**(2 k) and size * s**(2 k); and no
    direction grows by more than s.

    Args:
        struck: the impacts of these events, as `impacts` gives them, where they are there already.

    Raises:
        NoTangentMap: where there is none (see `impacts`), for a run of floats, and for one with no such event.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> told = certified_growth(ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, "1/2")])), 1)
    >>> round(told.low, 3), round(told.high, 3)
    (2.003, 2.003)
    """
    if not 0 < events <= len(trajectory.events):
        raise NoTangentMap(f"events = {events}: the run has {len(trajectory.events)}")
    motion = motion_of(trajectory)
    if motion is None or not trajectory.certified:
        raise NoTangentMap("growth is certified along a certified run only; run the exact engine")
    bits = motion.log.lost + LEAST_BITS
    while True:
        with ball.precision(bits):
            carried = Displacements(trajectory.scene, unit_rows(trajectory.scene))
            for event in impacts(trajectory, events, bits) if struck is None else struck:
                known = _known_bits(event)
                ball.use_bits(min(bits, known + BEYOND_BITS) if known > 0 else bits)
                carried.through(event)
            struck = None  # where that does not suffice it takes more bits
            low, high = _norm_squared(carried.matrix)
            if min(low.rel_accuracy_bits(), high.rel_accuracy_bits()) >= TOLD_BITS:
                two = arb(4).log()
                ends = float((low.log() / two).lower()), float((high.log() / two).upper())
                return CertifiedGrowth(events, nextafter(ends[0], -1e9), nextafter(ends[1], 1e9), bits)
        bits *= 2


def _known_bits(struck: Sequence[Impact]) -> int:
    """To how many bits the time of an event is known; its impacts are in balls."""
    return max((arb(impact.time).rel_accuracy_bits() for impact in struck), default=0)


def _norm_squared(product: arb_mat) -> tuple[arb, arb]:
    """Bounds of the largest singular value's square: below by the growth of a direction, above by a trace.

    The longest column of a high power of the Gram matrix points to where the product stretches most.
    """
    power = product.transpose() * product
    for _ in range(POWER):
        power = power * power
    longest = max(range(power.ncols()), key=lambda k: float(power[k, k].mid().log()) if power[k, k] > 0 else -inf)
    vector = arb_mat([[(power[k, longest] / power[longest, longest]).mid()] for k in range(power.nrows())])
    grown = product * vector
    low = (grown.transpose() * grown)[0, 0] / (vector.transpose() * vector)[0, 0]
    return low, power.trace().root(2**POWER)


# ----------------------------------------
# What contacts of one circle that push together do to displacements: the derivative of one round of impulses.


@dataclass(frozen=True)
class Pushed:
    """A round of impulses upon displaced circles.

    Attributes:
        columns: shape (circles, 4, k), the displacements after it.
        waits: shape (contacts, k): by how much each displacement delays each contact.
    """

    columns: NDArray[np.float64]
    waits: NDArray[np.float64]


def push_together(
    columns: NDArray[np.float64],
    row: Mapping[int, int],
    weights: NDArray[np.float64],
    struck: Sequence[Impact],
    turn: float = 2.0,
    gravity: tuple[float, float] = (0.0, 0.0),
) -> Pushed | None:
    """Displacements after a round in which contacts push together, each at its own displaced time.

    With J v for the speeds at which the contacts open, and W for the inverse masses, the round adds W J' s to the
    velocities, where J W J' s = -(1 + e) J v. Its derivative, to the first order: J turns with the lines of centres,
    as they are when each contact comes, and v changes with its displacement; a contact that comes later by tau leaves
    what it pushes tau times the change of velocity behind, and at a wall finds it to have fallen for so much longer.
    One contact alone gives `pair_tangent`, or `fall_turn`.

    Args:
        columns: shape (circles, 4, k), displacements at the instant, of the circles that can move.
        row: the row of each of those circles, by index.
        weights: inverse masses, by row.
        struck: the contacts, all with the velocities that the round finds.
        turn: 1 + e, e the restitution, above 0.
        gravity: along x and along y.

    Returns:
        None where the impulses are not unique: then they have no derivative.
    """
    import numpy as np

    count, errors = len(weights), columns.shape[2]
    lines, turned = np.zeros((len(struck), count, 2)), np.zeros((len(struck), 2, errors))
    opening, waits, fallen = np.zeros(len(struck)), np.zeros((len(struck), errors)), np.zeros((len(struck), errors))
    for k, hit in enumerate(struck):
        a, b, reach = row.get(hit.a), None if hit.b is None else row.get(hit.b), float(hit.reach)
        normal, speed = np.array([float(hit.dx), float(hit.dy)]) / reach, np.array([float(hit.vx), float(hit.vy)])
        between = np.zeros((2, errors))
        for place, side in ((a, 1.0 if hit.b is None else -1.0), (b, 1.0)):
            if place is not None:
                lines[k, place] += side * normal
                between += side * columns[place, :2]
        opening[k] = normal @ speed
        waits[k] = -(normal @ between) / opening[k]
        if hit.b is not None:
            turned[k] = (between + speed[:, None] * waits[k]) / reach
        else:
            fallen[k] = float(normal @ gravity) * waits[k]
    system = np.einsum("kmx,m,lmx->kl", lines, weights, lines)
    if np.linalg.matrix_rank(system) < len(struck):
        return None
    strengths = -turn * np.linalg.solve(system, opening)
    kicks = np.einsum("m,kmx,k->kmx", weights, lines, strengths)
    aside = np.zeros((count, 2, errors))
    faster = np.einsum("kmx,mxe->ke", lines, columns[:, 2:]) + fallen
    for k, hit in enumerate(struck):
        for name, side in ((hit.a, -1.0), (hit.b, 1.0)):
            place = None if name is None or hit.b is None else row.get(name)
            if place is not None:
                aside[place] += side * weights[place] * strengths[k] * turned[k]
                faster[k] += side * kicks[:, place].sum(axis=0) @ turned[k] / turn
        faster[k] += np.array([float(hit.vx), float(hit.vy)]) @ turned[k]
    stronger = np.linalg.solve(system, -turn * faster - np.einsum("kmx,mxe->ke", lines, aside))
    after = columns.copy()
    after[:, 2:] += aside + np.einsum("m,kmx,ke->mxe", weights, lines, stronger)
    after[:, :2] -= np.einsum("kmx,ke->mxe", kicks, waits)
    return Pushed(after, waits)
