"""What the way out proves of the way back, and what not: a limit beside an event by less than bits tell."""

from __future__ import annotations

import pytest

from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Scene

ALONG, ACROSS = Circle(5, 0, id="b"), Circle(4, 1, id="b")


@pytest.mark.parametrize(("other", "met"), [(ALONG, "3"), (ACROSS, "4 - sqrt(3)")])
@pytest.mark.parametrize(
    ("beside", "events"),
    [("-1/10**20", 1), ("-1/10**400", 1), ("0", 2), ("1/10**400", 2), ("1/10**20", 2)],
)
def test_a_limit_beside_the_second_meeting_is_told_from_one_at_it(
    other: Circle, met: str, beside: str, events: int
) -> None:
    """The two meet, turn back at 5, and meet again as long after that as before."""
    scene = Scene([Circle(0, 0, vx=1, id="a"), other], reverse_at=5)
    run = ExactEngine().run(scene, until=f"10 - ({met}) + ({beside})")
    assert len(run.events) == events
    assert run.reversal is not None
