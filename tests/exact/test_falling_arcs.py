"""Arcs under gravity: against a referee in true coordinates, planted faults, and what ends by name."""

from __future__ import annotations

import random
from collections import Counter
from typing import Any

import pytest
from arc_scenes import scene_of
from bow_referee import BowReferee, NotForThis, TieMet
from mpmath import mpf, workdps

from truebreak.exact import ExactEngine
from truebreak.exact.replay import landings, round_falls
from truebreak.scenarios import Arc, Circle, Quantity, Scene, SceneError, Segment, Trajectory, Wall
from truebreak.scenarios.trajectory import StopReason

FLOOR = Wall(0, -4, 1, -4, id="floor")
SIDES = [Wall(-6, 0, -6, 1, id="left"), Wall(6, 0, 6, 1, id="right")]
PULLS = [(0, -10), (0, "-981/100"), ("1/3", -4), ("sqrt(2)", -3)]


def drawn(seed: int) -> Scene:
    """One to three discs or points, arcs, and now and then fixed discs, segments and walls."""
    rng = random.Random(seed)
    if seed % 4 == 3:  # discs among arcs on a grid, in a box
        scene = scene_of(seed)
        if scene is not None:
            return scene.with_changes(gravity=rng.choice(PULLS))

    def some(low: int, high: int, parts: int = 100) -> str:
        return f"{rng.randint(low * parts, high * parts)}/{parts}"

    def radius() -> str:
        return rng.choice(["1/2", "1/4", "3/10", "sqrt(2)/4"])

    while True:
        arcs: list[Arc] = []
        for k in range(rng.choice([1, 1, 2, 3])):
            x, y, r = some(-3, 3), some(-3, 4), Quantity.of(rng.choice([some(1, 3), "2", "1", "3/2"]))
            ways = [(rng.randint(-9, 9), rng.randint(-9, 9)) for _ in range(2)]
            if arcs and rng.random() < 0.4:  # about the same middle; now and then as wide, too
                x, y = arcs[-1].x.text(), arcs[-1].y.text()
                r = arcs[-1].r if rng.random() < 0.5 else r
            cx, cy = Quantity.of(x), Quantity.of(y)
            begin, end = ((cx + ux, cy + uy) for ux, uy in ways)
            if arcs and not arcs[-1].full and arcs[-1].r == r and rng.random() < 0.5:  # where the one before ends
                begin = arcs[-1].ends[1]
                cx, cy = arcs[-1].x, arcs[-1].y
            try:
                full = rng.random() < 0.15
                arcs.append(Arc(cx, cy, r, id=f"a{k}", full=True) if full else Arc(cx, cy, r, *begin, *end, id=f"a{k}"))
            except SceneError:
                continue
        if not arcs:
            continue
        circles: list[Circle] = []
        for k in range(rng.randint(1, 3)):
            x, y = some(-4, 4), some(1, 8)
            if rng.random() < 0.5:  # within, or beside, an arc's circle
                bow = rng.choice(arcs)
                x, y = (bow.x + Quantity.of(x) / 4).text(), (bow.y + Quantity.of(y) / 8 - "1/2").text()
            vy = some(4, 12) if rng.random() < 0.3 else some(-4, 4)  # thrown up, to come back
            r, m = rng.choice([radius(), radius(), radius(), "0"]), rng.choice([1, 2, "1/3"])
            circles.append(Circle(x, y, r, some(-4, 4), vy, m, id=f"b{k}", point=r == "0"))
        circles += [Circle(some(-4, 4), some(-3, 5), radius(), m="oo", id=f"p{k}") for k in range(rng.randint(0, 1))]
        segments = [
            Segment(some(-4, 4), some(-3, 4), some(-4, 4), some(-3, 4), id=f"s{k}") for k in range(rng.randint(0, 1))
        ]
        walls = [*SIDES, FLOOR] if rng.random() < 0.8 else []
        e = rng.choice([1, 1, "9/10", "1/2"])
        try:
            return Scene(circles, walls, segments=segments, arcs=arcs, gravity=rng.choice(PULLS), restitution=e)
        except SceneError:
            continue


def pairs_of(run: Trajectory, k: int) -> list[list[str]]:
    """Who meets at an event."""
    return sorted(sorted((c.first, c.second)) for c in run.events[k].contacts)


def differs(scene: Scene, events: int) -> str | None:
    """What is otherwise than the referee has it; empty where all is as it has it, None where it has nothing."""
    run = ExactEngine(max_bits=2000, work=1_000_000).run(scene, events=events)
    count, quiet = len(run.events), run.stop.reason is StopReason.QUIET
    if run.events and float(run.events[0].time) == 0.0:
        return None  # the referee looks for what comes to a gap of zero, and not for what begins there
    try:
        course = BowReferee(scene).run(mpf(10) ** 9, count + quiet)
    except (TieMet, NotForThis):
        return None
    with workdps(60):
        if len(course.hits) != count:
            return "number of events"
        for k, (hit, event) in enumerate(zip(course.hits, run.events, strict=True)):
            if pairs_of(run, k) != [sorted(hit.pair)]:
                return f"who meets at event {k}"
            if abs(mpf(event.time.digits(40)) - hit.time) > mpf(10) ** -30 * (1 + hit.time):
                return f"time of event {k}"
        if run.events and not quiet:
            at = run.at(run.events[-1].time)
            for body, circle in zip(course.bodies, [c for c in scene.circles if not c.fixed], strict=True):
                mine = at[str(circle.id)]
                theirs = (body.x, body.y, body.vx, body.vy)
                for own, other in zip((mine.x, mine.y, mine.vx, mine.vy), theirs, strict=True):
                    if abs(mpf(own.digits(40)) - other) > mpf(10) ** -25 * (1 + abs(other)):
                        return f"state of {circle.id}"
    return ""


@pytest.mark.parametrize("seed", range(12))
def test_the_history_is_that_of_the_referee(seed: int) -> None:
    assert differs(drawn(seed), 10) == ""


@pytest.mark.slow
@pytest.mark.parametrize("block", range(20))
def test_many_histories_are_those_of_the_referee(block: int) -> None:
    found = Counter(differs(drawn(1000 + 50 * block + k), 15) for k in range(50))
    assert set(found) <= {"", None}
    assert found[""] > 40


# -- Planted faults: each is found.


def one_side(link: Any, fall: Any, stood: bool) -> Any:
    """The hollow side is met where the outside of as wide a circle would be."""
    return fall.polynomial(stood)


def mirrored(state: Any, link: Any, dx: Any, dy: Any) -> Any:
    """The rest of the circle is the arc."""
    found = WITHIN(state, link, dx, dy)
    return found if state.scene.arc_sides[link.arc].full else -found


def exchanged(state: Any, link: Any) -> Any:
    """Its one half is where the other is."""
    nx, ny, edge = CHORD(state, link)
    return -nx, -ny, edge


def first_alone(*of: Any) -> Any:
    """The first zero alone is looked at."""
    for found in ZEROS(*of):
        yield found
        return


def as_if_apart(self: Any, link: Any) -> bool:
    """The zero at 0 is not divided out."""
    return False


def narrow(self: Any, link: Any, other: Any) -> bool:
    """It is divided out of the side that was touched alone."""
    return link == other


def upside_down(self: Any, link: Any) -> Any:
    """Gravity pulls the other way."""
    found = FALL(self, link)
    return found._replace(hx=-found.hx, hy=-found.hy)


WITHIN, CHORD, ZEROS = landings.within_arc, landings.arc_chord, landings.falling_zeros
FALL = round_falls.RoundFalls.peg_fall_at_clock


@pytest.mark.parametrize(
    ("where", "name", "fault"),
    [
        (landings, "gap_of", one_side),
        (landings, "within_arc", mirrored),
        (landings, "arc_chord", exchanged),
        (landings, "falling_zeros", first_alone),
        (round_falls.RoundFalls, "stood", as_if_apart),
        (round_falls.RoundFalls, "_is_as_far", narrow),
        (round_falls.RoundFalls, "peg_fall_at_clock", upside_down),
    ],
)
def test_the_referee_finds_planted_faults(monkeypatch: pytest.MonkeyPatch, where: Any, name: str, fault: Any) -> None:
    sound = {seed: len(ExactEngine(max_bits=2000).run(drawn(seed), events=6).events) for seed in (*range(12), 58, 165)}
    monkeypatch.setattr(where, name, fault)

    def is_found(seed: int) -> bool:
        try:
            scene = drawn(seed)
            if len(ExactEngine(max_bits=600, work=100_000).run(scene, events=6).events) < sound[seed]:
                return True  # undecided, where all is decided
            return differs(scene, 6) not in ("", None)
        except AssertionError:
            return True

    assert any(is_found(seed) for seed in sound)
