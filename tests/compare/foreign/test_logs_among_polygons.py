"""Logs of engines among polygons: reported contacts, times alone, and states from which contacts are inferred."""

from __future__ import annotations

import csv
import io

import pytest
from polygon_faults import PolygonFault
from polygon_scenes import scene_of
from test_logs_among_segments import Retold

from truebreak.compare import compare
from truebreak.compare.foreign import Recording
from truebreak.compare.foreign.impulses import Impacts
from truebreak.compare.report.floats import floats_csv, floats_json
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Polygon, Scene

NOOK = Polygon([(-9, -9), (9, -9), (9, 0), (0, 0), (0, 9), (-9, 9)], id="nook", r="1/4")


@pytest.mark.parametrize("how", ["hits", "times", "states"])
def test_a_true_log_is_told_to_be_true(how: str) -> None:
    judged = 0
    for seed in range(45):
        scene = scene_of(seed)
        if scene is None or (how == "states" and not DoubleEngine().run(scene, until=20, events=20).events):
            continue
        doubles, found = compare(scene, ["double", Retold(how)], until=20, events=20).candidates
        if found.unable or doubles.verdict != "agree":  # within rounding of a joint, doubles name the other polygon
            continue
        judged += 1
        assert found.verdict == "agree", (seed, found.alignment.divergence)
        assert found.laws is not None
        assert found.laws.kept is (None if how == "times" and found.trajectory.events else True)
    assert judged > 20


@pytest.mark.parametrize("how", ["hits", "times", "states"])
def test_both_faces_of_a_concave_corner_push(how: str) -> None:
    scene = Scene([Circle(5, 5, r=1, vx=-1, vy=-1, id="c")], polygons=[NOOK])
    (found,) = compare(scene, [Retold(how)], until=20).candidates
    assert found.verdict == "agree"
    left = found.trajectory.final["c"]
    assert (float(left.vx), float(left.vy)) == pytest.approx((1, 1))


def test_nothing_is_quiet_that_comes_to_another_face() -> None:
    """In a notch what is nearest recedes, and the other jaw comes: the log must not end there as if all were over."""
    hook = Polygon([(0, 0), (6, 0), (6, 6), (0, 6), (0, 4), (4, 4), (4, 2), (0, 2)], "g")
    impacts = Impacts(Scene([Circle("3", "5/2", r="1/2", id="c")], polygons=[hook]))
    assert not impacts.quiet([(3.0, 2.5, -1.0, 1.0)], 0.0)
    assert impacts.quiet([(3.0, 2.5, -1.0, 0.1)], 0.0)


def test_a_scene_in_doubles_has_its_polygons() -> None:
    wedge = Polygon([(0, 0), ("1/3", 0), (0, "sqrt(2)")], id="wedge", r="1/10")
    scene = Scene([Circle(0, -5)], polygons=[wedge])
    (row,) = floats_json(scene)["polygons"]
    assert (row["points"], row["r"]) == ([[0.0, 0.0], [1 / 3, 0.0], [0.0, 2**0.5]], 0.1)
    assert row["error"]["points"][1] == [pytest.approx(1.850371707708594e-17), 0.0]
    told = [*csv.reader(io.StringIO(floats_csv(scene)))][1]
    assert told[:9] == ["polygon", "wedge", "0.1", "0.0", "0.0", repr(1 / 3), "0.0", "0.0", repr(2**0.5)]
    assert float(told[12]) == pytest.approx(1.850371707708594e-17)
    assert "polygons" not in floats_json(Scene([Circle(0, 5)]))


@pytest.mark.parametrize("fault", ["no corners", "no thickness", "a side lost"])
def test_a_log_of_states_that_breaks_a_law_is_found(fault: str) -> None:
    found = 0
    for seed in range(40):
        scene = scene_of(seed)
        if scene is None or any(c.point for c in scene.circles):
            continue
        run = PolygonFault(fault=fault).run(scene, until=20, events=20)
        if abs(DoubleEngine().run(scene, until=20, events=20).final.array() - run.final.array()).max() < 1e-3:
            continue
        recording = Recording(scene, "log", until=20, events=20)
        for event in run.events:
            states = {c.id: tuple(map(float, (c.x, c.y, c.vx, c.vy))) for c in run.after(event.index).circles}
            recording.hits(float(event.time), [tuple(pair) for pair in event.impulses], states)
            if not recording.open:
                break
        recording.end(float(run.final_time))
        (told,) = compare(scene, [_Recorded(recording.trajectory())], until=20, events=20).candidates
        assert told.laws is not None
        assert told.laws.kept is False, seed
        found += 1
    assert found > 1


class _Recorded(Retold):
    """A recording, handed back as the run of an engine."""

    def __init__(self, told: object) -> None:
        object.__setattr__(self, "told", told)
        super().__init__()

    def run(self, scene: Scene, **limits: object) -> object:
        """What was recorded."""
        return vars(self)["told"]
