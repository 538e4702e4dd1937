"""The full map in docs/stress.md: its tables, made of the ladders."""

from __future__ import annotations

import re
from collections.abc import Sequence
from hashlib import sha256
from itertools import groupby

from ...scenarios.errors import SceneError
from .family import Family
from .ladder import Ladder
from .plan import Plan
from .rows.marks import MapMark

BEGIN = "<!-- made by `python -m truebreak.compare.stress docs/stress.md`: from here -->\n"
END = "<!-- to here -->\n"

POWER = re.compile(r"\w+\*\*(-?\w+|\([^)]*\))")


def rewritten(page: str, part: str) -> str:
    """The page with what is between the two marks replaced.

    Raises:
        SceneError: for a page without them.
    """
    head, begin, rest = page.partition(BEGIN)
    _, end, tail = rest.partition(END)
    if not begin or not end:
        raise SceneError(f"the page has no place for the map; put there {BEGIN.strip()!r} and {END.strip()!r}")
    return f"{head}{begin}{part}{end}{tail}"


def map_part(asked: Plan, told: Sequence[Ladder]) -> str:
    """The tables of a map, family by family, and what the witnesses say of the exact engine."""
    by_family = {name: list(group) for name, group in groupby(told, key=lambda ladder: ladder.family)}
    parts = [
        f"Made with {asked.settings['versions']}.",
        exact_part(asked.families, told),
        "![The map: a row for each engine and scene, a cell for each k](stress.svg)",
        *(family_part(one, by_family[one.name]) for one in asked.families),
    ]
    return "".join(f"\n{part}\n" for part in parts) + "\n"


def exact_part(families: Sequence[Family], told: Sequence[Ladder]) -> str:
    """What the witnesses say of the exact engine."""
    closed = {one.name for one in families if one.known is not None}
    marks = [(ladder.family, mark) for ladder in told if ladder.engine == "exact" for mark in ladder.marks]
    right = [name for name, mark in marks if mark is MapMark.RIGHT]
    wrong = sum(mark is MapMark.WRONG for _, mark in marks)
    others = len(marks) - len(right) - wrong
    return (
        f"The exact engine is wrong at {wrong} of {len(marks):,} places. At {len(right):,} of them its whole run is "
        f"proved again by the independent checker, and at {sum(name in closed for name in right):,} of these a closed "
        f"form gives the same outcome; at {others} neither is known."
    )


def family_part(one: Family, told: Sequence[Ladder]) -> str:
    """One family's table."""
    levels = told[0].levels
    rows = [
        f"| {ladder.engine} | {ladder.lane} | {ladder.first_told} | {ladder.told()} |"
        for ladder in sorted(told, key=lambda ladder: list(dict.fromkeys(x.engine for x in told)).index(ladder.engine))
    ]
    return "\n".join(
        [
            f"### {one.name}",
            "",
            f"{_shown(one.summary)} {_shown(one.grows)}; k = {levels[0]} to {levels[-1]}.",
            "",
            f"A scene of it: `{_show(one)}`. SHA-256 of all scenes' digests: `{scenes_digest(one, levels)}`.",
            "",
            "| engine | scene | first wrong | every k |",
            "|---|---|---|---|",
            *rows,
        ]
    )


def scenes_digest(one: Family, levels: Sequence[int]) -> str:
    """The first 16 letters of the SHA-256 of the digests of a family's scenes, lane by lane."""
    digests = "".join(one.scene(place).digest for place in one.places(tuple(levels)))
    return sha256(digests.encode()).hexdigest()[:16]


def _show(one: Family) -> str:
    """The command that prints one of a family's scenes.

    >>> from truebreak.compare.stress.table import family
    >>> _show(family("scaled"))
    'truebreak stress scaled --show K --side up|down --seed 1|2'
    """
    seeds = "" if one.seeds == (0,) else f" --seed {'|'.join(map(str, one.seeds))}"
    return f"truebreak stress {one.name} --show K --side {'|'.join(one.sides)}{seeds}"


def _shown(words: str) -> str:
    """Powers as code: two stars are the beginning of bold letters elsewhere.

    >>> _shown("about pi * 10**(k/2), late by 10**-k.")
    'about pi * `10**(k/2)`, late by `10**-k`.'
    """
    return POWER.sub(r"`\g<0>`", words)
