"""What was foreseen of an engine, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..chaos.foreseen import Foreseen


def foreseen_phrase(found: Foreseen | None, number: int) -> str:
    """Between which events the engine at a place was to be expected to leave; empty where nothing is foreseen of it.

    >>> from truebreak.compare import compare
    >>> from truebreak.compare.chaos.foreseen import foreseen
    >>> from truebreak.scenarios import catalogue
    >>> found = foreseen(compare(catalogue.build("gas:n=4"), ["single", "quad"], events=60))
    >>> foreseen_phrase(found, 0)
    'foreseen to leave between event 25 and event 33, half of such engines by event 26'
    >>> foreseen_phrase(found, 1)
    'foreseen to keep the history in the 60 events looked at, by the growth of errors alone'
    >>> near = foreseen(compare(catalogue.build("near-tie:k=40"), ["interval"]))
    >>> foreseen_phrase(near, 0)
    'foreseen to leave at event 0'
    """
    horizon = None if found is None else found.horizons[number]
    if found is None or horizon is None:
        return ""
    if horizon.low.event is None:
        return f"foreseen to keep the history in the {found.events:,} events looked at, by the growth of errors alone"
    if horizon.high.event is None:
        half = "" if horizon.expected.event is None else f", half of such engines by event {horizon.expected.event:,}"
        return f"foreseen to leave from event {horizon.low.event:,} on{half}"
    if horizon.low.event == horizon.high.event:
        return f"foreseen to leave at event {horizon.low.event:,}"
    return (
        f"foreseen to leave between event {horizon.low.event:,} and event {horizon.high.event:,}, "
        f"half of such engines by event {horizon.expected.event:,}"
    )


def not_foreseen_phrase(found: Foreseen | None) -> str:
    """Why the run is not looked at to its end, or not at all; empty where it is.

    >>> from truebreak.compare.chaos.foreseen import Foreseen
    >>> not_foreseen_phrase(Foreseen(7, 2.5, (), "the run turns back after 7 events"))
    'Foreseen only so far: the run turns back after 7 events'
    >>> not_foreseen_phrase(Foreseen(0, 0.0, (), "a and b touch from the start on"))
    'No horizon is foreseen: a and b touch from the start on'
    """
    if found is None or not found.reason:
        return ""
    return f"{'Foreseen only so far' if found.events else 'No horizon is foreseen'}: {found.reason}"
