"""Whether the scene of a certificate is the one meant: its block compared with a scene, number by number."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ...scenarios.numbers.quantity import ZERO, Quantity

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.things import Circle, Pocket, Wall

KEYS = {"circles": "x y r vx vy", "walls": "x0 y0 x1 y1", "pockets": "x y r"}
TERM = re.compile(r"([+-]?[0-9]+(?:/[0-9]+)?)((?:\*r[0-9]+)*)")


def difference(block: Mapping[str, Any], scene: Scene) -> str | None:
    """The first thing in which the scene block of a certificate differs from a scene; None where it is that scene.

    Numbers are compared as exact numbers, however they are written, and things in their order, with their names. What a
    scene says of when to end a run is no part of the block.

    Args:
        block: the `scene` of a certificate that a checker has verified.
        scene: what it is compared with.

    Raises:
        SceneError: if two numbers cannot be told from each other within counted work.

    >>> from truebreak.compare.certificate import certificate_of
    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> one, other = (Scene([Circle(0, 0, vx=1), Circle(x, 0)]) for x in ("sqrt(12)", "2*sqrt(3)"))
    >>> block = certificate_of(ExactEngine().run(one))["scene"]
    >>> difference(block, other), difference(block, Scene([Circle(0, 0, vx=1), Circle(5, 0)]))
    (None, "circle 'c2': x is 1*r1, not 5")
    """
    roots: list[Quantity] = []
    for text in block.get("roots", ()):
        roots.append(_number(text, roots).sqrt())
    things: dict[str, Sequence[Circle | Wall | Pocket]] = {
        "circles": scene.circles, "walls": scene.walls, "pockets": scene.pockets,
    }  # fmt: skip
    for kind, meant in things.items():
        told = block.get(kind, ())
        if len(told) != len(meant):
            return f"it has {len(told)} {kind}, not {len(meant)}"
        for row, thing in zip(told, meant, strict=True):
            name = f"{kind[:-1]} {row['id']!r}"
            if row["id"] != str(thing.id):
                return f"{name} is not {str(thing.id)!r}"
            for key in KEYS[kind].split():
                value: Quantity = getattr(thing, key)
                if not _same(row[key], value, roots):
                    return f"{name}: {key} is {row[key]}, not {value}"
            if kind == "circles":
                mass = getattr(thing, "m")  # noqa: B009 (only circles have one)
                if not _same(row["w"], ZERO if isinstance(mass, str) else Quantity.of(1) / mass, roots):
                    return f"{name}: w is {row['w']}, and not one over the mass {mass}"
    policy = {"sequential": "sequential:order=scene"}
    ours, theirs = str(scene.tie_policy), str(block["tie_policy"])
    if policy.get(ours, ours) != policy.get(theirs, theirs):
        return f"its tie policy is {theirs}, not {ours}"
    if block.get("reverse_after") != scene.reverse_after:
        return f"reverse_after is {block.get('reverse_after')}, not {scene.reverse_after}"
    told_at = block.get("reverse_at")
    if (told_at is None) != (scene.reverse_at is None):
        return f"reverse_at is {told_at}, not {scene.reverse_at}"
    if scene.reverse_at is not None and not _same(str(told_at), scene.reverse_at, roots):
        return f"reverse_at is {told_at}, not {scene.reverse_at}"
    if scene.pockets and block.get("capture", False) != scene.capture:
        return f"capture is {block.get('capture', False)}, not {scene.capture}"
    return None


def _same(text: str, value: Quantity, roots: Sequence[Quantity]) -> bool:
    return (_number(text, roots) - value).sign() == 0


def _number(text: str, roots: Sequence[Quantity]) -> Quantity:
    """A number as a certificate spells it: r1 is the first of the roots."""
    total = ZERO
    for factor, names in TERM.findall(text):
        term = Quantity.of(factor.removeprefix("+"))
        for name in names.split("*r")[1:]:
            term = term * roots[int(name) - 1]
        total = total + term
    return total
