"""What is recorded of an engine is what the engine did."""

from __future__ import annotations

import math
from typing import Any

import pytest
from logs import without_limits

from truebreak.compare import compare
from truebreak.compare.foreign import LogEngine, Recording
from truebreak.compare.foreign.impulses import least
from truebreak.compare.validation import EngineError
from truebreak.floating import DoubleEngine, PymunkEngine, SingleEngine
from truebreak.scenarios import Circle, Pocket, Scene, StopReason, Wall, catalogue

PAIR = Scene([Circle(0, 0, vx=1, id="a"), Circle(4, 0, id="b")], [Wall(9, 0, 9, 1, id="w")], name="pair")


@pytest.mark.parametrize(
    "name", ["gas", "tennis", "cradle", "rack", "rack:gap=1/50", "lorentz", "pinball", "gas:mixed=yes"]
)
def test_states_after_each_step_tell_what_pymunk_met(name: str) -> None:
    """Contacts are inferred from velocities alone, and are those that pymunk itself reports."""
    scene = without_limits(catalogue.build(name)).with_changes(pockets=(), capture=False)
    engine = PymunkEngine(dt=1 / 256)
    run = engine.run(scene, until=12)
    recording = Recording(scene, step=engine.dt, until=12)
    steps = 0
    while recording.open:
        steps += 1
        recording.state(steps * engine.dt, run.at(steps * engine.dt).array())
    told = recording.trajectory()
    assert [(float(e.time), set(e.contacts)) for e in told.events] == [
        (float(e.time), set(e.contacts)) for e in run.events
    ]
    assert [e.coupled for e in told.events] == [e.coupled for e in run.events]
    apart = told.sample([0.0, 6.0, 12.0]) - run.sample([0.0, 6.0, 12.0])
    assert float(abs(apart).max()) < 1e-9


@pytest.mark.parametrize("name", ["gas", "cradle", "lorentz"])
def test_states_now_and_then_tell_it_without_a_step(name: str) -> None:
    """Of an engine of events that says where things are every 1/64: a contact lies up to so much before."""
    scene = without_limits(catalogue.build(name))
    run = DoubleEngine().run(scene, until=12)
    recording = Recording(scene, until=12)
    for k in range(1, 12 * 64 + 1):
        recording.state(k / 64, run.at(k / 64).array())
    told = recording.trajectory()
    assert [e.contacts for e in told.events] == [e.contacts for e in run.events]
    assert len(told.events) > 2
    for one, other in zip(told.events, run.events, strict=True):
        assert 0 <= float(one.time) - float(other.time) <= 1 / 64


@pytest.mark.parametrize("name", ["gas", "tennis", "cradle", "galperin", "lorentz", "reversal:after=10", "sizes"])
@pytest.mark.parametrize("engine", [DoubleEngine(), SingleEngine()], ids=["double", "single"])
def test_times_alone_lead_along_the_run(name: str, engine: Any) -> None:
    """Without states, the laws put the circles where the engine has them, as long as rounding has not grown."""
    scene = without_limits(catalogue.build(name))
    run = engine.run(scene, events=20)
    recording = Recording(scene, bits=engine.bits)
    for event in run.events:
        recording.hits(float(event.time), event.impulses)
    told = recording.trajectory(events=20)
    assert [e.contacts for e in told.events] == [e.contacts for e in run.events]
    end = float(run.events[-1].time)
    times = [end * k / 8 for k in range(8)]
    far = float(abs(told.sample(times) - run.sample(times)).max())
    assert far < (1e-6 if engine.bits == 53 else 1.0)
    assert (told.reversal is None) == (run.reversal is None)


def test_the_inferred_impulses_do_not_pull() -> None:
    import numpy as np

    rng = np.random.default_rng(5)
    for size in range(1, 9):
        arms = rng.normal(size=(size, 3))
        square, wanted = arms @ arms.T, arms @ rng.normal(size=3)
        found = least(square, wanted)
        slack = wanted - square @ found
        assert (found >= 0).all()
        assert slack.max() <= 1e-9 * abs(wanted).max()
        assert abs(found * slack).max() <= 1e-9 * abs(wanted).max()


def test_an_instant_of_several_contacts_goes_by_the_laws() -> None:
    lee = catalogue.build("lee")
    recording = Recording(lee)
    recording.hits(1.0, [("left", "middle"), ("middle", "right")])
    assert [round(c.vx, 12) for c in recording.trajectory().final.circles] == [-2.0, -1.0, 0.0]
    recording = Recording(lee)
    for pair in (("left", "middle"), ("right", "middle")) * 2:
        recording.hit(1.0, *pair)
    ends = [round(c.vx, 12) for c in recording.trajectory().final.circles]
    assert ends == [-11 / 5, -8 / 25, -3 / 25]


def test_the_order_of_an_exact_tie_is_a_divergence() -> None:
    lee = catalogue.build("lee")
    log = [(1.0, "left", "middle"), (1.0, "middle", "right"), (1.0, "left", "middle")]
    found = compare(lee, [LogEngine.of(log, lee, "mine")], until=2)["mine"]
    assert found.alignment.divergence is not None
    assert found.alignment.divergence.kind.name == "TIE"


def test_where_the_laws_do_not_have_them_approach_it_is_said() -> None:
    recording = Recording(PAIR)
    recording.hit(2.0, "a", "b")
    recording.hit(3.0, "a", "b")
    assert "event 1: with the times reported, the laws do not have a and b approach" in recording.trajectory().notes[0]


def test_limits_end_a_recording() -> None:
    recording = Recording(PAIR, events=1)
    assert recording.open
    recording.hit(2.0, "a", "b")
    assert not recording.open
    assert recording.trajectory().stop.reason is StopReason.EVENTS
    recording = Recording(PAIR, until=3)
    recording.hit(2.0, "b", "a")
    assert recording.open
    assert recording.trajectory().stop.message == "the record ends at time 2.0"
    recording.hit(6.0, "b", "w")
    assert not recording.open
    run = recording.trajectory()
    assert (len(run.events), float(run.final_time), run.stop.reason) == (1, 3.0, StopReason.HORIZON)


def test_a_recording_of_steps_is_quiet_when_nothing_comes_nearer() -> None:
    recording = Recording(Scene([Circle(0, 0, vx=-1, id="a"), Circle(4, 0, id="b")]), step=1.0)
    recording.state(1.0, [(-1, 0, -1, 0), (4, 0, 0, 0)])
    assert not recording.open
    assert recording.trajectory().stop.reason is StopReason.QUIET


def test_pockets_are_entered_by_the_flights() -> None:
    scene = Scene([Circle(0, 0, vx=1, id="a"), Circle(4, 0, id="b")], pockets=[Pocket(8, 0, 1, id="p")])
    recording = Recording(scene)
    recording.hit(2.0, "a", "b")
    recording.end(9)
    assert [(e.circle, e.pocket, float(e.time)) for e in recording.trajectory().pocketings] == [("b", "p", 5.0)]


@pytest.mark.parametrize(
    ("report", "told"),
    [
        (lambda r: r.hit(1.0, "a", "nobody"), "contacts has 'nobody', which is not in the scene"),
        (lambda r: r.hit(1.0, "a", "a"), "contacts has ('a', 'a')"),
        (lambda r: r.hit(1.0, "w", "w"), "contacts has ('w', 'w')"),
        (lambda r: r.hit(math.nan, "a", "b"), "time = nan; must be finite"),
        (lambda r: r.hit("1", "a", "b"), "time = '1'; must be a number"),
        (lambda r: r.hit(None, "a", "b"), "time = None; must be a number"),
        (lambda r: r.hit(-1.0, "a", "b"), "time = -1.0 is before the start"),
        (lambda r: [r.hit(2.0, "a", "b"), r.hit(1.0, "b", "w")], "time = 1.0 comes before 2.0"),
        (lambda r: r.hit(2.0, "a", "b", {"a": (1, 2, 3, 4)}), "states lacks 'b', which collides"),
        (lambda r: r.hit(2.0, "a", "b", {"w": (1, 2, 3, 4)}), "states has 'w', which is no circle"),
        (lambda r: r.hit(2.0, "a", "b", {"a": (1, 2, 3)}), "states: 'a' = (1, 2, 3); must be x, y, vx, vy"),
        (lambda r: r.hit(2.0, "a", "b", {"a": (1, math.inf, 3, 4)}), "states: 'a': y = inf; must be finite"),
        (lambda r: r.state(2.0, [(1, 2, 3, 4)]), "of all 2 circles in scene order"),
        (
            lambda r: r.state(1.0, [(1, 0, 1, 0), (4, 0, 1, 0)]),
            "where its flight has (0, 0), and no contact",
        ),
        (lambda r: r.hits(1.0, [("a", "b", "w")]), "must be two ids"),
    ],
)
def test_what_cannot_be_is_refused(report: Any, told: str) -> None:
    with pytest.raises(EngineError) as caught:
        report(Recording(PAIR, "mine"))
    assert str(caught.value).startswith("engine 'mine': ")
    assert told in str(caught.value)


def test_two_that_never_move_do_not_collide() -> None:
    scene = Scene([Circle(0, 0, m="oo", id="a"), Circle(4, 0, m="oo", id="b")])
    with pytest.raises(EngineError, match="neither ever moves"):
        Recording(scene).hit(1.0, "a", "b")
