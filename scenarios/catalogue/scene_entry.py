"""What scenes of the catalogue are made of: an entry, settings read from text, a draw from a seed, exact angles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, TypeAlias

from ..errors import SceneError, cut
from ..lazy import frozen
from ..numbers.quantity import Quantity
from ..scene import Scene
from ..settings import TiePolicy

# -- Exact cosines and sines of the angles that need square roots only.

COSINES = {
    0: "1",
    30: "(sqrt(6) + sqrt(2))/4",
    36: "sqrt(10 + 2*sqrt(5))/4",
    45: "sqrt(2 + sqrt(2))/2",
    60: "sqrt(3)/2",
    72: "(sqrt(5) + 1)/4",
    90: "sqrt(2)/2",
    108: "sqrt(10 - 2*sqrt(5))/4",
    120: "1/2",
    135: "sqrt(2 - sqrt(2))/2",
    144: "(sqrt(5) - 1)/4",
    150: "(sqrt(6) - sqrt(2))/4",
    180: "0",
}
"""Cosines by angle in half degrees. Euclid knew the pentagon's; the others halve 60 and 90 degrees."""


@cache
def cosine(half_degrees: int) -> Quantity:
    """The cosine of an angle, in half degrees: any multiple of 15, 18 or 22.5 degrees.

    >>> cosine(240), cosine(144)
    (Quantity('-1/2'), Quantity('(sqrt(5) - 1)/4'))
    """
    angle = abs((half_degrees + 360) % 720 - 360)
    return Quantity.of(COSINES[angle]) if angle <= 180 else -Quantity.of(COSINES[360 - angle])


def sine(half_degrees: int) -> Quantity:
    """The sine of an angle, in half degrees.

    >>> cosine(36) ** 2 + sine(36) ** 2 == 1
    True
    """
    return cosine(180 - half_degrees)


# -- Whole numbers drawn from a seed: the same ones on every machine and in every version of Python.

MASK = (1 << 64) - 1


class Draw:
    """A stream of pseudo-random whole numbers: SplitMix64.

    Source: Steele, Lea and Flood, *Fast splittable pseudorandom number generators* (OOPSLA 2014).

    >>> draw = Draw(1)
    >>> [draw.between(-5, 5) for _ in range(6)]
    [1, 3, 5, -1, -1, 3]
    """

    def __init__(self, seed: int) -> None:
        self._state = seed & MASK

    def _next(self) -> int:
        self._state = (self._state + 0x9E3779B97F4A7C15) & MASK
        z = self._state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
        return z ^ (z >> 31)

    def between(self, low: int, high: int) -> int:
        """A whole number from `low` to `high`, both included."""
        return low + (self._next() * (high - low + 1) >> 64)


# -- From the text of a setting to its value: one reader for each kind of setting.

ReadSetting: TypeAlias = Callable[[str], Any]


def whole(low: int, high: int) -> ReadSetting:
    """Reads a whole number from `low` to `high`.

    >>> whole(1, 5)("3")
    3
    """

    def read(text: str) -> int:
        digits = text.removeprefix("-")
        if digits.isascii() and digits.isdigit() and len(digits) <= len(str(max(abs(low), abs(high)))):
            value = int(text)
            if low <= value <= high:
                return value
        raise SceneError(f"must be a whole number from {low} to {high}")

    return read


def number(above: int | None = None, least: int | None = None) -> ReadSetting:
    """Reads an exact number, perhaps above a bound, or no less than one.

    >>> number(above=0)("sqrt(2)/2")
    Quantity('sqrt(2)/2')
    """

    def read(text: str) -> Quantity:
        value = Quantity.of(text)
        if above is not None and value <= above:
            raise SceneError(f"must be above {above}")
        if least is not None and value < least:
            raise SceneError(f"must be at least {least}")
        return value

    return read


def one_of(*choices: str) -> ReadSetting:
    """Reads one of some words.

    >>> one_of("left", "right")("left")
    'left'
    """

    def read(text: str) -> str:
        if text not in choices:
            raise SceneError(f"must be one of: {', '.join(choices)}")
        return text

    return read


def yes_no(text: str) -> bool:
    """Reads yes or no.

    >>> yes_no("yes")
    True
    """
    if text not in ("yes", "no"):
        raise SceneError("must be yes or no")
    return text == "yes"


def automatic(read: ReadSetting) -> ReadSetting:
    """Reads what `read` does, or the word auto, which is None.

    >>> automatic(whole(1, 9))("auto") is None
    True
    """

    def read_or_auto(text: str) -> Any:
        return None if text == "auto" else read(text)

    return read_or_auto


def tie_policy(text: str) -> TiePolicy:
    """Reads a tie policy.

    >>> tie_policy("sequential:seed=3")
    TiePolicy(name='sequential', seed=3)
    """
    return TiePolicy.parse(text)


# -- One scene of the catalogue: its parameters, its source, what is known of it, and how it is made.


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
