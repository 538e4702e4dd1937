"""`truebreak scenes` and `truebreak show`: the catalogue, and one scene."""

from __future__ import annotations

import click

from ..options import JSON, SCENE, a_file, examples
from ..progress import DONE


@click.command(epilog=examples("scenes"))
@JSON
def scenes(as_json: bool) -> int:
    """List the catalogue: names, parameters, sources."""
    from ...report.listing import print_catalogue

    print_catalogue(as_json)
    return DONE


@click.command(epilog=examples("show"))
@SCENE
@a_file("--plot", help="Write a picture of the scene (.svg).")
@JSON
def show(scene: str, plot: str | None, as_json: bool) -> int:
    """Show a scene, exactly, and where it comes from."""
    from ...report.listing import print_scene
    from ...scene_argument import scene_from

    loaded = scene_from(scene)
    if plot is not None:
        from ....scenarios.pictures import scene_picture
        from ...picture import svg_path
        from ...writing import write_whole

        write_whole(svg_path(plot), scene_picture(loaded, standalone=True))
    print_scene(loaded, as_json)
    return DONE
