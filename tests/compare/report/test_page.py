"""The page as text: one file without resources, its data, its downloads, its tables."""

from __future__ import annotations

import csv
import io
import json
import re
import struct
from itertools import pairwise
from pathlib import Path
from shutil import which
from subprocess import run as run_program

import jsonschema
import pytest
from browser import LABEL, shown_digest
from command_line import done
from pages import COMMAND, PAGES, comparison, page
from tags import saved, tags

from truebreak.compare import compare, html_report
from truebreak.compare.chaos.certified_chaos import chaos
from truebreak.compare.chaos.foreseen import foreseen
from truebreak.compare.picture import states_at
from truebreak.compare.report import page as page_provenance
from truebreak.compare.report.chaos_page import chaos_html
from truebreak.compare.report.documents import comparison_json
from truebreak.compare.report.html import SAME, UNTOLD, changed, kept, settled, value_text
from truebreak.compare.report.page import events_csv, provenance, whole_name
from truebreak.compare.report.player import JUMP, MOST_EVENTS, recording
from truebreak.compare.report.schema import schema
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Pocket, Scene, SceneError, StopReason, Wall, catalogue
from truebreak.scenarios.files import loads_toml


@pytest.mark.parametrize("kind", PAGES)
def test_a_page_is_one_file_without_resources(kind: str) -> None:
    text = page(kind)
    found = tags(text)
    assert found.open == []
    assert found.resources == []
    assert found.within <= found.places
    assert not re.search(r"@import|url\(|https?://(?!www\.w3\.org/2000/svg)", text)
    assert len(text.encode()) < 1_000_000


def test_a_break_of_sixteen_balls_with_three_hundred_events_stays_under_a_megabyte() -> None:
    found = comparison("break")
    assert (len(found.scene.circles), len(found.reference.events)) == (16, 300)
    assert len(page("break").encode()) < 1_000_000


@pytest.mark.slow
def test_so_it_does_with_causes_and_all_permitted_patterns() -> None:
    found = compare(catalogue.build("rack:rows=5"), ["double", "pymunk"], events=300)
    text = html_report(found)
    assert "What the physics permits" in text
    assert len(text.encode()) < 1_000_000


def test_the_horizon_stands_in_the_plot_as_a_band_and_beside_it_in_words() -> None:
    """The band is that of `truebreak chaos`, which knows nothing of the comparison."""
    found = compare(catalogue.build("gas"), ["double", "exact"], events=200, causes=False)
    (alone,) = chaos(catalogue.build("gas"), ["double"], events=200, run=False).horizons
    told = foreseen(found)
    assert told is not None
    assert told.horizons[1] is None
    assert told.horizons[0] is not None
    assert (told.horizons[0].low, told.horizons[0].high) == (alone.low, alone.high)
    text = html_report(found)
    assert text.count('<rect class="horizon e0"') == 2
    assert f"predicted to diverge between event {alone.low.event} and {alone.high.event}" in text


def test_nothing_is_foreseen_beyond_a_tie_or_without_an_exact_reference() -> None:
    told = foreseen(comparison("rack"))
    assert told is not None
    assert (told.events, told.horizons) == (0, (None, None))
    assert 'class="horizon' not in page("rack")
    assert f"Nothing is predicted: {told.reason}." in page("rack")
    assert foreseen(compare(catalogue.build("gas"), ["single"], events=20, reference="double")) is None


def test_pages_of_chaos_and_of_orders_carry_their_results() -> None:
    for kind, name in (("chaos", "chaos-2"), ("orders", "orders-2"), ("some-orders", "orders-2")):
        data = json.loads(saved(page(kind), f"{name.partition('-')[0]}.json"))
        jsonschema.validate(data, schema(name))
        assert loads_toml(saved(page(kind), ".toml")).digest == data["scene"]["digest"]
    rows = list(csv.reader(io.StringIO(saved(page("two-orders"), "events.csv"))))
    assert {row[0] for row in rows[1:]} == {"0", "1"}
    told = json.loads(saved(page("two-orders"), "orders.json"))
    for number, outcome in enumerate(told["outcomes"]):
        listed = [row[3:] for row in rows if row[0] == str(number)]
        assert listed == [pair for event in outcome["impulses"] for pair in event]


def test_outcomes_part_where_their_impulses_first_differ() -> None:
    data = json.loads(tags(page("two-orders")).scripts["recording"])
    (other,) = data["runs"][1:]
    assert other["divergence"] == {"time": 1.0, "expected": 0, "got": 0, "bodies": [0, 1, 2], "walls": []}
    assert "There are more" in page("some-orders")
    assert "recording" not in tags(page("one-order")).scripts


def test_names_in_a_scene_end_no_script_and_make_no_tags() -> None:
    found = tags(page("hostile"))
    data = json.loads(found.scripts["recording"])
    assert data["bodies"][0][0] == "<b>&</script>"
    assert "alert(1)" not in "".join(found.scripts.values())
    assert "i" not in found.open


def test_the_scene_is_saved_whole() -> None:
    for kind in ("gas", "rack", "hostile"):
        text = saved(page(kind), "comparison.json")
        told = comparison_json(comparison(kind))
        for part in (told["reference"], *told["candidates"]):
            assert part.pop("seconds") > 0
        assert json.loads(text) == json.loads(json.dumps(told))
        jsonschema.validate(json.loads(text), schema("comparison-5"))
        again = loads_toml(saved(page(kind), ".toml"))
        assert again.digest == comparison(kind).scene.digest


def test_events_are_saved_one_line_an_impulse() -> None:
    found = comparison("gas")
    rows = list(csv.reader(io.StringIO(saved(page("gas"), "events.csv"))))
    assert rows[0] == ["engine", "event", "time", "first", "second"]
    exact = [row for row in rows if row[0] == "exact"]
    assert len(exact) == found.reference.collisions
    assert [float(row[2]) for row in exact] == [float(event.time) for event in found.reference.events]
    assert {row[0] for row in rows[1:]} == {"exact", "double", "pymunk", "interval:bits=30"}
    assert events_csv(found) == saved(page("gas"), "events.csv")


def test_the_provenance_names_what_counted() -> None:
    told = provenance(comparison("gas"), COMMAND)
    assert told.command == COMMAND
    (shown,) = re.findall(r'<pre id="command">(.*?)</pre>', page("gas"))
    assert re.sub(r"</?span[^>]*>", "", shown) == COMMAND
    assert told.scene.startswith("gas:n=10,seed=1")
    assert {"truebreak", "Python", "python-flint", "FLINT", "pymunk", "Chipmunk", "machine"} <= dict(
        told.versions
    ).keys()
    assert "iterations" in dict(told.engines)["pymunk"]
    assert told.digest == catalogue.build(told.scene).digest


def test_the_day_can_be_set(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    assert provenance(comparison("quiet")).written == "1970-01-02"


def test_a_page_can_be_made_again_letter_for_letter(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    scene = catalogue.build("gas:n=3")
    one, other = (html_report(compare(scene, ["double", "pymunk"], events=12)) for _ in range(2))
    assert one == other
    first, second = (chaos_html(chaos(scene, ["single"], events=20)) for _ in range(2))
    assert first == second


def test_a_comparison_from_python_has_a_command_too() -> None:
    assert provenance(comparison("gas")).command == (
        "truebreak compare gas.toml --engines double,pymunk,interval:bits=30 --reference exact --events 40"
    )


def test_commands_name_the_file_that_the_page_saves(monkeypatch: pytest.MonkeyPatch) -> None:
    """A scene too large for TOML is saved as JSON."""

    def refused(scene: Scene) -> str:
        raise SceneError(f"{scene.name}: too large")

    monkeypatch.setattr(page_provenance, "dump_toml", refused)
    found = comparison("near-tie")
    told = provenance(found)
    assert told.files[0].name == "near-tie-k-40.json"
    assert told.command.startswith("truebreak compare near-tie-k-40.json ")
    shorter = page_provenance.minimise_command(found, found.candidates[0])
    assert shorter is not None and shorter.startswith("truebreak minimise near-tie-k-40.json ")


def test_a_long_file_is_carried_compressed_and_one_too_long_for_that_is_told_how_to_get(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = comparison("gas")
    monkeypatch.setattr(page_provenance, "MOST_BYTES", 2000)
    told = {file.name: file for file in provenance(found).files}
    assert set(told) == {"gas.toml", "gas-comparison.json", "gas-events.csv.gz"}
    assert told["gas-comparison.json"].address == ""
    assert told["gas-comparison.json"].remedy.endswith("bytes, too many for a page: the command above, with --json")
    text = html_report(found)
    assert saved(text, "events.csv.gz") == events_csv(found)
    assert text == html_report(found)


def test_the_certificate_saved_from_a_page_is_verified(tmp_path: Path) -> None:
    on_page, alone = tmp_path / "page.html", tmp_path / "lee.json"
    assert done("compare", "lee", "--engines", "double", "--certify", "--html", str(on_page)).returncode == 0
    alone.write_text(saved(on_page.read_text(), "certificate.json"))
    told = done("verify", str(alone))
    assert told.returncode == 0, told.stdout + told.stderr


def test_a_changed_scene_is_not_told_as_the_catalogue_has_it() -> None:
    assert whole_name(catalogue.build("gas").with_changes(tie_policy="sequential:order=scene")) == "gas"


def test_only_changed_values_are_shown() -> None:
    found = changed(comparison("gas"))
    assert "final velocities" in [outcome.name for outcome in found]
    for outcome in found:
        for row in outcome.rows:
            assert any(cell not in (SAME, UNTOLD) for cell in row.got)
            assert row.expected not in row.got
            assert row.got[2] == UNTOLD
    names = {name for name, _ in kept(comparison("gas"))}
    assert names.isdisjoint(outcome.name for outcome in found)


@pytest.mark.parametrize("kind", ["rack", "gas", "galperin", "thirty"])
def test_an_engine_that_agrees_changed_nothing(kind: str) -> None:
    """Rounding of a velocity that is exactly 0 is none of an outcome, in no cell."""
    found = comparison(kind)
    for outcome in changed(found):
        for number, candidate in enumerate(found.candidates):
            told = any(row.got[number] not in (SAME, UNTOLD) for row in outcome.rows)
            assert told == (settled(candidate) and outcome.name.replace(" ", "_") in candidate.changed)
            assert told or candidate.engine not in outcome.summary


def test_values_are_told_in_words() -> None:
    assert value_text({"line": "y = 0", "kept": True, "lost_at": None}) == "line y = 0; kept yes; lost at none"


@pytest.mark.parametrize("kind", ["gas", "rack", "near-tie", "reversal", "galperin"])
def test_a_recording_is_the_motion(kind: str) -> None:
    """Straight flight from the knots is where the run has each circle, between any two events.

    Not so where the instant of an event is an interval: within it, the engine's own state holds both flights.
    """
    found = comparison(kind)
    data = recording(found)
    assert data is not None
    runs = [found.reference, *(c.trajectory for c in found.candidates)]
    for told, run in zip(data["runs"], runs, strict=True):
        if run.engine == "interval":
            continue
        times = [*told["times"], told["end"]]
        for a, b in pairwise(times):
            middle = a + 0.625 * (b - a)
            if not a < middle < min(b, float(run.final_time)):
                continue
            state = run.sample([middle])[0]
            for body, row in enumerate(state):
                k, _, x, y, vx, vy = [
                    knot for knot in told["knots"] if knot[1] == body and told["times"][knot[0]] <= middle
                ][-1]
                flown = middle - told["times"][k]
                assert abs(x + vx * flown - row[0]) <= 2 * JUMP * data["view"][2]
                assert abs(y + vy * flown - row[1]) <= 2 * JUMP * data["view"][3]
        assert [event[0] for event in told["events"]] == list(range(len(told["events"])))


def test_what_is_fixed_does_not_fall_in_a_recording() -> None:
    """One knot is enough for a peg under gravity, however many events there are."""
    found = compare(catalogue.build("peg-mirror"), ["double"], events=20, causes=False)
    data = recording(found)
    assert data is not None and data["gravity"] != [0.0, 0.0]
    fixed = {k for k, (_, _, pinned) in enumerate(data["bodies"]) if pinned}
    assert fixed
    for run in data["runs"]:
        knots = [knot for knot in run["knots"] if knot[1] in fixed]
        assert [knot[1] for knot in knots] == sorted(fixed)
        assert all(knot[4:] == [0.0, 0.0] for knot in knots)


HOLE = Scene(
    [Circle(0, 8, "1/4", vx="1/2", id="a"), Circle(5, 3, "1/4", vx=-1, vy=6, id="b")],
    [Wall(0, 0, 1, 0, id="floor"), Wall(9, 0, 9, 1, id="right"), Wall(-9, 0, -9, 1, id="left")],
    pockets=[Pocket(2, 3, 1, id="hole")],
    capture=True,
    gravity=(0, -10),
)

MOTION = """
const data = JSON.parse(require("fs").readFileSync(0, "utf-8"));
const told = data.runs.map((run, k) => {
  const motion = new Motion(run, data.bodies, data.gravity);
  return data.times[k].map((time) => data.bodies.map((_, body) => motion.at(body, time)));
});
console.log(JSON.stringify(told));
"""


@pytest.mark.skipif(which("node") is None, reason="node is not at hand")
@pytest.mark.parametrize("scene", [catalogue.build("landing"), catalogue.build("struck"), HOLE], ids=lambda s: s.name)
def test_a_page_shows_what_is_carried_or_out_of_play_where_the_run_has_it(scene: Scene) -> None:
    """What had settled was shown as if it fell through the floor and rose again, from one event to the next."""
    found = compare(scene, ["double", "single", "quad", "interval"], until=4, causes=False)
    data = recording(found)
    assert data is not None
    runs = [found.reference, *(c.trajectory for c in found.candidates)]
    ends = [min(told["end"], float(run.final_time)) for told, run in zip(data["runs"], runs, strict=True)]
    data["times"] = [[end * (k + 0.37) / 40 for k in range(40)] for end in ends]
    script = (Path(page_provenance.__file__).parent / "templates" / "stage.js").read_text("utf-8") + MOTION
    shown = run_program(["node", "-e", script], input=json.dumps(data), capture_output=True, text=True, check=True)
    for run, times, rows, told in zip(runs, data["times"], json.loads(shown.stdout), data["runs"], strict=True):
        assert told["still"], run.engine
        for time, row in zip(times, rows, strict=True):
            for (x, y, *_), state in zip(row, run.sample([time])[0], strict=True):
                assert (x, y) == pytest.approx((state[0], state[1]), abs=1e-5), (run.engine, time)


def test_after_the_last_event_what_stands_is_drawn_where_it_stands() -> None:
    """What a pocket has taken, and what is fixed, was drawn as if it fell on."""
    peg = Circle(-5, 1, "1/2", m="oo", id="peg")
    run = ExactEngine().run(HOLE.with_changes(circles=[*HOLE.circles, peg]))
    assert run.stop.reason is StopReason.QUIET
    assert len(run.pocketings) == 2
    for now, last in zip(states_at(run, float(run.final_time) + 3), run.final.rows(), strict=True):
        assert now == pytest.approx(last)


def test_a_recording_of_a_long_run_is_about_the_divergence() -> None:
    found = compare(catalogue.build("galperin:n=3"), ["double", "pymunk"], causes=False)
    data = recording(found)
    assert data is not None
    assert len(found.reference.events) > MOST_EVENTS
    assert sum(len(run["events"]) for run in data["runs"]) <= MOST_EVENTS
    times = [c.alignment.divergence.time for c in found.candidates if c.alignment.divergence]
    assert data["begin"] < min(times) < data["end"]


def test_where_nothing_is_left_to_happen_circles_fly_on() -> None:
    found = comparison("galperin")
    data = recording(found)
    assert data is not None
    final = float(found.reference.final_time)
    assert data["end"] > 1.2 * final
    for told, run in zip(data["runs"], (found.reference, found["double"].trajectory), strict=False):
        assert told["end"] == data["end"]
        last = {knot[1]: knot for knot in told["knots"]}
        for body, circle in enumerate(run.final.circles):
            assert last[body][4] == pytest.approx(float(circle.vx), rel=1e-7)


def test_where_nothing_can_be_played_there_is_no_player() -> None:
    text = html_report(compare(Scene([Circle(0, 0)]), ["double"]))
    assert ('id="player"' in text) == ('id="recording"' in text)


def test_the_picture_of_the_readme_is_that_of_the_page_made_now(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`make picture` says how large it is, and so it is; what the page shows first is what it was made of."""
    recipe = (root / "Makefile").read_text("utf-8").partition("\npicture:")[2].partition("\n\n")[0]
    found = re.search(r"tests/compare/report/browser\.py report\.html docs/report\.png (\d+) (\d+)", recipe)
    assert found is not None
    assert "SOURCE_DATE_EPOCH=0 " in recipe
    picture = (root / "docs" / "report.png").read_bytes()
    assert picture.startswith(b"\x89PNG")
    assert struct.unpack(">II", picture[16:24]) == tuple(map(int, found.groups()))
    assert "docs/report.png" in (root / "README.md").read_text("utf-8")
    assert "make picture" in (root / "docs" / "index.md").read_text("utf-8")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    now = shown_digest(html_report(compare(catalogue.build("gas"))))
    assert picture.partition(LABEL)[2][:64].decode() == now, "make picture"


def test_a_matched_event_past_the_end_by_rounding_is_in_the_list() -> None:
    data = recording(compare(catalogue.build("wedge"), ["double"]))
    assert data is not None
    truth, run = data["runs"]
    assert run["events"][-1][1] > truth["end"], "the last hit comes a rounding later in doubles"
    assert run["matches"] == [event[0] for event in truth["events"]]
    assert [event[0] for event in run["events"]] == run["matches"]


def test_an_engine_that_cannot_run_is_not_predicted_and_enclosures_are_never_wrong() -> None:
    """A reader was told until when pymunk, which cannot run the scene, would be right, and was sent to --bits."""
    told = compare(catalogue.build("stadium"), ["interval", "pymunk"], events=20)
    page = html_report(told)
    assert "pymunk is predicted" not in page
    assert "interval is predicted to be right" not in page
    assert "interval is predicted to be able to decide until event" in page
    assert "--engines pymunk --bits" not in page
    assert "--engines interval --bits" in page


def test_a_motion_that_ends_by_itself_is_told_whole() -> None:
    """It ends a rounding earlier in doubles: the engine went to the end all the same."""
    found = compare(catalogue.build("closing-wall"), ["double"])
    assert [c.whole for c in found.candidates] == [True]
    assert "No engine went to the end" not in html_report(found)
