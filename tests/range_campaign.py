"""Discs that touch something just where a range begins or ends: is any certified run through something solid?

python tests/range_campaign.py --seeds 20000           # counts a family, and each run that is wrong
python tests/range_campaign.py --families met --guises # and whether it has the same history in other guises
python tests/range_campaign.py --replay "joint 17"     # one scene, as TOML, and what is wrong

A touch is chosen first, in fractions: where, along which normal, at which velocity, at what time; the flight goes back
from there to time 0. Something begins or ends there: a face, an arc, a polygon's side. The referee shares nothing with
the engine: it draws the certified run, in doubles, and looks whether any disc is inside of anything, whether what is
listed touches and approaches, and whether what rests touches something.
"""

from __future__ import annotations

import argparse
import signal
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction as F
from itertools import pairwise
from random import Random
from typing import Any

import guise_campaign
import numpy as np
from numpy.typing import NDArray

from truebreak.exact import ExactEngine
from truebreak.scenarios import Arc, Circle, Pocket, Polygon, Quantity, Scene, SceneError, Segment, Trajectory, Wall
from truebreak.scenarios.files import dump_toml
from truebreak.scenarios.trajectory import StopReason

Vector = tuple[F, F]
Doubles = NDArray[np.float64]

INSIDE, CLOSE, BESIDE, FINE = 1e-9, 1e-7, 1e-10, 1500
"""How deep is inside; how near is a contact; how near an event nobody looks; in how many places a flight is seen."""

WORK = 300_000
"""What an instant may cost."""

BITS = 256
"""What the engine may go to: more prove no double zero, they only take longer."""

DIRECTIONS: list[Vector] = [
    (F(x), F(y)) for x, y in ((1, 0), (0, 1), (-1, 0), (0, -1))
] + [(F(a * x, 5), F(b * y, 5)) for x, y in ((3, 4), (4, 3)) for a in (1, -1) for b in (1, -1)] + [
    (F(a * 5, 13), F(b * 12, 13)) for a in (1, -1) for b in (1, -1)
]  # fmt: skip


@dataclass
class Place:
    """What stands around the origin, and how it may be touched there.

    Attributes:
        touches: a normal, away from what is touched, how thick that is, and radii of curvature that matter.
        rho: the radius of what touches it, where that is given.
    """

    walls: list[tuple[Vector, Vector]] = field(default_factory=list)
    segments: list[tuple[Vector, Vector, F]] = field(default_factory=list)
    polygons: list[tuple[list[Vector], F]] = field(default_factory=list)
    arcs: list[tuple[Vector, F, Vector, Vector]] = field(default_factory=list)
    pegs: list[tuple[Vector, F]] = field(default_factory=list)
    touches: list[tuple[Vector, F]] = field(default_factory=list)
    radii: list[F] = field(default_factory=list)
    rho: F | None = None


UP, DOWN, LEFT, RIGHT = (F(0), F(1)), (F(0), F(-1)), (F(-1), F(0)), (F(1), F(0))
ORIGIN = (F(0), F(0))


def _times(v: Vector, k: F | int) -> Vector:
    return (v[0] * k, v[1] * k)


def _across(v: Vector) -> Vector:
    return (-v[1], v[0])


def _thick(rng: Random) -> F:
    return rng.choice((F(0), F(0), F(1, 4), F(1, 10), F(1, 2)))


def _lone(rng: Random) -> Place:
    r = _thick(rng)
    normals = [UP, DOWN, LEFT, (F(-3, 5), F(4, 5)), (F(-4, 5), F(-3, 5))]
    return Place(segments=[(ORIGIN, (F(rng.choice((1, 2, 3))), F(0)), r)], touches=[(n, r) for n in normals])


def _joint(rng: Random) -> Place:
    """Two segments that share an end: collinear, convex, or hollow to the one that touches."""
    one, other = rng.sample(DIRECTIONS, 2)
    r = _thick(rng)
    s = r if rng.random() < 0.6 else _thick(rng)
    normals = [n for d in (one, other) for n in (_across(d), _times(_across(d), -1))]
    return Place(
        segments=[(ORIGIN, _times(one, rng.choice((1, 2))), r), (_times(other, rng.choice((1, 2))), ORIGIN, s)],
        touches=[(n, max(r, s)) for n in normals],
    )


def _bow(rng: Random, r: F, up: bool, right: bool) -> tuple[Vector, F, Vector, Vector]:
    """An arc that begins or ends at the origin, where it is level, bent up or down, to the right or the left."""
    c = (F(0), r if up else -r)
    here = (F(0), F(0))
    far = rng.choice([d for d in DIRECTIONS if d != (F(0), -c[1] / r)])
    there = (c[0] + far[0] * r, c[1] + far[1] * r)
    return (c, r, here, there) if right == up else (c, r, there, here)


def _arc(rng: Random) -> Place:
    r = rng.choice((F(1), F(2), F(3), F(1, 2)))
    return Place(arcs=[_bow(rng, r, up=False, right=True)], touches=[(n, F(0)) for n in (UP, DOWN, LEFT)], radii=[r])


def _tangent(rng: Random) -> Place:
    """A face that goes over into an arc, bent up or down."""
    r = rng.choice((F(1), F(2), F(3), F(1, 2)))
    return Place(
        segments=[((F(-rng.choice((1, 2, 3))), F(0)), ORIGIN, F(0))],
        arcs=[_bow(rng, r, up=rng.random() < 0.5, right=True)],
        touches=[(UP, F(0)), (DOWN, F(0))],
        radii=[r],
    )


def _bows(rng: Random) -> Place:
    """Two arcs that share an end, of one circle or of two, bent alike or not."""
    one = rng.choice((F(1), F(2), F(3)))
    other = one if rng.random() < 0.4 else rng.choice((F(1), F(2), F(1, 2)))
    up = rng.random() < 0.5
    return Place(
        arcs=[
            _bow(rng, one, up=up, right=True),
            _bow(rng, other, up=up if rng.random() < 0.7 else not up, right=False),
        ],
        touches=[(UP, F(0)), (DOWN, F(0))],
        radii=[one, other],
    )


def _corner(rng: Random) -> Place:
    """A polygon's corner."""
    shapes: list[tuple[list[tuple[int, int]], list[Vector]]] = [
        ([(0, 0), (3, 0), (3, -2), (0, -2)], [UP, LEFT]),
        ([(0, 0), (4, 0), (0, -3)], [UP, LEFT]),
        ([(0, 0), (0, -4), (3, -4)], [LEFT, (F(4, 5), F(3, 5))]),
        ([(0, 0), (3, 0), (3, 2), (5, 2), (5, -2), (0, -2)], [UP, LEFT]),
        ([(0, 0), (-3, 4), (4, 0)], [DOWN, (F(-4, 5), F(-3, 5))]),
        ([(0, 0), (3, 4), (6, 0), (3, -4)], [(F(-4, 5), F(3, 5)), (F(-4, 5), F(-3, 5))]),
        ([(0, 0), (3, -4), (6, 4), (0, 3)], [LEFT, (F(-4, 5), F(-3, 5))]),
    ]  # fmt: skip
    points, normals = rng.choice(shapes)
    r = _thick(rng)
    return Place(polygons=[([(F(x), F(y)) for x, y in points], r)], touches=[(n, r) for n in normals])


def _corners(rng: Random) -> Place:
    """A polygon beside a segment, or another polygon, with which it shares a corner."""
    place = _corner(rng)
    d = rng.choice(DIRECTIONS)
    r = rng.choice((F(0), place.polygons[0][1]))
    if rng.random() < 0.5:
        place.segments.append((ORIGIN, _times(d, 2), r))
    else:
        place.polygons.append(([ORIGIN, (F(-2), F(0)), (F(-2), F(-3)), (F(0), F(-3))], r))
    return place


def _walled(rng: Random) -> Place:
    """A segment whose end a disc touches together with a wall, or that ends on a wall."""
    place = _lone(rng) if rng.random() < 0.5 else _joint(rng)
    d = rng.choice(DIRECTIONS)
    place.walls.append((_times(_across(d), rng.choice((F(1, 2), F(1), F(2), F(0)))), d))
    return place


def _pegged(rng: Random) -> Place:
    """A segment or a polygon whose end a fixed circle caps, or touches."""
    place = rng.choice((_lone, _joint, _corner))(rng)
    r = rng.choice((F(1, 4), F(1, 2), F(1, 10)))
    d = rng.choice(DIRECTIONS)
    place.pegs.append((ORIGIN if rng.random() < 0.4 else _times(d, r), r))
    if rng.random() < 0.5:
        place.touches = [(n, max(r, s)) for n, s in place.touches]
    place.radii.append(r)
    return place


def _several(rng: Random) -> Place:
    """Two segments that end at one place, or cross there, and share nothing else: of other radii, or other ways."""
    one, other = rng.sample(DIRECTIONS, 2)
    r, s = _thick(rng), _thick(rng)
    normals = [n for d in (one, other) for n in (_across(d), _times(_across(d), -1))]
    return Place(
        segments=[(ORIGIN, _times(one, 2), r), (_times(other, -1), _times(other, 2), s)],
        touches=[(n, k) for n in normals for k in {r, s, max(r, s)}],
    )


KINDS = ("wall", "face", "start", "end", "side", "corner", "hollow", "out", "out at end", "in", "in at end", "ring",
         "bow end", "mouth", "peg")  # fmt: skip


SHORT = DIRECTIONS[:4], (F(1, 2), F(1, 4), F(1))
"""Normals and radii of places that balls hold as they are."""


def _met(
    rng: Random, ways: list[Vector] = DIRECTIONS, radii: tuple[F, ...] = (F(1, 2), F(1, 4), F(1), F(1, 3), F(0))
) -> Place:
    """One, two or three things of any kinds that a disc comes to at once, along one normal, two, or opposite ones."""
    rho = rng.choice(radii)
    n = rng.choice(ways)
    place = Place(touches=[(n, F(0))], rho=rho)
    for k in range(rng.choice((1, 2, 2, 2, 3))):
        m = rng.choice((n, n, _times(n, -1), _across(n), *ways)) if k else n
        _put(rng, place, rng.choice(KINDS), _times(n, rho), rho, m)
    return place


def _moved(p: Vector, d: Vector, k: F | int) -> Vector:
    return (p[0] + d[0] * k, p[1] + d[1] * k)


def _put(rng: Random, place: Place, kind: str, at: Vector, rho: F, n: Vector) -> None:
    """Puts a thing of a kind to where a disc at a place touches it, with n the normal there, away from it."""
    r, t = _thick(rng), _times(_across(n), rng.choice((1, -1)))
    long, foot = rng.choice((F(1), F(2), F(1, 2))), _moved(at, n, -rho - r)
    radius, others = rng.choice((F(1), F(2), F(1, 2))), [d for d in DIRECTIONS if d != n]
    if kind == "wall":
        place.walls.append((_moved(at, n, -rho), t))
    elif kind in ("face", "start", "end"):
        way = t if kind != "end" else rng.choice([d for d in DIRECTIONS if d[0] * n[0] + d[1] * n[1] < 0])
        back = rng.choice((F(1), F(1, 3))) if kind == "face" else F(0)
        place.segments.append((_moved(foot, way, -back), _moved(foot, way, long), r))
    elif kind in ("side", "corner"):
        a, b = _moved(foot, t, -long if kind == "side" else 0), _moved(foot, t, long)
        place.polygons.append(([a, b, _moved(_moved(foot, n, -long), t, rng.choice((F(0), F(1), F(-1))))], r))
    elif kind == "hollow":  # its corner: the disc touches both sides
        c, w = _moved(foot, t, -rho - r), 2 * rho + 2
        low, out = _moved(c, n, -1), _moved(c, t, -1)
        corners = [c, _moved(c, t, w), _moved(low, t, w), _moved(low, t, -1), _moved(out, n, w), _moved(c, n, w)]
        place.polygons.append((corners, r))
    elif kind == "mouth":  # both ends of an arc are touched
        (c, s), (p, q) = (rng.choice(((F(3, 5), F(4, 5)), (F(-3, 5), F(4, 5)), (F(0), F(1)))) for _ in range(2))
        radius = (rho or F(1, 2)) * s / q
        middle = _moved(at, n, -(rho or F(1, 2)) * c - radius * p)
        ends = [_moved(_moved(middle, n, radius * p), t, radius * q * way) for way in (1, -1)]
        place.arcs.append((middle, radius, ends[0], ends[1]))
    elif kind == "peg":
        place.pegs.append((_moved(foot, n, r - radius), radius))
    else:
        inside = kind.startswith("in") or (kind == "ring" and rng.random() < 0.6)
        radius += rho if inside else 0
        e = rng.choice(others) if kind == "bow end" else _times(n, -1) if inside else n  # of the place that is touched
        middle = _moved(_moved(at, n, -rho), e, -radius)
        one, other = rng.sample([d for d in DIRECTIONS if d != e], 2)
        if kind.endswith("end"):
            one, other = (e, other) if rng.random() < 0.5 else (other, e)
        elif kind == "ring":  # in two halves, with a seam where it is touched
            one, other = e, _times(e, -1)
            place.arcs.append((middle, radius, _moved(middle, other, radius), _moved(middle, one, radius)))
        place.arcs.append((middle, radius, _moved(middle, one, radius), _moved(middle, other, radius)))
        place.radii.append(radius)


def _level(rng: Random) -> Place:
    """The same where balls hold places as they are, but no speed: some zeros are plain, and some are not."""
    return _met(rng, *SHORT)


FAMILIES: dict[str, Callable[[Random], Place]] = {
    "lone": _lone, "joint": _joint, "arc": _arc, "tangent": _tangent, "bows": _bows, "corner": _corner,
    "corners": _corners, "walled": _walled, "pegged": _pegged, "several": _several, "met": _met, "level": _level,
}  # fmt: skip


@dataclass
class Case:
    """A scene, when it comes to the touch, and what it has."""

    scene: Scene
    time: F
    until: Quantity
    place: Vector
    words: list[str]


def case_of(family: str, seed: int) -> Case | None:
    """One scene; None where what is drawn overlaps at time 0, or at the touch."""
    rng = Random(f"{family} {seed}")
    place, words = FAMILIES[family](rng), [family]
    rho = rng.choice((F(1, 2), F(1, 4), F(1), F(1, 3), F(0)) if rng.random() < 0.9 else (F(0),))
    rho = rho if place.rho is None else place.rho
    n, thick = rng.choice(place.touches)
    along = _times(_across(n), rng.choice((1, -1)))
    reach = rho + thick
    at = _times(n, reach)
    level = family == "level"
    speed = rng.choice((F(1), F(2), F(1, 3), F(1, 2), F(3), F(0)) if not level else (F(1, 3), F(3, 5), F(1, 7)))
    normal = F(0) if rng.random() < 0.75 else rng.choice((F(-1), F(-1, 2), F(1)))
    e = rng.choice((F(1), F(1), F(1), F(1, 2), F(0)))
    gravity: Vector | None = None
    if rng.random() < 0.75:
        pull = rng.choice((F(0), F(1, 3), F(1), F(1, 10), F(2), F(-1)))
        if rng.random() < 0.25:  # as bent as something round there
            radii = [x for x in (reach, *(r + rho for r in place.radii), *(r - rho for r in place.radii)) if x > 0]
            pull = speed * speed / rng.choice(radii) if radii else pull
            words.append("osculates")
        aside = rng.choice((F(0), F(0), F(1, 3), F(-1), F(1)))
        gravity = (-n[0] * pull + along[0] * aside, -n[1] * pull + along[1] * aside)
        gravity = None if gravity == ORIGIN else gravity
    g = gravity or ORIGIN
    v = (along[0] * speed + n[0] * normal, along[1] * speed + n[1] * normal)
    time = rng.choice((F(0), F(1, 4), F(1, 2), F(1), F(3, 2)) if not level else (F(0), F(0), F(0), F(1)))
    u = ORIGIN
    if rng.random() < 0.25 and not place.arcs:
        u = (F(rng.randint(-2, 2), rng.choice((1, 2))), F(rng.randint(-2, 2), rng.choice((1, 2))))
        words += ["moves"] if u != ORIGIN else []
    others: list[tuple[Vector, Vector, F, F]] = []  # place and velocity at the touch, radius, mass
    if rng.random() < 0.3:
        d = rng.choice(DIRECTIONS)
        r = rng.choice((F(1, 4), F(1, 2), F(1)))
        side = rng.choice((F(0), F(1), F(-1)))
        relative = rng.choice((F(0), F(0), F(-1), F(-2)))
        w = (v[0] + d[0] * relative - d[1] * side, v[1] + d[1] * relative + d[0] * side)
        others.append(((at[0] + d[0] * (rho + r), at[1] + d[1] * (rho + r)), w, r, rng.choice((F(1), F(3), F(1, 2)))))
        words.append("struck")
    rims: list[tuple[Vector, F]] = []
    if rng.random() < 0.2:
        d, r = rng.choice([*DIRECTIONS, n, _times(n, -1)]), rng.choice((F(1), F(1, 2), F(2)))
        rims.append(((at[0] + d[0] * r, at[1] + d[1] * r), r))
        words.append("rim")
    cos, sin = rng.choice(SHORT[0] if level else DIRECTIONS)
    flip = rng.choice((1, -1))

    def turned(p: Vector) -> Vector:
        x, y = p[0], p[1] * flip
        return (cos * x - sin * y, sin * x + cos * y)

    def back(p: Vector) -> Vector:
        return turned((p[0] - u[0] * time, p[1] - u[1] * time))

    def flown(p: Vector, w: Vector) -> tuple[Vector, Vector]:
        """Where something that falls is at time 0."""
        w = (w[0] + u[0], w[1] + u[1])
        first = (p[0] - w[0] * time + g[0] * time * time / 2, p[1] - w[1] * time + g[1] * time * time / 2)
        return turned(first), turned((w[0] - g[0] * time, w[1] - g[1] * time))

    drift = turned(u)
    pace = {"vx": drift[0], "vy": drift[1]}
    (x, y), (vx, vy) = flown(at, v)
    moving = [(x, y, rho, vx, vy, F(1))]
    for p, w, r, m in others:
        (x, y), (vx, vy) = flown(p, w)
        moving.append((x, y, r, vx, vy, m))
    try:
        circles = [
            Circle(_q(x), _q(y), _q(r), _q(vx), _q(vy), _q(m), id=f"disc{k}", point=r == 0)
            for k, (x, y, r, vx, vy, m) in enumerate(moving)
        ]
        circles += [Circle(*map(_q, turned(p)), _q(r), m="oo", id=f"peg{k}") for k, (p, r) in enumerate(place.pegs)]
        lines = [(back(p), back((p[0] + d[0], p[1] + d[1]))) for p, d in place.walls]
        walls = [Wall(*map(_q, (*a, *b)), id=f"wall{k}", **_all(pace)) for k, (a, b) in enumerate(lines)]
        scene = Scene(
            circles,
            walls,
            segments=[
                Segment(*map(_q, back(a)), *map(_q, back(b)), id=f"bar{k}", r=_q(r), **_all(pace))
                for k, (a, b, r) in enumerate(place.segments)
            ],
            polygons=[
                Polygon([tuple(map(_q, back(p))) for p in points], id=f"block{k}", r=_q(r), **_all(pace))
                for k, (points, r) in enumerate(place.polygons)
            ],
            arcs=[
                Arc(*map(_q, turned(c)), _q(r), *map(_q, (*turned(a), *turned(b))), id=f"bow{k}")
                for k, (c, r, a, b) in enumerate((c, r, *(a, b)[::flip]) for c, r, a, b in place.arcs)
            ],
            pockets=[Pocket(*map(_q, turned(p)), _q(r), id=f"hole{k}") for k, (p, r) in enumerate(rims)],
            capture=bool(rims) and rng.random() < 0.5,
            restitution=_q(e),
            gravity=None if gravity is None else tuple(map(_q, turned(gravity))),
            settle=gravity is not None and rng.random() < 0.3 and not place.arcs and not rims and u == ORIGIN,
        )
    except SceneError:
        return None
    words += [word for word, there in (("settles", scene.settle), ("start", time == 0), ("gravity", gravity)) if there]
    words += ["point"] if rho == 0 else []
    return Case(scene, time, Quantity.of(_q(time + F(3, 2))), turned((at[0] + u[0] * time - u[0] * time, at[1])), words)


def _q(value: F) -> str:
    return str(value)


def _all(pace: dict[str, F]) -> dict[str, str]:
    return {key: str(value) for key, value in pace.items()}


# -- The referee.


@dataclass
class Solid:
    """Something fixed or moving that discs are not to be in: its id, and how far a place is from it (see `gaps`)."""

    id: str
    pace: tuple[float, float]
    distance: Callable[[Doubles, Doubles], Doubles]


def _to_segment(x: Doubles, y: Doubles, a: tuple[float, float], b: tuple[float, float]) -> Doubles:
    dx, dy = b[0] - a[0], b[1] - a[1]
    s = np.clip(((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy), 0, 1)
    return np.hypot(x - a[0] - s * dx, y - a[1] - s * dy)


def _to_polygon(x: Doubles, y: Doubles, points: list[tuple[float, float]]) -> Doubles:
    sides = list(zip(points, points[1:] + points[:1], strict=True))
    least = np.min([_to_segment(x, y, a, b) for a, b in sides], axis=0)
    inside = np.zeros(x.shape, dtype=bool)
    for (ax, ay), (bx, by) in sides:
        if ay != by:
            inside ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) * (bx - ax) / (by - ay))
    return np.where(inside, -least, least)


def _to_arc(x: Doubles, y: Doubles, arc: Arc) -> Doubles:
    cx, cy, r = float(arc.x), float(arc.y), float(arc.r)
    dx, dy = x - cx, y - cy
    if arc.full:
        return np.abs(np.hypot(dx, dy) - r)
    (ax, ay), (bx, by) = ((float(p), float(q)) for p, q in arc.directions)
    first, last = np.arctan2(ay, ax), np.arctan2(by, bx)
    within = (np.arctan2(dy, dx) - first) % (2 * np.pi) <= (last - first) % (2 * np.pi)
    ends = np.min([np.hypot(dx - r * ex, dy - r * ey) for ex, ey in ((ax, ay), (bx, by))], axis=0)
    return np.where(within, np.abs(np.hypot(dx, dy) - r), ends)


def solids(scene: Scene) -> Iterator[Solid]:
    """What of a scene discs are not to be in. Walls and thick lines keep their sides: see `wrong`."""
    for s in scene.segments:
        a, b, r = (float(s.x0), float(s.y0)), (float(s.x1), float(s.y1)), float(s.r)
        yield Solid(str(s.id), (float(s.vx), float(s.vy)), lambda x, y, a=a, b=b, r=r: _to_segment(x, y, a, b) - r)
    for p in scene.polygons:
        points, r = [(float(x), float(y)) for x, y in p.points], float(p.r)
        yield Solid(str(p.id), (float(p.vx), float(p.vy)), lambda x, y, q=points, r=r: _to_polygon(x, y, q) - r)
    for arc in scene.arcs:
        yield Solid(str(arc.id), (0.0, 0.0), lambda x, y, arc=arc: _to_arc(x, y, arc))
    for c in scene.circles:
        if c.fixed:
            x0, y0, r = float(c.x), float(c.y), float(c.r)
            yield Solid(str(c.id), (0.0, 0.0), lambda x, y, x0=x0, y0=y0, r=r: np.hypot(x - x0, y - y0) - r)
    for w in scene.walls:
        nx, ny = (float(part) for part in w.normal)
        size, x0, y0 = float(np.hypot(nx, ny)), float(w.x0), float(w.y0)
        yield Solid(
            str(w.id),
            (float(w.vx), float(w.vy)),
            lambda x, y, nx=nx / size, ny=ny / size, x0=x0, y0=y0: np.abs((x - x0) * nx + (y - y0) * ny),
        )


def gap(solid: Solid, r: float, t: Any, x: Any, y: Any) -> Doubles:
    """How far a disc of radius r is from a solid at some times."""
    return solid.distance(np.asarray(x - solid.pace[0] * t), np.asarray(y - solid.pace[1] * t)) - r


def _moments(run: Trajectory) -> Doubles:
    """Times to look at, many between any two events, and close to them."""
    end = float(run.final_time)
    marks = sorted({0.0, *(min(float(known.time), end) for known in (*run.events, *run.pocketings)), end})
    steps = np.concatenate([np.linspace(0, 1, FINE), 2.0 ** -np.arange(2, 20), 1 - 2.0 ** -np.arange(2, 20)])
    parts = [low + (high - low) * steps for low, high in pairwise(marks)]
    found = np.unique(np.concatenate([np.zeros(0), *parts]))
    for mark in marks:  # whether a double is before or after an event is not asked
        found = found[np.abs(found - mark) > BESIDE]
    return found[(found >= 0) & (found <= end)]


def wrong(run: Trajectory) -> list[str]:
    """What a certified run shows that cannot be."""
    scene, found = run.scene, list[str]()
    times = _moments(run)
    if not len(times):
        return []
    rows = run.sample(times)
    things = list(solids(scene))
    free = [(k, c) for k, c in enumerate(scene.circles) if not c.fixed]
    gone = {entry.circle: float(entry.time) for entry in run.pocketings} if scene.capture else {}
    for k, c in free:
        x, y, r = rows[:, k, 0], rows[:, k, 1], float(c.r)
        there: NDArray[np.bool_] = times <= gone.get(str(c.id), np.inf)
        for solid in things:
            apart = gap(solid, r, times, x, y)[there]
            deep = apart < -INSIDE * max(1.0, float(np.max(np.abs(rows[:, k, :2]))))
            if deep.any():
                first = int(np.argmax(deep))
                found.append(f"{c.id} in {solid.id} from {times[there][first]:.6f} on, {-apart.min():.2g} deep")
        for m, other in free:
            if m > k:
                both = there & (times <= gone.get(str(other.id), np.inf))
                apart = np.hypot(x - rows[:, m, 0], y - rows[:, m, 1]) - r - float(other.r)
                deep = (apart < -INSIDE) & both
                if deep.any():
                    found.append(f"{c.id} in {other.id} from {times[int(np.argmax(deep))]:.6f} on")
        if r == 0:
            found += _crossings(run, k, str(c.id), times[there], x[there], y[there])
    for w in scene.walls:
        for k, c in free:
            nx, ny = (float(part) for part in w.normal)
            there = times <= gone.get(str(c.id), np.inf)  # what a pocket has taken stands, whatever goes over it
            height = (rows[:, k, 0] - float(w.x0) - float(w.vx) * times) * nx + (
                rows[:, k, 1] - float(w.y0) - float(w.vy) * times
            ) * ny
            if there.any() and height[there].min() < -CLOSE and height[there].max() > CLOSE:
                found.append(f"{c.id} on both sides of {w.id}")
    return [*found, *_listed(run, things), *_rest(run, things)]


def _crossings(run: Trajectory, k: int, name: str, t: Doubles, x: Doubles, y: Doubles) -> Iterator[str]:
    """Points that go through thin segments and arcs, which they are never deep in."""
    for s in run.scene.segments:
        if s.r.sign():
            continue
        ux, uy = float(s.vx), float(s.vy)
        dx, dy = float(s.x1 - s.x0), float(s.y1 - s.y0)
        px, py = x - ux * t - float(s.x0), y - uy * t - float(s.y0)
        along, side = (px * dx + py * dy) / (dx * dx + dy * dy), px * dy - py * dx
        yield from _through(name, str(s.id), t, side, (along > CLOSE) & (along < 1 - CLOSE))
    for a in run.scene.arcs:
        dx, dy = x - float(a.x), y - float(a.y)
        if a.full:
            within = np.ones(t.shape, dtype=bool)
        else:
            nx, ny, h = (float(part) for part in a.chord)
            within = (nx * dx + ny * dy) / np.hypot(dx, dy) > h + CLOSE
        yield from _through(name, str(a.id), t, np.hypot(dx, dy) - float(a.r), within)


def _through(name: str, thing: str, t: Doubles, side: Doubles, within: NDArray[np.bool_]) -> Iterator[str]:
    clear = np.abs(side) > CLOSE
    last: tuple[float, bool, float] | None = None
    for time, s, beside in zip(t[clear], side[clear], within[clear], strict=True):
        if last is not None and last[0] * s < 0 and beside and last[1] and time - last[2] < 0.05:
            yield f"{name} through {thing} at {time:.6f}"
        last = float(s), bool(beside), float(time)


def _listed(run: Trajectory, things: list[Solid]) -> Iterator[str]:
    """Impulses between what does not touch, or does not approach."""
    scene = run.scene
    index = {str(c.id): k for k, c in enumerate(scene.circles)}
    gx, gy = (0.0, 0.0) if scene.gravity is None else (float(part) for part in scene.gravity)
    settled = {row.circle for row in run.settlings}
    before = 0.0
    named = {solid.id: solid for solid in things}
    for event in run.events:
        time = float(event.time)
        mid = (before + time) / 2
        row, now = (_first(scene), _first(scene)) if time == 0 else (_row(run, mid), _row(run, time))
        before = time
        closing = []
        for one, other in event.impulses:
            k = index[one]
            vx, vy = row[k, 2] + gx * (time - mid), row[k, 3] + gy * (time - mid)
            r = float(scene.circles[k].r)
            if other in index and not scene.circles[index[other]].fixed:
                m = index[other]
                dx, dy = now[k, 0] - now[m, 0], now[k, 1] - now[m, 1]
                apart = np.hypot(dx, dy) - r - float(scene.circles[m].r)
                wx, wy = row[m, 2] + gx * (time - mid), row[m, 3] + gy * (time - mid)
                closing.append(((vx - wx) * dx + (vy - wy) * dy) / max(np.hypot(dx, dy), CLOSE))
            else:
                solid = named[other]
                apart = float(gap(solid, r, time, now[k, 0], now[k, 1]))
                h = 1e-6
                wx, wy = vx - solid.pace[0], vy - solid.pace[1]
                fore, aft = (float(gap(solid, r, time, now[k, 0] + wx * way, now[k, 1] + wy * way)) for way in (-h, h))
                closing.append(min(apart - fore, aft - apart) / h)  # between two ends they differ
            if abs(apart) > CLOSE:
                yield f"{one} and {other} {apart:.2g} apart at {time:.6f}"
        if closing and not settled and min(closing) > 1e-4:
            yield f"nothing approaches at {time:.6f}: {event.impulses}"


def _first(scene: Scene) -> Doubles:
    return np.array([[float(value) for value in (c.x, c.y, c.vx, c.vy)] for c in scene.circles])


def _row(run: Trajectory, time: float) -> Doubles:
    """Where all are at a time, or just before it."""
    return run.sample([max(time - BESIDE, 0.0)])[0]


def _rest(run: Trajectory, things: list[Solid]) -> Iterator[str]:
    """Rest without a touch."""
    if run.stop.reason is not StopReason.REST:
        return
    end = float(run.final_time)
    now = _row(run, end) if end else _first(run.scene)
    for k, c in enumerate(run.scene.circles):
        if not c.fixed and str(c.id) in run.stop.message:
            close = [abs(float(gap(s, float(c.r), float(run.final_time), now[k, 0], now[k, 1]))) for s in things]
            if min(close, default=1.0) > CLOSE:
                yield f"{c.id} at rest on nothing"


class TooLong(Exception):
    """A run that does not come back."""


def _ring(signum: int, frame: object) -> None:
    raise TooLong


def certified(scene: Scene, until: Quantity) -> Trajectory:
    """The run that is judged; what pushes without end within one instant ends sooner than else."""
    return ExactEngine(max_bits=BITS, work=WORK).run(scene, until=until, events=8)


def judged(case: Case) -> tuple[str, list[str]]:
    """How a run ends, and what is wrong with it."""
    run = certified(case.scene, case.until)
    return run.stop.reason.name, wrong(run)


def guised(case: Case, rng: Random) -> str:
    """How the history of a scene differs from what it is turned by 60 degrees, or in one more guise; or nothing."""
    scene, run = case.scene, certified(case.scene, case.until)
    turned = "turned by 60 degrees", guise_campaign.Guise(guise_campaign.turned_scene(scene))
    for name, guise in (turned, rng.choice([*guise_campaign.guises(scene, rng, None)])):
        again = certified(guise.scene, case.until * guise.units)
        if found := guise_campaign.differs(run, again, guise):
            return f"{name}: {found}"
    return ""


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--seeds", type=int, default=1000)
    parser.add_argument("--start", type=int, default=0)
    parser.add_argument("--families", default=",".join(FAMILIES))
    parser.add_argument("--guises", action="store_true", help="each history again, of the scene turned")
    parser.add_argument("--replay")
    options = parser.parse_args()
    if options.replay:
        family, seed = options.replay.split()
        case = case_of(family, int(seed))
        if case is None:
            print("overlaps")
            return 0
        print(dump_toml(case.scene), case.words, f"touch at {case.time}")
        run = certified(case.scene, case.until)
        print(run.stop.message, *((float(e.time), e.impulses) for e in run.events), float(run.final_time))
        print(wrong(run))
        return 0
    signal.signal(signal.SIGALRM, _ring)
    guise_campaign.mp.dps = 60
    failures, seconds = 0, 24 if options.guises else 8
    for family in options.families.split(","):
        counts: Counter[str] = Counter()
        for seed in range(options.start, options.start + options.seeds):
            case = case_of(family, seed)
            if case is None:
                continue
            signal.alarm(seconds)
            try:
                end, found = judged(case)
                if options.guises and (differs := guised(case, Random(seed))):
                    found.append(differs)
            except TooLong:
                end, found = "TOO LONG", [f"{seconds} s"]
            except Exception as error:  # whatever it is, it is a fault
                end, found = "RAISES", [f"{type(error).__name__}: {error}"]
            finally:
                signal.alarm(0)
            counts[end] += 1
            if found:
                failures += 1
                print(f"{family} {seed}", " ".join(case.words), "|", end, "|", "; ".join(found), flush=True)
        print(family, sum(counts.values()), dict(counts), flush=True)
    return min(failures, 1)


if __name__ == "__main__":
    sys.exit(main())
