"""Runs of every kind, short enough to be certified in a test."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any

from fuzz.generators import case_of

from truebreak.compare.certificate import certificate_of
from truebreak.exact import ExactEngine
from truebreak.scenarios import Circle, Scene, catalogue
from truebreak.scenarios.trajectory import Trajectory

BUILT = (
    ("lee", 5),
    ("cradle", 5),
    ("galperin:n=1", 40),
    ("gas:n=6,seed=3", 20),
    ("rack:rows=3,gap=0", 12),
    ("rack:rows=2,gap=1/50", 12),
    ("inscribed:n=4", 12),
    ("lorentz", 12),
    ("corner:angle=60", 10),
)
"""Scenes of the catalogue, and how many events of them."""

COINCIDENCES = (
    ("instant", 1), ("graze_blow", 0), ("raft", 2), ("slide", 1), ("rim_instant", 1), ("entry_ties", 1), ("on_rim", 0),
    ("pressed", 1), ("mirrored", 0), ("ring", 0), ("twins", 2), ("returns", 1), ("ends", 1), ("home", 1),
    ("couples", 24), ("pits", 19), ("points", 0),
)  # fmt: skip
"""Kinds and seeds of the fuzz (tests/fuzz), whose scenes are made of coincidences."""

FUZZ_EVENTS = 12


@cache
def built(spec: str, events: int | None = None, policy: str | None = None) -> Trajectory:
    """The run of a scene of the catalogue."""
    scene = catalogue.build(spec)
    scene = scene if policy is None else scene.with_changes(tie_policy=policy)
    return ExactEngine().run(scene, events=events)


@cache
def coincidence(kind: str, seed: int) -> Trajectory:
    """The run of a case of the fuzz."""
    case = case_of(kind, seed)
    events = min(case.events or FUZZ_EVENTS, FUZZ_EVENTS)
    return ExactEngine(work=300_000).run(case.scene, until=case.until, events=events)


def rows(n: int, masses: tuple[int, int], **settings: Any) -> Scene:
    """Two rows of n discs side by side, a blow passing along both at once; one may be heavier throughout."""
    discs = [
        Circle(4 * k, f"{50 * row} + {k}/7", vx=0 if k else 1, m=m, id=f"{'ab'[row]}{k}")
        for row, m in enumerate(masses)
        for k in range(n)
    ]
    return Scene(discs, **settings)


@cache
def there_and_back(heavier: int = 1) -> Trajectory:
    """Two rows and back: ties by isometry or in exact numbers, ties by the way back, the return."""
    return ExactEngine().run(rows(4 if heavier > 1 else 5, (1, heavier), reverse_at=50))


Kinds = dict[str, Callable[[], Trajectory]]


def kinds() -> Kinds:
    """Runs of every kind, by name; none is made before it is called for."""
    found: Kinds = {f"{spec}@{events}": partial(built, spec, events) for spec, events in BUILT}
    found |= {f"{kind}-{seed}": partial(coincidence, kind, seed) for kind, seed in COINCIDENCES}
    for policy in ("sequential", "sequential:seed=7"):
        found[f"rack {policy}"] = partial(built, "rack:rows=3,gap=0", 8, policy)
    found |= {"there and back": there_and_back, "there and back, one heavier": partial(there_and_back, 2)}
    meet = [Circle(0, 0, vx=1), Circle(4, 1), Circle(20, 0)]
    found["the end at a contact"] = lambda: ExactEngine().run(Scene(meet), until="4 - sqrt(3)")
    found["the reversal at a contact"] = lambda: ExactEngine().run(Scene(meet, reverse_at="4 - sqrt(3)"))
    touch = [Circle(0, 0, vx=-1), Circle(2, 0, vx=1), Circle(8, "1/7")]
    found["touching at both ends"] = lambda: ExactEngine().run(Scene(touch, reverse_at=20))
    return found


@cache
def samples() -> dict[str, dict[str, Any]]:
    """Certificates of all of these, by name."""
    return {name: certificate_of(run()) for name, run in kinds().items()}
