"""A tolerance with a reason: honest engines pass on the whole catalogue, planted bugs are found."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import pytest
from bugs import BUGS, Planted, heavier
from logs import triples

from truebreak.compare import engine
from truebreak.compare.foreign import RecordedEngine, Recording
from truebreak.compare.tangent.growth import error_growth
from truebreak.compare.testing.check import CheckFailed, NotDecided, check
from truebreak.compare.tolerances.errors_grown import ROUNDINGS, GrownErrors, LocalError, local_error
from truebreak.compare.tolerances.reach import reach_of
from truebreak.exact import ExactEngine
from truebreak.exact.laws import formulas
from truebreak.floating import DoubleEngine, PymunkEngine
from truebreak.scenarios import Circle, Declared, Scene, SceneError, Wall, catalogue

SCENES = (
    "article", "cradle", "cradle:gap=0", "tennis", "sizes", "galperin", "lee", "near-tie:k=40", "near-tie:k=2",
    "inscribed", "rack", "rack:gap=1/50", "gas", "gas:mixed=yes", "reversal", "pinball", "pinball:discs=3", "lorentz",
    "point", "grazing", "corner", "hexagon", "two-in-a-box", "three-disc", "free-discs", "magic-masses", "cross",
    "echo:rows=3,after=15", "triangle",
)  # fmt: skip

GAMES = (
    "bounce", "closing-wall", "collapse", "cooling:n=6", "cradle:e=9/10", "drop-pair", "falling-line",
    "gas-under-gravity", "piston", "struck", "wedge", "wedge:slope=2",
)  # fmt: skip
"""Under gravity, with a restitution below 1, and among walls that move."""

STEPS = ("pymunk:dt=1/64", "pymunk", "pymunk:dt=1/1024")


@pytest.fixture(scope="module", autouse=True)
def _one_true_run_a_scene(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Kept for all engines: faults are planted in these, never in the engine that is right."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TRUEBREAK_CACHE", str(tmp_path_factory.mktemp("kept")))
        yield


def test_every_family_of_the_catalogue_is_here() -> None:
    """But for a flight among 335 fixed circles, which is more than `check` goes over, and for what it cannot take."""

    def beyond(scene: Scene) -> bool:
        edges = scene.segments or scene.polygons or scene.arcs or scene.surfaces.pegs
        return bool(edges) or scene.restitution.sign() == 0

    def games(scene: Scene) -> bool:
        return not scene.elastic or scene.gravity is not None or scene.moving_walls

    new = {name for name in catalogue.names() if beyond(catalogue.build(name))}
    mine = {name for name in catalogue.names() if games(catalogue.build(name))} - new
    assert {spec.partition(":")[0] for spec in SCENES} == set(catalogue.names()) - {"siam"} - new - mine
    assert {spec.partition(":")[0] for spec in GAMES} == (mine | {"cradle"}) - {
        "beads"
    }  # whose true run stops at a collapse
    with pytest.raises(SceneError, match="more than 256 circles; give events= or until="):
        check("double", "siam")
    assert check("double", "siam", events=5).asserted


@pytest.mark.parametrize("name", ["double", "single", "quad"])
@pytest.mark.parametrize("scene", SCENES + GAMES)
def test_an_honest_engine_passes(name: str, scene: str) -> None:
    assert check(name, scene).asserted


@pytest.mark.parametrize("name", STEPS)
@pytest.mark.parametrize("scene", SCENES)
def test_an_honest_engine_of_steps_passes(name: str, scene: str) -> None:
    assert check(name, scene).asserted


@pytest.mark.parametrize("bug", BUGS, ids=lambda bug: bug.name)
@pytest.mark.parametrize("name", ["double", "single", "quad", *STEPS])
def test_a_planted_bug_is_found_and_told(name: str, bug: Any) -> None:
    with pytest.raises(CheckFailed) as caught:
        check(Planted(engine(name), bug), bug.scene)
    assert not isinstance(caught.value, NotDecided)
    assert bug.told in str(caught.value), str(caught.value)


class Counted:
    """A number that counts the operations made with it."""

    done = 0

    def _one(self, *_: Any) -> Counted:
        Counted.done += 1
        return self

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = __rtruediv__ = __neg__ = _one
    __pow__ = _one


def counted(*steps: tuple[Callable[..., Any], int]) -> int:
    """Operations of some formulas, each so many times."""
    Counted.done = 0
    for formula, times in steps:
        for _ in range(times):
            formula(*[Counted()] * formula.__code__.co_argcount)
    return Counted.done


def test_the_roundings_of_one_contact_are_counted() -> None:
    pair = counted(
        (formulas.pair_approach, 1),
        (formulas.pair_gap, 1),
        (formulas.pair_discriminant, 1),
        (formulas.pair_hit_time, 1),
        (formulas.advance, 4),
        (formulas.pair_impulse, 1),
    )
    wall = counted(
        (formulas.wall_gap, 1),
        (formulas.wall_approach, 1),
        (formulas.wall_hit_time, 1),
        (formulas.advance, 2),
        (formulas.wall_bounce, 1),
    )
    falling = counted(
        (formulas.wall_gap, 1),
        (formulas.wall_approach, 2),
        (formulas.fall_discriminant, 1),
        (formulas.fall_time_back, 1),
        (formulas.sag, 2),
        (formulas.fall_speed, 2),
        (formulas.wall_bounce, 1),
        (formulas.damped, 2),
        (formulas.advance, 2),
    )
    assert falling + 4 <= ROUNDINGS  # with a root, a clock, and a velocity relative to the wall
    relative, push, root, clock = 8, 8, 1, 1
    assert (pair + relative + push + root + clock, wall + clock) == (PAIR, WALL)
    assert max(PAIR, WALL) <= ROUNDINGS


PAIR, WALL = 57, 25


def test_errors_grow_as_the_tangent_map_says() -> None:
    """With input errors alone, all coordinates alike, the largest error is that of the tangent map's norm."""
    run = ExactEngine().run(catalogue.build("gas:n=4"), events=40)
    grown = GrownErrors(run, LocalError(0.0, 2.0**-53))
    for index in range(40):
        grown.come_to(index)
        grown.go_through(index)
    bits = error_growth(run, 40)
    assert bits is not None
    worst = max(grown.tolerance(k, float(run.events[-1].time))[0] for k in range(4))
    size = max(max(abs(float(c.x)), abs(float(c.y))) for c in run.scene.circles)
    assert 2.0 ** (40 * bits - 53) / 64 < worst < 64 * size * 2.0 ** (40 * bits - 53)


def test_an_exact_engine_is_held_to_all_of_it() -> None:
    run = ExactEngine().run(catalogue.build("gas"), events=60)
    reach = reach_of(run, LocalError(0.0, 0.0))
    assert (reach.events, reach.linear, reach.limit) == (60, 60, None)
    assert max(reach.time) == 0.0


def test_near_ties_are_out_of_reach_where_they_are_nearer_than_errors() -> None:
    for k in range(2, 45, 6):
        checked = check("double", f"near-tie:k={k}")
        assert checked.reach is not None
        assert checked.reach.whole == (k <= 12), k
    assert check("quad", "near-tie:k=24").reach.whole  # type: ignore[union-attr]


def test_the_order_of_an_engine_of_steps_is_seen() -> None:
    run = ExactEngine().run(catalogue.build("gas"), events=30)
    local = local_error(PymunkEngine(dt=1 / 128), run, 53)
    assert local.order == 1.0
    assert 1 / 128 <= local.lateness <= 2 / 128


@dataclass(frozen=True)
class ToldLater(Planted):
    """An engine of steps that pushes in time, and tells it two steps later."""

    def run(self, scene: Scene, **limits: Any) -> Any:
        recording = Recording(scene, self.name)
        run = self.inner.run(scene, **limits)
        for event in run.events:
            state, lag = run.at(event.time), 2 * self.inner.step
            rows = {
                name: (c.x + lag * c.vx, c.y + lag * c.vy, c.vx, c.vy)
                for pair in event.impulses
                for name, c in ((name, state[name]) for name in pair if name not in {w.id for w in scene.walls})
            }
            recording.hits(float(event.time) + lag, event.impulses, rows)
        recording.end()
        return replace(recording.trajectory(), stop=run.stop)


@pytest.mark.parametrize("name", STEPS)
def test_a_meeting_that_is_told_some_steps_later_is_honest(name: str) -> None:
    told = str(check(ToldLater(engine(name), BUGS[0]), "gas:n=3"))
    assert "the same history in" in told


@dataclass(frozen=True)
class Silent(Declared):
    """An engine that stops, not knowing."""

    name: str = "silent"

    def run(self, scene: Scene, **limits: Any) -> Any:
        run = DoubleEngine().run(scene, **{**limits, "until": None, "events": 1})
        return replace(run, stop=replace(run.stop, reason=run.stop.reason.UNDECIDED, message="undecided: at all"))


def test_what_cannot_be_decided_is_not_passed() -> None:
    with pytest.raises(NotDecided, match="undecided: at all"):
        check(Silent(), "gas", events=20)


@pytest.mark.parametrize("asked", [{}, {"permitted": True}, {"events": 3}])
def test_a_scene_that_an_engine_does_not_follow_is_not_passed(asked: dict[str, Any]) -> None:
    class NoPockets(DoubleEngine):
        name, scene_keys = "plain", frozenset({"wall"})

    with pytest.raises(NotDecided, match="plain on rack: cannot run this scene: it does not follow 'pocket'"):
        check(NoPockets(), "rack", **asked)


def test_a_span_is_required_whatever_its_margins() -> None:
    assert "150 events" in str(check("double", "gas", events=150))
    with pytest.raises(CheckFailed, match="double first differs at event 161"):
        check("double", "gas", events=170)
    with pytest.raises(CheckFailed, match="near-tie:k=40"):
        check("double", "near-tie:k=40", events=2)


def test_digits_are_certified_ones() -> None:
    assert check("double", "gas", events=60, digits=6)
    with pytest.raises(CheckFailed) as caught:
        check("double", "gas", events=60, digits=14)
    assert "14 digits" in str(caught.value)
    assert "digits are right" in str(caught.value)
    assert check("double", "gas", events=20, atol=1e-9)
    with pytest.raises(CheckFailed, match="1e-15 is asked for"):
        check("double", "gas", events=60, atol=1e-15)


def test_permitted_histories() -> None:
    class Sequential(Declared):
        name, bits, rounds_input = "sequential", 53, True

        def run(self, scene: Scene, **limits: Any) -> Any:
            run = DoubleEngine().run(scene.with_changes(tie_policy="sequential:order=scene"), **limits)
            return replace(run, scene=scene, engine=self.name)

    with pytest.raises(CheckFailed):
        check(Sequential(), "lee", events=1)
    assert "permitted" in str(check(Sequential(), "lee", permitted=True))
    told = str(check(Sequential(), "rack:rows=3", permitted=True))
    assert "permitted: some order of the impulses leads to it" in told
    assert "audited" in told
    told = str(check("pymunk:dt=1/64", "rack:rows=3", permitted=True))
    assert "up to event" in told
    assert "errors allowed by the rounding model may have grown to" in told


def test_a_history_of_mixed_ties_is_permitted() -> None:
    """A break by the policy, and then, by rounding, a tie taken in one of its orders: no order does that all along."""
    told = str(check("double", "rack:rows=3", permitted=True))
    assert "permitted: each tie resolved by the policy or in an order; times and places of" in told
    with pytest.raises(CheckFailed, match="no order of the impulses leads to it") as caught:
        check(Planted(engine("double"), replace(BUGS[0], given=heavier)), "rack:rows=3", permitted=True)
    assert "violation: does not keep the law" in str(caught.value)
    assert "event 0 (t = 43.75)" in str(caught.value)


@pytest.mark.parametrize("rows", [2, 3, 4, 5])
def test_errors_are_carried_through_a_break(rows: int) -> None:
    """24 bits are soon out of reach among balls that touch; 106 bits tell all of it, times and places too."""
    few, many = (check(name, f"rack:rows={rows}", permitted=True) for name in ("single", "quad"))
    assert "times and places of" in str(few)
    assert "up to event" not in str(many)
    count = int(str(many).split("times and places of ")[1].split()[0])
    assert count >= 19


@pytest.mark.parametrize("bug", BUGS, ids=lambda bug: bug.name)
@pytest.mark.parametrize("scene", ["rack:rows=2", "rack:rows=3,gap=1/50"])
@pytest.mark.parametrize("name", ["double", "single", "quad"])
def test_a_planted_bug_is_found_where_any_order_will_do(name: str, scene: str, bug: Any) -> None:
    with pytest.raises(CheckFailed) as caught:
        check(Planted(engine(name), bug), scene, permitted=True)
    assert not isinstance(caught.value, NotDecided)


def test_a_guide_that_loses_a_history_at_once_excuses_nothing() -> None:
    """Taken one by one, a tie is left with margin 0; taken together, it is followed up to the wall that is missed."""
    bug = next(bug for bug in BUGS if bug.name == "missed wall")
    with pytest.raises(CheckFailed, match=r"first differs at event 5 .* instead of wall top"):
        check(Planted(engine("double"), bug), "rack:rows=3,gap=1/50", permitted=True)


def test_numbers_are_held_against_the_run_that_resolves_ties_alike() -> None:
    assert "6 digits" in str(check("double", "rack:rows=3", permitted=True, events=10, digits=6))
    with pytest.raises(CheckFailed, match="14 digits; 13 digits are right"):
        check("double", "rack:rows=3", permitted=True, events=10, digits=14)


def test_a_log_is_checked_as_far_as_it_goes() -> None:
    run = DoubleEngine().run(catalogue.build("gas"), events=50)
    checked = check(triples(run), "gas")
    assert checked.comparison is not None
    assert "times of" in str(checked)
    late = [(time + 1e-7 * (k > 20), a, b) for k, (time, a, b) in enumerate(triples(run))]
    with pytest.raises(CheckFailed, match=r"event 21 .* off by 1e-07"):
        check(late, "gas")
    assert check(late, "gas", bits=24).asserted


def test_what_cannot_be_checked_is_refused() -> None:
    with pytest.raises(SceneError, match="more than 256 circles"):
        check("double", "gas:n=300")
    with pytest.raises(SceneError, match="bits: is declared of a log only"):
        check("double", "gas", bits=24)
    with pytest.raises(SceneError, match="horizon = 'wide'"):
        check("double", "gas", horizon="wide")
    with pytest.raises(SceneError, match="engine 'duoble' is not known"):
        check("duoble", "gas")


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({"digits": 0}, "digits = 0: must be a whole number from 1"),
        ({"digits": 1.5}, "digits = 1.5: must be"),
        ({"atol": float("nan")}, "atol = nan: must be a finite number from 0"),
        ({"atol": float("inf")}, "atol = inf: must be"),
        ({"rtol": -1}, "rtol = -1: must be"),
        ({"atol": "1"}, "atol = '1': must be"),
        ({"horizon": 2.5}, "horizon = 2.5: must be a number of bits"),
        ({"horizon": True}, "horizon = True: must be"),
        ({"max_seconds": 0}, "max_seconds = 0: must be a number of seconds above zero"),
        ({"max_seconds": "5"}, "max_seconds = '5': must be"),
    ],
)
def test_a_demand_that_asks_for_nothing_is_refused(asked: dict[str, Any], told: str) -> None:
    with pytest.raises(SceneError, match=told.replace("'", ".")):
        check("double", "near-tie:k=2", **asked)
    with pytest.raises(SceneError, match="scene = 3: must be a Scene"):
        check("double", 3)  # pyright: ignore[reportArgumentType]


def test_a_horizon_of_fewer_bits_asks_for_less() -> None:
    scene = Scene([Circle(0, 0, vx=1, id="a"), Circle(4, "1/2", id="b"), Circle(8, 1, id="c")], name="row")
    few, many = check("double", "gas", horizon="float32").reach, check("double", "gas").reach
    assert few is not None
    assert many is not None
    assert few.events < many.events
    assert check("double", scene, horizon=24).reach is not None


@pytest.mark.parametrize("name", ["double", "single"])
@pytest.mark.parametrize(("y", "vx", "x", "span"), [(1, "1", "1/3", 1), (2, "2", "1/7", 1), (1, "1", "1/3", 2)])
def test_a_tie_that_an_engine_takes_one_by_one_may_end_after_it(y: int, vx: str, x: str, span: int, name: str) -> None:
    """Two walls met at one instant: the order of `slope`, then `floor`, has its second contact some ulps later."""
    time = f"{span}*7/3"
    ball = Circle(f"{x} - ({vx})*{time}", f"2/7 + {y}*{time}", 1, vx, -y, id="ball")
    slope = Wall(f"{x}-3/5", "2/7-4/5", f"{x}-3/5+4", "2/7-4/5-3", id="slope")
    floor, top = Wall(0, "2/7-1", 1, "2/7-1", id="floor"), Wall(0, 300, 1, 300, id="top")
    assert "its tie: " in str(check(name, Scene([ball], [floor, slope, top], events=5)))


def test_a_contact_of_a_tie_that_is_left_out_is_still_found() -> None:
    """It comes neither at the tie nor after it."""
    ball = Circle("1/3 - 7/3", "2/7 + 7/3", 1, 1, -1, id="ball")
    slope = Wall("1/3-3/5", "2/7-4/5", "1/3-3/5+4", "2/7-4/5-3", id="slope")
    scene = Scene([ball], [slope, Wall(0, "2/7-1", 1, "2/7-1", id="floor"), Wall(0, 300, 1, 300, id="top")], events=5)

    @dataclass(frozen=True)
    class WithoutFloor(Declared):
        name: str = "without"

        def run(self, scene: Scene, **limits: Any) -> Any:
            left = scene.with_changes(walls=[w for w in scene.walls if w.id != "floor"])
            return replace(engine("double").run(left, **limits), scene=scene)

    with pytest.raises(CheckFailed):
        check(WithoutFloor(), scene)


class TimesAlone(RecordedEngine):
    """Tells when what happens, in doubles, and not where."""

    name = "times"

    def play(self, scene: Scene, recording: Recording) -> None:
        run = engine("double").run(scene, until=recording.until, events=recording.events)
        for event in run.events:
            recording.hits(float(event.time), [(pair.first, pair.second) for pair in event.impulses])
        recording.end(float(run.final_time))


def test_places_are_not_said_to_be_right_that_nobody_told() -> None:
    own, timed = (check(name, "gas:n=4", atol=1e-2).asserted for name in ("double", TimesAlone()))
    assert any(words.startswith("times and places of 58") for words in own) and "times and places within" in own[-1]
    assert any(words.startswith("times of 58") for words in timed) and "times within 0.01" in timed[-1]
    assert not any("places" in words for words in timed)
    (span,) = (words for words in check(TimesAlone(), "gas:n=4", events=9, atol=1e-6).asserted if "within" in words)
    assert span == "times within 1e-06 + 0 times the true value"


def test_no_number_is_said_to_be_right_where_none_is_compared() -> None:
    """An exact tie at the first event: nothing of the history is required."""
    found = check("double", "lee", atol=1e-6, digits=3)
    assert "nothing required" in found.asserted[0]
    assert not any("true value" in words or "digits of" in words for words in found.asserted)
