"""Whether a break pattern is the exact one, another that the physics permits, or neither.

Where several contacts fall on one instant and their order matters, the physics permits several histories, one for
each order. A float engine's pattern outside of that set was changed by its error; one inside was only chosen by it.
"""

from __future__ import annotations

import time as clock
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any

from ..scenarios.trajectory import StopReason
from .break_pattern import break_pattern
from .deadline import OutOfTime, limited

if TYPE_CHECKING:
    from ..scenarios.engine import Engine
    from ..scenarios.trajectory import OnProgress, Trajectory

POLICIES = ("simultaneous", "sequential:order=scene")
"""Policies whose patterns are always told."""

SEEDS = 32
"""Orders drawn at random, after those, in search of a pattern."""

SEARCH_SECONDS = 20.0
"""Longest that the search may take."""

DECIDED = (StopReason.HORIZON, StopReason.EVENTS, StopReason.QUIET)


class Relation(Enum):
    """What a candidate's break pattern is; the value is what a person reads."""

    EXACT = "the exact one"
    PERMITTED = "permitted"
    IMPOSSIBLE = "impossible"
    UNSEEN = "not seen under any order tried"


@dataclass(frozen=True)
class PermittedPatterns:
    """Break patterns that the exact engine has under several orders of simultaneous impulses.

    Attributes:
        exact: the pattern under the scene's own policy.
        coupled: whether the order of impulses matters at any event: if not, `exact` is the only one permitted.
        patterns: by policy, the patterns found.
    """

    exact: Mapping[str, Any]
    coupled: bool
    patterns: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    def relation(self, pattern: Mapping[str, Any]) -> tuple[Relation, str | None]:
        """What a pattern is, and the policy that leads to it if it is another than the scene's."""
        if pattern == self.exact:
            return Relation.EXACT, None
        for policy, other in self.patterns.items():
            if other == pattern:
                return Relation.PERMITTED, policy
        return (Relation.UNSEEN if self.coupled else Relation.IMPOSSIBLE), None

    @property
    def distinct(self) -> int:
        """Number of different patterns found."""
        return len({repr(pattern) for pattern in (self.exact, *self.patterns.values())})


def permitted_patterns(
    truth: Engine, reference: Trajectory, wanted: list[Mapping[str, Any]], progress: OnProgress | None = None
) -> PermittedPatterns | None:
    """The patterns under each policy, and under orders drawn at random until every wanted one is found.

    None for a scene without a break pattern.
    """
    exact = break_pattern(reference)
    if exact is None:
        return None
    scene, end = reference.scene, reference.final_time
    coupled = any(event.coupled for event in reference.events)
    patterns: dict[str, Mapping[str, Any]] = {str(scene.tie_policy): exact}
    missing = [pattern for pattern in wanted if pattern != exact]
    deadline = clock.monotonic() + SEARCH_SECONDS
    for policy in (*POLICIES, *(f"sequential:seed={seed}" for seed in range(SEEDS))):
        if not coupled or (policy not in POLICIES and not missing):
            break
        if policy in patterns:
            continue
        try:
            left = deadline - clock.monotonic()
            other = scene.with_changes(tie_policy=policy)
            run = truth.run(other, until=float(end), progress=limited(progress, left))
        except OutOfTime:
            break
        pattern = break_pattern(run)
        if pattern is not None and run.stop.reason in DECIDED:
            patterns[policy] = pattern
            missing = [other for other in missing if other != pattern]
    return PermittedPatterns(exact, coupled, patterns)
