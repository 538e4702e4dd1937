"""Two logs read side by side: steps by number, events by body, so that independent events may come in any order."""

from __future__ import annotations

import math
from collections import Counter, deque
from itertools import chain
from pathlib import Path

from .growing import NEVER, Growing, unit_of
from .log_format import Record
from .record_pairs import RecordPairs
from .sides import Found, Meeting, Side, TwoLogs, all_told, check, grid, names, touched_told

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
        ignore: free fields that are not compared.

    Raises:
        EngineError: for a log that cannot be read, and for two that have nothing to be compared.
    """
    a, b = TwoLogs(one, other).sides()
    check(a, b)
    growing = Growing(unit_of((a.log, b.log), (a.head, b.head)), a.log.names or b.log.names)
    renamed = names(a, b)
    steps = all(side.head[0].step is not None for side in (a, b) if side.head)
    found = Found(a.log, b.log, "step" if steps else "body", growing, names={v: k for k, v in renamed.items()})
    b.rename = renamed
    found.grid = grid(a) and grid(b)
    found.contacts_each = any(r.contacts for side in (a, b) for r in side.head)
    begun = any(side.log.header.get("contacts") == "begun" for side in (a, b))
    found.all_told = all_told(a) or all_told(b)
    found.touched_told = found.contacts_each and not begun and all(touched_told(side) for side in (a, b))
    (_BySteps if steps else _ByBodies)(a, b, found, ignore).run()
    return found


class _BySteps(RecordPairs):
    """Records of both logs by their step, continued over restarts."""

    def run(self) -> None:
        a, b = self.a.next(), self.b.next()
        while a is not None and b is not None:
            assert a.step is not None or b.step is not None
            x, y = _step(a), _step(b)
            if x == y:
                self.both(a, b)
                a, b = self.a.next(), self.b.next()
            elif x < y:
                self.one(0, a)
                a = self.a.next()
            else:
                self.one(1, b)
                b = self.b.next()
            self.after()
        if a is not None or b is not None:
            self.found.longer = "b" if a is None else "a"
        self.settled += 2
        self.after()
        for side, record, rest in ((0, a, self.a), (1, b, self.b)):
            while record is not None:
                self.take(side, record)
                record = rest.next()

    def one(self, side: int, record: Record) -> None:
        """A step that one log has alone."""
        self.take(side, record)
        found = self.found
        found.alone[side] += 1
        if found.alone_first[side] is None:
            found.alone_first[side] = record.place()
        if record.contacts and len(found.missing) < 20:
            found.missing.append(("ba"[side], record.place()))
        found.missing_count += bool(record.contacts)

    def both(self, a: Record, b: Record) -> None:
        found, growing = self.found, self.growing
        if a.repeats != b.repeats:
            self.repeated(*((0, a.line) if a.repeats > b.repeats else (1, b.line)))
        if a is b or (self.plain and a.texts == b.texts):
            self.alike(a, b)
            return
        self.take(0, a)
        self.take(1, b)
        found.pairs += 1
        found.last_common = a
        self.times(a, b)
        self.contacts(a, b)
        partners: dict[str, list[str]] = {}
        for p, q in a.contacts if a.contacts == b.contacts else chain(a.contacts, b.contacts):
            partners.setdefault(p, []).append(q)
            partners.setdefault(q, []).append(p)
        states, perm, number = b.states, self.perm, a.number
        befores = {body: growing.before(body, partners.get(body, ())) for body in a.states} if growing.off else {}
        if a.states.keys() != states.keys():
            self.uneven(a, b)
        for body, one in a.states.items():
            other = states.get(body)
            if other is None:
                continue
            found.compared["states"] += 1
            if perm is not None and len(other) == len(perm):
                other = [other[j] for j in perm]
            if one == other:
                growing.same(body, number)
                if 0.0 in one:
                    self.zeros(a, one, other)
                if found.pairs % 8 == 1:
                    growing.unit.widen(one)
            else:
                growing.differs(a, b, body, (one, other), body in partners, befores.get(body, NEVER))
        self.others(a, b)

    def times(self, a: Record, b: Record) -> None:
        """Compares the clocks of a step, but for how much later one was started."""
        found = self.found
        if a.clock is None or b.clock is None:
            return
        found.compared["times"] += 1
        late = b.clock - a.clock
        if found.clock is None:
            found.clock = late if abs(late) > 1e-9 * max(abs(a.clock), abs(b.clock)) else 0.0
        elif abs(late - found.clock) > 1e-6 * max(abs(a.clock), abs(b.clock), 1e-300) and found.times_differ is None:
            found.times_differ = a, b

    def contacts(self, a: Record, b: Record) -> None:
        found = self.found
        if not a.contacts and not b.contacts:
            return
        found.compared["contacts"] += max(len(a.contacts), len(b.contacts))
        self.growing.onsets += max(len(a.contacts), len(b.contacts))
        if a.contacts == b.contacts:
            return
        counts = [Counter(tuple(sorted(p)) for p in r.contacts) for r in (a, b)]
        if counts[0] == counts[1]:
            if found.reordered is None:
                found.reordered = a.number, b.number
            return
        if found.meeting is not None:
            return
        more = sorted((counts[0] - counts[1]).keys()) or sorted((counts[1] - counts[0]).keys())
        body = min(more[0], key=lambda i: sum(i in p for r in (a, b) for p in r.contacts))  # a ground has many
        own = [[q if p == body else p for p, q in r.contacts if body in (p, q)] for r in (a, b)]
        told = [" + ".join(sorted(names)) or None for names in own]
        self.meet(Meeting(a.number, a.step, a.time, body, told[0], told[1], (a.time, b.time), (a.line, b.line)))


def _step(record: Record) -> int:
    return record.step if record.step is not None else -1


class _Entry:
    """A body's part in one event."""

    __slots__ = ("event", "letters", "partners", "record", "role")

    def __init__(self, event: int, partners: tuple[str, ...], role: bool, record: Record) -> None:
        self.event, self.partners, self.role, self.record = event, partners, role, record
        self.letters = len(record.texts[0]) // len(record.contacts)


class _ByBodies(RecordPairs):
    """Events of both logs by body: its k-th meeting in the one with its k-th in the other. Frames go by their times."""

    def __init__(self, a: Side, b: Side, found: Found, ignore: frozenset[str]) -> None:
        super().__init__(a, b, found, ignore)
        self.queues: tuple[dict[str, deque[_Entry]], dict[str, deque[_Entry]]] = ({}, {})
        self.parted: set[str] = set()
        self.frames: tuple[deque[Record], deque[Record]] = (deque(), deque())
        self.spacing = math.inf
        self.last_frame = [math.nan, math.nan]
        self.waiting = self.letters = 0
        self.shift = 0.0
        self.restarts = 0
        self.last_record: tuple[dict[str, int], dict[str, int]] = ({}, {})  # its letters, hashed

    def run(self) -> None:
        one, other = self.a, self.b
        while not (one.ended and other.ended):
            a = None if one.ended else one.next()
            b = None if other.ended else other.next()
            if a is not None and b is not None and not (self.waiting or self.parted or any(self.frames)):
                if a is b or (self.plain and a.texts == b.texts):
                    self.same(a, b)
                    continue
                if self.level(a, b):
                    self.after()
                    continue
            if a is not None:
                self.feed(0, a)
            if b is not None:
                self.feed(1, b)
            self.after()
        self.finish()
        self.settled += 2
        self.after()

    def same(self, a: Record, b: Record) -> None:
        """Two records that are the same to the letter, with nothing waiting before them."""
        self.alike(a, b)
        self.found.compared["times"] += 1
        if not a.contacts:
            self.last_frame = [a.clock or 0.0, b.clock or 0.0]
            return
        one, other = self.last_record
        letters = _letters(a)
        for contact in a.contacts:
            for body in contact:
                one[body] = other[body] = letters
                if not a.states:
                    self.growing.same(body, a.number)
        self.a.events += 1
        self.b.events += 1

    def close(self, a: Record, b: Record) -> bool:
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

    def level(self, a: Record, b: Record) -> bool:
        """Compares two events of the same contacts at about one time, with nothing waiting; whether they are such."""
        if self.a.events != self.b.events or not self.close(a, b):
            return False
        self.take(0, a)
        self.take(1, b)
        self.growing.onsets += len(a.contacts)
        self.a.events += 1
        self.b.events += 1
        self.together(a, b)
        self.others(a, b)
        return True

    def together(self, a: Record, b: Record) -> None:
        """Compares one event of both runs, whose contacts are the same."""
        found, growing = self.found, self.growing
        count = 2 * len(a.contacts)
        found.pairs += count
        found.last_common = a
        found.compared["contacts"] += count
        if len(a.contacts) == 1:
            ((p, q),) = a.contacts
            partners: dict[str, list[str]] = {p: [q], q: [p]}
        else:
            partners = {}
            for p, q in a.contacts:
                partners.setdefault(p, []).append(q)
                partners.setdefault(q, []).append(p)
        befores = {body: growing.before(body, others) for body, others in partners.items()}
        letters = _letters(a), _letters(b)
        most = NEVER
        first = None
        for body, others in partners.items():
            if body not in growing.bodies:
                self.last_record[0][body], self.last_record[1][body] = letters
            if body in a.states and body in b.states:
                first = first or body
            most = max(most, self.states(a, b, body, others, befores[body]))
        if first is not None:
            self.clocks(a, b, first, True, most, befores[first])

    def twin(self, side: int, event: int, record: Record, p: str, q: str) -> bool:
        """Compares at once an event of two bodies that comes next for both in the other log, at about the same time."""
        own, theirs = self.queues[side], self.queues[1 - side]
        mine, other = theirs.get(p), theirs.get(q)
        if not mine or not other or own.get(p) or own.get(q):
            return False
        entry = mine[0]
        if entry.record is not other[0].record:
            return False
        a, b = (record, entry.record) if side == 0 else (entry.record, record)
        if not self.close(a, b):
            return False
        self.taken(mine)
        self.taken(other)
        self.together(a, b)
        if event == entry.event:
            self.others(a, b)
        elif self.found.reordered is None:
            self.found.reordered = (event, entry.event) if side == 0 else (entry.event, event)
        return True

    def feed(self, side: int, record: Record) -> None:
        """One more record of one log, which may wait for its like in the other."""
        self.take(side, record)
        contacts = record.contacts
        if not contacts:
            self.frame(side, record)
            return
        reader = (self.a, self.b)[side]
        event = reader.events
        reader.events += 1
        if side == 0:
            self.growing.onsets += len(contacts)
        own, theirs, parted = self.queues[side], self.queues[1 - side], self.parted
        if len(contacts) == 1 and contacts[0][0] != contacts[0][1]:
            p, q = contacts[0]
            if p in parted and q in parted:
                return
            if self.whole(side, event, record, p, q) or self.twin(side, event, record, p, q):
                return
            entries = [(p, _Entry(event, (q,), True, record)), (q, _Entry(event, (p,), False, record))]
        else:
            partners: dict[str, list[str]] = {}
            roles: dict[str, bool] = {}
            for p, q in contacts:
                partners.setdefault(p, []).append(q)
                partners.setdefault(q, []).append(p)
                roles.setdefault(p, True)
                roles.setdefault(q, False)
            entries = [(body, _Entry(event, tuple(o), roles[body], record)) for body, o in partners.items()]
        for body, entry in entries:
            if body in parted:
                continue
            queue = own.get(body)
            if queue is None:
                queue = own[body] = deque()
            queue.append(entry)
            self.waiting += 1
            self.letters += entry.letters
            if theirs.get(body):
                self.drain(body, ended=False)
        if self.waiting > WAITING or self.letters > MOST_LETTERS:
            self.give_up()

    def whole(self, side: int, event: int, record: Record, p: str, q: str) -> bool:
        """Compares at once an event of two bodies that comes next for both in the other log, to the letter the same."""
        own, theirs = self.queues[side], self.queues[1 - side]
        mine, other = theirs.get(p), theirs.get(q)
        if not mine or not other or own.get(p) or own.get(q) or not self.plain or self.growing.off:
            return False
        entry = mine[0]
        twin = entry.record
        if twin is not other[0].record or twin.texts != record.texts or twin.clock != record.clock:
            return False
        self.taken(mine)
        self.taken(other)
        a, b = (record, twin) if side == 0 else (twin, record)
        found, growing = self.found, self.growing
        found.pairs += 2
        found.last_common = a
        found.compared["contacts"] += 2
        found.compared["times"] += 2
        if event != entry.event:
            if found.reordered is None:
                found.reordered = (event, entry.event) if side == 0 else (entry.event, event)
        else:
            self.others(a, b)
        one, two = self.last_record
        one[p] = one[q] = two[p] = two[q] = _letters(a)
        states = a.states
        for body in (p, q):
            row = states.get(body)
            if row is None:
                if not states:
                    growing.same(body, a.number)
                continue
            found.compared["states"] += 1
            growing.same(body, a.number)
            if found.compared["states"] % 8 == 1:
                growing.unit.widen(row)
                if found.nans is None and any(map(math.isnan, row)):
                    found.nans = a.place()
        return True

    def frame(self, side: int, record: Record) -> None:
        """A record of states, a hash or fields alone: goes with the other log's of the same time."""
        clock = record.clock or 0.0
        before = self.last_frame[side]
        if clock > before:
            self.spacing = min(self.spacing, clock - before)
        self.last_frame[side] = clock
        self.frames[side].append(record)
        one, other = self.frames
        while one and other:
            x, y = one[0].clock or 0.0, (other[0].clock or 0.0) - self.shift
            room = min(0.25 * self.spacing, 1e-6 * max(1.0, abs(x)))
            if (
                self.found.pairs == 0
                and self.found.clock is None
                and abs(x - y) > room
                and one[0].states == other[0].states
            ):
                self.shift = self.found.clock = (other[0].clock or 0.0) - x
                continue
            if abs(x - y) <= room:
                self.framed(one.popleft(), other.popleft())
            elif x < y:
                self.lone(0, one.popleft())
            else:
                self.lone(1, other.popleft())
        for which, waiting in enumerate(self.frames):
            if len(waiting) > MOST_FRAMES:
                self.lone(which, waiting.popleft())

    def lone(self, side: int, record: Record) -> None:
        found = self.found
        found.alone[side] += 1
        if found.alone_first[side] is None:
            found.alone_first[side] = record.place()

    def framed(self, a: Record, b: Record) -> None:
        self.found.pairs += 1
        self.found.last_common = a
        if a.states.keys() != b.states.keys():
            self.uneven(a, b)
        before = {body: self.growing.before(body, ()) for body in a.states}
        for body in a.states:
            if body in b.states:
                one, other = a.states[body], b.states[body]
                self.found.compared["states"] += 1
                if self.perm is not None and len(other) == len(self.perm):
                    other = [other[j] for j in self.perm]
                if one == other:
                    self.growing.same(body, a.number)
                    self.growing.unit.widen(one)
                    if 0.0 in one:
                        self.zeros(a, one, other)
                else:
                    self.growing.differs(a, b, body, (one, other), False, before[body])
        self.others(a, b)

    def drain(self, body: str, *, ended: bool) -> None:
        """Compares the meetings of a body that both logs have."""
        one, other = (queues.get(body) for queues in self.queues)
        while one and other and body not in self.parted:
            x, y = one[0], other[0]
            alike = x.partners == y.partners or sorted(x.partners) == sorted(y.partners)
            if alike and (body in self.growing.bodies or self.near(x, y, body)):
                self.matched(body, self.taken(one), self.taken(other))
                continue
            clean = body not in self.growing.bodies
            if clean:
                lost = self.lost(body, one, other)
                if lost:
                    continue
                if not ended and min(len(one), len(other)) <= LOOKED_AHEAD:
                    return
            if alike:
                self.matched(body, self.taken(one), self.taken(other))
            else:
                self.part(body, x, y)

    def near(self, x: _Entry, y: _Entry, body: str) -> bool:
        """Whether two meetings with the same partners are one, but for rounding."""
        p, q = x.record, y.record
        if p.texts == q.texts:
            return True
        one, other = p.states.get(body), q.states.get(body)
        if one is not None and other is not None:
            if one == other:
                return True
            if len(one) != len(other):
                return True  # refused where they are compared
            unit, room = self.growing.unit, min(CLOSE, self.growing.unit.whole / 2)
            return all(
                u == v or unit.bits_off(u, v, (None, j)) <= room
                for j, (u, v) in enumerate(zip(one, other, strict=True))
            )
        if p.clock is None or q.clock is None:
            return True
        return abs(q.clock - self.shift - p.clock) <= 2.0 ** (CLOSE - 52) * max(abs(p.clock), 1e-300)

    def lost(self, body: str, one: deque[_Entry], other: deque[_Entry]) -> bool:
        """Whether a line was lost from one log, or is there twice: the other goes on exactly as after it."""
        for side, (longer, shorter) in enumerate(((one, other), (other, one))):
            for k in range(1, LOOKED_AHEAD + 1):
                if len(longer) > k and _exact(longer[k], shorter[0], body, self.perm):
                    for _ in range(k):
                        entry = self.taken(longer)
                        last = self.last_record[side].get(body)
                        if last is not None and last == _letters(entry.record):
                            self.repeated(side, entry.record.line)
                        else:
                            self.miss(side, entry.record)
                    return True
        return False

    def miss(self, side: int, record: Record) -> None:
        told = ("ba"[side], record.place())
        if told not in self.found.missing and len(self.found.missing) < 20:
            self.found.missing.append(told)
        self.found.missing_count += 1

    def matched(self, body: str, x: _Entry, y: _Entry) -> None:
        """One meeting of a body, in both."""
        found, growing = self.found, self.growing
        a, b = x.record, y.record
        found.pairs += 1
        found.last_common = a
        found.compared["contacts"] += 1
        if found.reordered is None and (x.event != y.event or x.partners != y.partners or x.role != y.role):
            found.reordered = x.event, y.event
        if body not in growing.bodies:
            self.last_record[0][body], self.last_record[1][body] = _letters(a), _letters(b)
        if growing.sated and x.event % SAMPLE:
            return
        before = growing.before(body, x.partners)
        stated = body in a.states and body in b.states
        off = self.states(a, b, body, x.partners, before)
        self.clocks(a, b, body, stated, off, before)
        if x.event == y.event and body == next(iter(a.contacts))[0]:
            self.others(a, b)

    def clocks(self, a: Record, b: Record, body: str, stated: bool, off: float, before: float) -> None:
        """Compares the times of one meeting."""
        if a.clock is None or b.clock is None:
            return
        found, growing = self.found, self.growing
        a_log, b_log = self.a.log, self.b.log
        found.compared["times"] += 1
        if a.clock == b.clock or a.clock == b.clock - self.shift:
            if not stated:
                growing.same(body, a.number)
            return
        late = b.clock - a.clock
        scale = max(abs(a.clock), abs(b.clock))
        other_start = abs(late) > 1e-6 * scale and found.clock is None and found.compared["times"] <= 2
        if other_start and (not stated or off == NEVER):
            found.clock = self.shift = late  # the second clock was started at another time
            if not stated:
                growing.same(body, a.number)
            return
        if self.shift and abs(late - self.shift) <= 8 * math.ulp(scale):
            if not stated:
                growing.same(body, a.number)
            return
        restarts = len(a_log.restarts) + len(b_log.restarts)
        if stated and off == NEVER and restarts != self.restarts:
            self.restarts, self.shift = restarts, late  # a clock began anew in one of them
            return
        if stated and off == NEVER and abs(late - self.shift) > 1e-6 * scale:
            if found.times_differ is None:
                found.times_differ = a, b
            return
        bits = growing.unit.bits_off(a.clock, b.clock - self.shift, ("time", 0))
        if bits > NEVER and bits > off:
            growing.note(a, b, body, "time", a.clock, b.clock - self.shift, bits, True, before)

    def part(self, body: str, x: _Entry, y: _Entry) -> None:
        """A body meets another in the one run than in the other."""
        a, b = x.record, y.record
        times = a.time, b.time
        tie = (
            a.clock is not None
            and b.clock is not None
            and abs(a.clock - b.clock + self.shift) <= 2.0**-40 * max(abs(a.clock), abs(b.clock))
        )
        first = self.found.meeting is None or a.number < self.found.meeting.number
        self.meet(
            Meeting(
                a.number, a.step, a.time, body, " + ".join(x.partners), " + ".join(y.partners), times, (a.line, b.line)
            )
        )
        if first:
            self.found.tie = tie
        self.drop(body)

    def drop(self, body: str) -> None:
        self.parted.add(body)
        for queues in self.queues:
            queue = queues.pop(body, ())
            self.waiting -= len(queue)
            self.letters -= sum(entry.letters for entry in queue)

    def taken(self, queue: deque[_Entry]) -> _Entry:
        """The entry that waits longest of a body, which waits no more."""
        entry = queue.popleft()
        self.waiting -= 1
        self.letters -= entry.letters
        return entry

    def give_up(self) -> None:
        """Lets bodies go, those first that wait longest, until half are left: the other log has nothing of them."""
        longest = sorted(
            ((len(queue), side, body) for side, queues in enumerate(self.queues) for body, queue in queues.items()),
            reverse=True,
        )
        for _, side, body in longest:
            if self.waiting <= WAITING // 2 and self.letters <= MOST_LETTERS // 2:
                break
            if body in self.queues[side]:
                if self.queues[side][body]:
                    self.alone(side, self.queues[side][body][0], body)
                self.drop(body)

    def alone(self, side: int, entry: _Entry, body: str) -> None:
        """A meeting that the other log has not, though it goes on beyond it."""
        record, told = entry.record, " + ".join(entry.partners)
        number = record.number
        pair_ = (told, None) if side == 0 else (None, told)
        times = (record.time, None) if side == 0 else (None, record.time)
        lines = (record.line, None) if side == 0 else (None, record.line)
        self.meet(Meeting(number, record.step, record.time, body, *pair_, times, lines))

    def finish(self) -> None:
        """What is left when both logs have ended."""
        for body in sorted(self.queues[0].keys() & self.queues[1].keys()):
            self.drain(body, ended=True)
        ends = [side.last.clock if side.last is not None else None for side in (self.a, self.b)]
        for side, queues in enumerate(self.queues):
            left = [(queue[0], body) for body, queue in queues.items() if queue]
            if not left:
                continue
            limit = ends[1 - side]
            for entry, body in left:
                clock = entry.record.clock
                shift = self.shift if side == 0 else -self.shift
                if limit is not None and clock is not None and clock + shift < limit:
                    last = self.last_record[side].get(body)
                    if last is not None and last == _letters(entry.record):
                        self.repeated(side, entry.record.line)
                    elif self.growing.bodies or self.found.meeting is not None:
                        self.alone(side, entry, body)
                    else:
                        self.miss(side, entry.record)
                else:
                    self.found.longer = "ab"[side]
        for side in (0, 1):
            for record in self.frames[side]:
                if ends[1 - side] is not None and (record.clock or 0.0) > (ends[1 - side] or 0.0):
                    self.found.longer = self.found.longer or "ab"[side]
                else:
                    self.lone(side, record)


def _letters(record: Record) -> int:
    """The lines of a record as one number."""
    texts = record.texts
    return hash(texts[0]) if len(texts) == 1 else hash(tuple(texts))


def _exact(x: _Entry, y: _Entry, body: str, perm: list[int] | None) -> bool:
    """Whether two meetings are the same to the last bit."""
    a, b = x.record, y.record
    return (
        sorted(x.partners) == sorted(y.partners)
        and a.time == b.time
        and (perm is not None or a.states.get(body) == b.states.get(body))
    )
