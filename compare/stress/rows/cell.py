"""One place of the map in every engine, as a row of plain data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from ....exact.exact_engine import ExactEngine
from ...alignment.align import UNKNOWING
from ...audit.audit import audit_run
from ...chaos.following import Followed, follow
from ...deadline import uninterrupted
from ...engines import engine as engine_named
from ...files.documents import laws_brief
from ...outcomes.matched import held
from ...outcomes.outcome import outcomes_of
from ...validation import EngineError
from ..family import MapPlace
from ..table import family
from .marks import MapMark
from .witness import witness

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ....scenarios.trajectory import Trajectory

StressRow: TypeAlias = dict[str, Any]

MARKS = {
    "diverged": MapMark.WRONG,
    "unsettled": MapMark.UNSETTLED,
    "undecided": MapMark.UNDECIDED,
    "agree": MapMark.RIGHT,
}
"""Of each verdict, where no outcome changed."""


@dataclass(frozen=True)
class Job:
    """A place and the engines to hold against its certified run; made of text, so that any worker can take it."""

    place: MapPlace
    engines: tuple[str, ...]


def row_of(job: Job) -> StressRow:
    """The row of one place; there is no clock in it, and nothing is drawn but from its seed.

    >>> row = row_of(Job(MapPlace("near-ties", 20, "left"), ("double", "quad")))
    >>> row["exact"]["mark"], row["engines"]["double"]["mark"], row["engines"]["quad"]["mark"]
    ('right', 'wrong', 'right')
    """
    of, place = family(job.place.family), job.place
    scene = of.scene(place)
    run = uninterrupted(ExactEngine().run(scene))
    told, outcomes = witness(run, of, place), outcomes_of(run)
    return {
        "family": place.family,
        "side": place.side,
        "seed": place.seed,
        "k": place.k,
        "scene": scene.digest,
        "events": len(run.events),
        "collisions": run.collisions,
        "stop": run.stop.reason.name.lower(),
        "exact": {"mark": told.mark.value, "told": told.told, "closed_form": told.closed_form},
        "engines": {label: _held(run, label, outcomes) for label in job.engines},
    }


def _held(run: Trajectory, label: str, outcomes: Mapping[str, Any]) -> StressRow:
    """The mark of one engine: where it is wrong, with the first event that differs and the outcomes changed.

    What is right otherwise is wrong where a law is not kept, and `laws` says which.

    An engine that hands back what can be no history, such as an event before the start, is wrong too. What it raises,
    one of truebreak's own too, is the end of its answer, and not of the map.
    """
    try:
        engine = engine_named(label)
        told = follow(run, engine, len(run.events))
    except EngineError as error:
        if error.__cause__ is not None:  # somebody else's engine raised it
            return {"mark": MapMark.FAILED.value, "told": str(error)}
        return {"mark": MapMark.WRONG.value, "event": None, "changed": [], "told": str(error)}
    except Exception as error:
        return {"mark": MapMark.FAILED.value, "told": f"{type(error).__name__}: {' '.join(str(error).split())}"}
    study, divergence = told.study, told.alignment.divergence
    patience, mine = study.patience(engine.step), study.longest or run
    changed = list(held(told.run, mine, told.alignment, study.span, patience, outcomes_of, outcomes).changed)
    mark = mark_of(told, changed=bool(changed))
    if mark is MapMark.RIGHT:
        laws = audit_run(told.run, engine)
        if laws.kept is False:
            return {"mark": MapMark.WRONG.value, "event": None, "changed": changed, "laws": laws_brief(laws)}
    row: StressRow = {"mark": mark.value}
    if mark is MapMark.WRONG:
        row |= {"event": None if divergence is None else divergence.event, "changed": changed}
    elif mark in (MapMark.UNDECIDED, MapMark.REFUSED):
        row["told"] = told.run.stop.message
    return row


def mark_of(told: Followed, *, changed: bool) -> MapMark:
    """Right or wrong, or why neither is known.

    Where the certified run itself stopped not knowing, a divergence before that stands, and all else is undecided.
    The outcomes of an engine that stopped early, or whose end is not settled, are those of another span, and
    tell nothing.
    """
    if told.unable:
        return MapMark.REFUSED
    mark = MARKS[told.alignment.verdict]
    if mark is MapMark.RIGHT and changed:
        return MapMark.WRONG
    if mark is MapMark.RIGHT and told.study.reference.stop.reason in UNKNOWING:
        return MapMark.UNDECIDED
    return mark
