"""What a notebook shows of a scene, a run and a comparison: well-formed tables of what they hold."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree

import pytest

import truebreak as tb


def cells(shown: Any) -> tuple[str, list[list[str]]]:
    """The caption and the rows of a table; every row fills it."""
    table = ElementTree.fromstring(shown._repr_html_())
    assert table.tag == "table"
    rows = [["".join(cell.itertext()) for cell in row] for row in table.iter("tr")]
    width = [sum(int(cell.get("colspan", "1")) for cell in row) for row in table.iter("tr")]
    assert len(set(width)) == 1
    return str(table.findtext("caption")), rows


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
