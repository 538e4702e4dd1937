"""Runs one scene through several engines and holds their histories against a reference."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from ..scenarios.errors import SceneError
from ..scenarios.trajectory import Progress, StopReason, Trajectory
from .alignment.separation import return_miss
from .candidate import Candidate, Verdict
from .deadline import time_limit, uninterrupted
from .engines import engine as engine_named
from .outcomes.permitted import PermittedPatterns, permitted_patterns
from .outcomes.table import outcomes_of
from .study import Study

if TYPE_CHECKING:
    from ..scenarios.engine import Engine
    from ..scenarios.quantity import QuantityLike
    from ..scenarios.scene import Scene
    from ..scenarios.trajectory import OnProgress
    from .outcomes.table import Outcome

DEFAULT_ENGINES = ("double", "interval", "pymunk")

UNDONE = (StopReason.UNDECIDED, StopReason.BUDGET, StopReason.INTERRUPTED)


@dataclass(frozen=True)
class Comparison:
    """What came out of holding several engines against a reference.

    Attributes:
        scene: what was run.
        reference: the run taken as the truth.
        candidates: the engines compared, in the order asked for.
        outcomes: the reference's outcomes.
        span: the time up to which histories were compared.
        return_miss: after a reversal, the reference's own distance from the start at the return.
        permitted: break patterns under several tie policies, for a scene that has one and in which an engine
            comes to another.
        seconds: wall time of the reference's run.
    """

    scene: Scene
    reference: Trajectory = field(repr=False)
    candidates: tuple[Candidate, ...]
    outcomes: Mapping[str, Any] = field(repr=False)
    span: float
    return_miss: float | None = None
    permitted: PermittedPatterns | None = None
    seconds: float = 0.0

    @property
    def verdict(self) -> Verdict:
        """`diverged` if any engine did; else `undecided` if anything, the reference included, is; else
        `agree`."""
        verdicts = {candidate.verdict for candidate in self.candidates}
        if "diverged" in verdicts:
            return "diverged"
        if "undecided" in verdicts or self.reference.stop.reason in UNDONE:
            return "undecided"
        return "agree"

    def __getitem__(self, engine: str) -> Candidate:
        """The candidate of an engine, by the text with which it was asked for."""
        for candidate in self.candidates:
            if candidate.engine == engine:
                return candidate
        raise KeyError(engine)


def compare(
    scene: Scene,
    engines: Sequence[str | Engine] = DEFAULT_ENGINES,
    *,
    until: QuantityLike | None = None,
    events: int | None = None,
    reference: str | Engine = "exact",
    outcomes: Mapping[str, Outcome] | None = None,
    causes: bool = True,
    max_seconds: float | None = None,
    progress: OnProgress | None = None,
) -> Comparison:
    """Runs `scene` in a reference engine and in others, and says where their histories part.

    The span compared ends where the reference ends. Candidates run a little past it; what they have there is
    looked at only to tell a late event from a missing one. Where that is not enough, the reference is run
    on too.

    Args:
        engines: names, with parameters as in `pymunk:dt=1/1000`, or engines.
        until, events: limits of the reference's run, as in `Engine.run`.
        reference: the engine taken as the truth.
        outcomes: further outcomes by name.
        causes: whether to find out, by further runs, why an engine diverged.
        max_seconds: ends the reference's run after so many seconds, and each candidate's; what they have by then is
            compared. No experiment on causes gets more either.
        progress: called now and then with how far a run is.

    Raises:
        SceneError: for an unknown engine or parameter, a limit that is not positive, or a scene that the
            reference cannot run.
        OutOfTime: if `max_seconds` are over and there is nothing yet to compare.
        KeyboardInterrupt: if the user interrupts it.

    >>> from truebreak.scenarios import Circle, Scene
    >>> compare(Scene([Circle(0, 0, vx=1), Circle(4, 0)]), ["double"], until=5).verdict
    'agree'
    """
    if not engines:
        raise SceneError("no engine to compare; name at least one, such as double")
    if isinstance(engines, str):
        engines = [engines]
    chosen = [(_label(e), engine_named(e) if isinstance(e, str) else e) for e in engines]
    truth = engine_named(reference) if isinstance(reference, str) else reference
    began = clock.perf_counter()
    with time_limit(max_seconds) as watch:
        noted = watch.watched(_noted(progress, truth.name))
        told = uninterrupted(truth.run(scene, until=until, events=events, progress=noted))
    seconds = clock.perf_counter() - began
    study = Study(scene, truth, told, until, events, seconds, max_seconds)
    found = outcomes_of(told, outcomes)
    results = []
    for label, engine in chosen:
        result = study.candidate(label, engine, found, outcomes, _noted(progress, label))
        results.append(study.explained(result, engine, _noted(progress, f"why {label}")) if causes else result)
    other = any("break_pattern" in c.changed and c.verdict != "undecided" for c in results)
    search = causes and other and told.stop.reason not in UNDONE
    histories = [c.trajectory for c in results if c.alignment.divergence is not None]
    orders = _noted(progress, "orders")
    permitted = permitted_patterns(truth, told, seconds, histories, orders, max_seconds) if search else None
    miss = return_miss(told, told)
    return Comparison(scene, told, tuple(results), found, study.span, miss, permitted, seconds)


def _label(engine: str | Engine) -> str:
    return engine.strip() if isinstance(engine, str) else engine.name


def _noted(progress: OnProgress | None, name: str) -> OnProgress | None:
    """A progress callback that says which engine is at work."""
    if progress is None:
        return None

    def noted(state: Progress) -> None:
        progress(replace(state, note=f"{name}, {state.note}" if state.note else name))

    return noted
