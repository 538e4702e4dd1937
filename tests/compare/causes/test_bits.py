"""The bits that would have been enough: what is told is tried here again."""

from __future__ import annotations

from dataclasses import replace

import pytest

from truebreak.compare import compare, engine
from truebreak.compare.candidate import Candidate
from truebreak.compare.causes import margin as enough
from truebreak.compare.causes.decision import Pairing
from truebreak.compare.causes.margin import BallRun, BitsEnough, Margin
from truebreak.compare.causes.reader import RunReader
from truebreak.compare.report.sentences import margin_phrase
from truebreak.exact.exact_engine import ExactEngine
from truebreak.exact.numbers import ball
from truebreak.scenarios import Circle, Scene, catalogue


def told(scene: Scene, name: str, events: int) -> tuple[Candidate, BitsEnough]:
    """What is said of one engine."""
    found = compare(scene, [name], events=events).candidates[0]
    assert found.margin is not None
    return found, found.margin.enough


FAR = ("gas", "gas:n=5,seed=2", "gas:seed=14", "rack:rows=4,gap=1/7,jitter=1/1000,seed=7033,offset=1/26,speed=20")


@pytest.mark.parametrize("name", ["double", "pymunk"])
@pytest.mark.parametrize("text", FAR)
def test_a_run_in_so_many_balls_comes_past_the_divergence_and_in_one_bit_less_does_not(text: str, name: str) -> None:
    scene = catalogue.build(text)
    found, bits = told(scene, name, 300)
    assert found.alignment.divergence is not None
    event = found.alignment.divergence.event
    assert bits.by == "run"
    assert bits.bits is not None
    reached = [BallRun(b).run(scene, None, event + 1)[0] for b in (bits.bits, bits.bits - 1)]
    assert reached[0] == event + 1
    assert bits.short in (None, bits.bits - 1)
    assert bits.short is None or reached[1] <= event
    # Intervals of other code come past it too, if not with the same bits.
    assert len(engine(f"interval:bits={2 * bits.bits + 64}").run(scene, events=event + 1).events) == event + 1
    told_so = margin_phrase(found) or ""
    assert f"{bits.bits} bits decide it (found by runs in " in told_so
    assert ("of one less" in told_so) == (bits.short is not None)


def test_a_late_divergence_has_them_too() -> None:
    found, bits = told(catalogue.build("gas:seed=3"), "quad", 500)
    assert found.alignment.divergence is not None
    assert found.alignment.divergence.event > 250
    assert bits.bits is not None
    assert bits.bits > 106


LATER = Scene(
    [
        Circle(-100, 0, vx=1, id="one"),
        Circle(-96, 1, vx=-1, id="other"),
        Circle(-100, 9, vx=1, id="third"),
        Circle(-96, 10, vx=-1, id="fourth"),
        Circle("-1 - 5", "2 - 1/10**30", vx=1, id="mover"),
        Circle(0, 0, id="target"),
    ]
)
"""Two pairs meet at one exact instant, which no width of balls tells; later comes a near graze."""


def test_beyond_an_exact_tie_the_log_is_carried_out() -> None:
    scene = LATER
    assert BallRun(4096).run(scene, None, 2)[0] < 2
    found, bits = told(scene, "double", 5)
    assert found.alignment.divergence is not None
    assert found.alignment.divergence.event >= 1
    assert bits.by == "replay"
    assert bits.bits is not None
    assert 50 < bits.bits < 128
    assert "found by replays of the exact run's log" in (margin_phrase(found) or "")


def test_a_replay_takes_no_more_bits_than_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = catalogue.build("gas")
    _, ran = told(scene, "double", 300)
    monkeypatch.setattr(enough, "MOST_EVENTS", 0)
    _, replayed = told(scene, "double", 300)
    assert (ran.by, replayed.by) == ("run", "replay")
    assert replayed.bits is not None
    assert ran.bits is not None
    assert 53 < replayed.bits <= ran.bits
    assert replayed.short == replayed.bits - 1


def test_where_none_is_given_it_is_said_why(monkeypatch: pytest.MonkeyPatch) -> None:
    assert told(catalogue.build("grazing"), "double", 5)[1] == BitsEnough(told="no number of bits tells an exact zero")
    monkeypatch.setattr(enough, "MOST_WORK", 1 << 12)
    assert told(catalogue.build("gas"), "double", 300)[1].told == "not searched: the run has more than 8 steps"
    found = compare(catalogue.build("gas:n=4"), ["exact"], reference="double", events=200).candidates[0]
    assert found.margin is None or found.margin.enough.told.startswith("not searched: double keeps no log")


@pytest.mark.parametrize("pair", [("b8", "b9"), ("b4", "b5")])
def test_two_that_touch_and_part_miss_by_exactly_zero(pair: tuple[str, str]) -> None:
    run = ExactEngine().run(catalogue.build("rack:rows=5"), events=1)
    told = RunReader(run).least_gap(Pairing(*pair, dict.fromkeys(pair, 0)))
    assert told is not None
    assert ball.sign_of(told) == 0


def test_what_no_double_tells_from_zero_is_called_neither_a_hit_nor_a_miss() -> None:
    found, _ = told(catalogue.build("grazing"), "double", 5)
    near = replace(found, margin=Margin(None, (-5e-324, 5e-324), None))
    assert margin_phrase(near) == "in the exact motion it is less than 4.94e-324 from a touch"
