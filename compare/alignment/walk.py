"""Whom each body meets, in order, in two runs side by side: the form in which histories are compared."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise, zip_longest
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory


class PartnersMet(NamedTuple):
    """The partners that one body meets at one instant, once for each impulse between them.

    Attributes:
        event: index of the event.
        partners: ids in the order of the impulses; a partner comes twice if two rounds of impulses passed.
    """

    event: int
    partners: tuple[str, ...]


@dataclass(frozen=True)
class Streams:
    """A trajectory seen body by body.

    Attributes:
        meetings: for each body that can move, its meetings in order. Walls and fixed circles are met, but
            have no history of their own: two balls that bounce off the same wall do not influence each other.
        times: the time of each event as a double.
    """

    meetings: dict[str, list[PartnersMet]]
    times: tuple[float, ...]


def bodies(scene: Scene) -> tuple[str, ...]:
    """Ids of the circles that can move, in scene order."""
    return tuple(str(circle.id) for circle in scene.circles if not circle.fixed)


def history(trajectory: Trajectory) -> Streams:
    """The meetings of every body, from the impulses of every event, in one pass.

    >>> from fractions import Fraction
    >>> from truebreak.scenarios import Contact, Event
    >>> from types import SimpleNamespace
    >>> from truebreak.scenarios import Circle, Scene, Wall
    >>> scene = Scene([Circle(0, 0, id="a"), Circle(3, 0, id="b")], [Wall(9, 0, 9, 1, id="w")])
    >>> ab, bw = Contact("a", "b"), Contact("b", "w")
    >>> events = (Event(0, 1.0, (ab,), (ab,)), Event(1, 2.0, (bw,), (bw,)))
    >>> history(SimpleNamespace(scene=scene, events=events)).meetings["b"]
    [PartnersMet(event=0, partners=('a',)), PartnersMet(event=1, partners=('w',))]
    """
    meetings: dict[str, list[PartnersMet]] = {name: [] for name in bodies(trajectory.scene)}
    for index, event in enumerate(trajectory.events):
        if len(event.impulses) == 1:
            first, second = event.impulses[0]
            if first in meetings:
                meetings[first].append(PartnersMet(index, (second,)))
            if second in meetings:
                meetings[second].append(PartnersMet(index, (first,)))
            continue
        met: dict[str, list[str]] = {}
        for first, second in event.impulses:
            if first in meetings:
                met.setdefault(first, []).append(second)
            if second in meetings:
                met.setdefault(second, []).append(first)
        for body, partners in met.items():
            meetings[body].append(PartnersMet(index, tuple(partners)))
    return Streams(meetings, tuple(float(event.time) for event in trajectory.events))


# ----------------------------------------
# How late a meeting may be and still be the same meeting: a rule that knows nothing of the span compared.

SLOWER = 2.0
"""A run that takes this many times as long to come to a meeting does not come to it."""


@dataclass(frozen=True)
class Patience:
    """How long one run is waited for where the other has a meeting.

    The rule is a function of the meeting's own time. If it depended on the end of the span, a longer span could
    turn a missing meeting into a late one, and take a divergence back.

    Attributes:
        slack: time granted on top of `SLOWER` times the meeting's own.
    """

    slack: float = 0.0

    def latest(self, time: float) -> float:
        """The last time at which another run may have the meeting that one has at `time`.

        >>> Patience(0.5).latest(3.0)
        6.5
        """
        return SLOWER * time + self.slack


class Tail(NamedTuple):
    """Infinitely many bounces of a circle on a wall, or on two that hold it, that come to an end, of which a run lists
    the first.

    Attributes:
        met: how many meetings the circle has up to the last that is listed.
        last: how many of these, one after the other, are with the walls.
        walls: these.
        time: their end.
    """

    met: int
    last: int
    walls: frozenset[str]
    time: float


def _tails(run: Trajectory, streams: Streams, circle: str) -> list[Tail]:
    """Those of one circle, in order."""
    row, found = streams.meetings[circle], list[Tail]()
    for rest in run.settlings:
        if rest.circle == circle and rest.since is not None:
            met = sum(streams.times[k] <= float(rest.since) for k, _ in row)
            walls = frozenset({rest.wall, rest.other or rest.wall})
            before = [walls.issuperset(one.partners) for one in reversed(row[:met])]
            last = before.index(False) if False in before else met
            found.append(Tail(met, last, walls, float(rest.time)))
    return found


def without_tails(
    reference: Trajectory, candidate: Trajectory, mine: Streams, theirs: Streams, patience: Patience
) -> tuple[Streams, Streams]:
    """Two histories without those of infinitely many bounces on a wall that only one of them lists.

    Of these a run may list any number: what it lists beyond the other does not tell them apart.
    """
    sides = [(mine, dict(mine.meetings)), (theirs, dict(theirs.meetings))]
    for circle in mine.meetings:
        dropped: tuple[set[int], set[int]] = set(), set()
        tails = [_tails(run, side, circle) for run, (side, _) in zip((reference, candidate), sides, strict=True)]
        for one, other in zip_longest(*tails):
            if one is not None and other is not None:
                excess = one.last - other.last
                longer, end = (0, one.met) if excess > 0 else (1, other.met)
                dropped[longer].update(range(end - abs(excess), end))
                continue
            known, at = (one, 1) if one is not None else (other, 0)
            assert known is not None
            streams, row = sides[at][0], sides[at][0].meetings[circle]
            place = known.met - len(dropped[1 - at]) + len(dropped[at])
            while place < len(row) and known.walls.issuperset(row[place].partners):
                if streams.times[row[place].event] > patience.latest(known.time):
                    break
                dropped[at].add(place)
                place += 1
        for (_, meetings), out in zip(sides, dropped, strict=True):
            meetings[circle] = [met for place, met in enumerate(meetings[circle]) if place not in out]
    return Streams(sides[0][1], mine.times), Streams(sides[1][1], theirs.times)


def bounces_of_one(
    reference: Trajectory, candidate: Trajectory, patience: Patience
) -> tuple[set[tuple[float, str]], set[tuple[float, str]]]:
    """What `without_tails` leaves out of the reference's history and of the candidate's: times and circles."""
    sides = history(reference), history(candidate)
    kept = without_tails(reference, candidate, *sides, patience)
    mine, theirs = (
        {
            (side.times[met.event], circle)
            for circle, row in side.meetings.items()
            for met in set(row).difference(left.meetings[circle])
        }
        for side, left in zip(sides, kept, strict=True)
    )
    return mine, theirs


def patience_for(scene: Scene, step: float | None) -> Patience:
    """What a scene's own measures grant: the time in which its fastest circle crosses it, and two time steps.

    >>> from truebreak.scenarios import Circle, Scene
    >>> patience_for(Scene([Circle(0, 0, vx=2), Circle(6, 8)]), None).slack
    6.0
    """
    xs, ys = [float(c.x) for c in scene.circles], [float(c.y) for c in scene.circles]
    across = math.hypot(max(xs) - min(xs), max(ys) - min(ys)) + 2 * max(float(c.r) for c in scene.circles)
    fastest = max(math.hypot(float(c.vx), float(c.vy)) for c in scene.circles)
    return Patience((across / fastest if fastest else 1.0) + 2 * (step or 0.0))


# ----------------------------------------
# Walks one body's meetings in two runs side by side, up to the first partner that differs.

REPEATED = 64
"""Time steps within which an engine comes to all rounds of one instant: a round takes few, and a dozen touching circles
take as many rounds."""


@dataclass(frozen=True)
class Mismatch:
    """Where one body's two sequences of partners part.

    Attributes:
        mine, expected: the reference's next event for the body and its partner; None at the end of the
            sequence, or if it comes too late for the candidate's.
        theirs, got: the same for the candidate.
        final: whether more of either run would not change it.
        left: the partners of the candidate's event that are not matched, `got` the first of them.
    """

    mine: int | None
    expected: str | None
    theirs: int | None
    got: str | None
    final: bool = False
    left: tuple[str, ...] = field(default=(), repr=False)


@dataclass
class Walk:
    """One body's meetings, matched.

    Attributes:
        pairs: (reference event, candidate event) for every partner matched.
        split: reference events whose partners the candidate meets in several events, with those.
        merged: candidate events that hold partners of several reference events, with those.
        reordered: reference events whose partners the candidate meets at one instant too, in another order.
        mismatch: where the sequences part, or None if they end together.
    """

    pairs: list[tuple[int, int]] = field(default_factory=list)
    split: dict[int, set[int]] = field(default_factory=dict)
    merged: dict[int, set[int]] = field(default_factory=dict)
    reordered: dict[int, set[int]] = field(default_factory=dict)
    mismatch: Mismatch | None = None

    def left(self, event: int, name: str) -> int:
        """How many times an event of the candidate has a partner beyond what is matched up to the mismatch."""
        parted = self.mismatch
        return 0 if parted is None or parted.theirs != event else parted.left.count(name)


@dataclass
class _Side:
    """One run's meetings of the body, taken up one after the other.

    Attributes:
        open: partners of the current instants that are not matched yet, with their events.
        coming: how many more times that instant has each partner, in later rounds of impulses.
        past: for each partner matched in the last instant that both have, the last event that had it.
        spare: as `coming`, for that instant.
    """

    meetings: Sequence[PartnersMet]
    times: Sequence[float]
    stepped: bool
    place: int = 0
    open: list[tuple[str, int]] = field(default_factory=list)
    coming: Counter[str] = field(default_factory=Counter)
    past: dict[str, int] = field(default_factory=dict)
    spare: Counter[str] = field(default_factory=Counter)

    def fill(self) -> None:
        """Takes up the next instant if none is open."""
        if self.open or self.place >= len(self.meetings):
            return
        meeting = self.meetings[self.place]
        self.place += 1
        names = dict.fromkeys(meeting.partners) if self.stepped else meeting.partners
        self.open = [(name, meeting.event) for name in names]
        self.coming = Counter(meeting.partners) - Counter([*names]) if self.stepped else Counter()

    def has_next(self, name: str) -> bool:
        """Whether a partner is met in the instant after that which was taken up."""
        return self.place < len(self.meetings) and name in self.meetings[self.place].partners

    def begin(self) -> None:
        """A new instant: what is past of the last one is no longer repeated."""
        self.past, self.spare = {}, Counter()

    def matched(self, name: str, event: int) -> None:
        """Notes that a partner was matched in an event."""
        self.spare += self.coming
        self.coming = Counter()
        self.past[name] = event


def walk(
    mine: Sequence[PartnersMet],
    theirs: Sequence[PartnersMet],
    my_times: Sequence[float],
    their_times: Sequence[float],
    step: float = 0.0,
    patience: Patience | None = None,
) -> Walk:
    """Matches partners in order; those of one instant in any order, and over several instants.

    With a time step, the rounds of one instant may come in any number of steps, or all in one: a partner that the
    last instant of one run has is not missed where the other has it again, as often as that instant has it, or
    within two steps.

    >>> walk([PartnersMet(0, ("j", "k"))], [PartnersMet(0, ("k",)), PartnersMet(1, ("j",))], [1.0], [1.0, 1.0]).split
    {0: {0, 1}}
    >>> walk([PartnersMet(0, ("j",))], [PartnersMet(0, ("k",))], [1.0], [1.0]).mismatch
    Mismatch(mine=0, expected='j', theirs=0, got='k', final=True)
    """
    walked = Walk()
    ours, other = _Side(mine, my_times, step > 0), _Side(theirs, their_times, step > 0)
    while True:
        ours.fill()
        other.fill()
        if step and _absorbed(walked, ours, other, step):
            continue
        if not ours.open or not other.open:
            if ours.open:
                walked.mismatch = Mismatch(ours.open[0][1], ours.open[0][0], None, None)
            elif other.open:
                walked.mismatch = Mismatch(None, None, other.open[0][1], other.open[0][0], left=_names(other))
            break
        late = None if patience is None else _late(ours, other, patience)
        if late is not None:
            walked.mismatch = late
            break
        _cancel(walked, ours, other)
        if ours.open and other.open and not (step and _again(ours, other, step)):
            (expected, m), (got, c) = ours.open[0], other.open[0]
            walked.mismatch = Mismatch(m, expected, c, got, True, _names(other))
            break
    _group(walked)
    return walked


def _names(side: _Side) -> tuple[str, ...]:
    return tuple(name for name, _ in side.open)


def _late(ours: _Side, other: _Side, patience: Patience) -> Mismatch | None:
    """A meeting that one run has long before the other has its next: the other does not have it."""
    (expected, m), (got, c) = ours.open[0], other.open[0]
    if other.times[c] > patience.latest(ours.times[m]):
        return Mismatch(m, expected, None, None, final=True)
    if ours.times[m] > patience.latest(other.times[c]):
        return Mismatch(None, None, c, got, True, _names(other))
    return None


def _again(ours: _Side, other: _Side, step: float) -> bool:
    """Whether the next partner of either run is one that the last instant of the other has again."""
    return _repeats(ours, other, step) or _repeats(other, ours, step)


def _repeats(side: _Side, other: _Side, step: float) -> bool:
    """Whether a side's next partner is part of the instant that the other has just taken up.

    Where the other's next instant has that partner too, it belongs to the one that is nearer in time, if the side is as
    late as it was at the last. But where the side's two are more than a step apart, it then has another partner, and
    the other's two are near each other, they are the same two: places may be off by many steps.
    """
    if not side.open or not side.past or not other.past:
        return False
    name, event = side.open[0]
    if name not in side.past or name not in other.past:
        return False
    lag = side.times[event] - side.times[side.past[name]]
    if lag > 2 * step and (other.spare[name] <= 0 or lag > REPEATED * step):
        return False
    rival = next((e for n, e in other.open if n == name), None)
    if rival is None:
        return True
    apart = other.times[rival] - other.times[other.past[name]]
    if lag > step and len(side.open) == 1 and apart <= REPEATED * step and not side.has_next(name):
        return False
    return abs(lag) < abs(other.times[other.past[name]] + lag - other.times[rival])


def _absorbed(walked: Walk, ours: _Side, other: _Side, step: float) -> bool:
    """Counts a repeated contact of one run as part of the other's last instant; whether there was one."""
    if _repeats(other, ours, step):
        name, event = other.open.pop(0)
        walked.pairs.append((ours.past[name], event))
        ours.spare[name] -= 1
        other.past[name] = event
        return True
    if _repeats(ours, other, step):
        name, event = ours.open.pop(0)
        walked.pairs.append((event, other.past[name]))
        other.spare[name] -= 1
        ours.past[name] = event
        return True
    return False


def _cancel(walked: Walk, ours: _Side, other: _Side) -> None:
    """Removes the partners that both have, and records who was matched with whom."""
    if len(ours.open) == 1 == len(other.open):  # nearly always
        (name, m), (got, c) = ours.open[0], other.open[0]
        if name == got:
            _match(walked, ours, other, name, m, c)
            ours.open, other.open = [], []
        return
    expected, got_names = [name for name, _ in ours.open], [name for name, _ in other.open]
    if expected != got_names and sorted(expected) == sorted(got_names):
        walked.reordered.setdefault(ours.open[0][1], set()).add(other.open[0][1])
    left: list[tuple[str, int]] = []
    for name, c in other.open:
        place = next((p for p, (mine, _) in enumerate(ours.open) if mine == name), None)
        if place is None:
            left.append((name, c))
            continue
        _match(walked, ours, other, name, ours.open.pop(place)[1], c)
    other.open = left


def _match(walked: Walk, ours: _Side, other: _Side, name: str, mine: int, theirs: int) -> None:
    walked.pairs.append((mine, theirs))
    if mine not in ours.past.values() and theirs not in other.past.values():
        ours.begin()
        other.begin()
    ours.matched(name, mine)
    other.matched(name, theirs)


def _group(walked: Walk) -> None:
    """Notes the events that were matched with several events of the other run.

    The pairs of one event follow each other, so that one look back suffices.
    """
    for (mine, theirs), (next_mine, next_theirs) in pairwise(walked.pairs):
        if mine == next_mine and theirs != next_theirs:
            walked.split.setdefault(mine, set()).update((theirs, next_theirs))
        if theirs == next_theirs and mine != next_mine:
            walked.merged.setdefault(theirs, set()).update((mine, next_mine))
