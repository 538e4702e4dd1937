"""Where two circles of an exact run graze: nearby runs part there, into those that hit and those that miss."""

from __future__ import annotations

from bisect import bisect_right
from typing import TYPE_CHECKING, NamedTuple

from flint import arb

from ...exact.exact_motion import ExactValue
from ...exact.laws.formulas import advance, pair_approach, pair_nearest_time
from ...exact.numbers import ball
from ...exact.numbers.ball import known_ball

if TYPE_CHECKING:
    from ...exact.exact_motion import ExactMotion
    from ...exact.replay.contact import Link
    from ...scenarios.trajectory import Event, Trajectory

BITS = 128
"""Accuracy of the times that are compared; where they are not told apart the graze counts as one."""


class Graze(NamedTuple):
    """Two circles that touch without pushing.

    Attributes:
        events: how many events of the run lie before it.
        one, other: the circles.
    """

    events: int
    one: str
    other: str


def first_graze(trajectory: Trajectory, motion: ExactMotion, events: int) -> Graze | None:
    """The first graze before the last of so many events of an exact run; None if there is none.

    The run has proved which pairs graze on flights that they had; such a graze comes to pass unless one of the two
    has its next impulse before it.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> run = ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 2), Circle(9, 0)]))
    >>> first_graze(run, run.motion, 1)
    Graze(events=0, one='c1', other='c2')
    """
    if motion.tape is None:
        return None
    found = [
        graze
        for instant, links in motion.tape.grazes.items()
        for link in links
        if (graze := _graze(trajectory, motion, events, instant, link)) is not None
    ]
    return min(found, default=None)


def _graze(trajectory: Trajectory, motion: ExactMotion, events: int, instant: int, link: Link) -> Graze | None:
    """The graze that two were proved to have on their flights after an instant, if it comes to pass."""
    i, j = link.circles
    one, other = trajectory.scene.ids[i], trajectory.scene.ids[j]
    before = sum(_number(event) <= instant for event in trajectory.events[:events])
    with ball.precision(BITS):
        time = _nearest(motion, i, j, instant)
        for event in trajectory.events[before:events]:
            if not event.time.ball(BITS) < time:
                return Graze(before, one, other)
            if any(name in pair for pair in event.impulses for name in (one, other)):
                return None
            before += 1
    return None


def _nearest(motion: ExactMotion, i: int, j: int, instant: int) -> arb:
    """When two circles are nearest to each other on their flights after an instant."""
    rows: list[list[arb]] = []
    for knots in (motion.knots[i], motion.knots[j]):
        knot = knots[bisect_right(knots, instant + 1, key=lambda knot: knot[-1]) - 1]
        rows.append([known_ball(number, BITS) for number in knot[:5]])
    (s, ax, ay, avx, avy), (t, bx, by, bvx, bvy) = rows
    dx, dy = bx - advance(ax, avx, t - s), by - advance(ay, avy, t - s)
    return t + pair_nearest_time(pair_approach(dx, dy, bvx - avx, bvy - avy), bvx - avx, bvy - avy)


def _number(event: Event) -> int:
    """The number of an event's instant; 0 at the start."""
    return event.time.instant or 0 if isinstance(event.time, ExactValue) else 0
