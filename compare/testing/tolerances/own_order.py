"""A history held against the exact run that resolves each tie as the history itself does."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ....exact.engine import ExactEngine
from ....exact.numbers.ball import double_bounds
from ....exact.policies.complementarity import Ask, pushing_contacts
from ....exact.replay.contact import Touch
from ...alignment.align import UNKNOWING, align
from ...causes.decision.decisions import decisions
from ...causes.decision.reader import Reader
from ...orders.guided import Guided

if TYPE_CHECKING:
    from ....scenarios.engine import Engine
    from ....scenarios.scene import Scene
    from ....scenarios.trajectory import Trajectory
    from ...alignment.align import Alignment
    from ...candidate import Candidate
    from .local_error import LocalError


class GuidedRounds(Guided):
    """As `Guided`; but contacts of one event of the history get their impulses together, as by the default policy.

    An engine that pushes all contacts of one instant at once may come to the next tie with them apart, by rounding:
    neither the policy nor one order after the other is what it does all along.
    """

    def __init__(self, scene: Scene, history: Trajectory) -> None:
        super().__init__(scene, history, any_order=True)

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """All of them that push, if the history has all that approach in what comes next; else one."""
        if not all(map(self._is_next, approaching)):
            return super().choose(approaching, ask)
        chosen = pushing_contacts(approaching, ask)
        for link in chosen:
            self.note(link)
        return chosen


def in_its_own_order(
    scene: Scene, candidate: Candidate, engine: Engine, span: float, local: LocalError | None
) -> str | None:
    """Why a history is permitted that resolves ties in no one order: as the exact run does that resolves them alike.

    Args:
        span: the time up to which it is asked for.
        local: the local error of the engine: where the two part at a decision that one contact of an honest engine may
            change, nothing is asked from there on. None: all of the span is asked for.

    Returns:
        What is told of it; None if it is not permitted, as far as this tells.
    """
    history = candidate.trajectory
    for guide in (GuidedRounds(scene, history), Guided(scene, history, candidate.stepped)):
        own = ExactEngine().run_with(scene, guide, until=None if math.isinf(span) else span)
        if own.stop.reason in UNKNOWING:
            continue
        found = align(own, history, step=engine.step, bits=engine.bits)
        if found.verdict == "agree":
            return "each tie resolved by the policy or in an order"
        if local is not None and (told := _out_of_reach(own, history, found, local)) is not None:
            return f"each tie resolved by the policy or in an order, up to event {told}"
    return None


def _out_of_reach(own: Trajectory, history: Trajectory, alignment: Alignment, local: LocalError) -> str | None:
    """The decision at which a history leaves a run, if its margin is within the error of one contact."""
    parted = alignment.divergence
    if parted is None:
        return None
    size = max(abs(float(x)) for circle in own.scene.circles for x in (circle.x, circle.y, circle.r))
    reader = Reader(own)
    for decision in decisions(own, history, alignment):
        value = reader.value(decision)
        if value is None:
            continue
        margin = max(map(abs, double_bounds(value)))
        room = local.unit * (size if decision.kind == "hit" else parted.time)
        if margin <= room:
            pair = " and ".join(f"{one.body} with {one.partner}" for one in decision.pairings)
            return (
                f"{parted.event} (t = {parted.time:.9g}): the meeting of {pair} is decided there by {margin:.3g}, "
                f"which the error of a single contact reaches: {room:.3g}"
            )
    return None
