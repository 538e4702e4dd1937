"""Tables and lines are as wide as the output, nothing in them is cut, and a cell is nothing but text."""

from __future__ import annotations

import io
import re
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from truebreak.compare.report.output import TextTable, Tinted, console, grid, say, wrapped

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


@given(tables(), st.integers(20, 90))
def test_nothing_in_a_table_is_cut_and_no_line_is_longer_than_the_width(table: TextTable, width: int) -> None:
    lines = table.lines(width)
    cells = [*table.headings, *(cell.text for cells, _ in table.rows for cell in cells)]
    assert max(map(len, lines)) <= max(width, table.least() if width >= table.least() else 0)
    if width >= table.least():
        assert sum(len("".join(cell.split())) for cell in [*cells, table.title or ""]) == sum(
            len("".join(line.replace("\u2500", "").split())) for line in lines
        )


@given(tables())
def test_where_there_is_room_each_line_of_a_cell_is_one_line(table: TextTable) -> None:
    """Columns begin where their heading does, three apart."""
    lines = table.lines(500)
    height = max(heading.count("\n") for heading in table.headings) + 1
    assert len(lines) == len(table.rows) + height + 3 + bool(table.title)
    place = 1
    for heading, cells in zip(table.headings, zip(*(cells for cells, _ in table.rows), strict=True), strict=False):
        wide = max(len(line) for text in (heading, *(cell.text for cell in cells)) for line in text.split("\n"))
        shown = [line[place : place + wide].strip() for line in lines[-1 - len(table.rows) : -1]]
        assert shown == [cell.text for cell in cells]
        place += wide + 3


SETTINGS = "pymunk:dt=1/1024,iterations=10,max_steps=300000"


@pytest.mark.parametrize("width", [90, 60, 40])
def test_settings_are_never_parted_inside_a_word(width: int) -> None:
    """In a table, in a list of few columns, and in a line."""
    table = grid("setting", "right on", "first failure")
    table.add_row(SETTINGS, "9 of 9", f"{SETTINGS} differs at event 51")
    for lines in (table.lines(width), wrapped(f"No setting, such as {SETTINGS}, is right.", width)):
        assert max(map(len, lines)) <= width
        words = {word for line in lines for word in re.split(r"[\s:=,/]+", line)}
        assert words >= {"pymunk", "dt", "1024", "iterations", "10", "max_steps", "300000"}


def test_further_lines_keep_the_indent(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    say(console(), "  " + "word " * 20 + "end")
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) > 2
    assert all(len(line) <= 40 and re.match(r"  \S", line) for line in lines)
    say(console(), "word " * 20 + "end", label="where  ")
    first, *others = capsys.readouterr().out.splitlines()
    assert first.startswith("where  word")
    assert others
    assert all(len(line) <= 40 and re.match(r" {7}\S", line) for line in others)


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
