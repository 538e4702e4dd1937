"""A run that goes on from what was saved is the run that was never interrupted."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from typing import Any

import pytest
from test_saved import MANY_ROOTS, RUNS, assumed, pocketed

from truebreak.compare import trajectory_json
from truebreak.exact import ExactEngine
from truebreak.exact.numbers import ball
from truebreak.exact.results.saved import run_of, saved_run
from truebreak.exact.simulation.loop import Loop
from truebreak.scenarios import Circle, Pocket, Scene, SceneError, StopReason, Trajectory, Wall, catalogue


def all_but_plan(run: Trajectory) -> tuple[str, str]:
    """What a run is, as JSON and as saved, without what it counted on the way."""
    told = trajectory_json(run)
    saved = json.loads(saved_run(run))
    for data in (told, saved, saved["tape"]):
        data.pop("plan")
    saved.pop("digest")
    return json.dumps(told), json.dumps(saved)


class Counted:
    """Counts how often a run sets the precision, from where its loop begins to where it ends.

    Args:
        limit: at which of them Ctrl-C comes: anywhere, also within an instant.
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch, limit: int = 0) -> None:
        self.patch = monkeypatch
        self.limit = limit
        self.calls = self.whole = 0
        self.armed = False

    def run(self, run: Callable[[], Trajectory]) -> Trajectory:
        """What comes of a run."""
        use_bits, first, loop = ball.use_bits, Loop._first_knots, Loop.run

        def counted(bits: int) -> None:
            self.calls += self.armed
            if self.armed and self.calls == self.limit:
                raise KeyboardInterrupt
            use_bits(bits)

        def begun(self_: Loop) -> None:
            first(self_)
            self.armed = True

        def ended(self_: Loop) -> Any:
            stop = loop(self_)
            self.armed, self.whole = False, self.calls
            return stop

        with self.patch.context() as patched:
            patched.setattr(ball, "use_bits", counted)
            patched.setattr(Loop, "_first_knots", begun)
            patched.setattr(Loop, "run", ended)
            return run()


def interrupted_after(calls: int, run: Callable[[], Trajectory], monkeypatch: pytest.MonkeyPatch) -> Trajectory:
    """A run that Ctrl-C ends."""
    return Counted(monkeypatch, calls).run(run)


def calls_of(run: Callable[[], Trajectory], monkeypatch: pytest.MonkeyPatch) -> int:
    """How often a run sets the precision."""
    counted = Counted(monkeypatch)
    counted.run(run)
    return counted.whole


def drawn_pockets() -> Trajectory:
    """Many circles, drawn orders, pockets, a reversal by count and lasting contacts."""
    circles = [Circle(2 * k, 2, r=1, vx=1 if k == 1 else 0, id=f"c{k}") for k in range(1, 4)]
    walls = (Wall(0, 0, 0, 1), Wall(12, 0, 12, 1), Wall(0, 0, 1, 0), Wall(0, 9, 1, 9))
    more = [Circle(10, 4, vy=-1, vx="1/3", id="d"), Circle(10, 8, vx="-1/2", id="e")]
    scene = Scene([*circles, *more], walls, pockets=[Pocket(6, 5, 1)], reverse_after=8)
    return ExactEngine().run(scene.with_changes(tie_policy="sequential:seed=5"), events=30)


CASES: dict[str, Callable[[], Trajectory]] = {
    **{name: RUNS[name] for name in RUNS if name not in ("undecided", "assumed", "long numbers")},
    "drawn": drawn_pockets,
    "disc in a disc": lambda: ExactEngine().run(catalogue.build("inscribed"), events=12),
    "tennis": lambda: ExactEngine().run(catalogue.build("tennis"), events=20),
    "the way back": lambda: ExactEngine().run(catalogue.build("gas:n=4").with_changes(reverse_after=12)),
    "rack with a cue": lambda: ExactEngine().run(catalogue.build("rack:rows=3"), events=25),
    "rising": lambda: ExactEngine().run(catalogue.build("gas:n=3"), events=1200),
}


@pytest.mark.parametrize("kind", CASES)
def test_a_run_that_was_interrupted_anywhere_goes_on_as_if_it_had_not_been(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = CASES[kind]()
    calls = calls_of(CASES[kind], monkeypatch)
    draw = random.Random(kind)
    told = all_but_plan(whole)
    for place in sorted({2, calls, *(draw.randrange(1, calls + 1) for _ in range(6))}):
        part = interrupted_after(place, CASES[kind], monkeypatch)
        assert part.stop.reason is StopReason.INTERRUPTED
        again = ExactEngine().resume(run_of(saved_run(part)))
        assert all_but_plan(again) == told, place


def test_what_goes_on_can_be_interrupted_again(monkeypatch: pytest.MonkeyPatch) -> None:
    run = CASES["the way back"]
    calls = calls_of(run, monkeypatch)
    part = interrupted_after(calls // 3, run, monkeypatch)
    more = interrupted_after(2 * calls // 3, lambda: ExactEngine().resume(part), monkeypatch)
    assert len(part.events) < len(more.events)
    assert all_but_plan(ExactEngine().resume(run_of(saved_run(more)))) == all_but_plan(run())


def test_what_is_interrupted_before_it_is_where_it_was_keeps_what_there_is(monkeypatch: pytest.MonkeyPatch) -> None:
    part = ExactEngine().run(catalogue.build("gas:n=4"), events=40)
    kept = interrupted_after(20, lambda: ExactEngine().resume(part, events=50), monkeypatch)
    assert kept.stop.reason is StopReason.INTERRUPTED
    assert kept.events == part.events
    assert len(ExactEngine().resume(kept, events=50).events) == 50


@pytest.mark.parametrize("kind", ["gas", "rack", "point", "drawn", "roots", "many roots", "pocketed"])
def test_to_farther_limits_it_is_the_run_to_those(kind: str) -> None:
    whole = CASES[kind]()
    for events in range(1, len(whole.events) + 1, 1 + len(whole.events) // 6):
        part = run_of(saved_run(ExactEngine().run(whole.scene, events=events)))
        again = ExactEngine().resume(part, events=len(whole.events))
        told = trajectory_json(ExactEngine().run(whole.scene, events=len(whole.events)))
        mine = trajectory_json(again)
        assert mine.pop("plan").keys() >= {"bits"}
        told.pop("plan")
        assert json.dumps(mine) == json.dumps(told)


def test_to_nearer_limits_too() -> None:
    whole = CASES["gas"]()
    assert all_but_plan(ExactEngine().resume(whole, events=7)) == all_but_plan(ExactEngine().run(whole.scene, events=7))
    half = float(whole.final_time) / 2
    assert all_but_plan(ExactEngine().resume(whole, until=half)) == all_but_plan(
        ExactEngine().run(whole.scene, until=half)
    )


def test_what_was_undecided_goes_on_with_more_work() -> None:
    part = RUNS["undecided"]()
    assert part.stop.reason is StopReason.UNDECIDED
    again = ExactEngine().resume(run_of(saved_run(part)))
    assert all_but_plan(again)[0] == all_but_plan(ExactEngine().run(part.scene))[0]


def test_the_rule_of_ties_stays() -> None:
    part = assumed()
    with pytest.raises(SceneError, match="go on with the same"):
        ExactEngine().resume(part)
    again = ExactEngine(ties="assume:200", work=2000).resume(run_of(saved_run(part)))
    assert all_but_plan(again) == all_but_plan(part)
    assert again.assumptions == part.assumptions


def test_a_log_of_another_scene_is_told() -> None:
    part = ExactEngine().run(MANY_ROOTS, events=9)
    data = json.loads(saved_run(part))
    assert [row for row in data["tape"]["instants"] if isinstance(row, list)]
    other = ExactEngine().run(MANY_ROOTS.with_changes(tie_policy="sequential:order=scene"), events=9)
    other.motion.tape.found[3] = (0, 1)  # type: ignore[attr-defined]
    with pytest.raises(SceneError, match="the log is not what its scene does"):
        ExactEngine().resume(other, events=20)


def test_pockets_are_among_the_cases() -> None:
    assert pocketed().pocketings
    assert drawn_pockets().reversal is not None
