"""Certificates of scenes in which walls carry what comes to rest: samples, ways to alter them, and forgeries, each of which
one condition alone keeps out (test_conditions.py)."""
# ruff: noqa: E501 (lines of the checkers stand here as they are)

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import isqrt
from random import Random
from typing import Any

from settle_campaign import drawn

from certificate.forgeries_by_condition import entries, negative
from certificate.forging import SAME, Told
from certificate.segment_forgeries import bar
from certificate.test_tampering import other_digit
from certificate.world_forgeries import DOWN, FLOOR, HAIR, HORIZON, QUIET, RING, Number, beside, wall
from truebreak.compare.certificate import certificate_of
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Polygon, Scene, Segment, Wall, catalogue
from truebreak.scenarios.trajectory import Trajectory

EVENTS = 8
SEEDS = [seed for seed in range(60) if seed != 57]
"""In 57 a disc falls along a wall after a peg: that has no certificate."""

# -- Runs: of the catalogue, by hand, and of random scenes.


def by_hand() -> dict[str, tuple[Scene, dict[str, Any]]]:
    """Scenes, and until when: what slides, lies, is struck, leaves, and settles again; shelves, blocks, aslant."""
    floor, side = Wall(0, 0, 1, 0, id="floor"), Wall(-9, 0, -9, 1, id="side")
    law = {"gravity": (0, -10), "settle": True}
    slider, lying = Circle(0, 6, vx=2, id="a"), Circle(20, 1, vx=-1, id="b")
    shelf = Segment(-3, 4, 3, 4, "shelf", "1/8")
    hill = Polygon([(5, 0), (9, 0), (7, 3)], "hill")
    twins = [Circle(x, 4, vx=x, id=f"c{x}") for x in (-2, 2)]
    slope = Wall(0, 0, 4, 3, id="aslant")
    square, flat = ([Wall(0, 0, -x, y, id="left"), Wall(0, 0, x, y, id="right")] for x, y in ((1, 1), (4, 3)))
    notch = [Segment(-4, 3, 0, 0, "left"), Segment(0, 0, 4, 3, "right")]
    half = {"restitution": "1/2", **law}
    return {
        "bounces out": (Scene([Circle(0, 3, vx=1), Circle(9, 1)], [floor, side], **half), {"until": 12}),
        "bounces out on a shelf": (Scene([Circle(1, 9), Circle(-9, 1, vx=1)], [floor], segments=[shelf], **half), {}),
        "bounces out aslant": (
            Scene([Circle(-6, 8, vx=4, vy=3, id="a")], [slope], gravity=("3", "-4"), restitution="1/2", settle=True), {},
        ),
        "twins bounce out": (Scene([Circle(0, 3, id="a"), Circle(5, "5/2", "1/2", id="b")], [floor], **half), {}),
        "in a corner": (Scene([Circle(0, "5/4"), Circle("1/3", 9)], flat, **half), {"events": 3}),
        "bounces out in a corner": (Scene([Circle(0, 6)], square, **half), {"until": 20}),
        "bounces out in a notch": (Scene([Circle(0, 4)], segments=notch, **half), {}),
        "nothing else": (Scene([Circle(0, 6)], [floor], restitution=0, **law), {}),
        "slid into": (Scene([slider, lying], [floor], restitution=0, **law), {"until": 20}),
        "to and fro": (Scene([slider, Circle(20, 1)], [floor, side], **law), {"events": EVENTS}),
        "to rest at once": (Scene([Circle(0, 1, vx=1), Circle(9, 1)], [floor, side], **law), {"events": EVENTS}),
        "on a shelf": (Scene([Circle(1, 9), Circle(-9, 1, vx=1)], [floor], segments=[shelf], restitution=0, **law), {}),
        "struck on a shelf": (
            Scene([Circle(1, "41/8"), Circle(-4, 9, vx=2)], [floor], segments=[shelf], **law), {"events": 5},
        ),
        "struck on a shelf by little": (
            Scene([Circle(1, "41/8"), Circle(-4, 9, vx=2)], [floor], segments=[shelf], restitution="1/9", **law), {"events": 5},
        ),
        "up a hill": (Scene([slider, lying], [floor, side], polygons=[hill], **law), {"events": EVENTS}),
        "a peg in the way": (
            Scene([slider, Circle(9, 1, m="oo"), lying], [floor, side], restitution=0, **law), {"until": 30},
        ),
        "twins": (Scene(twins, [floor, side, Wall(9, 0, 9, 1)], restitution=0, **law), {"until": 30}),
        "one by one": (
            Scene([slider, lying], [floor, side], tie_policy="sequential:seed=3", **law), {"events": EVENTS},
        ),
        "aslant": (
            Scene(
                [Circle(-6, 8, vx=4, vy=3, id="a"), Circle(0, 10, id="b")], [slope],
                gravity=("3", "-4"), restitution=0, settle=True,
            ), {"events": 4},
        ),
        "roots": (
            Scene([Circle(0, "4+sqrt(2)", "sqrt(2)/2", vx=1), Circle(9, "sqrt(2)/2", "sqrt(2)/2")], [floor, side],
                  gravity=(0, "-sqrt(3)"), restitution=0, settle=True), {"until": 30},
        ),
    }  # fmt: skip


@cache
def settled_runs() -> dict[str, Trajectory]:
    """Runs of all of these."""
    cases = by_hand() | {
        spec: (catalogue.build(spec), {"events": EVENTS}) for spec in ("landing", "struck", "struck:n=3")
    }
    for seed in SEEDS:
        if (scene := drawn(seed)) is not None:
            cases[f"settled {seed}"] = scene, {"until": 12, "events": EVENTS}
    return {name: ExactEngine(work=300_000).run(scene, **limits) for name, (scene, limits) in cases.items()}


@cache
def settled_samples() -> dict[str, Told]:
    """The certificates of these."""
    return {name: certificate_of(run) for name, run in settled_runs().items()}


# -- Ways to alter them.


def settles_not(told: Told, _: Random) -> None:
    """Nothing is said to settle; or the scene is one in which nothing does."""
    for entry in told["instants"]:
        entry.pop("settle", None)


def settles_sooner(told: Told, draw: Random) -> None:
    """What settles does so an instant before, or after."""
    places = [k for k, entry in enumerate(told["instants"]) if "settle" in entry]
    if places:
        k = draw.choice(places)
        other = told["instants"][max(0, k + draw.choice((-1, 1))) % len(told["instants"])]
        other["settle"] = told["instants"][k].pop("settle")


def settles_elsewhere(told: Told, draw: Random) -> None:
    """Another one settles, or on something else."""
    n = len(told["scene"]["circles"])
    listed = [pair for entry in told["instants"] for pair in entry.get("settle", ())]
    if listed:
        draw.choice(listed)[draw.randrange(2)] = draw.randrange(n + 2)
    else:
        draw.choice(told["instants"])["settle"] = [[draw.randrange(n), n]]


def settles_at_a_bounce(told: Told, draw: Random) -> None:
    """What bounces is said to settle."""
    pushed = [(entry, pair) for entry in told["instants"] for one in entry.get("rounds", ()) for pair in one]
    if pushed:
        entry, pair = draw.choice(pushed)
        entry["settle"] = [*entry.get("settle", ()), pair[:2]]


def passes_by(told: Told, draw: Random) -> None:
    """An instant is left out, and all that follow."""
    k = draw.randrange(1, len(told["instants"])) if len(told["instants"]) > 1 else 0
    if k:
        del told["instants"][k:]
        told["end"] = draw.choice(({"reason": "quiet"}, {"reason": "horizon", "until": "12"}))


def slides_otherwise(told: Told, draw: Random) -> None:
    """A velocity of the start is another, or one of the end."""
    if draw.random() < 0.5:
        row = draw.choice(told["scene"]["circles"])
        key = draw.choice(("vx", "vy", "x", "y"))
        row[key] = draw.choice((other_digit(row[key], draw), row[key] + "+1/1" + "0" * 30))
    else:
        row = draw.choice(told["final"]["circles"])
        k = draw.randrange(4)
        row[k] = other_digit(row[k], draw)


def does_not_push(told: Told, draw: Random) -> None:
    """One round fewer: what is struck leaves into its wall, or is not struck."""
    several = [entry for entry in told["instants"] if entry.get("rounds")]
    if several:
        rounds = draw.choice(several)["rounds"]
        rounds.pop(draw.randrange(len(rounds)))


def does_not_settle(told: Told, _: Random) -> None:
    """The scene is one in which nothing settles."""
    told["scene"].pop("settle", None)


SETTLE_WAYS = (
    settles_not, settles_sooner, settles_elsewhere, settles_at_a_bounce, passes_by, slides_otherwise, does_not_push, does_not_settle,
)  # fmt: skip

# -- Forgeries.


def lies(*rows: tuple[Number, ...], walls: list[Told] | None = None, end: Told | None = None, **scene: Any) -> Told:
    """Circles over a floor, of which nothing is told."""
    return beside(FLOOR if walls is None else walls, *rows, end=end, **{"gravity": DOWN, "settle": True, **scene})


def nobody_settles() -> Told:
    """A disc lies on the floor, which is not said to carry it."""
    return entries(lies((0, 1, 0, 0), end=QUIET), {"met": [[0, 1]]})


def settles_while_it_bounces() -> Told:
    """A disc that bounces is said to settle."""
    cert = lies((0, 3, 1, 0), restitution="1/2", end=HORIZON)
    return entries(cert, {}, {"met": [[0, 1]], "rounds": [[[0, 1]]], "settle": [[0, 1]]})


def settles_on_the_ceiling() -> Told:
    """A disc is thrown to a ceiling, and is said to settle there."""
    cert = lies((0, 5, 0, 9), walls=[wall(0, 9, 1, 9)], restitution="0", end=HORIZON)
    return entries(cert, {}, {"met": [[0, 1]], "rounds": [[[0, 1]]], "settle": [[0, 1]]})


def settles_on_a_slope(gravity: list[str] | None = None, **scene: Any) -> Told:
    """A disc lies on what is not level."""
    cert = lies(("-3/5", "4/5", 0, 0), walls=[{**wall(0, 0, 4, 3), "length": "5"}], end=QUIET, **scene)
    return entries(cert, {"met": [[0, 1]], "settle": [[0, 1]]})


def hardly_level() -> Told:
    """A disc lies on a floor that is aslant by very little."""
    cert = lies((0, 1, 0, 0), gravity=[HAIR, "-1"], roots=["2"], end=QUIET)
    return entries(cert, {"met": [[0, 1]], "settle": [[0, 1]]})


def hardly_down() -> Told:
    """A disc lies on a floor; that this is how gravity pulls is known, but not which way, as there is little of it."""
    long = f"1*r1+{isqrt(2 * 10**140)}/{10**70}"
    floor = {**wall(0, 0, 1, 0), "x1": long, "length": long}
    cert = lies((0, 1, 0, 0), walls=[floor], gravity=["0", negative(HAIR)], roots=["2"], end=QUIET)
    return entries(cert, {"met": [[0, 1]], "settle": [[0, 1]]})


def slides_on_a_shelf() -> Told:
    """A disc that slides along a shelf is said to settle on it."""
    cert = beside([], (0, 1, 1, 0), gravity=DOWN, settle=True, segments=[bar(-4, 0, 4, 0, 8)], end=QUIET)
    return entries(cert, {"met": [[0, 3]], "settle": [[0, 3]]})


def nowhere_to_settle(**scene: Any) -> Told:
    """A scene in which nothing can settle."""
    turn = [{"exact": "1"}, {"turn": True}] if "reverse_at" in scene else []
    return entries(lies((0, 50, 0, 0), **scene), {}, *turn)


def no_image_of_what_is_carried() -> Told:
    """A disc slides to a slope; another, in the air, falls by less than anybody can tell: its image is said to meet the like."""
    slopes = [{**wall(x, y, x + 3, y + 4), "length": "5", "id": f"s{x}"} for x, y in ((10, 0), (110, 50))]
    cert = lies((0, 1, 1, 0), (100, 51, 1, 0), walls=[*FLOOR, *slopes], gravity=["0", f"-1/{1 << 400}"])
    cert["isometries"] = [{**SAME, "shift": ["-100", "-50"], "map": [[1, 0], [4, 3]]}]
    both = {"met": [[0, 3], [1, 4]], "rounds": [[[0, 3]], [[1, 4]]], "zeros": [["gap", [1, 4], 0]]}
    return entries(cert, {"met": [[0, 2]], "settle": [[0, 2]]}, both)


OUT = {"met": [[0, 2]], "rounds": [[[0, 2]]], "bounces": [[0, 2]]}


def until(time: str) -> Told:
    """The end of a run."""
    return {"reason": "horizon", "until": time}


def bounces_still() -> Told:
    """A disc is said to lie before its bounces have come to their end, at 6."""
    cert = lies((0, 3, 0, 0), (100, 9, 0, 0), restitution="1/2", end=until("5"))
    hit = {"met": [[1, 2]], "rounds": [[[1, 2]]]}
    return entries(cert, {}, OUT, hit)


def lies_too_soon() -> Told:
    """The same, at an instant at which another disc hits the floor."""
    cert = bounces_still()
    cert["instants"][-1]["settle"] = [[0, 2]]
    return cert


def struck_amid_bounces() -> Told:
    """A disc passes over the place where another will lie, which is higher meanwhile."""
    cert = lies((0, 3, 0, 0), (30, "17/10", -10, 2), restitution="1/2", end=until("13/2"))
    return entries(cert, {}, OUT, {"met": [[1, 2]], "rounds": [[[1, 2]]]})


def lies_from_afar() -> Told:
    """A disc in the air is said to bounce on the floor."""
    return entries(lies((0, 9, 0, 0), restitution="1/2", end=HORIZON), {"bounces": [[0, 1]]})


def between(*row: Number, **scene: Any) -> Told:
    """A disc between two slopes."""
    walls = [{**wall(0, 0, -4, 3), "length": "5"}, {**wall(0, 0, 4, 3), "length": "5"}]
    return lies(row, walls=walls, restitution="1/2", end=until("40"), **scene)


BOTH = {"met": [[0, 1], [0, 2]], "bounces": [[0, 1], [0, 2]]}


def bounces_aslant_in_a_corner() -> Told:
    """A disc that comes to two slopes at once, at an angle, is said to bounce up and down there."""
    return entries(between(1, "11/4", -1, -1), {}, {**BOTH, "rounds": [[[0, 1], [0, 2]]]})


def bounces_one_by_one() -> Told:
    """A disc that flies straight up and down between two slopes, which push it one after the other in the end, as well."""
    cert = between(0, "5/4", 0, 1, tie_policy="sequential")
    return entries(cert, {"met": BOTH["met"]}, {**BOTH, "rounds": [[[0, 1]], [[0, 2]]]})


def bounces_on_what_hangs_over() -> Told:
    """A disc that slides up a slope, under a face that hangs over it, is said to bounce on that, before it began, and to lie."""
    over, slope = (Segment(*ends, name) for ends, name in OVERHANG)
    struck = [Circle(11, 13, id="i"), Circle("77/10", "91/10", "1/2", vx=22, vy="53/2", id="k")]
    law = {"gravity": (0, -10), "restitution": "1/5", "settle": True}
    run = ExactEngine().run(Scene(struck, [Wall(0, -5, 1, -5, id="floor")], segments=[over, slope], **law), until=30)
    cert = certificate_of(run)
    cert["scene"]["circles"][0] |= {"vx": "1", "vy": "21/20"}
    first = cert["instants"][0]
    first["bounces"], first["settle"] = first["settle"][:1], first["settle"][1:]
    return cert


OVERHANG = (
    (("99/10", "66/5", "21/2", "14"), "over"),
    (("330/29", "693/58", "350/29", "735/58"), "slope"),
)

Changes = tuple[str, str] | list[tuple[str, str]]
NONE_SETTLE = (
    ("refuse(settle and (not pull or drift or arcs or pockets or turns), ", "refuse(0, "),
    ("malformed('no scene: nothing settles there')", "void 0"),
)
SETTLE_CONDITIONS: dict[str, tuple[Changes, Changes | None, Callable[[], Told]]] = {
    "what settles is told": (
        ('refuse(sorted(begun | self.calm) != sorted(told + bounces), ', "refuse(0, "),
        ("refute('not these circles settle')", "void 0"), nobody_settles,
    ),
    "what bounces does not settle": (
        ("c[1] < self.arcs.start and not known[c])", "c[1] < self.arcs.start)"), ("if (x.sign === 0 && x.c.kind === 'wall') append(flat", "if (x.c.kind === 'wall') append(flat"), settles_while_it_bounces,
    ),
    "nothing settles where it is not pulled to": (
        ("                      and self.bends.get(c, self.slopes.get(c[1])) < 0}", "                      }"), ("return level && pulls * (c.face ? 1 : side[c.i]) < 0;", "return level;"), settles_on_the_ceiling,
    ),
    "nothing settles on a slope": (
        ('if not demand(leans, [-1, 0, 1], f"whether {j} is level"): level.add(j)', "level.add(j)"), ("wall.level = this.settles && (", "wall.level = this.settles || ("), settles_on_a_slope,
    ),
    "whether a wall is level is decided": (
        ('demand(leans, [-1, 0, 1], f"whether {j} is level")', "(leans or 0)"), ("undecided(`whether wall ${wall.id} is level`)", "0"), hardly_level,
    ),
    "which way is down is decided": (
        ('demand(sign_of(self.pull[k]), [-1, 1], "which way is down")', "(sign_of(self.pull[k]) or 1)"), ("undecided('which way is down')", "1"), hardly_down,
    ),
    "what slides along a face does not settle": (
        ('refuse(known and not more and self.sign("slide", by), ', "refuse(0, "), ("refute(`${c.name} slides along a face, which ends`)", "void 0"), slides_on_a_shelf,
    ),
    "a disc lies once its bounces are over": (
        ('if self.calm or met or told: refuse(self.sign("rest", by[0]) == 1, ', "if self.calm or met or told: refuse(0, "), ("refute(`${c.name} bounces still`)", "void 0"), lies_too_soon,
    ),
    "bounces are over at the end": (
        ('refuse(self.sign("rest", self.carried[i][0]) > 0, ', "refuse(0, "), ("refute(`${c.name} bounces still`)", "void 0"), bounces_still,
    ),
    "nothing comes near what bounces": (
        ("refuse(not (own & sides or any(map(beyond, sides))), ", "refuse(0, "), ("const close = () => undecided(", "const close = () => String("), struck_amid_bounces,
    ),
    "what bounces leaves what it bounces on": (
        ("refuse(not left, ", "refuse(0, "), None, lies_from_afar,
    ),
    "what bounces does so on all that hold it": (
        ("refuse(sorted(c for c in begun if c[0] in out) != bounces, ", "refuse(0, "), ("refute('not these contacts bounce')", "void 0"), bounces_on_what_hangs_over,
    ),
    "what bounces on two has come from both": (
        ("len(since) > 1 or ", ""), ("if (!both || !together) refute(", "if (!both) refute("), bounces_aslant_in_a_corner,
    ),
    "what bounces on two is pushed by both at once": (
        (" or pushes.get(i) != [ones]", ""), ("if (!both || !together) refute(", "if (!together) refute("), bounces_one_by_one,
    ),
    "nothing settles where walls move": (*NONE_SETTLE, lambda: nowhere_to_settle(walls=[wall(0, 0, 1, 0, vy=1)])),
    "nothing settles where nothing falls": (*NONE_SETTLE, lambda: nowhere_to_settle(gravity=["0", "0"])),
    "nothing settles where the run turns back": (*NONE_SETTLE, lambda: nowhere_to_settle(reverse_at="1")),
    "nothing settles beside an arc": (*NONE_SETTLE, lambda: nowhere_to_settle(arcs=[RING])),
    "nothing settles beside a pocket": (*NONE_SETTLE, lambda: nowhere_to_settle(pockets=[{"id": "p", "x": "90", "y": "9", "r": "1"}])),
    "an isometry maps what carries": (
        ("            self.rows.setdefault(i, []).append({*bears[i]})\n", ""), ("      append(this.rows, i, by); // an isometry maps that too\n", ""), no_image_of_what_is_carried,
    ),
}  # fmt: skip
"""Each with what each checker has instead of it, as in `test_conditions.CONDITIONS`."""
