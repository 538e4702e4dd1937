"""The commands: `scenes | show | run | compare | verify | orders | bench`. Data on stdout, progress on stderr."""

from __future__ import annotations

import click

from . import completion
from .chaos import chaos
from .examples import examples
from .exit_codes import DONE, ExitCode, of_comparison, of_stop
from .minimise import minimise
from .numbers import Whole
from .options import EVENTS, JSON, POLICY, REVERSE, SCENE, SECONDS, SYMMETRIC, TIES, UNTIL, WORK
from .shadow import shadow
from .sweep import sweep

EXAMPLES = """
\b
Examples:
  truebreak scenes                                what there is to play with
  truebreak compare cradle --engines double       did floating point change what happened?
  truebreak compare gas:n=10,seed=1 --events 200 --html report.html
  truebreak run galperin:n=2 --engine exact --json
  truebreak run tennis --engine exact --exact     every number as an exact expression
  truebreak run lee --certificate lee.json        and then: truebreak verify lee.json
  truebreak judge gas log.jsonl --events 100      the log of any engine, in any language
  truebreak export gas --floats                   the scene in doubles, for such an engine
  truebreak orders lee                            every outcome that some order of impulses leads to
  truebreak chaos gas --events 400                how fast errors grow, and when each engine is lost
  truebreak sweep gas --vary seed=1..20           the same question for a family of scenes
  truebreak minimise gas --engine double          the smallest scene that still shows it
  truebreak stress near-ties                      how near a tie has to be for each engine to be wrong
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
    from ..report.listing import print_catalogue

    print_catalogue(as_json)
    return DONE


@cli.command(epilog=examples("show"))
@SCENE
@click.option("--plot", metavar="FILE", help="Write a picture of the scene (.svg).")
@JSON
def show(scene: str, plot: str | None, as_json: bool) -> int:
    """Show a scene: its circles and walls, exactly, and where it comes from."""
    from ..report.listing import print_scene
    from ..scene_argument import scene_from

    loaded = scene_from(scene)
    if plot is not None:
        from ..report.picture import scene_picture, svg_path
        from .writing import write_whole

        write_whole(svg_path(plot), scene_picture(loaded, standalone=True))
    print_scene(loaded, as_json)
    return DONE


@cli.command(epilog=examples("run"))
@SCENE
@click.option(
    "--engine",
    "engine_text",
    default="exact",
    show_default=True,
    metavar="E",
    shell_complete=completion.engine,
    help="exact, sympy, double, interval or pymunk; parameters as in pymunk:dt=1/1000,iterations=30; "
    "or package.module:Class, your own.",
)
@UNTIL
@EVENTS
@click.option("--exact", is_flag=True, help="Give every time and coordinate as exact text too.")
@JSON
@click.option("--certificate", metavar="FILE", help="Also write a certificate that `truebreak verify` checks.")
@click.option("--save", metavar="FILE", help="Also save the run, or what there is of it, for `truebreak.load_run`.")
@TIES
@WORK
@SECONDS
@REVERSE
@POLICY
@SYMMETRIC
def run(
    scene: str,
    engine_text: str,
    until: str | None,
    events: int | None,
    exact: bool,
    as_json: bool,
    certificate: str | None,
    save: str | None,
    ties: str | None,
    work: int | None,
    max_seconds: float | None,
    reverse_after: int | None,
    tie_policy: str | None,
    symmetric: bool,
) -> int:
    """Run a scene in one engine and print its history."""
    from ..deadline import time_limit
    from ..documents.trajectory import trajectory_json
    from ..engines import engine
    from ..foreign.guard import is_own, run_guarded
    from ..report.listing import print_json, print_trajectory
    from ..saved_runs import check_savable, save_run
    from ..scene_argument import changed, with_settings
    from ..validation import check_trajectory, check_until
    from .progress import goal_of, showing_progress

    loaded = changed(scene, reverse_after, tie_policy, limited=bool(until or events), symmetric=symmetric)
    chosen = engine(with_settings(engine_text, ties=ties, work=work))
    check_until(chosen, loaded, until)
    if certificate is not None:
        from ..certificates import check_certifiable

        check_certifiable(chosen.name, certificate)
    if save is not None:
        check_savable(chosen.name, loaded, save)
    goal = goal_of(loaded, until, events)
    with showing_progress(f"{loaded.name} in {chosen.name}", goal) as progress, time_limit(max_seconds) as watch:
        told = run_guarded(chosen, loaded, until=until, events=events, progress=watch.watched(progress))
        trajectory = told if is_own(chosen) else check_trajectory(told, loaded, chosen.name, chosen.bits)
    if save is not None:
        save_run(trajectory, save)
    if certificate is not None:
        from ..certificates import write_certificate

        write_certificate(trajectory, certificate)
    if as_json:
        print_json(trajectory_json(trajectory, exact=exact, watch=watch))
    else:
        print_trajectory(trajectory, exact=exact, watch=watch)
    return of_stop(trajectory.stop)


@cli.command(epilog=examples("verify"))
@click.argument("file", metavar="FILE")
def verify(file: str) -> int:
    """Check a certificate (`run --certificate FILE`) by a program of its own, which shares nothing with the engines.

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
@JSON
@click.option("--html", metavar="FILE", help="Also write the report as one offline HTML file.")
@click.option("--certify", is_flag=True, help="Attach a certificate of the reference's run, independently checked.")
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
    as_json: bool,
    html: str | None,
    certify: bool,
    exit_zero: bool,
) -> int:
    """Run a scene in several engines and say whether they tell the same history.

    With --max-seconds the whole comparison ends after about S seconds, of which the reference may take half; what
    each run has by then is compared, and what was left out is named.
    """
    from ..attached import with_certificates
    from ..certificates import check_engine
    from ..comparison import compare as compare_engines
    from ..documents.comparison import comparison_json
    from ..engines import split_engines
    from ..report.listing import print_json
    from ..report.terminal import print_comparison
    from ..scene_argument import changed, with_settings
    from .progress import goal_of, showing_progress
    from .writing import check_writable, write_whole

    loaded = changed(scene, reverse_after, tie_policy, limited=bool(until or events), symmetric=symmetric)
    if html is not None:
        check_writable(html)
    if certify:
        check_engine(reference, "--certify")
    with showing_progress(loaded.name, goal_of(loaded, until, events)) as progress:
        comparison = compare_engines(
            loaded,
            split_engines(engines),
            until=until,
            events=events,
            reference=with_settings(reference, ties=ties, work=work),
            max_seconds=max_seconds,
            progress=progress,
        )
    if certify:
        comparison = with_certificates(comparison)
    if html is not None:
        from ..report.html import html_report
        from .retold import command_of

        write_whole(html, html_report(comparison, command=command_of(click.get_current_context())))
    if as_json:
        print_json(comparison_json(comparison))
    else:
        print_comparison(comparison)
    return DONE if exit_zero else of_comparison(comparison)


@cli.command(epilog=examples("orders"))
@SCENE
@click.option(
    "--engine",
    "engine_text",
    default="exact",
    show_default=True,
    metavar="E",
    shell_complete=completion.engine,
    help="exact or double.",
)
@UNTIL
@EVENTS
@click.option("--cap", type=Whole(), metavar="N", help="The most outcomes to enumerate (256).")
@click.option("--samples", type=Whole(), metavar="N", help="Orders to draw at random if the cap is hit (64).")
@click.option("--seed", type=Whole(), default=0, show_default=True, metavar="S", help="The first seed of the sample.")
@WORK
@SECONDS
@JSON
def orders(
    scene: str,
    engine_text: str,
    until: str | None,
    events: int | None,
    cap: int | None,
    samples: int | None,
    seed: int,
    work: int | None,
    max_seconds: float | None,
    as_json: bool,
) -> int:
    """List every outcome that some order of simultaneous impulses leads to.

    Where several contacts fall on one instant, each may get its impulse first. All orders are followed; those that
    swap contacts without a common circle count once, and branches that reach the same state exactly are merged.
    With --max-seconds the search ends after S seconds, and the outcomes that it has by then are listed.
    """
    from ...exact.policies.all_orders import DEFAULT_CAP, DEFAULT_SAMPLES
    from ...scenarios.errors import SceneError
    from ..documents.orders import orders_json, print_orders
    from ..engines import engine
    from ..outcomes.order_search import search_orders
    from ..report.listing import print_json
    from ..scene_argument import scene_from, with_settings
    from ..validation import check_until
    from .progress import showing_progress

    loaded, chosen = scene_from(scene), engine(with_settings(engine_text, work=work))
    check_until(chosen, loaded, until)
    if not hasattr(chosen, "run_with"):
        raise SceneError(f"engine {engine_text!r} takes no tie policy from its caller; choose exact or double")
    with showing_progress(f"{loaded.name}: all orders") as progress:
        search = search_orders(
            chosen,  # type: ignore[arg-type]
            loaded,
            until=until,
            events=events,
            cap=DEFAULT_CAP if cap is None else cap,
            samples=DEFAULT_SAMPLES if samples is None else samples,
            seed=seed,
            max_seconds=max_seconds,
            progress=progress,
        )
    if as_json:
        print_json(orders_json(loaded, search.tree, search.stop))
    else:
        print_orders(loaded, search.tree, search.stop)
    return DONE if search.stop is None else of_stop(search.stop)


@cli.command(context_settings={"ignore_unknown_options": True, "help_option_names": []}, add_help_option=False)
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED)
def bench(arguments: tuple[str, ...]) -> int:
    """Measure speed and print the figures (`truebreak bench --help` lists its options)."""
    from ..bench.command import main as bench_main

    return bench_main(list(arguments)) or DONE


cli.add_command(chaos)
cli.add_command(minimise)
cli.add_command(shadow)
cli.add_command(sweep)
