"""Two logs read side by side: steps by number, events by body, so that independent events may come in any order."""

from __future__ import annotations

import math
from collections import deque
from pathlib import Path

from .growing import NEVER, Growing, unit_of, unit_of_times
from .log_format import LogRecord
from .record_pairs import BySteps, RecordPairs
from .sides import Found, Side, all_told, grid, touched_told, two_sides

WAITING, MOST_LETTERS = 200_000, 1 << 26
"""Parts in events that may wait for their like in the other log, and letters of their lines; beyond that the bodies
that wait longest have parted."""

MOST_FRAMES = 2_000
"""Records without contacts that may wait for the other log to come to their time."""

LOOKED_AHEAD = 3
"""Lines in a row whose loss is told from another history."""

SAMPLE = 16
"""Of so many events one is compared, once differences are too large for a change to be told from chaos."""

CLOSE = 30
"""Bits of difference, of 52, up to which two events in the same place are the same event."""


def pair(one: str | Path, other: str | Path, ignore: frozenset[str] = frozenset()) -> Found:
    """Reads two logs side by side.

    Args:
        ignore: free fields that are not compared; `time` for the times of steps.

    Raises:
        EngineError: for a log that cannot be read, and for two that have nothing to be compared.
    """
    a, b = two_sides(one, other)
    names = a.log.names or b.log.names
    if names and a.columns is not None:
        names = [names[j] for j in a.columns]
    heads = a.head, b.head
    growing = Growing(unit_of((a.log, b.log), heads), names)
    steps = all(side.head[0].step is not None for side in (a, b) if side.head)
    found = Found(a.log, b.log, "step" if steps else "body", growing, names={v: k for k, v in b.rename.items()})
    found.time_unit = unit_of_times(heads)
    found.columns = a.columns, b.columns
    found.grid = grid(a) and grid(b)
    found.contacts_each = any(r.contacts for head in heads for r in head)
    begun = any(side.log.header.get("contacts") == "begun" for side in (a, b))
    found.all_told = all_told(a) or all_told(b)
    found.touched_told = found.contacts_each and not begun and all(map(touched_told, (a, b)))
    (BySteps if steps else ByBodies)(a, b, found, ignore).run()
    return found


class Part:
    """A body's part in one event: whether it is named first, whom it meets, and the record.

    Attributes:
        letters: what it takes to keep it, shared among those who take part.
    """

    __slots__ = ("event", "letters", "partners", "record", "role")

    def __init__(self, event: int, partners: tuple[str, ...], role: bool, record: LogRecord) -> None:
        self.event, self.partners, self.role, self.record = event, partners, role, record
        self.letters = len(record.texts[0]) // len(record.contacts)


class Waiting:
    """Parts in events of one log that wait for their like in the other, by log and body."""

    def __init__(self) -> None:
        self.queues: tuple[dict[str, deque[Part]], dict[str, deque[Part]]] = ({}, {})
        self.count = self.letters = 0

    def add(self, side: int, body: str, part: Part) -> None:
        """One more."""
        queue = self.queues[side].get(body)
        if queue is None:
            queue = self.queues[side][body] = deque()
        queue.append(part)
        self.count += 1
        self.letters += part.letters

    def take(self, queue: deque[Part]) -> Part:
        """The part that waits longest of a body, which waits no more."""
        part = queue.popleft()
        self.count -= 1
        self.letters -= part.letters
        return part

    def drop(self, body: str) -> None:
        """Lets a body go."""
        for queues in self.queues:
            queue = queues.pop(body, ())
            self.count -= len(queue)
            self.letters -= sum(part.letters for part in queue)

    def next_of_both(self, side: int, p: str, q: str) -> Part | None:
        """What comes next in the other log for two bodies, where that is one event and nothing waits before it."""
        own, theirs = self.queues[side], self.queues[1 - side]
        mine, other = theirs.get(p), theirs.get(q)
        if not mine or not other or own.get(p) or own.get(q) or mine[0].record is not other[0].record:
            return None
        return mine[0]

    def much(self, share: int = 1) -> bool:
        """Whether more waits than may, or than a share of that."""
        return self.count > WAITING // share or self.letters > MOST_LETTERS // share


class ByBodies(RecordPairs):
    """Events of both logs by body: its k-th meeting in the one with its k-th in the other. Frames go by their times."""

    def __init__(self, a: Side, b: Side, found: Found, ignore: frozenset[str]) -> None:
        super().__init__(a, b, found, ignore)
        self.waiting = Waiting()
        self.parted: set[str] = set()
        self.frames: tuple[deque[LogRecord], deque[LogRecord]] = (deque(), deque())
        self.spacing = math.inf
        self.last_frame = [math.nan, math.nan]
        self.shift = 0.0
        self.started: tuple[LogRecord, LogRecord] | None = None
        self.one_clock = False
        self.restarts = 0
        self.last_record: tuple[dict[str, int], dict[str, int]] = ({}, {})  # its letters, hashed

    def run(self) -> None:
        """Reads both logs to their ends."""
        one, other = self.sides
        while not (one.ended and other.ended):
            a = None if one.ended else self.next(0)
            b = None if other.ended else self.next(1)
            level = one.events == other.events and not (self.waiting.count or self.parted or any(self.frames))
            if level and a is not None and b is not None and self.at_once(a, b, one.events, one.events):
                if a.contacts:
                    one.events += 1
                    other.events += 1
            else:
                if a is not None:
                    self.feed(0, a)
                if b is not None:
                    self.feed(1, b)
            self.after()
        self.finish()
        self.settled += 2
        self.after()

    def at_once(self, a: LogRecord, b: LogRecord, event: int, other: int) -> bool:
        """Compares two records that are the same to the letter, or one event but for rounding; whether they are."""
        same = self.plain and a.texts == b.texts and a.clock == b.clock
        if not same and not self.close(a, b):
            return False
        if event != other and self.found.reordered is None:
            self.found.reordered = event, other
        if not same:
            self.together(a, b)
            if event == other:
                self.others(a, b)
            return True
        self.alike(a, b)
        self.found.compared["times"] += 1
        if a.contacts and a.clock is not None:
            self.one_clock = True
        if not a.contacts:
            self.last_frame = [a.clock or 0.0, b.clock or 0.0]
            return True
        one, two = self.last_record
        letters = _letters(a)
        for contact in a.contacts:
            for body in contact:
                one[body] = two[body] = letters
                if not a.states:
                    self.growing.same(body, a.number)
        return True

    def close(self, a: LogRecord, b: LogRecord) -> bool:
        """Whether two records are one event, at times that rounding alone sets apart, once something differs."""
        return (
            bool(self.growing.early)
            and self.growing.largest <= CLOSE
            and a.clock is not None
            and b.clock is not None
            and a.contacts == b.contacts
            and bool(a.contacts and a.states and b.states)
            and abs(b.clock - self.shift - a.clock) <= 2.0 ** (CLOSE - 52) * abs(a.clock)
        )

    def together(self, a: LogRecord, b: LogRecord) -> None:
        """Compares one event of both runs, whose contacts are the same."""
        found, growing = self.found, self.growing
        found.pairs += len(a.contacts)
        found.last_common = a
        found.compared["contacts"] += len(a.contacts)
        partners = _partners(a)
        befores = {body: growing.before(body, others) for body, others in partners.items()}
        letters = _letters(a), _letters(b)
        most, first = NEVER, None
        self.first(a)
        for body in partners:
            if body not in growing.bodies:
                self.last_record[0][body], self.last_record[1][body] = letters
            if body in a.states and body in b.states:
                first = first or body
            most = max(most, self.states(a, b, body, True, befores[body]))
        if first is not None:
            self.clocks(a, b, first, True, most, befores[first])

    def feed(self, side: int, record: LogRecord) -> None:
        """One more record of one log, which may wait for its like in the other."""
        contacts, waiting = record.contacts, self.waiting
        if not contacts:
            self.frame(side, record)
            return
        event = self.sides[side].events
        self.sides[side].events += 1
        if len(contacts) == 1 and contacts[0][0] != contacts[0][1]:
            p, q = contacts[0]
            twin = waiting.next_of_both(side, p, q)
            if twin is not None:
                both = (record, twin.record, event, twin.event)
                if self.at_once(*both if side == 0 else (twin.record, record, twin.event, event)):
                    waiting.take(waiting.queues[1 - side][p])
                    waiting.take(waiting.queues[1 - side][q])
                    return
        firsts = {p for p, _ in contacts}
        for body, partners in _partners(record).items():
            if body not in self.parted:
                waiting.add(side, body, Part(event, tuple(partners), body in firsts, record))
                if waiting.queues[1 - side].get(body):
                    self.drain(body, ended=False)
        if waiting.much():
            self.give_up()

    def frame(self, side: int, record: LogRecord) -> None:
        """A record of states, a hash or fields alone: goes with the other log's of the same time."""
        clock = record.clock or 0.0
        before = self.last_frame[side]
        if clock > before:
            self.spacing = min(self.spacing, clock - before)
        self.last_frame[side] = clock
        self.frames[side].append(record)
        one, other = self.frames
        while one and other:
            a, b = one[0], other[0]
            x, y = a.clock or 0.0, (b.clock or 0.0) - self.shift
            room = min(0.25 * self.spacing, 1e-6 * max(1.0, abs(x)))
            if self.found.pairs == 0 and self.found.clock is None and abs(x - y) > room and a.states == b.states:
                self.shift = self.found.clock = (b.clock or 0.0) - x
            elif abs(x - y) <= room:
                one.popleft()
                other.popleft()
                self.found.pairs += 1
                self.found.last_common = a
                self.all_states(a, b, {})
                self.others(a, b)
            else:
                which = 0 if x < y else 1
                self.alone(which, self.frames[which].popleft())
        for which, frames in enumerate(self.frames):
            if len(frames) > MOST_FRAMES:
                self.alone(which, frames.popleft())

    def drain(self, body: str, *, ended: bool) -> None:
        """Compares the meetings of a body that both logs have."""
        one, other = (queues.get(body) for queues in self.waiting.queues)
        while one and other and body not in self.parted:
            x, y = one[0], other[0]
            alike = x.partners == y.partners or sorted(x.partners) == sorted(y.partners)
            differed = body in self.growing.bodies
            if not (alike and (differed or self.near(x, y, body))) and not differed:
                if self.lost(body, one, other):
                    continue
                if not ended and min(len(one), len(other)) <= LOOKED_AHEAD:
                    return
            if alike:
                self.matched(body, self.waiting.take(one), self.waiting.take(other))
            else:
                self.part(body, x, y)

    def near(self, x: Part, y: Part, body: str) -> bool:
        """Whether two meetings with the same partners are one, but for rounding."""
        p, q = x.record, y.record
        if p.texts == q.texts:
            return True
        one, other = p.states.get(body), q.states.get(body)
        if one is not None and other is not None:
            if one == other or len(one) != len(other):  # the latter is refused where they are compared
                return True
            unit = self.growing.unit
            return unit.most_off(one, other, None)[0] <= min(CLOSE, unit.whole / 2)
        if p.clock is None or q.clock is None:
            return True
        return abs(q.clock - self.shift - p.clock) <= 2.0 ** (CLOSE - 52) * max(abs(p.clock), 1e-300)

    def lost(self, body: str, one: deque[Part], other: deque[Part]) -> bool:
        """Whether a line was lost from one log, or is there twice: the other goes on exactly as after it."""
        for side, (longer, shorter) in enumerate(((one, other), (other, one))):
            for k in range(1, LOOKED_AHEAD + 1):
                if len(longer) > k and _exact(longer[k], shorter[0], body):
                    for _ in range(k):
                        self.one_alone(side, body, self.waiting.take(longer).record)
                    return True
        return False

    def one_alone(self, side: int, body: str, record: LogRecord) -> None:
        """An event that one log has alone: twice, or lost from the other."""
        if self.last_record[side].get(body) == _letters(record):
            self.repeated(side, record.line)
        else:
            self.missing(side, record)

    def matched(self, body: str, x: Part, y: Part) -> None:
        """One meeting of a body, in both."""
        found, growing = self.found, self.growing
        a, b = x.record, y.record
        found.pairs += x.role
        found.last_common = a
        found.compared["contacts"] += x.role
        if found.reordered is None and (x.event != y.event or x.partners != y.partners):
            found.reordered = x.event, y.event
        if body not in growing.bodies:
            self.last_record[0][body], self.last_record[1][body] = _letters(a), _letters(b)
        if growing.sated and x.event % SAMPLE:
            return
        before = growing.before(body, x.partners)
        stated = body in a.states and body in b.states
        if stated:
            self.first(a)
        off = self.states(a, b, body, True, before)
        self.clocks(a, b, body, stated, off, before)
        if x.event == y.event and body == a.contacts[0][0]:
            self.others(a, b)

    def one_start(self) -> None:
        """The clocks are one: what was taken for another start of the second is a time that differs."""
        self.found.times_differ = self.found.times_differ or self.started
        self.found.clock, self.shift, self.started = None, 0.0, None

    def clocks(self, a: LogRecord, b: LogRecord, body: str, stated: bool, off: float, before: float) -> None:
        """Compares the times of one meeting."""
        if a.clock is None or b.clock is None:
            return
        found, growing = self.found, self.growing
        found.compared["times"] += 1
        if not stated and a.states and b.states:
            return  # what has no states where others have, as a wall, has no history of its own
        unit, x, y = found.time_unit, a.clock, b.clock - self.shift
        restarts = sum(len(side.log.counted.restarts) for side in self.sides)
        late, scale = b.clock - a.clock, max(abs(a.clock), abs(b.clock))
        other_start = abs(late) > 1e-6 * scale and found.clock is None and found.compared["times"] <= 2
        other_start = other_start and not self.one_clock
        agrees = x == y or a.clock == b.clock or bool(self.shift and abs(late - self.shift) <= 8 * math.ulp(scale))
        if not agrees and other_start and (not stated or off == NEVER):
            found.clock = self.shift = late  # the second clock was started at another time
            self.started = a, b
            agrees = True
        elif self.started is not None and late == 0 and self.shift and restarts == self.restarts:
            self.one_start()
        elif not agrees and unit.coarse is not None and unit.coarse.explains(x, y):
            found.explained += unit.coarse.side is not None
            agrees = True
        elif not agrees and stated and off == NEVER and restarts != self.restarts:
            self.restarts, self.shift = restarts, late  # a clock began anew in one of them
            agrees = True
        if agrees:
            if not stated:
                growing.same(body, a.number)
        elif stated and off == NEVER and abs(late - self.shift) > 1e-6 * scale:
            if found.times_differ is None:
                found.times_differ = a, b
        else:
            bits, _ = unit.most_off((x,), (y,), "time")
            if bits > NEVER and bits > off:
                growing.note(a, b, body, "time", x, y, bits, True, before)

    def part(self, body: str, x: Part, y: Part) -> None:
        """A body meets another in the one run than in the other."""
        a, b = x.record, y.record
        first = self.found.meeting is None or a.number < self.found.meeting.number
        self.meet((a, b), body, (" + ".join(x.partners), " + ".join(y.partners)))
        if first and a.clock is not None and b.clock is not None:
            off = abs(a.clock - b.clock + self.shift)
            self.found.tie = off <= 2.0**-40 * max(abs(a.clock), abs(b.clock))
        self.drop(body)

    def drop(self, body: str) -> None:
        """Compares a body no longer."""
        self.parted.add(body)
        self.waiting.drop(body)

    def give_up(self) -> None:
        """Lets bodies go, those first that wait longest, until half are left: the other log has nothing of them."""
        queues = self.waiting.queues
        longest = [(len(queue), side, body) for side in (0, 1) for body, queue in queues[side].items()]
        for _, side, body in sorted(longest, reverse=True):
            if not self.waiting.much(2):
                break
            if body in queues[side]:
                if queues[side][body]:
                    self.met_alone(side, queues[side][body][0], body)
                self.drop(body)

    def met_alone(self, side: int, part: Part, body: str) -> None:
        """A meeting that the other log has not, though it goes on beyond it."""
        record, partners = part.record, " + ".join(part.partners)
        if side == 0:
            self.meet((record, None), body, (partners, None))
        else:
            self.meet((None, record), body, (None, partners))

    def finish(self) -> None:
        """What is left when both logs have ended, and whether they end at one time."""
        found, queues = self.found, self.waiting.queues
        for body in sorted(queues[0].keys() & queues[1].keys()):
            self.drain(body, ended=True)
        ends = [side.last.clock if side.last is not None else None for side in self.sides]
        for side in (0, 1):
            limit = ends[1 - side]
            shift = self.shift if side == 0 else -self.shift
            for body, part in [(body, queue[0]) for body, queue in queues[side].items() if queue]:
                clock = part.record.clock
                if limit is None or clock is None or clock + shift >= limit:
                    found.longer = "ab"[side]
                elif self.growing.bodies or found.meeting is not None:
                    if self.last_record[side].get(body) == _letters(part.record):
                        self.repeated(side, part.record.line)
                    else:
                        self.met_alone(side, part, body)
                else:
                    self.one_alone(side, body, part.record)
        for side in (0, 1):
            for record in self.frames[side]:
                if ends[1 - side] is not None and (record.clock or 0.0) > (ends[1 - side] or 0.0):
                    found.longer = found.longer or "ab"[side]
                else:
                    self.alone(side, record)
        over = [side.log.end for side in self.sides]
        if self.started is not None and self.shift and None not in over and over[0] == over[1]:
            self.one_start()


def _partners(record: LogRecord) -> dict[str, list[str]]:
    """Whom each body meets at an event, itself once where it meets itself."""
    if len(record.contacts) == 1:
        ((p, q),) = record.contacts
        if p != q:
            return {p: [q], q: [p]}
    found: dict[str, list[str]] = {}
    for p, q in record.contacts:
        found.setdefault(p, []).append(q)
        found.setdefault(q, []).append(p)
    return found


def _letters(record: LogRecord) -> int:
    """The lines of a record as one number."""
    return hash(record.texts[0]) if len(record.texts) == 1 else hash(tuple(record.texts))


def _exact(x: Part, y: Part, body: str) -> bool:
    """Whether two meetings are the same to the last bit."""
    a, b = x.record, y.record
    return sorted(x.partners) == sorted(y.partners) and a.time == b.time and a.states.get(body) == b.states.get(body)
