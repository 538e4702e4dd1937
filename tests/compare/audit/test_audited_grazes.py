"""The audit where two all but graze: rounding of the gap is a root of it in the speed, and faults are found yet."""

from __future__ import annotations

from dataclasses import replace

import pytest

from truebreak.compare import engine
from truebreak.compare.audit.audit import Audit, audit_run
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Arc, Circle, Polygon, Scene, Segment

POINT = Scene(
    [Circle("-49/40", "3/8", 0, vx="3/2", vy=-1, id="point", point=True)],
    segments=[Segment(0, 0, 1, 0, r="1/10", id="bar")],
    gravity=(-1, 1),
)
"""It comes to the very end of the bar as it flies along it, and goes off: a double zero of the gap."""

BESIDE = Scene(
    [Circle("-1/2", "-23/24", "1/2", vy="11/6", id="disc")],
    segments=[Segment(0, 3, 0, 0, id="bar")],
    arcs=[Arc(3, 0, 3, 0, 0, "27/5", "-9/5", id="bow")],
    gravity=(0, "1/3"),
)
"""It flies along the bar, at gap 0, and beside the bar's end rounding has it meet that."""

WITHIN = Scene(
    [Circle("12/13", "5/13", 1, vx="-15/13", vy="36/13", id="disc")],
    arcs=[
        Arc("24/13", "10/13", 2, 0, 0, "88/65", "-76/65", id="bow"),
        Arc("24/13", "10/13", 2, "550/169", "370/169", 0, 0, id="other"),
    ],
    gravity=("-24/13", "-10/13"),
)
"""It begins to roll within a circle: bounces follow each other as fast as rounding has it."""

ONTO_AN_END = Scene(
    [Circle("381/160", "-37/10", 1, vx="1/40", vy="21/5", id="disc")],
    arcs=[Arc("9/5", "12/5", 3, "-3/5", "21/5", 0, 0, id="bow")],
    gravity=("-97/60", "-8/5"),
    restitution=0,
)
"""It grazes an end of an arc, at a zero of the gap which Newton's rule comes near to in halves."""

FROM_ABOVE = Scene(
    [Circle("243/100", "-44/25", 0, vx="-123/50", vy="43/25", id="point", point=True)],
    segments=[Segment(0, 0, "6/5", "8/5", r="1/4", id="post"), Segment("-4/5", "3/5", "8/5", "-6/5", id="bar")],
    gravity=("3/50", "2/25"),
    restitution="1/2",
)
"""It comes down onto a bar without thickness, touches it, and is pulled up again: it flies through nothing."""


@pytest.mark.parametrize(
    ("scene", "name"),
    [
        (POINT, "double"), (POINT, "single"), (BESIDE, "quad"), (WITHIN, "double"), (WITHIN, "quad"),
        (WITHIN, "rounded:bits=30"), (ONTO_AN_END, "double"), (ONTO_AN_END, "single"), (FROM_ABOVE, "quad"),
    ],
)  # fmt: skip
def test_what_grazes_but_for_rounding_keeps_the_law(scene: Scene, name: str) -> None:
    chosen = engine(name)
    found = audit_run(chosen.run(scene, until=3, events=20), chosen)
    assert found.kept, found.sentence


def struck(scene: Scene, times: float) -> Audit:
    """The audit of a run of doubles whose first impulse is so many times what it was."""
    run = DoubleEngine().run(scene, events=1)
    (t0, x0, y0, vx, vy), (t, x, y, ux, uy) = run.motion.knots[0]
    gx, gy = map(float, scene.gravity) if scene.gravity else (0.0, 0.0)
    vx, vy = vx + gx * (t - t0), vy + gy * (t - t0)
    assert 1e-3 < abs(complex(ux - vx, uy - vy)) < 0.1
    changed = (t, x, y, vx + times * (ux - vx), vy + times * (uy - vy))
    rows = [[(t0, x0, y0, *run.motion.knots[0][0][3:]), changed], *run.motion.knots[1:]]
    return audit_run(replace(run, motion=replace(run.motion, knots=rows)), DoubleEngine())


DISC = Circle(-4, "1.49998", "1/2", vx=2, id="disc")
PEG = Circle(0, 0, m="oo", id="peg")
SHALLOW = [
    Scene([DISC, PEG]),
    Scene([replace(DISC, y="1.29998", vy="1/5"), PEG], gravity=(0, "-1/10")),
    Scene([replace(DISC, y="1.29998", vy="1/5")], arcs=[Arc(0, 0, 1, full=True, id="ring")], gravity=(0, "-1/10")),
    Scene([replace(DISC, y="1.29998", vy="1/5")], segments=[Segment(0, 0, 0, -5, r=1, id="bar")], gravity=(0, "-1/10")),
    Scene(
        [replace(DISC, y="1.29998", vy="1/5")], polygons=[Polygon([(0, 0), (-1, -9), (1, -9)], r=1, id="tip")],
        gravity=(0, "-1/10"),
    ),
]  # fmt: skip
"""A disc meets a peg, an arc, an end or a corner at 0.02 of a speed of 2."""


@pytest.mark.parametrize("scene", SHALLOW)
def test_an_impulse_that_is_off_is_found_where_two_meet_at_a_hundredth_of_their_speed(scene: Scene) -> None:
    assert struck(scene, 1.0).kept
    for times in (1 + 1e-3, 1 - 1e-3, -1.0, 0.0):
        found = struck(scene, times)
        assert found.kept is False and found.first is not None, times
        assert found.first.kind == "impulse"
