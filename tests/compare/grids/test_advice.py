"""Advice is checked by others: what it names is run through `compare`, and what is one step cheaper too."""

from __future__ import annotations

import json
import math
import random
from dataclasses import replace
from fractions import Fraction
from itertools import count
from pathlib import Path
from typing import Any, ClassVar

import jsonschema
import pytest

from truebreak.compare import compare, engine
from truebreak.compare.chaos.accuracy import end_error
from truebreak.compare.cli.entry import main
from truebreak.compare.grids.goals import Digits, Goal, HistoryGoal, OutcomeGoal, difference
from truebreak.compare.grids.scene_family import nudged
from truebreak.compare.grids.setting_ladder import RunSize, ladder
from truebreak.compare.grids.setting_search import DEFAULT_BUDGET, ENOUGH, Advice, SearchEnd, advise
from truebreak.compare.report.schema import schema
from truebreak.compare.report.search_text import advice_json, advice_sentences
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine, PymunkEngine
from truebreak.scenarios import Circle, Quantity, Scene, SceneError, Wall, catalogue
from truebreak.scenarios.files import load_scene
from truebreak.scenarios.trajectory import Stop, StopReason, Trajectory

BESIDE = 3

LEAST_EVENTS = 7


def drawn(seed: int) -> Scene:
    """A box with a few discs of several sizes and masses, some of them fixed, some at rest; in no catalogue."""
    draw = random.Random(seed)
    side = 12
    walls = [Wall(0, 0, 0, 1), Wall(side, 0, side, 1), Wall(0, 0, 1, 0), Wall(0, side, 1, side)]
    circles: list[Circle] = []
    while len(circles) < 2 + seed % 3:
        r = Fraction(draw.randint(3, 12), 10)
        x, y = (Fraction(draw.randint(1300, 10700), 1000) for _ in range(2))
        if any((x - c.x.fraction) ** 2 + (y - c.y.fraction) ** 2 <= (r + c.r.fraction) ** 2 for c in circles):
            continue
        kind = draw.choice(["free", "free", "rest", "fixed"]) if circles else "free"
        vx, vy = (Fraction(draw.randint(-999, 999), 500) if kind == "free" else 0 for _ in range(2))
        m = math.inf if kind == "fixed" else Fraction(draw.randint(1, 40), 10)
        circles.append(Circle(x, y, r, vx, vy, m=m))
    scene = Scene(circles, walls, name=f"drawn {seed}", until=14 + seed % 4)
    return scene if len(ExactEngine().run(scene).events) >= LEAST_EVENTS else drawn(seed + 1000)


GOALS: list[Goal] = [
    HistoryGoal(6),
    OutcomeGoal("collisions"),
    Digits(9),
    HistoryGoal(),
    OutcomeGoal("who_hit_whom"),
    Digits(14),
]

ENGINES = ("pymunk", "pymunk", "interval")


def is_right(scene: Scene, goal: Goal, text: str) -> bool:
    """Whether a setting gets a goal right, found without anything of the advice."""
    if isinstance(goal, Digits):
        exact = ExactEngine().run(scene)
        run = engine(text).run(scene, until=Quantity.of(scene.until) + 1)
        end = float(exact.final_time)
        if float(run.final_time) < end:
            return False
        mine, theirs = exact.at(Quantity.of(Fraction(end))), run.at(Quantity.of(Fraction(end)))
        size = max(abs(float(v)) for c in mine.circles for v in (c.x, c.y))
        off = max(
            math.hypot(*(max(abs(b - float(p)) for b in q.bounds()) for p, q in ((m.x, t.x), (m.y, t.y))))
            for m, t in zip(mine.circles, theirs.circles, strict=True)
        )
        return off <= size * 10.0**-goal.count
    found = compare(scene, [text], events=goal.events, causes=False).candidates[0]
    if isinstance(goal, OutcomeGoal):
        return found.verdict in ("agree", "diverged") and goal.name not in found.changed
    return found.verdict == "agree"


def scene_of(told: Advice, seed: int | None) -> Scene:
    return next(one.study.scene for one in told.instances if one.seed == seed)


@pytest.mark.parametrize("seed", range(12))
def test_what_is_named_is_right_and_one_step_cheaper_is_wrong(seed: int) -> None:
    scene, goal, text = drawn(seed), GOALS[seed % len(GOALS)], ENGINES[seed % len(ENGINES)]
    told = advise(scene, goal, text, perturbed=BESIDE, budget=3_000_000)
    if told.named is None:
        assert told.end is SearchEnd.BUDGET
        assert told.why
        assert not any(tried.right for tried in told.tried)
        last = told.tried[-1]
        assert not is_right(scene_of(told, last.wrong[0]), goal, last.setting.text)
        return
    for seed_beside in (None, *told.perturbed):
        near = scene if seed_beside is None else nudged(scene, told.size, seed_beside)
        assert is_right(near, goal, told.named.setting.text), (told.named.setting.text, seed_beside)
    if told.cheaper is not None:
        assert told.cheaper.wrong
        assert set(told.cheaper.judged) == {None, *told.perturbed}
        for near in told.cheaper.judged:
            right = is_right(scene_of(told, near), goal, told.cheaper.setting.text)
            assert right == told.cheaper.judged[near].right, (told.cheaper.setting.text, near)
    for tried in told.tried[:-1]:
        assert tried.wrong


def test_the_drawn_scenes_have_an_answer_that_is_not_the_cheapest_there_is() -> None:
    found = [advise(drawn(seed), HistoryGoal(5), perturbed=1, budget=500_000) for seed in range(6)]
    assert all(told.end is SearchEnd.FOUND for told in found)
    assert sum(told.cheaper is not None for told in found) >= 4


def test_velocities_alone_differ_and_what_rests_goes_on_resting() -> None:
    scene = catalogue.build("rack:rows=3")
    near = nudged(scene, Quantity.of("1/100"), 7)
    assert [(c.x, c.y, c.r, c.m) for c in near.circles] == [(c.x, c.y, c.r, c.m) for c in scene.circles]
    assert near.touching == scene.touching != ()
    assert [c.at_rest for c in near.circles] == [c.at_rest for c in scene.circles]
    cue, other = scene.circles[0], near.circles[0]
    assert 0 < abs(float(other.vx - cue.vx)) + abs(float(other.vy)) <= 0.02 * abs(float(cue.vx))
    assert nudged(scene, Quantity.of("1/100"), 8).digest != near.digest


def test_a_ladder_is_ordered_by_cost_and_names_engines_that_are_what_they_say() -> None:
    size = RunSize(20.0, 30, 34, 5, 4)
    for text in ("pymunk", "pymunk:iterations=3", "pymunk:dt=1/100", "interval", "interval:bits=40", "quad"):
        rungs = ladder(text, size, 200_000)
        assert [rung.work for rung in rungs] == sorted(rung.work for rung in rungs)
        assert all(rung.work <= 200_000 for rung in rungs)
        assert all(engine(rung.text) == rung.engine for rung in rungs)
        assert len({rung.text for rung in rungs}) == len(rungs) > 0
    assert ladder("pymunk:dt=1/100", size, 200_000)[0].engine.step == 0.01
    assert {rung.engine.iterations for rung in ladder("pymunk:iterations=3", size, 10_000)} == {3}  # type: ignore[attr-defined]
    assert min(rung.engine.bits or 0 for rung in ladder("interval:bits=40", size, 200_000)) == 40


def test_a_long_run_is_given_room_in_its_own_text() -> None:
    rung = ladder("pymunk:iterations=1", RunSize(1000.0, 10, 10, 2, 0), 10**8)[-1]
    assert f"max_steps={rung.engine.max_steps}" in rung.text  # type: ignore[attr-defined]
    assert rung.engine.max_steps >= 8 * (rung.steps or 0)  # type: ignore[attr-defined]


def test_luck_is_told() -> None:
    told = advise(catalogue.build("near-tie:k=3"), OutcomeGoal("who_hit_whom"))
    assert told.lucky
    assert any(sentence.startswith("Not monotone") for sentence in advice_sentences(told))
    for tried in told.lucky:
        assert is_right(told.scene, told.goal, tried.setting.text)
        assert not is_right(scene_of(told, tried.wrong[0]), told.goal, tried.setting.text)
    for tried in told.worse:
        assert tried.setting.work > told.named.setting.work  # type: ignore[union-attr]
        assert not is_right(scene_of(told, tried.wrong[0]), told.goal, tried.setting.text)
    assert advice_json(told)["monotone"] is False


def test_the_budget_is_kept_and_why_is_told() -> None:
    told = advise(catalogue.build("gas:n=4"), HistoryGoal(60), perturbed=1, budget=100_000)
    assert told.end is SearchEnd.BUDGET
    assert told.spent <= told.budget
    assert told.next is not None
    assert told.why[0].startswith("The last tried, pymunk:dt=")
    assert any("a step of about 2**-" in sentence for sentence in told.why)
    again = advise(catalogue.build("gas:n=4"), HistoryGoal(60), perturbed=1, budget=100_000)
    assert (again.spent, again.tried, again.why) == (told.spent, told.tried, told.why)


def test_runs_that_settle_what_an_instant_comes_to_are_paid_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Discs that touch are pushed at one instant, of which a series of finer steps tells whether it converges."""
    steps: list[int] = []
    real = PymunkEngine.run

    def counted(self: PymunkEngine, scene: Scene, **limits: Any) -> Trajectory:
        run = real(self, scene, **limits)
        steps.append(math.ceil(float(run.final_time) / self.dt))
        return run

    monkeypatch.setattr(PymunkEngine, "run", counted)
    told = advise(catalogue.build("rack:rows=3,pockets=no"), HistoryGoal(4), perturbed=1, budget=40_000, why=False)
    assert told.end is SearchEnd.BUDGET
    assert told.why == ()
    assert told.spent <= told.budget
    assert 10_000 < sum(steps) <= told.budget, "a step is a unit of work and a little more"


def test_an_engine_with_one_setting_is_told_to_be_enough_or_not() -> None:
    assert advise(drawn(1), HistoryGoal(3), "double", perturbed=1).named is not None
    told = advise(catalogue.build("gas:n=4"), HistoryGoal(120), "double", perturbed=1)
    assert told.end is SearchEnd.LADDER
    assert "bits to keep every event" in " ".join(told.why)


class Unsure(ExactEngine):
    """The exact engine, which gives up on some scenes; all on which it does are in `on`."""

    on: ClassVar[set[str]] = set()

    def run(self, scene: Scene, **limits: Any) -> Any:
        told = super().run(scene, **limits)
        stop = Stop(StopReason.UNDECIDED, "undecided: for this test")
        return replace(told, stop=stop) if scene.digest in self.on else told


def test_why_no_costlier_setting_was_looked_at_is_told() -> None:
    one = advise(drawn(1), HistoryGoal(3), "double", perturbed=1)
    assert (one.next, one.beyond) == (None, ())
    assert "No costlier one was looked at: there is none." in advice_sentences(one)
    # the budget grows until it suffices for the first setting that is right, and for no more
    tried = (advise(drawn(1), HistoryGoal(3), "interval", perturbed=0, budget=int(100 * 1.1**k)) for k in count())
    told = next(advice for advice in tried if advice.named is not None)
    assert told.beyond == ()
    assert told.next is not None
    assert "No costlier one was looked at: the budget has no room for it." in advice_sentences(told)


def test_a_certified_run_that_is_not_decided_gives_no_advice(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = catalogue.build("gas:n=3")
    monkeypatch.setattr("truebreak.compare.grids.setting_search.ExactEngine", Unsure)
    monkeypatch.setattr(Unsure, "on", {scene.digest})
    told = advise(scene, HistoryGoal(9), perturbed=2)
    assert told.end is SearchEnd.REFERENCE
    assert told.tried == ()
    assert told.why == ("The certified run of the scene itself stops: undecided: for this test.",)
    assert told.named is told.cheaper is None
    jsonschema.Draft202012Validator(schema("advice-2")).validate(advice_json(told))


def test_scenes_beside_it_without_a_certified_run_are_left_out_and_named(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = catalogue.build("gas:n=3")
    monkeypatch.setattr("truebreak.compare.grids.setting_search.ExactEngine", Unsure)
    monkeypatch.setattr(Unsure, "on", {nudged(scene, Quantity.of("1/1000"), 2).digest})
    told = advise(scene, HistoryGoal(9), "quad", perturbed=3)
    assert told.left_out == (2,)
    assert [one.seed for one in told.instances] == [None, 1, 3]
    assert told.end is SearchEnd.FOUND
    assert advice_sentences(told)[-1] == "Left out, as their certified run is not decided: perturbed 2."


def test_without_scenes_beside_it_the_scene_alone_decides() -> None:
    told = advise(catalogue.build("gas:n=4"), HistoryGoal(3), perturbed=0)
    assert told.end is SearchEnd.FOUND
    assert "on gas:n=4 alone" in advice_sentences(told)[0]
    assert advice_sentences(told)[1] == "One scene says nothing of others like it."


def test_digits_are_bounded_from_above_by_the_worst_that_an_enclosure_holds() -> None:
    scene = catalogue.build("gas:n=3").with_changes(events=None, until=9)
    exact = ExactEngine().run(scene)
    narrow, wide = (end_error(exact, engine(f"interval:bits={bits}").run(scene)) for bits in (200, 60))
    assert narrow is not None
    assert wide is not None
    assert narrow.digits > wide.digits + 30
    same = end_error(exact, exact)
    assert same is not None
    assert same.digits > 1000
    assert end_error(exact, engine("double").run(scene, until=5)) is None


@pytest.mark.parametrize(
    ("expected", "got", "told"),
    [(3, 4, "4, not 3"), ({"a": [1.0]}, {"a": [2.0]}, "a: [2.0], not [1.0]"), ({"a": 1}, None, "none, not (a 1)")],
)
def test_differences_are_told_in_few_words(expected: object, got: object, told: str) -> None:
    assert difference(expected, got) == told


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--outcome", "pocketed"], "has no such outcome; choose from: collisions"),
        (["--outcome", "collisons"], "did you mean 'collisions'?"),
        (["--digits", "0"], "'0' is too small"),
        (["--events", "0"], "'0' is too small"),
        (["--budget", "0"], "'0' is too small"),
        (["--perturbed", "-1"], "'-1' is too small"),
        (["--size", "2"], "is a share of each velocity"),
        (["--size", "0"], "is a share of each velocity"),
        (["--size", "x"], "--size"),
        (["--engine", "pimunk"], "did you mean 'pymunk'?"),
        (["--engine", "pymunk:dt=0"], "dt = 0"),
        (["--digits", "2", "--events", "3"], "ask one"),
        (["--events", "2", "--until", "3"], "give one"),
        (["--until", "-1"], "must be above zero"),
        (["--until", "10**400"], "beyond 1.8e308"),
        (["--until", "10**400", "--engine", "exact"], "beyond the doubles"),
        (["--scenes", "nowhere"], "create it first"),
    ],
)
def test_bad_input_is_one_line(words: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["advise", "gas:n=3", *words])
    assert stop.value.code == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert told in err


def test_an_engine_that_cannot_take_the_scene_is_refused() -> None:
    scene = catalogue.build("rack:rows=2").with_changes(capture=True)
    with pytest.raises(SceneError, match="does not follow 'capture'"):
        advise(scene, HistoryGoal(3))


def test_the_command_prints_json_of_its_schema_and_writes_the_scenes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [
        "advise",
        "gas:n=3",
        "--events",
        "5",
        "--perturbed",
        "2",
        "--seed",
        "11",
        "--scenes",
        str(tmp_path),
        "--json",
    ]
    with pytest.raises(SystemExit) as stop:
        main([*words, "--scenes", str(tmp_path)])
    assert stop.value.code == 0
    data = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator(schema("advice-2")).validate(data)
    assert data["setting"]["may_fail"] == pytest.approx(1 - 0.05 ** (1 / 3))
    assert [near["seed"] for near in data["perturbed"]] == [11, 12]
    for near in data["perturbed"]:
        written = load_scene(tmp_path / f"perturbed-{near['seed']}.toml")
        assert written.data() == near["scene"]
        assert compare(written, [data["setting"]["engine"]], events=5, causes=False).verdict == "agree"


def test_where_none_is_right_the_json_is_of_the_schema_too(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["advise", "gas:n=4", "--events", "90", "--budget", "20000", "--perturbed", "1", "--json"])
    assert stop.value.code == 4
    data = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator(schema("advice-2")).validate(data)
    assert data["setting"] is data["cheaper"] is None
    assert data["why"]


def test_where_all_is_predicted_to_be_wrong_only_the_cheap_settings_are_run(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its work is bounded by count, and truebreak's own engines are looked at in its place; a budget runs the rest."""
    scene, steps = catalogue.build("gas:n=4").with_changes(events=60), list[int]()
    real = PymunkEngine.run

    def counted(self: PymunkEngine, scene: Scene, **limits: Any) -> Trajectory:
        run = real(self, scene, **limits)
        steps.append(math.ceil(float(run.final_time) / self.dt))
        return run

    monkeypatch.setattr(PymunkEngine, "run", counted)
    found = advise(scene, HistoryGoal(), perturbed=2, why=False)
    assert found.end is SearchEnd.HOPELESS
    assert found.spent <= ENOUGH
    assert sum(steps) <= 4 * ENOUGH, "a run goes no further than it takes to see it diverge"
    assert found.next is not None and found.next.work + found.spent > ENOUGH
    monkeypatch.setattr(PymunkEngine, "run", real)
    with pytest.raises(SystemExit) as stop:
        main(["advise", "gas:n=4", "--events", "60", "--perturbed", "2"])
    assert stop.value.code == 4
    told = " ".join(capsys.readouterr().out.split())
    assert "No setting of pymunk is predicted to get the first 60 events right" in told
    assert "Take double instead: it is right on all 3 scenes." in told
    assert is_right(scene, HistoryGoal(60), "double")
    data = advice_json(advise(scene, HistoryGoal(60), perturbed=2))
    jsonschema.Draft202012Validator(schema("advice-2")).validate(data)
    assert [(one["engine"], one["right"]) for one in data["instead"]] == [("double", True)]
    assert advise(scene, HistoryGoal(60), perturbed=1, budget=2 * ENOUGH, why=False).spent > ENOUGH


def test_a_wrong_prediction_would_be_seen() -> None:
    """Where a setting is right, the search ends with it, and none of those before it was left out as hopeless."""
    for seed in range(6):
        told = advise(drawn(seed), HistoryGoal(5), perturbed=1)
        again = advise(drawn(seed), HistoryGoal(5), perturbed=1, budget=DEFAULT_BUDGET)
        assert told.end is again.end is SearchEnd.FOUND
        assert [tried.setting.text for tried in told.tried] == [tried.setting.text for tried in again.tried]


class Sharp(PymunkEngine):
    """An engine of steps whose errors are no larger than those of doubles, whatever its step: of very high order."""

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        told = DoubleEngine().run(scene, **limits)
        return replace(told, engine=self.name)


def test_an_engine_of_high_order_is_not_held_for_hopeless(monkeypatch: pytest.MonkeyPatch) -> None:
    """By its step it is predicted to be wrong; how far it comes says otherwise, and it is run on."""
    scene = catalogue.build("gas:n=4").with_changes(events=120)
    whole = len(ExactEngine().run(scene).events)
    assert whole == 120
    monkeypatch.setattr(PymunkEngine, "run", Sharp.run)
    found = advise(scene, HistoryGoal(), "pymunk:dt=1/64,iterations=1", perturbed=0, why=False)
    agreed = max(judged.agreed or 0 for one in found.tried for judged in one.judged.values())
    assert 60 <= agreed < whole, "doubles diverge on the way"
    assert found.end is not SearchEnd.HOPELESS
