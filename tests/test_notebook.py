"""What a notebook shows of a scene, a run and a comparison: well-formed tables of what they hold."""

from __future__ import annotations

import base64
import html
import re
from typing import Any
from xml.etree import ElementTree

import pytest

import truebreak as tb


def cells(shown: Any) -> tuple[str, list[list[str]]]:
    """The caption and the rows of a table; every row fills it."""
    made = re.fullmatch(r"<div>(<table>.*</table>)(<img[^>]*>)?</div>", shown._repr_html_(), re.DOTALL)
    assert made is not None
    table = ElementTree.fromstring(made[1])
    rows = [["".join(cell.itertext()) for cell in row] for row in table.iter("tr")]
    width = [sum(int(cell.get("colspan", "1")) for cell in row) for row in table.iter("tr")]
    assert len(set(width)) == 1
    return str(table.findtext("caption")), rows


def drawn(shown: Any) -> tuple[str, str]:
    """The words for the picture, and its SVG, which is well-formed."""
    found = re.search(r'<img alt="([^"]*)" src="data:image/svg\+xml;base64,([^"]*)">', shown._repr_html_())
    assert found is not None
    text = base64.b64decode(found[2]).decode()
    ElementTree.fromstring(text)
    return html.unescape(found[1]), text


def test_each_has_a_picture() -> None:
    scene = tb.scene("near-tie:k=40")
    found = tb.comparison(scene, ["double"], causes=False)
    told, picture = drawn(scene)
    assert told == "near-tie:k=40 at time 0"
    assert picture.count("<circle") == 3
    told, picture = drawn(found.reference)
    assert told == f"near-tie:k=40 at time {float(found.reference.final_time):.9g}"
    assert picture.count("<circle") == 3
    told, picture = drawn(found)
    assert told == str(found)
    assert picture.count("<circle") == 6
    assert ".e0 {" in picture
    _, picture = drawn(tb.comparison(tb.scene("cradle"), ["double"], causes=False))
    assert "at time 0" in picture


def test_a_crowd_has_none() -> None:
    assert "<img" not in tb.scene("gas:n=501")._repr_html_()


def test_a_scene_shows_its_circles_exactly() -> None:
    scene = tb.Scene(
        [tb.Circle(0, "sqrt(2)", vx="1/3", id="<b>&"), tb.Circle(9, 0, m="oo")], [tb.Wall(-5, 0, -5, 1)], name="a < b"
    )
    caption, rows = cells(scene)
    assert caption == "a < b: 2 circles, 1 wall; simultaneous"
    assert rows[0] == ["id", "x", "y", "r", "vx", "vy", "m"]
    assert rows[1:] == [["<b>&", "0", "sqrt(2)", "1", "1/3", "0", "1"], ["c2", "9", "0", "1", "0", "0", "oo"]]


def test_a_run_shows_its_events() -> None:
    run = tb.run(tb.scene("lee"))
    caption, rows = cells(run)
    assert caption == f"lee in exact: {len(run.events)} events, {run.stop.message}"
    assert rows[1] == ["0", "1.0", "left and middle, middle and right"]


@pytest.mark.parametrize("count", [20, 21, 40])
def test_what_is_left_out_is_counted(count: int) -> None:
    _, rows = cells(tb.run(tb.scene("gas"), events=count))
    assert rows[21:] == ([] if count == 20 else [[f"and {count - 20} more"]])
    assert [row[0] for row in rows[1:21]] == [str(k) for k in range(20)]


def test_a_comparison_shows_each_verdict() -> None:
    found = tb.comparison(tb.scene("near-tie:k=40"), ["double"])
    caption, rows = cells(found)
    assert caption == f"{found.scene.name}: diverged"
    assert [row[:2] for row in rows[1:]] == [["exact", "reference"], ["double", "diverged"]]
    parted = found["double"].alignment.divergence
    assert parted is not None
    assert rows[2][3:] == [f"event {parted.event}", str(found["double"].diagnosis)]
