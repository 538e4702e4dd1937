"""One scene in many guises has one history, whatever there is in it; a fault of predictions is found."""

from __future__ import annotations

from collections import Counter

import guise_campaign
import pytest
from mpmath import mp

from truebreak.exact.replay.contact import Sides
from truebreak.exact.simulation import arc_meetings


@pytest.fixture(autouse=True)
def _digits(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(mp, "dps", 60)


def test_a_scene_has_one_history_in_every_guise() -> None:
    counts = Counter[str]()
    found = [line for seed in range(60) for line in guise_campaign.examined(seed, counts)]
    assert found == []
    assert all(counts[kind] > 10 for kind in ("velocity", "mirror", "turned", "units", "order", "later", "intervals"))
    assert counts["events"] > 150


def _no_order(monkeypatch: pytest.MonkeyPatch) -> None:
    """What stands is not looked for by what comes after it."""
    plain = arc_meetings.predict_falls
    monkeypatch.setattr(
        "truebreak.exact.certified.filtered_arcs.predict_falls",
        lambda predictor, moved, *rest: plain(predictor, [a for a in moved if a.index], *rest),
    )


def _sides_of_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    """Gravity is taken for its size alone."""
    plain = Sides.pull
    monkeypatch.setattr(Sides, "pull", lambda self, circle, wall: -abs(plain(self, circle, wall)))


@pytest.mark.parametrize("fault", [_no_order, _sides_of_the_page])
def test_a_planted_fault_is_found(fault, monkeypatch: pytest.MonkeyPatch) -> None:
    fault(monkeypatch)
    counts = Counter[str]()
    with pytest.raises(AssertionError):
        for seed in range(120):
            assert not list(guise_campaign.examined(seed, counts))
