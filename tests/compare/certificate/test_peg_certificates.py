"""Certificates of what stands where others fall: both checkers verify them; altered at random they are refused, or still
true; and faults planted in the laws of both are found."""
# ruff: noqa: E501 (lines of the checkers stand here as they are)

from __future__ import annotations

from decimal import Decimal
from functools import cache
from pathlib import Path

import pytest

from certificate.checkers import Lot, both_verify, by_python, lot_of, mistaken, needs_node
from certificate.peg_forgeries import PEG_CONDITIONS
from certificate.peg_samples import (
    BOW_WAYS,
    PEG_WAYS,
    bow_runs,
    bow_samples,
    bow_scene_of,
    bows_by_hand,
    by_hand,
    peg_runs,
    peg_samples,
)
from certificate.test_conditions import completed, lax, lax_second
from certificate.test_tampering import WAYS, altered, refused
from truebreak.compare.certificate import CertificateError, certificate_json, certificate_of
from truebreak.compare.certificate.certified import difference
from truebreak.exact import ExactEngine
from truebreak.exact.exact_motion import ExactValue
from truebreak.scenarios import Arc, Circle, Pocket, Scene, Segment, StopReason, Wall

FLOOR, LOW = (Wall(-9, y, 9, y, id="floor") for y in (-8, -7))


def ball(x: int, y: int, vx: int = 0, vy: int = 0) -> Circle:
    return Circle(x, y, r=1, vx=vx, vy=vy, id="ball")


def peg(x: int | str, y: int | str) -> Circle:
    return Circle(x, y, r=1, m="oo", id=f"peg {x} {y}")


def test_both_verify_runs_among_what_stands_under_gravity(tmp_path: Path) -> None:
    samples = peg_samples()
    assert sum(len(told["instants"]) for told in samples.values()) > 300
    listed = [told for told in samples.values() for entry in told["instants"][1:] if falls_on(told, entry)]
    assert len(listed) > 60
    assert sum("segments" in told["scene"] for told in samples.values()) > 20
    both_verify(samples.items(), tmp_path)


def falls_on(told: dict[str, object], entry: dict[str, list[list[int]]]) -> bool:
    """Whether the time of an instant is that at which a circle falls onto a fixed one, or onto an end."""
    scene = told["scene"]
    assert isinstance(scene, dict)
    circles, (i, j) = scene["circles"], entry["met"][0]
    ends = {(row[f"x{k}"], row[f"y{k}"]) for row in scene.get("segments", ()) for k in (0, 1)}
    return "0" in [circles[k]["w"] if k < len(circles) else "0" for k in (i, j) if k < len(circles) + len(ends)]


def test_both_verify_runs_among_arcs_and_rims_under_gravity(tmp_path: Path) -> None:
    samples = bow_samples()
    onto = [
        (push[1] - len(told["scene"]["circles"])) % 2  # of a full ring alone: its outside is even
        for told in samples.values()
        for entry in told["instants"]
        for round_ in entry.get("rounds", ())
        for push in round_
        if set(told["scene"]) & {"walls", "segments"} == set() and "x0" not in told["scene"]["arcs"][0]
    ]
    assert 0 in onto and 1 in onto
    assert sum(len(entry.get("enter", ())) for told in samples.values() for entry in told["instants"]) > 10
    both_verify(samples.items(), tmp_path)


@needs_node
@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_both_verify_hundreds_of_random_runs_among_arcs_and_rims(tmp_path: Path) -> None:
    drawn = {f"more {k}": scene for k in range(100, 600) if (scene := bow_scene_of(k)) is not None}
    both_verify(((name, certificate_of(ExactEngine().run(scene, events=8))) for name, scene in drawn.items()), tmp_path)
    assert len(drawn) > 400


def test_the_final_state_is_that_of_the_run() -> None:
    for name, run in {**peg_runs(), **bow_runs()}.items():
        told = {**peg_samples(), **bow_samples()}[name]
        if told["end"]["reason"] not in ("horizon", "events"):
            continue
        final = run.at(run.final_time)
        mine = [final.time, *(x for c in final.circles for x in (c.x, c.y, c.vx, c.vy))]
        rows = [told["final"]["time"], *(x for row in told["final"]["circles"] for x in row)]
        for said, number in zip(rows, mine, strict=True):
            assert abs(Decimal(said) - Decimal(number.digits(30))) < Decimal(10) ** -16, name


def test_mirrored_falls_need_no_number_in_radicals() -> None:
    told = peg_samples()["mirrored"]
    assert any(zero[0] == "gap" for entry in told["instants"] for zero in entry.get("zeros", ()))
    assert not any("exact" in entry for entry in told["instants"])


def test_a_certificate_is_compared_with_the_pegs_that_are_meant() -> None:
    scene = Scene([Circle(0, 4), Circle(9, 4, m="oo", id="peg")], [Wall(0, 0, 1, 0)], gravity=(0, -1))
    block = certificate_of(ExactEngine().run(scene, events=2))["scene"]
    assert difference(block, scene) is None
    free = scene.with_changes(circles=[scene.circles[0], Circle(9, 4, id="peg")])
    assert "circle 'peg'" in str(difference(block, free))


@needs_node
@pytest.mark.parametrize("count", [140, pytest.param(3000, marks=pytest.mark.slow)])
@pytest.mark.timeout(3600)
def test_altered_runs_among_what_stands_are_refused_or_shown_to_be_true(count: int, tmp_path: Path) -> None:
    tried = altered(count, (*PEG_WAYS, *WAYS), "pegsA", peg_samples())
    assert refused(tried, tmp_path) > count // 2


@needs_node
@pytest.mark.parametrize("count", [140, pytest.param(3000, marks=pytest.mark.slow)])
@pytest.mark.timeout(3600)
def test_altered_runs_among_arcs_and_rims_are_refused_or_shown_to_be_true(count: int, tmp_path: Path) -> None:
    tried = altered(count, (*BOW_WAYS, *WAYS), "bowsA", bow_samples())
    assert refused(tried, tmp_path) > count // 2


FAULTS = {
    "what stands falls too": (
        [("if falls := self.drops(c):", "if falls := j < 0:")],
        [("if (c.drops) return this.dropping(", "if (pocket && c.drops) return this.dropping(")],
    ),
    "gravity the other way": (
        [("if i not in self.pegs: x, y,", "if i in self.pegs: x, y,")],
        [("A.sub(A.add(place[k], by[k]), centre[k])", "A.sub(A.sub(place[k], by[k]), centre[k])")],
    ),
    "twice the pull": (
        [("bend, kind = self.at(*self.pull), ", "bend, kind = [x + x for x in self.at(*self.pull)], ")],
        [("A.neg(A.mul(x[w], this.half[w])) : A.mul(x[w], this.half[w])", "A.neg(x[w]) : x[w]")],
    ),
    "a cubic": (
        [("m.along(m.v), m.last])", "m.along(m.v)])")],
        [("A.twice(dot(v, a)), square(a)];", "A.twice(dot(v, a))];")],
    ),
    "the radius alone": (
        [("s if j < 0 else r + s, Nearing", "s, Nearing")],
        [(": A.add(this.circles[c.i].r[w], this.circles[c.j].r[w]));", ": this.circles[c.j].r[w]);")],
    ),
    "the zero at the start is not divided out": (
        [("start)).row[order:]", "start)).row"), (".row[order:], low - first", ".row, low - first")],
        [("all.slice(since.order)", "all"), (".quartic().slice(since.order)", ".quartic()")],
    ),
    "the zero at the end is not divided out": (
        [("for _ in range(ends): row", "for _ in (): row")],
        [("for (let k = 0; k < order; k++) row = divided", "for (let k = 0; k < 0; k++) row = divided")],
    ),
    "it is divided out with the wrong sign": (
        [("initial=-row[-1]", "initial=row[-1]")],
        [("const out = [A.neg(row.at(-1))];", "const out = [row.at(-1)];")],
    ),
    "the first half of a flight alone": (
        [("        sides = [[*map(shift, pair)]", "        if not ever: continue\n        sides = [[*map(shift, pair)]")],
        [("for (const half of [0, 1]) parts", "for (const half of [0]) parts")],
    ),
    "the ends of a flight alone": (
        [("if min(row) >= 0 < row[0]: return True", "if row[0] > 0 < sum(row): return True")],
        [("&& least.every(x => x >= 0n)", "")],
    ),
    "nothing beyond the first part of for ever": (
        [("        sides = [[*map(shift, pair)]", "        if ever: continue\n        sides = [[*map(shift, pair)]")],
        [("if (!wait) parts.push(", "if (0) parts.push(")],
    ),
    "the final place of what stands falls": (
        [("falls = self.put(i, age)[:4], self.pull and i not in self.pegs", "falls = self.put(i, age)[:4], self.pull")],
        [("const fall = gravity && !run.scene.stands(i) && !run.captured[i] && worlds", "const fall = gravity && worlds")],
    ),
    "what a pocket takes falls on": (
        [("Flight(*row, age, {}), self.pegs.add(i)", "Flight(*row, age, {}), 0")],
        [("!run.scene.stands(i) && !run.captured[i] && worlds", "!run.scene.stands(i) && worlds")],
    ),
    "what a pocket takes stands where the frame has it": (
        [("enumerate(self.true(i, age))]", "enumerate(self.put(i, age)[:4])]")],
        [("if (fall) f.p = f.p.map(", "if (0) f.p = f.p.map(")],
    ),
    "the rising zero of a face": (
        [("(m.closing if again else m.disc.sqrt())", "(m.closing if again else -m.disc.sqrt())")],
        [("arc ? full.div(full.neg(full.add(laws.closing(), root)), laws.speed())", "arc ? full.div(full.neg(full.sub(laws.closing(), root)), laws.speed())")],
    ),
    "a foot that is not pulled": (
        [("(m.slide + lift * wait) * wait", "m.slide * wait")],
        [("A.mul(A.mul(along(this.gravity.map(x => x[w])), this.half[w]), wait)", "A.zero")],
    ),
    "a face that is nowhere": (
        [("return -1 if -1 in signs else None if None in signs else min(signs)", "return -1")],
        [("if (reads.some(s => s < 0 || (s === 0 && c.face))) return;", "return;")],
    ),
    "the range of an arc as if nothing fell": (
        [("for x, y in (m.v, m.bend)]\n", "for x, y in (m.v,)]\n")],
        [("[d, own, this.halved(w, A, -1)].map((x, k)", "[d, own].map((x, k)")],
    ),
    "an arc where it is not": (
        [("[-m.foot, *ways]]", "[m.foot, *(-x for x in ways)]]")],
        [("A.neg(range(x, k ? A.zero : reach))", "range(x, k ? A.zero : reach)")],
    ),
    "an arc that falls too": (
        [("if self.pull: x, y, vx, vy = map(operator.add", "if 0: x, y, vx, vy = map(operator.add")],
        [("const d = fall ? minus(to, fall.by) : to, own = fall ? minus(way, fall.speed) : way;", "const d = to, own = way;")],
    ),
    "from within as from without": (
        [("m.turn(m.along(m.v)), m.turn(m.last)])", "m.along(m.v), m.last])")],
        [("quartic: () => this.quartic(A, w, d, own, -1, reach).map(turn)", "quartic: () => this.quartic(A, w, d, own, -1, reach)")],
    ),
    "a rim that is left is entered": (
        [("[row, [-x for x in row], slope_of(m.row)]", "[row, [-x for x in row], [-x for x in slope_of(m.row)]]")],
        [("row.map(x => A.neg(x)), slope(all)]", "row.map(x => A.neg(x)), slope(all.map(x => A.neg(x)))]")],
    ),
}  # fmt: skip
"""Of each what the first checker has instead, and the second."""


@cache
def lot() -> Lot:
    """Runs among pegs and between bows, and forgeries that miss one condition each."""
    samples = [peg_samples()[name] for name in by_hand()] + [bow_samples()[name] for name in bows_by_hand()]
    return lot_of(samples, [completed(make(), lax(first)) for first, _, make in PEG_CONDITIONS.values()], (1, 2, 4))


@needs_node
@pytest.mark.parametrize("fault", FAULTS)
def test_planted_faults_are_found(fault: str, tmp_path: Path) -> None:
    first, second = FAULTS[fault]
    mistaken(lax(first), lax_second(second, tmp_path / "faulty"), lot(), tmp_path)


GRAZED_ENDS = {
    "as it begins": Scene(
        [Circle("0", "0", vx="-12/5", vy="-9/5", id="d")],
        arcs=[Arc("-9/10", "6/5", "1/2", "-71/65", "108/65", "-1/2", "9/10"), Arc("9/10", "-6/5", "1/2", "46/65", "-48/65", "3/5", "-4/5")],
        tie_policy="sequential",
    ),
    "as another is hit": Scene(
        [Circle("-3/5", "9/20", vx="12/5", vy="-9/5")],
        arcs=[Arc("12/5", "16/5", 3, "21/5", "28/5", "3/5", "4/5"), Arc("8/5", "-6/5", 1, full=True)],
    ),
    "at rest": Scene(
        [Circle(0, 0, "1/2", vx="6/5", vy="8/5")],
        arcs=[
            Arc("-9/5", "-12/5", "7/2", "-409/130", "-366/65", "-39/10", "-26/5"),
            Arc("-8/5", "6/5", "5/2", "2/5", "-3/10", "-18/5", "-3/10"),
        ],
        restitution=0,
    ),
}  # fmt: skip


def test_both_verify_runs_that_graze_the_end_of_an_arc_or_rest_there(tmp_path: Path) -> None:
    """In fractions that balls do not tell from zero: each was without a certificate."""
    runs = {name: ExactEngine().run(scene, until="3/2") for name, scene in GRAZED_ENDS.items()}
    both_verify(((name, certificate_of(run)) for name, run in runs.items()), tmp_path)


BESIDE = {  # what a disc of radius 1 that falls touches without a blow, and how often
    "beside a peg, down and up again": (Scene([ball(2, 9), peg(0, 0)], walls=[FLOOR], gravity=(0, -2)), 4),
    "in no fractions, once it has bounced": (Scene([ball(2, 9), peg(0, 0)], walls=[LOW], gravity=(0, -2)), 4),
    "between two pegs, at one instant": (Scene([ball(2, 9), peg(0, 0), peg(4, 0)], gravity=(0, -2)), 1),
    "beside one peg and the other": (Scene([ball(2, 9), peg(0, 0), peg(4, -4)], gravity=(0, -2)), 2),
    "over the top of one": (Scene([ball(0, 0, 2, 1), peg(2, "-3/2")], gravity=(0, -1)), 1),
    "past the end of a segment": (Scene([ball(0, 9)], segments=[Segment(1, 0, 4, 0, id="bar")], gravity=(0, -2)), 1),
    "past an arc": (Scene([ball(3, 9)], arcs=[Arc(0, 0, 2, 0, -2, 0, 2, id="bow")], gravity=(0, -2)), 1),
}


@needs_node
@pytest.mark.parametrize("how", BESIDE)
def test_what_is_grazed_on_the_way_is_an_instant(how: str, tmp_path: Path) -> None:
    scene, grazes = BESIDE[how]
    run = ExactEngine().run(scene, until=14)
    assert run.stop.reason is StopReason.HORIZON
    told = certificate_of(run)
    listed = [entry for entry in told["instants"][1:] if "rounds" not in entry]
    assert len(listed) == grazes
    both_verify([("grazes", told)], tmp_path)
    for entry in listed:
        without = {**told, "instants": [other for other in told["instants"] if other is not entry]}
        path = tmp_path / "without.json"
        path.write_text(certificate_json(without), encoding="utf-8")
        assert by_python(path)[0] != 0


FACE, DISC = Segment(0, -4, 0, 0, id="face"), Circle(1, "-1/2", vy=5, id="disc")
HOLE = Pocket("7/6", -2, "1/2", id="hole")
PAST = {  # what slides along an upright face, past its end, and is beside it again where something happens to it, and how often
    "from beside it, thrice": (Scene([DISC], [Wall(0, -2, 1, -2)], segments=[FACE], gravity=(0, -10)), 3),
    "from beyond it, twice": (
        Scene([Circle(1, "1/2", id="disc")], [Wall(0, -2, 1, -2)], segments=[FACE], gravity=(0, -2)),
        2,
    ),
    "struck by another": (Scene([DISC, Circle(6, "-1/2", vx=-3, vy=5)], segments=[FACE], gravity=(0, -10)), 1),
    "taken at no exact time": (Scene([DISC], segments=[FACE], gravity=(0, -10), pockets=[HOLE], capture=True), 1),
    "after a blow along it": (
        Scene([DISC, Circle(1, 5)], segments=[FACE], gravity=(0, -2), pockets=[HOLE], capture=True),
        1,
    ),
}


@needs_node
@pytest.mark.parametrize("how", PAST)
def test_what_slides_past_an_end_and_back_touches_the_face(how: str, tmp_path: Path) -> None:
    scene, times = PAST[how]
    told = certificate_of(ExactEngine().run(scene, until=4))
    face = len(scene.circles) + 2 + len(scene.walls)
    listed = [entry for entry in told["instants"][1:] if any(j == face + 1 for _, j in entry.get("met", ()))]
    assert len(listed) == times
    both_verify([("past", told)], tmp_path)
    for entry in listed:
        entry["met"] = [c for c in entry["met"] if c[1] != face + 1]
        path = tmp_path / "without.json"
        path.write_text(certificate_json(told), encoding="utf-8")
        assert by_python(path)[0] != 0


@needs_node
def test_what_flies_along_a_face_after_a_blow_is_apart_from_it(tmp_path: Path) -> None:
    """Its speed across the face is zero, which is not told: it is apart from the face before and after, and so between."""
    discs = [Circle(1, 4, vy=3), Circle(4, 3, vx=-3, vy=4)]
    scene = Scene(discs, [Wall(0, -8, 1, -8)], segments=[Segment(0, -3, 0, 0)], gravity=(0, -10))
    both_verify([("apart", certificate_of(ExactEngine().run(scene, until=12, events=3)))], tmp_path)


FIRST, SECOND = Pocket(0, 2, 2, id="first"), Pocket("12/13", "5/13", 1, id="second")
ENTERS = Circle(-2, -22, vx=1, vy=21)
THIRD = Pocket("3/5", "4/5", 1, id="third")
RIMS = {  # of what a centre enters two rims at once or three, when, how many
    "captured": (Scene([ENTERS], pockets=[FIRST, SECOND], capture=True, gravity=(0, -10)), "2", 2),
    "passing through": (Scene([ENTERS], pockets=[FIRST, SECOND], gravity=(0, -10)), "2", 2),
    "three": (Scene([ENTERS], pockets=[FIRST, THIRD, SECOND], capture=True, gravity=(0, -10)), "2", 3),
    "at a root": (
        Scene([Circle(0, 10)], pockets=[Pocket("3/5", "-4/5", 1), Pocket("4/5", "-3/5", 1)], gravity=(0, -10)),
        "1*r1",
        2,
    ),
}


@needs_node
@pytest.mark.parametrize("how", RIMS)
def test_a_centre_enters_several_rims_at_once(how: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The run knows when that is; where it does not, that is said."""
    scene, time, rims = RIMS[how]
    run = ExactEngine().run(scene, until=4)
    told = certificate_of(run)
    entered = next(entry for entry in told["instants"] if len(entry.get("enter", ())) > 1)
    assert (entered["exact"], len(entered["enter"])) == (time, rims)
    both_verify([("rims", told)], tmp_path)
    entered["enter"].pop()
    path = tmp_path / "without.json"
    path.write_text(certificate_json(told), encoding="utf-8")
    assert by_python(path)[0] == 1
    monkeypatch.setattr(ExactValue, "exact", lambda _: None)
    with pytest.raises(CertificateError, match="meet at it"):
        certificate_of(run)
