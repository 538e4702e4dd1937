"""A circle and a wall in one number system: how far apart they are, when they meet; walls that fall, and that move."""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, NamedTuple, TypeAlias

from ..laws.formulas import (
    advance,
    face_along,
    face_foot,
    fall_discriminant,
    fall_speed,
    fall_time,
    fall_time_back,
    sag,
    speed_change,
    wall_approach,
    wall_gap,
    wall_hit_time,
)
from ..numbers.system import M, N
from .contact import AtWall, Body, Flight, Gravity, Sides, WallFall

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from flint import arb

    from ...scenarios.numbers.quantity import Quantity
    from ...scenarios.scene import Scene

Rows: TypeAlias = "Sequence[tuple[arb, arb, arb, arb]]"
"""x, y, vx, vy of every circle at an instant, in true coordinates, in balls."""

# -- In the frame that falls, X = x - g t^2 / 2, a circle flies straight and a wall rises: with n the normal to the
# circle's side, p a point of the wall at time 0 and u its velocity, the gap is
#
#     n.X - n.p - r |n| - (n.u) t + (n.g) t^2 / 2
#
# In true coordinates, at the circle's clock, it is the same number. Gravity alone bends it: which of its two zeros is
# the meeting goes by the sign of n.g, whatever u is; without gravity across the wall there is one. A wall pushes by
# the speed relative to it.


class Rebounds(NamedTuple, Generic[N]):
    """Infinitely many bounces, from the first of them on: along which normal, how fast after that one, and when."""

    nx: N
    ny: N
    speed: N
    start: N


class SeenWall(NamedTuple, Generic[N]):
    """A wall as seen from one circle: a point on it, the normal to the circle's side, and |n|^2, |n|."""

    x0: N
    y0: N
    nx: N
    ny: N
    nn: N
    length: N

    def moved(self, drift: tuple[N, N], time: N) -> SeenWall[N]:
        """The same wall at a time, with its velocity."""
        return self._replace(x0=advance(self.x0, drift[0], time), y0=advance(self.y0, drift[1], time))


def fall_of(
    falling: Gravity[N], flight: tuple[N, N, N, N, N], line: SeenWall[N], offset: N, drift: tuple[N, N] | None, zero: N
) -> WallFall[N]:
    """A circle and a wall under gravity, or a wall that moves, at the circle's clock.

    Args:
        falling: half of gravity.
        flight: (x, y, vx, vy, t) of the circle.
        line: the wall at time 0.
        offset: r |n|.
        drift: the wall's velocity; None where it stands.
    """
    x, y, vx, vy, t = flight
    _, _, nx, ny, *_ = line
    if drift is not None:
        line = line.moved(drift, t)
        vx, vy = vx - drift[0], vy - drift[1]
    half = wall_approach(falling.hx, falling.hy, nx, ny)
    gap, approach = wall_gap(x, y, line.x0, line.y0, nx, ny, offset), wall_approach(vx, vy, nx, ny)
    if falling.bent:
        return WallFall(gap, approach, half)
    return WallFall(sag(gap, zero, half, t), fall_speed(approach, half, t), half)


def along_of(falling: Gravity[N], place: tuple[N, N], line: SeenWall[N], clock: N, zero: N) -> tuple[N, N, N]:
    """Where along a face a circle that falls is at its clock, how fast that grows, and half of gravity along it.

    Args:
        place: the first two as its flight tells them (see `formulas.face_along`), in the frame that falls or in true
            coordinates.
    """
    (along, slide), half = place, face_along(falling.hx, falling.hy, zero, zero, line.nx, line.ny)
    if falling.bent:
        return along, slide, half
    return sag(along, zero, half, clock), fall_speed(slide, half, clock), half


class FallingWall(NamedTuple, Generic[M]):
    """A wall under gravity, or one that moves, to a circle: what of it no flight changes.

    Attributes:
        nx, ny: the normal, on the circle's side.
        foot: n.p + r |n|, of a point of the wall at time 0.
        drift: n.u, of its velocity.
        half: half of n.g, whose sign is `pull`.
        pull: whether gravity pulls towards the wall (negative), along it (0), or away from it.
        turn_x, turn_y: (1 + e) n / |n|^2.
    """

    nx: M
    ny: M
    foot: M
    drift: M
    half: M
    pull: int
    turn_x: M
    turn_y: M

    def met(self, x: M, y: M, vx: M, vy: M, clock: M, zero: M, root_of: Callable[[M], M]) -> tuple[M, M] | None:
        """The time from its clock until a circle that is certain to meet the wall does, and at what speed along n.

        That is the root of the discriminant, or without a pull what it is all the way: there is no time in it. In
        enclosures of numbers; None where these do not tell that there is such a time.
        """
        nx, ny, foot, drift, half, pull, *_ = self
        gap, speed = nx * x + ny * y - foot - drift * clock, nx * vx + ny * vy - drift
        if not pull:
            return (wall_hit_time(gap, speed), -speed) if speed < zero else None
        gap, speed = sag(gap, zero, half, clock), fall_speed(speed, half, clock)
        disc = fall_discriminant(gap, speed, half)
        if not disc > zero:
            return None
        root = root_of(disc)
        if speed < zero:
            return fall_time(gap, speed, root), root
        return (fall_time_back(speed, half, root), root) if pull < 0 else None


def falling_wall(
    line: SeenWall[M],
    r: M,
    falling: Gravity[M],
    pull: int,
    drift: tuple[M, M] | None,
    damping: Callable[[M], M],
    zero: M,
) -> FallingWall[M]:
    """A wall as a circle of radius r comes to it, in the falling frame.

    Args:
        line: the wall at time 0.
        falling: half of gravity.
        pull: as `FallingWall` has it.
        drift: the wall's velocity; None where it stands.
        damping: what is left of an elastic change of speed.
    """
    x0, y0, nx, ny, nn, length = line
    return FallingWall(
        nx,
        ny,
        nx * x0 + ny * y0 + r * length,
        zero if drift is None else wall_approach(*drift, nx, ny),
        wall_approach(falling.hx, falling.hy, nx, ny) if pull else zero,
        pull,
        *(damping(speed_change(n)) / nn for n in (nx, ny)),
    )


class WallFlights(Generic[N]):
    """What circles and walls do in one number system: a part of `Flights`, which has the attributes."""

    scene: Scene
    constant: Callable[[Quantity], N]
    root: Callable[[N], N]
    zero: N
    one: N
    bodies: dict[int, Body[N]]
    sides: Sides
    pegs: frozenset[int]
    falling: Gravity[N] | None
    drifts: dict[int, tuple[N, N]]
    slopes: dict[int, int]
    bounced: dict[int, tuple[Rebounds[N], ...]]
    paces: dict[int, tuple[N, N]]
    _lines: dict[int, tuple[SeenWall[N], SeenWall[N]]]

    def line(self, circle: int, wall: int) -> SeenWall[N]:
        """The wall as seen from a circle."""
        if wall not in self._lines:
            exact = self.scene.walls[wall]
            nx, ny = exact.normal
            x0, y0, mx, my = (self.constant(value) for value in (exact.x0, exact.y0, nx, ny))
            nn = mx * mx + my * my
            length = self.root(nn)
            self._lines[wall] = (SeenWall(x0, y0, mx, my, nn, length), SeenWall(x0, y0, -mx, -my, nn, length))
        return self._lines[wall][self.sides.negative(circle, wall)]

    def falls(self, circle: int) -> Gravity[N] | None:
        """What bends the gap of a circle and walls; None where nothing does: what a wall carries flies straight."""
        return None if circle in self.pegs else self.falling

    def pull(self, link: AtWall) -> int:
        """Whether gravity pulls a circle that falls towards a wall (negative), along it (0) or away from it."""
        return 0 if self.falls(link.circle) is None else self.sides.pull(*link[:2])

    def wall_gap(self, link: AtWall) -> N:
        """The distance of a circle from a wall, less its radius, times |n|; when, see `round_gap`."""
        x, y, vx, vy, _, _, late, *_ = self.bodies[link.circle].flight
        if (falling := self.falls(link.circle)) is not None:
            fall = self.fall(falling, link)
            return fall.gap if late is None else sag(fall.gap, fall.approach, fall.half, late)
        if late is None:
            return self._wall_gap(link, x, y)
        return self._wall_gap(link, advance(x, vx, late), advance(y, vy, late))

    def _wall_gap(self, link: AtWall, x: N, y: N) -> N:
        line = self.line(*link[:2])
        return wall_gap(x, y, line.x0, line.y0, line.nx, line.ny, self.bodies[link.circle].r * line.length)

    def wall_approach(self, link: AtWall) -> N:
        """n.v relative to the wall: negative while the two come nearer; under gravity as the flight begins."""
        flight, line = self.bodies[link.circle].flight, self.line(*link[:2])
        if (falling := self.falls(link.circle)) is not None:
            fall = self.fall(falling, link)
            return fall.approach if flight.late is None else fall_speed(fall.approach, fall.half, flight.late)
        return wall_approach(flight.vx, flight.vy, line.nx, line.ny)

    def wall_hit(self, link: AtWall) -> tuple[N, N]:
        """As `round_hit`."""
        flight = self.bodies[link.circle].flight
        pull, falling = self.pull(link), self.falls(link.circle)
        if falling is not None and (pull or link.wall in self.drifts):
            fall = self.fall(falling, link)
            if not pull:
                return flight.t, wall_hit_time(fall.gap, fall.approach)
            root = self.root(fall_discriminant(fall.gap, fall.approach, fall.half))
            if pull > 0 or self.surely_falls(fall.approach):
                return flight.t, fall_time(fall.gap, fall.approach, root)
            return flight.t, fall_time_back(fall.approach, fall.half, root)
        return flight.t, wall_hit_time(self._wall_gap(link, flight.x, flight.y), self.wall_approach(link))

    def wall_parts(self, link: AtWall) -> tuple[N, N, N]:
        """As `round_parts`; without gravity across the wall there is no root in it."""
        clock = self.bodies[link.circle].flight.t
        if self.falling is not None and self.pull(link):
            fall = self.fall(self.falling, link)
            pull = fall.half + fall.half
            return (
                clock - fall.approach / pull,
                -(self.one / pull),
                fall_discriminant(fall.gap, fall.approach, fall.half),
            )
        clock, wait = self.wall_hit(link)
        return clock + wait, self.zero, self.zero

    def wall_graze(self, link: AtWall) -> tuple[N, N]:
        """As `graze`, of a circle and a wall that gravity pulls it away from."""
        assert self.falling is not None
        fall = self.fall(self.falling, link)
        return self.bodies[link.circle].flight.t, -fall.approach / (fall.half + fall.half)

    def wall_discriminant(self, link: AtWall) -> N:
        """The square of the speed at which a circle comes to a wall under gravity; negative if it never does."""
        assert self.falling is not None
        fall = self.fall(self.falling, link)
        return fall_discriminant(fall.gap, fall.approach, fall.half)

    def fall(self, falling: Gravity[N], link: AtWall) -> WallFall[N]:
        """A circle and a wall under gravity, or a wall that moves, at the circle's clock."""
        body, line = self.bodies[link.circle], self.line(*link[:2])
        offset = body.r * line.length
        return fall_of(falling, body.flight[:5], line, offset, self.drifts.get(link.wall), self.zero)

    def surely_falls(self, speed: N) -> bool:
        """Whether a speed is surely below zero: of two forms of one number it chooses the one that is sharp there.

        Exact numbers need no choice.
        """
        return False

    def face_foot(self, link: AtWall, far: bool) -> N:
        """Where along a face an approaching circle meets its line, from its start or, `far`, to its end.

        Positive between the ends, in the scale of `formulas.face_foot`.
        """
        flight, line = self.bodies[link.circle].flight, self.line(*link[:2])
        along = face_along(flight.x, flight.y, line.x0, line.y0, line.nx, line.ny)
        slide = face_along(flight.vx, flight.vy, self.zero, self.zero, line.nx, line.ny)
        approach = self.wall_approach(link)
        foot = face_foot(along, slide, self._wall_gap(link, flight.x, flight.y), approach)
        return -(line.nn * approach) - foot if far else foot

    def face_place(self, link: AtWall, far: bool) -> tuple[N, N, N | None, N]:
        """Where along a face a circle is at its clock, as `face_foot`, how fast that grows, and the clock.

        Before the clock: half of gravity along the face, None without; places and speeds are in true coordinates, and
        as seen from a face that moves.
        """
        flight, line = self.bodies[link.circle].flight, self.line(*link[:2])
        drift = self.drifts.get(link.wall)
        at = line if drift is None else line.moved(drift, flight.t)
        along = face_along(flight.x, flight.y, at.x0, at.y0, line.nx, line.ny)
        ux, uy = (self.zero, self.zero) if drift is None else drift
        slide = face_along(flight.vx, flight.vy, ux, uy, line.nx, line.ny)
        bend = None
        if (falling := self.falls(link.circle)) is not None and self.scene.gravity is not None:
            place = along_of(falling, (along, slide), line, flight.t, self.zero)
            along, slide, bend = place
        if not far:
            return along, slide, bend, flight.t
        return line.nn - along, -slide, None if bend is None else -bend, flight.t

    def true_rows(self, time: N) -> list[tuple[N, N, N, N]]:
        """(x, y, vx, vy) of every circle at a time, in true coordinates."""
        rows: list[tuple[N, N, N, N]] = []
        for body in self.bodies.values():
            x, y, vx, vy, t, *_ = body.flight
            bend, lag = self.bend(body.index), time - t
            if (pace := self.paces.get(body.index)) is not None:
                rows.append((advance(x, pace[0], time), advance(y, pace[1], time), *pace))
            elif bend is None:
                still = body.index in self.pegs and body.flight.rest
                rows.append((x, y, vx, vy) if still else (advance(x, vx, lag), advance(y, vy, lag), vx, vy))
            elif bend.bent:
                rows.append(bend.flown((x, y, vx, vy), lag))
            else:
                rows.append(
                    (
                        x + vx * lag + sag(self.zero, self.zero, bend.hx, time),
                        y + vy * lag + sag(self.zero, self.zero, bend.hy, time),
                        fall_speed(vx, bend.hx, time),
                        fall_speed(vy, bend.hy, time),
                    )
                )
        return rows

    # -- circles that walls carry

    def true_row(self, body: Body[N]) -> tuple[N, N, N, N]:
        """(x, y, vx, vy) of a body that falls, in true coordinates, at the instant."""
        x, y, vx, vy, t, _, late, *_ = body.flight
        falls = self.falling
        assert falls is not None
        if not falls.bent:
            x, y = x + falls.hx * t * t, y + falls.hy * t * t
            vx, vy = vx + (falls.hx + falls.hx) * t, vy + (falls.hy + falls.hy) * t
        return (x, y, vx, vy) if late is None else falls.flown((x, y, vx, vy), late)

    def bend(self, index: int) -> Gravity[N] | None:
        """Half of what bends the flight of a circle: gravity, or what a slope that it slides down leaves of it.

        None of one that stands or flies straight.
        """
        if index in self.slopes:
            hx, hy = self.scene.walls[self.slopes[index]].along(*(part / 2 for part in self.scene.gravity or ()))
            return Gravity(self.constant(hx), self.constant(hy), True)
        return self.falls(index)

    @property
    def slides(self) -> dict[int, Gravity[N]]:
        """The circles that slide down slopes, with half of what there is of gravity along those."""
        return {i: bend for i in self.slopes if (bend := self.bend(i)) is not None}

    def settle(self, index: int, wall: int, slides: bool, bounces: bool, other: int = -1) -> None:
        """Has a wall carry a body; its velocity across the wall, which is zero, is left out.

        A wall that is a slope bears all of gravity but what there is along it. Of a body that bounces on it infinitely
        often, ever lower, the normal, the speed along that and the time are noted, for each time that it does; between
        two slopes, straight up.
        """
        body, zero = self.bodies[index], self.zero
        if bounces:
            known = self.bounced.get(index, ())
            if other < 0:
                line, speed = self.line(index, wall), self.wall_approach(AtWall(index, wall))
                row = Rebounds(line.nx, line.ny, speed, body.flight.instant)
            else:
                assert self.falling is not None
                (nx, ny), (*_, vx, vy) = self.falling.upward, self.true_row(body)
                row = Rebounds(nx, ny, nx * vx + ny * vy, body.flight.instant)
            self.bounced = {**self.bounced, index: (*known, row)}
        _, _, _, _, t, instant, late, last, _ = body.flight
        x, y, vx, vy = self.true_row(body)
        if slides:
            line = self.line(index, wall)
            slide = face_along(vx, vy, zero, zero, line.nx, line.ny) / line.nn
            vx, vy = line.ny * slide, -(line.nx * slide)
            if not self.sides.level(wall):
                self.slopes = {**self.slopes, index: wall}
                bend = self.bend(index)
                assert bend is not None
                if late is not None:
                    x, y, vx, vy = bend.flown((x, y, vx, vy), -late)
            elif late is not None:
                x, y = advance(x, vx, -late), advance(y, vy, -late)
        else:
            vx = vy = zero
        body.flight = Flight(x, y, vx, vy, t, instant, late, last, rest=not slides)
        self.pegs |= {index}

    def lift(self, index: int) -> None:
        """Lets a body fall from the instant on: its velocity is as it was."""
        body, falls = self.bodies[index], self.falling
        assert falls is not None
        self.pegs -= {index}
        x, y, vx, vy, t, instant, late, last, _ = body.flight
        back = self.zero if late is None else late
        if falls.bent:
            assert late is None
        else:  # x + h (s - T)^2 at the time s, less h s^2, with T = t + late
            rest, twice = (back - t) * (back + t), -(instant + instant)
            x, y, vx, vy = x + falls.hx * rest, y + falls.hy * rest, vx + falls.hx * twice, vy + falls.hy * twice
        body.flight = Flight(x, y, vx, vy, t, instant, late, last)
