"""The command line as tests use it: called, started as a process, interrupted."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest
from counted import wait_for_work

from truebreak.compare.cli import main

COMMAND = [sys.executable, "-P", "-m", "truebreak.compare.cli"]


def said(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    """Exit code, stdout and stderr."""
    with pytest.raises(SystemExit) as stop:
        main(list(words))
    return int(stop.value.code or 0), *capsys.readouterr()


def start(*words: str, before: tuple[str, ...] = ()) -> subprocess.Popen[str]:
    """The command line, at work; `before` is what it is started with, such as nohup."""
    return subprocess.Popen(
        [*before, *COMMAND, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    )


def done(*words: str) -> subprocess.CompletedProcess[str]:
    """What the command line did."""
    return subprocess.run([*COMMAND, *words], capture_output=True, text=True, check=False, timeout=120)


def interrupted(
    *words: str, after: float = 2.5, by: tuple[int, ...] = (signal.SIGINT,), before: tuple[str, ...] = ()
) -> tuple[int, str, str]:
    """Exit code, stdout and stderr of the command line, after Ctrl-C, or other signals."""
    running = start(*words, before=before)
    try:
        wait_for_work(running, after)
        assert running.poll() is None
        for number in by:
            running.send_signal(number)
        out, err = running.communicate(timeout=60)
    finally:
        running.kill()
    return running.returncode, out, err
