"""A family of scenes that get harder as one whole number grows, and a place in it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from ...scenarios.errors import SceneError
from ...scenarios.scene import Scene
from ...scenarios.trajectory import Trajectory
from ..engines import suggestion

SHORT = 4
"""Members of a lane in a short map: both ends, and two between."""


@dataclass(frozen=True)
class MapPlace:
    """One member of a family: everything that decides its scene.

    Attributes:
        family: the family's name.
        k: how hard.
        side: which of the family's variants.
        seed: what is drawn; 0 where nothing is.
    """

    family: str
    k: int
    side: str
    seed: int = 0

    @property
    def lane(self) -> str:
        """The ladder that it stands on, without its family.

        >>> MapPlace("near-ties", 7, "left").lane, MapPlace("scaled", 7, "up", 2).lane
        ('left', 'up, seed 2')
        """
        return f"{self.side}, seed {self.seed}" if self.seed else self.side

    @property
    def show(self) -> str:
        """The command that prints its scene.

        >>> MapPlace("scaled", 7, "up", 2).show
        'truebreak stress scaled --show 7 --side up --seed 2'
        """
        seed = f" --seed {self.seed}" if self.seed else ""
        return f"truebreak stress {self.family} --show {self.k} --side {self.side}{seed}"


@dataclass(frozen=True, kw_only=True)
class Family:
    """Scenes for k = `first` to `most`, on each of its sides and for each of its seeds.

    Attributes:
        name: as on the command line.
        summary: what happens in the scene.
        grows: what k is.
        make: the scene of k, a side and a seed, with limits of its own.
        first, last: the k of the map unless others are asked for.
        most: the largest k that can be asked for.
        sides: its variants.
        seeds: of what it draws; (0,) where it draws nothing.
        known: whether a run has the outcome that a closed form gives; None where there is none. It takes the run, k,
            side and seed.
    """

    name: str
    summary: str
    grows: str
    make: Callable[[int, str, int], Scene]
    first: int = 1
    last: int
    most: int
    sides: tuple[str, ...] = ("only",)
    seeds: tuple[int, ...] = (0,)
    known: Callable[[Trajectory, int, str, int], bool] | None = None

    def levels(self, short: bool = False) -> tuple[int, ...]:
        """The k of the map; a short map has a few, evenly spread.

        >>> def make(k: int, side: str, seed: int) -> Scene:
        ...     return Scene([])
        >>> one = Family(name="one", summary="", grows="", make=make, last=10, most=99)
        >>> one.levels(short=True)
        (1, 4, 7, 10)
        """
        whole = range(self.first, self.last + 1)
        if not short or len(whole) <= SHORT:
            return tuple(whole)
        return tuple(self.first + round(step * (len(whole) - 1) / (SHORT - 1)) for step in range(SHORT))

    def places(self, levels: tuple[int, ...]) -> Iterator[MapPlace]:
        """Lane by lane, from the easiest on."""
        for side in self.sides:
            for seed in self.seeds:
                for k in levels:
                    yield MapPlace(self.name, k, side, seed)

    def place(self, k: int, side: str | None = None, seed: int | None = None) -> MapPlace:
        """One member; without a side or a seed, the first.

        Raises:
            SceneError: for a k, side or seed that the family has not.
        """
        self.check(k)
        side = self.sides[0] if side is None else side
        if side not in self.sides:
            raise SceneError(f"--side {side!r}: {self.name} has none of that name; {suggestion(side, [*self.sides])}")
        seed = self.seeds[0] if seed is None else seed
        if seed not in self.seeds:
            told = "draws nothing; leave --seed out" if self.seeds == (0,) else f"has the seeds {self._seeds()}"
            raise SceneError(f"--seed {seed}: {self.name} {told}")
        return MapPlace(self.name, k, side, seed)

    def _seeds(self) -> str:
        return ", ".join(map(str, self.seeds))

    def check(self, k: int) -> None:
        """Refuses a k out of range.

        Raises:
            SceneError: naming the range.
        """
        if not self.first <= k <= self.most:
            raise SceneError(f"k = {k}: {self.name} has k from {self.first} to {self.most}; choose one of them")

    def scene(self, place: MapPlace) -> Scene:
        """The scene of a place, named after it.

        Raises:
            SceneError: for a k out of range.
        """
        self.check(place.k)
        seed = f"-{place.seed}" if place.seed else ""
        made = self.make(place.k, place.side, place.seed)
        return made.with_changes(
            name=f"{self.name}-{place.side}{seed}-{place.k}",
            description=f"{self.summary} Here k = {place.k}; {self.grows}.",
            source=place.show,
        )
