"""Contacts by index, typed: two circles, a circle and a wall, the centre of a circle and the rim of a pocket.

Each kind knows which circles it is between and which formulas of a state are its own. The gap of the first and the
last is quadratic in time, that of a wall linear; the last is no obstacle, but reckoned like one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple, Protocol, TypeAlias

from ...scenarios.scene import Scene
from ...scenarios.trajectory import Contact
from ..numbers.system import N
from .body import Body


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
    grazes = True
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
    grazes = False

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
        """See `Flights.wall_approach`: the same at every instant of a flight."""
        return state.wall_approach(self)

    def hit(self, state: Formulas[N]) -> tuple[N, N]:
        """See `Flights.wall_hit`."""
        return state.wall_hit(self)

    def parts(self, state: Formulas[N]) -> tuple[N, N, N]:
        """The time itself: it needs no root."""
        clock, wait = state.wall_hit(self)
        return clock + wait, state.zero, state.zero

    def bounce(self, state: Formulas[N]) -> None:
        """See `State.bounce_wall`."""
        state.bounce_wall(self)

    def arms(self, state: Formulas[N]) -> list[tuple[int, N, N]]:
        """See `State.wall_arms`."""
        return state.wall_arms(self)


class Entry(NamedTuple):
    """The centre of a circle and the rim of a pocket."""

    circle: int
    pocket: int
    kind: str = "pocket"

    pushes = False
    grazes = True
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


Touch: TypeAlias = Pair | AtWall
"""A contact through which an impulse can pass."""

Round: TypeAlias = Pair | Entry
"""A contact whose gap is |d|^2 - R^2."""

Link: TypeAlias = Pair | AtWall | Entry
"""Any of them."""


class Bodies(Protocol[N]):
    """What contacts are between."""

    @property
    def bodies(self) -> Mapping[int, Body[N]]: ...
    @property
    def pockets(self) -> Sequence[Body[N]]: ...


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
    def round_parts(self, link: Round) -> tuple[N, N, N]: ...
    def bounce_pair(self, link: Pair) -> None: ...
    def bounce_wall(self, link: AtWall) -> None: ...
    def pair_arms(self, link: Pair) -> list[tuple[int, N, N]]: ...
    def wall_arms(self, link: AtWall) -> list[tuple[int, N, N]]: ...


def scene_order(link: Link) -> tuple[int, int, int]:
    """What contacts are sorted by: their first circle; then its pairs, walls and rims, each by index.

    >>> sorted([AtWall(0, 0), Pair(1, 2), Pair(0, 3)], key=scene_order)
    [Pair(a=0, b=3), AtWall(circle=0, wall=0, kind='wall'), Pair(a=1, b=2)]
    """
    rank = 0 if isinstance(link, Pair) else 1 if isinstance(link, AtWall) else 2
    return link[0], rank, link[1]


def touch_of(scene: Scene, i: int, j: int) -> Touch:
    """A contact by places in `scene.ids`, where walls come after the circles; in either order.

    >>> from truebreak.scenarios import Circle, Wall
    >>> touch_of(Scene([Circle(0, 0), Circle(3, 0)], [Wall(9, 0, 9, 1)]), 1, 2)
    AtWall(circle=1, wall=0, kind='wall')
    """
    first, second, n = min(i, j), max(i, j), len(scene.circles)
    return Pair(first, second) if second < n else AtWall(first, second - n)


def places_of(scene: Scene, link: Touch) -> tuple[int, int]:
    """A contact by places in `scene.ids`, as `touch_of` reads them."""
    return (link.a, link.b) if isinstance(link, Pair) else (link.circle, len(scene.circles) + link.wall)


def contact_of(scene: Scene, link: Touch) -> Contact:
    """A contact by ids."""
    i, j = places_of(scene, link)
    return Contact(scene.ids[i], scene.ids[j])


class Named:
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
    if isinstance(link, Entry):
        pocket = str(scene.pockets[link.pocket].id)
        return f"{scene.ids[link.circle]} and {'' if pocket.startswith('pocket') else 'pocket '}{pocket}"
    return " and ".join(contact_of(scene, link))
