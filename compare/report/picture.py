"""Pictures of scenes and states as SVG."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ..candidate import Candidate
    from ..comparison import Comparison

WIDTH, HEIGHT = 720.0, 480.0
"""Largest size of a picture in pixels."""

MARGIN = 0.06
"""Room around what is shown, as a share of its size."""

STYLE = """
.frame { fill: #fbfaf7; } .wall { stroke: #555; stroke-width: 1.5; } .pocket { fill: #ddd9cf; }
.circle { fill: #2b6cb022; stroke: #2b6cb0; } .fixed { fill: #5555; stroke: #555; }
.other { fill: none; stroke: var(--engine); stroke-dasharray: var(--dash); } .marked { stroke-width: 3; }
.velocity { stroke: #2b6cb0; } .othervelocity { stroke: var(--engine); }
text { font: 11px system-ui, sans-serif; fill: #222; text-anchor: middle; dominant-baseline: central; }
@media screen and (prefers-color-scheme: dark) {
  .frame { fill: #1b1d21; } .wall { stroke: #aaa; } .pocket { fill: #3a3d44; } text { fill: #eee; }
  .circle { fill: #63b3ed33; stroke: #63b3ed; } .fixed { fill: #aaa5; stroke: #aaa; } .velocity { stroke: #63b3ed; }
}
"""
"""Colours; the reference is blue and solid, another engine has its own colour and dash (see `engine_css`)."""


@dataclass(frozen=True)
class Disc:
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

    @property
    def scale(self) -> float:
        """Pixels to a unit."""
        return min(WIDTH / self.width, HEIGHT / self.height)

    def x(self, x: float) -> float:
        """Pixels from the left."""
        return (x - self.left) * self.scale

    def y(self, y: float) -> float:
        """Pixels from the top."""
        return (self.bottom + self.height - y) * self.scale


def view_of(discs: Sequence[Disc], scene: Scene) -> View:
    """A view of the discs, and of the walls' own points where those lie near."""
    xs = [v for d in discs for v in (d.x - d.r, d.x + d.r)]
    ys = [v for d in discs for v in (d.y - d.r, d.y + d.r)]
    size = max(max(xs) - min(xs), max(ys) - min(ys), 1e-9)
    for wall in scene.walls:
        for x, y in _nearest(wall_line(wall), [(d.x, d.y) for d in discs]):
            if min(xs) - 3 * size <= x <= max(xs) + 3 * size and min(ys) - 3 * size <= y <= max(ys) + 3 * size:
                xs.append(x)
                ys.append(y)
    width, height = max(xs) - min(xs), max(ys) - min(ys)
    room = MARGIN * max(width, height, 1e-9)
    width, height = (
        max(width + 2 * room, (height + 2 * room) / 4),
        max(height + 2 * room, (width + 2 * room) / 4),
    )
    middle_x, middle_y = (max(xs) + min(xs)) / 2, (max(ys) + min(ys)) / 2
    return View(middle_x - width / 2, middle_y - height / 2, width, height)


def wall_line(wall: object) -> tuple[float, float, float, float]:
    """A wall's two points as doubles."""
    return tuple(float(getattr(wall, key)) for key in ("x0", "y0", "x1", "y1"))  # type: ignore[return-value]


def _nearest(
    line: tuple[float, float, float, float], points: Iterable[tuple[float, float]]
) -> list[tuple[float, float]]:
    """The feet of perpendiculars from points to a line."""
    x0, y0, x1, y1 = line
    dx, dy = x1 - x0, y1 - y0
    length2 = dx * dx + dy * dy
    feet = []
    for x, y in points:
        share = ((x - x0) * dx + (y - y0) * dy) / length2
        feet.append((x0 + share * dx, y0 + share * dy))
    return feet


def scene_picture(scene: Scene, *, standalone: bool = False) -> str:
    """The scene at time 0, with arrows for velocities."""
    discs = [
        Disc(
            str(c.id),
            float(c.x),
            float(c.y),
            float(c.r),
            float(c.vx),
            float(c.vy),
            "fixed" if c.fixed else "circle",
        )
        for c in scene.circles
    ]
    return draw(scene, discs, f"{scene.name} at time 0", standalone=standalone)


def divergence_picture(comparison: Comparison, candidate: Candidate, number: int = 0) -> str:
    """Both runs at the time of the first divergence: the reference solid, the candidate in the style of its place."""
    divergence = candidate.alignment.divergence
    assert divergence is not None
    marked = _names((divergence.body, divergence.expected, divergence.got))
    reference, run = comparison.reference, candidate.trajectory
    ends = [t for t in (divergence.expected_time, divergence.got_time) if t is not None]
    time = min(max(ends), float(reference.final_time) * (1 - 2**-50), float(run.final_time) * (1 - 2**-50))
    discs = []
    for trajectory, kind in ((reference, "circle"), (run, f"other e{number}")):
        for circle, row in zip(trajectory.scene.circles, trajectory.sample([time])[0], strict=True):
            if circle.fixed and kind != "circle":
                continue
            classes = f"{'fixed' if circle.fixed else kind}{' marked' if circle.id in marked else ''}"
            x, y, vx, vy = (float(v) for v in row)
            discs.append(Disc(str(circle.id), x, y, float(circle.r), vx, vy, classes, label=kind == "circle"))
    title = f"{reference.engine} (solid) and {candidate.engine} (dashed) at time {time:.9g}"
    whole = view_of(discs, comparison.scene)
    close = view_near([d for d in discs if "marked" in d.classes], whole)
    if close is not None:
        near = draw(comparison.scene, discs, f"{title}, close up", marked=marked, view=close)
        return draw(comparison.scene, discs, title, marked=marked) + near
    return draw(comparison.scene, discs, title, marked=marked)


CLOSE_UP_FROM = 20.0
"""Radius in pixels below which the circles that matter are drawn once more, close up."""

CLOSE_UP_REACH = 6.0
"""Size of a close-up, in radii beyond the circles that matter."""


def view_near(discs: Sequence[Disc], whole: View) -> View | None:
    """A view of a few discs alone; None if the whole shows them as large, or nearly so."""
    radius = max((d.r for d in discs), default=0.0)
    if radius <= 0 or radius * whole.scale >= CLOSE_UP_FROM:
        return None
    room = CLOSE_UP_REACH * radius
    left, right = min(d.x for d in discs) - room, max(d.x for d in discs) + room
    bottom, top = min(d.y for d in discs) - room, max(d.y for d in discs) + room
    size = max((right - left) / WIDTH, (top - bottom) / HEIGHT)
    if 1 / size < 1.5 * whole.scale:
        return None
    width, height = size * WIDTH, size * HEIGHT
    return View((left + right - width) / 2, (bottom + top - height) / 2, width, height)


def _names(marked: Iterable[str | None]) -> set[str]:
    """The ids among the partners of a divergence; those of a tie are joined by + or then."""
    return {name for text in marked if text for name in text.replace(" then ", " + ").split(" + ")}


def draw(
    scene: Scene,
    discs: Sequence[Disc],
    title: str,
    *,
    marked: Iterable[str] = (),
    standalone: bool = False,
    view: View | None = None,
) -> str:
    """Discs and walls as one SVG element, all of them or what a view shows."""
    view = view or view_of(discs, scene)
    width, height = view.width * view.scale, view.height * view.scale
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.2f} {height:.2f}" '
        f'width="{width:.0f}" height="{height:.0f}" role="img" class="picture">',
        f"<title>{escape(title)}</title>",
    ]
    if standalone:
        parts.append(f"<style>{STYLE}</style>")
    parts.append(f'<rect class="frame" width="{width:.2f}" height="{height:.2f}" rx="4"/>')
    parts += [_round("pocket", view, float(p.x), float(p.y), float(p.r)) for p in scene.pockets]
    names = set(marked)
    parts += [_wall(view, wall_line(w), w.id in names, str(w.id)) for w in scene.walls]
    fastest = max((math.hypot(d.vx, d.vy) for d in discs), default=0.0)
    arrow = 0.12 * max(view.width, view.height) / fastest if fastest else 0.0
    for disc in discs:
        parts.append(_round(disc.classes, view, disc.x, disc.y, disc.r))
        if disc.vx or disc.vy:
            kind = disc.classes.replace("other", "othervelocity") if "other" in disc.classes else "velocity"
            start = view.x(disc.x), view.y(disc.y)
            parts.append(_arrow(kind, start, (disc.vx * arrow * view.scale, -disc.vy * arrow * view.scale)))
        if disc.label and disc.r * view.scale >= 3 * len(disc.id) + 2:
            parts.append(f'<text x="{view.x(disc.x):.2f}" y="{view.y(disc.y):.2f}">{escape(disc.id)}</text>')
    parts.append("</svg>")
    return "\n".join(parts) + "\n"


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


def svg_path(name: str) -> Path:
    """A path for a picture.

    Raises:
        SceneError: unless it ends in .svg.
    """
    from ...scenarios.errors import SceneError

    if not name.lower().endswith(".svg"):
        raise SceneError(f"--plot {name!r}: pictures are SVG; give a file name that ends in .svg")
    return Path(name)
