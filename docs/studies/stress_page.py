"""`python docs/studies/stress_page.py docs/stress.md`: makes the full map, and writes page and picture."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from hashlib import sha256
from itertools import groupby
from pathlib import Path

from truebreak.compare.cli.commands.sweep import how_far
from truebreak.compare.grids.grid import carry_out
from truebreak.compare.grids.store import Store
from truebreak.compare.grids.stress_families import StressFamily
from truebreak.compare.grids.stress_map import Ladder, MapMark, StressMap, ladders, stress_plan
from truebreak.compare.report.pictures.heat_map import heat_map
from truebreak.compare.writing import check_writable, write_whole
from truebreak.scenarios.errors import SceneError

TITLE = "Where each engine's answer turns wrong"

BEGIN = "<!-- made by `python docs/studies/stress_page.py docs/stress.md`: from here -->\n"
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


def map_part(asked: StressMap, told: Sequence[Ladder]) -> str:
    """The tables of a map, family by family, and what the witnesses say of the exact engine."""
    by_family = {name: list(group) for name, group in groupby(told, key=lambda ladder: ladder.family)}
    parts = [
        f"Made with {asked.settings['versions']}.",
        exact_part(asked.families, told),
        "![The map: a row for each engine and scene, a cell for each k](stress.svg)",
        *(family_part(one, by_family[one.name]) for one in asked.families),
    ]
    return "".join(f"\n{part}\n" for part in parts) + "\n"


def exact_part(families: Sequence[StressFamily], told: Sequence[Ladder]) -> str:
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


def family_part(one: StressFamily, told: Sequence[Ladder]) -> str:
    """One family's table."""
    levels = told[0].levels
    rows = [
        f"| {ladder.engine} | {ladder.lane} | {ladder.first_words} | {ladder.summary()} |"
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


def scenes_digest(one: StressFamily, levels: Sequence[int]) -> str:
    """The first 16 letters of the SHA-256 of the digests of a family's scenes, lane by lane."""
    digests = "".join(one.scene(place).digest for place in one.places(tuple(levels)))
    return sha256(digests.encode()).hexdigest()[:16]


def _show(one: StressFamily) -> str:
    """The command that prints one of a family's scenes.

    >>> from truebreak.compare.grids.stress_families import stress_family
    >>> _show(stress_family("scaled"))
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


def main(arguments: list[str] | None = None) -> int:
    """Makes the map and writes it; the exit status."""
    parser = argparse.ArgumentParser(prog="python docs/studies/stress_page.py", description=__doc__)
    parser.add_argument("file", help="the page, such as docs/stress.md; the picture is written beside it")
    parser.add_argument("--store", help="keep the rows in this file, and resume from it")
    options = parser.parse_args(arguments)
    asked = stress_plan()
    try:
        page = Path(options.file).read_text(encoding="utf-8")
        rewritten(page, "")
        check_writable(options.file)
        rows = Store(options.store or ":memory:", asked.settings)
        carry_out(asked, rows, progress=lambda done: print(how_far("stress", "places", done), file=sys.stderr))
        rows.verify()
    except (SceneError, OSError) as error:
        print(f"truebreak: error: {error}", file=sys.stderr)
        return 2
    told = ladders(rows, asked.engines)
    write_whole(Path(options.file).with_suffix(".svg"), heat_map(asked.families, told, TITLE))
    write_whole(options.file, rewritten(page, map_part(asked, told)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
