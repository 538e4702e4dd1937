"""Every outcome that some sequential order of simultaneous impulses leads to, as a tree."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol, runtime_checkable

from ...exact.exact_motion import ExactValue
from ...exact.numbers.system import BudgetSpent, Undecided
from ...exact.replay.contact import Touch, contact_of
from ...exact.simulation.policies import Ask, Policy, Sequential
from ...scenarios.errors import SceneError, TimeIsUp
from ...scenarios.numbers.quantity import QuantityLike, Real
from ...scenarios.scene import Scene
from ...scenarios.trajectory import Contact, OnProgress, Progress, Stop, StopReason, Trajectory
from ..deadline import Clock, time_limit, uninterrupted


class Choice(NamedTuple):
    """One choice: at which instant (of those with several impulses), among which contacts, which was taken.

    `asleep` are those that were not to be taken; `rounds`, how many had begun by then.
    """

    instant: int
    offered: tuple[Touch, ...]
    chosen: Touch
    asleep: frozenset[Touch]
    rounds: int


class Branch(NamedTuple):
    """A branch to be followed: its script, the contacts asleep at the end of that, and the signs known until there.

    They are those of the first `known` rounds of the branch that it leaves: up to its last choice both are the same.
    """

    script: tuple[Touch, ...] = ()
    asleep: frozenset[Touch] = frozenset()
    rounds: Sequence[dict[Touch, int]] = ()
    known: int = 0


MOST_CHOICES = 1_000
"""Choices at one instant after which an order is given up: where energy is lost, an order may have no end."""


def _in_bounds(choices: int) -> None:
    if choices >= MOST_CHOICES:
        raise BudgetSpent(f"an order of impulses at one instant with over {MOST_CHOICES} choices; it may have no end")


class BranchDone(Exception):
    """This branch repeats one that has been followed: nothing new comes of it."""


class Scripted(Policy):
    """Follows `script`, then takes the first contact that is not asleep; remembers what it could have chosen.

    Two contacts without a common circle of finite mass may come in either order without any difference. So of all
    orders that differ by that only one is followed, by sleep sets (Godefroid, *Partial-Order Methods for the
    Verification of Concurrent Systems*, LNCS 1032, 1996): a contact whose branch has been followed is asleep
    until one that it depends on is kicked.

    Where, besides, the state after an instant is exactly one that another branch has reached from the same
    beginning, the branch is merged into that one: the same future follows.

    Args:
        branch: the contacts to kick where there is a choice, in order; at the last of these choices, the contacts whose
            branches have been followed, and the sleepers; what is known of the rounds until there.
        movers: for each circle, whether its mass is finite.
        seen: the states reached by all branches so far, shared among them.
    """

    chooses_order = True
    repeats = True
    """An order that goes on as it came has no end; what else it could have gone on with, other branches do."""

    def __init__(
        self,
        branch: Branch,
        movers: Sequence[bool],
        seen: dict[Hashable, int],
    ) -> None:
        self.script, self.asleep, self._told, self._known = branch
        self.rounds: list[dict[Touch, int]] = []
        self.movers = movers
        self.seen = seen
        self.node = 0
        self.instant = 0
        self.choices: list[Choice] = []
        self._before = 0

    def signs(self, ask: Callable[[], dict[Touch, int]]) -> dict[Touch, int]:
        """Asked but for the rounds that are those of another branch: signs follow from the scene and the script."""
        k = len(self.rounds)
        self.rounds.append(self._told[k] if k < self._known else ask())
        return self.rounds[k]

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """One contact.

        Raises:
            BranchDone: if all of them are asleep.
            BudgetSpent: after `MOST_CHOICES` at one instant.
        """
        place = len(self.choices)
        last = len(self.script) - 1
        if len(approaching) == 1:
            chosen = approaching[0]
            if place > last:
                if chosen in self.asleep:
                    raise BranchDone("asleep")
                self.asleep = self._still_asleep(chosen)
            return (chosen,)
        _in_bounds(place - self._before)
        if place <= last:
            chosen = self.script[place]
            self.choices.append(Choice(self.instant, tuple(approaching), chosen, frozenset(), len(self.rounds)))
            if place == last:
                self.asleep = self._still_asleep(chosen)
            return (chosen,)
        awake = [link for link in approaching if link not in self.asleep]
        if not awake:
            raise BranchDone("asleep")
        self.choices.append(Choice(self.instant, tuple(approaching), awake[0], self.asleep, len(self.rounds)))
        self.asleep = self._still_asleep(awake[0])
        return (awake[0],)

    def instant_done(self, state: Callable[[], Hashable | None]) -> None:
        """Merges the branch into another of the same state; no sleep outlasts its instant.

        Raises:
            BranchDone: if another branch has reached the state.
        """
        self.instant += 1
        made = tuple(choice.chosen for choice in self.choices[self._before :])
        self._before = len(self.choices)
        if not made:
            return
        exact = state()
        key = (self.node, self.instant, made if exact is None else exact)
        # The script's last choice is one that no branch had taken there.
        new = len(self.choices) >= len(self.script)
        if key in self.seen and new and exact is not None:
            raise BranchDone("merged")
        self.node = self.seen.setdefault(key, len(self.seen) + 1)
        if len(self.choices) >= len(self.script):
            self.asleep = frozenset()

    def _still_asleep(self, chosen: Touch) -> frozenset[Touch]:
        """The sleepers that do not depend on the contact kicked."""
        mine = {i for i in chosen.circles if self.movers[i]}
        return frozenset(link for link in self.asleep if link != chosen and mine.isdisjoint(link.circles))


class DrawnOrder(Sequential):
    """An order drawn from a seed, given up after `MOST_CHOICES` at one instant."""

    _choices = 0

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """One contact.

        Raises:
            BudgetSpent: after `MOST_CHOICES` at one instant.
        """
        if len(approaching) > 1:
            _in_bounds(self._choices)
            self._choices += 1
        return super().choose(approaching, ask)

    def instant_done(self, state: Callable[[], Hashable | None]) -> None:
        """Counts anew."""
        self._choices = 0


# ----------------------------------------
# Every outcome that the physics permits: all sequential orders of simultaneous impulses, as a tree.

DEFAULT_CAP = 256
"""Orders followed to their end before enumeration gives way to a sample."""

EQUAL_BITS = 1024
"""Bits to which two numbers are told apart; where they agree so far, only their normal forms prove them equal."""

DEFAULT_SAMPLES = 64
"""Orders drawn at random once the cap is hit."""


@runtime_checkable
class Runner(Protocol):
    """An event-driven engine that takes a policy from its caller."""

    def run_with(
        self,
        scene: Scene,
        policy: Policy | None,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """As `Engine.run`, under `policy`."""
        ...


class Branching(NamedTuple):
    """One branching: at the nth instant of several impulses, the contacts that could be first, and which was."""

    instant: int
    offered: tuple[Contact, ...]
    chosen: Contact


@dataclass(frozen=True)
class Leaf:
    """One leaf of the tree: the decisions that lead to it, and the history that follows.

    Attributes:
        decisions: in order; empty for a sampled outcome.
        trajectory: the whole run.
        seed: for a sampled outcome, the seed of `sequential:seed=N` that gives it; else None.
    """

    decisions: tuple[Branching, ...]
    trajectory: Trajectory
    seed: int | None = None


@dataclass(frozen=True)
class OrderTree:
    """The outcomes of all sequential orders.

    Attributes:
        outcomes: the distinct ones found, enumerated first, then sampled.
        complete: whether these are all of them; if not, the cap was hit.
        cap: the most orders that are followed to their end.
        merged: branches that came to a state which another had reached, on the way or at the end.
        unproved: those of them of which that is not proved: their numbers agree to `EQUAL_BITS`. There may be as many
            outcomes more.
        reordered: branches left out because they only swap contacts that share no circle.
        sampled: orders drawn at random beyond the cap.
    """

    outcomes: tuple[Leaf, ...]
    complete: bool
    cap: int
    merged: int
    reordered: int
    sampled: int
    unproved: int = 0


class _Ends:
    """The states in which histories end, told apart.

    Attributes:
        unproved: histories taken for repeated whose end is not proved to be equal to the other's.
    """

    def __init__(self) -> None:
        self._known: dict[Hashable, list[tuple[list[Real], list[tuple[float, float]]]]] = {}
        self._texts: dict[int, tuple[ExactValue, str | None]] = {}
        self.unproved = 0

    def _text(self, value: ExactValue) -> str | None:
        """A number in nested roots, written once: it takes a replay of what led to it."""
        if id(value) not in self._texts:
            self._texts[id(value)] = value, value.text()
        return self._texts[id(value)][1]

    def repeated(self, run: Trajectory) -> bool:
        """Whether a history has ended in this very state, at this very time; takes note of it."""
        if run.stop.reason not in (StopReason.QUIET, StopReason.EVENTS, StopReason.HORIZON):
            return False
        circles = run.final.circles
        values: list[Real] = [run.final_time, *(v for c in circles for v in (c.x, c.y, c.vx, c.vy))]
        bounds = [_bounds(value) for value in values]
        alike = self._known.setdefault((run.stop.reason, tuple(c.id for c in circles)), [])
        for others, their_bounds in alike:
            if any(a > d or c > b for (a, b), (c, d) in zip(bounds, their_bounds, strict=True)):
                continue
            same = [equality(one, other, self._text) for one, other in zip(values, others, strict=True)]
            if False not in same:
                self.unproved += None in same
                return True
        alike.append((values, bounds))
        return False


def _bounds(value: Real) -> tuple[float, float]:
    return value.bounds() if isinstance(value, ExactValue) else (float(value), float(value))


def equality(one: Real, other: Real, texts: Callable[[ExactValue], str | None] = ExactValue.text) -> bool | None:
    """Whether two numbers are equal; None if that is not proved.

    Args:
        texts: writes a number in nested roots; None if it is too deep.
    """
    if not isinstance(one, ExactValue) or not isinstance(other, ExactValue):
        return float(one) == float(other)
    try:
        if not one.ball(EQUAL_BITS).overlaps(other.ball(EQUAL_BITS)):
            return False
        told = texts(one)
        if told is not None and told == texts(other):
            return True
    except Undecided:
        pass
    return None


def all_orders(
    engine: Runner,
    scene: Scene,
    *,
    until: QuantityLike | None = None,
    events: int | None = None,
    cap: int = DEFAULT_CAP,
    samples: int = DEFAULT_SAMPLES,
    seed: int = 0,
    progress: OnProgress | None = None,
    ends: bool = True,
) -> OrderTree:
    """Follows every sequential order of the impulses at every instant, depth first.

    Orders that differ by swapping contacts without a common circle are one; branches that reach a state which
    another has reached are merged where the states are equal exactly, those too that come to their end in it.

    Args:
        cap: the most orders to follow to their end; beyond, `samples` are drawn, of seeds `seed`, `seed + 1`, ...
        ends: whether histories that end in one state are one outcome; else each that differs in its impulses is.

    Raises:
        SceneError: for a cap, or a number of samples, that cannot be.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle
    >>> lee = Scene([Circle(-3, 0, 1, 1, 0), Circle(0, 0, 1), Circle(4, 0, 2, -1, 0, m=4)])
    >>> tree = all_orders(ExactEngine(), lee)
    >>> [[c.vx.text() for c in o.trajectory.final.circles] for o in tree.outcomes]
    [['-11/5', '-8/25', '-3/25'], ['-8/5', '-39/25', '1/25']]
    """
    if isinstance(cap, bool) or not isinstance(cap, int) or cap < 1:
        raise SceneError(f"cap = {cap!r}: must be a whole number from 1")
    if isinstance(samples, bool) or not isinstance(samples, int) or samples < 0:
        raise SceneError(f"samples = {samples!r}: must be a whole number from 0")
    movers = [not circle.fixed for circle in scene.surfaces.circles]
    seen: dict[Hashable, int] = {}
    outcomes: list[Leaf] = []
    known = _Ends()
    merged = reordered = followed = 0
    stack = [Branch()]
    while stack and followed < cap:
        policy = Scripted(stack.pop(), movers, seen)
        try:
            trajectory = engine.run_with(scene, policy, until=until, events=events)
            followed += 1
            if ends and known.repeated(trajectory):
                merged += 1
            else:
                outcomes.append(Leaf(_decisions(scene, policy.choices), trajectory))
        except BranchDone as done:
            merged += done.args[0] == "merged"
            reordered += done.args[0] == "asleep"
        stack += _alternatives(policy)
        if progress is not None:
            progress(Progress(len(outcomes), 0.0, f"{len(stack)} branches open"))
    sampled = 0
    if stack:
        had = {_impulses(outcome.trajectory) for outcome in outcomes}
        for drawn in range(seed, seed + samples):
            trajectory = engine.run_with(scene, DrawnOrder(drawn), until=until, events=events)
            sampled += 1
            if _impulses(trajectory) not in had and not (ends and known.repeated(trajectory)):
                had.add(_impulses(trajectory))
                outcomes.append(Leaf((), trajectory, drawn))
            if progress is not None:
                progress(Progress(len(outcomes), 0.0, f"{sampled} of {samples} orders drawn"))
    return OrderTree(tuple(outcomes), not stack, cap, merged, reordered, sampled, known.unproved)


def _alternatives(policy: Scripted) -> list[Branch]:
    """The branches not taken at the choices after the script, each with the contacts asleep at it.

    The last choice comes last, so that the stack goes depth first; at one choice, contacts in scene order.
    """
    branches: list[Branch] = []
    choices = policy.choices
    for place in range(len(policy.script), len(choices)):
        choice = choices[place]
        before = tuple(earlier.chosen for earlier in choices[:place])
        asleep = set(choice.asleep) | {choice.chosen}
        siblings: list[Branch] = []
        for other in choice.offered:
            if other not in asleep:
                siblings.append(Branch((*before, other), frozenset(asleep), policy.rounds, choice.rounds))
                asleep.add(other)
        branches += siblings[::-1]
    return branches


def _decisions(scene: Scene, choices: list[Choice]) -> tuple[Branching, ...]:
    return tuple(
        Branching(
            choice.instant,
            tuple(contact_of(scene.surfaces, link) for link in choice.offered),
            contact_of(scene.surfaces, choice.chosen),
        )
        for choice in choices
    )


def _impulses(trajectory: Trajectory) -> tuple[tuple[Contact, ...], ...]:
    return tuple(event.impulses for event in trajectory.events)


# ----------------------------------------
# Follows all orders of impulses as `all_orders` does, and ends when the user's seconds are over, or at Ctrl-C.


@dataclass(frozen=True)
class Search:
    """What came of following the orders.

    Attributes:
        tree: the outcomes, every one of them whole.
        stop: why more were not looked for, if it was the time.
    """

    tree: OrderTree
    stop: Stop | None = None


class Attended:
    """An engine for `all_orders`, whose runs are taken for outcomes only if they went to their own end.

    Once the seconds are over, so many runs were made, or so many signs were proved in nested roots, it has no more
    outcomes: a branch ends at once, and a draw repeats what is known. A branch that is given up counts as many signs as
    the run before it.

    Attributes:
        cut: whether that has happened.
        drawn: how many orders were drawn at random before.
    """

    def __init__(
        self, engine: Runner, watch: Clock | None = None, runs: int | None = None, signs: int | None = None
    ) -> None:
        self._engine = engine
        self._left, self._signs = runs, signs
        self._watch = Clock(None) if watch is None else watch
        self._last: Trajectory | None = None
        self.cut = False
        self.drawn = 0

    def run_with(
        self,
        scene: Scene,
        policy: Policy | None,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """As the engine's own.

        Raises:
            KeyboardInterrupt: if the user interrupts the run.
        """
        if not self._watch.over and self._left != 0 and (self._signs is None or self._signs > 0):
            self._left = None if self._left is None else self._left - 1
            watched = self._watch.watched(progress)
            try:
                run = uninterrupted(self._engine.run_with(scene, policy, until=until, events=events, progress=watched))
            except TimeIsUp:  # before the run has begun, say; what was found before stays
                run = None
            except BranchDone:
                self._charge(self._last)
                raise
            self._charge(run)
            if run is not None and not (run.stop.reason is StopReason.BUDGET and self._watch.over):
                self._last = run
                self.drawn += not isinstance(policy, Scripted)
                return run
        self.cut = True
        if isinstance(policy, Scripted) or self._last is None:
            raise BranchDone("out of time")
        return self._last

    def _charge(self, run: Trajectory | None) -> None:
        """Counts the signs that a run has proved in nested roots."""
        if self._signs is not None and run is not None:
            self._signs -= int(run.plan.get("tower", 0))


def search_orders(
    engine: Runner,
    scene: Scene,
    *,
    until: QuantityLike | None = None,
    events: int | None = None,
    cap: int = DEFAULT_CAP,
    samples: int = DEFAULT_SAMPLES,
    seed: int = 0,
    max_seconds: float | None = None,
    progress: OnProgress | None = None,
) -> Search:
    """`all_orders`, and what it has found if the seconds are over before.

    Raises:
        SceneError: as `all_orders`, and for seconds that are not above zero.
        KeyboardInterrupt: if the user interrupts it.
    """
    with time_limit(max_seconds) as watch:
        attended = Attended(engine, watch)
        tree = all_orders(
            attended, scene, until=until, events=events, cap=cap, samples=samples, seed=seed, progress=progress
        )
    if not attended.cut:
        return Search(tree)
    reason = StopReason.BUDGET
    return Search(
        replace(tree, complete=False, sampled=attended.drawn), Stop(reason, f"{reason.value}: {watch.is_up()}")
    )
