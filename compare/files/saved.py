"""Runs and comparisons in files: written whole, read back whole, and gone on from."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias, TypedDict

from ...exact.exact_engine import NOT_ITS_LOG, ExactEngine, settlings_of, tape_of
from ...exact.exact_motion import ExactMotion, ExactValue, TimeFormula, ending_of, time_of
from ...exact.replay.contact import AtWall, Entry, can_push
from ...exact.replay.state import Constant
from ...exact.simulation.decider import Limits, Mark, RunLog
from ...exact.simulation.instant import Instant
from ...exact.simulation.loop import Found, Reached, Tape
from ...exact.simulation.policies import Accumulating
from ...scenarios.disk import InSchema, Seal, fits, text_of
from ...scenarios.errors import SceneError
from ...scenarios.files import dump_json, loads_json
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.trajectory import (
    Assumption,
    Contact,
    Event,
    Pocketing,
    Reversal,
    Stop,
    StopReason,
    Tie,
    TieProof,
    Trajectory,
)
from ..writing import check_writable, write_whole
from .codec import (
    Count,
    LinkData,
    NumberData,
    NumberReader,
    NumberWriter,
    StepData,
    TimeData,
    Written,
    link_of,
    links_data,
    links_of,
    set_time_data,
    source_data,
    source_of,
    step_data,
    step_of,
)

if TYPE_CHECKING:
    from ...scenarios.numbers.quantity import QuantityLike, Real
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress

# -- Runs of the exact engine: the scene, the log, and the numbers at hand, so that it is had again whole.


def check_savable(engine: str, scene: Scene, path: str) -> None:
    """Refuses, before a run, an engine whose runs have no log, a scene that no file can hold, and a place that cannot
    be written to.

    Raises:
        SceneError: saying which.
    """
    if engine != "exact":
        raise SceneError(f"--save: only runs of the exact engine are saved with their log, not those of {engine}")
    dump_json(scene)
    check_writable(path)


def save_run(trajectory: Trajectory, path: str | os.PathLike[str]) -> None:
    """Writes a run of the exact engine to a file that `load_run` reads: all of it, or nothing.

    Raises:
        SceneError: for a run of another engine, one that no file can hold, or a place that cannot be written to.
    """
    write_whole(os.fspath(path), saved_run(trajectory))


class EngineData(TypedDict):
    """Settings of the exact engine."""

    max_bits: Annotated[int, InSchema(minimum=1)]
    ties: str
    work: Annotated[int, InSchema(minimum=1)]


NamesData: TypeAlias = Annotated[list[tuple[str, str]], InSchema("names", title="Contacts by id")]

ProofName: TypeAlias = Annotated[str, InSchema(enum=[proof.name for proof in TieProof])]

TieData: TypeAlias = Annotated[tuple[NamesData, ProofName, Count | None], InSchema("tie")]

PlanData: TypeAlias = Annotated[dict[str, Count], InSchema("plan")]


class InstantData(TypedDict, total=False):
    """What was gathered for one instant, but for what is as by default."""

    hits: list[LinkData]
    touches: list[tuple[LinkData, Literal[-1, 0, 1]]]
    arrivals: list[LinkData]
    rims: list[LinkData]
    ties: list[TieData]
    clock: LinkData
    reversal: Literal[True]
    moment: str


class TapeData(TypedDict):
    """What a run leaves for one that goes on from it.

    Attributes:
        limits: a time, a number of events, and whether to the return.
        instants: a contact alone as the contact.
    """

    limits: tuple[str | None, Annotated[int, InSchema(minimum=1)] | None, bool]
    begun: bool
    plan: PlanData
    assumed: Count
    rises: list[tuple[Annotated[int, InSchema(minimum=1)], bool]]
    grazes: list[tuple[Count, list[LinkData]]]
    instants: list[LinkData | InstantData]


class SavedRun(TypedDict):
    """A run: its scene, its log step by step, and the numbers at hand."""

    schema: str
    version: str
    engine: EngineData
    stop: tuple[Annotated[str, InSchema(enum=[reason.name for reason in StopReason])], str]
    scene: dict[str, Any]
    lost: Count
    centred: bool
    plan: PlanData
    notes: list[str]
    assumptions: list[tuple[Count, str, Literal["ASSUMED"], Count | None]]
    end: TimeData
    returned: bool
    set_times: list[tuple[str, Count]]
    ending: str | tuple[Count, LinkData] | tuple[Count, LinkData, LinkData] | None
    reversal: tuple[Count, TimeData] | None
    entries: list[tuple[str, str, TimeData]]
    steps: list[StepData]
    events: list[tuple[TimeData, NamesData, NamesData, list[TieData], bool]]
    tape: TapeData | None
    knots: list[list[tuple[NumberData, NumberData, NumberData, NumberData, NumberData, Count, Count]]]
    roots: list[str]
    digest: Annotated[str, InSchema(pattern="^[0-9a-f]{64}$")]


RUN = Seal("truebreak/run-1", "run", "truebreak run SCENE --save FILE")


def saved_run(trajectory: Trajectory) -> str:
    """A run as the text of a file that `load_run` reads.

    Raises:
        SceneError: for a run of another engine, and for a scene or a limit that no file can hold.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> run = ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)]))
    >>> run_of(saved_run(run)).events[0].time.text()
    '-sqrt(3) + 4'
    """
    motion = trajectory.motion
    if trajectory.engine != "exact" or not isinstance(motion, ExactMotion):
        raise SceneError(f"only runs of the exact engine are saved with their log, not those of {trajectory.engine}")
    return _text(RUN.sealed(_data(trajectory, motion)))


def load_run(path: str | os.PathLike[str]) -> Trajectory:
    """The run in a file that `truebreak run SCENE --save FILE` wrote.

    It is the run that was saved: the same events, states and proofs, and any digit of any number, computed again from
    the log. The digest in the file tells damage, not forgery: load what you, or those whom you trust, have written.

    Raises:
        SceneError: one line, for a file that is not there, is none of these, is damaged or is of another version.
    """
    where = os.fspath(path)
    return run_of(text_of(where, remedy="give the path of a saved run", strict=False), where)


def run_of(text: str, where: str = "the text") -> Trajectory:
    """The run in the text of such a file; `where` names it in errors.

    Raises:
        SceneError: as `load_run`.
    """
    known = RUN.opened(text, where)
    try:
        return _trajectory(known, where)
    except (ArithmeticError, AssertionError, AttributeError, LookupError, RecursionError, TypeError, ValueError):
        raise RUN.damaged(where) from None


def _text(data: dict[str, Any]) -> str:
    """One line a key; of the long lists, one line an entry."""
    lines = []
    for key, value in data.items():
        told = json.dumps(value, separators=(",", ":"))
        if key in ("steps", "events", "knots"):
            told = "[\n" + ",\n".join(json.dumps(row, separators=(",", ":")) for row in value) + "]"
        lines.append(f"{json.dumps(key)}:{told}")
    return "{" + ",\n".join(lines) + "}\n"


# -- writing


def _data(run: Trajectory, motion: ExactMotion) -> dict[str, Any]:
    log, number = motion.log, NumberWriter()

    def time(value: Any) -> Written:
        return _time_data(value, number)

    rest = next((place for place, (_, end) in motion.ends.items() if end is run.final_time), None)
    data: dict[str, Any] = {
        "engine": dict(run.parameters),
        "stop": [run.stop.reason.name, run.stop.message],
        "scene": json.loads(dump_json(run.scene)),
        "lost": log.lost,
        "centred": log.centred,
        "plan": dict(run.plan),
        "notes": list(run.notes),
        "assumptions": [[a.event, a.question, a.proof.name, a.bound] for a in run.assumptions],
        "end": time(run.final_time) if rest is None else list(rest),
        "ending": _ending_data(run.ending),
        "returned": motion.returned,
        "set_times": [[set_time_data(when), part] for when, part in motion.set_times.items()],
        "reversal": None if run.reversal is None else [run.reversal.after, time(run.reversal.time)],
        "entries": [[e.circle, e.pocket, time(e.time)] for e in run.pocketings],
        "steps": [step_data(step) for step in log.steps],
        "events": [
            [time(e.time), e.contacts, e.impulses, [tie_data(t) for t in e.ties], e.coupled] for e in run.events
        ],
        "tape": tape_data(motion.tape),
        "knots": [[[*map(number, knot[:5]), *knot[5:]] for knot in row] for row in motion.knots],
    }
    return json.loads(json.dumps({**data, "roots": number.roots}))


def _time_data(time: Any, number: NumberWriter) -> Written:
    """A set time as text; one of an instant as its number, step, source and the number at hand."""
    if isinstance(time, Quantity):
        return set_time_data(time)
    assert isinstance(time, ExactValue)
    assert isinstance(time.formula, TimeFormula)
    return [time.instant, time.upto, source_data(time.formula.source), number(time.near)]


def _ending_data(ending: Real | None) -> Written:
    """A set time as text; of bounces, how many steps of the log lead to the last that is in it, and whose they are."""
    if ending is None:
        return None
    assert isinstance(ending, ExactValue)
    if isinstance(ending.formula, Constant):
        return set_time_data(ending.formula.value)
    assert isinstance(ending.formula, Accumulating)
    other = ending.formula.other
    return [ending.upto, list(ending.formula.link), *([] if other is None else [list(other)])]


# -- reading


def _check(data: dict[str, Any]) -> None:
    """Refuses what no writer wrote, though its digest is right.

    Raises:
        ValueError: then.
    """
    if not fits({**data, "digest": ""}, SavedRun):  # that it is the digest is known
        raise ValueError("it is not what it is to be")


def _trajectory(data: dict[str, Any], where: str) -> Trajectory:
    _check(data)
    scene = loads_json(json.dumps(data["scene"]), where)
    number = NumberReader(data["roots"])
    log = RunLog(scene, [step_of(step) for step in data["steps"]], data["lost"], data["centred"])

    def time(written: Written) -> Any:
        if isinstance(written, str):
            return Quantity.of(written)
        instant, upto, source, near = written
        return time_of(log, Mark(instant, number(near), upto, source_of(source)))

    rest = data["end"] if isinstance(data["end"], list) and len(data["end"]) == 2 else None
    end = time(["0", 0, "start", "0"]) if rest is not None else time(data["end"])
    knots = [
        [(number(t), number(x), number(y), number(vx), number(vy), upto, last) for t, x, y, vx, vy, upto, last in row]
        for row in data["knots"]
    ]
    ending, last = data["ending"], None
    if isinstance(ending, str):
        ending = Constant(Quantity.of(ending))
    elif ending is not None:
        last, links = ending[0], [link for told in ending[1:] if can_push(link := link_of(told))]
        if len(links) != len(ending) - 1 or not (len(links) == 2 or isinstance(links[0], AtWall)):
            raise ValueError(f"{ending[1:]} is no bounce on a wall, and no hits in turns")
        ending = Accumulating(*links)
    motion = ExactMotion(log, knots, end, {Quantity.of(text): part for text, part in data["set_times"]})
    if rest is not None and (known := motion.ends.get((rest[0], rest[1]))) is not None:
        end = motion.end = known[1]
    motion.returned, motion.tape = data["returned"], tape_of_data(data["tape"])
    reason, message = data["stop"]
    return Trajectory(
        scene=scene,
        engine="exact",
        parameters=data["engine"],
        events=tuple(
            Event(index, time(when), contacts_of(links), contacts_of(impulses), tuple(map(tie_of, ties)), coupled)
            for index, (when, links, impulses, ties, coupled) in enumerate(data["events"])
        ),
        stop=Stop(StopReason[reason], message),
        final_time=end,
        motion=motion,
        reversal=None if data["reversal"] is None else Reversal(data["reversal"][0], time(data["reversal"][1])),
        pocketings=tuple(Pocketing(circle, pocket, time(when)) for circle, pocket, when in data["entries"]),
        assumptions=tuple(
            Assumption(at, asked, TieProof[proof], bits) for at, asked, proof, bits in data["assumptions"]
        ),
        plan=data["plan"],
        notes=tuple(data["notes"]),
        ending=ending_of(log, last, ending),
        settlings=settlings_of(motion)[0],
    )


# -- What a run leaves for one that goes on from it.


def tape_data(tape: Tape | None) -> Written:
    """A tape, up to where all that followed from its instants is known."""
    if tape is None:
        return None
    limits, reached = tape.limits, tape.reached or Reached(0, {}, 0, 0)
    return {
        "limits": [None if limits.until is None else set_time_data(limits.until), limits.events, limits.to_return],
        "begun": tape.reached is not None,
        "plan": reached.plan,
        "assumed": reached.assumed,
        "rises": [list(rise) for rise in tape.rises[: reached.rises]],
        "grazes": [
            [number, links_data(links)]
            for number, links in tape.grazes.items()
            if number // 2 <= reached.instants
        ],
        "instants": [_found_data(found) for found in tape.whole()],
    }  # fmt: skip


def tape_of_data(data: Written) -> Tape | None:
    """What `tape_data` wrote."""
    if data is None:
        return None
    until, events, to_return = data["limits"]
    found = [_found_of(row, 2 * k) for k, row in enumerate(data["instants"], 1)]
    rises = [(bits, centred) for bits, centred in data["rises"]]
    return Tape(
        Limits(None if until is None else Quantity.of(until), events, to_return),
        found,
        Reached(len(found), data["plan"], len(rises), data["assumed"]) if data["begun"] else None,
        rises,
        {number: [link_of(link) for link in links] for number, links in data["grazes"]},
    )


def _found_data(found: Found) -> Written:
    """A contact alone as itself; of anything else what is not as it is by default."""
    if not isinstance(found, Instant):
        return list(found)
    told = {
        "hits": links_data(found.hits),
        "touches": [[list(link), sign] for link, sign in found.touches.items()],
        "arrivals": links_data(found.arrivals),
        "rims": links_data(sorted(found.rims)),
        "ties": [tie_data(tie) for tie in found.ties],
        "clock": None if found.clock is None else list(found.clock),
        "reversal": found.reversal,
        "moment": None if found.moment is None else set_time_data(found.moment),
    }
    return {key: value for key, value in told.items() if value}


def _found_of(data: Written, number: int) -> Found:
    if isinstance(data, list):
        (touch,) = links_of([data])
        return touch
    moment = data.get("moment")
    return Instant(
        number,
        hits=links_of(data.get("hits", ())),
        touches={touch: sign for link, sign in data.get("touches", ()) for touch in links_of([link])},
        arrivals=entries_of(data.get("arrivals", ())),
        rims=frozenset(entries_of(data.get("rims", ()))),
        ties=tuple(map(tie_of, data.get("ties", ()))),
        clock=link_of(data["clock"]) if "clock" in data else None,
        reversal=data.get("reversal", False),
        moment=None if moment is None else Quantity.of(moment),
    )


def tie_data(tie: Tie) -> Written:
    """A tie."""
    return [tie.contacts, tie.proof.name, tie.bound]


def tie_of(data: Written) -> Tie:
    """What `tie_data` wrote."""
    contacts, proof, bound = data
    return Tie(contacts_of(contacts), TieProof[proof], bound)


def contacts_of(data: Any) -> tuple[Contact, ...]:
    """Contacts by id."""
    return tuple(Contact(first, second) for first, second in data)


def entries_of(data: Written) -> tuple[Entry, ...]:
    """Entries into pockets."""
    return tuple(link for link in map(link_of, data) if not can_push(link))


# -- Going on.


@dataclass(frozen=True)
class GoingOn(ExactEngine):
    """The exact engine, with what it has of one run already.

    Attributes:
        earlier: that run.
        where: the file that it is from, as errors name it.
    """

    earlier: Trajectory = field(kw_only=True, repr=False)
    where: str | None = field(kw_only=True, default=None, repr=False)

    @classmethod
    def after(cls, earlier: Trajectory, where: str | None = None, **settings: Any) -> GoingOn:
        """The engine of a run, with some settings in place of its own; None leaves one as it is.

        Raises:
            SceneError: for a run that cannot be gone on with.
        """
        tape_of(earlier)
        given = {**earlier.parameters, **{k: v for k, v in settings.items() if v is not None}}
        return cls(**given, earlier=earlier, where=where)

    @property
    def limits(self) -> tuple[str | None, int | None]:
        """The time and the number of instants at which the run was to end."""
        limits = tape_of(self.earlier)[1].limits
        return None if limits.until is None else limits.until.text(), limits.events

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """As `ExactEngine.resume`."""
        try:
            return self.resume(self.earlier, until=until, events=events, progress=progress)
        except SceneError as error:
            if str(error) != NOT_ITS_LOG or self.where is None:
                raise
            raise SceneError(f"{self.where}: {error}") from None


def resume(
    run: Trajectory | str | os.PathLike[str],
    *,
    until: QuantityLike | None = None,
    events: int | None = None,
    work: int | None = None,
    progress: OnProgress | None = None,
) -> Trajectory:
    """Goes on from a run of the exact engine, or from the file of one, as if it had never ended.

    Args:
        run: the run, or the path of a file that `save_run` wrote.
        until, events: as in `Engine.run`; with neither, the limits that the run had hold on.
        work: what one question may cost now, in place of what it could cost then.
        progress: as in `Engine.run`.

    Raises:
        SceneError: for a file that is no saved run or is damaged, a run that has no log to go on from, and limits
            that are not above zero.

    >>> from truebreak.scenarios import catalogue
    >>> short = ExactEngine().run(catalogue.build("lee"), events=1)
    >>> resume(short, until=3).stop.reason.name
    'HORIZON'
    """
    earlier, where = (run, None) if isinstance(run, Trajectory) else (load_run(run), os.fspath(run))
    engine = GoingOn.after(earlier, where, work=work)
    return engine.run(earlier.scene, until=until, events=events, progress=progress)
