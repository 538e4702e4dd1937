"""One approaching contact at a time, in scene order or in an order drawn from a seed."""

from __future__ import annotations

import random
from collections.abc import Sequence

from ..replay.contact import Touch
from .complementarity import Ask
from .policy import Policy


class Sequential(Policy):
    """Kicks one approaching contact, then looks at all touching contacts again.

    Args:
        seed: None takes the first in scene order each time; a number draws one, each equally likely, from
            Python's Mersenne Twister started with it. Nothing is drawn where only one approaches.
    """

    chooses_order = True

    def __init__(self, seed: int | None = None) -> None:
        self._random = None if seed is None else random.Random(seed)

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """One contact."""
        if self._random is None or len(approaching) == 1:
            return (approaching[0],)
        return (approaching[self._random.randrange(len(approaching))],)
