"""`truebreak suite` and `truebreak survey`: many scenes, many engines, one report."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import click

from .. import completion
from ..options import JSON, Seconds, a_file, isolating, some_engines
from ..progress import DONE, ExitCode, duration, showing

SUITE_HELP = """
\b
FILE is TOML:
  engines = ["double", "box2d:dt=1/1024", "mine=package.module:Class"]
  [[scene]]
  name = "gas:n=5"            of the catalogue, or a file, from FILE's folder
  events = 200
  [[scene]]
  name = "table.toml"
  until = "25/2"
  engines = ["mine=package.module:Class"]     in place of those above
\b
Examples:
  truebreak suite mine.toml
  truebreak suite mine.toml --json > before.json
  truebreak suite mine.toml --against before.json   what did a change change?
  truebreak suite mine.toml --against before.json --only-changes

\b
Exit codes:
  0 all agree, and none is known to break a law
  1 an engine diverged, or breaks the law (--only-changes: something changed)
  2 bad input
  4 none diverged, but something is undecided or not settled
"""

SURVEY_HELP = """
\b
Examples:
  truebreak survey                     every installed engine: some minutes
  truebreak survey --engines box2d,billiards --scenes "cradle, apart;gas"
  truebreak survey --store rows.jsonl  rows are kept; call it again to go on
  truebreak survey --store rows.jsonl --json > survey.json
  truebreak survey --from survey.json --page survey.md   the page of the docs
  truebreak survey --from a.json --from b.json --json > c.json   made in parts
"""


@click.command(epilog=SUITE_HELP)
@click.argument("file", metavar="FILE", shell_complete=completion.files)
@click.option(
    "--against",
    metavar="EARLIER.json",
    shell_complete=completion.files,
    help="What changed since this report, written with --json.",
)
@click.option("--only-changes", is_flag=True, help="With --against: exit with 1 if anything changed, else with 0.")
@click.option("--max-seconds", type=Seconds(), metavar="S", help="What one engine on one scene may take.")
@isolating
@JSON
@click.option("--exit-zero", is_flag=True, help="Exit with 0 whatever diverged, breaks a law, or changed.")
def suite(
    file: str, against: str | None, only_changes: bool, max_seconds: float | None, as_json: bool, exit_zero: bool
) -> int:
    """Hold engines against the truth on many scenes, in one report.

    With --against, it tells too what changed since an earlier one.
    """
    from ....scenarios.errors import SceneError
    from ...report.listing import print_json
    from ...suites.document import suite_json
    from ...suites.running import run_suite
    from ...suites.shown import print_suite
    from ...suites.since import read_report, since
    from ...suites.suite import read_suite

    if only_changes and against is None:
        raise SceneError("--only-changes: changed since what? add --against EARLIER.json")
    asked = read_suite(file)
    earlier = None if against is None else read_report(against)
    with showing_cells(asked.name) as progress:
        report = run_suite(asked, max_seconds=max_seconds, progress=progress)
    changes = None if earlier is None else since(earlier, report)
    if as_json:
        print_json(suite_json(report, changes))
    else:
        print_suite(report, changes)
    if exit_zero:
        return DONE
    if only_changes:
        return ExitCode.DIVERGED if changes else DONE
    if report.lawless:
        return ExitCode.DIVERGED
    return {"agree": DONE, "diverged": ExitCode.DIVERGED}.get(report.verdict, ExitCode.UNDECIDED)


@click.command(epilog=SURVEY_HELP)
@some_engines("Only these.", "")
@click.option("--scenes", default="", metavar="A;B;...", help="Only these, by the names that the report has.")
@click.option("--no-causes", is_flag=True, help="Do not look for causes: a fraction of the work.")
@click.option("--no-advice", is_flag=True, help="Do not look for the cheapest setting that is right.")
@click.option("--max-seconds", type=Seconds(), metavar="S", help="What one run may take, and why it diverged.")
@a_file("--store", help="Keep each row in this file as soon as it is made, and make none that it has.")
@a_file("--from", "recorded", multiple=True, help="Run nothing: show what --json has written.")
@a_file("--page", help="Write the survey as a page in Markdown.")
@isolating
@JSON
def survey(
    engines: str,
    scenes: str,
    no_causes: bool,
    no_advice: bool,
    max_seconds: float | None,
    store: str | None,
    recorded: tuple[str, ...],
    page: str | None,
    as_json: bool,
) -> int:
    """Run every installed engine over twelve scenes. Which history does each tell, and what suits what?

    Each engine is run as it comes, and, where it diverges, at finer settings, the best of which is told; then at the
    cheapest setting that `truebreak advise` finds. It exits with 0 whatever diverged: this is a survey, not a check.
    """
    from ...report.listing import print_json
    from ...suites.document import survey_json
    from ...suites.shown import print_survey
    from ...suites.survey import survey as run_survey
    from ...suites.surveys.recorded_survey import read_survey
    from ...suites.surveys.survey_page import page_text
    from ...suites.surveys.survey_store import SurveyStore, survey_settings
    from ...writing import check_writable, write_whole

    if page is not None:
        check_writable(page)
    names = [name.strip() for name in engines.split(",") if name.strip()]
    labels = [label.strip() for label in scenes.split(";") if label.strip()]
    if recorded:
        if store is not None:
            raise click.UsageError("--from runs nothing, and --store keeps what is run; give one of them")
        found = read_survey(recorded)
    else:
        base = None if store is None else SurveyStore(store, survey_settings(not no_causes, not no_advice, max_seconds))
        with showing_cells("survey") as progress:
            found = run_survey(
                names,
                labels,
                causes=not no_causes,
                advice=not no_advice,
                max_seconds=max_seconds,
                progress=progress,
                kept=None if base is None else base.entries,
                keep=None if base is None else base.add,
            )
    if page is not None:
        write_whole(page, page_text(found))
    if as_json:
        print_json(survey_json(found))
    else:
        print_survey(found)
    return DONE


@contextmanager
def showing_cells(title: str) -> Iterator[Callable[[int, int, str], None] | None]:
    """A line on stderr: done, of how many, which is next, the time left; None where stderr is no terminal."""
    began = clock.monotonic()
    with showing(title) as show:
        yield (
            None
            if show is None
            else lambda done, total, label: show(f"{title}: {counted(done, total, clock.monotonic() - began)}: {label}")
        )


def counted(done: int, total: int, seconds: float) -> str:
    """How far it is.

    >>> counted(0, 12, 0.5), counted(3, 12, 6.0)
    ('0 of 12', '3 of 12, 0.5 a second, 18 s left')
    """
    if not done or not seconds:
        return f"{done:,} of {total:,}"
    rate = done / seconds
    return f"{done:,} of {total:,}, {rate:.2g} a second, {duration((total - done) / rate)} left"
