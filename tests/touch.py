"""Holds the ties of an exact run against the gaps: all that is said to touch at an instant does, to many digits."""

from __future__ import annotations

from flint import arb, ctx  # type: ignore[attr-defined]

from truebreak.scenarios import Trajectory, Wall
from truebreak.scenarios.trajectory import TieProof

GAP_BITS = 1200
"""Precision of the gaps. It is far above that of a run, so a tie that is none shows unless it is closer still."""


def assert_all_touch(trajectory: Trajectory, digits: int = 200) -> None:
    """At every instant of several contacts, each of them has a gap of zero, to so many digits."""
    scene = trajectory.scene
    things = {**{c.id: c for c in scene.circles}, **{w.id: w for w in scene.walls}}
    saved = ctx.prec
    try:
        for event in trajectory.events:
            if len(event.contacts) < 2:
                continue
            state = trajectory.at(event.time)
            for first, second in event.contacts:
                ctx.prec = GAP_BITS
                a, other = state[first], things[second]
                x, y, r = (a.x.ball(GAP_BITS), a.y.ball(GAP_BITS), things[first].r.ball(GAP_BITS))
                ctx.prec = GAP_BITS
                if isinstance(other, Wall):
                    nx, ny, x0, y0 = (q.ball(GAP_BITS) for q in (*other.normal, other.x0, other.y0))
                    height = nx * (x - x0) + ny * (y - y0)
                    gap = height * height - r * r * (nx * nx + ny * ny)
                else:
                    b = state[second]
                    dx, dy = b.x.ball(GAP_BITS) - x, b.y.ball(GAP_BITS) - y
                    reach = r + other.r.ball(GAP_BITS)
                    ctx.prec = GAP_BITS
                    gap = dx * dx + dy * dy - reach * reach
                assert gap.abs_upper() < arb(10) ** -digits, (event.index, first, second)
    finally:
        ctx.prec = saved


def proofs(trajectory: Trajectory) -> set[TieProof]:
    """The kinds of proof that a run's ties rest on."""
    return {tie.proof for event in trajectory.events for tie in event.ties}
