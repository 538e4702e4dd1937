"""`truebreak stress`: families of ever harder scenes, and where on them each engine's answer turns wrong."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

from ..options import JSON, Whole, WithDefault, a_file, isolating, some_engines
from ..progress import DONE, ExitCode, duration, showing

if TYPE_CHECKING:
    from ...stress.plan import Done
    from ...stress.rows.cell import StressRow

EPILOG = """
\b
Examples:
  truebreak stress --list                                 the families
  truebreak stress near-ties --engines double,quad        one of them
  truebreak stress near-ties --show 16 --side left > scene.toml
  truebreak compare scene.toml --engines double     by an independent call
  truebreak stress --store map.jsonl --svg map.svg  all of them; it resumes
  truebreak stress grazes --levels 60..64 --engines quad

\b
Exit codes:
  0 done, whatever the engines came to
  1 the exact engine is refuted somewhere
  2 bad input
  4 the exact engine is undecided or unchecked somewhere
"""


def _default_engines() -> str:
    from ...stress.plan import DEFAULT_ENGINES

    return ",".join(DEFAULT_ENGINES)


@click.command(epilog=EPILOG)
@click.argument("families", metavar="[FAMILY]...", nargs=-1)
@some_engines(
    "What to hold against the exact engine, which is always in the map", None, cls=WithDefault, told=_default_engines
)
@click.option("--levels", metavar="LOW..HIGH", help="The k of every family; else each family's own.")
@click.option("--short", is_flag=True, help="Only four of each family's own levels.")
@a_file("--store", help="Keep the rows in this file, and resume from it.")
@a_file("--svg", help="Also write the map as a picture.")
@click.option("--jobs", type=Whole(1), default=1, show_default=True, metavar="N", help="Worker processes.")
@click.option("--list", "listed", is_flag=True, help="List the families.")
@click.option("--show", type=Whole(), metavar="K", help="Print the scene of one place (TOML), and run nothing.")
@click.option("--side", metavar="NAME", help="For --show: which of the family's variants; else its first.")
@click.option("--seed", type=Whole(), metavar="N", help="For --show: of what is drawn; else the family's first.")
@isolating
@JSON
def stress(
    families: tuple[str, ...],
    engines: str | None,
    levels: str | None,
    short: bool,
    store: str | None,
    svg: str | None,
    jobs: int,
    listed: bool,
    show: int | None,
    side: str | None,
    seed: int | None,
    as_json: bool,
) -> int:
    """Find where on ever harder scenes each engine turns wrong.

    A family is a row of scenes, k = 1, 2, 3..., such as two collisions 10**-k apart. Each engine is held against the
    certified run of each of them, and that run is proved again by the checker of certificates, which shares nothing
    with the engines.
    """
    from ...documents.stress import print_stress, stress_json
    from ...engines import split_engines
    from ...report.listing import print_json
    from ...stress.ladder import ladders
    from ...stress.plan import DEFAULT_ENGINES, carry_out, plan
    from ...stress.store import Store
    from ...writing import check_writable, write_whole

    if listed:
        _list()
        return DONE
    if show is not None:
        if short or as_json or any(value is not None for value in (engines, levels, store, svg)):
            raise click.UsageError("--show prints one scene and runs nothing; give --side and --seed alone with it")
        _show(families, show, side, seed)
        return DONE
    if side is not None or seed is not None:
        raise click.UsageError("--side and --seed say which scene to --show; add --show K")
    asked = plan(families, DEFAULT_ENGINES if engines is None else split_engines(engines), levels=levels, short=short)
    for path in filter(None, (store, svg)):
        check_writable(path)
    with _showing() as progress:
        kept = Store(store, asked.settings, list(asked.places()))
        rows = carry_out(asked, kept, jobs=jobs, progress=progress)
    told = ladders(rows, asked.engines)
    if svg is not None:
        from ...report.pictures.heat_map import heat_map

        write_whole(svg, heat_map(asked.families, told, "Where each engine's answer turns wrong"))
    if as_json:
        print_json(stress_json(kept.settings, rows, told))
    else:
        print_stress(rows, told)
    return code_of(rows)


def code_of(rows: Sequence[StressRow]) -> ExitCode:
    """1 if the exact engine is refuted anywhere, 4 if it is undecided or unchecked anywhere, else 0."""
    marks = {row["exact"]["mark"] for row in rows}
    if "wrong" in marks:
        return ExitCode.DIVERGED
    return ExitCode.DONE if marks <= {"right"} else ExitCode.UNDECIDED


def _list() -> None:
    """The families, what happens in each, and what k is."""
    from ...report.output import console, grid
    from ...stress.table import FAMILIES, family

    table = grid("family", "what happens", "k", "scenes", whole=("family",))
    for name in FAMILIES:
        one = family(name)
        seeds = "" if one.seeds == (0,) else f"; seeds {', '.join(map(str, one.seeds))}"
        told = f"{one.first} to {one.last} (at most {one.most}): {one.grows}"
        table.add_row(name, one.summary, told, f"{', '.join(one.sides)}{seeds}")
    console().print(table)


def _show(families: Sequence[str], k: int, side: str | None, seed: int | None) -> None:
    """The scene of one place, as a file."""
    from ....scenarios.files import dump_toml
    from ...stress.table import family

    if len(families) != 1:
        raise click.UsageError("--show prints one scene; name one family")
    one = family(families[0])
    click.echo(dump_toml(one.scene(one.place(k, side, seed))).rstrip())


@contextmanager
def _showing() -> Iterator[Callable[[Done], None] | None]:
    """A line on stderr with the rate and the time left; None, and no output, where stderr is not a terminal."""
    with showing("stress") as show:
        yield None if show is None else lambda done: show(how_far(done))


def how_far(done: Done) -> str:
    """How far a map is.

    >>> from truebreak.compare.stress.family import MapPlace
    >>> from truebreak.compare.stress.plan import Done
    >>> how_far(Done(30, 80, 12.0, 20, MapPlace("near-ties", 7, "left")))
    'stress: near-ties, left, k = 7: 30 of 80 places, 1.67 a second, 30 s left'
    """
    rate = f", {done.fresh / done.seconds:.3g} a second" if done.seconds else ""
    left = "" if done.left is None else f", {duration(done.left)} left"
    where = f"{done.place.family}, {done.place.lane}, k = {done.place.k}"
    return f"stress: {where}: {done.there:,} of {done.wanted:,} places{rate}{left}"
