"""What breaks the symmetry of a scene: the least flaw, what takes part, an order once chosen."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from flint import arb  # type: ignore[attr-defined]
from test_symmetry import BITS, OPEN_RACK, TINY, assert_symmetric_instants, assert_symmetric_state, images, run
from touch import assert_all_touch, proofs

from truebreak.exact.log_symmetry import symmetries
from truebreak.floating import IntervalEngine
from truebreak.scenarios import Circle, Contact, Quantity, Scene, StopReason, Trajectory, Wall, catalogue
from truebreak.scenarios.trajectory import TieProof

pytestmark = pytest.mark.usefixtures("long_balls")

# -- what breaks it


def nudged(scene: Scene, name: str, **changes: Quantity) -> Scene:
    """The scene with some numbers of one circle or wall changed by these amounts."""

    def copy(thing: Circle | Wall, keys: tuple[str, ...]) -> Any:
        values = {key: getattr(thing, key) for key in keys}
        if thing.id == name:
            values |= {key: values[key] + amount for key, amount in changes.items()}
        return type(thing)(**values, id=thing.id)

    return scene.with_changes(
        circles=[copy(c, ("x", "y", "r", "vx", "vy", "m")) for c in scene.circles],
        walls=[copy(w, ("x0", "y0", "x1", "y1")) for w in scene.walls],
    )


FLAWS = {"x": TINY, "y": TINY, "vx": TINY, "vy": -TINY, "m": TINY, "r": -TINY}


def pasts_of_ties(trajectory: Trajectory) -> Iterator[tuple[set[str], set[str]]]:
    """For each tie by symmetry, the circles and walls on which either contact depends."""
    movable = {circle.id for circle in trajectory.scene.circles if not circle.fixed}
    cone = {name: {name} for name in trajectory.scene.ids}
    for event in trajectory.events:
        for tie in event.ties:
            if tie.proof is TieProof.SYMMETRY:
                first, second = (cone[contact.first] | cone[contact.second] for contact in tie.contacts)
                yield first, second
        for _ in event.contacts:  # as often as a round may reach one circle further
            for contact in event.contacts:
                met = cone[contact.first] | cone[contact.second]
                for name in movable & set(contact):
                    cone[name] = met


def assert_flaw_noticed(flawed: Scene, whole: Scene, alone: str | None = None, events: int = 60) -> None:
    """Some instant parted, the ties left are ties, and the very history that long intervals certify.

    Args:
        alone: a circle whose kind no other has: what depends on it is no image of what does not.
    """
    assert symmetries(flawed) == ()
    trajectory, before = run(flawed, events), run(whole, events)
    assert trajectory.certified
    assert trajectory.stop.reason is StopReason.EVENTS
    assert_all_touch(trajectory)
    assert all((alone in first) == (alone in second) for first, second in pasts_of_ties(trajectory))
    images_of = [images(whole, symmetry) for symmetry in symmetries(whole)]
    parted = [
        event
        for event in trajectory.events
        if any(set(map(image, event.contacts)) != set(event.contacts) for image in images_of)
    ]
    assert parted
    assert all(set(map(image, event.contacts)) == set(event.contacts) for event in before.events for image in images_of)
    assert_certified_by_intervals(trajectory)


def assert_certified_by_intervals(trajectory: Trajectory) -> None:
    """Intervals of 600 bits, as far as they get: not past a tie, which they never can tell."""
    intervals = IntervalEngine(bits=600).run(trajectory.scene, events=len(trajectory.events))
    for mine, theirs in zip(trajectory.events, intervals.events, strict=False):
        assert (mine.contacts, mine.impulses) == (theirs.contacts, theirs.impulses)
        assert theirs.time.low <= float(mine.time) <= theirs.time.high
    if len(intervals.events) < len(trajectory.events):
        assert intervals.stop.reason is StopReason.UNDECIDED
        assert trajectory.events[len(intervals.events)].ties


@pytest.mark.parametrize("key", FLAWS)
@pytest.mark.parametrize(
    ("spec", "circle"),
    [(OPEN_RACK, "b2"), (OPEN_RACK, "b4"), ("inscribed:n=4", "c1"), ("inscribed:n=3", "c2")],
)
def test_a_flaw_of_a_circle_is_noticed(spec: str, circle: str, key: str) -> None:
    whole = catalogue.build(spec)
    assert_flaw_noticed(nudged(whole, circle, **{key: FLAWS[key]}), whole, circle if key in ("m", "r") else None)


@pytest.mark.parametrize("key", ["y0", "y1"])
def test_a_flaw_of_a_wall_is_noticed(key: str) -> None:
    whole = catalogue.build(OPEN_RACK)
    assert_flaw_noticed(nudged(whole, "top", **{key: TINY}), whole, events=100)


def test_the_two_hits_of_a_flawed_pair_are_as_far_apart_as_they_should_be() -> None:
    """The cue hits two balls, one of them 10**-30 farther: the times differ by that."""
    scene = Scene([Circle(0, 0, vx=1), Circle(9, 1), Circle(9 + TINY, -1 - TINY)])
    assert symmetries(scene) == ()
    first, second = run(scene).events[:2]
    assert (first.contacts, second.contacts) == (
        (Contact("c1", "c2"),),
        (Contact("c1", "c3"),),
    ) or second.contacts == (Contact("c1", "c2"),)
    apart = second.time.ball(BITS) - first.time.ball(BITS)
    assert 0 < apart < arb(10) ** -29


def test_a_part_that_takes_no_part_ends_the_symmetry_of_the_scene_and_no_proof() -> None:
    """A ball beyond the walls breaks the scene's symmetry; the ties within are proved as before."""
    whole = catalogue.build(OPEN_RACK)
    scene = whole.with_changes(circles=[*whole.circles, Circle(50, 100, vy=7, r=3, id="stranger")])
    assert symmetries(scene) == ()
    trajectory, before = run(scene, 60), run(whole, 60)
    assert trajectory.certified
    assert [(e.contacts, e.ties) for e in trajectory.events] == [(e.contacts, e.ties) for e in before.events]
    assert TieProof.SYMMETRY in proofs(trajectory)


def test_a_part_that_comes_to_take_part_ends_only_what_depends_on_it() -> None:
    """The same ball within the walls, until it meets one of the rack's, and after."""
    whole = catalogue.build(OPEN_RACK)
    scene = whole.with_changes(circles=[*whole.circles, Circle(40, 30, r="1/2", id="stranger")])
    trajectory = run(scene, 80)
    assert trajectory.certified
    assert_all_touch(trajectory)
    met = next(event.index for event in trajectory.events if any("stranger" in contact for contact in event.contacts))
    before = [tie.proof for event in trajectory.events[:met] for tie in event.ties]
    assert TieProof.SYMMETRY in before
    assert all(("stranger" in first) == ("stranger" in second) for first, second in pasts_of_ties(trajectory))
    image = images(whole, symmetries(whole)[0])
    assert all(set(map(image, event.contacts)) == set(event.contacts) for event in trajectory.events[:met])
    assert any(set(map(image, event.contacts)) != set(event.contacts) for event in trajectory.events[met + 1 :])


def test_some_symmetries_may_go_and_others_stay() -> None:
    """A heavier ball leaves only the mirror through its own middle."""
    whole = catalogue.build("inscribed:n=6,spin=0")
    flawed = nudged(whole, "c2", m=TINY)
    (mirror,) = symmetries(flawed)
    assert mirror.mirror
    assert mirror.circles[1] == 1
    trajectory = run(flawed, 100)
    assert trajectory.certified
    assert_symmetric_instants(trajectory, mirror)
    assert_symmetric_state(trajectory, mirror)


@pytest.mark.parametrize("wall", [Wall(0, 60, 1, 60), Wall(0, "-1/10", 1, 0)])
def test_walls_may_break_the_symmetry_of_a_scene(wall: Wall) -> None:
    """A wall that no ball can reach ends no proof; a slanted one ends those of what has hit it."""
    scene = catalogue.build(OPEN_RACK)
    beyond = wall.y0 == wall.y1
    walls = [*scene.walls, wall] if beyond else [*scene.walls[:2], scene.walls[3], wall]
    assert len(symmetries(scene)) == 1
    changed = scene.with_changes(walls=walls)
    assert symmetries(changed) == ()
    trajectory, before = run(changed, 60), run(scene, 60)
    assert trajectory.certified
    assert_all_touch(trajectory)
    assert TieProof.SYMMETRY in proofs(trajectory)
    assert ([e.contacts for e in trajectory.events] == [e.contacts for e in before.events]) == beyond
    slanted = changed.walls[-1].id
    assert all((slanted in first) == (slanted in second) for first, second in pasts_of_ties(trajectory))


def test_pockets_of_a_symmetric_scene_that_capture_are_symmetric_too() -> None:
    scene = catalogue.build("rack:rows=3")
    assert len(symmetries(scene.with_changes(capture=True))) == 1
    uneven = scene.with_changes(pockets=scene.pockets[:-1])
    assert len(symmetries(uneven)) == 1  # they only report
    assert symmetries(uneven.with_changes(capture=True)) == ()


def test_what_is_captured_elsewhere_ends_no_proof() -> None:
    """One pocket is missing, so that balls leave the table on one side only."""
    scene = catalogue.build("rack:rows=3").with_changes(capture=True)
    entered = run(scene, 150).pocketings[0].pocket
    uneven = scene.with_changes(pockets=[pocket for pocket in scene.pockets if pocket.id != entered])
    trajectory = run(uneven, 150)
    assert trajectory.certified
    assert_all_touch(trajectory)
    assert symmetries(uneven) == ()
    first = float(trajectory.pocketings[0].time)
    assert TieProof.SYMMETRY in [t.proof for e in trajectory.events if float(e.time) > first for t in e.ties]


@pytest.mark.parametrize("policy", ["sequential:order=scene", "sequential:seed=4"])
def test_an_order_once_chosen_ends_the_proofs_that_depend_on_it(policy: str) -> None:
    """Up to there the instants are symmetric; here everything depends on it."""
    scene = catalogue.build("rack:rows=3").with_changes(tie_policy=policy)
    assert len(symmetries(scene)) == 1
    trajectory = run(scene, 40)
    first = next(event.index for event in trajectory.events if len(event.impulses) > 1)
    later = [tie.proof for event in trajectory.events[first + 1 :] for tie in event.ties]
    assert TieProof.SYMMETRY not in later
    assert trajectory.certified
    assert_all_touch(trajectory)
    image = images(scene, symmetries(scene)[0])
    assert any(set(map(image, event.contacts)) != set(event.contacts) for event in trajectory.events)


def test_under_a_chosen_order_a_ball_may_leave_the_mirror_line() -> None:
    scene = catalogue.build("rack:rows=2").with_changes(tie_policy="sequential:order=scene")
    trajectory = run(scene, 3)
    assert float(trajectory.final["cue"].vy) != 0 or float(trajectory.final["b1"].vy) != 0
