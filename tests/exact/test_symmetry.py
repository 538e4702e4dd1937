"""Symmetric scenes: what a mirror or a rotation of a scene leads to, and what the least flaw changes.

What proves ties is the form of causal pasts (`test_log_symmetry`): a scene's own symmetry, and its end, do not.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest
from flint import arb  # type: ignore[attr-defined]

from truebreak.exact import ExactEngine
from truebreak.exact.log_symmetry import FixedProjections, LogSymmetry, Past, Symmetry, symmetries
from truebreak.exact.numbers.ball import field_ball
from truebreak.scenarios import Circle, Contact, Quantity, Scene, StopReason, Trajectory, Wall, catalogue
from truebreak.scenarios.trajectory import TieProof

pytestmark = pytest.mark.usefixtures("long_balls")

INSTANTS = 300
TINY = Quantity.of("10**-30")
INSCRIBED = (3, 4, 5, 6, 8)
BITS = 400
"""Precision at which final states are compared."""
RACK = "rack:rows=5,gap=0"
OPEN_RACK = "rack:rows=3,gap=1/50,pockets=no"


def run(scene: Scene, events: int = INSTANTS) -> Trajectory:
    return ExactEngine().run(scene, events=events)


def images(scene: Scene, symmetry: Symmetry) -> Callable[[Contact], Contact]:
    """From a contact to its image."""
    places = {name: place for place, name in enumerate(scene.ids)}
    to = [*symmetry.circles, *(len(scene.circles) + wall for wall in symmetry.walls)]

    def image(contact: Contact) -> Contact:
        i, j = sorted(to[places[name]] for name in contact)
        return Contact(scene.ids[i], scene.ids[j])

    return image


def assert_symmetric_instants(trajectory: Trajectory, symmetry: Symmetry) -> None:
    """The image of every instant's contacts is the same contacts."""
    image = images(trajectory.scene, symmetry)
    for event in trajectory.events:
        assert set(map(image, event.contacts)) == set(event.contacts), event.index


def final_rows(trajectory: Trajectory) -> list[list[arb]]:
    """x, y, vx, vy of every circle at the end, as balls."""
    return [[c.x.ball(BITS), c.y.ball(BITS), c.vx.ball(BITS), c.vy.ball(BITS)] for c in trajectory.final.circles]


def assert_symmetric_state(trajectory: Trajectory, *found: Symmetry) -> None:
    """Every circle's final place and velocity are those of its image, mapped, to a hundred digits."""
    rows = final_rows(trajectory)
    for symmetry in found:
        a, b, c, d = (field_ball(entry, BITS) for entry in symmetry.matrix)
        cx, cy = (field_ball(part, BITS) for part in symmetry.centre)
        for (x, y, vx, vy), place in zip(rows, symmetry.circles, strict=True):
            x, y = x - cx, y - cy
            image = (a * x + b * y + cx, c * x + d * y + cy, a * vx + b * vy, c * vx + d * vy)
            for number, expected in zip(rows[place], image, strict=True):
                assert (number - expected).abs_upper() < arb(10) ** -100


# -- what symmetry proves


def test_a_touching_rack_is_mirror_symmetric_to_the_last() -> None:
    scene = catalogue.build(RACK)
    trajectory = run(scene)
    assert trajectory.certified
    assert (len(trajectory.events), trajectory.stop.reason) == (INSTANTS, StopReason.EVENTS)
    (mirror,) = symmetries(scene)
    assert mirror.mirror
    assert_symmetric_instants(trajectory, mirror)
    assert_symmetric_state(trajectory, mirror)
    for circle, place in zip(trajectory.final.circles, mirror.circles, strict=True):
        other = trajectory.final.circles[place]
        assert (float(circle.x), float(circle.vx)) == (float(other.x), float(other.vx))
        assert float(circle.vy) == -float(other.vy)
    assert any(tie.proof is TieProof.SYMMETRY for event in trajectory.events[-20:] for tie in event.ties)


def test_a_ball_on_the_mirror_line_stays_there() -> None:
    """The cue and the apex never leave the axis: their transverse velocity is exactly zero."""
    trajectory = run(catalogue.build(RACK))
    for name in ("cue", "b1"):
        circle = trajectory.final[name]
        assert (float(circle.y), float(circle.vy)) == (21.0, 0.0)
        assert circle.vy.ball(BITS) == 0


@pytest.mark.parametrize("n", INSCRIBED)
def test_inscribed_circles_keep_their_rotations(n: int) -> None:
    scene = catalogue.build(f"inscribed:n={n}")
    trajectory = run(scene)
    assert trajectory.certified
    assert (len(trajectory.events), trajectory.stop.reason) == (INSTANTS, StopReason.EVENTS)
    found = symmetries(scene)
    assert len(found) == n - 1
    assert not any(symmetry.mirror for symmetry in found)
    for symmetry in found:
        assert_symmetric_instants(trajectory, symmetry)
    assert_symmetric_state(trajectory, *found)
    assert all(len(event.contacts) % n == 0 or 2 * len(event.contacts) == n for event in trajectory.events)


@pytest.mark.parametrize("n", INSCRIBED)
def test_without_spin_there_are_mirrors_too(n: int) -> None:
    scene = catalogue.build(f"inscribed:n={n},spin=0")
    found = symmetries(scene)
    assert [symmetry.mirror for symmetry in found].count(True) == n
    assert len(found) == 2 * n - 1
    trajectory = run(scene, 30)
    assert trajectory.certified
    for symmetry in found:
        assert_symmetric_instants(trajectory, symmetry)


def test_a_tie_by_symmetry_is_between_a_contact_and_its_image() -> None:
    scene = catalogue.build(RACK)
    (mirror,) = symmetries(scene)
    image = images(scene, mirror)
    seen = 0
    for event in run(scene).events:
        for tie in event.ties:
            if tie.proof is TieProof.SYMMETRY:
                first, second = tie.contacts
                assert image(first) == second
                seen += 1
    assert seen > 100


def test_a_circle_that_two_mirrors_keep_stands_still() -> None:
    """Four balls fly at one in the middle."""
    around = [Circle(x, y, vx=-x // 6, vy=-y // 6) for x, y in ((6, 0), (0, 6), (-6, 0), (0, -6))]
    scene = Scene([Circle(0, 0, id="middle"), *around])
    held = FixedProjections(scene, LogSymmetry(scene, Past([True] * 5, [])))
    assert held
    projection = held(0)
    assert projection is not None
    matrix, centre = projection
    assert all(entry == 0 for entry in matrix)
    assert centre == (0, 0)
    assert held(1) is not None  # it flies along its own mirror line
    trajectory = run(scene)
    assert [float(v) for v in (trajectory.final["middle"].vx, trajectory.final["middle"].vy)] == [0, 0]
    assert len(trajectory.events[0].contacts) == 4


# -- finding them


def test_turned_mirrors_and_walls_are_found() -> None:
    """A mirror line along (3, 4), with a wall at right angles to it."""

    def turned(x: int, y: int) -> tuple[Quantity, Quantity]:
        c, s = Quantity.of("3/5"), Quantity.of("4/5")
        return c * x - s * y, s * x + c * y

    circles = [Circle(*turned(x, y), 1, *turned(vx, 0)) for x, y, vx in ((0, 0, 1), (9, 2, 0), (9, -2, 0))]
    wall = Wall(*turned(20, 0), *turned(20, 1))
    scene = Scene(circles, [wall])
    (mirror,) = symmetries(scene)
    assert (mirror.circles, mirror.walls, mirror.mirror) == ((0, 2, 1), (0,), True)
    trajectory = run(scene, 20)
    assert_symmetric_instants(trajectory, mirror)
    assert_symmetric_state(trajectory, mirror)


def test_a_lone_circle_among_walls_is_mirrored_by_its_velocity() -> None:
    scene = Scene([Circle(0, 0, vx=-1)], [Wall(-9, 0, 0, 9), Wall(-9, 0, 0, -9)])
    (mirror,) = symmetries(scene)
    assert mirror.walls == (1, 0)


def test_a_scene_without_symmetry_has_none() -> None:
    for spec in ("gas", "rack:jitter=1/1000", "rack:offset=10**-30", "lee", "inscribed:n=3,r=1"):
        scene = catalogue.build(spec)
        expected = {"lee": 1, "inscribed:n=3,r=1": 2}.get(spec, 0)
        assert len(symmetries(scene)) == expected, spec
