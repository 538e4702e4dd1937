"""Holds a run of an engine against the referee: every time, contact, impulse, entry, state and the end."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import arb, fmpz  # type: ignore[attr-defined]

from fuzz.referee import FINE, Told, referee
from fuzz.table import Row, shifted
from truebreak.exact import ExactEngine
from truebreak.exact.numbers import ball
from truebreak.exact.replay.ball_state import BallState
from truebreak.exact.replay.centred_state import CentredState
from truebreak.exact.replay.state import Step
from truebreak.scenarios import Scene, Trajectory

AGREED, AGREED_FINE = 200, 460
"""Bits to which numbers agree, relative to 1 + the size: for plain scenes, and for those with flaws of 10**-100."""
GAVE_UP = ("UNDECIDED", "BUDGET")
STATES_ASKED = 6
"""Most events at which, and around which, the state is asked."""


class Difference(AssertionError):
    """The engine and its witness disagree."""


def expect(right: bool, message: str) -> None:
    """Raises `Difference` unless it is right."""
    if not right:
        raise Difference(message)


def check(scene: Scene, until: Any = None, events: int | None = None, engine: Any = None) -> str:
    """Runs engine and referee; the name of the engine's reason to stop.

    Raises:
        Difference: where they disagree.
        Doubt, TooLong: where the referee has nothing to say.
    """
    told = referee(scene, until, events)
    run = (engine or ExactEngine()).run(scene, until=until, events=events)
    compare(run, told)
    return run.stop.reason.name


def compare(run: Trajectory, told: Told, asked: int = STATES_ASKED) -> None:
    """Holds a run against the referee's history.

    Args:
        asked: at how many events, and around how many, the state is asked.

    Raises:
        Difference: where they disagree.
    """
    stop = run.stop.reason.name
    if stop not in GAVE_UP:
        expect(stop == told.stop, f"stops with {stop} ({run.stop.message}), not {told.stop}")
    else:
        told = cut(told, run)
    compare_events(run, told)
    compare_entries(run, told)
    compare_reversal(run, told)
    same_number(run.final_time, told.final_time, told, "final_time")
    same_state(run.final.circles, told.final, told, "final state")
    same_state(run.at(run.final_time).circles, told.final, told, "at(final_time)")
    compare_states(run, told, asked)
    expect(run.certified, "is not certified")


def cut(told: Told, run: Trajectory) -> Told:
    """The history up to the instant at which a run gave up, which must be a whole one.

    Instants may be closer than what is agreed: of those, the one with as many events and entries as the run has.
    """
    end = near(run.final_time, told)
    tolerance = allowed(told, end)
    last = [when for when, _ in told.knots if abs(when - end) <= tolerance]
    expect(bool(last), f"gave up at {float(run.final_time)}, which is no instant of its history")

    def counted(when: fmpz) -> tuple[int, int]:
        return sum(event.time <= when for event in told.events), sum(entry.time <= when for entry in told.entries)

    mine = len(run.events), len(run.pocketings)
    end = next((when for when in last if counted(when) == mine), last[-1])
    knots = tuple(knot for knot in told.knots if knot[0] <= end)
    reversal = told.reversal if told.reversal and told.reversal[1] <= end else None
    events = tuple(event for event in told.events if event.time <= end)
    entries = tuple(entry for entry in told.entries if entry.time <= end)
    left, entered = told.left[: len(events)], told.entered[: len(entries)]
    return Told(told.bits, events, entries, reversal, told.stop, knots[-1][0], knots, left, entered)


def compare_events(run: Trajectory, told: Told) -> None:
    """Times, contacts and impulses."""
    ids = run.scene.ids
    ordered = run.scene.tie_policy.name == "sequential"
    for mine, theirs in zip(run.events, told.events, strict=False):
        where = f"event {mine.index}, time {float(mine.time):.17g}"
        expect_same_time(mine.time, theirs.time, told, where)
        contacts = [(ids.index(a), ids.index(b)) for a, b in mine.contacts]
        names = [(ids[i], ids[j]) for i, j in sorted(theirs.contacts)]
        expect(
            contacts == sorted(theirs.contacts), f"{where}: contacts {[tuple(c) for c in mine.contacts]}, not {names}"
        )
        expect(mine.coupled or not theirs.coupled, f"{where}: the order of its impulses matters, and is said not to")
        impulses = [(ids.index(a), ids.index(b)) for a, b in mine.impulses]
        if not theirs.unique:
            continue
        same = impulses == list(theirs.impulses) if ordered else Counter(impulses) == Counter(theirs.impulses)
        pushes = [(ids[i], ids[j]) for i, j in theirs.impulses]
        expect(same, f"{where}: impulses {[tuple(c) for c in mine.impulses]}, not {pushes}")
    counts = len(run.events), len(told.events)
    if counts[0] < counts[1]:
        missing = told.events[counts[0]]
        names = [(ids[i], ids[j]) for i, j in sorted(missing.contacts)]
        raise Difference(f"event {counts[0]}, {names} at {shown(missing.time, told)}, is missing")
    expect(counts[0] == counts[1], f"{counts[0]} events, not {counts[1]}")


def compare_entries(run: Trajectory, told: Told) -> None:
    """Entries into pockets, in order."""
    circles, pockets = [c.id for c in run.scene.circles], [p.id for p in run.scene.pockets]
    mine = [(circles.index(p.circle), pockets.index(p.pocket)) for p in run.pocketings]
    entries = [(e.circle, e.pocket) for e in told.entries]
    if mine != entries:
        names = [(p.circle, p.pocket) for p in run.pocketings]
        theirs = [f"c{i + 1} p{k + 1}" for i, k in entries]
        raise Difference(f"pocketings {names}, not those of circle and pocket {theirs}")
    for index, (p, e) in enumerate(zip(run.pocketings, told.entries, strict=True)):
        expect_same_time(p.time, e.time, told, f"pocketing {index} of {p.circle}")


def compare_reversal(run: Trajectory, told: Told) -> None:
    """Whether, when and after how many events."""
    mine, theirs = run.reversal, told.reversal
    expect((mine is None) == (theirs is None), f"reversal {mine}, not {theirs and theirs[0]}")
    if mine is not None and theirs is not None:
        expect(mine.after == theirs[0], f"reversal after {mine.after} events, not {theirs[0]}")
        expect_same_time(mine.time, theirs[1], told, "reversal")


def compare_states(run: Trajectory, told: Told, most: int) -> None:
    """States asked at so many events, between them, just before and after them, and outside of the run."""
    knots = [knot[0] for knot in told.knots]
    own = [*zip(run.events, told.events, told.left, strict=False)][:most]
    for mine, theirs, left in [*own, *zip(run.pocketings[:2], told.entries, told.entered, strict=False)]:
        same_state(run.at(mine.time).circles, list(left), told, f"at({float(mine.time):.17g}) as its own time")
        text = rational(mine.time)
        if text is not None and _is_just(theirs.time, text, told.bits):
            same_state(run.at(text).circles, told.at(theirs.time), told, f"at({text!r})")
    if run.reversal is not None and told.reversal is not None:
        same_state(run.at(run.reversal.time).circles, told.at(told.reversal[1]), told, "at the reversal")
    asked = [*between(knots[: most + 1], told.bits)]
    if most == STATES_ASKED:
        asked += between(knots[STATES_ASKED:][-3:], told.bits)
    for text in sorted(set(asked)):
        value = Fraction(text)
        time = (fmpz(value.numerator) << told.bits) // value.denominator
        if not 0 <= time < told.final_time or any(abs(time - knot) < allowed(told, time) for knot in knots):
            continue
        same_state(run.at(text).circles, told.at(time), told, f"at({text!r})")
    same_state(run.at("0").circles, told.at(fmpz(0)), told, "at('0')")
    if most == STATES_ASKED:
        narrower_holds_wider(run)
    half = fmpz(1) << (told.bits - 1)
    beyond = str(int((told.final_time + half) >> told.bits) + 1)
    for text in ("-1/1000000", beyond):
        try:
            run.at(text)
        except ValueError:
            continue
        raise Difference(f"at({text!r}) is outside of the run and gives a state")


FEW_BITS = (64, 100, 200)
"""Precisions at which a log is replayed, each of which must hold what `MANY_BITS` tell."""
MANY_BITS = 1500


def narrower_holds_wider(run: Trajectory) -> None:
    """The instants of a log, replayed with few bits, hold those replayed with many: in balls, and in centred ones."""
    log = getattr(run.motion, "log", None)
    if log is None:
        return
    steps = log.steps[:40]
    wider = _instants(BallState, run.scene, steps, MANY_BITS)
    for make in (BallState, CentredState):
        for bits in FEW_BITS:
            for k, (few, many) in enumerate(zip(_instants(make, run.scene, steps, bits), wider, strict=True)):
                with ball.precision(2 * MANY_BITS):
                    apart = bool(few < many) or bool(few > many)
                told = f"step {k} of the log, {make.__name__}: {bits} bits and {MANY_BITS} tell different instants"
                expect(not apart, told)


def _instants(make: type[BallState], scene: Scene, steps: Iterable[Step], bits: int) -> list[arb]:
    with ball.precision(bits):
        state, found = make(scene), []
        for step in steps:
            state.do(step)
            found.append(state.instant)
    return found


def _is_just(time: fmpz, text: str, bits: int) -> bool:
    """Whether a time is the fraction to as many bits as the referee takes for zero, not 10**-250 beside it."""
    value = Fraction(text)
    return bool(abs(time - (fmpz(value.numerator) << bits) // value.denominator) < fmpz(1) << (bits * 3 // 10))


def between(knots: list[fmpz], bits: int) -> Iterable[str]:
    """Dyadic times halfway between two instants, a little and very little before and after each, and the last before
    it or at it."""
    scale, fine = 1 << 64, 1 << 170
    for first, second in pairwise(knots):
        a, b = int(first >> (bits - 64)), int(second >> (bits - 64))
        floor = int(second >> (bits - 170))
        yield str(Fraction(floor - 1, fine))
        yield str(Fraction(floor, fine))
        yield str(Fraction(int(first >> (bits - 170)) + 2, fine))
        if b - a > 1 << 20:
            yield str(Fraction((a + b) // 2, scale))
            yield str(Fraction(a + 3, scale))
            yield str(Fraction(b - 2, scale))


def rational(value: Any) -> str | None:
    """The text of the simple fraction that a number is beyond reasonable doubt; None if it is none."""
    ball = value.ball(900)
    if not ball.rad() < arb((1, -700)):
        return None
    number = Fraction(int(shifted(ball, 720)), 1 << 720)
    guess = number.limit_denominator(10**20)
    return str(guess) if abs(number - guess) < Fraction(1, 1 << 690) else None


# -- numbers


def shown(value: fmpz, told: Told) -> str:
    """A fixed-point number as a person reads it."""
    return told.number(value).str(20, radius=False)


def agreed_bits(told: Told) -> int:
    return AGREED if told.bits < FINE else AGREED_FINE


def allowed(told: Told, value: fmpz) -> fmpz:
    """The largest difference from a number that counts as none."""
    return ((fmpz(1) << told.bits) + abs(value)) >> agreed_bits(told)


def near(value: Any, told: Told) -> fmpz:
    """The middle of an enclosure of an exact number that is much narrower than the tolerance."""
    bits = work = agreed_bits(told) + 40
    while True:
        ball = value.ball(work)
        if ball.rad() <= (1 + abs(ball.mid())) * arb((1, -bits)):
            return shifted(ball, told.bits)
        work *= 2
        expect(work < 1 << 16, f"{float(value)} is not enclosed sharply enough by {work} bits")


def enclosed(mine: Any, theirs: fmpz, told: Told, where: str) -> None:
    """The enclosure at hand, and one of a few more bits, hold the number, up to the witness's own rounding."""
    rounding = arb((1, -(told.bits // 2)))
    stored = [mine.near] if isinstance(getattr(mine, "near", None), arb) else []
    for enclosure in [*stored, mine.ball(agreed_bits(told) + 40)]:
        off = abs(told.number(theirs) - enclosure.mid())
        least = (off - enclosure.rad() - rounding * (1 + off + abs(enclosure.mid()))).lower()
        expect(not least > 0, f"{where}: {enclosure.str(20)} does not hold {shown(theirs, told)}")


def expect_same_time(mine: Any, theirs: fmpz, told: Told, where: str) -> None:
    """Times that differ say by how much."""
    enclosed(mine, theirs, told, where)
    off = near(mine, told) - theirs
    expect(abs(off) <= allowed(told, theirs), f"{where}: time off by {shown(off, told)} from {shown(theirs, told)}")


def same_number(mine: Any, theirs: fmpz, told: Told, where: str) -> None:
    """Two numbers are the same."""
    enclosed(mine, theirs, told, where)
    value = near(mine, told)
    expect(abs(value - theirs) <= allowed(told, theirs), f"{where} is {shown(value, told)}, not {shown(theirs, told)}")


def same_state(mine: Iterable[Any], theirs: list[Row], told: Told, where: str) -> None:
    """Two states of all circles are the same."""
    for circle, row in zip(mine, theirs, strict=True):
        for key, value in zip(("x", "y", "vx", "vy"), row, strict=True):
            same_number(getattr(circle, key), value, told, f"{where}: {circle.id}.{key}")
