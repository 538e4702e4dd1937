"""Random scenes with segments: ends, joints, corners, slides, points and thickness, on coarse grids and off them."""

from __future__ import annotations

from random import Random

from truebreak.scenarios import Circle, Quantity, Scene, SceneError, Segment, Wall

BOX = [Wall(-8, -8, 8, -8, id="bottom"), Wall(8, -8, 8, 8, id="right"), Wall(8, 8, -8, 8, id="top"),
       Wall(-8, 8, -8, -8, id="left")]  # fmt: skip


def _place(rng: Random, fine: bool) -> str:
    return f"{rng.randint(-6999, 6999)}/1000" if fine else f"{rng.randint(-6, 6)}"


def _speed(rng: Random, fine: bool) -> str:
    return f"{rng.randint(-3000, 3000)}/1000" if fine else f"{rng.choice((-2, -1, -1, 0, 0, 1, 1, 2))}"


def _bars(rng: Random, fine: bool) -> list[tuple[str, str, str, str]]:
    """Segments alone, in chains, in stars, and along one line."""
    kind, count = rng.choice(("free", "chain", "star", "row")), rng.randint(1, 4)
    points = [(_place(rng, fine), _place(rng, fine)) for _ in range(count + 1)]
    if kind == "free":
        return [(*points[k], _place(rng, fine), _place(rng, fine)) for k in range(count)]
    if kind == "star":
        return [(*points[0], *points[k + 1]) for k in range(count)]
    if kind == "row":
        start, y = rng.randint(-5, 0), rng.randint(-4, 4)
        return [(str(start + k), str(y), str(start + k + 1), str(y)) for k in range(count)]
    return [(*points[k], *points[k + 1]) for k in range(count)]


def _slider(rng: Random) -> Scene:
    """A disc that slides over a segment and off its end, or along its line towards it, and is struck from above."""
    wait, start, off = rng.randint(1, 9), rng.randint(-7, 0), rng.choice(("0", "0", "1/2", "-1/3"))
    thick, r = Quantity.of(rng.choice(("0", "1/2"))), Quantity.of(rng.choice(("1/2", "1")))
    bars = [Segment(start, 0, start + rng.randint(1, 5), 0, id="s0", r=thick)]
    if rng.random() < 0.3:
        bars.append(Segment(bars[0].x1, 0, bars[0].x1 + 1, rng.choice((0, 0, -1, 1)), id="s1", r=thick))
    discs = [Circle(-8 + r, r + thick, r=r, vx=1, id="c0", m=rng.choice(("1", "2")))]
    y = thick + r + r + 1 + wait
    discs.append(Circle(-8 + r + wait + Quantity.of(off), y, r=1, vy=-1, id="c1", m=rng.choice(("1", "1/2"))))
    return Scene(discs, BOX[:1], segments=bars)


def scene_of(seed: int) -> Scene | None:
    """The scene of a seed; None where what it draws is refused."""
    rng = Random(seed)
    if rng.random() < 0.1:
        return _slider(rng)
    fine = rng.random() < 0.4
    thick = rng.choice(("0", "0", "1/4", "1/2", "1"))
    try:
        segments = [
            Segment(*bar, id=f"s{k}", r=thick if rng.random() < 0.8 else "0") for k, bar in enumerate(_bars(rng, fine))
        ]
        discs: list[Circle] = []
        for k in range(rng.choice((1, 1, 1, 2, 2, 3))):
            r = rng.choice(("1", "1/2", "1/4", "0")) if rng.random() < 0.8 else f"{rng.randint(1, 900)}/1000"
            vx, vy = _speed(rng, fine), _speed(rng, fine)
            x, y = _place(rng, fine), _place(rng, fine)
            if rng.random() < 0.3:  # beside a segment's line, flying along it, or straight at one of its ends
                bar = rng.choice(segments)
                if bar.y0 == bar.y1:
                    y, vy, vx = (
                        (bar.y0 + rng.choice((-1, 1)) * (bar.r + f"{r}")).text(),
                        "0",
                        rng.choice(("1", "-1", "2")),
                    )
                elif bar.x0 == bar.x1:
                    x, vx, vy = (
                        (bar.x0 + rng.choice((-1, 1)) * (bar.r + f"{r}")).text(),
                        "0",
                        rng.choice(("1", "-1", "2")),
                    )
                elif not fine:
                    vx, vy = (bar.x0 - x).text(), (bar.y0 - y).text()
            flat = [bar for bar in segments if bar.y0 == bar.y1]
            if flat and rng.random() < 0.3:  # at the very end of a face, off it by 10**-k to either side
                bar, wait, vx, vy = rng.choice(flat), rng.choice((1, 2)), rng.choice(("-2", "1")), "-1"
                off = rng.choice((0, -1, 1)) * Quantity.of(10) ** -rng.choice((3, 12, 25))
                x = (rng.choice((bar.x0, bar.x1)) + off - wait * Quantity.of(vx)).text()
                y = (bar.y0 + bar.r + Quantity.of(r) + wait).text()
            m = rng.choice(("1", "1", "2", "1/3")) if k == 0 or rng.random() < 0.85 else "oo"
            if m == "oo":
                vx = vy = "0"
            discs.append(Circle(x, y, r=r, vx=vx, vy=vy, m=m, id=f"c{k}", point=r == "0"))
        if all(c.vx == 0 and c.vy == 0 for c in discs):
            return None
        return Scene(discs, BOX if rng.random() < 0.8 else [], segments=segments)
    except SceneError:
        return None
