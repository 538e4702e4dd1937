"""Checks a certificate of a run of hard circles, walls and pockets with the standard library alone: verify.py FILE.

docs/certificates.md defines the format. There is no search and no queue: what is stated is proved again, or refused.

*Numbers.* A `Ball` is an interval: what it says of a sign is true, or it says nothing. It remembers how its number came
about, and so the number can be computed again as an `Exact` one, a + b*sqrt(d), where a, b, d are alike with earlier
roots: what is zero term by term is zero, whatever the roots are.

*Flights.* Between instants circles fly straight. A gap, |d|^2 - R^2 of two circles or the distance from a wall, is
convex in time, so it falls through zero once at most: `next` encloses that time, or proves that there is none.

*Instants.* By induction, let all flights be enclosed. The next instant is when the contact named first meets. `later`
proves of every other pair, wall and pocket that it meets later; or it is listed, and then a witness proves it
simultaneous. So nothing is missed and nothing invented.

*Impulses.* All that stands at gap zero and hangs together is signed, round by round, until nothing approaches.
`simultaneous`: the impulses s of those said to push solve G s = -2u, are positive, and leave each other contact that
approaches with 2u + G s >= 0; the velocities that follow are unique (Cottle, Pang, Stone, The Linear Complementarity
Problem, 3.1). `sequential`: one contact at a time, in the order that the scene or its seed says.

*Zeros.* That a number is zero takes a witness. "exact": it is computed again from the scene in `Exact` numbers. An
isometry maps the causal past of one number to that of another, or of its negative: data are compared exactly, blocks of
impulses by the blocks before them, and by induction flights are mapped to flights. "back": the way back of a reversed
run undoes the way out, block by block. docs/symmetry-and-ties.md proves both theorems.
"""

# fmt: off
import json
import random
import re
import sys
from collections import defaultdict, namedtuple
from fractions import Fraction
from functools import reduce
from itertools import chain
from math import isqrt
from operator import add, mul, neg, sub, truediv
from pathlib import Path

FORMAT, BYTES, CIRCLES, BITS, PAIRS, SIZE = "truebreak/certificate-1", 1 << 24, 1000, 1 << 20, 1 << 22, 1 << 30
TEXT, ROOTS, SCENE_ROOTS, WORK, NEVER, DOUBT = 20_000, 16, 12, 1 << 37, ("never", None), ("doubt", None)
TERM, DECIMAL = r"\d+(?:/0*[1-9]\d*)?(?:\*r[1-9]\d?)*", r"-?\d{1,400}(?:\.(\d{1,400}))?"
POLICY = r"simultaneous|sequential(:order=scene|:seed=\d{1,18})?"
THINGS = {"circles": "x y vx vy r", "walls": "x0 y0 x1 y1", "pockets": "x y r"}
CONTACT, QUESTION = r"\[\d{1,15},-?\d{1,15}\]", '"(tie|graze|still|together|slack|rim|until|reverse)"'
WITNESS = rf'\[{QUESTION},{CONTACT},("exact"|"back"|\d{{1,15}})(,{CONTACT})?\]'
PART, SETTINGS, COUNT = "rounds entries zeros", "name digest capture reverse_after tie_policy", r"[1-9]\d*"
def each(item, times="*"): return rf"\[({item},?){times}\]"
SHAPES = {"arrive": each(CONTACT, "+"), "rounds": each(each(CONTACT, "+")), "zeros": each(WITNESS),
          "time": f'"{DECIMAL}"', "circles": each(each(f'"{DECIMAL}"', "{4}")), "map": each(each(r"-?\d{1,15}", "{2}")),
          "tie_policy": f'"({POLICY})"', "reason": '"(events|stopped|horizon|return|quiet)"', "capture": "true|false"}
SHAPES |= {"entries": each(CONTACT), "grazes": each(CONTACT.replace("-?", "")), "bits": each(CONTACT.replace("-?", ""))}
SHAPES |= dict.fromkeys(("limit", "reverse_after"), COUNT) | dict.fromkeys(("id", "name", "digest", "writer"), '".*"')
Flight = namedtuple("Flight", "x y vx vy t age")  # at (x, y) at time t, which is that of the instant `age`
Meeting = namedtuple("Meeting", "t gap closing d v square arms")
Block = namedtuple("Block", "kind among push before age")  # before: of each circle, the number of the block before

class Malformed(Exception): """This is no certificate."""
class Refuted(Exception): code, word = 1, "refuted"
class Undecided(Exception): code, word = 4, "not decided"  # the intervals are too wide, or a witness is missing
BROKEN = Malformed, LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError

class Exact:
    """a + b*sqrt(d): d is the k-th of `roots`, a and b use those before it; for k = 0 the fraction a."""
    roots, named, most, work, budget = [], [], ROOTS, 0, WORK
    def __init__(self, a, b=None, k=0): self.a, self.b, self.k = a, b, k
    def __bool__(self) -> bool: return self.k > 0 or self.a != 0
    def parts(self, k): return (self.a, self.b) if self.k == k else (self, ZERO)
    def __neg__(self): return Exact(-self.a, self.b and -self.b, self.k)
    def __sub__(self, o): return self + -o
    def __add__(self, o):
        if not (k := max(self.k, o.k)): return Exact(self.a + o.a)
        (a, b), (c, d) = self.parts(k), o.parts(k)
        return Exact(a + c, high, k) if (high := b + d) else a + c
    def __mul__(self, o):
        if not (self and o): return ZERO
        if not (k := max(self.k, o.k)):
            Exact.work += 10_000 + (size(self.a) * size(o.a) >> 8)  # about a nanosecond a unit
            if Exact.work > Exact.budget: raise Undecided("an exact witness takes too much work")
            return Exact(self.a * o.a)
        (a, b), (c, d) = self.parts(k), o.parts(k)
        low, high = a * c + b * d * Exact.roots[k - 1], a * d + b * c
        return Exact(low, high, k) if high else low
    def __truediv__(self, o):
        if o.k == 0: return self * Exact(1 / o.a)
        return self * Exact(o.a, -o.b, o.k) / (o.a * o.a - o.b * o.b * Exact.roots[o.k - 1])
    def sign(self):  # that of a and b; where they differ, a*a - b*b*d tells which is the greater
        if self.k == 0: return (self.a > 0) - (self.a < 0)
        a, b = self.a.sign(), self.b.sign()
        return b if a in (0, b) else a * (self.a * self.a - self.b * self.b * Exact.roots[self.k - 1]).sign()
    def sqrt(self):  # the positive root: made of the roots at hand if it can be, else a new one
        if self.sign() < 1: raise Malformed("a number that is not positive has a root")
        if root := self.within(len(Exact.roots)): return root if root.sign() > 0 else -root
        if len(Exact.roots) >= Exact.most: raise Undecided("an exact witness takes too many roots")
        Exact.roots.append(self)
        return Exact(ZERO, ONE, len(Exact.roots))
    def within(self, k):  # a square root made of the first k roots, or None: from (c + e*sqrt(d))^2 = a + b*sqrt(d)
        if k == 0:
            root = Fraction(isqrt(abs(self.a.numerator)), isqrt(self.a.denominator))
            return Exact(root) if root * root == self.a else None
        (a, b), d = self.parts(k), Exact.roots[k - 1]
        if not b: return a.within(k - 1) or ((e := (a / d).within(k - 1)) and Exact(ZERO, e, k))
        norm = (a * a - b * b * d).within(k - 1)
        for n in (norm, -norm) if norm else ():
            if c := ((a + n) / (ONE + ONE)).within(k - 1): return Exact(c, b / (c + c), k)
        return None

class Ball:
    """The reals within r of m, in units of 2**-bits; what is exact at these bits stays so. `how` the number comes
    about: its exact value, if that is known, and what it is computed by, from what."""
    bits = 0
    def __init__(self, m, r, *how): self.m, self.r, self.how = m, r, [None, *how]
    def __neg__(self): return Ball(-self.m, self.r, neg, self.how)
    def __add__(self, o): return Ball(self.m + o.m, self.r + o.r, add, self.how, o.how)
    def __sub__(self, o): return Ball(self.m - o.m, self.r + o.r, sub, self.how, o.how)
    def __mul__(self, o):
        wide = abs(self.m) * o.r + abs(o.m) * self.r + self.r * o.r
        return Ball(self.m * o.m, wide, mul, self.how, o.how).cut(Ball.bits)
    def __truediv__(self, o):
        if (least := abs(o.m) - o.r) <= 0: raise Undecided("a number that may be zero divides")
        m, rest = divmod(self.m << Ball.bits, o.m)
        wide = ((abs(self.m) * o.r // abs(o.m) + 1 + self.r) << Ball.bits) // least + 2
        return Ball(m, wide if rest or self.r or o.r else 0, truediv, self.how, o.how)
    def sqrt(self):
        if (low := (self.m - self.r) << Ball.bits) <= 0: raise Undecided("a number that may not be positive has a root")
        root = isqrt(low)
        half = 0 if self.r == 0 and root * root == low else (self.r << Ball.bits) // root // 2 + 2
        return Ball(root + half, half, Exact.sqrt, self.how)
    def cut(self, drop):  # the same in units of so many bits less
        exact = self.r == 0 and self.m >> drop << drop == self.m
        self.m, self.r = self.m >> drop, 0 if exact else (self.r >> drop) + 2
        return self
    def sign(self): return 1 if self.m > self.r else -1 if self.m < -self.r else None if self.r else 0
    @staticmethod
    def of(x):  # the interval of an exact number
        m, rest = (0, 0) if x.k else divmod(x.a.numerator << Ball.bits, x.a.denominator)
        ball = Ball.of(x.a) + Ball.of(x.b) * Ball.of(Exact.roots[x.k - 1]).sqrt() if x.k else Ball(m, int(rest > 0))
        ball.how = [x]
        return ball
    def zero(self):  # whether the number is zero, as it is computed again from the scene in exact numbers
        roots, todo, done = len(Exact.roots), [self.how], []
        try:
            while todo:
                value, *by = how = todo[-1]
                if missing := [part for part in by[1:] if value is None and part[0] is None]: todo += missing
                else:
                    how[0] = by[0](*(part[0] for part in by[1:])) if value is None else value
                    done.append(todo.pop())
            return not self.how[0]
        finally:
            for how in done: how[0] = how[0] if how[0] is not None and how[0].k <= roots else None
            del Exact.roots[roots:]

ZERO, ONE = Exact(Fraction(0)), Exact(Fraction(1))
def size(x): return x.numerator.bit_length() + x.denominator.bit_length()
def number(text):  # reads a sum of terms such as 3/4*r1*r2
    if len(text) > TEXT or not re.fullmatch(f"[+-]?{TERM}([+-]{TERM})*", text, re.ASCII):
        raise Malformed(f"{text[:40]!r} is no number")
    terms = (found.split("*r") for found in re.findall(f"[+-]?{TERM}", text))
    return sum((reduce(mul, (Exact.named[int(k) - 1] for k in ks), Exact(Fraction(x))) for x, *ks in terms), ZERO)

def put(flight, t, age):  # the same flight, told from where it is at a time t, that of the instant `age`
    x, y, vx, vy, since, then = flight
    return flight if age == then else Flight(x + vx * (t - since), y + vy * (t - since), vx, vy, t, age)

class Laws:
    """The laws of flight, meeting and impulse. Bodies are circles, and then pockets, which rest, counted from behind. A
    contact (i, j) is of two circles if 0 <= j < n, of wall j - n, or of the rim of pocket -1 - j."""
    def meeting(self, flights, c):
        """Two at the start t of the younger flight: gap, closing speed, d, v, R^2 (of a wall, None), and the directions
        in which the circles are pushed."""
        (i, j), a = c, flights[c[0]]
        if j >= self.n:
            x, y, nx, ny, length = self.balls[j]
            nx, ny = (nx, ny) if self.sides[c] > 0 else (-nx, -ny)
            gap = nx * (a.x - x) + ny * (a.y - y) - self.balls[i][4] * length
            return Meeting(a.t, gap, nx * a.vx + ny * a.vy, None, None, None, {i: (nx, ny)})
        t, age = max(a, flights[j], key=lambda flight: flight.age)[4:]
        a, b = put(a, t, age), put(flights[j], t, age)
        dx, dy, vx, vy = b.x - a.x, b.y - a.y, b.vx - a.vx, b.vy - a.vy
        reach = self.balls[j][4] if j < 0 else self.balls[i][4] + self.balls[j][4]
        gap = dx * dx + dy * dy - (square := reach * reach)
        return Meeting(t, gap, dx * vx + dy * vy, (dx, dy), (vx, vy), square, {i: (-dx, -dy), j: (dx, dy)})
    def speed(self, m): return m.v[0] * m.v[0] + m.v[1] * m.v[1]  # |v|^2
    def disc(self, m):  # of two that approach: positive if they hit, zero if they graze, negative if they miss
        cross = m.d[0] * m.v[1] - m.d[1] * m.v[0]
        return self.speed(m) * m.square - cross * cross
    def hit(self, m):  # when the gap falls through zero
        return m.t + m.gap / (self.disc(m).sqrt() - m.closing) if m.v else m.t - m.gap / m.closing
    def solve(self, rows):  # the x with G x = y, by elimination; each row is one of G, and then of y
        if not rows: return []
        (pivot, *top), *rest = rows
        rest = [[x - f * y for f in [row[0] / pivot] for x, y in zip(row[1:], top, strict=True)] for row in rest]
        low = self.solve(rest)
        return [sum((-(g * x) for g, x in zip(top[:-1], low, strict=True)), top[-1]) / pivot, *low]
    def blow(self, flights, push, others):  # s of those that push, by G s = -2u; 2u + G s of others; the new velocities
        met = {c: self.meeting(flights, c) for c in (*push, *others)}
        twice = {c: m.closing + m.closing for c, m in met.items()}
        def effect(c, o):  # an entry of G
            if c == o and c[1] < self.n: return (self.balls[c[0]][5] + self.balls[c[1]][5]) * met[c].square
            both = [(self.balls[i][5], *met[c].arms[i], *met[o].arms[i]) for i in met[c].arms if i in met[o].arms]
            return sum(((x * p + y * q) * w for w, x, y, p, q in both), self.none)
        s, new = self.solve([[*(effect(c, o) for o in push), -twice[c]] for c in push]), {}
        for i, x, y, j in ((i, x, y, j) for c, j in zip(push, s, strict=True) for i, (x, y) in met[c].arms.items()):
            (vx, vy), w = new.get(i, flights[i][2:4]), self.balls[i][5]
            new[i] = vx + w * j * x, vy + w * j * y
        return s, {c: sum((effect(c, o) * j for o, j in zip(push, s, strict=True)), twice[c]) for c in others}, new

class Zeros(Laws):
    """What proves numbers of a run zero. The past of a circle is its last block, and so all before: a round of impulses
    among contacts that hang together through movable circles, or one circle's turn or capture."""
    def take(self, entry, clock):  # takes up the witnesses of an entry, and the contact that tells its time
        self.clock, self.witnesses = clock, defaultdict(list)
        for question, c, *witness in entry.get("zeros", ()): self.witnesses[question, tuple(c)].append(witness)
    def sign(self, question, c, value):  # the sign of a number: its interval's, or zero by a witness
        if (sign := value.sign()) is None and not self.zero(question, c, value):
            raise Undecided(f"{question!r} of {c} may be zero, and there is no witness")
        return sign or 0
    def zero(self, question, c, value, must=True):  # whether a witness proves it; one that must, and does not, refutes
        witnesses = self.witnesses.get((question, c), ())
        proved = any(self.proves(question, c, value, *witness) for witness in witnesses)
        if witnesses and must and not proved: raise Refuted(f"the witness of zero {question!r} of {c} proves nothing")
        return proved
    def proves(self, question, c, value, how, other=None):  # whether a witness proves a number zero
        (i, j), other, tie = c, tuple(other) if other else self.clock, question == "tie"
        if tie and other not in self.tied: return False
        if how == "exact": return (self.nexts[c][1] - self.nexts[other][1] if tie else value).zero()
        if how == "back":
            if question == "graze": return bool(self.way) and self.pasts(c) in self.grazed
            then = self.parted(other) if tie else 0 if question == "until" and "until" not in self.limits else None
            return then is not None and then == self.parted(c)
        if how not in self.isometries: return False
        (a, b, d, e), images, _ = g = self.isometries[how]
        if tie:
            alike = self.nexts[c][0] == self.nexts[other][0] and self.image(images, c) == other
            return alike and all(self.maps(g, k) for k in c if 0 <= k < self.n)
        if question not in ("still", "together") or j < 0: return False
        if j >= self.n:
            _, _, nx, ny, _ = self.things[j]
            return not (a * nx + b * ny + nx or d * nx + e * ny + ny) and images.get(i) == i and self.maps(g, i)
        unturned = not any((a - ONE, b, d, e - ONE))
        return unturned and any(images.get(k) == m and self.maps(g, k) for k, m in ((i, j), (j, i)))
    def isometry(self, told):  # its linear part, what it maps to what, by the data, and the images of the first blocks
        (a, b, d, e), (p, q) = ([number(text) for text in told[key]] for key in ("matrix", "shift"))
        images, zeros = dict(told["map"]), [a * a + d * d - ONE, b * b + e * e - ONE, a * b + d * e]
        for i, j in images.items():
            (x, y, vx, vy, *kind), (u, v, wx, wy, *like) = self.things[i], self.things[j]
            x, y, vx, vy = a * x + b * y + p - u, d * x + e * y + q - v, a * vx + b * vy, d * vx + e * vy
            wall = [vx * wy - vy * wx, x * wx + y * wy]
            zeros += wall if i >= self.n else [x, y, vx - wx, vy - wy, *map(sub, kind, like)]
        alike = all((i < 0, i < self.n) == (j < 0, j < self.n) for i, j in images.items())
        if not alike or len(set(images.values())) < len(told["map"]) or any(zeros):
            raise Refuted("an isometry does not map what it says")
        return (a, b, d, e), images, [0]
    def image(self, images, c):  # the image of a contact
        i, j = images.get(c[0]), images.get(c[1])
        return None if i is None or j is None else (min(i, j), max(i, j)) if 0 <= j < self.n else (i, j)
    def maps(self, g, i):
        """Whether an isometry maps circle i with its past to its image: the image of a block is that of its kind with
        the images of its contacts, and of the blocks before it."""
        _, images, seen = g
        for kind, among, _, before, _ in self.blocks[len(seen) : self.last[i] + 1]:
            past = frozenset((images.get(k), seen[number]) for k, number in before.items())
            seen.append(self.numbers.get((kind, frozenset(self.image(images, c) for c in among), past)))
        return i in images and seen[self.last[i]] == self.last[images[i]]
    def note(self, kind, among, push, circles):
        """Logs a block, and gives its circles; on the way back it undoes one of the way out, or they leave that way."""
        before = {i: self.last[i] for i in circles & self.movable}
        block = Block(kind, frozenset(among), frozenset(push), before, self.age)
        if kind != "take": self.numbers[kind, block.among, frozenset(before.items())] = len(self.blocks)
        self.last |= dict.fromkeys(before, len(self.blocks))
        self.blocks.append(block)
        if self.way and kind == "kick":
            one, *more = {self.way[i] for i in before}
            old = self.blocks[0 if more or one is None else one]
            undone = old.push == block.push and old.before.keys() == before.keys()
            self.way |= {i: old.before[i] if undone else None for i in before}
        return before
    def pasts(self, c):  # with the last blocks of its circles, on the way out, that are done or not undone (None: left)
        return c, *((self.way or self.last)[i] for i in c if 0 <= i < self.n)
    def parted(self, c):  # the age of the instant of the way out at which two, on the flights of now, were at gap zero
        if not self.way or None in (pasts := self.pasts(c)): return None
        latest = max(self.blocks[k].age for k in pasts[1:])
        return latest if c in self.standing[latest] else None

class Checker(Zeros):
    """Follows the log of a certificate. Between instants it keeps `flights`, all enclosed; `nexts`, what is known of
    the next meeting of two: never, a hit or a graze, and when, or a doubt; `lasting`, the contacts that stay at gap
    zero; the `last` block of each circle; `way`, after the reversal, the last one of the way out that is not undone."""
    def __init__(self, told):  # takes up a certificate and its scene, in exact numbers
        if not isinstance(told, dict) or told.get("format") != FORMAT: raise Malformed(f"the format is not {FORMAT}")
        self.told, self.scene, self.end = told, (scene := told["scene"]), told["end"]
        lists = told["roots"], told["isometries"], told["instants"], *(scene.get(kind, []) for kind in THINGS)
        things, entries = [*chain(*lists[3:])], [told["start"], *told["instants"]]
        turned, limit = [part["reversal"] for part in entries if "reversal" in part], self.end["reason"] == "events"
        for keys, *parts in (("writer bits", told), (SETTINGS, scene), ("id", *things), ("map", *told["isometries"]),
                             (PART, *entries, *turned), ("arrive grazes time", *entries[1:]),
                             ("reason zeros" + " limit" * limit, self.end), ("time circles", told["final"])):
            for part, key in ((part, key) for part in parts for key in keys.split() if key in part):
                if not re.fullmatch(SHAPES[key], json.dumps(part[key], separators=(",", ":")), re.ASCII):
                    raise Malformed(f"its {key} are not of their shape")
        if {*map(type, lists)} != {list} or not {*map(type, turned)} <= {dict}: raise Malformed("a list is no list")
        n, (places, bits) = len(scene["circles"]), zip(*told["bits"], strict=True)
        area, roots = n * len(things), len(told["roots"])
        if not 0 < n <= CIRCLES or area > PAIRS or roots > SCENE_ROOTS or area * bits[0] > SIZE:
            raise Malformed("it has no circle, or too many circles, walls, pockets, roots or bits")
        if len({thing["id"] for thing in things}) < len(things) or len(told["final"]["circles"]) != n:
            raise Malformed("an id comes twice, or there is no final state of each circle")
        if [*places] != sorted({0, *places}) or not BITS >= bits[0] >= bits[-1] > 0 or [*bits] != sorted(bits)[::-1]:
            raise Malformed("bits out of range")
        Exact.roots, Exact.named, Exact.most, Exact.budget = [], [], ROOTS, WORK
        for text in told["roots"]: Exact.named.append(number(text).sqrt())
        circles, walls, pockets = ([[number(thing[key]) for key in keys.split()] for thing in scene.get(kind, ())]
                                   for kind, keys in THINGS.items())
        for row, thing in zip(circles, scene["circles"], strict=True):
            row.append(ZERO if thing["m"] == "oo" else ONE / number(thing["m"]))
        lines = [[x, y, p := y - v, q := u - x, p * p + q * q] for x, y, u, v in walls]
        rims = [[x, y, ZERO, ZERO, r, ZERO] for x, y, r in reversed(pockets)]
        self.n, self.things = n, dict(enumerate(circles + lines)) | dict(enumerate(rims, -len(rims)))
        self.movable = {i for i, row in enumerate(circles) if row[5]}
        pairs = [(i, j) for i in range(n) for j in range(i + 1, n) if circles[i][4] or circles[j][4]]
        others = [(i, j) for i in sorted(self.movable) for j in self.things if not 0 <= j < n]
        self.meets = dict.fromkeys([c for c in pairs if not self.movable.isdisjoint(c)] + others)
        self.sides = {(i, k): (p * (circles[i][0] - x) + q * (circles[i][1] - y)).sign()
                      for i in self.movable for k, (x, y, p, q, _) in enumerate(lines, n)}
        self.last_event = self.end["limit"] if limit else None
        self.limits = {"reverse": number(scene["reverse_at"])} if "reverse_at" in scene else {}
        if self.end["reason"] == "horizon": self.limits["until"] = number(self.end["until"])
        sizes = [x for row in circles for x in row[4:] if x] + [row[4] for row in lines + rims]
        moves = [x for row in circles if not row[5] for x in row[2:4] if x]
        if moves or any(x.sign() < 1 for x in (*sizes, *self.limits.values())):
            raise Malformed("a size, mass or time is not positive, or a fixed circle moves")
        if {"reverse_at", "reverse_after"} <= scene.keys(): raise Malformed("there are two reversals")
        self.policy, _, seed = scene["tie_policy"].partition(":seed=")
        self.draw = random.Random(int(seed)) if seed else None
    def check(self, factor=1):  # checks all of it, with so many times the bits
        self.where, bits = "in the scene", dict(self.told["bits"])
        Ball.bits = bits[0] * factor
        self.isometries = dict(enumerate(map(self.isometry, self.told["isometries"])))
        self.none, self.due = Ball.of(ZERO), {question: Ball.of(x) for question, x in self.limits.items()}
        self.balls = {k: [*map(Ball.of, row)] for k, row in self.things.items()}
        for k, row in self.balls.items(): row[4] = row[4].sqrt() if k >= self.n else row[4]
        self.flights = {k: Flight(*row[:4], self.none, 0) for k, row in self.balls.items() if k < self.n}
        self.time, self.age, self.count, self.way, self.last = self.none, 0, 0, {}, dict.fromkeys(range(self.n), 0)
        self.nexts, self.lasting, self.gone, self.grazed, self.standing = {}, set(), set(), set(), {}
        self.blocks, self.numbers = [Block("data", frozenset(), frozenset(), {}, 0)], {}
        instants = [(f"instant {k}", self.instant, entry) for k, entry in enumerate(self.told["instants"])]
        steps = [("at the start", self.open, self.told["start"]), *instants, ("at the end", self.close, self.end)]
        for k, (self.where, step, entry) in enumerate(steps):
            if k <= len(instants): self.fall(bits.get(k, 0) * factor or Ball.bits)
            step(entry)
    def fall(self, bits):  # goes on with so many bits, which may be fewer: what is known gets less sharp on the way
        drop, Ball.bits = Ball.bits - bits, bits
        rows = *(flight[:5] for flight in self.flights.values()), *self.balls.values(), self.due.values()
        numbers = *(x for row in rows for x in row), *(when for _, when in self.nexts.values() if when)
        for x in {id(x): x for x in numbers}.values() if drop else (): x.cut(drop)
    def open(self, entry):  # time 0: nothing overlaps; what touches is known exactly
        known = {}
        self.take(entry, None)
        if 0 in self.sides.values(): raise Refuted("a centre is on a wall")
        for c in self.meets:
            m = self.meeting(self.flights, c)
            if (gap := m.gap.sign()) == 0 or (gap is None and m.gap.zero()): known[c] = self.sign("still", c, m.closing)
            elif gap is None or gap < 0 <= c[1]: raise (Refuted if gap else Undecided)(f"{c} overlap, or may")
        self.resolve(known, entry)
        self.turn(entry, False)
    def instant(self, entry):  # its time, nothing before it, all that falls on it, and what that does
        arrive, grazes = ([tuple(c) for c in entry.get(key, ())] for key in ("arrive", "grazes"))
        self.take(entry, arrive[0] if arrive else None)
        self.age, self.tied, self.time, due = self.age + 2, set(), self.due.get("reverse"), False
        if self.count == self.last_event: raise Refuted("it comes after the last event")
        for k, c in enumerate((*arrive, *grazes)):
            kind, when = self.next(c)
            if kind == "doubt": raise Undecided(f"whether {c} meet, graze or miss")
            if k == 0: self.time = when
            elif c in self.tied or not when or self.sign("tie", c, when - self.time): kind = "at another time"
            if kind != ("hit" if c in arrive else "graze"): raise Refuted(f"{c} do not meet at this instant")
            self.tied.add(c)
        if not arrive and (grazes or "reversal" not in entry or not self.time): raise Refuted("nothing falls on it")
        self.said(self.time, entry["time"])
        near = [c for c in self.meets if c not in self.tied and self.later(c, self.time)]
        for question, limit in self.due.items():
            wait = limit - self.time
            sign = 0 if not arrive and wait.zero() else self.sign(question, self.clock, wait)
            if sign < 0: raise Refuted("the end, or the reversal, comes before it")
            due |= question == "reverse" and sign == 0
        alone = {"rounds": [arrive]} if len(arrive) == 1 and arrive[0][1] >= 0 else {}
        known = dict.fromkeys(self.lasting | {*grazes}, 0) | dict.fromkeys(arrive, -1)
        self.resolve(known, alone | entry, near)
        self.turn(entry, due)
    def next(self, c):  # of the next meeting of two: never; a hit or a graze, and when; a doubt, but for witnesses
        if self.nexts.get(c, DOUBT) == DOUBT:
            m = self.meeting(self.flights, c) if c in self.meets and self.gone.isdisjoint(c) else None
            closing, gap = (m.closing.sign(), m.gap.sign()) if m else (1, 1)
            if gap == -1 and c[1] >= 0: raise Refuted(f"{c} overlap")
            known = DOUBT
            if closing in (0, 1) or gap == -1 or (disc := self.disc(m).sign() if m.v else 1) == -1: known = NEVER
            elif closing is None: known = NEVER if self.zero("still", c, m.closing, must=False) else DOUBT
            elif disc == 1: known = "hit", self.hit(m)
            elif disc == 0 or self.zero("graze", c, self.disc(m)):
                known = "graze", m.t - m.closing / self.speed(m)  # when two are nearest
                self.grazed |= set() if self.way else {self.pasts(c)}
            self.nexts[c] = known
        return self.nexts[c]
    def apart(self, m, time):
        """Whether two have surely not met until a time. Their gap is at least gap + 2 closing * s at s after the start,
        as it is convex; and if it still falls then, it has not been smaller."""
        s, most = time - m.t, Ball(2 * (abs(m.closing.m) + m.closing.r), 0)
        then = m.closing + self.speed(m) * s if m.v else self.none
        return (m.gap - most * s).sign() == 1 or (then.sign() == -1 and (m.gap + (m.closing + then) * s).sign() == 1)
    def later(self, c, time):  # proves that two meet after a time (None: never); whether they may graze at it
        kind, when = self.next(c)
        order = (when - time).sign() if when and time else None
        if kind == "hit" and (order == -1 or not time): raise Refuted(f"{c} meet before it")
        if kind in ("hit", "doubt") and order != 1 and not (time and self.apart(self.meeting(self.flights, c), time)):
            raise Undecided(f"whether {c} meet before it")
        return kind == "graze" and order in (0, None)
    def resolve(self, known, entry, near=(), moved=()):
        """What an instant does with all that stands at gap zero, `known` with the signs of its closing speeds: rounds
        of impulses among all that hangs together with what approaches; then entries; then what lasts."""
        solid, moved, self.stood = [c for c in known if c[1] >= 0], {*moved}, known
        rounds = [[tuple(c) for c in push] for push in entry.get("rounds", ())]
        self.count += bool(rounds)
        while approaching := sorted(c for c in solid if known[c] < 0):  # the next group
            group = self.linked(approaching[0], solid, range(self.n))
            time = self.nexts[approaching[0]][1] if self.age and self.age % 2 == 0 else self.time
            here = {i: put(self.flights[i], time, self.age) for c in group for i in c if i < self.n}
            if any(c[1] >= 0 and not here.keys().isdisjoint(c) for c in near):
                raise Undecided(f"a graze may take part in the impulses of {approaching[0]}")
            while coming := sorted(c for c in group if known[c] < 0):
                push = rounds.pop(0) if rounds else []
                if self.policy != "simultaneous":
                    coming = [coming[self.draw.randrange(len(coming)) if self.draw and len(coming) > 1 else 0]]
                if not push or len(set(push)) < len(push) or not set(push) <= set(coming):
                    raise Refuted(f"{push} push, but {coming} may")
                s, slacks, new = self.blow(here, push, [c for c in coming if c not in push])
                for c, impulse in zip(push, s, strict=True):
                    if (sign := impulse.sign()) != 1: raise (Refuted if sign else Undecided)(f"{c} do not push")
                for c, slack in slacks.items():
                    if self.sign("slack", c, slack) < 0: raise Refuted(f"{c} push too")
                while coming:
                    part = self.linked(coming[0], coming, self.movable)
                    coming = [c for c in coming if c not in part]
                    for i in self.note("kick", part, part & set(push), {i for c in part for i in c}):
                        here[i] = self.flights[i] = Flight(*here[i][:2], *new.get(i, here[i][2:4]), *here[i][4:])
                moved |= (hit := {i for c in push for i in c} & self.movable)
                for c in group:
                    if not hit.isdisjoint(c): known[c] = self.sign("still", c, self.meeting(self.flights, c).closing)
        if rounds: raise Refuted("it has rounds of impulses where nothing approaches")
        self.standing[self.age] = {*solid}
        self.enter(known, moved, entry)
        for c in solid:
            if c not in self.lasting or not moved.isdisjoint(c):
                m = self.meeting(self.flights, c)
                lasts = known.get(c) == 0 and (not m.v or self.sign("together", c, self.speed(m)) == 0)
                (self.lasting.add if lasts else self.lasting.discard)(c)
        self.nexts = {c: x for c, x in self.nexts.items() if moved.isdisjoint(c)} | dict.fromkeys(known, NEVER)
    def linked(self, first, contacts, through):  # the contacts that hang together with one through common circles
        group, circles = set(), {*first} & {*through}
        while more := {c for c in contacts if not circles.isdisjoint(c)} - group:
            group |= more
            circles |= {i for c in more for i in c if i in through}
        return group
    def enter(self, known, moved, entry):  # centres on a rim that move inward, after the impulses; captures
        for c in [c for c in self.meets if c[1] < 0 and c[0] in moved and c[0] not in self.gone]:
            m = self.meeting(self.flights, c)
            if c in known or m.gap.sign() not in (1, -1):
                sign = self.sign("still", c, m.closing)
                known[c] = sign if c in known or sign >= 0 else self.sign("rim", c, m.gap) - 1
        found = sorted(c for c in known if c[1] < 0 and known[c] < 0)
        if found != sorted((i, -1 - k) for i, k in entry.get("entries", ())): raise Refuted(f"{found} enter")
        for i in {i for i, _ in found} if self.scene.get("capture") else ():
            x, y = put(self.flights[i], self.time, self.age)[:2]
            self.flights[i] = Flight(x, y, self.none, self.none, self.time, self.age)
            self.gone.add(i)
            moved |= {*self.note("take", (), (), {i})}
            for c in [c for c in known if i in c]: del known[c]
    def turn(self, entry, due):  # the reversal, if it falls on this instant, and what follows from it
        due = due or (not self.way and 0 < self.count == self.scene.get("reverse_after"))
        due = due and self.count != self.last_event  # else it comes too late to be told
        if due != ("reversal" in entry): raise Refuted(f"the reversal {'falls' if due else 'does not fall'} on it")
        if not due: return
        self.age, self.way = self.age + 1, dict(self.last)
        self.due.pop("reverse", None)
        if self.end["reason"] == "return": self.due["until"] = self.time + self.time
        for i in self.movable:
            x, y, vx, vy, *start = put(self.flights[i], self.time, self.age)
            self.flights[i] = Flight(x, y, -vx, -vy, *start)
            self.note("turn", (), (), {i})
        self.take(entry["reversal"], self.clock)
        self.resolve({c: -sign for c, sign in self.stood.items()}, entry["reversal"], moved=range(self.n))
        self.age += 1
    def said(self, value, text):  # that a number is as the decimal text says, to within one unit of its last digit
        if not (found := re.fullmatch(DECIMAL, text, re.ASCII)): raise Malformed(f"{text[:40]!r} is no decimal")
        one, unit = 1 << Ball.bits, Fraction(1, 10 ** len(found[1] or ""))
        off, wide = abs(Fraction(value.m, one) - Fraction(text)), Fraction(value.r, one)
        if off + wide >= unit: raise (Refuted if off - wide >= unit else Undecided)(f"a number is not {text}")
    def close(self, end):  # what ended the run, and the final state
        self.take(end, self.clock)
        reason, until, turn = end["reason"], self.due.get("until"), self.due.get("reverse")
        if self.last_event not in (None, self.count) or (reason == "return" and not self.way):
            raise Refuted(f"there are {self.count} events, or nothing was reversed")
        if reason not in ("events", "stopped"):
            order = (turn - until).sign() if turn and until else -1 if turn else 1
            if order != 1: raise (Undecided if order is None else Refuted)("the reversal comes first")
            for c in self.meets: self.later(c, until)
            if until: self.time, self.age = until, self.age + 2
        self.said(self.time, self.told["final"]["time"])
        for i, row in zip(range(self.n), self.told["final"]["circles"], strict=True):
            state = put(self.flights[i], self.time, self.age)[:4]
            for value, text in zip(state, row, strict=True): self.said(value, text)

def judged(told, factor):  # the exit code for a certificate with so many times its bits, and a sentence
    checker = None
    try:
        (checker := Checker(told)).check(factor)
        return 0, f"verified: {checker.count} events, to the end: {checker.end['reason']}"
    except (Refuted, Undecided) as fault:
        return fault.code, f"{fault.word}: {checker.where if checker else 'in the scene'}: {fault}"

def whole(text):  # a number of JSON
    if not re.fullmatch(r"-?\d{1,15}", text): raise Malformed(f"{text[:40]} is no whole number, or too long")
    return int(text)
def once(pairs):  # an object of JSON whose keys differ
    if len(found := dict(pairs)) < len(pairs): raise Malformed("a key comes twice")
    return found

def verdict(path):  # the exit code for a file, and a sentence
    sys.set_int_max_str_digits(TEXT)
    try:
        if Path(path).exists() and not Path(path).is_file(): raise Malformed("it is no regular file")
        with Path(path).open("rb") as file: text = file.read(BYTES + 1)
        if len(text) > BYTES: raise Malformed(f"it is longer than {BYTES} bytes")
        read = {"object_pairs_hook": once, "parse_int": whole, "parse_float": whole, "parse_constant": whole}
        Exact.work, told = 0, json.loads(text.decode(), **read)
        code, sentence = judged(told, 1)
        for factor in (2, 4) if code == 4 else ():
            more, what = judged(told, factor)
            if more != 4: return 4, f"{sentence}; with {factor * told['bits'][0][1]} bits it is {what}"
        return code, sentence + "; nor do 4 times the bits decide" * (code == 4)
    except OSError as error: return 2, f"no certificate: it cannot be read: {error.strerror}"
    except BROKEN as error:
        return 2, f"no certificate: {type(error).__name__}: {' '.join(str(error).split())[:200]}"

if __name__ == "__main__":
    code, sentence = verdict(sys.argv[1]) if len(sys.argv) == 2 else (2, "usage: verify.py FILE")
    print(sentence)
    sys.exit(code)
