"""Checks a certificate of a run of hard circles, walls and pockets with the standard library alone: verify.py FILE.

docs/certificates.md defines the format. There is no search and no queue: what is stated is proved again, or refused.

*Numbers.* The laws are written once, in `World`, and there are two worlds. In one, numbers are intervals (`Ball`): what
they say of a sign is true, or they say nothing. In the other they are exact (`Form`): sums of fractions times square
roots, which are only added and multiplied; times and impulses, which take more, are known there if the certificate
tells them, and then put in. A form without terms is zero, whatever the roots are. Intervals are read with few bits
first, in `clear`, and later on with no more than flights still know, and some: `Ball.at` rounds outward, too.

*Flights.* Between instants circles fly straight, and a gap, |d|^2 - R^2 of two circles or twice the distance from a
wall, is convex in time. When a flight ends, `clear` proves for all else that the gap has stayed positive while both
flew: by its tangent at the start or at the end, or as it has no zero. So nothing is missed. A contact listed has gap
zero: at the time that the quadratic formula gives, or that is told and put in. If the gap is not growing there it was
positive before, as it is convex; if it is, it is that of a pocket's rim, left from within. So nothing is invented.

*Impulses.* All that stands at gap zero and hangs together is signed, round by round, until nothing approaches.
`simultaneous`: the impulses s of those said to push solve G s = -2u, are positive, and leave each other contact that
approaches with 2u + G s >= 0; the velocities that follow are unique (Cottle, Pang, Stone, The Linear Complementarity
Problem, 3.1). `sequential`: one contact at a time, in the order that the scene or its seed says.

*Zeros.* A number is zero as a form, or by a witness. An isometry maps the flights of some circles to those of others:
first their data, compared as forms; then, instant by instant, their rows: of each circle, round by round, its contacts
that approach. As a contact is in the rows of both its circles, its k-th time in the one with its k-th in the other, the
rows tell what acts together, and what before what. Circles whose rows are not mapped are struck out, with all that they
hit. "back": on the way back of a reversed run the impulses so far undo those of the way out, last first; what was known
at the last instant not undone falls through gap zero at its mirror image only. docs/symmetry-and-ties.md proves both.
"""

import json, random, re, sys
from collections import defaultdict, namedtuple
from copy import copy
from fractions import Fraction
from functools import reduce
from itertools import product
from math import isqrt
from operator import mul, sub
from pathlib import Path

FORMAT, BYTES, CIRCLES, BITS, PAIRS, SIZE = "truebreak/certificate-2", 1 << 24, 1000, 1 << 20, 1 << 22, 1 << 30
DIGITS, ROOTS, WORK, FEW, KEEP = 100_000, 99, 1 << 40, 128, 256
TERM, COUNT, CONTACT = r"\d+(?:/0*[1-9]\d*)?(?:\*r[1-9]\d?)*", r"[1-9]\d{0,14}", r"\[\d{1,15},-?\d{1,15}\]"
NUMBER, DECIMAL, ANY = f'"[+-]?{TERM}([+-]{TERM})*"', r'"-?\d+(\.\d+)?"', '".*"'
POLICY, REASON = r'"(simultaneous|sequential(:order=scene|:seed=\d{1,18})?)"', '"(events|stopped|horizon|return|quiet)"'
THINGS = {"circles": "x y vx vy r w", "walls": "x0 y0 x1 y1 length", "pockets": "x y r"}
def each(item, times="*"): return rf"\[({item},?){times}\]"
ZEROS = each(rf'\["(gap|closing|disc|speed|slack|until|reverse)",{CONTACT},("back"|\d{{1,15}})(,{CONTACT})?\]')
ROUNDS, PAIR = each(each(CONTACT.replace(r"\]", rf"(,{NUMBER})?\]"), "+")), r"\[-?\d{1,15},-?\d{1,15}\]"
SHAPE = {  # of each part what there has to be, and how it is spelt; then what there may be
    "format": ANY, "writer": ANY, "bits": COUNT, "roots": each(NUMBER),
    "isometries": ({"matrix": each(NUMBER, "{4}"), "shift": each(NUMBER, "{2}"), "map": each(PAIR)}, {}),
    "instants": ({"time": DECIMAL}, {"met": each(CONTACT, "+"), "exact": NUMBER, "turn": "true", "rounds": ROUNDS,
                                     "enter": each(CONTACT), "zeros": ZEROS}),
    "end": ({"reason": REASON}, {"limit": COUNT, "until": NUMBER, "zeros": ZEROS}),
    "final": ({"time": DECIMAL, "circles": each(each(DECIMAL, "{4}"))}, {}),
    "scene": ({"tie_policy": POLICY}, {
        "capture": "true|false", "reverse_after": COUNT, "reverse_at": NUMBER, "name": ANY, "digest": ANY,
        **{kind: ({"id": ANY, **dict.fromkeys(keys.split(), NUMBER)}, {}) for kind, keys in THINGS.items()}})}, {}
Flight = namedtuple("Flight", "x y vx vy age")  # at (x, y) at the instant `age`
Meeting = namedtuple("Meeting", "gap closing speed disc arms")  # the gap at s later is gap + 2 closing s + speed s^2
class Malformed(Exception): """This is no certificate."""
class Refuted(Exception): code, word = 1, "refuted"
class Undecided(Exception): code, word = 4, "not decided"  # the intervals are too wide, or a witness is missing
BROKEN = Malformed, LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError, MemoryError
def positive(sign, text, fault=Refuted):  # goes on if a sign is 1
    if sign != 1: raise (Undecided if sign is None else fault)(text)
class Form(dict):
    """An exact number: a sum of terms {roots: factor}, a fraction times the square roots of these numbers. What takes a
    division or a root, and is not told, is `UNTOLD`: a term that is not a number, and stays so."""
    squares, work = [], 0  # of the roots, in terms of those before
    def __neg__(self): return Form((k, -x) for k, x in self.items())
    def __sub__(self, o): return self + -o
    def __add__(self, o): return Form((k, x) for k in {**self, **o} if (x := self.get(k, 0) + o.get(k, 0)))
    def __mul__(self, o):
        parts = defaultdict(lambda: defaultdict(int))  # by the roots that both have, whose squares are told
        for (j, x), (k, y) in product(self.items(), o.items()):
            if j is None or k is None: return UNTOLD
            Form.work += 160_000 + (size(x) * size(y) >> 4)  # dearer than those of intervals
            if Form.work > WORK: raise Undecided("it takes too much work")
            parts[j & k][j ^ k] += x * y
        return sum((reduce(mul, (Form.squares[n] for n in ks), Form((k, x) for k, x in part.items() if x))
                    for ks, part in parts.items()), NONE)
    def sqrt(self, _=None): return UNTOLD
    def at(self, _): return self
    __truediv__ = sqrt
class Ball:
    """The reals within r of m, in units of 2**-bits. What is computed of two has the same bits."""
    bits, roots = 0, []  # those of the certificate
    def __init__(self, m, r, bits): self.m, self.r, self.bits = m, r, bits
    def __neg__(self): return Ball(-self.m, self.r, self.bits)
    def __add__(self, o): return Ball(self.m + o.m, self.r + o.r, self.bits)
    def __sub__(self, o): return Ball(self.m - o.m, self.r + o.r, self.bits)
    def __mul__(self, o):
        Form.work += 1_000 + (self.bits * self.bits >> 12)  # about a nanosecond a unit
        if Form.work > WORK: raise Undecided("it takes too much work")
        m, wide = self.m * o.m, abs(self.m) * o.r + abs(o.m) * self.r + self.r * o.r
        return Ball(m >> self.bits, (wide >> self.bits) + 2 if m or wide else 0, self.bits)
    def __truediv__(self, o):
        if (least := abs(o.m) - o.r) <= 0: raise Undecided("a number that may be zero divides")
        m = (self.m << self.bits) // o.m
        return Ball(m, ((self.r << self.bits) + (abs(m) + 1) * o.r) // least + 2, self.bits)
    def sqrt(self):
        if self.m <= self.r: raise Undecided("a number that may not be positive has a root")
        low, high = (isqrt(self.m + r << self.bits) for r in (-self.r, self.r))
        return Ball(low + high >> 1, (high - low >> 1) + 2, self.bits)
    def at(self, bits):  # with fewer bits
        if (drop := self.bits - bits) <= 0: return self
        return Ball(self.m >> drop, (self.r >> drop) + 2 if self.m or self.r else 0, bits)
    def sign(self): return 1 if self.m > self.r else -1 if self.m < -self.r else None if self.r else 0
def enclosed(form):  # as a ball
    parts = ((reduce(mul, (Ball.roots[n] for n in k), Ball(1 << Ball.bits, 0, Ball.bits)), x) for k, x in form.items())
    return sum((Ball(b.m * x.numerator // x.denominator, b.r * abs(x.numerator) // x.denominator + 2, b.bits)
                for b, x in parts), Ball(0, 0, Ball.bits))
NONE, ONE, UNTOLD = Form(), Form({frozenset(): Fraction(1)}), Form({None: float("nan")})
def size(x): return x.numerator.bit_length() + x.denominator.bit_length()
def number(text):  # reads a sum of terms such as 3/4*r1*r2
    terms = (found.split("*r") for found in re.findall(f"[+-]?{TERM}", text))
    def root(k): return Form({frozenset({int(k) - 1} if Form.squares[int(k) - 1] else {}): Fraction(1)})
    return sum((reduce(mul, map(root, ks), Form({frozenset(): Fraction(x)})) for x, *ks in terms), NONE)
class World:
    """The laws of flight, meeting and impulse, in numbers of one kind. Circles fly, and pockets, which rest: pocket k
    is number -1 - k. A contact (i, j) is of two circles if 0 <= j < n, of wall j - n, or of the rim of a pocket."""
    def __init__(self, n, things, sides, limits, of):
        self.n, self.sides, self.read, self.none, self.bits = n, sides, of, of(NONE), Ball.bits
        self.things = {k: [*map(of, row)] for k, row in things.items()}
        self.flights = {k: Flight(*row[:4], 0) for k, row in self.things.items() if k < n}
        self.times, self.limits = [self.none], {key: of(x) for key, x in limits.items()}
    def put(self, i, age):  # a flight, told from where it is at an instant
        (x, y, vx, vy), start = self.at(*self.flights[i][:4]), self.flights[i].age
        if age != start: x, y = (q + v * self.wait(start, age) for q, v in ((x, vx), (y, vy)))
        return Flight(x, y, vx, vy, age)
    def at(self, *numbers): return [x.at(self.bits) for x in numbers]  # as the world has them now
    def of(self, form): return self.read(form).at(self.bits)
    def wait(self, start, age): return sub(*self.at(self.times[age], self.times[start]))
    def start(self, c): return max(self.flights[k].age for k in c if k < self.n)
    def meeting(self, c, age):  # of two at an instant; `arms` are the directions in which they are pushed
        (i, j), (x, y, vx, vy, _) = c, self.put(c[0], age)
        if j >= self.n:
            u, v, p, q, length, r, none = self.at(*self.things[j], self.things[i][4], self.none)
            nx, ny = (p, q) if self.sides[c] > 0 else (-p, -q)
            gap, closing = nx * (x - u) + ny * (y - v) - r * length, nx * vx + ny * vy
            return Meeting(gap + gap, closing, none, closing * closing, {i: (nx, ny)})
        u, v, p, q, _ = self.put(j, age)
        x, y, vx, vy = u - x, v - y, p - vx, q - vy
        reach, = self.at(self.things[j][4] if j < 0 else self.things[i][4] + self.things[j][4])
        square, speed, cross = reach * reach, vx * vx + vy * vy, x * vy - y * vx  # disc without cancellation: Lagrange
        gap, disc = x * x + y * y - square, speed * square - cross * cross
        return Meeting(gap, x * vx + y * vy, speed, disc, {i: (-x, -y), j: (x, y)})
    def hit(self, c):  # when the gap of two falls through zero
        m = self.meeting(c, start := self.start(c))
        return self.times[start].at(self.bits) + m.gap / (m.disc.sqrt() - m.closing)
    def solve(self, rows):  # the x with G x = y, by elimination; each row is one of G, and then of y
        if not rows: return []
        (pivot, *top), *rest = rows
        rest = [[x - f * y for f in [row[0] / pivot] for x, y in zip(row[1:], top, strict=True)] for row in rest]
        low = self.solve(rest)
        return [sum((-(g * x) for g, x in zip(top[:-1], low, strict=True)), top[-1]) / pivot, *low]
    def blow(self, age, push, others, s):  # a round with impulses s, where untold by G s = -2u; `rest` is 2u + G s
        met = {c: self.meeting(c, age) for c in (*push, *others)}
        twice = {c: m.closing + m.closing for c, m in met.items()}
        def effect(c, o):  # an entry of G
            both = [(self.things[i][5], *met[c].arms[i], *met[o].arms[i]) for i in met[c].arms if i in met[o].arms]
            return sum(((x * p + y * q) * w.at(self.bits) for w, x, y, p, q in both), self.none.at(self.bits))
        s = [*map(self.of, s)] or self.solve([[*(effect(c, o) for o in push), -twice[c]] for c in push])
        self.rest = {c: sum((effect(c, o) * j for o, j in zip(push, s, strict=True)), twice[c]) for c in met}
        for c, j in zip(push, s, strict=True):
            for i, (x, y) in met[c].arms.items():
                (u, v, vx, vy, _), w = self.put(i, age), self.things[i][5].at(self.bits)
                self.flights[i] = Flight(u, v, vx + w * j * x, vy + w * j * y, age)
        return s
    def redirect(self, circles, age, factor):  # their velocities times a factor
        for i, (x, y, vx, vy, _) in [(i, self.put(i, age)) for i in circles]:
            self.flights[i] = Flight(x, y, vx * self.of(factor), vy * self.of(factor), age)

class Checker:
    """Follows a certificate. Of the flights of now it keeps `parted`, contacts at gap zero that do not meet on them
    again, and `lasting`, those that stay at gap zero; `out`, the instants of the way out with impulses, if not undone;
    of an instant `met`, contacts listed, and `known`, all at gap zero, with the signs of closing, and all blows."""
    def __init__(self, told, factor):  # takes up a certificate and its scene
        if not isinstance(told, dict) or told.get("format") != FORMAT: raise Malformed(f"the format is not {FORMAT}")
        self.told, self.end, scene = told, told["end"], told["scene"]
        self.n, bits, self.policy = (n := len(scene["circles"])), told["bits"], scene["tie_policy"]
        fits(told, SHAPE)
        self.last, self.due, self.way = self.end["limit"] if self.end["reason"] == "events" else None, False, False
        things, final = [thing for kind in THINGS for thing in scene.get(kind, ())], told["final"]["circles"]
        if n > CIRCLES or (area := n * len(things)) > PAIRS or bits > min(BITS, SIZE // area) or told["roots"][ROOTS:]:
            raise Malformed("it has no circle, or too many circles, walls, pockets, roots or bits")
        twice = len({thing["id"] for thing in things}) < len(things) or {"reverse_at", "reverse_after"} <= scene.keys()
        if twice or len(final) != n or not told["instants"]: raise Malformed("an id, reversal or state too many or few")
        Ball.bits, Form.squares, Ball.roots = bits * factor, [], []
        for text in told["roots"]:
            Form.squares.append(number(text))
            positive((square := enclosed(Form.squares[-1])).sign(), "what has a root is not positive", Malformed)
            Ball.roots.append(square.sqrt())
        circles, walls, pockets = ([[number(thing[key]) for key in keys.split()] for thing in scene.get(kind, ())]
                                   for kind, keys in THINGS.items())
        lines = [[x, y, y - v, u - x, length] for x, y, u, v, length in walls]
        rims = [[x, y, NONE, NONE, r, NONE] for x, y, r in reversed(pockets)]
        self.things = dict(enumerate(circles + lines)) | dict(enumerate(rims, -len(rims)))
        self.movable = {i for i, row in enumerate(circles) if row[5]}
        ends = {"reverse": scene.get("reverse_at"), "until": self.end["reason"] == "horizon" and self.end["until"]}
        limits = {name: number(text) for name, text in ends.items() if text}
        if any(p * p + q * q != r * r for *_, p, q, r in lines): raise Malformed("a wall's length differs")
        if any((vx or vy) and not w for _, _, vx, vy, _, w in circles): raise Malformed("a fixed circle moves")
        sizes = [x for row in circles for x in row[4:] if x] + [row[4] for row in lines + rims]
        for x in (*sizes, *limits.values()): positive(enclosed(x).sign(), "a size or time is not positive", Malformed)
        pairs = ((i, j) for j in range(n) for i in range(j) if circles[i][4] or circles[j][4])
        self.meets = {c for c in (*pairs, *product(self.movable, self.things.keys() - range(n))) if self.movable & {*c}}
        sides = {(i, k): enclosed(p * (circles[i][0] - x) + q * (circles[i][1] - y)).sign()
                 for i in self.movable for k, (x, y, p, q, _) in enumerate(lines, n)}
        for c, sign in sides.items(): positive(sign and sign * sign, f"the centre of {c} is on the wall, or may be")
        self.draw = random.Random(int(self.policy[16:])) if ":seed=" in self.policy else None
        self.worlds = self.ball, self.form = [World(n, self.things, sides, limits, of) for of in (enclosed, Form)]
        self.few, self.few.bits = copy(self.ball), FEW  # the same numbers, read with few bits
        self.isometries = [self.isometry(g) for g in told["isometries"]]
        self.age, self.count, self.out, self.known, self.parted, self.lasting = -1, 0, [], {}, set(), {}
    def isometry(self, told):  # its linear part, what it maps to what, by the data, and whose flights it maps
        (a, b, d, e), (p, q) = ([number(text) for text in told[key]] for key in ("matrix", "shift"))
        images, zeros = dict(told["map"]), [a * a + d * d - ONE, b * b + e * e - ONE, a * b + d * e]
        for i, j in images.items():
            (x, y, vx, vy, *k), (u, v, wx, wy, *m) = self.things[i], self.things[j]
            x, y, vx, vy = a * x + b * y + p - u, d * x + e * y + q - v, a * vx + b * vy, d * vx + e * vy
            zeros += [vx * wy - vy * wx, x * wx + y * wy] if i >= self.n else [x, y, vx - wx, vy - wy, *map(sub, k, m)]
            zeros += [ONE] * ((i < 0, i < self.n) != (j < 0, j < self.n))
        if len({*images.values()}) < len(told["map"]) or any(zeros): raise Refuted("an isometry maps otherwise")
        return (a, b, d, e), images, {i for i in images if 0 <= i < self.n}
    def image(self, images, c):  # the image of a contact
        i, j = images.get(c[0]), images.get(c[1])
        return None if i is None or j is None else (min(i, j), max(i, j)) if 0 <= j < self.n else (i, j)
    def mapped(self, g):  # the circles whose flights an isometry maps: what hits them it maps, with all that it hits
        _, images, kept = g
        def strays(i):
            row, like = (self.rows.get(k, []) for k in (i, images[i]))
            by = {k for part in row for c in part for k in c} & self.movable
            return by - kept or like != [{self.image(images, c) for c in part} for part in row]
        while bad := {i for i in kept if strays(i)}: kept = kept - bad
        return kept
    def proves(self, question, c, how, other=None):  # whether a witness proves a number zero
        (i, j), other, first = c, tuple(other) if other else self.clock, question == "closing" and not self.rows
        if how == "back":
            due = question == "gap" or (question == "until" and self.end["reason"] == "return" and len(self.out) == 1)
            return self.way and self.out and due and self.met.get(other, 0) < 0 and {c, other} <= self.out[-1][1]
        (a, b, d, e), images, _ = g = self.isometries[how]
        kept = self.mapped(g)
        if other in self.met and self.image(images, c) == other and (question == "gap" or first > abs(self.met[other])):
            return all(k in kept for k in c if 0 <= k < self.n)
        if j >= self.n and question == "closing":
            _, _, nx, ny, _ = self.things[j]
            return not (a * nx + b * ny + nx or d * nx + e * ny + ny) and images.get(i) == i and i in kept
        unturned = question in ("closing", "speed") and not any((a - ONE, b, d, e - ONE))
        return unturned and any(images.get(k) == m and k in kept for k, m in ((i, j), (j, i)))
    def zero(self, question, c, law):  # whether a number is zero, as a form or by a witness
        return not law(self.form) or any(self.proves(question, c, *how) for how in self.witnesses[question, c])
    def sign(self, question, c, law=None):  # the sign of a number
        law = law or (lambda w: getattr(w.meeting(c, self.age), question))
        if (sign := law(self.ball).sign()) is not None: return sign
        if self.zero(question, c, law): return 0
        raise (Refuted if self.witnesses[question, c] else Undecided)(f"{c}: no witness proves {question!r} zero")
    def clear(self, c, age=None, last=False):  # proves that two do not meet on their flights up to an instant, or ever
        if c in self.parted: return
        for w in self.few, self.ball:
            gap, closing, _, disc = map(Ball.sign, (m := w.meeting(c, start := w.start(c)))[:4])
            if gap is None and c[1] < 0: continue  # the centre of a circle may be in the pocket from the start
            if (gap == -1 and c[1] < 0) or (gap == 1 and (closing in (0, 1) or disc == -1)): return
            if gap == -1 or (age is None and (closing, disc) == (-1, 1)): raise Refuted(f"{c} overlap, or meet")
            if age is None: continue
            end, wait = w.meeting(c, age), w.wait(start, age)
            after = end.gap.sign()
            there, back = (x.gap + x.closing * s + x.closing * s for x, s in ((m, wait), (end, -wait)))
            if (gap, there.sign()) == (1, 1) or (gap, after, back.sign()) == (1, 1, 1): return
            if after == -1 or (closing, disc, end.closing.sign()) == (-1, 1, 1): raise Refuted(f"{c} meet before it")
        laws = {name: lambda w, name=name: getattr(w.meeting(c, start), name) for name in ("closing", "disc")}
        if gap == 1 and (last or after == 1) and any(self.zero(name, c, law) for name, law in laws.items()): return
        raise Undecided(f"whether {c} meet before it")
    def take(self, entry, where):  # takes up the witnesses of an entry
        Checker.where, self.witnesses, self.met, self.rows, self.clock = where, defaultdict(list), {}, {}, None
        for question, c, *witness in entry.get("zeros", ()): self.witnesses[question, tuple(c)].append(witness)
    def instant(self, entry):  # its time; what meets at it, or the reversal; what follows
        self.age, turn, told, met = self.age + 1, "turn" in entry, "exact" in entry, [*map(tuple, entry.get("met", ()))]
        age, times, due = self.age, self.ball.times, self.due
        self.take(entry, f"instant {age}")
        if due != turn or self.count == self.last: raise Refuted("the reversal is due, or is not, or the end is")
        if told and (turn or not age): raise Refuted("it has a time already")
        if len({*met} - self.lasting.keys() & self.meets) < len(met) * (1 + turn): raise Refuted(f"{met} cannot meet")
        for w in self.worlds if age else ():
            w.times.append(w.times[-1] if turn else w.of(number(entry["exact"])) if told else w.hit(met[0]))
        self.said(times[age], entry["time"])
        if age and not turn: positive(self.ball.wait(age - 1, age).sign(), "it does not come later, or may not")
        for c in met:
            self.clock = self.clock or c
            if (self.met or told or not age) and self.sign("gap", c): raise Refuted(f"{c} do not meet at it")
            self.met[c] = self.sign("closing", c)
            if age and self.met[c] > 0: self.clear(c, last=True)  # only a pocket is left, by what was in it
        self.known = {c: -sign for c, sign in self.known.items()} if turn else self.lasting | self.met
        self.way, self.due = self.way or turn, False
        if turn: self.settle(self.movable)
        for w in self.worlds if turn else ():
            w.redirect(self.movable, age, -ONE)
            w.limits.pop("reverse", None)
            if self.end["reason"] == "return": w.limits["until"] = w.times[age] + w.times[age]
        for name in self.ball.limits:
            sign = self.sign(name, self.clock, lambda w, name=name: sub(*w.at(w.limits[name], w.times[age])))
            if sign < 0: raise Refuted("the end, or the reversal, comes before it")
            self.due |= name == "reverse" and sign == 0
        if not (met or turn or self.due or age == 0): raise Refuted("nothing falls on it")
        self.resolve([*entry.get("rounds", ())], entry, {*self.movable} if turn else set())
        self.due |= not self.way and 0 < self.count == self.told["scene"].get("reverse_after")
        known = (x.bits - x.r.bit_length() for i in self.movable for x in self.ball.flights[i][:4])
        self.ball.bits = min(self.ball.bits, max(known, default=0) + KEEP + Ball.bits // 32)
    def settle(self, circles):  # proves that circles have met nothing but what is known, as their flights end
        for c in self.meets:
            if c not in self.known and not circles.isdisjoint(c): self.clear(c, self.age)
    def resolve(self, rounds, entry, moved):
        known, pushes, self.count = self.known, {}, self.count + bool(rounds)  # rounds; then entries; then what lasts
        while approaching := sorted(c for c in known if known[c] < 0 <= c[1]):  # the next group
            group, circles = set(), {*approaching[0]} & {*range(self.n)}
            while more := {c for c in known if not circles.isdisjoint(c)} - group:
                group, circles = group | more, circles.union(*more) & {*range(self.n)}
            self.settle(circles)
            while coming := sorted(c for c in group if known[c] < 0 <= c[1]):
                if self.policy != "simultaneous":
                    coming = [coming[self.draw.randrange(len(coming)) if self.draw and len(coming) > 1 else 0]]
                told = rounds.pop(0) if rounds else []
                push = [(i, j) for i, j, *_ in told]
                if not push or len({*push}) < len(push) or {*push} - {*coming}: raise Refuted(f"{push} cannot push")
                others, s = [c for c in coming if c not in push], [number(text) for _, _, *by in told for text in by]
                balls, _ = (w.blow(self.age, push, others, s) for w in self.worlds)
                if s and any(self.form.rest[c] for c in push): raise Refuted(f"the impulses of {push} are others")
                for impulse in balls: positive(impulse.sign(), f"{push} do not push, or may not")
                for c in others:
                    if self.sign("slack", c, lambda w, c=c: w.rest[c]) < 0: raise Refuted(f"{c} push too")
                for i in circles & self.movable:
                    for rows, contacts in ((self.rows, coming), (pushes, push)):
                        if row := {c for c in contacts if i in c}: rows.setdefault(i, []).append(row)
                moved |= (hit := self.movable & {i for c in push for i in c})
                known |= {c: self.sign("closing", c) for c in sorted(group) if hit & {*c}}
        enter = sorted(c for c in known if c[1] < 0 and known[c] < 0)
        if rounds or enter != sorted(map(tuple, entry.get("enter", ()))): raise Refuted(f"{enter} enter, or none push")
        if taken := {i for i, _ in enter if self.told["scene"].get("capture")}:
            self.settle(taken)
            for w in self.worlds: w.redirect(taken, self.age, NONE)
            self.meets = {c for c in self.meets if not taken & {*c}}
        self.known = {c: sign for c, sign in known.items() if c in self.meets}
        self.lasting = {c: 0 for c, sign in self.known.items() if (c in self.lasting and not moved & {*c})
                        or (sign == 0 and self.sign("speed", c) == 0)}
        self.parted = {c for c in self.parted if not moved & {*c}} | known.keys()
        self.isometries = [(*g[:2], {i for i in self.mapped(g) if not taken & {i, g[1][i]}}) for g in self.isometries]
        hits = {i: rows[::-1] for i, rows in pushes.items()}
        if not self.way and (hits or not self.age): self.out.append((hits, {c for c in known if c[1] >= 0}))
        if self.way and hits: self.out = self.out[:-1] if self.out and self.out[-1][0] == pushes else []
    def said(self, value, text):  # that a number is as the decimal text says, to within one unit of its last digit
        unit, at = Fraction(1, 10 ** len(text.partition(".")[2])), Fraction(text)
        value, low, high = self.ball.at(value, *(enclosed(Form({frozenset(): at + d})) for d in (-unit, unit)))
        for x in (value - low, high - value): positive(x.sign(), f"a number is not {text[:40]}")
    def check(self):  # instant by instant; then what ended the run, and the final state
        for entry in self.told["instants"]: self.instant(entry)
        self.take(self.end, "at the end")
        reason, limits = self.end["reason"], self.ball.limits
        if self.last not in (None, self.count): raise Refuted(f"there are {self.count} events")
        if (self.last is None and self.due) or (reason == "return" and not self.way): raise Refuted("no reversal")
        if reason not in ("events", "stopped") and "reverse" in limits:
            positive((limits["reverse"] - limits["until"]).sign() if "until" in limits else 0, "the reversal is first")
        for w in self.worlds if "until" in limits else (): w.times.append(w.limits["until"])
        self.age += "until" in limits
        for c in self.meets: self.clear(c, None if reason == "quiet" else self.age, last=True)
        self.said(self.ball.times[self.age], self.told["final"]["time"])
        for i, row in zip(range(self.n), self.told["final"]["circles"], strict=True):
            for value, text in zip(self.ball.put(i, self.age)[:4], row, strict=True): self.said(value, text)
        return f"{self.count} events, to the end: {reason}"
def judged(told, factor):  # the exit code for a certificate with so many times its bits, and a sentence
    Checker.where, Form.work = "in the scene", 0
    try: return 0, f"verified: {Checker(told, factor).check()}"
    except (Refuted, Undecided) as fault: return fault.code, f"{fault.word}: {Checker.where}: {fault}"
def fits(value, shape):  # refuses a part, or a list of parts, of another shape
    for part in value if isinstance(value, list) else [value]:
        for key in {*part, *shape[0]}:
            found, inner = part[key], (shape[0] | shape[1])[key]
            if isinstance(inner, tuple): fits(found, inner)
            elif not re.fullmatch(inner, json.dumps(found, separators=(",", ":")), re.ASCII):
                raise Malformed(f"its {key} is not of its shape")
def once(pairs):  # an object of JSON whose keys differ
    if len(found := dict(pairs)) < len(pairs): raise Malformed("a key comes twice")
    return found
def verdict(path):  # the exit code for a file, and a sentence
    sys.set_int_max_str_digits(DIGITS)
    try:
        if Path(path).exists() and not Path(path).is_file(): raise Malformed("it is no regular file")
        with Path(path).open("rb") as file: text = file.read(BYTES + 1)
        if len(text) > BYTES: raise Malformed(f"it is longer than {BYTES} bytes")
        told = json.loads(text.decode(), object_pairs_hook=once)
        code, sentence = judged(told, 1)
        for factor in (2, 4) if code == 4 else ():
            more, what = judged(told, factor)
            if more != 4: return 4, f"{sentence}; with {factor * told['bits']} bits it is {what}"
        return code, sentence + "; nor do 4 times the bits decide" * (code == 4)
    except OSError as error: return 2, f"no certificate: it cannot be read: {error.strerror}"
    except BROKEN as error: return 2, f"no certificate: {type(error).__name__}: {' '.join(str(error).split())[:200]}"
if __name__ == "__main__":
    code, said = verdict(sys.argv[1]) if len(sys.argv) == 2 else (2, "usage: verify.py FILE")
    sys.exit(print(said.encode("ascii", "backslashreplace").decode()) or code)
