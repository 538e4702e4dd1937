"""Outcomes: what a history comes to, as functions of a trajectory."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

from ..documents.amounts import plain
from .break_pattern import break_pattern
from .pockets import pocketed
from .symmetry import symmetry

if TYPE_CHECKING:
    from ...scenarios.trajectory import Trajectory

Outcome: TypeAlias = "Callable[[Trajectory], Any]"
"""An outcome takes a trajectory and gives a value of plain data: numbers, text, lists and dicts; None where
it says nothing about the scene. Two runs have the same outcome when the values are equal."""


def collisions(trajectory: Trajectory) -> int:
    """Number of collisions: of pairwise impulses."""
    return trajectory.collisions


def collisions_per_ball(trajectory: Trajectory) -> dict[str, int]:
    """Number of impulses that each circle took part in, in scene order; circles without any are left out."""
    counts = Counter(name for event in trajectory.events for pair in event.impulses for name in pair)
    return {str(c.id): counts[str(c.id)] for c in trajectory.scene.circles if counts[str(c.id)]}


def who_hit_whom(trajectory: Trajectory) -> dict[str, int]:
    """Number of impulses between each pair, under `first-second` in scene order."""
    place = {name: number for number, name in enumerate(trajectory.scene.ids)}
    counts = Counter(pair for event in trajectory.events for pair in event.impulses)
    ordered = sorted(counts.items(), key=lambda item: (place[item[0][0]], place[item[0][1]]))
    return {f"{first}-{second}": count for (first, second), count in ordered}


def moved(trajectory: Trajectory) -> list[str]:
    """Ids of the circles that moved: those that did at the start, and those that were hit."""
    hit = {name for event in trajectory.events for pair in event.impulses for name in pair}
    return [str(c.id) for c in trajectory.scene.circles if not c.at_rest or (str(c.id) in hit and not c.fixed)]


def final_velocities(trajectory: Trajectory) -> dict[str, list[float]]:
    """The velocity (vx, vy) with which each circle that can move ends, as doubles."""
    movable = {str(c.id) for c in trajectory.scene.circles if not c.fixed}
    return {c.id: [float(c.vx), float(c.vy)] for c in trajectory.final.circles if c.id in movable}


OUTCOMES: dict[str, Outcome] = {
    "collisions": collisions,
    "collisions_per_ball": collisions_per_ball,
    "who_hit_whom": who_hit_whom,
    "moved": moved,
    "break_pattern": break_pattern,
    "pocketed": pocketed,
    "symmetry": symmetry,
    "final_velocities": final_velocities,
}
"""The outcomes that every comparison reports. A new one adds its own function and one line here; `compare`
takes more through its argument `outcomes`."""


def outcomes_of(trajectory: Trajectory, more: Mapping[str, Outcome] | None = None) -> dict[str, Any]:
    """Every outcome of a trajectory by name, those that say nothing left out."""
    table = {**OUTCOMES, **(more or {})}
    values = {name: outcome(trajectory) for name, outcome in table.items()}
    return {name: value for name, value in values.items() if value is not None}


SAME_NUMBER = 1e-6
"""Share of the largest number of an outcome by which its numbers may differ and still be the same: far above the
rounding of a run that agrees, far below any other event."""


def same_outcome(a: Any, b: Any, room: float = 0.0) -> bool:
    """Whether two values are the same outcome: equal, but for an error of numbers that are not whole.

    >>> same_outcome({"a": 1.0}, {"a": 1.0 + 1e-12}, 1e-6), same_outcome([1], [2])
    (True, False)
    """
    if isinstance(a, float) and isinstance(b, float):
        return abs(a - b) <= room or a == b
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(same_outcome(a[key], b[key], room) for key in a)
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(same_outcome(x, y, room) for x, y in zip(a, b, strict=True))
    return plain(a) == plain(b)


def changed_outcomes(reference: Mapping[str, Any], candidate: Mapping[str, Any], *, agrees: bool = False) -> list[str]:
    """Names of the outcomes that differ.

    Args:
        agrees: whether the two histories agree: then numbers that are not whole differ by error alone.

    >>> changed_outcomes({"collisions": 3, "moved": ["a"]}, {"collisions": 4, "moved": ["a"]})
    ['collisions']
    """
    names = [*reference, *(name for name in candidate if name not in reference)]
    return [
        name
        for name in names
        if not same_outcome(
            reference.get(name),
            candidate.get(name),
            math.inf if agrees else SAME_NUMBER * _largest(reference.get(name)),
        )
    ]


def _largest(value: Any) -> float:
    """The largest number of an outcome."""
    if isinstance(value, bool) or value is None or isinstance(value, str):
        return 0.0
    if isinstance(value, Mapping):
        return max(map(_largest, value.values()), default=0.0)
    if isinstance(value, list | tuple):
        return max(map(_largest, value), default=0.0)
    return abs(float(value)) if isinstance(value, int | float) else 0.0
