"""Two or more logs compared: the verdict of each against the first, as text and as JSON."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypedDict

from .growing import NEVER, Difference, ThinnedCurve, rate_of
from .pairing import pair
from .sides import Found
from .verdict import Finding, Verdict, decide

if TYPE_CHECKING:
    from .lawful import Lawful, LawfulDocument
    from .log_format import LogRecord

SCHEMA = "truebreak/diff-1"

SHOWN_BODIES = 8
"""Bodies whose growth a report lists: those that differ first."""

SPARKS = "▁▂▃▄▅▆▇█"

WIDE = 32
"""Letters of a curve in text."""

GRAVITY = (
    Finding.START,
    Finding.CHANGED,
    Finding.OPEN,
    Finding.GREW,
    Finding.HARMLESS,
    Finding.IDENTICAL,
)
"""Of several verdicts the first of these is the one of the whole."""


NEXT = {
    Finding.GREW: "there may be no bug: make both compute alike (one build, no fused multiply-add or fast-math, bodies "
    "in one order), or send states now and then",
    Finding.CHANGED: "look at what acts there at this step: inputs, contacts, caches, values that nobody sets",
    Finding.START: "compare what both begin with: first states, time step, gravity and other settings",
}
"""What helps where two runs differ."""


FindingWord = Annotated[str, Finding]
PairedBy = Annotated[str, Literal["step", "body"]]


class LogPlace(TypedDict):
    """Where two logs differ.

    Attributes:
        event: number of the record, from 0.
        step: time step; null: logs of events.
        time: time of the first log; null: it has none.
        lines: lines in both files.
    """

    event: int
    step: int | None
    time: float | None
    lines: list[int]


class FirstDifference(LogPlace):
    """A number in which two logs first differ.

    Attributes:
        body: whose it is.
        name: which number of its state.
        values: in both logs; null: infinite.
        bits: by how many bits above an ulp the two differ; null: endless, or not at all.
        touching: whether the body meets another in that record.
    """

    body: str
    name: str
    values: list[float | None]
    bits: float | None
    touching: bool


class FirstPartners(TypedDict):
    """Where a body first meets another in one log than in the other.

    Attributes:
        event: number of the record, from 0.
        step: time step; null: logs of events.
        time: time of the first log; null: it has none.
        body: whose partners differ.
        partners: whom it meets in each; null: nobody.
        times: when, in each.
        lines: lines in both files.
    """

    event: int
    step: int | None
    time: float | None
    body: str
    partners: list[str | None]
    times: list[float | None]
    lines: list[int | None]


class DifferenceGrowth(TypedDict):
    """How fast a difference grows, in bits.

    Attributes:
        bits_per_record: a record.
        record_error: standard error of that.
        bits_per_time: a unit of time; null: records have no times.
        time_error: standard error of that.
    """

    bits_per_record: float
    record_error: float
    bits_per_time: float | None
    time_error: float | None


class BodyGrowth(TypedDict):
    """How the difference of one body grew.

    Attributes:
        body: the body.
        first: number of the record in which it first differs.
        points: number of the record, time, bits above an ulp.
    """

    body: str
    first: int
    points: list[list[float | None]]


class PairDocument(TypedDict):
    """Two logs compared.

    Attributes:
        logs: their names.
        verdict: what the difference is called.
        line: that in words.
        event: number of the record at which it is decided; null: none.
        why: why it is called so.
        spread: where the first differences are; null: nowhere.
        paired_by: how records were paired.
        bits: of the numbers in the logs: 24 or 53 in the mantissa.
        compared: how much was compared, by kind.
        first_difference: the first numbers that differ.
        first_partners: the first meeting of other partners; null: none.
        first_hash: the first hash that differs; null: none.
        first_input: the first input that differs; null: none.
        growth: how fast the difference grows; null: not measured.
        bodies: by body.
        contacts: contacts in each log.
        alone: records that only one has, in each.
        missing: contacts that only one has.
        fields: the first difference of each free field.
        names: what the numbers of a state are called.
        clock: largest difference of times at equal steps; null: no times.
        notes: remarks.
        law: with a scene: the growth that is certified, and whether each run keeps the law; null: no scene was given.
    """

    logs: list[str]
    verdict: FindingWord
    line: str
    event: int | None
    why: str
    spread: str | None
    paired_by: PairedBy
    bits: int
    compared: dict[str, int]
    first_difference: list[FirstDifference]
    first_partners: FirstPartners | None
    first_hash: LogPlace | None
    first_input: LogPlace | None
    growth: DifferenceGrowth | None
    bodies: list[BodyGrowth]
    contacts: list[int]
    alone: list[int]
    missing: int
    fields: dict[str, LogPlace]
    names: dict[str, str]
    clock: float | None
    notes: list[str]
    law: LawfulDocument | None


class DiffDocument(TypedDict):
    """Two or more logs, each compared with the first.

    Attributes:
        verdict: the gravest of all.
        line: that in words.
        pairs: the comparisons.
    """

    schema: str
    verdict: FindingWord
    line: str
    pairs: list[PairDocument]


@dataclass(frozen=True)
class Desync:
    """What two logs have in common and not, and what is said of it.

    Attributes:
        found: the comparison.
        verdict: what it is called, and why.
        lawful: with a scene: the growth that is certified, and whether each run keeps the law.
    """

    found: Found
    verdict: Verdict
    lawful: Lawful | None = None

    @property
    def line(self) -> str:
        """The first line of the report."""
        return f"{self.verdict.line}: {self.verdict.why}"

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def lines(self) -> Iterator[str]:
        """The report, line by line."""
        found, verdict = self.found, self.verdict
        yield self.line
        if self.lawful is not None:
            yield from self.lawful.lines()
        yield ""
        for label, text in self.facts():
            yield f"  {label + ':':<22}{text}"
        rows = list(self.bodies())
        if rows:
            yield ""
            whole = found.growing.unit.whole
            yield f"  growth by body, from one ulp to the size of the scene ({whole:.0f} bits above it)"
            wide = max(len(row["body"]) for row in rows)
            for row in rows:
                yield f"  {row['body']:<{wide}}  {row['curve']:<{WIDE}}  {row['told']}"
        shown = list(self.around())
        if shown:
            yield ""
            yield f"  {self.where_shown()} the first difference{self.numbers()}"
            for place, what, one, other in shown:
                mark = " " if one == other else "|"
                yield f"  {mark} {place}: {what}: {one}" + ("" if one == other else f"  <>  {other}")
        for note in verdict.notes:
            yield f"  {note}"

    def where_shown(self) -> str:
        """Whether the records that are shown begin before a first meeting with another partner, or after it."""
        meeting, lines = self.found.meeting, [min((r.line for r in log), default=0) for log in self.found.context]
        past = meeting is not None and all(
            line is not None and first > line for line, first in zip(meeting.lines, lines, strict=True)
        )
        return "after" if past else "around"

    def facts(self) -> Iterator[tuple[str, str]]:
        """What is known, by label."""
        found, verdict = self.found, self.verdict
        if verdict.name in NEXT:
            yield "what to do", NEXT[verdict.name]
        kinds = ("states", "contacts", "hashes", "times", "inputs", "fields")
        told = ", ".join(f"{found.compared[kind]:,} {kind}" for kind in kinds if found.compared[kind])
        yield "compared", told or "nothing"
        if found.hash is not None:
            yield "first other hash", found.hash[0].place()
        if verdict.first:
            first = verdict.first[0]
            yield "first other bits", f"{_at(first)}: {first.name} of {first.body}: {first.a!r} and {first.b!r}"
            yield "where", str(verdict.spread)
        if found.input is not None:
            one, other = ("nothing" if record.input is None else record.input for record in found.input)
            yield "first other input", f"{found.input[0].place()}: {one} and {other}"
        if found.meeting is not None:
            m = found.meeting
            place = f"step {m.step}" if m.step is not None else f"event {m.number}"
            yield "first other partners", f"{place}: {m.body} meets {m.a or 'nobody'} and {m.b or 'nobody'}"
        if verdict.first:
            rate = verdict.rate
            if rate is None:
                yield "growth", "none to be measured: it is at once as large as it gets, or has too few records"
            else:
                by_time = (
                    "" if rate.bits_per_time is None
                    else f"; {_with_error(rate.bits_per_time, rate.time_error or 0.0)} a unit of time"
                )  # fmt: skip
                bits = rate.bits_per_record
                double = f" (it doubles every {1 / bits:.2g} records)" if bits > 2 * rate.record_error else ""
                yield "growth", f"{_with_error(bits, rate.record_error)} bits a record{double}{by_time}"
            yield "largest difference", f"{_power(found.growing.largest)} ulps"
            yield "bodies that differ", f"{len(found.growing.bodies)} of {found.growing.known}"
        if found.reordered is not None and verdict.same:
            yield "order", f"independent events come in another order, first at {found.reordered[0]}"
        if found.contacts[0] != found.contacts[1]:
            yield "contacts", f"{found.contacts[0]:,} and {found.contacts[1]:,}"
        if any(found.alone):
            yield "records of one alone", f"{found.alone[0]:,} and {found.alone[1]:,}"
        for name, (record, one, other) in list(found.fields.items())[:4]:
            yield f"field {name}", f"differs first at {record.place()}: {str(one)[:40]} and {str(other)[:40]}"
        for name, (side, record) in list(found.fields_alone.items())[:4]:
            yield f"field {name}", f"in {(found.a, found.b)[side].name} alone, first at {record.place()}"
        ends = self.ends()
        if ends:
            cut = (found.longer is not None or any(found.alone)) and ends != "the same"
            yield ("last states" if cut else "final states"), f"{ends}, not of one time" if cut else ends
        ids = [sorted(found.final[s].keys() - found.final[1 - s].keys()) for s in (0, 1)]
        for side, names in enumerate(ids):
            if names and found.final[1 - side]:
                yield (
                    "ids of one alone",
                    f"{', '.join(names[:4])}{' ...' if len(names) > 4 else ''} ({(found.a, found.b)[side].name})",
                )

    def ends(self) -> str | None:
        """How far apart the last states are, in words."""
        one, other = self.found.final
        common = one.keys() & other.keys()
        differ = [i for i in common if one[i] != other[i] and len(one[i]) == len(other[i])]
        if not common:
            return None
        if not differ:
            return "the same" if self.found.growing.bodies else None
        places = self.found.growing.places(len(one[differ[0]]))
        apart = max(
            (math.dist([one[i][j] for j in places], [other[i][j] for j in places]) for i in differ), default=0.0
        )
        return f"differ in {len(differ)} of {len(common)} bodies, by up to {apart:.3g} in place"

    def numbers(self) -> str:
        """What the numbers of a state are, where the logs name them."""
        names = self.found.growing.names
        return "" if not names else f" (states are {', '.join(names[:6])}{', ...' if len(names) > 6 else ''})"

    def curves(self) -> list[tuple[str, ThinnedCurve]]:
        """The growth of bodies, those first that differ first."""
        return sorted(self.found.growing.by_body.items(), key=lambda item: item[1].points[0][0])

    def bodies(self) -> Iterator[dict[str, Any]]:
        """How the difference grew, by body: those first that differ first."""
        unit = self.found.growing.unit
        for body, curve in self.curves()[:SHOWN_BODIES]:
            rate = rate_of(curve, unit)
            first, largest = curve.points[0], max(bits for _, _, bits in curve.points)
            told = f"from record {first[0]}, {_power(first[2])} to {_power(largest)} ulps"
            if rate is not None:
                told += f", {_with_error(rate.bits_per_record, rate.record_error)} bits a record"
            yield {"body": body, "curve": sparks(curve, unit.whole), "told": told, "rate": rate}

    def around(self) -> Iterator[tuple[str, str, str, str]]:
        """Rows (place, what, first log, second log) of the records around the first difference."""
        found, verdict = self.found, self.verdict
        names = [d.body for d in verdict.first[:2]]
        if found.meeting is not None and not names:
            names = [found.meeting.body]
        for a, b in zip_by_place(*found.context):
            record = a or b
            assert record is not None
            for body in names:
                rows = [r.states.get(body) if r is not None else None for r in (a, b)]
                if any(row is not None for row in rows):
                    yield record.place(), body, *_rows(*rows)
            contacts = [_contacts(r, names) for r in (a, b)]
            if any(contacts):
                yield record.place(), "contacts", contacts[0] or "none", contacts[1] or "none"
            if not names and record.hash is not None:
                yield record.place(), "hash", str(a.hash if a else "-"), str(b.hash if b else "-")

    def data(self) -> PairDocument:
        """As JSON."""
        found, verdict = self.found, self.verdict
        rate = verdict.rate
        return {
            "logs": [found.a.name, found.b.name],
            "verdict": verdict.name.name.lower(),
            "line": verdict.line,
            "event": verdict.event,
            "why": verdict.why,
            "spread": verdict.spread,
            "paired_by": found.by,
            "bits": found.growing.unit.bits,
            "compared": {kind: found.compared[kind] for kind in sorted(found.compared)},
            "first_difference": [_difference(d) for d in verdict.first[:20]],
            "first_partners": None if found.meeting is None else {
                "event": found.meeting.number, "step": found.meeting.step, "time": found.meeting.time,
                "body": found.meeting.body, "partners": [found.meeting.a, found.meeting.b],
                "times": list(found.meeting.times), "lines": list(found.meeting.lines),
            },
            "first_hash": None if found.hash is None else _place(found.hash),
            "first_input": None if found.input is None else _place(found.input),
            "growth": None if rate is None else {
                "bits_per_record": rate.bits_per_record, "record_error": rate.record_error,
                "bits_per_time": rate.bits_per_time, "time_error": rate.time_error,
            },
            "bodies": [
                {
                    "body": body, "first": curve.points[0][0],
                    "points": [[n, _finite(t), _finite(bits)] for n, t, bits in curve.points],
                }
                for body, curve in self.curves()
            ],
            "contacts": found.contacts, "alone": found.alone, "missing": found.missing_count,
            "fields": {name: _place((record, record)) for name, (record, _, _) in found.fields.items()},
            "names": found.names, "clock": None if found.clock is None else _finite(found.clock),
            "notes": list(verdict.notes),
            "law": None if self.lawful is None else self.lawful.data(),
        }  # fmt: skip


def diff(one: str | Path, other: str | Path, *, ignore: Iterable[str] = (), scene: Any = None) -> Desync:
    """Compares two logs of any engine in any world.

    Args:
        ignore: free fields that are not compared; `time` for clocks of logs with steps.
        scene: what both runs are of, if it is a scene of truebreak: they are then audited, too.

    Raises:
        EngineError: for a log that cannot be read, and for two with nothing to compare.

    >>> import json, tempfile, pathlib
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> for name, x in (("a", 0.5), ("b", 0.75)):
    ...     lines = [{"step": k, "states": {"ball": [k + x * (k > 5), 1.0]}} for k in range(9)]
    ...     _ = (folder / name).write_text("\\n".join(map(json.dumps, lines)))
    >>> diff(folder / "a", folder / "b").verdict.line
    'changed at event 6 by more than rounding'
    """
    found = pair(one, other, frozenset(ignore))
    verdict, lawful = decide(found), None
    if scene is not None:
        from .lawful import lawful_runs

        begun = [(first.time,) * 2 for first in verdict.first[:1] if first.step is None]
        begun += [found.meeting.times] if found.meeting is not None and found.meeting.step is None else []
        lawful = lawful_runs(one, other, scene, verdict.name is Finding.GREW, *begun[:1])
        if (
            lawful.tie
            and all(audit.kept for audit in lawful.audits)
            and verdict.name in (Finding.START, Finding.CHANGED)
        ):
            verdict = replace(verdict, name=Finding.OPEN, why="contacts of one instant are resolved otherwise in each")
    return Desync(found, verdict, lawful)


def gravest(compared: Sequence[Desync]) -> Desync:
    """Of several comparisons with one first log the one whose verdict is told first."""
    return min(compared, key=lambda one: GRAVITY.index(one.verdict.name))


def report(compared: Sequence[Desync]) -> Iterator[str]:
    """The report of several logs, each compared with the first."""
    if len(compared) == 1:
        yield from compared[0].lines()
        return
    worst = gravest(compared)
    yield f"{worst.verdict.line}: {worst.found.b.name} against {worst.found.a.name}: {worst.verdict.why}"
    for one in compared:
        yield ""
        yield f"{one.found.a.name} and {one.found.b.name}"
        yield from one.lines()


def report_json(compared: Sequence[Desync]) -> DiffDocument:
    """The object that `truebreak diff --json` prints."""
    worst = gravest(compared)
    return {
        "schema": SCHEMA,
        "verdict": worst.verdict.name.name.lower(),
        "line": worst.verdict.line,
        "pairs": [one.data() for one in compared],
    }


def sparks(curve: ThinnedCurve, whole: float) -> str:
    """A curve as letters: the lowest is one ulp or less, the highest the size of the scene.

    >>> curve = ThinnedCurve()
    >>> for k in range(8):
    ...     curve.add(k, float(k), 52 * k / 7)
    >>> sparks(curve, 52)
    '▁▂▃▄▅▆▇█'
    """
    points = curve.points
    columns = min(WIDE, len(points))
    found = ""
    for k in range(columns):
        part = points[
            k * len(points) // columns : max((k + 1) * len(points) // columns, k * len(points) // columns + 1)
        ]
        level = max(bits for _, _, bits in part) / whole
        found += SPARKS[min(len(SPARKS) - 1, max(0, int(level * len(SPARKS))))]
    return found


def zip_by_place(
    one: Sequence[LogRecord], other: Sequence[LogRecord]
) -> Iterator[tuple[LogRecord | None, LogRecord | None]]:
    """Records of two logs by their step, or by their number."""

    def key(record: LogRecord) -> int:
        return record.step if record.step is not None else record.number

    sides = [{key(r): r for r in records} for records in (one, other)]
    for k in sorted(sides[0].keys() | sides[1].keys()):
        yield sides[0].get(k), sides[1].get(k)


def _rows(one: Sequence[float] | None, other: Sequence[float] | None) -> tuple[str, str]:
    """Two states, with as many digits as tell them apart."""
    told = _row(one, 9), _row(other, 9)
    return (_row(one, 17), _row(other, 17)) if one != other and told[0] == told[1] else told


def _row(row: Sequence[float] | None, digits: int) -> str:
    if row is None:
        return "nothing"
    return "[" + ", ".join(f"{v:.{digits}g}" for v in row[:6]) + (", ...]" if len(row) > 6 else "]")


def _contacts(record: LogRecord | None, names: Sequence[str]) -> str:
    if record is None:
        return ""
    return ", ".join(sorted("-".join(p) for p in record.contacts if not names or set(p) & set(names)))


def _at(d: Difference) -> str:
    place = f"step {d.step}" if d.step is not None else f"event {d.number}"
    at = "" if d.time is None else f", t = {d.time:.9g}"
    return f"{place}{at}, lines {d.lines[0]} and {d.lines[1]}"


def _power(bits: float) -> str:
    return "no" if bits == NEVER else "endless" if bits == math.inf else f"2**{max(bits, 0.0):.0f}"


def _with_error(value: float, error: float) -> str:
    return f"{value:.3g} ± {error:.1g}"


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _difference(d: Difference) -> FirstDifference:
    return {
        "event": d.number, "step": d.step, "time": d.time, "lines": list(d.lines), "body": d.body, "name": d.name,
        "values": [_finite(d.a), _finite(d.b)], "bits": _finite(d.bits), "touching": d.touching,
    }  # fmt: skip


def _place(records: tuple[LogRecord, LogRecord]) -> LogPlace:
    a, b = records
    return {"event": a.number, "step": a.step, "time": a.time, "lines": [a.line, b.line]}
