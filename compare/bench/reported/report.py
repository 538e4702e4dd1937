"""All that a benchmark measured, as JSON and back."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ....scenarios.errors import SceneError
from ..computer import Idleness, computer
from ..ratios.figures import Figure
from ..tradeoff import Tradeoff

SCHEMA = "truebreak/bench-2"


@dataclass(frozen=True)
class Report:
    """All that was measured.

    Attributes:
        figures: the ratios.
        tradeoffs: run time against error, scene by scene and engine by engine.
        skipped: why a figure is missing, by its name.
        idleness: whether the machine was idle.
    """

    figures: tuple[Figure, ...]
    tradeoffs: tuple[Tradeoff, ...]
    skipped: dict[str, str]
    idleness: Idleness

    def data(self) -> dict[str, Any]:
        """The report as JSON has it."""
        idle = self.idleness
        return {
            "schema": SCHEMA,
            "version": version("truebreak"),
            "machine": computer(),
            "idle": {"idle": idle.idle, "wall": idle.wall, "uneven": idle.uneven, "unsteady": list(idle.unsteady)},
            "figures": [figure.data() for figure in self.figures],
            "tradeoffs": [row.data() for row in self.tradeoffs],
            "skipped": self.skipped,
        }


def load(path: str, option: str) -> dict[str, Any]:
    """A report that `truebreak bench --json` printed.

    Args:
        option: what named the file, for errors.

    Raises:
        SceneError: for a file that cannot be read, is none, or is of another version.
    """
    where = f"{option} {path!r}"
    try:
        data = json.loads(Path(path).read_text("utf-8"))
    except OSError as error:
        raise SceneError(f"{where}: {error.strerror or error}; name a file that `bench --json` printed") from None
    except (ValueError, RecursionError):
        raise SceneError(f"{where}: is not JSON; name a file that `bench --json` printed") from None
    told = data.get("schema") if isinstance(data, dict) else None
    if told != SCHEMA:
        raise SceneError(f"{where}: is {str(told)[:60]!r}, not {SCHEMA!r}; measure it again with this version")
    if data.get("version") != version("truebreak"):
        raise SceneError(f"{where}: is of version {str(data.get('version'))[:20]}; measure it again with this version")
    try:
        rows, told = rows_of(data), idleness_of(data)
        ratios = [row.ratio for row in rows if row.refused is None] + [figure["ratio"] for figure in data["figures"]]
        assert all(0 < value < math.inf for value in (*ratios, told.wall, told.uneven))
        assert len({row.name for row in rows}) == len(rows)
        assert all(figure["name"] for figure in data["figures"]) and isinstance(data["machine"], dict)
    except (KeyError, TypeError, ValueError, AttributeError, AssertionError):
        raise SceneError(f"{where}: is damaged; measure it again") from None
    return data


def rows_of(data: dict[str, Any]) -> tuple[Tradeoff, ...]:
    """The rows of a report's JSON."""
    known = {item.name for item in fields(Tradeoff)} - {"took", "loop"}
    rows: list[Tradeoff] = []
    for row in data["tradeoffs"]:
        told = {key: row[key] for key in known}
        told["digits"] = math.inf if told["digits"] == "all" else told["digits"]
        told["error"] = math.inf if told["error"] is None else float(told["error"])
        told["changed"] = None if told["changed"] is None else tuple(told["changed"])
        rows.append(Tradeoff(**told))
    return tuple(rows)


def idleness_of(data: dict[str, Any]) -> Idleness:
    """The idleness of a report's JSON."""
    idle = data["idle"]
    return Idleness(float(idle["wall"]), float(idle["uneven"]), tuple(idle["unsteady"]))


def check_scenes(told: dict[str, str | None], data: dict[str, Any], path: str) -> None:
    """Refuses to hold a report against one of other scenes.

    Args:
        told: names and digests of the scenes to be measured.

    Raises:
        SceneError: naming the first that differs.
    """
    then = {row["scene"]: row["digest"] for row in data["tradeoffs"]}
    for name in sorted(told.keys() ^ then.keys()):
        there = "has not" if name in told else "has besides"
        raise SceneError(f"--against {path!r}: is of another set of scenes: {name!r} it {there}; choose other --scenes")
    for name, digest in told.items():
        if digest != then[name]:
            raise SceneError(f"--against {path!r}: its scene {name!r} is another one; measure it again")


def worst(parts: Sequence[Idleness]) -> Idleness:
    """Of several measurements, the least idle.

    >>> worst([Idleness(1.0, 1.2), Idleness(1.1, 1.0, ("a",))])
    Idleness(wall=1.1, uneven=1.2, unsteady=('a',))
    """
    rows = tuple(name for part in parts for name in part.unsteady)
    return Idleness(max(part.wall for part in parts), max(part.uneven for part in parts), rows)
