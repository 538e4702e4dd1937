"""Scenes in which doubles tell times loosely, or not at all: the engine once left out what it should have looked at."""

from __future__ import annotations

import pytest

from fuzz.check import check
from fuzz.draft import F
from fuzz.examine import examine
from truebreak.compare import engine
from truebreak.exact import ExactEngine
from truebreak.exact.simulation.prediction import ArrivalQueue
from truebreak.scenarios import Circle, Pocket, Scene, Trajectory

pytestmark = pytest.mark.timeout(120)


def played(scene: Scene, until=None, events: int | None = None) -> Trajectory:
    """The run, held against the referee as well."""
    check(scene, until, events)
    return ExactEngine().run(scene, until=until, events=events)


# -- grazes beside arrivals whose times doubles tell loosely, as one circle is 10**12 times as fast as the others


SWIFT = [
    ("c1", 0, 0, -(10**12), 0, 1), ("c3", 0, 4, -1, 1, 10**6), ("c5", 0, 8, 0, -1, 1), ("c6", 4, 8, -1, 1, 1),
    ("c9", 0, 16, 0, 0, 1), ("c11", 0, 20, -1, 0, 1), ("c13", 0, 24, 0, 0, 2), ("c14", 4, 24, -1, 0, 2),
    ("c66", 4, 128, -1, 0, 2), ("c67", 0, 132, 0, 1, 1), ("c71", 0, 140, 0, 0, "oo"),
]  # fmt: skip


@pytest.mark.parametrize("start", [(0, 0), (-(10**9), 10**12)])
def test_what_comes_between_a_graze_and_the_first_to_collide_is_seen(start):
    """A graze ended the search for what may come first, so that 126 came before 125.5."""
    x0, y0 = start
    circles = [Circle(x0 + x, y0 + y, 1, F(vx, 10**6), F(vy, 10**6), m=m, id=name) for name, x, y, vx, vy, m in SWIFT]
    run = played(Scene(circles), events=16)
    times = [float(event.time) / 1e6 for event in run.events]
    assert times == sorted(times)
    assert [tuple(c) for event in run.events[-2:] for c in event.contacts] == [("c3", "c66"), ("c9", "c67")]
    assert times[-2:] == pytest.approx([125.51765032770354, 126])


@pytest.mark.parametrize("seed", [1343])
def test_swift_ones_among_slow_ones(seed):
    """Found by the kind of scenes, where an event was left out of an instant's rivals like that."""
    assert examine("swift", seed).outcome == "ok"


def test_a_history_out_of_order_is_never_told(monkeypatch):
    """Whatever else may be wrong: it ends in an error, not in a certified run."""
    monkeypatch.setattr(ArrivalQueue, "alone", lambda self, before: None)
    rivals = ArrivalQueue.rivals

    def late(queue):
        """Without what is first, the second time that it is asked."""
        found = rivals(queue)
        asked.append(found)
        if len(asked) == 2:
            hidden.extend(found)
            return rivals(queue)
        return [*found, hidden.pop()] if hidden else found

    asked, hidden = [], []
    monkeypatch.setattr(ArrivalQueue, "rivals", late)
    scene = Scene(
        [Circle(0, 0, vx=1), Circle(4, 0), Circle(0, 9, vx=1), Circle(8, 9), Circle(0, 18, vx=1), Circle(7, 18)]
    )
    with pytest.raises(AssertionError, match="event 1 comes after event 2"):
        ExactEngine().run(scene, events=3)


# -- a point flies into a pocket whose number is that of a point

POINT = Circle(0, 0, 0, 1, 0, point=True)
ENTRIES = {
    "plain": (Scene([POINT], pockets=[Pocket(5, 0, 1)], capture=True), 4),
    "not told by doubles": (
        Scene([Circle("3.9999999999999999999999999", 0, 0, 1, 0, point=True)], pockets=[Pocket(5, 0, 1)], capture=True),
        F(1, 10**25),
    ),
    "beside a swift one": (
        Scene([POINT, Circle(0, 9, 1, -(10**17))], pockets=[Pocket(5, 0, 1)], capture=True), 4
    ),
    "huge": (
        Scene([Circle(0, 0, 0, "10**60", 0, point=True)], pockets=[Pocket("5*10**60", 0, "10**60")], capture=True), 4
    ),
    "the second of both": (
        Scene(
            [Circle(0, 9, 1), Circle(0, 0, 0, 1, 0, point=True)], pockets=[Pocket(50, 50, 1), Pocket(5, 0, 1)],
            capture=True,
        ), 4
    ),
}  # fmt: skip
"""Scenes, and when the point enters."""


@pytest.mark.parametrize("name", ENTRIES)
def test_a_point_comes_to_a_pocket(name):
    scene, time = ENTRIES[name]
    run = played(scene, until=10)
    assert [float(entry.time) for entry in run.pocketings] == [pytest.approx(float(time), rel=1e-12)]


@pytest.mark.parametrize("kind", ["double", "quad", "interval", "rounded", "single"])
@pytest.mark.parametrize("name", ["plain", "the second of both"])
def test_a_point_comes_to_a_pocket_in_every_engine(name, kind):
    scene, time = ENTRIES[name]
    (entry,) = engine(kind).run(scene, until=10).pocketings
    assert float(entry.time) == pytest.approx(float(time))
