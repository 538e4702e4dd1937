"""Results as JSON objects: for each class the keys that it has there, each an attribute of it, or computed."""

# `schema.py` makes the JSON Schemas of it, by types and docstrings. Numbers are nearest doubles; null: not known.

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cache
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from ...scenarios.numbers.quantity import real
from ..deadline import Clock
from ..files.amounts import bounds, double, plain
from ..files.exact_text import ExactTexts

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Assumption, Contact, Event, Pocketing, State, Stop, Tie, TieProof, Trajectory
    from ..alignment.align import Separation
    from ..audit.audit import Audit
    from ..candidate import Candidate
    from ..chaos.certified_chaos import Chaos, Grown
    from ..chaos.horizon import Horizon
    from ..chaos.spectrum import Rate, Spectrum
    from ..comparison import Comparison
    from ..grids.survival import Summary, Uncertainty
    from ..orders.all_orders import Leaf, OrderTree
    from ..outcomes.permitted import PatternRelation, PermittedPatterns
    from ..shadowing.shadows import Proof, Shadow
    from ..tangent.growth import CertifiedGrowth
    from .answers import Substitute
    from .changes import Change

REPORTED_SAMPLES = 50
"""Times at which the JSON of a comparison gives the separation."""

CONVERGENCE_POINTS = 20
"""How many estimates of the largest exponent show how it converges."""

FORMS = {
    "scenarios.scene:Scene": "name digest tie_policy",
    "scenarios.trajectory:Stop": "reason message",
    "scenarios.trajectory:Assumption": "event question proof bound",
    "scenarios.trajectory:Tie": "contacts proof proved=proof.proved bound?",
    "scenarios.trajectory:Event": "index time contacts impulses ties? coupled? rests_on?",
    "scenarios.trajectory:Reversal": "after time",
    "scenarios.trajectory:Pocketing": "circle pocket time",
    "scenarios.trajectory:Settling": "circle wall time since? other?",
    "scenarios.trajectory:State": "time circles",
    "scenarios.trajectory:CircleState": "id x y vx vy",
    "scenarios.trajectory:Trajectory": "scene engine stop ending? certified collisions events final plan reversal? "
    "assumptions? notes? pocketed? settled?=settlings definitions?",
    "compare.audit.audit:Audit": "kept reason impacts flights sentence fit first violations counts defects declared "
    "phantoms horizon bounces?",
    "compare.audit.fits:BounceRatios": "asked mean low high count spread",
    "compare.audit.residual:Violation": "kind event time bodies size bound=room",
    "compare.audit.fits:Fit": "description=what kind value spread explained of",
    "compare.audit.residual:Defect": "kind size order finest step of_step",
    "compare.causes.diagnosis:Diagnosis": "names=causes displacement closed continuations=runs evidence=finding "
    "sufficient experiments",
    "compare.causes.diagnosis:Experiment": "cause suffices displacement share result",
    "compare.causes.diagnosis:Margin": "time=gap ulps distance speed position_error=error ratio "
    "growth_bits_per_event=growth",
    "compare.alignment.instants:Divergence": "event time body expected got kind expected_time got_time",
    "compare.alignment.align:Separation": "times max=largest final largest=maximum circle",
    "compare.candidate:Candidate": "engine parameters=trajectory.parameters verdict laws "
    "events_agreed=alignment.agreed first_divergence=alignment.divergence cause margin causes=diagnosis "
    "reordered=alignment.reordered split=alignment.split alternatives position_error outcomes pattern "
    "changed_outcomes=changed outcomes_until=until outcomes_expected return_error=return_miss stop=trajectory.stop "
    "seconds? rests_on",
    "compare.report.answers:Substitute": "engine events_agreed right run_no_further cost cost_in",
    "compare.outcomes.permitted:PermittedPatterns": "by_policy all_orders=orders complete orders_followed=followed "
    "realisable nearby_tried=tried",
    "compare.report.changes:Change": "from=before to=after verdict_changed=verdict laws_changed=laws "
    "divergence_changed=divergence outcomes_changed=outcomes sentence",
    "compare.report.documents:PatternRow": "relation policy witness witness_certificate?",
    "compare.report.documents:Reference": "engine parameters events stop certified assumptions outcomes return_error "
    "notes seconds? independently_checked? checker? certificate?",
    "compare.comparison:Comparison": "verdict sentence scene span reference candidates patterns=permitted left_out=cut "
    "changes?",
    "compare.orders.all_orders:Branching": "instant offered chosen",
    "compare.orders.all_orders:Leaf": "decisions seed stop=trajectory.stop collisions=trajectory.collisions impulses "
    "final",
    "compare.orders.all_orders:OrderTree": "scene complete cap merged unproved reordered sampled stop? outcomes",
    "compare.tangent.growth:CertifiedGrowth": "events low high precision=bits",
    "compare.chaos.certified_chaos:Grown": "event time bits",
    "compare.chaos.spectrum:Rate": "value low high blocks",
    "compare.chaos.spectrum:Spectrum": "dimension exponents pairing volume",
    "compare.chaos.horizon:EventTime": "event time",
    "compare.chaos.horizon:Seen": "verdict at=place",
    "compare.chaos.horizon:Horizon": "engine model unit_bits=unit expected low high by_exponent observed=seen inside",
    "compare.chaos.certified_chaos:Chaos": "scene events time stop=reference.stop certified=reference.certified "
    "lyapunov convergence spectrum entropy growth horizons exact",
    "compare.grids.survival:Step": "event share low high at_risk",
    "compare.grids.survival:Law": "slope intercept correlation scenes",
    "compare.grids.survival:ChangedShare": "size count total low high",
    "compare.grids.survival:Uncertainty": "shares exponent low high",
    "compare.grids.survival:Summary": "engine verdicts median survival band law changed laws",
    "compare.report.documents:SweepDocument": "settings scenes engines uncertainty failures",
    "compare.grids.bounce_survey:Bounces": "engine asked contact bounces missed mean spread least greatest refused",
    "compare.grids.bounce_survey:BounceSurvey": "versions rows",
    "compare.shadowing.obstacle:Blocked": "kind=obstacle event message",
    "compare.shadowing.obstacle:StartDistance": "position velocity",
    "compare.shadowing.obstacle:Distance": "position velocity time circle",
    "compare.shadowing.shadows:Proof": "digest=scene.digest start run=run_distance reordered certified=run.certified",
    "compare.shadowing.shadows:Shadow": "scene engine events divergence proof obstacle=blocked drift misfits shorter",
}
"""The keys of each class: `key`, or `key=attribute`; with `?` it is left out where it is None. Some are `COMPUTED`."""

BY_VALUE = ("CauseName",)
"""Enumerations that grow: their values are text, which may be any; of others the names, in small letters."""

COMPUTED: dict[str, Callable[[Any, Any], Any]] = {}
"""Keys that are no attributes: `Class.key`, and a function of the object, and of what the document is about."""


def computed(name: str) -> Callable[[Callable[[Any, Any], Any]], Callable[[Any, Any], Any]]:
    """Makes a function a key; its return type is the key's, its docstring the meaning."""

    def put(function: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
        return COMPUTED.setdefault(name, function)

    return put


class Key(NamedTuple):
    """A key of an object: how its value is had, whether it may be left out, whether it is a number of an engine."""

    name: str
    path: str
    of: Callable[[Any, Any], Any]
    optional: bool
    number: bool


@cache
def keys_of(kind: type) -> tuple[Key, ...]:
    """The keys of a class; none of one that has no form.

    >>> from truebreak.scenarios.trajectory import Stop
    >>> [key.name for key in keys_of(Stop)]
    ['reason', 'message']
    """
    own = " ".join(kind.__annotations__) if kind.__module__ == __name__ else ""
    spec = next((FORMS[name] for name in FORMS if name.endswith(f":{kind.__name__}")), own)
    told: list[Key] = []
    for word in spec.split():
        name, _, path = word.partition("=")
        name, optional = name.rstrip("?"), name.endswith("?")
        found, get = COMPUTED.get(f"{kind.__name__}.{name}"), attrgetter(path or name)
        number = found is None and str(getattr(kind, "__annotations__", {}).get(name, "")).startswith("Real")
        told.append(Key(name, path or name, found or (lambda value, _, get=get: get(value)), optional, number))
    return tuple(told)


class Encoder:
    """Makes JSON of what a document is of.

    Args:
        about: what computed keys are told beside the object that they are of.
        texts: collects the exact text of each number, for `..._exact`.
    """

    def __init__(self, about: Any, texts: ExactTexts | None = None) -> None:
        self._about = about
        self._texts = texts

    def __call__(self, value: Any) -> Any:
        """One value.

        >>> from truebreak.scenarios.trajectory import Stop, StopReason
        >>> Encoder(None)({"stop": Stop(StopReason.QUIET, "over"), "size": math.inf})
        {'stop': {'reason': 'quiet', 'message': 'over'}, 'size': None}
        """
        if value is None or isinstance(value, bool | str) or type(value) is int:
            return value
        if isinstance(value, float):
            return double(value)
        if isinstance(value, Enum):
            return value.value if type(value).__name__ in BY_VALUE else value.name.lower()
        if isinstance(value, Mapping):
            return {str(plain(key)): self(item) for key, item in value.items()}
        keys = keys_of(type(value))
        if not keys:
            many = isinstance(value, Sequence | set | frozenset)
            return [self(item) for item in value] if many else plain(value)
        row: dict[str, Any] = {}
        for key in keys:
            part = key.of(value, self._about)
            if part is None and key.optional:
                continue
            if key.number:
                self._put(row, key.name, part)
            else:
                row[key.name] = self(part)
        return row

    def _put(self, row: dict[str, Any], key: str, value: Any) -> None:
        """Puts one number into a row: the nearest double, bounds if it is an interval, exact text if asked for."""
        row[key] = double(value)
        number = real(value)
        interval = bounds(number)
        if interval is not None:
            row[f"{key}_interval"] = list(interval)
        elif self._texts is not None:
            self._texts.put(row, key, number)


def document(name: str, value: Any, about: Any = None, texts: ExactTexts | None = None) -> dict[str, Any]:
    """A whole document, which begins with the name of its schema; computed keys are told what it is about."""
    return {"schema": f"truebreak/{name}", **Encoder(value if about is None else about, texts)(value)}


# -- A run.


@dataclass(frozen=True)
class EngineUsed:
    """An engine, by name, and every parameter, those left at their defaults too."""

    name: str
    parameters: Mapping[str, Any]


@dataclass(frozen=True)
class RestsOn:
    """The event and the kind of proof, which is less than proof, on which what follows rests."""

    event: int
    proof: TieProof

    @classmethod
    def on(cls, assumption: Assumption | None) -> RestsOn | None:
        """What is said of an assumption."""
        return None if assumption is None else cls(assumption.event, assumption.proof)


@computed("Event.ties")
def _event_ties(event: Event, _: Any) -> tuple[Tie, ...] | None:
    """Only where several contacts fell on the instant: which, and how that is known."""
    return event.ties or None


@computed("Event.coupled")
def _event_coupled(event: Event, _: Any) -> bool | None:
    """Only where true: the order of the impulses could matter."""
    return event.coupled or None


@computed("Event.rests_on")
def _event_rests_on(event: Event, run: Trajectory) -> RestsOn | None:
    """Only after a decision of less than proof."""
    return RestsOn.on(run.rests_on(event.index))


@computed("Trajectory.engine")
def _run_engine(run: Trajectory, _: Any) -> EngineUsed:
    """The engine."""
    return EngineUsed(run.engine, run.parameters)


@computed("Trajectory.assumptions")
def _run_assumptions(run: Trajectory, _: Any) -> tuple[Assumption, ...] | None:
    """Only where decisions rest on less than proof: these."""
    return run.assumptions or None


@computed("Trajectory.notes")
def _run_notes(run: Trajectory, _: Any) -> tuple[str, ...] | None:
    """Only where there are any: what the run says of itself."""
    return run.notes or None


@computed("Trajectory.pocketed")
def _run_pocketed(run: Trajectory, _: Any) -> tuple[Pocketing, ...] | None:
    """Only for a scene with pockets: which circle's centre entered which, and when."""
    return run.pocketings if run.scene.pockets else None


@computed("Trajectory.definitions")
def _run_definitions(run: Trajectory, _: Any) -> Mapping[str, str] | None:
    """Only with exact texts of deep values: names for what they share, each defined by those before it."""
    return None


def trajectory_json(trajectory: Trajectory, *, exact: bool = False, watch: Clock | None = None) -> dict[str, Any]:
    """The object that `truebreak run --json` prints.

    Times and coordinates are the nearest doubles; null stands for one beyond the doubles. An engine of
    intervals adds the bounds as `..._interval`.

    Args:
        exact: add each time and coordinate as exact text, under `..._exact`. Values of too many nested roots refer to
            `definitions`, each a text of numbers and of the definitions before it.
        watch: the user's seconds; once they are over, every value that is left does.
    """
    texts = ExactTexts(watch=watch or Clock(None)) if exact else None
    data = document("trajectory-1", trajectory, texts=texts)
    definitions = texts.finish() if texts is not None else {}
    return {**data, "definitions": definitions} if definitions else data


# -- A comparison.


@dataclass(frozen=True)
class Phantoms:
    """Contacts whose impulse is below rounding: how many, the event of the first one, and its approach."""

    count: int
    event: int
    approach: float


@computed("Audit.phantoms")
def _audit_phantoms(audit: Audit, _: Any) -> Phantoms | None:
    """Contacts whose impulse is below rounding."""
    return None if audit.phantoms is None else Phantoms(*audit.phantoms)


@dataclass(frozen=True)
class PatternRow:
    """The class in which a pattern is, the impulse policy and the nearby scene that lead to it, if any do."""

    relation: PatternRelation
    policy: str | None
    witness: Mapping[str, Any] | None
    witness_certificate: Any


@computed("PermittedPatterns.realisable")
def _patterns_realisable(permitted: PermittedPatterns, _: Any) -> tuple[Any, ...]:
    """The patterns of nearby scenes."""
    return tuple(witness.pattern for witness in permitted.witnesses)


@computed("Candidate.cause")
def _candidate_cause(candidate: Candidate, _: Any) -> str | None:
    """Why it diverges, in words; null where that is not determined or was not looked for."""
    return str(candidate.diagnosis) if candidate.diagnosis else None


@computed("Candidate.alternatives")
def _candidate_alternatives(candidate: Candidate, comparison: Comparison) -> tuple[Substitute, ...]:
    """What was run and may stand in its place, those that are right first; none where it agrees."""
    from .answers import substitutes

    return substitutes(comparison, candidate)


@computed("Candidate.position_error")
def _candidate_position_error(candidate: Candidate, _: Any) -> Separation:
    """The largest distance of any circle from where the reference has it, at up to 50 times."""
    return candidate.separation.thinned(REPORTED_SAMPLES)


@computed("Separation.largest")
def _separation_largest(separation: Separation, _: Any) -> float:
    """The largest of all."""
    return separation.maximum


@computed("Candidate.pattern")
def _candidate_pattern(candidate: Candidate, comparison: Comparison) -> PatternRow | None:
    """The class of its pattern; null where patterns are not compared."""
    pattern, permitted = candidate.pattern, comparison.permitted
    if permitted is None or pattern is None or candidate.verdict != "diverged":
        return None
    witness = permitted.witness(pattern)
    proof = None if witness is None or witness.certificate is None else witness.certificate.data()
    scene = None if witness is None else witness.scene.data()
    return PatternRow(permitted.relation(pattern), permitted.policy(pattern), scene, proof)


@computed("Candidate.outcomes_expected")
def _candidate_expected(candidate: Candidate, _: Any) -> Mapping[str, Any] | None:
    """Null, or the reference's outcomes up to where its run ends."""
    return None if candidate.whole else candidate.expected


@computed("Candidate.rests_on")
def _candidate_rests_on(candidate: Candidate, comparison: Comparison) -> RestsOn | None:
    """The assumption of the reference on which the verdict rests; null for none."""
    parted = candidate.alignment.divergence
    event = candidate.alignment.agreed if parted is None else parted.event
    return RestsOn.on(comparison.reference.rests_on(event))


@dataclass(frozen=True)
class Reference:
    """The engine taken as the truth; after a reversal, `return_error` is how far from the start it is at the return.

    With a certificate, `independently_checked` says whether the checker verified it, and `checker` what it said.
    """

    engine: str
    parameters: Mapping[str, Any]
    events: int
    stop: Stop
    certified: bool
    assumptions: tuple[Assumption, ...]
    outcomes: Mapping[str, Any]
    return_error: float | None
    notes: tuple[str, ...]
    seconds: float
    independently_checked: bool | None
    checker: str | None
    certificate: Any


@computed("Comparison.reference")
def _comparison_reference(told: Comparison, _: Any) -> Reference:
    """The engine taken as the truth."""
    run = told.reference
    proof = {} if told.certificate is None else told.certificate.data()
    return Reference(run.engine, run.parameters, len(run.events), run.stop, run.certified and told.certain,
                     run.assumptions, told.outcomes, told.return_miss, run.notes, told.seconds,
                     proof.get("independently_checked"), proof.get("checker"), proof.get("certificate"))  # fmt: skip


@computed("Comparison.sentence")
def _comparison_sentence(comparison: Comparison, _: Any) -> str:
    """The sentence that the report leads with."""
    from .sentences import verdict_sentence

    return verdict_sentence(comparison)


@computed("Comparison.changes")
def _comparison_changes(comparison: Comparison, _: Any) -> tuple[Change, ...] | None:
    """Only of `judge` with several logs: from each to the next."""
    return None


def comparison_json(comparison: Comparison, changes: Sequence[Change] = ()) -> dict[str, Any]:
    """The object that `truebreak compare --json` prints; of `judge`, with the changes from log to log."""
    data = document("comparison-5", comparison)
    return {**data, "changes": Encoder(comparison)(changes)} if changes else data


# -- All orders of one instant.


@dataclass(frozen=True)
class SceneName:
    """A scene, by name, and the SHA-256 of all that decides its history."""

    name: str
    digest: str


@computed("OrderTree.scene")
def _orders_scene(_: OrderTree, about: tuple[Scene, Stop | None]) -> SceneName:
    """What was run."""
    return SceneName(about[0].name, about[0].digest)


@computed("OrderTree.stop")
def _orders_stop(_: OrderTree, about: tuple[Scene, Stop | None]) -> Stop | None:
    """Only where the user's seconds ended the search."""
    return about[1]


@computed("Leaf.impulses")
def _leaf_impulses(leaf: Leaf, _: Any) -> tuple[tuple[Contact, ...], ...]:
    """By instant."""
    return tuple(event.impulses for event in leaf.trajectory.events)


@computed("Leaf.final")
def _leaf_final(leaf: Leaf, _: Any) -> State:
    """The state at the end."""
    return leaf.trajectory.final


def orders_json(scene: Scene, tree: OrderTree, stop: Stop | None = None) -> dict[str, Any]:
    """The object that `truebreak orders --json` prints; with a stop if the search was ended before it was done."""
    return document("orders-2", tree, (scene, stop))


# -- Chaos along one run.


@dataclass(frozen=True)
class Lyapunov:
    """The largest exponent: natural logarithms per unit time, with the 95 % interval; `bits_...` are log2.

    The first `skipped` events are left out; `linear` is what growth that is linear in time would give, and
    `differs_from_zero` whether the estimate is above that.
    """

    value: float
    low: float | None
    high: float | None
    blocks: int
    per_event: Rate
    bits_per_time: float
    bits_per_event: float
    skipped: int
    linear: float
    differs_from_zero: bool


@dataclass(frozen=True)
class Estimate:
    """The largest exponent as of an event."""

    event: int
    time: float
    value: float


@dataclass(frozen=True)
class Growth:
    """How displacements of time 0 grow: at the end enclosed (null for so large a scene), and along the run."""

    certified: CertifiedGrowth | None
    curve: tuple[Grown, ...]


@computed("Chaos.lyapunov")
def _chaos_lyapunov(chaos: Chaos, _: Any) -> Lyapunov:
    """The largest exponent."""
    found, (time, event) = chaos.spectrum, (chaos.spectrum.per_time(), chaos.spectrum.per_event())
    return Lyapunov(time.value, time.low, time.high, time.blocks, event, time.value / math.log(2),
                    event.value / math.log(2), found.skipped, found.linear, found.chaotic)  # fmt: skip


@computed("Chaos.convergence")
def _chaos_convergence(chaos: Chaos, _: Any) -> tuple[Estimate, ...]:
    """How its estimate converges."""
    return tuple(Estimate(*point) for point in chaos.spectrum.running(CONVERGENCE_POINTS))


@computed("Chaos.entropy")
def _chaos_entropy(chaos: Chaos, _: Any) -> Rate | None:
    """The sum of the positive exponents; null where not all were measured."""
    return chaos.spectrum.entropy()


@computed("Chaos.growth")
def _chaos_growth(chaos: Chaos, _: Any) -> Growth:
    """Of displacements."""
    return Growth(chaos.certified, chaos.growth)


@computed("Spectrum.exponents")
def _spectrum_exponents(found: Spectrum, _: Any) -> tuple[Rate, ...]:
    """The largest first, per unit time."""
    return tuple(found.per_time(k) for k in range(found.gains.shape[1]))


@computed("Spectrum.pairing")
def _spectrum_pairing(found: Spectrum, _: Any) -> float | None:
    """The largest sum of an exponent and its partner, 0 in theory; null where not all were measured."""
    return found.pairing()


@computed("Spectrum.volume")
def _spectrum_volume(found: Spectrum, _: Any) -> float | None:
    """The logarithm of the growth of volume, 0 in theory; null where not all were measured."""
    return found.volume()


@computed("Horizon.inside")
def _horizon_inside(horizon: Horizon, _: Any) -> bool | None:
    """Whether it diverges inside the 90 % prediction interval; null where it does not diverge or was not run."""
    return None if horizon.seen is None or horizon.seen.place is None else horizon.holds(horizon.seen.place)


def chaos_json(chaos: Chaos) -> dict[str, Any]:
    """The object that `truebreak chaos --json` prints; exponents are natural logarithms per unit time."""
    return document("chaos-2", chaos)


# -- Shadows.


@dataclass(frozen=True)
class Shorter:
    """The shadow of a shorter beginning, of so many events."""

    events: int
    proof: Proof


@computed("Shadow.scene")
def _shadow_scene(told: Shadow, _: Any) -> SceneName:
    """What was run."""
    return SceneName(told.scene.name, told.scene.digest)


@computed("Shadow.misfits")
def _shadow_misfits(told: Shadow, _: Any) -> tuple[float, ...]:
    """The largest misfit of each round, in bits (log2)."""
    return () if told.refinement is None else told.refinement.misfits


@computed("Shadow.shorter")
def _shadow_shorter(told: Shadow, best: Shadow) -> Shorter | None:
    """The shadow of a shorter beginning; null where none was looked for or found."""
    return None if best is told or best.proof is None else Shorter(best.events, best.proof)


def shadow_json(told: Shadow, best: Shadow | None = None) -> dict[str, Any]:
    """The object that `truebreak shadow --json` prints.

    Args:
        best: the shadow of a shorter beginning, where one was looked for and found.
    """
    return document("shadow-2", told, told if best is None else best)


# -- Sweeps.


@dataclass(frozen=True)
class IntervalCoverage:
    """Of those that diverged and had a predicted interval: how many did inside it, and how many there are."""

    inside: int
    left: int


@dataclass(frozen=True)
class ChangedScenes:
    """Of the scenes whose outcomes were compared: how many changed, of how many, and the 95 % interval of the share."""

    scenes: int
    of: int
    low: float
    high: float


@dataclass(frozen=True)
class LawCounts:
    """In how many runs the laws are kept, in how many they are not, and in how many that is not determined."""

    kept: int
    not_kept: int
    not_determined: int


@dataclass(frozen=True)
class FailedScene:
    """A draw of a scene that came to nothing, and why."""

    scene: int
    attempt: int
    note: str


@dataclass(frozen=True)
class SweepDocument:
    """What was asked, what the rows say together; by outcome, how displacements of several sizes change it."""

    settings: Mapping[str, Any]
    scenes: int
    engines: tuple[Summary, ...]
    uncertainty: Mapping[str, Uncertainty]
    failures: tuple[FailedScene, ...]


@computed("Summary.band")
def _summary_band(summary: Summary, _: Any) -> IntervalCoverage:
    """How the predicted intervals did."""
    return IntervalCoverage(*summary.inside)


@computed("Summary.changed")
def _summary_changed(summary: Summary, _: Any) -> ChangedScenes | None:
    """Changed outcomes; null where none were compared."""
    return None if summary.changed is None else ChangedScenes(*summary.changed)


@computed("Summary.laws")
def _summary_laws(summary: Summary, _: Any) -> LawCounts:
    """The audits of its runs."""
    return LawCounts(*summary.laws)


def sweep_json(
    settings: Mapping[str, Any],
    scenes: int,
    told: Sequence[Summary],
    failures: Sequence[tuple[int, int, str]],
    unsure: Mapping[str, Uncertainty],
) -> dict[str, Any]:
    """The object that `truebreak sweep --json` prints.

    Args:
        unsure: by outcome, how displacements of several sizes change it.
    """
    return document(
        "sweep-2", SweepDocument(settings, scenes, tuple(told), unsure, tuple(FailedScene(*f) for f in failures))
    )
