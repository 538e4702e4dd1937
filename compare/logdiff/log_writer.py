"""Writes the log of a run: JSON lines, format truebreak/log-1; for engines in Python."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import IO, Any

from .log_format import FORMAT


class LogWriter:
    """A log that is being written; a context manager.

    Args:
        engine: what is said of the engine; compared, and told where it differs.
        fields: names of the numbers of a state.
        bits: of the engine's numbers: 24 for floats, 53 for doubles.
        settings: anything else for the header, such as a time step.

    >>> import pathlib, tempfile
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "run.jsonl"
    >>> with LogWriter(file, "mine 1.0", ["x", "v"]) as log:
    ...     log.step(0, 0.0, states={"ball": [1.0, 0.0]})
    ...     log.step(1, 0.5, contacts=[("ball", "floor")], states={"ball": [0.9, -0.5]}, energy=0.125)
    >>> print(file.read_text().splitlines()[2])
    {"step": 1, "time": 0.5, "contacts": [["ball", "floor"]], "states": {"ball": [0.9, -0.5]}, "energy": 0.125}
    """

    def __init__(
        self, path: str | Path, engine: str = "", fields: Sequence[str] | None = None, bits: int = 53, **settings: Any
    ) -> None:
        self._file: IO[str] = Path(path).open("w", encoding="utf-8")  # noqa: SIM115
        header: dict[str, Any] = {"log": FORMAT, "engine": engine, "bits": bits}
        if fields is not None:
            header["fields"] = list(fields)
        self._write({**header, **settings})

    def outline(self, body: str, outline: Any) -> None:
        """Logs the shape of a body: a list of circles, polygons and segments (see docs/log-format.md)."""
        self._write({"body": body, "outline": outline})

    def step(
        self, step: int | None, time: float | None = None, *, contacts: Iterable[tuple[str, str]] = (),
        states: Mapping[str, Sequence[float]] | None = None, hash: str | None = None, input: Any = None, **fields: Any,
    ) -> None:  # fmt: skip
        """Logs one step or event: pairs in contact, states by body, a hash, what was fed in, and free fields."""
        line: dict[str, Any] = {}
        pairs = [list(pair) for pair in contacts]
        parts = {"step": step, "time": time, "contacts": pairs or None, "hash": hash, "input": input}
        line.update({key: value for key, value in parts.items() if value is not None})
        if states:
            line["states"] = {body: [float(v) for v in row] for body, row in states.items()}
        self._write({**line, **fields})

    def _write(self, line: Mapping[str, Any]) -> None:
        self._file.write(json.dumps(line) + "\n")

    def close(self) -> None:
        """Finishes the file."""
        self._file.close()

    def __enter__(self) -> LogWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
