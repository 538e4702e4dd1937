"""The log of a run, instant by instant, as a certificate tells it: rounds, entries, the reversal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...exact.replay.contact import places_of
from ...exact.replay.steps import Kick, Step
from ...exact.results.value import ExactValue
from ...scenarios.event import Event, Pocketing
from ...scenarios.numbers.real import Real
from ...scenarios.trajectory import Trajectory

Contact = tuple[int, int]


def instants(trajectory: Trajectory) -> tuple[list[dict[str, Any]], list[frozenset[Contact]]]:
    """The instants from time 0 on, each a dict with `rounds`, `entries` and `reversal`, and the contacts of each.

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
            entries.setdefault(number, []).append([place[happened.circle], pockets[happened.pocket]])
    found: list[dict[str, Any]] = []
    met: list[frozenset[Contact]] = []
    done = 0
    for number in sorted(ends):
        kicks = [step.links for step in steps[done : ends[number]] if isinstance(step, Kick)]
        rounds = [[list(places_of(scene, link)) for link in links] for links in kicks]
        told = {"rounds": rounds, "entries": entries.get(number, [])}
        done = max(done, ends[number])
        if number % 2:
            if number - 1 not in ends:
                found.append({"rounds": [], "entries": []})
                met.append(frozenset())
            found[-1]["reversal"] = told
        else:
            found.append(told)
            met.append(frozenset(contacts.get(number, ())))
    return found, met


def _instant(time: Real) -> tuple[ExactValue, int]:
    """A time of an exact run, and the number of its instant."""
    assert isinstance(time, ExactValue) and time.instant is not None
    return time, time.instant
