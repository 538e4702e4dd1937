"""All orders of simultaneous impulses as one HTML file that needs no network, patterns drawn."""

from __future__ import annotations

import csv
import io
import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from ...scenarios.pictures import scene_picture
from ..files.amounts import counted
from ..outcomes.outcome import pattern
from ..outcomes.permitted import PatternRelation, PermittedPatterns
from .documents import orders_json
from .listing import laid_out
from .page import Download, download, file_name, provenance_of, rendered, scene_file, stem_of
from .player import Played, played
from .search_text import (
    choices_phrase,
    most_different,
    orders_sentence,
    outcome_names,
    spread_phrase,
    velocities_phrase,
    velocity_phrase,
)

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Stop, Trajectory
    from ..comparison import Comparison
    from ..orders.all_orders import Leaf, OrderTree

MOST_DRAWN = 12
"""Patterns drawn; those of the engines are always among them."""

WIDTH, HEIGHT = 220.0, 190.0
"""Largest size of a small picture in pixels."""

EDGE, ROW = 14.0, 26.0
"""Room around the circles' centres, and the most from one row of them to the next, in pixels."""

NAMED = 24
"""Scenes of more circles are drawn with dots without names."""

NAMED_PAIRS = 4
"""More pairs than these are counted, not named."""

LABELS = {
    PatternRelation.OWN: "the policy's own",
    PatternRelation.REALISABLE: "realisable: a nearby scene does it",
    PatternRelation.SOME_ORDER: "some order only",
    PatternRelation.NO_ORDER: "no order leads to it",
    PatternRelation.NOT_FOUND: "not found among the orders followed",
}


@dataclass(frozen=True)
class Drawn:
    """One pattern with its picture.

    Attributes:
        label: its class.
        engines: place and name of the engines that came to it.
        policies: the named policies that lead to it.
        note: how it differs from the policy's own, in words.
        picture: an SVG element.
    """

    label: str
    engines: tuple[tuple[int, str], ...]
    policies: tuple[str, ...]
    note: str
    picture: str


@dataclass(frozen=True)
class Gallery:
    """The patterns drawn, and how many are not."""

    drawn: tuple[Drawn, ...]
    left_out: int
    followed: str


def gallery(comparison: Comparison) -> Gallery | None:
    """The permitted patterns and those of the engines; None where there is nothing to choose from."""
    permitted = comparison.permitted
    if permitted is None or permitted.orders == (permitted.exact,):
        return None
    engines = [(k, c) for k, c in enumerate(comparison.candidates) if c.verdict == "diverged" and c.pattern is not None]
    known: list[Mapping[str, Any]] = []
    theirs = [c.pattern for _, c in engines if c.pattern is not None]
    witnessed = [w.pattern for w in permitted.witnesses]
    for one in (permitted.exact, *theirs, *permitted.by_policy.values(), *witnessed, *permitted.orders):
        if one not in known:
            known.append(one)
    if len(known) < 2:
        return None
    shown = known[: max(MOST_DRAWN, len(theirs) + 1)]
    drawn = tuple(
        Drawn(
            LABELS[permitted.relation(pattern)],
            tuple((k, c.engine) for k, c in engines if c.pattern == pattern),
            tuple(str(policy) for policy, other in permitted.by_policy.items() if other == pattern),
            difference(permitted.exact, pattern),
            small_picture(
                comparison.scene,
                permitted.exact,
                pattern,
                difference(permitted.exact, pattern) or LABELS[permitted.relation(pattern)],
            ),
        )
        for pattern in shown
    )
    return Gallery(drawn, len(known) - len(shown), _followed(permitted))


def _followed(permitted: PermittedPatterns) -> str:
    found = counted(len(permitted.orders), "pattern")
    whole = "all of them" if permitted.complete else "there are more"
    nearby = f"; {counted(permitted.tried, 'nearby scene')} tried" if permitted.tried else ""
    return f"{found} over {counted(permitted.followed, 'order')} of the impulses ({whole}){nearby}."


def met(pattern: Mapping[str, Any]) -> set[frozenset[str]]:
    """The pairs that met.

    >>> sorted(map(sorted, met({"a": {"met": ["b"]}, "b": {"met": ["a", "wall"]}})))
    [['a', 'b'], ['b', 'wall']]
    """
    return {frozenset((name, other)) for name, told in pattern.items() for other in told["met"]}


def difference(own: Mapping[str, Any], pattern: Mapping[str, Any]) -> str:
    """How a pattern differs from the policy's own, in words.

    >>> difference({"a": {"met": [], "ended": "A1"}}, {"a": {"met": ["w"], "ended": "B2"}})
    'also a–w; a ends in B2, not A1'
    """
    mine, theirs = met(own), met(pattern)
    parts = [
        f"{word} {', '.join('–'.join(sorted(pair)) for pair in sorted(pairs, key=sorted))}"
        if len(pairs) <= NAMED_PAIRS
        else f"{counted(len(pairs), 'pair')} {more}"
        for pairs, word, more in ((theirs - mine, "also", "more"), (mine - theirs, "not", "fewer"))
        if pairs
    ]
    ended = [
        f"{name} ends in {told['ended']}, not {own[name]['ended']}"
        for name, told in pattern.items()
        if name in own and told.get("ended") != own[name].get("ended")
    ]
    parts += ended if len(ended) <= 3 else [f"{len(ended)} circles end elsewhere"]
    return "; ".join(parts)


def places(scene: Scene) -> dict[str, tuple[float, float]]:
    """A place in the small picture for each circle: as they lie at the start, but spread out evenly both ways.

    True distances would put a rack's balls on top of each other, and leave the cue ball far away.

    >>> from truebreak.scenarios import Circle, Scene
    >>> places(Scene([Circle(0, 0, id="a"), Circle(90, 0, id="b"), Circle(93, 0, id="c")]))
    {'a': (14.0, 14.0), 'b': (110.0, 14.0), 'c': (206.0, 14.0)}
    """
    columns = sorted({float(c.x) for c in scene.circles})
    rows = sorted({float(c.y) for c in scene.circles}, reverse=True)
    across = (WIDTH - 2 * EDGE) / max(1, len(columns) - 1)
    up = min(ROW, (HEIGHT - 2 * EDGE) / max(1, len(rows) - 1))
    return {
        str(c.id): (EDGE + across * columns.index(float(c.x)), EDGE + up * rows.index(float(c.y)))
        for c in scene.circles
    }


def small_picture(scene: Scene, own: Mapping[str, Any], pattern: Mapping[str, Any], title: str) -> str:
    """A pattern beside the one that it is compared with, as an SVG element.

    Circles are dots; a line joins each pair that met: thin where `own` has it too, heavy where it has not, dotted where
    only `own` has it.
    """
    place = places(scene)
    height = max(y for _, y in place.values()) + EDGE
    mine, theirs = met(own), met(pattern)
    parts = [
        f'<svg viewBox="0 0 {WIDTH:.0f} {height:.1f}" width="{WIDTH:.0f}" height="{height:.0f}" role="img" '
        f'class="small"><title>{escape(title)}</title>'
    ]
    for pair in sorted(mine | theirs, key=sorted):
        ends = [place[name] for name in sorted(pair) if name in place]
        if len(ends) < 2:
            continue
        kind = "both" if pair in mine & theirs else "more" if pair in theirs else "fewer"
        (ax, ay), (bx, by) = ends
        parts.append(f'<line class="{kind}" x1="{ax:.1f}" y1="{ay:.1f}" x2="{bx:.1f}" y2="{by:.1f}"/>')
    named = len(place) <= NAMED
    for circle in scene.circles:
        x, y = place[str(circle.id)]
        kind = "fixed" if circle.fixed else "circle"
        parts.append(f'<circle class="{kind}" cx="{x:.1f}" cy="{y:.1f}" r="{EDGE - 5 if named else 3:.1f}"/>')
        if named and len(str(circle.id)) <= 3:
            parts.append(f'<text x="{x:.1f}" y="{y:.1f}">{escape(str(circle.id))}</text>')
    return "\n".join([*parts, "</svg>"])


# ----------------------------------------
# All orders of simultaneous impulses as one HTML file that needs no network.

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
    found, names = tree.outcomes, outcome_names(tree.outcomes)
    first, body = found[0].trajectory, most_different(found)
    drawn = _drawn(scene, found, names)
    settings = {"cap": tree.cap, **first.parameters}
    return rendered(
        "orders.html.jinja",
        recording=_recording(scene, found, names),
        engines=["outcome"] * max(1, min(len(found), max(MOST_PLAYED, MOST_DRAWN) + 1) - 1),
        title=f"{scene.name}, all orders: truebreak",
        sentence=orders_sentence(scene, tree, stop),
        spread=spread_phrase(found),
        body=body,
        complete=tree.complete,
        scene=scene,
        facts=[
            ("Scene", f"{scene.name} ({counted(len(scene.circles), 'circle')}, {counted(len(scene.walls), 'wall')})"),
            ("Engine", first.engine),
            ("Merged", f"{tree.merged:,}, into a state that another order reaches too"),
            ("Left out", f"{counted(tree.reordered, 'order')} that only reorder independent contacts"),
        ],
        picture=Markup(scene_picture(scene)),
        drawn=drawn,
        left_out=len(found) - len(drawn),
        rows=[_row(number, found, names[number], body) for number in range(min(len(found), MOST_LISTED))],
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


def _recording(scene: Scene, found: Sequence[Leaf], names: Sequence[str]) -> dict[str, Any] | None:
    if len(found) < 2:
        return None
    first, others = found[0].trajectory, []
    for number, outcome in enumerate(found[1 : MOST_PLAYED + 1]):
        place = parting(first, outcome.trajectory)
        time = None if place is None else _time(first, outcome.trajectory, place)
        told = {"divergence": None if place is None else _parted(scene, first, outcome.trajectory, place)}
        others.append(Played(number, f"outcome {number + 1}: {names[number + 1]}", outcome.trajectory, told, time))
    return played(scene, first, others, name="outcome 0", title=f"outcome 0: {names[0]}")


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


def _drawn(scene: Scene, found: Sequence[Leaf], names: Sequence[str]) -> list[dict[str, Any]]:
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
        drawn.append({"number": number, "label": label, "name": names[number], "told": told, "picture": picture})
        if len(drawn) == MOST_DRAWN:
            break
    return drawn if len(drawn) > 1 else []


def _row(number: int, found: Sequence[Leaf], name: str, body: str) -> dict[str, Any]:
    first, outcome = found[0], found[number]
    place = parting(first.trajectory, outcome.trajectory) if number else None
    time = None if place is None else _time(first.trajectory, outcome.trajectory, place)
    return {
        "number": number,
        "name": name,
        "velocity": velocity_phrase(outcome, body),
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
