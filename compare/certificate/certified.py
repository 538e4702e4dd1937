"""Certificates in use: written beside a run, checked by the program that shares nothing with it, and compared with the
scene that is meant."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import ZERO, Quantity
from ...scenarios.things import Arc
from ..writing import check_writable, write_whole
from .outlines import bars_of

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.things import Circle, Pocket, Segment, Wall
    from ...scenarios.trajectory import Trajectory

KEYS = {
    "circles": "x y r vx vy",
    "walls": "x0 y0 x1 y1 vx vy",
    "pockets": "x y r",
    "segments": "x0 y0 x1 y1 r vx vy",
    "arcs": "x y r",
}
TERM = re.compile(r"([+-]?[0-9]+(?:/[0-9]+)?)((?:\*r[0-9]+)*)")


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
    def summary(self) -> str:
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


def difference(block: Mapping[str, Any], scene: Scene) -> str | None:
    """The first thing in which the scene block of a certificate differs from a scene; None where it is that scene.

    Numbers are compared as exact numbers, however they are written, and things in their order, with their names;
    polygons as the segments that are their sides. What a scene says of when to end a run is no part of the block.

    Args:
        block: the `scene` of a certificate that a checker has verified.
        scene: what it is compared with.

    Raises:
        SceneError: if two numbers cannot be told from each other within counted work.

    >>> from truebreak.compare.certificate import certificate_of
    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> one, other = (Scene([Circle(0, 0, vx=1), Circle(x, 0)]) for x in ("sqrt(12)", "2*sqrt(3)"))
    >>> block = certificate_of(ExactEngine().run(one))["scene"]
    >>> difference(block, other), difference(block, Scene([Circle(0, 0, vx=1), Circle(5, 0)]))
    (None, "circle 'c2': x is 1*r1, not 5")
    """
    if scene.other_walls:
        return f"it has no wall of kind {scene.other_walls[0].kind!r}, which certificates do not know"
    roots: list[Quantity] = []
    for text in block.get("roots", ()):
        roots.append(_number(text, roots).sqrt())
    things: dict[str, Sequence[Circle | Wall | Pocket | Segment | Arc]] = {
        "circles": scene.circles, "walls": scene.walls, "pockets": scene.pockets, "segments": bars_of(scene),
        "arcs": scene.arcs,
    }  # fmt: skip
    for kind, meant in things.items():
        told = block.get(kind, ())
        if len(told) != len(meant):
            return f"it has {len(told)} {kind}, not {len(meant)}"
        for row, thing in zip(told, meant, strict=True):
            name = f"{kind[:-1]} {row['id']!r}"
            if row["id"] != str(thing.id):
                return f"{name} is not {str(thing.id)!r}"
            for key in KEYS[kind].split():
                value: Quantity = getattr(thing, key)
                if not _same(row.get(key, "0"), value, roots):
                    return f"{name}: {key} is {row.get(key, '0')}, not {value}"
            ends = thing.ends if isinstance(thing, Arc) else ()
            if isinstance(thing, Arc) and ("x0" in row) != bool(ends):
                return f"{name} is {'no ' * (not ends)}full circle"
            for k, end in enumerate(ends):
                for key, value in zip((f"x{k}", f"y{k}"), end, strict=True):
                    if not _same(row[key], value, roots):
                        return f"{name}: {key} is {row[key]}, not {value}"
            if kind == "circles":
                mass = getattr(thing, "m")  # noqa: B009 (only circles have one)
                if not _same(row["w"], ZERO if isinstance(mass, str) else Quantity.of(1) / mass, roots):
                    return f"{name}: w is {row['w']}, and not one over the mass {mass}"
    if not _same(block.get("restitution", "1"), scene.restitution, roots):
        return f"its restitution is {block.get('restitution', '1')}, not {scene.restitution}"
    pull = scene.gravity or (ZERO, ZERO)
    if not all(_same(text, part, roots) for text, part in zip(block.get("gravity", "00"), pull, strict=True)):
        return f"its gravity is {block.get('gravity', 'none')}, not {[str(part) for part in pull]}"
    policy = {"sequential": "sequential:order=scene"}
    ours, theirs = str(scene.tie_policy), str(block["tie_policy"])
    if policy.get(ours, ours) != policy.get(theirs, theirs):
        return f"its tie policy is {theirs}, not {ours}"
    if block.get("reverse_after") != scene.reverse_after:
        return f"reverse_after is {block.get('reverse_after')}, not {scene.reverse_after}"
    told_at = block.get("reverse_at")
    if (told_at is None) != (scene.reverse_at is None):
        return f"reverse_at is {told_at}, not {scene.reverse_at}"
    if scene.reverse_at is not None and not _same(str(told_at), scene.reverse_at, roots):
        return f"reverse_at is {told_at}, not {scene.reverse_at}"
    if block.get("settle", False) != scene.settle:
        return f"settle is {block.get('settle', False)}, not {scene.settle}"
    if scene.pockets and block.get("capture", False) != scene.capture:
        return f"capture is {block.get('capture', False)}, not {scene.capture}"
    return None


def _same(text: str, value: Quantity, roots: Sequence[Quantity]) -> bool:
    return (_number(text, roots) - value).sign() == 0


def _number(text: str, roots: Sequence[Quantity]) -> Quantity:
    """A number as a certificate spells it: r1 is the first of the roots."""
    total = ZERO
    for factor, names in TERM.findall(text):
        term = Quantity.of(factor.removeprefix("+"))
        for name in names.split("*r")[1:]:
            term = term * roots[int(name) - 1]
        total = total + term
    return total
