"""The pinball of three discs: its orbits proved and run, what the cycle expansion gives, and certified escape."""

from __future__ import annotations

import math
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from flint import arb
from pinball import (
    NotProved,
    Orbit,
    _found,
    _Path,
    _proved,
    averages,
    determinant,
    escape,
    fan,
    ladder,
    main,
    orbit,
    pinball,
    rate_between,
    visited,
    words,
)

from truebreak.compare.tangent.growth import Displacements, unit_displacements
from truebreak.compare.tangent.impacts import impacts
from truebreak.exact import ExactEngine
from truebreak.exact.numbers import ball
from truebreak.scenarios import Circle, Quantity, SceneError

SIX = pinball(Quantity.of(6))
ESCAPE_RATE = "0.4103384077693464893384613078192"


def test_words_are_the_cycles_of_two_letters_each_once() -> None:
    """As many of n letters as Moebius' formula says; no two are rotations of each other."""
    told = list(words(9))
    moebius = {1: 1, 2: -1, 3: -1, 4: 0, 5: -1, 6: 1, 7: -1, 8: 0, 9: 0}
    for n, count in Counter(map(len, told)).items():
        assert count == sum(moebius[k] * 2 ** (n // k) for k in moebius if n % k == 0) // n
    rotations = [min(word[k:] + word[:k] for k in range(len(word))) for word in told]
    assert len(set(rotations)) == len(told)


@pytest.mark.parametrize(
    ("word", "length", "multiplier"),
    [
        ("0", "4.000000000000", "9.898979485566"),
        ("1", "4.267949192431", "-11.77145519638"),
        ("01", "8.316529485168", "-124.0948019921"),
        ("001", "12.321746616182", "-1240.542557041"),
        ("011", "12.580807741032", "1449.545074956"),
    ],
)
def test_orbits_are_those_that_are_published(word: str, length: str, multiplier: str) -> None:
    """The table of ChaosBook (recalled)."""
    told = orbit(SIX, word)
    assert float(abs(told.length - arb(length))) < 1e-12
    assert float(abs(told.multiplier / arb(multiplier) - 1)) < 1e-12
    assert float(told.multiplier.rad()) < 1e-60


def test_the_two_simplest_have_their_closed_forms() -> None:
    with ball.precision(320):
        across, round_ = orbit(SIX, "0"), orbit(SIX, "1")
        assert across.multiplier.overlaps(5 + 2 * arb(6).sqrt())
        assert round_.length.overlaps(6 - arb(3).sqrt())
    assert round_.multiplier.str(20, radius=False) == "-11.771455196385560606"


@pytest.mark.parametrize("word", list(words(5)))
def test_a_certified_run_from_beside_an_orbit_takes_it_and_is_stretched_as_it_says(word: str) -> None:
    """From within 10**-60 of the middle of the first flight, for the whole of the way until the triangle is mapped to
    itself: at most six periods."""
    told = orbit(SIX, word)
    discs, turns = _whole(word)
    with ball.precision(320):
        (ax, ay), (bx, by) = told.points[0], _next(told)
        leg = ((bx - ax) ** 2 + (by - ay) ** 2).sqrt()
        places = [_near((a + b) / 2) for a, b in ((ax, bx), (ay, by))]
        speeds = [_near((b - a) / leg) for a, b in ((ax, bx), (ay, by))]
    start = Circle(*places, r=0, vx=speeds[0], vy=speeds[1], id="ball", point=True)
    scene = SIX.with_changes(circles=[start, *SIX.circles[1:]])
    run = ExactEngine().run(scene, events=len(discs))
    assert run.certified
    assert [event.contacts[0].second for event in run.events] == [f"disc {k + 1}" for k in discs]
    carried = Displacements(scene, unit_displacements(scene))
    for struck in impacts(run, len(discs)):
        carried.through(struck)
    carried.fly(float(told.length) * turns)
    trace = float(np.trace(carried.matrix)) * 2.0**carried.scale
    assert trace - 2 == pytest.approx(float(told.multiplier) ** turns, rel=1e-6 + 1 / float(told.multiplier) ** 2)


def _whole(word: str) -> tuple[list[int], int]:
    """The discs that are hit after the first, until the path is closed without a symmetry, and the periods it takes."""
    for turns in range(1, 7):
        discs = visited(word * turns)
        if discs[-2:] == discs[:2]:
            return list(discs[1 : len(word) * turns + 1]), turns
    raise AssertionError("a symmetry of the triangle has order 1, 2 or 3")


def _next(told: Orbit) -> tuple[arb, arb]:
    """The second bounce: of a word of one letter the image of the first."""
    if len(told.points) > 1:
        return told.points[1]
    return _Path(SIX, told.word).turned(told.points[0])


def _near(value: arb) -> Quantity:
    """A rational number within 10**-60."""
    return Quantity.of(int((value * arb(10) ** 60).mid().floor().unique_fmpz() or 0)) / 10**60


def test_a_box_beside_the_orbit_is_not_proved() -> None:
    with ball.precision(320):
        path = _Path(SIX, "01")
        found = _found(path, "01", 320)
        assert _proved(path, found, "01", 320)
        with pytest.raises(NotProved, match="01: the orbit is not enclosed"):
            _proved(path, [found[0] + arb(2) ** -200, found[1]], "01", 320)


def test_discs_that_may_stand_in_the_way_are_refused() -> None:
    with pytest.raises(SceneError, match="some paths may be cut off"):
        pinball(Quantity.of("23/10"))
    assert orbit(pinball(Quantity.of("5/2")), "01").length > 0


def test_the_determinant_has_the_slope_that_it_says() -> None:
    orbits = [orbit(SIX, word) for word in words(4)]
    with ball.precision(320):
        at, step = arb("-0.3"), arb(2) ** -100
        value, slope, _ = determinant(orbits, 4, at)
        assert float((determinant(orbits, 4, at + step)[0] - value) / step / slope) == pytest.approx(1, abs=1e-12)


def test_the_first_order_is_the_formula_by_hand() -> None:
    """1 less two weights, each exp(-s T)/((|M| - 1)(1 - 1/|M|)) with the sign of M minded."""
    told = averages([orbit(SIX, "0"), orbit(SIX, "1")], 1)
    g, two, three = float(told.escape), 5 + 2 * math.sqrt(6), -11.771455196385560606
    weights = [math.exp(g * t) / abs((1 - m) * (1 - 1 / m)) for t, m in ((4.0, two), (6 - math.sqrt(3), three))]
    assert sum(weights) == pytest.approx(1)


def test_the_escape_rate_has_the_31_published_digits_and_the_others_theirs() -> None:
    *_, before, told = ladder(Quantity.of(6), 12)
    assert told.orbits == 747
    assert told.escape.str(60, radius=False).startswith(ESCAPE_RATE)
    assert told.exponent.str(10, radius=False) == "0.5775525788"
    assert told.entropy.str(10, radius=False) == "0.1672141710"
    assert float(abs(told.escape - before.escape)) < 1e-34


def test_each_order_gains_digits() -> None:
    wanted = arb(ESCAPE_RATE)
    off = [float(abs(told.escape - wanted)) for told in ladder(Quantity.of(6), 6)]
    assert all(later < sooner / 10 for sooner, later in pairwise(off))


def test_a_short_fan_has_the_rate_within_what_it_may_be_off_by() -> None:
    told = escape(Quantity.of(6), 1000)
    assert told.survivors[:3] == (983, 195, 36)
    assert told.room < 0.02
    assert abs(told.rate - float(ESCAPE_RATE)) < told.room + 0.002 * told.rate


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_wide_fan_has_the_rate_to_half_a_percent() -> None:
    told = escape(Quantity.of(6), 20_000)
    assert told.room < 0.0012
    assert abs(told.rate - float(ESCAPE_RATE)) < told.room + 0.002 * told.rate


def test_a_fan_is_spread_over_the_first_disc() -> None:
    slopes = [float(scene.circles[0].vy / scene.circles[0].vx) for scene in fan(Quantity.of(6), 5)]
    assert slopes == sorted(slopes)
    assert 0 < slopes[0] < 0.05 and slopes[-1] == pytest.approx(math.tan(2 * math.atan(0.135)))


def test_no_survivor_is_an_error() -> None:
    with pytest.raises(SceneError, match="take more of them"):
        rate_between([1.0], [])


def test_the_command_prints_both(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--letters", "3", "--runs", "60"]) == 0
    told = capsys.readouterr().out
    assert "| 3 | 5 | 0.41033813795161215735920991139871 |" in told
    assert "60 certified runs: 59, 12, 2 bounce" in told


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--distance", "2"], "some paths may be cut off"),
        (["--distance", "six"], "--distance"),
        (["--letters", "0"], "must be whole numbers from 1"),
        (["--letters", "1", "--runs", "1"], "take more of them"),
    ],
)
def test_bad_input_is_one_line(arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 2
    told = capsys.readouterr().err
    assert message in told and len(told.splitlines()) == 1
