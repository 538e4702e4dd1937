"""The impacts of a run, with the numbers that its tangent map needs, and where circles graze."""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from math import hypot
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from flint import arb

from ...exact.exact_motion import ExactMotion, ExactValue, steps_through
from ...exact.laws.formulas import (
    N,
    advance,
    damped,
    fall_speed,
    pair_approach,
    pair_impulse,
    pair_nearest_time,
    wall_approach,
    wall_bounce,
)
from ...exact.numbers import ball
from ...exact.numbers.ball import known_ball
from ...exact.replay.ball_state import BallState
from ...exact.replay.centred_state import CentredState
from ...exact.replay.contact import (
    AtWall,
    Pair,
    Touch,
    can_push,
    contact_of,
    is_arc,
    is_flat,
    is_pair,
    name_of,
    places_of,
)
from ...exact.replay.landings import begins_at
from ...exact.replay.state import Go, Kick, Leave, ReplayState
from ...scenarios.lazy import Later
from ...scenarios.numbers.quantity import ZERO, Quantity
from ...scenarios.things import Circle

if TYPE_CHECKING:
    import numpy as np

    from ...exact.replay.contact import Link
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Event, Trajectory

else:
    np = Later("numpy")

BITS = 128
"""Accuracy of the times that are compared; where they are not told apart the graze counts as one."""

SKIMMED = 1e-6
"""The same, as a share, of those at zeros of quartics."""


class Graze(NamedTuple):
    """Two circles that touch without pushing; under gravity also a circle and a wall, from which it pulls away.

    Attributes:
        events: how many events of the run lie before it.
        one, other: the two.
    """

    events: int
    one: str
    other: str


def first_graze(trajectory: Trajectory, motion: ExactMotion, events: int) -> Graze | None:
    """The first graze before the last of so many events of an exact run; None if there is none.

    The run has proved which pairs graze on flights that they had; such a graze comes to pass unless one of the two
    has its next impulse before it.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> run = ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 2), Circle(9, 0)]))
    >>> first_graze(run, run.motion, 1)
    Graze(events=0, one='c1', other='c2')
    """
    if motion.tape is None:
        return None
    found = [
        graze
        for instant, links in motion.tape.grazes.items()
        for link in links
        if (graze := _graze(trajectory, motion, events, instant, link)) is not None
    ]
    return min(found, default=None)


def _graze(trajectory: Trajectory, motion: ExactMotion, events: int, instant: int, link: Link) -> Graze | None:
    """The graze that two were proved to have on their flights after an instant, if it comes to pass.

    At the rim of a pocket it changes no velocity.
    """
    if not can_push(link):
        return None
    scene = motion.log.scene
    names = [scene.ids[k] for k in link.circles]
    one, other = contact_of(scene, link)
    before = sum(_number(event) <= instant for event in trajectory.events[:events])
    with ball.precision(BITS):
        if is_flat(link):
            time = _apex(motion, link, instant)
        else:
            i, j = places_of(scene, link)
            stands = not scene.pegs.isdisjoint((i, j)) or max(i, j) >= len(scene.circles)
            falls = scene.gravity is not None and stands
            time = _skimmed(motion, i, j, instant) if falls else _nearest(motion, i, j, instant)
        for event in trajectory.events[before:events]:
            if not event.time.ball(BITS) < time:
                return Graze(before, one, other)
            if any(name in pair for pair in event.impulses for name in names):
                return None
            before += 1
    return None


def _apex(motion: ExactMotion, link: AtWall, instant: int) -> arb:
    """When a circle is nearest to a wall that gravity pulls it away from: n.v is 0 there."""
    scene = motion.log.scene
    assert scene.gravity is not None
    knots = motion.knots[link.circle]
    knot = knots[bisect_right(knots, instant + 1, key=lambda knot: knot[-1]) - 1]
    vx, vy = (known_ball(number, BITS) for number in knot[3:5])
    nx, ny = (ball.constant(part) for part in scene.walls[link.wall].normal)
    gx, gy = (ball.constant(part) for part in scene.gravity)
    vx, vy = (v - ball.constant(u) for v, u in ((vx, scene.walls[link.wall].vx), (vy, scene.walls[link.wall].vy)))
    return -wall_approach(vx, vy, nx, ny) / wall_approach(gx, gy, nx, ny)  # in the falling frame: n.(v + g t) = 0


def _nearest(motion: ExactMotion, i: int, j: int, instant: int) -> arb:
    """When two circles, or one and the middle of an arc, are nearest to each other on flights after an instant."""
    rows: list[list[arb]] = []
    scene = motion.log.scene
    beyond = len(scene.circles) + len(scene.walls)
    for k in (i, j):
        if k >= beyond:
            side = scene.arc_sides[k - beyond]
            rows.append([ball.constant(number) for number in (ZERO, side.x, side.y, ZERO, ZERO)])
            continue
        if k in scene.ends:
            end = scene.circles[k]
            rows.append([ball.constant(number) for number in (ZERO, end.x, end.y, *end.drift)])
            continue
        knots = motion.knots[k]
        knot = knots[bisect_right(knots, instant + 1, key=lambda knot: knot[-1]) - 1]
        rows.append([known_ball(number, BITS) for number in knot[:5]])
    (s, ax, ay, avx, avy), (t, bx, by, bvx, bvy) = rows
    dx, dy = bx - advance(ax, avx, t - s), by - advance(ay, avy, t - s)
    return t + pair_nearest_time(pair_approach(dx, dy, bvx - avx, bvy - avy), bvx - avx, bvy - avy)


def _skimmed(motion: ExactMotion, i: int, j: int, instant: int) -> arb:
    """When a circle that falls grazes something round that stands: about a zero of the distance's derivative, a cubic.

    The first of those that may be it; the instant itself where doubles tell of none.
    """
    scene = motion.log.scene
    i, j = (j, i) if i in scene.pegs else (i, j)
    beyond = len(scene.circles) + len(scene.walls)
    still = scene.arc_sides[j - beyond] if j >= beyond else scene.circles[j]
    reach = abs(float(still.r + scene.circles[i].r))
    knots = motion.knots[i]
    knot = knots[bisect_right(knots, instant + 1, key=lambda knot: knot[-1]) - 1]
    t, x, y, vx, vy = (float(known_ball(number, BITS)) for number in knot[:5])
    assert scene.gravity is not None
    gx, gy = map(float, scene.gravity)
    ux, uy = map(float, still.drift if isinstance(still, Circle) else Circle.drift)  # of an end that moves
    x, y = x + gx * t * t / 2 - float(still.x) - ux * t, y + gy * t * t / 2 - float(still.y) - uy * t
    vx, vy = vx + gx * t - ux, vy + gy * t - uy
    cubic = [(gx * gx + gy * gy) / 2, 1.5 * (vx * gx + vy * gy), vx * vx + vy * vy + x * gx + y * gy, x * vx + y * vy]
    waits = [float(root.real) for root in np.roots(cubic) if abs(root.imag) <= SKIMMED * (1 + abs(root))]
    away = [(s, hypot(x + (vx + gx * s / 2) * s, y + (vy + gy * s / 2) * s) - reach) for s in waits if s > 0.0]
    since = min((s for s, gap in away if abs(gap) <= SKIMMED * (reach + hypot(x, y))), default=0.0)
    return arb(t + since, SKIMMED * (1 + t + since))


def _number(event: Event) -> int:
    """The number of an event's instant; 0 at the start."""
    return event.time.instant or 0 if isinstance(event.time, ExactValue) else 0


# ----------------------------------------
# The impacts of a run, one after the other, with the numbers that its tangent map needs.


class NoTangentMap(ValueError):
    """Where a run has no tangent map: nearby runs are not its image under one linear map.

    Attributes:
        events: how many events at the start have one.
    """

    def __init__(self, message: str, events: int = 0) -> None:
        super().__init__(message)
        self.events = events


Real: TypeAlias = arb | float


class Impact(NamedTuple):
    """Two circles, or a circle and a wall, at the moment before their impulse.

    Attributes:
        time: of the impact.
        a, b: the circles by index; for a wall b is None.
        dx, dy: from a's centre to b's; for a wall its normal, of any length.
        vx, vy: the velocity of b less that of a, before the impulse; for a wall that of a, less the wall's own. Under
            gravity it is the true one, at the impact.
        reach: r_a + r_b; for a wall |n|.
        wa, wb: inverse masses; for a wall 0.
        wall: which of the walls, or faces, of `Scene.surfaces` it is at; None for circles, or where that is not known.
    """

    time: Real
    a: int
    b: int | None
    dx: Real
    dy: Real
    vx: Real
    vy: Real
    reach: Real
    wa: Real
    wb: Real
    wall: int | None = None


def as_doubles(impact: Impact) -> tuple[int, int | None, float, float, float, float, float, float, float]:
    """All of an impact but its time. Two that all but graze approach by an ulp, not by rounding's zero."""
    dx, dy, vx, vy, reach, wa, wb = (float(number) for number in impact[3:10])
    slip = ULP * hypot(vx, vy) / (hypot(dx, dy) or 1.0)
    while impact.b is not None and slip and pair_approach(dx, dy, vx, vy) == 0.0:
        vx, vy, slip = vx - slip * dx, vy - slip * dy, 2.0 * slip
    return impact.a, impact.b, dx, dy, vx, vy, reach, wa, wb


def moving(scene: Scene) -> list[int]:
    """The circles that can move, by index: those whose displacements a tangent map carries."""
    return [k for k, circle in enumerate(scene.circles) if not circle.fixed]


def check_start(scene: Scene) -> None:
    """Refuses a scene whose nearby scenes are no scenes, or capture circles.

    Raises:
        NoTangentMap: if walls are of kinds of their own, if circles go out of play, touch at time 0 and go on touching,
            if a restitution is 0, or what has settled goes on.
    """
    if scene.restitution.sign() == 0:
        raise NoTangentMap("the scene has restitution 0, and what has met stays together")
    if other := scene.other_walls:
        raise NoTangentMap(f"the scene has a wall of kind {other[0].kind!r}, of which there is no tangent map")
    if scene.settle:
        raise NoTangentMap("the scene has settle = true, and of what walls carry there is no tangent map")
    if scene.capture:
        raise NoTangentMap("the scene takes circles out of play (capture), and nearby runs do so at other times")
    scene = scene.surfaces
    free = moving(scene)
    for i, j in scene.touching:
        a = scene.circles[i]
        if i not in free and j not in free:
            continue
        beyond = len(scene.circles) + len(scene.walls)
        if j >= beyond:
            side = scene.arc_sides[j - beyond]
            closing = side.r * ((a.x - side.x) * a.vx + (a.y - side.y) * a.vy)
        elif j >= len(scene.circles):
            wall = scene.walls[j - len(scene.circles)]
            nx, ny = wall.normal
            closing = nx * (a.vx - wall.vx) + ny * (a.vy - wall.vy)
        else:
            b = scene.circles[j]
            (ux, uy), (wx, wy) = a.drift, b.drift  # of ends that move; of circles 0
            closing = (b.x - a.x) * (b.vx + wx - a.vx - ux) + (b.y - a.y) * (b.vy + wy - a.vy - uy)
        if closing.sign() == 0:
            names = f"{scene.ids[i]} and {scene.ids[j]}"
            raise NoTangentMap(f"{names} touch from the start on: a displacement would make them overlap")


HELD_BITS = 240
"""Sizes from 2**-240 to 2**240 are held by doubles to the fourth power, which is what the formulas come to."""


def check_sizes(scene: Scene) -> None:
    """Refuses a scene of numbers whose products doubles, in which displacements are carried, do not hold.

    Raises:
        NoTangentMap: naming the sizes that they hold.
    """
    scene = scene.surfaces
    ends = [value for wall in scene.walls for value in (wall.x0, wall.y0, wall.x1, wall.y1)]
    ends += [value for side in scene.arc_sides for value in (side.x, side.y, side.r)]
    flights = [value for c in scene.circles for value in (c.x, c.y, c.r, c.vx, c.vy)]
    if not all(_held(value) for value in (*ends, *flights, *(scene.gravity or ()))):
        raise NoTangentMap(
            f"lengths, speeds or a gravity above 2**{HELD_BITS} or below 2**-{HELD_BITS}; choose other units"
        )


def _held(value: Quantity) -> bool:
    try:
        size = abs(float(value))
    except OverflowError:
        return False
    return 2.0**-HELD_BITS <= size <= 2.0**HELD_BITS or value.sign() == 0


def check_event(scene: Scene, event: Event) -> None:
    """Refuses an instant that nearby runs take in orders which differ in their outcome to the first order.

    Several contacts at one instant have a tangent map where no moving circle takes part in two of them, and where
    one that does meets nothing but walls and fixed circles in directions at right angles to each other, and these are
    all flat, or stand still at restitution 1: see `_check_bent`. With a moving partner they do not commute, for the
    time between two impacts then turns the second.

    Raises:
        NoTangentMap: naming the event and the circle.
    """
    if len(event.contacts) == 1:
        return
    free = {str(circle.id) for circle in scene.circles if not circle.fixed}
    met = Counter(name for pair in event.contacts for name in pair if name in free)
    for name, count in met.items():
        if count == 1:
            continue
        partners = {other for pair in event.contacts if name in pair for other in pair if other != name}
        if event.coupled or partners & free or len(event.impulses) != len(event.contacts):
            raise _order_matters(event, name)


def _order_matters(event: Event, name: str) -> NoTangentMap:
    order = "several contacts at one instant, whose order matters to nearby runs"
    return NoTangentMap(f"event {event.index}: {name} has {order}", event.index)


def _check_bent(scene: Scene, event: Event, struck: Iterable[Impact]) -> None:
    """Refuses a circle that meets two things at right angles at one instant, one of them round, of which one moves or
    takes energy.

    With normals m and n at right angles, and the surface along m bent by k, a displacement turns m by k (dx.n + v.n dt)
    towards n. So the first impact changes the velocity along m by v.n times that; taken after the other, which leaves
    -e v.n and -e dx.n, by e^2 times as much; where the other moves, not even the same at e = 1. Flat ones have k = 0.

    Raises:
        NoTangentMap: naming the event and the circle.
    """
    if scene.elastic and not scene.moving_walls:
        return
    met, bent = Counter[int](), set[int]()
    for impact in struck:
        both = (impact.a,) if impact.b is None else (impact.a, impact.b)
        met.update(both)
        bent.update(both if impact.b is not None else ())
    for k in sorted(bent):
        if met[k] > 1 and k < len(scene.circles) and not scene.circles[k].fixed:
            raise _order_matters(event, str(scene.circles[k].id))


def impacts(trajectory: Trajectory, events: int, bits: int | None = None) -> list[list[Impact]]:
    """The impacts of the first events of a run, event by event.

    Of an exact run they are balls, read off a replay of its log; of any other run floats, read off its states.

    Args:
        bits: the precision of the replay; by default as many as it takes for each number to be told to a double.

    Raises:
        NoTangentMap: where there is none (see `check_start`, `check_sizes`, `check_event`, `_check_bent`), from a
            reversal on, and from where two circles of an exact run graze.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> [[impact]] = impacts(ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 0)])), 1)
    >>> impact.a, impact.b, float(impact.time), float(impact.dx)
    (0, 1, 2.0, 2.0)
    """
    scene = trajectory.scene
    check_start(scene)
    check_sizes(scene)
    turned = events if trajectory.reversal is None else trajectory.reversal.after
    for event in trajectory.events[: min(turned, events)]:
        check_event(scene, event)
    if turned < events:
        raise NoTangentMap(f"the run turns back after {turned} events", turned)
    if isinstance(trajectory.motion, ExactMotion):
        motion = trajectory.motion
        if (graze := first_graze(trajectory, motion, events)) is not None:
            pair = f"{graze.one} and {graze.other}"
            raise NoTangentMap(f"before event {graze.events}, {pair} graze: nearby they hit or miss", graze.events)
        if bits is None:
            told = _sharply(trajectory, motion, events, together=False)
        else:
            told = _replayed(trajectory, motion, events, bits, together=False)
        found = [[impact for struck in mine for impact in struck] for mine in told]
    else:
        found = list(_read(trajectory, events))
    for event, mine in zip(trajectory.events, found, strict=False):
        _check_bent(scene, event, mine)
    return found


def rounds(trajectory: Trajectory, events: int) -> list[list[list[Impact]]]:
    """The impacts of the first events of an exact run, event by event and round by round.

    Those of a round all have the velocities that it finds. Nearby runs are here those that take the contacts of each
    instant in the same rounds: then there is a map from event to event, whatever meets at one instant.

    Raises:
        NoTangentMap: from a reversal, or a circle's leaving play, on; for a run of floats.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import catalogue
    >>> [[struck]] = rounds(ExactEngine().run(catalogue.build("lee")), 1)
    >>> [(impact.a, impact.b) for impact in struck]
    [(0, 1), (1, 2)]
    """
    if not isinstance(trajectory.motion, ExactMotion):
        raise NoTangentMap("rounds are read off the log of an exact run")
    turned = events if trajectory.reversal is None else trajectory.reversal.after
    if trajectory.scene.capture and trajectory.pocketings:
        first = min(float(entry.time) for entry in trajectory.pocketings)
        turned = min(turned, sum(float(event.time) < first for event in trajectory.events))
    if turned < events:
        raise NoTangentMap(f"velocities turn back, or a circle leaves play, after {turned} events", turned)
    return _sharply(trajectory, trajectory.motion, events, together=True)


def _sharply(trajectory: Trajectory, motion: ExactMotion, events: int, *, together: bool) -> list[list[list[Impact]]]:
    """The rounds of each event, with as many bits as it takes for each number to be told to a double."""
    bits = motion.log.lost + LEAST_BITS
    while True:
        found = _replayed(trajectory, motion, events, bits, together=together)
        with ball.precision(bits):
            if all(_sharp(impact) for mine in found for struck in mine for impact in struck):
                return found
        bits *= 2


ULP = 2.0**-52

LEAST_BITS = 320
"""Bits of the replay beyond what the run lost, at first."""

SHARP_BITS = 60
"""Accuracy of an impact's numbers at which doubles lose nothing by it."""


def _sharp(impact: Impact) -> bool:
    """Whether the numbers of an impact are accurate, each against what it is added to, and the approach by itself."""
    time, dx, dy, vx, vy, reach = (arb(number) for number in (impact.time, *impact[3:8]))
    if (dx * vx + dy * vy).rel_accuracy_bits() < SHARP_BITS:
        return False
    small = arb(2) ** -SHARP_BITS
    speed = abs(vx) + abs(vy)
    return bool(
        dx.rad() + dy.rad() < small * reach
        and vx.rad() + vy.rad() < small * speed
        and time.rad() * speed < small * reach
    )


def _replayed(
    trajectory: Trajectory, motion: ExactMotion, events: int, bits: int, *, together: bool
) -> list[list[list[Impact]]]:
    log = motion.log
    found: list[list[list[Impact]]] = []
    with ball.precision(bits):
        state = CentredState(log.scene, log.centred)
        done = 0
        for event in trajectory.events[:events]:
            upto = steps_through(event)
            mine: list[list[Impact]] = []
            for step in log.steps[done:upto]:
                if isinstance(step, Kick):
                    mine.append(list(_struck(state, step.links, together)))
                elif not isinstance(step, Go):
                    touch = "two touch there without a push of their own: a displacement would make them overlap"
                    why = touch if isinstance(step, Leave) else "the run turns back at it"
                    raise NoTangentMap(f"event {event.index}: {why}", event.index)
                state.do(step)
            done = upto
            found.append(mine)
    return found


def _struck(state: BallState, links: Sequence[Touch], together: bool) -> Iterator[Impact]:
    """The impacts of one round: together, or the later ones with the velocities that the former leave."""
    speeds = {i: true_speed(state, i) for link in links for i in link.circles}
    for link in links:
        i, j, *_ = link
        ux, uy = speeds[i]
        if is_flat(link):
            line, (wx, wy) = state.line(link.circle, link.wall), state.drifts.get(link.wall, (state.zero, state.zero))
            ux, uy = ux - wx, uy - wy
            yield Impact(
                state.instant, i, None, line.nx, line.ny, ux, uy, line.length, state.zero, state.zero, link.wall
            )
            if not together:
                left = wall_bounce(ux, uy, line.nx, line.ny, line.nn)
                speeds[i] = _damped(ux, left[0], state.share) + wx, _damped(uy, left[1], state.share) + wy
            continue
        if is_arc(link):
            j = state.n + link.arc  # a circle that nothing moves, beyond those of the scene
            speeds[j] = state.zero, state.zero
        (a, b), (dx, dy), (vx, vy) = link.ends(state), state.span(link), speeds[j]
        reach = -state.reach(a, b) if link.hollow else state.reach(a, b)
        if is_pair(link) and j in state.scene.ends:
            _check_corner(state, link, dx, dy)
        yield Impact(state.instant, i, j, dx, dy, vx - ux, vy - uy, reach, a.w, b.w)
        if together:
            continue
        jx, jy = (state.damping(part) for part in pair_impulse(dx, dy, vx - ux, vy - uy, reach, a.w, b.w))
        speeds[i] = ux - a.w * jx, uy - a.w * jy
        speeds[j] = vx + b.w * jx, vy + b.w * jy


def true_speed(state: ReplayState[arb], i: int) -> tuple[arb, arb]:
    """The velocity of a circle at the instant at hand: that of the falling frame, and what gravity has added; of an end
    that moves, its own."""
    vx, vy = state.paces.get(i, state.bodies[i].flight[2:4])
    if state.falling is None or i in state.pegs:
        return vx, vy
    return fall_speed(vx, state.falling.hx, state.instant), fall_speed(vy, state.falling.hy, state.instant)


def _damped(before: N, after: N, share: N | None) -> N:
    return after if share is None else damped(before, after, share)


def _check_corner(state: BallState, link: Pair, dx: arb, dy: arb) -> None:
    """Refuses an impact on an end where a face begins: nearby runs meet the one or the other, which bend differently.

    Raises:
        NoTangentMap: naming the two.
    """
    end = state.scene.circles[link.b]
    for side in state.scene.arc_sides:
        rx, ry = end.x - side.x, end.y - side.y
        if side.id is not None and (rx * rx + ry * ry - side.r * side.r).sign() == 0:
            across = dx * state.constant(ry) - dy * state.constant(rx)
            if not (across > 0 or across < 0):
                who = name_of(state.scene, link)
                raise NoTangentMap(f"{who} meet where an end becomes an arc: nearby they meet the one or the other")
    for k in state.scene.faces:
        face = state.scene.walls[k]
        if face.id is not None and (face.vx, face.vy) == end.drift and begins_at(face, end):
            nx, ny = face.normal
            along = dx * state.constant(ny) - dy * state.constant(nx)
            if not (along > 0 or along < 0):
                who = name_of(state.scene, link)
                raise NoTangentMap(f"{who} meet where an end becomes a face: nearby they meet the one or the other")


def _read(trajectory: Trajectory, events: int) -> Iterator[list[Impact]]:
    scene = trajectory.scene
    if scene.polygons:
        raise NoTangentMap("of polygons only runs of the exact engine distinguish faces from corners")
    if scene.arcs:
        raise NoTangentMap("of arcs only runs of the exact engine distinguish sides from ends")
    if scene.segments:
        raise NoTangentMap("of segments only runs of the exact engine distinguish faces from ends")
    place = {str(c.id): k for k, c in enumerate(scene.circles)}
    walls = {str(w.id): (float(w.normal[0]), float(w.normal[1]), float(w.vx), float(w.vy)) for w in scene.walls}
    radii, weights = [float(c.r) for c in scene.circles], [float(c.inverse_mass) for c in scene.circles]
    speeds = [(float(c.vx), float(c.vy)) for c in scene.circles]
    since = [0.0] * len(speeds)
    share = None if scene.elastic else float((scene.restitution + 1) / 2)
    gx, gy = (0.0, 0.0) if scene.gravity is None else (float(scene.gravity[0]), float(scene.gravity[1]))
    for event in trajectory.events[:events]:
        time, after = float(event.time), trajectory.after(event.index).array()
        mine: list[Impact] = []
        if scene.gravity is not None:
            for k in {place[name] for pair in event.contacts for name in pair if name in place} - scene.pegs:
                (ux, uy), late, since[k] = speeds[k], time - since[k], time
                speeds[k] = ux + gx * late, uy + gy * late
        for first, second in event.contacts:
            i = place[first]
            ux, uy = speeds[i]
            if second in walls:
                nx, ny, wx, wy = walls[second]
                ux, uy = ux - wx, uy - wy
                mine.append(Impact(time, i, None, nx, ny, ux, uy, (nx * nx + ny * ny) ** 0.5, 0.0, 0.0))
                left = wall_bounce(ux, uy, nx, ny, nx * nx + ny * ny)
                speeds[i] = _damped(ux, left[0], share) + wx, _damped(uy, left[1], share) + wy
                continue
            j = place[second]
            dx, dy = (float(value) for value in after[j, :2] - after[i, :2])
            reach, wa, wb, (vx, vy) = radii[i] + radii[j], weights[i], weights[j], speeds[j]
            mine.append(Impact(time, i, j, dx, dy, vx - ux, vy - uy, reach, wa, wb))
            jx, jy = (part * (share or 1.0) for part in pair_impulse(dx, dy, vx - ux, vy - uy, reach, wa, wb))
            speeds[i] = ux - wa * jx, uy - wa * jy
            speeds[j] = vx + wb * jx, vy + wb * jy
        for name in {name for pair in event.contacts for name in pair if name in place}:
            speeds[place[name]] = (float(after[place[name], 2]), float(after[place[name], 3]))
        yield mine
