"""Standard output, lines and tables: plain ones are laid out here, what has colours or wraps by rich."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING, NamedTuple

from ...scenarios.errors import printable

if TYPE_CHECKING:
    from collections.abc import Sequence

    import rich.console
    import rich.table


# ----------------------------------------
# Standard output, lines and tables: plain ones are laid out here, what has colours or wraps by rich.

PLAIN_WIDTH = 110
"""Columns of a table where the output is not a terminal."""

LEAST_WIDTH = 40
"""Fewest columns that COLUMNS may ask for: a table of fewer is a heap of letters."""

BETWEEN = 3
"""Columns between two cells of a row."""

NARROWEST = 10
"""Columns into which no cell is pressed that has a longer word: rows become lists before that."""


def columns() -> int | None:
    """The columns that the variable COLUMNS asks for; None without one that makes sense."""
    asked = os.environ.get("COLUMNS", "")
    return max(int(asked), LEAST_WIDTH) if asked.isdecimal() and len(asked) < 6 and int(asked) > 0 else None


class Tinted(NamedTuple):
    """A cell in a style of its own, where there are colours."""

    text: str
    style: str


class TextTable:
    """Rows under headings; see `grid`."""

    def __init__(
        self, headings: tuple[str, ...], title: str | None, whole: Sequence[str], right: Sequence[str]
    ) -> None:
        self.headings, self.whole, self.right = headings, whole, right
        self.title = None if title is None else printable(title)
        self.rows: list[tuple[tuple[str | Tinted, ...], str | None]] = []

    def add_row(self, *cells: str | Tinted, style: str | None = None) -> None:
        """One cell under each heading, perhaps all in a style."""
        told = (printable(c) if isinstance(c, str) else Tinted(printable(c.text), c.style) for c in cells)
        self.rows.append((tuple(told), style))

    def lines(self, width: int) -> list[str] | None:
        """The table without colours, as rich lays it out; None where it needs rich, to go on in further lines.

        Args:
            width: columns that there are.
        """
        rows = [self.headings, *(self._texts(cells) for cells, _ in self.rows)]
        split = [[cell.split("\n") for cell in row] for row in rows]
        sizes = [max(len(line) for cell in column for line in cell) for column in zip(*split, strict=True)]
        inside = sum(sizes) + BETWEEN * (len(sizes) - 1)
        title = self.title or ""
        if not all(map(_simple, (title, *(cell for row in rows for cell in row)))) or min(sizes) == 0:
            return None
        if inside + 2 > width or len(title) > inside + 2 or "\n" in title:
            return None
        blank = " " * (inside + 2)
        told = [blank, *self._row(split[0], sizes, low=True), f" {'─' * inside} "]
        for row in split[1:]:
            told += self._row(row, sizes)
        return [*([title.ljust(len(blank))] if title else []), *told, blank]

    def _row(self, cells: list[list[str]], sizes: list[int], *, low: bool = False) -> list[str]:
        """The lines of one row; the lines of its cells end together (`low`), or begin together."""
        height = max(map(len, cells))
        columns = []
        for heading, cell, size in zip(self.headings, cells, sizes, strict=True):
            empty = [""] * (height - len(cell))
            filled = [*empty, *cell] if low else [*cell, *empty]
            columns.append([line.rjust(size) if heading in self.right else line.ljust(size) for line in filled])
        return [f" {(' ' * BETWEEN).join(parts)} " for parts in zip(*columns, strict=True)]

    def least(self) -> int:
        """Fewest columns in which it can be read as a table.

        >>> table = grid("engine", "position error", whole=("engine",))
        >>> table.add_row("interval:bits=100", "4.44e-16")
        >>> table.least()
        30
        """
        columns = zip(self.headings, *(self._texts(cells) for cells, _ in self.rows), strict=True)
        return 2 + BETWEEN * (len(self.headings) - 1) + sum(map(self._narrowest, self.headings, columns))

    @staticmethod
    def _texts(cells: Sequence[str | Tinted]) -> tuple[str, ...]:
        return tuple(cell if isinstance(cell, str) else cell.text for cell in cells)

    def _narrowest(self, heading: str, cells: Sequence[str]) -> int:
        parts = [part for cell in cells for part in (cell.split("\n") if heading in self.whole else cell.split())]
        longest = max(map(len, parts), default=0)
        return longest if heading in self.whole else min(longest, NARROWEST)

    def listed(self) -> rich.table.Table:
        """Each row as a list of its cells under each other, with their headings: for few columns."""
        import rich.table
        from rich.text import Text

        title = None if self.title is None else Text(self.title, style="table.title")
        table = rich.table.Table(box=None, title=title, title_justify="left", show_header=False, pad_edge=False)
        table.add_column(overflow="fold", ratio=1)
        table.add_column(overflow="fold", ratio=2)
        for cells, style in self.rows:
            table.add_row("", "")
            for heading, cell in zip(self.headings, cells, strict=True):
                text = Text(cell) if isinstance(cell, str) else Text(*cell)
                if text.plain.strip():
                    table.add_row(Text(" ".join(heading.split())), text, style=style)
        table.add_row("", "")
        return table

    def rich(self, width: int | None = None) -> rich.table.Table:
        """The table as rich has it.

        Args:
            width: columns that there are; too few for a table make a list of each row.
        """
        import rich.box
        import rich.table
        from rich.text import Text

        if width is not None and width < self.least():
            return self.listed()
        title = None if self.title is None else Text(self.title, style="table.title")
        table = rich.table.Table(box=rich.box.SIMPLE, title=title, title_justify="left", pad_edge=False)
        for heading in self.headings:
            justify = "right" if heading in self.right else "left"
            table.add_column(Text(heading), overflow="fold", no_wrap=heading in self.whole, justify=justify)
        for cells, style in self.rows:
            table.add_row(*(Text(c) if isinstance(c, str) else Text(*c) for c in cells), style=style)
        return table


def grid(*headings: str, title: str | None = None, whole: Sequence[str] = (), right: Sequence[str] = ()) -> TextTable:
    """An empty table in the one style of all reports. Nothing in it is ever cut.

    Args:
        whole: headings of the columns whose cells stay on one line; others go on in the next.
        right: headings of the columns whose cells end at the right.

    >>> table = grid("circle", "x", right=("x",))
    >>> table.add_row("c1", "0.25")
    >>> [line.strip() for line in table.lines(80)]
    ['', 'circle      x', '─────────────', 'c1       0.25', '']
    """
    return TextTable(headings, title, whole, right)


class Output:
    """Standard output.

    Attributes:
        plain: whether it has no colours.
        width: columns; None: as many as the terminal has.
    """

    def __init__(self, *, plain: bool, width: int | None) -> None:
        self.plain, self.width = plain, width

    def print(self, table: TextTable) -> None:
        """A table."""
        encoding = (getattr(sys.stdout, "encoding", None) or "utf-8").lower()
        lines = table.lines(self.width) if self.plain and self.width and encoding.startswith("utf") else None
        if lines is None:
            out = self.rich()
            out.print(table.rich(out.width))
        else:
            _write("\n".join(lines))

    def rich(self) -> rich.console.Console:
        """It as rich has it."""
        from rich.console import Console

        class Shown(Console):
            """A console that leaves a closed pipe to the caller, where rich would exit with code 1: diverged."""

            def on_broken_pipe(self) -> None:
                raise BrokenPipeError

        return Shown(width=self.width, highlight=False, soft_wrap=False)


def console() -> Output:
    """Standard output: colours on a terminal, plain text elsewhere; as wide as COLUMNS says, if it says anything."""
    terminal = sys.stdout.isatty()
    colours = terminal or os.environ.get("FORCE_COLOR", "") != "" or os.environ.get("TTY_COMPATIBLE") == "1"
    return Output(plain=not colours, width=columns() or (None if terminal else PLAIN_WIDTH))


def say(out: Output, text: str, style: str | None = None) -> None:
    """A line of text; where the output is not a terminal it stays one line, however long, unless COLUMNS is set."""
    text, width = printable(text), columns()
    if out.plain and _fits(text, width):
        _write(text)
        return
    from rich.text import Text

    rich = out.rich()
    rich.print(Text(text, style=style or ""), soft_wrap=not rich.is_terminal and width is None)


def _fits(text: str, width: int | None) -> bool:
    """Whether a text can be written as it is."""
    if width is None:
        return text.replace("\n", "").isprintable()
    return _simple(text) and all(len(line) <= width for line in text.split("\n"))


def _simple(text: str) -> bool:
    """Whether each character takes one column, but for ends of lines."""
    return text.isascii() and text.replace("\n", "").isprintable()


def _write(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()
