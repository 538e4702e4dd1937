"""The permitted patterns drawn small, side by side: whom each circle met, over the scene at the start."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

from ...outcomes.permitted import PermittedPatterns, Relation
from ..counting import counted

if TYPE_CHECKING:
    from ....scenarios.scene import Scene
    from ...comparison import Comparison

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
    Relation.OWN: "the policy's own",
    Relation.REALISABLE: "realisable: a nearby scene does it",
    Relation.SOME_ORDER: "some order only",
    Relation.NO_ORDER: "no order leads to it",
    Relation.NOT_FOUND: "not found among the orders followed",
}


@dataclass(frozen=True)
class Drawn:
    """One pattern with its picture.

    Attributes:
        label: its class.
        engines: place and name of the engines that came to it.
        policies: the named policies that lead to it.
        told: how it differs from the policy's own, in words.
        picture: an SVG element.
    """

    label: str
    engines: tuple[tuple[int, str], ...]
    policies: tuple[str, ...]
    told: str
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
    for pattern in (permitted.exact, *theirs, *permitted.by_policy.values(), *witnessed, *permitted.orders):
        if pattern not in known:
            known.append(pattern)
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
    """A pattern beside the one that it is held against, as an SVG element.

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
