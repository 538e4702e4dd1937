"""Checks a certificate of a run of hard circles, walls and pockets: verify.py FILE [--work=N].

docs/certificates.md defines the format, and says why this suffices. There is no search and no
queue: what is stated is proved again, or refused. The laws stand once, in `World`, and run in two:
of intervals (`Ball`), which tell a sign truly or not at all, and of exact numbers (`Form`), sums of
fractions times roots. What is done and what is kept is charged to one account before.
"""
import copy, hashlib, json, random, re, sys
from collections import defaultdict, namedtuple
from fractions import Fraction
from functools import cached_property
from itertools import product
from math import isqrt, prod
from pathlib import Path

FORMAT, BYTES, CIRCLES, BITS = "truebreak/certificate-3", 1 << 24, 1000, 1 << 20
PAIRS, SIZE, DIGITS, ROOTS, FEW, KEEP = 1 << 20, 1 << 30, 100_000, 99, 128, 128
WORK, EACH, ROOM, PARTS = 16 * 10**9, 32_000, 2 * 10**8, 4 * 10**6
ROW, COUNT, ANY = rf"\d{{1,{DIGITS}}}+", r"[1-9]\d{0,14}", '".*"'
CONTACT, PAIR = r"\[\d{1,15},-?\d{1,15}\]", r"\[-?\d{1,15},-?\d{1,15}\]"
DECIMAL, REASON = rf'"-?{ROW}(?:\.{ROW})?"', '"(events|stopped|horizon|return|quiet)"'
POLICY = r'"(simultaneous|sequential(:order=scene|:seed=\d{1,18})?)"'
QUESTION, HOW = '"(?:gap|closing|disc|speed|slack|until|reverse)"', r'(?:"back"|\d{1,15})'
THINGS = {"circles": "x y vx vy r w", "walls": "x0 y0 x1 y1 length", "pockets": "x y r"}
OPTIONAL = {"capture", "reverse_after", "reverse_at", "roots", "walls", "pockets", "met", "exact",
            "turn", "rounds", "enter", "zeros", "until", "limit"}
def each(item, times="*+"): return rf"\[(?:{item},?){times}\]"
def spelt(roots):  # how a number is spelt that uses so many roots
    name = "|".join(f"r{k}" for k in range(roots, 0, -1)) or "none"
    term = rf"{ROW}(?:/(?=0*+[1-9]){ROW})?(?:\*(?:{name}))*+"
    return f'"[+-]?{term}(?:[+-]{term})*+"'
def shape(own, all):  # what the parts of a certificate are, and how they are spelt
    own, any, pushes, map = spelt(own), spelt(all), each(CONTACT, "++"), each(PAIR)
    told = each(CONTACT.replace(r"\]", rf",{any}\]"), "++")
    zeros, rounds = each(rf"\[{QUESTION},{CONTACT},{HOW}(?:,{CONTACT})?\]"), f"(?:{pushes}|{told})"
    scene = {"capture": "true|false", "reverse_after": COUNT, "reverse_at": own, "roots": each(own)}
    for kind, names in THINGS.items(): scene[kind] = {"id": ANY} | dict.fromkeys(names.split(), own)
    return {"format": ANY, "writer": ANY, "bits": COUNT, "roots": each(any),
            "scene": scene | {"tie_policy": POLICY},
            "isometries": {"matrix": each(any, "{4}"), "shift": each(any, "{2}"), "map": map},
            "instants": {"time": DECIMAL, "met": pushes, "exact": any, "turn": "true",
                         "rounds": each(rounds), "enter": each(CONTACT), "zeros": zeros},
            "end": {"reason": REASON, "limit": COUNT, "until": any, "zeros": zeros},
            "final": {"time": DECIMAL, "circles": each(each(DECIMAL, "{4}"))}}
def fits(value, shape):  # refuses a part, or a list of parts, of another shape
    for part in value if isinstance(value, list) else [value]:
        for key in part.keys() | (shape.keys() - OPTIONAL):
            found, inner = part[key], shape[key]
            if isinstance(inner, dict): fits(found, inner)
            elif not re.fullmatch(inner, json.dumps(found, separators=(",", ":")), re.ASCII):
                raise Malformed(f"its {key} is not of its shape")
Flight = namedtuple("Flight", "x y vx vy age seen")  # at (x, y) at `age`; `seen`: where else it was
class Malformed(ValueError): """This is no certificate."""
class Refuted(Exception): code, word = 1, "refuted"
class Undecided(Exception): code, word = 4, "not decided"  # intervals too wide, or nothing shows it
class Declined(Exception): code, word = 4, "declined"
BROKEN = LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError
def refuse(wrong, text, fault=Refuted):
    if wrong: raise fault(text)
def demand(sign, wanted, text, fault=Refuted):  # goes on if a sign is among those wanted
    if sign not in wanted: raise (Undecided if sign is None else fault)(text)
class Account: work, most, room, rooms = 0, WORK, 0, ROOM  # units of about a nanosecond; bytes
cost = Account()
def charge(units, room=0):
    cost.work, cost.room = cost.work + units, cost.room + room
    if cost.work > cost.most: raise Declined(f"costs more than {cost.most} units of work; --work=N")
    if cost.room > cost.rooms: raise Declined(f"costs more than {cost.rooms} bytes; --work=N")
class Form(dict):
    """An exact number: a sum of terms {roots: factor}; zero if it has none. What takes a division
    or a root, and is not told, is `UNTOLD`, and stays so."""
    squares, most = [], 1 << 16  # of the roots, in terms of those before; most terms of a product
    def __neg__(self): return Form((k, -x) for k, x in self.items())
    def __sub__(self, o): return self + -o
    def __add__(self, o):
        charge(5_000)
        if None in self or None in o: return UNTOLD
        for x in (*self.values(), *o.values()): charge(6_000 + (size(x) ** 2 >> 5))
        return Form((k, x) for k in {**self, **o} if (x := self.get(k, 0) + o.get(k, 0)))
    def __mul__(self, o):
        charge(8_000)
        if None in self or None in o: return UNTOLD if self and o else NONE
        refuse(len(self) * len(o) > Form.most, "a product has too many terms", Declined)
        parts = defaultdict(lambda: defaultdict(int))  # by roots of both, whose squares are told
        for (j, x), (k, y) in product(self.items(), o.items()):
            charge(20_000 + ((size(x) + size(y)) ** 2 >> 4))
            parts[j & k][j ^ k] += x * y
        sums = {ks: Form((k, x) for k, x in part.items() if x) for ks, part in parts.items()}
        return sum((prod((Form.squares[n] for n in ks), start=x) for ks, x in sums.items()), NONE)
    def at(self, _): return self
    def sign(self):  # where it is known without an interval: roots are positive
        (k, x), *more = self.items() or [(0, 0)]
        return None if more or k is None else (x > 0) - (x < 0)
class Ball:
    """The reals within r of m, in units of 2**-bits. Two that meet have the same bits."""
    bits, roots = 0, []  # those of the certificate
    def __init__(self, m, r, bits): self.m, self.r, self.bits = m, r, bits
    def __neg__(self): return Ball(-self.m, self.r, self.bits)
    def meet(self, o, times=0):  # before two are computed with
        if self.bits != o.bits: raise Undecided("numbers of unlike bits meet")
        long = self.m.bit_length() + self.r.bit_length()
        cost.work += 2_000 + (long >> 3) + (times * long * (o.m.bit_length() + self.bits) >> 12)
        return self.bits if cost.work <= cost.most else charge(0)
    def __add__(self, o): return Ball(self.m + o.m, self.r + o.r, self.meet(o))
    def __sub__(self, o): return Ball(self.m - o.m, self.r + o.r, self.meet(o))
    def __mul__(self, o):
        bits, wide = self.meet(o, 1), abs(self.m) * o.r + abs(o.m) * self.r + self.r * o.r
        return shifted(self.m * o.m, wide, bits, bits)
    def __truediv__(self, o):
        self.meet(o, 8)
        if (least := abs(o.m) - o.r) <= 0: raise Undecided("a number that may be zero divides")
        m, rest = divmod(self.m << self.bits, o.m)
        wide = (self.r << self.bits) + (abs(m) + 1) * o.r
        return Ball(m, wide // least + 2 if rest or wide else 0, self.bits)
    def sqrt(self):  # |sqrt(x) - sqrt(m)| is at most r / (2 sqrt(m) - r / sqrt(m))
        self.meet(self, 8)
        if self.m <= self.r: raise Undecided("a number that may not be positive has a root")
        m, wide = isqrt(self.m << self.bits), self.r << self.bits
        off = wide // max(1, 2 * m - wide // m - 1) + 2
        return Ball(m, off if wide or m * m < self.m << self.bits else 0, self.bits)
    def at(self, bits):  # with fewer bits
        return shifted(self.m, self.r, drop, bits) if (drop := self.bits - bits) > 0 else self
    def sign(self):
        return (self.m > self.r) - (self.m < -self.r) or (None if self.r else 0)
def shifted(m, r, drop, bits):  # by so many bits less, rounded outward; what is exact stays so
    return Ball(m >> drop, (r >> drop) + 2 if r or m & ((1 << drop) - 1) else 0, bits)
def whole(n): return Ball(n << Ball.bits, 0, Ball.bits)
def enclosed(form):  # as a ball
    return sum((prod((Ball.roots[n] for n in ks), start=whole(x.numerator)) / whole(x.denominator)
                for ks, x in form.items()), whole(0))
def sign_of(form): return enclosed(form).sign() if (sign := form.sign()) is None else sign
NONE, ONE, UNTOLD = Form(), Form({frozenset(): Fraction(1)}), Form({None: float("nan")})
def size(x): return x.numerator.bit_length() + x.denominator.bit_length()
def number(text):  # reads a sum of terms such as 3/4*r1*r2
    total = NONE
    for x, *ks in (term.split("*r") for term in re.findall("[+-]?[^+-]+", text)):
        charge(5_000 + (len(x) ** 2 >> 5))
        roots = [frozenset({int(k) - 1}) for k in ks if Form.squares[int(k) - 1]]
        factor = Form({frozenset(): x} if (x := Fraction(x)) else {})
        total += prod((Form({k: Fraction(1)}) for k in roots), start=factor)
    return total
class Meeting:
    """Two at one instant, `arms` the directions in which they are pushed; computed as it is asked
    for. The gap at s later is gap + 2 closing s + speed s^2."""
    def __init__(self, d, v, reach, arms): self.d, self.v, self.reach, self.arms = d, v, reach, arms
    gap = cached_property(lambda m: m.d[0] * m.d[0] + m.d[1] * m.d[1] - m.reach * m.reach)
    closing = cached_property(lambda m: m.d[0] * m.v[0] + m.d[1] * m.v[1])
    speed = cached_property(lambda m: m.v[0] * m.v[0] + m.v[1] * m.v[1])
    cross = cached_property(lambda m: m.d[0] * m.v[1] - m.d[1] * m.v[0])
    disc = cached_property(lambda m: m.speed * (m.reach * m.reach) - m.cross * m.cross)  # Lagrange
class Bounce(Meeting):
    disc = cached_property(lambda m: m.closing * m.closing)  # at a wall, where `d` is its normal
class World:
    """The laws of flight, meeting and impulse, in numbers of one kind. Circles fly, and pockets,
    which rest: pocket k is number -1 - k. A contact (i, j) is of two circles if 0 <= j < n, of wall
    j - n, or of the rim of a pocket. What is computed of flights is kept while they are flown."""
    def __init__(self, n, things, sides, limits, of):
        self.n, self.sides, self.read, self.none, self.bits = n, sides, of, of(NONE), Ball.bits
        self.things = {k: [*map(of, row)] for k, row in things.items()}
        self.flights = {k: Flight(*row[:4], 0, {}) for k, row in self.things.items() if k < n}
        self.times, self.limits = [self.none], {key: of(x) for key, x in limits.items()}
    def put(self, i, age):  # a flight, told from where it is at an instant
        if (found := (flight := self.flights[i]).seen.get((age, self.bits))) is None:
            if age == flight.age: x, y, vx, vy = self.at(*flight[:4])
            else:
                (x, y, vx, vy, *_), wait = self.put(i, flight.age), self.wait(flight.age, age)
                x, y = x + vx * wait, y + vy * wait
            if len(flight.seen) > 9 + 9_999 // self.n: flight.seen.clear()
            found = flight.seen[age, self.bits] = Flight(x, y, vx, vy, age, {})
        return found
    def at(self, *numbers): return [x.at(self.bits) for x in numbers]  # as the world has them now
    def of(self, form): return self.read(form).at(self.bits)
    def less(self, x, y): return x.at(self.bits) - y.at(self.bits)
    def wait(self, start, age): return self.less(self.times[age], self.times[start])
    def start(self, c): return max(self.flights[k].age for k in c if k < self.n)
    def reach(self, c):  # of two circles the sum of their radii
        return self.things[c[1]][4] if c[1] < 0 else self.things[c[0]][4] + self.things[c[1]][4]
    def meeting(self, c, age):  # of two at an instant
        (i, j), (x, y, vx, vy, *_) = c, self.put(c[0], age)
        if j < self.n:
            u, v, p, q, *_ = self.put(j, age)
            d, reach = (u - x, v - y), self.reach(c).at(self.bits)
            return Meeting(d, (p - vx, q - vy), reach, {i: (-d[0], -d[1]), j: d})
        u, v, p, q, length, r, none = self.at(*self.things[j], self.things[i][4], self.none)
        d = (p, q) if self.sides[c] > 0 else (-p, -q)
        found, gap = Bounce(d, (vx, vy), none, {i: d}), d[0] * (x - u) + d[1] * (y - v) - r * length
        found.gap, found.speed = gap + gap, none
        return found
    def hit(self, c):  # when the gap of two falls through zero
        if self.read is Form: return UNTOLD
        m = self.meeting(c, start := self.start(c))
        return self.times[start].at(self.bits) + m.gap / (m.disc.sqrt() - m.closing)
    def solve(self, rows):  # the x with G x = y, by elimination; a row is one of G, and then of y
        low = []
        for k, (pivot, *top) in enumerate(rows):  # of the rows below one number less, each time
            rest = [(row[0] / pivot, row[1:]) for row in rows[k + 1:]]
            rows[k + 1:] = [[x - f * y for x, y in zip(row, top, strict=True)] for f, row in rest]
        for pivot, *top, y in reversed(rows):
            low = [sum((-(g * x) for g, x in zip(top, low, strict=True)), y) / pivot, *low]
        return low
    def blow(self, age, push, others, s):  # a round with impulses s, if untold by G s = -2u
        met, _ = {c: self.meeting(c, age) for c in (*push, *others)}, charge(2_000 * len(push) ** 2)
        self.before = {c: m.closing for c, m in met.items()}
        def effect(a, b):  # an entry of G
            both = ((i, *a[i], *b[i]) for i in a if i in b)
            parts = ((x * p + y * q) * self.things[i][5].at(self.bits) for i, x, y, p, q in both)
            return sum(parts, self.none.at(self.bits))
        if s: s = [*map(self.of, s)]
        elif self.read is Form: s = [UNTOLD] * len(push)
        else: s = self.solve([[*(effect(met[c].arms, met[o].arms) for o in push),
                               -(met[c].closing + met[c].closing)] for c in push])
        for c, j in zip(push, s, strict=True):
            for i, (x, y) in met[c].arms.items():
                (u, v, vx, vy, *_), w = self.put(i, age), self.things[i][5].at(self.bits) * j
                self.flights[i] = Flight(u, v, vx + w * x, vy + w * y, age, {})
        return s
    def ask(self, question, c, age):  # the number that a witness may show to be zero
        if question in self.limits: return self.less(self.limits[question], self.times[age])
        if question == "slack": return self.before[c] + self.meeting(c, age).closing  # 2u + G s
        return getattr(self.meeting(c, age), question)
    def redirect(self, circles, age, factor):  # their velocities times a factor
        for i, (x, y, vx, vy, *_) in [(i, self.put(i, age)) for i in circles]:
            self.flights[i] = Flight(x, y, vx * self.of(factor), vy * self.of(factor), age, {})

class Checker:
    """Follows a certificate. Of the flights of now it keeps `parted`, contacts at gap zero that do
    not meet on them again, and `lasting`, those that stay at gap zero; `out`, the instants of the
    way out with impulses, if not undone; of an instant `met`, contacts listed, and `known`, all at
    gap zero, with the signs of closing, and all blows."""
    def __init__(self, told, factor):  # takes up a certificate and its scene
        self.told, self.end, scene, maps = told, told["end"], told["scene"], told["isometries"]
        self.n, bits, self.policy = (n := len(scene["circles"])), told["bits"], scene["tie_policy"]
        own, parts = scene.get("roots", []), [*told["instants"], self.end]
        refuse(len(roots := own + told["roots"]) > ROOTS, f"it has over {ROOTS} roots", Malformed)
        fits(told, shape(len(own), len(roots)))
        things = [thing for kind in THINGS for thing in scene.get(kind, ())]
        area, ids = n * len(things), {thing["id"] for thing in things}
        hows = {zero[2] for part in parts for zero in part.get("zeros", ())} - {"back"}
        large = n > CIRCLES or area > PAIRS or bits > min(BITS, SIZE // area)
        for wrong, text in (
                (large, "it has too many circles, walls, pockets or bits"),
                (len(ids) < len(things) or not told["instants"], "an id twice, or no instant"),
                ({"reverse_at", "reverse_after"} <= scene.keys(), "it has two reversals"),
                (len(told["final"]["circles"]) != n, "of other circles than those the end is told"),
                (hows - {*range(len(maps))}, "a witness names no isometry that there is")):
            refuse(wrong, text, Malformed)
        text = json.dumps(scene, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
        self.digest = hashlib.sha256(text.encode()).hexdigest()
        Ball.bits, Form.squares, Ball.roots, cost.room = bits * factor, [], [], 0
        charge(3_000 * area, 300 * area + 2 * len(things) * Ball.bits)
        for text in roots:
            Form.squares.append(number(text))
            demand(sign_of(Form.squares[-1]), [1], "what has a root is not positive", Malformed)
            Ball.roots.append(enclosed(Form.squares[-1]).sqrt())
        circles, walls, pockets = ([[number(thing[name]) for name in THINGS[kind].split()]
                                    for thing in scene.get(kind, ())] for kind in THINGS)
        lines = [[x, y, y - v, u - x, length] for x, y, u, v, length in walls]
        rims = [[x, y, NONE, NONE, r, NONE] for x, y, r in reversed(pockets)]
        self.things = dict(enumerate(circles + lines)) | dict(enumerate(rims, -len(rims)))
        self.movable = {i for i, row in enumerate(circles) if row[5]}
        limits = {"reverse": number(scene["reverse_at"])} if "reverse_at" in scene else {}
        if self.end["reason"] == "horizon": limits["until"] = number(self.end["until"])
        for *_, p, q, r in lines:
            demand(sign_of(p * p + q * q - r * r), [0], "a wall's length differs", Malformed)
        moves = any((vx or vy) and not w for _, _, vx, vy, _, w in circles)
        refuse(moves, "a fixed circle moves", Malformed)
        sizes = [x for row in circles for x in row[4:] if x] + [row[4] for row in lines + rims]
        for x in (*sizes, *limits.values()): demand(sign_of(x), [1], "a size or a time", Malformed)
        pairs = ((i, j) for j in range(n) for i in range(j) if circles[i][4] or circles[j][4])
        others = product(self.movable, self.things.keys() - range(n))
        self.meets = {c for c in (*pairs, *others) if self.movable & {*c}}
        self.of = defaultdict(list)  # the contacts of each
        for c, i in ((d, i) for d in self.meets for i in d): self.of[i].append(c)
        sides = {(i, k): sign_of(p * (circles[i][0] - x) + q * (circles[i][1] - y))
                 for i in self.movable for k, (x, y, p, q, _) in enumerate(lines, n)}
        for c, sign in sides.items(): demand(sign, [1, -1], f"the centre of {c} is on the wall")
        self.worlds = [World(n, self.things, sides, limits, of) for of in (enclosed, Form)]
        self.ball, self.form = self.worlds
        self.few, self.few.bits = copy.copy(self.ball), min(FEW, Ball.bits)
        self.few.things = {k: self.few.at(*row) for k, row in self.ball.things.items()}
        self.isometries, self.parted = [self.isometry(g) for g in maps], set()
        self.age, self.count, self.out, self.known, self.lasting = -1, 0, [], {}, {}
        self.last = self.end["limit"] if self.end["reason"] == "events" else None
        self.draw = random.Random(int(self.policy[16:])) if ":seed=" in self.policy else None
        self.due = self.way = False
    def isometry(self, told):  # its linear part, its map, as the data have it, and whose flights
        (a, b, d, e), (p, q) = ([number(text) for text in told[key]] for key in ("matrix", "shift"))
        images, zeros = dict(told["map"]), [a * a + d * d - ONE, b * b + e * e - ONE, a * b + d * e]
        for i, j in images.items():
            (x, y, vx, vy, *k), (u, v, wx, wy, *m) = self.things[i], self.things[j]
            x, y = a * x + b * y + p - u, d * x + e * y + q - v
            vx, vy = a * vx + b * vy, d * vx + e * vy
            zeros += [ONE] * ((i < 0, i < self.n) != (j < 0, j < self.n))
            if i >= self.n: zeros += [vx * wy - vy * wx, x * wx + y * wy]
            else: zeros += [x, y, vx - wx, vy - wy, *(r - s for r, s in zip(k, m, strict=False))]
        signs, twice = {sign_of(x) for x in zeros}, len({*images.values()}) < len(told["map"])
        refuse(twice or signs & {1, -1}, "an isometry maps otherwise")
        refuse(None in signs, "whether an isometry maps otherwise", Undecided)
        return (a, b, d, e), images, {i for i in images if 0 <= i < self.n}
    def image(self, images, c):  # the image of a contact
        i, j = (images.get(k) for k in c)
        return tuple(sorted((i, j))) if None not in (i, j) and 0 <= j < self.n else (i, j)
    def mapped(self, g):  # the circles whose flights an isometry maps, and so all that hits them
        _, images, kept = g
        charge(200 * len(kept))
        hit = {i for i in kept if i in self.rows or images[i] in self.rows}
        def strays(i):
            row, like = (self.rows.get(k, []) for k in (i, images[i]))
            charge(2_000 + 500 * sum(map(len, row)))
            by = {k for part in row for c in part for k in c} & self.movable
            return by - kept or like != [{self.image(images, c) for c in part} for part in row]
        while bad := {i for i in hit & kept if strays(i)}: kept = kept - bad
        return kept
    def proves(self, question, c, how, other=None):  # whether a witness proves a number zero
        (i, j), other = c, tuple(other) if other else self.clock
        if how == "back":
            late = question == "until" and self.end["reason"] == "return" and len(self.out) == 1
            due = self.way and self.out and (late or question == "gap")
            return due and self.met.get(other, 0) < 0 and {c, other} <= self.out[-1][1]
        (a, b, d, e), images, _ = g = self.isometries[how]
        kept, first = self.mapped(g), question == "closing" and not self.rows
        alike = other in self.met and self.image(images, c) == other
        if alike and (question == "gap" or first > abs(self.met[other])):
            return all(k in kept for k in c if 0 <= k < self.n)
        if j >= self.n and question == "closing":
            _, _, nx, ny, _ = self.things[j]
            turned = not (a * nx + b * ny + nx or d * nx + e * ny + ny)
            return turned and images.get(i) == i and i in kept
        unturned = question in ("closing", "speed") and not any((a - ONE, b, d, e - ONE))
        return unturned and any(images.get(k) == m and k in kept for k, m in ((i, j), (j, i)))
    def zero(self, question, c, age):  # whether a number is zero, as a form or by a witness
        charge(3_000 * len(hows := self.witnesses[question, c]))
        exactly = not self.form.ask(question, c, age)
        return exactly or any(self.proves(question, c, *how) for how in hows)
    def sign(self, question, c):  # the sign of a number
        if (sign := self.ball.ask(question, c, self.age).sign()) is not None: return sign
        if self.zero(question, c, self.age): return 0
        raise Undecided(f"{c}: nothing shows that {question!r} is zero, or what sign it has")
    def apart(self, c, start, age):  # as `clear`, in whole numbers that are at most `off` off
        few, (i, j), wall = self.few, c, c[1] >= self.n
        reach = few.things[i][4] if wall else few.reach(c)
        for turn, at in ((1, start), (-1, age))[:1 + (age is not None)]:
            a, b = few.put(i, at)[:4], few.things[j] if wall else few.put(j, at)[:4]
            off, far = reach.r, abs(reach.m)
            for z in (*a, *b): off, far = off + z.r, far + abs(z.m)
            charge(15_000 + (far.bit_length() ** 2 >> 10))
            off *= 4 * (far + off)  # so are sums of products of two of them
            (x, y, vx, vy), (u, v, p, q, *length) = [z.m for z in a], [z.m for z in b]
            x, y, size = u - x, v - y, reach.m * (length[0] if wall else reach.m)
            if wall:
                if few.sides[c] * (x * p + y * q) + size + off >= 0: return False
                continue
            vx, vy = p - vx, q - vy
            gap, closing = x * x + y * y - size - off, turn * (x * vx + y * vy) - off
            if gap <= 0 or closing >= 0: return gap > 0  # at least as large
            wait = age is not None and few.wait(start, age)
            if wait and (gap << wait.bits) + 2 * closing * (wait.m + wait.r) > 0: return True
            cross, speed = abs(x * vy - y * vx) - off, vx * vx + vy * vy + off
            if cross > 0 and speed * (size + off) < cross * cross: return True
        return wall and age is not None
    def clear(self, c, age=None, last=False):  # proves that two do not meet on their flights
        start, doubt = self.ball.start(c), Undecided(f"whether {c} meet before it")
        if c in self.parted or self.apart(c, start, age): return
        wait, gaps, meet = age is not None and self.ball.wait(start, age), [], True
        for turn, at in ((1, start), (-1, age))[:1 + (age is not None)]:  # from then; backwards
            m = self.ball.meeting(c, at)
            rise = m.closing if turn > 0 else -m.closing
            gap, closing, disc = m.gap.sign(), rise.sign(), m.disc.sign()
            gaps.append(gap)
            if c[1] < 0 and gaps[0] is None: raise doubt  # the centre may be in it from the start
            if c[1] < 0 and gaps[0] == -1: return
            tangent = wait and {*gaps} == {1} and (m.gap + rise * wait + rise * wait).sign() == 1
            if {*gaps} == {1} and (closing in (0, 1) or disc == -1 or tangent): return
            meet &= (closing, disc) == (-1, 1)
        refuse(meet or gaps[0] == 0 or -1 in gaps, f"{c} overlap, or meet before it")
        for x in ("closing", "disc") if gaps[0] == 1 and (last or gaps[-1] == 1) else ():
            if self.zero(x, c, start): return
        raise doubt
    def take(self, entry, where):  # takes up the witnesses of an entry
        Checker.where, self.witnesses, self.clock = where, defaultdict(list), None
        self.met, self.rows = {}, {}
        for question, c, *how in entry.get("zeros", ()):
            self.witnesses[question, tuple(c)].append(how)
    def instant(self, entry):  # its time; what meets at it, or the reversal; what follows
        self.age, turn, told, due = self.age + 1, "turn" in entry, "exact" in entry, self.due
        age, times, met = self.age, self.ball.times, [*map(tuple, entry.get("met", ()))]
        charge(30_000 + 5_000 * (self.n + len(self.isometries)), Ball.bits // 4 + 2_000)
        self.take(entry, f"instant {age}")
        refuse(due != turn or self.count == self.last, "the reversal is due, or not, or the end is")
        refuse(told and (turn or not age), "it has a time already")
        refuse(len({*met} & self.meets) < len(met) * (1 + turn), f"{met} cannot meet")
        for w in self.worlds if age else ():
            if turn: w.times.append(w.times[-1])
            else: w.times.append(w.of(number(entry["exact"])) if told else w.hit(met[0]))
        self.said(times[age], entry["time"])
        if age and not turn: demand(self.ball.wait(age - 1, age).sign(), [1], "it comes no later")
        for c in met:
            self.clock = self.clock or c
            if self.met or told or not age: refuse(self.sign("gap", c), f"{c} do not meet at it")
            self.met[c] = self.sign("closing", c)
            stays = age and not self.met[c] and not self.sign("speed", c)
            refuse(stays, f"{c} are at gap zero all the time, and do not come to it")
            if age and self.met[c] > 0: self.clear(c, last=True)  # a rim is left from within
        turned = {c: -sign for c, sign in self.known.items()}
        self.known, self.way = turned if turn else self.lasting | self.met, self.way or turn
        if turn: self.settle(self.movable)
        for w in self.worlds if turn else ():
            w.redirect(self.movable, age, -ONE)
            w.limits.pop("reverse", None)
            if self.end["reason"] == "return": w.limits["until"] = w.times[age] + w.times[age]
        self.due = False
        for name in self.ball.limits:
            sign = self.sign(name, self.clock)
            refuse(sign < 0, "the end, or the reversal, comes before it")
            self.due |= name == "reverse" and sign == 0
        refuse(not (met or turn or self.due or age == 0), "nothing falls on it")
        self.resolve([*entry.get("rounds", ())], entry, {*self.movable} if turn else set())
        self.due |= not self.way and 0 < self.count == self.told["scene"].get("reverse_after")
        sharp = (x.bits - x.r.bit_length() for i in self.movable for x in self.ball.flights[i][:4])
        bits = max(max(sharp, default=0) + KEEP, self.few.bits)
        if self.ball.bits - bits >= KEEP // 4: self.ball.bits = bits
    def settle(self, circles):  # proves that they have met nothing but what is known
        found = {c for i in circles for c in self.of[i] if c not in self.known}
        charge(500 * sum(len(self.of[i]) for i in circles))
        for c in found & self.meets: self.clear(c, self.age)
    def resolve(self, rounds, entry, moved):  # rounds; then entries; then what lasts
        known, pushes, self.count = self.known, {}, self.count + bool(rounds)
        while approaching := sorted(c for c in known if known[c] < 0 <= c[1]):  # the next group
            group, circles = set(), {*approaching[0]} & {*range(self.n)}
            while more := {c for c in known if not circles.isdisjoint(c)} - group:
                charge(1_000 * len(known))
                group, circles = group | more, circles.union(*more) & {*range(self.n)}
            self.settle(circles)
            while coming := sorted(c for c in group if known[c] < 0 <= c[1]):
                charge(1_000 * len(group))
                if self.policy != "simultaneous":
                    many = self.draw and len(coming) > 1
                    coming = [coming[self.draw.randrange(len(coming)) if many else 0]]
                told = rounds.pop(0) if rounds else []
                push = [(i, j) for i, j, *_ in told]
                s = [number(x) for _, _, *by in told for x in by]
                wrong = not push or len({*push} & {*coming}) < len(push)
                refuse(wrong, f"{push} cannot push")
                others = [c for c in coming if c not in push]
                balls, _ = (w.blow(self.age, push, others, s) for w in self.worlds)
                hit = self.movable & {i for c in push for i in c}
                for c in push if s else ():
                    refuse(self.sign("slack", c), f"the impulse of {c} is another")
                for impulse in balls: demand(impulse.sign(), [1], f"{push} do not push, or may not")
                for c in others: refuse(self.sign("slack", c) < 0, f"{c} push too")
                for i in circles & self.movable:
                    for rows, contacts in ((self.rows, coming), (pushes, push)):
                        row = {c for c in contacts if i in c}
                        if row: rows.setdefault(i, []).append(row)
                moved |= hit
                known |= {c: self.sign("closing", c) for c in sorted(group) if hit & {*c}}
        enter = sorted(c for c in known if c[1] < 0 and known[c] < 0)
        refuse(rounds, "none push in a round")
        refuse(enter != sorted(map(tuple, entry.get("enter", ()))), f"{enter} enter")
        if taken := {i for i, _ in enter if self.told["scene"].get("capture")}:
            self.settle(taken)
            for w in self.worlds: w.redirect(taken, self.age, NONE)
            self.meets = {c for c in self.meets if not taken & {*c}}
        self.known = known = {c: sign for c, sign in known.items() if c in self.meets}
        stay = {c for c in known if c in self.lasting and not moved & {*c}}
        resting = (c for c in known.keys() - stay if not known[c] and not self.sign("speed", c))
        self.lasting = dict.fromkeys(sorted({*stay, *resting}), 0)
        charge(1_000 * (len(self.parted) + len(known)), 200 * len(known))
        self.parted = {c for c in self.parted if not moved & {*c}} | known.keys()
        maps = [(g, self.mapped(g)) for g in self.isometries]
        self.isometries = [(matrix, images, {i for i in kept if not taken & {i, images[i]}})
                           for (matrix, images, _), kept in maps]
        hits, here = {i: rows[::-1] for i, rows in pushes.items()}, {c for c in known if c[1] >= 0}
        if not self.way and (hits or not self.age): self.out.append((hits, here))
        if self.way and hits:
            self.out = self.out[:-1] if [pushes] == [x for x, _ in self.out[-1:]] else []
    def said(self, value, text):  # that a number is as its decimal says, to one unit of its end
        charge(5_000 + (len(text) ** 2 >> 5) + (len(text) * value.m.bit_length() >> 8))
        scale, at = 10 ** len(text.partition(".")[2]), int(text.replace(".", ""))
        off, unit = abs(value.m * scale - (at << value.bits)), 1 << value.bits
        refuse(off - value.r * scale >= unit, f"a number is not {text[:40]}")
        refuse(off + value.r * scale >= unit, f"whether a number is {text[:40]}", Undecided)
    def check(self):  # instant by instant; then what ended the run, and the final state
        for entry in self.told["instants"]: self.instant(entry)
        self.take(self.end, "at the end")
        reason, limits = self.end["reason"], self.ball.limits
        refuse(self.last not in (None, self.count), f"there are {self.count} events")
        left = (self.last is None and self.due) or (reason == "return" and not self.way)
        refuse(left, "no reversal is told")
        if reason not in ("events", "stopped") and "reverse" in limits:
            sign = (limits["reverse"] - limits["until"]).sign() if "until" in limits else 0
            demand(sign, [1], "the reversal is first")
        for w in self.worlds if "until" in limits else (): w.times.append(w.limits["until"])
        self.age += "until" in limits
        charge(500 * len(self.meets))
        for c in self.meets: self.clear(c, None if reason == "quiet" else self.age, last=True)
        self.said(self.ball.times[self.age], self.told["final"]["time"])
        for i, row in enumerate(self.told["final"]["circles"]):
            for value, text in zip(self.ball.put(i, self.age)[:4], row, strict=True):
                self.said(value, text)
        many = [f"{len(self.told['scene'].get(kind, ()))} {kind}" for kind in THINGS]
        events = f"{self.count} event{'s' * (self.count != 1)}, to the end: {reason}"
        return f"{events}; {', '.join(many)}; scene sha256:{self.digest}"
def judged(told, factor):  # the exit code for a certificate with so many times its bits; and words
    Checker.where = "in the scene"
    try: return 0, f"verified: {Checker(told, factor).check()}"
    except (Refuted, Undecided, Declined) as x: return x.code, f"{x.word}: {Checker.where}: {x}"
def once(pairs):  # an object of JSON whose keys differ
    refuse(len(found := dict(pairs)) < len(pairs), "a key comes twice", Malformed)
    return found
def integer(text):  # a number of JSON, which has to be whole
    return refuse(len(text) > 16, "a number of over 15 digits", Malformed) or int(text)
def verdict(path, work=None):  # the exit code for a file, and a sentence
    sys.set_int_max_str_digits(2 * DIGITS + 2)  # a decimal has two rows of digits
    try:
        refuse(Path(path).exists() and not Path(path).is_file(), "it is no regular file", Malformed)
        with Path(path).open("rb") as file: text = file.read(BYTES + 1)
        refuse(len(text) > BYTES, f"it is longer than {BYTES} bytes", Malformed)
        cost.work, cost.most = 0, work or WORK + EACH * len(text)
        cost.rooms, parts = 1 << 60 if work else ROOM, sum(text.count(x) for x in b",[{:")
        if not work and parts > PARTS: return 4, f"declined: more than {PARTS} parts; --work=N"
        numbers = dict.fromkeys(("parse_int", "parse_float", "parse_constant"), integer)
        told = json.loads(text.decode(), object_pairs_hook=once, **numbers)
        refuse(told["format"] != FORMAT, f"the format is not {FORMAT}", Malformed)
        timed = all({"met", "exact", "turn"} & entry.keys() for entry in told["instants"][1:])
        refuse(not timed, "an instant has neither met nor exact nor turn", Malformed)
        code, sentence = judged(told, 1)
        for factor in (2, 4) if sentence.startswith(Undecided.word) else ():
            more, what = judged(told, factor)
            if more != 4: return 4, f"{sentence}; with {factor * told['bits']} bits it is {what}"
        return code, sentence
    except MemoryError: return 4, "declined: there is not so much memory"
    except OSError as error: return 2, f"no certificate: it cannot be read: {error.strerror}"
    except BROKEN as error:
        return 2, f"no certificate: {type(error).__name__}: {' '.join(str(error).split())[:200]}"
if __name__ == "__main__":
    given = re.fullmatch(r"(?:--work=(\d{1,15}))?", sys.argv[2] if len(sys.argv) == 3 else "")
    code, said = 2, "no certificate: usage: verify.py FILE [--work=N]"
    if given and len(sys.argv) in (2, 3): code, said = verdict(sys.argv[1], int(given[1] or 0))
    sys.exit(print(said.encode("ascii", "backslashreplace").decode()) or code)
