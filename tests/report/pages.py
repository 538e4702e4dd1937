"""The pages that the tests of the report look at: a comparison of each kind, and the file that it makes."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from truebreak.compare import compare, html_report
from truebreak.compare.comparison import Comparison
from truebreak.scenarios import Circle, Scene, Wall, catalogue

COMMAND = "truebreak compare SCENE --html page.html"


def _gas() -> Comparison:
    return compare(catalogue.build("gas"), ["double", "pymunk", "interval:bits=30"], events=40)


def _near_tie() -> Comparison:
    return compare(catalogue.build("near-tie:k=40"), ["double", "interval", "pymunk"])


def _far_near_tie() -> Comparison:
    return compare(catalogue.build("near-tie:k=400"), ["double"])


def _galperin() -> Comparison:
    return compare(catalogue.build("galperin:n=2"), ["double", "pymunk"])


def _rack() -> Comparison:
    return compare(catalogue.build("rack:rows=2"), ["double", "pymunk:dt=1/10"], events=8)


def _undecided() -> Comparison:
    return compare(catalogue.build("gas"), ["interval:bits=30"], events=40)


def _reversal() -> Comparison:
    scene = catalogue.build("gas").with_changes(reverse_after=10, events=None, until=None)
    return compare(scene, ["double"])


def _unsettled() -> Comparison:
    """A candidate of which the runs at hand do not tell; made so by hand, as the engines here always tell."""
    found = _undecided()
    (candidate,) = found.candidates
    open_end = replace(candidate.alignment, undecided=False, unsettled=True)
    return replace(found, candidates=(replace(candidate, alignment=open_end, diagnosis=None),))


def _hostile() -> Comparison:
    """Names that would be tags, the end of a script, a formula, and words too long for any line."""
    circles = [
        Circle(0, 0, vx=1, id="<b>&</script>"),
        Circle(9, "1/3", id='"q"'),
        Circle(30, 0, vx=-1, id="W" * 64),
        Circle(40, 5, id="=1+1"),
    ]
    walls = [Wall(60, 0, 60, 1, id="</svg>")]
    scene = Scene(circles, walls, name="<script>alert(1)</script>", source="<i>")
    return compare(scene, ["double", "pymunk:dt=1/100", "pymunk:dt=1/10"], until=40)


def _many_engines() -> Comparison:
    steps = [f"pymunk:dt=1/{k}" for k in range(8, 19)]
    return compare(catalogue.build("galperin:n=1"), steps, causes=False)


def _quiet() -> Comparison:
    return compare(Scene([Circle(0, 0)]))


KINDS = {
    "gas": _gas,
    "near-tie": _near_tie,
    "far-near-tie": _far_near_tie,
    "galperin": _galperin,
    "rack": _rack,
    "undecided": _undecided,
    "unsettled": _unsettled,
    "reversal": _reversal,
    "hostile": _hostile,
    "many-engines": _many_engines,
    "quiet": _quiet,
}


@cache
def comparison(kind: str) -> Comparison:
    """The comparison of a kind, made once."""
    return KINDS[kind]()


@cache
def page(kind: str) -> str:
    """Its page."""
    return html_report(comparison(kind), command=COMMAND)
