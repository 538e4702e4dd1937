"""All approaching contacts at once, in rounds."""

from __future__ import annotations

from collections.abc import Sequence

from ..replay.contact import Touch
from .complementarity import Ask, pushing_contacts
from .policy import Policy


class Simultaneous(Policy):
    """In each round all contacts that approach get their impulses together.

    The impulses are the least that make every one of them separate at least as fast as it approached
    (`complementarity`). Symmetric scenes stay symmetric, and no order is chosen.
    """

    chooses_order = False

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """Those of the approaching contacts that push."""
        return pushing_contacts(approaching, ask)
