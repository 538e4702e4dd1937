"""Pairs of logs of several engines of which it is known what came between them.

`python docs/studies/desync/trials_page.py` has them compared.
"""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import desync_worlds as worlds
from desync_worlds import NONE, Fault, Lines, Steps, Trial

from truebreak.compare.logdiff.log_format import FORMAT
from truebreak.compare.logdiff.verdict import Finding

I, H, G, C, S, N = Finding  # noqa: E741
TRUE_NAMES = {
    "none": {I}, "ulp": {G}, "moved": {S}, "dt": {S}, "gravity": {S}, "contact": {C}, "warm": {C}, "input": {C},
    "mass": {C}, "garbage": {C}, "nan": {C}, "push": {C}, "threads": {I, H, G, C}, "order": {I, H, G, C},
}  # fmt: skip
"""What is right to say of each fault; "not determined" is never wrong. A mass that differs from the start may be called
so, too; bodies in another order, and threads, change what a solver does that has not converged, or only the rounding,
or nothing."""


Style = Callable[[Steps], Lines]


def full(told: Steps) -> Lines:
    """Everything, every step."""
    return [{"log": FORMAT, "fields": told.fields}, *told.records]


def every(n: int) -> Style:
    """Contacts and states of every n-th step."""

    def style(told: Steps) -> Lines:
        return [{"log": FORMAT, "fields": told.fields}, *(r for r in told.records if r["step"] % n == 0)]

    return style


def states_only(told: Steps) -> Lines:
    """States of every step by their times: neither steps nor contacts."""
    rows = [{k: v for k, v in r.items() if k in ("time", "states")} for r in told.records]
    return [{"log": FORMAT, "fields": told.fields}, *rows]


def touching(told: Steps) -> Lines:
    """Contacts, with the states of what is in contact, and all states every 64th step."""
    lines: Lines = [{"log": FORMAT, "fields": told.fields}]
    for r in told.records:
        bodies = {i for p in r["contacts"] for i in p}
        whole = r["step"] % 64 == 0
        states = {i: row for i, row in r["states"].items() if whole or i in bodies}
        if states:
            lines.append({**r, "states": states})
    return lines


def contacts_only(told: Steps) -> Lines:
    """Contacts by steps, without states."""
    return [{k: v for k, v in r.items() if k != "states"} for r in told.records]


def hashes(told: Steps) -> Lines:
    """A hash of every step, and nothing else."""
    return [{"step": r["step"], "hash": _hash(r)} for r in told.records]


def hashes_and_states(told: Steps) -> Lines:
    """A hash of every step, and all states every 16th."""
    return [
        {"step": r["step"], "hash": _hash(r), **({"states": r["states"]} if r["step"] % 16 == 0 else {})}
        for r in told.records
    ]


def digits(n: int) -> Style:
    """Everything, to n digits."""

    def style(told: Steps) -> Lines:
        rows = copy.deepcopy(told.records)
        for r in rows:
            r["states"] = {i: [float(f"{v:.{n}g}") for v in row] for i, row in r["states"].items()}
        return [{"log": FORMAT, "fields": told.fields}, *rows]

    return style


def _hash(record: dict[str, Any]) -> str:
    import hashlib

    return hashlib.blake2b(json.dumps(record["states"]).encode(), digest_size=8).hexdigest()


@cache
def _steps(engine: str, kind: str, seed: int, count: int, steps: int, fault: Fault, inputs: bool) -> Steps:
    return worlds.run(worlds.ENGINES[engine], seed, count, kind, steps, fault, inputs=inputs)


def stepped(
    engine: str, kind: str, seed: int, fault: Fault, style: Style = full, *, count: int = 16, steps: int = 240,
    true: set[Finding] | None = None, what: str | None = None,
) -> Trial:  # fmt: skip
    """A pair of an engine of steps."""
    inputs = fault.kind == "input"

    def make() -> tuple[Lines, Lines]:
        one = _steps(engine, kind, seed, count, steps, NONE, inputs)
        return style(one), style(_steps(engine, kind, seed, count, steps, fault, inputs))

    named = FAULTS[fault.kind].format(f=fault)
    doc = (style.__doc__ or f"{style.__qualname__.partition('.')[0]}").partition(".")[0].lower()
    shown = "" if style is full else f"; log: {doc}"
    return Trial(
        f"{engine}, {kind} {seed}", (what or named) + shown, frozenset(true or TRUE_NAMES[fault.kind]), make,
        fault.at if fault.kind in ("garbage", "nan", "push", "warm") else None,
    )  # fmt: skip


FAULTS = {
    "none": "nothing: run twice",
    "ulp": "one start moved by one ulp",
    "moved": "one start moved by {f.size:g}",
    "order": "bodies added in another order",
    "dt": "time step times {f.size:g}",
    "contact": "a contact lost, from step {f.at}",
    "warm": "the solver's memory lost at step {f.at}",
    "input": "an input dropped, from step {f.at}",
    "mass": "a mass {f.size:+.0%} from step {f.at}",
    "garbage": "{f.size:g} added to a velocity at step {f.at}",
    "push": "{f.size:g} added to a velocity at step {f.at}",
    "nan": "a velocity that is no number, from step {f.at}",
    "gravity": "gravity times 1 + {f.size:g}",
    "threads": "several threads",
}


def edited(engine: str, kind: str, seed: int, what: str, true: set[Finding], edit: Callable[[Lines], Lines],
           style: Style = full, fault: Fault = NONE, at: int | None = None) -> Trial:  # fmt: skip
    """A pair of which the second log was changed after the run."""

    def make() -> tuple[Lines, Lines]:
        one = _steps(engine, kind, seed, 16, 240, NONE, False)
        return style(one), edit(copy.deepcopy(style(_steps(engine, kind, seed, 16, 240, fault, False))))

    return Trial(f"{engine}, {kind} {seed}", what, frozenset(true), make, at)


def _renamed(lines: Lines) -> Lines:
    """Other ids."""
    for line in lines:
        if "states" in line:
            line["states"] = {f"entity-{i}": row for i, row in line["states"].items()}
        if "contacts" in line:
            line["contacts"] = [[f"entity-{i}" for i in p] for p in line["contacts"]]
    return lines


def _permuted(lines: Lines) -> Lines:
    """Ids handed out in another order."""
    ids = sorted({i for line in lines for i in line.get("states", ())})
    other = dict(zip(ids, ids[3:] + ids[:3], strict=True))
    for line in lines:
        if "states" in line:
            line["states"] = {other[i]: row for i, row in line["states"].items()}
        if "contacts" in line:
            line["contacts"] = [[other.get(i, i) for i in p] for p in line["contacts"]]
    return lines


def _later(lines: Lines) -> Lines:
    """A clock that was started 100 earlier."""
    return [{**line, "time": line["time"] + 100.0} if "time" in line else line for line in lines]


def _restarted(lines: Lines) -> Lines:
    """A clock, and a count of steps, that begin anew at step 120."""
    return [
        {**line, "step": line["step"] - 120, "time": line["time"] - 2.0} if line.get("step", 0) >= 120 else line
        for line in lines
    ]


def _swapped(lines: Lines) -> Lines:
    """Contacts of a step in another order."""
    rng = random.Random(5)
    for line in lines:
        if len(line.get("contacts", ())) > 1:
            rng.shuffle(line["contacts"])
    return lines


def _without(n: int) -> Callable[[Lines], Lines]:
    return lambda lines: lines[:n] + lines[n + 1 :]


def _twice(n: int) -> Callable[[Lines], Lines]:
    return lambda lines: lines[: n + 1] + lines[n:]


def _scene(name: str, engine: str, what: str, true: set[Finding], change: Callable[[Any], Any] | None = None, *,
           other: str | None = None, events: int = 150, states: bool = True,
           edit: Callable[[Lines], Lines] | None = None) -> Trial:  # fmt: skip
    """A pair of one of truebreak's own engines: logs of events."""

    def make() -> tuple[Lines, Lines]:
        one = list(worlds.scene_run(name, engine, None, events))
        two = list(worlds.scene_run(name, other or engine, change, events))
        if edit is not None:
            two = edit(two)
        if not states:
            one, two = ([{k: v for k, v in r.items() if k != "states"} for r in rows] for rows in (one, two))
        return one, two

    shown = "" if states else "; log: events without states"
    return Trial(f"{engine}, {name}", what + shown, frozenset(true), make)


def _moved(place: int, by: Any = None, **keys: Any) -> Callable[[Any], Any]:
    """Changes one circle of a scene: x by so much, or by an ulp of its nearest double."""

    def change(scene: Any) -> Any:
        from fractions import Fraction
        from math import nextafter

        circles = list(scene.circles)
        c = circles[place]
        if by is not None:
            x = Fraction(float(c.x))
            moved = Fraction(nextafter(float(c.x), 1e9)) if by == "ulp" else x + Fraction(by)
            circles[place] = replace(c, x=str(moved))
        else:
            circles[place] = replace(c, **keys)
        return scene.with_changes(circles=circles)

    return change


def _shuffled(scene: Any) -> Any:
    """The same circles in another order; ids go with them."""
    circles = list(scene.circles)
    random.Random(3).shuffle(circles)
    return scene.with_changes(circles=circles)


def _interleaved(lines: Lines) -> Lines:
    """Neighbouring events that share no body change places."""
    found, k = list(lines), 0
    while k + 1 < len(found):
        bodies = [{i for p in r["contacts"] for i in p} for r in found[k : k + 2]]
        if not bodies[0] & bodies[1]:
            found[k], found[k + 1] = found[k + 1], found[k]
            k += 2
        else:
            k += 1
    return found


PLAIN = ("-O0", "-ffp-contract=off")
FUSED = (("-O3", "-ffp-contract=off"), ("-O3", "-mfma", "-ffp-contract=fast"), ("-O0", "-mfma", "-ffp-contract=fast"),
         ("-O3", "-ffast-math"))  # fmt: skip


def _c(flags: Sequence[str], real: str, kind: str, seed: int) -> Trial:
    what = f"built with {' '.join(flags)} instead of {' '.join(PLAIN)}"

    def make() -> tuple[Lines, Lines]:
        one = worlds.c_run((*PLAIN, f"-DREAL={real}"), kind, seed, 600)
        return full(one), full(worlds.c_run((*flags, f"-DREAL={real}"), kind, seed, 600))

    return Trial(f"C, {real}, {kind} {seed}", what, frozenset({I, G}), make)


TUNED, HELD_OUT = 0, 100
"""Where the seeds of the two sets of trials begin."""


def trials(base: int = 0) -> Iterator[Trial]:
    """All pairs, of seeds that begin at one; where a fault strikes, and how hard, is drawn by that.

    The thresholds were chosen with the pairs of `TUNED` before the eyes; those of `HELD_OUT` were made after.
    """
    rng = random.Random(base)
    for engine in ("pymunk", "box2d", "rapier", "mujoco"):
        single = engine in ("box2d", "rapier")

        def strike(kind: str, least: float = 0.2, most: float = 1.5) -> Fault:
            return Fault(
                kind, rng.randrange(50, 150), rng.randrange(16), rng.choice((-1, 1)) * rng.uniform(least, most)
            )

        for kind, seed in (("gas", base + 1), ("pile", base + 2)):
            yield stepped(engine, kind, seed, NONE)
            yield stepped(engine, kind, seed, Fault("ulp", 0, rng.randrange(16)))
            yield stepped(engine, kind, seed, Fault("moved", 0, rng.randrange(16), 1e-3 if single else 1e-6))
            yield stepped(engine, kind, seed, Fault("order"))
            yield stepped(engine, kind, seed, Fault("dt", 0, 0, 0.5))
            yield stepped(engine, kind, seed, strike("garbage"))
            yield stepped(engine, kind, seed, Fault("input", rng.randrange(50, 150)))
            yield stepped(engine, kind, seed, replace(strike("nan"), size=0.0))
            yield stepped(engine, kind, seed, Fault("mass", 0, rng.randrange(16), 0.01), true={C, S})
        yield stepped(engine, "pile", base + 3, Fault("warm", rng.randrange(90, 160)))
        yield stepped(engine, "pile", base + 4, Fault("gravity", 0, 0, 1e-3))
        yield stepped(engine, "pile", base + 5, Fault("ulp", 0, rng.randrange(16)), every(16))
        yield stepped(engine, "pile", base + 5, strike("garbage"), every(16))
        yield stepped(engine, "gas", base + 6, Fault("ulp", 0, rng.randrange(16)), touching)
        yield stepped(engine, "gas", base + 6, strike("garbage"), touching)
        yield stepped(engine, "pile", base + 7, Fault("ulp", 0, rng.randrange(16)), hashes)
        yield stepped(engine, "pile", base + 7, strike("garbage"), hashes_and_states)
        yield stepped(engine, "pile", base + 8, NONE, hashes)
        yield stepped(engine, "gas", base + 9, Fault("ulp", 0, rng.randrange(16)), states_only)
        yield stepped(engine, "gas", base + 9, strike("garbage"), states_only)
        yield edited(engine, "pile", base + 10, "ids renamed", {I}, _renamed)
        yield edited(engine, "pile", base + 10, "ids handed out in another order", {I}, _permuted)
        yield edited(engine, "pile", base + 11, "log cut short at step 150", set(), lambda lines: lines[:152])
        yield edited(engine, "pile", base + 11, "clock started 100 earlier", {I}, _later)
        yield edited(engine, "pile", base + 12, "contacts of a step in another order", {H}, _swapped)
        yield edited(engine, "pile", base + 12, "clock and count begin anew at step 120", {I}, _restarted)
        yield edited(engine, "gas", base + 13, "a line lost from the log", set(), _without(40))
        yield edited(engine, "gas", base + 13, "a line twice in the log", set(), _twice(40))
        yield stepped(engine, "pile", base + 14, Fault("threads"))
    for engine in ("pymunk", "box2d"):
        for seed in (base + 15, base + 16):
            yield stepped(engine, "pile", seed, Fault("contact", rng.randrange(50, 100)))
            yield stepped(engine, "gas", seed, Fault("contact", rng.randrange(50, 100)), touching)
        yield stepped(engine, "pile", base + 17, Fault("mass", rng.randrange(80, 120), rng.randrange(16), 0.1))
        yield stepped(engine, "pile", base + 18, strike("garbage"), contacts_only)
        yield stepped(engine, "pile", base + 19, Fault("ulp", 0, rng.randrange(16)), digits(6))
        yield stepped(engine, "pile", base + 19, strike("garbage"), digits(6))
    yield stepped("pymunk", "gas", base + 20, strike("push", 1e-7, 1e-6))
    yield stepped("pymunk", "pile", base + 21, Fault("ulp", 0, 5), count=40, steps=400)
    yield stepped("mujoco", "gas", base + 22, strike("push", 1e-7, 1e-6))
    if worlds.compiler():
        for real in ("double", "float"):
            for kind in ("gas", "pile"):
                for seed in (base + 1, base + 2):
                    for flags in FUSED:
                        yield _c(flags, real, kind, seed)
    for name in (f"gas:n=10,seed={1 + base}", f"gas:n=10,seed={2 + base}", f"gas:n=20,seed={3 + base}"):
        yield _scene(name, "double", "nothing: run twice", {I})
        yield _scene(name, "double", "one start moved by one ulp", {G}, _moved(2, "ulp"))
        yield _scene(name, "double", "one start moved by one ulp", {G}, _moved(2, "ulp"), states=False)
        yield _scene(name, "double", "one start moved by 1/1000", {S}, _moved(2, "1/1000"))
        yield _scene(name, "double", "circles in another order", {I, H, G}, _shuffled)
        yield _scene(name, "double", "independent events in another order", {H, I}, edit=_interleaved)
        yield _scene(name, "double", "a mass of 11/10", {C, S}, _moved(3, m="11/10"))
        yield _scene(name, "double", "a line lost from the log", set(), edit=_without(30))
        yield _scene(name, "double", "a line twice in the log", set(), edit=_twice(30))
        yield _scene(name, "double", "log cut short", set(), edit=lambda lines: lines[:100])
        yield _scene(name, "double", "another engine: quad", {G, I}, other="quad")
        yield _scene(name, "quad", "one start moved by one ulp", {G}, _moved(2, "ulp"))
