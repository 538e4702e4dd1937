"""Pictures of scenes and states as SVG, and the tables that a notebook shows with them."""

from __future__ import annotations

import math
from base64 import b64encode
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from html import escape
from itertools import islice
from typing import TYPE_CHECKING, Protocol, TypeVar

if TYPE_CHECKING:
    from .things import Arc, Circle, Pocket, Polygon, Segment, Wall

    pass

# -- What a picture of a scene shows: discs and walls, and the part of the plane that holds them.

WIDTH, HEIGHT = 720.0, 480.0
"""Largest size of a picture in pixels."""

MARGIN = 0.06
"""Room around what is shown, as a share of its size."""


class Pictured(Protocol):
    """What a picture takes of a scene."""

    @property
    def name(self) -> str: ...
    @property
    def circles(self) -> tuple[Circle, ...]: ...
    @property
    def walls(self) -> tuple[Wall, ...]: ...
    @property
    def pockets(self) -> tuple[Pocket, ...]: ...
    @property
    def segments(self) -> tuple[Segment, ...]: ...
    @property
    def polygons(self) -> tuple[Polygon, ...]: ...
    @property
    def arcs(self) -> tuple[Arc, ...]: ...


@dataclass(frozen=True)
class DrawnDisc:
    """One circle to draw: where, how large, how fast, and with which classes."""

    id: str
    x: float
    y: float
    r: float
    vx: float
    vy: float
    classes: str
    label: bool = True


@dataclass(frozen=True)
class View:
    """The part of the plane that is shown; y goes up."""

    left: float
    bottom: float
    width: float
    height: float
    across: float = WIDTH
    up: float = HEIGHT

    @property
    def scale(self) -> float:
        """Pixels to a unit, so that it is no larger than `across` by `up` pixels."""
        return min(self.across / self.width, self.up / self.height)

    def x(self, x: float) -> float:
        """Pixels from the left."""
        return (x - self.left) * self.scale

    def y(self, y: float) -> float:
        """Pixels from the top."""
        return (self.bottom + self.height - y) * self.scale


def view_of(discs: Sequence[DrawnDisc], scene: Pictured) -> View:
    """A view of the discs, and of the walls' own points where those lie near."""
    xs = [v for d in discs for v in (d.x - d.r, d.x + d.r)]
    ys = [v for d in discs for v in (d.y - d.r, d.y + d.r)]
    (left, right), (bottom, top) = (min(xs), max(xs)), (min(ys), max(ys))
    near = 3 * max(right - left, top - bottom, 1e-9)
    for wall in scene.walls:
        for x, y in _nearest(wall_line(wall), [(d.x, d.y) for d in discs]):
            if left - near <= x <= right + near and bottom - near <= y <= top + near:
                left, right, bottom, top = min(left, x), max(right, x), min(bottom, y), max(top, y)
    xs, ys = [left, right], [bottom, top]
    for segment in scene.segments:
        x0, y0, x1, y1, r = segment_line(segment)
        xs += [x0 - r, x1 - r, x0 + r, x1 + r]
        ys += [y0 - r, y1 - r, y0 + r, y1 + r]
    for points, r in map(polygon_outline, scene.polygons):
        xs += [x + side for x, _ in points for side in (-r, r)]
        ys += [y + side for _, y in points for side in (-r, r)]
    for points in map(arc_line, scene.arcs):
        xs += [x for x, _ in points]
        ys += [y for _, y in points]
    width, height = max(xs) - min(xs), max(ys) - min(ys)
    room = MARGIN * max(width, height, 1e-9)
    width, height = (
        max(width + 2 * room, (height + 2 * room) / 4),
        max(height + 2 * room, (width + 2 * room) / 4),
    )
    middle_x, middle_y = (max(xs) + min(xs)) / 2, (max(ys) + min(ys)) / 2
    return View(middle_x - width / 2, middle_y - height / 2, width, height)


def wall_line(wall: Wall) -> tuple[float, float, float, float]:
    """A wall's two points as doubles."""
    return float(wall.x0), float(wall.y0), float(wall.x1), float(wall.y1)


def segment_line(segment: Segment) -> tuple[float, float, float, float, float]:
    """A segment's two points and half its thickness as doubles."""
    return float(segment.x0), float(segment.y0), float(segment.x1), float(segment.y1), float(segment.r)


def polygon_outline(polygon: Polygon) -> tuple[list[tuple[float, float]], float]:
    """A polygon's points and the radius of its corners as doubles."""
    return [(float(x), float(y)) for x, y in polygon.points], float(polygon.r)


ARC_STEP = math.pi / 90
"""Most of a turn from one point of a drawn arc to the next: their chord misses the arc by 0.00015 of its radius."""


def arc_line(arc: Arc) -> list[tuple[float, float]]:
    """Points along an arc, close enough for a picture, both ends among them.

    >>> from truebreak.scenarios import Arc
    >>> len(arc_line(Arc(0, 0, 1, full=True)))
    181
    """
    x, y, r = float(arc.x), float(arc.y), float(arc.r)
    start, turn = 0.0, math.tau
    if not arc.full:
        (ax, ay), (bx, by) = arc.directions
        start, end = (math.atan2(float(dy), float(dx)) for dx, dy in ((ax, ay), (bx, by)))
        turn = (end - start) % math.tau
    count = max(2, math.ceil(turn / ARC_STEP))
    angles = [start + turn * k / count for k in range(count + 1)]
    return [(x + r * math.cos(angle), y + r * math.sin(angle)) for angle in angles]


def _nearest(
    line: tuple[float, float, float, float], points: Iterable[tuple[float, float]]
) -> list[tuple[float, float]]:
    """The feet of perpendiculars from points to a line."""
    x0, y0, x1, y1 = line
    dx, dy = x1 - x0, y1 - y0
    length2 = dx * dx + dy * dy
    feet: list[tuple[float, float]] = []
    for x, y in points:
        share = ((x - x0) * dx + (y - y0) * dy) / length2
        feet.append((x0 + share * dx, y0 + share * dy))
    return feet


# -- Pictures of scenes and states as SVG.

STYLE = """
.frame { fill: #fbfaf7; } .wall { stroke: #555; stroke-width: 1.5; } .pocket { fill: #ddd9cf; }
.solid { fill: #aaa; stroke: #aaa; stroke-linejoin: round; } .solid.sharp { stroke: #555; }
.solid.marked { fill: #777; stroke: #222; }
.circle { fill: #2b6cb022; stroke: #2b6cb0; } .fixed { fill: #5555; stroke: #555; }
.other { fill: none; stroke: var(--engine); stroke-dasharray: var(--dash); } .marked { stroke-width: 3; }
.velocity { stroke: #2b6cb0; } .othervelocity { stroke: var(--engine); }
text { font: 11px system-ui, sans-serif; fill: #222; text-anchor: middle; dominant-baseline: central; }
.name { paint-order: stroke; stroke: #fbfaf7; stroke-width: 3; stroke-linejoin: round; }
@media screen and (prefers-color-scheme: dark) {
  .frame { fill: #1b1d21; } .wall { stroke: #aaa; } .solid { fill: #666; stroke: #666; } .solid.sharp { stroke: #aaa; }
  .solid.marked { fill: #999; stroke: #fff; } .pocket { fill: #3a3d44; } text { fill: #eee; }
  .name { stroke: #1b1d21; }
  .circle { fill: #63b3ed33; stroke: #63b3ed; } .fixed { fill: #aaa5; stroke: #aaa; } .velocity { stroke: #63b3ed; }
}
"""
"""Colours; the reference is blue and solid, another engine has its own colour and dash, which reports set."""

NAME_ROOM = 24.0
"""Pixels around a disc in which its outline, the head of its arrow and its name are."""

PICTURED_CIRCLES = 500
"""A scene of more circles is not drawn: the picture would say nothing."""


def scene_picture(scene: Pictured, *, standalone: bool = False, across: float = WIDTH) -> str:
    """The scene at time 0, with arrows for velocities, at most so many pixels wide."""
    rows = [tuple(float(value) for value in (c.x, c.y, c.vx, c.vy)) for c in scene.circles]
    return state_picture(scene, rows, f"{scene.name} at time 0", standalone=standalone, across=across)


Drawn = TypeVar("Drawn", bound=Pictured)


def as_at(scene: Drawn, time: float) -> Drawn:
    """A scene with its walls, segments and polygons where they are at a time, to be drawn.

    >>> from truebreak.scenarios import Circle, Scene, Wall
    >>> float(as_at(Scene([Circle(0, 0)], [Wall(9, 0, 9, 1, vx=-2)]), 1.5).walls[0].x1)
    6.0
    """
    if not any(thing.moves for thing in (*scene.walls, *scene.segments, *scene.polygons)):
        return scene
    from copy import copy
    from fractions import Fraction

    from .numbers.quantity import Quantity
    from .things import Polygon, Segment, Wall

    now, moved = Quantity.of(Fraction(time)), copy(scene)
    walls = [
        Wall(w.x0 + w.vx * now, w.y0 + w.vy * now, w.x1 + w.vx * now, w.y1 + w.vy * now, w.id, w.vx, w.vy)
        for w in scene.walls
    ]
    segments = [
        Segment(s.x0 + s.vx * now, s.y0 + s.vy * now, s.x1 + s.vx * now, s.y1 + s.vy * now, s.id, s.r, s.vx, s.vy)
        for s in scene.segments
    ]
    polygons = [
        Polygon([(x + p.vx * now, y + p.vy * now) for x, y in p.points], p.id, p.r, p.vx, p.vy) for p in scene.polygons
    ]
    for key, things in (("walls", walls), ("segments", segments), ("polygons", polygons)):
        object.__setattr__(moved, key, tuple(things))
    return moved


def state_picture(
    scene: Pictured, rows: Iterable[Sequence[float]], title: str, *, standalone: bool = False, across: float = WIDTH
) -> str:
    """The scene with its circles at x, y, vx, vy, with arrows for velocities."""
    discs = [
        DrawnDisc(str(c.id), x, y, float(c.r), vx, vy, "fixed" if c.fixed else "circle")
        for c, (x, y, vx, vy) in zip(scene.circles, rows, strict=True)
    ]
    view = replace(view_of(discs, scene), across=across, up=across * HEIGHT / WIDTH) if discs else None
    return draw(scene, discs, title, standalone=standalone, view=view)


def image(picture: str, title: str) -> str:
    """A standalone picture as an element of HTML of its own, whose style sheet stays within it.

    >>> image("<svg/>", "a < b")
    '<img alt="a &lt; b" src="data:image/svg+xml;base64,PHN2Zy8+">'
    """
    return f'<img alt="{escape(title)}" src="data:image/svg+xml;base64,{b64encode(picture.encode()).decode()}">'


def draw(
    scene: Pictured,
    discs: Sequence[DrawnDisc],
    title: str,
    *,
    marked: Iterable[str] = (),
    standalone: bool = False,
    style: str = "",
    view: View | None = None,
    over: str = "",
) -> str:
    """Discs and walls as one SVG element, all of them or what a view shows.

    Args:
        marked: ids of circles and walls to be drawn heavy; such a circle has its name beside it where it is small.
        over: what lies over them, in pixels.
        standalone: whether it is a file of its own, with its style sheet in it; `style` is added to that.
    """
    view = view or view_of(discs, scene)
    width, height = view.width * view.scale, view.height * view.scale
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.2f} {height:.2f}" '
        f'width="{width:.0f}" height="{height:.0f}" role="img" class="picture">',
        f"<title>{escape(title)}</title>",
    ]
    if standalone:
        parts.append(f"<style>{STYLE}{style}</style>")
    parts.append(f'<rect class="frame" width="{width:.2f}" height="{height:.2f}" rx="4"/>')
    parts += [_round("pocket", view, float(p.x), float(p.y), float(p.r)) for p in scene.pockets]
    names = set(marked)
    parts += [_wall(view, wall_line(w), w.id in names, str(w.id)) for w in scene.walls]
    solids = sorted(scene.polygons, key=lambda p: p.id in names)  # those in question above those at their sides
    parts += [_solid(view, *polygon_outline(p), p.id in names, str(p.id)) for p in solids]
    parts += [_segment(view, segment_line(s), s.id in names, str(s.id)) for s in scene.segments]
    parts += [_curve(view, arc_line(a), a.id in names, str(a.id)) for a in scene.arcs]
    fastest = max((math.hypot(d.vx, d.vy) for d in discs), default=0.0)
    arrow = 0.12 * max(view.width, view.height) / fastest if fastest else 0.0
    labels = [_name_in(view, p) for p in solids if p.id in names]
    for disc in discs:
        if not _in_sight(view, disc, arrow):
            continue
        parts.append(_round(disc.classes, view, disc.x, disc.y, disc.r))
        if disc.vx or disc.vy:
            kind = disc.classes.replace("other", "othervelocity") if "other" in disc.classes else "velocity"
            start = view.x(disc.x), view.y(disc.y)
            parts.append(_arrow(kind, start, (disc.vx * arrow * view.scale, -disc.vy * arrow * view.scale)))
        large = disc.r * view.scale >= 3 * len(disc.id) + 2
        if disc.label and (large or disc.id in names):
            above = 0.0 if large else disc.r * view.scale + 8
            place = f'x="{view.x(disc.x):.2f}" y="{view.y(disc.y) - above:.2f}"'
            labels.append(f'<text class="name" {place}>{escape(disc.id)}</text>')
    return "\n".join([*parts, *labels, *([over] if over else []), "</svg>"]) + "\n"


def _in_sight(view: View, disc: DrawnDisc, arrow: float) -> bool:
    """Whether a disc or its arrow, `arrow` times its velocity, may reach into the view; a name beside it may too."""
    reach = max(disc.r, math.hypot(disc.vx, disc.vy) * arrow) + NAME_ROOM / view.scale
    return (
        view.left - reach <= disc.x <= view.left + view.width + reach
        and view.bottom - reach <= disc.y <= view.bottom + view.height + reach
    )


def _round(classes: str, view: View, x: float, y: float, r: float) -> str:
    radius = max(r * view.scale, 2.0)
    return f'<circle class="{classes}" cx="{view.x(x):.2f}" cy="{view.y(y):.2f}" r="{radius:.2f}"/>'


def _arrow(classes: str, start: tuple[float, float], along: tuple[float, float]) -> str:
    """An arrow as one path; its head is a quarter of its length, at most 7 pixels."""
    (x, y), (dx, dy) = start, along
    length = math.hypot(dx, dy)
    if length < 1.0:
        return ""
    head = min(7.0, length / 4) / length
    back, side = (dx * head, dy * head), (-dy * head / 2, dx * head / 2)
    tip = x + dx, y + dy
    one, other = ((tip[0] - back[0] + s * side[0], tip[1] - back[1] + s * side[1]) for s in (1, -1))
    points = (("M", (x, y)), ("L", tip), ("M", one), ("L", tip), ("L", other))
    path = "".join(f"{letter}{px:.2f} {py:.2f}" for letter, (px, py) in points)
    return f'<path class="{classes}" fill="none" d="{path}"/>'


def _segment(view: View, line: tuple[float, float, float, float, float], marked: bool, name: str) -> str:
    """A segment as wide as it is, or as a wall is drawn."""
    x0, y0, x1, y1, r = line
    wide = f' style="stroke-width:{2 * r * view.scale:.2f};stroke-linecap:round"' if r * view.scale > 1.0 else ""
    return (
        f'<line class="wall{" marked" if marked else ""}" x1="{view.x(x0):.2f}" y1="{view.y(y0):.2f}" '
        f'x2="{view.x(x1):.2f}" y2="{view.y(y1):.2f}"{wide}><title>{escape(name)}</title></line>'
    )


def _curve(view: View, points: Sequence[tuple[float, float]], marked: bool, name: str) -> str:
    """An arc as wide as a wall is drawn."""
    path = " ".join(f"{view.x(x):.2f},{view.y(y):.2f}" for x, y in points)
    style = f'class="wall{" marked" if marked else ""}" fill="none"'
    return f'<polyline {style} points="{path}"><title>{escape(name)}</title></polyline>'


def _solid(view: View, points: Sequence[tuple[float, float]], r: float, marked: bool, name: str) -> str:
    """A polygon, with its corners as round as they are."""
    path = " ".join(f"{view.x(x):.2f},{view.y(y):.2f}" for x, y in points)
    thick = 2 * r * view.scale
    sharp = thick < 1.0  # a line of its own, which parts it from those at its side
    width = max(thick, 1.0, 3.0 * marked)
    return (
        f'<polygon class="solid{" sharp" if sharp else ""}{" marked" if marked else ""}" points="{path}" '
        f'style="stroke-width:{width:.2f}"><title>{escape(name)}</title></polygon>'
    )


def _name_in(view: View, polygon: Polygon) -> str:
    """A polygon's name in the middle of its corners."""
    points, _ = polygon_outline(polygon)
    x, y = (sum(parts) / len(points) for parts in zip(*points, strict=True))
    return f'<text class="name" x="{view.x(x):.2f}" y="{view.y(y):.2f}">{escape(str(polygon.id))}</text>'


def _wall(view: View, line: tuple[float, float, float, float], marked: bool, name: str) -> str:
    """The part of a wall's line that crosses the view."""
    x0, y0, x1, y1 = line
    dx, dy = x1 - x0, y1 - y0
    low, high = -math.inf, math.inf
    for origin, step, least, size in ((x0, dx, view.left, view.width), (y0, dy, view.bottom, view.height)):
        if step == 0:
            if not least <= origin <= least + size:
                return ""
            continue
        ends = sorted(((least - origin) / step, (least + size - origin) / step))
        low, high = max(low, ends[0]), min(high, ends[1])
    if low >= high:
        return ""
    ax, ay, bx, by = x0 + low * dx, y0 + low * dy, x0 + high * dx, y0 + high * dy
    return (
        f'<line class="wall{" marked" if marked else ""}" x1="{view.x(ax):.2f}" y1="{view.y(ay):.2f}" '
        f'x2="{view.x(bx):.2f}" y2="{view.y(by):.2f}"><title>{escape(name)}</title></line>'
    )


# -- Tables in HTML, each with a picture: what a notebook shows of a scene, a run, a comparison.

MOST_ROWS = 20
"""Rows that a notebook shows; how many more there are is said."""


def shown(table: str, scene: Pictured, picture: Callable[[], str], title: str) -> str:
    """A table with a picture below it; of a scene of too many circles the table alone."""
    drawn = image(picture(), title) if 0 < len(scene.circles) <= PICTURED_CIRCLES else ""
    return f"<div>{table}{drawn}</div>"


def html_table(caption: str, headings: Sequence[str], rows: Iterable[Sequence[object]], count: int) -> str:
    """A table of at most `MOST_ROWS` of `count` rows, every text escaped.

    >>> html_table("a < b", ["id"], [["<x>"]], 1)[:48]
    '<table><caption>a &lt; b</caption><thead><tr><th'
    """
    head = "".join(f"<th>{escape(heading)}</th>" for heading in headings)
    body = "".join(
        f"<tr>{''.join(f'<td>{escape(str(cell))}</td>' for cell in row)}</tr>" for row in islice(rows, MOST_ROWS)
    )
    if count > MOST_ROWS:
        body += f'<tr><td colspan="{len(headings)}">and {count - MOST_ROWS:,} more</td></tr>'
    return f"<table><caption>{escape(caption)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
