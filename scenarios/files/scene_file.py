"""Scene files on disk: read whole, written all or nothing."""

from __future__ import annotations

import os
import secrets
import stat
from pathlib import Path

from ..checks.showing import cut
from ..errors import SceneError
from ..scene import Scene
from .reader import MAX_JSON, MAX_TOML, loads_json, loads_toml
from .writer import dump_json, dump_toml


def load_scene(path: str | os.PathLike[str]) -> Scene:
    """The scene in a file: `.toml` or `.json`.

    Raises:
        SceneError: one line that names the file, the thing, its key and value, the reason and the remedy.
    """
    where = os.fspath(path)
    if _suffix(where) == ".toml":
        return loads_toml(_text_of(where, MAX_TOML), where)
    return loads_json(_text_of(where, MAX_JSON), where)


def save_scene(scene: Scene, path: str | os.PathLike[str]) -> None:
    """Writes the scene to a file, `.toml` or `.json`: all of it, or nothing.

    Raises:
        SceneError: if the scene cannot be written as such a file, or the file cannot be written.
    """
    where = os.fspath(path)
    text = dump_toml(scene) if _suffix(where) == ".toml" else dump_json(scene)
    target = Path(where)
    partial = target.with_name(f".{secrets.token_hex(8)}.tmp")
    try:
        try:
            partial.write_text(text, encoding="utf-8", newline="\n")
            partial.replace(target)
        finally:
            partial.unlink(missing_ok=True)
    except OSError as error:
        raise SceneError(f"{where}: cannot be written: {error.strerror or error}") from None
    except ValueError as error:  # a zero byte in the path
        raise SceneError(f"{where!r}: cannot be written: {error}") from None


def _suffix(where: str) -> str:
    suffix = Path(where).suffix.lower()
    if suffix not in (".toml", ".json"):
        raise SceneError(f"{where}: a scene file ends in .toml or .json, not in {cut(suffix)}; rename it")
    return suffix


def _text_of(where: str, limit: int) -> str:
    """The text of a regular file, which must be UTF-8."""
    path = Path(where)
    try:
        about = path.stat()
        regular = stat.S_ISREG(about.st_mode)
        raw = path.read_bytes() if regular and about.st_size <= limit else b""
    except FileNotFoundError:
        raise SceneError(f"{where}: no such file; check the path") from None
    except OSError as error:
        raise SceneError(f"{where}: cannot be read: {error.strerror or error}") from None
    except ValueError as error:  # a zero byte in the path
        raise SceneError(f"{where!r}: cannot be read: {error}") from None
    if not regular:
        what = "a directory" if stat.S_ISDIR(about.st_mode) else "not a regular file"
        raise SceneError(f"{where}: is {what}; give the path of a scene file")
    if about.st_size > limit:
        raise SceneError(f"{where}: has {about.st_size} bytes; at most {limit} for {path.suffix.lower()}")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise SceneError(f"{where}: is not UTF-8 text (at byte {error.start}); save it as UTF-8") from None
