"""Entries into pockets of a run whose engine knows none: they follow from the flights between its knots."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

from ..scenarios.numbers.precision import Double
from ..scenarios.scene import Scene
from ..scenarios.trajectory import Pocketing, Trajectory
from .knots import DoubleKnot, DoubleMotion, FallingMotion, SteppedFall


def entries(scene: Scene, motion: DoubleMotion, end: float) -> tuple[Pocketing, ...]:
    """Every time that a centre comes within a pocket's radius, in order.

    Between two knots a centre flies straight, and enters a pocket (X, Y, R) when |p + v t - (X, Y)|^2 = R^2 has its
    smaller root within the flight; under gravity at a zero of a quartic, or, of an engine of steps, straight between
    two of them.
    """
    found = [
        Pocketing(str(circle.id), str(pocket.id), Double(time))
        for k, circle in enumerate(scene.circles)
        if not circle.fixed
        for pocket in scene.pockets
        for time in _times(motion, k, float(pocket.x), float(pocket.y), float(pocket.r), end)
    ]
    return tuple(sorted(found, key=lambda entry: float(entry.time)))


def last_entry(scene: Scene, motion: DoubleMotion, end: float) -> float:
    """When a run that has no contact left has no entry left either: never before `end`."""
    if isinstance(motion, SteppedFall):
        return end
    return max([end, *(float(entry.time) for entry in entries(scene, motion, math.inf))])


def entering(scene: Scene, row: tuple[float, float, float, float], room: float) -> bool:
    """Whether a centre at x, y, with vx, vy, is in a pocket, or flies into it from its rim, to a rounding of places."""
    x, y, vx, vy = row
    for pocket in scene.pockets:
        dx, dy = x - float(pocket.x), y - float(pocket.y)
        beyond = math.hypot(dx, dy) - float(pocket.r)
        if beyond < -room or (beyond <= room and dx * vx + dy * vy < 0.0):
            return True
    return False


def left_play(run: Trajectory, steps: bool, loose: float) -> dict[str, float]:
    """When circles have left play, by the pockets that they have entered.

    What meets something afterwards has not: of an engine of events, nothing is taken to have gone before its last
    contact, and to go on after it. An engine of steps sees at the end of a step that a centre is in a pocket.

    Args:
        steps: whether the engine takes steps.
        loose: the share of a time within which a contact may be of the instant of an entry.
    """
    last, found = dict[str, float](), dict[str, float]()
    for event in () if steps else run.events:
        last.update((str(name), float(event.time)) for pair in event.impulses for name in pair)
    for entry in run.pocketings if run.scene.capture else ():
        met, time = last.get(entry.circle, -math.inf), float(entry.time)
        found.setdefault(entry.circle, time if met <= time + loose * time else math.nextafter(met, math.inf))
    return found


def _times(motion: DoubleMotion, place: int, x0: float, y0: float, r: float, end: float) -> Iterator[float]:
    """When one circle enters one pocket.

    At the time of a knot the velocity from then on decides: who is turned away at the rim does not enter.
    """
    row = motion.knots[place]
    _, x, y, _, _ = row[0]
    inside = _gap(x - x0, y - y0, r) < 0
    falls = motion.halves if isinstance(motion, FallingMotion) and place not in motion.pegs else None
    for knot, (last, *_) in pairwise([*row, (math.inf, 0.0, 0.0, 0.0, 0.0)]):
        for (t, x, y, vx, vy), after in _pieces(motion, place, knot, min(last, math.nextafter(end, math.inf))):
            flight = x - x0, y - y0, vx, vy, r
            waits = [time_to_enter(*flight)] if falls is None else times_to_enter(*flight, *falls)
            entered = [wait for wait in waits if wait is not None and t + wait < after]
            yield from (t + wait for wait in entered if wait or not inside)
            if inside or entered:
                x, y, _, _ = motion.flown(place, knot, after)
                inside = _gap(x - x0, y - y0, r) < 0


def _pieces(motion: DoubleMotion, place: int, knot: DoubleKnot, after: float) -> Iterator[tuple[DoubleKnot, float]]:
    """A flight in parts, and when each ends: as a whole, or from step to step."""
    t = knot[0]
    if not isinstance(motion, SteppedFall) or place in motion.pegs:
        if t < after:
            yield knot, after
        return
    dt, k = motion.dt, 0
    while (since := t + k * dt) < after:
        k += 1
        (x, y, _, _), then = motion.flown(place, knot, since), motion.flown(place, knot, t + k * dt)
        yield (since, x, y, (then[0] - x) / dt, (then[1] - y) / dt), min(t + k * dt, after)


def time_to_enter(dx: float, dy: float, vx: float, vy: float, r: float) -> float | None:
    """Time until a point comes within r of the origin; 0 if it is there already, None if it never does, or grazes.

    >>> time_to_enter(-3.0, 0.0, 1.0, 0.0, 1.0), time_to_enter(-3.0, 1.0, 1.0, 0.0, 1.0)
    (2.0, None)
    """
    gap = _gap(dx, dy, r)
    if gap < 0:
        return 0.0
    approach, speed2 = dx * vx + dy * vy, vx * vx + vy * vy
    discriminant = speed2 * r * r - (dx * vy - dy * vx) ** 2
    if approach >= 0 or discriminant <= 0:
        return None
    return gap / (-approach + math.sqrt(discriminant))


def times_to_enter(dx: float, dy: float, vx: float, vy: float, r: float, hx: float, hy: float) -> list[float]:
    """The times until a point comes within r of the origin on its parabola d + v t + h t^2; the first 0 if it is there.

    >>> [round(time, 12) for time in times_to_enter(0.0, -2.0, 0.0, 10.0, 1.0, 0.0, -5.0)]
    [0.105572809, 1.632455532034]
    """
    import numpy as np

    along, fall, lift = dx * vx + dy * vy, dx * hx + dy * hy, vx * hx + vy * hy
    gap = np.polynomial.Polynomial(
        [_gap(dx, dy, r), 2 * along, vx * vx + vy * vy + 2 * fall, 2 * lift, hx * hx + hy * hy]
    )
    slope = gap.deriv()
    zeros = sorted(float(zero.real) for zero in gap.roots() if zero.imag == 0.0 and slope(zero.real) < 0.0)
    zeros = [zero - float(gap(zero) / slope(zero)) for zero in zeros]  # one more step of Newton's
    return [*([0.0] if gap(0.0) < 0 else []), *(zero for zero in zeros if zero > 0.0)]


def _gap(dx: float, dy: float, r: float) -> float:
    """The square of a centre's distance less that of the rim's: below zero inside."""
    return dx * dx + dy * dy - r * r
