"""Scenes with gravity, walls that move, a restitution and what is round, against a referee of their own.

python tests/falling_campaign.py --scenes 20000 --out falling.jsonl   # a second call goes on
python tests/falling_campaign.py --report --out falling.jsonl         # the counts so far
python tests/falling_campaign.py --replay 17                          # one scene, as TOML, and what differs

The bases are those of `edge_campaign` and two of discs, walls and fixed circles; gravity, motion and the older
ingredients are added by chance. The referee keeps true coordinates: every gap is a polynomial of the time, of degree
four for what is round and does not fall, and a meeting is the first of its zeros, all found between those of its
derivative, at which it falls.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from random import Random

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parent)

import edge_campaign as edges
import segment_referee as sharp
from edge_campaign import Aged, Campaign, NotForThis, OlderReferee
from mpmath import mpf, sqrt
from segment_referee import Disc, Happened, number

from truebreak.scenarios import Circle, Polygon, Quantity, Scene, SceneError, Segment, Wall

# -- Zeros of polynomials: the constant coefficient first.


def value(c: list[mpf], t: mpf) -> mpf:
    """A polynomial at a time."""
    total = mpf(0)
    for x in reversed(c):
        total = total * t + x
    return total


def zero_between(c: list[mpf], low: mpf, high: mpf) -> mpf:
    """The one zero between two times at which a polynomial has two signs and between which it is monotone."""
    slope = [k * x for k, x in enumerate(c)][1:]
    rising = value(c, high) > 0
    t = (low + high) / 2
    for _ in range(2000):
        at, steep = value(c, t), value(slope, t)
        low, high = (low, t) if (at > 0) == rising else (t, high)
        step = t - at / steep if steep != 0 else low
        near = step if low < step < high else (sqrt(low * high) if low > 0 and high > 4 * low else (low + high) / 2)
        if abs(near - t) <= (1 + abs(t)) * mpf(10) ** (12 - sharp.DIGITS):
            return near
        t = near
    raise NotForThis("a zero that is hard to find")


def changes(c: list[mpf]) -> list[mpf]:
    """The positive times at which a polynomial changes its sign, ascending; a graze is none."""
    while c and abs(c[-1]) < sharp.SAME:
        c = c[:-1]
    if len(c) < 2:
        return []
    if len(c) == 2:
        return [t] if (t := -c[0] / c[1]) > 0 else []
    turns = changes([k * x for k, x in enumerate(c)][1:])
    beyond = 2 + max(abs(x / c[-1]) for x in c[:-1])  # Cauchy's bound
    sizes = [abs(x) for x in c]
    turns = [t for t in turns if abs(value(c, t)) > sharp.SAME * (1 + value(sizes, t))]
    places = [mpf(0), *turns, max([beyond, *(2 * t for t in turns)])]
    values = [value(c, t) for t in places]
    return [
        zero_between(c, a, b)
        for a, b, va, vb in zip(places, places[1:], values, values[1:], strict=False)
        if (va > 0) != (vb > 0)
    ]


def meetings(c: list[mpf]) -> list[mpf]:
    """The times after now at which a gap, zero or more now, falls through zero."""
    if abs(c[0]) < sharp.SAME:  # it touches: the zero that is now is divided out
        c = c[1:]
        if c and abs(c[0]) < sharp.SAME:
            c = c[1:]
            if c and abs(c[0]) < sharp.SAME:
                if all(abs(x) < sharp.SAME for x in c):
                    return []
                raise NotForThis("a contact that lasts up to the third order")
            if c and c[0] < 0:
                raise NotForThis("at rest")
            if not c:
                return []
        if c[0] < 0:
            raise NotForThis("it goes in: impulses without a last one, too weak to be seen")
    sign = c[0] > 0
    found = changes(c)
    return found[0 if sign else 1 :: 2]


class FallingReferee(OlderReferee):
    """The referee, in true coordinates: what moves falls, and walls go on at a constant velocity."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        zero = Quantity.of(0)
        self.g = [number(part) for part in scene.gravity or (zero, zero)]
        things = [*scene.walls, *scene.segments, *scene.polygons]
        self.paces = {str(thing.id): (number(thing.vx), number(thing.vy)) for thing in things}
        self.rides = any(any(self.paces[bar.id]) for bar in self.bars)
        if self.rides:
            self.outlines, self.ends = [], self._ends_by_pace()

    def _ends_by_pace(self) -> list[tuple[str, mpf, mpf, mpf]]:
        """The ends of segments, one for each place and velocity, named by the first of the thickest there."""
        found: list[tuple[str, mpf, mpf, mpf]] = []
        for bar in self.bars:
            for way in (mpf(0), bar.length):
                x, y = bar.x + way * bar.ux, bar.y + way * bar.uy
                same = [
                    k
                    for k, (name, ex, ey, _) in enumerate(found)
                    if abs(ex - x) + abs(ey - y) < sharp.SAME and self.paces[name] == self.paces[bar.id]
                ]
                if not same:
                    found.append((bar.id, x, y, bar.r))
                elif bar.r > found[same[0]][3]:
                    found[same[0]] = (bar.id, x, y, bar.r)
        return found

    def clear(self) -> bool:
        """As without motion; what moves goes through what is fixed."""
        every = self.discs
        self.discs = [disc for disc in every if disc.w or not self.rides]
        try:
            return super().clear()
        finally:
            self.discs = every

    def _pull(self, disc: Disc) -> tuple[mpf, mpf]:
        return (self.g[0], self.g[1]) if disc.w else (mpf(0), mpf(0))

    def fly(self, wait: mpf) -> None:
        for disc in self.discs:
            gx, gy = self._pull(disc)
            disc.x += disc.vx * wait + gx * wait * wait / 2
            disc.y += disc.vy * wait + gy * wait * wait / 2
            disc.vx += gx * wait
            disc.vy += gy * wait
        for bar in self.bars:
            ux, uy = self.paces[bar.id]
            bar.x, bar.y = bar.x + ux * wait, bar.y + uy * wait
        paces = self.paces
        self.walls = [(k, x + paces[k][0] * wait, y + paces[k][1] * wait, *normal) for k, x, y, *normal in self.walls]
        self.ends = [(k, x + paces[k][0] * wait, y + paces[k][1] * wait, r) for k, x, y, r in self.ends]
        self.now += wait

    def resolve(self) -> Happened:
        """As without motion, with the velocity of what pushes."""
        contacts = [row for row in self.normals() if any(d.w for d, _, _ in row[1])]
        still = (mpf(0), mpf(0))
        first: set[tuple[str, str]] = set()
        for rounds in range(1000):
            speeds = []
            for (_, other), arms in contacts:
                ux, uy = self.paces.get(other, still)
                speeds.append(sum((nx * (d.vx - ux) + ny * (d.vy - uy) for d, nx, ny in arms), mpf(0)))
            coming = [k for k, u in enumerate(speeds) if u < -sharp.SAME]
            if any(
                abs(u) < sharp.SAME and self._on_a_line(arms) for (_, arms), u in zip(contacts, speeds, strict=True)
            ):
                raise NotForThis("a point along a line, of which its velocity does not say on which side it is")
            if not coming:
                return Happened(self.now, first, {name for name, _ in contacts}, rounds)
            first = first or {contacts[k][0] for k in coming}
            self.push([contacts[k][1] for k in coming], [speeds[k] for k in coming])
        raise AssertionError("no end")

    def _on_a_line(self, arms: list[tuple[Disc, mpf, mpf]]) -> bool:
        return len(arms) == 1 and arms[0][0].r == 0 and self.e == 0

    def next_instant(self) -> tuple[mpf, bool] | None:
        """The time until something comes that may change something, and whether that is a point at a point."""
        rows = sorted(self._coming(), key=lambda row: row[0])
        if self.turn_at is not None and self.turned is None:
            rows.append((self.turn_at - self.now, False))
        first = min((t for t, _ in rows), default=None)
        return None if first is None else (first, any(blunt for t, blunt in rows if t < first + sharp.SAME))

    def _coming(self) -> Iterator[tuple[mpf, bool]]:
        for a, b in combinations(self.discs, 2):
            if (a.w or b.w) and a.r + b.r > 0:
                (ax, ay), (bx, by) = self._pull(a), self._pull(b)
                place = b.x - a.x, b.y - a.y, b.vx - a.vx, b.vy - a.vy, bx - ax, by - ay
                yield from ((t, False) for t in meetings(around(*place, a.r + b.r)))
        for disc in self.discs:
            if not disc.w:
                continue
            gx, gy = self._pull(disc)
            for name, x, y, nx, ny in self.walls:
                ux, uy = self.paces[name]
                height, speed = (disc.x - x) * nx + (disc.y - y) * ny, (disc.vx - ux) * nx + (disc.vy - uy) * ny
                pull = (gx * nx + gy * ny) / 2
                side = self._side(height, speed, pull)
                if side:
                    gap = [side * height - disc.r, side * speed, side * pull]
                    yield from ((t, False) for t in meetings(gap))
            for bar in self.bars:
                yield from ((t, False) for t in self._onto(disc, bar))
            for name, x, y, r in self.ends:
                ux, uy = self.paces[name]
                place = disc.x - x, disc.y - y, disc.vx - ux, disc.vy - uy, gx, gy
                if disc.r + r > 0:
                    yield from ((t, False) for t in meetings(around(*place, disc.r + r)))
                elif not any(self.g):
                    hit = sharp.falls(*place[:4], mpf(0))
                    yield from [] if hit is None else [(hit[0], True)]
            for _, x, y, r in self.pockets:
                place = disc.x - x, disc.y - y, disc.vx, disc.vy, gx, gy
                gap = around(*place, r)
                if gap[0] < -sharp.SAME or (abs(gap[0]) < sharp.SAME and gap[1] < -sharp.SAME):  # it is inside
                    yield from ((t, False) for t in changes(gap)[1::2])
                elif abs(gap[0]) > sharp.SAME or gap[1] > sharp.SAME:
                    yield from ((t, False) for t in meetings(gap))
                else:
                    raise NotForThis("along a rim")

    def _side(self, height: mpf, speed: mpf, pull: mpf) -> int:
        """On which side of a line a circle is; 0 where it stays on it."""
        for what in (height, speed, pull):
            if abs(what) > sharp.SAME:
                return 1 if what > 0 else -1
        return 0

    def _onto(self, disc: Disc, bar: sharp.Bar) -> Iterator[mpf]:
        """When a disc comes down on a bar, from either side of it, beside it."""
        (px, py), (gx, gy) = self.paces[bar.id], self._pull(disc)
        x, y, vx, vy = disc.x - bar.x, disc.y - bar.y, disc.vx - px, disc.vy - py
        along = [x * bar.ux + y * bar.uy, vx * bar.ux + vy * bar.uy, (gx * bar.ux + gy * bar.uy) / 2]
        across = [y * bar.ux - x * bar.uy, vy * bar.ux - vx * bar.uy, (gy * bar.ux - gx * bar.uy) / 2]
        for side in (1, -1):
            gap = [side * part for part in across]
            gap[0] -= disc.r + bar.r
            touches = abs(gap[0]) < sharp.SAME
            if touches and not self._beside(along[0], bar):
                touches = False  # at its height, beside it: nothing pushes
            if touches:
                rising = next((x for x in gap[1:] if abs(x) > sharp.SAME), mpf(0))
                if rising < 0 and disc.r + bar.r == 0:
                    continue  # a point on the line that is on its other side
                yield from (t for t in meetings(gap) if self._beside(value(along, t), bar))
            else:
                falling = [k * x for k, x in enumerate(gap)][1:]
                yield from (
                    t
                    for t in changes(gap)
                    if t > sharp.SAME and value(falling, t) < 0 and self._beside(value(along, t), bar)
                )

    def _beside(self, along: mpf, bar: sharp.Bar) -> bool:
        return sharp.SAME < along < bar.length - sharp.SAME


def around(x: mpf, y: mpf, vx: mpf, vy: mpf, ax: mpf, ay: mpf, reach: mpf) -> list[mpf]:
    """The squared distance less a reach squared."""
    return [
        x * x + y * y - reach * reach,
        2 * (x * vx + y * vy),
        vx * vx + vy * vy + x * ax + y * ay,
        vx * ax + vy * ay,
        (ax * ax + ay * ay) / 4,
    ]


# -- What is drawn.


def _some(rng: Random, low: int, high: int) -> str:
    return f"{rng.randint(low * 100, high * 100)}/100"


def pegboard(seed: int) -> Scene | None:
    """Discs among fixed circles and points, between walls."""
    rng = Random(f"pegs {seed}")
    circles: list[Circle] = []
    for k in range(rng.choice((1, 1, 2, 3))):
        place = _some(rng, -5, 5), _some(rng, 0, 8)
        r, m = rng.choice(("1/2", "1/4", "sqrt(2)/4", "1")), rng.choice(("1", "2", "1/3"))
        circles.append(Circle(*place, r, _some(rng, -4, 4), _some(rng, -4, 4), m, id=f"b{k}"))
    for k in range(rng.randint(1, 6)):
        r = rng.choice(("1/2", "1/10", "0", "1", "sqrt(3)/3"))
        circles.append(Circle(_some(rng, -5, 5), _some(rng, -6, 5), r, m="oo", id=f"peg{k}", point=r == "0"))
    walls = [Wall(-7, 0, -7, -1, id="left"), Wall(7, 0, 7, 1, id="right"), Wall(0, -8, 1, -8, id="floor")]
    try:
        return Scene(circles, walls[: rng.choice((2, 3, 3))])
    except SceneError:
        return None


def boxed(seed: int) -> Scene | None:
    """Discs and points among walls, some of them tilted."""
    rng = Random(f"boxed {seed}")
    circles: list[Circle] = []
    for k in range(rng.choice((1, 2, 3, 4))):
        r = rng.choice(("1/2", "1/4", "3/4", "1", "0", "sqrt(2)/2"))
        place, speed = (_some(rng, -5, 5), _some(rng, -5, 5)), (_some(rng, -3, 3), _some(rng, -3, 3))
        circles.append(Circle(*place, r, *speed, rng.choice(("1", "2", "3")), id=f"c{k}", point=r == "0"))
    sides = [(-7, 7, -7, 0), (7, 0, 7, 7), (-7, -7, 0, -7), (7, 7, 0, 7)]
    walls = [Wall(*side, id=f"w{k}") for k, side in enumerate(sides) if rng.random() < 0.7]
    if rng.random() < 0.4:
        nx, ny = rng.choice(((3, 4), (-3, 4), (1, 2), (5, 12), (1, 1)))
        walls.append(Wall(-2 * nx, -2 * ny, -2 * nx + ny, -2 * ny - nx, id="tilted"))
    try:
        return Scene(circles, walls)
    except SceneError:
        return None


def _gravity(aged: Aged, rng: Random) -> Aged:
    """Mostly downward; weak and strong, now and then."""
    down = rng.choice(("1", "10", "981/100", "1/3", "sqrt(2)", "1/1000000", "100000"))
    aside = "0" if "twin" in aged.ingredients or rng.random() < 0.6 else rng.choice(("1/3", "-2", "sqrt(3)"))
    gravity = (Quantity.of(aside), -Quantity.of(down))
    return replace(aged, scene=aged.scene.with_changes(gravity=gravity))


def _moving(aged: Aged, rng: Random) -> Aged:
    """Walls that go on for ever; between the two halves of a mirrored scene a floor that rises."""
    walls = list(aged.scene.walls) or [Wall(0, -40, 1, -40, id="floor")]
    moved = []
    for k, w in enumerate(walls):
        vx, vy = (_some(rng, -1, 1), _some(rng, -1, 1)) if k == 0 or rng.random() < 0.5 else ("0", "0")
        moved.append(Wall(w.x0, w.y0, w.x1, w.y1, id=w.id, vx="0" if "twin" in aged.ingredients else vx, vy=vy))
    return replace(aged, scene=aged.scene.with_changes(walls=moved))


def _carried(aged: Aged, rng: Random) -> Aged:
    """Segments and polygons that move, each its own way; where there are none, a paddle and a wedge."""
    scene, twin = aged.scene, "twin" in aged.ingredients

    def pace() -> dict[str, str]:
        return {"vx": "0" if twin else _some(rng, -2, 2), "vy": _some(rng, -2, 2)}

    segments, polygons = list(scene.segments), list(scene.polygons)
    if not segments and not polygons:
        x, y = Quantity.of(_some(rng, -6, 2)), Quantity.of(_some(rng, -7, 0))
        (dx, dy), r = rng.choice(((3, 0), (0, 3), (2, 1), (1, -2))), rng.choice(("0", "1/4", "1/10"))
        segments.append(Segment(x, y, x + dx, y + dy, id="paddle", r=r))
        if rng.random() < 0.4:
            corner = Quantity.of(_some(rng, 2, 6))
            polygons.append(Polygon([(corner, -5), (corner + 2, -5), (corner + 1, -3)], id="wedge"))
    moved = [
        Segment(s.x0, s.y0, s.x1, s.y1, s.id, s.r, **(pace() if k == 0 or rng.random() < 0.7 else {}))
        for k, s in enumerate(segments)
    ]
    solid = [Polygon(p.points, p.id, p.r, **(pace() if rng.random() < 0.7 else {})) for p in polygons]
    return replace(aged, scene=scene.with_changes(segments=moved, polygons=solid))


def _e(aged: Aged, rng: Random) -> Aged:
    e = rng.choice(("1/2", "9/10", "sqrt(2)/2", "1/1000", "999999/1000000", "0"))
    return replace(aged, scene=aged.scene.with_changes(restitution=e))


def _late(aged: Aged, rng: Random) -> Aged:
    """One is thrown up so far that it is long in coming back, and the rest waits for it."""
    fast = Quantity.of(10) ** rng.choice((2, 4, 6))

    def up(c: Circle) -> Circle:
        return edges._again(c, vy=fast)

    return replace(edges._with_one(aged, rng, up), until=aged.until * fast)


INGREDIENTS = {
    **{k: add for k, add in edges.INGREDIENTS.items() if k != "restitution"},
    "late": _late, "gravity": _gravity, "motion": _moving, "restitution": _e,
    "carried": _carried,
}  # fmt: skip
FALLING = Campaign(
    "falling",
    {"boxed": boxed, "pegs": pegboard, **edges.BASES},
    INGREDIENTS,
    FallingReferee,
    (
        ("restitution", "reversal"),
        ("motion", "reversal"),
        ("carried", "reversal"),
    ),
    ("REST", "ACCUMULATION", "CRUSHED"),
    (240, mpf(10) ** -110),
    {"gravity": 0.6, "motion": 0.3, "restitution": 0.3, "carried": 0.3},
)

if __name__ == "__main__":
    sys.exit(edges.main(FALLING))
