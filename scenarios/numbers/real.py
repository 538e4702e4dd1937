"""What the numbers of every run can do, whatever the engine counts in."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, SupportsFloat, runtime_checkable

from ..errors import SceneError
from .doubles import Double
from .quantity import Quantity

if TYPE_CHECKING:
    from flint import arb


@runtime_checkable
class Real(Protocol):
    """A number of a run: a time, a coordinate, a speed. `Quantity` and `Double` are two; engines have more.

    The enclosures hold what the engine knows: the value itself, or an interval that is as narrow as it gets.
    """

    def __float__(self) -> float:
        """The nearest double; the middle of an interval."""
        ...

    def bounds(self) -> tuple[float, float]:
        """Doubles at or below, and at or above, the value."""
        ...

    def text(self) -> str | None:
        """The exact value in the grammar of scene files; None where it is not known, or too deep to be written."""
        ...

    def digits(self, count: int) -> str:
        """The value in decimals: as many digits as are known, and at most `count`; "" if none is."""
        ...

    def ball(self, bits: int) -> arb:
        """An enclosure, to about `bits` bits where the engine can go that far."""
        ...


def real(value: Any) -> Real:
    """A number of any engine as a `Real`: those of an engine that hands back plain floats are doubles.

    >>> real(0.375).text(), real(10**400).bounds()[1], real("sqrt(2)").digits(10)
    ('3/8', inf, '1.414213562')
    """
    if type(value) is float:
        return Double(value)
    if isinstance(value, Real):
        return value
    if isinstance(value, float):
        return Double(value)
    try:
        return Quantity.of(value)
    except SceneError:
        number: SupportsFloat = value
        return Double(number)
