"""Follows a run as the checker does, and finds the witness of each zero that the checker will ask for.

The checker's own program decides what has to be shown: where its intervals leave a number in doubt, a witness is looked
for, and kept if the checker accepts it. So nothing here is trusted.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, cast

from ...tools.verify import ROOTS, WORK, Ball, Checker, Exact, Undecided, put
from .isometries import Contact, Isometries

GUARD = 64
"""Bits kept below the width of what is known, so that rounding adds nothing to it."""

LEAST = 128
"""Bits that are kept in any case: of large numbers none after the point may be known."""

CHEAP_ROOTS, DEEP_ROOTS = 2, 7
"""Roots beyond the scene's that an exact witness may take: first, to compare two times; at last."""

CHEAP_WORK, DEEP_WORK = 1 << 26, 1 << 32
"""Work that an exact witness may take at first, and at last (see `Exact.work`): a part of a second; some seconds."""


class Prover(Checker):
    """Makes the instants of a certificate.

    Args:
        certificate: all but the witnesses, times and final state; it is completed in place.
        contacts: for each instant from time 0 on, the contacts of its event.
        digits: decimals after the point of the times and of the final state.
    """

    def __init__(self, certificate: dict[str, Any], contacts: list[frozenset[Contact]], digits: int) -> None:
        super().__init__(certificate)
        self.contacts = contacts
        self.digits = digits
        self.known_isometries: dict[str, int] = {}
        self.likely = Isometries(self.things, self.n)
        self.drops: list[list[int]] = []
        self.upto: Ball | None = None
        self.idle = False

    def run(self) -> None:
        """Completes the certificate, with the bits that it says.

        Raises:
            Undecided: if these bits do not suffice, or a zero has no witness.
            Refuted: if the run is wrong.
        """
        self.check()
        final: dict[str, Any] = self.told["final"]
        final["time"] = self.decimal(cast(Ball, self.time))
        for i in range(self.n):
            final["circles"][i] = [self.decimal(value) for value in put(self.flights[i], self.time, self.age)[:4]]

    # -- what the checker reads, and this writes

    def take(self, entry: dict[str, Any], clock: Contact | None) -> None:
        """Starts the list of an entry's witnesses."""
        super().take(entry, clock)
        self.zeros: list[list[Any]] = entry.setdefault("zeros", [])

    def said(self, value: Ball, text: str) -> None:
        """Nothing: numbers are written, not read."""

    def decimal(self, value: Ball) -> str:
        """A number to the digits asked for.

        Raises:
            Undecided: if it is not known so sharply.
        """
        scale = 10**self.digits
        if value.r * scale * 8 > 1 << Ball.bits:
            raise Undecided("a number is not known to as many digits")
        nearest = (2 * value.m * scale + (1 << Ball.bits)) >> (Ball.bits + 1)
        whole, part = divmod(abs(nearest), scale)
        return f"{'-' if nearest < 0 else ''}{whole}.{part:0{self.digits}d}"

    def open(self, entry: dict[str, Any]) -> None:
        """Time 0."""
        self.number = 0
        self.drops.clear()
        super().open(entry)

    def instant(self, entry: dict[str, Any]) -> None:
        """Gathers what falls on an instant, then checks it."""
        self.number += 1
        width = max(x.r.bit_length() for flight in self.flights.values() for x in cast(tuple[Ball, ...], flight[:5]))
        if width > 2 * GUARD and Ball.bits > LEAST:
            self.fall(max(Ball.bits - (width - GUARD), LEAST))
            self.drops.append([self.number, Ball.bits])
        self.shown: set[Contact] = set()
        self.upto, self.idle = None, True
        self._gather(entry, self.contacts[self.number])
        self.idle = False
        entry["time"], self.shown = "0", self.tied
        super().instant(entry)
        entry["time"] = self.decimal(cast(Ball, self.time))

    # -- what falls on an instant

    def _gather(self, entry: dict[str, Any], contacts: frozenset[Contact]) -> None:
        """Lists the contacts that meet at an instant, first the one whose meeting is its time, and the grazes."""
        self.tied = set()
        met: dict[Contact, tuple[str, Any]] = {c: known for c in self.meets if (known := self.next(c))[0] != "never"}
        wanted = contacts or {(i, -1 - k) for i, k in entry["entries"]}
        hits = [(met[c][1].m, c) for c in wanted if c in met and met[c][0] == "hit"]
        if not hits:
            if wanted:
                raise Undecided("whether the contacts of an event meet")
            return
        clock = min(hits)[1]
        self.upto, self.idle = met[clock][1], False
        time: Ball = met[clock][1]
        entry["arrive"], entry["grazes"], self.tied = [list(clock)], [], {clock}
        self.take(entry, clock)
        for c, (kind, when) in met.items():
            if kind == "hit" and c != clock and (c in contacts or c[1] < 0) and (when - time).sign() in (None, 0):
                self._list(entry["arrive"], c, when - time)
        bodies = {i for c in contacts for i in c if i < self.n}
        grown = bool(contacts)
        while grown:
            before = len(bodies)
            for c in met:
                near = 0 <= c[1] < self.n and c not in self.tied and bodies & set(c)
                if (
                    near
                    and self._grazes(c, time)
                    and self._list(entry["grazes"], c, cast(Ball, self.nexts[c][1]) - time)
                ):
                    bodies |= set(c)
            for c in self.lasting:
                if bodies & set(c):
                    bodies |= {i for i in c if i < self.n}
            grown = len(bodies) > before

    def _list(self, listed: list[list[int]], c: Contact, wait: Ball) -> bool:
        """Lists a contact whose meeting is proved to be at the instant; whether it is."""
        if wait.sign() is None and not self.zero("tie", c, wait):
            return False
        listed.append(list(c))
        self.tied.add(c)
        return True

    def _grazes(self, c: Contact, time: Ball) -> bool:
        """Whether two graze at a time, as far as intervals tell."""
        when: Any
        kind, when = self.next(c)
        return kind == "graze" and (when - time).sign() in (None, 0)

    def close(self, end: dict[str, Any]) -> None:
        """The end."""
        self.upto = self.due.get("until")
        super().close(end)

    # -- witnesses

    def zero(self, question: str, c: Contact, value: Ball, must: bool = True) -> bool:
        """Whether a witness is found; it is kept. That two graze or fly abreast is shown only where it has to be."""
        if (question == "graze" or not must) and (self.idle or self._waits(c)):
            return False
        if question == "tie" and c in self.shown:
            return True
        for witness in self._witnesses(question, c):
            if self._accepts(question, c, value, witness):
                told = [question, list(c), witness[0], *map(list, witness[1:])]
                if told not in self.zeros:
                    self.zeros.append(told)
                return True
        return False

    def _waits(self, c: Contact) -> bool:
        """Whether two that are in doubt have not met by the instant at hand."""
        return self.upto is not None and self.apart(self.meeting(self.flights, c), self.upto)

    def _accepts(self, question: str, c: Contact, value: Ball, witness: tuple[Any, ...]) -> bool:
        spent = Exact.work
        try:
            return self.proves(question, c, value, *witness)
        except Undecided:
            Exact.work = spent
            return False

    def _witnesses(self, question: str, c: Contact) -> Iterator[tuple[Any, ...]]:
        """What might be a witness, the likeliest and shortest first."""
        yield from [(w, *map(tuple, o)) for q, other, w, *o in self.zeros if q == question and tuple(other) == c]
        others: list[tuple[Contact, ...]] = [()]
        if question == "tie":
            others += [(other,) for other in sorted(self.tied) if other != self.clock]
            for other in others:
                at = other[0] if other else self.clock
                known = range(len(self.told["isometries"]))
                yield from ((k, *other) for k in known if self.image(self.isometries[k][1], c) == at)
        elif question in ("still", "together"):
            yield from ((k,) for k in range(len(self.told["isometries"])))
        yield from self._exact(CHEAP_ROOTS, CHEAP_WORK)
        if question == "tie":
            for other in others:
                found = self.likely.between(c, other[0] if other else self.clock)
                yield from ((k, *other) for k in self._new(found))
        elif question in ("still", "together"):
            yield from ((k,) for k in self._new(self.likely.holding(c)))
        if question in ("tie", "graze", "until"):
            yield from (("back", *other) for other in others)
        yield from self._exact(DEEP_ROOTS, DEEP_WORK)

    def _exact(self, roots: int, work: int) -> Iterator[tuple[str]]:
        """An exact witness, with no more roots and work than that."""
        Exact.most, Exact.budget = len(Exact.roots) + roots, Exact.work + work
        try:
            yield ("exact",)
        finally:
            Exact.most, Exact.budget = ROOTS, WORK

    def _new(self, found: Iterable[dict[str, Any]]) -> Iterator[int]:
        """The places of isometries in the certificate's list, to which new ones are added."""
        for told in found:
            key = repr((told["matrix"], told["shift"]))
            if key not in self.known_isometries:
                k = self.known_isometries[key] = len(self.told["isometries"])
                self.isometries[k] = self.isometry(told)
                self.told["isometries"].append(told)
            yield self.known_isometries[key]
