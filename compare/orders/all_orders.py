"""Every outcome that the physics permits: all sequential orders of simultaneous impulses, as a tree."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import NamedTuple, Protocol, runtime_checkable

from ...exact.exact_motion import ExactValue
from ...exact.numbers.system import Undecided
from ...exact.replay.contact import Touch, contact_of
from ...exact.simulation.policies import Policy, Sequential
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import QuantityLike, Real
from ...scenarios.scene import Scene
from ...scenarios.trajectory import Contact, OnProgress, Progress, StopReason, Trajectory
from .scripted import BranchDone, Choice, Scripted

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
        swapped: branches left out because they only swap contacts that share no circle.
        sampled: orders drawn at random beyond the cap.
    """

    outcomes: tuple[Leaf, ...]
    complete: bool
    cap: int
    merged: int
    swapped: int
    sampled: int
    unproved: int = 0


class _Ends:
    """The states in which histories end, told apart.

    Attributes:
        unproved: histories taken for repeated whose end is not proved to be equal to the other's.
    """

    def __init__(self) -> None:
        self._known: dict[Hashable, list[tuple[list[Real], list[tuple[float, float]]]]] = {}
        self.unproved = 0

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
            same = [equality(one, other) for one, other in zip(values, others, strict=True)]
            if False not in same:
                self.unproved += None in same
                return True
        alike.append((values, bounds))
        return False


def _bounds(value: Real) -> tuple[float, float]:
    return value.bounds() if isinstance(value, ExactValue) else (float(value), float(value))


def equality(one: Real, other: Real) -> bool | None:
    """Whether two numbers are equal; None if that is not proved."""
    if not isinstance(one, ExactValue) or not isinstance(other, ExactValue):
        return float(one) == float(other)
    try:
        if not one.ball(EQUAL_BITS).overlaps(other.ball(EQUAL_BITS)):
            return False
        if one.exact() is not None and other.exact() is not None and one.text() == other.text():
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
    movers = [not circle.fixed for circle in scene.circles]
    seen: dict[Hashable, int] = {}
    outcomes: list[Leaf] = []
    known = _Ends()
    merged = swapped = followed = 0
    stack: list[tuple[tuple[Touch, ...], frozenset[Touch]]] = [((), frozenset())]
    while stack and followed < cap:
        script, asleep = stack.pop()
        policy = Scripted(script, asleep, movers, seen)
        try:
            trajectory = engine.run_with(scene, policy, until=until, events=events)
            followed += 1
            if ends and known.repeated(trajectory):
                merged += 1
            else:
                outcomes.append(Leaf(_decisions(scene, policy.choices), trajectory))
        except BranchDone as done:
            merged += done.args[0] == "merged"
            swapped += done.args[0] == "asleep"
        stack += _alternatives(policy.choices, len(script))
        if progress is not None:
            progress(Progress(len(outcomes), 0.0, f"{len(stack)} branches open"))
    sampled = 0
    if stack:
        had = {_impulses(outcome.trajectory) for outcome in outcomes}
        for drawn in range(seed, seed + samples):
            trajectory = engine.run_with(scene, Sequential(drawn), until=until, events=events)
            sampled += 1
            if _impulses(trajectory) not in had and not (ends and known.repeated(trajectory)):
                had.add(_impulses(trajectory))
                outcomes.append(Leaf((), trajectory, drawn))
            if progress is not None:
                progress(Progress(len(outcomes), 0.0, f"{sampled} of {samples} orders drawn"))
    return OrderTree(tuple(outcomes), not stack, cap, merged, swapped, sampled, known.unproved)


def _alternatives(choices: list[Choice], followed: int) -> list[tuple[tuple[Touch, ...], frozenset[Touch]]]:
    """The branches not taken at the choices after the script, each with the contacts asleep at it.

    The last choice comes last, so that the stack goes depth first; at one choice, contacts in scene order.
    """
    branches: list[tuple[tuple[Touch, ...], frozenset[Touch]]] = []
    for place in range(followed, len(choices)):
        choice = choices[place]
        before = tuple(earlier.chosen for earlier in choices[:place])
        asleep = set(choice.asleep) | {choice.chosen}
        siblings = []
        for other in choice.offered:
            if other not in asleep:
                siblings.append(((*before, other), frozenset(asleep)))
                asleep.add(other)
        branches += siblings[::-1]
    return branches


def _decisions(scene: Scene, choices: list[Choice]) -> tuple[Branching, ...]:
    return tuple(
        Branching(
            choice.instant,
            tuple(contact_of(scene, link) for link in choice.offered),
            contact_of(scene, choice.chosen),
        )
        for choice in choices
    )


def _impulses(trajectory: Trajectory) -> tuple[tuple[Contact, ...], ...]:
    return tuple(event.impulses for event in trajectory.events)
