"""What the map says of one engine at one place."""

from __future__ import annotations

from enum import Enum


class Mark(Enum):
    """One of these for each engine at each place; only `RIGHT` counts as right, and only `WRONG` as wrong."""

    RIGHT = "right"
    WRONG = "wrong"
    UNSETTLED = "unsettled"
    UNDECIDED = "undecided"
    REFUSED = "refused"
    FAILED = "failed"
    UNCHECKED = "unchecked"

    @property
    def sign(self) -> str:
        """As one letter.

        >>> "".join(mark.sign for mark in Mark)
        '.X~?-#!'
        """
        return SIGNS[self][0]

    @property
    def meaning(self) -> str:
        """In words."""
        return SIGNS[self][1]


SIGNS = {
    Mark.RIGHT: (".", "right: the certified history, every meeting of it, and its outcomes"),
    Mark.WRONG: ("X", "wrong: another history, or an outcome changed"),
    Mark.UNSETTLED: ("~", "not settled: the runs at hand do not tell"),
    Mark.UNDECIDED: ("?", "undecided: it stopped, not knowing, or its counted steps were spent"),
    Mark.REFUSED: ("-", "refused: it does not take the scene"),
    Mark.FAILED: ("#", "failed: it ended with an error of its own, and no answer"),
    Mark.UNCHECKED: ("!", "unchecked: decided, but the independent checker does not tell"),
}
