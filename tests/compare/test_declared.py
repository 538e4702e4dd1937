"""Engines are judged by what they declare, and what they hand back is checked first."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import pytest

from truebreak.compare import compare
from truebreak.compare.engines import engine
from truebreak.compare.validation import EngineError, check_engine, check_trajectory, unsupported
from truebreak.floating import DoubleEngine, IntervalEngine, PymunkEngine
from truebreak.scenarios import Circle, Contact, Declared, Polygon, Scene, SceneError, Trajectory, catalogue
from truebreak.scenarios.engine import ALL_KEYS, SCENE_KEYS
from truebreak.scenarios.trajectory import Pocketing, Reversal, Stop, StopReason

PAIR = Scene([Circle(0, 0, vx=1, id="a"), Circle(4, "1/3", id="b")], name="pair")
PEGGED = Scene([Circle(0, 3, vx=1, id="a"), Circle("1/2", 0, fixed=True, id="peg")], gravity=(0, -1), name="pegged")
WIDER = Scene([Circle(0, 0, vx=1, id="a"), Circle(5, "1/3", id="b")], name="pair")


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


def told_of_first(**changes: Any) -> Callable[[Trajectory], Trajectory]:
    return lambda run: replace(run, events=(replace(run.events[0], **changes),))


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
        (lambda run: replace(run, stop=None), "stop = None"),
        (lambda run: replace(run, scene=catalogue.build("lee")), "is of another scene"),
        (lambda run: replace(run, scene=run.scene.with_changes(restitution="1/2")), "is of another scene"),
        (
            lambda run: replace(
                run, scene=run.scene.with_changes(polygons=[Polygon([(50, 50), (51, 50), (50, 51)], id="block")])
            ),
            "is of another scene",
        ),
        (lambda run: replace(run, motion=None), "raised AttributeError: 'NoneType' object has no attribute 'state'"),
        (lambda run: replace(run, events=None), "events = None; must be a tuple"),
        (lambda run: replace(run, events=(e for e in run.events)), "must be a tuple"),
        (lambda run: replace(run, scene=None), "is of another scene, None"),
        (lambda run: replace(run, scene=WIDER), "is of another scene, 'pair'; hand back the one asked for"),
        (lambda run: replace(run, stop=Stop(StopReason.QUIET, None)), "must be a Stop with a StopReason and a message"),
        (lambda run: replace(run, engine=None), "engine = None; must be its name"),
        (lambda run: replace(run, parameters=None), "parameters = None; must be a dict"),
        (lambda run: replace(run, plan=None), "plan = None; must be a dict"),
        (lambda run: replace(run, notes=None), "notes = None; must be a tuple"),
        (lambda run: replace(run, assumptions=(3,)), "assumptions has 3; must hold things of the kind Assumption"),
        (lambda run: replace(run, pocketings=(3,)), "pocketings has 3; must hold things of the kind Pocketing"),
        (lambda run: replace(run, pocketings=(Pocketing("a", "p", 1.0),)), "pocketing 0: pocket = 'p', which is not"),
        (lambda run: replace(run, reversal=Reversal(0, 1.0)), "but the scene has none; leave it out"),
        (told_of_first(contacts=None), "event 0: contacts = None; must be a tuple"),
        (told_of_first(impulses=3), "event 0: impulses = 3; must be a tuple"),
        (told_of_first(impulses=(([], "b"),)), "event 0: impulses has [], which is not in the scene"),
        (told_of_first(coupled="yes"), "event 0: coupled = 'yes'; must be True or False"),
        (told_of_first(ties=(3,)), "event 0: ties has 3; must hold things of the kind Tie"),
        (told_of_first(index=0.0), "event 0: index = 0.0; must be its place, 0"),
        (told_of_first(time="2"), "event 0: time = '2'; must be a number"),
        (sys.exit, "run raised SystemExit"),
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

    with pytest.raises(EngineError, match=r"motion.state at t = .*: circle 'b': y = nan; must be a finite"):
        compare(PAIR, [Altered(lambda run: replace(run, motion=Lost()))])


def nothing(motion: Any, asked: Any) -> Any:
    return None


def fault(motion: Any, asked: Any) -> Any:
    raise RuntimeError("worn out")


@dataclass(frozen=True)
class Worn:
    """A motion that answers in another way; as it should, where no way is given."""

    motion: Any
    states: Any = None
    samples: Any = None

    def state(self, time: Any) -> Any:
        return (self.states or type(self.motion).state)(self.motion, time)

    def sample(self, times: Any) -> Any:
        return (self.samples or type(self.motion).sample)(self.motion, times)


@pytest.mark.parametrize(
    ("ways", "told"),
    [
        ({"states": fault}, "raised RuntimeError: worn out"),
        ({"states": lambda motion, time: fault(motion, time) if time < 9 else motion.state(time)}, "worn out"),
        ({"states": nothing}, "motion.state at t = 10.3844933 raised TypeError"),
        ({"states": lambda motion, time: motion.state(time)[:1]}, "gave rows of [4] numbers"),
        ({"states": lambda motion, time: [row[:3] for row in motion.state(time)]}, "gave rows of [3, 3] numbers"),
        ({"states": lambda motion, time: [("x", 0.0, 0.0, 0.0)] * 2}, "circle 'a': x = x; must be a finite number"),
        ({"samples": fault}, "motion.sample raised RuntimeError: worn out"),
        ({"samples": nothing}, "motion.sample gave an array of shape (); must be (200, 2, 4)"),
        ({"samples": lambda motion, times: motion.sample(times)[:3]}, "must be (200, 2, 4)"),
        ({"samples": lambda motion, times: motion.sample(times) * float("nan")}, "circle 'a' at t = 0: [nan,"),
    ],
)
def test_a_motion_is_checked_wherever_it_is_read(ways: dict[str, Any], told: str) -> None:
    with pytest.raises(EngineError) as caught:
        compare(PAIR, [Altered(lambda run: replace(run, motion=Worn(run.motion, **ways)))])
    assert str(caught.value).startswith("engine 'mine': motion.")
    assert told in str(caught.value)


def test_a_motion_that_answers_is_judged() -> None:
    found = compare(PAIR, [Altered(lambda run: replace(run, motion=Worn(run.motion)))])
    assert found["mine"].verdict == "agree"
    assert found["mine"].changed == ()


@pytest.mark.parametrize(
    ("reversal", "told"),
    [
        ("soon", "reversal = 'soon'; must be a Reversal, or None"),
        (Reversal(99, 1.0), "reversal.after = 99; must be the number of events before it"),
        (Reversal(None, 1.0), "reversal.after = None"),  # type: ignore[arg-type]
        (Reversal(0, 1e9), "reversal.time = 1000000000.0 is not within the run"),
        (Reversal(0, float("nan")), "reversal.time = nan; must be finite"),
    ],
)
def test_a_reversal_that_cannot_be_is_refused(reversal: Any, told: str) -> None:
    scene = PAIR.with_changes(reverse_at=1, until=5)
    with pytest.raises(EngineError) as caught:
        compare(scene, [Altered(lambda run: replace(run, reversal=reversal))])
    assert told in str(caught.value)


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
        ("scene_keys", frozenset({"wind"}), "scene_keys has 'wind'"),
        ("scene_keys", None, "scene_keys = None; must be a frozenset of keys"),
        ("scene_keys", [["wall"]], "scene_keys has"),
        ("step", True, "step = True"),
        ("bits", True, "bits = True"),
        ("rounds_input", None, "rounds_input = None; must be True or False"),
        ("finer", None, "finer = None; must be a method"),
    ],
)
def test_declarations_are_checked(key: str, value: Any, told: str) -> None:
    kind = type("Wrong", (Altered,), {key: property(lambda self: value)})
    with pytest.raises(EngineError) as caught:
        check_engine(kind(lambda run: run))
    assert told in str(caught.value)


@pytest.mark.parametrize("name", [None, 3, "", "two\nlines"])
def test_a_name_is_text_of_one_line(name: Any) -> None:
    with pytest.raises(EngineError, match="must be text of one line"):
        check_engine(Altered(lambda run: run, name))


def test_a_class_is_no_engine() -> None:
    with pytest.raises(EngineError, match=r"is a class; give an engine, such as DoubleEngine\(\)"):
        compare(PAIR, DoubleEngine)  # type: ignore[arg-type]


def missed(run: Trajectory) -> Trajectory:
    return replace(run, events=())


def at_a_loss(run: Trajectory) -> Trajectory:
    return replace(run, events=(), final_time=0.0, stop=Stop(StopReason.UNDECIDED, "cannot tell"))


@pytest.mark.parametrize(
    ("key", "said", "told"),
    [
        ("finer", lambda self: self, "finer gave a step of 0.5; must be below 0.5"),
        ("finer", lambda self: 3, "finer gave what is no engine: engine 'int': declares no name"),
        ("finer", lambda self: 1 // 0, "finer raised ZeroDivisionError"),
        ("wider", lambda self: self, "wider gave 24 bits; must be above 24"),
        ("wider", lambda self: 3, "wider gave what is no engine"),
        ("wider", lambda self: 1 // 0, "wider raised ZeroDivisionError"),
        ("firmer", lambda self: 3, "firmer gave what is no engine"),
        ("firmer", lambda self: 1 // 0, "firmer raised ZeroDivisionError"),
    ],
)
def test_the_engines_that_one_names_are_checked(key: str, said: Any, told: str) -> None:
    step = None if key == "wider" else 0.5
    space = {"step": property(lambda self: step), "bits": property(lambda self: 24), key: said}
    kind = type("Series", (Altered,), space)
    with pytest.raises(EngineError) as caught:
        compare(PAIR, [kind(at_a_loss if key == "wider" else missed)])
    assert str(caught.value).startswith("engine 'mine': ")
    assert told in str(caught.value)


@pytest.mark.parametrize("engine", [DoubleEngine(), IntervalEngine(), PymunkEngine()])
def test_the_engines_here_declare_what_they_are(engine: Any) -> None:
    assert check_engine(engine) is engine
    assert engine.scene_keys <= ALL_KEYS


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


@pytest.mark.parametrize("name", ["billiards", "perfect-physics", "pooltool"])
def test_engines_of_others_that_have_no_gravity_say_so(name: str) -> None:
    """They are built without: a run of theirs would be of another scene."""
    theirs = engine(name)
    for scene in (catalogue.build("bounce"), PEGGED):
        assert unsupported(theirs, scene) is not None
        (found,) = compare(scene, [theirs], events=3).candidates
        assert found.unable
        assert "does not follow" in found.trajectory.stop.message
