"""Which of several approaching contacts at one instant push, by policy; and contacts in turns without a last one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from functools import lru_cache, partial
from importlib import import_module
from itertools import pairwise
from typing import Protocol

from flint import arb

from ...scenarios import settings
from ...scenarios.lazy import frozen
from ...scenarios.numbers.quantity import ZERO, Quantity
from ...scenarios.scene import Scene
from ...scenarios.settings import TiePolicy
from ..numbers.system import BudgetSpent, N
from ..question import Closing, Coupling, Pivot, Question, RootFree, Share, Slack, Strength, Strengths
from ..replay.contact import AtWall, Link, Pair, Sides, Touch, is_arc, is_flat, is_pair, scene_order
from ..replay.state import Kick, ReplayState

# -- Which of several approaching contacts push: the linear complementarity problem of one round, by criss-cross.
#
# The impulses s of a round obey 0 <= s, complementary to G s + 2 u >= 0: each contact separates at least as fast as
# it approached, and one that separates faster is not pushed (G and u as in `State.contact_system`). G is positive
# semidefinite, hence sufficient, so the least-index criss-cross method ends after finitely many exchanges whatever
# the degeneracy (Klafszky and Terlaky, Linear Algebra Appl. 1992; den Hertog, Roos, Terlaky, 1993), and the
# velocities that come out are unique though the impulses need not be.

Ask = Callable[[Question], int]

ENDLESS = "passes without end: rounded numbers contradict each other on which of {} contacts at one instant push"


def pushing_contacts(approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
    """Those of the approaching contacts that push, in the order given.

    Args:
        approaching: contacts at one instant, each of which approaches.
        ask: decides the sign of a question.

    Raises:
        BudgetSpent: if a set of contacts comes a second time, or none pushes, which no true signs lead to.
        whatever `ask` raises when a sign is not known.
    """
    if len(approaching) == 1:
        return tuple(approaching)
    basis: list[Touch] = []
    seen: set[tuple[Touch, ...]] = set()
    while tuple(basis) not in seen:
        seen.add(tuple(basis))
        strengths, pushing = Strengths(tuple(basis)), []
        for link in approaching:
            if link in basis:
                sign = ask(Strength(tuple(basis), link, strengths))
                if sign > 0:
                    pushing.append(link)
            else:
                sign = ask(Slack(tuple(basis), link)) if basis else -1
            if sign < 0:
                _exchange(basis, link, approaching, ask)
                break
        else:
            if pushing:
                return tuple(pushing)
            break
    raise BudgetSpent(ENDLESS.format(len(approaching)))


def _exchange(basis: list[Touch], link: Touch, order: Sequence[Touch], ask: Ask) -> None:
    """One criss-cross exchange at the first infeasible contact; none where the signs leave none."""
    if link in basis:
        basis.remove(link)
        return
    if basis and ask(Pivot(tuple(basis), link)) == 0:
        sharing = (other for other in order if other in basis and ask(Share(tuple(basis), other, entering=link)) > 0)
        leaving = next(sharing, None)
        if leaving is None:
            return
        basis.remove(leaving)
    basis.append(link)
    basis.sort(key=order.index)


# -- The contract of a tie policy.


class Policy(Protocol):
    """Chooses, round by round, which approaching contacts are kicked together.

    Attributes:
        chooses_order: whether it picks some contacts before others, so that symmetric scenes need not stay symmetric.
        repeats: whether closing speeds alone, up to one factor, settle its choice, now as later.
    """

    chooses_order: bool
    repeats: bool = False

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """The contacts, at least one, that get their impulses now.

        Args:
            approaching: the contacts at this instant that approach, in scene order; at least one.
            ask: decides the sign of a question about the state.
        """
        ...

    def signs(self, ask: Callable[[], dict[Touch, int]]) -> dict[Touch, int]:
        """The signs of all closing speeds as a round begins: `ask` decides them, where they are not known."""
        return ask()

    def note(self, link: Touch) -> None:
        """Called when a contact was alone at its instant, so that nothing was to be chosen."""
        return

    def instant_done(self, state: Callable[[], Hashable | None]) -> None:
        """Called when an instant of several impulses is done.

        Args:
            state: gives the exact state of the circles that took part, or None where it is not at hand.
        """
        return


# -- All approaching contacts at once, in rounds.


class Simultaneous(Policy):
    """In each round all contacts that approach get their impulses together.

    The impulses are the least that make every one of them separate at least as fast as it approached
    (`complementarity`). Symmetric scenes stay symmetric, and no order is chosen.
    """

    chooses_order = False
    repeats = True

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """Those of the approaching contacts that push."""
        return pushing_contacts(approaching, ask)


# -- One approaching contact at a time, in scene order or in an order drawn from a seed.


class Sequential(Policy):
    """Kicks one approaching contact, then looks at all touching contacts again.

    Args:
        seed: None takes the first in scene order each time; a number draws one, each equally likely, from
            Python's Mersenne Twister started with it. Nothing is drawn where only one approaches.
    """

    chooses_order = True

    def __init__(self, seed: int | None = None) -> None:
        self.repeats = seed is None
        if seed is None:
            self._random = None
            return
        from random import Random

        self._random = Random(seed)

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """One contact."""
        if self._random is None or len(approaching) == 1:
            return (approaching[0],)
        return (approaching[self._random.randrange(len(approaching))],)


# -- The table of tie policies.


def policy_for(choice: TiePolicy) -> Policy:
    """A fresh policy, at the start of its random order if it has one."""
    module, _, name = settings.POLICIES[choice.name].partition(":")
    make = getattr(import_module(module, settings.__package__), name)
    return make() if choice.seed is None else make(choice.seed)


# -- Several contacts at one instant: which hang together, and the rounds of impulses until none approaches.


class Lasting:
    """The contacts that last: two circles at gap zero that move together, or a circle sliding along a wall."""

    def __init__(self) -> None:
        self._links: frozenset[Touch] = frozenset()

    def __bool__(self) -> bool:
        return bool(self._links)

    def add(self, link: Touch) -> None:
        """A contact that lasts."""
        self._links |= {link}

    def discard(self, link: Touch) -> None:
        """A contact that ends."""
        self._links -= {link}

    def settle(self, links: Iterable[Touch], stand: Collection[int]) -> None:
        """Contacts that last as walls carry circles; what falls goes from what is carried, though both are as fast."""
        kept = (link for link in self._links if not (is_pair(link) and (link.a in stand) is not (link.b in stand)))
        self._links = frozenset((*kept, *links))

    def all(self) -> frozenset[Touch]:
        """Every lasting contact."""
        return self._links


@frozen
class Component:
    """Contacts that hang together through shared circles of finite or infinite mass, and those circles."""

    bodies: tuple[int, ...]
    links: tuple[Touch, ...]


def components(links: Sequence[Touch], touching: Lasting) -> list[Component]:
    """The contacts of an instant with the lasting contacts that they reach, split where no circle is shared.

    In scene order of their first circle.

    >>> from truebreak.exact.replay.contact import Pair
    >>> [found.bodies for found in components([Pair(4, 5), Pair(0, 1), Pair(1, 2)], Lasting())]
    [(0, 1, 2), (4, 5)]
    """
    pending = set(links) | set(touching.all())
    found: list[Component] = []
    for first in sorted(links, key=scene_order):
        if first not in pending:
            continue
        bodies = set(first.circles)
        mine: set[Touch] = set()
        grown = True
        while grown:
            reached = {link for link in pending if not bodies.isdisjoint(link.circles)}
            grown = bool(reached)
            mine |= reached
            pending -= reached
            bodies |= {i for link in reached for i in link.circles}
        found.append(Component(tuple(sorted(bodies)), tuple(sorted(mine, key=scene_order))))
    return found


@frozen
class Rounds:
    """The outcome of the rounds in one component.

    Attributes:
        impulses: the contacts kicked, in the order applied.
        taking_part: the contacts that approached, as the instant came or in its rounds.
        signs: for each contact, 0 if it neither approaches nor parts at the end, else +1.
    """

    impulses: tuple[Touch, ...]
    taking_part: frozenset[Touch]
    signs: dict[Touch, int]


def _holds_back(parting: Touch, pushing: Touch, ask: Ask) -> bool:
    """Whether a push at one contact slows how another parts."""
    return not set(parting.circles).isdisjoint(pushing.circles) and ask(Coupling(parting, pushing)) < 0


def _closing_signs(known: Mapping[Touch, int | None], ask: Ask) -> dict[Touch, int]:
    """The signs of closing speeds, those that are not known asked for."""
    return {link: ask(Closing(link)) if sign is None else sign for link, sign in known.items()}


def are_square(scene: Scene, one: int, other: int) -> bool:
    """Whether two walls are at right angles to each other."""
    (nx, ny), (mx, my) = scene.walls[one].normal, scene.walls[other].normal
    return (nx * mx + ny * my).sign() == 0


def leaves_as_is(sides: Sides, links: Sequence[Touch], push: Touch, other: Touch) -> bool:
    """Whether a push surely leaves the speed at which a circle closes with a wall as it is.

    So does that of another wall at right angles, and that of a circle of the same size that touches the same wall.

    Args:
        sides: of the scene.
        links: all contacts at gap zero.
        push, other: the contact that pushes, and that with the wall.
    """
    scene, circles = sides.scene, sides.scene.circles
    if not is_flat(other) or push == other:
        return False
    if other.circle not in push.circles:
        return True
    if is_flat(push):
        return are_square(scene, push.wall, other.wall)
    if not is_pair(push) or (circles[push.a].r - circles[push.b].r).sign() != 0:
        return False
    both = all(AtWall(i, other.wall) in links for i in push)
    return both and sides.negative(push.a, other.wall) == sides.negative(push.b, other.wall)


def settle(
    links: Sequence[Touch],
    known: Mapping[Touch, int],
    policy: Policy,
    ask: Ask,
    do: Callable[[Kick], None],
    max_rounds: int,
    turn: Callable[[Touch, Touch], None] | None = None,
    again: Callable[[Sequence[Touch]], None] | None = None,
    closes: bool = False,
    leaves: Callable[[Touch, Touch], bool] | None = None,
) -> Rounds:
    """Rounds of impulses among touching contacts until none approaches.

    Args:
        links: the contacts, all at gap zero, in scene order.
        known: signs of closing speeds that are known as the instant comes: -1 where the two approach.
        policy: chooses the contacts of each round.
        ask: decides signs on the state as it is.
        do: applies impulses to the state.
        max_rounds: raises BudgetSpent beyond.
        turn: called where one of two contacts approaches after a round, with that one first.
        again: called where the rounds come again and again, with the contacts that push in them: one contact approaches
            alone for the second time, and what else does not part neither approaches nor parts, both times. The closing
            speeds of those are one factor times what they were, and rounds are linear in them; those that part are
            only pushed further apart by what pushed meanwhile.
        closes: whether what has pushed neither approaches nor parts: its restitution is 0.
        leaves: whether a push through one contact surely leaves the closing speed of another as it is.
    """
    signs: dict[Touch, int | None] = {link: known.get(link) for link in links}
    impulses: list[Touch] = []
    taking_part: set[Touch] = set()
    rounds = 0
    alone: dict[tuple[Touch, frozenset[Touch]], int] = {}
    while True:
        told = policy.signs(partial(_closing_signs, signs, ask))
        coming = [link for link in links if told[link] < 0]
        if not coming:
            return Rounds(tuple(impulses), frozenset(taking_part), told)
        if turn is not None and rounds and len(links) == 2 and len(coming) == 1:
            turn(coming[0], links[1] if coming[0] is links[0] else links[0])
        if again is not None and policy.repeats and len(coming) == 1:
            parting = frozenset(link for link in links if told[link] > 0)
            since = impulses[alone.setdefault((coming[0], parting), len(impulses)) :]
            if since and not any(_holds_back(one, other, ask) for one in parting for other in set(since)):
                again(since)
        if rounds == max_rounds:
            raise BudgetSpent(f"{max_rounds} passes of impulses at one instant")
        rounds += 1
        taking_part.update(coming)
        chosen = policy.choose(coming, ask)
        among = chosen if policy.chooses_order else tuple(coming)
        do(Kick(chosen, among))
        impulses += chosen
        hit = {i for link in chosen for i in link.circles}
        parted, after = (chosen, 0) if closes else (among, 1)
        apart = {
            link
            for link in links
            if hit.isdisjoint(link.circles) or (leaves is not None and all(leaves(push, link) for push in chosen))
        }
        signs = {link: after if link in parted else told[link] if link in apart else None for link in links}


# -- Contacts in turns, at one instant after the other, without a last one: three bodies on a line.
#
# Of three bodies on one line, of which a wall or a fixed circle may be one, the middle one hits the outer ones in turns
# (X, Y, X, Y...) with a restitution below 1. With u_k the speed at which the two of hit k part, the speed at which the
# others close is a sum of the last two: u_{k+2} = g u_{k+1} - e u_k, g = (1 + e) w / (w + w'), w the inverse mass of
# the middle one and w' of the outer one of hit k + 1. So after a hit of X
#
#     u_{k+2} = c u_{k+1} - e u_k,    u_{k+3} = d u_{k+2} - e u_{k+1}
#
# and a gap opens at u_k while the other closes at u_{k+1} / e. The time between two hits is e**k / (u_k u_{k+1}) times
# a constant. With another solution v of the recurrence v_{k+1} / u_{k+1} - v_k / u_k is that, too, times another one
# (Casorati's determinant shrinks by e a step). So all times add up to a difference of two such ratios. With v the
# solution that shrinks faster, v_1 = (lambda + e) / c v_0, lambda the smaller zero of lambda^2 + (2 e - c d) lambda +
# e^2, the ratio vanishes in the end. So after a hit of X, which parts at p, all end b / (-q - k p) later, b the gap of
# Y, q < 0 the speed at which it grows, k = (lambda + e) / (c e). Of equal masses it is real up to e = 7 - 4 sqrt(3)
# (McNamara and Young 1992). All u_k are above zero, and the hits have no last one, where -q > k p: then u_1 / u_0 is
# above the ratio that this solution keeps, from which others go away.


@frozen
class Collapse:
    """Two contacts in turns, of three bodies on a level or an upright line.

    Attributes:
        link, other: the one that was hit last, and the other.
        axis: of the line: 0 for x.
        signs: for each, 1 where the second of the two has the greater coordinate, as it has for ever.
        share: k, the part of the speed at which the first parts that is taken from the speed at which the other closes.
    """

    link: Touch
    other: Touch
    axis: int
    signs: tuple[int, int]
    share: Quantity

    @staticmethod
    @lru_cache(maxsize=256)
    def of(scene: Scene, link: Touch, other: Touch) -> Collapse | None:
        """Of what shares one circle; None where such hits have a last one, or are not known to be on one line."""
        e, circles = scene.restitution, scene.circles
        middle = [i for i in link.circles if i in other.circles and not circles[i].fixed]
        if (
            len(middle) != 1
            or e.sign() <= 0
            or scene.elastic
            or not all(is_pair(x) or is_flat(x) for x in (link, other))
        ):
            return None
        (m,) = middle
        w = circles[m].inverse_mass
        after, before = _others_share(scene, other, m), _others_share(scene, link, m)
        if after.sign() == 0 == before.sign():  # between two that stand it goes on for ever
            return None
        c, d = (1 + e) * w / (w + after), (1 + e) * w / (w + before)
        root = c * d * (c * d - 4 * e)
        axis = next((k for k in (0, 1) if all(_is_along(scene, x, k) for x in (link, other))), None)
        if axis is None or root.sign() <= 0:
            return None
        small = (c * d - e - e - root.sqrt()) / 2
        signs = _sign_of(scene, link, axis), _sign_of(scene, other, axis)
        return Collapse(link, other, axis, signs, (small + e) / (c * e))

    def rates(self, state: ReplayState[N]) -> tuple[N, N, N]:
        """At the last hit: the speed at which its two part; the gap of the others, and how fast that grows."""
        _, p = self._gap(state, self.link, self.signs[0])
        gap, q = self._gap(state, self.other, self.signs[1])
        return p, gap, q

    def _gap(self, state: ReplayState[N], link: Touch, sign: int) -> tuple[N, N]:
        if is_flat(link):
            length = state.line(*link[:2]).length
            return state.wall_gap(link) / length, state.wall_approach(link) / length
        assert is_pair(link)
        pair = state.relation(link)
        late, far, fast = state.later(link).flight.late, pair[1 + self.axis], pair[3 + self.axis]
        far, fast = (far, fast) if sign > 0 else (-far, -fast)
        gap = far - pair.reach
        return (gap if late is None else gap + fast * late), fast

    def wait(self, state: ReplayState[N]) -> N:
        """How long after the hit all of them have happened."""
        p, gap, q = self.rates(state)
        return gap / -(q + state.constant(self.share) * p)


@frozen
class Accumulating:
    """Computes when the bounces of a circle on a wall end, from the state after one of them; or the hits of `link` and
    `other` in turns, on one line (see `Collapse`), from the state after one of `link`."""

    link: Touch
    other: Touch | None = None

    @property
    def circles(self) -> tuple[int, ...]:
        """The circle, or all that are hit."""
        return tuple(dict.fromkeys((*self.link.circles, *(() if self.other is None else self.other.circles))))

    def __call__(self, state: ReplayState[N]) -> N:
        body = state.bodies[self.link[0]]
        return body.flight.instant + self.wait(state)

    def wait(self, state: ReplayState[N]) -> N:
        """How long after the bounce: 2 v / (|n.g| (1 - e)), with v relative to the wall."""
        if self.other is not None:
            collapse = Collapse.of(state.scene, self.link, self.other)
            assert collapse is not None
            return collapse.wait(state)
        assert state.falling is not None
        assert is_flat(self.link)
        speed, half = self.link.closing(state), state.fall(state.falling, self.link).half
        return -speed / (half * state.constant(1 - state.scene.restitution))


class Outlasts(RootFree):
    """Do infinitely many hits end after a time (positive), at it (zero) or before it (negative)?"""

    def __init__(self, end: Accumulating, time: Quantity) -> None:
        self._end, self._time = end, time

    @property
    def bodies(self) -> tuple[int, ...]:
        """See `Question.bodies`."""
        return self._end.circles

    def value(self, state: ReplayState[N]) -> N:
        """See `Question.value`."""
        return self._end(state) - state.constant(self._time)

    def describe(self, name: Callable[[Link], str]) -> str:
        """See `Question.describe`."""
        return f"whether the bounces of {name(self._end.link)} end after time {float(self._time):.12g}"


def _others_share(scene: Scene, link: Touch, middle: int) -> Quantity:
    """The inverse mass of the other one of a contact."""
    return ZERO if is_flat(link) else scene.circles[link[0] if link[1] == middle else link[1]].inverse_mass


def _is_along(scene: Scene, link: Touch, axis: int) -> bool:
    """Whether a contact is on a level line (0), or an upright one: told of the scene, where all begins."""
    one = scene.circles[link[0]]
    across, speed = ("y", "vy") if axis == 0 else ("x", "vx")
    if getattr(one, speed).sign():
        return False
    if is_flat(link):
        return scene.walls[link.wall].normal[1 - axis].sign() == 0 and not scene.moving_walls and scene.gravity is None
    two = scene.circles[link[1]]
    falls = scene.gravity is not None and (one.fixed or two.fixed)
    return not getattr(two, speed).sign() and getattr(one, across) == getattr(two, across) and not falls


def _sign_of(scene: Scene, link: Touch, axis: int) -> int:
    key = "xy"[axis]
    if is_flat(link):
        return 1
    return (getattr(scene.circles[link[1]], key) - getattr(scene.circles[link[0]], key)).sign()


LEFT = 31
"""Such hits are all told while more than one part in LEFT + 1 of their time is left."""

IN_TURNS = 8
"""Hits in turns, of a middle circle, from which on the end of all of them is looked for."""


def may_collapse(scene: Scene) -> bool:
    """Whether three neighbours on a level or an upright line may hit in turns without a last time."""
    if scene.elastic or scene.restitution.sign() == 0:
        return False
    walls = range(scene.faces.start)
    for axis, (key, across) in enumerate((("x", "y"), ("y", "x"))):
        rows: dict[Quantity, list[int]] = {}
        for i, circle in enumerate(scene.circles):
            if i not in scene.ends and not getattr(circle, f"v{across}").sign():
                rows.setdefault(getattr(circle, across), []).append(i)
        ends = [k for k in walls if scene.walls[k].normal[1 - axis].sign() == 0]
        for row in rows.values():
            row.sort(key=lambda i: getattr(scene.circles[i], key))  # pyright: ignore[reportUnknownLambdaType]
            pairs = [Pair(min(i, j), max(i, j)) for i, j in pairwise(row)]
            turns: list[tuple[Touch, Touch]] = [*pairwise(pairs)]
            turns += [(pair, AtWall(i, k)) for pair in (*pairs[:1], *pairs[-1:]) for i in pair for k in ends]
            if any(Collapse.of(scene, *two) is not None for two in turns):
                return True
    return False


class LineRallies:
    """Looks for circles that hit in turns on one line.

    A circle is on a line as long as all that it was ever hit by is: told of the scene, no number is looked at.

    Args:
        scene: what runs: see `may_collapse`.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._off: list[set[int]] = [set(), set()]
        self._recent: dict[int, list[Touch]] = {}
        self._since: dict[int, arb] = {}

    def note(self, impulses: Sequence[Touch]) -> list[Collapse]:
        """Notes the impulses of an instant; the hits in turns, of which the last are among them."""
        shares = Counter(i for link in impulses for i in link.circles)
        found: list[Collapse] = []
        for link in impulses:
            for axis, off in enumerate(self._off):
                if is_arc(link) or not off.isdisjoint(self._movers(link)) or not _is_along(self.scene, link, axis):
                    off.update(self._movers(link))
            for i in self._movers(link):
                row = self._recent.setdefault(i, [])
                row.append(link)
                del row[:-IN_TURNS]
                if shares[i] > 1 or (len(row) > 2 and row[-1] != row[-3]):
                    self._since.pop(i, None)
        for link in impulses:
            found += [known for i in self._movers(link) if (known := self._in_turns(i)) is not None]
        return found

    def lately(self, collapse: Collapse, time: arb, wait: arb) -> bool:
        """Whether little of the time of all such hits is left, of which this is one."""
        (middle,) = {*collapse.link.circles} & {*collapse.other.circles}
        return bool(wait * LEFT < time - self._since.setdefault(middle, time))

    def _movers(self, link: Touch) -> list[int]:
        return [i for i in link.circles if not self.scene.circles[i].fixed]

    def _in_turns(self, middle: int) -> Collapse | None:
        row = self._recent[middle]
        if len(row) < IN_TURNS or row[-1] == row[-2] or row[2:] != row[:-2]:
            return None
        found = Collapse.of(self.scene, row[-1], row[-2])
        if found is None:
            return None
        mine = {*self._movers(found.link), *self._movers(found.other)}
        outer = [row for i in mine - {middle} for row in [self._recent[i]]]
        apart = all(len(row) >= IN_TURNS // 2 and len({*row[-IN_TURNS // 2 :]}) == 1 for row in outer)
        return found if apart and self._off[found.axis].isdisjoint(mine) else None
