"""Whether another setting passes: a finer step, more iterations, more bits, a budget; what stops at an exact zero."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations, product, starmap
from typing import TYPE_CHECKING, Any, cast

from ...exact.laws import formulas as law
from ...exact.laws.formulas import pair_approach, pair_discriminant, pair_gap, wall_approach, wall_gap
from ...exact.replay.landings import double_zeros_exactly
from ...exact.replay.round_falls import gap_quartic
from ...scenarios.arcs import NearSide
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import ZERO, Quantity, real
from ...scenarios.trajectory import StopReason
from ..alignment.align import align
from ..alignment.instants import NEARER, Kind, instants, velocity_difference
from ..alignment.walk import REPEATED, history
from ..audit.passages import passes_between
from ..deadline import NO_TIME
from ..foreign.guard import cut_short, finer_of, firmer_of, wider_of
from ..study import finer_by, series_steps
from ..validation import EngineError
from .budget import accounted
from .diagnosis import CauseName, Diagnosis, Experiment, diagnosed
from .free_flights import ExactFlight, OwnFlight, apart_at, exact_flight, is_zero, resting
from .laboratory import decisions

if TYPE_CHECKING:
    from ...scenarios.arcs import ArcSide
    from ...scenarios.engine import Engine
    from ...scenarios.things import Wall
    from ...scenarios.trajectory import OnProgress, Trajectory
    from ..alignment.align import Alignment
    from ..candidate import Candidate
    from ..study import Study
    from .laboratory import Laboratory

# -- Engines of steps.

MOST_HALVINGS = 8
"""A time step is halved up to so many times, as far as `series_steps` allow; once more where only the last agrees."""


def by_finer_steps(lab: Laboratory, told: str) -> Diagnosis:
    """Why two histories part, of an engine of steps in a scene of which there is no account: what runs show alone.

    Args:
        told: why there is no account.
    """
    lab.accounted = told
    rows: list[Experiment] = []
    for name, function in (("STEP", step), ("ITERATIONS", iterations)):
        rows += lab.tried(partial(function, lab, rows), [Experiment(CauseName[name], NO_TIME)])
    found = diagnosed(rows, None, None, 0)
    unknown = CauseName["UNKNOWN"]
    if found.name is not unknown:
        return found
    return Diagnosis((unknown,), (*rows, Experiment(unknown, told, None, True)), told)


def step(lab: Laboratory, rows: Sequence[Experiment]) -> list[Experiment]:
    """The step halved again and again, for an engine that takes steps, as far as counted work allows."""
    if lab.engine.step is None:
        return []
    until, told = lab.until(lab.engine.step), list[str]()
    agrees: list[bool] = []
    why = f"a finer step takes more than {series_steps(lab.engine):,} steps"
    for halvings in range(1, MOST_HALVINGS + 2):
        finer, once = finer_by(lab.engine, halvings), agrees[-2:] in ([True], [False, True])
        if finer is None or finer.step is None:
            break
        if not once and (halvings > MOST_HALVINGS or until > series_steps(finer) * finer.step):
            break  # one that agrees is not enough: it may do so by chance
        try:
            run = lab.run(finer, lab.study.scene, until)
        except EngineError as refused:  # that is evidence of nothing
            why = f"a step of {finer.step:.3g} cannot be judged: {refused}"
            break
        if ends_early(lab, run, until, finer.step):
            why = f"with a step of {finer.step:.3g} it ends at time {float(run.final_time):.6g}"
            break
        agrees.append(gone(lab, run, finer.step))
        told.append(f"{finer.step:.3g}")
        if agrees[-2:] == [True, True] and not _by_chance(lab):
            break
    if not agrees and finer_of(lab.engine) is None:
        return [Experiment(CauseName["STEP"], f"not tried: {lab.name} has no finer step to offer")]
    if not agrees:
        return [Experiment(CauseName["STEP"], f"not tried: {why}")]
    first = agrees.index(True) if True in agrees else len(agrees)
    twice = agrees[-2:] == [True, True] or (agrees[-1] and finer_by(lab.engine, len(agrees) + 1) is None)
    enough = twice and (all(agrees[first:]) or not _by_chance(lab))
    runs = [f"{size} {'agrees' if flag else 'differs'}" for size, flag in zip(told, agrees, strict=True)]
    if first > 1 and all(agrees[first:]):
        runs = [f"{told[0]} to {told[first - 1]} differs", *runs[first:]]
    return [Experiment(CauseName["STEP"], f"a step of {', '.join(runs)}", None, enough)]


def _by_chance(lab: Laboratory) -> bool:
    """Whether finer steps that agree may do so by chance: rounding decides, and what is of the step does not."""
    account = accounted(lab)
    return not isinstance(account, str) and lab.margin is not None and account.is_of_rounding(float(lab.margin.mid()))


def iterations(lab: Laboratory, rows: Sequence[Experiment]) -> list[Experiment]:
    """Four times as many iterations of the solver, and sixteen, for an engine that takes steps."""
    cause, more = CauseName["ITERATIONS"], firmer_of(lab.engine)
    if lab.engine.step is None:
        return []
    if more is None:
        return [Experiment(cause, "it iterates nothing", None, False)]
    last = lab.divergence.time + REPEATED * lab.engine.step
    earlier = [e for e in lab.candidate.trajectory.events if float(e.time) <= last]
    laws = lab.candidate.laws
    iterated = laws is not None and any(defect.kind == "iterations" for defect in laws.defects)
    if not iterated and not any(len(e.contacts) > 1 for e in earlier):
        return [Experiment(cause, "no step had several contacts", None, False)]
    until, most = lab.until(lab.engine.step), series_steps(lab.engine)
    if until > most * lab.engine.step:
        return [Experiment(cause, f"not tried: it takes more than {most:,} steps")]
    told, agrees = list[str](), False
    for times in ("four", "sixteen"):
        more = firmer_of(firmer_of(more) or more) or more if told else firmer_of(more) or more
        try:
            run = lab.run(more, lab.study.scene, until)
        except EngineError as refused:
            return [Experiment(cause, f"not tried: with {times} times as many it cannot be judged: {refused}")]
        if ends_early(lab, run, until, more.step):
            return [Experiment(cause, f"not tried: with {times} times as many it ends at {float(run.final_time):.6g}")]
        agrees = gone(lab, run, more.step)
        told.append(f"with {times} times as many it {'agrees' if agrees else 'differs too'}")
        if agrees:
            break
    return [Experiment(cause, ", ".join(told), None, agrees)]


def tunnelling(lab: Laboratory, rows: Sequence[Experiment]) -> list[Experiment]:
    """Whether two that should meet overlap between two ends of steps, or have come as near as they do by the later."""
    cause, step = CauseName["TUNNELLING"], lab.engine.step
    if step is None:
        return []
    missed = [d for d in decisions(lab.reference, lab.candidate.trajectory, lab.candidate.alignment) if d.kind == "hit"]
    for decision in missed:
        if decision.first.partner != lab.divergence.expected:
            continue
        stay = lab.own.stay(decision.first)
        if stay is None or not math.isfinite(stay[1]):
            continue
        enter, leave = stay
        if lab.divergence.got_time is not None and lab.divergence.got_time < enter:
            continue  # what it has too much comes before
        base = 0.0
        reversal = lab.candidate.trajectory.reversal
        if reversal is not None and lab.study.scene.reverse_at is not None and float(reversal.time) < enter:
            base = float(reversal.time)
        body, partner = decision.first.body, decision.first.partner
        told, through = f"{body} and {partner} overlap for {leave - enter:.3g}, a step takes {step:.3g}", False
        if leave <= enter:
            told, through = f"{body} and {partner} have no thickness: they overlap at no step's end", True
        elif passes_between(enter, leave, step, base):
            told, through = f"{told}, and none ends in between: one passes through the other", True
        elif passes_between(enter, (enter + leave) / 2, step, base):
            told = f"{told}, and by the end of a step in between they part again: one passes through the other"
            through = True
        return [Experiment(cause, told, None, through)]
    return [Experiment(cause, "no circle that it should meet is passed through", None, False)]


def ends_early(lab: Laboratory, run: Trajectory, until: float, step: float | None) -> bool:
    """Whether an engine has ended a run of its own accord before it was asked to, and has not diverged by then: that is
    evidence of nothing."""
    if not cut_short(run, until):
        return False
    return align(lab.reference, run, span=lab.passing, step=step, bits=lab.engine.bits).divergence is None


def gone(lab: Laboratory, run: Trajectory, step: float | None) -> bool:
    """Whether a variant does not have the divergence.

    Where velocities after one exact instant are in question, they must have come nearer by what a series demands.
    """
    alignment = align(lab.reference, run, span=lab.passing, step=step, bits=lab.engine.bits)
    if lab.divergence.kind is Kind.TIE:
        own = _difference(lab, lab.candidate.trajectory, lab.candidate.alignment)
        nearer = _difference(lab, run, alignment)
        if own is not None:
            return nearer is not None and nearer <= own / NEARER
        return alignment.divergence is None or alignment.divergence.expected_event > lab.divergence.expected_event
    found = alignment.divergence
    if lab.divergence.kind is Kind.MISSING or lab.divergence.kind is Kind.DIFFERENT:
        event = lab.divergence.expected_event
        for name in {name for pair in lab.reference.events[event].contacts for name in pair} & alignment.walks.keys():
            walked = alignment.walks[name]  # of several contacts of the instant, each has to be met
            if event not in {m for m, _ in walked.pairs}:
                return False
            if walked.mismatch is not None and walked.mismatch.mine == event:
                return False
    return found is None or found.event > lab.divergence.event


def _difference(lab: Laboratory, run: Trajectory, alignment: Alignment) -> float | None:
    """How far the velocities after the instant in question are from the exact ones; None if it is not one instant."""
    event = lab.divergence.expected_event
    for found in instants(alignment.walks):
        if event in found.mine:
            return velocity_difference(lab.reference, run, found) if len(found.mine) == 1 else None
    return None


# -- Engines that stopped where the reference goes on: a refusal, a budget, their width, or an exact zero.


@dataclass(frozen=True)
class Stopped:
    """A candidate that could not decide, with what it takes to ask why."""

    study: Study
    candidate: Candidate
    engine: Engine
    progress: OnProgress | None = None
    bits: bool = False
    """Whether to find how many bits lead to the end."""

    @property
    def message(self) -> str:
        """What it said itself."""
        return self.candidate.trajectory.stop.message

    @property
    def undecided(self) -> bool:
        """Whether it is a decision that stopped it."""
        return not self.candidate.unable and self.candidate.trajectory.stop.reason is StopReason.UNDECIDED

    @property
    def widens(self) -> bool:
        """Whether it is a decision that stopped it, and wider numbers can be tried."""
        return self.undecided and wider_of(self.engine) is not None

    @property
    def event(self) -> int:
        """How far it came."""
        return len(self.candidate.trajectory.events)

    @property
    def reference(self) -> Trajectory:
        """The longest run of the reference."""
        return self.study.longest or self.study.reference


def diagnosis_of_stop(stopped: Stopped) -> Diagnosis:
    """Why a candidate stopped: what it refuses, its budget, its width, or a zero that no width decides."""
    rows: list[Experiment] = []
    for tried in (unable, budget, tied, width):
        rows += tried(stopped)
        if rows and rows[-1].suffices:
            return Diagnosis((rows[-1].cause,), tuple(rows), rows[-1].result)
    unknown = CauseName["UNKNOWN"]
    if not rows:
        message = stopped.message
        return Diagnosis((unknown,), (Experiment(unknown, message, None, True),), message)
    return Diagnosis((unknown,), tuple(rows), f"{rows[-1].result}, and no number is proved to be zero")


def unable(stopped: Stopped) -> list[Experiment]:
    """A scene that an engine refuses, or of which it declares that it does not follow one of its keys."""
    return [Experiment(CauseName["UNABLE"], stopped.message, None, True)] if stopped.candidate.unable else []


def budget(stopped: Stopped) -> list[Experiment]:
    """A budget of steps, events, work or seconds: what the engine said, where it was no decision that stopped it."""
    if stopped.undecided or stopped.candidate.unable:
        return []
    return [Experiment(CauseName["BUDGET"], stopped.message, None, True)]


def tied(stopped: Stopped) -> list[Experiment]:
    """Whether several contacts fall on the exact instant at which it stopped, and twice the bits stop there too.

    Wider numbers are tried once: it may have stopped for something else, and numbers that are exact tell ties apart.
    """
    events, event = stopped.reference.events, stopped.event
    if not stopped.widens or event >= len(events) or len(events[event].contacts) < 2:
        return []
    past = _doubled(stopped, stopped.study.until_event(event), lambda run: len(run.events) > event, 0)
    if past.enough is not None:
        return []
    told = (
        f"several contacts fall on exactly one instant, event {event}, where enclosures overlap however wide: "
        f"with {past.short} bits it stops there too"
    )
    return [Experiment(CauseName["TIE"], told, None, True)]


# -- the width of enclosures: what wider numbers decide, found by running

WORK = 8
"""Runs as long as the engine's own that the bits may be doubled for, counted in events times the length of numbers;
under gravity its square: as many halvings as bits part two zeros of a quartic, or do not part a double one."""
LEAST_WORK = 320
"""The same in events, where its own run is short."""
SHORT_BITS = 512
"""Bits up to which an operation costs about the same, whatever their number."""
TO_THE_END = 4096
"""The same for the bits that lead to the end, where they are asked for."""
NEARLY = 2.0**-40
"""The share by which one number in doubles may be beyond another that it is not beyond."""
FAR = 3
"""How often the bits are doubled at once beside a number that is proved to be zero: one run says which it is."""
SPARE_BITS = 48
"""Bits more than those that were lost by the end: the last decisions need some, and one more run confirms them."""


def width(stopped: Stopped) -> list[Experiment]:
    """Whether more bits go on past the stop, at which no two contacts fall on one instant; how many, where asked.

    Where twice the bits stop there too, and one of the numbers that lead to the event is proved to be exactly zero, one
    run that is much wider says which of the two it is.
    """
    if not stopped.widens:
        return []
    event, found = stopped.event, None
    until, allowed = stopped.study.until_event(event), max(WORK * (event + 1), LEAST_WORK)
    past = _doubled(stopped, until, lambda run: len(run.events) > event, 0)
    if past.enough is None:
        found = exact_zero(stopped.reference, event)
        more = wider_of(past.tried)
        if found is not None:
            for _ in range(FAR - 1):
                more = (wider_of(more) if more else None) or more
            allowed = 0
        past = _doubled(stopped, until, lambda run: len(run.events) > event, allowed, past.tried, more)
    if past.enough is None and found is not None:
        told = f"exactly zero: {found}; no enclosure can decide it: with {past.short} bits it stops there too"
        return [Experiment(CauseName["ZERO"], told, None, True)]
    if past.enough is None:
        told = f"with {past.short} bits it stops there too{past.left}"
        return [Experiment(CauseName["WIDTH"], told, None, False)]
    told = f"with {past.enough.bits} bits it goes on past event {event}, with {past.short} it does not"
    if stopped.bits:
        told = f"{told}; {_to_the_end(stopped)}"
    elif stopped.engine.bits is not None:
        told = f"{told}; --bits finds how many lead to the end"
    return [Experiment(CauseName["WIDTH"], told, None, True)]


@dataclass(frozen=True)
class Widened:
    """What the runs of one engine with ever more bits showed.

    Attributes:
        tried: the widest that was seen not to do what is asked.
        enough: the first that does, with its run; None if none of those that were tried does.
        left: which bits were not tried, in words; empty if all were.
    """

    tried: Engine
    enough: Engine | None = None
    run: Trajectory | None = None
    left: str = ""

    @property
    def short(self) -> int | None:
        """The most bits that were seen not to do."""
        return self.tried.bits


def _doubled(
    stopped: Stopped,
    until: float,
    does: Callable[[Trajectory], bool],
    allowed: float,
    tried: Engine | None = None,
    chosen: Engine | None = None,
    ties: bool = False,
) -> Widened:
    """Doubles the bits until a run does what is asked, or the work is done that is allowed.

    Args:
        does: whether a run that is undecided does what is asked; one that is not does.
        allowed: events, of numbers of up to `SHORT_BITS` bits.
        tried, chosen: what is known not to do, and what is tried first; the engine that stopped, and the next wider.
        ties: whether to ask, where twice the bits come no farther, whether a tie is proved there, and go no wider.
    """
    if tried is None:
        tried, chosen = stopped.engine, wider_of(stopped.engine)
    before, power = -1, 1 if stopped.study.scene.gravity is None else 2
    while chosen is not None and chosen.bits is not None:
        run = stopped.study.whole_run(chosen, stopped.study.scene, until, stopped.progress)
        if run.stop.reason is not StopReason.UNDECIDED or does(run):
            return Widened(tried, chosen, run)
        allowed -= (len(run.events) + 1) * (1 + chosen.bits / SHORT_BITS) ** power
        tried = chosen
        before, come = len(run.events), before == len(run.events)
        if ties and come and (told := exact_tie(stopped.reference, before)) is not None:
            return Widened(tried, left=f"; at event {before} it stops however wide: {told}")
        if allowed <= 0:
            return Widened(tried, left="; more were not tried: the work that may be done for it is over")
        chosen = wider_of(chosen)
    return Widened(tried)


def _to_the_end(stopped: Stopped) -> str:
    """How many bits decide all that the reference has inside the span, in words.

    One run that is wide enough says how many of its bits are lost by the end; one more, with those that are not, and
    some to spare, confirms it.
    """
    end = stopped.study.span.time
    wide = _doubled(stopped, end, lambda run: False, TO_THE_END * (stopped.event + 1), ties=True)
    if wide.enough is None or wide.run is None or wide.enough.bits is None:
        return f"with {wide.short} it does not come to the end{wide.left}"
    bits = _bits_lost(wide.run, wide.enough.bits) + SPARE_BITS
    if (wide.short or 0) < bits < wide.enough.bits:
        try:
            fewer = dataclasses.replace(cast("Any", wide.enough), bits=bits)
        except (TypeError, SceneError):  # it is made with other numbers of bits only
            fewer = wide.enough
        run = stopped.study.whole_run(fewer, stopped.study.scene, end, stopped.progress)
        if run.stop.reason is not StopReason.UNDECIDED:
            return f"with {bits} it comes to the end, of which {bits - SPARE_BITS} are lost by then"
    return f"with {wide.enough.bits} it comes to the end, with {wide.short} it does not"


def _bits_lost(run: Trajectory, bits: int) -> int:
    """How many of its bits the places and velocities of a run's end have lost, beside the largest of each."""
    circles, lost = run.final.circles, 0.0
    for pair in ("x", "y"), ("vx", "vy"):
        balls = [real(getattr(circle, name)).ball(bits) for circle in circles for name in pair]
        size = max((abs(float(ball.mid())) for ball in balls), default=0.0)
        radius = max((float(ball.rad()) for ball in balls), default=0.0)
        if size and radius:
            lost = max(lost, bits + math.log2(radius) - math.log2(size))
    return math.ceil(lost)


# -- exact zeros before an event


def exact_tie(reference: Trajectory, event: int) -> str | None:
    """Why no enclosure decides an event, however narrow, in words; None if that is not proved."""
    if event < len(reference.events) and len(reference.events[event].contacts) > 1:
        return "several contacts fall on exactly one instant"
    return exact_zero(reference, event)


def exact_zero(reference: Trajectory, event: int) -> str | None:
    """What is exactly zero among the flights that lead to an event, in words; None if no zero is proved.

    Looked for are grazes, circles that touch without approaching, circles that fly parallel to a wall or a face, and
    those that meet a segment where its face becomes its end, or an arc where it ends.
    """
    flights = _flights_before(reference, event)
    radii = {str(c.id): c.r for c in reference.scene.circles}
    falls, fixed = reference.scene.gravity is not None, {str(c.id) for c in reference.scene.circles if c.fixed}
    for (one, a), (other, b) in combinations(flights.items(), 2):
        if falls and (one in fixed) is not (other in fixed):
            continue  # no two straight flights in one frame
        dx, dy, vx, vy = apart_at(a, b)
        reach = radii[one] + radii[other]
        if is_zero(pair_gap, dx, dy, reach) and is_zero(pair_approach, dx, dy, vx, vy):
            return f"{one} and {other} touch and do not approach"
        if float(pair_approach(dx, dy, vx, vy)) < 0 and is_zero(pair_discriminant, dx, dy, vx, vy, reach):
            return f"{one} and {other} graze"
    whole = reference.scene.surfaces
    for name, (*_, vx, vy) in flights.items():
        for wall in whole.walls:
            ux, uy = vx - wall.vx, vy - wall.vy
            along = whole.gravity is None or is_zero(wall_approach, *whole.gravity, *wall.normal)
            if along and (ux.sign() or uy.sign()) and is_zero(wall_approach, ux, uy, *wall.normal):
                return f"{name} flies parallel to {wall.id}"
    if reference.scene.moving_solid is not None:  # whose ends and faces are where they move to
        return None
    if falls:
        return next(
            (told for told in starmap(partial(_zero_of_a_fall, reference, event), flights.items()) if told), None
        )
    for (name, flight), k in product(flights.items(), whole.ends):
        end = whole.circles[k]
        apart = apart_at(flight, resting(end))
        if float(pair_approach(*apart)) < 0 and is_zero(pair_discriminant, *apart, radii[name] + end.r):
            return f"{name} grazes an end of {end.id}"
    for (name, flight), k in product(flights.items(), whole.faces):
        if _meets_an_end_of(flight, whole.walls[k], radii[name]):
            return f"{name} meets {whole.walls[k].id} where a face becomes an end"
    for name, flight in flights.items():
        for side in whole.arc_sides:
            zero = _zero_at_side(flight, side, radii[name])
            if zero is not None:
                return f"{name} {zero}"
    return None


def _zero_of_a_fall(reference: Trajectory, event: int, name: str, flight: ExactFlight) -> str | None:
    """What is exactly zero of a circle that falls and of what stands, no later than an event: a double zero of their
    gap, or the place along a face at which it comes to its line."""
    scene = reference.scene
    circle = next(c for c in scene.circles if c.id == name)
    if circle.fixed or scene.gravity is None:
        return None
    whole, (hx, hy), (t, x, y, vx, vy) = scene.surfaces, (part / 2 for part in scene.gravity), flight
    x, y, vx, vy = x + hx * t * t, y + hy * t * t, vx + hx * t * 2, vy + hy * t * 2  # where it truly is
    last = float(reference.events[event].time) if event < len(reference.events) else math.inf

    def in_time(wait: float) -> bool:
        return float(t) + wait <= last * (1 + NEARLY)

    ends = [whole.circles[k] for k in whole.ends]
    stand: list[tuple[str, Any, Quantity, NearSide | None]]
    stand = [(f"grazes {c.id}", c, circle.r + c.r, None) for c in scene.circles if c.fixed]
    stand += [(f"grazes an end of {end.id}", end, circle.r + end.r, None) for end in ends]
    stand += [(f"grazes the rim of {hole.id}", hole, hole.r, None) for hole in scene.pockets]
    for arc in scene.arcs:
        outside, hollow = NearSide.both(arc)
        stand.append((f"grazes {arc.id}", arc, circle.r + arc.r, outside))
        if (circle.r - arc.r).sign() < 0:
            stand.append((f"touches {arc.id} from within, along it", arc, circle.r - arc.r, hollow))
    for told, thing, reach, side in stand:
        gap = gap_quartic(thing.x - x, thing.y - y, -vx, -vy, hx, hy, reach)
        c = [value.rational for value in gap if value.rational is not None]
        if len(c) < len(gap):
            continue
        for wait in [0.0] * (c[0] == c[1] == 0) + [float(zero.in_ball()) for zero in double_zeros_exactly(c)]:
            far = [float(at + v * wait + h * wait * wait) for at, v, h in ((x, vx, hx), (y, vy, hy))]
            dx, dy = far[0] - float(thing.x), far[1] - float(thing.y)
            if in_time(wait) and (side is None or side.within(dx, dy, abs(float(reach))) > -NEARLY):
                return f"{name} {told}" if wait else f"{name} and {thing.id} touch and do not approach"
    for k in whole.faces:
        face = whole.walls[k]
        nx, ny = face.normal
        gap = wall_gap(x, y, face.x0, face.y0, nx, ny, circle.r * (nx * nx + ny * ny).sqrt())
        approach, half = wall_approach(vx, vy, nx, ny), wall_approach(hx, hy, nx, ny)
        slide, bend = law.face_along(vx, vy, ZERO, ZERO, nx, ny), law.face_along(hx, hy, ZERO, ZERO, nx, ny)
        try:
            root = law.fall_discriminant(gap, approach, half).sqrt()
            wait = law.fall_time_back(approach, half, root) if half.sign() else law.wall_hit_time(gap, approach)
            foot = slide * wait + bend * wait * wait
            if (
                wait.sign() > 0
                and in_time(float(wait))
                and any(
                    (law.face_along(x, y, x0, y0, nx, ny) + foot).sign() == 0
                    for x0, y0 in ((face.x0, face.y0), (face.x1, face.y1))
                )
            ):
                return f"{name} meets {face.id} where a face becomes an end"
        except (ValueError, ZeroDivisionError):  # it does not come there, or that is not known
            continue
    return None


def _zero_at_side(flight: ExactFlight, side: ArcSide, r: Quantity) -> str | None:
    """What is exactly zero of a circle and a side of an arc: the discriminant, or the range where they meet."""
    _, x, y, vx, vy = flight
    dx, dy, reach = side.x - x, side.y - y, r + side.r
    hollow = side.r.sign() < 0
    if hollow and reach.sign() >= 0:
        return None
    if not hollow and not float(pair_approach(dx, dy, -vx, -vy)) < 0:
        return None
    if is_zero(pair_discriminant, dx, dy, -vx, -vy, reach):
        return f"touches {side.id} from within, along it" if hollow else f"grazes {side.id}"
    if side.full or not float(pair_discriminant(dx, dy, -vx, -vy, reach)) > 0:
        return None

    def within() -> Quantity:
        root, approach = pair_discriminant(dx, dy, -vx, -vy, reach).sqrt(), pair_approach(dx, dy, -vx, -vy)
        if hollow:
            wait = law.pair_last_time(approach, root, vx * vx + vy * vy)
        else:
            wait = law.pair_hit_time(pair_gap(dx, dy, reach), approach, root)
        edge = side.h * (-reach if hollow else reach)
        return law.arc_range(law.advance(dx, -vx, wait), law.advance(dy, -vy, wait), side.nx, side.ny, edge)

    return f"meets {side.id} where it ends" if is_zero(within) else None


def _meets_an_end_of(flight: ExactFlight, face: Wall, r: Quantity) -> bool:
    """Whether a circle comes to the line of a face right above one of its points."""
    _, x, y, vx, vy = flight
    nx, ny = face.normal
    approach = wall_approach(vx, vy, nx, ny)
    if not float(approach) < 0:
        return False
    span = (nx * nx + ny * ny).sqrt()
    slide = law.face_along(vx, vy, ZERO, ZERO, nx, ny)

    def foot(x0: Quantity, y0: Quantity) -> Quantity:
        return law.face_foot(
            law.face_along(x, y, x0, y0, nx, ny), slide, law.wall_gap(x, y, x0, y0, nx, ny, r * span), approach
        )

    return any(is_zero(foot, x0, y0) for x0, y0 in ((face.x0, face.y0), (face.x1, face.y1)))


def _flights_before(reference: Trajectory, event: int) -> dict[str, ExactFlight]:
    """Each circle as its last meeting before an event left it, where its numbers are exact and short."""
    met = history(reference).meetings
    flights: dict[str, ExactFlight] = {}
    carried = {settling.circle for settling in reference.settlings}  # which fly otherwise
    for circle in (c for c in reference.scene.circles if c.id not in carried):
        past = [m.event for m in met.get(str(circle.id), []) if m.event < event]
        time = reference.events[past[-1]].time if past else Quantity.of(0)
        state = reference.at(time)[str(circle.id)]
        flight = exact_flight(OwnFlight(time, state.x, state.y, state.vx, state.vy), reference.scene.gravity)
        if flight is not None:
            flights[str(circle.id)] = flight
    return flights
