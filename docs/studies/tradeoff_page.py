"""`python docs/studies/tradeoff_page.py docs/tradeoffs.json`: the page and the plot of what was measured, beside it.

The file is what `truebreak bench tradeoffs --json` printed. Nothing is measured here.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from truebreak.compare.grids.row import Row
from truebreak.compare.grids.tradeoffs import SUBJECTS, digits_shown, law_shown
from truebreak.compare.report.pictures.tradeoff_plot import tradeoff_plot
from truebreak.compare.report.speed_report import idleness_of, load, rows_of
from truebreak.scenarios.errors import SceneError

HEAD = """# Run time against error, measured

What [each column is](advice.md#run-time-against-error). Made by `python docs/studies/tradeoff_page.py
docs/tradeoffs.json` from [tradeoffs.json](tradeoffs.json), which `truebreak bench tradeoffs --json` printed on a
machine with {cores} cores ({processor}), Python {python}. {idle}

![Digits that are right at the end over run time as a multiple of the exact engine's, a panel a scene](tradeoffs.svg)
"""

COLUMNS = (
    "|  | engine | time / exact | seconds | events agreed | largest error | digits | outcomes | law | memory, MiB |",
    "|---|---|---:|---:|---:|---:|---:|---|---|---:|",
)


def page(data: dict[str, Any]) -> str:
    """The whole page, from a report's JSON."""
    told = data["machine"]
    parts = [HEAD.format(idle=idleness_of(data), **{key: told[key] for key in ("cores", "processor", "python")})]
    specs = {subject.name: subject.spec for subject in SUBJECTS}
    for name, rows in groupby(rows_of(data), key=lambda row: row.scene):
        parts += ["", *section(name, specs[name], list(rows))]
    return "\n".join([*parts, ""])


def section(name: str, spec: str, rows: Sequence[Row]) -> list[str]:
    """One scene: a table of what ran, and why the rest did not."""
    ran, refused = ([row for row in rows if (row.refused is None) is kept] for kept in (True, False))
    lines = [f"## {name}", "", f"`{spec}`, {rows[0].events:,} events."]
    if ran:
        lines += ["", *COLUMNS, *map(_line, ran)]
    if refused:
        lines += ["", *(f"- `{row.engine}`: {row.refused}." for row in refused)]
    return lines


def _line(row: Row) -> str:
    digits = digits_shown(row.digits)
    cells = (
        "*" if row.front else "",
        f"`{row.engine}`",
        f"{row.ratio:.3g}",
        f"{row.seconds:.3g}",
        f"{row.agreed:,}",
        "inf" if row.error is None else f"{row.error:.2g}",
        "" if digits is None else str(digits),
        str(row.verdict) if row.changed is None else f"{len(row.changed)} wrong" if row.changed else "right",
        law_shown(row),
        "" if row.memory is None else f"{row.memory / 2**20:.1f}",
    )
    return f"| {' | '.join(cells)} |"


def made(file: Path) -> dict[Path, str]:
    """The text of each file that is made from a report, by its place.

    Raises:
        SceneError: for a file that is no such report.
    """
    data = load(str(file), "report")
    return {file.with_suffix(".md"): page(data), file.with_suffix(".svg"): tradeoff_plot(rows_of(data))}


def main(arguments: list[str] | None = None) -> int:
    """Writes, or checks; the exit status."""
    parser = argparse.ArgumentParser(prog="python docs/studies/tradeoff_page.py", description=__doc__)
    parser.add_argument("file", type=Path, help="what `truebreak bench tradeoffs --json` printed")
    parser.add_argument("--check", action="store_true", help="write nothing; exit with 1 if a file is not current")
    options = parser.parse_args(arguments)
    try:
        files = made(options.file)
    except SceneError as error:
        print(error, file=sys.stderr)
        return 2
    if options.check:
        return 0 if all(p.is_file() and p.read_text(encoding="utf-8") == text for p, text in files.items()) else 1
    for path, text in files.items():
        path.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
