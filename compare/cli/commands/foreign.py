"""`truebreak judge` and `truebreak export`: logs of any engine, and the scene in doubles that it starts from."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from ....scenarios.errors import SceneError
from ....scenarios.numbers.quantity import Quantity
from ...files.amounts import no_formula
from .. import completion
from ..options import SCENE, SCENE_HELP, HeldAgainst, Whole, a_file, examples, held_against
from ..progress import DONE, of_comparison

if TYPE_CHECKING:
    from ....scenarios.scene import Scene
    from ....scenarios.things import Circle, Pocket, Wall
    from ...foreign.log_engine import LogEngine

FLOATS_SCHEMA = "truebreak/floats-1"

CIRCLE, WALL, POCKET = ("x", "y", "r", "vx", "vy", "m"), ("x0", "y0", "x1", "y1"), ("x", "y", "r")


def floats_json(scene: Scene) -> dict[str, Any]:
    """The scene in the nearest doubles; each thing has an `error` for each number: the exact one less the double.

    A fixed circle has mass null. Times are doubles too.

    Raises:
        SceneError: for a number beyond the doubles.

    >>> from truebreak.scenarios import Circle, Scene
    >>> floats_json(Scene([Circle("1/3", 0)]))["circles"][0]["error"]["x"]
    1.850371707708594e-17
    """
    data: dict[str, Any] = {
        "schema": FLOATS_SCHEMA,
        "scene": {"name": scene.name, "digest": scene.digest, "tie_policy": str(scene.tie_policy)},
        "circles": [_thing(c, CIRCLE) for c in scene.circles],
        "walls": [_thing(w, WALL) for w in scene.walls],
        "pockets": [_thing(p, POCKET) for p in scene.pockets],
    }
    for key in ("until", "reverse_at"):
        if getattr(scene, key) is not None:
            data[key], data[f"{key}_error"] = double_and_error(getattr(scene, key), key)
    for key in ("events", "reverse_after"):
        if getattr(scene, key) is not None:
            data[key] = getattr(scene, key)
    return data


def floats_csv(scene: Scene) -> str:
    """The same, a row for each thing: `circle,ID,x,y,r,vx,vy,m`, `wall,ID,x0,y0,x1,y1`, `pocket,ID,x,y,r`.

    The errors follow in the same order. The mass of a fixed circle is `inf`, its error 0.

    Raises:
        SceneError: for a number beyond the doubles, and for an id that a spreadsheet would take for a formula.
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    for kind, things, keys in (("circle", scene.circles, CIRCLE), ("wall", scene.walls, WALL),
                               ("pocket", scene.pockets, POCKET)):  # fmt: skip
        for thing in things:
            if no_formula(thing.id) != thing.id:
                told = f"{kind} {thing.id!r}: a spreadsheet takes an id that begins so for a formula"
                raise SceneError(f"{told}; leave out --csv, or write another id")
            pairs = [_pair(thing, key) for key in keys]
            writer.writerow([kind, thing.id, *(repr(d) for d, _ in pairs), *(repr(e) for _, e in pairs)])
    return out.getvalue()


def _thing(thing: Circle | Wall | Pocket, keys: tuple[str, ...]) -> dict[str, Any]:
    pairs = {key: _pair(thing, key) for key in keys}
    row: dict[str, Any] = {"id": thing.id, **{key: _finite(double) for key, (double, _) in pairs.items()}}
    return {**row, "error": {key: error for key, (_, error) in pairs.items()}}


def _pair(thing: Circle | Wall | Pocket, key: str) -> tuple[float, float]:
    value = getattr(thing, key)
    return double_and_error(value, f"{thing.id!r}: {key}") if isinstance(value, Quantity) else (math.inf, 0.0)


def _finite(double: float) -> float | None:
    return double if math.isfinite(double) else None


def double_and_error(value: Quantity, label: str) -> tuple[float, float]:
    """The nearest double, and the exact value less it, as a double.

    Raises:
        SceneError: beyond the doubles.
    """
    try:
        double = float(value)
        return double, float(value - Quantity.of(double))
    except OverflowError:
        raise SceneError(f"{label} is beyond the doubles; scale the scene down") from None


# ----------------------------------------
# The commands for engines that are not truebreak's own: `judge` and `export`.

LOG_HELP = f"""{SCENE_HELP}

\b
LOG is JSON lines, one event a line; or CSV, if its name ends in .csv:
  {{"time": 1.25, "contact": ["a", "b"]}}
  {{"time": 2.5, "contact": ["b", "w1"], "states": {{"b": [7.0, 0.5, -1, 0]}}}}
  {{"time": 3.0, "contacts": [["a", "b"], ["b", "c"]]}}  at one instant
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
    help="Keys of a scene that it does not follow: wall, pocket, capture, reverse_at, reverse_after, tie_policy.",
)
@held_against
@click.option("--exit-zero", is_flag=True, help="Exit with 0 even if a log diverged, breaks a law, or is undecided.")
def judge(
    scene: str,
    logs: tuple[str, ...],
    bits: int,
    step: str | None,
    exact_input: bool,
    lacks: str,
    held: HeldAgainst,
    exit_zero: bool,
) -> int:
    """Judge the log of any engine, in any language. Does it have the reference's events, by the laws?

    The report is that of `compare`. Where the log has states, every step is audited. Without --until and --events, a
    log is judged as far as it goes. A log cannot be run on: where it ends too early to tell, the verdict is "not
    settled", and the report says how far to record. With several logs, it says from each to the next whether the
    verdict changed, or whether the law is kept.
    """
    from ...comparison import compare
    from ...report.documents import comparison_json
    from ...report.listing import print_json
    from ...report.output import console, say
    from ...report.terminal import print_comparison
    from ...writing import check_writable, write_whole
    from ..progress import showing_progress

    loaded = held.scene(scene)
    if held.html is not None:
        check_writable(held.html)
    engines = [_log(path, loaded, bits, step, exact_input, lacks) for path in logs]
    limits: dict[str, Any] = {"until": held.until, "events": held.events}
    if held.until is None and held.events is None:
        limits = _as_far_as(engines, loaded)
    with showing_progress(loaded.name) as progress:
        comparison = compare(
            loaded,
            engines,
            **limits,
            reference=held.engine(),
            max_seconds=held.max_seconds,
            progress=progress,
        )
    if held.certified:
        from ...certificate.certified import certified

        comparison = replace(comparison, certificate=certified(comparison.reference))
    from ...report.changes import changes_of

    changes = changes_of(comparison)
    if held.html is not None:
        from ...report.html import html_report
        from ..options import command_of

        write_whole(held.html, html_report(comparison, command=command_of(click.get_current_context())))
    if held.as_json:
        print_json(comparison_json(comparison, changes))
    else:
        print_comparison(comparison)
        out = console()
        for candidate in comparison.candidates:
            for note in candidate.trajectory.notes:
                say(out, f"{candidate.engine}: {note}.")
        for change in changes:
            say(out, change.sentence, "bold")
    return DONE if exit_zero else of_comparison(comparison)


def _log(path: str, scene: Scene, bits: int, step: str | None, exact_input: bool, lacks: str) -> LogEngine:
    """The engine of one log, with what the command line declares of it."""
    from ....scenarios.engine import SCENE_KEYS
    from ....scenarios.errors import SceneError
    from ....scenarios.settings import positive_time
    from ...engines import suggestion
    from ...foreign.log_engine import LogEngine

    missing = frozenset(filter(None, (key.strip() for key in lacks.split(","))))
    for key in sorted(missing - SCENE_KEYS):
        raise SceneError(f"--lacks: {key!r} is no key; {suggestion(key, sorted(SCENE_KEYS))}")
    length = positive_time("--step", step)
    dt = None if length is None else float(length)
    return LogEngine.of(path, scene, bits=bits, step=dt, rounds_input=not exact_input, lacks=missing)


def _as_far_as(engines: list[LogEngine], scene: Scene) -> dict[str, Any]:
    """Limits that no log goes beyond: the earliest end of those that are not over, and the scene's own."""
    from ....scenarios.errors import SceneError

    ends = {log.name: float(log.last.final_time) for log in engines if not log.over}
    if not ends:
        return {}
    name = min(ends, key=lambda key: ends[key])
    if ends[name] <= 0:
        raise SceneError(f"file {name!r}: ends at time 0, so that there is nothing to judge; record it farther")
    if scene.until is not None and float(scene.until) <= ends[name]:
        return {}
    return {"until": ends[name], "events": scene.events}


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
    from ....scenarios.errors import SceneError
    from ....scenarios.files import dump_json
    from ...report.listing import laid_out
    from ...scene_argument import scene_from
    from ...writing import write_whole

    if as_csv and not floats:
        raise SceneError("--csv: rows hold doubles; add --floats")
    loaded = scene_from(scene)
    text = floats_csv(loaded) if as_csv else laid_out(floats_json(loaded)) if floats else dump_json(loaded)
    if out is not None:
        write_whole(out, text if text.endswith("\n") else f"{text}\n")
    else:
        click.echo(text, nl=not text.endswith("\n"))
    return DONE
