"""Every scene of the catalogue as a report: its first screen, its length on a telephone, its size, what axe finds."""

from __future__ import annotations

import json
import time
from pathlib import Path

import pytest
from browser import Browser, found
from test_browser import AXE, CLIPPED, SMALL_TEXT, UNFOLDED

from truebreak.compare import compare, html_report
from truebreak.compare.chaos.certified_chaos import chaos
from truebreak.compare.orders.all_orders import all_orders
from truebreak.compare.report.chaos_page import chaos_html
from truebreak.compare.report.orders_page import orders_html
from truebreak.exact import ExactEngine
from truebreak.scenarios import catalogue

HERE = pytest.mark.skipif(found() is None, reason="no chromium here: apt-get install chromium")

MOST_EVENTS = 60
"""Events compared: a verdict and its words are there by then."""

NAMED = (
    "[...document.querySelectorAll('.answers')[0].querySelectorAll('dt')].map((e) => e.firstChild.textContent.trim())"
)
"""What the first answers are called."""

PHONE, DESK = (390, 844), (1280, 800)

QUICK = ("gas", "inscribed", "rack", "near-tie", "drop-pair")
"""Scenes whose pages are unfolded in every test run; those of the others in the slow ones."""

TALLEST = """(async () => {
  const drawn = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  const folds = (root) => [...document.querySelectorAll('details:not(.help)')]
    .filter((fold) => (fold.parentElement.closest('details') ?? null) === root);
  let seen = ['as opened', document.documentElement.scrollHeight];
  const opened = async (root, path) => {
    for (const fold of folds(root)) {
      fold.querySelector('summary').click();
      if (!fold.open) fold.querySelector('summary').click();
      const here = `${path} > ${fold.querySelector('summary').textContent.trim().slice(0, 40)}`;
      await drawn();
      const height = document.documentElement.scrollHeight;
      if (height > seen[1]) seen = [here, height];
      await opened(fold, here);
    }
  };
  const choice = document.getElementById('engine');
  for (const option of choice?.options ?? [null]) {
    if (option) { choice.value = option.value; choice.dispatchEvent(new Event('change')); }
    await opened(null, option?.textContent ?? '');
  }
  return seen;
})()"""
"""The tallest page that a reader comes to by unfolding, whichever engine is played: by what, and its height."""

LARGEST = {"echo": 900_000, "cooling": 720_000}
"""Bytes of the pages over half a megabyte, of a hundred discs and of fifty."""


def made(name: str, events: int | None) -> str:
    """The report of a scene beside the engines of `truebreak compare`."""
    scene = catalogue.build(name)
    limit = events if scene.events is None or events is None else min(events, scene.events)
    return html_report(compare(scene, events=limit), command=f"truebreak compare {name} --html page.html")


@pytest.fixture(scope="module")
def report(request: pytest.FixtureRequest) -> str:
    """The report of a scene's first events, made once: what it takes counts for each test that looks at it."""
    return made(request.param, MOST_EVENTS)


@HERE
@pytest.mark.parametrize("report", catalogue.names(), indirect=True)
def test_verdict_and_answers_stand_on_the_first_screen(browser: Browser, tmp_path: Path, report: str) -> None:
    """And what sticks out, is small, or is found by axe-core, where that is at hand: a page is made and opened once."""
    page = tmp_path / "page.html"
    page.write_text(report, "utf-8")
    browser.media(prefers_reduced_motion="reduce")
    for width, height in (DESK, PHONE):
        browser.size(width, height)
        browser.open(page)
        assert browser.ask(NAMED) == ["Where", "Why", "So what", "What now"]
        assert browser.ask("document.querySelector('.verdict').getBoundingClientRect().top") > 0
        assert browser.ask("document.querySelector('.answers').getBoundingClientRect().bottom") <= height
    assert browser.ask("document.documentElement.scrollHeight") <= 6000
    browser.size(320)
    browser.open(page)
    browser.ask(UNFOLDED)
    assert browser.ask("document.documentElement.scrollWidth") <= 320
    assert browser.ask(CLIPPED) == []
    assert browser.ask(SMALL_TEXT) == []
    assert browser.messages == []
    if AXE.is_file():
        browser.size(*PHONE)
        for scheme in ("light", "dark"):
            browser.media(prefers_color_scheme=scheme)
            browser.open(page)
            browser.ask(UNFOLDED)
            browser.ask(AXE.read_text(encoding="utf-8") + "; 0")
            violations = json.loads(browser.ask("axe.run().then((found) => JSON.stringify(found.violations))"))
            assert [(rule["id"], [node["html"][:120] for node in rule["nodes"][:3]]) for rule in violations] == []


@HERE
@pytest.mark.skipif(not AXE.is_file(), reason="no axe-core here: npm install --prefix tests/compare/report")
def test_axe_is_at_hand() -> None:
    """Or pages of the catalogue are not put to it, as is told by leaving this one out."""


@HERE
@pytest.mark.parametrize(
    "report",
    [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in catalogue.names()],
    indirect=True,
)
def test_no_page_unfolds_to_more_than_6000_pixels_on_a_telephone(browser: Browser, tmp_path: Path, report: str) -> None:
    page = tmp_path / "page.html"
    page.write_text(report, "utf-8")
    browser.media(prefers_reduced_motion="reduce")
    browser.size(*PHONE)
    browser.open(page)
    by_what, height = browser.ask(TALLEST)
    assert height <= 6000, by_what
    browser.ask("dispatchEvent(new Event('beforeprint'))")
    assert browser.ask("[...document.querySelectorAll('details:not(.help)')].every((fold) => fold.open)")
    browser.ask("dispatchEvent(new Event('afterprint'))")
    assert browser.ask("document.documentElement.scrollHeight") <= 6000, "printed, and looked at again"


@HERE
@pytest.mark.parametrize("kind", ["chaos", "orders"])
def test_pages_of_chaos_and_of_all_orders_are_no_longer(browser: Browser, tmp_path: Path, kind: str) -> None:
    """A hundred exponents, and 24 outcomes with their pictures."""
    page, scene = tmp_path / "page.html", catalogue.build("rack:rows=3")
    page.write_text(
        chaos_html(chaos(catalogue.build("gas:n=25"), ["double"], events=60))
        if kind == "chaos"
        else orders_html(scene, all_orders(ExactEngine(), scene)),
        "utf-8",
    )
    browser.media(prefers_reduced_motion="reduce")
    browser.size(*PHONE)
    browser.open(page)
    by_what, height = browser.ask(TALLEST)
    assert height <= 6000, by_what
    browser.ask(UNFOLDED)
    assert browser.ask(CLIPPED) == []


@pytest.mark.parametrize("report", [name for name in catalogue.names() if name not in LARGEST], indirect=True)
def test_a_page_takes_half_a_megabyte_at_most(report: str) -> None:
    assert len(report.encode()) < 500_000


@pytest.mark.parametrize("name", ["gas", *LARGEST])
def test_so_it_does_with_all_events_but_for_the_scenes_of_many_discs(name: str) -> None:
    assert len(made(name, None).encode()) < LARGEST.get(name, 500_000)


def test_a_page_takes_a_part_of_the_time_of_its_comparison() -> None:
    """By a ratio of times of CPU in one run: about a fifth."""
    scene = catalogue.build("gas")
    compare(scene), html_report(compare(scene, events=5))  # what is imported and kept at the first time
    began = time.process_time()
    comparison = compare(scene)
    compared = time.process_time()
    html_report(comparison)
    assert time.process_time() - compared < 0.5 * (compared - began)
