"""The ranges of arcs: which part of its circle each is, told by the side of a chord."""

from __future__ import annotations

from ..laws.formulas import arc_range
from ..numbers.system import N
from .contact import AtArc
from .state import Flights


def arc_chord(state: Flights[N], link: AtArc) -> tuple[N, N, N]:
    """The normal of an arc's chord, and n.e |R|, as `formulas.arc_range` takes them."""
    side, reach, constant = state.scene.arc_sides[link.arc], state.reach(*link.ends(state)), state.constant
    return constant(side.nx), constant(side.ny), constant(side.h) * (-reach if link.hollow else reach)


def faces_arc(state: Flights[N], link: AtArc, dx: N, dy: N) -> N:
    """Whether a circle anywhere, d from the middle of an arc, is within its range: positive there."""
    side, constant = state.scene.arc_sides[link.arc], state.constant
    if side.full:
        return state.one
    return arc_range(dx, dy, constant(side.nx), constant(side.ny), constant(side.h) * state.root(dx * dx + dy * dy))


def within_arc(state: Flights[N], link: AtArc, dx: N, dy: N) -> N:
    """Whether d, as long as the centres are apart at a contact, leads to within an arc's range: positive there."""
    return state.one if state.scene.arc_sides[link.arc].full else arc_range(dx, dy, *arc_chord(state, link))
