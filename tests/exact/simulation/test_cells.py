"""Histories with cells and without are the same."""

from __future__ import annotations

import pytest

from truebreak.compare import engine
from truebreak.exact.simulation import cells
from truebreak.scenarios import Circle, Scene, Trajectory, Wall, catalogue

LATTICE = Scene(
    [Circle(3 * i, 3 * j, vx=(i * 7 + j) % 5 - 2, vy=(i + 3 * j) % 5 - 2) for i in range(10) for j in range(7)],
    [Wall(-4, 0, -4, 1), Wall(32, 0, 32, 1), Wall(0, -4, 1, -4), Wall(0, 23, 1, 23)],
    events=300,
)
"""Many instants of several contacts, far from one another."""

SCENES = {
    "gas": lambda: (catalogue.build("gas:n=70,seed=3"), {"events": 300}),
    "mixed": lambda: (catalogue.build("gas:n=70,seed=4,mixed=yes"), {"events": 300}),
    "crowd": lambda: (catalogue.build("gas:n=200,seed=1"), {"events": 400}),
    "lattice": lambda: (LATTICE, {"events": 200}),
    "there and back": lambda: (
        catalogue.build("gas:n=70,seed=2").with_changes(until=None, events=None, reverse_after=60),
        {},
    ),
    "turned at a time": lambda: (
        catalogue.build("gas:n=70,seed=5").with_changes(until=None, events=None, reverse_at=1),
        {},
    ),
    "one large among small": lambda: (
        Scene(
            [
                Circle(0, 0, 40, 1, 0, m=9),
                *(Circle(50 + 3 * i, 3 * j, vx=-1 - i % 3) for i in range(10) for j in range(-3, 4)),
            ]
        ),
        {"events": 60},
    ),
}


def told(run: Trajectory) -> list[object]:
    """All that a history says, its numbers as doubles; the contacts of one instant in no order."""
    events = [(float(e.time), sorted(e.contacts), sorted(e.impulses), {t.proof for t in e.ties}) for e in run.events]
    final = [(float(c.x), float(c.y), float(c.vx), float(c.vy)) for c in run.final.circles]
    return [events, final, float(run.final_time), run.stop.reason, [(p.circle, float(p.time)) for p in run.pocketings]]


@pytest.mark.parametrize("name", ["exact", "double"])
@pytest.mark.parametrize("scene", SCENES)
def test_cells_change_nothing(scene: str, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    built, limits = SCENES[scene]()
    with_cells = engine(name).run(built, **limits)
    assert with_cells.plan["cells crossed"] > 0
    monkeypatch.setattr(cells, "FEWEST", 10**9)
    without = engine(name).run(built, **limits)
    assert "cells crossed" not in without.plan
    assert told(with_cells) == told(without)
    assert with_cells.plan["pairs predicted"] < without.plan["pairs predicted"] / 2


def test_what_no_double_holds_is_held_against_all() -> None:
    """Places, radii and walls beyond the range of doubles, and below it."""
    far = "10**400"
    run = engine("exact").run(
        Scene([Circle(0, 0, far, 1, 0), Circle("4*10**400", 0, far)], [Wall(far, far, 0, "2*10**400")])
    )
    assert run.certified
    rows = [Circle(f"4*{k}*{far}", 0, far, -k) for k in range(70)]
    assert engine("exact").run(Scene(rows), events=2).certified
    near = "10**-320"
    beside = Scene(
        [Circle(f"{k}*{near}", 0, f"{near}/4", 1) for k in (1, 3)], [Wall(f"2*{near}", 0, f"2*{near}", "10**300")]
    )
    hit = engine("exact").run(beside).events[0]
    assert hit.contacts[0] == ("c1", "w1")
    assert float(hit.time) == 7.5e-321
