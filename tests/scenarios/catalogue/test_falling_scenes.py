"""What is known of the falling scenes of the catalogue, against what the engines make of them."""

from __future__ import annotations

from fractions import Fraction
from math import floor

import numpy as np
import pytest

from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Quantity, catalogue
from truebreak.scenarios.trajectory import StopReason


@pytest.mark.parametrize(("h", "g", "e"), [("5", "10", "9/10"), ("1", "2", "1/3"), ("3", "1", "1/2")])
def test_bounce_ends_at_its_exact_time(h: str, g: str, e: str) -> None:
    run = ExactEngine().run(catalogue.build(f"bounce:h={h},g={g},e={e}"))
    loss = Quantity.of(e)
    assert run.stop.reason is StopReason.ACCUMULATION
    assert run.ending is not None
    assert Quantity.of(run.ending.text()) == (Quantity.of(h) * 2 / Quantity.of(g)).sqrt() * (1 + loss) / (1 - loss)


@pytest.mark.parametrize("big", [4, 9, 999])
def test_the_upper_of_a_dropped_pair_is_thrown_back(big: int) -> None:
    run = ExactEngine().run(catalogue.build(f"drop-pair:big={big},gap=1/10**12"), events=2)
    assert float(run.final["tennis"].vy) / 10 == pytest.approx((3 * big - 1) / (big + 1), abs=1e-9)


def test_a_wedge_of_a_right_angle_is_hit_at_equal_intervals_and_a_wider_one_is_not() -> None:
    for slope, equal in (("1", True), ("3/2", False)):
        run = ExactEngine().run(catalogue.build(f"wedge:slope={slope}"), events=16)
        times = [float(event.time) for event in run.events if event.contacts[0].second == "left"]
        assert len(times) > 5
        assert bool(np.ptp(np.diff(times)) < 1e-12) is equal


def test_half_of_the_energy_of_a_gas_without_a_lid_is_that_of_height() -> None:
    run = DoubleEngine().run(catalogue.build("gas-under-gravity"), events=6000)
    rows = run.sample(np.linspace(0, float(run.final_time), 20_000))
    height = (rows[:, :, 1] - 0.1).sum(1)
    motion = (rows[:, :, 2] ** 2 + rows[:, :, 3] ** 2).sum(1) / 2
    assert height.mean() / motion.mean() == pytest.approx(1, abs=0.1)
    assert np.ptp(height + motion) < 1e-9


def test_a_falling_line_keeps_its_energy_and_its_order() -> None:
    run = ExactEngine().run(catalogue.build("falling-line:n=4"))
    assert run.certified
    for state in (run.at(0), run.final):
        ys = [float(circle.y) for circle in state.circles]
        assert ys == sorted(ys)
    masses = [4, 3, 2, 1]
    energy = [
        sum(m * (float(c.vy) ** 2 / 2 + float(c.y)) for m, c in zip(masses, state.circles, strict=True))
        for state in (run.at(0), run.final)
    ]
    assert energy[0] == pytest.approx(energy[1], abs=1e-10)


@pytest.mark.parametrize(("length", "v", "u"), [("8", "1", "1/10"), ("1", "3", "2"), ("5/3", "1/7", "1/3")])
def test_a_closing_wall_quickens_a_disc_by_its_closed_form(length: str, v: str, u: str) -> None:
    run = ExactEngine().run(catalogue.build(f"closing-wall:length={length},v={v},u={u}"))
    assert run.stop.reason is StopReason.CRUSHED
    assert run.ending is not None
    way, speed, wall = map(Fraction, (length, v, u))
    assert Fraction(run.ending.text()) == way / wall
    hits = [event for event in run.events if event.contacts[0].second == "right"]
    assert len(hits) > 5
    time, kept = way / 2 / (speed + wall), None
    for n, event in enumerate(hits, 1):
        assert Fraction(event.time.text()) == time
        left = -Fraction(run.after(event.index)["ball"].vx.text())
        assert left == speed + 2 * n * wall
        here = (way - wall * time) * (speed + (2 * n - 1) * wall)
        assert kept in (None, here)
        kept = here
        time += 2 * (way - wall * time) / (left + wall)


def test_a_slow_piston_keeps_energy_times_area() -> None:
    """Of 16 discs, over five draws; the area is that in which their centres are."""
    ratios = list[float]()
    for seed in range(1, 6):
        run = DoubleEngine().run(catalogue.build(f"piston:n=16,seed={seed},u=1/200"))
        before, after = (sum(float(c.vx) ** 2 + float(c.vy) ** 2 for c in s.circles) for s in (run.at(0), run.final))
        ratios.append(after / before)
    free = (4 - 0.1) / (2 - 0.1)
    assert np.mean(ratios) == pytest.approx(free, rel=0.03)
    quick = DoubleEngine().run(catalogue.build("piston:n=16,u=3"))
    before, after = (sum(float(c.vx) ** 2 + float(c.vy) ** 2 for c in s.circles) for s in (quick.at(0), quick.final))
    assert after / before > 2 * free  # a quick one does more work


@pytest.mark.parametrize(("h", "v", "m"), [("5", "2", "3"), ("1/5", "1/3", "1"), ("45", "7", "1/4")])
def test_what_lands_slides_and_pushes_by_its_closed_form(h: str, v: str, m: str) -> None:
    run = ExactEngine().run(catalogue.build(f"landing:h={h},v={v},m={m}"))
    speed, fall = Quantity.of(v), (Quantity.of(h) / 5).sqrt()
    other, own, push = run.events
    assert Quantity.of(own.time.text()) == fall
    assert Quantity.of(other.time.text()) == fall * Quantity.of("3/5").sqrt()
    assert Quantity.of(push.time.text()) == fall + 1 / speed
    for disc in run.final.circles:
        assert Quantity.of(disc.vx.text()) == speed / (1 + Quantity.of(m))
    assert [(s.circle, s.wall) for s in run.settlings] == [("sitter", "floor"), ("slider", "floor")]
    assert run.stop.reason is StopReason.QUIET


@pytest.mark.parametrize("n", [1, 3, 6])
def test_struck_discs_keep_the_energy_and_lie_until_something_comes(n: int) -> None:
    scene = catalogue.build(f"struck:n={n}")
    run = ExactEngine().run(scene)
    assert run.certified
    assert len(run.events) == 40
    for disc in scene.circles[1:]:
        met = next(
            (event.time for event in run.events if any(disc.id in link for link in event.contacts)), run.final_time
        )
        before = run.at(floor(float(met) * 2**20) / 2**20)[disc.id]
        assert [before.x.text(), before.y.text(), before.vx.text(), before.vy.text()] == [disc.x.text(), "1", "0", "0"]
    energies = [
        sum((float(c.vx) ** 2 + float(c.vy) ** 2) / 2 + 10 * float(c.y) for c in state.circles)
        for state in (run.at(0), run.final)
    ]
    assert energies[0] == pytest.approx(energies[1], abs=1e-10)


@pytest.mark.parametrize(("u", "h", "vx"), [("1", "4", "1/2"), ("3", "2", "1"), ("1/2", "1/5", "2")])
def test_a_disc_on_a_paddle_lands_at_its_closed_form_until_it_is_beyond_the_end(u: str, h: str, vx: str) -> None:
    run = ExactEngine().run(catalogue.build(f"paddle:u={u},h={h},vx={vx}"))
    rise, along = Quantity.of(u), Quantity.of(vx)
    landing = (rise * rise + 20 * Quantity.of(h)).sqrt()
    time, over = (landing - rise) / 10, 0
    while along * time < 8:
        event = run.events[over]
        assert event.contacts[0].second == "paddle"
        assert Quantity.of(event.time.text()) == time
        assert Quantity.of(run.after(over)["ball"].vy.text()) == landing + rise
        time, over = time + landing / 5, over + 1
    assert over > 1
    assert len(run.events) <= over + 1  # the end itself may be met once more


@pytest.mark.parametrize("e", ["1/20", "1/15", "1/100"])
def test_a_collapse_has_no_last_hit_below_its_restitution(e: str) -> None:
    run = ExactEngine().run(catalogue.build(f"collapse:e={e}"))
    assert run.stop.reason is StopReason.ACCUMULATION
    x, v = [Fraction(0), Fraction(3), Fraction(13, 2)], [Fraction(1), Fraction(0), Fraction(-1)]
    now, last = Fraction(0), None
    for _ in range(60):
        closing = [k for k in (0, 1) if k != last and v[k] > v[k + 1]]
        wait, last = min(((x[k + 1] - x[k] - 2) / (v[k] - v[k + 1]), k) for k in closing)
        now, x = now + wait, [a + b * wait for a, b in zip(x, v, strict=True)]
        mean, part = (v[last] + v[last + 1]) / 2, Fraction(e) * (v[last + 1] - v[last]) / 2
        v[last], v[last + 1] = mean + part, mean - part
    assert run.ending is not None
    assert float(run.ending) == pytest.approx(float(now), abs=1e-12)


@pytest.mark.parametrize("e", ["3/40", "1/10", "1/2"])
def test_above_it_the_last_hit_leaves_them_apart(e: str) -> None:
    run = ExactEngine().run(catalogue.build(f"collapse:e={e}"))
    assert run.stop.reason is StopReason.QUIET
    assert [float(c.vx) for c in run.final.circles] == sorted(float(c.vx) for c in run.final.circles)
