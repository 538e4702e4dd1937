"""The settings of an engine that are tried, ordered by what a run with each costs in counted work."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import count, takewhile
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ..engines import class_path, parsed_settings
from ..engines import engine as engine_named
from ..foreign.guard import finer_of, wider_of

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.trajectory import Trajectory

ITERATIONS = (1, 10, 100)
"""Rounds of a solver that are tried with each step; 10 are pymunk's own default."""

WIDTHS = (24, 32, 48)
"""Bits that are tried first; then twice, four times, ... as many, and those of doubles."""

DOUBLE = 53

STEP_NANOSECONDS, CIRCLE_NANOSECONDS, ROUND_NANOSECONDS = 900, 50, 220
"""What a time step costs in pymunk, for itself and for each circle, and one round of the solver over one contact:
measured with gases of 2 to 160 discs, at 1 to 4,096 iterations, on one core of a shared virtual machine."""

EVENT_MICROSECONDS, BITS_A_MICROSECOND = 60, 16
"""What an event costs in intervals for each circle and wall, and the bits that add as much as a microsecond: measured
with gases of 3 to 30 discs at 53 to 4,096 bits; beyond that it is more."""

ROOM = 8
"""Times as long as the span for which an engine with a limit on its steps is given room: a comparison may run on, and a
scene beside this one may last longer."""


@dataclass(frozen=True)
class Setting:
    """One rung.

    Attributes:
        text: the engine as the command line takes it.
        engine: the engine.
        work: what one run over the scene costs, in counted units of about a microsecond.
        steps: time steps of one run; None for an event-driven engine.
    """

    text: str
    engine: Engine
    work: int
    steps: int | None = None


@dataclass(frozen=True)
class RunSize:
    """How much there is to do in a scene, by its certified run: what the cost of a run is counted from.

    Attributes:
        time: its length.
        events, impulses: instants, and pairwise impulses.
        circles, walls: how many.
    """

    time: float
    events: int
    impulses: int
    circles: int
    walls: int

    @classmethod
    def of(cls, run: Trajectory) -> RunSize:
        """That of a certified run."""
        scene = run.scene
        return cls(float(run.final_time) or 1.0, len(run.events), run.collisions, len(scene.circles), len(scene.walls))

    def stepped(self, step: float, iterations: int) -> tuple[int, int]:
        """Steps, and units of work, of a run by time steps.

        >>> RunSize(10.0, 20, 20, 10, 4).stepped(1 / 64, 10)
        (640, 940)
        """
        steps = math.ceil(self.time / step)
        nanoseconds = steps * (STEP_NANOSECONDS + CIRCLE_NANOSECONDS * self.circles)
        return steps, -(-(nanoseconds + ROUND_NANOSECONDS * iterations * self.impulses) // 1000)

    def driven(self, bits: int, pair: float = 0.0) -> int:
        """Units of work of a run from event to event in numbers of so many bits, each event `pair` more for each pair.

        >>> RunSize(10.0, 20, 20, 10, 4).driven(64)
        18816
        >>> RunSize(10.0, 20, 20, 10, 4).driven(64, 6.0) - RunSize(10.0, 20, 20, 10, 4).driven(64)
        5670
        """
        pairs = self.circles * (self.circles - 1) // 2
        one = (self.circles + self.walls) * (EVENT_MICROSECONDS + bits // BITS_A_MICROSECOND)
        return (self.events + 1) * (one + math.ceil(pair * pairs))


def cost(engine: Engine, size: RunSize) -> tuple[int | None, int]:
    """Time steps, if it has any, and units of work of a run.

    >>> cost(engine_named("pymunk:dt=1/64,iterations=10"), RunSize(10.0, 20, 20, 10, 4))
    (640, 940)
    """
    if engine.step is None:
        return None, size.driven(engine.bits or 0, getattr(engine, "pair_microseconds", 0.0))
    return size.stepped(engine.step, getattr(engine, "iterations", 1))


def ladder(text: str, size: RunSize, budget: int) -> tuple[Setting, ...]:
    """The settings of an engine, cheapest first, up to the first that costs more than the budget, which is left out.

    By the engine's own parameters: `dt`, the step, from about the length of the whole run on, halved again and again,
    each with several `iterations` if it has them; or `bits`. A parameter that is given sets where the ladder begins
    (`iterations`: is kept). An engine that has none of these is made finer, or wider, as far as it goes.

    Raises:
        SceneError: for an unknown engine or parameter.

    >>> [(s.text, s.work) for s in ladder("pymunk", RunSize(3.0, 4, 4, 2, 0), 10)]
    [('pymunk:dt=2,iterations=1', 3), ('pymunk:dt=1,iterations=1', 4), ('pymunk:dt=1/2,iterations=1', 7)]
    >>> [s.text for s in ladder("interval", RunSize(3.0, 4, 4, 2, 0), 620)]
    ['interval:bits=24', 'interval:bits=32']
    >>> [s.text for s in ladder("double", RunSize(3.0, 4, 4, 2, 0), 10**6)]
    ['double']
    """
    base = engine_named(text)
    names = {f.name for f in dataclasses.fields(base)} if dataclasses.is_dataclass(base) else set[str]()
    given = _taken_apart(text)[1]
    if base.step is not None and "dt" in names:
        found = list(_steps(text, base, names, given, size, budget))
    elif "bits" in names:
        found = list(_widths(text, base, given, size, budget))
    else:
        found = list(_made_better(text, base, size, budget))
    return tuple(sorted(found, key=lambda setting: setting.work))


def _steps(
    text: str, base: Engine, names: set[str], given: dict[str, str], size: RunSize, budget: int
) -> Iterator[Setting]:
    """A grid of steps and iterations."""
    first = Fraction(2) ** math.floor(math.log2(size.time))
    if "dt" in given:
        first = Quantity.of(given["dt"]).fraction or Fraction(base.step or 1)
    free = "iterations" in names and "iterations" not in given
    most = getattr(base, "max_steps", None) if "max_steps" not in given else None
    for iterations in ITERATIONS if free else (getattr(base, "iterations", 1),):
        for halvings in count():
            step = first / 2**halvings
            steps, work = size.stepped(float(step), iterations)
            if work > budget:
                break
            settings: dict[str, Any] = {"dt": step}
            if free:
                settings["iterations"] = iterations
            if most is not None and ROOM * steps > most:
                settings["max_steps"] = 2 ** math.ceil(math.log2(ROOM * steps))
            named = _with(text, **settings)
            yield Setting(named, engine_named(named), work, steps)


def _widths(text: str, base: Any, given: dict[str, str], size: RunSize, budget: int) -> Iterator[Setting]:
    """Numbers of ever more bits."""
    least = base.bits if "bits" in given else WIDTHS[0]
    doubled = (width * 2**power for power in count() for width in WIDTHS[1:])
    affordable = takewhile(lambda bits: size.driven(bits) <= budget, doubled)
    for bits in sorted({least, WIDTHS[0], DOUBLE, *affordable}):
        if bits < least or size.driven(bits) > budget:
            continue
        named = _with(text, bits=bits)
        try:
            yield Setting(named, engine_named(named), size.driven(bits))
        except SceneError:  # an engine has its own fewest and most bits
            continue


def _made_better(text: str, base: Engine, size: RunSize, budget: int) -> Iterator[Setting]:
    """The engine as it is, then finer or wider by its own declaration."""
    chosen: Engine | None = base
    for times in count():
        if chosen is None:
            return
        steps, work = cost(chosen, size)
        if work > budget:
            return
        yield Setting(text if times == 0 else f"{text}, {_better(chosen, times)}", chosen, work, steps)
        chosen = finer_of(chosen) if chosen.step is not None else wider_of(chosen)


def _better(chosen: Engine, times: int) -> str:
    what = "step halved" if chosen.step is not None else "bits doubled"
    return f"{what} {times} time{'s' * (times != 1)}"


def _taken_apart(text: str) -> tuple[str, dict[str, str]]:
    """What names the engine, and the parameters that the text sets.

    >>> _taken_apart("pymunk:dt=1/64,iterations=3")
    ('pymunk', {'dt': '1/64', 'iterations': '3'})
    """
    path = class_path(text)
    if path is None:
        name, _, settings = text.strip().partition(":")
    else:
        name, settings = f"{path.label}={path.place}" if path.label else path.place, path.settings
    return name, parsed_settings(f"engine {name!r}", settings)


def _with(text: str, **settings: Any) -> str:
    """The text with settings, in place of those that it has.

    >>> _with("pymunk:dt=1/64,iterations=3", dt=Fraction(1, 128))
    'pymunk:dt=1/128,iterations=3'
    """
    name, given = _taken_apart(text)
    merged = {**given, **{key: str(value) for key, value in settings.items()}}
    return f"{name}:" + ",".join(f"{key}={value}" for key, value in merged.items())
