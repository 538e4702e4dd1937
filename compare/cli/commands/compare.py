"""`truebreak compare`: one scene in several engines, held against the truth."""

from __future__ import annotations

import click

from .. import completion
from ..examples import examples
from ..exit_codes import DONE, of_comparison
from ..options import SCENE, held_against


@click.command(epilog=examples("compare"))
@SCENE
@click.option(
    "--engines",
    default="double,interval,pymunk",
    show_default=True,
    metavar="A,B,...",
    shell_complete=completion.engines,
    help="The engines to hold against the reference: names, package.module:Class, or LABEL=package.module:Class.",
)
@held_against
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
    from ...certificate.attached import with_certificates
    from ...certificates import check_engine
    from ...comparison import compare as compare_engines
    from ...documents.comparison import comparison_json
    from ...engines import split_engines
    from ...report.text.listing import print_json
    from ...report.text.terminal import print_comparison
    from ...saved.cache import reference_named
    from ...scene_argument import changed, with_settings
    from ..progress import goal_of, showing_progress
    from ..writing import check_writable, write_whole

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
        from ...report.html import html_report
        from ..retold import command_of

        write_whole(html, html_report(comparison, command=command_of(click.get_current_context())))
    if save is not None:
        from ...saved.comparisons import save_comparison

        save_comparison(comparison, save)
    if as_json:
        print_json(comparison_json(comparison))
    else:
        print_comparison(comparison)
    return DONE if exit_zero else of_comparison(comparison)
