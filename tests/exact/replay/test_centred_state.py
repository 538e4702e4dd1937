"""Exact midpoints and one set of their deviations: every number lies in its ball, and few bits are lost."""

import random
from math import ldexp, log

import pytest
from flint import arb

from truebreak.compare.tangent.growth import error_growth
from truebreak.exact import ExactEngine
from truebreak.exact.certified import certified_decider as precision
from truebreak.exact.laws.tangent_formulas import pair_tangent_blocks
from truebreak.exact.numbers import ball
from truebreak.exact.replay import centred_state
from truebreak.exact.replay.ball_state import BallState
from truebreak.exact.replay.centred_state import CentredState
from truebreak.exact.replay.contact import AtArc, Pair
from truebreak.exact.replay.deviations import Deviations
from truebreak.exact.replay.error_bounds import Collision, Mirror, Spent
from truebreak.exact.replay.error_set import ErrorSet
from truebreak.exact.replay.landings import Window
from truebreak.exact.replay.round_falls import RoundFall
from truebreak.exact.replay.state import Go
from truebreak.scenarios import Arc, Circle, Polygon, Quantity, Scene, Segment, StopReason, catalogue
from truebreak.scenarios.files import loads_toml

FEW, MANY = 500, 4096


def deviations(scene, events):
    """For each coordinate of each body after each step: log2 of what the midpoint is off, over the ball's radius."""
    steps = ExactEngine().run(scene, events=events).motion.log.steps
    with ball.precision(MANY):
        true = BallState(scene)
    with ball.precision(FEW):
        ours = CentredState(scene)
    for step in steps:
        for state, bits in ((ours, FEW), (true, MANY)):
            ball.use_bits(bits)
            state.do(step)
        assert ours.instant.overlaps(true.instant)
        for mine, exact in zip(ours.bodies.values(), true.bodies.values(), strict=True):
            one, other = mine.flight, exact.flight
            lag = one.t - other.t
            there = (other.x + other.vx * lag, other.y + other.vy * lag, other.vx, other.vy)
            for mine, exact in zip((one.x, one.y, one.vx, one.vy), there, strict=True):
                off, radius = abs(mine.mid() - exact.mid()), mine.rad()
                yield -1e9 if off.is_zero() else float((off / radius).log()) / log(2) if radius > 0 else 0.0


def test_every_number_lies_in_its_ball(scene):
    """Against balls of eight times the bits; and the bound is no mere upper bound: it comes within 40 bits."""
    found = list(deviations(scene, 120))
    assert max(found) <= 0.0
    assert max(found[len(found) // 2 :]) > -60.0


EDGES = (Segment(3, 5, 4, 9), Segment(11, 4, 14, "11/2", r="1/4"), Segment(13, 14, "33/2", "29/2"))


def among_edges(kind):
    """A gas of four in a box, among what is fixed: segments, thick ones, solids, circles."""
    plain = catalogue.build("gas:n=4,seed=3").with_changes(until=None, events=None)
    size = max(float(wall.x0) for wall in plain.walls)
    taken = [(float(c.x), float(c.y)) for c in plain.circles]
    places = [(x / 4, y / 4) for x in range(8, int(4 * size) - 8) for y in range(8, int(4 * size) - 8)]
    free = [(x, y) for x, y in places if all(abs(x - a) + abs(y - b) > 3.5 for a, b in taken)]
    x, y = (Quantity.of(round(4 * value)) / 4 for value in free[len(free) // 2])
    things = {
        "segment": {"segments": [Segment(x, y, x + "3/4", y + "1/3")]},
        "thick": {"segments": [Segment(x, y, x + "1/2", y, r="1/5")]},
        "solid": {"polygons": [Polygon([(x, y), (x + "3/4", y), (x + "1/3", y + "1/2")])]},
        "circle": {"circles": [*plain.circles, Circle(x, y, r="1/3", m="oo", id="peg")]},
    }
    return plain.with_changes(**things[kind])


@pytest.mark.parametrize("kind", ["segment", "thick", "solid", "circle"])
def test_every_number_lies_in_its_ball_among_what_is_fixed(kind):
    """As above, and one set is carried through ends and corners, not begun anew at each."""
    scene = among_edges(kind)
    run = ExactEngine().run(scene, events=150)
    ends = [step for step in run.motion.log.steps if isinstance(step, Go) and is_end(scene.surfaces, step.source)]
    assert len(ends) > 8
    assert max(deviations(scene.surfaces, 150)) <= 0.0


def is_end(whole, source):
    """Whether a contact is with something round that is fixed."""
    return isinstance(source, Pair) and any(whole.circles[k].fixed for k in source)


def test_among_edges_bits_go_as_fast_too():
    """Ten discs among three segments."""
    scene = catalogue.build("gas:n=10,seed=1").with_changes(until=None, events=None, segments=EDGES)
    events = 900
    run = ExactEngine().run(scene, events=events)
    with ball.precision(3000):
        state = CentredState(scene.surfaces)
        for step in run.motion.log.steps:
            state.do(step)
        radii = [float(body.flight.x.rad().log()) / log(2) for k, body in state.bodies.items() if k < 10]
    growth = error_growth(run, events) * events
    assert growth < 3000 + max(radii) < 1.1 * growth + 0.05 * events


BOW = Arc("25/2", "9/2", "5/4", "27/2", "9/2", "25/2", "11/2", id="bow")


@pytest.mark.parametrize(("name", "arcs"), [("gas:n=10,seed=1", (BOW,)), ("stadium", ()), ("mushroom", ())])
def test_at_arcs_bits_go_as_fast_too(name, arcs):
    """Ten discs with a bow among them; a point on a table with arcs. Balls lose twice as many and more."""
    scene = catalogue.build(name).with_changes(until=None, events=None)
    scene = scene.with_changes(arcs=arcs) if arcs else scene
    events = 600
    run = ExactEngine().run(scene, events=events)
    steps = run.motion.log.steps
    assert sum(isinstance(step, Go) and isinstance(step.source, AtArc) for step in steps) > 8
    lost = []
    for make in (CentredState, BallState):
        with ball.precision(4000):
            state = make(scene.surfaces)
            for step in steps:
                state.do(step)
            radii = [body.flight.x.rad() for body in state.bodies.values()]
        lost.append(4000 + max(float(radius.log()) / log(2) for radius in radii if radius > 0))
    growth = error_growth(run, events) * events
    assert lost[0] < 1.1 * growth + 0.05 * events
    assert lost[1] > 1.8 * lost[0]


@pytest.mark.parametrize(
    ("name", "events", "balls"),
    [("wedge:slope=2", 800, 3.3), ("gas-under-gravity", 1200, 2.0), ("piston", 600, 1.3), ("wedge", 4000, 60)],
)
def test_where_walls_fall_or_move_bits_go_as_fast_too(name, events, balls):
    """A wedge that is chaotic, a gas, one that a wall presses, and a wedge that is not: its bits all but stay."""
    scene = catalogue.build(name).with_changes(until=None, events=None)
    run = ExactEngine().run(scene, events=events)
    bits, lost = 12_000 if events > 1200 else 4000, []
    for make in (CentredState, BallState):
        with ball.precision(bits):
            state = make(scene)
            for step in run.motion.log.steps:
                state.do(step)
            radii = [number.rad() for body in state.bodies.values() for number in body.flight[:2]]
        lost.append(bits + max(float(radius.log()) / log(2) for radius in radii if radius > 0))
    growth = error_growth(run, events) * events
    assert growth < lost[0] < 1.1 * growth + 0.05 * events
    assert lost[1] > balls * lost[0]


def gas_onto_pegs():
    """Ten discs that fall among fixed ones and walls."""
    plain = catalogue.build("gas:n=10,seed=1").with_changes(until=None, events=None)
    spots = [Circle(x, y, "1/4", m="oo", id=f"peg{x}-{y}") for x in range(3, 17) for y in range(3, 17)]
    clear = [p for p in spots if all((p.x - c.x) ** 2 + (p.y - c.y) ** 2 > (p.r + c.r) ** 2 for c in plain.circles)]
    return plain.with_changes(circles=[*plain.circles, *clear[::12]], gravity=(0, "-1/10"))


def scene_by(name):
    return gas_onto_pegs() if name == "pegs" else catalogue.build(name).with_changes(until=None, events=None)


@pytest.mark.parametrize(
    ("name", "events", "balls"),
    [
        ("galton:e=1", 700, 1.6),
        ("plinko:e=1", 600, 1.4),
        ("pinball-table:e=1", 700, 1.7),
        ("pegs", 1200, 1.8),
        ("bowl", 2500, 60),
    ],
)
def test_where_discs_fall_onto_something_round_bits_go_as_fast_too(name, events, balls):
    """Pegboards, a table of pegs, faces, ends and arcs, a gas among pegs; a bowl, in which next to nothing grows."""
    scene = scene_by(name).surfaces
    run = ExactEngine().run(scene, events=events)
    steps = run.motion.log.steps
    on_peg = BallState(scene).on_peg
    assert sum(isinstance(s, Go) and isinstance(s.source, Pair | AtArc) and on_peg(s.source) for s in steps) > 100
    bits, lost = 12_000 if name == "bowl" else 3000, []
    for make in (CentredState, BallState):
        with ball.precision(bits):
            state = make(scene)
            for step in steps:
                state.do(step)
            radii = [number.rad() for body in state.bodies.values() for number in body.flight[:2]]
        lost.append(bits + max(float(radius.log()) / log(2) for radius in radii if radius > 0))
    growth = error_growth(run, events) * events
    assert growth < lost[0] < 1.1 * growth + 0.05 * events
    assert lost[1] > balls * lost[0]


@pytest.mark.parametrize("name", ["galton", "plinko", "bowl", "pinball-table", "peg-mirror", "platforms", "pegs"])
def test_every_number_lies_in_its_ball_onto_something_round(name):
    assert max(deviations(scene_by(name).surfaces, 120)) <= 0.0


def test_every_number_lies_in_its_ball_at_ends_that_move_under_gravity():
    plain = catalogue.build("gas:n=4,seed=3").with_changes(until=None, events=None)
    paddles = (
        Segment(3, "1/2", 5, 1, vx="1/50", vy="1/90"),
        Segment(1, "1/2", 2, "1/4", r="1/9", vx="1/40", vy="1/30"),
    )
    scene = plain.with_changes(segments=paddles, gravity=("1/7", -1))
    steps = ExactEngine().run(scene, events=200).motion.log.steps
    assert sum(isinstance(step, Go) and is_end(scene.surfaces, step.source) for step in steps) > 20
    assert max(deviations(scene.surfaces, 200)) <= 0.0


def grazing(over):
    """A disc that falls past the left of a fixed one, `over` beside a graze, and then onto the right of it; with R = 1,
    and numbers known to 2**-100."""
    start, shift, k = arb(-3), arb("-0.1"), arb(3)
    s, h = arb("2.073"), arb("1.4")
    for _ in range(12):  # until |D|^2 = 1 and D.D' = 0
        x, y, vy = start + s, h - k * (start + s - shift) ** 2 / 2, -k * (start + s - shift)
        gap, along = x * x + y * y - 1, x + y * vy
        bent = 1 + vy * vy - k * y
        h = (h - gap / (2 * y)).mid()
        s = (s - (along + vy * (-gap / (2 * y))) / bent).mid()
    scene = Scene([Circle(-3, 4, "1/2", vx=1, vy=9), Circle(0, 0, "1/2", fixed=True)], gravity=(0, -3))
    state = CentredState(scene)
    lift = h + over - k * (start - shift) ** 2 / 2
    near = arb(0, 2.0**-100)
    flight = state.bodies[0].flight._replace(y=lift + near, vy=-k * (start - shift) + near, vx=arb(1) + near)
    state.bodies[0].flight, state.bodies[0].acc = flight, 400
    state._deviations = state._begin()
    return state


def test_a_graze_that_balls_leave_open_is_not_decided_by_midpoints(monkeypatch):
    """A midpoint passes, by 2**-200, what the truth may hit, and its zero is another, which midpoints alone would have
    carried as if it were the truth's."""
    with ball.precision(400):
        plain = grazing(arb("1e-9"))  # it is told which zero
        assert centred_state.LoneCentred(plain).strike(Pair(0, 1), 400, 0) is not None
        open_one = grazing(arb(2) ** -200)
        assert centred_state.LoneCentred(open_one).strike(Pair(0, 1), 400, 0) is None
        real = centred_state.window_of

        def of_midpoints(state, link):
            body = state.bodies[0]
            kept = body.flight
            body.flight = kept._replace(**{name: getattr(kept, name).mid() for name in ("x", "y", "vx", "vy")})
            found = real(state, link)
            body.flight = kept
            return found

        monkeypatch.setattr(centred_state, "window_of", of_midpoints)
        assert centred_state.LoneCentred(grazing(arb(2) ** -200)).strike(Pair(0, 1), 400, 0) is not None


def test_a_gap_that_turns_within_a_window_falls_not_throughout():
    """Of a fall onto a disc: towards it, and from within beyond its middle."""
    zero, one = arb(0), arb(1)
    fall = RoundFall(zero, arb(4), zero, arb(-1), zero, arb("0.5"), one)
    until = arb("1.6457513")
    for hollow, time, falls in ((False, until, True), (False, until.union(arb(3)), False), (True, until, False)):
        assert Window(until, fall, hollow).falls(time) is falls


@pytest.mark.parametrize("at_once", [True, False])
def test_where_a_gap_may_turn_nothing_is_carried(at_once, monkeypatch):
    """What is looked at holds the truth's zero, and the midpoint's with all that it may be off."""
    asked, answers = [], [True, False]
    monkeypatch.setattr(Window, "falls", lambda window, until: asked.append((window, until)) or answers[len(asked) - 1])
    with ball.precision(400):
        for carried in answers:
            state = grazing(arb("1e-9"))
            if at_once:
                assert (centred_state.LoneCentred(state).strike(Pair(0, 1), 400, 0) is not None) is carried
            else:
                state.go(Pair(0, 1), (0, 1))
                assert (state._deviations is not None) is carried
            window, until = asked[-1]
            assert until.contains(window.wait) and (not carried or until.contains(state.instant))


@pytest.mark.parametrize(
    ("name", "events", "balls"), [("wedge:slope=2", 1500, 2.5), ("pinball-table:e=1", 1500, 1.8), ("pegs", 1500, 1.7)]
)
def test_a_long_fall_keeps_its_deviations_in_a_set(name, events, balls, monkeypatch):
    """Bits an event as above, in one go: the same history as in balls, which lose more."""
    scene = scene_by(name)
    plain = ExactEngine().run(scene, events=events)
    monkeypatch.setattr(precision, "LONG_BITS", 600)
    run = ExactEngine().run(scene, events=events)
    assert run.motion.log.centred
    assert not plain.motion.log.centred
    assert run.motion.log.lost < (1.1 * error_growth(run, events) + 0.05) * events
    assert plain.motion.log.lost > balls * run.motion.log.lost
    assert [e.contacts for e in run.events] == [e.contacts for e in plain.events]
    for index in (0, events // 2, events - 1):
        one, other = (each.events[index].time.ball(300) for each in (run, plain))
        assert one.overlaps(other) and one.rel_accuracy_bits() > 280


@pytest.mark.parametrize("name", ["stadium", "mushroom", "lemon:d=6/5,y=1/7"])
def test_every_number_lies_in_its_ball_at_arcs(name):
    scene = catalogue.build(name).with_changes(until=None, events=None)
    assert max(deviations(scene.surfaces, 120)) <= 0.0


@pytest.mark.parametrize(("n", "events"), [(3, 600), (10, 1200)])
def test_bits_go_as_fast_as_small_displacements_grow(n, events):
    """Balls lose twice as many."""
    scene = catalogue.build(f"gas:n={n},seed=1")
    run = ExactEngine().run(scene, events=events)
    lost = []
    for make in (CentredState, BallState):
        with ball.precision(3000):
            state = make(scene)
            for step in run.motion.log.steps:
                state.do(step)
            lost.append(3000 + max(float(body.flight.x.rad().log()) / log(2) for body in state.bodies.values()))
    growth = error_growth(run, events) * events
    assert growth < lost[0] < 1.1 * growth + 45
    assert lost[1] > 1.9 * growth


def test_a_long_run_keeps_its_deviations_in_a_set(monkeypatch):
    """With the set from early on: the same history, with fewer bits; its times are had to any digit again."""
    scene = catalogue.build("gas:n=6,seed=2")
    plain = ExactEngine().run(scene, events=900)
    monkeypatch.setattr(precision, "LONG_BITS", 512)
    centred = ExactEngine().run(scene, events=900)
    assert centred.motion.log.centred
    assert not plain.motion.log.centred
    assert [e.contacts for e in centred.events] == [e.contacts for e in plain.events]
    assert centred.plan["bits"] < plain.plan["bits"]
    for index in (*range(0, 900, 60), 899):  # each replays the run up to it
        one, other = (run.events[index].time.ball(400) for run in (centred, plain))
        assert one.overlaps(other)
        assert one.rel_accuracy_bits() > 380


def test_long_numbers_have_the_history_of_all_others(monkeypatch):
    """With short clocks from early on: the same history in the same bits, and the same times to 400 of them."""
    scene = catalogue.build("gas:n=6,seed=2,mixed=yes")
    monkeypatch.setattr(precision, "LONG_BITS", 512)
    plain = ExactEngine().run(scene, events=900)
    clocks, made = [], centred_state.short_clock
    monkeypatch.setattr(centred_state, "LONG_NUMBERS", 300)
    monkeypatch.setattr(centred_state, "short_clock", lambda *given: clocks.append(made(*given)) or clocks[-1])
    ours = ExactEngine().run(scene, events=900)
    assert len(clocks) > 400
    assert max(clock.bits() for clock in clocks) <= centred_state.CLOCK_BITS
    assert [e.contacts for e in ours.events] == [e.contacts for e in plain.events]
    assert ours.plan == plain.plan
    for one, other in zip(ours.events[::60], plain.events[::60], strict=True):
        assert one.time.ball(400).overlaps(other.time.ball(400))


def turned(matrix, x, y):
    """(xx, xy; yx, yy) (x, y)."""
    xx, xy, yx, yy = matrix
    return xx * x + xy * y, yx * x + yy * y


@pytest.mark.parametrize("seed", range(4))
def test_a_set_holds_what_is_carried_exactly(seed):
    """A set against its own steps, carried out in long balls: flights, mirrors at any angle, collisions of unequal
    masses and with what is fixed. Points of the box, corners among them, lie within the bounds, block after block; and
    the bounds are no idle ones."""
    draw = random.Random(seed)
    with ball.precision(400):
        count, unit = 4, 0.5
        errors = ErrorSet([[1.0, 0.5, 2.0, 0.25]] * count, 0, unit)
        sides = [(1.0, 0.5, 2.0 / unit, 0.25 / unit)] * count  # velocities are counted in the set's unit of time
        shares = [[draw.choice([-1, 1, draw.uniform(-1, 1)]) for _ in range(4 * count)] for _ in range(40)]
        points = [[[arb(r[4 * k + m] * sides[k][m]) for m in range(4)] for k in range(count)] for r in shares]
        for _ in range(14 * count):
            i, j = draw.sample(range(count), 2)
            j = draw.choice([j, j, j, -1])
            if draw.random() < 0.4:
                angle, lag = arb(draw.uniform(0, 3)), draw.uniform(0, 2)
                c, s = (angle + angle).cos(), (angle + angle).sin()
                xx, xy, yy = float(c), float(s), float(-c)
                errors.fly(i, lag / unit, Mirror(xx, xy, yy, 2.0**-50))
                for point in points:
                    x, y, vx, vy = point[i]
                    point[i] = [
                        *turned((c, s, s, -c), x + lag * vx, y + lag * vy),
                        *turned((c, s, s, -c), vx, vy),
                    ]
            else:
                weights = draw.uniform(0.1, 3.0), 0.0 if j < 0 else draw.uniform(0.1, 3.0)
                lags = draw.uniform(0, 1), 0.0 if j < 0 else draw.uniform(0, 1)
                reach, angle, slant = arb(draw.uniform(0.1, 2)), arb(draw.uniform(0, 7)), arb(draw.uniform(-1.4, 1.4))
                speed = arb(draw.uniform(0.2, 5))
                dx, dy = reach * angle.cos(), reach * angle.sin()
                vx, vy = -speed * (angle + slant).cos(), -speed * (angle + slant).sin()
                rate = dx * vx + dy * vy
                strength = arb(-2) / (reach * reach * (weights[0] + weights[1]))
                square = vx * vx + vy * vy
                bxx, bxy, byy, *a = pair_tangent_blocks(dx, dy, rate, dx * vy - dy * vx, square, strength)
                told = map(float, (dx, dy, vx, vy, -rate, strength))
                hit = Collision(0.0, 0.0, float(unit * square / -rate) * 1.0001, *told)
                errors.meet(i, j, (lags[0] / unit, lags[1] / unit), weights, hit, 0.0)
                for point in points:
                    flown = []
                    for k, lag in ((i, lags[0]), (j, lags[1])):
                        x, y, ux, uy = point[k] if k >= 0 else [arb(0)] * 4
                        flown.append((x + lag * ux, y + lag * uy, ux, uy))
                    px, py, qx, qy = (second - first for first, second in zip(*flown, strict=True))
                    ox, oy = turned((bxx, bxy, bxy, byy), px, py)
                    (rx, ry), (sx, sy) = turned(a, px, py), turned((bxx, bxy, bxy, byy), qx, qy)
                    for k, of, sign in ((i, 0, -1), (j, 1, 1)):
                        if k >= 0:
                            gained = [sign * weights[of] * part for part in (ox, oy, rx + sx, ry + sy)]
                            point[k] = [old + more for old, more in zip(flown[of], gained, strict=True)]
            if errors.full or draw.random() < 0.1:
                errors.close()
            for k in range(count):
                place, pace = (arb(2) ** errors.power_of(part[k]) for part in (errors.bounds.place, errors.bounds.pace))
                for point in points:
                    x, y, vx, vy = point[k]
                    assert abs(x) < place
                    assert abs(y) < place
                    assert abs(vx) * unit < pace
                    assert abs(vy) * unit < pace
        errors.close()
        widest = max(float(abs(value).log()) / log(2) for point in points for row in point for value in row)
        assert max(errors.power_of(bound) for bound in errors.bounds.place + errors.bounds.pace) < widest + 12


def test_a_set_that_doubles_cannot_carry_says_so():
    errors = ErrorSet([[1.0] * 4] * 2, 0)
    huge = Collision(0.0, 0.0, 1e200, 1e100, 0.0, -1e100, 0.0, 1e200, -1.0)
    errors.meet(0, 1, (1.0, 1.0), (1.0, 1.0), huge, 0.0)
    errors.meet(0, 1, (1.0, 1.0), (1.0, 1.0), huge, 0.0)
    with pytest.raises(Spent):
        errors.close()
    with pytest.raises(Spent):
        errors.power_of(errors.bounds.pace[0])


@pytest.mark.parametrize("name", ["pinball-table:e=1", "galton:e=1"])
def test_a_set_that_loses_so_much_that_no_zero_is_told_is_given_up(name, monkeypatch):
    """With roundings of 2**-9 at each contact: the log cannot be carried out in it at all."""
    scene = scene_by(name)
    plain, real, seen = ExactEngine().run(scene, events=200), Deviations.recentre, []

    def rough(held, *given):
        rounding, doubles = real(held, *given)
        seen.append(ldexp(1.0, max(-900, -9 - held.errors.shift)))
        return max(rounding, seen[-1]), doubles

    monkeypatch.setattr(Deviations, "recentre", rough)
    monkeypatch.setattr(precision, "LONG_BITS", 100)
    run = ExactEngine().run(scene, events=200)
    assert seen
    assert not run.motion.log.centred
    assert [e.contacts for e in run.events] == [e.contacts for e in plain.events]


WEDGE = """\
reverse_at = "25/8"
until = "25/4"

[[circle]]
id = "heavy"
x = "-21/20 + (24/25)*3*sqrt(3)"
y = "-18/5 - (7/25)*3*sqrt(3)"
r = 1
vx = "7/20 - (24/25)*sqrt(3)"
vy = "6/5 + (7/25)*sqrt(3)"
m = 10000000

[[circle]]
id = "point"
x = "-63/100 + (24/25)*(3*sqrt(3)/2)"
y = "-54/25 - (7/25)*(3*sqrt(3)/2)"
r = 0
vx = "77/300 - (24/25)*(2*sqrt(3)/3)"
vy = "22/25 + (7/25)*(2*sqrt(3)/3)"
m = "1/2"
point = true

[[circle]]
id = "light"
x = "-21/50 - (24/25)*(1/10**100 - 21*sqrt(3)/4)"
y = "-36/25 + (7/25)*(1/10**100 - 21*sqrt(3)/4)"
r = "1/2"
vx = "21/100 - (24/25)*(3*sqrt(3)/2)"
vy = "18/25 + (7/25)*(3*sqrt(3)/2)"

[[wall]]
id = "w1"
x0 = "-7/50 - (12/25)*sqrt(3)"
y0 = "-12/25 + (7/50)*sqrt(3)"
x1 = "(7/25)*(-1/2 + sqrt(3)/2) - (24/25)*(sqrt(3)/2 + 1/2)"
y1 = "(24/25)*(-1/2 + sqrt(3)/2) + (7/25)*(sqrt(3)/2 + 1/2)"

[[wall]]
id = "w2"
x0 = "7/50 - (12/25)*sqrt(3)"
y0 = "12/25 + (7/50)*sqrt(3)"
x1 = "(7/25)*(1/2 + sqrt(3)/2) - (24/25)*(sqrt(3)/2 - 1/2)"
y1 = "(24/25)*(1/2 + sqrt(3)/2) + (7/25)*(sqrt(3)/2 - 1/2)"
"""
"""A point in a wedge behind a circle of 10**7 times its mass: thousands of events, 10**-100 from the origin."""


def test_a_set_that_loses_more_than_balls_is_given_up():
    """Deviations are rounded to the smallest number's accuracy, which is bad where one is 10**-100 and others are 1."""
    run = ExactEngine(work=300_000).run(loads_toml(WEDGE), events=2200)
    assert len(run.events) == 2200
    assert precision.LONG_BITS <= run.plan["bits"] < 2 * precision.LONG_BITS


def test_a_time_that_no_bits_sharpen_ends_within_counted_work(monkeypatch):
    """As a question does: named, with the work; long before there are no more bits."""
    sharp, wait, late = precision.CertifiedMeetings.time, precision.Moment.wait, []

    def time(self, moment):
        late.extend(["its ball holds all"] * (len(self._state.steps) > 60))
        try:
            return sharp(self, moment)
        finally:
            late.clear()

    def unsharp(self, state):
        return (arb("nan"), arb("nan")) if late else wait(self, state)

    monkeypatch.setattr(precision.CertifiedMeetings, "time", time)
    monkeypatch.setattr(precision.Moment, "wait", unsharp)
    run = ExactEngine().run(catalogue.build("rack:rows=4,pockets=no,speed=8"), events=60)
    assert run.stop.reason is StopReason.UNDECIDED
    assert "is unsharp" in run.stop.message
    assert "more than 3000000 units of work (--work)" in run.stop.message
    assert run.plan["bits"] < 1 << 20
