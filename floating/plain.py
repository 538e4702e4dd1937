"""The event loop in numbers that answer at once: what every engine without certainty shares."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from math import hypot, inf
from operator import itemgetter
from typing import Any, ClassVar, Generic, NamedTuple, Protocol, SupportsFloat, TypeAlias, TypeVar

from flint import arb

from ..exact.numbers.system import BudgetSpent, M, NumberSystem, Ordered, Undecided
from ..exact.question import Question
from ..exact.replay.contact import (
    AtWall,
    Body,
    Entry,
    Gravity,
    Link,
    NamedContacts,
    Round,
    name_of,
)
from ..exact.replay.landings import told_wait
from ..exact.replay.state import Lift, ReplayState, Settle, Step, Take
from ..exact.replay.wall_flights import SeenWall
from ..exact.simulation.decider import History, Limits, Mark, run_limits
from ..exact.simulation.endings import Rows
from ..exact.simulation.loop import SELDOM_COLLECTED, Loop
from ..exact.simulation.policies import Accumulating, Policy
from ..exact.simulation.prediction import ArrivalQueue, Predictor
from ..scenarios.engine import ALL_KEYS, EventDriven
from ..scenarios.errors import SceneError
from ..scenarios.lazy import Late
from ..scenarios.numbers.precision import Double, hull
from ..scenarios.numbers.quantity import Quantity, QuantityLike, Real
from ..scenarios.scene import Scene
from ..scenarios.trajectory import Event, Motion, OnProgress, Pocketing, Reversal, Settling, StopReason, Trajectory
from .knots import DoubleMotion, EndlessBounces, FallingMotion
from .plain_meetings import PlainMeetings

# -- The state of a run in finite precision.


class PlainState(ReplayState[M]):
    """See `ReplayState`; two that rounding has put into each other, and that approach, collide at once.

    What the law of their meeting tells is then when they would have met on their way here: before the instant at which
    they stand, and long before it where they are all but at rest with each other. Under gravity it is kept in true
    coordinates, as users' engines keep theirs.
    """

    bends = True

    def surely_falls(self, speed: M) -> bool:
        """See `Flights.surely_falls`."""
        return bool(speed < self.zero)

    def settle(self, index: int, wall: int, slides: bool, bounces: bool, other: int = -1) -> None:
        """See `ReplayState.settle`; at a wall along an axis a circle is put where the wall has it, to the last bit."""
        x, y, vx, vy, *_ = self.bodies[index].flight
        super().settle(index, wall, slides, bounces, other)
        body, line, zero = self.bodies[index], self.line(index, wall), self.zero
        flight, level, upright = body.flight, *(part.sign() == 0 for part in self.scene.walls[wall].normal)
        if level:
            y = line.y0 + body.r if line.ny > zero else line.y0 - body.r
            body.flight = flight._replace(x=x, y=y, vx=vx if slides else zero, vy=zero)
        elif upright:
            x = line.x0 + body.r if line.nx > zero else line.x0 - body.r
            body.flight = flight._replace(x=x, y=y, vx=zero, vy=vy if slides else zero)

    def wall_hit(self, link: AtWall) -> tuple[M, M]:
        """As `Flights.wall_hit`; what rounding has put into a wall for all of its way up comes to it where it turns."""
        if self.falling is not None and self.sides.pull(*link[:2]) and self.wall_discriminant(link) < self.zero:
            return self.wall_graze(link)
        return super().wall_hit(link)

    def _hit_from_base(self, source: Link) -> tuple[M, M]:
        clock, wait = super()._hit_from_base(source)
        return clock, self.zero if wait < self.zero else wait

    def peg_hit(self, link: Round) -> tuple[M, M]:
        """See `RoundFalls.peg_hit`; only of what comes."""
        wait = self.fall_wait(link)
        assert wait is not None, "a circle that was to fall onto another does not: a defect"
        return self.faller(link).flight.t, wait

    def fall_wait(self, link: Round) -> M | None:
        """See `Flights.fall_wait`."""
        return told_wait(self, link)


# -- Tells when a run in finite precision goes round without end while its clock stands still.
#
# Where a wait is shorter than the last bit of the clock no time passes; and circles that rounding has put into each
# other may then push each other on and on.

RETURNS = 100
"""How often all circles must come back to the same flights: what comes back once may yet leave, by what it met last."""

FAINT = 2.0**-53
"""A push that is less than so much of an earlier one at the same time leads nowhere any more: where something bounces
to an end, each is a share of the one before, and that goes on to the least number that there is."""

MOST = 1_000_000
"""Events at one time, whatever the circles do."""


class StandingClock(Generic[M]):
    """Looks at a run as it goes on.

    Args:
        size: a bound of the size of a number.

    >>> clock = StandingClock(abs)
    >>> for events in range(1000):
    ...     clock.look(events, 4.0, lambda: [(0.0, 0.0, events % 2, 0.0, 4.0)])
    Traceback (most recent call last):
        ...
    truebreak.exact.numbers.system.BudgetSpent: passes without end: 541 events at time 4, and the same flights again
    >>> clock = StandingClock(abs)
    >>> for events in range(1000):
    ...     clock.look(events, 4.0, lambda: [(0.0, 0.0, 0.5**events, 0.0, 4.0)])
    Traceback (most recent call last):
        ...
    truebreak.exact.numbers.system.BudgetSpent: passes without end: 254 events at time 4, each fainter than the last
    """

    def __init__(self, size: Callable[[M], float]) -> None:
        self._size = size
        self._last: Sequence[Sequence[M]] | None = None
        self._hardest = 0.0
        self._faints = 0
        self._time = -inf
        self._first = 0
        self._kept: Sequence[Sequence[M]] | None = None
        self._at = 0
        self._returns = 0
        self._seen = 0

    def look(self, events: int, time: float, flights: Callable[[], Sequence[Sequence[M]]]) -> None:
        """Notes where the run is.

        The flights are compared with those at the last power of two of the events at this time: whatever the period,
        one of these is long enough (Brent).

        Args:
            events: how many there have been; no more since the last look, as where two only grazed, tell nothing.
            time: of the last of them.
            flights: (x, y, vx, vy, t) of all circles.

        Raises:
            BudgetSpent: if no time passes any more.
        """
        if events == self._seen:
            return
        self._seen = events
        if time > self._time:
            self._time, self._first, self._kept, self._at = time, events, None, 1
            self._last, self._hardest, self._faints = None, 0.0, 0
            return
        stood = events - self._first
        if stood >= MOST:
            raise BudgetSpent(f"passes without end: {stood:,} events at time {time:g}")
        if stood >= RETURNS and self._fades(flights()):
            raise BudgetSpent(f"passes without end: {stood:,} events at time {time:g}, each fainter than the last")
        if self._kept is not None and flights() == self._kept:
            self._returns += 1
            if self._returns == RETURNS:
                raise BudgetSpent(f"passes without end: {stood:,} events at time {time:g}, and the same flights again")
        elif stood >= 2 * self._at:
            self._kept, self._at, self._returns = flights(), stood, 0

    def _fades(self, flights: Sequence[Sequence[M]]) -> bool:
        """Whether the last pushes were all but none."""
        last, self._last = self._last, flights
        if last is None:
            return False
        changed = [pair for pair in zip(last, flights, strict=True) if pair[0] != pair[1]]
        push = max((self._size(new[k] - old[k]) for old, new in changed for k in (2, 3)), default=0.0)
        self._hardest = max(self._hardest, push)
        self._faints = self._faints + 1 if 0.0 < push < FAINT * self._hardest else 0
        return self._faints >= RETURNS


# -- Decisions in a finite precision that answers, or fails to answer, at once: nothing stronger stands behind it.


class PlainReading(Generic[M]):
    """Reads a state off as it is.

    Args:
        state: that state.
        numbers: its system.
    """

    def __init__(self, state: ReplayState[M], numbers: NumberSystem[M]) -> None:
        self._state = state
        self._bounds = numbers.bounds

    def knot(self, body: Body[M]) -> tuple[M, M, M, M, M]:
        """The state."""
        x, y, vx, vy, t, *_ = body.flight
        return t, x, y, vx, vy

    def now(self, body: Body[M]) -> M:
        """The instant of a body's last contact."""
        return body.flight.instant

    def entry_time(self, link: Entry) -> M:
        """The time of an entry."""
        clock, wait = link.hit(self._state)
        return clock + wait

    def reversal_time(self) -> M:
        """The time of the reversal."""
        return self._state.flip_time

    def exact_state(self, bodies: Sequence[int]) -> Hashable | None:
        """None: the state is not exact."""
        return None

    def fallen(self, circle: int) -> tuple[arb, Rows]:
        """In the numbers that there are."""
        told = self._ball
        time = self._state.bodies[circle].flight.instant
        return told(time), [(told(x), told(y), told(vx), told(vy)) for x, y, vx, vy in self._state.true_rows(time)]

    def bounces(self, end: Accumulating) -> arb:
        """In the numbers that there are."""
        return self._ball(end.wait(self._state))

    def _ball(self, number: M) -> arb:
        """What holds a number, to doubles."""
        low, high = self._bounds(number)
        return hull(arb(low), arb(high))

    def note(self) -> str:
        """Nothing to add."""
        return ""

    def rough(self, time: M) -> float:
        """The lower bound of a time."""
        return self._bounds(time)[0]

    def limit_bounds(self, time: Quantity | None) -> tuple[float, float]:
        """Doubles around a set time (None: the return)."""
        if time is None:
            return self._bounds(self._state.flip_time + self._state.flip_time)
        return self._bounds(self._state.constant(time))


class PlainDecider(Generic[M]):
    """The decider of one number system (see `Decider`).

    Args:
        scene: what runs.
        state: its state.
        numbers: the system that the state is in; what its signs do not tell is undecided.
    """

    proves = False
    predictor: ClassVar[type[Predictor[Any]]] = Predictor

    def __init__(self, scene: Scene, state: ReplayState[M], numbers: NumberSystem[M]) -> None:
        self.scene = scene
        self.state = state
        self.bodies = state.bodies
        self.history, self.queue, self.meetings = self._parts(numbers)
        self.reading = PlainReading(state, numbers)
        self.stride = None
        self._sign = numbers.sign
        self._standing = StandingClock[M](lambda value: max(map(abs, numbers.bounds(value))))
        self.refresh([*state.bodies.values(), *state.pockets])

    def _parts(self, numbers: NumberSystem[M]) -> tuple[History[M], ArrivalQueue[M], PlainMeetings[M]]:
        history: History[M] = History()
        queue = ArrivalQueue(self.bodies)
        meetings = PlainMeetings(self.scene, self.state, queue, history.plan, numbers, self.ask, self.predictor)
        return history, queue, meetings

    def begin(self, instant: int) -> None:
        """The precision is what it is; but time must pass (see `pass_on`)."""
        self.pass_on()

    def pass_on(self) -> None:
        """Looks whether time passes.

        Raises:
            BudgetSpent: if it no longer does.
        """
        if self.history.records:
            self._standing.look(len(self.history.records), self._clock(), self._flights)

    def _clock(self) -> float:
        """The time of the last event."""
        return self.reading.rough(self.history.records[-1].mark.time)

    def _flights(self) -> list[tuple[M, ...]]:
        """(x, y, vx, vy, t) of every circle."""
        return [body.flight[:5] for body in self.bodies.values()]

    def do(self, step: Step) -> None:
        """Carries out a step and logs it."""
        self.history.steps.append(step)
        self.state.do(step)

    def gathered(self, links: Iterable[Link]) -> None:
        """Nothing to note."""

    @property
    def finish(self) -> Callable[[], None]:
        """To be called before the history is read: does nothing."""
        return _nothing

    def close(self) -> None:
        """Lets go of all that it holds but its history: its parts know each other, and would await the collector."""
        self.meetings.close()
        del self.meetings

    def refresh(self, bodies: Iterable[Body[M]]) -> None:
        """Predictions use the state itself; a velocity of exactly zero is noted."""
        zero, falls, circles = self.state.zero, self.state.falling is not None, self.state.scene.circles
        for body in bodies:
            flight = body.flight
            flies = falls and not (body.is_pocket or circles[body.index].fixed or body.index in self.state.pegs)
            rest = not flies and bool(flight.vx == zero) and bool(flight.vy == zero)
            if rest is not flight.rest:
                body.flight = flight._replace(rest=rest)
            body.q = flight[:5]

    def ask(self, question: Question) -> int:
        """The sign of a question's number.

        Raises:
            Undecided: with the question in words.
        """
        try:
            return self._sign(question.value(self.state))
        except Undecided:
            told = f"{question.describe(self._name)} cannot be decided, after {len(self.history.records)} instants"
            raise Undecided(told) from None

    def ask_cheaply(self, question: Question) -> int | None:
        """The sign, or None where it is not known."""
        try:
            return self.ask(question)
        except Undecided:
            return None

    def _name(self, link: Link) -> str:
        return name_of(self.scene, link)


def _nothing() -> None:
    """What there is to do where a history needs no finish."""


# -- Runs the event loop in a finite precision, and makes a trajectory of what it gathered.

Passed: TypeAlias = tuple[M, M, M, M, M, int]
"""(t, x, y, vx, vy) of a circle from a knot on, and the number of the knot's instant."""


def run_plain(
    scene: Scene,
    engine: str,
    parameters: Mapping[str, Any],
    decider: PlainDecider[M],
    motion: Callable[[Sequence[Sequence[Passed[M]]], Real], Motion],
    shown: Callable[[M, int | None], Real],
    *,
    until: QuantityLike | None,
    events: int | None,
    progress: OnProgress | None,
    policy: Policy | None = None,
    loop: Callable[[Limits], Loop[M, M]] | None = None,
) -> Trajectory:
    """The trajectory of a scene in the numbers of a decider.

    Args:
        engine: its name.
        parameters: its settings.
        decider: keeps the state and decides.
        motion: makes the motion from the knots of each circle, and the last time that may be asked for.
        loop: makes the loop, where it is not the general one.
        shown: makes a time of the trajectory from a number and the number of its instant.
    """
    limits = run_limits(scene, until, events)
    inner = decider.scene
    made = Loop(inner, decider, limits, progress, policy) if loop is None else loop(limits)
    stop = made.run()
    ending, bounced = None, bounced_knots(decider.state, decider.history)
    if made.endings is not None and made.endings.found is not None:
        ending = shown(made.endings.found(decider.state), 0)
    ids, history, finish, named = scene.ids, decider.history, decider.finish, NamedContacts(inner)

    def at(mark: Mark[M]) -> Real:
        return shown(mark.time, mark.number)

    def events_of() -> Iterator[Event]:
        finish()
        for index, record in enumerate(history.records):
            impulses = named(record.impulses)
            yield Event(index, at(record.mark), named(record.links), impulses, record.ties, record.coupled)

    def knots_of() -> Iterator[list[Passed[M]]]:
        finish()
        for row in history.knots[: len(scene.circles)]:
            yield [(t, x, y, vx, vy, number) for t, x, y, vx, vy, _, number in row]

    reversal = None
    if history.reversal is not None:
        reversal = Reversal(history.reversal[0], at(history.reversal[1]))
    end: Real
    if stop.reason is StopReason.HORIZON and limits.to_return:
        assert history.reversal is not None
        assert history.last is not None
        time = history.reversal[1].time
        end = shown(time + time, history.last.number)
    elif stop.reason is StopReason.HORIZON:
        assert limits.until is not None
        late = history.last is not None and float(at(history.last)) > float(limits.until)
        end = at(history.last) if history.last is not None and late else limits.until  # rounded up, it let this in
    else:
        end = shown(decider.state.zero, 0) if history.last is None else at(history.last)
        if stop.reason is StopReason.QUIET:
            ends = (shown(known.until, None) for row in bounced.values() for known in row.values())
            end = max((end, *ends), key=float)
    decider.close()
    settlings = [*_settlings(inner, history, bounced, shown)]
    pending = [s for s in settlings if float(s.time) > float(end)]
    return Trajectory(
        scene=scene,
        engine=engine,
        parameters=parameters,
        events=Late(len(history.records), events_of),
        stop=stop,
        final_time=end,
        motion=motion(Late(len(scene.circles), knots_of), end),
        reversal=reversal,
        pocketings=tuple(
            Pocketing(str(ids[e.circle]), str(scene.pockets[e.pocket].id), at(e.mark)) for e in history.entries
        ),
        plan=dict(sorted(history.plan.items())),
        ending=ending,
        notes=tuple(told for s in pending if (told := s.unlisted(end)) is not None),
        settlings=tuple(s for s in settlings if s not in pending),
    )


def carried_knots(history: History[M]) -> dict[int, frozenset[int]]:
    """For each circle that walls carry in a run, or that goes out of play, its knots from which on it does not fall: by
    their place."""
    found: dict[int, frozenset[int]] = {}
    for body in {step.body for step in history.steps if isinstance(step, Settle | Take)}:
        places, carried, done = list[int](), False, 0
        for place, knot in enumerate(history.knots[body]):
            for step in history.steps[done : knot[5]]:
                if isinstance(step, Settle | Lift | Take) and step.body == body:
                    carried = not isinstance(step, Lift)
            done = knot[5]
            if carried:
                places.append(place)
        found[body] = frozenset(places)
    return found


class LastBounces(NamedTuple, Generic[M]):
    """Infinitely many bounces of a circle on a wall that come to an end.

    Attributes:
        start, until: when the first of them is, which is listed, and when they have all happened.
        speed: after the first, in the scale of the wall's normal.
        line: the wall as the circle sees it; between two slopes, one across gravity.
    """

    start: M
    until: M
    speed: M
    line: SeenWall[M]


def bounced_knots(state: ReplayState[M], history: History[M]) -> dict[int, dict[int, LastBounces[M]]]:
    """For each circle that settles after infinitely many bounces: those, by the place of the knot that comes after."""
    found: dict[int, dict[int, LastBounces[M]]] = {}
    falls, e = state.falling, state.scene.restitution
    for k, step in enumerate(history.steps, 1):
        if isinstance(step, Settle) and step.bounces:
            row = history.knots[step.body]
            place = next(n for n, knot in enumerate(row) if knot[5] >= k)
            start, _, _, vx, vy, *_ = row[place - 1]
            assert falls is not None
            assert falls.bent
            line = state.line(step.body, step.wall)
            if step.other >= 0:
                nx, ny = falls.upward
                line = line._replace(nx=nx, ny=ny, nn=nx * nx + ny * ny)
            speed, half = line.nx * vx + line.ny * vy, line.nx * falls.hx + line.ny * falls.hy
            until = start - speed / (half * state.constant(1 - e))
            found.setdefault(step.body, {})[place] = LastBounces(start, until, speed, line)
    return found


def _settlings(
    scene: Scene,
    history: History[M],
    bounced: Mapping[int, Mapping[int, LastBounces[M]]],
    shown: Callable[[M, int | None], Real],
) -> Iterator[Settling]:
    """Where walls began to carry circles; not where one was let fall and carried on at one instant."""
    if not scene.settle:
        return
    steps = {k: step for k, step in enumerate(history.steps, 1) if isinstance(step, Settle)}
    rows: list[tuple[float, int, Settle, Real, Real | None]] = []
    for body, places in carried_knots(history).items():
        row = history.knots[body]
        for place in sorted(places):
            time, step, number = row[place][0], row[place][5], row[place][6]
            begun = next(steps[k] for k in range(step, 0, -1) if k in steps and steps[k].body == body)
            if place == 0 or place - 1 not in places:
                last, since = bounced.get(body, {}).get(place), None
                when = shown(time, number)
                if last is not None:
                    when, since = shown(last.until, None), when
                rows.append((float(when), body, begun, when, since))
    for _, _, begun, when, since in sorted(rows, key=itemgetter(0, 1)):
        yield begun.told(scene, when, since)


# -- What event-driven engines without certainty share: the event loop, fed numbers of one system that always answers.


class Counted(Ordered, SupportsFloat, Protocol):
    """A number of finite precision, which has a double next to it."""


F = TypeVar("F", bound=Counted)


def in_doubles(found: Mapping[int, Mapping[int, LastBounces[F]]], e: float) -> dict[int, dict[int, EndlessBounces]]:
    """Bounces that come to an end, as a motion in doubles shows them."""

    def told(known: LastBounces[F]) -> EndlessBounces:
        start, until, speed, line = float(known.start), float(known.until), float(known.speed), known.line
        nx, ny = float(line.nx), float(line.ny)
        length = hypot(nx, ny)
        return EndlessBounces(start, until, nx / length, ny / length, speed / length, e)

    return {i: {place: told(known) for place, known in row.items()} for i, row in found.items()}


class EventEngine(EventDriven, ABC, Generic[F]):
    """The event loop of the exact engine in one number system.

    Inputs are rounded to the system's nearest numbers; every sign is taken at its word; equal event times are a tie;
    an overlap that rounding has made collides at once.
    """

    scene_keys = ALL_KEYS

    @property
    @abstractmethod
    def name(self) -> str:
        """The engine's name."""

    @property
    @abstractmethod
    def numbers(self) -> NumberSystem[F]:
        """The system."""

    @property
    def parameters(self) -> Mapping[str, Any]:
        """Its settings, all of them."""
        return {}

    @property
    def rounds_input(self) -> bool:
        """True: a scene is rounded to the system's nearest numbers."""
        return True

    def motion(self, knots: Sequence[Sequence[Passed[F]]], end: Real) -> Motion:
        """The motion, from the knots of each circle and the last time that may be asked for: here, in doubles."""
        rows = [[(float(t), float(x), float(y), float(vx), float(vy)) for t, x, y, vx, vy, _ in row] for row in knots]
        return DoubleMotion(rows, float(end))

    def fallen_motion(
        self,
        knots: Sequence[Sequence[Passed[F]]],
        end: Real,
        falling: Gravity[F],
        pegs: Collection[int],
        carried: Mapping[int, frozenset[int]],
        slides: Mapping[int, Gravity[F]],
        bounced: Mapping[int, Mapping[int, EndlessBounces]],
    ) -> Motion:
        """As `motion`, under gravity; some circles stand, and some walls carry, from these of their knots on.

        Some slide down a slope from their last knot on, with what there is of half of gravity along that. Some bounce
        infinitely often first.
        """
        halves = float(falling.hx), float(falling.hy)
        rows = [[(float(t), float(x), float(y), float(vx), float(vy)) for t, x, y, vx, vy, _ in row] for row in knots]
        along = {i: {len(rows[i]) - 1: (float(bend.hx), float(bend.hy))} for i, bend in slides.items()}
        return FallingMotion(rows, float(end), halves, pegs, carried, along, bounced)

    def decider(self, scene: Scene, state: ReplayState[F]) -> PlainDecider[F]:
        """What decides, of a state in these numbers."""
        return PlainDecider(scene, state, self.numbers)

    def shown(self, time: F, instant: int | None) -> Real:
        """A time of the trajectory, from a number and the number of its instant, if it is that of one."""
        return Double(float(time))

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """The history as these numbers see it (see `Engine.run`).

        Raises:
            SceneError: where a number is beyond those that there are.
        """
        try:
            with SELDOM_COLLECTED:
                return self.run_with(scene, None, until=until, events=events, progress=progress)
        except OverflowError:
            raise SceneError(
                f"{scene.name!r}: a number is beyond 1e308, where {self.name} ends; change the units, or use exact"
            ) from None

    def run_with(
        self,
        scene: Scene,
        policy: Policy | None,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """As `run`, with a policy of the caller's in place of the scene's."""
        inner = scene.surfaces
        state = PlainState(inner, self.numbers)
        falling, decider = state.falling, self.decider(inner, state)

        def fallen(knots: Sequence[Sequence[Passed[F]]], end: Real) -> Motion:
            assert falling is not None
            carried, slides = carried_knots(decider.history), state.slides
            bounced = in_doubles(bounced_knots(state, decider.history), float(scene.restitution))
            return self.fallen_motion(knots, end, falling, inner.pegs, carried, slides, bounced)

        return run_plain(
            scene,
            self.name,
            self.parameters,
            decider,
            self.motion if falling is None else fallen,
            self.shown,
            until=until,
            events=events,
            progress=progress,
            policy=policy,
        )
