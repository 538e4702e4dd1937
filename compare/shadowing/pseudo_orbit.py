"""An engine's run as nodes of a fixed order of contacts, and the true orbit nearest to them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import inf, log2
from typing import TYPE_CHECKING, Any, SupportsFloat

import numpy as np
from flint import arb

from ...exact.numbers import ball
from ...exact.replay.ball_state import BallState, LoneContacts
from ...exact.replay.contact import Flight, Touch, is_arc, is_flat, places_of, touch_of
from ...exact.replay.landings import landing
from ...exact.replay.parts import PartsNear
from ...exact.replay.state import Go, Kick
from ...floating.double import DOUBLES
from ..tangent.growth import Displacements, unit_displacements
from ..tangent.impacts import Impact, NoTangentMap, check_start, moving, true_speed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Motion, Trajectory

Indices = tuple[int, int]
"""A contact by index in `Scene.surfaces`: two circles, or circle i and wall or face j - n, n the number of circles."""

DoubleFlight = tuple[float, float, float, float, float]
"""(t, x, y, vx, vy): from time t on a circle flies straight from (x, y) at (vx, vy)."""


@dataclass(frozen=True)
class OrbitRecord:
    """The first events of a run in doubles.

    Attributes:
        links: the contacts, one after the other; those of one instant in the order of their impulses.
        events: for each contact the event that it belongs to.
        times: for each contact its time.
        flights: for each circle that can move, by its index, how it flew at the start and after each of its contacts:
            where it truly was, and how fast.
    """

    links: tuple[Indices, ...]
    events: tuple[int, ...]
    times: tuple[float, ...]
    flights: dict[int, tuple[DoubleFlight, ...]]


def recorded(trajectory: Trajectory, events: int) -> OrbitRecord:
    """The first events of a run.

    Raises:
        NoTangentMap: where nearby runs are not its image under a smooth map: circles that touch from the start on or
            go out of play, a reversal, and a circle that has several contacts at one instant.

    >>> from truebreak.floating import DoubleEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> told = recorded(DoubleEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 0)])), 1)
    >>> told.links, told.times, told.flights[1]
    (((0, 1),), (2.0,), ((0.0, 4.0, 0.0, 0.0, 0.0), (2.0, 4.0, 0.0, 1.0, 0.0)))
    """
    scene = trajectory.scene
    check_start(scene)
    if trajectory.reversal is not None and trajectory.reversal.after < events:
        raise NoTangentMap(f"the run turns back after {trajectory.reversal.after} events", trajectory.reversal.after)
    place, part_of = {name: k for k, name in enumerate(scene.ids)}, PartsNear(scene, DOUBLES)
    flights: dict[int, list[DoubleFlight]] = {}
    for i in moving(scene):
        c = scene.circles[i]
        flights[i] = [(0.0, float(c.x), float(c.y), float(c.vx), float(c.vy))]
    links: list[Indices] = []
    owners: list[int] = []
    times: list[float] = []
    for event in trajectory.events[:events]:
        mine = [(place[first], place[second]) for first, second in event.impulses]
        met = [i for link in mine for i in link if i in flights]
        if len(set(met)) < len(met):
            twice = next(scene.ids[i] for i in met if met.count(i) > 1)
            raise NoTangentMap(f"event {event.index}: {twice} has several contacts at one instant", event.index)
        time, rows = float(event.time), _rows(trajectory.motion, met, event.time)
        for i, row in zip(met, rows, strict=True):
            x, y, vx, vy = map(float, row)
            flights[i].append((time, x, y, vx, vy))
        links += [_part(scene, part_of, link, flights) for link in mine]
        owners += [event.index] * len(mine)
        times += [time] * len(mine)
    return OrbitRecord(tuple(links), tuple(owners), tuple(times), {i: tuple(rows) for i, rows in flights.items()})


def _rows(motion: Motion, circles: Sequence[int], time: Any) -> Sequence[Sequence[SupportsFloat]]:
    """(x, y, vx, vy) of some circles, without the others where the motion can tell."""
    one: Callable[[int, Any], Sequence[SupportsFloat]] | None = getattr(motion, "circle", None)
    if one is not None:
        return [one(i, time) for i in circles]
    states = motion.state(time)
    return [states[i] for i in circles]


def in_the_frame(scene: Scene, flight: DoubleFlight) -> DoubleFlight:
    """A flight as it is in the frame that falls with gravity, in which all that move fly straight; to rounding.

    >>> from truebreak.scenarios import Circle, Scene
    >>> in_the_frame(Scene([Circle(0, 9)], gravity=(0, -2)), (3.0, 0.0, 0.0, 1.0, -6.0))
    (3.0, 0.0, 9.0, 1.0, 0.0)
    """
    if scene.gravity is None:
        return flight
    (t, x, y, vx, vy), (gx, gy) = flight, map(float, scene.gravity)
    return t, x - gx / 2 * t * t, y - gy / 2 * t * t, vx - gx * t, vy - gy * t


def _part(
    scene: Scene, near: PartsNear[float], link: Indices, flights: Mapping[int, Sequence[DoubleFlight]]
) -> Indices:
    """A contact by index in `Scene.surfaces`: of a thing with faces and ends the part that has pushed."""
    (i, j), inner, count = link, scene.surfaces, len(scene.circles)
    if j < count:
        return link
    if j not in near.things:
        return i, len(inner.circles) + j - count
    (since, *_, ux, uy), (time, x, y, vx, vy) = flights[i][-2:]
    if scene.gravity is not None:
        ux, uy = ux + float(scene.gravity[0]) * (time - since), uy + float(scene.gravity[1]) * (time - since)
    push = vx - ux, vy - uy
    for face in near.things[j].faces[:1]:  # as seen from what moves
        wx, wy = float(inner.walls[face].vx), float(inner.walls[face].vy)
        x, y, ux, uy = x - wx * time, y - wy * time, ux - wx, uy - wy
    [part] = near.pushing(i, j, x, y, ux, uy, push)[:1]
    return places_of(inner, part)


# ----------------------------------------
# A run with its order of contacts held fixed: a smooth map from one node to the next, and its tangent map.

Node = list[arb]
"""x, y, vx, vy of every circle that can move, one after the other: midpoints, without a radius."""


class Missed(ArithmeticError):
    """Two that are to meet do not: what leads to them passes by.

    Attributes:
        contact: which, by its place in the order.
    """

    def __init__(self, contact: int) -> None:
        super().__init__(f"contact {contact} is missed")
        self.contact = contact


@dataclass(frozen=True)
class OrbitSegment:
    """From one node to the next: contacts from number `first` on, and the two nodes' times."""

    first: int
    links: tuple[Indices, ...]
    begin: float
    end: float


CLOSE = 2.0**-20
"""Share of the mean time between contacts: onto what is round and stands under gravity no node stands between two that
are closer, as on a board that is its own mirror image. Corrections may put a contact on the other side of a node, and
what falls is met ahead only; elsewhere a state is flown back to it, and nothing is lost."""


def segments(record: OrbitRecord, events: int = 1, falls: bool = False) -> list[OrbitSegment]:
    """One for so many events: nodes stand half-way between instants, the first at time 0, the last at the last instant.

    Args:
        falls: whether contacts are zeros of quartics: then no node stands between two that are too close (`CLOSE`).
    """
    found: list[OrbitSegment] = []
    first, begin, count = 0, 0.0, len(record.links)
    close = CLOSE * record.times[-1] / count if falls and count else -inf
    while first < count:
        stop = first + 1
        while stop < count and (
            record.events[stop] < record.events[first] + events or record.times[stop] - record.times[stop - 1] <= close
        ):
            stop += 1
        last = record.times[stop - 1]
        end = last if stop == count else last + (record.times[stop] - last) / 2
        found.append(OrbitSegment(first, record.links[first:stop], begin, end))
        first, begin = stop, end
    return found


class FixedOrder:
    """The map of each segment, in balls at flint's working precision.

    Args:
        scene: what runs, as engines see it; of its start only walls, fixed circles, radii and masses count. Under
            gravity nodes are in the frame that falls.
        chain: the segments.
    """

    def __init__(self, scene: Scene, chain: Sequence[OrbitSegment]) -> None:
        self.scene = scene
        self.chain = chain
        self.free = moving(scene)
        self._made = BallState(scene)
        self._alone = LoneContacts(self._made)
        self._bits = ball.bits_in_use()

    @property
    def reversible(self) -> bool:
        """Whether what is turned back obeys the same law: contacts keep the energy, and no wall moves."""
        return self.scene.elastic and not (self._made.drifts or self.scene.moving_ends)

    def traced_back(self, k: int, node: Node) -> Node:
        """The start from which the orbit through a node at the begin of segment k comes; see `reversible`.

        Raises:
            Missed: as `image`.
        """
        turn, fallen = self.chain[k].begin, self._made.falling
        drop = [arb(0), arb(0)] if fallen is None else [2 * turn * part for part in fallen[:2]]

        def turned(x: arb, y: arb, vx: arb, vy: arb) -> Node:
            return [x, y, -vx - drop[0], -vy - drop[1]]

        def by_circles(change: Callable[..., Node], flights: Node) -> Node:
            return [value for i in range(0, len(flights), 4) for value in change(*flights[i : i + 4])]

        halves = [part * turn / 2 for part in drop]
        now = by_circles(lambda x, y, *v: turned(x + halves[0], y + halves[1], *v), node)
        back = [
            OrbitSegment(max(1, s.first), s.links[::-1], turn - s.end, turn - s.begin) for s in reversed(self.chain[:k])
        ]
        order = FixedOrder(self.scene, back)
        for step in range(k):
            now = [value.mid() for value in order.image(step, now, False)[0]]
        return [value.mid() for value in by_circles(lambda x, y, *v: turned(x + halves[0], y + halves[1], *v), now)]

    def image(self, k: int, node: Node, impacts: bool = True) -> tuple[Node, list[Impact]]:
        """Where segment k leads from a node, and the impacts on the way, if they are asked for.

        Raises:
            Missed: if two that are to meet do not.
        """
        segment = self.chain[k]
        state = self._state(segment, node)
        struck: list[Impact] = []
        for place, (i, j) in enumerate(segment.links):
            link = touch_of(self.scene, i, j)
            if not _meets(state, link):
                raise Missed(segment.first + place)
            if not impacts and self._alone.strike(link, self._bits, state.steps_done) is not None:
                continue
            state.do(Go(link, link.circles))
            if not state.instant.is_finite():  # of two that pass each other it is no number
                raise Missed(segment.first + place)
            if impacts:
                struck.append(_impact(state, link))
            state.do(Kick((link,), (link,)))
        ball.use_bits(self._bits)  # of contacts alone, numbers that have lost many are computed with fewer
        end = arb(segment.end)
        told: Node = []
        for i in self.free:
            flight = state.bodies[i].flight
            left = end - flight.t
            told += (flight.x + flight.vx * left, flight.y + flight.vy * left, flight.vx, flight.vy)
        return told, struck

    def _state(self, segment: OrbitSegment, node: Node) -> BallState:
        if self._bits != ball.bits_in_use():
            self._made, self._bits = BallState(self.scene), ball.bits_in_use()
            self._alone = LoneContacts(self._made)
        state, begin, last = self._made, arb(segment.begin), int(segment.first > 0)  # none touches but at the start
        for i in state.bodies.keys() - self.free:
            state.bodies[i].flight = state.bodies[i].flight._replace(last=0)
        for row, i in enumerate(self.free):
            x, y, vx, vy = node[4 * row : 4 * row + 4]
            state.bodies[i].flight, state.bodies[i].acc = Flight(x, y, vx, vy, begin, begin, last=last), self._bits
        state.contacts.clear()
        state.stand(begin, state.zero, last)
        return state

    def tangent(self, k: int, struck: Sequence[Impact]) -> NDArray[np.float64]:
        """The tangent map of segment k, in doubles: shape (4 moving circles, the same)."""
        segment = self.chain[k]
        carried = Displacements(self.scene, unit_displacements(self.scene), segment.begin)
        carried.through(struck)
        carried.fly(segment.end)
        return carried.matrix * 2.0**carried.scale


def _meets(state: BallState, link: Touch) -> bool:
    """Whether two meet on their flights as they are: a state takes it for granted, as the log of a run says so."""
    if not is_flat(link) and state.stands and state.on_peg(link):
        return isinstance(landing(state, link, inf), arb)
    # what is within an arc may fly away from it first, and what falls onto a wall comes back, however it flies
    thrown = is_flat(link) and state.sides.pull(*link[:2]) < 0
    return thrown or link.hollow or bool(link.approach(state) < 0)


def _impact(state: BallState, link: Touch) -> Impact:
    """The impact that is about to push."""
    i, zero = link.circles[0], state.zero
    ux, uy = true_speed(state, i)
    if is_flat(link):
        line, (wx, wy) = state.line(link.circle, link.wall), state.drifts.get(link.wall, (zero, zero))
        return Impact(state.instant, i, None, line.nx, line.ny, ux - wx, uy - wy, line.length, zero, zero, link.wall)
    (a, b), (dx, dy) = link.ends(state), state.span(link)
    if is_arc(link):  # as a circle that nothing moves, beyond those of the scene
        reach = -state.reach(a, b) if link.hollow else state.reach(a, b)
        return Impact(state.instant, i, state.n + link.arc, dx, dy, -ux, -uy, reach, a.w, b.w)
    vx, vy = true_speed(state, link.b)
    return Impact(state.instant, i, link.b, dx, dy, vx - ux, vy - uy, state.reach(a, b), a.w, b.w)


# ----------------------------------------
# Multiple shooting: the true orbit of a fixed order of contacts that is nearest to given nodes, to any accuracy.
#
# Newton's method on the misfits between the image of each node and the next. Of the many corrections that close them
# to first order the shortest is taken, over all nodes together: so the orbit found stays by the nodes, forwards and
# backwards alike. Misfits are computed in balls, tangent maps in doubles: each round gains about as many digits as
# these are good for.
#
# One node, the anchor, gets all the bits, and the start is traced back from it. Its errors grow both ways, so it stands
# where they grow alike until either end. Of a misfit elsewhere only what is left of it at the anchor counts: it closes
# at so many bits as errors grow by from there to that end, and no round looks at it any more.

MOST_ROUNDS = 200
"""Rounds of Newton's method at most: each gains more than a bit, or the search ends."""

GUARD_BITS = 64
"""Bits beyond what the run loses: so near to the true orbit is that of the start that comes out, at its end."""

FIRST_BITS = 192
"""Bits of the first rounds, which start from doubles."""

LINEAR = 2.0**-45
"""Corrections, as a share of the scale, below which tangent maps are not taken anew: the error of the old ones is of
that size itself, and doubles are good for little more."""

MENDED = 2
"""How often what an elimination leaves of the residuals is corrected: the second time nothing but rounding is left."""

MARGIN_BITS = 8
"""By how much smaller than asked for misfits are before they are let be: corrections elsewhere leave some there."""

LEAST_GAIN = 0.5
"""A round that leaves more than this share of the misfits gains nothing."""

PATIENCE = 3
"""Rounds without gain after which the search ends: from a start that is far off, misfits may grow at first."""


@dataclass(frozen=True)
class Refined:
    """What came of the search.

    Attributes:
        nodes: the last nodes.
        misfits: the largest misfit of each round, as a share of the scale, in bits (log2).
        corrections: the largest correction of each round, likewise.
        closed: whether the misfits became as small as was asked for.
        bits: the precision at the end.
        missed: a contact that came to nothing, as the two passed each other by; None if none did.
    """

    nodes: list[Node]
    misfits: tuple[float, ...]
    corrections: tuple[float, ...]
    closed: bool
    bits: int
    missed: int | None = None


def refined(order: FixedOrder, nodes: Sequence[Sequence[float]], scale: Sequence[float]) -> Refined:
    """Closes the misfits from nodes in doubles.

    Args:
        nodes: the coordinates at the begin of each segment, and at the end of the last.
        scale: for each coordinate the size by which it is measured.
    """
    weights = np.array(scale)
    shares = [arb(value) for value in scale]
    now: list[Node] = [[arb(value) for value in node] for node in nodes]
    shortest: ShortestCorrections | None = None
    misfits: list[float] = []
    corrections: list[float] = []
    bits, stale, missed = FIRST_BITS, 0, None
    low, high, anchor, lost, goals = 0, len(order.chain), 0, 0.0, [0.0]
    for _ in range(MOST_ROUNDS):
        fresh = shortest is None or corrections[-1] > log2(LINEAR)
        if fresh:
            low, high = 0, len(order.chain)
        with ball.precision(bits):
            try:
                residuals, maps = _misfits(order, now, (low, high), weights, shares, fresh)
            except Missed as error:
                missed = error.contact
                break
            misfits.append(_largest(residuals))
            if fresh:
                anchor, lost, goals = _aims(maps, order.reversible)
            open_ones = [k for k in range(low, high) if goals[k] <= misfits[-1] + MARGIN_BITS]
            if not open_ones:
                bits = int(GUARD_BITS + FIRST_BITS + lost)
                with ball.precision(bits):
                    try:
                        start = order.traced_back(anchor, now[anchor])
                    except Missed as error:
                        missed = error.contact
                        break
                return Refined([start, *now[1:]], tuple(misfits), tuple(corrections), True, bits)
            residuals = residuals[open_ones[0] - low : open_ones[-1] + 1 - low]
            low, high = open_ones[0], open_ones[-1] + 1
            best = min(misfits[:-1], default=inf)
            stale = 0 if misfits[-1] < best + log2(LEAST_GAIN) else stale + 1
            if stale >= PATIENCE:
                break
            exponent = int(max(misfits[-1], -1e9))
            factor = arb(2) ** -exponent
            try:
                if shortest is None or fresh:
                    shortest = ShortestCorrections(maps)
                steps = shortest([np.array([float(value * factor) for value in row]) for row in residuals], low)
            except np.linalg.LinAlgError:  # by a graze: growth there is without bound
                break
            corrections.append(exponent + log2(max(float(np.abs(step).max()) for step in steps) or 2.0**-1000))
            if corrections[-1] > 0:
                break
            factor = arb(2) ** exponent
            for k, mine in enumerate(steps, low):
                shifts = (mine * weights).tolist()
                now[k] = [(value + arb(step) * factor).mid() for value, step in zip(now[k], shifts, strict=True)]
        bits = FIRST_BITS + max(0, -exponent)
    return Refined(now, tuple(misfits), tuple(corrections), False, bits, missed)


def _misfits(
    order: FixedOrder,
    nodes: Sequence[Node],
    span: tuple[int, int],
    weights: NDArray[np.float64],
    shares: Node,
    fresh: bool,
) -> tuple[list[Node], list[NDArray[np.float64]]]:
    """Image less next node, of some segments, and the tangent maps if they are wanted; both by the scale."""
    residuals: list[Node] = []
    maps: list[NDArray[np.float64]] = []
    for k in range(*span):
        image, struck = order.image(k, nodes[k], fresh)
        residuals.append([(a - b) / w for a, b, w in zip(image, nodes[k + 1], shares, strict=True)])
        if fresh:
            maps.append(order.tangent(k, struck) * weights[None, :] / weights[:, None])
    return residuals, maps


def _aims(maps: Sequence[NDArray[np.float64]], reversible: bool) -> tuple[int, float, list[float]]:
    """The anchor, by its node; the bits that the whole run loses; and how small each segment's misfit has to become.

    Args:
        reversible: whether the start may be traced back from another node; else it is the anchor.
    """
    after = _growths(maps[::-1])[::-1]
    before = [0.0] + [inf] * len(maps)
    if reversible:
        with suppress(np.linalg.LinAlgError):  # by a graze: then the start is the anchor
            before = _growths([np.linalg.inv(step) for step in maps])
    anchor = min(range(len(maps)), key=lambda k: max(after[k], before[k]))
    goals = [-(GUARD_BITS + (after[k] if k >= anchor else before[k + 1])) for k in range(len(maps))]
    return anchor, after[0], goals


def _growths(maps: Sequence[NDArray[Any]]) -> list[float]:
    """Bits by which the worst displacement grows through the first of some maps: none, one, two, ..."""
    product, scale, found = np.eye(len(maps[0])), 0.0, [0.0]
    for step in maps:
        product = product @ step
        size = float(np.abs(product).max())
        product /= size
        scale += log2(size)
        found.append(max(0.0, scale + log2(float(np.linalg.norm(product)))))
    return found


def _largest(residuals: Sequence[Node]) -> float:
    """log2 of the largest, whatever its size: upper ends are exact numbers, of which one is the largest."""
    top = max(value.abs_upper() for row in residuals for value in row)
    return -inf if top.is_zero() else float(top.log() / arb(2).log())


class ShortestCorrections:
    """The shortest corrections s with maps[k] s[k] - s[k + 1] = -residuals[k], for ever other residuals.

    With A the matrix of these equations, s = -A^T (A A^T)^-1 r; A A^T has blocks on three diagonals only, and is
    solved by its block elimination. What that leaves of the residuals, since it squares the condition of A, is
    corrected in its turn.

    Raises:
        LinAlgError: for maps by which a block has no inverse.

    >>> import numpy as np
    >>> [float(step[0]) for step in ShortestCorrections([np.eye(1) * 2])([np.ones(1)])]  # 2 s0 - s1 = -1
    [-0.4, 0.2]
    """

    def __init__(self, maps: Sequence[NDArray[np.float64]]) -> None:
        self._maps = maps
        self._inverses: list[NDArray[Any]] = []
        unit = np.eye(len(maps[0]))
        for k, step in enumerate(maps):
            block = step @ step.T + unit
            if k:
                block = block - step @ self._inverses[-1] @ step.T
            self._inverses.append(np.linalg.inv(block))

    def __call__(self, residuals: Sequence[NDArray[np.float64]], low: int = 0) -> list[NDArray[np.float64]]:
        """The corrections, one more than there are residuals: these are of the segments from `low` on, the others 0."""
        maps = self._maps[low : low + len(residuals)]
        found = [np.zeros(len(residuals[0])) for _ in range(len(residuals) + 1)]
        left = [-row for row in residuals]
        for _ in range(1 + MENDED):
            for step, more in zip(found, self._least(left, low), strict=True):
                step += more
            left = [
                -row - (step @ mine - other)
                for row, step, mine, other in zip(residuals, maps, found, found[1:], strict=False)
            ]
        return found

    def _least(self, right: Sequence[NDArray[np.float64]], low: int = 0) -> list[NDArray[np.float64]]:
        """The shortest s with A s = right, as exact as one elimination makes it."""
        count, sides = len(right), list(right)
        maps, inverses = self._maps[low : low + count], self._inverses[low : low + count]
        for k in range(1, count):
            sides[k] = sides[k] + maps[k] @ (inverses[k - 1] @ sides[k - 1])
        sides[-1] = inverses[-1] @ sides[-1]
        for k in range(count - 2, -1, -1):
            sides[k] = inverses[k] @ (sides[k] + maps[k + 1].T @ sides[k + 1])
        steps = [maps[0].T @ sides[0]]
        if low:
            steps[0] = steps[0] - self._inverses[low - 1] @ steps[0]
        steps += [maps[k].T @ sides[k] - sides[k - 1] for k in range(1, count)]
        return [*steps, -sides[-1]]
