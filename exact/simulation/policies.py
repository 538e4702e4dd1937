"""Tie policies: which of several approaching contacts at one instant push, round by round until none approaches."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Protocol

from ...scenarios import settings
from ...scenarios.settings import TiePolicy
from ..numbers.system import BudgetSpent
from ..question import Closing, Coupling, Pivot, Question, Share, Slack, Strength
from ..replay.contact import Touch, scene_order
from ..replay.state import Kick

# -- Which of several approaching contacts push: the linear complementarity problem of one round, by criss-cross.
#
# The impulses s of a round obey 0 <= s, complementary to G s + 2 u >= 0: each contact separates at least as fast as
# it approached, and one that separates faster is not pushed (G and u as in `State.contact_system`). G is positive
# semidefinite, hence sufficient, so the least-index criss-cross method ends after finitely many exchanges whatever
# the degeneracy (Klafszky and Terlaky, Linear Algebra Appl. 1992; den Hertog, Roos, Terlaky, 1993), and the
# velocities that come out are unique though the impulses need not be.

Ask = Callable[[Question], int]

ENDLESS = "passes without end: rounded numbers contradict each other on which of {} contacts at one instant push"


def pushing_contacts(approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
    """Those of the approaching contacts that push, in the order given.

    Args:
        approaching: contacts at one instant, each of which approaches.
        ask: decides the sign of a question.

    Raises:
        BudgetSpent: if a set of contacts comes a second time, or none pushes, which no true signs lead to.
        whatever `ask` raises when a sign is not known.
    """
    if len(approaching) == 1:
        return tuple(approaching)
    basis: list[Touch] = []
    seen: set[tuple[Touch, ...]] = set()
    while tuple(basis) not in seen:
        seen.add(tuple(basis))
        pushing = []
        for link in approaching:
            if link in basis:
                sign = ask(Strength(tuple(basis), link))
                if sign > 0:
                    pushing.append(link)
            else:
                sign = ask(Slack(tuple(basis), link)) if basis else -1
            if sign < 0:
                _exchange(basis, link, approaching, ask)
                break
        else:
            if pushing:
                return tuple(pushing)
            break
    raise BudgetSpent(ENDLESS.format(len(approaching)))


def _exchange(basis: list[Touch], link: Touch, order: Sequence[Touch], ask: Ask) -> None:
    """One criss-cross exchange at the first infeasible contact; none where the signs leave none."""
    if link in basis:
        basis.remove(link)
        return
    if basis and ask(Pivot(tuple(basis), link)) == 0:
        sharing = (other for other in order if other in basis and ask(Share(tuple(basis), other, entering=link)) > 0)
        leaving = next(sharing, None)
        if leaving is None:
            return
        basis.remove(leaving)
    basis.append(link)
    basis.sort(key=order.index)


# -- The contract of a tie policy.


class Policy(Protocol):
    """Chooses, round by round, which approaching contacts are kicked together.

    Attributes:
        chooses_order: whether it picks some contacts before others, so that symmetric scenes need not stay symmetric.
        repeats: whether closing speeds alone, up to one factor, settle its choice, now as later.
    """

    chooses_order: bool
    repeats: bool = False

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """The contacts, at least one, that get their impulses now.

        Args:
            approaching: the contacts at this instant that approach, in scene order; at least one.
            ask: decides the sign of a question about the state.
        """
        ...

    def note(self, link: Touch) -> None:
        """Called when a contact was alone at its instant, so that nothing was to be chosen."""
        return

    def instant_done(self, state: Callable[[], Hashable | None]) -> None:
        """Called when an instant of several impulses is done.

        Args:
            state: gives the exact state of the circles that took part, or None where it is not at hand.
        """
        return


# -- All approaching contacts at once, in rounds.


class Simultaneous(Policy):
    """In each round all contacts that approach get their impulses together.

    The impulses are the least that make every one of them separate at least as fast as it approached
    (`complementarity`). Symmetric scenes stay symmetric, and no order is chosen.
    """

    chooses_order = False
    repeats = True

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """Those of the approaching contacts that push."""
        return pushing_contacts(approaching, ask)


# -- One approaching contact at a time, in scene order or in an order drawn from a seed.


class Sequential(Policy):
    """Kicks one approaching contact, then looks at all touching contacts again.

    Args:
        seed: None takes the first in scene order each time; a number draws one, each equally likely, from
            Python's Mersenne Twister started with it. Nothing is drawn where only one approaches.
    """

    chooses_order = True

    def __init__(self, seed: int | None = None) -> None:
        self.repeats = seed is None
        if seed is None:
            self._random = None
            return
        from random import Random

        self._random = Random(seed)

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """One contact."""
        if self._random is None or len(approaching) == 1:
            return (approaching[0],)
        return (approaching[self._random.randrange(len(approaching))],)


# -- The table of tie policies.


def policy_for(choice: TiePolicy) -> Policy:
    """A fresh policy, at the start of its random order if it has one."""
    module, _, name = settings.POLICIES[choice.name].partition(":")
    make = getattr(import_module(module, settings.__package__), name)
    return make() if choice.seed is None else make(choice.seed)


# -- Several contacts at one instant: which hang together, and the rounds of impulses until none approaches.


class Lasting:
    """The contacts that last: two circles at gap zero that move together, or a circle sliding along a wall."""

    def __init__(self) -> None:
        self._links: frozenset[Touch] = frozenset()

    def __bool__(self) -> bool:
        return bool(self._links)

    def add(self, link: Touch) -> None:
        """A contact that lasts."""
        self._links |= {link}

    def discard(self, link: Touch) -> None:
        """A contact that ends."""
        self._links -= {link}

    def all(self) -> frozenset[Touch]:
        """Every lasting contact."""
        return self._links


@dataclass(frozen=True, eq=False, repr=False)
class Component:
    """Contacts that hang together through shared circles of finite or infinite mass, and those circles."""

    bodies: tuple[int, ...]
    links: tuple[Touch, ...]


def components(links: Sequence[Touch], touching: Lasting) -> list[Component]:
    """The contacts of an instant with the lasting contacts that they reach, split where no circle is shared.

    In scene order of their first circle.

    >>> from truebreak.exact.replay.contact import Pair
    >>> [found.bodies for found in components([Pair(4, 5), Pair(0, 1), Pair(1, 2)], Lasting())]
    [(0, 1, 2), (4, 5)]
    """
    pending = set(links) | set(touching.all())
    found: list[Component] = []
    for first in sorted(links, key=scene_order):
        if first not in pending:
            continue
        bodies = set(first.circles)
        mine: set[Touch] = set()
        grown = True
        while grown:
            reached = {link for link in pending if not bodies.isdisjoint(link.circles)}
            grown = bool(reached)
            mine |= reached
            pending -= reached
            bodies |= {i for link in reached for i in link.circles}
        found.append(Component(tuple(sorted(bodies)), tuple(sorted(mine, key=scene_order))))
    return found


@dataclass(frozen=True, eq=False, repr=False)
class Rounds:
    """The outcome of the rounds in one component.

    Attributes:
        impulses: the contacts kicked, in the order applied.
        taking_part: the contacts that approached, as the instant came or in its rounds.
        signs: for each contact, 0 if it neither approaches nor parts at the end, else +1.
    """

    impulses: tuple[Touch, ...]
    taking_part: frozenset[Touch]
    signs: dict[Touch, int]


def _holds_back(parting: Touch, pushing: Touch, ask: Ask) -> bool:
    """Whether a push at one contact slows how another parts."""
    return not set(parting.circles).isdisjoint(pushing.circles) and ask(Coupling(parting, pushing)) < 0


def settle(
    links: Sequence[Touch],
    known: Mapping[Touch, int],
    policy: Policy,
    ask: Ask,
    do: Callable[[Kick], None],
    max_rounds: int,
    turn: Callable[[Touch, Touch], None] | None = None,
    again: Callable[[Sequence[Touch]], None] | None = None,
    closes: bool = False,
) -> Rounds:
    """Rounds of impulses among touching contacts until none approaches.

    Args:
        links: the contacts, all at gap zero, in scene order.
        known: signs of closing speeds that are known as the instant comes: -1 where the two approach.
        policy: chooses the contacts of each round.
        ask: decides signs on the state as it is.
        do: applies impulses to the state.
        max_rounds: raises BudgetSpent beyond.
        turn: called where one of two contacts approaches after a round, with that one first.
        again: called where the rounds come again and again, with the contacts that push in them: one contact approaches
            alone for the second time, and what else does not part neither approaches nor parts, both times. The closing
            speeds of those are one factor times what they were, and rounds are linear in them; those that part are
            only pushed further apart by what pushed meanwhile.
        closes: whether what has pushed neither approaches nor parts: its restitution is 0.
    """
    signs: dict[Touch, int | None] = {link: known.get(link) for link in links}
    impulses: list[Touch] = []
    taking_part: set[Touch] = set()
    rounds = 0
    alone: dict[tuple[Touch, frozenset[Touch]], int] = {}
    while True:
        told = {link: ask(Closing(link)) if sign is None else sign for link, sign in signs.items()}
        coming = [link for link in links if told[link] < 0]
        if not coming:
            return Rounds(tuple(impulses), frozenset(taking_part), told)
        if turn is not None and rounds and len(links) == 2 and len(coming) == 1:
            turn(coming[0], links[1] if coming[0] is links[0] else links[0])
        if again is not None and policy.repeats and len(coming) == 1:
            parting = frozenset(link for link in links if told[link] > 0)
            since = impulses[alone.setdefault((coming[0], parting), len(impulses)) :]
            if since and not any(_holds_back(one, other, ask) for one in parting for other in set(since)):
                again(since)
        if rounds == max_rounds:
            raise BudgetSpent(f"{max_rounds} passes of impulses at one instant")
        rounds += 1
        taking_part.update(coming)
        chosen = policy.choose(coming, ask)
        among = chosen if policy.chooses_order else tuple(coming)
        do(Kick(chosen, among))
        impulses += chosen
        hit = {i for link in chosen for i in link.circles}
        parted, after = (chosen, 0) if closes else (among, 1)
        apart = {link for link in links if hit.isdisjoint(link.circles)}
        signs = {link: after if link in parted else told[link] if link in apart else None for link in links}
