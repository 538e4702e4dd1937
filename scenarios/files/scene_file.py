"""Scene files on disk: read whole, written all or nothing."""

from __future__ import annotations

import os
from pathlib import Path

from ..checks.showing import cut
from ..errors import SceneError
from ..scene import Scene
from .disk import text_of, write_file
from .reader import MAX_JSON, MAX_TOML, loads_json, loads_toml
from .writer import dump_json, dump_toml

GIVE = "give the path of a scene file"


def load_scene(path: str | os.PathLike[str]) -> Scene:
    """The scene in a file: `.toml` or `.json`.

    Raises:
        SceneError: one line that names the file, the thing, its key and value, the reason and the remedy.
    """
    where = os.fspath(path)
    if _suffix(where) == ".toml":
        return loads_toml(text_of(where, MAX_TOML, GIVE), where)
    return loads_json(text_of(where, MAX_JSON, GIVE), where)


def save_scene(scene: Scene, path: str | os.PathLike[str]) -> None:
    """Writes the scene to a file, `.toml` or `.json`: all of it, or nothing.

    Raises:
        SceneError: if the scene cannot be written as such a file, or the file cannot be written.
    """
    where = os.fspath(path)
    text = dump_toml(scene) if _suffix(where) == ".toml" else dump_json(scene)
    try:
        write_file(Path(where), text.encode())
    except OSError as error:
        raise SceneError(f"{where}: cannot be written: {error.strerror or error}") from None
    except ValueError as error:  # a zero byte in the path
        raise SceneError(f"{where!r}: cannot be written: {error}") from None


def _suffix(where: str) -> str:
    suffix = Path(where).suffix.lower()
    if suffix not in (".toml", ".json"):
        raise SceneError(f"{where}: a scene file ends in .toml or .json, not in {cut(suffix)}; rename it")
    return suffix
