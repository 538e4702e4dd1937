"""Writes the certificate of a run of the exact engine: its scene, its log instant by instant, its end."""

from __future__ import annotations

import gc
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Annotated, Any, Literal, NotRequired, TypeAlias, TypedDict, TypeVar

from flint import arb

from ...exact.certified.certified_decider import FIRST_BITS
from ...exact.exact_motion import ExactMotion, ExactValue, motion_of
from ...exact.replay.contact import AtWall, places_of
from ...exact.replay.state import Kick, Leave, Lift, Settle, Step
from ...exact.simulation.endings import ENDS
from ...scenarios.disk import InSchema
from ...scenarios.errors import SceneError
from ...scenarios.numbers.quantity import Quantity, Real
from ...scenarios.trajectory import Event, Pocketing, Settling, StopReason, Trajectory
from ...tools.verify import BITS, CIRCLES, FORMAT, Malformed, Refuted, Unsettled, cost
from .isometries import Contact
from .outlines import numbers_of
from .prover import Prover, decimal_text, is_same
from .tower import Exact, exact_number, scene_part, text_of

T = TypeVar("T")

DIGITS = 17
"""Decimals after the point of times and of the final state, unless others are asked for."""

LEAST_BITS = 128
"""Bits tried first for the shortest runs. Others begin with a quarter more than the engine had: in a gas its forms lose
0.79 bits an event, the plain ones 0.96 (docs/how-it-is-exact.md)."""

ENOUGH = 16
"""By how much more bits than the engine had are tried, before a zero is said to have no witness."""

EACH = 4
"""More of them for each instant: where the engine's forms lose none, as on a line, the plain ones lose one or two."""

PLAIN = 64
"""Events of a run that is not followed: a longer one too often has a graze or a zero that wants a witness."""

SHARP, FINE = 96, 2.0**-64
"""Bits in which a plain certificate's numbers are taken where they are not known to `FINE`."""

LONG = 500
"""A run of more instants is followed over its first part, and the bits lost there tell how many the whole takes."""

PART = 16
"""Which part of it that is. (`gas` loses 1,125 bits in its first 1,000 events, and 4,931 in its first 4,500.)"""

ORDER = 512
"""Bits in which times are compared, to say which of two instants comes first, or that they are one."""

MARGIN = 32
"""Bits that a certificate allows beyond those that its writer needed, so that a checker whose intervals are somewhat
wider decides all the same."""


class CertificateError(SceneError):
    """A run of which no certificate can be written."""


# -- The form of a certificate, of which its JSON schema is made. The two checkers read it by code of their own.

NumberText: TypeAlias = Annotated[
    str,
    InSchema("number", pattern="^[+-]?[0-9]+(/[0-9]+)?(\\*r[1-9][0-9]?)*([+-][0-9]+(/[0-9]+)?(\\*r[1-9][0-9]?)*)*$"),
]
"""A fraction, or a sum of products of fractions and of the roots."""

DecimalText: TypeAlias = Annotated[str, InSchema("decimal", pattern="^-?[0-9]+(\\.[0-9]+)?$")]
Place: TypeAlias = Annotated[int, InSchema(minimum=0)]
Roots: TypeAlias = Annotated[list[NumberText], InSchema(maxItems=99)]
Plane: TypeAlias = Annotated[list[NumberText], InSchema(minItems=2, maxItems=2)]

ContactData: TypeAlias = Annotated[tuple[Place, int], InSchema("contact")]
"""A circle, and another circle, or by a number below 0 a pocket; walls, faces and arcs come after the circles."""

ZeroData: TypeAlias = Annotated[
    tuple[
        Literal["gap", "closing", "disc", "speed", "slack", "until", "reverse", "rest"],
        ContactData,
        Literal["back"] | Place,
        ContactData,
    ],
    InSchema("zero", minItems=3),
]
"""What is zero, of which contact, by the way back or which isometry, and of which contact it is the image."""

PushData: TypeAlias = Annotated[tuple[Place, int, NumberText], InSchema("push", minItems=2)]
"""A contact that pushes, with its impulse where that is no matter of course."""


class CircleData(TypedDict):
    """A circle; `w` is 1 over its mass."""

    id: str
    x: NumberText
    y: NumberText
    r: NumberText
    vx: NumberText
    vy: NumberText
    w: NumberText


class WallData(TypedDict):
    """A wall, and how far its two points are apart."""

    id: str
    x0: NumberText
    y0: NumberText
    x1: NumberText
    y1: NumberText
    length: NumberText
    vx: NotRequired[NumberText]
    vy: NotRequired[NumberText]


class PocketData(TypedDict):
    """A pocket."""

    id: str
    x: NumberText
    y: NumberText
    r: NumberText


class SegmentData(TypedDict):
    """A segment, or a side of a polygon, and how far its two points are apart."""

    id: str
    x0: NumberText
    y0: NumberText
    x1: NumberText
    y1: NumberText
    length: NumberText
    r: NumberText
    vx: NotRequired[NumberText]
    vy: NotRequired[NumberText]


class ArcData(TypedDict):
    """An arc; without its two points a whole circle."""

    id: str
    x: NumberText
    y: NumberText
    r: NumberText
    x0: NotRequired[NumberText]
    y0: NotRequired[NumberText]
    x1: NotRequired[NumberText]
    y1: NotRequired[NumberText]


POINTS = ("x0", "y0", "x1", "y1")
AllPoints = InSchema(dependentRequired={key: [other for other in POINTS if other != key] for key in POINTS})


class WrittenScene(TypedDict):
    """The scene."""

    roots: NotRequired[Roots]
    tie_policy: Annotated[str, InSchema(pattern="^(simultaneous|sequential(:order=scene|:seed=[0-9]{1,18})?)$")]
    reverse_after: NotRequired[Annotated[int, InSchema(minimum=1)]]
    reverse_at: NotRequired[NumberText]
    capture: NotRequired[bool]
    restitution: NotRequired[NumberText]
    gravity: NotRequired[Plane]
    settle: NotRequired[Annotated[bool, InSchema(const=True)]]
    circles: Annotated[list[CircleData], InSchema(minItems=1, maxItems=CIRCLES)]
    walls: NotRequired[list[WallData]]
    pockets: NotRequired[list[PocketData]]
    segments: NotRequired[list[SegmentData]]
    arcs: NotRequired[list[Annotated[ArcData, AllPoints]]]


class IsometryData(TypedDict):
    """A map of the plane, and of contacts: which thing goes where."""

    matrix: Annotated[list[NumberText], InSchema(minItems=4, maxItems=4)]
    shift: Plane
    map: list[Annotated[list[int], InSchema(minItems=2, maxItems=2)]]


class MomentData(TypedDict):
    """An instant."""

    time: DecimalText
    exact: NotRequired[NumberText]
    met: NotRequired[Annotated[list[ContactData], InSchema(minItems=1)]]
    turn: NotRequired[Annotated[bool, InSchema(const=True)]]
    rounds: NotRequired[list[Annotated[list[PushData], InSchema(minItems=1)]]]
    enter: NotRequired[list[ContactData]]
    settle: NotRequired[list[ContactData]]
    bounces: NotRequired[list[ContactData]]
    zeros: NotRequired[list[ZeroData]]


class EndData(TypedDict):
    """Why the run ends."""

    reason: Literal["quiet", "horizon", "return", "events", "stopped"]
    until: NotRequired[NumberText]
    limit: NotRequired[Annotated[int, InSchema(minimum=1)]]
    zeros: NotRequired[list[ZeroData]]


def _where(reason: str, key: str) -> dict[str, Any]:
    return {"if": {"properties": {"reason": {"const": reason}}}, "then": {"required": [key]}}


class FinalData(TypedDict):
    """The final state: x, y, vx, vy of each circle."""

    time: DecimalText
    circles: list[Annotated[list[DecimalText], InSchema(minItems=4, maxItems=4)]]


class Certificate(TypedDict):
    """A certificate of a run of the exact engine (docs/certificates.md)."""

    format: Annotated[str, InSchema(const=FORMAT)]
    writer: str
    roots: Roots
    scene: WrittenScene
    isometries: list[IsometryData]
    bits: Annotated[int, InSchema(minimum=1, maximum=BITS)]
    instants: Annotated[list[MomentData], InSchema(minItems=1)]
    end: Annotated[EndData, InSchema(allOf=[_where("horizon", "until"), _where("events", "limit")])]
    final: FinalData


def certificate_of(trajectory: Trajectory, digits: int = DIGITS) -> dict[str, Any]:
    """The certificate of a run: what docs/certificates.md describes, as a JSON object.

    Args:
        trajectory: a run of the exact engine.
        digits: decimals after the point of the times and of the final state.

    Raises:
        CertificateError: for a run of another engine, one that rests on an assumption, in which a circle slides down
            a slope or that ends amid infinitely many bounces, a scene whose numbers need too many roots, or a zero for
            which no witness is found.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> told = certificate_of(ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)])))
    >>> told["instants"][1]
    {'rounds': [[[0, 1]]], 'time': '2.26794919243112271', 'met': [[0, 1]]}
    """
    _check_certifiable(trajectory)
    with _long_numbers(), _without_limit(), _without_search_for_cycles():
        return _certified(trajectory, digits)


def plain_certificate(trajectory: Trajectory) -> dict[str, Any] | None:
    """The certificate of a short run of single meetings, written from the run's own numbers, with no witness of a zero.

    It claims what the one that `certificate_of` writes claims, and a checker proves it, or does not. If not, that says
    nothing of the run: it may want witnesses, or grazes.

    Args:
        trajectory: a run of the exact engine.

    Returns:
        None: for a run of more than `PLAIN` events, with more than one meeting in an instant, with a reversal, a
        pocketing or a settling, or one that has taken more bits than a run begins with.

    Raises:
        CertificateError: for a run of another engine, one that rests on an assumption, a scene whose numbers need too
            many roots.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import Circle, Scene
    >>> run = ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)]))
    >>> plain_certificate(run)["instants"] == certificate_of(run)["instants"]
    True
    """
    _check_certifiable(trajectory)
    others = trajectory.pocketings or trajectory.settlings or trajectory.reversal
    if others or len(trajectory.events) > PLAIN or int(trajectory.plan["bits"]) > FIRST_BITS:
        return None
    if any(len(event.contacts) > 1 for event in trajectory.events):
        return None
    with _long_numbers(), _without_limit():
        try:
            frame = _frame(trajectory)
        except Unsettled as doubt:
            raise CertificateError(f"the scene's numbers: {doubt}") from None
        log, _, times = instants(trajectory)
        log[0]["time"] = decimal_text(0, 0, DIGITS)
        for k, time in times.items():
            log[k]["time"] = _decimal(time)
        circles = [[_decimal(x) for x in (c.x, c.y, c.vx, c.vy)] for c in trajectory.final.circles]
        final = {"time": _decimal(trajectory.final_time), "circles": circles}
        return _short({**frame, "bits": FIRST_BITS + MARGIN, "instants": log, "final": final})


def _decimal(value: Real) -> str:
    """A number to `DIGITS` decimals after the point. Whether it is right is the checker's to say."""
    near = value.near if isinstance(value, ExactValue) else None
    if not isinstance(near, arb) or near.rad() > FINE:
        near = value.ball(SHARP)
    part, exponent = near.mid().man_exp()
    return decimal_text(int(part), -int(exponent), DIGITS)


def _check_certifiable(trajectory: Trajectory) -> None:
    """Refuses a run of which there is no certificate, or that rests on an assumption."""
    """Refuses a run of which there is no certificate, or that rests on an assumption."""
    if trajectory.engine != "exact":
        raise CertificateError(f"only runs of the exact engine have certificates, not those of {trajectory.engine}")
    if other := trajectory.scene.other_walls:
        raise CertificateError(f"the scene has a wall of kind {other[0].kind!r}, which they do not know")
    sides = sum(len(polygon.sides()) for polygon in trajectory.scene.polygons)
    if len(trajectory.scene.surfaces.faces) != 2 * len(trajectory.scene.segments) + sides:
        raise CertificateError("the scene has surfaces that certificates do not know yet; write them as segments")
    if len(trajectory.scene.circles) > CIRCLES:
        raise CertificateError(
            f"the scene has {len(trajectory.scene.circles)} circles; a certificate at most {CIRCLES}"
        )
    for circle, (time, _) in trajectory.slides.items():
        raise CertificateError(
            f"{circle} slides down a slope from time {time:.9g} on: certificates do not tell that yet"
        )
    if ENDS in trajectory.stop.message:
        raise CertificateError("a circle slides along a face, to its end: certificates do not tell that yet")
    if motion := motion_of(trajectory):
        _check_end(motion)
    if not trajectory.certified:
        raise CertificateError("the run rests on a tie that is assumed, not proved; run it with --ties proved")


def _check_end(motion: ExactMotion) -> None:
    """Refuses a run that ends amid infinitely many bounces, but with the first of them: that is one like any other."""
    last = motion.end.instant if isinstance(motion.end, ExactValue) else None
    for since, time in motion.ends.values():
        if since.instant != last and not motion.reaches(time):
            step = motion.log.steps[time.upto - 1]
            assert isinstance(step, Settle)
            rest = step.told(motion.log.scene, time, since)
            raise CertificateError(
                f"{rest.circle} bounces infinitely often {rest.where} until {float(time):.9g}, and the run ends amid "
                "that: certificates do not tell where it is then"
            )


@contextmanager
def _long_numbers() -> Iterator[None]:
    """Whole numbers of any length are written and read as decimals: a scene may have them."""
    saved = sys.get_int_max_str_digits()
    sys.set_int_max_str_digits(0)
    try:
        yield
    finally:
        sys.set_int_max_str_digits(saved)


@contextmanager
def _without_limit() -> Iterator[None]:
    """What the checker's own program may cost is not bounded here: the run that it follows has bounds of its own."""
    saved = cost.most, cost.rooms
    cost.most = cost.rooms = 1 << 200
    try:
        yield
    finally:
        cost.most, cost.rooms = saved


@contextmanager
def _without_search_for_cycles() -> Iterator[None]:
    """The numbers of a run refer to those that they come about from, never in a circle: looking at all of them, again
    and again, for some that do is a tenth of what a certificate costs."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


MOST_FOLD = 2
"""Of the zero of a gap from which two part that touch as a flight begins: checkers look no further."""


def _certified(trajectory: Trajectory, digits: int) -> dict[str, Any]:
    """As `certificate_of`, of a run that may have a certificate."""
    try:
        frame = _frame(trajectory)
    except Unsettled as doubt:
        raise CertificateError(f"the scene's numbers: {doubt}") from None
    motion = motion_of(trajectory)
    if motion is not None and any(isinstance(step, Leave) and step.fold > MOST_FOLD for step in motion.log.steps):
        raise CertificateError("two that touch part by a zero of their gap of third or fourth fold: that has none")
    log, contacts, times = instants(trajectory)
    had = int(trajectory.plan["bits"])
    short = had <= FIRST_BITS or trajectory.stop.reason is StopReason.UNDECIDED  # it took more to tell what comes next
    bits = LEAST_BITS if short else had * 5 // 4
    most = min(BITS // 2, ENOUGH * bits + 4 * len(json.dumps(frame["scene"])) + EACH * len(log))
    follow = _Follow(frame, log, contacts, digits, times)
    if len(log) > LONG and follow.part(len(log) // PART):
        bits = follow.needed
    while True:
        try:
            told = follow.whole(bits)
            break
        except Unsettled as doubt:
            if bits > most:
                plain = str(doubt).startswith(("whether", "nothing"))
                why = doubt if plain else f"whether {doubt}, is not decided"
                raise CertificateError(f"no certificate within {bits} bits: {follow.where}: {why}") from None
            bits = min(2 * bits, follow.needed) if len(log) > LONG and follow.needed > bits else 2 * bits
        except Malformed as fault:  # the engine itself took more than a certificate may have
            raise CertificateError(f"no certificate within {bits} bits: {fault}") from None
        except Refuted as fault:
            if frame["end"]["reason"] == "stopped" and len(log) == 1:
                raise CertificateError("the run stopped within time 0: there is nothing to certify") from None
            raise AssertionError(f"{follow.where}: {fault}: a defect, of the engine or of the checker") from None
    told["bits"] = bits + MARGIN
    return _short(told)


class _Follow:
    """A run to be followed, with so many bits.

    Args:
        frame: the certificate, all but the log.
        log, contacts, times: what `instants` tells.
        digits: decimals after the point.
    """

    def __init__(
        self,
        frame: dict[str, Any],
        log: list[dict[str, Any]],
        contacts: list[frozenset[Contact]],
        digits: int,
        times: dict[int, ExactValue],
    ) -> None:
        self.frame, self.log, self.contacts, self.digits, self.times = frame, log, contacts, digits, times
        self.roots = list(Exact.roots)
        self.grazing: dict[int, list[Contact]] = {}
        self.grazes: set[tuple[str, Contact]] = set()
        self.prover: Prover | None = None

    def whole(self, bits: int) -> dict[str, Any]:
        """The certificate, with isometries that are not used.

        Raises:
            Unsettled: if these bits do not suffice, or a zero has no witness.
            Refuted: if the run is wrong.
        """
        while True:
            told = self._told(self.frame, self.log, bits)
            if not self._list_missed():
                return told

    def part(self, count: int) -> bool:
        """Follows the first instants only, with more bits than forms lose; whether that went well."""
        try:
            self._told({**self.frame, "end": {"reason": "stopped"}}, self.log[:count], LEAST_BITS + 2 * count)
        except (Unsettled, Refuted):  # they did not suffice, or a reversal falls due with the last of them
            return False
        return True

    def _told(self, frame: dict[str, Any], log: list[dict[str, Any]], bits: int) -> dict[str, Any]:
        told = {**_copied(frame), "bits": bits, "instants": _copied(log)}
        Exact.work, Exact.roots, self.prover = 0, list(self.roots), None
        self.prover = Prover(told, self.contacts, self.digits, self.times, self.grazing)
        self.prover.run()
        return told

    def _list_missed(self) -> bool:
        """Lists the grazes that were missed, at instants that there are or of their own; whether there are any.

        Raises:
            Unsettled: where it is not told before or after which instant one comes, or one was listed in vain.
        """
        assert self.prover is not None
        own: dict[int, Exact] = {}
        times = self.prover.ball.times[: len(self.log)]
        for exact, near, contact in self.prover.missed:
            graze = text_of(exact), contact
            if graze in self.grazes:
                raise Unsettled("whether two graze")
            self.grazes.add(graze)
            k = next((k for k, time in enumerate(times) if (near - time).sign() != 1), len(times))
            if k < len(times) and (near - times[k]).sign() != -1:
                there = self.prover.form.times[k - sum(other < k for other in own)]
                if (own[k] - exact) if k in own else not is_same(there, exact):
                    raise Unsettled("at which instant two graze")
            else:
                entry = {"exact": graze[0], "rounds": [], "enter": [], "settle": [], "bounces": [], "time": "0"}
                self.log.insert(k, entry)
                self.contacts.insert(k, frozenset())
                times.insert(k, near)
                self.times, self.grazing = _shifted(self.times, k), _shifted(self.grazing, k)
                own = {**_shifted(own, k), k: exact}
            self.grazing.setdefault(k, []).append(contact)
        if self.prover.missed:
            self.roots = list(Exact.roots)
            scene = len(self.frame["scene"].get("roots", ()))
            self.frame["roots"] = [text_of(root) for root in self.roots[scene:]]
        return bool(self.prover.missed)

    @property
    def where(self) -> str:
        """How far it was followed."""
        return self.prover.where if self.prover else "in the scene"

    @property
    def needed(self) -> int:
        """How many bits the whole seems to take: what is lost up to here goes on, and a sixteenth more; what is left
        at the end are the digits, and room for decisions."""
        lost, age = (self.prover.lost, max(1, self.prover.age)) if self.prover else (0, 1)
        return LEAST_BITS + 4 * self.digits + lost * len(self.log) * 17 // (16 * age)


def _shifted(told: Mapping[int, T], k: int) -> dict[int, T]:
    """By places in the log, into which an instant has been put."""
    return {place + (place >= k): value for place, value in told.items()}


def _copied(part: Any) -> Any:
    """A copy of plain JSON, to be completed in place."""
    if isinstance(part, dict):
        return {key: _copied(value) for key, value in part.items()}
    return [_copied(value) for value in part] if isinstance(part, list) else part


def _frame(trajectory: Trajectory) -> dict[str, Any]:
    """All but the log."""
    scene = scene_part(trajectory.scene)
    reason, final_time = trajectory.stop.reason, trajectory.final_time
    end: dict[str, Any] = {"reason": "stopped"}
    if reason is StopReason.HORIZON and isinstance(final_time, Quantity):
        end = {"reason": "horizon", "until": text_of(exact_number(final_time))}
    elif reason is StopReason.HORIZON:
        end = {"reason": "return"}
    elif reason is StopReason.EVENTS:
        end = {"reason": "events", "limit": len(trajectory.events)}
    elif reason is StopReason.QUIET:
        end = {"reason": "quiet"}
    return {
        "format": FORMAT,
        "writer": "truebreak",
        "roots": [text_of(root) for root in Exact.roots[len(scene.get("roots", ())) :]],
        "scene": scene,
        "isometries": [],
        "end": end,
        "final": {"time": "0", "circles": [["0"] * 4 for _ in trajectory.scene.circles]},
    }


def instants(
    trajectory: Trajectory,
) -> tuple[list[dict[str, Any]], list[frozenset[Contact]], dict[int, ExactValue]]:
    """The instants from time 0 on, each a dict with `rounds`, `enter` and perhaps `turn`; the contacts of each; when
    they are.

    The first is time 0, whether anything falls on it or not.
    """
    scene, number_of = trajectory.scene.surfaces, numbers_of(trajectory.scene)
    parts: dict[str, list[int]] = {}  # of a segment or polygon: its ends, and its faces
    for k, name in enumerate(scene.ids):
        parts.setdefault(name, []).append(number_of[k])
    place = {name: found[0] for name, found in parts.items()}
    pockets = {str(pocket.id): k for k, pocket in enumerate(scene.pockets)}
    ends: dict[int, int] = {0: 0}
    contacts: dict[int, set[Contact]] = {}
    entries: dict[int, list[list[int]]] = {}
    steps: Sequence[Step] = ()
    times: dict[int, ExactValue] = {}
    stilled: dict[tuple[int, int], ExactValue] = {}
    for happened in (*trajectory.events, *trajectory.pocketings, trajectory.reversal, *trajectory.settlings):
        if happened is None:
            continue
        if isinstance(happened, Settling) and happened.since is not None:  # it bounces out from then on
            assert isinstance(happened.time, ExactValue)
            time, number = _instant(happened.since)
            stilled[number, place[happened.circle]] = happened.time
            upto = happened.time.upto
        else:
            time, number = _instant(happened.time)
            upto = time.upto
        times[number] = time
        steps = time.log.steps if len(time.log.steps) > len(steps) else steps
        ends[number] = max(upto, ends.get(number, 0))
        if isinstance(happened, Event):
            contacts[number] = {(place[a], part) for a, b in happened.contacts for part in parts[b]}
        elif isinstance(happened, Pocketing):
            entries.setdefault(number, []).append([place[happened.circle], -1 - pockets[happened.pocket]])
    carried: set[int] = set()
    found: list[dict[str, Any]] = []
    met: list[frozenset[Contact]] = []
    when: dict[int, ExactValue] = {}
    calm: list[tuple[ExactValue, list[list[int]]]] = []
    done = 0
    for number in sorted(ends):
        kicks = [step.links for step in steps[done : ends[number]] if isinstance(step, Kick)]
        rounds = [[[number_of[k] for k in places_of(scene, link)] for link in links] for links in kicks]
        turn = {"turn": True} if number % 2 else {}
        if turn and number - 1 not in ends and scene.reverse_at is not None:
            found.append({"exact": text_of(exact_number(scene.reverse_at)), "rounds": [], "enter": [], "time": "0"})
            met.append(frozenset())
        enter, pushed = entries.get(number, []), contacts.get(number, set())
        clocks = {} if turn or not number else {"met": [list(c) for c in sorted(pushed)] or list(enter)}
        if number in times:
            when[len(found)] = times[number]
        settled = [step for step in steps[done : ends[number]] if isinstance(step, Settle) and step.body not in carried]
        begun: list[list[int]] = []
        bounces: list[list[int]] = []
        for step in settled:
            walls = (step.wall, step.other) if step.other >= 0 else (step.wall,)
            on = [[step.body, number_of[places_of(scene, AtWall(step.body, wall))[1]]] for wall in sorted(walls)]
            if step.bounces and (number, step.body) not in stilled:  # with this bounce the run ends
                continue
            if step.bounces:
                bounces += on
                calm.append((stilled[number, step.body], on))
            else:
                begun += on
        for step in steps[done : ends[number]]:
            if isinstance(step, Settle | Lift):
                (carried.add if isinstance(step, Settle) else carried.discard)(step.body)
        lasts = {"settle": begun, "bounces": bounces}
        found.append({**turn, **clocks, "rounds": rounds, "enter": enter, **lasts, "time": "0"})
        met.append(frozenset(pushed))
        done = max(done, ends[number])
    for time, on in calm:  # an instant of its own, or of others like it; beside a meeting it is not told
        sharp = time.ball(ORDER)
        k = next((k for k, other in sorted(when.items()) if not other.ball(ORDER) < sharp), len(found))
        if k == len(found) or not when[k].ball(ORDER).overlaps(sharp):
            found.insert(k, {"rounds": [], "enter": [], "settle": [], "bounces": [], "time": "0"})
            met.insert(k, frozenset())
            when = {**_shifted(when, k), k: time}
        if not (met[k] or found[k]["enter"]):
            found[k]["settle"] += on
    return found, met, when


def _instant(time: Real) -> tuple[ExactValue, int]:
    """A time of an exact run, and the number of its instant."""
    assert isinstance(time, ExactValue) and time.instant is not None
    return time, time.instant


def _short(told: dict[str, Any]) -> dict[str, Any]:
    """The certificate without isometries that are not used, and without what goes without saying."""
    entries = told["instants"]
    zeros = [zero for entry in [*entries, told["end"]] for zero in entry.get("zeros", ())]
    used = sorted({zero[2] for zero in zeros if isinstance(zero[2], int)})
    for zero in zeros:
        if isinstance(zero[2], int):
            zero[2] = used.index(zero[2])
    told["isometries"] = [told["isometries"][k] for k in used]
    for entry in [*entries, told["end"]]:
        for key in [key for key, value in entry.items() if value == []]:
            del entry[key]
    return told


def certificate_json(certificate: dict[str, Any]) -> str:
    r"""A certificate as text: one line an instant, a circle, an isometry.

    >>> certificate_json({"format": "f", "instants": [{"time": "1"}, {"time": "2"}]})
    '{"format":"f",\n"instants":[\n{"time":"1"},\n{"time":"2"}]}\n'
    """

    def text(value: Any) -> str:
        return json.dumps(value, separators=(",", ":"))

    def lines(value: Any) -> str:
        rows = isinstance(value, list) and value and not isinstance(value[0], str | int)
        return "[\n" + ",\n".join(map(text, value)) + "]" if rows else text(value)

    return "{" + ",\n".join(f"{text(key)}:{lines(value)}" for key, value in certificate.items()) + "}\n"
