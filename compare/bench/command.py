"""Measures speed: runs the figures and the table of run time against error, and prints what they gave."""

from __future__ import annotations

import json
import time as clock
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from textwrap import fill
from typing import Any

import click

from ...scenarios.errors import SceneError
from ..adapters.adapter import NotInstalled
from ..cli.arguments import completion
from ..cli.arguments.numbers import Whole
from ..cli.arguments.options import a_file
from ..cli.exit_codes import DONE, ExitCode
from ..cli.progress import duration, showing
from ..cli.writing import check_writable, write_whole
from ..engines import split_engines, suggestion
from .computer import Took, calibration, computer, idleness
from .ratios.figures import FULL, SHORT, Figure, Workload
from .ratios.table import BENCHMARKS
from .reported.against import Against, against
from .reported.report import Report, check_scenes, idleness_of, load, rows_of, worst
from .subjects import SUBJECTS, digest_of, subjects
from .tradeoff import LEAST_PROCESSES, MOST_PROCESSES, Tradeoff, tradeoffs

TRADEOFFS = "tradeoffs"
"""The name of the table of run time against error, beside the figures."""


def chosen(only: Sequence[str]) -> tuple[str, ...]:
    """The names to measure: all, or those asked for.

    Raises:
        SceneError: for an unknown name.

    >>> chosen(["tradeoffs", "gas-long"])
    ('gas-long', 'tradeoffs')
    """
    known = (*BENCHMARKS, TRADEOFFS)
    for name in only:
        if name not in known:
            raise SceneError(f"benchmark {name!r} is not known; {suggestion(name, list(known))}")
    return tuple(name for name in known if name in only) if only else known


def measure(
    size: Workload = SHORT,
    only: Sequence[str] = (),
    *,
    scenes: Sequence[str] = (),
    engines: Sequence[str] = (),
    processes: tuple[int, int] = (LEAST_PROCESSES, MOST_PROCESSES),
    kept: dict[str, Any] | None = None,
    progress: Callable[[str, int, int], None] | None = None,
) -> Report:
    """Measures all figures, or those named, one after the other.

    Args:
        size: how much work each figure does.
        only: names of figures; none means all.
        scenes, engines: of the table of run time against error; none means all.
        processes: the fewest and the most for each of its rows.
        kept: an earlier report, whose scenes are taken over instead of measured.
        progress: called with the name of each, how many are done, and how many there are, before it starts.

    Raises:
        SceneError: for an unknown name.
    """
    figures: list[Figure] = []
    rows: list[Tradeoff] = []
    skipped: dict[str, str] = {}
    took: list[Took] = []
    loops: list[Took] = []
    names, table = chosen(only), subjects(scenes)
    for place, name in enumerate(names):
        if progress is not None and name != TRADEOFFS:
            progress(name, place, len(names))
        loops += calibration()
        try:
            if name == TRADEOFFS:
                old = () if kept is None else rows_of(kept)
                there = {row.scene for row in old}
                fresh = tradeoffs(
                    [subject for subject in table if subject.name not in there],
                    engines,
                    processes=processes,
                    progress=progress,
                )
                order = [subject.name for subject in SUBJECTS]
                rows = sorted([*old, *fresh], key=lambda row: order.index(row.scene))
                took, loops = [t for row in fresh for t in row.took], [*loops, *(t for row in fresh for t in row.loop)]
            else:
                figures.append(BENCHMARKS[name](size))
        except NotInstalled as missing:
            skipped[name] = str(missing)
        loops += calibration()
    unsteady = [row.name for row in rows if row.took and not row.steady]
    now = idleness(took, loops, unsteady)
    told = now if kept is None else worst([now, idleness_of(kept)])
    return Report(tuple(figures), tuple(rows), skipped, told)


def run(
    *,
    full: bool = False,
    as_json: bool = False,
    only: Sequence[str] = (),
    size: Workload | None = None,
    scenes: Sequence[str] = (),
    engines: Sequence[str] = (),
    processes: int = LEAST_PROCESSES,
    compared: str | None = None,
    keep: str | None = None,
    svg: str | None = None,
) -> tuple[Report, Against | None]:
    """Measures, and prints the report on stdout: tables, or one JSON object. Progress goes to stderr.

    With `full`, perfect-physics gets the scene of 314 collisions, which takes it about a minute.

    Raises:
        SceneError: for an unknown name, a file that cannot be used, and one of other scenes or another version.
    """
    then = None if compared is None else load(compared, "--against")
    kept = None if keep is None else load(keep, "--keep")
    asked = {s.name: digest_of(s) for s in subjects(scenes)} if TRADEOFFS in chosen(only) else {}
    _check_files(asked, then, compared, kept, keep)
    if svg is not None:
        from ..report.pictures.picture import svg_path

        if not asked:
            raise SceneError(f"--svg {svg!r}: the plot is that of {TRADEOFFS!r}; name it too")
        check_writable(svg_path(svg))
    with _showing() as show:
        report = measure(size or (FULL if full else SHORT), only, scenes=scenes, engines=engines,
                         processes=(processes, max(processes, MOST_PROCESSES) if processes > 1 else 1),
                         kept=kept, progress=show)  # fmt: skip
    if svg is not None:
        from ..report.pictures.picture import svg_path
        from ..report.pictures.tradeoff_plot import tradeoff_plot

        write_whole(svg_path(svg), tradeoff_plot(report.tradeoffs))
    held = None if then is None else against(report, then)
    _print(report, held, as_json)
    for name, reason in report.skipped.items():
        click.echo(f"{name}: not measured: {reason}", err=True)
    return report, held


def _check_files(
    asked: dict[str, str | None],
    then: dict[str, Any] | None,
    compared: str | None,
    kept: dict[str, Any] | None,
    keep: str | None,
) -> None:
    """Refuses files of other scenes before anything is measured.

    Raises:
        SceneError: naming the file, the first difference and the remedy.
    """
    if then is not None and compared is not None:
        check_scenes(asked, then, compared)
    if kept is not None:
        there = {row["scene"]: row["digest"] for row in kept["tradeoffs"]}
        strange = sorted(name for name, digest in there.items() if name not in asked or asked[name] != digest)
        if strange:
            raise SceneError(f"--keep {keep!r}: has the scene {strange[0]!r}, which is not asked for, or is another")
        if kept["machine"] != computer():
            raise SceneError(f"--keep {keep!r}: was measured on another machine; measure all on one")


def _print(report: Report, held: Against | None, as_json: bool) -> None:
    from ..report.text.output import console, say
    from .reported.tables import tables

    out = console()
    if as_json:
        print(json.dumps(report.data(), indent=1))
    else:
        for table in tables(report):
            out.print(table)
        say(out, str(report.idleness))
    if held is not None:
        for line in held.sentences():
            click.echo(line, err=as_json)


def main(arguments: list[str]) -> int:
    """`truebreak bench` with these arguments; the exit code.

    Raises:
        SceneError: for an unknown name.
        click.UsageError: for arguments that it does not take.
    """
    with command.make_context("truebreak bench", arguments) as context:
        return command.invoke(context)


NAMES = {
    **{name: " ".join(str(measured.__doc__).split()) for name, measured in BENCHMARKS.items()},
    TRADEOFFS: "Run time against error, scene by scene and engine by engine.",
}


def _words(context: click.Context, parameter: click.Parameter, value: str | None) -> list[str]:
    return [] if value is None else [word.strip() for word in value.split(",") if word.strip()]


def _engines(context: click.Context, parameter: click.Parameter, value: str | None) -> list[str]:
    return [] if value is None else split_engines(value)


@click.command(
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="\b\nNAME is one of these, or all without one:\n"
    + "\n".join(fill(f"{n}: {NAMES[n]}", 78, initial_indent="  ", subsequent_indent="    ") for n in NAMES)
    + "\n\n\b\nExamples:\n"
    "  truebreak bench gas-double\n"
    "  truebreak bench tradeoffs --scenes gas,cradle --svg tradeoffs.svg\n"
    "  truebreak bench tradeoffs --json > before.json\n"
    "  truebreak bench tradeoffs --against before.json\n\n"
    "With --against: 0 all ratios agree within 15 %, 1 one does not, 4 one does not and the machine was not idle.",
)
@click.argument("names", nargs=-1, metavar="[NAME]...", shell_complete=completion.among(NAMES))
@click.option("--full", is_flag=True, help="Give perfect-physics 314 collisions: about a minute.")
@click.option(
    "--scenes",
    callback=_words,
    metavar="A,B,...",
    shell_complete=completion.among([subject.name for subject in SUBJECTS]),
    help="Of tradeoffs: these scenes alone.",
)
@click.option(
    "--engines",
    callback=_engines,
    metavar="A,B,...",
    shell_complete=completion.engines,
    help="Of tradeoffs: these beside exact.",
)
@click.option(
    "--processes",
    type=Whole(1),
    default=LEAST_PROCESSES,
    show_default=True,
    metavar="N",
    help="Of tradeoffs: fresh processes for each row, more while they differ; 1 for a quick look.",
)
@a_file("--svg", help="Of tradeoffs: also write the plot of time against digits.")
@a_file("--against", "compared", help="Compare the ratios with those of an earlier --json.")
@a_file("--keep", help="Of tradeoffs: take the scenes of an earlier --json over.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of tables.")
def command(
    names: tuple[str, ...],
    full: bool,
    scenes: list[str],
    engines: list[str],
    processes: int,
    svg: str | None,
    compared: str | None,
    keep: str | None,
    as_json: bool,
) -> int:
    """Measure speed and print the figures, each a ratio of two things timed in one run.

    `tradeoffs` sets run time against error: ten scenes, every engine, several settings, each answer held against the
    certified run. Each row runs in processes of its own, in turns with a loop of Python that tells whether the machine
    was idle; memory is the peak of that process while it ran, above what it held before.
    """
    _, held = run(full=full, as_json=as_json, only=names, scenes=scenes, engines=engines, processes=processes,
                  compared=compared, keep=keep, svg=svg)  # fmt: skip
    if held is not None and not held.changes:
        return ExitCode.UNDECIDED
    if held is None or not held.beyond:
        return DONE
    return ExitCode.DIVERGED if held.told else ExitCode.UNDECIDED


@contextmanager
def _showing() -> Iterator[Callable[[str, int, int], None]]:
    """A line on stderr: what is measured, how many are done, their rate and the time left."""
    began = clock.monotonic()
    with showing("measuring") as show:

        def told(name: str, done: int, total: int) -> None:
            if show is None:
                click.echo(f"measuring {name} ({done} of {total} done)", err=True)
                return
            seconds, text = clock.monotonic() - began, f"measuring {name}: {done} of {total} done"
            if done:
                text += f", {60 * done / seconds:.0f} a minute, {duration(seconds / done * (total - done))} left"
            show(text)

        yield told
