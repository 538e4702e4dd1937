"""The terminal: nothing cut at 80 columns, numbers refused with what to write, long values not repeated whole."""

from __future__ import annotations

import json
from typing import Any

import pytest
from pages import comparison, page

from truebreak.compare import compare
from truebreak.compare.chaos.foreseen import foreseen
from truebreak.compare.cli import main
from truebreak.compare.report.output import PLAIN_WIDTH, columns, console, grid
from truebreak.compare.report.sentences import about, margin_phrase, short
from truebreak.compare.report.terminal import print_comparison
from truebreak.scenarios import Circle, Scene, Wall, catalogue
from truebreak.scenarios.errors import SceneError
from truebreak.scenarios.files import loads_json, loads_toml


def printed(kind: str, capsys: pytest.CaptureFixture[str], *, verbose: bool = False) -> str:
    """What the terminal says of a comparison."""
    print_comparison(comparison(kind), verbose=verbose)
    return capsys.readouterr().out


def said(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    """The one line of error that a command line gives."""
    with pytest.raises(SystemExit) as stop:
        main(list(words))
    told = capsys.readouterr()
    assert (stop.value.code, told.out) == (2, "")
    assert len(told.err.splitlines()) == 1
    return told.err


@pytest.mark.parametrize("verbose", [False, True])
@pytest.mark.parametrize("width", [80, 40])
@pytest.mark.parametrize("kind", ["gas", "near-tie", "rack", "reversal", "hostile", "many-engines"])
def test_nothing_is_cut_at_80_columns_nor_at_40(
    kind: str, width: int, verbose: bool, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    told = printed(kind, capsys, verbose=verbose)
    assert max(map(len, told.splitlines())) <= width
    assert "…" not in told
    joined = "".join(told.split())
    for candidate in comparison(kind).candidates:
        assert candidate.verdict in told.split()
        assert "".join(candidate.engine.split()) in joined
        assert short(candidate.separation.maximum) in joined


def test_piped_output_is_as_wide_as_columns_says_and_plain(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    assert console().width == PLAIN_WIDTH
    wide = printed("gas", capsys)
    assert max(map(len, wide.splitlines())) > 120
    for asked, width in (("100", 100), ("7", 40), ("zero", PLAIN_WIDTH), ("0", PLAIN_WIDTH), ("9" * 50, PLAIN_WIDTH)):
        monkeypatch.setenv("COLUMNS", asked)
        assert console().width == width
    monkeypatch.setenv("COLUMNS", "100")
    assert columns() == 100
    told = printed("gas", capsys)
    assert max(map(len, told.splitlines())) <= 100
    assert "\x1b" not in told + wide


def test_the_report_is_twelve_lines_and_the_rest_comes_when_asked_for(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Verdict, scene, a table of an engine a line, and four answers."""
    monkeypatch.delenv("COLUMNS", raising=False)
    lines = printed("gas", capsys).splitlines()
    assert len(lines) == 5 + len(comparison("gas").candidates) + 4 == 12
    assert [line[:10].strip() for line in lines[-4:]] == ["where", "why", "so what", "what now"]
    assert "pymunk diverges at event 22" in lines[0]
    told = foreseen(comparison("gas"))
    assert told is not None and told.horizons[1] is not None
    assert f"pymunk is predicted to be right until event {told.horizons[1].low.event} " in lines[-1]
    whole = printed("gas", capsys, verbose=True)
    assert "kind of error" in whole
    assert "kind of error" not in "\n".join(lines)


def test_headings_give_way_before_a_table_becomes_a_list() -> None:
    """A list takes a line a cell: of four engines two dozen. No word is parted for it."""
    table = grid("engine", "differs at", "position error", whole=("differs at", "position error"), close=True)
    table.add_row("double", "event 19", "4.07e-11")
    assert table.lines(40)[0].split() == ["engine", "differs", "at", "position", "error"]
    assert [line.split() for line in table.lines(31)[:2]] == [["differs", "position"], ["engine", "at", "error"]]
    assert table.lines(31)[-1].split() == ["double", "event", "19", "4.07e-11"]
    assert table.lines(29)[1].split() == ["engine", "double"]


def test_who_agrees_gets_the_verdict_and_what_to_do(capsys: pytest.CaptureFixture[str]) -> None:
    print_comparison(compare(catalogue.build("cradle"), ["double"], events=6, causes=False))
    told = capsys.readouterr().out
    assert "did not change what happened" in told
    assert "what now" in told
    assert not any(word in told for word in ("where  ", "so what"))


def test_changed_outcomes_stand_below_the_table(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    candidate = comparison("gas")["pymunk"]
    (line,) = [
        line for line in printed("gas", capsys, verbose=True).splitlines() if line.startswith("pymunk changed: ")
    ]
    assert all(name.replace("_", " ") in line for name in candidate.changed)


@pytest.mark.parametrize(
    ("words", "remedy"),
    [
        (["compare", "gas", "--events", "1e3"], "'1e3' is not a whole number; write digits alone: 1000"),
        (["compare", "gas", "--events", "0"], "'0' is too small; write a whole number from 1"),
        (["run", "gas", "--work", "2.5"], "'2.5' is not a whole number; write digits alone, such as 1000"),
        (["run", "gas", "--max-seconds", "soon"], "'soon' is not a number of seconds above 0; write one such as 2.5"),
        (["run", "gas", "--max-seconds", "nan"], "'nan' is not a number of seconds above 0"),
        (["orders", "lee", "--cap", "many"], "'many' is not a whole number"),
    ],
)
def test_a_wrong_number_is_told_what_to_write(
    words: list[str], remedy: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert remedy in said(capsys, *words)


LONG = "x" * 5000


@pytest.mark.parametrize(
    "words",
    [
        ["show", "lee", "--plot", LONG],
        ["show", "lee", "--plot", "y z " * 1250],
        ["compare", LONG],
        ["compare", "gas", "--engines", LONG],
        ["compare", "gas", "--events", LONG],
        ["compare", "gas", "--until", LONG],
        ["compare", "gas", "--tie-policy", LONG],
        ["compare", "gas", "--html", f"no/{LONG}"],
        [LONG],
    ],
    ids=lambda words: " ".join(word[:12] for word in words),
)
def test_a_long_value_is_not_repeated_whole(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    told = said(capsys, *words)
    assert told.startswith("truebreak: error: ")
    assert len(told) < 1_100


def test_help_of_bench_is_asked_for_like_any_other(capsys: pytest.CaptureFixture[str]) -> None:
    for word in ("-h", "--help"):
        with pytest.raises(SystemExit) as stop:
            main(["bench", word])
        assert stop.value.code == 0
        assert "run time against error" in capsys.readouterr().out


def test_each_kind_of_file_is_told_its_own_remedy() -> None:
    for kind in ("circle", "wall", "pocket"):
        rows: dict[str, Any] = {"circle": [{"id": "a", "x": 0, "y": 0, "r": 1}], kind: 3}
        with pytest.raises(SceneError, match=f'write "{kind}": ') as refused:
            loads_json(json.dumps(rows))
        assert "[[" not in str(refused.value)
    with pytest.raises(SceneError, match=r"write \[\[circle\]\] above each of them"):
        loads_toml("circle = 3")
    for load, text in ((loads_json, '{"name": "x"}'), (loads_toml, 'name = "x"')):
        with pytest.raises(SceneError, match="add at least one circle"):
            load(text)


def test_a_margin_too_small_for_a_double_is_not_called_zero() -> None:
    assert about((0.0, 5e-324)) == "less than 4.94e-324"
    told = margin_phrase(comparison("far-near-tie").candidates[0])
    assert told is not None
    assert "the second came less than 4.94e-324 later" in told
    assert "came 0 later" not in told
    assert "(0 spacings" not in told


def test_a_page_of_outcomes_says_nothing_in_the_words_of_python() -> None:
    for kind in ("rack", "near-tie", "gas"):
        assert not any(word in page(kind) for word in ("kept: True", "lost_at", ">None<", ">True<"))


@pytest.mark.parametrize(
    ("until", "told"),
    [("21/2", "(reached the time limit 21/2)"), ("6127674000886021/140737488355328", "(reached the time limit)")],
)
def test_a_time_limit_is_told_where_it_can_be_read(until: str, told: str, capsys: pytest.CaptureFixture[str]) -> None:
    print_comparison(compare(catalogue.build("gas"), ["double"], until=until, causes=False), verbose=True)
    assert told in capsys.readouterr().out


def test_a_contact_that_a_run_lacks_is_said_to_be_lacking_as_far_as_it_goes(capsys: pytest.CaptureFixture[str]) -> None:
    """What rests at a wall is struck a little below its middle: double goes along the wall, as far as it is run."""
    scene = Scene(
        [Circle(0, "2-10**-30", 1, vx=1, id="b"), Circle(4, 2, 1, id="d")], [Wall(0, 3, 1, 3, id="w")], until=5
    )
    print_comparison(compare(scene, ["double"], causes=False), verbose=True)
    assert "circle d does not meet wall w by t = 10." in capsys.readouterr().out.replace("\n", " ")
