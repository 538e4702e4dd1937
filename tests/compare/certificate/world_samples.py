"""Certificates of runs with restitution, gravity, walls that move, and arcs; and ways to alter those."""

from __future__ import annotations

from functools import cache
from random import Random
from typing import Any

from arc_scenes import scene_of as arc_scene

from certificate.test_tampering import Told, other_digit
from truebreak.compare.certificate import certificate_of
from truebreak.exact import ExactEngine
from truebreak.scenarios import Arc, Circle, Pocket, Quantity, Scene, SceneError, Segment, Wall, catalogue
from truebreak.scenarios.trajectory import Trajectory

SEEDS = range(24)
EVENTS = 8

CATALOGUE = (
    "bounce", "wedge", "drop-pair", "falling-line", "gas-under-gravity:n=4", "cradle:e=9/10", "cradle:n=3,e=1/2",
    "cooling:n=6",
)  # fmt: skip
FLOOR = Wall(0, 0, 1, 0, id="floor")
BOX = [FLOOR, Wall(-5, 0, -5, 1, id="left"), Wall(5, 0, 5, 1, id="right"), Wall(0, 9, 1, 9, id="top")]
DOWN = (0, "-1/2")


def by_hand() -> dict[str, tuple[Scene, dict[str, Any]]]:
    """Scenes, and until when: ties, grazes, slides, what stays, there and back, walls that come and go."""
    pair = [Circle(-3, 2, vx="1/3"), Circle(-3, 5, vx="1/3", m=2)]
    twins = [Circle(x, 3, vx=x, id=f"c{x}") for x in (-2, 2)]
    lifts = [Wall(0, 0, 1, 0, id="floor", vy="1/10"), Wall(0, 9, 1, 9, id="top", vy="-1/7")]
    return {
        "there and back": (Scene(pair, BOX, gravity=DOWN, reverse_after=4), {}),
        "there and back at a time": (Scene(pair, BOX, gravity=("1/5", -1), reverse_at=5), {}),
        "twins": (Scene(twins, BOX, gravity=DOWN), {"events": EVENTS}),
        "twins, one by one": (Scene(twins, BOX, gravity=DOWN, tie_policy="sequential:seed=3"), {"events": EVENTS}),
        "a graze of the ceiling": (Scene([Circle(0, 6, vx=1, vy=2)], BOX, gravity=(0, -1)), {"events": 4}),
        "up to a horizon": (Scene(pair, BOX, gravity=DOWN), {"until": 7}),
        "a horizon at a hit": (Scene([Circle(0, 3)], BOX, gravity=(0, -1)), {"until": 2}),
        "pulled aside": (Scene(pair, BOX, gravity=("-1/3", 0), restitution="3/4"), {"events": EVENTS}),
        "along a wall": (Scene([Circle(-4, 5, vy=1), Circle(2, 3)], BOX, gravity=(0, -1)), {"events": EVENTS}),
        "what stays on": (Scene([Circle(0, 5, vx=1, vy=-1), Circle(3, 5, vx=-1)], BOX, restitution=0), {"events": 5}),
        "what stays on is struck": (
            Scene([Circle(0, 5, vy=-1), Circle(0, 8, vy=-1), Circle(-4, "3/2", vx=1)], BOX, restitution=0),
            {"events": 5},
        ),
        "two on one": (
            Scene([Circle(-3, 0, vx=1), Circle(0, 0), Circle(3, 0, vx=-1)], restitution="1/2"), {"events": 3},
        ),
        "a lift": (Scene(pair, [*lifts, *BOX[1:3]]), {"events": EVENTS}),
        "a lift under gravity": (
            Scene(pair, [*lifts, *BOX[1:3]], gravity=DOWN, restitution="9/10"), {"events": EVENTS},
        ),
        "away with it": (Scene([Circle(0, 1, vx="1/9", vy="1/10"), Circle(4, 3, vx=-1)], lifts), {"events": 4}),
        "a wall that is caught": (Scene([Circle(3, 5, vx=-2)], [Wall(-5, 0, -4, 1, id="w", vx=-1)]), {}),
        "roots": (Scene([Circle(0, 5, vx=1)], BOX, gravity=("sqrt(2)/4", -1), restitution="sqrt(3)/2"), {"events": 5}),
        "to rest": (Scene([Circle(0, 5)], BOX, gravity=(0, -1), restitution=0), {}),
        "to rest at a horizon": (Scene([Circle(0, 3)], BOX, gravity=(0, -1), restitution=0), {"until": 2}),
        "never again": (Scene([Circle(0, 5)], [FLOOR], gravity=(0, 1)), {}),
    }  # fmt: skip


def scene_of(seed: int, moves: bool) -> Scene | None:
    """Discs among walls, some of them oblique, under gravity; or walls that may move, with gravity or without. None
    where what it draws is refused."""
    rng = Random(f"world {seed}")

    def speed() -> str:
        return rng.choice(("0", f"{rng.randint(-60, 60)}/31", f"{rng.randint(-9, 9)}/4"))

    def way() -> dict[str, str]:
        return {"vx": rng.choice(("0", "1/30", "-1/9")), "vy": rng.choice(("0", "0", "1/20", "-1/7"))} if moves else {}

    radii = [rng.choice(("1", "1/2", "0")) for _ in range(rng.randint(1, 4))]
    discs = [
        Circle(f"{3 * k - 4} + {rng.randint(0, 50)}/97", rng.randint(-3, 3), r=r, point=r == "0", vx=speed(),
               vy=speed(), m=rng.choice(("1", "2", "1/3")), id=f"c{k}")
        for k, r in enumerate(radii)
    ]  # fmt: skip
    floor = Wall(*rng.choice(((0, -6, 1, -6), (-9, -8, 9, -7), (-4, -9, -1, -5))), id="floor", **way())
    box = [
        floor, Wall(0, 6, 1, 6, id="top", **way()), Wall(-9, 0, -9, 1, id="left", **way()),
        Wall(10, 0, rng.choice((10, 11)), 9, id="right", **way()),
    ]  # fmt: skip
    pulls = ((0, -10), (0, -1), ("1/3", "-1/2"), (3, 0), ("-sqrt(2)", "1/7"), (0, "1/100"))
    try:
        return Scene(
            discs,
            rng.choice((box, box, [floor], box[2:])),
            gravity=None if moves and rng.random() < 0.5 else rng.choice(pulls),
            restitution=rng.choice(("1", "1", "9/10", "1/2", "sqrt(2)/2", "0")),
            tie_policy=rng.choice(("simultaneous", "sequential:seed=2")),
        )
    except SceneError:
        return None


@cache
def world_runs() -> dict[str, Trajectory]:
    """Runs of all of these, and of random scenes."""
    cases: dict[str, tuple[Scene, dict[str, Any]]] = by_hand()
    cases |= {spec: (catalogue.build(spec), {"events": EVENTS}) for spec in CATALOGUE}
    for seed in SEEDS:
        for name, moves in ((f"falling {seed}", False), (f"moving {seed}", True)):
            if (scene := scene_of(seed, moves)) is not None:
                cases[name] = scene, {"until": 12, "events": EVENTS}
    return {name: ExactEngine().run(scene, **limits) for name, (scene, limits) in cases.items()}


@cache
def world_samples() -> dict[str, Told]:
    """The certificates of these."""
    return {name: certificate_of(run) for name, run in world_runs().items()}


ARC_SEEDS = range(60)
TABLES = ("stadium", "mushroom", "lemon", "round-table")


def mirrored() -> list[Circle]:
    """Two pairs of discs, each mirrored at the y axis: what they meet, they meet at once, however deep their roots."""
    rows = [("2", "1/3", "3/5", "1/7"), ("3", "-7/2", "-2/5", "-1/3")]
    return [
        Circle(sign * Quantity.of(x), y, vx=sign * Quantity.of(vx), vy=vy) for x, y, vx, vy in rows for sign in (-1, 1)
    ]


def bows_apart() -> list[Arc]:
    """Two bows that bulge towards each other, mirrored at the y axis."""
    return [Arc(9, 0, 4, 9, 4, 9, -4, id="right"), Arc(-9, 0, 4, -9, -4, -9, 4, id="left")]


def arcs_by_hand() -> dict[str, tuple[Scene, dict[str, Any]]]:
    """Scenes with arcs, and until when: there and back, joints, ends, points, pockets, what rests, what is struck."""
    ring, bow = Arc(0, 0, 5, full=True, id="ring"), Arc(0, 0, 5, 1, 0, -1, 0, id="bow")
    cup = Arc(0, 0, 5, -3, -4, 3, -4, id="cup")
    long_one = Arc(0, 0, 5, 0, -1, -1, 0, id="long")  # three quarters
    low = Segment(-9, 0, -5, 0, id="low")
    point = Circle(1, 2, r=0, point=True, vx="3/7", vy=1)
    return {
        "a ring there and back": (Scene([Circle(1, 0, vx="1/3", vy=1)], arcs=[ring], reverse_after=5), {}),
        "two in a ring there and back": (
            Scene([Circle(2, 0, vx="1/3", vy=1), Circle(-2, 0, m=2)], arcs=[ring], reverse_at=20), {},
        ),
        "a point in a ring": (Scene([point], arcs=[ring]), {"events": EVENTS}),
        "a point out of a bow": (Scene([point], arcs=[bow]), {"events": EVENTS}),
        "a point onto a bow": (Scene([Circle(1, 20, r=0, point=True, vy=-1)], arcs=[bow]), {}),
        "within three quarters": (Scene([Circle(0, 1, vx=1, vy="1/5")], arcs=[long_one]), {"events": EVENTS}),
        "onto an end": (Scene([Circle(5, -9, vy=1)], arcs=[bow]), {}),
        "beside an end": (Scene([Circle("21/4", -9, vy=1)], arcs=[bow]), {}),
        "a graze": (Scene([Circle(-20, 6, vx=1)], arcs=[ring]), {}),
        "along a joint": (Scene([Circle(-8, 1, vx=1)], segments=[low], arcs=[bow]), {}),
        "past it, inward": (Scene([Circle(0, -9, vx="1/9", vy=1)], arcs=[bow]), {"events": 3}),
        "mirrored in a ring": (Scene(mirrored(), arcs=[Arc(0, 0, 7, full=True, id="ring")]), {"events": 30}),
        "mirrored between bows": (
            Scene(mirrored()[:2], [Wall(0, -9, 1, -9), Wall(0, 9, 1, 9)], arcs=bows_apart()), {"events": 20},
        ),
        "at rest in a cup": (Scene([Circle(0, -4), Circle(0, 3, vy=-1)], arcs=[cup]), {"events": 4}),
        "at rest on a ring": (Scene([Circle(0, 6), Circle(9, 6, vx=-1)], arcs=[ring]), {"events": 3}),
        "a pocket in a ring": (
            Scene(
                [Circle(2, 0, vx=-1, vy="1/9"), Circle(-2, 0, vy=1)],
                pockets=[Pocket(0, 3, 1)],
                capture=True,
                arcs=[ring],
            ),
            {"events": EVENTS},
        ),
        "less each time": (Scene([Circle(1, 0, vx="1/3", vy=1)], arcs=[ring], restitution="1/2"), {"events": EVENTS}),
        "a horizon at a hit": (Scene([Circle(0, 0, vx=1)], arcs=[ring]), {"until": 4}),
        "a horizon at the second hit": (Scene([Circle(0, 0, vx=1)], arcs=[ring]), {"until": 12}),
        "one by one": (
            Scene([Circle(2, 0, vx=1), Circle(-2, 0, vx=-1)], arcs=[ring], tie_policy="sequential:seed=4"),
            {"events": 6},
        ),
        "no room within": (Scene([Circle(9, 1, r=6, vx=-1)], arcs=[Arc(0, 0, 2, 0, 1, 0, -1, id="small")]), {}),
        "out of three": (Scene([Circle(0, -1, vy=-1)], arcs=[Arc(0, 0, 5, 4, -3, -4, -3, id="jar")]), {"events": 3}),
    }  # fmt: skip


def two_at_once(told: Told, draw: Random) -> None:
    """A contact of one instant is said to come at another too."""
    listed = [entry for entry in told["instants"] if entry.get("met")]
    if len(listed) > 1:
        one, other = draw.sample(listed, 2)
        pair, pushes = [*draw.choice(other["met"])], draw.random() < 0.5
        if "segments" in told["scene"] and listed.index(other) < listed.index(one):
            return  # a circle may slide along a face from the one to the other
        one["met"].append(pair)
        if pushes:
            one.setdefault("rounds", []).append([[*pair]])


@cache
def arc_runs() -> dict[str, Trajectory]:
    """Runs among arcs: of these, of tables of the catalogue, and of random scenes."""
    cases = {**arcs_by_hand(), **{spec: (catalogue.build(spec), {"events": EVENTS}) for spec in TABLES}}
    for seed in ARC_SEEDS:
        if (scene := arc_scene(seed)) is not None:
            turns = scene.reverse_at is not None or scene.reverse_after is not None
            cases[f"arcs {seed}"] = scene, {} if turns else {"until": 20, "events": 5}
    return {name: ExactEngine().run(scene, **limits) for name, (scene, limits) in cases.items()}


@cache
def arc_samples() -> dict[str, Told]:
    """The certificates of these."""
    return {name: certificate_of(run) for name, run in arc_runs().items()}


def another_radius(told: Told, draw: Random) -> None:
    """An arc has another radius, or a circle has."""
    row = draw.choice(told["scene"][draw.choice(["arcs", "circles"])])
    row["r"] = draw.choice(["1", "0", row["r"] + "+1/1" + "0" * 40, row["r"] + "-1/8"])


def moved_bow(told: Told, draw: Random) -> None:
    """An arc is somewhere else, with its ends."""
    row, by = draw.choice(told["scene"]["arcs"]), draw.choice(["+1", "-1", "+1/8", "-1/1000", "+1/1" + "0" * 30])
    for key in draw.choice([("x", "x0", "x1"), ("y", "y0", "y1"), ("x",), ("x0",)]):
        if key in row:
            row[key] += by


def turned_bow(told: Told, draw: Random) -> None:
    """An arc is the rest of its circle, all of it, or the half beyond its first end."""
    row = draw.choice(told["scene"]["arcs"])
    if "x0" not in row:
        row.update(x0=f"{row['x']}+{row['r']}", y0=row["y"], x1=row["x"], y1=f"{row['y']}+{row['r']}")
    elif draw.random() < 0.7:
        row.update(x0=row["x1"], y0=row["y1"], x1=row["x0"], y1=row["y0"])
    else:
        for key in ("x0", "y0", "x1", "y1"):
            del row[key]


def no_bow(told: Told, draw: Random) -> None:
    """An arc is not there."""
    told["scene"]["arcs"].pop(draw.randrange(len(told["scene"]["arcs"])))


def other_side(told: Told, draw: Random) -> None:
    """A contact with an arc is one with its other side, with another arc, or with an end."""
    n = len(told["scene"]["circles"])
    pairs = [
        row
        for part in (*told["instants"], told["end"])
        for row in (*part.get("met", ()), *(push for one in part.get("rounds", ()) for push in one))
        if row[1] >= n
    ]
    if pairs:
        row = draw.choice(pairs)
        old, new = row[1], draw.choice([row[1] + 1, row[1] - 1, n + draw.randrange(9)])
        for other in pairs if draw.random() < 0.7 else [row]:
            if other[:2] == [row[0], old]:
                other[1] = new


ARC_WAYS = (another_radius, moved_bow, turned_bow, no_bow, other_side, two_at_once)


def another_loss(told: Told, draw: Random) -> None:
    """The restitution is another."""
    told["scene"]["restitution"] = draw.choice(["1", "0", "1/2", "3/2", "-1/2", "1-1/1" + "0" * 40, "99/100"])


def another_pull(told: Told, draw: Random) -> None:
    """Gravity is another, is not there, or is the other way."""
    pull = told["scene"].get("gravity", ["0", "0"])
    k = draw.randrange(2)
    changed = [*pull]
    changed[k] = draw.choice([f"-1*{pull[k]}" if pull[k][0].isdigit() and "r" not in pull[k] else "0", "1/3", "-1"])
    if changed[k].startswith("-1*"):
        changed[k] = "-" + pull[k]
    told["scene"]["gravity"] = changed
    if draw.random() < 0.2:
        del told["scene"]["gravity"]


def another_way(told: Told, draw: Random) -> None:
    """A wall's velocity is another."""
    if walls := told["scene"].get("walls"):
        row = draw.choice(walls)
        key = draw.choice(["vx", "vy"])
        row[key] = draw.choice(["0", "1/10", "-1", row.get(key, "0") + "+1/1" + "0" * 30])


def digit_of_the_world(told: Told, draw: Random) -> None:
    """A digit of gravity, of the restitution or of a wall's velocity is another."""
    scene = told["scene"]
    places: list[tuple[Any, Any]] = [(scene["gravity"], k) for k in range(2) if "gravity" in scene]
    places += [(scene, "restitution")] if "restitution" in scene else []
    places += [(row, key) for row in scene.get("walls", ()) for key in ("vx", "vy") if key in row]
    if places:
        where, key = draw.choice(places)
        where[key] = other_digit(where[key], draw)


WORLD_WAYS = (another_loss, another_pull, another_way, digit_of_the_world, two_at_once)
