"""What the project runs, certified and verified by both checkers: the catalogue, gases, racks, coincidences."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Any

import pytest
from fuzz.generators import KINDS, case_of

from certificate.checkers import both_verify
from truebreak.compare.certificate import CertificateError, certificate_of
from truebreak.exact import ExactEngine
from truebreak.scenarios import catalogue
from truebreak.scenarios.trajectory import StopReason, Trajectory

NOTHING = "the run stopped within time 0"


def gases(count: int) -> Iterator[tuple[str, Trajectory]]:
    """Random gases of 2 to 12 discs, some of mixed sizes."""
    for seed in range(count):
        draw = Random(f"gas {seed}")
        spec = f"gas:n={draw.randrange(2, 13)},seed={seed},mixed={draw.choice(['yes', 'no'])}"
        yield spec, ExactEngine().run(catalogue.build(spec), events=draw.randrange(10, 60))


def racks(count: int) -> Iterator[tuple[str, Trajectory]]:
    """Racks that touch, that do not, that are jittered, hit off the axis, and under other tie policies."""
    for seed in range(count):
        draw = Random(f"rack {seed}")
        gap = draw.choice(["0", "1/50", "1/1000"])
        jitter = draw.choice(["0", "1/10000"]) if gap != "0" else "0"
        tie = draw.choice(["simultaneous", "simultaneous", "sequential", f"sequential:seed={seed}"])
        rows, offset = draw.randrange(2, 5), draw.choice(["0", "0", "1/10"])
        spec = f"rack:rows={rows},gap={gap},jitter={jitter},seed={seed},offset={offset},tie={tie}"
        yield spec, ExactEngine().run(catalogue.build(spec), events=12)


def coincidences(count: int) -> Iterator[tuple[str, Trajectory]]:
    """Cases of the fuzz, all kinds in turn."""
    for number in range(count):
        kind, seed = KINDS[number % len(KINDS)], 1000 + number // len(KINDS)
        case = case_of(kind, seed)
        run = ExactEngine(work=300_000).run(case.scene, until=case.until, events=min(case.events or 20, 20))
        yield f"{kind}-{seed}", run


def whole_catalogue(_: int) -> Iterator[tuple[str, Trajectory]]:
    """Every family with its defaults, but for what falls onto something round."""
    for name in catalogue.names():
        scene = catalogue.build(name)
        if scene.elastic and not (scene.gravity is not None and scene.surfaces.pegs):
            yield name, ExactEngine().run(scene)


def certified(runs: Iterator[tuple[str, Trajectory]]) -> Iterator[tuple[str, dict[str, Any]]]:
    """The certificate of each run; only a run that told nothing may be without."""
    for name, run in runs:
        try:
            yield name, certificate_of(run)
        except CertificateError as error:
            within = run.stop.reason is StopReason.BUDGET and not run.events
            assert within and NOTHING in str(error), f"{name}: {error}"


@pytest.mark.parametrize(
    ("runs", "count"),
    [
        (gases, 6),
        (racks, 4),
        (coincidences, 29),
        pytest.param(whole_catalogue, 0, marks=pytest.mark.slow),
        pytest.param(gases, 300, marks=pytest.mark.slow),
        pytest.param(racks, 100, marks=pytest.mark.slow),
        pytest.param(coincidences, 500, marks=pytest.mark.slow),
    ],
)
@pytest.mark.timeout(3600)
def test_every_run_has_a_certificate_that_both_checkers_verify(runs: Any, count: int, tmp_path: Path) -> None:
    both_verify(certified(runs(count)), tmp_path)


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_ten_thousand_events_of_a_gas(tmp_path: Path) -> None:
    run = ExactEngine().run(catalogue.build("gas"), events=10_000)
    both_verify([("gas", certificate_of(run))], tmp_path)
