"""A scene in the numbers of a certificate: sums of products of fractions and named roots."""

from __future__ import annotations

from fractions import Fraction
from typing import Any, cast

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.things import Circle, Pocket, Wall
from .tower import ONE, WORK, ZERO, Exact

SCENE_ROOTS = 12


def exact_number(q: Quantity) -> Exact:
    """A quantity in the checker's exact numbers, whose list of roots grows where it must.

    Raises:
        Undecided: if it needs more roots than a certificate may hold.
    """
    if q.rational is not None:
        return Exact(Fraction(int(q.rational.p), int(q.rational.q)))
    parts = [exact_number(part) for part in q.args]
    if q.op == "sqrt":
        return parts[0].sqrt() if parts[0] else ZERO
    left, right = parts
    if q.op == "+":
        return left + right
    if q.op == "-":
        return left - right
    return left * right if q.op == "*" else left / right


def text_of(value: Exact) -> str:
    """A number as a certificate spells it.

    >>> text_of(Exact(Fraction(-3, 4)))
    '-3/4'
    """
    text = "+".join("*".join([str(factor), *names]) for factor, names in _terms(value))
    return text.replace("+-", "-") or "0"


def _terms(value: Exact) -> list[tuple[Fraction, list[str]]]:
    if value.k == 0:
        return [] if not value else [(value.a, [])]
    plain, rooted = _terms(value.a), _terms(cast(Exact, value.b))
    return plain + [(factor, [*names, f"r{value.k}"]) for factor, names in rooted]


def _length(wall: Any) -> Exact:
    """Of the vector between the two points that a wall is told by."""
    x, y = exact_number(wall.x1) - exact_number(wall.x0), exact_number(wall.y1) - exact_number(wall.y0)
    return (x * x + y * y).sqrt()


def scene_part(scene: Scene) -> dict[str, Any]:
    """The part `scene` of a certificate; its roots are in `Exact.roots`, to which later numbers may add.

    Raises:
        Undecided: if the scene's numbers need more roots than a certificate may hold.

    >>> from truebreak.scenarios import Circle, Scene
    >>> part = scene_part(Scene([Circle("1/2 + sqrt(8)", 0)]))
    >>> [text_of(root) for root in Exact.roots], part["circles"][0]["x"]
    (['8'], '1/2+1*r1')
    """
    Exact.roots, Exact.most, Exact.work, Exact.budget = [], SCENE_ROOTS, 0, WORK

    def row(thing: Circle | Wall | Pocket, keys: tuple[str, ...]) -> dict[str, str]:
        return {"id": str(thing.id), **{key: text_of(exact_number(getattr(thing, key))) for key in keys}}

    circles = []
    for circle in scene.circles:
        weight = ZERO if isinstance(circle.m, str) else ONE / exact_number(circle.m)
        circles.append({**row(circle, ("x", "y", "r", "vx", "vy")), "w": text_of(weight)})
    told: dict[str, Any] = {"tie_policy": str(scene.tie_policy)}
    if scene.reverse_after is not None:
        told["reverse_after"] = scene.reverse_after
    if scene.reverse_at is not None:
        told["reverse_at"] = text_of(exact_number(scene.reverse_at))
    told["circles"] = circles
    if scene.walls:
        told["walls"] = [
            {**row(wall, ("x0", "y0", "x1", "y1")), "length": text_of(_length(wall))} for wall in scene.walls
        ]
    if scene.pockets:
        told["pockets"] = [row(pocket, ("x", "y", "r")) for pocket in scene.pockets]
        told["capture"] = scene.capture
    if Exact.roots:
        told["roots"] = [text_of(root) for root in Exact.roots]
    return told
