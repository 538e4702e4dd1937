"""Logs a live pymunk space of any content, step by step, for `truebreak diff`."""

from __future__ import annotations

import json
from binascii import b2a_base64
from collections.abc import Callable
from functools import partial
from pathlib import Path
from struct import calcsize
from types import TracebackType
from typing import IO, TYPE_CHECKING, Any
from zlib import crc32

from .log_format import FORMAT

if TYPE_CHECKING:
    import pymunk

FIELDS = ("x", "y", "angle", "vx", "vy", "spin")
"""The numbers of a state, as pymunk's batch functions give them."""

EVERY = 64
"""Steps from one record of all states to the next."""


PAIR = 2 * calcsize("N")
"""Bytes of the two ids of a contact."""


class PymunkRecording:
    """A space that is being logged; see `record`."""

    def __init__(self, space: pymunk.Space, file: str | Path, every: int, name: Callable[[Any], str] | None) -> None:
        if every < 1:
            from ..validation import EngineError

            raise EngineError(f"every = {every}: must be a whole number from 1")
        from pymunk import batch

        self._space, self._path, self._every, self._name = space, Path(file), every, name
        self._read = _Readings(space, batch)
        self._names: dict[int, str] = {}
        self._order: list[int] = []
        self._between = 1
        self._number, self._time, self._count = 0, 0.0, 0
        self._before: bytes = b""
        self._pairs: set[bytes] = set()
        self._input: Any = None
        self._file: IO[str] | None = None
        self._step: Callable[[float], None] | None = None

    def input(self, value: Any) -> None:
        """Logs what is fed in before the next step: anything that JSON can hold."""
        self._input = value

    def __enter__(self) -> PymunkRecording:
        import pymunk

        self._file = self._path.open("w", encoding="utf-8", buffering=1 << 16)
        header = {
            "log": FORMAT, "engine": f"pymunk {pymunk.version}", "bits": 53, "fields": FIELDS, "contacts": "begun",
            "iterations": self._space.iterations, "gravity": list(self._space.gravity),
        }  # fmt: skip
        self._write(header)
        if self._every > 1:  # pymunk keeps a contact for so many steps: none is missed
            self._between = max(1, min(self._space.collision_persistence, self._every))
        self._meet_bodies()
        self._take(0.0, start=True)
        self._step = self._space.step
        self._space.step = self._stepped  # pyright: ignore[reportAttributeAccessIssue]
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        del self._space.step  # the class's own again
        assert self._file is not None
        try:
            self._write({"end": self._time})
        finally:
            self._file.close()

    def _stepped(self, dt: float) -> None:
        assert self._step is not None
        self._step(dt)
        self._take(dt)

    def _take(self, dt: float, start: bool = False) -> None:
        """Writes the line of the step just made."""
        if not start:
            self._number += 1
            self._time += dt
            if self._number % self._between and self._input is None:
                return
        numbers = self._read.numbers()
        line = f'{{"step": {self._number}, "time": {self._time!r}, "hash": "{crc32(numbers):08x}"'
        if self._input is not None:
            line += f', "input": {json.dumps(self._input)}'
            self._input = None
        count = len(numbers)
        whole = self._number % self._every == 0 or count != self._count  # and where bodies were added or removed
        self._count = count
        pairs = self._read.pairs()
        if pairs != self._before:
            contacts = self._begun(pairs)
            whole = whole or bool(contacts)
            line += contacts
        if whole:
            self._meet(self._read.ids())
            line += f', "packed": "{b2a_base64(numbers, newline=False).decode()}"'
        assert self._file is not None
        self._file.write(line + "}\n")

    def _begun(self, pairs: bytes) -> str:
        """The contacts that there were none of before."""
        self._before = pairs
        now = {pairs[k : k + PAIR] for k in range(0, len(pairs), PAIR)}  # bytes: what no collector looks through
        before, self._pairs = self._pairs, now
        begun = [key for key in now - before if key[PAIR // 2 :] + key[: PAIR // 2] not in before]
        if not begun:
            return ""
        self._meet(self._read.ids())
        named = [sorted(self._names.get(i, "static") for i in memoryview(key).cast("N").tolist()) for key in begun]  # pyright: ignore[reportCallIssue, reportArgumentType]
        return f', "contacts": {json.dumps(sorted(named))}'

    def _meet(self, ids: list[int]) -> None:
        """Logs in which order bodies are packed, where that is another than before."""
        if ids != self._order:
            if any(i not in self._names for i in ids):
                self._meet_bodies()
            self._order = ids
            self._write({"order": [self._names[i] for i in ids]})

    def _meet_bodies(self) -> None:
        """Names bodies that are new, in the order in which they were added, and logs their shapes once."""
        for body in self._space.bodies:
            if body.id not in self._names:
                numbered = len(self._names) - (self._space.static_body.id in self._names)
                name = self._name(body) if self._name else f"body{numbered}"
                self._names[body.id] = name
                self._write({"body": name, "outline": [_outline(shape) for shape in body.shapes]})
        static = self._space.static_body
        if static.id not in self._names:
            self._names[static.id] = "static"
            if static.shapes:
                self._write({"body": "static", "outline": [_outline(shape) for shape in static.shapes]})

    def _write(self, value: dict[str, Any]) -> None:
        assert self._file is not None
        self._file.write(json.dumps(value) + "\n")


class _Readings:
    """What pymunk reads in one go of all bodies, and of all arbiters, of a space.

    Its own functions for that make the same few objects at each call; what they are made of is kept here.
    """

    def __init__(self, space: pymunk.Space, batch: Any) -> None:
        self._states, self._arbiters = batch.Buffer(), batch.Buffer()
        f, g = batch.BodyFields, batch.ArbiterFields
        fields = f.BODY_ID | f.POSITION | f.ANGLE | f.VELOCITY | f.ANGULAR_VELOCITY
        pair = g.BODY_A_ID | g.BODY_B_ID
        self._bodies: Callable[[], object] = partial(batch.get_space_bodies, space, fields, self._states)
        self._contacts: Callable[[], object] = partial(batch.get_space_arbiters, space, pair, self._arbiters)
        try:
            ffi, lib = batch.ffi, batch.lib
            made = [ffi.new("pmBatchedData *") for _ in range(2)]
            for data, buffer, flags in zip(made, (self._states, self._arbiters), (fields, pair), strict=True):
                data.fields, data.floatArray, data.intArray = flags.value, buffer._float_arr, buffer._int_arr
            where = space._space  # pyright: ignore[reportPrivateUsage]
            reading = ffi.addressof(lib, "pmSpaceBodyGetIteratorFuncBatched")
            pairing = ffi.addressof(lib, "pmSpaceArbiterIteratorFuncBatched")
            self._bodies = partial(lib.cpSpaceEachBody, where, reading, made[0])
            self._contacts = partial(lib.cpSpaceEachCachedArbiter, where, pairing, made[1])
        except (AttributeError, TypeError):
            pass  # a pymunk that is made otherwise: its own functions do the same

    def numbers(self) -> memoryview:
        """The numbers of all bodies, as bytes."""
        self._states.clear()
        self._bodies()
        return memoryview(self._states.float_buf())

    def ids(self) -> list[int]:
        """Whose they are."""
        return memoryview(self._states.int_buf()).cast("N").tolist()  # pyright: ignore[reportCallIssue, reportArgumentType]

    def pairs(self) -> bytes:
        """The ids of pairs of bodies in contact."""
        self._arbiters.clear()
        self._contacts()
        return bytes(self._arbiters.int_buf())


def record(
    space: pymunk.Space, file: str | Path, *, every: int = EVERY, name: Callable[[Any], str] | None = None
) -> PymunkRecording:
    """Logs every step of a space, whatever is in it, while the context lasts.

    Every third step, as long as pymunk keeps a contact, is a line with a hash of all states, to the last bit; where
    contacts begin, with these and the states of all bodies; and every so many steps, and where bodies come or go, with
    the states of all. Steps with an input are lines, too. Shapes are logged once.

    Args:
        every: steps from one record of all states to the next; 1 writes a line for each step (docs/desync.md has the
            costs).
        name: gives a body its id; by default the order in which bodies were added.

    Raises:
        EngineError: for an `every` below 1.
        OSError: where the file cannot be written.

    >>> import pathlib, pymunk, tempfile
    >>> space = pymunk.Space()
    >>> body = pymunk.Body(1, 1)
    >>> space.add(body, pymunk.Circle(body, 1))
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "run.jsonl"
    >>> with record(space, file) as log:
    ...     for _ in range(3):
    ...         space.step(0.25)
    >>> len(file.read_text().splitlines())  # header, shape, order, start, a step, end
    6
    """
    return PymunkRecording(space, file, every, name)


def _outline(shape: Any) -> dict[str, Any]:
    """A shape in its body's own frame."""
    import pymunk

    if isinstance(shape, pymunk.Circle):
        return {"circle": shape.radius, "at": list(shape.offset)}
    if isinstance(shape, pymunk.Segment):
        return {"segment": [list(shape.a), list(shape.b)], "radius": shape.radius}
    return {"polygon": [list(v) for v in shape.get_vertices()], "radius": shape.radius}
