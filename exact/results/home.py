"""Whether a reversed run came back to its start, and what it says of that."""

from __future__ import annotations

from collections.abc import Sequence

from ...scenarios.scene import Scene
from ..numbers import ball
from .motion import ExactMotion

HOME_BITS = 128
"""Accuracy at which a final state is held against the first one, where the log does not tell."""

HOME = "came back to the start exactly: every position is the one at time 0 and every velocity its negative"


def return_note(scene: Scene, home: bool, exact: Sequence[bool], motion: ExactMotion) -> str:
    """What a run that ended at the return says of its final state.

    Args:
        scene: what ran.
        home: whether every circle has undone its whole way.
        exact: for each circle, whether its final numbers are exact.
        motion: the run's.
    """
    if home:
        return (
            "came back to the start exactly: after the reversal every circle met the same partners in reverse "
            "order, and each impulse undoes itself, so every position is the one at time 0 and every velocity "
            "its negative"
        )
    rows = motion.state(motion.end)
    apart: list[str] = []
    places = velocities = True
    for i, (circle, row) in enumerate(zip(scene.circles, rows, strict=True)):
        wanted = (circle.x, circle.y, -circle.vx, -circle.vy)
        for k, (value, first) in enumerate(zip(row, wanted, strict=True)):
            if ball.sign_of(value.ball(HOME_BITS) - ball.constant(first)):
                apart += [str(circle.id)] if k < 2 else []
                velocities = velocities and k < 2
            else:
                number = value.exact() if exact[i] else None
                same = number is not None and (number - first.in_tower(number.tower)).is_zero()
                places, velocities = places and (same or k >= 2), velocities and (same or k < 2)
    if apart:
        return f"did not come back to the start: circle {apart[0]} is elsewhere at the return"
    if places and velocities:
        return HOME
    if places:
        return (
            "came back to the start exactly: every position is the one at time 0; what touches there collides, "
            "so that not every velocity is the negative of its first"
        )
    return (
        "whether it came back to the start is not proved: an order chosen within one instant, or an instant of "
        "several contacts, is not always undone by its own reversal"
    )
