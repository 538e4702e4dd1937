"""The table of stress families by name."""

from __future__ import annotations

from importlib import import_module

from ...scenarios.errors import SceneError
from ..engines import suggestion
from .family import Family

FAMILIES = {
    "near-ties": "near_ties",
    "grazes": "grazes",
    "slow-fast": "slow_fast",
    "mass-ratios": "mass_ratios",
    "pi": "pi",
    "scaled": "scaled",
    "moved": "moved",
    "walls": "walls",
    "corners": "corners",
    "unstable": "unstable",
    "touching": "touching",
    "gaps": "gaps",
    "long-runs": "long_runs",
    "crowds": "crowds",
}
"""Every family, and the module of `families` whose `FAMILY` it is. A new one is its own file, and one line here."""


def family(name: str) -> Family:
    """The family of that name.

    Raises:
        SceneError: if there is none.

    >>> family("near-ties").sides
    ('left', 'right')
    """
    if name not in FAMILIES:
        raise SceneError(f"no stress family {name[:60]!r}; {suggestion(name, list(FAMILIES))}")
    return import_module(f".families.{FAMILIES[name]}", __package__).FAMILY
