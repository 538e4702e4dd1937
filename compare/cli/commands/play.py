"""`truebreak play`: a page to play with scenes, in the browser of this computer."""

from __future__ import annotations

import click

from ..options import OPTIONAL_SCENE, Whole
from ..progress import DONE

EPILOG = """
SCENE is a catalogue name, perhaps with parameters (galperin:n=2), or a .toml or .json file; without one, the page has a
scene of its own.

\b
Examples:
  truebreak play
  truebreak play gas:n=5
  truebreak play mine.toml --port 8000 --no-browser
"""


@click.command(epilog=EPILOG)
@OPTIONAL_SCENE
@click.option("--port", type=Whole(0), default=0, show_default=True, help="The port; 0: any that is free.")
@click.option("--no-browser", is_flag=True, help="Only print the address; open nothing.")
def play(scene: str | None, port: int, no_browser: bool) -> int:
    """Play with scenes, on a page in the browser.

    A page opens on which scenes are drawn, and run exactly and in doubles, or in another engine, side by side on one
    clock. Only this computer can reach it, and only by the address that is printed, which has a token in it. Ctrl-C
    ends it.
    """
    import webbrowser

    from ....scenarios.errors import SceneError
    from ...play.page_files import page_files
    from ...play.play_server import PlayServer
    from ...scene_argument import scene_from

    loaded = None if scene is None else scene_from(scene)
    try:
        server = PlayServer(page_files("server", loaded), port)
    except (OSError, OverflowError) as error:
        raise SceneError(
            f"port {port}: {getattr(error, 'strerror', None) or error}; choose another with --port"
        ) from None
    with server:
        click.echo(server.address)
        click.echo("Ctrl-C ends it.", err=True)
        if not no_browser:
            webbrowser.open(server.address)
        server.serve_forever()
    return DONE
