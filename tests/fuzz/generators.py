"""The table of kinds: from a kind's name and a seed to a case, always the same one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from random import Random

from flint import fmpz  # type: ignore[attr-defined]

from fuzz.draft import Case, Draft, F, finish, flaw
from fuzz.ingredients import mixed
from fuzz.kinds import alike, brinks, contacts, cruel, pockets, rooms, symmetry
from fuzz.referee import Told, referee
from truebreak.scenarios import Quantity
from truebreak.scenarios.errors import SceneError

Maker = Callable[[Random], Draft]

PLAIN: dict[str, Maker] = {
    "gas": rooms.gas,
    "grid": rooms.grid,
    "instant": contacts.instant,
    "graze_blow": contacts.graze_blow,
    "raft": contacts.raft,
    "slide": rooms.slide,
    "corner": rooms.corner,
    "wedged": rooms.wedged,
    "near_ties": rooms.near_ties,
    "points": rooms.points,
    "obstacles": rooms.obstacles,
    "rim_instant": pockets.rim_instant,
    "entry_ties": pockets.entry_ties,
    "on_rim": pockets.on_rim,
    "pocket_rafts": pockets.pocket_rafts,
    "holes": pockets.holes,
    "pressed": pockets.pressed,
    "mirrored": symmetry.mirrored,
    "neighbours": symmetry.neighbours,
    "ring": symmetry.ring,
    "onto_pair": symmetry.onto_pair,
}
CRUEL: dict[str, Maker] = {
    "hairs": cruel.hairs,
    "apart": cruel.apart,
    "swift": rooms.swift,
    "pits": cruel.pits,
    "dyads": contacts.dyads,
    "couples": brinks.couples,
    "boxes": brinks.boxes,
    "rims": brinks.rims,
    "again": brinks.again,
    "spoilt": brinks.spoilt,
    "home": brinks.home,
    "strayed": brinks.strayed,
    "late": brinks.late,
    "nearest": brinks.nearest,
    "alike": alike.alike,
    "abreast": alike.abreast,
    "lanes": alike.lanes,
    "strokes": alike.strokes,
    "dips": alike.dips,
    "brushed": alike.brushed,
    "belated": alike.belated,
    "undone": alike.undone,
}

TWINS = ("instant", "graze_blow", "near_ties", "entry_ties", "on_rim", "points", "onto_pair")
"""The kinds of which twins are made."""


def twins(draw: Random) -> Draft:
    """See `kinds.symmetry.twins`."""
    return symmetry.twins(draw, [PLAIN[name] for name in TWINS])


def long(draw: Random) -> Draft:
    """A scene of another kind in numbers too long, or beside one too deep, for a field."""
    where = draw.choice([brinks.in_long_numbers, brinks.without_a_field])
    return where(PLAIN[draw.choice(list(PLAIN))](draw))


POCKETED = ("rim_instant", "entry_ties", "on_rim", "pocket_rafts", "holes", "pressed")
"""The kinds that have pockets."""


def specks(draw: Random) -> Draft:
    """A scene with pockets of which some circles are points: what their centres do is as it was."""
    draft = PLAIN[draw.choice(POCKETED)](draw)
    share = draw.choice([F(1, 3), F(2, 3), 1])
    for body in draft.bodies:
        if draw.random() < share and body.m != "oo":
            body.r, body.point = 0, True
    return draft


def ends(draw: Random) -> Case:
    """A case of another kind whose limit or reversal falls exactly on one of its own instants, or a flaw beside it."""
    case = base(draw)
    told = referee(case.scene, None if case.events else case.until, min(case.events or 6, 6))
    times = [time for knot, _ in told.knots if (time := simple(knot, told)) is not None and time > 0]
    if not times:
        return case
    time = draw.choice(times) + draw.choice([0, 0, 0, 0, flaw(draw)])
    if draw.random() < 0.5 or case.scene.reverse_at or case.scene.reverse_after:
        return replace(case, until=Quantity.of(time), events=draw.choice([None, None, case.events]))
    scene = case.scene.with_changes(reverse_at=time)
    choice = draw.random()
    if choice < 0.4:
        return Case(scene, None, None)
    if choice < 0.7:
        return Case(scene, Quantity.of(draw.choice([time, 2 * time, *times])), None)
    return Case(scene, None, draw.randrange(1, 8))


def returns(draw: Random) -> Case:
    """A case of another kind, turned back after some events or at a time, without any limit: there and back."""
    case = base(draw)
    scene = case.scene
    if draw.random() < 0.6:
        return Case(scene.with_changes(reverse_at=None, reverse_after=draw.randrange(1, 6)), None, 14)
    scene = scene.with_changes(reverse_after=None, reverse_at=draw.choice([1, 2, 3, F(5, 2)]))
    return Case(scene, None, None)


def base(draw: Random) -> Case:
    """A case of any plain kind."""
    return made(draw, PLAIN[draw.choice(list(PLAIN))], "fuzz")


def simple(value: fmpz, told: Told) -> Fraction | None:
    """The fraction of small numbers that a time is beyond reasonable doubt."""
    exact = Fraction(int(value), 1 << told.bits)
    guess = exact.limit_denominator(10**9)
    return guess if abs(exact - guess) < Fraction(1, 1 << 300) else None


COMPOSED: dict[str, Callable[[Random], Case]] = {"ends": ends, "returns": returns}
MIXED: dict[str, Maker] = {"twins": twins, "long": long, "specks": specks, "loose": rooms.loose}
KINDS: tuple[str, ...] = (*PLAIN, *MIXED, *COMPOSED, *CRUEL, "mixed")


def made(draw: Random, maker: Maker, name: str) -> Case:
    """The first scene that the drafts of a maker give."""
    for _ in range(200):
        try:
            return finish(maker(draw), draw, name)
        except SceneError:
            continue
    raise AssertionError(f"{name}: no draft is a scene")


def case_of(kind: str, seed: int) -> Case:
    """The case of a kind and a seed."""
    if kind == "mixed":
        return mixed(seed).case
    draw, name = Random(f"{kind}:{seed}"), f"{kind} {seed}"
    if kind in COMPOSED:
        found = COMPOSED[kind](draw)
        return replace(found, scene=found.scene.with_changes(name=name))
    return made(draw, {**PLAIN, **MIXED, **CRUEL}[kind], name)
