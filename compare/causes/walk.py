"""Walks the table of causes: why an engine left the reference's history, or why it stopped."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

from .diagnosis import CauseName, Diagnosis, Experiment, diagnosed
from .so_far import SoFar
from .table import CAUSES

if TYPE_CHECKING:
    from .laboratory.laboratory import Laboratory
    from .stops.stopped import Stopped


def diagnosis_of(lab: Laboratory) -> Diagnosis:
    """The cause of a divergence, by what suffices at the contact in question.

    Each experiment moves the number that decides: input rounding alone (the reference engine on the scene in the
    engine's numbers), arithmetic alone (from there to the engine), both together; for an engine with a time step, the
    step, in a series, passing through within a step, and the iterations of its solver; another resolution of an exact
    tie; and, where none of these, the engine's law. One that moves it past zero suffices. What the user's seconds leave
    no time for is not tried, and says so. A law that the engine has broken by then outranks all of them.
    """
    found = SoFar()
    for cause in CAUSES.values():
        if cause.experiment is not None:
            found.rows += _function(cause.experiment)(lab, found)
            if cause is CAUSES["LAW"] and found.rows:
                break
    return diagnosed(found.rows)


def diagnosis_of_stop(stopped: Stopped) -> Diagnosis:
    """Why a candidate stopped: what it refuses, its budget, its width, or a zero that no width tells."""
    rows: list[Experiment] = []
    for cause in CAUSES.values():
        if cause.stop is not None:
            rows += _function(cause.stop)(stopped, rows)
        if rows and rows[-1].suffices:
            return Diagnosis(rows[-1].cause, tuple(rows), rows[-1].result)
    if not rows:
        told = stopped.message
        return Diagnosis(CauseName["UNKNOWN"], (Experiment(CauseName["UNKNOWN"], told, None, True, 1.0),), told)
    return Diagnosis(CauseName["UNKNOWN"], tuple(rows), f"{rows[-1].result}, and no number is proved to be zero")


def _function(path: str) -> Callable[..., list[Experiment]]:
    """The function of that name, imported now."""
    module, _, name = path.partition(":")
    function: Any = getattr(import_module(f".{module}", __package__), name)
    return function
