"""Searches for the smallest scene on which an engine still diverges from the certified history, or breaks a law."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...scenarios.errors import SceneError
from ...scenarios.trajectory import StopReason
from ..comparison import compare
from ..deadline import Clock, OutOfTime, checked_seconds
from .smallest import (
    DENOMINATORS,
    THINGS,
    End,
    Reduction,
    SceneParts,
    SceneSize,
    Smallest,
    corners,
    ddmin,
    digits,
    settings,
    things,
)

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.numbers.quantity import QuantityLike
    from ...scenarios.scene import Scene
    from ..audit.residual import Violation
    from ..candidate import Candidate
    from ..causes.diagnosis import CauseName
    from ..comparison import Comparison

DEFAULT_RUNS = 1_000
"""Comparisons that a search may make. For n parts ddmin asks n**2 + 3 n times at most: 1,000 is as much as 30 parts can
need. Six discs (gas:n=6, double) took 106, ten with a reversal (reversal, double) 126."""

FARTHER = 4
"""A scene with something left out may diverge later: it is compared to where the last one diverged, and, while it does
not, so many times as far, up to the span asked for."""


MINIMISED = " (minimised)"
"""What is added to a scene's name."""


@dataclass(frozen=True)
class Reducing:
    """How far a search is: comparisons made, the most that may be, the size of the best scene so far."""

    runs: int
    limit: int
    size: SceneSize


OnReducing = Callable[[Reducing], None]


def minimise(
    scene: Scene,
    engine: str | Engine,
    *,
    until: QuantityLike | None = None,
    events: int | None = None,
    same_cause: bool = False,
    same_law: bool = False,
    runs: int = DEFAULT_RUNS,
    max_seconds: float | None = None,
    progress: OnReducing | None = None,
) -> Smallest:
    """The smallest scene found on which an engine still diverges from the exact one, or still breaks a law.

    Circles are left out first, then walls, segments, polygons, arcs, pockets, corners of
    both, events at the end, a reversal, a limit in time, and the digits of
    numbers; then all over again, until nothing more can be left out by itself. Each try is a certified comparison: what
    is not proved to diverge is not taken.

    Args:
        engine: its name, with parameters as in `pymunk:dt=1/1000`, or an engine.
        until, events: where the comparison ends; else the scene's own limits.
        same_law: whether to look for the smallest scene on which its steps still break the law that they break first
            (a flight, a gap, an impulse: `Violation.kind`), whatever becomes of the history.
        same_cause: whether the divergence must keep its cause (`Diagnosis.name`), not just be one. Causes are found by
            further runs, so that each comparison takes many times as long.
        runs: the most comparisons to make.
        max_seconds: ends the search after about so many seconds, with the smallest scene by then.
        progress: called before each comparison.

    Raises:
        SceneError: if the engine does not diverge on the scene, or with `same_law` breaks no law; for an unknown
            engine, and bad limits.
        OutOfTime: if the seconds are over before the scene itself is compared.
        KeyboardInterrupt: if the user interrupts that first comparison. Later the smallest scene by then is returned.

    >>> from truebreak.scenarios import catalogue
    >>> found = minimise(catalogue.build("near-tie:k=40"), "double")
    >>> found.candidate.verdict, found.minimal
    ('diverged', True)

    Source: A. Zeller and R. Hildebrandt, IEEE Transactions on Software Engineering 28 (2002), 183-200.
    """
    if runs < 1:
        raise SceneError(f"runs = {runs!r}: must be a whole number from 1")
    if same_cause and same_law:
        raise SceneError("same_cause and same_law: what must remain is one of them; leave the other out")
    if until is not None or events is not None:
        scene = scene.with_changes(until=until, events=events)
    kind = _Lawless if same_law else _Search
    search = kind(scene, engine, same_cause, runs, Clock(checked_seconds(max_seconds)), progress)
    return search.run()


class _Ended(Exception):
    """The search may make no more comparisons."""

    def __init__(self, end: End) -> None:
        self.end = end


class _Search:
    """One call of `minimise`: the smallest scene so far, with its comparison."""

    sought = "diverges"

    def __init__(
        self,
        scene: Scene,
        engine: str | Engine,
        same_cause: bool,
        limit: int,
        watch: Clock,
        progress: OnReducing | None,
    ) -> None:
        self.original = scene
        self.engine, self.same_cause = engine, same_cause
        self.limit, self.watch, self.progress = limit, watch, progress
        self.runs, self.cut_short = 0, False
        self.steps: list[Reduction] = []
        self.tried: set[tuple[str, str, int | None]] = set()

    def run(self) -> Smallest:
        """The search, to its end."""
        self.comparison = self._compared(self._named())
        self.cause = _cause(self.comparison)
        self._require_divergence()
        self._set_span()
        try:
            end = self._passes()
        except _Ended as ended:
            end = ended.end
        except KeyboardInterrupt:
            end = End.INTERRUPTED
        if end is not End.INTERRUPTED and not self.same_cause:
            self._explain()
        return Smallest(self.original, self.comparison, tuple(self.steps), self.runs, end, isinstance(self, _Lawless))

    @property
    def best(self) -> Scene:
        """The smallest scene so far."""
        return self.comparison.scene

    def _named(self) -> Scene:
        """The original with a name and a description that are true of what is left of it too."""
        name = self.original.name
        engine = self.engine if isinstance(self.engine, str) else self.engine.name
        told = f"What was left of {name} in a search for the smallest scene on which {engine} {self.sought}."
        return self.original.with_changes(name=f"{name.removesuffix(MINIMISED)}{MINIMISED}", description=told)

    def _passes(self) -> End:
        """Goes over everything that can be left out, until nothing is; first by halves, then one by one."""
        by_one = False
        while True:
            before = self.best
            for kind in THINGS:
                self._reduce(things(self.best, kind), by_one)
            self._reduce(corners(self.best), by_one)
            self._shorten()
            self._reduce(settings(self.best), by_one)
            for denominator in DENOMINATORS:
                self._reduce(digits(self.best, denominator), by_one)
            if by_one and self.best is before:
                return End.SECONDS if self.cut_short else End.MINIMAL
            by_one = True

    def _reduce(self, parts: SceneParts, by_one: bool) -> None:
        """Leaves out of the best scene what can be of these parts."""
        gone: set[str] = set()

        def still(kept: Sequence[str]) -> bool:
            try:
                smaller = parts.keeping(kept)
            except SceneError:
                return False
            left_out = tuple(item for item in parts.items if item not in kept and item not in gone)
            if not by_one and parts.kind in THINGS and smaller.until is None:
                smaller = smaller.with_changes(until=self.until)
            taken = any(self._take(smaller.with_changes(events=n), parts.kind, left_out) for n in self._spans())
            gone.update(left_out if taken else ())
            return taken

        ddmin(parts.items, still, len(parts.items) if by_one else 2)

    def _shorten(self) -> None:
        """Ends the run with the divergence, without a limit in time that the original lacks; then earlier while it
        still shows."""
        shown = min(self._shown(), self.span)
        told = (str(shown),)
        if self.original.until is None and self.best.until is not None:
            self._take(self.best.with_changes(events=shown, until=None), "events", told)
        if self.best.events is None or shown < self.best.events:
            self._take(self.best.with_changes(events=shown), "events", told)
        while self.best.events is not None and self.best.events > 1:
            fewer = self.best.events - 1
            if not self._take(self.best.with_changes(events=fewer), "events", (str(fewer),)):
                break
        if self.best.events is not None:
            self.span = self.best.events

    def _spans(self) -> list[int]:
        """Limits on instants at which a scene is compared, one after the other."""
        spans = [min(self._shown(), self.span)]
        while spans[-1] < self.span:
            spans.append(min(FARTHER * spans[-1], self.span))
        return spans

    def _shown(self) -> int:
        """The instants after which the best scene's divergence has come."""
        divergence = self.comparison.candidates[0].alignment.divergence
        assert divergence is not None
        return divergence.event + 1

    def _set_span(self) -> None:
        """Sets how far any scene is compared: no farther than the original, in instants and in time.

        With fewer circles the same number of events takes longer. Where nothing is left to happen in the original,
        the time is not limited.
        """
        reference = self.comparison.reference
        self.span = self.original.events or max(len(reference.events), self._shown())
        end = math.inf if reference.stop.reason is StopReason.QUIET else reference.final_time.bounds()[1]
        self.until = math.floor(end) + 1 if math.isfinite(end) else None

    def _take(self, scene: Scene, kind: str, removed: tuple[str, ...]) -> bool:
        """Takes a smaller scene if the engine diverges on it."""
        key = scene.digest, str(scene.until), scene.events
        if key in self.tried:
            return False
        self.tried.add(key)
        try:
            comparison = self._compared(scene)
        except SceneError:  # an engine may refuse what the original does not hold
            return False
        if not self._shows(comparison):
            return False
        self.comparison = comparison
        self._note(kind, removed)
        return True

    def _note(self, kind: str, removed: tuple[str, ...]) -> None:
        """Notes a step; what only goes farther by halves in one list is one step."""
        if kind == "digits" and self.steps and self.steps[-1].kind == "digits":
            known = self.steps.pop().removed
            removed = (*known, *(name for name in removed if name not in known))
        self.steps.append(Reduction(kind, removed, self.comparison, self.runs))

    def _shows(self, comparison: Comparison) -> bool:
        """Whether a comparison has what is looked for."""
        if comparison.candidates[0].verdict != "diverged":
            stops = (comparison.reference.stop, comparison.candidates[0].trajectory.stop)
            timed = self.watch.seconds is not None and any(stop.reason is StopReason.BUDGET for stop in stops)
            self.cut_short = self.cut_short or timed
            return False
        return not self.same_cause or _cause(comparison) is self.cause

    def _compared(self, scene: Scene) -> Comparison:
        """One more comparison.

        Raises:
            _Ended: if there may be none.
        """
        if self.runs and self.runs >= self.limit:
            raise _Ended(End.RUNS)
        if self.runs and self.watch.over:
            raise _Ended(End.SECONDS)
        if self.progress is not None:
            self.progress(Reducing(self.runs, self.limit, SceneSize.of(self.best if self.runs else self.original)))
        self.runs += 1
        try:
            left = self.watch.left()
            return compare(scene, [self.engine], causes=self.same_cause, alternatives=False, max_seconds=left)
        except OutOfTime:
            if self.runs == 1:
                raise
            raise _Ended(End.SECONDS) from None

    def _explain(self) -> None:
        """Finds out why the engine diverges on the best scene, as far as the seconds allow."""
        if self.watch.over:
            return
        try:
            explained = compare(self.best, [self.engine], alternatives=False, max_seconds=self.watch.left())
        except (OutOfTime, KeyboardInterrupt):
            return
        if explained.candidates[0].verdict == "diverged":
            self.comparison = explained

    def _require_divergence(self) -> None:
        """Refuses a scene on which there is nothing to look for.

        Raises:
            SceneError: with the verdict.
        """
        candidate, comparison = self.comparison.candidates[0], self.comparison
        if candidate.verdict == "diverged":
            return
        events = len(comparison.reference.events)
        raise SceneError(
            f"engine {candidate.engine!r} is not known to diverge on {self.original.name}: {_told(candidate)} "
            f"(events of the exact run: {events}); there is nothing to minimise; try a longer span or another engine"
        )


class _Lawless(_Search):
    """A search for the smallest scene on which an engine still breaks the law that it breaks first."""

    sought = "does not keep the law"

    @property
    def broken(self) -> Violation | None:
        """The first step of the best scene that misses a law."""
        found = self.comparison.candidates[0].laws
        return None if found is None else found.first

    def _shown(self) -> int:
        broken = self.broken
        return max(len(self.comparison.reference.events), 1) if broken is None else broken.event + 1

    def _shows(self, comparison: Comparison) -> bool:
        candidate = comparison.candidates[0]
        if not candidate.lawless or candidate.laws is None:
            timed = self.watch.seconds is not None and (candidate.laws is None or self.watch.over)
            self.cut_short = self.cut_short or timed
            return False
        first, wanted = candidate.laws.first, self.broken
        return (first is None) == (wanted is None) and (first is None or wanted is None or first.kind == wanted.kind)

    def _explain(self) -> None:
        """A law not kept needs no run to explain it: the audit says what fits."""

    def _require_divergence(self) -> None:
        candidate = self.comparison.candidates[0]
        if candidate.lawless:
            return
        told = "it was not audited" if candidate.laws is None else f"it {candidate.laws.sentence}"
        raise SceneError(
            f"engine {candidate.engine!r} is not known to break a law on {self.original.name}: {told}; there is "
            "nothing to minimise; try a longer span or another engine"
        )


def _cause(comparison: Comparison) -> CauseName | None:
    diagnosis = comparison.candidates[0].diagnosis
    return None if diagnosis is None else diagnosis.name


VERDICT_WORDS = {"agree": "the verdict is agree", "unsettled": "the verdict is not settled"}


def _told(candidate: Candidate) -> str:
    """A verdict that is no divergence, in words."""
    return VERDICT_WORDS.get(candidate.verdict, f"the verdict is undecided, {candidate.trajectory.stop.message}")
