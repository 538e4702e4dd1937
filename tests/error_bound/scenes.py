"""Scenes for the error bound: rooms of all kinds, each drawn from its number, and the catalogue's."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction as F
from random import Random
from typing import Any

from truebreak.scenarios import Arc, Circle, Pocket, Scene, Wall, catalogue

CATALOGUE = (
    "gas:n=3,seed=2", "gas:n=5,seed=1,mixed=yes", "gas:n=10,seed=1", "gas:n=20,seed=3", "rack:rows=3,gap=0",
    "rack:rows=3,gap=1/9,jitter=1/1000,seed=4", "pinball", "lorentz", "inscribed:n=4", "corner:angle=60",
    "galperin:n=2", "stadium", "mushroom", "lemon:d=6/5,y=1/7",
)  # fmt: skip

Rows = list[dict[str, Any]]
Point = tuple[Any, Any]


class Room:
    """Two to five circles between four walls, none of them parallel to an axis: what a kind of room changes.

    Attributes:
        draw: decides.
        rows: of each circle, what it is made of.
        corners: of the walls.
        drifts: the walls' velocities.
        settings: of the scene.
    """

    def __init__(self, draw: Random, count: int) -> None:
        self.draw = draw
        self.rows: Rows = [self._row(k) for k in range(count)]
        right, high = 3 * min(count, 4) + 1, 3 * ((count - 1) // 4) + 4
        lean = [(F(draw.randrange(1, 9), 10), F(draw.randrange(1, 9), 11)) for _ in range(4)]
        (a, b), (c, d), (e, f), (g, h) = lean
        self.corners: list[Point] = [(-3 - a, -3 - b), (right + c, -3 - d), (right + e, high + f), (-3 - g, high + h)]
        self.drifts: list[Point] = [(0, 0)] * 4
        self.settings: dict[str, Any] = {}

    def _row(self, k: int) -> dict[str, Any]:
        x, y = 3 * (k % 4) + F(self.draw.randrange(-20, 21), 97), 3 * (k // 4) + F(self.draw.randrange(-20, 21), 89)
        r = F(self.draw.randrange(40, 100), 101)
        return {"x": x, "y": y, "r": r, "vx": self.speed(), "vy": self.speed(), "m": 1}

    def speed(self) -> F:
        """Not zero."""
        return self.draw.choice([-1, 1]) * F(self.draw.randrange(20, 90), self.draw.choice([89, 97, 101]))

    def upright(self) -> None:
        """Walls along the axes."""
        xs, ys = [x for x, _ in self.corners], [y for _, y in self.corners]
        self.corners = [(min(xs), min(ys)), (max(xs), min(ys)), (max(xs), max(ys)), (min(xs), max(ys))]

    def scaled(self, lengths: F, speeds: F, dx: F = F(0), dy: F = F(0)) -> None:
        """All lengths and speeds times something, and shifted."""
        for row in self.rows:
            row |= {"x": row["x"] * lengths + dx, "y": row["y"] * lengths + dy, "r": row["r"] * lengths}
            row |= {"vx": row["vx"] * speeds, "vy": row["vy"] * speeds}
        self.corners = [(x * lengths + dx, y * lengths + dy) for x, y in self.corners]

    def scene(self) -> Scene:
        """The scene, as engines of events have it."""
        ends = zip(self.corners, self.corners[1:] + self.corners[:1], strict=True)
        walls = [Wall(*p, *q, vx=u, vy=v) for (p, q), (u, v) in zip(ends, self.drifts, strict=True)]
        scene = Scene([Circle(**row) for row in self.rows], walls, **self.settings)
        return scene.surfaces


def rest(row: dict[str, Any], **values: Any) -> None:
    """A circle does not move, and is otherwise as told."""
    row |= {"vx": F(0), "vy": F(0), **values}


def oblique(room: Room) -> None:
    """A radius that is no fraction."""
    room.rows[1]["r"] = "sqrt(2)/2"


def fixed(room: Room) -> None:
    """Fixed circles."""
    for row in room.rows[1::3]:
        rest(row, m="oo")


def points(room: Room) -> None:
    """Points."""
    for row in room.rows[1::2]:
        row |= {"r": 0, "point": True}


def masses(room: Room) -> None:
    """Masses from 1/7 to 7."""
    for row in room.rows:
        row["m"] = F(room.draw.randrange(1, 8), room.draw.randrange(1, 8))


def heavy(room: Room) -> None:
    """Masses from 10**-12 to 10**12."""
    for row in room.rows:
        row["m"] = F(10) ** room.draw.choice([-12, 0, 12])


def pockets(room: Room) -> None:
    """Pockets that capture."""
    holes(room)
    room.settings["capture"] = True


def holes(room: Room) -> None:
    """Pockets that do not."""
    room.settings["pockets"] = [Pocket(F(3, 2), F(3, 2), F(1, 5)), Pocket(F(-5, 3), F(5, 3), F(1, 3))]


def back(room: Room) -> None:
    """A reversal after some events."""
    room.settings["reverse_after"] = room.draw.randrange(20, 50)


def later(room: Room) -> None:
    """A reversal at a set time."""
    room.settings["reverse_at"] = F(room.draw.randrange(20, 60), 7)


def still(room: Room) -> None:
    """All but one at rest."""
    for row in room.rows[1:]:
        rest(row)


def together(room: Room) -> None:
    """Pairs that touch: several contacts at one instant."""
    for one, other in zip(room.rows[::2], room.rows[1::2], strict=False):
        one["r"] = F(9, 10)
        rest(other, x=one["x"] + F(18, 10), y=one["y"], r=F(9, 10))


def row(room: Room) -> None:
    """Touching balls level with an axis, and one that flies at them: velocities and places of exactly zero."""
    room.upright()
    for k, ball in enumerate(room.rows):
        rest(ball, x=F(2 * k), y=F(1, 3), r=F(1), m=F(k + 1, 3))
    room.rows[0] |= {"x": F(-3, 2), "vx": F(5, 7)}


def level(room: Room) -> None:
    """Upright walls."""
    room.upright()


def flat(room: Room) -> None:
    """Two walls that are nearly level with the flights."""
    room.upright()
    for ball in room.rows:
        ball["vy"] /= 10**4
    (a, b), (c, d), (e, f), (g, h) = room.corners
    room.corners = [(a, b), (c, d + F(1, 10**4)), (e + F(1, 10**4), f), (g, h)]


def far(room: Room) -> None:
    """Far from the origin."""
    room.scaled(F(1), F(1), F(10) ** 9 / 7, -(F(10) ** 8) / 13)


def swift(room: Room) -> None:
    """One a million times faster than the rest."""
    room.rows[0] |= {"vx": room.rows[0]["vx"] * 10**6, "vy": room.rows[0]["vy"] * 10**6}


def huge(room: Room) -> None:
    """Lengths of 10**30, speeds of 10**-20."""
    room.scaled(F(10) ** 30, F(10) ** -20)


def tiny(room: Room) -> None:
    """Lengths of 10**-40, speeds of 10**40."""
    room.scaled(F(10) ** -40, F(10) ** 40)


def beyond(room: Room) -> None:
    """Lengths and speeds that doubles do not hold."""
    room.scaled(F(10) ** room.draw.choice([-400, 160, 400]), F(10) ** room.draw.choice([-400, -160, 400]))


def hall(room: Room) -> None:
    """Two of twelve are fixed."""
    for ball in room.rows[5:7]:
        rest(ball, m="oo")


def lossy(room: Room) -> None:
    """At each contact little is lost, half, or nearly all; walls at any angle, unequal masses, one of them fixed."""
    masses(room)
    if len(room.rows) > 3:
        rest(room.rows[2], m="oo")
    room.settings["restitution"] = room.draw.choice(["99/100", "9/10", "1/2", "1/9", "sqrt(2)/2"])


def level_and_lossy(room: Room) -> None:
    """The same between walls along the axes."""
    lossy(room)
    room.upright()


def ring(room: Room) -> None:
    """A ring that is wider than the room in parts, so that circles bounce within it and off walls; unequal masses."""
    masses(room)
    middle = F(3 * min(len(room.rows), 4) - 3, 2), F(3 * ((len(room.rows) - 1) // 4), 2)
    room.settings["arcs"] = [Arc(*middle, 4 + middle[0], full=True)]


def bows(room: Room) -> None:
    """Bows between the circles and the walls, met from within, from without, and at their ends; a loss for some."""
    if room.draw.random() < 0.5:
        room.settings["restitution"] = "9/10"
    shifts = [room.draw.choice([F(1, 9), F(-1, 9)]) for _ in range(2)]
    low = F(-17, 10)
    arcs = [
        Arc(x, low, F(1, 2), x + F(1, 2), low, x + shift, F(-2))
        for x, shift in zip((F(3, 2), F(9, 2)), shifts, strict=True)
    ]
    room.settings["arcs"] = [*arcs, Arc(-2, 0, F(3, 4), -2, F(-3, 4), -2, F(3, 4))]


def falling(room: Room) -> None:
    """Under gravity in any direction, between walls at any angle; a loss for some; far from the start for some."""
    masses(room)
    room.settings["gravity"] = tuple(F(room.draw.randrange(-30, 31), 97) for _ in range(2))
    if room.draw.random() < 0.5:
        room.settings["restitution"] = room.draw.choice(["99/100", "9/10"])


def level_and_falling(room: Room) -> None:
    """Gravity down onto a level floor, between upright walls."""
    falling(room)
    room.upright()
    room.settings["gravity"] = (0, -F(room.draw.randrange(1, 100), 31))


def pressed(room: Room) -> None:
    """Walls that move, under gravity and without."""
    if room.draw.random() < 0.5:
        falling(room)
    room.drifts = [(F(room.draw.randrange(-9, 10), 997), F(room.draw.randrange(-9, 10), 991)) for _ in range(4)]


def swept(room: Room) -> None:
    """Walls that move, beside bows or pockets."""
    (bows if room.draw.random() < 0.6 else holes)(room)
    room.drifts = [(F(room.draw.randrange(-9, 10), 997), F(room.draw.randrange(-9, 10), 991)) for _ in range(4)]


def falling_back(room: Room) -> None:
    """A reversal under gravity."""
    room.settings["gravity"] = (F(1, 9), -F(room.draw.randrange(1, 100), 31))
    room.settings["reverse_after"] = room.draw.randrange(20, 50)


def dropped(room: Room) -> None:
    """One circle alone, which gravity drops onto a level floor or an oblique one; a loss for some."""
    room.settings["gravity"] = (0, -F(room.draw.randrange(20, 100), 31))
    if room.draw.random() < 0.5:
        room.upright()
    if room.draw.random() < 0.3:
        room.settings["restitution"] = "99/100"


def onto_pegs(room: Room) -> None:
    """Under gravity, fixed circles among those that fall, some of radius 0: quartics."""
    falling(room)
    for ball in room.rows[1::3]:
        rest(ball, m="oo", **room.draw.choice([{}, {"r": F(0), "point": True}]))


def onto_bows(room: Room) -> None:
    """Under gravity, arcs met from without, from within and at their ends."""
    bows(room)
    lossy = room.settings.pop("restitution", None)
    falling(room)
    room.settings |= {} if lossy is None else {"restitution": lossy}


def in_a_ring(room: Room) -> None:
    """Under gravity in a ring that is wider than the room in parts."""
    falling(room)
    ring(room)


def into_holes(room: Room) -> None:
    """Under gravity, pockets that capture, or do not."""
    falling(room)
    (pockets if room.draw.random() < 0.5 else holes)(room)


def peg_alone(room: Room) -> None:
    """One circle that falls among fixed ones, between walls."""
    room.settings["gravity"] = (F(1, 7), -F(room.draw.randrange(20, 100), 31))
    for ball in room.rows[1:]:
        rest(ball, m="oo")


def ring_alone(room: Room) -> None:
    """One circle that falls in a ring within the room, and bounces off it for good."""
    room.settings["gravity"] = (F(1, 7), -F(room.draw.randrange(20, 100), 31))
    room.settings["arcs"] = [Arc(0, 0, F(5, 2), full=True)]


KINDS: dict[str, Callable[[Room], None]] = {
    kind.__name__: kind
    for kind in (
        oblique, fixed, points, masses, heavy, pockets, holes, back, later, still, together, row, level, flat, far,
        swift, huge, tiny, beyond, hall, lossy, level_and_lossy, ring, bows,
        falling, level_and_falling, pressed, swept, falling_back, dropped,
        onto_pegs, onto_bows, in_a_ring, into_holes, peg_alone, ring_alone,
    )
}  # fmt: skip
"""The kinds of rooms, by name."""

COUNTS = {"hall": 12, "together": 6, "row": 4, "dropped": 1, "peg_alone": 4, "ring_alone": 1}


def scene_of(name: str) -> Scene:
    """A scene of the catalogue, or a room by kind and number: `oblique 3`."""
    kind, _, seed = name.partition(" ")
    if not seed:
        return catalogue.build(name).surfaces
    draw = Random(name)
    room = Room(draw, COUNTS.get(kind) or draw.randrange(2, 6))
    KINDS[kind](room)
    return room.scene()
