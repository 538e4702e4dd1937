"""The pages that the tests of the report look at: a comparison of each kind, and the file that it makes."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

from truebreak.compare import compare, html_report
from truebreak.compare.chaos.certified_chaos import chaos
from truebreak.compare.comparison import Comparison
from truebreak.compare.orders.all_orders import all_orders
from truebreak.compare.report.chaos_page import chaos_html
from truebreak.compare.report.orders_page import orders_html
from truebreak.exact.exact_engine import ExactEngine
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


def _break() -> Comparison:
    """A rack of five rows and the cue ball, 300 events; without causes, which take minutes here."""
    return compare(catalogue.build("rack:rows=5"), ["double", "pymunk"], events=300, causes=False)


def _pinball() -> Comparison:
    return compare(catalogue.build("pinball"), ["double", "pymunk"])


def _long_galperin() -> Comparison:
    return compare(catalogue.build("galperin:n=3"), ["double"])


def _thirty() -> Comparison:
    return compare(catalogue.build("gas:n=30"), ["double", "pymunk"], events=120)


def _thousand() -> Comparison:
    return compare(catalogue.build("gas:n=1000"), ["double"], events=12)


def _chaos() -> str:
    return chaos_html(chaos(catalogue.build("gas:n=5"), events=120), command="truebreak chaos SCENE --html page.html")


def _orders() -> str:
    scene = catalogue.build("rack:rows=3")
    return orders_html(scene, all_orders(ExactEngine(), scene, events=12))


def _two_orders() -> str:
    scene = catalogue.build("lee")
    return orders_html(scene, all_orders(ExactEngine(), scene))


def _some_orders() -> str:
    """A search that its cap has cut."""
    scene = catalogue.build("rack:rows=3")
    return orders_html(scene, all_orders(ExactEngine(), scene, events=2, cap=3, samples=2))


def _one_order() -> str:
    scene = Scene([Circle(0, 0, vx=1), Circle(4, 0)], name="<one> & the same")
    return orders_html(scene, all_orders(ExactEngine(), scene))


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
    "break": _break,
    "pinball": _pinball,
    "long-galperin": _long_galperin,
    "thirty": _thirty,
    "thousand": _thousand,
}

OTHERS = {
    "chaos": _chaos,
    "orders": _orders,
    "two-orders": _two_orders,
    "some-orders": _some_orders,
    "one-order": _one_order,
}
"""Pages that are none of a comparison."""

PAGES = (*KINDS, *OTHERS)


@cache
def comparison(kind: str) -> Comparison:
    """The comparison of a kind, made once."""
    return KINDS[kind]()


@cache
def page(kind: str) -> str:
    """Its page."""
    if kind in OTHERS:
        return OTHERS[kind]()
    return html_report(comparison(kind), command=COMMAND)


class Files:
    """Every page as a file, `files / "gas.html"`, which is made when it is first asked for."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __truediv__(self, name: str) -> Path:
        path = self.folder / name
        if not path.exists():
            path.write_text(page(path.stem), encoding="utf-8")
        return path
