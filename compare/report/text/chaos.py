"""Chaos along one run in sentences and rows, and on the terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ..counting import counted
from ..sentences import listed
from .output import console, grid, say

if TYPE_CHECKING:
    from ...chaos.chaos import Chaos
    from ...chaos.growth.blocks import Rate
    from ...chaos.horizon import EventTime, Horizon

SHOWN_EXPONENTS = 12
"""Exponents listed for people; the JSON has all."""

HORIZON_HEADINGS = ("engine", "foreseen at event", "90 % band", "time", "ln(1/eps)/lambda", "what happened")


def rate_phrase(rate: Rate) -> str:
    """A rate with its interval.

    >>> from truebreak.compare.chaos.growth.blocks import Rate
    >>> rate_phrase(Rate(0.25, 0.2, 0.3, 20)), rate_phrase(Rate(0.25))
    ('0.25 (95 %: 0.2 to 0.3)', '0.25 (too short for an interval)')
    """
    if rate.low is None or rate.high is None:
        return f"{rate.value:.4g} (too short for an interval)"
    return f"{rate.value:.4g} (95 %: {rate.low:.4g} to {rate.high:.4g})"


def sentences(chaos: Chaos) -> list[str]:
    """What was measured, one sentence each; the first leads."""
    found = chaos.spectrum
    value, per_event = found.per_time(), found.per_event()
    told = [
        f"Largest Lyapunov exponent, an estimate: {rate_phrase(value)} per unit time, over "
        f"{counted(chaos.events, 'event')} to time {chaos.time:.6g}.",
        f"Per event: {rate_phrase(per_event)}. In bits: {value.value / math.log(2):.4g} a unit of time, "
        f"{per_event.value / math.log(2):.4g} an event.",
    ]
    if not found.chaotic:
        would = f"would give {found.linear:.3g} here" if math.isfinite(found.linear) else "may give as much"
        told.append(f"Not told from zero: displacements that grow in proportion to time {would}. Take more events.")
    if chaos.certified is not None:
        grown = chaos.certified
        told.append(
            f"Certified growth of the worst error from time 0 through {counted(grown.events, 'event')}: between "
            f"{grown.low!r} and {grown.high!r} bits (proved, in balls of {grown.bits} bits)."
        )
    entropy, pairing, volume = found.entropy(), found.pairing(), found.volume()
    if entropy is not None and pairing is not None and volume is not None:
        told.append(f"Sum of the exponents that are not negative (Kolmogorov-Sinai): {rate_phrase(entropy)}.")
        told.append(
            f"Checks: exponents come in pairs of opposite sign, to {pairing:.2g}; volume is kept, to {abs(volume):.1g}."
        )
    count = found.gains.shape[1]
    listed_values = ", ".join(f"{found.per_time(k).value:.4g}" for k in range(min(count, SHOWN_EXPONENTS)))
    more = f", and {count - SHOWN_EXPONENTS} more" if count > SHOWN_EXPONENTS else ""
    told.append(f"Spectrum, {count} of {found.dimension}: {listed_values}{more}.")
    if chaos.horizons and not found.chaotic:
        told.append(
            "The events foreseen hold where small errors change who meets next. Here growth that goes on is not told, "
            "and engines may hold out longer."
        )
    if chaos.exact:
        told.append(f"No horizon: {listed([*chaos.exact])}, whose numbers are exact.")
    return told


def horizon_rows(chaos: Chaos) -> list[tuple[str, ...]]:
    """One row an engine, under `HORIZON_HEADINGS`."""
    return [_row(horizon, chaos.events) for horizon in chaos.horizons]


def _row(horizon: Horizon, events: int) -> tuple[str, ...]:
    ends = dict.fromkeys(_event(end, events) for end in (horizon.low, horizon.high))
    time = "" if horizon.expected.time is None else f"{horizon.expected.time:.5g}"
    return (
        horizon.engine,
        _event(horizon.expected, events),
        " to ".join(ends),
        time,
        "-" if horizon.by_exponent is None else f"{horizon.by_exponent:.5g}",
        _seen(horizon, events),
    )


def _event(place: EventTime, events: int) -> str:
    return f"beyond {events - 1}" if place.event is None else str(place.event)


def _seen(horizon: Horizon, events: int) -> str:
    seen = horizon.seen
    if seen is None:
        return "not run"
    if seen.place is None:
        return f"{'agrees' if seen.verdict == 'agree' else seen.verdict} to event {events - 1}"
    word = "inside" if horizon.holds(seen.place) else "outside the band"
    return f"{seen.verdict} at event {seen.place.event}, t = {seen.place.time:.5g}: {word}"


def print_chaos(chaos: Chaos) -> None:
    """Prints all of it on stdout."""
    out = console()
    first, *others = sentences(chaos)
    say(out, f"{chaos.scene.name}: {first}", "bold")
    for sentence in others:
        say(out, sentence)
    if chaos.horizons:
        table = grid(*HORIZON_HEADINGS)
        for row in horizon_rows(chaos):
            table.add_row(*row)
        out.print(table)
