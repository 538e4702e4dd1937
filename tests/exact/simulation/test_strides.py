"""Contacts carried out in one go, and instants in strides, come to what the steps and the loop come to."""

from __future__ import annotations

import pytest
from flint import arb, ctx

from truebreak.exact import ExactEngine
from truebreak.exact.certified.certified_decider import Stride
from truebreak.exact.numbers import ball
from truebreak.exact.replay.ball_state import BallState, LoneContacts
from truebreak.exact.replay.contact import AtWall, Pair
from truebreak.exact.replay.state import Go, Kick
from truebreak.exact.simulation.loop import instant_of
from truebreak.scenarios import Circle, Scene, Segment, Wall, catalogue

BITS, SHARP = 384, 4096


def upright(n: int = 5) -> Scene:
    """Circles of unequal masses on one upright line between two walls."""
    circles = [
        Circle(f"sqrt({2})", f"{4 * k} + sqrt({k + 2})/5", vy=(-1) ** k * (k + 1), m=f"{k + 1}/3") for k in range(n)
    ]
    return Scene(circles, [Wall(0, -3, 1, -3), Wall(0, 4 * n + 3, 1, 4 * n + 3)])


def slanted() -> Scene:
    """Circles, a point and a heavy one among walls at angles that no axis knows."""
    circles = [
        Circle(0, 0, 1, 1, "1/3"),
        Circle(4, "1/7", "2/5", -1, "1/2", m=9),
        Circle(1, 4, 0, "1/2", -1, point=True),
        Circle(-3, 3, "1/3", 1, 1),
    ]
    corners = [(-9, "-7 - 1/9"), (9, "-8 + sqrt(2)/9"), (8, 9), ("-8 + 1/7", 8)]
    return Scene(circles, [Wall(*a, *b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)])


BARS = [Segment(3, 5, 4, 9), Segment(11, 4, 14, "11/2", r="1/4"), Segment(13, 14, "33/2", "29/2")]

SCENES = {
    "gas": (catalogue.build("gas:n=8,seed=3"), 120),
    "mixed": (catalogue.build("gas:n=6,mixed=yes,size=20"), 100),
    "galperin": (catalogue.build("galperin:n=1"), 31),
    "upright": (upright(), 60),
    "slanted": (slanted(), 80),
    "obstacles": (catalogue.build("lorentz"), 60),
    "segments": (catalogue.build("gas:n=10").with_changes(segments=BARS), 120),
}


def contacts(scene: Scene, events: int) -> list[Pair | AtWall]:
    steps = ExactEngine().run(scene, events=events).motion.log.steps
    found = [step.links[0] for step in steps if isinstance(step, Kick) and len(step.links) == 1]
    assert len(found) == events
    return found


@pytest.mark.parametrize("name", SCENES)
def test_a_contact_in_one_go_comes_to_what_its_two_steps_come_to(name: str) -> None:
    """Every number after every contact holds what the plain steps come to with many times the bits, and is as sharp
    as theirs with as many bits, but for a few; all contacts but those of circles at rest go so."""
    scene, events = SCENES[name]
    saved = ctx.prec
    try:
        links = contacts(scene, events)
        ball.use_bits(SHARP)
        inner = scene.surfaces
        truth = BallState(inner)
        ball.use_bits(BITS)
        plain, fused = BallState(inner), BallState(inner)
        lone, done, left = LoneContacts(fused), 0, 0
        for body in fused.bodies.values():
            body.acc = BITS
        for link in links:
            steps = Go(link, link.circles), Kick((link,), (link,))
            for state, bits in ((truth, SHARP), (plain, BITS)):
                ball.use_bits(bits)
                for step in steps:
                    state.do(step)
            accuracy = lone.strike(link, BITS, done)
            ball.use_bits(BITS)
            if accuracy is None:
                left += 1
                for step in steps:
                    fused.do(step)
            else:
                assert fused.instant.rel_accuracy_bits() >= min(accuracy, BITS)
            done += 2
            ball.use_bits(SHARP)
            assert fused.instant.overlaps(truth.instant)
            for i in link.circles:
                mine, sharp, other = (state.bodies[i].flight for state in (fused, truth, plain))
                shift = mine.t - sharp.t
                assert mine.last == sharp.last
                for at, v, true_at, true_v, own in zip(
                    mine[:2], mine[2:4], sharp[:2], sharp[2:4], other[:2], strict=True
                ):
                    assert (true_at + true_v * shift - at).contains(0)
                    assert (true_v - v).contains(0)
                    assert at.rad() <= 16 * own.rad() + arb(2) ** (32 - BITS)
        assert left <= events // 20
    finally:
        ctx.prec = saved


@pytest.mark.parametrize(
    "spec, events",
    [
        ("gas:n=10,seed=5", 250),
        ("gas:n=70,seed=1", 120),
        ("gas:n=5,mixed=yes,size=20", 150),
        ("galperin:n=2", 314),
        ("reversal:n=4,after=9,mixed=yes", None),
        ("rack:rows=3,jitter=1/10,pockets=no", 60),
        ("lorentz", 60),
        ("bumper", 40),
        ("inscribed:n=5", 60),
        ("pinball", None),
        ("cradle", None),
    ],
)
def test_a_run_in_strides_is_that_of_the_loop(spec: str, events: int | None, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = catalogue.build(spec)
    strides, taken = Stride.__call__, []

    def counted(self: Stride, last: int, *rest: object) -> int:
        now = strides(self, last, *rest)  # type: ignore[arg-type]
        taken.append(now - last)
        return now

    monkeypatch.setattr(Stride, "__call__", counted)
    quick = ExactEngine().run(scene, events=events)
    monkeypatch.setattr(Stride, "__call__", lambda self, last, *rest: last)
    slow = ExactEngine().run(scene, events=events)
    assert (sum(taken) > 0) is (spec != "inscribed:n=5" and not scene.pockets)  # in the pentagon all comes in fives
    assert quick.motion.log.steps == slow.motion.log.steps
    assert [(float(e.time), e.contacts, e.impulses, e.ties) for e in quick.events] == [
        (float(e.time), e.contacts, e.impulses, e.ties) for e in slow.events
    ]
    assert (quick.stop, quick.notes, quick.assumptions) == (slow.stop, slow.notes, slow.assumptions)
    assert {k: n for k, n in quick.plan.items() if k != "bits"} == {k: n for k, n in slow.plan.items() if k != "bits"}
    instants = [[instant_of(found, 2 * k) for k, found in enumerate(run.motion.tape.found, 1)] for run in (quick, slow)]
    assert instants[0] == instants[1]
    assert quick.motion.tape.reached[0] == slow.motion.tape.reached[0]
    for mine, other in zip(quick.motion.knots, slow.motion.knots, strict=True):
        assert [knot[5:] for knot in mine] == [knot[5:] for knot in other]
