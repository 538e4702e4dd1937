"""Checks one engine, or log, against one scene; a failure says the divergence first, and how to see it again."""

from __future__ import annotations

import dataclasses
import shlex
import sys
import sysconfig
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite, log10
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...exact.exact_engine import DEFAULT_WORK, ExactEngine
from ...scenarios.engine import DEFAULT_EVENTS
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.trajectory import StopReason
from ..alignment.align import UNKNOWING
from ..alignment.walk import REPEATED
from ..audit.audit import Audit, audit_run
from ..comparison import Comparison, compare
from ..deadline import OutOfTime, time_limit
from ..engines import ENGINES
from ..engines import engine as engine_named
from ..files.cache import CachedEngine, cached, kept_value
from ..foreign.guard import run_guarded
from ..foreign.log_engine import LogEngine
from ..outcomes.permitted import TIE_ENDS, PatternRelation, permitted_patterns
from ..report.sentences import divergence_phrase, listed, margin_phrase, middle, short, until_phrase, verdict_sentence
from ..report.sentences import off as off_by
from ..scene_argument import scene_from
from ..study import Study
from ..tolerances.errors_grown import LocalError, local_error
from ..tolerances.reach import MOST_CIRCLES, Demand, ErrorWalk, OutOfReach, Reach, number_off, tie_off
from ..validation import check_engine, check_trajectory, unsupported
from .own_order import permission

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.numbers.quantity import QuantityLike
    from ...scenarios.trajectory import Trajectory
    from ..candidate import Candidate

LOGS = (".jsonl", ".csv", ".log", ".ndjson")
"""Suffixes by which a text is known for the path of a log."""

WIDTHS = {"float16": 11, "float32": 24, "single": 24, "float64": 53, "double": 53, "quad": 106, "float128": 113}
"""Horizons by name: bits of the numbers whose errors are granted."""


def engine_asked(engine: Any, scene: Scene, declared: dict[str, Any]) -> tuple[Engine, str]:
    """The engine to check, and what messages call it."""
    if isinstance(engine, Path) or (isinstance(engine, str) and engine.lower().endswith(LOGS)):
        log = LogEngine.of(engine, scene, **declared)
        return log, log.name
    if isinstance(engine, Iterable) and not isinstance(engine, str):
        return LogEngine.of(engine, scene, **declared), "log"
    if declared:
        raise SceneError(f"{next(iter(declared))}: is declared of a log only; an engine declares it itself")
    chosen = engine_named(engine) if isinstance(engine, str) else check_engine(engine)
    return chosen, engine if isinstance(engine, str) else chosen.name


def bits_asked(engine: Engine, horizon: str | int | None) -> int | None:
    """The width whose errors are granted."""
    if horizon is None:
        return engine.bits
    if isinstance(horizon, str) and horizon in WIDTHS:
        return WIDTHS[horizon]
    bits = int(horizon) if isinstance(horizon, str) and horizon.isascii() and horizon.isdigit() else horizon
    if isinstance(bits, bool) or not isinstance(bits, int) or bits < 1:
        raise SceneError(f"horizon = {horizon!r}: must be a number of bits, or one of {', '.join(WIDTHS)}")
    return bits


# ----------------------------------------
# What a failed check says: the divergence first, then why, then how to see it again.

DIGITS = 15
"""Certified digits of a time that a message shows."""


def failure(
    comparison: Comparison,
    reproduce: str,
    reach: Reach | None,
    off: str | None = None,
    bits: int | None = None,
    violations: Sequence[str] = (),
) -> str:
    """The message of a check that failed.

    Args:
        reproduce: the command that shows the same.
        reach: how far the history was required; None where the span was given.
        off: which number is off, where the history is the same.
        bits: of the engine's numbers; None where they are not known.
        violations: what else is wrong, such as a number before the divergence, or a law.
    """
    (candidate,) = comparison.candidates
    lines = [off if off is not None else divergence_phrase(comparison, candidate)]
    divergence = candidate.alignment.divergence
    if divergence is not None and off is None:
        events = comparison.reference.events
        if divergence.expected is not None and divergence.expected_time is not None:
            own = divergence.expected_event
            told = events[own].time.digits(DIGITS) if own < len(events) else "later"
            lines.append(f"  expected: {divergence.body} meets {divergence.expected} at t = {told}")
        if divergence.got is not None:
            lines.append(f"  got:      {divergence.body} meets {divergence.got} at t = {divergence.got_time!r}")
    lines += [f"  violation: {told}" for told in violations]
    if candidate.margin is not None:
        exact = candidate.margin.gap or candidate.margin.distance
        margin = [] if exact is None else [f"margin {short(abs(middle(exact)))}"]
        by = candidate.margin.error
        beside = [] if by is None else [f"{'beside ' if margin else ''}an error of {off_by(by)}"]
        told = filter(None, (" ".join([*margin, *beside]), margin_phrase(candidate)))
        lines.append(f"  decision: {'; '.join(told)}")
    error = None if candidate.margin is None else candidate.margin.error
    if error is not None and bits is not None:
        expected = int(bits * log10(2))
        left = digits_left(error, _size(comparison), expected)
        lines.append(f"  digits:   {expected} expected of {bits} bits, {left} left of places by then")
    if candidate.diagnosis is not None:
        lines.append(f"  cause:    {candidate.diagnosis}: {candidate.diagnosis.finding}")
        also = [cause.value for cause in candidate.diagnosis.sufficient if cause is not candidate.diagnosis.name]
        lines += [f"            suffices by itself too: {listed(also)}"] if also else []
    total = len(comparison.reference.events)
    required = (
        f"{total} events" if reach is None or reach.limit is None else f"{reach.events} events, up to {reach.limit}"
    )
    lines.append(f"  required: {required}; {candidate.alignment.agreed} agree")
    until = until_phrase(candidate)
    lines += [] if until is None else [f"  known:    {until}; what lies beyond is not settled"]
    lines.append(f"  reproduce: {reproduce}")
    return "\n".join(lines)


def digits_left(error: float, size: float, expected: int) -> int:
    """How many of the expected digits an error leaves of numbers of a size.

    >>> digits_left(1e-12, 10.0, 15), digits_left(0.0, 10.0, 15), digits_left(30.0, 10.0, 15)
    (13, 15, 0)
    """
    if error == 0.0:
        return expected
    return int(min(expected, max(0.0, log10(size / error)))) if isfinite(error) and size > 0.0 else 0


def _size(comparison: Comparison) -> float:
    """The largest coordinate at the divergence."""
    (candidate,) = comparison.candidates
    divergence, reference = candidate.alignment.divergence, comparison.reference
    known = divergence is not None and divergence.expected_event < len(reference.events)
    event = reference.events[divergence.expected_event] if divergence is not None and known else None
    state = reference.final if event is None else reference.at(event.time)
    return max(abs(float(place)) for circle in state.circles for place in (circle.x, circle.y))


# ----------------------------------------
# The command that shows a failed check again, or the Python, where no command has the same scene and engine.


def reproduction(comparison: Comparison, engine: Engine, text: str | None, where: str) -> str:
    """What shows a comparison of one engine again.

    Args:
        text: how the engine was asked for; None: as an object.
        where: what the scene is called; a command is told only where that is enough to have it again.
    """
    reference = comparison.reference
    limits: dict[str, Any] = {
        StopReason.EVENTS: {"events": len(reference.events)},
        StopReason.HORIZON: {"until": float(reference.final_time)},
    }.get(reference.stop.reason, {})
    return reproduction_of(comparison.scene, engine, text, where, limits)


def reproduction_of(scene: Scene, engine: Engine, text: str | None, where: str, limits: Mapping[str, Any]) -> str:
    """The command that runs an engine on a scene to some limits, or the Python.

    Args:
        text, where: as in `reproduction`.
        limits: `until` or `events`.
    """
    words = [word for key, value in limits.items() for word in (f"--{key}", repr(value))]
    named = _is_scene(where, scene)
    if named and isinstance(engine, LogEngine) and "log" in engine.recording.parameters:
        return " ".join(["truebreak judge", shlex.quote(where), shlex.quote(engine.name), *_declared(engine), *words])
    text = engine_text(engine) if text is None else text
    if named and text is not None:
        return " ".join(["truebreak compare", shlex.quote(where), "--engines", shlex.quote(text), *words])
    told = [f"truebreak.scene({where!r})" if named else "scene", f"[{'engine' if text is None else repr(text)}]"]
    return f"truebreak.comparison({', '.join([*told, *(f'{key}={value!r}' for key, value in limits.items())])})"


def check_again(engine: Engine, text: str | None, where: str, scene: Scene, demands: Mapping[str, Any]) -> str:
    """The check itself, in Python: what shows again that a number is off in a history that is right."""
    named = "log" if isinstance(engine, LogEngine) else "engine"
    text = engine_text(engine) if text is None and not isinstance(engine, LogEngine) else text
    if isinstance(engine, LogEngine) and "log" in engine.recording.parameters:
        text = engine.name
    told = [named if text is None else repr(text), repr(where) if _is_scene(where, scene) else "scene"]
    told += [f"{key}={value!r}" for key, value in demands.items() if value not in (None, False)]
    return f"truebreak.check({', '.join(told)})"


def _declared(engine: LogEngine) -> list[str]:
    """What was declared of a log, as options of `judge`."""
    words = [] if engine.bits in (None, 53) else ["--bits", str(engine.bits)]
    words += [] if engine.step is None else ["--step", repr(engine.step)]
    return words if engine.rounds_input else [*words, "--exact-input"]


def _is_scene(where: str, scene: Scene) -> bool:
    """Whether a scene is what the command line makes of a text."""
    try:
        return scene_from(where).digest == scene.digest
    except SceneError:
        return False


def engine_text(engine: Engine) -> str | None:
    """How the command line names an engine, in the folder where the user is; None where it cannot.

    >>> from truebreak.floating import PymunkEngine
    >>> engine_text(PymunkEngine()), engine_text(PymunkEngine(dt=1 / 64))
    ('pymunk', 'pymunk:dt=0.015625')
    """
    kind = type(engine)
    entry = ENGINES.get(engine.name)
    home = engine.name if entry is not None and entry.load() is kind else _class_text(kind)
    if home is None:
        return None
    for text in (home, f"{home}:{_settings(engine)}"):
        try:
            same = engine_named(text)
        except SceneError:
            continue
        if type(same) is kind and (same == engine or getattr(same, "__dict__", 0) == getattr(engine, "__dict__", 1)):
            return text
    return None


def _class_text(kind: type) -> str | None:
    """The class of a module that lies in the user's folder, or is installed."""
    top = sys.modules.get(kind.__module__.partition(".")[0])
    file = getattr(top, "__file__", None)
    if file is None or not kind.__qualname__.isidentifier() or kind.__module__ == "__main__":
        return None
    place = Path(file).parent.parent if Path(file).name == "__init__.py" else Path(file).parent
    known = {Path.cwd(), *map(Path, (sysconfig.get_path("purelib"), sysconfig.get_path("platlib")))}
    return f"{kind.__module__}:{kind.__qualname__}" if place in known else None


def _settings(engine: Engine) -> str:
    """The fields that are numbers and not at their default."""
    if not dataclasses.is_dataclass(engine):
        return ""
    values = {field.name: (getattr(engine, field.name), field.default) for field in dataclasses.fields(engine)}
    return ",".join(
        f"{key}={value!r}" for key, (value, usual) in values.items() if value != usual and type(value) in (int, float)
    )


# ----------------------------------------
# Checks one engine, or log, against one scene; a failure tells the divergence first.

FIRST, THEN = 64, 256
"""Events of the true run that are looked at first: most engines come no farther."""

PAST = 9 / 8
"""Steps are audited up to this many times the true run's end: what is missing at the end shows after it."""


class CheckFailed(AssertionError):
    """An engine does not do what was required of it.

    Attributes:
        comparison: with the reference, if it came to one.
    """

    def __init__(self, message: str, comparison: Comparison | None = None) -> None:
        super().__init__(message)
        self.comparison = comparison


class NotDecided(CheckFailed):
    """What was required could not be decided: a check that cannot check is not passed."""


@dataclass(frozen=True)
class Checked:
    """What a check asserted, and found to hold.

    Attributes:
        engine, scene: what was checked.
        asserted: each thing that was required, in words.
        reach: how far the history was required; None where the span was given.
        comparison: with the reference; None where nothing of the history was required.
    """

    engine: str
    scene: str
    asserted: tuple[str, ...]
    reach: Reach | None = field(default=None, repr=False)
    comparison: Comparison | None = field(default=None, repr=False)

    def __str__(self) -> str:
        return f"{self.engine} on {self.scene}: {'; '.join(self.asserted)}"


def check(
    engine: Engine | str | Path | Iterable[tuple[float, str, str]],
    scene: Scene | str,
    *,
    events: int | None = None,
    until: QuantityLike | None = None,
    digits: int | None = None,
    atol: float | None = None,
    rtol: float | None = None,
    permitted: bool = False,
    horizon: str | int | None = None,
    require_history: bool = False,
    work: int | None = None,
    max_seconds: float | None = None,
    **declared: Any,
) -> Checked:
    """Requires that an engine tells a scene's true history; see docs/pytest.md.

    Without a span the history is required while the exact margin of every decision exceeds what errors allowed by the
    rounding model may have grown to (`reach_of`), and so are times and places, within those errors. Beyond that, every
    step must keep the laws on the engine's own numbers (`audit_run`).

    Args:
        engine: an engine, its name or class path, the path of a log, or a list of (time, a, b).
        scene: a scene, or its name or file, as on the command line.
        events, until: require all of this span instead, whatever its margins.
        digits: so many certified digits of every event's time.
        atol, rtol: times and places (where the engine tells them) within atol + rtol times the true value.
        permitted: any order of simultaneous impulses will do.
        horizon: bits, or a width by name, whose errors are granted, instead of those that the engine declares.
        require_history: whether a check that can require no event of the history is not decided.
        work: see `ExactEngine`.
        max_seconds: what is not decided by then, as an engine hangs, is not decided.
        declared: of a log: `bits`, `step`, `rounds_input`, `lacks` (see `LogEngine.of`).

    Raises:
        CheckFailed: if it does not hold.
        NotDecided: if it could not be decided.
        SceneError: for what cannot be checked.
    """
    if not isinstance(scene, Scene | str):
        raise SceneError(f"scene = {str(scene)[:60]}: must be a Scene, or what the command line takes for one")
    where = scene if isinstance(scene, str) else scene.name
    loaded = scene_from(scene) if isinstance(scene, str) else scene
    chosen, name = engine_asked(engine, loaded, declared)
    key = unsupported(chosen, loaded)
    if key is not None:
        raise NotDecided(f"{name} on {where}: cannot run this scene: it does not follow {key!r}, by its scene_keys")
    truth = cached(ExactEngine(work=DEFAULT_WORK if work is None else work))
    demand = Demand(digits, atol, rtol)
    case = _Case(
        chosen,
        name,
        loaded,
        where,
        truth,
        demand,
        permitted,
        isinstance(engine, str) and not isinstance(chosen, LogEngine),
        {
            "events": events,
            "until": until,
            "digits": digits,
            "atol": atol,
            "rtol": rtol,
            "permitted": permitted,
            "horizon": horizon,
            **declared,
        },
        require_history,
    )
    bits, spanned = bits_asked(chosen, horizon), events is not None or until is not None or permitted
    if not spanned and len(loaded.circles) > MOST_CIRCLES:
        raise SceneError(f"{where!r}: has more than {MOST_CIRCLES} circles; give events= or until=")
    try:
        with time_limit(max_seconds) as watch:
            checked = case.span(events, until, bits) if spanned else case.as_far_as_it_reaches(bits)
            if not watch.over:
                return checked
        raise OutOfTime(str(watch.is_up()))
    except OutOfTime as outcome:
        raise NotDecided(f"{name} on {where}: not decided within {outcome}") from None


def _why_nothing(reach: Reach) -> str:
    """Why no event of a history can be required, in words."""
    if reach.limit is None:
        return "the scene has no event"
    return f"an exact tie at event {reach.limit.event}" if reach.limit.tie else str(reach.limit)


def _tells_places(candidate: Candidate) -> bool:
    """Whether an engine tells where circles are: places that are reckoned from its times are not its own."""
    return not getattr(candidate.trajectory.motion, "reckoned", ())


def _span(run: Trajectory) -> tuple[int, float]:
    """How many events a run has, and when it ends."""
    return len(run.events), float(run.final_time)


def _plain(found: tuple[LocalError, Reach, tuple[int, float]]) -> list[Any]:
    """What was found of a reach, in JSON values."""
    local, reach, span = found
    return [dataclasses.asdict(local), dataclasses.asdict(reach), list(span)]


@dataclass
class _Case:
    """One check under way."""

    engine: Engine
    name: str
    scene: Scene
    where: str
    truth: Engine
    demand: Demand
    permitted: bool
    asked: bool
    demands: dict[str, Any]
    strict: bool

    def span(self, events: int | None, until: QuantityLike | None, bits: int | None) -> Checked:
        """All of a span, or the scene's own, is required."""
        given = events is not None or until is not None
        until = until if given else self._log_end
        comparison = self._compared(events=events, until=until)
        asserted = [f"the same history in {len(comparison.reference.events)} events"]
        if self.permitted and (given or len(self.scene.circles) > MOST_CIRCLES):
            asserted = [*self._permitted(comparison, None), *self._audited(_span(comparison.reference), comparison)]
        elif self.permitted:
            reference, local, reach = self._reach(bits)
            self._up_to_a_tie(comparison, reach, local)
            asserted = [*self._permitted(comparison, local), *self._audited(_span(reference), comparison)]
        else:
            self._same_history(comparison, None)
            self._same_numbers(comparison, comparison.reference, comparison.candidates[0], None)
            asserted += self._audited(_span(comparison.reference), comparison)
        return self._done([*asserted, *self._demanded(comparison)], None, comparison)

    def as_far_as_it_reaches(self, bits: int | None) -> Checked:
        """The history is required to its horizon, and every step is audited."""
        local, reach, span = self._kept_reach(bits)
        comparison, asserted = None, []
        if reach.events or reach.whole:
            limits: dict[str, Any] = {"events": reach.events}
            if reach.whole:
                limits = {"until": self._log_end} if self._log_end else {}
            comparison = self._compared(**limits)
            self._same_history(comparison, reach, local)
            asserted = [f"the same history in {reach.events} events"]
            asserted += self._same_numbers(comparison, comparison.reference, comparison.candidates[0], reach, local)
        else:
            asserted = [f"history: nothing required ({_why_nothing(reach)})"]
            if self.strict and reach.limit is not None:
                raise NotDecided(f"{self.name} on {self.where}: {asserted[0]}; choose a scene with a certified horizon")
        if reach.limit is not None:
            if comparison is not None:
                asserted.append(f"past the certified horizon: {reach.limit}")
            asserted += self._tie_resolved(reach.limit)
        asserted += [*self._audited(span, comparison), *self._demanded(comparison)]
        return self._done(asserted, reach, comparison)

    def _demanded(self, comparison: Comparison | None) -> list[str]:
        """What else was asked of the numbers that were compared."""
        return [] if comparison is None else self.demand.told(_tells_places(comparison.candidates[0]))

    @property
    def _log_end(self) -> float | None:
        """Where a log ends that does not say that nothing is left to happen."""
        if not isinstance(self.engine, LogEngine) or self.engine.over:
            return None
        return float(self.engine.last.final_time)

    def _kept_reach(self, bits: int | None) -> tuple[LocalError, Reach, tuple[int, float]]:
        """What one contact may cost, how far that reaches, and the events and the end of the true run by which that is
        known: kept between calls where all that decides it is known."""

        def found() -> tuple[LocalError, Reach, tuple[int, float]]:
            run, local, reach = self._reach(bits)
            return local, reach, _span(run)

        engine = self.engine
        whose: list[Any] = [engine.rounds_input]
        if engine.step is not None:
            from ...floating.pymunk_engine import PymunkEngine

            if type(engine) is not PymunkEngine:  # another's lateness may change with its library
                return found()
            from pymunk import version

            whose = [repr(engine), version]
        if not isinstance(self.truth, CachedEngine):
            return found()
        limits = [self.scene.events, str(self.scene.until), self._log_end]
        key = ["reach", self.scene.digest, str(self.scene.tie_policy), self.truth.work, limits, bits, *whose]
        local, reach, span = kept_value(key, lambda: _plain(found()))
        limit = None if reach["limit"] is None else OutOfReach(**reach["limit"])
        return LocalError(**local), Reach(**{**reach, "limit": limit}), (span[0], span[1])

    def _reach(self, bits: int | None) -> tuple[Trajectory, LocalError, Reach]:
        """The true run as far as it is needed, what one contact may cost, and how far that reaches."""
        most = self.scene.events or (DEFAULT_EVENTS if self.scene.until is None else None)
        until = min(filter(None, (self._log_end, self.scene.until and float(self.scene.until))), default=None)
        until = self.scene.until if until is None or until != self._log_end else until
        walk: ErrorWalk | None = None
        for size in (FIRST, THEN, None):
            count = most if size is None else min(size, most or size)
            run = self.truth.run(self.scene, until=until, events=count)
            if run.stop.reason in UNKNOWING:
                raise NotDecided(f"{self.where}: the true run itself stopped: {run.stop.message}")
            local = local_error(self.engine, run, bits)
            if walk is None or not walk.goes_on(run, local):
                walk = ErrorWalk(run, local)
            reach = walk.walked()
            if reach.limit is not None or run.stop.reason is not StopReason.EVENTS or count == most:
                return run, local, reach
        raise AssertionError("unreachable")

    def _compared(self, **limits: Any) -> Comparison:
        return compare(
            self.scene,
            [self.name if self.asked else self.engine],
            reference=self.truth,
            sampled=False,
            audited=False,
            alternatives=False,
            **limits,
        )

    def _same_history(self, comparison: Comparison, reach: Reach | None, local: LocalError | None = None) -> None:
        (candidate,) = comparison.candidates
        if candidate.verdict == "diverged":
            violations = [] if local is None else self._violated(comparison, reach)
            raise CheckFailed(self._failure(comparison, reach, violations=violations), comparison)
        if comparison.verdict != "agree":
            told = [verdict_sentence(comparison), f"  {candidate.engine}: {candidate.trajectory.stop.message}"]
            raise NotDecided("\n".join([*told, f"  reproduce: {self._reproduced(comparison)}"]), comparison)

    def _same_numbers(
        self,
        comparison: Comparison,
        reference: Trajectory,
        candidate: Candidate,
        reach: Reach | None,
        local: LocalError | None = None,
    ) -> list[str]:
        """Times and places are as near to those of a run with the same history as is asked for, and granted."""
        off = number_off(reference, candidate, self.demand, reach, _tells_places(candidate))
        if off is not None:
            raise CheckFailed(self._failure(comparison, reach, off), comparison)
        if reach is None or local is None or not reach.linear:
            return []
        places = "times and places" if _tells_places(candidate) else "times"
        return [f"{places} of {reach.linear} within the errors that the rounding model allows ({local.told})"]

    def _up_to_a_tie(self, comparison: Comparison, reach: Reach, local: LocalError) -> None:
        """Before the first tie, and to its time, no order of impulses makes a difference: all is as by the policy."""
        (candidate,) = comparison.candidates
        parted = candidate.alignment.divergence
        if parted is not None and parted.event < reach.events:
            raise CheckFailed(
                self._failure(comparison, reach, violations=self._violated(comparison, reach)), comparison
            )
        off = number_off(comparison.reference, candidate, Demand(), reach, _tells_places(candidate))
        off = off or (tie_off(comparison.reference, candidate, reach.limit) if reach.limit else None)
        if off is not None:
            raise CheckFailed(self._failure(comparison, reach, off), comparison)

    def _permitted(self, comparison: Comparison, local: LocalError | None) -> list[str]:
        """Some order of simultaneous impulses leads to the history, and to its times and places."""
        (candidate,) = comparison.candidates
        if candidate.verdict not in ("agree", "diverged"):
            self._same_history(comparison, None)
        found = permission(comparison, self.engine, local)
        if found.told is None:
            broken = local is not None and candidate.lawless
            text = self._failure(comparison, None, violations=self._violated(comparison, None) if broken else [])
            kind = CheckFailed if found.settled or broken else NotDecided
            raise kind(f"{text}\n  permitted: {found.relation.value}", comparison)
        own = found.own
        if own is None or own.told is None:
            if self.demand != Demand():
                raise NotDecided(f"{self.name} on {self.where}: {found.told}; no run is known to hold numbers against")
            return [found.told]
        mine = replace(candidate, trajectory=own.history, alignment=own.alignment)
        return [found.told, *self._same_numbers(comparison, own.run, mine, own.reach, local)]

    def _tie_resolved(self, limit: OutOfReach) -> list[str]:
        """Whom each circle meets in an exact tie out of reach is what some order of its impulses, or a nearby scene,
        leads to: told where a complete enumeration of the orders tells."""
        if not limit.tie:
            return []
        comparison = self._compared(events=limit.event + 1, causes=False)
        (candidate,) = comparison.candidates
        off = tie_off(comparison.reference, candidate, limit)
        if off is not None:
            raise CheckFailed(self._failure(comparison, None, off), comparison)
        if candidate.verdict == "agree":
            return [f"its tie: {PatternRelation.OWN.value}"]
        if candidate.verdict != "diverged" or candidate.pattern is None:
            return []
        relation = self._relation(comparison)
        if relation is PatternRelation.NO_ORDER:
            # What the engine takes one by one may end some ulps, or steps, after the tie: it is looked at up to there.
            tie = float(comparison.reference.final_time)
            after = Quantity.of(tie + TIE_ENDS * tie + REPEATED * (self.engine.step or 0.0))
            later = self._compared(until=after, causes=False)
            relation = PatternRelation.OWN if later.candidates[0].verdict == "agree" else self._relation(later)
        if relation is PatternRelation.NO_ORDER:
            raise CheckFailed(f"{self._failure(comparison, None)}\n  permitted: {relation.value}", comparison)
        return [] if relation is None else [f"its tie: {relation.value}"]

    def _relation(self, comparison: Comparison) -> PatternRelation | None:
        """What orders of the impulses, or nearby scenes, have to do with whom each circle meets; None: not known."""
        (candidate,) = comparison.candidates
        if candidate.pattern is None:
            return None
        study = Study(self.scene, self.truth, comparison.reference)
        found = permitted_patterns(study, [(candidate.trajectory, candidate.stepped)])
        return None if found is None else found.relation(candidate.pattern)

    def _audited(self, span: tuple[int, float], comparison: Comparison | None) -> list[str]:
        """Every step of the engine's run keeps the laws; of a log without states nothing of that is known."""
        until = PAST * span[1] or None
        if isinstance(self.engine, LogEngine):
            run = self.engine.last
        else:
            told = run_guarded(self.engine, self.scene, until=until, events=4 * span[0] + 64)
            run = check_trajectory(told, self.scene, self.name, self.engine.bits)
        found = audit_run(run, self.engine)
        if found.kept is False:
            lines = [f"{self.name} on {self.where}: {found.sentence}", *self._steps(found)]
            again = {"until": float(run.final_time)} if float(run.final_time) else {}
            lines.append(f"  reproduce: {reproduction_of(self.scene, self.engine, self._text, self.where, again)}")
            raise CheckFailed("\n".join(lines), comparison)
        if found.kept is None:
            return [f"laws: not determined ({found.reason})"]
        return [f"{found.steps} audited", *([] if found.bounces is None else [str(found.bounces)])]

    def _steps(self, found: Audit) -> list[str]:
        """The first step of each kind that misses a law."""
        return [f"  violation: {violation}" for violation in found.violations]

    def _violated(self, comparison: Comparison, reach: Reach | None) -> list[str]:
        """The first number that is off before the histories part, and the law that is not kept: what a bug is."""
        (mine,) = comparison.candidates
        found = [number_off(comparison.reference, mine, self.demand, reach, _tells_places(mine))]
        if mine.laws is not None and mine.laws.kept is False:
            found.append(mine.laws.sentence)
        return [told for told in found if told is not None]

    @property
    def _text(self) -> str | None:
        return self.name if self.asked else None

    def _failure(
        self, comparison: Comparison, reach: Reach | None, off: str | None = None, violations: Sequence[str] = ()
    ) -> str:
        again = self._reproduced(comparison)
        if off is not None:  # the history is right, so that a comparison would agree
            again = check_again(self.engine, self._text, self.where, self.scene, self.demands)
        return failure(comparison, again, reach, off, self.engine.bits, violations)

    def _reproduced(self, comparison: Comparison) -> str:
        return reproduction(comparison, self.engine, self._text, self.where)

    def _done(self, asserted: list[str], reach: Reach | None, comparison: Comparison | None) -> Checked:
        return Checked(self.name, self.where, tuple(asserted), reach, comparison)
