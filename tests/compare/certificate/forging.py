"""What forgeries of certificates are made with: scenes, and small changes of what is told of them."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from typing import Any

from certificate.checkers import NODE, by_node, by_python
from truebreak.compare.certificate import certificate_json, certificate_of
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Quantity, Scene

Told = dict[str, Any]
TINY = "1/1" + "0" * 70
"""Far less than the bits of these certificates tell."""

SAME = {"matrix": ["1", "0", "0", "1"], "shift": ["0", "0"]}
UPSIDE_DOWN = {"matrix": ["1", "0", "0", "-1"], "shift": ["0", "0"]}


def told(scene: Scene, **limits: Any) -> Told:
    """A scene's certificate."""
    return deepcopy(certificate_of(ExactEngine().run(scene, **limits)))


def row(y: int, count: int = 3, name: str = "a", **first: Any) -> list[Circle]:
    """Discs each a little off the line, the first of which flies at the others."""
    lines = [{"x": 4 * k, "y": Quantity.of(f"{y} + {k}/7"), "id": f"{name}{k}"} for k in range(count)]
    return [Circle(**line, **({"vx": 1, **first} if k == 0 else {})) for k, line in enumerate(lines)]


def added(cert: Told, circle: int, key: str) -> None:
    """A number of a circle becomes a little larger."""
    cert["scene"]["circles"][circle][key] += f"+{TINY}"


def witness(cert: Told, entry: Told, *zero: Any, motion: Told | None = None) -> None:
    """A witness that comes before the others, perhaps by a further isometry."""
    if motion is not None:
        cert["isometries"].append(motion)
        zero = (*zero[:2], len(cert["isometries"]) - 1, *zero[2:])
    entry["zeros"] = [list(zero), *entry.get("zeros", [])]


def refused_by_both(cert: Told, path: Path) -> tuple[int, str]:
    """Asserts that neither checker verifies a certificate, and that they do not differ; the first one's verdict."""
    path.write_text(certificate_json(cert), encoding="utf-8")
    code, sentence = by_python(path)
    assert code != 0, sentence
    if NODE is not None:
        other, words = by_node([path])[0]
        assert other != 0 and (4 in (code, other) or code == other), f"{sentence}; {words}"
    return code, sentence
