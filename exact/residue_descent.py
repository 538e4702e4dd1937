"""Depth-first search for homomorphisms: from the field of a past to the residues modulo one prime."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any, Protocol

from flint import fmpq, fmpz  # type: ignore[attr-defined]

from .numbers.residue import Residue, Residues
from .questions import RootSum
from .root_past import RootMachine, restore, snapshot
from .root_survey import GaveUp, Survey, Tie, needs


class _Dead(Exception):
    """A place that leads no further, and the free roots that are to blame, as bits."""

    def __init__(self, blame: int) -> None:
        super().__init__()
        self.blame = blame


class Watch(Protocol):
    """What learns from a descent."""

    def examine(self, descent: Descent, index: int, value: Residue, along: tuple[Residue, ...]) -> None:
        """Sees a radicand for the first time, modulo any prime."""
        ...

    def note(self, index: int, modulus: fmpz, residue: bool) -> None:
        """Takes down whether a radicand has a root."""
        ...

    def enough(self, index: int) -> bool:
        """Whether nothing is to be learned from a root and those after it."""
        ...

    @property
    def open(self) -> int:
        """The free roots whose other signs would tell more, as bits."""
        ...


class Descent:
    """The homomorphisms to one ring of residues, by depth-first search over the signs of the free roots.

    Args:
        survey: the past and its roots.
        residues: the numbers of K_0 modulo a prime.
        deadline: when to give up, as `time.monotonic()`.
        scout: what is told of each radicand on the way (see `Scout`); None if nothing is to be learned.
    """

    def __init__(self, survey: Survey, residues: Residues, deadline: float, scout: Watch | None = None) -> None:
        self.survey = survey
        self.deadline = deadline
        self.roots = survey.roots
        self.residues = residues
        self.scout = scout
        self.values: list[tuple[Residue, Residue]] = []
        self._chosen: dict[int, tuple[Residue, int | None]] = {}
        self._saved: dict[int, tuple[Any, ...]] = {}

    def leaves(self) -> Iterator[RootSum]:
        """The parts of the number asked for, at places where every radicand has a root.

        The first such place; then, with a scout, those that lie behind other signs of what its open roots
        need.

        Raises:
            ZeroDivisionError: if the prime divides a denominator or a radicand.
            GaveUp: if time is up.
        """
        past, residues = self.survey.past, self.residues
        machine = RootMachine(past.scene, lambda q: residues.number(self.survey.constant(q)), self._root, past.bodies)
        branching = {root.place for root in self.roots if root.exact is None}
        end = len(past.steps)
        place = 0
        while True:
            try:
                while place < end:
                    if place in branching:
                        self._saved[place] = snapshot(machine)
                    past.carry_out(machine, place)
                    place += 1
                if end in branching:
                    self._saved[end] = snapshot(machine)
                yield past.root_sum(machine)
                blame = self.scout.open if self.scout is not None else 0
            except _Dead as dead:
                blame = dead.blame
            if time.monotonic() > self.deadline:
                raise GaveUp(f"time was up on the way through {len(self.roots)} square roots")
            back = self._turn(blame)
            if back is None:
                return
            place = self.roots[back].place
            restore(machine, self._saved[place])

    def _turn(self, blame: int) -> int | None:
        """Takes the other sign of the last root to blame for a dead end; None if there is none.

        Roots after it are forgotten. A root of which both signs are to blame passes the blame on to what it
        depends on and to what else was to blame for its first sign.
        Source: P. Prosser, *Hybrid algorithms for the constraint satisfaction problem* (Computational
        Intelligence 9, 1993), conflict-directed backjumping.
        """
        while blame:
            index = blame.bit_length() - 1
            blame ^= 1 << index
            while next(reversed(self._chosen)) != index:
                self._chosen.popitem()
            root, first = self._chosen[index]
            if first is None:
                self._chosen[index] = (-root, blame)
                return index
            self._chosen.popitem()
            blame |= first | self.roots[index].needs
        return None

    def _root(self, index: int, value: Residue, along: tuple[Residue, ...]) -> Residue:
        plan = self.roots[index]
        if plan.exact is not None:
            root = self.residues.number(plan.exact)
        else:
            if self.scout is not None and not plan.examined:
                plan.examined = True
                plan.needs = needs(self.roots, plan.past)
                self.scout.examine(self, index, value, along)
            root = self._tied(plan.tie, value, along) if plan.tie is not None else self._free(index, value)
        del self.values[index:]
        self.values.append((value, root))
        return root

    def _tied(self, tie: Tie, value: Residue, along: tuple[Residue, ...]) -> Residue:
        square, base = self.base(tie.source, along)
        if value != self.residues.number(tie.ratio) * square:
            raise GaveUp("two radicands agreed modulo one prime by chance")
        root = self.residues.number(tie.factor) * base
        return root if tie.sign > 0 else -root

    def base(self, source: int | str, along: tuple[Residue, ...]) -> tuple[Residue, Residue]:
        """base**2 and base of a tie."""
        if isinstance(source, int):
            return self.values[source]
        if source == "1":
            one = self.residues.number(fmpq(1))
            return one, one
        speed = along[source == "vy"]
        return speed * speed, speed

    def _free(self, index: int, value: Residue) -> Residue:
        chosen = self._chosen.get(index)
        if chosen is not None:
            return chosen[0]
        if self.scout is not None and self.scout.enough(index):
            raise _Dead(self.scout.open)
        root = self.residues.root(value)
        if self.scout is not None:
            self.scout.note(index, self.residues.modulus, root is not None)
        if root is None:
            raise _Dead(self.roots[index].needs)
        self._chosen[index] = (root, None)
        return root
