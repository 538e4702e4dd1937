"""Chaos along one run as one HTML file that needs no network."""

from __future__ import annotations

import csv
import io
import math
import shlex
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from ..files.documents import chaos_json
from .page.provenance import Download, download, file_name, limits_of, provenance_of, scene_file, stem_of
from .page.recording import played
from .page.rendering import rendered
from .pictures.curves import Band, Curve, plot
from .pictures.plot import NARROW, WIDE
from .text.chaos import HORIZON_HEADINGS, horizon_rows, sentences
from .text.listing import laid_out

if TYPE_CHECKING:
    from ..chaos.chaos import Chaos

CONVERGENCE_POINTS = 100

PLAYER = {
    "title": "The run",
    "choice": "engine",
    "note": "The line in the plot below follows the clock, and a click there sets it.",
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
        engines=max(1, len(chaos.horizons)),
        title=f"{chaos.scene.name}, chaos: truebreak",
        lead=sentences(chaos)[0],
        sentences=sentences(chaos)[1:],
        scene=chaos.scene,
        headings=HORIZON_HEADINGS,
        rows=horizon_rows(chaos),
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
        Band(
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


def _plot(title: str, up: str, curves: list[Curve], bands: list[Band], width: int) -> Markup:
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
        yield horizon.engine, {"foreseen by": horizon.model.value, "unit of error": f"2**{horizon.unit:.6g}"}


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
