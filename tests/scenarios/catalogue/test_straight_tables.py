"""What is known of the tables of straight things, and holds."""

from __future__ import annotations

import pytest

from truebreak.compare import compare
from truebreak.compare.chaos.certified_chaos import mapped
from truebreak.compare.chaos.spectrum import spectrum
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine, PymunkEngine
from truebreak.scenarios import Quantity, catalogue


@pytest.mark.parametrize(
    "name", ["barrier", "barrier:height=1/3,vx=1/7,vy=1", "wind-tree", "wind-tree:rows=5,side=1/3"]
)
def test_only_four_velocities_occur(name):
    scene = catalogue.build(name)
    run = ExactEngine().run(scene, events=150)
    assert len(run.events) == 150
    start = scene.circles[0].vx, scene.circles[0].vy
    seen = set()
    for k in range(0, 150, 3):
        ball = run.after(k)["ball"]
        assert {ball.vx.text().lstrip("-"), ball.vy.text().lstrip("-")} == {speed.text() for speed in start}
        seen.add((float(ball.vx) > 0, float(ball.vy) > 0))
    assert len(seen) == 4
    assert {pair.second for event in run.events for pair in event.contacts} - {"left", "right", "top", "bottom"}


@pytest.mark.parametrize("name", ["triangle", "barrier", "wind-tree"])
def test_every_exponent_is_zero(name):
    """Errors that grow in proportion to time have a rate log(t)/t: at four times the time, less than a half of it."""
    scene = catalogue.build(name)
    rates = []
    for events in (250, 1000):
        run = ExactEngine().run(scene, events=events)
        found = spectrum(scene, mapped(run, events), 1)
        assert not found.chaotic
        rates.append(found.per_time().value)
    assert 0 < rates[1] < 0.5 * rates[0]


def test_a_triangle_has_ever_new_directions():
    run = ExactEngine().run(catalogue.build("triangle"), events=1000)
    seen, counts = set(), []
    for k in range(1000):
        ball = run.after(k)["ball"]
        seen.add((ball.vx.text(), ball.vy.text()))
        counts.append(len(seen))
    assert [counts[k - 1] for k in (40, 400, 1000)] == [7, 15, 59]


@pytest.mark.parametrize("off", ["-1/3", "-10**-40", "0", "10**-40", "10**-20", "1/3"])
def test_a_corner_is_told_from_the_side_beside_it(off):
    run = ExactEngine().run(catalogue.build(f"corner-hit:off={off}"))
    (event,) = run.events
    at, after, here = Quantity.of(off), run.after(0)["disc"], event.time
    if at.sign() <= 0:
        assert (here.text(), after.vx.text(), after.vy.text()) == ("2", "0", "1")
        return
    rise = (1 - at * at).sqrt()
    for value, known in ((here, 3 - rise), (after.vx, 2 * at * rise), (after.vy, 1 - 2 * at * at)):
        assert Quantity.of(value.text()) == known


def test_a_floor_of_segments_is_one_floor():
    scene = catalogue.build("ghost")
    for engine in (ExactEngine(), DoubleEngine(), PymunkEngine()):
        (event,) = engine.run(scene).events
        assert event.contacts == (("disc", "end"),)
        assert float(event.time) == pytest.approx(34, abs=PymunkEngine().dt)


def _mirrored(name, axis, other, events):
    """Every circle is where its mirror image is, at several times."""
    run = ExactEngine().run(catalogue.build(name), events=events)
    for k in range(0, len(run.events), 4):
        state = run.after(k)
        for circle in state.circles:
            twin = state[other(circle)]
            for mine, theirs in zip(axis(circle), axis(twin, -1), strict=True):
                assert mine == pytest.approx(theirs, abs=1e-9)
    return run


def test_a_funnel_is_its_own_mirror_image():
    def axis(circle, sign=1):
        return sign * float(circle.x), float(circle.y), sign * float(circle.vx)

    def other(circle):
        side, number = circle.id.split()
        return f"{'left' if side == 'right' else 'right'} {number}"

    run = _mirrored("funnel", axis, other, 100)
    assert {"slope left", "slope right"} <= {pair.second for event in run.events for pair in event.contacts}


def test_balls_leave_a_table_only_into_pockets():
    run = ExactEngine().run(catalogue.build("bumper"), events=300)
    gone = {entry.circle for entry in run.pocketings}
    assert gone
    for ball in run.final.circles:
        if ball.id not in gone:
            assert -1 < float(ball.x) < 93
            assert -1 < float(ball.y) < 43
    assert {pair.second for event in run.events for pair in event.contacts} > {"left", "right", "top right"}


def test_a_break_in_the_axis_stays_in_it():
    run = ExactEngine().run(catalogue.build("bumper:offset=0"), events=60)
    for k in range(0, 60, 6):
        rows = sorted((float(ball.x), float(ball.y), float(ball.vy)) for ball in run.after(k).circles)
        twins = sorted((x, 42 - y, -vy) for x, y, vy in rows)
        assert [value for row in rows for value in row] == pytest.approx([v for row in twins for v in row], abs=1e-9)


def test_breakout_is_followed_by_all():
    scene = catalogue.build("breakout").with_changes(events=12)
    run = ExactEngine().run(scene)
    bricks = {pair.second for event in run.events for pair in event.contacts if pair.second.startswith("brick")}
    assert len(bricks) > 2
    vx, vy = run.final["ball"].vx, run.final["ball"].vy
    assert Quantity.of(vx.text()) ** 2 + Quantity.of(vy.text()) ** 2 == 40**2 + 400**2
    found = compare(scene, ["double", "quad"])
    assert [candidate.verdict for candidate in found.candidates] == ["agree", "agree"]
