"""Carries a sweep out: jobs through an executor, rows into a store."""

from __future__ import annotations

import multiprocessing
import os
import time as clock
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from itertools import islice
from typing import Any

from ...scenarios.errors import SceneError
from ..engines import engine as engine_named
from ..engines import suggestion
from ..outcomes.outcome import OUTCOMES
from ..validation import check_engine
from .family import Family, family, shard_of
from .rows.row import PERTURBED, SweepJob, SweepRow, engine_of
from .rows.store import Store
from .rows.worker import carry_out, prepare

ASK_FIRST = 100_000
"""Scenes from which on a sweep is asked for twice: at ten a second they take three hours."""

IN_FLIGHT = 3
"""Jobs handed out for each worker: one at work, and the next ready."""


@dataclass(frozen=True)
class Done:
    """How far a sweep is: scenes there, scenes wanted, scenes that failed, seconds so far and scenes in them."""

    there: int
    wanted: int
    failed: int
    seconds: float
    fresh: int

    @property
    def left(self) -> float | None:
        """Seconds that the rest will take at this rate; None before the first."""
        return self.seconds / self.fresh * (self.wanted - self.there - self.failed) if self.fresh else None


@dataclass(frozen=True)
class Sweep:
    """What a sweep asks for.

    Attributes:
        family: its scenes.
        engines: labels of engines, and `perturbed:SIZE`.
        events: of each certified run; None: the scene's own.
        outcomes: names of outcomes that are compared at the end of the runs.
        causes: whether causes are looked for.
        work: what one question may cost the exact engine; None: its default.
        shard: which part of how many.
        audit: whether every step of the engines' runs is audited.
    """

    family: Family
    engines: tuple[str, ...]
    events: int | None = None
    outcomes: tuple[str, ...] = ()
    causes: bool = False
    work: int | None = None
    shard: tuple[int, int] = (1, 1)
    audit: bool = True

    @property
    def settings(self) -> dict[str, Any]:
        """As a store keeps them."""
        return {
            "scene": self.family.scene,
            "vary": [parameter.text() for parameter in self.family.parameters],
            "engines": list(self.engines),
            "events": self.events,
            "outcomes": list(self.outcomes),
            "causes": self.causes,
            "work": self.work,
            "shard": list(self.shard),
            "audit": self.audit,
        }

    def job(self, index: int) -> SweepJob:
        """What is asked of one scene."""
        of = self.family
        return SweepJob(index, of.spec(index), of.settings(index), self.engines, self.events, self.outcomes,
                        self.causes, self.work, self.audit)  # fmt: skip


def plan(
    scene: str,
    vary: Sequence[str] = (),
    engines: Sequence[str] = ("double",),
    *,
    events: int | None = None,
    perturb: Sequence[str] = (),
    outcomes: Sequence[str] = (),
    causes: bool = False,
    work: int | None = None,
    shard: str = "1/1",
    audit: bool = True,
) -> Sweep:
    """A sweep, checked before anything runs.

    Args:
        scene: a catalogue scene, perhaps with settings, or a file.
        vary: `KEY=LOW..HIGH`, `KEY=LOW..HIGH:STEP` or `KEY=VALUE,VALUE`, one for each parameter.
        engines: their names.
        perturb: sizes of displacements; each adds the certified run of the displaced scene.
        outcomes: see `compare.OUTCOMES`.
        shard: `K/N`.
        audit: whether every step of the engines' runs is audited.

    Raises:
        SceneError: for whatever of these is wrong.

    >>> len(plan("gas", ["n=3..20", "seed=1..500"], ["double"]).family)
    9000
    """
    labels = (*engines, *(f"{PERTURBED}{size}" for size in perturb))
    if not labels:
        raise SceneError("no engine to hold against the certified runs; name at least one, such as double")
    for label in engines:
        check_engine(engine_named(label))
    for label in labels:
        engine_of(label, 0)
    if len(set(labels)) < len(labels):
        raise SceneError("--engines: an engine is named twice; keep one")
    for name in outcomes:
        if name not in OUTCOMES:
            raise SceneError(f"--outcome {name!r}: is not known; {suggestion(name, list(OUTCOMES))}")
    return Sweep(family(scene, vary), labels, events, tuple(outcomes), causes, work, shard_of(shard), audit)


def pool(jobs: int | None = None) -> ProcessPoolExecutor:
    """Worker processes, started afresh: one for each processor unless told otherwise."""
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        raise SystemExit(1)  # a worker that runs the user's script once more: its parent says what to do
    count = (os.cpu_count() or 1) if jobs is None else jobs
    return ProcessPoolExecutor(count, mp_context=multiprocessing.get_context("spawn"), initializer=prepare)


NO_WORKERS = (
    "sweep: no worker process can be started; each reads the script that calls sweep, which has to do so below "
    '`if __name__ == "__main__":`'
)


def _starts() -> bool:
    """Whether a worker process comes up at all."""
    with pool(1) as executor:
        return executor.submit(os.getpid).exception() is None


def run(
    sweep: Sweep,
    store: Store,
    *,
    jobs: int | None = None,
    executor: Executor | None = None,
    progress: Callable[[Done], None] | None = None,
) -> None:
    """Carries out what is not in the store yet; every scene is in it as soon as it is done.

    A scene whose worker dies is tried once more, by itself; if that comes to nothing too, it is noted beside the table.

    Args:
        jobs: how many worker processes; by default one for each processor.
        executor: any other executor in their place. It is not shut down.

    Raises:
        SceneError: if the store cannot be written any more.
        KeyboardInterrupt: on Ctrl-C; what is done is in the store.
    """
    _Run(sweep, store, jobs, executor, progress).run()


def sweep(
    scene: str,
    vary: Sequence[str] = (),
    engines: Sequence[str] = ("double",),
    *,
    store: str = ":memory:",
    jobs: int | None = None,
    executor: Executor | None = None,
    progress: Callable[[Done], None] | None = None,
    **asked: Any,
) -> list[SweepRow]:
    """Plans a sweep, carries it out, and gives its rows in the order of the scenes.

    Args:
        store: the file that keeps the rows; what is in it already is not done again.
        asked: `events`, `perturb`, `outcomes`, `causes`, `work` and `shard`, as for `plan`.
        jobs, executor, progress: see `run`.

    Without an executor it starts processes, each of which reads the script that calls it: that has to be done below
    `if __name__ == "__main__":`. Scenes that came to nothing are warned of.

    Raises:
        SceneError: as `plan`, `Store` and `run`.

    >>> from concurrent.futures import ThreadPoolExecutor
    >>> with ThreadPoolExecutor(1) as one:
    ...     rows = sweep("gas:n=3", ["seed=1..2"], ["single"], events=60, executor=one)
    >>> [(row["index"], row["verdict"]) for row in rows]
    [(0, 'diverged'), (1, 'diverged')]
    """
    planned = plan(scene, vary, engines, **asked)
    base = Store(store, planned.settings)
    try:
        run(planned, base, jobs=jobs, executor=executor, progress=progress)
        _warn_of_failures(base)
        return list(base.rows())
    finally:
        base.close()


class SweepWarning(UserWarning):
    """Some scenes of a sweep came to nothing, and have no rows.

    Attributes:
        in_one_line: tells the command line to show it as such.
    """

    in_one_line = True


def _warn_of_failures(base: Store) -> None:
    done = base.done()
    failed = {scene: note for scene, _, note in base.failures() if scene not in done}
    if failed:
        first = min(failed)
        told = f"{len(failed):,} scene{'' if len(failed) == 1 else 's'} came to nothing, and have no rows"
        warnings.warn(f"{told}: scene {first}: {failed[first]}", SweepWarning, stacklevel=3)


class _Run:
    """One call of `run`."""

    def __init__(
        self,
        sweep: Sweep,
        store: Store,
        jobs: int | None,
        executor: Executor | None,
        progress: Callable[[Done], None] | None,
    ) -> None:
        self.sweep, self.store, self.jobs, self.given = sweep, store, jobs, executor
        self.progress = progress
        self.there = store.done()
        self.wanted = len(range(sweep.shard[0] - 1, len(sweep.family), sweep.shard[1]))
        self.began, self.fresh, self.failed = clock.perf_counter(), 0, 0

    def run(self) -> None:
        waiting = (index for index in self.sweep.family.indices(self.sweep.shard) if index not in self.there)
        whole = False
        while not whole:
            again, whole = self._together(waiting)
            for index in again:
                self._alone(index)

    def _together(self, waiting: Iterator[int]) -> tuple[list[int], bool]:
        """Hands out jobs while the workers last: those to try again, and whether nothing is waiting any more."""
        executor = pool(self.jobs) if self.given is None else self.given
        room = IN_FLIGHT * (self.jobs or os.cpu_count() or 1)
        flying: dict[Future[Any], int] = {}
        again: list[int] = []
        try:
            while True:
                for index in islice(waiting, room - len(flying)):
                    flying[executor.submit(carry_out, self.sweep.job(index))] = index
                if not flying:
                    return again, True
                for future in wait(flying, return_when=FIRST_COMPLETED).done:
                    index = flying.pop(future)
                    error = future.exception()
                    if error is None:
                        self._keep(index, future)
                    else:
                        self._fail(index, 1, error)
                        again.append(index)
                    if isinstance(error, BrokenExecutor):
                        self._check_own(error)
                        again += sorted(flying.values())
                        return sorted(again), False
        finally:
            if self.given is None:
                executor.shutdown(wait=True, cancel_futures=True)

    def _alone(self, index: int) -> None:
        """The second attempt at a scene, with no other in flight: what dies now dies of it."""
        executor = pool(1) if self.given is None else self.given
        try:
            future = executor.submit(carry_out, self.sweep.job(index))
            error = future.exception()
            if error is None:
                self._keep(index, future)
                return
            self._fail(index, 2, error)
            self.failed += 1
            self._tell()
            if isinstance(error, BrokenExecutor):
                self._check_own(error)
        finally:
            if self.given is None:
                executor.shutdown(wait=True, cancel_futures=True)

    def _check_own(self, error: BrokenExecutor) -> None:
        """A broken executor of the caller's cannot be started afresh; nor can one whose workers never come up."""
        if self.given is None and not self.fresh and not _starts():
            raise SceneError(NO_WORKERS) from None
        if self.given is not None:
            raise SceneError(f"the executor lost its workers ({error}); start it again, and call again: "
                             "what is done stays") from None  # fmt: skip

    def _keep(self, index: int, future: Future[Any]) -> None:
        rows, seconds = future.result()
        self.store.add(index, rows, seconds)
        self.there.add(index)
        self.fresh += 1
        self._tell()

    def _fail(self, index: int, attempt: int, error: BaseException) -> None:
        self.store.fail(index, attempt, f"{type(error).__name__}: {' '.join(str(error).split())}")

    def _tell(self) -> None:
        if self.progress is not None:
            seconds = clock.perf_counter() - self.began
            self.progress(Done(len(self.there), self.wanted, self.failed, seconds, self.fresh))
