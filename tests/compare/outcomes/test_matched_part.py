"""A run that stopped early is held against as much of the reference as it has told."""

from __future__ import annotations

from typing import Any

import pytest

from truebreak.compare.comparison import compare
from truebreak.scenarios import catalogue


@pytest.mark.parametrize("spec", ["gas:n=4", "rack:rows=2", "reversal", "galperin:n=1"])
def test_what_an_undecided_engine_told_is_not_called_changed(spec: str) -> None:
    found = compare(catalogue.build(spec), ["interval"], causes=False)
    candidate = found["interval"]
    assert candidate.verdict == "undecided"
    assert candidate.outcomes["collisions"] < found.outcomes["collisions"]
    assert candidate.changed == ()


def test_what_it_told_otherwise_is() -> None:
    """An outcome of the events themselves, told otherwise by an engine that then stops."""

    def told(run: Any) -> Any:
        return [run.engine == "interval" and len(run.events) > 1, len(run.events)]

    found = compare(catalogue.build("gas:n=4"), ["interval"], causes=False, outcomes={"told": told})
    assert found["interval"].verdict == "undecided"
    assert found["interval"].changed == ("told",)


@pytest.mark.parametrize(("spec", "engine"), [("drop-pair", "pymunk"), ("gas:n=4", "single"), ("lorentz", "single")])
def test_after_a_divergence_a_collision_counts_by_its_own_time(spec: str, engine: str) -> None:
    """Whatever one of its bodies comes to after the end in the reference: the other has parted from it before."""
    found = compare(catalogue.build(spec), [engine])
    (candidate,) = found.candidates
    assert candidate.verdict == "diverged"
    assert candidate.outcomes is not None
    end = found.reference.final_time
    assert candidate.outcomes["collisions"] == sum(
        len(event.impulses) for event in candidate.trajectory.events if float(event.time) <= float(end)
    )
