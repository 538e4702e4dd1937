"""What `import truebreak as tb` gives a user: names, short texts and tables."""

from __future__ import annotations

import csv
import io
import sys
from importlib.util import find_spec

import pytest

import truebreak as tb
from truebreak.compare.report.tables import table
from truebreak.scenarios import SceneError


def test_no_name_is_that_of_a_package() -> None:
    """`truebreak.compare` is a package: what compares is `truebreak.comparison`."""
    for name in tb.__all__:
        assert find_spec(f"truebreak.{name}") is None, name
    asked = {"Scene", "Circle", "Wall", "load", "scene", "run", "comparison", "load_run", "__version__"}
    assert asked <= set(tb.__all__)


def test_texts_are_short() -> None:
    scene = tb.scene("gas:n=3")
    run = tb.run(scene, events=3)
    assert str(scene) == "gas:n=3: 3 circles, 4 walls"
    assert str(run) == "gas:n=3 in exact: 3 events; reached the limit on instants (3)"
    assert str(tb.comparison(scene, ["double"], events=3)) == "gas:n=3: double agree"
    told = str(tb.comparison(tb.scene("near-tie:k=40"), ["double", "interval"], events=2))
    assert told.startswith("near-tie:k=40: double diverged at event 0, interval ")
    assert str(tb.Scene([tb.Circle(0, 0)], name="one")) == "one: 1 circle"


def test_tables_hold_what_runs_do() -> None:
    run = tb.run(tb.scene("gas:n=3"), events=4)
    events = table(run)
    assert events["time"] == [float(event.time) for event in run.events]
    assert [float(row["time"]) for row in csv.DictReader(io.StringIO(events.csv()))] == events["time"]
    array = events.numpy()
    assert (array["time"].tolist(), array["contacts"].tolist()) == (events["time"], events["contacts"])
    states = table(run, "states")
    assert len(states.rows) == 4 * 3
    last = run.at(run.events[-1].time)
    assert states["x"][-3:] == [float(circle.x) for circle in last.circles]
    found = tb.comparison(tb.scene("near-tie:k=40"), ["double"], events=2)
    assert table(found).rows == [("double", "diverged", 0, 0, "input rounding")]
    separation = found["double"].separation
    apart = table(separation)
    assert (apart["time"], apart["largest"]) == (list(separation.times), list(separation.largest))
    assert len(table(tb.run(tb.Scene([tb.Circle(0, 0)]), until=1), "states").rows) == 1
    with pytest.raises(SceneError, match="has no table 'verdicts'; it has events, states"):
        table(run, "verdicts")


def test_without_pandas_it_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(SceneError, match="pandas is not installed"):
        table(tb.run(tb.scene("lee"), events=1)).pandas()


def test_with_pandas_it_is_a_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    pandas = pytest.importorskip("pandas")
    frame = table(tb.run(tb.scene("lee"), events=1)).pandas()
    assert isinstance(frame, pandas.DataFrame)
    assert frame["time"].tolist() == [1.0]
