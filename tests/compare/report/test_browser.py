"""The page in a real browser: nothing wider than it, no errors, without scripts and motion, what axe-core finds."""

from __future__ import annotations

import json
import re
from itertools import product
from pathlib import Path

import pytest
from browser import Browser, found
from pages import PAGES, Files

pytestmark = pytest.mark.skipif(found() is None, reason="no chromium here: apt-get install chromium")

AXE = Path(__file__).parent / "node_modules" / "axe-core" / "axe.min.js"
WIDTHS = (1200, 768, 360, 320)
PAPER = 718
"""Pixels of an A4 sheet between margins of a centimetre."""

CLIPPED = """[...document.querySelectorAll('main *')].filter((e) => {
  const box = e.getBoundingClientRect();
  const style = getComputedStyle(e);
  const head = e.closest('thead');
  const shown = box.width > 1 && style.visibility !== 'hidden' && !(head && head.offsetHeight <= 1);
  const scrolls = (x) => ['auto', 'scroll'].includes(getComputedStyle(x).overflowX);
  const own = scrolls(e) || e instanceof SVGElement || e.tagName === 'SELECT';
  for (let x = e.parentElement; x && x.tagName !== 'MAIN'; x = x.parentElement) if (scrolls(x)) return false;
  const cut = e.clientWidth > 0 && e.scrollWidth > e.clientWidth + 1 && style.display !== 'inline';
  return shown && !own && (cut || box.right > innerWidth + 1 || box.left < -1);
}).map((e) => e.outerHTML.slice(0, 120))"""
"""Elements that stick out of the page, or whose contents stick out of them."""


UNFOLDED = """document.querySelectorAll('details').forEach((fold) => {
  fold.removeAttribute('name');
  fold.open = true;
})"""
"""Opens every fold, those too of which a reader sees one at a time."""


@pytest.mark.parametrize("kind", PAGES)
def test_nothing_is_wider_than_the_page_and_nothing_goes_wrong(browser: Browser, files: Files, kind: str) -> None:
    for width in WIDTHS:
        browser.size(width)
        browser.open(files / f"{kind}.html")
        browser.ask(UNFOLDED)
        assert browser.ask("document.documentElement.scrollWidth") <= width
        assert browser.ask(CLIPPED) == []
        assert browser.messages == []
        assert [address for address in browser.requests if not address.startswith(("file:", "data:"))] == []


@pytest.mark.parametrize("kind", ["gas", "rack", "hostile", "many-engines", "chaos", "orders"])
def test_nothing_is_cut_on_paper(browser: Browser, files: Files, kind: str) -> None:
    browser.size(PAPER)
    browser.open(files / f"{kind}.html")
    browser.media("print")
    browser.ask("dispatchEvent(new Event('beforeprint'))")
    assert browser.ask("document.documentElement.scrollWidth") <= PAPER
    assert browser.ask(CLIPPED) == []
    assert browser.ask("getComputedStyle(document.getElementById('player')).display") == "none"
    assert browser.ask("[...document.querySelectorAll('details:not(.help)')].every((fold) => fold.open)")
    browser.ask("document.querySelectorAll('details.help').forEach((mark) => { mark.open = true; })")
    assert browser.ask("[...document.querySelectorAll('.help p, .contents')].every((e) => e.offsetHeight === 0)")
    heads = "[...document.querySelectorAll('th button')].map((button) => getComputedStyle(button).display)"
    assert set(browser.ask(heads)) <= {"contents"}, "Chromium leaves buttons out of a repeated head"
    tops = browser.ask("[...document.querySelectorAll('.frames figure')].map((e) => e.getBoundingClientRect().top)")
    assert len({*tops}) * 3 == len(tops), "the three frames of a moment stand side by side"
    assert browser.paper().startswith(b"%PDF")


def test_less_motion_leaves_the_steps_and_the_still_pictures(browser: Browser, files: Files) -> None:
    browser.media(prefers_reduced_motion="reduce")
    browser.open(files / "gas.html")
    assert browser.ask("document.getElementById('play').hidden")
    assert not browser.ask("document.getElementById('still').hidden")
    browser.ask("document.getElementById('scrubber').focus()")
    browser.press("Space")
    assert browser.ask("document.getElementById('play').textContent") == "Play"
    assert browser.ask(
        "[...document.querySelectorAll('svg.picture')].every((e) => e.getBoundingClientRect().width > 100)"
    )


def test_without_scripts_the_pictures_the_tables_and_the_files_are_there(browser: Browser, files: Files) -> None:
    browser.script(False)
    browser.open(files / "gas.html")
    assert browser.ask("getComputedStyle(document.getElementById('player')).display") == "none"
    assert browser.ask("document.querySelectorAll('svg.picture').length") > 0
    assert browser.ask("document.querySelectorAll('a[download]').length") == 3
    assert browser.ask("document.querySelector('[data-copy]').hidden")


@pytest.mark.parametrize("kind", ["gas", "near-tie", "galperin", "rack", "undecided", "pinball", "thirty"])
def test_the_first_screen_holds_the_verdict_and_the_four_answers(browser: Browser, files: Files, kind: str) -> None:
    names = "[...document.querySelector('.answers').querySelectorAll('dt')].map((e) => e.firstChild.textContent.trim())"
    for width, height in ((1280, 800), (390, 844)):
        browser.size(width, height)
        browser.open(files / f"{kind}.html")
        assert browser.ask(names) == ["Where", "Why", "So what", "What now"]
        assert browser.ask("document.querySelector('.answers').getBoundingClientRect().bottom") <= height
        assert browser.ask("document.querySelector('.answers').getBoundingClientRect().top") > 0
        assert width > 672 or browser.ask("document.documentElement.scrollHeight") <= 6000


@pytest.mark.parametrize("kind", ["gas", "rack", "pinball", "many-engines"])
def test_no_text_of_a_picture_is_small(browser: Browser, files: Files, kind: str) -> None:
    for width in (1280, 1000, 768, 673, 672, 390, 320):
        browser.size(width)
        browser.open(files / f"{kind}.html")
        browser.ask(UNFOLDED)
        assert browser.ask(SMALL_TEXT) == [], width


SMALL_TEXT = """[...document.querySelectorAll('svg text')].map((e) => {
  const svg = e.ownerSVGElement;
  return parseFloat(getComputedStyle(e).fontSize) * svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;
}).filter((size) => size > 0 && size < 9)"""
"""Sizes in pixels, as they are seen, of the letters of pictures that are below nine."""


def test_every_heading_says_what_it_is_about_and_only_one_at_a_time(browser: Browser, files: Files) -> None:
    browser.open(files / "gas.html")
    heads = "[...document.querySelectorAll('h2, h3')].filter((e) => !e.closest('summary'))"
    bare = f"{heads}.filter((e) => !e.parentElement.querySelector('.help')).map((e) => e.textContent)"
    assert browser.ask(bare) == []
    about = browser.ask("[...document.querySelectorAll('.help p')].map((e) => e.textContent)")
    assert min(len(re.findall(r"[.:] [A-Z]|[.]$", text)) for text in about) >= 2
    shown = "[...document.querySelectorAll('details.help[open]')].length"
    for place in (0, 1):
        browser.ask(f"document.querySelectorAll('.answers .help summary')[{place}].click()")
        browser.ask("new Promise((done) => setTimeout(done))")
        assert browser.ask(shown) == 1
    browser.ask("dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape' }))")
    assert browser.ask(shown) == 0


def test_a_link_to_a_folded_engine_opens_it(browser: Browser, files: Files) -> None:
    browser.open(files / "gas.html")
    fold = "document.getElementById('engine-2')"
    assert browser.ask(f"{fold}.open") is False
    browser.ask("document.querySelector('.chips a[href=\"#engine-2\"]').click()")
    browser.ask("new Promise((done) => setTimeout(done))")
    assert browser.ask(f"{fold}.open") is True


@pytest.mark.parametrize("width", WIDTHS)
def test_tables_sort(browser: Browser, files: Files, width: int) -> None:
    browser.size(width)
    browser.open(files / "many-engines.html")
    column = (
        "[...document.querySelector('table.sortable').tBodies[0].rows].map((row) => row.cells[3].textContent.trim())"
    )
    for expected in (False, True):
        browser.click("table.sortable th:nth-child(4) button")
        assert browser.ask("document.querySelector('table.sortable th:nth-child(4) button').offsetHeight") > 15
        numbers = [float(text) for text in browser.ask(column)]
        assert numbers == sorted(numbers, reverse=expected)
    assert browser.ask("document.querySelector('table.sortable th:nth-child(4)').ariaSort") == "descending"


@pytest.mark.skipif(not AXE.is_file(), reason="no axe-core here: npm install --prefix tests/compare/report")
@pytest.mark.parametrize("kind", ["gas", "near-tie", "undecided", "unsettled", "hostile", "pinball", "chaos", "orders"])
def test_axe_finds_nothing_serious(browser: Browser, files: Files, kind: str) -> None:
    for scheme, width in product(("light", "dark"), (1200, 360)):
        browser.media(prefers_color_scheme=scheme)
        browser.size(width)
        browser.open(files / f"{kind}.html")
        browser.ask(UNFOLDED)
        browser.ask(AXE.read_text(encoding="utf-8") + "; 0")
        told = browser.ask("axe.run().then((found) => JSON.stringify(found.violations))")
        bad = [
            (rule["id"], [node["html"][:120] for node in rule["nodes"][:3]])
            for rule in json.loads(told)
            if rule["impact"] in ("serious", "critical")
        ]
        assert bad == [], (scheme, width)
