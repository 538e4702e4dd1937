"""What tells that the exact engine is right, and is not the exact engine: a checked certificate, and a closed form."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ....scenarios.errors import SceneError
from ....tools.verify import BROKEN
from ...alignment.align import UNKNOWING
from ...certificate import certificate_json
from ...certificate.certified import Certified, certified, verdict
from .marks import MapMark

if TYPE_CHECKING:
    from ....scenarios.trajectory import Trajectory
    from ..family import Family, MapPlace

VERIFIED, REFUTED, NOT_DECIDED = 0, 1, 4
"""Exit codes of the checker."""

MOST_TIMES = 16
"""By how much more bits a certificate is checked, where its own do not tell."""


@dataclass(frozen=True)
class Testimony:
    """What is said of a certified run by others.

    Attributes:
        mark: `right` only if the checker proves the whole run again, and no closed form contradicts it.
        told: the checker's sentence, or what is amiss.
        closed_form: whether the outcome is that of the family's closed form; None where there is none.
    """

    mark: MapMark
    told: str
    closed_form: bool | None


def witness(run: Trajectory, family: Family, place: MapPlace) -> Testimony:
    """Has a run of the exact engine checked.

    Its certificate goes to `tools/verify.py`, a program of its own, which shares no decision with the engines: it
    proves every contact, impulse and miss again, or refuses.

    >>> from truebreak.compare.stress.table import family
    >>> from truebreak.exact import ExactEngine
    >>> one = family("near-ties")
    >>> place = one.place(20)
    >>> found = witness(ExactEngine().run(one.scene(place)), one, place)
    >>> found.mark.value, found.told.partition(";")[0], found.closed_form
    ('right', 'verified: 4 events, to the end: quiet', True)
    """
    if run.stop.reason in UNKNOWING:
        return Testimony(MapMark.UNDECIDED, run.stop.message, None)
    fits = None if family.known is None else family.known(run, place.k, place.side, place.seed)
    try:
        found = certified(run)
    except SceneError as error:
        return Testimony(MapMark.UNCHECKED, str(error), fits)
    except AssertionError as error:  # the writer of certificates is itself refuted
        return Testimony(MapMark.WRONG, str(error), fits)
    except BROKEN as error:  # numbers that certificates do not reach
        return Testimony(MapMark.UNCHECKED, f"no certificate: {type(error).__name__}: {error}", fits)
    if found.code == REFUTED:
        return Testimony(MapMark.WRONG, found.sentence, fits)
    if fits is False:
        return Testimony(MapMark.WRONG, "its outcome is not that of the closed form", fits)
    found = with_more_bits(found)
    return Testimony(MapMark.RIGHT if found.code == VERIFIED else MapMark.UNCHECKED, found.sentence, fits)


def with_more_bits(found: Certified) -> Certified:
    """A certificate whose own bits decide nothing, checked with more of them; what the checker proves is as certain.

    Bits are how finely the checker counts, and no part of what it is told.
    """
    told, factor = json.loads(found.text), 1
    while found.code == NOT_DECIDED and factor < MOST_TIMES:
        factor *= 2
        finer = {**told, "bits": factor * told["bits"]}
        code, sentence = verdict(certificate_json(finer))
        found = Certified(found.text, code, f"{sentence} (with {factor} times its bits)")
    return found
