"""A billiards break: a triangle of balls on a table, and a cue ball that comes from the left."""

from __future__ import annotations

from ..errors import SceneError
from ..numbers.quantity import Quantity
from ..scene import Scene
from ..settings import TiePolicy
from ..things import Circle, Pocket, Wall
from .article import SOURCE as ARTICLE
from .scene_entry import Draw, Parameter, SceneEntry, number, tie_policy, whole, yes_no

EVENTS = 20

LENGTH, WIDTH = 92, 42
"""The table in inches, between the cushions: the article's numbers."""

RADIUS = Quantity.of("9/8")
"""Radius of a pool ball in inches."""

POCKET = Quantity.of("9/4")
"""Radius of a pocket. A centre comes within 9/8 * sqrt(2), about 1.6, of a corner, and so can enter."""

HEIGHT = Quantity.of("sqrt(3)/2")
"""Height of a triangle of side 1."""

GRAIN = 1000
"""Jitter is drawn in steps of its amplitude divided by this."""


def rack(
    rows: int,
    gap: Quantity,
    jitter: Quantity,
    seed: int,
    offset: Quantity,
    speed: Quantity,
    tie: TiePolicy,
    pockets: bool,
) -> Scene:
    """`rows` rows of balls, apex at three quarters of the table, and the cue at one quarter.

    Neighbours are `gap` apart. With `jitter`, every ball of the rack is displaced by up to that much in x and
    in y, drawn from `seed`, in a rack drawn wider so that they stay clear of each other.

    Raises:
        SceneError: for a rack or a cue that the table has no room for.

    >>> zero = Quantity.of(0)
    >>> scene = rack(2, zero, zero, 0, zero, Quantity.of(1), TiePolicy(), False)
    >>> [c.id for c in scene.circles], scene.circles[2].x
    (['cue', 'b1', 'b2', 'b3'], Quantity('69 + sqrt(3)/2*(9/4)'))
    """
    room = 2 * RADIUS + gap + 3 * jitter  # 3 > 2 * sqrt(2): two displacements toward each other
    draw = Draw(seed)
    middle = Quantity.of(WIDTH) / 2
    circles = [Circle(Quantity.of(LENGTH) / 4, middle + offset, r=RADIUS, vx=speed, id="cue")]
    for row in range(rows):
        for place in range(row + 1):
            x = 3 * Quantity.of(LENGTH) / 4 + HEIGHT * (room * row)
            y = middle + room * (row - 2 * place) / 2
            dx, dy = (jitter * draw.between(-GRAIN, GRAIN) / GRAIN for _ in range(2))
            circles.append(Circle(x + dx, y + dy, r=RADIUS, id=f"b{len(circles)}"))
    for ball in circles:
        if not (RADIUS <= ball.x <= LENGTH - RADIUS and RADIUS <= ball.y <= WIDTH - RADIUS):
            raise SceneError(f"ball {ball.id!r} is not on the table; lower rows, gap, jitter or offset")
    return Scene(circles, _cushions(), tie_policy=tie, pockets=_pockets() if pockets else (), events=EVENTS)


def _cushions() -> list[Wall]:
    return [
        Wall(0, 0, 0, 1, id="left"),
        Wall(LENGTH, 0, LENGTH, 1, id="right"),
        Wall(0, 0, 1, 0, id="bottom"),
        Wall(0, WIDTH, 1, WIDTH, id="top"),
    ]


def _pockets() -> list[Pocket]:
    return [
        Pocket(x, y, POCKET, id=f"pocket {side} {place}")
        for y, side in ((0, "bottom"), (WIDTH, "top"))
        for x, place in ((0, "left"), (LENGTH // 2, "middle"), (LENGTH, "right"))
    ]


SCENES = {
    "rack": SceneEntry(
        name="rack",
        summary="The billiards break: a cue ball hits a triangle of balls.",
        parameters=(
            Parameter("rows", "4", "rows of the triangle", whole(1, 5)),
            Parameter("gap", "0", "gap between the balls; 0 makes them touch", number(least=0)),
            Parameter("jitter", "0", "largest displacement of a ball, such as 10**-3", number(least=0)),
            Parameter("seed", "0", "seed of the jitter", whole(0, 10**9)),
            Parameter("offset", "0", "the cue's distance from the table's axis", number()),
            Parameter("speed", "1", "speed of the cue, in inches a second", number(above=0)),
            Parameter("tie", "simultaneous", "tie policy, such as sequential:seed=7", tie_policy),
            Parameter("pockets", "yes", "whether to report who enters a pocket", yes_no),
        ),
        known=(
            "Without offset and jitter the scene is its own mirror image in the table's axis, and stays so "
            "under a tie policy that is symmetric. What a touching rack does depends on the tie policy."
        ),
        source=f"{ARTICLE} (World.billiards: rows=4)",
        make=rack,
    )
}
