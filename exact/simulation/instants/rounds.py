"""Several contacts at one instant: which hang together, and the rounds of impulses until none approaches."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from ....scenarios.lazy import frozen
from ...numbers.undecided import BudgetSpent
from ...policies.complementarity import Ask
from ...policies.policy import Policy
from ...predicates.hits import Closing
from ...replay.contact import Touch, scene_order
from ...replay.steps import Kick


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


@frozen
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


@frozen
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


def settle(
    links: Sequence[Touch],
    known: Mapping[Touch, int],
    policy: Policy,
    ask: Ask,
    do: Callable[[Kick], None],
    max_rounds: int,
) -> Rounds:
    """Rounds of impulses among touching contacts until none approaches.

    Args:
        links: the contacts, all at gap zero, in scene order.
        known: signs of closing speeds that are known as the instant comes: -1 where the two approach.
        policy: chooses the contacts of each round.
        ask: decides signs on the state as it is.
        do: applies impulses to the state.
        max_rounds: raises BudgetSpent beyond.
    """
    signs: dict[Touch, int | None] = {link: known.get(link) for link in links}
    impulses: list[Touch] = []
    taking_part: set[Touch] = set()
    rounds = 0
    while True:
        told = {link: ask(Closing(link)) if sign is None else sign for link, sign in signs.items()}
        coming = [link for link in links if told[link] < 0]
        if not coming:
            return Rounds(tuple(impulses), frozenset(taking_part), told)
        if rounds == max_rounds:
            raise BudgetSpent(f"{max_rounds} rounds of impulses at one instant")
        rounds += 1
        taking_part.update(coming)
        chosen = policy.choose(coming, ask)
        among = chosen if policy.chooses_order else tuple(coming)
        do(Kick(chosen, among))
        impulses += chosen
        hit = {i for link in chosen for i in link.circles}
        parted = set(among)
        signs = {link: 1 if link in parted else told[link] if hit.isdisjoint(link.circles) else None for link in links}
