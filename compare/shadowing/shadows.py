"""Is an engine's run, past where it leaves the history, the true history of a nearby start? Proved, or not found."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ...exact.exact_engine import ExactEngine
from ...exact.numbers import ball
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import rational
from ...scenarios.things import Circle
from ..alignment.instants import Divergence
from ..chaos.horizon import follow
from ..deadline import uninterrupted
from ..engines import engine as engine_named
from ..foreign.guard import run_guarded
from ..tangent.impacts import NoTangentMap, check_sizes, moving
from ..validation import check_engine, check_trajectory
from .obstacle import (
    Blocked,
    Distance,
    Obstacle,
    StartDistance,
    distance,
    drift,
    not_closed,
    other_history,
    start_distance,
    units,
)
from .pseudo_orbit import (
    FIRST_BITS,
    FixedOrder,
    Node,
    OrbitRecord,
    Refined,
    in_the_frame,
    recorded,
    refined,
    segments,
)

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress, Trajectory

MORE_EVENTS = 2
"""Events that the engine runs beyond those asked for, so that the last of them is whole."""


@dataclass(frozen=True)
class Proof:
    """A start near the scene's whose true history is the engine's; certified.

    Attributes:
        scene: the start, in exact rational numbers: run it to see for yourself.
        run: its certified run.
        start: how far it is from the scene's own start.
        run_distance: how far its run is from the engine's.
        reordered: contacts that have another place in the whole order, though each circle's own order is the same.
    """

    scene: Scene
    run: Trajectory = field(repr=False)
    start: StartDistance
    run_distance: Distance
    reordered: int


TOGETHER = 8
"""Events from one node to the next: errors grow little in so few, and nodes cost. Where the search does not come to its
end with these, nodes stand at every event."""


@dataclass(frozen=True)
class Shadow:
    """What came of looking for a shadow of an engine's run.

    Attributes:
        scene, engine: what was run, and by whom.
        events: of the engine's run.
        divergence: where the engine diverges from the certified history of the scene's own start; None if it does not.
        proof: the shadow; None if none was found.
        blocked: why not.
        drift: the largest relative change of the energy along the engine's run; None if the law keeps none, with a
            restitution below 1 or walls that move, or if the search never began.
        refinement: how the search went; None if it never began.
    """

    scene: Scene
    engine: str
    events: int
    divergence: Divergence | None
    proof: Proof | None
    blocked: Blocked | None
    drift: float | None = None
    refinement: Refined | None = field(default=None, repr=False)


def shadow(
    scene: Scene, engine: str | Engine = "double", *, events: int | None = None, progress: OnProgress | None = None
) -> Shadow:
    """Looks for a start near the scene's whose true history is what an engine computed.

    The nearest orbit of the engine's order of contacts is found by multiple shooting. Its start, written in exact
    numbers, is run by the exact engine: where each circle of that certified run has the very contacts of the engine's
    run, in order, this start is a shadow, proved; and the distances are bounded in balls. Nothing of the search is
    trusted.

    Args:
        events: how many of the engine's events; by default as many as the scene's own limit.

    Raises:
        SceneError: for a scene without collisions, and for an engine that cannot take it.

    >>> from truebreak.scenarios import catalogue
    >>> told = shadow(catalogue.build("gas:n=3"), events=150)
    >>> told.divergence.event < 150, told.proof.run_distance.position < 1e-10
    (True, True)
    """
    if other := scene.other_walls:
        raise SceneError(f"{scene.name!r}: has a wall of kind {other[0].kind!r}, of which there is no shadow")
    if scene.gravity is not None and not scene.capture:  # where a flight enters one it is told anew, and goes on
        scene = scene.with_changes(pockets=())
    chosen = check_engine(engine_named(engine) if isinstance(engine, str) else engine)
    name = engine if isinstance(engine, str) else engine.name
    truth = uninterrupted(ExactEngine().run(scene, events=events, progress=progress))
    if not truth.events:
        raise SceneError(f"{scene.name!r}: nothing collides ({truth.stop.message}); there is no run to shadow")
    count = len(truth.events) if events is None else events
    run = uninterrupted(run_guarded(chosen, scene, events=count + MORE_EVENTS, progress=progress))
    check_trajectory(run, scene, chosen.name, chosen.bits)
    if scene.gravity is not None and chosen.step is not None:
        raise SceneError(
            f"{scene.name!r}: engine {name!r} falls by steps, which is no flight of the law; no shadow is looked for"
        )
    if not run.events:
        raise SceneError(
            f"{scene.name!r}: engine {name!r} has no event ({run.stop.message}); there is nothing to shadow"
        )
    count = min(count, len(run.events))
    told = follow(truth, chosen)
    if told.unable:
        raise SceneError(f"{scene.name!r}: engine {name!r} cannot take it: {told.run.stop.message}")
    left = told.alignment.divergence
    try:
        check_sizes(scene)
        record = recorded(run, count)
    except NoTangentMap as error:
        return Shadow(scene, name, count, left, None, Blocked(Obstacle.SIMULTANEOUS, error.events, str(error)))
    return _Search(scene, name, record, count, left).shadow(progress)


def longest(
    scene: Scene, engine: str | Engine = "double", *, events: int | None = None, progress: OnProgress | None = None
) -> tuple[Shadow, Shadow | None]:
    """Looks for a shadow of all of a run, and, where none is found, of ever shorter beginnings of it, by bisection.

    Returns:
        What came of the whole, and the shadow of the longest beginning for which one was found (None: of none). A
        longer one may exist that was not tried.

    Raises:
        SceneError: as `shadow`.
    """
    whole = shadow(scene, engine, events=events, progress=progress)
    best = whole if whole.proof is not None else None
    good, bad = 0, whole.events
    while best is not whole and bad - good > 1:
        tried = shadow(scene, engine, events=(good + bad) // 2, progress=progress)
        if tried.proof is not None:
            best, good = tried, tried.events
        else:
            bad = (good + bad) // 2
    return whole, best


class _Search:
    """One search."""

    def __init__(self, scene: Scene, name: str, record: OrbitRecord, events: int, left: Divergence | None) -> None:
        self.scene, self.name, self.record, self.events, self.left = scene, name, record, events, left
        self.seen = scene.surfaces  # in whose places contacts are
        self.free = moving(scene)
        self.falls = scene.gravity is not None and bool(self.seen.pegs or self.seen.arcs)
        self.chain = segments(record, TOGETHER, self.falls)

    def shadow(self, progress: OnProgress | None) -> Shadow:
        """The search, and the proof."""
        found = self._refined()
        if not found.closed:
            self.chain = segments(self.record, falls=self.falls)
            found = self._refined()
        told = self._proved(found.nodes[0], progress) if found.closed else not_closed(self.seen, self.record, found)
        proof, blocked = (told, None) if isinstance(told, Proof) else (None, told)
        lost = drift(self.scene, self.record)
        return Shadow(self.scene, self.name, self.events, self.left, proof, blocked, lost, found)

    def _refined(self) -> Refined:
        with ball.precision(FIRST_BITS):
            order = FixedOrder(self.seen, self.chain)
        length, speed = units(self.seen, self.record)
        return refined(order, self._nodes(), [length, length, speed, speed] * len(self.free))

    def _nodes(self) -> list[list[float]]:
        """The states of the engine's run at the begin of each segment, and at the end of the last."""
        nodes: list[list[float]] = []
        done = dict.fromkeys(self.record.flights, 0)
        for segment in (*self.chain, None):
            time = segment.begin if segment is not None else self.chain[-1].end
            node: list[float] = []
            for i, flights in self.record.flights.items():
                t, x, y, vx, vy = in_the_frame(self.seen, flights[done[i]])
                node += [x + vx * (time - t), y + vy * (time - t), vx, vy]
            nodes.append(node)
            for i in (i for link in (segment.links if segment else ()) for i in link if i in done):
                done[i] += 1
        return nodes

    # -- the proof

    def _proved(self, node: Node, progress: OnProgress | None) -> Proof | Blocked:
        try:
            start = self._started(node)
        except SceneError as error:
            return Blocked(Obstacle.TOUCHING, None, f"the start that was found is no scene: {error}")
        run = uninterrupted(ExactEngine().run(start, events=len(self.record.links), progress=progress))
        try:
            theirs = recorded(run, len(run.events))
        except NoTangentMap as error:
            return Blocked(Obstacle.SIMULTANEOUS, error.events, f"in the start that was found: {error}")
        wrong = other_history(start.surfaces, self.record, run, theirs)
        if wrong is not None:
            return wrong
        apart = distance(self.record, run)
        if apart is None:
            message = "two contacts of one circle are closer to each other than the runs are"
            return Blocked(Obstacle.ORDER, None, message)
        reordered = sum(a != b for a, b in zip(theirs.links, self.record.links, strict=False))
        return Proof(start, run, start_distance(self.scene, start), apart, reordered)

    def _started(self, node: Node) -> Scene:
        """The scene with a node as its start, in exact rational numbers."""
        circles: list[Circle] = list(self.scene.circles)
        for row, i in enumerate(self.free):
            c = circles[i]
            x, y, vx, vy = (rational(value.fmpq()) for value in node[4 * row : 4 * row + 4])
            circles[i] = Circle(x, y, c.r, vx, vy, m=c.m, id=c.id, point=c.point)
        return self.scene.with_changes(circles=circles, name=f"shadow of {self.scene.name}"[:64])
