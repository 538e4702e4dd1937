"""Where a run ends though time goes on: at rest, infinitely many hits in finite time, crushed; what goes on at rest."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from itertools import combinations
from math import ceil, inf, log
from typing import NamedTuple

from flint import arb

from ...scenarios.numbers.precision import hull
from ...scenarios.numbers.quantity import ZERO
from ...scenarios.scene import Scene
from ...scenarios.things import Squeeze
from ..laws.formulas import face_along
from ..numbers import ball
from ..numbers.system import Undecided
from ..question import Question, RelativeSpeed, Slide
from ..replay.contact import AtWall, Link, Pair, Sides, Touch, is_flat, is_pair, name_of
from ..replay.state import Constant, Go, Lift, Settle, Step
from ..replay.wall_flights import Rows
from .arc_meetings import Incline, borne, held_between
from .policies import Accumulating, Collapse, LineRallies, are_square, may_collapse

# -- A circle that stands at a wall to which gravity pulls it, and neither approaches nor parts, is at rest there. It is
# no straight flight in the falling frame: the run ends.
#
# A circle that bounces on such a wall with a restitution below 1, and meets nothing else, comes to rest there: with
# the normal speed v after a bounce it is back after 2 v / |n.g|, with the speed e v. So the bounces end 2 v / |n.g|
# (1 + e + e^2 + ...) = 2 v / (|n.g| (1 - e)) later, whichever bounce it is told from.
#
# That it meets nothing else until then is proved with a bound on all speeds. Collisions with e <= 1 add no kinetic
# energy K, and gravity does at most |g| sqrt(m) sqrt(2 K) a unit of time, m the mass of all circles: so sqrt(2 K) grows
# by at most |g| sqrt(m) a unit of time, and no circle of mass w is ever faster than sqrt(2 K / w). Of the circle itself
# that holds until it meets something else, and so for all of the time if nothing is near enough for that. On a face it
# stays there: it cannot pass an end, which is a fixed circle, without coming near to that. A wall that
# moves adds to K, each time, so that beside one nothing is said of other circles; on it, speeds are relative to it.
#
# A circle between two parallel walls that close has no room from a time on that the scene tells: hits on both come ever
# faster until then, infinitely many. They are told until SQUEEZED of the time since the first of them is left. That it
# meets nothing else until then is proved of all circles between the two walls: nothing but a meeting with something
# else changes a velocity along the walls, so until the first such meeting each is where its flight along the walls, and
# the room between these, says; and no two of these places, nor one and another wall, are near enough to meet. Where one
# of the two is a face, that ends, this is proved of a circle that alone moves, which is over the face for all of the
# time, and far from its ends.

# A scene may have walls carry what comes to rest so, or slides: on a wall across gravity, along which nothing pulls, it
# then flies straight in true coordinates. One that falls meets it at a zero of a quartic, as it meets what is fixed;
# what does not fall, at that of a quadratic. As something comes to it, it is let fall, so that its wall is one of the
# contacts of that instant; and what these leave at the wall, neither approaching nor parting, is carried again.
# Down a slope it slides, and that is no straight flight: there it goes on only where nothing ever meets it any more,
# out of play (see `Incline`).

SLIDES = ", a slope, along which it slides"
"""What the stop says of a circle that neither approaches a wall nor parts from it, and does not stay where it is."""

ENDS = ", a face, along which it slides: it would come to its end"
"""What it says of a level face where a scene may go on with what rests."""

ROUND = ", something round, along which it slides"
"""What it says of a circle that presses on what is round, and does not lie still straight above it."""

UNPROVED = ": it is not proved that nothing meets it there"
"""What it says besides where a scene may go on with what slides."""

SHRUNK = 20
"""A bounce counts as one of the last once its speed is 2**-SHRUNK of the first one's: before that they are all told."""

SQUEEZED = 31
"""Bounces between two walls that close are all told while more than one part in SQUEEZED + 1 of their time is left."""

WINDOW = 256
"""Events that are compared with as many before them, to see whether hits accumulate elsewhere."""

CROWDED = 2.0**-10
"""Share of the time of those before that WINDOW events take, where hits are suspected to accumulate; between walls that
close, share of the whole time that the later half of all events takes."""

PROOF_BITS = 256
"""Precision of a proof that a circle meets nothing else."""


class Rally(NamedTuple):
    """A circle that bounces between two surfaces: the last, the other, below 0 before there is one, and since when."""

    last: int
    other: int
    since: float


class Carrier:
    """Knows the circles of a run that walls carry.

    Args:
        scene: what runs.
        ask, ask_cheaply: decide the sign of a question on the state as it is; the other may leave it open.
        do: carries a step out.

    Attributes:
        walls: the circles, with the wall of each.
        away: those that slide down a slope, for ever: they are out of play.
        leaving: those that slide along a face, to its end, which is not followed.
    """

    def __init__(
        self,
        scene: Scene,
        ask: Callable[[Question], int],
        ask_cheaply: Callable[[Question], int | None],
        do: Callable[[Go | Settle | Lift], None],
    ) -> None:
        self.walls: dict[int, int] = {}
        self.away: set[int] = set()
        self.leaving: list[AtWall] = []
        self._scene, self._ask, self._ask_cheaply, self._do = scene, ask, ask_cheaply, do
        self._sides = Sides(scene)
        self._changed: set[int] = set()

    @property
    def begun(self) -> set[int]:
        """All that a wall bears now."""
        return self.away.union(self.walls)

    def anchored(self, at_hand: Collection[int]) -> set[int]:
        """The circles whose flights are new as a wall has begun to carry one, or has let it go, since last asked.

        All that fall are then reckoned anew from here on: their clock is no earlier than that of what is carried, and
        what a flight would meet after one that was, it may meet.

        Args:
            at_hand: those that stand at the instant already.
        """
        changed, self._changed = self._changed, set()
        if not changed:
            return changed
        stand = self._scene.pegs.union(self.begun)
        falling = [i for i in range(len(self._scene.circles)) if i not in stand]
        others = tuple(i for i in falling if i not in at_hand)
        if others:
            self._do(Go(min(changed), others))
        return changed.union(falling)

    def lift(self, bodies: Iterable[int]) -> None:
        """Lets circles fall, to which something has come."""
        for i in bodies:
            if self.walls.pop(i, None) is not None:
                self._do(Lift(i))
                self._changed.add(i)

    def settle(self, standing: Mapping[Link, int]) -> list[Touch]:
        """Has walls carry the circles that neither approach them nor part, where they can; the contacts that last so.

        It does not leave any other wall either at which it stands, neither approaching nor parting: it lies still, or
        slides along that, too. If it lies still, that holds of what is round and stands as well.

        Args:
            standing: contacts at gap zero, with the sign of their closing speed.
        """
        flat = sorted(link for link, sign in standing.items() if sign == 0 and is_flat(link))
        begun: set[int] = set()
        for link in flat:
            if self.carries(link):  # of two surfaces on one line the first
                self.carry(link)
                begun.add(link.circle)
        for one, other in combinations(flat, 2):
            i = one.circle
            free = i not in self.walls and i not in self.away and i not in self._scene.pegs
            if free and i == other.circle and held_between(self._sides, i, one.wall, other.wall):
                self._hold(i, one.wall, other.wall)
                begun.add(i)
        beside = [link for link, sign in standing.items() if sign == 0 and is_pair(link) and self._stays(link)]
        return [*(link for link in flat if link.circle in begun), *sorted(beside)]

    def _stays(self, pair: Pair) -> bool:
        """Whether a circle that is carried lies still beside one that is fixed."""
        pegs = self._scene.pegs
        lies = (pair.a in self.walls and pair.b in pegs) or (pair.b in self.walls and pair.a in pegs)
        return lies and self._ask(RelativeSpeed(pair)) == 0

    def slide(
        self, standing: Mapping[Link, int], fallen: Callable[[int], tuple[arb, Rows]], steps: Sequence[Step]
    ) -> list[int]:
        """Lets circles slide down slopes, each for ever, that surely meet nothing any more; which these are.

        Args:
            standing: contacts at gap zero, with the sign of their closing speed.
            fallen: gives where all circles are at the instant at which one stands.
            steps: the log.
        """
        done: list[int] = []
        for link in sorted(link for link, sign in standing.items() if sign == 0 and is_flat(link)):
            i, wall = link.circle, link.wall
            if i in self.away or i in self._scene.pegs or wall in self._scene.faces or self._sides.level(wall):
                continue
            if self._sides.pull(i, wall) < 0 and self._is_alone(link, fallen(i)[1], steps):
                self._do(Settle(i, wall, True))
                self.away.add(i)
                done.append(i)
        return done

    def calm(self, link: AtWall, other: int, fallen: Callable[[int], tuple[arb, Rows]], steps: Sequence[Step]) -> bool:
        """Has a wall carry a circle that bounces on it infinitely often and meets nothing else meanwhile, if it can.

        That is done at the instant at which the circle stands, after one of these bounces: until they have come to
        their end nothing is near enough to tell. Along the wall it flies as it would.

        Args:
            link: the two.
            other: the other wall, of two that hold it; below 0 elsewhere.
            fallen, steps: see `slide`.
        """
        i, wall = link.circle, link.wall
        if other >= 0:
            self._hold(i, wall, other, bounces=True)
            return True
        if not self._sides.level(wall):
            if wall in self._scene.faces or not self._is_alone(link, fallen(i)[1], steps):
                return False
            self._do(Settle(i, wall, True, True))
            self.away.add(i)
            return True
        if wall in self._scene.faces and self._ask_cheaply(Slide(link)) != 0:
            return False
        self.carry(link, bounces=True)
        return True

    def _is_alone(self, link: AtWall, rows: Rows, steps: Sequence[Step]) -> bool:
        with ball.precision(PROOF_BITS):
            return Incline(self._scene, self._sides, link, rows).meets_nothing(self.away, self.walls, steps)

    def carries(self, link: AtWall) -> bool:
        """Whether a wall can carry a circle, and carries it not yet."""
        known = link.circle in self.walls or link.circle in self._scene.pegs
        return not known and self._sides.pull(*link[:2]) < 0 and self._sides.level(link.wall)

    def _hold(self, i: int, wall: int, other: int, *, bounces: bool = False) -> None:
        """Has two slopes hold a circle between them."""
        self._do(Settle(i, wall, False, bounces, other))
        self.walls[i] = wall
        self._changed.add(i)

    def carry(self, link: AtWall, *, bounces: bool = False) -> None:
        """Has a wall carry a circle, perhaps after infinitely many bounces."""
        if link.wall in self._scene.faces:
            slides = self._ask(Slide(link)) != 0
            self.leaving += [link] if slides else []
        else:
            slides = self._ask_cheaply(Slide(link)) != 0
        self._do(Settle(link.circle, link.wall, slides, bounces))
        self.walls[link.circle] = link.wall
        self._changed.add(link.circle)


class Endings:
    """Looks for them, event by event.

    Args:
        scene: what runs, under gravity, with walls that move, or a restitution below 1.
        together: whether contacts of one instant push together, not one by one.

    Attributes:
        found: the bounces that were proved to end, or when a circle is crushed.
        closes: whether surfaces may close and leave a circle no room.
    """

    def __init__(self, scene: Scene, together: bool) -> None:
        self.scene, self._together = scene, together
        self.found: Accumulating | Constant | None = None
        self._closing = {closing.circle: closing for closing in scene.closing}
        self.closes = bool(self._closing or scene.moving_ends)
        self._since: dict[int, float] = {}
        self._rallies: dict[int, Rally] = {}
        self._pinches: dict[tuple[int, int, int], Squeeze | None] = {}
        self._sides = Sides(scene)
        self._rows: dict[int, dict[int, int]] = {}
        self._pairs: dict[int, tuple[int, int, int]] = {}
        self.lines = LineRallies(scene) if may_collapse(scene) else None
        self._marks: list[tuple[int, float]] = []
        self._stuck = 0, 0.0
        self._spans: dict[int, tuple[Touch, float, float]] = {}
        self._times: list[float] = []
        e = float(scene.restitution)
        self._enough = ceil(SHRUNK * log(2.0) / -log(e)) if 0.0 < e < 1.0 else None

    def at_rest(
        self, standing: Mapping[Link, int], carrier: Carrier | None = None, pressed: Mapping[Link, bool] | None = None
    ) -> str | None:
        """Who is at rest at the end of an instant, in words; None if nobody is.

        Args:
            standing: contacts at gap zero, with the sign of their closing speed.
            carrier: knows the circles that walls carry: these stand, as fixed ones do.
            pressed: contacts with what is round on which one presses, and whether it slides along it; faces at joints.
        """
        stands = self.scene.pegs.union(() if carrier is None else carrier.begun)
        slides = SLIDES + (UNPROVED if self.scene.settle else "")
        walls: dict[int, list[int]] = {}
        for link in (*(link for link, sign in standing.items() if sign == 0), *(pressed or ())):
            if is_flat(link) and link.circle not in stands:
                walls.setdefault(link.circle, []).append(link.wall)
        names = [name_of(self.scene, link) + ENDS for link in (() if carrier is None else carrier.leaving)]
        names += [
            name_of(self.scene, AtWall(i, wall)) + (slides if goes else "")
            for i, row in walls.items()
            for on, goes in (borne(self._sides, i, row),)
            for wall in on
        ]
        names += [
            name_of(self.scene, link) + ROUND * slides for link, slides in (pressed or {}).items() if not is_flat(link)
        ]
        return " as well as ".join(sorted(names)) or None

    def bounced(self, impulses: Iterable[Touch]) -> list[tuple[AtWall, int]]:
        """Notes the impulses of an event; the contacts whose bounces have shrunk enough to be looked at.

        A wall at right angles to another leaves the speed towards that as it is: where circles settle, both count.
        With each comes the other wall, below 0 elsewhere, of two that hold the circle between them, where it bounces on
        both at once, a second time: it is as fast away from one, for what pulls it there, as from the other, and so it
        flies straight up. Both push, as -g lies between their normals, and it is as straight up after that.
        """
        mine: dict[int, list[Touch]] = {}
        for link in impulses:
            for i in link.circles:
                mine.setdefault(i, []).append(link)
        found: list[tuple[AtWall, int]] = []
        for i, links in mine.items():
            before, pair = self._rows.pop(i, {}), self._pairs.pop(i, None)
            walls = [link.wall for link in links if is_flat(link)]
            if len(walls) < len(links) or self._enough is None:
                continue
            if len(walls) == 1:
                wall = walls[0]
                square = {k: n for k, n in before.items() if self.scene.settle and are_square(self.scene, k, wall)}
                self._rows[i] = counts = {**square, wall: before.get(wall, 0) + (self._sides.pull(i, wall) < 0)}
                if counts[wall] > self._enough:
                    found.append((AtWall(i, wall), -1))
            elif len(walls) == 2:
                one, other = sorted(walls)
                as_before = self._together or are_square(self.scene, one, other)
                if one != other and as_before and held_between(self._sides, i, one, other):
                    count = pair[2] if pair is not None and pair[:2] == (one, other) else 0
                    self._pairs[i] = one, other, count + 1
                    if count >= self._enough:
                        found.append((AtWall(i, one), other))
        return found

    def crushed(self, links: Iterable[Touch]) -> Squeeze | None:
        """Which circle has no room at an instant at which all of these contacts are at gap zero."""
        walls: dict[int, set[int]] = {}
        for link in links:
            if is_flat(link) and (link.circle in self._closing or self.scene.moving_ends):
                walls.setdefault(link.circle, set()).add(link.wall)
        found = next((c for i, c in self._closing.items() if walls.get(i, set()).issuperset(c.walls)), None)
        if found is None and self.scene.moving_ends:
            pairs = ((i, *pair) for i, mine in sorted(walls.items()) for pair in combinations(sorted(mine), 2))
            found = next((pinch for pair in pairs if (pinch := self._pinch(*pair)) is not None), None)
        return found

    def squeezed(self, impulses: Iterable[Touch], time: float) -> list[Squeeze]:
        """Notes the impulses of an event; the circles between walls that close of which little time is left."""
        links, since = [*impulses], self._since
        shares = Counter(i for link in links for i in link.circles)
        found: list[Squeeze] = []
        for link in links:
            closing = self._closing.get(link[0])
            if closing is not None and is_flat(link) and link.wall in closing.walls and shares[link.circle] == 1:
                first = since.setdefault(link.circle, time)
                if (float(closing.time) - time) * SQUEEZED <= time - first:
                    found.append(closing)
            else:
                for i in link.circles:
                    since.pop(i, None)
            if not (is_flat(link) and shares[link.circle] == 1):
                for i in link.circles:
                    self._rallies.pop(i, None)
            elif self.scene.moving_ends and (pinch := self._rallied(link, time)) is not None:
                found.append(pinch)
        return found

    def _rallied(self, link: AtWall, time: float) -> Squeeze | None:
        """Notes a bounce; when a circle that goes to and fro between two surfaces, of which one is a face, is crushed,
        once little time is left."""
        i, wall = link.circle, link.wall
        last, other, since = self._rallies.get(i, (wall, -1, time))
        if (other < 0 and wall != last) or wall == other:
            other = last
        elif wall != last:
            other, since = last, time
        self._rallies[i] = Rally(wall, other, since)
        if other < 0 or (i in self._closing and {wall, other} == {*self._closing[i].walls}):
            return None
        pinch = self._pinch(i, min(wall, other), max(wall, other))
        return pinch if pinch is not None and (float(pinch.time) - time) * SQUEEZED <= time - since else None

    def _pinch(self, i: int, one: int, other: int) -> Squeeze | None:
        """When two surfaces leave no room for a circle between them; None where they do not close."""
        key = (i, one, other)
        if key not in self._pinches:
            self._pinches[key] = self._pinched(*key)
        return self._pinches[key]

    def _pinched(self, i: int, one: int, other: int) -> Squeeze | None:
        a, b = self.scene.walls[one], self.scene.walls[other]
        (nx, ny), (mx, my) = a.normal, b.normal
        turned = self._sides.negative(i, one) != self._sides.negative(i, other)
        facing = (nx * mx + ny * my).sign() * (-1 if turned else 1) < 0
        if not facing or (nx * my - ny * mx).sign() != 0:
            return None
        length = (nx * nx + ny * ny).sqrt() * (-1 if self._sides.negative(i, one) else 1)
        rate = (nx * (a.vx - b.vx) + ny * (a.vy - b.vy)) / length
        across = (nx * (b.x0 - a.x0) + ny * (b.y0 - a.y0)) / length
        if rate.sign() <= 0:
            return None
        r = self.scene.circles[i].r
        time = (across - r - r) / rate
        return Squeeze(i, (one, other), time) if time.sign() >= 0 else None

    def crushes(self, closing: Squeeze, now: arb, rows: Rows) -> bool:
        """Whether a circle surely meets nothing but the two walls until they leave no room for it."""
        with ball.precision(PROOF_BITS):
            return self._is_alone(closing, now, rows)

    def _is_alone(self, closing: Squeeze, now: arb, rows: Rows) -> bool:
        scene, (one, other) = self.scene, closing.walls
        circles, sides = scene.circles, self._sides
        if scene.arc_sides or (scene.pockets and scene.capture):
            return False
        own = sides.negative(closing.circle, one), sides.negative(closing.circle, other)
        inside = [
            i
            for i, circle in enumerate(circles)
            if circle.fixed or (sides.negative(i, one), sides.negative(i, other)) == own
        ]
        faces, movers = [k for k in closing.walls if k in scene.faces], [i for i in inside if not circles[i].fixed]
        if faces and sum(not circle.fixed for circle in circles) > 1:
            return False  # others may come in beside a face
        if any(i in self._closing and self._closing[i].time < closing.time for i in movers):
            return False
        end = ball.constant(closing.time)
        span, wait = hull(now, end), hull(arb(0), end - now)
        lines = [tuple(map(ball.constant, (*w.normal, w.x0, w.y0, w.vx, w.vy))) for w in scene.walls]
        nx, ny = lines[one][:2]
        length = (nx * nx + ny * ny).sqrt()
        nx, ny = nx / length, ny / length
        room = [
            nx * (x0 + ux * when) + ny * (y0 + uy * when)
            for _, _, x0, y0, ux, uy in (lines[one], lines[other])
            for when in (now, end)
        ]
        across = hull(hull(room[0], room[1]), hull(room[2], room[3]))
        gx, gy = (ball.constant(part) for part in scene.gravity or (ZERO, ZERO))
        pull = (nx * gy - ny * gx) / 2
        places: list[arb] = []
        for i in inside:
            x, y, vx, vy = rows[i]
            bent = arb(0) if circles[i].fixed else pull
            places.append(nx * y - ny * x + (nx * vy - ny * vx + bent * wait) * wait)
        place = places[inside.index(closing.circle)]
        if not all(self._is_over(k, lines[k], (nx, ny), place, now, wait) for k in faces):
            return False
        others = {scene.two_sided.start + ((k - scene.two_sided.start) ^ 1) for k in faces if k in scene.two_sided}
        radii = [ball.constant(circles[i].r) for i in inside]
        for k, i in enumerate(inside):
            for m in range(k):
                both = circles[i].fixed and circles[inside[m]].fixed
                if not both and not abs(places[k] - places[m]) > radii[k] + radii[m]:
                    return False
            if circles[i].fixed:
                continue
            px, py = nx * across - ny * places[k], ny * across + nx * places[k]
            for w, (mx, my, x0, y0, ux, uy) in enumerate(lines):
                height = mx * (px - x0 - ux * span) + my * (py - y0 - uy * span)
                if w in closing.walls or w in others or abs(height) > radii[k] * (mx * mx + my * my).sqrt():
                    continue
                along = face_along(px, py, x0 + ux * span, y0 + uy * span, mx, my)
                if w not in scene.faces or not (along < 0 or along > mx * mx + my * my):
                    return False
        return True

    def _is_over(
        self, face: int, line: tuple[arb, ...], normal: tuple[arb, arb], place: arb, now: arb, wait: arb
    ) -> bool:
        """Whether a circle whose place along two parallel surfaces is that for a time to come is over a face for all of
        that time."""
        (nx, ny), (mx, my, x0, y0, ux, uy) = normal, line
        start = nx * (y0 + uy * now) - ny * (x0 + ux * now) + (nx * uy - ny * ux) * wait
        end = start + (nx * -mx - ny * my)
        return bool(start < place < end) or bool(end < place < start)

    def ends(
        self,
        link: AtWall,
        other: int,
        now: arb,
        wait: arb,
        rows: Rows,
        lasting: Collection[Touch] = (),
        joint: tuple[int, int] | None = None,
    ) -> bool:
        """Whether the bounces of a circle surely end, so long after an instant, as it meets nothing else until then.

        Args:
            link: the circle and the wall.
            other: the other wall, of two that hold it; below 0 elsewhere.
            now, wait: the instant, and how long after it they end.
            rows: where all circles are.
            lasting: contacts that last: along a wall at right angles to the other a circle goes on.
            joint: the other face and the end of a joint above which the circle stays.
        """
        beside = {k.wall for k in lasting if is_flat(k) and k.circle == link.circle}
        square = {k for k in beside if other < 0 and are_square(self.scene, k, link.wall)}
        with ball.precision(PROOF_BITS):
            face, end = joint or (-1, -1)
            return self._meets_nothing(link, now, wait, rows, square | {other, face}, end)

    def collapses(self, collapse: Collapse, wait: arb, rows: Rows) -> bool:
        """Whether three bodies on a line, right after a hit, surely hit each other for so long, and nothing else.

        No circle goes farther than a speed lets it that has all of the energy.
        """
        scene, circles = self.scene, self.scene.circles
        if scene.moving_walls or not wait > 0:
            return False
        mine = {*collapse.link.circles, *collapse.other.circles}
        walls = {link.wall for link in (collapse.link, collapse.other) if is_flat(link)}
        with ball.precision(PROOF_BITS):
            gx, gy = (ball.constant(part) for part in scene.gravity or (ZERO, ZERO))
            masses = [arb(0) if c.fixed else 1 / ball.constant(c.inverse_mass) for c in circles]
            doubled = sum((m * (vx * vx + vy * vy) for m, (_, _, vx, vy) in zip(masses, rows, strict=True)), arb(0))
            swing = doubled.sqrt() + (gx * gx + gy * gy).sqrt() * sum(masses, arb(0)).sqrt() * wait
            ways = [arb(0) if c.fixed else swing / m.sqrt() * wait for c, m in zip(circles, masses, strict=True)]
            radii = [ball.constant(c.r) for c in circles]
            return all(
                self._is_far(i, rows[i][:2], radii[i], ways[i], walls)
                and all(
                    (px - rows[i][0]) ** 2 + (py - rows[i][1]) ** 2 > (radii[i] + radii[j] + ways[i] + ways[j]) ** 2
                    for j, (px, py, _, _) in enumerate(rows)
                    if j not in mine
                )
                for i in mine
                if not circles[i].fixed
            )

    def _is_far(self, i: int, place: tuple[arb, arb], r: arb, way: arb, own: Collection[int]) -> bool:
        """Whether a circle is farther than its way from all that stands, and is no circle, but for some walls."""
        x, y = place
        for side in self.scene.arc_sides:
            dx, dy = x - ball.constant(side.x), y - ball.constant(side.y)
            if not abs((dx * dx + dy * dy).sqrt() - abs(ball.constant(side.r))) > r + way:
                return False
        for pocket in self.scene.pockets:
            dx, dy = x - ball.constant(pocket.x), y - ball.constant(pocket.y)
            if not abs((dx * dx + dy * dy).sqrt() - ball.constant(pocket.r)) > way:
                return False
        for k, wall in enumerate(self.scene.walls):
            nx, ny, x0, y0 = (ball.constant(q) for q in (*wall.normal, wall.x0, wall.y0))
            height = abs(nx * (x - x0) + ny * (y - y0))
            if k not in own and not height > (r + way) * (nx * nx + ny * ny).sqrt():
                return False
        return True

    def glance(self, count: int, time: float) -> None:
        """Looks at the time of an event, of which others were not looked at.

        Raises:
            Undecided: as `look`.
        """
        if time != self._stuck[1]:
            self._stuck = count, time
        stuck = count - self._stuck[0] >= WINDOW // 2  # doubles do not tell so many apart
        if self._marks and count - self._marks[-1][0] < WINDOW and not stuck:
            return
        self._marks = [*self._marks[-2:], (count, time)]
        if len(self._marks) == 3 or stuck:
            (_, first), (begun, middle), (_, last) = self._marks if len(self._marks) == 3 else [self._stuck] * 3
            if stuck or last - middle < CROWDED * (middle - first):
                raise Undecided(
                    f"accumulation suspected: the last {count - begun} events took less than a thousandth of the time "
                    f"of as many before, up to time {time:.9g}; end the run before, or raise the restitution"
                )

    def _meets_nothing(self, link: AtWall, now: arb, wait: arb, rows: Rows, beside: Collection[int], end: int) -> bool:
        circles, moving = self.scene.circles, self.scene.moving_walls
        if moving and sum(not circle.fixed for circle in circles) > 1:
            return False
        gx, gy = (ball.constant(part) for part in self.scene.gravity or ())
        radii, pegs = [ball.constant(c.r) for c in circles], self.scene.pegs
        masses = [arb(0) if k in pegs else 1 / ball.constant(c.inverse_mass) for k, c in enumerate(circles)]
        pull = (gx * gx + gy * gy).sqrt()
        doubled = sum((m * (vx * vx + vy * vy) for m, (_, _, vx, vy) in zip(masses, rows, strict=True)), arb(0))
        swing = doubled.abs_upper().sqrt() + pull * sum(masses, arb(0)).sqrt() * wait
        ways = [  # at most: of a velocity that may be 0 the square may be known to be below that
            (vx * vx + vy * vy).abs_upper().sqrt() * wait if k in pegs else swing / m.sqrt() * wait
            for k, (m, (_, _, vx, vy)) in enumerate(zip(masses, rows, strict=True))
        ]
        i = link.circle
        x, y, vx, vy = rows[i]
        ux, uy, drift = self._pace(link.wall)
        vx, vy = vx - ux, vy - uy
        way = ((vx * vx + vy * vy).abs_upper().sqrt() + pull * wait + drift) * wait
        for j, (px, py, _, _) in enumerate(rows):
            room = radii[i] + radii[j] + way + ways[j]
            if j not in (i, end) and not (px - x) * (px - x) + (py - y) * (py - y) > room * room:
                return False
        for side in self.scene.arc_sides:
            dx, dy, r = x - ball.constant(side.x), y - ball.constant(side.y), ball.constant(side.r)
            if r > 0 and not abs((dx * dx + dy * dy).sqrt() - r) > radii[i] + way:
                return False
        for pocket in self.scene.pockets:
            dx, dy = x - ball.constant(pocket.x), y - ball.constant(pocket.y)
            if not abs((dx * dx + dy * dy).sqrt() - ball.constant(pocket.r)) > way:
                return False
        for k, wall in enumerate(self.scene.walls):
            if k != link.wall and k not in beside:
                nx, ny, x0, y0 = (ball.constant(q) for q in (*wall.normal, wall.x0, wall.y0))
                ux, uy, drift = self._pace(k)
                x0, y0 = x0 + ux * now, y0 + uy * now
                length = (nx * nx + ny * ny).sqrt()
                reach = (radii[i] + way + drift * wait) * length
                if abs(nx * (x - x0) + ny * (y - y0)) > reach:
                    continue
                clear = self._is_clear_of(
                    k, {link.wall, *beside}, x - ux * now, y - uy * now, (way + drift * wait) * length
                )
                if k not in self.scene.faces or not clear:
                    return False
        return True

    def _is_clear_of(self, face: int, own: Collection[int], x: arb, y: arb, way: arb) -> bool:
        """Whether a circle that stands on some faces, and is far from their ends, surely does not come to be over
        another.

        Places are as seen from where the other was at time 0. Not the other side of the same segment: while it is over
        its own it stays on that side. Nor one before whose start, or beyond whose end, it is by more than its way, in
        the scale of `formulas.face_along`.
        """
        sides = self.scene.two_sided
        if face in sides and sides.start + ((face - sides.start) ^ 1) in own:
            return True
        wall = self.scene.walls[face]
        nx, ny, x0, y0 = (ball.constant(q) for q in (*wall.normal, wall.x0, wall.y0))
        along = face_along(x, y, x0, y0, nx, ny)
        return bool(along < -way) or bool(along > nx * nx + ny * ny + way)

    def _pace(self, k: int) -> tuple[arb, arb, arb]:
        """The velocity of a wall, and its speed."""
        wall = self.scene.walls[k]
        ux, uy = ball.constant(wall.vx), ball.constant(wall.vy)
        return ux, uy, (ux * ux + uy * uy).sqrt()

    def look(self, time: float, impulses: Iterable[Touch]) -> None:
        """Notes the time of an event, and its impulses.

        Raises:
            Undecided: where hits come ever faster, though no proof is known that they accumulate.
        """
        if self.scene.elastic and not self._closing and not self.scene.moving_ends:
            return
        if self._enough is not None:
            self._look_at_bounces(time, [*impulses])
        self._times.append(time)
        times, count = self._times, len(self._times)
        halved = (self._closing or self.scene.moving_ends) and count >= 2 * WINDOW and count & (count - 1) == 0
        if halved and times[-1] - times[count // 2] < CROWDED * times[-1]:
            raise Undecided(
                f"accumulation suspected: between surfaces that close the later half of {count} events took less than "
                f"a thousandth of the time up to {time:.9g}; end the run before"
            )
        if not self.scene.elastic and len(times) >= 2 * WINDOW and len(times) % WINDOW == 0:
            before, last = times[-WINDOW] - times[-2 * WINDOW], times[-1] - times[-WINDOW]
            if last < CROWDED * before:
                raise Undecided(
                    f"accumulation suspected: the last {WINDOW} events took less than a thousandth of the time of the "
                    f"{WINDOW} before, up to time {time:.9g}; end the run before, or raise the restitution"
                )

    def _look_at_bounces(self, time: float, links: Sequence[Touch]) -> None:
        """The same of circles that hit one round thing alone, again and again, of which no proof is known."""
        shares = Counter(i for link in links for i in link.circles)
        for link in links:
            movers = [i for i in link.circles if not self.scene.circles[i].fixed]
            shrunk = [self._has_shrunk(i, link, time, alone=shares[i] == 1) for i in movers]
            if all(shrunk):
                raise Undecided(
                    f"accumulation suspected: {name_of(self.scene, link)} meet again and again, and nothing else, "
                    f"up to time {time:.9g}, a million times faster by then; end the run before"
                )

    def _has_shrunk(self, i: int, link: Touch, time: float, *, alone: bool) -> bool:
        """Whether the time between a circle's hits on one round thing is 2**-SHRUNK of what it was at first."""
        known = self._spans.get(i)
        if is_flat(link) or known is None or known[0] != link or not alone:
            self._spans[i] = (link, time, inf)
            return False
        _, last, first = known
        span = time - last
        self._spans[i] = (link, time, span if first == inf else first)
        return span * 2.0**SHRUNK < first < inf
