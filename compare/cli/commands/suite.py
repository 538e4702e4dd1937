"""`truebreak suite` and `truebreak survey`: many scenes, many engines, one report."""

from __future__ import annotations

from dataclasses import replace

import click

from .. import completion
from ..options import GRID_HTML, JOBS, JSON, REPORTS, STORE, Seconds, a_file, exit_zero, isolating, some_engines
from ..progress import DONE, ExitCode, showing
from .sweep import came_to_nothing, check_against, check_reports, showing_done, write_page

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
  truebreak survey --store rows.db  rows are kept; call it again to go on
  truebreak survey --store rows.db --json > survey.json
  truebreak survey --from survey.json --page survey.md   the page of the docs
  truebreak survey --from a.json --from b.json --json > c.json   made in parts
  truebreak survey --restitution       asked for e, what do bounces have?
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
@STORE
@JOBS
@GRID_HTML
@REPORTS
@isolating
@JSON
@exit_zero("Exit with 0 whatever diverged, breaks a law, or changed.")
def suite(
    file: str,
    against: str | None,
    only_changes: bool,
    max_seconds: float | None,
    store: str | None,
    jobs: int | None,
    html: str | None,
    reports: bool,
    as_json: bool,
    exit_zero: bool,
) -> int:
    """Compare engines with certified runs of many scenes.

    With --against, it says too what changed since an earlier one.
    """
    from ....scenarios.errors import SceneError
    from ...grids.store import Store
    from ...grids.suite_file import read_report, read_suite, run_suite, since, suite_json
    from ...report.grid_tables import print_suite
    from ...report.listing import print_json
    from ...writing import check_writable

    if only_changes and against is None:
        raise SceneError("--only-changes: changed since what? add --against EARLIER.json")
    check_reports(html, reports)
    if html is not None:
        check_writable(html)
    asked = replace(read_suite(file), max_seconds=max_seconds)
    earlier = None if against is None else read_report(against)[1]
    rows = Store(store or ":memory:", asked.settings)
    with showing_done(asked.name, "scenes") as progress:
        report = run_suite(asked, store=rows, jobs=jobs, progress=progress)
    changes = None if earlier is None else since(earlier, report)
    if html is not None:
        limits = {number: (task.until, task.events) for number, task in enumerate(asked.tasks)}
        since_then = None if changes is None else {(one.scene, one.engine): one.sentence for one in changes}
        write_page(html, asked.name, rows, reports, limits, changes=since_then)
    if as_json:
        print_json(suite_json(report, changes))
    else:
        print_suite(report, changes)
    undone = came_to_nothing(rows)
    if exit_zero:
        return DONE
    if only_changes:
        return ExitCode.DIVERGED if changes else DONE
    if report.lawless:
        return ExitCode.DIVERGED
    code = {"agree": DONE, "diverged": ExitCode.DIVERGED}.get(report.verdict, ExitCode.UNDECIDED)
    return code or undone


def _restitution(engines: list[str], as_json: bool) -> int:
    from ...grids.bounce_survey import survey_of_restitution
    from ...report.documents import document
    from ...report.grid_tables import print_restitution
    from ...report.listing import print_json

    with showing("restitution") as progress:
        found = survey_of_restitution(engines, progress)
    if as_json:
        print_json(document("restitution-1", found))
    else:
        print_restitution(found)
    return DONE


@click.command(epilog=SURVEY_HELP)
@some_engines("Only these.", "")
@click.option("--scenes", default="", metavar="A;B;...", help="Only these, by the names that the report has.")
@click.option("--no-causes", is_flag=True, help="Do not look for causes: a fraction of the work.")
@click.option("--no-advice", is_flag=True, help="Do not look for the cheapest setting that is right.")
@click.option("--restitution", is_flag=True, help="Measure the restitution of each engine's bounces instead.")
@click.option("--max-seconds", type=Seconds(), metavar="S", help="What one run may take, and why it diverged.")
@STORE
@JOBS
@a_file("--from", "recorded", multiple=True, help="Run nothing: show what --json has written.")
@GRID_HTML
@a_file("--against", help="With --html: what changed since this survey, written with --json, as a column.")
@REPORTS
@a_file("--page", help="Write the survey as a page in Markdown.")
@isolating
@JSON
def survey(
    engines: str,
    scenes: str,
    no_causes: bool,
    no_advice: bool,
    restitution: bool,
    max_seconds: float | None,
    store: str | None,
    jobs: int | None,
    recorded: tuple[str, ...],
    html: str | None,
    against: str | None,
    reports: bool,
    page: str | None,
    as_json: bool,
) -> int:
    """Run every installed engine over sixteen scenes. Which reproduces the certified history, and what suits what?

    Each engine is run as it comes, and, where it diverges, at finer settings, the best of which is shown; then at the
    cheapest setting that `truebreak advise` finds. It exits with 0 whatever diverged: this is a survey, not a check.
    """
    from ...grids.engine_survey import limit_of, read_survey, survey_json
    from ...grids.engine_survey import survey as run_survey
    from ...grids.suite_file import since
    from ...report.grid_tables import print_survey
    from ...report.listing import print_json
    from ...report.survey_page import page_text
    from ...writing import check_writable, write_whole

    check_reports(html, reports)
    check_against(against, html)
    before = None if against is None else read_survey([against]).report.rows
    for file in (page, html):
        if file is not None:
            check_writable(file)
    names = [name.strip() for name in engines.split(",") if name.strip()]
    if restitution:
        others = {"--scenes": scenes, "--store": store, "--from": recorded, "--html": html, "--page": page}
        for option, given in others.items():
            if given:
                raise click.UsageError(f"--restitution has scenes and a table of its own; leave {option} out")
        return _restitution(names, as_json)
    labels = [label.strip() for label in scenes.split(";") if label.strip()]
    if recorded:
        if store is not None:
            raise click.UsageError("--from runs nothing, and --store keeps what is run; give one of them")
        found = read_survey(recorded)
    else:
        with showing_done("survey", "rows") as progress:
            found = run_survey(names, labels, store=store or ":memory:", jobs=jobs, progress=progress,
                               causes=not no_causes, advice=not no_advice, max_seconds=max_seconds)  # fmt: skip
    if html is not None:
        tried = found.report.rows
        limits = {row.index: (None, limit_of(row.scene)) for row in tried}
        changes = None if before is None else since(before, found.report)
        since_then = None if changes is None else {(one.scene, one.engine): one.sentence for one in changes}
        write_page(html, "Survey of engines", tried, reports, limits, changes=since_then)
    if page is not None:
        write_whole(page, page_text(found))
    if as_json:
        print_json(survey_json(found))
    else:
        print_survey(found)
    return DONE
