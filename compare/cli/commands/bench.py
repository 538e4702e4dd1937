"""`truebreak bench`: run time against error, scene by scene and engine by engine, on this computer."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

from ....scenarios.errors import SceneError
from ...engines import split_engines
from ...grids.computer import LEAST_PROCESSES, MOST_PROCESSES
from ...writing import check_writable, write_whole
from .. import completion
from ..options import JSON, STORE, Whole, a_file
from ..progress import DONE, ExitCode, duration, showing

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from ...grids.grid import Done
    from ...report.speed_report import Against, Report

TRADEOFFS = "tradeoffs"
"""What is measured, by name: it may be left out."""


def run(
    *,
    as_json: bool = False,
    scenes: Sequence[str] = (),
    engines: Sequence[str] = (),
    processes: int = LEAST_PROCESSES,
    compared: str | None = None,
    store: str | None = None,
    svg: str | None = None,
) -> tuple[Report, Against | None]:
    """Measures, and prints the report on stdout: tables, or one JSON object. Progress goes to stderr.

    Raises:
        SceneError: for an unknown name, a file that cannot be used, and one of other scenes or another version.
    """
    from ...grids.tradeoffs import digest_of, subjects
    from ...report import speed_report

    then = None if compared is None else speed_report.load(compared, "--against")
    asked = {subject.name: digest_of(subject) for subject in subjects(scenes)}
    if then is not None and compared is not None:
        speed_report.check_scenes(asked, then, compared)
    if svg is not None:
        from ...picture import svg_path

        check_writable(svg_path(svg))
    with _showing() as show:
        report = speed_report.measure(scenes=scenes, engines=engines, store=store or ":memory:", progress=show,
                         processes=(processes, max(processes, MOST_PROCESSES) if processes > 1 else 1))  # fmt: skip
    if svg is not None:
        from ...picture import svg_path
        from ...report.pictures.tradeoff_plot import tradeoff_plot

        write_whole(svg_path(svg), tradeoff_plot(report.tradeoffs))
    held = None if then is None else speed_report.against(report, then)
    _print(report, held, as_json)
    return report, held


def _print(report: Report, held: Against | None, as_json: bool) -> None:
    from ...report.output import console, say
    from ...report.speed_report import tables

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


def _words(context: click.Context, parameter: click.Parameter, value: str | None) -> list[str]:
    return [] if value is None else [word.strip() for word in value.split(",") if word.strip()]


def _engines(context: click.Context, parameter: click.Parameter, value: str | None) -> list[str]:
    return [] if value is None else split_engines(value)


def _name(context: click.Context, parameter: click.Parameter, value: str) -> str:
    if value != TRADEOFFS:
        raise SceneError(f"benchmark {value!r} is not known; there is {TRADEOFFS!r} (the README's ratios are measured "
                         "in the repository: python docs/studies/speed_ratios.py)")  # fmt: skip
    return value


def _subjects(context: click.Context, parameter: click.Parameter, typed: str) -> list[CompletionItem]:
    """What a shell offers: the scenes of the table."""
    from ...grids.tradeoffs import SUBJECTS

    return completion.among([subject.name for subject in SUBJECTS])(context, parameter, typed)


@click.command(
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="\b\nExamples:\n"
    "  truebreak bench --scenes gas,cradle --svg tradeoffs.svg\n"
    "  truebreak bench --json > before.json\n"
    "  truebreak bench --against before.json\n\n"
    "With --against: 0 all ratios agree within 15 %, 1 one does not, 4 one does not and the machine was not idle.",
)
@click.argument("name", default=TRADEOFFS, metavar="[tradeoffs]", callback=_name, expose_value=False,
                shell_complete=completion.among([TRADEOFFS]))  # fmt: skip
@click.option(
    "--scenes",
    callback=_words,
    metavar="A,B,...",
    shell_complete=_subjects,
    help="These scenes alone.",
)
@click.option(
    "--engines", callback=_engines, metavar="A,B,...", shell_complete=completion.engines, help="These beside exact."
)
@click.option(
    "--processes",
    type=Whole(1),
    default=LEAST_PROCESSES,
    show_default=True,
    metavar="N",
    help="Fresh processes for each row, more while they differ; 1 for a quick look.",
)
@a_file("--svg", help="Also write the plot of time against digits.")
@a_file("--against", "compared", help="Compare the ratios with those of an earlier --json.")
@STORE
@JSON
def bench(
    scenes: list[str],
    engines: list[str],
    processes: int,
    svg: str | None,
    compared: str | None,
    store: str | None,
    as_json: bool,
) -> int:
    """Measure run time against error.

    Of ten scenes in every engine, at several settings. Each answer is compared with the certified run. Each row runs in
    processes of its own, in turns with a loop of Python that shows whether the machine was idle; memory is the peak of
    that process while it ran, above what it held before.
    """
    _, held = run(as_json=as_json, scenes=scenes, engines=engines, processes=processes, compared=compared, store=store,
                  svg=svg)  # fmt: skip
    if held is not None and not held.changes:
        return ExitCode.UNDECIDED
    if held is None or not held.beyond:
        return DONE
    return ExitCode.DIVERGED if held.comparable else ExitCode.UNDECIDED


@contextmanager
def _showing() -> Iterator[Callable[[Done], None]]:
    """A line on stderr: how many are done, their rate and the time left, and what was measured last."""
    with showing("measuring") as show:

        def told(done: Done) -> None:
            if show is None:
                click.echo(f"measured {done.label} ({done.there} of {done.wanted} done)", err=True)
            else:
                left = "" if done.left is None else f", {duration(done.left)} left"
                show(f"measuring: {done.there} of {done.wanted} done{left}; last: {done.label}")

        yield told
