"""What is known of the boards and levels of the catalogue, against what the engines make of them."""

from __future__ import annotations

from itertools import pairwise
from math import acos, cos, hypot, log, sqrt

import pytest

from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Quantity, catalogue
from truebreak.scenarios.trajectory import StopReason, TieProof, Trajectory


def bin_of(run: Trajectory) -> int | None:
    """The first bin of which a ball meets the floor, from 1; None where it comes to none."""
    met = (second for event in run.events for _, second in event.contacts)
    return next((int(name.split()[1]) for name in met if name.startswith("bin")), None)


@pytest.mark.parametrize("seed", range(1, 7))
def test_a_ball_of_a_galton_board_comes_to_a_bin_and_stays(seed: int) -> None:
    run = ExactEngine().run(catalogue.build(f"galton:rows=4,seed={seed}"))
    found = bin_of(run)
    assert found is not None
    assert run.stop.reason in (StopReason.ACCUMULATION, StopReason.UNDECIDED)
    if run.stop.reason is StopReason.ACCUMULATION:
        left = 2 * found - 7
        assert left + 0.5 <= float(run.final["ball"].x) <= left + 1.5
    else:
        assert "accumulation suspected" in run.stop.message


def test_every_bin_is_reached() -> None:
    runs = [DoubleEngine().run(catalogue.build(f"galton:rows=3,seed={seed}"), events=60) for seed in range(80)]
    counts = [sum(bin_of(run) == k for run in runs) for k in range(1, 5)]
    assert all(count > 4 for count in counts)
    assert sum(counts) > 70


def test_an_elastic_board_keeps_its_energy() -> None:
    run = ExactEngine().run(catalogue.build("galton:rows=3,e=1"), events=60)
    assert run.certified

    def energy(state: object) -> float:
        ball = state["ball"]  # pyright: ignore[reportIndexIssue, reportUnknownVariableType]
        return float(ball.vx) ** 2 / 2 + float(ball.vy) ** 2 / 2 + 10 * float(ball.y)  # pyright: ignore[reportUnknownArgumentType, reportUnknownMemberType]

    assert energy(run.final) == pytest.approx(energy(run.at(0)), abs=1e-9)


@pytest.mark.parametrize("slot", [1, 3, 5])
def test_a_disc_of_plinko_goes_the_mirror_image_of_its_way(slot: int) -> None:
    ways = [
        ExactEngine().run(catalogue.build(f"plinko:slot={s},off={off}"), events=12)
        for s, off in ((slot, "1/7"), (10 - slot, "-1/7"))
    ]
    one, other = ([(c.vx, c.vy) for c in (run.after(e.index)["disc"] for e in run.events)] for run in ways)
    assert len(one) == 12
    for (ax, ay), (bx, by) in zip(one, other, strict=True):
        assert float(ax) == -float(bx)
        assert ay.digits(40) == by.digits(40)


def test_mirrored_balls_meet_their_pegs_at_one_instant_row_after_row() -> None:
    run = ExactEngine().run(catalogue.build("peg-mirror:rows=5"), events=60)
    assert run.certified
    assert len(run.events) == 60
    pegs = [event for event in run.events if event.contacts[0].second.startswith("peg")]
    assert len(pegs) > 20
    assert len({event.contacts[0].second.split(",")[0] for event in pegs}) == 5
    for event in pegs:
        assert len(event.contacts) == 2
        (tie,) = event.ties
        assert tie.proof is TieProof.SYMMETRY


@pytest.mark.parametrize(("k", "h"), [(40, 4), (60, 4), (60, 1)])
def test_a_ball_leaves_the_axis_of_a_peg_as_fast_as_is_known(k: int, h: int) -> None:
    run = ExactEngine().run(catalogue.build(f"axis:k={k},h={h}"))
    half = 1 + 4 * h
    rate = half + sqrt(half * half - 1)
    assert abs(len(run.events) - k * log(2) / log(rate)) < 2
    ways = [float(run.at(event.time)["ball"].x) for event in run.events[:-2]]
    growth = [b / a for a, b in pairwise(ways)]
    assert growth
    assert growth[-1] == pytest.approx(rate, rel=0.01)


def test_a_ball_on_the_axis_bounces_for_ever_in_equal_times() -> None:
    run = ExactEngine().run(catalogue.build("axis:k=0"))
    assert len(run.events) == 40
    times = [float(event.time) for event in run.events]
    assert [b - a for a, b in pairwise(times)] == pytest.approx([2 * sqrt(0.8)] * 39, abs=1e-12)
    assert all(float(run.at(event.time)["ball"].x) == 0 for event in run.events)


@pytest.mark.parametrize("h", ["1", "2/3"])
def test_a_ball_bounces_down_a_ramp_by_one_two_three(h: str) -> None:
    run = ExactEngine().run(catalogue.build(f"ramp:h={h}"))
    xs = [Quantity.of(run.at(event.time)["ball"].x.text()) for event in run.events]
    step = Quantity.of(h) * 24 / 5 * 4 / 5
    assert [b - a for a, b in pairwise(xs)] == [step * n for n in range(1, len(xs))]
    assert len(xs) >= 6
    assert xs[-1] <= 80 + Quantity.of("3/10") < xs[-1] + step * len(xs)


@pytest.mark.parametrize("v", [4, 8])
def test_a_jumper_lands_where_school_physics_says(v: int) -> None:
    run = ExactEngine().run(catalogue.build(f"ski-jump:v={v}"))
    first = run.events[0]
    assert first.contacts[0] == ("ball", "slope")
    assert first.time.text() == Quantity.of(f"3*{v}/20").text()
    ball = run.at(first.time)["ball"]
    assert Quantity.of(ball.x.text()) == Quantity.of(f"3*{v}**2/16") * 4 / 5


def test_the_ball_of_platforms_stays_in_its_room() -> None:
    run = ExactEngine().run(catalogue.build("platforms"))
    assert run.certified
    assert len({name for event in run.events for _, name in event.contacts}) > 6
    for event in run.events:
        ball = run.at(event.time)["ball"]
        assert 23 - 1e-9 <= float(ball.x) <= 667 + 1e-9
        assert 63 - 1e-9 <= float(ball.y) <= 357 + 1e-9


def test_a_ball_in_a_bowl_comes_back_after_every_fourth_bounce() -> None:
    off = 2.0**-20
    run = ExactEngine().run(catalogue.build("bowl:h=1/2,off=1/2**20"))
    assert len(run.events) == 40
    ways = [float(run.at(event.time)["ball"].x) / off for event in run.events[:12]]
    assert ways == pytest.approx([1.0, -1.0, -1.0, 1.0] * 3, abs=1e-9)


@pytest.mark.parametrize("h", ["1/3", "4/5", "19/20"])
def test_a_ball_in_a_bowl_turns_about_its_axis_as_fast_as_is_known(h: str) -> None:
    """Where it bounces is at cos((n - 1/2) a) / cos(a / 2) of its way to the axis at first."""
    off = 2.0**-40
    run = ExactEngine().run(catalogue.build(f"bowl:h={h},off=1/2**40"))
    turn = acos(1 - 2 * float(Quantity.of(h)))
    for n, event in enumerate(run.events[:30], 1):
        known = cos((n - 0.5) * turn) / cos(turn / 2)
        assert float(run.at(event.time)["ball"].x) / off == pytest.approx(known, abs=1e-9)


def test_a_ball_from_above_half_of_the_radius_leaves_the_axis_of_a_bowl() -> None:
    low, high = (ExactEngine().run(catalogue.build(f"bowl:h={h},off=1/10**6")) for h in ("9/10", "11/10"))
    assert max(abs(float(low.at(event.time)["ball"].x)) for event in low.events) < 1e-5
    assert max(abs(float(high.at(event.time)["ball"].x)) for event in high.events) > 1e-2


@pytest.mark.parametrize("v", [16, 18, 19, 20])
def test_the_ball_of_a_pinball_table_drains(v: int) -> None:
    run = ExactEngine().run(catalogue.build(f"pinball-table:v={v}"))
    assert run.certified
    assert run.stop.reason is StopReason.ACCUMULATION
    assert run.events[-1].contacts[0] == ("ball", "drain")
    energies: list[float] = []
    for event in run.events:
        ball = run.at(event.time)["ball"]
        x, y = float(ball.x), float(ball.y)
        assert y <= 1 + v * v / 20 + 1e-12
        assert abs(x) <= 5.75 + 1e-12
        assert y >= -0.75 - 1e-12
        assert y <= 14 or hypot(x, y - 14) <= 5.75 + 1e-12
        energies.append(float(ball.vx) ** 2 / 2 + float(ball.vy) ** 2 / 2 + 10 * y)
    assert all(after <= before + 1e-9 for before, after in pairwise(energies))


def test_a_ball_that_rolls_along_the_dome_ends_as_suspected() -> None:
    run = ExactEngine().run(catalogue.build("pinball-table:v=30"))
    assert run.stop.reason is StopReason.UNDECIDED
    assert "accumulation suspected: ball and dome" in run.stop.message
