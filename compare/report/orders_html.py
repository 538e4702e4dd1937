"""All orders of simultaneous impulses as one HTML file that needs no network."""

from __future__ import annotations

import csv
import io
import shlex
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from ...scenarios.pictures import scene_picture
from ..files.documents import orders_json
from ..outcomes.outcome import pattern
from .counting import counted
from .page.patterns import MOST_DRAWN, difference, small_picture
from .page.provenance import Download, download, file_name, provenance_of, scene_file, stem_of
from .page.recording import Played, played
from .page.rendering import rendered
from .text.listing import laid_out
from .text.order_tree import choices_phrase, orders_sentence, velocities_phrase

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Stop, Trajectory
    from ..orders.all_orders import Leaf, OrderTree

MOST_PLAYED = 24
"""Outcomes that can be played beside the first."""

MOST_LISTED = 400
"""Rows of the table."""

PLAYER = {
    "title": "Two outcomes, side by side",
    "choice": "outcome",
    "note": "Solid outlines in the right pane are the circles of outcome 0; those whose impulses first differ are "
    "ringed. With sound, the left ear hears outcome 0, the right one the other.",
}


def orders_html(scene: Scene, tree: OrderTree, stop: Stop | None = None, *, command: str = "") -> str:
    """The page: what was found, two outcomes to play, whom each circle meets in each, the table.

    Args:
        stop: why the search was ended before it was done, if it was.
        command: the command line that the search came from, to be told in the page.
    """
    found = tree.outcomes
    first = found[0].trajectory
    drawn = _drawn(scene, found)
    settings = {"cap": tree.cap, **first.parameters}
    return rendered(
        "orders.html.jinja",
        recording=_recording(scene, found),
        engines=max(1, min(len(found), max(MOST_PLAYED, MOST_DRAWN) + 1) - 1),
        title=f"{scene.name}, all orders: truebreak",
        sentence=orders_sentence(scene, tree, stop),
        complete=tree.complete,
        scene=scene,
        facts=[
            ("Scene", f"{scene.name} ({counted(len(scene.circles), 'circle')}, {counted(len(scene.walls), 'wall')})"),
            ("Engine", first.engine),
            ("Merged", f"{tree.merged:,}, into a state that another order reaches too"),
            ("Left out", f"{counted(tree.swapped, 'swap')} of independent contacts, which change nothing"),
        ],
        picture=Markup(scene_picture(scene)),
        drawn=drawn,
        left_out=len(found) - len(drawn),
        rows=[_row(number, outcome, found[0]) for number, outcome in enumerate(found[:MOST_LISTED])],
        styles=MOST_PLAYED,
        unlisted=max(0, len(found) - MOST_LISTED),
        provenance=provenance_of(
            scene,
            [(first.engine, settings)],
            command or shlex.join(["truebreak", "orders", file_name(scene), "--cap", str(tree.cap)]),
            _files(scene, tree, stop),
        ),
        player=PLAYER,
        footnote="Solid and blue: outcome 0.",
    )


def _recording(scene: Scene, found: Sequence[Leaf]) -> dict[str, Any] | None:
    if len(found) < 2:
        return None
    first, others = found[0].trajectory, []
    for number, outcome in enumerate(found[1 : MOST_PLAYED + 1]):
        place = parting(first, outcome.trajectory)
        time = None if place is None else _time(first, outcome.trajectory, place)
        told = {"divergence": None if place is None else _parted(scene, first, outcome.trajectory, place)}
        others.append(Played(number, f"outcome {number + 1}", outcome.trajectory, told, time))
    return played(scene, first, others, name="outcome 0", title="outcome 0")


def parting(one: Trajectory, other: Trajectory) -> int | None:
    """The first event whose impulses differ, in their pairs or their order; None if there is none.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import catalogue
    >>> runs = [ExactEngine().run(catalogue.build(f"lee:tie={name}")) for name in ("simultaneous", "sequential")]
    >>> parting(*runs), parting(runs[0], runs[0])
    (0, None)
    """
    pairs = zip(one.events, other.events, strict=False)
    differ = (k for k, (a, b) in enumerate(pairs) if a.impulses != b.impulses)
    lengths = len(one.events), len(other.events)
    return next(differ, None if lengths[0] == lengths[1] else min(lengths))


def _time(first: Trajectory, other: Trajectory, place: int) -> float:
    return min(float(run.events[place].time) for run in (first, other) if place < len(run.events))


def _parted(scene: Scene, first: Trajectory, other: Trajectory, place: int) -> dict[str, Any]:
    """Where two outcomes part, as the player has a divergence."""
    events = [run.events[place] for run in (first, other) if place < len(run.events)]
    names = {str(name) for event in events for pair in event.impulses for name in pair}
    return {
        "time": _time(first, other, place),
        "expected": place if place < len(first.events) else None,
        "got": place if place < len(other.events) else None,
        "bodies": [k for k, circle in enumerate(scene.circles) if str(circle.id) in names],
        "walls": [k for k, wall in enumerate(scene.walls) if str(wall.id) in names],
    }


def _drawn(scene: Scene, found: Sequence[Leaf]) -> list[dict[str, Any]]:
    """The first outcomes that differ in whom each circle meets or where it ends, as small pictures."""
    own = pattern(found[0].trajectory)
    known: list[dict[str, Any]] = []
    drawn: list[dict[str, Any]] = []
    for number, outcome in enumerate(found):
        theirs = pattern(outcome.trajectory)
        if theirs in known:
            continue
        known.append(theirs)
        told = difference(own, theirs)
        label = f"outcome {number}"
        picture = Markup(small_picture(scene, own, theirs, told or label))
        drawn.append({"number": number, "label": label, "told": told, "picture": picture})
        if len(drawn) == MOST_DRAWN:
            break
    return drawn if len(drawn) > 1 else []


def _row(number: int, outcome: Leaf, first: Leaf) -> dict[str, Any]:
    place = parting(first.trajectory, outcome.trajectory) if number else None
    time = None if place is None else _time(first.trajectory, outcome.trajectory, place)
    return {
        "number": number,
        "choices": choices_phrase(outcome),
        "parted": "" if place is None else f"event {place:,}, t = {time:.9g}",
        "collisions": f"{outcome.trajectory.collisions:,}",
        "ends": velocities_phrase(outcome),
    }


def _files(scene: Scene, tree: OrderTree, stop: Stop | None) -> Iterator[Download]:
    file, stem = scene_file(scene), stem_of(scene)
    if file is not None:
        yield file
    told = laid_out(orders_json(scene, tree, stop)) + "\n"
    yield download(
        f"{stem}-orders.json", "all results (JSON)", "application/json", told, "the command above, with --json"
    )
    text = io.StringIO()
    table: Any = csv.writer(text, lineterminator="\n")
    table.writerow(("outcome", "event", "time", "first", "second"))
    for number, outcome in enumerate(tree.outcomes):
        for event in outcome.trajectory.events:
            table.writerows((number, event.index, repr(float(event.time)), *pair) for pair in event.impulses)
    yield download(f"{stem}-events.csv", "every event of every outcome (CSV)", "text/csv", text.getvalue(), "the JSON")
