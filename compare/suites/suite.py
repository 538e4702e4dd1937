"""A suite: scenes, the engines held against the truth on each, and limits; read from a TOML file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...scenarios.disk import text_of
from ...scenarios.errors import SceneError
from ...scenarios.files import MAX_TOML, toml_table
from ..engines import engine, label_of, split_engines, suggestion
from ..scene_argument import FILE_SUFFIXES, scene_from

SUITE_KEYS = ("engines", "until", "events", "causes", "scene")
SCENE_KEYS = ("name", "engines", "until", "events")


@dataclass(frozen=True)
class Task:
    """One scene of a suite.

    Attributes:
        scene: as on the command line: a name of the catalogue, or a file.
        engines: as on the command line.
        until, events: limits of the reference's run; None: the scene's own.
    """

    scene: str
    engines: tuple[str, ...]
    until: str | None = None
    events: int | None = None


@dataclass(frozen=True)
class Suite:
    """Tasks, and whether causes are looked for.

    Attributes:
        name: what reports call it.
    """

    name: str
    tasks: tuple[Task, ...]
    causes: bool = True


def read_suite(path: str) -> Suite:
    """A suite from a file, every scene and engine of it checked before anything is run.

    Scenes that are files are looked for from the suite's folder.

    Raises:
        SceneError: naming the file, the scene, the key and the remedy.
    """
    return parsed_suite(text_of(path, MAX_TOML, "name a suite in TOML"), path)


def parsed_suite(text: str, path: str) -> Suite:
    """A suite from the text of a file; see `read_suite`.

    >>> parsed_suite('engines = ["double"]\\n[[scene]]\\nname = "lee"', "mine.toml").tasks
    (Task(scene='lee', engines=('double',), until=None, events=None),)
    """
    where = f"file {path!r}"
    data = toml_table(text, where)
    _known(where, data, SUITE_KEYS)
    scenes = data.get("scene", [])
    if not isinstance(scenes, list) or not scenes or not all(isinstance(scene, dict) for scene in scenes):
        raise SceneError(f'{where}: has no scene; add [[scene]] with name = "gas:n=5"')
    causes = data.get("causes", True)
    if not isinstance(causes, bool):
        raise SceneError(f"{where}: causes = {causes!r}; must be true or false")
    tasks = tuple(_task(f"{where}: scene {number}", {**data, **scene}, path) for number, scene in enumerate(scenes, 1))
    seen: set[tuple[str, str]] = set()
    for task in tasks:
        for name in map(label_of, task.engines):
            if (task.scene, name) in seen:
                raise SceneError(f"{where}: {task.scene!r} is there twice with {name!r}; leave one out")
            seen.add((task.scene, name))
    for scene in scenes:
        _known(where, scene, SCENE_KEYS)
    return Suite(Path(path).name, tasks, causes)


def _task(where: str, data: Mapping[str, Any], path: str) -> Task:
    name = data.get("name")
    if not isinstance(name, str) or not name.strip():
        raise SceneError(f"{where}: name = {name!r}; must be a scene of the catalogue or a file, as text")
    where = f"{where} ({name})"
    if name.lower().endswith(FILE_SUFFIXES) and not Path(name).is_absolute():
        name = str(Path(path).parent / name)
    until, events = data.get("until"), data.get("events")
    if isinstance(until, int) and not isinstance(until, bool):
        until = str(until)
    if until is not None and not isinstance(until, str):
        raise SceneError(f'{where}: until = {until!r}; must be exact, as text: until = "9/4"')
    if events is not None and (isinstance(events, bool) or not isinstance(events, int) or events < 1):
        raise SceneError(f"{where}: events = {events!r}; must be a whole number from 1")
    engines = data.get("engines", [])
    listed = split_engines(engines) if isinstance(engines, str) else engines
    if not isinstance(listed, list) or not listed or not all(isinstance(text, str) for text in listed):
        raise SceneError(f'{where}: engines = {engines!r}; must be a list such as ["double", "pymunk:dt=1/512"]')
    try:
        scene_from(name)
        for text in listed:
            engine(text)
    except SceneError as error:
        raise type(error)(f"{where}: {error}") from None
    return Task(name, tuple(listed), until, events)


def _known(where: str, data: Mapping[str, Any], keys: tuple[str, ...]) -> None:
    for key in data:
        if key not in keys:
            raise SceneError(f"{where}: {key!r} is no key of it; {suggestion(key, list(keys))}")
