"""Files on disk: read whole, written whole or not at all, and sealed with a digest of their contents."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import secrets
import stat
from collections.abc import Callable, Generator, Iterable
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import NoneType, UnionType
from typing import (
    Annotated,
    Any,
    BinaryIO,
    Literal,
    NotRequired,
    Union,
    cast,
    get_args,
    get_origin,
    get_type_hints,
    is_typeddict,
)
from weakref import WeakValueDictionary

from .errors import SceneError, cut
from .lazy import VERSION

# -- Files on disk: what a user names is read whole; what is written is there whole or not at all, whoever is killed.

try:
    import fcntl
except ImportError:  # Windows, where nobody can remove a file that another process has open
    fcntl = None

UNFINISHED = re.compile(r"\.truebreak-[0-9a-f]{16}\.part")
"""The name of a file while it is written, beside its place."""


def text_of(
    where: str, limit: int | None = None, remedy: str = "give the path of a file", *, strict: bool = True
) -> str:
    """The text of a regular file.

    Args:
        where: its path, as errors name it.
        limit: its most bytes; None: as many as there are.
        remedy: what to do instead of naming a folder or a pipe.
        strict: whether bytes that are not UTF-8 are refused; else they come to be marks that fit nowhere.

    Raises:
        SceneError: one line that says what is wrong with it.
    """
    path = Path(where)
    try:
        about = path.stat()
        regular = stat.S_ISREG(about.st_mode)
        small = limit is None or about.st_size <= limit
        raw = path.read_bytes() if regular and small else b""
    except FileNotFoundError:
        raise SceneError(f"{where}: no such file; check the path") from None
    except OSError as error:
        raise SceneError(f"{where}: cannot be read: {error.strerror or error}") from None
    except ValueError as error:  # a zero byte in the path
        raise SceneError(f"{where!r}: cannot be read: {error}") from None
    if not regular:
        what = "a directory" if stat.S_ISDIR(about.st_mode) else "not a regular file"
        raise SceneError(f"{where}: is {what}; {remedy}")
    if not small:
        raise SceneError(f"{where}: has {about.st_size} bytes; at most {limit} for {path.suffix.lower()}")
    try:
        return raw.decode("utf-8-sig", errors="strict" if strict else "replace")
    except UnicodeDecodeError as error:
        raise SceneError(f"{where}: is not UTF-8 text (at byte {error.start}); save it as UTF-8") from None


def write_file(target: Path, data: bytes | Iterable[bytes], *, lasting: bool = True) -> None:
    """Writes a file beside its place, then moves it there: at no time is there half of one.

    What other processes that were killed have left beside it is removed first; what one that is alive is writing stays.

    Args:
        data: all of it, or one part after the other.
        lasting: whether it is to be there after a power cut too, once this returns; it takes some milliseconds.

    Raises:
        OSError: if it cannot be written; what was there before stays.
    """
    folder = target.parent
    clear(folder)
    with _beside(folder) as (file, name):
        file.writelines([data] if isinstance(data, bytes) else data)
        file.flush()
        if lasting:
            os.fsync(file.fileno())
        if fcntl is None:
            file.close()  # there only what is closed can be moved
        name.replace(target)
    if lasting:
        _sync_folder(folder)


def clear(folder: Path) -> None:
    """Removes unfinished files whose writers have died, however that was, and whatever the clock says."""
    try:
        left = [entry.name for entry in os.scandir(folder) if UNFINISHED.fullmatch(entry.name)]
    except OSError:
        return
    for name in left:
        with contextlib.suppress(OSError):
            _clear(folder / name)


def _clear(path: Path) -> None:
    """Removes one: its writer has it locked for as long as it lives, and the system takes the lock when it dies."""
    if fcntl is None:
        path.unlink()
        return
    descriptor = os.open(path, os.O_RDWR)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        path.unlink()
    finally:
        os.close(descriptor)


@contextmanager
def _beside(folder: Path) -> Generator[tuple[BinaryIO, Path]]:
    """A new file that is locked, open for writing; whatever happens, nothing of that name is left."""
    while True:
        name = folder / f".truebreak-{secrets.token_hex(8)}.part"
        file = name.open("xb")
        try:
            if fcntl is not None:
                with contextlib.suppress(OSError):  # a file system without locks: then nobody else gets one either
                    fcntl.flock(file, fcntl.LOCK_EX)
                if os.fstat(file.fileno()).st_nlink == 0:  # cleared by another between these two lines
                    continue
            yield file, name
            return
        finally:
            with contextlib.suppress(OSError):
                file.close()
            with contextlib.suppress(OSError):
                name.unlink()


_HELD: WeakValueDictionary[tuple[int, int], BinaryIO] = WeakValueDictionary()
"""What this process holds, which it may hold more than once: where an error is looked at, what raised it lives on."""


def held(path: Path) -> BinaryIO | None:
    """A file, open and locked for as long as it is open and this process lives; None if another process has it so.

    Raises:
        OSError: if it cannot be opened.
    """
    file = path.open("r+b")
    about = os.fstat(file.fileno())
    mine = _HELD.get((about.st_dev, about.st_ino))
    if mine is not None:
        file.close()
        return mine
    if fcntl is not None:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.close()
            return None
        except OSError:  # a file system without locks
            pass
    _HELD[about.st_dev, about.st_ino] = file
    return file


class Lines:
    """A file of lines to which whole ones are added, by one process at a time.

    Only its end may be missing, in the middle of a line: that is what a kill or a full disk leaves. It stays until the
    next line takes its place, since the file may be somebody else's.

    Args:
        path: the file, which is made if it is not there.

    Attributes:
        whole: the lines that are there, without their ends.
        rest: what comes after the last of them.

    Raises:
        BlockingIOError: if another process has it.
        OSError: if it cannot be opened.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        path.touch()
        self._held = held(path)
        if self._held is None:
            raise BlockingIOError("another process writes there; let it end, or choose another file")
        *self.whole, self.rest = path.read_bytes().split(b"\n")
        self._size = sum(len(line) + 1 for line in self.whole)

    def add(self, line: bytes) -> None:
        """Adds a line, which ends with its end: on disk when this returns.

        Raises:
            OSError: if it cannot be written; what was there stays, and nothing of the line.
        """
        with self._path.open("r+b", buffering=0) as file:
            try:
                file.seek(self._size)
                left = memoryview(line)
                while left:
                    left = left[file.write(left) :]
                file.truncate()
                os.fsync(file.fileno())
            except BaseException:
                with contextlib.suppress(OSError):
                    file.truncate(self._size)
                raise
        self._size += len(line)


def _sync_folder(folder: Path) -> None:
    """Has the move itself on disk; not every system lets a folder be opened for that."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


# -- Files with a digest of their contents, by which damage is seen: what saved runs and comparisons have in common.


@dataclass(frozen=True)
class Seal:
    """One kind of saved file: a JSON object with its schema, the version that wrote it, and a digest of the rest.

    Attributes:
        schema: its name and number.
        kind: what is saved, in one word.
        command: what writes such a file.

    >>> seal = Seal("truebreak/run-1", "run", "truebreak run SCENE --save FILE")
    >>> data = seal.sealed({"roots": []})
    >>> seal.opened(json.dumps(data), "here")["roots"]
    []
    """

    schema: str
    kind: str
    command: str

    def sealed(self, data: dict[str, Any]) -> dict[str, Any]:
        """Contents with schema, version and digest."""
        whole = {"schema": self.schema, "version": VERSION, **data}
        return {**whole, "digest": digest(whole)}

    def opened(self, text: str, where: str) -> dict[str, Any]:
        """The contents of a file, checked; `where` names it in errors.

        Raises:
            SceneError: for what is none of these, is damaged or is of another version.
        """
        try:
            told: Any = json.loads(text)
        except (ValueError, RecursionError):
            told = None
            if text[:99].replace(" ", "").startswith(f'{{"schema":"{self.schema}"'):
                raise self.damaged(where) from None
        contents = cast("dict[str, Any]", told) if isinstance(told, dict) else {}
        if contents.get("schema") != self.schema:
            raise SceneError(f"{where}: is not a saved {self.kind}; write one with `{self.command}`")
        if contents.get("version") != VERSION:
            raise SceneError(
                f"{where}: was saved by truebreak {cut(contents.get('version'))}, and this is {VERSION}; "
                f"save the {self.kind} again, or install that version"
            )
        if contents.pop("digest", None) != digest(contents):
            raise self.damaged(where)
        return contents

    def damaged(self, where: str) -> SceneError:
        """What is said of a file whose contents are not what was written."""
        return SceneError(f"{where}: is damaged; save the {self.kind} again")


class InSchema:
    """In `Annotated`: what the JSON schema says of a type besides; with a name it stands there once, as a definition.

    Args:
        has_reader: what reads it refuses what is none, and `fits` does not look at it.
    """

    def __init__(self, name: str | None = None, *, has_reader: bool = False, **words: Any) -> None:
        self.name, self.has_reader, self.words = name, has_reader, words


def fits(value: Any, hint: Any) -> bool:
    """Whether what was read as JSON is of a type.

    Args:
        hint: `int` (a truth value is none), `float` (a whole number is one), `str`, `bool`, `None`, `Any`, lists,
            tuples (just these items), `dict[str, ...]`, unions, `Literal`, a `TypedDict`; of `Annotated` the type.

    >>> fits([1, ["a", None]], tuple[int, list[str | None]]), fits({"n": True}, dict[str, int])
    (True, False)
    """
    return _test_of(hint)(value)


@cache
def _test_of(hint: Any) -> Callable[[Any], bool]:
    origin, parts = get_origin(hint), get_args(hint)
    if hint is Any:
        return lambda value: True
    if hint in (None, NoneType):
        return lambda value: value is None
    if hint is float:
        return lambda value: type(value) in (int, float)
    if origin in (Annotated, NotRequired):
        return _test_of(Any if isinstance(parts[-1], InSchema) and parts[-1].has_reader else parts[0])
    if origin is Literal:
        return lambda value: value in parts and any(value == part and type(value) is type(part) for part in parts)
    if origin in (Union, UnionType):
        tests = [_test_of(part) for part in parts]
        return lambda value: any(test(value) for test in tests)
    if origin is list:
        item = _test_of(parts[0])
        return lambda value: type(value) is list and all(map(item, cast("list[Any]", value)))
    if origin is tuple:
        tests = [_test_of(part) for part in parts]
        return lambda value: (
            type(value) is list
            and len(cast("list[Any]", value)) == len(tests)
            and all(test(item) for test, item in zip(tests, cast("list[Any]", value), strict=True))
        )
    if origin is dict:
        item = _test_of(parts[1])
        return lambda value: type(value) is dict and all(map(item, cast("dict[str, Any]", value).values()))
    if is_typeddict(hint):
        hints = get_type_hints(hint, include_extras=True)
        keys = {key: _test_of(part) for key, part in hints.items()}
        needed = {key for key, part in hints.items() if hint.__total__ and get_origin(part) is not NotRequired}
        return lambda value: (
            type(value) is dict
            and needed <= (told := cast("dict[str, Any]", value)).keys() <= keys.keys()
            and all(keys[key](item) for key, item in told.items())
        )
    return lambda value: type(value) is hint


def digest(data: dict[str, Any]) -> str:
    """SHA-256 of contents, in hexadecimal."""
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()
