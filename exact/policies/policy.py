"""The contract of a tie policy."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import Protocol

from ..replay.contact import Touch
from .complementarity import Ask


class Policy(Protocol):
    """Chooses, round by round, which approaching contacts are kicked together.

    Attributes:
        chooses_order: whether it picks some contacts before others, so that symmetric scenes need not stay symmetric.
    """

    chooses_order: bool

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
