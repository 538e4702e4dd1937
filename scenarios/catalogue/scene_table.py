"""The table of all scenes in the catalogue, and how one is built from its name."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from ..errors import SceneError, cut
from ..scene import Scene
from .scene_entry import SceneEntry

FAMILIES = {
    "article": "article",
    "cradle": "line",
    "tennis": "line",
    "sizes": "line",
    "galperin": "line",
    "lee": "line",
    "near-tie": "line",
    "inscribed": "degenerate",
    "rack": "rack",
    "gas": "gas",
    "reversal": "gas",
    "echo": "gas",
    "pinball": "billiard_tables",
    "lorentz": "billiard_tables",
    "point": "billiard_tables",
    "grazing": "degenerate",
    "corner": "degenerate",
    "siam": "billiard_tables",
    "hexagon": "billiard_tables",
    "two-in-a-box": "billiard_tables",
    "three-disc": "billiard_tables",
    "free-discs": "article",
    "magic-masses": "article",
    "cross": "article",
    **dict.fromkeys(
        ("triangle", "barrier", "wind-tree", "bumper", "funnel", "breakout", "ghost", "corner-hit"), "straight_tables"
    ),
    **dict.fromkeys(("beads", "collapse"), "line"),
    "cooling": "gas",
    **dict.fromkeys(
        ("bounce", "drop-pair", "falling-line", "wedge", "gas-under-gravity", "closing-wall", "piston", "paddle"),
        "falling_scenes",
    ),
    **dict.fromkeys(("landing", "struck"), "falling_scenes"),
    **dict.fromkeys(("stadium", "mushroom", "lemon", "round-table"), "curved_tables"),
    **dict.fromkeys(("galton", "plinko", "peg-mirror", "axis", "ramp", "ski-jump", "platforms"), "pegboards"),
    **dict.fromkeys(("bowl", "pinball-table"), "pegboards"),
}
"""Every scene, and the module here whose `SCENES` hold it. A new scene touches that module and this table."""


def names() -> tuple[str, ...]:
    """The names of all scenes.

    >>> names()[:3]
    ('article', 'cradle', 'tennis')
    """
    return tuple(FAMILIES)


def entry(name: str) -> SceneEntry:
    """The scene of that name: its summary, its parameters, its source and what is known of it.

    Raises:
        SceneError: if there is none.

    >>> [parameter.name for parameter in entry("galperin").parameters]
    ['n']
    """
    if name not in FAMILIES:
        import difflib

        near = difflib.get_close_matches(name, FAMILIES, n=1)
        hint = f"did you mean {near[0]!r}? " if near else ""
        raise SceneError(f"no scene {cut(name)} in the catalogue; {hint}it has: {', '.join(FAMILIES)}")
    return import_module(f".{FAMILIES[name]}", __package__).SCENES[name]


def build(spec: str, **settings: Any) -> Scene:
    """The scene that `NAME` or `NAME:key=value,key=value` says; settings may also be given by name.

    Raises:
        SceneError: for an unknown name or key, and for a value that the scene cannot have.

    >>> build("lee").ids
    ('left', 'middle', 'right')
    >>> build("galperin:n=1").name, build("galperin", n=1).name
    ('galperin:n=1', 'galperin:n=1')
    """
    name, colon, rest = spec.partition(":")
    scene = entry(name.strip())
    given: dict[str, Any] = {}
    for part in rest.split(",") if colon and rest.strip() else ():
        key, equals, value = (piece.strip() for piece in part.partition("="))
        if not equals:
            raise SceneError(f"catalogue scene {scene.name!r}: {cut(part)} is not a setting; write key=value")
        if key in given:
            raise SceneError(f"catalogue scene {scene.name!r}: {key} is set twice; keep one")
        given[key] = value
    return scene.build({**given, **settings})
