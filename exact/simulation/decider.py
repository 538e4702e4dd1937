"""The contract between the event loop and a number system, the limits of a run, and the history that it gathers."""

from __future__ import annotations

from abc import abstractmethod
from array import array
from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from operator import itemgetter
from typing import TYPE_CHECKING, Any, ClassVar, Generic, NamedTuple, Protocol, TypeAlias, TypeVar, cast, overload

from flint import arb, arb_mat

from ...scenarios.engine import horizon
from ...scenarios.lazy import frozen
from ...scenarios.numbers.quantity import Quantity, QuantityLike
from ...scenarios.numbers.tower_element import Element
from ...scenarios.numbers.tower_ring import TowerLimit
from ...scenarios.scene import Scene
from ...scenarios.trajectory import Assumption, Tie
from ...scenarios.work import Work
from ..numbers import ball
from ..numbers.ball import Known, NestedNumbers
from ..numbers.system import N, number_system
from ..question import Decision, Question
from ..replay.centred_state import CentredState
from ..replay.contact import AtWall, Body, Entry, Link, Sides, Touch
from ..replay.state import Lift, ReplayState, Settle, Step, Take, causal_past, replay, step_units
from .endings import Rows
from .policies import Accumulating
from .prediction import Arrival, ArrivalQueue

if TYPE_CHECKING:
    from ..numbers.expression import SymPyExpression

# -- Where an event-driven run ends.


@frozen
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


@dataclass(slots=True, repr=False, eq=False)
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


@dataclass(repr=False, eq=False)
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
        last: the last instant at which anything happened; None before the first.
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
    last: Mark[K] | None = None

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


# -- The history of a long exact run in little memory: short balls packed by the block, and given back bit for bit.
#
# An object for each ball takes twice the memory of the ball itself, and the tuples that hold them as much again. What
# cannot be packed, such as exact numbers, stays as it is.


class PackedRows(KeptRows[R], Generic[R]):
    """Rows that are only ever added to and dropped at the end; all but the last few are packed.

    Args:
        rows: those that are there from the start on.
    """

    __slots__ = ("_blocks", "_most", "_tail")

    block: ClassVar[int]
    """Rows that are packed together."""

    short: ClassVar[int]
    """Rows from which on they are packed at all: less is not worth the time."""

    def __init__(self, rows: Iterable[R] = ()) -> None:
        self._blocks: list[Any] = []
        self._tail: list[R] = []
        self._most = self.short
        self += rows

    def __reduce__(self) -> tuple[Callable[..., PackedRows[R]], tuple[list[R]]]:
        return type(self), (list(self),)

    @abstractmethod
    def _packed(self, rows: list[R]) -> Any:
        """A block of them; the rows themselves where they cannot be packed."""

    @abstractmethod
    def _row(self, block: Any, k: int) -> R:
        """One of a block that is packed."""

    @abstractmethod
    def _rows(self, block: Any) -> Iterable[R]:
        """All of one that is packed."""

    def append(self, row: R) -> None:
        """One more."""
        tail = self._tail
        tail.append(row)
        if len(tail) >= self._most:
            for _ in range(len(tail) // self.block):
                self._blocks.append(self._packed(tail[: self.block]))
                del tail[: self.block]
            self._most = self.block

    def pop(self) -> R:
        """Takes the last away."""
        if not self._tail:
            self._tail = [*self._of(self._blocks.pop())]
            self._most = self.block if self._blocks else self.short
        return self._tail.pop()

    def __iadd__(self, rows: Iterable[R]) -> PackedRows[R]:
        for row in rows:
            self.append(row)
        return self

    def __len__(self) -> int:
        return self.block * len(self._blocks) + len(self._tail)

    @overload
    def __getitem__(self, k: int) -> R: ...

    @overload
    def __getitem__(self, k: slice) -> list[R]: ...

    def __getitem__(self, k: int | slice) -> R | list[R]:
        if isinstance(k, slice):
            return [self[place] for place in range(*k.indices(len(self)))]
        place = k + len(self) if k < 0 else k
        if not 0 <= place < len(self):
            raise IndexError(k)
        number, within = divmod(place, self.block)
        if number >= len(self._blocks):
            return self._tail[place - self.block * len(self._blocks)]
        found = self._blocks[number]
        return found[within] if isinstance(found, list) else self._row(found, within)

    def __iter__(self) -> Iterator[R]:
        for block in self._blocks:
            yield from self._of(block)
        yield from self._tail

    def _of(self, block: Any) -> Iterable[R]:
        return block if isinstance(block, list) else self._rows(block)


class PackedKnots(PackedRows[Knot[Known]]):
    """The knots of a circle.

    >>> rows = [(arb(k), arb(1), arb(2), arb(3), arb(4), 2 * k, k) for k in range(3000)]
    >>> knots = PackedKnots(rows)
    >>> len(knots), knots[70][0] == 70, knots[-1][5:], [*knots][150][5:]
    (3000, True, (5998, 2999), (300, 150))
    """

    __slots__ = ()
    block, short = 256, 2048

    def _packed(self, rows: list[Knot[Known]]) -> Any:
        values: list[Any] = [value for row in rows for value in row[:5]]
        if any(type(value) is not arb for value in values):
            return rows
        return arb_mat(len(rows), 5, values), array("q", [row[5] for row in rows]), array("q", [r[6] for r in rows])

    def _row(self, block: Any, k: int) -> Knot[Known]:
        balls, steps, instants = block
        return balls[k, 0], balls[k, 1], balls[k, 2], balls[k, 3], balls[k, 4], steps[k], instants[k]

    def _rows(self, block: Any) -> Iterable[Knot[Known]]:
        balls, steps, instants = block
        values = balls.entries()
        return (cast("Knot[Known]", (*values[5 * k : 5 * k + 5], steps[k], instants[k])) for k in range(len(steps)))


class PackedRecords(PackedRows[Record[Known]]):
    """The events of a run; those of one contact, which proves no tie, are packed.

    >>> from truebreak.exact.replay.contact import Pair
    >>> rows = [Record(Mark(2 * k, arb(k), 3 * k, 0), (Pair(0, 1),), (Pair(0, 1),), (), False) for k in range(9000)]
    >>> records = PackedRecords(rows)
    >>> records[70].mark.number, records[70].links, records[8999].mark.step
    (140, (Pair(a=0, b=1),), 26997)
    >>> float(records.time_at(140)), records.time_at(141).is_finite()
    (70.0, False)
    """

    __slots__ = ()
    block, short = 1024, 8192

    def _packed(self, rows: list[Record[Known]]) -> Any:
        if not all(map(_is_plain, rows)):
            return rows
        marks = [row.mark for row in rows]
        numbers = array("q", [each for mark in marks for each in (mark.number, mark.step, cast("int", mark.source))])
        times: list[Any] = [mark.time for mark in marks]
        links: list[tuple[Touch, ...]] = [row.links for row in rows]
        return links, arb_mat(len(marks), 1, times), numbers

    def time_at(self, instant: int) -> Known:
        """The time of an instant, by its number; a ball that says nothing, where no event falls on it."""
        k = bisect_left(self, instant, key=lambda record: record.mark.number)
        found = self[k].mark if k < len(self) else None
        return arb.nan() if found is None or found.number != instant else found.time

    def _row(self, block: Any, k: int) -> Record[Known]:
        links, times, numbers = block
        number, step, source = numbers[3 * k : 3 * k + 3]
        return Record(Mark(number, times[k, 0], step, source), links[k], links[k], (), False)

    def _rows(self, block: Any) -> Iterable[Record[Known]]:
        return (self._row(block, k) for k in range(len(block[0])))


def _is_plain(row: Record[Known]) -> bool:
    mark = row.mark
    plain = row.impulses is row.links or row.impulses == row.links
    return plain and not row.ties and not row.coupled and type(mark.time) is arb and type(mark.source) is int


# -- The log of a finished run, from which every number of it is computed again.

TEXT_DEPTH = 5
"""Nested roots up to which a value is written out in full; beyond, it is given by shared definitions."""

TEXT_WORK = 1_000_000
"""Units of work that writing out one value may take: about a second."""

STATES_KEPT = 3
"""Of how many numbers of bits a log keeps how far it was replayed."""


class Formula(Protocol):
    """Computes a number from a state, in its numbers."""

    def __call__(self, state: ReplayState[N], /) -> N: ...


class RunLog:
    """A scene and the log of its run: enough to compute every number of the run again.

    Attributes:
        given: the scene; `scene` is as engines see it.
        steps: the log.
        lost: how many bits of its precision the run lost, at most, in the time of an event.
        centred: whether that was with the deviations in a set (see `CentredState`).
        events: those of the run, whose times are at hand; None where it was read from a file.
    """

    events: PackedRecords | None = None

    def __init__(self, scene: Scene, steps: Sequence[Step], lost: int, centred: bool = False) -> None:
        self.given = scene
        self.steps = steps
        self.lost = lost
        self.centred = centred
        self._reached: dict[tuple[int, int], CentredState] = {}
        self._too_deep: list[frozenset[int]] = []
        self._written: tuple[tuple[list[int], list[int]], ReplayState[Element], NestedNumbers, int] | None = None

    @cached_property
    def scene(self) -> Scene:
        """The scene with its faces, ends and arcs."""
        return self.given.surfaces

    def __getstate__(self) -> dict[str, Any]:
        """All but what is computed again at need."""
        return {**self.__dict__, "_reached": {}, "_too_deep": [], "_written": None, "events": None}

    def in_balls(self, bits: int, upto: int) -> CentredState:
        """The state after the first `upto` steps, in balls computed with `bits` bits.

        The one that came farthest with these bits, but not too far, goes on from there, so that numbers asked for in
        the order of the run cost one replay together.
        """
        ball.use_bits(bits)
        done = max((reached for width, reached in self._reached if width == bits and reached <= upto), default=0)
        state = self._reached.pop((bits, done), None)  # what is ended half-way is not kept
        if state is None:
            state = CentredState(self.scene, self.centred)
        if done < upto:
            replay(state, self.steps, range(done, upto))
        while len(self._reached) >= STATES_KEPT:
            del self._reached[next(iter(self._reached))]
        self._reached[bits, upto] = state
        return state

    def begins(self, other: RunLog, upto: int) -> bool:
        """Whether another log has the same first `upto` steps, of the same scene: then its numbers are the same."""
        same = other is self or (len(other.steps) >= upto and other.scene == self.scene)
        ours, theirs = (self.steps, other.steps) if other is not self else ((), ())
        return same and all(one == two for one, two in zip(ours[:upto], theirs[:upto], strict=True))

    def carries(self, circle: int, upto: int) -> bool:
        """Whether a wall carries a circle after the first `upto` steps (see `Settle`), or it is out of play."""
        known = self._carried.get(circle, [])
        before = bisect_right(known, upto, key=itemgetter(0))
        return before > 0 and known[before - 1][1]

    def slope(self, circle: int, upto: int) -> int | None:
        """The wall that a circle slides down after the first `upto` steps (see `Settle`); None of any other."""
        known = self._slopes.get(circle)
        return known[1] if known is not None and known[0] <= upto else None

    @cached_property
    def _slopes(self) -> dict[int, tuple[int, int]]:
        """For each circle that slides down a wall for ever, how many steps led to where it does, and that."""
        sides, steps = Sides(self.scene), enumerate(self.steps if self.given.settle else (), start=1)
        settled = ((k, s) for k, s in steps if isinstance(s, Settle) and s.other < 0)
        return {s.body: (k, s.wall) for k, s in settled if not sides.level(s.wall)}

    @cached_property
    def _carried(self) -> dict[int, list[tuple[int, bool]]]:
        """For each circle that walls have carried, how many steps led to where one does, or none any more; of one that
        went out of play, to there."""
        found: dict[int, list[tuple[int, bool]]] = {}
        for k, step in enumerate(self.steps if self.given.settle or self.given.capture else (), start=1):
            if isinstance(step, Settle | Lift | Take):
                found.setdefault(step.body, []).append((k, not isinstance(step, Lift)))
        return found

    def units(self, bits: int, upto: int) -> int:
        """The work of that."""
        return (len(self.scene.circles) + upto) * step_units(bits)

    def exact(self, upto: int, bodies: Sequence[int], formula: Formula) -> Element | None:
        """A number after the first `upto` steps in nested roots, or None if it is too deep.

        A value whose causal past contains one that was too deep is not tried. Numbers of one past, asked for one after
        another, cost one replay together; each has the work that one alone would have.
        """
        steps = self.steps[:upto]
        needed, held = causal_past(steps, bodies)
        past = frozenset(needed)
        if any(deep <= past for deep in self._too_deep):
            return None
        kept, self._written = self._written, None  # what is ended half-way is not kept
        try:
            if kept is None or kept[0] != (needed, held):
                work = Work(TEXT_WORK)
                numbers = NestedNumbers(TEXT_DEPTH, work)
                state = ReplayState(self.scene, numbers, only=held)
                replay(state, steps, needed)
                kept = (needed, held), state, numbers, work.spent
            _, state, numbers, spent = kept
            roots, numbers.tower.work = len(numbers.tower.generators), Work(TEXT_WORK)
            numbers.tower.work.spend(spent)
            value = formula(state)
        except TowerLimit:
            self._too_deep.append(past)
            return None
        if len(numbers.tower.generators) == roots:  # a formula's own roots are no part of what others would find
            self._written = kept
        return value

    def in_expressions(self, upto: int, bodies: Sequence[int]) -> ReplayState[SymPyExpression]:
        """The states of some bodies after the first `upto` steps, as SymPy expressions that share their parts."""
        needed, held = causal_past(self.steps[:upto], bodies)
        state: ReplayState[SymPyExpression] = ReplayState(self.scene, number_system("expression"), only=held)
        replay(state, self.steps, needed)
        return state


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

    def fallen(self, circle: int) -> tuple[arb, Rows]:
        """Right after a bounce of a circle: when it was, and where all circles are (see `WallFlights.true_rows`)."""
        ...

    def bounces(self, end: Accumulating) -> arb:
        """Under gravity, right after a bounce: how long its like go on alone."""
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
