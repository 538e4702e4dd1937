"""Both checkers say the same of certificates tampered with in many kinds; what either verifies is true."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import pytest

from certificate import campaign
from certificate.campaign import NO_CERTIFICATE, REFUTED, UNDECIDED, VERIFIED
from certificate.checkers import needs_node
from certificate.kinds import KINDS


def test_there_are_many_kinds() -> None:
    assert len(KINDS) >= 60


@needs_node
@pytest.mark.parametrize("count", [len(KINDS), pytest.param(20_000, marks=pytest.mark.slow)])
@pytest.mark.timeout(7200)
def test_both_checkers_say_the_same_of_what_is_tampered_with(count: int, tmp_path: Path) -> None:
    results = list(campaign.campaign(range(count), tmp_path))
    assert [one for one in results if one.fault] == []
    codes = Counter((one.python, one.node) for one in results)
    assert sum(codes.values()) == count
    alike = sum(many for (one, other), many in codes.items() if one == other)
    assert alike > 0.95 * count, codes
    for code in (VERIFIED, REFUTED, NO_CERTIFICATE, UNDECIDED):
        assert codes[code, code] > count // 100, codes


@needs_node
@needs_node
def test_a_campaign_of_what_moves_finds_no_fault_and_would_find_a_run_that_is_not_verified(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    results = list(campaign.campaign(range(30), tmp_path, campaign.moving))
    assert [result.fault for result in results if result.fault] == []
    honest = [result for result in results if result.made.startswith(campaign.AS_IT_IS)]
    assert len(honest) > 7 and sum(result.python == REFUTED for result in results) > 5
    monkeypatch.setattr(campaign, "by_python", lambda path: (UNDECIDED, "as if it did not know"))
    wrong = list(campaign.campaign([honest[0].number], tmp_path, campaign.moving))
    assert wrong[0].fault.startswith("it is a run of the engine")


def test_a_campaign_goes_on_where_it_was_ended(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "results"
    assert campaign.main([str(file), "--count", "3"]) == 0
    first = file.read_text(encoding="utf-8")
    file.write_text(first[:-9], encoding="utf-8")  # killed within the third line
    assert campaign.main([str(file), "--count", "4"]) == 0
    rows = file.read_text(encoding="utf-8")
    assert rows.startswith(first) and [json.loads(row)["number"] for row in rows.splitlines()] == [0, 1, 2, 3]
    assert "4 certificates" in capsys.readouterr().out


@pytest.mark.parametrize(("first", "second"), [(VERIFIED, REFUTED), (REFUTED, NO_CERTIFICATE), (VERIFIED, VERIFIED)])
def test_verdicts_that_contradict_each_other_or_the_engine_are_faults(first: int, second: int) -> None:
    _, told = campaign.tampered(sorted(KINDS).index("vx of a circle"))
    assert campaign.fault_in(told, (first, "a"), (second, "a"))
    assert not campaign.fault_in(told, (REFUTED, "a"), (UNDECIDED, "b"))
