"""Plain tables are those of rich, character by character; nothing in a cell is read as anything but text."""

from __future__ import annotations

import io
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from truebreak.compare.report.output import PLAIN_WIDTH, TextTable, Tinted, console, grid, say

TEXT = st.text("ab 1-:[]/\\.", max_size=9).map(str.strip)


@st.composite
def tables(draw: st.DrawFn) -> TextTable:
    count = draw(st.integers(1, 5))
    headings = draw(st.lists(TEXT.filter(bool), min_size=count, max_size=count, unique=True))
    two_lines = draw(st.booleans())
    named = [f"{heading}\nunder" if two_lines and k % 2 else heading for k, heading in enumerate(headings)]
    title = draw(st.none() | TEXT.filter(bool))
    table = grid(*named, title=title, whole=named[:1], right=draw(st.sampled_from([(), tuple(named[-1:])])))
    for row in draw(st.lists(st.lists(TEXT, min_size=count, max_size=count), max_size=4)):
        table.add_row(*row, style=draw(st.sampled_from([None, "bold red"])))
    return table


def by_rich(table: TextTable, width: int = PLAIN_WIDTH) -> str:
    out = io.StringIO()
    Console(file=out, width=width, highlight=False, force_terminal=False).print(table.rich())
    return out.getvalue()


@given(tables())
def test_a_plain_table_is_what_rich_makes_of_it(table: TextTable) -> None:
    lines = table.lines(PLAIN_WIDTH)
    if lines is not None:
        assert "".join(f"{line}\n" for line in lines) == by_rich(table)
    else:
        assert len(table.title or "") > max(map(len, by_rich(table).splitlines())) - 2


def test_what_does_not_fit_is_left_to_rich(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    table = grid("one", "two")
    table.add_row("a" * 30, "b " * 20)
    assert table.lines(40) is None
    assert table.lines(79) is not None
    console().print(table)
    told = capsys.readouterr().out
    assert told == by_rich(table, 40)
    assert (told.count("a"), told.count("b")) == (30, 20)
    say(console(), "word " * 20 + "end")
    assert [len(line) <= 40 for line in capsys.readouterr().out.splitlines()] == [True] * 3


def test_with_too_few_columns_each_row_is_a_list(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    headings = ("engine", "verdict", "agreed", "differs at", "cause", "position\nerror")
    table = grid(*headings, whole=("engine",))
    table.add_row("pymunk:dt=1/1024", Tinted("diverged", "red"), "12", "event 13", "arithmetic rounding", "4.44e-16")
    table.add_row("exact", "reference", "", "", "", "")
    monkeypatch.setenv("COLUMNS", str(table.least()))
    console().print(table)
    assert len(capsys.readouterr().out.splitlines()) < 10
    monkeypatch.setenv("COLUMNS", str(table.least() - 1))
    console().print(table)
    told = [line.split("  ")[0].strip() for line in capsys.readouterr().out.splitlines()]
    names = [" ".join(heading.split()) for heading in headings]
    assert told == ["", *names, "", *names[:2], ""]
    monkeypatch.setenv("COLUMNS", "40")
    console().print(table)
    lines = capsys.readouterr().out.splitlines()
    assert all(len(line) <= 40 for line in lines)
    assert "position error  4.44e-16" in " ".join(lines).replace("   ", "  ")


def test_cells_are_text(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither markup nor the name of a picture, plain or by rich."""
    monkeypatch.delenv("COLUMNS", raising=False)
    for word in ("[bold]", "[/]", ":snake:", "\\[x]", "größe", "日本"):
        table = grid("name", title=word)
        table.add_row(Tinted(word, "red"))
        console().print(table)
        say(console(), word)
        assert capsys.readouterr().out.count(word) == 3


def test_colours_are_for_terminals_and_for_who_asks(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    say(console(), "plain", "bold red")
    assert capsys.readouterr().out == "plain\n"
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("TERM", "xterm")
    say(console(), "loud", "bold red")
    assert "\x1b[" in capsys.readouterr().out


def test_a_closed_pipe_is_told_to_the_caller(monkeypatch: pytest.MonkeyPatch) -> None:
    class Closed(io.StringIO):
        def write(self, text: str) -> int:
            raise BrokenPipeError

    monkeypatch.setattr(sys, "stdout", Closed())
    table = grid("one")
    table.add_row("two")
    for wide in (table, grid("x" * 200)):
        with pytest.raises(BrokenPipeError):
            console().print(wide)
    with pytest.raises(BrokenPipeError):
        say(console(), "word")
