"""The laws in any kind of number, and what proves a number zero: the past computed again, an isometry, the way back."""

try:
    from .arithmetic import ONE, ZERO, Exact, Undecided, number
except ImportError:  # run as a program
    from arithmetic import ONE, ZERO, Exact, Undecided, number


class Refuted(Exception):
    """The certificate states something false."""


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
        """What two see of each other at the start of the younger flight: time, d, v, R; of a wall its normal n, n, |n|."""
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


def place(flight, t):
    x, y, vx, vy, since, _ = flight
    return (x, y) if t is since else (x + vx * (t - since), y + vy * (t - since))


class Block:
    """One round of impulses among contacts that hang together through movable circles, or one circle's turn or capture.
    `places` gives the place of each of its circles in its row of blocks; `source` is what its time comes of."""

    def __init__(self, kind, among, push, places, source, age):
        self.kind, self.among, self.push, self.places = kind, frozenset(among), tuple(push), places
        self.source, self.age = source, age


class Witnesses:
    """Proves numbers of a run zero. `Checker` keeps what it reads: `rows`, the blocks of each circle; `coming`, the kind
    of the next meeting of two; `source`, what the instant's time comes of; `standing`, the contacts at gap zero by age."""

    # -- exact numbers

    def after(self, i, p):
        """The flight of circle i after the first p blocks of its row, in exact numbers."""
        todo = [(i, p)]
        while todo:
            i, p = todo[-1]
            if (i, p) in self.known:
                todo.pop()
            elif p == 0:
                self.known[i, 0] = (*self.exact.circles[i][:4], ZERO, 0)
            else:
                block = self.rows[i][p - 1]
                needed = [k for k in (*block.places.items(), *block.source[1].items()) if k not in self.known]
                todo += needed
                if not needed:
                    self.known.update(self.carried_out(block))
        return self.known[i, p]

    def carried_out(self, block):
        """The flights that leave a block, in exact numbers."""
        t, new = self.moment(block.source), {}
        at = {}
        for i in {i for c in block.among for i in c if 0 <= i < self.n} | set(block.places):
            old = self.after(i, block.places.get(i, 0))
            at[i] = (*place(old, t), *old[2:4], t, block.age)
        if block.kind == "kick":
            new = self.exact.blow(at.get, block.push)[2]
        for i in block.places:
            vx, vy = at[i][2:4]
            vx, vy = (
                (-vx, -vy) if block.kind == "turn" else (ZERO, ZERO) if block.kind == "take" else new.get(i, (vx, vy))
            )
            yield (i, block.places[i] + 1), (*at[i][:2], vx, vy, t, block.age)

    def moment(self, source):
        """An instant's time in exact numbers: a set one, or that of a contact on flights of then."""
        time, places = source
        return time if isinstance(time, Exact) else self.exact.time(lambda i: self.after(i, places.get(i, 0)), time)

    # -- witnesses

    def zero(self, question, c, must=True):
        """Whether a witness proves the number asked about zero; one that fails refutes the certificate."""
        witnesses = self.witnesses.get((question, c), ())
        if any(self.proves(question, c, *w) for w in witnesses):
            return True
        if witnesses:
            raise Refuted(f"the witness of the zero {question!r} of {c} proves nothing")
        if must:
            raise Undecided(f"{question!r} of {c} may be zero, and there is no witness")
        return False

    def proves(self, question, c, witness, other=None):
        if witness == "exact":
            return self.exactly(question, c, other)
        if witness == "back":
            other = other or self.source[0]
            return bool(self.levels) and (question != "tie" or other in self.tied) and self.retraced(question, c, other)
        (matrix, images, _), (i, j) = g, _ = self.isometry(witness), c
        if question == "tie":
            other = other or self.source[0]
            if other not in self.tied:
                return False
            alike = self.coming[c][0] == self.coming[other][0] and self.image(images, c) == other
            return alike and all(self.maps(g, k) for k in c if 0 <= k < self.n)
        if question not in ("still", "together") or j < 0:
            return False
        (a, b), (d, e) = matrix
        if j >= self.n:
            _, _, nx, ny = self.exact.walls[j - self.n]
            return (
                (a * nx + b * ny + nx).zero()
                and (d * nx + e * ny + ny).zero()
                and images.get(i) == i
                and self.maps(g, i)
            )
        unturned = all(x.zero() for x in (a - ONE, b, d, e - ONE))
        return unturned and ((images.get(i) == j and self.maps(g, i)) or (images.get(j) == i and self.maps(g, j)))

    def exactly(self, question, c, other):
        """Whether the number is zero in exact numbers."""
        world, roots = self.exact, len(Exact.roots)
        try:
            _, gap, closing, disc, _ = world.meeting(self.now, c)
            if question == "tie":
                if other and other not in self.tied:
                    return False
                ours = world.time(self.now, c, self.coming[c][0] == "graze")
                return (ours - (world.time(self.now, other, self.coming[other][0] == "graze") if other else self.moment(self.source))).zero()
            if question in ("until", "reverse"):
                turn = question == "until" and "until" not in self.limits
                limit = (
                    self.moment(self.turned) if turn else self.limits["until" if question == "until" else "reverse_at"]
                )
                return (self.moment(self.source) - (limit + limit if turn else limit)).zero()
            if question == "slack":
                return world.blow(self.now, self.push, [c])[1][c].zero()
            if question == "together":
                return all(x.zero() for x in world.view(self.now, c)[3:5])
            return {"graze": disc, "still": closing, "rim": gap}[question].zero()
        finally:
            if len(Exact.roots) > roots:
                del Exact.roots[roots:]
                self.known = {k: f for k, f in self.known.items() if max(x.k for x in f[:5]) <= roots}
                world.lengths.clear()

    def now(self, i):
        return self.after(i, len(self.rows[i]))

    def isometry(self, k):
        """The linear part, what the certificate says is mapped to what, checked on the data, and an empty memory."""
        if k not in self.isometries:
            told = self.told["isometries"][k]
            (a, b, d, e), (p, q) = (list(map(number, told[key])) for key in ("matrix", "shift"))
            zeros = [a * a + d * d - ONE, b * b + e * e - ONE, a * b + d * e]
            for i, j in told["map"]:
                if i < 0:
                    (x, y, r), (u, v, s) = self.data["pockets"][-1 - i], self.data["pockets"][-1 - j]
                    zeros += [a * x + b * y + p - u, d * x + e * y + q - v, r - s]
                elif i < self.n:
                    (x, y, vx, vy, *kind), (u, v, wx, wy, *like) = self.data["circles"][i], self.data["circles"][j]
                    zeros += [a * x + b * y + p - u, d * x + e * y + q - v, a * vx + b * vy - wx, d * vx + e * vy - wy]
                    zeros += [kind[0] - like[0], kind[1] - like[1]]
                else:
                    (x, y, mx, my), (u, v, nx, ny) = self.data["walls"][i - self.n], self.data["walls"][j - self.n]
                    for s, t in ((x, y), (x + my, y - mx)):
                        zeros.append(nx * (a * s + b * t + p - u) + ny * (d * s + e * t + q - v))
            if not all(x.zero() for x in zeros) or any(
                (i < 0, i < self.n) != (j < 0, j < self.n) for i, j in told["map"]
            ):
                raise Refuted(f"isometry {k} does not map what it says")
            self.isometries[k] = ((a, b), (d, e)), {i: j for i, j in told["map"]}, set()
        return self.isometries[k]

    def image(self, images, c):
        i, j = images.get(c[0]), images.get(c[1])
        return None if i is None or j is None else (min(i, j), max(i, j)) if 0 <= j < self.n else (i, j)

    def maps(self, g, i):
        """Whether an isometry maps the past of circle i to that of its image, block by block."""
        _, images, proved = g
        if i not in self.movable or images.get(i) is None:
            return i in images
        mine, theirs = self.rows[i], self.rows[images[i]]
        todo, seen = [(mine[-1], theirs[-1])] if mine and theirs else [], set()
        if len(mine) != len(theirs):
            return False
        while todo:
            if (pair := todo.pop()) in seen or pair in proved:
                continue
            seen.add(pair)
            a, b = pair
            among = {self.image(images, c) for c in a.among}
            if a.kind != b.kind or a.kind == "take" or among != b.among or len(a.among) != len(b.among):
                return False
            for k, p in a.places.items():
                if b.places.get(images.get(k)) != p or len(a.places) != len(b.places):
                    return False
                if p:
                    todo.append((self.rows[k][p - 1], self.rows[images[k]][p - 1]))
        proved |= seen
        return True

    # -- the way back

    def undo(self, block):
        """Each circle's level: how many blocks of its way out are not undone; None once it has left the way."""
        last = {self.rows[i][self.levels[i] - 1] if self.levels[i] else None for i in block.places}
        whole = last.pop()
        same = not last and whole and whole.kind == block.kind == "kick" and set(whole.push) == set(block.push)
        for i in block.places:
            self.levels[i] = whole.places[i] if same and whole.places.keys() == block.places.keys() else None

    def heights(self, c):
        return c, *((self.levels[i] if self.levels else len(self.rows[i])) for i in c if 0 <= i < self.n)

    def parted(self, c):
        """The age of the instant of the way out at which two, on their flights of now, stood at gap zero; or None."""
        latest, met = 0, self.standing[0]
        for i in self.movable.intersection(c):
            if self.levels[i] is None:
                return None
            if self.levels[i]:
                block = self.rows[i][self.levels[i] - 1]
                if block.age > latest:
                    latest, met = block.age, self.standing[block.age]
                met = met | block.among if block.age == latest else met
        return latest if c in met else None

    def retraced(self, question, c, other):
        if question == "graze":
            return None not in self.heights(c) and self.heights(c) in self.grazed
        when = self.parted(c)
        if question == "until":
            return when == 0 and "until" not in self.limits
        return question == "tie" and when is not None and when == self.parted(other)
