"""Random scenes with arcs: hollows, openings, ends, joints with segments, concentric ones, points, on grids and off."""

from __future__ import annotations

from random import Random

from truebreak.scenarios import Arc, Circle, Quantity, Scene, SceneError, Segment, Wall

BOX = [Wall(-8, -8, 8, -8, id="bottom"), Wall(8, -8, 8, 8, id="right"), Wall(8, 8, -8, 8, id="top"),
       Wall(-8, 8, -8, -8, id="left")]  # fmt: skip
TURNS = ((1, 0), (0, 1), (-1, 0), (0, -1), (3, 4), (-3, 4), (4, -3), (-4, -3), (5, 12), (-12, 5), (1, 1), (-1, 2))


def _number(rng: Random, fine: bool, most: int) -> str:
    return f"{rng.randint(-1000 * most, 1000 * most)}/1000" if fine else f"{rng.randint(-2 * most, 2 * most)}/2"


def _arc(rng: Random, fine: bool, k: int, others: list[Arc]) -> Arc:
    """An arc of its own, or of the same centre as another, or beginning where another ends."""
    r = rng.choice(("1", "2", "3", "5/2", "4")) if not fine else f"{rng.randint(800, 5000)}/1000"
    x, y = _number(rng, fine, 3), _number(rng, fine, 3)
    if others and rng.random() < 0.3:
        x, y = others[-1].x.text(), others[-1].y.text()
    if rng.random() < 0.15:
        return Arc(x, y, r, id=f"a{k}", full=True)
    cx, cy = Quantity.of(x), Quantity.of(y)
    if others and not others[-1].full and rng.random() < 0.25:  # smoothly, or with the same end
        ex, ey = others[-1].ends[1]
        back = Quantity.of(r) / others[-1].r
        cx, cy = ex - (ex - others[-1].x) * back, ey - (ey - others[-1].y) * back
        start = ex, ey
    else:
        ux, uy = rng.choice(TURNS) if not fine else (rng.randint(-99, 99), rng.randint(1, 99))
        start = cx + ux, cy + uy
    ux, uy = rng.choice(TURNS) if not fine else (rng.randint(-99, 99), rng.randint(-99, -1))
    return Arc(cx, cy, r, *start, cx + ux, cy + uy, id=f"a{k}")


def _stadium(rng: Random) -> Scene:
    """A disc in a stadium: straight sides that go over smoothly into half-circles."""
    half, r = rng.choice((0, 1, 2, "1/2")), rng.choice(("1", "2", "3/2"))
    half, r = Quantity.of(half), Quantity.of(r)
    rho = r * rng.choice(("0", "1/4", "1/2", "1/10"))
    bars = [Segment(-half, -r, half, -r, id="low"), Segment(half, r, -half, r, id="high")] if half.sign() else []
    bows = [Arc(half, 0, r, half, -r, half, r, id="east"), Arc(-half, 0, r, -half, r, -half, -r, id="west")]
    # at the very joint now and then: the flight ends below it at distance rho from the side
    vx, vy = rng.choice((0, 1, 1, 2, -1, "1/3", "7/5")), rng.choice((0, 1, 1, -2, "-2/7"))
    x, y = Quantity.of(0), Quantity.of(0)
    if rng.random() < 0.4:
        wait = Quantity.of(rng.choice(("1/2", "1/3")))
        x, y = half - Quantity.of(vx) * wait, r - rho - Quantity.of(vy) * wait
        if rng.random() < 0.3:
            x += rng.choice((-1, 1)) * Quantity.of(10) ** -rng.choice((3, 12, 25))
    return Scene([Circle(x, y, r=rho, vx=vx, vy=vy, id="c0", point=rho.sign() == 0)], segments=bars, arcs=bows)


def _corner(rng: Random) -> Scene:
    """A disc that comes to two sides at once: in the corner of a lemon, between two bulges, of a bow and a wall."""
    kind, v, rho = rng.choice(("lemon", "bulges", "wall")), rng.choice((1, 2, -1)), rng.choice(("1/2", "1/4", "3/4"))
    discs = [Circle(0, 0, r=rho, vx=v, id="c0", m=rng.choice(("1", "2")))]
    if rng.random() < 0.4:
        discs.append(Circle(-2, rng.choice(("0", "1/3")), r="1/4", vx=rng.choice((3, 1)), vy=0, id="c1"))
    if kind == "lemon":
        bows = [Arc(0, -3, 5, 4, 0, -4, 0, id="up"), Arc(0, 3, 5, -4, 0, 4, 0, id="down")]
        return Scene(discs, arcs=bows)
    if kind == "bulges":
        full = rng.random() < 0.5
        ends = () if full else (3, 0, 5, 0)
        low = () if full else (5, 0, 3, 0)
        return Scene(
            discs, BOX, arcs=[Arc(4, 1, 1, *ends, id="up", full=full), Arc(4, -1, 1, *low, id="down", full=full)]
        )
    wait = rng.choice((1, 2))
    bow, reach = Arc(0, -8, 5, 5, -8, -5, -8, id="bow"), 5 - Quantity.of(rho)
    x = ((reach - rho) * (reach + rho)).sqrt()  # where it touches the wall and the bow
    start = x - wait, -8 + Quantity.of(rho) + wait
    discs = [Circle(*start, r=rho, vx=1, vy=-1, id="c0")]
    return Scene(discs, BOX[:1], arcs=[bow])


def scene_of(seed: int) -> Scene | None:
    """The scene of a seed; None where what it draws is refused."""
    rng = Random(seed)
    try:
        if rng.random() < 0.12:
            scene = _stadium(rng)
            return None if all(c.at_rest for c in scene.circles) else scene
        if rng.random() < 0.07:
            return _corner(rng)
        fine = rng.random() < 0.4
        arcs: list[Arc] = []
        for k in range(rng.choice((1, 1, 2, 2, 3))):
            arcs.append(_arc(rng, fine, k, arcs))
        bars: list[Segment] = []
        if rng.random() < 0.3:
            bow = rng.choice(arcs)
            ends = bow.ends or ((bow.x, bow.y),)
            (ex, ey), thick = rng.choice(ends), rng.choice(("0", "0", "1/4"))
            along = (
                (bow.y - ey, ex - bow.x) if rng.random() < 0.5 else (Quantity.of(rng.randint(-3, 3)), Quantity.of(2))
            )
            bars.append(Segment(ex, ey, ex + along[0], ey + along[1], id="s0", r=thick))
        discs: list[Circle] = []
        for k in range(rng.choice((1, 1, 1, 2, 2, 3))):
            r = rng.choice(("1", "1/2", "1/4", "0", "3/4")) if rng.random() < 0.8 else f"{rng.randint(1, 900)}/1000"
            vx, vy = _number(rng, fine, 2), _number(rng, fine, 2)
            x, y = _number(rng, fine, 6), _number(rng, fine, 6)
            bow = rng.choice(arcs)
            kind = rng.random()
            if kind < 0.35:  # within, or near the middle
                x, y = (bow.x + Quantity.of(x) / 8).text(), (bow.y + Quantity.of(y) / 8).text()
            elif kind < 0.5 and not fine:  # straight at the centre, or at an end
                gx, gy = rng.choice((*bow.ends, (bow.x, bow.y)))
                vx, vy = ((gx - x) / 2).text(), ((gy - y) / 2).text()
            elif kind < 0.6:  # to graze the outside
                side = rng.choice((-1, 1))
                x, vx, vy = (bow.x + side * (bow.r + r)).text(), "0", rng.choice(("1", "-1"))
            elif kind < 0.7 and not bow.full:  # beside an end by 10**-k, from above or below
                (gx, gy), off = rng.choice(bow.ends), rng.choice((0, -1, 1)) * Quantity.of(10) ** -rng.choice((3, 12))
                vx, vy = rng.choice(("0", "1")), rng.choice(("-1", "1"))
                x, y = (gx + off - Quantity.of(vx) * 2).text(), (gy - Quantity.of(vy) * (Quantity.of(r) + 2)).text()
            m = rng.choice(("1", "1", "2", "1/3")) if k == 0 or rng.random() < 0.85 else "oo"
            if m == "oo":
                vx = vy = "0"
            discs.append(Circle(x, y, r=r, vx=vx, vy=vy, m=m, id=f"c{k}", point=r == "0"))
        if all(c.at_rest for c in discs):
            return None
        e = rng.choice(("1", "1", "1", "9/10")) if len(discs) == 1 else "1"
        return Scene(discs, BOX if rng.random() < 0.8 else [], segments=bars, arcs=arcs, restitution=e)
    except SceneError:
        return None


SPANS = ((1, -4, -1, -4), (-1, -4, 1, -4), (0, -5, 0, -3), ("3/5", "-16/5", "-3/5", "-16/5"))
"""Ends of a bow about (0, -4)."""


def falls_to_arcs(seed: int) -> Scene:
    """A disc that falls in a bowl beside a bow, with a ring high above, of which it may meet the outside."""
    rng = Random(seed)
    at = lambda low, high: Quantity.of(rng.randint(10 * low, 10 * high)) / 10  # noqa: E731
    ball = Circle(at(-5, 5), at(2, 4), r=at(1, 9) / 10, vx=at(-4, 4), vy=at(-3, 3), id="ball")
    bow = Arc(0, -4, 1, *rng.choice(SPANS), id="bow")
    things = [Arc(0, 0, 9, -9, 0, 9, 0, id="bowl"), bow, Arc(0, 9, 2, id="ring", full=True)]
    return Scene(
        [ball], arcs=things, gravity=(at(-1, 1), -10), restitution=rng.choice(("1", "9/10")), name=f"falls {seed}"
    )
