"""One engine on one scene as a row of plain data: what all grids keep, print and compare, and its one JSON form."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cache
from importlib.metadata import version
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Any, Literal, get_args, get_origin, get_type_hints

from ...scenarios.disk import fits
from ...scenarios.errors import SceneError, cut
from ..alignment.align import UNKNOWING
from ..audit.audit import audit_run
from ..chaos.following import Followed, follow
from ..documents.laws import laws_brief
from ..documents.values.amounts import plain
from ..outcomes.matched import held
from ..outcomes.table import outcome, outcomes_of

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.trajectory import Trajectory
    from ..alignment.align import Alignment
    from ..candidate import Candidate
    from ..study import Study

VerdictWord = Literal["agree", "diverged", "unsettled", "undecided", "refused", "failed"]


def told(meaning: str, default: Any = None) -> Any:
    """A field of a row, and what it means: from this the docs and the JSON schema are made."""
    return field(default=default, metadata={"meaning": meaning})


@dataclass(frozen=True, slots=True)
class Row:
    """One engine on one scene. Made of what JSON knows; what does not apply, or is not known, is None.

    Attributes:
        index: place of the scene in its grid, from 0; each further attribute says in its metadata what it means.
    """

    index: int = field(metadata={"meaning": "place of the scene in its grid, from 0"})
    scene: str = field(metadata={"meaning": "the scene, as on the command line"})
    engine: str = field(metadata={"meaning": "the engine and its settings, as asked for, or its label"})
    verdict: VerdictWord = told(
        "as in a comparison; `refused`: the scene or the engine cannot be run; `failed`: the engine ended with an error",
        "undecided",
    )
    digest: str | None = told("digest of the scene; null if it cannot be built")
    parameters: dict[str, str] | None = told("values of what varies over the grid")
    settings: dict[str, Any] | None = told("all parameters of the engine, those it is built with too")
    agreed: int | None = told("events before the first divergence")
    events: int | None = told("events of the reference")
    time: float | None = told("time at which the reference ends")
    stop: str | None = told("why the reference ends")
    ended: str | None = told("how the engine's run ended")
    event: int | None = told("first divergence: number of the event")
    at: float | None = told("first divergence: its time")
    body: str | None = told("first divergence: the body whose next partner differs")
    expected: str | None = told("first divergence: the partner in the reference; null: none")
    got: str | None = told("first divergence: the partner in the engine's run; null: none")
    kind: str | None = told("first divergence: `different`, `missing` or `extra`")
    cause: str | None = told("why it diverged or stopped, by experiment; null: it agrees, or causes were not asked for")
    margin: list[float] | None = told("how close the decision was in the reference: bounds of the distance")
    error: float | None = told("error of the engine's places by then")
    changed: list[str] | None = told("outcomes that differ from the reference's; null: not asked for, or not settled")
    until: float | None = told("where the engine's run ends before the span does; null: it covers all of it")
    drift: float | None = told("energy gained by the end of the run, as a share of that at its start")
    laws: dict[str, Any] | None = told("whether every step keeps the laws: `kept` (null: not determined) and `told`")
    foreseen_low: int | None = told("forecast: first event of the 90 % prediction interval of the divergence")
    foreseen: int | None = told("forecast: the event by which the engine is expected to have diverged")
    foreseen_high: int | None = told("forecast: last event of the prediction interval")
    by_exponent: float | None = told("forecast: ln(1/eps)/lambda, a time")
    lyapunov: float | None = told("forecast: the largest exponent per unit of time, an estimate")
    lyapunov_low: float | None = told("forecast: lower end of its interval")
    lyapunov_high: float | None = told("forecast: upper end of its interval")
    mark: str | None = told("what a stress map shows: `right`, `wrong`, `unsettled`, ...")
    closed_form: bool | None = told("whether the outcome is that of a closed form; null: there is none")
    right: bool | None = told("whether what was asked for is right, and known to be")
    units: int | None = told("counted work of the run, in units of about a microsecond")
    steps: int | None = told("time steps of the run")
    seconds: float | None = told("seconds of the run on the wall")
    times: float | None = told("processor time of the run alone over that of the reference made beside it")
    work: dict[str, Any] | None = told("what the reference counted, its plan")
    versions: str | None = told("what computed the row")
    note: str | None = told("a remark, such as why it was refused")

    @property
    def lawless(self) -> bool:
        """Whether its steps are known not to keep the laws."""
        return self.laws is not None and self.laws["kept"] is False

    @property
    def agrees(self) -> bool:
        """Whether it agrees, and is not known to break a law."""
        return self.verdict == "agree" and not self.lawless

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


@cache
def _shapes() -> dict[str, Any]:
    return {key: _shape(hint) for key, hint in get_type_hints(Row).items()}


def _shape(hint: Any) -> Any:
    """What `fits` takes for a type."""
    if get_origin(hint) is UnionType:
        inner = [_shape(part) for part in get_args(hint) if part is not NoneType]
        return (inner[0], None)
    if get_origin(hint) is Literal:
        return str
    if get_origin(hint) is list:
        return [_shape(get_args(hint)[0])]
    if get_origin(hint) is dict:
        return {str: _shape(get_args(hint)[1])}
    return frozenset({int, float}) if hint is float else hint


def row_of(data: Any, where: str) -> Row:
    """A row from its JSON, every part of it checked.

    Raises:
        SceneError: naming the part and the remedy.

    >>> row_of({"index": 0, "scene": "lee", "engine": "double", "agreed": True}, "file 'x': row 0")
    Traceback (most recent call last):
      ...
    truebreak.scenarios.errors.SceneError: file 'x': row 0: agreed = True; write the report again
    """
    if not isinstance(data, dict):
        raise SceneError(f"{where} is no object; write the report again")
    for key in ("index", "scene", "engine", "verdict"):
        if key not in data and key != "verdict":
            raise SceneError(f"{where} lacks {key!r}; write the report again")
    for key, value in data.items():
        shape = _shapes().get(key)
        if shape is None:
            raise SceneError(f"{where}: {cut(key)} is no part of a row; write the report again")
        optional = isinstance(shape, tuple)
        if not (optional and value is None) and not fits(value, shape[0] if optional else shape):
            raise SceneError(f"{where}: {key} = {cut(value)}; write the report again")
    if data.get("verdict", "undecided") not in get_args(VerdictWord):
        raise SceneError(f"{where}: verdict = {cut(data['verdict'])}; write the report again")
    if data.get("laws") is not None and data["laws"].keys() != {"kept", "told"}:
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


def versions() -> str:
    """What computes rows."""
    return ", ".join(f"{name} {version(name)}" for name in ("truebreak", "python-flint", "pymunk"))


# -- what a row is made of: an engine followed until it diverges, or compared as `truebreak compare` does


def followed(run: Trajectory, engine: Engine, foreseen: int | None = None) -> Followed:
    """An engine run beside a reference until it has diverged; one of events and bits is run over all of it at once:
    that costs less than to begin anew."""
    whole = foreseen is None and engine.step is None and engine.bits is not None
    return follow(run, engine, len(run.events) if whole else foreseen)


def outcomes_changed(found: Followed, run: Trajectory, step: float | None, names: Sequence[str] | None) -> Any:
    """The outcomes that differ, of those named (None: of all), and whether they are those of the whole span."""
    chosen = None if names is None else {name: outcome(name) for name in names}

    def tell(mine: Trajectory) -> Mapping[str, Any]:
        return outcomes_of(mine) if chosen is None else {name: value(mine) for name, value in chosen.items()}

    study, mine = found.study, found.study.longest or run
    return held(found.run, mine, found.alignment, study.span, study.patience(step), tell, tell(run))


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


def energy_drift(trajectory: Trajectory) -> float | None:
    """The energy gained by the end of a run, as a share of that at its start; None where there is none at all.

    >>> from truebreak.floating import DoubleEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> energy_drift(DoubleEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 0)]), until=3))
    0.0
    """
    circles = [circle for circle in trajectory.scene.circles if not circle.fixed]
    before = sum((float(c.vx) ** 2 + float(c.vy) ** 2) / float(c.inverse_mass) for c in circles)
    if not before:
        return None
    final = trajectory.final
    after = sum(
        (float(final[str(c.id)].vx) ** 2 + float(final[str(c.id)].vy) ** 2) / float(c.inverse_mass) for c in circles
    )
    return after / before - 1.0
