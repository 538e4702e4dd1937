"""Finds the cheapest setting of an engine that gets what is asked for right on a scene and on scenes beside it."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

from ...exact.exact_engine import ExactEngine
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.settings import positive_time
from ..alignment.align import UNKNOWING
from ..chaos.horizon import Forecaster, follow
from ..chaos.levels import LEVELS
from ..deadline import uninterrupted
from ..engines import engine as engine_named
from ..side_by_side import SideBySide
from ..study import Study
from ..tangent.hazard import ErrorModel, model_of
from ..tangent.impacts import NoTangentMap, impacts
from ..validation import check_until, checked_number, unsupported
from .goals import HistoryGoal
from .row import diagnosed
from .scene_family import nudged
from .setting_ladder import RunSize, Setting, cost, ladder

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.numbers.quantity import QuantityLike
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
    from ..tangent.hazard import ErrorCurve
    from .row import diagnosed
from .goals import Goal, Judged

LOW, MIDDLE, HIGH = range(3)
"""Of `LEVELS`: where one run in twenty has diverged, a half, and all but one in twenty."""


ROOMIER = 16
"""Times the budget: a step halved, with the most iterations, costs no more than that of the one before."""


class SearchEnd(Enum):
    """How a search ended."""

    FOUND = "a setting is right"
    BUDGET = "the budget is spent"
    LADDER = "no costlier setting is to be had"
    REFERENCE = "the certified run itself is not decided"
    HOPELESS = "what is left is predicted to be wrong"


@dataclass(frozen=True)
class Instance:
    """One scene on which a setting has to be right.

    Attributes:
        seed: of its velocities; None: the scene as it is.
        study: its certified run.
    """

    seed: int | None
    study: Study = field(repr=False)
    curves: dict[ErrorModel, ErrorCurve | None] = field(default_factory=dict, repr=False, compare=False)

    def needed(self, engine: Engine, level: int) -> float | None:
        """log2 of the unit of error with which a share of an engine's runs keeps the whole history of this scene.

        None where nothing is predicted.
        """
        declared, reference = model_of(engine), self.study.reference
        if declared is None or not reference.events:
            return None
        model = declared[0]
        if model not in self.curves:
            try:
                self.curves[model] = Forecaster(reference, impacts(reference, len(reference.events))).curve(model)
            except NoTangentMap:
                self.curves[model] = None
        curve = self.curves[model]
        unit = -math.inf if curve is None else curve.unit_at(LEVELS[model.name][level])
        return None if math.isinf(unit) else unit

    @property
    def label(self) -> str:
        """What reports call it."""
        return "the scene itself" if self.seed is None else f"perturbed {self.seed}"


@dataclass(frozen=True)
class Tried:
    """One setting, compared with the certified run of some of the scenes.

    Attributes:
        setting: the setting.
        judged: what came out, by the scene's seed (None: the scene itself).
        of: how many scenes there are.
    """

    setting: Setting
    judged: dict[int | None, Judged]
    of: int

    @property
    def wrong(self) -> list[int | None]:
        """The scenes on which it is wrong, as far as it was tried."""
        return [seed for seed, told in self.judged.items() if not told.right]

    @property
    def right(self) -> bool:
        """Whether it is right on every scene."""
        return len(self.judged) == self.of and not self.wrong


@dataclass(frozen=True)
class Cost:
    """What one run of the setting over the scene took, and the certified run: seconds of this machine's processor."""

    seconds: float
    exact_seconds: float


@dataclass(frozen=True)
class Advice:
    """What a search found.

    Attributes:
        scene, goal, engine: what was asked.
        size, perturbed: of the changes of velocities; the seeds of the scenes beside this one.
        left_out: seeds of those whose certified run is not decided, so that nothing can be compared with it.
        budget, spent: units of work.
        tried: every setting that was tried, cheapest first, up to the one that is right.
        end: how the search ended.
        beyond: costlier settings, tried after that.
        cost: of the setting that is right.
        why: where none is, why.
        next: where the budget ended the search, the setting that it did not suffice for, be it beyond the one that is
            right; where a prediction did, the next one.
        instead: where none is right, truebreak's own engines of doubles and of pairs of doubles, up to one that is.
        instances: the scenes, as far as they were needed.
    """

    scene: Scene
    goal: Goal
    engine: str
    size: Quantity
    perturbed: tuple[int, ...]
    left_out: tuple[int, ...]
    budget: int
    spent: int
    tried: tuple[Tried, ...]
    end: SearchEnd
    beyond: tuple[Tried, ...] = ()
    cost: Cost | None = None
    why: tuple[str, ...] = ()
    next: Setting | None = None
    instead: tuple[Tried, ...] = ()
    instances: tuple[Instance, ...] = field(default=(), repr=False)

    @property
    def named(self) -> Tried | None:
        """The cheapest setting that is right everywhere; None if none was found."""
        return self.tried[-1] if self.end is SearchEnd.FOUND else None

    @property
    def cheaper(self) -> Tried | None:
        """The one before it: one step cheaper, and wrong; None if it is the cheapest there is."""
        return self.tried[-2] if self.end is SearchEnd.FOUND and len(self.tried) > 1 else None

    @property
    def lucky(self) -> tuple[Tried, ...]:
        """Cheaper settings that are right on the scene itself, and wrong beside it."""
        cheaper = self.tried[:-1] if self.end is SearchEnd.FOUND else self.tried
        return tuple(t for t in cheaper if None in t.judged and t.judged[None].right and t.wrong)

    @property
    def worse(self) -> tuple[Tried, ...]:
        """Costlier settings that are wrong."""
        return tuple(t for t in self.beyond if t.wrong)


DEFAULT_PERTURBED = 8

DEFAULT_SIZE = Quantity.of("1/1000")
"""Share of a velocity by which it is changed: enough that impacts fall elsewhere between two steps, too little to make
another scene of it."""

DEFAULT_BUDGET = 30_000_000
"""Units of work of all runs together: half a minute or so of pymunk."""

FAR = 10**9
"""Work up to which a ladder is followed to see whether it ends."""

ENOUGH = 400_000
"""Units of work of the settings that are run where all are predicted to be wrong: enough to see how far they come."""

MARGIN = 8
"""By how many halvings a step has to be too large, beside what one run in twenty needs, to be predicted to be wrong."""

WORTH = 20_000
"""Units of work, of about a microsecond, from which on a run is worth a process of its own."""

MICROSECOND = 1e-6

INSTEAD = ("double", "quad")

BEYOND = 3
"""Costlier settings that are looked at once one is right, to tell luck from convergence."""


@dataclass(frozen=True)
class Searching:
    """How far a search is: units spent, the budget, the setting under way and the scene."""

    spent: int
    budget: int
    setting: str
    scene: str


OnSearch: TypeAlias = Callable[[Searching], None]


def advise(
    scene: Scene,
    goal: Goal | None = None,
    engine: str = "pymunk",
    *,
    until: QuantityLike | None = None,
    perturbed: int = DEFAULT_PERTURBED,
    size: QuantityLike = DEFAULT_SIZE,
    seed: int = 1,
    budget: int | None = None,
    why: bool = True,
    jobs: int | None = 1,
    progress: OnSearch | None = None,
) -> Advice:
    """Searches an engine's settings, from the cheapest up, for the first that is right.

    Every cheaper one is tried, and wrong on the scene or on one of those beside it: nothing is left out by supposing
    that what costs more is better. Where the growth of errors along the certified run predicts that no setting of the
    ladder keeps the history, only the cheap ones are run, unless a budget is given.

    Args:
        goal: what is to be right; by default every event.
        engine: whose settings; parameters that are given say where to begin.
        until: the end of the history looked at, where the goal sets none; by default the scene's own.
        perturbed: how many scenes beside this one: velocities differ, by shares of up to `size` of them, drawn from
            `seed`, `seed` + 1, ...
        budget: the most units of work (about a microsecond each) that all runs of the engine may cost together. Each
            run is counted before it is begun, by its setting and by the length of the certified run. None:
            `DEFAULT_BUDGET`, and no run of what is predicted to be wrong once `ENOUGH` is spent.
        why: whether to find out what stands in the way where no setting is right, by further runs beside the budget.
        jobs: how many settings, or scenes, are tried at once, each in a copy of this process; None: one for each
            processor. What comes out is the same.
        progress: called before each run.

    Raises:
        SceneError: for a goal that the scene has not, an engine that cannot take the scene, and a number out of range.

    >>> from truebreak.scenarios import catalogue
    >>> told = advise(catalogue.build("gas:n=3"), HistoryGoal(4), perturbed=2)
    >>> told.named.right, len(told.cheaper.wrong) > 0
    (True, True)
    """
    goal = HistoryGoal() if goal is None else goal
    share = _checked(size, perturbed, budget)
    search = _Search(scene, goal, engine, until, share, range(seed, seed + perturbed), budget, why, progress)
    with SideBySide(jobs) as search.tasks:
        return search.advice()


def _checked(size: QuantityLike, perturbed: int, budget: int | None) -> Quantity:
    """The size, if all three are in range."""
    try:
        share = Quantity.of(size)
    except SceneError as error:
        raise SceneError(f"--size {error}") from None
    if not 0 < share < 1:
        raise SceneError(f"--size {share.brief()}: is a share of each velocity; write one above 0 and below 1")
    if perturbed < 0:
        raise SceneError(f"--perturbed {perturbed}: must be a whole number from 0")
    if budget is not None and budget < 1:
        raise SceneError(f"--budget {budget}: nothing can be tried with that; write a whole number from 1")
    return share


class _Spent(Exception):
    """The next run costs more than is left."""


class _Search:
    """One search under way."""

    def __init__(
        self,
        scene: Scene,
        goal: Goal,
        engine: str,
        until: QuantityLike | None,
        size: Quantity,
        seeds: range,
        budget: int | None,
        why: bool,
        progress: OnSearch | None,
    ) -> None:
        self.scene, self.goal, self.engine, self.until = scene, goal, engine, until
        self.size, self.seeds, self.why, self.progress = size, seeds, why, progress
        self.budget, self.predicts = DEFAULT_BUDGET if budget is None else budget, budget is None
        self.spent, self.left_out = 0, list[int]()
        self.begun = set[tuple[str, int | None]]()
        self.tasks, self.paid = SideBySide(1), list[int]()
        self.exact = ExactEngine()
        chosen = engine_named(engine)
        key = unsupported(chosen, scene)
        if key is not None:
            raise SceneError(f"engine {engine!r} does not follow {key!r}, which the scene has; choose another --engine")
        check_until(chosen, scene, until)
        end = positive_time("until", until) or scene.until
        if end is not None:
            checked_number("until", end)
        began = clock.process_time()
        self.home = self._instance(None, scene, self._exact_run(scene))
        self.exact_seconds = clock.process_time() - began
        goal.check(self.home.study.reference)
        self._beside: list[Instance] | None = None

    def _exact_run(self, scene: Scene, progress: object = None) -> Trajectory:
        until, events = (None, self.goal.events) if self.goal.events is not None else (self.until, None)
        return uninterrupted(self.exact.run(scene, until=until, events=events))

    def _instance(self, seed: int | None, scene: Scene, run: Trajectory) -> Instance:
        return Instance(seed, Study(scene, self.exact, run, pay=self._pay))

    @property
    def instances(self) -> list[Instance]:
        """The scene, and those beside it whose certified run is decided."""
        if self._beside is None:
            self._beside = []
            scenes = {seed: nudged(self.scene, self.size, seed) for seed in self.seeds}
            if self.exact_seconds >= WORTH * MICROSECOND:
                for seed, scene in scenes.items():
                    self.tasks.add(seed, partial(self._exact_run, scene))
            for seed, scene in scenes.items():
                run = self.tasks.result(seed) if seed in self.tasks else self._exact_run(scene)
                near = self._instance(seed, scene, run)
                if near.study.reference.stop.reason in UNKNOWING:
                    self.left_out.append(seed)
                else:
                    self._beside.append(near)
        return [self.home, *self._beside]

    def advice(self) -> Advice:
        """Tries one after the other."""
        run = self.home.study.reference
        if run.stop.reason in UNKNOWING:
            return self._told(
                (), SearchEnd.REFERENCE, why=(f"The certified run of the scene itself stops: {run.stop.message}.",)
            )
        rungs = ladder(self.engine, RunSize.of(run), self.budget)
        tried: list[Tried] = []
        first: int | None = None
        hopeless = self._hopeless(rungs)
        for place, setting in enumerate(rungs):
            if hopeless and self.spent + setting.work > ENOUGH and self._far_off(tried):
                return self._none(tried, SearchEnd.HOPELESS, setting)
            self._look_ahead(rungs[place:], ENOUGH if hopeless else self.budget, first)
            try:
                told = self._try(setting, first)
            except _Spent:
                return self._none(tried, SearchEnd.BUDGET, setting)
            tried.append(told)
            if told.right:
                return self._found(tried, rungs[len(tried) :])
            first = told.wrong[0]
        return self._none(tried, self._end_of(rungs), None)

    def _look_ahead(self, rungs: tuple[Setting, ...], most: int, first: int | None) -> None:
        """Begins to try the next settings, where they are worth a process and can be paid for.

        On the scene itself, and on the one on which the last was wrong. Those before one are paid for by then, or it
        is not asked for.
        """
        near = [] if first is None else [one for one in self.instances[1:] if one.seed == first]
        spent = self.spent
        for setting in rungs[: self.tasks.jobs] if self.tasks.together else ():
            for one in (self.home, *near):
                spent += setting.work
                if setting.work >= WORTH and spent <= most:
                    self._begin(setting, one, spent)

    def _begin_all(self, setting: Setting, scenes: Sequence[Instance]) -> None:
        """Begins to try a setting on scenes beside this one, where that is worth it and can be paid for."""
        if self.tasks.together and setting.work >= WORTH and self.spent + len(scenes) * setting.work <= self.budget:
            for place, near in enumerate(scenes):
                self._begin(setting, near, self.spent + (place + 1) * setting.work)

    def _begin(self, setting: Setting, near: Instance, spent: int) -> None:
        name = setting.text, near.seed
        if name not in self.begun:
            self.begun.add(name)
            self.tasks.add(name, partial(self._judged, setting, near, spent))

    def _hopeless(self, rungs: tuple[Setting, ...]) -> bool:
        """Whether every setting is predicted to be wrong: even the finest step is far coarser than nineteen runs in
        twenty can do with to keep the whole history."""
        finest = rungs[-1].engine if rungs else None
        if not self.predicts or not isinstance(self.goal, HistoryGoal) or finest is None or finest.step is None:
            return False
        if sum(setting.work for setting in rungs) <= ENOUGH:
            return False
        unit = self.home.needed(finest, HIGH)
        return unit is not None and math.log2(finest.step) > unit + MARGIN

    def _far_off(self, tried: list[Tried]) -> bool:
        """Whether none of those tried agrees on half of the history: a prediction supposes that errors go with the
        step, and an engine of higher order comes farther than that."""
        agreed = [judged.agreed or 0 for one in tried for judged in one.judged.values()]
        return 2 * max(agreed, default=0) < len(self.home.study.reference.events)

    def _end_of(self, rungs: tuple[Setting, ...]) -> SearchEnd:
        """Whether the ladder goes on beyond the budget."""
        more = ladder(self.engine, RunSize.of(self.home.study.reference), max(4 * self.budget, FAR))
        return SearchEnd.BUDGET if len(more) > len(rungs) else SearchEnd.LADDER

    def _try(self, setting: Setting, first: int | None, whole: Tried | None = None) -> Tried:
        """Holds a setting against the scene itself, then against the one on which the last was wrong, then the others.

        Args:
            whole: what is known of it; it is then compared with all the others, and not only up to the first failure.

        Raises:
            _Spent: if the budget does not suffice.
        """
        judged = {} if whole is None else dict(whole.judged)
        if None not in judged:
            judged[None] = self._judge(setting, self.home)
        if judged[None].right or whole is not None:
            others = sorted(self.instances[1:], key=lambda one: one.seed != first)
            others = [near for near in others if near.seed not in judged]
            for place, near in enumerate(others):
                if place == (first is not None):  # one that was wrong before is tried alone
                    self._begin_all(setting, others[place:])
                judged[near.seed] = self._judge(setting, near)
                if whole is None and not judged[near.seed].right:
                    break
        return Tried(setting, judged, 1 + len(self.seeds) - len(self.left_out))

    def _judge(self, setting: Setting, near: Instance) -> Judged:
        work = cost(setting.engine, RunSize.of(near.study.reference))[1]
        self._check_budget(work)
        if self.progress is not None:
            self.progress(Searching(self.spent, self.budget, setting.text, near.label))
        self.spent += work
        name = (setting.text, near.seed)
        paid, judged = self.tasks.result(name) if name in self.tasks else self._judged(setting, near, self.spent)
        for each in paid:
            self._check_budget(each)
            self.spent += each
        if judged is None:
            raise _Spent
        return judged

    def _judged(
        self, setting: Setting, near: Instance, spent: int, progress: object = None
    ) -> tuple[list[int], Judged | None]:
        """What comes of a setting on a scene, and what was to be paid for it; None where that was too much.

        Args:
            spent: what is spent before, at the least.
        """
        before, self.spent, self.paid = self.spent, spent, []
        try:
            return self.paid, self.goal.judge(near.study, setting.text, setting.engine)
        except _Spent:
            return self.paid, None
        finally:
            self.spent = before

    def _check_budget(self, work: int) -> None:
        if self.spent + work > self.budget:
            raise _Spent

    def _pay(self, engine: Engine, steps: int) -> None:
        """Counts a run at a finer step, which shows whether an instant of several contacts is the same.

        Raises:
            _Spent: if the budget does not suffice.
        """
        size = replace(RunSize.of(self.home.study.reference), time=steps * (engine.step or 0.0))
        work = cost(engine, size)[1]
        self.paid.append(work)
        self._check_budget(work)
        self.spent += work

    def _found(self, tried: list[Tried], costlier: tuple[Setting, ...]) -> Advice:
        """Looks at what is one step cheaper on every scene, at what is costlier, and takes the time of the run."""
        end = float(self.home.study.reference.final_time)
        began = clock.process_time()
        self.home.study.run(tried[-1].setting.engine, self.scene, self.home.study.past(end))
        took = Cost(clock.process_time() - began, self.exact_seconds)
        beyond: list[Tried] = []
        try:
            if len(tried) > 1:
                tried[-2] = self._try(tried[-2].setting, None, tried[-2])
            beyond.extend(self._try(setting, None) for setting in costlier[:BEYOND])
        except _Spent:
            pass
        after = None if beyond else next(iter(costlier or self._beyond_budget()), None)
        return replace(self._told(tuple(tried), SearchEnd.FOUND, after=after), beyond=tuple(beyond), cost=took)

    def _beyond_budget(self) -> list[Setting]:
        """The settings that come next in the ladder, had the budget more room."""
        rungs = ladder(self.engine, RunSize.of(self.home.study.reference), ROOMIER * self.budget)
        return [setting for setting in rungs if setting.work > self.budget]

    def _none(self, tried: list[Tried], end: SearchEnd, after: Setting | None) -> Advice:
        self.tasks.end()
        seed = tried[-1].wrong[0] if tried else None
        near = next(one for one in (self.home, *(self._beside or ())) if one.seed == seed)
        free = replace(near.study, pay=None)
        why = reasons(near, free, [(t.setting, t.judged.get(seed)) for t in tried]) if self.why else ()
        found = self._told(tuple(tried), end, why=why, after=after)
        return replace(found, instead=self._instead() if self.why else ())

    def _instead(self) -> tuple[Tried, ...]:
        """Engines of truebreak's own, up to one that is right; they cost less than a few steps of another's."""
        found: list[Tried] = []
        spent, self.spent, size = self.spent, 0, RunSize.of(self.home.study.reference)
        for name in INSTEAD:
            chosen = engine_named(name)
            if self.engine.partition(":")[0] == name or unsupported(chosen, self.scene) is not None:
                continue
            try:
                found.append(self._try(Setting(name, chosen, cost(chosen, size)[1]), None))
            except _Spent:
                break
            if found[-1].right:
                break
        self.spent = spent
        return tuple(found)

    def _told(
        self, tried: tuple[Tried, ...], end: SearchEnd, why: tuple[str, ...] = (), after: Setting | None = None
    ) -> Advice:
        return Advice(
            self.scene,
            self.goal,
            self.engine,
            self.size,
            tuple(self.seeds),
            tuple(self.left_out),
            self.budget,
            self.spent,
            tried,
            end,
            why=why,
            next=after,
            instances=(self.home, *(self._beside or ())),
        )


# -- why no setting was right: how far they came, what would be needed, and what the divergence is due to

DIAGNOSED_WORK = 2_000_000
"""Work of the costliest run whose cause is looked for, by experiments that take many times as much."""

SHOWN = 4
"""Settings whose reach is shown."""


def reasons(near: Instance, study: Study, tried: Sequence[tuple[Setting, Judged | None]]) -> tuple[str, ...]:
    """Sentences, the most telling first.

    Args:
        near: the scene on which the last setting was wrong.
        study: its certified run, for which nothing is paid.
        tried: each setting, and what came out on that scene; None where it was not tried there.
    """
    if not tried:
        return ("The budget does not suffice for one run of the cheapest setting.",)
    setting, judged = tried[-1]
    last = None if judged is None else f"The last tried, {setting.text}, on {near.label}: {judged.result}."
    sentences = (last, _reach(study, tried), _needed(near, setting), _cause(study, tried))
    return tuple(sentence for sentence in sentences if sentence)


def _reach(study: Study, tried: Sequence[tuple[Setting, Judged | None]]) -> str | None:
    """How many events the best of each step, or width, agreed on."""
    best: dict[float, int] = {}
    for setting, judged in tried:
        if judged is not None and judged.agreed is not None:
            key = setting.engine.step or float(setting.engine.bits or 0)
            best[key] = max(best.get(key, 0), judged.agreed)
    reached = list(best.values())[-SHOWN:]
    if len(reached) < 2:
        return None
    what = "halving of the step" if tried[-1][0].engine.step is not None else "wider number"
    return (
        f"Of {len(study.reference.events):,} events, each {what} agreed on: ... "
        f"{', '.join(f'{count:,}' for count in reached)}."
    )


def _needed(near: Instance, setting: Setting) -> str | None:
    """The step, or the bits, with which half of such runs keep the whole history, predicted from the certified run."""
    declared, reference = model_of(setting.engine), near.study.reference
    unit = near.needed(setting.engine, MIDDLE)
    if unit is None or declared is None or unit >= declared[1]:
        return None
    rate = "Errors grow along the certified run so that it would take"
    if declared[0] is ErrorModel.STEPPED:
        steps = math.log10(float(reference.final_time)) - unit * math.log10(2)
        return f"{rate} a step of about 2**{math.floor(unit)}, some 10**{steps:.0f} steps, to keep every event."
    return f"{rate} about {math.ceil(-unit)} bits to keep every event."


def _cause(study: Study, tried: Sequence[tuple[Setting, Judged | None]]) -> str | None:
    """What the first divergence is due to, by experiment, at the costliest setting that is cheap enough for that."""
    cheap = [setting for setting, judged in tried if setting.work <= DIAGNOSED_WORK and judged and not judged.right]
    if not cheap:
        return None
    setting = cheap[-1]
    found = follow(study.reference, setting.engine)
    if found.alignment.divergence is None:
        return None
    diagnosis = diagnosed(found, setting.text, setting.engine).diagnosis
    if diagnosis is None:
        return None
    return f"Why {setting.text} diverges at event {found.alignment.divergence.event}: {diagnosis}."
