"""What the first difference of two runs says of its cause; and when it does not say enough."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING

from .growing import NEVER, Difference, GrowthRate, LogDigits, Unit, rate_of

if TYPE_CHECKING:
    from .log_format import LogRecord
    from .sides import Found, OtherPartner


class Finding(Enum):
    """The six verdicts; the value is how the first line of a report begins."""

    IDENTICAL = "identical"
    HARMLESS = "harmless order"
    GREW = "grew from rounding at event {k}"
    CHANGED = "changed at event {k} by more than rounding"
    START = "different from the start"
    OPEN = "not determined"


@dataclass(frozen=True)
class Thresholds:
    """Sizes of a first difference, in bits above one ulp, in one number type.

    Up to the first number of each pair it is rounding, from the second on it is none, between them it may be either.
    They lie on both sides of what the trials show (docs/desync.md).

    Attributes:
        start: in the first record that both have, which no solver has touched.
        free: of a body that is in contact with nothing.
        touching: of a body in contact, which a solver has passed on from others, or where contacts are not logged.
    """

    start: tuple[float, float]
    free: tuple[float, float]
    touching: tuple[float, float]


DOUBLES = Thresholds(start=(4, 10), free=(6, 14), touching=(8, 20))
FLOATS = Thresholds(start=(4, 8), free=(5, 10), touching=(6, 13))

SETTLED = 40
"""Contacts that are the same to the last bit in both, after which a build that rounds otherwise had shown itself."""

NEAR_START = 8
"""Steps from the first record to the second up to which a difference in most bodies is one of the start: a change in
one of them has not come to most by then."""

PER_STEP = 1.0
"""Bits by which a difference may grow in a step that was not logged, where the log does not tell more."""

SHIFTED = 20.0
"""Bits of improbability from which other partners are no matter of chance, in a log of events."""


@dataclass(frozen=True)
class Verdict:
    """What is said of two runs.

    Attributes:
        name: which of the six.
        event: k: the step, in logs with steps, else the number of the event, from 0; None where there is none.
        why: what that rests on, in a sentence.
        spread: where the first difference is: "everywhere at once", "in one body", ...; None without one.
        first: the first difference of states, and those of the same record.
        rate: how it grew.
        notes: what else is to be known, a sentence each.
    """

    name: Finding
    event: int | None
    why: str
    spread: str | None = None
    first: tuple[Difference, ...] = ()
    rate: GrowthRate | None = None
    notes: tuple[str, ...] = field(default=())

    @property
    def line(self) -> str:
        """The verdict as the first line of a report has it.

        >>> Verdict(Finding.GREW, 12, "").line
        'grew from rounding at event 12'
        """
        return self.name.value.format(k=self.event)

    @property
    def same(self) -> bool:
        """Whether nothing is different that matters."""
        return self.name in (Finding.IDENTICAL, Finding.HARMLESS)


def decide(found: Found) -> Verdict:
    """The verdict of two logs that have been read."""
    growing = found.growing
    notes = tuple(_notes(found))
    if not growing.early:
        name, event, why = _gone(found, None) or _without_states(found)
        return Verdict(name, event, why, notes=notes)
    number = min(d.number for d in growing.early)
    gone = _gone(found, number)
    if gone is not None:
        return Verdict(*gone, notes=notes)
    first = tuple(sorted((d for d in growing.early if d.number == number), key=lambda d: -d.bits))
    rate = rate_of(growing.whole, growing.unit)
    name, event, why = _with_states(found, first, rate)
    return Verdict(name, event, why, _spread(found, first), first, rate, notes)


Answer = tuple[Finding, int | None, str]


def _gone(found: Found, number: int | None) -> Answer | None:
    """Where a body is in one run alone from some record on, before any number differs; None where that is not so.

    Args:
        number: of the record in which numbers differ first.
    """
    if found.uneven is None or found.by != "step":
        return None
    side, record, body, pairs, row = found.uneven
    lies = found.final[side].get(body) == row  # and never moves again: it may be asleep, and not logged
    begun = [] if number is None else [number]
    begun += [found.meeting.number] if found.meeting is not None else []
    begun += [found.hash[0].number] if found.hash is not None else []
    again = found.growing.same_at.get(body, -1) >= record.number or (
        not found.all_told and any(d.body == body and d.number >= record.number for d in found.growing.early)
    )
    touching = any(body in p for p in record.contacts)
    if lies or (begun and min(begun) < record.number) or again or pairs < 4 or (touching and not found.all_told):
        return None
    fed = found.input[0] if found.input is not None else record
    first = fed if fed.number < record.number else record
    return Finding.CHANGED, _event(first), (
        f"{body} is in {(found.a, found.b)[side].name} alone, from {record.place()} on; up to then everything is "
        f"{_as_before(found)}"
    )  # fmt: skip


def _as_before(found: Found) -> str:
    """What two runs were before they parted."""
    return "the same but for the digits that one log leaves out" if found.explained else "the same to the last bit"


def _event(at: LogRecord | Difference | OtherPartner) -> int:
    return at.step if at.step is not None else at.number


def _without_states(found: Found) -> Answer:
    """Where no number of any body differs."""
    meeting = found.meeting
    states = found.compared["states"]
    if found.hash is not None:
        k = _event(found.hash[0])
        since = "" if found.hash_same is None else "; all hashes before it are the same"
        if states:
            return Finding.OPEN, k, (
                f"hashes differ from {found.hash[0].place()} on, though all states that are logged are the same: "
                "what is hashed has something in it that is not logged (a random state, a cache of the solver, padding)"
            )  # fmt: skip
        return Finding.OPEN, k, (
            f"hashes differ from {found.hash[0].place()} on{since}. A hash does not show how much differs: log states "
            "from a few steps before it to a few after it"
        )  # fmt: skip
    if meeting is not None and not (states and 0 in found.contacts):
        return _partners_alone(found)
    if found.input is not None:
        return Finding.OPEN, _event(found.input[0]), (
            f"inputs differ first at {found.input[0].place()}, and nothing else that is logged does"
        )  # fmt: skip
    gone = _incomplete(found)
    if gone:
        return Finding.OPEN, None, f"all that both logs have is the same, but {gone}"
    if found.explained:
        return Finding.OPEN, None, f"{_fewer(found)}, and no difference but what that makes: log both alike"
    if found.times_differ is not None:
        a, b = found.times_differ
        return Finding.OPEN, _event(a), (
            f"all states and contacts are the same, but clocks are not: {a.time!r} and {b.time!r} at {a.place()} "
            "(--ignore time, if that is a clock on the wall)"
        )  # fmt: skip
    if found.fields:
        name, (record, one, other) = next(iter(found.fields.items()))
        return Finding.OPEN, _event(record), (
            f"states, contacts and hashes are the same, but {name!r} is not, first at {record.place()}: "
            f"{_short(one)} and {_short(other)} (--ignore {name}, if that is no part of the run)"
        )  # fmt: skip
    if found.fields_alone:
        name, (side, record) = next(iter(found.fields_alone.items()))
        return Finding.OPEN, _event(record), (
            f"states, contacts and hashes are the same, but {(found.a, found.b)[side].name} alone has {name!r}, first "
            f"at {record.place()} (--ignore {name}, if that is no part of the run)"
        )  # fmt: skip
    if found.zeros is not None:
        return Finding.OPEN, _event(found.zeros), (
            f"nothing differs but signs of zeros, first at {found.zeros.place()}: -0 and 0 are equal, and have other "
            "bits; some writers (JSON in JavaScript) leave the sign out"
        )  # fmt: skip
    if found.reordered is not None and found.grid and not found.compared["states"] + found.compared["hashes"]:
        return Finding.OPEN, None, (
            f"contacts are the same, but come in another order, first at event {found.reordered[0]}; whether that "
            "changed anything, contacts alone do not show: log states"
        )  # fmt: skip
    if found.reordered is not None:
        return Finding.HARMLESS, None, (
            f"for each body the same in both, to the last bit; independent events come in another order, first at "
            f"event {found.reordered[0]}"
        )  # fmt: skip
    if not found.pairs:
        return Finding.OPEN, None, "no record of the one log has its like in the other"
    return Finding.IDENTICAL, None, f"{_what(found)} the same to the last bit"


def _partners_alone(found: Found) -> Answer:
    """Where bodies meet others, and no number differed before."""
    meeting = found.meeting
    assert meeting is not None
    k = _event(meeting)
    told = f"{meeting.body} meets {meeting.a or 'nobody'} in the one and {meeting.b or 'nobody'} in the other"
    if found.by == "step":
        if found.compared["states"]:
            return Finding.OPEN, k, f"{told}, and all states that are logged are the same, then and after"
        return Finding.OPEN, k, f"{told}; contacts alone do not show how far apart the runs were by then: log states"
    if found.tie:
        return Finding.OPEN, k, (
            f"{told}, at one instant but for rounding: a tie that each resolves in its own order, or two names for one"
        )  # fmt: skip
    if not found.compared["states"] and found.grid:
        return Finding.OPEN, k, f"{told}; times of steps do not show how far apart the runs were by then: log states"
    if found.pairs < 2 or (not found.compared["states"] and (meeting.number < 2 or found.pairs < 4)):
        return Finding.OPEN, k, f"{told}, and there is too little before it to show whether the start was the same"
    if found.explained:
        return Finding.OPEN, k, f"{told}; {_fewer(found)}, so that a difference before is not seen: log both alike"
    return Finding.CHANGED, k, f"{told}, and up to then everything is the same to the last bit"


def _fewer(found: Found) -> str:
    """Which log has fewer digits than the other."""
    coarse = next(c for u in (found.growing.unit, found.time_unit) if (c := u.coarse) and c.side is not None)
    return f"{(found.a, found.b)[coarse.side or 0].name} has {coarse.words}, the other has more"


def _incomplete(found: Found) -> str | None:
    """What a log lacks, in words; None if nothing is known to be missing."""
    logs = {"a": found.a, "b": found.b}
    for side, log in logs.items():
        if log.cut is not None:
            return f"{log.name} is cut off in line {log.cut}"
        repeats = [line for which, line in found.repeated if which == side]
        if repeats:
            return f"line {repeats[0]} of {log.name} repeats the one before it"
    thinned = found.by == "step" and _thinned(found) is not None
    for side, first in enumerate(found.alone_first):
        if first is not None and first.number == 0 and not thinned:
            return f"{logs['ba'[side]].name} begins later, and has nothing for {first.place()} of the other"
    if found.missing and not thinned:
        side, place = found.missing[0]
        return f"{logs[side].name} has nothing for {place} of the other: was a line lost, or a contact without effect?"
    if found.longer is not None:
        ended = logs["b" if found.longer == "a" else "a"]
        last = f", after {found.last_common.place()}" if found.last_common else ""
        return f"{ended.name} ends before the other{last}: the rest cannot be compared"
    if found.uneven is not None:
        side, record, body, *_ = found.uneven
        return (
            f"{(found.b, found.a)[side].name} has no state of {body} at {record.place()} of the other: was it not "
            "logged, or not there?"
        )
    alone = found.alone_first
    for side, first in enumerate(alone):
        if first is not None and found.pairs and not thinned and found.alone[side] <= max(1, found.pairs // 20):
            return f"{(found.b, found.a)[side].name} has nothing for {first.place()} of the other: were lines lost?"
    if alone[0] is not None and alone[1] is not None and found.pairs and not thinned:
        return f"each has records that the other has not, first {alone[0].place()}"
    ends = found.a.end, found.b.end
    if ends[0] is not None and ends[1] is not None and ends[0] != ends[1] and not found.clock:
        return f"the one says that it ends at {ends[0]!r} and the other at {ends[1]!r}"
    return None


def _thinned(found: Found) -> tuple[int, int] | None:
    """Which log has every so many steps of the other's alone, and how many; None if neither has."""
    strides = [log.counted.stride for log in (found.a, found.b)]
    for side in (0, 1):
        own, other = strides[side], strides[1 - side]
        if other and own > other and own % other == 0 and found.alone[1 - side] >= found.pairs - 1:
            return None if found.alone[side] else (side, own)
    return None


def _with_states(found: Found, first: tuple[Difference, ...], rate: GrowthRate | None) -> Answer:
    """Where numbers differ."""
    top = first[0]
    if found.names and found.uneven is not None and found.uneven[1].number == found.first_states:
        return Finding.OPEN, _event(top), (
            f"{_size(top)}; but ids differ, and {found.uneven[2]} starts like none in the other log; name bodies alike"
        )  # fmt: skip
    unit = _unit_of(found, top)
    if unit.coarse is not None:
        return _coarse(found, first, unit.coarse)
    limits = FLOATS if unit.bits <= 24 else DOUBLES
    size = _size(top)
    if top.name == TIME and found.grid:
        return (
            Finding.OPEN,
            _event(top),
            f"{size}; times of steps do not show how far apart the runs were by then: log states",
        )
    start = _start(found, first, limits, size)
    if start is not None and start[0] is Finding.START and _alone(found, first):
        return Finding.OPEN, start[1], (
            f"{size}, and from the next record on all states are the same to the last bit: was that logged right?"
        )  # fmt: skip
    if start is not None:
        return start
    onset, gap = _onset(found, top)
    others = [record for record in found.alone_first if record is not None]
    since_start = gap > 1 and top.number - top.gap == found.first_states
    if since_start and others and min(record.number for record in others) < top.number and top.bits >= limits.free[0]:
        return Finding.OPEN, onset, (
            f"{size}, and since the start no records are of the same step or time, first {others[0].place()}: another "
            "step or setting, or a change since? Log both alike, and every step"
        )  # fmt: skip
    allowance = _allowance(found, gap, rate)
    if allowance is None:
        what = "records are far apart; log states of every step"
        if found.by == "body":
            what = "how many steps lie between records is not logged; log the step, or states with each contact"
        return Finding.OPEN, onset, (
            f"{size}, but it may be of any age: the first record that has it has all of it, and {what}"
        )  # fmt: skip
    free = not top.touching and found.contacts_each and found.by == "step" and gap <= 1
    low, high = limits.free if free else limits.touching
    if top.bits >= high + allowance:
        return _large(found, first, onset, size)
    if top.bits > low + min(allowance, 2.0):
        return Finding.OPEN, onset, f"{size}: more than one rounding, and less than is sure to be none"
    return _small(found, first, onset, size)


def _size(d: Difference) -> str:
    """How large a first difference is, in words."""
    if d.bits == math.inf:
        return f"{d.name} of {d.body} is {d.a!r} in the one and {d.b!r} in the other"
    ulps = 2.0**d.bits
    told = "less than one ulp" if ulps < 0.75 else "one ulp" if ulps < 1.5 else f"{ulps:.3g} ulps"
    return f"the first difference is {abs(d.a - d.b):.3g} in {d.name} of {d.body}, {told} of the largest such number"


def _alone(found: Found, first: tuple[Difference, ...]) -> bool:
    """Whether nothing differs but in one record, though each body of it is told again: no run has another start so."""
    growing, number = found.growing, first[0].number
    return not growing.off and not growing.sated and all(d.number == number for d in growing.early)


def _start(found: Found, first: tuple[Difference, ...], limits: Thresholds, size: str) -> Answer | None:
    """Where the first records differ already; None if they do not."""
    growing, top, k = found.growing, first[0], _event(first[0])
    bodies, most = _many(found, first), len(first) * 2 > growing.known
    if top.number == found.first_states and all(d.fresh for d in first) and not top.touching:
        size = f"{size}, in the first record that both have"
        if top.bits >= limits.start[1]:
            return Finding.START, k, f"{size} ({bodies})"
        if top.bits > limits.start[0]:
            return Finding.OPEN, k, f"{size}: another start, or one computed otherwise?"
        return _small(found, first, k, size)
    begun = min([top.number, *(pair[0].number for pair in (found.hash, found.input) if pair is not None)])
    early = found.first_states is not None and begun <= found.first_states + 1
    stride = _stride(found) or 1
    if early and most and top.bits >= limits.free[0] and stride > NEAR_START and top.gap >= 1:
        return Finding.OPEN, k, (
            f"{size}, in {bodies}, and nothing is logged of the {stride} steps between the start and there: another "
            "start, or a change since? Log states of every step"
        )  # fmt: skip
    if early and most and top.bits >= limits.free[0]:
        if top.bits < limits.free[1]:
            return Finding.OPEN, k, f"{size}, in the first step ({bodies}): a setting, or rounding?"
        return Finding.START, k, f"{size}, in the first step ({bodies}): another setting, step or build"
    if early and top.bits >= limits.touching[1] and not growing.same_again:
        return Finding.START, k, f"{size}, and no body is the same in any record after the first"
    since_start = top.gap > 1 and top.number - top.gap == found.first_states and begun == top.number
    if since_start and not top.placed and found.touched_told and top.bits >= limits.touching[1]:
        if not growing.same_again:
            return Finding.START, k, f"{size}, and no body is the same in any record after the first"
        return Finding.OPEN, k, (
            f"{size}, and nothing is logged of {top.body} between the start and there, so that it may have been "
            "acted on at any time: log states of every step"
        )  # fmt: skip
    if found.by == "body" and any(d.fresh and not d.placed for d in first):
        top = next(d for d in first if d.fresh and not d.placed)
        if top.bits < limits.touching[1]:
            return None
        if top.number < max(3, growing.known) and all(
            d.fresh for d in first if d.body in found.final[0] or not found.final[0]
        ):
            return Finding.START, _event(top), (
                f"{size}, and that is the first that is logged of {top.body}: it came there at another time or place"
            )  # fmt: skip
        return Finding.OPEN, _event(top), (
            f"{size}, and nothing is logged of {top.body} before: it may have started elsewhere, or been moved since; "
            "log states at the start"
        )  # fmt: skip
    return None


def _onset(found: Found, top: Difference) -> tuple[int, int]:
    """The event from which on something differs, and records from there to the first difference of states."""
    earlier = [pair[0] for pair in (found.hash, found.input) if pair is not None and pair[0].number < top.number]
    if earlier:
        record = min(earlier, key=lambda r: r.number)
        return _event(record), top.number - record.number + 1
    return _event(top), max(1, top.gap)


def _allowance(found: Found, gap: int, rate: GrowthRate | None) -> float | None:
    """Bits by which rounding may have grown unseen before the first difference; None if nobody knows."""
    stride = _stride(found)
    if found.touched_told and (found.by == "body" or stride == 1):
        return 0.0  # whatever happens to a body is in a record of its own
    if stride is None:
        stride = 1 if rate is not None else 64
    unseen = gap * stride - 1
    if unseen <= 0:
        return 0.0
    grown = PER_STEP * unseen
    if rate is not None:
        grown = max(0.0, rate.bits_per_record + 2 * rate.record_error) * gap
    if grown > found.growing.unit.whole / 2:
        return None
    return grown


def _stride(found: Found) -> int | None:
    """Steps from record to record; None where there are no steps."""
    if found.by != "step":
        return None
    return max(found.a.counted.stride, found.b.counted.stride, 1)


def _large(found: Found, first: tuple[Difference, ...], onset: int, size: str) -> Answer:
    """A first difference that is no rounding."""
    if found.tie and found.meeting is not None and found.meeting.number <= first[0].number:
        return (
            Finding.OPEN,
            onset,
            "simultaneous contacts were resolved in another order, and rounding may decide that",
        )
    since = f"; up to then everything is {_as_before(found)}"
    if found.input is not None and _event(found.input[0]) <= onset:
        return Finding.CHANGED, onset, f"{size}; the inputs differ, first at {found.input[0].place()}"
    return Finding.CHANGED, onset, size + since


def _small(found: Found, first: tuple[Difference, ...], onset: int, size: str) -> Answer:
    """A first difference as small as rounding: how it went on decides."""
    growing, top = found.growing, first[0]
    later = [d for d in growing.leaps if d.number > top.number and _allowance(found, 1, None) == 0.0]
    free = [d for d in later if not d.touching and found.contacts_each and found.by == "step" and d.gap <= 1]
    if top.number == found.first_states and top.fresh and not free:
        later = []  # that the start was another explains what leaps there are: contacts that come a step earlier
    if later:
        leap = min(later, key=lambda d: d.number)
        leapt = f"{leap.body} leaps from {_bits(leap.before)} to {_bits(leap.bits)} at {_place(leap)}"
        told = f"{leapt}, where rounding had brought nothing"
        limits = FLOATS if growing.unit.bits <= 24 else DOUBLES
        if leap in free and leap.bits >= limits.free[1] + 4:
            why = f"runs were off by rounding before, but {told}, and it touches nothing there"
            return Finding.CHANGED, _event(leap), why
        return Finding.OPEN, onset, f"{size}; but {told} near enough to decide that: a near tie, or a change"
    if found.by == "body" and found.meeting is not None:
        chance = max(found.meeting_off, 0.0) + math.log2(found.onsets_then + 1)
        if chance < growing.unit.whole - SHIFTED:
            m = found.meeting
            return Finding.OPEN, onset, (
                f"{size}; but {m.body} meets {m.a or 'nobody'} instead of {m.b or 'nobody'} at event {m.number}, when "
                f"nothing was off by more than {_bits(found.meeting_off)}: a near tie, or a change"
            )  # fmt: skip
    odd = ("the input", found.input[0]) if found.input is not None else found.field_leap
    if odd is not None:
        return Finding.OPEN, onset, f"{size}; but {odd[0]} differs by more than that, first at {odd[1].place()}"
    late = growing.contacts_before(top.number) >= SETTLED
    if late and len(first) >= 3 and len(first) * 2 >= growing.known:
        return Finding.OPEN, onset, (
            f"{size}: of the size of rounding, but in {_many(found, first)} at once, after all contacts before came "
            "out the same to the last bit: a cache or a setting that was lost, rather than arithmetic"
        )  # fmt: skip
    return Finding.GREW, onset, size


TIME = "time"
"""What a difference is of that is one of times, not of a state."""


def _unit_of(found: Found, d: Difference) -> Unit:
    """What a difference is measured in."""
    return found.time_unit if d.name == TIME and found.by == "body" else found.growing.unit


def _coarse(found: Found, first: tuple[Difference, ...], coarse: LogDigits) -> Answer:
    """Where the logs, or one of them, have fewer digits than the engines."""
    top, unit = first[0], _unit_of(found, first[0])
    scale = next(iter(unit.scales.get(TIME if unit is not found.growing.unit else None, ())), 0.0) or 1.0
    last = coarse.last(scale)
    onset, gap = _onset(found, top)
    if not abs(top.a - top.b) < COARSE * last and gap <= 1 and (_stride(found) or 1) == 1 and last < 1e-5 * scale:
        if found.first_states == top.number:
            return Finding.START, onset, f"{_size(top)}, in the first record that both have"
        if found.first_states == top.number - 1 and len(first) * 2 > found.growing.known:
            why = f"{_size(top)}, in the first step ({_many(found, first)}): another setting or step"
            return Finding.START, onset, why
        return Finding.CHANGED, onset, (
            f"{top.name} of {top.body} is {top.a!r} and {top.b!r}, {abs(top.a - top.b) / last:.3g} of the last digit "
            "that is logged, and was the same to all digits before"
        )  # fmt: skip
    log = "the logs have" if coarse.side is None else f"{(found.a, found.b)[coarse.side].name} has"
    short = coarse.digits is not None or coarse.decimals is not None
    what = (
        "log 17 digits"
        if short
        else "log all bits, if its engine has more; if not, the two compute in different numbers"
    )
    told = f"{log} {coarse.words}, so that nothing is seen of a difference before it is {last:.0e}: {what}"
    return Finding.OPEN, onset, told


COARSE = 2.0**12
"""How many of a log's last digits a first difference has to be, to have come at once."""


def _spread(found: Found, first: tuple[Difference, ...]) -> str:
    """Where the first difference is."""
    if len(first) * 2 > found.growing.known > 2:
        return f"everywhere at once ({_many(found, first)})"
    if len(first) == 1:
        return "in one body, in contact" if first[0].touching else "in one body, in contact with nothing"
    if len(first) == 2 and all(d.touching for d in first):
        return f"in one contact ({first[0].body} and {first[1].body})"
    return f"in {_many(found, first)}"


def _many(found: Found, first: tuple[Difference, ...]) -> str:
    return f"{len(first)} of {found.growing.known} bodies"


def _bits(bits: float) -> str:
    return "nothing" if bits == NEVER else "no number" if bits == math.inf else f"2**{max(bits, 0.0):.0f} ulps"


def _place(d: Difference) -> str:
    return f"step {d.step}" if d.step is not None else f"event {d.number}"


def _what(found: Found) -> str:
    """What was compared, in words."""
    names = [f"{count:,} {kind}" for kind in ("states", "contacts", "hashes") if (count := found.compared[kind])]
    names = names or [f"{found.compared['fields']:,} fields"]
    return f"{' and '.join([', '.join(names[:-1]), names[-1]] if len(names) > 1 else names)}:"


def _short(value: object) -> str:
    return str(value)[:40]


def _notes(found: Found) -> list[str]:
    """What else is to be known of the logs."""
    told: list[str] = []
    if found.names:
        pairs = list(found.names.items())
        shown = ", ".join(f"{ours} is {theirs}" for ours, theirs in pairs[:3])
        told.append(f"Ids differ: {shown}{f', and {len(pairs) - 3} more' if len(pairs) > 3 else ''} in {found.b.name}.")
    if found.clock:
        told.append(f"The clock of {found.b.name} is {found.clock:.9g} later throughout; that is not counted.")
    thinned = _thinned(found)
    if thinned is not None:
        side, stride = thinned
        log = (found.a, found.b)[side]
        told.append(f"{log.name} has a record every {stride} steps; those of the other between are not compared.")
    for side, log in enumerate((found.a, found.b)):
        if not found.contacts[side] and found.contacts[1 - side] and found.compared["states"]:
            told.append(f"{log.name} has no contacts; those of the other are not compared.")
        for line, before, after in log.counted.restarts[:2]:
            told.append(
                f"In line {line} of {log.name} the count goes from {before:.9g} back to {after:.9g}; it is counted on."
            )
    if found.zeros is not None and found.growing.early:
        told.append(f"Signs of zeros differ, too, first at {found.zeros.place()}.")
    if found.uneven is not None and found.growing.early:
        side, record, body, *_ = found.uneven
        told.append(f"{(found.a, found.b)[side].name} alone has the state of {body}, first at {record.place()}.")
    if found.nans is not None:
        told.append(f"Both have numbers that are none (NaN), first at {found.nans}.")
    settings = [
        f"{key} is {_short(found.a.header[key])} and {_short(found.b.header[key])}"
        for key in sorted(found.a.header.keys() & found.b.header.keys())
        if found.a.header[key] != found.b.header[key] and key != "fields"
    ]
    if settings:
        told.append(f"What the logs say of themselves differs: {', '.join(settings[:4])}.")
    return told
