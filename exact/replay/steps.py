"""The event log: what happened, as steps without decisions, and which of them a number rests on.

Given the scene and the log, every number of a run can be computed again: to more bits, in nested square roots.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple, TypeAlias

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.work import product_units
from .contact import Link, Touch


class Go(NamedTuple):
    """Advance `bodies` to one instant.

    The instant is the hit time of `source` if that is a Link, the clock of a body if it is an int, the constant
    itself if it is a Quantity.
    """

    source: Link | int | Quantity
    bodies: tuple[int, ...]


class Kick(NamedTuple):
    """Apply, together, the impulses that make each of these contacts separate as fast as it approached.

    Attributes:
        links: the contacts that push.
        among: the contacts whose law this is: all that approach in a round of the policy `simultaneous`, of which
            `links` push; the contact alone where an order was chosen. The velocities that come out depend on the
            state and on `among` alone, so symmetric instants have symmetric `among`, whatever set of contacts was
            found to push.
    """

    links: tuple[Touch, ...]
    among: tuple[Touch, ...]


class Flip(NamedTuple):
    """Negate every velocity; all bodies stand at one instant."""


class Take(NamedTuple):
    """Take a body out of play: it rests where it is, and nothing meets it."""

    body: int


Step: TypeAlias = Go | Kick | Flip | Take


STEP_UNITS = 60
"""Work of one step of the log in short numbers: about 60 microseconds."""

STEP_PRODUCTS = 30
"""Products of a step: those of long numbers are most of it."""


def step_units(bits: int) -> int:
    """Work of one step of the log in numbers of so many bits.

    >>> [step_units(bits) for bits in (256, 10_000, 1_000_000)]
    [60, 240, 77280]
    """
    return STEP_UNITS + STEP_PRODUCTS * product_units(bits, bits)


def causal_past(steps: Sequence[Step], bodies: Iterable[int]) -> tuple[list[int], list[int]]:
    """The steps on which the states of some bodies depend, in order, and all bodies in them.

    Args:
        steps: the log.
        bodies: indices of the circles asked about.
    """
    wanted = set(bodies)
    needed: list[int] = []
    for k in range(len(steps) - 1, -1, -1):
        step = steps[k]
        if isinstance(step, Go):
            if not wanted.isdisjoint(step.bodies):
                needed.append(k)
                if isinstance(step.source, int):
                    wanted.add(step.source)
                elif not isinstance(step.source, Quantity):
                    wanted.update(step.source.circles)
        elif isinstance(step, Kick):
            touched = {i for link in step.links for i in link.circles}
            if wanted & touched:
                needed.append(k)
                wanted |= touched
        elif isinstance(step, Take):
            if step.body in wanted:
                needed.append(k)
        else:
            needed.append(k)
    needed.reverse()
    return needed, sorted(wanted)


def circles_of(step: Step, count: int) -> tuple[int, ...]:
    """The circles that take part in a step, of so many."""
    if type(step) is Go:
        source = step.source
        if isinstance(source, tuple):
            extra = [i for i in source.circles if i not in step.bodies]
            return (*step.bodies, *extra) if extra else step.bodies
        return (*step.bodies, source) if isinstance(source, int) else step.bodies
    if type(step) is Kick:
        if len(step.links) == 1:
            return step.links[0].circles
        return tuple({i for link in step.links for i in link.circles})
    if isinstance(step, Take):
        return (step.body,)
    return tuple(range(count))
