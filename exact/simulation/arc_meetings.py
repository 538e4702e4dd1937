"""When a circle meets an arc next, or, under gravity, something round that stands or a face; never, of what slides."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Sequence
from itertools import combinations
from typing import Generic, NamedTuple, Protocol

from flint import arb

from ...scenarios.numbers.quantity import ZERO, Quantity
from ...scenarios.scene import Scene
from ..laws.formulas import (
    advance,
    arc_range,
    face_along,
    fall_discriminant,
    fall_speed,
    fall_time,
    fall_time_back,
    pair_approach,
    pair_discriminant,
    pair_gap,
    pair_hit_time,
    pair_last_time,
    sag,
    wall_hit_time,
)
from ..numbers import ball
from ..numbers.system import M, Undecided
from ..question import Approach, Arrives, Beside, Discriminant, Gap, Moment, Onward, Question, Slide, Within
from ..replay.contact import AtArc, AtWall, Body, Entry, Gravity, Link, Pair, Round, Sides, Touch, is_flat, is_pair
from ..replay.landings import arc_chord, joints_at
from ..replay.state import Kick, ReplayState, Settle, Step
from ..replay.wall_flights import Rows, SeenWall, along_of, fall_of

# -- Arcs: the outside is met as a path comes to it, the inside as it leaves what is within.
#
# The two sides of an arc of radius r are two circles about its middle, of R = r + rho and R = r - rho, for a circle
# of radius rho whose centre flies straight. It is outside of R, or comes to be within it at the first zero of the gap
# |D|^2 - R^2, and leaves it at the second. It meets the outside at the first, if that is to come: D shrinks to R there.
# It meets the inside at the second, if that is to come, wherever it is before: within R; or beyond, where it has to
# come in by the opening first, or meets something else before. Either counts only where D points to the arc then.
#
# Right after a contact the zero at 0 is not looked for. After one with the outside there is none to come: what flies
# away from R goes on doing so, and does not come to be within it. After one with the inside the gap's other zero is at
# -2 d.v / |v|^2, rational in the state; the outside is not met: beyond the second zero, there is none.


def arc_contact(link: AtArc, sign: Callable[[Question], int | None], final: bool = False) -> int | None:
    """Whether a circle meets a side of an arc, its flight as it is: 1, or 0 for a graze; -1: it does not.

    Args:
        sign: the sign of a question; None where it is not known.
        final: whether it would come next, and is to be decided now.

    Returns:
        None where a sign that is needed is not known.

    Raises:
        Undecided: where the path touches the hollow side right at its end, and goes on along it.
    """
    disc = sign(Discriminant(link))
    if disc is None and link.hollow and sign(Gap(link)) == 0 == sign(Approach(link)):
        disc = 0  # it is there, and flies along the arc
    if disc == 0 and link.hollow and _may_go_along(link, sign):
        if not final:
            return None
        raise Undecided("a path touches the hollow side of an arc at its end, along it: what comes then is not decided")
    if disc is not None and (disc < 0 or (disc == 0 and link.hollow)):
        return -1
    approach, gap = sign(Approach(link)), sign(Gap(link))
    if link.hollow:
        ahead = gap is not None and gap > 0, approach is not None and approach > 0
        if gap is not None and approach is not None and not any(ahead):
            return -1
        known = any(ahead)
    else:
        if (approach is not None and approach >= 0) or (gap is not None and gap <= 0):
            return -1
        known = approach is not None and gap is not None
    if disc is None:
        return None
    within = sign(Within(link, graze=disc == 0))
    if within is not None and within <= 0:
        return -1
    return disc if known and within is not None else None


def _may_go_along(link: AtArc, sign: Callable[[Question], int | None]) -> bool:
    """Whether a path that touches the circle of a hollow side may do so at an end, and then go through the arc.

    It has yet to come there; or it is there now, at the start or after an impulse along the arc, and goes into it.
    """
    approach = sign(Approach(link))
    if approach == -1 or (approach != 1 and sign(Onward(link)) in (0, -1)):
        return False
    return sign(Within(link, graze=True)) in (0, None)


class Predicting(Protocol[M]):
    """What queues meetings: see `Predictor`."""

    @property
    def root(self) -> Callable[[M], M]: ...
    @property
    def unsure(self) -> Callable[[Link], None]: ...
    def prepare(self) -> None: ...
    def push(self, time: M, link: Link, graze: bool = False) -> None: ...
    def land(self, a: Body[M], link: Round, standing: Collection[Link]) -> None: ...


class ArcSides(Generic[M]):
    """The sides of arcs as circles meet them, in one number system.

    Args:
        scene: what runs.
        state: its state.

    Attributes:
        count: how many there are.
    """

    def __init__(self, scene: Scene, state: ReplayState[M]) -> None:
        self.scene = scene
        self.state = state
        self.count = len(scene.arc_sides)
        self._fits: dict[int, list[AtArc]] = {}

    def of(self, a: Body[M], standing: Collection[Link]) -> list[AtArc]:
        """Those that a circle may meet before its flight changes.

        A side within which the circle has no room is not met at all.
        """
        fits = self.that_fit(a)
        if not standing:
            return fits
        others = [link for link in fits if link.other_side not in standing]
        return [link for link in others if link.hollow or link not in standing]

    def that_fit(self, a: Body[M]) -> list[AtArc]:
        """Those within which a circle has room."""
        fits = self._fits.get(a.index)
        if fits is None:
            radius, sides = self.scene.circles[a.index].r, self.scene.arc_sides
            found = (AtArc(a.index, k) for k in range(self.count))
            fits = [link for link in found if not link.hollow or (radius + sides[link.arc].r).sign() < 0]
            self._fits[a.index] = fits
        return fits

    def numbers(self, link: AtArc) -> tuple[M, M, M, M, M, M, M]:
        """Of a side as a circle meets it: its middle, R, its radius, and as `formulas.arc_range` takes it."""
        a, b = link.ends(self.state)
        return b.flight.x, b.flight.y, self.state.reach(a, b), b.r, *arc_chord(self.state, link)

    def meet(self, a: Body[M], standing: Collection[Link], predictor: Predicting[M]) -> None:
        """Queues the next hits of a circle with all of them."""
        for link in self.of(a, standing):
            self.meet_one(a, link, predictor)

    def meet_one(self, a: Body[M], link: AtArc, predictor: Predicting[M]) -> None:
        """Queues the next hit of a, which has a new flight, with a side."""
        met, time = self.hit(a, link, predictor.root)
        if met is None:
            predictor.unsure(link)
            predictor.prepare()
        elif time is not None:
            predictor.push(time, link)

    def hit(self, a: Body[M], link: AtArc, root: Callable[[M], M]) -> tuple[bool | None, M | None]:
        """Whether a, which has a new flight, hits a side, and when; None where that is not plain."""
        cx, cy, reach, radius, nx, ny, edge = self.numbers(link)
        ax, ay, avx, avy, at = a.q
        zero, late = self.state.zero, a.flight.late
        dx, dy, vx, vy = cx - ax, cy - ay, -avx, -avy
        disc = pair_discriminant(dx, dy, vx, vy, reach)
        if disc < zero:
            return False, None
        gx, gy = (dx, dy) if late is None else (advance(dx, vx, late), advance(dy, vy, late))
        approach, gap = pair_approach(gx, gy, vx, vy), pair_gap(gx, gy, reach)
        if link.hollow:
            if gap >= zero and approach >= zero and pair_gap(gx, gy, radius) >= zero:
                return False, None
            ahead = gap < zero or approach < zero
        else:
            if approach >= zero or (gap <= zero and pair_gap(gx, gy, radius) <= zero):
                return False, None
            ahead = gap > zero and approach < zero
        if not (disc > zero and ahead):
            return None, None
        far, approach = root(disc), pair_approach(dx, dy, vx, vy)
        if link.hollow:
            wait = pair_last_time(approach, far, vx * vx + vy * vy)
        else:
            wait = pair_hit_time(pair_gap(dx, dy, reach), approach, far)
        if self.scene.arc_sides[link.arc].full:
            return True, at + wait
        within = arc_range(advance(dx, vx, wait), advance(dy, vy, wait), nx, ny, edge)
        if within < zero:
            return False, None
        return (True, at + wait) if within > zero else (None, None)


class FallenOnArcs(ArcSides[M]):
    """The same under gravity, where a circle may come back to what it has touched."""

    def meet(self, a: Body[M], standing: Collection[Link], predictor: Predicting[M]) -> None:
        """See `ArcSides.meet`."""
        for link in self.that_fit(a):
            predictor.land(a, link, standing)


# -- Circles that stand while others fall are met like walls: what a flight would meet after one, it does not.


class PegMeetings(Protocol[M]):
    """What predicts meetings of circles that fall: see `Predictor`."""

    @property
    def scene(self) -> Scene: ...
    @property
    def state(self) -> ReplayState[M]: ...
    @property
    def plan(self) -> Counter[str]: ...
    def pairs(self, a: Body[M], others: list[Body[M]], standing: Collection[Link]) -> None: ...
    def land(self, a: Body[M], link: Round, standing: Collection[Link]) -> None: ...


def predict_falls(
    predictor: PegMeetings[M],
    moved: Sequence[Body[M]],
    standing: Collection[Link],
    gone: Collection[int],
    walls: Callable[[Sequence[Body[M]], Collection[Link]], None],
) -> None:
    """As `Predictor.predict`, where something round stands under gravity: walls and arcs first, then circles that stand
    and rims, then circles that fall."""
    pegs, fixed = predictor.state.pegs, predictor.scene.pegs
    moved = [a for a in moved if a.index not in gone]
    walls([a for a in moved if a.index not in fixed], standing)
    there = [b for b in predictor.state.bodies.values() if b.index not in gone]
    falling, others = [b for b in there if b.index not in pegs], [b for b in there if b.index in pegs]
    carried = [b for b in others if not b.flight.rest]  # along a wall, at constant velocity
    predicted = 0
    for a in moved:
        if a.index in pegs:
            others.remove(a)
            for b in falling:
                predictor.land(b, Pair(*sorted((a.index, b.index))), standing)
            predicted += len(falling)
            if not a.flight.rest:
                carried.remove(a)
            predictor.pairs(a, carried if a.flight.rest else others, standing)
            continue
        falling.remove(a)
        for b in others:
            predictor.land(a, Pair(*sorted((a.index, b.index))), standing)
        for k in range(len(predictor.scene.pockets)):
            predictor.land(a, Entry(a.index, k), standing)
        predictor.pairs(a, falling, standing)
        predicted += len(falling) + len(others)
    if moved:
        predictor.plan["pairs predicted"] += predicted


# -- A face under gravity: its line is met like a wall's, at the one zero at which the gap falls, and counts only where
# the circle is strictly between the ends then.
#
# With the pull towards the line that zero is the later one, which is to come where the gap is above 0 or grows: so a
# circle beside a face may rise above its line, and come down onto it. With the pull away from it, it is the earlier
# one, to come where the gap is above 0 and falls; where the two zeros are one, the circle grazes. Without a pull there
# is one. Right after a contact the gap is 0 and grows: it is met again, if it is, by the pull alone.


def face_contact(link: AtWall, pull: int, sign: Callable[[Question], int | None]) -> int | None:
    """Whether a circle under gravity meets a face, its flight as it is: 1, or 0 for a graze; -1: it does not.

    Args:
        pull: whether gravity pulls it to the face (negative), away from it (positive), or along it.
        sign: the sign of a question; None where it is not known.

    Returns:
        None where a sign that is needed is not known.
    """
    reached = sign(Arrives(link)) if pull else 1
    if reached is not None and (reached < 0 or (reached == 0 and pull < 0)):
        return -1
    approach = sign(Approach(link))
    if pull >= 0 and approach is not None and approach >= 0:
        return -1
    ahead: int | None = 1
    if pull >= 0 or approach is None or approach <= 0:
        ahead = sign(Gap(link))
        if ahead is not None and ahead <= 0 and (pull >= 0 or approach is not None):
            return -1
    known = ahead is not None and ahead > 0 and (approach is not None or pull < 0)
    moment = Moment(link, graze=reached == 0)
    for far in (False, True):
        beside = sign(Beside(link, far, moment))
        if beside is not None and beside <= 0:
            return -1
        known = known and beside is not None
    return reached if known else None


class FaceMeetings(Protocol[M]):
    """What predicts meetings with faces under gravity: see `Predictor`."""

    @property
    def state(self) -> ReplayState[M]: ...
    @property
    def zero(self) -> M: ...
    @property
    def root(self) -> Callable[[M], M]: ...
    @property
    def falling(self) -> Gravity[M] | None: ...
    @property
    def two_sided(self) -> range: ...
    @property
    def unsure(self) -> Callable[[Link], None]: ...
    def line(self, body: Body[M], wall: int) -> tuple[M, M, M, M, M]: ...
    def prepare(self) -> None: ...
    def push(self, time: M, link: Link, graze: bool = False) -> None: ...


def fall_to_face(
    predictor: FaceMeetings[M], a: Body[M], wall: int, standing: Collection[Link], *, rounded: bool
) -> None:
    """Queues the next hit of a circle, which has a new flight under gravity, with a face.

    Args:
        predictor: what queues it; where signs are not plain its `unsure` is asked.
        a: the circle.
        wall: which face.
        standing: contacts at gap zero that do not approach.
        rounded: whether rounding may have put the circle into the face, by less than its radius.
    """
    link = AtWall(a.index, wall)
    if wall in predictor.two_sided:
        first = predictor.two_sided.start
        if AtWall(a.index, first + ((wall - first) ^ 1)) in standing:
            return  # who flies from one side of a segment does not come to the other before something else
    time = _time_to_face(predictor, a, link, link in standing, rounded)
    if isinstance(time, bool):
        if time:
            predictor.unsure(link)
            predictor.prepare()
    else:
        predictor.push(time, link)


def _time_to_face(predictor: FaceMeetings[M], a: Body[M], link: AtWall, stands: bool, rounded: bool) -> M | bool:
    """When a circle hits a face; False: it does not; True: that is not plain."""
    state, zero, falling = predictor.state, predictor.zero, predictor.falling
    assert falling is not None
    pull = state.sides.pull(*link[:2])
    if stands and pull >= 0:
        return False
    x0, y0, nx, ny, offset = predictor.line(a, link.wall)
    line = SeenWall(x0, y0, nx, ny, nx * nx + ny * ny, nx)
    at, late, drift = a.q[4], a.flight.late, state.drifts.get(link.wall)
    fall = fall_of(falling, a.q, line, offset, drift, zero)
    gap, approach, half = fall
    still, now = (gap, approach) if late is None else (sag(*fall, late), fall_speed(approach, half, late))
    if stands:
        if not now > zero:
            return True
        wait = fall_time_back(now, half, now)
        wait = wait if late is None else late + wait
    else:
        if pull >= 0 and (now > zero or (now >= zero and (still > zero or still < zero))):
            return False
        behind = (still + offset if rounded else still) < zero
        if behind and (pull >= 0 or now <= zero):
            return False
        disc = fall_discriminant(gap, approach, half) if pull else None
        if disc is not None and (disc < zero or (pull < 0 and disc <= zero)) and (behind or not rounded or pull > 0):
            return False
        if pull < 0:
            if not (still > zero or (now > zero and (behind or not rounded))):
                return True
        elif not (still > zero and now < zero):
            return True
        if disc is None:
            wait = wall_hit_time(gap, approach)
        elif disc > zero:
            root = predictor.root(disc)
            wait = fall_time(gap, approach, root) if approach < zero else fall_time_back(approach, half, root)
        else:
            return True
    x, y, vx, vy, _ = a.q
    (px, py, *_), pace = (line, (zero, zero)) if drift is None else (line.moved(drift, at), drift)
    straight = face_along(x, y, px, py, nx, ny), face_along(vx, vy, *pace, nx, ny)
    foot = sag(*along_of(falling, straight, line, at, zero), wait)
    beyond = line.nn - foot
    if foot < zero or beyond < zero:
        return False
    return at + wait if foot > zero and beyond > zero else True


# -- Down a slope a circle slides, and that is no straight flight. So it goes on there only where nothing ever meets it
# any more, and is out of play. With s the way down the slope and h the height above it: as long as circles push nothing
# but walls parallel to the slope, all fall alike along it, so that s' - s of any two is linear in time; and a bounce
# with e <= 1 adds nothing to u^2 / 2 + |g_n| h, with u the speed across the slope, so that each stays in a strip: s is
# never less than it becomes on the way up, and h is from r to h + u^2 / (2 |g_n|). Two that are apart along the slope,
# and do not come nearer along it, never meet. A wall, a fixed circle or a face from which the strip keeps clear is
# never met, nor, by the circle that slides, any that are behind such a wall, whatever becomes of them. That two come no
# nearer is seen of what they start with, exactly, if both have pushed nothing but such walls so far; else of their
# velocities.


def held_between(sides: Sides, i: int, one: int, other: int) -> bool:
    """Whether two walls bear a circle between them against gravity, which neither does alone.

    Gravity is then -p a - q b with p, q > 0, for their normals a and b to the circle's side.

    >>> from truebreak.scenarios import Circle, Scene, Wall
    >>> valley, ridge = [Wall(0, 0, -4, 3), Wall(0, 0, 4, 3)], [Wall(0, 0, 3, -4), Wall(0, 0, 4, -3)]
    >>> [held_between(Sides(Scene([Circle(1, 9)], two, gravity=(0, -10))), 0, 0, 1) for two in (valley, ridge)]
    [True, False]
    """
    (ax, ay), (bx, by) = (sides.scene.walls[k].normal for k in (one, other))
    gx, gy = sides.scene.gravity or (ZERO, ZERO)
    turn = (ax * by - ay * bx).sign()
    first, second = (gx * by - gy * bx).sign() * turn, (ax * gy - ay * gx).sign() * turn
    return first == (1 if sides.negative(i, one) else -1) and second == (1 if sides.negative(i, other) else -1)


def borne(sides: Sides, i: int, walls: Sequence[int]) -> tuple[list[int], bool]:
    """On which of the walls at which it stands a circle lies, and whether it slides along that one.

    If neither a level wall bears it nor two between them, it leaves all but the least steep.
    """
    scene, pressed = sides.scene, [k for k in walls if sides.pull(i, k) < 0]
    if any(held_between(sides, i, *both) for both in combinations(walls, 2)):
        return pressed, False
    if any(map(sides.level, pressed)):
        return [k for k in pressed if sides.level(k)], False
    gx, gy = scene.gravity or (ZERO, ZERO)
    normals = {k: scene.walls[k].normal for k in pressed}
    shares = {k: (nx * gx + ny * gy) ** 2 / (nx * nx + ny * ny) for k, (nx, ny) in normals.items()}
    return [k for k in pressed if all((shares[k] - share).sign() >= 0 for share in shares.values())], True


class Incline:
    """A slope, and where circles are along it, s, downwards, and above it, h: in balls.

    Args:
        scene, sides: what runs.
        link: a circle that stands on it, and it.
        rows: where all are.
    """

    def __init__(self, scene: Scene, sides: Sides, link: AtWall, rows: Rows) -> None:
        self._scene, self._sides, self._link = scene, sides, link
        (nx, ny), (gx, gy) = self._normal(*link[:2]), scene.gravity or (ZERO, ZERO)
        down = (ny * gx - nx * gy).sign()
        self._down = ny * down, -nx * down
        length = ball.constant(nx * nx + ny * ny).sqrt()
        self._along, self._up = ([ball.constant(q) / length for q in axis] for axis in (self._down, (nx, ny)))
        self._pull, self._lift = self._seen(ball.constant(gx), ball.constant(gy))
        own = scene.walls[link.wall]
        _, self._foot = self._seen(ball.constant(own.x0), ball.constant(own.y0))
        self._radii = [ball.constant(circle.r) for circle in scene.circles]
        self._places = [(*self._seen(x, y), *self._seen(vx, vy)) for x, y, vx, vy in rows]

    def _seen(self, x: arb, y: arb) -> tuple[arb, arb]:
        (tx, ty), (nx, ny) = self._along, self._up
        return tx * x + ty * y, nx * x + ny * y

    def _normal(self, circle: int, wall: int) -> tuple[Quantity, Quantity]:
        """Of a wall, to a circle's side."""
        nx, ny = self._scene.walls[wall].normal
        return (-nx, -ny) if self._sides.negative(circle, wall) else (nx, ny)

    def meets_nothing(self, away: Collection[int], carried: Collection[int], steps: Sequence[Step]) -> bool:
        """Whether the circle that stands on it surely meets nothing any more but for it.

        Args:
            away: those of which that has been proved.
            carried: those that other walls carry.
            steps: the log.
        """
        scene, (i, own, *_), is_behind = self._scene, self._link, self._sides.negative
        if not self._is_clear(i):
            return False
        walls = [k for k in range(len(scene.walls)) if k != own and k not in scene.faces]
        near = [i]
        for j, circle in enumerate(scene.circles):
            if j == i or circle.fixed or j in away or any(is_behind(i, k) != is_behind(j, k) for k in walls):
                continue
            if j in carried or is_behind(i, own) != is_behind(j, own) or not self._is_clear(j):
                return False
            near.append(j)
        struck = self._struck(steps)
        return all(self._part(a, b, exactly=struck.isdisjoint((a, b))) for a, b in combinations(near, 2))

    def _is_clear(self, j: int) -> bool:
        """Whether a circle surely meets nothing that stands, as long as it meets no other circle: but for walls along
        the slope, which the one that slides on it does not meet either."""
        scene, (i, own, *_), r = self._scene, self._link, self._radii[j]
        s, h, along, up = self._places[j]
        first = s if along > 0 else s - along * along / (2 * self._pull)
        least, most = self._foot + r, h - up * up / (2 * self._lift)

        def is_beside(places: Sequence[tuple[arb, arb]], room: arb) -> bool:
            """Whether what is between some places is above, below or before all that the circle comes to."""
            return (
                all(height > most + room for _, height in places)
                or all(height < least - room for _, height in places)
                or all(place < first - room for place, _ in places)
            )

        for k in range(len(scene.circles)):
            if scene.circles[k].fixed and not is_beside([self._places[k][:2]], r + self._radii[k]):
                return False
        for k, wall in enumerate(scene.walls):
            x0, y0, x1, y1 = map(ball.constant, (wall.x0, wall.y0, wall.x1, wall.y1))
            if k in scene.faces and not is_beside([self._seen(x0, y0), self._seen(x1, y1)], r):
                return False
            if k in scene.faces or k == own:
                continue
            nx, ny = self._normal(j, k)
            leans = (nx * self._down[0] + ny * self._down[1]).sign()
            if leans == 0 and j != i:
                continue
            mx, my = ball.constant(nx), ball.constant(ny)
            (tx, ty), (ux, uy), room = self._along, self._up, r * (mx * mx + my * my).sqrt()
            corners = [(tx * first + ux * height, ty * first + uy * height) for height in (least, most)]
            if leans < 0 or not all(mx * (x - x0) + my * (y - y0) > room for x, y in corners):
                return False
        return True

    def _struck(self, steps: Sequence[Step]) -> set[int]:
        """The circles whose velocity along the slope has been changed by more than gravity."""
        (tx, ty), walls = self._down, self._scene.walls
        sloped = {k for k, (nx, ny) in enumerate(wall.normal for wall in walls) if (nx * tx + ny * ty).sign() == 0}
        found = {step.body for step in steps if isinstance(step, Settle)}
        for step in steps:
            for link in step.links if isinstance(step, Kick) else ():
                if not (is_flat(link) and link.wall in sloped):
                    found.update(link.circles)
        return found

    def _part(self, a: int, b: int, exactly: bool) -> bool:
        """Whether two are apart along the slope, and surely come no nearer along it."""
        (one, _, fast, _), (other, _, slow, _) = self._places[a], self._places[b]
        apart, speed = one - other, fast - slow
        if not abs(apart) > self._radii[a] + self._radii[b]:
            return False
        if not exactly:
            return bool(apart * speed > 0)
        mine, theirs = self._scene.circles[a], self._scene.circles[b]
        tx, ty = self._down
        sign = ((mine.vx - theirs.vx) * tx + (mine.vy - theirs.vy) * ty).sign()
        return sign == 0 or (sign > 0) is bool(apart > 0)


# -- Joints: where one face goes on as another.


class Joint(NamedTuple):
    """Where one face goes on as another, with a circle straight above.

    Attributes:
        face: the circle, and the first of the two.
        other: the second.
        end: what stands between them.
        pull: whether gravity pulls the circle towards them, below 0, along or away.
    """

    face: AtWall
    other: int
    end: int
    pull: int


class Joints:
    """Knows the joints of faces on one line: faces are open, so that the end there is met, which pushes as they do.

    Args:
        scene: what runs.
        ask, ask_cheaply: decide the sign of a question on the state as it is; the other may leave it open.
    """

    def __init__(
        self, scene: Scene, ask: Callable[[Question], int], ask_cheaply: Callable[[Question], int | None]
    ) -> None:
        self._sides, self._ask, self._ask_cheaply = Sides(scene), ask, ask_cheaply
        self._known: dict[int, list[tuple[int, int]]] = {}

    def at(self, link: Touch, *, surely: bool = True) -> Joint | None:
        """The joint at which a contact is; None elsewhere.

        Args:
            surely: whether it has to be proved; else one is told where nothing at hand speaks against it.
        """
        scene = self._sides.scene
        end = next((i for i in link.circles if i in scene.ends), None)
        if end is None or not is_pair(link):
            return None
        i, pairs = link.a if link.b == end else link.b, self._known.get(end)
        if pairs is None:
            pairs = self._known[end] = joints_at(scene, end)
        for one, other in pairs:
            gaps = [Gap(AtWall(i, k)) for k in (one, other)]
            if not any(map(self._ask_cheaply, gaps)) and (not surely or not any(map(self._ask, gaps))):
                return Joint(AtWall(i, one), other, end, self._sides.pull(i, one))
        return None

    def stays(self, link: Touch) -> bool:
        """Whether a circle that bounces on a level joint surely stays above it."""
        joint = self.at(link)
        return joint is not None and self._sides.level(joint.face.wall) and self._ask(Slide(joint.face)) == 0
