"""Forgeries of certificates of what stands where others fall, fixed circles and segments under gravity, each of which one
condition alone keeps out (test_conditions.py)."""
# ruff: noqa: E501 (lines of the checkers stand here as they are)

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal, localcontext
from typing import Any

from certificate.forgeries_by_condition import bare, entries
from certificate.forging import UPSIDE_DOWN, Told
from certificate.segment_forgeries import bar
from certificate.world_forgeries import ASIDE, BOW, DOWN, FLOOR, HAIR, QUIET, RING, STOPPED, Number, beside, no_image

# Numbers: circles, fixed ones among them, then the ends of segments, then walls, then both faces of each segment.

PEG = (1, 0)
"""A radius, and one over the mass, of what is fixed."""

BELOW = ["0", "-2"]
SHELF = [bar(-9, 0, 9, 0, 18)]


def dropped(*rows: tuple[Number, ...], end: Told | None = None, gravity: list[str] = BELOW, **scene: Any) -> Told:
    """Circles and what stands, where they fall; of that nothing is told."""
    return {**bare(*rows, scene={"gravity": gravity, **scene}), "end": end or STOPPED}


def until(time: str) -> Told:
    """An end at a time."""
    return {"reason": "horizon", "until": time}


def digits(value: Callable[[], Decimal]) -> str:
    """A number to 15 decimals."""
    with localcontext() as context:
        context.prec = 40
        return f"{value():.15f}"


def through_a_peg(**end: Any) -> Told:
    """A disc falls through a fixed one, which is not told."""
    return dropped((0, 9, 0, 0), ("1/3", 0, 0, 0, *PEG), end=end or until("4"))


def hardly_through_a_peg() -> Told:
    """A disc falls past a fixed one, of which it is in the way by very little."""
    return dropped((0, 9, 0, 0), (f"2-1*r1+{HAIR[5:]}", 0, 0, 0, *PEG), roots=["2"], end=until("4"))


def onto_a_peg_from_above() -> Told:
    """A disc is thrown up through a fixed one, which is not told, and then falls onto it, which is."""
    cert = dropped((0, 0, 0, 20), ("1/3", 50, 0, 0, *PEG))
    time = digits(lambda: 10 + (100 - 50 - (4 - 1 / Decimal(9)).sqrt()).sqrt())
    return entries(cert, {}, {"time": time, "met": [[0, 1]], "rounds": [[[0, 1]]]})


def off_a_peg_and_through_it() -> Told:
    """A disc bounces off a fixed one, upright, and falls through it later on."""
    cert = dropped((0, 6, 0, 0), (0, 0, 0, 0, *PEG), end=until("7"))
    return entries(cert, {}, {"time": "2.000000", "met": [[0, 1]], "rounds": [[[0, 1]]]})


def before_another_hits_it() -> Told:
    """A disc falls through a fixed one before another falls onto that: up to then it is not asked."""
    rows = [(0, 6, 0, 0), (0, 0, 0, 0, *PEG), ("1/2", 30, 0, 0)]
    cert = dropped(*rows, end=until("6"))
    time = digits(lambda: (30 - (15 / Decimal(4)).sqrt()).sqrt() + 0)
    return entries(cert, {}, {"time": time, "met": [[1, 2]], "rounds": [[[1, 2]]]})


def in_a_segment(height: Number, **scene: Any) -> Told:
    """A disc starts in a segment, and nothing more is told."""
    return dropped((2, height, 0, 4), segments=SHELF, **scene)


def through_a_shelf() -> Told:
    """A disc falls through a segment, which is not told."""
    return dropped((2, 5, 0, 0), segments=SHELF, end=until("4"))


def through_a_shelf_from_its_end() -> Told:
    """A disc touches the end of a segment from above at its apex, and goes on through it."""
    cert = dropped((-2, "1/2", 2, 1), gravity=["0", "-1"], segments=[bar(0, 0, 4, 0, 4)], end=until("3/2"))
    return entries(cert, {}, {"exact": "1", "met": [[0, 1]]})


def off_a_shelf_and_through_it() -> Told:
    """A disc bounces off a segment, and falls through it later on."""
    cert = dropped((0, 5, 0, 0), segments=SHELF, end=until("7"))
    return entries(cert, {}, {"met": [[0, 3]], "rounds": [[[0, 3]]]})


def led_onto_a_shelf() -> Told:
    """A disc is pulled aside, and so onto a segment beside which it started: through it, as is not told."""
    return dropped((-20, 10, 0, 0), segments=[bar(-5, 0, 5, 0, 10)], gravity=["20/9", "-1"], end=until("5"))


def back_along_a_face() -> Told:
    """A disc slides up along a face, past its end, and back along it: there it is struck against it, which is not told."""
    cert = dropped((1, -3, 0, 4), (7, -3, -1, 4), segments=[bar(0, -9, 0, 0, 9)])
    grazes = [{"exact": time, "met": [[0, 3]]} for time in ("1", "3")]
    return entries(cert, {"met": [[0, 5]]}, *grazes, {"exact": "4", "met": [[0, 1]], "rounds": [[[0, 1]]]})


# -- Arcs and rims. Numbers: circles, then the ends of arcs, then walls, then the outside and the inside of each arc.


def through_a_cap() -> Told:
    """A disc falls through an arc, which is not told."""
    return dropped(("1/3", 9, 0, 0), arcs=[BOW], end=until("4"))


def through_a_cup() -> Told:
    """A disc within the lower half of a circle falls through it, which is not told."""
    return dropped(("1/3", 0, 0, 0), arcs=[{**BOW, "x0": "-5", "x1": "5"}], end=until("5"))


def into_a_pocket() -> Told:
    """A disc falls into a pocket, which is not told."""
    return dropped((0, 9, 0, 0), pockets=[{"id": "hole", "x": "1/3", "y": "0", "r": "1"}], end=until("3"))


def onto_a_ring_from_above() -> Told:
    """A disc is thrown up at a ring, past it, which is not told, and then falls onto it, which is."""
    cert = dropped(("1/3", 0, 0, 20, 2), arcs=[{**RING, "y": "50", "r": "1"}])
    time = digits(lambda: 10 + (100 - 50 - (9 - 1 / Decimal(9)).sqrt()).sqrt())
    return entries(cert, {}, {"time": time, "met": [[0, 1]], "rounds": [[[0, 1]]]})


def off_an_arc_that_is_not_there() -> Told:
    """A disc falls onto the lower half of a circle, from above: to where only the upper half would be."""
    cert = dropped((0, 7, 0, 0), arcs=[{**BOW, "x0": "-5", "x1": "5"}])
    return entries(cert, {}, {"time": "1.0000", "met": [[0, 3]], "rounds": [[[0, 3]]]})


def a_point_out_of_a_ring() -> Told:
    """A point hits a fixed circle and a ring from within at once, which is told as if it came out of that."""
    cert = dropped(
        (0, 4, 0, 2, 0), (0, 6, 0, 0, 1, 0), arcs=[RING], gravity=["0", "-1/2"], restitution="0", roots=["3"]
    )
    return entries(cert, {}, {"exact": "4-2*r1", "met": [[0, 1], [0, 2]], "rounds": [[[0, 1, "1*r1"]]]})


def a_point_that_grazes_a_ring_from_within() -> Told:
    """A point hits a fixed circle as it grazes a ring from within, which is told of its outside."""
    cert = dropped((-1, 4, 1, 2, 0), (1, 5, 0, 0, 1, 0), arcs=[RING], restitution="0")
    return entries(cert, {}, {"exact": "1", "met": [[0, 1], [0, 2]], "rounds": [[[0, 1]]]})


def down_from_where_it_rests() -> Told:
    """A disc comes to rest in a ring, and falls through it."""
    cert = dropped((0, -3, 0, 0), arcs=[RING], restitution="0", end=until("2"))
    return entries(cert, {}, {"time": "1.0000", "met": [[0, 2]], "rounds": [[[0, 2]]]})


def mapped_upside_down(number: int, **scene: Any) -> Told:
    """An isometry maps what stands to itself, and gravity to its opposite."""
    return {**dropped((0, 50, 0, 0), **scene), "isometries": [{**UPSIDE_DOWN, "map": [[number, number]]}]}


Changes = tuple[str, str] | list[tuple[str, str]]
MEETS = (
    ('demand(None if signs <= {None, 1} else 0, [1], f"{c} meet before it, or overlap")', "return"),
    (
        "if (reads.some(s => s <= 0)) refute(`${c.name} meet, which is not told, or overlap`);",
        "if (reads.some(s => s <= 0)) return;",
    ),
)
CANNOT_TURN = (
    "refuse(turns and (drift or loss != ONE or stands),",
    "if (turned && stands) malformed(",
)
PEG_CONDITIONS: dict[str, tuple[Changes, Changes | None, Callable[[], Told]]] = {
    "nothing falls through a fixed circle": (
        ('demand(None if signs <= {None, 1} else 0, [1], f"{c} meet before it, or overlap")', "return"), ("if (reads.some(s => s <= 0)) refute(`${c.name} meet, which is not told, or overlap`);", "if (reads.some(s => s <= 0)) return;"), through_a_peg,
    ),
    "nothing falls through a fixed circle in the end": (
        ('demand(None if signs <= {None, 1} else 0, [1], f"{c} meet before it, or overlap")', "return"), ("if (reads.some(s => s <= 0)) refute(`${c.name} meet, which is not told, or overlap`);", "if (reads.some(s => s <= 0)) return;"), lambda: through_a_peg(**QUIET),
    ),
    "whether something falls past a fixed circle is decided": (
        ('demand(None if signs <= {None, 1} else 0, [1], f"{c} meet before it, or overlap")', "return"), ("    undecided(`whether ${c.name} kept apart`);\n  }\n\n  /** At time 0", "  }\n\n  /** At time 0"), hardly_through_a_peg,
    ),
    "a fixed circle is met for the first time": (
        ("if age: self.flies(c, age, 2 - abs(self.met[c]))", "pass"), ("if (c.drops) this.stays(c, 'flight', 1);", ""), onto_a_peg_from_above,
    ),
    "a fixed circle that was left is met again": (
        ("if self.drops(c): return self.flies(c, age)", "if self.drops(c): return c in self.parted or self.flies(c, age)"),
        ("if (c.drops) { this.stays(c, mode); return; }", "if (c.drops) { if (!this.parted(c)) this.stays(c, mode); return; }"), off_a_peg_and_through_it,
    ),
    "a flight past a fixed circle is that of what falls": (
        ("met[c].arms.keys() - self.fixed", "met[c].arms.keys()"),
        ("const { start, t } = this.flights[last];", "const { start, t } = this.flights[peg]?.start ? this.flights[peg] : this.flights[last];"), before_another_hits_it,
    ),
    "an isometry keeps gravity where it maps a fixed circle": (
        ("zeros += falls if bow or i < 0 or i in self.ball.fixed else []", "pass"), ("if (kind === 'pocket' || p.fixed) falls(what);", ""),
        lambda: no_image({**UPSIDE_DOWN, "map": [[0, 0]]}, FLOOR, gravity=DOWN) | {"scene": dropped((0, 0, 0, 0, *PEG), (50, 50, 0, 0))["scene"], "final": {"time": "0", "circles": [["0"] * 4] * 2}},
    ),
    "an isometry keeps gravity where it maps a face": (
        ("zeros += falls + stays", "zeros += stays"), ("        falls(what);\n        same((A, w) => p.thick", "        same((A, w) => p.thick"),
        lambda: {**dropped((0, 50, 0, 0), segments=SHELF), "isometries": [{**UPSIDE_DOWN, "map": [[3, 4]]}]},
    ),
    "nothing turns back where a circle stands under gravity": (
        (CANNOT_TURN[0], "refuse(0,"), (CANNOT_TURN[1], "if (0) malformed("),
        lambda: entries(beside(FLOOR, (0, 50, 0, 0), (9, 50, 0, 0, *PEG), gravity=DOWN, reverse_at="1"), {}, {"exact": "1"}, {"turn": True}),
    ),
    "nothing turns back where a segment is under gravity": (
        (CANNOT_TURN[0], "refuse(0,"), (CANNOT_TURN[1], "if (0) malformed("),
        lambda: entries(beside(FLOOR, (0, 50, 0, 0), gravity=DOWN, reverse_at="1", segments=SHELF), {}, {"exact": "1"}, {"turn": True}),
    ),
    "nothing starts in a segment under gravity": (
        ("refuse(inside, f\"{c}: it", "if inside: return\n        refuse(0, f\"{c}: it"), ("height >= 0) refute(`${c.name} starts in a segment`);", "height >= 0) return;"), lambda: in_a_segment("1/2"),
    ),
    "whether something starts in a segment under gravity is decided": (
        ('raise Unsettled(f"whether {c[0]} starts in a segment")', "return"), ("undecided(`whether ${c.name} starts in a segment`);", ""), lambda: in_a_segment(f"1-1*r1+{HAIR[5:]}", roots=["2"]),
    ),
    "what is pulled to a face does not pass it": (
        [("refuse(ahead and there == 1 and (age is None or done), ", "refuse(0, "), ('raise Unsettled(f"whether {c} meet on the way")', "return")],
        ("if (ahead && there > 0 && (ever || done)) refute(", "if (ahead && there > 0) return; if (0) refute("), through_a_shelf,
    ),
    "what grazes an end where a face begins may go into that": (ASIDE[0], ASIDE[1], through_a_shelf_from_its_end),
    "what is pulled to a face comes to it again": (
        ("if c in self.parted and not (self.hollow(c) or slides): ", "if c in self.parted: "), ("(!hollow && slope !== 0 && this.parted(c))", "this.parted(c)"), off_a_shelf_and_through_it,
    ),
    "a face is where gravity leads to": (
        ("(m.slide + lift * wait) * wait", "m.slide * wait"), ("A.mul(A.mul(along(this.gravity.map(x => x[w])), this.half[w]), wait)", "A.zero"), led_onto_a_shelf,
    ),
    "what slid along a face may come back to be beside it": (
        ("slides = self.pull and c[1] in self.faces and not self.slope(c)", "slides = False"), ("(!hollow && slope !== 0 && this.parted(c))", "(!hollow && this.parted(c))"), back_along_a_face,
    ),
    "nothing falls through an arc": (*MEETS, through_a_cap),
    "nothing falls out of an arc": (*MEETS, through_a_cup),
    "no pocket is entered unseen": (*MEETS, into_a_pocket),
    "an arc is met for the first time": (
        ("if age: self.flies(c, age, 2 - abs(self.met[c]))", "pass"), ("if (c.drops) this.stays(c, 'flight', 1);", ""), onto_a_ring_from_above,
    ),
    "an arc is met within its range under gravity": (
        ("refuse(ranged and not self.within(c), ", "refuse(0, "), ("if (!this.within(c)) refute(", "if (0) refute("), off_an_arc_that_is_not_there,
    ),
    "what comes to an arc under gravity comes from that side": (
        ("refuse(age and self.met[c] > 0 <= c[1], ", "refuse(0, "), ("if (this.k && sign > 0 && c.kind !== 'pocket') refute(`${c.name} comes from behind`);", ""), a_point_out_of_a_ring,
    ),
    "a graze of an arc is one of that side": (
        ("tops += [value(row, wait)]", "pass"), ("if (graze) reads.push(", "if (0) reads.push("), a_point_that_grazes_a_ring_from_within,
    ),
    "what rests on an arc does not fall through it": (
        ("tops = row[:c in self.parted and c[1] >= 0]", "tops = []"), ("if (leaves) reads.push(", "if (0) reads.push("), down_from_where_it_rests,
    ),
    "an isometry keeps gravity where it maps an arc": (
        ("zeros += falls if bow or i < 0 or i in self.ball.fixed else []", "pass"), ("        falls(what);\n        continue;\n      }\n      if (kind === 'face')", "        continue;\n      }\n      if (kind === 'face')"),
        lambda: mapped_upside_down(1, arcs=[RING]),
    ),
    "an isometry keeps gravity where it maps a pocket": (
        ("zeros += falls if bow or i < 0 or i in self.ball.fixed else []", "pass"), ("if (kind === 'pocket' || p.fixed) falls(what);", ""),
        lambda: mapped_upside_down(-1, pockets=[{"id": "hole", "x": "0", "y": "0", "r": "1"}]),
    ),
    "nothing turns back where an arc is under gravity": (
        (CANNOT_TURN[0], "refuse(0,"), (CANNOT_TURN[1], "if (0) malformed("),
        lambda: entries(beside(FLOOR, (0, 50, 0, 0), gravity=DOWN, reverse_at="1", arcs=[RING]), {}, {"exact": "1"}, {"turn": True}),
    ),
    "nothing turns back where a pocket is under gravity": (
        (CANNOT_TURN[0], "refuse(0,"), (CANNOT_TURN[1], "if (0) malformed("),
        lambda: entries(beside(FLOOR, (0, 50, 0, 0), gravity=DOWN, reverse_at="1", pockets=[{"id": "hole", "x": "9", "y": "9", "r": "1"}]), {}, {"exact": "1"}, {"turn": True}),
    ),
}  # fmt: skip
"""Each with what each checker has instead of it, as in `test_conditions.CONDITIONS`."""
