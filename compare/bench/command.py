"""Measures speed: runs the figures and the table of run time against error, and prints what they gave."""

from __future__ import annotations

import json
import platform
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import click

from ..adapters.package import NotInstalled
from ..engines import suggestion
from .figures import BENCHMARKS, FULL, GAS, SHORT, Figure, Size, scene_of
from .tradeoff import Tradeoff, tradeoffs

TRADEOFFS = "tradeoffs"
"""The name of the table of run time against error, beside the figures."""


@dataclass(frozen=True)
class Report:
    """All that was measured.

    Attributes:
        figures: the ratios.
        tradeoffs: run time against error, engine by engine.
        skipped: why a figure is missing, by its name.
    """

    figures: tuple[Figure, ...]
    tradeoffs: tuple[Tradeoff, ...]
    skipped: dict[str, str]

    def data(self) -> dict[str, Any]:
        """The report as JSON has it."""
        return {
            "schema": "truebreak/bench-1",
            "python": platform.python_version(),
            "figures": [figure.data() for figure in self.figures],
            "tradeoffs": [asdict(row) for row in self.tradeoffs],
            "skipped": self.skipped,
        }


def chosen(only: Sequence[str]) -> tuple[str, ...]:
    """The names to measure: all, or those asked for.

    Raises:
        SceneError: for an unknown name.

    >>> chosen(["tradeoffs", "gas-long"])
    ('gas-long', 'tradeoffs')
    """
    from ...scenarios.errors import SceneError

    known = (*BENCHMARKS, TRADEOFFS)
    for name in only:
        if name not in known:
            raise SceneError(f"benchmark {name!r} is not known; {suggestion(name, list(known))}")
    return tuple(name for name in known if name in only) if only else known


def measure(size: Size = SHORT, only: Sequence[str] = (), progress: Callable[[str], None] | None = None) -> Report:
    """Measures all figures, or those named, one after the other.

    Args:
        size: how much work each does.
        only: names of figures; none means all.
        progress: called with the name of each before it starts.

    Raises:
        SceneError: for an unknown name.
    """
    figures: list[Figure] = []
    rows: list[Tradeoff] = []
    skipped: dict[str, str] = {}
    for name in chosen(only):
        if progress is not None:
            progress(name)
        try:
            if name == TRADEOFFS:
                rows.extend(tradeoffs(scene_of(GAS), size.traded))
            else:
                figures.append(BENCHMARKS[name](size))
        except NotInstalled as missing:
            skipped[name] = str(missing)
    return Report(tuple(figures), tuple(rows), skipped)


def run(*, full: bool = False, as_json: bool = False, only: Sequence[str] = (), size: Size | None = None) -> Report:
    """Measures, and prints the report on stdout: tables, or one JSON object. Progress goes to stderr.

    With `full`, perfect-physics gets the scene of 314 collisions, which takes it about a minute.

    Raises:
        SceneError: for an unknown name in `only`.
    """
    from rich.console import Console

    notes = Console(stderr=True)
    size = size or (FULL if full else SHORT)
    report = measure(size, only, lambda name: notes.print(f"measuring {name} ...", style="dim"))
    if as_json:
        print(json.dumps(report.data(), indent=2))
    else:
        for table in _tables(report):
            Console().print(table)
    for name, reason in report.skipped.items():
        notes.print(f"{name}: not measured: {reason}", markup=False)
    return report


def main(arguments: list[str]) -> int:
    """`truebreak bench` with these arguments; the exit code.

    Raises:
        SceneError: for an unknown name.
        click.UsageError: for arguments that it does not take.
    """
    with command.make_context("truebreak bench", arguments) as context:
        command.invoke(context)
    return 0


NAMES = {
    **{name: str(measured.__doc__) for name, measured in BENCHMARKS.items()},
    TRADEOFFS: "Run time against error, engine by engine.",
}


@click.command(
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="\b\nNAME is one of these, or all without one:\n" + "\n".join(f"  {n}: {NAMES[n]}" for n in NAMES),
)
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--full", is_flag=True, help="Give perfect-physics 314 collisions: about a minute.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of tables.")
def command(names: tuple[str, ...], full: bool, as_json: bool) -> None:
    """Measure speed and print the figures, each a ratio of two things timed in one run."""
    run(full=full, as_json=as_json, only=names)


def _tables(report: Report) -> Iterator[Any]:
    from rich.table import Table

    if report.figures:
        table = Table("first / second", title="Ratios, each of two things timed in one run", title_justify="left")
        for heading in ("first (s)", "second (s)", "ratio"):
            table.add_column(heading, justify="right", no_wrap=True)
        table.add_column("target")
        for figure in report.figures:
            table.add_row(
                figure.what,
                f"{figure.numerator:.4g}",
                f"{figure.denominator:.4g}",
                f"{figure.ratio:,.4g}",
                "" if figure.met is None else f"{figure.target}: {'met' if figure.met else 'MISSED'}",
            )
        yield table
    if report.tradeoffs:
        table = Table(title="Run time against error, 10 discs", title_justify="left")
        table.add_column("engine", no_wrap=True)
        for heading in ("seconds", "/ exact", "events agreed", "reached", "largest error"):
            table.add_column(heading, justify="right", no_wrap=True)
        for row in report.tradeoffs:
            table.add_row(
                row.engine,
                f"{row.seconds:.4g}",
                f"{row.ratio:.3g}",
                f"{row.agreed} of {row.events}",
                f"{row.reached:.0%}",
                f"{row.error:.2g}",
            )
        yield table
