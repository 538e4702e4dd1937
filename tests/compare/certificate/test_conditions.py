"""Conditions of the checker, one by one: a forgery that a checker without it would verify, and that both refuse."""
# ruff: noqa: E501 (lines of the checkers stand here as they are)

from __future__ import annotations

import ast
import re
import shutil
from collections.abc import Callable
from functools import cache
from itertools import pairwise
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

import pytest

from certificate import forgeries_by_condition as forged
from certificate.checkers import TOOLS, needs_node, printed_by
from certificate.forgeries_by_condition import MEET, PAIR, STOPPED, TURN, of
from certificate.forging import Told, refused_by_both, told
from certificate.peg_forgeries import PEG_CONDITIONS
from certificate.segment_forgeries import SEGMENT_CONDITIONS
from certificate.settle_forgeries import SETTLE_CONDITIONS
from certificate.test_forgeries import back_after_rounds_that_do_not_go_back
from certificate.test_loopholes import (
    an_entry_hidden_by_the_leaving,
    nothing_told_up_to_a_horizon,
)
from certificate.world_forgeries import WORLD_CONDITIONS
from truebreak.compare.certificate import certificate_json
from truebreak.scenarios import Circle, Pocket, Scene

SOURCE = (TOOLS / "verify.py").read_text(encoding="utf-8")
SECOND = "\n".join(path.read_text(encoding="utf-8") for path in sorted((TOOLS / "second").glob("*.mjs")))
Changes = tuple[str, str] | list[tuple[str, str]]


def replaced(text: str, changes: Changes) -> str:
    """A program with one condition replaced, which may stand in more than one place."""
    for condition, instead in changes if isinstance(changes, list) else [changes]:
        assert condition and text.count(condition) <= 1, condition
        text = text.replace(condition, instead)
    return text


@cache
def compiled(part: str) -> CodeType:
    """A statement of the first checker: of nearly two hundred checkers, each is like the others but for one or two."""
    return compile(part, "lax", "exec")


def statements(source: str) -> list[str]:
    """The parts of a program, each a statement with what stands before the next."""
    firsts = [
        min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", ()))]) for node in ast.parse(source).body
    ]
    lines = source.splitlines(keepends=True)
    return ["".join(lines[a - 1 : b - 1]) for a, b in pairwise([1, *firsts[1:], len(lines) + 1])]


PARTS = statements(SOURCE)


def lax(changes: Changes) -> Any:
    """The first checker without one condition."""
    assert all(SOURCE.count(condition) == 1 for condition in conditions_in(changes)), changes
    module = ModuleType("lax")
    parts = [replaced(part, changes) for part in PARTS]
    assert "".join(parts) == replaced(SOURCE, changes)
    for part in parts:
        exec(compiled(part), module.__dict__)
    return module


def lax_second(changes: Changes, folder: Path) -> Path:
    """The second checker without one condition, as a program in a folder."""
    assert all(SECOND.count(condition) == 1 for condition in conditions_in(changes)), changes
    shutil.copytree(TOOLS / "second", folder / "second")
    shutil.copy(TOOLS / "verify.mjs", folder / "verify.mjs")
    for path in (folder / "second").glob("*.mjs"):
        path.write_text(replaced(path.read_text(encoding="utf-8"), changes), encoding="utf-8")
    return folder / "verify.mjs"


def conditions_in(changes: Changes) -> list[str]:
    """What is replaced."""
    return [condition for condition, _ in (changes if isinstance(changes, list) else [changes])]


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


CONDITIONS: dict[str, tuple[Changes, Changes | None, Callable[[], Told]]] = {
    "there is an instant": (
        ('(timed and told["instants"])', "timed"),
        None,  # at the end the second one takes all flights up again
        nothing_told_up_to_a_horizon,
    ),
    "what is listed comes to gap zero": (
        ("refuse(age and not self.met[c]", "refuse(0 and not self.met[c]"), ("sign === 0 && this.signed(law('speed')", "0 && this.signed(law('speed')"),
        forged.touching_all_along,
    ),
    "what is listed had not been at gap zero": (
        ("refuse(age and not self.met[c]", "refuse(0 and not self.met[c]"), ("sign === 0 && this.signed(law('speed')", "0 && this.signed(law('speed')"),
        forged.later_than_it_touches,
    ),
    "instants come one after the other": (
        ("if age and not turn: demand(", "if 0: demand("),
        ("if (s <= 0) refute('it does not come after", "if (0) refute('it does not come after"), forged.sooner,
    ),
    "what is listed has gap zero": (
        ("if self.met or told or not age: refuse(", "if 0: refuse("),
        ("refute(`${c.name} is not at gap zero`)", "void 0"), forged.no_gap_zero,
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
        ("self.due != turn or ", ""), ("if (k && this.due !== turn) refute(", "if (0) refute("),
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
        ("if (last && run.events !== end.limit) refute(", "if (0) refute("), lambda: forged.events(2),
    ),
    "no instant is after the set time": (
        ("refuse(-1 in signs.values(), ", "refuse(0, "),
        ("if (s < 0) refute(`it is not so", "if (0) refute(`it is not so"),
        lambda: of(Scene(PAIR), MEET, end=STOPPED, reverse_at="5"),
    ),
    "no end is before the set time": (
        ('if reason not in ("events", "stopped") and', "if reason == 0 and"),
        ("if (end.reason === 'quiet' && reverseAt && !run.turnTime) refute(", "if (0) refute("),
        lambda: of(Scene(PAIR), reverse_at="50"),
    ),
    "signs turn with the velocities": (
        ("{c: -sign for c, sign in self.known.items()}", "dict(self.known)"),
        ("sign: turn ? -x.sign : x.sign", "sign: x.sign"), forged.through_each_other,
    ),
    "impulses push": (
        ("for impulse in balls:", "for impulse in ():"),
        ("if (sign <= 0) refute(`${contacts[a].name} does not push`)", ""), forged.into_two_points,
    ),
    "impulses turn the closing speed round": (
        ('refuse(self.sign("slack", c), f"{c} push otherwise")', "0"),
        ("if (s) refute(`the impulse of", "if (0) refute(`the impulse of"),
        lambda: of(Scene(PAIR), {"exact": "7", "met": [[0, 1]], "rounds": [[[0, 1, "2"]]]}),
    ),
    "who does not push is not pushed into": (
        ('self.sign("slack", c) < 0, f"', 'self.sign("slack", c) < -1, f"'),
        ("if (slack < 0) refute(", "if (0) refute("), forged.one_by_one,
    ),
    "one after the other is one after the other": (
        ('if self.policy != "simultaneous":', "if 0:"), ("if (!simultaneous) {", "if (0) {"),
        lambda: of(Scene([Circle(-3, 0, vx=1), Circle(0, 0), Circle(3, 0, vx=-1)]), tie_policy="sequential"),
    ),
    "who enters is told": (
        ('refuse(enter != sorted(map(tuple, entry.get("enter", ()))), ', "refuse(0, "),
        ("refute('not these circles enter pockets');", ""), forged.nobody_enters,
    ),
    "only the mirror holds to a wall": (
        (" and not (a * nx + b * ny + nx or d * nx + e * ny + ny)", ""), ("return [0, 1].every(k => isZero(", "return true || [0].every(k => isZero("),
        forged.held_to_a_floor,
    ),
    "only a shift holds two together": (
        (" and not any((a - ONE, b, d, e - ONE))", ""),
        ("if (![b, d, A.sub(a, one), A.sub(e, one)].every(x => A.sign(x) === 0)) return false;", ""), forged.nearly_turned,
    ),
    "what is taken is met no more": (
        [("self.meets = {c for c in self.meets if not", "self.meets = {c for c in self.meets if c[1] >= 0 or not"), ("Flight(*row, age, {}), self.pegs.add(i)", "Flight(*row, age, {}), 0")],
        ("if (!c || this.movers(c).some(x => this.captured[x])) refute(", "if (!c) refute("), forged.taken_and_yet_there,
    ),
    "an isometry's first column is of length 1": (
        ("a * a + d * d - ONE, ", ""), ("zero((A, w) => A.sub(A.add(A.square(a[w]), A.square(c[w])), one[w])", "void ((A, w) => 0"),
        lambda: forged.no_isometry(matrix=["2", "0", "0", "1"], map=[]),
    ),
    "an isometry's second column is of length 1": (
        ("b * b + e * e - ONE, ", ""), ("zero((A, w) => A.sub(A.add(A.square(b[w]), A.square(d[w])), one[w])", "void ((A, w) => 0"),
        lambda: forged.no_isometry(matrix=["1", "0", "0", "2"]),
    ),
    "an isometry's columns are at right angles": (
        (", a * b + d * e]", "]"), ("zero((A, w) => A.add(A.mul(a[w], b[w]), A.mul(c[w], d[w]))", "void ((A, w) => 0"),
        lambda: forged.no_isometry(matrix=["1", "3/5", "0", "4/5"]),
    ),
    "an isometry maps places": (
        ("else: zeros += [x, y, vx", "else: zeros += [vx"),
        ("same((A, w) => this.image(A, w, [p.x[w], p.y[w]], shift)[k], [q.x, q.y][k], what);", ""),
        lambda: forged.no_isometry(shift=["1", "0"]),
    ),
    "an isometry maps velocities": (
        ("[x, y, vx - wx, vy - wy, *(r", "[x, y, *(r"),
        ("if (kind === 'circle') same((A, w) => this.image(A, w, [p.vx[w], p.vy[w]])[k], [q.vx, q.vy][k], what);", ""),
        lambda: forged.no_isometry(matrix=["-1", "0", "0", "1"]),
    ),
    "an isometry maps radii": (
        ("zip(k, m, strict=False)", "zip(k[1:], m[1:], strict=False)"), ("same((A, w) => p.r[w], q.r, what);", ""),
        lambda: forged.shifted(r="1/2"),
    ),
    "an isometry maps masses": (
        ("zip(k, m, strict=False)", "zip(k[:1], m[:1], strict=False)"), ("if (kind === 'circle') same((A, w) => p.w[w], q.w, what);", ""),
        lambda: forged.shifted(m=2),
    ),
    "an isometry maps walls to parallel ones": (
        ("[vx * wy - vy * wx, *(s", "[*(s"),
        ("zero((A, w) => across(A, w, this.image(A, w, [A.sub(p.x1[w], p.x0[w]), A.sub(p.y1[w], p.y0[w])])), what);", ""),
        lambda: forged.beside_a_wall(matrix=["0", "-1", "1", "0"], shift=["9", "-9"]),
    ),
    "an isometry maps walls to where they are": (
        ("in ((x, y), stays, falls)", "in (stays, falls)"),
        ("return across(A, w, [A.sub(x, q.x0[w]), A.sub(y, q.y0[w])]);", "return A.sub(x, x);"),
        lambda: forged.beside_a_wall(shift=["1", "0"]),
    ),
    "no centre is on a wall": (
        ("demand(sign, [1, -1], f\"the centre", "demand(1, [1, -1], f\"the centre"),
        (" || refute(`the centre of circle ${i} is on wall ${wall.id}`)", ""), forged.centre_on_a_wall,
    ),
    "an isometry maps circles to circles": (
        ("            zeros += [ONE] * ((i < 0, i < self.n) != (j < 0, j < self.n))\n", ""),
        None,  # the second one has no circle by that number then
        forged.circle_to_pocket,
    ),
    "whose row is not mapped is struck out": (
        ("while bad := {i for i in hit & kept if strays(i)}: kept", "while bad := (): kept"),
        ("if (!this.rowMapped(", "if (0 && !this.rowMapped("), forged.a_blow_that_is_not_mapped,
    ),
    "an isometry takes no two to one": (
        ('refuse(len({*images.values()}) < len(told["map"]), ', "refuse(0, "),
        ("if (this.inverse.size !== given.map.length) refute(", "if (0) refute("), forged.two_to_one,
    ),
    "a wall is as long as is said": (
        ("demand(sign_of(p * p + q * q - z * z), ", "demand(0, "),
        ("demand((A, w) => A.sub(A.add(A.square(wall.n[0][w])", "void ((A, w) => A.sub(A.add(A.square(wall.n[0][w])"),
        lambda: forged.with_data(0, "walls", length="2"),
    ),
    "what is fixed has no velocity": (
        ("refuse((u or v) and not w, ", "refuse(0, "), ("for (const v of [c.vx, c.vy]) demand(", "for (const v of []) demand("),
        lambda: forged.with_data(1, vx="1"),
    ),
    "no radius is negative": (
        ("for x in (*sizes, *limits.values()): demand(", "for x in (): demand("),
        ("c.point = demand(c.r, [0, 1],", "c.point = demand(c.r, [-1, 0, 1],"), lambda: forged.with_data(0, r="-1"),
    ),
    "time 0 is time 0": (
        ("refuse(told and (turn or not age), ", "refuse(0, "), ("refute('it has a time already')", "void 0"),
        forged.a_time_at_the_start,
    ),
    "no contact is listed twice": (
        ("refuse(len({*met} & self.meets) < len(met) * (1 + turn), ", "refuse(0, "),
        ("refute('a contact meets twice')", "void 0"), forged.listed_twice,
    ),
    "what parts was not apart": (
        ("if age and self.met[c] > 0: self.clear(c, last=True)", "pass"),
        ("if (this.k && sign > 0) {", "if (0) {"), forged.an_overlap_that_ends,
    ),
    "something falls on an instant": (
        ("refuse(not (met or calm or turn or self.due or age == 0), ", "refuse(0, "), ("refute('nothing meets')", "void 0"),
        lambda: of(Scene(PAIR), {"exact": "3"}, MEET),
    ),
    "a reversal that is due is told": (
        ("(self.last is None and self.due) or ", ""), ("if (run.due && !last) refute(", "if (0) refute("),
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
        forged.a_round_too_many,
    ),
    "what pushes approaches": (
        [("refuse(len({*push} & {*coming}) < len(push), ", "refuse(0, "), ("c: self.meeting(c, age) for c in coming}", "c: self.meeting(c, age) for c in (*push, *coming)}")],
        ("new Map(list.map(x => [x.c.name, x]))", "new Map(group.map(x => [x.c.name, x]))"),
        forged.what_does_not_approach_pushes,
    ),
    "what pushes pushes once": (
        ("refuse(len({*push} & {*coming}) < len(push), ", "refuse(0, "),
        None,  # the second one has an impulse for each contact, and no more
        forged.pushed_by_halves,
    ),
    "the seed says which pushes": (
        ("self.draw(len(coming)) if self.draw and coming[1:] else 0", "0"), ("run.random.below(list.length)", "0"), forged.another_draw,
    ),
    "nothing more happens where it is quiet": (
        ("for c in self.meets: self.clear(c, None", "for c in (): self.clear(c, None"),
        ("run.apart(c, end.reason === 'quiet' ? 'ever' : 'end')", "void 0"), forged.nothing_told,
    ),
    "nothing else is met on a flight": (
        ("for c in found & self.meets: self.clear(", "for c in (): self.clear("), ("this.apart(c, 'flight')", "void 0"),
        forged.through_a_third,
    ),
    "what approaches is not apart for that": (
        ("rise in (0, 1) or disc == -1", "True"),
        ("if (closing >= 0) return;", "if (closing >= -1) return;"), forged.nothing_told,
    ),
    "what has a positive discriminant is not apart for that": (
        ("rise in (0, 1) or disc == -1", "rise in (0, 1) or disc == 1"), ("if (disc < 0 || (", "if (disc > 0 || ("), forged.nothing_told,
    ),
    "the tangent is above zero": (
        ("(m.gap + (closing + closing) * world.wait(*span)).sign() == 1", "(m.gap + (closing + closing) * world.wait(*span)).sign() == -1"),
        ("if (this.sign((A, w) => atStart(A, w)) > 0) return;", "if (this.sign((A, w) => atStart(A, w)) < 0) return;"),
        forged.through_a_third,
    ),
    "the gap is positive at the end too": (
        ("(safe and {*gaps} == {1})", "(safe and gaps[0] == 1)"), ("if (gapNow > 0) {", "if (1) {"),
        forged.beyond_the_end_of_a_horizon,
    ),
    "circles do not overlap": (
        ("(gaps == [-1] and c[1] < 0)", "(gaps == [-1])"),
        ("if (gap < 0 && c.kind === 'pocket') return;", "if (gap < 0) return;"), lambda: forged.with_data(1, x="1"),
    ),
    "what has a root is positive": (
        [('demand(sign_of(x := number(text)), [1], "what has', 'demand((x := number(text)) and 1, [1], "what has'),
         ('if self.m <= self.r: raise Unsettled("a number that may not be positive', 'if 0: raise Unsettled("a number that may not be positive')],
        [("if (square.hi <= 0n) malformed(", "if (0) malformed("), ("if (square.lo <= 0n) undecided(", "if (0) undecided(")],
        forged.root_of_less_than_nothing,
    ),
    "what has an image that closes is closing": (
        ("first > abs(self.met[other])", "first"), ("first && image && other.sign === 0", "first && image"),
        forged.hardly_closing_by_its_image,
    ),
    "an image's closing is that before the rounds": (
        ('question == "closing" and not self.rows', 'question == "closing"'),
        ("question === 'closing' && first && image", "question === 'closing' && image"),
        forged.not_closing_as_before_the_round,
    ),
    "what lasts has no speed": (
        ('or not (known[c] or self.drops(c) or self.sign("speed", c))}', "or not known[c]}"),
        ("move as one`) === 0;", "move as one`) >= 0;"), forged.together_after_a_graze,
    ),
    "what lasts is not pushed": (
        ("(c in self.lasting and not moved & {*c})", "(c in self.lasting)"),
        ("if (x.lasted && !this.movers(x.c).some(i => rounds.pushed.has(i))) continue;", "if (x.lasted) continue;"),
        forged.lasting_though_pushed,
    ),
    "groups hang together through fixed circles too": (
        [("{*approaching[0]} & {*range(self.n)}", "{*approaching[0]} & self.movable"),
         ("circles.union(*more) & {*range(self.n)}", "circles.union(*more) & self.movable")],
        ("if (c.kind === 'circle') { const a = root(c.i)", "if (c.kind === 'circle' && !this.run.fixed[c.i] && !this.run.fixed[c.j]) { const a = root(c.i)"),
        forged.apart_at_a_shared_one,
    ),
    "each group has its rounds": (
        ("if not circles.isdisjoint(c)}", "if 1}"), ("append(groups, root(x.c.i), x)", "append(groups, 0, x)"),
        lambda: forged.groups([[0, 1], [2, 3]]),
    ),
    "groups come in order": (
        ("sorted(c for c in known if known[c] < 0 <= c[1]):  # the", "sorted((c for c in known if known[c] < 0 <= c[1]), reverse=True):  # the"),
        ("active.sort((a, b) => a.first.c.key - b.first.c.key)", "active.sort((a, b) => b.first.c.key - a.first.c.key)"),
        lambda: forged.groups([[2, 3]], [[0, 1]]),
    ),
    "the first contact comes first": (
        ("self.draw and coming[1:] else 0", "self.draw and coming[1:] else -1"), ("run.random.below(list.length) : 0]", "run.random.below(list.length) : list.length - 1]"),
        forged.the_last_first,
    ),
    "closing speeds are signed again": (
        ("for c in sorted(group) if hit & {*c}}", "for c in push}"), ("some(i => moved.has(i))) {", "some(i => moved.has(i)) && pushing.has(x)) {"),
        forged.a_blow_that_is_not_passed_on,
    ),
    "what has parted may come back": (
        ("for c, since in self.parted.items() if not moved & {*c}}", "for c, since in self.parted.items()}"),
        ("k !== undefined && this.movers(c).every(i => this.turnedAt[i] <= k)", "k !== undefined"),
        forged.met_again_after_a_wall,
    ),
    "no instant is after the end": (
        ("refuse(-1 in signs.values(), ", "refuse(0, "), ("if (s < 0) refute(`it is not so", "if (0) refute(`it is not so"),
        forged.beyond_a_horizon,
    ),
    "fixed circles do not meet": (
        ("if self.movable & {i, j}", "if 1"), ("(a.fixed && b.fixed) || ", ""), forged.fixed_ones_meet,
    ),
    "points do not meet": (
        [("(j >= first or not self.points(i, j))", "1"), ("refuse(c[0] < c[1] < self.n and self.points(*c), ", "refuse(0, ")],
        [(" || (a.point && b.point && !b.end)", ""), ("if (c.blunt) refute(", "if (0) refute(")], forged.two_points_meet,
    ),
    "what was hit by what is struck out is struck out": (
        ("return by - kept or like != ", "return like != "),
        ("if (!out.has(i) && (rows.get(i) ?? []).some(", "if (0 && (rows.get(i) ?? []).some("),
        forged.struck_out_with_what_it_hit,
    ),
    "what a mirror holds to a wall it maps to itself": (
        ("images.get(i) == i in kept", "i in kept"), ("this.map.get(c.i) !== c.i || ", ""), forged.a_mirror_of_another,
    ),
    "the way back shows gaps and the return": (
        ('back = question == "gap" or (question == "until" and self.end["reason"] == "return")', "back = True"),
        ("if (question !== 'gap' && (question !== 'until' || run.certificate.end.reason !== 'return')) continue;", ""),
        forged.hardly_closing_on_the_way_back,
    ),
    "the way back ends at the return": (
        ('(question == "until" and self.end["reason"] == "return")', 'question == "until"'),
        (" || run.certificate.end.reason !== 'return'", ""), forged.after_a_horizon_by_the_way_back,
    ),
    "what comes back was there": (
        ("{c, other} <= self.out[-1][1]", "{other} <= self.out[-1][1]"), ("last.known.has(a) && ", ""),
        forged.what_was_hardly_apart,
    ),
    "what comes back with it was there": (
        ("{c, other} <= self.out[-1][1]", "{c} <= self.out[-1][1]"), (" && last.known.has(b)", ""),
        forged.by_what_was_hardly_apart,
    ),
    "a rim does not tell when the way back is": (
        ("{c for c in known if c[1] >= 0}", "{*known}"), ("x.c.kind !== 'pocket').map(", "true).map("),
        forged.by_a_rim_that_is_crossed_twice,
    ),
    "the way back undoes what was": (
        ("-1 if [back] == [x for x, _ in self.out[-1:]] else 0:", "-1:"), ("if (!same) this.retraced = false;", ""),
        back_after_rounds_that_do_not_go_back,
    ),
    "the way back undoes the last round first": (
        ("rows[::-1] for i, rows in pushes", "rows for i, rows in pushes"), ("r === out[out.length - 1 - k]", "r === out[k]"),
        forged.the_same_order_back,
    ),
    "a pocket has a positive radius": (
        ("for x in (*sizes, *limits.values()): demand(", "for x in (): demand("),
        ("demand(p.r, [1], `the radius", "demand(p.r, [-1, 1], `the radius"), lambda: forged.with_a_pocket("-1"),
    ),
    "no weight is negative": (
        ("for x in (*sizes, *limits.values()): demand(", "for x in (): demand("),
        ("demand(c.w, [0, 1],", "demand(c.w, [-1, 0, 1],"), lambda: forged.with_data(0, w="-1"),
    ),
    "a length is positive": (
        ("for x in (*sizes, *limits.values()): demand(", "for x in (): demand("),
        ("demand(wall.length, [1],", "demand(wall.length, [-1, 1],"), lambda: forged.with_data(0, "walls", length="-1"),
    ),
    "a reversal is after time 0": (
        ("(*sizes, *limits.values())", "sizes"), ("if (this.reverseAt) demand(", "if (0) demand("),
        lambda: forged.entries(forged.of_no_sense(scene={"reverse_at": "0"}), None, {"turn": True}),
    ),
    "a horizon is after time 0": (
        ("(*sizes, *limits.values())", "sizes"), ("if (this.until) demand(", "if (0) demand("),
        lambda: forged.of_no_sense(end={"reason": "horizon", "until": "0"}),
    ),
    "names differ": (
        ("refuse(len(ids) < len(things), ", "refuse(0, "), ("if (new Set(ids).size !== ids.length) malformed(", "if (0) malformed("),
        lambda: forged.with_data(0, "walls", id=told(Scene(PAIR))["scene"]["circles"][0]["id"]),
    ),
    "there is one reversal": (
        ('refuse({"reverse_at", "reverse_after"} <= scene.keys(), ', "refuse(0, "),
        ("if (scene.reverse_after !== undefined && scene.reverse_at !== undefined) malformed(", "if (0) malformed("),
        lambda: forged.of_no_sense(scene={"reverse_at": "5", "reverse_after": 1}),
    ),
    "a witness names an isometry that there is": (
        ("refuse(hows - {*range(len(maps))}, ", "refuse(0, "),
        ("if (how !== 'back' && how >= c.isometries.length) malformed(", "if (0) malformed("),
        lambda: forged.entries(forged.of_no_sense(), {"zeros": [["gap", [0, 1], 7]]}),
    ),
    "an isometry maps one to one": (
        ('refuse(len({*images.values()}) < len(told["map"]), ', "refuse(0, "),
        ("if (this.map.size !== given.map.length) refute(", "if (0) refute("),
        lambda: forged.no_isometry(map=[[0, 1], [0, 0]]),
    ),
    "nothing meets at a reversal": (
        ("len(met) * (1 + turn)", "len(met)"), ("if (turn && e.met) refute(", "if (0) refute("), forged.met_at_a_reversal,
    ),
    "what is not shown is not decided": (
        ('raise Unsettled(f"{c}: nothing shows', 'return 0\n        raise Unsettled(f"{c}: nothing shows'),
        [("undecided(`no witness shows it: ${what}`);", ""), ("if (!answers.length) undecided(what);", "")],
        lambda: forged.unshown(forged.nearly_alike()),
    ),
    "whether two keep apart is decided": (
        ('raise Unsettled(f"whether {c} meet before it")', "return"), ("    undecided(what);\n  }\n\n  /** As `apart`", "  }\n\n  /** As `apart`"),
        forged.hardly_a_hit,
    ),
    "an image is that of the other": (
        ("self.image(images, c) == other", "1"), (" && g.contact(c)?.key === other.c.key;", ";"), forged.nearly_alike,
    ),
    **SEGMENT_CONDITIONS,
    **WORLD_CONDITIONS,
    **PEG_CONDITIONS,
    **SETTLE_CONDITIONS,
}  # fmt: skip


@needs_node
@pytest.mark.parametrize("name", CONDITIONS)
def test_no_condition_is_idle(name: str, tmp_path: Path) -> None:
    first, second, make = CONDITIONS[name]
    checker = lax(first)
    cert = completed(make(), checker)
    path = tmp_path / "lax.json"
    path.write_text(certificate_json(cert), encoding="utf-8")
    code, sentence = checker.verdict(path)
    assert code == 0, sentence
    if second is not None:
        code, lines = printed_by(lax_second(second, tmp_path / "lax"), [path])
        assert code == 0, lines
    refused_by_both(cert, tmp_path / "forged.json")


ELSEWHERE = {
    "its {key} is not of its shape": "test_bad_files",
    "units of work; --work=N": "test_cost",
    "bytes; --work=N": "test_cost",
    "a product has too many terms": "test_cost",
    "numbers of unlike bits meet": "test_checker_numbers",
    "a number that may be zero divides": "test_checker_numbers",
    "it has over {ROOTS} roots": "test_bad_files",
    "it has too many circles": "test_bad_files",
    "its end is of other circles": "test_bad_files",
    "an isometry maps otherwise": "each of the zeros that it is asked of stands above",
    "meet before it or overlap": "what it refutes would not be decided in the next lines",
    "a number: {text[:40]}": "DECIMALS",
    "the reversal is first": "the line before it stands above",
    "a key comes twice": "test_bad_files",
    "a number of over 15 digits": "test_bad_files",
    "it is no regular file": "test_bad_files",
    "it is longer than {BYTES} bytes": "test_bad_files",
    "the format is not {FORMAT}": "test_bad_files",
    "(Unsettled if sign is None else fault)(text)": "it is how all are asked",
    "overlap, or touch from the start": "the line that asks for it stands above",
    "meet on the way": "what it refutes would not be decided in the next lines",
    "touch as the flight ends": "the line before it stands above",
    "whether a gap falls all the time that is said": "without it a quotient would be none",
    "a gap does not fall through zero where it is said": "DECIMALS: what is found instead is not where it is said",
    # and of the second one
    "the scene has no thing": "test_agreement",
    "refuse(others and (": "each of the two ways not to do so stands above",
    "an instant without a time": "without it there is none",
    "hold it": "a sign that is not known is none of those that are wanted",
    "undecided('how ": "without a quotient there is none",
    "undecided(`how fast": "without a quotient there is none",
    "does not leave`)": "what is not known has no sign to change",
    "undecided(`${name}: whether ${what}`)": "each of the zeros stands above",
    "refute(`${name}: it is not so that ${what}`)": "each of the zeros stands above",
    "which is another kind": "there is no circle by that number then",
    "does not approach, and is said to push": "the list of those that approach stands above",
    "a contact pushes twice in a round": "there is one impulse for each contact then",
    "it is ${block[0].c.name} that pushes": "`if (!simultaneous)` stands above",
    "whether ${contacts[a].name} pushes": "a sign that is not known is not positive",
    "is as told`)": "a sign that is not known is not zero",
    "whether the impulses are determined": "without a quotient there is none",
    "?? stuck()": "without a quotient there is none",
    "known(law, what)": "a sign that is not known",
    "overlaps where its flight starts": "pockets and their gaps stand above",
    "meet, which is not told": "what it refutes would not be decided in the next lines",
    "the first instant is a reversal": "no reversal is due at the first instant",
    "does not hit`)": "a time without a root is none",
    "when ${name} hits`)": "a time without a root is none",
    "is not as its decimal says": "DECIMALS",
    "at gap zero all the time": "the line before it stands above",
    "is at gap zero and parts": "the line before it stands above",
    "is on the rim and not told": "test_forgeries",
    "falls all the time that is told": "without it a quotient would be none",
    "hits when it is told": "a sign that is not known is not the one that is wanted",
    "does not fall through zero when it is told": "DECIMALS: what is found instead is not where it is told",
    "undecided(`when ${what} hits`)": "without a quotient there is none, and two intervals with one zero meet",
    "=== 0) refute(`${c.name} comes from behind`)": "it is in a segment, or came into one: that is refuted as it does",
    "the scene: whether ${what}": "each of the demands stands above",
    "no scene: it is not so that ${what}": "each of the demands stands above",
}
"""What else either checker raises, and where that is tried."""

RAISES = re.compile(r"\b(?:refuse|demand|refute|malformed|undecided|stuck)\(|\braise ")
FOLLOWS = ("run", "rounds", "isometry", "back", "witness", "end", "scene", "quartic", "calm")
"""Modules of the second checker that follow a run; what the others refuse is no certificate (test_bad_files)."""


@pytest.mark.parametrize("name", ["verify.py", *(f"{module}.mjs" for module in FOLLOWS)])
def test_each_condition_of_the_programs_has_its_forgery(name: str) -> None:
    first = name == "verify.py"
    text = SOURCE if first else (TOOLS / "second" / name).read_text(encoding="utf-8")
    changes = [one if first else other for one, other, _ in CONDITIONS.values()]
    tried = [condition for change in changes if change is not None for condition in conditions_in(change)]
    tried += [str(row[0 if first else 1]) for row in DECIMALS.values()]
    spans = [found.span() for part in [*tried, *ELSEWHERE] for found in re.finditer(re.escape(part), text)]
    end = 0
    for line in text.splitlines(keepends=True):
        start, end = end, end + len(line)
        if RAISES.search(line) and not line.startswith(("def ", "import ", "export const")):
            assert any(a < end and b > start for a, b in spans), f"no forgery is kept out by this alone: {line}"


def test_nothing_is_said_to_be_tried_that_is_not_there() -> None:
    assert [part for part in ELSEWHERE if part not in SOURCE and part not in SECOND] == []


DECIMALS = {
    "a place in the end": ("final", "run.decimal(p, row[a], `${'xy'[a]} of circle ${i}`);", "final", "circles", 1, 0),
    "a velocity in the end": (
        "final",
        "run.decimal(fall ? v.map((x, w) => worlds[w].add(x, fall[w].speed[a])) : v, row[2 + a], `v${'xy'[a]} of circle ${i}`);",
        "final",
        "circles",
        1,
        2,
    ),
    "the final time": (
        'self.said(self.ball.times[self.age], self.told["final"]["time"])',
        "run.decimal(run.now, final.time, 'the time');",
        "final",
        "time",
    ),
    "the time of an instant": (
        'self.said(self.ball.times[age], entry["time"])',
        "this.decimal(this.now, e.time, 'the time');",
        "instants",
        1,
        "time",
    ),
}


@needs_node
@pytest.mark.parametrize("name", DECIMALS)
def test_numbers_are_as_their_decimals_say(name: str, tmp_path: Path) -> None:
    first, second, *place, last = DECIMALS[name]
    cert = told(Scene(PAIR))
    part: Any = cert
    for key in place:
        part = part[key]
    part[last] = "1234.5"
    path = tmp_path / "decimal.json"
    path.write_text(certificate_json(cert), encoding="utf-8")
    checker = lax(("self.said(x, text)" if first == "final" else str(first), "pass"))
    assert checker.verdict(path)[0] == 0
    code, lines = printed_by(lax_second((str(second), ""), tmp_path / "lax"), [path])
    assert code == 0, lines
    refused_by_both(cert, tmp_path / "forged.json")
