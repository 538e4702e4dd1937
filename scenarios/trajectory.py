"""What a run gives back: events, the reason it stopped, and the motion between them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import field
from enum import Enum
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, SupportsFloat, TypeAlias

from .lazy import frozen, kept
from .numbers.quantity import ZERO, Quantity, Real, real
from .scene import Scene

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

# -- What happens at instants: contacts, how it is known that they are simultaneous, entries, the reversal.


class Contact(NamedTuple):
    """Two touching things by id: the circle that comes first in the scene is first, a wall is last."""

    first: str
    second: str


class TieProof(Enum):
    """How it is known that several contacts fall on one instant; weakest last."""

    CONSTRUCTION = "the same instant by construction"
    RATIONAL = "computed in rational numbers"
    FIELD = "signs of coefficients in the field of the state"
    SYMMETRY = "an isometry maps the causal past of the one to that of the other"
    WAY_BACK = "the way back retraces a tie of the way out"
    TOWER = "replayed in nested square roots in normal form"
    ASSUMED = "agreement to as many bits as the user asked for: an assumption"
    FLOAT = "equal in the engine's own finite precision"

    @property
    def proved(self) -> bool:
        """Whether this is a proof."""
        return self not in (TieProof.ASSUMED, TieProof.FLOAT)


@frozen
class Tie:
    """Several contacts on one instant, and how that is known.

    Attributes:
        contacts: the contacts shown to be simultaneous.
        proof: on what that rests.
        bound: for ASSUMED, the bits of agreement.
    """

    contacts: tuple[Contact, ...]
    proof: TieProof
    bound: int | None = None


@frozen
class Assumption:
    """A decision that rests on less than proof; everything from its event on rests on it.

    Attributes:
        event: index of the first event that follows from it.
        question: what was decided, in words.
        proof: on what that rests.
        bound: as in `Tie`.
    """

    event: int
    question: str
    proof: TieProof
    bound: int | None = None

    def __str__(self) -> str:
        return (
            f"from event {self.event} on, this rests on a zero that is not proved ({self.question}): "
            f"agreement to {self.bound} bits"
        )


@frozen
class Event:
    """One instant at which contacts collide.

    Attributes:
        index: place in the trajectory, from 0.
        time: the instant; float(time) is the nearest double.
        contacts: the contacts that took part, in scene order: those that approach as the instant comes, and
            those that come to approach in its rounds of impulses.
        impulses: the pairwise impulses in the order applied; their number is the number of collisions.
        ties: how it is known that the contacts are simultaneous; empty for a single contact.
        coupled: whether the order of the impulses could matter: some circle takes part in several contacts that
            are not at right angles to each other.
    """

    index: int
    time: Real
    contacts: tuple[Contact, ...]
    impulses: tuple[Contact, ...]
    ties: tuple[Tie, ...] = ()
    coupled: bool = False


@frozen
class Reversal:
    """The one moment at which every velocity was negated.

    Attributes:
        after: number of instants before it.
        time: the moment.
    """

    after: int
    time: Real


@frozen
class Pocketing:
    """The centre of a circle enters a pocket.

    Attributes:
        circle: the circle's id.
        pocket: the pocket's id.
        time: the instant.
    """

    circle: str
    pocket: str
    time: Real


@frozen
class Settling:
    """A wall begins to carry a circle, which is at rest on it from then on, or slides along it.

    Attributes:
        circle: the circle's id.
        wall: the wall's id.
        time: the instant.
        since: where infinitely many bounces come before that, the time of the last that the run lists; None elsewhere.
        other: the other wall's id, of two slopes that hold the circle between them; None elsewhere.
    """

    circle: str
    wall: str
    time: Real
    since: Real | None = None
    other: str | None = None

    @property
    def where(self) -> str:
        """Where the circle lies, in words."""
        if self.other is None:
            return f"on {self.wall}"
        return f"between {self.wall} and {self.other}" if self.other != self.wall else f"in a corner of {self.wall}"

    def unlisted(self, end: Real) -> str | None:
        """That a run which ends before the instant does not list all bounces of the circle by then; None: it does.

        >>> Settling("a", "floor", 3.0, since=2.0).unlisted(2.5)
        'a bounces infinitely often on floor until time 3; no bounce of it after time 2 is listed'
        """
        if self.since is None or not float(self.since) < float(end):
            return None
        told = f"{self.circle} bounces infinitely often {self.where} until time {float(self.time):.9g}"
        return f"{told}; no bounce of it after time {float(self.since):.9g} is listed"


# -- What a run gives back: events, the reason it stopped, and the motion between them.


@frozen
class CircleState:
    """Where a circle is and how fast it goes, in the engine's own numbers."""

    id: str
    x: Real
    y: Real
    vx: Real
    vy: Real


@frozen
class State:
    """All circles at one time, in scene order."""

    time: Real
    circles: tuple[CircleState, ...]

    def __getitem__(self, name: str) -> CircleState:
        for circle in self.circles:
            if circle.id == name:
                return circle
        raise KeyError(name)

    def array(self) -> NDArray[np.float64]:
        """Shape (circles, 4): x, y, vx, vy as doubles."""
        import numpy as np

        return np.array(self.rows())

    def rows(self) -> list[tuple[float, float, float, float]]:
        """The same in a list, which needs no NumPy."""
        return [(float(c.x), float(c.y), float(c.vx), float(c.vy)) for c in self.circles]


class StopReason(Enum):
    """Why a run ended; the value is what a person reads."""

    HORIZON = "reached the time limit"
    EVENTS = "reached the limit on instants"
    QUIET = "no further collision: nothing left to happen"
    REST = "at rest: a circle stands on what gravity pulls it to"
    ACCUMULATION = "infinitely many collisions in finite time"
    CRUSHED = "crushed: two walls that close leave no room for a circle"
    UNDECIDED = "undecided: what happens next could not be proved"
    BUDGET = "the budget is spent"
    INTERRUPTED = "interrupted"


AT_AN_END = frozenset((StopReason.REST, StopReason.ACCUMULATION, StopReason.CRUSHED))
"""Reasons that lie in the motion, though time goes on: no limit lets a run go on from there."""


@frozen
class Stop:
    """The reason for the end of a run, with the particulars."""

    reason: StopReason
    message: str


class Motion(Protocol):
    """The motion between the events, as an engine keeps it.

    One with a method `after(event)`, which gives the rows as an event leaves them, by its index, can have several
    events at one time; or with `among(place, time, done, count)`, which gives that of a circle after some of its so
    many events at one time, or None.
    """

    def state(self, time: Any) -> Sequence[tuple[SupportsFloat, SupportsFloat, SupportsFloat, SupportsFloat]]:
        """(x, y, vx, vy) of every circle at a time; at an event, as it leaves it. Plain floats are doubles."""
        ...

    def sample(self, times: Sequence[float]) -> NDArray[np.float64]:
        """Shape (times, circles, 4): the same as doubles at ascending times."""
        ...


@frozen
class Progress:
    """How far a run is: instants done, and the time reached."""

    events: int
    time: float
    note: str = ""


OnProgress: TypeAlias = Callable[[Progress], None]


@frozen
class Trajectory:
    """The history of one scene in one engine.

    Attributes:
        scene: what was run.
        engine: the engine's name.
        parameters: the engine's settings, all of them.
        events: the instants, in order.
        stop: why it ended.
        final_time: the time of the final state.
        motion: positions and velocities between events; ask through `at` and `sample`.
        reversal: where velocities were negated, if they were.
        pocketings: entries into pockets, in order.
        assumptions: decisions that rest on less than proof, in order.
        plan: what each rung of the decision ladder decided and what was skipped, as counts.
        notes: what the run says of itself, one sentence each (such as an exact return to the start).
        ending: where it stopped at an ACCUMULATION, the time by which all of the infinitely many have happened; where
            it was CRUSHED, when no room is left.
        settlings: where walls began to carry circles, in order; none but with `settle`.
    """

    scene: Scene
    engine: str
    parameters: Mapping[str, Any]
    events: Sequence[Event]
    stop: Stop
    final_time: Real
    motion: Motion = field(repr=False)
    reversal: Reversal | None = None
    pocketings: tuple[Pocketing, ...] = ()
    assumptions: tuple[Assumption, ...] = ()
    plan: Mapping[str, Any] = field(default_factory=dict[str, Any])
    notes: tuple[str, ...] = ()
    ending: Real | None = None
    settlings: tuple[Settling, ...] = ()

    def at(self, time: str | SupportsFloat) -> State:
        """The state at a time from 0 to `final_time`; at an event, as it leaves it.

        Args:
            time: exact text such as "9/4", a number, or a time of this run.

        Raises:
            ValueError: outside of that range.
        """
        if isinstance(time, str):
            time = Quantity.of(time)
        return self._state(time, self.motion.state(time))

    def circle(self, name: str, time: str | SupportsFloat) -> CircleState:
        """One circle of `at`, of which a motion with a method `circle(place, time)` tells without the others.

        Raises:
            ValueError: outside of that range.
            KeyError: for an unknown name.
        """
        told = getattr(self.motion, "circle", None)
        if told is None:
            return self.at(time)[name]
        place = {str(c.id): k for k, c in enumerate(self.scene.circles)}[name]
        row = told(place, Quantity.of(time) if isinstance(time, str) else time)
        return CircleState(name, *map(real, row))

    def after(self, event: int) -> State:
        """The state as an event leaves it, by its index; without what follows at the same time, if the motion tells."""
        time, told = self.events[event].time, getattr(self.motion, "after", None)
        rows = self.motion.state(time) if told is None else told(event)
        among, sides = getattr(self.motion, "among", None), (event - 1, event + 1)
        if told is None and among and any(0 <= k < len(self.events) and self.events[k].time == time for k in sides):
            low, high = event, event + 1
            while low and self.events[low - 1].time == time:
                low -= 1
            while high < len(self.events) and self.events[high].time == time:
                high += 1
            rows = list(rows)
            for place, circle in enumerate(self.scene.circles):
                own = [e.index <= event for e in self.events[low:high] if any(str(circle.id) in p for p in e.impulses)]
                rows[place] = (among(place, float(time), sum(own), len(own)) if own else None) or rows[place]
        return self._state(time, rows)

    @kept
    def final(self) -> State:
        """The state at the end."""
        return self.at(self.final_time)

    def _state(self, time: SupportsFloat, rows: Iterable[Sequence[SupportsFloat]]) -> State:
        circles = zip(self.scene.circles, rows, strict=True)
        return State(real(time), tuple(CircleState(str(c.id), *map(real, row)) for c, row in circles))

    def sample(self, times: Sequence[float]) -> NDArray[np.float64]:
        """Shape (times, circles, 4): x, y, vx, vy as doubles, at ascending times within the run."""
        return self.motion.sample(times)

    def rests_on(self, event: int) -> Assumption | None:
        """The first assumption on which an event rests; None if all before it is proved."""
        return next((assumption for assumption in self.assumptions if assumption.event <= event), None)

    def __str__(self) -> str:
        """The scene, the engine, how many events, and why it ended."""
        events = f"{len(self.events):,} event{'s' * (len(self.events) != 1)}"
        return f"{self.scene.name} in {self.engine}: {events}; {self.stop.message}"

    def _repr_html_(self) -> str:
        """The events as a table, and a picture of the state that they lead to, for a notebook."""
        from .pictures import as_at, html_table, shown, state_picture

        rows = (
            [event.index, float(event.time), ", ".join(f"{first} and {second}" for first, second in event.impulses)]
            for event in self.events
        )
        told = [f"{len(self.events):,} events, {self.stop.message}", *map(str, self.assumptions[:1])]
        caption = f"{self.scene.name} in {self.engine}: {'; '.join(told)}"
        table, final = html_table(caption, ("event", "time", "impulses"), rows, len(self.events)), self.final
        title = f"{self.scene.name} at time {float(self.final_time):.9g}"
        scene = as_at(self.scene, float(self.final_time))
        picture = lambda: state_picture(scene, final.array().tolist(), title, standalone=True)  # noqa: E731
        return shown(table, self.scene, picture, title)

    @property
    def slides(self) -> dict[str, tuple[float, tuple[float, float]]]:
        """The circles that slide down slopes, by id: from when on, and what there is of gravity along those.

        >>> from truebreak.exact import ExactEngine
        >>> from truebreak.scenarios import Circle, Scene, Wall
        >>> slope = Wall(0, 0, 4, -3, id="slope")
        >>> scene = Scene([Circle("3/5", "4/5", id="a")], [slope], gravity=(0, -10), settle=True)
        >>> ExactEngine().run(scene, until=1).slides
        {'a': (0.0, (4.8, -3.6))}
        """
        walls, (gx, gy) = {wall.id: wall for wall in self.scene.walls}, self.scene.gravity or (ZERO, ZERO)
        last = {s.circle: s for s in self.settlings}.values()
        along = [(s, walls[s.wall].along(gx, gy)) for s in last if s.wall in walls and s.other is None]
        return {s.circle: (float(s.time), (float(x), float(y))) for s, (x, y) in along if x.sign() or y.sign()}

    @property
    def collisions(self) -> int:
        """Number of pairwise impulses."""
        return sum(len(event.impulses) for event in self.events)

    @property
    def certified(self) -> bool:
        """Whether every decision rests on proof."""
        return not self.assumptions and all(tie.proof.proved for event in self.events for tie in event.ties)
