"""The player of a report as a widget for notebooks (`anywidget`; the extra `notebook`)."""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from .page.provenance import provenance
from .page.recording import recording
from .page.rendering import COMPARED, rendered

if TYPE_CHECKING:
    from ..comparison import Comparison

HEIGHT = 860
"""Pixels: the player with its lists, at the width of a notebook's cell."""


def player(comparison: Comparison, *, height: int = HEIGHT) -> Any:
    """A widget that plays a comparison: reference and engine side by side on one clock.

    Its `time`, in the scene's units, can be read and set, and follows the player; `height` is in pixels.

    Raises:
        ImportError: without anywidget, with the remedy.
        SceneError: for a comparison in which there is nothing to play, and for a height below 1.

    >>> from truebreak.compare import compare
    >>> from truebreak.scenarios import catalogue
    >>> shown = player(compare(catalogue.build("lee"), ["double"]))
    >>> shown.time, shown.height
    (0.0, 860)
    """
    if height < 1:
        raise SceneError(f"height = {height}: must be a whole number from 1")
    return _widget_class()(page=player_page(comparison), height=height)


def player_page(comparison: Comparison) -> str:
    """The page of the player alone, which tells the page around it its time, and takes one from there.

    Raises:
        SceneError: for a comparison in which there is nothing to play.
    """
    data = recording(comparison)
    if data is None:
        raise SceneError(f"{comparison.scene.name!r}: there is nothing to play; compare over a longer span")
    return rendered(
        "widget.html.jinja",
        recording={**data, "embedded": True},
        engines=len(comparison.candidates),
        title=f"{comparison.scene.name}: player",
        provenance=provenance(comparison),
        player=COMPARED,
        footnote="Solid and blue: the reference.",
    )


@cache
def _widget_class() -> Any:
    try:
        import anywidget
        import traitlets
    except ImportError:
        raise ImportError(
            "the player in a notebook needs anywidget, which is not installed: pip install '.[notebook]'"
        ) from None

    class Player(anywidget.AnyWidget):
        """The player; `page` is its document."""

        _esm = resources.files(f"{__package__}.page").joinpath("widget.js").read_text("utf-8")
        page = traitlets.Unicode().tag(sync=True)
        time = traitlets.Float(0.0).tag(sync=True)
        height = traitlets.Int(HEIGHT).tag(sync=True)

    return Player
