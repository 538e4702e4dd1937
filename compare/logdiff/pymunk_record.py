"""Logs a live pymunk space of any content, step by step, for `truebreak diff`."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import IO, TYPE_CHECKING, Any
from zlib import crc32

import numpy as np

from .log_format import FORMAT

if TYPE_CHECKING:
    import pymunk

FIELDS = ("x", "y", "angle", "vx", "vy", "spin")
"""The numbers of a state, as pymunk's batch functions give them."""

EVERY = 64
"""Steps from one record of all states to the next: reading them into text costs as much as some ten steps."""


class PymunkRecording:
    """A space that is being logged; see `record`."""

    def __init__(self, space: pymunk.Space, file: str | Path, every: int, name: Callable[[Any], str] | None) -> None:
        if every < 1:
            from ..validation import EngineError

            raise EngineError(f"every = {every}: must be a whole number from 1")
        from pymunk import batch

        self._space, self._path, self._every, self._name = space, Path(file), every, name
        self._batch: Any = batch
        self._states, self._arbiters = batch.Buffer(), batch.Buffer()
        f, g = batch.BodyFields, batch.ArbiterFields
        self._body_fields = f.BODY_ID | f.POSITION | f.ANGLE | f.VELOCITY | f.ANGULAR_VELOCITY
        self._arbiter_fields = g.BODY_A_ID | g.BODY_B_ID
        self._names: dict[int, str] = {}
        self._number, self._time, self._count = 0, 0.0, 0
        self._before: bytes = b""
        self._pairs: set[tuple[int, int]] = set()
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
        batch, states, arbiters = self._batch, self._states, self._arbiters
        states.clear()
        batch.get_space_bodies(self._space, self._body_fields, states)
        arbiters.clear()
        batch.get_space_arbiters(self._space, self._arbiter_fields, arbiters)
        if not start:
            self._number += 1
            self._time += dt
        numbers = states.float_buf()
        line = f'{{"step": {self._number}, "time": {self._time!r}, "hash": "{crc32(numbers):08x}"'
        if self._input is not None:
            line += f', "input": {json.dumps(self._input)}'
            self._input = None
        count = len(states.int_buf())
        whole = self._number % self._every == 0 or count != self._count  # and where bodies were added or removed
        self._count = count
        touched: list[int] = []
        pairs = bytes(arbiters.int_buf())
        if pairs != self._before:
            line += self._begun(pairs, touched)
        if whole or touched:
            line += self._rows(numbers, None if whole else touched)
        assert self._file is not None
        self._file.write(line + "}\n")

    def _begun(self, pairs: bytes, touched: list[int]) -> str:
        """The contacts that there were none of in the step before; their bodies are added to `touched`."""
        self._before = pairs
        ids = np.frombuffer(pairs, np.uintp).tolist()
        now = {(a, b) if a < b else (b, a) for a, b in zip(ids[::2], ids[1::2], strict=True)}
        begun = now - self._pairs
        self._pairs = now  # those of the last few steps, as pymunk keeps them
        if not begun:
            return ""
        touched.extend(sorted({i for pair in begun for i in pair}))
        names = self._names
        if any(i not in names for i in touched):
            self._meet_bodies()
        pairs_of_names = sorted(sorted((names.get(a, "static"), names.get(b, "static"))) for a, b in begun)
        return f', "contacts": {json.dumps(pairs_of_names)}'

    def _rows(self, numbers: Any, touched: list[int] | None) -> str:
        """States of some bodies, or of all."""
        ids = np.frombuffer(self._states.int_buf(), np.uintp).tolist()
        if any(i not in self._names for i in ids):
            self._meet_bodies()
        rows = np.frombuffer(numbers).reshape(-1, len(FIELDS))
        places = range(len(ids))
        if touched is not None:
            wanted = set(touched)
            places = [k for k, i in enumerate(ids) if i in wanted]
        return f', "states": {json.dumps({self._names[ids[k]]: rows[k].tolist() for k in places})}'

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


def record(
    space: pymunk.Space, file: str | Path, *, every: int = EVERY, name: Callable[[Any], str] | None = None
) -> PymunkRecording:
    """Logs every step of a space, whatever is in it, while the context lasts.

    Each step is a line with a hash of all states, to the last bit; with the contacts that begin in it, and the states
    of their bodies; and every so many steps, and where bodies come or go, with the states of all. Shapes are logged
    once.

    Args:
        every: steps from one record of all states to the next. 1 costs some ten times as much as stepping.
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
    >>> len(file.read_text().splitlines())  # header, shape, start, three steps, end
    7
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
