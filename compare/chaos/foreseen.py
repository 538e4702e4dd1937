"""Where each engine of a comparison was to be expected to diverge, by the exact run alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...exact.exact_motion import motion_of
from ..tangent.impacts import NoTangentMap, impacts
from .horizon import Forecaster, Horizon

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..comparison import Comparison
    from ..tangent.impacts import Impact

MOST_WORK = 400_000
"""Events times circles along which displacements are carried: about a second of time."""


@dataclass(frozen=True)
class Foreseen:
    """What the exact run says of its engines before they are run.

    Attributes:
        events: how many events were looked at, and the time of the last; none where the start has no tangent map.
        horizons: one for each candidate, in their order; None for an engine of exact numbers, for one
            that cannot run the scene, and without events.
        reason: why not all events of the run were looked at; empty if they were.
    """

    events: int
    time: float
    horizons: tuple[Horizon | None, ...]
    reason: str = ""


def foreseen(comparison: Comparison, work: int = MOST_WORK) -> Foreseen | None:
    """The horizons of a comparison's engines; None where the reference is not an exact run with events.

    Args:
        work: events times circles along which displacements are carried at most.

    >>> from truebreak.compare import compare
    >>> from truebreak.scenarios import catalogue
    >>> found = foreseen(compare(catalogue.build("gas:n=4"), ["single"], events=100))
    >>> found.events, found.horizons[0].holds(found.horizons[0].expected)
    (100, True)
    """
    reference = comparison.reference
    if motion_of(reference) is None or not reference.events:
        return None
    most = min(len(reference.events), work // len(comparison.scene.circles))
    reason = "" if most == len(reference.events) else f"no more than {most:,} events are looked at"
    try:
        struck = impacts(reference, most)
    except NoTangentMap as error:
        if not error.events:
            return Foreseen(0, 0.0, (None,) * len(comparison.candidates), str(error))
        reason = str(error)
        struck = impacts(reference, error.events)
    return _forecast(comparison, struck, reason)


def _forecast(comparison: Comparison, struck: Sequence[Sequence[Impact]], reason: str) -> Foreseen:
    reference = comparison.reference
    forecaster = Forecaster(reference, struck)
    horizons = tuple(
        None if candidate.error is None or candidate.unable else forecaster.horizon(candidate.engine, *candidate.error)
        for candidate in comparison.candidates
    )
    return Foreseen(len(struck), float(reference.events[len(struck) - 1].time), horizons, reason)
