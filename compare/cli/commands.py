"""The commands: `scenes | show | run | compare | verify | orders | bench`. Data on stdout, progress on stderr."""

from __future__ import annotations

import click

from . import completion
from .chaos import chaos
from .examples import examples
from .exit_codes import DONE, ExitCode, of_comparison
from .minimise import minimise
from .options import EVENTS, JSON, NO_CACHE, POLICY, REVERSE, SCENE, SECONDS, SYMMETRIC, TIES, UNTIL, WORK
from .orders import orders
from .run import run
from .shadow import shadow
from .sweep import sweep

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


@cli.command(epilog=examples("compare"))
@SCENE
@click.option(
    "--engines",
    default="double,interval,pymunk",
    show_default=True,
    metavar="A,B,...",
    shell_complete=completion.engines,
    help="The engines to hold against the reference: names, package.module:Class, or LABEL=package.module:Class.",
)
@click.option(
    "--reference",
    default="exact",
    show_default=True,
    metavar="E",
    shell_complete=completion.engine,
    help="The engine taken as the truth.",
)
@UNTIL
@EVENTS
@REVERSE
@POLICY
@TIES
@WORK
@SECONDS
@SYMMETRIC
@NO_CACHE
@JSON
@click.option(
    "--html", metavar="FILE", shell_complete=completion.files, help="Also write the report as one offline HTML file."
)
@click.option("--certify", is_flag=True, help="Attach a certificate of the reference's run, independently checked.")
@click.option(
    "--save",
    metavar="FILE",
    shell_complete=completion.files,
    help="Also save the comparison with its runs, for `truebreak.load_comparison`.",
)
@click.option("--exit-zero", is_flag=True, help="Exit with 0 even if engines diverged or are undecided.")
def compare(
    scene: str,
    engines: str,
    reference: str,
    until: str | None,
    events: int | None,
    reverse_after: int | None,
    tie_policy: str | None,
    ties: str | None,
    work: int | None,
    max_seconds: float | None,
    symmetric: bool,
    no_cache: bool,
    as_json: bool,
    html: str | None,
    certify: bool,
    save: str | None,
    exit_zero: bool,
) -> int:
    """Run a scene in several engines: do they tell the same history?

    With --max-seconds the whole comparison ends after about S seconds, of which the reference may take half; what
    each run has by then is compared, and what was left out is named.
    """
    from ..attached import with_certificates
    from ..certificates import check_engine
    from ..comparison import compare as compare_engines
    from ..documents.comparison import comparison_json
    from ..engines import split_engines
    from ..report.text.listing import print_json
    from ..report.text.terminal import print_comparison
    from ..saved.cache import reference_named
    from ..scene_argument import changed, with_settings
    from .progress import goal_of, showing_progress
    from .writing import check_writable, write_whole

    loaded = changed(scene, reverse_after, tie_policy, limited=bool(until or events), symmetric=symmetric)
    for file in (html, save):
        if file is not None:
            check_writable(file)
    if certify:
        check_engine(reference, "--certify")
    with showing_progress(loaded.name, goal_of(loaded, until, events)) as progress:
        comparison = compare_engines(
            loaded,
            split_engines(engines),
            until=until,
            events=events,
            reference=reference_named(with_settings(reference, ties=ties, work=work), cache=not no_cache),
            max_seconds=max_seconds,
            progress=progress,
        )
    if certify:
        comparison = with_certificates(comparison)
    if html is not None:
        from ..report.html import html_report
        from .retold import command_of

        write_whole(html, html_report(comparison, command=command_of(click.get_current_context())))
    if save is not None:
        from ..saved.comparisons import save_comparison

        save_comparison(comparison, save)
    if as_json:
        print_json(comparison_json(comparison))
    else:
        print_comparison(comparison)
    return DONE if exit_zero else of_comparison(comparison)


@cli.command(context_settings={"ignore_unknown_options": True, "help_option_names": []}, add_help_option=False)
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED)
def bench(arguments: tuple[str, ...]) -> int:
    """Measure speed, and print the figures."""
    from ..bench.command import main as bench_main

    return bench_main(list(arguments)) or DONE


cli.add_command(run)
cli.add_command(chaos)
cli.add_command(minimise)
cli.add_command(orders)
cli.add_command(shadow)
cli.add_command(sweep)
