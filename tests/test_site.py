"""The documentation builds as a site: warnings are errors, links within it are checked, and nothing comes from afar."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from truebreak.exact import ExactEngine
from truebreak.scenarios import catalogue

pytest.importorskip("sphinx", reason="no sphinx here: pip install -e '.[docs]'")
pytest.importorskip("myst_parser")
pytest.importorskip("furo")

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "docs" / "site" / "build.py"
sys.path.insert(0, str(BUILD.parent))


def built(out: Path, *arguments: str) -> Path:
    """The site that the command builds."""
    done = subprocess.run(
        [sys.executable, str(BUILD), "--out", str(out), *arguments], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return out / "html"


def every_page_of_the_docs_and_every_scene_is_there(site: Path) -> None:
    for page in (ROOT / "docs").glob("*.md"):
        assert (site / "docs" / f"{page.stem}.html").is_file()
    for name in catalogue.names():
        text = (site / "catalogue" / f"{name}.html").read_text("utf-8")
        assert catalogue.build(name).digest in text
        assert f"{name}.svg" in text
    assert (site / "reports" / "lee.html").read_text("utf-8").startswith("<!DOCTYPE html>")


def the_laws_are_printed_by_sympy(site: Path) -> None:
    from law_forms import FORMS

    text = (site / "laws" / "index.html").read_text("utf-8")
    assert text.count("<math") > 5 * len(FORMS) / 2
    assert all(form.name in text for form in FORMS)
    assert "hat</mi>" not in text
    assert text.count('<mover accent="true">') > 4
    assert "\u2062" not in text and "InvisibleTimes" not in text, "names of several letters run together"


def every_name_of_the_face_is_in_the_api(site: Path) -> None:
    import truebreak

    text = (site / "api" / "truebreak.html").read_text("utf-8")
    assert all(f'id="truebreak.{name}"' in text for name in truebreak.__all__ if not name.startswith("__"))


def no_two_pages_have_one_title(site: Path, tmp_path: Path) -> None:
    from links import same_titles

    assert same_titles(site) == []
    twice = tmp_path / "twice"
    twice.mkdir()
    for name in ("a", "b"):
        (twice / f"{name}.html").write_text("<title>One</title>", "utf-8")
    assert same_titles(twice) == ["a.html, b.html: have one title: One"]


def the_home_page_leads_in_and_shows_every_scene_with_its_verdict(site: Path) -> None:
    from catalogue import verdicts

    text = (site / "index.html").read_text("utf-8")
    assert "pip" in text and "install" in text
    for door in ("README.html#how-to-read-the-report", "docs/your-engine.html", "docs/chaos.html"):
        assert f'href="{door}"' in text
    assert list(verdicts()) == list(catalogue.names())
    for name, (verdict, _) in verdicts().items():
        assert f'href="catalogue/{name}.html"' in text
        moving = (site / "pictures" / f"{name}.svg").read_text("utf-8")
        still = (site / "pictures" / "still" / f"{name}.svg").read_text("utf-8")
        assert f'srcset="pictures/still/{name}.svg"' in text
        assert ("@keyframes" in moving) == (name not in ("article", "beads")), (
            "in those nothing happens after the start"
        )
        assert "@keyframes" not in still
        assert verdict in text
    if (site / "play").is_dir():
        assert all(f'href="play/index.html?scene={name}"' in text for name in verdicts())


def test_the_short_site_is_whole(tmp_path: Path) -> None:
    """One test, since building it takes half a minute, and each worker would."""
    site = built(tmp_path / "site", "--short")
    every_page_of_the_docs_and_every_scene_is_there(site)
    the_laws_are_printed_by_sympy(site)
    every_name_of_the_face_is_in_the_api(site)
    no_two_pages_have_one_title(site, tmp_path)
    the_home_page_leads_in_and_shows_every_scene_with_its_verdict(site)


def test_a_long_formula_is_the_sum_of_its_parts() -> None:
    """Numerator, denominator and radicand put together again are what SymPy derived."""
    from law_proofs import pair_displacement
    from laws import in_parts
    from sympy import simplify

    from truebreak.exact.laws import derivation

    for found in (derivation.pair_times(), derivation.fixed_circle_velocities(), pair_displacement()[2]):
        expressions = found if isinstance(found, tuple) else (found,)
        shown, names = in_parts(expressions)
        assert len(names) > 1
        values = {symbol: expression for expression, symbol in names.items()}
        for formula, expression in zip(shown, expressions, strict=True):
            assert simplify(formula.subs(values).subs(values) - expression) == 0


def test_a_link_that_leads_nowhere_is_found(tmp_path: Path) -> None:
    from links import broken

    (tmp_path / "a.html").write_text('<p id="x"><a href="#x">a</a><a href="b.html#y">b</a></p>', "utf-8")
    (tmp_path / "b.html").write_text('<a href="a.html#x">c</a><a href="https://far.example/">d</a>', "utf-8")
    assert broken(tmp_path) == ["a.html: b.html#y leads to no place in its page"]
    (tmp_path / "b.html").write_text(
        '<i id="y"></i><a href="c.html"></a><img src="https://far.example/x.png">', "utf-8"
    )
    assert broken(tmp_path) == [
        "b.html: loads https://far.example/x.png",
        "b.html: c.html leads to no file",
    ]


@pytest.mark.parametrize(
    ("address", "good"),
    [
        ("https://far.example/a/b-1.html?q=1#x", True),
        ("https://far.example", True),
        ("data:text/plain,x", True),
        ("http://far.example/", False),
        ("https://far/", False),
        ("https:///a", False),
        ("https://far.example/a.", False),
        ("https://far.example/a b", False),
        ("https://far.example)", False),
        ("//far.example/a", False),
        ("javascript:alert(1)", False),
        ("file:///home/someone/a.html", False),
    ],
)
def test_a_foreign_link_is_a_whole_address(address: str, good: bool, tmp_path: Path) -> None:
    from links import broken

    (tmp_path / "a.html").write_text(f'<a href="{address}">a</a>', "utf-8")
    assert broken(tmp_path) == ([] if good else [f"a.html: {address} is no address of another site"])


FRAMES = re.compile(r"@keyframes b(\d+)\{(.*?\})\}")
FRAME = re.compile(r"([\d.]+)%\{transform:translate\(([-\d.]+)px,([-\d.]+)px")


@pytest.mark.parametrize("name", ["gas", "gas-under-gravity", "bounce"])
def test_a_small_picture_shows_the_exact_run(name: str) -> None:
    """Each frame is where the exact run has it: at each event of a disc, between them under gravity, and at the end."""
    from catalogue import MOST_EVENTS, moving_picture

    ran = ExactEngine().run(catalogue.build(name), events=MOST_EVENTS)
    end, pairs = float(ran.final_time), {0: list[tuple[float, float]](), 1: list[tuple[float, float]]()}
    found = FRAMES.findall(moving_picture(name))
    assert len(found) == len(ran.scene.circles)
    for body, text in found:
        frames = [tuple(map(float, frame)) for frame in FRAME.findall(text)]
        shares, places = [frame[0] for frame in frames], {str(c.id): k for k, c in enumerate(ran.scene.circles)}
        mine = [float(e.time) for e in ran.events if int(body) in {places.get(n) for pair in e.impulses for n in pair}]
        assert shares[0] == 0 and shares[-1] == 100
        assert all(min(abs(100 * time / end - share) for share in shares) < 1e-3 for time in mine)
        states = ran.sample([min(share * end / 100, end) for share in shares])[:, int(body)]
        for state, (_, x, y) in zip(states, frames, strict=True):
            pairs[0].append((state[0], x))
            pairs[1].append((state[1], -y))
    for way in filter(lambda way: max(way)[0] > min(way)[0], pairs.values()):
        (low, first), (high, last) = min(way), max(way)
        scale = (last - first) / (high - low)
        assert scale > 0
        assert [pixel for _, pixel in way] == pytest.approx([first + (at - low) * scale for at, _ in way], abs=0.4)


@pytest.mark.parametrize("name", ["lee", "near-tie", "cradle"])
def test_the_verdicts_of_the_gallery_are_current(name: str) -> None:
    """The whole site's build compares all of them."""
    from catalogue import report, verdicts

    found = report(name)
    assert verdicts()[name] == [found.verdict, found.tone]


@pytest.mark.slow
def test_the_whole_site_builds(tmp_path: Path) -> None:
    site = built(tmp_path)
    assert all((site / "reports" / f"{name}.html").is_file() for name in catalogue.names())
