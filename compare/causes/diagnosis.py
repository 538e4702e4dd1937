"""Why an engine left the reference's history: a table of experiments, and what of them suffices."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from .table import CAUSES, Cause


class CauseName(Enum):
    """The classes of causes: one for each entry of `CAUSES`. The value is what a person reads.

    >>> CauseName["INPUT"].value, CauseName("time step").name
    ('input rounding', 'STEP')
    """

    _ignore_ = "names key entry_of"
    names = vars()
    for key, entry_of in CAUSES.items():
        names[key] = entry_of.text

    @property
    def entry(self) -> Cause:
        """What the table says of it."""
        return CAUSES[self.name]


@dataclass(frozen=True)
class Experiment:
    """One experiment, and what it showed at the decision in question.

    Attributes:
        cause: the class of cause that it tries.
        result: what came out, in words; "not tried" with the reason, where it was not.
        displacement: by how much it moves the number that decides; None where that is not to be had.
        suffices: whether it alone changes the decision; None if it was not tried.
        share: its part of all displacements measured; None where there is none.
    """

    cause: CauseName
    result: str
    displacement: float | None = None
    suffices: bool | None = None
    share: float | None = None


@dataclass(frozen=True)
class Diagnosis:
    """Why, with all that was tried.

    Attributes:
        name: the cause: of those that suffice, the one with the largest share.
        experiments: all of them, those not tried too.
        finding: what the experiment behind `name` showed.
    """

    name: CauseName
    experiments: tuple[Experiment, ...]
    finding: str

    def __str__(self) -> str:
        return self.name.value

    @property
    def sufficient(self) -> tuple[CauseName, ...]:
        """Every cause that suffices, the largest share first."""
        enough = [e for e in self.experiments if e.suffices]
        return tuple(e.cause for e in sorted(enough, key=lambda e: -(e.share or 0.0)))


def diagnosed(experiments: list[Experiment]) -> Diagnosis:
    """The diagnosis that a table of experiments gives. Shares are told where all that suffices was measured.

    >>> diagnosed([Experiment(CauseName["INPUT"], "moves it by 3", 3.0, True, 0.75)]).name.value
    'input rounding'
    """
    if not any(e.suffices for e in experiments):
        told = "nothing that was tried changes the decision by itself"
        return Diagnosis(CauseName["UNKNOWN"], tuple(experiments), told)
    measured = all(e.displacement is not None for e in experiments if e.suffices)
    total = sum(abs(e.displacement) for e in experiments if e.displacement is not None) if measured else 0.0
    rows = tuple(
        e
        if e.share is not None or e.displacement is None or not total
        else Experiment(e.cause, e.result, e.displacement, e.suffices, abs(e.displacement) / total)
        for e in experiments
    )
    first = max((e for e in rows if e.suffices), key=lambda e: e.share or 0.0)
    return Diagnosis(first.cause, rows, first.result)
