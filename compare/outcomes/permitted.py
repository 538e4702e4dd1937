"""Which patterns the physics permits, in four classes.

Where several contacts fall on one instant and their order matters, nearby scenes in which they do not come to
different ends. The policy names one outcome; the sequential orders are a superset of what nearby scenes do; and the
default policy's own outcome may be the limit of none.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import TYPE_CHECKING, Any, TypeAlias

from flint import fmpq

from ...exact.numbers import ball
from ...exact.replay.contact import Sides, is_flat, touching_at_start
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity, real
from ...scenarios.things import Circle
from ...scenarios.trajectory import StopReason, Trajectory
from ..deadline import OutOfTime
from ..orders.all_orders import Attended, Runner, all_orders
from ..orders.guided import Guided
from .outcome import pattern as pattern_of

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress
    from ..certificate.certified import Certified
    from ..study import Study

Pattern: TypeAlias = "Mapping[str, Any]"

POLICIES = ("simultaneous", "sequential:order=scene")
"""Policies whose patterns are always told."""

ORDER_WORK = 6_000
"""Events times circles that following the orders may take: some seconds of the exact engine."""

LEAST_RUNS = 96
"""Runs that are made in any case, those included whose branch comes to a state that is known."""

ORDER_SIGNS = 12
"""Signs that these runs may prove in nested roots, which take as long as a hundred events."""

LEAST_CAP, GREATEST_CAP = 8, 256
"""Least and greatest number of outcomes that are followed."""

QUESTION_WORK = 20_000
"""Counted work that one question may take in these runs: what is not told by then leaves them incomplete."""

SAMPLE_SHARE = 4
"""Beyond the cap, one order is drawn at random for this many outcomes followed."""

DECIDED = (StopReason.HORIZON, StopReason.EVENTS, StopReason.QUIET)


class PatternRelation(Enum):
    """What a candidate's pattern is; the value is what a person reads."""

    OWN = "the policy's own"
    REALISABLE = "realisable: a nearby scene does it"
    SOME_ORDER = "some order of the impulses leads to it, no nearby scene that was tried does"
    NO_ORDER = "no order of the impulses leads to it"
    NOT_FOUND = "not found among the orders followed; there are more"


@dataclass(frozen=True)
class PermittedPatterns:
    """Patterns over the exact span: the policy's own, those of nearby scenes, and of all sequential orders.

    Attributes:
        exact: the pattern under the scene's own policy.
        by_policy: the pattern under each named policy.
        orders: the distinct patterns over the sequential orders followed.
        complete: whether those are all orders.
        followed: how many orders, or draws, were followed.
        witnesses: nearby scenes, each with its certified pattern.
        tried: how many nearby scenes were tried.
    """

    exact: Pattern
    by_policy: Mapping[str, Pattern] = field(default_factory=dict)
    orders: tuple[Pattern, ...] = ()
    complete: bool = True
    followed: int = 0
    witnesses: tuple[Witness, ...] = ()
    tried: int = 0

    def relation(self, pattern: Pattern) -> PatternRelation:
        """The class of a pattern."""
        if pattern == self.exact:
            return PatternRelation.OWN
        if self.witness(pattern) is not None:
            return PatternRelation.REALISABLE
        if pattern in self.orders:
            return PatternRelation.SOME_ORDER
        return PatternRelation.NO_ORDER if self.complete else PatternRelation.NOT_FOUND

    def witness(self, pattern: Pattern) -> Witness | None:
        """A nearby scene that comes to a pattern."""
        return next((w for w in self.witnesses if w.pattern == pattern), None)

    def policy(self, pattern: Pattern) -> str | None:
        """The named policy that leads to a pattern, if one does."""
        return next((policy for policy, other in self.by_policy.items() if other == pattern), None)


def permitted_patterns(
    study: Study,
    histories: Sequence[tuple[Trajectory, bool]] = (),
    progress: OnProgress | None = None,
    *,
    wanted: Sequence[Pattern] = (),
) -> PermittedPatterns | None:
    """The patterns under each policy, of nearby scenes, and over all sequential orders, over the reference's span.

    A pattern is whom each circle met, and on a table where it ended. None if the reference engine takes no policy from
    its caller.

    Args:
        histories: runs, and whether each goes by time steps. Their own order of impulses is followed as far as the
            exact engine allows it, so that a pattern is found even where the orders are too many to enumerate.
        wanted: the patterns whose class is asked; with none, those of the histories.
    """
    reference, scene, truth = study.reference, study.scene, _thrifty(study.truth)
    if not isinstance(truth, Runner):
        return None
    exact = pattern_of(reference)
    by_policy: dict[str, Pattern] = {str(scene.tie_policy): exact}
    if not any(event.coupled for event in reference.events):
        return PermittedPatterns(exact, by_policy, (exact,), True, 1)
    span = _ExactSpan(reference)
    patterns: list[Pattern] = []
    witnesses: list[Witness] = []
    complete, followed, tried = False, 0, 0
    wanted = wanted or [pattern_of(span.cut(history)) for history, _ in histories]
    try:
        for policy in POLICIES:
            if policy not in by_policy:
                pattern = span.pattern(study.run(truth, scene.with_changes(tie_policy=policy), span.past, progress))
                if pattern is not None:
                    by_policy[policy] = pattern
        for history, stepped in histories:
            guide = Guided(scene, history, stepped)
            run = truth.run_with(scene, guide, until=span.past, progress=study.watch.watched(progress))
            _add(patterns, span.pattern(run))
        work = max(1, len(reference.events) * len(scene.circles))
        cap = max(LEAST_CAP, min(GREATEST_CAP, ORDER_WORK // work))
        attended = Attended(truth, study.watch, max(LEAST_RUNS, ORDER_WORK // work), ORDER_SIGNS)
        tree = all_orders(
            attended, scene, until=span.past, cap=cap, samples=cap // SAMPLE_SHARE, progress=progress, ends=False
        )
        found = [span.pattern(outcome.trajectory) for outcome in tree.outcomes]
        complete = tree.complete and None not in found and not attended.cut
        followed = len(tree.outcomes)
        for pattern in found:
            _add(patterns, pattern)
        for nearby in nearby_scenes(scene, work):
            if all(any(w.pattern == p for w in witnesses) for p in wanted if p != exact):
                break
            tried += 1
            try:
                run = study.run(truth, nearby, span.beyond, progress)
            except SceneError:
                continue
            told = span.patterns_of_nearby(run)
            pattern = next((p for p in told if p in wanted and p != exact), told[0] if told else None)
            if pattern is not None and run.certified and not any(w.pattern == pattern for w in witnesses):
                witnesses.append(Witness(nearby, pattern, run))
    except OutOfTime:
        complete = False
    return PermittedPatterns(exact, by_policy, tuple(patterns), complete, followed, tuple(witnesses), tried)


TIE_ENDS = 2.0**-10
"""By what share of its time an engine may take the rest of a tie later."""


def pattern_at_the_end(
    found: PermittedPatterns, pattern: Pattern, history: Trajectory, reference: Trajectory, late: float
) -> Pattern:
    """A pattern that no order leads to as orders are cut: at the end of the span, whatever comes late for it.

    If the span ends at a tie, an engine may take that one by one, some ulps or steps later: then of the history a
    little farther on. The pattern itself, if no order leads to those either.

    Args:
        late: how much later an engine of steps may be.
    """
    events, end = reference.events, float(reference.final_time)
    if found.relation(pattern) is not PatternRelation.NO_ORDER:
        return pattern
    tie = bool(events) and events[-1].coupled and float(events[-1].time) == end
    last = end + TIE_ENDS * end + late if tie else end
    for count, event in enumerate(history.events, 1):
        following = history.events[count] if count < len(history.events) else None
        whole = following is None or float(following.time) > end
        if float(event.time) <= last and (whole or (tie and float(event.time) == end)):
            known = min(max(end, float(event.time)), float(history.final_time))
            heard = replace(history, events=history.events[:count], final_time=known)
            if found.relation(other := pattern_of(heard)) is not PatternRelation.NO_ORDER:
                return other
    return pattern


def _thrifty(truth: Engine) -> Engine:
    """The reference engine with less work for each question, if it counts any."""
    work = getattr(truth, "work", None)
    if not dataclasses.is_dataclass(truth) or not isinstance(work, int):
        return truth
    thrifty: Any = dataclasses.replace(truth, work=min(work, QUESTION_WORK))
    return thrifty


def _add(patterns: list[Pattern], pattern: Pattern | None) -> None:
    if pattern is not None and pattern not in patterns:
        patterns.append(pattern)


class _ExactSpan:
    """The end of the reference's run, exactly: an event on it belongs to the span, one after it does not.

    Attributes:
        past: a time to which other runs are made: the end itself if it is a set time, else a little past it.
        beyond: a little past it, to which nearby scenes are run: what falls on the end falls beside it there.
    """

    def __init__(self, reference: Trajectory) -> None:
        self.end: Any = reference.final_time
        self.set = isinstance(self.end, Quantity)
        self.open = reference.stop.reason is StopReason.QUIET
        self.beyond: float = float(self.end) * (1 + PAST)
        self.past: Any = self.end if self.set else self.beyond
        self.event_at_end = bool(reference.events) and not self._before(reference.events[-1].time)

    def pattern(self, run: Trajectory) -> Pattern | None:
        """The pattern of a run that went to the end of the span."""
        return pattern_of(self.cut(run)) if run.stop.reason in DECIDED else None

    def cut(self, run: Trajectory) -> Trajectory:
        """A run up to the end."""
        if self.set and run.final_time is self.end:
            return run
        events = tuple(event for event in run.events if not self._after(event.time))
        ended = run.final_time if float(run.final_time) < float(self.end) else float(self.end)
        return replace(run, events=events, final_time=ended)

    def patterns_of_nearby(self, run: Trajectory) -> Sequence[Pattern]:
        """The patterns of a nearby scene's run up to the end, and to just past it, where that is another.

        First the one that has as much as the span, if an event falls on its end.
        """
        if run.stop.reason not in DECIDED:
            return []
        past = run if float(run.final_time) <= self.beyond else replace(run, final_time=self.beyond)
        told = [pattern_of(self.cut(run)), pattern_of(past)]
        return told[::-1] if self.event_at_end else told

    def _before(self, time: Any) -> bool:
        """Whether a time is before the end by more than a nearby scene is late."""
        return float(time) < float(self.end) * (1 - PAST)

    def _after(self, time: Any) -> bool:
        """Whether a time is after the end; one that agrees with it to `SAME_BITS` bits is on it.

        Rounding to the nearest double keeps the order, so that unequal doubles tell.
        """
        near, end = float(time), float(self.end)
        if near != end:
            return near > end
        return ball.sign_of(real(time).ball(SAME_BITS) - real(self.end).ball(SAME_BITS)) == 1


PAST = 2.0**-30
"""Share of the span by which other runs go past an end that is no set time; what they have there is cut off."""

SAME_BITS = 1024
"""Bits to which times of different runs are compared: an event on the end itself agrees with it to any number."""


# ----------------------------------------
# Scenes beside a scene, in which what falls on one instant there comes apart: witnesses of what is realisable.

NEARBY = fmpq(1, 10**20)
"""Largest displacement of a coordinate: far below what moves any later event noticeably."""

GRAIN = 1000
"""Displacements are drawn in steps of `NEARBY` divided by this."""

WITNESS_WORK = 3_000
"""Events times circles that trying nearby scenes may take."""

LEAST_TRIED, MOST_TRIED = 8, 32


@dataclass(frozen=True)
class Witness:
    """A nearby scene and the break pattern that the exact engine certifies for it.

    Attributes:
        run: the run that came to it.
        certificate: that of the run, if it was asked for and there is one.
    """

    scene: Scene
    pattern: Mapping[str, Any]
    run: Trajectory = field(repr=False, compare=False)
    certificate: Certified | None = field(default=None, repr=False, compare=False)


def nearby_scenes(scene: Scene, work: int) -> Iterator[Scene]:
    """Scenes whose circles are displaced by up to `NEARBY`, drawn from seeds 0, 1, ...; those that overlap left out.

    Radii are smaller by twice that, so that circles that touch come apart.

    Args:
        work: what one run takes, in events times circles.
    """
    for seed in range(max(LEAST_TRIED, min(MOST_TRIED, WITNESS_WORK // max(work, 1)))):
        try:
            yield nearby(scene, seed)
        except SceneError:
            continue


def nearby(scene: Scene, seed: int) -> Scene:
    """One nearby scene; what lies on a level wall that carries it, or slides along it, does so there.

    Raises:
        SceneError: if its circles overlap.

    >>> from truebreak.scenarios import Scene
    >>> nearby(Scene([Circle(0, 0, id="a")]), 1).circles[0].r.text()
    '49999999999999999999/50000000000000000000'
    """
    from random import Random

    draw, lying = Random(seed), _lying(scene)
    circles = []
    for k, c in enumerate(scene.circles):
        moved = [NEARBY * draw.randint(-GRAIN, GRAIN) / GRAIN for _ in range(2)]
        x, y = (c.x, c.y) if c.fixed else (c.x + moved[0], c.y + moved[1])
        if k in lying:
            nx, ny = lying[k]
            along = nx * moved[1] - ny * moved[0]
            down = 0 if c.point else 2 * NEARBY
            x, y = c.x - ny * along - nx * down, c.y + nx * along - ny * down
        r = c.r if c.point else c.r - 2 * NEARBY
        circles.append(Circle(x, y, r, c.vx, c.vy, m=c.m, id=c.id, point=c.point))
    return scene.with_changes(circles=circles, name=f"{scene.name}, nearby {seed}")


def _lying(scene: Scene) -> dict[int, tuple[Quantity, Quantity]]:
    """The circles that a level wall or face carries from the start, each with the way up from that, of length 1."""
    found: dict[int, tuple[Quantity, Quantity]] = {}
    seen = scene.surfaces
    sides = Sides(seen)
    for link in touching_at_start(seen) if scene.settle else ():
        if not is_flat(link) or link.circle >= len(scene.circles):
            continue
        circle, (nx, ny) = scene.circles[link.circle], seen.walls[link.wall].normal
        stays = (nx * circle.vx + ny * circle.vy).sign() == 0
        if stays and sides.pull(link.circle, link.wall) < 0 and sides.level(link.wall):
            length = (nx * nx + ny * ny).sqrt() * (-1 if sides.negative(link.circle, link.wall) else 1)
            found.setdefault(link.circle, (nx / length, ny / length))
    return found
