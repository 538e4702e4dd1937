"""The exact engine against brute force where everything happens at once: ties, grazes, touching, sliding, reversal.

The brute force below keeps no queue and remembers no contact: at every instant it looks at every gap anew, in plain
numbers of 500 bits, and takes what is below 2**-180 for zero. That is no proof, but nothing in these small scenes
comes so close to zero without being it.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import combinations
from random import Random

import mpmath
import pytest
from flint import arb
from mpmath import mpf
from referee import compare_to_referee, gas, polygon, referee

from truebreak.exact import ExactEngine, live
from truebreak.scenarios import Circle, Quantity, Scene, Wall
from truebreak.scenarios.errors import SceneError

F = Fraction
BITS = 500
ZERO = mpf(2) ** -180
SAME_TIME = mpf(10) ** -25
SAME_STATE = 1e-13
"""Errors allowed relative to 1 + the size: the state is compared as doubles."""

Link = tuple[int, int]


# -- brute force


def number(value) -> mpf:
    """A Quantity or an ExactValue as an mpf."""
    mantissa, exponent = value.ball(BITS + 50).mid().man_exp()
    return mpf(int(mantissa)) * mpf(2) ** int(exponent)


class Table:
    """All circles at one time; links as in the exact engine: (i, j) two circles, (i, n + k) circle and wall."""

    def __init__(self, scene: Scene) -> None:
        self.scene, self.n, self.time = scene, len(scene.circles), mpf(0)
        self.place = [[number(c.x), number(c.y)] for c in scene.circles]
        self.speed = [[number(c.vx), number(c.vy)] for c in scene.circles]
        self.r = [number(c.r) for c in scene.circles]
        self.w = [mpf(0) if c.fixed else 1 / number(c.m) for c in scene.circles]
        self.walls = []
        for wall in scene.walls:
            nx, ny = map(number, wall.normal)
            length = mpmath.hypot(nx, ny)
            self.walls.append((number(wall.x0), number(wall.y0), nx / length, ny / length))
        pairs = [*combinations(range(self.n), 2)]
        ends = [(i, self.n + k) for i in range(self.n) for k in range(len(self.walls))]
        self.links = sorted(pairs + ends)

    def look(self, link: Link) -> tuple[mpf, list[mpf], mpf]:
        """The gap, the direction of approach (a unit vector), and how fast the gap grows."""
        i, j = link
        if j < self.n:
            d = [q - p for p, q in zip(self.place[i], self.place[j], strict=True)]
            distance = mpmath.hypot(*d)
            u = [c / distance for c in d] if distance else [mpf(0), mpf(0)]
            growing = sum(c * (q - p) for c, p, q in zip(u, self.speed[i], self.speed[j], strict=True))
            return distance - self.r[i] - self.r[j], u, growing
        x0, y0, nx, ny = self.walls[j - self.n]
        height = (self.place[i][0] - x0) * nx + (self.place[i][1] - y0) * ny
        u = [nx, ny] if height > 0 else [-nx, -ny]
        return abs(height) - self.r[i], u, sum(c * p for c, p in zip(u, self.speed[i], strict=True))

    def arms(self, link: Link) -> dict[int, list[mpf]]:
        i, j = link
        _, u, _ = self.look(link)
        return {i: [-c for c in u], j: u} if j < self.n else {i: u}

    def kick(self, links: list[Link]) -> tuple[Link, ...]:
        """Impulses s >= 0 with G s + 2 u >= 0 and s (G s + 2 u) = 0, by trying every set of pushing contacts."""
        arms, speeds = [self.arms(link) for link in links], [self.look(link)[2] for link in links]
        places = range(len(links))

        def coupling(a: int, b: int) -> mpf:
            shared = arms[a].keys() & arms[b].keys()
            return sum((self.w[i] * mpmath.fdot(arms[a][i], arms[b][i]) for i in shared), mpf(0))

        matrix = [[coupling(a, b) for b in places] for a in places]
        for size in range(1, len(links) + 1):
            for pushing in combinations(places, size):
                inner = mpmath.matrix([[matrix[a][b] for b in pushing] for a in pushing])
                if abs(mpmath.det(inner)) < ZERO:
                    continue
                solved = mpmath.lu_solve(inner, mpmath.matrix([-2 * speeds[a] for a in pushing]))
                strength = dict(zip(pushing, solved, strict=True))
                enough = all(sum(matrix[a][b] * s for b, s in strength.items()) + 2 * speeds[a] > -ZERO for a in places)
                if enough and all(s > -ZERO for s in solved):
                    for a, s in strength.items():
                        for i, arm in arms[a].items():
                            self.speed[i] = [v + self.w[i] * s * c for v, c in zip(self.speed[i], arm, strict=True)]
                    return tuple(links[a] for a, s in strength.items() if s > ZERO)
        raise AssertionError("no impulses keep the contacts apart")

    def settle(self) -> frozenset[Link]:
        """Rounds of impulses until no contact approaches; the contacts that took part."""
        touching = [link for link in self.links if abs(self.look(link)[0]) < ZERO]
        taking_part: set[Link] = set()
        for _ in range(300):
            coming = [link for link in touching if self.look(link)[2] < -ZERO]
            if not coming:
                return frozenset(taking_part)
            taking_part |= set(coming)
            self.kick(coming if self.scene.tie_policy.name == "simultaneous" else coming[:1])
        raise OverflowError("the impulses at one instant do not come to an end")

    def wait(self) -> mpf | None:
        """The time to the next contact."""
        waits = []
        for link in self.links:
            gap, _, growing = self.look(link)
            if abs(gap) < ZERO or growing >= -ZERO:
                continue
            i, j = link
            if j >= self.n:
                waits.append(-gap / growing)
                continue
            (dx, dy), (vx, vy), reach = (
                [q - p for p, q in zip(self.place[i], self.place[j], strict=True)],
                [q - p for p, q in zip(self.speed[i], self.speed[j], strict=True)],
                self.r[i] + self.r[j],
            )
            square, cross = vx * vx + vy * vy, dx * vy - dy * vx
            disc = square * reach**2 - cross**2
            if disc > ZERO * square:
                waits.append((-(dx * vx + dy * vy) - mpmath.sqrt(disc)) / square)
        return min(waits, default=None)

    def advance(self, wait: mpf) -> None:
        self.time += wait
        for place, speed in zip(self.place, self.speed, strict=True):
            place[:] = [p + v * wait for p, v in zip(place, speed, strict=True)]


Instant = tuple[mpf, frozenset[Link], list[list[mpf]]]


def brute_force(scene: Scene) -> Iterator[Instant]:
    """(time, contacts that took part, states as they leave) of every instant."""
    table = Table(scene)
    flip_at = None if scene.reverse_at is None else number(scene.reverse_at)
    to_flip = scene.reverse_after
    done = 0
    while True:
        contacts = table.settle()
        if contacts:
            done += 1
            yield table.time, contacts, [p + v for p, v in zip(table.place, table.speed, strict=True)]
        if to_flip == done and contacts:
            to_flip, table.speed = None, [[-v for v in speed] for speed in table.speed]
            continue
        wait = table.wait()
        if flip_at is not None and (wait is None or table.time + wait > flip_at + ZERO):
            table.advance(flip_at - table.time)
            flip_at, table.speed = None, [[-v for v in speed] for speed in table.speed]
            continue
        if wait is None:
            return
        table.advance(wait)


def compare_to_brute_force(scene: Scene, events: int) -> str:
    """Holds the exact engine against brute force, instant by instant; the name of its reason to stop."""
    run = ExactEngine(max_bits=1 << 14).run(scene, events=events)
    expected = brute_force(scene)
    index = scene.ids.index
    with mpmath.workprec(BITS):
        for event in run.events:
            told = next(expected, None)
            assert told is not None, f"{scene.name}: {event.contacts} at {float(event.time)} do not happen"
            time, contacts, rows = told
            where = f"{scene.name}, event {event.index}, time {mpmath.nstr(time, 17)}"
            assert abs(number(event.time) - time) <= SAME_TIME * (1 + time), where
            assert {(index(a), index(b)) for a, b in event.contacts} == contacts, where
            for mine, theirs in zip(run.at(event.time).array(), rows, strict=True):
                for a, b in zip(mine, theirs, strict=True):
                    assert abs(mpf(float(a)) - b) <= SAME_STATE * (1 + abs(b)), where
        if run.stop.reason.name in ("QUIET", "HORIZON"):
            assert next(expected, None) is None, f"{scene.name}: the engine saw no more events"
    return run.stop.reason.name


# -- scenes where much happens at once


def crowd(seed: int) -> Scene:
    """Circles on a grid with speeds of few values: touching, in a row, on a wall, or symmetric; then moved."""
    draw = Random(seed)
    kind = draw.choice(["grid", "grid", "grid", "touch", "line", "slide", "sym"])
    n, side = draw.choice([2, 3, 3, 4, 4, 5, 6, 8]), draw.choice([3, 4, 5, 6])
    cells = [(x, y) for x in range(side) for y in range(side)] if kind != "line" else [(x, 0) for x in range(3 * n)]
    motion = draw.choice(["id", "shift", "rot345", "rot45", "scale", "rot30"])
    policy = draw.choice(["simultaneous"] * 4 + ["sequential"])
    r = draw.choice([F(1, 2), F(1, 2), F(1, 4), F(1, 3), F(2, 5)]) if kind != "touch" else F(1, 2)
    draw.shuffle(cells)
    rows = []
    for x, y in cells[:n]:
        vx, vy = draw.choice([-1, 0, 0, 1]), draw.choice([-1, 0, 0, 1]) if kind != "line" else 0
        if kind == "touch" and draw.random() < 0.7:
            vx = vy = 0
        m = draw.choice([1, 1, 1, 1, 2, 3, "oo" if draw.random() < 0.3 else 1])
        if m == "oo":
            vx = vy = 0
        rows.append((F(x), F(y), r, vx * draw.choice([F(1), F(1), F(1, 2), F(2)]), F(vy), m))
    if kind == "touch" and draw.random() < 0.7:
        y, vy = draw.choice([0, 1, F(1, 2), F(1, 2)]), F(draw.choice([0, 0, 1]), 3)
        rows.append((F(-draw.choice([3, 5])), F(y), r, F(draw.choice([1, 2])), vy, 1))
    walls = []
    if kind == "slide":
        walls.append((F(0), -r, F(1), -r))
        rows = [
            (x, y, r, vx if y or m == "oo" else F(draw.choice([-1, 0, 1, 2])), vy if y else F(0), m)
            for x, y, r, vx, vy, m in rows
        ]
    if kind == "sym":
        above = [(x, y + 1, r, vx, vy, m) for x, y, r, vx, vy, m in rows[:4]]
        rows = [row for x, y, r, vx, vy, m in above for row in ((x, y, r, vx, vy, m), (x, -y, r, vx, -vy, m))]
        if draw.random() < 0.7:
            x, vx = -draw.choice([3, 4, 6]), draw.choice([1, 2])
            rows.append((F(x), F(0), r * draw.choice([F(1), F(3, 2)]), F(vx), F(0), draw.choice([1, 2])))
    if draw.random() < 0.6 and kind != "line":
        left, right = draw.choice([(-6, side + 3), (-5, side + 2), (-5, side + F(5, 2))])
        walls += [(left, 0, left, 1), (right, 0, right, 1)]
        if kind != "slide":
            walls += [(0, left - 1, 1, left - 1), (0, right + 4, 1, right + 4)]
        elif draw.random() < 0.5:
            walls.append((0, right, 1, right))
    if draw.random() < 0.15:
        walls.append((-9, -9, -8, -10))
    changes = {}
    if draw.random() < 0.3:
        after, at = draw.choice([1, 2, 3]), F(draw.randrange(1, 7), draw.choice([1, 2]))
        changes = draw.choice([{"reverse_after": after}, {"reverse_at": at}])
    return moved(rows, walls, motion, tie_policy=policy, name=f"{kind} {motion} {policy} {seed}", **changes)


TURNS = {
    "rot345": ("3/5", "4/5"),
    "rot45": ("sqrt(2)/2", "sqrt(2)/2"),
    "rot30": ("sqrt(3)/2", "1/2"),
    "scale": ("sqrt(2)", "0"),
}


def moved(rows, walls, motion: str, **changes) -> Scene:
    """The scene turned by an angle, stretched by sqrt(2), or shifted by roots: the same history in harder numbers."""
    c, s = map(Quantity.of, TURNS.get(motion, ("1", "0")))
    shift = map(Quantity.of, ("sqrt(3)/7", "-sqrt(5)/3") if motion == "shift" else ("0", "0"))
    dx, dy = shift

    def turn(x, y):
        return c * x - s * y, s * x + c * y

    def place(x, y):
        x, y = turn(x, y)
        return x + dx, y + dy

    stretch = c if motion == "scale" else Quantity.of(1)
    circles = [Circle(*place(x, y), stretch * r, *turn(vx, vy), m) for x, y, r, vx, vy, m in rows]
    return Scene(circles, [Wall(*place(a, b), *place(c, d)) for a, b, c, d in walls], **changes)


def check_crowds(seeds: range, events: int) -> set[str]:
    stops = set()
    for seed in seeds:
        try:
            scene = crowd(seed)
        except SceneError:  # a circle lies across a wall
            continue
        try:
            stops.add(compare_to_brute_force(scene, events))
        except OverflowError:  # endless impulses: brute force has nothing to say
            continue
    return stops


@pytest.mark.parametrize("start", range(0, 400, 50))
def test_what_happens_at_once_is_what_brute_force_finds(start):
    assert check_crowds(range(start, start + 50), events=12) <= {"QUIET", "EVENTS", "HORIZON"}


@pytest.mark.parametrize("start", range(1000, 1200, 50))
def test_it_is_the_same_without_exact_fields(start, monkeypatch):
    monkeypatch.setattr(live, "FIELD_BITS", 0)
    assert check_crowds(range(start, start + 50), events=12) <= {"QUIET", "EVENTS", "HORIZON"}


@pytest.mark.slow
@pytest.mark.parametrize("field_bits", [0, 768])
def test_a_thousand_crowds(field_bits, monkeypatch):
    monkeypatch.setattr(live, "FIELD_BITS", field_bits)
    check_crowds(range(10_000, 11_000), events=20)


# -- one law each, with the smallest scene that once broke it


def test_impulses_in_sequence_break_the_symmetry_that_the_scene_had():
    scene = Scene([Circle(-5, 0, vx=1), Circle(0, 1), Circle(0, -1)], tie_policy="sequential", name="two at once")
    assert compare_to_brute_force(scene, 3) == "QUIET"
    velocities = ExactEngine().run(scene).final.circles
    assert sum((c.vy.ball(200) for c in velocities), arb(0)).contains(0)


def test_a_graze_at_the_very_reversal_leaves_nothing_behind():
    a = Circle("-6/5", "17/5", vx="12/5", vy="-9/5")
    b, c = Circle(0, 0, m="oo"), Circle("-6/5", "27/5", vy=7, m=3)
    scene = Scene([a, b, c], reverse_at=1, name="graze at the reversal")
    compare_to_brute_force(scene, 3)


def test_an_instant_lasts_until_no_contact_approaches():
    a, b = Circle(0, -1, "1/2", vy=1), Circle(1, 0, "1/2", m=3)
    scene = Scene([a, b, Circle(-2, 0, "1/2", vx=1)], name="grazing one while hit by another")
    assert compare_to_brute_force(scene, 3) == "QUIET"


@pytest.mark.parametrize("power", [-300, -160, -99, -90, -60, -9, 0, 9, 60, 80, 99, 160, 300])
def test_a_near_graze_is_told_from_a_graze_at_any_size(power):
    size = F(10) ** power
    for angle, distance, offset in [(2, 7, 10**17), (3, 30, 10**20), (5, 11, 10**40), (9, 4, 10**300)]:
        c, s = F(angle**2 - 1, angle**2 + 1), F(2 * angle, angle**2 + 1)
        for sign in (-1, 0, 1):
            aside = 2 + F(sign, offset)
            x, y = c * distance - s * aside, s * distance + c * aside
            moving = Circle(0, 0, size, c * size, s * size)
            run = ExactEngine().run(Scene([moving, Circle(x * size, y * size, size)]))
            assert len(run.events) == (1 if sign < 0 else 0)


@pytest.mark.parametrize("late", [F(0), F(1, 10**40), F(-1, 10**40), F(1, 10**300), F(-1, 10**300)])
def test_a_near_tie_is_told_from_a_tie(late):
    # both meet their partner after 4 - sqrt(3), the second one later by `late`
    one = [Circle(0, 0, vx=1), Circle(4, 1)]
    two = [Circle(-late, 10, vx=1), Circle(4, 11)]
    contacts = [[tuple(c) for c in event.contacts] for event in ExactEngine().run(Scene(one + two)).events]
    first, second = [("c1", "c2")], [("c3", "c4")]
    assert contacts == ([first + second] if late == 0 else [first, second] if late > 0 else [second, first])


@pytest.mark.parametrize("until", ["4 - sqrt(3)", "sqrt(2)", "4 - sqrt(3) - 1/10000000000000000000000000000000000"])
def test_an_event_at_the_time_limit_happens_and_one_beyond_does_not(until):
    run = ExactEngine().run(Scene([Circle(0, 0, vx=1), Circle(4, 1)]), until=until)
    assert len(run.events) == (1 if until == "4 - sqrt(3)" else 0)
    assert run.stop.reason.name == "HORIZON"
    assert run.final["c1"].x.digits(20) == (Quantity.of(until)).ball(100).str(20, radius=False)


@pytest.mark.parametrize("exponent", [-330, -12, 330])
def test_times_beyond_the_doubles_are_times(exponent):
    speed = Quantity.of(F(10) ** exponent)
    scene = Scene([Circle(0, 0, vx=speed), Circle(4, 1), Circle(40, 1)])
    run = ExactEngine().run(scene)
    with mpmath.workprec(BITS):
        first = mpmath.mpf(10) ** -exponent * (4 - mpmath.sqrt(3))
        assert abs(number(run.events[0].time) / first - 1) < SAME_TIME


@pytest.mark.parametrize(("maker", "events"), [
    (lambda: gas(101, 3, 5, False), 150),
    (lambda: gas(102, 12, 9, True), 120),
    (lambda: gas(103, 25, 12, False), 100),
    (lambda: polygon(104, [(1, 0), (9, 2), (10, 7), (4, 10), (0, 5)], 5), 120),
])  # fmt: skip
def test_gases_that_the_engine_has_not_seen_are_as_the_referee_finds(maker, events):
    scene = maker()
    history = referee(scene, events, bits=1500)
    assert len(history.events) == events
    compare_to_referee(ExactEngine().run(scene, events=events), history)


@pytest.mark.slow
def test_three_thousand_events_are_as_the_referee_finds():
    scene = gas(3, 10, 8, False)
    history = referee(scene, 3000, bits=16_000)
    assert len(history.events) == 3000
    compare_to_referee(ExactEngine().run(scene, events=3000), history)
