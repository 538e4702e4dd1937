"""The scene that a word on the command line names: a catalogue scene or a file."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..scenarios.errors import SceneError

if TYPE_CHECKING:
    from ..scenarios.scene import Scene

FILE_SUFFIXES = (".toml", ".json")


def scene_from(text: str) -> Scene:
    """The scene of `NAME`, `NAME:key=value,...`, or a path to a .toml or .json file.

    Raises:
        SceneError: if there is no such scene or file, or it is not a valid scene.
    """
    from ..scenarios import catalogue

    name = text.partition(":")[0]
    looks_like_file = text.lower().endswith(FILE_SUFFIXES) or os.sep in text or _is_file(text)
    if looks_like_file and name not in catalogue.names():
        from ..scenarios.files import load_scene

        return load_scene(text)
    return catalogue.build(text)


def _is_file(text: str) -> bool:
    """Whether there is such a file; a name that no file can have is none."""
    try:
        return Path(text).is_file()
    except OSError:
        return False


def changed(
    scene: str, reverse_after: int | None, tie_policy: str | None, *, limited: bool, symmetric: bool = False
) -> Scene:
    """The scene of the command line, with a reversal or a tie policy of the command line in place of its own.

    A reversal of the command line takes the place of the scene's default horizon too, unless the command line
    sets one: the run then ends at the return.
    """
    changes: dict[str, Any] = {}
    if reverse_after is not None:
        changes |= {"reverse_after": reverse_after, "reverse_at": None}
        if not limited:
            changes |= {"until": None, "events": None}
    if tie_policy is not None:
        changes["tie_policy"] = tie_policy
    loaded = scene_from(scene)
    if changes:
        loaded = loaded.with_changes(**changes)
    if symmetric:
        from ..exact.log_symmetry import symmetries

        if not symmetries(loaded.surfaces):
            raise SceneError(
                f"scene {loaded.name!r}: no mirror and no rotation maps it to itself exactly; "
                "make it symmetric, or leave out --symmetric"
            )
    return loaded


def with_settings(engine_text: str, **settings: str | int | None) -> str:
    """An engine's text with more settings; None leaves one as it is.

    >>> with_settings("exact:max_bits=4096", ties=None, work=10)
    'exact:max_bits=4096,work=10'
    """
    given = ",".join(f"{key}={value}" for key, value in settings.items() if value is not None)
    if not given:
        return engine_text
    from .engines import class_path

    path = class_path(engine_text)
    begun = path.settings != "" if path is not None else ":" in engine_text
    return f"{engine_text}{',' if begun else ':'}{given}"
