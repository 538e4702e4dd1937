"""What a stress map asks for, and how it is carried out: place by place, each row kept as soon as it is there."""

from __future__ import annotations

import re
import time as clock
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from ...scenarios.errors import SceneError
from ..engines import engine as engine_named
from ..grids.row import versions
from ..grids.executors import pool
from ..validation import check_engine
from .family import Family, MapPlace
from .rows.cell import Job, StressRow, row_of
from .store import Store
from .table import FAMILIES, family

DEFAULT_ENGINES = ("single", "double", "quad", "interval", "pymunk:max_steps=300000")
"""Held against the certified run unless others are asked for. 300,000 steps of pymunk take about a second."""

MOST_LEVELS = 1000


@dataclass(frozen=True)
class Plan:
    """Families, their levels, and engines.

    Attributes:
        families: in the order of the table.
        engines: labels of the engines held against the exact one, which is always there.
        levels: the k of every family; None: each family's own.
        short: whether only a few of each family's own.
    """

    families: tuple[Family, ...]
    engines: tuple[str, ...]
    levels: range | None = None
    short: bool = False

    @property
    def settings(self) -> dict[str, Any]:
        """As a store keeps them."""
        levels = None if self.levels is None else [self.levels[0], self.levels[-1]]
        return {
            "families": [one.name for one in self.families],
            "engines": list(self.engines),
            "levels": levels,
            "short": self.short,
            "versions": versions(),
        }

    def places(self) -> Iterator[MapPlace]:
        """Every place of the map, in order."""
        for one in self.families:
            yield from one.places(one.levels(self.short) if self.levels is None else tuple(self.levels))


def levels_of(text: str) -> range:
    """`LOW..HIGH` as the numbers from the one to the other.

    Raises:
        SceneError: for anything else.

    >>> levels_of("14..18")
    range(14, 19)
    """
    match = re.fullmatch(r"(\d{1,9})\.\.(\d{1,9})", text.strip())
    if match is None or int(match[1]) > int(match[2]):
        raise SceneError(f"--levels {text!r}: is not LOW..HIGH with LOW the smaller; write 14..18")
    found = range(int(match[1]), int(match[2]) + 1)
    if len(found) > MOST_LEVELS:
        raise SceneError(f"--levels {text!r}: are {len(found):,} levels; ask for at most {MOST_LEVELS:,}")
    return found


def plan(
    families: Sequence[str] = (),
    engines: Sequence[str] = DEFAULT_ENGINES,
    *,
    levels: str | None = None,
    short: bool = False,
) -> Plan:
    """What is asked for, checked before anything runs.

    Args:
        families: their names; none: all of them.
        engines: what to hold against the exact engine, which is in every map; named here too, it is in it once.
        levels: `LOW..HIGH`, the k of every family; each has to have all of them.
        short: whether only a few of each family's own levels.

    Raises:
        SceneError: for whatever of these is wrong.

    >>> len(list(plan(["near-ties"], ["double"], levels="14..18").places()))
    10
    """
    if len(set(families)) < len(families):
        raise SceneError("a family is named twice; keep one")
    chosen = [family(name) for name in families or FAMILIES]
    chosen.sort(key=lambda one: list(FAMILIES).index(one.name))
    labels = tuple(label for label in engines if label != "exact")
    for label in labels:
        if label.partition(":")[0] == "exact":
            raise SceneError(
                f"--engines {label}: the exact engine is in every map as it is, checked by a witness; leave it out"
            )
        check_engine(engine_named(label))
    if len(set(labels)) < len(labels):
        raise SceneError("--engines: an engine is named twice; keep one")
    found = None if levels is None else levels_of(levels)
    if found is not None and short:
        raise SceneError("--short and --levels both say which levels; keep one of them")
    for one in chosen:
        for k in () if found is None else (found[0], found[-1]):
            one.check(k)
    return Plan(tuple(chosen), labels, found, short)


@dataclass(frozen=True)
class Done:
    """How far a map is: rows there, rows wanted, seconds so far and rows in them, and what was told last."""

    there: int
    wanted: int
    seconds: float
    fresh: int
    place: MapPlace

    @property
    def left(self) -> float | None:
        """Seconds that the rest will take at this rate; None before the first."""
        return self.seconds / self.fresh * (self.wanted - self.there) if self.fresh else None


def carry_out(
    asked: Plan, store: Store, *, jobs: int = 1, progress: Callable[[Done], None] | None = None
) -> list[StressRow]:
    """Does what is not in the store yet, in order; each row is in it as soon as it is there.

    Args:
        jobs: worker processes; with 1, all is done in this one.
        progress: called after each row.

    Raises:
        SceneError: if the store cannot be written any more, or a worker process was ended by another.
        KeyboardInterrupt: on Ctrl-C; what is done is in the store.

    >>> asked = plan(["near-ties"], ["double"], levels="15..16")
    >>> rows = carry_out(asked, Store(None, asked.settings))
    >>> [row["engines"]["double"]["mark"] for row in rows]
    ['right', 'wrong', 'right', 'wrong']
    """
    places = list(asked.places())
    waiting = [Job(place, asked.engines) for place in places[len(store.rows) :]]
    began, fresh = clock.perf_counter(), 0
    try:
        with _rows(waiting, jobs) as rows:
            for job, row in zip(waiting, rows, strict=True):
                store.add(row)
                fresh += 1
                if progress is not None:
                    progress(Done(len(store.rows), len(places), clock.perf_counter() - began, fresh, job.place))
    except BrokenExecutor:
        raise SceneError(f"--jobs {jobs}: a worker process was ended; call again: what is done stays") from None
    return store.rows


@contextmanager
def _rows(jobs: Sequence[Job], workers: int) -> Iterator[Iterator[StressRow]]:
    """The rows of jobs, in order; with several workers, computed ahead."""
    if workers == 1 or len(jobs) < 2:
        yield map(row_of, jobs)
        return
    executor = pool(workers)
    try:
        yield executor.map(row_of, jobs)
    finally:
        executor.shutdown(wait=True, cancel_futures=True)
