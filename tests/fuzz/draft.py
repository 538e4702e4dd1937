"""A scene on the drawing board: rows of numbers that can be moved, turned, copied and spoilt."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from random import Random
from typing import Any, TypeAlias

from truebreak.scenarios import Circle, Pocket, Quantity, Scene, Wall

F = Fraction
Number: TypeAlias = Any
"""int, Fraction or Quantity: they mix in sums and products."""
Vector: TypeAlias = tuple[Number, Number]

ROOT2, ROOT3, ROOT5 = (Quantity.of(f"sqrt({n})") for n in (2, 3, 5))
TRIPLES: list[Vector] = [(F(3, 5), F(4, 5)), (F(5, 13), F(12, 13)), (F(8, 17), F(15, 17)), (F(7, 25), F(24, 25))]
AXES: list[Vector] = [(1, 0), (0, 1), (-1, 0), (0, -1)]
HEX: list[Vector] = [(1, 0), (F(1, 2), ROOT3 / 2), (F(-1, 2), ROOT3 / 2)]
HEX += [(-x, -y) for x, y in HEX]
DIAGONALS: list[Vector] = [(a * ROOT2 / 2, b * ROOT2 / 2) for a in (1, -1) for b in (1, -1)]
PYTHAGOREAN: list[Vector] = AXES + [
    (a * p, b * q) for x, y in TRIPLES for p, q in ((x, y), (y, x)) for a in (1, -1) for b in (1, -1)
]
POLICIES = [*["simultaneous"] * 5, "sequential:order=scene", "sequential:order=scene", "sequential:seed=1"]
FLAWS = (20, 30, 40, 60, 100)
"""A flaw is a power of ten below zero."""


@dataclass
class Body:
    """A circle to be."""

    x: Number
    y: Number
    r: Number = 1
    vx: Number = 0
    vy: Number = 0
    m: Number = 1
    point: bool = False
    half: int = 0
    """Which of two alike parts of the scene it belongs to: 1 or 2; 0 for neither."""

    def back(self, time: Number) -> Body:
        """Where it was a time ago."""
        return replace(self, x=self.x - self.vx * time, y=self.y - self.vy * time)


@dataclass
class Draft:
    """A scene to be, with the limits of its run. `walls` are (x0, y0, x1, y1), `pockets` (x, y, r)."""

    bodies: list[Body]
    walls: list[tuple[Number, Number, Number, Number]] = field(default_factory=list)
    pockets: list[tuple[Number, Number, Number]] = field(default_factory=list)
    until: Number = None
    events: int | None = None
    reverse_at: Number = None
    reverse_after: int | None = None
    capture: bool = False
    policy: str = "simultaneous"
    endless: bool = False
    """Whether it shall run without any limit (only with a reversal)."""

    def moved(self, c: Number, s: Number, dx: Number, dy: Number, mirror: bool = False, stretch: Number = 1) -> Draft:
        """Mirrored, turned by the angle of cosine c and sine s, stretched, and shifted."""

        def turn(x: Number, y: Number) -> Vector:
            y = -y if mirror else y
            return stretch * (c * x - s * y), stretch * (s * x + c * y)

        def place(x: Number, y: Number) -> Vector:
            x, y = turn(x, y)
            return x + dx, y + dy

        bodies = []
        for b in self.bodies:
            (x, y), (vx, vy) = place(b.x, b.y), turn(b.vx, b.vy)
            bodies.append(replace(b, x=x, y=y, r=b.r * stretch, vx=vx, vy=vy))
        walls = [(*place(a, b), *place(p, q)) for a, b, p, q in self.walls]
        return replace(
            self, bodies=bodies, walls=walls, pockets=[(*place(x, y), r * stretch) for x, y, r in self.pockets]
        )

    def shuffled(self, draw: Random) -> Draft:
        """Everything in another order."""
        return replace(
            self,
            bodies=draw.sample(self.bodies, len(self.bodies)),
            walls=draw.sample(self.walls, len(self.walls)),
            pockets=draw.sample(self.pockets, len(self.pockets)),
        )

    def scene(self, name: str = "fuzz") -> Scene:
        """The scene.

        Raises:
            SceneError: where circles overlap, or lie across walls.
        """
        of = Quantity.of
        return Scene(
            [Circle(of(b.x), of(b.y), of(b.r), of(b.vx), of(b.vy), b.m, point=b.point) for b in self.bodies],
            [Wall(*map(of, wall)) for wall in self.walls],
            pockets=[Pocket(*map(of, pocket)) for pocket in self.pockets],
            name=name,
            tie_policy=self.policy,
            capture=self.capture,
            reverse_at=self.reverse_at,
            reverse_after=self.reverse_after,
        )


@dataclass(frozen=True)
class Case:
    """A scene and the limits of its run."""

    scene: Scene
    until: Quantity | None
    events: int | None


# -- drawing


def flaw(draw: Random, least: int = 20) -> Fraction:
    """A tiny number of either sign."""
    return F(draw.choice([1, -1]), 10 ** draw.choice([k for k in FLAWS if k >= least]))


def size(draw: Random) -> Number:
    """A radius."""
    return draw.choice([1, 1, 1, F(1, 2), F(1, 2), F(1, 3), F(3, 4), F(3, 2), 2, F(2, 5)])


def mass(draw: Random) -> Number:
    """A mass; mostly 1."""
    return draw.choice([1, 1, 1, 1, 1, 2, 3, F(1, 2), F(5, 3)])


def speed(draw: Random) -> Number:
    """A speed above zero."""
    return draw.choice([1, 1, 1, 2, F(1, 2), F(3, 2), F(2, 3), 3])


def span(draw: Random) -> Number:
    """A stretch of time."""
    return draw.choice([1, 1, 2, 2, 3, F(3, 2), F(7, 3), F(5, 2)])


def velocity(draw: Random) -> Vector:
    """A velocity of few values; zero often enough."""
    choice = draw.random()
    if choice < 0.2:
        return 0, 0
    if choice < 0.6:
        x, y = draw.choice(AXES)
        return x * (v := speed(draw)), y * v
    x, y = draw.choice(PYTHAGOREAN)
    return x * (v := speed(draw)), y * v


def directions(draw: Random) -> list[Vector]:
    """The directions in which one drawing puts things side by side; two thirds are rational."""
    return draw.choice([AXES, PYTHAGOREAN, PYTHAGOREAN, PYTHAGOREAN, HEX, HEX, DIAGONALS + AXES])


def has_room(bodies: list[Body], x: Number, y: Number, r: Number) -> bool:
    """Whether a circle has room there, as doubles see it: a touch counts as room."""
    return all(
        (float(b.x) - float(x)) ** 2 + (float(b.y) - float(y)) ** 2 > (float(b.r) + float(r)) ** 2 - 1e-9
        for b in bodies
    )


def limits(draft: Draft, draw: Random, most: int = 10) -> Draft:
    """Limits for a draft that has none: a number of events, a time, or both."""
    if draft.until is None and draft.events is None and not draft.endless:
        kind = draw.random()
        if kind < 0.75:
            draft.events = draw.randrange(1, most + 1)
        if kind > 0.65:
            draft.until = draw.choice([1, 2, 3, 4, F(5, 2), F(9, 2), 6])
    return draft


def reversal(draft: Draft, draw: Random, chance: float) -> Draft:
    """A reversal, sometimes, where there is none."""
    if draft.reverse_at is None and draft.reverse_after is None and draw.random() < chance:
        if draw.random() < 0.5:
            draft.reverse_after = draw.choice([1, 1, 2, 2, 3, 4])
        else:
            draft.reverse_at = draw.choice([1, 2, 3, F(1, 2), F(3, 2), F(7, 3)])
        if draw.random() < 0.25:
            draft.endless = True
    return draft


MOVES: Sequence[tuple[Number, Number]] = [
    *[(1, 0)] * 5, (0, 1), *TRIPLES[:2], (F(1, 2), ROOT3 / 2), (ROOT3 / 2, F(1, 2)), (ROOT2 / 2, ROOT2 / 2),
]  # fmt: skip


def finish(draft: Draft, draw: Random, name: str) -> Case:
    """Moves, turns and mirrors a draft, shuffles it, and gives it a policy and limits.

    Raises:
        SceneError: where it is no scene.
    """
    draft = limits(draft, draw)
    if draw.random() < 0.6:
        c, s = draw.choice(MOVES)
        shift = draw.choice([(0, 0), (0, 0), (0, 0), (F(1, 3), F(-2, 7)), (ROOT3 / 7, -ROOT5 / 3)])
        stretch = draw.choice([1, 1, 1, 1, ROOT2, F(2, 3)])
        draft = draft.moved(c, s, *shift, mirror=draw.random() < 0.5, stretch=stretch)
    if draw.random() < 0.7:
        draft = draft.shuffled(draw)
    if draft.policy == "simultaneous":
        draft.policy = draw.choice(POLICIES)
        if draft.policy.endswith("seed=1"):
            draft.policy = f"sequential:seed={draw.randrange(100)}"
    if draft.reverse_at is None and draft.reverse_after is None:
        draft.endless = False
        draft = limits(draft, draw)
    scene = draft.scene(name)
    until = None if draft.until is None else Quantity.of(draft.until)
    return Case(scene, until, draft.events)
