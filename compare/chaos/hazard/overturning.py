"""What errors do to the decisions of an impact: each in its own direction, as a share of what turns them over."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .margins import WALL, Course, as_doubles

if TYPE_CHECKING:
    from ...tangent.impacts import Impact

Errors = NDArray[np.float64]


def shares(
    course: Course,
    event: Sequence[Impact],
    impact: Impact,
    errors: Errors,
    movable: Callable[[int], bool],
    off: Callable[[int], Errors],
) -> list[float]:
    """Root mean squares, over a number of errors, of what they change in each decision as a share of its margin.

    To the first order. The decisions are

    - for each circle that can move, and each thing that it would meet next were it not for the impact: which of the two
      meetings is the earlier. The margin is the time between them;
    - for two circles: whether they pass each other by. The margin is how far they are from that;
    - whether they come together at all. The margin is the speed at which they do.

    So an error along the motion of two balls on a line lets none of them miss the other, however large it is.

    Args:
        course: the states at the event.
        event: all of its impacts.
        impact: the one in question.
        errors: shape (circles, 4, k): k errors of x, y, vx, vy of every circle.
        off: draws by how much an engine errs in the times of so many meetings themselves, shape (so many, k).

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.compare.tangent.impacts import impacts
    >>> from truebreak.scenarios import Circle, Scene
    >>> scene = Scene([Circle(0, 0, vx=1), Circle(6, "6/5")])
    >>> [[impact]] = impacts(ExactEngine().run(scene), 1)
    >>> course = Course(scene)
    >>> course.fly(float(impact.time))
    >>> errors = np.zeros((2, 4, 1))
    >>> def told(place, coordinate):
    ...     errors[:] = 0
    ...     errors[place, coordinate] = 0.1
    ...     found = shares(course, [impact], impact, errors, lambda i: True, lambda count: np.zeros((count, 1)))
    ...     return [round(share, 9) for share in found]
    >>> told(0, 0), told(0, 1), told(0, 2)  # forward; up, of the 0.8 to a miss; and in the speed
    ([0.0, 0.0], [0.125, 0.0], [0.0, 0.1])
    """
    a, b, dx, dy, vx, vy, reach, *_ = as_doubles(impact)
    normal, velocity = np.array([dx, dy]) / reach, np.array([vx, vy])
    apart = errors[a] if b is None else errors[b] - errors[a]
    rate = normal @ velocity
    shift = -(normal @ apart[:2]) / rate
    told: list[float] = []
    for i in (i for i in (a, b) if i is not None and movable(i)):
        others = course.instead(event, i)
        theirs = np.where((others.places == WALL)[:, None, None], 0.0, errors[others.places, :2])
        gaps = np.einsum("oc,ock->ok", others.normals, theirs - errors[i, :2])
        shifts = gaps / others.rates[:, None] - shift + off(len(gaps)) - off(len(gaps))
        told += [_share(one, wait) for one, wait in zip(shifts, others.waits.tolist(), strict=True)]
    if b is None:
        return [*told, _share(normal @ apart[2:], abs(float(rate)))]
    speed = float(np.hypot(vx, vy))
    along = velocity / speed
    across = np.array([-along[1], along[0]])
    nearest = apart[:2] - (dx * vx + dy * vy) / speed**2 * apart[2:]
    room = reach - abs(dx * vy - dy * vx) / speed
    return [*told, _share(across @ nearest, room), _share(along @ apart[2:], speed)]


def _share(changes: Errors, margin: float) -> float:
    """The root mean square of changes over a margin; infinite where there is none."""
    return float(np.sqrt(np.mean(changes * changes))) / margin if margin > 0 else np.inf
