"""Run time against error: scenes in every engine, each at several settings, answers checked."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from ...exact.exact_engine import ExactEngine
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.trajectory import StopReason
from ..chaos.accuracy import end_error
from ..comparison import candidate_of
from ..deadline import uninterrupted
from ..engines import engine as engine_named
from ..grids.setting_ladder import RunSize, cost
from ..outcomes.outcome import outcomes_of
from ..scene_argument import scene_from
from ..study import Study
from .computer import UNEVEN, Took
from .measured import Process, measure
from .subjects import Subject, digest_of, settings_of

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.scene import Scene

ALL_DIGITS = 1_000.0
"""Beyond so many digits a row says "all": the rest depends on how far one looks."""

MOST_WORK = 8_000_000
"""Counted work of the longest run that the table gives to one row: some ten seconds of pymunk."""

LEAST_PROCESSES, MOST_PROCESSES = 2, 4

STEADY = 1.05
"""Processes are started until the two fastest differ by no more than this."""

REST = Fraction(17, 16)
"""A scene that comes to rest is run to so many times the time of its last event."""


@dataclass(frozen=True)
class Tradeoff:
    """One engine at one setting on one scene.

    Attributes:
        scene, digest: the subject's name, and the scene's digest.
        engine: the engine and its setting, as the command line writes them.
        refused: why it was not run; the rest is then empty.
        verdict, agreed, events: as in a comparison with the certified run.
        error: the largest distance of a circle from its exact place at sampled times, in units of the scene.
        digits: decimal digits that are right at the end (infinite for all); None if it did not get there.
        changed: names of the outcomes that are wrong; None where it stopped before the end.
        seconds: processor time of the fastest run.
        loops: that in the time of the machine's loop.
        ratio: that over the exact engine's.
        spread: how far the two fastest processes are apart, as a ratio; None of a single one.
        memory: bytes of the peak while it ran, above what its process held before; None where it is not told.
        front: whether no other row of the scene is as fast and has as many digits.
    """

    scene: str
    digest: str | None
    engine: str
    refused: str | None = None
    verdict: str | None = None
    agreed: int = 0
    events: int = 0
    error: float = 0.0
    digits: float | None = None
    changed: tuple[str, ...] | None = None
    seconds: float = 0.0
    loops: float = 0.0
    ratio: float = 0.0
    spread: float | None = None
    memory: int | None = None
    front: bool = False
    took: tuple[Took, ...] = field(default=(), repr=False)
    loop: tuple[Took, ...] = field(default=(), repr=False)

    @property
    def name(self) -> str:
        """Scene and engine."""
        return f"{self.scene}, {self.engine}"

    @property
    def steady(self) -> bool:
        """Whether two processes took the same time."""
        return self.refused is not None or (self.spread is not None and self.spread <= UNEVEN)

    def data(self) -> dict[str, Any]:
        """The row as JSON has it."""
        keys = ("scene", "digest", "engine", "refused", "verdict", "agreed", "events", "seconds", "loops", "ratio",
                "spread", "memory", "front")  # fmt: skip
        error = self.error if math.isfinite(self.error) else None
        changed = None if self.changed is None else list(self.changed)
        return {**{key: getattr(self, key) for key in keys}, "error": error, "digits": told_digits(self.digits),
                "changed": changed}  # fmt: skip


def told_digits(digits: float | None) -> float | str | None:
    """Digits as JSON has them: to a tenth, rounded down; `all` beyond what anyone asks for.

    >>> told_digits(7.39), told_digits(math.inf), told_digits(None), told_digits(-3.0)
    (7.3, 'all', None, 0.0)
    """
    if digits is None:
        return None
    return "all" if digits >= ALL_DIGITS else max(math.floor(10 * digits) / 10, 0.0)


OnRow = Callable[[str, int, int], None]
"""Called before each row with its name, the rows done, and all there are."""


def tradeoffs(
    chosen: Iterable[Subject],
    engines: Sequence[str] = (),
    *,
    processes: tuple[int, int] = (LEAST_PROCESSES, MOST_PROCESSES),
    progress: OnRow | None = None,
) -> list[Tradeoff]:
    """For each scene the exact engine's row, then one for each setting, all to one time between two exact events.

    Args:
        engines: settings instead of the table's own.
        processes: the fewest and the most for each row; between them, until the two fastest agree.
        progress: see `OnRow`.
    """
    plan = [(subject, settings_of(subject, engines)) for subject in chosen]
    total, rows = sum(1 + len(settings) for _, settings in plan), list[Tradeoff]()
    for subject, settings in plan:
        mine: list[Tradeoff] = []
        try:
            study = study_of(subject)
        except SceneError as error:
            rows += [
                Tradeoff(subject.name, digest_of(subject), text, refused=str(error)) for text in ("exact", *settings)
            ]
            continue
        for text in ("exact", *settings):
            if progress is not None:
                progress(f"{subject.name}, {text}", len(rows) + len(mine), total)
            mine.append(_row(subject, study, text, processes))
        rows += with_front(in_exact(mine))
    return rows


def study_of(subject: Subject) -> Study:
    """The certified run of a subject, to a time at which rounding decides nothing.

    Raises:
        SceneError: if there is no such scene, or its certified run is not decided.
    """
    scene, truth = scene_from(subject.spec), ExactEngine()
    reference = uninterrupted(truth.run(scene, until=between_events(scene, subject.events)))
    if reference.stop.reason is not StopReason.HORIZON:
        raise SceneError(f"the certified run stops: {reference.stop.message}")
    return Study(scene, truth, reference)


def between_events(scene: Scene, events: int) -> Quantity:
    """A time half-way between an exact event and the next, so that rounding decides nothing there; a double.

    Of a scene that comes to rest before, a time a little past its last event.
    """
    found = uninterrupted(engine_named("exact").run(scene, events=events + 1)).events
    if len(found) <= events:
        last = found[-1].time if found else 1
        return Quantity.of(Fraction(float(Fraction(float(last)) * REST)))
    before, after = found[-2:]
    return Quantity.of(Fraction((float(before.time) + float(after.time)) / 2))


def _row(subject: Subject, study: Study, text: str, processes: tuple[int, int]) -> Tradeoff:
    blank = Tradeoff(subject.name, study.scene.digest, text, events=len(study.reference.events))
    try:
        engine = engine_named(text)
        _check_affordable(subject, study, engine)
        row = _checked(blank, study, engine)
    except SceneError as error:
        return replace(blank, refused=str(error))
    if row.refused is not None:
        return row
    try:
        found = _processes(subject, study, text, processes)
    except RuntimeError as error:
        return replace(blank, refused=f"its process ended: {error}")
    ratios = sorted(process.ratio for process in found)
    best = min(found, key=lambda process: process.ratio)
    known = [process.memory for process in found if process.memory is not None]
    return replace(
        row,
        seconds=min(t.cpu for t in best.runs),
        loops=ratios[0],
        spread=ratios[1] / ratios[0] if len(ratios) > 1 else None,
        memory=max(known, default=None),
        took=tuple(t for process in found for t in process.runs),
        loop=tuple(t for process in found for t in process.loops),
    )


def _check_affordable(subject: Subject, study: Study, engine: Engine) -> None:
    """Leaves out what would take minutes.

    Raises:
        SceneError: with the reason.
    """
    if engine == study.truth:
        return
    if engine.bits is None and engine.step is None and not subject.symbolic:
        raise SceneError("not run here: it counts in expressions, and would take minutes")
    steps, work = cost(engine, RunSize.of(study.reference))
    if work > MOST_WORK:
        told = f"{work:,} units of work" + ("" if steps is None else f", {steps:,} steps")
        raise SceneError(f"not run: {told}, where this table gives {MOST_WORK:,} units to a row")


def _checked(blank: Tradeoff, study: Study, engine: Engine) -> Tradeoff:
    """The row with what the run came to, held against the certified run."""
    if engine == study.truth:
        return replace(blank, verdict="agree", agreed=blank.events, digits=math.inf, changed=())
    expected = outcomes_of(study.reference)
    found = candidate_of(study, blank.engine, engine, expected, None, None)
    if found.unable:
        return replace(blank, refused=found.trajectory.stop.message)
    error = end_error(study.reference, found.trajectory)
    return replace(
        blank,
        verdict=found.verdict,
        agreed=found.alignment.agreed,
        error=found.separation.maximum,
        digits=None if error is None else error.digits,
        changed=found.changed if found.whole else None,
    )


def _processes(subject: Subject, study: Study, text: str, processes: tuple[int, int]) -> list[Process]:
    until = str(study.reference.final_time)
    found = [measure(subject.spec, text, until) for _ in range(processes[0])]
    while len(found) < processes[1]:
        fastest, second, *_ = sorted(process.ratio for process in found) if len(found) > 1 else (1.0, math.inf)
        if second <= STEADY * fastest:
            break
        found.append(measure(subject.spec, text, until))
    return found


def in_exact(rows: Sequence[Tradeoff]) -> list[Tradeoff]:
    """The rows of one scene with their ratios to the exact engine's."""
    exact = next((row.loops for row in rows if row.engine == "exact" and row.refused is None), 0.0)
    return [replace(row, ratio=row.loops / exact if exact else 0.0) for row in rows]


def with_front(rows: Sequence[Tradeoff]) -> list[Tradeoff]:
    """The rows of one scene, those marked than which none is at once as fast and as right (Pareto's front).

    Digits count as they are told, to a tenth.

    >>> rows = [Tradeoff("s", "", name, loops=t, digits=d) for name, t, d in
    ...         (("a", 1.0, 5.0), ("b", 2.0, 4.0), ("c", 3.0, 9.0), ("d", 0.5, None))]
    >>> [row.engine for row in with_front(rows) if row.front]
    ['a', 'c']
    """

    def digits(row: Tradeoff) -> float:
        told = told_digits(row.digits)
        return told if isinstance(told, float) else math.inf

    def beats(other: Tradeoff, row: Tradeoff) -> bool:
        better = other.loops < row.loops or digits(other) > digits(row)
        return other.loops <= row.loops and digits(other) >= digits(row) and better

    there = [row for row in rows if row.refused is None and row.digits is not None]
    return [replace(row, front=row in there and not any(beats(other, row) for other in there)) for row in rows]
