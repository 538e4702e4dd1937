"""Certificates on the command line: written beside a run, and checked by the program that shares nothing with it."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from ..writing import check_writable, write_whole

if TYPE_CHECKING:
    from ...scenarios.trajectory import Trajectory


@dataclass(frozen=True)
class Certified:
    """A certificate and what the checker says of it.

    Attributes:
        text: the certificate.
        code: the checker's exit code; 0: independently checked.
        sentence: its verdict in words.
    """

    text: str
    code: int
    sentence: str

    @property
    def checked(self) -> bool:
        """Whether the checker verified it."""
        return self.code == 0

    @property
    def told(self) -> str:
        """What a report says of it."""
        return f"{'Independently checked' if self.checked else 'Not independently checked'}: {self.sentence}."

    def data(self) -> dict[str, Any]:
        """What JSON says of it, the certificate included."""
        return {
            "independently_checked": self.checked,
            "checker": self.sentence,
            "certificate": json.loads(self.text),
        }


def certified(trajectory: Trajectory) -> Certified:
    """The certificate of a run, checked.

    Raises:
        SceneError: if the run has none.
    """
    from . import certificate_json, certificate_of

    text = certificate_json(certificate_of(trajectory))
    return Certified(text, *verdict(text))


def verdict(text: str) -> tuple[int, str]:
    """The checker's exit code and sentence for a certificate."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "certificate.json"
        file.write_text(text, encoding="utf-8")
        return verdict_on(str(file))


def check_engine(engine: str, option: str) -> None:
    """Refuses, before a run, an engine whose runs have no certificates.

    Raises:
        SceneError: saying which.
    """
    name = engine.partition(":")[0]
    if name != "exact":
        raise SceneError(f"{option}: only runs of the exact engine have certificates, not those of {name}")


def check_certifiable(engine: str, path: str) -> None:
    """Refuses, before a run, an engine whose runs have no certificates, and a place that cannot be written to.

    Raises:
        SceneError: saying which.
    """
    check_engine(engine, "--certificate")
    check_writable(path)


def write_certificate(trajectory: Trajectory, path: str) -> None:
    """Writes the certificate of a run.

    Raises:
        SceneError: if it has none, or the place cannot be written to.
    """
    from . import certificate_json, certificate_of

    write_whole(path, certificate_json(certificate_of(trajectory)))


def verdict_of_scene(path: str, scene: str | None, work: int | None = None) -> tuple[int, str]:
    """As `verdict_on`; what is verified is compared with a scene, or the sentence says that none was given.

    Args:
        path: the certificate.
        scene: the scene that it should be of: a name, a name with settings, or a file.
        work: as for `verdict_on`.

    Raises:
        SceneError: if there is no such scene, or two numbers cannot be told from each other within counted work.
    """
    from ..scene_argument import scene_from
    from .same_scene import difference

    meant = None if scene is None else scene_from(scene)
    code, sentence = verdict_on(path, work)
    if code:
        return code, sentence
    if meant is None:
        return code, f"{sentence}; no scene was given"
    found = difference(json.loads(Path(path).read_text(encoding="utf-8"))["scene"], meant)
    if found:
        return 1, f"refuted: its scene is not {scene}: {found}"
    return code, f"{sentence}; its scene is {scene}"


def verdict_on(path: str, work: int | None = None) -> tuple[int, str]:
    """The checker's exit code and sentence for a file; it runs by itself, as anybody else would run it.

    Args:
        path: the certificate.
        work: what checking may cost, in units of about a nanosecond; None: by the size of the file.
    """
    from ...tools import verify

    more = [] if work is None else [f"--work={work}"]
    command = [sys.executable, "-I", str(Path(verify.__file__)), path, *more]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    told = done.stdout.strip() or f"the checker failed: {done.stderr.strip().rpartition(chr(10))[2]}"
    return (done.returncode, told) if done.stdout else (2, told)
