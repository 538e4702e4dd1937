"""A stress map: where on families of ever harder scenes each engine turns wrong, and what proves the exact engine."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property, lru_cache
from itertools import groupby
from typing import TYPE_CHECKING, Annotated, Any

from ...exact.exact_engine import ExactEngine
from ...scenarios.errors import SceneError
from ...tools import verify
from ...tools.verify import BROKEN
from ..certificate.certified import Certified
from ..certificate.writer import certificate_json, certificate_of, plain_certificate
from ..deadline import uninterrupted
from ..engines import engine as engine_named
from ..outcomes.outcome import outcomes_of
from ..validation import EngineError, check_engine
from .grid import several
from .row import Columns, Row, divergence_of, followed, laws_of, outcomes_changed, reference_of, unknowing, versions
from .stress_families import FAMILIES, MapPlace, StressFamily, stress_family

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
    from ..chaos.horizon import Followed

DEFAULT_ENGINES = ("single", "double", "quad", "interval", "pymunk:max_steps=300000")
"""Compared with the certified run unless others are asked for. 300,000 steps of pymunk take about a second."""

MOST_LEVELS = 1000

COLUMNS = (
    "index", "scene", "digest", "parameters", "engine", "mark", "verdict", "agreed", "events", "stop",
    "event", "at", "body", "expected", "got", "kind", "changed", "laws", "closed_form", "note",
)  # fmt: skip
"""What the JSON of a map has of each row."""

StressRow = Annotated[dict[str, Any], Columns(COLUMNS)]


class MapMark(Enum):
    """One of these for each engine at each place; only `RIGHT` counts as right, and only `WRONG` as wrong."""

    RIGHT = "right"
    WRONG = "wrong"
    UNSETTLED = "unsettled"
    UNDECIDED = "undecided"
    REFUSED = "refused"
    FAILED = "failed"
    UNCHECKED = "unchecked"

    @property
    def sign(self) -> str:
        """As one letter.

        >>> "".join(mark.sign for mark in MapMark)
        '.X~?-#!'
        """
        return SIGNS[self][0]

    @property
    def meaning(self) -> str:
        """In words."""
        return SIGNS[self][1]


SIGNS = {
    MapMark.RIGHT: (
        ".",
        "right: the certified history, every meeting of it, and its outcomes; no law known to be broken",
    ),
    MapMark.WRONG: ("X", "wrong: another history, an outcome changed, or a law not kept"),
    MapMark.UNSETTLED: ("~", "not settled: the runs do not go far enough to decide"),
    MapMark.UNDECIDED: ("?", "undecided: it stopped, not knowing, or its counted steps were spent"),
    MapMark.REFUSED: ("-", "refused: it does not take the scene"),
    MapMark.FAILED: ("#", "failed: it ended with an error of its own, and no answer"),
    MapMark.UNCHECKED: ("!", "unchecked: decided, but the independent checker does not say so"),
}

MARKS = {
    "diverged": MapMark.WRONG,
    "unsettled": MapMark.UNSETTLED,
    "undecided": MapMark.UNDECIDED,
    "agree": MapMark.RIGHT,
}
"""Of each verdict, where no outcome changed."""


# -- the exact engine: what says that it is right, and is not the exact engine: a checked certificate, a closed form

VERIFIED, REFUTED, NOT_DECIDED = 0, 1, 4
"""Exit codes of the checker."""

MOST_TIMES = 16
"""By how much more bits a certificate is checked, where its own do not decide."""


@dataclass(frozen=True)
class Testimony:
    """What is said of a certified run by others.

    Attributes:
        mark: `right` only if the checker proves the whole run again, and no closed form contradicts it.
        note: the checker's sentence, or what is wrong.
        closed_form: whether the outcome is that of the family's closed form; None where there is none.
    """

    mark: MapMark
    note: str
    closed_form: bool | None


def witness(run: Trajectory, family: StressFamily, place: MapPlace) -> Testimony:
    """Has a run of the exact engine checked.

    Its certificate goes to `tools/verify.py`, which shares no decision with the engines: it proves every contact,
    impulse and miss again, or refuses.

    >>> from truebreak.compare.grids.stress_families import stress_family
    >>> from truebreak.exact import ExactEngine
    >>> one = stress_family("near-ties")
    >>> place = one.place(20)
    >>> found = witness(ExactEngine().run(one.scene(place)), one, place)
    >>> found.mark.value, found.note.partition(";")[0], found.closed_form
    ('right', 'verified: 4 events, to the end: quiet', True)
    """
    if unknowing(run):
        return Testimony(MapMark.UNDECIDED, run.stop.message, None)
    fits = None if family.known is None else family.known(run, place.k, place.side, place.seed)
    try:
        plain = plain_certificate(run)  # the checker has to find nothing; what it does not prove at once gets witnesses
        found = None if plain is None else weighed(plain)
        if found is None or found.code != VERIFIED:
            found = weighed(certificate_of(run))
    except SceneError as error:
        return Testimony(MapMark.UNCHECKED, str(error), fits)
    except AssertionError as error:  # the writer of certificates is itself refuted
        return Testimony(MapMark.WRONG, str(error), fits)
    except BROKEN as error:  # numbers that certificates do not reach
        return Testimony(MapMark.UNCHECKED, f"no certificate: {type(error).__name__}: {error}", fits)
    if found.code == REFUTED:
        return Testimony(MapMark.WRONG, found.sentence, fits)
    if fits is False:
        return Testimony(MapMark.WRONG, "its outcome is not that of the closed form", fits)
    found = with_more_bits(found)
    return Testimony(MapMark.RIGHT if found.code == VERIFIED else MapMark.UNCHECKED, found.sentence, fits)


def weighed(certificate: dict[str, Any]) -> Certified:
    """A certificate, with the checker's exit code and sentence. It runs in this process: to start another for each of a
    thousand certificates of four events would take most of the time."""
    limit, text = sys.get_int_max_str_digits(), certificate_json(certificate)
    try:
        return Certified(text, *verify.weighed(text.encode()))
    finally:
        sys.set_int_max_str_digits(limit)


def with_more_bits(found: Certified) -> Certified:
    """A certificate whose own bits decide nothing, checked with more of them; what the checker proves is as certain.

    Bits are how finely the checker counts, and no part of what it proves.
    """
    told, factor = json.loads(found.text), 1
    while found.code == NOT_DECIDED and factor < MOST_TIMES:
        factor *= 2
        finer = {**told, "bits": factor * told["bits"]}
        more = weighed(finer)
        found = Certified(found.text, more.code, f"{more.sentence} (with {factor} times its bits)")
    return found


# -- the rows of one place


@lru_cache(maxsize=1)
def scene_of(place: MapPlace) -> Scene:
    """The scene of a place: its rows are made of it, and kept under its digest.

    >>> scene_of(MapPlace("near-ties", 20, "left")).name
    'near-ties-left-20'
    """
    return stress_family(place.family).scene(place)


@dataclass(frozen=True)
class StressJob:
    """A place of the map, and the engines to compare with its certified run."""

    index: int
    place: MapPlace
    engines: tuple[str, ...]

    @property
    def label(self) -> str:
        """The place."""
        return f"{self.place.family}, {self.place.lane}, k = {self.place.k}"

    def rows(self) -> list[Row]:
        """The exact engine's row, then one for each engine; there is no clock in them, and nothing is drawn but from
        its seed.

        >>> exact, double, quad = StressJob(0, MapPlace("near-ties", 20, "left"), ("double", "quad")).rows()
        >>> exact.mark, double.mark, quad.mark
        ('right', 'wrong', 'right')
        """
        of, place = stress_family(self.place.family), self.place
        scene = scene_of(place)
        run = uninterrupted(ExactEngine().run(scene))
        found = witness(run, of, place)
        varies = {"family": place.family, "side": place.side, "seed": str(place.seed), "k": str(place.k)}
        row = Row(self.index, scene.name, "exact", "agree", parameters=varies, **reference_of(run))
        exact = replace(row, mark=found.mark.value, closed_form=found.closed_form, note=found.note,
                        verdict="undecided" if unknowing(run) else "agree", agreed=len(run.events))  # fmt: skip
        expected = outcomes_of(run)
        return [exact, *(_compared(replace(row, engine=label), run, expected) for label in self.engines)]


def _compared(row: Row, run: Trajectory, expected: Mapping[str, Any]) -> Row:
    """The row of one engine. What is right otherwise is wrong where a law is not kept, and `laws` says which.

    An engine that hands back what can be no history, such as an event before the start, is wrong too. What it raises,
    one of truebreak's own too, is the end of its answer, and not of the map.
    """
    try:
        engine = engine_named(row.engine)
        found = followed(run, engine, len(run.events))
    except EngineError as error:  # with a cause: somebody else's engine raised it
        mark = MapMark.WRONG if error.__cause__ is None else MapMark.FAILED
        return replace(row, verdict="failed", mark=mark.value, note=str(error))
    except Exception as error:
        note = f"{type(error).__name__}: {' '.join(str(error).split())}"
        return replace(row, verdict="failed", mark=MapMark.FAILED.value, note=note)
    parts = divergence_of(found.alignment)
    if found.unable:
        parts |= {"verdict": "refused", "mark": MapMark.REFUSED.value, "note": found.run.stop.message}
        return replace(row, **parts)
    changed = list[str]()
    if MARKS[found.alignment.verdict] in (MapMark.RIGHT, MapMark.WRONG):  # elsewhere outcomes say nothing
        changed += outcomes_changed(found, run, engine.step, None, expected).changed
    mark = mark_of(found, changed=bool(changed))
    laws = laws_of(found.run, engine) if mark is MapMark.RIGHT else None
    if laws is not None and laws["kept"] is False:
        mark = MapMark.WRONG
    note = found.run.stop.message if mark is MapMark.UNDECIDED else None
    parts |= {"mark": mark.value, "laws": laws, "note": note, "changed": changed if mark is MapMark.WRONG else None}
    return replace(row, **parts)


def mark_of(found: Followed, *, changed: bool) -> MapMark:
    """Right or wrong, or why neither is known.

    Where the certified run itself stopped not knowing, a divergence before that stands, and all else is undecided.
    The outcomes of an engine that stopped early, or whose end is not settled, are those of another span, and
    say nothing.
    """
    mark = MARKS[found.alignment.verdict]
    if mark is MapMark.RIGHT and changed:
        return MapMark.WRONG
    if mark is MapMark.RIGHT and unknowing(found.study.reference):
        return MapMark.UNDECIDED
    return mark


# -- the map


@dataclass(frozen=True)
class StressMap:
    """Families, their levels, and engines: what a map asks for.

    Attributes:
        families: in the order of the table.
        engines: labels of the engines compared with the exact one, which is always there.
        levels: the k of every family; None: each family's own.
        short: whether only a few of each family's own.
    """

    families: tuple[StressFamily, ...]
    engines: tuple[str, ...]
    levels: range | None = None
    short: bool = False

    apart = False

    @property
    def settings(self) -> dict[str, Any]:
        """As a store keeps them."""
        return {
            "grid": "stress map",
            "versions": versions(),
            "families": [one.name for one in self.families],
            "engines": list(self.engines),
            "levels": None if self.levels is None else [self.levels[0], self.levels[-1], self.levels.step],
            "short": self.short,
        }

    @cached_property
    def places(self) -> tuple[MapPlace, ...]:
        """Every place of the map, in order."""
        asked = [
            one.places(one.levels(self.short) if self.levels is None else tuple(self.levels)) for one in self.families
        ]
        return tuple(place for places in asked for place in places)

    def indices(self) -> range:
        """Of the places."""
        return range(len(self.places))

    def key(self, index: int) -> str:
        """The digest of the place's scene: a family may be another one by now."""
        place = self.places[index]
        return scene_of(place).digest

    def job(self, index: int) -> StressJob:
        """Of one place."""
        return StressJob(index, self.places[index], self.engines)


def stress_plan(
    families: Sequence[str] = (),
    engines: Sequence[str] = DEFAULT_ENGINES,
    *,
    levels: str | None = None,
    short: bool = False,
) -> StressMap:
    """What is asked for, checked before anything runs.

    Args:
        families: their names; none: all of them.
        engines: what to compare with the exact engine, which is in every map; named here too, it is in it once.
        levels: `LOW..HIGH`, the k of every family; each has to have all of them.
        short: whether only a few of each family's own levels.

    Raises:
        SceneError: for whatever of these is wrong.

    >>> len(stress_plan(["near-ties"], ["double"], levels="14..18").places)
    10
    """
    if len(set(families)) < len(families):
        raise SceneError("a family is named twice; keep one")
    chosen = [stress_family(name) for name in families or FAMILIES]
    chosen.sort(key=lambda one: list(FAMILIES).index(one.name))
    labels = tuple(label for label in engines if label != "exact")
    for label in labels:
        if label.partition(":")[0] == "exact":
            raise SceneError(
                f"--engines {label}: the exact engine is in every map as it is, checked by a witness; leave it out"
            )
        check_engine(engine_named(label))
    if len(set(labels)) < len(labels):
        raise SceneError("--engines: an engine is named twice; keep one")
    found = None if levels is None else levels_of(levels)
    if found is not None and short:
        raise SceneError("--short and --levels both say which levels; keep one of them")
    for one in chosen:
        for k in () if found is None else (found[0], found[-1]):
            one.check(k)
    return StressMap(tuple(chosen), labels, found, short)


def levels_of(text: str) -> range:
    """`LOW..HIGH`, or `LOW..HIGH:STEP`, as the numbers from the one to the other.

    Raises:
        SceneError: for anything else.

    >>> levels_of("14..18")
    range(14, 19)
    """
    found = several(text, "--levels")
    if found is None:
        raise SceneError(f"--levels {text!r}: is not LOW..HIGH with LOW the smaller; write 14..18")
    if len(found) > MOST_LEVELS:
        raise SceneError(f"--levels {text!r}: are {len(found):,} levels; ask for at most {MOST_LEVELS:,}")
    return found


# -- what the rows of one lane say of one engine: from which k on it is wrong, and where it is not


@dataclass(frozen=True)
class Ladder:
    """The marks of one engine along one lane.

    Attributes:
        family, side, seed: the lane.
        engine: its label; `exact` for the exact engine, whose marks are those of its witness.
        levels: the k, ascending.
        marks: one for each.
    """

    family: str
    side: str
    seed: int
    engine: str
    levels: tuple[int, ...]
    marks: tuple[MapMark, ...]

    @property
    def lane(self) -> str:
        """As `MapPlace.lane`."""
        return MapPlace(self.family, self.levels[0], self.side, self.seed).lane

    @property
    def first_wrong(self) -> int | None:
        """The first k at which it is wrong; None if it is at none."""
        return next((k for k, mark in zip(self.levels, self.marks, strict=True) if mark is MapMark.WRONG), None)

    @property
    def right_again(self) -> tuple[int, ...]:
        """The k after the first wrong one at which it is right."""
        first = self.first_wrong
        told = zip(self.levels, self.marks, strict=True)
        return () if first is None else tuple(k for k, mark in told if k > first and mark is MapMark.RIGHT)

    @property
    def first_words(self) -> str:
        """From which k on it is wrong, and where after it the engine is right; "none" if it is wrong at none.

        Where the k before was not tried, all that is known is that it turns wrong at or before the first wrong one.

        >>> R, W = MapMark.RIGHT, MapMark.WRONG
        >>> Ladder("walls", "opening", 0, "double", (1, 2, 3, 4, 5, 6), (R, W, R, R, W, R)).first_words
        '2, but right at 3 to 4, 6'
        >>> Ladder("near-ties", "left", 0, "double", (1, 14, 27, 40), (R, R, W, W)).first_words
        'at or before 27 (right at 14)'
        """
        if self.first_wrong is None:
            return "none"
        first = self.first_wrong
        again = [_ends(low, high) for mark, low, high in self.stretches if mark is MapMark.RIGHT and low > first]
        return f"{self.first_short}, but right at {', '.join(again)}" if again else self.first_short

    @property
    def first_short(self) -> str:
        """`first_words` without what comes after; empty if it is wrong at none."""
        first = self.first_wrong
        if first is None or first - 1 in self.levels or first == stress_family(self.family).first:
            return "" if first is None else str(first)
        before = [k for k, mark in zip(self.levels, self.marks, strict=True) if k < first and mark is MapMark.RIGHT]
        return f"at or before {first}" + (f" (right at {before[-1]})" if before else "")

    @property
    def signs(self) -> str:
        """One letter for each k."""
        return "".join(mark.sign for mark in self.marks)

    @property
    def stretches(self) -> tuple[tuple[MapMark, int, int], ...]:
        """Equal marks in a row: the mark, the first k and the last.

        >>> marks = (MapMark.RIGHT, MapMark.RIGHT, MapMark.WRONG)
        >>> ladder = Ladder("near-ties", "left", 0, "double", (1, 2, 3), marks)
        >>> [(mark.value, *ends) for mark, *ends in ladder.stretches]
        [('right', 1, 2), ('wrong', 3, 3)]
        """
        found: list[tuple[MapMark, int, int]] = []
        for mark, group in groupby(zip(self.marks, self.levels, strict=True), key=lambda pair: pair[0]):
            ks = [k for _, k in group]
            found.append((mark, ks[0], ks[-1]))
        return tuple(found)

    def summary(self) -> str:
        """The whole ladder in words.

        >>> marks = (MapMark.RIGHT, MapMark.WRONG, MapMark.RIGHT, MapMark.WRONG, MapMark.WRONG)
        >>> Ladder("near-ties", "left", 0, "double", (1, 2, 3, 4, 5), marks).summary()
        'right 1; wrong 2; right 3; wrong 4 to 5'
        """
        return "; ".join(f"{mark.value} {_ends(low, high)}" for mark, low, high in self.stretches)


def _ends(low: int, high: int) -> str:
    return str(low) if low == high else f"{low} to {high}"


def ladders(rows: Iterable[Row], engines: Sequence[str]) -> list[Ladder]:
    """The ladders of a map: lane by lane, the exact engine first."""
    lanes: dict[tuple[str, str, int], dict[str, list[tuple[int, MapMark]]]] = {}
    for row in rows:
        of = row.parameters or {}
        lane = lanes.setdefault((of["family"], of["side"], int(of["seed"])), {})
        lane.setdefault(row.engine, []).append((int(of["k"]), MapMark(row.mark)))
    return [
        Ladder(*lane, label, tuple(k for k, _ in told[label]), tuple(mark for _, mark in told[label]))
        for lane, told in lanes.items()
        for label in ("exact", *engines)
    ]


def place_of(row: Row) -> MapPlace:
    """The place that a row is of."""
    of: Mapping[str, str] = row.parameters or {}
    return MapPlace(of["family"], int(of["k"]), of["side"], int(of["seed"]))
