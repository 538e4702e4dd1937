"""Causes at restitution 0 in engines of steps: what sticks together is lasting contact, and no new impact."""

from __future__ import annotations

import math
import re
from typing import Any

import pytest
from drawn_falls import sticking
from refuting import PHANTOM, Said, refute

from truebreak.compare import compare
from truebreak.compare.audit.audit import audit_run
from truebreak.compare.engines import engine as engine_named
from truebreak.compare.foreign import RecordedEngine, Recording
from truebreak.exact import ExactEngine
from truebreak.floating import PymunkEngine
from truebreak.scenarios import Circle, Scene, Trajectory, Wall

LATE = 2 - 147 / 74
"""From the contact to the end of a step of 1/16."""


def aside(off: str) -> Scene:
    """A disc strikes another one aside at t = 147/74, which leaves at 4/5 along (4, -3)/5; a third one crosses its way.

    Places of the third are by 12 along that direction and by q across it. The two come nearer at 4/5 along it and at
    4/5 across: they are nearest at 2 sqrt(2) - off over sqrt(2), less both radii, and each second that the struck one
    leaves late is 4/5 / sqrt(2) more.
    """
    q = f"(12 + 4/5*(147/74) - 2*sqrt(2) + {off})"
    third = Circle(f"48/5 + {q}*3/5", f"-36/5 + {q}*4/5", vx="-12/25", vy="-16/25", id="c")
    return Scene([Circle("-8/5 - 147/37", "6/5", vx=2, id="a"), Circle(0, 0, id="b"), third], restitution=0)


def least(run: Trajectory) -> float:
    """The least gap of b and c in free flight, from where a run has them at t = 9 and 10."""
    there, then = (run.sample([time])[0][:, :2] for time in (9.0, 10.0))
    (dx, dy), (x, y) = there[2] - there[1], then[2] - then[1]
    return abs(dx * (y - dy) - dy * (x - dx)) / math.hypot(x - dx, y - dy) - 2


@pytest.mark.parametrize("bias", [1.0, 0.5**8, 0.0])
def test_the_account_of_a_disc_that_is_struck_aside_is_what_geometry_says(bias: float) -> None:
    """Lateness moves the third disc away, overlap turns the push, and what is pushed apart moves the second on."""
    scene, chosen = aside("-1/250"), PymunkEngine(dt=1 / 16, collision_bias=bias)
    found = compare(scene, [chosen], events=2).candidates[0]
    why = found.diagnosis
    assert why is not None and found.laws is not None
    assert found.laws.kept
    assert why.closed
    away = chosen.run(aside("-1/20"), until=11)  # which lets the two pass
    assert why.displacement == pytest.approx(least(away) - least(ExactEngine().run(aside("-1/20"), until=11)), rel=5e-3)
    sizes = {row.cause.name: row.displacement or 0.0 for row in why.shares}
    assert sum(sizes.values()) == pytest.approx(why.displacement, rel=1e-9)
    assert sizes["LATENESS"] == pytest.approx(LATE * 0.8 / math.sqrt(2), rel=1e-3)
    assert sizes["OVERLAP"] < -sizes["LATENESS"]
    moved = sizes.get("CORRECTION", 0.0)
    assert moved == pytest.approx(0.0, abs=1e-12) if bias == 1.0 else moved < -0.004
    assert str(why) == "time step"
    assert not refute(scene, chosen, found)


def box(vx: str, vy: str) -> Scene:
    """A disc that comes to the floor, slides along it, and comes to the wall at the right."""
    walls = [Wall(0, 0, 1, 0, id="floor"), Wall(7, 0, 7, 1, id="right")]
    return Scene([Circle(2, "7/3", vx=vx, vy=vy, id="disc")], walls, restitution=0, until=9)


def test_contacts_that_last_are_neither_late_nor_a_law_broken() -> None:
    """pymunk reports some of them again, with an impulse of a last bit: over that no lateness can be told."""
    seen, told = 0, 0
    for k in (1, 3, 4, 8, 9):
        scene, chosen = box(f"{k}/7", f"-{12 - k}/11"), PymunkEngine(dt=1 / 64)
        run = chosen.run(scene, until=9)
        seen += len(run.events) > 2
        assert audit_run(run, chosen).kept, k
        found = compare(scene, [chosen]).candidates[0]
        if found.verdict == "diverged":
            assert str(found.diagnosis) in {"phantom contact", "time step", "not determined"}, k
            told += str(found.diagnosis) == "phantom contact"
            assert not refute(scene, chosen, found), k
    assert seen >= 3
    assert told >= 1


class Sticks(RecordedEngine):
    """An engine of steps that leaves a share of the approach, and may say a contact that lasts again, once or more."""

    step, bits, name = 1 / 64, 53, "sticks"
    scene_keys = frozenset({"wall", "restitution"})

    def __init__(self, share: float = 0.0, again: int = 0, step: float = 1 / 64) -> None:
        self.share, self.again, self.step = share, again, step

    def finer(self) -> Any:
        """Half the step."""
        return Sticks(self.share, self.again, self.step / 2)

    def play(self, scene: Scene, recording: Recording) -> None:
        """One disc, a floor at 0 and a wall at 7."""
        x, y, vx, vy = recording.rows[0]
        done, times = 0, 0
        while recording.open and done < 100_000:
            done, x, y = done + 1, x + vx * self.step, y + vy * self.step
            hit: list[tuple[str, str]] = []
            if y < 1 and vy < 0:
                vy, hit = -self.share * vy, [("disc", "floor")]
            elif y < 1 and times < self.again and done % 16 == 0:  # a step later it is one contact in two steps
                times, hit, vy = times + 1, [("disc", "floor")], vy + 2.0**-70  # a later one, by an impulse
            if x > 6 and vx > 0:
                vx, hit = -self.share * vx, [*hit, ("disc", "right")]
            if hit:
                recording.hits(done * self.step, hit, {"disc": (x, y, vx, vy)})
            recording.state(done * self.step, [(x, y, vx, vy)])


def test_a_share_of_the_approach_that_is_left_is_a_law_not_kept() -> None:
    scene = box("1", "-1")
    assert audit_run(Sticks().run(scene, until=6), Sticks()).kept
    audit = audit_run(Sticks(0.1).run(scene, until=6), Sticks(0.1))
    assert audit.kept is False
    assert [violation.kind for violation in audit.violations] == ["impulse"]
    assert audit.bounces is not None and audit.bounces.mean == pytest.approx(0.1)


def test_a_contact_that_lasts_and_is_told_again_is_a_phantom() -> None:
    """How many are told, and that nothing differs without them, is known; none is of the step, nor of rounding."""
    for again in (1, 2):
        found = compare(box("1", "-1"), [Sticks(again=again)], until=3).candidates[0]
        why = found.diagnosis
        assert found.verdict == "diverged" and why is not None
        assert found.laws is not None and found.laws.kept, found.laws
        assert str(why) == "phantom contact"
        assert ("more below rounding nothing else differs" in why.finding) == (again > 1), why.finding
        assert not refute(box("1", "-1"), Sticks(again=again), found)


@pytest.mark.parametrize("seed", [0, 1, 7])
def test_causes_at_restitution_0_are_not_refuted(seed: int) -> None:
    for name in ("pymunk:dt=1/64", "rounded:bits=12"):
        found = compare(sticking(seed), [engine_named(name)], events=12).candidates[0]
        assert not refute(sticking(seed), engine_named(name), found)


BIASED = f"pymunk:dt=1/64,collision_bias={0.9**60!r}"


@pytest.mark.parametrize(("seed", "name"), [(7, "rounded:bits=12"), (5, "pymunk:dt=1/64")])
def test_a_phantom_contact_is_said_with_those_that_were_left_out_beside_it(seed: int, name: str) -> None:
    """Without it alone another is left, of an engine of events too: what is said is what was tried."""
    scene, chosen = sticking(seed), engine_named(name)
    found = compare(scene, [chosen], events=20).candidates[0]
    assert re.search("without it and [1-9] more below rounding nothing else", getattr(found.diagnosis, "finding", ""))
    assert not refute(scene, chosen, found)
    alone = Said((PHANTOM,), frozenset({PHANTOM}), without=1)
    assert "something else" in {refutation.rule for refutation in refute(scene, chosen, found, alone)}


def test_a_finer_step_that_has_the_contact_too_many_later_does_not_pass() -> None:
    """A contact that lasts is reported again at every step, at another time: up to the reference's next event."""
    found = compare(sticking(21), [engine_named(BIASED)], events=20).candidates[0]
    why = found.diagnosis
    assert why is not None
    assert str(why) == "phantom contact"
    assert "the two agree for longer" in why.finding
    assert not refute(sticking(21), engine_named(BIASED), found)


def test_under_gravity_causes_at_restitution_0_are_not_looked_for_in_steps() -> None:
    """There what has met is pushed anew by g dt at every step."""
    floor = [Wall(0, 0, 1, 0, id="floor")]
    scene = Scene([Circle(0, 2)], floor, gravity=(0, -1), restitution=0, until=3)
    audit = audit_run(PymunkEngine().run(scene, until=2), PymunkEngine())
    assert audit.kept is None
    assert "with gravity and restitution 0" in audit.reason
