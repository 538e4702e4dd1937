"""Exact numbers of certificates, nested square roots in normal form; and a scene in them, as certificates spell it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import isqrt
from operator import add, mul, neg, sub, truediv
from typing import Any, ClassVar, TypeVar, cast

from ...scenarios.numbers.quantity import Quantity
from ...scenarios.scene import Scene
from ...scenarios.things import Arc, Circle, Pocket, Segment, Wall
from ...tools.verify import Sum, Unsettled
from .outlines import bars_of

T = TypeVar("T")

ROOTS = 24
"""Most roots that a run's numbers may take."""

SCENE_ROOTS = 12
"""Most of them that a scene's numbers may take."""

WORK = 1 << 37
"""Most work (see `Exact.work`): about two minutes."""

DEEP_ROOTS = 7
"""Roots beyond those at hand that an exact zero may take."""

DEEP_WORK = 1 << 32
"""Work that an exact zero may take (see `Exact.work`): some seconds."""


class Exact:
    """a + b*sqrt(d): d is the k-th of `roots`, a and b use those before it; for k = 0 the fraction a.

    Attributes:
        roots: the numbers whose positive roots are taken, each in those before it.
        most: how many of them there may be.
        work: what products have cost so far, in units of about a nanosecond.
        budget: what they may cost.
    """

    roots: ClassVar[list[Exact]] = []
    most: ClassVar[int] = ROOTS
    work: ClassVar[int] = 0
    budget: ClassVar[int] = WORK

    __slots__ = ("a", "b", "k")

    def __init__(self, a: Any, b: Any = None, k: int = 0) -> None:
        self.a, self.b, self.k = a, b, k

    def __bool__(self) -> bool:
        return self.k > 0 or self.a != 0

    def parts(self, k: int) -> tuple[Exact, Exact]:
        """a and b, by the k-th root."""
        return (self.a, self.b) if self.k == k else (self, ZERO)

    def __neg__(self) -> Exact:
        return Exact(-self.a, self.b and -self.b, self.k)

    def __sub__(self, o: Exact) -> Exact:
        return self + -o

    def __add__(self, o: Exact) -> Exact:
        if not (k := max(self.k, o.k)):
            return Exact(self.a + o.a)
        (a, b), (c, d) = self.parts(k), o.parts(k)
        return Exact(a + c, high, k) if (high := b + d) else a + c

    def __mul__(self, o: Exact) -> Exact:
        if not (self and o):
            return ZERO
        if not (k := max(self.k, o.k)):
            Exact.work += 10_000 + (size(self.a) * size(o.a) >> 8)  # about a nanosecond a unit
            if Exact.work > Exact.budget:
                raise Unsettled("exact values take too much work")
            return Exact(self.a * o.a)
        (a, b), (c, d) = self.parts(k), o.parts(k)
        low, high = a * c + b * d * Exact.roots[k - 1], a * d + b * c
        return Exact(low, high, k) if high else low

    def __truediv__(self, o: Exact) -> Exact:
        if o.k == 0:
            return self * Exact(1 / o.a)
        return self * Exact(o.a, -o.b, o.k) / (o.a * o.a - o.b * o.b * Exact.roots[o.k - 1])

    def sign(self) -> int:
        """That of a and b; where they differ, a*a - b*b*d tells which is the greater."""
        if self.k == 0:
            return (self.a > 0) - (self.a < 0)
        a, b = self.a.sign(), self.b.sign()
        return b if a in (0, b) else a * (self.a * self.a - self.b * self.b * Exact.roots[self.k - 1]).sign()

    def sqrt(self) -> Exact:
        """The positive root: made of the roots at hand if it can be, else a new one."""
        if self.sign() < 1:
            raise Unsettled("a number that is not positive has a root")
        if root := self.within(len(Exact.roots)):
            return root if root.sign() > 0 else -root
        if len(Exact.roots) >= Exact.most:
            raise Unsettled("exact values take too many roots")
        Exact.roots.append(self)
        return Exact(ZERO, ONE, len(Exact.roots))

    def within(self, k: int) -> Exact | None:
        """A square root made of the first k roots, or None: from (c + e*sqrt(d))^2 = a + b*sqrt(d)."""
        if k == 0:
            root = Fraction(isqrt(abs(self.a.numerator)), isqrt(self.a.denominator))
            return Exact(root) if root * root == self.a else None
        (a, b), d = self.parts(k), Exact.roots[k - 1]
        if not b:
            return a.within(k - 1) or ((e := (a / d).within(k - 1)) and Exact(ZERO, e, k))
        norm = (a * a - b * b * d).within(k - 1)
        for n in (norm, -norm) if norm else ():
            if c := ((a + n) / (ONE + ONE)).within(k - 1):
                return Exact(c, b / (c + c), k)
        return None

    @staticmethod
    def of(form: Sum) -> Exact:
        """A sum of terms as a number."""
        total = ZERO
        for ks, x in form.items():
            term = Exact(Fraction(x))
            for k in ks:
                term = term * Exact(ZERO, ONE, k + 1)
            total = total + term
        return total


ZERO, ONE = Exact(Fraction(0)), Exact(Fraction(1))


def size(x: Fraction) -> int:
    """Bits of a fraction."""
    return x.numerator.bit_length() + x.denominator.bit_length()


def exact_number(q: Quantity) -> Exact:
    """A quantity in the checker's exact numbers, whose list of roots grows where it must.

    Raises:
        Unsettled: if it needs more roots than a certificate may hold.
    """
    if q.rational is not None:
        return Exact(Fraction(int(q.rational.p), int(q.rational.q)))
    parts = [exact_number(part) for part in q.args]
    if q.op == "sqrt":
        return parts[0].sqrt() if parts[0] else ZERO
    left, right = parts
    if q.op == "+":
        return left + right
    if q.op == "-":
        return left - right
    return left * right if q.op == "*" else left / right


def text_of(value: Exact) -> str:
    """A number as a certificate spells it.

    >>> text_of(Exact(Fraction(-3, 4)))
    '-3/4'
    """
    text = "+".join("*".join([str(factor), *names]) for factor, names in _terms(value))
    return text.replace("+-", "-") or "0"


def _terms(value: Exact) -> list[tuple[Fraction, list[str]]]:
    if value.k == 0:
        return [] if not value else [(value.a, [])]
    plain, rooted = _terms(value.a), _terms(cast(Exact, value.b))
    return plain + [(factor, [*names, f"r{value.k}"]) for factor, names in rooted]


def _length(wall: Any) -> Exact:
    """Of the vector between the two points that a wall or a segment is told by."""
    x, y = exact_number(wall.x1) - exact_number(wall.x0), exact_number(wall.y1) - exact_number(wall.y0)
    return (x * x + y * y).sqrt()


def _bow(arc: Arc, told: dict[str, str]) -> dict[str, str]:
    """An arc, with where it begins and ends on its circle."""
    for k, (x, y) in enumerate(arc.ends):  # of a full one there are none
        told |= {f"x{k}": text_of(exact_number(x)), f"y{k}": text_of(exact_number(y))}
    return told


def scene_part(scene: Scene) -> dict[str, Any]:
    """The part `scene` of a certificate; its roots are in `Exact.roots`, to which later numbers may add.

    Raises:
        Unsettled: if the scene's numbers need more roots than a certificate may hold.

    >>> from truebreak.scenarios import Circle, Scene
    >>> part = scene_part(Scene([Circle("1/2 + sqrt(8)", 0)]))
    >>> [text_of(root) for root in Exact.roots], part["circles"][0]["x"]
    (['8'], '1/2+1*r1')
    """
    Exact.roots, Exact.most, Exact.work, Exact.budget = [], SCENE_ROOTS, 0, WORK

    def row(thing: Circle | Wall | Pocket | Segment | Arc, keys: tuple[str, ...]) -> dict[str, str]:
        return {"id": str(thing.id), **{key: text_of(exact_number(getattr(thing, key))) for key in keys}}

    circles = []
    for circle in scene.circles:
        weight = ZERO if isinstance(circle.m, str) else ONE / exact_number(circle.m)
        circles.append({**row(circle, ("x", "y", "r", "vx", "vy")), "w": text_of(weight)})
    told: dict[str, Any] = {"tie_policy": str(scene.tie_policy)}
    if not scene.elastic:
        told["restitution"] = text_of(exact_number(scene.restitution))
    if scene.gravity is not None:
        told["gravity"] = [text_of(exact_number(part)) for part in scene.gravity]
    if scene.settle:
        told["settle"] = True
    if scene.reverse_after is not None:
        told["reverse_after"] = scene.reverse_after
    if scene.reverse_at is not None:
        told["reverse_at"] = text_of(exact_number(scene.reverse_at))
    told["circles"] = circles
    if scene.walls:
        told["walls"] = [
            {
                **row(wall, ("x0", "y0", "x1", "y1", *(("vx", "vy") if wall.moves else ()))),
                "length": text_of(_length(wall)),
            }
            for wall in scene.walls
        ]
    if scene.pockets:
        told["pockets"] = [row(pocket, ("x", "y", "r")) for pocket in scene.pockets]
        told["capture"] = scene.capture
    if bars := bars_of(scene):
        told["segments"] = [
            {
                **row(bar, ("x0", "y0", "x1", "y1", "r", *(("vx", "vy") if bar.moves else ()))),
                "length": text_of(_length(bar)),
            }
            for bar in bars
        ]
    if scene.arcs:
        told["arcs"] = [_bow(arc, row(arc, ("x", "y", "r"))) for arc in scene.arcs]
    if Exact.roots:
        told["roots"] = [text_of(root) for root in Exact.roots]
    return told


# -- Numbers that are computed when they are asked for.


class Lazy:
    """An exact number that is computed when it is asked for, from those that it comes about from.

    A product of zero is zero, whatever the other factor is: the one that less goes into is computed first.
    """

    __slots__ = ("by", "depth", "told", "value")

    def __init__(self, value: Exact | None, *by: Any) -> None:
        self.value, self.by, self.told = value, by, False
        self.depth: int = 1 + max((part.depth for part in by[1:] if isinstance(part, Lazy)), default=0)

    def __neg__(self) -> Lazy:
        return Lazy(None, neg, self)

    def __add__(self, o: Lazy) -> Lazy:
        return Lazy(None, add, self, o)

    def __sub__(self, o: Lazy) -> Lazy:
        return Lazy(None, sub, self, o)

    def __mul__(self, o: Lazy) -> Lazy:
        return Lazy(None, mul, self, o)

    def __truediv__(self, o: Lazy) -> Lazy:
        return Lazy(None, truediv, self, o)

    def sqrt(self) -> Lazy:
        return Lazy(None, Exact.sqrt, self)

    def at(self, _: int) -> Lazy:
        return self

    def sign(self) -> None:
        """Not known: whether it is zero is asked of `is_zero`."""

    def tell(self) -> None:
        """Marks it, and all that it comes about from, as what is to be told."""
        todo = [self]
        while todo:
            now = todo.pop()
            if not now.told:
                now.told = True
                parts: list[Lazy] = list(now.by[1:])
                zeros = [part for part in parts if now.by[0] is mul and _is_known_zero(part)]
                todo += zeros[:1] or parts


def _is_known_zero(x: Lazy) -> bool:
    """Whether a number is computed, and zero."""
    return x.value is not None and not x.value


def lazy_text(x: Lazy) -> str:
    """A number as certificates spell it."""
    Exact.most, Exact.budget = len(Exact.roots) + 20, Exact.work + DEEP_WORK
    _compute(x, [])
    return text_of(cast(Exact, x.value))


def is_zero(value: Lazy) -> bool:
    """Whether a number is zero exactly, within the roots and the work that it may take."""
    if computed([value], lambda numbers: not numbers[0]):
        value.tell()
        return True
    return False


def computed(values: Sequence[Lazy], use: Callable[[Sequence[Exact]], T]) -> T | None:
    """What is made of numbers, within roots and work that they may take; the roots are kept where it is something."""
    before, spent = len(Exact.roots), Exact.work
    Exact.most, Exact.budget = before + DEEP_ROOTS, spent + DEEP_WORK
    done: list[Lazy] = []
    found = None
    try:
        for value in values:
            _compute(value, done)
        found = use([cast(Exact, value.value) for value in values])
    except Unsettled:
        Exact.work = spent
    if found:
        return found
    for now in done:
        if now.value is not None and now.value.k > before:
            now.value = None
    del Exact.roots[before:]
    return None


def _depth(x: Lazy) -> int:
    return x.depth


def _compute(value: Lazy, done: list[Lazy]) -> None:
    """Computes a number; what was computed on the way is listed.

    Raises:
        Unsettled: where that takes what is no number here, or too much; but a product of zero takes no other factor.
    """
    todo, lost = [value], set[int]()
    doubt: Unsettled | None = None
    while todo:
        now = todo[-1]
        if now.value is None:
            product = now.by[0] is mul
            parts = sorted(now.by[1:], key=_depth) if product else now.by[1:]
            zero = next((part for part in parts if product and _is_known_zero(part)), None)
            missing = [] if zero else [part for part in parts if part.value is None]
            left = [part for part in missing if id(part) not in lost]
            if left and (product or len(left) == len(missing)):
                todo.append(left[0 if product else -1])
                continue
            try:
                if missing and doubt:
                    raise doubt
                now.value = zero.value if zero else now.by[0](*(part.value for part in now.by[1:]))
                done.append(now)
            except Unsettled as reason:
                doubt = reason
                lost.add(id(now))
        todo.pop()
    if doubt and value.value is None:
        raise doubt
