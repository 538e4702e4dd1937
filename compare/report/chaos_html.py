"""Chaos along one run as one HTML file that needs no network."""

from __future__ import annotations

from typing import TYPE_CHECKING

import jinja2
from markupsafe import Markup

from .chaos_text import HORIZON_HEADINGS, horizon_rows, sentences
from .curves import Band, Curve, plot

if TYPE_CHECKING:
    from ..chaos.chaos import Chaos

CONVERGENCE_POINTS = 100


def chaos_html(chaos: Chaos) -> str:
    """The page: sentences, horizons, the growth of errors with the horizons in it, and how the exponent converges."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader(__package__ or "", ""), autoescape=True, trim_blocks=True, lstrip_blocks=True
    )
    growth = Curve("worst error", [(grown.time, grown.bits) for grown in chaos.growth])
    bands = [
        Band(
            horizon.engine,
            horizon.low.time,
            chaos.time if horizon.high.time is None else horizon.high.time,
            -horizon.unit,
            None if horizon.seen is None or horizon.seen.place is None else horizon.seen.place.time,
        )
        for horizon in chaos.horizons
        if horizon.low.time is not None
    ]
    estimates = [(time, value) for _, time, value in chaos.spectrum.running(CONVERGENCE_POINTS)]
    rate = chaos.spectrum.per_time()
    limits = [
        Curve(label, [(0.0, value), (chaos.time, value)])
        for label, value in (("95 %, low", rate.low), ("95 %, high", rate.high))
        if value is not None
    ]
    return environment.get_template("chaos.html.jinja").render(
        title=f"{chaos.scene.name}: chaos",
        lead=sentences(chaos)[0],
        sentences=sentences(chaos)[1:],
        headings=HORIZON_HEADINGS,
        rows=horizon_rows(chaos),
        growth=Markup(plot("Growth of the worst error", "time", "bits", [growth], bands)),
        convergence=Markup(plot("The largest exponent as it converges", "time", "lambda",
                                [Curve("estimate", estimates), *limits])),
        digest=chaos.scene.digest,
    )  # fmt: skip
