"""What is to be right: the history or its beginning, an outcome, or digits at the end."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from ...scenarios.errors import SceneError
from ..alignment.instants import Kind
from ..audit.audit import audit_run
from ..chaos.accuracy import end_error
from ..chaos.horizon import follow
from ..comparison import candidate_of
from ..engines import suggestion
from ..files.amounts import plain
from ..outcomes.outcome import outcomes_of
from ..validation import EngineError

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.trajectory import Trajectory
    from ..alignment.instants import Divergence
    from ..study import Study


@dataclass(frozen=True)
class Judged:
    """One run compared with the certified run.

    Attributes:
        right: whether what was asked for is right, and known to be, and no law is known to be broken.
        result: what came out, in a few words.
        agreed: events of the certified run before the first that differs; None where only the end was looked at.
    """

    right: bool
    result: str
    agreed: int | None = None


class Goal(Protocol):
    """What is asked for."""

    @property
    def events(self) -> int | None:
        """The limit on instants that it sets; None: the scene's own limits hold."""
        ...

    def __str__(self) -> str:
        """What is to be right, as it follows 'gets'."""
        ...

    def check(self, reference: Trajectory) -> None:
        """Refuses a scene of which it asks nothing.

        Raises:
            SceneError: with the remedy.
        """
        ...

    def judge(self, study: Study, label: str, engine: Engine) -> Judged:
        """Runs an engine and says whether it gets it right."""
        ...


@dataclass(frozen=True)
class HistoryGoal:
    """Who meets whom, to the end or in the first events.

    >>> str(HistoryGoal(20)), str(HistoryGoal())
    ('the first 20 events right', 'every event right')
    """

    events: int | None = None

    def __str__(self) -> str:
        return "every event right" if self.events is None else f"the first {self.events:,} events right"

    def check(self, reference: Trajectory) -> None:
        """Every scene has a history."""

    def judge(self, study: Study, label: str, engine: Engine) -> Judged:
        """Right if the histories agree; the run ends where they part."""
        try:
            told = follow(study.reference, engine, pay=study.pay)
        except EngineError:
            raise
        except SceneError as error:
            return Judged(False, str(error))
        alignment = told.alignment
        if told.unable:
            return Judged(False, told.run.stop.message)
        if alignment.divergence is not None:
            return Judged(False, parted(alignment.divergence, told.run), alignment.agreed)
        if alignment.verdict == "agree":
            return _lawful(Judged(True, "agrees", len(study.reference.events)), told.run, engine)
        return Judged(False, _unknown(told.run, alignment.verdict), alignment.agreed)


@dataclass(frozen=True)
class OutcomeGoal:
    """One outcome of the run, by its name.

    >>> str(OutcomeGoal("who_hit_whom"))
    "the outcome 'who_hit_whom' right"
    """

    name: str
    events: int | None = None

    def __str__(self) -> str:
        return f"the outcome {self.name!r} right"

    def check(self, reference: Trajectory) -> None:
        """The scene must have that outcome."""
        known = outcomes_of(reference)
        if self.name not in known:
            raise SceneError(f"--outcome {self.name!r}: {reference.scene.name!r} has no such outcome; "
                             f"{suggestion(self.name, list(known))}")  # fmt: skip

    def judge(self, study: Study, label: str, engine: Engine) -> Judged:
        """Right if the outcome over the span compared is the certified run's, as `compare` reports it."""
        expected = outcomes_of(study.reference)
        found = candidate_of(study, label, engine, expected, None, None)
        agreed, verdict = found.alignment.agreed, found.verdict
        if found.unable:
            return Judged(False, found.trajectory.stop.message)
        if not found.whole:
            return Judged(False, _unknown(found.trajectory, verdict), agreed)
        if self.name in found.changed:
            told = difference(expected[self.name], found.outcomes.get(self.name))
            return Judged(False, f"{self.name}: {told}", agreed)
        how = "the histories agree" if verdict == "agree" else "though the history differs"
        if found.lawless and found.laws is not None:
            return Judged(False, f"{LAWLESS}: {found.laws.finding}", agreed)
        return Judged(True, f"{self.name} is the same, {how}", agreed)


@dataclass(frozen=True)
class Digits:
    """So many decimal digits of every place at the end, as a share of the largest coordinate there.

    Raises:
        SceneError: for less than one digit.

    >>> str(Digits(3))
    '3 digits right at the end'
    """

    count: int
    events: int | None = None

    def __post_init__(self) -> None:
        if self.count < 1:
            raise SceneError(f"--digits {self.count}: must be a whole number from 1")

    def __str__(self) -> str:
        return f"{self.count} digit{'s' * (self.count != 1)} right at the end"

    def check(self, reference: Trajectory) -> None:
        """Every scene has an end."""

    def judge(self, study: Study, label: str, engine: Engine) -> Judged:
        """Right if no circle is farther off than 10**-count of the largest coordinate."""
        end = float(study.reference.final_time)
        try:
            run = study.run(engine, study.scene, study.past(end))
        except EngineError:
            raise
        except SceneError as error:
            return Judged(False, str(error))
        found = end_error(study.reference, run)
        if found is None:
            return Judged(False, _unknown(run, "undecided"))
        digits = math.floor(10 * min(found.digits, 1e6)) / 10
        told = f"{max(digits, 0.0):g} digits: {found.circle} is {10**found.error:.2g} off at t = {found.time:.6g}"
        return _lawful(Judged(found.digits >= self.count, told), run, engine)


LAWLESS = "does not keep the law"
"""What is said of a run that is right otherwise."""


def _lawful(judged: Judged, run: Trajectory, engine: Engine) -> Judged:
    """What is right stays so unless the run's steps are known not to keep the laws; what is wrong needs no audit."""
    if not judged.right:
        return judged
    found = audit_run(run, engine)
    return Judged(False, f"{LAWLESS}: {found.finding}", judged.agreed) if found.kept is False else judged


def parted(divergence: Divergence, run: Trajectory) -> str:
    """A first divergence in a few words; of what a run lacks, up to when it was looked for."""
    d, end = divergence, float(run.final_time)
    match d.kind:
        case Kind.MISSING:
            what = f"{d.body} does not meet {d.expected}" + (f" by t = {end:.6g}" if math.isfinite(end) else "")
        case Kind.EXTRA:
            what = f"{d.body} meets {d.got}, which it should not"
        case _:
            what = f"{d.body} meets {d.got}, not {d.expected}"
    return f"event {d.event} (t = {d.time:.6g}): {what}"


def _unknown(run: Trajectory, verdict: str) -> str:
    """What is said of a run that does not settle the matter."""
    if verdict == "unsettled":
        return "not settled: the runs do not go far enough to decide"
    return f"stops at t = {float(run.final_time):.6g}: {run.stop.message}"


SHOWN = 1
"""Entries of an outcome that are shown where they differ."""


def difference(expected: Any, got: Any) -> str:
    """Two values of an outcome where they differ.

    >>> difference(3, 4), difference({"a-b": 1, "b-c": 2}, {"a-b": 1}), difference(["a"], ["a", "b"])
    ('4, not 3', 'b-c: none, not 2', "['a', 'b'], not ['a']")
    """
    mine, theirs = plain(expected), plain(got)
    if isinstance(mine, Mapping) and isinstance(theirs, Mapping):
        keys = [key for key in {**mine, **theirs} if mine.get(key) != theirs.get(key)]
        told = [f"{key}: {_brief(theirs.get(key))}, not {_brief(mine.get(key))}" for key in keys[:SHOWN]]
        more = f"; {len(keys) - SHOWN} more" if len(keys) > SHOWN else ""
        return "; ".join(told) + more
    return f"{_brief(theirs)}, not {_brief(mine)}"


def _brief(value: Any) -> str:
    if value is None:
        return "none"
    if isinstance(value, Mapping):
        return "(" + ", ".join(f"{key} {_brief(item)}" for key, item in value.items()) + ")"
    text = f"{value:.6g}" if isinstance(value, float) else str(value)
    return text if len(text) <= 60 else f"{text[:59]}…"
