"""Final velocities of scenes that turn back at, or before, the end of what is compared."""

from __future__ import annotations

from typing import Any

import pytest

from truebreak.compare import compare
from truebreak.compare.foreign import LogEngine, Recording
from truebreak.scenarios import Circle, Scene, Wall

PAIR = [Circle(0, 0, vx=1, id="a"), Circle(5, 0, id="b"), Circle(0, 9, vx="1/3", id="c")]


@pytest.mark.parametrize("name", ["single", "double", "quad", "rounded:bits=40", "interval:bits=200", "pymunk"])
@pytest.mark.parametrize("limit", [{"events": 1}, {"events": 2}, {"until": 3}, {"until": 4}, {}])
def test_an_engine_that_turns_where_the_reference_ends_has_changed_nothing(name: str, limit: dict[str, Any]) -> None:
    """After its first event, at 3, the scene turns back, and the two collide again at once."""
    (candidate,) = compare(Scene(PAIR, reverse_after=1), [name], causes=False, **limit).candidates
    assert candidate.verdict == "agree"
    assert candidate.changed == ()


@pytest.mark.parametrize(("vx", "changed"), [(1.0, ()), (0.8, ("final_velocities",))])
def test_what_a_log_has_otherwise_after_the_turn_is_told(vx: float, changed: tuple[str, ...]) -> None:
    """a turns back at x = 1, and meets the wall at 4."""
    scene = Scene(PAIR, [Wall(-3, 0, -3, 1, id="wall")], reverse_at=1)
    recording = Recording(scene, "log")
    recording.hit(4.0, "a", "wall", {"a": (-2.0, 0.0, vx, 0.0)})
    recording.end(4.5)
    (told,) = compare(scene, [LogEngine(recording)], until=4.5, causes=False).candidates
    assert (told.verdict, told.changed) == ("agree", changed)


def test_states_before_the_turn_lead_through_it() -> None:
    scene = Scene(PAIR, reverse_at=1)
    recording = Recording(scene, "log", step=0.5)
    for time in (0.5, 1.0):
        recording.state(time, {"a": (time, 0.0, 1.0, 0.0), "b": (5.0, 0.0, 0.0, 0.0), "c": (time / 3, 9.0, 1 / 3, 0.0)})
    recording.end(4.0)
    (told,) = compare(scene, [LogEngine(recording, step=0.5)], until=4, causes=False).candidates
    assert (told.verdict, told.changed) == ("agree", ())
    run = recording.trajectory()
    assert run.reversal is not None
    assert [float(c.vx) for c in run.final.circles] == [-1.0, 0.0, pytest.approx(-1 / 3)]
