"""Several contacts at one instant: which hang together, and the rounds of impulses until none approaches."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from .complementarity import Ask
from .machine import Link
from .policies.policy import Policy
from .questions import Closing
from .undecided import BudgetSpent


class Touching:
    """The contacts that last: two circles at gap zero that move together, or a circle sliding along a wall."""

    def __init__(self, n: int) -> None:
        self.n = n
        self._links: set[Link] = set()

    def __bool__(self) -> bool:
        return bool(self._links)

    def add(self, link: Link) -> None:
        """A contact that lasts."""
        self._links.add(link)

    def add_all(self, links: Iterable[Link]) -> None:
        """Contacts that last until the instant at hand is done."""
        self._links.update(links)

    def discard(self, link: Link) -> None:
        """A contact that ends."""
        self._links.discard(link)

    def all(self) -> frozenset[Link]:
        """Every lasting contact."""
        return frozenset(self._links)


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
class Instant:
    """The outcome of the rounds in one component.

    Attributes:
        impulses: the contacts kicked, in the order applied.
        taking_part: the contacts that approached, as the instant came or in its rounds.
        signs: for each contact, 0 if it neither approaches nor parts at the end, else +1.
        rounds: how many rounds it took.
    """

    impulses: tuple[Link, ...]
    taking_part: frozenset[Link]
    signs: dict[Link, int]
    rounds: int


def settle_contacts(
    links: Sequence[Link],
    approaching: frozenset[Link],
    policy: Policy,
    ask: Ask,
    kick: Callable[[tuple[Link, ...]], None],
    max_rounds: int,
    order_chosen: Callable[[], None],
) -> Instant:
    """Rounds of impulses among touching contacts until none approaches.

    Args:
        links: the contacts, all at gap zero, in scene order.
        approaching: those known to approach already.
        policy: chooses the contacts of each round.
        ask: decides signs on the state as it is.
        kick: applies impulses to the state.
        max_rounds: raises BudgetSpent beyond.
        order_chosen: called before the policy's choice among several is carried out.
    """
    signs: dict[Link, int | None] = {link: -1 if link in approaching else None for link in links}
    impulses: list[Link] = []
    taking_part: set[Link] = set()
    rounds = 0
    while True:
        known = {link: ask(Closing(link)) if sign is None else sign for link, sign in signs.items()}
        coming = [link for link in links if known[link] < 0]
        if not coming:
            return Instant(tuple(impulses), frozenset(taking_part), known, rounds)
        if rounds == max_rounds:
            raise BudgetSpent(f"{max_rounds} rounds of impulses at one instant")
        rounds += 1
        taking_part.update(coming)
        chosen = policy.choose(coming, ask)
        if policy.chooses_order and len(coming) > 1:
            order_chosen()
        kick(chosen)
        impulses += chosen
        hit = {i for link in chosen for i in link}
        together = set(coming) if len(chosen) > 1 or chosen == tuple(coming) else set(chosen)
        signs = {link: 1 if link in together else (None if hit & set(link) else known[link]) for link in links}
