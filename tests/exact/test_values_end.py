"""Whatever is asked of a number of a run ends within counted work, and "0" is told of proved zeros alone."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import pytest
from flint import arb

from truebreak.exact import ExactEngine
from truebreak.exact import exact_motion as values
from truebreak.exact.exact_motion import ExactValue
from truebreak.exact.numbers.system import Undecided
from truebreak.exact.replay.state import Constant
from truebreak.exact.simulation.decider import RunLog
from truebreak.scenarios import Circle, Quantity, Scene, SceneError, Wall, catalogue
from truebreak.scenarios.numbers.precision import decimals_of

ENGINE = ExactEngine()


@pytest.mark.parametrize("y", ["10**-300", "10**-400", "10**-500", "-7*10**-3000", "0"])
def test_zero_is_told_of_a_zero_alone(y: str) -> None:
    run = ENGINE.run(Scene([Circle(0, y, id="a"), Circle("1/3", 5, vy=-1, id="b")]), events=3)
    for state in (run.at(run.events[0].time), run.final):
        number = state["a"].y
        told = Quantity.of(number.digits(20).replace("e", "*10**")) if y != "0" else Quantity.of(number.digits(20))
        assert told == Quantity.of(y)
        assert number.text() == Quantity.of(y).text()
        assert float(number) == (0.0 if y == "0" or len(y) > 8 or y > "10**-300" else 1e-300)
        assert Quantity.of(y) - Q(1, 10**290) < number.bounds()[1]


def test_slow_beyond_all_doubles_is_not_at_rest() -> None:
    run = ENGINE.run(Scene([Circle(0, 0, id="a"), Circle(0, 5, vy="-10**-330", id="b")]))
    assert run.stop.reason.name == "QUIET"
    (event,) = run.events
    assert event.time.digits(5) == "3.0000e+330"
    assert run.final["a"].vy.digits(5) == "-1.0000e-330"
    assert run.final["b"].vy.digits(5) == "0"


def number_of(formula: object, near: arb) -> ExactValue:
    """A number of a run of no steps."""
    return ExactValue(RunLog(Scene([Circle(0, 0)]), [], 0), 0, (0,), formula, near)  # type: ignore[arg-type]


class Unproved:
    """A number that no bits tell from zero, and that is in no nested roots."""

    def __call__(self, state: object) -> arb:
        return arb("0 +/- 1") * arb(2) ** -(10**7)


class NoNumber:
    """What balls never tell."""

    def __call__(self, state: object) -> arb:
        return arb.nan()


def test_what_no_bits_tell_ends_in_an_error_that_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ExactValue, "exact", lambda self: None)
    faint, none = number_of(Unproved(), arb("0 +/- 1")), number_of(NoNumber(), arb.nan())
    assert float(faint) == 0.0
    assert faint.ball(500).contains(0)
    assert faint.bounds()[0] <= 0.0 <= faint.bounds()[1]
    with pytest.raises(Undecided, match="neither separated from zero"):
        faint.digits(17)
    assert repr(faint).startswith("ExactValue([+/- ")
    for ask in (lambda: none.digits(17), lambda: none.ball(64), lambda: float(none), none.bounds):
        with pytest.raises(Undecided):
            ask()


def test_a_number_half_way_between_two_doubles_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    half = Q(1) + Q(1, 1 << 53)
    near = arb(half.numerator) / half.denominator + arb("0 +/- 1e-30")
    number = number_of(Constant(Quantity.of(half)), near)
    assert float(number) == 1.0
    monkeypatch.setattr(Constant, "__call__", lambda self, state: near + arb("0 +/- 1e-40"))
    monkeypatch.setattr(ExactValue, "exact", lambda self: None)
    with pytest.raises(Undecided):
        float(number_of(Constant(Quantity.of(half)), near))


@pytest.mark.parametrize("text", ["1 + 2**-53", "1 - 2**-54", "-2500000000000000 - 1/4", "3 * 2**-1075"])
def test_a_number_that_no_bits_tell_from_half_way_has_the_even_double(
    text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    half = Quantity.of(text)
    within = arb("0 +/- 1") * arb(2) ** -(10**7)
    monkeypatch.setattr(Constant, "__call__", lambda self, state: half.ball(10**7) + within)
    monkeypatch.setattr(ExactValue, "exact", lambda self: None)
    number = number_of(Constant(half), half.ball(300) + arb("0 +/- 1e-400"))
    assert float(number) == float(half)
    low, high = number.bounds()
    assert low <= float(number) <= high


def test_decimals_that_no_bits_tell_from_half_way_end_in_an_error_that_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    within = arb("0 +/- 1") * arb(2) ** -(10**7)
    monkeypatch.setattr(Constant, "__call__", lambda self, state: arb(1) / 8 + within)
    monkeypatch.setattr(ExactValue, "exact", lambda self: None)
    number = number_of(Constant(Quantity.of("1/8")), arb(1) / 8 + arb("0 +/- 1e-400"))
    assert number.digits(3) == "0.125"
    with pytest.raises(Undecided, match="half-way between decimals"):
        number.digits(2)


@pytest.mark.parametrize("count", [1, 2, 5, 17])
def test_digits_do_not_depend_on_the_ball_that_they_are_read_from(count: int) -> None:
    for number in (Q(1, 8), Q(1, 3), Q(-5, 2), Q(12345, 10**5), Q(999_999, 10**6), Q(25, 100), Q(-15), Q(10**9)):
        exact = arb(number.numerator) / number.denominator
        told = {
            number_of(Constant(Quantity.of(number)), near).digits(count)
            for near in (
                exact + arb("0 +/- 1e-3"),
                exact + arb("0 +/- 1e-25"),
                arb(number.numerator) / number.denominator,
            )
        }
        assert len(told) == 1
        assert abs(Q(told.pop()) - number) <= abs(number) * Q(1, 2 * 10 ** (count - 1))


def test_decimals_of_a_ball_are_those_of_all_its_numbers() -> None:
    assert decimals_of(arb("0.5 +/- 0.6"), 3) is None
    assert decimals_of(arb("0 +/- 1e-900"), 3) is None
    assert decimals_of(arb.nan(), 3) is None
    assert decimals_of(arb(1) / 3, 10) == "0.3333333333"


@pytest.mark.parametrize("name", ["inscribed:n=3", "gas:n=4", "cradle", "lorentz", "galperin"])
def test_a_resumed_run_tells_the_same_text_and_digits(name: str) -> None:
    scene = catalogue.build(name)
    whole = ENGINE.run(scene, events=6)
    resumed = ENGINE.resume(ENGINE.run(scene, events=2), events=6)
    for one, other in zip(whole.events, resumed.events, strict=True):
        assert one.time.digits(30) == other.time.digits(30)
    for k, (one, other) in enumerate(zip(whole.final.circles, resumed.final.circles, strict=True)):
        for key in ("x", "y", "vx", "vy"):
            mine, its = getattr(one, key), getattr(other, key)
            assert mine.digits(30) == its.digits(30)
            assert k > 1 or mine.text() == its.text()


def test_zero_is_told_alike_of_a_run_that_was_resumed() -> None:
    circles = [
        Circle(0, 3, 2, 0, -1, 2, id="h"),
        Circle(-2, "-3/2", "1/2", m="oo", id="f1"),
        Circle("-69/13", "-32/13", 1, "24/13", "-3/13", 1, id="g2"),
    ]
    scene = Scene(circles)
    whole, resumed = ENGINE.run(scene, events=6), ENGINE.resume(ENGINE.run(scene, until=3), events=6)
    for run in (whole, resumed):
        assert (run.final["h"].x.digits(30), run.final["h"].y.digits(30)) == ("0", "0")


def test_times_beyond_doubles_limit_runs_and_are_asked_for() -> None:
    speed = Q(1, 7 * 10**400)
    walls = [Wall(-2, 0, -2, 1), Wall(10, 0, 10, 1), Wall(0, -2, 1, -2), Wall(0, 10, 1, 10)]
    circles = [Circle(0, 0, 1, 5 * speed, 3 * speed, id="a"), Circle(4, 4, 1, -2 * speed, 7 * speed, id="b")]
    scene = Scene(circles, walls)
    long = ENGINE.run(scene, until=100 * 10**400)
    assert long.stop.reason.name == "HORIZON"
    assert len(long.events) > 20
    short = ENGINE.run(scene, events=len(long.events))
    assert [e.contacts for e in short.events] == [e.contacts for e in long.events]
    resumed = ENGINE.resume(ENGINE.run(scene, events=5), until=100 * 10**400)
    assert [e.time.digits(20) for e in resumed.events] == [e.time.digits(20) for e in long.events]
    times = [Quantity.of(e.time.digits(40).replace("e+", "*10**")) for e in long.events]
    for time in (10**400, 50 * 10**400):
        state, again = long.at(time), ENGINE.run(scene, until=time)
        assert len(again.events) == sum(earlier < time for earlier in times)
        assert state["a"].x.digits(30) == again.final["a"].x.digits(30)
    with pytest.raises(ValueError, match=r"e\+40\d is after the end"):
        long.at(10**403)


def test_the_work_of_a_number_is_bounded_by_what_its_first_replay_costs() -> None:
    log = ENGINE.run(catalogue.build("gas:n=3"), events=5).motion.log
    assert values.VALUE_WORK + values.MORE_WORK * log.units(320, 10) < 10**7
    assert log.units(10**6, 10) > 1000 * log.units(256, 10)


@pytest.mark.parametrize("count", [0, -1, True, 1.5, "3", None, 2**70, float("nan")])
def test_what_is_asked_of_a_number_is_a_whole_number_within_bounds(count: Any) -> None:
    """Of any number, a billion digits would take more memory than there is; what is no number is no count."""
    run = ExactEngine().run(catalogue.build("gas:n=3"), events=30)
    numbers = [
        run.events[-1].time,
        run.final.circles[0].x,
        ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 0)])).events[0].time,
    ]
    for number in (*numbers, Quantity.of("sqrt(2)"), Quantity.of(3)):
        with pytest.raises(SceneError, match=r"digits\(.*: must be a whole number from 1 to 1,000,000"):
            number.digits(count)
    for number in numbers:
        with pytest.raises(SceneError, match=r"ball\(.*: must be a whole number from 1 to 4,000,000"):
            number.ball(count)
