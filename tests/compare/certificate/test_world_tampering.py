"""Certificates of runs with restitution, gravity and walls that move: both checkers verify them; altered at random they
are refused, or still true; and faults planted in the new laws are found."""
# ruff: noqa: E501 (lines of the checkers stand here as they are)

from __future__ import annotations

from decimal import Decimal
from functools import cache
from pathlib import Path

import pytest

from certificate.checkers import Lot, both_verify, lot_of, mistaken, needs_node
from certificate.test_conditions import completed, lax, lax_second
from certificate.test_tampering import WAYS, altered, refused
from certificate.world_forgeries import (
    WORLD_CONDITIONS,
    across_an_arc,
    beside_an_arc,
    from_within_the_floor,
)
from certificate.world_samples import (
    ARC_WAYS,
    BOX,
    WORLD_WAYS,
    arc_runs,
    arc_samples,
    world_runs,
    world_samples,
)
from truebreak.compare.certificate import CertificateError, certificate_of, prover
from truebreak.compare.certificate.certified import difference
from truebreak.exact import ExactEngine
from truebreak.scenarios import Arc, Circle, Scene, Wall


def test_both_verify_runs_with_gravity_restitution_and_moving_walls(tmp_path: Path) -> None:
    samples = world_samples()
    assert sum(len(told["instants"]) for told in samples.values()) > 300
    ways = [told["scene"] for told in samples.values()]
    assert sum("gravity" in scene for scene in ways) > 20
    assert sum("restitution" in scene for scene in ways) > 15
    assert sum(any("vx" in wall for wall in scene.get("walls", ())) for scene in ways) > 10
    both_verify(samples.items(), tmp_path)


def test_both_verify_runs_among_arcs(tmp_path: Path) -> None:
    assert sum(len(told["instants"]) for told in arc_samples().values()) > 150
    both_verify(arc_samples().items(), tmp_path)


@pytest.mark.parametrize("name", ["mirrored in a ring", "mirrored between bows"])
def test_what_falls_on_one_instant_by_symmetry_is_shown_by_isometries_of_arcs(name: str) -> None:
    """The engine proves these ties by the form of the log; the checkers by a map of sides to sides, without a root."""
    ties = [tie for event in arc_runs()[name].events for tie in event.ties]
    told = arc_samples()[name]
    assert len(ties) > 10 and sum(tie.proof.name == "SYMMETRY" for tie in ties) > len(ties) - 4
    first = len(told["scene"]["circles"])
    assert told["isometries"] and any(i >= first for motion in told["isometries"] for i, _ in motion["map"])
    assert len(told["roots"]) < 3 and any(part.get("zeros") for part in told["instants"])


@pytest.mark.slow
def test_a_push_that_no_witness_shows_to_fall_on_an_instant_is_no_defect(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nothing shows that two meet at once, the certificate is refused by name."""
    monkeypatch.setattr(prover.Prover, "_new", lambda *given: iter(()))
    with pytest.raises(CertificateError, match="meet at it"):
        certificate_of(arc_runs()["mirrored in a ring"])


def test_the_final_state_is_in_true_coordinates() -> None:
    samples = {**world_samples(), **arc_samples()}
    for name, run in {**world_runs(), **arc_runs()}.items():
        told = samples[name]["final"]
        rows = [told["time"], *(x for row in told["circles"] for x in row)]
        final = run.at(run.final_time)
        if run.stop.reason.name in ("REST", "ACCUMULATION", "CRUSHED", "UNDECIDED"):
            continue  # the run ends later than its last instant
        mine = [final.time, *(x for c in final.circles for x in (c.x, c.y, c.vx, c.vy))]
        if samples[name]["end"]["reason"] in ("horizon", "return", "events"):
            assert [
                abs(Decimal(x) - Decimal(y.digits(30))) < Decimal(10) ** -16 for x, y in zip(rows, mine, strict=True)
            ] == [True] * len(rows), name


@needs_node
@pytest.mark.parametrize("count", [140, pytest.param(3000, marks=pytest.mark.slow)])
@pytest.mark.timeout(3600)
def test_altered_runs_of_the_larger_world_are_refused_or_shown_to_be_true(count: int, tmp_path: Path) -> None:
    tried = altered(count, (*WORLD_WAYS, *WAYS), "worldA", world_samples())
    assert refused(tried, tmp_path) > count // 2


@needs_node
@pytest.mark.parametrize("count", [140, pytest.param(3000, marks=pytest.mark.slow)])
@pytest.mark.timeout(3600)
def test_altered_runs_among_arcs_are_refused_or_shown_to_be_true(count: int, tmp_path: Path) -> None:
    tried = altered(count, (*ARC_WAYS, *WAYS), "arcsA", arc_samples())
    assert refused(tried, tmp_path) > count // 2


def test_a_certificate_is_compared_with_the_arcs_that_are_meant() -> None:
    bow, ring = Arc(0, 0, 5, 1, 0, -1, 0, id="bow"), Arc(0, 0, 5, full=True, id="bow")
    scene = Scene([Circle(0, 1, vy=1)], arcs=[bow])
    block = certificate_of(ExactEngine().run(scene, events=2))["scene"]
    assert difference(block, scene) is None
    assert difference(block, scene.with_changes(arcs=[ring])) == "arc 'bow' is no full circle"
    assert difference(block, scene.with_changes(arcs=[])) == "it has 1 arcs, not 0"
    assert (
        difference(block, scene.with_changes(arcs=[Arc(0, 0, 6, 1, 0, -1, 0, id="bow")])) == "arc 'bow': r is 5, not 6"
    )
    longer = scene.with_changes(arcs=[Arc(0, 0, 5, 1, 0, 0, -1, id="bow")])
    assert difference(block, longer) == "arc 'bow': x1 is -5, not 0"


def test_a_certificate_is_compared_with_the_world_that_is_meant() -> None:
    lift = [Wall(0, 0, 1, 0, id="floor", vy="1/10"), *BOX[1:]]
    scene = Scene([Circle(0, 4)], lift, gravity=(0, -1), restitution="1/2")
    block = certificate_of(ExactEngine().run(scene, events=2))["scene"]
    assert difference(block, scene) is None
    assert difference(block, scene.with_changes(restitution=1)) == "its restitution is 1/2, not 1"
    assert "its gravity is ['0', '-1']" in str(difference(block, scene.with_changes(gravity=(0, -2))))
    assert "its gravity is ['0', '-1']" in str(difference(block, scene.with_changes(gravity=None)))
    assert difference(block, scene.with_changes(walls=BOX)) == "wall 'floor': vy is 1/10, not 0"


FAULTS = {
    "gravity the other way": (
        [("pull = [x * time for x in self.at(*self.pull)]", "pull = [-x * time for x in self.at(*self.pull)]")],
        [("const speed = this.gravity.map(g => A.mul(g[w], time));", "const speed = this.gravity.map(g => A.neg(A.mul(g[w], time)));")],
    ),
    "twice as far as it falls": (
        [("return [x * time for x in pull] + [x + x for x in pull]", "return [(x + x) * time for x in pull] + [x + x for x in pull]")],
        [("A.mul(A.mul(x, time), this.half[w])", "A.mul(x, time)")],
    ),
    "the pull without its part of the root": (
        [("            wall.disc = wall.disc - wall.speed * wall.gap\n", "")],
        [("disc: () => (falls ? A.sub(A.square(closing()), A.mul(speed(), gap())) : A.square(closing())),", "disc: () => A.square(closing()),")],
    ),
    "the rising zero": (
        [("return m.gap / (m.disc.sqrt() - m.closing)", "return m.gap / (-m.disc.sqrt() - m.closing)")],
        [("full.sub(root, laws.closing()))) ??", "full.sub(full.neg(root), laws.closing()))) ??")],
    ),
    "the zero at 0, not the second one": (
        [("(m.closing if again else m.disc.sqrt())", "(-m.closing if again else m.disc.sqrt())")],
        [("full.div(full.twice(laws.closing()), full.neg(laws.speed()))", "full.sub(laws.closing(), laws.closing())")],
    ),
    "half the wait to the second zero": (
        [("(m.closing if again else m.disc.sqrt())", "(m.closing - m.closing if again else m.disc.sqrt())")],
        [("full.div(full.twice(laws.closing()),", "full.div(laws.closing(),")],
    ),
    "walls that stand still": (
        [("x, y, vx, vy = x - p * time, y - q * time, vx - p, vy - q", "pass")],
        [("if (wall.way) {", "if (0) {")],
    ),
    "walls that move the other way": (
        [("x, y, vx, vy = x - p * time, y - q * time, vx - p, vy - q", "x, y, vx, vy = x + p * time, y + q * time, vx + p, vy + q")],
        [("const own = wall.way.map(x => x[w]);", "const own = wall.way.map(x => A.neg(x[w]));")],
    ),
    "walls that push as if they stood": (
        [("x, y, vx, vy = x - p * time, y - q * time, vx - p, vy - q", "x, y = x - p * time, y - q * time")],
        [("way = minus(way, own);", "")],
    ),
    "the law of restitution 1": (
        [("self.loss, self.lost, self.pull = of(e),", "self.loss, self.lost, self.pull = of(ONE),")],
        [("A.add(A.of(one), this.restitution[w])", "A.add(A.of(one), A.of(one))")],
    ),
    "a restitution of e in place of 1 + e": (
        [("-(met[c].closing + self.before[c])", "-self.before[c]")],
        [("A.neg(A.mul(this.scene.factor[1], ", "A.neg(A.mul(this.scene.restitution[1], ")],
    ),
    "what has pushed parts, whatever e is": (
        [("for k, v in drift.items()}, bool(loss)", "for k, v in drift.items()}, 1")],
        [("x.sign = this.scene.bounced;", "x.sign = 1;")],
    ),
    "a run turned back as without gravity": (
        [("vx, vy = vx + (u + u), vy + (v + v)", "pass")],
        [("const fall = gravity && worlds.map((A, w) => A.twice(", "const fall = null && worlds.map((A, w) => A.twice(")],
    ),
    "the final state in the falling frame": (
        [("self.fallen(age))] if falls else row", "self.fallen(age))] if 0 else row")],
        [("const fall = gravity && !run.scene.stands(i) && !run.captured[i] && worlds.map((A, w) => run.scene.fallen", "const fall = null && worlds.map((A, w) => run.scene.fallen")],
    ),
    "nothing pulls to a wall": (
        [("return self.bends.get(c, 0) < 0", "return 0 and self.bends.get(c, 0) < 0")],
        [("return pulls * side[c.i] < 0;", "return false;")],
    ),
    "everything pulls to a wall": (
        [("return self.bends.get(c, 0) < 0", "return c in self.bends")],
        [("return pulls * side[c.i] < 0;", "return Boolean(this.gravity);")],
    ),
}  # fmt: skip
"""Of each what the first checker has instead, and the second."""


ARC_FAULTS = {
    "an arc without its range": (
        [("        return -(p * d[0] + q * d[1]) * r - edge * reach\n", "        return reach\n")],
        [("const range = (to, length) => A.neg(", "const range = (to, length) => length && A.neg(A.neg(length)) || A.neg(")],
    ),
    "the range on the other side of the chord": (
        [("return -(p * d[0] + q * d[1]) * r - edge * reach", "return (p * d[0] + q * d[1]) * r + edge * reach")],
        [("const range = (to, length) => A.neg(", "const range = (to, length) => A.neg(A.neg(")
         , ("        A.mul(arc.far[w], length)));", "        A.mul(arc.far[w], length))));")],
    ),
    "the chord at the middle": (
        [("* r - edge * reach", "* r - edge * reach * (edge - edge)")],
        [("        A.mul(arc.far[w], length)));", "        A.sub(length, length)));")],
    ),
    "the earlier zero from within": (
        [("(m.closing if again else m.disc.sqrt())", "(m.closing if again else -m.disc.sqrt() if m.hollow else m.disc.sqrt())")],
        [("full.div(full.neg(full.add(laws.closing(), root)), laws.speed())", "full.div(full.neg(c.hollow ? full.sub(laws.closing(), root) : full.add(laws.closing(), root)), laws.speed())")],
    ),
    "half the chord after a bounce": (
        [("(m.closing if again else m.disc.sqrt())", "(m.closing - m.closing if again else m.disc.sqrt())")],
        [("full.neg(full.twice(laws.closing())), laws.speed())", "full.neg(laws.closing()), laws.speed())")],
    ),
    "no room taken by the disc within": (
        [("size - r if within else size + r", "size if within else size + r")],
        [("hollow ? A.sub(arc.r[w], radius) : A.add(arc.r[w], radius)", "hollow ? arc.r[w] : A.add(arc.r[w], radius)")],
    ),
    "the disc's radius the other way without": (
        [("size - r if within else size + r", "size - r if within else size - r")],
        [("hollow ? A.sub(arc.r[w], radius) : A.add(arc.r[w], radius)", "A.sub(arc.r[w], radius)")],
    ),
    "pushed outward from within": (
        [("arms = {i: d if within else (-d[0], -d[1])}", "arms = {i: (-d[0], -d[1])}")],
        [("direction: () => (hollow ? d : [", "direction: () => (0 ? d : [")],
    ),
    "ends that are not there": (
        [("for row in arcs if row[3:]]", "for row in arcs if 0]")],
        [("if (!full) for (const [x, y] of", "if (0) for (const [x, y] of")],
    ),
    "the sides exchanged": (
        [("within, kind = (u - x, v - y), (j - self.bows) % 2", "within, kind = (u - x, v - y), (j - self.bows + 1) % 2")],
        [("(j - this.firstBow) % 2 === 1", "(j - this.firstBow) % 2 === 0")],
    ),
}  # fmt: skip


@cache
def lot(of_walls: bool) -> Lot:
    """Runs among walls or among arcs, and forgeries that miss one condition each."""
    if of_walls:
        forged = {from_within_the_floor: "nothing starts across a wall to which it is pulled"}
    else:
        forged = {across_an_arc: "nothing starts across an arc", beside_an_arc: "an arc is met within its range"}
    samples = world_samples() if of_walls else arc_samples()
    wrong = [completed(make(), lax(WORLD_CONDITIONS[name][0])) for make, name in forged.items()]
    return lot_of(samples.values(), wrong)


@needs_node
@pytest.mark.parametrize("fault", [*FAULTS, *ARC_FAULTS])
def test_planted_faults_are_found(fault: str, tmp_path: Path) -> None:
    first, second = {**FAULTS, **ARC_FAULTS}[fault]
    mistaken(lax(first), lax_second(second, tmp_path / "faulty"), lot(fault in FAULTS), tmp_path)
