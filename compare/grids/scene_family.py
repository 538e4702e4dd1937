"""Families of scenes: a catalogue scene with some of its parameters varied, and scenes a little beside one."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ...exact.exact_engine import ExactEngine
from ...scenarios import catalogue
from ...scenarios.catalogue.scene_entry import Draw
from ...scenarios.engine import Declared
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.things import Circle
from ..engines import suggestion
from ..scene_argument import scene_from
from .grid import several

if TYPE_CHECKING:
    from ...scenarios.numbers.quantity import QuantityLike
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress, Trajectory

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
    try:
        numbers = several(rest, "--vary")
    except SceneError as error:
        raise SceneError(str(error).replace(repr(rest), repr(text), 1)) from None
    if numbers is not None:
        return Varied(key, numbers)
    values = tuple(value.strip() for value in rest.split(","))
    if ".." in rest or not all(values):
        raise SceneError(f"--vary {text!r}: {rest!r} is no range and no list; write 3..20, 0..90:10 or 1/10,1/4")
    if len(set(values)) < len(values):
        raise SceneError(f"--vary {text!r}: a value comes twice; keep one")
    return Varied(key, values)


@dataclass(frozen=True)
class SceneFamily:
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

        >>> SceneFamily("gas", (varied("n=3..4"), varied("seed=1..3"))).settings(4)
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

    def indices(self, shard: tuple[int, int]) -> range:
        """The scenes of one shard K of N: every Nth from the Kth on."""
        return range(shard[0] - 1, len(self), shard[1])


def family(scene: str, vary: Sequence[str]) -> SceneFamily:
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
        return SceneFamily(scene, ())
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
    return SceneFamily(scene, parameters)


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


# -- scenes beside a scene: what an exact observer errs by who knows the start a little less

GRAIN = 1000
"""Displacements are drawn in thousandths of their size."""


def displaced(scene: Scene, size: Quantity, seed: int) -> Scene:
    """The scene with every circle that can move displaced by up to `size` in x and in y.

    Raises:
        SceneError: if circles overlap then.

    >>> from truebreak.scenarios import catalogue
    >>> near = displaced(catalogue.build("gas:n=3"), Quantity.of("10**-12"), 1)
    >>> abs(float(near.circles[0].x - catalogue.build("gas:n=3").circles[0].x)) <= 1e-12
    True
    """
    draw = Draw(seed)
    circles: list[Circle] = []
    for c in scene.circles:
        if c.fixed:
            circles.append(c)
            continue
        dx, dy = (size * draw.between(-GRAIN, GRAIN) / GRAIN for _ in range(2))
        circles.append(Circle(c.x + dx, c.y + dy, c.r, c.vx, c.vy, m=c.m, id=c.id, point=c.point))
    return scene.with_changes(circles=circles)


def nudged(scene: Scene, size: Quantity, seed: int) -> Scene:
    """The scene with every velocity changed a little, and nothing else: what touches goes on touching.

    A component of a velocity changes by up to `size` times the larger component of it. Circles at rest stay at rest.

    >>> from truebreak.scenarios import catalogue
    >>> near = nudged(catalogue.build("cradle"), Quantity.of("1/1000"), 1)
    >>> [(str(c.vx), str(c.vy)) for c in near.circles[:2]], near.circles[0].x == catalogue.build("cradle").circles[0].x
    ([('1000133/1000000', '123/250000'), ('0', '0')], True)
    """
    draw = Draw(seed)
    circles: list[Circle] = []
    for c in scene.circles:
        room = size * max(abs(c.vx), abs(c.vy))
        vx, vy = (v + room * draw.between(-GRAIN, GRAIN) / GRAIN for v in (c.vx, c.vy))
        circles.append(Circle(c.x, c.y, c.r, vx, vy, m=c.m, id=c.id, point=c.point))
    return scene.with_changes(circles=circles, name=f"{scene.name}, perturbed {seed}")


@dataclass(frozen=True)
class Perturbed(Declared):
    """The exact engine, given the scene displaced: every decision is proved, of another scene.

    Attributes:
        size: the largest displacement of a coordinate.
        seed: of the displacements.
    """

    size: Quantity
    seed: int = 1

    def __post_init__(self) -> None:
        if self.size.sign() <= 0:
            raise SceneError(f"--perturb {self.size}: must be above zero")

    @property
    def name(self) -> str:
        """`perturbed`."""
        return "perturbed"

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """The certified history of the displaced scene, given as that of the scene asked for."""
        near = displaced(scene, self.size, self.seed)
        told = ExactEngine().run(near, until=until, events=events, progress=progress)
        return replace(told, scene=scene, engine=self.name)
