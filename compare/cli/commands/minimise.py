"""`truebreak minimise`: the smallest scene on which an engine still diverges, or breaks a law."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from ..options import EVENTS, SCENE, SCENE_HELP, UNTIL, Seconds, Whole, WithDefault, a_file, isolating, one_engine
from ..progress import DONE, ExitCode

if TYPE_CHECKING:
    from ...reduction.minimal_scene import Reducing

EPILOG = f"""
{SCENE_HELP}

\b
Examples:
  truebreak minimise gas:n=6 --engine double -o small.toml
  truebreak compare small.toml --engines double   by an independent call
  truebreak minimise rack:rows=2 --engine pymunk --runs 50
  truebreak minimise sizes --engine mine:Events --same law

\b
Exit codes:
  0 the smallest scene is 1-minimal
  2 the engine does not diverge (with --same law: breaks no law), or bad input
  4 a limit came first
  130 interrupted: the smallest scene so far is written
"""


def _default_runs() -> str:
    from ...reduction.minimal_scene import DEFAULT_RUNS

    return f"{DEFAULT_RUNS:,}"


@click.command(epilog=EPILOG)
@SCENE
@one_engine("What diverges.", None)
@UNTIL
@EVENTS
@a_file("-o", "--out", help="Write the scene there (TOML) instead of to stdout.")
@click.option(
    "--same",
    type=click.Choice(["any", "cause", "law"]),
    default="any",
    show_default=True,
    help="What must remain: any divergence, one of the same cause (many times the work), or a law not kept.",
)
@click.option(
    "--runs", type=Whole(1), cls=WithDefault, told=_default_runs, metavar="N", help="The most comparisons to make"
)
@click.option(
    "--max-seconds",
    type=Seconds(),
    metavar="S",
    help="End after about S seconds with the smallest scene by then, and exit with 4.",
)
@isolating
def minimise(
    scene: str,
    engine_text: str,
    until: str | None,
    events: int | None,
    out: str | None,
    same: str,
    runs: int | None,
    max_seconds: float | None,
) -> int:
    """Find the smallest scene on which an engine still diverges.

    Circles, walls, pockets, events, a reversal and the digits of numbers are left out as long as the engine still
    leaves the certified history, or with --same law still breaks the law (delta debugging). Ctrl-C ends the search with
    the smallest scene so far.
    """
    from ....scenarios.files import dump_toml
    from ...reduction.minimal_scene import DEFAULT_RUNS
    from ...reduction.minimal_scene import minimise as search
    from ...reduction.smallest import End
    from ...report.smallest_text import print_smallest
    from ...scene_argument import scene_from
    from ...writing import check_writable, write_whole
    from ..progress import showing_search

    loaded = scene_from(scene)
    if out is not None:
        check_writable(out)
    with showing_search(loaded.name, searched) as progress:
        found = search(
            loaded,
            engine_text,
            until=until,
            events=events,
            same_cause=same == "cause",
            same_law=same == "law",
            runs=DEFAULT_RUNS if runs is None else runs,
            max_seconds=max_seconds,
            progress=progress,
        )
    text = dump_toml(found.scene)
    if out is not None:
        write_whole(out, text)
    print_smallest(found)
    click.echo(f"Written to {out}." if out is not None else f"\n{text}", nl=out is not None)
    codes = {End.MINIMAL: DONE, End.INTERRUPTED: ExitCode.INTERRUPTED}
    return codes.get(found.end, ExitCode.UNDECIDED)


def searched(state: Reducing, seconds: float) -> str:
    """How far a search is.

    >>> from truebreak.compare.reduction.minimal_scene import Reducing
    >>> from truebreak.compare.reduction.smallest import SceneSize
    >>> searched(Reducing(30, 1000, SceneSize(2, 4, 0, 75, 39)), 3.0)
    '30 of at most 1,000 comparisons, 10 a second; left: 2 circles, 4 walls, 75 events, 39 characters'
    """
    from ...report.smallest_text import size_phrase

    rate = f", {state.runs / seconds:.3g} a second" if state.runs and seconds else ""
    return f"{state.runs:,} of at most {state.limit:,} comparisons{rate}; left: {size_phrase(state.size)}"
