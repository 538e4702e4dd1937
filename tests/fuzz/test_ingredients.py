"""The covering array covers, what is said to take part does, relations see what is wrong; what was found."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from pathlib import Path
from random import Random
from typing import Any

import pytest
from command_line import said

from fuzz.check import Difference, compare
from fuzz.draft import Case
from fuzz.examine import AIMED, aimed, examine
from fuzz.generators import KINDS, case_of
from fuzz.ingredients import FEWEST, INGREDIENTS, PAIRS, ROWS, Mixed, array, exercised, mixed, row_of
from fuzz.maps import MAPS
from fuzz.referee import referee
from fuzz.relations import (
    FEW_CELLS,
    RELATIONS,
    _far_from,
    cells_from,
    resumed_on_the_way,
    wanted_of,
    with_one_at_rest,
)
from truebreak.exact import ExactEngine
from truebreak.exact.certified.cascade import ByForm, ByWayBack
from truebreak.exact.simulation.instant import Resolver
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Pocket, Quantity, Scene, StopReason, Wall
from truebreak.scenarios.files import load_scene
from truebreak.scenarios.trajectory import Stop

FOUND = sorted((Path(__file__).parent / "found").glob("*.toml"))
HIT = Scene(
    [Circle(0, 0, vx=3, id="a"), Circle(5, 1, vy="1/7", id="b"), Circle(12, "3/2", m=2, id="c")],
    [Wall(20, 0, 20, 1, id="w")],
)


def plain(scene: Scene, row: str = "", until: Any = None, events: int | None = None) -> Mixed:
    """A scene as if it had come of a row."""
    limit = None if until is None else Quantity.of(until)
    return Mixed(frozenset(row.split()), Case(scene, limit, events), (0,) * len(scene.circles), (400, -380, 700))


# -- the array


def test_every_array_has_every_pair_and_most_triples_come_soon() -> None:
    triples = set()
    for number in range(12):
        rows = array(number)
        assert len(rows) == ROWS
        assert all(FEWEST <= len(row) <= 8 for row in rows)
        assert {pair for row in rows for pair in combinations([n for n in INGREDIENTS if n in row], 2)} == set(PAIRS)
        triples |= {t for row in rows for t in combinations([n for n in INGREDIENTS if n in row], 3)}
    assert len(INGREDIENTS) == 23
    assert len(triples) > 0.9 * 1771  # all that there are of 23


def test_a_seed_is_one_scene() -> None:
    digests = [mixed(seed).case.scene.digest for seed in range(20)]
    assert digests == [mixed(seed).case.scene.digest for seed in range(20)]
    assert len(set(digests)) == 20
    assert {"pocket"} <= row_of(next(k for k in range(99) if "capture" in row_of(k)))


def test_all_ingredients_take_part_within_sixty_scenes() -> None:
    found = set[str]()
    for seed in range(60):
        verdict = examine("mixed", seed)
        assert verdict.outcome in ("ok", "budget", "undecided"), (seed, verdict)
        found |= set(verdict.exercised)
    assert found == set(INGREDIENTS)


# -- what took part


def took_part(mix: Mixed) -> frozenset[str]:
    told = referee(mix.case.scene, mix.case.until, mix.case.events)
    run = ExactEngine().run(mix.case.scene, until=mix.case.until, events=mix.case.events)
    return exercised(mix, told, run, frozenset())


def test_what_is_there_and_does_nothing_takes_no_part() -> None:
    aside = [Circle(0, 300, m="oo"), Circle(0, 400, 0, point=True), Circle("10**12", 500), Circle(9, 600, m="10**12")]
    scene = HIT.with_changes(circles=[*HIT.circles, *aside], pockets=[Pocket(0, 700, 3)], capture=True)
    idle = {"point", "pocket", "capture", "fixed", "mass", "graze", "raft", "lasting", "oblique", "corner", "swift"}
    assert not took_part(plain(scene, events=2)) & idle
    assert not took_part(plain(scene.with_changes(reverse_at=900), events=1)) & {"reversal"}


@pytest.mark.parametrize(
    ("name", "scene", "until"),
    [
        ("graze", Scene([Circle(0, 0, vx=1), Circle(5, 2), Circle(9, 0)]), 20),
        ("raft", Scene([Circle(0, 0, vx=1), Circle(0, 2, vx=1), Circle(9, 0)]), 20),
        ("lasting", Scene([Circle(0, 0, vx=1), Circle(9, 0)], [Wall(0, -1, 1, -1)]), 20),
        ("corner", Scene([Circle(5, 5, vx=-1, vy=-1)], [Wall(0, 0, 0, 1), Wall(0, 0, 1, 0)]), 20),
        ("oblique", Scene([Circle(9, 0, vx=-1)], [Wall(0, 0, 3, 4)]), 20),
        ("point", Scene([Circle(0, 0, 0, vx=1, point=True), Circle(9, 0)]), 20),
        ("swift", Scene([Circle(0, 0, vx="10**9"), Circle(9, 0)]), 20),
        ("mass", Scene([Circle(0, 0, vx=1, m="10**9"), Circle(9, 0)]), 20),
        ("far", Scene([Circle("10**12", 0, vx=1), Circle("10**12 + 9", 0)]), 20),
        ("nested", Scene([Circle("sqrt(2 + sqrt(3))", 0, vx=1), Circle(9, 0)]), 20),
        ("gap", Scene([Circle(0, 0, vx=1), Circle(9, 0), Circle(0, 99, vx=1), Circle("9 + 10**-30", 99)]), 20),
        ("limit", Scene([Circle(0, 0, vx=1), Circle(9, 0)]), 7),
        ("fixed", Scene([Circle(0, 0, vx=1), Circle(9, 0, m="oo")]), 20),
        ("tie", Scene([Circle(0, 0, vx=1), Circle(9, 0), Circle(0, 9, vx=1), Circle(9, 9)]), 20),
        ("capture", Scene([Circle(0, 0, vx=1)], pockets=[Pocket(9, 0, 2)], capture=True), 20),
    ],
)
def test_what_takes_part_is_seen(name: str, scene: Scene, until: int) -> None:
    assert name in took_part(plain(scene, until=until))


# -- the relations


class Wrong:
    """An engine that runs another scene than it is given, whenever it runs one that it has not seen, or all of them."""

    def __init__(self, at: int) -> None:
        self.left = at

    def run(self, scene: Scene, **limits: Any) -> Any:
        self.left -= 1
        if self.left < 0:
            first, *others = scene.circles
            heavy = Circle(first.x, first.y, first.r, first.vx, first.vy, first.m * 3, first.id)
            scene = scene.with_changes(circles=[heavy, *others])
        return ExactEngine().run(scene, **limits)

    def resume(self, run: Any, **limits: Any) -> Any:
        return self.run(run.scene, **limits)


@pytest.mark.parametrize("name", [name for name in RELATIONS if name not in ("interval", "work", "back")])
def test_a_relation_sees_another_history(name: str) -> None:
    open_plane = name == "deep"
    mix = plain(HIT.with_changes(walls=()) if open_plane else HIT, "resume scale", events=1 if open_plane else 3)
    run = ExactEngine().run(mix.case.scene, events=mix.case.events)
    assert len(run.events) == mix.case.events
    at = 1 if name in ("resume", "cut") else 0
    draws = [Random(seed) for seed in range(8)]
    assert any(RELATIONS[name](run, mix, Random(seed), ExactEngine()) for seed in range(8))
    with pytest.raises(Difference):
        for draw in draws:
            RELATIONS[name](run, mix, draw, Wrong(at))


def test_there_and_back_sees_another_time() -> None:
    """A wrong mass comes home as well: it is the clock that must not be wrong."""
    mix = plain(HIT, events=2)
    run = ExactEngine().run(HIT, events=2)
    assert RELATIONS["back"](run, mix, Random(1), ExactEngine())

    class Late:
        def run(self, scene: Scene, *, until: Any, events: int) -> Any:
            return ExactEngine().run(scene, until=until + Quantity.of("1/10**30"), events=events)

    with pytest.raises(Difference, match="there and back"):
        RELATIONS["back"](run, mix, Random(1), Late())


def test_a_run_may_give_up_between_events_that_are_closer_than_what_is_agreed() -> None:
    """10**-180 apart, where numbers are agreed on to 460 bits; but not within an instant."""
    two = [Circle(0, 0, vx=1), Circle(5, 0), Circle(0, 99, vx=1), Circle("5 + 10**-180", 99)]
    for late, whole in ((two, True), ([*two[:3], Circle(5, 99)], False)):
        scene = Scene(late)
        told = referee(scene, None, 2)
        run = replace(ExactEngine().run(scene, events=1), stop=Stop(StopReason.UNDECIDED, "here"))
        assert len(told.events) == (2 if whole else 1)
        if whole:
            compare(run, told)
            with pytest.raises(Difference, match=r"is missing|0 events"):
                compare(replace(run, events=()), told)
        else:
            half = replace(run.events[0], ties=(), contacts=run.events[0].contacts[:1])
            with pytest.raises(Difference, match="contacts"):
                compare(replace(run, events=(half,)), told)


# -- what is played beside


def test_each_kind_that_aims_at_something_has_its_turn() -> None:
    assert [aimed(seed)[0] for seed in range(len(AIMED))] == list(AIMED)
    assert aimed(2 * len(AIMED) + 3) == (AIMED[3], 2)
    assert len(set(AIMED)) == len(AIMED) and set(AIMED) < set(KINDS) - {"mixed"}


def test_what_is_wrong_beside_a_scene_is_a_failure_of_its_seed(monkeypatch: pytest.MonkeyPatch) -> None:
    seed = AIMED.index("home")
    assert "beside" in examine("mixed", seed).extra.split()
    scene, run = case_of("home", 0).scene, ExactEngine.run

    def forgetful(self: Any, of: Scene, **limits: Any) -> Any:
        whole = run(self, of, **limits)
        return replace(whole, events=whole.events[1:]) if of.digest == scene.digest else whole

    monkeypatch.setattr(ExactEngine, "run", forgetful)
    verdict = examine("mixed", seed)
    assert (verdict.kind, verdict.seed, verdict.outcome) == ("mixed", seed, "failure")
    assert verdict.message.startswith("beside it, home 0: ")


def test_a_circle_at_rest_beside_all_others_changes_nothing() -> None:
    case = Case(HIT.with_changes(walls=()), None, 1)
    run = ExactEngine().run(case.scene, events=1)
    assert with_one_at_rest(run, case, ExactEngine())
    with pytest.raises(Difference, match="with one at rest"):
        with_one_at_rest(run, case, Wrong(0))
    struck = Scene([Circle(0, 0), Circle(-5, -5, vx=1, vy=1), Circle(9, 9, vx=1, vy=1)])
    run = ExactEngine().run(struck, events=2)
    assert not with_one_at_rest(run, Case(struck, None, 2), ExactEngine())  # it is met


def test_what_is_broken_off_on_the_way_out_comes_home_too() -> None:
    case = Case(HIT.with_changes(reverse_after=2), None, 4)
    run = ExactEngine().run(case.scene, events=4)
    assert run.reversal is not None and len(run.events) == 4
    assert resumed_on_the_way(run, case, Random(1), ExactEngine())
    with pytest.raises(Difference, match="resumed after"):
        resumed_on_the_way(run, case, Random(1), Wrong(2))
    short = ExactEngine().run(HIT, events=1)
    assert not resumed_on_the_way(short, Case(HIT, None, 1), Random(1), ExactEngine())


# -- what was found


@pytest.mark.parametrize("path", FOUND, ids=lambda path: path.stem)
def test_what_was_found_stays_mended(path: Path) -> None:
    scene = load_scene(path)
    mix = plain(scene, "resume scale", scene.until, scene.events)
    told = referee(scene, scene.until, scene.events)
    for count in (FEW_CELLS, 10**9):
        with cells_from(count):
            engine = ExactEngine()
            run = engine.run(scene, until=scene.until, events=scene.events)
            compare(run, told)
            for name, relation in RELATIONS.items():
                relation(run, mix, Random(name), engine)
    assert {m.name for m in MAPS} >= {"turn 90"}


def test_a_number_that_is_not_proved_to_be_half_way_between_doubles_has_one(capsys: pytest.CaptureFixture[str]) -> None:
    path = FOUND[0].with_name("home_half_way.toml")
    last = ExactEngine().run(load_scene(path)).final
    assert float(last["c8"].x) == -2500000000000000.0  # -.25: the even one of that and -.5
    assert last["c8"].x.text() is None
    code, out, _ = said(capsys, "run", str(path))
    assert code == 0
    assert "-2.5e+15" in out


@pytest.mark.parametrize("engine", [ExactEngine(), DoubleEngine()], ids=lambda engine: engine.name)
def test_predictions_see_every_body_by_the_clock_that_it_has(engine: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """One that only touches in an instant is carried there: its copy must be too, or cells take it for older."""
    noted, seen = Resolver.noted, []

    def watched(self: Any, done: Any) -> Any:
        found = noted(self, done)
        for body in self.decider.bodies.values():
            seen.append(len(self.decider.history.steps))
            assert abs(float(body.q[4]) - float(body.flight.t)) < 1e-9, body.index
        return found

    monkeypatch.setattr(Resolver, "noted", watched)
    scene = load_scene(FOUND[0].with_name("graze_taken_up.toml"))
    engine.run(scene, until=4, events=2)
    assert any(seen)


@pytest.mark.parametrize("time", ["3", "3+1/10**40"])
def test_what_a_resumed_run_has_touched_is_not_met_again(time: str) -> None:
    """A flight that began before the log's end crosses the cells on its way anew: only a whole run may look there."""
    scene = load_scene(FOUND[0].with_name("graze_taken_up.toml"))
    engine = ExactEngine()
    with cells_from(FEW_CELLS):
        whole, first = engine.run(scene), engine.run(scene, until=time)
        assert len(whole.events) == 2 and len(first.events) == 1
        again = engine.resume(first, until=4, events=2)
    assert [event.time.digits(40) for event in again.events] == [event.time.digits(40) for event in whole.events]
    assert [event.contacts for event in again.events] == [event.contacts for event in whole.events]


def test_a_scene_with_walls_is_played_beside_deep_numbers_too() -> None:
    mix = plain(HIT, "reversal")
    engine = ExactEngine()
    assert RELATIONS["deep"](engine.run(HIT), mix, Random(1), engine)
    through = HIT.with_changes(walls=[*HIT.walls, Wall(0, "10**60 - 7*10**59", 1, "10**60 - 7*10**59")])
    assert not _far_from(through.walls[-1], Quantity.of(0), Quantity.of("3*10**59"))
    assert _far_from(HIT.walls[0], Quantity.of("10**60"), Quantity.of(0))


@pytest.mark.parametrize(("seed", "rung"), [(24, ByWayBack), (2, ByForm)], ids=["way back", "form"])
def test_without_nested_roots_little_else_proves_a_tie(seed: int, rung: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """So a fault that spoils such a proof is seen: nested roots make up for it in scenes as small as these."""
    mix, engine = mixed(seed), ExactEngine()
    run = engine.run(mix.case.scene, until=mix.case.until, events=mix.case.events)
    assert "past" in wanted_of(mix.row, seed)
    assert RELATIONS["past"](run, mix, Random(1), engine)
    monkeypatch.setattr(rung, "__call__", lambda self, question: None)
    assert not RELATIONS["past"](run, mix, Random(1), engine)
    assert RELATIONS["form"](run, mix, Random(1), engine)


def test_what_the_past_proves_is_compared_as_far_as_it_goes() -> None:
    mix, engine = mixed(24), ExactEngine()
    run = engine.run(mix.case.scene, until=mix.case.until, events=mix.case.events)
    first, later = run.events[0], Quantity.of(run.events[0].time.text()) + Quantity.of("1/10**40")
    for wrong, words in ((replace(first, impulses=()), "impulses"), (replace(first, time=later), "time of event 0")):
        with pytest.raises(Difference, match=f"by the past: {words}"):
            RELATIONS["past"](replace(run, events=(wrong, *run.events[1:])), mix, Random(1), engine)
