"""Certificates of runs among segments, altered at random, are refused, or still true; and compared with a scene."""
# ruff: noqa: E501 (lines of the checkers stand here as they are)

from __future__ import annotations

import subprocess
from copy import deepcopy
from fractions import Fraction
from functools import cache
from pathlib import Path
from random import Random

import pytest
from segment_scenes import scene_of

from certificate.checkers import Lot, both_verify, by_python, lot_of, mistaken, needs_node
from certificate.forging import refused_by_both
from certificate.peg_samples import (
    another_thing,
    bounce_left_out,
    carried_by_hand,
    carried_samples,
    less_said_of_a_time,
)
from certificate.segment_forgeries import STOPPED, beside_a_face, crushed_late
from certificate.test_conditions import completed, lax, lax_second
from certificate.test_tampering import WAYS, Told, altered, refused, shown_true
from truebreak.compare.certificate import certificate_json, certificate_of
from truebreak.compare.certificate.certified import difference
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Pocket, Polygon, Quantity, Scene, Segment, Wall

SEEDS = range(70)
EVENTS = 6


def by_hand() -> dict[str, Scene]:
    """Scenes of joints, slides, corners, points, and what is thick; and there and back, into pockets, in any order."""
    row = [Segment(k, 0, k + 1, k % 2, id=f"s{k}", r="1/4") for k in range(-4, 4)]
    box = [Wall(-5, 0, -5, 1, id="l"), Wall(5, 0, 5, 1, id="r"), Wall(0, 9, 1, 9, id="t")]
    floor = [Segment(2 * k, 0, 2 * k + 2, 0, id=f"f{k}") for k in range(5)]
    slider = Circle(-3, 1, vx=1, id="slider")
    return {
        "there and back": Scene([Circle(0, 4, vx="1/3", vy=-1, id="c")], box, segments=row, reverse_at=15),
        "a slide and a blow": Scene([slider, Circle(-3, 12, vx=1, vy=-1)], segments=floor),
        "a slide and a blow at a joint": Scene([slider, Circle(-3, 10, vx=1, vy=-1)], segments=floor),
        "a slide into a pocket": Scene([slider], pockets=[Pocket(7, 0, "3/2")], capture=True, segments=floor),
        "a slide there and back": Scene([slider, Circle(-3, 12, vx=1, vy=-1)], segments=floor, reverse_at=12),
        "a corner": Scene([Circle(0, 5, vy=-1)], segments=[Segment(-3, 3, 0, 0), Segment(0, 0, 3, 3)]),
        "an apex": Scene([Circle(0, 5, vy=-1)], segments=[Segment(-3, -3, 0, 0), Segment(0, 0, 3, -3)]),
        "a point": Scene([Circle(0, 5, r=0, point=True, vx="1/2", vy=-1)], box, segments=floor, events=5),
        "a point at an end": Scene([Circle(0, 5, r=0, point=True, vy=-1), Circle(7, 5, vy=-1)], segments=floor[:1]),
        "on a joint": Scene([Circle(4, 1), Circle(4, 9, vy=-1)], segments=floor),
        "one by one": Scene(
            [Circle(0, 5, vy=-1), Circle(3, 5, vy=-1)],
            tie_policy="sequential:seed=5",
            segments=[Segment(-3, 3, 0, 0), Segment(0, 0, 3, 3), Segment(3, 3, 6, 0)],
        ),
        "thick and thin": Scene(
            [Circle(-2, 9, vx="1/4", vy=-1)], segments=[Segment(-4, 0, 0, 0, r=1), Segment(0, 0, 4, 0)]
        ),
        "mirrored": Scene(
            [Circle(-2, "sqrt(5)", vx="1/3", vy=-1), Circle(2, "sqrt(5)", vx="-1/3", vy=-1)],
            segments=[Segment(-4, -1, -1, 0), Segment(4, -1, 1, 0)],
        ),
    }  # fmt: skip


@cache
def segment_samples() -> dict[str, Told]:
    """Certificates of these, and of random scenes."""
    scenes = {**by_hand(), **{f"seed {seed}": scene for seed in SEEDS if (scene := scene_of(seed)) is not None}}
    runs = {
        name: ExactEngine().run(scene, until=30, events=EVENTS)
        for name, scene in scenes.items()
        if not scene.reverse_at
    }
    runs |= {name: ExactEngine().run(scene) for name, scene in scenes.items() if scene.reverse_at}
    return {name: certificate_of(run) for name, run in runs.items()}


def test_both_verify_runs_among_segments(tmp_path: Path) -> None:
    assert sum(len(told["instants"]) for told in segment_samples().values()) > 200
    both_verify(segment_samples().items(), tmp_path)


# -- ways to alter segments


def moved_bar(told: Told, draw: Random) -> None:
    """A segment is somewhere else, by a little or by more."""
    bar = draw.choice(told["scene"]["segments"])
    by = draw.choice(["+1", "-1", "+1/8", "-1/1000", "+1/1" + "0" * 30])
    for key in draw.choice([("x0", "x1"), ("y0", "y1")]):
        bar[key] += by


def turned_bar(told: Told, draw: Random) -> None:
    """A segment is told from its other end, its faces with it."""
    bar = draw.choice(told["scene"]["segments"])
    bar.update(x0=bar["x1"], y0=bar["y1"], x1=bar["x0"], y1=bar["y0"])


def thicker_bar(told: Told, draw: Random) -> None:
    """A segment is thicker, or thinner."""
    bar = draw.choice(told["scene"]["segments"])
    bar["r"] = draw.choice(["0", "1/8", "1", bar["r"] + "+1/1" + "0" * 40])


def longer_bar(told: Told, draw: Random) -> None:
    """A segment that runs along an axis is longer or shorter by a half."""
    bars = [
        bar
        for bar in told["scene"]["segments"]
        if "r" not in bar["length"] and Quantity.of(bar["y0"]) == Quantity.of(bar["y1"])
    ]
    if bars:
        bar = draw.choice(bars)
        start, end = Quantity.of(bar["x0"]), Quantity.of(bar["x1"])
        bar["x1"] = (end + (end - start) / 2 * draw.choice([1, -1])).text()
        bar["length"] = abs((Quantity.of(bar["x1"]) - start).rational).__str__()


def no_bar(told: Told, draw: Random) -> None:
    """A segment is not there."""
    told["scene"]["segments"].pop(draw.randrange(len(told["scene"]["segments"])))


def other_part(told: Told, draw: Random) -> None:
    """A contact with a segment is one with another part of it, or with another segment."""
    scene = told["scene"]
    n = len(scene["circles"])
    pairs = [
        row
        for part in (*told["instants"], told["end"])
        for row in (*part.get("met", ()), *(push for one in part.get("rounds", ()) for push in one))
        if row[1] >= n
    ]
    if pairs:
        row = draw.choice(pairs)
        old, new = row[1], n + draw.randrange(4 * len(scene["segments"]) + len(scene.get("walls", ())))
        everywhere = draw.random() < 0.5
        for other in pairs if everywhere else [row]:
            if other[:2] == [row[0], old]:
                other[1] = new


BAR_WAYS = (moved_bar, turned_bar, thicker_bar, longer_bar, no_bar, other_part)


def another_pace(told: Told, draw: Random) -> None:
    """A segment has another velocity, or stops; or moves, where it stood."""
    row, key = draw.choice(told["scene"]["segments"]), draw.choice(["vx", "vy"])
    pace = row.get(key, "0")
    row[key] = draw.choice(["0", "1/10", "-1", pace + "+1/1" + "0" * 30, pace + "-1/1000"])


def opposite_pace(told: Told, draw: Random) -> None:
    """A segment moves the other way."""
    moving = [row for row in told["scene"]["segments"] if "vx" in row]
    row = draw.choice(moving or [{"vx": "0", "vy": "0"}])
    for key in ("vx", "vy"):
        row[key] = row[key][1:] if row[key].startswith("-") else f"-{row[key]}"


CARRIED_WAYS = (another_pace, opposite_pace, *BAR_WAYS, less_said_of_a_time, bounce_left_out, another_thing)


def test_both_verify_runs_among_what_moves(tmp_path: Path) -> None:
    samples = carried_samples()
    pushes = [entry["rounds"] for told in samples.values() for entry in told["instants"] if entry.get("rounds")]
    ways = [told["scene"] for told in samples.values()]
    assert len(pushes) > 200 and sum("gravity" in scene for scene in ways) > 20
    assert sum(any("vx" in row for row in scene["segments"]) for scene in ways) > 50
    both_verify(samples.items(), tmp_path)


@needs_node
@pytest.mark.parametrize("count", [150, pytest.param(1500, marks=pytest.mark.slow)])
@pytest.mark.timeout(3600)
def test_altered_runs_among_what_moves_are_refused_or_shown_to_be_true(count: int, tmp_path: Path) -> None:
    tried = altered(count, (*CARRIED_WAYS, *WAYS), "carriedA", carried_samples())
    assert refused(tried, tmp_path) > count // 2


def test_a_certificate_is_compared_with_what_is_meant_to_move() -> None:
    scene = carried_by_hand()["onto a wedge"][0]
    block = certificate_of(ExactEngine().run(scene, events=1))["scene"]
    assert difference(block, scene) is None
    slow = scene.with_changes(segments=[Segment(-3, 9, 3, 9, id="press", vy="-1/4")])
    assert difference(block, slow) == "segment 'press': vy is -1/3, not -1/4"
    stood = scene.with_changes(polygons=[Polygon([(-2, 0), (2, 0), (0, 2)], "wedge", vx="1/9")])
    assert difference(block, stood) == "segment 'wedge/1': vy is 1/3, not 0"


@needs_node
@pytest.mark.parametrize("count", [150, pytest.param(1500, marks=pytest.mark.slow)])
def test_altered_runs_among_segments_are_refused_or_shown_to_be_true(count: int, tmp_path: Path) -> None:
    tried = altered(count, (*BAR_WAYS, *WAYS), "segments", segment_samples())
    assert refused(tried, tmp_path) > count // 2


def test_a_certificate_is_compared_with_the_segments_that_are_meant() -> None:
    scene = by_hand()["thick and thin"]
    block = certificate_of(ExactEngine().run(scene, until=5))["scene"]
    assert difference(block, scene) is None
    thin = scene.with_changes(segments=[Segment(-4, 0, 0, 0), Segment(0, 0, 4, 0)])
    assert difference(block, thin) == "segment 's1': r is 1, not 0"
    assert difference(block, scene.with_changes(segments=scene.segments[:1])) == "it has 2 segments, not 1"
    solid = scene.with_changes(polygons=[Polygon([(0, -9), (4, -9), (4, -7)])])
    assert difference(block, solid) == "it has 2 segments, not 5"
    assert difference(block, scene.with_changes(restitution="9/10")) == "its restitution is 1, not 9/10"


def test_the_checker_says_how_many_segments(tmp_path: Path) -> None:
    path = tmp_path / "one.json"
    path.write_text(certificate_json(segment_samples()["a corner"]), encoding="utf-8")
    assert "1 circles, 0 walls, 0 pockets, 2 segments" in by_python(path)[1]


# -- Faults planted in either checker: each is seen in what it says of honest certificates, or of a forgery.

FAULTS = {
    "a face without its range": (
        [("all(self.sign(x, c) > 0 for x in RANGE)", "True")],
        [("['foot', 'far']).every(name =>", "[]).every(name =>")],
    ),
    "the range with the wrong sign": (
        [("{foot.sign(), (m.square - foot).sign()}", "{(-foot).sign(), (foot + m.square).sign()}")],
        [("A.sub(A.mul(along(way), gap()), A.twice(A.mul(closing(), foot())))", "A.sub(A.twice(A.mul(closing(), foot())), A.mul(along(way), gap()))")],
    ),
    "an end without thickness": (
        [("found[key] = [*place, *way, r, NONE]", "found[key] = [*place, *way, NONE, NONE]")],
        [("y: py, r: thick, vx", "y: py, r: zero, vx")],
    ),
    "a face without thickness": (
        [("(r + more) * size", "r * size")],
        [("wall.face ? A.add(radius, wall.thick[w]) : radius", "radius")],
    ),
    "the normal of the other side": (
        [("dict.fromkeys(product(self.movable, self.faces), 1)", "dict.fromkeys(product(self.movable, self.faces), -1)")],
        [("!side || side[c.i] > 0 ? x[w]", "side && side[c.i] > 0 ? x[w]")],
    ),
    "one end alone": (
        [("for place in (x, y), (u, v):", "for place in [(x, y)]:")],
        [("of [[e.x0, e.y0], [e.x1, e.y1]]) end(id, x, y, thick, e.vx, e.vy)", "of [[e.x0, e.y0]]) end(id, x, y, thick, e.vx, e.vy)")],
    ),
    "the thinner of two ends at a place": (
        [("if sign == 1: found", "if sign == (-1 if key in found else 1): found")],
        [("if (larger > 0) there.r", "if (larger < 0) there.r")],
    ),
}  # fmt: skip
"""Of each what the first checker has instead, and the second."""

MOVING_FAULTS = {
    "faces that stand": (
        [("x, y, vx, vy = x - p * time, y - q * time, vx - p, vy - q", "pass")], [("if (wall.way) {", "if (0) {")],
    ),
    "faces that move the other way": (
        [("x, y, vx, vy = x - p * time, y - q * time, vx - p, vy - q", "x, y, vx, vy = x + p * time, y + q * time, vx + p, vy + q")],
        [("const own = wall.way.map(x => x[w]);", "const own = wall.way.map(x => A.neg(x[w]));")],
    ),
    "faces that push as if they stood": (
        [("x, y, vx, vy = x - p * time, y - q * time, vx - p, vy - q", "x, y = x - p * time, y - q * time")],
        [("way = minus(way, own);", "")],
    ),
    "ends that stand": (
        [("found[key] = [*place, *way, r, NONE]", "found[key] = [*place, NONE, NONE, r, NONE]")],
        [("vx: ux, vy: uy, w: zero, end: true, way: this.way(ux, uy)", "vx: zero, vy: zero, w: zero, end: true, way: null")],
    ),
    "ends that move the other way": (
        [("found[key] = [*place, *way, r, NONE]", "found[key] = [*place, *(-z for z in way), r, NONE]")],
        [("(x => ({ p: [x.x, x.y], v: [x.vx, x.vy],", "(x => ({ p: [x.x, x.y], v: [x.vx, x.vy].map(v => (x.end ? v.map((z, w) => scene.worlds[w].neg(z)) : v)),"),
         ("(own ? A.sub(x, own[k]) : x)", "(own ? A.add(x, own[k]) : x)")],
    ),
    "ends that push as if they stood": (
        [("speeds = p - vx, q - vy", "speeds = (-vx, -vy) if not getattr(w := self.things[j][5], 'm', w) else (p - vx, q - vy)")],
        [("(own ? A.sub(x, own[k]) : x)", "x"), (": minus(v, u);\n    const reach", ": minus(this.circles[c.j].end ? [A.zero, A.zero] : v, u);\n    const reach")],
    ),
    "one side of a segment alone moves": (
        [("for row in segments for _ in range(2)]]", "for row in segments for row in (row, [NONE])]]")],
        [("length, thick, face, way });\n      this.walls.push({ id, x0: x1, y0: y1, x1: x0, y1: y0, length, thick, face, way });", "length, thick, face, way });\n      this.walls.push({ id, x0: x1, y0: y1, x1: x0, y1: y0, length, thick, face, way: null });")],
    ),
}  # fmt: skip
"""The same, of what moves."""


@needs_node
@pytest.mark.parametrize("fault", MOVING_FAULTS)
def test_faults_planted_in_what_moves_are_found_and_what_they_tell_is_refused(fault: str, tmp_path: Path) -> None:
    """A checker with the fault finds runs of the engine wrong; and what that checker has to say of them, both refuse."""
    first, second = MOVING_FAULTS[fault]
    checker, told, paths = lax(first), carried_samples(), []
    for number, cert in enumerate(told.values()):
        paths.append(tmp_path / f"{number}.json")
        paths[-1].write_text(certificate_json(cert), encoding="utf-8")
    wrong = [path for path in paths if checker.verdict(path)[0]]
    assert len(wrong) > 3
    program = lax_second(second, tmp_path / "faulty")
    done = subprocess.run(["node", str(program), *map(str, paths)], capture_output=True, text=True, check=False)
    assert sum(not line.startswith("verified") for line in done.stdout.splitlines()) > 3
    forged = 0
    for cert in told.values():
        try:
            other = completed(deepcopy(cert), checker)
        except (checker.Refuted, checker.Unsettled):
            continue
        if shown_true(other):  # nothing of what has the fault comes in
            continue
        forged += 1
        refused_by_both(other, tmp_path / "forged.json")
    assert bool(forged) is (fault != "ends that move the other way")  # which meet nothing


@needs_node
@pytest.mark.parametrize("time, contact", [("42/5", 7), ("17/2", 7), ("9", 8), ("9", 5)])
def test_nothing_happens_to_what_has_been_crushed(time: str, contact: int, tmp_path: Path) -> None:
    """A lift and a press close on a disc at 42/5: no push, at that time or later, of either side of either, is verified."""
    push = {"time": str(float(Fraction(time))), "exact": time, "met": [[0, contact]], "rounds": [[[0, contact]]]}
    refused_by_both(crushed_late(STOPPED, push), tmp_path / "forged.json")


@cache
def lot() -> Lot:
    """Runs among segments, and a forgery."""
    wrong = completed(beside_a_face(), lax(FAULTS["a face without its range"][0]))
    return lot_of(segment_samples().values(), [wrong])


@needs_node
@pytest.mark.parametrize("fault", FAULTS)
def test_planted_faults_are_found(fault: str, tmp_path: Path) -> None:
    first, second = FAULTS[fault]
    mistaken(lax(first), lax_second(second, tmp_path / "faulty"), lot(), tmp_path)
