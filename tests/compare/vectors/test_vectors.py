"""Vectors: their answers by another calculation, their files, the scorer in C, and scores of engines and queries."""

from __future__ import annotations

import json
import math
import shutil
import subprocess
from collections import Counter
from dataclasses import replace
from decimal import Decimal, localcontext
from fractions import Fraction
from importlib.util import find_spec
from itertools import islice
from pathlib import Path
from typing import Any

import pytest

from truebreak.compare.cli import main
from truebreak.compare.engines import engine
from truebreak.compare.vectors.first_meetings import (
    KINDS,
    THINGS,
    MeetingQuestion,
    Vector,
    answered,
    questions,
    vectors,
)
from truebreak.compare.vectors.scores import QUERIES, by_engine, error_of, installed_queries, query_named, scores
from truebreak.compare.vectors.vector_files import SOURCES, vectors_header, vectors_json, write_vectors
from truebreak.scenarios import SceneError

SAMPLE = Path(__file__).parents[2] / "data" / "vectors-1000.json"
"""`truebreak vectors --out FOLDER`, its JSON."""

COMPILER = shutil.which("cc")

# -- a referee in rational numbers: whether two meet is a sign, when is one square root


def root(square: Fraction) -> Decimal:
    return (Decimal(square.numerator) / Decimal(square.denominator)).sqrt()


def round_meeting(dx: Fraction, dy: Fraction, vx: Fraction, vy: Fraction, reach: Fraction) -> Decimal | None:
    """When a place that flies from (dx, dy) comes within `reach` of the origin."""
    a, b, c = vx * vx + vy * vy, dx * vx + dy * vy, dx * dx + dy * dy - reach * reach
    if b >= 0 or b * b <= a * c:
        return None
    one = root(b * b - a * c)
    return (Decimal(c.numerator) / c.denominator) / (Decimal((-b).numerator) / b.denominator + one)


def side_meeting(
    x: Fraction, y: Fraction, r: Fraction, vx: Fraction, vy: Fraction, line: tuple[Fraction, ...]
) -> tuple[Decimal, Decimal] | None:
    """When a disc comes to the left side of a line, and how far along it, as a share of the way between its points."""
    x0, y0, x1, y1 = line
    ux, uy = x1 - x0, y1 - y0
    height, rise = ux * (y - y0) - uy * (x - x0), ux * vy - uy * vx
    if rise >= 0 or height < 0:
        return None
    length = root(ux * ux + uy * uy)
    time = (Decimal(height.numerator) / height.denominator - Decimal(r.numerator) / r.denominator * length) / (
        Decimal((-rise).numerator) / rise.denominator
    )
    begin, speed = ux * (x - x0) + uy * (y - y0), ux * vx + uy * vy
    along = Decimal(begin.numerator) / begin.denominator + Decimal(speed.numerator) / speed.denominator * time
    square = ux * ux + uy * uy
    return time, along / (Decimal(square.numerator) / square.denominator)


def decimal(number: Fraction) -> Decimal:
    return Decimal(number.numerator) / Decimal(number.denominator)


def arc_meetings(question: MeetingQuestion) -> list[tuple[Decimal, str]]:
    """When a disc meets the sides and the ends of an arc; the range by the directions of its ends, one turn after the
    other, and not by a chord."""
    x, y, r, vx, vy = map(Fraction, question.disc)
    cx, cy, radius, x0, y0, x1, y1 = map(Fraction, question.other)
    dx, dy = x - cx, y - cy
    first, second = (x0 - cx, y0 - cy), (x1 - cx, y1 - cy)
    full = first == second == (0, 0)
    turn = first[0] * second[1] - first[1] * second[0]

    def within(time: Decimal) -> bool:
        px, py = decimal(dx) + decimal(vx) * time, decimal(dy) + decimal(vy) * time
        after = decimal(first[0]) * py - decimal(first[1]) * px > 0
        before = px * decimal(second[1]) - py * decimal(second[0]) > 0
        return full or (after if turn == 0 else after and before if turn > 0 else after or before)

    found: list[tuple[Decimal, str]] = []
    away = dx * dx + dy * dy
    if away >= (radius + r) ** 2 and (time := round_meeting(dx, dy, vx, vy, radius + r)) is not None and within(time):
        found.append((time, "outside"))
    a, b, c = vx * vx + vy * vy, dx * vx + dy * vy, away - (radius - r) ** 2
    if radius > r and b * b > a * c:
        time = (root(b * b - a * c) - decimal(b)) / decimal(a)
        if time >= 0 and within(time):
            found.append((time, "inside"))
    for px, py in () if full else (first, second):
        share = decimal(radius) / root(px * px + py * py)
        ex, ey = decimal(dx) - share * decimal(px), decimal(dy) - share * decimal(py)
        mine, inner = decimal(a), ex * decimal(vx) + ey * decimal(vy)
        rest = ex * ex + ey * ey - decimal(r) ** 2
        if inner < 0 and inner * inner > mine * rest:
            found.append((rest / (-inner + (inner * inner - mine * rest).sqrt()), "end"))
    return found


def referee(question: MeetingQuestion) -> tuple[Decimal, str] | None:
    """When the two meet, and on which part."""
    x, y, r, vx, vy = map(Fraction, question.disc)
    b = [Fraction(n) for n in question.other]
    if question.thing == "disc":
        time = round_meeting(b[0] - x, b[1] - y, b[3] - vx, b[4] - vy, r + b[2])
        return None if time is None else (time, "")
    if question.thing == "wall":
        left = (b[2] - b[0]) * (y - b[1]) - (b[3] - b[1]) * (x - b[0]) > 0
        line = (b[0], b[1], b[2], b[3]) if left else (b[2], b[3], b[0], b[1])
        met = side_meeting(x, y, r, vx, vy, line)
        return None if met is None else (met[0], "")
    if question.thing == "arc":
        return min(arc_meetings(question), default=None)
    found: list[tuple[Decimal, str]] = []
    for line in ((b[0], b[1], b[2], b[3]), (b[2], b[3], b[0], b[1])):
        met = side_meeting(x, y, r + b[4], vx, vy, line)
        if met is not None and met[0] >= 0 and 0 < met[1] < 1:
            found.append((met[0], "face"))
    for ex, ey in ((b[0], b[1]), (b[2], b[3])):
        time = round_meeting(ex - x, ey - y, -vx, -vy, r + b[4])
        if time is not None:
            found.append((time, "end"))
    return min(found, default=None)


def objections(vector: Vector) -> str | None:
    """What the referee has against an answer."""
    with localcontext() as context:
        context.prec = 700
        found = referee(vector.question)
        if (found is not None) != vector.meets:
            return f"meets: {vector.meets}, by the referee {found}"
        if found is None:
            return None
        time = Decimal(vector.digits)
        if abs(time - found[0]) > Decimal(10) ** -38 * abs(time):
            return f"{time} is certified, {found[0]:.50} calculated"
        pair = Decimal(vector.time) + Decimal(vector.rest)
        if abs(pair - found[0]) > Decimal(2) ** -104 * abs(found[0]) + Decimal(2) ** -1074:
            return f"{pair} is written, {found[0]:.50} calculated"
        return None if found[1] == vector.part else f"part {vector.part}, by the referee {found[1]}"


def test_every_answer_is_what_rational_numbers_and_one_root_give() -> None:
    made = [*vectors(560, seed=11)]
    against = [(vector.question, told) for vector in made if (told := objections(vector)) is not None]
    assert not against, against[:3]


@pytest.mark.slow
def test_a_hundred_thousand_answers() -> None:
    for vector in vectors(100_000, seed=2):
        assert objections(vector) is None, vector


@pytest.mark.parametrize(
    "planted",
    [
        lambda v: replace(v, meets=not v.meets, digits=v.digits or "1"),
        lambda v: replace(v, digits=str(Decimal(v.digits or 1) * (1 + Decimal(10) ** -37))),
        lambda v: replace(v, rest=v.rest + math.ulp(v.time) * 2**-50),
        lambda v: replace(v, part={"face": "end", "outside": "inside", "inside": "end"}.get(v.part, "face")),
    ],
)
@pytest.mark.parametrize("part", ["face", "outside", "inside", "end"])
def test_the_referee_finds_a_false_answer(planted: Any, part: str) -> None:
    hit = next(v for v in vectors(60, seed=3) if v.part == part and v.time)
    assert objections(hit) is None
    with localcontext() as context:
        context.prec = 60
        assert objections(planted(hit)) is not None


def test_every_kind_is_drawn_and_means_what_it_says() -> None:
    count = Counter((v.question.thing, v.question.kind, v.meets) for v in vectors(560, seed=5))
    for thing in THINGS:
        for kind in KINDS:
            meets, misses = count[thing, kind, True], count[thing, kind, False]
            assert meets + misses == 20
            if kind in ("hit", "near hit", "scale"):
                assert not misses, (thing, kind)
            elif kind in ("miss", "near miss", "graze"):
                assert not meets, (thing, kind)
            else:
                assert meets, (thing, kind)
                assert misses, (thing, kind)


def test_every_part_is_met_in_every_kind_that_can() -> None:
    met = {(v.question.kind, v.part) for v in vectors(840, seed=5) if v.question.thing == "arc" and v.meets}
    assert met == {
        (kind, part) for kind in ("hit", "near hit", "touching", "scale") for part in ("outside", "inside", "end")
    }


def test_grazes_need_more_than_doubles() -> None:
    """They are exact: doubles and the quadratic formula take some for hits, some for misses."""
    false = 0
    for question in islice(questions(1), 5600):
        if question.kind == "graze" and question.thing == "disc":
            x, y, r, vx, vy = question.disc
            dx, dy, ux, uy = (
                question.other[0] - x,
                question.other[1] - y,
                question.other[3] - vx,
                question.other[4] - vy,
            )
            cross, reach = dx * uy - dy * ux, r + question.other[2]
            false += (ux * ux + uy * uy) * reach * reach - cross * cross > 0
    assert false > 5


def test_what_overlaps_is_no_question() -> None:
    with pytest.raises(SceneError, match="overlaps"):
        answered(MeetingQuestion("disc", "hit", (0.0, 0.0, 1.0, 1.0, 0.0), (1.0, 0.0, 1.0, 0.0, 0.0)))


# -- files


def test_the_sample_that_is_kept_is_current() -> None:
    assert SAMPLE.read_text("utf-8") == "".join(vectors_json(vectors(1000), "truebreak vectors"))


def test_json_and_c_hold_the_same(tmp_path: Path) -> None:
    made = [*vectors(84, seed=4)]
    written = write_vectors(tmp_path, made, "truebreak vectors --count 84 --seed 4")
    assert [path.name for path in written] == ["vectors.json", "vectors.h", *SOURCES]
    kept = json.loads(written[0].read_text("utf-8"))
    assert kept["format"] == "truebreak-vectors-2"
    lines = [line for line in written[1].read_text("utf-8").splitlines() if line.startswith("  {")]
    assert len(kept["vectors"]) == len(lines) == 84
    for vector, row, line in zip(made, kept["vectors"], lines, strict=True):
        assert (tuple(row["disc"]), tuple(row["other"])) == (vector.question.disc, vector.question.other)
        assert row["meets"] == vector.meets
        assert row.get("time", 0.0) == vector.time
        numbers = [float.fromhex(word.strip(" {}")) for word in line.strip(" {},").split(",")[3:]]
        padded = [*vector.question.other, *[0.0] * (7 - len(vector.question.other))]
        assert numbers == [*vector.question.disc, *padded, vector.time, vector.rest]


def compiled(folder: Path, source: str, *options: str) -> Path:
    program = folder / f"score{len([*folder.iterdir()])}"
    words = ["cc", "-O1", "-std=c11", "-Wall", "-Wextra", "-Werror", "-pedantic", *options]
    subprocess.run([*words, "-o", str(program), "score.c", source, "-lm"], cwd=folder, check=True)
    return program


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
@pytest.mark.parametrize("formula", [1, 2, 3])
def test_the_scorer_in_c_counts_as_python_does(tmp_path: Path, formula: int) -> None:
    """A formula that misses is counted as such; one in place of it that is always right has nothing against it."""
    made = [*vectors(280, seed=6)]
    write_vectors(tmp_path, made, "truebreak vectors")
    run = subprocess.run(
        [compiled(tmp_path, "formulas.c", f"-DFORMULA={formula}")], capture_output=True, text=True, check=False
    )
    rows = run.stdout.splitlines()
    assert len(rows) == 1 + 28 + 1 + 1
    assert rows[-1].endswith("ns a query")
    _, count, meet, false, missed, *_ = rows[-2].split()
    assert (int(count), int(meet)) == (280, sum(v.meets for v in made))
    assert run.returncode == int(int(false) + int(missed) > 0)
    sums = [row[20:].split()[:4] for row in rows[1:-2]]
    assert [sum(int(row[k]) for row in sums) for k in range(4)] == [280, int(meet), int(false), int(missed)]


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
def test_the_scorer_finds_what_is_false(tmp_path: Path) -> None:
    """Answers read off the vectors have no error; with one hit made up, one left out and one late, it says which."""
    made = [*vectors(56, seed=8)]
    write_vectors(tmp_path, made, "truebreak vectors")
    hits = [k for k, v in enumerate(made) if v.meets and v.time]
    miss = next(k for k, v in enumerate(made) if not v.meets)
    (tmp_path / "true.c").write_text(
        '#include "vectors.h"\nint first_meeting(const struct truebreak_vector *v, double *t)'
        "{ *t = v->time; return v->meets; }\n"
    )
    x, y, *_ = made[miss].question.disc
    other = made[miss].question.other[0]
    (tmp_path / "false.c").write_text(
        '#include "vectors.h"\nint first_meeting(const struct truebreak_vector *v, double *t) {\n'
        f"  *t = v->time * (v->time == {made[hits[1]].time.hex()} ? 1.5 : 1.0);\n"
        f"  if (v->a[0] == {x.hex()} && v->a[1] == {y.hex()} && v->b[0] == {other.hex()}) return 1;\n"
        f"  return v->meets && v->time != {made[hits[0]].time.hex()};\n}}\n"
    )
    right, wrong = (
        subprocess.run([compiled(tmp_path, name)], capture_output=True, text=True, check=False)
        for name in ("true.c", "false.c")
    )
    assert right.returncode == 0, right.stdout
    assert right.stdout.splitlines()[-2].split()[3:5] == ["0", "0"]
    words = wrong.stdout.splitlines()[-2].split()
    assert wrong.returncode == 1
    assert words[3:5] == ["1", "1"]
    assert words[5:] == ["5.00e-01", "(vector", f"{hits[1]})"]


# -- scores


def test_scores_of_answers_that_are_false_somewhere() -> None:
    made = [*vectors(56, seed=9)]
    hit, miss = next(v for v in made if v.meets and v.time), next(v for v in made if not v.meets)

    def query(question: MeetingQuestion) -> float | None:
        vector = next(v for v in made if v.question == question)
        if vector is hit:
            return None
        return 1.0 if vector is miss else vector.time if vector.meets else None

    *each, whole = scores(made, query)
    assert (whole.false_hits, whole.missed, whole.refused) == (1, 1, 0)
    assert whole.worst is not None
    assert whole.worst <= 2**-53
    assert sum(row.vectors for row in each) == whole.vectors == 56
    assert error_of(hit, hit.time * 1.5) == pytest.approx(0.5)
    assert error_of(hit, math.nan) == math.inf


@pytest.mark.parametrize(("name", "worst"), [("exact", 2**-53), ("quad", 2**-53), ("double", 1e-9), ("single", 1.0)])
def test_our_engines(name: str, worst: float) -> None:
    """Of ordinary size: exact and quad are right to the nearest double; double is, but for errors of near hits."""
    made = [v for v in vectors(280) if v.question.kind != "scale"]
    whole = scores(made, query_named(name))[-1]
    assert whole.worst is not None
    assert whole.worst <= worst
    if name in ("exact", "quad"):
        assert (whole.refused, whole.false_hits, whole.missed) == (0, 0, 0)
    if name == "single":
        assert whole.missed > 0


def test_pymunk_takes_grazes_and_partings_for_hits() -> None:
    """Its query asks for overlap of shapes that are swept, whatever way they fly."""
    rows = {(row.thing, row.kind): row for row in scores([*vectors(280)], query_named("pymunk.segment_query"))}
    assert rows["disc", "hit"].missed == rows["disc", "hit"].false_hits == rows["disc", "miss"].false_hits == 0
    assert (rows["disc", "hit"].worst or 1.0) < 1e-10
    assert rows["disc", "touching"].false_hits > 0
    assert rows["segment", "hit"].missed == 0


@pytest.mark.skipif(find_spec("Box2D") is None, reason="Box2D is not installed")
def test_box2d_is_right_to_within_its_slop() -> None:
    rows = {(row.thing, row.kind): row for row in scores([*vectors(280)], query_named("box2d.time_of_impact"))}
    hit = rows["disc", "hit"]
    assert (hit.refused, hit.missed, hit.false_hits) == (0, 0, 0)
    assert 1e-7 < (hit.worst or 0.0) < 0.1
    assert rows["segment", "hit"].refused > 0


def test_names_of_what_can_be_scored(monkeypatch: pytest.MonkeyPatch) -> None:
    assert set(installed_queries()) <= set(QUERIES)
    with pytest.raises(SceneError, match="takes time steps"):
        by_engine(engine("pymunk"))
    with pytest.raises(SceneError, match="is not known"):
        query_named("nothing")
    monkeypatch.setattr("truebreak.compare.vectors.scores.find_spec", lambda name: None)
    with pytest.raises(SceneError, match="needs pymunk, which is not installed"):
        query_named("pymunk.segment_query")


# -- the command


def code_of(*words: str) -> Any:
    """The exit code of a command line."""
    with pytest.raises(SystemExit) as ended:
        main([*words])
    return ended.value.code


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert code_of("vectors", "--count", "21", "--out", str(tmp_path)) == 0
    assert capsys.readouterr().out == ""
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(["vectors.json", "vectors.h", *SOURCES])
    assert "".join(vectors_header([*vectors(21)], f"truebreak vectors --count 21 --out {tmp_path}")) == (
        tmp_path / "vectors.h"
    ).read_text("utf-8")
    assert code_of("vectors", "--count", "21", "--engines", "double", "--json") == 0
    found = json.loads(capsys.readouterr().out)["scores"]["double"]
    assert [row["vectors"] for row in found] == [1] * 21 + [21]
    assert code_of("vectors", "--count", "21", "--engines", "double,single", "-v") == 0
    assert "near miss" in capsys.readouterr().out
    assert code_of("vectors", "--out", str(tmp_path / "none")) == 2
    assert "there is none of that name" in capsys.readouterr().err
