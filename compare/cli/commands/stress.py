"""`truebreak stress`: families of ever harder scenes, and where on them each engine's answer turns wrong."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import click

from ..options import (
    AGAINST,
    GRID_HTML,
    JOBS,
    JSON,
    REPORTS,
    STORE,
    Whole,
    WithDefault,
    a_file,
    isolating,
    some_engines,
)
from ..progress import DONE, ExitCode
from .sweep import came_to_nothing, changes_since, check_reports, earlier_rows, showing_done, write_page

if TYPE_CHECKING:
    from ....scenarios.scene import Scene
    from ...grids.row import Row

EPILOG = """
\b
Examples:
  truebreak stress --list                                 the families
  truebreak stress near-ties --engines double,quad        one of them
  truebreak stress near-ties --show 16 --side left > scene.toml
  truebreak compare scene.toml --engines double     by an independent call
  truebreak stress --store map.db --svg map.svg  all of them; it resumes
  truebreak stress grazes --levels 60..64 --engines quad

\b
Exit codes:
  0 done, whatever the engines came to
  1 the exact engine is refuted somewhere
  2 bad input
  4 the exact engine is undecided or unchecked somewhere
"""


def _default_engines() -> str:
    from ...grids.stress_map import DEFAULT_ENGINES

    return ",".join(DEFAULT_ENGINES)


@click.command(epilog=EPILOG)
@click.argument("families", metavar="[FAMILY]...", nargs=-1)
@some_engines(
    "What to compare with the exact engine, which is always in the map", None, cls=WithDefault, told=_default_engines
)
@click.option("--levels", metavar="LOW..HIGH", help="The k of every family; else each family's own.")
@click.option("--short", is_flag=True, help="Only four of each family's own levels.")
@STORE
@a_file("--svg", help="Also write the map as a picture.")
@GRID_HTML
@AGAINST
@REPORTS
@JOBS
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
    html: str | None,
    against: str | None,
    reports: bool,
    jobs: int | None,
    listed: bool,
    show: int | None,
    side: str | None,
    seed: int | None,
    as_json: bool,
) -> int:
    """Find where on ever harder scenes each engine turns wrong.

    A family is a row of scenes, k = 1, 2, 3..., such as two collisions 10**-k apart. Each engine is compared with the
    certified run of each of them, and that run is proved again by the checker of certificates, which shares nothing
    with the engines.
    """
    from ...engines import split_engines
    from ...grids.grid import carry_out
    from ...grids.store import Store
    from ...grids.stress_map import DEFAULT_ENGINES, ladders, place_of, stress_plan
    from ...report.grid_tables import print_stress, stress_json
    from ...report.listing import print_json
    from ...writing import check_writable, write_whole

    if listed:
        _list()
        return DONE
    if show is not None:
        if short or as_json or any(value is not None for value in (engines, levels, store, svg, html, against)):
            raise click.UsageError("--show prints one scene and runs nothing; give --side and --seed alone with it")
        _show(families, show, side, seed)
        return DONE
    if side is not None or seed is not None:
        raise click.UsageError("--side and --seed say which scene to --show; add --show K")
    asked = stress_plan(
        families, DEFAULT_ENGINES if engines is None else split_engines(engines), levels=levels, short=short
    )
    check_reports(html, reports)
    before = earlier_rows(against, html, [] if store is None else [store])
    for path in filter(None, (store, svg, html)):
        check_writable(path)
    rows = Store(store or ":memory:", asked.settings)
    with showing_done("stress", "places") as progress:
        carry_out(asked, rows, jobs=jobs, progress=progress)
    rows.verify()
    told = ladders(rows, asked.engines)
    if svg is not None:
        from ...report.pictures.heat_map import heat_map

        write_whole(svg, heat_map(asked.families, told, "Where each engine's answer turns wrong"))
    if html is not None:
        shown = {row.scene: place_of(row).show for row in rows}
        changes = changes_since(before, rows)
        title = "Stress: where engines turn wrong"
        write_page(html, title, rows, reports, {}, _scene_of, commands=shown, changes=changes)
    if as_json:
        print_json(stress_json(rows.settings, rows, told))
    else:
        print_stress(rows, told)
    return max(code_of(rows), came_to_nothing(rows))


def code_of(rows: Iterable[Row]) -> ExitCode:
    """1 if the exact engine is refuted anywhere, 4 if it is undecided or unchecked anywhere, else 0."""
    marks = {row.mark for row in rows if row.engine == "exact"}
    if "wrong" in marks:
        return ExitCode.DIVERGED
    return ExitCode.DONE if marks <= {"right"} else ExitCode.UNDECIDED


def _scene_of(row: Row) -> Scene:
    from ...grids.stress_families import stress_family
    from ...grids.stress_map import place_of

    place = place_of(row)
    return stress_family(place.family).scene(place)


def _list() -> None:
    """The families, what happens in each, and what k is."""
    from ...grids.stress_families import FAMILIES
    from ...report.output import console, grid

    table = grid("family", "what happens", "k", "scenes", whole=("family",))
    for name, one in FAMILIES.items():
        seeds = "" if one.seeds == (0,) else f"; seeds {', '.join(map(str, one.seeds))}"
        told = f"{one.first} to {one.last} (at most {one.most}): {one.grows}"
        table.add_row(name, one.summary, told, f"{', '.join(one.sides)}{seeds}")
    console().print(table)


def _show(families: Sequence[str], k: int, side: str | None, seed: int | None) -> None:
    """The scene of one place, as a file."""
    from ....scenarios.files import dump_toml
    from ...grids.stress_families import stress_family

    if len(families) != 1:
        raise click.UsageError("--show prints one scene; name one family")
    one = stress_family(families[0])
    click.echo(dump_toml(one.scene(one.place(k, side, seed))).rstrip())
