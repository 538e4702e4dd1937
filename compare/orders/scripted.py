"""One approaching contact at a time, chosen by a script: the branches of all sequential orders."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import NamedTuple

from ...exact.replay.contact import Touch
from ...exact.simulation.policies import Ask, Policy


class Choice(NamedTuple):
    """One choice: at which instant (of those with several impulses), among which contacts, which was taken.

    `asleep` are those that were not to be taken.
    """

    instant: int
    offered: tuple[Touch, ...]
    chosen: Touch
    asleep: frozenset[Touch]


class BranchDone(Exception):
    """This branch repeats one that has been followed: nothing new comes of it."""


class Scripted(Policy):
    """Follows `script`, then takes the first contact that is not asleep; remembers what it could have chosen.

    Two contacts without a common circle of finite mass may be swapped without any difference. So of all orders
    that differ by such swaps only one is followed, by sleep sets (Godefroid, *Partial-Order Methods for the
    Verification of Concurrent Systems*, LNCS 1032, 1996): a contact whose branch has been followed is asleep
    until one that it depends on is kicked.

    Where, besides, the state after an instant is exactly one that another branch has reached from the same
    beginning, the branch is merged into that one: the same future follows.

    Args:
        script: the contacts to kick where there is a choice, in order.
        asleep: at the script's last choice, the contacts whose branches have been followed, and the sleepers.
        movers: for each circle, whether its mass is finite.
        seen: the states reached by all branches so far, shared among them.
    """

    chooses_order = True

    def __init__(
        self,
        script: Sequence[Touch],
        asleep: frozenset[Touch],
        movers: Sequence[bool],
        seen: dict[Hashable, int],
    ) -> None:
        self.script = tuple(script)
        self.asleep = asleep
        self.movers = movers
        self.seen = seen
        self.node = 0
        self.instant = 0
        self.choices: list[Choice] = []
        self._before = 0

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """One contact.

        Raises:
            BranchDone: if all of them are asleep.
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
        if place <= last:
            chosen = self.script[place]
            self.choices.append(Choice(self.instant, tuple(approaching), chosen, frozenset()))
            if place == last:
                self.asleep = self._still_asleep(chosen)
            return (chosen,)
        awake = [link for link in approaching if link not in self.asleep]
        if not awake:
            raise BranchDone("asleep")
        self.choices.append(Choice(self.instant, tuple(approaching), awake[0], self.asleep))
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
