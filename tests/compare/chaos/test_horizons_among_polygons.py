"""Horizons of engines among polygons, convex and not: the bands hold as often as they say."""

from __future__ import annotations

from functools import cache
from random import Random

import pytest

from truebreak.compare import compare
from truebreak.compare.chaos.certified_chaos import chaos
from truebreak.compare.chaos.foreseen import foreseen
from truebreak.compare.tangent.hazard import Course
from truebreak.compare.tangent.impacts import impacts
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Polygon, Quantity, Scene, SceneError, Wall

BOX = [Wall(-8, -8, 8, -8), Wall(8, -8, 8, 8), Wall(8, 8, -8, 8), Wall(-8, 8, -8, -8)]
HOOK = [(0, 0), (6, 0), (6, 6), (0, 6), (0, 4), (4, 4), (4, 2), (0, 2)]


def drawn(seed: int) -> Scene | None:
    """Three discs among two polygons in a box, one of which is not convex."""
    rng = Random(seed)
    at = lambda: Quantity.of(rng.randint(-4000, 4000)) / 1000  # noqa: E731
    dart = [(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)]
    try:
        x, y = at(), at()
        solids = [
            Polygon([(x + a, y + b) for a, b in dart], "dart", rng.choice(("0", "1/3"))),
            Polygon([(at(), at()) for _ in range(3)], "wedge"),
        ]
        discs = [Circle(-6 + 3 * k, 7, r="1/2", vx=at(), vy=at(), id=f"c{k}") for k in range(3)]
        return Scene(discs, BOX, polygons=solids)
    except SceneError:
        return None


@cache
def scenes() -> tuple[Scene, ...]:
    """The first eight."""
    return tuple([scene for seed in range(100) if (scene := drawn(seed)) is not None][:8])


def seen_in_bands() -> tuple[int, int]:
    """How often the first divergence falls in the band, and of how many."""
    held = told = 0
    for scene in scenes():
        for horizon in chaos(scene, ["double", "single", "rounded:bits=30"], events=120).horizons:
            if horizon.seen is not None and horizon.seen.place is not None:
                told += 1
                held += horizon.holds(horizon.seen.place)
    return held, told


def test_the_bands_hold_what_is_seen() -> None:
    held, told = seen_in_bands()
    assert told >= 18
    assert held / told > 0.75


@pytest.mark.parametrize(
    ("x", "y", "vx", "vy", "depth", "wait"),
    [
        ("-9", "5", "1", "0", 1.5, 0.5),  # onto the upper jaw: up, past its corner
        ("-9", "1", "1", "0", 1.5, 0.5),
        ("2", "9", "0", "-1", 2.5, 0.5),  # from above: to the left, past its corner
    ],
)
def test_how_far_a_disc_is_from_passing_what_is_not_convex(
    x: str, y: str, vx: str, vy: str, depth: float, wait: float
) -> None:
    scene = Scene([Circle(x, y, r="1/2", vx=vx, vy=vy)], polygons=[Polygon(HOOK, "hook")])
    [[impact], *_] = impacts(ExactEngine().run(scene), 1)
    course = Course(scene)
    course.fly(float(impact.time))
    found = course.passing(impact)
    assert found is not None
    assert (found.depth, found.wait) == (pytest.approx(depth), pytest.approx(wait))


def test_the_other_face_of_a_concave_corner_is_another_meeting() -> None:
    nook = Polygon([(-9, -9), (9, -9), (9, 0), (0, 0), (0, 9), (-9, 9)], id="nook")
    for solid, others in ((nook, [0.5]), (Polygon([(0, 0), (9, 0), (9, -9), (0, -9)], "box"), [])):
        scene = Scene([Circle(5, "9/2", vx=-1, vy=-1, id="c")], polygons=[solid])
        [[impact], *_] = impacts(ExactEngine().run(scene), 1)
        course = Course(scene)
        course.fly(float(impact.time))
        assert [pytest.approx(wait) for wait in others] == course.instead([impact], 0).waits.tolist()


def test_a_comparison_foresees_its_engines() -> None:
    found = foreseen(compare(scenes()[0], ["single", "double"], events=60))
    assert found is not None
    assert found.events == 60
    assert all(horizon is not None for horizon in found.horizons)
