"""Input rounding alone: the exact run of what the engine is given."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING

from ....scenarios.errors import SceneError
from ....scenarios.numbers.quantity import Quantity
from ...deadline import NO_TIME
from ..decision.rounding import rounded, shifted
from ..diagnosis import CauseName, Experiment
from ..laboratory.shown import SMALLER, shown, to_first_order

if TYPE_CHECKING:
    from ..decision.reader import RunReader
    from ..laboratory.laboratory import Laboratory
    from ..so_far import SoFar

CAUSE = CauseName["INPUT"]


def input_rounding(lab: Laboratory, found: SoFar) -> list[Experiment]:
    """The reference engine on the scene in the engine's numbers."""
    found.entered, row = lab.tried(lambda: _input(lab), (None, Experiment(CAUSE, NO_TIME)))
    return [row]


def _input(lab: Laboratory) -> tuple[RunReader | None, Experiment]:
    """A reader of it, and what it shows."""
    if not lab.engine.rounds_input:
        return lab.truth, Experiment(CAUSE, "no input is rounded", 0.0, False)
    if lab.given is None:
        try:
            rounded(lab.study.scene, lab.bits)
        except SceneError as error:
            return None, Experiment(
                CAUSE, f"rounded to {lab.numbers}, the scene is no longer valid: {error}", None, True, 1.0
            )
    assert lab.given is not None
    if lab.given.digest == lab.study.scene.digest:
        return lab.truth, Experiment(CAUSE, f"the scene is exact in {lab.numbers}, so no input was rounded", 0.0, False)
    run = lab.run(lab.study.truth, lab.given, lab.until(None))
    reader = lab.reader(run, lab.given, None)
    if lab.decision is None:
        return reader, Experiment(CAUSE, "not tried: no contact can be named")
    told = shown(lab, CAUSE, lab.decision, lab.truth, reader, f"the reference engine on the scene in {lab.numbers}")
    return reader, told if told.displacement is not None else to_first_order(told, _linear(lab))


def _linear(lab: Laboratory) -> float | None:
    """What input rounding moves the decision by, to the first order: by the response to a 2**-`SMALLER` part of it."""
    assert lab.decision is not None
    try:
        scene = shifted(lab.study.scene, Quantity.of(Fraction(1, 2**SMALLER)), lab.bits)
    except SceneError:
        return None
    run = lab.run(lab.study.truth, scene, lab.until(None))
    moved = lab.moved(lab.reader(run, scene, None).value(lab.decision), lab.margin)
    return None if moved is None else math.ldexp(moved, SMALLER)
