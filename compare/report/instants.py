"""Instants of which a double tells no difference, told apart."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...exact.numbers import ball
from ...scenarios.numbers.quantity import real

if TYPE_CHECKING:
    from ...scenarios.trajectory import Event

BITS = (256, 1_024, 4_096)
"""Bits to which two instants are known before they are called one: near-ties of the catalogue need up to 1,400."""


def later(before: Event, event: Event) -> str:
    """How much later an event is than another that has the same double for its time; empty where that is not known.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import catalogue
    >>> events = ExactEngine().run(catalogue.build("near-tie:k=40")).events
    >>> later(events[0], events[1])
    '5.00e-41'
    """
    for bits in BITS:
        with ball.precision(bits):
            apart = real(event.time).ball(bits) - real(before.time).ball(bits)
            if apart > 0:
                return apart.str(3, radius=False)
    return ""
