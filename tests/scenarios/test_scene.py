"""Circles, walls and scenes: what is refused, in which words."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Callable
from fractions import Fraction

import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from truebreak.scenarios import Circle, Pocket, Quantity, Scene, SceneError, Segment, TiePolicy, Wall


def refusal(make: Callable[[], object]) -> str:
    """The message with which something is refused."""
    with pytest.raises(SceneError) as error:
        make()
    return str(error.value)


CIRCLES: list[tuple[dict[str, object], str]] = [
    (
        {"x": "1/0", "y": 0, "id": "b3"},
        "circle 'b3': x = '1/0' is not an exact number: division by zero",
    ),
    (
        {"x": 0, "y": 0, "r": 0, "id": "a"},
        "circle 'a': r = 0: a radius must be positive; a point ball says point = true",
    ),
    ({"x": 0, "y": 0, "r": "-1/2", "id": "a"}, "circle 'a': r = -1/2: a radius must be positive"),
    (
        {"x": 0, "y": 0, "r": 1, "point": True, "id": "a"},
        "circle 'a': r = 1: a point ball has r = 0; leave out point, or set r = 0",
    ),
    (
        {"x": 0, "y": 0, "m": 0, "id": "a"},
        "circle 'a': m = 0: a mass must be positive (or \"oo\" for a fixed circle)",
    ),
    (
        {"x": 0, "y": 0, "m": "oo", "vx": 1, "id": "a"},
        "circle 'a': m = oo with velocity (1, 0): a fixed circle never moves; set vx = vy = 0, or give a finite mass",
    ),
    (
        {"x": True, "y": 0, "id": "a"},
        "circle 'a': x = True is not a number; write a whole number or text such as \"9/4\"",
    ),
    ({"x": float("nan"), "y": 0, "id": "a"}, "circle 'a': x = nan is not a finite number"),
    ({"x": 0, "y": 0, "id": ""}, "circle: id = '' is not usable; write 1 to 64 printable characters"),
    (
        {"x": 0, "y": 0, "id": "a\nb"},
        "circle: id = 'a\\nb' is not usable; write 1 to 64 printable characters",
    ),
    ({"x": 0, "y": 0, "point": 1, "id": "a"}, "circle 'a': point = 1 is not true or false"),
    (
        {"x": "x", "y": 0},
        "circle: x = 'x' is not an exact number: 'x' is not allowed; the only function is sqrt",
    ),
]


@pytest.mark.parametrize(("values", "message"), CIRCLES)
def test_a_bad_circle_is_refused(values: dict[str, object], message: str) -> None:
    assert refusal(lambda: Circle(**values)) == message  # type: ignore[arg-type]


def test_a_wall_needs_two_points() -> None:
    assert refusal(lambda: Wall(1, "sqrt(4)", "2/2", 2, id="w")) == (
        "wall 'w': both points are (1, 2); a wall needs two distinct points"
    )


def test_a_pocket_needs_a_radius() -> None:
    assert refusal(lambda: Pocket(0, 0, 0, id="p")) == "pocket 'p': r = 0: a radius must be positive"


SCENES: list[tuple[Callable[[], Scene], str]] = [
    (lambda: Scene([]), "the scene has no circle; add at least one circle"),
    (
        lambda: Scene([Circle(0, 0, id="b1"), Circle("199/100", 0, id="b3")]),
        "circle 'b3': overlaps 'b1' by 1/100 at time 0; move it, or reduce r",
    ),
    (
        lambda: Scene([Circle(0, 0, id="a"), Circle(0, 0, id="b")]),
        "circle 'b': overlaps 'a' by 2 at time 0; move it, or reduce r",
    ),
    (
        lambda: Scene([Circle(0, 0, r=0, point=True, id="a"), Circle(0, 0, r=0, point=True, id="b")]),
        "circle 'b': is the same point as 'a'; move it",
    ),
    (
        lambda: Scene([Circle(0, "1/2", id="a")], [Wall(0, 0, 1, 0, id="floor")]),
        "circle 'a': lies across wall 'floor', by 1/2 at time 0; move it, or reduce r",
    ),
    (
        lambda: Scene([Circle(3, 0, r=0, point=True, id="a")], [Wall(0, 0, 1, 0, id="floor")]),
        "circle 'a': its centre lies on wall 'floor'; move it to one side",
    ),
    (
        lambda: Scene([Circle(0, 0, id="a")], [Wall(2, 0, 2, 1, id="a")]),
        "id 'a' is used twice; give everything an id of its own",
    ),
    (
        lambda: Scene([Circle(0, 0)], reverse_after=1, reverse_at=1),
        "reverse_after and reverse_at are both set; keep one of them",
    ),
    (lambda: Scene([Circle(0, 0)], events=0), "events = 0: must be a whole number from 1"),
    (lambda: Scene([Circle(0, 0)], events=True), "events = True: must be a whole number from 1"),
    (lambda: Scene([Circle(0, 0)], until=0), "until = 0: must be above zero"),
    (
        lambda: Scene([Circle(0, 0)], until="soon"),
        "until = 'soon' is not an exact number: 'soon' is not allowed; the only function is sqrt",
    ),
    (
        lambda: Scene([Circle(0, 0)], tie_policy="fair"),
        "tie_policy 'fair' is not known; choose simultaneous, sequential:order=scene or sequential:seed=N",
    ),
    (lambda: Scene([Circle(0, 0)], name=""), "name = '' is not text; give the scene a name"),
    (lambda: Scene([Circle(0, 0)], capture=1), "capture = 1 is not true or false"),  # type: ignore[arg-type]
]


@pytest.mark.parametrize(("make", "message"), SCENES)
def test_a_bad_scene_is_refused(make: Callable[[], Scene], message: str) -> None:
    assert refusal(make) == message


def test_touching_is_not_overlapping() -> None:
    Scene([Circle(0, 0), Circle("sqrt(2)", "sqrt(2)")])
    Scene([Circle("-sqrt(2)/2", "sqrt(2)/2")], [Wall(-1, -1, 1, 1)])
    Scene([Circle(0, 0, r="1/3"), Circle("2/3", 0, r="1/3")])


@pytest.mark.parametrize("k", [17, 40, 300, 1000])
def test_an_overlap_far_below_the_doubles_is_found(k: int) -> None:
    tiny = f"10**-{k}"
    Scene([Circle(0, 0), Circle(f"sqrt(2) + {tiny}", "sqrt(2)")])
    assert "overlaps" in refusal(lambda: Scene([Circle(0, 0), Circle(f"sqrt(2) - {tiny}", "sqrt(2)")]))
    Scene([Circle(0, f"1 + {tiny}")], [Wall(0, 0, 1, 0)])
    assert "lies across" in refusal(lambda: Scene([Circle(0, f"1 - {tiny}")], [Wall(0, 0, 1, 0)]))


@pytest.mark.parametrize("scale", ["10**-400", "10**-120", "10**120", "10**400"])
def test_no_size_is_too_small_or_too_large(scale: str) -> None:
    def pair(distance: str) -> Scene:
        return Scene([Circle(0, 0, r=scale), Circle(f"{distance}*{scale}", 0, r=scale)])

    assert pair("2").circles[1].r == Quantity.of(scale)
    assert "overlaps" in refusal(lambda: pair("1999/1000"))


@given(st.integers(-40, 40), st.integers(-40, 40), st.integers(1, 20), st.integers(1, 20))
@settings(deadline=None)
def test_circles_overlap_exactly_if_their_centres_are_too_close(x: int, y: int, r: int, s: int) -> None:
    def make() -> Scene:
        other = Circle(Fraction(x, 2), Fraction(y, 2), r=Fraction(s, 2))
        return Scene([Circle(0, 0, r=Fraction(r, 2)), other])

    if x * x + y * y < (r + s) ** 2:
        assert "overlaps" in refusal(make)
    else:
        make()


def test_ids_are_filled_in_by_place() -> None:
    scene = Scene([Circle(0, 0), Circle(9, 0, id="b")], [Wall(20, 0, 20, 1)], pockets=[Pocket(0, 0, 1)])
    assert scene.ids == ("c1", "b", "w1")
    assert scene.pockets[0].id == "p1"


def test_infinite_mass_is_spelled_in_several_ways() -> None:
    for m in ("oo", " oo ", float("inf"), sympy.oo):
        circle = Circle(0, 0, m=m)
        assert circle.fixed
        assert circle.inverse_mass == 0
    assert not Circle(0, 0, m=10**5000).fixed


def test_errors_stay_short() -> None:
    huge = "1" * 15_000
    for make in (
        lambda: Circle(0, 0, r=f"-{huge}"),
        lambda: Circle(0, 0, m=f"-{huge}"),
        lambda: Circle(0, 0, m="oo", vx=huge),
        lambda: Wall(huge, 0, huge, 0),
        lambda: Scene([Circle(0, 0)], until=f"-{huge}"),
        lambda: Scene([Circle(0, 0, r=huge), Circle(1, 0)]),
        lambda: Circle(0, 0, id="x" * 10_000),
    ):
        message = refusal(make)
        assert len(message) < 300
        assert "\n" not in message


def test_the_digest_covers_what_decides_the_history() -> None:
    scene = Scene([Circle(0, 0, vx=1), Circle(5, 0)])
    for same in (
        scene.with_changes(name="other"),
        scene.with_changes(description="x", source="y"),
        scene.with_changes(events=5, until=3),
    ):
        assert same.digest == scene.digest
    for other in (
        scene.with_changes(tie_policy="sequential"),
        scene.with_changes(reverse_after=3),
        scene.with_changes(reverse_at="1/2"),
        scene.with_changes(capture=True),
        scene.with_changes(circles=scene.circles[::-1]),
        scene.with_changes(walls=[Wall(9, 0, 9, 1)]),
        scene.with_changes(circles=[Circle(0, 0, vx="1 + 10**-30", id="c1"), scene.circles[1]]),
    ):
        assert other.digest != scene.digest


def test_tie_policies_are_parsed_and_spelled() -> None:
    for text in ("simultaneous", "sequential:order=scene", "sequential:seed=7"):
        assert str(TiePolicy.parse(text)) == text
    assert TiePolicy.parse("sequential") == TiePolicy.parse("sequential:order=scene")
    for text in ("", "sequential:seed=", "sequential:seed=-1", "sequential:seed=x", "Simultaneous"):
        assert "is not known" in refusal(lambda text=text: TiePolicy.parse(text))


def test_a_scene_that_nobody_holds_is_gone_at_once() -> None:
    """It does not hold itself, which a collector would have to find: the one of many small scenes seldom looks."""
    gc.disable()
    try:
        for segments in ((), (Segment(0, 5, 4, 5),)):
            scene = Scene([Circle(0, 0, vx=1), Circle(4, 0)], segments=segments)
            assert scene.surfaces.surfaces is scene.surfaces
            held = weakref.ref(scene)
            del scene
            assert held() is None
    finally:
        gc.enable()
