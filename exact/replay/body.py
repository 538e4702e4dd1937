"""One circle as it flies."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Any, Generic, NamedTuple, TypeAlias

from ..numbers.system import N


class Flight(NamedTuple, Generic[N]):
    """A straight flight from one instant on; it never changes, another one takes its place.

    Attributes:
        x, y, vx, vy, t: it passes (x, y) at time t, the body's clock, with velocity (vx, vy).
        instant, late: the instant from which it holds, and the time from t to that (None: it is t itself).
        last: number of log steps done when the body was last touched; tells the later of two clocks.
        rest: whether the velocity is exactly zero.
    """

    x: N
    y: N
    vx: N
    vy: N
    t: N
    instant: N
    late: N | None = None
    last: int = 0
    rest: bool = False


new_flight: Callable[[type[Flight[Any]], tuple[object, ...]], Flight[Any]] = tuple.__new__  # pyright: ignore[reportUnknownMemberType, reportUnknownVariableType]
"""Makes a `Flight` of nine numbers: what its own constructor does, in a third of the time."""


Doubles: TypeAlias = tuple[float, float, float, float, float, float]
"""(x, y, vx, vy, t) of a flight, and a bound of `late`."""


FAINT = -240
"""Deviations of at most 2**FAINT do not matter to short balls, where numbers are not all but zero themselves."""

Midpoints: TypeAlias = tuple[N, N, N, N, N, int]
"""(x, y, vx, vy, t) of a flight around which it is known, and its `last`."""


class Body(Generic[N]):
    """One circle, or a pocket, which is a body at rest.

    Attributes:
        index: its place among its kind.
        flight: how it flies.
        r, w: radius and inverse mass.
        is_pocket: whether it is one.
        serial: how often its velocity has changed; tells stale predictions.
        until: a double by which its flight ends at a wall, if nothing ends it before.
        q: (x, y, vx, vy, t) as predictions use them.
        f: these as doubles, with a bound of `late`, where their error is bounded; None where not.
        kind, acc: for the exact engine: which radius it has, how many bits of it are known.
    """

    __slots__ = ("_make", "_of", "acc", "f", "flight", "index", "is_pocket", "kind", "q", "r", "serial", "until", "w")

    def __init__(self, index: int, flight: Flight[N], r: N, w: N, is_pocket: bool = False) -> None:
        self.index = index
        self.flight: Flight[N] = flight
        self.r = r
        self.w = w
        self.is_pocket = is_pocket
        self.q: tuple[N, N, N, N, N] = flight[:5]
        self.f: Doubles | None = None
        self.serial = 0
        self.until = inf
        self.kind = 0
        self.acc = 0
        self._make: Callable[..., Flight[N]]
        self._of: tuple[object, ...] | None

    def await_flight(self, make: Callable[..., Flight[N]], *of: object) -> None:
        """Has a new flight made, of some things, when it is first asked for."""
        if type(self) is not WaitingBody:
            object.__setattr__(self, "__class__", WaitingBody)  # for good
        self._make, self._of = make, of

    def become(self, other: Body[N]) -> None:
        """Takes over the numbers of the same body, computed again."""
        self.flight, self.acc, self.r, self.w = other.flight, other.acc, other.r, other.w

    def __repr__(self) -> str:
        return f"Body({self.index}, {self.flight})"


_FLIGHT: Any = Body.__dict__["flight"]
"""Where a flight is kept."""


class WaitingBody(Body[N]):
    """A body whose flights are made when they are asked for: a class of its own, as asking takes longer."""

    __slots__ = ()

    @property
    def flight(self) -> Flight[N]:
        """The flight; made now, where it was left to be."""
        if self._of is not None:
            _FLIGHT.__set__(self, self._make(*self._of))
            self._of = None
        return _FLIGHT.__get__(self)

    @flight.setter
    def flight(self, flight: Flight[N]) -> None:  # pyright: ignore[reportIncompatibleVariableOverride]
        _FLIGHT.__set__(self, flight)
        self._of = None


Landed: TypeAlias = tuple[Body[N], Midpoints[N], Doubles | None]
"""A body whose flight is new, what that is known around, and its doubles; None where they do not tell it."""
