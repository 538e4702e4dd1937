"""Follows a run as the checker does, and finds the witness of each zero that the checker will ask for.

The checker's own program decides what has to be shown: where its intervals leave a number in doubt, a witness is looked
for, and kept if the checker accepts it. So nothing here is trusted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from contextlib import suppress
from copy import copy
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import partial
from itertools import chain
from typing import Any, NamedTuple, TypeVar, cast

from flint import fmpq, fmpq_poly

from ...exact.exact_motion import ExactValue
from ...exact.replay.landings import double_zeros_exactly
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ...tools.verify import (
    FEW,
    Arching,
    Ball,
    Bowing,
    Checker,
    Dropping,
    Facing,
    Nearing,
    Refuted,
    Space,
    Sum,
    Unsettled,
    charge,
    enclosed,
    number,
    value,
)
from .isometries import Contact, Isometries
from .tower import ONE, Exact, Lazy, computed, exact_number, is_zero, lazy_text, text_of

T = TypeVar("T")

TWO = ONE + ONE

NEARER = (40, 160, 640)
"""Digits in which a time is said that tells a zero of a quartic from others, where fewer do not suffice."""


class Remembering(Space):
    """A world that keeps the last hit and the last meetings: an instant is gathered from them, and then checked.

    Of balls it tells some things roughly, in whole numbers, where that is enough: see `Prover.look` and `Prover.flies`.
    """

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self.last: tuple[Any, Any] = (None, None)
        self.age = 0
        self.met: dict[Contact, tuple[Any, Any, int, Nearing]] = {}

    def meeting(self, c: Contact, age: int) -> Nearing:
        """As in any world; asked again, with the same flights and bits, it is the same one."""
        if age != self.age:
            self.age, self.met = age, {}
        asked = self.flights[c[0]], self.flights[c[1]], self.bits
        if (kept := self.met.get(c)) is None or any(x is not y for x, y in zip(asked, kept, strict=False)):
            self.met[c] = kept = (*asked, super().meeting(c, age))
        return kept[3]

    def hit(self, c: Contact, again: Any, near: str) -> Any:
        """As in any world; asked again, it is the same number."""
        asked = (c, len(self.times), self.start(c), near if self.drops(c) else "")
        if self.last[0] != asked:
            self.last = asked, super().hit(c, again, near)
        return self.last[1]

    def rough(self, k: int, age: int) -> tuple[int, ...]:
        """A flight or a wall in whole numbers; how large these are, and how far off, places first."""
        kept, key = self.flights[k].seen, (age if k < self.n else 0, self.bits, 0)
        if key not in kept:
            x, y, vx, vy, r = row = self.at(*self.put(k, key[0])[:4], self.things[k][4])
            far, fast = abs(x.m) + abs(y.m) + abs(r.m), abs(vx.m) + abs(vy.m)
            kept[key] = *(z.m for z in row), far, x.r + y.r + r.r, fast, vx.r + vy.r
        return kept[key]

    def aside(self, c: Contact, start: int, age: int | None) -> bool:
        """Whether all of a flight is beside a fixed circle: a box round it is, of its ends and where tangents meet."""
        i, j = c if c[1] in self.pegs else c[::-1]
        u, v, *way = self.put(j, start)[:4]
        if age is None or any(z.m or z.r for z in way):
            return False
        kept, key = self.flights[i].seen, (start, age, self.bits, 0)
        if key not in kept:
            (x, y, vx, vy), wait = self.true(i, start), self.wait(start, age)
            way = [z * wait for z in (vx, vy)]
            to = zip((x, y), way, self.true(i, age), strict=False)
            spots = [(z + z, z + z + w, e + e) for z, w, e in to]
            kept[key] = [(min(z.m - z.r for z in s), max(z.m + z.r for z in s)) for s in spots]
        r, s = self.at(*(self.things[k][4] for k in c))
        room = 2 * (r.m + r.r + s.m + s.r)
        return any(
            2 * (z.m + z.r) + room < low or high < 2 * (z.m - z.r) - room
            for z, (low, high) in zip((u, v), kept[key], strict=True)
        )


class Recorded(Remembering):
    """A world of such numbers that keeps the impulses of its rounds, by instants; `near`: as the prover's times."""

    def __init__(self, near: Mapping[int, ExactValue], *args: Any) -> None:
        super().__init__(*args)
        self.near = near
        self.struck: dict[int, list[list[Lazy]]] = {}

    def drop(self, c: Contact, again: Any, near: str) -> Lazy:
        """A zero of a quartic: of what falls straight onto the middle of a circle, or one that the run has closed."""
        m: Any = self.meeting(c, start := self.start(c))
        parts = self.times[start], *m.d, *m.v, *m.bend, m.reach, *m.row
        return Lazy(None, partial(_fallen, self.near.get(len(self.times)), type(m) is Dropping), *parts)

    def blow(self, age: int, push: Any, coming: Any, s: Any) -> Any:
        """As in any world."""
        found: Any = super().blow(age, push, coming, s)
        self.struck.setdefault(age, []).append(found)
        return found


class Unlisted(NamedTuple):
    """When a circle that falls touches what stands without a blow, exactly and in a ball; which."""

    time: Exact
    near: Ball
    contact: Contact


class Prover(Checker):
    """Makes the instants of a certificate.

    Args:
        certificate: all but the witnesses, times and final state; it is completed in place.
        contacts: for each instant from time 0 on, the contacts of its event.
        digits: decimals after the point of the times and of the final state.
        times: by the place of an instant, when it is, where that may be a zero of a quartic.
        grazing: by the place of an instant, what grazes at it.

    Attributes:
        missed: grazes that no instant lists; if there are any, the certificate is not complete.
    """

    def __init__(
        self,
        certificate: dict[str, Any],
        contacts: list[frozenset[Contact]],
        digits: int,
        times: Mapping[int, ExactValue],
        grazing: Mapping[int, Sequence[Contact]],
    ) -> None:
        super().__init__(certificate, 1)
        self.near, self.grazing = times, grazing
        self.missed: list[Unlisted] = []
        self.contacts, self.digits = contacts, digits
        self.known_isometries: dict[str, int] = {}
        self.history: list[dict[int, Any]] = []
        self.cleared: set[Contact] = set()
        self.things_exact = {k: [Exact.of(x) for x in row] for k, row in self.things.items()}
        drift = {k: (Exact.of(x), Exact.of(y)) for k, (x, y) in self.drift.items()}
        pull = [Exact.of(x) for x in self.pull]
        down = (pull[0], pull[1]) if pull else None
        self.likely = Isometries(self.things_exact, self.n, self.faces, self.arcs, drift, down)
        told = self.form
        of = (told.sides, told.limits, self.laws)
        self.form = Recorded(times, self.n, self.things, *of, lambda form: Lazy(Exact.of(form)))
        balls = Remembering(self.n, self.things, *of, enclosed)
        self.few = few = copy(balls)  # reads the same with few bits
        few.bits, few.met = min(FEW, int(self.told["bits"])), {}
        self.ball = balls
        self.worlds = self.ball, self.form

    @property
    def meets(self) -> Set[Contact]:
        """What may still meet, in scene order: what is written does not hang on the order of sets."""
        return self._meets.keys()

    @meets.setter
    def meets(self, contacts: Iterable[Contact]) -> None:
        self._meets = dict.fromkeys(sorted(contacts))

    def run(self) -> None:
        """Completes the certificate, with the bits that it says.

        Raises:
            Unsettled: if these bits do not suffice, or a zero has no witness.
            Refuted: if the run is wrong.
        """
        self.check()
        final: dict[str, Any] = self.told["final"]
        final["time"] = self.decimal(self.ball.times[self.age])
        for i in range(len(final["circles"])):
            final["circles"][i] = [self.decimal(value) for value in self.ball.true(i, self.age)]
        times = cast(list[Lazy], self.form.times)
        for age, entry in enumerate(self.told["instants"]):
            if age and times[age].told and "turn" not in entry:
                entry["exact"] = lazy_text(times[age])
            for push, s in zip(entry["rounds"], self.form.struck.get(age, ()), strict=True):
                if any(x.told for x in s):
                    push[:] = [[i, j, lazy_text(x)] for (i, j), x in zip(push, s, strict=True)]
        self.told["roots"] = [text_of(root) for root in Exact.roots[len(self.told["scene"].get("roots", ())) :]]

    # -- what the checker reads, and this writes

    def take(self, entry: dict[str, Any], where: str) -> None:
        """Starts the list of an entry's witnesses."""
        entry.setdefault("zeros", [])
        super().take(entry, where)

    def said(self, value: Ball, text: str) -> None:
        """Nothing: numbers are written, not read."""

    def decimal(self, value: Ball, digits: int | None = None) -> str:
        """A number to the digits asked for.

        Raises:
            Unsettled: if it is not known so sharply.
        """
        digits = self.digits if digits is None else digits
        scale, bits = 10**digits, value.bits
        if value.r * scale * 8 > 1 << bits:
            raise Unsettled("a number is not known to as many digits")
        return decimal_text(value.m, bits, digits)

    @property
    def lost(self) -> int:
        """The bits that the least known number of a flight has lost so far."""
        numbers = (x for flight in self.ball.flights.values() for x in flight[:4])
        return max(self.told["bits"] - x.bits + x.r.bit_length() for x in numbers)

    def instant(self, entry: dict[str, Any]) -> None:
        """Gathers what falls on an instant, then checks it."""
        self.cleared.clear()
        if "turn" not in entry:
            self._gather(entry, self.contacts[self.age + 1])
        clock = entry["met"][0] if self.age >= 0 and entry.get("met") else None
        falls = clock is not None and self.drops(tuple(clock))  # before what falls stands, or the reverse
        super().instant(entry)
        self.history.append(self.rows)
        if not falls or "exact" in entry:
            entry["time"] = self.decimal(self.ball.times[self.age])

    # -- what falls on an instant

    def _gather(self, entry: dict[str, Any], contacts: frozenset[Contact]) -> None:
        """Lists the contacts that meet at an instant, first the one whose meeting is its time, and the grazes."""
        self.age += 1
        self.take(entry, f"instant {self.age}")
        entry.pop("met", None)  # its place is after the witnesses
        entry["met"] = []
        if entry.get("settle") and not (contacts or entry["enter"] or "exact" in entry or self.age == 0):
            _still(self, entry)
            self.age -= 1
            return
        if self.age == 0:
            for c in self.meets:
                if self.ball.ask("gap", c, 0).sign() in (None, 0) and self.zero("gap", c, 0) and _beside(self, c):
                    entry["met"].append(list(c))
            self.age -= 1
            return
        if "exact" in entry:
            for w in self.worlds:
                w.times.append(w.of(number(entry["exact"])))
            if not all(self._try(entry, c) for c in self.grazing.get(self.age, ())):
                raise Unsettled("whether two graze")
            if not entry["met"]:
                self._try_all(entry)
            self.age -= 1
            for w in self.worlds:
                del w.times[-1]
            return
        wanted = sorted(contacts or {(i, j) for i, j in map(tuple, entry["enter"])})
        near = [c for c in wanted if c in self.meets and c not in self.lasting and not self._left(c)]
        flat = [c for c in near if not self.drops(c) and (len(near) == 1 or self._hits(c))]
        hits = [(self.ball.hit(c, self.again(c), ""), c) for c in flat]
        if self.pull:  # of an end and a face of one thing it may be either
            hits = [hit for hit in hits if _as_said(hit[0], self.near[self.age])]
        if not hits:
            for c in (c for c in near if self.drops(c)):
                with suppress(Unsettled, Refuted):
                    entry["time"], when = _dropped(self, c, self.near[self.age])
                    hits = [(when, c)]
                    break
        if not hits:
            raise Unsettled("whether the contacts of an event meet")
        time, clock = min(hits, key=lambda hit: hit[0].m)
        self.ball.times.append(time)
        self.form.times.append(self.form.hit(clock, self.again(clock), ""))
        self._list(entry, clock)
        bodies = {i for c in contacts for i in c if i < len(self.told["scene"]["circles"])}
        tried = {clock}
        rims = [c for c in self.meets if c[1] < 0] if min(self.things) < 0 else []
        for c in [*wanted, *rims, *self.grazing.get(self.age, ())]:
            if c not in tried:
                tried.add(c)
                self._try(entry, c, leaving=c[1] < 0 and c[0] in bodies)
        if self.told["scene"].get("capture"):  # what a pocket takes may slide along a face as its flight ends
            for c in (c for i, _ in entry["enter"] for c in self.of[i] if c[1] in self.faces):
                self._try(entry, c)
        todo = sorted(bodies)
        while todo:
            for c in self.of[todo.pop()]:
                linked = c in self.lasting or c in self.met
                if not linked and c not in tried and not self._left(c):
                    tried.add(c)
                    linked = self._try(entry, c)
                if linked:
                    more = {i for i in c if 0 <= i < self.n} - bodies
                    bodies |= more
                    todo += sorted(more)
        if any("turn" in later for later in self.told["instants"][self.age + 1 : self.age + 2]):
            self._try_all(entry)
        needed = {(push[0], push[1]) for pushes in (*entry["rounds"], entry["enter"]) for push in pushes}
        if missing := needed - self.met.keys() - self.lasting.keys():
            raise Unsettled(f"whether {min(missing)} meet at it")
        self.age -= 1
        del self.ball.times[-1], self.form.times[-1]

    def _left(self, c: Contact) -> bool:
        """Whether a contact was at gap zero on these flights, and does not come to it again."""
        slides = self.pull and c[1] in self.faces and not self.slope(c)  # past an end, perhaps, and then it comes back
        return c in self.parted and not (self.again(c) or slides)

    def _hits(self, c: Contact) -> bool:
        """Whether the gap of two falls through zero on their flights; few bits mostly tell."""
        if self.falls(c):  # sooner or later
            return True
        for world in (self.few, self.ball):
            m = world.meeting(c, world.start(c))
            if isinstance(m, Bowing) or (isinstance(m, Facing) and c[1] in self.faces):
                again, gap, closing = bool(self.again(c)), m.gap.sign(), m.closing.sign()
                ahead = closing == 1 or (gap == 1 and not again) if m.hollow else gap == 1 and closing == -1
                if ahead and (again or m.disc.sign() == 1) and m.there(m.wait(again)) == 1:
                    return True
                continue
            signs = [m.closing.sign(), m.disc.sign()]
            if None not in signs:
                return signs == [-1, 1, 1, 1][: len(signs)]
        return False

    def _list(self, entry: dict[str, Any], c: Contact) -> None:
        entry["met"].append(list(c))
        self.met[c] = self.sign("closing", c)

    def _try_all(self, entry: dict[str, Any]) -> None:
        """Lists whatever is at gap zero where a reversal falls on it: all flights end, and who leaves enters."""
        for c in self.meets:
            self._try(entry, c, leaving=c[1] < 0)

    def _try(self, entry: dict[str, Any], c: Contact, leaving: bool = False) -> bool:
        """Lists a contact whose gap is proved to be zero at the instant; whether it is."""
        if c in self.lasting or c in self.met or c not in self.meets or (self._left(c) and not leaving):
            return False
        ranged = c[1] in self.faces or c[1] in self.arcs
        if ranged and not self.drops(c):
            if self.other(c) in self.parted:
                return False
        elif not (ranged or self.falls(c) or self.drops(c)) and _apart(self, c):
            return False
        for world in (self.few, self.ball):
            m = world.meeting(c, self.age)
            if m.gap.sign() in (-1, 1) or (m.closing.sign() == 1 and not leaving):
                return False
            if ranged and -1 in (world.ask(x, c, self.age).sign() for x in ("foot", "far")):
                return False  # on the line of a face beyond its ends the gap is 0 too
        if not (self.zero("gap", c, self.age) and _beside(self, c)):
            return False
        if self.hollow(c) and not self.drops(c) and not self.sign("closing", c):
            return False
        self._list(entry, c)
        return True

    def settle(self, circles: Set[int]) -> None:
        """As the checker's, of what has not been seen to keep apart while the instant was gathered."""
        found = {c for i in circles & self.movable for c in self.of[i] if c not in self.known}
        for c in found & self.meets:
            if c not in self.cleared:
                self.clear(c, self.age)

    def look(self, world: Any, c: Contact, at: int, turn: int, span: Sequence[int]) -> tuple[int | None, bool, bool]:
        """As the checker's, with few products of whole numbers: a certificate takes half as long again without this."""
        if c in self.bends:
            return super().look(world, c, at, turn, span)
        (x, y, vx, vy, r, *a), (u, v, p, q, s, *b) = world.rough(c[0], at), world.rough(c[1], at)
        far, off, fast, by = a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]
        charge(15_000 + ((far + fast).bit_length() ** 2 >> 10))
        slip = 4 * (far * by + fast * off + off * by)  # by which products with velocities are off
        off, by, x, y = 4 * off * (far + off), 4 * by * (fast + by), u - x, v - y  # and others
        size = 0
        if wall := c[1] >= self.n:
            side, off, slip = world.sides[c], off + slip, by
            gap, rise = -2 * (side * (x * p + y * q) + r * s), turn * side * (vx * p + vy * q)
        else:
            vx, vy, size = turn * (p - vx), turn * (q - vy), (s if c[1] < 0 else r + s) ** 2
            gap, rise = x * x + y * y - size, x * vx + y * vy
        sign, safe = (gap > off) - (gap < -off) or (None if off else 0), rise >= slip
        if sign == 1 and not safe and span[1:]:  # the tangent
            wait = world.wait(*span)
            safe = (gap - off << wait.bits) + 2 * (rise - slip) * (wait.m + wait.r) > 0
        if safe or wall:
            return sign, safe, rise < -slip
        cross, speed = abs(x * vy - y * vx), vx * vx + vy * vy
        falls = rise < -slip and off < size and (cross + slip) ** 2 < (speed - by) * (size - off)
        return sign, cross > slip and (speed + by) * (size + off) < (cross - slip) ** 2, falls

    def flies(self, c: Contact, age: int | None, ends: int = 0) -> None:
        """As the checker's; where two graze on the way, that is noted, and the rest is left to the next try."""
        if 0 <= c[1] < self.n and not ends and not self.again(c):
            start = self.ball.start(c)
            if (start == age and age) or any(world.aside(c, start, age) for world in (self.few, self.ball)):
                return
        try:
            super().flies(c, age, ends)
        except Unsettled:
            missed = _grazes(self, c, age)
            if not missed:
                raise
            self.missed += missed

    # -- witnesses

    def sign(self, question: str, c: Contact) -> int:
        """As the checker's; a slack of zero is shown even where nothing was rounded: in another checker it may be."""
        found: int = super().sign(question, c)
        if question == "slack" and not found:
            self.zero(question, c, self.age)
        return found

    def zero(self, name: str, c: Contact, age: int) -> bool:
        """Whether a number is shown to be zero; a witness that shows it is kept."""
        for asked, d, how, *other in self.zeros:
            if (asked, tuple(d)) == (name, c) and self.proves(name, c, how, *map(tuple, other)):
                return True
        for witness in self._witnesses(name, c, age):
            if witness is None:
                return True
            if self.proves(name, c, *witness):
                self.zeros.append([name, list(c), witness[0], *map(list, witness[1:])])
                return True
        return False

    def _witnesses(self, question: str, c: Contact, age: int) -> Iterator[Any]:
        """What might be a witness, the likeliest and shortest first; None where it is shown to be zero exactly."""
        others: list[tuple[Contact, ...]] = [()]
        if question in ("gap", "closing"):
            others += [(other,) for other in sorted(self.met) if other != self.clock]
        places = range(len(self.isometries))
        if question in ("gap", "closing", "speed"):
            yield from ((k, *other) for other in others for k in places)
        if question == "gap":
            for other in others:
                if to := other[0] if other else self.clock:
                    yield from ((k, *other) for k in self._new(self.likely.between(c, to)))
        elif question in ("closing", "speed"):
            yield from ((k,) for k in self._new(self.likely.holding(c)))
        yield from (("back", *other) for other in others if self.way and c)
        if is_zero(cast(Lazy, self.form.ask(question, c, age))):
            yield None

    def _new(self, found: Iterable[dict[str, Any]]) -> Iterator[int]:
        """The places of isometries in the certificate's list, to which new ones are added."""
        for told in found:
            key = repr((told["matrix"], told["shift"]))
            if key not in self.known_isometries:
                g, now = self.isometry(told), self.rows
                for rows in self.history:
                    self.rows = rows
                    g = (*g[:2], self.mapped(g))
                self.rows = now
                self.known_isometries[key] = len(self.isometries)
                self.isometries.append(g)
                self.told["isometries"].append(told)
            yield self.known_isometries[key]


def _still(prover: Prover, entry: dict[str, Any]) -> None:
    """Of bounces that come to their end at an instant, keeps those of which that is shown: others are not told."""
    first = entry["settle"][0][0]
    for w in prover.worlds:
        w.times.append(w.rest(first))
    prover.calm = {*prover.carried[first]}
    for i in dict.fromkeys(i for i, _ in entry["settle"] if i != first):
        try:
            prover.sign("rest", prover.carried[i][0])
            prover.calm |= {*prover.carried[i]}
        except Unsettled:
            entry["settle"] = [c for c in entry["settle"] if c[0] != i]
    for w in prover.worlds:
        del w.times[-1]


def _apart(prover: Prover, c: Contact) -> bool:
    """Whether few bits tell that two kept apart up to this instant; if so, it is not asked once more."""
    span = [prover.few.start(c), prover.age]
    for turn, at in zip((1, -1), span, strict=True):
        sign, safe, _ = prover.look(prover.few, c, at, turn, span)
        if sign != 1:
            return False
        if safe:
            prover.cleared.add(c)
            return True
    return False


def decimal_text(part: int, bits: int, digits: int) -> str:
    """The decimal nearest to part / 2**bits, with so many digits after the point.

    >>> decimal_text(-3, 1, 2), decimal_text(3, -1, 2)
    ('-1.50', '6.00')
    """
    scale = 10**digits
    twice = 2 * part * scale
    nearest = (twice + (1 << bits)) >> (bits + 1) if bits >= 0 else (twice << -bits) >> 1
    whole, rest = divmod(abs(nearest), scale)
    return f"{'-' if nearest < 0 else ''}{whole}.{rest:0{digits}d}"


def _fallen(said: ExactValue | None, straight: bool, start: Exact, *numbers: Exact) -> Exact:
    """When what falls meets what stands: |d + v s + h s^2| = R, of second degree along a line; or as the run says."""
    dx, dy, vx, vy, hx, hy, reach, *row = numbers
    along = dx * hx + dy * hy
    if straight and along and not (dx * hy - dy * hx or vx * hy - vy * hx):
        square, speed = hx * hx + hy * hy, vx * hx + vy * hy
        gap, approach, half = along - reach * square.sqrt(), speed, square
        if along.sign() < 0:
            gap, approach, half = -along - reach * square.sqrt(), -speed, -square
        if half.sign() < 0 or approach.sign() < 0:
            root = (approach * approach - TWO * TWO * half * gap).sqrt()
            return start + (-approach - root) / (half + half)
    if said is None or (closed := said.exact()) is None:
        raise Unsettled("a zero of a quartic is no exact number here")
    try:
        time = exact_number(Quantity.of(closed.text()))
    except SceneError as fault:
        raise Unsettled(str(fault)) from None
    if value(row, time - start):
        raise Unsettled("another zero")
    return time


def _beside(prover: Prover, c: Contact) -> bool:
    """Of a face or an arc: whether the centre is beside it, between its ends."""
    return (c[1] not in prover.faces and c[1] not in prover.arcs) or prover.within(c)


def _as_said(time: Ball, said: ExactValue) -> bool:
    """Whether a time may be the one at which the run has an instant."""
    text = _spelt(float(said), 14)
    at, scale = int(text.replace(".", "")) << time.bits, 10 ** len(text.partition(".")[2])
    return abs(time.m * scale - at) <= time.r * scale + (1 << time.bits)


def _dropped(prover: Prover, c: Contact, said: ExactValue) -> tuple[str, Ball]:
    """When a circle falls onto one that is fixed: in so many digits that no other zero is as near, and sharply.

    Raises:
        Unsettled: if no number of digits that is tried tells.
        Refuted: if it does not fall onto it then.
    """
    again = prover.again(c)

    def first(texts: Iterable[Callable[[], str]]) -> tuple[str, Ball]:
        for spell in texts:
            with suppress(Unsettled):
                return (text := spell()), prover.ball.hit(c, again, text)
        raise Unsettled("when a circle falls onto one that is fixed")

    nearer = (partial(_spelt, said.digits(digits), digits) for digits in NEARER)
    _, time = first(chain((partial(_spelt, float(said), 16),), nearer))
    return first(partial(prover.decimal, time, prover.digits + more) for more in (0, *NEARER))


def _spelt(value: float | str, digits: int) -> str:
    """A positive time that is right to so many digits but for the last, as a decimal without exponent that is."""
    number = Decimal(value)
    after = max(0, digits - 2 - number.adjusted())
    with localcontext() as context:
        context.prec = digits + after + abs(number.adjusted()) + 9
        return f"{number:.{after}f}"


def _grazes(prover: Prover, c: Contact, age: int | None) -> list[Unlisted]:
    """When two of which one stands graze on their flights, up to an instant, or ever: double zeros of the gap."""
    if c[1] in prover.arcs and not prover.things[c[0]][4]:  # of a point both sides of an arc are at gap zero
        return []
    start, order = prover.again(c) or (prover.ball.start(c), 0)
    m, now = prover.ball.meeting(c, start), None if age is None else prover.ball.wait(start, age)
    found: list[Unlisted] = []
    exact: Any = prover.form.meeting(c, start)
    for zero in computed(exact.row[order:], _double_zeros) or ():
        wait, time = in_ball(zero), computed([prover.form.times[start]], lambda numbers: [numbers[0]])
        beyond = isinstance(m, Arching) and value(m.tests(m.row)[3], wait).sign() != -1
        if time and not beyond and (now is None or (now - wait).sign() != -1):
            found.append(Unlisted(time[0] + zero, prover.ball.times[start].at(wait.bits) + wait, c))
    return found


def is_same(time: Lazy, exact: Exact) -> bool:
    """Whether a time of a run is a number."""
    return is_zero(time - Lazy(exact))


def in_ball(x: Exact) -> Ball:
    """A number to the bits at hand."""
    if not x.k:
        return enclosed(Sum({frozenset(): x.a}))
    return in_ball(x.a) + in_ball(x.b) * in_ball(Exact.roots[x.k - 1]).sqrt()


def _double_zeros(row: Sequence[Exact]) -> list[Exact]:
    """The positive double zeros of a polynomial, but no fourfold one, which no certificate lists.

    Its numbers are fractions, or it is a square.
    """
    if not any(x.k for x in row):
        known = [fmpq(x.a.numerator, x.a.denominator) for x in row]
        zeros = [
            zero for zero in double_zeros_exactly(known) if zero.q or fmpq_poly(known).derivative().derivative()(zero.p)
        ]
        parts = [(zero.q, [Exact(Fraction(int(x.p), int(x.q))) for x in (zero.p, zero.square)]) for zero in zeros]
        return [p + square.sqrt() if q > 0 else p - square.sqrt() if q else p for q, (p, square) in parts]
    if len(row) < 5 or not row[4]:
        return []
    c, b, a = (x / row[4] for x in row[1:4])
    half = a / TWO  # s^2 + half s + rest
    rest = (b - half * half) / TWO
    square = half * half / (TWO + TWO) - rest
    if c - (TWO * half) * rest or row[0] - rest * rest * row[4] or square.sign() < 1:
        return []
    root = square.sqrt()
    return [zero for zero in (-half / TWO - root, -half / TWO + root) if zero.sign() > 0]
