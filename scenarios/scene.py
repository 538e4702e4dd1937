"""Circles, walls and the scene that they make: frozen, exact, validated."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

from .errors import SceneError
from .numbers.quantity import ZERO, Quantity, QuantityLike
from .tie_policy import TiePolicy

FIXED = "oo"
"""The mass of a circle that never moves."""

MAX_CIRCLES = 5_000
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
    the limit of infinite mass. `point=True` allows the radius 0 of a point ball. A missing id is filled in by
    the scene (`c1`, `c2`, ...).

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
    ) -> None:
        _checked_id("circle", id)
        put = object.__setattr__
        put(self, "id", id)
        if not isinstance(point, bool):
            raise SceneError(f"{_label('circle', id)}: point = {point!r} is not true or false")
        put(self, "point", point)
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


def _is_infinite(m: Any) -> bool:
    if isinstance(m, str):
        return m.strip() == FIXED
    if isinstance(m, float):
        return m == float("inf")
    return hasattr(m, "free_symbols") and str(m) == FIXED  # SymPy's infinity


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


@dataclass(frozen=True)
class Scene:
    """Circles and walls at time 0, with the tie policy and, optionally, a reversal and a default horizon.

    Attributes:
        circles: the circles, in the order that names contacts and breaks sequential ties.
        walls: the walls, after the circles in that order.
        name: what reports call the scene.
        tie_policy: see `TiePolicy`; text is parsed.
        reverse_after: negate every velocity once, right after this many instants.
        reverse_at: negate every velocity once, at this time (not both).
        until: default time limit of a run.
        events: default limit on the number of instants of a run.
        pockets: round pockets; where a centre enters one is reported with the trajectory's outcome.
        capture: whether a circle that enters a pocket leaves play.
        description, source: what the scene shows and where it comes from.

    Raises:
        SceneError: for overlapping circles, a circle across a wall, duplicate ids, limits that are not positive.

    >>> scene = Scene([Circle(0, 0, vx=1), Circle(4, 0)], [Wall(7, 0, 7, 1)])
    >>> [c.id for c in scene.circles], scene.walls[0].id
    (['c1', 'c2'], 'w1')
    """

    circles: tuple[Circle, ...]
    walls: tuple[Wall, ...] = ()
    name: str = "scene"
    tie_policy: TiePolicy = field(default_factory=TiePolicy)
    reverse_after: int | None = None
    reverse_at: Quantity | None = None
    until: Quantity | None = None
    events: int | None = None
    pockets: tuple[Pocket, ...] = ()
    capture: bool = False
    description: str = ""
    source: str = ""

    def __init__(
        self,
        circles: Any,
        walls: Any = (),
        name: str = "scene",
        tie_policy: str | TiePolicy = "simultaneous",
        reverse_after: int | None = None,
        reverse_at: QuantityLike | None = None,
        until: QuantityLike | None = None,
        events: int | None = None,
        pockets: Any = (),
        capture: bool = False,
        description: str = "",
        source: str = "",
    ) -> None:
        put = object.__setattr__
        put(self, "circles", tuple(_named(circles, "c")))
        put(self, "walls", tuple(_named(walls, "w")))
        put(self, "pockets", tuple(_named(pockets, "p")))
        put(self, "name", name)
        put(self, "tie_policy", TiePolicy.parse(tie_policy))
        put(self, "capture", capture)
        put(self, "description", description)
        put(self, "source", source)
        put(self, "reverse_after", positive_count("reverse_after", reverse_after))
        put(self, "events", positive_count("events", events))
        put(self, "reverse_at", positive_time("reverse_at", reverse_at))
        put(self, "until", positive_time("until", until))
        self._validate()

    def _validate(self) -> None:
        if not isinstance(self.name, str) or not self.name:
            raise SceneError(f"name = {self.name!r} is not text; give the scene a name")
        if not self.circles:
            raise SceneError("the scene has no circle; add at least one [[circle]]")
        if len(self.circles) > MAX_CIRCLES:
            raise SceneError(f"the scene has {len(self.circles)} circles; at most {MAX_CIRCLES}")
        if self.reverse_after is not None and self.reverse_at is not None:
            raise SceneError("reverse_after and reverse_at are both set; keep one of them")
        if not isinstance(self.capture, bool):
            raise SceneError(f"capture = {self.capture!r} is not true or false")
        seen: set[str | None] = set()
        for thing in (*self.circles, *self.walls, *self.pockets):
            if thing.id in seen:
                raise SceneError(f"id {thing.id!r} is used twice; give every circle, wall and pocket an id of its own")
            seen.add(thing.id)
        from .validation import check_apart

        check_apart(self)

    @cached_property
    def ids(self) -> tuple[str, ...]:
        """Ids of the circles, then of the walls: the scene order."""
        return tuple(str(thing.id) for thing in (*self.circles, *self.walls))

    def with_changes(self, **changes: Any) -> Scene:
        """A copy with some attributes replaced.

        >>> Scene([Circle(0, 0)]).with_changes(name="lonely").name
        'lonely'
        """
        values = {key: getattr(self, key) for key in self.__dataclass_fields__}
        return Scene(**{**values, **changes})

    def data(self) -> dict[str, Any]:
        """The scene as plain text and whole numbers, in the form of the scene files."""
        data: dict[str, Any] = {"name": self.name, "tie_policy": str(self.tie_policy)}
        if self.description:
            data["description"] = self.description
        if self.source:
            data["source"] = self.source
        for key in ("reverse_after", "events"):
            if getattr(self, key) is not None:
                data[key] = getattr(self, key)
        for key in ("reverse_at", "until"):
            if getattr(self, key) is not None:
                data[key] = getattr(self, key).text()
        if self.capture:
            data["capture"] = True
        data["circle"] = [_texts(c, ("x", "y", "r", "vx", "vy", "m")) for c in self.circles]
        for circle, row in zip(self.circles, data["circle"], strict=True):
            if circle.point:
                row["point"] = True
        if self.walls:
            data["wall"] = [_texts(w, ("x0", "y0", "x1", "y1")) for w in self.walls]
        if self.pockets:
            data["pocket"] = [_texts(p, ("x", "y", "r")) for p in self.pockets]
        return data

    @property
    def digest(self) -> str:
        """SHA-256 of what decides the history: everything but name, description, source and default horizon."""
        told = {"name", "description", "source", "until", "events"}
        data = {key: value for key, value in self.data().items() if key not in told}
        return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def _named(things: Any, letter: str) -> list[Any]:
    """The things, those without an id named by letter and number."""
    import dataclasses

    named = []
    for number, thing in enumerate(things, start=1):
        if thing.id is None:
            values = {f.name: getattr(thing, f.name) for f in dataclasses.fields(thing)}
            thing = type(thing)(**{**values, "id": f"{letter}{number}"})
        named.append(thing)
    return named


def _texts(thing: Any, keys: tuple[str, ...]) -> dict[str, Any]:
    row: dict[str, Any] = {"id": thing.id}
    for key in keys:
        value = getattr(thing, key)
        row[key] = value if isinstance(value, str) else value.text()
    return row


def positive_count(key: str, value: Any) -> int | None:
    """A limit on a number of instants.

    Raises:
        SceneError: unless it is None or a whole number from 1.
    """
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise SceneError(f"{key} = {value!r}: must be a whole number from 1")
    return value


def positive_time(key: str, value: QuantityLike | None) -> Quantity | None:
    """A time limit.

    Raises:
        SceneError: unless it is None or an exact number above zero.
    """
    if value is None:
        return None
    try:
        time = Quantity.of(value)
    except SceneError as error:
        raise SceneError(f"{key} = {error}") from None
    if time.sign() <= 0:
        raise SceneError(f"{key} = {time.brief()}: must be above zero")
    return time
