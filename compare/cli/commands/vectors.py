"""`truebreak vectors`: single first meetings with certified answers, for authors of engines."""

from __future__ import annotations

import click

from .. import completion
from ..options import JSON, VERBOSE, Whole, command_of, examples, isolating
from ..progress import DONE


@click.command(epilog=examples("vectors"))
@click.option("--count", type=Whole(1), default=1000, show_default=True, metavar="N", help="How many vectors.")
@click.option("--seed", type=Whole(), default=1, show_default=True, metavar="S", help="What they are drawn from.")
@click.option("--out", metavar="FOLDER", help="Write them there: vectors.json, vectors.h, score.c, formulas.c.")
@click.option(
    "--engines",
    metavar="A,B,...",
    shell_complete=completion.engines,
    help="What to score: engines without time steps, and queries of physics libraries; else double, single and the "
    "queries whose library is installed. With --out nothing is scored unless this is given.",
)
@VERBOSE
@isolating
@JSON
def vectors(count: int, seed: int, out: str | None, engines: str | None, verbose: bool, as_json: bool) -> int:
    """Write first meetings with certified answers; score engines.

    A vector is a disc, what it may meet (a disc, a wall, a segment or an arc with its ends), whether they meet, and
    when. All numbers of a question are doubles. There are hits, misses, grazes, hits and misses by 2**-k, discs that
    touch at the start, and lengths and times of extreme size.

    With --out a program in C scores your own function: cc -O2 -o score score.c yours.c -lm && ./score
    """
    from ...engines import split_engines
    from ...report.grid_tables import print_scores, scores_json
    from ...report.listing import print_json
    from ...vectors.first_meetings import vectors as drawn
    from ...vectors.scores import installed_queries, query_named, scores
    from ...vectors.vector_files import write_vectors
    from ...writing import check_folder
    from ..progress import RunEnd, showing_progress

    if out is not None:
        check_folder(out)
    names = [] if engines is None and out is not None else ["double", "single", *installed_queries()]
    names = names if engines is None else split_engines(engines)
    queries = {name: query_named(name) for name in names}
    with showing_progress(f"{count:,} vectors", RunEnd(events=count)) as progress:
        made = [*drawn(count, seed, progress)]
    if out is not None:
        for path in write_vectors(out, made, command_of(click.get_current_context())):
            click.echo(f"{path} written", err=True)
    found = {}
    for name, query in queries.items():
        with showing_progress(f"scoring {name}", RunEnd(events=count)) as progress:
            found[name] = scores(made, query, progress)
    if as_json:
        print_json(scores_json(found))
    elif found:
        print_scores(found, verbose=verbose)
    return DONE
