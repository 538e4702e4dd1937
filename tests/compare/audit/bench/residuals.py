"""How far a run is from the laws, step by step, on its own numbers: flight, gap, impulse, in units of rounding.

All is reckoned in 60 digits from the trajectory that an engine handed back, and from the scene. A residual is given
together with the sizes by which it may be measured, so that a table can say which of them explains honest engines.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from .worlds import PRECISE, precisely

ZERO = precisely(0.0)

OPERATORS: dict[Any, Any] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}


@dataclass
class Residual:
    """One residual of one event.

    Attributes:
        kind: flight, told gap, flown gap, direction, strength.
        event: its index.
        value: its size, in the units of the scene.
        sizes: what it may be measured in, by name; each already without u.
    """

    kind: str
    event: int
    value: Any
    sizes: dict[str, Any]
    more: dict[str, Any] = field(default_factory=dict)

    def units(self, size: str, u: Any) -> float:
        """The residual in u times one of the sizes."""
        scale = self.sizes[size] * u
        return 0.0 if self.value == 0 else float("inf") if scale == 0 else float(self.value / scale)


class Bodies:
    """The exact scene in 60 digits."""

    def __init__(self, scene: Any) -> None:
        self.ids = {name: k for k, name in enumerate(scene.ids)}
        self.n = len(scene.circles)
        self.r = [_number(c.r) for c in scene.circles]
        self.w = [_number(c.inverse_mass) for c in scene.circles]
        self.walls = []
        for wall in scene.walls:
            x0, y0, x1, y1 = (_number(v) for v in (wall.x0, wall.y0, wall.x1, wall.y1))
            length = PRECISE.hypot(x1 - x0, y1 - y0)
            self.walls.append(
                (x0, y0, (y0 - y1) / length, (x1 - x0) / length, max(map(abs, (x0, y0, x1, y1))) / length)
            )
        self.sides = [[1 if w.height(c.x, c.y).sign() >= 0 else -1 for w in scene.walls] for c in scene.circles]

    @classmethod
    def of_world(cls, world: Any, scene: Bodies) -> Bodies:
        """The scene in the numbers that an engine starts from: `world` in 60 digits."""
        made = cls.__new__(cls)
        made.ids, made.n, made.r, made.w, made.sides = scene.ids, scene.n, world.r, world.w, scene.sides
        made.walls = [(*line, wall[-1]) for line, wall in zip(world.walls, scene.walls, strict=True)]
        return made


def _number(value: Any) -> Any:
    """A number of a scene, with its roots, in 60 digits."""
    if value.fraction is not None:
        return precisely(value.fraction)
    return _evaluated(ast.parse(value.text(), mode="eval").body)


def _evaluated(node: ast.AST) -> Any:
    if isinstance(node, ast.BinOp):
        return OPERATORS[type(node.op)](_evaluated(node.left), _evaluated(node.right))
    if isinstance(node, ast.UnaryOp):
        return -_evaluated(node.operand)
    if isinstance(node, ast.Call):
        return PRECISE.sqrt(_evaluated(node.args[0]))
    assert isinstance(node, ast.Constant)
    return PRECISE.mpf(node.value)


def residuals(run: Any) -> Iterator[Residual]:
    """Every residual of a run with states."""
    bodies = Bodies(run.scene)
    knots, left = run.motion.knots, run.motion.left
    before = [1] * bodies.n
    for index, event in enumerate(run.events):
        after = left[index][1]
        if run.reversal is not None and run.reversal.after == index:
            before = [k + (w > 0) for k, w in zip(before, bodies.w, strict=True)]
        if len(event.impulses) == 1:
            yield from _of_contact(bodies, run, index, event, knots, before, after)
        before = list(after)


def _of_contact(bodies: Bodies, run: Any, index: int, event: Any, knots: Any, before: Any, after: Any) -> Any:
    time = precisely(float(event.time))
    ((a, b),) = event.impulses
    i, j = bodies.ids[a], bodies.ids[b]
    old: dict[int, list[Any]] = {}
    new: dict[int, list[Any]] = {}
    flown: dict[int, tuple[Any, Any]] = {}
    for k in range(bodies.n):
        if k not in (i, j) and after[k] == before[k]:
            continue
        last = [precisely(v) for v in knots[k][before[k] - 1]]
        told = [precisely(v) for v in knots[k][after[k] - 1]]
        dt = time - last[0]
        fx, fy = last[1] + last[3] * dt, last[2] + last[4] * dt
        old[k], new[k], flown[k] = last, told, (fx, fy)
        if after[k] == before[k]:
            new[k] = [time, fx, fy, last[3], last[4]]
            continue
        age = index - sum(1 for t, _ in run.motion.left[:index] if t <= float(last[0]))
        for axis, f in ((0, fx), (1, fy)):
            p0, v, p, v2 = last[1 + axis], last[3 + axis], told[1 + axis], told[3 + axis]
            size = abs(p0) + abs(p)
            clock = size + (abs(v) + abs(v2)) * abs(time)
            yield Residual(
                "flight", index, abs(p - f), {"place": size, "clock": clock, "clock*age": clock * (age + 1)}, {"k": k}
            )
    yield from impact_residuals(bodies, index, i, j, time, old, new, flown)


def impact_residuals(
    bodies: Bodies, index: int, i: int, j: int, time: Any, old: Any, new: Any, flown: Any
) -> Iterator[Residual]:
    """The residuals of gap and impulse of one contact.

    Args:
        bodies: the scene.
        index: of the event.
        i, j: the two by their places; a wall comes after all circles.
        time: that is told.
        old, new: [t, x, y, vx, vy] of circles, as they were last told and as they are told now; t is that of telling.
        flown: where their own flights take them by the time.
    """
    vi, vi2 = old[i][3:], new[i][3:]
    wi, wj, reach = bodies.w[i], ZERO, ZERO
    vj, vj2 = [ZERO, ZERO], [ZERO, ZERO]
    size = max(abs(v) for v in new[i][1:3])
    speed = PRECISE.hypot(*vi)
    if j < bodies.n:
        wj, vj, vj2 = bodies.w[j], old[j][3:], new[j][3:]
        size, speed = max(size, *(abs(v) for v in new[j][1:3])), speed + PRECISE.hypot(*vj)
        reach = bodies.r[i] + bodies.r[j]
        dx, dy = new[j][1] - new[i][1], new[j][2] - new[i][2]
        far = PRECISE.hypot(dx, dy)
        told = far - reach
        own = PRECISE.hypot(flown[j][0] - flown[i][0], flown[j][1] - flown[i][1]) - reach
        nx, ny = dx / far, dy / far
        since = max(old[i][0], old[j][0])
        back = time - since
        away = PRECISE.hypot(dx - (vj[0] - vi[0]) * back, dy - (vj[1] - vi[1]) * back)
        square, size, turn = away * away / reach, max(size, reach), size / reach
    else:
        x0, y0, nx, ny, bad = bodies.walls[j - bodies.n]
        side = bodies.sides[i][j - bodies.n]
        nx, ny = -side * nx, -side * ny
        told = -(nx * (new[i][1] - x0) + ny * (new[i][2] - y0)) - bodies.r[i]
        own = -(nx * (flown[i][0] - x0) + ny * (flown[i][1] - y0)) - bodies.r[i]
        from_point = PRECISE.hypot(new[i][1] - x0, new[i][2] - y0)
        size, turn = max(size, abs(x0), abs(y0), bodies.r[i]), bad
        square = from_point * (1 + bad)
    clock = size + (speed + PRECISE.hypot(*vi2) + PRECISE.hypot(*vj2)) * abs(time)
    lean = turn + clock / reach if j < bodies.n else turn
    for kind, gap in (("told gap", told), ("flown gap", own)):
        sizes = {"place": size, "clock": clock, "clock+d2/R": clock + square}
        yield Residual(kind, index, abs(gap), sizes, {"gap": gap})
    closing = (vj[0] - vi[0]) * nx + (vj[1] - vi[1]) * ny
    relative = PRECISE.hypot(vj[0] - vi[0], vj[1] - vi[1])
    for w, v, v2, way in ((wi, vi, vi2, 1), (wj, vj, vj2, -1)):
        if w == 0:
            continue
        share = w / (wi + wj)
        want = way * 2 * share * closing
        gx, gy = v2[0] - v[0], v2[1] - v[1]
        along, across = gx * nx + gy * ny - want, gy * nx - gx * ny
        own_size = PRECISE.hypot(*v) + PRECISE.hypot(*v2)
        sizes = {
            "speeds": own_size,
            "speeds+rel": own_size + share * relative,
            "with X/R": own_size + share * relative * (1 + turn),
            "with clock/R": own_size + share * relative * (1 + lean),
        }
        yield Residual("strength", index, abs(along), sizes, {"closing": closing, "want": want})
        yield Residual("direction", index, abs(across), sizes, {"closing": closing, "want": want})
