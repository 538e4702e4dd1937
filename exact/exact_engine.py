"""The exact engine: certified collision histories, run anew or carried out again from a saved run."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise, starmap
from operator import gt, itemgetter

from flint import arb

from ..scenarios.engine import ALL_KEYS, Declared, endable
from ..scenarios.errors import SceneError, TimeIsUp
from ..scenarios.lazy import Late, frozen
from ..scenarios.numbers.precision import check_doubles
from ..scenarios.numbers.quantity import Quantity, QuantityLike, Real
from ..scenarios.numbers.tower_element import AnyTower, Element
from ..scenarios.numbers.tower_ring import TowerLimit
from ..scenarios.scene import Scene
from ..scenarios.trajectory import Event, OnProgress, Pocketing, Reversal, Settling, Stop, StopReason, Trajectory
from .certified.cascade import TieRule
from .certified.certified_decider import FIRST_BITS, CertifiedDecider
from .exact_motion import (
    START,
    ExactMotion,
    ExactValue,
    RunTime,
    Source,
    TimeFormula,
    ending_of,
    time_of,
    time_of_return,
)
from .numbers import ball
from .numbers.ball import Known, known_ball
from .numbers.system import BudgetSpent, Undecided
from .replay.contact import NamedContacts
from .replay.state import Settle
from .simulation import cells
from .simulation.decider import History, Limits, Mark, PackedKnots, PackedRecords, Record, RunLog, run_limits
from .simulation.instant import Instant
from .simulation.loop import SELDOM_COLLECTED, Loop, Reached, Tape, stopped
from .simulation.policies import Policy

# -- A history carried out again from a saved run gets the numbers and counts that the run had.

NOT_ITS_LOG = "the log is not what its scene does; save the run again"

CHECK_BITS = 128
"""Bits to which an exact time of the file is compared with the one that comes of carrying the log out."""

FORGED = (ArithmeticError, AssertionError, AttributeError, LookupError, TypeError, ValueError)
"""What comes up where a log is carried out that no run has written."""


def tape_of(run: Trajectory) -> tuple[ExactMotion, Tape, Reached | None]:
    """What a run left for one that goes on from it.

    Raises:
        SceneError: for a run that left nothing.
    """
    motion = run.motion
    if not isinstance(motion, ExactMotion) or motion.tape is None:
        raise SceneError("only runs of the exact engine, with the scene's own tie policy, are gone on with")
    return motion, motion.tape, motion.tape.reached


def within(run: Trajectory, limits: Limits, reached: Reached) -> bool:
    """Whether all that a run had when it last looked for an instant lies before some limits, clearly."""
    had = [event.time for event in run.events if _number(event.time) <= 2 * reached.instants + 1]
    if limits.events is not None and limits.events <= len(had):
        return False
    had += [entry.time for entry in run.pocketings] + ([] if run.reversal is None else [run.reversal.time])
    return limits.until is None or all(time.bounds()[1] < limits.until.bounds()[0] for time in had)


def may_be_taken_up(scene: Scene, tape: Tape) -> bool:
    """Whether what lies ahead of a log's end can be predicted from there alone.

    Not among cells where something touched and left a flight as it was: on its way from there to the end that flight
    crosses cells again, and in each it would be held to meet anew what it has touched. Nor beside surfaces, nor under
    gravity, where a flight may come back to what it has touched.
    """
    if scene.surfaces is not scene or scene.gravity is not None:
        return False
    touched = any(isinstance(found, Instant) and (found.touches or found.rims) for found in tape.whole())
    return not (touched and len(scene.circles) >= cells.FEWEST)


def farther(run: Trajectory, again: Trajectory, limits: Limits) -> Trajectory:
    """What went on from a run; the run itself, where that was ended before it was as far and the limits admit it."""
    reason, had = again.stop.reason, len(run.events)
    if reason not in (StopReason.INTERRUPTED, StopReason.BUDGET) or len(again.events) >= had:
        return again
    if limits.events is not None and limits.events < had:
        return again
    if limits.until is not None and limits.until.bounds()[1] < run.events[-1].time.bounds()[0]:
        return again
    return replace(run, stop=stopped(reason, had) if reason is StopReason.INTERRUPTED else again.stop)


def _number(time: Real) -> int:
    assert isinstance(time, ExactValue)
    assert time.instant is not None
    return time.instant


def restore(history: History[Known], run: Trajectory, limits: Limits, tower: AnyTower) -> None:
    """Gives a history that was carried out again the numbers and counts of the run that it is the beginning of.

    Args:
        history: as `Loop.take_up` left it.
        run: that run.
        limits: where the history is to end.
        tower: of its exact numbers.

    Raises:
        SceneError: if it is not the beginning of that run.
    """
    motion, _, reached = tape_of(run)
    assert reached is not None
    if not _same(history, run, motion):
        raise SceneError(NOT_ITS_LOG)
    number = Moved(tower)
    times = {
        (value.instant, value.upto, _source(value)): number(value.near)
        for value in (*(e.time for e in run.events), *(e.time for e in run.pocketings))
        if isinstance(value, ExactValue)
    }
    if run.reversal is not None and isinstance(run.reversal.time, ExactValue):
        value = run.reversal.time
        times[value.instant, value.upto, _source(value)] = number(value.near)

    def timed(mark: Mark[Known]) -> Mark[Known]:
        time = times[mark.number, mark.step, mark.source]
        if not known_ball(time, CHECK_BITS).overlaps(known_ball(mark.time, CHECK_BITS)):
            raise SceneError(NOT_ITS_LOG)
        return mark._replace(time=time)

    history.records = PackedRecords(record._replace(mark=timed(record.mark)) for record in history.records)
    history.entries = [entry._replace(mark=timed(entry.mark)) for entry in history.entries]
    history.last = None if history.last is None else timed(history.last)
    if history.reversal is not None:
        history.reversal = (history.reversal[0], timed(history.reversal[1]))
    history.knots = [
        PackedKnots(
            (number(t), number(x), number(y), number(vx), number(vy), step, instant)
            for t, x, y, vx, vy, step, instant in row[: len(mine)]
        )
        for mine, row in zip(history.knots, motion.knots, strict=True)
    ]
    history.plan.clear()
    history.plan.update(reached.plan)
    history.assumptions[:] = run.assumptions[: reached.assumed]
    wanted = {limits.until, run.scene.reverse_at}
    last = 2 * reached.instants + 1
    history.set_times = {t: part for t, part in motion.set_times.items() if t in wanted and part <= last}


def _source(value: ExactValue) -> Source:
    assert isinstance(value.formula, TimeFormula)
    return value.formula.source


def _same(history: History[Known], run: Trajectory, motion: ExactMotion) -> bool:
    """Whether a history is the beginning of a run: the same steps, events and flights."""
    named = NamedContacts(run.scene)
    if history.steps != list(motion.log.steps[: len(history.steps)]) or len(history.records) > len(run.events):
        return False
    if len(history.knots) != len(motion.knots):
        return False
    for record, event in zip(history.records, run.events, strict=False):
        links = [named(record.links), named(record.impulses)]
        if links != [event.contacts, event.impulses] or record.mark.number != _number(event.time):
            return False
    return all(
        [knot[5:] for knot in mine] == [knot[5:] for knot in row[: len(mine)]]
        for mine, row in zip(history.knots, motion.knots, strict=True)
    )


class Moved:
    """Numbers of another field of the same roots, in this one.

    Args:
        tower: this one's.
    """

    def __init__(self, tower: AnyTower) -> None:
        self._tower = tower
        self._known: dict[str, Element] = {}

    def __call__(self, number: Known) -> Known:
        """One number.

        Raises:
            SceneError: if it is not in the field.
        """
        if not isinstance(number, Element) or number.tower is self._tower:
            return number
        text = number.text()
        try:
            if text not in self._known:
                self._known[text] = Quantity.of(text).in_tower(self._tower)
        except TowerLimit:
            raise SceneError(NOT_ITS_LOG) from None
        return self._known[text]


# -- Whether a reversed run came back to its start, and what it says of that.

HOME_BITS = 128
"""Accuracy at which a final state is compared with the first one, where the log does not tell."""

HOME = "came back to the start exactly: every position is the one at time 0 and every velocity its negative"


def return_note(scene: Scene, home: bool, exact: Sequence[bool], motion: ExactMotion) -> str:
    """What a run that ended at the return says of its final state.

    Args:
        scene: what ran.
        home: whether every circle has undone its whole way.
        exact: for each circle, whether its final numbers are exact.
        motion: the run's.
    """
    if home:
        return (
            "came back to the start exactly: after the reversal every circle met the same partners in reverse "
            "order, and each impulse undoes itself, so every position is the one at time 0 and every velocity "
            "its negative"
        )
    rows = motion.state(motion.end)
    apart: list[str] = []
    places = velocities = True
    for i, (circle, row) in enumerate(zip(scene.circles, rows, strict=True)):
        wanted = (circle.x, circle.y, -circle.vx, -circle.vy)
        for k, (value, first) in enumerate(zip(row, wanted, strict=True)):
            if ball.sign_of(value.ball(HOME_BITS) - ball.constant(first)):
                apart += [str(circle.id)] if k < 2 else []
                velocities = velocities and k < 2
            else:
                number = value.exact() if exact[i] else None
                same = number is not None and (number - first.in_tower(number.tower)).is_zero()
                places, velocities = places and (same or k >= 2), velocities and (same or k < 2)
    if apart:
        return f"did not come back to the start: circle {apart[0]} is elsewhere at the return"
    if places and velocities:
        return HOME
    if places:
        return (
            "came back to the start exactly: every position is the one at time 0; what touches there collides, "
            "so that not every velocity is the negative of its first"
        )
    return (
        "whether it came back to the start is not proved: an order chosen within one instant, or an instant of "
        "several contacts, is not always undone by its own reversal"
    )


# -- The exact engine: certified collision histories.

DEFAULT_WORK = 3_000_000
"""Units of work that one question, or all of one instant, may cost; a unit is about a microsecond.

200,000 suffice to tell two rows of 16 discs apart that are flawed by 10**-9000 (`test_log_symmetry.py`), and a proof in
six nested roots takes about as many: fifteen times that leaves room, and ends what has no end in seconds."""


ORDER_BITS = 128
"""Bits to which times that are exact are told apart."""


@frozen
class ExactEngine(Declared):
    """Runs a scene so that every event, its order and its partners are proved.

    Attributes:
        max_bits: precision beyond which a sign that is still not known is called undecided.
        ties: what is taken for a zero once every proof has failed: `proved` nothing, `assume:BITS` agreement to so
            many bits. What follows from such a zero is marked as resting on it.
        work: what one question may cost before it is undecided, in units that are counted, not timed: a run stops
            at the same place on every state.

    >>> from truebreak.scenarios import Circle, Scene
    >>> run = ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)]))
    >>> run.events[0].time.text(), run.stop.reason.name
    ('-sqrt(3) + 4', 'QUIET')
    """

    max_bits: int = 1 << 20
    ties: str = "proved"
    work: int = DEFAULT_WORK
    scene_keys = ALL_KEYS

    def __post_init__(self) -> None:
        TieRule.parse(self.ties)
        for key, value in (("max_bits", self.max_bits), ("work", self.work)):
            if isinstance(value, bool) or not isinstance(value, int) or value < 1:
                raise SceneError(f"{key} = {value!r}: must be a whole number from 1")

    @property
    def name(self) -> str:
        """The engine's name."""
        return "exact"

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """The certified history up to a time, a number of instants, or both (see `Engine.run`).

        With a reversal in the scene and no limit from the caller, the run ends at the return to the start: twice
        the time of the reversal.

        Raises:
            SceneError: for limits that are not above zero, or an unknown setting.
        """
        return self.run_with(scene, None, until=until, events=events, progress=progress)

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
        return self._run(scene, run_limits(scene, until, events), policy, progress)

    def resume(
        self,
        run: Trajectory,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """Goes on from a run that ended too soon: with its limits, unless others are given.

        The log is carried out again, with the bits that the run had, and nothing is looked for until it ends. What
        comes out is what one run to these limits would have given: events, proofs, states, stop, and every number.
        Its plan may count otherwise, since what lies ahead is predicted anew.

        Raises:
            SceneError: as `run`; for a run of another engine, policy or rule of ties; for a log that is not what its
                scene does.

        >>> from truebreak.scenarios import catalogue
        >>> short = ExactEngine().run(catalogue.build("gas:n=3"), events=5)
        >>> len(ExactEngine().resume(short, events=9).events)
        9
        """
        _, tape, reached = tape_of(run)
        if TieRule.parse(str(run.parameters["ties"])) != TieRule.parse(self.ties):
            raise SceneError(f"the run was made with ties = {run.parameters['ties']!r}; go on with the same")
        given = until is not None or events is not None
        limits = run_limits(run.scene, until, events) if given else tape.limits

        def take_up(loop: Loop, decider: CertifiedDecider) -> None:
            assert reached is not None
            try:
                decider.history.rises += tape.rises[: reached.rises]
                if decider.history.rises:
                    decider.state.rise(*decider.history.rises[-1])
                decider.grazes = {k: list(links) for k, links in tape.grazes.items() if k // 2 <= reached.instants}
                loop.take_up(tape.whole(), decider.graze_again)
                restore(decider.history, run, limits, decider.state.numbers.tower)
            except FORGED:
                raise SceneError(NOT_ITS_LOG) from None

        try:
            known = reached is not None and within(run, limits, reached)
        except FORGED:
            raise SceneError(NOT_ITS_LOG) from None
        try:
            with endable():
                again = self._run(
                    run.scene, limits, None, progress, take_up if known and may_be_taken_up(run.scene, tape) else None
                )
        except (Undecided, BudgetSpent):
            again = self._run(run.scene, limits, None, progress)
        except KeyboardInterrupt:
            return replace(run, stop=stopped(StopReason.INTERRUPTED, len(run.events)))
        except TimeIsUp as outcome:
            return replace(run, stop=stopped(StopReason.BUDGET, len(run.events), str(outcome)))
        return farther(run, again, limits)

    def _run(
        self,
        scene: Scene,
        limits: Limits,
        policy: Policy | None,
        progress: OnProgress | None,
        take_up: Callable[[Loop, CertifiedDecider], None] | None = None,
    ) -> Trajectory:
        with ball.precision(FIRST_BITS), SELDOM_COLLECTED:
            check_doubles()
            outer, scene = scene, scene.surfaces
            decider = CertifiedDecider(scene, limits, self.max_bits, self.work, TieRule.parse(self.ties))
            loop = Loop(scene, decider, limits, progress, policy)
            if take_up is not None:
                take_up(loop, decider)
            stop = loop.run()
            _in_order(decider.history.records)
            tape = None
            if policy is None:
                tape = loop.tape
                tape.rises, tape.grazes = decider.history.rises, decider.grazes
            run = self._trajectory(outer, loop, decider, limits, stop, tape)
            decider.close()
            check_doubles()
            return run

    def _trajectory(
        self, outer: Scene, loop: Loop, decider: CertifiedDecider, limits: Limits, stop: Stop, tape: Tape | None
    ) -> Trajectory:
        scene, history = loop.scene, decider.history
        state = decider.state
        log = RunLog(outer, history.steps, state.bits - min(state.lowest, state.bits), state.centred)
        ids, records = scene.ids, history.records
        notes: tuple[str, ...] = ()
        home = False
        end = _end(log, history, limits, stop)
        motion = ExactMotion(log, history.knots[: len(outer.circles)], end, history.set_times)
        if stop.reason is StopReason.HORIZON and limits.to_return:
            decider.catch_up()
            home = decider.retrace.home
            notes = (return_note(outer, decider.retrace.home, decider.state.exact, motion),)
        motion.returned, motion.tape = home, tape
        if stop.reason is StopReason.QUIET:
            for _, rest in motion.ends.values():
                motion.end = motion.end if motion.reaches(rest) else rest
        log.events = records if isinstance(records, PackedRecords) else None
        reversal = None
        if history.reversal is not None:
            reversal = Reversal(history.reversal[0], time_of(log, history.reversal[1]))
        settlings, unlisted = settlings_of(motion)
        return Trajectory(
            scene=outer,
            engine=self.name,
            parameters={"max_bits": self.max_bits, "ties": self.ties, "work": self.work},
            events=Late(len(records), lambda: _events(log, records)),
            stop=stop,
            final_time=motion.end,
            motion=motion,
            reversal=reversal,
            pocketings=tuple(
                Pocketing(str(ids[e.circle]), str(scene.pockets[e.pocket].id), time_of(log, e.mark))
                for e in history.entries
            ),
            assumptions=tuple(history.assumptions),
            plan={**dict(sorted(history.plan.items())), "bits": decider.state.bits},
            notes=(*notes, *unlisted),
            ending=ending_of(
                log, None if history.last is None else history.last.step, loop.endings and loop.endings.found
            ),
            settlings=settlings,
        )


def settlings_of(motion: ExactMotion) -> tuple[tuple[Settling, ...], tuple[str, ...]]:
    """Where walls began to carry circles, told by the log; not where one was let fall and carried on at one instant.

    With it, of those that bounce until after the end, that not all of their bounces are listed.
    """
    log, knots, ends, unlisted = motion.log, motion.knots, motion.ends, list[str]()
    found: list[tuple[float, int, Settling]] = []
    for k, step in enumerate(log.steps if log.given.settle else (), start=1):
        if isinstance(step, Settle):
            i, row = step.body, knots[step.body]
            at = bisect_left(row, k, key=itemgetter(5))
            if at == 0 or not log.carries(i, row[at - 1][5]):
                since, time = ends.get((i, at)) or (None, motion.knot_time(i, at))
                told = step.told(log.scene, time, since)
                if motion.reaches(time):
                    found.append((float(time), i, told))
                elif (missing := told.unlisted(motion.end)) is not None:
                    unlisted.append(missing)
    return tuple(settling for *_, settling in sorted(found, key=itemgetter(0, 1))), tuple(unlisted)


def _in_order(records: Sequence[Record[Known]]) -> None:
    """Raises AssertionError where an event provably comes before the one before it, which no run may ever have."""
    known = (record.mark.time for record in records)  # one after the other: all at once are a sixth of a long run
    times = (time if isinstance(time, arb) else known_ball(time, ORDER_BITS) for time in known)
    late = next((k for k, wrong in enumerate(starmap(gt, pairwise(times))) if wrong), None)
    if late is not None:
        told = f"event {late} comes after event {late + 1}"
        raise AssertionError(f"{told}: a defect of truebreak; please report the scene")


def _events(log: RunLog, records: Sequence[Record[Known]]) -> Iterator[Event]:
    """The events that a history keeps."""
    named = NamedContacts(log.scene)
    for index, (mark, links, impulses, ties, coupled) in enumerate(records):
        yield Event(index, time_of(log, mark), named(links), named(impulses), ties, coupled)


def _end(log: RunLog, history: History[Known], limits: Limits, stop: Stop) -> RunTime:
    """The time of the final state."""
    if stop.reason is StopReason.HORIZON and limits.to_return and history.reversal is not None:
        mark = history.reversal[1]
        last = history.last.number if history.last is not None else mark.number
        return time_of_return(log, mark, last)
    if stop.reason is StopReason.HORIZON:
        assert limits.until is not None
        return limits.until
    if history.last is None:
        return time_of(log, Mark(0, history.knots[0][0][0], 0, START))  # nothing happened
    return time_of(log, history.last)
