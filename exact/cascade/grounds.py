"""What the rungs of the cascade decide from."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ...scenarios.lazy import frozen
from ...scenarios.scene import Scene
from ..predicates.ties import TieRule
from ..replay.contact import Link
from ..replay.refinable import RefinableState
from ..replay.steps import Step
from ..symmetry.log_symmetry import LogSymmetry
from ..symmetry.retrace import Retrace


@frozen
class Grounds:
    """One run, as its rungs see it.

    Attributes:
        scene: what runs.
        state: its state, refinable.
        steps: its log.
        retrace: what the way back knows of the way out.
        log: what the form of the past proves.
        rule: what is taken for a zero that is not proved.
        max_bits: the precision beyond which an undecided sign stays so.
        work: what one question may cost before it is undecided.
        catch_up: brings what is known of the past up to the end of the log.
        rise: computes the state again with twice the bits; told why.
        spend: told of work done.
        where: how far the run is, as a person reads it.
        name: a contact as a person reads it.
    """

    scene: Scene
    state: RefinableState
    steps: Sequence[Step]
    retrace: Retrace
    log: LogSymmetry
    rule: TieRule
    max_bits: int
    work: int
    catch_up: Callable[[], None]
    rise: Callable[[str], None]
    spend: Callable[[int], None]
    where: Callable[[], str]
    name: Callable[[Link], str]
