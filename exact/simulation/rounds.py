"""Several contacts at one instant: which hang together, and the rounds of impulses until none approaches."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from ..numbers.undecided import BudgetSpent
from ..policies.complementarity import Ask
from ..policies.policy import Policy
from ..predicates.hits import Closing
from ..replay.steps import Kick, Link


class Touching:
    """The contacts that last: two circles at gap zero that move together, or a circle sliding along a wall."""

    def __init__(self, n: int) -> None:
        self.n = n
        self._links: frozenset[Link] = frozenset()

    def __bool__(self) -> bool:
        return bool(self._links)

    def add(self, link: Link) -> None:
        """A contact that lasts."""
        self._links |= {link}

    def discard(self, link: Link) -> None:
        """A contact that ends."""
        self._links -= {link}

    def all(self) -> frozenset[Link]:
        """Every lasting contact."""
        return self._links


@dataclass(frozen=True)
class Component:
    """Contacts that hang together through shared circles of finite or infinite mass, and those circles."""

    bodies: tuple[int, ...]
    links: tuple[Link, ...]


def components(links: Sequence[Link], touching: Touching, n: int) -> list[Component]:
    """The contacts of an instant with the lasting contacts that they reach, split where no circle is shared.

    In scene order of their first circle.

    >>> components([(0, 1), (4, 5)], Touching(9), 9)
    [Component(bodies=(0, 1), links=((0, 1),)), Component(bodies=(4, 5), links=((4, 5),))]
    """
    pending = set(links) | set(touching.all())
    found: list[Component] = []
    for start in sorted(links):
        if start not in pending:
            continue
        bodies = {i for i in start if i < n}
        mine: set[Link] = set()
        grown = True
        while grown:
            reached = {link for link in pending if any(i in bodies for i in link if i < n)}
            grown = bool(reached)
            mine |= reached
            pending -= reached
            bodies |= {i for link in reached for i in link if i < n}
        found.append(Component(tuple(sorted(bodies)), tuple(sorted(mine))))
    return found


@dataclass(frozen=True)
class Rounds:
    """The outcome of the rounds in one component.

    Attributes:
        impulses: the contacts kicked, in the order applied.
        taking_part: the contacts that approached, as the instant came or in its rounds.
        signs: for each contact, 0 if it neither approaches nor parts at the end, else +1.
    """

    impulses: tuple[Link, ...]
    taking_part: frozenset[Link]
    signs: dict[Link, int]


def settle(
    links: Sequence[Link],
    known: Mapping[Link, int],
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
    signs: dict[Link, int | None] = {link: known.get(link) for link in links}
    impulses: list[Link] = []
    taking_part: set[Link] = set()
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
        hit = {i for link in chosen for i in link}
        parted = set(among)
        signs = {link: 1 if link in parted else (None if hit & set(link) else told[link]) for link in links}
