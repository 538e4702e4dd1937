"""Scenes in which states of every kind are held against long balls."""

from __future__ import annotations

import random

import pytest

from truebreak.scenarios import Circle, Scene, Wall, catalogue


def oblique(seed: int, e: str = "1") -> Scene:
    """Unequal circles, a fixed one and a point, between walls of which none is parallel to an axis."""
    draw = random.Random(seed)

    def speed() -> str:
        return f"{draw.choice([-1, 1]) * draw.randrange(20, 90)}/97"

    circles = [
        Circle(0, 0, vx=speed(), vy=speed(), m="3/7"),
        Circle(4, "1/3", r="1/2", vx=speed(), vy=speed(), m=2),
        Circle("-7/2", 2, r="sqrt(2)/2", vx=speed(), vy=speed()),
        Circle(0, 4, r="3/4", m="oo"),
        Circle(1, "-7/2", r=0, vx=speed(), vy=speed(), m="1/5", point=True),
    ]
    walls = [Wall(-8, -9, 9, -7), Wall(9, -7, 7, 9), Wall(7, 9, -9, 8), Wall(-9, 8, -8, -9)]
    return Scene(circles, walls, restitution=e)


SCENES = {
    **{name: (lambda name=name: catalogue.build(name)) for name in ("gas:n=3,seed=2", "gas:n=7,seed=5,mixed=yes")},
    "a reversal": lambda: catalogue.build("gas:n=4,seed=3").with_changes(reverse_after=40),
    "a rack": lambda: catalogue.build("rack:rows=3,gap=1/9,jitter=1/1000,seed=4"),
    "pinball": lambda: catalogue.build("pinball"),
    **{f"oblique {seed}": (lambda seed=seed: oblique(seed)) for seed in range(3)},
    **{f"restitution {e}": (lambda e=e: oblique(1, e)) for e in ("9/10", "1/3", "sqrt(2)/2")},
}


@pytest.fixture(params=SCENES)
def scene(request: pytest.FixtureRequest) -> Scene:
    """Each of them."""
    return SCENES[request.param]()
