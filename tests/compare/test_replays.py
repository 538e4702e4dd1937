"""Numbers of a run that a command asks for come of one replay of its log, or not much more: counted steps."""

from __future__ import annotations

import pickle
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import pytest

from truebreak.compare import compare
from truebreak.compare.grids.family_sweep import SweepJob
from truebreak.compare.report.documents import comparison_json
from truebreak.compare.report.html import html_report
from truebreak.compare.shadowing.shadows import shadow
from truebreak.compare.testing.check import check
from truebreak.exact import ExactEngine
from truebreak.exact.simulation import decider
from truebreak.scenarios import catalogue

MOST = 2
"""Steps that are replayed for the numbers of a run, over the steps of its log."""

GAS = catalogue.build("gas")


@pytest.fixture
def replayed(monkeypatch: pytest.MonkeyPatch) -> Callable[[], list[float]]:
    """For each log so far, the steps that were replayed over those that it has."""
    logs: dict[int, Sequence[Any]] = {}
    counted: Counter[int] = Counter()
    true = decider.replay

    def replay(state: Any, steps: Sequence[Any], needed: Iterable[int]) -> None:
        needed = list(needed)
        logs[id(steps)] = steps
        counted[id(steps)] += len(needed)
        true(state, steps, needed)

    monkeypatch.setattr(decider, "replay", replay)
    return lambda: [count / len(logs[key]) for key, count in counted.items()]


@pytest.mark.parametrize(
    "command",
    [
        lambda: compare(GAS, ["double"]),
        lambda: compare(catalogue.build("rack:rows=5")),
        lambda: compare(catalogue.build("reversal")),
        lambda: compare(GAS, ["double", "interval"], causes=False),
        lambda: comparison_json(compare(GAS, ["double"], causes=False)),
        lambda: html_report(compare(GAS, ["double"], events=100)),
        lambda: check("double", GAS),
        lambda: shadow(GAS, "double", events=40),
        lambda: SweepJob(0, "gas:seed=3", {}, ("double",), 200).rows(),
    ],
    ids=["compare", "rack", "reversal", "two engines", "json", "html", "check", "shadow", "sweep"],
)
def test_a_command_replays_a_log_not_much_more_than_once(
    command: Callable[[], object], replayed: Callable[[], list[float]]
) -> None:
    command()
    assert max(replayed(), default=0.0) <= MOST


def test_places_beside_every_event_are_had_in_one_replay(replayed: Callable[[], list[float]]) -> None:
    """Of all circles, and asked for twice; one circle after the other would replay the log once for each.

    Of a run that has its events at hand, whose times tell; of one that was pickled, by a replay.
    """
    made = ExactEngine().run(GAS, events=120)
    run = pickle.loads(pickle.dumps(made))
    times = [float(event.time) * (1 + 2.0**-52) for event in run.events[:-1]]
    once = run.sample(times)
    assert run.sample(times).tolist() == once.tolist()
    assert 0 < max(replayed()) <= 1
    before = replayed()
    assert made.sample(times).tolist() == once.tolist()
    assert replayed() == before
    for k in (0, 57, 118):
        assert [[float(v) for v in (c.x, c.y, c.vx, c.vy)] for c in run.at(times[k]).circles] == pytest.approx(once[k])
