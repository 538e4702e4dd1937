"""What the map says of one engine at one place."""

from __future__ import annotations

from enum import Enum


class MapMark(Enum):
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

        >>> "".join(mark.sign for mark in MapMark)
        '.X~?-#!'
        """
        return SIGNS[self][0]

    @property
    def meaning(self) -> str:
        """In words."""
        return SIGNS[self][1]


SIGNS = {
    MapMark.RIGHT: (
        ".",
        "right: the certified history, every meeting of it, and its outcomes; no law known to be broken",
    ),
    MapMark.WRONG: ("X", "wrong: another history, an outcome changed, or a law not kept"),
    MapMark.UNSETTLED: ("~", "not settled: the runs at hand do not tell"),
    MapMark.UNDECIDED: ("?", "undecided: it stopped, not knowing, or its counted steps were spent"),
    MapMark.REFUSED: ("-", "refused: it does not take the scene"),
    MapMark.FAILED: ("#", "failed: it ended with an error of its own, and no answer"),
    MapMark.UNCHECKED: ("!", "unchecked: decided, but the independent checker does not tell"),
}
