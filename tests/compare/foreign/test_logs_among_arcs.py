"""Logs of engines among arcs: reported contacts, times alone, and states from which contacts are inferred."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest
from arc_scenes import scene_of
from test_logs_among_segments import Retold

from truebreak.compare import compare
from truebreak.compare.cli import main
from truebreak.compare.foreign import LogEngine
from truebreak.compare.foreign.impulses import Impacts
from truebreak.compare.report.floats import floats_csv, floats_json
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Arc, Circle, Scene, Segment, catalogue

RING = Arc(0, 0, 5, id="ring", full=True)
HALF = Arc(0, 0, 5, 0, -5, 0, 5, id="half")


@pytest.mark.parametrize("how", ["hits", "times", "states"])
def test_a_true_log_is_told_to_be_true(how: str) -> None:
    judged = 0
    for seed in range(60):
        scene = scene_of(seed)
        if scene is None or not scene.elastic:
            continue
        if how == "states" and not DoubleEngine().run(scene, until=20, events=20).events:
            continue
        doubles, found = compare(scene, ["double", Retold(how)], until=20, events=20).candidates
        if found.unable or doubles.verdict != "agree":
            continue
        judged += 1
        assert found.verdict == "agree", (seed, found.alignment.divergence)
        assert found.laws is not None
        assert found.laws.kept is (None if how == "times" and found.trajectory.events else True), seed
    assert judged > 20


def test_a_log_of_a_stadium_is_judged(tmp_path: Path) -> None:
    """As somebody's engine writes it, with one impulse of a third less than the law: the audit says which."""
    bars = [Segment(-1, -2, 1, -2, id="low"), Segment(1, 2, -1, 2, id="high")]
    bows = [Arc(1, 0, 2, 1, -2, 1, 2, id="east"), Arc(-1, 0, 2, -1, 2, -1, -2, id="west")]
    scene = Scene([Circle(0, "1/7", r="1/4", vx=1, vy="1/3", id="c")], segments=bars, arcs=bows)
    run = DoubleEngine().run(scene, events=6)
    true, wrong = tmp_path / "true.jsonl", tmp_path / "wrong.jsonl"
    for path, fault in ((true, 1.0), (wrong, 2 / 3)):
        rows = []
        for event in run.events:
            c = run.after(event.index)["c"]
            speed = fault if event.index == 5 else 1.0
            state = [float(c.x), float(c.y), speed * float(c.vx), speed * float(c.vy)]
            rows.append({"time": float(event.time), "contact": [*event.impulses[0]], "states": {"c": state}})
        path.write_text("\n".join(json.dumps(row) for row in rows))
    (good,) = compare(scene, [LogEngine.of(true, scene)], events=6).candidates
    assert good.alignment.divergence is None
    assert good.alignment.agreed >= 5
    assert good.laws is not None
    assert good.laws.kept is True
    (bad,) = compare(scene, [LogEngine.of(wrong, scene)], events=6).candidates
    assert bad.laws is not None
    assert bad.laws.kept is False
    assert bad.laws.first is not None
    assert (bad.laws.first.kind, bad.laws.first.event) == ("impulse", 5)


def test_nothing_is_quiet_within_a_ring() -> None:
    within = Impacts(Scene([Circle(0, 0, r="1/2", vx=1, id="c")], arcs=[RING]))
    assert not within.quiet([(0.0, 0.0, 1.0, 0.0)], 0.0)
    assert not within.quiet([(4.5, 0.0, -1.0, 0.0)], 0.0)  # away from where it has just been
    half = Impacts(Scene([Circle(0, 0, r="1/2", vx=1, id="c")], arcs=[HALF]))
    assert half.quiet([(4.5, 0.0, -1.0, 0.0)], 0.0)  # out by the opening
    assert not half.quiet([(-9.0, 0.0, 1.0, 0.0)], 0.0)  # in by the opening
    assert not half.quiet([(9.0, 0.0, -1.0, 0.0)], 0.0)
    assert half.quiet([(9.0, 0.0, 1.0, 0.0)], 0.0)


def test_impulses_of_both_sides_are_inferred() -> None:
    for x, speed in ((4.5, 1.0), (5.5, -1.0)):
        scene = Scene([Circle(x, 0, r="1/2", vx=speed, id="c")], arcs=[HALF])
        links, left = Impacts(scene).inferred([(x, 0.0, -speed, 0.0)], [(x, 0.0, speed, 0.0)], 0.1, 0.0)
        assert links == [(0, 1)]
        assert left < 1e-12


def test_a_scene_in_doubles_has_its_arcs() -> None:
    scene = Scene(
        [Circle(0, 0)], arcs=[Arc("1/3", 0, 9, 1, 0, "sqrt(2)", 3, id="bow"), Arc(0, 0, 20, id="ring", full=True)]
    )
    bow, ring = floats_json(scene)["arcs"]
    assert (bow["x"], bow["y1"], bow["full"]) == (1 / 3, 3.0, False)
    assert bow["error"]["x"] == pytest.approx(1.850371707708594e-17)
    assert (set(ring), ring["full"], ring["r"]) == ({"id", "x", "y", "r", "full", "error"}, True, 20.0)
    rows = [row for row in csv.reader(io.StringIO(floats_csv(scene))) if row[0] == "arc"]
    assert rows[0][:9] == ["arc", "bow", repr(1 / 3), "0.0", "9.0", "1.0", "0.0", repr(2**0.5), "3.0"]
    assert rows[1][:5] == ["arc", "ring", "0.0", "0.0", "20.0"]
    assert (len(rows[0]), len(rows[1])) == (16, 8)


def test_two_logs_of_a_stadium_are_told_apart_by_the_law(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`diff --scene`: one of two logs loses a tenth of its speed at an arc, which the audit of each says."""
    run = DoubleEngine().run(catalogue.build("stadium"), events=20)
    paths = [tmp_path / "true.jsonl", tmp_path / "wrong.jsonl"]
    for path, share in zip(paths, (1.0, 0.9), strict=True):
        rows = []
        for event in run.events:
            c, speed = run.after(event.index)["ball"], share if event.index == 9 else 1.0
            state = [float(c.x), float(c.y), speed * float(c.vx), speed * float(c.vy)]
            rows.append({"time": float(event.time), "contact": [*event.impulses[0]], "states": {"ball": state}})
        path.write_text("\n".join(json.dumps(row) for row in rows))
    with pytest.raises(SystemExit) as ended:
        main(["diff", *map(str, paths), "--scene", "stadium"])
    assert ended.value.code == 1
    told = " ".join(capsys.readouterr().out.split())
    assert f"{paths[1]} does not keep the law: event 9" in told
    assert "the impulse of ball and east leaves a velocity 0.1 off the law's" in told
    assert "certified growth in stadium:" in told
