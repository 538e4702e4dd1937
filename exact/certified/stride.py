"""Many instants in one go: each of one contact alone, which nothing comes near.

Nearly all instants of a run are like that. Nothing is to be gathered or ordered for them, there is one impulse, and
what the loop would do step by step (see `Loop`) is done here in a row, to the same end: the same log, the same history,
the same queue. Whatever is otherwise is left to the loop.
"""

from __future__ import annotations

from collections.abc import Callable

from flint import arb

from ..numbers.field import Known
from ..replay.body import Body
from ..replay.contact import Touch
from ..replay.refinable import RefinableState
from ..replay.steps import Go, Kick
from ..simulation.arrivals.queue import ArrivalQueue
from ..simulation.history import History, Mark, Record
from .meetings import CertifiedMeetings
from .precision import SAFE_BITS, Precision
from .reading import CertifiedReading


class Stride:
    """Carries out the ordinary instants of one run.

    Args:
        state: its state.
        history: what it has gathered.
        queue: its arrivals.
        meetings: predicts.
        reading: reads the state off.
        precision: its bits.
        begin: called before the steps of an instant, with its number.
        do: carries out a step that is not ordinary, and logs it.
    """

    def __init__(
        self,
        state: RefinableState,
        history: History[Known],
        queue: ArrivalQueue[arb],
        meetings: CertifiedMeetings,
        reading: CertifiedReading,
        precision: Precision,
        begin: Callable[[int], None],
        do: Callable[[Go | Kick], None],
    ) -> None:
        self._state = state
        self._history = history
        self._queue = queue
        self._meetings = meetings
        self._reading = reading
        self._precision = precision
        self._begin = begin
        self._do = do
        self._refresh = meetings.predictor.refresh
        self._take = meetings.predictor.take
        self._steps: dict[Touch, tuple[tuple[Go, Kick], list[Body[arb]]]] = {}

    def __call__(
        self, last: int, most: float, before: float, look: Callable[[], None], note: Callable[[Touch], None]
    ) -> int:
        """Carries out instants while they are ordinary; gives the number of the last.

        Args:
            last: the number of the instant before.
            most: how many at most.
            before: a time that all come before.
            look: called before each look for an instant.
            note: told of each contact.
        """
        queue, predict = self._queue, self._meetings.predictor.predict
        while most > 0:
            look()
            link = queue.alone(before)
            if link is None:
                break
            most -= 1
            last += 2
            predict(*self._carried_out(link, last, note, self._precision), ())
        return last

    def again(self, link: Touch, number: int, note: Callable[[Touch], None]) -> None:
        """Carries out an instant that an earlier run had in a stride; its meetings are not predicted.

        Args:
            link: its contact.
            number: of the instant.
            note: told of the contact.
        """
        self._carried_out(link, number, note, None)

    def _carried_out(
        self, link: Touch, number: int, note: Callable[[Touch], None], precision: Precision | None
    ) -> tuple[list[Body[arb]], tuple[Touch, ...]]:
        """Carries out one instant, with the precision looked after if one is given: its circles, and its contact."""
        history, state, reading = self._history, self._state, self._reading
        self._begin(number)
        both, moved = self._steps.get(link) or self._steps_of(link)
        in_balls = state.strike(link, both)
        if not in_balls:
            for step in both:
                self._do(step)
        note(link)
        if precision is not None and state.lowest < SAFE_BITS:
            precision.secure()
        circles, alone = both[0].bodies, both[1].links
        landed = state.lone.landed if in_balls else None
        if landed is not None:
            self._take(landed, landed[0][1][4])
        else:
            self._refresh(moved)
        done = len(state.steps)
        time = +state.balls.instant if in_balls else reading.now(moved[0])  # short, as `refresh` has left it
        mark = _new(Mark, (number, time, done, circles[0]))
        history.records.append(_new(Record, (mark, alone, alone, (), False)))
        knots = history.knots
        for body in moved:
            body.serial += 1
            if in_balls:
                x, y, vx, vy, t = body.q
                knots[body.index].append((t, x, y, vx, vy, done, number))
            else:
                knots[body.index].append((*reading.knot(body), done, number))
        history.last = mark
        return moved, alone

    def _steps_of(self, link: Touch) -> tuple[tuple[Go, Kick], list[Body[arb]]]:
        """The steps of a contact, and its circles."""
        steps = Go(link, link.circles), Kick((link,), (link,))
        found = self._steps[link] = steps, [self._state.bodies[i] for i in link.circles]
        return found


_new = tuple.__new__
"""Makes a named tuple of all its fields: what its own constructor does, in a third of the time."""
