"""A history in little memory is the same history, bit for bit."""

from __future__ import annotations

import pickle
import tracemalloc

import pytest
from flint import arb, fmpq

from truebreak.exact import ExactEngine
from truebreak.exact.exact_engine import _in_order
from truebreak.exact.numbers.ball import parts_of
from truebreak.exact.replay.contact import Pair
from truebreak.exact.simulation.decider import Knot, Mark, PackedKnots, PackedRecords, Record
from truebreak.scenarios import catalogue


def knots(count: int) -> list[Knot[arb | fmpq]]:
    return [(arb(k) / 3, arb(-k, 2.0**-90), arb(1), arb(2) ** -k, arb(0), 2 * k, k) for k in range(count)]


def parts(row: Knot[arb]) -> tuple[object, ...]:
    return (*map(parts_of, row[:5]), *row[5:])


def in_turn(times: list[arb | fmpq]) -> PackedRecords:
    return PackedRecords(
        Record(Mark(k + 1, time, 2 * k + 2, 0), (Pair(0, 1),), (Pair(0, 1),), (), False) for k, time in enumerate(times)
    )


def test_a_history_out_of_order_is_seen() -> None:
    """Where two times overlap neither is provably the earlier; what is given exactly is compared with balls."""
    _in_order(in_turn([]))
    _in_order(in_turn([arb(1), arb(2, 1.5), arb(1.5), fmpq(3, 2), fmpq(7, 4)]))
    with pytest.raises(AssertionError, match="event 1 comes after event 2: a defect"):
        _in_order(in_turn([arb(1), arb(3), fmpq(2), arb(4)]))


def test_whether_a_history_is_in_order_is_seen_without_all_its_times_at_once() -> None:
    records = in_turn([arb(k) / 3 for k in range(6000)])
    tracemalloc.start()
    try:
        _in_order(records)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most < 6000 * 8, "less than as many pointers"


@pytest.mark.parametrize("count", [0, 1, 2047, 2048, 2049, 5000])
def test_packed_knots_are_those_that_were_added(count: int) -> None:
    rows = knots(count)
    packed = PackedKnots(rows)
    assert len(packed) == count
    assert [parts(row) for row in packed] == [parts(row) for row in rows]
    for k in {0, 255, 256, 2047, 2048, -1, -count} & set(range(-count, count)):
        assert parts(packed[k]) == parts(rows[k])
    assert [parts(row) for row in packed[1:7]] == [parts(row) for row in rows[1:7]]
    with pytest.raises(IndexError):
        packed[count]
    again = pickle.loads(pickle.dumps(packed))
    assert [parts(row) for row in again] == [parts(row) for row in rows]


def test_rows_are_dropped_and_added_at_the_end() -> None:
    rows = knots(2100)
    packed = PackedKnots(rows)
    for _ in range(300):
        assert parts(packed.pop()) == parts(rows.pop())
    more = knots(2000)
    for row in more:
        packed.append(row)
    assert [parts(row) for row in packed] == [parts(row) for row in [*rows, *more]]


def test_exact_numbers_stay_as_they_are() -> None:
    rows = [*knots(1000), (fmpq(1, 3), arb(0), arb(0), arb(0), arb(0), 0, 0), *knots(2000)]
    packed = PackedKnots(rows)
    assert packed[1000][0] == fmpq(1, 3)
    assert type(packed[1000][0]) is fmpq
    assert parts(packed[1500]) == parts(rows[1500])


def test_records_with_ties_stay_as_they_are() -> None:
    link = (Pair(0, 1),)
    rows = [Record(Mark(2 * k, arb(k), k, 0), link, link, (), k == 70) for k in range(9000)]
    packed = PackedRecords(rows)
    assert packed[70].coupled
    assert not packed[71].coupled
    assert [row.mark.number for row in packed] == [2 * k for k in range(9000)]
    assert float(packed.time_at(16_000)) == 8000
    assert not packed.time_at(16_001).is_finite()


def test_a_long_run_is_the_same_with_all_of_it_packed(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = catalogue.build("gas:n=4")
    plain = ExactEngine().run(scene, events=400)
    for kind in (PackedKnots, PackedRecords):
        monkeypatch.setattr(kind, "block", 8)
        monkeypatch.setattr(kind, "short", 16)
    packed = ExactEngine().run(scene, events=400)
    assert packed.motion.knots[0]._blocks  # type: ignore[attr-defined]
    assert [event.contacts for event in packed.events] == [event.contacts for event in plain.events]
    assert [float(event.time) for event in packed.events] == [float(event.time) for event in plain.events]
    times = [float(event.time) for event in plain.events[:-1:7]]
    assert packed.sample(times).tolist() == plain.sample(times).tolist()
    longer = ExactEngine().resume(packed, events=450)
    assert len(longer.events) == 450
