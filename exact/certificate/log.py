"""The log of a run, instant by instant, as a certificate tells it: rounds, entries, the reversal."""

from __future__ import annotations

from typing import Any

from ...scenarios.trajectory import Trajectory
from ..replay.contact import places_of
from ..replay.steps import Kick
from .scene_text import exact_number, text_of

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
    times: list[Any] = [event.time for event in trajectory.events] + [entry.time for entry in trajectory.pocketings]
    if trajectory.reversal is not None:
        times.append(trajectory.reversal.time)
    for time in times:
        ends[time.instant] = max(time.upto, ends.get(time.instant, 0))
    for event in trajectory.events:
        time: Any = event.time
        contacts[time.instant] = {(place[a], place[b]) for a, b in event.contacts}
    for entry in trajectory.pocketings:
        when: Any = entry.time
        entries.setdefault(when.instant, []).append([place[entry.circle], -1 - pockets[entry.pocket]])
    steps = _steps(times)
    found: list[dict[str, Any]] = []
    met: list[frozenset[Contact]] = []
    done = 0
    for number in sorted(ends):
        kicks = [step.links for step in steps[done : ends[number]] if isinstance(step, Kick)]
        rounds = [[list(places_of(scene, link)) for link in links] for links in kicks]
        turn = {"turn": True} if number % 2 else {}
        if turn and number - 1 not in ends:
            found.append({"exact": text_of(exact_number(scene.reverse_at)), "rounds": [], "enter": []})
            met.append(frozenset())
        found.append({**turn, "rounds": rounds, "enter": entries.get(number, [])})
        met.append(frozenset(contacts.get(number, ())))
        done = max(done, ends[number])
    return found, met


def _steps(times: list[Any]) -> Any:
    """The log; empty where nothing happened."""
    return times[0].log.steps if times else ()
