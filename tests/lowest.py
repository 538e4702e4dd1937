"""The lowest version that each dependency is declared to work with: `python tests/lowest.py` prints them for pip.

`make lowest` installs these and runs the tests that touch each of them.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent / "pyproject.toml"
EXTRAS = ("dask", "docs", "notebook", "plots", "tables")
"""Extras with lower bounds; those of other people's engines are pinned."""


def declared() -> list[str]:
    """What pyproject.toml demands, of those extras too."""
    project = tomllib.loads(PROJECT.read_text("utf-8"))["project"]
    extras = project["optional-dependencies"]
    return [*project["dependencies"], *(requirement for name in EXTRAS for requirement in extras[name])]


def lowest(requirements: list[str]) -> list[str]:
    """Each requirement at its lower bound.

    >>> lowest(["click>=8.1", "mpmath>=1.3,<1.4"])
    ['click==8.1', 'mpmath==1.3']
    """
    found = []
    for requirement in requirements:
        match = re.fullmatch(r"([\w-]+)>=([\d.]+)(?:,.*)?", requirement)
        if match is None:
            raise ValueError(f"{requirement!r}: has no lower bound of the form name>=version")
        found.append(f"{match[1]}=={match[2]}")
    return found


if __name__ == "__main__":
    print("\n".join(lowest(declared())))
