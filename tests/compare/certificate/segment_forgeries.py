"""Forgeries of certificates with segments, each of which one condition alone keeps out (test_conditions.py)."""
# ruff: noqa: E501 (lines of the checkers stand here as they are)

from __future__ import annotations

from collections.abc import Callable
from math import isqrt
from typing import Any

from certificate.forgeries_by_condition import STOPPED, bare, entries, small
from certificate.forging import SAME, UPSIDE_DOWN, Told, told
from truebreak.scenarios import Circle, Scene, Segment, Wall

HORIZON = {"reason": "horizon", "until": "9"}
Number = str | int
HAIR = f"1*r1-{isqrt(2 * 10**140)}/{10**70}"
"""More than zero, by less than the bits of these certificates tell; its root is that of 2."""

# Numbers: circles, then the ends of segments, then walls, then the left and the right face of each segment.


def bar(x0: Number, y0: Number, x1: Number, y1: Number, length: Number, r: Number = 0, **way: Number) -> Told:
    """A segment of a certificate, perhaps with a velocity."""
    row = {"x0": x0, "y0": y0, "x1": x1, "y1": y1, "length": length, "r": r, **way}
    return {"id": f"s {x0} {y0} {x1} {y1}", **{key: str(value) for key, value in row.items()}}


def among(bars: list[Told], *rows: tuple[Number, ...], end: Told | None = None, **values: Any) -> Told:
    """Circles among segments, of which nothing is told."""
    return {**bare(*rows, scene={"segments": bars, **values.pop("scene", {})}, **values), "end": end or STOPPED}


SHELF = [bar(0, 0, 4, 0, 4)]
"""Its ends are n and n + 1, its faces n + 2, from above, and n + 3."""

PIERCED = {"exact": "5"}


def beside_a_face() -> Told:
    """A disc bounces off the line of a face, beyond its end."""
    return entries(among(SHELF, (6, 5, 0, -1)), {}, {"met": [[0, 3]], "rounds": [[[0, 3]]]})


def through_a_face(**entry: Any) -> Told:
    """A point flies through a segment; or what is listed of it is the face that it comes to from behind."""
    cert = among(SHELF, (2, 5, 0, -1, 0), end=HORIZON)
    return entries(cert, {}, {**PIERCED, **entry}) if entry else cert


def onto_a_face() -> Told:
    """A disc flies into the middle of a segment, which is not told."""
    return among(SHELF, (2, 5, 0, -1), end={"reason": "quiet"})


def through_an_end(**entry: Any) -> Told:
    """A point flies through the end of a segment without thickness."""
    cert = among(SHELF, (0, 5, 0, -1, 0), end=HORIZON)
    return entries(cert, {}, {**PIERCED, **entry}) if entry else cert


def past_an_end_to_a_wall() -> Told:
    """A point flies through the end of a segment, and then into a wall."""
    wall = {"id": "w", "x0": "0", "y0": "-3", "x1": "1", "y1": "-3", "length": "1"}
    cert = among(SHELF, (0, 5, 0, -1, 0), scene={"walls": [wall]})
    return entries(cert, {}, {"met": [[0, 3]], "rounds": [[[0, 3]]]})


def from_the_middle() -> Told:
    """A point starts on a segment, and is said to slide along both of its faces."""
    return entries(among(SHELF, (2, 0, 1, 0, 0)), {"met": [[0, 3], [0, 4]]})


def across_a_segment(y: str = "1/2", r: Number = 0) -> Told:
    """A disc starts across a segment, and leaves it."""
    return among([bar(0, 0, 4, 0, 4, r)], (2, y, 0, 1), end={"reason": "quiet"})


def hardly_across() -> Told:
    """The same, by very little."""
    cert = across_a_segment(f"1-1*r1+{isqrt(2 * 10**140)}/{10**70}")
    cert["scene"]["roots"] = ["2"]
    return cert


def hardly_on_a_face() -> Told:
    """A disc that meets a face right beside its end, by very little, is said to meet the end."""
    cert = among(SHELF, (HAIR, 5, 0, -1), scene={"roots": ["2"]})
    return entries(cert, {}, {"met": [[0, 1]], "rounds": [[[0, 1]]]})


def what_it_slides_on() -> Told:
    """A large disc slides onto a segment, and one before it, and is struck from above: into the small one, which then
    throws it up before the segment does."""
    floor = [bar(0, 0, 100, 0, 100)]
    cert = among(floor, (-10, 39, 1, -1, 1, 2), (-10, 9, 1, 0, 9), (-4, 1, 1, 0, 1, "1/1000"))
    pushes = [[[0, 1]], [[1, 2]], [[2, 5]]]
    return entries(cert, {"met": [[1, 2]]}, {"exact": "20", "met": [[0, 1], [2, 5]], "rounds": pushes})


def a_face_that_was_left() -> Told:
    """A disc slides off a segment, and is struck beyond its end: the face is said to push it."""
    cert = among([bar(-4, 0, 4, 0, 8)], (0, 1, 1, 0), (0, 9, 1, -1))
    pushes = [[[0, 1, "1/2"]], [[0, 4, "1/4"]], [[0, 1, "1/2"]]]
    return entries(cert, {"met": [[0, 4]]}, {"exact": "6", "met": [[0, 1]], "rounds": pushes})


def on_both_sides() -> Told:
    """A point slides along a segment, on its left; what comes from the right is said to push it against the right."""
    floor = [bar(-50, 0, 50, 0, 100)]
    rows = [(-1, 1, 1, -1, 0, 1), (0, "11/4", 0, "-7/4", 1, 2), (2, -4, 0, 1)]
    cert = among(floor, *rows, scene={"tie_policy": "sequential"})
    first = {
        "exact": "1",
        "met": [[0, 1], [0, 5], [1, 5]],
        "rounds": [[[0, 1, "1/2"]], [[0, 5, "3/100"]], [[0, 1, "3/2"]]],
    }
    second = {
        "exact": "3",
        "met": [[0, 2], [2, 6], [0, 6]],
        "rounds": [[[0, 2, "1"]], [[0, 6, "1/50"]], [[0, 2, "1"]]],
    }
    return entries(cert, {}, first, second)


def alike(change: Told, *bars: Segment, walls: tuple[Wall, ...] = ()) -> Told:
    """An isometry of faces that is none, and that nothing needs."""
    cert = told(Scene([Circle(0, 0)], walls, segments=bars))
    return {**cert, "isometries": [{**SAME, **change}]}


def back_by_what_it_slides_on() -> Told:
    """Two that touched at time 0 are said to do so again a little before they do, as something slides on."""
    late, slow = small(150), f"1/{1 << 20}*r1"
    rows = [(0, 1, 1, 0), (0, 50, 0, 0), ("6/5", "258/5", slow, 0)]
    cert = among([bar(-100, 0, 100, 0, 200)], *rows, scene={"reverse_at": "5", "roots": ["2"]})
    last = {"met": [[0, 5], [1, 2]], "zeros": [["gap", [1, 2], "back", [0, 5]]], "rounds": [[[1, 2]]]}
    first = {"met": [[0, 5], [1, 2]]}
    return entries(cert, first, {"exact": "5"}, {"turn": True}, {"exact": f"10-{late}", **last})


def the_larger_by_a_hair() -> Told:
    """Of two segments that share an end one is hardly thicker; what its end meets by very little is not told."""
    unit, by = 1 << 160, 1 << 20
    thicker = f"1+{by}*r1-{by * isqrt(2 * unit * unit)}/{unit}"
    bars = [bar(0, 0, 0, -9, 9, 1), bar(0, 0, 3, -4, 5, thicker)]
    return among(bars, (-5, f"2+{small(150)}", by, 0), scene={"roots": ["2"]}, end={"reason": "quiet"})


# -- What moves. Of one segment the ends are n and n + 1, its faces n + 2, from above, and n + 3.

LIFT = [bar(0, 0, 4, 0, 4, vy="1/2")]
DOWN = ["0", "-2"]


def under_a_moving_end() -> Told:
    """A disc falls past the end of a segment that has come along meanwhile, and was far off as it began: not told."""
    row = bar(-20, 0, -10, 0, 10, vx="17/5")
    return among([row], (0, 9, 0, 0), scene={"gravity": DOWN}, end={"reason": "horizon", "until": "4"})


def through_a_joint_that_parts() -> Told:
    """Two segments share an end at time 0, and one moves off: a disc flies through that one's end, which is not told."""
    bars = [bar(-9, 0, 0, 0, 9), bar(0, 0, 9, 0, 9, vx="1/3", vy="-1/2")]
    return among(bars, ("57/10", 9, 0, -1, "1/4"), end={"reason": "quiet"})


def onto_where_it_was() -> Told:
    """A disc is said to meet a face where it stood at time 0: the face has come up to meet it before."""
    return entries(among(LIFT, (2, 5, 0, -1)), {}, {"exact": "4", "met": [[0, 3]], "rounds": [[[0, 3]]]})


def onto_a_face_that_went_off() -> Told:
    """A disc bounces off the line of a face that has moved aside from under it."""
    cert = among([bar(0, 0, 4, 0, 4, vx=2)], (2, 5, 0, -1))
    return entries(cert, {}, {"met": [[0, 3]], "rounds": [[[0, 3]]]})


def past_a_face_that_came() -> Told:
    """A disc flies through a face that has come from aside, which is not told."""
    return among([bar(-19, 0, -5, 0, 14, vx=2)], (0, 5, 0, -1), end=HORIZON)


def turned_back_beside_what_moves() -> Told:
    """A run beside a segment that moves is turned back."""
    cert = among(LIFT, (0, 50, 0, 0), scene={"reverse_at": "1"})
    return entries(cert, {}, {"exact": "1"}, {"turn": True})


def held_to_a_face_that_moves() -> Told:
    """A face comes up under a disc at rest, by very little; that the disc is its own mirror image is no sign against it."""
    cert = among([bar(-4, 0, 4, 0, 8, vy=HAIR)], (0, 1, 0, 0), scene={"roots": ["2"]})
    cert["isometries"] = [{**UPSIDE_DOWN, "shift": ["0", "2"], "map": [[0, 0]]}]
    return entries(cert, {"met": [[0, 3]], "zeros": [["closing", [0, 3], 0]]})


def turned_round_as_it_moves() -> Told:
    """An isometry turns a segment that moves round about its middle: it flies off the other way."""
    turn = {"matrix": ["-1", "0", "0", "-1"], "shift": ["0", "-40"], "map": [[3, 4]]}
    return alike(turn, Segment(-4, -20, 4, -20, id="u", vx=1))


def later_onto_a_moving_end() -> Told:
    """A disc is thrown up through the end of a segment that moves, which is not told, and then falls onto it, which is."""
    cert = among([bar("1/3", 50, 30, 50, "89/3", vx="1/1000")], (0, 0, 0, 20), scene={"gravity": DOWN})
    return entries(cert, {}, {"time": "17.00453", "met": [[0, 1]], "rounds": [[[0, 1]]]})


def crushed_late(reason: Told, *later: Told) -> Told:
    """A lift takes a disc up to a press, and both close on it at 42/5: something is said of it after that."""
    lift, press = bar(-3, 0, 3, 0, 6, vy="1/2"), bar(-3, 9, 3, 9, 6, vy="-1/3")
    cert = among([lift, press], (0, 4, 0, 0), scene={"restitution": "0"}, end=reason)
    return entries(cert, {}, {"met": [[0, 5]], "rounds": [[[0, 5]]]}, *later)


UPPER, LOWER = Segment(-4, -20, 4, -20, id="u"), Segment(-4, -30, 4, -30, id="l", r=1)

Changes = tuple[str, str] | list[tuple[str, str]]
MOVED = ("x, y, vx, vy = x - p * time, y - q * time, vx - p, vy - q", "pass")
CANNOT_TURN = (
    "refuse(turns and (drift or loss != ONE or stands),",
    "if (turned && (!elastic || drift)) malformed(",
)
SEGMENT_CONDITIONS: dict[str, tuple[Changes, Changes | None, Callable[[], Told]]] = {
    "a face is met between its ends": (
        ("refuse(ranged and not self.within(c), ", "refuse(0, "), ("if (!this.within(c)) refute(", "if (0) refute("), beside_a_face,
    ),
    "a face that is in the way is met": (
        ("return -1 if -1 in signs else None if None in signs else min(signs)", "return -1"), ("if (near <= 0 || beyond <= 0) return;", "return;"), onto_a_face,
    ),
    "a face is not passed before its first end alone": (
        ("signs = {foot.sign(), (m.square - foot).sign()}", "signs = {-(foot.sign() or 0)}"), ("if (near <= 0 || beyond <= 0) return;", "if (near >= 0) return;"), onto_a_face,
    ),
    "a face is not met from behind": (
        ("refuse(age and self.met[c] >= away, ", "refuse(0, "), ("if (c.kind !== 'pocket') refute(", "if (0) refute("), lambda: through_a_face(met=[[0, 4]]),
    ),
    "a point does not meet an end without thickness": (
        ("refuse(c[0] < c[1] < self.n and self.points(*c), ", "refuse(0, "), ("if (c.blunt) refute(", "if (0) refute("), lambda: through_an_end(met=[[0, 1]]),
    ),
    "a point does not pass through an end": (
        ("[:1 if 0 <= c[1] < self.n and self.points(*c) else 2]", ""), (" && mode !== 'flight' && !c.blunt", ""), through_an_end,
    ),
    "a point does not pass through an end on its way": (
        ("[:1 if 0 <= c[1] < self.n and self.points(*c) else 2]", ""), ("if ((disc === 0 && !c.blunt) || ", "if (disc === 0 || "), past_an_end_to_a_wall,
    ),
    "no centre is on a segment": (
        ('if face and not age: refuse(self.sign("height", c) < 1, ', "if 0: refuse(0, "),
        ("if (c.face && this.k === 0 && this.known(law('height'), `whether the centre of ${c.name} is on it`) <= 0) refute(", "if (0) refute("), from_the_middle,
    ),
    "nothing starts across a segment": (
        ("if c[1] in self.faces and c not in self.met: self.outside(c)", "pass"), ("if (this.flights[c.i].start === 0 && !(", "if (0 && !("), across_a_segment,
    ),
    "nothing starts in the thickness of a segment": (
        ("if c[1] in self.faces and c not in self.met: self.outside(c)", "pass"), ("if (this.flights[c.i].start === 0 && !(", "if (0 && !("), lambda: across_a_segment("3/2", 1),
    ),
    "whether something starts across a segment is decided": (
        ('raise Unsettled(f"whether {c[0]} starts in a segment")', "return"), ("undecided(`whether ${c.name} overlap`)", "void 0"), hardly_across,
    ),
    "whether a face is met is decided": (
        ('raise Unsettled(f"whether {c} meet on the way")', "return"), ("undecided(`whether ${c.name} meet on the way`)", "return"), hardly_on_a_face,
    ),
    "what a circle slides on is told": (
        ("if gap or last or signs", "if True or signs"), ("if (gap > 0 || mode !== 'flight' || foot <= 0 || far <= 0) return;", "return;"), what_it_slides_on,
    ),
    "a face is left at its end": (
        ("if c[1] not in self.faces or self.within(c)}", "}"), (" && (!x.c.face || this.within(x.c))", ""), a_face_that_was_left,
    ),
    "a point is on one side": (
        ("refuse(self.other(c) in self.parted, ", "refuse(0, "), ("if (other && !c.drops && this.parted(other)) refute(", "if (0) refute("), on_both_sides,
    ),
    "an isometry maps faces to their side": (
        ("[vx - wx, vy - wy, x + x", "[x + x"), ("same((A, w) => this.image(A, w, [p.n[0][w], p.n[1][w]])[k], q.n[k], what);", ""),
        lambda: alike({"map": [[3, 4]]}, UPPER),
    ),
    "an isometry maps faces to where they are": (
        (", x + x + along - wy, y + y + by + wx, k[1]", ", k[1]"), ("return A.sub(moved, ends(A, w, q)[k]);", "return A.sub(moved, moved);"),
        lambda: alike({"map": [[3, 3]], "shift": ["1", "0"]}, UPPER),
    ),
    "an isometry maps thick faces to thick ones": (
        (", k[1] - m[1]]", "]"), ("same((A, w) => p.thick[w], q.thick, what);", ""),
        lambda: alike({"map": [[5, 7]], "shift": ["0", "-10"]}, UPPER, LOWER),
    ),
    "an isometry maps faces to faces": (
        ("                zeros += [ONE] * (i not in self.faces or j not in self.faces)\n", ""), ("if (kind !== this.sort(j)) refute(", "if (0) refute("),
        lambda: alike({"map": [[3, 4]]}, UPPER, walls=(Wall(-4, -20, 4, -20),)),
    ),
    "what slides comes to no gap zero on the way back": (
        ("and self.out and not slides", "and self.out"), (" && !(other.c.face && other.sign === 0)", ""), back_by_what_it_slides_on,
    ),
    "which end is the larger is decided": (
        ('demand(sign, [-1, 0, 1], "which', 'demand(0, [-1, 0, 1], "which'), ("if (larger === undefined) undecided(", "if (0) undecided("), the_larger_by_a_hair,
    ),
    "an end that moves comes along": (
        ("speeds = p - vx, q - vy", "speeds = (-vx, -vy) if c[1] in self.pegs else (p - vx, q - vy)"), ("(own ? A.sub(x, own[k]) : x)", "x"), under_a_moving_end,
    ),
    "a joint that parts has two ends": (
        ("for z in (*place, *way))", "for z in place)"), ("[x, y, vx, vy].map(v => this.spelled(v))", "[x, y].map(v => this.spelled(v))"), through_a_joint_that_parts,
    ),
    "a face has moved by the time it is met": (
        MOVED, [("place = minus(place, own.map(x => A.mul(x, time)));", ""), ("way = minus(way, own);", "")], onto_where_it_was,
    ),
    "a face that went off is not met": (
        MOVED, [("place = minus(place, own.map(x => A.mul(x, time)));", ""), ("way = minus(way, own);", "")], onto_a_face_that_went_off,
    ),
    "a face that came is met": (
        ("wall.gap, wall.speed, wall.disc = gap", "if j in self.drift: wall.slide = wall.slide + (d[1] * p - d[0] * q)\n        wall.gap, wall.speed, wall.disc = gap"),
        ("A.mul(along(way), gap())", "A.mul(along(u), gap())"), past_a_face_that_came,
    ),
    "no segment that moves is turned back": (
        (CANNOT_TURN[0], "refuse(0,"), (CANNOT_TURN[1], "if (0) malformed("), turned_back_beside_what_moves,
    ),
    "no mirror holds to a face that moves": (
        ("steered = self.pull or j in self.drift", "steered = self.pull"), (" || scene.steered(c)", ""), held_to_a_face_that_moves,
    ),
    "an isometry maps faces to such as move alike": (
        ("zeros += falls + stays", "zeros += falls"), ("same((A, w) => this.image(A, w, [own[0][w], own[1][w]])[k], other[k], what);", ""), turned_round_as_it_moves,
    ),
    "an end that moves is met for the first time": (
        ("if age: self.flies(c, age, 2 - abs(self.met[c]))", "pass"), ("if (c.drops) this.stays(c, 'flight', 1);", ""), later_onto_a_moving_end,
    ),
    "what is crushed by a horizon has met both": (
        [("refuse(ahead and there == 1 and (age is None or done), ", "refuse(0, "), ('raise Unsettled(f"whether {c} meet on the way")', "return")], ("(mode === 'ever' || at('gap', false) <= 0)) refute(`${c.name} meet on the way`);", "(mode === 'ever' || at('gap', false) <= 0)) return;"), lambda: crushed_late({"reason": "horizon", "until": "9"}),
    ),
}  # fmt: skip
"""Each with what each checker has instead of it, as in `test_conditions.CONDITIONS`."""
