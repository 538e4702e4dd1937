"""`truebreak shadow`: is an engine's run the true history of a nearby start?"""

from __future__ import annotations

import click

from ..options import EVENTS, JSON, SCENE, SCENE_HELP, a_file, isolating, one_engine
from ..progress import DONE, ExitCode

EPILOG = f"""
{SCENE_HELP}

\b
Examples:
  truebreak shadow gas --events 260     doubles leave the history at event 161
  truebreak shadow gas:n=3 --engine pymunk:dt=1/1024 --events 60
  truebreak shadow gas --events 260 --write near.toml   the start as a scene
  truebreak run near.toml --events 260                  its certified run

\b
Exit codes:
  0 proved      4 not found, with what stands in the way      2 bad input
"""


@click.command(epilog=EPILOG)
@SCENE
@one_engine("Whose run.", "double")
@EVENTS
@click.option("--longest", is_flag=True, help="Where none is found, look for one of ever shorter beginnings.")
@a_file("--write", "out", help="Write the start that was found as a scene (TOML).")
@isolating
@JSON
def shadow(scene: str, engine_text: str, events: int | None, longest: bool, out: str | None, as_json: bool) -> int:
    """Ask whether a wrong run is the true history of a nearby start.

    The orbit nearest to the run, of the same contacts in the same order, is sought by multiple shooting. Its start is
    then run by the exact engine: where the certified history is the engine's, that is a proof. Otherwise nothing is
    claimed, and what stands in the way is named.
    """
    from ....scenarios.files import dump_toml
    from ...report.documents import shadow_json
    from ...report.listing import print_json
    from ...report.shadow_text import print_shadow
    from ...scene_argument import scene_from
    from ...shadowing.shadows import longest as sought
    from ...shadowing.shadows import shadow as whole
    from ...writing import check_writable, write_whole
    from ..progress import showing_progress

    loaded = scene_from(scene)
    if out is not None:
        check_writable(out)
    with showing_progress(f"{loaded.name}: shadow") as progress:
        if longest:
            told, best = sought(loaded, engine_text, events=events, progress=progress)
        else:
            told = whole(loaded, engine_text, events=events, progress=progress)
            best = told if told.proof is not None else None
    if out is not None and best is not None and best.proof is not None:
        write_whole(out, dump_toml(best.proof.scene))
    if as_json:
        print_json(shadow_json(told, best))
    else:
        print_shadow(told, best)
        if out is not None:
            click.echo(f"Written to {out}." if best is not None else f"Nothing was found to write to {out}.")
    return DONE if told.proof is not None else ExitCode.UNDECIDED
