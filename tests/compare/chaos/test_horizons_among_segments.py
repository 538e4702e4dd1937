"""Horizons of engines among segments: the bands hold as often as they say, and a thing's own sides decide nothing."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest

from truebreak.compare import compare
from truebreak.compare.chaos.certified_chaos import chaos
from truebreak.compare.chaos.foreseen import foreseen
from truebreak.compare.tangent import hazard
from truebreak.compare.tangent.hazard import Course
from truebreak.compare.tangent.impacts import impacts
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Quantity, Scene, SceneError, Segment, Wall

BOX = [Wall(-8, -8, 8, -8), Wall(8, -8, 8, 8), Wall(8, 8, -8, 8), Wall(-8, 8, -8, -8)]


def drawn(seed: int) -> Scene | None:
    """Three discs among three segments in a box."""
    rng = Random(seed)
    at = lambda: Quantity.of(rng.randint(-4000, 4000)) / 1000  # noqa: E731
    try:
        bars = [Segment(at(), at(), at(), at(), id=f"s{k}", r=rng.choice(("0", "1/3"))) for k in range(3)]
        discs = [Circle(-6 + 3 * k, 6, r="1/2", vx=at(), vy=at(), id=f"c{k}") for k in range(3)]
        return Scene(discs, BOX, segments=bars)
    except SceneError:
        return None


def seen_in_bands(seeds: range) -> tuple[int, int]:
    """How often the first divergence falls in the band, and of how many."""
    held = told = 0
    for seed in seeds:
        scene = drawn(seed)
        if scene is None:
            continue
        for horizon in chaos(scene, ["double", "single", "rounded:bits=30", "pymunk"], events=130).horizons:
            if horizon.seen is not None and horizon.seen.place is not None:
                told += 1
                held += horizon.holds(horizon.seen.place)
    return held, told


def test_the_bands_hold_what_is_seen() -> None:
    held, told = seen_in_bands(range(100, 112))
    assert told >= 36
    assert held / told > 0.8


def test_a_hazard_without_ends_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where neither ends nor passing count, engines leave before they are foreseen to."""
    monkeypatch.setattr(hazard, "parts_of", lambda scene: {})
    monkeypatch.setattr(Course, "_circles", lambda self, i, partners: self._walls_of(i, range(len(self._walls)), 0))
    held, told = seen_in_bands(range(100, 112))
    assert held / told < 0.8


@pytest.mark.parametrize(("x", "depth"), [("1", 3.0), ("-5/2", 1.5), ("0", 4.0)])
def test_how_far_a_disc_is_from_passing_a_segment(x: str, depth: float) -> None:
    scene = Scene([Circle(x, 5, vx=0, vy=-1)], segments=[Segment(-3, 0, 3, 0)])
    [[impact]] = impacts(ExactEngine().run(scene), 1)
    course = Course(scene)
    course.fly(float(impact.time))
    found = course.passing(impact)
    assert found is not None
    assert found.depth == pytest.approx(depth)
    assert found.wait == pytest.approx(1.0)  # the ends lie 1 below the centre as the disc touches
    assert len(course.instead([impact], 0).places) == 0  # its other side and its ends are no other meeting


def test_what_would_be_met_instead_is_within_its_range() -> None:
    bars = [Segment(-3, 0, 3, 0, id="near"), Segment(-9, -4, 9, -4, id="far"), Segment(5, -2, 9, -2, id="beside")]
    scene = Scene([Circle(0, 5, vy=-1, id="disc")], segments=bars)
    run = ExactEngine().run(scene)
    [[impact]] = impacts(run, 1)
    course = Course(scene)
    course.fly(float(impact.time))
    others = course.instead([impact], 0)
    np.testing.assert_allclose(others.waits, [4.0])
    np.testing.assert_allclose(others.normals, [[0.0, -1.0]])


def test_a_comparison_foresees_its_engines() -> None:
    scene = drawn(100)
    assert scene is not None
    found = foreseen(compare(scene, ["single", "double"], events=80))
    assert found is not None
    assert found.events == 80
    assert all(horizon is not None for horizon in found.horizons)
