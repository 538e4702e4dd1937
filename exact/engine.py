"""The exact engine: certified collision histories."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from operator import lt

from flint import arb

from ..scenarios.engine import Declared
from ..scenarios.errors import SceneError, TimeIsUp
from ..scenarios.lazy import Late
from ..scenarios.numbers.precision import check_doubles
from ..scenarios.numbers.quantity import QuantityLike
from ..scenarios.scene import Scene
from ..scenarios.trajectory import Event, OnProgress, Pocketing, Reversal, Stop, StopReason, Trajectory
from .certified.decider import CertifiedDecider
from .certified.precision import FIRST_BITS
from .numbers import ball
from .numbers.field import Known, known_ball
from .numbers.undecided import BudgetSpent, Undecided
from .policies import Policy
from .predicates.ties import TieRule
from .replay.contact import Named
from .results.home import return_note
from .results.motion import ExactMotion, RunTime
from .results.resumed import FORGED, NOT_ITS_LOG, farther, restore, tape_of, within
from .results.run_log import RunLog
from .results.times import time_of, time_of_return, time_zero
from .simulation.collecting import SELDOM_COLLECTED
from .simulation.history import History, Record
from .simulation.limits import Limits, run_limits
from .simulation.loop import Loop, stopped
from .simulation.tape import Tape

DEFAULT_WORK = 3_000_000
"""Units of work that one question, or all of one instant, may cost; a unit is about a microsecond.

200,000 suffice to tell two rows of 16 discs apart that are flawed by 10**-9000 (`test_log_symmetry.py`), and a proof in
six nested roots takes about as many: fifteen times that leaves room, and ends what has no end in seconds."""


ORDER_BITS = 128
"""Bits to which times that are exact are told apart."""


@dataclass(frozen=True)
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
            again = self._run(run.scene, limits, None, progress, take_up if known else None)
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
            run = self._trajectory(scene, decider, limits, stop, tape)
            decider.close()
            check_doubles()
            return run

    def _trajectory(
        self, scene: Scene, decider: CertifiedDecider, limits: Limits, stop: Stop, tape: Tape | None
    ) -> Trajectory:
        history = decider.history
        state = decider.state
        log = RunLog(scene, history.steps, state.bits - min(state.lowest, state.bits), state.centred)
        ids, records = scene.ids, history.records
        notes: tuple[str, ...] = ()
        home = False
        end = _end(log, history, limits, stop)
        motion = ExactMotion(log, history.knots, end, history.set_times)
        if stop.reason is StopReason.HORIZON and limits.to_return:
            decider.catch_up()
            home = decider.retrace.home
            notes = (return_note(scene, decider.retrace.home, decider.state.exact, motion),)
        motion.returned, motion.tape = home, tape
        reversal = None
        if history.reversal is not None:
            reversal = Reversal(history.reversal[0], time_of(log, history.reversal[1]))
        return Trajectory(
            scene=scene,
            engine=self.name,
            parameters={"max_bits": self.max_bits, "ties": self.ties, "work": self.work},
            events=Late(len(records), lambda: _events(log, records)),
            stop=stop,
            final_time=end,
            motion=motion,
            reversal=reversal,
            pocketings=tuple(
                Pocketing(str(ids[e.circle]), str(scene.pockets[e.pocket].id), time_of(log, e.mark))
                for e in history.entries
            ),
            assumptions=tuple(history.assumptions),
            plan={**dict(sorted(history.plan.items())), "bits": decider.state.bits},
            notes=notes,
        )


def _in_order(records: Sequence[Record[Known]]) -> None:
    """Raises AssertionError where an event provably comes before the one before it, which no run may ever have."""
    known = (record.mark.time for record in records)
    times = [time if isinstance(time, arb) else known_ball(time, ORDER_BITS) for time in known]
    if any(map(lt, times[1:], times)):
        late = next(k for k, (one, next_one) in enumerate(pairwise(times)) if next_one < one)
        told = f"event {late} comes after event {late + 1}"
        raise AssertionError(f"{told}: a defect of truebreak; please report the scene")


def _events(log: RunLog, records: Sequence[Record[Known]]) -> Iterator[Event]:
    """The events that a history keeps."""
    named = Named(log.scene)
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
        return time_zero(log, history.knots[0][0][0])
    return time_of(log, history.last)
