"""A history compared with the exact run that resolves each tie as the history itself does."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...exact.exact_engine import ExactEngine
from ...exact.numbers.ball import double_bounds
from ...exact.replay.contact import Touch
from ...exact.simulation.policies import Ask, pushing_contacts
from ..alignment.align import UNKNOWING, Span, align
from ..alignment.instants import Kind
from ..causes.decision import RunReader
from ..causes.laboratory import decisions
from ..foreign.guard import run_guarded
from ..foreign.log_engine import LogEngine
from ..orders.guided import Guided
from ..outcomes.permitted import PatternRelation
from ..tolerances.reach import reach_of
from ..validation import check_trajectory

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
    from ..alignment.align import Alignment
    from ..candidate import Candidate
    from ..comparison import Comparison
    from ..tolerances.errors_grown import LocalError
    from ..tolerances.reach import Reach


class GuidedRounds(Guided):
    """As `Guided`; but contacts of one event of the history get their impulses together, as by the default policy.

    An engine that pushes all contacts of one instant at once may come to the next tie with them apart, by rounding:
    neither the policy nor one order after the other is what it does all along.
    """

    def __init__(self, scene: Scene, history: Trajectory) -> None:
        super().__init__(scene, history, any_order=True)

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """All of them that push, if the history has all that approach in what comes next; else one."""
        if not all(map(self._is_next, approaching)):
            return super().choose(approaching, ask)
        chosen = pushing_contacts(approaching, ask)
        for link in chosen:
            self.note(link)
        return chosen


@dataclass(frozen=True)
class OwnOrder:
    """An exact run that resolves each tie as a history does.

    Attributes:
        run: the exact run.
        history: the engine's run, as far on as it took to tell.
        alignment: of the history with the run.
        reach: how far the history is required; None where all of it is.
        told: how it was found to be permitted; None where it was not.
    """

    run: Trajectory
    history: Trajectory
    alignment: Alignment
    reach: Reach | None
    told: str | None

    @property
    def settled(self) -> bool:
        """Whether it is known that the history is permitted, or not.

        It is not, where the two part at no tie, with all before resolved alike, at a decision beyond rounding errors.
        """
        parted = self.alignment.divergence
        return self.told is not None or (parted is not None and parted.kind is not Kind.TIE)


def in_its_own_order(
    scene: Scene, candidate: Candidate, engine: Engine, span: float, local: LocalError | None
) -> OwnOrder | None:
    """The exact run that resolves ties as a history does, in no one order all along.

    Args:
        span: the time up to which it is asked for.
        local: the local error of the engine: from the first decision on that rounding errors may have changed, grown
            along that run, nothing is asked. None: all of the span is asked for.

    Returns:
        The one of two such runs that follows the history the farthest; None if neither was decided.
    """
    followed: list[tuple[Trajectory, Trajectory, Alignment]] = []
    for together in (True, False):
        try:
            followed.append(_followed(scene, candidate, engine, span, together))
        except Unfollowed:
            continue
    if not followed:
        return None
    own, history, found = max(followed, key=lambda each: _parted(each[2]))
    reach = None if local is None else reach_of(own, local, in_rounds=True)
    return OwnOrder(own, history, found, reach, _told(own, history, found, local, reach))


def _parted(alignment: Alignment) -> float:
    """Where two histories part; the run that follows a history the farthest is the one that resolves ties alike."""
    return math.inf if alignment.divergence is None else alignment.divergence.event


class Unfollowed(Exception):
    """The exact run that resolves ties as a history does was not decided."""


def _followed(
    scene: Scene, candidate: Candidate, engine: Engine, span: float, together: bool
) -> tuple[Trajectory, Trajectory, Alignment]:
    """The exact run that follows a history, both as far on as it takes to tell what lies in the span."""
    history, until, covered = candidate.trajectory, None if math.isinf(span) else span, None
    tries = GOING_ON
    while True:
        guide = GuidedRounds(scene, history) if together else Guided(scene, history, candidate.stepped)
        own = ExactEngine().run_with(scene, guide, until=until)
        if own.stop.reason in UNKNOWING:
            raise Unfollowed(own.stop.message)
        covered = Span.of(own) if covered is None else covered
        found = align(own, history, span=covered, step=engine.step, bits=engine.bits)
        tries -= 1
        if found.verdict != "unsettled" or isinstance(engine, LogEngine) or not tries:
            return own, history, found
        if found.wanted.reference is not None and until is not None:
            until = None if math.isinf(found.wanted.reference) else max(until, found.wanted.reference)
        if found.wanted.candidate is not None:
            end = None if math.isinf(found.wanted.candidate) else found.wanted.candidate
            run = run_guarded(engine, scene, until=end, events=4 * len(own.events) + 64)
            history = check_trajectory(run, scene, candidate.engine, engine.bits)


GOING_ON = 4
"""How often both are run, each time farther on, to settle what lies at the end of the span."""


def _told(
    own: Trajectory, history: Trajectory, found: Alignment, local: LocalError | None, reach: Reach | None
) -> str | None:
    """How a history is permitted, as far as it is required; None if it is not, or if that is not settled."""
    if found.verdict == "agree":
        return TOLD
    limit = None if reach is None else reach.limit
    if limit is not None:
        parted = found.divergence
        met = found.whole.issuperset(range(limit.event)) if parted is None else limit.event <= parted.event
        if met:
            return f"{TOLD}, up to {limit}"
    if local is not None and (told := _out_of_reach(own, history, found, local)) is not None:
        return f"{TOLD}, up to event {told}"
    return None


TOLD = "each tie resolved by the policy or in an order"


@dataclass(frozen=True)
class Permission:
    """Whether some order of simultaneous impulses leads to a history.

    Attributes:
        relation: the class of its pattern.
        told: how it is permitted; None if it is not, or if that is not settled.
        settled: whether it is known that it is not.
        own: the exact run that resolves ties as it does, if there is one.
    """

    relation: PatternRelation
    told: str | None
    settled: bool
    own: OwnOrder | None


def permission(comparison: Comparison, engine: Engine, local: LocalError | None) -> Permission:
    """Whether the history of a comparison's one engine is permitted; `local` as in `in_its_own_order`."""
    (candidate,), reference = comparison.candidates, comparison.reference
    if candidate.verdict == "agree":
        told = f"the same history in {len(reference.events)} events"
        reach = None if local is None else reach_of(reference, local, in_rounds=True)
        return Permission(
            PatternRelation.OWN, told, True, OwnOrder(reference, candidate.trajectory, candidate.alignment, reach, told)
        )
    relation, found = PatternRelation.OWN, comparison.permitted
    if found is not None and candidate.pattern is not None:
        relation = found.relation(candidate.pattern)
    elif candidate.pattern is None:  # the run ends before the span does
        relation = PatternRelation.NOT_FOUND
    own = in_its_own_order(comparison.scene, candidate, engine, comparison.span, local)
    told = None if own is None else own.told
    if relation in (PatternRelation.OWN, PatternRelation.REALISABLE, PatternRelation.SOME_ORDER):
        told = relation.value
    unsettled = own is not None and own.told is None and own.alignment.divergence is None
    settled = (own is not None and own.settled) or (relation is not PatternRelation.NOT_FOUND and not unsettled)
    return Permission(relation, told and f"a history that is permitted: {told}", settled, own)


def _out_of_reach(own: Trajectory, history: Trajectory, alignment: Alignment, local: LocalError) -> str | None:
    """The decision at which a history leaves a run, if its margin is within the error of one contact."""
    parted = alignment.divergence
    if parted is None:
        return None
    size = max(abs(float(x)) for circle in own.scene.circles for x in (circle.x, circle.y, circle.r))
    reader = RunReader(own)
    for decision in decisions(own, history, alignment):
        value = reader.value(decision)
        if value is None:
            continue
        margin = max(map(abs, double_bounds(value)))
        room = local.unit * (size if decision.kind == "hit" else parted.time)
        if margin <= room:
            pair = " and ".join(f"{one.body} with {one.partner}" for one in decision.pairings)
            return (
                f"{parted.event} (t = {parted.time:.9g}): the meeting of {pair} is decided there by {margin:.3g}, "
                f"which the error of a single contact reaches: {room:.3g}"
            )
    return None
