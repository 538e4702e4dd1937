"""What an engine reports, checked: times, contacts, states."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from ....scenarios.trajectory import Contact
from ...validation import EngineError, checked_number, falls
from .impulses import Row

if TYPE_CHECKING:
    from ....scenarios.scene import Scene

States: TypeAlias = "Mapping[str, Sequence[float]] | Sequence[Sequence[float]]"
"""x, y, vx, vy by the ids of circles; or of all circles, in scene order."""


class Reports:
    """Checks what is reported of a scene.

    Attributes:
        where: what an error begins with: the engine, or the line of a log.
    """

    def __init__(self, scene: Scene, where: str) -> None:
        self.where = where
        self._ids = scene.ids
        self._places = {name: place for place, name in enumerate(scene.ids)}
        self._circles = [str(circle.id) for circle in scene.circles]

    def time(self, time: Any, last: float, bits: int | None) -> float:
        """A time that may follow the last one, of an engine of so many bits.

        Raises:
            EngineError: for one that is no finite number, or goes back by more than rounding.
        """
        now = self._number("time", time)
        if now < 0:
            raise EngineError(f"{self.where}: time = {now!r} is before the start; times are from 0")
        if falls(last, now, bits):
            raise EngineError(f"{self.where}: time = {now!r} comes before {last!r}, the one before it; sort them")
        return now

    def contact(self, pair: Any) -> Contact:
        """A pair in scene order; unknown names are left for the check of the event.

        Raises:
            EngineError: if it is no pair of texts.
        """
        if not isinstance(pair, Sequence) or [type(name) for name in pair] != [str, str]:
            raise EngineError(f"{self.where}: contact = {str(pair)[:60]}; must be two ids, as text")
        first, second = pair
        swap = self._places.get(first, -1) > self._places.get(second, len(self._places))
        return Contact(second, first) if swap else Contact(first, second)

    def states(self, states: Any) -> dict[int, Row]:
        """States by the places of their circles.

        Raises:
            EngineError: for an unknown circle, and for a number that is none, or not finite.
        """
        if not isinstance(states, Mapping):
            try:
                states = dict(zip(self._circles, states, strict=True))
            except (TypeError, ValueError):
                raise EngineError(
                    f"{self.where}: states = {str(states)[:60]}; must be x, y, vx, vy by id, or of all "
                    f"{len(self._circles)} circles in scene order"
                ) from None
        found: dict[int, Row] = {}
        for name, row in states.items():
            place = self._places.get(name, len(self._circles))
            if place >= len(self._circles):
                raise EngineError(f"{self.where}: states has {name!r}, which is no circle of the scene; use its ids")
            try:
                x, y, vx, vy = row
            except (TypeError, ValueError):
                raise EngineError(f"{self.where}: states: {name!r} = {str(row)[:60]}; must be x, y, vx, vy") from None
            label = f"states: {name!r}: "
            found[place] = (
                self._number(f"{label}x", x),
                self._number(f"{label}y", y),
                self._number(f"{label}vx", vx),
                self._number(f"{label}vy", vy),
            )
        return found

    def check_all(self, wanted: set[int], given: Mapping[int, Row]) -> None:
        """Refuses states that leave out a circle which collides."""
        missing = wanted - given.keys()
        if missing:
            raise EngineError(
                f"{self.where}: states lacks {self._ids[min(missing)]!r}, which collides; "
                "give every circle that takes part, or no states at all"
            )

    def _number(self, label: str, value: Any) -> float:
        if isinstance(value, bool | str):
            raise EngineError(f"{self.where}: {label} = {value!r}; must be a number")
        return checked_number(f"{self.where}: {label}", value)


def rounded_to(value: float, bits: int | None) -> float:
    """A double rounded to fewer bits, ties to even; wider numbers stay doubles.

    >>> rounded_to(0.1, 24), rounded_to(0.1, 53)
    (0.10000000149011612, 0.1)
    """
    if bits is None or bits >= 53:
        return value
    mantissa, exponent = math.frexp(value)
    return math.ldexp(round(math.ldexp(mantissa, bits)), exponent - bits)
