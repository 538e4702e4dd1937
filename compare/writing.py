"""Writes files whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path


def check_writable(path: str | Path) -> None:
    """Refuses a place that cannot be written to, before any work is done for it.

    Raises:
        SceneError: naming the file and the reason.
    """
    from ..scenarios.errors import SceneError

    target = Path(path)
    try:
        is_folder, has_folder = target.is_dir(), target.parent.is_dir()
    except OSError as error:
        raise SceneError(f"file {str(path)!r}: {error.strerror or error}; choose another place to write to") from None
    if is_folder:
        raise SceneError(f"file {str(path)!r}: is a folder; name a file in it")
    if not has_folder:
        raise SceneError(f"file {str(path)!r}: there is no folder {str(target.parent)!r}; create it first")
    if not os.access(target if target.exists() else target.parent, os.W_OK):
        raise SceneError(f"file {str(path)!r}: writing there is not permitted; choose another place to write to")


def check_folder(path: str | Path) -> None:
    """Refuses what is no folder that can be written to.

    Raises:
        SceneError: naming it and the remedy.
    """
    from ..scenarios.errors import SceneError

    if not Path(path).is_dir():
        raise SceneError(f"folder {str(path)!r}: there is none of that name; create it first")
    check_writable(Path(path) / "perturbed")


def write_whole(path: str | Path, text: str | Iterable[str]) -> None:
    """Writes UTF-8 text, given whole or in parts: all of it or nothing, so that it is on disk once this returns.

    Raises:
        SceneError: if the place cannot be written to.
    """
    from ..scenarios.disk import write_file
    from ..scenarios.errors import SceneError

    target, parts = Path(path), [text] if isinstance(text, str) else text
    try:
        if target.exists() and not target.is_file():
            with target.open("w", encoding="utf-8", newline="") as file:  # a device or a pipe, such as /dev/stdout
                file.writelines(parts)
        else:
            write_file(target, (part.encode("utf-8") for part in parts))
    except OSError as error:
        raise SceneError(f"file {str(path)!r}: {error.strerror or error}; choose another place to write to") from None
