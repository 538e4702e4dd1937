"""Ties by the form of causal pasts: what isometries of logged histories prove, and what they must not."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeAlias

import pytest
from touch import assert_all_touch, proofs

from truebreak.exact import ExactEngine
from truebreak.exact.log_symmetry import symmetries
from truebreak.floating import IntervalEngine
from truebreak.scenarios import Circle, Pocket, Quantity, Scene, StopReason, Trajectory, Wall, catalogue
from truebreak.scenarios.trajectory import TieProof

pytestmark = pytest.mark.usefixtures("long_balls")

FIXED = "oo"
TINY = Quantity.of("10**-30")
LENGTH = 10
"""Discs in a row: nested roots of the last hit are nine deep, more than can be multiplied out."""

Point: TypeAlias = Callable[[Quantity, Quantity], tuple[Quantity, Quantity]]


def row(n: int = LENGTH, flaw: Quantity | int = 0) -> list[Circle]:
    """A disc that flies at a row of others, each of which it, or the one before, hits off centre."""
    return [Circle(0, flaw, 1, 1), *(Circle(4 * k, f"{k}/7") for k in range(1, n))]


def mapped(circles: Iterable[Circle], turn: Point, dx: int, dy: int) -> list[Circle]:
    """The circles turned (or mirrored) about the origin, then shifted."""
    found = []
    for c in circles:
        x, y = turn(c.x, c.y)
        found.append(Circle(x + dx, y + dy, c.r, *turn(c.vx, c.vy), c.m))
    return found


def same(x: Quantity, y: Quantity) -> tuple[Quantity, Quantity]:
    return x, y


COPIES: dict[str, tuple[Point, int, int]] = {
    "shifted": (same, 1, 500),
    "mirrored": (lambda x, y: (x, -y), 3, -500),
    "mirrored in a diagonal": (lambda x, y: (y, x), 200, -500),
    "turned by 90 degrees": (lambda x, y: (-y, x), -500, 30),
    "turned by a 3-4-5 angle": (lambda x, y: ((3 * x - 4 * y) / 5, (4 * x + 3 * y) / 5), 1000, 500),
    "mirrored by a 3-4-5 angle": (lambda x, y: ((3 * x + 4 * y) / 5, (4 * x - 3 * y) / 5), 1000, 500),
    "turned by 45 degrees": (lambda x, y: ((x - y) / Quantity.of("sqrt(2)"), (x + y) / Quantity.of("sqrt(2)")), 0, 800),
}

every_copy = pytest.mark.parametrize("name", COPIES)


def twins(name: str, beside: Iterable[Circle] = (), walls: Iterable[Wall] = ()) -> Scene:
    """Two rows, one of them mapped."""
    return Scene([*row(), *mapped(row(), *COPIES[name]), *beside], walls)


def run(scene: Scene, **limits: Any) -> Trajectory:
    return ExactEngine().run(scene, **limits)


def ties_by(trajectory: Trajectory, proof: TieProof) -> list[tuple[str, ...]]:
    """The circles of each tie that rests on this proof."""
    return [
        tuple(name for contact in tie.contacts for name in contact)
        for event in trajectory.events
        for tie in event.ties
        if tie.proof is proof
    ]


def assert_two_by_two(trajectory: Trajectory, n: int = LENGTH) -> None:
    """Every hit in the one row falls on the instant of its image."""
    assert [event.contacts for event in trajectory.events] == [
        ((f"c{k}", f"c{k + 1}"), (f"c{n + k}", f"c{n + k + 1}")) for k in range(1, n)
    ]
    assert trajectory.certified
    assert_all_touch(trajectory)


# -- copies


@every_copy
def test_a_row_and_its_copy_are_one_history(name: str) -> None:
    trajectory = run(twins(name), events=LENGTH - 1)
    assert_two_by_two(trajectory)
    assert len(ties_by(trajectory, TieProof.SYMMETRY)) >= LENGTH - 3  # the first few are plain numbers
    assert TieProof.TOWER not in proofs(trajectory)
    assert run(twins(name)).certified


@pytest.mark.parametrize(("policy", "alike"), [("order=scene", True), ("seed=3", True), ("seed=7", False)])
def test_two_racks_in_which_orders_are_chosen(policy: str, alike: bool) -> None:
    """What a policy chooses is logged: equal choices have equal consequences, and opposite ones mirrored ones."""
    table = catalogue.build("rack:rows=3,gap=1/50,pockets=no")
    rack, n = list(table.circles), len(table.circles)
    walls = [*table.walls, *(Wall(0, w.y0 + 5000, 1, w.y1 + 5000) for w in table.walls if w.id in ("bottom", "top"))]
    pair = Scene([*rack, *mapped(rack, same, 0, 5000)], walls, tie_policy=f"sequential:{policy}")
    trajectory = run(pair, events=40)
    assert trajectory.certified
    assert_all_touch(trajectory)
    place = {name: k for k, name in enumerate(pair.ids)}
    choice = next(event for event in trajectory.events if len(event.contacts) == 4)
    chosen = [{place[name] for name in contact} for contact in choice.impulses]
    mine, theirs = ([{i % n for i in pair} for pair in chosen if (min(pair) < n) == low] for low in (True, False))
    assert (mine == theirs) == alike
    ties = [tie for event in trajectory.events[choice.index + 1 :] for tie in event.ties]
    image = range(n) if alike else symmetries(table)[0].circles
    proved = 0
    for tie in ties:
        first, second = ({place[name] for name in contact if place[name] < 2 * n} for contact in tie.contacts)
        if min(first) >= n:
            first, second = second, first
        assert {image[i] + n for i in first} == second
        proved += tie.proof is TieProof.SYMMETRY
    assert proved > 20


@every_copy
def test_a_stranger_that_hits_the_fixed_post_of_one_copy_changes_nothing(name: str) -> None:
    """A fixed circle has data and no past: both rows come to their posts, one of which something else has met."""
    last = run(Scene(row()), events=LENGTH - 1).final[f"c{LENGTH}"]
    x, y, vx, vy = (Quantity.of(round(float(q) * 1000)) / 1000 for q in (last.x, last.y, last.vx, last.vy))
    post = Circle(x + 200 * vx, y + 200 * vy, 1, m=FIXED)
    stranger = Circle(post.x + 30 * vx, post.y + 30 * vy, "1/2", -vx, -vy)
    turn, dx, dy = COPIES[name]
    scene = Scene([*row(), post, *mapped([*row(), post, stranger], turn, dx, dy)])
    trajectory = run(scene, events=LENGTH + 1)
    assert trajectory.certified
    assert_all_touch(trajectory)
    (strange,) = [event for event in trajectory.events if any("c23" in contact for contact in event.contacts)]
    assert strange.contacts == (("c22", "c23"),)
    assert strange.index < LENGTH
    assert trajectory.events[-1].contacts == (("c10", "c11"), ("c21", "c22"))
    assert [tie.proof for tie in trajectory.events[-1].ties] == [TieProof.SYMMETRY]


def test_a_flawed_neighbour_is_no_part_of_the_past() -> None:
    """A ball that is off the mirror line by 10**-30 ends the scene's symmetry, and no proof until it is met."""
    neighbour = Circle(300, -250 + TINY, vx=-1)
    trajectory = run(twins("mirrored", [neighbour]), events=LENGTH - 1)
    assert_two_by_two(trajectory)
    assert len(ties_by(trajectory, TieProof.SYMMETRY)) >= LENGTH - 3


def test_a_wall_that_one_copy_hits_ends_the_proofs_from_there_on() -> None:
    """Up to the wall the pasts are alike; behind it they are not, and nothing says that they were."""
    scene = twins("mirrored", walls=[Wall(0, -504, 1, -504, id="floor")])
    trajectory = run(scene)
    hit = next(event.index for event in trajectory.events if any("floor" in contact for contact in event.contacts))
    assert trajectory.certified
    assert_all_touch(trajectory)
    assert 0 < hit < len(trajectory.events)
    for event in trajectory.events:
        assert not any({"floor"} & set(contact) for tie in event.ties for contact in tie.contacts)


# -- parallel flight


def test_two_discs_that_are_hit_alike_fly_abreast() -> None:
    """Their relative velocity is a difference of equal deep roots: only the shift between them says that it is zero."""
    scene = Scene([*row(9), *mapped(row(9), same, 0, 40)])
    trajectory = run(scene)
    assert trajectory.stop.reason is StopReason.QUIET
    assert trajectory.certified
    assert trajectory.plan["symmetry"] > len(ties_by(trajectory, TieProof.SYMMETRY))
    last, other = trajectory.final["c9"], trajectory.final["c18"]
    for key in ("vx", "vy"):
        difference = getattr(last, key).ball(2000) - getattr(other, key).ball(2000)
        assert difference.abs_upper() < 1e-300


def test_a_disc_that_rolls_along_a_tilted_floor_never_leaves_it() -> None:
    """Hit by others along the floor, it is mapped to itself by the mirror through its own centre."""

    def tilted(x: Any, y: Any) -> tuple[Quantity, Quantity]:
        x, y = Quantity.of(x), Quantity.of(y)
        return (3 * x - 4 * y) / 5, (4 * x + 3 * y) / 5

    def rolling(x: Any, vx: Any, r: Any = 1, m: Any = 1) -> Circle:
        return Circle(*tilted(x, r), r, *tilted(vx, 0), m)

    floor = Wall(*tilted(0, 0), *tilted(1, 0), id="floor")
    ends = [Wall(*tilted(x, 0), *tilted(x, 1)) for x in (-4, 40)]
    discs = [rolling(0, 2), rolling("7 + sqrt(2)", -1), rolling(15, "1/3", 1, 3), rolling(25, "-1/2", 1, "sqrt(5)")]
    trajectory = run(Scene(discs, [floor, *ends]), events=60)
    assert trajectory.stop.reason is StopReason.EVENTS
    assert trajectory.certified
    assert not any("floor" in contact for event in trajectory.events for contact in event.contacts)
    for circle in trajectory.final.circles:
        across = circle.vy.ball(2000) * 3 - circle.vx.ball(2000) * 4
        assert across.abs_upper() < 1e-300


# -- the way back

BOX = [Wall(-3, -8, 20, -8), Wall(-3, 12, 20, 12), Wall(-3, 0, -3, 1), Wall(20, 0, 20, 1)]
MESS = [Circle(0, 0, 1, 2, "1/3"), Circle(9, 1, 1, -1), Circle(4, 6, 1, 0, -1), Circle(12, -4, 1, "-1/2", "1/2")]


@pytest.mark.parametrize("after", [3, 12, 40])
def test_a_rational_tie_is_met_again_after_a_reversal(after: int) -> None:
    """By then the clock is deep, and what was plain on the way out is not any more."""
    tie = [Circle(100, 100, 1, 1), Circle(105, 100), Circle(100, 300, 1, 1), Circle(105, 300)]
    trajectory = run(Scene([*MESS, *tie], BOX, reverse_after=after))
    assert trajectory.certified
    assert "came back to the start exactly" in trajectory.notes[0]
    first, last = (event for event in trajectory.events if len(event.contacts) > 1)
    assert first.index + last.index == len(trajectory.events) - 1
    assert first.contacts == last.contacts == (("c5", "c6"), ("c7", "c8"))
    assert [tie.proof for tie in first.ties] == [TieProof.RATIONAL]
    assert [tie.proof for tie in last.ties] in ([TieProof.WAY_BACK], [TieProof.SYMMETRY], [TieProof.RATIONAL])
    assert_all_touch(trajectory)


def test_a_tie_of_unlike_things_is_met_again_after_a_reversal() -> None:
    """No isometry maps a disc at a wall to a disc at a disc: on the way back only the way out tells."""
    tie = [Circle(100, 100, 1, 1), Circle(105, 100), Circle(100, 300, 2, 2, m=5)]
    walls = [*BOX, Wall(108, 300, 108, 301, id="far")]
    trajectory = run(Scene([*MESS, *tie], walls, reverse_after=15))
    assert trajectory.certified
    several = [event for event in trajectory.events if ("c7", "far") in event.contacts and len(event.contacts) > 1]
    assert [tie.proof for event in several for tie in event.ties] == [TieProof.RATIONAL, TieProof.WAY_BACK]
    assert_all_touch(trajectory)


# -- what is no symmetry


@pytest.mark.parametrize("power", [300, 3000, 9000])
def test_twins_with_the_least_flaw_are_told_apart(power: int) -> None:
    """The one row lies off by 10**-power, and each of its hits comes by about that before or after the other's."""
    flaw = Quantity.of(f"10**-{power}")
    trajectory = run(Scene([*row(), *mapped(row(flaw=flaw), same, 1, 500)]), events=2 * LENGTH - 2)
    assert trajectory.certified
    assert not any(event.ties for event in trajectory.events)
    assert [len(event.contacts) for event in trajectory.events] == [1] * (2 * LENGTH - 2)
    hits = Counter(contact for event in trajectory.events for contact in event.contacts)
    assert set(hits.values()) == {1}
    early, late = trajectory.events[:2]
    bits = 4 * power + 200
    apart = late.time.ball(bits) - early.time.ball(bits)
    assert apart > 0
    assert apart.log() / 2.302585 < -power + 3


FLAWS: dict[str, dict[str, Quantity | int]] = {
    "mass": {"m": TINY},
    "radius": {"r": -TINY},
    "place": {"y": TINY},
    "place along the way": {"x": TINY},
    "velocity": {"vy": TINY},
}


def flawed(circle: Circle, changes: dict[str, Quantity | int]) -> Circle:
    """A circle with some numbers changed by these amounts."""
    values = {key: getattr(circle, key) for key in ("x", "y", "r", "vx", "vy", "m")}
    return Circle(**{key: value + changes.get(key, 0) for key, value in values.items()})


def pasts_of_ties(trajectory: Trajectory) -> Iterator[tuple[set[str], set[str]]]:
    """For each tie by symmetry, the circles on which either contact depends."""
    cone = {name: {name} for name in trajectory.scene.ids}
    for event in trajectory.events:
        for tie in event.ties:
            if tie.proof is TieProof.SYMMETRY:
                first, second = (cone[contact.first] | cone[contact.second] for contact in tie.contacts)
                yield first, second
        for contact in event.contacts:
            cone[contact.first] = cone[contact.second] = cone[contact.first] | cone[contact.second]


@every_copy
@pytest.mark.parametrize("kind", FLAWS)
def test_what_depends_on_a_flaw_is_no_image_of_what_does_not(kind: str, name: str) -> None:
    """The fifth disc of the copy is flawed: the hits before it are ties, those from it on are told apart."""
    copy = mapped(row(), *COPIES[name])
    copy[4] = flawed(copy[4], FLAWS[kind])
    trajectory = run(Scene([*row(), *copy]), events=2 * LENGTH - 6)
    assert trajectory.certified
    assert_all_touch(trajectory)
    assert TieProof.SYMMETRY in proofs(trajectory)
    assert all("c15" not in first | second for first, second in pasts_of_ties(trajectory))
    same_instant = [event for event in trajectory.events if len(event.contacts) > 1]
    met = next(event.index for event in trajectory.events if ("c14", "c15") in event.contacts)
    assert all(event.index <= met for event in same_instant)
    intervals = IntervalEngine(bits=700).run(trajectory.scene, events=len(trajectory.events))
    for mine, theirs in zip(trajectory.events, intervals.events, strict=False):
        assert mine.contacts == theirs.contacts


@every_copy
def test_one_more_collision_in_one_copy_is_noticed(name: str) -> None:
    """A stranger hits the sixth disc of the copy before the row does, so lightly that doubles see no difference."""
    turn, dx, dy = COPIES[name]
    target = row()[5]
    stranger = Circle(target.x, target.y - 4, 1, 0, "10**-30 + 1/2")
    aside = Circle(target.x + 4 * 4, target.y + 70, 1)
    trajectory = run(Scene([*row(), *mapped([*row(), stranger, aside], turn, dx, dy)]), events=2 * LENGTH)
    assert trajectory.certified
    assert_all_touch(trajectory)
    assert TieProof.SYMMETRY in proofs(trajectory)
    assert all("c21" not in first | second for first, second in pasts_of_ties(trajectory))
    extra = next(event for event in trajectory.events if ("c16", "c21") in event.contacts)
    tied = [event.index for event in trajectory.events if len(event.contacts) > 1]
    assert extra.index < max(tied)
    assert not any(("c5", "c6") in event.contacts for event in trajectory.events if len(event.contacts) > 1)


# -- walls along one line, pockets at one place


def walled(*names: str) -> Scene:
    """Two circles in a box, whose left wall is given in as many parts as there are names."""
    lines = {"low": (-3, -4, -3, 0), "high": (-3, 0, -3, 4), "turned": (-3, 9, -3, 5)}
    walls = [Wall(*lines[name], id=name) for name in names]
    walls += [Wall(8, -4, 8, 4, id="e"), Wall(-3, -4, 8, -4, id="s"), Wall(-3, 4, 8, 4, id="n")]
    circles = [Circle(0, 0, 1, "3/7", "5/11", id="a"), Circle(4, 1, 1, "-2/7", "1/3", id="b")]
    return Scene(circles, walls)


def test_a_wall_in_parts_is_one_wall() -> None:
    """Whoever comes to one part comes to all at that instant, which is proved by form: no bits, no roots."""
    one = ExactEngine().run(walled("low"), events=60)
    for names in (("low", "high"), ("low", "turned", "high")):
        run = ExactEngine().run(walled(*names), events=60)
        assert [e.time.digits(40) for e in run.events] == [e.time.digits(40) for e in one.events]
        for mine, other in zip(run.events, one.events, strict=True):
            parts = {c for c in mine.contacts if c.second in names}
            assert {c.second for c in parts} in (set(), set(names))
            assert set(mine.contacts) - parts == {c for c in other.contacts if c.second != "low"}
        assert run.plan["bits"] == one.plan["bits"]
        assert run.plan.get("tower", 0) == 0
        assert all(tie.proof is not TieProof.TOWER for e in run.events for tie in e.ties)


def test_pockets_at_one_place_are_entered_at_one_instant() -> None:
    circles = [Circle(0, 0, 1, 1, "1/7"), Circle(5, "1/3"), Circle(9, "-1/2")]
    first = ExactEngine().run(Scene(circles), events=3)
    last = first.final[first.events[-1].contacts[0].first]
    place = Quantity.of(float(last.x) + 40 * float(last.vx)), Quantity.of(float(last.y) + 40 * float(last.vy))
    run = ExactEngine().run(Scene(circles, pockets=[Pocket(*place, 2), Pocket(*place, 2)]))
    assert len(run.pocketings) == 2
    assert run.pocketings[0].time.digits(40) == run.pocketings[1].time.digits(40)


def test_parallel_walls_are_not_one() -> None:
    """A circle between them meets one, then the other; a part that is 10**-40 further back is never met."""
    near = Wall("-3 - 10**-40", 0, "-3 - 10**-40", 1, id="near")
    scene = walled("low")
    run = ExactEngine().run(scene.with_changes(walls=[*scene.walls, near]), events=30)
    assert {c.second for e in run.events for c in e.contacts} & {"low", "near"} == {"low"}
