"""Certificates of scenes in which walls carry what comes to rest: both checkers verify them, and refuse what is altered."""
# ruff: noqa: E501 (lines of the checkers stand here as they are)

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from functools import cache
from pathlib import Path

import jsonschema
import pytest

from certificate.checkers import Lot, both_verify, lot_of, mistaken, needs_node
from certificate.forging import Told, refused_by_both, told
from certificate.settle_forgeries import SETTLE_WAYS, by_hand, settled_runs, settled_samples
from certificate.test_conditions import completed, lax, lax_second
from certificate.test_tampering import altered, refused
from truebreak.compare.certificate import CertificateError, certificate_of
from truebreak.compare.certificate.certified import difference
from truebreak.compare.report.schema import schema
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Scene, Segment, Wall
from truebreak.scenarios.trajectory import StopReason

FLOOR = Wall(0, 0, 1, 0, id="floor")
LAW = {"gravity": (0, -10), "settle": True}


def test_both_verify_runs_in_which_walls_carry(tmp_path: Path) -> None:
    both_verify(settled_samples().items(), tmp_path)


def test_the_samples_hold_what_is_carried_and_what_becomes_of_it() -> None:
    """Each that settles is listed as the run has it; on walls, also aslant, and faces; and then more happens."""
    settled, later, ends, places, out = set[str](), 0, set[str](), set[str](), 0
    for name, run in settled_runs().items():
        cert = settled_samples()[name]
        listed = [(i, k) for k, entry in enumerate(cert["instants"]) for i in {i for i, _ in entry.get("settle", ())}]
        assert len(listed) == len(run.settlings), name
        assert sorted(run.scene.ids[i] for i, _ in listed) == sorted(s.circle for s in run.settlings), name
        settled |= {s.wall for s in run.settlings}
        last = max((k for k, entry in enumerate(cert["instants"]) if "settle" in entry), default=0)
        later += any(entry.get("rounds") for entry in cert["instants"][last + 1 :])
        ends.add(cert["end"]["reason"])
        places |= {s.where for s in run.settlings if s.other}
        out += sum(s.since is not None for s in run.settlings)
    assert settled >= {"floor", "shelf", "aslant"}
    assert places == {"between left and right"}
    assert out > 6
    assert later > 20
    assert ends == {"quiet", "horizon", "events", "stopped"}


def test_they_are_what_the_schema_says() -> None:
    for cert in settled_samples().values():
        jsonschema.Draft202012Validator(schema("certificate-3")).validate(cert)


def test_what_slides_lies_in_true_coordinates_at_the_end() -> None:
    cert = told(by_hand()["slid into"][0], until=20)
    assert [entry["settle"] for entry in cert["instants"] if "settle" in entry] == [[[1, 2]], [[0, 2]]]
    assert [[float(x) for x in row] for row in cert["final"]["circles"]] == [[19, 1, 0.5, 0], [21, 1, 0.5, 0]]


def test_a_certificate_is_compared_with_whether_the_scene_settles() -> None:
    scene = by_hand()["slid into"][0]
    cert = told(scene, until=20)
    assert difference(cert["scene"], scene) is None
    assert difference(cert["scene"], scene.with_changes(settle=False)) == "settle is True, not False"


# -- What is altered.


@needs_node
@pytest.mark.parametrize("count", [160, pytest.param(2400, marks=pytest.mark.slow)])
@pytest.mark.timeout(3600)
def test_altered_runs_in_which_walls_carry_are_refused_or_shown_to_be_true(count: int, tmp_path: Path) -> None:
    tried = altered(count, SETTLE_WAYS, "settledA", settled_samples())
    assert refused(tried, tmp_path) > count // 2


def struck_but_not_told() -> Told:
    """A disc falls through one that lies in its way."""
    cert = told(by_hand()["struck on a shelf"][0], events=2)
    del cert["instants"][1:]
    cert["end"] = {"reason": "horizon", "until": "3"}
    return cert


def into_the_floor() -> Told:
    """A disc that is struck from above leaves into its floor."""
    scene = Scene([Circle(0, 1), Circle("1/3", 5)], [FLOOR], **LAW)
    cert = told(scene, events=1)
    assert [len(one) for one in cert["instants"][1]["rounds"]] == [1, 1, 1]
    del cert["instants"][1]["rounds"][1:]
    return cert


def slid_into_but_not_told() -> Told:
    """Two that slide pass through each other."""
    cert = told(by_hand()["slid into"][0], until=20)
    assert cert["instants"].pop()["rounds"] == [[[0, 1]]]
    return cert


def past_the_end_of_a_shelf() -> Told:
    """A disc slides along a shelf, and past its end."""
    cert = told(Scene([Circle(0, 1)], segments=[Segment(-4, 0, 4, 0, "shelf")], **LAW))
    cert["scene"]["circles"][0]["vx"] = "1"
    cert["end"] = {"reason": "horizon", "until": "9"}
    cert["final"] = {"time": "9", "circles": [["9", "1", "1", "0"]]}
    return cert


def another_slide() -> Told:
    """A disc slides off faster than it was struck."""
    cert = told(by_hand()["slid into"][0], until=20)
    cert["final"]["circles"][1] = ["20.0", "1.0", "1.5", "0.0"]
    return cert


def still_carried() -> Told:
    """A disc that has been struck off its shelf is said to be carried still: where it falls, no other bounce is told."""
    cert = told(by_hand()["struck on a shelf"][0], events=4)
    count = next(k for k, entry in enumerate(cert["instants"]) if entry.get("rounds")) + 1
    assert len(cert["instants"]) > count
    del cert["instants"][count:]
    cert["end"] = {"reason": "horizon", "until": "9"}
    return cert


FORGERIES = (
    struck_but_not_told, into_the_floor, slid_into_but_not_told, past_the_end_of_a_shelf, another_slide, still_carried,
)  # fmt: skip


@pytest.mark.parametrize("forge", FORGERIES)
def test_a_forgery_is_refused_by_both(forge: Callable[[], Told], tmp_path: Path) -> None:
    refused_by_both(forge(), tmp_path / "forged.json")


# -- Faults planted in either checker: each is seen in what it says of honest certificates.

FAULTS = {
    "what is carried falls": ([("Flight(*row, age, {}), self.pegs.add(i)", "Flight(*row, age, {}), 0")], [("falls = this.gravity && !this.carried.has(c.i)", "falls = this.gravity")]),
    "what is struck is carried on": (
        [("w.lift(i, self.age)", "pass"), ("        self.carried = bears\n", "        self.carried = self.carried | bears\n")],
        [("of [...carried.keys()].filter(i => !on.has(i))", "of []")],
    ),
    "what leaves rises": (
        [("row = map(operator.sub, self.put(i, age)[:4], self.fallen(age))", "row = map(operator.add, self.put(i, age)[:4], self.fallen(age))")],
        [("side > 0 ? A.add(x[w], fall[w][part][a]) : A.sub(", "side > 0 ? A.add(x[w], fall[w][part][a]) : A.add(")],
    ),
    "what slides stops": (
        [("dict.fromkeys((2, 3) if more or j in self.faces else (), NONE)", "dict.fromkeys((2, 3), NONE)"), ("refuse(known and not more and self.sign", "refuse(0 and self.sign")],
        [("    if (c.face) {\n", "    {\n"), ("refute(`${c.name} slides along a face, which ends`)", "void 0")],
    ),
    "what falls onto what slides meets it where it was": (
        [("speeds = p - vx, q - vy", "speeds = (-vx, -vy) if c[1] in self.pegs else (p - vx, q - vy)")],
        [("(own ? A.sub(x, own[k]) : x)", "x")],
    ),
    "it is below its wall": (
        [("(reach if down < 0 else -reach)", "(reach if down > 0 else -reach)")],
        [("(down < 0 ? A.add(from[w], reach[w])", "(down > 0 ? A.add(from[w], reach[w])")],
    ),
    "it is thinner than it is": (
        [("reach = self.things[i][4] + thick\n", "reach = thick\n")],
        [(": scene.circles[c.i].r[w]));", ": scene.number(ZERO)[w]));")],
    ),
    "the final state falls": (
        [("falls = self.put(i, age)[:4], self.pull and i not in self.pegs", "falls = self.put(i, age)[:4], self.pull")],
        [("gravity && !run.scene.stands(i) && !run.captured[i] && worlds", "gravity && !run.fixed[i] && !run.captured[i] && worlds")],
    ),
}  # fmt: skip
"""Of each what the first checker has instead, and the second."""


@cache
def lot() -> Lot:
    """Runs in which something comes to rest: all of them true, by both checkers."""
    return lot_of(settled_samples().values())


@needs_node
@pytest.mark.parametrize("fault", FAULTS)
def test_planted_faults_are_found(fault: str, tmp_path: Path) -> None:
    first, second = FAULTS[fault]
    mistaken(lax(first), lax_second(second, tmp_path / "faulty"), lot(), tmp_path, 4)


@needs_node
def test_what_a_faulty_checker_says_of_the_end_is_refused(tmp_path: Path) -> None:
    """The states that a checker has in which nothing is carried, or what slides stops, are not those of any run."""
    forged = 0
    for name in ("what slides stops", "it is below its wall", "the final state falls"):
        checker = lax(FAULTS[name][0])
        for cert in [*settled_samples().values()][:20]:
            try:
                other = completed(deepcopy(cert), checker)
            except (checker.Refuted, checker.Unsettled):
                continue
            if other["final"]["circles"] == completed(deepcopy(cert), lax([]))["final"]["circles"]:
                continue
            forged += 1
            refused_by_both(other, tmp_path / "forged.json")
    assert forged > 9


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_a_campaign_of_settled_scenes(tmp_path: Path) -> None:
    """Some hundred random scenes: each run has a certificate, which both verify."""
    from settle_campaign import drawn

    found: dict[str, Told] = {}
    for seed in range(1000, 1400):
        if (scene := drawn(seed)) is not None:
            found[str(seed)] = certificate_of(ExactEngine(work=300_000).run(scene, until=12, events=24))
    assert len(found) > 300
    both_verify(found.items(), tmp_path)


def test_a_run_that_ends_undecided_has_a_certificate_of_few_bits(tmp_path: Path) -> None:
    """What could not be decided took a hundred thousand bits; what came before takes a few hundred."""
    places = [
        ("d", 0, 1, 1),
        ("k", "sqrt(2)/2", 9, 1),
        ("h", 20, 1, 2),
        ("n", "20 + sqrt(2)/2", 9, 2),
    ]  # the same, of other masses
    discs = [Circle(x, y, m=m, id=name) for name, x, y, m in places]
    scene = Scene(discs, [Wall(0, 0, 1, 0, id="w")], gravity=(0, -2), restitution="1/2", settle=True)
    run = ExactEngine(work=200_000).run(scene, until=8)
    assert run.stop.reason is StopReason.UNDECIDED and int(run.plan["bits"]) > 2**15
    told = certificate_of(run)
    assert told["bits"] < 2**12
    both_verify([("few", told)], tmp_path)


def test_a_run_that_ends_amid_infinitely_many_bounces_has_none(tmp_path: Path) -> None:
    """One that ends with the first of them has one, as has one that ends after them."""
    discs = [Circle(0, 6, id="a"), Circle("20 - 29999995/10000000", 100, vx=1, id="b")]
    scene = Scene(discs, [FLOOR], segments=[Segment(21, 0, 21, 200, "side")], restitution="1/2", **LAW)
    runs = {events: ExactEngine().run(scene, until=20, events=events) for events in (20, 21, 22, 23)}
    first = runs[23].settlings[0].since
    assert first is not None and runs[21].final_time.text() == first.text()
    with pytest.raises(
        CertificateError, match="a bounces infinitely often on floor until 3, and the run ends amid that"
    ):
        certificate_of(runs.pop(22))
    both_verify([(str(events), certificate_of(run)) for events, run in runs.items()], tmp_path)
