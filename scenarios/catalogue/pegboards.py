"""Boards of pegs, bowls and levels of games under gravity: what is round and stands is met at quartics."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from ..numbers.quantity import Quantity
from ..scene import Scene
from ..things import Arc, Circle, Polygon, Segment, Wall
from .scene_entry import Draw, Parameter, SceneEntry, number, whole

PEG = Quantity.of("1/5")
"""Radius of a peg; two beside each other are 2 apart, and a ball has the radius 1/2."""

BALL = Quantity.of("1/2")
ROW = Quantity.of("7/4")
"""How far a row is below the one before: a little more than in triangles of equal sides."""

FALL = 10
"""Gravity of boards and levels that have no other."""


def _pegs(rows: int, reach: int, odd: bool) -> Iterator[Circle]:
    """Rows of pegs 2 apart, set off by 1 from the row before, from -reach to reach; `odd`: the first has none at 0."""
    for row in range(rows):
        first = -reach + (reach + row + odd) % 2
        for k, x in enumerate(range(first, reach + 1, 2), 1):
            yield Circle(x, -ROW * row, r=PEG, fixed=True, id=f"peg {row + 1},{k}")


def _collector(bins: int, floor: Quantity, height: int) -> list[Segment]:
    """Bins side by side, each 2 wide: their floors, and what parts them."""
    floors = [Segment(2 * k - bins, floor, 2 * k + 2 - bins, floor, id=f"bin {k + 1}") for k in range(bins)]
    between = [(k, 2 * k - bins) for k in range(1, bins)]
    return [*floors, *(Segment(x, floor, x, floor + height, id=f"divider {k}") for k, x in between)]


def _sides(half: int) -> list[Wall]:
    return [Wall(-half, 0, -half, 1, id="left"), Wall(half, 0, half, 1, id="right")]


def galton(rows: int, e: Quantity, seed: int) -> Scene:
    """A ball on rows of pegs, above a collector of rows + 1 bins; where it starts is drawn from a seed.

    >>> from ..numbers.quantity import Quantity
    >>> scene = galton(3, Quantity.of("1/2"), 1)
    >>> [str(s.id) for s in scene.segments if str(s.id).startswith("bin")], abs(scene.circles[0].x) < "1/4"
    (['bin 1', 'bin 2', 'bin 3', 'bin 4'], True)
    """
    x = Quantity.of(f"{Draw(seed).between(-(10**9) + 1, 10**9 - 1)}/{4 * 10**9}")
    floor = -ROW * (rows - 1) - 6
    return Scene(
        [Circle(x, 3, r=BALL, id="ball"), *_pegs(rows, rows, False)],
        _sides(rows + 1),
        segments=_collector(rows + 1, floor, 5),
        gravity=(0, -FALL),
        restitution=e,
        events=200,
    )


SLOTS, PLINKO_ROWS = 9, 12


def plinko(slot: int, off: Quantity, e: Quantity) -> Scene:
    """A disc that is let go above one of nine slots, beside its middle, on twelve rows of pegs.

    >>> plinko(5, Quantity.of("1/100"), Quantity.of("1/2")).circles[0].x
    Quantity('1/100')
    """
    return Scene(
        [Circle(2 * slot - SLOTS - 1 + off, 3, r=BALL, id="disc"), *_pegs(PLINKO_ROWS, SLOTS - 1, False)],
        _sides(SLOTS),
        segments=_collector(SLOTS, -ROW * (PLINKO_ROWS - 1) - 6, 5),
        gravity=(0, -FALL),
        restitution=e,
        events=200,
    )


def peg_mirror(rows: int, x: Quantity, e: Quantity) -> Scene:
    """Two balls as far left and right of the axis of a board of pegs, let go at one time."""
    balls = [Circle(side * x, 3, r=BALL, id=name) for side, name in ((-1, "left ball"), (1, "right ball"))]
    floor = Wall(0, -ROW * rows - 2, 1, -ROW * rows - 2, id="floor")
    board = [*_pegs(rows, rows + 1, True)]
    return Scene([*balls, *board], [floor, *_sides(rows + 2)], gravity=(0, -FALL), restitution=e, events=100)


def axis(k: int, h: Quantity) -> Scene:
    """A ball that falls by h onto a peg, 2**-k beside its axis; it and the peg have the radius 1/2.

    >>> axis(3, Quantity.of(4)).circles[0].x
    Quantity('1/8')
    """
    off = Quantity.of(f"1/{2**k}") if k else Quantity.of(0)
    peg = Circle(0, 0, r=BALL, fixed=True, id="peg")
    return Scene([Circle(off, h + 1, r=BALL, id="ball"), peg], [], gravity=(0, -FALL), events=40)


def ramp(h: Quantity, length: Quantity) -> Scene:
    """A ball that falls by h onto a ramp that goes down by 3 for 4 across, at its upper end, and is `length` long.

    >>> ramp(Quantity.of(1), Quantity.of(100)).segments[0].y1
    Quantity('-60')
    """
    slope = Segment(0, 0, length * 4 / 5, -length * 3 / 5, id="ramp")
    # 1 along the ramp, where the middle of the ball is 1/2 above it as it lands
    x, y = Quantity.of("4/5") + BALL * 3 / 5, -Quantity.of("3/5") + BALL * 4 / 5
    return Scene([Circle(x, y + h, r=BALL, id="ball")], [], segments=[slope], gravity=(0, -FALL), events=20)


def ski_jump(v: Quantity, e: Quantity) -> Scene:
    """A ball that leaves a table level, at the speed v, above a slope that goes down by 3 for 4 across, to a level.

    Its middle begins as far above the slope's line as its radius, where the slope has not begun yet.
    """
    start = -BALL * 3 / 5, -BALL * 4 / 5  # of the slope's line, at the foot of the ball's middle
    foot = start[0] + 48, start[1] - 36
    slope = Segment(start[0] + "4/5", start[1] - "3/5", *foot, id="slope")
    level = Segment(*foot, foot[0] + 400, foot[1], id="level")
    table = Segment(-6, -1, -1, -1, id="table")
    return Scene(
        [Circle(0, 0, r=BALL, vx=v, id="ball")],
        [],
        segments=[table, slope, level],
        gravity=(0, -FALL),
        restitution=e,
        events=60,
    )


ROOM = ((10, 50), (680, 50), (680, 370), (10, 370))
ROUNDED = ((500, 50), (520, 60), (540, 80), (550, 100), (550, 150))
PLATFORMS = (
    ((170, 50), (270, 150)), ((400, 150), (450, 150)), ((400, 200), (450, 200)), ((220, 200), (300, 200)),
    ((50, 250), (200, 250)), ((10, 370), (50, 250)),
)  # fmt: skip


def platforms(vx: Quantity, e: Quantity) -> Scene:
    """The level of pymunk's platformer, as a ball finds it that is thrown where its player stands.

    >>> len(platforms(Quantity.of(200), Quantity.of("9/10")).segments)
    15
    """
    ways = [
        *((a, b, f"room {k}") for k, (a, b) in enumerate(zip(ROOM, (*ROOM[1:], ROOM[0]), strict=True), 1)),
        *((a, b, f"rounded {k}") for k, (a, b) in enumerate(pairwise(ROUNDED), 1)),
        *((a, b, f"platform {k}") for k, (a, b) in enumerate(PLATFORMS, 1)),
        ((270, 100), (320, 100), "bridge"),
    ]
    segments = [Segment(*a, *b, r=5 if name == "bridge" else 3, id=name) for a, b, name in ways]
    ball = Circle(100, 100, r=10, vx=vx, id="ball")
    return Scene([ball], [], segments=segments, gravity=(0, -1000), restitution=e, events=60)


BOWL = 2
"""How far the middle of a ball in a bowl is from that of the bowl where they touch: 5/2 less the ball's radius."""


def bowl(h: Quantity, off: Quantity) -> Scene:
    """A ball that is let go in a half-circle, h above the lowest place that it can be at, beside the axis.

    >>> bowl(Quantity.of(1), Quantity.of(0)).circles[0].y
    Quantity('-1')
    """
    half = Arc(0, 0, BALL + BOWL, -BALL - BOWL, 0, BALL + BOWL, 0, id="bowl")
    ball = Circle(off, h - BOWL, r=BALL, id="ball")
    return Scene([ball], [], arcs=[half], gravity=(0, -FALL), events=40)


HALF, TOP = 6, 14
"""Half of the width of a pinball table, and how high its sides go over into the dome."""


def pinball_table(v: Quantity, e: Quantity) -> Scene:
    """A ball that is shot up a lane into a dome, onto lanes and bumpers, above flippers that stand still, and a drain.

    >>> [str(arc.id) for arc in pinball_table(Quantity.of(20), Quantity.of(1)).arcs]
    ['dome', 'left bow', 'right bow']
    """
    bumpers = ((-2, 8), (2, 8), (0, 5))
    bars = {
        "shooter": (5, 0, 5, 12), "left lane": (-1, 11, -1, 12), "right lane": (1, 11, 1, 12),
        "left guide": (-5, 3, -5, 4), "left flipper": (-5, 3, -1, 1), "right flipper": (5, 3, 1, 1),
    }  # fmt: skip
    slings = {"left sling": ((-4, 4), (-4, 6), (-3, 4)), "right sling": ((4, 4), (3, 4), (4, 6))}
    return Scene(
        [
            Circle(HALF - BALL, 1, r="1/4", vy=v, id="ball"),
            *(Circle(x, y, r="3/4", fixed=True, id=f"bumper {k}") for k, (x, y) in enumerate(bumpers, 1)),
        ],
        [*_sides(HALF), Wall(0, -1, 1, -1, id="drain")],
        segments=[Segment(*ends, id=name) for name, ends in bars.items()],
        polygons=[Polygon(points, r="1/8", id=name) for name, points in slings.items()],
        arcs=[
            Arc(0, TOP, HALF, HALF, TOP, -HALF, TOP, id="dome"),
            Arc(-4, 10, 1, -4, 11, -5, 10, id="left bow"),
            Arc(3, 10, 1, 4, 10, 3, 11, id="right bow"),
        ],
        gravity=(0, -FALL),
        restitution=e,
        events=200,
    )


ROWS = Parameter("rows", "5", "rows of pegs", whole(1, 40))
LOSS = Parameter("e", "7/10", "restitution", number(above=0))
COINS = "Were each peg a fair coin, the bins would be binomial: bin k + 1 of rows + 1 with C(rows, k) / 2**rows"

SCENES = {
    "galton": SceneEntry(
        name="galton",
        summary="A ball falls through rows of pegs into a bin: the Galton board.",
        parameters=(ROWS, LOSS, Parameter("seed", "1", "seed of where it starts", whole(0, 10**9))),
        known=(
            f"{COINS}. It is no coin: the way is fixed by where the ball starts. At e = 1, on a board without end, the "
            "speed grows as the cube root of time, and the ball comes back to the top again and again."
        ),
        source=(
            "F. Galton, Natural Inheritance (1889); N. Chernov and D. Dolgopyat, The Galton board: limit theorems and "
            "recurrence, Journal of the AMS 22 (2009), 821"
        ),
        make=galton,
    ),
    "plinko": SceneEntry(
        name="plinko",
        summary="A disc is let go above one of nine slots, and falls through twelve rows of pegs.",
        parameters=(
            Parameter("slot", "5", "above which slot it is let go", whole(1, SLOTS)),
            Parameter("off", "1/100", "how far right of the slot's middle", number()),
            LOSS,
        ),
        known=(
            "Were each peg a fair coin, a disc from above the middle would come to the middle with C(12, 6) / 2**12, "
            "which is .226. From slot 10 - s, as far left, it goes the mirror image of the way from slot s, exactly."
        ),
        source="the game of television; A. Biesterfeld, Journal of Statistics Education 9, no. 3 (2001)",
        make=plinko,
    ),
    "peg-mirror": SceneEntry(
        name="peg-mirror",
        summary="Two balls are let go as far left and right of the axis of a board of pegs.",
        parameters=(
            Parameter("rows", "4", "rows of pegs", whole(1, 40)),
            Parameter("x", "7/5", "how far from the axis they start", number(above=0)),
            Parameter("e", "1", "restitution", number(above=0)),
        ),
        known=(
            "They are each other's mirror image for ever: they meet their pegs at the same instants, row after row, "
            "which are zeros of quartics, and each other on the axis."
        ),
        source="elementary",
        make=peg_mirror,
    ),
    "axis": SceneEntry(
        name="axis",
        summary="A ball bounces on top of a peg, all but on its axis.",
        parameters=(
            Parameter("k", "20", "it starts 2**-k beside the axis; 0: on it", whole(0, 400)),
            Parameter("h", "4", "how far it falls", number(above=0)),
        ),
        known=(
            "On the axis it bounces for ever, each 2 sqrt(2 h / g). Beside it the way to the axis grows L-fold a "
            "bounce, with L + 1/L = 2 + 8 h: 34-fold at h = 4, so that it falls off after some k / 5 bounces."
        ),
        source="elementary: a flight, and a mirror of radius 1, linear in the way to the axis",
        make=axis,
    ),
    "ramp": SceneEntry(
        name="ramp",
        summary="A ball is dropped on a ramp, and bounces down it.",
        parameters=(
            Parameter("h", "1", "how far it falls", number(above=0)),
            Parameter("length", "100", "length of the ramp", number(above=1)),
        ),
        known=(
            "It lands 8 h sin(a) = 24 h / 5 farther down, then twice, then three times as far again, at equal "
            "intervals of 2 sqrt(2 h / g), as long as the ramp lasts."
        ),
        source="school physics: the ball dropped on an inclined plane",
        make=ramp,
    ),
    "ski-jump": SceneEntry(
        name="ski-jump",
        summary="A ball leaves a table, lands on a slope below, and runs out on a level.",
        parameters=(
            Parameter("v", "8", "its speed, level", number(above=0)),
            Parameter("e", "9/10", "restitution", number(above=0)),
        ),
        known=(
            "On a slope of the angle a it lands after 2 v tan(a) / g, that is 3 v / 20, and by "
            "2 v**2 sin(a) / (g cos(a)**2), that is 3 v**2 / 16, down the slope from where it left."
        ),
        source="school physics: range on an inclined plane",
        make=ski_jump,
    ),
    "platforms": SceneEntry(
        name="platforms",
        summary="A ball is thrown in the level of pymunk's platformer, without friction.",
        parameters=(
            Parameter("vx", "700", "velocity to the right", number()),
            Parameter("e", "1", "restitution", number(above=0)),
        ),
        known=(
            "The level is 15 segments, of which many share ends; its player, a moving platform and friction are left "
            "out. A ball of radius 10 never leaves the room, and its energy never grows."
        ),
        source="V. Blomqvist, pymunk, examples/platformer.py: its room, platforms and gravity",
        make=platforms,
    ),
    "bowl": SceneEntry(
        name="bowl",
        summary="A ball bounces in a bowl, a half-circle, beside its axis.",
        parameters=(
            Parameter("h", "1/2", "how far above the lowest place that it can be at it is let go", number(above=0)),
            Parameter("off", "1/4", "how far right of the axis", number()),
        ),
        known=(
            "Near the axis the tops of its way are at off cos(n a), with cos(a) = 1 - 4 h / R and R = 2: as it began "
            "after every fourth bounce from h = 1/2. It stays there if h < R / 2, and leaves the axis from above that."
        ),
        source="elementary: a flight, and a hollow mirror of radius R, linear in the way to the axis",
        make=bowl,
    ),
    "pinball-table": SceneEntry(
        name="pinball-table",
        summary="A ball is shot into the dome of a pinball table, falls among bumpers, and drains.",
        parameters=(
            Parameter("v", "18", "the speed at which it is shot", number(above=0)),
            Parameter("e", "3/4", "restitution", number(above=0)),
        ),
        known=(
            "It never comes higher than v**2 / 20 above its start; its energy never grows. Nobody plays: in the end "
            "it bounces on the drain, infinitely often in finite time; or, shot fast, it comes to roll along the dome, "
            "where the run ends as that is suspected."
        ),
        source="E. N. Lorenz, The Essence of Chaos (1993), chapter 1: the pinball machine as an example of chaos",
        make=pinball_table,
    ),
}
