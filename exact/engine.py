"""The exact engine: certified collision histories."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from flint import ctx  # type: ignore[attr-defined]

from ..scenarios.engine import horizon
from ..scenarios.quantity import QuantityLike
from ..scenarios.scene import Scene
from ..scenarios.trajectory import Event, OnProgress, Pocketing, Reversal, StopReason, Trajectory
from .certify import CertifiedLoop, contact_of
from .event_loop import Limits
from .evidence import prover_for
from .motion import ExactMotion
from .policies import Policy
from .value import ExactValue, Program


@dataclass(frozen=True)
class ExactEngine:
    """Runs a scene so that every event, its order and its partners are proved.

    Attributes:
        max_bits: precision beyond which a sign that is still not known is called undecided.
        ties: what is taken for a zero that is not proved: `proved` nothing, `probable` evidence by residues,
            `assume:BITS` agreement to so many bits. What follows from such a zero is marked as resting on it.

    >>> from truebreak.scenarios import Circle, Scene
    >>> run = ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)]))
    >>> run.events[0].time.text(), run.stop.reason.name
    ('-sqrt(3) + 4', 'QUIET')
    """

    max_bits: int = 1 << 20
    ties: str = "proved"

    @property
    def name(self) -> str:
        """The engine's name."""
        return "exact"

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """The certified history up to a time, a number of instants, or both (see `Engine.run`).

        With a reversal in the scene and no limit from the caller, the run ends at the return to the start: twice
        the time of the reversal.

        Raises:
            SceneError: for limits that are not above zero, or an unknown setting.
        """
        return self.run_with(scene, None, until=until, events=events, progress=progress)

    def run_with(
        self,
        scene: Scene,
        policy: Policy | None,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """As `run`, with a policy of the caller's in place of the scene's."""
        limits = run_limits(scene, until, events)
        prover = prover_for(scene, self.ties)
        saved = ctx.prec
        try:
            loop = CertifiedLoop(scene, limits, progress, self.max_bits, prover, policy)
            stop = loop.run()
        finally:
            ctx.prec = saved
        return self._trajectory(scene, loop, limits, stop)

    def _trajectory(self, scene: Scene, loop: CertifiedLoop, limits: Limits, stop: Any) -> Trajectory:
        history = loop.history
        program = Program(scene, history.steps, loop.live.bits)
        ids = scene.ids
        events = []
        for index, record in enumerate(history.records):
            body = record.source
            time = ExactValue(program, record.step, (body,), _clock(body), record.time)
            contacts = tuple(contact_of(ids, link) for link in record.links)
            impulses = tuple(contact_of(ids, link) for link in record.impulses)
            events.append(Event(index, time, contacts, impulses, record.ties, record.coupled))
        reversal = None
        notes: tuple[str, ...] = ()
        returned = False
        if history.reversal is not None:
            after, moment, step = history.reversal
            flip_time = ExactValue(program, step, (0,), lambda m: m.flip_time, moment)
            reversal = Reversal(after, flip_time)
        if stop.reason is StopReason.HORIZON and limits.to_return and reversal is not None:
            _, moment, step = history.reversal  # type: ignore[misc]
            end: Any = ExactValue(program, step, (0,), lambda m: m.flip_time + m.flip_time, moment + moment)
            returned = retraced(history.steps, len(scene.circles))
            notes = (_return_note(returned),)
        elif stop.reason is StopReason.HORIZON:
            end = limits.until
        else:
            end = events[-1].time if events else ExactValue(program, 0, (0,), _clock(0), history.knots[0][0][0])
        motion = ExactMotion(program, history.knots, end, returned)
        plan = {**dict(sorted(history.plan.items())), "bits": loop.live.bits}
        return Trajectory(
            scene=scene,
            engine=self.name,
            parameters={"max_bits": self.max_bits, "ties": self.ties},
            events=tuple(events),
            stop=stop,
            final_time=end,
            motion=motion,
            reversal=reversal,
            pocketings=tuple(
                Pocketing(str(ids[p.circle]), str(scene.pockets[p.pocket].id), _entry(program, p))
                for p in history.pocketings
            ),
            assumptions=tuple(loop.assumptions),
            plan=plan,
            notes=notes,
        )


def _entry(program: Program, pocketing: Any) -> ExactValue:
    link = (pocketing.circle, -1 - pocketing.pocket)

    def time(machine: Any) -> Any:
        clock, wait = machine.hit(link)
        return clock + wait

    return ExactValue(program, pocketing.step, (pocketing.circle,), time, pocketing.time)


def _clock(body: int) -> Any:
    return lambda machine: machine.bodies[body].instant


def run_limits(scene: Scene, until: QuantityLike | None, events: int | None) -> Limits:
    """The limits of an event-driven run, with the return of a reversed one as its default end."""
    time, count = horizon(scene, until, events)
    reversing = scene.reverse_after is not None or scene.reverse_at is not None
    own = until is not None or events is not None or scene.until is not None or scene.events is not None
    if reversing and not own:
        return Limits(None, None, to_return=True)
    return Limits(time, count)


def _return_note(returned: bool) -> str:
    if returned:
        return (
            "came back to the start exactly: after the reversal every circle met the same partners in reverse "
            "order, and each impulse undoes itself, so every position is the one at time 0 and every velocity "
            "its negative"
        )
    return "did not retrace its way: an instant with several contacts is not undone by its own reversal"


def retraced(steps: Any, n: int) -> bool:
    """Whether, after the one reversal of a log, every body's kicks are those before it in reverse order.

    Each kick is a linear map of velocities that is its own inverse at the same positions, so by induction over
    the kicks, latest first, every state on the way back is that on the way there with velocities negated.
    """
    from .machine import Flip, Kick

    k = next(k for k, step in enumerate(steps) if isinstance(step, Flip))
    before: list[list[Any]] = [[] for _ in range(n)]
    after: list[list[Any]] = [[] for _ in range(n)]
    for place, step in enumerate(steps):
        if isinstance(step, Kick):
            for i in {i for link in step.links for i in link if i < n}:
                (before if place < k else after)[i].append(step.links)
    return all(there == back[::-1] for there, back in zip(before, after, strict=True))
