"""The scenes on which engines and bugs are tried, how far each is run, and which engines can take it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from random import Random
from typing import Any

from truebreak.compare.validation import unsupported
from truebreak.scenarios import Circle, Scene, Wall, catalogue


@dataclass(frozen=True)
class Case:
    """A scene of the bench.

    Attributes:
        name: of the case.
        build: makes the scene.
        events: how far engines of events are run.
        until: how far engines of steps are run; None where such an engine has no business (tunnels, or never ends).
        narrow: whether 24 bits hold it: sizes, distances and squares.
        ties: whether two contacts fall on one instant of the exact motion.
    """

    name: str
    build: Callable[[], Scene]
    events: int
    until: float | None = None
    narrow: bool = True
    ties: bool = False

    def takes(self, engine: Any) -> bool:
        """Whether an engine can take it."""
        scene = scene_of(self.name)
        if engine.step is not None and self.until is None:
            return False
        return (self.narrow or engine.bits > 24) and unsupported(engine, scene) is None

    def span(self, engine: Any) -> dict[str, Any]:
        """How far the engine is run: arguments of `run`."""
        return {"events": self.events} if engine.step is None else {"until": self.until}


def known(text: str) -> Callable[[], Scene]:
    """A scene of the catalogue."""
    return lambda: catalogue.build(text)


def box(low: Any, high: Any) -> list[Wall]:
    """Four walls along the axes."""
    return [
        Wall(low, low, low, high, id="left"),
        Wall(high, low, high, high, id="right"),
        Wall(low, low, high, low, id="floor"),
        Wall(low, high, high, high, id="top"),
    ]


def gas(
    n: int,
    seed: int,
    *,
    masses: Iterable[Any] = (1,),
    speeds: Iterable[float] = (1.0,),
    r: float = 1.0,
    cell: float = 4.0,
    offset: int = 0,
    length: Fraction = Fraction(1),
    speed: Fraction = Fraction(1),
) -> Scene:
    """Circles on a jittered lattice in a box, from a seed; masses and speeds are dealt in turn."""
    random, side = Random(seed), math.ceil(math.sqrt(n))
    heavy, fast = list(masses), list(speeds)
    circles = []
    for k in range(n):
        jitter = cell / 2 - r * 1.2
        x = (k % side + 0.5) * cell + random.uniform(-jitter, jitter)
        y = (k // side + 0.5) * cell + random.uniform(-jitter, jitter)
        angle, v = random.uniform(0, 2 * math.pi), fast[k % len(fast)] * random.uniform(0.5, 1.5)
        vx, vy = v * math.cos(angle), v * math.sin(angle)
        place = [Fraction(offset + q) * length for q in (offset * 0.0 + x, offset * 0.0 + y)]
        circles.append(
            Circle(*place, Fraction(r) * length, Fraction(vx) * speed, Fraction(vy) * speed, heavy[k % len(heavy)])
        )
    return Scene(circles, box(offset * length, (offset + Fraction(side * cell)) * length), name=f"gas-{n}-{seed}")


def graze(miss: str, far: int = 10) -> Scene:
    """A ball flies at another from afar, and meets it within `miss` of the edge."""
    mover = Circle(-far, f"2*(1 - {miss})", 1, 1, 0)
    return Scene([mover, Circle(0, 0, 1, 0, 0, 3)], [Wall(-far - 5, 0, -far - 5, 1), Wall(30, 0, 30, 1)], name="graze")


def polygon(n: int, corners: int, seed: int) -> Scene:
    """A gas in a polygon of oblique walls, none along an axis."""
    inner = gas(n, seed)
    side = math.ceil(math.sqrt(n)) * 4.0
    circles = [Circle(c.x - Fraction(side / 2), c.y - Fraction(side / 2), c.r, c.vx, c.vy, c.m) for c in inner.circles]
    radius = side * 0.75 / math.cos(math.pi / corners)
    points = [
        (radius * math.cos(0.3 + 2 * math.pi * k / corners), radius * math.sin(0.3 + 2 * math.pi * k / corners))
        for k in range(corners)
    ]
    walls = [Wall(*points[k], *points[(k + 1) % corners]) for k in range(corners)]
    return Scene(circles, walls, name=f"polygon-{corners}")


def struck_pair() -> Scene:
    """Two that touch and fly side by side, in contact for a while, until a third strikes one of them."""
    pair = [Circle(0, 0, 1, 1, "1/8", 2), Circle(0, 2, 1, 1, "1/8")]
    return Scene([*pair, Circle(14, "9/4", 1, -1, 0), Circle(30, 3, 2, "-1/2", 0, 8)], box(-20, 40), name="lasting")


def slow() -> Scene:
    """Balls that come nearer by a billionth of a radius a unit of time."""
    row = [Circle(0, 0, 1, "1e-9", 0), Circle("2.5", "1/3", 1, 0, 0, 2), Circle(6, 0, 1, "-1e-9", "1e-10")]
    return Scene(row, box(-10, 10), name="slow")


def far_points() -> Scene:
    """Walls told by two points that lie close together, a million lengths from where they are hit."""
    walls = [
        Wall(10**6, 0, 10**6 + 1, "1/64", id="floor"),
        Wall(-(10**6), "-31230", -(10**6) + 1, "-31229.984375", id="roof"),
    ]
    circles = [Circle(0, "-15616", "1/2", "1/2", -1), Circle(40, "-15618", 1, "-1/4", 1, 2)]
    return Scene(circles, walls, name="far-points")


def quick() -> Scene:
    """Balls the size of a thousandth, at a thousand lengths a unit of time, among pins."""
    random = Random(4)
    pins = [Circle(Fraction(x, 4), Fraction(y, 4), "1/16", m="oo") for x in (1, 2, 3) for y in (1, 2, 3)]
    balls = []
    for k in range(3):
        angle = random.uniform(0, 2 * math.pi)
        balls.append(Circle(0.125 + k * 0.25, 0.375, Fraction(1, 1024), 1000 * math.cos(angle), 1000 * math.sin(angle)))
    return Scene([*balls, *pins], box(0, 1), name="quick")


def point_gas() -> Scene:
    """Points among discs that move."""
    discs = [Circle(4, 4, 1, "1/3", "1/5", 5), Circle(8, 8, "3/2", "-1/4", "1/7", 9), Circle(8, 3, 1, 0, 0, "oo")]
    points = [Circle(1, k, 0, 1, Fraction(k, 7), point=True) for k in range(1, 5)]
    return Scene([*points, *discs], box(0, 11), name="points")


TWO = Fraction(2)

CASES: dict[str, Case] = {
    case.name: case
    for case in (
        Case("gas-3", known("gas:n=3,seed=1"), 60, 20.0),
        Case("gas-10", known("gas:n=10,seed=2"), 120, 12.0),
        Case("gas-20", known("gas:n=20,seed=5"), 100),
        Case("gas-mixed", known("gas:n=8,seed=3,mixed=yes"), 100, 15.0),
        Case("two-in-a-box", known("two-in-a-box"), 80),
        Case("gas-long", lambda: gas(5, 9), 1500),
        Case("masses-1e8", lambda: gas(6, 11, masses=("1e-8", 1, "1e8")), 120),
        Case("masses-1e4", lambda: gas(7, 12, masses=("1e-4", 1, "1e4", 3)), 120),
        Case("galperin", known("galperin:n=2"), 314),
        Case("galperin-4", known("galperin:n=4"), 400),
        Case("tennis", known("tennis"), 20, 20.0, ties=True),
        Case("sizes", known("sizes"), 20, ties=True),
        Case("graze-1e-6", lambda: graze("1e-6"), 6),
        Case("graze-1e-10", lambda: graze("1e-10"), 6, narrow=False),
        Case("graze-1e-13", lambda: graze("1e-13"), 6, narrow=False),
        Case("graze-1e-15", lambda: graze("1e-15"), 6, narrow=False),
        Case("graze-far", lambda: graze("1e-9", 2000), 6, narrow=False),
        Case("far-1e3", lambda: gas(4, 21, offset=1000), 80),
        Case("far-1e6", lambda: gas(4, 22, offset=10**6), 80, narrow=False),
        Case("far-1e9", lambda: gas(4, 23, offset=10**9), 60, narrow=False),
        Case("huge", lambda: gas(5, 31, length=TWO**200, speed=TWO**200), 60, narrow=False),
        Case("tiny", lambda: gas(5, 32, length=TWO**-200, speed=TWO**-200), 60, narrow=False),
        Case("slow-units", lambda: gas(5, 33, length=TWO**100, speed=TWO**-100), 60, narrow=False),
        Case("corner-60", known("corner:angle=60"), 6, ties=True),
        Case("corner-skew", known("corner:angle=60,skew=1/1000"), 6, 12.0, ties=True),
        Case("lorentz", known("lorentz"), 60, 30.0),
        Case("pinball", known("pinball:offset=1/1000"), 12),
        Case("siam", known("siam"), 14),
        Case("hexagon", known("hexagon"), 80),
        Case("sinai-long", known("point"), 1200),
        Case("points", point_gas, 100),
        Case("polygon-5", lambda: polygon(5, 5, 41), 100, 15.0),
        Case("polygon-7", lambda: polygon(9, 7, 42), 100),
        Case("far-points", far_points, 12, narrow=False),
        Case("cradle", known("cradle"), 40, 20.0),
        Case("cradle-touching", known("cradle:gap=0"), 40, ties=True),
        Case("rack-touching", known("rack:rows=3,pockets=no"), 60, ties=True),
        Case("rack-gap", known("rack:rows=3,gap=1/100,jitter=10**-4,seed=3"), 60),
        Case("rack-pockets", known("rack:rows=4,gap=1/50,jitter=10**-3,seed=7"), 60),
        Case("lee", known("lee"), 6, ties=True),
        Case("near-tie", known("near-tie:k=9"), 6, narrow=False),
        Case("inscribed", known("inscribed"), 60, ties=True),
        Case("lasting", struck_pair, 40),
        Case("reversal", known("reversal:n=5,seed=4,after=30"), 60),
        Case("slow", slow, 40),
        Case("quick", quick, 150),
        Case("fast-and-slow", lambda: gas(6, 51, speeds=(1e-6, 1.0, 1e6)), 120),
    )
}
"""Every case by its name."""


@cache
def scene_of(name: str) -> Scene:
    """The scene of a case, built once."""
    return CASES[name].build()
