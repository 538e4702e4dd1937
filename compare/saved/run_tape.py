"""What a run leaves for one that goes on from it, as JSON, and back."""

from __future__ import annotations

from typing import Any

from ...exact.replay.contact import Entry
from ...exact.simulation.decider import Limits
from ...exact.simulation.instant import Instant
from ...exact.simulation.loop import Found, Reached, Tape
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.trajectory import Contact, Tie, TieProof
from .run_numbers import Written, link_of, links_data, links_of, set_time_data


def tape_data(tape: Tape | None) -> Written:
    """A tape, up to where all that followed from its instants is known."""
    if tape is None:
        return None
    limits, reached = tape.limits, tape.reached or Reached(0, {}, 0, 0)
    return {
        "limits": [None if limits.until is None else set_time_data(limits.until), limits.events, limits.to_return],
        "begun": tape.reached is not None,
        "plan": reached.plan,
        "assumed": reached.assumed,
        "rises": [list(rise) for rise in tape.rises[: reached.rises]],
        "grazes": [
            [number, links_data(links)]
            for number, links in tape.grazes.items()
            if number // 2 <= reached.instants
        ],
        "instants": [_found_data(found) for found in tape.whole()],
    }  # fmt: skip


def tape_of_data(data: Written) -> Tape | None:
    """What `tape_data` wrote."""
    if data is None:
        return None
    until, events, to_return = data["limits"]
    found = [_found_of(row, 2 * k) for k, row in enumerate(data["instants"], 1)]
    rises = [(bits, centred) for bits, centred in data["rises"]]
    return Tape(
        Limits(None if until is None else Quantity.of(until), events, to_return),
        found,
        Reached(len(found), data["plan"], len(rises), data["assumed"]) if data["begun"] else None,
        rises,
        {number: [link_of(link) for link in links] for number, links in data["grazes"]},
    )


def _found_data(found: Found) -> Written:
    """A contact alone as itself; of anything else what is not as it is by default."""
    if not isinstance(found, Instant):
        return list(found)
    told = {
        "hits": links_data(found.hits),
        "touches": [[list(link), sign] for link, sign in found.touches.items()],
        "arrivals": links_data(found.arrivals),
        "rims": links_data(sorted(found.rims)),
        "ties": [tie_data(tie) for tie in found.ties],
        "clock": None if found.clock is None else list(found.clock),
        "reversal": found.reversal,
        "moment": None if found.moment is None else set_time_data(found.moment),
    }
    return {key: value for key, value in told.items() if value}


def _found_of(data: Written, number: int) -> Found:
    if isinstance(data, list):
        (touch,) = links_of([data])
        return touch
    moment = data.get("moment")
    return Instant(
        number,
        hits=links_of(data.get("hits", ())),
        touches={touch: sign for link, sign in data.get("touches", ()) for touch in links_of([link])},
        arrivals=entries_of(data.get("arrivals", ())),
        rims=frozenset(entries_of(data.get("rims", ()))),
        ties=tuple(map(tie_of, data.get("ties", ()))),
        clock=link_of(data["clock"]) if "clock" in data else None,
        reversal=data.get("reversal", False),
        moment=None if moment is None else Quantity.of(moment),
    )


def tie_data(tie: Tie) -> Written:
    """A tie."""
    return [tie.contacts, tie.proof.name, tie.bound]


def tie_of(data: Written) -> Tie:
    """What `tie_data` wrote."""
    contacts, proof, bound = data
    return Tie(contacts_of(contacts), TieProof[proof], bound)


def contacts_of(data: Any) -> tuple[Contact, ...]:
    """Contacts by id."""
    return tuple(Contact(first, second) for first, second in data)


def entries_of(data: Written) -> tuple[Entry, ...]:
    """Entries into pockets."""
    return tuple(link for link in map(link_of, data) if isinstance(link, Entry))
