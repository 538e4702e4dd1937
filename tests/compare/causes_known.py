"""Scenes and engines whose error is made by hand, so that the cause of each divergence is known before it is asked for.

    python tests/compare/causes_known.py [FAMILY...] [--only TEXT]

To the engine of `faults.Run` a case adds faults. What each contributes to the decision is the difference of two runs,
with the faults up to it and with those before it, so that the contributions add up; which faults are enough is found by
running each by itself.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Any

from faults import (
    Always,
    Fault,
    Invent,
    Kick,
    Made,
    OtherPolicy,
    Rounded,
    RoundedExact,
    Run,
    Shift,
    Skip,
    Steps,
    fraction,
)
from other_runs import nearest, rounded_scene
from refuting import (
    ARITHMETIC,
    FLIGHTS,
    IMPACTS,
    INPUT,
    INTEGRATOR,
    ITERATIONS,
    LATENESS,
    LAW,
    MISSED,
    OF_ARITHMETIC,
    OVERLAP,
    PHANTOM,
    POSITIONS,
    STEP,
    TIE,
    TUNNELLING,
    UNKNOWN,
    refute,
    said_of,
)

from truebreak.compare import compare
from truebreak.compare.engines import engine as engine_named
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Scene, Wall, catalogue

# -- what is known of a case


@dataclass(frozen=True)
class Case:
    """A scene, an engine, and what has to be said.

    Attributes:
        name: what it is.
        scene, engine: what is compared; `events`: how far.
        main: the kinds of which one has to be the first that is named.
        never: kinds that must not be said to be enough.
        shares: for each kind, its share of the displacement, and by how much it may be off.
        all_of: kinds all of which must be named, since none is enough without the others.
    """

    name: str
    scene: Scene
    engine: Any
    main: frozenset[str]
    events: int | None = None
    never: frozenset[str] = frozenset()
    shares: tuple[tuple[str, float, float], ...] = ()
    all_of: frozenset[str] = frozenset()


Decision = Callable[[Run], Any]
"""The number that decides, of a run that has come to the last event before it."""


def gap(one: str, other: str) -> Decision:
    """Whether two circles hit or miss each other: their least gap in free flight."""
    return lambda run: run.least(one, other)


def order(first: tuple[str, str], second: tuple[str, str]) -> Decision:
    """Which of two meetings comes first: the time between them."""

    def between(run: Run) -> Any:
        times = []
        for one, other in (first, second):
            i, j = sorted((run.ids.index(one), run.ids.index(other)))
            times.append(run.wall(i, j - len(run.p)) if j >= len(run.p) else run.wait(i, j))
        return times[1] - times[0]

    return between


def in_order(faults: Sequence[Fault]) -> list[Fault]:
    """The order in which they act: the input, then events, flights before impulses."""

    def place(fault: Fault) -> tuple[int, int]:
        if isinstance(fault, Rounded):
            return (-1, 0)
        if isinstance(fault, Always):
            return (-1, 1)
        return (fault.event, 0 if isinstance(fault, Shift) else 1)

    return sorted(faults, key=place)


@cache
def history(scene: Scene, faults: tuple[Fault, ...], events: int) -> tuple[tuple[str, str], ...]:
    """Who meets whom."""
    return tuple(m.pair for m in Run(scene, faults).upto(events).meetings)


def budget(
    scene: Scene, faults: Sequence[Fault], after: int, decision: Decision
) -> tuple[dict[str, tuple[float, float]], float, float]:
    """What each kind contributes, as a share with a tolerance; the displacement; and the margin.

    The tolerance has two parts: .02, and what separate runs of the faults do not add up to, since a contribution may be
    taken to the first order where the second is small.
    """
    listed = in_order(faults)
    values = [decision(Run(scene, listed[:k]).upto(after)) for k in range(len(listed) + 1)]
    margin, total = values[0], values[-1] - values[0]
    alone = [decision(Run(scene, [f]).upto(after)) - margin for f in listed]
    bent = abs(float((sum(alone) - total) / total))
    shares: dict[str, float] = {}
    for k, fault in enumerate(listed):
        shares[fault.kind] = shares.get(fault.kind, 0.0) + float((values[k + 1] - values[k]) / total)
    return {kind: (share, 0.02 + bent) for kind, share in shares.items()}, float(total), float(margin)


def case(
    name: str,
    scene: Scene,
    faults: Sequence[Fault],
    after: int,
    decision: Decision,
    bits: int = 53,
    events: int | None = None,
) -> Case:
    """A case whose expectation is found by runs: of all faults, of each kind by itself, and of all before each."""
    listed = tuple(in_order(faults))
    kinds = list(dict.fromkeys(f.kind for f in listed))
    shares, total, margin = budget(scene, listed, after, decision)
    assert margin * (margin + total) < 0, f"{name}: margin {margin}, displacement {total}: nothing is decided otherwise"
    by_kind = {kind: tuple(f for f in listed if f.kind == kind) for kind in kinds}
    moved = {kind: float(decision(Run(scene, of).upto(after))) for kind, of in by_kind.items()}
    enough = {kind for kind, value in moved.items() if value * margin < 0}
    top = max(share for share, _ in shares.values())
    main = frozenset(kind for kind, (share, room) in shares.items() if share >= top - 2 * room)
    together = frozenset(k for k in kinds if shares[k][0] > 0.1) if not enough else frozenset[str]()
    arithmetic = [f for f in listed if f.kind in (FLIGHTS, IMPACTS)]
    only = decision(Run(scene, arithmetic).upto(after))
    never = (set(kinds) - enough) | {LAW, MISSED, PHANTOM, TIE, STEP} | ({INPUT, FLIGHTS, IMPACTS} - set(kinds))
    if only * margin > 0:
        never.add(ARITHMETIC)
    return Case(
        name,
        scene,
        Made(listed, bits),
        main,
        events=events if events is not None else after + 2,
        never=frozenset(never),
        shares=tuple((kind, share, room) for kind, (share, room) in shares.items()),
        all_of=together,
    )


# -- the scenes

AIMED = frozenset({ARITHMETIC, FLIGHTS, IMPACTS, LAW, MISSED, PHANTOM})
SLOPE, WAY = (Fraction(4, 5), Fraction(3, 5)), (Fraction(-3, 5), Fraction(4, 5))
"""Where the second disc of a relay flies, and what is at right angles to that."""


def aim(offset: str) -> Scene:
    """A disc flies past another: their least gap is the offset less 2."""
    return Scene([Circle(0, offset, vx=1, id="a"), Circle(10, 0, id="b")], name=f"aim at {offset}")


def relay(bits: int, margin: int, extra: Fraction = Fraction(0), far: int = 64) -> Scene:
    """One disc hits a second, which flies `far` and passes a third by `margin` units of 2**-bits, or hits it.

    All numbers have so many bits, but for `extra`, which is added to the place of the first disc: below half a unit, it
    is what rounding takes away. The margin is met to a unit, by the radius of the third disc.
    """
    c, s = SLOPE

    def made(radius: Fraction) -> Scene:
        first = nearest(-2 * s, bits) + extra
        third = [nearest(far * along + 2 * side, bits) for along, side in zip(SLOPE, WAY, strict=True)]
        circles = [
            Circle(str(nearest(-8 - 2 * c, bits)), str(first), vx=1, id="a"),
            Circle(0, 0, id="b"),
            Circle(str(third[0]), str(third[1]), str(radius), id="c"),
        ]
        return Scene(circles, name=f"relay of {bits} bits, margin {margin}")

    unit = Fraction(1, 2**bits)
    off = decided(made(Fraction(1))) - margin * unit
    return made(nearest(1 + off, bits - 1))


def decided(scene: Scene, faults: Sequence[Fault] = ()) -> Fraction:
    """The number that decides a relay: the least gap of its second and third disc, after the first event."""
    return fraction(gap("b", "c")(Run(scene, faults).upto(1)))


def sized(scene: Scene, make: Callable[[Fraction], Fault], want: Fraction) -> Fault:
    """The fault of such a size that it moves the relay's decision by what is wanted, to some digits."""
    size, margin = Fraction(1, 2**30), decided(scene)
    for _ in range(4):
        size = nearest(size * want / (decided(scene, [make(size)]) - margin), 40)
    return make(size)


def kicked(size: Fraction) -> Fault:
    """The second disc leaves the first by a velocity that is off to the side."""
    return Kick(0, "b", (size * WAY[0], size * WAY[1]))


def shifted(size: Fraction) -> Fault:
    """The first disc comes to the second off to the side, which turns the line of centres."""
    return Shift(0, "a", (size * WAY[0], size * WAY[1]))


def of_input() -> Iterator[Case]:
    """Engines that are exact but for the rounding of the input: it is the only cause, with all of the displacement."""
    for bits, offset in ((8, "1.999"), (11, "2 - 1/3000"), (24, "2 - 10**-8"), (53, "2 - 10**-17"), (24, "2 - 10**-9")):
        yield Case(
            f"aim at {offset}, input of {bits} bits", aim(offset), Made((Rounded(bits),), bits), frozenset({INPUT}), 2,
            AIMED | {TIE}, ((INPUT, 1.0, 0.02),),
        )  # fmt: skip
    for spec, bits, events in (
        ("near-tie:k=9", 24, 4), ("near-tie:k=20", 53, 4), ("near-tie:k=40", 53, 4),
        ("near-tie:k=20,first=right", 53, 4), ("gas:n=5,seed=2", 24, 60), ("gas:n=4,seed=7", 24, 60),
        ("pinball:offset=1/10**8", 24, 12),
    ):  # fmt: skip
        scene = catalogue.build(spec)
        yield Case(f"{spec}, exact on {bits} bits", scene, RoundedExact(bits), frozenset({INPUT}), events, AIMED,
                   ((INPUT, 1.0, 0.02),))  # fmt: skip
    yield Case("struck at a graze", STRUCK, "double", frozenset({INPUT}), 8, frozenset({LAW, PHANTOM, TIE}))


STRUCK = Scene(
    [Circle(0, "2-10**-30", vx=1, id="b"), Circle(4, 2, id="d")], [Wall(0, 3, 1, 3, id="w")], name="struck at a graze"
)
"""The first hits the second from 10**-30 below its centre, and so presses it against the wall that it touches. In
doubles it hits it square: the exact run of the scene in doubles lacks the same contact as the run in doubles does."""


def of_one_kind() -> Iterator[Case]:
    """In a relay one impulse is off, or one flight; nothing else is."""
    for bits, units, far in ((16, 24, 64), (16, -24, 64), (24, 16, 64), (24, -40, 128)):
        scene = relay(bits, units, far=far)
        margin = decided(scene)
        for name, make in (("impulse", kicked), ("flight", shifted)):
            for part in (Fraction(3, 2), Fraction(3)):
                fault = sized(scene, make, -margin * part)
                yield case(f"{scene.name}: {name} off by {part} margins", scene, [fault], 1, gap("b", "c"), bits)


MIXES = (
    ("60 and 40", Fraction(9, 10), Fraction(6, 10)),
    ("120 and 80 margins", Fraction(6, 5), Fraction(4, 5)),
    ("85 and 15", Fraction(17, 10), Fraction(3, 10)),
    ("even, neither alone", Fraction(7, 10), Fraction(7, 10)),
    ("75 and 25, neither alone", Fraction(9, 10), Fraction(3, 10)),
    ("cancel in part", Fraction(3), Fraction(-1)),
    ("cancel, the other way", Fraction(-1), Fraction(5, 2)),
)
"""Two contributions as parts of the margin, which they have to carry past zero."""


def of_two_kinds() -> Iterator[Case]:
    """Errors of flight and impulse that add, cancel in part, or are enough only together."""
    for bits, units in ((16, 24), (24, -20)):
        scene = relay(bits, units)
        margin = decided(scene)
        for name, one, other in MIXES:
            faults = [sized(scene, kicked, -margin * one), sized(scene, shifted, -margin * other)]
            yield case(f"{scene.name}: impulse and flight, {name}", scene, faults, 1, gap("b", "c"), bits)


def of_input_and_arithmetic() -> Iterator[Case]:
    """The same with rounding of the input, which takes away what was added to the first disc's place."""
    for bits, sign, make in ((16, 1, kicked), (24, -1, kicked), (16, -1, shifted)):
        extra = sign * Fraction(3, 8) / 2**bits
        takes = decided(relay(bits, 0, extra), [Rounded(bits)]) - decided(relay(bits, 0, extra))
        for name, one, other in MIXES:
            units = round(-takes / one * 2**bits)
            scene = relay(bits, units, extra)
            margin = decided(scene)
            by = decided(scene, [Rounded(bits)]) - margin
            fault = sized(scene, make, by * other / one)
            yield case(
                f"{scene.name}: input and arithmetic, {name}", scene, [Rounded(bits), fault], 1, gap("b", "c"), bits
            )


def gases() -> Iterator[Case]:
    """Chaotic scenes in which faults grow until they decide; what each contributes is the difference of two runs."""
    recipes: list[tuple[int, list[tuple[type[Kick] | type[Shift], int, int, int]], bool]] = [
        (16, [(Kick, 2, 24, -8)], False),
        (16, [(Kick, 5, -16, 24)], False),
        (16, [(Shift, 3, 2, 3)], False),
        (20, [(Shift, 1, -4, 2)], False),
        (16, [], True),
        (16, [(Kick, 2, 24, -16)], True),
        (20, [(Shift, 2, 3, -3)], True),
        (16, [(Kick, 2, 8, 8), (Shift, 3, 4, -4)], True),
        (16, [(Kick, 1, 16, 8), (Kick, 4, -8, 16)], False),
        (20, [(Shift, 1, 4, 4), (Kick, 3, -16, 8)], False),
        (24, [(Kick, 3, 16, 16), (Shift, 5, 4, 4)], True),
    ]
    seed = 0
    for bits, made, rounds in recipes:
        while True:
            seed += 1
            scene = catalogue.build(f"gas:n=4,seed={seed}").with_changes(until=None, events=None)
            scene = scene if rounds else rounded_scene(scene, bits)
            pairs = history(scene, (), 8)
            faults: list[Fault] = [Rounded(bits)] if rounds else []
            faults += [
                make(event, pairs[event][0], (Fraction(x, 2**bits), Fraction(y, 2**bits))) for make, event, x, y in made
            ]
            kinds = ", ".join(dict.fromkeys(f.kind for f in faults))
            known = grown(f"gas of 4, seed {seed}, {bits} bits: {kinds}", scene, faults, bits)
            if known is not None:
                yield known
                break


def grown(name: str, scene: Scene, faults: Sequence[Fault], bits: int, most: int = 80) -> Case | None:
    """The case of a scene in which it is first to be found where a run with faults leaves the one without.

    None where it does not, or where another decision than whether two hit, or which of two comes first, is in question.
    """
    listed = tuple(in_order(faults))
    mine, theirs = history(scene, (), most), history(scene, listed, most)
    where = next((k for k, (one, other) in enumerate(zip(mine, theirs, strict=False)) if one != other), most)
    circles = {str(c.id) for c in scene.circles}
    if where > most - 8 or not {*mine[where]} & {*theirs[where]} & circles:
        return None  # nothing, or perhaps two independent events in another order
    runs = [Run(scene, listed[:k]).upto(where) for k in range(len(listed) + 1)]
    if any(tuple(m.pair for m in run.meetings) != mine[:where] for run in runs):
        return None
    values: list[Any] = []
    for decision in (
        order(mine[where], theirs[where]),
        *(gap(*p) for p in (mine[where], theirs[where]) if {*p} <= circles),
    ):
        try:
            values = [decision(run) for run in runs]
        except TypeError:  # one of the two does not meet at all
            continue
        if values[0] * values[-1] < 0:
            break
    else:
        return None
    total = values[-1] - values[0]
    shares: dict[str, float] = {}
    for k, fault in enumerate(listed):
        shares[fault.kind] = shares.get(fault.kind, 0.0) + float((values[k + 1] - values[k]) / total)
    room = 0.02 if len(shares) == 1 else 0.15
    top = max(shares.values())
    main = frozenset(kind for kind, share in shares.items() if share >= top - 2 * room)
    never = frozenset({LAW, MISSED, PHANTOM, TIE, STEP} | ({INPUT, FLIGHTS, IMPACTS} - shares.keys()))
    expected = tuple((kind, share, room) for kind, share in shares.items())
    return Case(name, scene, Made(listed, bits), main, where + 3, never, expected)


def of_every_event() -> Iterator[Case]:
    """Every place, or every velocity, is rounded to few bits: all of it is flights, or impulses."""
    seed = 50
    for bits, kind in ((16, FLIGHTS), (16, IMPACTS), (20, FLIGHTS), (20, IMPACTS)):
        known = None
        while known is None:
            seed += 1
            scene = catalogue.build(f"gas:n=4,seed={seed}").with_changes(until=None, events=None)
            fault = Always(
                flights=bits if kind == FLIGHTS else None, impacts=bits if kind == IMPACTS else None, kind=kind
            )
            known = grown(f"gas of 4, seed {seed}: {kind}, {bits} bits", rounded_scene(scene, bits), [fault], bits)
        yield known


def of_law() -> Iterator[Case]:
    """Engines of another law."""
    lost, gained = Always(Fraction(999, 1000)), Always(Fraction(1001, 1000))
    for name, spec, fault in (
        ("restitution 0.999", "gas:n=4,seed=3", lost),
        ("restitution 0.999", "gas:n=3,seed=5,mixed=yes", lost),
        ("restitution 1.001", "gas:n=4,seed=6", gained),
        ("restitution 0.9", "galperin:n=1", Always(Fraction(9, 10))),
        ("masses taken for equal", "gas:n=4,seed=3,mixed=yes", Always(equal=True)),
        ("masses taken for equal", "sizes", Always(equal=True)),
        ("masses taken for equal", "tennis", Always(equal=True)),
    ):
        never = frozenset({INPUT, ARITHMETIC, FLIGHTS, IMPACTS, TIE, PHANTOM, MISSED})
        yield Case(f"{spec}: {name}", catalogue.build(spec), Made((fault,)), frozenset({LAW}), 60, never)


def of_contacts() -> Iterator[Case]:
    """Engines that miss one contact, or invent one."""
    wrong = frozenset({INPUT, ARITHMETIC, FLIGHTS, IMPACTS, TIE})
    for seed in (21, 22, 23, 24):
        scene = catalogue.build(f"gas:n=4,seed={seed}")
        ids = {str(c.id) for c in scene.circles}
        pairs = history(scene, (), 30)
        event = next(k for k, pair in enumerate(pairs) if k > 2 and set(pair) <= ids)
        yield Case(
            f"gas of 4, seed {seed}: event {event} missed", scene, Made((Skip(event),)), frozenset({MISSED, LAW}),
            event + 6, wrong | {PHANTOM},
        )  # fmt: skip
        event, (one, other) = next((k, p) for k, p in enumerate(pairs) if set(p) <= ids)
        for strength in (Fraction(1, 10), Fraction(1, 2**50)):
            fault = Invent(
                event, Fraction(1, 2**8) if strength > Fraction(1, 100) else Fraction(0), one, other, strength
            )
            size = "a real impulse" if strength > Fraction(1, 100) else "an impulse of 2**-50"
            yield Case(
                f"gas of 4, seed {seed}: a contact invented, {size}", scene, Made((fault,)),
                frozenset({PHANTOM, LAW} if strength > Fraction(1, 100) else {PHANTOM}), event + 4, wrong | {MISSED},
            )  # fmt: skip


OF_STEP = frozenset({STEP, LATENESS, OVERLAP, POSITIONS, INTEGRATOR, TUNNELLING})
NOT_OF_STEP = frozenset({INPUT, ARITHMETIC, FLIGHTS, IMPACTS, LAW, TIE, ITERATIONS})


def of_steps() -> Iterator[Case]:
    """Engines of steps, at steps that are too long: finer ones pass the event."""
    for margin, step in (("1/8", 1 / 4), ("1/16", 1 / 8)):
        scene = relay(20, round(Fraction(margin) * 2**20), far=16)
        yield Case(f"{scene.name}: steps of {step}", scene, Steps(step), OF_STEP, 3, NOT_OF_STEP)
    for offset, step in (("2 - 10**-4", 1 / 4), ("2 - 10**-5", 1 / 16)):
        name = f"aim at {offset}: flown through in steps of {step}"
        yield Case(name, aim(offset), Steps(step), OF_STEP | {MISSED}, 2, NOT_OF_STEP)
    for spec, engine, events in (
        ("near-tie:k=4,first=right", Steps(1 / 256), 4), ("near-tie:k=3,first=right", Steps(1 / 64), 4),
        ("gas:n=3,seed=2", Steps(1 / 32), 20), ("gas:n=4,seed=5", Steps(1 / 32), 20),
        ("near-tie:k=3", "pymunk:dt=1/64", 4), ("near-tie:k=3,first=right", "pymunk:dt=1/64", 4),
        ("gas:n=3,seed=2", "pymunk:dt=1/64", 20), ("gas:n=4,seed=5", "pymunk:dt=1/64", 20),
        ("rack:rows=2,gap=1/50", "pymunk:dt=1/16", 10),
    ):  # fmt: skip
        name = engine if isinstance(engine, str) else f"steps of {engine.step}"
        yield Case(f"{spec}: {name}", catalogue.build(spec), engine, OF_STEP, events, NOT_OF_STEP)


def of_steps_but_not_by_them() -> Iterator[Case]:
    """Engines of steps whose steps are short enough: the rounding of the input decides, or too few iterations do."""
    for offset, bits in (("1.999", 8), ("2 - 1/3000", 11), ("2 - 1/5000", 12)):
        name = f"aim at {offset}: steps, input of {bits} bits"
        yield Case(name, aim(offset), Steps(1 / 256, bits), frozenset({INPUT}), 2,
                   OF_STEP | {ARITHMETIC, FLIGHTS, IMPACTS, LAW, TIE, ITERATIONS})  # fmt: skip
    circles = [Circle(-3, 0, vx=1, id="a"), Circle(0, 0, id="b"), Circle(10, 0, id="c")]
    scene = Scene([*circles, Circle(10, "23/2", vy=-1, id="d")], name="who is first", until=12)
    for iterations in (2, 3):
        yield Case(f"who is first: steps, {iterations} iterations", scene, Steps(1 / 64, iterations=iterations),
                   frozenset({ITERATIONS}), None, OF_STEP | {INPUT, ARITHMETIC, FLIGHTS, IMPACTS, TIE})  # fmt: skip


def of_arithmetic() -> Iterator[Case]:
    """Truebreak's own engines on scenes that have only numbers of their bits: their input is not rounded."""
    for name, bits, seed in (
        ("rounded:bits=12", 12, 71),
        ("rounded:bits=16", 16, 72),
        ("single", 24, 73),
        ("double", 53, 74),
    ):
        scene = short(f"gas:n=5,seed={seed}", bits)
        yield Case(f"{scene.name}: {name}", scene, name, frozenset({FLIGHTS, IMPACTS}), 160,
                   frozenset({INPUT, LAW, TIE, MISSED, PHANTOM}), ((INPUT, 0.0, 0.02),))  # fmt: skip


def short(spec: str, bits: int) -> Scene:
    """A scene of the catalogue with every number rounded to so many bits."""
    scene = rounded_scene(catalogue.build(spec), bits)
    return scene.with_changes(name=f"{spec} in {bits} bits", until=None, events=None)


def triple(mass: str) -> Scene:
    """Two discs meet a third from both sides at one exact instant, 7/5; no binary number is where they start."""
    circles = [Circle("-17/5", 0, vx=1, id="l"), Circle(0, 0, id="m"), Circle("31/5", 0, vx=-3, m=mass, id="r")]
    return Scene(circles, name=f"triple, mass {mass}")


def of_ties() -> Iterator[Case]:
    """Simultaneous contacts: resolved by another policy, or split by the rounding of the input."""
    for spec in ("lee", "rack:rows=2", "inscribed:n=3"):
        scene = catalogue.build(spec)
        never = AIMED - {LAW} | {INPUT}
        if ExactEngine().run(scene, events=2).events[-1].coupled or spec != "inscribed:n=3":
            yield Case(f"{spec}: another policy", scene, OtherPolicy(), frozenset({TIE}), 8, never)
    for mass in ("4", "9"):
        yield Case(
            f"triple, mass {mass}: another policy", triple(mass), OtherPolicy(), frozenset({TIE}), 4, AIMED | {INPUT}
        )
    for mass, bits in (("4", 24), ("4", 53), ("9", 11), ("2", 30)):
        yield Case(f"triple, mass {mass}: split by {bits} bits of the input", triple(mass), RoundedExact(bits),
                   frozenset({INPUT}), 4, frozenset({TIE, LAW, ARITHMETIC, FLIGHTS, IMPACTS}))  # fmt: skip


# -- engines with several faults: known is the one without which the engine comes to the reference's history


def without(name: str, scene: Scene, engine: Any, repaired: dict[str, Any], events: int, *never: str) -> Case | None:
    """A case of an engine with several faults, of which just one kind decides; None where that is not so.

    Args:
        repaired: for each kind of fault, the engine without it.
        never: further kinds that must not be said to be enough.
    """

    def agrees(made: Any) -> bool:
        return compare(scene, [made], events=events, causes=False).candidates[0].verdict == "agree"

    if agrees(engine):
        return None
    enough = {kind for kind, other in repaired.items() if agrees(other)}
    if ARITHMETIC in enough and all(agrees(replace(engine, step=engine.step / 2**k)) for k in (3, 4)):
        return None  # finer steps pass, by chance or not
    if len(enough) != 1:
        return None
    (kind,) = enough
    main = {STEP: OF_STEP, ARITHMETIC: OF_ARITHMETIC}.get(kind, frozenset({kind}))
    wrong = {INPUT, LAW, TIE, PHANTOM, ITERATIONS, STEP, ARITHMETIC, FLIGHTS, IMPACTS}
    return Case(name, scene, engine, main, events, frozenset(wrong - main) | {*never})


def slanted(offset: Fraction, speed: int = 1) -> Scene:
    """A disc flies past another at a slant, so that every step rounds its place: least gap offset - 2, about."""
    c, s = SLOPE
    start = [c * -8 - s * offset, s * -8 + c * offset]
    circles = [Circle(str(start[0]), str(start[1]), 1, str(speed * c), str(speed * s), id="a"), Circle(0, 0, id="b")]
    return Scene(circles, name=f"slanted, {float(offset - 2):.3g}")


def of_several_faults() -> Iterator[Case]:
    """Engines of steps that round to few bits as well, push apart, or iterate too little: one of these decides."""
    tried: list[tuple[str, Scene, Steps, dict[str, Any], int]] = []
    for bits, step, margin in (
        (12, 1 / 256, Fraction(-1, 2**8)), (16, 1 / 512, Fraction(1, 2**13)), (14, 1 / 512, Fraction(-1, 2**11)),
        (24, 1 / 4, Fraction(-1, 2**6)), (24, 1 / 2, Fraction(-1, 2**5)), (20, 1 / 8, Fraction(-1, 2**9)),
    ):  # fmt: skip
        scene = rounded_scene(slanted(2 + margin), bits)
        made = Steps(step, bits, rounds=True)
        exact, fine = replace(made, rounds=False), replace(made, step=step / 256)
        tried.append(
            (f"{scene.name}, steps of {step:.3g}, {bits} bits", scene, made, {ARITHMETIC: exact, STEP: fine}, 2)
        )
    for parts, step, margin in ((1.0, 1 / 16, 40), (4.0, 1 / 64, -60), (8.0, 1 / 64, 90), (2.0, 1 / 32, -120)):
        for sign in (1, -1):
            scene = relay(24, sign * margin * 2**10, far=16)
            made = Steps(step, parts=parts)
            repaired = {POSITIONS: replace(made, parts=0.0)}
            tried.append((f"{scene.name}, steps of {step:.3g}, pushed apart by {parts}", scene, made, repaired, 3))
    for name, scene, made, repaired, events in tried:
        known = without(name, scene, made, repaired, events)
        if known is None:
            continue
        if POSITIONS in known.main:  # a finer step pushes less
            known = replace(known, main=OF_STEP, never=known.never - {STEP})
        yield known


def of_mixed_contacts() -> Iterator[Case]:
    """Contacts that are missed or invented where another error comes too, and laws beside rounding."""
    rounding = frozenset({INPUT, ARITHMETIC, FLIGHTS, IMPACTS})
    for seed in (31, 32, 33, 34, 35, 36):
        scene = catalogue.build(f"gas:n=4,seed={seed}")
        ids = {str(c.id) for c in scene.circles}
        pairs = history(scene, (), 30)
        event = next(k for k, pair in enumerate(pairs) if k > 8 and set(pair) <= ids)
        yield Case(
            f"gas of 4, seed {seed}: event {event} missed", scene, Made((Skip(event),)),
            frozenset({MISSED, LAW}), event + 6, rounding | {TIE, PHANTOM},
        )  # fmt: skip
        event = next(k for k, pair in enumerate(pairs) if k > 1 and set(pair) <= ids)
        off = WAY[0] / 2**10, WAY[1] / 2**10
        faults = Invent(event, Fraction(0), *pairs[event], Fraction(1, 2**50)), Kick(event + 3, pairs[event][0], off)
        yield Case(
            f"gas of 4, seed {seed}: an impulse of 2**-50, then a real one that is off", scene, Made(faults),
            frozenset({PHANTOM}), event + 6, rounding | {TIE, MISSED, LAW},
        )  # fmt: skip
        lossy = Made((Rounded(16), Always(Fraction(99, 100))), 16)
        yield Case(f"gas of 4, seed {seed}: restitution 0.99 in 16 bits", scene, lossy, frozenset({LAW}), 80, rounding)


def of_other_ties() -> Iterator[Case]:
    """Ties that the rounding of the input splits, and lasting contacts that it opens."""
    for mass, bits in (("3", 16), ("5", 20), ("7", 24), ("3/2", 30), ("10", 53), ("1/3", 53)):
        yield Case(
            f"triple, mass {mass}: split by {bits} bits", triple(mass), RoundedExact(bits), frozenset({INPUT}), 4,
            frozenset({TIE, LAW, ARITHMETIC, FLIGHTS, IMPACTS}),
        )  # fmt: skip
    for mass in ("3", "5", "7"):
        yield Case(
            f"triple, mass {mass}: in another order", triple(mass), OtherPolicy(), frozenset({TIE}), 4, AIMED | {INPUT}
        )
    for depth, bits in ((12, 11), (26, 24), (40, 24), (60, 53)):
        circles = [Circle(0, f"2-1/2**{depth}", vx=1, id="b"), Circle(4, 2, id="d")]
        scene = Scene(circles, [Wall(0, 3, 1, 3, id="w")], name=f"struck 2**-{depth} below its centre")
        yield Case(f"{scene.name}, {bits} bits", scene, RoundedExact(bits), frozenset({INPUT}), 8,
                   frozenset({LAW, PHANTOM, TIE, ARITHMETIC, FLIGHTS, IMPACTS}))  # fmt: skip


FAMILIES: dict[str, Callable[[], Iterator[Case]]] = {
    "input": of_input,
    "one kind": of_one_kind,
    "two kinds": of_two_kinds,
    "input and arithmetic": of_input_and_arithmetic,
    "gases": gases,
    "every event": of_every_event,
    "law": of_law,
    "contacts": of_contacts,
    "steps": of_steps,
    "not of steps": of_steps_but_not_by_them,
    "own engines": of_arithmetic,
    "ties": of_ties,
    "several faults": of_several_faults,
    "mixed contacts": of_mixed_contacts,
    "other ties": of_other_ties,
}


def _parts(name: str, said: Any) -> tuple[str, ...]:
    """The kinds that a cause stands for, the largest first."""
    of = [s for s in said.shares if s.kind in (FLIGHTS, IMPACTS)]
    return tuple(s.kind for s in sorted(of, key=lambda s: -(s.share or 0.0))) if name == ARITHMETIC and of else (name,)


def complaints(known: Case) -> list[str]:
    """What is wrong with what a comparison says of a case; empty if nothing is."""
    engine = engine_named(known.engine) if isinstance(known.engine, str) else known.engine
    limits = {} if known.events is None else {"events": known.events}
    candidate = compare(known.scene, [engine], **limits).candidates[0]
    if candidate.alignment.divergence is None or candidate.diagnosis is None:
        return [f"it is said to {candidate.verdict}"]
    said = said_of(candidate)
    whole = frozenset({FLIGHTS, IMPACTS})
    coarse = any(s.kind == ARITHMETIC for s in said.shares)  # flights and impulses as one
    if not coarse:  # the sum is named, and its parts are in the account
        said = replace(said, causes=tuple(kind for name in said.causes for kind in _parts(name, said)))

    def merged(kinds: Iterable[str]) -> set[str]:
        return {ARITHMETIC if coarse and kind in whole else kind for kind in kinds}

    wrong: list[str] = []
    first = said.causes[0] if said.causes else UNKNOWN
    if first not in merged(known.main):
        wrong.append(f"it is {first}, and not {' or '.join(sorted(known.main))}")
    false = (known.never if not coarse else known.never - whole) & (said.suffices | {first})
    if false and len(known.all_of) < 2:
        wrong.append(f"{', '.join(sorted(false))}: is not enough by itself")
    elif false & said.suffices:
        wrong.append(f"{', '.join(sorted(false & said.suffices))}: is not enough by itself")
    if missing := merged(known.all_of) - set(said.causes):
        wrong.append(f"{', '.join(sorted(missing))}: not named, and nothing is enough without it")
    expected: dict[str, list[float]] = {}
    for kind, share, room in known.shares:
        entry = expected.setdefault(ARITHMETIC if coarse and kind in whole else kind, [0.0, 0.0])
        entry[0], entry[1] = entry[0] + share, entry[1] + room
    if known.shares:
        most = max(room for _, room in expected.values())
        told = dict.fromkeys(expected, 0.0)
        for s in said.shares:
            told[s.kind] = told.get(s.kind, 0.0) + (s.share or 0.0)
        for kind, share in told.items():
            if kind not in expected and math.fsum(want for want, _ in expected.values()) < 0.5:
                continue  # only what is not of it is known
            want, room = expected.get(kind, (0.0, most))
            if abs(share - want) > room:
                wrong.append(f"the share of {kind} is {share:.3g}, and not {want:.3g} +/- {room:.2g}")
        if said.closed is False:
            wrong.append("the account does not close")
    wrong += [f"{r.claim} ({r.rule}): {r.because}" for r in refute(known.scene, engine, candidate, said)]
    return wrong


def main(arguments: list[str]) -> int:
    """Judges what comparisons say of the cases of some families, or of all; exits with 1 where one is wrong."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("families", nargs="*", help=", ".join(FAMILIES))
    parser.add_argument("--only", default="", help="text in the name of a case")
    given = parser.parse_args(arguments)
    right = count = 0
    for family in given.families or FAMILIES:
        for known in FAMILIES[family]():
            if given.only in known.name:
                wrong = complaints(known)
                count, right = count + 1, right + (not wrong)
                print(f"{'right' if not wrong else 'WRONG'}  [{family}] {known.name}", flush=True)
                for line in wrong:
                    print(f"         {line}", flush=True)
    print(f"{right} of {count} right")
    return 0 if right == count else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
