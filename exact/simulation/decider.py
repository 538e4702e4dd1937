"""The contract between the event loop and a number system: how it keeps bodies, and what it can decide."""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from typing import Protocol

from ...scenarios.numbers.quantity import Quantity
from ..numbers.system import N
from ..predicates.question import Decision, Question
from ..replay.body import Body
from ..replay.contact import Entry, Link, Touch
from ..replay.steps import Step
from .arrivals.queue import Arrival, ArrivalQueue
from .history import History, K


class Meetings(Protocol[N]):
    """Predicts and orders the meetings of one run."""

    def predict(self, moved: Sequence[Body[N]], standing: Collection[Link], gone: Collection[int]) -> None:
        """Queues the next meetings of circles whose flights are new.

        Args:
            moved: those circles.
            standing: contacts and rims at gap zero that do not approach: nothing to predict until a flight changes.
            gone: circles out of play.
        """
        ...

    def settled(self, arrival: Arrival[N]) -> Arrival[N] | None:
        """An arrival that may not come, made one that does; None if it does not come.

        Raises:
            Undecided: if that is not to be had.
        """
        ...

    def timed(self, arrival: Arrival[N]) -> Arrival[N]:
        """The arrival with its time computed."""
        ...

    def certainly_before(self, first: Arrival[N], second: Arrival[N]) -> bool:
        """Whether the one comes before the other, as far as their times at hand tell."""
        ...

    def order(self, first: Arrival[N], second: Arrival[N]) -> Decision:
        """Whether the one comes before (negative), with (zero) or after (positive) the other.

        Raises:
            Undecided: if that is not to be had.
        """
        ...

    def off_rim(self, link: Entry) -> bool:
        """Whether a centre is plainly not on the rim of a pocket; False says nothing."""
        ...


class Reading(Protocol[N, K]):
    """Reads a state off, in the numbers that the history keeps."""

    def knot(self, body: Body[N]) -> tuple[K, K, K, K, K]:
        """(t, x, y, vx, vy) of a body."""
        ...

    def now(self, body: Body[N]) -> K:
        """The instant at which a body's clock stands."""
        ...

    def entry_time(self, link: Entry) -> K:
        """The time of an entry."""
        ...

    def reversal_time(self) -> K:
        """The time of the reversal."""
        ...

    def exact_state(self, bodies: Sequence[int]) -> Hashable | None:
        """A key of the bodies' exact states, equal only for equal states; None where none is at hand."""
        ...

    def rough(self, time: K) -> float:
        """About what double a time is."""
        ...

    def limit_bounds(self, time: Quantity | None) -> tuple[float, float]:
        """Doubles that enclose a set time (None: the return)."""
        ...

    def note(self) -> str:
        """What progress says beside the counts."""
        ...


class Ordinary(Protocol):
    """Carries out, in one go, instants of one contact that nothing comes near, with all that follows from them."""

    def __call__(
        self, last: int, most: float, before: float, look: Callable[[], None], note: Callable[[Touch], None]
    ) -> int:
        """Carries out instants as long as they are of that kind; gives the number of the last.

        Args:
            last: the number of the instant before.
            most: how many at most.
            before: a time that all come before.
            look: called before each look for an instant.
            note: told of each contact.
        """
        ...

    def again(self, link: Touch, number: int, note: Callable[[Touch], None]) -> None:
        """Carries out one that an earlier run had, of that contact and number; its meetings are not predicted."""
        ...


class Decider(Protocol[N, K]):
    """Keeps the state of one scene in some numbers, and decides what the loop asks.

    The log in its history is its own; `meetings` and `reading` are its other two faces.
    """

    @property
    def history(self) -> History[K]:
        """What the run has gathered."""
        ...

    @property
    def bodies(self) -> Mapping[int, Body[N]]:
        """The circles, by index."""
        ...

    @property
    def queue(self) -> ArrivalQueue[N]:
        """Where predictions go."""
        ...

    @property
    def stride(self) -> Ordinary | None:
        """Carries out ordinary instants by itself; None: the loop does."""
        ...

    @property
    def meetings(self) -> Meetings[N]:
        """Predicts and orders meetings."""
        ...

    @property
    def reading(self) -> Reading[N, K]:
        """Reads the state off."""
        ...

    def begin(self, instant: int) -> None:
        """Called before the steps of an instant, with its number."""
        ...

    def do(self, step: Step) -> None:
        """Carries out a step and logs it."""
        ...

    def gathered(self, links: Iterable[Link]) -> None:
        """Told which contacts stand at gap zero once an instant's impulses are done."""
        ...

    def ask(self, question: Question) -> int:
        """The sign of a question.

        Raises:
            Undecided: if it is not to be had.
        """
        ...

    def ask_cheaply(self, question: Question) -> int | None:
        """The sign of a question if it is to be had at once, else None."""
        ...

    def refresh(self, bodies: Iterable[Body[N]]) -> None:
        """Makes the numbers that predictions use current for circles whose flights are new.

        Raises:
            Undecided: if the instant is not known sharply enough, and cannot be.
        """
        ...
