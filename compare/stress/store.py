"""The rows of a stress map in one file of JSON lines, in order: what is interrupted goes on, and ends the same."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...scenarios.disk import Lines
from ...scenarios.errors import SceneError
from .rows.cell import StressRow
from .table import family

if TYPE_CHECKING:
    from .family import MapPlace

FORMAT = "truebreak/stress-store-2"

SUM = 16
"""Letters of the sum on each line: SHA-256 of the sum before it and of what the line says."""


class Store:
    """The rows of one map, in memory and in a file.

    The first line tells what is asked for, each further one is a row, in the order of the map's places. A line ends
    with a sum over all before it, so that a file of another kind, or one that was damaged, is refused. Only its end may
    be missing, in the middle of a line too: that is what an interruption leaves.

    Args:
        path: the file; None: only in memory.
        settings: what the map is of. A new file takes it up; one of another map is refused. None: the file must be
            there, and is only read.
        places: of the map; what a file holds must be the first of them.

    Attributes:
        rows: those that are there.
        settings: what the map is of.

    Raises:
        SceneError: if the file is no store, of another map, damaged, or not to be written.
    """

    def __init__(
        self, path: str | None, settings: Mapping[str, Any] | None = None, places: Sequence[MapPlace] = ()
    ) -> None:
        self.path, self._places, self._writes = path, places, settings is not None
        self.settings: dict[str, Any] = json.loads(json.dumps(settings or {}))
        self.rows: list[StressRow] = []
        self._sum = ""
        self._lines: Lines | None = None
        if path is not None:
            with self._told():
                self._open(Path(path))

    def _open(self, path: Path) -> None:
        if path.exists() and not path.is_file():
            raise SceneError(f"--store {self.path!r}: is no regular file; choose another")
        if self._writes:
            self._lines = Lines(path)
            head = self._line({"format": FORMAT, "settings": self.settings})
            if not self._lines.whole and head.startswith(self._lines.rest):
                self._lines.add(head)
                return
            self._sum = ""
            self._read(self._lines.whole)
            return
        data = path.read_bytes() if path.exists() else b""
        if not data:
            raise SceneError(f"--store {self.path!r}: there is no such file, or nothing in it")
        self._read(data.split(b"\n")[:-1])

    def _read(self, lines: Sequence[bytes]) -> None:
        """Takes up what a file holds."""
        for number, line in enumerate(lines, start=1):
            told = self._said(line, number)
            if number == 1:
                self._agree(told)
            else:
                self._check(told, number)
                self.rows.append(told)
        if not lines:
            raise self._foreign()

    def _foreign(self) -> SceneError:
        return SceneError(f"--store {self.path!r}: is no store of a stress map ({FORMAT}); choose another file")

    def _agree(self, head: Mapping[str, Any]) -> None:
        """Refuses a file that holds another map."""
        if head.get("format") != FORMAT or not isinstance(mine := head.get("settings"), dict):
            raise self._foreign()
        for key, value in self.settings.items():
            if mine.get(key) != value:
                raise SceneError(
                    f"--store {self.path!r}: holds another map: its {key} = {_short(mine.get(key))}, and here it is "
                    f"{_short(value)}; choose another file"
                )
        self.settings = mine

    def _check(self, row: StressRow, number: int) -> None:
        """Refuses a row that is not the next of the map asked for, or is of another scene than its place has now."""
        if not self._writes:
            return
        where = f"--store {self.path!r}: line {number}"
        place = self._places[number - 2] if number - 2 < len(self._places) else None
        if place is None or (row["family"], row["side"], row["seed"], row["k"]) != (
            place.family, place.side, place.seed, place.k
        ):  # fmt: skip
            raise SceneError(f"{where} is of another place than the map has there; choose another file")
        if row["scene"] != family(place.family).scene(place).digest:
            raise SceneError(f"{where} is of another scene than {place.family} has now; choose another file")

    def _said(self, line: bytes, number: int) -> dict[str, Any]:
        """What a line says, if its sum is right."""
        try:
            says: dict[str, Any] = json.loads(line)["says"]
            if self._line(says) == line + b"\n":
                return says
        except (ValueError, LookupError, TypeError, RecursionError):
            pass
        if number == 1:
            raise self._foreign()
        raise SceneError(f"--store {self.path!r}: is damaged at line {number}; choose another file")

    def _line(self, says: Mapping[str, Any]) -> bytes:
        """A line, and its sum kept for the next."""
        text = json.dumps(says, separators=(",", ":"))
        self._sum = sha256(f"{self._sum}{text}".encode()).hexdigest()[:SUM]
        return f'{{"says":{text},"sum":"{self._sum}"}}\n'.encode()

    def add(self, row: StressRow) -> None:
        """Keeps the next row: it is on disk when this returns.

        Raises:
            SceneError: if it cannot be written; what was there stays.
        """
        if self._lines is not None:
            before = self._sum
            try:
                with self._told():
                    self._lines.add(self._line(row))
            except BaseException:
                self._sum = before
                raise
        self.rows.append(row)

    @contextmanager
    def _told(self) -> Iterator[None]:
        """Turns the file system's errors into one line."""
        try:
            yield
        except BlockingIOError as error:
            raise SceneError(f"--store {self.path!r}: {error}") from None
        except OSError as error:
            raise SceneError(
                f"--store {self.path!r}: {error.strerror or error}; mend that, and call again: what is in it stays"
            ) from None


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:60]}…"
