"""The log of a run, instant by instant, as a certificate tells it: rounds, entries, the reversal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...exact.exact_motion import ExactValue
from ...exact.replay.contact import places_of
from ...exact.replay.state import Kick, Step
from ...scenarios.numbers.quantity import Real
from ...scenarios.trajectory import Event, Pocketing, Trajectory
from .scene_text import exact_number, text_of

Contact = tuple[int, int]


def instants(trajectory: Trajectory) -> tuple[list[dict[str, Any]], list[frozenset[Contact]]]:
    """The instants from time 0 on, each a dict with `rounds`, `enter` and perhaps `turn`, and the contacts of each.

    The first is time 0, whether anything falls on it or not.
    """
    scene = trajectory.scene
    place = {name: k for k, name in enumerate(scene.ids)}
    pockets = {str(pocket.id): k for k, pocket in enumerate(scene.pockets)}
    ends: dict[int, int] = {0: 0}
    contacts: dict[int, set[Contact]] = {}
    entries: dict[int, list[list[int]]] = {}
    steps: Sequence[Step] = ()
    for happened in (*trajectory.events, *trajectory.pocketings, trajectory.reversal):
        if happened is None:
            continue
        time, number = _instant(happened.time)
        steps = time.log.steps
        ends[number] = max(time.upto, ends.get(number, 0))
        if isinstance(happened, Event):
            contacts[number] = {(place[a], place[b]) for a, b in happened.contacts}
        elif isinstance(happened, Pocketing):
            entries.setdefault(number, []).append([place[happened.circle], -1 - pockets[happened.pocket]])
    found: list[dict[str, Any]] = []
    met: list[frozenset[Contact]] = []
    done = 0
    for number in sorted(ends):
        kicks = [step.links for step in steps[done : ends[number]] if isinstance(step, Kick)]
        rounds = [[list(places_of(scene, link)) for link in links] for links in kicks]
        turn = {"turn": True} if number % 2 else {}
        if turn and number - 1 not in ends and scene.reverse_at is not None:
            found.append({"exact": text_of(exact_number(scene.reverse_at)), "rounds": [], "enter": [], "time": "0"})
            met.append(frozenset())
        enter, pushed = entries.get(number, []), contacts.get(number, set())
        clocks = {} if turn or not number else {"met": [list(c) for c in sorted(pushed)] or list(enter)}
        found.append({**turn, **clocks, "rounds": rounds, "enter": enter, "time": "0"})
        met.append(frozenset(pushed))
        done = max(done, ends[number])
    return found, met


def _instant(time: Real) -> tuple[ExactValue, int]:
    """A time of an exact run, and the number of its instant."""
    assert isinstance(time, ExactValue) and time.instant is not None
    return time, time.instant
