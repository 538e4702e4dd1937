"""What a scene or a run is given beside its things: a tie policy, limits on time and on instants, truths; checked."""

from __future__ import annotations

from typing import Any, cast

from .errors import SceneError
from .lazy import frozen
from .numbers.quantity import Quantity, QuantityLike

# -- What happens when several contacts fall on one instant: the names of the modelling choices.

POLICIES: dict[str, str] = {
    "simultaneous": "..exact.simulation.policies:Simultaneous",
    "sequential": "..exact.simulation.policies:Sequential",
}
"""Where each policy lives, seen from `scenarios`; loaded by the engine that follows it. A new one is its own file, and
one line here."""


@frozen
class TiePolicy:
    """The chosen order of impulses among contacts at one instant.

    Attributes:
        name: one of `POLICIES`: `simultaneous` (all approaching contacts at once, in rounds) or `sequential` (one
            approaching contact at a time).
        seed: for `sequential`: None takes the contacts in scene order, a whole number draws the order from
            that seed.

    >>> TiePolicy.parse("sequential:seed=7")
    TiePolicy(name='sequential', seed=7)
    >>> str(TiePolicy.parse("sequential"))
    'sequential:order=scene'
    """

    name: str = "simultaneous"
    seed: int | None = None

    @staticmethod
    def parse(text: str | TiePolicy) -> TiePolicy:
        """Reads `simultaneous`, `sequential`, `sequential:order=scene` or `sequential:seed=N`.

        Raises:
            SceneError: for any other text.
        """
        if isinstance(text, TiePolicy):
            return text
        if text in POLICIES:
            return TiePolicy(text)
        if text == "sequential:order=scene":
            return TiePolicy("sequential")
        if text == "all-orders":
            raise SceneError(
                "tie_policy 'all-orders' stands for many histories, not one; list them with `truebreak orders SCENE`"
            )
        head, _, seed = str(text).partition("seed=")
        if head == "sequential:" and seed.isascii() and seed.isdigit() and len(seed) <= 18:
            return TiePolicy("sequential", int(seed))
        raise SceneError(
            f"tie_policy {text!r} is not known; choose {', '.join(p for p in POLICIES if p != 'sequential')}, "
            "sequential:order=scene or sequential:seed=N"
        )

    def __str__(self) -> str:
        if self.name != "sequential":
            return self.name
        return f"sequential:{'order=scene' if self.seed is None else f'seed={self.seed}'}"


WALL_KINDS: dict[str, str] = {
    "wall": ".things:Wall",
}
"""Where each kind of wall lives, seen from `scenarios`: what `kind` of a [[wall]] names. A new one is its own file, a
class that extends `Wall`, and one line here; every engine runs it by what it says of itself."""


# -- Settings of scenes and runs, checked: limits on time and on instants, truths.


def checked_truth(place: str, value: object) -> bool:
    """True or false.

    Raises:
        SceneError: for anything else; `place` says where.
    """
    if not isinstance(value, bool):
        raise SceneError(f"{place} = {value!r} is not true or false")
    return value


ELASTIC = Quantity.of(1)
"""The restitution of contacts that lose no energy."""


def checked_restitution(value: QuantityLike) -> Quantity:
    """A coefficient of restitution.

    Raises:
        SceneError: unless it is an exact number from 0 to 1.

    >>> checked_restitution("9/10")
    Quantity('9/10')
    """
    try:
        found = Quantity.of(value)
    except SceneError as error:
        raise SceneError(f"restitution = {error}") from None
    if found.sign() < 0 or (ELASTIC - found).sign() < 0:
        raise SceneError(f"restitution = {found.brief()}: is not in 0 to 1; write a number from 0 to 1")
    return found


def checked_gravity(value: Any) -> tuple[Quantity, Quantity] | None:
    """A uniform acceleration; None for none, or for one of zero.

    Raises:
        SceneError: unless it is two exact numbers.

    >>> checked_gravity([0, "-981/100"]), checked_gravity([0, 0])
    ((Quantity('0'), Quantity('-981/100')), None)
    """
    if value is None:
        return None
    if not isinstance(value, (list, tuple)) or len(cast("list[Any]", value)) != 2:
        raise SceneError(f"gravity = {value!r}: must be two numbers; write gravity = [0, -10]")
    try:
        gx, gy = (Quantity.of(part) for part in cast("list[Any]", value))
    except SceneError as error:
        raise SceneError(f"gravity: {error}") from None
    return None if gx.sign() == 0 == gy.sign() else (gx, gy)


def positive_count(key: str, value: Any) -> int | None:
    """A limit on a number of instants.

    Raises:
        SceneError: unless it is None or a whole number from 1.
    """
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise SceneError(f"{key} = {value!r}: must be a whole number from 1")
    return value


def positive_time(key: str, value: QuantityLike | None) -> Quantity | None:
    """A time limit.

    Raises:
        SceneError: unless it is None or an exact number above zero.
    """
    if value is None:
        return None
    try:
        time = Quantity.of(value)
    except SceneError as error:
        raise SceneError(f"{key} = {error}") from None
    if time.sign() <= 0:
        raise SceneError(f"{key} = {time.brief()}: must be above zero")
    return time
