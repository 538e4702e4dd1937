"""Pairs of logs by another author than the thresholds': what came between them, and what may be said of that.

They were written from docs/desync.md and docs/log-format.md alone, before the code that decides was looked at. The
worlds are a small solver in Python, an event-driven gas, pymunk, and a chain of pendulums in C.
"""

from __future__ import annotations

import heapq
import itertools
import json
import math
import random
import shutil
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

from desync_sketch import (
    HEAD,
    Hook,
    Log,
    absent,
    bare,
    csv_of,
    dice,
    each,
    first,
    floats,
    forget,
    hash_lines,
    hash_of,
    hashes_with,
    heavier,
    hexed,
    jitter,
    jumps,
    lose,
    packed,
    place,
    plain,
    played,
    renamed,
    rounded,
    rows,
    shove,
    shown,
    shuffled,
    sleeps,
    sloppy,
    stale,
    styled,
    swapped,
    through_text,
    turned,
    ulp,
    untimed,
    value,
    when,
    woken,
)
from desync_worlds import Lines, Trial, chain

from truebreak.compare.logdiff.verdict import Finding

I, H, G, C, S, N = Finding  # noqa: E741


def hooked(what: str, right: set[Finding], hook: Hook | None = None, *, at: int | None = None, kind: str = "pile",
           dims: int = 2, seed: int = 1, bits: int = 53, cut: Callable[[Lines], Log] = lambda lines: lines,
           **settings: Any) -> Trial:  # fmt: skip
    """A run, and one with a hook or other settings, both logged as `cut` says."""

    def make() -> tuple[Log, Log]:
        other = played(kind, dims=dims, seed=seed, bits=bits, hook=hook, **settings)
        return cut(plain(kind, dims, seed, bits)), cut(other)

    return Trial(f"{kind} {seed}, {dims}D, {bits} bits", what, frozenset(right), make, at)


def rewritten(what: str, right: set[Finding], edit: Callable[[Lines], Log], *, at: int | None = None,
              kind: str = "pile", dims: int = 2, seed: int = 1, bits: int = 53,
              cut: Callable[[Lines], Log] = lambda lines: lines, suffix: str = ".jsonl") -> Trial:  # fmt: skip
    """One run logged in two ways."""

    def make() -> tuple[Log, Log]:
        return cut(plain(kind, dims, seed, bits)), edit(plain(kind, dims, seed, bits))

    return Trial(f"{kind} {seed}, {dims}D, {bits} bits", what, frozenset(right), make, at, suffix=suffix)


def both(what: str, right: set[Finding], cut: Callable[[Lines], Log], hook: Hook | None = None, *,
         at: int | None = None, kind: str = "pile", seed: int = 1, **settings: Any) -> Trial:  # fmt: skip
    """A run, logged in full, and one with a hook or other settings, logged as `cut` says."""
    return Trial(f"{kind} {seed}", what, frozenset(right), lambda: (
        plain(kind, 2, seed), cut(played(kind, seed=seed, hook=hook, **settings))), at)  # fmt: skip


def jumped(
    what: str, right: set[Finding], hook: Hook, at: int | None, hidden: bool = False, kind: str = "pile"
) -> Trial:
    """A run with inputs, and one with others."""
    plain_hook = jumps(hidden=hidden)
    return Trial(kind, what, frozenset(right), lambda: (played(kind, hook=plain_hook), played(kind, hook=hook)), at)


def stepped_pairs() -> Iterator[Trial]:
    """Pairs of the solver by steps."""
    # the kinds that everybody thinks of
    for kind, dims, seed, bits in (("gas", 2, 1, 53), ("pile", 2, 2, 53), ("gas", 3, 3, 53), ("pile", 3, 4, 24),
                                   ("gas", 2, 5, 24)):  # fmt: skip
        world = {"kind": kind, "dims": dims, "seed": seed, "bits": bits}
        yield hooked("nothing: run twice", {I}, **world)
        yield hooked("one start moved by an ulp", {G}, when(0, ulp(2)), at=0, **world)
        yield hooked("one start moved by 0.003", {S}, when(0, place(2, 0.003)), at=0, **world)
        yield hooked("another step", {S}, dt=1 / 50, **world)
        yield hooked("a velocity shoved at step 47", {C}, when(47, shove(1, -0.7)), at=47, **world)
        yield hooked("a velocity is NaN from step 47 on", {C}, when(47, value(1, math.nan)), at=47, **world)
    for seed in (6, 7):
        yield hooked("a lost contact", {C}, lose(30), seed=seed)
        yield hooked("a lost contact", {C}, lose(30), seed=seed, dims=3)
        yield hooked("a lost contact", {C}, lose(30), seed=seed, kind="gas")
        yield hooked("a stale warm start at step 60", {C}, when(60, stale), seed=seed, at=60)
        yield hooked("a warm start lost at step 60", {C}, when(60, forget), seed=seed, at=60)
        yield hooked("solved in another order", {I, H, G, C}, seed=seed, order=3)
        yield hooked("solved in another order in each step, as by threads", {I, H, G, C}, sloppy, seed=seed)
        yield hooked("a mass times 1.05 from the start", {C, S}, when(0, heavier(0, 1.05)), seed=seed)
        yield hooked("a mass times 1.05 from step 40", {C}, when(40, heavier(0, 1.05)), seed=seed)
    yield jumped("an input dropped", {C}, jumps(70), 70)
    yield jumped("an input a step late", {C}, jumps(late=70), 70)
    yield jumped("an input that acts twice", {C}, jumps(twice=70), 70)
    yield jumped("the first input dropped", {C}, jumps(10), 10)
    yield jumped("an input dropped, not logged", {C}, jumps(70, hidden=True), 70, hidden=True)
    yield jumped("an input dropped, in a gas", {C}, jumps(55), 55, kind="gas")
    yield Trial("pile", "an input that is logged otherwise and does the same", frozenset({C}), lambda: (
        played(hook=jumps()),
        [{**x, "input": {"jump": "nobody"}} if x.get("step") == 70 else x for x in played(hook=jumps())]))  # fmt: skip
    yield rewritten("the log cut short at step 80", set(), lambda lines: lines[:82])
    yield rewritten("the log's last line torn", set(), lambda lines: "".join(json.dumps(x) + "\n" for x in lines)[:-40])
    yield rewritten("the clock begins at 1000", {I}, each(lambda line: {**line, "time": line["time"] + 1000}))
    yield rewritten("clock and count begin anew at step 50", {I},
                    each(lambda line: line if line["step"] < 50 else {
                        **line, "step": line["step"] - 50, "time": line["time"] - 50 / 60}))  # fmt: skip
    # settings
    yield hooked("one iteration more", {I, G, C, S}, iterations=7, seed=8)
    yield hooked("restitution 0.31 for 0.3", {C, S}, bounce=0.31, seed=8)
    yield hooked("gravity -9.81 for -9.8", {S}, pull=-9.81, seed=8, at=1)
    yield hooked("a wind of 1e-7", {S, C}, wind=1e-7, seed=8, at=1)
    yield hooked("a wind of 1e-7 from step 40 on", {C}, when(40, lambda w: setattr(w, "wind", 1e-7)), seed=8, at=40)
    yield hooked(
        "an ulp in each step, as of another libm", {G}, when(0, lambda w: setattr(w, "ulps", True)), seed=8, at=1
    )
    yield hooked("a step of 1/60 + 1 ulp", {G}, dt=math.nextafter(1 / 60, 1), seed=8)
    yield hooked("a body starts with a spin that nobody set", {S, C}, when(0, value(3, 7.25e11)), seed=8, at=0)
    yield hooked("a body more", {S, C}, seed=8, count=8)
    yield hooked("the roll of dice of another seed, logged", {C}, dice(2, True), seed=8)
    yield Trial("pile", "dice of another seed, logged", frozenset({C}), lambda: (
        played(hook=dice(1, True)), played(hook=dice(2, True))), 20)  # fmt: skip
    yield Trial("gas", "dice of another seed, not logged", frozenset({C}), lambda: (
        played("gas", hook=dice(1, False)), played("gas", hook=dice(2, False))), 20)  # fmt: skip
    yield Trial("gas", "an ulp at the start, and dice of another seed", frozenset({C}), lambda: (
        played("gas", hook=dice(1, True)),
        played("gas", hook=first(ulp(2), dice(2, True)))))  # fmt: skip
    # time steps
    yield hooked("steps that vary by 1 %", {S}, jitter(0.01), at=1)
    yield hooked("steps that vary by 1 % from step 60 on", {C}, jitter(0.01, 60), at=60)
    yield hooked("steps that vary by an ulp", {G}, jitter(2e-16))
    yield hooked("steps that vary by 1e-9 of a clock's ticks", {S, C}, jitter(1e-9), at=1)
    rng = random.Random(3)
    yield rewritten("clock readings that vary, of the same steps", {I},
                    each(lambda line: {**line, "time": line["time"] + rng.uniform(0, 0.004)}))  # fmt: skip
    # a game saved as text, and loaded
    yield hooked("saved with 17 digits and loaded at step 50", {I}, when(50, through_text("%.17g")))
    yield hooked("saved with 15 digits and loaded at step 50", {G}, when(50, through_text("%.15g")))
    yield hooked("saved with 6 digits and loaded at step 50", {C}, when(50, through_text("%.6g")), at=50)
    yield hooked("saved in floats and loaded at step 50", {C, G}, when(50, through_text("single")))
    yield hooked(
        "saved with 6 digits and loaded at step 50, in 3D floats", {C}, when(50, through_text("%.6f")), dims=3, bits=24
    )
    # digits of the log
    yield rewritten("17 digits in one log, the shortest in the other", {I}, shown("%.17g"))
    yield rewritten("15 digits in one log", set(), shown("%.15g"))
    yield rewritten("6 decimals in one log", set(), shown("%.6f"))
    yield rewritten("9 digits of floats in one log, all of the double in the other", {I, G}, shown("%.9g"), bits=24)
    yield rewritten("6 digits of floats in one log", set(), shown("%.6g"), bits=24)
    yield hooked(
        "an ulp at the start, both logged with 6 digits", {G, I}, when(0, ulp(2)), kind="gas", seed=9, cut=shown("%.6g")
    )
    yield hooked(
        "an ulp at the start, both logged with 15 digits",
        {G, I},
        when(0, ulp(2)),
        kind="gas",
        seed=9,
        cut=shown("%.15g"),
    )
    yield hooked(
        "a shove at step 47, both logged with 6 digits", {C}, when(47, shove(1, 0.8)), seed=9, at=47, cut=shown("%.6g")
    )
    yield hooked(
        "a start moved by 0.01, both logged with 3 decimals", {S}, when(0, place(1, 0.01)), seed=9, cut=shown("%.3f")
    )
    # ids
    yield rewritten("ids of other names", {I}, renamed(lambda i: f"Actor_{i}" if i[0] == "n" else i))
    yield rewritten(
        "ids renumbered",
        {I},
        renamed(lambda i: f"n{(int(i[1:]) * 3 + 2) % 7}" if i[0] == "n" and i[1:].isdigit() else i),
    )
    yield rewritten(
        "ids renumbered, in a gas of 3D",
        {I},
        renamed(lambda i: f"n{6 - int(i[1:])}" if i[1:].isdigit() else i),
        kind="gas",
        dims=3,
    )
    yield rewritten("one id is another from step 60 on", {I, C}, renamed(lambda i: "n99" if i == "n4" else i, 60))
    yield rewritten(
        "two ids change places at step 60", {I, C}, renamed(lambda i: {"n4": "n5", "n5": "n4"}.get(i, i), 60)
    )
    yield hooked("ids renumbered, and a start moved by an ulp", {G}, when(0, ulp(2)), kind="gas",
                 cut=lambda lines: lines if lines[1]["states"]["n2"] == plain("gas")[1]["states"]["n2"] else
                 renamed(lambda i: f"p{(int(i[1:]) * 3 + 2) % 7}" if i[1:].isdigit() else i)(lines))  # fmt: skip
    # order
    yield rewritten("contacts and states of a step in another order", {H, I}, each(shuffled))
    yield rewritten(
        "pairs the other way round",
        {I, H},
        each(lambda line: {**line, "contacts": [p[::-1] for p in line["contacts"]]}),
    )
    yield rewritten("a contact to a line", {I, H}, lambda lines: [lines[0], *itertools.chain.from_iterable(
        [*({"step": x["step"], "contact": p} for p in x["contacts"]), {k: v for k, v in x.items() if k != "contacts"}]
        for x in lines[1:])])  # fmt: skip
    # bodies that come and go
    yield hooked(
        "a body removed and put back in one step", {I}, when(50, lambda w: (w.alive.remove(4), w.alive.append(4)))
    )
    yield hooked("a body removed and put back, its warm start lost", {C, I},
                 when(60, lambda w: setattr(w, "cache", {k: v for k, v in w.cache.items() if 4 not in k})))  # fmt: skip
    yield hooked("a body gone for five steps", {C}, absent(50, 55), at=50)
    yield hooked("a body gone from step 50 on", {C}, absent(50, 999), at=50)
    yield hooked("a body gone from the start", {S, C}, absent(0, 999))
    yield hooked("a body gone for five steps, in a gas of 3D", {C}, absent(50, 55), at=50, kind="gas", dims=3)
    # sleep
    yield hooked("bodies fall asleep in one run", {C}, sleeps, seed=10)
    yield Trial("pile", "a sleeping body is not logged in one log", frozenset({I}), lambda: (
        played(hook=sleeps, seed=10), each(lambda line: {**line, "states": {
            i: row for i, row in line["states"].items() if any(row[2:])}})(played(hook=sleeps, seed=10))))  # fmt: skip
    yield Trial("pile", "one sleeping body is woken at step 100", frozenset({C}), lambda: (
        played(hook=sleeps, seed=10, steps=130),
        played(hook=woken, seed=10, steps=130)))  # fmt: skip
    # numbers that are none, zeros, denormals
    nan = math.nan
    yield Trial("gas", "NaN in both from step 30 on", frozenset({I}), lambda: (
        played("gas", hook=when(30, value(1, nan))), played("gas", hook=when(30, value(1, nan)))))  # fmt: skip
    yield Trial("gas", "NaN in the one, infinity in the other", frozenset({C}), lambda: (
        played("gas", hook=when(30, value(1, nan))), played("gas", hook=when(30, value(1, math.inf)))), 30)  # fmt: skip
    yield hooked("a start that is NaN", {S, C}, when(0, value(1, math.nan)), at=0)
    yield hooked("a velocity overflows at step 30", {C}, when(30, value(1, 1e308)), at=30, kind="gas")
    yield Trial("pile", "-0 for the 0 of what sleeps", frozenset(), lambda: (
        played(hook=sleeps, seed=10),
        rows(lambda i, row: [x or -0.0 for x in row])(played(hook=sleeps, seed=10))))  # fmt: skip
    yield Trial("pile", "denormals are flushed to zero", frozenset({G, I}), lambda: (
        rows(lambda i, row: [*row, 3e-310])(plain()), rows(lambda i, row: [*row, 0.0])(plain())))  # fmt: skip
    yield Trial("pile", "a spin that is noise of 1e-17", frozenset({G}), lambda: (
        rows(lambda i, row: [*row, 1e-17 * math.sin(row[0] * 1e3)])(plain()),
        rows(lambda i, row: [*row, 1e-17 * math.cos(row[0] * 1e3)])(plain())))  # fmt: skip
    yield Trial("pile", "an angle that is wrapped by a turn from step 40 on", frozenset({C}), lambda: (
        turned(lambda k: [k / 6]), turned(lambda k: [math.remainder(k / 6, math.tau)])))  # fmt: skip
    yield Trial("pile", "a quaternion of the other sign from step 60 on", frozenset({C}), lambda: (
        turned(lambda k: [math.cos(k / 30), math.sin(k / 30)]),
        turned(lambda k: [math.copysign(1, 59.5 - k) * f(k / 30) for f in (math.cos, math.sin)])))  # fmt: skip
    # frames of reference, units, what is logged when
    yield rewritten("centimetres for metres", {S}, rows(lambda i, row: [100 * x for x in row]))
    yield rewritten("y downwards", {S}, rows(lambda i, row: [row[0], -row[1], row[2], -row[3]]))
    yield rewritten("fields in another order, by name", {I}, lambda lines: [
        {**lines[0], "fields": lines[0]["fields"][::-1]}, *rows(lambda i, row: row[::-1])(lines)[1:]])  # fmt: skip
    yield rewritten("states as objects with names", {I}, lambda lines: [lines[0], *(
        {**x, "states": {i: dict(zip(lines[0]["fields"], row, strict=True)) for i, row in x["states"].items()}}
        for x in lines[1:])])  # fmt: skip
    yield rewritten("steps counted from 1", {I, S}, each(lambda line: {**line, "step": line["step"] + 1}))
    yield rewritten("a log that begins a step later, counted from 0", {S, I}, lambda lines: [lines[0], *(
        {**x, "step": x["step"] - 1, "time": x["time"] - 1 / 60} for x in lines[2:])])  # fmt: skip
    yield rewritten("a log of every second step", {I}, styled({"step", "time", "contacts", "states"}, 2))
    yield rewritten("a log that begins at step 30", {I}, lambda lines: [lines[0], *lines[31:]])
    yield rewritten("states alone in one log", {I}, styled({"step", "time", "states"}))
    yield rewritten("velocities alone left out in one log", {I}, lambda lines: [
        {**lines[0], "fields": lines[0]["fields"][:2]}, *rows(lambda i, row: row[:2])(lines)[1:]])  # fmt: skip
    yield rewritten("hexadecimal numbers", {I}, hexed)
    yield rewritten("packed numbers", {I}, packed)
    yield rewritten("a line lost", set(), lambda lines: [*lines[:40], *lines[41:]])
    yield rewritten("a line twice", set(), lambda lines: [*lines[:41], *lines[40:]])
    yield rewritten(
        "wall-clock milliseconds in one log alone", {C}, each(lambda line: {**line, "ms": 0.1 * (line["step"] % 7)})
    )
    yield hooked("a field 'score' differs from step 70 on", {C}, lambda w, k: {"score": 1 + (k >= 70)}, at=70)
    yield Trial("pile", "'score' of another value from step 70 on", frozenset({C}), lambda: (
        played(hook=lambda w, k: {"score": 1}), played(hook=lambda w, k: {"score": 1 + (k >= 70)})), 70)  # fmt: skip
    # logs of less
    for n in (4, 16):
        cut = styled({"step", "time", "contacts", "states"}, n)
        yield hooked(f"an ulp at the start; every {n}th step", {G}, when(0, ulp(2)), kind="gas", seed=11, cut=cut)
        yield hooked(f"a shove at step 50; every {n}th step", {C}, when(50, shove(1, 0.9)), seed=11, cut=cut)
        yield hooked(f"a start moved; every {n}th step", {S}, when(0, place(1, 0.02)), seed=11, cut=cut)
    for cut, name in ((styled({"step", "contacts"}), "contacts alone"), (hash_lines, "hashes alone"),
                      (hashes_with(10), "hashes, and states of every 10th step"),
                      (styled({"time", "states"}), "times and states")):  # fmt: skip
        yield hooked(f"nothing; {name}", {I}, seed=12, cut=cut)
        yield hooked(
            f"an ulp at the start; {name}",
            {G, I} if name == "contacts alone" else {G},
            when(0, ulp(2)),
            kind="gas",
            seed=12,
            cut=cut,
        )
        yield hooked(f"a shove at step 50; {name}", {C}, when(50, shove(1, 0.9)), seed=12, cut=cut)
        yield hooked(f"another step; {name}", {S, C} if name == "contacts alone" else {S}, dt=1 / 50, seed=12, cut=cut)
        yield hooked(f"a lost contact; {name}", {C}, lose(30), seed=12, cut=cut)
    yield rewritten(
        "hashes in two forms of file",
        {I},
        lambda lines: "".join(f"{x['step']} {hash_of(x)}\n" for x in lines[1:]),
        cut=hash_lines,
    )
    yield rewritten("hashes, the one list cut short", set(), lambda lines: hash_lines(lines)[:-130], cut=hash_lines)
    yield rewritten("hashes, one lost", set(), lambda lines: hash_lines([*lines[:60], *lines[61:]]), cut=hash_lines)
    # one log has less than the other
    less = styled({"step", "time", "contacts", "states"}, 16)
    yield both("another step; the other log has every 16th", {S}, less, dt=1 / 50, seed=13)
    yield both("a start moved; the other log has every 16th", {S}, less, when(0, place(1, 0.02)), seed=13)
    yield both("a shove at step 50; the other log has every 16th", {C}, less, when(50, shove(1, 0.9)), seed=13)
    yield both("an ulp; the other log has every 16th", {G}, less, when(0, ulp(1)), kind="gas", seed=13)
    late = lambda lines: [lines[0], *lines[31:]]  # noqa: E731
    yield both("a start moved; the other log begins at step 30", {S}, late, when(0, place(1, 0.02)), seed=13)
    yield both(
        "a shove at step 50; the other log begins at step 30", {C}, late, when(50, shove(1, 0.9)), at=50, seed=13
    )
    yield both("an ulp; the other log begins at step 30", {G}, late, when(0, ulp(1)), kind="gas", seed=13)
    for form in ("%.15g", "%.6f", "%.9g"):
        yield both(
            f"a shove at step 50; the other log printed by {form}",
            {C},
            shown(form),
            when(50, shove(1, 0.9)),
            at=50,
            seed=13,
        )
        yield both(f"an ulp; the other log printed by {form}", {G}, shown(form), when(0, ulp(1)), kind="gas", seed=13)
        yield both(
            f"a start moved; the other log printed by {form}", {S}, shown(form), when(0, place(1, 0.02)), seed=13
        )
        yield both(f"another step; the other log printed by {form}", {S}, shown(form), dt=1 / 50, seed=13)
    some = lambda lines: [{**lines[0], "fields": ["x", "vx"]}, *rows(lambda i, row: [row[0], row[2]])(lines)[1:]]  # noqa: E731
    yield both("a shove at step 50; the other log has x and vx", {C}, some, when(50, shove(1, 0.9)), at=50, seed=13)
    yield both("an ulp; the other log has x and vx", {G}, some, when(0, ulp(1)), kind="gas", seed=13)
    alone = styled({"step", "time", "states"})
    yield both("a shove at step 50; the other log has no contacts", {C}, alone, when(50, shove(1, 0.9)), at=50, seed=13)
    yield both("a lost contact; the other log has no contacts", {C}, alone, lose(30), seed=13)
    yield both("an ulp; the other log has no contacts", {G}, alone, when(0, ulp(1)), kind="gas", seed=13)
    timed = styled({"time", "contacts"})
    yield hooked(
        "an ulp; contacts at times of steps, no states", {G, I}, when(0, ulp(1)), kind="gas", seed=13, cut=timed
    )
    yield hooked(
        "a shove at step 50; contacts at times of steps, no states",
        {C},
        when(50, shove(1, 0.9)),
        kind="gas",
        seed=13,
        cut=timed,
    )
    timed = styled({"time", "contacts", "states"})
    yield hooked("an ulp; contacts and states at times of steps", {G}, when(0, ulp(1)), kind="gas", seed=13, cut=timed)
    yield hooked(
        "a shove at step 50; contacts and states at times of steps",
        {C},
        when(50, shove(1, 0.9)),
        kind="gas",
        seed=13,
        cut=timed,
    )
    yield hooked("another step; contacts and states at times of steps", {S}, dt=1 / 50, kind="gas", seed=13, cut=timed)
    yield rewritten("a body not logged for five steps", {I}, each(lambda x: {**x, "states": {
        i: row for i, row in x["states"].items() if i != "n4" or not 50 <= x["step"] < 55}}))  # fmt: skip
    yield Trial("pile", "rows of CSV, one number shoved at step 50", frozenset({C}), lambda: (
        csv_of(plain()), csv_of(played(hook=when(50, shove(1, 0.9))))), 50, suffix=".csv")  # fmt: skip
    yield Trial("gas", "rows of CSV, one start moved by an ulp", frozenset({G}), lambda: (
        csv_of(plain("gas")), csv_of(played("gas", hook=when(0, ulp(1))))), 0, suffix=".csv")  # fmt: skip


# An event-driven gas of discs: events have times, no steps.


@cache
def _events(seed: int, nudge: str, bias: float, mass: float, count: int = 220, n: int = 8) -> str:
    rng = random.Random(seed)
    at = [[1.5 + 2.9 * (k % 3) + rng.uniform(0, 0.6), 1.5 + 2.9 * (k // 3) + rng.uniform(0, 0.6)] for k in range(n)]
    v = [[rng.uniform(-2, 2), rng.uniform(-2, 2)] for _ in range(n)]
    m = [1.0] * n
    m[3] = mass
    if nudge == "ulp":
        at[2][0] = math.nextafter(at[2][0], 9)
    if nudge == "moved":
        at[2][0] += 0.05
    now, ends, when_of = 0.0, 10.0, [0.0] * n
    stamp = [0] * n
    queue: list[tuple[float, int, int, int, int]] = []

    def here(k: int, t: float) -> tuple[float, float]:
        return at[k][0] + v[k][0] * (t - when_of[k]), at[k][1] + v[k][1] * (t - when_of[k])

    def predict(k: int) -> None:
        for axis in (0, 1):
            if v[k][axis]:
                edge = ends - 1 if v[k][axis] > 0 else 1.0
                heapq.heappush(
                    queue, (now + (edge - at[k][axis]) / v[k][axis], k, -1 - 2 * axis - (edge > 1), stamp[k], 0)
                )
        for j in range(n):
            if j == k:
                continue
            (x, y), (p, q) = here(k, now), here(j, now)
            dx, dy, ux, uy = p - x, q - y, v[j][0] - v[k][0], v[j][1] - v[k][1]
            b, a, c = dx * ux + dy * uy, ux * ux + uy * uy, dx * dx + dy * dy - 4.0
            if b < 0 and (d := b * b - a * c) > 0 and c > -1e-6 and {j, k} != passing:
                heapq.heappush(queue, (now + max(0.0, c / (-b + math.sqrt(d))), k, j, stamp[k], stamp[j]))

    passing: set[int] = set()
    for k in range(n):
        predict(k)
    lines: Lines = []
    lost = nudge != "lost"
    while len(lines) < count:
        t, a, b, sa, sb = heapq.heappop(queue)
        if stamp[a] != sa or (b >= 0 and stamp[b] != sb):
            continue
        now = t
        for k in (a, b):
            if k >= 0:
                at[k][:], when_of[k] = here(k, t), t
                stamp[k] += 1
        if not lost and b >= 0 and len(lines) > 90:
            lost, passing = True, {a, b}
        elif b >= 0:
            dx, dy = at[b][0] - at[a][0], at[b][1] - at[a][1]
            s = 2 * ((v[b][0] - v[a][0]) * dx + (v[b][1] - v[a][1]) * dy) / (dx * dx + dy * dy) / (1 / m[a] + 1 / m[b])
            for k, sign in ((a, 1), (b, -1)):
                v[k][0] += sign * s * dx / m[k]
                v[k][1] += sign * s * dy / m[k]
            lines.append(
                {"time": t, "contact": [f"d{a}", f"d{b}"], "states": {f"d{k}": [*at[k], *v[k]] for k in (a, b)}}
            )
        else:
            axis = (-1 - b) // 2
            v[a][axis] *= -1.0
            v[a][axis] += bias if len(lines) > 100 else 0.0
            lines.append({"time": t, "contact": [f"d{a}", f"wall{-b}"], "states": {f"d{a}": [*at[a], *v[a]]}})
        for k in (a, b):
            if k >= 0:
                predict(k)
        passing = set()
    return json.dumps([{**HEAD, "fields": ["x", "y", "vx", "vy"]}, *lines])


def events(seed: int = 1, nudge: str = "", bias: float = 0.0, mass: float = 1.0) -> Lines:
    """A log of events."""
    return json.loads(_events(seed, nudge, bias, mass))


def event_pairs() -> Iterator[Trial]:
    """Pairs of the gas by events."""

    def of(what: str, right: set[Finding], make: Callable[[int], tuple[Log, Log]]) -> Iterator[Trial]:
        for seed in (1, 2):
            yield Trial(f"events {seed}", what, frozenset(right), lambda seed=seed: make(seed))

    yield from of("nothing", {I}, lambda s: (events(s), events(s)))
    yield from of("one start moved by an ulp", {G}, lambda s: (events(s), events(s, "ulp")))
    yield from of("one start moved by an ulp, without states", {G}, lambda s: (bare(events(s)), bare(events(s, "ulp"))))
    yield from of(
        "one start moved by an ulp, partners alone", {G}, lambda s: (untimed(events(s)), untimed(events(s, "ulp")))
    )
    yield from of("one start moved by 0.05", {S}, lambda s: (events(s), events(s, "moved")))
    yield from of(
        "one start moved by 0.05, without states", {S, C}, lambda s: (bare(events(s)), bare(events(s, "moved")))
    )
    yield from of("a lost contact", {C}, lambda s: (events(s), events(s, "lost")))
    yield from of("a lost contact, without states", {C}, lambda s: (bare(events(s)), bare(events(s, "lost"))))
    yield from of("a lost contact, partners alone", {C}, lambda s: (untimed(events(s)), untimed(events(s, "lost"))))
    yield from of("a mass of 1.2", {C, S}, lambda s: (events(s), events(s, mass=1.2)))
    yield from of("walls that give speed from event 100 on", {C}, lambda s: (events(s), events(s, bias=0.01)))
    yield from of("independent events in another order", {H}, lambda s: (events(s), swapped(events(s))))
    yield from of(
        "independent events in another order, without states",
        {H},
        lambda s: (bare(events(s)), swapped(bare(events(s)))),
    )
    yield from of(
        "an ulp, and independent events in another order", {G}, lambda s: (events(s), swapped(events(s, "ulp")))
    )
    yield from of(
        "times in floats in one log",
        {G, I},
        lambda s: (events(s), floats(events(s), ("time",))),
    )
    yield from of(
        "one start moved by an ulp, all in floats", {G, I}, lambda s: (floats(events(s)), floats(events(s, "ulp")))
    )
    yield from of(
        "one start moved by an ulp, times in floats, without states",
        {G, I},
        lambda s: (bare(floats(events(s))), bare(floats(events(s, "ulp")))),
    )
    yield from of("a lost contact, all in floats", {C}, lambda s: (floats(events(s)), floats(events(s, "lost"))))
    yield from of(
        "a lost contact, times in floats, without states",
        {C},
        lambda s: (bare(floats(events(s))), bare(floats(events(s, "lost")))),
    )
    yield from of(
        "a mass of 1.2; times in floats in one log",
        {C, S},
        lambda s: (
            events(s),
            floats(events(s, mass=1.2), ("time",)),
        ),
    )
    yield from of(
        "walls of other ids, and an ulp",
        {G},
        lambda s: (events(s), json.loads(json.dumps(events(s, "ulp")).replace('"wall', '"side-'))),
    )
    yield from of(
        "times with 4 decimals in both, and an ulp", {G}, lambda s: (rounded(events(s)), rounded(events(s, "ulp")))
    )
    yield from of("a clock that begins anew at event 120", {I}, lambda s: (events(s), [
        {**x, "time": x["time"] - events(s)[121]["time"]} if k > 120 else x
        for k, x in enumerate(events(s))]))  # fmt: skip
    yield from of("an event lost from the log", set(), lambda s: (events(s), [*events(s)[:90], *events(s)[91:]]))
    yield from of("an event twice", set(), lambda s: (events(s), [*events(s)[:91], *events(s)[90:]]))
    yield from of("cut short", set(), lambda s: (events(s), events(s)[:150]))
    yield from of("other ids", {I}, lambda s: (events(s), json.loads(json.dumps(events(s)).replace('"d', '"disc-'))))
    yield from of(
        "walls of other ids", {I}, lambda s: (events(s), json.loads(json.dumps(events(s)).replace('"wall', '"side-')))
    )


# pymunk, with what its own users do.


def pymunk_run(seed: int = 1, steps: int = 150, iterations: int = 10, damping: float = 1.0,
               do: Callable[[Any, int], object] = lambda space, k: None, threads: int = 0,
               sleep: float = math.inf) -> Lines:  # fmt: skip
    """Boxes that fall onto each other, a motor and a spring."""
    import pymunk

    rng = random.Random(seed)
    space = pymunk.Space(threaded=threads > 0)
    if threads:
        space.threads = threads
    space.gravity, space.iterations, space.damping, space.sleep_time_threshold = (0, -500), iterations, damping, sleep
    for ends in (((0, 0), (400, 0)), ((0, 0), (0, 900)), ((400, 0), (400, 900))):
        floor = pymunk.Segment(space.static_body, *ends, 3)
        floor.friction = 0.8
        space.add(floor)
    bodies = []
    for k in range(10):
        body = pymunk.Body(2, pymunk.moment_for_box(2, (30, 20)))
        body.position = 60 + 70 * (k % 5) + rng.random(), 40 + 60 * (k // 5)
        shape = pymunk.Poly.create_box(body, (30, 20)) if k % 3 else pymunk.Circle(body, 14)
        shape.friction, shape.elasticity = 0.7, 0.3
        space.add(body, shape)
        bodies.append(body)
    joints: Any = pymunk
    space.add(
        joints.DampedSpring(bodies[0], bodies[6], (0, 0), (0, 0), 50, 30, 1),
        joints.PivotJoint(bodies[1], bodies[7], (130, 70)),
    )
    space.bodies_by_age = bodies  # type: ignore[attr-defined]
    lines: Lines = [{**HEAD, "fields": ["x", "y", "angle", "vx", "vy", "spin"]}]
    for k in range(steps + 1):
        if k:
            do(space, k)
            space.step(1 / 60)
        lines.append(
            {
                "step": k,
                "states": {
                    f"body{i}": [*b.position, b.angle, *b.velocity, b.angular_velocity] for i, b in enumerate(bodies)
                },
            }
        )
    return lines


def pymunk_pairs() -> Iterator[Trial]:
    """Pairs of pymunk."""

    def at(step: int, do: Callable[[Any], object]) -> Callable[[Any, int], object]:
        return lambda space, k: do(space) if k == step else None

    def shoved(space: Any) -> None:
        space.bodies_by_age[4].apply_impulse_at_local_point((40, 0))

    def put_back(space: Any) -> None:
        body = space.bodies_by_age[8]
        shapes = list(body.shapes)
        space.remove(body, *shapes)
        space.add(body, *shapes)

    def of(what: str, right: set[Finding], where: int | None = None, **settings: Any) -> Trial:
        return Trial("pymunk", what, frozenset(right), lambda: (pymunk_run(), pymunk_run(**settings)), where)

    yield of("nothing", {I})
    yield of("an impulse at step 70", {C}, 70, do=at(70, shoved))
    yield of("a body removed and put back at step 120", {C, I, H}, do=at(120, put_back))
    yield of("a joint removed at step 30", {C}, do=at(30, lambda s: s.remove(next(iter(s.constraints)))))
    yield of("25 iterations for 10", {C, S}, iterations=25)
    yield of("a damping of 0.999", {S, C}, 1, damping=0.999)
    yield of("sleeping allowed", {C, I}, sleep=0.3)
    yield of("gravity turned at step 90", {C}, 90, do=at(90, lambda s: setattr(s, "gravity", (10, -500))))
    yield of(
        "a body moved by an ulp at step 5",
        {G},
        do=at(
            5,
            lambda s: setattr(
                s.bodies_by_age[3],
                "position",
                (math.nextafter(s.bodies_by_age[3].position.x, 999), s.bodies_by_age[3].position.y),
            ),
        ),
    )
    yield of("two threads", {I, H, G, C}, threads=2)
    yield of("a friction of 0.71 for 0.7", {C, S}, do=at(1, lambda s: [setattr(x, "friction", 0.71) for x in s.shapes]))


def chain_pairs() -> Iterator[Trial]:
    """Pairs of the chain."""
    if shutil.which("cc") is None:
        return
    plain_flags = ("-O0", "-ffp-contract=off")
    for flags, right in (
        (("-O2", "-ffp-contract=off"), {I}),
        (("-O3", "-ffp-contract=off"), {I}),
        (("-O2", "-mfma", "-ffp-contract=fast"), {G, I}),
        (("-Ofast", "-march=native"), {G, I}),
        (("-O2", "-mfpmath=387"), {G}),
        (("-O0", "-DSIN=sinf"), {G, C, S}),
        (("-O0", "-DREAL=float"), {G}),
        (("-O0", "-DREAL=long double"), {G}),
    ):
        what = " ".join(flags)
        yield Trial(
            "a chain in C, double",
            f"{what} for -O0",
            frozenset(right),
            lambda flags=flags: (chain(*plain_flags), chain(*flags)),
        )
    for flags in (("-O2", "-mfma", "-ffp-contract=fast"), ("-Ofast", "-march=native"), ("-O2", "-mfpmath=387")):

        def make(flags: tuple[str, ...] = flags) -> tuple[Log, Log]:
            real = "-DREAL=float", "-DSIN=sinf"
            return chain(*plain_flags, *real), chain(*flags, *real)

        yield Trial("a chain in C, float", f"{' '.join(flags)} for -O0", frozenset({G, I}), make)


def pairs() -> list[Trial]:
    """All of them."""
    return [*stepped_pairs(), *event_pairs(), *pymunk_pairs(), *chain_pairs()]
