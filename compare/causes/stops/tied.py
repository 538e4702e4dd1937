"""Several contacts at one exact instant, which no enclosure tells apart."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..diagnosis import CauseName, Experiment

if TYPE_CHECKING:
    from .stopped import Stopped


def tied(stopped: Stopped, rows: list[Experiment]) -> list[Experiment]:
    """Whether the event at which it stopped is such an instant."""
    events, event = stopped.reference.events, stopped.event
    if not stopped.widens or event >= len(events) or len(events[event].contacts) < 2:
        return []
    told = f"several contacts fall on exactly one instant, event {event}: no enclosure can tell"
    return [Experiment(CauseName["TIE"], told, None, True, 1.0)]
