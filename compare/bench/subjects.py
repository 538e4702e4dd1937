"""The scenes and the settings of which run time is set against error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...scenarios.errors import SceneError
from ..engines import ENGINES, offered, suggestion
from ..scene_argument import scene_from

SETTINGS = (
    "single",
    "double",
    "quad",
    "interval:bits=53",
    "interval:bits=128",
    "interval:bits=512",
    "pymunk:dt=1/64",
    "pymunk:dt=1/256",
    "pymunk:dt=1/1024",
    "pymunk:dt=1/4096",
    "pymunk:dt=1/1024,iterations=1",
    "pymunk:dt=1/1024,iterations=1000",
)
"""What is set against the exact engine, whose own row comes first. Pymunk's iterations are 64 where nothing is said."""

CROWD = ("double", "pymunk:dt=1/64", "pymunk:dt=1/1024")
"""The same for a scene of many discs."""


@dataclass(frozen=True)
class Subject:
    """One scene of the table.

    Attributes:
        name: as `--scenes` takes it.
        spec: the scene of the catalogue.
        events: how many of its instants are run; fewer where it comes to rest before.
        settings: what is set against the exact engine.
        symbolic: whether engines that count in expressions are run too: elsewhere an event takes them seconds, or
            minutes where roots nest.
    """

    name: str
    spec: str
    events: int
    settings: tuple[str, ...] = SETTINGS
    symbolic: bool = False


SUBJECTS = (
    Subject("gas", "gas:n=10,seed=1", 100),
    Subject("mixed-gas", "gas:n=10,seed=1,mixed=yes", 100),
    Subject("rack-touching", "rack:rows=3", 20),
    Subject("rack-loose", "rack:rows=3,gap=1/50", 20),
    Subject("galperin", "galperin:n=2", 314),
    Subject("cradle", "cradle", 60, symbolic=True),
    Subject("pinball", "pinball", 20),
    Subject("lorentz", "lorentz", 20),
    Subject("near-tie", "near-tie:k=12", 4, symbolic=True),
    Subject("thousand-discs", "gas:n=1000,seed=1", 100, CROWD),
)
"""Every scene. A new one is one line here."""


def subjects(only: Sequence[str] = ()) -> tuple[Subject, ...]:
    """All, or those named.

    Raises:
        SceneError: for an unknown name.

    >>> [subject.name for subject in subjects(["cradle", "gas"])]
    ['gas', 'cradle']
    """
    names = [subject.name for subject in SUBJECTS]
    for name in only:
        if name not in names:
            raise SceneError(f"--scenes {name!r}: is none of this table's; {suggestion(name, names)}")
    return tuple(subject for subject in SUBJECTS if not only or subject.name in only)


def digest_of(subject: Subject) -> str | None:
    """What tells its scene from another; None where it cannot be built."""
    try:
        return scene_from(subject.spec).digest
    except SceneError:
        return None


def settings_of(subject: Subject, only: Sequence[str] = ()) -> tuple[str, ...]:
    """The settings of a scene, those asked for, or all: with every other engine that there is.

    >>> settings_of(SUBJECTS[0], ["double"])
    ('double',)
    """
    if only:
        return tuple(only)
    named = {text.partition(":")[0] for text in (*SETTINGS, "exact")}
    others = [name for name in (*ENGINES, *offered()) if name not in named]
    return (*subject.settings, *others)
