"""`truebreak chaos`: growth of errors, Lyapunov exponents, and how long engines can be trusted."""

from __future__ import annotations

import click

from ..options import EVENTS, JSON, REVERSE, SCENE, SCENE_HELP, Whole, a_file, isolating, some_engines
from ..progress import of_stop

EPILOG = f"""
{SCENE_HELP}

\b
Units:
  per unit time   natural logarithm per unit of the scene's own time: what
                  the literature calls lambda
  per event       the same for each instant of collision
  bits            divided by ln 2: how many bits an engine's numbers lose

\b
Examples:
  truebreak chaos gas --events 400               when does each engine leave?
  truebreak chaos gas --engines double --no-run  by the certified run alone
  truebreak chaos point --events 2000 --engines double --html chaos.html
"""


@click.command(epilog=EPILOG)
@SCENE
@EVENTS
@some_engines("Whose horizons to foresee (single,double,quad,interval,pymunk); none for no engine.", None)
@click.option(
    "--exponents",
    type=Whole(1),
    metavar="K",
    help="How many Lyapunov exponents; else all, or the largest 8 of more than 20 discs.",
)
@click.option("--no-run", is_flag=True, help="Foresee only: do not run the engines to show what happens.")
@REVERSE
@isolating
@JSON
@a_file("--html", help="Also write the measurement as one offline HTML file.")
def chaos(
    scene: str,
    events: int | None,
    engines: str | None,
    exponents: int | None,
    no_run: bool,
    reverse_after: int | None,
    as_json: bool,
    html: str | None,
) -> int:
    """Measure how errors grow, and foresee when engines are lost.

    Small displacements are carried along the certified run by its tangent map. Their growth from start to end is
    proved; Lyapunov exponents, which are limits, are estimates with a 95 % interval. From the growth follows the event
    at which each engine is expected to leave the true history, before it is run.
    """
    from ...chaos.certified_chaos import DEFAULT_ENGINES
    from ...chaos.certified_chaos import chaos as measured
    from ...engines import split_engines
    from ...report.chaos_page import print_chaos
    from ...report.documents import chaos_json
    from ...report.listing import print_json
    from ...scene_argument import changed
    from ...writing import check_writable, write_whole
    from ..progress import showing_progress

    loaded = changed(scene, reverse_after, None, limited=bool(events))
    if html is not None:
        check_writable(html)
    named = DEFAULT_ENGINES if engines is None else [] if engines.strip() == "none" else split_engines(engines)
    with showing_progress(f"{loaded.name}: chaos") as progress:
        told = measured(loaded, named, events=events, exponents=exponents, run=not no_run, progress=progress)
    if html is not None:
        from ...report.chaos_page import chaos_html
        from ..options import command_of

        write_whole(html, chaos_html(told, command=command_of(click.get_current_context())))
    if as_json:
        print_json(chaos_json(told))
    else:
        print_chaos(told)
    return of_stop(told.reference.stop)
