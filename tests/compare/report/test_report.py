"""Reports: the HTML file, the pictures, the sentences."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from xml.etree import ElementTree

import pytest
from tags import tags

from truebreak.compare import compare
from truebreak.compare.comparison import Comparison
from truebreak.compare.picture import engine_styles
from truebreak.compare.report.answers import verdict_line
from truebreak.compare.report.charts import NARROW, WIDE, error_plot, errors_shown, ticks
from truebreak.compare.report.html import html_report
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
    assert verdict_line(gas) in page.replace("\N{NO-BREAK SPACE}", " ")
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
    plot = ElementTree.fromstring(error_plot(gas))
    lines = [e for e in plot.iter() if e.tag.endswith("polyline")]
    assert len(lines) == 3
    assert [line.get("class") for line in lines] == [f"series e{k}" for k in range(3)]
    assert len({style.dash for style in engine_styles([c.engine for c in gas.candidates])}) == 3


def test_the_plot_has_a_floor_a_line_at_one_radius_and_names_at_the_lines(gas: Comparison) -> None:
    """No line falls to where the logarithm of zero would be; every text lies within the picture."""
    for width in (WIDE, NARROW):
        plot = ElementTree.fromstring(error_plot(gas, width))
        (floor,) = [float(e.get("y1", "")) for e in plot.iter() if e.get("class") == "floor"]
        (radius,) = [float(e.get("y1", "")) for e in plot.iter() if e.get("class") == "radius"]
        heights = [
            float(point.split(",")[1])
            for e in plot.iter()
            if e.tag.endswith("polyline")
            for point in e.get("points", "").split()
        ]
        assert radius < floor
        assert max(heights) <= floor + 0.06
        assert 0.0 in gas["double"].separation.largest
        names = [e.text for e in plot.iter() if e.tag.endswith("text") and e.text in {c.engine for c in gas.candidates}]
        assert len(names) == (3 if width == WIDE else 0)


def test_lines_that_lie_on_each_other_are_marked_and_share_a_name(gas: Comparison) -> None:
    twin = replace(gas["double"], engine="twin")
    plot = ElementTree.fromstring(error_plot(replace(gas, candidates=(gas["double"], twin))))
    assert "double = twin" in [e.text for e in plot.iter() if e.tag.endswith("text")]
    assert len([e for e in plot.iter() if e.tag.endswith("rect") and e.get("class") == "dot e1"]) > 3
    alone = ElementTree.fromstring(error_plot(gas))
    assert not [e for e in alone.iter() if e.tag.endswith("rect") and "dot" in e.get("class", "")]


def test_errors_go_on_as_far_as_the_runs_are_shown() -> None:
    """After the last event both runs fly on for ever, at other velocities: the error grows without a bound."""
    found = compare(catalogue.build("near-tie"), ["double"])
    errors = errors_shown(found, found["double"])
    assert found["double"].separation.times[-1] <= 1 < errors.times[-1] == pytest.approx(1.25)
    mine, theirs = (run.final.array()[:, 2:] for run in (found.reference, found["double"].trajectory))
    apart = 0.25 * max(math.dist(a, b) for a, b in zip(mine, theirs, strict=True))
    assert errors.final == pytest.approx(apart, rel=1e-9)
    assert "growing" in html_report(found)


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
