"""`truebreak advise`: the cheapest setting of an engine that gets what is asked for right."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from .. import completion
from ..options import JOBS, JSON, SCENE, SCENE_HELP, UNTIL, Whole, WithDefault, isolating, one_engine
from ..progress import DONE, ExitCode

if TYPE_CHECKING:
    from ...grids.goals import Goal
    from ...grids.setting_search import Searching

EPILOG = f"""
{SCENE_HELP}

\b
What is to be right, one of:
  (nothing)        every event, to the end of the scene
  --events N       the first N events: who meets whom
  --outcome NAME   an outcome at the end: collisions, who_hit_whom, moved, ...
  --digits D       D decimal digits of every place at the end: no circle is
                   farther off than 10**-D of the largest coordinate there

\b
Examples:
  truebreak advise gas:n=5 --events 12
  truebreak advise galperin:n=1 --outcome collisions
  truebreak advise gas:n=5 --events 30 --engine interval
  truebreak advise cradle --digits 2 --until 20 --perturbed 3 --budget 2000000

\b
Exit codes:
  0 found   1 no setting that there is is right   2 usage, or bad scene
  4 none within the budget, or none that is predicted to be right, or the
    certified run is undecided
  130 interrupted
"""


def _default_budget() -> str:
    from ...grids.setting_search import DEFAULT_BUDGET

    return f"{DEFAULT_BUDGET:,}"


@click.command(epilog=EPILOG)
@SCENE
@click.option("--outcome", metavar="NAME", help="Get this outcome right.")
@click.option("--digits", type=Whole(1), metavar="D", help="Get so many digits of every place at the end right.")
@click.option("--events", type=Whole(1), metavar="N", help="Get the first N events right.")
@UNTIL
@one_engine(
    "Whose settings: pymunk, interval, or your own. A setting that is given is where the search begins.", "pymunk"
)
@click.option(
    "--perturbed",
    type=Whole(0),
    default=8,
    show_default=True,
    metavar="K",
    help="On so many scenes beside this one it has to be right too: other velocities, the same places.",
)
@click.option(
    "--size",
    default="1/1000",
    show_default=True,
    metavar="S",
    help="The share of its speed by which a velocity is changed there, at most.",
)
@click.option("--seed", type=Whole(0), default=1, show_default=True, metavar="N", help="The first seed of those.")
@click.option(
    "--budget",
    type=Whole(1),
    cls=WithDefault,
    told=_default_budget,
    metavar="N",
    help="The most that all runs may cost together, in counted units of about a microsecond; given, settings that are "
    "predicted to be wrong are run too",
)
@click.option(
    "--scenes",
    "folder",
    metavar="DIR",
    shell_complete=completion.folders,
    help="Write the scenes beside this one there, as perturbed-N.toml.",
)
@isolating
@JOBS
@JSON
def advise(
    scene: str,
    outcome: str | None,
    digits: int | None,
    events: int | None,
    until: str | None,
    engine_text: str,
    perturbed: int,
    size: str,
    seed: int,
    budget: int | None,
    folder: str | None,
    jobs: int | None,
    as_json: bool,
) -> int:
    """Find the cheapest setting of an engine that gets it right. What is right is proved by the certified run.

    Settings are tried from the cheapest up (pymunk: step and iterations; interval: bits) on the scene and on K scenes
    beside it, so that one that is right by luck is found out. Every cheaper one was run, and is wrong.
    Where none is right, double and quad are run too.
    """
    from ...grids.setting_search import SearchEnd
    from ...grids.setting_search import advise as search
    from ...report.listing import print_json
    from ...report.search_text import advice_json, print_advice
    from ...scene_argument import scene_from
    from ...writing import check_folder, write_whole
    from ..progress import showing_search

    if sum(given is not None for given in (outcome, digits, events)) > 1:
        raise click.UsageError("--outcome, --digits and --events are three different questions; ask one")
    if events is not None and until is not None:
        raise click.UsageError("--events and --until both say how far to look; give one")
    loaded = scene_from(scene)
    if folder is not None:
        check_folder(folder)
    with showing_search(loaded.name, searched) as progress:
        found = search(
            loaded,
            _goal(outcome, digits, events),
            engine_text,
            until=until,
            perturbed=perturbed,
            size=size,
            seed=seed,
            budget=budget,
            jobs=jobs,
            progress=progress,
        )
    if folder is not None:
        from pathlib import Path

        from ....scenarios.files import dump_toml

        for near in found.instances[1:]:
            write_whole(Path(folder) / f"perturbed-{near.seed}.toml", dump_toml(near.study.scene))
    if as_json:
        print_json(advice_json(found))
    else:
        print_advice(found)
    return {SearchEnd.FOUND: DONE, SearchEnd.LADDER: ExitCode.DIVERGED}.get(found.end, ExitCode.UNDECIDED)


def _goal(outcome: str | None, digits: int | None, events: int | None) -> Goal:
    from ...grids.goals import Digits, HistoryGoal, OutcomeGoal

    if outcome is not None:
        return OutcomeGoal(outcome)
    return Digits(digits) if digits is not None else HistoryGoal(events)


def searched(state: Searching, seconds: float) -> str:
    """How far a search is.

    >>> from truebreak.compare.grids.setting_search import Searching
    >>> searched(Searching(3_000_000, 30_000_000, "pymunk:dt=1/64", "perturbed 2"), 6.0)
    'pymunk:dt=1/64 on perturbed 2; 3,000,000 of at most 30,000,000 units, 500,000 a second, at most 54 s left'
    """
    from ..progress import duration

    told = f"{state.setting} on {state.scene}; {state.spent:,} of at most {state.budget:,} units"
    if not state.spent or seconds < 1.0:
        return told
    rate = state.spent / seconds
    return f"{told}, {rate:,.0f} a second, at most {duration((state.budget - state.spent) / rate)} left"
