"""Runs, and replays of the exact run's log, in balls of a fixed number of bits."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ....exact.exact_motion import motion_of, steps_through
from ....exact.laws.formulas import pair_approach, pair_discriminant
from ....exact.numbers import ball
from ....exact.replay.ball_state import BallState
from ....exact.replay.state import Flip, Step
from ....exact.simulation.decider import run_limits
from ....exact.simulation.loop import Loop
from ....floating.plain import PlainDecider
from .reader import FlightBalls, RunReader

if TYPE_CHECKING:
    from ....scenarios.numbers.quantity import Quantity
    from ....scenarios.scene import Scene
    from ....scenarios.trajectory import OnProgress, Stop, Trajectory
    from .decision import DecidingNumber, OwnFlight, Pairing


@dataclass(frozen=True)
class BallRun:
    """The event loop in balls of a fixed number of bits, each sign taken where a ball tells it.

    Where one does not, the run stops: every event that it comes to is certain.
    """

    bits: int

    def run(
        self, scene: Scene, until: Quantity | float | None, events: int, progress: OnProgress | None = None
    ) -> tuple[int, Stop]:
        """How many events it comes to, and why it ends.

        >>> from truebreak.scenarios import Circle, Scene
        >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, 1), Circle(4, "-1 - 1/10**40")])
        >>> [BallRun(bits).run(scene, 9, 5)[0] for bits in (128, 256)]
        [0, 2]
        """
        with ball.precision(self.bits):
            decider = PlainDecider(scene, BallState(scene), ball.BALLS)
            stop = Loop(scene, decider, run_limits(scene, until, events), progress).run()
        return len(decider.history.records), stop


class Replay(RunReader):
    """Reads a decision off the exact run's log, carried out in balls of a fixed number of bits.

    No decision of the history is asked again: only the one in question.

    Args:
        run: the exact run.
        decision: what is asked.
        bits: of the balls.
        turned_after: see `RunReader`.
    """

    def __init__(self, run: Trajectory, decision: DecidingNumber, bits: int, turned_after: int | None) -> None:
        super().__init__(run, turned_after=turned_after)
        self.decision = decision
        self.bits = bits
        self._numbers = self._replayed()

    def _replayed(self) -> Mapping[tuple[str, int], FlightBalls]:
        """t, x, y, vx, vy of each circle in question, after the steps of its last event."""
        steps, place = steps_of(self.run), {str(c.id): k for k, c in enumerate(self.run.scene.circles)}
        wanted: dict[int, set[str]] = {}
        for pairing in self.decision.pairings:
            for name in (pairing.body, pairing.partner):
                if name in place:
                    wanted.setdefault(self._upto(pairing, name), set()).add(name)
        found: dict[tuple[str, int], FlightBalls] = {}
        with ball.precision(self.bits):
            state = BallState(self.run.scene)
            for done in range(max(wanted) + 1):
                for name in wanted.get(done, ()):
                    flight = state.bodies[place[name]].flight
                    found[name, done] = (flight.t, flight.x, flight.y, flight.vx, flight.vy)
                if done < len(steps):
                    state.do(steps[done])
        return found

    def _upto(self, pairing: Pairing, name: str) -> int:
        """How many steps lead to a circle's flight."""
        if self._turned(pairing):
            return 1 + next(k for k, step in enumerate(steps_of(self.run)) if isinstance(step, Flip))
        anchor = pairing.anchors.get(name)
        return 0 if anchor is None else steps_through(self.run.events[anchor])

    def numbers(self, pairing: Pairing, name: str, bits: int) -> FlightBalls:
        """As `RunReader.numbers`, at the replay's bits."""
        return self._numbers[name, self._upto(pairing, name)]

    def _proves(self, is_zero: Callable[[OwnFlight, OwnFlight, Quantity], bool], pairing: Pairing) -> bool:
        """Balls do not tell."""
        return False

    @property
    def decides(self) -> bool:
        """Whether the balls tell the answer, and all that it rests on: that the circles come nearer, and meet."""
        with ball.precision(self.bits):
            if not all(self._clear(pairing) for pairing in self.decision.pairings):
                return False
            value = self._value(self.decision, self.bits)
            return value is not None and ball.sign_of(value) in (-1, 1)

    def _clear(self, pairing: Pairing) -> bool:
        if self.is_wall(pairing):
            told = self._wall(pairing, self.bits)
            return told is not None and ball.sign_of(told[2]) in (-1, 1)
        relative = self._relative(pairing, self.bits)
        assert relative is not None
        _, dx, dy, vx, vy, reach = relative
        nearer = ball.sign_of(pair_approach(dx, dy, vx, vy))
        if self.decision.kind == "hit":
            return nearer is not None
        return nearer == -1 and ball.sign_of(pair_discriminant(dx, dy, vx, vy, reach)) == 1


def steps_of(run: Trajectory) -> Sequence[Step]:
    """The log of an exact run."""
    motion = motion_of(run)
    assert motion is not None
    return motion.log.steps
