"""The page in a real browser: nothing wider than it, no errors, without scripts and motion, what axe-core finds."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from browser import Browser, found
from pages import PAGES, Files

pytestmark = pytest.mark.skipif(found() is None, reason="no chromium here: apt-get install chromium")

AXE = Path(__file__).parent / "node_modules" / "axe-core" / "axe.min.js"
WIDTHS = (1200, 768, 360)
PAPER = 718
"""Pixels of an A4 sheet between margins of a centimetre."""

CLIPPED = """[...document.querySelectorAll('main *')].filter((e) => {
  const box = e.getBoundingClientRect();
  const style = getComputedStyle(e);
  const head = e.closest('thead');
  const shown = box.width > 1 && style.visibility !== 'hidden' && !(head && head.offsetHeight <= 1);
  const own = ['auto', 'scroll'].includes(style.overflowX) || e instanceof SVGElement;
  const cut = e.clientWidth > 0 && e.scrollWidth > e.clientWidth + 1 && style.display !== 'inline';
  return shown && !own && (cut || box.right > innerWidth + 1 || box.left < -1);
}).map((e) => e.outerHTML.slice(0, 120))"""
"""Elements that stick out of the page, or whose contents stick out of them."""


@pytest.mark.parametrize("kind", PAGES)
def test_nothing_is_wider_than_the_page_and_nothing_goes_wrong(browser: Browser, files: Files, kind: str) -> None:
    for width in WIDTHS:
        browser.size(width)
        browser.open(files / f"{kind}.html")
        browser.ask("document.querySelectorAll('details.outcome').forEach((fold) => { fold.open = true; })")
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
    assert browser.ask("[...document.querySelectorAll('details.outcome')].every((fold) => fold.open)")
    heads = "[...document.querySelectorAll('th button')].map((button) => getComputedStyle(button).display)"
    assert set(browser.ask(heads)) == {"contents"}, "Chromium leaves buttons out of a repeated head"
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


@pytest.mark.parametrize("width", WIDTHS)
def test_tables_sort(browser: Browser, files: Files, width: int) -> None:
    browser.size(width)
    browser.open(files / "gas.html")
    column = (
        "[...document.querySelector('table.sortable').tBodies[0].rows].map((row) => row.cells[2].textContent.trim())"
    )
    for expected in (False, True):
        browser.click("table.sortable th:nth-child(3) button")
        assert browser.ask("document.querySelector('table.sortable th:nth-child(3) button').offsetHeight") > 15
        numbers = [float(text) for text in browser.ask(column)]
        assert numbers == sorted(numbers, reverse=expected)
    assert browser.ask("document.querySelector('table.sortable th:nth-child(3)').ariaSort") == "descending"


@pytest.mark.skipif(not AXE.is_file(), reason="no axe-core here: npm install --prefix tests/compare/report")
@pytest.mark.parametrize("kind", ["gas", "near-tie", "undecided", "unsettled", "hostile", "pinball", "chaos", "orders"])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing_serious(browser: Browser, files: Files, kind: str, scheme: str) -> None:
    browser.media(prefers_color_scheme=scheme)
    for width in (1200, 360):
        browser.size(width)
        browser.open(files / f"{kind}.html")
        browser.ask("document.querySelectorAll('details').forEach((fold) => { fold.open = true; })")
        browser.ask(AXE.read_text(encoding="utf-8") + "; 0")
        told = browser.ask("axe.run().then((found) => JSON.stringify(found.violations))")
        bad = [
            (rule["id"], [node["html"][:120] for node in rule["nodes"][:3]])
            for rule in json.loads(told)
            if rule["impact"] in ("serious", "critical")
        ]
        assert bad == []
