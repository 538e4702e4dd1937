"""Certificates on the command line: written beside a run, and checked by the program that shares nothing with it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from ..scenarios.errors import SceneError
from .writing import check_writable, write_whole

if TYPE_CHECKING:
    from ..scenarios.trajectory import Trajectory


def check_certifiable(engine: str, path: str) -> None:
    """Refuses, before a run, an engine whose runs have no certificates, and a place that cannot be written to.

    Raises:
        SceneError: saying which.
    """
    if engine != "exact":
        raise SceneError(f"--certificate: only runs of the exact engine have certificates, not those of {engine}")
    check_writable(path)


def write_certificate(trajectory: Trajectory, path: str) -> None:
    """Writes the certificate of a run.

    Raises:
        SceneError: if it has none, or the place cannot be written to.
    """
    from ..exact.certificate import certificate_json, certify

    write_whole(path, certificate_json(certify(trajectory)))


def verdict_on(path: str) -> tuple[int, str]:
    """The checker's exit code and sentence for a file; it runs by itself, as anybody else would run it."""
    from ..tools import verify

    done = subprocess.run(
        [sys.executable, "-I", str(Path(verify.__file__)), path], capture_output=True, text=True, check=False
    )
    told = done.stdout.strip() or f"the checker failed: {done.stderr.strip().rpartition(chr(10))[2]}"
    return (done.returncode, told) if done.stdout else (2, told)
