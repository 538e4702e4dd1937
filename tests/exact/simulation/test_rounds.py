"""Laws of one round of impulses: what it keeps, and that it solves its complementarity problem."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from random import Random
from typing import Any

import pytest
from test_policies import SCENE_ORDER, C

from truebreak.exact import ExactEngine
from truebreak.exact.numbers.ball import BALLS, Field, precision
from truebreak.exact.numbers.system import BudgetSpent, solve_positive
from truebreak.exact.question import Question, Strengths
from truebreak.exact.replay.contact import Pair, Touch
from truebreak.exact.replay.state import Kick, ReplayState
from truebreak.exact.simulation.policies import pushing_contacts
from truebreak.scenarios import Circle, Quantity, Scene, Trajectory

# -- laws of one round


def momentum_and_energy(scene: Scene, run: Trajectory) -> list[Quantity]:
    totals = [Quantity.of(0)] * 3
    for circle, state in zip(scene.circles, run.final.circles, strict=True):
        vx, vy = Quantity.of(state.vx.text()), Quantity.of(state.vy.text())
        parts = (circle.m * vx, circle.m * vy, circle.m * (vx * vx + vy * vy))
        totals = [total + part for total, part in zip(totals, parts, strict=True)]
    return totals


def blow(seed: int) -> Scene:
    """A heap of touching balls of drawn masses, hit by two more at the same instant."""
    draw = Random(seed)
    heap = [(0, 0), ("sqrt(3)", 1), ("sqrt(3)", -1), ("2*sqrt(3)", 0)]
    balls = [C(x, y, m=draw.randrange(1, 9)) for x, y in heap]
    balls.append(C(-4, 0, vx=1, m=draw.randrange(1, 9)))
    balls.append(C("2*sqrt(3) + 4", 0, vx=-1, m=draw.randrange(1, 9)))
    return Scene(balls)


@pytest.mark.parametrize("policy", ["simultaneous", SCENE_ORDER, "sequential:seed=3"])
@pytest.mark.parametrize("seed", range(4))
def test_momentum_and_energy_are_kept_exactly_and_no_contact_approaches(seed: int, policy: str) -> None:
    scene = blow(seed).with_changes(tie_policy=policy)
    run = ExactEngine().run(scene, events=1)
    start = [(c.m, c.vx, c.vy) for c in scene.circles]
    assert momentum_and_energy(scene, run) == [
        sum((m * vx for m, vx, _ in start), Quantity.of(0)),
        sum((m * vy for m, _, vy in start), Quantity.of(0)),
        sum((m * (vx * vx + vy * vy) for m, vx, vy in start), Quantity.of(0)),
    ]
    state = run.final.circles
    for a, b in combinations(state, 2):
        dx, dy, vx, vy = (
            Quantity.of(getattr(b, name).text()) - Quantity.of(getattr(a, name).text())
            for name in ("x", "y", "vx", "vy")
        )
        if dx * dx + dy * dy == 4:
            assert dx * vx + dy * vy >= 0


@pytest.mark.parametrize("seed", range(6))
def test_the_order_of_the_scene_does_not_matter_if_simultaneous(seed: int) -> None:
    scene = blow(seed)
    shuffled = scene.with_changes(circles=Random(seed).sample(scene.circles, len(scene.circles)))
    ends = [
        {c.id: (c.vx.text(), c.vy.text()) for c in ExactEngine().run(s, events=1).final.circles}
        for s in (scene, shuffled)
    ]
    assert ends[0] == ends[1]


AROUND = (
    [(2, 0), (-2, 0), (0, 2)],
    [(2, 0), ("-6/5", "8/5"), ("-6/5", "-8/5")],
    [("6/5", "8/5"), ("-6/5", "8/5"), (0, -2)],
    [(2, 0), ("-10/13", "24/13"), ("-10/13", "-24/13")],
)
"""Places of three balls that touch one at the origin, and not each other."""


@pytest.mark.parametrize("fixed", [False, True])
@pytest.mark.parametrize("seed", range(40))
def test_the_impulses_of_a_round_solve_the_complementarity_problem(seed: int, fixed: bool) -> None:
    """0 <= s, complementary to G s + 2 u >= 0: by the criss-cross method and by trying every set of contacts.

    With fixed balls around it the contacts of one ball depend on each other: G is singular, and its sets of
    pushing contacts may be several, all with the same G s.
    """
    draw = Random(seed)

    def ball(x: Any, y: Any, mass: Any) -> Circle:
        vx, vy = (0, 0) if mass == "oo" else (draw.randrange(-3, 4), draw.randrange(-3, 4))
        return C(x, y, vx=vx, vy=vy, m=mass)

    hub = C(0, 0, vx=draw.randrange(1, 4), vy=draw.randrange(-3, 4), m=draw.randrange(1, 5))
    others = [ball(x, y, "oo" if fixed else draw.randrange(1, 5)) for x, y in draw.choice(AROUND)]
    machine = ReplayState(Scene([hub, *others]), Field())
    links: list[Touch] = [Pair(0, k) for k in range(1, 4)]
    _, speeds = machine.contact_system(links)
    approaching = [link for link, speed in zip(links, speeds, strict=True) if speed < 0]

    def ask(question: Question) -> int:
        value = question.value(machine)
        return (value > 0) - (value < 0)

    chosen = pushing_contacts(approaching, ask) if approaching else ()
    solutions = every_solution(*machine.contact_system(approaching))
    assert chosen in [
        tuple(link for link, s in zip(approaching, solution, strict=True) if s) for solution, _ in solutions
    ]
    assert all(effect == solutions[0][1] for _, effect in solutions)


def test_impulses_are_solved_again_where_a_number_has_changed() -> None:
    """The questions about one set of contacts share them: of one state as it is, with the bits in use."""
    scene = Scene([C(0, 0, vx=1), C(2, 0, vx=-1), C(4, 0, vx=-2)])
    links: tuple[Touch, ...] = (Pair(0, 1), Pair(1, 2))
    shared, heavier = Strengths(links), [C(0, 0, vx=1, m=3), *scene.circles[1:]]

    def radii(found: list[Any]) -> list[float]:
        return [float(value.rad()) for value in found]

    with precision(64):
        balls, heavy = ReplayState(scene, BALLS), ReplayState(Scene(heavier), BALLS)
        first = shared(balls)
        assert shared(balls) is first
        for i, body in heavy.bodies.items():
            body.flight = balls.bodies[i].flight
        assert not (shared(heavy)[0] - first[0]).contains(0)
        assert radii(shared(balls)) == radii(first)
    with precision(256):
        assert radii(shared(balls)) == radii(Strengths(links)(balls))
        assert 0 < max(radii(shared(balls))) < min(radii(first))
        before = shared(balls)
        balls.do(Kick((links[0],), (links[0],)))
        assert not (shared(balls)[0] - before[0]).contains(0)
        assert radii(shared(balls)) == radii(Strengths(links)(balls))


class Counted(Fraction):
    """A fraction that counts the products it takes part in."""

    products = 0

    def __mul__(self, other: Any) -> Counted:
        Counted.products += 1
        return Counted(Fraction.__mul__(self, other))

    def __truediv__(self, other: Any) -> Counted:
        return Counted(Fraction.__truediv__(self, other))

    def __sub__(self, other: Any) -> Counted:
        return Counted(Fraction.__sub__(self, other))


@pytest.mark.parametrize("seed", range(20))
def test_contacts_that_share_no_circle_are_not_multiplied(seed: int) -> None:
    """A row of contacts, in a drawn order, leaves most of its matrix empty: the solution is the same without these."""
    draw, size, nothing = Random(seed), 12, Counted(0)
    order = draw.sample(range(size), size)
    matrix = [[nothing] * size for _ in range(size)]
    for i, j in [(k, k) for k in range(size)] + [(k, k + 1) for k in range(size - 1)]:
        entry = Counted(4) if i == j else Counted(draw.choice([-1, 1, 0]))
        matrix[order[i]][order[j]] = matrix[order[j]][order[i]] = entry
    right = [draw.choice([nothing, Counted(draw.randrange(-9, 10))]) for _ in range(size)]
    Counted.products = 0
    whole, products = solve_positive(matrix, right), Counted.products
    Counted.products = 0
    assert solve_positive(matrix, right, nothing) == whole
    assert Counted.products < products / 3
    assert all(sum(a * s for a, s in zip(row, whole, strict=True)) == b for row, b in zip(matrix, right, strict=True))


def every_solution(matrix: Any, speeds: Any) -> list[tuple[list[Fraction], list[Fraction]]]:
    """The solutions s of the complementarity problem, by trying every set of contacts that push, and each G s."""
    count = len(speeds)
    rows = [[Fraction(int(e.p), int(e.q)) for e in row] for row in matrix]
    twice = [2 * Fraction(int(u.p), int(u.q)) for u in speeds]
    found = []
    for size in range(count + 1):
        for active in combinations(range(count), size):
            solution = solved([[rows[i][j] for j in active] for i in active], [-twice[i] for i in active])
            if solution is None:
                continue
            s = [Fraction(0)] * count
            for place, value in zip(active, solution, strict=True):
                s[place] = value
            effect = [sum((rows[i][j] * s[j] for j in range(count)), Fraction(0)) for i in range(count)]
            enough = all(gain + need >= 0 for gain, need in zip(effect, twice, strict=True))
            if enough and all(s[i] > 0 for i in active):
                found.append((s, effect))
    return found


def solved(matrix: list[list[Fraction]], right: list[Fraction]) -> list[Fraction] | None:
    """The solution of a linear system by elimination; None if it has not exactly one."""
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    for column in range(len(rows)):
        pivot = next((k for k in range(column, len(rows)) if rows[k][column]), None)
        if pivot is None:
            return None
        rows[column], rows[pivot] = rows[pivot], rows[column]
        rows[column] = [value / rows[column][column] for value in rows[column]]
        for k, row in enumerate(rows):
            if k != column and row[column]:
                rows[k] = [a - row[column] * b for a, b in zip(row, rows[column], strict=True)]
    return [row[-1] for row in rows]


# -- signs that cannot be true


@pytest.mark.parametrize("told", [-1, 0, 1])
def test_signs_that_contradict_each_other_end_with_a_word(told: int) -> None:
    """No true signs lead to a set of contacts twice; rounded ones may, and then would for ever."""

    def ask(question: Question) -> int:
        return -1 if type(question).__name__ in ("Slack", "Strength") else told

    with pytest.raises(BudgetSpent, match=r"passes without end.* which of 3 contacts"):
        pushing_contacts([Pair(0, 1), Pair(1, 2), Pair(2, 3)], ask)


def test_signs_by_which_nothing_pushes_end_with_a_word() -> None:
    """Of contacts that approach, one pushes at least."""
    with pytest.raises(BudgetSpent, match="which of 2 contacts"):
        pushing_contacts([Pair(0, 1), Pair(1, 2)], lambda question: 0)
