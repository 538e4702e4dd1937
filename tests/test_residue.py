"""Laws of residues: a true zero is a zero with a bound, what is not zero is not, and doubt is said aloud."""

from __future__ import annotations

import doctest
import random
from collections.abc import Callable, Sequence

import pytest
from flint import fmpq, fmpz

from truebreak.exact import (
    ExactEngine,
    residue_descent,
    residue_scout,
    residue_search,
    root_sums,
    root_survey,
)
from truebreak.exact.machine import Flip, Go, Kick, Link, Machine, Step
from truebreak.exact.numbers import heights, residue
from truebreak.exact.numbers.heights import Measured
from truebreak.exact.program import causal_past, replay
from truebreak.exact.questions import Approach, BeforeTime, Gap, Question, RelativeSpeed, Sooner
from truebreak.exact.residue_search import TARGET, ResidueVerdict, residue_evidence
from truebreak.scenarios import Circle, Quantity, Scene, Wall
from truebreak.scenarios.catalogue.gas import gas
from truebreak.scenarios.tower import Tower, sign_of_root_sum

SECONDS = 60.0
"""Far above what any example needs."""

Q = Quantity.of
ZERO, ONE = Q(0), Q(1)
TINY = Q("1/10") ** 30


def verdict(scene: Scene, steps: Sequence[Step], question: Question, seed: int | None = 1) -> ResidueVerdict:
    return residue_evidence(scene, steps, question, seconds=SECONDS, seed=seed)


def assert_zero(found: ResidueVerdict) -> None:
    assert found.zero is True, found
    assert found.log2_error <= TARGET
    assert not found.why


def assert_not_zero(found: ResidueVerdict) -> None:
    assert found.zero is False, found


# -- a system, and a copy of it far away

Map = tuple[tuple[Quantity, Quantity], tuple[Quantity, Quantity]]
"""A linear map of the plane, row by row."""

SAME: Map = ((Q(1), Q(0)), (Q(0), Q(1)))
MIRRORED: Map = ((Q(-1), Q(0)), (Q(0), Q(1)))
TURNED: Map = ((Q("1/2"), Q("-sqrt(3)/2")), (Q("sqrt(3)/2"), Q("1/2")))
QUARTER: Map = ((Q(0), Q(-1)), (Q(1), Q(0)))
FAR = (Q(10_000), Q(20_000))


def applied(matrix: Map, x: Quantity, y: Quantity) -> tuple[Quantity, Quantity]:
    return matrix[0][0] * x + matrix[0][1] * y, matrix[1][0] * x + matrix[1][1] * y


def copied(
    scene: Scene, matrix: Map = SAME, size: Quantity = ONE, speed: Quantity = ONE, off: Quantity = ZERO
) -> Scene:
    """The scene mapped, so many times as large and as fast, its first circle displaced by `off`."""

    def place(x: Quantity, y: Quantity) -> tuple[Quantity, Quantity]:
        x, y = applied(matrix, x * size, y * size)
        return x + FAR[0], y + FAR[1]

    circles = []
    for number, c in enumerate(scene.circles):
        x, y = place(c.x, c.y)
        vx, vy = applied(matrix, c.vx * speed, c.vy * speed)
        circles.append(Circle(x if number else x + off, y, c.r * size, vx, vy, m=c.m, id=f"{c.id} copy"))
    walls = [Wall(*place(w.x0, w.y0), *place(w.x1, w.y1), id=f"{w.id} copy") for w in scene.walls]
    return Scene(circles, walls)


def side_by_side(
    scene: Scene, copy: Scene, steps: Sequence[Step]
) -> tuple[Scene, list[Step], Callable[[Link], tuple[Link, Link]]]:
    """Both in one scene, the log for both, and each contact of the one with that of the other."""
    n, walls = len(scene.circles), len(scene.walls)
    both = Scene([*scene.circles, *copy.circles], [*scene.walls, *copy.walls])

    def pair(link: Link) -> tuple[Link, Link]:
        i, j = link
        if j < n:
            return link, (i + n, j + n)
        return (i, j + n), (i + n, j + n + walls)

    log: list[Step] = []
    for half, shift in ((0, 0), (1, n)):
        for step in steps:
            if isinstance(step, Go):
                source = step.source
                if isinstance(source, tuple):
                    source = pair(source)[half]
                elif isinstance(source, int):
                    source += shift
                log.append(Go(source, tuple(i + shift for i in step.bodies)))
            elif isinstance(step, Kick):
                log.append(Kick(tuple(pair(link)[half] for link in step.links)))
            elif half:
                log.append(Flip())
    return both, log, pair


def chaos(n: int, events: int, seed: int = 1) -> tuple[Scene, list[Step], Link]:
    """A gas of n discs, the log of so many instants, and the contact that comes next."""
    scene = gas(n, seed, None, False)
    program = ExactEngine().run(scene, events=events + 1).motion.program  # type: ignore[attr-defined]
    hits = [k for k, step in enumerate(program.steps) if isinstance(step, Go) and type(step.source) is tuple]
    last = program.steps[hits[events]]
    assert isinstance(last, Go)
    assert isinstance(last.source, tuple)
    return scene, list(program.steps[: hits[events]]), last.source


def twins(n: int, events: int, **change: object) -> tuple[Scene, list[Step], Sooner]:
    scene, steps, link = chaos(n, events)
    both, log, pair = side_by_side(scene, copied(scene, **change), steps)  # type: ignore[arg-type]
    return both, log, Sooner(*pair(link))


@pytest.mark.parametrize(("n", "events"), [(3, 10), (3, 20), (3, 40), (4, 40)])
@pytest.mark.parametrize("matrix", [SAME, MIRRORED, TURNED], ids=["moved", "mirrored", "turned"])
def test_a_system_and_its_image_are_simultaneous(n: int, events: int, matrix: Map) -> None:
    found = verdict(*twins(n, events, matrix=matrix))
    assert_zero(found)
    assert found.roots >= 3


def test_a_larger_and_faster_copy_is_simultaneous() -> None:
    assert_zero(verdict(*twins(3, 20, size=Q(3), speed=Q(3))))
    assert_zero(verdict(*twins(3, 20, size=Q("5/7"), speed=Q("5/7"))))
    assert_zero(verdict(*twins(3, 20, size=Q("sqrt(2)"), speed=Q("sqrt(2)"))))


def test_a_copy_that_is_faster_alone_is_not_simultaneous() -> None:
    assert_not_zero(verdict(*twins(3, 10, speed=Q("11/10"))))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_copy_displaced_by_very_little_is_not_simultaneous(seed: int) -> None:
    assert_not_zero(verdict(*twins(3, 10, matrix=MIRRORED, off=TINY), seed=seed))


def test_the_system_draws_primes_of_its_own() -> None:
    case = twins(3, 10, matrix=MIRRORED)
    first, second = verdict(*case, seed=None), verdict(*case, seed=None)
    assert_zero(first)
    assert_zero(second)


def test_gap_and_approach_after_a_bounce() -> None:
    scene, steps, link = chaos(3, 15)
    both, log, pair = side_by_side(scene, copied(scene, MIRRORED), steps)
    first, _ = pair(link)
    assert_zero(verdict(both, [*log, Go(first, first)], Gap(first)))
    assert_not_zero(verdict(both, log, Gap(first)))
    assert_not_zero(verdict(both, log, Approach(first)))


def test_bounds_of_long_histories_hold_the_target() -> None:
    found = verdict(*twins(5, 60, matrix=MIRRORED))
    assert_zero(found)
    assert found.roots >= 15
    assert 256 < found.bits < 1024


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_residues_agree_with_the_tower_on_short_histories(seed: int) -> None:
    scene, steps, link = chaos(3, 5, seed)
    n = len(scene.circles)
    questions: list[Question] = [Approach(link), Gap(link), BeforeTime(link, Q(40))]
    questions += [Approach((i, j)) for i in range(n) for j in range(i + 1, n + len(scene.walls))]
    for question in questions:
        needed, bodies = causal_past(steps, question.bodies(n), n)
        tower = Tower(max_depth=4)
        machine = Machine(scene, lambda q, tower=tower: q.in_tower(tower), tower.sqrt, only=bodies)
        replay(machine, steps, needed)
        sign = sign_of_root_sum(*question.root_sum(machine))
        assert verdict(scene, steps, question).zero is (sign == 0)


def test_walls_of_irrational_length_bring_their_roots() -> None:
    box = [Wall(-20, 0, 20, 1), Wall(-20, 0, 0, 30), Wall(20, 1, 0, 30)]
    scene = Scene([Circle(-5, 8, vx=1, vy=Q("1/3")), Circle(5, 9, vy=-1), Circle(1, 15, vx=Q("1/2"))], box)
    run = ExactEngine().run(scene, events=16)
    steps = list(run.motion.program.steps)  # type: ignore[attr-defined]
    last = max(k for k, step in enumerate(steps) if isinstance(step, Go) and type(step.source) is tuple)
    step = steps[last]
    assert isinstance(step, Go)
    assert isinstance(step.source, tuple)
    for matrix in (MIRRORED, TURNED):
        both, log, pair = side_by_side(scene, copied(scene, matrix), steps[:last])
        assert_zero(verdict(both, log, Sooner(*pair(step.source))))


# -- scenes without free roots


def test_rational_scenes_need_no_root() -> None:
    scene = Scene([Circle(0, 0, vx=1), Circle(4, 0), Circle(0, 10, vx=1), Circle(4, 10)])
    found = verdict(scene, [], Sooner((0, 1), (2, 3)))
    assert_zero(found)
    assert found.roots == 0
    steps = [Go((0, 1), (0, 1)), Kick(((0, 1),)), Go((2, 3), (2, 3)), Kick(((2, 3),))]
    assert_zero(verdict(scene, steps, RelativeSpeed((1, 3))))
    near = Scene([Circle(0, 0, vx=1), Circle(4, 0), Circle(0, 10, vx=1), Circle(4 + TINY, 10)])
    assert_not_zero(verdict(near, [], Sooner((0, 1), (2, 3))))


def test_the_earlier_hit_is_told_from_the_later_one() -> None:
    scene = Scene([Circle(0, 0, vx=1), Circle(4, 1)])
    assert_zero(verdict(scene, [], BeforeTime((0, 1), Q("4 - sqrt(3)"))))
    assert_not_zero(verdict(scene, [], BeforeTime((0, 1), Q("4 + sqrt(3)"))))
    assert_not_zero(verdict(scene, [], BeforeTime((0, 1), Q("4 - sqrt(3)") + TINY)))


def test_two_roots_that_differ_make_one_time() -> None:
    """Times 8 - sqrt(3) and x - sqrt(2), equal by the choice of x; or only by that of the other sign."""
    x = Q("8 - sqrt(3) + sqrt(2)")
    scene = Scene([Circle(0, 0, vx=1), Circle(8, 1), Circle(0, 10, vx=1), Circle(x, 10 + Q("sqrt(2)"))])
    assert_zero(verdict(scene, [], Sooner((0, 1), (2, 3))))
    far = Scene([*scene.circles[:3], Circle(Q("8 - sqrt(3) - sqrt(2)"), 10 + Q("sqrt(2)"))])
    assert_not_zero(verdict(far, [], Sooner((0, 1), (2, 3))))


def test_products_of_rational_radicands_are_recognised() -> None:
    """Radicands 2, 3 and 6 (times squares): the third root is the product of the other two."""
    rows = [(Q(0), "sqrt(2)"), (Q(20), "1"), (Q(40), "sqrt(5/2)")]
    circles = []
    for y, off in rows:
        circles += [Circle(0, y, vx=1), Circle(9, y + Q(off))]
    scene = Scene(circles)
    steps: list[Step] = []
    for i in (0, 2, 4):
        steps += [Go((i, i + 1), (i, i + 1)), Kick(((i, i + 1),))]
    found = verdict(scene, steps, RelativeSpeed((1, 3)))
    assert_not_zero(found)
    assert found.roots == 0


def test_square_radicands_of_the_scene_field_have_their_own_sign() -> None:
    """Head-on at 1 + sqrt(3): the radicand is a square in Q(sqrt(3)), the time 2/(1 + sqrt(3))."""
    scene = Scene([Circle(0, 0, vx=Q("1 + sqrt(3)")), Circle(4, 0), Circle(0, 9, vx=Q("1 - sqrt(3)"))])
    steps = [Go((0, 1), (0, 1)), Kick(((0, 1),))]
    assert_zero(verdict(scene, [], BeforeTime((0, 1), 2 / Q("1 + sqrt(3)"))))
    assert_zero(verdict(scene, steps, Gap((0, 1))))
    assert_not_zero(verdict(scene, steps, RelativeSpeed((0, 1))))


# -- hits on an axis of symmetry, at a speed that is a deep number


def struck_on_axis() -> tuple[Scene, list[Step], Link]:
    """Mirror images bounce off two posts each and strike a disc; it strikes another, that meets a wall."""
    side = [
        Circle(-10, -30, vy=1, id="ball"),
        Circle(Q("-23/3"), -13, r=2, m="oo", id="post"),
        Circle(-28, -12, r=2, m="oo", id="far post"),
    ]
    image = [Circle(-c.x, c.y, c.r, -c.vx, c.vy, m=c.m, id=f"{c.id} image") for c in side]
    row = [Circle(0, 0, id="middle"), Circle(0, 20, id="next"), Circle(0, 60, id="idle")]
    scene = Scene([*side, *image, *row], [Wall(-1, 40, 1, 40)])
    steps: list[Step] = []
    for contact in ((0, 1), (0, 2), (3, 4), (3, 5)):
        steps += [Go(contact, contact), Kick((contact,))]
    steps += [Go((0, 6), (0, 3, 6)), Kick(((0, 6), (3, 6))), Go((6, 7), (6, 7)), Kick(((6, 7),))]
    return scene, steps, (7, 9)


def test_a_deep_speed_along_an_axis_is_recognised_under_the_root() -> None:
    """The radicand of a head-on hit is (2 v)**2 with v deep, and v has either sign in turned copies."""
    scene, steps, link = struck_on_axis()
    for matrix in (QUARTER, TURNED):
        both, log, pair = side_by_side(scene, copied(scene, matrix), steps)
        assert_zero(verdict(both, log, Sooner(*pair(link))))
    assert_zero(verdict(scene, steps, RelativeSpeed((6, 8))))
    assert_not_zero(verdict(scene, steps, RelativeSpeed((7, 8))))
    both, log, pair = side_by_side(scene, copied(scene, QUARTER, off=TINY), steps)
    assert_not_zero(verdict(both, log, Sooner(*pair(link))))


# -- giving up


def test_a_square_that_is_not_recognised_is_said() -> None:
    """Larger by 1 + sqrt(2), as fast: each radicand is (1 + sqrt(2))**2 times that of the original."""
    size = Q("1 + sqrt(2)")
    found = verdict(*twins(3, 10, size=size))
    assert found.zero is None
    assert "it seems to be the square of a number that was not recognised" in found.why


def test_a_search_out_of_time_says_so() -> None:
    found = residue_evidence(*twins(4, 30), seconds=0.0, seed=1)
    assert found.zero is None
    assert "time" in found.why


# -- parts


def test_candidates_are_primes_with_the_squares_asked_for() -> None:
    rng = random.Random(3)
    wanted = [fmpz(2), fmpz(15), fmpz(21), fmpz(45), fmpz(7 * 11 * 13)]
    candidates = residue.Candidates(wanted, 100, rng)
    assert candidates.log2_size >= 100
    for _ in range(20):
        p = candidates.prime(limit=1 << 20)
        assert p is not None
        assert p.is_prime()
        assert p.bit_length() <= candidates.bits
        assert all(w.jacobi(p) == 1 for w in wanted)


def test_candidates_come_to_an_end() -> None:
    assert residue.Candidates([], 64, random.Random(1)).prime(limit=0) is None


def test_the_set_of_candidates_is_as_large_as_stated() -> None:
    """Counted for small parts: residues modulo 8 * 3 * 5 * 7 with the symbols wanted."""
    candidates = residue.Candidates([fmpz(3), fmpz(5), fmpz(7)], 40, random.Random(1))
    units = {r for r in range(7, 840, 8) if all(fmpz(c).jacobi(fmpz(r)) == 1 for c in (3, 5, 7))}
    drawn = set()
    for _ in range(400):
        candidates._choose()
        drawn.add(int(candidates._start % 840))
    assert drawn == units
    assert len(units) * 2**candidates._spread >= 2**candidates.log2_size


@pytest.mark.parametrize("n", [561, 1105, 3215031751, 3317044064679887385961981])
def test_pseudoprimes_fail_the_witnesses(n: int) -> None:
    assert not residue.passes_witnesses(fmpz(n), random.Random(1))


def test_ratios_are_found_or_not() -> None:
    residues = residue.Residues(fmpz(2**127 - 1), None)
    for q in (fmpq(1), fmpq(7, 9), fmpq(2**23, 3)):
        assert residue.small_ratio(residues.number(q), residues.modulus, 24) == q
    for q in (fmpq(-1), fmpq(2**30, 3), fmpq(2**60 + 1, 3**30)):
        assert residue.small_ratio(residues.number(q), residues.modulus, 24) is None


def test_measured_heights_bound_true_ones() -> None:
    """Replayed in rationals, without dropping the exact values, and with the bounds alone."""
    rng = random.Random(4)
    numbers = [fmpq(rng.randrange(1, 99), rng.randrange(1, 99)) for _ in range(6)]
    bare = [Measured(Measured.of(q).height) for q in numbers]
    exact = numbers[0]
    bound = bare[0]
    for q, b in zip(numbers[1:], bare[1:], strict=True):
        exact, bound = (exact + q) * exact / (q - exact * q), (bound + b) * bound / (b - bound * b)
        assert max(exact.p.bit_length(), exact.q.bit_length()) <= bound.height + 1


def test_replay_modulo_a_prime_is_replay() -> None:
    """A rational run, and its image: p divides no denominator."""
    scene = Scene([Circle(0, 0, vx=1), Circle(4, 0), Circle(9, 0, vx="-1/3")])
    steps: list[Step] = [Go((0, 1), (0, 1)), Kick(((0, 1),)), Go((1, 2), (1, 2)), Kick(((1, 2),))]
    modulus = fmpz(2**89 - 1)
    residues = residue.Residues(modulus, None)

    def root(value: residue.Residue) -> residue.Residue:
        found = residues.root(value)
        return min(found, -found, key=int)

    rational = Machine(scene, lambda q: q.rational, lambda q: fmpq(q.p.isqrt(), q.q.isqrt()))
    modular = Machine(scene, lambda q: residues.number(q.rational), root)
    replay(rational, steps, range(2))
    replay(modular, steps, range(2))
    for a, b in zip(rational.bodies, modular.bodies, strict=True):
        assert [residues.number(v) for v in (a.x, a.vx, a.t)] == [b.x, b.vx, b.t]  # type: ignore[union-attr]


@pytest.mark.parametrize(
    "module", [heights, residue, residue_descent, residue_scout, residue_search, root_sums, root_survey]
)
def test_docstring_examples_hold(module: object) -> None:
    assert doctest.testmod(module).failed == 0  # type: ignore[arg-type]
