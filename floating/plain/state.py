"""The state of a run in finite precision."""

from __future__ import annotations

from ...exact.numbers.system import M
from ...exact.replay.contact import Link
from ...exact.replay.state import State


class PlainState(State[M]):
    """See `State`; two that rounding has put into each other, and that approach, collide at once.

    What the law of their meeting tells is then when they would have met on their way here: before the instant at which
    they stand, and long before it where they are all but at rest with each other.
    """

    def _hit_from_base(self, source: Link) -> tuple[M, M]:
        clock, wait = super()._hit_from_base(source)
        return clock, self.zero if wait < self.zero else wait
