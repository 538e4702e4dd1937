"""`truebreak compare`: one scene in several engines, compared with the reference."""

from __future__ import annotations

import click

from ..options import JOBS, SCENE, ReferenceOptions, a_file, examples, exit_zero, reference_options, some_engines
from ..progress import DONE, of_comparison


@click.command(epilog=examples("compare"))
@SCENE
@some_engines(
    "The engines to compare with the reference: names, package.module:Class, or LABEL=package.module:Class.",
    "double,interval,pymunk",
)
@reference_options
@a_file("--save", help="Also save the comparison with its runs, for `truebreak.load_comparison`.")
@click.option(
    "--bits", is_flag=True, help="Find how many bits lead to the end where enclosures are too wide to decide."
)
@JOBS
@exit_zero("Exit with 0 even if engines diverged or are undecided.")
def compare(
    scene: str, engines: str, asked: ReferenceOptions, save: str | None, bits: bool, jobs: int | None, exit_zero: bool
) -> int:
    """Run a scene in several engines: do they have the same history?

    With --max-seconds the whole comparison ends after about S seconds, of which the reference may take half; what
    each run has by then is compared, and what was left out is named.
    """
    from ...certificate.attached import with_certificates
    from ...certificate.certified import check_engine
    from ...comparison import compare as compare_engines
    from ...engines import split_engines
    from ...report.documents import comparison_json
    from ...report.listing import print_json
    from ...report.terminal import print_comparison
    from ...writing import check_writable, write_whole
    from ..progress import goal_of, showing_progress

    loaded = asked.scene(scene)
    for file in (asked.html, save):
        if file is not None:
            check_writable(file)
    if asked.certified:
        check_engine(asked.reference, "--certify")
    with showing_progress(loaded.name, goal_of(loaded, asked.until, asked.events)) as progress:
        comparison = compare_engines(
            loaded,
            split_engines(engines),
            until=asked.until,
            events=asked.events,
            reference=asked.engine(),
            bits=bits,
            max_seconds=asked.max_seconds,
            jobs=jobs,
            progress=progress,
        )
    if asked.certified:
        comparison = with_certificates(comparison)
    if asked.html is not None:
        from ...report.html import html_report
        from ..options import command_of

        write_whole(asked.html, html_report(comparison, command=command_of(click.get_current_context())))
    if save is not None:
        from ...saved_comparisons import save_comparison

        save_comparison(comparison, save)
    if asked.as_json:
        print_json(comparison_json(comparison))
    else:
        print_comparison(comparison, verbose=asked.verbose, scene=scene)
    return DONE if exit_zero else of_comparison(comparison)
