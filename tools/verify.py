"""Checks a certificate of a run of hard circles, walls and pockets, with Python's standard library alone: FILE.

docs/certificates.md defines the format. No search, no queue: what the certificate states is proved again, or refused.

*Numbers.* A `Ball` is an interval; rounded outward, what it says of a sign is true, or it says nothing. An `Exact` is
a + b*sqrt(d), where a, b, d are alike with earlier roots: what is zero term by term is zero, whatever the roots are.

*Flights.* Between instants circles fly straight. A gap, |d|^2 - R^2 of two circles or the distance from a wall, is
convex in time: it falls through zero once at most. `meeting` encloses that time, or proves that there is none.

*Instants.* By induction, let all flights be enclosed. The next instant is when the contact named first meets. `window`
proves that every other pair, wall and pocket meets later, or is listed, and then a witness proves it simultaneous. So
nothing is missed and nothing invented.

*Impulses.* All that stands at gap zero and hangs together is signed, round by round, until nothing approaches.
`simultaneous`: the impulses s of those said to push solve G s = -2u, are positive, and leave each other contact that
approaches with 2u + G s >= 0; the velocities that follow are unique (Cottle, Pang, Stone, The Linear Complementarity
Problem, 3.1). `sequential`: one contact at a time, in the order that the scene or its seed says.

*Zeros.* That a number is zero takes a witness. "exact": it is computed again from the scene in `Exact` numbers. An
isometry: it maps the causal past of one number to that of another, or of its negative (`maps`); data are compared
exactly, rounds as sets of contacts, and by induction over the rounds flights are mapped to flights. "back": the way
back of a reversed run undoes the way out (`undo`). docs/symmetry-and-ties.md proves both theorems.
"""

import json
import random
import re
import sys
from fractions import Fraction
from pathlib import Path

if not __package__:  # run as a program
    folder = Path(__file__).resolve().parent
    sys.path.insert(0, str(folder.parent))
    __package__ = folder.name

from .arithmetic import ONE, ROOTS, SCENE_ROOTS, WORK, ZERO, Ball, Exact, Malformed, Refuted, Undecided, number
from .impulses import Impulses
from .laws import World, place
from .witnesses import Block

FORMAT, BYTES, CIRCLES, BITS = "truebreak/certificate-1", 1 << 24, 1000, 1 << 20
PAIRS, SIZE = 1 << 22, 1 << 30
DOUBT = "doubt", None
BROKEN = (Malformed, LookupError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError, OSError)


class Checker(Impulses):
    """Follows the log of a certificate. Between instants it keeps `flights`, all enclosed; `coming`, what is known of
    the next meeting of two: None, ("hit", when), ("graze", when) or ("doubt", None); `lasting`, the contacts that stay
    at gap zero; `rows`, the past of each circle."""

    def __init__(self, certificate):
        if not isinstance(certificate, dict) or certificate.get("format") != FORMAT:
            raise Malformed(f"the format is not {FORMAT}")
        self.told = certificate
        self.scene = scene = certificate["scene"]
        Exact.roots, Exact.most, Exact.work, Exact.budget = [], ROOTS, 0, WORK
        if len(certificate["roots"]) > SCENE_ROOTS or not 0 < len(scene["circles"]) <= CIRCLES:
            raise Malformed("it has no circle, or too many, or too many roots")
        for text in certificate["roots"]:
            Exact.roots.append(number(text))
        circles = [[number(c[key]) for key in ("x", "y", "vx", "vy", "r")] for c in scene["circles"]]
        for row, c in zip(circles, scene["circles"], strict=True):
            row.append(ZERO if c["m"] == "oo" else ONE / number(c["m"]))
        corners = [[number(w[key]) for key in ("x0", "y0", "x1", "y1")] for w in scene.get("walls", ())]
        walls = [[x0, y0, y0 - y1, x1 - x0] for x0, y0, x1, y1 in corners]
        pockets = [[number(p[key]) for key in ("x", "y", "r")] for p in scene.get("pockets", ())]
        self.n, self.data = len(circles), {"circles": circles, "walls": walls, "pockets": pockets, "sides": {}}
        self.bits = dict(map(tuple, certificate["bits"]))
        if not all(0 < bits <= BITS for bits in self.bits.values()) or 0 not in self.bits:
            raise Malformed("bits out of range")
        if (size := self.n * (self.n + len(walls) + len(pockets))) > PAIRS or size * self.bits[0] > SIZE:
            raise Malformed("too many circles, walls and pockets, or too many bits for so many")
        self.movable = {i for i, c in enumerate(circles) if not c[5].zero()}
        points = {i for i, c in enumerate(circles) if c[4].zero()}
        pairs = [{i, j} for i in range(self.n) for j in range(i + 1, self.n)]
        others = [*range(self.n, self.n + len(walls)), *range(-len(pockets), 0)]
        self.meets = [tuple(sorted(pair)) for pair in pairs if pair & self.movable and not pair <= points]
        self.meets += [(i, j) for i in sorted(self.movable) for j in others]
        self.end, self.limits = certificate["end"], {}
        for key, at in (("reverse_at", scene), ("until", self.end)):
            if key in at:
                self.limits[key] = number(at[key])
        self.exact, self.known, self.isometries = World(self.data, lambda x: x), {}, {}
        self.policy, _, seed = scene["tie_policy"].partition(":seed=")
        self.draw = random.Random(int(seed)) if seed else None
        if self.policy not in ("simultaneous", "sequential", "sequential:order=scene"):
            raise Malformed(f"tie policy {self.policy!r} is not known")
        Ball.bits = self.bits[0]
        positive = [*self.limits.values(), *(p[2] for p in pockets), *(c[4] for c in circles if not c[4].zero())]
        positive += [c[5] for c in circles if not c[5].zero()]
        wrong = any(x.ball().sign() != 1 for x in positive) or len(scene.keys() & {"reverse_at", "reverse_after"}) > 1
        if wrong or any(not (c[2].zero() and c[3].zero()) for c in circles if c[5].zero()):
            raise Malformed("a size, mass or time is not positive, a fixed circle moves, or there are two reversals")

    def check(self, factor=1):
        """Checks all of it, with `factor` times the bits.

        Raises:
            Refuted: if something in it is false.
            Undecided: if these bits do not tell.
        """
        self.age, self.count, self.where, self.levels, self.turned = 0, 0, "at the start", {}, None
        self.rows, self.standing, self.grazed, self.gone = [[] for _ in range(self.n)], {}, set(), set()
        self.factor, self.coming, self.lasting, self.tied = factor, {}, set(), set()
        Ball.bits = self.bits[0] * factor
        self.balls = World(self.data, Exact.ball)
        self.flights = [(*c[:4], self.balls.zero, 0) for c in self.balls.circles]
        self.time, self.turn = self.balls.zero, None
        self.open(self.told["start"])
        for k, entry in enumerate(self.told["instants"]):
            self.where = f"instant {k}"
            self.instant(entry, self.bits.get(k + 1))
        self.where = "at the end"
        self.close()

    # -- instants

    def open(self, entry):
        """Time 0: nothing overlaps; what touches is known exactly."""
        self.witnessed(entry, (Exact(Fraction(0)), {}))
        known = {}
        for i in self.movable:
            for k, (x, y, nx, ny) in enumerate(self.balls.walls, start=self.n):
                side = (nx * (self.flights[i][0] - x) + ny * (self.flights[i][1] - y)).sign()
                if not side:
                    raise Undecided(f"on which side of wall {k - self.n} circle {i} is")
                self.data["sides"][i, k] = side > 0
        for c in self.meets:
            gap = self.balls.meeting(self.fly, c)[1].sign()
            if gap == 0 or (gap is None and self.exactly("rim", c, None)):
                known[c] = self.sign("still", c, self.balls.meeting(self.fly, c)[2])
                self.coming[c] = None
            elif gap is None or (gap < 0 and c[1] >= 0):
                raise (Refuted if gap else Undecided)(f"{c} overlap, or it is not known that they do not")
        for c in self.meets:
            if c not in known:
                self.coming[c] = self.foreseen(c)
        self.resolve(known, entry, [])
        self.turn_if_due(entry, False)

    def instant(self, entry, bits):
        """One instant: its time, nothing before it, all that falls on it, and what that does."""
        if bits:
            self.cut(bits * self.factor)
        self.age += 2
        arrive, grazes = ([tuple(c) for c in entry.get(key, ())] for key in ("arrive", "grazes"))
        if arrive:
            kind, time = self.coming.get(arrive[0]) or ("none", None)
            if kind != "hit":
                raise Refuted(f"{arrive[0]} do not meet") if kind != "doubt" else Undecided(f"whether {arrive[0]} meet")
            source = arrive[0], {i: len(self.rows[i]) for i in arrive[0] if 0 <= i < self.n}
        else:
            if self.turned or "reverse_at" not in self.limits or "reversal" not in entry:
                raise Refuted("nothing falls on it")
            time, source = self.limits["reverse_at"].ball(), (self.limits["reverse_at"], {})
        self.time = time
        self.witnessed(entry, source)
        self.said(time, entry["time"])
        self.tied = set(arrive[:1])
        for c in [*arrive[1:], *grazes]:
            self.join(c, time, "hit" if c in arrive else "graze")
        near = [c for c in self.meets if self.coming[c] and c not in self.tied and self.window(c, time)]
        due = self.before_limits(arrive)
        known = {**dict.fromkeys(self.lasting, 0), **dict.fromkeys(grazes, 0), **dict.fromkeys(arrive, -1)}
        only = [[arrive[0]]] if len(arrive) == 1 and arrive[0][1] >= 0 else []
        self.resolve(known, entry, only, near)
        self.turn_if_due(entry, due)

    def before_limits(self, arrive):
        """That the instant comes before the end, or at it; whether the reversal at a set time falls on it."""
        end = self.limits.get("until") and self.limits["until"].ball()
        if self.end["reason"] == "return" and self.turn:
            end = self.turn + self.turn
        same = end and not arrive and (self.limits["until"] - self.limits["reverse_at"]).zero()
        if end and not same and self.sign("until", arrive[0] if arrive else None, end - self.time) < 0:
            raise Refuted("it comes after the end")
        if self.turned or "reverse_at" not in self.limits:
            return False
        wait = self.limits["reverse_at"].ball() - self.time
        sign = 0 if not arrive else self.sign("reverse", arrive[0], wait)
        if sign < 0:
            raise Refuted("the reversal comes before it")
        return sign == 0

    def join(self, c, time, kind):
        """That a listed contact meets, or grazes, at this very instant."""
        if (self.coming.get(c) or ("none", None))[0] == "doubt":
            self.coming[c] = self.settled(c, None)
        known, when = self.coming.get(c) or ("none", None)
        if known != kind or c in self.tied or (when - time).sign() in (-1, 1):
            raise Refuted(f"{c} do not meet at this instant")
        if (when - time).sign() is None:
            self.zero("tie", c)
        self.tied.add(c)

    def window(self, c, time):
        """Proves that the next meeting of two comes after a time (None: that there is none); or else whether it is a
        graze that may fall on it."""
        if self.coming[c][0] == "doubt":
            self.coming[c] = self.settled(c, time)
            if self.coming[c] in (None, DOUBT):
                return False
        kind, when = self.coming[c]
        order = (when - time).sign() if time else -1
        if order == 1:
            return False
        if kind == "graze":
            if order == -1:
                self.coming[c] = None
            return order != -1
        raise (Refuted if order == -1 else Undecided)(f"{c} meet before it, or may")

    def settled(self, c, time):
        """A doubtful meeting: by a witness a graze, or none as the two do not come nearer; else still in doubt, if they
        have surely not met until a time."""
        closing = self.balls.meeting(self.fly, c)[2].sign()
        if closing == -1 and self.zero("graze", c, must=False):
            self.grazed.add(self.heights(c))
            return "graze", self.balls.time(self.fly, c, graze=True)
        if closing is None and any(self.proves("still", c, *w) for w in self.witnesses.get(("still", c), ())):
            return None
        if time and self.apart(c, time):
            return DOUBT
        raise Undecided(f"whether {c} meet, graze or miss")

    def apart(self, c, time):
        """Whether two have not met until a time. Their gap is at least gap + 2 closing * s at s after the start, as it
        is convex; and if it still falls then, it has not been smaller."""
        t, gap, closing, _, speed = self.balls.meeting(self.fly, c)
        fastest, s = Ball(-abs(closing.m) - closing.r), time - t
        if (gap + (fastest + fastest) * s).sign() == 1:
            return True
        if speed is None:
            return False
        then = closing + speed * s
        return then.sign() == -1 and (gap + (closing + then) * s).sign() == 1

    def foreseen(self, c):
        """The next meeting of two, from the start of the younger of their flights."""
        _, gap, closing, disc, _ = self.balls.meeting(self.fly, c)
        if c[0] in self.gone or c[1] in self.gone or closing.sign() in (0, 1):
            return None
        if gap.sign() == -1:
            if c[1] < 0:
                return None
            raise Refuted(f"{c} overlap")
        sign = 1 if disc is None else disc.sign()
        if sign == -1:
            return None
        if closing.sign() is None or sign is None:
            return DOUBT
        return ("hit" if sign else "graze"), self.balls.time(self.fly, c, graze=not sign)

    # -- the reversal

    def turn_if_due(self, entry, due):
        """The reversal, if it falls on this instant, and what follows from it."""
        due = due or (not self.turned and self.count > 0 and self.scene.get("reverse_after") == self.count)
        last = entry is (self.told["instants"] or [self.told["start"]])[-1]
        if due and "reversal" not in entry and last and self.end.get("limit") == self.count:
            return  # the event after it would be one too many
        if due != ("reversal" in entry):
            raise Refuted("the reversal falls on it" if due else "the reversal does not fall on it")
        if not due:
            return
        self.age, self.turned, self.turn = self.age + 1, self.source, self.time
        self.levels = dict.fromkeys(range(self.n), 0) | {i: len(self.rows[i]) for i in self.movable}
        for i, old in enumerate(self.flights):
            self.flights[i] = (*place(old, self.time), -old[2], -old[3], self.time, self.age)
        for i in self.movable:
            self.log(Block("turn", (), (), {i: len(self.rows[i])}, self.source, self.age))
        known = {**dict.fromkeys(self.lasting, 0), **{c: -sign for c, sign in self.known_now.items()}}
        self.witnessed(entry["reversal"], self.source)
        self.resolve(known, entry["reversal"], [], everyone=True)
        self.age += 1

    # -- the frame

    def witnessed(self, entry, source):
        """Takes up the witnesses of an instant, and what its time comes of."""
        self.source, self.witnesses = source, {}
        for question, c, witness, *other in entry.get("zeros", ()):
            found = self.witnesses.setdefault((question, tuple(c)), [])
            found.append((witness, *map(tuple, other)))

    def cut(self, bits):
        """Goes on with fewer bits."""
        drop, met = Ball.bits - bits, {}

        def shorter(x):
            return met.setdefault(id(x), (x, x.cut(drop)))[1] if isinstance(x, Ball) else x

        Ball.bits = bits
        self.balls = World(self.data, Exact.ball)
        self.flights = [tuple(map(shorter, flight)) for flight in self.flights]
        self.coming = {c: known and tuple(map(shorter, known)) for c, known in self.coming.items()}
        self.turn = shorter(self.turn)

    def said(self, value, text):
        """That a number is as the decimal text says, to within one unit of its last digit."""
        if not (decimal := re.fullmatch(r"-?\d{1,400}(?:\.(\d{1,400}))?", text, re.ASCII)):
            raise Malformed(f"{text[:40]!r} is no decimal")
        unit = Exact(Fraction(1, 10 ** len(decimal[1] or ""))).ball()
        off = value - Exact(Fraction(text)).ball()
        signs = (unit - off).sign(), (unit + off).sign()
        if signs != (1, 1):
            raise (Undecided if None in signs else Refuted)(f"a number is not {text}")

    def close(self):
        """What ended the run, and the final state."""
        reason, time = self.end["reason"], self.time
        self.witnessed(self.end, self.source if self.told["instants"] else (Exact(Fraction(0)), {}))
        if reason == "events":
            if self.end["limit"] != self.count:
                raise Refuted(f"there are {self.count} events")
        elif reason in ("horizon", "return", "quiet"):
            if reason == "return" and not self.turned:
                raise Refuted("nothing was reversed")
            until = None
            if reason != "quiet":
                until = self.limits["until"].ball() if reason == "horizon" else self.turn + self.turn
            if not self.turned and "reverse_at" in self.limits:
                sign = (self.limits["reverse_at"].ball() - until).sign() if until else -1
                if sign != 1:
                    raise (Undecided if sign is None else Refuted)("the reversal comes first")
            for c in self.meets:
                if self.coming[c]:
                    self.window(c, until)
            self.time = time = until or time
        elif reason != "stopped":
            raise Malformed(f"end {reason!r} is not known")
        self.said(time, self.told["final"]["time"])
        for flight, row in zip(self.flights, self.told["final"]["circles"], strict=True):
            for value, text in zip((*place(flight, time), *flight[2:4]), row, strict=True):
                self.said(value, text)


def verdict(path):
    """The exit code for a file, and a sentence."""
    sys.set_int_max_str_digits(0)
    checker = None
    try:
        if Path(path).exists() and not Path(path).is_file():
            raise Malformed("it is no regular file")
        with Path(path).open("rb") as file:
            if len(text := file.read(BYTES + 1)) > BYTES:
                raise Malformed(f"it is longer than {BYTES} bytes")
        told = json.loads(text)
        try:
            checker = Checker(told)
            checker.check()
            return 0, f"verified: {checker.count} events, to the end: {checker.end['reason']}"
        except Undecided as doubt:
            where = checker.where if checker else "in the scene"
            return 4, f"not decided: {where}: {doubt}; {enough(told)}"
    except Refuted as fault:
        return 1, f"refuted: {checker.where}: {fault}"
    except BROKEN as error:
        return 2, f"no certificate: {type(error).__name__}: {' '.join(str(error).split())[:200]}"


def enough(told):
    """How many bits would decide."""
    for factor in (2, 4):
        try:
            Checker(told).check(factor)
        except Undecided:
            continue
        except Refuted as fault:
            return f"{factor} times the bits refute it: {fault}"
        return f"{factor} times the bits verify it"
    return "nor with 4 times the bits"


if __name__ == "__main__":
    code, sentence = verdict(sys.argv[1]) if len(sys.argv) == 2 else (2, "usage: verify.py FILE")
    print(sentence)
    sys.exit(code)
