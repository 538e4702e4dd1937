"""Forgeries of certificates with restitution, gravity and walls that move, each of which one condition alone keeps out
(test_conditions.py)."""
# ruff: noqa: E501 (lines of the checkers stand here as they are)

from __future__ import annotations

from collections.abc import Callable
from math import isqrt
from typing import Any

from certificate.forgeries_by_condition import STOPPED, bare, entries, negative, small
from certificate.forging import SAME, UPSIDE_DOWN, Told

QUIET = {"reason": "quiet"}
Number = str | int
HAIR = f"1*r1-{isqrt(2 * 10**140)}/{10**70}"
"""More than zero, by less than the bits of these certificates tell; its root is that of 2."""


def wall(x0: Number, y0: Number, x1: Number, y1: Number, **way: Number) -> Told:
    """A wall of a certificate whose points are 1 apart, perhaps with a velocity."""
    row = {"x0": x0, "y0": y0, "x1": x1, "y1": y1, "length": 1, **way}
    return {"id": f"w {x0} {y0} {x1} {y1}", **{key: str(value) for key, value in row.items()}}


def beside(walls: list[Told], *rows: tuple[Number, ...], end: Told | None = None, **scene: Any) -> Told:
    """Circles among walls, of which nothing is told."""
    return {**bare(*rows, scene={"walls": walls, **scene}), "end": end or STOPPED}


FLOOR = [wall(0, 0, 1, 0)]
DOWN = ["0", "-1"]


def bounced(e: str, **scene: Any) -> Told:
    """Two meet, with a restitution."""
    cert = bare((0, 0, 1, 0), (9, 0, 0, 0), scene={"restitution": e, **scene})
    return entries(cert, {}, {"met": [[0, 1]], "rounds": [[[0, 1]]]})


def turned_back(walls: list[Told], **scene: Any) -> Told:
    """A run that cannot be turned back is, before anything has happened."""
    return entries(beside(walls, (0, 50, 0, 0), reverse_at="1", **scene), {}, {"exact": "1"}, {"turn": True})


def from_within_the_floor() -> Told:
    """A disc that starts across the floor leaves it, and is said to come back to it."""
    cert = beside(FLOOR, (0, "1/2", 0, 4), gravity=DOWN)
    return entries(cert, {}, {"met": [[0, 1]], "rounds": [[[0, 1]]]})


def through_the_floor(**end: Any) -> Told:
    """A disc falls through the floor, which is not told."""
    return beside(FLOOR, (0, 5, 0, 0), gravity=DOWN, end={"reason": "horizon", "until": "8", **end})


def never_down() -> Told:
    """A disc thrown up is said to meet nothing ever again."""
    return beside(FLOOR, (0, 5, 0, 3), gravity=DOWN, end=QUIET)


def grazed_twice() -> Told:
    """Two graze; that they meet is said once more, when they are as far apart as at the start."""
    cert = bare((0, 0, 1, 0), (9, 2, 0, 0))
    return entries(cert, {}, {"exact": "9", "met": [[0, 1]]}, {"met": [[0, 1]]})


def hardly_pulled() -> Told:
    """A disc leaves the floor, to which it is pulled by very little, for ever."""
    return beside(FLOOR, (0, 5, 0, 3), gravity=["0", negative(HAIR)], roots=["2"], end=QUIET)


def no_image(motion: Told, walls: list[Told], **scene: Any) -> Told:
    """An isometry that nothing needs is none: of walls that do not stay mapped."""
    return {**beside(walls, (0, 50, 0, 0), **scene), "isometries": [motion]}


def not_back_but_again() -> Told:
    """Two discs leave the floor at once, one a little faster: they are said to come back to it at once, as they left."""
    cert = beside(FLOOR, (0, 1, 0, 1), (9, 1, 0, f"1+{small(170)}"), gravity=DOWN)
    both = {"met": [[0, 2], [1, 2]], "rounds": [[[0, 2]], [[1, 2]]], "zeros": [["gap", [1, 2], "back"]]}
    return entries(cert, {"met": [[0, 2], [1, 2]]}, both)


def held_to_what_moves() -> Told:
    """A floor comes up under a disc at rest, by very little; that the disc is its own mirror image is no sign against it."""
    cert = beside([wall(0, 0, 1, 0, vy=HAIR)], (0, 1, 0, 0), roots=["2"])
    cert["isometries"] = [{**UPSIDE_DOWN, "shift": ["0", "2"], "map": [[0, 0]]}]
    return entries(cert, {"met": [[0, 1]], "zeros": [["closing", [0, 1], 0]]})


def struck_at_a_ceiling() -> Told:
    """Two discs graze a ceiling each, the one as the other; one of them is struck there, and its ceiling is left out."""
    bars = [
        {"id": name, "x0": x0, "y0": y, "x1": x1, "y1": y, "length": "6", "r": "0"}
        for name, x0, x1, y in (("low", "-8", "-2", "1"), ("high", "2", "8", "4"))
    ]
    like = {"matrix": ["1", "0", "0", "1"], "shift": ["10", "3"], "map": [[0, 1], [8, 10]]}
    rows = (-5, "-1/2", 0, 1), (5, "5/2", 0, 1), (-5, "-9/2", 0, 3)
    cert = {**bare(*rows, scene={"segments": bars, "gravity": DOWN}), "isometries": [like], "end": STOPPED}
    zeros = [["closing", [0, 8], 0]]
    return entries(cert, {}, {"exact": "1", "met": [[1, 10], [0, 2]], "rounds": [[[0, 2]]], "zeros": zeros})


ASIDE = ("self.aside(m, c, start) and ", ""), ("again || !this.aside(c, at, closing)", "again")
"""A concave gap that is zero once only, right at an end, from where on there is a range."""

# -- arcs. Numbers: circles, then the ends of arcs, then the outside and the inside of each.

BOW = {"id": "bow", "x": "0", "y": "0", "r": "5", "x0": "5", "y0": "0", "x1": "-5", "y1": "0"}
"""The upper half of a circle."""

RING = {key: BOW[key] for key in ("id", "x", "y", "r")}
HORIZON = {"reason": "horizon", "until": "9"}


def bowed(arcs: list[Told], *rows: tuple[Number, ...], end: Told | None = None, **scene: Any) -> Told:
    """Circles among arcs, of which nothing is told."""
    return {**bare(*rows, scene={"arcs": arcs, **scene}), "end": end or STOPPED}


def beside_an_arc() -> Told:
    """A disc bounces off the circle of an arc, where the arc is not."""
    return entries(bowed([BOW], (20, -3, -1, 0)), {}, {"met": [[0, 3]], "rounds": [[[0, 3]]]})


def hardly_on_an_arc() -> Told:
    """A disc that meets an arc right beside its end, by very little, is said to meet the end."""
    cert = bowed([BOW], (20, HAIR, -1, 0), roots=["2"])
    return entries(cert, {}, {"met": [[0, 1]], "rounds": [[[0, 1]]]})


def in_a_ring_that_hardly_fits() -> Told:
    """A disc in the middle of a ring that is hardly larger flies on for ever."""
    return bowed([RING], (0, 0, 1, 0, f"5-1*r1+{HAIR[5:]}"), roots=["2"], end=QUIET)


def at_rest_on_an_arc() -> Told:
    """A disc that rests on an arc is said to come to it."""
    return entries(bowed([BOW], (0, 6, 0, 0)), {"met": [[0, 3]]}, {"exact": "1", "met": [[0, 3]]})


def a_point_on_an_arc() -> Told:
    """A point starts on an arc, and is said to leave it outward."""
    return entries(bowed([BOW], (0, 5, 0, 1, 0)), {"met": [[0, 3]]})


def across_an_arc() -> Told:
    """A disc starts across an arc, and leaves it."""
    return bowed([BOW], (0, "11/2", 0, 1), end=QUIET)


def hardly_across_an_arc() -> Told:
    """The same, by very little."""
    return bowed([BOW], (0, f"6-1*r1+{HAIR[5:]}", 0, 1), roots=["2"], end=QUIET)


def into_an_arc_from_its_end() -> Told:
    """A disc in a bow touches its end, and flies along it: into the bow."""
    return entries(bowed([BOW], (4, 0, 0, 1), end=HORIZON), {"met": [[0, 1]]})


def with_an_arc(arc: Told, **values: Any) -> Told:
    """A disc at rest far from an arc that is none; or an isometry beside."""
    return {**bowed([{**BOW, **arc}], (90, 90, 0, 0)), **values}


def two_rings(radii: tuple[str, str]) -> Told:
    """Two rings far from a disc at rest, and an isometry that takes the one to the other."""
    rings = [{**RING, "id": f"ring {k}", "x": str(40 * k), "r": r} for k, r in enumerate(radii)]
    cert = bowed(rings, (90, 90, 0, 0))
    cert["isometries"] = [{**SAME, "shift": ["40", "0"], "map": [[1, 3]]}]
    return cert


def short_to_long() -> Told:
    """An arc of less than a half-turn is mapped to the rest of its circle, turned round: their chords are alike."""
    short = {"id": "short", "x": "0", "y": "0", "r": "5", "x0": "4", "y0": "3", "x1": "-4", "y1": "3"}
    long = {**short, "id": "long", "x": "40", "x0": "44", "y0": "-3", "x1": "36", "y1": "-3"}
    cert = bowed([short, long], (90, 90, 0, 0))
    cert["isometries"] = [{**SAME, "shift": ["40", "0"], "map": [[5, 7]]}]
    return cert


Changes = tuple[str, str] | list[tuple[str, str]]
CANNOT_TURN = (
    "refuse(turns and (drift or loss != ONE or stands),",
    "if (turned && (!elastic || drift)) malformed(",
)
WORLD_CONDITIONS: dict[str, tuple[Changes, Changes | None, Callable[[], Told]]] = {
    "no restitution is above 1": (
        ("for x in loss, ONE - loss: demand(", "for x in (): demand("), ("demand((A, w) => A.sub(A.add(A.of(fraction(1n)), A.of(fraction(1n)))", "void ((A, w) => A.sub(A.add(A.of(fraction(1n)), A.of(fraction(1n)))"), lambda: bounced("2"),
    ),
    "no restitution is negative": (
        ("for x in loss, ONE - loss: demand(", "for x in (): demand("), ("demand(this.restitution, [0, 1], 'the restitution is not negative')", "1"), lambda: bounced("-1/2"),
    ),
    "what loses energy is not turned back": (
        (CANNOT_TURN[0], "refuse(0,"), (CANNOT_TURN[1], "if (0) malformed("), lambda: turned_back(FLOOR, restitution="1/2"),
    ),
    "what moves is not turned back": (
        (CANNOT_TURN[0], "refuse(0,"), (CANNOT_TURN[1], "if (0) malformed("), lambda: turned_back([wall(0, 0, 1, 0, vy=1)]),
    ),
    "nothing starts across a wall to which it is pulled": (
        ('if self.falls(c): demand(', "if 0: demand("), ("if (this.known((A, w) => this.laws(c, A, w).gap(), `whether ${c.name} overlap`) <= 0) refute(", "if (0) refute("), from_within_the_floor,
    ),
    "what is pulled to a wall does not pass it": (
        ('demand(gap.sign(), [1], f"{c} meet before it, or overlap")', "return"), ("if (this.known(gap, `whether ${c.name} kept apart`) <= 0) refute(", "if (0) refute("), through_the_floor,
    ),
    "what is pulled to a wall comes to it": (
        ('refuse(age is None, f"{c} meet in the end")', "if age is None: return"), ("if (mode === 'ever') refute(`${c.name} meet in the end`);", "if (mode === 'ever') return;"), never_down,
    ),
    "what is not pulled does not come again": (
        ("return (self.falls(c) or self.hollow(c) or self.drops(c)) and self.parted.get(c)", "return self.parted.get(c)"), None,  # the second one asks first whether it hits
        grazed_twice,
    ),
    "whether gravity pulls to a wall is decided": (
        ('demand(sign, [-1, 0, 1], f"whether gravity pulls to {j}")', "(sign or 0)"), ("undecided(`whether gravity pulls along wall ${wall.id}`)", "0"), hardly_pulled,
    ),
    "an isometry maps walls to such as move alike": (
        ("in ((x, y), stays, falls)", "in ((x, y), falls)"), ("ways = [[p.way, q.way], [", "ways = [["),
        lambda: no_image({**SAME, "shift": ["0", "1"], "map": [[1, 2]]}, [wall(0, 0, 1, 0, vy=1), wall(0, 1, 1, 1)]),
    ),
    "an isometry maps walls to such as are pulled alike": (
        ("in ((x, y), stays, falls)", "in ((x, y), stays)"), (", [scene.gravity, scene.gravity]]", "]"),
        lambda: no_image({**UPSIDE_DOWN, "map": [[1, 1]]}, FLOOR, gravity=DOWN),
    ),
    "nothing comes back before the run is turned": (
        ("back = back and self.way and self.out", "back = back and self.out"), ("if (!run.turnTime) continue;", ""), not_back_but_again,
    ),
    "an arc is met within its range": (
        ("refuse(ranged and not self.within(c), ", "refuse(0, "), ("if (!this.within(c)) refute(", "if (0) refute("), beside_an_arc,
    ),
    "what flies along the inside of an arc at its end goes into it": (
        ASIDE[0], ASIDE[1], into_an_arc_from_its_end,
    ),
    "what comes to gap zero at an instant is listed": (
        ("if not hollow and (last or gap2 == 1) else ()", "if not hollow else ()"),
        [("mode === 'flight' && !(gapNow > 0) ? []", "0 ? []"), ("if (question === 'closing' && first && image && other.sign === 0) return;", "if (question === 'closing' && image && other.sign === 0) return;")],
        struck_at_a_ceiling,
    ),
    "whether an arc is met is decided": (
        ('raise Unsettled(f"whether {c} meet on the way")', "return"), ("    undecided(what);\n  }\n  /** Is the gap of a side", "  }\n  /** Is the gap of a side"), hardly_on_an_arc,
    ),
    "whether there is room within is decided": (
        [('demand(room, [-1, 0, 1], f"whether {c} fit")', "(room or 0)"), ('demand(None if None in gaps or within != 1 else 0, [1], f"{c} overlap at time 0")', "return")],
        [("undecided('whether a circle fits in an arc')", "0"), ("undecided(`whether ${c.name} lie across each other`)", "void 0")], in_a_ring_that_hardly_fits,
    ),
    "what rests on an arc does not come to it": (
        ("refuse(age and not self.met[c]", "refuse(0 and not self.met[c]"), ("sign === 0 && this.signed(law('speed')", "0 && this.signed(law('speed')"), at_rest_on_an_arc,
    ),
    "no point starts on an arc": (
        ("refuse(met and not self.things[c[0]][4], ", "refuse(0, "), ("if (there.length && this.scene.circles[c.i].point) refute(", "if (0) refute("), a_point_on_an_arc,
    ),
    "nothing starts across an arc": (
        ('demand(None if None in gaps or within != 1 else 0, [1], f"{c} overlap at time 0")', "return"), [("if (within > 0 && gaps.every(s => s <= 0)) refute(", "if (0) refute("), ("undecided(`whether ${c.name} lie across each other`)", "void 0")], across_an_arc,
    ),
    "whether something starts across an arc is decided": (
        ('demand(None if None in gaps or within != 1 else 0, [1], f"{c} overlap at time 0")', "return"), ("undecided(`whether ${c.name} lie across each other`)", "void 0"), hardly_across_an_arc,
    ),
    "an arc's ends are on its circle": (
        ('demand(sign_of(p * p + q * q - r * r), [0], "an end is on its arc", Malformed)', "0"), ("demand((A, w) => A.sub(A.add(A.square(p[w]), A.square(q[w])), A.square(r[w]))", "void ((A, w) => A.zero"), lambda: with_an_arc({"x0": "4"}),
    ),
    "an arc begins and ends at two places": (
        ('demand(sign_of(p * p + q * q), [1], "an arc has one end", Malformed)', "0"), ("if (ends.length) demand(apart,", "if (0) demand(apart,"), lambda: with_an_arc({"x1": "5"}),
    ),
    "an arc's radius is positive": (
        ("bows, sizes = [], [row[2] for row in arcs]", "bows, sizes = [], []"), ("demand(r, [1], 'the radius of an arc is positive')", "0"), lambda: with_an_arc({"r": "-5"}),
    ),
    "an isometry maps a side of an arc to the same side": (
        ("            zeros += [ONE] * (bow != to)  # a side of an arc to the same side of another\n", ""), ("if ((i - j) % 2) refute(", "if (0) refute("),
        lambda: with_an_arc({}, isometries=[{**SAME, "map": [[3, 4]]}]),
    ),
    "an isometry maps the middle of an arc": (
        ("else: zeros += [x, y, vx - wx, vy - wy,", "else: zeros += [vx - wx, vy - wy,"),
        ("same((A, w) => this.image(A, w, [own.x[w], own.y[w]], shift)[k], [other.x, other.y][k], what);", ""),
        lambda: with_an_arc({}, isometries=[{**SAME, "shift": ["0", "1"], "map": [[3, 3]]}]),
    ),
    "an isometry maps the chord of an arc": (
        ("else: zeros += [x, y, vx - wx, vy - wy,", "else: zeros += [x, y,"),
        ("same((A, w) => this.image(A, w, [own.across[0][w], own.across[1][w]])[k], other.across[k], what);", ""),
        lambda: with_an_arc({}, isometries=[{**UPSIDE_DOWN, "map": [[3, 3]]}]),
    ),
    "an isometry maps an arc to one as large": (
        ("*(r - s for r, s in zip(k, m, strict=False))]", "]"), ("same((A, w) => own.r[w], other.r, what);", ""),
        lambda: two_rings(("5", "6")),
    ),
    "an isometry maps an arc to one as long": (
        ("*(r - s for r, s in zip(k, m, strict=False))]", "]"), ("same((A, w) => own.far[w], other.far, what);", ""), short_to_long,
    ),
    "no mirror holds to a wall that moves": (
        ("steered = self.pull or j in self.drift", "steered = False"), (" || scene.steered(c)", ""), held_to_what_moves,
    ),
}  # fmt: skip
"""Each with what each checker has instead of it, as in `test_conditions.CONDITIONS`."""
