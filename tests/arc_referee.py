"""A referee of scenes with arcs too, in plain coordinates and 100 digits: angles, and distances from sets of points."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from mpmath import atan2, cos, mpf, pi, sin, sqrt
from segment_referee import SAME, Disc, Referee, falls, number

from truebreak.scenarios import Scene


@dataclass
class Bow:
    """An arc by its circle, the angle at which it begins and the angle through which it goes."""

    id: str
    x: mpf
    y: mpf
    r: mpf
    start: mpf
    turn: mpf

    def place(self, share: int) -> tuple[mpf, mpf]:
        """Its start or its end."""
        angle = self.start + share * self.turn
        return self.x + self.r * cos(angle), self.y + self.r * sin(angle)

    def holds(self, x: mpf, y: mpf) -> bool:
        """Whether the direction to a point is strictly between those of the ends."""
        if self.turn >= 2 * pi:
            return True
        angle = (atan2(y - self.y, x - self.x) - self.start) % (2 * pi)
        return SAME < angle < self.turn - SAME

    def away(self, x: mpf, y: mpf) -> mpf:
        """How far a point is from it."""
        far = sqrt((x - self.x) ** 2 + (y - self.y) ** 2)
        if far < SAME or self.holds(x, y):
            return abs(far - self.r)
        return min(sqrt((x - px) ** 2 + (y - py) ** 2) for px, py in map(self.place, (0, 1)))


def leaves(dx: mpf, dy: mpf, vx: mpf, vy: mpf, reach: mpf) -> mpf | None:
    """When |d + v t| comes up to a reach, after it was below it: for the last time. None: never from now on."""
    a, b, c = vx * vx + vy * vy, dx * vx + dy * vy, dx * dx + dy * dy - reach * reach
    if a < SAME or b * b - a * c < SAME:
        return None
    t = (-b + sqrt(b * b - a * c)) / a
    return t if t > SAME else None


class ArcReferee(Referee):
    """One run."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        self.bows: list[Bow] = []
        for arc in scene.arcs:
            x, y, r, x0, y0, x1, y1 = (number(q) for q in (arc.x, arc.y, arc.r, arc.x0, arc.y0, arc.x1, arc.y1))
            if arc.full:
                self.bows.append(Bow(arc.id, x, y, r, mpf(0), 2 * pi))
                continue
            start = atan2(y0 - y, x0 - x)
            self.bows.append(Bow(arc.id, x, y, r, start, (atan2(y1 - y, x1 - x) - start) % (2 * pi)))
            for px, py in map(self.bows[-1].place, (0, 1)):
                if all(abs(ex - px) + abs(ey - py) > SAME for _, ex, ey, _ in self.ends):
                    self.ends.append((arc.id, px, py, mpf(0)))

    def normals(self) -> Iterator[tuple[tuple[str, str], list[tuple[Disc, mpf, mpf]]]]:
        yield from super().normals()
        for disc in self.discs:
            for bow in self.bows:
                dx, dy = disc.x - bow.x, disc.y - bow.y
                far = sqrt(dx * dx + dy * dy)
                if far < SAME or abs(abs(far - bow.r) - disc.r) > SAME or not bow.holds(disc.x, disc.y):
                    continue
                side = 1 if far > bow.r else -1
                if disc.r == 0:  # a point is on the side from which it comes
                    side = -1 if disc.vx * dx + disc.vy * dy > 0 else 1
                yield (disc.id, bow.id), [(disc, side * dx / far, side * dy / far)]

    def next_time(self) -> tuple[mpf, bool] | None:
        found = [] if (first := super().next_time()) is None else [first]
        for disc in self.discs:
            for bow in self.bows:
                dx, dy = disc.x - bow.x, disc.y - bow.y
                hit = falls(dx, dy, disc.vx, disc.vy, disc.r + bow.r)
                times = [hit[0]] if hit is not None and hit[1] and hit[0] > SAME else []
                if disc.r < bow.r:
                    times += [t] if (t := leaves(dx, dy, disc.vx, disc.vy, bow.r - disc.r)) is not None else []
                found += [(t, False) for t in times if bow.holds(disc.x + t * disc.vx, disc.y + t * disc.vy)]
        first = min((t for t, _ in found), default=None)
        return None if first is None else (first, any(blunt for t, blunt in found if t < first + SAME))

    def clear(self) -> bool:
        return super().clear() and all(
            bow.away(disc.x, disc.y) > disc.r - SAME for disc in self.discs if disc.w for bow in self.bows
        )
