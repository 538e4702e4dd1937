"""No cause that a comparison names is refuted by another run; false ones are, each by the run that it is about."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from importlib.util import find_spec
from types import SimpleNamespace
from typing import Any, cast

import pytest
from causes_known import FAMILIES, STRUCK, history
from faults import Invent, Made
from other_runs import Runs, rounded_scene
from polygon_scenes import scene_of as polygon_scene
from refuting import (
    ARITHMETIC,
    CAMPAIGNS,
    FLIGHTS,
    IMPACTS,
    INPUT,
    ITERATIONS,
    LATENESS,
    LAW,
    MISSED,
    PHANTOM,
    RULES,
    STEP,
    SURVEYED,
    TIE,
    Job,
    Said,
    Share,
    account,
    campaign,
    placements,
    refute,
    said_of,
    tried,
)
from segment_scenes import scene_of as segment_scene

from truebreak.compare import compare
from truebreak.compare.candidate import Candidate
from truebreak.compare.causes.given_scene import rounded
from truebreak.compare.engines import engine as engine_named
from truebreak.scenarios import Scene, SceneError, catalogue


def refuted(outcomes: Any) -> str:
    """What is refuted, a line each."""
    return "\n".join(f"{o.label} {o.engine}: {r.claim}: {r.because}" for o in outcomes for r in o.refutations)


@pytest.mark.slow
@pytest.mark.parametrize("name", CAMPAIGNS)
def test_no_cause_that_is_named_is_refuted(name: str) -> None:
    against = refuted(campaign([name]))
    assert not against, against


@pytest.mark.parametrize(
    ("spec", "engine"),
    [
        ("gas:n=8,seed=8488,size=10", "rounded:bits=12"),  # input rounding brings about a hit, after another contact
        ("rack:rows=4,gap=0", "rounded:bits=16"),  # from the engine's own state the exact law has its contacts, later
        ("gas:n=4,seed=2491", "quad"),  # a wall that one of the two flies from
    ],
)
def test_no_cause_that_was_refuted_before_is_named(spec: str, engine: str) -> None:
    outcome = tried(Job(spec, catalogue.build(spec), engine))
    assert outcome.event is not None
    assert outcome.causes
    assert not outcome.refutations, refuted([outcome])


@pytest.mark.parametrize(
    ("seed", "engine"),
    [
        (70214, "single"),  # carried out by the exact run's contacts the rounded scene misses; run freely it does not
        (70309, "rounded:bits=24"),
    ],
)
def test_what_changes_the_decision_among_segments_does_so_in_a_free_run(seed: int, engine: str) -> None:
    """What hits a face may hit its end, or another face, when it comes there a little aside."""
    scene = segment_scene(seed)
    assert scene is not None
    outcome = tried(Job(f"segments {seed}", scene, engine, 60))
    assert outcome.causes
    assert INPUT not in outcome.suffices
    assert not outcome.refutations, refuted([outcome])


def test_a_thing_that_a_circle_just_leaves_is_no_meeting_that_comes_first() -> None:
    """pymunk meets the segment again a step later; that the exact flight touches it as it begins says nothing."""
    scene = segment_scene(71201)
    assert scene is not None
    outcome = tried(Job("segments 71201", scene, "pymunk:dt=1/256", 24))
    assert outcome.causes == ("errors of its steps",)
    assert INPUT not in outcome.suffices
    assert not outcome.refutations, refuted([outcome])


def test_the_refuter_rounds_every_number_of_a_scene_as_the_engine_is_given_it() -> None:
    scenes = [segment_scene(70214), segment_scene(70309), polygon_scene(70287)]
    for scene in filter(None, scenes):
        assert rounded_scene(scene, 24).digest == rounded(scene, 24).digest
    runs = [Runs(s, engine_named("double"), compare(s, ["double"], events=60).candidates[0]) for s in scenes[2:] if s]
    assert [run.input for run in runs] == ["same"]


def test_the_margin_at_a_wall_is_a_speed() -> None:
    """A circle that one run alone brings to a wall has no distance to it: every flight towards a wall comes there."""
    found = compare(catalogue.build("gas:n=4,seed=2491"), [engine_named("quad")]).candidates[0].margin
    assert found is not None
    assert (found.distance, found.gap, found.ratio) == (None, None, None)
    assert found.speed is not None
    assert found.speed[1] < 0


def test_no_cause_of_a_row_that_touches_is_refuted() -> None:
    jobs = [Job(scene.name, scene, name) for scene in placements()[:24] for name in ("double", "single")]
    against = refuted(map(tried, jobs))
    assert not against, against


SAMPLE = [
    ("rack:rows=3", "pymunk:dt=1/64", 10),
    ("rack:rows=3,gap=1/50", "pymunk:dt=1/256", 20),
    ("gas", "double", 200),
    ("gas:n=5,seed=3,mixed=yes", "single", 80),
    ("near-tie:k=6", "single", None),
    ("near-tie:k=40", "double", None),
    ("pinball", "double", 40),
    ("inscribed", "single", 12),
    ("gas", "single", 220),
    ("lorentz", "double", 220),
    ("pinball", "quad", 220),
    ("grazing", "pymunk:dt=1/1024", 24),
]


@pytest.mark.parametrize(("spec", "name", "events"), SAMPLE)
def test_no_cause_of_these_is_refuted(spec: str, name: str, events: int | None) -> None:
    against = refuted([tried(Job(spec, catalogue.build(spec), name, events))])
    assert not against, against


# -- the refuter's power: claims that are false are refuted, claims that are true are not


@cache
def candidate(scene: Scene, name: str, events: int | None = None) -> Candidate:
    """A run compared, without its causes."""
    limits: dict[str, Any] = {} if events is None else {"events": events}
    return compare(scene, [engine_named(name)], causes=False, **limits).candidates[0]


def claimed(*kinds: str) -> Said:
    """What a report says that names these."""
    return Said(kinds, frozenset(kinds) if len(kinds) == 1 else frozenset())


AGAINST = [
    # the exact run in doubles lacks the same contact: it is the input, and nothing else
    ("struck", "double", INPUT, False),
    ("struck", "double", ARITHMETIC, True),
    ("struck", "double", TIE, True),
    ("struck", "double", LAW, True),
    ("struck", "double", PHANTOM, True),
    ("near-tie:k=40", "double", INPUT, False),
    ("near-tie:k=40", "double", LAW, True),
    ("near-tie:k=40", "double", ARITHMETIC, True),
    ("near-tie:k=40", "double", STEP, True),
    # in 24 bits the exact run of this gas passes its first divergence in 12 bits
    ("gas:n=4,seed=1", "rounded:bits=12", LAW, True),
    ("gas:n=4,seed=1", "rounded:bits=12", TIE, True),
    # a step that is too long
    ("near-tie:k=3", "pymunk:dt=1/64", STEP, False),
    ("near-tie:k=3", "pymunk:dt=1/64", LATENESS, False),
    ("near-tie:k=3", "pymunk:dt=1/64", INPUT, True),
    ("near-tie:k=3", "pymunk:dt=1/64", ARITHMETIC, True),
    ("near-tie:k=3", "pymunk:dt=1/64", IMPACTS, True),
    ("near-tie:k=3", "pymunk:dt=1/64", LAW, True),
    ("near-tie:k=3", "pymunk:dt=1/64", TIE, True),
    ("near-tie:k=3", "pymunk:dt=1/64", MISSED, True),
    ("near-tie:k=3", "pymunk:dt=1/64", ITERATIONS, True),
    # a step that nothing is to blame on: 10**-40 is out of reach for any
    ("near-tie:k=40", "pymunk:dt=1/64", STEP, True),
    # a tie that doubles keep by another policy
    ("lee:tie=sequential:order=scene", "pymunk", TIE, False),
    ("lee:tie=sequential:order=scene", "pymunk", INPUT, True),
]


@pytest.mark.parametrize(("spec", "name", "claim", "false"), AGAINST)
def test_a_false_claim_is_refuted_and_a_true_one_is_not(spec: str, name: str, claim: str, false: bool) -> None:
    scene = STRUCK if spec == "struck" else catalogue.build(spec)
    found = candidate(scene, name, 60 if spec.startswith("gas") else None)
    assert found.verdict == "diverged"
    against = refute(scene, engine_named(name), found, claimed(claim))
    assert bool(against) == false, against


TRIED = (INPUT, IMPACTS, LAW, TIE, PHANTOM, MISSED, STEP, ITERATIONS)


@pytest.mark.slow
def test_of_the_cases_that_are_known_no_true_claim_is_refuted_and_most_false_ones_are() -> None:
    """What cannot be refuted by a run is mostly arithmetic, of engines in which something else happens as well."""
    false, refuted_false, refuted_true = 0, 0, []
    for known in [known for family in FAMILIES.values() for known in [*family()][::2]]:
        engine = engine_named(known.engine) if isinstance(known.engine, str) else known.engine
        limits: dict[str, Any] = {} if known.events is None else {"events": known.events}
        runs = Runs(known.scene, engine, compare(known.scene, [engine], causes=False, **limits).candidates[0])
        for kind in TRIED:
            against = [r for rule in RULES for r in rule(runs, claimed(kind), {kind})]
            if kind in known.never - known.main:
                false, refuted_false = false + 1, refuted_false + bool(against)
            elif known.main == {kind} and not known.all_of and against:
                refuted_true.append((known.name, against))
    assert not refuted_true
    assert false > 200
    assert refuted_false > 0.85 * false, (refuted_false, false)


def test_a_phantom_among_the_impulses_of_one_instant_is_not_taken_for_a_real_contact() -> None:
    scene = next(s for s in placements() if candidate(s, "double").verdict == "diverged")
    assert not refute(scene, engine_named("double"), candidate(scene, "double"), claimed(PHANTOM))


def test_a_refused_scene_is_evidence_of_nothing() -> None:
    """Rounded to doubles, two discs of this row overlap: no run shows the rounding of the input to be enough."""
    scene = next(s for s in placements() if candidate(s, "double").verdict == "diverged" and overlaps(s))
    (against,) = refute(scene, engine_named("double"), candidate(scene, "double"), claimed(INPUT))
    assert against.rule == "refused scene"


def overlaps(scene: Scene) -> bool:
    """Whether it is no scene in doubles."""
    try:
        rounded_scene(scene, 53)
    except SceneError:
        return True
    return False


@dataclass
class Accounted:
    """A diagnosis by shares."""

    causes: tuple[Any, ...]
    shares: list[Any]
    displacement: float | None = 2.0
    closed: bool = True
    finding: str = "without it and 1,002 more below rounding nothing else differs"


@dataclass
class Entry:
    """One entry of its account."""

    cause: Any
    displacement: float
    share: float


def test_both_forms_of_a_diagnosis_are_read() -> None:
    name = SimpleNamespace(value="Simultaneous collisions")
    rows = [(INPUT, 1.5, 0.75, "run"), (name, 0.5, 0.25, "run")]
    for entries in (rows, [Entry(*row[:3]) for row in rows]):
        said = said_of(cast(Any, SimpleNamespace(diagnosis=Accounted((INPUT,), entries))))
        assert said.causes == (INPUT,)
        assert said.suffices == {INPUT}
        assert said.shares == (Share(INPUT, 1.5, 0.75, "run"), Share(TIE, 0.5, 0.25, "run"))
        assert (said.displacement, said.closed, said.without) == (2.0, True, 1003)
    both = said_of(cast(Any, SimpleNamespace(diagnosis=Accounted((INPUT, name), []))))
    assert (both.causes, both.suffices) == ((INPUT, TIE), frozenset())
    none = said_of(cast(Any, SimpleNamespace(diagnosis=Accounted(("not determined",), [], None, False, ""))))
    assert (none.causes, none.suffices, none.without) == ((), frozenset(), 0)


def test_an_account_that_does_not_add_up_is_refuted() -> None:
    shares = (Share(INPUT, 3e-3, 0.6), Share(IMPACTS, 3e-3, 0.6), Share(FLIGHTS, -1e-3, -0.2))
    right = Said((INPUT,), frozenset(), shares, 5e-3, True)
    assert not [*account(right)]
    for wrong in (
        Said((INPUT,), frozenset(), shares[:2], 5e-3, True),
        Said((INPUT,), frozenset(), (*shares[:2], Share(FLIGHTS, -1e-3, 0.2)), 5e-3, True),
        Said((FLIGHTS,), frozenset(), shares, 5e-3, True),
        Said((INPUT,), frozenset(), shares, 4.9e-3, True),
        Said((ARITHMETIC,), frozenset({ARITHMETIC}), (Share(ARITHMETIC, 0.0, None),)),
    ):
        assert [*account(wrong)], wrong


def test_a_phantom_is_alone_only_where_nothing_else_has_changed() -> None:
    """One impulse of 2**-50 too many changes nothing in a few events; one of 1/10 does."""
    scene = catalogue.build("gas:n=4,seed=21")
    pair = next(p for p in history(scene, (), 30) if {*p} <= {"c1", "c2", "c3", "c4"})
    event = history(scene, (), 30).index(pair)
    for strength, wrong in ((Fraction(1, 2**50), False), (Fraction(1, 2), True)):
        engine = Made((Invent(event, Fraction(0), *pair, strength),))
        found = compare(scene, [engine], events=event + 8, causes=False).candidates[0]
        said = Said((PHANTOM,), frozenset({PHANTOM}), without=1)
        rules = {r.rule for r in refute(scene, engine, found, said)}
        assert ("something else" in rules) == wrong, (strength, rules)


GAS = (-0.1889488757714378, -0.05624345769)
"""What moves the first divergence of `double` in a gas: the rounding of the input, to the first order; the engine."""


@pytest.mark.parametrize(
    ("moved", "displacement", "rules"),
    [
        (GAS[0], GAS[1], set()),
        (-GAS[0], -GAS[1], set()),
        (GAS[0] / 2, GAS[1], {"tangent"}),
        (GAS[0], GAS[1] * 1.5, {"displacement"}),
        (GAS[0], GAS[1] / 2, {"displacement"}),
    ],
)
def test_an_account_is_held_to_the_states_and_to_a_nearby_run(
    moved: float, displacement: float, rules: set[str]
) -> None:
    scene = catalogue.build("gas")
    rest = displacement - moved
    shares = (
        Share(INPUT, moved, moved / displacement, "tangent"),
        Share(IMPACTS, rest, rest / displacement, "run"),
    )
    found = refute(
        scene,
        engine_named("double"),
        candidate(scene, "double", 200),
        Said((), frozenset(), shares, displacement, True),
    )
    assert {r.rule for r in found} == rules, found


def test_the_engines_of_others_are_those_that_are_installed() -> None:
    asked = {job.engine for job in CAMPAIGNS["survey"]()}
    assert asked == {name for name, module in SURVEYED.items() if find_spec(module) is not None}
