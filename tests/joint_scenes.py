"""Random scenes of joints: ends on faces from both sides, smooth joints of unlike thickness, faces that coincide."""

from __future__ import annotations

from random import Random

from segment_scenes import BOX

from truebreak.scenarios import Circle, Polygon, Quantity, Scene, SceneError, Segment


def _things(rng: Random) -> tuple[list[Segment], list[Polygon]]:
    """A floor from -4 to 4 at height 0, of one part or several, with what joins it."""
    thick = rng.choice(("0", "0", "1/2"))
    cuts = sorted(rng.sample(range(-3, 4), rng.randint(0, 3)))
    floor = [
        Segment(a, 0, b, 0, id=f"f{k}", r=thick if rng.random() < 0.8 else rng.choice(("0", "1/4")))
        for k, (a, b) in enumerate(zip([-4, *cuts], [*cuts, 4], strict=True))
    ]
    polygons: list[Polygon] = []
    kind = rng.choice(("below", "above", "slope", "level", "box", "boxes"))
    x = rng.randint(-3, 3)
    if kind == "below":  # an end right at the line of a face, seen from the other side
        floor.append(Segment(x, 0, x + rng.choice((0, 0, 1)), -3, id="t", r=rng.choice(("0", thick))))
    elif kind == "above":
        floor.append(Segment(x, 0, x, 3, id="t", r=rng.choice(("0", thick))))
    elif kind == "slope":
        floor.append(Segment(4, 0, 7, rng.choice((-2, -1, 1, 2)), id="t", r=thick))
    elif kind == "level":  # two faces on one line, of a thick segment and a thin one
        floor.append(Segment(x, "1/2", x + 3, "1/2", id="t"))
    else:
        y = Quantity.of(rng.choice(("0", "-1/2", "-2", "1")))
        count = 1 if kind == "box" else rng.randint(2, 3)
        polygons = [
            Polygon([(x + 2 * k, y - 3), (x + 2 * k + 2, y - 3), (x + 2 * k + 2, y), (x + 2 * k, y)], id=f"g{k}")
            for k in range(count)
        ]
        if rng.random() < 0.6:
            floor = []
    return floor, polygons


def scene_of(seed: int) -> Scene | None:
    """The scene of a seed; None where what it draws is refused."""
    rng = Random(seed)
    try:
        segments, polygons = _things(rng)
        discs: list[Circle] = []
        for k in range(rng.choice((1, 1, 2))):
            r = Quantity.of(rng.choice(("1", "1/2", "1/4", "0")))
            up = rng.choice((1, 1, -1))
            wait, place = rng.randint(1, 3), rng.choice((rng.randint(-4, 4), rng.randint(-9, 9)))
            top = rng.choice(("0", "1/2", "1/4", "1"))
            vx, vy = rng.choice(("0", "0", "1", "-1", "1/2")), str(-up)
            off = rng.choice((0, 0, 0, 1, -1)) * Quantity.of(10) ** -rng.choice((1, 12, 25))
            y = up * (r + top)  # when it is there
            if rng.random() < 0.25:
                vx, vy = rng.choice(("1", "-1")), "0"  # along the floor
                x = Quantity.of(place)
            else:
                x, y = place + off - wait * Quantity.of(vx), y - wait * Quantity.of(vy)
            discs.append(Circle(x, y, r=r, vx=vx, vy=vy, id=f"c{k}", point=r.sign() == 0, m=rng.choice(("1", "2"))))
        return Scene(discs, BOX if rng.random() < 0.8 else [], segments=segments, polygons=polygons)
    except SceneError:
        return None
