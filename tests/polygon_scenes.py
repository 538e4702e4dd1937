"""Random scenes with polygons: concave corners, thickness, side by side, with segments; on grids and off them."""

from __future__ import annotations

from random import Random

from segment_scenes import BOX

from truebreak.scenarios import Circle, Polygon, Quantity, Scene, SceneError, Segment


def _number(rng: Random, fine: bool, size: int = 6) -> str:
    return f"{rng.randint(-1000 * size, 1000 * size)}/1000" if fine else str(rng.randint(-size, size))


def _polygon(rng: Random, fine: bool, name: str) -> Polygon:
    """A triangle, a box, a comb, a dart, or whatever few points happen to bound."""
    x, y = Quantity.of(_number(rng, fine, 5)), Quantity.of(_number(rng, fine, 5))
    w, h = rng.randint(1, 4), rng.randint(1, 4)
    kind = rng.choice(("triangle", "box", "box", "dart", "stairs", "bent", "free", "free"))
    shape: list[tuple[int | str, int | str]] = {
        "triangle": [(0, 0), (w, 0), (rng.randint(-1, 3), h)],
        "box": [(0, 0), (w, 0), (w, h), (0, h)],
        "dart": [(0, 0), (w, 0), (w, h + 2), (f"{w}/2", rng.choice((1, 1, f"{h}/2"))), (0, h + 2)],
        "stairs": [(0, 0), (3, 0), (3, 1), (2, 1), (2, 2), (1, 2), (1, 3), (0, 3)],
        "bent": [(0, 0), (w, 0), (w, h), (f"{w}/2", h), (f"{w}/3", h), (0, h)],  # points within a side
        "free": [(_number(rng, fine, 3), _number(rng, fine, 3)) for _ in range(rng.randint(3, 6))],
    }[kind]
    points = [(x + a, y + b) for a, b in shape]
    if rng.random() < 0.5:
        points.reverse()
    return Polygon(points, id=name, r=rng.choice(("0", "0", "0", "1/4", "1/2", "1")))


def _drawn(rng: Random, fine: bool) -> list[Polygon]:
    """Some polygons; now and then two boxes with a common side."""
    if rng.random() < 0.15:
        x, y, w = rng.randint(-4, 1), rng.randint(-4, 2), rng.randint(1, 2)
        boxes = [((0, 0), (w, 0), (w, 1), (0, 1)), ((w, 0), (w + 2, 0), (w + 2, 1 + rng.randint(0, 1)), (w, 1))]
        return [Polygon([(x + a, y + b) for a, b in box], id=f"g{k}") for k, box in enumerate(boxes)]
    found: list[Polygon] = []
    for _ in range(60):
        if len(found) > (rng.random() < 0.4):
            break
        try:
            found.append(_polygon(rng, fine, f"g{len(found)}"))
        except SceneError:
            continue
    return found


def _aimed(rng: Random, polygon: Polygon, x: Quantity, y: Quantity) -> tuple[str, str]:
    """A velocity at a corner of a polygon, or beside it by 10**-k."""
    px, py = rng.choice(polygon.points)
    off = rng.choice((0, 0, 1, -1)) * Quantity.of(10) ** -rng.choice((3, 12, 25))
    return (px - x + off).text(), (py - y).text()


def scene_of(seed: int) -> Scene | None:
    """The scene of a seed; None where what it draws is refused."""
    rng = Random(seed)
    fine = rng.random() < 0.35
    polygons = _drawn(rng, fine)
    if not polygons:
        return None
    segments = []
    if rng.random() < 0.2:
        (ax, ay), (bx, by) = rng.choice(polygons[0].points), (_number(rng, fine), _number(rng, fine))
        try:
            segments = [Segment(ax, ay, bx, by, id="s0", r=rng.choice(("0", "0", "1/4")))]
        except SceneError:
            return None
    discs: list[Circle] = []
    for k in range(rng.choice((1, 1, 1, 2, 2, 3))):
        for _ in range(40):
            r = rng.choice(("1", "1/2", "1/4", "0")) if rng.random() < 0.8 else f"{rng.randint(1, 900)}/1000"
            x, y = _number(rng, fine, 7), _number(rng, fine, 7)
            vx, vy = _number(rng, fine, 2), _number(rng, fine, 2)
            if rng.random() < 0.25:
                vx, vy = _aimed(rng, rng.choice(polygons), Quantity.of(x), Quantity.of(y))
            flat = [(a, b) for p in polygons for a, b in p.sides() if a[1] == b[1]]
            if flat and rng.random() < 0.25:  # along a side
                polygon = rng.choice([p for p in polygons if any(a[1] == b[1] for a, b in p.sides())])
                a, b = rng.choice([(a, b) for a, b in polygon.sides() if a[1] == b[1]])
                up = 1 if (b[0] - a[0]).sign() > 0 else -1
                y, vy, vx = (a[1] + up * (polygon.r + r)).text(), "0", rng.choice(("1", "-1", "2"))
            try:
                disc = Circle(x, y, r=r, vx=vx, vy=vy, m=rng.choice(("1", "1", "2", "1/3")), id=f"c{k}", point=r == "0")
                Scene([*discs, disc], BOX, polygons=polygons, segments=segments)
            except SceneError:
                continue
            discs.append(disc)
            break
    if not discs or all(c.at_rest for c in discs):
        return None
    return Scene(discs, BOX if rng.random() < 0.8 else [], polygons=polygons, segments=segments)
