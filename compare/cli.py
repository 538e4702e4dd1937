"""The command line: `truebreak scenes | show | run | verify | compare | orders | bench`. Data on stdout."""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .exit_codes import DONE, ExitCode, of_comparison, of_stop

if TYPE_CHECKING:
    from ..scenarios.scene import Scene

SCENE_HELP = (
    "SCENE is a name from `truebreak scenes`, perhaps with parameters (galperin:n=2), or a .toml or .json file."
)

EXAMPLES = """
\b
Examples:
  truebreak scenes                                what there is to play with
  truebreak compare cradle                        did floating point change what happened?
  truebreak compare gas:n=10,seed=1 --events 200 --html report.html
  truebreak run galperin:n=2 --engine exact --json
  truebreak run tennis --engine exact --exact     every number as an exact expression
  truebreak run lee --certificate lee.json        and then: truebreak verify lee.json
  truebreak orders lee                            every outcome that some order of impulses leads to
  truebreak show rack:rows=3 --plot rack.svg

\b
Exit codes:
  0 agree, or done   1 diverged   2 usage or bad scene   3 internal error
  4 undecided, or budget spent    130 interrupted
"""


class WithDefaultWork(click.Option):
    """An option whose help ends with the exact engine's default of `work`; the engine is loaded when that is read."""

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        from ..exact.engine import DEFAULT_WORK

        names, text = super().get_help_record(ctx) or ("", "")
        return names, f"{text} ({DEFAULT_WORK:,})."


@click.group(epilog=EXAMPLES, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.option("--debug", is_flag=True, help="Show the traceback of an internal error.")
@click.version_option(package_name="truebreak", message="%(prog)s %(version)s")
def cli(debug: bool) -> None:
    """Says, provably, whether and where floating-point error changed what happened.

    truebreak runs one scene of colliding circles and walls through engines that count differently, takes the
    exact one as the truth, and reports the first event where another engine's history leaves it, why, and
    what that did to the outcome.
    """


SCENE = click.argument("scene", metavar="SCENE")
UNTIL = click.option("--until", metavar="T", help='Stop at this time: exact text such as 12, 9/4 or "10*sqrt(2)".')
EVENTS = click.option("--events", type=click.IntRange(min=1), metavar="N", help="Stop after N instants of collision.")
REVERSE = click.option(
    "--reverse-after",
    type=click.IntRange(min=1),
    metavar="N",
    help="Negate every velocity once, after N instants.",
)
POLICY = click.option(
    "--tie-policy",
    metavar="P",
    help="simultaneous, sequential:order=scene or sequential:seed=N; else the scene's own.",
)
TIES = click.option(
    "--ties",
    metavar="RULE",
    help="What the exact engine takes for a tie: proved (default), or assume:BITS where proof fails.",
)
WORK = click.option(
    "--work",
    type=click.IntRange(min=1),
    metavar="N",
    cls=WithDefaultWork,
    help="What one question may cost the exact engine before it is undecided, in counted units of about a microsecond",
)
SECONDS = click.option(
    "--max-seconds",
    type=click.FloatRange(min=0, min_open=True),
    metavar="S",
    help="End a run after S seconds, show what it has by then, and exit with 4.",
)
SYMMETRIC = click.option(
    "--symmetric",
    is_flag=True,
    help="Refuse a scene that no mirror and no rotation maps to itself: its ties could not be proved by symmetry.",
)
JSON = click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of text.")


@cli.command()
@JSON
def scenes(as_json: bool) -> int:
    """List the catalogue: names, parameters, sources."""
    from .report.listing import print_catalogue

    print_catalogue(as_json)
    return DONE


@cli.command(epilog=SCENE_HELP)
@SCENE
@click.option("--plot", metavar="FILE", help="Write a picture of the scene (.svg).")
@JSON
def show(scene: str, plot: str | None, as_json: bool) -> int:
    """Show a scene: its circles and walls, exactly, and where it comes from."""
    from .report.listing import print_scene
    from .scene_argument import scene_from

    loaded = scene_from(scene)
    if plot is not None:
        from .report.picture import scene_picture, svg_path
        from .writing import write_whole

        write_whole(svg_path(plot), scene_picture(loaded, standalone=True))
    print_scene(loaded, as_json)
    return DONE


@cli.command(epilog=SCENE_HELP)
@SCENE
@click.option(
    "--engine",
    "engine_text",
    default="exact",
    show_default=True,
    metavar="E",
    help="exact, sympy, double, interval or pymunk; parameters as in pymunk:dt=1/1000,iterations=30.",
)
@UNTIL
@EVENTS
@click.option("--exact", is_flag=True, help="Give every time and coordinate as exact text too.")
@JSON
@click.option("--certificate", metavar="FILE", help="Also write a certificate that `truebreak verify` checks.")
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
    ties: str | None,
    work: int | None,
    max_seconds: float | None,
    reverse_after: int | None,
    tie_policy: str | None,
    symmetric: bool,
) -> int:
    """Run a scene in one engine and print its history."""
    from .deadline import time_limit
    from .engines import engine
    from .progress import showing_progress
    from .report.listing import print_json, print_trajectory
    from .trajectory_document import trajectory_json

    loaded = changed(scene, reverse_after, tie_policy, limited=bool(until or events), symmetric=symmetric)
    chosen = engine(with_settings(engine_text, ties=ties, work=work))
    if certificate is not None:
        from .certificates import check_certifiable

        check_certifiable(chosen.name, certificate)
    with showing_progress(f"{loaded.name} in {chosen.name}") as progress, time_limit(max_seconds) as watch:
        trajectory = chosen.run(loaded, until=until, events=events, progress=watch.watched(progress))
    if certificate is not None:
        from .certificates import write_certificate

        write_certificate(trajectory, certificate)
    if as_json:
        print_json(trajectory_json(trajectory, exact=exact))
    else:
        print_trajectory(trajectory, exact=exact)
    return of_stop(trajectory.stop)


@cli.command()
@click.argument("file", metavar="FILE")
def verify(file: str) -> int:
    """Check a certificate (`run --certificate FILE`) by a program of its own, which shares nothing with the engines.

    Exit codes: 0 verified, 1 refuted, 2 no certificate, 4 not decided with the bits that it allows.
    """
    from .certificates import verdict_on

    code, sentence = verdict_on(file)
    click.echo(sentence, err=code == ExitCode.USAGE)
    return code


@cli.command(epilog=SCENE_HELP)
@SCENE
@click.option(
    "--engines",
    default="double,interval,pymunk",
    show_default=True,
    metavar="A,B,...",
    help="The engines to hold against the reference.",
)
@click.option("--reference", default="exact", show_default=True, metavar="E", help="The engine taken as the truth.")
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

    With --max-seconds the reference's run ends after S seconds, and what it has by then is compared; each of the
    other engines gets S seconds too.
    """
    from .comparison import compare as compare_engines
    from .comparison_document import comparison_json
    from .engines import split_engines
    from .progress import showing_progress
    from .report.listing import print_json
    from .report.terminal import print_comparison
    from .writing import check_writable, write_whole

    loaded = changed(scene, reverse_after, tie_policy, limited=bool(until or events), symmetric=symmetric)
    if html is not None:
        check_writable(html)
    with showing_progress(loaded.name) as progress:
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
        from .certificates import certified

        comparison = replace(comparison, certificate=certified(comparison.reference))
    if html is not None:
        from .report.html import html_report

        write_whole(html, html_report(comparison))
    if as_json:
        print_json(comparison_json(comparison))
    else:
        print_comparison(comparison)
    return DONE if exit_zero else of_comparison(comparison)


@cli.command(epilog=SCENE_HELP)
@SCENE
@click.option("--engine", "engine_text", default="exact", show_default=True, metavar="E", help="exact or double.")
@UNTIL
@EVENTS
@click.option("--cap", type=int, metavar="N", help="The most outcomes to enumerate (256).")
@click.option("--samples", type=int, metavar="N", help="Orders to draw at random if the cap is hit (64).")
@click.option("--seed", type=int, default=0, show_default=True, metavar="S", help="The first seed of the sample.")
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
    from ..exact.policies.all_orders import DEFAULT_CAP, DEFAULT_SAMPLES
    from ..scenarios.errors import SceneError
    from .engines import engine
    from .order_search import search_orders
    from .orders_document import orders_json, print_orders
    from .progress import showing_progress
    from .report.listing import print_json
    from .scene_argument import scene_from

    loaded, chosen = scene_from(scene), engine(with_settings(engine_text, work=work))
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
    from .bench import main as bench_main

    return bench_main(list(arguments)) or DONE


def changed(
    scene: str, reverse_after: int | None, tie_policy: str | None, *, limited: bool, symmetric: bool = False
) -> Scene:
    """The scene of the command line, with a reversal or a tie policy of the command line in place of its own.

    A reversal of the command line takes the place of the scene's default horizon too, unless the command line
    sets one: the run then ends at the return.
    """
    from .scene_argument import scene_from

    changes: dict[str, Any] = {}
    if reverse_after is not None:
        changes |= {"reverse_after": reverse_after, "reverse_at": None}
        if not limited:
            changes |= {"until": None, "events": None}
    if tie_policy is not None:
        changes["tie_policy"] = tie_policy
    loaded = scene_from(scene)
    if changes:
        loaded = loaded.with_changes(**changes)
    if symmetric:
        from ..exact.predicates.scene_symmetry import require_symmetry

        require_symmetry(loaded)
    return loaded


def with_settings(engine_text: str, **settings: str | int | None) -> str:
    """An engine's text with more settings; None leaves one as it is.

    >>> with_settings("exact:max_bits=4096", ties=None, work=10)
    'exact:max_bits=4096,work=10'
    """
    given = ",".join(f"{key}={value}" for key, value in settings.items() if value is not None)
    return f"{engine_text}{',' if ':' in engine_text else ':'}{given}" if given else engine_text


def main(arguments: list[str] | None = None) -> None:
    """Runs the command line and exits with its code; see `ExitCode`.

    Bad input is one line on stderr. Other errors are one line too, and a traceback with `--debug`.
    """
    given = list(sys.argv[1:] if arguments is None else arguments)
    if "_TRUEBREAK_COMPLETE" in os.environ:
        cli.main(given, prog_name="truebreak")
    debug = "--debug" in given
    words = [word for word in given if word != "--debug"]
    try:
        code = _run(words)
        sys.stdout.flush()
    except KeyboardInterrupt:
        _say("truebreak: interrupted")
        code = ExitCode.INTERRUPTED
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = ExitCode.PIPE_CLOSED
    except Exception as error:
        if debug:
            import traceback

            traceback.print_exc()
        reason = " ".join(str(error).split())
        _say(f"truebreak: internal error: {type(error).__name__}: {reason} (add --debug for the traceback)")
        code = ExitCode.INTERNAL
    sys.exit(int(code))


def _run(words: list[str]) -> int:
    """One command; click's own errors and bad scenes become one line and a code."""
    try:
        with cli.make_context("truebreak", words) as context:
            code = cli.invoke(context)
        return code if isinstance(code, int) else DONE
    except click.exceptions.Exit as stop:
        return stop.exit_code
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message(), err=True)
        return ExitCode.USAGE
    except click.UsageError as error:
        command = error.ctx.command_path if error.ctx else Path("truebreak").name
        _say(f"truebreak: error: {' '.join(error.format_message().split())} (see {command} --help)")
        return ExitCode.USAGE
    except Exception as error:
        from ..scenarios.errors import SceneError
        from .deadline import OutOfTime

        if isinstance(error, OutOfTime):
            _say(f"truebreak: out of time, with nothing to show yet: {error}")
            return ExitCode.UNDECIDED
        if not isinstance(error, SceneError):
            raise
        _say(f"truebreak: error: {' '.join(str(error).split())}")
        return ExitCode.USAGE


def _say(line: str) -> None:
    """One line on stderr, which may be closed."""
    try:
        click.echo(line, err=True)
    except OSError:
        return


if __name__ == "__main__":
    main()
