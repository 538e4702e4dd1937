"""The scene that a word on the command line names: a catalogue scene or a file."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

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
    looks_like_file = text.lower().endswith(FILE_SUFFIXES) or os.sep in text or Path(text).is_file()
    if looks_like_file and name not in catalogue.names():
        from ..scenarios.files import load_scene

        return load_scene(text)
    return catalogue.build(text)
