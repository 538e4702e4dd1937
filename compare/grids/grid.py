"""A grid of jobs carried out: through an executor, into a store, in whatever order they end; what is there stays."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future
from dataclasses import dataclass
from itertools import islice
from queue import Empty, SimpleQueue
from typing import Any, Protocol

from ...scenarios.errors import SceneError
from .executors import Here, Job, cores, do, pool, starts
from .store import SECONDS, Store

IN_FLIGHT = 3
"""Jobs handed out for each worker: one at work, and the next ready."""

ELSEWHERE = 4096
"""Jobs handed out to an executor of the caller's, whose workers are not known: small texts, enough for a cluster."""

NO_WORKERS = (
    "no worker process can be started; each reads the script that calls this, which has to do so below "
    '`if __name__ == "__main__":`'
)


class Plan(Protocol):
    """What a grid asks for: its jobs by number, none made before it is needed."""

    @property
    def settings(self) -> Mapping[str, Any]:
        """What decides its rows, as a store keeps it; `grid` names the kind."""
        ...

    @property
    def apart(self) -> bool:
        """Whether a job goes to a worker process even where there is one worker: what dies then dies alone."""
        ...

    def indices(self) -> Sequence[int]:
        """The numbers of the jobs."""
        ...

    def key(self, index: int) -> str:
        """What decides a job's rows beside the settings: a row made for another key is made again."""
        ...

    def job(self, index: int) -> Job:
        """One of them."""
        ...


@dataclass(frozen=True)
class Done:
    """How far a grid is: jobs there, wanted and failed, seconds so far and jobs done in them, and the last one."""

    there: int
    wanted: int
    failed: int
    seconds: float
    fresh: int
    label: str = ""

    @property
    def left(self) -> float | None:
        """Seconds that the rest will take at this rate; None before the first."""
        return self.seconds / self.fresh * (self.wanted - self.there - self.failed) if self.fresh else None


OnDone = Callable[[Done], None]


def carry_out(
    plan: Plan,
    store: Store,
    *,
    jobs: int | None = None,
    executor: Executor | None = None,
    progress: OnDone | None = None,
) -> None:
    """Does what is not in the store yet.

    A scene whose worker dies is tried once more, by itself; if that comes to nothing too, it is noted beside the rows.

    Args:
        jobs: how many worker processes; by default one for each processor. With one, or where one job is left, all is
            done in this process, unless the plan wants its jobs apart.
        executor: any other executor in their place. It is not shut down. `jobs` is then how many it takes at once, if
            that is known.
        progress: called after each job.

    Raises:
        SceneError: for bad input, and if the store cannot be written any more.
        KeyboardInterrupt: on Ctrl-C; what is done is in the store.
    """
    _Run(plan, store, jobs, executor, progress).run()


class _Run:
    """One call of `carry_out`."""

    def __init__(
        self, plan: Plan, store: Store, jobs: int | None, executor: Executor | None, progress: OnDone | None
    ) -> None:
        self.plan, self.store, self.given, self.progress = plan, store, executor, progress
        wanted, there = plan.indices(), store.done(plan.key)
        self.wanted = len(wanted)
        self.waiting = (index for index in wanted if index not in there)
        self.there = len(there.intersection(wanted)) if there else 0
        left = self.wanted - self.there
        self.workers = min(cores() if jobs is None else jobs, max(left, 1))
        self.here = executor is None and self.workers == 1 and not plan.apart
        self.room = 1 if self.here else IN_FLIGHT * self.workers
        if executor is not None:
            self.room = ELSEWHERE if jobs is None else IN_FLIGHT * jobs
        self.began, self.fresh, self.failed = clock.perf_counter(), 0, 0

    def run(self) -> None:
        try:
            whole = False
            while not whole:
                again, whole = self._together(self.waiting)
                for index in again:
                    self._alone(index)
        finally:
            self.store.keep()

    def _workers(self, count: int) -> Executor:
        return self.given or (Here() if self.here else pool(count))

    def _together(self, waiting: Iterator[int]) -> tuple[list[int], bool]:
        """Hands out jobs while the workers last: those to try again, and whether nothing is waiting any more."""
        executor = self._workers(self.workers)
        ended: SimpleQueue[Future[Any]] = SimpleQueue()
        flying: dict[Future[Any], int] = {}
        again: list[int] = []
        broken: BrokenExecutor | None = None
        noted = False
        try:
            while True:
                for index in islice(waiting, self.room - len(flying)) if broken is None else ():
                    try:
                        future = executor.submit(do, self.plan.job(index))
                    except BrokenExecutor as error:
                        broken = error
                        again.append(index)
                        break
                    flying[future] = index
                    future.add_done_callback(ended.put)
                if not flying:
                    if broken is not None:
                        self._check_own(broken)
                    return sorted(again), broken is None
                future = self._next(ended)
                index, error = flying.pop(future), future.exception()
                if error is None:
                    self._keep(index, future)
                    continue
                if not isinstance(error, BrokenExecutor) or not noted:
                    self._fail(index, 1, error)
                if isinstance(error, BrokenExecutor):  # of all that were in flight, which are tried again
                    broken, noted = error, True
                again.append(index)
        finally:
            for future in flying:
                future.cancel()
            if self.given is None:
                executor.shutdown(wait=True, cancel_futures=True)

    def _next(self, ended: SimpleQueue[Future[Any]]) -> Future[Any]:
        """The next that ends; what is there is written before it is long waited for."""
        try:
            return ended.get(timeout=SECONDS)
        except Empty:
            self.store.keep()
            return ended.get()

    def _alone(self, index: int) -> None:
        """The second attempt at a scene, with no other in flight: what dies now dies of it."""
        executor = self._workers(1)
        try:
            future = executor.submit(do, self.plan.job(index))
            error = future.exception()
            if error is None:
                self._keep(index, future)
                return
            self._fail(index, 2, error)
            self.failed += 1
            self._tell(index)
            if isinstance(error, BrokenExecutor):
                self._check_own(error)
        finally:
            if self.given is None:
                executor.shutdown(wait=True, cancel_futures=True)

    def _check_own(self, error: BrokenExecutor) -> None:
        """A broken executor of the caller's cannot be started afresh; nor can one whose workers never come up."""
        if self.given is None and not self.fresh and not starts():
            raise SceneError(f"{self.plan.settings['grid']}: {NO_WORKERS}") from None
        if self.given is not None:
            raise SceneError(f"the executor lost its workers ({error}); start it again, and call again: "
                             "what is done stays") from None  # fmt: skip

    def _keep(self, index: int, future: Future[Any]) -> None:
        rows, seconds = future.result()
        self.store.add(index, self.plan.key(index), rows, seconds)
        self.there += 1
        self.fresh += 1
        self._tell(index)

    def _fail(self, index: int, attempt: int, error: BaseException) -> None:
        own = self.here and not isinstance(error, MemoryError)
        if own or isinstance(error, SceneError) or not isinstance(error, Exception):
            raise error
        self.store.fail(index, attempt, f"{type(error).__name__}: {' '.join(str(error).split())}")

    def _tell(self, index: int) -> None:
        if self.progress is not None:
            seconds = clock.perf_counter() - self.began
            label = self.plan.job(index).label
            self.progress(Done(self.there, self.wanted, self.failed, seconds, self.fresh, label))


def several(text: str, option: str) -> range | None:
    """`LOW..HIGH` or `LOW..HIGH:STEP` as the numbers from the one to the other; None for text of another form.

    Raises:
        SceneError: for an empty range, and a step of 0.

    >>> several("14..18", "--levels"), several("0..90:30", "--vary"), several("5", "--vary")
    (range(14, 19), range(0, 91, 30), None)
    """
    ends, colon, step = text.strip().partition(":")
    low, dots, high = ends.partition("..")
    numbers = (low, high, *([step] if colon else []))
    if not dots or not all(part.removeprefix("-").isdecimal() and len(part) <= 15 for part in numbers):
        return None
    first, last, by = int(low), int(high), int(step or 1)
    if by <= 0:
        raise SceneError(f"{option} {text!r}: a step of {by} goes nowhere; make it 1 or more")
    if last < first:
        raise SceneError(
            f"{option} {text!r}: the range is empty, as {last} is below {first}; write the lower end first"
        )
    return range(first, last + 1, by)
