"""Engines are judged by what they declare, and what they hand back is checked first."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import pytest

from truebreak.compare import compare
from truebreak.compare.validation import EngineError, check_engine, check_trajectory
from truebreak.floating import DoubleEngine, IntervalEngine, PymunkEngine
from truebreak.scenarios import Circle, Contact, Declared, Scene, SceneError, Trajectory, catalogue
from truebreak.scenarios.engine import SCENE_KEYS

PAIR = Scene([Circle(0, 0, vx=1, id="a"), Circle(4, "1/3", id="b")], name="pair")


@dataclass(frozen=True)
class Altered(Declared):
    """Doubles, with something done to what they hand back."""

    alter: Callable[[Trajectory], Any]
    name: str = "mine"

    def run(self, scene: Scene, **limits: Any) -> Any:
        return self.alter(DoubleEngine().run(scene, **limits))


def swapped(run: Trajectory) -> Trajectory:
    event = run.events[0]
    back = tuple(Contact(b, a) for a, b in event.contacts)
    return replace(run, events=(replace(event, contacts=back, impulses=back),))


def named(name: str) -> Callable[[Trajectory], Trajectory]:
    pair = (Contact("a", name),)
    return lambda run: replace(run, events=(replace(run.events[0], contacts=pair, impulses=pair),))


def timed(*times: float) -> Callable[[Trajectory], Trajectory]:
    def alter(run: Trajectory) -> Trajectory:
        events = tuple(replace(run.events[0], index=k, time=t) for k, t in enumerate(times))
        return replace(run, events=events)

    return alter


@pytest.mark.parametrize(
    ("alter", "told"),
    [
        (lambda run: None, "run gave None"),
        (lambda run: replace(run, final_time=float("nan")), "final_time = nan; must be finite"),
        (lambda run: replace(run, final_time=0.0), "final_time = 0.0 is before its last event"),
        (lambda run: replace(run, final_time=None), "final_time = None; must be a number"),
        (swapped, "event 0: contacts has ('b', 'a'); put the circle that comes first"),
        (named("nobody"), "event 0: contacts has 'nobody', which is not in the scene"),
        (named("a"), "event 0: contacts has ('a', 'a')"),
        (timed(2.0, 1.0), "event 1: time = 1.0 comes before 2.0, the time of event 0; sort"),
        (timed(float("inf")), "event 0: time = inf; must be finite"),
        (timed(-1.0), "event 0: time = -1.0 is before the start"),
        (lambda run: replace(run, events=(replace(run.events[0], index=7),)), "event 0: index = 7; must be its place"),
        (lambda run: replace(run, events=(replace(run.events[0], impulses=()),)), "event 0: impulses is empty"),
        (lambda run: replace(run, events=(None,)), "event 0: is None; must be a scenarios.Event"),
        (lambda run: replace(run, events=(replace(run.events[0], contacts=(3,)),)), "event 0: contacts has 3"),
        (
            lambda run: replace(run, events=(replace(run.events[0], contacts=None),)),
            "event 0: contacts = None; must be",
        ),
        (lambda run: replace(run, events=None), "events = None; must be a tuple"),
        (lambda run: replace(run, events=iter(run.events)), "must be a tuple of scenarios.Event"),
        (lambda run: replace(run, stop=None), "stop = None"),
        (lambda run: replace(run, scene=catalogue.build("lee")), "is of another scene"),
        (lambda run: replace(run, motion=None), "the final state is not to be had"),
    ],
)
def test_what_cannot_be_judged_is_refused(alter: Any, told: str) -> None:
    with pytest.raises(EngineError) as caught:
        compare(PAIR, [Altered(alter)])
    assert str(caught.value).startswith("engine 'mine': ")
    assert told in str(caught.value)


def test_a_state_that_is_not_finite_is_refused() -> None:
    class Lost:
        def state(self, time: Any) -> Any:
            return [(0.0, 0.0, 0.0, 0.0), (0.0, float("nan"), 0.0, 0.0)]

    with pytest.raises(EngineError, match="the final state: circle 'b': y = nan; must be finite"):
        compare(PAIR, [Altered(lambda run: replace(run, motion=Lost()))])


def test_a_reversal_that_is_ignored_is_told() -> None:
    scene = PAIR.with_changes(reverse_at=1, until=5)
    with pytest.raises(EngineError, match="reversal = None, but the scene reverses"):
        compare(scene, [Altered(lambda run: replace(run, reversal=None))])


def test_a_scene_that_an_engine_does_not_follow_is_not_given_to_it() -> None:
    @dataclass(frozen=True)
    class Plain(Altered):
        @property
        def scene_keys(self) -> frozenset[str]:
            return SCENE_KEYS - {"reverse_at"}

    comparison = compare(PAIR.with_changes(reverse_at=1, until=5), [Plain(lambda run: 1 / 0)])
    assert comparison["mine"].verdict == "undecided"
    assert comparison["mine"].unable
    assert "'reverse_at'" in comparison["mine"].trajectory.stop.message


def test_what_comes_back_whole_is_judged() -> None:
    run = DoubleEngine().run(PAIR)
    assert check_trajectory(run, PAIR, "double") is run
    assert compare(PAIR, [Altered(lambda told: told)]).verdict == "agree"


class Declares(Altered):
    """An engine with one declaration of its own."""


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("step", 0.0, "step = 0.0"),
        ("step", float("inf"), "step = inf"),
        ("bits", 0, "bits = 0"),
        ("bits", 5.5, "bits = 5.5"),
        ("bits", True, "bits = True"),
        ("step", True, "step = True"),
        ("scene_keys", frozenset({"wind"}), "scene_keys has 'wind'"),
        ("scene_keys", None, "scene_keys = None; must be a set"),
        ("finer", lambda: 7, "finer() gave 7; it must give an engine, or None"),
        ("wider", lambda: 1 / 0, "wider() raised ZeroDivisionError: division by zero"),
    ],
)
def test_declarations_are_checked(key: str, value: Any, told: str) -> None:
    kind = type("Wrong", (Altered,), {key: property(lambda self: value)})
    with pytest.raises(EngineError) as caught:
        check_engine(kind(lambda run: run))
    assert told in str(caught.value)


@pytest.mark.parametrize("name", [5, None, " "])
def test_a_name_is_text(name: Any) -> None:
    with pytest.raises(EngineError, match=rf"engine Altered: name = {name!r}; must be text"):
        check_engine(replace(Altered(lambda run: run), name=name))


@pytest.mark.parametrize("engine", [DoubleEngine(), IntervalEngine(), PymunkEngine()])
def test_the_engines_here_declare_what_they_are(engine: Any) -> None:
    assert check_engine(engine) is engine
    assert engine.scene_keys <= SCENE_KEYS


def test_a_finer_engine_is_half_as_coarse_and_the_same_else() -> None:
    finer = PymunkEngine(dt=1 / 8, iterations=5, max_steps=100).finer()
    assert (finer.step, finer.iterations, finer.max_steps) == (1 / 16, 5, 200)
    assert PymunkEngine(iterations=5).firmer().iterations == 10
    wider = IntervalEngine(60).wider()
    assert wider is not None
    assert wider.bits == 120
    assert IntervalEngine(100_000).wider() is None
    assert DoubleEngine().finer() is DoubleEngine().wider() is DoubleEngine().firmer() is None


def test_text_is_no_scene() -> None:
    with pytest.raises(SceneError, match=r"write scenarios.catalogue.build\('gas'\)"):
        compare("gas", ["double"])  # type: ignore[arg-type]


def test_one_engine_may_be_given_as_it_is() -> None:
    assert compare(PAIR, "double").verdict == compare(PAIR, DoubleEngine()).verdict == "agree"


def test_an_outcome_may_be_an_array() -> None:
    import numpy as np

    comparison = compare(PAIR, ["double"], outcomes={"counts": lambda run: np.array([run.collisions, 2])})
    assert comparison["double"].changed == ()


def test_a_time_beyond_the_doubles_is_refused() -> None:
    with pytest.raises(SceneError, match="beyond"):
        compare(PAIR, ["double"], until="10**400")
