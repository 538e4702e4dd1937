"""Past the certified horizon nothing is required of the history, but every step still keeps the laws."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import pytest
from bugs import BUGS, Planted

from truebreak.compare import engine
from truebreak.compare.foreign import Recording
from truebreak.compare.testing.check import CheckFailed, check
from truebreak.compare.tolerances.errors_grown import UNSEEN, local_error
from truebreak.floating import DoubleEngine, PymunkEngine
from truebreak.scenarios import Circle, Declared, Scene, Trajectory, Wall, catalogue

FAR = 130
"""An event of `gas` that is beyond the reach of doubles, which ends at 110."""

Rows = dict[str, tuple[float, float, float, float]]


@dataclass(frozen=True)
class Retold(Declared):
    """Doubles, all told again, but for one event of which something else is told."""

    event: int
    told: Callable[[Recording, Any, Rows], None]
    name: str = "retold"
    bits: int | None = 53
    rounds_input: bool = True

    def run(self, scene: Scene, **limits: Any) -> Trajectory:
        """The run of doubles, recorded again."""
        run = DoubleEngine().run(scene, **limits)
        recording = Recording(scene, self.name)
        for event in run.events:
            rows = {c.id: (float(c.x), float(c.y), float(c.vx), float(c.vy)) for c in run.at(event.time).circles}
            if event.index == self.event:
                self.told(recording, event, rows)
            else:
                recording.hits(float(event.time), event.impulses, rows)
        recording.end()
        return replace(recording.trajectory(), stop=run.stop)


def honest(recording: Recording, event: Any, rows: Rows) -> None:
    """What happened."""
    recording.hits(float(event.time), event.impulses, rows)


def phantom(recording: Recording, event: Any, rows: Rows) -> None:
    """What happened, and a meeting of two that are nowhere near each other."""
    names = sorted(rows, key=lambda name: rows[name][0])
    recording.hits(float(event.time), [*event.impulses, (names[0], names[-1])], rows)


def crooked(recording: Recording, event: Any, rows: Rows) -> None:
    """Two discs leave each other in a direction turned by 20 degrees: energy and momentum are kept."""
    (pair,) = event.impulses
    (_, _, ax, ay), (_, _, bx, by) = rows[pair.first], rows[pair.second]
    mx, my, rx, ry = (ax + bx) / 2, (ay + by) / 2, (bx - ax) / 2, (by - ay) / 2
    cos, sin = math.cos(math.radians(20)), math.sin(math.radians(20))
    tx, ty = cos * rx - sin * ry, sin * rx + cos * ry
    rows[pair.first] = (*rows[pair.first][:2], mx - tx, my - ty)
    rows[pair.second] = (*rows[pair.second][:2], mx + tx, my + ty)
    recording.hits(float(event.time), event.impulses, rows)


def an_event_of_two_discs(after: int) -> int:
    run = DoubleEngine().run(catalogue.build("gas"))
    walls = {wall.id for wall in run.scene.walls}
    return next(e.index for e in run.events[after:] if not walls & set(e.impulses[0]))


@pytest.mark.parametrize(
    ("bug", "told"),
    [
        (phantom, "from touching as they collide"),
        (crooked, "off the law's"),
    ],
)
def test_what_keeps_energy_and_momentum_beyond_reach_may_yet_be_wrong(bug: Any, told: str) -> None:
    event = an_event_of_two_discs(FAR)
    checked = check(Retold(event, honest), "gas")
    assert checked.reach is not None
    assert checked.reach.events < FAR
    assert "impacts and" in str(checked)
    with pytest.raises(CheckFailed, match=told) as caught:
        check(Retold(event, bug), "gas")
    assert f"event {event} (" in str(caught.value), "and where"


def test_a_tie_out_of_reach_is_resolved_in_some_order() -> None:
    """A row of touching balls: the striker is told to meet the second, through the first."""

    def through(recording: Recording, event: Any, rows: Rows) -> None:
        recording.hits(float(event.time), [("striker", "b2"), *event.impulses[1:]], rows)

    assert "its tie: the policy's own" in str(check(Retold(99, honest), "cradle:gap=0"))
    with pytest.raises(CheckFailed, match="permitted: no order of the impulses leads to it"):
        check(Retold(0, through), "cradle:gap=0")


@pytest.mark.parametrize("name", ["double", "single", "quad"])
def test_far_from_the_origin_energy_is_kept_as_well_as_places_are(name: str) -> None:
    """A push along a line of centres that is askew by rounding gains or loses a share of the energy."""
    far = 10**6 if name != "single" else 100
    circles = [Circle(far, 0, vx=-1, vy="1/9"), Circle(far - 9, 1), Circle(far - 15, 0, 2, m=5)]
    box = [Wall(far - 30, 0, far - 30, 1), Wall(far + 10, 0, far + 10, 1), Wall(0, -10, 1, -10), Wall(0, 10, 1, 10)]
    assert check(name, Scene(circles, box, name="far", events=40)).asserted


LATE = next(bug for bug in BUGS if bug.name == "late clock")


@pytest.mark.parametrize(
    ("scene", "told"), [("gas", "time = "), ("rack:rows=3,gap=1/40", "the first meeting of its tie is at ")]
)
@pytest.mark.parametrize("name", ["pymunk", "pymunk:dt=1/64"])
def test_a_late_clock_of_an_engine_of_steps_is_no_matter_of_its_step(name: str, scene: str, told: str) -> None:
    """Lateness that does not fall with the step is not granted, so that times are off, and that of a tie."""
    assert check(name, scene).asserted
    with pytest.raises(CheckFailed, match=told):
        check(Planted(engine(name), LATE), scene)


def test_where_the_step_cannot_be_halved_lateness_is_granted_up_to_some_steps() -> None:
    run = DoubleEngine().run(catalogue.build("gas"), events=30)
    local = local_error(Planted(NoFiner(), LATE), run, 53)
    assert (local.order, local.lateness) == (1.0, UNSEEN / 256)


@dataclass(frozen=True)
class NoFiner(PymunkEngine):
    """Pymunk, as if its step could not be halved."""

    def finer(self) -> Any:
        """None."""


def test_what_a_bug_is_stands_beside_where_the_histories_part() -> None:
    """A wrong mass changes whom a disc meets only after some hits; what each hit does to velocities is told as well."""
    bug = next(bug for bug in BUGS if bug.name == "wrong mass")
    with pytest.raises(CheckFailed) as caught:
        check(Planted(engine("double"), bug), "gas:n=6")
    first, *others = str(caught.value).splitlines()
    assert "first differs at event" in first
    told = [line for line in others if line.startswith("  violation: ")]
    assert len(told) == 2
    assert "the velocity of c2 after it is off by" in told[0]
    assert "does not keep the law: the mass of c2 taken for" in told[1]
