"""One case, every check: the referee for all, a map, a cut or the interval engine for some, by the seed."""

from __future__ import annotations

import time as clock
from dataclasses import dataclass
from random import Random
from typing import Any

from fuzz.check import GAVE_UP, STATES_ASKED, Difference, compare
from fuzz.draft import Case
from fuzz.generators import case_of
from fuzz.ingredients import exercised, mixed
from fuzz.maps import MAPS, check_cut, check_interval, check_map
from fuzz.referee import referee
from fuzz.relations import FEW_CELLS, again, cells_from, check_relations, resumed_on_the_way, the_same, with_one_at_rest
from fuzz.table import Doubt, TooLong
from truebreak.exact import ExactEngine
from truebreak.exact.exact_engine import DEFAULT_WORK
from truebreak.exact.simulation.cells import FEWEST as DEFAULT_CELLS
from truebreak.floating import IntervalEngine

MODES = ("map", "plain", "cut", "plain", "map", "interval", "plain", "plain")
"""Which further check a seed gets."""
BY_INTERVALS = ("hairs", "near_ties", "graze_blow", "apart", "dyads")
"""Kinds whose plain seeds get the interval engine in doubles: their ties are closer than those."""
THERE_AND_BACK = ("undone", "again", "home", "strayed")
"""Kinds whose plain seeds are broken off and resumed: what the way out tells of the way back has to be kept."""
AIMED = (
    "alike",
    "hairs",
    "late",
    "neighbours",
    "home",
    "strayed",
    "undone",
    "again",
    "abreast",
    "strokes",
    "on_rim",
    "dips",
    "dyads",
    "raft",
    "swift",
    "loose",
)
"""Kinds that each aim at one thing which scenes by the covering array seldom bring close enough: one of them is played
beside each of those, by turns."""


@dataclass(frozen=True)
class Verdict:
    """What came of one case.

    Attributes:
        outcome: "ok", "undecided" or "budget" (right as far as it goes), "failure", "interval" (only the interval
            engine is wrong), "skipped" (the referee has nothing to say), or "hang".
        endless: whether the impulses of an instant have no end.
    """

    kind: str
    seed: int
    outcome: str
    events: int
    seconds: float
    message: str = ""
    extra: str = ""
    endless: bool = False
    exercised: tuple[str, ...] = ()
    """Of a scene by the covering array: the ingredients that took part."""


FEW_WORK = 200_000
"""Work allowed where the referee knows that the impulses of an instant have no end: enough for all before it."""


def examine(kind: str, seed: int, modes: bool = True, work: int = DEFAULT_WORK) -> Verdict:
    """Runs one case through the exact engine, which has so much work for a question, and holds it against all that is
    known of it."""
    if kind == "mixed":
        return examine_mixed(seed, modes, work)
    start = clock.perf_counter()

    def verdict(outcome: str, events: int, message: str = "", extra: str = "", endless: bool = False) -> Verdict:
        return Verdict(kind, seed, outcome, events, round(clock.perf_counter() - start, 4), message, extra, endless)

    try:
        case = case_of(kind, seed)
        told = referee(case.scene, case.until, case.events)
    except (Doubt, TooLong) as error:
        return verdict("skipped", 0, repr(error))
    except Exception as error:
        return verdict("failure", 0, f"generator or referee: {type(error).__name__}: {error}")
    extra, endless = "", told.stop == "ENDLESS"
    engine = ExactEngine(work=FEW_WORK if endless else work)
    try:
        run = engine.run(case.scene, until=case.until, events=case.events)
        compare(run, told)
        if modes:
            extra = further(kind, seed, run, case, engine)
    except Difference as difference:
        wrong = "interval" if str(difference).startswith("interval") else "failure"
        return verdict(wrong, len(told.events), str(difference), extra, endless)
    except Exception as error:
        return verdict("failure", len(told.events), f"{type(error).__name__}: {error}", extra, endless)
    stop = run.stop.reason.name
    if stop in GAVE_UP:
        return verdict(stop.lower(), len(told.events), run.stop.message, extra, endless)
    return verdict("ok", len(told.events), "", extra, endless)


def aimed(seed: int) -> tuple[str, int]:
    """The scene of an older kind that is played beside one by the covering array."""
    return AIMED[seed % len(AIMED)], seed // len(AIMED)


def examine_mixed(seed: int, modes: bool = True, work: int = DEFAULT_WORK) -> Verdict:
    """As `examine`, for a scene by the covering array: with the relations of its row, a scene of an older kind beside
    it, and what of the row took part."""
    start = clock.perf_counter()

    def verdict(outcome: str, events: int, message: str = "", extra: str = "", **more: Any) -> Verdict:
        seconds = round(clock.perf_counter() - start, 4)
        return Verdict("mixed", seed, outcome, events, seconds, message, extra, **more)

    try:
        mix = mixed(seed)
        case = mix.case
        told = referee(case.scene, case.until, case.events)
    except (Doubt, TooLong) as error:
        return verdict("skipped", 0, repr(error))
    except Exception as error:
        return verdict("failure", 0, f"generator or referee: {type(error).__name__}: {error}")
    endless, checks, count = told.stop == "ENDLESS", frozenset[str](), len(told.events)
    engine = ExactEngine(work=FEW_WORK if endless else work)
    with cells_from(FEW_CELLS if "crowd" in mix.row else DEFAULT_CELLS):
        try:
            run = engine.run(case.scene, until=case.until, events=case.events)
            compare(run, told, 1 if seed % 4 else STATES_ASKED)
            if modes and not endless:
                checks = check_relations(run, mix, seed, engine)
        except Difference as difference:
            wrong = "interval" if str(difference).startswith("interval") else "failure"
            return verdict(wrong, count, str(difference), endless=endless)
        except Exception as error:
            return verdict("failure", count, f"{type(error).__name__}: {error}", endless=endless)
    if modes:
        kind, number = aimed(seed)
        other = examine(kind, number, work=work)
        if other.outcome in ("failure", "interval"):
            return verdict(other.outcome, count, f"beside it, {kind} {number}: {other.message}", endless=endless)
        checks |= {"beside"} if other.outcome == "ok" else set()
    stop, found = run.stop.reason.name, tuple(sorted(exercised(mix, told, run, checks)))
    outcome = stop.lower() if stop in GAVE_UP else "ok"
    message = run.stop.message if stop in GAVE_UP else ""
    return verdict(outcome, count, message, " ".join(sorted(checks)), endless=endless, exercised=found)


def further(kind: str, seed: int, run: Any, case: Case, engine: Any) -> str:
    """The check that a seed adds; its name, or nothing where it did not apply.

    Raises:
        Difference: where it fails.
    """
    draw, mode = Random(f"{kind}:{seed}:further"), MODES[seed % len(MODES)]
    if mode == "map":
        by = draw.choice([m for m in MAPS if m.fits(case.scene)])
        return "map" if check_map(run, case, by, engine) else ""
    if mode == "cut":
        return "cut" if check_cut(run, case, draw, engine) else ""
    if mode == "plain" and kind in THERE_AND_BACK:
        return "resume" if resumed_on_the_way(run, case, draw, engine) else ""
    if mode == "plain" and kind == "loose":
        with cells_from(FEW_CELLS):
            return "cells" if the_same(run, again(case, engine), "with cells") else ""
    plain = mode == "plain" and kind in BY_INTERVALS
    if plain:
        with_one_at_rest(run, case, engine)
    if (mode == "interval" or plain) and run.stop.reason.name not in GAVE_UP:
        check_interval(run, case, IntervalEngine(bits=53 if plain else draw.choice([53, 120, 300])))
        return "interval"
    return ""
