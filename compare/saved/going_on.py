"""Goes on from runs that were saved, or that ended too soon."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ...exact.exact_engine import NOT_ITS_LOG, ExactEngine, tape_of
from ...scenarios.errors import SceneError
from ...scenarios.trajectory import Trajectory
from .run_file import load_run

if TYPE_CHECKING:
    from ...scenarios.numbers.quantity import QuantityLike
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import OnProgress


@dataclass(frozen=True)
class GoingOn(ExactEngine):
    """The exact engine, with what it has of one run already.

    Attributes:
        earlier: that run.
        where: the file that it is from, as errors name it.
    """

    earlier: Trajectory = field(kw_only=True, repr=False)
    where: str | None = field(kw_only=True, default=None, repr=False)

    @classmethod
    def after(cls, earlier: Trajectory, where: str | None = None, **settings: Any) -> GoingOn:
        """The engine of a run, with some settings in place of its own; None leaves one as it is.

        Raises:
            SceneError: for a run that cannot be gone on with.
        """
        tape_of(earlier)
        given = {**earlier.parameters, **{k: v for k, v in settings.items() if v is not None}}
        return cls(**given, earlier=earlier, where=where)

    @property
    def limits(self) -> tuple[str | None, int | None]:
        """The time and the number of instants at which the run was to end."""
        limits = tape_of(self.earlier)[1].limits
        return None if limits.until is None else limits.until.text(), limits.events

    def run(
        self,
        scene: Scene,
        *,
        until: QuantityLike | None = None,
        events: int | None = None,
        progress: OnProgress | None = None,
    ) -> Trajectory:
        """As `ExactEngine.resume`."""
        try:
            return self.resume(self.earlier, until=until, events=events, progress=progress)
        except SceneError as error:
            if str(error) != NOT_ITS_LOG or self.where is None:
                raise
            raise SceneError(f"{self.where}: {error}") from None


def resume(
    run: Trajectory | str | os.PathLike[str],
    *,
    until: QuantityLike | None = None,
    events: int | None = None,
    work: int | None = None,
    progress: OnProgress | None = None,
) -> Trajectory:
    """Goes on from a run of the exact engine, or from the file of one, as if it had never ended.

    Args:
        run: the run, or the path of a file that `save_run` wrote.
        until, events: as in `Engine.run`; with neither, the limits that the run had hold on.
        work: what one question may cost now, in place of what it could cost then.
        progress: as in `Engine.run`.

    Raises:
        SceneError: for a file that is no saved run or is damaged, a run that has no log to go on from, and limits
            that are not above zero.

    >>> from truebreak.scenarios import catalogue
    >>> short = ExactEngine().run(catalogue.build("lee"), events=1)
    >>> resume(short, until=3).stop.reason.name
    'HORIZON'
    """
    earlier, where = (run, None) if isinstance(run, Trajectory) else (load_run(run), os.fspath(run))
    engine = GoingOn.after(earlier, where, work=work)
    return engine.run(earlier.scene, until=until, events=events, progress=progress)
