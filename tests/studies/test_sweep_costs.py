"""What a sweep costs beside a loop over `compare`: each way is measured, workers included."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
import sweep_costs

from truebreak.compare.grids.store import Store


def test_the_cost_of_each_way_is_told(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweep_costs, "EVENTS", 5)
    assert sweep_costs.main(["--scenes", "2"]) == 0
    told = capsys.readouterr().out
    assert [line.split("|")[1].strip() for line in told.splitlines() if line.startswith("| ")] == [
        "way",
        *sweep_costs.WAYS,
    ]
    assert "in 2 turns" in told and "% of what two separate processes reach" in told
    with pytest.raises(SystemExit) as stop:
        sweep_costs.main(["--scenes", "0"])
    assert stop.value.code == 2


def test_the_time_of_workers_that_have_ended_is_counted() -> None:
    """A child that works for as long as this on its processor, while we wait."""
    code = "import time\nwhile time.process_time() < 0.3: pass"
    spent = sweep_costs.cost(lambda: subprocess.run([sys.executable, "-S", "-c", code], check=True))
    assert spent.processor >= 0.3


def test_going_on_with_a_store_and_reading_it_are_measured(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = str(tmp_path / "rows.db")
    asked = sweep_costs.filled(path, 40)
    store = Store(path)
    assert len(store) == 40
    assert store.scenes == 20
    assert {row.scene for row in store} == {f"gas:n=3,seed={seed}" for seed in range(1, 21)}
    assert asked[2] == "seed=1..21"
    assert sweep_costs.main(["--store", "40"]) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[0].startswith("A store of 40 rows")
    for line in told[4:]:
        seconds, megabytes = (float(each) for each in line.split("|")[2:4])
        assert 0 < seconds < 60
        assert 10 < megabytes < 500
    assert len(told) == 7
