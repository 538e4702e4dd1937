"""How much Python does, counted in calls, or in processor time: seconds of the clock tell of other work too."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path


def calls(run: Callable[[], object]) -> int:
    """How many functions are called, Python's own in C among them."""
    count = 0

    def note(frame: object, event: str, argument: object) -> None:
        nonlocal count
        count += event in ("call", "c_call")

    saved = sys.getprofile()
    sys.setprofile(note)
    try:
        run()
    finally:
        sys.setprofile(saved)
    return count


def wait_for_work(process: subprocess.Popen[str], seconds: float) -> None:
    """Waits until a process has had so many seconds of processor time, however loaded the machine is, or has ended.

    Where the system does not tell, the seconds are those of the clock.
    """
    told = Path(f"/proc/{process.pid}/stat")
    if not told.exists():
        time.sleep(seconds)
        return
    ticks = seconds * os.sysconf("SC_CLK_TCK")
    while process.poll() is None:
        user, system = told.read_text().rpartition(")")[2].split()[11:13]
        if int(user) + int(system) >= ticks:
            return
        time.sleep(0.05)
