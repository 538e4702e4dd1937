"""Numbers that are proved to be exactly zero, which no enclosure tells from small ones."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations, product
from typing import TYPE_CHECKING, NamedTuple

from ....exact.laws.formulas import advance, pair_approach, pair_discriminant, pair_gap, wall_approach
from ....scenarios.numbers.quantity import Quantity, Real, real
from ...alignment.streams import history
from .decision import OwnFlight

if TYPE_CHECKING:
    from ....scenarios.trajectory import Trajectory

LONGEST_TEXT = 400
"""Characters of an exact value that is still calculated with as text: some levels of square roots, which a `Quantity`
tells from zero in milliseconds. A longer one proves nothing, and is never called zero."""


class _Exact(NamedTuple):
    """A flight in exact numbers."""

    t: Quantity
    x: Quantity
    y: Quantity
    vx: Quantity
    vy: Quantity


def grazes_exactly(one: OwnFlight, other: OwnFlight, reach: Quantity) -> bool:
    """Whether two circles are proved to pass each other at a least distance of exactly zero.

    Args:
        reach: the sum of their radii.
    """
    flights = _exact(one), _exact(other)
    if flights[0] is None or flights[1] is None:
        return False
    return _is_zero(pair_discriminant, *_relative(flights[0], flights[1]), reach)


def touches_exactly(one: OwnFlight, other: OwnFlight, reach: Quantity) -> bool:
    """Whether two circles are proved to touch, neither apart nor overlapping, where the later of their flights begins.

    Args:
        reach: the sum of their radii.
    """
    flights = _exact(one), _exact(other)
    if flights[0] is None or flights[1] is None:
        return False
    dx, dy, _, _ = _relative(flights[0], flights[1])
    return _is_zero(pair_gap, dx, dy, reach)


def exact_zero(reference: Trajectory, event: int) -> str | None:
    """What is exactly zero among the flights that lead to an event, in words; None if no zero is proved.

    Looked for are grazes, circles that touch without approaching, and circles that fly parallel to a wall.
    """
    flights = _flights_before(reference, event)
    radii = {str(c.id): c.r for c in reference.scene.circles}
    for (one, a), (other, b) in combinations(flights.items(), 2):
        dx, dy, vx, vy = _relative(a, b)
        reach = radii[one] + radii[other]
        if _is_zero(pair_gap, dx, dy, reach) and _is_zero(pair_approach, dx, dy, vx, vy):
            return f"{one} and {other} touch and do not approach"
        if float(pair_approach(dx, dy, vx, vy)) < 0 and _is_zero(pair_discriminant, dx, dy, vx, vy, reach):
            return f"{one} and {other} graze"
    for (name, flight), wall in product(flights.items(), reference.scene.walls):
        moves = flight.vx.sign() or flight.vy.sign()
        if moves and _is_zero(wall_approach, flight.vx, flight.vy, *wall.normal):
            return f"{name} flies parallel to {wall.id}"
    return None


def _flights_before(reference: Trajectory, event: int) -> dict[str, _Exact]:
    """Each circle as its last meeting before an event left it, where its numbers are exact and short."""
    met = history(reference).meetings
    flights: dict[str, _Exact] = {}
    for circle in reference.scene.circles:
        past = [m.event for m in met.get(str(circle.id), []) if m.event < event]
        time = reference.events[past[-1]].time if past else Quantity.of(0)
        state = reference.at(time)[str(circle.id)]
        flight = _exact(OwnFlight(time, state.x, state.y, state.vx, state.vy))
        if flight is not None:
            flights[str(circle.id)] = flight
    return flights


def _exact(flight: OwnFlight) -> _Exact | None:
    """A flight in exact numbers, where they are short."""
    values = [_short(value) for value in (flight.t, flight.x, flight.y, flight.vx, flight.vy)]
    return None if None in values else _Exact(*(q for q in values if q is not None))


def _short(value: Real) -> Quantity | None:
    """A number as a `Quantity`, if it is exact and short."""
    text = real(value).text()
    return None if text is None or len(text) > LONGEST_TEXT else Quantity.of(text)


def _relative(one: _Exact, other: _Exact) -> tuple[Quantity, Quantity, Quantity, Quantity]:
    """d and v from one to the other, at the later of the times from which they fly."""
    later = one.t if (one.t - other.t).sign() >= 0 else other.t
    ax, ay = advance(one.x, one.vx, later - one.t), advance(one.y, one.vy, later - one.t)
    bx, by = advance(other.x, other.vx, later - other.t), advance(other.y, other.vy, later - other.t)
    return bx - ax, by - ay, other.vx - one.vx, other.vy - one.vy


def _is_zero(law: Callable[..., Quantity], *numbers: Quantity) -> bool:
    """Whether a law is proved to give zero."""
    try:
        return law(*numbers).sign() == 0
    except ValueError:
        return False
