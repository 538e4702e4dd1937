"""What proves a number zero: the past computed again in exact numbers, an isometry, the way back."""

from .arithmetic import ONE, ZERO, Exact, Refuted, Undecided, number
from .laws import place


class Block:
    """One round of impulses among contacts that hang together through movable circles, or one circle's turn or capture.
    `places` gives the place of each of its circles in its row of blocks; `source` is what its time comes of."""

    def __init__(self, kind, among, push, places, source, age):
        self.kind, self.among, self.push, self.places = kind, frozenset(among), tuple(push), places
        self.source, self.age = source, age


class Witnesses:
    """Proves numbers of a run zero. It reads `rows`, the blocks of each circle; `coming`, the kind of the next meeting
    of two; `source`, what the instant's time comes of; `tied`, what is shown to meet at it; `standing`, the contacts at
    gap zero at each instant, by its age."""

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
            at[i] = self.put(self.after(i, block.places.get(i, 0)), t, block.age)
        if block.kind == "kick":
            new = self.exact.blow(at.get, block.push)[2]
        for i in block.places:
            vx, vy = at[i][2:4]
            vx, vy = (
                (-vx, -vy) if block.kind == "turn" else (ZERO, ZERO) if block.kind == "take" else new.get(i, (vx, vy))
            )
            yield (i, block.places[i] + 1), (*at[i][:2], vx, vy, t, block.age)

    @staticmethod
    def put(flight, t, age):
        """A flight told from another of its places."""
        return (*place(flight, t), *flight[2:4], t, age)

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
                return (
                    ours
                    - (
                        world.time(self.now, other, self.coming[other][0] == "graze")
                        if other
                        else self.moment(self.source)
                    )
                ).zero()
            if question in ("until", "reverse"):
                turn = question == "until" and "until" not in self.limits
                limit = (
                    self.moment(self.turned) if turn else self.limits["until" if question == "until" else "reverse_at"]
                )
                return (self.moment(self.source) - (limit + limit if turn else limit)).zero()
            if question == "slack":
                t = self.moment(self.source)
                there = {i: self.put(self.now(i), t, self.age) for o in (*self.push, c) for i in o if i < self.n}
                return world.blow(there.get, self.push, [c])[1][c].zero()
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
            self.isometries[k] = ((a, b), (d, e)), dict(told["map"]), set()
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
