"""Any file is verified, refuted or declined within 20 s of processor time, 40 s more a megabyte, and 500 MB."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import pytest

from certificate.checkers import NODE, TOOLS

Told = dict[str, Any]
SECONDS, A_MEGABYTE, MEGABYTES = 20, 40, 500


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


HOSTILE: tuple[Callable[[], Told], ...] = (
    many_terms, pressed, crowd, many_bits, many_motions, long_numbers, many_parts,
)  # fmt: skip


@pytest.mark.parametrize("program", ["verify.py", "verify.mjs"])
@pytest.mark.parametrize("made", HOSTILE)
@pytest.mark.timeout(900)
def test_no_file_costs_more_than_its_size_allows(made: Callable[[], Told], program: str, tmp_path: Path) -> None:
    runner = sys.executable if program.endswith("py") else NODE
    if runner is None:
        pytest.skip("node is not at hand")
    path = tmp_path / "hostile.json"
    path.write_text(json.dumps(made(), separators=(",", ":")), encoding="utf-8")
    with (tmp_path / "said").open("wb") as out:
        process = subprocess.Popen([runner, str(TOOLS / program), str(path)], stdout=out)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    sentence = (tmp_path / "said").read_text(encoding="utf-8")
    assert process.returncode in (0, 1, 2, 4) and sentence.count("\n") == 1
    assert sentence.startswith(("verified: ", "refuted: ", "declined: ", "no certificate: ")), sentence
    assert used.ru_utime + used.ru_stime <= SECONDS + A_MEGABYTE * path.stat().st_size / 1e6, sentence
    assert used.ru_maxrss <= MEGABYTES * 1000, sentence
