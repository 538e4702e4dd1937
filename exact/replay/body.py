"""One circle as it flies."""

from __future__ import annotations

from collections.abc import Sequence

from ..numbers.system import Number


class Body:
    """One circle's state: position and velocity at its own clock t.

    Attributes:
        x, y, vx, vy, t: it flies through (x, y) at time t with velocity (vx, vy).
        instant, late: the instant of its last contact, and the time from t to it (None: it is t itself).
        r, w: radius and inverse mass.
        rest: whether its velocity is exactly zero.
        last: number of log steps done when it was last touched; tells the later of two clocks.
        serial: how often its velocity has changed; tells stale predictions.
        q: its state as predictions use it.
        f: that state as doubles, where their error is bounded; None where not.
        kind, acc: for the exact engine: which radius it has, how many bits of it are known.
    """

    __slots__ = (
        "acc", "f", "index", "instant", "kind", "last", "late", "q", "r", "rest", "serial",
        "t", "vx", "vy", "w", "x", "y",
    )  # fmt: skip

    def __init__(self, index: int, state: Sequence[Number], t: Number, r: Number, w: Number) -> None:
        self.index = index
        self.x, self.y, self.vx, self.vy = state
        self.t = t
        self.instant = t
        self.late: Number | None = None
        self.r = r
        self.w = w
        self.q: tuple[Number, ...] = ()
        self.f: tuple[float, ...] | None = None
        self.rest = False
        self.last = 0
        self.serial = 0
        self.kind = 0
        self.acc = 0

    def become(self, other: Body) -> None:
        """Takes over the numbers of the same body, computed again."""
        self.x, self.y, self.vx, self.vy, self.t = other.x, other.y, other.vx, other.vy, other.t
        self.instant, self.late, self.acc = other.instant, other.late, other.acc
        self.r, self.w = other.r, other.w

    def __repr__(self) -> str:
        return f"Body({self.index}, x={self.x}, y={self.y}, vx={self.vx}, vy={self.vy}, t={self.t})"
