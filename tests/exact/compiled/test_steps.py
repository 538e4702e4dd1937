"""Deviations that are carried by what is compiled against those carried by Python: the same bits."""

from __future__ import annotations

from contextlib import suppress
from copy import deepcopy
from random import Random
from typing import Any

import numpy as np
import pytest
from flint import arb

from truebreak.exact import ExactEngine
from truebreak.exact.certified import certified_decider as precision
from truebreak.exact.compiled import steps
from truebreak.exact.numbers import ball
from truebreak.exact.replay import centred_state as lone_centred
from truebreak.exact.replay import contact as body
from truebreak.exact.replay import deviations, error_set
from truebreak.exact.replay import deviations as carrying
from truebreak.exact.replay import error_bounds as derivatives
from truebreak.exact.replay import error_bounds as errors
from truebreak.exact.replay.centred_state import CentredState
from truebreak.exact.replay.contact import AtWall, Pair
from truebreak.exact.replay.error_bounds import NO_MIRROR, Spent
from truebreak.exact.replay.error_set import ErrorSet
from truebreak.scenarios import Circle, Scene, Wall
from truebreak.scenarios.catalogue import build

pytestmark = pytest.mark.skipif(steps is None, reason="nothing is compiled here")

ROWS, HIT = np.zeros((2, 4, 4)), np.zeros((1, error_set.PARTS))

KEPT = ("_hits", "_pairs", "_pending", "_steps", "_grown")


def test_the_numbers_written_twice_are_the_same() -> None:
    assert steps is not None
    where = (errors, derivatives, deviations, body, carrying)
    for name, value in steps.constants().items():
        assert {getattr(module, name) for module in where if hasattr(module, name)} == {value}, name


def kept(held: ErrorSet) -> str:
    """All that a contact changes of a set, to the last bit."""
    bounds = held.bounds
    return repr([bounds.place, bounds.pace, bounds.beside, *(getattr(held, name) for name in KEPT)])


def keep(held: ErrorSet) -> tuple[Any, ...]:
    return deepcopy((held.bounds, {name: getattr(held, name) for name in KEPT}))


def give_back(held: ErrorSet, of: tuple[Any, ...]) -> None:
    held.bounds = of[0]
    for name, value in of[1].items():
        setattr(held, name, value)


def seen(told: Any) -> str:
    """What comes out: balls are equal to none, so they are told by their exact numbers."""
    if told is None:
        return "None"
    power, beside, landings = told
    rows = [[[number.man_exp() for number in mid[:5]], *rest] for mid, *rest in landings]
    return repr((power, beside, rows))


def in_both(monkeypatch: pytest.MonkeyPatch) -> dict[str, int]:
    """Has each contact carried twice from now on, and the two compared; counts what came out."""
    told = dict.fromkeys(("pairs", "walls", "falls", "none", "spent", "plain"), 0)

    def both(carry: Any, kind: str) -> Any:
        def carried(held: Any, *given: Any) -> Any:
            before, mids = keep(held.errors), dict(held.mid)
            outcomes = []
            for python in (True, False):
                with monkeypatch.context() as patch:
                    if python:
                        patch.setattr(carrying, "steps", None)
                    try:
                        found = carry(held, *given)
                    except Spent:
                        outcomes.append(("spent", ""))
                        found = Spent
                    else:
                        outcomes.append((seen(found), kept(held.errors)))
                held.mid = dict(mids)
                if python:
                    give_back(held.errors, before)
            assert outcomes[0] == outcomes[1]
            if found is Spent:
                told["spent"] += 1
                raise Spent
            told["none" if found is None else kind] += 1
            told["plain"] += found is not None and found[2][0][3] is not None
            return found

        return carried

    monkeypatch.setattr(lone_centred, "carry_pair", both(lone_centred.carry_pair, "pairs"))
    monkeypatch.setattr(lone_centred, "carry_wall", both(lone_centred.carry_wall, "walls"))
    monkeypatch.setattr(lone_centred, "carry_fall", both(lone_centred.carry_fall, "falls"))
    return told


FLIGHTS = [(1, 2, 1, "1/9"), (3, 2, -1, "1/7"), (2, 4, "1/5", -1), (4, 4, "1/3", "1/4")]
MASSES = [1, "1/3", 10**6, "22/7"]

OBLIQUE = Scene(
    [Circle(x, y, vx=v, vy=w, r="1/3", m=m) for (x, y, v, w), m in zip(FLIGHTS, MASSES, strict=True)],
    [Wall(0, 0, 6, 1), Wall(6, 1, 5, 7), Wall(5, 7, -1, 6), Wall(-1, 6, 0, 0)],
)


DRIFTING = OBLIQUE.with_changes(
    walls=[Wall(w.x0, w.y0, w.x1, w.y1, vx=f"{k % 2}/999", vy=f"-{k % 2}/997") for k, w in enumerate(OBLIQUE.walls)]
)


@pytest.mark.parametrize(
    ("scene", "events"),
    [
        (build("gas:n=10,seed=3"), 500),
        (build("gas:n=3,seed=2"), 700),
        (build("gas:n=5,seed=1,mixed=yes"), 400),
        (OBLIQUE, 400),
        (build("galperin:n=2"), 300),
        (build("rack:rows=3"), 40),
        (build("gas-under-gravity"), 500),
        (build("wedge:slope=2").with_changes(restitution="99/100"), 160),
        (OBLIQUE.with_changes(gravity=("1/3", -1)), 400),
        (DRIFTING, 400),
    ],
    ids=["ten", "three", "mixed", "oblique", "galperin", "rack", "falling", "wedge", "oblique, falling", "drifting"],
)
@pytest.mark.parametrize("clocks", ["of all bits", "short"])
def test_contacts_of_a_run_are_carried_in_the_same_bits(
    scene: Scene, events: int, clocks: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(precision, "LONG_BITS", 300)
    monkeypatch.setattr(lone_centred, "FALLING_COSTS", 1)
    if clocks == "short":
        monkeypatch.setattr(lone_centred, "LONG_NUMBERS", 0)
        monkeypatch.setattr(lone_centred, "CLOCK_BITS", 100)
    told = in_both(monkeypatch)
    assert ExactEngine().run(scene, events=events).events
    if events >= 400:
        assert min(told["pairs"], told["walls"] + told["falls"], told["plain"]) > 80
    assert not told["walls" if scene.gravity or scene.moving_walls else "falls"]


@pytest.mark.parametrize(("name", "kinds"), [("gas:n=3,seed=2", ("pairs", "walls")), ("gas-under-gravity", ("falls",))])
def test_what_cannot_be_carried_is_told_alike(
    name: str, kinds: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Bounds of every size, and balls of few bits: up to where a derivative is not to be had, and beyond doubles."""
    told, rng = in_both(monkeypatch), Random(4)
    scene = build(name)
    run = ExactEngine().run(scene, events=60)
    links = [event.contacts[0] for event in run.events]
    names = {str(circle.id): i for i, circle in enumerate(scene.circles)}
    walls = {str(wall.id): k for k, wall in enumerate(scene.walls)}
    for _ in range(300):
        bits = rng.choice([60, 120, 300])
        with ball.precision(bits):
            state = CentredState(scene)
            for each in state.bodies.values():
                each.acc = bits
            state._deviations = held = state._begin()
            held.errors.near *= 2.0 ** rng.choice([rng.randrange(-60, 60), 1000])
            held.near_time *= 2.0 ** rng.randrange(-20, 20)
            held.errors._limit *= 2.0 ** rng.randrange(-60, 60)
            for part in (held.errors.bounds.place, held.errors.bounds.pace):
                part[:] = [
                    bound * 2.0 ** rng.choice([0, rng.randrange(-40, 40), rng.randrange(920, 960)]) for bound in part
                ]
            for step, link in enumerate(links[:6]):
                known = names[link.first], names.get(link.second)
                contact = Pair(*sorted(known)) if known[1] is not None else AtWall(known[0], walls[link.second])
                if lone_centred.LoneCentred(state).strike(contact, bits, 2 * step) is None:
                    break
    assert min(told[kind] for kind in (*kinds, "none", "spent")) > 20


NUMBERS = [arb(1), arb(2, 1e-20), arb(0, 1e-10), arb(0), arb(1, 1e3), arb(1, float("inf")), arb("nan"), arb(3, 1e-300)]


@pytest.mark.parametrize("odd", NUMBERS, ids=str)
@pytest.mark.parametrize("shift", [-300, 0, 300])
def test_what_rounding_drops_is_told_alike_of_every_ball(odd: arb, shift: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Balls around 0, of which flint tells no bits, balls without end, and what is none: the set is given up, or what
    they drop is in its bounds."""
    told = in_both(monkeypatch)
    scene = build("gas:n=3,seed=2")
    with ball.precision(300):
        state = CentredState(scene)
        state._deviations = held = state._begin()
        held.errors.shift = shift
        held.errors.near = 1e300
        a, b = (state.bodies[i] for i in (0, 1))
        met, since = (arb(1), arb(1), arb(-1), arb(-1), arb(2)), (arb(1), arb(1))
        plain, clock = (arb(1), arb(2), arb(3), arb(4)), arb(1)
        for k in range(4):
            numbers = (*plain[:k], odd, *plain[k + 1 :])
            before, mids = keep(held.errors), dict(held.mid)
            for carry in (
                lambda numbers=numbers: lone_centred.carry_pair(
                    held, state, Pair(0, 1), met, since, arb(0), ((a, *plain), (b, *numbers)), clock, 2
                ),
                lambda numbers=numbers: lone_centred.carry_wall(
                    held, AtWall(0, 0), held.face(state, AtWall(0, 0)), arb(1), (arb(-1), arb(-1)), arb(0),
                    (a, *numbers), clock, 2,
                ),
                lambda numbers=numbers: lone_centred.carry_fall(
                    held, AtWall(0, 0), deviations.Slope(0.0, 1.0, -2.0, -1.0), arb(1), arb(1), arb(0),
                    (a, *numbers), clock, 2,
                ),
                lambda numbers=numbers: lone_centred.carry_fall(
                    held, AtWall(0, 0), deviations.Slope(0.0, 1.0, -2.0, -1.0), arb(1), odd, arb(0),
                    (a, *plain), clock, 2,
                ),
            ):  # fmt: skip
                with suppress(Spent):
                    carry()
                give_back(held.errors, before)
                before, held.mid = keep(held.errors), dict(mids)
    assert sum(told.values()) >= 8


@pytest.mark.parametrize(("count", "hits"), [(1, 0), (2, 5), (10, 60), (24, 200)])
def test_rows_are_carried_by_the_same_matrices(count: int, hits: int) -> None:
    """To their roundings, which docs/error-bound.md counts: less than 16 u of the sizes a step."""
    assert steps is not None
    rng = np.random.default_rng(count)
    rows = rng.normal(size=(count + 1, 4, 4 * count))
    rows[-1] = 0.0
    parts, blocks = rng.normal(size=(hits, error_set.PARTS)) / 2.0, rng.normal(size=(7, hits)) / 2.0
    pairs = [tuple(map(int, rng.choice(count, 2, replace=False))) for _ in range(hits)] if count > 1 else []
    pairs = [(i, -1) if k % 5 == 0 else (i, j) for k, (i, j) in enumerate(pairs)]
    parts[[k for k, (_, j) in enumerate(pairs) if j < 0], 11] = 0.0  # what is fixed stays
    legs = [tuple(rng.normal(size=5)) for _ in range(count)] + [error_set.STILL]
    carried, exact, sizes = rows.copy(), rows.astype(np.longdouble), np.abs(rows)
    steps.carry(carried, [k for pair in pairs for k in pair], parts, blocks, legs)
    wide = error_set._maps(parts.astype(np.longdouble), blocks.astype(np.longdouble)).astype(np.longdouble)
    for (i, j), m, size in zip(pairs, wide, error_set._maps(np.abs(parts), -np.abs(blocks)), strict=True):
        exact[i], exact[j] = np.split(m @ np.concatenate([exact[i], exact[j]]), 2)
        sizes[i], sizes[j] = np.split(np.abs(size) @ np.concatenate([sizes[i], sizes[j]]), 2)
    exact, sizes = (error_set._flown(np.array(of)) @ to for of, to in ((legs, exact), (np.abs(legs), sizes)))
    assert np.all(np.abs(carried - exact) <= 32 * (hits + 1) * 2.0**-53 * sizes)
    assert not np.array_equal(carried, rows)


def test_the_end_of_a_block_is_that_of_python(monkeypatch: pytest.MonkeyPatch) -> None:
    """M to its roundings: far below what a step is said to leave beside it."""
    rng, sets = Random(7), [ErrorSet([[1.0, 0.5, 2.0, 0.25]] * 5, 0, 0.5) for _ in range(2)]
    for _ in range(30):
        i, j = rng.sample(range(5), 2)
        j = rng.choice([j, j, -1])
        dx, dy, slow = rng.uniform(0.5, 1), rng.uniform(0.5, 1), rng.uniform(0.1, 1)
        hit = errors.Collision(0.0, 0.0, 2.0, dx, dy, -slow, -slow, slow * (dx + dy), -1.0 / (dx * dx + dy * dy))
        for held in sets:
            held.fly(i, 0.25, NO_MIRROR)
            held.meet(i, j, (0.5, 0.125), (1.0, 1.0 if j >= 0 else 0.0), hit, 0.0)
    ours = sets[0]._carried()
    monkeypatch.setattr(error_set, "steps", None)
    python = sets[1]._carried()
    assert np.abs(ours - python).max() < 2.0**-40 * np.abs(python).max()
    assert np.abs(ours).max() > 1.0


@pytest.mark.parametrize(
    "call",
    [
        lambda c: c.bounce(),
        lambda c: c.rebound(1, 2, 3),
        lambda c: c.fall(1, 2, 3),
        lambda c: c.fall(ErrorSet([[1.0] * 4], 0), 0, arb(1), 1.0, (0.0, 1.0, -2.0), arb(0), 1.0, (), arb(1), 1, 0),
        lambda c: c.carry(ROWS, [0, 1], HIT, np.zeros(6), []),
        lambda c: c.carry(ROWS, [0, 1], np.zeros((1, 18)), np.zeros((7, 1)), []),
        lambda c: c.carry(np.zeros((2, 3, 4)), [0, 1], HIT, np.zeros((7, 1)), []),
        lambda c: c.carry(np.zeros(8), [0, 1], HIT, np.zeros((7, 1)), []),
        lambda c: c.carry(ROWS.astype(np.float32), [0, 1], HIT, np.zeros((7, 1)), []),
        lambda c: c.carry(ROWS, (0, 1), HIT, np.zeros((7, 1)), []),
        lambda c: c.carry(ROWS, [0, 1], HIT, np.zeros((7, 1)), [(1.0, 2.0)]),
        lambda c: c.rebound(ErrorSet([[1.0] * 4], 0), 0, arb(1), (1, 1), (1, 2), arb(0), 1.0, (), arb(1), 1, 0),
        lambda c: c.rebound(
            ErrorSet([[1e-30] * 4], 0), 0, arb(1), (1.0, -1.0), (0.0, 1.0, (1.0, 0.0, -1.0, 0.0)), arb(0), 1.0,
            (arb(1),), arb(1), 1, 0,
        ),
    ],
)  # fmt: skip
def test_what_makes_no_sense_is_refused(call: Any) -> None:
    with pytest.raises(TypeError):
        call(steps)


def test_bodies_that_are_not_there_are_refused() -> None:
    assert steps is not None
    with pytest.raises(IndexError):
        steps.carry(ROWS, [0, 2], HIT, np.zeros((7, 1)), [])
    with pytest.raises(IndexError):
        steps.carry(ROWS, [], HIT, np.zeros((7, 1)), [error_set.STILL] * 3)
    held, four = ErrorSet([[1.0] * 4] * 2, 0), (arb(1),) * 4
    face = (0.0, 1.0, (1.0, 0.0, -1.0, 0.0))
    for i in (-1, 2):
        with pytest.raises(IndexError):
            steps.rebound(held, i, arb(1), (arb(1), arb(-1)), face, arb(0), 1.0, four, arb(1), 1, 0)
        with pytest.raises(IndexError):
            steps.fall(held, i, arb(1), 1.0, (0.0, 1.0, -2.0, -1.0), arb(0), 1.0, four, arb(1), 1, 0)
    with pytest.raises(IndexError):
        steps.bounce(held, 0, 2, (arb(1),) * 5, arb(1), arb(1), -1.0, (1.0, 1.0), arb(0), 1.0, four, four, arb(1), 1, 0)
