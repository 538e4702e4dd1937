"""Families of scenes that get harder as one whole number grows: each is a function, and an entry of the table."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import isqrt

from flint import arb

from ...scenarios import catalogue
from ...scenarios.errors import SceneError
from ...scenarios.numbers.precision import at_bits
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.things import Circle, Segment, Wall
from ...scenarios.trajectory import Trajectory
from ..engines import suggestion

SHORT = 4
"""Members of a lane in a short map: both ends, and two between."""


@dataclass(frozen=True)
class MapPlace:
    """One member of a family: everything that decides its scene.

    Attributes:
        family: the family's name.
        k: how hard.
        side: which of the family's variants.
        seed: what is drawn; 0 where nothing is.
    """

    family: str
    k: int
    side: str
    seed: int = 0

    @property
    def lane(self) -> str:
        """The ladder that it stands on, without its family.

        >>> MapPlace("near-ties", 7, "left").lane, MapPlace("scaled", 7, "up", 2).lane
        ('left', 'up, seed 2')
        """
        return f"{self.side}, seed {self.seed}" if self.seed else self.side

    @property
    def show(self) -> str:
        """The command that prints its scene.

        >>> MapPlace("scaled", 7, "up", 2).show
        'truebreak stress scaled --show 7 --side up --seed 2'
        """
        seed = f" --seed {self.seed}" if self.seed else ""
        return f"truebreak stress {self.family} --show {self.k} --side {self.side}{seed}"


@dataclass(frozen=True, kw_only=True)
class StressFamily:
    """Scenes for k = `first` to `most`, on each of its sides and for each of its seeds.

    Attributes:
        name: as on the command line.
        summary: what happens in the scene.
        grows: what k is.
        make: the scene of k, a side and a seed, with limits of its own.
        first, last: the k of the map unless others are asked for.
        most: the largest k that can be asked for.
        sides: its variants.
        seeds: of what it draws; (0,) where it draws nothing.
        known: whether a run has the outcome that a closed form gives; None where there is none. It takes the run, k,
            side and seed.
    """

    name: str
    summary: str
    grows: str
    make: Callable[[int, str, int], Scene]
    first: int = 1
    last: int
    most: int
    sides: tuple[str, ...] = ("only",)
    seeds: tuple[int, ...] = (0,)
    known: Callable[[Trajectory, int, str, int], bool] | None = None

    def levels(self, short: bool = False) -> tuple[int, ...]:
        """The k of the map; a short map has a few, evenly spread.

        >>> def make(k: int, side: str, seed: int) -> Scene:
        ...     return Scene([])
        >>> one = StressFamily(name="one", summary="", grows="", make=make, last=10, most=99)
        >>> one.levels(short=True)
        (1, 4, 7, 10)
        """
        whole = range(self.first, self.last + 1)
        if not short or len(whole) <= SHORT:
            return tuple(whole)
        return tuple(self.first + round(step * (len(whole) - 1) / (SHORT - 1)) for step in range(SHORT))

    def places(self, levels: tuple[int, ...]) -> Iterator[MapPlace]:
        """Lane by lane, from the easiest on."""
        for side in self.sides:
            for seed in self.seeds:
                for k in levels:
                    yield MapPlace(self.name, k, side, seed)

    def place(self, k: int, side: str | None = None, seed: int | None = None) -> MapPlace:
        """One member; without a side or a seed, the first.

        Raises:
            SceneError: for a k, side or seed that the family has not.
        """
        self.check(k)
        side = self.sides[0] if side is None else side
        if side not in self.sides:
            raise SceneError(f"--side {side!r}: {self.name} has none of that name; {suggestion(side, [*self.sides])}")
        seed = self.seeds[0] if seed is None else seed
        if seed not in self.seeds:
            told = "draws nothing; leave --seed out" if self.seeds == (0,) else f"has the seeds {self._seeds()}"
            raise SceneError(f"--seed {seed}: {self.name} {told}")
        return MapPlace(self.name, k, side, seed)

    def _seeds(self) -> str:
        return ", ".join(map(str, self.seeds))

    def check(self, k: int) -> None:
        """Refuses a k out of range.

        Raises:
            SceneError: naming the range.
        """
        if not self.first <= k <= self.most:
            raise SceneError(f"k = {k}: {self.name} has k from {self.first} to {self.most}; choose one of them")

    def scene(self, place: MapPlace) -> Scene:
        """The scene of a place, named after it.

        Raises:
            SceneError: for a k out of range.
        """
        self.check(place.k)
        seed = f"-{place.seed}" if place.seed else ""
        made = self.make(place.k, place.side, place.seed)
        return made.with_changes(
            name=f"{self.name}-{place.side}{seed}-{place.k}",
            description=f"{self.summary} Here k = {place.k}; {self.grows}.",
            source=place.show,
        )


ENDS = {"left": ("-11/5", "-8/25", "-3/25"), "right": ("-8/5", "-39/25", "1/25")}
"""Final velocities where the left pair goes first, and where the right one does, by hand: three impulses each."""


def near_tie(k: int, side: str, seed: int) -> Scene:
    """Lee's three balls, the outer one on the other side 10**-k late.

    >>> near_tie(3, "left", 0).circles[2].x.text()
    '4001/1000'
    """
    return catalogue.build("near-tie", k=k, first=side)


def near_tie_known(run: Trajectory, k: int, side: str, seed: int) -> bool:
    """Whether the balls end as they do by hand."""
    return tuple(circle.vx.text() for circle in run.final.circles) == ENDS[side]


def graze(k: int, side: str, seed: int) -> Scene:
    """To and fro between two walls, aslant by 36 degrees; it misses the other by 10**-k, or overlaps its path by that.

    >>> len(graze(3, "hit", 0).walls)
    2
    """
    sign = "" if side == "miss" else "-"
    return catalogue.build("grazing", miss=f"{sign}1/10**{k}", angle=36).with_changes(events=6)


def graze_known(run: Trajectory, k: int, side: str, seed: int) -> bool:
    """Whether the two meet first of all, or the mover meets walls alone."""
    met = [pair for event in run.events for pair in event.impulses]
    return met[0] == ("mover", "rest") if side == "hit" else ("mover", "rest") not in met


COS, SIN = Quantity.of("3/5"), Quantity.of("4/5")
"""The direction in which the fast one flies: no double holds it."""


def drift(k: int, side: str, seed: int) -> Scene:
    """The slow one starts where the fast one would exactly graze it, and drifts into its path, or out of it.

    >>> slow = drift(3, "in", 0).circles[1]
    >>> (slow.vx.text(), slow.vy.text())
    ('1/1250', '-3/5000')
    """
    speed = Quantity.of(10) ** -k * (-1 if side == "in" else 1)
    fast = Circle(-5 * COS, -5 * SIN, vx=COS, vy=SIN, id="fast")
    slow = Circle(-2 * SIN, 2 * COS, vx=-speed * SIN, vy=speed * COS, id="slow")
    walls = [Wall(d * COS, d * SIN, d * COS - SIN, d * SIN + COS, id=name) for d, name in ((-9, "back"), (9, "front"))]
    return Scene([fast, slow], walls, events=4)


def drift_known(run: Trajectory, k: int, side: str, seed: int) -> bool:
    """Whether the two meet before anything else, or the fast one flies on to the front wall."""
    return run.events[0].impulses == ((("fast", "slow") if side == "in" else ("fast", "front")),)


def end(k: int, side: str, seed: int) -> Scene:
    """A ball flies past the end of a segment that stands across its way, 2**-k too near or too far.

    >>> scene = end(3, "hit", 0)
    >>> scene.segments[0].x0.text(), scene.circles[0].x.text()
    ('0', '-37/10')
    """
    beside = 1 + Quantity.of(2) ** -k * (-1 if side == "hit" else 1)
    ball = Circle(-5 * COS - beside * SIN, -5 * SIN + beside * COS, vx=COS, vy=SIN, id="ball")
    walls = [Wall(d * COS, d * SIN, d * COS - SIN, d * SIN + COS, id=name) for d, name in ((-9, "back"), (9, "front"))]
    return Scene([ball], walls, segments=[Segment(0, 0, 3 * SIN, -3 * COS, id="bar")], events=4)


def end_known(run: Trajectory, k: int, side: str, seed: int) -> bool:
    """Whether the ball meets the segment before anything else, or flies on to the front wall, and to the back."""
    met = [event.impulses for event in run.events]
    return met[0] == (("ball", "bar"),) if side == "hit" else met[:2] == [(("ball", "front"),), (("ball", "back"),)]


def kick(k: int, side: str, seed: int) -> Scene:
    """Lee's three balls, 10**k as heavy, the outer two equally far off; a ball of mass 1 catches one up and pushes it.

    The push changes its speed by 4/(10**k + 1) or 4/(4 * 10**k + 1), so that it is first by about 10**-k.

    >>> [c.m.text() for c in kick(2, "left", 0).circles]
    ['100', '100', '400', '1']
    """
    m = Quantity.of(10) ** k
    heavy = [
        Circle(-12, 0, vx=1, m=m, id="left"),
        Circle(0, 0, m=m, id="middle"),
        Circle(13, 0, r=2, vx=-1, m=4 * m, id="right"),
    ]
    at, speed = (-16, 3) if side == "left" else (18, -3)
    return Scene([*heavy, Circle(at, 0, vx=speed, id="light")], events=12)


def galperin(k: int, side: str, seed: int) -> Scene:
    """A ball 10**k times as heavy pushes a small one to a wall.

    >>> galperin(2, "wall", 0).circles[1].m.text()
    '100'
    """
    small, big = Circle(2, 0, id="small"), Circle(6, 0, r=2, vx=-1, m=10**k, id="big")
    return Scene([small, big], [Wall(0, 0, 0, 1, id="wall")], events=4 * isqrt(10**k) + 10)


def galperin_known(run: Trajectory, k: int, side: str, seed: int) -> bool:
    """Whether there are ceil(pi / arctan(sqrt(1 / 10**k))) - 1 collisions, for the angle that each turns.

    Only for k = 0 is the quotient a whole number, 4.
    """
    with at_bits(256):
        turns = (arb.pi() / (arb(1) / arb(10) ** k).sqrt().atan()).floor().unique_fmpz()
    return run.collisions == (3 if k == 0 else turns)


def scaled(k: int, side: str, seed: int) -> Scene:
    """Four discs in a box, all lengths and speeds 10**k as large, or as small.

    >>> scaled(12, "down", 1).circles[0].r.text()
    '1/1000000000000'
    """
    s = Quantity.of(10) ** (k if side == "up" else -k)
    base = catalogue.build("gas", n=4, seed=seed)
    circles = [Circle(c.x * s, c.y * s, c.r * s, c.vx * s, c.vy * s, c.m, c.id) for c in base.circles]
    walls = [Wall(w.x0 * s, w.y0 * s, w.x1 * s, w.y1 * s, w.id) for w in base.walls]
    return Scene(circles, walls, events=8)


def moved(k: int, side: str, seed: int) -> Scene:
    """Four discs in a box, 10**k to the right, or to the left and down.

    >>> scene = moved(12, "aslant", 1)
    >>> scene.walls[0].x0.text(), scene.walls[2].y0.text()
    ('-1000000000000', '-1000000000000')
    """
    far = Quantity.of(10) ** k
    dx, dy = (far, 0 * far) if side == "along" else (-far, -far)
    base = catalogue.build("gas", n=4, seed=seed)
    circles = [Circle(c.x + dx, c.y + dy, c.r, c.vx, c.vy, c.m, c.id) for c in base.circles]
    walls = [Wall(w.x0 + dx, w.y0 + dy, w.x1 + dx, w.y1 + dy, w.id) for w in base.walls]
    return Scene(circles, walls, events=8)


def wedge(k: int, side: str, seed: int) -> Scene:
    """A ball goes from wall to wall at 45 degrees, and exactly grazes an obstacle, were the walls parallel.

    The upper one is tilted by 10**-k about its point above the start. The obstacle is 1/4 in radius, 5/4 beside the
    ball's way up from (40, 1) to (42, 3).

    >>> wedge(5, "opening", 0).walls[1].y1.text()
    '400001/100000'
    """
    tilt = Quantity.of(10) ** -k * (1 if side == "opening" else -1)
    beside = Quantity.of("5/8") * Quantity.of("sqrt(2)")
    obstacle = Circle(Quantity.of("203/5") + beside, Quantity.of("8/5") - beside, r="1/4", m="oo", id="obstacle")
    walls = [Wall(0, 0, 1, 0, id="lower"), Wall(0, 4, 1, 4 + tilt, id="upper")]
    return Scene([Circle(0, 1, vx=1, vy=1, id="ball"), obstacle], walls, events=24)


def corner(k: int, side: str, seed: int) -> Scene:
    """A corner of 72 degrees, closed by a third wall; the ball flies along its bisector, 10**-k above it or below.

    >>> ball = corner(3, "lower", 0).circles[0]
    >>> ball.y.text(), ball.vy.text()
    ('-1/1000', '0')
    """
    beside = Quantity.of(10) ** -k * (1 if side == "upper" else -1)
    base = catalogue.build("corner", angle=72)
    ball = Circle(base.circles[0].x, beside, vx=-1, id="ball")
    return base.with_changes(circles=[ball], events=6)


def corner_known(run: Trajectory, k: int, side: str, seed: int) -> bool:
    """Whether the ball meets the wall on its side of the bisector first, and then the other."""
    other = "lower" if side == "upper" else "upper"
    return [event.impulses for event in run.events[:2]] == [(("ball", side),), (("ball", other),)]


def orbit(k: int, side: str, seed: int) -> Scene:
    """Between two fixed discs, 10**-k beside the line through their centres: it leaves after about k bounces.

    >>> orbit(3, "left", 0).events
    28
    """
    sign = "" if side == "left" else "-"
    return catalogue.build("pinball", discs=2, r="1/10", offset=f"{sign}1/10**{k}").with_changes(events=k + 25)


def touching(k: int, side: str, seed: int) -> Scene:
    """A row of k + 1 touching balls of radius 3/10, or a triangle of k + 1 rows, struck by one more.

    >>> len(touching(3, "row", 0).circles), len(touching(3, "triangle", 0).circles)
    (5, 11)
    """
    if side == "row":
        return catalogue.build("cradle", n=k + 1, r="3/10", gap=0).with_changes(events=3)
    r, height = Quantity.of("3/10"), Quantity.of("sqrt(3)")
    balls = [Circle(r * height * row, r * (row - 2 * place), r) for row in range(k + 1) for place in range(row + 1)]
    return Scene([Circle(-2, 0, r, vx=1, id="cue"), *balls], events=3, until=3)


def gap(k: int, side: str, seed: int) -> Scene:
    """Three rows of balls, neighbours 10**-k apart, struck by a cue ball 1/10 above the axis, or below it.

    >>> len(gap(3, "above", 0).circles)
    7
    """
    offset = "1/10" if side == "above" else "-1/10"
    spec = {"rows": 3, "gap": f"1/10**{k}", "offset": offset, "pockets": "no"}
    return catalogue.build("rack", **spec).with_changes(events=12)


def long_run(k: int, side: str, seed: int) -> Scene:
    """Three discs in a box, for 2**k instants.

    >>> long_run(8, "gas", 1).events
    256
    """
    return catalogue.build("gas", n=3, seed=seed).with_changes(events=2**k)


def crowd(k: int, side: str, seed: int) -> Scene:
    """2**k discs that cover a tenth of their box, for five instants a disc.

    >>> scene = crowd(5, "even", 1)
    >>> len(scene.circles), scene.events
    (32, 160)
    """
    n = 2**k
    return catalogue.build("gas", n=n, seed=seed, mixed="no" if side == "even" else "yes").with_changes(events=5 * n)


ALL = (
    StressFamily(
        name="near-ties",
        summary="Two balls meet a third between them, one 10**-k after the other.",
        grows="10**-k is the distance by which the later one is late",
        make=near_tie, first=1, last=40, most=300, sides=("left", "right"), known=near_tie_known,
    ),
    StressFamily(
        name="grazes",
        summary="A ball passes another, which rests, at the distance of their radii plus or minus 10**-k.",
        grows="10**-k is what it misses by, or overlaps by",
        make=graze, first=1, last=40, most=300, sides=("hit", "miss"), known=graze_known,
    ),
    StressFamily(
        name="ends",
        summary="A ball passes the end of a segment at the distance of its radius plus or minus 2**-k.",
        grows="2**-k is what it misses by, or overlaps by",
        make=end, first=1, last=60, most=1000, sides=("hit", "miss"), known=end_known,
    ),
    StressFamily(
        name="slow-fast",
        summary="A ball at speed 1 passes one at speed 10**-k, which drifts into its path or out of it.",
        grows="10**k is the ratio of speeds",
        make=drift, first=1, last=40, most=300, sides=("in", "out"), known=drift_known,
    ),
    StressFamily(
        name="mass-ratios",
        summary="Two heavy balls would meet a third at one instant, had a ball 10**k times lighter not pushed one of "
        "them.",
        grows="10**k is the ratio of masses",
        make=kick, first=0, last=36, most=300, sides=("left", "right"),
    ),
    StressFamily(
        name="pi",
        summary="A ball 10**k times as heavy pushes a small one to a wall, and all collisions are counted.",
        grows="10**k is the ratio of masses; there are about pi * 10**(k/2) collisions",
        make=galperin, first=0, last=5, most=8, sides=("wall",), known=galperin_known,
    ),
    StressFamily(
        name="scaled",
        summary="Four discs in a box for 8 instants, every length and speed multiplied by 10**k, or divided by it.",
        grows="10**k is the scale",
        make=scaled, first=0, last=20, most=300, sides=("up", "down"), seeds=(1, 2),
    ),
    StressFamily(
        name="moved",
        summary="Four discs in a box for 8 instants, the box 10**k away from the origin, in x or in both x and y.",
        grows="10**k is the distance",
        make=moved, first=0, last=40, most=300, sides=("along", "aslant"), seeds=(1,),
    ),
    StressFamily(
        name="walls",
        summary="A ball flies from wall to wall 20 times, and then past an obstacle; one wall is tilted by 10**-k.",
        grows="10**-k is the slope between the walls",
        make=wedge, first=4, last=40, most=300, sides=("opening", "closing"),
    ),
    StressFamily(
        name="corners",
        summary="A ball runs into a corner of 72 degrees, 10**-k beside the bisector, and so meets one wall first.",
        grows="10**-k is the distance from the bisector",
        make=corner, first=1, last=40, most=300, sides=("upper", "lower"), known=corner_known,
    ),
    StressFamily(
        name="unstable",
        summary="A ball bounces between two fixed discs, 10**-k beside the line through their centres, until it "
        "leaves.",
        grows="10**-k is the distance from the orbit; each bounce multiplies it by about ten",
        make=orbit, first=1, last=40, most=300, sides=("left", "right"),
    ),
    StressFamily(
        name="touching",
        summary="A ball strikes a row of k + 1 touching balls, or a triangle of k + 1 rows of them.",
        grows="k + 1 is the number of balls in the row, or of rows",
        make=touching, first=1, last=6, most=20, sides=("row", "triangle"),
    ),
    StressFamily(
        name="gaps",
        summary="A ball strikes a triangle of three rows whose balls are 10**-k apart, a little beside its axis.",
        grows="10**-k is the gap between neighbours",
        make=gap, first=1, last=40, most=300, sides=("above", "below"),
    ),
    StressFamily(
        name="long-runs",
        summary="Three discs in a box, for 2**k instants.",
        grows="2**k is the number of instants",
        make=long_run, first=0, last=9, most=14, sides=("gas",), seeds=(1, 2, 3),
    ),
    StressFamily(
        name="crowds",
        summary="2**k discs in a box, of one radius or of five, for five instants a disc.",
        grows="2**k is the number of discs",
        make=crowd, first=0, last=6, most=10, sides=("even", "mixed"), seeds=(1,),
    ),
)  # fmt: skip


FAMILIES = {one.name: one for one in ALL}
"""Every family, in the order of the map. A new one is its function, and an entry of `ALL`."""


def stress_family(name: str) -> StressFamily:
    """The family of that name.

    Raises:
        SceneError: if there is none.

    >>> stress_family("near-ties").sides
    ('left', 'right')
    """
    if name not in FAMILIES:
        raise SceneError(f"no stress family {name[:60]!r}; {suggestion(name, list(FAMILIES))}")
    return FAMILIES[name]
