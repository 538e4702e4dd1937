"""The referee itself: closed forms, conservation, time reversal, ties, and the committed data."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import mpmath
import pytest
import referee
from mpmath import mpf
from referee import History, compare_to_referee, load
from referee_play import Table, play

from truebreak.scenarios import Circle, Contact, Event, Scene, Stop, StopReason, Trajectory, Wall

BITS = 1000
SHARP = mpf(2) ** -900
"""What rounding may leave of an identity at BITS after a few events."""


@pytest.fixture(autouse=True)
def _sharp_arithmetic():
    with mpmath.workprec(2 * BITS):
        yield


def close(found: Any, expected: Any, tolerance: mpf = SHARP) -> bool:
    return all(abs(a - b) < tolerance for a, b in zip(found, expected, strict=True))


# -- closed forms


def test_head_on_unequal_masses():
    scene = Scene([Circle(0, 0, vx=3, m=2), Circle(7, 0, vx=-2, m=5)])
    history = referee.referee(scene, 10)
    assert history.stop == "quiet"
    assert [event.contacts for event in history.events] == [(("c1", "c2"),)]
    assert close([history.events[0].time], [1])
    assert close(history.final["c1"], (3, 0, mpf(-29) / 7, 0))
    assert close(history.final["c2"], (5, 0, mpf(6) / 7, 0))


def test_oblique_hit_parts_at_right_angles():
    scene = Scene([Circle(0, 0, vx=1), Circle(4, 1)])
    history = referee.referee(scene, 10)
    root = mpmath.sqrt(3)
    assert close([history.events[0].time], [4 - root])
    assert close(history.final["c1"], (4 - root, 0, mpf(1) / 4, -root / 4))
    assert close(history.final["c2"], (4, 1, mpf(3) / 4, root / 4))


def test_fixed_circle_reflects():
    scene = Scene([Circle(4, 1, m="oo"), Circle(0, 0, vx=1)])
    history = referee.referee(scene, 10)
    assert [event.contacts for event in history.events] == [(("c1", "c2"),)]
    assert close(history.final["c1"], (4, 1, 0, 0))
    assert close(history.final["c2"][2:], (mpf(-1) / 2, -mpmath.sqrt(3) / 2))


def test_ball_between_walls():
    scene = Scene([Circle(2, 0, "1/2", vx="-1/3", vy=1)], [Wall(0, 0, 0, 1), Wall(3, 0, 3, 1)])
    history = referee.referee(scene, 7)
    assert [event.contacts for event in history.events] == [(("c1", f"w{1 + i % 2}"),) for i in range(7)]
    assert close([event.time for event in history.events], [mpf(9) / 2 + 6 * i for i in range(7)])


def test_slanted_wall_swaps_the_velocity():
    scene = Scene([Circle(0, 5, 1, vy=-1)], [Wall(0, 0, 1, 1)])
    history = referee.referee(scene, 7)
    assert history.stop == "quiet"
    assert close([history.events[0].time], [5 - mpmath.sqrt(2)])
    assert close(history.final["c1"][2:], (-1, 0))


@pytest.mark.parametrize(("mass", "collisions"), [(1, 3), (100, 31), (10_000, 314), (1_000_000, 3141)])
def test_galperin_counts_the_digits_of_pi(mass, collisions):
    scene = Scene([Circle(5, 0), Circle(9, 0, vx=-1, m=mass)], [Wall(0, 0, 0, 1)])
    history = referee.referee(scene, 2 * collisions)
    assert (history.stop, len(history.events)) == ("quiet", collisions)


# -- laws


def free_break() -> Scene:
    return referee.make("rack15").with_changes(walls=())


def totals(scene: Scene, state: dict[str, tuple[mpf, ...]]) -> tuple[mpf, mpf, mpf, mpf]:
    """Momentum in x and y, angular momentum, and twice the energy."""
    mass = {c.id: mpf(int(c.m.rational.p)) / int(c.m.rational.q) for c in scene.circles}
    rows = [(mass[name], *row) for name, row in state.items()]
    return (
        sum(m * vx for m, _, _, vx, _ in rows),
        sum(m * vy for m, _, _, _, vy in rows),
        sum(m * (x * vy - y * vx) for m, x, y, vx, vy in rows),
        sum(m * (vx * vx + vy * vy) for m, _, _, vx, vy in rows),
    )


def test_momentum_is_conserved_without_walls():
    scene = free_break()
    start = totals(scene, Table(scene, BITS).state())
    history = referee.referee(scene, 400, BITS)
    assert len(history.events) > 20
    assert close(totals(scene, history.final), start, mpf(2) ** -900)


@pytest.mark.parametrize("name", ["gas10-mixed", "heavy8", "slanted5"])
def test_energy_is_conserved(name):
    scene = referee.make(name)
    start = totals(scene, Table(scene, BITS).state())[-1]
    final = play(scene, 400, BITS).final
    assert abs(totals(scene, final)[-1] - start) < start * mpf(2) ** -900


@pytest.mark.parametrize("name", ["gas5-mixed", "rack6", "triangle4", "lorentz12"])
def test_time_reversal_leads_back_to_the_start(name):
    scene = referee.make(name)
    table = Table(scene, 2 * BITS)
    start = table.state()
    there = []
    for _ in range(150):
        contact = table.candidates()[0]
        table.advance(contact.dt)
        table.bounce(contact)
        there.append((table.number(table.time), table.pair(contact)))
    table.advance(table.candidates()[0].dt // 2)
    turned = table.time
    for disc in table.discs:
        disc.vx, disc.vy = -disc.vx, -disc.vy
    for time, pair in reversed(there):
        contact = table.candidates()[0]
        table.advance(contact.dt)
        assert table.pair(contact) == pair
        assert abs(table.number(table.time - 2 * turned) + time) < mpf(2) ** -BITS
        table.bounce(contact)
    table.advance(2 * turned - table.time)
    for circle, (x, y, vx, vy) in table.state().items():
        assert close((x, y, -vx, -vy), start[circle], mpf(2) ** -BITS)


@pytest.mark.parametrize("name", ["gas5-equal", "lorentz-triangular", "slanted5", "heavy8"])
def test_replay_by_impulses_in_mpmath_finds_every_contact_touching(name):
    """Another arithmetic and another form of the law, given the order and the times."""
    scene, _ = load(name)
    history = referee.referee(scene, 100)
    body = {c.id: [mpf(1), *Table(scene, 2 * BITS).state()[c.id]] for c in scene.circles}
    radius = {c.id: mpf(int(c.r.rational.p)) / int(c.r.rational.q) for c in scene.circles}
    inverse = {c.id: mpf(int(q.p)) / int(q.q) for c in scene.circles for q in [c.inverse_mass.rational]}
    lines = {line.id: line for line in Table(scene, 2 * BITS).lines}
    clock, ruler = mpf(0), Table(scene, 2 * BITS).number
    for event in history.events:
        ((first, second),) = event.contacts
        for row in body.values():
            row[1] += row[3] * (event.time - clock)
            row[2] += row[4] * (event.time - clock)
        clock = event.time
        p = body[first]
        if second in lines:
            line = lines[second]
            nx, ny = ruler(line.nx), ruler(line.ny)
            height = (p[1] - ruler(line.x)) * nx + (p[2] - ruler(line.y)) * ny
            assert abs(abs(height) - radius[first]) < mpf(2) ** -referee.AGREED_BITS
            impulse = 2 * (p[3] * nx + p[4] * ny)
            p[3], p[4] = p[3] - impulse * nx, p[4] - impulse * ny
            continue
        q = body[second]
        reach, dx, dy = radius[first] + radius[second], q[1] - p[1], q[2] - p[2]
        assert abs(dx * dx + dy * dy - reach * reach) < mpf(2) ** -referee.AGREED_BITS
        approach = (q[3] - p[3]) * dx + (q[4] - p[4]) * dy
        assert approach < 0
        impulse = 2 * approach / ((inverse[first] + inverse[second]) * reach * reach)
        p[3], p[4] = p[3] + impulse * inverse[first] * dx, p[4] + impulse * inverse[first] * dy
        q[3], q[4] = q[3] - impulse * inverse[second] * dx, q[4] - impulse * inverse[second] * dy


# -- what it refuses to decide


def test_one_ball_onto_two_that_touch_is_a_tie():
    scene = Scene([Circle("-5", 0, vx=1), Circle(0, 1), Circle(0, -1)])
    history = referee.referee(scene, 10)
    assert (history.stop, history.events) == ("tie", ())


def test_cradle_stops_after_the_first_hit():
    scene = Scene([Circle(-5, 0, vx=1), Circle(0, 0), Circle(2, 0)])
    history = referee.referee(scene, 10)
    assert (history.stop, len(history.events)) == ("tie", 1)


def test_corner_is_a_tie():
    scene = Scene([Circle(5, 5, vx=-1, vy=-1)], [Wall(0, 0, 1, 0), Wall(0, 0, 0, 1)])
    for merge_ties in (False, True):
        assert referee.referee(scene, 5, merge_ties=merge_ties).stop == "tie"


def test_independent_ties_are_merged_on_demand():
    scene = Scene([Circle(0, 0, vx=1), Circle(9, 0, vx=-1)], [Wall(-2, 0, -2, 1), Wall(11, 0, 11, 1)])
    assert referee.referee(scene, 4, merge_ties=False).stop == "tie"
    history = referee.referee(scene, 4, merge_ties=True)
    assert [e.contacts for e in history.events] == 2 * [(("c1", "c2"),), (("c1", "w1"), ("c2", "w2"))]


def test_tangent_flight_is_a_graze():
    scene = Scene([Circle(-5, 2, vx=1), Circle(0, 0)])
    history = referee.referee(scene, 5)
    assert (history.stop, history.events) == ("graze", ())


def test_a_near_tie_is_told_apart_and_its_gap_reported():
    scene = Scene([Circle(3, 3, vx=-1, vy="-1 - 10**-30")], [Wall(0, 0, 1, 0), Wall(0, 0, 0, 1)])
    history = referee.referee(scene, 5)
    assert [e.contacts for e in history.events] == [(("c1", "w1"),), (("c1", "w2"),)]
    assert close([history.least_gap[0] * mpf(10) ** 30], [1], mpf(10) ** -15)


def test_too_low_a_precision_cuts_the_history():
    scene, committed = load("gas5-mixed")
    history = referee.referee(scene, 500, bits=200)
    assert history.stop == "precision"
    assert 10 < len(history.events) < 400
    assert _orders(history) == _orders(committed)[: len(history.events)]


def test_higher_precision_tells_the_same():
    scene, committed = load("lorentz12")
    assert _orders(referee.referee(scene, 300, bits=4000)) == _orders(committed)


def test_reversals_and_pockets_are_refused():
    with pytest.raises(ValueError, match="no reversal"):
        referee.referee(Scene([Circle(0, 0)], reverse_after=3), 5)


def _orders(history: History) -> list[tuple[tuple[str, str], ...]]:
    return [event.contacts for event in history.events]


# -- the judge


@dataclass(frozen=True)
class FinalMotion:
    rows: list[tuple[mpf, ...]]

    def state(self, time: Any) -> list[tuple[mpf, ...]]:
        return self.rows

    def sample(self, times: Any) -> Any:
        raise NotImplementedError


def as_trajectory(scene: Scene, history: History) -> Trajectory:
    """What an engine that agrees with the referee would give back."""
    events = []
    for index, instant in enumerate(history.events):
        contacts = tuple(Contact(*pair) for pair in instant.contacts)
        events.append(Event(index, instant.time, contacts, contacts))
    motion: Any = FinalMotion(list(history.final.values()))
    stop = Stop(StopReason.EVENTS, "")
    return Trajectory(scene, "parrot", {}, tuple(events), stop, events[-1].time, motion)


@pytest.fixture
def parrot() -> tuple[Trajectory, History]:
    scene, history = load("gas5-equal")
    return as_trajectory(scene, history), history


def changed(trajectory: Trajectory, index: int, **changes: Any) -> Trajectory:
    events = list(trajectory.events)
    events[index] = replace(events[index], **changes)
    return replace(trajectory, events=tuple(events))


def test_judge_accepts_the_same_history(parrot):
    compare_to_referee(*parrot)


def test_judge_names_the_first_wrong_contact(parrot):
    trajectory, history = parrot
    assert history.events[17].contacts != (("c1", "c2"),)
    wrong = changed(trajectory, 17, contacts=(Contact("c1", "c2"),), time=1.5)
    with pytest.raises(AssertionError, match=r"'gas5-equal': event 17 .* has c1-c2 at 1\.5, the referee"):
        compare_to_referee(wrong, history)


def test_judge_rejects_a_time_that_is_off(parrot):
    trajectory, history = parrot
    time = history.events[20].time
    with pytest.raises(AssertionError, match=r"event 20 .* off by"):
        compare_to_referee(changed(trajectory, 20, time=time * (1 + mpf("2e-12"))), history)
    compare_to_referee(changed(trajectory, 20, time=time * (1 + mpf("5e-13"))), history)


def test_judge_rejects_a_short_history(parrot):
    trajectory, history = parrot
    with pytest.raises(AssertionError, match="stops before event 199"):
        compare_to_referee(replace(trajectory, events=trajectory.events[:-1]), history)


def test_judge_rejects_an_event_after_the_last(parrot):
    trajectory, history = parrot
    quiet = replace(history, events=history.events[:-1], stop="quiet", final={})
    with pytest.raises(AssertionError, match="after the referee's last event"):
        compare_to_referee(trajectory, quiet)
    compare_to_referee(trajectory, replace(quiet, stop="events"))


def test_judge_rejects_another_final_state(parrot):
    trajectory, history = parrot
    x, y, vx, vy = history.final["c3"]
    wrong = replace(history, final={**history.final, "c3": (x, y, vx + mpf("1e-10"), vy)})
    with pytest.raises(AssertionError, match=r"c3\.vx is"):
        compare_to_referee(trajectory, wrong)
