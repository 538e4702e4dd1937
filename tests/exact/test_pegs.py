"""Fixed circles under gravity, in the exact engine: against a referee in true coordinates, and what ends by name."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from counted import calls
from flint import fmpq, fmpq_poly
from mpmath import mpf, polyroots, workdps
from peg_referee import NotForThis, PegReferee, TieMet

from truebreak.exact import ExactEngine
from truebreak.exact.literal import symbolic_contacts, symbolic_engine
from truebreak.exact.literal.symbolic_engine import SymbolicEngine
from truebreak.exact.replay import landings, round_falls, state
from truebreak.floating import DoubleEngine, PymunkEngine, QuadEngine, RoundedEngine, SingleEngine
from truebreak.scenarios import Arc, Circle, Pocket, Quantity, Scene, SceneError, Segment, Trajectory, Wall, catalogue
from truebreak.scenarios.errors import NoClosedForm
from truebreak.scenarios.trajectory import StopReason, TieProof

FLOOR = Wall(0, -2, 1, -2, id="floor")
SIDES = [Wall(-6, 0, -6, 1, id="left"), Wall(6, 0, 6, 1, id="right")]


def drawn(seed: int) -> Scene:
    """One to three discs, as many as six pegs, walls."""
    rng = random.Random(seed)

    def some(low: int, high: int) -> str:
        return f"{rng.randint(low * 100, high * 100)}/100"

    def radius() -> str:
        return rng.choice(["1/2", "1/4", "3/10", "sqrt(2)/4"])

    while True:
        circles: list[Circle] = [
            Circle(some(-4, 4), some(1, 8), radius(), some(-4, 4), some(-4, 4), rng.choice([1, 2, "1/3"]), id=f"b{k}")
            for k in range(rng.randint(1, 3))
        ]
        for k in range(rng.randint(1, 6)):
            r = rng.choice([radius(), "1/10", "0", "1"])
            x, y = some(-4, 4), some(0, 5)
            circles.append(Circle(x, y, r, m="oo", id=f"p{k}", point=r == "0"))
        rng.shuffle(circles)
        walls = [*SIDES, FLOOR] if rng.random() < 0.8 else SIDES
        gravity = rng.choice([(0, -10), (0, "-981/100"), ("1/3", -4), ("sqrt(2)", -3)])
        try:
            return Scene(circles, walls, gravity=gravity, restitution=rng.choice([1, "9/10", "1/2"]))
        except SceneError:
            continue


def pairs_of(run: Trajectory, k: int) -> list[list[str]]:
    """Who meets at an event."""
    return sorted(sorted((c.first, c.second)) for c in run.events[k].contacts)


def differs(scene: Scene, events: int) -> str | None:
    """What is otherwise than the referee has it; empty where all is as it has it, None where it has nothing."""
    run = ExactEngine(max_bits=2000, work=1_000_000).run(scene, events=events)
    try:
        course = PegReferee(scene).run(mpf(10) ** 9, len(run.events))
    except (TieMet, NotForThis):
        return None
    with workdps(60):
        if len(course.hits) != len(run.events):
            return "number of events"
        for k, (hit, event) in enumerate(zip(course.hits, run.events, strict=True)):
            if pairs_of(run, k) != [sorted(hit.pair)]:
                return f"who meets at event {k}"
            if abs(mpf(event.time.digits(40)) - hit.time) > mpf(10) ** -30 * (1 + hit.time):
                return f"time of event {k}"
        if run.events:
            at = run.at(run.events[-1].time)
            for body, circle in zip(course.bodies, [c for c in scene.circles if not c.fixed], strict=True):
                mine = at[str(circle.id)]
                theirs = (body.x, body.y, body.vx, body.vy)
                for own, other in zip((mine.x, mine.y, mine.vx, mine.vy), theirs, strict=True):
                    if abs(mpf(own.digits(40)) - other) > mpf(10) ** -25 * (1 + abs(other)):
                        return f"state of {circle.id}"
    return ""


@pytest.mark.parametrize("seed", range(8))
def test_the_history_is_that_of_the_referee(seed: int) -> None:
    assert differs(drawn(seed), 20) == ""


@pytest.mark.slow
@pytest.mark.parametrize("block", range(20))
def test_many_histories_are_those_of_the_referee(block: int) -> None:
    found = Counter(differs(drawn(1000 + 50 * block + k), 30) for k in range(50))
    assert set(found) <= {"", None}
    assert found[""] > 40


# -- Planted faults: each is found.


def light(self: Any, *of: Any) -> Any:
    """Gravity is half of what it is."""
    found = FALL(self, *of)
    return found._replace(hx=found.hx / 2, hy=found.hy / 2)


def other_side(self: Any, *of: Any) -> Any:
    """Velocity along x has the other sign."""
    found = SOUND(self, *of)
    return found._replace(vx=-found.vx)


def whole_impulse(dx: Any, dy: Any, vx: Any, vy: Any, *rest: Any) -> Any:
    """Impulses are an eighth too large."""
    jx, jy = IMPULSE(dx, dy, vx, vy, *rest)
    return jx + jx / 8, jy + jy / 8


SOUND, IMPULSE = round_falls.RoundFalls.peg_relation, state.pair_impulse
FALL = round_falls.RoundFalls.peg_fall_at_clock


@pytest.mark.parametrize(
    ("where", "name", "fault"),
    [
        (round_falls.RoundFalls, "peg_fall_at_clock", light),
        (round_falls.RoundFalls, "peg_relation", other_side),
        (state, "pair_impulse", whole_impulse),
    ],
)
def test_the_referee_finds_planted_faults(
    monkeypatch: pytest.MonkeyPatch, where: Any, name: str, fault: Callable[..., Any]
) -> None:
    monkeypatch.setattr(where, name, fault)

    def is_found(seed: int) -> bool:
        try:
            return differs(drawn(seed), 6) not in ("", None)
        except AssertionError:
            return True

    assert any(is_found(seed) for seed in range(4))


# -- What is proved, and what ends by name.


def test_mirrored_balls_meet_their_pegs_at_the_same_instants() -> None:
    balls = [Circle(s + "7/5", 8, "1/4", id=f"ball{s}") for s in ("-", "")]
    pegs = [
        Circle(f"{s}{x}", y, "1/4", m="oo", id=f"peg{s}{x}at{y}")
        for y, row in ((6, ("3/2",)), (4, ("1/2", "2")), (2, ("3/2",)))
        for x in row
        for s in ("-", "")
    ]
    run = ExactEngine().run(Scene([*balls, *pegs], [FLOOR, *SIDES], gravity=(0, -10), restitution="4/5"), events=6)
    assert run.stop.reason is StopReason.EVENTS
    assert run.plan["symmetry"] >= 3
    met = Counter((event.time.digits(50), contact.second) for event in run.events for contact in event.contacts)
    alone = [(time, who) for time, who in met if who != "ball" and (time, mirrored(who)) not in met]
    assert not alone
    assert sum("peg" in who for _, who in met) >= 4


def mirrored(name: str) -> str:
    """The peg or wall on the other side; the floor is on both."""
    sides = {"left": "right", "right": "left", "floor": "floor"}
    return sides.get(name) or (name.replace("-", "") if "-" in name else name.replace("peg", "peg-"))


def test_a_ball_on_the_axis_of_a_peg_stays_on_it() -> None:
    scene = Scene([Circle(0, 4, "1/2", id="ball"), Circle(0, 0, "1/2", m="oo")], gravity=(0, -10))
    run = ExactEngine().run(scene, events=60)
    assert run.stop.reason is StopReason.EVENTS
    with workdps(60):
        first = mpf(run.events[0].time.digits(45))
        assert all(
            abs(mpf(event.time.digits(45)) - (2 * k + 1) * first) < mpf(10) ** -40 for k, event in enumerate(run.events)
        )
    assert run.at(run.events[-1].time)["ball"].x.digits(20) == "0"


def test_a_ball_beside_the_axis_leaves_it_soon() -> None:
    near = Scene([Circle(f"1/{2**40}", 4, "1/2", id="ball"), Circle(0, 0, "1/2", m="oo")], gravity=(0, -10))
    run = ExactEngine().run(near, events=60)
    assert run.stop.reason is StopReason.QUIET
    assert 8 < len(run.events) < 30


def touched(d: tuple[str, str], v: tuple[str, str], *more: Circle) -> Trajectory:
    """A ball that touches a peg of half its size about 0, 1 away, as time begins; g = 1."""
    ball = Circle(*d, "2/3", vx=v[0], vy=v[1], id="ball")
    scene = Scene([ball, Circle(0, 0, "1/3", m="oo", id="peg"), *more], gravity=(0, -1))
    return ExactEngine().run(scene, until=5)


@pytest.mark.parametrize(
    ("d", "v"),
    [
        (("0", "1"), ("2", "0")),  # c2 > 0: faster than what falls along the peg
        (("0", "1"), ("-1", "0")),  # as fast: c2 = c3 = 0, c4 > 0
        (("3/5", "4/5"), ("4/5*sqrt(4/5)", "-3/5*sqrt(4/5)")),  # c2 = 0, downwards: c3 > 0
        (("0", "-1"), ("0", "0")),  # let fall from below
        (("4/5", "-3/5"), ("0", "0")),
        (("1", "0"), ("0", "1")),  # up beside it, and down again, which is a graze
    ],
)
def test_what_touches_a_peg_flies_off_where_it_bends_less_than_the_peg(d, v) -> None:
    run = touched(d, v)
    assert (run.stop.reason, len(run.events)) == (StopReason.HORIZON, 0)
    x, y, vx, vy = (Quantity.of(number) for number in (*d, *v))
    final = [Quantity.of(number.text()) for number in (run.final["ball"].x, run.final["ball"].y)]
    assert final == [x + vx * 5, y + vy * 5 - Quantity.of("25/2")]


@pytest.mark.parametrize(
    ("d", "v", "slides"),
    [
        (("0", "1"), ("0", "0"), False),
        (("0", "1"), ("1/2", "0"), True),
        (("3/5", "4/5"), ("0", "0"), True),
        (("3/5", "4/5"), ("-4/5*sqrt(4/5)", "3/5*sqrt(4/5)"), True),  # c2 = 0, upwards: c3 < 0
    ],
)
def test_what_presses_on_a_peg_rests_by_name(d, v, slides) -> None:
    stop = touched(d, v).stop
    told = "at rest: a circle stands on what gravity pulls it to: ball and peg"
    assert stop.reason is StopReason.REST
    assert stop.message == told + ", something round, along which it slides" * slides


def test_who_is_held_by_two_pegs_is_undecided_and_says_which_and_why() -> None:
    stop = touched(("3/5", "4/5"), ("0", "0"), Circle("6/5", 0, "1/3", m="oo", id="other")).stop
    assert stop.reason is StopReason.UNDECIDED
    assert "ball and peg touch, and neither approach nor part, under gravity" in stop.message


def first_fall(ball: Circle, pegs: list[Circle], pull: tuple[Fraction, Fraction]) -> tuple[int, mpf] | None:
    """Which peg the ball hits first, and when, by mpmath's zeros of gaps in fractions, less those at time 0; None: no
    one. The first is -1 where it presses on one as time begins."""
    found: list[tuple[mpf, int]] = []
    for k, peg in enumerate(pegs):
        d, v = [
            [Fraction(str(part)) for part in pair] for pair in ((ball.x - peg.x, ball.y - peg.y), (ball.vx, ball.vy))
        ]
        reach = Fraction(str(ball.r + peg.r))
        gap = [Fraction(0)] * 5
        for x, u, g in zip(d, v, pull, strict=True):  # (x + u t + g t^2 / 2)^2
            for n, term in enumerate((x * x, 2 * x * u, u * u + x * g, u * g, g * g / 4)):
                gap[n] += term
        gap[0] -= reach * reach
        while gap[0] == 0:
            gap.pop(0)
        if gap[0] < 0:
            return -1, mpf(0)
        with workdps(60):
            zeros = polyroots([mpf(c.numerator) / c.denominator for c in reversed(gap)], maxsteps=500, extraprec=500)
            real = sorted(z.real for z in zeros if abs(z.imag) < mpf(10) ** -40 and z.real > mpf(10) ** -40)
        found += [(zero, k) for zero in real[:1]]
    return min(found)[::-1] if found else None


def test_what_comes_next_after_a_touch_is_what_zeros_in_fractions_say() -> None:
    rng, kinds = random.Random(36), Counter[str]()
    turns = [
        (Fraction(a, c), Fraction(b, c)) for a, b, c in ((3, 4, 5), (-5, 12, 13), (0, 1, 1), (1, 0, 1), (8, -15, 17))
    ]
    for _ in range(120):
        (nx, ny), speed = rng.choice(turns), Fraction(rng.randint(-6, 6), 4)
        pull = Fraction(rng.randint(-2, 2)), Fraction(-rng.randint(1, 3))
        ball = Circle(nx, ny, "1/2", vx=-ny * speed, vy=nx * speed, id="ball")
        pegs, taken = [Circle(0, 0, "1/2", m="oo")], [(Fraction(0), Fraction(0)), (nx, ny)]
        while len(pegs) < 4:
            x, y = (Fraction(rng.randint(-12, 12), 4) for _ in "xy")
            if all((x - a) ** 2 + (y - b) ** 2 > 1 for a, b in taken):
                pegs.append(Circle(x, y, "1/4", m="oo"))
                taken.append((x, y))
        known = first_fall(ball, pegs, pull)
        run = ExactEngine().run(Scene([ball, *pegs], gravity=pull), events=1)
        if known is None:
            assert run.stop.reason is StopReason.QUIET
            assert not run.events
        elif known[0] < 0:
            assert run.stop.reason is StopReason.REST
        else:
            assert run.events[0].contacts[0].second == run.scene.ids[known[0] + 1]
            with workdps(60):
                assert abs(mpf(run.events[0].time.digits(40)) - known[1]) < mpf(10) ** -36 * (1 + known[1])
        kinds["none" if known is None else "presses" if known[0] < 0 else "same" if not known[0] else "other"] += 1
    assert min(kinds[kind] for kind in ("none", "presses", "same", "other")) >= 2


def beside(x: str) -> Scene:
    """A ball that falls from (0, 4) beside a peg at (x, 1), 1 and a quarter away at a hit, onto a floor."""
    peg = Circle(x, 1, "1/4", m="oo", id="peg")
    return Scene([Circle(0, 4, id="ball"), peg], [Wall(0, -9, 1, -9, id="floor")], gravity=(0, -2))


@pytest.mark.parametrize(
    ("x", "time"),
    [
        ("3/4", "sqrt(2)"),  # the gap, (3 - t^2)^2 - 1, has factors of second degree
        ("-3/4", "sqrt(2)"),
        ("1", "3/2"),  # (3 - t^2)^2 - 9/16
        ("1/3", None),  # (3 - t^2)^2 = 209/144: of no such factors
    ],
)
def test_a_zero_of_a_quartic_with_factors_is_closed(x: str, time: str | None) -> None:
    run = ExactEngine().run(beside(x), events=3)
    assert tuple(run.events[0].contacts[0]) == ("ball", "peg")
    if time is None:
        with pytest.raises(NoClosedForm):
            run.events[0].time.sympy()
        return
    assert Quantity.of(run.events[0].time.text()) == Quantity.of(time)
    assert run.plan["bits"] == 256


def test_what_comes_exactly_at_a_limit_after_such_a_zero_is_told() -> None:
    first = ExactEngine().run(beside("1"), events=2)
    assert first.events[1].time.text() is not None
    second = Quantity.of(first.events[1].time.text())
    at = ExactEngine().run(beside("1"), until=second)
    assert len(at.events) == 2
    assert len(ExactEngine().run(beside("1"), until=second - Quantity.of("1/10**60")).events) == 1


def passing(off: str) -> Scene:
    """A ball whose way has its top below a peg, which it grazes there; the peg is so much higher."""
    peg = Circle(1, f"3/2+({off})", "1/2", m="oo", id="peg")
    return Scene([Circle(0, 0, "1/2", vx=1, vy=1, id="ball"), peg], gravity=(0, -1))


def test_a_graze_is_told_by_factors_where_coefficients_are_fractions() -> None:
    counts = [len(ExactEngine(max_bits=2000).run(passing(o), events=5).events) for o in ("0", "10**-30", "-10**-30")]
    assert counts == [0, 0, 1]
    run = ExactEngine(max_bits=2000).run(passing("0"), events=5)
    assert run.stop.reason is StopReason.QUIET


def test_a_graze_of_other_numbers_is_undecided_and_says_why() -> None:
    scene = passing("0")
    root = Quantity.of("sqrt(2)")
    wide = [Circle(c.x * root, c.y * root, c.r * root, c.vx * root, c.vy * root, c.m, id=c.id) for c in scene.circles]
    run = ExactEngine(max_bits=2000).run(Scene(wide, gravity=(0, -root)), events=5)
    assert run.stop.reason is StopReason.UNDECIDED
    assert "ball and peg hit, graze or miss" in run.stop.message
    assert "zero of a quartic, which no field holds" in run.stop.message


def test_what_approaches_and_pushes_nothing_is_no_part_of_a_past() -> None:
    """`idle` is outrun at time 0 by what `hit` pushes: whatever asked for that one's past fell over `idle`."""
    ball, hit = Circle(0, 0, id="ball"), Circle(0, -2, vy=2, id="hit")
    idle, far = Circle("-48/25", "-14/25", vx="1/10", id="idle"), Circle("1/2", 3, id="far")
    peg = Circle(9, 9, 1, m="oo", id="peg")
    run = ExactEngine().run(Scene([ball, hit, idle, far, peg], gravity=(0, -1)), until=1)
    assert [event.contacts for event in run.events] == [(("ball", "hit"), ("ball", "idle")), (("ball", "far"),)]
    assert run.events[0].impulses == (("ball", "hit"),)
    assert run.final["ball"].y.text() == "-15/32*sqrt(15) + 39/16"


@pytest.mark.parametrize("restitution", ["1", "1/2"])
def test_a_graze_at_the_instant_of_a_blow_is_no_event_without_its_pushes(restitution: str) -> None:
    """A ball over the top of a peg, struck there from above: the blow was noted, and not what it leads to."""
    peg, ball = Circle(0, 0, 1, m="oo", id="peg"), Circle(-2, "3/2", 1, vx=2, vy=1, id="ball")

    def run(*others: Circle) -> Trajectory:
        return ExactEngine().run(Scene([peg, ball, *others], gravity=(0, -1), restitution=restitution), until=2)

    assert run().stop.reason is StopReason.HORIZON
    struck = run(Circle(0, "13/2", 1, vy=-2, id="other"))
    assert [tuple(pair) for pair in struck.events[0].impulses][:3] == [
        ("ball", "other"),
        ("peg", "ball"),
        ("ball", "other"),
    ]
    for near in ("13/2 + 10**-12", "13/2 - 10**-12"):  # where the pushes come one after the other
        beside = run(Circle(0, near, 1, vy=-2, id="other"))
        for mine, theirs in zip(struck.final.circles, beside.final.circles, strict=True):
            assert float(mine.vx) == pytest.approx(float(theirs.vx), abs=1e-9)
            assert float(mine.vy) == pytest.approx(float(theirs.vy), abs=1e-9)
    later, sooner = (run(Circle(0, height, 1, vy=-2, id="other")) for height in ("6501/1000", "6499/1000"))
    assert [event.contacts[0] for event in later.events[:2]] == [("ball", "other"), ("peg", "ball")]
    assert [event.contacts[0] for event in sooner.events[:2]] == [("ball", "other"), ("peg", "ball")]


def test_a_graze_at_the_instant_of_a_blow_takes_part_in_it_where_flights_are_straight() -> None:
    """A bar that moves strikes a disc that grazes an arc then: they push each other without end."""
    disc = Circle("12/5", "-9/5", vx="-12/5", vy="9/5", id="disc")
    bar = Segment("-33/50", "-69/50", "-93/50", "-149/50", r="1/10", vy="1/2", id="bar")
    bow = Arc("9/5", "12/5", 2, "17/5", "18/5", "67/65", "36/65", id="bow")
    run = ExactEngine().run(Scene([disc], segments=[bar], arcs=[bow], restitution="1/2"), until=2)
    assert run.events == ()
    assert "collapse: disc and bar as well as disc and bow" in run.stop.message


def at_once(off: str, kind: str) -> Scene:
    """A ball that falls onto the top of a peg by 3 in sqrt(3); another that meets something then, or a little later."""
    circles = [Circle(0, 4, "1/2", id="A"), Circle(0, 0, "1/2", m="oo", id="p")]
    if kind == "wall":
        circles.append(Circle(10, f"5/2+({off})", "1/2", vx=1, id="B"))
    else:  # beside the top of another
        circles += [Circle(10, f"19/5+({off})", "1/2", id="B"), Circle("10-3/5", 0, "1/2", m="oo", id="q")]
    return Scene(circles, [Wall(0, -1, 1, -1, id="floor")], gravity=(0, -2))


@pytest.mark.parametrize("kind", ["wall", "peg"])
def test_a_tie_of_zeros_of_fractions_is_told_by_their_common_divisor(kind: str) -> None:
    runs = {off: ExactEngine(max_bits=2000).run(at_once(off, kind), events=1) for off in ("0", "10**-30", "-10**-30")}
    other = {"wall": ("B", "floor"), "peg": ("B", "q")}[kind]
    assert [[*map(tuple, run.events[0].contacts)] for run in runs.values()] == [
        [("A", "p"), other], [("A", "p")], [other]
    ]  # fmt: skip
    (tie,) = runs["0"].events[0].ties
    assert tie.proof is TieProof.RATIONAL
    with workdps(40):
        assert abs(mpf(runs["0"].events[0].time.digits(35)) ** 2 - 3) < mpf(10) ** -30


def test_a_horizon_at_a_zero_of_fractions_is_told() -> None:
    ball = [Circle(0, 5, "1/2", id="A"), Circle(0, 0, "1/2", m="oo", id="p")]
    scene = Scene(ball, gravity=(0, -2))
    assert [len(ExactEngine(max_bits=2000).run(scene, until=t).events) for t in ("2", "2-10**-30")] == [1, 0]


def drawn_zeros(rng: random.Random) -> tuple[list[int], fmpq_poly]:
    """Squares of zeros, and a polynomial that has their square roots, times a fraction, and one positive zero each."""
    squares = rng.sample(range(1, 9), rng.randint(1, 2))
    poly = fmpq_poly([rng.randint(1, 9)])
    for square in squares:
        poly *= fmpq_poly([-square, 0, 1])
    return squares, poly * fmpq_poly([rng.randint(1, 5), 1])


def test_common_divisors_order_zeros_as_they_are() -> None:
    """Square roots of whole numbers, as far apart as they are, or the same; a shared zero elsewhere is none."""
    rng, met = random.Random(7), Counter[tuple[int, bool]]()
    for _ in range(400):
        (mine, one), (theirs, two) = drawn_zeros(rng), drawn_zeros(rng)
        a, b = rng.choice(mine), rng.choice(theirs)
        ends = [
            (fmpq(int(10**3 * square**0.5) - 3, 10**3), fmpq(int(10**3 * square**0.5) + 5, 10**3)) for square in (a, b)
        ]
        found = landings.order_exactly(landings.ExactMoment(one, *ends[0]), landings.ExactMoment(two, *ends[1]))
        assert found == (a > b) - (a < b)
        met[found, one.gcd(two).degree() > 0] += 1
    assert all(met[sign, shared] > 5 for sign in (-1, 1) for shared in (True, False))
    assert met[0, True] > 5


def test_a_tie_without_proof_is_undecided_and_says_why() -> None:
    balls = [Circle(0, 5, "1/2", id="one"), Circle(4, 6, "1/2", vy=0, id="two")]
    pegs = [Circle("1/4", 0, "1/2", m="oo", id="p"), Circle("15/4", 1, "1/2", m="oo", id="q")]
    mirrored = Scene([*balls, *pegs], gravity=(0, -10))
    run = ExactEngine(max_bits=4000).run(mirrored, events=1)
    assert run.stop.reason is StopReason.EVENTS  # the glide from one to the other proves it
    turned = [Circle(4, 6, "1/2", vy="1/7", id="two"), Circle("15/4", "1", "1/2", m="oo", id="q")]
    run = ExactEngine(max_bits=4000).run(Scene([balls[0], pegs[0], *turned], gravity=(0, -10)), events=1)
    assert run.stop.reason is StopReason.EVENTS


def test_numbers_after_a_quartic_have_digits_and_a_definition_and_no_closed_form() -> None:
    scene = Scene([Circle(0, 6, "1/2", id="ball"), Circle("1/3", 3, "1/2", m="oo")], [FLOOR], gravity=(0, -10))
    run = ExactEngine().run(scene, events=4)
    time = run.events[2].time
    assert time.ball(500).rel_accuracy_bits() >= 500
    assert time.digits(60).startswith(time.digits(30)[:28])
    assert time.normal_form() is None
    assert "zero(" in time.text()
    with pytest.raises(NoClosedForm, match="zero of a quartic"):
        time.sympy()


def test_two_bits_may_leave_it_open_and_are_never_wrong() -> None:
    scene = drawn(3)
    sharp = ExactEngine().run(scene, events=20)
    for bits in (256, 300, 1000):
        run = ExactEngine(max_bits=bits).run(scene, events=20)
        assert [e.contacts for e in run.events] == [e.contacts for e in sharp.events[: len(run.events)]]


def test_finite_precision_has_the_same_first_events() -> None:
    scene = drawn(2)
    exact = ExactEngine().run(scene, events=6)
    for engine in (DoubleEngine(), SingleEngine(), QuadEngine(), RoundedEngine(bits=30), PymunkEngine(dt=1 / 4096)):
        run = engine.run(scene, events=6)
        assert [e.contacts for e in run.events[:3]] == [e.contacts for e in exact.events[:3]], engine.name
        place = run.sample([float(exact.events[0].time) / 2])[0]
        assert abs(place - exact.sample([float(exact.events[0].time) / 2])[0]).max() < 0.01


def beside_sympy(scene: Scene, events: int = 4) -> tuple[int, str]:
    """How many events SymPy's engine has as the exact one has them, and what it says of the end."""
    run, exact = SymbolicEngine().run(scene, events=events), ExactEngine().run(scene, events=8)
    count = len(run.events)
    assert [e.contacts for e in run.events] == [e.contacts for e in exact.events[:count]]
    for mine, theirs in zip(run.events, exact.events, strict=False):
        assert abs(float(mine.time) - float(theirs.time)) < 1e-12
    if "quartic" in run.stop.message:
        assert run.stop.reason is StopReason.UNDECIDED
        things = (*(c for c in scene.circles if c.fixed), *scene.segments, *scene.polygons, *scene.arcs)
        fixed = {str(thing.id) for thing in things}
        assert count == len(exact.events) or not fixed.isdisjoint(exact.events[count].contacts[0])
        return count, "quartic"
    assert count == min(events, len(exact.events))
    return count, run.stop.reason.name


def test_sympy_goes_to_its_first_quartic_and_says_so() -> None:
    found = [beside_sympy(drawn(seed)) for seed in range(10)]
    assert sum(end == "quartic" for _, end in found) >= 3
    assert sum(count for count, _ in found) >= 20
    peg = Circle(0, 3, m="oo", id="peg")
    run = SymbolicEngine().run(Scene([Circle(0, 6, id="ball"), peg], gravity=(0, -10)))
    assert run.stop.reason is StopReason.UNDECIDED
    assert "whether and when ball falls onto peg is told by a zero of a quartic" in run.stop.message
    beside = Scene([Circle("2001/1000", 6, id="ball"), peg], [Wall(0, 0, 1, 0, id="floor")], gravity=(0, -10))
    run = SymbolicEngine().run(beside, events=3)
    assert [event.time.text() for event in run.events] == ["1", "3", "5"]
    assert run.sample([1.0, 4.0])[:, 1].tolist() == [[0.0, 3.0, 0.0, 0.0]] * 2
    assert run.at(2)["peg"].y.text() == "3"


def test_without_that_look_sympy_flies_through(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(symbolic_engine, "_refuse_quartics", lambda *_: None)
    with pytest.raises(AssertionError):
        for seed in range(10):
            beside_sympy(drawn(seed))


def test_sympy_falls_onto_faces_and_goes_to_the_first_fall_onto_something_round() -> None:
    """Faces are met at zeros of quadratics; that no end and no arc comes before is proved at each instant."""
    ends: Counter[str] = Counter()
    for spec in ("ski-jump", "paddle", "bowl", "galton:rows=2"):
        ends[beside_sympy(catalogue.build(spec), 2)[1]] += 1
    assert ends == {"EVENTS": 2, "quartic": 2}


@pytest.mark.parametrize("fault", ["range", "thickness", "pull along the face"])
def test_faults_of_faces_that_fall_are_found(monkeypatch: pytest.MonkeyPatch, fault: str) -> None:
    """A range looked at as if nothing fell, a face without its thickness, a fall along an oblique face left out."""
    beside, times = symbolic_contacts.Bar.beside, symbolic_contacts.fall_times
    if fault == "range":
        monkeypatch.setattr(symbolic_contacts.Bar, "beside", lambda bar, a, time, g=None: beside(bar, a, time))
    elif fault == "thickness":
        monkeypatch.setattr(
            symbolic_engine, "fall_times", lambda a, b, g: times(replace(a, r=a.r - getattr(b, "r", 0)), b, g)
        )
    else:
        monkeypatch.setattr(symbolic_engine, "fall_times", lambda a, b, g: times(a, b, (g[0] * 0, g[1])))
    post, bar = Segment(2, -3, 2, 0, id="post"), Segment(-3, -1, 3, 1, id="bar", r="1/4")
    with pytest.raises(AssertionError):
        beside_sympy(Scene([Circle(0, 1, "1/4", vx=1)], segments=[post], gravity=(0, -1)), 1)
        beside_sympy(Scene([Circle("-1", 4, "1/2", vx="1/2")], segments=[bar], gravity=("1/2", -1)), 1)


def test_a_point_that_bounces_twice_on_one_wall_is_on_the_side_from_which_it_came() -> None:
    """A flight from a wall to the same wall: neither of its ends tells the side."""
    point = Circle(0, 1, 0, vx=1, point=True)
    for thing in ({"walls": [Wall(0, 0, 1, 0, id="floor")]}, {"segments": [Segment(-1, 0, 9, 0, id="floor")]}):
        run = SymbolicEngine().run(Scene([point], **thing, gravity=(0, -2)), events=3)
        assert [event.time.text() for event in run.events] == ["1", "3", "5"]


def test_no_run_is_turned_back_where_a_circle_stands_under_gravity() -> None:
    with pytest.raises(SceneError, match="circle 'peg' is fixed, and no run is turned back there; leave"):
        Scene([Circle(0, 6), Circle(0, 3, m="oo", id="peg")], gravity=(0, -10), reverse_at=3)


def test_bounces_that_shrink_on_a_peg_end_as_suspected_and_not_for_want_of_bits() -> None:
    """On its axis each comes back after half of the time; 2**-20 of the first is less than is waited for."""
    peg = Circle(0, 0, r="1/2", fixed=True, id="peg")
    scene = Scene([Circle("1/10**9", 5, r="1/2", id="ball"), peg], [], gravity=(0, -10), restitution="1/2", events=400)
    run = ExactEngine().run(scene)
    assert run.stop.reason is StopReason.UNDECIDED
    assert "accumulation suspected: ball and peg" in run.stop.message
    times = [float(event.time) for event in run.events]
    assert 20 <= len(times) <= 23
    assert (times[1] - times[0]) / 2**18 > times[-1] - times[-2] > 0


def test_a_board_of_more_pegs_costs_no_more_a_peg() -> None:
    """The first prediction of a board, in counted calls: its pegs are not looked at in pairs."""
    small, large = (catalogue.build(f"galton:rows={rows}") for rows in (10, 20))
    for scene in (small, large):
        ExactEngine().run(scene, events=1)  # what a scene keeps of itself
    few, many = (calls(lambda scene=scene: ExactEngine().run(scene, events=1)) for scene in (small, large))
    assert many / few < len(large.circles) / len(small.circles)


@pytest.mark.parametrize("capture", [False, True])
def test_what_enters_a_pocket_as_another_touches_it_is_at_the_instant_already(capture: bool) -> None:
    """The other has come to a wall by then and is sent back: it pushes nothing. That ended as an internal error."""
    discs = [Circle(1, -1, 1, id="ball"), Circle("13/4", -2, "1/4", vx=-1, vy=1, id="other")]
    walls = [Wall(0, -3, 1, -3, id="floor"), Wall(2, 0, 2, 1, id="side")]
    scene = Scene(discs, walls, pockets=[Pocket(1, "-5/2", 1, id="hole")], gravity=(0, -1), capture=capture)
    run = ExactEngine().run(scene, until=2)
    assert [(entry.circle, float(entry.time)) for entry in run.pocketings] == [("ball", 1.0)]
    assert [tuple(pair) for pair in run.events[0].impulses] == [("other", "side")]
    assert run.stop.reason is (StopReason.HORIZON if capture else StopReason.UNDECIDED)
