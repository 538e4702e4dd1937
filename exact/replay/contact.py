"""Circles as they fly, and contacts by index: of two circles, of one with a wall, an arc, or the rim of a pocket."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import lru_cache
from math import hypot, inf, isfinite
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, Protocol, TypeAlias

from ...scenarios.scene import Scene
from ...scenarios.things import Wall
from ...scenarios.trajectory import Contact
from ..laws.formulas import fall_speed, pair_gap, sag
from ..numbers.system import N

if TYPE_CHECKING:
    from typing_extensions import TypeIs

# -- One circle as it flies.


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

Flown: TypeAlias = Flight[N] | Midpoints[N]
"""What tells where a circle is: (x, y, vx, vy, t), and more."""


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

    __slots__ = ("acc", "f", "flight", "index", "is_pocket", "kind", "q", "r", "serial", "until", "w")

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

    def await_flight(self, make: Callable[..., Flight[N]], *of: object) -> None:
        """Has a new flight made, of some things: at once, or by a `WaitingBody` when it is first asked for."""
        self.flight = make(*of)

    def become(self, other: Body[N]) -> None:
        """Takes over the numbers of the same body, computed again."""
        self.flight, self.acc, self.r, self.w = other.flight, other.acc, other.r, other.w

    def __repr__(self) -> str:
        return f"Body({self.index}, {self.flight})"


class WaitingBody(Body[N]):
    """A body whose flights are made when they are asked for: a class of its own, as asking takes longer."""

    __slots__ = ("_made", "_make", "_of")

    def __init__(self, index: int, flight: Flight[N], r: N, w: N, is_pocket: bool = False) -> None:
        super().__init__(index, flight, r, w, is_pocket)
        self._make: Callable[..., Flight[N]]

    def await_flight(self, make: Callable[..., Flight[N]], *of: object) -> None:
        """See `Body`."""
        self._make, self._of = make, of

    @property
    def flight(self) -> Flight[N]:
        """The flight; made now, where it was left to be."""
        if self._of is not None:
            self._made, self._of = self._make(*self._of), None
        return self._made

    @flight.setter
    def flight(self, flight: Flight[N]) -> None:  # pyright: ignore[reportIncompatibleVariableOverride]
        self._made = flight
        self._of: tuple[object, ...] | None = None


Landed: TypeAlias = tuple[Body[N], Midpoints[N], Doubles | None]
"""A body whose flight is new, what that is known around, and its doubles; None where they do not tell it."""


# -- Contacts by index, typed: two circles, a circle and a wall, or an arc, the centre of a circle and a pocket's rim.
#
# Each kind knows which circles it is between, which formulas of a state are its own, and what else sets it apart; what
# works with contacts asks them, and `KINDS` lists them. Of each kind:
#
# - its gap is a polynomial of the time: `flat`, of degree 1, which falls for good or never, and touches without
#   approach only along a whole flight; else of degree 2, |d|^2 - R^2, whose discriminant tells a hit, the earlier
#   zero, from a graze and a miss;
# - whether it is `hollow`, met from within: its gap falls as |d| grows, and the later zero counts;
# - whether it `pushes`; what does not is no obstacle, but reckoned like one: a flight may begin inside of it;
# - `rank`: its place among contacts of one circle;
# - what remains of the gap after a contact: its zero at the instant is never looked for again, as contacts at gap
#   zero are known by name (`Instant.standing`) and left out of the next prediction, whatever rounding makes of it.


def _gap(link: Round, state: Formulas[N]) -> N:
    """See `Flights.round_gap`."""
    return state.round_gap(link)


def _approach(link: Round, state: Formulas[N]) -> N:
    """See `Flights.round_approach`."""
    return state.round_approach(link)


def _closing(link: Round, state: Formulas[N]) -> N:
    """See `State.round_closing`."""
    return state.round_closing(link)


def _hit(link: Round, state: Formulas[N]) -> tuple[N, N]:
    """See `Flights.round_hit`."""
    return state.round_hit(link)


def _parts(link: Round, state: Formulas[N]) -> tuple[N, N, N]:
    """See `Flights.round_parts`."""
    return state.round_parts(link)


class Pair(NamedTuple):
    """Circles a and b, a < b."""

    a: int
    b: int

    pushes = True
    flat = hollow = False
    rank = 0
    gap, approach, closing, hit, parts = _gap, _approach, _closing, _hit, _parts

    @property
    def circles(self) -> tuple[int, ...]:
        """The circles that it is between."""
        return self

    def ends(self, state: Bodies[N]) -> tuple[Body[N], Body[N]]:
        """The two."""
        return state.bodies[self.a], state.bodies[self.b]

    def later(self, state: Formulas[N]) -> Body[N]:
        """The one whose flight is newer."""
        return state.later(self)

    def bounce(self, state: Formulas[N]) -> None:
        """See `State.bounce_pair`."""
        state.bounce_pair(self)

    def arms(self, state: Formulas[N]) -> list[tuple[int, N, N]]:
        """See `State.pair_arms`."""
        return state.pair_arms(self)


class AtWall(NamedTuple):
    """A circle and a wall."""

    circle: int
    wall: int
    kind: str = "wall"

    pushes = True
    flat = True
    hollow = False
    rank = 1

    @property
    def circles(self) -> tuple[int, ...]:
        """The circle."""
        return (self.circle,)

    def later(self, state: Formulas[N]) -> Body[N]:
        """The circle."""
        return state.bodies[self.circle]

    def gap(self, state: Formulas[N]) -> N:
        """See `Flights.wall_gap`."""
        return state.wall_gap(self)

    def approach(self, state: Formulas[N]) -> N:
        """See `Flights.wall_approach`."""
        return state.wall_approach(self)

    def closing(self, state: Formulas[N]) -> N:
        """See `Flights.wall_approach`: without gravity the same at every instant of a flight."""
        return state.wall_approach(self)

    def hit(self, state: Formulas[N]) -> tuple[N, N]:
        """See `Flights.wall_hit`."""
        return state.wall_hit(self)

    def parts(self, state: Formulas[N]) -> tuple[N, N, N]:
        """See `Flights.wall_parts`."""
        return state.wall_parts(self)

    def bounce(self, state: Formulas[N]) -> None:
        """See `State.bounce_wall`."""
        state.bounce_wall(self)

    def arms(self, state: Formulas[N]) -> list[tuple[int, N, N]]:
        """See `State.wall_arms`."""
        return state.wall_arms(self)


class AtArc(NamedTuple):
    """A circle and one side of an arc: the outside, or the hollow one, whose index is odd."""

    circle: int
    arc: int
    kind: str = "arc"

    pushes = True
    flat = False
    rank = 3

    @property
    def circles(self) -> tuple[int, ...]:
        """The circle."""
        return (self.circle,)

    @property
    def hollow(self) -> bool:
        """Whether it is met from within."""
        return self.arc % 2 == 1

    @property
    def other_side(self) -> AtArc:
        """The same circle with the other side."""
        return AtArc(self.circle, self.arc ^ 1)

    def ends(self, state: Bodies[N]) -> tuple[Body[N], Body[N]]:
        """The circle, and that of the arc."""
        return state.bodies[self.circle], state.arcs[self.arc]

    def later(self, state: Formulas[N]) -> Body[N]:
        """The circle."""
        return state.bodies[self.circle]

    def gap(self, state: Formulas[N]) -> N:
        """See `Flights.round_gap`; within a hollow side it falls as |d| grows."""
        return -state.round_gap(self) if self.hollow else state.round_gap(self)

    def approach(self, state: Formulas[N]) -> N:
        """See `Flights.round_approach`."""
        return -state.round_approach(self) if self.hollow else state.round_approach(self)

    def closing(self, state: Formulas[N]) -> N:
        """See `State.round_closing`."""
        return -state.round_closing(self) if self.hollow else state.round_closing(self)

    def hit(self, state: Formulas[N]) -> tuple[N, N]:
        """See `Flights.arc_hit`."""
        return state.arc_hit(self)

    def parts(self, state: Formulas[N]) -> tuple[N, N, N]:
        """See `Flights.round_parts`; a hollow side is met at the later zero."""
        p, q, d = state.round_parts(self)
        return (p, -q, d) if self.hollow else (p, q, d)

    def bounce(self, state: Formulas[N]) -> None:
        """See `State.bounce_arc`."""
        state.bounce_arc(self)

    def arms(self, state: Formulas[N]) -> list[tuple[int, N, N]]:
        """See `State.arc_arms`."""
        return state.arc_arms(self)


class Entry(NamedTuple):
    """The centre of a circle and the rim of a pocket."""

    circle: int
    pocket: int
    kind: str = "pocket"

    pushes = flat = hollow = False
    rank = 2
    gap, approach, closing, hit, parts = _gap, _approach, _closing, _hit, _parts

    @property
    def circles(self) -> tuple[int, ...]:
        """The circle."""
        return (self.circle,)

    def ends(self, state: Bodies[N]) -> tuple[Body[N], Body[N]]:
        """The circle and the pocket."""
        return state.bodies[self.circle], state.pockets[self.pocket]

    def later(self, state: Formulas[N]) -> Body[N]:
        """The circle."""
        return state.bodies[self.circle]


Touch: TypeAlias = Pair | AtWall | AtArc
"""A contact through which an impulse can pass."""

Round: TypeAlias = Pair | AtArc | Entry
"""A contact whose gap is |d|^2 - R^2; of a hollow side, less that."""

Link: TypeAlias = Pair | AtWall | AtArc | Entry
"""Any of them."""

KINDS: Mapping[str, Callable[[int, int], Link]] = {"": Pair, "wall": AtWall, "arc": AtArc, "pocket": Entry}
"""How each kind is written beside its two indices, and what makes it."""


def can_push(link: Link | None) -> TypeIs[Touch]:
    """Whether an impulse can pass through a contact, if there is one."""
    return link is not None and link.pushes


def is_flat(link: Link) -> TypeIs[AtWall]:
    """Whether the gap of a contact is linear in time."""
    return link.flat


def is_arc(link: Link) -> TypeIs[AtArc]:
    """Whether a contact is with a side of an arc."""
    return link.rank == AtArc.rank


def is_pair(link: Link) -> TypeIs[Pair]:
    """Whether a contact is between circles alone, which may both move."""
    return link.rank == 0


class Bodies(Protocol[N]):
    """What contacts are between."""

    @property
    def bodies(self) -> Mapping[int, Body[N]]: ...
    @property
    def pockets(self) -> Sequence[Body[N]]: ...
    @property
    def arcs(self) -> Sequence[Body[N]]: ...


class Formulas(Bodies[N], Protocol[N]):
    """What contacts ask of a state: see `Flights` and `State`."""

    @property
    def zero(self) -> N: ...
    def later(self, link: Round) -> Body[N]: ...
    def round_gap(self, link: Round) -> N: ...
    def wall_gap(self, link: AtWall) -> N: ...
    def round_approach(self, link: Round) -> N: ...
    def wall_approach(self, link: AtWall) -> N: ...
    def round_closing(self, link: Round) -> N: ...
    def round_hit(self, link: Round) -> tuple[N, N]: ...
    def wall_hit(self, link: AtWall) -> tuple[N, N]: ...
    def arc_hit(self, link: AtArc) -> tuple[N, N]: ...
    def round_parts(self, link: Round) -> tuple[N, N, N]: ...
    def wall_parts(self, link: AtWall) -> tuple[N, N, N]: ...
    def bounce_pair(self, link: Pair) -> None: ...
    def bounce_wall(self, link: AtWall) -> None: ...
    def bounce_arc(self, link: AtArc) -> None: ...
    def pair_arms(self, link: Pair) -> list[tuple[int, N, N]]: ...
    def wall_arms(self, link: AtWall) -> list[tuple[int, N, N]]: ...
    def arc_arms(self, link: AtArc) -> list[tuple[int, N, N]]: ...


def scene_order(link: Link) -> tuple[int, int, int]:
    """What contacts are sorted by: their first circle; then its pairs, walls, rims and arcs, each by index.

    >>> sorted([AtWall(0, 0), Pair(1, 2), Pair(0, 3)], key=scene_order)
    [Pair(a=0, b=3), AtWall(circle=0, wall=0, kind='wall'), Pair(a=1, b=2)]
    """
    return link[0], link.rank, link[1]


def touch_of(scene: Scene, i: int, j: int) -> Touch:
    """A contact by places in `scene.ids`, where walls come after the circles, then sides of arcs; in either order.

    >>> from truebreak.scenarios import Circle, Wall
    >>> touch_of(Scene([Circle(0, 0), Circle(3, 0)], [Wall(9, 0, 9, 1)]), 1, 2)
    AtWall(circle=1, wall=0, kind='wall')
    """
    first, second, n = min(i, j), max(i, j), len(scene.circles)
    arc = second - n - len(scene.walls)
    return Pair(first, second) if second < n else AtWall(first, second - n) if arc < 0 else AtArc(first, arc)


def part_at(
    scene: Scene, circle: int, number: int, x: float, y: float, taken: Collection[Touch] = frozenset[Touch]()
) -> Touch:
    """What a circle at (x, y), of which doubles tell enough, touches of a segment, polygon or arc: its nearest part.

    Args:
        number: which segment, or, after all of them, which polygon, then which arc.
        taken: what it touches of it, too, in a concave corner: the nearest of the others is wanted.

    >>> from truebreak.scenarios import Circle, Segment
    >>> scene = Scene([Circle(0, 9)], segments=[Segment(0, 0, 4, 0)])
    >>> part_at(scene, 0, 0, 1.0, -1.0), part_at(scene, 0, 0, 5.0, 0.5)
    (AtWall(circle=0, wall=1, kind='wall'), Pair(a=0, b=2))
    """
    found = sorted(_parts_at(scene, circle, number, x, y), key=lambda one: one[0])
    return next((link for _, link in found if link not in taken), found[0][1])


def _parts_at(scene: Scene, circle: int, number: int, x: float, y: float) -> Iterator[tuple[float, Touch]]:
    """Of each side of a segment or polygon what is nearest to a circle, and the square of how far that is."""
    whole, count = scene.surfaces, len(scene.segments)
    if number >= count + len(scene.polygons):
        yield from _parts_of_arc(scene, circle, number - count - len(scene.polygons), x, y)
        return
    face = whole.faces.start + 2 * min(number, count)
    if number < count:
        segment = scene.segments[number]
        ways = (((segment.x0, segment.y0), (segment.x1, segment.y1)),)
    else:
        ways = scene.polygons[number - count].sides()
        face += sum(len(polygon.sides()) for polygon in scene.polygons[: number - count])
    for k, (a, b) in enumerate(ways):
        x0, y0, x1, y1 = float(a[0]), float(a[1]), float(b[0]), float(b[1])
        ux, uy = x1 - x0, y1 - y0
        foot = ((x - x0) * ux + (y - y0) * uy) / (ux * ux + uy * uy)
        share = min(1.0, max(0.0, foot))
        away = (x - x0 - share * ux) ** 2 + (y - y0 - share * uy) ** 2
        corner = None
        if not 0.0 < foot < 1.0:
            place = b if foot > 0.0 else a
            corner = next((e for e in whole.ends if (whole.circles[e].x, whole.circles[e].y) == place), None)
        if corner is not None:
            yield away, Pair(circle, corner)
        elif number < count:
            yield away, AtWall(circle, face + (ux * (y - y0) - uy * (x - x0) < 0.0))
        else:
            yield away, AtWall(circle, face + k)


def _parts_of_arc(scene: Scene, circle: int, number: int, x: float, y: float) -> Iterator[tuple[float, Touch]]:
    """Of an arc the side, or the ends, that a circle is beside, and the square of how far that is."""
    arc, whole = scene.arcs[number], scene.surfaces
    nx, ny, h = map(float, arc.chord)
    dx, dy = x - float(arc.x), y - float(arc.y)
    far, r = hypot(dx, dy), float(arc.r)
    if arc.full or nx * dx + ny * dy > h * far:
        yield (far - r) ** 2, AtArc(circle, 2 * number + (far < r))
        return
    for place in arc.ends:
        end = next(e for e in whole.ends if (whole.circles[e].x, whole.circles[e].y) == place)
        yield (x - float(place[0])) ** 2 + (y - float(place[1])) ** 2, Pair(circle, end)


def places_of(scene: Scene, link: Touch) -> tuple[int, int]:
    """A contact by places in `scene.ids`, as `touch_of` reads them."""
    if is_arc(link):
        return link[0], len(scene.circles) + len(scene.walls) + link[1]
    return link[0], len(scene.circles) + link[1] if link.flat else link[1]


def contact_of(scene: Scene, link: Touch) -> Contact:
    """A contact by ids."""
    i, j = places_of(scene, link)
    return Contact(scene.ids[i], scene.ids[j])


class NamedContacts:
    """Contacts by ids; the same contacts are the same tuple.

    Args:
        scene: whose ids.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._known: dict[tuple[Touch, ...], tuple[Contact, ...]] = {}

    def __call__(self, links: tuple[Touch, ...]) -> tuple[Contact, ...]:
        """Some contacts, in their order."""
        found = self._known.get(links)
        if found is None:
            found = self._known[links] = tuple([contact_of(self._scene, link) for link in links])
        return found


def name_of(scene: Scene, link: Link) -> str:
    """A contact as a person reads it.

    >>> from truebreak.scenarios import Circle
    >>> name_of(Scene([Circle(0, 0, id="a"), Circle(4, 0, id="b")]), Pair(0, 1))
    'a and b'
    """
    if not can_push(link):
        pocket = str(scene.pockets[link.pocket].id)
        return f"{scene.ids[link.circle]} and {'' if pocket.startswith('pocket') else 'pocket '}{pocket}"
    return " and ".join(contact_of(scene, link))


# -- Which circles, walls and rims of a scene touch at time 0, decided exactly.


@lru_cache(maxsize=8)
def touching_at_start(scene: Scene) -> tuple[Touch, ...]:
    """The contacts at gap zero at time 0, in scene order.

    >>> from truebreak.scenarios import Circle, Scene
    >>> touching_at_start(Scene([Circle(0, 0), Circle("sqrt(2)", "sqrt(2)"), Circle(5, 5)]))
    (Pair(a=0, b=1),)
    """
    circles = scene.circles
    fixed = [circle.fixed for circle in circles]
    return tuple(touch_of(scene, i, j) for i, j in scene.touching if not (fixed[i] and _stays(scene, j, fixed)))


def _stays(scene: Scene, j: int, fixed: Sequence[bool]) -> bool:
    """Whether nothing happens between a thing and a fixed circle that it touches: it is one, or a wall that moves."""
    wall = j - len(fixed)
    return fixed[j] if wall < 0 else wall < len(scene.walls) and scene.walls[wall].moves


@lru_cache(maxsize=8)
def rims_at_start(scene: Scene) -> tuple[Entry, ...]:
    """The centres of movable circles on the rim of a pocket at time 0.

    >>> from truebreak.scenarios import Circle, Pocket, Scene
    >>> rims_at_start(Scene([Circle(0, 0, vx=1)], pockets=[Pocket(2, 0, 2)]))
    (Entry(circle=0, pocket=0, kind='pocket'),)
    """
    found: list[Entry] = []
    for i, circle in enumerate(scene.circles):
        for k, pocket in enumerate(scene.pockets):
            dx, dy = pocket.x - circle.x, pocket.y - circle.y
            if not circle.fixed and pair_gap(dx, dy, pocket.r).sign() == 0:
                found.append(Entry(i, k))
    return tuple(found)


# -- On which side of a wall a circle lies.

CLEAR = 2.0**-40
"""Share of its terms beyond which a height in doubles has the sign of the true one. Six roundings to doubles, of
2**-53 each, and the roundings of five operations come to less than 2**-49 of them."""


class Sides:
    """On which side of each wall each circle starts, and so stays: decided exactly, once, when asked."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._known: dict[tuple[int, int], bool] = {}
        self._pulls: dict[int, int] = {}
        self._level: dict[int, bool] = {}
        self._walls: dict[int, tuple[float, float, float, float] | None] = {}

    def negative(self, circle: int, wall: int) -> bool:
        """Whether the circle lies where the wall's own normal does not point."""
        key = (circle, wall)
        if key not in self._known:
            where = self.scene.circles[circle]
            exact = self.scene.walls[wall]
            told = self._in_doubles(circle, wall) if type(exact) is Wall else None
            self._known[key] = exact.side(where.x, where.y) < 0 if told is None else told
        return self._known[key]

    def pull(self, circle: int, wall: int) -> int:
        """Whether gravity pulls the circle towards the wall (negative), along it (0; also without) or away from it."""
        if wall not in self._pulls:
            (nx, ny), g = self.scene.walls[wall].normal, self.scene.gravity
            self._pulls[wall] = 0 if g is None else (nx * g[0] + ny * g[1]).sign()
        sign = self._pulls[wall]
        return -sign if sign and self.negative(circle, wall) else sign

    def level(self, wall: int) -> bool:
        """Whether a wall lies across gravity: along it nothing pulls."""
        if wall not in self._level:
            (nx, ny), g = self.scene.walls[wall].normal, self.scene.gravity
            self._level[wall] = g is not None and (nx * g[1] - ny * g[0]).sign() == 0
        return self._level[wall]

    def _in_doubles(self, circle: int, wall: int) -> bool | None:
        """The same, where doubles tell it."""
        if wall not in self._walls:
            exact = self.scene.walls[wall]
            try:
                nx, ny = exact.normal
                self._walls[wall] = (float(nx), float(ny), float(exact.x0), float(exact.y0))
            except OverflowError:
                self._walls[wall] = None
        line, where = self._walls[wall], self.scene.circles[circle]
        if line is None:
            return None
        nx, ny, x0, y0 = line
        try:
            x, y = float(where.x), float(where.y)
        except OverflowError:
            return None
        height = nx * (x - x0) + ny * (y - y0)
        terms = abs(nx) * (abs(x) + abs(x0)) + abs(ny) * (abs(y) + abs(y0))
        lost = CLEAR * terms + TINIEST * (1.0 + abs(nx) + abs(ny) + abs(x) + abs(y) + abs(x0) + abs(y0))
        return height < 0.0 if isfinite(terms) and abs(height) > lost else None


TINIEST = 1e-280
"""More than what underflow may take from a factor, or from a product: half of 2**-1074 each."""


# -- Gravity, in one number system.


class Gravity(NamedTuple, Generic[N]):
    """Half of the gravity of a scene; and whether flights are kept in true coordinates, where they are parabolas.

    Else they are kept in the falling frame, X = x - g t^2 / 2 and V = v - g t, in which every flight is straight: so
    pairs of circles keep all their formulas, and walls alone move.
    """

    hx: N
    hy: N
    bent: bool

    @property
    def upward(self) -> tuple[N, N]:
        """What is against gravity, and as long."""
        return -(self.hx + self.hx), -(self.hy + self.hy)

    def half(self, axis: int) -> N:
        """Half of gravity along x (0) or y (1)."""
        return self.hx if axis == 0 else self.hy

    def flown(self, flight: tuple[N, N, N, N], lag: N) -> tuple[N, N, N, N]:
        """(x, y, vx, vy) after a time, in true coordinates."""
        x, y, vx, vy = flight
        hx, hy, _ = self
        return sag(x, vx, hx, lag), sag(y, vy, hy, lag), fall_speed(vx, hx, lag), fall_speed(vy, hy, lag)


class WallFall(NamedTuple, Generic[N]):
    """The gap of a circle and a wall under gravity at the circle's clock, how fast it grows, and half of n.g."""

    gap: N
    approach: N
    half: N


# -- Another body, as one sees it.


class Relation(NamedTuple, Generic[N]):
    """Two bodies at the later of their clocks: that clock, d = b - a, v = b - a, R."""

    t: N
    dx: N
    dy: N
    vx: N
    vy: N
    reach: N
