"""Whether a break pattern is the exact one, another that the physics permits, or neither.

Where several contacts fall on one instant and their order matters, the physics permits several histories,
one for each order. A float engine's pattern outside of that set was changed by its error; one inside was only
chosen by it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any, TypeAlias

from ...scenarios.trajectory import StopReason
from ..deadline import OutOfTime, limited, uninterrupted
from ..engines import is_stepped
from .break_pattern import break_pattern

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.trajectory import OnProgress, Trajectory

Pattern: TypeAlias = "Mapping[str, Any]"

POLICIES = ("simultaneous", "sequential:order=scene")
"""Policies whose patterns are always told."""

SEARCH_SECONDS = 10.0
"""Time that following the orders may take; from the reference's own run follows how many can be followed in
it."""

LEAST_CAP, GREATEST_CAP = 8, 256
"""Least and greatest number of outcomes that are followed."""

SAMPLE_SHARE = 4
"""Beyond the cap, one order is drawn at random for this many outcomes followed."""

DECIDED = (StopReason.HORIZON, StopReason.EVENTS, StopReason.QUIET)


class Relation(Enum):
    """What a candidate's break pattern is; the value is what a person reads."""

    EXACT = "the exact one"
    PERMITTED = "permitted"
    IMPOSSIBLE = "impossible"
    UNSEEN = "not seen"


@dataclass(frozen=True)
class PermittedPatterns:
    """Break patterns that the reference engine has under several orders of simultaneous impulses.

    Attributes:
        exact: the pattern under the scene's own policy.
        by_policy: the pattern under each named policy.
        orders: the distinct patterns over all sequential orders.
        complete: whether `orders` are all that there are; if not, there are more orders than could be
            followed.
    """

    exact: Pattern
    by_policy: Mapping[str, Pattern] = field(default_factory=dict)
    orders: tuple[Pattern, ...] = ()
    complete: bool = True

    def relation(self, pattern: Pattern) -> Relation:
        """What a pattern is."""
        if pattern == self.exact:
            return Relation.EXACT
        if pattern in self.orders or pattern in self.by_policy.values():
            return Relation.PERMITTED
        return Relation.IMPOSSIBLE if self.complete else Relation.UNSEEN

    def policy(self, pattern: Pattern) -> str | None:
        """The named policy that leads to a pattern, if one does."""
        return next((policy for policy, other in self.by_policy.items() if other == pattern), None)


def permitted_patterns(
    truth: Engine,
    reference: Trajectory,
    seconds: float,
    histories: Sequence[Trajectory] = (),
    progress: OnProgress | None = None,
    max_seconds: float | None = None,
) -> PermittedPatterns | None:
    """The patterns under each policy and over all sequential orders.

    None for a scene without a break pattern.

    Args:
        seconds: how long the reference's run took.
        histories: runs whose own order of impulses is followed as far as the exact engine allows it, so that a
            permitted pattern is found even where the orders are too many to enumerate.
        max_seconds: what the user allows any one run; the search gets no more.
    """
    exact = break_pattern(reference)
    if exact is None:
        return None
    scene, end = reference.scene, float(reference.final_time)
    by_policy: dict[str, Pattern] = {str(scene.tie_policy): exact}
    if not any(event.coupled for event in reference.events):
        return PermittedPatterns(exact, by_policy, (exact,))
    watched = limited(progress, SEARCH_SECONDS, max_seconds)
    patterns: list[Pattern] = []
    complete = False
    try:
        for policy in POLICIES:
            if policy not in by_policy:
                run = truth.run(scene.with_changes(tie_policy=policy), until=end, progress=watched)
                pattern = _pattern(uninterrupted(run))
                if pattern is not None:
                    by_policy[policy] = pattern
        if hasattr(truth, "run_with"):
            from ...exact.all_orders import all_orders
            from ...exact.policies.guided import Guided
            from .order_search import Attended

            for history in histories:
                policy = Guided(scene, history, is_stepped(history.engine))
                guided = truth.run_with(scene, policy, until=end, progress=watched)  # type: ignore[attr-defined]
                pattern = _pattern(uninterrupted(guided))
                if pattern is not None and pattern not in patterns:
                    patterns.append(pattern)
            cap = max(LEAST_CAP, min(GREATEST_CAP, int(SEARCH_SECONDS / 2 / max(seconds, 1e-3))))
            attended = Attended(truth)  # type: ignore[arg-type]
            tree = all_orders(attended, scene, until=end, cap=cap, samples=cap // SAMPLE_SHARE, progress=watched)
            found = [_pattern(outcome.trajectory) for outcome in tree.outcomes]
            complete = tree.complete and None not in found
            for pattern in found:
                if pattern is not None and pattern not in patterns:
                    patterns.append(pattern)
    except OutOfTime:
        complete = False
    return PermittedPatterns(exact, by_policy, tuple(patterns), complete)


def _pattern(run: Trajectory) -> Pattern | None:
    """The break pattern of a run that went to its end."""
    return break_pattern(run) if run.stop.reason in DECIDED else None
