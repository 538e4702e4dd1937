"""The referee's scenes: every number is written as text, whole multiples of 1/1000 unless it says otherwise."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from random import Random

from truebreak.scenarios import Circle, Scene, Wall

# -- the scenes: every number is written as text, whole multiples of 1/1000 unless it says otherwise


def thousandths(number: int) -> str:
    return str(Fraction(number, 1000))


def box(width: int, height: int) -> list[Wall]:
    return [
        Wall(0, 0, 1, 0, id="floor"),
        Wall(0, height, 1, height, id="ceiling"),
        Wall(0, 0, 0, 1, id="left"),
        Wall(width, 0, width, 1, id="right"),
    ]


def scatter(
    draw: Random,
    radii: list[int],
    inside: Callable[[int, int, int], bool],
    size: tuple[int, int],
    taken: tuple[tuple[int, int, int], ...] = (),
) -> Iterator[tuple[int, int, int]]:
    """Places (x, y, r) in thousandths, drawn at random until they fit."""
    placed = list(taken)
    for r in radii:
        while True:
            x, y = draw.randrange(size[0]), draw.randrange(size[1])
            if inside(x, y, r) and all((x - a) ** 2 + (y - b) ** 2 > (r + s) ** 2 for a, b, s in placed):
                break
        placed.append((x, y, r))
        yield x, y, r


def within(width: int, height: int) -> Callable[[int, int, int], bool]:
    return lambda x, y, r: r < x < 1000 * width - r and r < y < 1000 * height - r


def velocity(draw: Random, top: int = 1000) -> dict[str, str]:
    return {"vx": thousandths(draw.randrange(-top, top)), "vy": thousandths(draw.randrange(-top, top))}


def gas(seed: int, n: int, side: int, mixed: bool) -> Scene:
    """Moving discs in a square box."""
    draw = Random(seed)
    radii = sorted((draw.randrange(150, 700) if mixed else 500 for _ in range(n)), reverse=True)
    circles = [
        Circle(thousandths(x), thousandths(y), thousandths(r), **velocity(draw),
               m=thousandths(draw.randrange(200, 5000)) if mixed else 1)
        for x, y, r in scatter(draw, radii, within(side, side), (1000 * side, 1000 * side))
    ]  # fmt: skip
    return Scene(circles, box(side, side), description=f"{n} moving discs in a box")


def rack(seed: int, rows: int) -> Scene:
    """A triangle of balls of radius 1, pitch 201/100, each moved by up to 1/500; a cue ball; cushions."""
    draw = Random(seed)
    height, vy = thousandths(12_500 + draw.randrange(-500, 500)), thousandths(draw.randrange(300))
    circles = [Circle(6, height, vx=20, vy=vy, id="cue")]
    for row in range(rows):
        for place in range(row + 1):
            jx, jy = (thousandths(draw.randrange(-2, 3)) for _ in range(2))
            x = f"20 + {row}*sqrt(3)*201/200 + {jx}"
            y = f"25/2 + {2 * place - row}*201/200 + {jy}"
            circles.append(Circle(x, y, id=f"b{len(circles)}"))
    return Scene(circles, box(50, 25), description=f"a cue ball and a loose rack of {len(circles) - 1}")


def lorentz(seed: int, triangular: bool) -> Scene:
    """One ball among fixed discs in a box."""
    draw = Random(seed)
    if triangular:
        grid = [(2 * i + j % 2 + 1, j) for i in range(4) for j in range(4)]
        places = [(f"{i}*11/10", f"({j}*sqrt(3) + 1)*11/10") for i, j in grid]
        obstacles = [Circle(x, y, "4/5", m="oo", id=f"o{k}") for k, (x, y) in enumerate(places, start=1)]
        ball = Circle("33/10", "11/10*(sqrt(3)/3*2 + 1)", "1/10", id="ball", vx="3/5", vy="7/10")
        walls = [
            Wall(0, 0, 1, 0, id="floor"),
            Wall(0, "(3*sqrt(3) + 2)*11/10", 1, "(3*sqrt(3) + 2)*11/10", id="ceiling"),
            Wall(0, 0, 0, 1, id="left"),
            Wall("99/10", 0, "99/10", 1, id="right"),
        ]
        return Scene([ball, *obstacles], walls, description="a ball in a triangular lattice of fixed discs")
    radii = sorted((draw.randrange(300, 1200) for _ in range(12)), reverse=True)
    circles = [
        Circle(thousandths(x), thousandths(y), thousandths(r), m="oo" if r > 200 else 1,
               **(velocity(draw) if r <= 200 else {}))
        for x, y, r in scatter(draw, [*radii, 200], within(10, 10), (10_000, 10_000))
    ]  # fmt: skip
    return Scene(circles, box(10, 10), description="one ball among 12 fixed discs of mixed radii")


def polygon(seed: int, corners: list[tuple[int, int]], n: int) -> Scene:
    """Moving discs in a convex polygon, corners anticlockwise, whose walls are neither level nor upright."""
    draw = Random(seed)
    ends = list(zip(corners, corners[1:] + corners[:1], strict=True))

    def inside(x: int, y: int, r: int) -> bool:
        for (ax, ay), (bx, by) in ends:
            height = (bx - ax) * (y - 1000 * ay) - (by - ay) * (x - 1000 * ax)
            if height <= 0 or height**2 <= r**2 * ((bx - ax) ** 2 + (by - ay) ** 2):
                return False
        return True

    size = (1000 * max(x for x, _ in corners), 1000 * max(y for _, y in corners))
    radii = sorted((draw.randrange(300, 900) for _ in range(n)), reverse=True)
    circles = [
        Circle(thousandths(x), thousandths(y), thousandths(r), **velocity(draw),
               m=thousandths(draw.randrange(500, 3000)))
        for x, y, r in scatter(draw, radii, inside, size)
    ]  # fmt: skip
    walls = [Wall(*a, *b) for a, b in ends]
    return Scene(circles, walls, description=f"{n} moving discs inside {len(corners)} slanted walls")


def triangle() -> Scene:
    """Four discs in an equilateral triangle of side 12: one level wall, two with sqrt(3) in their points."""
    walls = [
        Wall(0, 0, 12, 0, id="floor"),
        Wall(12, 0, 6, "6*sqrt(3)", id="right"),
        Wall(6, "6*sqrt(3)", 0, 0, id="left"),
    ]
    circles = [
        Circle(3, "1.3", "0.9", vx="0.7", vy="0.31"),
        Circle("9.1", "1.2", 1, vx="-0.45", vy="0.83", m=2),
        Circle("6.05", "sqrt(2)*3", "1.1", vx="0.2", vy="-sqrt(2)/2", m=3),
        Circle("6.1", "7.7", "0.5", vx="-0.9", vy="-0.6", m="1/2"),
    ]
    return Scene(circles, walls, description="4 discs inside an equilateral triangle")


def heavy(seed: int) -> Scene:
    """Two discs of mass 10**6 and six of mass 1 in a box."""
    draw = Random(seed)
    circles = [
        Circle(thousandths(x), thousandths(y), thousandths(r), m=10**6 if r == 1500 else 1,
               **velocity(draw, 100 if r == 1500 else 1000))
        for x, y, r in scatter(draw, [1500, 1500, *[250] * 6], within(10, 10), (10_000, 10_000))
    ]  # fmt: skip
    return Scene(circles, box(10, 10), description="2 discs a million times as heavy as the 6 others")


def chambers(seed: int, n: int) -> Scene:
    """n discs in one box and their mirror image in another: every instant is two independent contacts."""
    draw = Random(seed)
    circles = []
    for k, (x, y, r) in enumerate(scatter(draw, [600] * n, within(5, 6), (5000, 6000)), start=1):
        vx, vy = draw.randrange(-1000, 1000), draw.randrange(-1000, 1000)
        for side, sign in (("l", -1), ("r", 1)):
            place = thousandths(sign * (1000 + x)), thousandths(y)
            motion = thousandths(sign * vx), thousandths(vy)
            circles.append(Circle(*place, thousandths(r), *motion, id=f"{side}{k}"))
    walls = [
        Wall(0, 0, 1, 0, id="floor"),
        Wall(0, 6, 1, 6, id="ceiling"),
        Wall(-6, 0, -6, 1, id="left"),
        Wall(-1, 0, -1, 1, id="inner-left"),
        Wall(1, 0, 1, 1, id="inner-right"),
        Wall(6, 0, 6, 1, id="right"),
    ]
    return Scene(circles, walls, description=f"{n} discs in a box, and their mirror image in another")


SCENES: dict[str, tuple[Callable[[], Scene], int]] = {
    "gas5-equal": (lambda: gas(seed=1, n=5, side=6, mixed=False), 200),
    "gas5-mixed": (lambda: gas(seed=2, n=5, side=6, mixed=True), 500),
    "gas10-equal": (lambda: gas(seed=3, n=10, side=8, mixed=False), 400),
    "gas10-mixed": (lambda: gas(seed=4, n=10, side=8, mixed=True), 400),
    "gas20-equal": (lambda: gas(seed=5, n=20, side=8, mixed=False), 300),
    "gas20-mixed": (lambda: gas(seed=6, n=20, side=9, mixed=True), 300),
    "rack6": (lambda: rack(seed=7, rows=3), 300),
    "rack15": (lambda: rack(seed=8, rows=5), 300),
    "lorentz12": (lambda: lorentz(seed=9, triangular=False), 300),
    "lorentz-triangular": (lambda: lorentz(seed=0, triangular=True), 300),
    "slanted5": (lambda: polygon(11, [(1, 0), (9, 2), (10, 7), (4, 10), (0, 5)], 6), 400),
    "triangle4": (triangle, 400),
    "heavy8": (lambda: heavy(seed=13), 400),
    "chambers6": (lambda: chambers(seed=14, n=3), 200),
}
"""Every committed scene by name, and its number of instants."""
MERGED = {"chambers6"}
"""The scenes whose ties between independent contacts are merged."""
