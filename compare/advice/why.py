"""Why no setting of an engine was right: how far they came, what would be needed, and what the divergence is due to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..chaos.hazard.errors import ErrorModel, model_of
from ..chaos.horizon import Forecaster
from ..chaos.levels import LEVELS
from ..comparison import candidate_of, explained
from ..outcomes.outcome import outcomes_of
from ..tangent.impacts import NoTangentMap, impacts

if TYPE_CHECKING:
    from ..study import Study
    from .goal import Judged
    from .ladder import Setting

DIAGNOSED_WORK = 2_000_000
"""Work of the costliest run whose cause is looked for, by experiments that take many times as much."""

SHOWN = 4
"""Settings whose reach is shown."""


def reasons(where: str, study: Study, tried: Sequence[tuple[Setting, Judged | None]]) -> tuple[str, ...]:
    """Sentences, the most telling first.

    Args:
        where: the scene on which the last setting was wrong, in words.
        study: its certified run.
        tried: each setting, and what came out on that scene; None where it was not tried there.
    """
    if not tried:
        return ("The budget does not suffice for one run of the cheapest setting.",)
    setting, judged = tried[-1]
    last = None if judged is None else f"The last tried, {setting.text}, on {where}: {judged.told}."
    sentences = (last, _reach(study, tried), _needed(study, setting), _cause(study, tried))
    return tuple(sentence for sentence in sentences if sentence)


def _reach(study: Study, tried: Sequence[tuple[Setting, Judged | None]]) -> str | None:
    """How many events the best of each step, or width, agreed on."""
    best: dict[float, int] = {}
    for setting, judged in tried:
        if judged is not None and judged.agreed is not None:
            key = setting.engine.step or float(setting.engine.bits or 0)
            best[key] = max(best.get(key, 0), judged.agreed)
    reached = list(best.values())[-SHOWN:]
    if len(reached) < 2:
        return None
    what = "halving of the step" if tried[-1][0].engine.step is not None else "wider number"
    return (
        f"Of {len(study.reference.events):,} events, each {what} agreed on: ... "
        f"{', '.join(f'{count:,}' for count in reached)}."
    )


def _needed(study: Study, setting: Setting) -> str | None:
    """The step, or the bits, with which half of such runs keep the whole history, foreseen from the certified run."""
    declared, reference = model_of(setting.engine), study.reference
    if declared is None or not reference.events:
        return None
    try:
        curve = Forecaster(reference, impacts(reference, len(reference.events))).curve(declared[0])
    except NoTangentMap:
        return None
    unit = curve.unit_at(LEVELS[declared[0].name][1])
    if unit >= declared[1] or math.isinf(unit):
        return None
    rate = "Errors grow along the certified run so that it would take"
    if declared[0] is ErrorModel.STEPPED:
        steps = math.log10(float(reference.final_time)) - unit * math.log10(2)
        return f"{rate} a step of about 2**{math.floor(unit)}, some 10**{steps:.0f} steps, to keep every event."
    return f"{rate} about {math.ceil(-unit)} bits to keep every event."


def _cause(study: Study, tried: Sequence[tuple[Setting, Judged | None]]) -> str | None:
    """What the first divergence is due to, by experiment, at the costliest setting that is cheap enough for that."""
    cheap = [setting for setting, judged in tried if setting.work <= DIAGNOSED_WORK and judged and not judged.right]
    if not cheap:
        return None
    setting = cheap[-1]
    found = candidate_of(study, setting.text, setting.engine, outcomes_of(study.reference), None, None)
    if found.alignment.divergence is None:
        return None
    diagnosis = explained(study, found, setting.engine, None).diagnosis
    if diagnosis is None:
        return None
    return f"Why {setting.text} leaves the history at event {found.alignment.divergence.event}: {diagnosis}."
