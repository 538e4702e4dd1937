"""What a run leaves for one that goes on from it: its instants, and what it had counted by then."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from ..replay.contact import AtWall, Link, Pair
from .history import History, K
from .instants.instant import Instant
from .limits import Limits

Found: TypeAlias = Instant | Pair | AtWall
"""What was gathered for one instant; of a contact alone, the contact."""


class Reached(NamedTuple):
    """How far a run was when it last began to look for an instant.

    Attributes:
        instants: how many it had carried out, besides that at time 0.
        plan: what it had counted.
        rises: how often its precision had risen.
        assumed: how many assumptions it had made.
    """

    instants: int
    plan: dict[str, int]
    rises: int
    assumed: int


_new = tuple.__new__
"""Makes a named tuple of all its fields: what its own constructor does, in a third of the time."""


@dataclass
class Tape:
    """The instants of a run, in order, without that at time 0.

    Attributes:
        limits: where the run was to end.
        found: the instants.
        reached: how many of them are whole, with all that followed from them; None before the first look.
        rises: as the history has them.
        grazes: by the number of the instant at which the later of their flights begins: the pairs proved to graze.
    """

    limits: Limits
    found: list[Found] = field(default_factory=list)
    reached: Reached | None = None
    rises: list[tuple[int, bool]] = field(default_factory=list)
    grazes: dict[int, list[Link]] = field(default_factory=dict)

    def mark(self, history: History[K]) -> None:
        """Called before each look for an instant."""
        done = len(self.found)
        if self.reached is None or self.reached.instants != done:
            self.reached = _new(Reached, (done, dict(history.plan), len(history.rises), len(history.assumptions)))

    def add(self, instant: Instant, *, whole: bool) -> None:
        """An instant that was gathered; kept `whole`, or as its contact if that stands alone.

        Where strides may be taken a contact is what one carried out, so that it is carried out again like that.
        """
        link = instant.clock
        if (
            not whole
            and isinstance(link, Pair | AtWall)
            and instant == Instant(instant.number, hits=(link,), clock=link)
        ):
            self.found.append(link)
        else:
            self.found.append(instant)

    def whole(self) -> list[Found]:
        """The instants up to where all that followed from them is known."""
        return [] if self.reached is None else self.found[: self.reached.instants]


def instant_of(found: Found, number: int) -> Instant:
    """An instant, from what a tape keeps of it and its number.

    >>> instant_of(Pair(0, 1), 2).hits
    (Pair(a=0, b=1),)
    """
    return found if isinstance(found, Instant) else Instant(number, hits=(found,), clock=found)
