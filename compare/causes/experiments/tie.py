"""A tie that is resolved otherwise."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..diagnosis import CauseName, Experiment

if TYPE_CHECKING:
    from ....scenarios.trajectory import Contact
    from ..laboratory.laboratory import Laboratory
    from ..so_far import SoFar

CAUSE = CauseName["TIE"]


def tie(lab: Laboratory, found: SoFar) -> list[Experiment]:
    """Another resolution of an exact tie, unless more iterations of the solver resolve it as the policy does."""
    if any(row.suffices for row in found.rows if row.cause is CauseName["ITERATIONS"]):
        return [Experiment(CAUSE, "with more iterations it resolves the instant as the policy does", None, False)]
    return [resolved_otherwise(lab)]


def resolved_otherwise(lab: Laboratory) -> Experiment:
    """Contacts of one exact instant, which the engine resolves otherwise."""
    divergence, events = lab.divergence, lab.reference.events
    if lab.decision is not None and lab.decision.second is not None:
        names = {lab.decision.first.partner, lab.decision.second.partner}
    else:
        names = {*divergence.partners} & {*lab.study.scene.ids}
    here = events[divergence.expected_event] if divergence.expected_event < len(events) else None
    cluster = _cluster(lab, [] if here is None or not here.coupled else here.contacts)
    together = {name for pair in cluster for name in pair}
    if len(cluster) < 2 or not names or not names <= together:
        return Experiment(CAUSE, "no contacts of one exact instant are in question", None, False)
    policy = lab.study.scene.tie_policy
    own = "" if "tie_policy" in lab.engine.scene_keys else f"; {lab.name} does not follow {policy}"
    return Experiment(
        CAUSE,
        f"{len(cluster)} contacts fall on exactly one instant, the order of their impulses matters, and "
        f"{lab.name} has another{own}",
        None,
        True,
        1.0,
    )


def _cluster(lab: Laboratory, contacts: Sequence[Contact]) -> list[Contact]:
    """Those contacts of an instant that hang together with the body in question through circles that can move."""
    movable = lab.candidate.alignment.walks
    names, found = {lab.divergence.body}, [pair for pair in contacts if lab.divergence.body in pair]
    while True:
        names |= {name for pair in found for name in pair if name in movable}
        more = [pair for pair in contacts if names & {*pair}]
        if len(more) == len(found):
            return found
        found = more
