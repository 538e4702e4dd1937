"""Three bodies on a line that hit in turns without a last time: the exact end, against sums of all times."""

from __future__ import annotations

from fractions import Fraction
from random import Random
from typing import NamedTuple

import pytest
from mpmath import mpf, workdps

from truebreak.compare.files.saved import load_run, save_run
from truebreak.exact import ExactEngine
from truebreak.exact.simulation import policies
from truebreak.exact.simulation.policies import Collapse, may_collapse
from truebreak.floating import DoubleEngine, QuadEngine
from truebreak.scenarios import Circle, Quantity, Scene, StopReason, Wall

HITS, DIGITS = 400, 2500


class Bead(NamedTuple):
    """Of radius r on a line; w is 0 for what stands."""

    x: Fraction
    r: int
    v: Fraction
    w: Fraction


def summed(beads: list[Bead], e: Fraction) -> mpf | None:
    """The time of a hit so late that all after it make no difference; None where hits have a last one."""
    x, v, w = (
        [mpf(q.numerator) / q.denominator for q in row] for row in zip(*((b.x, b.v, b.w) for b in beads), strict=True)
    )
    r, share, now, last = [b.r for b in beads], mpf(e.numerator) / e.denominator, mpf(0), None
    for _ in range(HITS):
        waits = [
            ((x[i + 1] - x[i] - r[i] - r[i + 1]) / (v[i] - v[i + 1]), i)
            for i in range(len(x) - 1)
            if v[i] > v[i + 1] and i != last
        ]
        if not waits:
            return None
        wait, i = min(waits)
        now, x = now + wait, [a + b * wait for a, b in zip(x, v, strict=True)]
        push = (1 + share) * (v[i + 1] - v[i]) / (w[i] + w[i + 1])
        v[i], v[i + 1], last = v[i] + w[i] * push, v[i + 1] - w[i + 1] * push, i
    return now


def drawn(seed: int) -> tuple[Scene, list[Bead], Fraction]:
    """Two to four discs on a level or an upright line, beside a wall, a fixed disc or nothing."""
    rng = Random(f"line {seed}")
    e, beside = (
        Fraction(rng.randint(1, 30), rng.choice((100, 200, 400))),
        rng.choice(("nothing", "wall", "fixed", "more")),
    )
    count = {"nothing": 3, "wall": 2, "fixed": 2, "more": 4}[beside]
    beads, x = list[Bead](), Fraction(0)
    for _ in range(count):
        x += Fraction(rng.randint(210, 400), 100)
        w = 1 / Fraction(rng.choice((1, 1, 2, 5)), rng.choice((1, 1, 3)))
        beads.append(Bead(x, 1, Fraction(rng.randint(-300, 300), 100), w))
    upright = rng.random() < 0.4

    def two(along: Fraction, across: int = 0) -> tuple[str, str]:
        return (str(across), str(along)) if upright else (str(along), str(across))

    circles = [Circle(*two(b.x), 1, *two(b.v), str(1 / b.w), id=f"c{k}") for k, b in enumerate(beads)]
    walls = [Wall(0, 0, *two(Fraction(0), 1), id="w")] if beside == "wall" else []
    if beside == "fixed":
        circles.append(Circle(0, 0, 1, m="oo", id="f"))
    rng.shuffle(circles)
    if beside in ("wall", "fixed"):
        beads.insert(0, Bead(Fraction(0), int(beside == "fixed"), Fraction(0), Fraction(0)))
    return Scene(circles, walls, restitution=str(e)), beads, e


def differs(seed: int) -> str:
    """What is wrong with a scene's end; "" for nothing, "right" where hits without a last one ended it rightly."""
    scene, beads, e = drawn(seed)
    run = ExactEngine().run(scene, events=60)
    with workdps(DIGITS):
        end = summed(beads, e)
        if run.stop.reason is StopReason.ACCUMULATION:
            assert run.ending is not None
            far = end is None or abs(mpf(run.ending.digits(30)) - end) > mpf(10) ** -22
            return f"{run.ending.digits(30)}, not {end}" if far else "right"
    return "" if end is None or run.stop.reason is StopReason.EVENTS else run.stop.message


def test_the_end_is_that_of_a_sum_of_all_times():
    found = [differs(seed) for seed in range(60)]
    assert set(found) == {"", "right"}
    assert found.count("right") > 15


def _other_root(share: Quantity, e: Quantity, c: Quantity, d: Quantity) -> Quantity:
    return ((c * d - e - e + (c * d * (c * d - 4 * e)).sqrt()) / 2 + e) / (c * e)


FAULTS = {
    "the other solution": _other_root,
    "a percent too much": lambda share, e, c, d: share * 101 / 100,
    "the sign of the share": lambda share, e, c, d: -share,
    "the masses of one hit for those of the other": lambda share, e, c, d: share * c / d,
    "no share": lambda share, e, c, d: share - share,
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_found(fault: str, monkeypatch: pytest.MonkeyPatch):
    plain = Collapse.of

    def spoilt(scene: Scene, link, other):
        found = plain(scene, link, other)
        if found is None:
            return None
        e = scene.restitution
        (m,) = {*link.circles} & {*other.circles}
        w = scene.circles[m].inverse_mass
        c, d = ((1 + e) * w / (w + policies._others_share(scene, x, m)) for x in (other, link))
        return Collapse(found.link, found.other, found.axis, found.signs, FAULTS[fault](found.share, e, c, d))

    monkeypatch.setattr(Collapse, "of", staticmethod(spoilt))
    found = [differs(seed) for seed in range(40)]
    assert not {*found} <= {"", "right"} or found.count("right") == 0


def three(e: str = "1/20", *more: Circle, **changes: object) -> Scene:
    circles = [Circle(0, 0, vx=1, id="a"), Circle(4, 0, id="b"), Circle(7, 0, vx=-1, id="c")]
    return Scene([*circles, *more], restitution=e).with_changes(**changes)


def test_three_balls_end_in_closed_form_and_only_up_to_the_bound():
    run = ExactEngine().run(three())
    assert run.stop.message == "infinitely many collisions in finite time: b and c as well as a and b by 1.71428571429"
    assert run.ending is not None
    assert run.ending.text() == "12/7"
    assert may_collapse(three("7 - 4 * sqrt(3) - 10**-9"))
    assert not may_collapse(three("7 - 4 * sqrt(3) + 10**-9"))
    assert not may_collapse(three("1/20", walls=[Wall(0, 3, 1, 3)]).with_changes(restitution=1))
    assert ExactEngine().run(three("1/10")).stop.reason is StopReason.QUIET


def test_another_that_comes_near_ends_it_otherwise():
    far = ExactEngine().run(three("1/20", Circle(4, 40, vy=-1, id="d")))
    assert far.stop.reason is StopReason.ACCUMULATION
    near = ExactEngine().run(three("1/20", Circle("27/10", "29/10", vy="-1", vx=0, id="d")), events=60)
    assert near.stop.reason is not StopReason.ACCUMULATION or float(near.ending or 0) != pytest.approx(12 / 7, abs=1e-9)


def test_what_was_hit_off_its_line_is_not_on_it():
    pusher = Circle("3/2", 4, "1/2", vy=-4, id="d")  # it hits b from above first
    run = ExactEngine().run(three("1/20", pusher), events=40)
    assert any("d" in contact for event in run.events for contact in event.contacts)
    assert run.stop.reason is not StopReason.ACCUMULATION


def test_others_that_accumulate_are_suspected():
    """On an oblique line no proof is known; hits come ever faster, and the run says so before long."""
    scene = Scene(
        [Circle(0, 0, vx="3/5", vy="4/5"), Circle("12/5", "16/5"), Circle("21/5", "28/5", vx="-3/5", vy="-4/5")],
        restitution="1/20",
    )
    run = ExactEngine().run(scene, events=2000)
    assert run.stop.reason is StopReason.UNDECIDED
    assert "accumulation suspected" in run.stop.message
    assert len(run.events) < 400


def test_a_run_is_gone_on_with_and_kept(tmp_path):
    whole, short = ExactEngine().run(three()), ExactEngine().run(three(), events=5)
    again = ExactEngine().resume(short, events=60)
    assert [e.time.text() for e in again.events] == [e.time.text() for e in whole.events]
    assert again.ending is not None
    assert again.ending.text() == "12/7"
    save_run(whole, tmp_path / "run.json")
    kept = load_run(tmp_path / "run.json")
    assert kept.stop == whole.stop
    assert kept.ending is not None
    assert kept.ending.text() == "12/7"


def test_three_that_fall_end_as_those_that_do_not():
    run = ExactEngine().run(three(gravity=(0, -10)))
    assert run.ending is not None
    assert run.ending.text() == "12/7"
    along = ExactEngine().run(three(gravity=(3, 0)))
    assert along.ending is not None
    assert along.ending.text() == "12/7"


@pytest.mark.parametrize("engine", [QuadEngine(), DoubleEngine()], ids=lambda engine: engine.name)
def test_engines_of_finite_precision_end_beside_it(engine):
    run = engine.run(three(), events=200)
    assert run.stop.reason is not StopReason.HORIZON
    assert float(run.final_time) == pytest.approx(12 / 7, abs=1e-4)
