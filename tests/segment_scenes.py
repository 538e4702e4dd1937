"""Random scenes with segments: ends, joints, corners, slides, points and thickness, on coarse grids and off them."""

from __future__ import annotations

from random import Random

from truebreak.scenarios import Circle, Scene, SceneError, Segment, Wall

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


def scene_of(seed: int) -> Scene | None:
    """The scene of a seed; None where what it draws is refused."""
    rng = Random(seed)
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
            m = rng.choice(("1", "1", "2", "1/3")) if k == 0 or rng.random() < 0.85 else "oo"
            if m == "oo":
                vx = vy = "0"
            discs.append(Circle(x, y, r=r, vx=vx, vy=vy, m=m, id=f"c{k}", point=r == "0"))
        if all(c.vx == 0 and c.vy == 0 for c in discs):
            return None
        return Scene(discs, BOX if rng.random() < 0.8 else [], segments=segments)
    except SceneError:
        return None
