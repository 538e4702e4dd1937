"""The player in a real browser: clock, scrubber, keys, lists, the jump to the first divergence."""

from __future__ import annotations

import json

import pytest
from browser import Browser, found
from pages import Files, comparison

pytestmark = pytest.mark.skipif(found() is None, reason="no chromium here: apt-get install chromium")


def test_the_scrubber_moves_the_clock(browser: Browser, files: Files) -> None:
    browser.open(files / "gas.html")
    before = browser.ask(PIXELS)
    browser.ask(MOVE % 3.5)
    assert browser.ask("document.getElementById('clock').textContent") == "3.5"
    assert browser.ask(PIXELS) != before
    place = max(k for k, event in enumerate(comparison("gas").reference.events) if float(event.time) <= 3.5)
    assert browser.ask(CURRENT).startswith(f"{place} | ")


MOVE = "((s) => { s.value = %r; s.dispatchEvent(new Event('input')); })(document.getElementById('scrubber'))"
PIXELS = "['pane-truth', 'pane-engine'].map((name) => document.getElementById(name).toDataURL()).join()"
CURRENT = (
    "[...(document.querySelector('#list [aria-selected=true]')?.children ?? [])].map((e) => e.textContent).join(' | ')"
)
"""The row at which the list stands: the event's number, the reference's pairs and time, the engine's."""
CLOCK = "Number(document.getElementById('scrubber').value)"


def test_a_finger_does_what_a_mouse_does(browser: Browser, files: Files) -> None:
    """On a telephone: help, folds, the frames side by side, the strip, a step, a row of the list, the slider."""
    browser.size(390, 844)
    browser.send("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=5)
    try:
        browser.open(files / "gas.html")
        shown = "document.querySelectorAll('details.help[open]').length"
        browser.touch(".answers .help summary")
        assert browser.ask(shown) == 1
        browser.touch("h1")
        assert browser.ask(shown) == 0, "a touch elsewhere closes it"
        browser.touch(".frames", swipe=-150)
        assert browser.ask("document.querySelector('.frames').scrollLeft") > 100
        browser.touch("#strip", across=0.25)
        begin, end = browser.ask("(({min, max}) => [Number(min), Number(max)])(document.getElementById('scrubber'))")
        assert browser.ask(CLOCK) == pytest.approx(begin + (end - begin) / 4, rel=0.02)
        before = browser.ask(CLOCK)
        browser.touch("#forth")
        assert browser.ask(CLOCK) > before
        browser.touch("#list li:nth-child(2)")
        assert browser.ask(CURRENT).startswith("1 | ")
        browser.touch("#scrubber", across=0.9)
        assert browser.ask(CLOCK) == pytest.approx(begin + (end - begin) * 0.9, rel=0.05)
        browser.touch("details.engine + details.engine > summary")
        opened = "[...document.querySelectorAll('details.engine')].map((fold) => fold.open)"
        assert browser.ask(opened) == [False, True], "one at a time"
        browser.touch("#play")
        assert browser.ask("document.getElementById('play').textContent") == "Stop"
        browser.touch("#play")
        assert browser.ask("document.getElementById('play').textContent") == "Play"
        small = "[...document.querySelectorAll('button, select, summary, .contents a')].filter((e) => e.offsetParent"
        assert (
            browser.ask(f"{small} && e.getBoundingClientRect().height < 24).map((e) => e.outerHTML.slice(0, 90))") == []
        )
    finally:
        browser.send("Emulation.setTouchEmulationEnabled", enabled=False)


def test_the_jump_lands_on_the_first_divergence(browser: Browser, files: Files) -> None:
    browser.open(files / "gas.html")
    divergence = comparison("gas")["pymunk"].alignment.divergence
    assert divergence is not None
    browser.ask("document.getElementById('scrubber').focus()")
    browser.press("Home")
    assert browser.ask(CLOCK) == 0
    browser.click("#jump")
    assert browser.ask(CLOCK) == pytest.approx(divergence.time, rel=1e-9)
    assert browser.ask(CURRENT).startswith(f"{divergence.expected_event} ◆ | ")
    assert "The first divergence" in browser.ask("document.getElementById('told').textContent")
    (cells,) = browser.ask(MARKED)
    assert divergence.expected is not None and divergence.got is not None
    assert divergence.expected in cells[1]
    assert divergence.got in cells[2]


MARKED = (
    "[...document.querySelectorAll('#player li.first')].map((e) => [...e.children].map((cell) => cell.textContent))"
)


def test_both_histories_stand_row_by_row(browser: Browser, files: Files) -> None:
    """Every event of each run is in the list once; up to the divergence both cells of a row name the same pair."""
    browser.open(files / "gas.html")
    rows = browser.ask(
        "[...document.querySelectorAll('#list li')].map((e) => [...e.children].map((c) => c.textContent))"
    )
    found = comparison("gas")
    run = found["pymunk"].trajectory
    assert [int(row[0].split()[0]) for row in rows if row[0]] == list(range(len(found.reference.events)))
    end = float(found.reference.final_time)
    assert sum(row[2] != "–" for row in rows) == sum(float(event.time) <= end for event in run.events)
    parted = found["pymunk"].alignment.divergence
    assert parted is not None
    for row in rows[: parted.event]:
        assert row[1].split("  ")[0] == row[2].split("  ")[0]


def test_past_the_divergence_the_meter_says_another_history(browser: Browser, files: Files) -> None:
    browser.open(files / "gas.html")
    digits = "document.getElementById('digits').textContent"
    assert float(browser.ask(digits)) >= 0
    browser.ask("document.getElementById('scrubber').focus()")
    browser.press("ArrowRight")
    assert browser.ask(digits) == "none: another history"


def test_the_strip_has_the_error_and_takes_a_click(browser: Browser, files: Files) -> None:
    browser.open(files / "gas.html")
    strip = "document.getElementById('strip').toDataURL()"
    before = browser.ask(strip)
    browser.click("#strip")
    data = json.loads(browser.ask("document.getElementById('recording').textContent"))
    assert browser.ask(CLOCK) == pytest.approx((data["begin"] + data["end"]) / 2, rel=0.01)
    assert browser.ask(strip) != before
    for run in data["runs"][1:]:
        assert run["errors"][-1][0] >= min(data["end"], run["end"]) * 0.999


def test_outlines_that_are_apart_are_tied_to_their_discs(browser: Browser, files: Files) -> None:
    """Lines in the reference's colour come where the engine's discs are elsewhere, and are gone at the start."""
    browser.open(files / "gas.html")
    blue = """(() => { const c = document.getElementById('pane-engine');
      const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let n = 0;
      for (let k = 0; k < d.length; k += 4) n += d[k + 2] > d[k] + 70; return n; })()"""
    browser.ask("document.getElementById('scrubber').focus()")
    browser.press("Home")
    at_start = browser.ask(blue)
    browser.press("End")
    with_ties = browser.ask(blue)
    assert with_ties > at_start + 100


@pytest.mark.parametrize("kind", ["break", "pinball", "thirty"])
def test_the_page_opens_at_the_first_divergence_and_the_jump_finds_it_again(
    browser: Browser, files: Files, kind: str
) -> None:
    browser.open(files / f"{kind}.html")
    opened = browser.ask(CLOCK)
    ends = [
        t
        for c in comparison(kind).candidates
        if (d := c.alignment.divergence) is not None
        for t in (d.time, d.expected_time, d.got_time)
        if t is not None
    ]
    assert any(opened == pytest.approx(t, rel=1e-9) for t in ends)
    browser.ask("document.getElementById('scrubber').focus()")
    browser.press("Home")
    assert browser.ask(CLOCK) == 0
    browser.click("#jump")
    assert browser.ask(CLOCK) == opened
    assert "The first divergence" in browser.ask("document.getElementById('told').textContent")


def test_at_the_first_divergence_the_list_stands_at_its_event(browser: Browser, files: Files) -> None:
    """In the break three events of doubles lie within an instant that the clock cannot tell apart."""
    browser.open(files / "break.html")
    divergence = comparison("break")["double"].alignment.divergence
    assert divergence is not None
    assert browser.ask(CURRENT).startswith(f"{divergence.event} ◆ | ")
    clock = browser.ask(CLOCK)
    browser.ask("document.getElementById('scrubber').focus()")
    seen = {browser.ask(CURRENT)}
    for _ in range(2):
        browser.press("ArrowLeft")
        seen.add(browser.ask(CURRENT))
        assert browser.ask(CLOCK) == pytest.approx(clock, rel=1e-9)
    assert len(seen) == 3
    for _ in range(2):
        browser.press("ArrowRight")
    assert browser.ask(CURRENT).startswith(f"{divergence.event} ◆ | ")
    browser.press("ArrowRight")
    assert browser.ask(CLOCK) > clock


def test_events_that_no_double_tells_apart_are_gone_through_one_by_one(browser: Browser, files: Files) -> None:
    """Four in the exact run, all at t = 1 as a double, with how much later each is than the last; one in doubles."""
    browser.open(files / "near-tie.html")
    rows = browser.ask("[...document.querySelectorAll('#list li')].map((row) => row.children[1].textContent)")
    assert [row.split("  ")[1] for row in rows] == ["t = 1", "5.00e-41 later", "2.27e-41 later", "2.27e-40 later"]
    assert browser.ask(CURRENT).startswith("0 ")
    browser.ask("document.getElementById('scrubber').focus()")
    for key, place in (("ArrowRight", "1"), ("ArrowRight", "2"), ("ArrowLeft", "1"), ("ArrowLeft", "0")):
        browser.press(key)
        assert browser.ask(CLOCK) == 1
        assert browser.ask(CURRENT).startswith(f"{place} ")
    browser.click("#row-2")
    assert browser.ask(CURRENT).startswith("2 ")
    assert "event 2: exact" in browser.ask("document.getElementById('told').textContent")
    browser.press("Home")
    browser.press("ArrowRight")
    assert browser.ask(CURRENT).startswith("0 ")


@pytest.mark.parametrize("kind", ["undecided", "unsettled"])
def test_a_page_without_an_answer_opens_where_the_run_stopped(browser: Browser, files: Files, kind: str) -> None:
    browser.open(files / f"{kind}.html")
    stopped = float(comparison(kind).candidates[0].trajectory.final_time)
    assert browser.ask(CLOCK) == pytest.approx(stopped, rel=1e-12)
    assert " ends at t = " in browser.ask("document.getElementById('told').textContent")
    browser.ask("document.getElementById('scrubber').focus()")
    browser.press("Home")
    assert browser.ask("document.getElementById('jump').textContent") == "To where it stopped"
    browser.click("#jump")
    assert browser.ask(CLOCK) == pytest.approx(stopped, rel=1e-12)
    assert "No engine went to the end" in browser.ask("document.querySelector('main').textContent")


def test_small_bodies_are_shown_close_up_and_all_of_them_when_asked(browser: Browser, files: Files) -> None:
    browser.open(files / "orders.html")
    pressed = "document.getElementById('close').getAttribute('aria-pressed')"
    assert browser.ask(pressed) == "true"
    close = browser.ask(PIXELS)
    browser.click("#close")
    assert browser.ask(pressed) == "false"
    assert browser.ask(PIXELS) != close
    browser.click("#close")
    assert browser.ask(PIXELS) == close
    browser.open(files / "gas.html")
    assert browser.ask(pressed) == "false"
    browser.open(files / "undecided.html")
    assert browser.ask("document.getElementById('close').hidden")


@pytest.mark.parametrize("kind", ["thousand", "long-galperin", "chaos", "orders"])
def test_the_scrubber_moves_in_every_kind_of_page(browser: Browser, files: Files, kind: str) -> None:
    browser.open(files / f"{kind}.html")
    browser.ask("document.getElementById('scrubber').focus()")
    browser.press("Home")
    before, clock = browser.ask(PIXELS), browser.ask("document.getElementById('clock').textContent")
    browser.press("ArrowRight")
    assert browser.ask("document.getElementById('clock').textContent") != clock
    assert browser.ask(PIXELS) != before
    assert browser.ask(CURRENT) != ""


def test_a_run_alone_has_one_pane_and_moves_the_line_in_the_plot(browser: Browser, files: Files) -> None:
    browser.open(files / "chaos.html")
    shown = "[...document.querySelectorAll('#player figure')].filter((e) => e.offsetWidth > 0).length"
    assert browser.ask(shown) == 1
    assert browser.ask("document.getElementById('digits-told').hidden")
    where = "Number(document.querySelector('#errors svg.wide .cursor').getAttribute('x1'))"
    before = browser.ask(where)
    browser.ask("document.getElementById('scrubber').focus()")
    browser.press("End")
    assert browser.ask(where) > before + 400


def test_two_outcomes_part_where_they_are_said_to(browser: Browser, files: Files) -> None:
    browser.open(files / "orders.html")
    assert browser.ask("document.getElementById('name-engine').textContent").startswith("outcome 1: b1 hits b2 first")
    (cells,) = browser.ask(MARKED)
    assert cells[1] != cells[2]
    browser.ask(
        "(() => { const e = document.getElementById('engine'); e.value = 3; e.dispatchEvent(new Event('change')); })()"
    )
    assert browser.ask("document.getElementById('name-engine').textContent").startswith("outcome 3")
    assert browser.messages == []


def test_digits_are_not_all_there_once_an_error_may_have_come(browser: Browser, files: Files) -> None:
    """Between an error of nothing and the next that is known, the counter tells of the latter."""
    browser.open(files / "break.html")
    errors = json.loads(browser.ask("document.getElementById('recording').textContent"))["runs"][2]["errors"]
    place = max(k for k, (_, error) in enumerate(errors) if error == 0)
    browser.ask(MOVE % ((errors[place][0] + errors[place + 1][0]) / 2))
    browser.ask(
        "(() => { const e = document.getElementById('engine'); e.value = 2; e.dispatchEvent(new Event('change')); })()"
    )
    assert float(browser.ask("document.getElementById('digits').textContent")) < 17


def test_the_two_bodies_are_ringed_at_the_divergence_and_not_long_before(browser: Browser, files: Files) -> None:
    """The ring is drawn in the colour of text, which nothing else without a label has: pixels of it come and go."""
    browser.open(files / "gas.html")
    data = json.loads(browser.ask("document.getElementById('recording').textContent"))
    run = next(run for run in data["runs"] if run.get("divergence"))
    assert len(run["divergence"]["bodies"]) == 2
    browser.click("#jump")
    ringed = browser.ask(DARK)
    browser.ask("document.getElementById('scrubber').focus()")
    browser.press("Home")
    assert ringed > browser.ask(DARK) + 200


DARK = """(() => { const c = document.getElementById('pane-truth');
  const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let n = 0;
  for (let k = 0; k < d.length; k += 4) n += d[k] < 60 && d[k + 1] < 60 && d[k + 2] < 70; return n; })()"""


def test_keys_go_from_event_to_event(browser: Browser, files: Files) -> None:
    browser.open(files / "undecided.html")
    every = sorted(
        {float(e.time) for e in comparison("undecided").reference.events}
        | {float(e.time) for e in comparison("undecided").candidates[0].trajectory.events}
    )
    times = [time for time, before in zip(every, [0.0, *every], strict=False) if time - before > 1e-9 * time]
    browser.ask("document.getElementById('scrubber').focus()")
    browser.press("Home")
    browser.press("ArrowRight")
    assert browser.ask(CLOCK) == pytest.approx(times[0], rel=1e-12)
    browser.press("ArrowRight")
    browser.press("ArrowRight")
    browser.press("ArrowLeft")
    assert browser.ask(CLOCK) == pytest.approx(times[1], rel=1e-9)
    browser.press("End")
    assert browser.ask(CLOCK) == pytest.approx(float(comparison("undecided").reference.final_time), rel=1e-12)
    assert " ends at t = " in browser.ask("document.getElementById('told').textContent")
    browser.press("Space")
    assert browser.ask("document.getElementById('play').textContent") == "Stop"
    browser.press("Space")
    assert browser.ask("document.getElementById('play').textContent") == "Play"


def test_keys_need_no_focus_while_the_panes_are_in_sight(browser: Browser, files: Files) -> None:
    browser.size(1200)
    browser.open(files / "gas.html")
    assert browser.ask("document.activeElement.tagName") == "BODY"
    browser.ask("document.getElementById('player').scrollIntoView()")
    scrolled = browser.ask("scrollY")
    browser.press("Home")
    assert browser.ask(CLOCK) == 0
    browser.press("ArrowRight")
    after = browser.ask(CLOCK)
    assert after > 0
    browser.press("Space")
    assert browser.ask("document.getElementById('play').textContent") == "Stop"
    browser.press("Space")
    assert browser.ask("scrollY") == scrolled
    stopped = browser.ask(CLOCK)
    browser.ask("document.querySelector('footer').scrollIntoView()")
    browser.press("Home")
    assert browser.ask(CLOCK) == stopped, "out of sight, Home is the page's"
    browser.ask("document.querySelector('table.sortable th button').focus()")
    browser.press("ArrowRight")
    assert browser.ask(CLOCK) == stopped, "what has the focus has the keys"


def test_playing_moves_the_clock_until_it_is_stopped(browser: Browser, files: Files) -> None:
    browser.open(files / "gas.html")
    browser.ask("document.getElementById('scrubber').focus()")
    browser.press("Home")
    browser.click("#play")
    reached = (
        "new Promise((done) => { const look = () => (%s > 0 ? done(true) : requestAnimationFrame(look)); look(); })"
    )
    assert browser.ask(reached % CLOCK)
    browser.click("#play")
    stopped = browser.ask(CLOCK)
    browser.ask("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    assert browser.ask(CLOCK) == stopped


def test_an_event_in_the_list_and_a_place_in_the_plot_can_be_clicked(browser: Browser, files: Files) -> None:
    browser.open(files / "gas.html")
    event = comparison("gas").reference.events[12]
    row = next(k for k, text in enumerate(browser.ask(NUMBERS)) if text == "12")
    browser.ask(f"document.getElementById('row-{row}').scrollIntoView()")
    browser.click(f"#row-{row}")
    assert browser.ask(CLOCK) == pytest.approx(float(event.time), rel=1e-12)
    browser.click("#errors svg.wide")
    x = float(browser.ask("document.querySelector('#errors svg.wide .cursor').getAttribute('x1')"))
    assert x == pytest.approx(450, abs=2)


NUMBERS = "[...document.querySelectorAll('#list li')].map((row) => row.children[0].textContent)"


def test_digits_run_down(browser: Browser, files: Files) -> None:
    browser.open(files / "gas.html")
    browser.ask("document.getElementById('scrubber').focus()")
    browser.press("Home")
    assert browser.ask("document.getElementById('digits').textContent") == "all"
    digits = []
    for _ in range(5):
        for _ in range(7):
            browser.press("ArrowRight")
        digits.append(float(browser.ask("document.getElementById('digits').textContent")))
    assert digits[-1] < digits[0] < 16


def test_another_engine_can_be_chosen(browser: Browser, files: Files) -> None:
    browser.open(files / "gas.html")
    assert browser.ask("document.getElementById('name-engine').textContent") == "pymunk"
    browser.ask(
        "(() => { const e = document.getElementById('engine'); e.value = 1; e.dispatchEvent(new Event('change')); })()"
    )
    assert browser.ask("document.getElementById('name-engine').textContent") == "double"
    assert browser.ask("document.getElementById('jump').hidden")
    assert browser.ask("document.getElementById('engine-figure').className") == "e0"


def test_sound_is_off_at_first(browser: Browser, files: Files) -> None:
    browser.open(files / "gas.html")
    assert browser.ask("document.getElementById('sound').getAttribute('aria-pressed')") == "false"
    browser.click("#sound")
    assert browser.ask("document.getElementById('sound').getAttribute('aria-pressed')") == "true"
    assert browser.messages == []
