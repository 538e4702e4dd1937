"""A run of the exact engine as a file: the scene, the log, and the numbers at hand, so that it is had again whole."""

from __future__ import annotations

import json
import os
from typing import Any

from ...exact.exact_motion import ExactMotion, ExactValue, RunLog, TimeFormula, time_of
from ...exact.simulation.decider import Mark
from ...scenarios.disk import Seal, fits, text_of
from ...scenarios.errors import SceneError
from ...scenarios.files import dump_json, loads_json
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.trajectory import Assumption, Event, Pocketing, Reversal, Stop, StopReason, TieProof, Trajectory
from .run_numbers import (
    NumberReader,
    NumberWriter,
    Written,
    set_time_data,
    source_data,
    source_of,
    step_data,
    step_of,
)
from .run_tape import contacts_of, tape_data, tape_of_data, tie_data, tie_of

SEAL = Seal("truebreak/run-1", "run", "truebreak run SCENE --save FILE")


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
    return _text(SEAL.sealed(_data(trajectory, motion)))


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
    known = SEAL.opened(text, where)
    try:
        return _trajectory(known, where)
    except (ArithmeticError, AssertionError, AttributeError, LookupError, RecursionError, TypeError, ValueError):
        raise SEAL.damaged(where) from None


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

    data: dict[str, Any] = {
        "engine": dict(run.parameters),
        "stop": [run.stop.reason.name, run.stop.message],
        "scene": json.loads(dump_json(run.scene)),
        "lost": log.lost,
        "centred": log.centred,
        "plan": dict(run.plan),
        "notes": list(run.notes),
        "assumptions": [[a.event, a.question, a.proof.name, a.bound] for a in run.assumptions],
        "end": time(run.final_time),
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


# -- reading

LINK = [Any]
"""A contact: `link_of` looks at its parts."""

TIE = ([(str, str)], str, frozenset({int, None}))

SHAPE = {
    "engine": {"max_bits": int, "ties": str, "work": int},
    "stop": (str, str),
    "scene": dict,
    "lost": int,
    "centred": bool,
    "plan": {str: int},
    "notes": [str],
    "assumptions": [(int, str, str, int)],
    "returned": bool,
    "set_times": [(str, int)],
    "entries": [(str, str, Any)],
    "steps": [list],
    "events": [(Any, [(str, str)], [(str, str)], [TIE], bool)],
    "knots": [[(Any, Any, Any, Any, Any, int, int)]],
}
"""What a file holds, but for its numbers, times, reversal and tape, which have readers that refuse what is none."""

TAPE = {
    "limits": (frozenset({str, None}), frozenset({int, None}), bool),
    "begun": bool,
    "plan": {str: int},
    "assumed": int,
    "rises": [(int, bool)],
    "grazes": [(int, [LINK])],
    "instants": [frozenset({list, dict})],
}


def _check(data: dict[str, Any]) -> None:
    """Refuses what no writer wrote, though its digest is right.

    Raises:
        ValueError: then.
    """
    for key, shape in SHAPE.items():
        if not fits(data[key], shape):
            raise ValueError(f"{key} is not what it is to be")
    if data["tape"] is not None and not fits(data["tape"], TAPE):
        raise ValueError("the tape is not what it is to be")
    if data["reversal"] is not None and not fits(data["reversal"], (int, Any)):
        raise ValueError("the reversal is not what it is to be")


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

    end = time(data["end"])
    knots = [
        [(number(t), number(x), number(y), number(vx), number(vy), upto, last) for t, x, y, vx, vy, upto, last in row]
        for row in data["knots"]
    ]
    motion = ExactMotion(log, knots, end, {Quantity.of(text): part for text, part in data["set_times"]})
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
    )
