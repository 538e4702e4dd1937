"""Logs of engines among segments: reported contacts, times alone, and states from which contacts are inferred."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from typing import Any, ClassVar

import pytest
from segment_scenes import scene_of

from truebreak.compare import compare
from truebreak.compare.foreign import Recording
from truebreak.compare.report.floats import floats_csv, floats_json
from truebreak.floating import DoubleEngine, PymunkEngine
from truebreak.scenarios import Circle, Declared, Scene, Segment, Wall


@dataclass(frozen=True)
class Retold(Declared):
    """What the engine of doubles does, as somebody else's engine would report it."""

    how: str = "hits"
    name: ClassVar[str] = "retold"
    scene_keys: ClassVar[frozenset[str]] = DoubleEngine().scene_keys

    def run(self, scene: Scene, *, until: Any = None, events: Any = None, progress: Any = None) -> Any:
        """A recording of the run."""
        run = DoubleEngine().run(scene, until=until, events=events)
        recording = Recording(scene, self.name, until=until, events=events)
        for event in run.events:
            states = {c.id: tuple(map(float, (c.x, c.y, c.vx, c.vy))) for c in run.after(event.index).circles}
            pairs = [tuple(pair) for pair in event.impulses]
            if self.how == "states":
                recording.state(float(event.time), states)
            else:
                recording.hits(float(event.time), pairs, None if self.how == "times" else states)
            if not recording.open:
                break
        recording.end(float(run.final_time), quiet=run.stop.reason.name == "QUIET")
        return recording.trajectory(until=until, events=events)


@pytest.mark.parametrize("how", ["hits", "times", "states"])
def test_a_true_log_is_told_to_be_true(how: str) -> None:
    judged = 0
    for seed in range(45):
        scene = scene_of(seed)
        if scene is None or (how == "states" and not DoubleEngine().run(scene, until=20, events=30).events):
            continue
        (found,) = compare(scene, [Retold(how)], until=20, events=30).candidates
        if found.unable:
            continue
        judged += 1
        assert found.verdict == "agree", (seed, found.alignment.divergence)
        assert found.laws is not None
        assert found.laws.kept is (None if how == "times" and found.trajectory.events else True)
    assert judged > 25


def roof(first: str, second: str) -> Scene:
    """A disc that falls on the ridge of two segments."""
    bars = [Segment(-3, -1, 0, 0, id=first), Segment(0, 0, 3, -1, id=second)]
    return Scene([Circle("1/10", 5, vx="1/100", vy=-1, id="c")], segments=bars)


@pytest.mark.parametrize("said", ["a", "b"])
def test_an_end_that_segments_share_has_one_name(said: str) -> None:
    scene = roof("a", "b")
    run = DoubleEngine().run(scene, until=20)
    recording = Recording(scene, until=20)
    states = {c.id: tuple(map(float, (c.x, c.y, c.vx, c.vy))) for c in run.after(0).circles}
    recording.hits(float(run.events[0].time), [("c", said)], states)
    recording.end(20.0, quiet=True)
    assert recording.trajectory().events[0].contacts == run.events[0].contacts == (("c", "a"),)
    assert PymunkEngine().run(scene, until=20).events[0].contacts == (("c", "a"),)


def test_the_thickest_names_the_end_that_it_makes() -> None:
    bars = [Segment(-3, 0, 0, 0, id="thin"), Segment(0, 0, 0, -3, id="thick", r=1)]
    scene = Scene([Circle(0, 6, vy=-1, vx="1/9", id="c")], segments=bars)
    for run in (DoubleEngine().run(scene, until=9), PymunkEngine().run(scene, until=9)):
        assert run.events[0].contacts == (("c", "thick"),)


def test_a_scene_in_doubles_has_its_segments() -> None:
    scene = Scene([Circle(0, 5)], [Wall(9, 0, 9, 1)], segments=[Segment(0, 0, "1/3", "sqrt(2)", id="s", r="1/10")])
    (row,) = floats_json(scene)["segments"]
    assert (row["x1"], row["y1"], row["r"]) == (1 / 3, 2**0.5, 0.1)
    assert row["error"]["x1"] == pytest.approx(1.850371707708594e-17)
    rows = [*csv.reader(io.StringIO(floats_csv(scene)))]
    assert rows[2][:7] == ["segment", "s", "0.0", "0.0", repr(1 / 3), repr(2**0.5), "0.1"]
    assert "segments" not in floats_json(Scene([Circle(0, 5)]))
