"""Chaos along one run, on the terminal and as one HTML file that needs no network."""

from __future__ import annotations

import csv
import io
import math
import shlex
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from ..files.amounts import counted
from .charts import NARROW, WIDE, Curve, ForecastBand, plot
from .documents import chaos_json
from .listing import laid_out
from .output import console, grid, say
from .page import Download, download, file_name, limits_of, provenance_of, rendered, scene_file, stem_of
from .player import played
from .sentences import listed

if TYPE_CHECKING:
    from ..chaos.certified_chaos import Chaos
    from ..chaos.horizon import EventTime, Horizon
    from ..chaos.spectrum import Rate

SHOWN_EXPONENTS = 12
"""Exponents listed for people; the JSON has all."""

HORIZON_HEADINGS = ("engine", "predicted to diverge at event", "90 % interval", "at time", "what happened")
EXPONENT_HEADING = "ln(1/eps)/lambda"
"""The time by the largest exponent alone."""


def rate_phrase(rate: Rate) -> str:
    """A rate with its interval.

    >>> from truebreak.compare.chaos.spectrum import Rate
    >>> rate_phrase(Rate(0.25, 0.2, 0.3, 20)), rate_phrase(Rate(0.25))
    ('0.25 (95 %: 0.2 to 0.3)', '0.25 (too short for an interval)')
    """
    if rate.low is None or rate.high is None:
        return f"{rate.value:.4g} (too short for an interval)"
    return f"{rate.value:.4g} (95 %: {rate.low:.4g} to {rate.high:.4g})"


def lead(chaos: Chaos) -> str:
    """How long to trust which engine: the one of doubles if it was asked about, else the first; else the exponent."""
    chosen = next((h for h in chaos.horizons if h.engine == "double"), chaos.horizons[0] if chaos.horizons else None)
    if chosen is None:
        return f"{_growth_sentence(chaos)} No engine was asked about."
    place = None if chosen.seen is None else chosen.seen.place
    if place is not None and place.event is not None and place.event < (chosen.low.event or chaos.events):
        early = f"it was run, and {_word(chosen)} there, earlier than predicted"
        return f"Do not trust {chosen.engine} beyond event {place.event:,}: {early}."
    return f"{trust_phrase(chosen, chaos.events)}{_outcome(chosen)}."


def trust_phrase(horizon: Horizon, events: int) -> str:
    """For how many events an engine can be trusted, with the 90 % prediction interval."""
    name, low, middle, high = horizon.engine, *(p.event for p in (horizon.low, horizon.expected, horizon.high))
    if low is None:
        return f"Trust {name} for all {counted(events, 'event')} that were measured"
    if middle is None:
        return f"Trust {name} for {counted(low, 'event')} at least, and perhaps for all {events:,} that were measured"
    if not middle:
        return f"Do not trust {name} for a single event"
    to = f"{high:,}" if high is not None else f"more than {events:,}"
    return f"Trust {name} for about {counted(middle, 'event')} ({low:,} to {to})"


def _outcome(horizon: Horizon) -> str:
    """What came of running it."""
    seen = horizon.seen
    if seen is None:
        return ""
    if seen.place is None:
        return f"; it was run, and {'agrees to the end' if seen.verdict == 'agree' else _word(horizon)}"
    return f"; it was run, and {_word(horizon)} at event {seen.place.event:,}"


def _word(horizon: Horizon) -> str:
    """What it did, in a sentence."""
    verdict = "not run" if horizon.seen is None else str(horizon.seen.verdict)
    return "diverged" if verdict == "diverged" else f"was {verdict}"


def _growth_sentence(chaos: Chaos) -> str:
    found = chaos.spectrum
    value, per_event = found.per_time(), found.per_event()
    told = f"Errors grow by {per_event.value / math.log(2):.3g} bits an event"
    return f"{told} (largest Lyapunov exponent {value.value:.3g} per unit time, an estimate)."


def sentences(chaos: Chaos) -> list[str]:
    """The answer, one sentence each; the first leads."""
    told = [lead(chaos)]
    if chaos.horizons:
        told.append(_growth_sentence(chaos))
    found = chaos.spectrum
    if not found.chaotic:
        would = f"would give {found.linear:.3g} here" if math.isfinite(found.linear) else "may give as much"
        told.append(
            f"The exponent cannot be distinguished from zero: displacements that grow in proportion to time {would}. "
            "Take more events."
        )
    if chaos.horizons and not found.chaotic:
        told.append(
            "The predictions hold where small errors change who meets next. Here it is not known that growth goes on, "
            "and engines may last longer."
        )
    if chaos.exact:
        told.append(f"No horizon: {listed([*chaos.exact])}, whose numbers are exact.")
    return told


def details(chaos: Chaos) -> list[str]:
    """What was measured, with every digit."""
    found = chaos.spectrum
    value, per_event = found.per_time(), found.per_event()
    told = [
        f"Largest Lyapunov exponent, an estimate: {rate_phrase(value)} per unit time, over "
        f"{counted(chaos.events, 'event')} to time {chaos.time:.6g}.",
        f"Per event: {rate_phrase(per_event)}. In bits: {value.value / math.log(2):.4g} a unit of time, "
        f"{per_event.value / math.log(2):.4g} an event.",
    ]
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
    elif volume is not None:
        told.append(f"Check: the volume shrinks by e**2 an impulse, to {abs(volume):.1g}.")
    count = found.gains.shape[1]
    listed_values = ", ".join(f"{found.per_time(k).value:.4g}" for k in range(min(count, SHOWN_EXPONENTS)))
    more = f", and {count - SHOWN_EXPONENTS} more" if count > SHOWN_EXPONENTS else ""
    told.append(f"Spectrum, {count} of {found.dimension}: {listed_values}{more}.")
    return told


def horizon_rows(chaos: Chaos) -> list[tuple[str, ...]]:
    """One row an engine, under `HORIZON_HEADINGS`."""
    return [_row(horizon, chaos.events) for horizon in chaos.horizons]


def _row(horizon: Horizon, events: int) -> tuple[str, ...]:
    ends = dict.fromkeys(_event(end, events) for end in (horizon.low, horizon.high))
    time = "" if horizon.expected.time is None else f"{horizon.expected.time:.5g}"
    return horizon.engine, _event(horizon.expected, events), " to ".join(ends), time, _seen(horizon, events)


def _by_exponent(horizon: Horizon) -> str:
    return "-" if horizon.by_exponent is None else f"{horizon.by_exponent:.5g}"


def _event(place: EventTime, events: int) -> str:
    return f"after {events - 1:,}" if place.event is None else f"{place.event:,}"


def _seen(horizon: Horizon, events: int) -> str:
    seen = horizon.seen
    if seen is None:
        return "not run"
    if seen.place is None:
        return f"{'agrees' if seen.verdict == 'agree' else seen.verdict} to event {events - 1:,}"
    word = "inside" if horizon.holds(seen.place) else "outside"
    return f"{seen.verdict} at event {seen.place.event:,}, t = {seen.place.time:.5g}: {word} the interval"


def print_chaos(chaos: Chaos, *, verbose: bool = False) -> None:
    """Prints the answer on stdout.

    Args:
        verbose: whether also exponents, spectrum and checks.
    """
    out = console()
    first, *others = sentences(chaos)
    say(out, f"{chaos.scene.name}: {first}", "bold")
    for sentence in others:
        say(out, sentence)
    if chaos.horizons:
        table = grid(*HORIZON_HEADINGS, *[EXPONENT_HEADING] * verbose)
        for row, horizon in zip(horizon_rows(chaos), chaos.horizons, strict=True):
            table.add_row(*row, *[_by_exponent(horizon)] * verbose)
        out.print(table)
    for sentence in details(chaos) if verbose else []:
        say(out, sentence)


# ----------------------------------------
# Chaos along one run as one HTML file that needs no network.

CONVERGENCE_POINTS = 100

PLAYER = {
    "title": "The run",
    "choice": "engine",
    "note": "The certified run, to play or to step through event by event. "
    "The line in the plot below follows the clock, and a click there sets it.",
}


def chaos_html(chaos: Chaos, *, command: str = "") -> str:
    """The page: sentences, horizons, the run to play, the growth of errors with the horizons in it, the exponents.

    Args:
        command: the command line that the measurement came from, to be told in the page.
    """
    name = chaos.reference.engine
    return rendered(
        "chaos.html.jinja",
        recording=played(chaos.scene, chaos.reference, [], name=name, title=name),
        engines=[horizon.engine for horizon in chaos.horizons] or [name],
        title=f"{chaos.scene.name}, chaos: truebreak",
        lead=lead(chaos),
        sentences=sentences(chaos)[1:],
        details=details(chaos),
        scene=chaos.scene,
        headings=(*HORIZON_HEADINGS, EXPONENT_HEADING),
        rows=[(*row, _by_exponent(h)) for row, h in zip(horizon_rows(chaos), chaos.horizons, strict=True)],
        barred=[(k, h.engine) for k, h in enumerate(chaos.horizons) if h.low.time is not None],
        growth=[_growth(chaos, width) for width in (WIDE, NARROW)],
        convergence=[_convergence(chaos, width) for width in (WIDE, NARROW)],
        interval=chaos.spectrum.per_time().low is not None,
        exponents=_exponents(chaos),
        dimension=chaos.spectrum.dimension,
        provenance=provenance_of(
            chaos.scene,
            [(name, chaos.reference.parameters), *_models(chaos)],
            command or _command(chaos),
            _files(chaos),
        ),
        player=PLAYER,
        footnote="Solid and blue: the exact run.",
    )


def _growth(chaos: Chaos, width: int) -> Markup:
    growth = Curve("worst error", [(grown.time, grown.bits) for grown in chaos.growth], "reference")
    bands = [
        ForecastBand(
            horizon.engine,
            horizon.low.time,
            chaos.time if horizon.high.time is None else horizon.high.time,
            -horizon.unit,
            None if horizon.seen is None or horizon.seen.place is None else horizon.seen.place.time,
            f"e{number}",
        )
        for number, horizon in enumerate(chaos.horizons)
        if horizon.low.time is not None
    ]
    return _plot("Growth of the worst error", "bits", [growth], bands, width)


def _convergence(chaos: Chaos, width: int) -> Markup:
    rate = chaos.spectrum.per_time()
    estimates = [(time, value) for _, time, value in chaos.spectrum.running(CONVERGENCE_POINTS)]
    limits = [
        Curve(label, [(0.0, value), (chaos.time, value)], "bound")
        for label, value in (("95 %, low", rate.low), ("95 %, high", rate.high))
        if value is not None
    ]
    curves = [Curve("estimate", estimates, "reference"), *limits]
    return _plot("The largest exponent as it converges", "per unit time", curves, [], width)


def _plot(title: str, up: str, curves: list[Curve], bands: list[ForecastBand], width: int) -> Markup:
    kind = "narrow" if width == NARROW else "wide"
    return Markup(plot(title, "time", up, curves, bands, width=width, legend=False, kind=kind))


def _exponents(chaos: Chaos) -> list[tuple[str, ...]]:
    found = chaos.spectrum
    rows = []
    for k in range(found.gains.shape[1]):
        rate = found.per_time(k)
        ends = ("" if end is None else f"{end:.5g}" for end in (rate.low, rate.high))
        rows.append((str(k + 1), f"{rate.value:.5g}", *ends, f"{found.per_event(k).value / math.log(2):.4g}"))
    return rows


def _models(chaos: Chaos) -> Iterator[tuple[str, dict[str, Any]]]:
    for horizon in chaos.horizons:
        yield horizon.engine, {"predicted by": horizon.model.value, "unit of error": f"2**{horizon.unit:.6g}"}


def _command(chaos: Chaos) -> str:
    """A command that measures it again, from the scene as saved from the page."""
    engines = ",".join([*(h.engine for h in chaos.horizons), *chaos.exact]) or "none"
    limits = [] if chaos.events < len(chaos.reference.events) else limits_of(chaos.reference)
    return shlex.join(["truebreak", "chaos", file_name(chaos.scene), "--engines", engines, *limits])


def _files(chaos: Chaos) -> Iterator[Download]:
    file, stem = scene_file(chaos.scene), stem_of(chaos.scene)
    if file is not None:
        yield file
    told = laid_out(chaos_json(chaos)) + "\n"
    yield download(
        f"{stem}-chaos.json", "all results (JSON)", "application/json", told, "the command above, with --json"
    )
    text = io.StringIO()
    table: Any = csv.writer(text, lineterminator="\n")
    table.writerow(("event", "time", "bits"))
    table.writerows((grown.event, repr(grown.time), repr(grown.bits)) for grown in chaos.growth)
    yield download(f"{stem}-growth.csv", "the growth of the worst error (CSV)", "text/csv", text.getvalue(), "the JSON")
