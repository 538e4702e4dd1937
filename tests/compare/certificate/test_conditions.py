"""Conditions of the checker, one by one: a forgery that a checker without it would verify, and that both refuse."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from math import isqrt
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any

import pytest

from certificate.checkers import NODE, TOOLS, needs_node
from certificate.forging import SAME, Told, added, refused_by_both, told
from certificate.test_loopholes import (
    an_entry_hidden_by_the_leaving,
    nothing_told_up_to_a_horizon,
)
from truebreak.compare.certificate import certificate_json
from truebreak.scenarios import Circle, Pocket, Scene, Wall

SOURCE = (TOOLS / "verify.py").read_text(encoding="utf-8")
SECOND = "\n".join(path.read_text(encoding="utf-8") for path in sorted((TOOLS / "second").glob("*.mjs")))
PAIR = [Circle(0, 0, vx=1), Circle(9, 0)]


def lax(condition: str, instead: str) -> Any:
    """The first checker with one condition replaced."""
    assert SOURCE.count(condition) == 1, condition
    module = ModuleType("lax")
    exec(compile(SOURCE.replace(condition, instead), "lax", "exec"), module.__dict__)
    return module


def lax_second(condition: str, instead: str, folder: Path) -> Path:
    """The second checker with one condition replaced, as a program in a folder."""
    assert SECOND.count(condition) == 1, condition
    shutil.copytree(TOOLS / "second", folder / "second")
    shutil.copy(TOOLS / "verify.mjs", folder / "verify.mjs")
    for path in (folder / "second").glob("*.mjs"):
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace(condition, instead), encoding="utf-8")
    return folder / "verify.mjs"


def completed(cert: Told, checker: Any) -> Told:
    """A certificate with the times and the final state that a checker would have."""
    values: list[str] = []

    class Telling(checker.Checker):
        def said(self, value: Any, _: str) -> None:
            nearest = (2 * value.m * 10**12 + (1 << value.bits)) >> (value.bits + 1)
            values.append(f"{'-' if nearest < 0 else ''}{abs(nearest) // 10**12}.{abs(nearest) % 10**12:012d}")

    Telling(cert, 1).check()
    told_values = iter(values)
    for entry in cert["instants"]:
        entry["time"] = next(told_values)
    circles = len(cert["scene"]["circles"])
    time = next(told_values)
    cert["final"] = {"time": time, "circles": [[next(told_values) for _ in range(4)] for _ in range(circles)]}
    return cert


def of(scene: Scene, *instants: Told, end: Told | None = None, **values: Any) -> Told:
    """A scene's certificate with other instants after time 0, another end and other values of the scene."""
    cert = told(scene)
    if instants:
        cert["instants"][1:] = [{"time": "0", **instant} for instant in instants]
    cert["end"] = end or cert["end"]
    cert["scene"] |= values
    return cert


def into_two_points() -> Told:
    """A disc that touches two points, of which the one alone pushes: with both, the other would pull."""
    points = [Circle(x, y, r=0, point=True, m="oo") for x, y in ((10, 0), (8, 6))]
    cert = of(Scene([Circle(0, 0, r=10, vx=1, vy="-1/2"), *points]))
    assert [[push[:2] for push in one] for one in cert["instants"][0]["rounds"]] == [[[0, 1]]]
    cert["instants"][0]["rounds"] = [[[0, 1], [0, 2]]]
    return cert


def held_to_a_floor() -> Told:
    """A disc flies into a floor, by very little; that it is mapped to itself is no sign that it does not."""
    cert = told(Scene([Circle(0, 0, vx=1)], [Wall(0, -1, 1, -1)]))
    cert["scene"]["roots"] = ["2"]
    cert["scene"]["circles"][0]["vy"] = f"{isqrt(2 * 10**140)}/{10**70}-1*r1"
    cert["isometries"] = [{**SAME, "map": [[0, 0]]}]
    cert["instants"][0]["zeros"] = [["closing", [0, 1], 0]]
    return cert


def nearly_turned() -> Told:
    """Two that touch, the one's velocity the other's turned by very little: no shift maps the one to the other."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(1, "sqrt(3)", vx=1)]))
    large = 10**70
    a, b = f"{large * large - 1}/{large * large + 1}", f"{2 * large}/{large * large + 1}"
    cert["scene"]["circles"][1] |= {"vx": a, "vy": f"-{b}"}
    cert["isometries"] = [{"matrix": [a, b, f"-{b}", a], "shift": ["1", "1*r1"], "map": [[0, 1]]}]
    cert["instants"][0]["zeros"] = [["closing", [0, 1], 0], ["speed", [0, 1], 0]]
    cert["end"] = {"reason": "stopped"}
    return cert


def taken_and_yet_there() -> Told:
    """What a pocket has taken is met by another later on."""
    scene = Scene([Circle(0, 0, vx=1), Circle(-9, 0, vx=1)], pockets=[Pocket(9, 0, 1)], capture=True)
    entry = {"met": [[0, -1]], "enter": [[0, -1]]}
    return of(scene, entry, {"met": [[0, 1]], "rounds": [[[0, 1]]]}, end={"reason": "stopped"})


def through_each_other() -> Told:
    """Two meet and are reversed at once: on the way back they meet again, which is not told."""
    cert = told(Scene(PAIR, reverse_after=1))
    del cert["instants"][2]["rounds"]
    return cert


def later_than_it_touches() -> Told:
    """Two that touch from the start, and rest, are said to come to it at 1; of time 0 nothing is told."""
    cert = touching_all_along()
    cert["instants"][0] = {"time": "0"}
    return cert


def touching_all_along() -> Told:
    """As before; what is said of time 0 is true: two that touch, and rest. That they meet again is not."""
    cert = told(Scene([Circle(0, 0), Circle(2, 0)]))
    cert["instants"].append({"time": "0", "exact": "1", "met": [[0, 1]]})
    cert["end"] = STOPPED
    return cert


def sooner() -> Told:
    """The instant after the first is not after it."""
    return of(
        Scene([*PAIR, Circle(0, 50, vx=1), Circle(9, 50)]),
        {"exact": "7", **MEET},
        {"exact": "7", "met": [[2, 3]], "rounds": [[[2, 3]]]},
        end=STOPPED,
    )


def no_gap_zero() -> Told:
    """Two are said to meet which are apart."""
    return of(
        Scene([*PAIR, Circle(50, 50, vx=1, vy=1), Circle(60, 60)]),
        {"met": [[0, 1], [2, 3]], "rounds": [[[0, 1]], [[2, 3]]]},
        end=STOPPED,
    )


def one_by_one() -> Told:
    """Of three in a line, the middle one is struck from one side, then from the other, where both push at once."""
    cert = of(Scene([Circle(-3, 0, vx=1), Circle(0, 0), Circle(3, 0, vx=-1)]), end=STOPPED)
    cert["instants"][1]["rounds"] = [[[0, 1]], [[1, 2]], [[0, 1]]]
    return cert


def nobody_enters() -> Told:
    """A circle that enters a pocket is not said to."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(50, 50)], pockets=[Pocket(9, 0, 1)]))
    del cert["instants"][1]["enter"]
    return cert


def no_isometry(**values: Any) -> Told:
    """An isometry that nothing needs is none."""
    cert = told(Scene(PAIR))
    cert["isometries"] = [{**SAME, "map": [[0, 0]], **values}]
    return cert


def events(limit: int) -> Told:
    """There are not so many events."""
    return of(Scene(PAIR), end={"reason": "events", "limit": limit})


def shifted(**values: Any) -> Told:
    """One circle is said to be another shifted, from which it differs."""
    cert = told(Scene([Circle(0, 0, vx=1, **values), Circle(9, 0, vx=1)]))
    cert["isometries"] = [{**SAME, "shift": ["9", "0"], "map": [[0, 1]]}]
    return cert


def beside_a_wall(**values: Any) -> Told:
    """A wall is said to be its own image, and is not."""
    cert = told(Scene([Circle(0, 0)], [Wall(9, 0, 9, 1)]))
    cert["isometries"] = [{**SAME, "map": [[1, 1]], **values}]
    return cert


def two_to_one() -> Told:
    """Two fixed circles at one place are said to be mapped to the one of them."""
    cert = told(Scene([Circle(0, 0), Circle(9, 0, m="oo"), Circle(19, 0, m="oo")]))
    cert["scene"]["circles"][2]["x"] = "9"
    cert["isometries"] = [{**SAME, "map": [[1, 1], [2, 1]]}]
    return cert


def centre_on_a_wall() -> Told:
    """A point starts on a wall, and so on neither side of it; it is said to leave."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(50, 50)], [Wall(-9, -1, -9, 1)]))
    cert["scene"]["walls"][0] |= {"x0": "0", "x1": "0"}
    cert["scene"]["circles"][0]["r"] = "0"
    cert["instants"] = [{"time": "0", "met": [[0, 2]]}]
    return cert


def circle_to_pocket() -> Told:
    """A fixed circle is said to be mapped to a pocket of its size where it is."""
    cert = told(Scene([Circle(0, 0), Circle(9, 0, m="oo")], pockets=[Pocket(20, 0, 1)]))
    cert["scene"]["pockets"][0]["x"] = "9"
    cert["isometries"] = [{**SAME, "map": [[1, -1]]}]
    return cert


def a_blow_that_is_not_mapped() -> Told:
    """Two heavy pairs alike, but that something light has struck one of them: they do not meet at the same time."""
    heavy = [Circle(x, y, vx=int(m > 1), m=m) for y in (0, 50) for x, m in ((0, 10**60), (9, 1))]
    discs = [*heavy, Circle(-3, 50, vx=5)]
    both = {"met": [[0, 1], [2, 3]], "rounds": [[[0, 1]], [[2, 3]]], "zeros": [["gap", [2, 3], 0]]}
    cert = of(Scene(discs), {"met": [[2, 4]], "rounds": [[[2, 4]]]}, both, end=STOPPED)
    cert["isometries"] = [{**SAME, "shift": ["0", "-50"], "map": [[2, 0], [3, 1]]}]
    return {**cert, "bits": 160}


def nothing_told(*circles: Circle, end: Told | None = None, **values: Any) -> Told:
    """Nothing is said to happen."""
    cert = of(Scene(circles or PAIR), end=end or {"reason": "quiet"}, **values)
    return {**cert, "instants": [{"time": "0"}]}


def with_data(index: int, kind: str = "circles", **values: str) -> Told:
    """Circles at rest, and a wall, whose data are otherwise."""
    cert = told(Scene([Circle(0, 0), Circle(9, 0, m="oo")], [Wall(-9, 0, -9, 1)]))
    cert["scene"][kind][index] |= values
    return cert


def a_time_at_the_start() -> Told:
    """Time 0 is said to be another."""
    cert = told(Scene(PAIR))
    cert["instants"][0]["exact"] = "5"
    return cert


def listed_twice() -> Told:
    """Two that touch are listed twice."""
    cert = told(Scene([Circle(0, 0), Circle(2, 0)]))
    cert["instants"][0]["met"] *= 2
    return cert


def an_overlap_that_ends() -> Told:
    """Two that overlap are said to meet where they part."""
    cert = told(Scene([Circle(0, 0), Circle(9, 0, vx=1)]))
    cert["scene"]["circles"][1]["x"] = "1"
    cert["instants"].append({"time": "0", "exact": "1", "met": [[0, 1]]})
    return cert


def a_round_too_many() -> Told:
    """A blow is told twice."""
    cert = told(Scene(PAIR))
    cert["instants"][1]["rounds"] *= 2
    return cert


def what_does_not_approach_pushes() -> Told:
    """Of three in a row, of which two touch, both contacts are said to push at once: only the one approaches."""
    cert = of(Scene([*PAIR, Circle(11, 0)]), end=STOPPED)
    cert["instants"][1] |= {"exact": "7", "rounds": [[[0, 1, "2/3"], [1, 2, "1/3"]]]}
    return cert


def pushed_by_halves() -> Told:
    """An impulse is told in two halves."""
    return of(Scene(PAIR), {"met": [[0, 1]], "rounds": [[[0, 1, "1/4"], [0, 1, "1/4"]]]}, end=STOPPED)


def another_draw() -> Told:
    """The first of two contacts pushes where the seed takes the second."""
    seed = next(k for k in range(99) if Random(k).randrange(2))
    scene = Scene([Circle(-3, 0, vx=1), Circle(0, 0), Circle(3, 0, vx=-1)], tie_policy="sequential")
    return of(scene, tie_policy=f"sequential:seed={seed}", end=STOPPED)


def through_a_third() -> Told:
    """A third circle is in the way of two that meet."""
    cert = of(Scene([*PAIR, Circle("9/2", 50)]), MEET, end=STOPPED)
    cert["scene"]["circles"][2]["y"] = "0"
    return cert


def nearly_alike() -> Told:
    """Of two pairs, one meets a little later; the identity is said to take it to the other."""
    cert = of(
        Scene([Circle(0, 0, vx=1), Circle(4, 1), Circle(0, 9, vx=1), Circle(4, 10)]),
        {"met": [[0, 1], [2, 3]], "rounds": [[[0, 1]], [[2, 3]]], "zeros": [["gap", [2, 3], 0]]},
        end=STOPPED,
    )
    added(cert, 3, "x")
    cert["isometries"] = [{**SAME, "map": [[k, k] for k in range(4)]}]
    return cert


def beyond_the_end_of_a_horizon() -> Told:
    """A horizon at which two overlap."""
    return nothing_told(end={"reason": "horizon", "until": "8"})


STOPPED = {"reason": "stopped"}
MEET = {"met": [[0, 1]], "rounds": [[[0, 1]]]}
TURN = ({"exact": "12"}, {"turn": True})
Change = tuple[str, str]
CONDITIONS: dict[str, tuple[Change, Change | None, Callable[[], Told]]] = {
    "there is an instant": (
        (' or not told["instants"]', ""),
        None,  # at the end the second one takes all flights up again
        nothing_told_up_to_a_horizon,
    ),
    "what is listed comes to gap zero": (
        ("refuse(stays, ", "refuse(0, "), ("sign === 0 && this.signed(law('speed')", "0 && this.signed(law('speed')"),
        touching_all_along,
    ),
    "what is listed had not been at gap zero": (
        ("refuse(stays, ", "refuse(0, "), ("sign === 0 && this.signed(law('speed')", "0 && this.signed(law('speed')"),
        later_than_it_touches,
    ),
    "instants come one after the other": (
        ("if age and not turn: demand(", "if 0: demand("),
        ("if (s <= 0) refute('it does not come after", "if (0) refute('it does not come after"), sooner,
    ),
    "what is listed has gap zero": (
        ("if self.met or told or not age: refuse(", "if 0: refuse("),
        ("refute(`${c.name} is not at gap zero`)", "void 0"), no_gap_zero,
    ),
    "a pocket is left by what was in it": (
        ("if age and self.met[c] > 0: self.clear(c, last=True)", "pass"),
        ("refute(`${c.name} leaves without having entered`)", "void 0"), an_entry_hidden_by_the_leaving,
    ),
    "flights end at the reversal": (
        ("if turn: self.settle(self.movable)", "pass"),
        ("this.endFlights(this.flights.keys(), known)", "for (const i of this.flights.keys()) this.fresh(i)"),
        lambda: of(Scene(PAIR, reverse_at=12), *TURN, end=STOPPED),
    ),
    "flights end where they are taken": (
        ("            self.settle(taken)\n", ""), ("this.endFlights([i], known)", "this.fresh(i)"),
        lambda: of(
            Scene(PAIR, pockets=[Pocket(30, 0, 1)], capture=True), {"met": [[0, -1]], "enter": [[0, -1]]}, end=STOPPED
        ),
    ),
    "the reversal comes when it is due": (
        ("due != turn or ", ""), ("if (k && this.due !== turn) refute(", "if (0) refute("),
        lambda: of(Scene([*PAIR, Circle(20, 0)]), reverse_after=1),
    ),
    "nothing comes after the last event": (
        (" or self.count == self.last, ", ", "),
        ("if (end.reason === 'events' && this.events >= end.limit) refute(", "if (0) refute("),
        lambda: of(
            Scene(PAIR, pockets=[Pocket(30, 0, 1)]), MEET, {"met": [[1, -1]], "enter": [[1, -1]]},
            end={"reason": "events", "limit": 1},
        ),
    ),
    "there are as many events as are said": (
        ("refuse(self.last not in (None, self.count), ", "refuse(0, "),
        ("if (last && run.events !== end.limit) refute(", "if (0) refute("), lambda: events(2),
    ),
    "no instant is after the set time": (
        ('refuse(sign < 0, "the end', 'refuse(0, "the end'),
        ("if (s < 0) refute(`it is not so", "if (0) refute(`it is not so"),
        lambda: of(Scene(PAIR), MEET, end=STOPPED, reverse_at="5"),
    ),
    "no end is before the set time": (
        ('if reason not in ("events", "stopped") and', "if reason == 0 and"),
        ("if (end.reason === 'quiet' && reverseAt && !run.turnTime) refute(", "if (0) refute("),
        lambda: of(Scene(PAIR), reverse_at="50"),
    ),
    "signs turn with the velocities": (
        ("turned = {c: -sign for c, sign in self.known.items()}", "turned = dict(self.known)"),
        ("sign: turn ? -x.sign : x.sign", "sign: x.sign"), through_each_other,
    ),
    "impulses push": (
        ("for impulse in balls:", "for impulse in ():"),
        ("if (sign <= 0) refute(`${contacts[a].name} does not push`)", ""), into_two_points,
    ),
    "impulses turn the closing speed round": (
        ('refuse(self.sign("slack", c), f"the impulse', 'refuse(0, f"the impulse'),
        ("if (s) refute(`the impulse of", "if (0) refute(`the impulse of"),
        lambda: of(Scene(PAIR), {"exact": "7", "met": [[0, 1]], "rounds": [[[0, 1, "2"]]]}),
    ),
    "who does not push is not pushed into": (
        ('self.sign("slack", c) < 0, f"', 'self.sign("slack", c) < -1, f"'),
        ("if (slack < 0) refute(", "if (0) refute("), one_by_one,
    ),
    "one after the other is one after the other": (
        ('if self.policy != "simultaneous":', "if 0:"), ("if (!simultaneous) {", "if (0) {"),
        lambda: of(Scene([Circle(-3, 0, vx=1), Circle(0, 0), Circle(3, 0, vx=-1)]), tie_policy="sequential"),
    ),
    "who enters is told": (
        ('refuse(enter != sorted(map(tuple, entry.get("enter", ()))), ', "refuse(0, "),
        ("refute('not these circles enter pockets');", ""), nobody_enters,
    ),
    "only the mirror holds to a wall": (
        ("return turned and images", "return images"), ("return [0, 1].every(k => isZero(", "return true || [0].every(k => isZero("),  # noqa: E501
        held_to_a_floor,
    ),
    "only a shift holds two together": (
        (" and not any((a - ONE, b, d, e - ONE))", ""),
        ("if (![b, d, A.sub(a, one), A.sub(e, one)].every(x => A.sign(x) === 0)) return false;", ""), nearly_turned,
    ),
    "what is taken is met no more": (
        ("self.meets = {c for c in self.meets if not", "self.meets = {c for c in self.meets if c[1] >= 0 or not"),
        ("if (!c || this.movers(c).some(x => this.captured[x])) refute(", "if (!c) refute("), taken_and_yet_there,
    ),
    "an isometry's first column is of length 1": (
        ("a * a + d * d - ONE, ", ""), ("zero((A, w) => A.sub(A.add(A.square(a[w]), A.square(c[w])), one[w])", "void ((A, w) => 0"),  # noqa: E501
        lambda: no_isometry(matrix=["2", "0", "0", "1"], map=[]),
    ),
    "an isometry's second column is of length 1": (
        ("b * b + e * e - ONE, ", ""), ("zero((A, w) => A.sub(A.add(A.square(b[w]), A.square(d[w])), one[w])", "void ((A, w) => 0"),  # noqa: E501
        lambda: no_isometry(matrix=["1", "0", "0", "2"]),
    ),
    "an isometry's columns are at right angles": (
        (", a * b + d * e]", "]"), ("zero((A, w) => A.add(A.mul(a[w], b[w]), A.mul(c[w], d[w]))", "void ((A, w) => 0"),
        lambda: no_isometry(matrix=["1", "3/5", "0", "4/5"]),
    ),
    "an isometry maps places": (
        ("else: zeros += [x, y, vx", "else: zeros += [vx"),
        ("same((A, w) => this.image(A, w, [p.x[w], p.y[w]], shift)[k], [q.x, q.y][k], what);", ""),
        lambda: no_isometry(shift=["1", "0"]),
    ),
    "an isometry maps velocities": (
        ("[x, y, vx - wx, vy - wy, *(r", "[x, y, *(r"),
        ("if (kind === 'circle') same((A, w) => this.image(A, w, [p.vx[w], p.vy[w]])[k], [q.vx, q.vy][k], what);", ""),
        lambda: no_isometry(matrix=["-1", "0", "0", "1"]),
    ),
    "an isometry maps radii": (
        ("zip(k, m, strict=False)", "zip(k[1:], m[1:], strict=False)"), ("same((A, w) => p.r[w], q.r, what);", ""),
        lambda: shifted(r="1/2"),
    ),
    "an isometry maps masses": (
        ("zip(k, m, strict=False)", "zip(k[:1], m[:1], strict=False)"), ("if (kind === 'circle') same((A, w) => p.w[w], q.w, what);", ""),  # noqa: E501
        lambda: shifted(m=2),
    ),
    "an isometry maps walls to parallel ones": (
        ("[vx * wy - vy * wx, x * wx", "[x * wx"),
        ("zero((A, w) => across(A, w, this.image(A, w, [A.sub(p.x1[w], p.x0[w]), A.sub(p.y1[w], p.y0[w])])), what);", ""),  # noqa: E501
        lambda: beside_a_wall(matrix=["0", "-1", "1", "0"], shift=["9", "-9"]),
    ),
    "an isometry maps walls to where they are": (
        ("[vx * wy - vy * wx, x * wx + y * wy]", "[vx * wy - vy * wx]"),
        ("return across(A, w, [A.sub(x, q.x0[w]), A.sub(y, q.y0[w])]);", "return A.sub(x, x);"),
        lambda: beside_a_wall(shift=["1", "0"]),
    ),
    "no centre is on a wall": (
        ("demand(sign, [1, -1], f\"the centre", "demand(1, [1, -1], f\"the centre"),
        (" || refute(`the centre of circle ${i} is on wall ${wall.id}`)", ""), centre_on_a_wall,
    ),
    "an isometry maps circles to circles": (
        ("            zeros += [ONE] * ((i < 0, i < self.n) != (j < 0, j < self.n))\n", ""),
        None,  # the second one has no circle by that number then
        circle_to_pocket,
    ),
    "whose row is not mapped is struck out": (
        ("while bad := {i for i in hit & kept if strays(i)}: kept", "while bad := (): kept"),
        ("if (!this.rowMapped(", "if (0 && !this.rowMapped("), a_blow_that_is_not_mapped,
    ),
    "an isometry takes no two to one": (
        ("refuse(twice or signs", "refuse(signs"),
        ("if (this.inverse.size !== given.map.length) refute(", "if (0) refute("), two_to_one,
    ),
    "a wall is as long as is said": (
        ("demand(sign_of(p * p + q * q - r * r), ", "demand(0, "),
        ("demand((A, w) => A.sub(A.add(A.square(wall.n[0][w])", "void ((A, w) => A.sub(A.add(A.square(wall.n[0][w])"),
        lambda: with_data(0, "walls", length="2"),
    ),
    "what is fixed has no velocity": (
        ("refuse(moves, ", "refuse(0, "), ("for (const v of [c.vx, c.vy]) demand(", "for (const v of []) demand("),
        lambda: with_data(1, vx="1"),
    ),
    "no radius is negative": (
        ("for x in (*sizes, *limits.values()): demand(", "for x in (): demand("),
        ("c.point = demand(c.r, [0, 1],", "c.point = demand(c.r, [-1, 0, 1],"), lambda: with_data(0, r="-1"),
    ),
    "time 0 is time 0": (
        ("refuse(told and (turn or not age), ", "refuse(0, "), ("refute('it has a time already')", "void 0"),
        a_time_at_the_start,
    ),
    "no contact is listed twice": (
        ("refuse(len({*met} & self.meets) < len(met) * (1 + turn), ", "refuse(0, "),
        ("refute('a contact meets twice')", "void 0"), listed_twice,
    ),
    "what parts was not apart": (
        ("if age and self.met[c] > 0: self.clear(c, last=True)", "pass"),
        ("if (this.k && sign > 0) {", "if (0) {"), an_overlap_that_ends,
    ),
    "something falls on an instant": (
        ("refuse(not (met or turn or self.due or age == 0), ", "refuse(0, "), ("refute('nothing meets')", "void 0"),
        lambda: of(Scene(PAIR), {"exact": "3"}, MEET),
    ),
    "a reversal that is due is told": (
        ("refuse(left, ", "refuse(0, "), ("if (run.due && !last) refute(", "if (0) refute("),
        lambda: of(Scene(PAIR), reverse_after=1),
    ),
    "there is no return without a reversal": (
        ('(reason == "return" and not self.way)', "False"),
        ("if (end.reason === 'return' && !run.turnTime) refute(", "if (0) refute("),
        lambda: of(Scene(PAIR), end={"reason": "return"}),
    ),
    "no horizon is beyond a reversal that is not told": (
        ('if reason not in ("events", "stopped") and', "if reason == 0 and"),
        ("refute('the reversal is not told')", "void 0"),
        lambda: of(Scene(PAIR), reverse_at="50", end={"reason": "horizon", "until": "60"}),
    ),
    "all rounds are used up": (
        ('refuse(rounds, "none', 'refuse(0, "none'), ("refute('a round in which nothing approaches')", "void 0"),
        a_round_too_many,
    ),
    "what pushes approaches": (
        ("wrong = not push or len({*push} & {*coming}) < len(push)", "wrong = not push"),
        ("new Map(list.map(x => [x.c.name, x]))", "new Map(group.map(x => [x.c.name, x]))"),
        what_does_not_approach_pushes,
    ),
    "what pushes pushes once": (
        ("wrong = not push or len({*push} & {*coming}) < len(push)", "wrong = not push"),
        None,  # the second one has an impulse for each contact, and no more
        pushed_by_halves,
    ),
    "the seed says which pushes": (
        ("self.draw.randrange(len(coming)) if many else 0", "0"), ("run.random.below(list.length)", "0"), another_draw,
    ),
    "nothing more happens where it is quiet": (
        ("for c in self.meets: self.clear(c, None", "for c in (): self.clear(c, None"),
        ("run.apart(c, end.reason === 'quiet' ? 'ever' : 'end')", "void 0"), nothing_told,
    ),
    "nothing else is met on a flight": (
        ("for c in found & self.meets: self.clear(", "for c in (): self.clear("), ("this.apart(c, 'flight')", "void 0"),
        through_a_third,
    ),
    "what approaches is not apart for that": (
        ("closing in (0, 1) or", "closing in (-1, 0, 1) or"),
        ("if (closing >= 0) return;", "if (closing >= -1) return;"), nothing_told,
    ),
    "what has a positive discriminant is not apart for that": (
        ("disc == -1 or tangent", "disc == 1 or tangent"), ("if (disc < 0 || (", "if (disc > 0 || ("), nothing_told,
    ),
    "the tangent is above zero": (
        ("(m.gap + rise * wait + rise * wait).sign() == 1", "(m.gap + rise * wait + rise * wait).sign() == -1"),
        ("if (this.sign((A, w) => atStart(A, w)) > 0) return;", "if (this.sign((A, w) => atStart(A, w)) < 0) return;"),
        through_a_third,
    ),
    "the gap is positive at the end too": (
        ("if {*gaps} == {1} and (closing in", "if gaps[0] == 1 and (closing in"), ("if (gapNow > 0) {", "if (1) {"),
        beyond_the_end_of_a_horizon,
    ),
    "circles do not overlap": (
        ("if c[1] < 0 and gaps[0] == -1: return", "if gaps[0] == -1: return"),
        ("if (gap < 0 && c.kind === 'pocket') return;", "if (gap < 0) return;"), lambda: with_data(1, x="1"),
    ),
    "an image is that of the other": (
        ("self.image(images, c) == other", "1"), (" && g.contact(c)?.key === other.c.key;", ";"), nearly_alike,
    ),
}  # fmt: skip


@needs_node
@pytest.mark.parametrize("name", CONDITIONS)
def test_no_condition_is_idle(name: str, tmp_path: Path) -> None:
    first, second, forged = CONDITIONS[name]
    checker = lax(*first)
    cert = completed(forged(), checker)
    path = tmp_path / "lax.json"
    path.write_text(certificate_json(cert), encoding="utf-8")
    code, sentence = checker.verdict(path)
    assert code == 0, sentence
    if second is not None:
        assert NODE is not None
        command = [NODE, str(lax_second(*second, tmp_path / "lax")), str(path)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    refused_by_both(cert, tmp_path / "forged.json")


@needs_node
def test_the_final_state_is_as_its_decimals_say(tmp_path: Path) -> None:
    cert = told(Scene(PAIR))
    path = tmp_path / "final.json"
    cert["final"]["circles"][1][0] = "9.5"
    path.write_text(certificate_json(cert), encoding="utf-8")
    checker = lax("                self.said(value, text)\n", "                pass\n")
    assert checker.verdict(path)[0] == 0
    second = lax_second("run.decimal(p, row[a], `${'xy'[a]} of circle ${i}`);", "", tmp_path / "lax")
    assert NODE is not None
    done = subprocess.run([NODE, str(second), str(path)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    refused_by_both(cert, tmp_path / "forged.json")
