"""The pymunk engine: a scene played by the game engine Chipmunk, by time steps."""

from __future__ import annotations

import math
import signal
import threading
import time as clock
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
import pymunk

from ..scenarios.engine import SCENE_KEYS, Declared, horizon
from ..scenarios.errors import SceneError, TimeIsUp
from ..scenarios.quantity import QuantityLike
from ..scenarios.scene import Scene
from ..scenarios.trajectory import (
    OnProgress,
    Progress,
    Reversal,
    Stop,
    StopReason,
    Trajectory,
)
from . import pymunk_space
from .knots import DoubleMotion
from .pymunk_pockets import entries
from .pymunk_record import Record
from .pymunk_space import PymunkSpace, build_space

STRETCH = 256
"""Steps between two looks at the clock: about a millisecond."""

PROGRESS_SECONDS = 0.2

DEFAULT_MAX_STEPS = 10_000_000
"""Some fifteen seconds for ten circles."""


@dataclass(frozen=True)
class PymunkEngine(Declared):
    """Plays scenes in pymunk, the one engine here that shares no formula with the others.

    Pymunk knows no collision times. At every step it moves each circle on by `dt`, finds the circles that
    overlap by then, and gives each overlapping pair an impulse. So

    - an event's time is that of the step that found it, late by at most `dt`; circles have flown into each
      other meanwhile, and nothing gives that back, so that errors of the order of `dt` add up;
    - all impulses of one step are one event, with the evidence `TieProof.FLOAT`;
    - a contact is a collision if pymunk gave it an impulse; circles that only touch are none;
    - the order among contacts of one step is pymunk's own, whatever the scene's tie policy;
    - `until` and `reverse_at` between two steps are reached by straight flight from the step before.

    The time step never varies within a run: after a change, pymunk rescales the impulse that it keeps for a
    contact that persists, and so can pull circles together that have just bounced.

    Attributes:
        dt: the time step. The default is the power of two next to the 1/240 of a game that makes four
            substeps a frame; step times k/256 are exact in doubles.
        iterations: rounds of pymunk's solver over the contacts of a step; its own default is 10. Steps
            without contacts cost nothing more.
        collision_slop: overlap that pymunk leaves alone; of no effect while `collision_bias` is 1.
        collision_bias: share of an overlap that remains after a unit of time. The default, 1, never pushes
            overlapping circles apart other than by their bounce, so that between knots they fly straight.
            Pymunk's own default is 0.9**60.
        max_steps: steps after which a run stops with `StopReason.BUDGET`.

    Raises:
        SceneError: for a parameter out of its range.

    >>> from truebreak.scenarios import Circle, Scene
    >>> run = PymunkEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 0)]), until=4)
    >>> [(event.time, *event.contacts) for event in run.events]
    [(2.00390625, Contact(first='c1', second='c2'))]
    >>> run.final["c1"].vx, run.final["c2"].vx
    (0.0, 1.0)
    """

    dt: float = 1 / 256
    iterations: int = 64
    collision_slop: float = 0.0
    collision_bias: float = 1.0
    max_steps: int = DEFAULT_MAX_STEPS

    def __post_init__(self) -> None:
        if not 0 < self.dt < math.inf:
            raise SceneError(f"engine 'pymunk': dt = {self.dt!r}: a time step must be above zero, and finite")
        if not 0 <= self.collision_slop < math.inf:
            raise SceneError(f"engine 'pymunk': collision_slop = {self.collision_slop!r}: must be 0 or above")
        if not 0 <= self.collision_bias <= 1:
            raise SceneError(f"engine 'pymunk': collision_bias = {self.collision_bias!r}: not in 0 to 1")
        for key in ("iterations", "max_steps"):
            value = getattr(self, key)
            if isinstance(value, bool) or not isinstance(value, int) or value < 1:
                raise SceneError(f"engine 'pymunk': {key} = {value!r}: must be a whole number from 1")

    @property
    def name(self) -> str:
        """`pymunk`."""
        return "pymunk"

    @property
    def step(self) -> float:
        """`dt`."""
        return self.dt

    @property
    def bits(self) -> int:
        """53: Chipmunk counts in doubles."""
        return 53

    @property
    def rounds_input(self) -> bool:
        """True: a scene is rounded to the nearest doubles."""
        return True

    @property
    def scene_keys(self) -> frozenset[str]:
        """All but `capture`, which pymunk has no notion of, and `tie_policy`: it solves all contacts of a step."""
        return SCENE_KEYS - {"capture", "tie_policy"}

    def finer(self) -> PymunkEngine:
        """Half the time step, and room for twice the steps."""
        return replace(self, dt=self.dt / 2, max_steps=2 * self.max_steps)

    def firmer(self) -> PymunkEngine:
        """Twice the iterations of pymunk's solver."""
        return replace(self, iterations=2 * self.iterations)

    @property
    def parameters(self) -> dict[str, Any]:
        """All that decides how pymunk plays a scene: the fields, and what is the same in every run."""
        return {
            **asdict(self),
            "collision_persistence": pymunk_space.COLLISION_PERSISTENCE,
            "elasticity": pymunk_space.ELASTICITY,
            "friction": pymunk_space.FRICTION,
            "damping": pymunk_space.DAMPING,
            "gravity": pymunk_space.GRAVITY,
            "pymunk": pymunk.version,
            "chipmunk": pymunk.chipmunk_version,
        }

    def space(self, scene: Scene) -> PymunkSpace:
        """The scene as a pymunk space; see `build_space`.

        It is made for the longest run that `max_steps` allow, never for a limit of the caller's: the ends of its walls
        depend on it, to the last bit, and a history must not depend on when it is to end.
        """
        return build_space(
            scene,
            dt=self.dt,
            duration=self.max_steps * self.dt,
            iterations=self.iterations,
            slop=self.collision_slop,
            bias=self.collision_bias,
        )

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """The history of `scene`; see `Engine.run`.

        With a reversal, and no limit from the caller, the run lasts to twice the time of the reversal.

        Raises:
            SceneError: for a limit that is not above zero, for pockets that capture, which pymunk has no
                notion of, and as `build_space`.
        """
        if scene.capture and scene.pockets:
            raise SceneError(
                f"{scene.name!r}: capture = true: engine 'pymunk' cannot take circles out of play; "
                "set capture = false, or use another engine"
            )
        return _Run(self, scene, until, events, progress).trajectory()


class _Interrupts:
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


class _Run:
    """One run under way."""

    def __init__(
        self,
        engine: PymunkEngine,
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
        self.record = Record(scene, self.world)
        self.reversal: Reversal | None = None
        self.steps = self.last_event_step = 0
        self.base, self.base_step = 0.0, 0
        self.told = clock.monotonic()
        self.interrupts = _Interrupts()
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
        with self.interrupts.kept():
            stop, final = self.play()
        self.glide(final)
        self.record.tie_knots(final)
        return Trajectory(
            scene=self.scene,
            engine=self.engine.name,
            parameters=self.engine.parameters,
            events=tuple(self.record.events),
            stop=stop,
            final_time=final,
            motion=DoubleMotion(self.record.knots, final),
            reversal=self.reversal,
            pocketings=entries(self.scene, self.record.knots, final) if self.scene.pockets else (),
            plan={
                "steps": self.steps,
                "steps with contacts": self.record.contact_steps,
                "contacts without impulse": self.record.resting_contacts,
            },
            notes=tuple(self.notes()),
        )

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
            stretch_end = min(self.steps + STRETCH, last)
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
        self.reversal = Reversal(self.done, time)
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
        return StopReason.INTERRUPTED if self.interrupts.came else None

    def may_be_quiet(self) -> bool:
        """Whether to look: after 1, 2, 4... stretches without an event, unless a reversal is due by time."""
        idle = (self.steps - self.last_event_step) // STRETCH
        due = self.reversal is None and self.turn_at <= self.end and self.turn_at < math.inf
        return not due and idle > 0 and idle & (idle - 1) == 0

    def quiet(self) -> bool:
        """Whether no two circles and no circle and wall come nearer to each other: then none ever will."""
        place = np.array([tuple(body.position) for body in self.world.bodies])
        speed = np.array([tuple(body.velocity) for body in self.world.bodies])
        for number, (nx, ny, _) in enumerate(self.world.walls):
            side = np.array([sides[number] for sides in self.world.sides])
            if np.any(side * (speed @ (nx, ny)) < 0):
                return False
        return not any(
            np.any(np.einsum("ij,ij->i", place[i + 1 :] - place[i], speed[i + 1 :] - speed[i]) < 0)
            for i in range(len(place) - 1)
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


def bench_overhead(
    scene: Scene, steps: int, engine: PymunkEngine | None = None, rounds: int = 9
) -> tuple[float, float]:
    """Seconds that `steps` steps take: in a bare loop over `space.step`, and in the engine.

    Both play the same space, including its building, by turns; each time is the least of `rounds`.

    >>> from truebreak.scenarios import Circle, Scene
    >>> bare, recorded = bench_overhead(Scene([Circle(0, 0, vx=1), Circle(4, 0, vx=-1)]), steps=200, rounds=1)
    >>> bare > 0 and recorded > 0
    True
    """
    engine = PymunkEngine() if engine is None else engine
    engine = replace(engine, max_steps=max(engine.max_steps, steps))
    duration = steps * engine.dt
    bare: list[float] = []
    recorded: list[float] = []
    for _ in range(rounds):
        begin = clock.perf_counter()
        step, dt = engine.space(scene).space.step, engine.dt
        for _ in range(steps):
            step(dt)
        bare.append(clock.perf_counter() - begin)
        begin = clock.perf_counter()
        if engine.run(scene, until=duration).stop.reason is StopReason.INTERRUPTED:
            raise KeyboardInterrupt
        recorded.append(clock.perf_counter() - begin)
    return min(bare), min(recorded)
