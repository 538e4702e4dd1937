"""The contract of a tie policy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from ..complementarity import Ask
from ..machine import Link


class Policy(Protocol):
    """Chooses, round by round, which approaching contacts are kicked together."""

    def choose(self, approaching: Sequence[Link], ask: Ask) -> tuple[Link, ...]:
        """The contacts, at least one, that get their impulses now.

        Args:
            approaching: the contacts at this instant that approach, in scene order; at least one.
            ask: decides the sign of a question about the state.
        """
        ...
