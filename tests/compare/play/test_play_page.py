"""The page in a real browser: drawn in, run, linked to, undone, by mouse, finger and keys."""

from __future__ import annotations

import base64
import json
import re
import zlib
from pathlib import Path
from typing import Any

import pytest
from browser import found
from playing import PagePlayed

from truebreak.compare import compare
from truebreak.compare.certificate.certified import certified
from truebreak.compare.play.play_server import PlayServer
from truebreak.compare.report.answers import answers, verdict_line
from truebreak.exact import ExactEngine
from truebreak.scenarios import Arc, Circle, Polygon, Scene, Segment, Wall, catalogue
from truebreak.scenarios.files import loads_toml

pytestmark = pytest.mark.skipif(found() is None, reason="no chromium here: apt-get install chromium")

AXE = Path(__file__).resolve().parent.parent / "report" / "node_modules" / "axe-core" / "axe.min.js"


def packed(rows: object) -> str:
    """What stands in an address for an object."""
    made = zlib.compressobj(9, zlib.DEFLATED, -15)
    data = made.compress(json.dumps(rows).encode()) + made.flush()
    return "s=" + base64.urlsafe_b64encode(data).decode().rstrip("=")


def opened(page: PagePlayed) -> Any:
    """The object in the page's address."""
    page.browser.ask("new Promise((done) => setTimeout(done, 150))")  # it is written when the packing is done
    letters = page.wait("location.hash.startsWith('#s=') && location.hash").removeprefix("#s=")
    return json.loads(zlib.decompress(base64.urlsafe_b64decode(letters + "=" * (-len(letters) % 4)), -15))


def test_a_picture_is_picked_run_and_explained(page: PagePlayed) -> None:
    page.browser.ask("[...document.querySelectorAll('#pictures button')].find((b) => b.textContent === 'gas').click()")
    true = compare(catalogue.build("gas"), ["double"], events=300, alternatives=False)
    assert page.run() == verdict_line(true)
    assert "every decision proved" in page.text("exactness")
    divergence = true["double"].alignment.divergence
    assert divergence is not None
    page.press("jump")
    assert float(page.browser.ask("document.getElementById('scrubber').value")) == pytest.approx(divergence.time)
    assert "The first divergence" in page.text("told")
    assert page.browser.ask("document.querySelectorAll('#list li.first').length") == 1
    page.press("why")
    words = page.wait("[...document.querySelectorAll('#answers dd')].map((e) => e.firstChild.textContent)")
    told = answers(true)
    assert words[:2] == [told.where, told.why]
    assert page.browser.messages == []
    assert all(url.startswith(page.address.partition("#")[0]) for url in page.browser.requests if url[:4] == "http")


def test_runs_stand_side_by_side_and_digits_go(page: PagePlayed) -> None:
    page.run()
    counts = []
    for time in (0, 60, 120):
        page.browser.ask(f"seek({time})")
        counts.append(page.text("digits"))
    assert counts[0] == "all" or float(counts[0]) > 14
    assert float(counts[1]) > float(counts[2]) > 0
    first = page.browser.ask(PIXELS)
    page.browser.ask("seek(60)")
    assert page.browser.ask(PIXELS) != first


PIXELS = "['pane-truth', 'pane-engine'].map((name) => document.getElementById(name).toDataURL()).join()"


def test_another_run_takes_the_place_of_the_first(page: PagePlayed) -> None:
    page.run()
    before = page.browser.ask("data.runs[0].events.length")
    page.value("events", "7")
    page.run()
    assert (before, page.browser.ask("data.runs[0].events.length")) == (300, 7)
    assert page.browser.ask("document.querySelectorAll('#list li').length") in range(7, 9)


def test_it_plays_where_motion_is_wanted(page: PagePlayed) -> None:
    page.browser.media()
    page.run()
    page.wait("Number(document.getElementById('scrubber').value) > data.begin")
    page.press("play")
    assert page.text("play") == "Play"


def view(page: PagePlayed) -> tuple[float, float, float, float]:
    """What the editor shows: the scene of the page's own, with its room."""
    del page
    left, right, bottom, top = -9.0, 9.0, -5.0, 5.0
    room = 0.12 * 18 + 1e-9
    return left - room, bottom - room, right - left + 2 * room, top - bottom + 2 * room


def test_a_disc_is_dragged_sized_and_thrown(page: PagePlayed) -> None:
    shown = view(page)
    page.drag(page.place(3, 0.5, shown), page.place(5, 2, shown))
    moved = page.thing("b")
    assert float(moved["x"]) == pytest.approx(5, abs=0.1) and float(moved["y"]) == pytest.approx(2, abs=0.1)
    edge = float(moved["x"]) + 0.5**0.5, float(moved["y"]) - 0.5**0.5
    page.drag(page.place(*edge, shown), page.place(edge[0] + 0.5, edge[1] - 0.5, shown))
    assert float(page.thing("b")["r"]) == pytest.approx(1 + 0.5**0.5, abs=0.1)
    assert page.thing("a")["vx"] == "2"
    page.drag(page.place(-3, 0.3, shown), page.place(-5, 3, shown))
    thrown = page.thing("a")
    assert float(thrown["vx"]) == pytest.approx(0, abs=0.1) and float(thrown["vy"]) == pytest.approx(3, abs=0.1)
    rows = opened(page)
    assert [row[:6] for row in rows["c"] if row[0] == "a"] == [["a", "-5", "0", "1", thrown["vx"], thrown["vy"]]]


def test_a_wall_is_dragged_by_its_end(page: PagePlayed) -> None:
    shown = view(page)
    page.thing("left")
    page.drag(page.place(-9, 1, shown), page.place(-8, 2, shown))
    wall = page.thing("left")
    assert (wall["x0"], wall["y0"]) == ("-9", "0")
    assert float(wall["x1"]) == pytest.approx(-8, abs=0.1) and float(wall["y1"]) == pytest.approx(2, abs=0.1)


def test_a_wall_is_thrown_and_runs_as_it_moves(page: PagePlayed) -> None:
    """By the end of its arrow, by keys, and in numbers; a link keeps it, and one that stands takes no more letters."""
    disc, still, right = (
        ["a", "0", "0", "1", "1", "0", "1"],
        ["left", "-6", "-3", "-6", "3"],
        ["piston", "6", "-3", "6", "3"],
    )
    page.open(packed({"n": "x", "events": 6, "c": [disc], "w": [still, right]}))
    room = 0.12 * 12 + 1e-9
    shown = -6 - room, -1 - room, 12 + 2 * room, 2 + 2 * room
    assert page.thing("piston") == {"x0": "6", "y0": "-3", "x1": "6", "y1": "3", "vx": "0", "vy": "0"}
    page.browser.ask(
        "[...document.querySelectorAll('#fields input')].forEach((e) => { if (e.name === 'vx') { e.value = '-2'; "
        "e.dispatchEvent(new Event('change', {bubbles: true})); } })"
    )
    page.drag(page.place(4, 0, shown), page.place(5, 0, shown))  # the end of its arrow, from two to one
    moved = opened(page)["w"][1]
    assert moved[:5] == right and moved[6] == "0"
    assert float(moved[5]) == pytest.approx(-1, abs=0.1)
    assert opened(page)["w"][0] == still
    piston = Wall(6, -3, 6, 3, vx=moved[5], id="piston")
    scene = Scene([Circle(0, 0, 1, 1, 0, id="a")], [Wall(-6, -3, -6, 3, id="left"), piston], name="x")
    verdict = page.run()
    assert verdict == verdict_line(compare(scene, ["double"], events=6))
    true = ExactEngine().run(scene, events=6)
    assert page.browser.ask("data.runs[0].events.map((e) => e[1])") == [float(e.time) for e in true.events]
    page.press("copy-toml")
    assert loads_toml(page.says("copied-text", "piston")).digest == scene.digest
    assert page.browser.messages == []


def test_a_finger_drags_as_a_mouse_does(page: PagePlayed) -> None:
    shown = view(page)
    page.drag(page.place(3, 0.5, shown), page.place(4, -2, shown), touch=True)
    assert float(page.thing("b")["y"]) == pytest.approx(-2, abs=0.1)


def test_the_cue_throws_away_from_the_pull_and_runs(page: PagePlayed) -> None:
    shown = view(page)
    page.press("cue")
    page.browser.ask("document.getElementById('verdict').textContent = ''")
    page.drag(page.place(3, 0.5, shown), page.place(6, 0.5, shown))
    assert page.wait("document.getElementById('verdict').textContent")
    assert float(page.thing("b")["vx"]) == pytest.approx(-3, abs=0.1)
    assert page.browser.ask("document.getElementById('cue').getAttribute('aria-pressed')") == "false"


def test_numbers_are_exact(page: PagePlayed) -> None:
    page.thing("b")
    for key, typed in (("y", "sqrt(3)/2"), ("r", "1/3"), ("m", "oo")):
        page.browser.ask(
            f"((e) => {{ e.value = {json.dumps(typed)}; e.dispatchEvent(new Event('change', {{bubbles: true}})); }})"
            f"(document.querySelector('#fields [name={key}]'))"
        )
    page.value("events", "20")
    verdict = page.run()
    circles = [Circle(-5, 0, 1, 2, "0.3", id="a"), Circle(3, "sqrt(3)/2", "1/3", m="oo", id="b")]
    circles.append(Circle(0, -3, "sqrt(2)/2", 1, 1, "1/2", id="c"))
    ends = {"left": (-9, 0, -9, 1), "right": (9, 0, 9, 1), "bottom": (0, -5, 1, -5), "top": (0, 5, 1, 5)}
    scene = Scene(circles, [Wall(*line, id=name) for name, line in ends.items()])
    true = compare(scene, ["double"], events=20)
    assert verdict == verdict_line(true)
    times = page.browser.ask("data.runs[0].events.map((event) => event[1])")
    assert times == [float(event.time) for event in true.reference.events]


def test_things_are_added_where_there_is_room_and_removed(page: PagePlayed) -> None:
    for kind in ("circle", "post", "wall", "segment", "pocket"):
        page.press(f"add-{kind}")
    rows = opened(page)
    assert [len(rows[letter]) for letter in "cwsp"] == [5, 5, 1, 1]
    assert rows["c"][4][6] == "oo"
    assert page.run().startswith("Floating point")
    page.press("remove")
    assert "p" not in opened(page)


def test_undo_and_redo_go_through_every_change(page: PagePlayed) -> None:
    shown = view(page)
    start = opened(page)
    page.drag(page.place(3, 0.5, shown), page.place(5, 2, shown))
    page.press("add-circle")
    page.press("remove")
    states = [opened(page)]
    for _ in range(3):
        page.press("undo")
        states.append(opened(page))
    assert states[-1] == start and len(states[1]["c"]) == 4 and len(states[2]["c"]) == 3
    assert page.browser.ask("document.getElementById('undo').disabled")
    for state in states[-2::-1]:
        page.press("redo")
        assert opened(page) == state
    assert page.browser.ask("document.getElementById('redo').disabled")


def test_a_click_that_moves_nothing_is_no_change(page: PagePlayed) -> None:
    place = page.place(3, 0.5, view(page))
    page.drag(place, place)
    assert page.browser.ask("document.getElementById('undo').disabled")
    assert page.text("edited").startswith("disc b")


def test_all_of_it_goes_by_keys(page: PagePlayed) -> None:
    page.browser.ask("document.getElementById('editor').focus()")
    page.key("PageDown")
    assert page.text("edited").startswith("disc a at (-5, 0)")
    page.key("PageDown")
    page.key("ArrowUp")
    page.key("ArrowRight", shift=True)
    moved = page.thing("b")
    assert float(moved["y"]) > 0.5 and float(moved["vx"]) > 0
    page.browser.ask("document.getElementById('editor').focus()")
    page.key("Delete")
    assert len(opened(page)["c"]) == 2
    for _ in range(3):
        page.key("z", control=True)
    assert opened(page)["c"][1][:3] == ["b", "3", "0.5"]
    page.key("y", control=True)
    assert opened(page)["c"][1][2] != "0.5"


def test_a_link_is_a_scene(page: PagePlayed) -> None:
    page.press("add-segment")
    page.value("events", "77")
    before = opened(page)
    link = page.browser.ask("location.hash")
    page.open(link.removeprefix("#"))
    assert opened(page) == before and before["events"] == 77
    assert page.browser.ask("document.getElementById('events').value") == "77"
    assert "token" not in page.browser.ask("location.href")
    page.press("copy-link")
    shown = page.wait("document.getElementById('copied-text').textContent")
    assert shown.endswith(link) and page.browser.ask("location.origin") in shown


def test_ten_discs_fit_in_two_thousand_letters(page: PagePlayed) -> None:
    page.browser.ask("[...document.querySelectorAll('#pictures button')].find((b) => b.textContent === 'gas').click()")
    assert len(opened(page)["c"]) == 10
    assert page.browser.ask("location.href.length") < 2000


HOSTILE: dict[str, tuple[Any, str | None]] = dict(
    zip(
        ["markup", "script", "many", "long", "object", "length", "name", "prototype", "list", "null", "bomb"],
        [
            ({"n": "x", "c": [["<img src=x onerror=alert(1)>", "0", "0", "1", "1", "0", "1"]]}, None),
            ({"n": "</script><script>alert(1)</script>", "c": [["a", "0", "0", "1", "1", "0", "1"]]}, None),
            ({"n": "x", "c": [[f"c{k}", str(3 * k), "0", "1", "0", "0", "1"] for k in range(401)]}, "401"),
            ({"n": "x", "c": [["a", "9" * 5000, "0", "1", "0", "0", "1"]]}, "5,000 characters"),
            ({"n": "x", "c": [["a", {"toString": 1}, "0", "1", "0", "0", "1"]]}, "no text"),
            ({"n": "x", "c": {"length": 10**9}}, "no scene"),
            ({"n": 7.5}, "no text"),
            ({"__proto__": {"n": 1}, "c": "abc"}, "no scene"),
            ([], None),
            (None, None),
            ("x" * 1_000_000, "no scene"),
        ],
        strict=True,
    )
)


def test_a_hostile_address_does_nothing(page: PagePlayed) -> None:
    for name, (rows, words) in HOSTILE.items():
        page.open(packed(rows))
        if words is not None:
            assert words in page.text("edited"), name
            assert page.thing("a")["x"] == "-5", f"{name}: the page's own scene is there"
        assert page.browser.ask("document.querySelectorAll('main img[src=x], main script').length") == 0, name
        assert page.browser.messages == [], name


NO_NUMBERS = ("9**9**9", "1/0", "10**400", "sqrt(-1)", "(" * 200, "__import__('os')", "NaN", "1e999999999")


def test_a_number_that_is_none_is_said_and_nothing_breaks(page: PagePlayed) -> None:
    for number in NO_NUMBERS:
        rows = [["a", number, "0", "1", "1", "0", "1"], ["b", "9", "0", "1", "0", "0", "1"]]
        page.open(packed({"n": "x", "c": rows}))
        page.press("go")
        assert page.wait("document.getElementById('progress').textContent.includes(\"'a'\")"), number


def test_what_overlaps_is_said_with_both_names(page: PagePlayed) -> None:
    shown = view(page)
    page.drag(page.place(3, 0.5, shown), page.place(-4.5, 0.5, shown))
    page.press("go")
    said = page.says("progress", "overlap")
    assert "'a'" in said and "'b'" in said


def test_a_run_that_is_too_long_is_stopped(page: PagePlayed) -> None:
    page.browser.ask("[...document.querySelectorAll('#pictures button')].find((b) => b.textContent === 'echo').click()")
    page.value("events", "5000")
    page.value("seconds", "60")
    page.press("go")
    page.wait("/events$/.test(document.getElementById('progress').textContent)")
    page.press("stop")
    assert page.wait("/^Stopped after [0-9,]+ events/.exec(document.getElementById('progress').textContent)?.[0]")
    page.value("events", "5")
    assert page.run()


def test_one_ulp_and_turning_back(page: PagePlayed) -> None:
    page.run("ulp")
    names = page.browser.ask("[...document.getElementById('engine').options].map((o) => o.text.split(':')[0])")
    assert names == ["double", "double (one bit off)"]
    page.value("events", "40")
    page.run("turn")
    home = page.text("home")
    assert "the exact run is exactly 0 from home" in home
    assert re.search(r"double is \d", home) and "choice of model" not in home
    page.open("scene=tennis")
    page.value("events", "40")
    page.run("turn")
    home = page.text("home")
    assert re.search(r"the exact run is 3\.87 from home", home) and "At 2 instants discs touch several things" in home


def test_the_certificate_is_checked_in_the_page(page: PagePlayed) -> None:
    page.value("events", "30")
    page.run()
    page.press("prove")
    said = page.says("proof", "verified|refuted|no certificate")
    assert "verified: 30 events" in said


def test_what_was_checked_of_a_certificate_is_shown(page: PagePlayed) -> None:
    page.open("scene=inscribed")
    page.run()
    assert page.browser.ask("document.getElementById('checked').hidden")
    page.press("prove")
    page.says("proof", "verified: 12 events")
    page.wait("!document.getElementById('checked').hidden")
    shown = dict(
        page.browser.ask(
            "[...document.querySelectorAll('#checked div')].map((e) => [...e.children].map((p) => p.innerText))"
        )
    )
    instants = json.loads(certified(ExactEngine().run(catalogue.build("inscribed"))).text)["instants"]
    met, pushes, zeros = (
        sum(len(instant.get("met", [])) for instant in instants),
        sum(len(each) for instant in instants for each in instant.get("rounds", [])),
        sum(len(instant.get("zeros", [])) for instant in instants),
    )
    assert met and pushes and zeros
    assert shown["Meetings"].startswith(f"{met} contacts in {len(instants)} instants")
    assert shown["Pushes"].startswith(f"{pushes} pushes") and shown["Exactly zero"].startswith(f"{zeros} numbers")
    page.run()
    assert page.browser.ask("document.getElementById('checked').hidden"), "another run has another proof"


def test_a_certificate_that_was_changed_is_refuted_in_the_page(page: PagePlayed) -> None:
    """The checker of the page is the one of the command line, and says what that says."""
    text = certified(ExactEngine().run(catalogue.build("gas"), events=5)).text
    told = page.browser.ask(
        "new Promise((done) => { const w = new Worker('check.js', {type: 'module'}); w.onmessage = (m) => done(m.data);"
        f"w.postMessage({json.dumps(text.replace('c1', 'c2', 1))}); }})"
    )
    assert not told.startswith("verified")


@pytest.mark.parametrize("name", ["chaos", "tie", "back"])
def test_a_lesson_can_be_linked_to(page: PagePlayed, name: str) -> None:
    page.open(f"lesson={name}")
    assert not page.browser.ask("document.getElementById('lesson').hidden")
    assert page.text("lesson-question").endswith("?")
    assert page.browser.ask("location.hash") == f"#lesson={name}"
    assert page.run().startswith("Floating point changed what happened")


def test_a_scene_of_the_catalogue_can_be_linked_to(page: PagePlayed) -> None:
    page.open("scene=lee")
    assert page.thing("middle")["x"] == "0"


def test_on_a_telephone_nothing_is_wider_than_it(page: PagePlayed) -> None:
    page.browser.size(390, 844)
    page.thing("a")
    page.run()
    page.press("why")
    page.wait("document.querySelectorAll('#answers dd').length")
    assert page.browser.ask("document.documentElement.scrollWidth") <= 390
    small = page.browser.ask(
        "[...document.querySelectorAll('button, select, input')]"
        ".filter((e) => e.offsetParent && e.getBoundingClientRect().height < 24).map((e) => e.id)"
    )
    assert set(small) <= {"scrubber"}


@pytest.mark.skipif(not AXE.is_file(), reason="no axe-core here: npm install --prefix tests/compare/report")
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing(page: PagePlayed, scheme: str) -> None:
    page.browser.media(prefers_color_scheme=scheme, prefers_reduced_motion="reduce")
    page.browser.ask("document.getElementById('catalogue').open = true")
    page.thing("a")
    page.run()
    page.press("why")
    page.wait("document.querySelectorAll('#answers dd').length")
    page.browser.ask(AXE.read_text("utf-8") + ";0")
    found = json.loads(page.browser.ask("axe.run().then((found) => JSON.stringify(found.violations))"))
    assert [(one["id"], [node["html"][:120] for node in one["nodes"]]) for one in found] == []


SAVED = """HTMLAnchorElement.prototype.click = function () { globalThis.named = this.download; };
URL.createObjectURL = (blob) => { blob.text().then((text) => { globalThis.saved = text; }); return "data:,"; };"""
"""Keeps what is saved, with its name, in place of a download."""


def test_the_saved_report_is_one_file_with_the_answers_and_the_player(page: PagePlayed, tmp_path: Path) -> None:
    page.browser.ask("[...document.querySelectorAll('#pictures button')].find((b) => b.textContent === 'gas').click()")
    page.run()
    page.browser.ask(SAVED)
    page.press("report")
    text = page.wait("globalThis.saved")
    assert page.browser.ask("globalThis.named") == "gas.html" and "@@" not in text
    file = tmp_path / "gas.html"
    file.write_text(text, "utf-8")
    true = compare(catalogue.build("gas"), ["double"], events=300, alternatives=False)
    divergence = true["double"].alignment.divergence
    assert divergence is not None
    for scheme, width in (("light", 1200), ("dark", 390)):
        page.browser.size(width, 844)
        page.browser.media(prefers_color_scheme=scheme, prefers_reduced_motion="reduce")
        page.browser.open(file)
        shown = page.browser.ask("[...document.querySelectorAll('dt, dd, .verdict')].map((e) => e.innerText.trim())")
        assert verdict_line(true) in shown and answers(true).where in shown
        page.press("jump")
        assert float(page.browser.ask("document.getElementById('scrubber').value")) == pytest.approx(divergence.time)
        assert page.browser.ask("document.documentElement.scrollWidth") <= width
        assert [url for url in page.browser.requests if not url.startswith(("file:", "data:"))] == []
        assert page.browser.messages == []
        if AXE.is_file():
            page.browser.ask(AXE.read_text("utf-8") + ";0")
            told = json.loads(page.browser.ask("axe.run().then((found) => JSON.stringify(found.violations))"))
            assert [(one["id"], [node["html"][:120] for node in one["nodes"]]) for one in told] == []


def test_what_is_taken_away_is_there_to_copy(page: PagePlayed) -> None:
    page.press("copy-toml")
    assert 'id = "a"' in page.wait("document.getElementById('copied-text').textContent")
    page.press("copy-python")
    assert page.wait("/Circle\\(id='a'/.test(document.getElementById('copied-text').textContent)")
    page.press("copy-command")
    assert page.wait("document.getElementById('copied-text').textContent.startsWith('truebreak compare')")


def test_a_server_that_has_ended_is_said(page: PagePlayed, play_server: PlayServer) -> None:
    token, play_server.token = play_server.token, "another"
    try:
        page.press("go")
        assert page.wait("document.getElementById('progress').textContent.includes('nly the page')")
    finally:
        play_server.token = token


def test_the_segment_that_is_drawn_is_the_one_that_is_run(page: PagePlayed) -> None:
    page.open(
        packed(
            {
                "n": "x",
                "events": 9,
                "c": [["a", "0", "0", "1", "1", "1/7", "1"]],
                "s": [["s", "5", "-3", "5", "3", "0"], ["t", "-5", "-3", "-5", "3", "1/9"]],
            }
        )
    )
    page.run()
    scene = Scene(
        [Circle(0, 0, 1, 1, "1/7", id="a")],
        segments=[Segment(5, -3, 5, 3, id="s"), Segment(-5, -3, -5, 3, id="t", r="1/9")],
    )
    true = compare(scene, ["double"], events=9)
    assert page.browser.ask("data.runs[0].events.map((e) => e[1])") == [float(e.time) for e in true.reference.events]


def test_a_polygon_is_drawn_by_its_corners_and_run(page: PagePlayed) -> None:
    shown = view(page)
    page.press("add-polygon")
    assert page.text("edited").startswith("Click the corners")
    for corner in ((4, -4), (8, -4), (6, -2), (4, -4)):
        place = page.place(*corner, shown)
        page.drag(place, place)
        if corner == (8, -4):
            assert page.text("add-polygon") == "Give it up" and page.text("edited") == "a polygon with 2 corners so far"
    drawn = page.thing("g1")
    assert [*drawn] == ["x1", "y1", "x2", "y2", "x3", "y3", "r"]
    for name, number in zip(drawn, (4, -4, 8, -4, 6, -2, 0), strict=True):
        assert float(drawn[name]) == pytest.approx(number, abs=0.1)
    page.browser.ask(
        "((e) => { e.value = 'sqrt(3)'; e.dispatchEvent(new Event('change', {bubbles: true})); })"
        "(document.querySelector('#fields [name=y3]'))"
    )
    page.value("restitution", "9/10")
    rows = opened(page)
    assert rows["restitution"] == "9/10" and rows["g"][0][1][2][1] == "sqrt(3)"
    page.value("events", "30")
    page.run()
    box = {"left": (-9, 0, -9, 1), "right": (9, 0, 9, 1), "bottom": (0, -5, 1, -5), "top": (0, 5, 1, 5)}
    circles = [Circle(-5, 0, 1, 2, "0.3", id="a"), Circle(3, "0.5", id="b")]
    circles.append(Circle(0, -3, "sqrt(2)/2", 1, 1, "1/2", id="c"))
    walls = [Wall(*line, id=name) for name, line in box.items()]
    scene = Scene(circles, walls, polygons=[Polygon(rows["g"][0][1], id="g1")], restitution="9/10")
    true = compare(scene, ["double"], events=30).reference
    assert any("g1" in pair for event in true.events for pair in event.impulses)
    assert page.browser.ask("data.runs[0].events.map((e) => e[1])") == [float(e.time) for e in true.events]


def test_a_polygon_is_placed_by_keys_and_its_corners_move_alone(page: PagePlayed) -> None:
    for _ in range(2):
        page.press("add-polygon")
    assert page.text("edited").startswith("polygon g1 of 3 corners")
    before = page.thing("g1")
    page.press("more")
    after = page.thing("g1")
    assert len(after) == len(before) + 2 and {*before.values()} <= {*after.values()}
    page.press("fewer")
    assert len(page.thing("g1")) == len(before)
    page.browser.ask("document.getElementById('editor').focus()")
    page.key("ArrowUp")
    moved = page.thing("g1")
    assert float(moved["y1"]) > float(before["y1"]) and moved["r"] == "0"
    shown = page.browser.ask("document.getElementById('undo').disabled")
    assert not shown
    page.press("add-polygon")
    page.browser.ask("document.getElementById('editor').focus()")
    page.key("Escape")
    assert page.text("add-polygon") == "+ polygon" and len(opened(page)["g"]) == 1


def test_a_polygon_is_dragged_whole_and_by_a_corner(page: PagePlayed) -> None:
    rows = {"n": "x", "c": [["a", "-3", "0", "1", "1", "0", "1"]]}
    page.open(packed({**rows, "g": [["p", [["0", "0"], ["1/3", "2"], ["4", "sqrt(3)"], ["3", "-1"]], "0"]]}))
    left, right, bottom, top = -4.0, 4.0, -1.0, 2.0
    room = 0.12 * 8 + 1e-9
    shown = left - room, bottom - room, right - left + 2 * room, top - bottom + 2 * room
    page.thing("p")
    page.drag(page.place(3, -1, shown), page.place(4, -1, shown))
    points = opened(page)["g"][0][1]
    assert points[:3] == [["0", "0"], ["1/3", "2"], ["4", "sqrt(3)"]]
    assert [float(part) for part in points[3]] == pytest.approx([4, -1], abs=0.1)
    page.drag(page.place(2, 0.8, shown), page.place(1, 0.8, shown))
    moved = [[float(part) for part in point] for point in opened(page)["g"][0][1]]
    assert moved[1] == pytest.approx([1 / 3 - 1, 2], abs=0.1) and moved[2] == pytest.approx([3, 3**0.5], abs=0.1)


NO_POLYGONS: list[tuple[Any, str]] = [
    ([["0", "0"], ["1", "1"]], "polygon p has no three corners"),
    ([[str(k), str(k * k)] for k in range(101)], "polygon p has 101 corners"),
    ([["0", "0"], ["1", "1"], ["1"]], "polygon p: corner 3 is no pair"),
    ("many", "polygon p has no three corners"),
]


def test_a_polygon_that_is_none_is_refused_by_name(page: PagePlayed) -> None:
    for points, words in NO_POLYGONS:
        page.open(packed({"n": "x", "c": [["a", "-9", "0", "1", "1", "0", "1"]], "g": [["p", points, "0"]]}))
        assert words in page.wait("document.getElementById('edited').textContent")


def test_gravity_is_typed_and_runs(page: PagePlayed) -> None:
    page.value("gravity-y", "-1/3")
    page.value("events", "12")
    assert opened(page)["gravity"] == ["0", "-1/3"]
    page.run()
    box = {"left": (-9, 0, -9, 1), "right": (9, 0, 9, 1), "bottom": (0, -5, 1, -5), "top": (0, 5, 1, 5)}
    circles = [Circle(-5, 0, 1, 2, "0.3", id="a"), Circle(3, "0.5", id="b")]
    circles.append(Circle(0, -3, "sqrt(2)/2", 1, 1, "1/2", id="c"))
    scene = Scene(circles, [Wall(*line, id=name) for name, line in box.items()], gravity=(0, "-1/3"))
    true = compare(scene, ["double"], events=12).reference
    assert page.browser.ask("data.runs[0].events.map((e) => e[1])") == [float(e.time) for e in true.events]
    page.value("gravity-y", "0")
    page.run()
    assert page.browser.ask("data.gravity ?? null") is None


def test_arcs_are_drawn_dragged_and_run(page: PagePlayed) -> None:
    """A ring around one disc, and half of a circle in it: the run of the page is that of the scene in its address."""
    disc, half = ["a", "0", "-1", "1/2", "2", "1/3", "1"], ["bow", "0", "0", "3", "3", "0", "-3", "0"]
    page.open(
        packed({"n": "x", "events": 12, "c": [disc], "a": [["ring", "0", "0", "6", None, None, None, None, 2], half]})
    )
    room = 0.12 * 12 + 1e-9
    shown = -6 - room, -6 - room, 12 + 2 * room, 12 + 2 * room
    assert [*page.thing("ring")] == ["x", "y", "r"]
    assert [*page.thing("bow")] == ["x", "y", "r", "x0", "y0", "x1", "y1"]
    page.drag(page.place(3, 0, shown), page.place(2, -3, shown))  # where it begins
    begun = opened(page)["a"][1]
    assert begun[1:4] == ["0", "0", "3"] and begun[6:] == ["-3", "0"]
    assert [float(part) for part in begun[4:6]] == pytest.approx([2, -3], abs=0.1)
    page.drag(page.place(-3, 0, shown), page.place(-3, -0.5, shown))  # where it ends
    top = 3 * 2**-0.5
    page.drag(page.place(top, top, shown), page.place(top + 0.5, top, shown))  # the whole, by a place on it
    page.browser.ask("document.getElementById('editor').focus()")
    page.key("ArrowRight")
    rows = opened(page)["a"]
    assert rows[0] == ["ring", "0", "0", "6", None, None, None, None, 2]
    assert float(rows[1][1]) > 0.4
    names = ("x", "y", "r", "x0", "y0", "x1", "y1")
    bow = Arc(**dict(zip(names, rows[1][1:], strict=True)), id="bow")
    scene = Scene([Circle(0, -1, "1/2", 2, "1/3", id="a")], arcs=[Arc(0, 0, 6, full=True, id="ring"), bow])
    page.run()
    true = compare(scene, ["double"], events=12).reference
    assert {"ring", "bow"} <= {name for event in true.events for pair in event.impulses for name in pair}
    assert page.browser.ask("data.runs[0].events.map((e) => e[1])") == [float(e.time) for e in true.events]
    assert len(page.browser.ask("data.arcs")) == 2
    assert page.browser.messages == []


def test_a_part_of_an_arc_is_sized_by_its_middle(page: PagePlayed) -> None:
    """Its ends stay where they are seen from its centre, and what is run is what is drawn."""
    disc, half = ["a", "0", "0", "1/2", "0", "1", "1"], ["bow", "0", "0", "3", "3", "0", "-3", "0"]
    ring = ["ring", "0", "0", "6", None, None, None, None, 2]
    page.open(packed({"n": "x", "events": 3, "c": [disc], "a": [ring, half]}))
    room = 0.12 * 12 + 1e-9
    shown = -6 - room, -6 - room, 12 + 2 * room, 12 + 2 * room
    page.thing("bow")
    page.drag(page.place(0, 3, shown), page.place(0, 4, shown))
    sized = opened(page)["a"][1]
    assert float(sized[3]) == pytest.approx(4, abs=0.1)
    assert [*sized[:3], *sized[4:]] == [*half[:3], *half[4:]]
    page.run()
    first = page.browser.ask("data.runs[0].events[0][1]")
    assert first == pytest.approx(float(sized[3]) - 0.5)  # straight up at speed 1, from the centre to the bow


def test_an_arc_and_a_ring_are_added_and_a_stadium_is_picked(page: PagePlayed) -> None:
    page.press("add-arc")
    assert page.text("edited").startswith("arc a1 about (")
    page.press("add-ring")
    assert page.text("edited").startswith("ring a2 about (")
    assert len(opened(page)["a"]) == 2
    page.press("undo")
    page.press("undo")
    page.browser.ask(
        "[...document.querySelectorAll('#pictures button')].find((b) => b.textContent === 'stadium').click()"
    )
    true = compare(catalogue.build("stadium"), ["double"], events=100, alternatives=False)
    assert page.run() == verdict_line(true)
    page.press("why")
    words = page.wait("[...document.querySelectorAll('#answers dd')].map((e) => e.firstChild.textContent)")
    assert words[1] == answers(true).why


def test_an_arc_without_an_end_is_refused_by_name(page: PagePlayed) -> None:
    ball = ["a", "0", "0", "1", "1", "0", "1"]
    page.open(packed({"n": "x", "c": [ball], "a": [["o", "0", "0", "6", "1", "0", None, "1"]]}))
    assert "arc o: x1 is no text" in page.wait("document.getElementById('edited').textContent")
