"""Runs saved from the command line."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..scenarios.errors import SceneError
from .cli.writing import check_writable, write_whole

if TYPE_CHECKING:
    from ..scenarios.trajectory import Trajectory


def check_savable(engine: str, path: str | None) -> None:
    """Refuses, before a run, an engine whose runs have no log, and a place that cannot be written to.

    Raises:
        SceneError: saying which.
    """
    if path is None:
        return
    if engine != "exact":
        raise SceneError(f"--save: only runs of the exact engine are saved with their log, not those of {engine}")
    check_writable(path)


def save_run(trajectory: Trajectory, path: str | None) -> None:
    """Writes a run, or what there is of it, whole.

    Raises:
        SceneError: if no file can hold it, or the place cannot be written to.
    """
    if path is not None:
        from ..exact.results.saved import saved_run

        write_whole(path, saved_run(trajectory))
