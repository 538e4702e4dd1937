"""`truebreak sweep`: a comparison for each scene of a family, kept in a file, and what the family says."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .. import completion
from ..options import AGAINST, EVENTS, GRID_HTML, JOBS, JSON, REPORTS, SCENE_HELP, WORK, a_file, isolating, some_engines
from ..progress import DONE, ExitCode, duration, showing

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from ....scenarios.scene import Scene
    from ...grids.grid import Done
    from ...grids.row import Row
    from ...grids.store import Store

EPILOG = f"""
{SCENE_HELP}

\b
Examples:
  truebreak sweep gas --vary n=3..5 --vary seed=1..20 --store gas.db
  truebreak sweep --store gas.db --csv -   the table, without running anything
  truebreak sweep gas --vary seed=1..100 --perturb 1e-12 --csv gas.csv
  truebreak sweep gas --vary seed=1..50 --engines double,pymunk:dt=1/256
  truebreak sweep gas --vary seed=1..4000 --shard 3/40 --store part3.db
  truebreak sweep gas --vary seed=1..4000 --executor dask://10.0.0.7:8786

Call it again with the same store, and it goes on where it stopped, whatever
ended it.
"""


@click.command(epilog=EPILOG)
@click.argument("scene", metavar="[SCENE]", required=False, shell_complete=completion.scenes)
@click.option(
    "--vary",
    multiple=True,
    metavar="KEY=VALUES",
    help="A parameter of the scene: n=3..20, seed=0..90:10 or gap=0,1/10. Several make a grid.",
)
@some_engines("What to compare with the certified runs.", "double")
@click.option(
    "--perturb",
    multiple=True,
    metavar="D",
    help="Also the certified run of each scene with its circles displaced by up to D (1e-12, or 10**-20).",
)
@click.option(
    "--outcome",
    multiple=True,
    metavar="NAME",
    help="Whether this outcome changes too; engines then run to the end, and not only until they diverge.",
)
@click.option(
    "--causes", is_flag=True, help="Also find out why each engine diverged, by experiment: many times the work."
)
@click.option(
    "--no-audit", is_flag=True, help="Do not audit the steps of each run: whether the laws are kept is then not known."
)
@click.option("--forecast", is_flag=True, help="Also predict when each engine diverges: several times the work.")
@EVENTS
@WORK
@a_file("--store", multiple=True, help="Keep the rows in this SQLite file, and resume from it.")
@a_file("--csv", "csv_file", help="Write the table here; - is stdout.")
@click.option("--shard", default="1/1", metavar="K/N", help="Do only the Kth of N parts.")
@JOBS
@click.option(
    "--executor",
    "executor_text",
    metavar="dask://HOST:PORT",
    help="Workers of a Dask cluster, in place of processes here.",
)
@a_file("--svg", help="Draw how long each engine's histories stay true, as one SVG file.")
@GRID_HTML
@AGAINST
@REPORTS
@click.option("--yes", is_flag=True, help="Run a sweep of more than 100,000 scenes without being asked.")
@isolating
@JSON
def sweep(
    scene: str | None,
    vary: tuple[str, ...],
    engines: str,
    perturb: tuple[str, ...],
    outcome: tuple[str, ...],
    causes: bool,
    no_audit: bool,
    forecast: bool,
    events: int | None,
    work: int | None,
    store: tuple[str, ...],
    csv_file: str | None,
    shard: str,
    jobs: int | None,
    executor_text: str | None,
    svg: str | None,
    html: str | None,
    against: str | None,
    reports: bool,
    yes: bool,
    as_json: bool,
) -> int:
    """Compare engines on a whole family of scenes.

    Each scene runs in a worker process; each engine only until it diverges. Rows go into the store as soon
    as they are there. Without a SCENE, stores are read and nothing is run; several, such as shards, make one table.
    """
    from ...engines import split_engines
    from ...grids.family_sweep import csv_parts, plan
    from ...grids.grid import carry_out
    from ...grids.store import Store, merged
    from ...grids.survival import summaries, uncertainty
    from ...report.documents import sweep_json
    from ...report.grid_tables import print_sweep
    from ...report.listing import print_json
    from ...report.pictures.sweep_plots import survival_svg
    from ...writing import check_writable, write_whole

    for file in (csv_file, svg, html):
        if file not in (None, "-"):
            check_writable(file)
    check_reports(html, reports)
    before = earlier_rows(against, html, store)
    if executor_text is not None and (jobs is not None or scene is None):
        raise click.UsageError("--executor brings its own workers, to run a SCENE: leave --jobs out, and give a SCENE")
    if csv_file == "-" and as_json:
        raise click.UsageError("--csv - and --json both want stdout; write one of them to a file")
    if scene is None:
        if not store:
            raise click.UsageError("nothing to do: give a SCENE to run, or a --store to read")
        rows = merged(store)
        _tell_missing(rows)
    else:
        if len(store) > 1:
            raise click.UsageError("several stores can be read, and one be written to; give one --store")
        asked = plan(scene, vary, split_engines(engines), events=events, perturb=perturb, outcomes=outcome,
                     causes=causes, work=work, shard=shard, audit=not no_audit, forecast=forecast)  # fmt: skip
        _ask(len(asked.family), yes)
        rows = Store(store[0] if store else ":memory:", asked.settings)
        with _workers(executor_text, jobs) as (executor, count), showing_done(asked.family.scene, "scenes") as show:
            carry_out(asked, rows, jobs=count, executor=executor, progress=show)
        rows.verify()
    settings = rows.settings
    keys = [text.partition("=")[0] for text in settings["vary"]]
    if csv_file == "-":
        sys.stdout.writelines(csv_parts(rows, keys))
    elif csv_file is not None:
        write_whole(csv_file, csv_parts(rows, keys))
    told = summaries(rows) if svg is not None or html is not None or as_json or csv_file != "-" else []
    if svg is not None:
        write_whole(svg, survival_svg(told))
    if html is not None:
        limits = {row.index: (None, settings["events"]) for row in rows} if reports else {}
        title = " ".join([settings["scene"], *settings["vary"]])
        changes = changes_since(before, rows)
        write_page(html, title, rows, reports, limits, pictures=[survival_svg(told)], changes=changes)
    unsure = {name: uncertainty(rows, name) for name in settings["outcomes"] if _displaced(settings)}
    if as_json:
        print_json(sweep_json(settings, rows.scenes, told, rows.failures(), unsure))
    elif csv_file != "-":
        print_sweep(settings, rows.scenes, told, unsure)
    return came_to_nothing(rows)


def check_reports(html: str | None, reports: bool) -> None:
    """Refuses reports without the page that links to them.

    Raises:
        UsageError: then.
    """
    if reports and html is None:
        raise click.UsageError("--reports are written beside a page: add --html FILE")


def check_against(against: str | None, html: str | None) -> None:
    """Refuses an earlier grid without the page in which what changed since is a column.

    Raises:
        UsageError: then.
    """
    if against is not None and html is None:
        raise click.UsageError("--against is a column of a page: add --html FILE")


def earlier_rows(against: str | None, html: str | None, stores: Iterable[str]) -> Store | None:
    """The rows of before, from the store that was named; None if none was.

    Raises:
        UsageError: without a page, and where it is the store that is written to.
        SceneError: if it is no store.
    """
    from ....scenarios.errors import SceneError
    from ...grids.store import merged

    check_against(against, html)
    if against is None:
        return None
    path = Path(against)
    if not path.exists():
        raise SceneError(f"--against {against!r}: there is no such file; name one that --store has written")
    if any(Path(other).exists() and path.samefile(other) for other in stores):
        raise click.UsageError(f"--against {against!r} is the --store too, which is written to; take a copy of before")
    try:
        return merged([against])
    except SceneError as error:
        raise SceneError(str(error).replace("--store", "--against", 1)) from None


def changes_since(before: Store | None, rows: Store) -> dict[tuple[str, str], str] | None:
    """By scene and engine what changed, in a sentence; None if nothing of before was named.

    Raises:
        SceneError: if the rows of before are of another kind of grid.
    """
    from ....scenarios.errors import SceneError
    from ...grids.suite_file import SuiteReport, since

    if before is None:
        return None
    kind, asked = before.settings.get("grid"), rows.settings.get("grid")
    if kind != asked:
        raise SceneError(f"--against {before.path!r}: is a store of a {kind}; name one of a {asked}")
    return {(one.scene, one.engine): one.sentence for one in since(before, SuiteReport("", rows))}


def write_page(
    file: str,
    title: str,
    rows: Iterable[Row],
    reports: bool,
    limits: Mapping[int, tuple[Any, Any]],
    scene: Callable[[Row], Scene] | None = None,
    **more: Any,
) -> None:
    """Writes the page of a grid, and the reports beside it if they are asked for."""
    from ...report.grid_page import grid_page, write_reports
    from ...writing import write_whole

    links = write_reports(rows, file, limits, scene) if reports else None
    write_whole(file, grid_page(title, rows, links=links, **more))


def came_to_nothing(rows: Store) -> int:
    """Says on stderr which attempts came to nothing; the exit code is 4 if a scene has no rows for that."""
    from ....scenarios.errors import printable

    undone = {scene for scene, _, _ in rows.failures(undone=True)}
    for index, attempt, note in rows.failures():
        after = "" if index in undone else "; another attempt was done"
        told = f"truebreak: scene {index}, attempt {attempt}, came to nothing: {note}{after}"
        click.echo(printable(" ".join(told.split())), err=True)
    return ExitCode.UNDECIDED if undone else DONE


def _tell_missing(rows: Store) -> None:
    """Says on stderr how many scenes of a sweep are not in the stores that are read."""
    from ...grids.scene_family import family

    wanted, there = len(family(rows.settings["scene"], rows.settings["vary"])), rows.scenes
    if there < wanted:
        click.echo(f"truebreak: {there:,} of {wanted:,} scenes are there; the others are in another shard's store, or "
                   "not done yet", err=True)  # fmt: skip


def _displaced(settings: Mapping[str, Any]) -> bool:
    """Whether a sweep displaces its scenes."""
    from ...grids.family_sweep import PERTURBED

    return any(label.startswith(PERTURBED) for label in settings["engines"])


def _ask(scenes: int, yes: bool) -> None:
    """Asks before a very large sweep.

    Raises:
        UsageError: where nobody is there to answer, or the answer is no.
    """
    from ...grids.family_sweep import ASK_FIRST

    if scenes <= ASK_FIRST or yes:
        return
    if not sys.stdin.isatty() or not click.confirm(f"{scenes:,} scenes: run them all?", err=True):
        raise click.UsageError(f"{scenes:,} scenes are to be run; add --yes to do so, or take narrower ranges")


@contextmanager
def _workers(text: str | None, jobs: int | None) -> Iterator[tuple[Executor | None, int | None]]:
    """The executor that was named, and how many jobs it takes; None for processes here."""
    if text is None:
        yield None, jobs
        return
    from ...grids.executors import executor_named

    with executor_named(text) as found:
        yield found


@contextmanager
def showing_done(title: str, what: str) -> Iterator[Callable[[Done], None] | None]:
    """A line on stderr with the rate and the time left; None, and no output, where stderr is not a terminal."""
    with showing(title) as show:
        yield None if show is None else lambda done: show(how_far(title, what, done))


def how_far(title: str, what: str, done: Done) -> str:
    """How far a grid is.

    >>> from truebreak.compare.grids.grid import Done
    >>> how_far("gas", "scenes", Done(30, 80, 1, 12.0, 20, "gas:seed=7"))
    'gas: 30 of 80 scenes, 1.67 a second, 29 s left, 1 failed; last: gas:seed=7'
    """
    rate = f", {done.fresh / done.seconds:.3g} a second" if done.seconds else ""
    left = "" if done.left is None else f", {duration(done.left)} left"
    failed = f", {done.failed} failed" if done.failed else ""
    return f"{title}: {done.there:,} of {done.wanted:,} {what}{rate}{left}{failed}; last: {done.label}"
