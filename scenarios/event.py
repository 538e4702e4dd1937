"""What happens at instants: contacts, how it is known that they are simultaneous, entries, the reversal."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from .lazy.frozen import frozen
from .numbers.real import Real


class Contact(NamedTuple):
    """Two touching things by id: the circle that comes first in the scene is first, a wall is last."""

    first: str
    second: str


class TieProof(Enum):
    """How it is known that several contacts fall on one instant; weakest last."""

    CONSTRUCTION = "the same instant by construction"
    RATIONAL = "computed in rational numbers"
    FIELD = "signs of coefficients in the field of the state"
    SYMMETRY = "an isometry maps the causal past of the one to that of the other"
    WAY_BACK = "the way back retraces a tie of the way out"
    TOWER = "replayed in nested square roots in normal form"
    ASSUMED = "agreement to as many bits as the user asked for: an assumption"
    FLOAT = "equal in the engine's own finite precision"

    @property
    def proved(self) -> bool:
        """Whether this is a proof."""
        return self not in (TieProof.ASSUMED, TieProof.FLOAT)


@frozen
class Tie:
    """Several contacts on one instant, and how that is known.

    Attributes:
        contacts: the contacts shown to be simultaneous.
        proof: on what that rests.
        bound: for ASSUMED, the bits of agreement.
    """

    contacts: tuple[Contact, ...]
    proof: TieProof
    bound: int | None = None


@frozen
class Assumption:
    """A decision that rests on less than proof; everything from its event on rests on it.

    Attributes:
        event: index of the first event that follows from it.
        question: what was decided, in words.
        proof: on what that rests.
        bound: as in `Tie`.
    """

    event: int
    question: str
    proof: TieProof
    bound: int | None = None

    def __str__(self) -> str:
        return (
            f"from event {self.event} on, this rests on a zero that is not proved ({self.question}): "
            f"agreement to {self.bound} bits"
        )


@frozen
class Event:
    """One instant at which contacts collide.

    Attributes:
        index: place in the trajectory, from 0.
        time: the instant; float(time) is the nearest double.
        contacts: the contacts that took part, in scene order: those that approach as the instant comes, and
            those that come to approach in its rounds of impulses.
        impulses: the pairwise impulses in the order applied; their number is the number of collisions.
        ties: how it is known that the contacts are simultaneous; empty for a single contact.
        coupled: whether the order of the impulses could matter: some circle takes part in several contacts that
            are not at right angles to each other.
    """

    index: int
    time: Real
    contacts: tuple[Contact, ...]
    impulses: tuple[Contact, ...]
    ties: tuple[Tie, ...] = ()
    coupled: bool = False


@frozen
class Reversal:
    """The one moment at which every velocity was negated.

    Attributes:
        after: number of instants before it.
        time: the moment.
    """

    after: int
    time: Real


@frozen
class Pocketing:
    """The centre of a circle enters a pocket.

    Attributes:
        circle: the circle's id.
        pocket: the pocket's id.
        time: the instant.
    """

    circle: str
    pocket: str
    time: Real
