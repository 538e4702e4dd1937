"""One run in pymunk: step by step to its end, what is recorded of it, and what it hands back."""

from __future__ import annotations

import math
import signal
import threading
import time as clock
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import combinations
from typing import Any, Protocol

import pymunk

from ..scenarios.engine import horizon
from ..scenarios.errors import TimeIsUp
from ..scenarios.numbers.precision import Double
from ..scenarios.numbers.quantity import QuantityLike
from ..scenarios.scene import Scene
from ..scenarios.trajectory import (
    Contact,
    Event,
    OnProgress,
    Progress,
    Reversal,
    Stop,
    StopReason,
    Tie,
    TieProof,
    Trajectory,
)
from .knots import DoubleKnot, DoubleMotion, SteppedFall, SteppedMotion
from .pocket_entries import entries, last_entry
from .pymunk_space import PymunkSpace, elasticity_of
from .resting import Resting

# -- What is kept of a run in pymunk: an event a step with impulses, a knot for each body that it touched.


class Recorder:
    """The events and knots of a run, taken down step by step.

    Attributes:
        touched: the pairs that overlap in the step just made, as places in `scene.ids`; empty after `step`.
        settling: circles that an overlap's correction moves once more in the step to come; empty unless the
            space corrects overlaps.
        failures: what was raised while pymunk reported a contact. C code in between prints an exception and
            goes on, so it is kept here for the run to raise.
        events, knots: as in the trajectory.
        contact_steps: number of steps in which something touched.
        resting_contacts: number of times that a pair overlapped without an impulse.
        resting: what lies on walls, where the scene has that go on.
    """

    def __init__(self, scene: Scene, world: PymunkSpace, dt: float) -> None:
        self.touched: list[tuple[int, int]] = []
        self.settling: set[int] = set()
        self.failures: list[BaseException] = []
        self.events: list[Event] = []
        self.knots: list[list[DoubleKnot]] = [
            [(0.0, body.position.x, body.position.y, body.velocity.x, body.velocity.y)] for body in world.bodies
        ]
        self.contact_steps = self.resting_contacts = 0
        self.resting = Resting(scene, dt) if scene.settle else None
        self._pushed: list[tuple[int, int]] = []
        self._impulses: dict[tuple[int, int], float] = {}
        self._world, self._dt = world, dt
        self._gravity = (0.0, 0.0) if scene.gravity is None else tuple(world.space.gravity)
        self._corrects = world.space.collision_bias < 1
        self._falls = scene.gravity is not None
        self._ids = scene.ids
        self._moving = {
            place: (body, self.knots[place])
            for place, body in enumerate(world.bodies)
            if body.body_type == pymunk.Body.DYNAMIC
        }
        self._singles: dict[tuple[int, int], tuple[Contact]] = {}
        self._listen()

    def _listen(self) -> None:
        """Has pymunk report every pair that overlaps in a step, once its impulse is known."""
        places, touched, pushed, failures = self._world.places, self.touched, self._pushed, self.failures
        impulses = self._impulses if self.resting is not None else None

        def after_contact(arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
            try:
                first, second = arbiter.shapes
                i, j = places[first], places[second]
                pair = (i, j) if i < j else (j, i)
                if arbiter.total_impulse != (0.0, 0.0) and pair not in pushed:  # a polygon may be of several shapes
                    pushed.append(pair)
                if impulses is not None:
                    impulses[pair] = impulses.get(pair, 0.0) + arbiter.total_impulse.length
                if pair not in touched:
                    touched.append(pair)
            except BaseException as error:
                failures.append(error)

        self._world.space.on_collision(post_solve=after_contact)

    def tie_knots(self, time: float) -> None:
        """Notes where every circle is and how it goes on."""
        self._tie(time, self._moving, all_of_them=True)

    def _tie(self, time: float, places: Iterable[int], all_of_them: bool) -> None:
        """A knot for all of the circles at these places, or only for those whose velocity has changed."""
        moving = self._moving
        for place in places:
            if place in moving:
                body, knots = moving[place]
                vx, vy = body.velocity
                if all_of_them or self._falls or knots[-1][3:] != (vx, vy):
                    x, y = body.position
                    knots.append((time, x, y, vx, vy))

    def step(self, time: float) -> bool:
        """Notes what the step that ended at `time` did; whether that was an event."""
        touched, pushed = self.touched, self._pushed
        if self._world.joints:
            for pairs in (touched, pushed):
                pairs[:] = dict.fromkeys(map(self._world.named, pairs))
        if self.resting is not None:
            if not self._corrects and touched == pushed and self.resting.holds(time, pushed, self._velocity):
                self.contact_steps += 1
                for told in (touched, pushed, self._impulses):
                    told.clear()
                return False
            pushed[:] = self._collisions(self.resting, time)
        collided = bool(pushed)
        if len(touched) == 1 and not self._corrects:
            self._tie(time, touched[0], all_of_them=False)
        else:
            places = {place for pair in touched for place in pair}
            self._tie(time, places | self.settling, all_of_them=self._corrects)
            self.settling.clear()
            if self._corrects:
                self.settling.update(places)
        if len(pushed) == 1:
            contacts = self._single(pushed[0])
            self.events.append(Event(len(self.events), Double(time), contacts, contacts))
        elif pushed:
            self.events.append(self._several(time))
        self.contact_steps += bool(touched)
        self.resting_contacts += len(touched) - len(pushed)
        touched.clear()
        pushed.clear()
        return collided

    def _velocity(self, k: int) -> tuple[float, float]:
        return self._world.bodies[k].velocity

    def _collisions(self, resting: Resting, time: float) -> list[tuple[int, int]]:
        """Those that were pushed in a step, but for what lies on a wall."""
        bodies, (gx, gy) = self._world.bodies, self._gravity
        impulses = dict[tuple[int, int], float]()
        for pair, impulse in self._impulses.items():
            named = self._world.named(pair)
            impulses[named] = impulses.get(named, 0.0) + impulse
        self._impulses.clear()

        def before(k: int) -> tuple[float, float]:
            if k not in self._moving:
                return 0.0, 0.0
            t, _, _, vx, vy = self.knots[k][-1]
            lag = time - resting.pushed(k, t)
            return vx + gx * lag, vy + gy * lag

        def normal(pair: tuple[int, int]) -> tuple[float, float]:
            (nx, ny), wall = self._normal(pair), pair[1] - len(bodies)
            side = -1 if wall < 0 else self._world.sides[pair[0]][wall] if wall < len(self._world.walls) else 1
            length = side * math.hypot(nx, ny) or 1.0
            return nx / length, ny / length

        return resting.collisions(
            time, self._pushed, before, self._velocity, normal, lambda pair: impulses.get(pair, 0.0)
        )

    def raise_failure(self) -> None:
        """Raises what a report of a contact raised, if one did."""
        if self.failures:
            raise self.failures[0]

    def _single(self, pair: tuple[int, int]) -> tuple[Contact]:
        contact = self._singles.get(pair)
        if contact is None:
            contact = self._singles[pair] = (Contact(self._ids[pair[0]], self._ids[pair[1]]),)
        return contact

    def _several(self, time: float) -> Event:
        pairs = sorted(self._pushed)
        impulses = tuple(self._single(pair)[0] for pair in self._pushed)
        contacts = tuple(self._single(pair)[0] for pair in pairs)
        tie = Tie(contacts, TieProof.FLOAT)
        return Event(len(self.events), Double(time), contacts, impulses, (tie,), self._coupled(pairs))

    def _coupled(self, pairs: list[tuple[int, int]]) -> bool:
        """Whether a moving circle has two of the contacts, not at right angles in pymunk's own numbers."""
        normals: dict[int, list[tuple[float, float]]] = {}
        for pair in pairs:
            nx, ny = self._normal(pair)
            for place in self._moving.keys() & pair:
                others = normals.setdefault(place, [])
                if any(nx * ox + ny * oy != 0 for ox, oy in others):
                    return True
                others.append((nx, ny))
        return False

    def _normal(self, pair: tuple[int, int]) -> tuple[float, float]:
        first, second = pair
        bodies = self._world.bodies
        walls = self._world.walls
        if second >= len(bodies) + len(walls):
            number = second - len(bodies) - len(walls)
            if number >= len(self._world.bars):
                return self._world.from_outline(number - len(self._world.bars), *bodies[first].position)
            return self._world.from_bar(number, *bodies[first].position)
        if second >= len(bodies):
            nx, ny, _ = self._world.walls[second - len(bodies)]
            return nx, ny
        return bodies[second].position - bodies[first].position


# -- One run in pymunk: step by step to its end, and what it hands back.

STRETCH = 256
"""Steps between two looks at the clock: about a millisecond."""

PROGRESS_SECONDS = 0.2


class Interrupts:
    """Ctrl-C, kept until a run looks for it.

    A KeyboardInterrupt that is raised while pymunk reports a contact never gets out of the C code that asked for the
    report; one that is raised between a step and its record leaves the two apart.

    Attributes:
        came: whether it was pressed.
    """

    def __init__(self) -> None:
        self.came = False

    def note(self, number: int, frame: Any) -> None:
        """Keeps the first; whoever presses it again does not want to wait."""
        if self.came:
            raise KeyboardInterrupt
        self.came = True

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Keeps it in the body, where it is Python's own to handle."""
        mine = threading.current_thread() is threading.main_thread()
        if not mine or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
            yield
            return
        signal.signal(signal.SIGINT, self.note)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, signal.default_int_handler)


class Stepper(Protocol):
    """What a run needs of its engine: its name, its parameters as shown, its step, its limit, the scene's space."""

    @property
    def name(self) -> str:
        """See `Engine`."""
        ...

    @property
    def parameters(self) -> dict[str, Any]:
        """As a trajectory shows them."""
        ...

    @property
    def dt(self) -> float:
        """The time step."""
        ...

    @property
    def max_steps(self) -> int:
        """Steps after which no run goes on."""
        ...

    def steps_for(self, scene: Scene) -> int:
        """Steps for which the walls of its space reach far enough."""
        ...

    def space(self, scene: Scene) -> PymunkSpace:
        """The scene as a pymunk space."""
        ...


class Run:
    """One run under way."""

    def __init__(
        self,
        engine: Stepper,
        scene: Scene,
        until: QuantityLike | None,
        events: int | None,
        progress: OnProgress | None,
    ) -> None:
        self.engine, self.scene, self.progress = engine, scene, progress
        time_limit, self.event_limit = horizon(scene, until, events)
        self.end = math.inf if time_limit is None else float(time_limit)
        self.turn_at = math.inf if scene.reverse_at is None else float(scene.reverse_at)
        self.turn_after = scene.reverse_after
        turns = scene.reverse_at is not None or scene.reverse_after is not None
        self.returns = turns and until is None and events is None
        if self.returns:
            self.end, self.event_limit = 2 * self.turn_at, None
        self.world = engine.space(scene)
        self.record = Recorder(scene, self.world, engine.dt)
        self.laying = self.reach = engine.steps_for(scene)
        self.reversal: Reversal | None = None
        self.steps = self.last_event_step = 0
        self.base, self.base_step = 0.0, 0
        self.told = clock.monotonic()
        self.interrupts = Interrupts()
        self.budget = ""

    @property
    def now(self) -> float:
        """The time at the end of the last step: a multiple of dt after time 0, or after `reverse_at`."""
        return self.base + (self.steps - self.base_step) * self.engine.dt

    @property
    def done(self) -> int:
        """Number of events so far."""
        return len(self.record.events)

    def trajectory(self) -> Trajectory:
        """Runs to the end."""
        with self.interrupts.kept():
            stop, final = self.play()
        if stop.reason is StopReason.QUIET:
            final = last_entry(self.scene, self.motion(final), final)
        self.glide(final)
        self.record.tie_knots(final)
        motion = self.motion(final)
        return Trajectory(
            scene=self.scene,
            engine=self.engine.name,
            parameters=self.parameters(),
            events=tuple(self.record.events),
            stop=stop,
            final_time=Double(final),
            motion=motion,
            reversal=self.reversal,
            pocketings=entries(self.scene, motion, final) if self.scene.pockets else (),
            plan={
                "steps": self.steps,
                "steps with contacts": self.record.contact_steps,
                "contacts without impulse": self.record.resting_contacts,
            },
            notes=tuple(self.notes()),
            settlings=tuple(self.record.resting.settlings) if self.record.resting is not None else (),
        )

    def parameters(self) -> dict[str, Any]:
        """The engine's, with the gravity of the scene, and with the elasticity that makes up its restitution."""
        told = self.engine.parameters
        if self.scene.gravity is not None:
            told = {**told, "gravity": tuple(self.world.space.gravity)}
        return told if self.scene.elastic else {**told, "elasticity": elasticity_of(self.scene)}

    def motion(self, final: float) -> DoubleMotion:
        """Straight flight between knots, and between steps under gravity."""
        if self.scene.gravity is None:
            return SteppedMotion(self.record.knots, final)
        gx, gy = self.world.space.gravity
        rests = {} if self.record.resting is None else self.record.resting.spans(final)
        return SteppedFall(self.record.knots, final, (gx, gy), self.engine.dt, self.scene.pegs, rests=rests)

    def play(self) -> tuple[Stop, float]:
        """Runs to the end; why it ended, and when."""
        while True:
            pending = self.reversal is None
            turn_at, turn_after = (self.turn_at, self.turn_after) if pending else (math.inf, None)
            goal = min(self.end, turn_at)
            counts = [count for count in (self.event_limit, turn_after) if count is not None]
            reason = self.advance(goal, min(counts, default=None))
            if reason is StopReason.EVENTS and self.done == turn_after:
                self.reverse(self.now)
                if self.returns:
                    self.end = 2 * self.now
            if reason is StopReason.EVENTS and self.done == self.event_limit:
                return Stop(reason, f"{reason.value} ({self.event_limit})"), self.now
            if reason is StopReason.HORIZON and goal == turn_at:
                self.reverse(turn_at)
            elif reason is StopReason.HORIZON or (reason is StopReason.QUIET and self.end < math.inf):
                return self.horizon_stop(), self.end
            elif reason is StopReason.QUIET:
                return Stop(reason, reason.value), self.now
            elif reason is StopReason.INTERRUPTED:
                return Stop(reason, f"{reason.value}: after {self.done} events"), self.now
            elif reason is StopReason.BUDGET:
                limit = self.budget or f"{self.engine.max_steps} steps of {self.engine.dt!r}; raise max_steps, or dt"
                return Stop(reason, f"{reason.value}: {limit}"), self.now

    def horizon_stop(self) -> Stop:
        if self.returns:
            return Stop(StopReason.HORIZON, "back at twice the time of the reversal")
        return Stop(StopReason.HORIZON, f"{StopReason.HORIZON.value} {self.end!r}")

    def advance(self, goal: float, count: int | None) -> StopReason:
        """Steps on to the last step by `goal` (HORIZON), `count` events, quiet, the budget's end, or Ctrl-C."""
        step, dt, base, base_step = self.world.space.step, self.engine.dt, self.base, self.base_step
        record, touched, settling = self.record, self.record.touched, self.record.settling
        wanted = self.last_step(goal)
        last = int(min(wanted, self.engine.max_steps))
        while self.steps < last:
            if self.steps == self.laying:
                self.world = self.world.laid_anew(dt, self.reach * dt)
                self.laying += self.reach
            stretch_end = min(self.steps + STRETCH, last, self.laying)
            for number in range(self.steps + 1, stretch_end + 1):
                step(dt)
                if (touched or settling) and record.step(base + (number - base_step) * dt):
                    self.steps = self.last_event_step = number
                    if self.done == count:
                        return StopReason.EVENTS
            self.steps = stretch_end
            record.raise_failure()
            ended = self.tell()
            if ended is not None:
                return ended
            if self.may_be_quiet() and self.quiet():
                if record.resting is not None:
                    record.resting.stays()
                return StopReason.QUIET
        return StopReason.HORIZON if self.steps == wanted else StopReason.BUDGET

    def last_step(self, goal: float) -> float:
        """The number of the last step that ends by `goal`."""
        if goal == math.inf:
            return math.inf
        whole = round((goal - self.base) / self.engine.dt)
        if self.base + whole * self.engine.dt > goal:
            whole -= 1
        return self.base_step + whole

    def glide(self, time: float) -> None:
        """Moves all circles straight on from the last step to a time."""
        rest = time - self.now
        if rest:
            for body in self.world.moving:
                body.position += body.velocity * rest
            self.base, self.base_step = time, self.steps

    def reverse(self, time: float) -> None:
        """Negates every velocity at a time."""
        self.glide(time)
        for body in self.world.moving:
            body.velocity = -body.velocity
        self.record.tie_knots(time)
        self.reversal = Reversal(self.done, Double(time))
        self.last_event_step = self.steps

    def tell(self) -> StopReason | None:
        """Tells how far the run is; why it has to end here, if it has."""
        try:
            if self.progress is not None and clock.monotonic() - self.told >= PROGRESS_SECONDS:
                self.told = clock.monotonic()
                self.progress(Progress(self.done, self.now))
        except TimeIsUp as outcome:
            self.budget = str(outcome)
            return StopReason.BUDGET
        except KeyboardInterrupt:
            return StopReason.INTERRUPTED
        if self._idles():
            self.budget = f"no limit on the time, and nothing new by {self.now:g}; give until"
            return StopReason.BUDGET
        if self.scene.moving_walls and any(body.velocity.length > self.world.speed for body in self.world.moving):
            self.budget = f"a circle is faster than {self.world.speed:g}, up to which walls reach far enough"
            return StopReason.BUDGET
        return StopReason.INTERRUPTED if self.interrupts.came else None

    def _idles(self) -> bool:
        """Whether a run that sees no quiet, and has no limit on its time, has gone on for long enough."""
        if self.end < math.inf or self.reach == self.engine.max_steps:
            return False
        return self.steps - self.last_event_step >= self.reach

    def may_be_quiet(self) -> bool:
        """Whether to look: after 1, 2, 4... stretches without an event, unless a reversal is due by time."""
        idle = (self.steps - self.last_event_step) // STRETCH
        due = self.reversal is None and self.turn_at <= self.end and self.turn_at < math.inf
        stands = self.scene.gravity is None and not self.scene.moving_walls
        resting = self.record.resting
        still = stands or (resting is not None and resting.all_lie(self.now))
        return still and not due and idle > 0 and idle & (idle - 1) == 0

    def quiet(self) -> bool:
        """Whether no two circles and no circle and wall come nearer to each other: then none ever will.

        Of what lies on walls, where all do, by more than rounding, which pushes it on for ever.
        """
        flights = [(*body.position, *body.velocity) for body in self.world.bodies]
        resting, speeds = self.record.resting, [body.velocity.length for body in self.world.moving]
        room = 0.0 if resting is None else -resting.room(speeds)
        for sides, (_, _, vx, vy) in zip(self.world.sides, flights, strict=True):
            if any(
                side * (vx * nx + vy * ny) < room for side, (nx, ny, _) in zip(sides, self.world.walls, strict=True)
            ):
                return False
        for body in self.world.moving:  # a distance from a segment is convex along a flight
            for away in self.world.ways_from(*body.position):
                if away[0] * body.velocity[0] + away[1] * body.velocity[1] < room * math.hypot(*away):
                    return False
        return not any(
            (x2 - x1) * (vx2 - vx1) + (y2 - y1) * (vy2 - vy1) < room * math.hypot(x2 - x1, y2 - y1)
            for (x1, y1, vx1, vy1), (x2, y2, vx2, vy2) in combinations(flights, 2)
        )

    def notes(self) -> Iterable[str]:
        """What is to be known of the run besides its events."""
        radii = [float(circle.r) for circle in self.scene.circles]
        smallest = min((radius for radius in radii if radius > 0), default=math.inf)
        if self.world.speed * self.engine.dt > smallest:
            speed = max(math.hypot(knot[3], knot[4]) for knots in self.record.knots for knot in knots)
            if speed * self.engine.dt > smallest:
                yield (
                    f"the speed {speed:.3g} makes more than the smallest radius {smallest:.3g} in one step: "
                    "circles may have passed through each other; reduce dt"
                )
        if radii.count(0.0) > 1:
            yield "two point balls never overlap, so that pymunk cannot see them collide"
        if self.scene.tie_policy.name != "simultaneous":
            yield f"tie policy {self.scene.tie_policy}: pymunk solves all contacts of a step at once instead"
