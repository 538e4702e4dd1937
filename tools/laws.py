"""The laws of flight, meeting and impulse, in any kind of number."""

from .arithmetic import ZERO


def place(flight, t):
    x, y, vx, vy, since, _ = flight
    return (x, y) if t is since else (x + vx * (t - since), y + vy * (t - since))


class World:
    """The scene in one kind of number. `fly(i)` is the flight of circle i: (x, y) at time t with velocity (vx, vy), as
    (x, y, vx, vy, t, age). A contact (i, j) is of two circles if 0 <= j < n, of wall j - n, or of pocket -1 - j."""

    def __init__(self, data, kind):
        self.n, self.zero = len(data["circles"]), kind(ZERO)
        self.circles = [[kind(x) for x in c] for c in data["circles"]]
        self.pockets = [[kind(x) for x in p] for p in data["pockets"]]
        self.walls = [[kind(x) for x in w] for w in data["walls"]]
        self.sides, self.lengths = data["sides"], {}

    def view(self, fly, c):
        """Of two, at the start of the younger flight: time, d, v, R; of a wall: time, the way to it, n, r |n|."""
        a, (i, j) = fly(c[0]), c
        if j >= self.n:
            x, y, nx, ny = self.walls[j - self.n]
            if j not in self.lengths:
                self.lengths[j] = (nx * nx + ny * ny).sqrt()
            if not self.sides[c]:
                nx, ny = -nx, -ny
            return a[4], x - a[0], y - a[1], nx, ny, self.circles[i][4] * self.lengths[j]
        x, y, reach = self.pockets[-1 - j] if j < 0 else (None, None, self.circles[i][4] + self.circles[j][4])
        b = fly(j) if j >= 0 else (x, y, self.zero, self.zero, *a[4:])
        t = a[4] if a[5] >= b[5] else b[4]
        (ax, ay), (bx, by) = place(a, t), place(b, t)
        return t, bx - ax, by - ay, b[2] - a[2], b[3] - a[3], reach

    def meeting(self, fly, c):
        """At that start: time, gap, closing speed, discriminant and |v|^2 (None of a wall)."""
        t, dx, dy, vx, vy, reach = self.view(fly, c)
        if c[1] >= self.n:
            return t, -(vx * dx + vy * dy) - reach, vx * fly(c[0])[2] + vy * fly(c[0])[3], None, None
        cross, square, speed = dx * vy - dy * vx, reach * reach, vx * vx + vy * vy
        return t, dx * dx + dy * dy - square, dx * vx + dy * vy, speed * square - cross * cross, speed

    def time(self, fly, c, graze=False):
        """When the gap falls through zero; of a graze, when it is zero."""
        t, gap, closing, disc, speed = self.meeting(fly, c)
        return t - closing / speed if graze else t + gap / ((disc.sqrt() if disc else self.zero) - closing)

    def arms(self, fly, c):
        """The movable circles of a contact, each with the direction in which it is pushed, and its inverse mass."""
        _, dx, dy, vx, vy, _ = self.view(fly, c)
        ways = {c[0]: (vx, vy)} if c[1] >= self.n else {c[0]: (-dx, -dy), c[1]: (dx, dy)}
        return {i: (*way, self.circles[i][5]) for i, way in ways.items()}

    def blow(self, fly, push, others=()):
        """The impulses s of contacts, 2u + G s of others, and the velocities after: G s = -2u, by elimination."""
        arms = {c: self.arms(fly, c) for c in (*push, *others)}
        twice = {c: (u := self.meeting(fly, c)[2]) + u for c in arms}

        def effect(c, o):
            if c == o and c[1] < self.n:
                reach = self.circles[c[0]][4] + self.circles[c[1]][4]
                return (self.circles[c[0]][5] + self.circles[c[1]][5]) * (reach * reach)
            both = [(*arms[c][i], *arms[o][i]) for i in arms[c] if i in arms[o]]
            return sum(((x * p + y * q) * w for x, y, w, p, q, _ in both), self.zero)

        rows = [[*(effect(c, o) for o in push), -twice[c]] for c in push]
        for k, top in enumerate(rows):
            for row in rows[k + 1 :]:
                factor = row[k] / top[k]
                row[k + 1 :] = [x - factor * y for x, y in zip(row[k + 1 :], top[k + 1 :], strict=True)]
        s, new = {}, {}
        for k, c in reversed(list(enumerate(push))):
            s[c] = sum((-(rows[k][m] * s[push[m]]) for m in range(k + 1, len(push))), rows[k][-1]) / rows[k][k]
        for c in push:
            for i, (x, y, w) in arms[c].items():
                vx, vy = new.get(i, fly(i)[2:4])
                new[i] = vx + w * s[c] * x, vy + w * s[c] * y
        return s, {c: sum((effect(c, o) * s[o] for o in push), twice[c]) for c in others}, new
