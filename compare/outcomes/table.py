"""Outcomes: what a history comes to, as functions of a trajectory."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any, TypeAlias

from ..documents.values.amounts import plain

if TYPE_CHECKING:
    from ...scenarios.trajectory import Trajectory

Outcome: TypeAlias = "Callable[[Trajectory], Any]"
"""An outcome takes a trajectory and gives a value of plain data: numbers, text, lists and dicts; None where
it says nothing about the scene. Two runs have the same outcome when the values are equal."""


OUTCOMES: dict[str, str] = {
    "collisions": "counts:collisions",
    "collisions_per_ball": "counts:collisions_per_ball",
    "who_hit_whom": "counts:who_hit_whom",
    "moved": "counts:moved",
    "break_pattern": "break_pattern:break_pattern",
    "pocketed": "pockets:pocketed",
    "symmetry": "symmetry:symmetry",
    "final_velocities": "counts:final_velocities",
}
"""The outcomes that every comparison reports, by module and function. A new one is its own file, and one line here;
`compare` takes more through its argument `outcomes`."""


def outcome(name: str) -> Outcome:
    """The outcome of that name, imported now.

    Raises:
        KeyError: for an unknown name.
    """
    module, _, function = OUTCOMES[name].partition(":")
    return getattr(import_module(f".{module}", __package__), function)


def outcomes_of(trajectory: Trajectory, more: Mapping[str, Outcome] | None = None) -> dict[str, Any]:
    """Every outcome of a trajectory by name, those that say nothing left out."""
    table = {**{name: outcome(name) for name in OUTCOMES}, **(more or {})}
    values = {name: function(trajectory) for name, function in table.items()}
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
            math.inf if agrees else room_of(reference.get(name)),
        )
    ]


def room_of(value: Any) -> float:
    """How far numbers may differ from those of a reference's outcome and be the same.

    >>> room_of({"a": [0.0, -2.0], "b": [1.0, 0.0]}) == 2 * SAME_NUMBER
    True
    """
    return SAME_NUMBER * _largest(value)


def _largest(value: Any) -> float:
    """The largest number of an outcome."""
    if isinstance(value, bool) or value is None or isinstance(value, str):
        return 0.0
    if isinstance(value, Mapping):
        return max(map(_largest, value.values()), default=0.0)
    if isinstance(value, list | tuple):
        return max(map(_largest, value), default=0.0)
    return abs(float(value)) if isinstance(value, int | float) else 0.0
