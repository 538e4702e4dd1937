"""`truebreak diff`: two or more runs of any engine, in any world, compared by their logs."""

from __future__ import annotations

import click

from .. import completion
from ..options import HTML, JSON, exit_zero
from ..progress import ExitCode

EPILOG = """
\b
The first line of the report begins with one of:
  identical                                 to the last bit
  harmless order                            independent events are reordered
  grew from rounding at event K             what differs first is rounding
  changed at event K by more than rounding  what differs first is no rounding
  different from the start                  another start, setting or step
  not determined                            the logs do not show it; why
K is the step, where logs have steps, else the number of the event, from 0.

\b
Examples:
  truebreak diff pc.jsonl phone.jsonl
  truebreak diff host.jsonl a.jsonl b.jsonl --html desync.html
  truebreak diff checksums-a.txt checksums-b.txt     a hash a line
  truebreak diff a.jsonl b.jsonl --ignore frame_ms
  truebreak diff a.jsonl b.jsonl --scene gas:n=10    audits each run, too

\b
Exit codes:
  0 identical, or harmless order   1 anything else   2 a log not to be read
"""


@click.command(epilog=EPILOG)
@click.argument("logs", metavar="A B [C ...]", nargs=-1, required=True, shell_complete=completion.files)
@click.option("--ignore", metavar="NAME,...", help="Free fields that are not compared; time: nor are clocks.")
@click.option("--scene", metavar="SCENE", shell_complete=completion.scenes, help="What the runs are of: audits them.")
@exit_zero("Exit with 0 where logs differ, too.")
@JSON
@HTML
def diff(
    logs: tuple[str, ...], ignore: str | None, scene: str | None, exit_zero: bool, as_json: bool, html: str | None
) -> int:
    """Compare the logs of runs of any engine, in any world.

    Says where they part first, to the last bit, how the difference grew, and whether it began as rounding, as a change,
    or from the start; "not determined" where the logs do not show it. A log is a file of JSON lines, CSV, or a list of
    hashes. Several logs are each compared with the first.
    """
    from ...logdiff.desync import diff as compared
    from ...logdiff.desync import report, report_json
    from ...report.listing import print_json
    from ...report.output import console, say
    from ...scene_argument import scene_from
    from ...writing import check_writable, write_whole

    if len(logs) < 2:
        raise click.UsageError("name two logs, or more", click.get_current_context())
    if html is not None:
        check_writable(html)
    ignored = [name.strip() for name in (ignore or "").split(",") if name.strip()]
    known = None if scene is None else scene_from(scene)
    found = [compared(logs[0], other, ignore=ignored, scene=known) for other in logs[1:]]
    if html is not None:
        from ...report.desync_page import desync_html
        from ..options import command_of

        write_whole(html, desync_html(found, command=command_of(click.get_current_context())))
    if as_json:
        print_json(report_json(found))
    else:
        out = console()
        for line in report(found):
            say(out, line)
    same = all(one.verdict.same for one in found)
    return ExitCode.DONE if same or exit_zero else ExitCode.DIVERGED
