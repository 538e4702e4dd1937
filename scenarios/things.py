"""Circles, walls, segments and pockets: frozen, exact, checked each by itself."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any, Literal

from .errors import SceneError, cut
from .numbers.parsing import is_sympy
from .numbers.quantity import ZERO, Quantity, QuantityLike
from .settings import checked_truth

FIXED = "oo"
"""The mass of a circle that never moves."""

INFINITE = (FIXED, "inf", "+inf", "Infinity")
"""How it may be written: as SymPy, TOML and Python's JSON write it."""

MAX_ID = 64


def _exact(kind: str, name: str | None, key: str, value: QuantityLike) -> Quantity:
    """The value of one key as a Quantity; an error names the thing, the key, the value and the reason."""
    try:
        return Quantity.of(value)
    except SceneError as error:
        raise SceneError(f"{_label(kind, name)}: {key} = {error}") from None


def _label(kind: str, name: str | None) -> str:
    return f"{kind} {name!r}" if name is not None else kind


def _checked_id(kind: str, name: Any) -> None:
    if name is None:
        return
    if not isinstance(name, str) or not name or len(name) > MAX_ID or not name.isprintable():
        raise SceneError(f"{kind}: id = {str(name)[:MAX_ID]!r} is not usable; write 1 to {MAX_ID} printable characters")


@dataclass(frozen=True)
class Circle:
    """A hard disc: centre (x, y), radius r, velocity (vx, vy), mass m.

    Every number is exact (see `Quantity.of`). `m = "oo"` fixes the circle in place (an obstacle): the bounce is
    the limit of infinite mass; `m = "inf"` and `fixed=True` say the same. `point=True` allows the radius 0 of a
    point ball. A missing id is filled in by the scene (`c1`, `c2`, ...).

    Raises:
        SceneError: for a radius or mass that is not positive, or a moving obstacle.

    >>> Circle(x=0, y="sqrt(2)", r=1, vx="1/2", vy=0).m
    Quantity('1')
    """

    x: Quantity
    y: Quantity
    r: Quantity
    vx: Quantity
    vy: Quantity
    m: Quantity | Literal["oo"]
    id: str | None
    point: bool

    def __init__(
        self,
        x: QuantityLike,
        y: QuantityLike,
        r: QuantityLike = 1,
        vx: QuantityLike = 0,
        vy: QuantityLike = 0,
        m: QuantityLike = 1,
        id: str | None = None,
        point: bool = False,
        fixed: bool | None = None,
    ) -> None:
        _checked_id("circle", id)
        put = object.__setattr__
        put(self, "id", id)
        if fixed is not None:
            m = _fixed_mass(id, fixed, m)
        put(self, "point", checked_truth(f"{_label('circle', id)}: point", point))
        for key, value in (("x", x), ("y", y), ("r", r), ("vx", vx), ("vy", vy)):
            put(self, key, _exact("circle", id, key, value))
        put(self, "m", FIXED if _is_infinite(m) else _exact("circle", id, "m", m))
        self._validate()

    def _validate(self) -> None:
        label = _label("circle", self.id)
        sign = self.r.sign()
        if sign < 0 or (sign == 0 and not self.point):
            hint = "; a point ball says point = true" if sign == 0 else ""
            raise SceneError(f"{label}: r = {self.r.brief()}: a radius must be positive{hint}")
        if sign > 0 and self.point:
            raise SceneError(f"{label}: r = {self.r.brief()}: a point ball has r = 0; leave out point, or set r = 0")
        if isinstance(self.m, Quantity) and self.m.sign() <= 0:
            raise SceneError(f'{label}: m = {self.m.brief()}: a mass must be positive (or "oo" for a fixed circle)')
        if self.fixed and (self.vx.sign() or self.vy.sign()):
            raise SceneError(
                f"{label}: m = oo with velocity ({self.vx.brief()}, {self.vy.brief()}): a fixed circle never moves; "
                "set vx = vy = 0, or give a finite mass"
            )

    @property
    def fixed(self) -> bool:
        """Whether the circle is an obstacle of infinite mass."""
        return not isinstance(self.m, Quantity)

    @property
    def inverse_mass(self) -> Quantity:
        """1/m; zero for a fixed circle."""
        return 1 / self.m if isinstance(self.m, Quantity) else ZERO

    @property
    def at_rest(self) -> bool:
        """Whether the velocity is exactly zero."""
        return self.vx.sign() == 0 and self.vy.sign() == 0


def _fixed_mass(id: str | None, fixed: Any, m: QuantityLike) -> QuantityLike:
    """The mass of a circle that is said to be fixed, or not to be.

    Raises:
        SceneError: if its mass, 1 by default, says otherwise.
    """
    label = _label("circle", id)
    if checked_truth(f"{label}: fixed", fixed) == _is_infinite(m):
        return m
    if fixed:
        mass = _exact("circle", id, "m", m)
        if mass == 1:
            return FIXED
        told = f"{label}: fixed = true with m = {mass.brief()}"
        raise SceneError(f"{told}: a fixed circle has no finite mass; keep one of them")
    raise SceneError(f"{label}: fixed = false with m = {cut(m)}: an infinite mass fixes it; keep one of them")


def _is_infinite(m: Any) -> bool:
    if isinstance(m, str):
        return m.strip() in INFINITE
    if isinstance(m, float):
        return m == inf
    return is_sympy(m) and str(m) == FIXED


@dataclass(frozen=True)
class Wall:
    """An infinitely long straight wall through (x0, y0) and (x1, y1), hard on both sides.

    Raises:
        SceneError: if the two points are one.

    >>> Wall(0, 0, 1, 0, id="floor").id
    'floor'
    """

    x0: Quantity
    y0: Quantity
    x1: Quantity
    y1: Quantity
    id: str | None

    is_face = False
    """Whether it is one side of a segment, which ends: see `scenarios.surfaces`."""

    def __init__(
        self, x0: QuantityLike, y0: QuantityLike, x1: QuantityLike, y1: QuantityLike, id: str | None = None
    ) -> None:
        _checked_id("wall", id)
        put = object.__setattr__
        put(self, "id", id)
        for key, value in (("x0", x0), ("y0", y0), ("x1", x1), ("y1", y1)):
            put(self, key, _exact("wall", id, key, value))
        if self.x0 == self.x1 and self.y0 == self.y1:
            raise SceneError(
                f"{_label('wall', id)}: both points are ({self.x0.brief()}, {self.y0.brief()}); "
                "a wall needs two distinct points"
            )

    @property
    def normal(self) -> tuple[Quantity, Quantity]:
        """A vector at right angles to the wall, as long as its two points are apart."""
        return self.y0 - self.y1, self.x1 - self.x0

    def height(self, x: Quantity, y: Quantity) -> Quantity:
        """Signed distance of a point from the wall, times the length of `normal`."""
        nx, ny = self.normal
        return nx * (x - self.x0) + ny * (y - self.y0)


@dataclass(frozen=True)
class Segment:
    """A straight segment from (x0, y0) to (x1, y1), hard on both sides, `r` thick to each side, with round ends.

    Raises:
        SceneError: if the two points are one, or r is negative.

    >>> Segment(0, 0, 1, 0, id="shelf").r
    Quantity('0')
    """

    x0: Quantity
    y0: Quantity
    x1: Quantity
    y1: Quantity
    id: str | None
    r: Quantity

    def __init__(
        self,
        x0: QuantityLike,
        y0: QuantityLike,
        x1: QuantityLike,
        y1: QuantityLike,
        id: str | None = None,
        r: QuantityLike = 0,
    ) -> None:
        _checked_id("segment", id)
        put = object.__setattr__
        put(self, "id", id)
        for key, value in (("x0", x0), ("y0", y0), ("x1", x1), ("y1", y1), ("r", r)):
            put(self, key, _exact("segment", id, key, value))
        if self.x0 == self.x1 and self.y0 == self.y1:
            raise SceneError(
                f"{_label('segment', id)}: both points are ({self.x0.brief()}, {self.y0.brief()}); "
                "a segment needs two distinct points, or write a fixed circle"
            )
        if self.r.sign() < 0:
            raise SceneError(f"{_label('segment', id)}: r = {self.r.brief()}: half a thickness is 0 or more")


@dataclass(frozen=True)
class Pocket:
    """A round pocket: a circle's centre that comes within r of (x, y) has entered it."""

    x: Quantity
    y: Quantity
    r: Quantity
    id: str | None

    def __init__(self, x: QuantityLike, y: QuantityLike, r: QuantityLike, id: str | None = None) -> None:
        _checked_id("pocket", id)
        object.__setattr__(self, "id", id)
        for key, value in (("x", x), ("y", y), ("r", r)):
            object.__setattr__(self, key, _exact("pocket", id, key, value))
        if self.r.sign() <= 0:
            raise SceneError(f"{_label('pocket', id)}: r = {self.r.brief()}: a radius must be positive")
