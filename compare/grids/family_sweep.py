"""A sweep: every scene of a family in several engines, a row each, and what the rows are made of."""

from __future__ import annotations

import csv
import io
import json
import math
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ...exact.exact_engine import ExactEngine
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ..audit.audit import Audit, audit_run
from ..deadline import uninterrupted
from ..engines import engine as engine_named
from ..engines import suggestion
from ..files.amounts import no_formula, plain
from ..outcomes.outcome import OUTCOMES
from ..scene_argument import scene_from
from ..validation import check_engine
from .grid import OnDone, carry_out
from .row import Row, diagnosed, divergence_of, followed, laws_brief, outcomes_changed, reference_of, versions
from .scene_family import Perturbed, SceneFamily, family, shard_of
from .store import Store

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.trajectory import Trajectory
    from ..chaos.horizon import Followed, Horizon

PERTURBED = "perturbed:"
"""What the label of a displaced scene's certified run begins with."""

DISPLACED = "displaced start"
"""Why the certified run of a displaced scene diverges: there is nothing else."""

ASK_FIRST = 100_000
"""Scenes from which on a sweep is asked for twice: at ten a second they take three hours."""

COLUMNS = (
    "index", "scene", "digest", "parameters", "engine", "verdict", "agreed", "events", "time", "stop",
    "event", "at", "body", "expected", "got", "kind", "cause", "margin", "error",
    "predicted_low", "predicted", "predicted_high", "by_exponent", "lyapunov", "lyapunov_low", "lyapunov_high",
    "changed", "laws", "work", "versions", "note",
)  # fmt: skip
"""What the table of a sweep has of each row, in order; docs/sweep.md says what each means."""


@dataclass(frozen=True)
class SweepJob:
    """One scene and what is asked of it.

    Attributes:
        index: its place in the sweep.
        scene: its text.
        parameters: what varies.
        engines: labels of engines, and `perturbed:SIZE`.
        events: of the certified run; None: the scene's own limit.
        outcomes: names of outcomes to compare at the end; each engine then runs to the end.
        causes: whether to find out why engines diverged.
        work: what one question may cost the exact engine; None: its default.
        audit: whether every step of each engine's run is audited, as far as it was followed.
        forecast: whether to predict when each engine diverges: two to ten times the work of the rest.
    """

    index: int
    scene: str
    parameters: Mapping[str, str]
    engines: tuple[str, ...]
    events: int | None = None
    outcomes: tuple[str, ...] = ()
    causes: bool = False
    work: int | None = None
    audit: bool = True
    forecast: bool = False

    @property
    def label(self) -> str:
        """Its scene."""
        return self.scene

    def rows(self) -> list[Row]:
        """In the order of the engines. A scene that cannot be built, and an engine that cannot take it, are rows too,
        with the verdict `refused`."""
        parameters = dict(self.parameters)
        blank = [Row(self.index, self.scene, label, parameters=parameters) for label in self.engines]
        try:
            scene = scene_from(self.scene)
            truth = ExactEngine() if self.work is None else ExactEngine(work=self.work)
            run = uninterrupted(truth.run(scene, events=self.events))
        except SceneError as error:
            return [replace(row, verdict="refused", note=str(error)) for row in blank]
        work = dict(sorted((str(k), plain(v)) for k, v in run.plan.items()))
        shared = {**reference_of(run), "work": work, "versions": versions()}
        forecast = Forecast(run) if self.forecast else None
        return [self._row(replace(row, **shared), run, forecast) for row in blank]

    def _row(self, row: Row, run: Trajectory, forecast: Forecast | None) -> Row:
        label, engine = row.engine, engine_of(row.engine, self.index)
        foreseen = len(run.events) if self.outcomes else None
        if forecast is not None:
            told, horizon = forecast.of(label, engine)
            row = replace(row, **told)
            if foreseen is None and horizon is not None and horizon.high.event is not None:
                from ..chaos.horizon import MORE_EVENTS

                foreseen = horizon.high.event + MORE_EVENTS
        try:
            found = followed(run, engine, foreseen)
        except SceneError as error:
            return replace(row, verdict="refused", note=str(error))
        if found.unable:
            return replace(row, verdict="refused", note=found.run.stop.message)
        told, laws = divergence_of(found.alignment), None
        if self.audit and not label.startswith(PERTURBED):
            laws = audit_run(found.run, engine)
            told["laws"] = laws_brief(laws)
        if self.outcomes and told["verdict"] in ("agree", "diverged"):
            over = outcomes_changed(found, run, engine.step, self.outcomes)
            told["changed"] = list(over.changed) if over.until is None else None
        if self.causes:
            displaced = "event" in told and label.startswith(PERTURBED)
            told |= {"cause": DISPLACED} if displaced else _why(found, label, engine, laws)
        return replace(row, **told)


class Forecast:
    """What a certified run predicts of engines; nothing where there is no tangent map, or nothing moves."""

    def __init__(self, run: Trajectory) -> None:
        from ..chaos.horizon import Forecaster
        from ..chaos.spectrum import spectrum
        from ..tangent.impacts import NoTangentMap, impacts

        self.forecaster: Forecaster | None = None
        self.exponent, self.lyapunov = 0.0, dict[str, Any]()
        if not run.events or all(circle.fixed for circle in run.scene.circles):
            return
        try:
            struck = impacts(run, len(run.events))
        except NoTangentMap:
            return
        found = spectrum(run.scene, struck, 1)
        told = found.per_time()
        self.lyapunov = {"lyapunov": told.value, "lyapunov_low": told.low, "lyapunov_high": told.high}
        self.exponent = told.value if found.chaotic else 0.0
        self.forecaster = Forecaster(run, struck)

    def of(self, label: str, engine: Engine) -> tuple[dict[str, Any], Horizon | None]:
        """What a row has of it, and where the engine is expected to diverge."""
        told = dict(self.lyapunov)
        horizon = None if self.forecaster is None else self.forecaster.foresee(label, engine, self.exponent)
        unit = None if horizon is None else horizon.unit
        if label.startswith(PERTURBED):
            unit = float(Quantity.of(label.removeprefix(PERTURBED)).ball(64).log()) / math.log(2)
        if self.exponent > 0 and unit is not None:
            told["by_exponent"] = -unit * math.log(2) / self.exponent
        if horizon is not None:
            told |= {"predicted": horizon.expected.event, "predicted_low": horizon.low.event,
                     "predicted_high": horizon.high.event}  # fmt: skip
        return told, horizon


def _why(found: Followed, label: str, engine: Engine, laws: Audit | None) -> dict[str, Any]:
    """The cause, the margin and the engine's error, by the experiments of `compare`."""
    candidate = diagnosed(found, label, engine, laws)
    margin = candidate.margin
    return {
        "cause": None if candidate.diagnosis is None else candidate.diagnosis.name.value,
        "margin": None if margin is None or margin.distance is None else list(margin.distance),
        "error": None if margin is None else margin.error,
    }


def engine_of(label: str, seed: int) -> Engine:
    """The engine of a label; the displacements of a perturbed scene are drawn by the scene's place in the sweep.

    Raises:
        SceneError: for an unknown one.
    """
    if label.startswith(PERTURBED):
        return Perturbed(Quantity.of(label.removeprefix(PERTURBED)), seed)
    return engine_named(label)


@dataclass(frozen=True)
class Sweep:
    """What a sweep asks for: see `SweepJob`; of its family the part `shard`, the Kth of N."""

    family: SceneFamily
    engines: tuple[str, ...]
    events: int | None = None
    outcomes: tuple[str, ...] = ()
    causes: bool = False
    work: int | None = None
    shard: tuple[int, int] = (1, 1)
    audit: bool = True
    forecast: bool = False

    apart = True

    @property
    def settings(self) -> dict[str, Any]:
        """As a store keeps them."""
        return {
            "grid": "sweep",
            "versions": versions(),
            "scene": self.family.scene,
            "vary": [parameter.text() for parameter in self.family.parameters],
            "engines": list(self.engines),
            "events": self.events,
            "outcomes": list(self.outcomes),
            "causes": self.causes,
            "work": self.work,
            "shard": list(self.shard),
            "audit": self.audit,
            "forecast": self.forecast,
        }

    def indices(self) -> range:
        """The scenes of its shard."""
        return self.family.indices(self.shard)

    def key(self, index: int) -> str:
        """Its settings say all."""
        return ""

    def job(self, index: int) -> SweepJob:
        """What is asked of one scene."""
        of = self.family
        return SweepJob(index, of.spec(index), of.settings(index), self.engines, self.events, self.outcomes,
                        self.causes, self.work, self.audit, self.forecast)  # fmt: skip


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
    forecast: bool = False,
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
        forecast: whether to predict when each engine diverges.

    Raises:
        SceneError: for whatever of these is wrong.

    >>> len(plan("gas", ["n=3..20", "seed=1..500"], ["double"]).family)
    9000
    """
    labels = (*engines, *(f"{PERTURBED}{size}" for size in perturb))
    if not labels:
        raise SceneError("no engine to compare with the certified runs; name at least one, such as double")
    for label in engines:
        check_engine(engine_named(label))
    for label in labels:
        engine_of(label, 0)
    if len(set(labels)) < len(labels):
        raise SceneError("--engines: an engine is named twice; keep one")
    for name in outcomes:
        if name not in OUTCOMES:
            raise SceneError(f"--outcome {name!r}: is not known; {suggestion(name, list(OUTCOMES))}")
    return Sweep(family(scene, vary), labels, events, tuple(outcomes), causes, work, shard_of(shard), audit, forecast)


def sweep(
    scene: str,
    vary: Sequence[str] = (),
    engines: Sequence[str] = ("double",),
    *,
    store: str = ":memory:",
    jobs: int | None = None,
    executor: Executor | None = None,
    progress: OnDone | None = None,
    **asked: Any,
) -> Store:
    """Plans a sweep, carries it out, and gives its rows in the order of the scenes: read from the store one by one.

    Args:
        store: the file that keeps the rows; what is in it already is not done again.
        asked: `events`, `perturb`, `outcomes`, `causes`, `work`, `shard`, `audit` and `forecast`, as for `plan`.
        jobs, executor, progress: see `carry_out`.

    Without an executor it starts processes, each of which reads the script that calls it: that has to be done below
    `if __name__ == "__main__":`. Scenes that came to nothing are warned of.

    Raises:
        SceneError: as `plan`, `Store` and `carry_out`.

    >>> from concurrent.futures import ThreadPoolExecutor
    >>> with ThreadPoolExecutor(1) as one:
    ...     rows = sweep("gas:n=3", ["seed=1..2"], ["single"], events=60, executor=one)
    >>> [(row.index, row.verdict) for row in rows]
    [(0, 'diverged'), (1, 'diverged')]
    """
    planned = plan(scene, vary, engines, **asked)
    rows = Store(store, planned.settings)
    carry_out(planned, rows, jobs=jobs, executor=executor, progress=progress)
    failed = rows.failures(undone=True)
    if failed:
        count = len({scene for scene, _, _ in failed})
        told = f"{count:,} scene{'' if count == 1 else 's'} came to nothing, and have no rows"
        warnings.warn(f"{told}: scene {failed[0][0]}: {failed[0][2]}", SweepWarning, stacklevel=2)
    return rows


class SweepWarning(UserWarning):
    """Some scenes of a sweep came to nothing, and have no rows.

    Attributes:
        in_one_line: tells the command line to show it as such.
    """

    in_one_line = True


# -- the rows as a table


PART = 500
"""Rows of a table that are in memory at once."""


def csv_parts(rows: Iterable[Row], keys: Sequence[str]) -> Iterator[str]:
    """The rows of a sweep as CSV, some lines at a time, each varied parameter in a column of its own; equal rows give
    equal bytes.

    >>> text = "".join(csv_parts([Row(3, "gas:n=5", "double", parameters={"n": "5"}, changed=["collisions"])], ["n"]))
    >>> text.splitlines()[1].split(",")[:4]
    ['3', 'gas:n=5', '', '5']
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    at = COLUMNS.index("parameters")
    columns = [*COLUMNS[:at], *keys, *COLUMNS[at + 1 :]]
    writer.writerow(columns)
    places = {column: place for place, column in enumerate(columns) if not at <= place < at + len(keys)}
    objects = rows.objects() if isinstance(rows, Store) else (row.data() for row in rows)
    for number, row in enumerate(objects, 1):
        cells: list[Any] = [None] * len(columns)
        for column, value in row.items():
            if column in places:
                cells[places[column]] = value if type(value) in (int, float) else _cell(value)
        varied = row.get("parameters") or {}
        for place, key in enumerate(keys, at):
            cells[place] = no_formula(varied.get(key, ""))
        writer.writerow(cells)
        if number % PART == 0:
            yield out.getvalue()
            out.seek(0)
            out.truncate()
    yield out.getvalue()


def _cell(value: Any) -> Any:
    return _compact(value) if isinstance(value, dict | list) else no_formula(value)


_compact = json.JSONEncoder(separators=(",", ":")).encode
