"""What may touch is found whatever the sizes and places, and refused in the order in which pairs were looked at."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from random import Random

import pytest
from counted import calls
from hypothesis import given, settings
from hypothesis import strategies as st

from truebreak.scenarios import Circle, Quantity, Scene, SceneError, Wall
from truebreak.scenarios.catalogue import build
from truebreak.scenarios.files import dump_json, dump_toml, loads_json, loads_toml
from truebreak.scenarios.neighbours import Neighbourhood, box, check_apart

NUDGE = Fraction(1, 10**30)
scales = st.sampled_from([Fraction(10) ** k for k in (-320, -160, -30, -3, 0, 0, 0, 3, 30, 160, 320)])


@st.composite
def circles(draw: st.DrawFn) -> list[Circle]:
    """Circles of every size, anywhere, some of them laid to touch the one before, or to miss it by little."""
    made: list[Circle] = []
    unit = draw(scales)
    for k in range(draw(st.integers(1, 12))):
        scale = unit if draw(st.booleans()) else draw(scales)
        r = draw(st.integers(1, 9)) * scale
        x, y = (draw(st.integers(-40, 40)) * scale for _ in range(2))
        if made and draw(st.booleans()):
            last = made[-1]
            beside = Fraction(str(last.r)) + r + draw(st.sampled_from([0, 0, NUDGE, -NUDGE]))
            cos, sin = draw(st.sampled_from([(1, 0), (0, -1), (Fraction(3, 5), Fraction(4, 5))]))
            x, y = Fraction(str(last.x)) + cos * beside, Fraction(str(last.y)) + sin * beside
        made.append(Circle(x, y, r, id=f"c{k}"))
    return made


def gap(a: Circle, b: Circle) -> Quantity:
    return (a.x - b.x) ** 2 + (a.y - b.y) ** 2 - (a.r + b.r) ** 2


@settings(max_examples=400, deadline=None)
@given(circles())
def test_whatever_touches_or_overlaps_is_near(made: list[Circle]) -> None:
    near = Neighbourhood([box(circle) for circle in made])
    for j, b in enumerate(made):
        found = near.around(j)
        near.enter(j)
        assert found == sorted(set(found))
        assert {i for i, a in enumerate(made[:j]) if gap(a, b).sign() <= 0} <= set(found)


@settings(max_examples=200, deadline=None)
@given(circles(), st.booleans())
def test_scenes_are_refused_as_if_every_pair_had_been_looked_at(made: list[Circle], leave: bool) -> None:
    kept: list[Circle] = []
    for circle in made:
        if not leave or all(gap(circle, other).sign() >= 0 for other in kept):
            kept.append(circle)
    bad = next(((a, b) for j, b in enumerate(kept) for a in kept[:j] if gap(a, b).sign() < 0), None)
    if bad is None:
        pairs = [(i, j) for i, j in combinations(range(len(kept)), 2) if gap(kept[i], kept[j]).sign() == 0]
        assert list(check_apart(kept, [])) == pairs
    else:
        with pytest.raises(SceneError, match=f"^circle '{bad[1].id}': overlaps '{bad[0].id}' by"):
            check_apart(kept, [])


@settings(max_examples=200, deadline=None)
@given(st.integers(-9, 9), st.integers(1, 9), st.integers(-1, 1), scales, scales)
def test_a_circle_by_a_wall_is_decided_at_every_scale(
    along: int, r: int, side: int, scale: Fraction, length: Fraction
) -> None:
    """A wall in the direction (3, 4), and a circle at a distance of its radius, or 10**-40 of it nearer or farther."""
    cos, sin = Fraction(3, 5), Fraction(4, 5)
    away = r * (1 + Fraction(side, 10**40))
    x, y = (scale * (along * c + away * n) for c, n in ((cos, -sin), (sin, cos)))
    circle, wall = Circle(x, y, r * scale, id="a"), Wall(0, 0, cos * length, sin * length, id="w")
    if side < 0:
        with pytest.raises(SceneError, match=r"^circle 'a': lies across wall 'w'"):
            check_apart([circle], [wall])
    else:
        assert check_apart([circle], [wall]) == (() if side else ((0, 1),))


def scattered(n: int, seed: int) -> list[Circle]:
    """n circles of sizes from 1 to 2**9 on a grid wide enough for all."""
    draw = Random(seed)
    side = int(n**0.5) + 1
    return [Circle(1100 * (k % side), 1100 * (k // side), 2 ** draw.randrange(10), vx=1, id=f"c{k}") for k in range(n)]


def test_set_up_grows_with_the_number_of_circles() -> None:
    few, many = (calls(lambda n=n: Scene(scattered(n, 1))) for n in (500, 4_000))
    assert many < 9 * few


def test_catalogue_and_files_grow_with_the_number_of_discs() -> None:
    def told(n: int) -> list[int]:
        scene = build(f"gas:n={n}")
        texts = dump_json(scene), dump_toml(scene)
        return [
            calls(lambda: build(f"gas:n={n}")),
            calls(lambda: loads_json(texts[0])),
            calls(lambda: loads_toml(texts[1])),
        ]

    for few, many in zip(told(250), told(2_000), strict=True):
        assert many < 10 * few


def test_ten_thousand_discs_are_a_scene() -> None:
    scene = build("gas:n=10000")
    assert len(scene.circles) == 10_000
    assert scene.touching == ()
    assert loads_json(dump_json(scene)) == scene


def test_all_circles_in_one_place_are_refused_at_the_first_two() -> None:
    same = [Circle(0, 0, id=f"c{k}") for k in range(2_000)]
    with pytest.raises(SceneError, match=r"^circle 'c1': overlaps 'c0' by 2 at time 0"):
        check_apart(same, [])


def test_a_change_of_words_keeps_what_touches() -> None:
    scene = Scene([Circle(0, 0, id="a"), Circle(2, 0, id="b")])
    named = scene.with_changes(name="pair", until=3)
    assert (named.name, named.touching, named.circles is scene.circles) == ("pair", ((0, 1),), True)
    assert scene.name == "scene"
    assert scene.with_changes(circles=[Circle(0, 0), Circle(3, 0)]).touching == ()
    with pytest.raises(SceneError, match="until"):
        scene.with_changes(until=-1)
