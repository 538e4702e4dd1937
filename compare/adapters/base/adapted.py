"""What every adapter has: the version of its package among its settings, and checks of its parameters."""

from __future__ import annotations

import math
from importlib.metadata import PackageNotFoundError, version
from typing import Any, ClassVar

from ....scenarios.errors import SceneError
from ...foreign.runs.recorded import Playing


class Adapted(Playing):
    """An engine of others, adapted. `name` is that of its extra, too.

    Attributes:
        distribution: what the package index calls its package.
        pair_microseconds: what an event costs it for each pair of circles, where it looks at all of them; measured.
    """

    distribution: ClassVar[str]
    pair_microseconds: ClassVar[float] = 0.0

    @property
    def step(self) -> float | None:
        """No time step, but for a `SteppedAdapter`."""
        return None

    @property
    def parameters(self) -> dict[str, Any]:
        """The fields, and the version of the package."""
        return {**super().parameters, self.distribution: version_of(self.distribution)}

    def check_positive(self, key: str) -> None:
        """Refuses a parameter that is not above zero, or not finite."""
        if not 0 < getattr(self, key) < math.inf:
            raise SceneError(f"engine {self.name!r}: {key} = {getattr(self, key)!r}: must be above zero, and finite")

    def check_count(self, key: str) -> None:
        """Refuses a parameter that is no whole number from 1."""
        value = getattr(self, key)
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise SceneError(f"engine {self.name!r}: {key} = {value!r}: must be a whole number from 1")


def version_of(distribution: str) -> str:
    """The version of a package, such as `2.3.10`; "not installed" where there is none.

    >>> version_of("no-such-package")
    'not installed'
    """
    try:
        return version(distribution)
    except PackageNotFoundError:
        return "not installed"
