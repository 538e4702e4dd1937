"""The tangent map: derived from the laws, proved as written, and equal to the difference of two exact runs."""

from __future__ import annotations

from fractions import Fraction as Q
from random import Random

import law_forms
import law_proofs
import numpy as np
import pytest
from flint import arb, arb_mat
from law_proofs import functions

from truebreak.compare.tangent import growth
from truebreak.compare.tangent import impacts as impacts_of
from truebreak.compare.tangent.growth import Displacements, certified_growth, error_growth, unit_displacements
from truebreak.compare.tangent.hazard import Course
from truebreak.compare.tangent.impacts import LEAST_BITS, Graze, NoTangentMap, first_graze, impacts, moving
from truebreak.exact import ExactEngine
from truebreak.exact.exact_motion import ExactMotion, motion_of
from truebreak.exact.laws.derivation import LawError
from truebreak.exact.laws.formulas import wall_bounce
from truebreak.exact.laws.tangent_formulas import pair_tangent
from truebreak.exact.numbers import ball
from truebreak.exact.replay.contact import Pair
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Arc, Circle, Pocket, Polygon, Quantity, Scene, Segment, Trajectory, Wall, catalogue

TEXT = law_forms.tangent_text()


def test_the_file_is_current() -> None:
    assert law_proofs.TANGENT_FORMULAS.read_text("utf-8") == TEXT, "run: python docs/studies/law_proofs.py"


def test_what_is_written_is_what_the_laws_lead_to() -> None:
    law_proofs.prove_tangent(functions(TEXT, law_forms.TANGENT_FORMS), wall_bounce)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("return dx * shift,", "return -dx * shift,"),
        ("mx = vx * wait + px", "mx = px"),
        ("-(approach + approach) / weight", "(approach + approach) / weight"),
        ("wa + wb", "wa + wa"),
        ("(nx * px + ny * py)) * pull", "(nx * px + ny * py)) * approach"),
        ("return nx * turn, ny * turn", "return -nx * turn, -ny * turn"),
        ("((nx * px + ny * py) + (nx * px + ny * py)) * pull", "(nx * px + ny * py) * pull"),
        ("* pull / (nn * approach)", "* pull / (nn + approach)"),
    ],
)
def test_a_wrong_form_is_not_proved(right: str, wrong: str) -> None:
    assert right in TEXT
    with pytest.raises(LawError):
        law_proofs.prove_tangent(functions(TEXT.replace(right, wrong), law_forms.TANGENT_FORMS), wall_bounce)


def test_a_displacement_that_is_not_mirrored_is_not_proved() -> None:
    with pytest.raises(LawError, match="mirrored"):
        law_proofs.prove_tangent(functions(TEXT, law_forms.TANGENT_FORMS), lambda vx, vy, nx, ny, nn: (vx, vy))


def test_it_is_the_map_of_dellago_posch_and_hoover() -> None:
    """Their form, for unit masses: A = (a.n) n, B = (b.n) n + ((w.ac) n + (w.n) ac) / s."""
    d, w, a, b, s = (Q(3), Q(4)), (Q(-2), Q(1)), (Q(1, 7), Q(2)), (Q(5), Q(-1, 3)), Q(5)
    n = tuple(part / s for part in d)

    def dot(x: tuple[Q, ...], y: tuple[Q, ...]) -> Q:
        return x[0] * y[0] + x[1] * y[1]

    ac = tuple(p - dot(a, n) / dot(w, n) * q for p, q in zip(a, w, strict=True))
    first = tuple(dot(a, n) * part for part in n)
    second = tuple(dot(b, n) * k + (dot(w, ac) * k + dot(w, n) * c) / s for k, c in zip(n, ac, strict=True))
    told = pair_tangent(*d, *w, s, Q(1), Q(1), *a, *b)
    assert told == tuple(-part for part in (*first, *second))  # what b gains is what a loses


def moved(scene: Scene, amount: Quantity, index: int = 0, coordinate: int = 0) -> Scene:
    circles = list(scene.circles)
    c = circles[index]
    x, y, vx, vy = (value + (amount if k == coordinate else 0) for k, value in enumerate((c.x, c.y, c.vx, c.vy)))
    circles[index] = Circle(x, y, c.r, vx, vy, m=c.m, id=c.id, point=c.point)
    return scene.with_changes(circles=circles)


def carried_through(run: Trajectory, start: np.ndarray, events: int) -> Displacements:
    carried = Displacements(run.scene, start)
    for struck in impacts(run, events):
        carried.through(struck)
    return carried


def difference(
    scene: Scene, events: int, size: str = "10**-150", index: int = 0, coordinate: int = 0, ahead: str = "10**-40"
) -> tuple[Trajectory, np.ndarray, np.ndarray]:
    """The exact difference quotient of a displacement of a coordinate (x, y, vx, vy), and what the map tells.

    Both just before the run's last event.
    """
    small = Quantity.of(size)
    run = ExactEngine().run(scene, events=events)
    count = len(run.events)
    before = Quantity.of(run.events[-1].time.digits(80)) - Quantity.of(ahead)
    other = ExactEngine().run(moved(scene, small, index, coordinate), until=before)
    told = [sorted(pair for event in events for pair in event.contacts) for events in (run.events[:-1], other.events)]
    assert told[0] == told[1]
    rows = []
    free = moving(scene)
    for one, two in zip(run.at(before).circles, other.at(before).circles, strict=True):
        pairs = [(one.x, two.x), (one.y, two.y), (one.vx, two.vx), (one.vy, two.vy)]
        rows.append([float((b.ball(1200) - a.ball(1200)) / small.ball(1200)) for a, b in pairs])
    start = np.zeros((len(free), 4, 1))
    start[free.index(index), coordinate, 0] = 1.0
    carried = carried_through(run, start, count - 1)
    carried.fly(float(before))
    return run, np.array(rows)[free], carried.columns[:, :, 0] * 2.0**carried.scale


FIXED = Scene(
    [
        Circle(2, 3, vx=1, vy="1/3", m=2, id="a"),
        Circle("21/2", "9/2", r="3/2", vx="-1/2", vy="2/7", m="1/3", id="b"),
        Circle(7, 9, r=0, vx="3/5", vy=-1, point=True, id="dot"),
        Circle(6, "13/2", m="oo", id="post"),
    ],
    [Wall(0, 0, 1, "1/9"), Wall(0, 0, "-1/7", 2), Wall(13, 0, 13, 1), Wall(0, 13, 1, 13)],
    name="masses, a post, a point and slopes",
)


@pytest.mark.parametrize(
    "scene",
    [
        *(catalogue.build(text) for text in ("gas", "gas:n=5,seed=3,mixed=yes", "gas:n=3", "point", "galperin:n=2")),
        FIXED,
    ],
    ids=lambda scene: scene.name,
)
def test_the_map_is_the_difference_of_two_exact_runs_over_300_events(scene: Scene) -> None:
    run, exact, mapped = difference(scene.with_changes(until=None), 300)
    assert len(run.events) == 300
    assert np.abs(mapped - exact).max() <= 0.01 * np.abs(exact).max()
    assert np.abs(mapped - exact).max() <= 1e-6 * np.abs(exact).max()


MOVING = Scene(
    [Circle(0, 3, vx="1/3", id="a"), Circle("1/4", 6, id="b")],
    [Wall(0, 0, 5, 1, vy="1/2", id="floor"), Wall(-3, 0, -3, 1, id="l"), Wall(3, 0, 3, 1, vx="1/9", id="r")],
    gravity=(0, -2),
    restitution="9/10",
    name="a slope that rises between walls that part",
)


@pytest.mark.parametrize("scene", [MOVING, catalogue.build("piston:n=4")], ids=lambda scene: scene.name)
def test_so_it_is_among_walls_that_move(scene: Scene) -> None:
    run, exact, mapped = difference(scene.with_changes(until=None, events=None), 40)
    assert len(run.events) == 40
    assert np.abs(mapped - exact).max() <= 1e-6 * np.abs(exact).max()


@pytest.mark.parametrize("lift", ["0", "1/4", "-1/3"])
@pytest.mark.parametrize("pull", [None, (0, -2)])
def test_what_would_be_met_instead_comes_when_the_law_says(lift: str, pull: tuple[int, int] | None) -> None:
    floor, right = Wall(0, 0, 5, 1, vy=lift, id="floor"), Wall(6, 0, 6, 1, vx="-1/5", id="right")
    ball = Circle(0, 9, vx=3, vy=-1, id="ball")
    run, alone = (
        ExactEngine().run(Scene([ball], walls, gravity=pull), events=1) for walls in ([floor, right], [floor])
    )
    assert [pair.second for event in run.events for pair in event.contacts] == ["right"]
    ((impact,),) = impacts(run, 1)
    course = Course(run.scene)
    course.fly(float(impact.time))
    others = course.instead([impact], 0)
    late = float(alone.events[0].time) - float(run.events[0].time)
    assert others.waits.tolist() == pytest.approx([late], rel=1e-12)
    course.push(impact)
    after = run.after(0)["ball"]
    assert course.speeds[0].tolist() == pytest.approx([float(after.vx), float(after.vy)], rel=1e-12)


@pytest.mark.parametrize(("index", "coordinate"), [(0, 3), (1, 1), (1, 2), (2, 0), (2, 3)])
def test_so_it_is_whatever_is_displaced(index: int, coordinate: int) -> None:
    """Places and velocities, of a heavy disc, a light one and a point."""
    run, exact, mapped = difference(FIXED.with_changes(until=None), 300, index=index, coordinate=coordinate)
    assert len(run.events) == 300
    assert np.abs(mapped - exact).max() <= 1e-6 * np.abs(exact).max()


def test_contacts_at_one_instant_of_different_circles_have_a_map() -> None:
    """Two boxes, one the other shifted: each event is one of both, and a displacement parts them."""
    pair = [Circle(2, 3, vx=1, vy="1/3", id="a"), Circle(7, 6, vx="-1/2", vy="2/7", m=2, id="b")]
    twins = [Circle(c.x, c.y + 20, c.r, c.vx, c.vy, m=c.m, id=f"{c.id}'") for c in pair]
    walls = [Wall(0, 0, 0, 1), Wall(10, 0, 10, 1), *(Wall(0, y, 1, y) for y in (0, 10, 20, 30))]
    run, exact, mapped = difference(Scene([*pair, *twins], walls), 300)
    assert len(run.events) == 300
    assert all(len(event.contacts) >= 2 for event in run.events)
    assert np.abs(mapped - exact).max() <= 1e-6 * np.abs(exact).max()


def test_where_errors_grow_beyond_the_displacement_a_smaller_one_shows_it() -> None:
    """300 events of the Lorentz gas make 10**-150 larger than the scene."""
    run, exact, mapped = difference(catalogue.build("lorentz").with_changes(until=None), 300, "10**-300")
    assert len(run.events) == 300
    assert np.abs(exact).max() > 1e140
    assert np.abs(mapped - exact).max() <= 1e-6 * np.abs(exact).max()


def corner(y: str) -> Scene:
    """A disc that meets a wall and a fixed disc straight above it, or a second wall, in one instant."""
    walls = [Wall(0, 0, 0, 1, id="left"), Wall(0, 0, 1, 0, id="low")]
    post = [Circle(1, 3, m="oo", id="post")] if y == "post" else []
    speed = {"vx": -1, "vy": "3/4" if post else -1}
    return Scene([Circle(5, -2 if post else 5, **speed, id="a"), *post], walls[:1] if post else walls)


@pytest.mark.parametrize("kind", ["wall", "post"])
@pytest.mark.parametrize("size", ["10**-150", "-10**-150"])
def test_reflections_at_right_angles_commute_and_have_a_map(kind: str, size: str) -> None:
    """Displaced to one side the disc meets the one first, to the other side the other: to the same effect."""
    scene = corner(kind)
    run = ExactEngine().run(scene, events=1)
    assert len(run.events[0].contacts) == 2
    other = ExactEngine().run(moved(scene, Quantity.of(size)), events=2)
    assert len(other.events) == 2
    after = Quantity.of(other.events[-1].time.digits(60)) + 1
    here, there = ExactEngine().run(scene, until=after), ExactEngine().run(moved(scene, Quantity.of(size)), until=after)
    small = Quantity.of(size).ball(900)
    one, two = here.at(after).circles[0], there.at(after).circles[0]
    pairs = [(one.x, two.x), (one.y, two.y), (one.vx, two.vx), (one.vy, two.vy)]
    exact = [float((b.ball(900) - a.ball(900)) / small) for a, b in pairs]
    carried = carried_through(run, unit_displacements(scene)[:, :, :1], 1)
    carried.fly(float(after))
    assert np.abs(carried.columns[0, :, 0] - exact).max() <= 1e-12


def test_with_a_moving_partner_they_do_not_commute_and_the_map_is_refused() -> None:
    """What a displacement leads to depends on its sign: no linear map does that."""
    circles = [Circle(0, 0, vx=1, vy="1/2", id="b"), Circle(5, 0, vy="1/2", id="a"), Circle(3, "7/2", id="c")]
    scene = Scene(circles)
    run = ExactEngine().run(scene, events=1)
    assert len(run.events[0].contacts) == 2
    assert not run.events[0].coupled
    with pytest.raises(NoTangentMap, match="event 0: b has several contacts"):
        impacts(run, 1)
    quotients = []
    for size in ("10**-150", "-10**-150"):
        small = Quantity.of(size)
        here, there = (ExactEngine().run(s, until=5) for s in (scene, moved(scene, small)))
        ends = [[(c.vx.ball(900), c.vy.ball(900)) for c in r.final.circles] for r in (here, there)]
        pairs = [(x, y) for one, two in zip(*ends, strict=True) for x, y in zip(one, two, strict=True)]
        quotients.append([float((y - x) / small.ball(900)) for x, y in pairs])
    assert np.abs(np.subtract(*quotients)).max() > 0.01


def onto_two(what: str, aside: Quantity | int = 0, e: str | int = 1) -> Scene:
    """A disc that meets two things at time 1, at right angles, one of them round; displaced by so much."""
    if what == "two discs":
        still = [Circle(0, -20, 19, m="oo"), Circle(2, 0, 1, m="oo")]
        return Scene([Circle(-1, Quantity.of(aside) + 10, vx=1, vy=-10), *still], restitution=e)
    wall = Wall(2, 0, 2, 1, vx=-1) if what == "a wall that moves" else Wall(1, 0, 1, 1)
    return Scene([Circle(Quantity.of(aside) - 3, 2, vx=3, vy=-2), Circle(0, -2, 1, m="oo")], [wall], restitution=e)


@pytest.mark.parametrize(("what", "e"), [("two discs", "1/10"), ("a wall", "1/2"), ("a wall that moves", 1)])
def test_beside_something_round_they_commute_only_where_all_stand_and_keep_energy(what: str, e: str | int) -> None:
    """What a displacement leads to depends on its sign: by which of the two is met first."""
    run = ExactEngine().run(onto_two(what, e=e), until=2)
    assert len(run.events[0].contacts) == 2 and not run.events[0].coupled
    with pytest.raises(NoTangentMap, match="event 0: c1 has several contacts"):
        impacts(run, 1)
    quotients = []
    for size in ("10**-150", "-10**-150"):
        near = ExactEngine().run(onto_two(what, Quantity.of(size), e), until=2)
        one, two = (r.at("9/8").circles[0] for r in (run, near))
        pairs = [(getattr(one, k), getattr(two, k)) for k in ("x", "y", "vx", "vy")]
        quotients.append([float((y.ball(900) - x.ball(900)) / Quantity.of(size).ball(900)) for x, y in pairs])
    assert np.abs(np.subtract(*quotients)).max() > 0.01


@pytest.mark.parametrize("what", ["two discs", "a wall"])
def test_beside_something_round_that_stands_they_commute_where_energy_is_kept(what: str) -> None:
    run = ExactEngine().run(onto_two(what), until=2)
    assert len(run.events[0].contacts) == 2 and len(impacts(run, 1)[0]) == 2


def test_a_wall_and_a_fixed_circle() -> None:
    scene = Scene(
        [Circle(0, 0, vx=1, vy="1/3", id="a"), Circle(9, 2, m="oo", id="o")],
        [Wall(-2, 0, -3, 1, id="slope"), Wall(0, 12, 1, 12, id="top"), Wall(0, -12, 1, -12, id="low")],
    )
    run, exact, mapped = difference(scene, 4)
    assert len(run.events) == 4
    assert np.abs(mapped - exact).max() <= 1e-9 * np.abs(exact).max()


def test_the_growth_of_errors_in_the_gas() -> None:
    run = ExactEngine().run(catalogue.build("gas"), events=161)
    rate = error_growth(run, 161)
    assert rate is not None
    assert 161 * rate == pytest.approx(53, abs=2)  # doubles diverge at event 161
    assert error_growth(run, 40) is not None


@pytest.mark.parametrize("text", ["gas:n=4", "lorentz"])
def test_a_run_of_floats_has_the_map_of_the_exact_one_while_it_is_near(text: str) -> None:
    """Its impacts are read off its states, not off a log: another way to the same numbers."""
    scene = catalogue.build(text)
    growths = [error_growth(engine.run(scene, events=10), 10) for engine in (ExactEngine(), DoubleEngine())]
    assert growths[1] == pytest.approx(growths[0], rel=1e-6)


@pytest.mark.parametrize(
    ("scene", "events", "reason"),
    [
        (catalogue.build("lee"), 1, "event 0: middle has several contacts"),
        (catalogue.build("tennis"), 1, "basketball and tennis touch from the start on"),
        (catalogue.build("gas:n=3").with_changes(reverse_after=4, events=8), 6, "turns back after 4 events"),
        (Scene([Circle(0, 0, vx=-1)], [Wall(-3, 0, -3, 1)], pockets=[Pocket(9, 9, 1)], capture=True), 1, "capture"),
        (Scene([Circle(0, 1, vx=1), Circle(9, 1)], [Wall(0, 0, 1, 0)]), 1, "c1 and w1 touch from the start on"),
        (catalogue.build("grazing"), 1, "before event 0, mover and rest graze"),
        (Scene([Circle(0, 0, vx=1), Circle(4, 0), Circle(0, 9, vx=1), Circle(2, 11)]), 1, "0, c3 and c4 graze"),
        (Scene([Circle(0, 0, vx=1), Circle(4, 0), Circle(9, 2), Circle(14, 0)]), 2, "event 1, c2 and c3 graze"),
    ],
)
def test_where_there_is_no_map_it_is_refused(scene: Scene, events: int, reason: str) -> None:
    run = ExactEngine().run(scene, events=8)
    with pytest.raises(NoTangentMap, match=reason):
        impacts(run, events)
    assert error_growth(run, events) is None


def test_a_graze_that_does_not_come_to_pass_takes_no_map_away() -> None:
    """The first ball would graze the last one, but hits another before; that one does graze it, after event 0."""
    run = ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 0), Circle(9, 2)], [Wall(15, 0, 15, 1)]), events=2)
    assert isinstance(run.motion, ExactMotion) and run.motion.tape is not None
    grazes = run.motion.tape.grazes
    assert (grazes[0], grazes[2]) == ([Pair(0, 2)], [Pair(1, 2)])
    assert len(impacts(run, 1)) == 1
    with pytest.raises(NoTangentMap, match="event 1, c2 and c3 graze") as refused:
        impacts(run, 2)
    assert refused.value.events == 1


def test_before_a_reversal_there_is_a_map() -> None:
    run = ExactEngine().run(catalogue.build("gas:n=3").with_changes(reverse_after=4, events=8))
    assert error_growth(run, 4) is not None
    assert error_growth(run, 0) is None


def test_large_displacements_are_scaled() -> None:
    run = ExactEngine().run(catalogue.build("gas"), events=20)
    units = unit_displacements(run.scene)
    plain, scaled = (carried_through(run, units * size, 20) for size in (1.0, growth.RESCALED))
    assert scaled.scale > 0
    assert np.allclose(plain.columns * growth.RESCALED / 2.0**scaled.scale, scaled.columns, rtol=1e-9)


def test_numbers_that_the_run_had_exactly_are_replayed_with_bits_enough() -> None:
    """The periodic pinball needs few bits to be decided, and hundreds to be followed in balls."""
    run = ExactEngine().run(catalogue.build("pinball"), events=100)
    carried = carried_through(run, unit_displacements(run.scene), 100)
    reach = 6 / 1.1  # the ball's radius added to the discs'
    bounce = np.log2(reach - 1 + np.sqrt(reach * (reach - 2)))
    grown = carried.scale + np.log2(np.linalg.norm(carried.matrix, 2))
    assert grown / 100 == pytest.approx(bounce, rel=0.02)


@pytest.mark.parametrize("text", ["gas", "lorentz", "gas:n=4,mixed=yes", "pinball"])
@pytest.mark.parametrize("events", [1, 25, 60])
def test_certified_growth_holds_what_doubles_say(text: str, events: int) -> None:
    run = ExactEngine().run(catalogue.build(text).with_changes(until=None), events=events)
    told, rate = certified_growth(run, events), error_growth(run, events)
    assert rate is not None
    assert told.low - 1e-9 <= rate * events <= told.high + 1e-9
    assert told.high - told.low < 0.1


def test_certified_growth_of_two_collisions_by_hand() -> None:
    """A disc flies 2 to a wall and 3 back: reflected, and x displaced by 5 times v's."""
    run = ExactEngine().run(Scene([Circle(0, 0, vx=1)], [Wall(3, 0, 3, 1), Wall(-2, 0, -2, 1)]), events=2)
    told = certified_growth(run, 2)
    norm = (5 + np.sqrt(29)) / 2  # of ((1, 5), (0, 1))
    assert told.low <= np.log2(norm) <= told.high


def test_growth_is_certified_along_certified_runs_only() -> None:
    scene = catalogue.build("gas:n=3")
    with pytest.raises(NoTangentMap, match="certified"):
        certified_growth(DoubleEngine().run(scene, events=5), 5)
    with pytest.raises(NoTangentMap, match="the run has 5"):
        certified_growth(ExactEngine().run(scene, events=5), 6)


BOX = [Wall(0, -6, 1, -6), Wall(0, 6, 1, 6), Wall(-7, 0, -7, 1), Wall(7, 0, "29/4", 9)]

FALLING = Scene(
    [
        Circle(-3, 1, vx=1, vy="1/3", m=2, id="a"),
        Circle("5/2", "9/2", r="2/3", vx="-1/2", vy="2/7", m="1/3", id="b"),
        Circle(1, -3, r=0, vx="3/5", vy=-1, point=True, id="dot"),
    ],
    BOX,
    gravity=("1/3", -2),
    restitution="9/10",
    name="falls",
)


PEGS = FALLING.with_changes(
    circles=[
        *FALLING.circles,
        Circle(-5, -4, "3/4", m="oo", id="peg"),
        Circle("9/2", -3, "1/2", m="oo", id="post"),
    ],
    segments=[Segment(-4, -2, -2, "-9/4", r="1/8", id="shelf"), Segment("1/2", 2, "7/2", 1, id="blade")],
    polygons=[Polygon([(0, -6), (2, -6), (1, -5)], r="1/10", id="hill")],
    name="falls among pegs, faces and ends",
)


@pytest.mark.parametrize(
    "scene",
    [
        PEGS,
        PEGS.with_changes(restitution=1, name="falls among pegs and loses nothing"),
        FALLING,
        FALLING.with_changes(restitution=1, name="falls and loses nothing"),
        FALLING.with_changes(gravity=None, name="loses and does not fall"),
        *(catalogue.build(text) for text in ("wedge:slope=2", "falling-line", "drop-pair", "gas-under-gravity")),
    ],
    ids=lambda scene: scene.name,
)
@pytest.mark.parametrize(("index", "coordinate"), [(0, 0), (0, 1), (0, 2), (0, 3), (-1, 3)])
def test_the_map_holds_under_gravity_and_with_a_restitution(scene: Scene, index: int, coordinate: int) -> None:
    place = moving(scene)[index]
    run, exact, mapped = difference(scene.with_changes(until=None), 60, index=place, coordinate=coordinate)
    assert len(run.events) == 60
    assert np.abs(mapped - exact).max() <= 1e-9 * np.abs(exact).max()


@pytest.mark.parametrize(
    ("text", "events"),
    [
        ("axis", 4),
        ("ramp", 6),
        ("ski-jump", 13),
        ("platforms", 60),
        ("peg-mirror", 100),
        ("plinko", 60),
        ("galton", 60),
    ],
)
@pytest.mark.parametrize("coordinate", [0, 1, 2])
def test_so_it_does_on_pegs_ramps_and_platforms_of_the_catalogue(text: str, events: int, coordinate: int) -> None:
    scene = catalogue.build(text).with_changes(until=None)
    run, exact, mapped = difference(scene, events, index=moving(scene)[0], coordinate=coordinate)
    assert len(run.events) == events
    assert np.abs(mapped - exact).max() <= 1e-8 * np.abs(exact).max()


@pytest.mark.parametrize("text", ["axis", "platforms", "galton"])
def test_a_neighbour_by_a_last_bit_of_a_double_is_where_the_map_says(text: str) -> None:
    """So near by its own measure: what a displacement of 2**-60 lacks of the map is of second order."""
    scene = catalogue.build(text).with_changes(until=None)
    _, exact, mapped = difference(scene, 12, "2**-60", index=moving(scene)[0], ahead="2**-12")
    assert np.abs(mapped - exact).max() <= 1e-6 * np.abs(exact).max()


def test_bounces_up_to_an_accumulation_have_a_map() -> None:
    """No error grows there, and each bounce makes it less sharp."""
    scene = Scene([Circle(0, 6, vx="1/3")], [Wall(0, 0, 1, 0)], gravity=(0, -10), restitution="1/2")
    run, exact, mapped = difference(scene, 30, index=0, coordinate=1)
    assert run.ending is not None and len(run.events) == 21
    assert np.abs(mapped - exact).max() <= 1e-9 * np.abs(exact).max()


def _other_sign(*numbers: object) -> tuple[object, ...]:
    return tuple(-part for part in FALL_TURN(*numbers))


def _tenth_off(*numbers: object) -> tuple[object, ...]:
    return tuple(part * 1.1 for part in FALL_TURN(*numbers))


def _missing(*numbers: object) -> tuple[object, ...]:
    return tuple(part * 0 for part in FALL_TURN(*numbers))


FALL_TURN = growth.fall_turn
FALL_FAULTS = {
    "gravity of the other sign at a bounce": (growth, "fall_turn", _other_sign),
    "gravity off by a tenth at a bounce": (growth, "fall_turn", _tenth_off),
    "no gravity at a bounce": (growth, "fall_turn", _missing),
    "the speed of the falling frame": (impacts_of, "fall_speed", lambda v, half, t: v),
    "gravity twice in the speed": (impacts_of, "fall_speed", lambda v, half, t: v + (half + half + half + half) * t),
    "no loss at a bounce": (growth, "damped", lambda before, after, share: after),
}
PEG_FAULTS = [name for name in FALL_FAULTS if name.endswith("at a bounce") and "loss" not in name]


@pytest.mark.parametrize("fault", FALL_FAULTS)
def test_a_map_with_a_planted_fault_is_not_the_difference(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(*FALL_FAULTS[fault])
    _, exact, mapped = difference(FALLING, 12, coordinate=1)
    assert np.abs(mapped - exact).max() > 1e-3 * np.abs(exact).max()


@pytest.mark.parametrize("fault", PEG_FAULTS)
def test_nor_is_one_onto_pegs_alone(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """On this board nothing but pegs is met so soon: no wall takes the blame."""
    scene = catalogue.build("galton:e=1").with_changes(until=None)
    run, exact, mapped = difference(scene, 4, index=moving(scene)[0])
    assert all(scene.circles[k].fixed for event in impacts(run, 4) for hit in event for k in (hit.b,) if k is not None)
    assert np.abs(mapped - exact).max() <= 1e-9 * np.abs(exact).max()
    monkeypatch.setattr(*FALL_FAULTS[fault])
    _, exact, mapped = difference(scene, 4, index=moving(scene)[0])
    assert np.abs(mapped - exact).max() > 1e-3 * np.abs(exact).max()


def test_what_stands_second_is_as_what_stands_first() -> None:
    """A contact names the lower number first, whether it falls or stands: the sign of gravity goes by which it is."""
    ball, peg = Circle("1/3", 5, vx="1/9", id="ball"), Circle(0, 0, m="oo", id="peg")
    told = []
    for circles in ([ball, peg], [peg, ball]):
        scene = Scene(circles, gravity=(0, -10))
        told.append(difference(scene, 2, index=circles.index(ball))[1:])
    assert np.array_equal(told[0][0], told[1][0])
    assert np.allclose(told[0][1], told[1][1], rtol=1e-12)


@pytest.mark.parametrize("text", ["wedge:slope=2", "falling-line", "gas-under-gravity", "axis"])
def test_a_run_of_floats_under_gravity_has_the_same_impacts(text: str) -> None:
    scene = catalogue.build(text).with_changes(restitution="9/10")
    exact, told = (impacts(engine.run(scene, events=10), 10) for engine in (ExactEngine(), DoubleEngine()))
    for one, other in zip(exact, told, strict=True):
        for a, b in zip(one, other, strict=True):
            sign = 1.0 if a.b is not None or float(a.dx) * b.dx + float(a.dy) * b.dy > 0 else -1.0
            numbers = [float(a.dx), float(a.dy), float(a.vx), float(a.vy), float(a.reach)]
            assert numbers == pytest.approx([sign * b.dx, sign * b.dy, b.vx, b.vy, b.reach], rel=1e-9, abs=1e-9)


def test_certified_growth_encloses_what_doubles_measure_under_gravity() -> None:
    for scene in (FALLING, catalogue.build("wedge:slope=2")):
        run = ExactEngine().run(scene, events=40)
        found, rough = certified_growth(run, 40), error_growth(run, 40)
        assert rough is not None and found.high - found.low < 0.1
        assert found.low - 1e-6 <= 40 * rough <= found.high + 1e-6


def test_what_has_no_map_under_gravity_is_refused_by_name() -> None:
    walls = [Wall(0, 5, 1, 5, id="top"), Wall(9, 0, 9, 1, id="right"), Wall(0, -9, 1, -9)]
    run = ExactEngine().run(Scene([Circle(0, -4, vx=1, vy=4)], walls, gravity=(0, -1)), events=2)
    assert len(run.events) == 2
    with pytest.raises(NoTangentMap, match="before event 0, c1 and top graze"):  # up by 4**2 / 2, to the ceiling
        impacts(run, 2)


@pytest.mark.parametrize(("r", "events"), [("1", 1), ("99/100", None), ("101/100", None)])
@pytest.mark.parametrize("thing", ["a circle", "a ring"])
def test_a_graze_under_gravity_has_no_tangent_map(r, events, thing):
    """A ball rises to 5 at the time 1, and there just touches something round of radius r, or does not."""
    ball, beside = Circle(0, 0, 1, 0, 10, id="ball"), Circle(30, 0, 1, vy=3, id="beside")
    circles, arcs = [ball, beside], [Arc(0, 7, r, id="thing", full=True)]
    if thing == "a circle":
        circles, arcs = [*circles, Circle(0, 7, r, m="oo", id="thing")], []
    scene = Scene(circles, [Wall(0, -2, 1, -2, id="floor")], arcs=arcs, gravity=(0, -10))
    run = ExactEngine().run(scene, events=3)
    found = first_graze(run, run.motion, 3)
    assert found == (None if events is None else Graze(events, "ball", "thing"))
    if events is None:
        assert len([*impacts(run, 3)]) >= 3
    else:
        with pytest.raises(NoTangentMap, match="ball and thing graze: nearby they hit or miss"):
            [*impacts(run, 3)]


def test_a_long_run_carried_in_sets_has_its_growth_with_the_bits_that_it_lost() -> None:
    """Displacements as balls lose less than the run's own numbers do: no second attempt is needed."""
    run = ExactEngine().run(catalogue.build("stadium"), events=6000)
    log = motion_of(run).log  # pyright: ignore[reportOptionalMemberAccess]
    assert log.centred
    told = certified_growth(run, 6000)
    assert told.bits == log.lost + LEAST_BITS
    assert told.high - told.low < 1e-9
    assert log.lost > told.high > 0.9 * log.lost


@pytest.mark.parametrize("seed", range(8))
def test_rows_of_balls_are_carried_by_the_matrix_of_the_same_map(seed: int) -> None:
    draw = Random(seed)
    with ball.precision(200):
        dx, dy, vx, vy, wa, wb = (arb(draw.randint(1, 50)) / 7 for _ in range(6))
        reach = (dx * dx + dy * dy).sqrt()
        rows = [arb_mat([[arb(draw.randint(-50, 50)) / 3 for _ in range(2)]]) for _ in range(4)]
        told = growth._by_blocks(dx, dy, vx, vy, reach, wa, wb, *rows)
        for column in range(2):
            wanted = pair_tangent(dx, dy, vx, vy, reach, wa, wb, *(row[0, column] for row in rows))
            assert all(abs(a[0, column] - b) < arb(2) ** -150 for a, b in zip(told, wanted, strict=True))
