"""The contract between the event loop and a number system, the limits of a run, and the history that it gathers."""

from __future__ import annotations

from abc import abstractmethod
from collections import Counter
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Generic, NamedTuple, Protocol, TypeAlias, TypeVar

from ...scenarios.engine import horizon
from ...scenarios.numbers.quantity import Quantity, QuantityLike
from ...scenarios.scene import Scene
from ...scenarios.trajectory import Assumption, Tie
from ..numbers.system import N
from ..question import Decision, Question
from ..replay.contact import AtWall, Body, Entry, Link, Touch
from ..replay.state import Step
from .prediction import Arrival, ArrivalQueue

# -- Where an event-driven run ends.


@dataclass(frozen=True, eq=False)
class Limits:
    """The limits of a run.

    Attributes:
        until: the last time that belongs to it; None: no such limit.
        events: the most events; None: no such limit.
        to_return: whether it ends at the return, twice the time of the reversal.
    """

    until: Quantity | None
    events: int | None
    to_return: bool = False


def run_limits(scene: Scene, until: QuantityLike | None, events: int | None) -> Limits:
    """The limits of an event-driven run, with the return of a reversed one as its default end.

    Raises:
        SceneError: for limits that are not above zero.
    """
    time, count = horizon(scene, until, events)
    reversing = scene.reverse_after is not None or scene.reverse_at is not None
    own = until is not None or events is not None or scene.until is not None or scene.events is not None
    if reversing and not own:
        return Limits(None, None, to_return=True)
    return Limits(time, count)


# -- What a run has gathered, by index: records of events, entries, the reversal, and the knots of the flights.

K = TypeVar("K")
"""The numbers that a history keeps: of one system, or of several side by side."""

REVERSAL = "reversal"
"""The source of the reversal's own time."""


class Mark(NamedTuple, Generic[K]):
    """An instant of a run, and how its time is computed again from the log.

    Attributes:
        number: its place among the instants of the run; 0 is time 0.
        time: the number at hand.
        step: how many steps of the log there are at its end.
        source: the circle whose clock stands at it; or the entry that comes at it; or REVERSAL.
    """

    number: int
    time: K
    step: int
    source: int | Link | str


class Record(NamedTuple, Generic[K]):
    """One event."""

    mark: Mark[K]
    links: tuple[Touch, ...]
    impulses: tuple[Touch, ...]
    ties: tuple[Tie, ...]
    coupled: bool


class Arrived(NamedTuple, Generic[K]):
    """The centre of a circle enters a pocket."""

    circle: int
    pocket: int
    mark: Mark[K]


Knot: TypeAlias = tuple[K, K, K, K, K, int, int]
"""(t, x, y, vx, vy) of a circle, the steps of the log by then, the number of the instant."""


@dataclass(slots=True)
class Noted(Generic[K]):
    """What an instant did, or a part of it, in the history's terms."""

    records: list[Record[K]] = field(default_factory=list)
    entries: list[Arrived[K]] = field(default_factory=list)
    knots: list[tuple[int, Knot[K]]] = field(default_factory=list)
    reversal: Mark[K] | None = None
    last: Mark[K] | None = None


R = TypeVar("R")


class KeptRows(Sequence[R]):
    """What a history is kept in, other than a list: it takes less memory."""

    @abstractmethod
    def append(self, row: R) -> None:
        """One more."""

    @abstractmethod
    def pop(self) -> R:
        """Takes the last away."""


@dataclass
class History(Generic[K]):
    """What a loop has gathered, always up to the end of a whole instant.

    Attributes:
        records: the events.
        entries: the entries into pockets.
        reversal: how many events came before it, and when it was.
        knots: for each circle one at the start and one after each instant that changed its velocity.
        steps: the log.
        plan: what each rung decided, and what was skipped.
        rises: the bits of each rise of the precision, and whether deviations were kept in a set from then on.
        assumptions: what the run rests on that is not proved.
        row: what keeps the knots of a circle, made of those that there are.
        set_times: limits and the reversal's time, with the number of the last part of the instant that falls on it.
    """

    records: list[Record[K]] | KeptRows[Record[K]] = field(default_factory=list)
    entries: list[Arrived[K]] = field(default_factory=list)
    reversal: tuple[int, Mark[K]] | None = None
    knots: list[list[Knot[K]] | KeptRows[Knot[K]]] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    plan: Counter[str] = field(default_factory=Counter)
    rises: list[tuple[int, bool]] = field(default_factory=list)
    assumptions: list[Assumption] = field(default_factory=list)
    set_times: dict[Quantity, int] = field(default_factory=dict)
    row: Callable[[list[Knot[K]]], list[Knot[K]] | KeptRows[Knot[K]]] = list
    _last: Mark[K] | None = None

    @property
    def last(self) -> Mark[K] | None:
        """The last instant at which anything happened; None before the first."""
        return self._last

    @last.setter
    def last(self, mark: Mark[K] | None) -> None:
        self._last = mark

    def add(self, note: Noted[K]) -> None:
        """Takes up what an instant, or a part of one, did. It is whole once `last` says so."""
        for record in note.records:
            self.records.append(record)
        self.entries += note.entries
        for i, knot in note.knots:
            self.knots[i].append(knot)

    def drop_unfinished(self) -> None:
        """Drops what does not belong to the last instant that was noted whole, or to those before it."""
        number, step = (-1, 0) if self.last is None else (self.last.number, self.last.step)
        del self.steps[step:]
        while self.records and self.records[-1].mark.number > number:
            self.records.pop()
        self.entries = [entry for entry in self.entries if entry.mark.number <= number]
        if self.reversal is not None and self.reversal[1].number > number:
            self.reversal = None
        for row in self.knots:
            while len(row) > 1 and row[-1][-1] > number:
                row.pop()


# -- The contract between the event loop and a number system: how it keeps bodies, and what it can decide.


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

    @property
    def slides(self) -> list[AtWall]:
        """Circles that predictions have seen to stand at the line of a face and to fly along it; taken by the loop."""
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

    Attributes:
        proves: whether its answers are proved; what no rounding may claim is asked of it alone.
    """

    @property
    def proves(self) -> bool:
        """See the attributes."""
        ...

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
