"""The four answers, and the engines and settings that are run for them."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass, replace
from typing import Any

import pytest
from pages import comparison, page

from truebreak.compare import compare, html_report
from truebreak.compare.alternatives import Alternative
from truebreak.compare.causes.diagnosis import Margin
from truebreak.compare.chaos.foreseen import foreseen
from truebreak.compare.cli import main
from truebreak.compare.comparison import Comparison
from truebreak.compare.engines import engine
from truebreak.compare.foreign import LogEngine
from truebreak.compare.picture import instant_of, moment_frames, states_at
from truebreak.compare.report.answers import all_run, answers, right_to, subject, tone, verdict_line, why
from truebreak.compare.report.documents import comparison_json
from truebreak.compare.report.sentences import verdict_sentence
from truebreak.compare.report.terminal import print_comparison
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Scene, StopReason, Trajectory, Wall, catalogue
from truebreak.scenarios.trajectory import Stop

TEXT = re.compile(r"<[^>]*>")


def test_where_names_both_bodies_and_both_times() -> None:
    found = comparison("gas")
    parted = found["pymunk"].alignment.divergence
    assert parted is not None and parted.got_time is not None and parted.expected_time is not None
    told = answers(found).where
    assert told.startswith(f"After {found['pymunk'].alignment.agreed} agreed events pymunk lets {parted.body} hit ")
    assert f"t = {parted.got_time:.6g}; in the exact run {parted.body} hits " in told
    assert told.endswith(f"t = {parted.expected_time:.6g}.")


def test_where_says_one_time_once() -> None:
    """Two times that no ten digits distinguish are one to a reader."""
    found = comparison("near-tie")
    parted, told = subject(found).alignment.divergence, answers(found).where
    assert parted is not None and parted.got_time is not None and parted.expected_time is not None
    assert f"{parted.got_time:.10g}" == f"{parted.expected_time:.10g}"
    assert f", at t = {parted.got_time:.6g}, {subject(found).engine} lets " in told
    assert told.count("at t = ") == 1


def test_a_missing_meeting_is_a_miss_and_a_stop_is_none() -> None:
    assert " miss disc " in answers(comparison("pinball")).where
    stopped = answers(comparison("undecided"))
    assert "it cannot decide what comes next" in stopped.where
    assert "up to there it is right" in stopped.so_what


def test_why_names_the_shares_that_add_up_to_the_shift() -> None:
    found = comparison("thirty")
    candidate = subject(found)
    assert candidate.diagnosis is not None and candidate.diagnosis.displacement is not None
    told = answers(found).why
    large = [e for e in candidate.diagnosis.shares if abs(e.share or 0) >= 0.1]
    assert large
    assert all(e.cause.value in told.lower() for e in large[:3])


@pytest.mark.parametrize(("kind", "words"), [("gas", "It is chaos"), ("near-tie", "")])
def test_chaos_is_said_where_errors_grew(kind: str, words: str) -> None:
    found = comparison(kind)
    candidate = subject(found)
    assert candidate.margin is not None and candidate.alignment.divergence is not None
    grown = (candidate.margin.growth or 0) * candidate.alignment.divergence.expected_event
    assert ("It is chaos" in answers(found).why) == (grown >= 10) == bool(words)
    assert bool(words) or "It is no chaos" in answers(found).why


def test_what_was_run_is_right_as_far_as_a_comparison_finds_it() -> None:
    """Each alternative is run again by hand: it agrees as far as the page says."""
    found = comparison("thirty")
    assert found.alternatives
    for alternative in found.alternatives:
        again = compare(found.scene, [alternative.engine], events=120, causes=False).candidates[0]
        assert again.alignment.agreed == alternative.agreed or alternative.ended
        assert again.alignment.agreed >= alternative.agreed
        assert alternative.right <= again.right


def test_a_finer_step_that_passes_the_divergence_is_run_and_named_as_a_setting() -> None:
    found = compare(catalogue.build("gas"), ["pymunk"], events=40)
    (finer,) = [a for a in found.alternatives if a.steps is not None]
    candidate = found["pymunk"]
    assert engine(finer.engine).step == 2**-8 / (finer.steps or 0)
    assert finer.agreed > candidate.alignment.agreed
    assert finer.cost(candidate) == finer.steps
    assert f"As a setting, {finer.engine} is {right_to(found, finer)}" in answers(found).what_now


def test_the_cheapest_that_is_right_comes_first_and_what_diverges_is_not_called_right() -> None:
    found = comparison("gas")
    slow = replace(found, processor=1e3)
    candidate = slow["pymunk"]
    first = all_run(slow, candidate)
    assert [a.engine for a in first if a.right] == ["double", "exact"]
    assert all(not a.right or a.agreed == len(found.reference.events) for a in first)
    wrong = Alternative("other", "pymunk", 30, right=False)
    assert right_to(found, wrong) == "right to event 29"
    assert right_to(found, replace(wrong, ended=True)) == "right to event 29 (run no further)"
    assert right_to(found, replace(wrong, agreed=0)) == "right in no event"


def test_nothing_is_run_in_place_of_an_engine_that_agrees_or_breaks_a_law() -> None:
    assert compare(catalogue.build("cradle"), ["double"]).alternatives == ()
    assert compare(catalogue.build("near-tie"), ["double"], alternatives=False).alternatives == ()
    assert compare(catalogue.build("near-tie"), ["double"], causes=False).alternatives == ()


def test_the_prediction_is_that_of_the_exact_run() -> None:
    found = compare(catalogue.build("gas"), ["double"], events=200, causes=False)
    told = foreseen(found)
    assert told is not None and told.horizons[0] is not None
    low = told.horizons[0].low.event
    assert f"double is predicted to be right until event {low}" in answers(found, foreseen=told).what_now


def test_the_verdict_is_coloured_as_its_sentence_says() -> None:
    """`cradle` did not change: that one engine could not follow makes no warning of it."""
    found = compare(catalogue.build("cradle"), ["double", "interval"])
    assert found.verdict == "undecided"
    assert verdict_sentence(found).startswith("Floating point did not change what happened")
    assert tone(found) == "agree"
    assert subject(found).engine == "double"
    assert answers(found).where == "Nowhere: double has all 60 events of the exact run."
    assert tone(comparison("undecided")) == tone(comparison("unsettled")) == "undecided"
    assert tone(comparison("gas")) == "diverged"
    assert 'class="verdict agree"' in html_report(found)


def test_a_page_says_no_sentence_twice() -> None:
    """What is folded of other engines apart: they may do the same."""
    for kind in ("gas", "near-tie", "pinball", "rack", "thirty"):
        text = page(kind)
        body = text.partition("<main>")[2].partition("</main>")[0]
        first, *others = body.split('<details class="engine"')
        if others:
            body = first + others[0] + "".join(others[1:]).partition(' id="outcomes"')[2]
        body = re.sub(r"<(svg|script).*?</\1>", "", body, flags=re.S)
        parts = re.split(r"</(?:p|dd|li|td|h2|h3|dt|summary)>", body)
        words = [" ".join(TEXT.sub(" ", part).split()) for part in parts]
        sentences = [s.strip() for text in words for s in re.split(r"(?<=[.;:]) ", text) if len(s.split()) > 6]
        of_each = ("predicted to diverge", "about ")  # said of one engine, and of another too
        sentences = [s for s in sentences if not s.startswith(of_each)]
        assert len(sentences) == len({*sentences}), [s for s in sentences if sentences.count(s) > 1]
        assert verdict_line(comparison(kind)).partition(":")[0] in body


def test_the_moment_is_shown_before_at_and_after_with_the_contact_in_it() -> None:
    """At the moment, the engine's two circles touch; the exact ones do so in the later frame, or not at all."""
    found = comparison("gas")
    candidate = found["pymunk"]
    parted = candidate.alignment.divergence
    assert parted is not None and parted.got is not None
    frames = moment_frames(found.reference, candidate, 1)
    times = [float(frame.caption.partition("t = ")[2]) for frame in frames]
    assert times == sorted(times) and len(set(times)) == 3
    at = instant_of(parted)
    assert times[1] == pytest.approx(at, rel=1e-5)
    places = {str(c.id): k for k, c in enumerate(found.scene.circles)}
    one, other = (states_at(candidate.trajectory, at)[places[name]][:2] for name in (parted.body, parted.got))
    reach = sum(float(found.scene.circles[places[name]].r) for name in (parted.body, parted.got))
    gap = ((one[0] - other[0]) ** 2 + (one[1] - other[1]) ** 2) ** 0.5 - reach
    assert abs(gap) < 0.02 * reach
    for frame in frames:
        assert f">{parted.body}</text>" in frame.picture and f">{parted.got}</text>" in frame.picture


def test_a_gap_too_small_to_be_seen_is_shown_through_a_lens() -> None:
    found = compare(catalogue.build("gas"), ["double"], events=200)
    pictures = [frame.picture for frame in moment_frames(found.reference, found["double"])]
    assert ["lens" in picture for picture in pictures] == [False, True, False]
    margin = found["double"].margin
    assert margin is not None and margin.distance is not None
    wide = replace(margin, distance=(100.0, 100.0))
    pictures = [frame.picture for frame in moment_frames(found.reference, replace(found["double"], margin=wide))]
    assert not any("lens" in picture for picture in pictures)


def test_a_scene_without_events_has_answers() -> None:
    found = compare(Scene([Circle(0, 0)]))
    assert answers(found).where == "Nowhere: nothing happens in this span."


def other_velocities(found: Comparison) -> Comparison:
    """A comparison in which the first engine ends with other velocities than those of rounding."""
    assert found.candidates[0].changed == ()
    return replace(
        found, candidates=(replace(found.candidates[0], changed=("final_velocities",)), *found.candidates[1:])
    )


def test_where_only_an_outcome_changed_what_to_take_for_it_is_said() -> None:
    made = other_velocities(compare(catalogue.build("wedge:slope=2"), ["double", "quad"], events=60))
    assert "an outcome did (final velocities)" in verdict_line(made)
    told = "Nothing to change if who hits whom is all that matters; for final velocities, take quad."
    assert answers(made).what_now == told


def test_where_the_reference_stops_not_knowing_no_engine_is_called_right_to_the_end() -> None:
    """Two marbles that push each other without end: nothing happens, and nothing of it is known."""
    made = compare(catalogue.build("beads"), ["double"])
    found = answers(made)
    assert verdict_line(made) == "Undecided: the exact run itself stopped after 0 events."
    assert found.where == "The exact run itself stops before its first event."
    assert "collapse: b1 and b2" in found.why and found.what_now == "Raise the restitution, or leave a gap."
    assert found.command == "truebreak run beads" and "open" in found.so_what
    made = compare(catalogue.build("gas"), ["double"], reference="interval", events=100)
    found, events = answers(made), len(made.reference.events)
    assert 0 < events < 100 and made["double"].verdict == "agree"
    assert f"The interval run itself stops after {events} events" in found.where and "double agrees" in found.where
    assert "right to the end" not in found.what_now and found.command.endswith(f"--engines double --events {events}")


def test_infinitely_many_bounces_that_all_agree_are_agreement() -> None:
    made = compare(catalogue.build("bounce"), ["double", "single", "quad"])
    assert made.verdict == "agree"
    assert "right to the end" in answers(made).what_now


@dataclass(frozen=True)
class RestsEarly(DoubleEngine):
    """Says that its last circle came to rest, an event before its limit."""

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        ran = super().run(scene, events=100, **{key: value for key, value in limits.items() if key != "events"})
        events, stop = tuple(ran.events[:60]), Stop(StopReason.REST, "at rest: ball on floor")
        return replace(ran, events=events, stop=stop, final_time=events[-1].time, ending=None)


def test_a_run_that_nothing_lets_go_on_is_not_to_be_run_further() -> None:
    made = compare(catalogue.build("bounce"), [RestsEarly()])
    found = answers(made)
    assert made.verdict == "unsettled"
    assert "record it" not in verdict_line(made)
    assert "further" in found.what_now


@pytest.mark.parametrize("name", ["stadium", "lemon", "gas", "ghost", "corner", "bounce"])
def test_the_command_to_copy_runs(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    command = answers(compare(catalogue.build(name), ["double"])).command
    with pytest.raises(SystemExit) as stop:
        main(shlex.split(command)[1:])
    assert stop.value.code in (None, 0, 1), capsys.readouterr().err


def test_growth_is_measured_only_where_it_can_be() -> None:
    """Of an engine that agrees: beside walls that move, or where a hit is a graze, coarser numbers are run instead."""
    for scene, wanted in [
        (closing("1"), "truebreak compare closing.toml --engines single"),
        (catalogue.build("ghost"), "truebreak compare ghost --engines single --until 35"),
        (catalogue.build("bounce"), "truebreak chaos bounce --engines double"),
    ]:
        found = answers(compare(scene, ["double"], until=10 if scene.moving_walls else None))
        assert (found.command, found.read.removeprefix("docs/")) == (
            wanted,
            "chaos.md" if " chaos " in wanted else "engines.md",
        )


@pytest.mark.parametrize(
    ("name", "engine", "said"),
    [
        ("drop-pair", "double", "an event, which is chaos; a longer run may diverge."),  # agrees
        ("drop-pair", "pymunk", "an event, which is chaos."),  # diverges, of a cause that is not looked for
        ("galperin", "double", "an event, which is chaos."),  # agrees; nothing comes after it
        ("wedge", "double", "It is not chaos: errors hardly grow on the way."),  # free flight alone gains 7 bits
        (
            "ghost",
            "double",
            "chaos is not known: before event 0, disc and s1 graze: nearby they hit or miss.",
        ),
        ("closing-wall", "double", "It is not chaos: errors hardly grow on the way."),
    ],
)
def test_whether_errors_grow_is_said_on_a_page_without_an_account(name: str, engine: str, said: str) -> None:
    found = compare(catalogue.build(name), [engine], causes=False)
    assert answers(found, foreseen=foreseen(found)).why.endswith(said)


def test_one_event_is_one() -> None:
    found = answers(compare(catalogue.build("ghost"), ["double"]))
    assert found.where == "Nowhere: double has the one event of the exact run."


def closing(e: str) -> Scene:
    """A disc between a wall that stands and one that comes, which leave no room at 8."""
    walls = [Wall(-5, 0, -5, 1, id="still"), Wall(5, 0, 5, 1, id="piston", vx=-1)]
    walls += [Wall(0, -2, 1, -2, id="low"), Wall(0, 2, 1, 2, id="high")]
    return Scene([Circle(0, "1/3", vx=2, vy="1/7", id="ball")], walls, restitution=e, name="closing")


@pytest.mark.parametrize("e", ["1", "1/2"])
def test_a_circle_that_both_runs_see_crushed_is_agreement_and_how_it_ends_is_said(e: str) -> None:
    """The engine's last bounce before it may be an ulp before the exact one: what comes is bounces alone, until 8."""
    found = compare(closing(e), ["double"], until=10)
    assert found.verdict == "agree"
    assert answers(found).where.endswith(
        "It ends there, crushed: two walls that close leave no room for a circle (ball between still and piston at 8)."
    )


@pytest.mark.parametrize("engine", ["double", "single", "quad"])
def test_a_circle_at_rest_in_both_runs_is_agreement(engine: str) -> None:
    """Whichever clock says a little earlier that it is."""
    rest = Scene([Circle(0, 5, id="ball")], [Wall(0, 0, 1, 0, id="floor")], gravity=(0, -10), restitution=0)
    assert compare(rest, [engine], until=10).verdict == "agree"


def test_how_the_motion_ends_is_said_under_the_verdict() -> None:
    found = compare(catalogue.build("bounce"), ["double"])
    told = "It ends there: infinitely many collisions in finite time (ball and floor by 19)."
    assert answers(found).where == f"Nowhere: double has all 133 events of the exact run. {told}"
    rest = Scene([Circle(0, 5, id="ball")], [Wall(0, 0, 1, 0, id="floor")], gravity=(0, -10), restitution=0)
    told = answers(compare(rest, ["double"], until=10)).where
    assert told.endswith("there, at rest: a circle stands on what gravity pulls it to (ball and floor).")


@pytest.mark.parametrize(
    ("mine", "exact", "said"),
    [(1.0, 1.1, "takes about its time"), (1.0, 2.2, "about 2 times its time"), (1.0, 0.5, "about 0.5 times its time")],
)
def test_what_the_exact_run_takes_is_said_to_one_digit(mine: float, exact: float, said: str) -> None:
    found = compare(catalogue.build("ghost"), ["double"])
    found = replace(found, processor=exact, candidates=(replace(found.candidates[0], processor=mine),))
    assert said in answers(found).what_now


def test_an_engine_that_cannot_run_a_scene_has_no_error_and_no_prediction(capsys: pytest.CaptureFixture[str]) -> None:
    found = compare(catalogue.build("stadium"), ["double", "pymunk"], events=60, causes=False)
    assert found["pymunk"].unable
    text = TEXT.sub(" ", html_report(found))
    assert re.search(r"pymunk\s*:\s*cannot run this scene", text)
    assert not re.search(r"pymunk\s*:\s*predicted", text)
    print_comparison(found)
    row = next(line for line in capsys.readouterr().out.splitlines() if line.strip().startswith("pymunk"))
    assert row.split() == ["pymunk", "undecided", "-", "0"]  # agreed events, and no position error


def test_a_page_says_what_acts_in_its_world() -> None:
    found = compare(closing("1/2"), ["double"], until=10)
    assert "1 circle, 4 walls; restitution 1/2, 1 wall that moves" in html_report(found)
    found = compare(catalogue.build("stadium"), ["double"], events=5)
    assert "1 circle, 2 segments, 2 arcs<" in html_report(found)


def test_the_json_has_what_the_page_says_was_run_in_its_place() -> None:
    """The cheapest that is right first; of an engine that agrees nothing."""
    found = comparison("gas")
    told = {row["engine"]: row["alternatives"] for row in comparison_json(found)["candidates"]}
    for candidate in found.candidates:
        runs = [] if candidate.right else all_run(found, candidate)
        rows = told[candidate.engine]
        assert [(row["engine"], row["events_agreed"], row["right"]) for row in rows] == [
            (run.engine, run.agreed, run.right) for run in runs
        ]
        assert [row["cost"] for row in rows] == [run.cost(candidate) for run in runs]
        assert all((row["cost"] is None) == (row["cost_in"] is None) for row in rows)
    assert "time steps" in {row["cost_in"] for row in told["pymunk"]}


@pytest.mark.parametrize(
    ("growth", "error", "gap", "said"),
    [
        (0.01, 1e-9, None, "It is no chaos: errors hardly grow on the way."),
        (0.1, 1e-9, None, "It is on the way to chaos: errors grow by 5 bits on the way."),
        (0.5, 1e-9, None, "It is chaos: errors grow by 0.5 bits an event."),
        (0.5, 1e-9, (0.0, 0.0), "It takes no chaos: any error, however small, decides it."),
        (None, 1e-9, None, "Whether errors grow on the way is not known."),
    ],
)
def test_whether_it_is_chaos_is_said_of_every_divergence(
    growth: float | None, error: float, gap: tuple[float, float] | None, said: str
) -> None:
    found = comparison("gas")
    candidate = found["pymunk"]
    parted = candidate.alignment.divergence
    assert parted is not None
    fifty = replace(candidate.alignment, divergence=replace(parted, own_event=50))
    margin = Margin(gap=gap, growth=growth, error=error)
    assert why(found, replace(candidate, alignment=fifty, margin=margin)).endswith(said)


def test_an_engine_that_diverges_before_its_prediction_is_not_promised_to_be_right() -> None:
    found = compare(catalogue.build("gas"), ["double"], events=200, causes=False)
    told, parted = foreseen(found), found.candidates[0].alignment.divergence
    assert told is not None and told.horizons[0] is not None and parted is not None
    low = told.horizons[0].low.event
    early = replace(found.candidates[0].alignment, divergence=replace(parted, event=3))
    changed = replace(found, candidates=(replace(found.candidates[0], alignment=early),))
    assert answers(changed, foreseen=told).what_now.endswith(
        f"double was predicted to be right until event {low}, and diverged before that."
    )


def test_velocities_that_differ_late_are_given_to_the_digit_that_differs() -> None:
    found = answers(other_velocities(compare(catalogue.build("pinball-table"), ["double"]))).so_what
    one, other = re.findall(r"\([^)]*\)", found)[:2]
    assert "instead of" in found and one != other


def test_a_divergence_beyond_the_last_event_is_said_to_be_after_it() -> None:
    scene = Scene([Circle(0, 0, vx=1, id="a"), Circle(4, 0, id="b")], [Wall(9, 0, 9, 1, id="w")])
    log = LogEngine.of([(2.0, "a", "b"), (6.0, "b", "w"), (10.0, "a", "b"), (12.0, "a", "b")], scene)
    assert verdict_line(compare(scene, [log])).endswith("diverges after the last of 3.")
