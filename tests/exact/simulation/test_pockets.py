"""Laws of pockets: entries are told with their instant, change nothing unless the scene says so, and then end play."""

from __future__ import annotations

import pytest

from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine, IntervalEngine
from truebreak.scenarios import Circle, Pocket, Scene, Wall, catalogue

ENGINES = [ExactEngine(), DoubleEngine(), IntervalEngine(200)]


def shot(**changes) -> Scene:
    return Scene(
        [Circle(0, 0, 1, 1, 0, id="a"), Circle(10, 0, 1, id="b")],
        [Wall(20, 0, 20, 1, id="end")],
        pockets=[Pocket(14, 0, 1, id="hole")],
        **changes,
    )


@pytest.mark.parametrize("engine", ENGINES, ids=lambda e: e.name)
def test_an_entry_is_told_with_its_instant(engine):
    """a hits b at 8; b's centre goes 3 to the pocket's rim, on to the wall at 19, and in again at 8 + 9 + 4."""
    run = engine.run(shot(), until=23)
    assert [(p.circle, p.pocket, float(p.time)) for p in run.pocketings] == [("b", "hole", 11.0), ("b", "hole", 21.0)]
    assert [float(e.time) for e in run.events] == [8.0, 17.0]


@pytest.mark.parametrize("engine", ENGINES, ids=lambda e: e.name)
def test_capture_ends_play(engine):
    run = engine.run(shot(capture=True), until=30)
    assert [(p.circle, float(p.time)) for p in run.pocketings] == [("b", 11.0)]
    assert len(run.events) == 1
    assert [float(v) for v in (run.final["b"].x, run.final["b"].vx)] == [13.0, 0.0]


def test_pockets_that_do_not_capture_change_nothing():
    scene = catalogue.build("rack:rows=4,gap=1/50")
    bare = scene.with_changes(pockets=())
    runs = [ExactEngine().run(s, events=150) for s in (scene, bare)]
    assert runs[0].pocketings
    histories = [[(event.impulses, float(event.time)) for event in run.events] for run in runs]
    assert histories[0] == histories[1]


def test_a_symmetric_rack_pockets_symmetrically():
    run = ExactEngine().run(catalogue.build("rack:rows=5,gap=0").with_changes(capture=True), events=120)
    assert run.certified
    times = [float(p.time) for p in run.pocketings]
    assert times and times[::2] == times[1::2]


def test_the_time_of_an_entry_is_exact():
    scene = Scene([Circle(0, 0, 1, 1, "1/2")], pockets=[Pocket(5, 3, 1)])
    [entry] = ExactEngine().run(scene, until=10).pocketings
    assert entry.time.text() == "-2/5*sqrt(19) + 26/5" or abs(float(entry.time) - 4.0) < 2
    x, y = entry.time.sympy() - 5, entry.time.sympy() / 2 - 3
    assert (x**2 + y**2 - 1).expand() == 0
