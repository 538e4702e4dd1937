"""`truebreak judge` and `truebreak export`: logs of any engine, and the scene in doubles that it starts from."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from ....scenarios.errors import SceneError
from .. import completion
from ..options import SCENE, SCENE_HELP, ReferenceOptions, Whole, a_file, examples, exit_zero, reference_options
from ..progress import DONE, of_comparison

if TYPE_CHECKING:
    from ....scenarios.scene import Scene
    from ...foreign.log_engine import LogEngine

LOG_HELP = f"""{SCENE_HELP}

\b
LOG is JSON lines, one event a line; or CSV, if its name ends in .csv:
  {{"time": 1.25, "contact": ["a", "b"]}}
  {{"time": 2.5, "contact": ["b", "w1"], "states": {{"b": [7.0, 0.5, -1, 0]}}}}
  {{"time": 3.0, "contacts": [["a", "b"], ["b", "c"]]}}  at one instant
  {{"time": 4.5, "states": {{...}}, "carried": {{"c": "w1"}}}}  what walls carry
  {{"end": 290.7}}                                     nothing happened up to it
  {{"end": 290.7, "quiet": true}}                      nor will ever anything
\b
  time,a,b                                           CSV begins like this
  1.25,a,b
  290.7,,                                            the end

A state is x, y, vx, vy as the event leaves a circle. With states, every step of the log is audited, each flight, gap
and impulse, on the log's own numbers. Without states, where circles are is reckoned from the times by the laws, and
whether the engine keeps them is not determined. A log without an end ends at its last event.

\b
Examples:
  truebreak export gas:seed=3 --floats > scene.json  what it starts from
  truebreak judge gas:seed=3 log.jsonl --events 200
  truebreak judge gas:seed=3 log.csv --bits 24       one in single precision
  truebreak judge cradle steps.jsonl --step 1/256    one that goes by steps
  truebreak judge gas:seed=3 old.jsonl new.jsonl     did a change matter?

Exit codes are those of `compare`: 0 agree, 1 diverged or a law not kept, 2 a log that cannot be judged, 4 undecided or
not settled.
"""


@click.command(epilog=LOG_HELP)
@SCENE
@click.argument("logs", metavar="LOG...", shell_complete=completion.files, nargs=-1, required=True)
@click.option("--bits", type=Whole(1), default=53, show_default=True, metavar="N", help="Of its numbers.")
@click.option("--step", metavar="DT", help="Its time step, if it has one: exact text such as 1/240.")
@click.option("--exact-input", is_flag=True, help="It does not round the scene's numbers to its bits.")
@click.option(
    "--lacks",
    default="capture",
    show_default=True,
    metavar="KEY,...",
    help="Keys of a scene that it does not follow: wall, pocket, capture, gravity, restitution, reverse_at, ...",
)
@reference_options
@exit_zero("Exit with 0 even if a log diverged, breaks a law, or is undecided.")
def judge(
    scene: str,
    logs: tuple[str, ...],
    bits: int,
    step: str | None,
    exact_input: bool,
    lacks: str,
    asked: ReferenceOptions,
    exit_zero: bool,
) -> int:
    """Judge the log of any engine, in any language. Does it have the reference's events, by the laws?

    The report is that of `compare`. Where the log has states, every step is audited. Without --until and --events, a
    log is judged as far as it goes. A log cannot be run on: where it ends too early to tell, the verdict is "not
    settled", and the report says how far to record. With several logs, it says from each to the next whether the
    verdict changed, or whether the law is kept.
    """
    from ....scenarios.trajectory import StopReason
    from ...comparison import compare
    from ...report.documents import comparison_json
    from ...report.listing import print_json
    from ...report.output import console, say
    from ...report.terminal import print_comparison
    from ...writing import check_writable, write_whole
    from ..progress import showing_progress

    loaded = asked.scene(scene)
    if asked.html is not None:
        check_writable(asked.html)
    engines = [_log(path, loaded, bits, step, exact_input, lacks) for path in logs]
    limits: dict[str, Any] = {"until": asked.until, "events": asked.events}
    shortest = ""
    if asked.until is None and asked.events is None:
        limits, shortest = _as_far_as(engines, loaded)
    with showing_progress(loaded.name) as progress:
        comparison = compare(
            loaded,
            engines,
            **limits,
            reference=asked.engine(),
            max_seconds=asked.max_seconds,
            progress=progress,
        )
    if asked.certified:
        from ...certificate.certified import certified

        comparison = replace(comparison, certificate=certified(comparison.reference))
    from ...files.amounts import counted
    from ...report.changes import changes_of

    if comparison.reference.stop.reason is not StopReason.HORIZON:  # it ends before that of itself
        shortest = ""
    changes = changes_of(comparison, shortest)
    if asked.html is not None:
        from ...report.html import html_report
        from ..options import command_of

        write_whole(asked.html, html_report(comparison, command=command_of(click.get_current_context())))
    if asked.as_json:
        print_json(comparison_json(comparison, changes))
    else:
        print_comparison(comparison, verbose=asked.verbose, scene=scene)
        out = console()
        for log, candidate in zip(engines, comparison.candidates, strict=False):
            for hint in log.undeclared() if candidate.lawless or candidate.verdict == "diverged" else ():
                say(out, f"{candidate.engine}: {hint}.")
            for note in candidate.trajectory.notes:
                say(out, f"{candidate.engine}: {note}.")
            if (together := candidate.alignment.taken_together) and log.step is not None:
                of = f"{together:,} of the exact run's {counted(len(comparison.reference.events), 'event')}"
                say(out, f"{candidate.engine}: {of} come within two of its steps of the one before: one contact there.")
            if candidate.laws is not None and candidate.laws.bounces is not None:
                say(out, f"{candidate.engine}: {candidate.laws.bounces}.")
        for change in changes:
            say(out, change.sentence, "bold")
        if shortest:
            say(out, f"All logs are judged {shortest}; judge one by itself to go as far as it does.")
    return DONE if exit_zero else of_comparison(comparison)


def _log(path: str, scene: Scene, bits: int, step: str | None, exact_input: bool, lacks: str) -> LogEngine:
    """The engine of one log, with what the command line declares of it."""
    from ....scenarios.engine import ALL_KEYS
    from ....scenarios.settings import positive_time
    from ...engines import suggestion
    from ...foreign.log_engine import LogEngine

    missing = frozenset(filter(None, (key.strip() for key in lacks.split(","))))
    for key in sorted(missing - ALL_KEYS):
        raise SceneError(f"--lacks: {key!r} is no key; {suggestion(key, sorted(ALL_KEYS))}")
    length = positive_time("--step", step)
    dt = None if length is None else float(length)
    return LogEngine.of(path, scene, bits=bits, step=dt, rounds_input=not exact_input, lacks=missing)


def _as_far_as(engines: list[LogEngine], scene: Scene) -> tuple[dict[str, Any], str]:
    """Limits that no log goes beyond: the earliest end of those that are not over, and the scene's own; and which log
    ends there, in words, where others go on."""

    ends = {log.name: float(log.last.final_time) for log in engines if not log.over}
    if not ends:
        return {}, ""
    name = min(ends, key=lambda key: ends[key])
    if ends[name] <= 0:
        raise SceneError(f"file {name!r}: ends at time 0, so that there is nothing to judge; record it farther")
    if scene.until is not None and float(scene.until) <= ends[name]:
        return {}, ""
    shown = {log.name: "" if log.over else f"{ends[log.name]:.9g}" for log in engines}
    told = f"up to time {shown[name]}, where {name} ends" if len({*shown.values()}) > 1 else ""
    return {"until": ends[name], "events": scene.events}, told


@click.command(epilog=examples("export"))
@SCENE
@click.option(
    "--floats", is_flag=True, help="In the nearest doubles, each with its error, for a program that counts so."
)
@click.option("--csv", "as_csv", is_flag=True, help="With --floats: rows instead of JSON, easy to read in C.")
@a_file("--out", help="Write there instead of to stdout.")
def export(scene: str, floats: bool, as_csv: bool, out: str | None) -> int:
    """Write a scene for another program, exactly or in doubles. Exactly, it is a scene file in JSON.

    With --floats every number is the nearest double, and comes with its error: the exact number less the double. With
    --csv a row is `circle,ID,x,y,r,vx,vy,m`, `wall,ID,x0,y0,x1,y1` or `pocket,ID,x,y,r`, and the errors follow in the
    same order; the mass of a fixed circle is `inf` there, and null in JSON.
    """
    from ....scenarios.files import dump_json
    from ...report.listing import laid_out
    from ...scene_argument import scene_from
    from ...writing import write_whole

    if as_csv and not floats:
        raise SceneError("--csv: rows hold doubles; add --floats")
    loaded = scene_from(scene)
    from ...report.floats import floats_csv, floats_json

    text = floats_csv(loaded) if as_csv else laid_out(floats_json(loaded)) if floats else dump_json(loaded)
    if out is not None:
        write_whole(out, text if text.endswith("\n") else f"{text}\n")
    else:
        click.echo(text, nl=not text.endswith("\n"))
    return DONE
