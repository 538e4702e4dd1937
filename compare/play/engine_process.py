"""The engines in a process of their own, which can be ended at any moment.

    python -m truebreak.compare.play.engine_process

A message is a line of JSON on its standard input, and each answer one on its standard output.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from typing import Any

from .messages import answer

GRACE = 2.0
"""Seconds by which an answer may be late; then the process is ended, wherever it is."""


class EngineProcess:
    """A process that answers messages, one at a time; a new one after one that was ended."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._lock = threading.Lock()

    def ask(self, message: dict[str, Any], seconds: float) -> Iterator[dict[str, Any]]:
        """The answers to a message, as they come; the last is `stopped` where the process was ended before.

        Args:
            seconds: after which it is ended, and `GRACE` more.
        """
        process = self._started()
        assert process.stdin is not None and process.stdout is not None
        late = threading.Timer(seconds + GRACE, self.stop)
        late.daemon = True
        late.start()
        try:
            process.stdin.write(json.dumps(message).encode() + b"\n")
            process.stdin.flush()
            while line := process.stdout.readline():
                found: dict[str, Any] = json.loads(line)
                yield found
                if found["kind"] != "progress":
                    return
            yield {"kind": "stopped", "error": "the run was stopped"}
        except (BrokenPipeError, ValueError):  # it was ended while it was written to, or half-way through a line
            yield {"kind": "stopped", "error": "the run was stopped"}
        finally:
            late.cancel()

    def stop(self) -> None:
        """Ends the process, and what it is at."""
        with self._lock:
            process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.wait()

    def _started(self) -> subprocess.Popen[bytes]:
        with self._lock:
            if self._process is None or self._process.poll() is not None:
                module = f"{__package__}.engine_process"
                self._process = subprocess.Popen(
                    [sys.executable, "-m", module], stdin=subprocess.PIPE, stdout=subprocess.PIPE
                )
            return self._process


def main() -> None:
    """Answers until there is nothing more to read; Ctrl-C is for whoever started this process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    told = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what a library prints is no answer

    def say(found: dict[str, Any]) -> None:
        told.write(json.dumps(found, allow_nan=False) + "\n")
        told.flush()

    for line in sys.stdin:
        answer(json.loads(line), say)


if __name__ == "__main__":
    main()
