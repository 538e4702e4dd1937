"""Finds engines that are not truebreak's own: `package.module:Class`, or by the name of an entry point."""

from __future__ import annotations

import re
import sys
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from ...scenarios.errors import SceneError

GROUP = "truebreak.engines"
"""The group of entry points under which an installed package offers engines."""

PATH = re.compile(
    r"(?:(?P<label>[\w.-]+)=)?(?P<module>[^\W\d]\w*(?:\.[^\W\d]\w*)*):(?P<attribute>[^\W\d][\w.]*)(?=[:,]|$)"
    r"[:,]?(?P<settings>.*)",
    re.DOTALL,
)


class ClassPath(NamedTuple):
    """`LABEL=package.module:Class:key=value`, taken apart.

    Attributes:
        label: what reports call it; None: as it was asked for.
        settings: `key=value,key=value`, or nothing.
    """

    label: str | None
    module: str
    attribute: str
    settings: str

    @property
    def told(self) -> str:
        """Where it is."""
        return f"{self.module}:{self.attribute}"


def class_path(text: str) -> ClassPath | None:
    """A text that says where an engine's class is; None for a name with settings, such as `pymunk:dt=1/100`.

    >>> class_path("mine=pool.engines:Fast:dt=1/100")
    ClassPath(label='mine', module='pool.engines', attribute='Fast', settings='dt=1/100')
    >>> class_path("pymunk:dt=1/100") is class_path("double") is None
    True
    """
    match = PATH.fullmatch(text.strip())
    if match is None:
        return None
    return ClassPath(match["label"], match["module"], match["attribute"], match["settings"])


def label_of(text: str) -> str:
    """What reports call an engine that was asked for by a text.

    >>> label_of("mine=pool.engines:Fast"), label_of(" double ")
    ('mine', 'double')
    """
    path = class_path(text)
    return text.strip() if path is None or path.label is None else path.label


def load_class(path: ClassPath) -> Any:
    """What a path names: an engine's class, or an engine. The folder where the user is counts as one of modules.

    Raises:
        SceneError: if there is no such module or name, or the module raises.
    """
    here = str(Path.cwd())
    if here not in sys.path and "" not in sys.path:
        sys.path.append(here)
    try:
        found: Any = import_module(path.module)
    except (Exception, SystemExit) as error:
        missing = isinstance(error, ModuleNotFoundError) and error.name and path.module.startswith(error.name)
        reason = " ".join(str(error).split())
        remedy = "; is it installed, or in this folder?" if missing else ""
        raise SceneError(f"engine '{path.told}': {type(error).__name__}: {reason}{remedy}") from None
    for part in path.attribute.split("."):
        if not hasattr(found, part):
            raise SceneError(f"engine '{path.told}': {path.module} has no {part!r}; name a class of that module")
        found = getattr(found, part)
    return found


def offered() -> dict[str, Any]:
    """The entry points by which installed packages offer engines, by name; nothing of them is imported."""
    from importlib.metadata import entry_points

    return {point.name: point for point in entry_points(group=GROUP)}


def load_offered(name: str) -> Any:
    """What an entry point names.

    Raises:
        SceneError: if it cannot be had.
    """
    point = offered()[name]
    try:
        return point.load()
    except Exception as error:
        reason = " ".join(str(error).split())
        raise SceneError(f"engine {name!r}, offered as {point.value}: {type(error).__name__}: {reason}") from None
