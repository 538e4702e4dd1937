"""Checks a certificate of a run of hard circles, walls and segments: verify.py FILE [--work=N].

docs/certificates.md defines the format, and says why this suffices. There is no search and no
queue: what is stated is proved again, or refused. The laws stand once, in `Space`, and run in two:
of intervals (`Ball`), which tell a sign truly or not at all, and of exact numbers (`Sum`)."""
import collections, copy, fractions, hashlib, json, math, operator, pathlib, random, re, sys
from functools import cache, cached_property, reduce
from itertools import accumulate, combinations, groupby, product
Fraction, Path, Counter = fractions.Fraction, pathlib.Path, collections.Counter

FORMAT, BYTES, CIRCLES, BITS = "truebreak/certificate-3", 1 << 24, 1000, 1 << 20
PAIRS, SIZE, DIGITS, ROOTS, FEW, KEEP = 1 << 20, 1 << 30, 100_000, 99, 128, 128
WORK, EACH, ROOM, PART = 16 * 10**9, 32_000, 2 * 10**8, 50
ROW, COUNT, ANY = rf"\d{{1,{DIGITS}}}+", r"[1-9]\d{0,14}", '".*"'
CONTACT, PAIR = r"\[\d{1,15},-?\d{1,15}\]", r"\[-?\d{1,15},-?\d{1,15}\]"
DECIMAL, REASON = rf'"-?{ROW}(?:\.{ROW})?"', '"(events|stopped|horizon|return|quiet)"'
POLICY = r'"(simultaneous|sequential(:order=scene|:seed=\d{1,18})?)"'
QUESTION, HOW = '"(?:gap|closing|disc|speed|slack|until|reverse|rest)"', r'(?:"back"|\d{1,15})'
THINGS = {"circles": "x y vx vy r w", "walls": "x0 y0 x1 y1 length vx vy", "pockets": "x y r",
          "segments": "x0 y0 x1 y1 length r vx vy", "arcs": "x y r x0 y0 x1 y1"}
OPTIONAL = {"capture", "reverse_after", "reverse_at", "roots", "walls", "pockets", "segments",
            "restitution", "gravity", "arcs", "vx", "vy", "x0", "y0", "x1", "y1", "settle",
            "met", "exact", "turn", "rounds", "enter", "bounces", "zeros", "until", "limit"}
def each(item, times="*+"): return rf"\[(?:{item},?){times}\]"
def spelt(roots):  # how a number is spelt that uses so many roots
    name = "|".join(f"r{k}" for k in range(roots, 0, -1)) or "none"
    term = rf"{ROW}(?:/(?=0*+[1-9]){ROW})?(?:\*(?:{name}))*+"
    return f'"[+-]?{term}(?:[+-]{term})*+"'
@cache
def shape(own, all):  # what the parts of a certificate are, and how they are spelt
    own, any, pushes, map = spelt(own), spelt(all), each(CONTACT, "++"), each(PAIR)
    told = each(CONTACT.replace(r"\]", rf",{any}\]"), "++")
    zeros, rounds = each(rf"\[{QUESTION},{CONTACT},{HOW}(?:,{CONTACT})?\]"), f"(?:{pushes}|{told})"
    scene = {"capture": "true|false", "reverse_after": COUNT, "reverse_at": own, "roots": each(own)}
    scene |= {"restitution": own, "gravity": each(own, "{2}"), "settle": "true"}
    for kind, names in THINGS.items(): scene[kind] = {"id": ANY} | dict.fromkeys(names.split(), own)
    return {"format": ANY, "writer": ANY, "bits": COUNT, "roots": each(any),
            "scene": scene | {"tie_policy": POLICY},
            "isometries": {"matrix": each(any, "{4}"), "shift": each(any, "{2}"), "map": map},
            "instants": {"time": DECIMAL, "met": pushes, "exact": any, "turn": "true",
                         **dict.fromkeys(("enter", "settle", "bounces"), each(CONTACT)),
                         "rounds": each(rounds), "zeros": zeros},
            "end": {"reason": REASON, "limit": COUNT, "until": any, "zeros": zeros},
            "final": {"time": DECIMAL, "circles": each(each(DECIMAL, "{4}"))}}
def dense(x): return json.dumps(x, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
def fits(value, shape):  # refuses a part, or a list of parts, of another shape
    for part in value if isinstance(value, list) else [value]:
        for key in part.keys() | (shape.keys() - OPTIONAL):
            if isinstance(shape[key], dict): fits(part[key], shape[key])
            elif not re.fullmatch(shape[key], dense(part[key]), re.ASCII):
                raise Malformed(f"its {key} is not of its shape")
Flight = collections.namedtuple("Flight", "x y vx vy age seen")  # at (x, y) at `age`, and elsewhere
class Malformed(ValueError): """This is no certificate."""
class Refuted(Exception): code, word = 1, "refuted"
class Unsettled(Exception): code, word = 4, "not decided"  # intervals too wide, or nothing shows it
class Declined(Exception): code, word = 4, "declined"
BROKEN = LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError
def refuse(wrong, text, fault=Refuted): demand(bool(wrong), [False], text, fault)
def demand(sign, wanted, text, fault=Refuted):  # goes on if a sign is among those wanted
    if sign not in wanted: raise (Unsettled if sign is None else fault)(text)
    return sign
class cost: work, most, room, rooms = 0, WORK, 0, ROOM  # units of about a nanosecond; bytes
def charge(units, room=0):  # before they are spent
    cost.work, cost.room = cost.work + units, cost.room + room
    if cost.work > cost.most: raise Declined(f"costs more than {cost.most} units of work; --work=N")
    if cost.room > cost.rooms: raise Declined(f"costs more than {cost.rooms} bytes; --work=N")
class Sum(dict):  # an exact number: a sum of terms {roots: factor}, zero if none; or `UNTOLD`
    squares, most = [], 1 << 16  # of the roots, in terms of those before; most terms of a product
    def __neg__(self): return Sum((k, -x) for k, x in self.items())
    def __sub__(self, o): return self + -o
    def __add__(self, o):
        if None in self or None in o: return UNTOLD
        for x in (*self.values(), *o.values(), 1): charge(6_000 + spent(2 * size(x)) // 2)
        return Sum((k, x) for k in {**self, **o} if (x := self.get(k, 0) + o.get(k, 0)))
    def __mul__(self, o):
        if None in self or None in o: return UNTOLD if self and o else NONE
        refuse(len(self) * len(o) > Sum.most, "a product has too many terms", Declined)
        parts = collections.defaultdict(Counter)  # by roots of both
        for (j, x), (k, y) in product(self.items(), o.items()):
            charge(20_000 + 2 * spent(size(x) + size(y) + size(parts[j & k][j ^ k])))
            parts[j & k][j ^ k] += x * y
        sums = [(ks, Sum((k, x) for k, x in part.items() if x)) for ks, part in parts.items()]
        return sum((math.prod((Sum.squares[n] for n in ks), start=x) for ks, x in sums), NONE)
    def at(self, _): return self
    def sign(self):  # where it is known without an interval: roots are positive
        (k, x), *more = self.items() or [(0, 0)]
        return None if more or k is None else (x > 0) - (x < 0)
class Ball:  # the reals within r of m, in units of 2**-bits; two that meet have the same bits
    bits, roots = 0, []  # those of the certificate
    def __init__(self, m, r, bits): self.m, self.r, self.bits = m, r, bits
    def __neg__(self): return Ball(-self.m, self.r, self.bits)
    def meet(self, o, times=0):  # before two are computed with
        if self.bits != o.bits: raise Unsettled("numbers of unlike bits meet")
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
        if (least := abs(o.m) - o.r) <= 0: raise Unsettled("a number that may be zero divides")
        m, rest = divmod(self.m << self.bits, o.m)
        wide = (self.r << self.bits) + (abs(m) + 1) * o.r
        return Ball(m, wide // least + 2 if rest or wide else 0, self.bits)
    def sqrt(self):  # |sqrt(x) - sqrt(m)| is at most r / (2 sqrt(m) - r / sqrt(m))
        self.meet(self, 8)
        if self.m <= self.r: raise Unsettled("a number that may not be positive has a root")
        m, wide = math.isqrt(self.m << self.bits), self.r << self.bits
        off = wide // max(1, 2 * m - wide // m - 1) + 2
        return Ball(m, off if wide or m * m < self.m << self.bits else 0, self.bits)
    def at(self, bits):  # with fewer bits
        return shifted(self.m, self.r, drop, bits) if (drop := self.bits - bits) > 0 else self
    def sign(self): return (self.m > self.r) - (self.m < -self.r) or (None if self.r else 0)
def shifted(m, r, drop, bits):  # by so many bits less, rounded outward; what is exact stays so
    return Ball(m >> drop, (r >> drop) + 2 if r or m & ((1 << drop) - 1) else 0, bits)
def top(x): return Ball(math.isqrt((abs(x.m) + x.r) << x.bits) + 1, 0, x.bits)  # over its root
def whole(n): return Ball(n << Ball.bits, 0, Ball.bits)
def enclosed(form):  # as a ball
    return sum((math.prod((Ball.roots[n] for n in ks), start=whole(x.numerator))
                / whole(x.denominator) for ks, x in form.items()), whole(0))
def sign_of(form): return enclosed(form).sign() if (sign := form.sign()) is None else sign
NONE, ONE, UNTOLD = Sum(), Sum({frozenset(): Fraction(1)}), Sum({None: float("nan")})
HALF, RANGE = Sum({frozenset(): Fraction(1, 2)}), ("foot", "far")
def size(x): return x.numerator.bit_length() + x.denominator.bit_length()
def spent(long): return 4 * long + (long**2 >> 12)  # on two fractions of so many bits
def number(text):  # reads a sum of terms such as 3/4*r1*r2
    total = NONE
    for x, *ks in (term.split("*r") for term in re.findall("[+-]?[^+-]+", text)):
        charge(5_000 + (len(x) ** 2 >> 5))
        roots = [frozenset({int(k) - 1}) for k in ks if Sum.squares[int(k) - 1]]
        total += math.prod((Sum({k: 1}) for k in roots), start=Sum({frozenset(): Fraction(x)}))
    return total
class Nearing:  # of two; at s later the gap is gap + 2 closing s + speed s^2; `arms`: the rows of J
    hollow, bow, bend = 0, (), ()  # whether its speed is negative; of an arc; half of what pulls
    once = cached_property(lambda m: -m.closing / m.speed)  # until both zeros, if they are one
    def __init__(self, d, v, reach, arms): self.d, self.v, self.reach, self.arms = d, v, reach, arms
    def wait(m, again):  # until the gap falls through zero; perhaps it is zero now
        if not (again or m.hollow): return m.gap / (m.disc.sqrt() - m.closing)
        return -(m.closing + (m.closing if again else m.disc.sqrt())) / m.speed
    gap = cached_property(lambda m: m.d[0] * m.d[0] + m.d[1] * m.d[1] - m.reach * m.reach)
    closing = cached_property(lambda m: m.d[0] * m.v[0] + m.d[1] * m.v[1])
    speed = cached_property(lambda m: m.v[0] * m.v[0] + m.v[1] * m.v[1])
    cross = cached_property(lambda m: m.d[0] * m.v[1] - m.d[1] * m.v[0])
    disc = cached_property(lambda m: m.speed * (m.reach * m.reach) - m.cross * m.cross)  # Lagrange
class Facing(Nearing):  # of a circle and a wall; of a face: where the foot of the centre is on it
    square = cached_property(lambda m: m.d[0] * m.d[0] + m.d[1] * m.d[1])
    height = cached_property(lambda m: m.d[0] * m.place[0] + m.d[1] * m.place[1])
    foot = cached_property(lambda m: m.d[1] * m.place[0] - m.d[0] * m.place[1])  # from its start,
    far = cached_property(lambda m: m.square - m.foot)  # and from its end
    slide = cached_property(lambda m: m.d[1] * m.v[0] - m.d[0] * m.v[1])
    def there(m, wait):  # the sign of whether the foot is on it then
        lift = m.d[1] * m.pull[0] - m.d[0] * m.pull[1]
        foot = m.foot + (m.slide + lift * wait) * wait
        signs = {foot.sign(), (m.square - foot).sign()}
        return -1 if -1 in signs else None if None in signs else min(signs)
class Dropping(Nearing):  # of one that falls and a fixed one: further terms of the gap, s^3 and s^4
    speed = cached_property(lambda m: Nearing.speed.func(m) + m.along(m.d))
    row = cached_property(lambda m: [m.gap, m.closing + m.closing, m.speed, m.along(m.v), m.last])
    last = cached_property(lambda m: m.bend[0] * m.bend[0] + m.bend[1] * m.bend[1])
    def along(m, z): return (x := z[0] * m.bend[0] + z[1] * m.bend[1]) + x
    def tests(m, row): return [row]  # one of them is positive wherever the two do not meet
class Ringing(Dropping):  # of one that falls and a rim: it may be left, and is not entered
    def tests(m, row): return [row, [-x for x in row], slope_of(m.row)]
class Bowing(Nearing):  # of a circle and a side of an arc: from within, the gap is turned round
    def turn(m, x): return -x if m.hollow else x
    gap = cached_property(lambda m: m.turn(Nearing.gap.func(m)))
    closing = cached_property(lambda m: m.turn(Nearing.closing.func(m)))
    speed = cached_property(lambda m: m.turn(Nearing.speed.func(m)))
    disc = cached_property(lambda m: m.turn(m.speed) * (m.reach * m.reach) - m.cross * m.cross)
    foot = cached_property(lambda m: m.beside(m.d, m.reach))  # within the range, at gap zero
    far = cached_property(lambda m: m.foot)
    def beside(m, d, reach):  # d is the way to the middle, so long: the sign says whether within it
        p, q, r, edge = m.bow
        return -(p * d[0] + q * d[1]) * r - edge * reach
    def there(m, wait):  # whether that is within the range
        return m.beside([x + v * wait for x, v in zip(m.d, m.v, strict=True)], m.reach).sign()
class Arching(Bowing, Ringing):  # of one that falls and a side of an arc, where it is in its range
    speed = cached_property(lambda m: m.turn(Dropping.speed.func(m)))
    row = cached_property(lambda m: [m.gap, m.closing + m.closing, m.speed,
                                     m.turn(m.along(m.v)), m.turn(m.last)])
    def tests(m, row):
        ways = [(m.bow[0] * x + m.bow[1] * y) * m.bow[2] for x, y in (m.v, m.bend)]
        return [*Ringing.tests(m, row), [-m.foot, *ways]]
def shift(row):  # of whole numbers: the polynomial from 1 on
    for k in range(len(row) - 1): row = row[:k] + [*accumulate(row[k:][::-1])][::-1]
    return row
def twice(row): return [x << n for n, x in enumerate(row)]  # of whole numbers: at 2 x
def keeps(wait, *rows):  # whether at all times of [0, wait], or for ever, one of them is positive
    def scaled(row):  # to whole numbers, with [0, 1] for [0, wait]
        for k in range(1, len(row)) if wait else (): row = row[:k] + [x * wait for x in row[k:]]
        return [x.m - x.r for x in row], [x.m + x.r for x in row]  # the least, and the most
    parts = [([*map(scaled, rows)], wait is None, 0)]
    def rises(row, ever):  # is it positive? All its terms; or, of 1 / (1 + x), times (1 + x)^n
        if min(row) >= 0 < row[0]: return True
        return not ever and min(row[0], sum(row)) > 0 and min(shift(row[::-1])) >= 0
    while parts:
        sides, ever, depth = parts.pop()
        for low, high in sides: charge(20_000 + 20 * max(abs(x) for x in low + high).bit_length())
        if any(rises(low, ever) for low, _ in sides): continue
        (low, high), asides = sides[0], [[-x for x in high] for _, high in sides[3:]]
        fell = low[0] > 0 > sum(high) and all(rises(row, ever) for row in asides)  # in its range
        if fell or (not sides[1:] and (high[0] < 0 or sum(high) < 0)): return -1
        bare = max(low[0] for low, _ in sides), ever or max(sum(low) for low, _ in sides)
        if depth > 300 or min(bare) <= 0: return None
        if not ever: sides = [[twice(row[::-1])[::-1] for row in pair] for pair in sides]
        parts.append((sides, False, depth + (not ever)))  # a half, as [0, 1], times 2^n; or all of
        sides = [[*map(shift, pair)] for pair in sides]  # [0, 1], and then what is beyond
        if ever: sides = [[*map(twice, pair)] for pair in sides]  # in parts twice as large
        parts.append((sides, ever, depth + 1))
    return 1
def divided(row, x):  # a polynomial over x - s, where it is zero at x
    return [*accumulate(row[-2:0:-1], lambda y, term: x * y - term, initial=-row[-1])][::-1]
def value(row, x): return reduce(lambda total, term: total * x + term, row[::-1])
def slope_of(row): return [Ball(k * x.m, k * x.r, x.bits) for k, x in enumerate(row)][1:]
def falling(row, low, high):  # the one zero of a polynomial that lies between, where it falls
    slope = slope_of(row)
    x = Ball((low.m + high.m) // 2, (high.m - low.m) // 2 + low.r + high.r + 1, low.bits)
    demand(value(slope, x).sign(), [-1], "whether a gap falls all the time that is said", Unsettled)
    for end, sign in ((low, 1), (high, -1)):
        demand(value(row, end).sign(), [sign], "a gap does not fall through zero where it is said")
    def newton(x): return (mid := Ball(x.m, 0, x.bits)) - value(row, mid) / value(slope, x)
    while (next := newton(x)).r < x.r: x = next
    return x
class Space:
    """The laws of flight, meeting and impulse, in numbers of one kind. Number j is a circle (ends
    come last), wall j - n (faces come last), side of an arc (after these), or pocket -1 - j."""
    def __init__(self, n, things, sides, limits, world, of):
        self.n, self.sides, self.read, self.none, self.bits = n, sides, of, of(NONE), Ball.bits
        e, pull, drift, self.bows, self.slopes = world  # restitution, half the gravity, walls that
        # move, the first side of an arc, and how faces pull: the sign of their speeds
        self.loss, self.lost, self.pull = of(e), of(ONE - e), [*map(of, pull)]
        self.drift = {k: [*map(of, v)] for k, v in drift.items()}
        self.fixed = {k for k in range(n) if pull and not things[k][5]}
        self.pegs, self.bounces = {*self.fixed}, {}  # where others fall: these, and what is carried
        self.things = {k: [*map(of, row)] for k, row in things.items()}
        self.flights = {k: Flight(*row[:4], 0, {}) for k, row in self.things.items()}
        self.times, self.limits = [self.none], {key: of(x) for key, x in limits.items()}
    def put(self, i, age):  # a flight, told from where it is at an instant
        if (found := (flight := self.flights[i]).seen.get((age, self.bits))) is None:
            x, y, vx, vy = self.at(*flight[:4])
            if wait := age != flight.age and self.wait(flight.age, age):
                x, y = x + vx * wait, y + vy * wait
            if len(flight.seen) > 9 + 9_999 // self.n: flight.seen.clear()
            found = flight.seen[age, self.bits] = Flight(x, y, vx, vy, age, {})
        return found
    def at(self, *numbers): return [x.at(self.bits) for x in numbers]  # as the world has them now
    def of(self, form): return self.read(form).at(self.bits)
    def less(self, x, y): return x.at(self.bits) - y.at(self.bits)
    def wait(self, start, age): return self.less(self.times[age], self.times[start])
    def start(self, c): return max(self.flights[k].age for k in c if k < self.n)
    def fallen(self, age):  # how far the frame has fallen in which flights are straight; how fast
        time = self.times[age].at(self.bits)
        pull = [x * time for x in self.at(*self.pull)]  # half of what pulls, times the time
        return [x * time for x in pull] + [x + x for x in pull]
    def drops(self, c):  # whether one falls and the other stands, and so their gap is a quartic
        one = c[1] < self.n and (c[0] in self.pegs) != (c[1] in self.pegs)
        return self.pull and (one or not 0 <= c[1] < self.bows)
    def true(self, i, age):  # where a circle is, and its velocity, in the frame of the scene
        row, falls = self.put(i, age)[:4], self.pull and i not in self.pegs
        return [*map(operator.add, row, self.fallen(age))] if falls else row
    def meeting(self, c, age):  # of two at an instant
        (i, j), (x, y, vx, vy, *_) = c, self.put(c[0], age)
        if j < self.n:
            (u, v, p, q, *_), (r, s) = self.put(j, age), self.at(*(self.things[k][4] for k in c))
            d, reach, kind = (u - x, v - y), s if j < 0 else r + s, Nearing
            speeds = p - vx, q - vy
            if falls := self.drops(c):
                x, y, p, q = self.fallen(age)
                bend, kind = self.at(*self.pull), Ringing if j < 0 else Dropping
                if i not in self.pegs: x, y, p, q, *bend = (-z for z in (x, y, p, q, *bend))
                d, speeds = (d[0] + x, d[1] + y), (speeds[0] + p, speeds[1] + q)
            m = kind(d, speeds, reach, {i: (-d[0], -d[1]), j: d})
            if falls: m.bend = bend
            return m
        u, v, p, q, size, more, r, none = self.at(*self.things[j], self.things[i][4], self.none)
        if j >= self.bows:
            if self.pull: x, y, vx, vy = map(operator.add, (x, y, vx, vy), self.fallen(age))
            d, within, kind = (u - x, v - y), (j - self.bows) % 2, Arching if self.pull else Bowing
            arms = {i: d if within else (-d[0], -d[1])}
            m = kind(d, (-vx, -vy), size - r if within else size + r, arms)
            m.hollow, m.bow, m.bend = within, (p, q, size, more), [-z for z in self.at(*self.pull)]
            return m
        d = (p, q) if self.sides[c] > 0 else (-p, -q)
        x, y, time = x - u, y - v, self.times[age].at(self.bits)
        if falls := self.pull and i not in self.pegs:
            p, q, u, v = self.fallen(age)
            x, y, vx, vy = x + p, y + q, vx + u, vy + v
        if j in self.drift:
            p, q = self.at(*self.drift[j])
            x, y, vx, vy = x - p * time, y - q * time, vx - p, vy - q
        (wall := Facing(d, (vx, vy), none, {i: d})).place = x, y
        gap = wall.height - (r + more) * size
        wall.gap, wall.speed, wall.disc = gap + gap, none, wall.closing * wall.closing
        wall.pull = p, q = self.at(*self.pull) if falls else (none, none)
        if falls:
            wall.hollow = self.slopes.get(j) == -1
            wall.speed = d[0] * (p + p) + d[1] * (q + q)
            wall.disc = wall.disc - wall.speed * wall.gap
        return wall
    def hit(self, c, again, near):  # when the gap of two falls through zero, perhaps from zero
        if self.read is Sum: return UNTOLD
        if self.drops(c): return self.drop(c, again, near)
        m = self.meeting(c, start := self.start(c))
        return self.times[start].at(self.bits) + m.wait(again)
    def drop(self, c, again, near):  # the same, of a fixed one: where a decimal says
        start, order = again or (self.start(c), 0)
        charge(9_000 + len(near) * (len(near) + self.bits >> 5))
        one, at = whole(10 ** len(near.partition(".")[2])), whole(int(near.replace(".", "")))
        low, high = (((at + side) / one).at(self.bits) for side in (whole(-1), whole(1)))
        first = self.times[start].at(self.bits)
        return first + falling(self.meeting(c, start).row[order:], low - first, high - first)
    def solve(self, rows):  # the x with G x = y, by elimination; a row is one of G, and then of y
        for k in range(len(rows)):  # all rows lose their first number
            top = [x / rows[k][0] for x in rows[k][1:]]
            rows = [top if row is rows[k] else
                    [x - row[0] * t for x, t in zip(row[1:], top, strict=True)] for row in rows]
        return [y for y, in rows]
    def blow(self, age, push, coming, s):  # a round with impulses s, if untold G s = -(1 + e) u
        met, _ = {c: self.meeting(c, age) for c in coming}, charge(2_000 * len(push) ** 2)
        loss = self.loss.at(self.bits)
        self.before = {c: m.closing * loss for c, m in met.items()}
        def effect(a, b):  # an entry of G
            both = ((self.things[i][5].at(self.bits), *a[i], *b[i]) for i in a if i in b)
            return sum(((x * p + y * q) * w for w, x, y, p, q in both), self.none.at(self.bits))
        if s or self.read is Sum: s = [*map(self.of, s)] or [UNTOLD] * len(push)
        else: s = self.solve([[*(effect(met[c].arms, met[o].arms) for o in push),
                               -(met[c].closing + self.before[c])] for c in push])
        for c, j in zip(push, s, strict=True):
            flown = met[c].arms.keys() - self.fixed  # those have one flight from time 0 on
            for i, (x, y) in ((i, met[c].arms[i]) for i in flown):
                (u, v, vx, vy, *_), w = self.put(i, age), self.things[i][5].at(self.bits) * j
                self.flights[i] = Flight(u, v, vx + w * x, vy + w * y, age, {})
        return s
    def bounce(self, c, age):  # from now on, without a speed across the wall: what is kept of that
        m, (x, y, vx, vy, *_) = self.meeting(c, age), self.put(c[0], age)
        q, (p, r) = UNTOLD, m.arms[c[0]]
        if self.read is not Sum: q = m.closing / (p * p + r * r)
        self.flights[c[0]] = Flight(x, y, vx - q * p, vy - q * r, age, {})
        fall = m.speed * self.lost.at(self.bits)
        self.bounces[c[0]] = m.closing + m.closing, fall, self.times[age]
    def rest(self, i, age=None):  # when its bounces have come to their end; or what shows that
        rise, fall, start = self.at(*self.bounces[i])
        if age is None: return UNTOLD if self.read is Sum else start - rise / fall
        return rise + fall * self.less(self.times[age], start)
    def ask(self, question, c, age):  # the number that a witness may show to be zero
        if question in self.limits: return self.less(self.limits[question], self.times[age])
        if question == "rest": return self.rest(c[0], age)
        if question == "slack": return self.before[c] + self.meeting(c, age).closing  # e u + u'
        return getattr(self.meeting(c, age), question)
    def turn(self, circles, age):  # their velocities are reversed
        for i, (x, y, vx, vy, *_) in [(i, self.put(i, age)) for i in circles]:
            if self.pull:  # -v is -V - 2 g t of V = v - g t
                *_, u, v = self.fallen(age)
                vx, vy = vx + (u + u), vy + (v + v)
            self.flights[i] = Flight(x, y, -vx, -vy, age, {})
    def stand(self, i, age, known):  # from now on in the frame of the scene, with what is known
        row = [self.of(known[k]) if k in known else x for k, x in enumerate(self.true(i, age))]
        self.flights[i], _ = Flight(*row, age, {}), self.pegs.add(i)
    def lift(self, i, age):  # it falls from now on
        row = map(operator.sub, self.put(i, age)[:4], self.fallen(age))
        self.flights[i], *_ = Flight(*row, age, {}), self.pegs.remove(i), self.bounces.pop(i, None)
def ends_of(segments, arcs):  # as circles; those at one place that move alike are the largest one
    found = {}
    rows = [(x, y, u, v, r, *way) for x, y, u, v, _, r, *way in segments]
    for x, y, u, v, r, *way in rows + [(*row[3:], NONE, NONE, NONE) for row in arcs if row[3:]]:
        for place in (x, y), (u, v):
            key = tuple(frozenset(z.items()) for z in (*place, *way))
            sign = sign_of(r - found[key][4]) if key in found else 1
            demand(sign, [-1, 0, 1], "which of two ends at one place is the larger")
            if sign == 1: found[key] = [*place, *way, r, NONE]
    return [*found.values()]
class KeptApart:  # how a checker proves that two kept apart on their flights
    def points(self, i, j): return not (self.things[i][4] or self.things[j][4])
    def other(self, c):  # with the other face of the segment, or the other side of the arc
        k = (self.arcs if c[1] in self.arcs else self.faces).start % 2
        return c[0], ((c[1] - k) ^ 1) + k
    def hollow(self, c):  # whether a gap of an arc or a face is concave: from within, or pulled to
        return (c[1] in self.arcs and (c[1] - self.arcs.start) % 2) or self.slope(c) == -1
    def slope(self, c): return 0 if c[0] in self.carried else self.slopes.get(c[1], 0)
    def drops(self, c): return self.ball.drops(c)
    def within(self, c): return all(self.sign(x, c) > 0 for x in RANGE)  # now
    def slides(self, c, start, age, gap, last):  # along a face, if it is on the line
        signs = {self.ball.ask(x, c, age).sign() for x in RANGE if not last}
        if gap or last or signs & {-1, 0}: return  # it is not beside it as its flight ends
        if any(self.zero(x, c, age) for x in RANGE): return
        inside = signs == {1} and (gap == 0 or self.zero("gap", c, start))
        demand(0 if inside else None, [1], f"{c} touch as the flight ends")
    def outside(self, c):  # at time 0: proves that a circle is not in a segment, seen from a face
        gap, height, foot, far = (self.ball.ask(x, c, 0).sign() for x in ("gap", "height", *RANGE))
        if gap == 1 or height == -1 or {foot, far} & {-1, 0}: return
        if any(self.zero(x, c, 0) for x in RANGE): return
        inside = gap in (-1, 0) and foot == far == 1 and height in (0, 1)
        refuse(inside, f"{c}: it starts in a segment")
        raise Unsettled(f"whether {c[0]} starts in a segment")
    def look(self, world, c, at, turn, span):  # the gap's sign; whether it stays positive; falls
        charge(9_000)
        m = world.meeting(c, at)
        closing = m.closing if turn > 0 else -m.closing
        gap, rise, disc = m.gap.sign(), closing.sign(), m.disc.sign()
        safe = rise in (0, 1) or disc == -1
        if gap == 1 and not safe and span[1:]:  # the tangent
            safe = (m.gap + (closing + closing) * world.wait(*span)).sign() == 1
        return gap, safe, rise == -1 and disc == 1
    def clear(self, c, age=None, last=False):  # proves that two do not meet on their flights
        if self.falls(c): return self.rises(c, age)
        if self.drops(c): return self.flies(c, age)
        slides = self.pull and c[1] in self.faces and not self.slope(c)  # and then comes back
        if c in self.parted and not (self.hollow(c) or slides): return charge(500)
        if c[1] >= self.faces.start: return self.misses(c, age, last)
        span = [start := self.ball.start(c)] + [age] * (age is not None)
        for world in (self.few, self.ball):
            gaps, meet = [], True
            for turn, at in zip((1, -1), span, strict=False):
                gap, safe, falls = self.look(world, c, at, turn, span)
                gaps, meet = [*gaps, gap], meet and falls
                if (gaps == [-1] and c[1] < 0) or (safe and {*gaps} == {1}): return
        refuse(gaps[0] == 0 or (gaps[0] and (meet or -1 in gaps)), f"{c} meet before it or overlap")
        shown = ("closing", "disc")[:1 if 0 <= c[1] < self.n and self.points(*c) else 2]
        for x in shown if gaps[0] == 1 and (last or gaps[-1] == 1) else ():
            if self.zero(x, c, start): return
        raise Unsettled(f"whether {c} meet before it")
    def again(self, c):  # since when, and of what order, a gap was zero that comes to zero again
        return (self.falls(c) or self.hollow(c) or self.drops(c)) and self.parted.get(c)
    def flies(self, c, age, ends=0):  # as `clear`, of one that falls and what stands: the gap is
        start, order = self.again(c) or (self.ball.start(c), 0)  # positive but for zeros at the
        if start == age and age: return charge(500)  # start, and at the end, that are known; of a
        # rim, or a side of an arc, it falls to no other zero; of a point both sides have the same
        twin = c[1] in self.arcs and not self.things[c[0]][4] and self.other(c)
        if self.parted.get(twin, (-1,))[0] == start: order = self.parted[twin][1]
        if twin in self.met: ends = 2 - abs(self.met[twin])
        for world in (self.few, self.ball):
            row = (m := world.meeting(c, start)).row[order:]
            wait = None if age is None else world.wait(start, age)
            for _ in range(ends): row = divided(row, wait)
            tops = row[:c in self.parted and c[1] >= 0]  # it leaves; and a graze is from outside
            if c in self.met and ends == 2: tops += [value(row, wait)]
            if (signs := {keeps(wait, *m.tests(row)), *(x.sign() for x in tops)}) == {1}: return
        demand(None if signs <= {None, 1} else 0, [1], f"{c} meet before it, or overlap")
    def falls(self, c): return self.bends.get(c, 0) < 0 and c[0] not in self.carried  # to a wall
    def rises(self, c, age):  # as `clear`, of a wall to which a circle is pulled
        refuse(age is None, f"{c} meet in the end")
        if (start := self.ball.start(c)) == age: return charge(500)
        for world in (self.few, self.ball):
            if c in self.parted:  # the gap was zero: what is left of it over the time since
                m = world.meeting(c, start)
                gap = m.closing + m.closing + m.speed * world.wait(start, age)
            else: gap = world.ask("gap", c, age)
            if gap.sign() == 1: return
        demand(gap.sign(), [1], f"{c} meet before it, or overlap")
    def misses(self, c, age, last):  # as `clear`, of a side of an arc, or of a face where it falls
        other, start, hollow = self.other(c), self.ball.start(c), self.hollow(c)
        if start == age or other in self.parted or c in self.lasting: return charge(500)
        bow, again, flat = (x := c[1] in self.arcs), c in self.parted, not (x or self.slope(c))
        if hollow and bow and other in self.met: return charge(500)  # it was outside up to now
        for world in (self.few, self.ball):
            charge(30_000)
            m, later = world.meeting(c, start), age is not None and world.meeting(c, age)
            gap, closing, disc = (x.sign() for x in (m.gap, m.closing, m.disc))
            gap2, closing2 = (later.gap.sign(), later.closing.sign()) if later else (None, None)
            if disc == -1 and not again: return
            if hollow:  # the gap is concave: it falls later than now, or fell before the start
                if gap2 == 1 or closing2 == 1 or (gap == -1 and closing in (-1, 0)): return
            elif gap == -1 or closing == 1 or (closing == 0 and (gap == 1 or not flat)) or (
                    gap2 == 1 and (closing2 == -1 or (flat and gap == 1))): return  # convex
            hits = closing == 1 and m.speed.sign() == -1 if again else disc == 1
            if (there := m.there(m.wait(again)) if hits else None) in (-1, -bow): return
        if hollow and not again and self.aside(m, c, start) and self.zero("disc", c, start): return
        part = ("closing", "disc")[:2 if gap == 1 else not flat]  # it rises, or misses at best
        for x in part if not hollow and (last or gap2 == 1) else ():
            if self.zero(x, c, start): return
        if flat and gap != 1 and (closing == 0 or self.zero("closing", c, start)):
            return self.slides(c, start, age, gap, last)
        turns = not (hollow or flat or closing2) and later and self.zero("closing", c, age)
        ends = (closing2 == -1 or turns) and not (later.foot.sign() and later.far.sign())  # at one?
        if ends and self.zero("gap", c, age) and any(self.zero(x, c, age) for x in RANGE): return
        ahead = gap == 1 or closing == 1 if hollow else gap == 1 and closing == -1
        done = closing2 == -1 and gap2 in (-1, 0) if hollow else gap2 in (-1, 0) or closing2 == 1
        refuse(ahead and there == 1 and (age is None or done), f"{c} meet on the way")
        raise Unsettled(f"whether {c} meet on the way")
    def aside(self, m, c, t):  # whether a double zero is not at an end, where it leads in; or out
        if (not m.speed.sign() and self.zero("speed", c, t)) or m.there(m.once): return True
        return m.bow and m.beside(m.v, m.gap - m.gap).sign() == -1 and self.zero("closing", c, t)
    def across(self, c):  # at time 0: proves that a circle is not across an arc
        m, inner = self.ball.meeting(c, 0), self.other(c)
        sides = [x for x in (c, inner) if x in self.meets]
        met = self.met.keys() & {*sides}
        refuse(met and not self.things[c[0]][4], f"{c}: its centre is on the arc")
        gaps = {self.ball.ask("gap", x, 0).sign() for x in sides}
        if met or 1 in gaps: return
        square = m.d[0] * m.d[0] + m.d[1] * m.d[1]
        within = m.beside(m.d, square.sqrt()).sign() if square.sign() == 1 else None
        if within == -1: return
        if any(self.zero("foot", x, 0) and self.zero("gap", x, 0) for x in sides): return
        demand(None if None in gaps or within != 1 else 0, [1], f"{c} overlap at time 0")
class Checker(KeptApart):
    """Follows a certificate. On the flights of now `parted` was at gap zero, `lasting` stays so; of
    the way out, `out` is not undone; at an instant `met` is listed, `known` all, with its sign."""
    clock = property(lambda self: next(iter(self.met), None))
    def __init__(self, told, factor):  # takes up a certificate and its scene
        self.told, self.end, scene, maps = told, told["end"], told["scene"], told["isometries"]
        n, bits, self.policy = len(scene["circles"]), told["bits"], scene["tie_policy"]
        own, parts = scene.get("roots", []), [*told["instants"], self.end]
        refuse(len(roots := own + told["roots"]) > ROOTS, f"it has over {ROOTS} roots", Malformed)
        fits(told, shape(len(own), len(roots)))
        things = [thing for kind in THINGS for thing in scene.get(kind, ())]
        more = [*scene.get("segments", ()), *scene.get("arcs", ())]
        area = n * (len(things) + 3 * len(more))  # two faces or sides, and two ends
        ids = {thing["id"] for thing in things}
        hows = {zero[2] for part in parts for zero in part.get("zeros", ())} - {"back"}
        large = n > CIRCLES or area > PAIRS or bits > min(BITS, SIZE // area)
        timed = all({"met", "exact", "turn", "settle"} & x.keys() for x in told["instants"][1:])
        refuse(large, "it has too many circles, walls, pockets or bits", Malformed)
        refuse(len(ids) < len(things), "an id comes twice", Malformed)
        refuse(not (timed and told["instants"]), "no instant, or one without a time", Malformed)
        refuse({"reverse_at", "reverse_after"} <= scene.keys(), "it has two reversals", Malformed)
        refuse(len(told["final"]["circles"]) != n, "its end is of other circles", Malformed)
        refuse(hows - {*range(len(maps))}, "a witness names no isometry that there is", Malformed)
        self.digest = hashlib.sha256(dense(scene).encode()).hexdigest()
        Ball.bits, Sum.squares, Ball.roots, cost.room = bits * factor, [], [], 0
        charge(3_000 * area, 300 * area + 2 * len(things) * Ball.bits)
        for text in roots:
            demand(sign_of(x := number(text)), [1], "what has a root is not positive", Malformed)
            Sum.squares, Ball.roots = [*Sum.squares, x], [*Ball.roots, enclosed(x).sqrt()]
        def read(kind, row):  # of an arc without ends, which is all of its circle, three
            names = THINGS[kind].split()
            full = kind == "arcs" and not {*names[3:]} & row.keys()
            row = {"vx": "0", "vy": "0"} | row if kind in ("walls", "segments") else row
            return [number(row[name]) for name in names[:3 if full else None]]
        circles, walls, pockets, segments, arcs = (
            [read(kind, row) for row in scene.get(kind, ())] for kind in THINGS)
        loss, pull = number(scene.get("restitution", "1")), [*map(number, scene.get("gravity", ()))]
        pull = pull if any(pull) else []
        ways = [row[-2:] for row in walls + [row for row in segments for _ in range(2)]]
        drift = {k: way for k, way in enumerate(ways) if any(way)}
        stands = pull and (segments or arcs or pockets or not all(row[5] for row in circles))
        turns, settle = {"reverse_at", "reverse_after"} & scene.keys(), "settle" in scene
        refuse(turns and (drift or loss != ONE or stands), "what cannot turn back does", Malformed)
        refuse(settle and (not pull or drift or arcs or pockets or turns), "none settle", Malformed)
        for x in loss, ONE - loss: demand(sign_of(x), [0, 1], "no such restitution", Malformed)
        sides, circles = ((0, 1, 2, 3, 4, 5), (2, 3, 0, 1, 4, 5)), circles + ends_of(segments, arcs)
        faces = [[row[k] for k in side] for row, side in product(segments, sides)]
        lines = [[x, y, y - v, u - x, length, (*thick, NONE)[0]]
                 for x, y, u, v, length, *thick in [row[:5] for row in walls] + faces]
        first, n, level = n, len(circles), set()  # the first end, if there is one; what is level
        self.n, self.carried, self.faces = n, {}, range(n + len(walls), n + len(lines))
        self.pull, self.drift, self.bounced = pull, {n + k: v for k, v in drift.items()}, bool(loss)
        bows, sizes = [], [row[2] for row in arcs]
        for x, y, r, *ends in arcs:  # it lies beyond its chord: the normal of that, and how far
            ends = [z - o for z, o in zip(ends, (x, y, x, y), strict=False)]
            for p, q in (ends[:2], ends[2:]) if ends else ():
                demand(sign_of(p * p + q * q - r * r), [0], "an end is on its arc", Malformed)
            p, q = (ends[3] - ends[1], ends[0] - ends[2]) if ends else (NONE, NONE)
            edge = p * ends[0] + q * ends[1] if ends else -ONE
            if ends: demand(sign_of(p * p + q * q), [1], "an arc has one end", Malformed)
            bows += [[x, y, p, q, r, edge]] * 2
        self.arcs, self.slopes = range(n + len(lines), n + len(lines) + len(bows)), {}
        rims = [[x, y, NONE, NONE, r, NONE] for x, y, r in reversed(pockets)]
        self.things = dict(enumerate(circles + lines + bows)) | dict(enumerate(rims, -len(rims)))
        self.movable = {i for i, row in enumerate(circles) if row[5]}
        limits = {"reverse": number(scene["reverse_at"])} if "reverse_at" in scene else {}
        if self.end["reason"] == "horizon": limits["until"] = number(self.end["until"])
        for *_, p, q, z, _ in lines: demand(sign_of(p * p + q * q - z * z), [0], "size", Malformed)
        for *_, u, v, _, w in circles[:first]:
            refuse((u or v) and not w, "what is fixed moves", Malformed)
        sizes += [x for row in circles for x in row[4:] if x] + [row[4] for row in lines + rims]
        for x in (*sizes, *limits.values()): demand(sign_of(x), [1], "a size or a time", Malformed)
        self.meets = {(i, j) for i, j in product(range(n), self.things) if self.movable & {i, j}
                      and (not 0 <= j < n or (i < j and (j >= first or not self.points(i, j))))}
        def roomy(c):  # whether a side is wide enough
            room = sign_of(self.things[c[1]][4] - self.things[c[0]][4]) if self.hollow(c) else 1
            return demand(room, [-1, 0, 1], f"whether {c} fit") == 1
        self.meets = {c for c in self.meets if roomy(c)}
        self.of = collections.defaultdict(list)  # the contacts of each
        for c, i in ((d, i) for d in self.meets for i in d): self.of[i].append(c)
        sides = {(i, k): sign_of(p * (circles[i][0] - x) + q * (circles[i][1] - y))
                 for i in self.movable for k, (x, y, p, q, *_) in enumerate(lines[:len(walls)], n)}
        for c, sign in sides.items(): demand(sign, [1, -1], f"the centre of {c} is on the wall")
        self.bends = {c: 0 for c in sides if pull or c[1] in self.drift}  # signs of their speeds
        for j in range(n, self.arcs.start) if pull else ():
            p, q = self.things[j][2:4]
            sign = sign_of(p * pull[0] + q * pull[1])
            self.slopes[j] = demand(sign, [-1, 0, 1], f"whether gravity pulls to {j}")
            leans = sign_of(q * pull[0] - p * pull[1]) if settle else 1
            if not demand(leans, [-1, 0, 1], f"whether {j} is level"): level.add(j)
        for c in self.bends if pull else (): self.bends[c] = sides[c] * self.slopes[c[1]]
        self.bears = {c for c in self.meets if c[1] in level  # what can carry what it pulls
                      and self.bends.get(c, self.slopes.get(c[1])) < 0}
        for j in range(n, self.faces.start): self.slopes.pop(j, None)  # of faces alone from now on
        sides |= dict.fromkeys(product(self.movable, self.faces), 1)  # met from their left alone
        self.laws = loss, [x * HALF for x in pull], self.drift, n + len(lines), self.slopes
        self.worlds = [Space(n, self.things, sides, limits, self.laws, f) for f in (enclosed, Sum)]
        self.ball, self.form = self.worlds
        self.few, self.few.bits = copy.copy(self.ball), min(FEW, Ball.bits)
        self.isometries, self.out, self.parted = [self.isometry(g) for g in maps], [], {}
        self.age, self.count, self.known, self.lasting, self.due, self.way = -1, 0, {}, {}, 0, 0
        self.last = self.end["limit"] if self.end["reason"] == "events" else None
        self.draw = "seed" in self.policy and random.Random(int(self.policy[16:])).randrange
    def isometry(self, told):  # its linear part, its map, as the data have it, and whose flights
        (a, b, d, e), (p, q) = ([number(text) for text in told[key]] for key in ("matrix", "shift"))
        images, zeros = dict(told["map"]), [a * a + d * d - ONE, b * b + e * e - ONE, a * b + d * e]
        u, v = self.pull or (NONE, NONE)  # kept where something fixed is mapped
        falls = [a * u + b * v - u, d * u + e * v - v]
        for i, j in images.items():
            (x, y, vx, vy, *k), (u, v, wx, wy, *m) = self.things[i], self.things[j]
            x, y = a * x + b * y + p - u, d * x + e * y + q - v
            along, by = a * vy - b * vx, d * vy - e * vx  # the image of the way along a face
            vx, vy = a * vx + b * vy, d * vx + e * vy
            zeros += [ONE] * ((i < 0, i < self.n) != (j < 0, j < self.n))
            (s, t), (g, h) = (self.drift.get(k, (NONE, NONE)) for k in (i, j))
            stays = [a * s + b * t - g, d * s + e * t - h]
            bow, to = (k in self.arcs and 1 + (k - self.arcs.start) % 2 for k in (i, j))
            zeros += [ONE] * (bow != to)  # a side of an arc to the same side of another
            if i in self.faces or j in self.faces:  # its normal, its middle, its thickness
                zeros += [ONE] * (i not in self.faces or j not in self.faces)
                zeros += [vx - wx, vy - wy, x + x + along - wy, y + y + by + wx, k[1] - m[1]]
                zeros += falls + stays
            elif i >= self.n and not bow:
                zeros += [vx * wy - vy * wx, *(s * wx + t * wy for s, t in ((x, y), stays, falls))]
            else: zeros += [x, y, vx - wx, vy - wy, *(r - s for r, s in zip(k, m, strict=False))]
            zeros += falls if bow or i < 0 or i in self.ball.fixed else []
        refuse(len({*images.values()}) < len(told["map"]), "an isometry maps two to one")
        for x in zeros: demand(sign_of(x), [0], "an isometry maps otherwise")
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
            back = question == "gap" or (question == "until" and self.end["reason"] == "return")
            slides = other in self.met and other[1] in self.faces and not self.met[other]
            back = back and self.way and self.out and not slides
            return back and other in self.met and {c, other} <= self.out[-1][1]
        (a, b, d, e), images, _ = g = self.isometries[how]
        kept, first = self.mapped(g), question == "closing" and not self.rows
        if question == "rest": return self.image(images, c) in self.calm and i in kept
        alike = other in self.met and self.image(images, c) == other
        if alike and (question == "gap" or first > abs(self.met[other])):
            return all(k in kept for k in c if 0 <= k < self.n)
        steered = self.pull or j in self.drift  # the gap is not as of what rests
        if self.n <= j < self.arcs.start and question == "closing" and not steered:
            nx, ny = self.things[j][2:4]
            return images.get(i) == i in kept and not (a * nx + b * ny + nx or d * nx + e * ny + ny)
        unturned = question in ("closing", "speed") and not any((a - ONE, b, d, e - ONE))
        return unturned and any(images.get(k) == m and k in kept for k, m in ((i, j), (j, i)))
    def zero(self, name, c, age):  # whether a number is zero, as a form or by a witness
        charge(300 * len(self.zeros))
        hows = (how for asked, d, *how in self.zeros if (asked, tuple(d)) == (name, c))
        return not self.form.ask(name, c, age) or any(self.proves(name, c, *how) for how in hows)
    def sign(self, question, c):  # the sign of a number
        if (sign := self.ball.ask(question, c, self.age).sign()) is not None: return sign
        if self.zero(question, c, self.age): return 0
        raise Unsettled(f"{c}: nothing shows that {question!r} is zero, or what sign it has")
    def take(self, entry, where):  # takes up an entry
        Checker.where, self.zeros, self.met, self.rows = where, entry.get("zeros", ()), {}, {}
        self.calm = set()  # what has bounced up to now
    def instant(self, entry):  # its time; what meets at it, or the reversal; what follows
        self.age, turn, met = self.age + 1, "turn" in entry, [*map(tuple, entry.get("met", ()))]
        age, told = self.age, [number(text) for key, text in entry.items() if key == "exact"]
        charge(30_000 + 5_000 * (self.n + len(self.isometries)) + 1_000 * len(self.parted),
               Ball.bits // 4 + 2_000 + 200 * (len(self.lasting) + len(met)))
        self.take(entry, f"instant {age}")
        refuse(self.due != turn or self.count == self.last, "the reversal, or the end, is due")
        refuse(told and (turn or not age), "it has a time already")
        refuse(len({*met} & self.meets) < len(met) * (1 + turn), f"{met} cannot meet")
        calm = sorted({i for i, _ in entry.get("settle", ()) if i in self.ball.bounces})
        for w in self.worlds if age else ():
            w.times.append(w.times[-1] if turn else w.of(told[0]) if told
                           else w.hit(met[0], self.again(met[0]), entry["time"]) if met
                           else w.rest(calm[0]))
        self.said(self.ball.times[age], entry["time"])
        if age and not turn: demand(self.ball.wait(age - 1, age).sign(), [1], "it comes no later")
        for c in met:
            if self.met or told or not age: refuse(self.sign("gap", c), f"{c} do not meet at it")
            face, self.met[c] = c[1] in self.faces, self.sign("closing", c)
            refuse(c[0] < c[1] < self.n and self.points(*c), f"{c} have no normal")
            ranged = face or c[1] in self.arcs
            refuse(ranged and not self.within(c), f"{c}: it is beside it, beyond an end")
            if self.drops(c):  # up to now they were apart
                refuse(age and self.met[c] > 0 <= c[1], f"{c}: it comes from behind")
                if age: self.flies(c, age, 2 - abs(self.met[c]))
                continue
            if not face:
                refuse(age and not self.met[c] and self.sign("speed", c) < 1, f"{c} stay so")
            if ranged:
                refuse(self.other(c) in self.parted, f"{c}: it is on the other side")
                if face and not age: refuse(self.sign("height", c) < 1, f"{c}: it is on the line")
                away = 0 if self.slope(c) == -1 else 1  # what rises to it, or from it
                refuse(age and self.met[c] >= away, f"{c}: it comes from behind")
            if age and self.met[c] > 0: self.clear(c, last=True)  # a rim is left from within
        for by in (self.carried[i] for i in calm):  # its bounces have come to their end
            if self.calm or met or told: refuse(self.sign("rest", by[0]) == 1, f"{by} bounces")
            self.calm |= {*by}
        for w, i in product(self.worlds, calm): del w.bounces[i]
        self.lasting = {c: 0 for c in self.lasting if c[1] not in self.faces or self.within(c)}
        turned, self.way = {c: -sign for c, sign in self.known.items()}, self.way or turn
        self.known = turned if turn else self.lasting | self.met
        for c in () if age else self.meets:
            if c[1] in self.arcs and not self.hollow(c): self.across(c)
            if c[1] in self.faces and c not in self.met: self.outside(c)
        for c in () if age else self.bends.keys() - self.met.keys():
            if self.falls(c): demand(self.ball.ask("gap", c, 0).sign(), [1], f"{c} overlap")
        if turn: self.settle(self.movable)
        for w in self.worlds if turn else ():
            w.turn(self.movable, age)
            w.limits.pop("reverse", None)
            if self.end["reason"] == "return": w.limits["until"] = w.times[age] + w.times[age]
        signs = {name: self.sign(name, self.clock) for name in self.ball.limits}
        refuse(-1 in signs.values(), "the end, or the reversal, comes before it")
        self.due = signs.get("reverse") == 0
        refuse(not (met or calm or turn or self.due or age == 0), "nothing falls on it")
        self.resolve([*entry.get("rounds", ())], entry, {*self.movable} if turn else set())
        self.due |= not self.way and 0 < self.count == self.told["scene"].get("reverse_after")
        sharp = (x.bits - x.r.bit_length() for i in self.movable for x in self.ball.flights[i][:4])
        bits = max(max(sharp, default=0) + KEEP, self.few.bits)
        if self.ball.bits - bits >= KEEP // 4: self.ball.bits = bits
    def settle(self, circles):  # proves that they have met nothing but what is known
        found = {c for i in circles - self.ball.fixed for c in self.of[i]} - self.known.keys()
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
                    coming = [coming[self.draw(len(coming)) if self.draw and coming[1:] else 0]]
                told, rounds = [*rounds, []][0], rounds[1:]
                push, s = [(i, j) for i, j, *_ in told], [number(x) for c in told for x in c[2:]]
                refuse(len({*push} & {*coming}) < len(push), f"{push} cannot push")
                balls, _ = (w.blow(self.age, push, coming, s) for w in self.worlds)
                moved |= (hit := self.movable & {i for c in push for i in c})
                for c in push if s else (): refuse(self.sign("slack", c), f"{c} push otherwise")
                for impulse in balls: demand(impulse.sign(), [1], f"{push} do not push, or may not")
                for c in {*coming} - {*push}: refuse(self.sign("slack", c) < 0, f"{c} push too")
                for rows, part in ((self.rows, coming), (pushes, push)):
                    for i in {i for c in part for i in c} & self.movable:
                        rows.setdefault(i, []).append({c for c in part if i in c})
                known |= {c: self.bounced if c in push else self.sign("closing", c)
                          for c in sorted(group) if hit & {*c}}
        enter = sorted(c for c in known if c[1] < 0 and known[c] < 0)
        refuse(rounds, "none push in a round")
        refuse(enter != sorted(map(tuple, entry.get("enter", ()))), f"{enter} enter")
        if taken := {i for i, _ in enter if self.told["scene"].get("capture")}:
            self.settle(taken)
            for w, i in product(self.worlds, taken): w.stand(i, self.age, {2: NONE, 3: NONE})
            self.meets = {c for c in self.meets if not taken & {*c}}
        self.known = known = {c: sign for c, sign in known.items() if c in self.meets}
        bounces = sorted(map(tuple, entry.get("bounces", ())))
        for _, by in groupby(bounces, operator.itemgetter(0)): self.bounce(*by, pushes)
        known |= dict.fromkeys(bounces, 0)
        flat = sorted(c for c in known if self.n <= c[1] < self.arcs.start and not known[c])
        charge(500 * len(flat) ** 2 * (settles := "settle" in self.told["scene"]))
        bears = {c[0]: (c,) for c in flat[::-1] if c in self.bears}
        for c, o in combinations(flat, 2) if settles else ():
            if c[0] not in bears and self.holds(c, o): bears[c[0]] = c, o
        begun = {c for by in bears.values() for c in by if c[0] not in self.carried}
        told, out = [*map(tuple, entry.get("settle", ()))], dict(bounces).keys()
        refuse(sorted(c for c in begun if c[0] in out) != bounces, f"not {begun} bounce")
        refuse(sorted(begun | self.calm) != sorted(told + bounces), f"{begun} settle")
        self.settle({i for i, _ in begun} - moved)
        moved |= {i for i, _ in begun}
        for w, i in product(self.worlds, self.carried.keys() - bears.keys()): w.lift(i, self.age)
        for i in moved & bears.keys():
            self.rows.setdefault(i, []).append({*bears[i]})
            for w in self.worlds: w.stand(i, self.age, self.along(i, *bears[i]))
        self.carried = bears
        self.lasting = {c: 0 for c in known if (c in self.lasting and not moved & {*c})
                        or not (known[c] or self.drops(c) or self.sign("speed", c))}
        self.parted = {c: since for c, since in self.parted.items() if not moved & {*c}}
        self.parted |= {c: (self.age, 2 if known[c] == 0 else 1) for c in known}
        self.isometries = [(*g[:2], self.mapped(g)) for g in self.isometries]
        if not self.way and (pushes or not self.age):
            self.out.append((pushes, {c for c in known if c[1] >= 0}))
        back = {i: rows[::-1] for i, rows in pushes.items()}
        if self.way and back: del self.out[-1 if [back] == [x for x, _ in self.out[-1:]] else 0:]
    def holds(self, c, o, *more):  # whether two surfaces hold what gravity pulls to between them
        if c[0] != o[0] or more or not self.pull: return False
        one, other = ([-z if self.ball.sides[d] < 0 else z for z in self.things[d[1]][2:4]]
                      for d in (c, o))
        turns = (one, other), (self.pull, one), (other, self.pull)
        signs = [sign_of(a[0] * b[1] - a[1] * b[0]) for a, b in turns]
        return {demand(x, [-1, 0, 1], f"whether {c, o} hold it") for x in signs} in ({1}, {-1})
    def bounce(self, c, *more):  # proves that it bounces out, and nothing comes near meanwhile
        i, (*others, pushes), w, ones = c[0], more, self.ball, {c, *more[:-1]}
        left = self.pull and i not in self.carried and {*map(self.known.get, ones)} == {1}
        refuse(not left, f"{c} does not leave, and come back")
        since = {self.parted.get(d, (d,))[0] for d in ones}  # both push it for the first time since
        refuse(others and (len(since) > 1 or pushes.get(i) != [ones]), f"{c} flies aslant")
        rows, own = [w.true(k, self.age) for k in range(self.n)], {o[1] for o in ones}
        for v in self.worlds: v.bounce(c, self.age)
        charge(30_000 * len(self.things) + 9 * w.bits * self.n)
        wait, one = w.less(w.rest(i), w.times[self.age]), whole(1).at(w.bits)
        light = {k: w.at(w.things[k][5])[0] for k in self.movable}  # none has more energy than all
        def square(x, y): return x * x + y * y
        def most(parts): return top(sum(parts, one - one))
        fall = top(square(*w.at(*w.pull))) * (wait + wait)
        swing = most(square(*rows[k][2:]) / x for k, x in light.items())
        swing = swing + fall * most(one / x for x in light.values())
        way = (top(square(*rows[i][2:])) + fall) * wait
        def beyond(k):  # whether more is between the two than they go
            m, size = w.meeting((i, k) if i < k else (k, i), self.age), w.at(w.things[k][4])[0]
            off = way + swing * top(light[k]) * wait if k in light else way
            if k < self.n: return (m.gap - off * (m.reach + m.reach + off)).sign() == 1
            aside = k in self.faces and -1 in {(x + way * size).sign() for x in (m.foot, m.far)}
            return aside or (m.gap - (way + way) * size).sign() == 1
        for k in {*range(self.arcs.start)} - own - {i}:
            sides = {k, self.other((i, k))[1]} if k in self.faces else {k}
            refuse(not (own & sides or any(map(beyond, sides))), f"whether {c} is alone", Unsettled)
    def along(self, i, by, *more):  # what is known of the flight of what is carried, by place
        *spot, p, q, _, thick = self.things[j := by[1]]
        known = dict.fromkeys((2, 3) if more or j in self.faces else (), NONE)
        refuse(known and not more and self.sign("slide", by), f"{by}: it slides, up to an end")
        reach = self.things[i][4] + thick
        for k in (k for k in (0, 1) if not (more or (q, p)[k])):  # the way up is along an axis
            down = demand(sign_of(self.pull[k]), [-1, 1], "which way is down")
            known |= {k: spot[k] + (reach if down < 0 else -reach), k + 2: NONE}
        return known
    def said(self, value, text):  # that a number is as its decimal says, to one unit of its end
        charge(5_000 + (len(text) ** 2 >> 5) + (len(text) * value.m.bit_length() >> 8))
        scale, at = 10 ** len(text.partition(".")[2]), int(text.replace(".", ""))
        off, wide = abs(value.m * scale - (at << value.bits)) - (1 << value.bits), value.r * scale
        demand(-1 if off + wide < 0 else None if off < wide else 1, [-1], f"a number: {text[:40]}")
    def check(self):  # instant by instant; then what ended the run, and the final state
        for entry in self.told["instants"]: self.instant(entry)
        self.take(self.end, "at the end")
        reason, limits = self.end["reason"], self.ball.limits
        refuse(self.last not in (None, self.count), f"there are {self.count} events")
        refuse((self.last is None and self.due) or (reason == "return" and not self.way), "no turn")
        if reason not in ("events", "stopped") and "reverse" in limits:
            sign = (limits["reverse"] - limits["until"]).sign() if "until" in limits else 0
            demand(sign, [1], "the reversal is first")
        for w in self.worlds if "until" in limits else (): w.times.append(w.limits["until"])
        self.age += "until" in limits
        for c in self.meets: self.clear(c, None if reason == "quiet" else self.age, last=True)
        for i in self.ball.bounces: refuse(self.sign("rest", self.carried[i][0]) > 0, f"{i} flies")
        self.said(self.ball.times[self.age], self.told["final"]["time"])
        for i, row in enumerate(self.told["final"]["circles"]):
            for x, text in zip(self.ball.true(i, self.age), row, strict=True): self.said(x, text)
        scene = self.told["scene"]
        kinds = [kind for kind in THINGS if kind in scene or kind not in ("segments", "arcs")]
        many = [f"{len(scene.get(kind, ()))} {kind}" for kind in kinds]
        events = f"{self.count} event{'s' * (self.count != 1)}, to the end: {reason}"
        return f"{events}; {', '.join(many)}; scene sha256:{self.digest}"
def judged(told, factor):  # the exit code for a certificate with so many times its bits; and words
    Checker.where = "in the scene"
    try: return 0, f"verified: {Checker(told, factor).check()}"
    except (Refuted, Unsettled, Declined) as x: return x.code, f"{x.word}: {Checker.where}: {x}"
def once(pairs):  # an object of JSON whose keys differ
    return refuse(len(dict(pairs)) < len(pairs), "a key comes twice", Malformed) or dict(pairs)
def integer(text):  # a number of JSON, which has to be whole
    return refuse(len(text) > 16, "a number of over 15 digits", Malformed) or int(text)
def verdict(path, work=None):  # the exit code for a file, and a sentence
    try:
        refuse(Path(path).exists() and not Path(path).is_file(), "it is no regular file", Malformed)
        with Path(path).open("rb") as file: return weighed(file.read(BYTES + 1), work)
    except MemoryError: return 4, "declined: there is too little memory"
    except OSError as error: return 2, f"no certificate: it cannot be read: {error.strerror}"
    except BROKEN as error: return 2, f"no certificate: {type(error).__name__}: {error}"
def weighed(text, work=None):  # the same of what is in it
    sys.set_int_max_str_digits(2 * DIGITS + 2)  # a decimal has two rows of digits
    try:
        refuse(len(text) > BYTES, f"it is longer than {BYTES} bytes", Malformed)
        cost.work, cost.most, cost.room = 0, work or WORK + EACH * len(text), 0
        cost.rooms = 1 << 60 if work else ROOM
        charge(0, PART * sum(text.count(x) for x in b",[{:"))
        numbers = dict.fromkeys(("parse_int", "parse_float", "parse_constant"), integer)
        told = json.loads(text.decode(), object_pairs_hook=once, **numbers)
        refuse(told["format"] != FORMAT, f"the format is not {FORMAT}", Malformed)
        code, sentence = judged(told, 1)
        for factor in (2, 4) if sentence.startswith(Unsettled.word) else ():
            more, what = judged(told, factor)
            if more != 4: return 4, f"{sentence}; with {factor * told['bits']} bits it is {what}"
        return code, sentence
    except (MemoryError, Declined) as x: return 4, f"declined: {x or 'there is too little memory'}"
    except BROKEN as error:
        return 2, f"no certificate: {type(error).__name__}: {' '.join(str(error).split())[:200]}"
if __name__ == "__main__":
    given = re.fullmatch(r"(?:--work=(\d{1,15}))?", sys.argv[2] if len(sys.argv) == 3 else "")
    code, said = 2, "no certificate: usage: verify.py FILE [--work=N]"
    if given and len(sys.argv) in (2, 3): code, said = verdict(sys.argv[1], int(given[1] or 0))
    sys.exit(print(said.encode("ascii", "backslashreplace").decode()) or code)
