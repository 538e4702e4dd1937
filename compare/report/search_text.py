"""What searches came to, for people: advice, all orders of an instant, a shadow, the smallest scene; advice as JSON."""

from __future__ import annotations

import math
import sys
from decimal import ROUND_CEILING, Context, Decimal
from itertools import count
from typing import TYPE_CHECKING, Annotated, Any, TypedDict

from ..alignment.align import UNKNOWING
from ..files.amounts import counted
from .documents import Encoder
from .output import console, grid, say
from .sentences import divergence_phrase
from .terminal import print_comparison

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Contact, Stop
    from ..grids.setting_search import Advice, SearchEnd, Tried
    from ..orders.all_orders import Leaf, OrderTree
    from ..reduction.smallest import SceneSize, Smallest
    from ..shadowing.shadows import Proof, Shadow

# -- the cheapest setting that is right

ADVICE_SCHEMA = "truebreak/advice-2"

SHOWN = 4
"""Settings of one kind that are named in a sentence; the JSON has all."""


class SettingRow(TypedDict):
    """A setting of an engine.

    Attributes:
        engine: the engine with it, as on the command line.
        work: counted work of its run, in units of about a microsecond.
        steps: time steps of its run; null: it has none.
    """

    engine: str
    work: int
    steps: int | None


class FoundSetting(SettingRow):
    """The setting that is advised.

    Attributes:
        may_fail: the share of such scenes on which it may fail, at 95 %, as far as those that were tried say.
        seconds: of its run.
        exact_seconds: of the exact run.
    """

    may_fail: float
    seconds: float
    exact_seconds: float


class TriedOn(TypedDict):
    """What came of a setting on one scene.

    Attributes:
        scene: its seed; null: the scene itself.
        right: whether what is asked for is right.
        agreed: events before the first divergence.
        result: in words.
    """

    scene: int | None
    right: bool
    agreed: int | None
    result: str


class TriedSetting(SettingRow):
    """A setting that was tried.

    Attributes:
        right: whether it is right on every scene.
        on: scene by scene, as far as it was tried.
    """

    right: bool
    on: list[TriedOn]


class GoalRow(TypedDict):
    """What is asked for.

    Attributes:
        text: in words.
        outcome: the outcome that shall be right; null: none was named.
        digits: the decimal digits that shall be right; null: none were asked for.
        events: events that shall agree; null: all.
    """

    text: str
    outcome: str | None
    digits: int | None
    events: int | None


class NearbyScene(TypedDict):
    """A nearby scene on which settings were tried.

    Attributes:
        seed: of its displacement.
        scene: the scene, as a file of JSON has it.
    """

    seed: int
    scene: dict[str, Any]


class AdviceDocument(TypedDict):
    """The cheapest setting of an engine that gets what is asked for right.

    Attributes:
        sentence: what was found.
        scene: the scene.
        goal: what is asked for.
        engine: the engine.
        end: why the search ended.
        budget: work that was allowed.
        spent: work that was done.
        setting: the setting that is advised; null: none was found.
        cheaper: the next cheaper one, which is wrong; null: there is none.
        monotone: whether no finer setting was worse than a coarser one.
        lucky: settings that are right while finer ones are wrong.
        worse: settings that are wrong while coarser ones are right.
        why: why none was found, in sentences.
        instead: settings of other engines that are right.
        size: how far nearby scenes are displaced.
        left_out: seeds of nearby scenes that the reference could not run.
        tried: what was tried, in order.
        beyond: what was tried beyond the setting that is advised.
        perturbed: the nearby scenes.
    """

    schema: str
    sentence: str
    scene: Scene
    goal: GoalRow
    engine: str
    end: Annotated[str, SearchEnd]
    budget: int
    spent: int
    setting: FoundSetting | None
    cheaper: TriedSetting | None
    monotone: bool
    lucky: list[str]
    worse: list[str]
    why: list[str]
    instead: list[TriedSetting]
    size: str
    left_out: list[int]
    tried: list[TriedSetting]
    beyond: list[TriedSetting]
    perturbed: list[NearbyScene]


def advice_json(advice: Advice) -> AdviceDocument:
    """The object that `truebreak advise --json` prints. `scene` is null for the scene itself, else the seed."""
    from ..grids.goals import Digits, OutcomeGoal

    goal, named, cheaper = advice.goal, advice.named, advice.cheaper
    found: FoundSetting | None = None
    if named is not None and advice.cost is not None:
        found = {**_setting(named), "may_fail": may_fail(named.of), "seconds": advice.cost.seconds,
                 "exact_seconds": advice.cost.exact_seconds}  # fmt: skip
    return {
        "schema": ADVICE_SCHEMA,
        "sentence": advice_sentences(advice)[0],
        "scene": Encoder(None)(advice.instances[0].study.reference.scene),
        "goal": {
            "text": str(goal),
            "outcome": goal.name if isinstance(goal, OutcomeGoal) else None,
            "digits": goal.count if isinstance(goal, Digits) else None,
            "events": goal.events,
        },
        "engine": advice.engine,
        "end": advice.end.name.lower(),
        "budget": advice.budget,
        "spent": advice.spent,
        "setting": found,
        "cheaper": None if cheaper is None else _tried(cheaper),
        "monotone": not (advice.lucky or advice.worse),
        "lucky": [tried.setting.text for tried in advice.lucky],
        "worse": [tried.setting.text for tried in advice.worse],
        "why": list(advice.why),
        "instead": [_tried(tried) for tried in advice.instead],
        "size": str(advice.size),
        "left_out": list(advice.left_out),
        "tried": [_tried(tried) for tried in advice.tried],
        "beyond": [_tried(tried) for tried in advice.beyond],
        "perturbed": [
            {"seed": one.seed, "scene": one.study.scene.data()} for one in advice.instances if one.seed is not None
        ],
    }


def _setting(tried: Tried) -> SettingRow:
    return {"engine": tried.setting.text, "work": tried.setting.work, "steps": tried.setting.steps}


def _tried(tried: Tried) -> TriedSetting:
    on: list[TriedOn] = [{"scene": seed, "right": one.right, "agreed": one.agreed, "result": one.result}
          for seed, one in tried.judged.items()]  # fmt: skip
    return {**_setting(tried), "right": tried.right, "on": on}


def advice_sentences(advice: Advice) -> list[str]:
    """What was found, one sentence each; the first leads."""
    where = _where(advice)
    if advice.named is None:
        return [_none(advice, where), *_instead(advice), *advice.why, *_luck(advice), *_left_out(advice)]
    told = [f"{advice.named.setting.text} is the cheapest setting that gets {advice.goal}, on {where}."]
    return [*told, *_unseen(advice.named), _cost(advice), _cheaper(advice), *_luck(advice), *_left_out(advice)]


def may_fail(scenes: int) -> float:
    """The share of such scenes on which a setting may fail that is right on so many: below this at 95 %, one-sided.

    It fails on a share p of them, and is right on n in a row with probability (1 - p)**n: 0.05 at this p
    (C. J. Clopper and E. S. Pearson, Biometrika 26 (1934), 404).

    >>> round(may_fail(9), 3), round(may_fail(299), 3)
    (0.283, 0.01)
    """
    return float(1 - 0.05 ** (1 / scenes))


def _unseen(named: Tried) -> list[str]:
    if named.of == 1:
        return ["One scene says nothing of others like it."]
    return [
        f"Right on {named.of} of {named.of} is no proof for others: a setting that fails on "
        f"{100 * may_fail(named.of):.0f} % of such scenes is right on so many in one case of 20, and in more "
        "where many settings are tried."
    ]


def _where(advice: Advice) -> str:
    seeds = advice.perturbed
    if not seeds:
        return f"{advice.scene.name} alone"
    which = f"seed {seeds[0]}" if len(seeds) == 1 else f"seeds {seeds[0]} to {seeds[-1]}"
    count = "one beside it" if len(seeds) == 1 else f"{len(seeds)} beside it"
    return f"{advice.scene.name} and {count} (velocities changed by up to {advice.size} of them, {which})"


def _none(advice: Advice, where: str) -> str:
    from ..grids.setting_search import SearchEnd

    match advice.end:
        case SearchEnd.REFERENCE:
            return f"No advice on {advice.scene.name}: {advice.end.value}."
        case SearchEnd.LADDER:
            tried = f"none of its {len(advice.tried)} settings" if len(advice.tried) > 1 else "its one setting does not"
            verb = f"{tried} gets" if len(advice.tried) > 1 else f"{tried} get"
            return f"{advice.engine}: {verb} {advice.goal}, on {where}."
        case SearchEnd.HOPELESS:
            return (
                f"No setting of {advice.engine} is predicted to get {advice.goal}, on {where}: {len(advice.tried)} "
                "tried, all wrong; --budget N runs the finer ones too."
            )
        case _:
            after = "" if advice.next is None else f", which do not suffice for {advice.next.text}"
            return (
                f"No setting of {advice.engine} within the budget gets {advice.goal}, on {where}: "
                f"{len(advice.tried)} tried, {advice.spent:,} of {advice.budget:,} units spent{after}."
            )


def _instead(advice: Advice) -> list[str]:
    """What truebreak's own engines come to, where no setting of the one that was asked for is right."""
    right = [tried for tried in advice.instead if tried.right]
    wrong = [f"{tried.setting.text} is wrong on {_listed_scenes(tried)}" for tried in advice.instead if not tried.right]
    if right:
        (tried,) = right
        where = "there" if tried.of == 1 else f"on all {tried.of} scenes"
        return [f"Take {tried.setting.text} instead: it is right {where}" +
                (f"; {'; '.join(wrong)}." if wrong else ".")]  # fmt: skip
    return [f"Nor is one of truebreak's own engines right: {'; '.join(wrong)}."] if wrong else []


def _cost(advice: Advice) -> str:
    assert advice.named is not None
    assert advice.cost is not None
    setting, cost = advice.named.setting, advice.cost
    steps = "" if setting.steps is None else f" ({setting.steps:,} time step{'s' * (setting.steps != 1)})"
    return (
        f"It costs {setting.work:,} units of work a run{steps}; measured, {cost.seconds:.3g} s of processor time, "
        f"where the certified run took {cost.exact_seconds:.3g} s."
    )


def _cheaper(advice: Advice) -> str:
    cheaper = advice.cheaper
    if cheaper is None:
        return "There is no cheaper one."
    others = len(advice.tried) - 2
    rest = f" So is each of the {others} that cost less still, somewhere." if others > 1 else ""
    return f"One step cheaper, {cheaper.setting.text}, is wrong on {_listed_scenes(cheaper)}.{rest}"


def _listed_scenes(tried: Tried) -> str:
    """Where a setting is wrong, with what came out at the first."""
    first, *others = tried.wrong
    more = f" (and on {', '.join(map(_scene, others))})" if others else ""
    return f"{_scene(first)}: {tried.judged[first].result}{more}"


def _scene(seed: int | None) -> str:
    return "the scene itself" if seed is None else f"perturbed {seed}"


def _luck(advice: Advice) -> list[str]:
    """Where the ladder is not monotone."""
    told = []
    if advice.lucky:
        names = [f"{t.setting.text} on {_scene(t.wrong[0])}" for t in advice.lucky[-SHOWN:]]
        more = f"{len(advice.lucky) - SHOWN} more; " if len(advice.lucky) > SHOWN else ""
        told.append(
            f"Not monotone: {_counted(len(advice.lucky))} right on the scene itself by luck, and wrong beside it: "
            f"{more}{'; '.join(names)}."
        )
    told.extend(
        f"Not monotone: {worse.setting.text}, which costs more, is wrong on {_listed_scenes(worse)}: "
        "what is right may be so by luck."
        for worse in advice.worse
    )
    good = [t.setting.text for t in advice.beyond if not t.wrong]
    if good:
        told.append(f"Costlier ones tried, and right everywhere too: {'; '.join(good)}.")
    elif advice.named is not None and not advice.beyond:
        told.append("No costlier one was looked at: "
                    + ("the budget has no room for it." if advice.next is not None else "there is none."))  # fmt: skip
    return told


def _counted(cheaper: int) -> str:
    return "one cheaper setting is" if cheaper == 1 else f"{cheaper} cheaper settings are"


def _left_out(advice: Advice) -> list[str]:
    if not advice.left_out:
        return []
    seeds = ", ".join(map(str, advice.left_out))
    return [f"Left out, as their certified run is not decided: perturbed {seeds}."]


def print_advice(advice: Advice) -> None:
    """The sentences, and one row for each of the last settings."""
    out = console()
    first, *others = advice_sentences(advice)
    say(out, first, "bold")
    for sentence in others:
        say(out, sentence)
    table = grid("setting", "units", "steps", "right on", "first failure", whole=("units", "steps", "right on"))
    shown = [*advice.tried[-ROWS:], *advice.beyond]
    for tried in shown:
        wrong = tried.wrong
        table.add_row(
            tried.setting.text,
            f"{tried.setting.work:,}",
            "" if tried.setting.steps is None else f"{tried.setting.steps:,}",
            f"{len(tried.judged) - len(wrong)} of {len(tried.judged)}",
            f"{_scene(wrong[0])}: {tried.judged[wrong[0]].result}" if wrong else "",
        )
    if shown:
        out.print(table)


ROWS = 6
"""Settings shown to people up to the one that is right."""


# -- all orders of one instant


MOST_CHOICES = 3
"""Choices that name an outcome; of more, how many."""


def print_orders(scene: Scene, tree: OrderTree, stop: Stop | None = None, *, verbose: bool = False) -> None:
    """The outcomes, one a row, each by what happens in it.

    Args:
        verbose: whether also every choice, every velocity, and what the search left out.
    """
    out, found = console(), tree.outcomes
    say(out, orders_sentence(scene, tree, stop), "bold")
    spread = spread_phrase(found)
    if spread:
        say(out, spread)
    cut = [leaf.trajectory.stop for leaf in found if leaf.trajectory.stop.reason in UNKNOWING]
    if cut:
        say(out, f"{len(cut)} of them {'stops' if len(cut) == 1 else 'stop'} before the end: {cut[0].message}")
    if verbose:
        say(out, f"Merged, as they come to an equal state: {counted(tree.merged, 'order')}; left out, as they only "
                 f"reorder independent contacts: {counted(tree.reordered, 'order')}.")  # fmt: skip
    if not found:
        return
    body = most_different(found)
    last = ("every choice", "velocities at the end") if verbose else (f"{body} ends with velocity",)
    table = grid("outcome", "what happens", "collisions", *last)
    for number, (name, outcome) in enumerate(zip(outcome_names(found), found, strict=True)):
        ends = (choices_phrase(outcome), velocities_phrase(outcome)) if verbose else (velocity_phrase(outcome, body),)
        table.add_row(str(number), name, f"{outcome.trajectory.collisions:,}", *ends)
    out.print(table)


def outcome_names(outcomes: Sequence[Leaf]) -> list[str]:
    """Each outcome by what happens in it: which contact comes first, wherever outcomes part by that.

    Of choices that are the same in all outcomes that have come so far alike nothing is said; so no two names of
    enumerated outcomes are the same, but for those of more than `MOST_CHOICES` choices.

    >>> from truebreak.compare.orders.all_orders import all_orders
    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import catalogue
    >>> outcome_names(all_orders(ExactEngine(), catalogue.build("lee")).outcomes)
    ['left hits middle first', 'middle hits right first']
    """
    after: dict[int, dict[tuple[int, Contact] | None, int]] = {}  # of each place in the tree, the steps from there
    fresh = count(1)
    places: dict[int, list[int]] = {}
    for k, leaf in enumerate(outcomes):
        if leaf.seed is None:
            node, places[k] = 0, []
            for step in (*((choice.instant, choice.chosen) for choice in leaf.decisions), None):
                places[k].append(node)
                node = after.setdefault(node, {}).setdefault(step, next(fresh))
    names = []
    for k, outcome in enumerate(outcomes):
        if outcome.seed is not None:
            names.append(f"an order drawn at random (sequential:seed={outcome.seed})")
            continue
        parts = [
            f"{choice.chosen.first} hits {choice.chosen.second}"
            for choice, node in zip(outcome.decisions, places[k], strict=False)
            if len(after[node]) > 1
        ]
        more = len(parts) - MOST_CHOICES
        shown = [f"{parts[0]} first", *parts[1:MOST_CHOICES]] if parts else ["as in every order"]
        names.append(", then ".join(shown) + (f", and {counted(more, 'more choice')}" if more > 0 else ""))
    return names


def most_different(outcomes: Sequence[Leaf]) -> str:
    """The circle whose velocity at the end differs most between outcomes."""
    ends = [{str(c.id): (float(c.vx), float(c.vy)) for c in outcome.trajectory.final.circles} for outcome in outcomes]
    return max(ends[0], key=lambda name: max(math.dist(end[name], ends[0][name]) for end in ends))


def spread_phrase(outcomes: Sequence[Leaf]) -> str:
    """In what outcomes differ; empty for a single one."""
    if len(outcomes) < 2:
        return ""
    counts = [outcome.trajectory.collisions for outcome in outcomes]
    low, high = min(counts), max(counts)
    told = f"All have {counted(low, 'collision')}" if low == high else f"They have {low:,} to {high:,} collisions"
    return f"{told}; what differs most is the velocity with which {most_different(outcomes)} ends."


def velocity_phrase(outcome: Leaf, body: str) -> str:
    """The velocity with which a circle ends."""
    (circle,) = (c for c in outcome.trajectory.final.circles if str(c.id) == body)
    return f"({float(circle.vx):.4g}, {float(circle.vy):.4g})"


def orders_sentence(scene: Scene, tree: OrderTree, stop: Stop | None = None) -> str:
    """How many outcomes there are, and whether these are all."""
    found = counted(len(tree.outcomes), "outcome")
    if tree.complete and tree.unproved:
        return (
            f"{scene.name}: at least {found}, over all orders of simultaneous impulses; of "
            f"{counted(tree.unproved, 'more order')} it is not proved that the end is one of these."
        )
    if tree.complete:
        return f"{scene.name}: {found}, over all orders of simultaneous impulses."
    if stop is not None:
        drawn = f", {counted(tree.sampled, 'order')} drawn at random among them" if tree.sampled else ""
        return f"{scene.name}: {found} so far{drawn}: {stop.message}. There may be more."
    return (
        f"{scene.name}: {found} so far: the cap of {tree.cap} was hit, and {counted(tree.sampled, 'order')} "
        "drawn at random beyond it. There are more."
    )


def choices_phrase(outcome: Leaf) -> str:
    """Which contact came first, instant by instant; or the policy that draws the order."""
    if outcome.seed is not None:
        return f"sequential:seed={outcome.seed}"
    return " ".join(f"{first}-{second}" for first, second in (d.chosen for d in outcome.decisions))


def velocities_phrase(outcome: Leaf) -> str:
    """The velocity of each circle at the end."""
    return " ".join(f"{c.id} ({float(c.vx):.6g}, {float(c.vy):.6g})" for c in outcome.trajectory.final.circles)


# -- a shadow


def shadow_sentences(told: Shadow) -> list[str]:
    """What was found, most important first."""
    left = told.divergence
    whose = f"{told.engine} over {counted(told.events, 'event')}"
    found: list[str] = []
    if told.proof is not None:
        found.append(f"Proved: {_claim(told.proof, whose)}.")
        if told.proof.reordered:
            found.append(f"In the whole order {counted(told.proof.reordered, 'independent contact')} are reordered.")
    elif told.blocked is not None:
        found.append(f"Not found: no shadow of {whose}. What stands in the way: {told.blocked.obstacle.value}.")
        found.append(f"{told.blocked.message[0].upper()}{told.blocked.message[1:]}.")
    if left is None:
        found.append("The run has not diverged from the certified history of the scene's own start.")
    else:
        met, got = (name or "nothing" for name in (left.expected, left.got))
        beyond = told.events - left.event - 1 if told.proof is not None else 0
        more = f"; the shadow goes on for {counted(beyond, 'event')} more" if beyond > 0 else ""
        found.append(
            f"The run diverges from the certified history of the scene's own start at event {left.event} "
            f"({left.body} meets {got} instead of {met}){more}."
        )
    if told.drift is not None and told.drift <= (4 + len(told.scene.circles)) * sys.float_info.epsilon:
        found.append("The engine's energy stays what it was, but for the rounding of its states.")
    elif told.drift is not None:
        found.append(f"The engine's energy drifts by {told.drift:.2g} of itself, that of a true orbit by nothing.")
    return found


UPWARDS = Context(prec=3, rounding=ROUND_CEILING)


def at_most(bound: float) -> str:
    """An upper bound in three digits, rounded up: it must not be told too small.

    >>> at_most(3.7643e-13)
    '3.77e-13'
    """
    return f"{UPWARDS.create_decimal(Decimal(bound)):.3g}"


def _claim(proof: Proof, whose: str) -> str:
    start, apart = proof.start, proof.run_distance
    return (
        f"a start within {at_most(start.position)} (velocities: {at_most(start.velocity)}) of the scene's has the "
        f"order of contacts of {whose}, and stays within {at_most(apart.position)} of it throughout (velocities: "
        f"{at_most(apart.velocity)}, times of contacts: {at_most(apart.time)})"
    )


def print_shadow(told: Shadow, best: Shadow | None = None) -> None:
    """Prints it on stdout; `best` is the shadow of a shorter beginning."""
    out = console()
    first, *others = shadow_sentences(told)
    say(out, f"{told.scene.name}: {first}", "bold")
    for sentence in others:
        say(out, sentence)
    if best is not None and best is not told:
        say(out, f"Of a shorter beginning: {shadow_sentences(best)[0]}", "bold")


# -- the smallest scene


def print_smallest(found: Smallest) -> None:
    """Prints what was left out, step by step with the verdict on what was left, and the comparison of the last."""
    from ..reduction.smallest import SceneSize

    out = console()
    say(out, f"{found.original.name}: {size_phrase(SceneSize.of(found.original))}")
    say(out, f"still shown by: {size_phrase(SceneSize.of(found.scene))}", "bold")
    say(out, f"{counted(found.runs, 'comparison')}; {found.end.value}.", None if found.minimal else "yellow")
    if found.steps:
        table = grid("comparison", "left out", "on what is left", whole=("comparison",))
        for step in found.steps:
            candidate = step.comparison.candidates[0]
            broken = candidate.laws.finding if found.law and candidate.laws is not None else None
            phrase = broken or divergence_phrase(step.comparison, candidate)
            table.add_row(f"{step.runs:,}", step.change, phrase)
        out.print(table)
    print_comparison(found.comparison, verbose=True)


def size_phrase(size: SceneSize) -> str:
    """A size in words; the characters are those of the numbers.

    >>> from truebreak.compare.reduction.smallest import SceneSize
    >>> size_phrase(SceneSize(2, 4, 0, None, 39))
    '2 circles, 4 walls, 39 characters'
    """
    things = [
        (size.circles, "circle"),
        (size.walls, "wall"),
        (size.segments, "segment"),
        (size.polygons, "polygon"),
        (size.arcs, "arc"),
        (size.pockets, "pocket"),
        (size.events, "event"),
    ]
    told = [counted(number, noun) for number, noun in things if number]
    return ", ".join([*told, counted(size.characters, "character")])
