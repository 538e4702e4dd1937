"""Why an engine left the reference's history: the table of causes, what was tried of each, and what it comes to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flint import arb

NO_CAUSE = "The histories differ"
"""The sentence of a report where no cause is known, or none that has a sentence of its own."""

LAW_RANK, FACT_RANK, RUN_RANK, SHARE_RANK = range(4)
"""A law that is not kept outranks all; then what is seen in the run itself; then what a run at other settings shows;
then shares of the displacement."""


@dataclass(frozen=True)
class Cause:
    """One class of causes.

    Attributes:
        text: what a person reads.
        experiment: where two histories part, the function that tries it, `module:function` of this folder: it takes the
            `Laboratory` and the rows so far, and gives rows. None: another one's function has it.
        rank: of causes that suffice, one of a lower rank comes first.
        rounding: whether it is floating-point error; None: where the engine takes no time steps and keeps the law.
        head: the sentence of a report for a history that it changed, where it is not.
        settings: whether it tries a series of settings, and says which of them was enough.
        family: the cause that stands for it and others, where none of them has nearly all of their share.
    """

    text: str
    experiment: str | None = None
    rank: int = RUN_RANK
    rounding: bool | None = False
    head: str = NO_CAUSE
    settings: bool = False
    family: str = ""


STEP_HEAD = "The time step changed what happened"
TUNNELS = "The time step let circles pass through what they should hit"
SOLVER_HEAD = "The solver's iterations changed what happened"

CAUSES: dict[str, Cause] = {
    "LAW": Cause("law not kept", "budget:law", LAW_RANK, head="The engine does not keep the law"),
    "STEP": Cause("time step", "other_settings:step", head=STEP_HEAD, settings=True),
    "TUNNELLING": Cause("tunnelling", "other_settings:tunnelling", FACT_RANK, head=TUNNELS),
    "ITERATIONS": Cause("solver iterations", "other_settings:iterations", head=SOLVER_HEAD, settings=True),
    "PHANTOM": Cause("phantom contact", "evidence:phantom", FACT_RANK, rounding=True),
    "PARTING": Cause(
        "contact without effect", rank=FACT_RANK, head="A contact of two that part, without effect, was reported"
    ),
    "TIE": Cause("tie", "evidence:tie", FACT_RANK, head="A tie was resolved differently"),
    "INPUT": Cause("input rounding", "evidence:shares", SHARE_RANK, rounding=True),
    "FLIGHTS": Cause("arithmetic in flights", rank=SHARE_RANK, rounding=True, family="ARITHMETIC"),
    "IMPACTS": Cause("arithmetic in impacts", rank=SHARE_RANK, rounding=True, family="ARITHMETIC"),
    "DECISION": Cause("arithmetic in the decision", rank=SHARE_RANK, rounding=True, family="ARITHMETIC"),
    "ARITHMETIC": Cause("arithmetic rounding", rank=SHARE_RANK, rounding=True),
    "OWN": Cause("errors of its own steps, not audited", rank=SHARE_RANK, rounding=None),
    "INTEGRATOR": Cause(
        "integrator", rank=SHARE_RANK, head="The way in which the engine falls changed what happened", family="STEPS"
    ),
    "LATENESS": Cause("lateness", rank=SHARE_RANK, head=STEP_HEAD, family="STEPS"),
    "OVERLAP": Cause("overlap", rank=SHARE_RANK, head=STEP_HEAD, family="STEPS"),
    "SOLVER": Cause("inexact impulses", rank=SHARE_RANK, head="Inexact impulses changed what happened", family="STEPS"),
    "THRESHOLD": Cause(
        "restitution threshold",
        rank=SHARE_RANK,
        head="A speed below which nothing bounces changed what happened",
        family="STEPS",
    ),
    "SEVERAL": Cause(
        "impulses of several contacts",
        rank=SHARE_RANK,
        head="Contacts of one instant changed what happened",
        family="STEPS",
    ),
    "MERGED": Cause("instants split or merged by steps", rank=SHARE_RANK, head=STEP_HEAD, family="STEPS"),
    "STEPS": Cause("errors of its steps", rank=SHARE_RANK, head=STEP_HEAD),
    "CORRECTION": Cause(
        "position correction", rank=SHARE_RANK, head="Position correction changed what happened", family="STEPS"
    ),
    "UNABLE": Cause("scene not possible in this engine"),
    "BUDGET": Cause("budget"),
    "WIDTH": Cause("enclosure width"),
    "ZERO": Cause("exact zero"),
    "UNKNOWN": Cause("not determined", rounding=None),
}
"""Every cause by its name in `CauseName`, in the order in which they are tried. A new one is its own file, and one line
here."""


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
    """One kind of error, and what was seen of it at the decision in question.

    Attributes:
        cause: the kind.
        result: what came out, in words; "not tried" with the reason, where it was not.
        displacement: what it adds to the number that decides, signed; None where that is not to be had.
        suffices: whether it alone changes the decision; None if that is not known.
        share: its part of the whole displacement, signed: all shares add up to 1.
    """

    cause: CauseName
    result: str
    displacement: float | None = None
    suffices: bool | None = None
    share: float | None = None


@dataclass(frozen=True)
class Contribution:
    """What one kind of error adds to the number that decides.

    Attributes:
        cause: the kind.
        size: signed, in the unit of the number: a length for hit or miss, a time for an order.
        alone: the number that decides with this kind of error alone; None where that was not run, or does not exist.
        late: whether the hit that there is with this kind alone comes after the meeting that the run without it has
            there, which is as good as a miss; None where that is not known.
    """

    cause: CauseName
    size: float
    alone: arb | None = None
    late: bool | None = False


@dataclass(frozen=True)
class Account:
    """A displacement and what it is made of.

    Attributes:
        displacement: the engine's value less the exact margin.
        contributions: they add up to it.
        own: all but the input's together: the engine's own errors.
        runs: how many continuations by the exact law were made.
        groups: how many groups of steps the run was cut into.
        lumped: why the engine's own errors are told as one, where they are.
        along: whether contributions are integrals along the way on which all errors grow together: then a size says
            nothing of what a kind does alone.
    """

    displacement: float
    contributions: tuple[Contribution, ...]
    own: Contribution
    runs: int
    groups: int
    lumped: str = ""
    along: bool = False

    def is_of_rounding(self, margin: float) -> bool:
        """Whether what rounding adds changes the decision, and what the engine's steps add does not."""
        rounding = sum(part.size for part in self.contributions if part.cause.entry.rounding)
        rest = sum(part.size for part in self.contributions if not part.cause.entry.rounding)
        return not self.lumped and margin * (margin + rounding) <= 0 < margin * (margin + rest)


@dataclass(frozen=True)
class Diagnosis:
    """Why, with all that was tried.

    Attributes:
        causes: what it comes of, the largest share first: one kind that suffices, or the fewest that do together.
        experiments: all that was tried, and all shares.
        finding: what was seen of the first cause.
        displacement: the engine's value of the number that decides less the exact one; None where it is not known.
        closed: whether the shares add up to it.
        runs: continuations by the exact law, each from a state of the engine to the decision, that the account took.
    """

    causes: tuple[CauseName, ...]
    experiments: tuple[Experiment, ...]
    finding: str
    displacement: float | None = None
    closed: bool = False
    runs: int = 0

    @property
    def name(self) -> CauseName:
        """The first cause."""
        return self.causes[0]

    def __str__(self) -> str:
        """The causes in words.

        >>> str(Diagnosis((CauseName["INPUT"], CauseName["IMPACTS"]), (), ""))
        'input rounding + arithmetic in impacts'
        """
        return " + ".join(cause.value for cause in self.causes)

    @property
    def unexplained(self) -> bool:
        """Whether nothing is named, and rounding is known not to have done it."""
        rows = [e for e in self.experiments if e.cause is CauseName["ARITHMETIC"]]
        return self.name is CauseName["UNKNOWN"] and any(e.suffices is False and e.share is None for e in rows)

    @property
    def sufficient(self) -> tuple[CauseName, ...]:
        """Every kind that suffices by itself, the largest share first."""
        enough = [e for e in self.experiments if e.suffices]
        return tuple(e.cause for e in sorted(enough, key=lambda e: (e.cause.entry.rank, -abs(e.share or 0.0))))

    @property
    def shares(self) -> tuple[Experiment, ...]:
        """The account: every kind with its part of the displacement, the largest first."""
        return tuple(sorted((e for e in self.experiments if e.share is not None), key=lambda e: -abs(e.share or 0.0)))

    @property
    def families(self) -> dict[str, list[Experiment]]:
        """The account by families of kinds, such as those of arithmetic; a kind without one is its own."""
        found: dict[str, list[Experiment]] = {}
        for row in self.shares:
            found.setdefault(row.cause.entry.family or row.cause.name, []).append(row)
        return found

    def large(self, least: float) -> list[Experiment]:
        """The shares of some size, of families of some size: elsewhere kinds cancel each other."""
        rows = [row for rows in self.families.values() if abs(_sum(rows)) >= least for row in rows]
        return [row for row in self.shares if row in rows and abs(row.share or 0.0) >= least]


def _sum(rows: Sequence[Experiment]) -> float:
    return math.fsum(row.share or 0.0 for row in rows)


Bounds = tuple[float, float]
"""Doubles around a number that is known exactly."""


@dataclass(frozen=True)
class Margin:
    """How close the decision was in the exact motion, and how far off the engine was by then.

    Attributes:
        gap: the time between the two meetings, each taken as if nothing hindered it; None for hit or miss.
        distance: for hit or miss, the least distance of the surfaces in free flight, negative for the depth of a hit;
            for an order, how far apart the pair that comes second is when the first one meets.
        speed: for a wall that the circle comes to in one run alone, the speed at which it leaves it; negative: comes.
        ulps: `gap` in units of a double's spacing at that time.
        error: the largest distance between the engine's place and the exact one of the circles in question, at the
            earlier of the two events.
        growth: bits an event by which a small error grows along the exact run up to there; None if not known.
        cut: whether the user's seconds were over before all of this was measured.
        entry: the circle and the pocket, where it is whether, or when, the one's centre comes to the other's rim.
    """

    gap: Bounds | None = None
    distance: Bounds | None = None
    speed: Bounds | None = None
    ulps: float | None = None
    error: float | None = None
    growth: float | None = None
    cut: bool = False
    entry: tuple[str, str] | None = None

    @property
    def ratio(self) -> float | None:
        """The error over the distance: above about 1, the error explains the divergence."""
        if self.error is None or self.distance is None:
            return None
        middle = abs(self.distance[0] + self.distance[1]) / 2
        return self.error / middle if middle else math.inf if self.error else None


NOTHING_TRIED = "nothing that was tried changes the decision by itself"


def diagnosed(
    experiments: Sequence[Experiment], margin: float | None, displacement: float | None, runs: int
) -> Diagnosis:
    """The diagnosis that a table of experiments gives.

    What suffices by a run comes before shares. Of these, the largest that suffices is the cause; where none does, the
    fewest, largest first, that push the decision's number past zero together.

    Args:
        margin: the exact value of the number that decides.

    >>> rows = [("INPUT", -3.0, 0.75), ("IMPACTS", -1.0, 0.25)]
    >>> table = [Experiment(CauseName[name], "", size, False, share) for name, size, share in rows]
    >>> str(diagnosed(table, 3.5, -4.0, 0))
    'input rounding + arithmetic in impacts'
    """
    closed = displacement is not None and any(e.share is not None for e in experiments)
    left = [row for row in experiments if row.cause is CauseName["UNKNOWN"] or "not determined" in row.result]
    why = "; ".join(_why(row) for row in left if not row.suffices) or NOTHING_TRIED
    made = Diagnosis((CauseName["UNKNOWN"],), tuple(experiments), why, displacement, closed, runs)
    enough = made.sufficient
    if enough and enough[0].entry.rank < SHARE_RANK:
        return _named(made, enough[:1])
    families = made.families
    sizes = {name: _sum(rows) for name, rows in families.items()}
    pushing = [name for name in sorted(sizes, key=lambda name: -sizes[name]) if sizes[name] > 0]
    alone = [
        name
        for name in pushing
        if CauseName[name] in enough
        or (any(row.suffices for row in families[name][:1]) and not _not_alone(made, name, families[name]))
        or any(row.suffices and (row.share or 0.0) >= NEARLY_ALL for row in families[name])
    ]
    if alone:
        return _named(made, (_chief(alone[0], families[alone[0]]),))
    value = margin
    for count, name in enumerate(pushing, 1):
        if value is None or margin is None or displacement is None:
            break
        value += sizes[name] * displacement
        if count == 1 and _not_alone(made, name, families[name]):
            continue
        if (value * margin <= 0 or abs(value) <= SUMMED * abs(margin)) and value != margin:
            return _named(made, tuple(_chief(each, families[each]) for each in pushing[:count]))
    if enough and sizes.get(enough[0].name, 1.0) > 0:  # what acts against the displacement is not what made it
        return _named(made, enough[:1])
    if pushing and margin is not None and displacement is not None and margin * (margin + displacement) <= 0:
        large = [name for name in sorted(sizes, key=lambda name: -sizes[name]) if abs(sizes[name]) >= SMALL]
        return _named(made, tuple(_chief(each, families[each]) for each in large))
    return _named(made, enough[:1]) if enough else made


def _why(row: Experiment) -> str:
    """Why it is not determined what comes of a cause, by its name where it has one."""
    return row.result if row.cause is CauseName["UNKNOWN"] else f"{row.cause.value}: {row.result}"


def _not_alone(made: Diagnosis, name: str, rows: Sequence[Experiment]) -> bool:
    """Whether a run has shown that a family, or the kind that has nearly all of it, changes nothing alone."""
    shown = [e.suffices for e in made.experiments if e.cause is _chief(name, rows)]
    return False in (shown or [row.suffices for row in rows if len(rows) == 1])


def _chief(name: str, rows: Sequence[Experiment]) -> CauseName:
    """The cause that a family is named by: the kind that has nearly all of it, or the family's own."""
    total = sum(abs(row.share or 0.0) for row in rows)
    return rows[0].cause if abs(rows[0].share or 0.0) >= NEARLY_ALL * total else CauseName[name]


def _named(made: Diagnosis, causes: tuple[CauseName, ...]) -> Diagnosis:
    """With its causes, and what was seen of them; steps that were not audited may be of another law."""
    if CauseName["OWN"] in causes:
        return replace(made, finding=next(e.result for e in made.experiments if e.cause is CauseName["OWN"]))
    found: list[str] = []
    for cause in causes:
        rows = [e.result for e in made.experiments if e.cause is cause][:1]
        found += rows or [e.result for e in made.shares if e.cause.entry.family == cause.name]
    return replace(made, causes=causes, finding="; ".join(found))


SMALL = 0.1
"""Share from which on a kind is named, where none pushes the decision over without those that act against it."""

SUMMED = 2.0**-40
"""Share of the margin to which kinds add up in doubles: what an answer is rounded by is what was left to zero."""

NEARLY_ALL = 0.9
"""Share of its family that a kind has to have to be named in its place."""
