"""`truebreak orders`: every outcome that some order of simultaneous impulses leads to."""

from __future__ import annotations

import click

from ..options import EVENTS, HTML, JSON, SCENE, SECONDS, UNTIL, VERBOSE, WORK, Whole, examples, one_engine
from ..progress import DONE, of_stop


@click.command(epilog=examples("orders"))
@SCENE
@one_engine("exact or double.")
@UNTIL
@EVENTS
@click.option("--cap", type=Whole(), metavar="N", help="The most outcomes to enumerate (256).")
@click.option("--samples", type=Whole(), metavar="N", help="Orders to draw at random if the cap is hit (64).")
@click.option("--seed", type=Whole(), default=0, show_default=True, metavar="S", help="The first seed of the sample.")
@WORK
@SECONDS
@VERBOSE
@JSON
@HTML
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
    verbose: bool,
    as_json: bool,
    html: str | None,
) -> int:
    """List every outcome that some order of impulses leads to.

    Where several contacts fall on one instant, each may get its impulse first. All orders are followed; those that
    only reorder contacts without a common circle count once, and branches that reach the same state exactly are merged.
    With --max-seconds the search ends after S seconds, and the outcomes that it has by then are listed.
    """
    from ....scenarios.errors import SceneError
    from ...engines import engine
    from ...orders.all_orders import DEFAULT_CAP, DEFAULT_SAMPLES, Runner, search_orders
    from ...report.documents import orders_json
    from ...report.listing import print_json
    from ...report.search_text import print_orders
    from ...scene_argument import scene_from, with_settings
    from ...validation import check_until
    from ...writing import check_writable, write_whole
    from ..progress import showing_progress

    loaded, chosen = scene_from(scene), engine(with_settings(engine_text, work=work))
    if html is not None:
        check_writable(html)
    check_until(chosen, loaded, until)
    if not isinstance(chosen, Runner):
        raise SceneError(f"engine {engine_text!r} takes no tie policy from its caller; choose exact or double")
    with showing_progress(f"{loaded.name}: all orders") as progress:
        search = search_orders(
            chosen,
            loaded,
            until=until,
            events=events,
            cap=DEFAULT_CAP if cap is None else cap,
            samples=DEFAULT_SAMPLES if samples is None else samples,
            seed=seed,
            max_seconds=max_seconds,
            progress=progress,
        )
    if html is not None and not search.tree.outcomes:
        click.echo(f"truebreak: {html} is not written: no outcome was found; give more --max-seconds", err=True)
    elif html is not None:
        from ...report.orders_page import orders_html
        from ..options import command_of

        command = command_of(click.get_current_context())
        write_whole(html, orders_html(loaded, search.tree, search.stop, command=command))
    if as_json:
        print_json(orders_json(loaded, search.tree, search.stop))
    else:
        print_orders(loaded, search.tree, search.stop, verbose=verbose)
    return DONE if search.stop is None else of_stop(search.stop)
