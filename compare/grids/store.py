"""The rows of a grid in one SQLite file: written by one process in batches, resumed by key, read by SQL."""

from __future__ import annotations

import json
import sqlite3
import time as clock
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path
from typing import Any, overload

from ...scenarios.errors import SceneError
from .row import Row

FORMAT = "truebreak/grid-store-1"

BATCH, SECONDS, SHORT = 256, 0.5, 0.05
"""Scenes, and seconds, after which what was added is written: a kill loses no more. A scene that took longer than the
last of these is written at once: the disk is not waited for at each of a thousand small ones alone."""

PATIENCE = 60.0
"""Seconds that a writer waits for those who read, and a reader for a write: all of a large store is read at once."""

COLUMNS = {
    **{key: f"json_extract(row, '$.{key}')" for key in ("engine", "verdict", "agreed", "event", "at", "predicted_low",
                                                        "predicted_high", "by_exponent", "changed", "index")},
    "audited": "json_type(row, '$.laws') IS NOT NULL",
    "kept": "json_extract(row, '$.laws.kept')",
}  # fmt: skip
"""What SQL asks for, read off the rows themselves, so that it cannot differ from them. `changed` is a JSON list."""

TABLES = f"""
CREATE TABLE IF NOT EXISTS meta (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS jobs (job INTEGER PRIMARY KEY, key TEXT NOT NULL, digest TEXT NOT NULL,
                                 seconds REAL NOT NULL, rows INTEGER NOT NULL);
CREATE TABLE IF NOT EXISTS rows (job INTEGER NOT NULL, place INTEGER NOT NULL, row TEXT NOT NULL,
    {", ".join(f'"{name}" AS ({what})' for name, what in COLUMNS.items())},
    PRIMARY KEY (job, place));
CREATE TABLE IF NOT EXISTS failures (job INTEGER NOT NULL, attempt INTEGER NOT NULL, note TEXT NOT NULL);
"""

HELD = """
SELECT rows.job, CAST(rows.job || char(10) || group_concat(row, char(10)) AS BLOB), digest
FROM rows LEFT JOIN jobs ON jobs.job = rows.job GROUP BY rows.job
"""
"""Each scene's rows as its digest is made of them, joined by SQLite: a million rows one by one take seconds more."""


class Store(Sequence[Row]):
    """An open store, a sequence of its rows, in the order of the scenes and of the engines; `:memory:` is none on disk.

    Args:
        path: the file.
        settings: what the grid asks for. A new file takes them up; one that has others is refused. None: the file
            must be there, and is only read; what a kill left half written is taken back, which is SQLite's own doing.

    Raises:
        SceneError: if the file is no store, of another version, damaged, not to be written, or of another grid.
    """

    def __init__(self, path: str = ":memory:", settings: Mapping[str, Any] | None = None) -> None:
        self.path = path
        self._waiting, self._written = 0, clock.monotonic()
        with self._told():
            self._check_place(settings)
        with self._told():
            mode = f"{Path(path).absolute().as_uri()}?mode=rw"
            name, uri = (mode, True) if settings is None else (path, False)
            self.base = sqlite3.connect(name, PATIENCE, uri=uri, check_same_thread=False)  # it may be closed in any
            if settings is None:
                self.base.execute("PRAGMA query_only = ON")
            elif not self.base.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
                with self.base:  # as nothing is in it: it is new, or a kill came before it was made
                    self.base.executescript("BEGIN IMMEDIATE;" + TABLES)  # another process may have made it meanwhile
                    text = _text(settings)
                    known = {"format": FORMAT, "settings": text, "digest": _digest(text)}
                    self.base.executemany("INSERT OR IGNORE INTO meta VALUES (?, ?)", known.items())
        self.settings = self._checked(settings)

    def _check_place(self, settings: Mapping[str, Any] | None) -> None:
        if self.path == "" and settings is not None:
            return  # a file of SQLite's own, which is gone when it is closed
        path = Path(self.path)
        fresh = self.path == ":memory:" or not path.exists() or (path.is_file() and path.stat().st_size == 0)
        if fresh and settings is None:
            there = "the file is empty" if path.exists() else "there is no such file"
            raise SceneError(f"--store {self.path!r}: {there}; give a scene to make one")
        if path.is_dir():
            raise SceneError(f"--store {self.path!r}: is a folder; name a file in it")
        if path.exists() and not path.is_file():
            raise SceneError(f"--store {self.path!r}: is no regular file; choose another")
        if not path.parent.is_dir():
            raise SceneError(f"--store {self.path!r}: there is no folder {str(path.parent)!r}; create it first")

    def _checked(self, settings: Mapping[str, Any] | None) -> dict[str, Any]:
        with self._told():
            meta = dict(self.base.execute("SELECT key, value FROM meta").fetchall())
        if meta.get("format") != FORMAT:
            version = meta.get("format", "of no version")
            raise SceneError(f"--store {self.path!r}: is {version}, and this is {FORMAT}; choose another file")
        try:
            mine = json.loads(meta["settings"]) if meta.get("digest") == _digest(meta.get("settings", "")) else None
        except (ValueError, KeyError):
            mine = None
        if not isinstance(mine, dict):
            raise self._damaged(meta.get("settings"))
        for key, value in json.loads(_text(settings or mine)).items():
            if mine.get(key) != value:
                raise SceneError(
                    f"--store {self.path!r}: holds another {settings and settings['grid']}: its {key} is "
                    f"{_short(mine.get(key))}, here it is {_short(value)}; choose another file"
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
                    f"--store {self.path!r}: is no store of a grid ({error}); choose another file"
                ) from None
            if "JSON" in str(error):
                raise self._damaged(None) from None
            full = "full" in str(error) or "I/O" in str(error)  # a limit on the length of files is told as the latter
            remedy = "make room, and call again: what is in it stays" if full else "see that it is free"
            raise SceneError(f"--store {self.path!r}: {error}; {remedy}") from None
        except (sqlite3.DatabaseError, UnicodeDecodeError) as error:
            raise SceneError(f"--store {self.path!r}: is no store of a grid, or damaged ({error}); "
                             "choose another file") from None  # fmt: skip

    def _damaged(self, text: Any) -> SceneError:
        return SceneError(f"--store {self.path!r}: is damaged: it holds {_short(text)}; choose another file")

    def done(self, key: Callable[[int], str]) -> set[int]:
        """The jobs that are there, each with all of its rows, and made for the same key as now."""
        whole = "SELECT job, key FROM jobs"
        with self._told():
            if not self.base.execute("SELECT (SELECT total(rows) FROM jobs) = (SELECT count(*) FROM rows)").fetchone()[
                0
            ]:
                whole += " WHERE rows = (SELECT count(*) FROM rows WHERE rows.job = jobs.job)"
            return {job for job, old in self.base.execute(whole) if old == key(job)}

    def add(self, job: int, key: str, rows: Iterable[Row], seconds: float) -> None:
        """A job's rows and wall time, all or nothing; on disk before long, at the latest with `keep`."""
        texts = [row.text() for row in rows]
        with self._told():
            self.base.execute("DELETE FROM rows WHERE job = ?", (job,))
            self.base.executemany(
                "INSERT INTO rows (job, place, row) VALUES (?, ?, ?)", [(job, k, text) for k, text in enumerate(texts)]
            )
            self.base.execute("INSERT OR REPLACE INTO jobs VALUES (?, ?, ?, ?, ?)",
                              (job, key, _digest(*texts, place=job), seconds, len(texts)))  # fmt: skip
        self._waiting += 1
        if seconds >= SHORT or self._waiting >= BATCH or clock.monotonic() - self._written >= SECONDS:
            self.keep()

    def keep(self) -> None:
        """Writes what was added: it is on disk when this returns."""
        with self._told():
            self.base.commit()
        self._waiting, self._written = 0, clock.monotonic()

    def fail(self, job: int, attempt: int, note: str) -> None:
        """An attempt at a scene that came to nothing, beside the rows; it stays noted when another one succeeds."""
        with self._told():
            self.base.execute("INSERT INTO failures VALUES (?, ?, ?)", (job, attempt, note))
        self.keep()

    def verify(self) -> None:
        """Refuses a file that was damaged, or changed by others: each scene's rows have a digest.

        While another process writes, all is read as it was at one time.

        Raises:
            SceneError: then.
        """
        begun = not self.base.in_transaction
        try:
            with self._told():
                if begun:
                    self.base.execute("BEGIN")
                self._verify()
        finally:
            if begun:
                with suppress(sqlite3.Error):
                    self.base.rollback()

    def _verify(self) -> None:
        (found,) = self.base.execute("PRAGMA quick_check").fetchone()
        if found != "ok":
            raise SceneError(f"--store {self.path!r}: the file is damaged ({found}); take a copy of it, or a new file")
        count = 0
        for job, text, digest in self.base.execute(HELD):
            if sha256(text).hexdigest() != digest:
                self._refuse_changed(job)
            count += 1
        (jobs,) = self.base.execute("SELECT count(*) FROM jobs WHERE rows > 0").fetchone()
        if jobs != count:
            raise self._damaged(f"{jobs} scenes, and rows of {count}")

    def _refuse_changed(self, job: int) -> None:
        """Refuses a scene whose rows, one by one in their order, are not those of its digest: `HELD` joins them in the
        order in which it finds them, which SQLite does not promise."""
        rows = [text for (text,) in self.base.execute("SELECT row FROM rows WHERE job = ? ORDER BY place", (job,))]
        kept = self.base.execute("SELECT digest FROM jobs WHERE job = ?", (job,)).fetchone()
        if kept != (_digest(*rows, place=job),):
            raise self._damaged(rows[0])

    def __len__(self) -> int:
        return self.sql("SELECT count(*) FROM rows")[0][0]

    def __iter__(self) -> Iterator[Row]:
        with self._told():
            for (text,) in self.base.execute("SELECT row FROM rows ORDER BY job, place"):
                yield self._row(text)

    @overload
    def __getitem__(self, place: int) -> Row: ...
    @overload
    def __getitem__(self, place: slice) -> list[Row]: ...
    def __getitem__(self, place: int | slice) -> Row | list[Row]:
        many = range(len(self))[place]
        asked = "SELECT row FROM rows ORDER BY job, place LIMIT ? OFFSET ?"
        if isinstance(many, int):
            return self._row(self.sql(asked, 1, many)[0][0])
        if many.step != 1:
            return [self[number] for number in many]
        return [self._row(text) for (text,) in self.sql(asked, len(many), many.start)]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and len(self) == len(other) and all(map(Row.__eq__, self, other))

    __hash__ = None  # type: ignore[assignment]

    def objects(self) -> Iterator[dict[str, Any]]:
        """Every row as its JSON object, without what is null."""
        with self._told():
            for (text,) in self.base.execute("SELECT row FROM rows ORDER BY job, place"):
                yield json.loads(text)

    def _row(self, text: str) -> Row:
        try:
            return Row(**json.loads(text))
        except (ValueError, TypeError):
            raise self._damaged(text) from None

    def sql(self, query: str, *given: Any) -> list[Any]:
        """The answer to a question on `rows`, whose columns are `COLUMNS`, `job` and `place`."""
        with self._told():
            return self.base.execute(query, given).fetchall()

    def counted(self, query: str) -> Counter[tuple[Any, ...]]:
        """How often each answer to such a question comes, in the order in which they first come."""
        with self._told():
            return Counter(self.base.execute(query))

    @property
    def scenes(self) -> int:
        """How many scenes are there."""
        return self.sql("SELECT count(*) FROM jobs WHERE rows > 0")[0][0]

    def failures(self, undone: bool = False) -> list[tuple[int, int, str]]:
        """Scene, attempt and what went wrong; those that are done by now are left out if asked for."""
        without = " WHERE job NOT IN (SELECT job FROM jobs)" if undone else ""
        return self.sql(f"SELECT job, attempt, note FROM failures{without} ORDER BY job, attempt")

    def close(self) -> None:
        """Closes the file; what was not kept by then is lost."""
        self.base.close()

    def __del__(self) -> None:
        if hasattr(self, "base"):
            self.base.close()


def merged(paths: Iterable[str]) -> Store:
    """One store, or several of one sweep, such as its shards, as one; what they hold is verified.

    Raises:
        SceneError: as `Store`, and if they are of different sweeps.
    """
    whole: Store | None = None
    for path in paths:
        store = Store(path)
        store.verify()
        mine = {key: value for key, value in store.settings.items() if key != "shard"}
        if whole is None:
            whole = store
            continue
        if {key: value for key, value in whole.settings.items() if key != "shard"} != mine:
            raise SceneError(f"--store {path!r}: is of another sweep than the one before it; give stores of one sweep")
        if whole.path:
            whole = _copied(whole)
        _copy(store, whole)
    if whole is None:
        raise SceneError("no store to read; name one")
    return whole


def _copied(store: Store) -> Store:
    """The same in a file that SQLite removes when it is closed, as large as it has to be."""
    mine = Store("", store.settings)
    _copy(store, mine)
    return mine


def _copy(store: Store, whole: Store) -> None:
    with whole._told():
        for table, columns in (("jobs", 5), ("rows (job, place, row)", 3), ("failures", 3)):
            name = table.partition(" ")[0]
            told = {"rows": "job, place, row"}.get(name, "*")
            marks = ", ".join("?" * columns)
            rows = store.base.execute(f"SELECT {told} FROM {name}")
            whole.base.executemany(f"INSERT OR REPLACE INTO {table} VALUES ({marks})", rows)
        whole.base.commit()


def _text(settings: Mapping[str, Any]) -> str:
    return json.dumps(settings, sort_keys=True)


def _digest(*texts: str, place: int | str = "") -> str:
    """Of texts and the place where they belong."""
    return sha256("\n".join(map(str, (place, *texts))).encode()).hexdigest()


def _short(value: object) -> str:
    text = json.dumps(value, default=repr)
    return text if len(text) <= 60 else f"{text[:60]}…"
