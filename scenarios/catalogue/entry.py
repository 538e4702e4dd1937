"""One scene of the catalogue: its parameters, its source, what is known of it, and how it is made."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ..checks.showing import cut
from ..errors import SceneError
from ..lazy.frozen import frozen
from ..scene import Scene
from .settings import ReadSetting


@frozen
class Parameter:
    """A setting of a catalogue scene.

    Attributes:
        name: as it is written in `NAME:name=value`.
        default: its value where none is given, as text.
        help: what it sets, in one line.
        read: from text to the value, or SceneError.
    """

    name: str
    default: str
    help: str
    read: ReadSetting


@frozen
class SceneEntry:
    """A scene of the catalogue.

    Attributes:
        name: what `catalogue.build` calls it.
        summary: what it shows, in one line.
        parameters: its settings, in order.
        known: what is known of it without this program.
        source: where it comes from.
        make: the scene function; it takes the settings by name.
    """

    name: str
    summary: str
    parameters: tuple[Parameter, ...]
    known: str
    source: str
    make: Callable[..., Scene]

    def build(self, settings: Mapping[str, Any]) -> Scene:
        """The scene with some settings changed; values are text or anything that spells them.

        Raises:
            SceneError: for an unknown setting, and for a value that it cannot have.
        """
        label = f"catalogue scene {self.name!r}"
        known = {parameter.name: parameter for parameter in self.parameters}
        for key in settings:
            if key not in known:
                import difflib

                near = difflib.get_close_matches(key, known, n=1)
                hint = f"did you mean {near[0]!r}? " if near else ""
                raise SceneError(f"{label} has no parameter {cut(key)}; {hint}it has: {', '.join(known)}")
        values: dict[str, Any] = {}
        changed: list[str] = []
        for key, parameter in known.items():
            text = _text(settings[key]) if key in settings else parameter.default
            try:
                values[key] = parameter.read(text)
            except SceneError as error:
                raise SceneError(f"{label}: {key} = {cut(text)}: {error}") from None
            if text != parameter.default:
                changed.append(f"{key}={text}")
        try:
            scene = self.make(**values)
        except SceneError as error:
            raise SceneError(f"{label}: {error}") from None
        name = f"{self.name}:{','.join(changed)}" if changed else self.name
        return scene.with_changes(name=name, description=f"{self.summary} {self.known}", source=self.source)


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return str(value).strip()
