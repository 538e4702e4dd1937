"""The map: ladders, the page in the docs, the picture, and the command."""

from __future__ import annotations

import json
import re
from importlib.metadata import version
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jsonschema
import numpy as np
import pytest
import stress_page
from stress_page import BEGIN, END, TITLE, map_part, rewritten
from stress_page import main as page_main

from truebreak.compare.cli import main
from truebreak.compare.grids import stress_map
from truebreak.compare.grids.row import Row
from truebreak.compare.grids.stress_families import FAMILIES, MapPlace, StressFamily, stress_family
from truebreak.compare.grids.stress_map import Ladder, MapMark, StressJob, StressMap, ladders
from truebreak.compare.grids.stress_map import stress_plan as plan
from truebreak.compare.report.grid_tables import exact_sentence
from truebreak.compare.report.pictures.heat_map import DARK, LIGHT, heat_map
from truebreak.compare.report.schema import schema
from truebreak.scenarios import Scene, SceneError

FULL = plan()


def rows_of(asked: StressMap) -> list[Row]:
    return [row for index in asked.indices() for row in asked.job(index).rows()]


def call(arguments: list[str]) -> int:
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    return int(stop.value.code or 0)


def test_outcomes_are_asked_for_where_they_count_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """An engine that cannot decide has another span: what would be told of its outcomes stands in no row."""
    told, true = list[str](), stress_map.outcomes_changed

    def counted(found: Any, *rest: Any) -> Any:
        told.append(found.run.engine)
        return true(found, *rest)

    monkeypatch.setattr(stress_map, "outcomes_changed", counted)
    place = stress_family("near-ties").place(40)
    exact, double, interval = StressJob(0, place, ("double", "interval")).rows()
    assert (exact.mark, double.mark, interval.mark) == ("right", "wrong", "undecided")
    assert told == ["double"] and double.changed and interval.changed is None


# -- ladders


def ladder(marks: str, first: int = 1) -> Ladder:
    signs = {mark.sign: mark for mark in MapMark}
    levels = tuple(range(first, first + len(marks)))
    return Ladder("near-ties", "left", 0, "double", levels, tuple(signs[sign] for sign in marks))


@pytest.mark.parametrize(
    ("marks", "first_wrong", "right_again", "told"),
    [
        ("....", None, (), "right 1 to 4"),
        ("..XX", 3, (), "right 1 to 2; wrong 3 to 4"),
        ("XXXX", 1, (), "wrong 1 to 4"),
        (".X.X.", 2, (3, 5), "right 1; wrong 2; right 3; wrong 4; right 5"),
        ("..??", None, (), "right 1 to 2; undecided 3 to 4"),
        (".?X~-", 3, (), "right 1; undecided 2; wrong 3; unsettled 4; refused 5"),
        ("!#", None, (), "unchecked 1; failed 2"),
    ],
)
def test_a_ladder_tells_the_first_wrong_and_where_it_does_not_stay(
    marks: str, first_wrong: int | None, right_again: tuple[int, ...], told: str
) -> None:
    one = ladder(marks)
    assert (one.first_wrong, one.right_again, one.summary(), one.signs) == (first_wrong, right_again, told, marks)


def test_ladders_are_lane_by_lane_with_the_exact_engine_first() -> None:
    rows = rows_of(plan(["near-ties"], ["double"], levels="15..16"))
    told = ladders(rows, ["double"])
    assert [(one.side, one.engine, one.signs) for one in told] == [
        ("left", "exact", ".."), ("left", "double", ".X"), ("right", "exact", ".."), ("right", "double", ".X")
    ]  # fmt: skip


def test_a_near_tie_is_lost_where_the_numbers_are_too_far_apart() -> None:
    """The late ball stands at 4 + 10**-k, or at -3 - 10**-k: late as long as that is another number than 4, or -3."""
    rows = rows_of(plan(["near-ties"], ["single", "double"], levels="5..18"))
    found = {(one.side, one.engine): one for one in ladders(rows, ["single", "double"])}
    for side, place in (("left", 4), ("right", 3)):
        for engine, kind in (("single", np.float32), ("double", np.float64)):
            half = float(np.spacing(kind(place))) / 2
            lost = next(k for k in range(1, 40) if 10.0**-k < half)
            assert found[side, engine].summary() == f"right 5 to {lost - 1}; wrong {lost} to 18"


def test_what_is_not_right_is_told_of_the_exact_engine() -> None:
    rows = [Row(0, "s", "exact", mark=mark) for mark in ("right", "wrong", "unchecked", "right")]
    assert exact_sentence(rows).endswith(
        "right at 2 of 4 places, each proved again by the independent checker; 1 wrong, 1 unchecked."
    )


# -- the page in the docs


def told_by(page: str, asked: StressMap) -> list[Ladder]:
    """The ladders that the page's tables tell."""
    part = page.partition(BEGIN)[2].partition(END)[0]
    found: dict[tuple[str, str, str], Ladder] = {}
    for section in part.split("\n### ")[1:]:
        name = section.partition("\n")[0]
        for row in re.findall(r"^\| ([^|]+) \| ([^|]+) \| [^|]+ \| ([^|]+) \|$", section, re.MULTILINE)[1:]:
            if row[0] == "engine":
                continue
            side, _, seed = row[1].partition(", seed ")
            marks: dict[int, MapMark] = {}
            for stretch in row[2].split("; "):
                mark, low, *high = stretch.replace(" to ", " ").split()
                marks |= dict.fromkeys(range(int(low), int((high or [low])[0]) + 1), MapMark(mark))
            found[name, row[1], row[0]] = Ladder(
                name, side, int(seed or 0), row[0], tuple(marks), tuple(marks.values())
            )
    lanes = dict.fromkeys((place.family, place.lane) for place in asked.places)
    return [found[name, lane, engine] for name, lane in lanes for engine in ("exact", *asked.engines)]


@pytest.fixture(scope="module")
def page(root: Path) -> str:
    return (root / "docs" / "stress.md").read_text("utf-8")


@pytest.fixture(scope="module")
def told(page: str) -> list[Ladder]:
    return told_by(page, FULL)


def test_the_page_is_of_the_families_as_they_are_now(page: str, told: list[Ladder]) -> None:
    """Its form, its families, the digest of all their scenes, its engines and every count follow from its tables."""
    made_with = page.partition("\nMade with ")[2].partition(".\n")[0]
    now = map_part(FULL, told).replace(FULL.settings["versions"], made_with)
    assert rewritten(page, now) == page


def test_every_level_of_every_lane_is_on_the_page(told: list[Ladder]) -> None:
    places = [(one.family, one.side, one.seed, k) for one in told if one.engine == "exact" for k in one.levels]
    assert places == [(place.family, place.side, place.seed, place.k) for place in FULL.places]
    assert {one.family for one in told} == set(FAMILIES)


def test_the_picture_is_that_of_the_page(root: Path, told: list[Ladder]) -> None:
    assert (root / "docs" / "stress.svg").read_text("utf-8") == heat_map(FULL.families, told, TITLE)


def test_the_exact_engine_is_right_wherever_the_map_is(told: list[Ladder]) -> None:
    marks = [mark for one in told if one.engine == "exact" for mark in one.marks]
    assert set(marks) == {MapMark.RIGHT}
    assert len(marks) == len(list(FULL.places))


def checked_again(one: StressFamily, told: list[Ladder]) -> list[MapPlace]:
    """The ends of a family's first ladder, and the brink of `double` on its last; nothing that takes long."""
    mine = [x for x in told if x.family == one.name and x.engine == "double"]
    first, last = mine[0], mine[-1]
    cheap = {"crowds": 4, "touching": 3, "moved": 16}.get(one.name, one.last)
    found = [one.place(k, first.side, first.seed) for k in (one.first, cheap)]
    brink = last.first_wrong
    if brink is not None and brink <= cheap:
        found += [one.place(k, last.side, last.seed) for k in (brink - 1, brink) if k >= one.first]
    return list(dict.fromkeys(found))


@pytest.mark.parametrize("name", FAMILIES)
def test_places_are_still_what_the_page_says(name: str, page: str, told: list[Ladder]) -> None:
    """The short map of every test run; an engine of another version than the page's may have turned."""
    for place in checked_again(stress_family(name), told):
        rows = {row.engine: row for row in StressJob(0, place, FULL.engines).rows()}
        for one in told:
            if (one.family, one.side, one.seed) != (place.family, place.side, place.seed):
                continue
            if one.engine.startswith("pymunk") and f"pymunk {version('pymunk')}." not in page:
                continue
            row = rows[one.engine]
            assert row.mark == one.marks[one.levels.index(place.k)].value, row


def test_the_command_that_makes_the_page_writes_both(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = plan(["corners"], ["double"], levels="15..16")
    monkeypatch.setattr(stress_page, "stress_plan", lambda: asked)
    file, store = tmp_path / "p.md", tmp_path / "p.db"
    file.write_text(f"Before.\n{BEGIN}old\n{END}After.\n", "utf-8")
    assert page_main([str(file), "--store", str(store)]) == 0
    text = file.read_text("utf-8")
    assert text.startswith("Before.\n") and text.endswith("After.\n") and "old" not in text
    assert "| double | upper | 16 | right 15; wrong 16 |" in text
    assert (tmp_path / "p.svg").read_text("utf-8").startswith("<svg ")
    before = store.read_bytes()
    assert page_main([str(file), "--store", str(store)]) == 0
    assert (file.read_text("utf-8"), store.read_bytes()) == (text, before)


def test_a_page_without_a_place_for_the_map_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "p.md"
    file.write_text("Nothing.\n", "utf-8")
    assert page_main([str(file)]) == 2
    assert "has no place for the map" in capsys.readouterr().err
    assert page_main([str(tmp_path / "none.md")]) == 2
    assert file.read_text("utf-8") == "Nothing.\n"


# -- the picture


def luminance(colour: str) -> float:
    """Relative luminance, as WCAG 2 defines it."""
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    red, green, blue = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(one: str, other: str) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("colours", [LIGHT, DARK], ids=["light", "dark"])
def test_letters_stand_out_on_light_and_on_dark_pages(colours: dict[str, str]) -> None:
    """4.5 : 1 and more, the least that WCAG 2 allows for small letters."""
    assert {name.removesuffix("-ink") for name in colours} - {"page", "ink", "faint"} == {m.value for m in MapMark}
    for ink in ("ink", "faint"):
        assert contrast(colours[ink], colours["page"]) >= 4.5
    for mark in MapMark:
        assert contrast(colours[f"{mark.value}-ink"], colours[mark.value]) >= 4.5


def test_the_picture_draws_every_stretch_and_names_every_lane() -> None:
    long = "pymunk:max_steps=300000,iterations=128"
    marks = tuple(MapMark)
    mine = [Ladder("near-ties", side, 0, long, tuple(range(1, 8)), marks) for side in ("left", "right")]
    text = heat_map([stress_family("near-ties")], mine, "A <title> & more")
    picture = ElementTree.fromstring(text)
    words = [node.text or "" for node in picture.iter("{http://www.w3.org/2000/svg}text")]
    assert {f"{long}  left", f"{long}  right", "A <title> & more", "wrong at 2"} <= set(words)
    fills = [node.get("fill") for node in picture.iter("{http://www.w3.org/2000/svg}rect")]
    legend = 1
    for mark in MapMark:
        assert fills.count(f"url(#stress-{mark.value})") == legend + 2
    titles = [node.text for node in picture.iter("{http://www.w3.org/2000/svg}title")]
    assert f"{long}  left: {mine[0].summary()}" in titles


# -- the command


def test_json_is_what_its_schema_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    store = str(tmp_path / "map.db")
    arguments = [
        "stress",
        "near-ties",
        "unstable",
        "--engines",
        "single,interval",
        "--short",
        "--store",
        store,
        "--json",
    ]
    assert call(arguments) == 0
    out = capsys.readouterr().out
    data: dict[str, Any] = json.loads(out)
    jsonschema.Draft202012Validator(schema("stress-2")).validate(data)
    assert data["exact"] == {"places": 16, "closed_form": 8, "right": 16}
    assert {row["parameters"]["k"] for row in data["rows"]} == {"1", "14", "27", "40"}
    assert [row["engine"] for row in data["rows"][:3]] == ["exact", "single", "interval"]
    assert call(arguments) == 0
    assert capsys.readouterr().out == out


def test_people_are_told_the_map_the_marks_and_how_to_see_a_place(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = tmp_path / "map.svg"
    assert call(["stress", "near-ties", "--engines", "exact,double", "--levels", "14..17", "--svg", str(picture)]) == 0
    out = capsys.readouterr().out
    assert len(re.findall(r"double +left +16 +\.\.XX", out)) == 1
    assert len(re.findall(r"^ exact", out, re.MULTILINE)) == 2
    assert "The exact engine: right at 8 of 8 places" in out
    assert "truebreak stress near-ties --show 17 --side right > scene.toml" in out
    assert all(mark.meaning in out for mark in MapMark)
    assert ElementTree.parse(picture).getroot().get("role") == "img"


def test_the_list_names_every_family(capsys: pytest.CaptureFixture[str]) -> None:
    assert call(["stress", "--list"]) == 0
    out = capsys.readouterr().out
    assert all(name in out for name in FAMILIES)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["near-tie"], "did you mean 'near-ties'?"),
        (["near-ties", "near-ties"], "named twice"),
        (["near-ties", "--engines", "dobule"], "did you mean 'double'?"),
        (["near-ties", "--engines", "double,double"], "named twice"),
        (["near-ties", "--engines", "exact:max_bits=99"], "checked by a witness; leave it out"),
        (["near-ties", "--engines", "double:x=1"], "has no parameter 'x'"),
        (["near-ties", "--levels", "0..3"], "k = 0: near-ties has k from 1 to 300"),
        (["near-ties", "--levels", "299..301"], "k = 301: near-ties has k from 1 to 300"),
        (["--levels", "20..21"], "k = 20: pi has k from 0 to 8"),
        (["near-ties", "--levels", "5..3"], "the range is empty, as 3 is below 5"),
        (["near-ties", "--levels", "five"], "is not LOW..HIGH"),
        (["near-ties", "--levels", "1..2000"], "at most 1,000"),
        (["near-ties", "--levels", "1..2", "--short"], "keep one of them"),
        (["near-ties", "--show", "301"], "k = 301: near-ties has k from 1 to 300"),
        (["near-ties", "--show", "3", "--side", "up"], "--side 'up': near-ties has none"),
        (["near-ties", "--show", "3", "--seed", "4"], "draws nothing"),
        (["scaled", "--show", "3", "--seed", "4"], "has the seeds 1, 2"),
        (["--show", "3"], "name one family"),
        (["near-ties", "--show", "3", "--engines", "double"], "--show prints one scene and runs nothing"),
        (["near-ties", "--show", "3", "--json"], "--show prints one scene and runs nothing"),
        (["near-ties", "grazes", "--show", "3"], "name one family"),
        (["near-ties", "--side", "left"], "add --show K"),
        (["near-ties", "--store", "/nowhere/map.db"], "no folder"),
        (["near-ties", "--store", "/dev/null"], "is no regular file"),
        (["near-ties", "--svg", "/nowhere/map.svg"], "no folder"),
        (["near-ties", "--jobs", "0"], "--jobs"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(["stress", *arguments]) == 2
    told = capsys.readouterr()
    assert message in told.err
    assert len(told.err.splitlines()) == 1
    assert told.out == ""


def test_a_foreign_file_is_one_line_and_stays(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "notes.txt"
    path.write_text("my notes", "utf-8")
    assert call(["stress", "near-ties", "--store", str(path)]) == 2
    error = capsys.readouterr().err
    assert "is no store of a grid" in error and len(error.splitlines()) == 1
    assert path.read_text("utf-8") == "my notes"


def test_a_family_out_of_its_own_range_is_refused_by_its_scene_too() -> None:
    one = StressFamily(name="own", summary="A.", grows="k", make=lambda k, side, seed: Scene([]), last=2, most=3)
    with pytest.raises(SceneError, match="k = 4: own has k from 1 to 3"):
        one.scene(MapPlace("own", 4, "one"))
