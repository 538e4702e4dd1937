"""One engine on one scene as a row of plain data: what all grids keep, print and compare, and its one JSON form."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cache
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, get_type_hints

from ...scenarios.disk import fits
from ...scenarios.errors import SceneError, cut
from ..alignment.align import UNKNOWING, not_measured
from ..audit.audit import Audit, audit_run
from ..candidate import Candidate
from ..chaos.horizon import Followed, follow
from ..comparison import explained
from ..files.amounts import plain
from ..outcomes.matched import held
from ..outcomes.outcome import outcome, outcomes_of

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.trajectory import Trajectory
    from ..alignment.align import Alignment
    from ..study import Study

VerdictWord = Literal["agree", "diverged", "unsettled", "undecided", "refused", "failed"]


@dataclass(frozen=True, slots=True)
class Row:
    """One engine on one scene. Made of what JSON knows; what does not apply, or is not known, is None.

    Attributes:
        index: place of the scene in its grid, from 0.
        scene: the scene, as on the command line.
        engine: the engine and its settings, as asked for, or its label.
        verdict: as in a comparison; `refused`: the scene or the engine cannot be run; `failed`: the engine
            ended with an error.
        digest: digest of the scene; null if it cannot be built.
        parameters: values of what varies over the grid.
        settings: all parameters of the engine, those it is built with too.
        agreed: events before the first divergence.
        events: events of the reference.
        time: time at which the reference ends.
        stop: why the reference ends.
        ended: how the engine's run ended.
        event: first divergence: number of the event.
        at: first divergence: its time.
        body: first divergence: the body whose next partner differs.
        expected: first divergence: the partner in the reference; null: none.
        got: first divergence: the partner in the engine's run; null: none.
        kind: first divergence: `different`, `missing` or `extra`.
        cause: why it diverged or stopped, by experiment; null: it agrees, or causes were not asked for.
        margin: how close the decision was in the reference: bounds of the distance.
        error: error of the engine's places by then; in a table of run time against error, its largest.
        changed: outcomes that differ from the reference's; null: not asked for, or not settled.
        until: where the engine's run ends before the span does; null: it covers all of it.
        drift: energy gained by the end of the run, as a share of that at its start.
        laws: whether every step keeps the laws: `kept` (null: not determined) and `finding`.
        predicted_low: forecast: first event of the 90 % prediction interval of the divergence.
        predicted: forecast: the event by which the engine is expected to have diverged.
        predicted_high: forecast: last event of the prediction interval.
        by_exponent: forecast: ln(1/eps)/lambda, a time.
        lyapunov: forecast: the largest exponent per unit of time, an estimate.
        lyapunov_low: forecast: lower end of its interval.
        lyapunov_high: forecast: upper end of its interval.
        mark: what a stress map shows: `right`, `wrong`, `unsettled` or another mark.
        closed_form: whether the outcome is that of a closed form; null: there is none.
        right: whether what was asked for is right, and known to be.
        units: counted work of the run, in units of about a microsecond.
        steps: time steps of the run.
        seconds: seconds of the run on the wall; in a table of run time against error, of the processor.
        times: processor time of the run alone over that of the reference made beside it.
        digits: decimal digits that are right at the end; 1000 for all of them; null: it did not get there.
        loops: processor time of the fastest run in the time of a fixed loop of Python's.
        ratio: that over the exact engine's.
        spread: how far the two fastest processes are apart, as a ratio; null of a single one.
        memory: bytes of the peak while it ran, above what its process held before.
        front: whether no other row of the scene is at once as fast and as right (Pareto's front).
        samples: what each run, and each loop in turns with them, took on the wall and of the processor.
        work: what the reference counted, its plan.
        versions: what computed the row.
        note: a remark, such as why it was refused.
    """

    index: int
    scene: str
    engine: str
    verdict: VerdictWord = "undecided"
    digest: str | None = None
    parameters: dict[str, str] | None = None
    settings: dict[str, Any] | None = None
    agreed: int | None = None
    events: int | None = None
    time: float | None = None
    stop: str | None = None
    ended: str | None = None
    event: int | None = None
    at: float | None = None
    body: str | None = None
    expected: str | None = None
    got: str | None = None
    kind: str | None = None
    cause: str | None = None
    margin: list[float] | None = None
    error: float | None = None
    changed: list[str] | None = None
    until: float | None = None
    drift: float | None = None
    laws: dict[str, Any] | None = None
    predicted_low: int | None = None
    predicted: int | None = None
    predicted_high: int | None = None
    by_exponent: float | None = None
    lyapunov: float | None = None
    lyapunov_low: float | None = None
    lyapunov_high: float | None = None
    mark: str | None = None
    closed_form: bool | None = None
    right: bool | None = None
    units: int | None = None
    steps: int | None = None
    seconds: float | None = None
    times: float | None = None
    digits: float | None = None
    loops: float | None = None
    ratio: float | None = None
    spread: float | None = None
    memory: int | None = None
    front: bool | None = None
    samples: dict[str, Any] | None = None
    work: dict[str, Any] | None = None
    versions: str | None = None
    note: str | None = None

    @property
    def lawless(self) -> bool:
        """Whether its steps are known not to keep the laws."""
        return self.laws is not None and self.laws["kept"] is False

    @property
    def agrees(self) -> bool:
        """Whether it agrees, and is not known to break a law."""
        return self.verdict == "agree" and not self.lawless

    @property
    def refused(self) -> str | None:
        """Why it was not run; None if it was."""
        return self.note if self.verdict == "refused" else None

    @property
    def name(self) -> str:
        """Scene and engine, in words."""
        return f"{self.scene}, {self.engine}"

    @property
    def pair(self) -> tuple[str, str]:
        """Scene and engine."""
        return self.scene, self.engine

    def data(self, keys: Sequence[str] | None = None) -> dict[str, Any]:
        """As JSON: all of it, or these keys.

        >>> Row(0, "lee", "double", "agree", agreed=1).data(("engine", "agreed", "event"))
        {'engine': 'double', 'agreed': 1, 'event': None}
        """
        return {key: getattr(self, key) for key in (KEYS if keys is None else keys)}

    def text(self) -> str:
        """As a store keeps it: JSON in one form without what is None, so that equal rows are equal byte by byte.

        >>> Row(0, "lee", "double", "agree", agreed=1).text()
        '{"index":0,"scene":"lee","engine":"double","verdict":"agree","agreed":1}'
        """
        there = {key: value for key in KEYS if (value := getattr(self, key)) is not None}
        return json.dumps(there, ensure_ascii=False, separators=(",", ":"), allow_nan=False)


KEYS = tuple(one.name for one in fields(Row))


class Columns(NamedTuple):
    """Which parts of a row a document has: `Annotated[dict[str, Any], Columns(...)]` is the type of such rows."""

    keys: tuple[str, ...]


@cache
def _hints() -> dict[str, Any]:
    return get_type_hints(Row)


def row_of(data: Any, where: str) -> Row:
    """A row from its JSON, every part of it checked.

    Raises:
        SceneError: naming the part and the remedy.

    >>> row_of({"index": 0, "scene": "lee", "engine": "double", "agreed": True}, "file 'x': row 0")
    Traceback (most recent call last):
      ...
    truebreak.scenarios.errors.SceneError: file 'x': row 0: agreed = true; write the report again
    """
    if not isinstance(data, dict):
        raise SceneError(f"{where} is no object; write the report again")
    for key in ("index", "scene", "engine"):
        if key not in data:
            raise SceneError(f"{where} lacks {key!r}; write the report again")
    for key, value in data.items():
        if key not in _hints():
            raise SceneError(f"{where}: {cut(key)} is no part of a row; write the report again")
        if not fits(value, _hints()[key]):
            raise SceneError(f"{where}: {key} = {cut(value)}; write the report again")
    if data.get("laws") is not None and data["laws"].keys() != {"kept", "finding"}:
        raise SceneError(f"{where}: laws = {cut(data['laws'])}; write the report again")
    if data.get("event") is not None and data.get("body") is None:
        raise SceneError(f"{where}: event {data['event']} has no body; write the report again")
    return Row(**data)


def divergence_of(alignment: Alignment) -> dict[str, Any]:
    """Verdict, events agreed and the first divergence, as a row has them."""
    first = alignment.divergence
    found: dict[str, Any] = {"verdict": alignment.verdict, "agreed": alignment.agreed}
    if first is not None:
        found |= {"event": first.event, "at": first.time, "body": first.body, "expected": first.expected,
                  "got": first.got, "kind": first.kind.value}  # fmt: skip
    return found


def reference_of(run: Trajectory) -> dict[str, Any]:
    """What a row has of its reference."""
    return {"digest": run.scene.digest, "events": len(run.events), "time": float(run.final_time),
            "stop": run.stop.reason.name.lower()}  # fmt: skip


@cache
def versions() -> str:
    """What computes rows."""
    from importlib.metadata import version  # here, since it loads what no worker needs

    return ", ".join(f"{name} {version(name)}" for name in ("truebreak", "python-flint", "pymunk"))


# -- what a row is made of: an engine followed until it diverges, or compared as `truebreak compare` does


def followed(run: Trajectory, engine: Engine, foreseen: int | None = None) -> Followed:
    """An engine run beside a reference until it has diverged; one of events and bits is run over all of it at once:
    that costs less than to begin anew."""
    whole = foreseen is None and engine.step is None and engine.bits is not None
    return follow(run, engine, len(run.events) if whole else foreseen)


def diagnosed(found: Followed, label: str, engine: Engine, laws: Audit | None = None) -> Candidate:
    """An engine that was followed, with the cause and the margin of its divergence, by the experiments of `compare`.

    Args:
        laws: the audit of its run, if that is known; without one no error of its own is told from another law.
    """
    apart, stepped = not_measured(found.study.reference), engine.step is not None
    if laws is None and found.alignment.divergence is not None:
        laws = audit_run(found.run, engine)
    candidate = Candidate(label, found.run, found.alignment, apart, {}, (), stepped=stepped, laws=laws)
    return explained(found.study, candidate, engine, None)


def outcomes_changed(
    found: Followed, run: Trajectory, step: float | None, names: Sequence[str] | None, expected: Any = None
) -> Any:
    """The outcomes that differ, of those named (None: of all), and whether they are those of the whole span.

    Args:
        expected: the outcomes of the reference, if they are known.
    """
    chosen = None if names is None else {name: outcome(name) for name in names}

    def tell(mine: Trajectory) -> Mapping[str, Any]:
        return outcomes_of(mine) if chosen is None else {name: value(mine) for name, value in chosen.items()}

    study, mine = found.study, found.study.longest or run
    return held(found.run, mine, found.alignment, study.span, study.patience(step), tell, expected or tell(run))


def laws_brief(audit: Audit | None) -> dict[str, Any] | None:
    """An audit in a row of many: whether the laws are kept, and what is found, or why it cannot be told.

    >>> from truebreak.compare.audit.audit import Audit
    >>> laws_brief(Audit(None, "no finer step was run")), laws_brief(Audit(True)), laws_brief(None)
    ({'kept': None, 'finding': 'no finer step was run'}, {'kept': True, 'finding': ''}, None)
    """
    return None if audit is None else {"kept": audit.kept, "finding": audit.finding}


def laws_of(run: Trajectory, engine: Engine) -> dict[str, Any] | None:
    """The audit of a run's steps, as a row has it."""
    return laws_brief(audit_run(run, engine))


def unknowing(run: Trajectory) -> bool:
    """Whether a reference stopped not knowing."""
    return run.stop.reason in UNKNOWING


def compared(study: Study, candidate: Candidate, index: int, scene: str) -> Row:
    """The row of an engine that was compared with a reference, as `truebreak compare` reports it."""
    run, unable = candidate.trajectory, candidate.unable
    return Row(
        index,
        scene,
        candidate.engine,
        **(divergence_of(candidate.alignment) | ({"verdict": "refused"} if unable else {})),
        **reference_of(study.reference),
        settings=dict(plain(run.parameters)),
        ended=run.stop.message,
        cause=None if candidate.diagnosis is None else str(candidate.diagnosis),
        changed=list(candidate.changed),
        until=candidate.until,
        drift=None if unable else energy_drift(run),
        laws=laws_brief(candidate.laws),
        seconds=candidate.seconds,
        times=candidate.processor / study.processor if candidate.processor and study.processor else None,
    )


def energy_gained(trajectory: Trajectory) -> float:
    """The energy of the circles at the end of a run less that at its start; under gravity that of the fall counts.

    Of a run that loses none at contacts it is what walls that move brought in.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene, Wall
    >>> energy_gained(ExactEngine().run(Scene([Circle(3, 0, m=2)], [Wall(0, 0, 0, 1, vx=1)]), until=4))
    4.0
    """
    final, gained = trajectory.final, 0.0
    gx, gy = map(float, trajectory.scene.gravity or (0, 0))
    for start in trajectory.scene.circles:
        if not start.fixed:
            end, mass = final[str(start.id)], 1.0 / float(start.inverse_mass)
            gained += mass / 2 * (float(end.vx) ** 2 + float(end.vy) ** 2 - float(start.vx) ** 2 - float(start.vy) ** 2)
            gained -= mass * (gx * (float(end.x) - float(start.x)) + gy * (float(end.y) - float(start.y)))
    return gained


def energy_drift(trajectory: Trajectory) -> float | None:
    """The energy gained by the end of a run, as a share of that at its start.

    None where there is none at all, or the scene's restitution takes some, or walls that move bring some in. Under
    gravity that of the fall counts, and the share is of the larger kinetic energy of the start and the end.

    >>> from truebreak.floating import DoubleEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> energy_drift(DoubleEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 0)]), until=3))
    0.0
    """
    circles = [circle for circle in trajectory.scene.circles if not circle.fixed]
    before = sum((float(c.vx) ** 2 + float(c.vy) ** 2) / float(c.inverse_mass) for c in circles)
    if (
        not trajectory.scene.elastic
        or trajectory.scene.moving_walls
        or (not before and trajectory.scene.gravity is None)
    ):
        return None
    final = trajectory.final
    after = sum(
        (float(final[str(c.id)].vx) ** 2 + float(final[str(c.id)].vy) ** 2) / float(c.inverse_mass) for c in circles
    )
    if trajectory.scene.gravity is None:
        return after / before - 1.0
    gx, gy = map(float, trajectory.scene.gravity)
    ways = ((final[str(c.id)].x, final[str(c.id)].y, c) for c in circles)
    spent = sum(
        2.0 * (gx * (float(x) - float(c.x)) + gy * (float(y) - float(c.y))) / float(c.inverse_mass) for x, y, c in ways
    )
    most = max(before, after)
    return (after - before - spent) / most if most else None
