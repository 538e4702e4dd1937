"""What reports say of causes, where something else was seen to be so: each of these was told wrongly once."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path

import pytest
from audit.planted import PlantedSteps

from truebreak.compare import compare
from truebreak.compare.audit import residuals
from truebreak.compare.causes import budget, other_settings
from truebreak.compare.causes.diagnosis import CauseName
from truebreak.compare.comparison import Candidate
from truebreak.compare.foreign.log_engine import LogEngine
from truebreak.compare.foreign.recorded import RecordedEngine
from truebreak.compare.foreign.recording import Recording
from truebreak.compare.report.answers import verdict_line, what_now, why
from truebreak.compare.report.sentences import head_phrase, verdict_sentence
from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine, PymunkEngine
from truebreak.scenarios import Circle, Pocket, Scene, Wall, catalogue


def only(scene: Scene, engine: object, **limits: object) -> Candidate:
    """The comparison of one engine."""
    return compare(scene, [engine], **limits).candidates[0]  # pyright: ignore


def test_times_told_out_of_order_by_rounding_are_taken_in_the_order_told(tmp_path: Path) -> None:
    """The impulses of one instant, the second a spacing of doubles before the first."""
    rows = [
        ("left", "middle", {"left": [-2, 0, 0, 0], "middle": [0, 0, 1, 0]}),
        ("middle", "right", {"middle": [0, 0, -2.2, 0], "right": [3, 0, -0.19999999999999996, 0]}),
        ("left", "middle", {"left": [-2, 0, -2.2, 0], "middle": [0, 0, 0, 0]}),
        ("middle", "right", {"middle": [0, 0, -0.31999999999999995, 0], "right": [3, 0, -0.11999999999999997, 0]}),
    ]
    told = [
        {"time": 1.0 if k == 1 else 1.0000000000000002, "contact": [a, b], "states": s}
        for k, (a, b, s) in enumerate(rows)
    ]
    log = tmp_path / "log.jsonl"
    log.write_text("\n".join(map(json.dumps, [*told, {"end": 5}])))
    scene = catalogue.build("lee:tie=sequential:order=scene")
    found = only(scene, LogEngine.of(log, scene), until=5)
    assert found.laws is not None and found.laws.kept
    assert found.alignment.verdict == "agree"


LATE = Scene(
    [
        Circle(-3, 0, vx=1, id="left"),
        Circle(0, 0, id="middle"),
        Circle("4 - 1/10**20", 0, 2, vx=-1, m=4, id="right"),
    ],
    [Wall(-20, 0, -20, 1, id="wl"), Wall(20, 0, 20, 1, id="wr")],
    events=14,
)  # fmt: skip


@pytest.mark.parametrize("lacks", [9, 11])
def test_a_law_broken_after_the_divergence_is_not_its_cause(lacks: int) -> None:
    """Doubles diverge at the first event; a contact that is left out later, of the same pair too, did not do that."""
    whole = DoubleEngine().run(LATE, events=lacks + 1)
    recording = Recording(LATE)
    for event in whole.events[:lacks]:
        states = {c.id: (c.x, c.y, c.vx, c.vy) for c in whole.after(event.index).circles}
        recording.hits(float(event.time), [tuple(c) for c in event.impulses], states)  # pyright: ignore
    recording.end(2 * float(whole.final_time))
    comparison = compare(LATE, [LogEngine(recording)])
    found = comparison.candidates[0]
    assert found.lawless and found.alignment.divergence is not None and found.alignment.divergence.event == 0
    assert found.diagnosis is not None and found.diagnosis.name is CauseName["INPUT"]
    said = why(comparison, found)
    assert said.startswith("Input rounding") and "Later" in said and "do not collide" in said
    last = next(v for v in found.laws.violations if v.kind == "depth")  # pyright: ignore
    assert f"at t = {last.time:.9g}: " in said and "event 9 (" not in said


def test_another_policy_at_a_tie_is_no_floating_point_error() -> None:
    scene = catalogue.build("lee")
    run = DoubleEngine().run(catalogue.build("lee:tie=sequential"))
    recording = Recording(scene)
    for event in run.events:
        for pair in event.impulses:
            recording.hit(float(event.time), pair.first, pair.second)
    recording.end(quiet=True)
    found = only(scene, LogEngine(recording))
    assert found.diagnosis is not None and found.diagnosis.name is CauseName["TIE"]
    assert head_phrase(found) == "A tie was resolved differently"


@pytest.mark.parametrize("rows", [2, 3])
def test_what_makes_two_fall_on_one_instant_changes_the_decision_alone(rows: int) -> None:
    """The rack in doubles has no jitter of 10**-20 any more: b1 meets both at once, as `double` does."""
    found = only(catalogue.build(f"rack:rows={rows},jitter=10**-20"), "double", events=6)
    assert found.diagnosis is not None and found.diagnosis.name is CauseName["INPUT"]
    row = next(row for row in found.diagnosis.experiments if row.cause is CauseName["INPUT"])
    assert row.suffices is True and "alone it does not" not in row.result


def test_what_an_answer_is_rounded_by_is_named_without_what_hardly_adds_to_it() -> None:
    found = only(catalogue.build("near-tie:k=5"), PymunkEngine(dt=1 / 60))
    assert found.diagnosis is not None and found.diagnosis.causes == (CauseName["LATENESS"],)
    found = only(catalogue.build("rack:rows=2,gap=10**-9,offset=10**-12"), "double")
    assert found.diagnosis is not None and found.diagnosis.causes == (CauseName["DECISION"],)


def test_of_several_events_at_one_time_each_leaves_its_own_state() -> None:
    """What doubles take for one instant leaves b2 three times; all three states were the last."""
    run = DoubleEngine().run(catalogue.build("rack:rows=3,gap=10**-20"), events=4)
    assert len({float(event.time) for event in run.events}) == 1
    assert [round(float(run.after(k)["b2"].vx), 2) for k in range(4)] == [0.0, 0.6, -0.09, -0.07]
    assert [round(float(run.after(k)["b5"].vx), 2) for k in range(4)] == [0.0, 0.0, 0.25, 0.25]


def test_what_the_partner_meets_before_in_the_exact_run_is_what_was_decided() -> None:
    """b2 meets b4 by 1e-20 before it would meet b5; the margin was said to be 0.3, by arithmetic and no run."""
    found = only(catalogue.build("rack:rows=3,gap=10**-20"), "double", events=40)
    assert found.diagnosis is not None and found.diagnosis.causes == (CauseName["DECISION"],)
    assert found.margin is not None and found.margin.gap[0] == pytest.approx(1.4433756729740639e-20)


def test_kinds_that_cancel_each_other_are_not_said_to_shift_the_margin() -> None:
    """What is mirrored errs alike; only the offset of 10**-20 that 24 bits cannot hold decides."""
    found = only(catalogue.build("rack:rows=3,offset=10**-20"), "single", events=40)
    assert found.diagnosis is not None and found.diagnosis.name is CauseName["INPUT"]
    assert [row.cause for row in found.diagnosis.large(0.1)] == [CauseName["INPUT"]]


def test_a_contact_too_many_before_it_is_no_tunnelling() -> None:
    """Two bricks in one step turn the ball; that it passes through the paddle later is not why."""
    found = only(catalogue.build("breakout"), PymunkEngine(dt=1 / 30))
    assert found.diagnosis is not None and found.diagnosis.name is CauseName["STEP"]


def test_the_account_of_quad_is_of_its_106_bits() -> None:
    """Its states were read as doubles, so that its flights and impulses had shares of 1e-15 that cancel."""
    found = only(catalogue.build("inscribed:n=5"), "quad", events=8)
    assert found.diagnosis is not None
    sizes = [abs(row.displacement) for row in found.diagnosis.experiments if row.displacement]
    assert sizes and max(sizes) < 2.0**-95


def test_between_two_slopes_a_disc_slides_along_neither() -> None:
    walls = [Wall(0, 0, 4, -3, id="v"), Wall(0, 0, 4, 3, id="w")]
    stop = ExactEngine().run(Scene([Circle("5/3", 0, id="d")], walls, gravity=(-10, 0)), until=1).stop
    assert stop.message.endswith("d and v as well as d and w")


def test_against_a_float_engine_nothing_is_told_of_floating_point() -> None:
    """It takes the near-tie for a tie, as the others do, and was said to be right."""
    scene = catalogue.build("near-tie")
    told = compare(scene, ["pymunk", "single"], reference="double")
    assert told.verdict == "agree"
    assert verdict_sentence(told).startswith("No difference: pymunk and single agree with the double run")
    assert "right to the end" not in what_now(told, told.candidates[0])
    found = compare(scene, ["exact"], reference="double").candidates[0]
    assert found.diagnosis is not None and found.diagnosis.name is CauseName["UNKNOWN"]
    assert "the error is double's" in found.diagnosis.finding


@dataclass(frozen=True)
class Soft(RecordedEngine):
    """Steps of 1/128 or finer; of what meets in one step it gives too little back."""

    step: float = 1 / 128
    name, scene_keys = "soft", frozenset[str]()

    def play(self, scene: Scene, recording: Recording) -> None:
        steps, rows = 0, [list(row) for row in recording.rows]
        while recording.open:
            steps += 1
            for row in rows:
                row[0], row[1] = row[0] + self.step * row[2], row[1] + self.step * row[3]
            gaps = [math.dist(rows[0][:2], row[:2]) for row in rows[1:]]
            if max(gaps) < 2.0 and rows[0][2] > 0.0 == rows[1][2]:
                rows[0][2], rows[1][2:], rows[2][2:] = 0.44, [0.28, 0.21], [0.28, -0.21]
            recording.state(steps * self.step, [tuple(row) for row in rows])  # pyright: ignore


def test_energy_that_is_lost_where_several_meet_is_no_tie() -> None:
    """No order of the impulses loses half of it; that was said to be of the step, as the room for rounding was."""
    discs = [Circle(-4, 0, vx=1, id="a"), Circle("8/5", "6/5", id="b"), Circle("8/5", "-6/5", id="c")]
    found = only(Scene(discs, until=8), Soft())
    assert found.laws is not None and found.laws.kept is False
    assert found.diagnosis is not None and str(found.diagnosis) == "law not kept"


def test_a_contact_that_is_told_twice_is_no_rounding() -> None:
    """Nothing pushes two that part: that no rounding plays a part in it is said of the second line."""
    scene = catalogue.build("gas:n=4")
    whole = DoubleEngine().run(scene, events=12)
    recording = Recording(scene)
    for event in whole.events:
        states = {c.id: (c.x, c.y, c.vx, c.vy) for c in whole.after(event.index).circles}
        for _ in range(1 + (event.index == 4)):
            recording.hits(float(event.time), [tuple(c) for c in event.impulses], states)  # pyright: ignore
    recording.end(float(whole.final_time))
    comparison = compare(scene, [LogEngine(recording)], events=11)
    found = comparison.candidates[0]
    assert found.diagnosis is not None and found.diagnosis.name is CauseName["PARTING"]
    assert head_phrase(found).startswith("A contact of two that part, without effect, was reported")
    assert "chaos" not in why(comparison, found)


def test_one_finer_step_that_agrees_is_not_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """It may agree by chance: a finer one is run then, however many steps that takes, and has to agree as well."""
    scene = catalogue.build("gas:n=4")
    engine = PymunkEngine(dt=1 / 64)

    @dataclass
    class Lab:
        answers: list[bool]
        accounted: str = "none"
        margin: None = None

        def __post_init__(self) -> None:
            self.engine, self.study, self.name = engine, self, "pymunk"
            self.scene, self.took = scene, 0

        def until(self, step: float) -> float:
            return 1.0

        def run(self, finer: PymunkEngine, scene: Scene, until: float) -> PymunkEngine:
            self.took += 1
            return finer

    monkeypatch.setattr(other_settings, "gone", lambda lab, run, step: lab.answers[lab.took - 1])
    monkeypatch.setattr(other_settings, "ends_early", lambda lab, run, until, step: False)
    monkeypatch.setattr(other_settings, "series_steps", lambda engine: 300)  # to two halvings of 1/64
    for answers, enough, runs in (
        ([False, True, False], False, 3),
        ([False, True, True], True, 3),
        ([True, True], True, 2),
        ([False, False], False, 2),
    ):
        lab = Lab(answers)
        (row,) = other_settings.step(lab, [])  # pyright: ignore[reportArgumentType]
        assert (row.suffices, lab.took) == (enough, runs), answers


def test_what_an_impulse_of_steps_leaves_off_is_the_velocity_that_it_is() -> None:
    """Masses taken for each other: three pairs head on; every one is told, and by how much it is off."""
    pairs = [(3, 1, 2), (2, 1, 1), (1, 1, 3)]
    circles = [
        Circle(x, 8 * k, 1, vx=vx, m=m, id=f"{name}{k}")
        for k, (one, speed, other) in enumerate(pairs)
        for name, x, vx, m in (("a", 0, speed, one), ("b", 4, -speed, other))
    ]
    scene, recording = Scene(circles, []), Recording(Scene(circles, []), step=1 / 8)
    rows = {str(c.id): [float(v) for v in (c.x, c.y, c.vx, c.vy)] for c in circles}
    off = []
    for n in range(1, 33):
        time = n / 8
        for row in rows.values():
            row[0] += row[2] / 8
        if time == 1.0:
            for k, (one, speed, other) in enumerate(pairs):
                true = [speed - 4 * speed * other / (one + other), -speed + 4 * speed * one / (one + other)]
                made = [speed - 4 * speed * one / (one + other), -speed + 4 * speed * other / (one + other)]
                rows[f"a{k}"][2], rows[f"b{k}"][2] = made
                off.append(max(abs(a - b) for a, b in zip(true, made, strict=True)))
        states: dict[str, tuple[float, ...]] = {name: (*row,) for name, row in rows.items()}
        if time == 1.0:
            for k in range(3):
                recording.hit(time, f"a{k}", f"b{k}", states)  # pyright: ignore[reportArgumentType]
        else:
            recording.state(time, states)  # pyright: ignore[reportArgumentType]
    recording.end(4.0)
    found = only(scene, LogEngine(recording), until=4)
    assert found.laws is not None and found.laws.kept is False
    (first,) = found.laws.violations
    assert first.size == pytest.approx(off[0])
    assert found.laws.counts == {"impulse": 3}


@dataclass
class FailsAtFinerSteps(RecordedEngine):
    """Pymunk's states step by step; at a finer step one of them cannot be."""

    name: str = "mine"
    step: float | None = 1 / 64

    def finer(self) -> FailsAtFinerSteps:
        assert self.step is not None
        return FailsAtFinerSteps(step=self.step / 2)

    def play(self, scene: Scene, rec: Recording) -> None:
        assert self.step is not None
        run = PymunkEngine(dt=self.step).run(scene, until=rec.until)
        for k in range(1, int(float(run.final_time) / self.step) + 1):
            row = {c.id: (float(c.x), float(c.y), float(c.vx), float(c.vy)) for c in run.at(k * self.step).circles}
            faster = 1.0 if self.step < 1 / 64 and k == 20 else 0.0
            rec.state(k * self.step, {name: (x, y, vx + faster, vy) for name, (x, y, vx, vy) in row.items()})


def test_a_finer_step_that_cannot_be_judged_is_evidence_of_nothing() -> None:
    found = only(catalogue.build("gas:n=4"), FailsAtFinerSteps(), events=20)
    assert found.alignment.verdict == "diverged" and found.diagnosis is not None
    (row,) = [row for row in found.diagnosis.experiments if row.cause is CauseName["STEP"]]
    assert row.suffices is None
    assert row.result.startswith("not tried: a step of 0.00781 cannot be judged: engine 'mine': at time 0.15625")


AT_ONCE = Scene(
    [Circle(0, 3, vx=1, id="ball")],
    [Wall(0, 0, 1, 0, id="ground"), Wall(-3, 0, -3, 1, id="left"), Wall(3, 0, 3, 1, id="right")],
    gravity=(0, -1),
)


@pytest.mark.parametrize("step", [1 / 64, 1 / 128])
def test_of_two_contacts_at_one_instant_the_one_that_is_met_does_not_stand_for_both(
    step: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It falls through the ground at every step, and bounces off the wall beside it at the same instant."""
    found = only(AT_ONCE, PlantedSteps(step, "ground"), until=12)
    assert found.lawless and found.diagnosis is not None and found.diagnosis.name is CauseName["LAW"]
    judged: list[bool] = []
    gone = other_settings.gone
    monkeypatch.setattr(other_settings, "gone", lambda *asked: judged.append(gone(*asked)) or judged[-1])
    monkeypatch.setattr(budget, "law", lambda lab, rows: [])
    only(AT_ONCE, PlantedSteps(step, "ground"), until=12)
    assert judged and not any(judged)


def test_what_rounding_cannot_have_done_is_not_said_to_be_of_floating_point(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A log flies on past a pocket that captures: a broken law, and no known cause, where that is not seen."""
    walls = [Wall(-7, 0, -7, 1, id="left"), Wall(7, 0, 7, 1, id="right")]
    hole = Pocket(3, "1/2", 1, id="hole")
    scene = Scene([Circle(-3, 0, vx=1, id="a")], walls, pockets=[hole], capture=True)
    rows = [(9.0, "right", 6.0, -1.0), (21.0, "left", -6.0, 1.0), (33.0, "right", 6.0, -1.0)]
    told = [{"time": t, "contacts": [["a", wall]], "states": {"a": [x, 0.0, vx, 0.0]}} for t, wall, x, vx in rows]
    log = tmp_path / "log.jsonl"
    log.write_text("\n".join(map(json.dumps, told)))
    chosen = LogEngine(LogEngine.of(log, scene).recording, lacks=frozenset())
    broken = only(scene, chosen, until=30)
    assert broken.laws is not None and broken.laws.kept is False and broken.laws.counts == {"capture": 2}
    line = verdict_line(compare(scene, [chosen], until=30))
    assert line == f"{broken.engine} does not keep the law, and diverges where the exact run has no event."
    monkeypatch.setattr(residuals, "uncaptured", lambda *_: ())
    found = only(scene, chosen, until=30)
    assert found.laws is not None and found.laws.kept
    assert found.diagnosis is not None and found.diagnosis.name is CauseName["UNKNOWN"]
    assert "by more than rounding" in found.diagnosis.finding
    assert head_phrase(found) == "The histories differ"


@pytest.mark.parametrize("late", [0.0, 1e-9])
def test_of_a_log_without_states_no_velocity_is_compared(late: float, tmp_path: Path) -> None:
    """Its velocities are computed from its times, by the laws: a time that is off moves them, and no outcome."""
    scene = catalogue.build("gas:n=5").with_changes(until=None)
    run = DoubleEngine().run(scene, events=12)
    told = [{"time": float(e.time) + late * (e.index == 3), "contacts": [list(e.impulses[0])]} for e in run.events]
    log = tmp_path / "log.jsonl"
    log.write_text("\n".join(map(json.dumps, told)))
    comparison = compare(scene, [LogEngine.of(log, scene)], events=8)
    found = comparison.candidates[0]
    assert found.alignment.verdict == "agree" and not found.changed
    assert found.outcomes["final_velocities"] != found.expected["final_velocities"] or not late
    phrase = what_now(comparison, found)
    assert "right contacts in the right order" in phrase and "right to the end" not in phrase
    assert "final velocities" not in verdict_sentence(comparison)
