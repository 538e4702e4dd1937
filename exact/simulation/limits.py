"""Where an event-driven run ends."""

from __future__ import annotations

from ...scenarios.engine import horizon
from ...scenarios.lazy import frozen
from ...scenarios.numbers.quantity import Quantity, QuantityLike
from ...scenarios.scene import Scene


@frozen
class Limits:
    """The limits of a run.

    Attributes:
        until: the last time that belongs to it; None: no such limit.
        events: the most events; None: no such limit.
        to_return: whether it ends at the return, twice the time of the reversal.
    """

    until: Quantity | None
    events: int | None
    to_return: bool = False


def run_limits(scene: Scene, until: QuantityLike | None, events: int | None) -> Limits:
    """The limits of an event-driven run, with the return of a reversed one as its default end.

    Raises:
        SceneError: for limits that are not above zero.
    """
    time, count = horizon(scene, until, events)
    reversing = scene.reverse_after is not None or scene.reverse_at is not None
    own = until is not None or events is not None or scene.until is not None or scene.events is not None
    if reversing and not own:
        return Limits(None, None, to_return=True)
    return Limits(time, count)
