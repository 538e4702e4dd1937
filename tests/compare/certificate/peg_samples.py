"""Certificates of runs with what stands under gravity, fixed circles, segments, polygons, arcs and rims; and ways to
alter those."""

from __future__ import annotations

from functools import cache
from math import hypot
from random import Random
from typing import Any

from certificate.test_tampering import Told, exact_text, other_digit
from certificate.world_samples import ARC_WAYS, WORLD_WAYS
from truebreak.compare.certificate import certificate_of
from truebreak.exact import ExactEngine
from truebreak.scenarios import Arc, Circle, Pocket, Polygon, Quantity, Scene, SceneError, Segment, Wall
from truebreak.scenarios.trajectory import Trajectory

SEEDS = range(40)
EVENTS = 8

FLOOR = Wall(0, -9, 1, -9, id="floor")
BOX = [FLOOR, Wall(-20, 0, -20, 1, id="left"), Wall(20, 0, 20, 1, id="right")]
BAR = Segment(-3, 0, 3, 0, id="bar")
TABLE = Polygon([(-4, -1), (4, -1), (4, 0), (-4, 0)], "table")
DART = Polygon([(-4, -1), (4, -1), (0, 1), (0, 3)], "dart")
DOWN = (0, -10)


def peg(x: int | str, y: int | str, name: str = "p", r: int | str = "1/2") -> Circle:
    """A fixed circle."""
    return Circle(x, y, r, m="oo", id=name)


def by_hand() -> dict[str, tuple[Scene, dict[str, Any]]]:
    """Scenes, and until when: along an axis, mirrored, at once on two, past and off, ends, corners, slides, grazes."""
    far = {"events": EVENTS}
    pair = [Circle(-2, 10, "1/2", vx="1/9", id="a"), Circle(2, 10, "1/2", vx="-1/9", id="b")]
    mirrored = [*pair, peg("-3/2", 0), peg("3/2", 0, "q"), peg(0, -3, "s")]
    ball = Circle("1/3", 8, vx=1, id="a")
    between = [Circle(0, 8, id="a"), peg(-1, 0), peg(1, 0, "q")]
    steep = Segment(5, 0, 7, 4, id="steep", r="1/5")
    high = [*BOX, Wall(0, 20, 1, 20, id="top")]
    return {
        "past a peg for ever": (Scene([Circle(0, 10, vx=1), peg("3", 0)], gravity=DOWN), {}),
        "off a peg for ever": (Scene([Circle("1/7", 10), peg(0, 0)], gravity=DOWN), {}),
        "on the axis of a peg": (Scene([Circle(0, 10), peg(0, 0)], restitution="3/4", gravity=DOWN), {"events": 4}),
        "mirrored": (Scene(mirrored, BOX[:1], gravity=DOWN), far),
        "mirrored, one by one": (Scene(mirrored, BOX[:1], gravity=DOWN, tie_policy="sequential:seed=3"), far),
        "on two at once": (Scene(between, BOX, gravity=DOWN), {"events": 4}),
        "on two, one by one": (Scene(between, BOX, gravity=DOWN, tie_policy="sequential"), {"events": 4}),
        "at a peg from the start": (Scene([Circle(0, "3/2", vx=1, vy=2), peg(0, 0)], BOX, gravity=DOWN), {"events": 4}),
        "up to a horizon": (Scene([ball, peg(0, 0)], BOX, gravity=DOWN), {"until": 5}),
        "to rest on a peg": (Scene([ball, peg(0, 0)], BOX, gravity=DOWN, restitution=0), {"events": 4}),
        "a lift and a peg": (
            Scene([ball, peg(0, 0)], [Wall(0, -9, 1, -9, id="lift", vy="1/10"), *BOX[1:]], gravity=DOWN), {"events": 6},
        ),
        "up beside a bar, and onto it": (
            Scene([Circle(-4, -2, "1/2", vx=2, vy=8)], segments=[BAR], gravity=(0, -8)), {"events": 3},
        ),
        "a bar from below": (Scene([Circle(0, -2, "1/2", vy=8)], BOX[:1], segments=[BAR], gravity=(0, -8)), far),
        "a bar and its ends": (
            Scene([Circle(-2, 6, vx="1/4")], BOX[:1], segments=[BAR], gravity=DOWN, restitution="9/10"), far,
        ),
        "a corner at a foot of zero": (Scene([Circle(3, 3)], BOX[:1], segments=[BAR], gravity=DOWN), {"events": 2}),
        "pulled along a face": (
            Scene([Circle(0, 1, "1/2", vx=1)], BOX[:1], segments=[Segment(2, -1, 2, 2, id="u")], gravity=(0, "-1/4")),
            {"events": 3},
        ),
        "a graze of a bar from below": (Scene([Circle(0, -6, vy=10)], BOX[:1], segments=[BAR], gravity=DOWN), far),
        "a point": (Scene([Circle("1/9", 6, 0, point=True)], BOX[:1], segments=[BAR], gravity=DOWN), {"events": 4}),
        "a table": (Scene([Circle(-2, 6, vx="1/4"), ball], BOX, polygons=[TABLE], gravity=DOWN), far),
        "a dart": (Scene([Circle(-1, 6, vx="1/4"), ball], BOX, polygons=[DART], gravity=DOWN), far),
        "pulled aside": (
            Scene([ball, peg(0, 0)], high, segments=[steep], gravity=("1/3", "-sqrt(2)")), far,
        ),
    }  # fmt: skip


def scene_of(seed: int) -> Scene | None:
    """Discs and points among pegs, segments and polygons, between walls; None where what it draws is refused."""
    rng = Random(f"pegs {seed}")

    def some(low: int, high: int) -> str:
        return f"{rng.randint(low * 50, high * 50)}/50"

    def radius() -> str:
        return rng.choice(["1/2", "1/4", "3/10", "sqrt(2)/4"])

    discs = [
        Circle(some(-4, 4), some(4, 9), radius(), some(-4, 4), some(-4, 4), m=rng.choice([1, 2, "1/3"]), id=f"c{k}")
        for k in range(rng.randint(1, 2))
    ]
    discs += [peg(some(-5, 5), some(-4, 4), f"p{k}", radius()) for k in range(rng.randint(0, 6))]
    rng.shuffle(discs)
    try:
        bars = [
            Segment(some(-5, 5), some(-4, 4), some(-5, 5), some(-4, 4), r=rng.choice(["0", "1/5"]), id=f"s{k}")
            for k in range(rng.randint(0, 2))
        ]
        return Scene(
            discs,
            [Wall(0, -6, 1, -6, id="floor"), Wall(-6, 0, -6, 1, id="left"), Wall(6, 0, 6, 1, id="right")],
            segments=bars,
            gravity=rng.choice([(0, -10), ("1/3", -4), ("sqrt(2)", -3)]),
            restitution=rng.choice(["1", "9/10", "1/2"]),
        )
    except SceneError:
        return None


@cache
def peg_runs() -> dict[str, Trajectory]:
    """Runs of all of these."""
    cases = by_hand()
    cases |= {f"pegs {k}": (scene, {"events": EVENTS}) for k in SEEDS if (scene := scene_of(k)) is not None}
    return {name: ExactEngine().run(scene, **limits) for name, (scene, limits) in cases.items()}


@cache
def peg_samples() -> dict[str, Told]:
    """The certificates of these."""
    return {name: certificate_of(run) for name, run in peg_runs().items()}


CUP = Arc(0, 0, 5, -4, -3, 4, -3, id="cup")
CAP = Arc(0, 0, 5, 4, 3, -4, 3, id="cap")
RING = Arc(0, 0, 5, id="ring", full=True)
HOLE = Pocket(0, -3, 1, id="hole")


def bows_by_hand() -> dict[str, tuple[Scene, dict[str, Any]]]:
    """Scenes with arcs and rims, and until when: within and without, past ends, mirrored, grazes, points, for ever."""
    far = {"events": EVENTS}
    ball, point = Circle("1/3", 3, "1/2", id="a"), Circle("1/3", 8, 0, point=True, id="a")
    pair = [Circle(-2, 1, "1/2", vx="1/9", id="a"), Circle(2, 1, "1/2", vx="-1/9", id="b")]
    jar, cup = Arc(0, 0, 5, 4, -3, -4, -3, id="jar"), Arc(0, 0, 5, -3, 4, 3, 4, id="cup")
    thrown, up = Circle(3, 1, "1/4", vx="21/5", vy=9, id="a"), Circle(0, 0, "1/4", vy=10, id="a")
    hole = Pocket(0, 3, 1, id="hole")
    return {
        "into a cup": (Scene([ball], BOX, arcs=[CUP], gravity=DOWN), far),
        "into a cup, with less each time": (Scene([ball], BOX, arcs=[CUP], gravity=DOWN, restitution="4/5"), far),
        "onto a cap": (Scene([Circle("1/3", 8, "1/2", id="a")], BOX, arcs=[CAP], gravity=DOWN), far),
        "up into a cap": (Scene([Circle("1/3", 0, "1/2", vy=12, id="a")], BOX, arcs=[CAP], gravity=DOWN), far),
        "out of a jar": (Scene([Circle("1/3", 3, "1/2", vx=1, id="a")], BOX, arcs=[jar], gravity=DOWN), far),
        "out of a cup and onto its outside": (Scene([thrown], BOX, arcs=[cup], gravity=DOWN), far),
        "a point on a cap": (Scene([point], BOX, arcs=[CAP], gravity=DOWN), far),
        "a point in a ring": (Scene([Circle(1, 0, 0, point=True, vx=1)], arcs=[RING], gravity=DOWN), far),
        "two in a ring": (Scene([Circle("1/3", 1, "1/2"), Circle("-2/3", -1, "1/2")], arcs=[RING], gravity=DOWN), far),
        "mirrored in a ring": (Scene(pair, arcs=[RING], gravity=DOWN), far),
        "on the axis of a ring": (Scene([Circle(0, 2)], arcs=[RING], gravity=DOWN), {"events": 4}),
        "past a ring for ever": (Scene([Circle(0, 9, vx=9)], arcs=[RING], gravity=DOWN), {}),
        "off a ring for ever": (Scene([Circle("1/7", 9)], arcs=[RING], gravity=DOWN), {}),
        "to rest in a cup": (Scene([ball], arcs=[CUP], gravity=DOWN, restitution=0), far),
        "up to a horizon": (Scene([ball], BOX, arcs=[CUP], pockets=[HOLE], gravity=DOWN), {"until": 5}),
        "through a pocket, up and down": (
            Scene([up], BOX, arcs=[RING], pockets=[hole], gravity=DOWN), far,
        ),
        "into a pocket that captures": (
            Scene([ball, *pair[1:]], BOX, arcs=[CUP], pockets=[HOLE], capture=True, gravity=DOWN),
            far,
        ),
        "out of a pocket": (Scene([Circle(0, -3, "1/4", vy=3)], BOX, arcs=[RING], pockets=[HOLE], gravity=DOWN), far),
    }  # fmt: skip


def bow_scene_of(seed: int) -> Scene | None:
    """Discs and points that fall among arcs, pockets, walls, perhaps a segment; None where what it draws is refused."""
    rng = Random(f"bows {seed}")

    def some(low: int, high: int) -> str:
        return f"{rng.randint(low * 50, high * 50)}/50"

    discs = []
    for k in range(rng.randint(1, 2)):
        r = rng.choice(["1/2", "1/4", "3/10", "sqrt(2)/4", "0"])
        place, way = (some(-4, 4), some(-2, 8)), (some(-4, 4), some(-4, 4))
        discs.append(Circle(*place, r, *way, m=rng.choice([1, 2, "1/3"]), id=f"c{k}", point=r == "0"))
    try:
        arcs = []
        for k in range(rng.randint(1, 2)):
            ends = [] if rng.random() < 0.25 else [some(-9, 9) for _ in range(4)]
            radius = rng.choice([1, 2, "3/2", 4, "sqrt(5)"])
            arcs.append(Arc(some(-4, 4), some(-4, 4), radius, *ends, id=f"a{k}", full=not ends))
        holes = [Pocket(some(-5, 5), some(-5, 5), rng.choice(["1/2", 1, 2]), f"p{k}") for k in range(rng.randint(0, 2))]
        bars = [Segment(some(-5, 5), some(-4, 4), some(-5, 5), some(-4, 4), r=rng.choice(["0", "1/5"]), id="s")]
        return Scene(
            discs,
            [Wall(0, -6, 1, -6, id="floor"), Wall(-6, 0, -6, 1, id="left"), Wall(6, 0, 6, 1, id="right")][
                : rng.choice([0, 1, 3])
            ],
            segments=bars[: rng.random() < 0.3],
            arcs=arcs,
            pockets=holes,
            gravity=rng.choice([(0, -10), ("1/3", -4), ("sqrt(2)", -3)]),
            restitution=rng.choice(["1", "9/10", "1/2", "0"]),
            capture=rng.random() < 0.5,
        )
    except SceneError:
        return None


@cache
def bow_runs() -> dict[str, Trajectory]:
    """Runs of all of these."""
    cases = bows_by_hand()
    cases |= {f"bows {k}": (scene, {"events": EVENTS}) for k in SEEDS if (scene := bow_scene_of(k)) is not None}
    return {name: ExactEngine().run(scene, **limits) for name, (scene, limits) in cases.items()}


@cache
def bow_samples() -> dict[str, Told]:
    """The certificates of these."""
    return {name: certificate_of(run) for name, run in bow_runs().items()}


def carried_by_hand() -> dict[str, tuple[Scene, dict[str, Any]]]:
    """Scenes in which segments and polygons move, and until when: faces, ends, slides, joints that part, crushed."""
    far = {"events": EVENTS}
    ball = Circle("1/2", 5, vx="1/9", vy=-1, id="a")

    def bar(x0: int, x1: int, y: int | str, name: str, **way: int | str) -> Segment:
        return Segment(x0, y, x1, y, id=name, **way)

    lift, press = bar(-3, 3, 0, "lift", vx="-1/5", vy="1/2"), bar(-3, 3, 9, "press", vy="-1/3")
    wedge = Polygon([(-2, 0), (2, 0), (0, 2)], "wedge", vx="1/9", vy="1/3")
    stays, parts = bar(-4, 0, 0, "stays"), bar(0, 4, 0, "parts", vx="1/3", vy="-1/2")
    one = Circle("1/10", 9, "1/4", vy=-1, id="a")
    twins = [Circle(x, 5, "1/2", vx=f"{x}/9", vy=-1, id=f"c{x}") for x in (-2, 2)]
    level = bar(-3, 3, 0, "level", vy="1/2")
    away = bar(-3, 3, 0, "away", vx=1, vy=-2)
    doors = [bar(-9, -3, 0, "left", vx="1/4", vy="1/2"), bar(3, 9, 0, "right", vx="-1/4", vy="1/2")]
    point = Circle("1/2", 5, 0, point=True, vx="1/9", vy=-1, id="p")
    slanted = Segment(0, 0, "sqrt(3)", 1, id="slanted", vx="1/7", vy="-1/3")  # in balls nothing along it is zero
    before = Segment("-2*sqrt(3)", -2, 0, 0, id="before", vx="1/7", vy="-1/3")
    under = Circle("1/2 - 2*sqrt(3)", "-2 - sqrt(3)/2", 1, "sqrt(3)/2 + 1/7", "1/2 - 1/3", id="under")
    off = Circle("-1/2", "sqrt(3)/2", 1, "-1/2 + 1/7", "sqrt(3)/2 - 1/3", id="off")
    return {
        "along the line of a face that it falls from": (
            Scene([under], BOX[:1], segments=[slanted], gravity=(0, -1)), {"events": 2},
        ),
        "off a joint": (Scene([off], BOX, segments=[before, slanted]), {"events": 2}),
        "off a joint, under gravity": (Scene([off], BOX, segments=[before, slanted], gravity=(0, -1)), {"events": 2}),
        "onto a lift": (Scene([ball], segments=[lift]), {}),
        "between a lift and a press": (Scene([ball], segments=[lift, press]), far),
        "crushed": (Scene([Circle(0, 4, vy=-1)], segments=[lift, press]), {}),
        "crushed at once": (Scene([Circle(0, 4, vy="1/12")], segments=[lift, press], restitution=0), {}),
        "onto an end": (Scene([Circle(3, 5, vy=-1)], segments=[lift]), {}),
        "past what flees": (Scene([ball], segments=[away]), {}),
        "caught": (Scene([Circle(0, 5)], segments=[level]), {}),
        "a slide along what moves": (
            Scene([Circle(-2, 1, vx=1, vy="1/2"), Circle(1, 9, vy=-1)], segments=[level]), far,
        ),
        "away with it": (Scene([Circle(0, 1, vx="1/9", vy="1/2"), Circle(4, 9, vx=-1, vy=-1)], segments=[level]), far),
        "a joint that parts": (
            Scene([one, Circle("57/10", 9, "1/4", vy=-1, id="b")], segments=[stays, parts]), {"until": 20},
        ),
        "a joint that parts, under gravity": (
            Scene([one, Circle("11/10", 9, "1/4", vy=-1, id="b")], segments=[stays, parts], gravity=(0, -1)), far,
        ),
        "twins at doors": (Scene(twins, segments=doors), far),
        "twins at doors, under gravity": (Scene(twins, segments=doors, gravity=(0, "-1/2")), far),
        "twins on a lift, one by one": (Scene(twins, segments=[level], tie_policy="sequential:seed=3"), far),
        "a point": (Scene([point], segments=[lift, press]), far),
        "onto a wedge": (Scene([ball], BOX, segments=[press], polygons=[wedge]), far),
        "onto a wedge, under gravity": (Scene([ball], BOX, segments=[press], polygons=[wedge], gravity=(0, -1)), far),
        "onto a lift, under gravity": (Scene([ball], segments=[lift], gravity=(0, -1), restitution="9/10"), far),
        "onto an end, under gravity": (Scene([Circle(3, 5, vx="1/9")], segments=[lift], gravity=(0, -1)), far),
        "up to a horizon": (Scene([ball], segments=[lift, press], gravity=(0, -1)), {"until": 6}),
        "crushed under gravity": (Scene([Circle(0, 4)], segments=[lift, press], gravity=(0, -1)), {}),
        "to rest on a lift": (Scene([ball], segments=[level], gravity=(0, -1), restitution=0), {}),
        "from below": (
            Scene([Circle(0, -4, vy=8)], segments=[bar(-3, 3, 0, "roof", vx="1/5", vy="-1/2")], gravity=(0, -8)), far,
        ),
        "through each other": (Scene([ball], segments=[lift, bar(-2, 4, 1, "cross", vy="-1/2")]), far),
    }  # fmt: skip


def carried_scene_of(seed: int) -> Scene | None:
    """Discs and points among segments and polygons of which some move, between walls; half of them under gravity."""
    rng = Random(f"carried {seed}")

    def some(low: int, high: int) -> str:
        return f"{rng.randint(low * 50, high * 50)}/50"

    def way() -> dict[str, str]:
        return {"vx": some(-1, 1), "vy": some(-1, 1)} if rng.random() < 0.8 else {}

    try:
        discs = []
        for k in range(rng.randint(1, 3)):
            r = rng.choice(["1/2", "1/4", "3/10", "sqrt(2)/4", "0"])
            rest = {"m": rng.choice([1, 2, "1/3"]), "id": f"c{k}", "point": r == "0"}
            discs.append(Circle(some(-5, 5), some(3, 8), r, some(-3, 3), some(-4, 2), **rest))
        bars = []
        for k in range(rng.randint(1, 3)):
            x, y, r = some(-5, 5), some(-5, 3), rng.choice(["0", "0", "1/5"])
            if k and rng.random() < 0.4:
                x, y = bars[-1].x1, bars[-1].y1  # they share an end, for as long as they move alike
            bars.append(Segment(x, y, some(-5, 5), some(-5, 3), f"s{k}", r, **way()))
        x, y = rng.randint(-4, 2), rng.randint(-4, 0)
        wedge = Polygon([(x, y), (x + 2, y), (x + 1, y + 2)], "wedge", **way())
        return Scene(
            discs,
            [Wall(0, -7, 1, -7, id="floor"), Wall(-6, 0, -6, 1, id="left"), Wall(6, 0, 6, 1, id="right")][
                : rng.choice([0, 1, 3])
            ],
            segments=bars,
            polygons=[wedge] if rng.random() < 0.3 else [],
            gravity=rng.choice([None, None, (0, -10), ("1/3", -2), ("sqrt(2)", -1), (0, "1/2")]),
            restitution=rng.choice(["1", "1", "9/10", "1/2", "0"]),
            tie_policy=rng.choice(["simultaneous", "sequential:seed=2"]),
        )
    except SceneError:
        return None


@cache
def carried_runs() -> dict[str, Trajectory]:
    """Runs of all of these."""
    cases = carried_by_hand()
    cases |= {f"carried {k}": (scene, {"events": EVENTS}) for k in SEEDS if (scene := carried_scene_of(k)) is not None}
    return {name: ExactEngine().run(scene, **limits) for name, (scene, limits) in cases.items()}


@cache
def carried_samples() -> dict[str, Told]:
    """The certificates of these."""
    return {name: certificate_of(run) for name, run in carried_runs().items()}


def moved_rim(told: Told, draw: Random) -> None:
    """A pocket is somewhere else, or has another size."""
    if rows := told["scene"].get("pockets"):
        draw.choice(rows)[draw.choice("xyr")] += draw.choice(["+1", "+1/8", "-1/1000", "+1/1" + "0" * 30])


def fixed(told: Told) -> list[dict[str, str]]:
    """The circles and the segments of a certificate that stand."""
    return [row for row in told["scene"]["circles"] if row["w"] == "0"] + told["scene"].get("segments", [])


def moved_peg(told: Told, draw: Random) -> None:
    """Something that stands is elsewhere, or larger."""
    if rows := fixed(told):
        row, by = draw.choice(rows), draw.choice(["+1", "-1/8", "+1/1000", "-1/1" + "0" * 30, "+1/1" + "0" * 60])
        before = dict(row)
        for key in draw.choice([("x", "x0", "x1"), ("y", "y0", "y1"), ("r",)]):
            if key in row:
                row[key] += by
        if not lie_apart(told):  # a scene of that is refused, though a certificate may be of it
            row.update(before)


def lie_apart(told: Told) -> bool:
    """Whether no fixed circle overlaps what else is fixed."""
    roots = told["scene"].get("roots", [])

    def numbers(row: dict[str, str], *keys: str) -> list[float]:
        return [float(Quantity.of(exact_text(row[key], roots))) for key in keys]

    pegs = [numbers(row, "x", "y", "x", "y", "r") for row in told["scene"]["circles"] if row["w"] == "0"]
    bars = [numbers(row, "x0", "y0", "x1", "y1", "r") for row in told["scene"].get("segments", ())]
    for k, (x, y, _, _, r) in enumerate(pegs):
        for x0, y0, x1, y1, s in pegs[:k] + bars:
            ux, uy = x1 - x0, y1 - y0
            along = min(1.0, max(0.0, ((x - x0) * ux + (y - y0) * uy) / ((ux * ux + uy * uy) or 1.0)))
            if hypot(x - x0 - along * ux, y - y0 - along * uy) < r + s + 1e-9:
                return False
    return True


def let_fall(told: Told, draw: Random) -> None:
    """A fixed circle falls, or one that falls is fixed."""
    row = draw.choice(told["scene"]["circles"])
    row["w"] = "1" if row["w"] == "0" else "0"
    if draw.random() < 0.5:
        row["vx"] = row["vy"] = "0"


def less_said_of_a_time(told: Told, draw: Random) -> None:
    """A time is said in fewer digits, or with another digit: it is what says which zero is meant."""
    entry = draw.choice(told["instants"][1:])
    if draw.random() < 0.7:
        entry["time"] = entry["time"][: -draw.randint(1, len(entry["time"].partition(".")[2]) + 1)] or "0"
    else:
        entry["time"] = other_digit(entry["time"], draw)


def bounce_left_out(told: Told, draw: Random) -> None:
    """An instant is left out."""
    if len(told["instants"]) > 2:
        del told["instants"][draw.randrange(1, len(told["instants"]))]


def another_thing(told: Told, draw: Random) -> None:
    """What meets or pushes is another thing."""
    entry = draw.choice(told["instants"])
    if rows := [*entry.get("met", ()), *(push for one in entry.get("rounds", ()) for push in one)]:
        old, new = [*draw.choice(rows)], draw.randrange(len(told["scene"]["circles"]) + 12)
        for row in rows:
            if row[:2] == old[:2]:
                row[1] = new


PEG_WAYS = (moved_peg, let_fall, less_said_of_a_time, bounce_left_out, another_thing, *WORLD_WAYS)
BOW_WAYS = (*ARC_WAYS, *PEG_WAYS[2:], moved_rim)
