"""Certificates of what stands where others fall: both checkers verify them; altered at random they are refused, or still
true; and faults planted in the laws of both are found."""
# ruff: noqa: E501 (lines of the checkers stand here as they are)

from __future__ import annotations

import subprocess
from decimal import Decimal
from pathlib import Path

import pytest

from certificate.checkers import both_verify, by_python, needs_node
from certificate.peg_forgeries import PEG_CONDITIONS
from certificate.peg_samples import PEG_WAYS, by_hand, peg_runs, peg_samples
from certificate.test_conditions import completed, lax, lax_second
from certificate.test_tampering import WAYS, altered, refused
from truebreak.compare.certificate import certificate_json, certificate_of
from truebreak.compare.certificate.certified import difference
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Scene, Wall


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


def test_the_final_state_is_that_of_the_run() -> None:
    for name, run in peg_runs().items():
        told = peg_samples()[name]
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


FAULTS = {
    "what stands falls too": (
        [("if peg := self.pegs & {*c}:", "if peg := set():")],
        [("if (c.drops) return this.dropping(", "if (0) return this.dropping(")],
    ),
    "gravity the other way": (
        [("if j in peg: x, y,", "if i in peg: x, y,")],
        [("A.sub(A.add(place[k], by[k]), centre[k])", "A.sub(A.sub(place[k], by[k]), centre[k])")],
    ),
    "twice the pull": (
        [("bend = self.at(*self.pull)", "bend = [x + x for x in self.at(*self.pull)]")],
        [("half = this.gravity.map(x => A.mul(x[w], this.half[w]))", "half = this.gravity.map(x => x[w])")],
    ),
    "a cubic": (
        [("m.along(m.v), m.last])", "m.along(m.v)])")],
        [("A.twice(dot(fast, half)), square(half)],", "A.twice(dot(fast, half))],")],
    ),
    "the radius alone": (
        [("s if j < 0 else r + s, Nearing", "s, Nearing")],
        [("A.square(A.add(this.circles[c.i].r[w], this.circles[c.j].r[w])));", "A.square(this.circles[c.j].r[w]));")],
    ),
    "the zero at the start is not divided out": (
        [(".row[order:], None", ".row, None"), (".row[order:], low - first", ".row, low - first")],
        [(".quartic().slice(order)", ".quartic()")],
    ),
    "the zero at the end is not divided out": (
        [("for _ in range(ends): row", "for _ in (): row")],
        [("for (let k = 0; k < order; k++) row = divided", "for (let k = 0; k < 0; k++) row = divided")],
    ),
    "it is divided out with the wrong sign": (
        [("rest = [-row[-1]]", "rest = [row[-1]]")],
        [("const out = [A.neg(row.at(-1))];", "const out = [row.at(-1)];")],
    ),
    "the first half of a flight alone": (
        [("            parts += [(low, high, False, depth + 1)]\n        low, high = shift", "            continue\n        low, high = shift")],
        [("parts.push([a, c], [b, d]);", "parts.push([a, c]);")],
    ),
    "the ends of a flight alone": (
        [("if min(low) >= 0 < low[0]: continue", "if low[0] > 0 < sum(low): continue")],
        [("if (least.every(x => x >= 0n)) continue;", "continue;")],
    ),
    "nothing beyond the first part of for ever": (
        [("        if ever: parts += [(low, high, False, depth)]", "        if ever: parts += [(low, high, False, depth)]; continue\n        if 0: pass")],
        [("if (!wait) parts.push(", "if (0) parts.push(")],
    ),
    "the final place of what stands falls": (
        [("if not self.pull or i in self.pegs: return row", "if not self.pull: return row")],
        [("const fall = gravity && !run.fixed[i] && worlds", "const fall = gravity && worlds")],
    ),
    "the rising zero of a face": (
        [("return -(m.closing + (m.closing if again else m.disc.sqrt())) / m.speed\n    def there(m, again):  # the sign", "return -(m.closing + (m.closing if again else -m.disc.sqrt())) / m.speed\n    def there(m, again):  # the sign")],
        [("arc ? full.div(full.neg(full.add(laws.closing(), root)), laws.speed())", "arc ? full.div(full.neg(full.sub(laws.closing(), root)), laws.speed())")],
    ),
    "a foot that is not pulled": (
        [("(m.slide + lift * wait) * wait", "m.slide * wait")],
        [("A.mul(A.mul(along(this.gravity.map(x => x[w])), this.half[w]), wait)", "A.zero")],
    ),
    "a face that is nowhere": (
        [("return -1 if signs & {-1, 0} else None if None in signs else 1", "return -1")],
        [("if (reads.some(s => s < 0 || (s === 0 && c.face))) return;", "return;")],
    ),
}  # fmt: skip
"""Of each what the first checker has instead, and the second."""


@needs_node
@pytest.mark.parametrize("fault", FAULTS)
def test_planted_faults_are_found(fault: str, tmp_path: Path) -> None:
    first, second = FAULTS[fault]
    samples = {name: peg_samples()[name] for name in by_hand()}
    wrong = [completed(make(), lax(first)) for first, _, make in PEG_CONDITIONS.values()]
    paths: list[Path] = []
    for number, told in enumerate([*samples.values(), *wrong]):
        paths.append(tmp_path / f"{number}.json")
        paths[-1].write_text(certificate_json(told), encoding="utf-8")
    truth = [*([True] * len(samples)), *([False] * len(wrong))]
    checker = lax(first)
    assert [checker.verdict(path)[0] == 0 for path in paths] != truth
    program = lax_second(second, tmp_path / "faulty")
    done = subprocess.run(["node", str(program), *map(str, paths)], capture_output=True, text=True, check=False)
    assert [line.startswith("verified") for line in done.stdout.splitlines()] != truth
    assert [by_python(path)[0] == 0 for path in paths] == truth
