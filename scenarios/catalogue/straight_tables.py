"""Tables of straight things: walls, segments and polygons, whose corners and joints are what is hard about them."""

from __future__ import annotations

from ..numbers.quantity import Quantity
from ..scene import Scene
from ..settings import TiePolicy
from ..things import Circle, Pocket, Polygon, Segment, Wall
from .rack import LENGTH, POCKET, WIDTH, rack
from .scene_entry import Parameter, SceneEntry, number, tie_policy, whole

EVENTS = 100

GUTKIN = (
    "E. Gutkin, Billiards in polygons: survey of recent results, Journal of Statistical Physics 83 (1996), 7; "
    "I. Niven, Irrational Numbers (1956): the angles of this triangle are no rational multiples of pi"
)
RICHENS = (
    "P. J. Richens and M. V. Berry, Pseudointegrable systems in classical and quantum mechanics, "
    "Physica D 2 (1981), 495"
)
WIND = (
    "P. and T. Ehrenfest, Begriffliche Grundlagen der statistischen Auffassung in der Mechanik (1912); "
    "J. Hardy and J. Weber, Diffusion in a periodic wind-tree model, Journal of Mathematical Physics 21 (1980), 1802"
)


def triangle(vx: Quantity, vy: Quantity) -> Scene:
    """A point in the right triangle with the sides 3, 4 and 5.

    >>> len(triangle(Quantity.of(1), Quantity.of("1/3")).walls)
    3
    """
    walls = [Wall(0, 0, 4, 0, id="4"), Wall(0, 3, 0, 0, id="3"), Wall(4, 0, 0, 3, id="5")]
    return Scene([Circle(1, 1, r=0, vx=vx, vy=vy, id="ball", point=True)], walls, events=EVENTS)


def barrier(height: Quantity, vx: Quantity, vy: Quantity) -> Scene:
    """A point in the square of side 1 with a slit that stands in the middle of its floor.

    >>> barrier(Quantity.of("1/2"), Quantity.of(1), Quantity.of("sqrt(2)")).segments[0].y1
    Quantity('1/2')
    """
    ball = Circle("1/4", "1/3", r=0, vx=vx, vy=vy, id="ball", point=True)
    return Scene([ball], _box(1, 1), segments=[Segment("1/2", 0, "1/2", height, id="slit")], events=EVENTS)


def wind_tree(rows: int, side: Quantity, vx: Quantity, vy: Quantity) -> Scene:
    """A point among rows * rows square trees whose middles are 1 apart, in a box half a spacing wider.

    >>> scene = wind_tree(3, Quantity.of("1/2"), Quantity.of(1), Quantity.of("sqrt(2)"))
    >>> len(scene.polygons), scene.walls[1].x0
    (9, Quantity('3'))
    """
    half = Quantity.of("1/2")
    trees = [
        _rectangle(column + half, row + half, side, side, f"tree {column + 1},{row + 1}")
        for row in range(rows)
        for column in range(rows)
    ]
    ball = Circle((1 - side) / 5, (1 - side) / 7, r=0, vx=vx, vy=vy, id="ball", point=True)
    return Scene([ball], _box(rows, rows), polygons=trees, events=EVENTS)


MOUTH = Quantity.of("7/2")
"""How far from a corner of the table its cushions begin, in inches: a ball of 9/4 has room between their jaws."""

SIDE = Quantity.of("5/2")
"""The same, from the middle of a long side."""

DEPTH = Quantity.of(3)
"""How deep a cushion is; the jaws at a corner are at 45 degrees, those in the middle straight."""


def bumper(rows: int, offset: Quantity, speed: Quantity, tie: TiePolicy) -> Scene:
    """The break of `rack` on a table of six cushions with jaws, between which balls fall into six pockets.

    >>> zero = Quantity.of(0)
    >>> scene = bumper(2, zero, Quantity.of(1), TiePolicy())
    >>> [cushion.id for cushion in scene.polygons][:2], len(scene.pockets), scene.capture
    (['bottom left', 'bottom right'], 6, True)
    """
    zero = Quantity.of(0)
    balls = rack(rows, zero, zero, 0, offset, speed, tie, False).circles
    middle, far = Quantity.of(LENGTH) / 2, Quantity.of(LENGTH)
    long = [(MOUTH, zero), (middle - SIDE, zero), (middle - SIDE, -DEPTH), (MOUTH - DEPTH, -DEPTH)]
    short = [(zero, MOUTH), (zero, WIDTH - MOUTH), (-DEPTH, WIDTH - MOUTH + DEPTH), (-DEPTH, MOUTH - DEPTH)]
    cushions = [
        Polygon(long, id="bottom left"),
        Polygon([(far - x, y) for x, y in long], id="bottom right"),
        Polygon([(x, WIDTH - y) for x, y in long], id="top left"),
        Polygon([(far - x, WIDTH - y) for x, y in long], id="top right"),
        Polygon(short, id="left"),
        Polygon([(far - x, y) for x, y in short], id="right"),
    ]
    pockets = [
        Pocket(x, y, POCKET, id=f"pocket {side} {place}")
        for out, edge, side in ((-2, zero, "bottom"), (2, Quantity.of(WIDTH), "top"))
        for x, y, place in ((zero, edge, "left"), (middle, edge + out, "middle"), (far, edge, "right"))
    ]
    return Scene(balls, polygons=cushions, pockets=pockets, capture=True, tie_policy=tie, events=EVENTS)


def funnel(discs: int, width: Quantity) -> Scene:
    """Discs of radius 1 that come down side by side, in pairs, into a funnel with an opening of a width.

    >>> len(funnel(6, Quantity.of(3)).circles)
    6
    """
    circles: list[Circle] = []
    for k in range(discs):
        row, side = divmod(k, 2)
        x = (1 if side else -1) * Quantity.of("21/10")
        circles.append(Circle(x, 8 + Quantity.of("5/2") * row, vy=-1, id=f"{'right' if side else 'left'} {row + 1}"))
    half = width / 2
    sides = [Segment(-half, 0, -half - 6, 6, id="slope left"), Segment(half, 0, half + 6, 6, id="slope right")]
    chutes = [Segment(-half, 0, -half, -6, id="chute left"), Segment(half, 0, half, -6, id="chute right")]
    return Scene(circles, segments=[*sides, *chutes], events=EVENTS)


def breakout(columns: int, rows: int) -> Scene:
    """A ball of radius 5 that flies at bricks of 20 by 10, side by side, from a paddle, in a frame.

    >>> len(breakout(21, 5).polygons)
    105
    """
    bricks = [
        _rectangle(Quantity.of(100 + 20 * column), Quantity.of(400 + 10 * row), Quantity.of(20), Quantity.of(10),
                   f"brick {column + 1},{row + 1}")
        for row in range(rows) for column in range(columns)
    ]  # fmt: skip
    frame = [
        Segment(50, 50, 50, 550, id="left", r=2),
        Segment(50, 550, 550, 550, id="top", r=2),
        Segment(550, 550, 550, 50, id="right", r=2),
        Segment(50, 50, 550, 50, id="bottom", r=2),
        Segment(250, 100, 350, 100, id="paddle", r=8),
    ]
    return Scene([Circle(300, 140, r=5, vx=40, vy=400, id="ball")], segments=frame, polygons=bricks, events=EVENTS)


def ghost(segments: int) -> Scene:
    """A disc that slides over a floor of many segments on one line, to a wall behind its end.

    >>> len(ghost(30).segments)
    30
    """
    floor = [Segment(k, 0, k + 1, 0, id=f"s{k + 1}") for k in range(segments)]
    end = Wall(segments + 3, 0, segments + 3, 1, id="end")
    return Scene([Circle(-2, 1, vx=1, id="disc")], [end], segments=floor, until=segments + 5)


def corner_hit(off: Quantity) -> Scene:
    """A disc of radius 1 that comes down beside the upright side of a box, `off` to the right of it.

    >>> corner_hit(Quantity.of(0)).circles[0].x
    Quantity('0')
    """
    box = Polygon([(-4, -3), (0, -3), (0, 0), (-4, 0)], id="box")
    return Scene([Circle(off, 3, vy=-1, id="disc")], polygons=[box], until=9)


def _box(width: int, height: int) -> list[Wall]:
    return [
        Wall(0, 0, 0, 1, id="left"),
        Wall(width, 0, width, 1, id="right"),
        Wall(0, 0, 1, 0, id="bottom"),
        Wall(0, height, 1, height, id="top"),
    ]


def _rectangle(x: Quantity, y: Quantity, width: Quantity, height: Quantity, name: str) -> Polygon:
    """A rectangle about a point."""
    w, h = width / 2, height / 2
    return Polygon([(x - w, y - h), (x + w, y - h), (x + w, y + h), (x - w, y + h)], id=name)


DIRECTION = (
    Parameter("vx", "1", "velocity in x", number()),
    Parameter("vy", "sqrt(2)", "velocity in y", number()),
)

SCENES = {
    "triangle": SceneEntry(
        name="triangle",
        summary="A point in the right triangle with sides 3, 4 and 5.",
        parameters=DIRECTION,
        known=(
            "Errors grow in proportion to time: every exponent is 0. Two angles are no rational multiples of pi: new "
            "directions keep coming, 7 in 40 events and 59 in 1,000. Whether it is ergodic is open."
        ),
        source=GUTKIN,
        make=triangle,
    ),
    "barrier": SceneEntry(
        name="barrier",
        summary="A point in a square with a slit: pseudo-integrable.",
        parameters=(Parameter("height", "1/2", "length of the slit", number(above=0)), *DIRECTION),
        known=(
            "Only four velocities occur, (vx, vy) and its mirror images, and every exponent is 0. Yet it is not "
            "integrable: the end of the slit parts neighbours for good, and their surface has two holes."
        ),
        source=RICHENS,
        make=barrier,
    ),
    "wind-tree": SceneEntry(
        name="wind-tree",
        summary="The wind-tree model of the Ehrenfests, in a box.",
        parameters=(
            Parameter("rows", "3", "the grid has rows * rows trees", whole(1, 20)),
            Parameter("side", "1/2", "side of a tree; their middles are 1 apart", number(above=0)),
            *DIRECTION,
        ),
        known="Only four velocities occur, (vx, vy) and its mirror images, and every exponent is 0.",
        source=WIND,
        make=wind_tree,
    ),
    "bumper": SceneEntry(
        name="bumper",
        summary="The billiards break on a table of cushions with jaws and six pockets.",
        parameters=(
            Parameter("rows", "4", "rows of the triangle", whole(1, 5)),
            Parameter("offset", "1/50", "the cue's distance from the table's axis", number()),
            Parameter("speed", "1", "speed of the cue, in inches a second", number(above=0)),
            Parameter("tie", "simultaneous", "tie policy, such as sequential:seed=7", tie_policy),
        ),
        known=(
            "A ball leaves the table only into a pocket. Without offset the scene is its own mirror image in the "
            "table's axis, and stays so."
        ),
        source="the table of rack, with cushions of which each mouth lets a ball of 9/4 pass",
        make=bumper,
    ),
    "funnel": SceneEntry(
        name="funnel",
        summary="Discs in pairs come down into a funnel.",
        parameters=(
            Parameter("discs", "12", "how many discs", whole(1, 100)),
            Parameter("width", "3", "width of the opening; a disc is 2 wide", number(above=0)),
        ),
        known="With an even number of discs the scene is its own mirror image, and stays so.",
        source="the funnels in which users of pymunk and box2d let discs fall, without gravity",
        make=funnel,
    ),
    "breakout": SceneEntry(
        name="breakout",
        summary="A ball among bricks, as in pymunk's example program.",
        parameters=(
            Parameter("columns", "21", "bricks in a row", whole(1, 21)),
            Parameter("rows", "5", "rows of bricks", whole(1, 10)),
        ),
        known=(
            "The speed never changes. Bricks that stand side by side are one wall; here they stay, the paddle rests, "
            "and the bottom is hard."
        ),
        source="V. Blomqvist, pymunk, examples/breakout.py: its frame, bricks, paddle and ball",
        make=breakout,
    ),
    "ghost": SceneEntry(
        name="ghost",
        summary="A disc slides over a floor of many segments on one line: it meets nothing.",
        parameters=(Parameter("segments", "30", "segments of length 1", whole(1, 1000)),),
        known="It flies on as over one segment, and meets the wall behind at time segments + 4, nothing before.",
        source="Rapier, issue 669 (Ghost Collision Handling); E. Catto, Ghost Collisions, box2d.org (2020)",
        make=ghost,
    ),
    "corner-hit": SceneEntry(
        name="corner-hit",
        summary="A disc comes down at the corner of a box: on its top, or at the corner itself.",
        parameters=(Parameter("off", "10**-20", "how far right of the box's upright side its middle is", number()),),
        known=(
            "Up to off = 0 it goes straight back up at time 2; with 0 < off < 1 it meets the corner at time "
            "3 - sqrt(1 - off**2), and leaves with the velocity (2 off sqrt(1 - off**2), 1 - 2 off**2)."
        ),
        source="elementary",
        make=corner_hit,
    ),
}
