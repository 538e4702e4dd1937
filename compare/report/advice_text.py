"""Advice as the JSON object `truebreak/advice-2`, and for people."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..grids.goals import Digits, OutcomeGoal
from ..grids.setting_search import SearchEnd
from .documents import Encoder

if TYPE_CHECKING:
    from ..grids.setting_search import Advice, Tried

ADVICE_SCHEMA = "truebreak/advice-2"

SHOWN = 4
"""Settings of one kind that are named in a sentence; the JSON has all."""


def advice_json(advice: Advice) -> dict[str, Any]:
    """The object that `truebreak advise --json` prints. `scene` is null for the scene itself, else the seed."""
    goal, named, cheaper = advice.goal, advice.named, advice.cheaper
    found = None
    if named is not None and advice.cost is not None:
        found = {**_setting(named), "may_fail": may_fail(named.of), "seconds": advice.cost.seconds,
                 "exact_seconds": advice.cost.exact_seconds}  # fmt: skip
    return {
        "schema": ADVICE_SCHEMA,
        "sentence": sentences(advice)[0],
        "scene": Encoder(None)(advice.instances[0].study.reference.scene),
        "goal": {
            "told": str(goal),
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
        "perturbed": [{"seed": one.seed, "scene": one.study.scene.data()} for one in advice.instances[1:]],
    }


def _setting(tried: Tried) -> dict[str, Any]:
    return {"engine": tried.setting.text, "work": tried.setting.work, "steps": tried.setting.steps}


def _tried(tried: Tried) -> dict[str, Any]:
    on = [{"scene": seed, "right": told.right, "agreed": told.agreed, "told": told.told}
          for seed, told in tried.judged.items()]  # fmt: skip
    return {**_setting(tried), "right": tried.right, "on": on}


def sentences(advice: Advice) -> list[str]:
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
    wrong = [f"{tried.setting.text} is not ({_listed_scenes(tried)})" for tried in advice.instead if not tried.right]
    if right:
        (tried,) = right
        return [f"{tried.setting.text} is right there, on {tried.of} of {tried.of}" +
                (f"; {'; '.join(wrong)}." if wrong else ".")]  # fmt: skip
    return [f"{'; '.join(wrong)}."] if wrong else []


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
    return f"{_scene(first)}: {tried.judged[first].told}{more}"


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
                    + ("the budget is spent." if advice.spent else "there is none."))  # fmt: skip
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
    from .output import console, grid, say

    out = console()
    first, *others = sentences(advice)
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
            f"{_scene(wrong[0])}: {tried.judged[wrong[0]].told}" if wrong else "",
        )
    if shown:
        out.print(table)


ROWS = 6
"""Settings shown to people up to the one that is right."""
