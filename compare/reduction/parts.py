"""What a scene is made of, so that it can be left out: things, settings, and the digits of numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.things import Circle, Pocket, Wall

THINGS = ("circles", "walls", "pockets")

SETTINGS = ("reverse_after", "reverse_at", "capture", "until")

KEYS = {
    "circles": ("x", "y", "r", "vx", "vy", "m"),
    "walls": ("x0", "y0", "x1", "y1"),
    "pockets": ("x", "y", "r"),
}
"""The numbers of a thing; `id` and `point` are not numbers."""

DENOMINATORS = tuple(10**k for k in (0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 40))
"""Largest denominators of the fractions that a number is rounded to, the shortest first: a double has 16 digits, and
scenes closer to a tie than doubles can tell have more."""

ROOT_DIGITS = 60
"""Digits of a number with roots that are looked at before it is rounded: more than the longest fraction has."""


@dataclass(frozen=True)
class SceneParts:
    """Items of a scene, any of which may be left out.

    Attributes:
        kind: what they are called.
        items: their names.
        keeping: the scene with these of them alone.
            It raises a `SceneError` where that is no scene.
    """

    kind: str
    items: tuple[str, ...]
    keeping: Callable[[Sequence[str]], Scene]


def things(scene: Scene, kind: str) -> SceneParts:
    """The circles, the walls or the pockets by their ids.

    >>> parts = things(Scene([Circle(0, 0, id="a"), Circle(4, 0, id="b")]), "circles")
    >>> parts.items, parts.keeping(["b"]).ids
    (('a', 'b'), ('b',))
    """
    all_of: tuple[Any, ...] = getattr(scene, kind)

    def keeping(ids: Sequence[str]) -> Scene:
        return scene.with_changes(**{kind: [thing for thing in all_of if thing.id in ids]})

    return SceneParts(kind, tuple(str(thing.id) for thing in all_of), keeping)


def settings(scene: Scene) -> SceneParts:
    """The scene's reversal, its capture in pockets and its limit in time, where it has any.

    >>> settings(Scene([Circle(0, 0)], reverse_at=3)).items
    ('reverse_at',)
    """

    def keeping(names: Sequence[str]) -> Scene:
        gone = {name: False if name == "capture" else None for name in SETTINGS if name not in names}
        return scene.with_changes(**gone)

    return SceneParts("settings", tuple(name for name in SETTINGS if getattr(scene, name)), keeping)


def digits(scene: Scene, denominator: int) -> SceneParts:
    """The numbers that are shorter once they are rounded to a fraction of at most this denominator.

    Without one of them is: with it rounded.

    >>> parts = digits(Scene([Circle("22/7", 0)]), 1)
    >>> parts.items, parts.keeping([]).circles[0].x
    (('c1.x',), Quantity('3'))
    """
    shorter = {
        (kind, k, key): value
        for kind, k, key, number in numbers(scene)
        if (value := rounded(number, denominator)) is not None
    }
    names = {place: f"{getattr(scene, place[0])[place[1]].id}.{place[2]}" for place in shorter}

    def keeping(kept: Sequence[str]) -> Scene:
        changed: dict[str, list[Circle | Wall | Pocket]] = {}
        for (kind, k, key), value in shorter.items():
            if names[kind, k, key] not in kept:
                row = changed.setdefault(kind, list(getattr(scene, kind)))
                row[k] = with_number(row[k], kind, key, value)
        return scene.with_changes(**changed)

    return SceneParts("digits", tuple(names.values()), keeping)


def numbers(scene: Scene) -> Iterator[tuple[str, int, str, Quantity]]:
    """Every number of every thing: its kind, its place, its key and its value. A mass that is infinite is none."""
    for kind, keys in KEYS.items():
        for k, thing in enumerate(getattr(scene, kind)):
            for key in keys:
                value = getattr(thing, key)
                if isinstance(value, Quantity):
                    yield kind, k, key, value


def with_number(thing: Circle | Wall | Pocket, kind: str, key: str, value: Quantity) -> Circle | Wall | Pocket:
    """The thing with another number in one place; it is checked as any other.

    Raises:
        SceneError: if it must not have that number.
    """
    given = {name: getattr(thing, name) for name in KEYS[kind]} | {key: value, "id": thing.id}
    if isinstance(thing, Circle):
        given["point"] = thing.point
    return type(thing)(**given)


def rounded(number: Quantity, denominator: int) -> Quantity | None:
    """The nearest fraction of at most this denominator; None if it is no shorter to write.

    >>> rounded(Quantity.of("7799/1000"), 10), rounded(Quantity.of("sqrt(2)"), 10), rounded(Quantity.of("1/3"), 10)
    (Quantity('39/5'), Quantity('7/5'), None)
    """
    value = number.fraction
    if value is None:
        value = Fraction(number.digits(ROOT_DIGITS))
    told = Quantity.of(value.limit_denominator(denominator))
    return told if written(told) < written(number) else None


def written(number: Quantity) -> int:
    """How long a number is to write: its characters, without its sign; none for zero.

    >>> written(Quantity.of("-22/7")), written(Quantity.of("sqrt(2)")), written(Quantity.of(0))
    (4, 7, 0)
    """
    return len(number.text().removeprefix("-")) if number.sign() else 0


def length(scene: Scene) -> int:
    """How long all of a scene's numbers are to write.

    >>> length(Scene([Circle("1/3", 0)]))
    5
    """
    return sum(written(number) for *_, number in numbers(scene))
