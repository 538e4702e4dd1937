"""The scenes of a sweep: a catalogue scene with some of its parameters varied."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ...scenarios import catalogue
from ...scenarios.errors import SceneError
from ..engines import suggestion
from ..scene_argument import scene_from

RANGE = re.compile(r"(?P<low>-?\d{1,15})\.\.(?P<high>-?\d{1,15})(:(?P<step>\d{1,15}))?")

CHECKED = 10_000
"""Values of one parameter up to which each is read before anything runs."""


@dataclass(frozen=True)
class Varied:
    """One parameter and the values that it takes, as text."""

    key: str
    values: range | tuple[str, ...]

    def __len__(self) -> int:
        return len(self.values)

    def text(self) -> str:
        """As it was written, in one form."""
        if isinstance(self.values, range):
            step = f":{self.values.step}" if self.values.step != 1 else ""
            return f"{self.key}={self.values[0]}..{self.values[-1]}{step}"
        return f"{self.key}={','.join(self.values)}"


def varied(text: str) -> Varied:
    """`KEY=LOW..HIGH`, `KEY=LOW..HIGH:STEP` or `KEY=VALUE,VALUE,...`.

    Raises:
        SceneError: for anything else, and for an empty range.

    >>> list(varied("n=3..5").values), varied("gap=0,1/10").values
    ([3, 4, 5], ('0', '1/10'))
    """
    key, equals, rest = (part.strip() for part in text.partition("="))
    if not equals or not key or not rest:
        raise SceneError(f"--vary {text!r}: is not KEY=VALUES; write n=3..20, seed=0..90:10 or r=1/10,1/4")
    match = RANGE.fullmatch(rest)
    if match is None:
        values = tuple(value.strip() for value in rest.split(","))
        if ".." in rest or not all(values):
            raise SceneError(f"--vary {text!r}: {rest!r} is no range and no list; write 3..20, 0..90:10 or 1/10,1/4")
        if len(set(values)) < len(values):
            raise SceneError(f"--vary {text!r}: a value comes twice; keep one")
        return Varied(key, values)
    low, high, step = int(match["low"]), int(match["high"]), int(match["step"] or 1)
    if step == 0:
        raise SceneError(f"--vary {text!r}: a step of 0 goes nowhere; make it 1 or more")
    if high < low:
        raise SceneError(f"--vary {text!r}: the range is empty, as {high} is below {low}; write the lower end first")
    return Varied(key, range(low, high + 1, step))


@dataclass(frozen=True)
class Family:
    """The scenes of a sweep, in order: the last parameter varies fastest. None is built before it is asked for.

    Attributes:
        scene: as on the command line.
        parameters: what varies.
    """

    scene: str
    parameters: tuple[Varied, ...]

    def __len__(self) -> int:
        return math.prod(len(parameter) for parameter in self.parameters)

    def settings(self, index: int) -> dict[str, str]:
        """The values of the varied parameters in one scene.

        >>> Family("gas", (varied("n=3..4"), varied("seed=1..3"))).settings(4)
        {'n': '4', 'seed': '2'}
        """
        told: dict[str, str] = {}
        for parameter in reversed(self.parameters):
            index, place = divmod(index, len(parameter))
            told[parameter.key] = str(parameter.values[place])
        return dict(reversed(told.items()))

    def spec(self, index: int) -> str:
        """The scene's own text: a catalogue name with all of its settings, or the file."""
        given = ",".join(f"{key}={value}" for key, value in self.settings(index).items())
        return f"{self.scene}{',' if ':' in self.scene else ':'}{given}" if given else self.scene

    def indices(self, shard: tuple[int, int]) -> Iterator[int]:
        """The scenes of one shard K of N: every Nth from the Kth on."""
        return iter(range(shard[0] - 1, len(self), shard[1]))


def family(scene: str, vary: Sequence[str]) -> Family:
    """The family, with every key and value checked as far as can be without building all scenes.

    Raises:
        SceneError: for a scene that is not known or has nothing to vary, an unknown key, a bad value, an empty range.
    """
    parameters = tuple(varied(text) for text in vary)
    name, _, given = scene.partition(":")
    if not parameters or name.strip() not in catalogue.names():
        if parameters:
            raise SceneError(f"--vary: {scene!r} is no catalogue scene, and has no parameters; leave --vary out")
        scene_from(scene)
        return Family(scene, ())
    entry = catalogue.entry(name.strip())
    known = {parameter.name: parameter for parameter in entry.parameters}
    fixed = {part.partition("=")[0].strip() for part in given.split(",")}
    for place, parameter in enumerate(parameters):
        key = parameter.key
        if key not in known:
            raise SceneError(f"--vary {parameter.text()}: scene {name!r} has no parameter {key!r}; "
                             f"{suggestion(key, list(known))}")  # fmt: skip
        if key in fixed or key in [other.key for other in parameters[:place]]:
            raise SceneError(f"--vary {parameter.text()}: {key} is set twice; keep one")
        ends = parameter.values if len(parameter) <= CHECKED else (parameter.values[0], parameter.values[-1])
        for value in ends:
            try:
                known[key].read(str(value))
            except SceneError as error:
                raise SceneError(f"--vary {parameter.text()}: {key} = {str(value)!r}: {error}") from None
    return Family(scene, parameters)


def shard_of(text: str) -> tuple[int, int]:
    """`K/N` as two numbers.

    Raises:
        SceneError: unless 1 <= K <= N.

    >>> shard_of("3/40")
    (3, 40)
    """
    match = re.fullmatch(r"(\d{1,9})/(\d{1,9})", text.strip())
    if match is None or not 1 <= int(match[1]) <= int(match[2]):
        raise SceneError(f"--shard {text!r}: is not K/N with K from 1 to N; write 3/40 for the third of forty parts")
    return int(match[1]), int(match[2])
