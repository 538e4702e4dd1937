"""Follows all orders of impulses as `all_orders` does, and ends when the user's seconds are over, or at Ctrl-C."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...scenarios.errors import TimeIsUp
from ...scenarios.trajectory import Stop, StopReason
from ..deadline import Clock, time_limit, uninterrupted
from .all_orders import DEFAULT_CAP, DEFAULT_SAMPLES, OrderTree, all_orders
from .scripted import BranchDone, Scripted

if TYPE_CHECKING:
    from ...exact.simulation.policies import Policy
    from ...scenarios.numbers.quantity import QuantityLike
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress, Trajectory
    from .all_orders import Runner


@dataclass(frozen=True)
class Search:
    """What came of following the orders.

    Attributes:
        tree: the outcomes, every one of them whole.
        stop: why more were not looked for, if it was the time.
    """

    tree: OrderTree
    stop: Stop | None = None


class Attended:
    """An engine for `all_orders`, whose runs are taken for outcomes only if they went to their own end.

    Once the seconds are over, or so many runs were made, it has no more outcomes: a branch ends at once, and a draw
    repeats what is known.

    Attributes:
        cut: whether that has happened.
        drawn: how many orders were drawn at random before.
    """

    def __init__(self, engine: Runner, watch: Clock | None = None, runs: int | None = None) -> None:
        self._engine = engine
        self._left = runs
        self._watch = Clock(None) if watch is None else watch
        self._last: Trajectory | None = None
        self.cut = False
        self.drawn = 0

    def run_with(
        self,
        scene: Scene,
        policy: Policy | None,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """As the engine's own.

        Raises:
            KeyboardInterrupt: if the user interrupts the run.
        """
        if not self._watch.over and self._left != 0:
            self._left = None if self._left is None else self._left - 1
            watched = self._watch.watched(progress)
            try:
                run = uninterrupted(self._engine.run_with(scene, policy, until=until, events=events, progress=watched))
            except TimeIsUp:  # before the run has begun, say; what was found before stays
                run = None
            if run is not None and not (run.stop.reason is StopReason.BUDGET and self._watch.over):
                self._last = run
                self.drawn += not isinstance(policy, Scripted)
                return run
        self.cut = True
        if isinstance(policy, Scripted) or self._last is None:
            raise BranchDone("out of time")
        return self._last


def search_orders(
    engine: Runner,
    scene: Scene,
    *,
    until: QuantityLike | None = None,
    events: int | None = None,
    cap: int = DEFAULT_CAP,
    samples: int = DEFAULT_SAMPLES,
    seed: int = 0,
    max_seconds: float | None = None,
    progress: OnProgress | None = None,
) -> Search:
    """`all_orders`, and what it has found if the seconds are over before.

    Raises:
        SceneError: as `all_orders`, and for seconds that are not above zero.
        KeyboardInterrupt: if the user interrupts it.
    """
    with time_limit(max_seconds) as watch:
        attended = Attended(engine, watch)
        tree = all_orders(
            attended, scene, until=until, events=events, cap=cap, samples=samples, seed=seed, progress=progress
        )
    if not attended.cut:
        return Search(tree)
    reason = StopReason.BUDGET
    return Search(
        replace(tree, complete=False, sampled=attended.drawn), Stop(reason, f"{reason.value}: {watch.is_up()}")
    )
