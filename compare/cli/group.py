"""The commands: `scenes | show | run | compare | verify | orders | bench`. Data on stdout, progress on stderr."""

from __future__ import annotations

import click

from . import completion
from .commands.chaos import chaos
from .commands.compare import compare
from .commands.minimise import minimise
from .commands.orders import orders
from .commands.run import run
from .commands.shadow import shadow
from .commands.sweep import sweep
from .examples import examples
from .exit_codes import DONE, ExitCode
from .options import JSON, SCENE

EXAMPLES = """
\b
Examples:
  truebreak scenes                           what there is to play with
  truebreak compare cradle --engines double  did floats change what happened?
  truebreak compare gas:n=10,seed=1 --events 200 --html report.html
  truebreak run galperin:n=2 --json          314 collisions: the digits of pi
  truebreak run tennis --exact               every number as an expression
  truebreak run --resume gas-run.json        go on from what --save wrote
  truebreak run lee --certificate lee.json   then: truebreak verify lee.json
  truebreak judge gas log.jsonl              the log of any engine
  truebreak export gas --floats              the scene for such an engine
  truebreak orders lee                       what orders of impulses lead to
  truebreak chaos gas --events 400           when each engine will be lost
  truebreak sweep gas --vary seed=1..20      the same for a family of scenes
  truebreak minimise gas --engine double     the smallest scene that shows it
  truebreak advise gas:n=5 --events 12       the cheapest right setting
  truebreak stress near-ties                 how near a tie may be
  truebreak show rack:rows=3 --plot rack.svg

\b
Exit codes:
  0 agree, or done   1 diverged   2 usage or bad scene   3 internal error
  4 undecided, or budget spent    130 interrupted
"""


@click.group(epilog=EXAMPLES, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.option("--debug", is_flag=True, help="Show the traceback of an internal error.")
@click.version_option(package_name="truebreak", message="%(prog)s %(version)s")
def cli(debug: bool) -> None:
    """Says, provably, whether and where floating-point error changed what happened.

    truebreak runs one scene of colliding circles and walls through engines that count differently, takes the
    exact one as the truth, and reports the first event where another engine's history leaves it, why, and
    what that did to the outcome.
    """


@cli.command(epilog=examples("scenes"))
@JSON
def scenes(as_json: bool) -> int:
    """List the catalogue: names, parameters, sources."""
    from ..report.text.listing import print_catalogue

    print_catalogue(as_json)
    return DONE


@cli.command(epilog=examples("show"))
@SCENE
@click.option("--plot", metavar="FILE", shell_complete=completion.files, help="Write a picture of the scene (.svg).")
@JSON
def show(scene: str, plot: str | None, as_json: bool) -> int:
    """Show a scene, exactly, and where it comes from."""
    from ..report.text.listing import print_scene
    from ..scene_argument import scene_from

    loaded = scene_from(scene)
    if plot is not None:
        from ...scenarios.picture import scene_picture
        from ..report.pictures.picture import svg_path
        from .writing import write_whole

        write_whole(svg_path(plot), scene_picture(loaded, standalone=True))
    print_scene(loaded, as_json)
    return DONE


@cli.command(epilog=examples("verify"))
@click.argument("file", metavar="FILE", shell_complete=completion.files)
def verify(file: str) -> int:
    """Check a certificate by a program of its own.

    It shares nothing with the engines. `truebreak run --certificate FILE` writes certificates.

    Exit codes: 0 verified, 1 refuted, 2 no certificate, 4 not decided with the bits that it allows.
    """
    from ..certificates import verdict_on

    code, sentence = verdict_on(file)
    click.echo(sentence, err=code == ExitCode.USAGE)
    return code


@cli.command(context_settings={"ignore_unknown_options": True, "help_option_names": []}, add_help_option=False)
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED)
def bench(arguments: tuple[str, ...]) -> int:
    """Measure speed, and print the figures."""
    from ..bench.command import main as bench_main

    return bench_main(list(arguments)) or DONE


cli.add_command(run)
cli.add_command(compare)
cli.add_command(chaos)
cli.add_command(minimise)
cli.add_command(orders)
cli.add_command(shadow)
cli.add_command(sweep)
