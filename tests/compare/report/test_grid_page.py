"""The page of a grid in a real browser: filters, sorting, a row's figures; nothing overflows; a thousand rows."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest
from browser import Browser, found
from test_browser import UNFOLDED

from truebreak.compare.cli import main
from truebreak.compare.grids import survival
from truebreak.compare.grids.row import Row
from truebreak.compare.report.grid_page import grid_page

HERE = pytest.mark.skipif(found() is None, reason="no chromium here: apt-get install chromium")

AXE = Path(__file__).parent / "node_modules" / "axe-core" / "axe.min.js"


def called(*words: str) -> int | str | None:
    """The exit code of a command line."""
    with pytest.raises(SystemExit) as stop:
        main(list(words))
    return stop.value.code


EVIL = "</script><img src=x onerror=alert(1)>"


def rows(scenes: int) -> list[Row]:
    """Two engines: one that diverges at event k of scene k, but for every third, and one that agrees."""
    told: list[Row] = []
    for k in range(scenes):
        name = f"gas:n=3,seed={k}"
        left = {} if k % 3 == 0 else {"event": k, "body": "c1", "expected": "top", "got": "c2", "kind": "different"}
        verdict = "agree" if k % 3 == 0 else "diverged"
        kept = {"kept": True, "finding": ""}
        told.append(Row(k, name, "single", verdict, agreed=k, events=scenes, laws=kept, **left))
        told.append(Row(k, name, "pymunk:dt=1/64", "agree", agreed=scenes, events=scenes))
    return told


@pytest.fixture
def page(tmp_path: Path) -> Path:
    return tmp_path / "page.html"


def shown(browser: Browser) -> list[str]:
    return browser.ask("[...document.querySelectorAll('#grid tbody th')].map(head => head.textContent)")


@HERE
def test_scenes_are_filtered_and_sorted(browser: Browser, page: Path) -> None:
    page.write_text(grid_page("Gases", rows(30)), "utf-8")
    browser.open(page)
    assert shown(browser) == [f"gas:n=3,seed={k}" for k in range(30)]
    browser.ask("(text.value = 'seed=2', text.dispatchEvent(new Event('input')), 0)")
    assert shown(browser) == [f"gas:n=3,seed={k}" for k in (2, *range(20, 30))]
    browser.ask("(state.value = 'diverged', state.dispatchEvent(new Event('input')), 0)")
    assert shown(browser) == [f"gas:n=3,seed={k}" for k in (2, *range(20, 30)) if k % 3]
    assert browser.ask("count.textContent") == "8 of 30 scenes"
    browser.ask("(engine.value = 'pymunk:dt=1/64', engine.dispatchEvent(new Event('input')), 0)")
    assert shown(browser) == [], "it diverges nowhere"
    browser.ask("(state.value = '', state.dispatchEvent(new Event('input')), 0)")
    assert len(shown(browser)) == 11
    assert browser.ask("document.querySelectorAll('#grid tbody tr:first-child td').length") == 1
    browser.ask("(engine.value = '', engine.dispatchEvent(new Event('input')), 0)")
    browser.ask("(state.value = 'diverged', state.dispatchEvent(new Event('input')), 0)")
    for expected in (1, -1):
        browser.click("#grid thead button[data-engine=single]")
        assert shown(browser) == [f"gas:n=3,seed={k}" for k in (2, *range(20, 30)) if k % 3][::expected]
    assert browser.ask("document.querySelectorAll('th[aria-sort]').length") == 1


@HERE
def test_a_row_is_one_click_away(browser: Browser, page: Path) -> None:
    told = rows(4)
    page.write_text(grid_page("Gases", told, links={told[2].pair: "page-reports/1-single.html"}), "utf-8")
    browser.open(page)
    assert browser.ask("document.querySelector('tbody td a').getAttribute('href')") == "page-reports/1-single.html"
    browser.click("tbody tr:nth-child(2) td button")
    text = browser.ask("document.querySelector('dialog[open]').innerText")
    assert "differs at event\n1" in text and "should meet\ntop" in text
    assert browser.ask("document.querySelector('dialog a').getAttribute('href')") == "page-reports/1-single.html"
    browser.click("dialog form button")
    browser.click("tbody tr:nth-child(3) td button")
    text = browser.ask("document.querySelector('dialog[open]').innerText")
    assert "truebreak compare gas:n=3,seed=2 --engines single --html report.html" in text


@HERE
@pytest.mark.parametrize("width", [1280, 390, 320])
def test_nothing_overflows(browser: Browser, page: Path, width: int) -> None:
    long = Row(99, "gas:" + ",".join(f"n{k}=1/3" for k in range(30)), "pymunk:max_steps=300000,iterations=10", "failed")
    page.write_text(grid_page("Gases", [*rows(9), long], changes={long.pair: "is new"}), "utf-8")
    browser.size(width)
    browser.open(page)
    assert browser.ask("document.documentElement.scrollWidth") <= width
    browser.click("tbody tr:last-child td button")
    left, right = browser.ask("(b => [b.left, b.right])(document.querySelector('dialog').getBoundingClientRect())")
    assert left >= 0 and right <= width


@HERE
def test_a_thousand_rows_are_drawn_within_a_few_of_ten(browser: Browser, page: Path) -> None:
    """By a ratio of two drawings in one run: the time goes with the rows, and not with their square."""

    def drawn(scenes: int) -> float:
        page.write_text(grid_page("Gases", rows(scenes)), "utf-8")
        browser.open(page)
        turns = "Array.from({length: 9}, () => { const b = performance.now(); draw(); return performance.now() - b; })"
        return sorted(browser.ask(f"{turns}.sort((a, b) => a - b)"))[4]

    few, many = drawn(100), drawn(1000)
    assert many <= 60 * max(few, 0.5)


@pytest.mark.parametrize(("count", "total"), [(1, 3), (10, 30), (333, 1000), (99_999, 100_000)])
def test_intervals_take_a_dozen_steps(count: int, total: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A page of a thousand scenes has thousands of them: halving the interval took half a minute."""
    whole = survival.proportion(count, total)
    monkeypatch.setattr(survival, "BISECTIONS", 12)
    assert survival.proportion(count, total) == pytest.approx(whole, rel=1e-12)


@HERE
@pytest.mark.skipif(not AXE.is_file(), reason="no axe-core here: npm install --prefix tests/compare/report")
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1280, 390])
def test_axe_finds_nothing_and_no_text_is_small(browser: Browser, page: Path, scheme: str, width: int) -> None:
    told = rows(12)
    page.write_text(grid_page("Gases", told, links={told[2].pair: "r.html"}, changes={told[0].pair: "is new"}), "utf-8")
    browser.media(prefers_color_scheme=scheme)
    browser.size(width)
    browser.open(page)
    browser.ask(UNFOLDED)
    browser.ask(AXE.read_text(encoding="utf-8") + "; 0")
    told_by_axe = browser.ask("axe.run().then((found) => JSON.stringify(found.violations.map((rule) => rule.id)))")
    assert json.loads(told_by_axe) == []
    sizes = "[...document.querySelectorAll('body *')].map((e) => parseFloat(getComputedStyle(e).fontSize))"
    assert min(browser.ask(sizes)) >= 9


@HERE
def test_each_heading_is_explained_in_two_sentences(browser: Browser, page: Path) -> None:
    page.write_text(grid_page("Gases", rows(3)), "utf-8")
    browser.open(page)
    told = browser.ask(
        "[...document.querySelectorAll('h2')].map((h) => h.parentElement.querySelector('.help p')?.textContent)"
    )
    assert len(told) == 2
    assert all(len(re.findall(r"[.](?: |$)", text or "")) == 2 for text in told)


@HERE
def test_what_a_scene_is_called_runs_nowhere(browser: Browser, page: Path) -> None:
    page.write_text(grid_page(EVIL, [Row(0, EVIL, EVIL, "diverged", note=EVIL)], changes={(EVIL, EVIL): EVIL}), "utf-8")
    browser.open(page)
    browser.click("tbody td button")
    assert browser.ask("document.querySelectorAll('img').length") == 0
    assert shown(browser) == [EVIL]


class Outside(HTMLParser):
    """What a page loads from elsewhere."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found += [str(value) for key, value in attrs if key == "src" or (tag == "link" and key == "href")]


def test_the_page_needs_nothing_else_and_says_its_figures() -> None:
    text = grid_page("Gases", rows(30))
    reader = Outside()
    reader.feed(text)
    assert reader.found == []
    assert "<td>10: 33.3% (17.3% to 52.8%)</td>" in text, "Clopper and Pearson, for 10 of 30"
    assert "<td>30: 100.0% (88.4% to 100.0%)</td>" in text
    assert "<td>not reached</td>" in text


@pytest.mark.parametrize("laws", [None, {"kept": None, "finding": "not determined"}])
def test_an_engine_of_which_no_law_is_known_has_its_row(laws: dict[str, object] | None) -> None:
    text = grid_page("One", [Row(0, "lee", "box2d", "diverged", event=0, agreed=0, events=1, laws=laws)])
    assert "1 scene, 1 engine: 0 of 1 row agree, 1 diverged." in text


def test_a_suite_writes_its_page_and_the_reports_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("s.toml").write_text(
        'engines = ["double"]\ncauses = false\n[[scene]]\nname = "lee"\n[[scene]]\nname = "near-tie"\n'
    )
    words = ["suite", "s.toml", "--jobs", "1", "--exit-zero"]
    for more in (["--html", "p.html", "--reports"], ["--json"]):
        with pytest.raises(SystemExit) as stop:
            main([*words, *more])
        assert not stop.value.code
    assert '"link":"p-reports/1-double.html"' in Path("p.html").read_text("utf-8")
    assert [path.name for path in Path("p-reports").iterdir()] == ["1-double.html"]
    for odd, said in ((["--reports"], "add --html FILE"), (["--html", "nowhere/p.html"], "there is no folder")):
        capsys.readouterr()
        with pytest.raises(SystemExit) as stop:
            main([*words, *odd])
        assert stop.value.code == 2
        assert said in capsys.readouterr().err


def test_what_changed_since_an_earlier_store_is_a_column_of_a_sweep(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The earlier store is of a longer run: what has no row now is counted, what diverges elsewhere is said."""
    before, html = str(tmp_path / "before.db"), str(tmp_path / "page.html")
    asked = ["sweep", "gas:n=3", "--vary", "seed=1..2", "--engines", "single", "--jobs", "1"]
    assert called(*asked, "--events", "3", "--store", before) == 0
    assert called(*asked, "--events", "40", "--html", html, "--against", before) == 0
    told = json.loads(re.findall(r'<script id="data"[^>]*>(.*?)</script>', Path(html).read_text("utf-8"), re.S)[0])
    assert told["changed"]
    assert [row["since"].partition(": ")[2] for row in told["rows"]] == [
        f"agreed, 3 of 3 events before, diverged at event {row['event']} now" for row in told["rows"]
    ]
    assert "Since the earlier grid 2 of 2 rows changed." in Path(html).read_text("utf-8")
    capsys.readouterr()
    for words, said in (
        (["--against", before], "--against is a column of a page: add --html FILE"),
        (["--html", html, "--against", before, "--store", before], "take a copy of before"),
        (["--html", html, "--against", f"{before}x"], "there is no such file; name one that --store has written"),
    ):
        assert called(*asked, "--events", "3", *words) == 2
        assert said in " ".join(capsys.readouterr().err.split())


def test_a_store_of_another_kind_of_grid_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before, html = str(tmp_path / "before.db"), str(tmp_path / "page.html")
    assert called("sweep", "lee", "--vary", "tie=simultaneous", "--jobs", "1", "--store", before) == 0
    capsys.readouterr()
    short = ["stress", "near-ties", "--levels", "4..4", "--engines", "double", "--jobs", "1", "--html", html]
    assert called(*short, "--against", before) == 2
    assert "is a store of a sweep; name one of a stress" in capsys.readouterr().err
