"""`truebreak run`: one scene in one engine, from its start or from a saved run. `truebreak verify`: its certificate."""

from __future__ import annotations

import click

from .. import completion
from ..options import (
    EVENTS,
    JSON,
    NO_CACHE,
    OPTIONAL_SCENE,
    POLICY,
    REVERSE,
    SECONDS,
    SYMMETRIC,
    TIES,
    UNTIL,
    WORK,
    Whole,
    a_file,
    examples,
    isolating,
    one_engine,
    refuse_beside,
    required,
)
from ..progress import ExitCode, of_stop


@click.command(epilog=examples("run"))
@OPTIONAL_SCENE
@one_engine(
    "exact, sympy, double, single, quad, rounded, interval or pymunk; parameters as in "
    "pymunk:dt=1/1000,iterations=30; another installed engine, or package.module:Class, your own."
)
@UNTIL
@EVENTS
@click.option("--exact", is_flag=True, help="Give every time and coordinate as exact text too.")
@isolating
@JSON
@a_file("--certificate", help="Also write a certificate that `truebreak verify` checks.")
@a_file("--save", help="Also save the run, or what there is of it, for `truebreak.load_run`.")
@a_file(
    "--resume",
    help="Go on from a run that --save wrote, in place of a SCENE: to the limits that it had, or to those given now.",
)
@TIES
@WORK
@SECONDS
@REVERSE
@POLICY
@SYMMETRIC
@NO_CACHE
def run(
    scene: str | None,
    engine_text: str,
    until: str | None,
    events: int | None,
    exact: bool,
    as_json: bool,
    certificate: str | None,
    save: str | None,
    resume: str | None,
    ties: str | None,
    work: int | None,
    max_seconds: float | None,
    reverse_after: int | None,
    tie_policy: str | None,
    symmetric: bool,
    no_cache: bool,
) -> int:
    """Run a scene in one engine and print its history.

    What comes of --resume is what one run from the beginning would have given, but for the counts of its plan.
    """
    from ...deadline import time_limit
    from ...files.cache import reference_named
    from ...foreign.guard import is_own, run_guarded
    from ...scene_argument import changed, with_settings
    from ...validation import check_trajectory, check_until
    from ..progress import goal_of, showing_progress

    if resume is None:
        loaded = changed(required(scene), reverse_after, tie_policy, limited=bool(until or events), symmetric=symmetric)
        chosen = reference_named(with_settings(engine_text, ties=ties, work=work), cache=not no_cache)
        goal = goal_of(loaded, until, events)
    else:
        refuse_beside("--resume", ("scene", "engine_text", "reverse_after", "tie_policy", "symmetric"))
        from ...files.saved import GoingOn, load_run

        chosen = GoingOn.after(load_run(resume), resume, ties=ties, work=work)
        loaded = chosen.earlier.scene
        goal = goal_of(loaded, *((until, events) if until or events else chosen.limits))
    check_until(chosen, loaded, until)
    if certificate is not None:
        from ...certificate.certified import check_certifiable

        check_certifiable(chosen.name, certificate)
    if save is not None:
        from ...files.saved import check_savable

        check_savable(chosen.name, loaded, save)
    with showing_progress(f"{loaded.name} in {chosen.name}", goal) as progress, time_limit(max_seconds) as watch:
        told = run_guarded(chosen, loaded, until=until, events=events, progress=watch.watched(progress))
        trajectory = told if is_own(chosen) else check_trajectory(told, loaded, chosen.name, chosen.bits)
    if save is not None:
        from ...files.saved import save_run

        save_run(trajectory, save)
    if certificate is not None:
        from ...certificate.certified import write_certificate

        write_certificate(trajectory, certificate)
    if as_json:
        from ...report.documents import trajectory_json
        from ...report.listing import print_json

        print_json(trajectory_json(trajectory, exact=exact, watch=watch))
    else:
        from ...report.listing import print_trajectory

        print_trajectory(trajectory, exact=exact, watch=watch)
    return of_stop(trajectory.stop)


@click.command(epilog=examples("verify"))
@click.argument("file", metavar="FILE", shell_complete=completion.files)
@click.option(
    "--scene",
    metavar="SCENE",
    shell_complete=completion.scenes,
    help="The scene that it should be of: a name, or a file.",
)
@click.option("--work", type=Whole(), metavar="N", help="Units of work that checking may cost (by the size of FILE).")
def verify(file: str, scene: str | None, work: int | None) -> int:
    """Check a certificate by a program of its own.

    It shares nothing with the engines. `truebreak run --certificate FILE` writes certificates. With --scene the scene
    in the certificate is compared with SCENE, number by number.

    Exit codes: 0 verified, 1 refuted, 2 no certificate, 4 not decided with the bits that it allows, or declined as it
    costs more than --work.
    """
    from ...certificate.certified import verdict_of_scene

    code, sentence = verdict_of_scene(file, scene, work)
    click.echo(sentence, err=code == ExitCode.USAGE)
    return code
