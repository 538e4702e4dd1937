"""Standard output: lines and tables as wide as it is; rich is loaded for colours alone."""

from __future__ import annotations

import os
import re
import sys
from typing import TYPE_CHECKING, NamedTuple

from ...scenarios.errors import printable

if TYPE_CHECKING:
    from collections.abc import Sequence


PLAIN_WIDTH = 110
"""Columns of a table where the output is not a terminal."""

LEAST_WIDTH = 40
"""Fewest columns that COLUMNS may ask for: a table of fewer is a heap of letters."""

BETWEEN = 3
"""Columns between two cells of a row."""

NARROWEST = 10
"""Columns that a cell gets at least, if it has so many: rows become lists before that."""

JOINT = re.compile(r"(?<=[:=,/])(?=[^:=,/])")
"""Where a word too long for its line is parted: an engine's settings go on after a colon, `=` or comma."""


def columns() -> int | None:
    """The columns that the variable COLUMNS asks for; None without one that makes sense."""
    asked = os.environ.get("COLUMNS", "")
    return max(int(asked), LEAST_WIDTH) if asked.isdecimal() and len(asked) < 6 and int(asked) > 0 else None


def size(text: str) -> int:
    """Columns that a line takes.

    >>> size("wall"), size("\u65e5\u672c")
    (4, 4)
    """
    if text.isascii():
        return len(text)
    from rich.cells import cell_len

    return cell_len(text)


def wrapped(text: str, width: int) -> list[str]:
    """A text in lines of at most so many columns, broken between words; within a long word where its parts join.

    >>> wrapped("pymunk:dt=1/1024,iterations=10 agrees", 20)
    ['pymunk:dt=1/1024,', 'iterations=10 agrees']
    """
    lines = []
    for part in text.split("\n"):
        line = ""
        for number, word in enumerate(part.split(" ")):
            joined = f"{line} {word}" if number else word
            if size(joined) <= width:
                line = joined
                continue
            if line.strip():
                lines.append(line.rstrip())
            *full, line = _parts(word, width)
            lines += full
        lines.append(line.rstrip())
    return lines


def _parts(word: str, width: int) -> list[str]:
    """A word in pieces, each as long as the width allows; by letters only where no joint helps."""
    found = [""]
    for piece in JOINT.split(word):
        if size(found[-1] + piece) <= width:
            found[-1] += piece
            continue
        rest = piece
        if found[-1]:
            found.append("")
        while size(rest) > width:
            cut = next(k for k in range(len(rest), 0, -1) if k == 1 or size(rest[:k]) <= width)
            found[-1], rest = rest[:cut], rest[cut:]
            found.append("")
        found[-1] = rest
    return found


class Tinted(NamedTuple):
    """A cell in a style of its own, where there are colours."""

    text: str
    style: str


Line = list[tuple[str, str]]
"""Pieces of a line, each with its style."""


class TextTable:
    """Rows under headings; see `grid`."""

    def __init__(
        self, headings: tuple[str, ...], title: str | None, whole: Sequence[str], right: Sequence[str], close: bool
    ) -> None:
        self.headings, self.whole, self.right, self.close = headings, whole, right, close
        self.title = None if title is None else printable(title)
        self.rows: list[tuple[tuple[Tinted, ...], str]] = []

    def add_row(self, *cells: str | Tinted, style: str | None = None) -> None:
        """One cell under each heading, perhaps all in a style."""
        told = (Tinted(printable(c), "") if isinstance(c, str) else Tinted(printable(c.text), c.style) for c in cells)
        self.rows.append((tuple(told), style or ""))

    def lines(self, width: int, rule: str = "─") -> list[str]:
        """The table without colours, in lines.

        Args:
            width: columns that there are; too few for a table make a list of each row.
        """
        return ["".join(text for text, _ in line).rstrip() for line in self.styled(width, rule)]

    def styled(self, width: int, rule: str = "─") -> list[Line]:
        """The table in lines of pieces with their styles."""
        folded = width < self.least()
        if width < self.least(folded=True):
            return self._listed(width)
        wide = [max(size(line) for cell in column for line in cell.split("\n")) for column in self._columns()]
        least, room = self._least(folded), width - 2 - BETWEEN * (len(wide) - 1)
        level = max(wide)
        while sum(sizes := [min(n, max(m, level)) for n, m in zip(wide, least, strict=True)]) > room:
            level -= 1
        blank: list[Line] = [] if self.close else [[]]
        told: list[Line] = [[(line, "table.title")] for line in wrapped(self.title, width)] if self.title else []
        told += [*blank, *self._row([Tinted(heading, "bold") for heading in self.headings], sizes, low=True)]
        told.append([(f" {rule * (sum(sizes) + BETWEEN * (len(sizes) - 1))} ", "")])
        for cells, style in self.rows:
            told += self._row([Tinted(cell.text, cell.style or style) for cell in cells], sizes)
        return [*told, *blank]

    def _row(self, cells: Sequence[Tinted], sizes: list[int], *, low: bool = False) -> list[Line]:
        """The lines of one row; the lines of its cells end together (`low`), or begin together."""
        split = [wrapped(cell.text, width) for cell, width in zip(cells, sizes, strict=True)]
        height = max(map(len, split))
        lines: list[Line] = [[(" ", "")] for _ in range(height)]
        for number, (heading, cell, part, width) in enumerate(zip(self.headings, cells, split, sizes, strict=True)):
            empty = [""] * (height - len(part))
            for line, text in zip(lines, [*empty, *part] if low else [*part, *empty], strict=True):
                room = " " * (width - size(text))
                line.append((" " * BETWEEN if number else "", ""))
                line += [(room, ""), (text, cell.style)] if heading in self.right else [(text, cell.style), (room, "")]
        return lines

    def least(self, *, folded: bool = False) -> int:
        """Fewest columns in which it can be read as a table.

        Args:
            folded: with headings that take a line a word, but no other word in parts.

        >>> table = grid("engine", "position error", whole=("engine",))
        >>> table.add_row("interval:bits=100", "4.44e-16")
        >>> table.least()
        30
        """
        return 2 + BETWEEN * (len(self.headings) - 1) + sum(self._least(folded))

    def _columns(self) -> list[tuple[str, ...]]:
        rows = [self.headings, *(tuple(cell.text for cell in cells) for cells, _ in self.rows)]
        return list(zip(*rows, strict=True))

    def _least(self, folded: bool) -> list[int]:
        """Columns that each column takes at least: its lines, its words, or the parts of its words."""
        found = []
        for heading, cells in zip(self.headings, self._columns(), strict=True):
            lines = [line for cell in cells for line in cell.split("\n")]
            words = [word for line in lines for word in line.split()]
            parts = max((size(part) for word in words for part in JOINT.split(word)), default=1)
            longest = max(map(size, words), default=1)
            whole = [*heading.split(), *lines[heading.count("\n") + 1 :]] if folded else lines
            least = longest if folded else max(min(longest, NARROWEST), parts)
            found.append(max(map(size, whole)) if heading in self.whole else least)
        return found

    def _listed(self, width: int) -> list[Line]:
        """Each row as a list of its cells under each other, with their headings: for few columns."""
        names = [" ".join(heading.split()) for heading in self.headings]
        wide = min(max(map(size, names)), 2 * width // 5)
        told: list[Line] = [[(line, "table.title")] for line in wrapped(self.title, width)] if self.title else []
        for cells, style in self.rows:
            told.append([])
            for name, cell in zip(names, cells, strict=True):
                if not cell.text.strip():
                    continue
                heads, texts = wrapped(name, wide), wrapped(cell.text, width - wide - 2)
                for k in range(max(len(heads), len(texts))):
                    head, text = (part[k] if k < len(part) else "" for part in (heads, texts))
                    told.append([(head + " " * (wide + 2 - size(head)), style), (text, cell.style or style)])
        return [*told, []]


def grid(
    *headings: str, title: str | None = None, whole: Sequence[str] = (), right: Sequence[str] = (), close: bool = False
) -> TextTable:
    """An empty table in the one style of all reports. Nothing in it is ever cut.

    Args:
        whole: headings of the columns whose cells stay on one line; others go on in the next.
        right: headings of the columns whose cells end at the right.
        close: no empty line before and after it.

    >>> table = grid("circle", "x", right=("x",))
    >>> table.add_row("c1", "0.25")
    >>> [line.strip() for line in table.lines(80)]
    ['', 'circle      x', '─────────────', 'c1       0.25', '']
    """
    return TextTable(headings, title, whole, right, close)


class Output:
    """Standard output.

    Attributes:
        plain: whether it has no colours.
        width: columns of a table.
        wraps: whether lines of text are wrapped at them too.
    """

    def __init__(self, *, plain: bool, width: int, wraps: bool) -> None:
        self.plain, self.width, self.wraps = plain, width, wraps

    def print(self, table: TextTable) -> None:
        """A table."""
        encoding = (getattr(sys.stdout, "encoding", None) or "utf-8").lower()
        self.write(table.styled(self.width, "─" if encoding.startswith("utf") else "-"))

    def write(self, lines: Sequence[Line]) -> None:
        """Lines, as they are."""
        if self.plain:
            sys.stdout.write("".join("".join(text for text, _ in line).rstrip() + "\n" for line in lines))
            sys.stdout.flush()
            return
        from rich.console import Console
        from rich.text import Text

        class Shown(Console):
            """A console that leaves a closed pipe to the caller, where rich would exit with code 1: diverged."""

            def on_broken_pipe(self) -> None:
                raise BrokenPipeError

        out = Shown(highlight=False)
        for line in lines:
            out.print(Text.assemble(*line), soft_wrap=True)


def console() -> Output:
    """Standard output: colours on a terminal, plain text elsewhere; as wide as COLUMNS says, if it says anything."""
    terminal, asked = sys.stdout.isatty(), columns()
    colours = terminal or os.environ.get("FORCE_COLOR", "") != "" or os.environ.get("TTY_COMPATIBLE") == "1"
    width = asked or PLAIN_WIDTH
    if terminal and not asked:
        import shutil

        width = max(shutil.get_terminal_size().columns, LEAST_WIDTH)
    return Output(plain=not colours, width=width, wraps=terminal or asked is not None)


def say(out: Output, text: str, style: str | None = None, label: str = "") -> None:
    """A line of text; where the output is not a terminal it stays one line, however long, unless COLUMNS is set.

    Args:
        label: what stands before it, in bold; further lines are indented by as much, as by spaces that it begins with.
    """
    told = printable(text)
    body = told.lstrip(" ")
    indent = label or " " * (len(told) - len(body))
    lines = wrapped(body, out.width - size(indent)) if out.wraps else body.split("\n")
    after = [(" " * size(indent), "") for _ in lines[1:]]
    first = (indent, "bold" if label else "")
    out.write([[before, (line, style or "")] for before, line in zip([first, *after], lines, strict=True)])
