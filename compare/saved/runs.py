"""Runs saved to files."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from ...scenarios.errors import SceneError
from ...scenarios.files import dump_json
from ..writing import check_writable, write_whole

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory


def check_savable(engine: str, scene: Scene, path: str) -> None:
    """Refuses, before a run, an engine whose runs have no log, a scene that no file can hold, and a place that cannot
    be written to.

    Raises:
        SceneError: saying which.
    """
    if engine != "exact":
        raise SceneError(f"--save: only runs of the exact engine are saved with their log, not those of {engine}")
    dump_json(scene)
    check_writable(path)


def save_run(trajectory: Trajectory, path: str | os.PathLike[str]) -> None:
    """Writes a run of the exact engine to a file that `load_run` reads: all of it, or nothing.

    Raises:
        SceneError: for a run of another engine, one that no file can hold, or a place that cannot be written to.
    """
    from .run_file import saved_run

    write_whole(os.fspath(path), saved_run(trajectory))
