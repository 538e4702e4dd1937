"""Reports: the HTML file, the pictures, the sentences."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import pytest
from tags import tags

from truebreak.compare import compare
from truebreak.compare.comparison import Comparison
from truebreak.compare.picture import engine_styles
from truebreak.compare.report.html import html_report
from truebreak.compare.report.plot import separation_plot, ticks
from truebreak.compare.report.sentences import verdict_sentence
from truebreak.compare.report.terminal import side_by_side
from truebreak.scenarios import Circle, Scene, Wall, catalogue
from truebreak.scenarios.pictures import scene_picture


@pytest.fixture(scope="module")
def gas() -> Comparison:
    return compare(catalogue.build("gas"), events=200)


def test_the_report_is_one_file_without_resources(gas: Comparison) -> None:
    page = html_report(gas)
    assert tags(page).open == []
    assert tags(page).resources == []
    assert not re.search(r"@import|url\(", page)
    assert verdict_sentence(gas) in page.replace("\N{NO-BREAK SPACE}", " ")
    assert page.count("<svg") >= 1 + sum(c.verdict == "diverged" for c in gas.candidates)


def test_the_report_escapes_what_scenes_say() -> None:
    scene = Scene(
        [Circle(0, 0, vx=1, id="<b>&"), Circle(9, "1/3", id='"q"')],
        [Wall(20, 0, 20, 1, id="</svg>")],
        name="<script>alert(1)</script>",
        source="<i>",
    )
    page = html_report(compare(scene, ["double", "pymunk"], until=40))
    assert "<script>" not in page
    assert "<b>&<" not in page
    assert "&lt;script&gt;" in page
    assert tags(page).open == []


@pytest.mark.parametrize("text", ["cradle", "rack:rows=3", "inscribed", "lorentz", "pinball", "galperin", "point"])
def test_every_kind_of_scene_is_drawn(text: str) -> None:
    root = ElementTree.fromstring(scene_picture(catalogue.build(text), standalone=True))
    assert root.tag.endswith("svg")
    assert "nan" not in scene_picture(catalogue.build(text))


def test_the_plot_has_a_line_for_each_engine(gas: Comparison) -> None:
    plot = ElementTree.fromstring(separation_plot(gas))
    lines = [e for e in plot.iter() if e.tag.endswith("polyline")]
    assert len(lines) == 3
    assert [line.get("class") for line in lines] == [f"series e{k}" for k in range(3)]
    assert len({style.dash for style in engine_styles([c.engine for c in gas.candidates])}) == 3


def test_ticks_are_round() -> None:
    assert ticks(7.0) == [0.0, 2.0, 4.0, 6.0]
    assert ticks(0.03) == [0.0, 0.005, 0.01, 0.015, 0.02, 0.025, 0.03]


def test_a_time_step_is_not_called_floating_point() -> None:
    comparison = compare(catalogue.build("gas"), ["double", "pymunk"], events=40)
    assert comparison["double"].verdict == "agree"
    assert verdict_sentence(comparison).startswith("The time step changed what happened: double agrees, but pymunk")


def test_agreement_is_said_with_the_number_of_events() -> None:
    comparison = compare(catalogue.build("cradle"), ["double"])
    assert verdict_sentence(comparison) == (
        "Floating point did not change what happened: double agrees with the exact run in all 60 events."
    )


def test_a_scene_where_nothing_happens_is_reported() -> None:
    comparison = compare(Scene([Circle(0, 0)]))
    assert comparison.verdict == "agree"
    assert html_report(comparison)


def test_side_by_side_marks_the_first_difference(gas: Comparison) -> None:
    candidate = gas["double"]
    rows = side_by_side(gas, candidate)
    assert [row.differs for row in rows].count(True) == 1
    marked = next(row for row in rows if row.differs)
    assert marked.expected != marked.got
    divergence = candidate.alignment.divergence
    assert divergence is not None
    assert (marked.expected, marked.got) == (divergence.expected, divergence.got)


def test_after_a_reversal_the_report_says_how_far_each_misses_the_start() -> None:
    scene = catalogue.build("gas").with_changes(reverse_after=40, events=None, until=None)
    comparison = compare(scene, ["double"])
    assert comparison.return_miss == 0
    miss = comparison["double"].return_miss
    assert miss is not None
    assert 1e-16 < miss < 10
    assert "misses the start by" in html_report(comparison)
