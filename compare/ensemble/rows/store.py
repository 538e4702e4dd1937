"""The rows of a sweep in one SQLite file, written by one process, a scene as soon as it is there."""

from __future__ import annotations

import json
import sqlite3
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any

from ....scenarios.errors import SceneError
from .row import COLUMNS, SweepRow, text_of

FORMAT = "truebreak/sweep-store-3"

SETTINGS = ("scene", "vary", "engines", "events", "outcomes", "causes", "work", "shard", "audit")
"""What a sweep asks for, as a store keeps it: see `Sweep.settings`."""

TABLES = """
CREATE TABLE IF NOT EXISTS meta (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS rows (scene INTEGER NOT NULL, engine INTEGER NOT NULL, row TEXT NOT NULL,
                                 digest TEXT NOT NULL, PRIMARY KEY (scene, engine));
CREATE TABLE IF NOT EXISTS times (scene INTEGER PRIMARY KEY, seconds REAL NOT NULL);
CREATE TABLE IF NOT EXISTS failures (scene INTEGER NOT NULL, attempt INTEGER NOT NULL, note TEXT NOT NULL);
"""


class Store:
    """An open store; `:memory:` keeps it in memory.

    Args:
        path: the file.
        settings: what the sweep asks for. A new file takes them up; one that has others is refused. None: the file
            must be there, and is only read; what a kill left half written is taken back, which is SQLite's own doing.

    Raises:
        SceneError: if the file is no store, of another version, damaged, not to be written, or of another sweep.
    """

    def __init__(self, path: str, settings: Mapping[str, Any] | None) -> None:
        self.path = path
        with self._told():
            self._check_place(settings)
        with self._told():
            self.base = sqlite3.connect(path if settings is not None else f"{Path(path).absolute().as_uri()}?mode=rw",
                                        uri=settings is None)  # fmt: skip
            if settings is None:
                self.base.execute("PRAGMA query_only = ON")
            if settings is not None and not self.base.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
                with self.base:  # as nothing is in it: it is new, or a kill came before it was made
                    self.base.executescript("BEGIN IMMEDIATE;" + TABLES)  # another process may have made it meanwhile
                    text = _text(settings)
                    known = {"format": FORMAT, "settings": text, "digest": _digest(text)}
                    self.base.executemany("INSERT OR IGNORE INTO meta VALUES (?, ?)", known.items())
        self.settings = self._checked(settings)

    def _check_place(self, settings: Mapping[str, Any] | None) -> None:
        path = Path(self.path)
        fresh = self.path == ":memory:" or not path.exists() or path.stat().st_size == 0
        if fresh and settings is None:
            there = "the file is empty" if path.exists() else "there is no such file"
            raise SceneError(f"--store {self.path!r}: {there}; give a scene to make one")
        if path.is_dir():
            raise SceneError(f"--store {self.path!r}: is a folder; name a file in it")
        if not path.parent.is_dir():
            raise SceneError(f"--store {self.path!r}: there is no folder {str(path.parent)!r}; create it first")

    def _checked(self, settings: Mapping[str, Any] | None) -> dict[str, Any]:
        with self._told():
            meta = dict(self.base.execute("SELECT key, value FROM meta").fetchall())
            (found,) = self.base.execute("PRAGMA quick_check").fetchone()
        if found != "ok":
            raise SceneError(f"--store {self.path!r}: the file is damaged ({found}); take a copy of it, or a new file")
        if meta.get("format") != FORMAT:
            told = meta.get("format", "of no version")
            raise SceneError(f"--store {self.path!r}: is {told}, and this is {FORMAT}; choose another file")
        mine = self._kept(meta.get("settings", ""), meta.get("digest"), SETTINGS)
        for key, value in json.loads(_text(settings or mine)).items():
            if mine.get(key) != value:
                raise SceneError(
                    f"--store {self.path!r}: holds another sweep: its {key} is {_short(mine.get(key))}, here it is "
                    f"{_short(value)}; choose another file"
                )
        return mine

    @contextmanager
    def _told(self) -> Iterator[None]:
        """Turns errors of SQLite and of the file system into one line."""
        try:
            yield
        except OSError as error:
            raise SceneError(f"--store {self.path!r}: {error.strerror or error}; choose another file") from None
        except sqlite3.OperationalError as error:
            if "no such" in str(error):
                raise SceneError(
                    f"--store {self.path!r}: is no store of a sweep ({error}); choose another file"
                ) from None
            full = "full" in str(error) or "I/O" in str(error)  # a limit on the length of files is told as the latter
            remedy = "make room, and call again: what is in it stays" if full else "see that it is free"
            raise SceneError(f"--store {self.path!r}: {error}; {remedy}") from None
        except (sqlite3.DatabaseError, UnicodeDecodeError) as error:
            raise SceneError(f"--store {self.path!r}: is no store of a sweep, or damaged ({error}); "
                             "choose another file") from None  # fmt: skip

    def _kept(self, text: str, digest: str | None, keys: Iterable[str], *place: int) -> dict[str, Any]:
        """What was written as JSON; SQLite does not see it if some of its letters are others now, the digest does."""
        try:
            told = json.loads(text) if digest == _digest(text, *place) else None
        except ValueError:
            told = None
        if not isinstance(told, dict) or not set(keys) <= set(told):
            raise SceneError(f"--store {self.path!r}: is damaged: it holds {_short(text)}; choose another file")
        return told

    def done(self) -> set[int]:
        """The scenes that are there, each with all of its rows."""
        there = Counter(scene for scene, _, _ in self._read())
        return {scene for scene, count in there.items() if count == len(self.settings["engines"])}

    def add(self, scene: int, rows: Iterable[SweepRow], seconds: float) -> None:
        """A scene's rows and wall time, all or nothing: on disk when this returns."""
        with self._told(), self.base:
            told = [(scene, engine, text, _digest(text, scene, engine))
                    for engine, text in enumerate(map(text_of, rows))]  # fmt: skip
            self.base.executemany("INSERT OR REPLACE INTO rows VALUES (?, ?, ?, ?)", told)
            self.base.execute("INSERT OR REPLACE INTO times VALUES (?, ?)", (scene, seconds))

    def fail(self, scene: int, attempt: int, note: str) -> None:
        """An attempt at a scene that came to nothing, beside the table; it stays noted when another one succeeds."""
        with self._told(), self.base:
            self.base.execute("INSERT INTO failures VALUES (?, ?, ?)", (scene, attempt, note))

    def rows(self) -> Iterator[SweepRow]:
        """Every row, in the order of the scenes and of the engines."""
        return (row for _, _, row in self._read())

    def _read(self) -> Iterator[tuple[int, int, SweepRow]]:
        with self._told():
            for scene, engine, text, digest in self.base.execute("SELECT * FROM rows ORDER BY scene, engine"):
                yield scene, engine, self._kept(text, digest, COLUMNS, scene, engine)

    def failures(self) -> list[tuple[int, int, str]]:
        """Scene, attempt and what went wrong, of scenes that are done by now too."""
        with self._told():
            return self.base.execute("SELECT scene, attempt, note FROM failures ORDER BY scene, attempt").fetchall()

    def close(self) -> None:
        """Closes the file."""
        self.base.close()


def merged(paths: Iterable[str]) -> tuple[list[SweepRow], dict[str, Any], list[tuple[int, int, str]]]:
    """The rows of several stores of one sweep, such as its shards, what the sweep asked for, and the failures.

    Raises:
        SceneError: as `Store`, and if they are of different sweeps.
    """
    found: dict[tuple[int, int], SweepRow] = {}
    settings: dict[str, Any] | None = None
    failures: list[tuple[int, int, str]] = []
    for path in paths:
        store = Store(path, None)
        mine = {key: value for key, value in store.settings.items() if key != "shard"}
        if settings is not None and mine != settings:
            raise SceneError(f"--store {path!r}: is of another sweep than the one before it; give stores of one sweep")
        settings = mine
        count = len(mine["engines"])
        for number, row in enumerate(store.rows()):
            found[row["index"], number % count] = row
        failures += store.failures()
        store.close()
    return [found[key] for key in sorted(found)], settings or {}, failures


def _text(settings: Mapping[str, Any]) -> str:
    return json.dumps(settings, sort_keys=True)


def _digest(text: str, *place: int) -> str:
    """Of a text and the place where it belongs."""
    return sha256("\n".join(map(str, [*place, text])).encode()).hexdigest()


def _short(value: object) -> str:
    text = json.dumps(value, default=repr)
    return text if len(text) <= 60 else f"{text[:60]}…"
