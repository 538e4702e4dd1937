"""Any file is verified, refuted or declined within 20 s of processor time, 40 s more a megabyte, and 500 MB."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import pytest

from certificate.checkers import NODE, TOOLS
from certificate.samples import built
from truebreak.compare.certificate import certificate_json, certificate_of, prover
from truebreak.compare.certificate.tower import Exact
from truebreak.exact import ExactEngine
from truebreak.scenarios import catalogue
from truebreak.tools import verify

Told = dict[str, Any]
SECONDS, A_MEGABYTE, MEGABYTES = 20, 40, 500

WRITING = 0.6
"""How many times the work of a check a certificate may cost to be written: the writer looks at two in whole numbers."""

MEASURED = """
import resource, subprocess, sys
done = subprocess.run(sys.argv[1:])
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime, used.ru_maxrss, file=sys.stderr)
sys.exit(done.returncode)
"""
"""A process's largest size has that of the one it was forked from: this is a small one, and a run of tests is not."""


def circle(name: int, x: int, y: int = 0, vx: str = "0", r: str = "1", w: str = "1") -> Told:
    """A circle of a certificate."""
    return {"id": str(name), "x": str(x), "y": str(y), "vx": vx, "vy": "0", "r": r, "w": w}


def told(circles: list[Told], *entries: Told, bits: int = 160, **values: Any) -> Told:
    """A certificate of circles of which nothing but this is told."""
    final = {"time": "0", "circles": [[row[key] for key in ("x", "y", "vx", "vy")] for row in circles]}
    scene = {"tie_policy": "simultaneous", "circles": circles, **values.pop("scene", {})}
    parts = {"roots": [], "isometries": [], "end": {"reason": "quiet"}, "final": final, "bits": bits, **values}
    first = list(entries) or [{"time": "0"}]
    return {"format": "truebreak/certificate-3", "writer": "forger", "scene": scene, "instants": first, **parts}


def many_terms() -> Told:
    """A matrix of sums of products of 99 roots."""
    draw = Random("terms")
    term = "+".join("1*" + "*".join(f"r{k}" for k in sorted(draw.sample(range(1, 100), 33))) for _ in range(500))
    motion = {"matrix": [term] * 4, "shift": ["0", "0"], "map": []}
    return told([circle(0, 0)], roots=["2"] * 99, isometries=[motion])


def pressed() -> Told:
    """450 points at one place strike a fixed disc at once: a round of 450 impulses."""
    points = [circle(k, 1, vx="-1", r="0") for k in range(1, 451)]
    met = [[0, k] for k in range(1, 451)]
    final = {"time": "0", "circles": [["0.0"] * 4, *([["1.0", "0.0", "1.0", "0.0"]] * 450)]}
    return told([circle(0, 0, w="0"), *points], {"time": "0", "met": met, "rounds": [met]}, final=final)


def crowd() -> Told:
    """A thousand circles at rest."""
    return told([circle(k, 4 * (k % 32), 4 * (k // 32)) for k in range(1000)])


def many_bits() -> Told:
    """A thousand walls at a million bits."""
    wall = {"y0": "0", "y1": "1", "length": "1"}
    walls = [{"id": f"w{k}", "x0": str(k + 9), "x1": str(k + 9), **wall} for k in range(1000)]
    return told([circle(0, 0)], bits=1 << 20, scene={"walls": walls})


def many_motions() -> Told:
    """The identity, again and again, of a hundred circles."""
    motion = {"matrix": ["1", "0", "0", "1"], "shift": ["0", "0"], "map": [[k, k] for k in range(100)]}
    return told([circle(k, 4 * k) for k in range(100)], isometries=[motion] * 300)


def long_numbers() -> Told:
    """Fractions of a hundred thousand digits."""
    draw = Random("digits")
    rows = ["".join(draw.choices("123456789", k=100_000)) for _ in range(8)]
    cert = told([circle(k, 0) for k in range(4)])
    for row, (top, bottom) in zip(cert["scene"]["circles"], zip(rows[::2], rows[1::2], strict=True), strict=True):
        row["x"] = f"{top}/{bottom}"
    cert["final"]["circles"] = [["1.0", "0.0", "0.0", "0.0"]] * 4
    return cert


def many_parts() -> Told:
    """Two million lists that are no roots."""
    return told([circle(0, 0)], roots=[[]] * 2_000_000)


def many_isometries_to_sign() -> Told:
    """Isometries of nested roots, the zeros of which have to be told from what is very near to them."""
    roots = ["2", *(f"{k + 2}+1*r{k}" for k in range(1, 60))]
    motions = [
        {
            "matrix": ["1", "0", "0", "1"],
            "shift": [f"1*r{k}-1*r{k}", f"1*r{k}*r{k}-{k + 1}-1*r{k - 1}"],
            "map": [[0, 0]],
        }
        for k in range(2, 60)
    ]
    return told([circle(0, 0)], roots=roots, isometries=motions * 100)


def deep_roots() -> Told:
    """99 roots, each of the one before and a square of sums of all: products that multiply out to many terms."""
    sums = ("+".join(f"1*r{j}" for j in range(max(1, k - 20), k + 1)) for k in range(1, 99))
    roots = ["2", *(f"3+{text}" for text in sums)]
    term = "+".join(f"1*r{j}*r{j + 1}" for j in range(60, 99))
    motion = {"matrix": [term] * 4, "shift": ["0", "0"], "map": [[0, 0]]}
    return told([circle(0, 0)], roots=roots, isometries=[motion])


def powers_of_roots() -> Told:
    """One root to the power of a million."""
    return told([circle(0, 0)], roots=["2", "1+1" + "*r1" * 1_000_000])


def powers_of_a_sum() -> Told:
    """The last of nested roots, again and again: its square is a sum with the one before, and so on."""
    roots = ["2", *(f"1+1*r{k}" for k in range(1, 40))]
    motion = {"matrix": ["1" + "*r40" * 3000, "0", "0", "1"], "shift": ["0", "0"], "map": []}
    return told([circle(0, 0)], roots=roots, isometries=[motion])


def many_terms_of_one_number() -> Told:
    """A sum of a million terms."""
    cert = told([circle(0, 0)])
    cert["end"] = {"reason": "horizon", "until": "+".join(["1/3"] * 1_000_000)}
    return cert


def sums_of_unlike_fractions() -> Told:
    """A sum of ten thousand fractions over different primes' products: its denominator grows with each."""
    cert = told([circle(0, 0)])
    cert["end"] = {"reason": "horizon", "until": "+".join(f"1/{k}{k}{k}7" for k in range(1000, 21_000))}
    return cert


def equal_comparisons() -> Told:
    """Circles at one place with one velocity: gaps that no interval tells from zero."""
    cert = told([circle(k, 0, r="1*r1") for k in range(300)], roots=[])
    cert["scene"]["roots"] = ["2"]
    for k, row in enumerate(cert["scene"]["circles"]):
        row["x"] = f"{2 * k}*r1"
    return cert


def many_witnesses() -> Told:
    """A hundred thousand witnesses for one number, none of which shows it."""
    motion = {"matrix": ["1", "0", "0", "1"], "shift": ["0", "0"], "map": [[k, k] for k in range(100)]}
    zeros = [["gap", [0, 1], 0, [0, 1]]] * 100_000
    cert = told([circle(k, 0, r="1*r1") for k in range(100)], isometries=[motion])
    cert["scene"]["roots"] = ["2"]
    for k, row in enumerate(cert["scene"]["circles"]):
        row["x"] = f"{2 * k}*r1"
    met = [[k, k + 1] for k in range(99)]
    cert["instants"] = [{"time": "0", "met": met, "zeros": zeros}]
    return cert


def many_instants() -> Told:
    """Two hundred thousand instants of a thousand circles."""
    cert = told([circle(k, 4 * (k % 32), 4 * (k // 32), vx="1") for k in range(1000)], {"time": "0"})
    cert["instants"] += [{"time": str(k), "exact": str(k)} for k in range(1, 200_000)]
    return cert


def long_decimals() -> Told:
    """Final numbers of a hundred thousand digits before and after the point."""
    cert = told([circle(k, 4 * k) for k in range(80)])
    cert["final"]["circles"] = [["0" * 100_000 + "." + "0" * 99_000, "0", "0", "0"] for _ in range(80)]
    return cert


def deep_lists() -> Told:
    """Lists in lists."""
    cert = told([circle(0, 0)])
    inner: Any = []
    for _ in range(900):
        inner = [inner]
    return {**cert, "isometries": inner}


def long_impulses() -> Told:
    """Impulses that are told with fifty thousand digits, of a hundred contacts."""
    digits = "7" * 50_000
    cert = told([circle(0, 0, w="0"), *(circle(k, 1, vx="-1", r="0") for k in range(1, 101))])
    met = [[0, k] for k in range(1, 101)]
    cert["instants"] = [{"time": "0", "met": met, "rounds": [[[0, k, f"{digits}/{digits}3"] for k in range(1, 101)]]}]
    cert["final"]["circles"] = [["0.0"] * 4, *([["1.0", "0.0", "1.0", "0.0"]] * 100)]
    return cert


def many_walls_and_circles() -> Told:
    """As many pairs as may be."""
    walls = [
        {"id": f"w{k}", "x0": str(k + 9), "x1": str(k + 9), "y0": "0", "y1": "1", "length": "1"} for k in range(40)
    ]
    return told([circle(k, -4 * (k % 32), 4 * (k // 32)) for k in range(980)], bits=900, scene={"walls": walls})


HOSTILE: tuple[Callable[[], Told], ...] = (
    many_terms, pressed, crowd, many_bits, many_motions, long_numbers, many_parts, many_isometries_to_sign, deep_roots,
    powers_of_roots, powers_of_a_sum, many_terms_of_one_number, sums_of_unlike_fractions, equal_comparisons,
    many_witnesses, many_instants, long_decimals, deep_lists, long_impulses, many_walls_and_circles,
)  # fmt: skip
SHORT = pressed, deep_roots, powers_of_a_sum, many_witnesses, deep_lists
"""Those that are tried each time; all of them take minutes."""

CASES = [made if made in SHORT else pytest.param(made, marks=pytest.mark.slow) for made in HOSTILE]


def slowness() -> float:
    """How many times as long a loop takes here, right now, as where the seconds were measured; 1 at least."""
    begun, total = time.process_time(), 0
    for k in range(LOOP):
        total += k
    return max(1.0, (time.process_time() - begun) / LOOP_SECONDS)


LOOP, LOOP_SECONDS = 5_000_000, 0.2
"""Additions of a loop, and what they take where the bounds were set."""


@pytest.mark.parametrize("program", ["verify.py", "verify.mjs"])
@pytest.mark.parametrize("made", CASES)
@pytest.mark.timeout(900)
def test_no_file_costs_more_than_its_size_allows(made: Callable[[], Told], program: str, tmp_path: Path) -> None:
    runner = sys.executable if program.endswith("py") else NODE
    if runner is None:
        pytest.skip("node is not at hand")
    path = tmp_path / "hostile.json"
    path.write_text(json.dumps(made(), separators=(",", ":")), encoding="utf-8")
    with (tmp_path / "said").open("wb") as out:
        asked = [sys.executable, "-S", "-c", MEASURED, runner, str(TOOLS / program), str(path)]
        process = subprocess.run(asked, stdout=out, stderr=subprocess.PIPE, text=True, check=False)
    seconds, size = map(float, process.stderr.split()[-2:])
    sentence = (tmp_path / "said").read_text(encoding="utf-8")
    assert process.returncode in (0, 1, 2, 4) and sentence.count("\n") == 1
    assert sentence.startswith(("verified: ", "refuted: ", "declined: ", "not decided: ", "no certificate: ")), sentence
    assert seconds <= slowness() * (SECONDS + A_MEGABYTE * path.stat().st_size / 1e6), sentence
    assert size <= MEGABYTES * 1000, sentence


class Forgetful(set[Any]):
    """A set in which nothing stays."""

    def add(self, _: Any) -> None:
        """Nothing."""


def written_over_checked(folder: Path) -> float:
    """How many times the counted work of a check the checker's own program does when a certificate is written."""
    run = built("gas", 600)
    verify.cost.work = 0
    told = certificate_of(run)
    written, path = verify.cost.work, folder / "gas.json"
    path.write_text(certificate_json(told), encoding="utf-8")
    assert verify.verdict(path)[0] == 0
    return written / verify.cost.work


def test_writing_does_the_work_of_checking_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of what is asked for to gather an instant, nothing is asked once more; a writer that forgets it does far more."""
    assert written_over_checked(tmp_path) <= WRITING
    gather = prover.Prover.instant

    def forgetful(self: prover.Prover, entry: dict[str, Any]) -> None:
        self.cleared = Forgetful()
        gather(self, entry)

    monkeypatch.setattr(prover.Prover, "instant", forgetful)
    assert written_over_checked(tmp_path) > WRITING


def test_a_face_on_the_line_of_another_takes_no_exact_number() -> None:
    """A point that meets one rim of the mushroom is on the line of the other rim, and beside it: balls tell that."""
    run = ExactEngine().run(catalogue.build("mushroom"), events=150)
    met = [name for event in run.events for _, name in event.contacts]
    assert met.count("rim right") > 2 and met.count("rim left") > 2
    made = certificate_of(run)
    assert Exact.work == 0 and not any(part.get("zeros") for part in made["instants"])
