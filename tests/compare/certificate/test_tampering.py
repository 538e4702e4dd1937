"""Certificates altered at random are refused, or still true, and then shown to be so by running their scenes again."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from copy import deepcopy
from decimal import Decimal
from pathlib import Path
from random import Random
from typing import Any

import pytest

from certificate.checkers import NODE, by_node, by_python, needs_node
from certificate.samples import samples
from truebreak.compare.certificate import CertificateError, certificate_json, certificate_of
from truebreak.exact import ExactEngine
from truebreak.scenarios import Arc, Circle, Pocket, Quantity, Scene, Segment, Wall
from truebreak.scenarios.errors import SceneError

Told = dict[str, Any]
Way = Callable[[Told, Random], None]


def parts(told: Told) -> list[Told]:
    """All that holds rounds or witnesses."""
    return [*told["instants"], told["end"]]


def two_of(told: Told, draw: Random) -> list[int]:
    """Two indices: of circles, of ends and faces of segments, and of the first wall, or of nothing."""
    scene = told["scene"]
    bars = len(scene.get("segments", ()))
    size = len(scene["circles"]) + 1
    if bars and draw.random() < 0.7:
        return [draw.randrange(size - 1), size - 1 + draw.randrange(4 * bars + len(scene.get("walls", ())))]
    return sorted(draw.sample(range(size), 2))


def swap_contact(told: Told, draw: Random) -> None:
    """A contact of an instant becomes another."""
    entry = draw.choice([entry for entry in told["instants"] if "met" in entry])
    entry["met"][draw.randrange(len(entry["met"]))] = two_of(told, draw)


def drop_contact(told: Told, draw: Random) -> None:
    """One of several contacts of an instant is left out, or a whole instant."""
    entry = draw.choice(told["instants"])
    if len(entry.get("met", [])) > 1:
        entry["met"].pop(draw.randrange(len(entry["met"])))
    else:
        told["instants"].remove(entry)


def add_contact(told: Told, draw: Random) -> None:
    """An instant gets one contact more, or comes twice."""
    place = draw.randrange(len(told["instants"]))
    entry = told["instants"][place]
    if draw.random() < 0.5:
        told["instants"].insert(place, deepcopy(entry))
    else:
        entry.setdefault("met", []).append(two_of(told, draw))


def exchange(told: Told, draw: Random) -> None:
    """Two instants change places."""
    i, j = (draw.randrange(len(told["instants"])) for _ in "ij")
    told["instants"][i], told["instants"][j] = told["instants"][j], told["instants"][i]


def move_time(told: Told, draw: Random) -> None:
    """A digit of a time or of the final state changes."""
    if draw.random() < 0.5:
        entry = draw.choice(told["instants"])
        key = draw.choice(sorted(entry.keys() & {"time", "exact"}))
        entry[key] = other_digit(entry[key], draw)
    else:
        row = draw.choice(told["final"]["circles"])
        k = draw.randrange(4)
        row[k] = other_digit(row[k], draw)


def change_impulse(told: Told, draw: Random) -> None:
    """A round loses a contact, gains one, comes twice, goes, or is split."""
    entry = draw.choice([part for part in parts(told) if part.get("rounds") or part.get("met")])
    rounds = entry.setdefault("rounds", [deepcopy(entry.get("met", []))])
    if draw.random() < 0.3 and (pushes := [push for one in rounds for push in one if len(push) > 2]):
        push = draw.choice(pushes)
        push[2] = other_digit(push[2], draw)
        return
    choice, place = draw.randrange(5), draw.randrange(len(rounds))
    if choice == 0:
        rounds[place].pop(draw.randrange(len(rounds[place])))
    elif choice == 1:
        rounds[place].append(two_of(told, draw))
    elif choice == 2:
        rounds.insert(place, deepcopy(rounds[place]))
    elif choice == 3:
        rounds.pop(place)
    else:
        rounds[place : place + 1] = [rounds[place][:1], rounds[place][1:]]


def falsify_witness(told: Told, draw: Random) -> None:
    """A witness goes, becomes another, or speaks of another contact or question; or an isometry changes."""
    holding = [part for part in parts(told) if part.get("zeros")]
    if not holding or (told["isometries"] and draw.random() < 0.3):
        if told["isometries"]:
            motion = draw.choice(told["isometries"])
            key = draw.choice(["matrix", "shift", "map"])
            if key == "map":
                draw.choice(motion["map"])[1] = draw.randrange(len(told["scene"]["circles"]))
            else:
                motion[key][draw.randrange(len(motion[key]))] = draw.choice(["0", "1", "-1", "1/2"])
        return
    zeros = draw.choice(holding)["zeros"]
    zero = draw.choice(zeros)
    choice = draw.randrange(4)
    if choice == 0:
        zeros.remove(zero)
    elif choice == 1:
        zero[2] = draw.choice(["back", 0, 1])
    elif choice == 2:
        zero[1] = two_of(told, draw)
    else:
        zero[0] = draw.choice(["gap", "closing", "disc", "speed", "slack", "until"])


def change_scene(told: Told, draw: Random) -> None:
    """A digit of the scene changes."""
    kind = draw.choice([kind for kind in ("circles", "walls", "pockets", "segments") if told["scene"].get(kind)])
    row = draw.choice(told["scene"][kind])
    key = draw.choice([key for key in row if key not in ("id", "length")])
    row[key] = other_digit(row[key], draw)


def change_end(told: Told, draw: Random) -> None:
    """Another end, or a limit that is off by one."""
    end = told["end"]
    choice = draw.randrange(3)
    if choice == 0 and "limit" in end:
        end["limit"] += draw.choice([-1, 1])
    elif choice == 1 and told["instants"]:
        told["instants"].pop()
    else:
        told["end"] = draw.choice(
            [{"reason": "quiet"}, {"reason": "horizon", "until": "3"}, {"reason": "return"}, {"reason": "stopped"}]
        )


def other_digit(text: str, draw: Random) -> str:
    """The text with one digit replaced by another, a root's number never."""
    places = [
        m.start() for m in re.finditer(r"(?<![r\d])\d|(?<=\d)\d", text) if not re.search(r"r\d*$", text[: m.start()])
    ]
    place = draw.choice(places)
    return text[:place] + draw.choice([d for d in "0123456789" if d != text[place]]) + text[place + 1 :]


WAYS = (
    swap_contact, drop_contact, add_contact, exchange, move_time, change_impulse, falsify_witness, change_scene,
    change_end,
)  # fmt: skip


def altered(
    count: int, ways: Sequence[Way] = WAYS, start: str = "tampering", of: dict[str, Told] | None = None
) -> list[tuple[str, Told]]:
    """Certificates, each altered in one way."""
    made = []
    whole = samples() if of is None else of
    usable = {name: told for name, told in whole.items() if any("met" in i for i in told["instants"])}
    for number in range(count):
        draw = Random(f"{start} {number}")
        name = draw.choice(sorted(usable))
        way = ways[number % len(ways)]
        told = deepcopy(usable[name])
        way(told, draw)
        made.append((f"{number} {way.__name__} {name}", told))
    return made


def exact_text(text: str, roots: list[str]) -> str:
    """A number of a certificate in the grammar of scene files."""
    return re.sub(r"r(\d+)", lambda m: f"sqrt({exact_text(roots[int(m[1]) - 1], roots)})", text)


def mass(inverse: str) -> str:
    """The mass of an inverse mass, however zero is written."""
    return "oo" if Quantity.of(inverse) == Quantity.of(0) else f"1/({inverse})"


def run_again(told: Told) -> Told:
    """The certificate of the engine's own run of a certificate's scene, to the same end."""
    scene, end = told["scene"], told["end"]
    roots = scene.get("roots", []) + told["roots"]

    def rows(name: str) -> list[Told]:
        return [
            {key: exact_text(v, roots) if key != "id" else v for key, v in row.items() if key not in ("w", "length")}
            | ({"m": mass(exact_text(row["w"], roots))} if "w" in row else {})
            for row in scene.get(name, ())
        ]

    def things(kind: Any, name: str, **more: Any) -> list[Any]:
        found = rows(name)
        return [kind(**row, **(more if Quantity.of(row.get("r", "1")) == Quantity.of(0) else {})) for row in found]

    built = Scene(
        things(Circle, "circles", point=True),
        things(Wall, "walls"),
        tie_policy=scene["tie_policy"],
        reverse_after=scene.get("reverse_after"),
        reverse_at=exact_text(scene["reverse_at"], roots) if "reverse_at" in scene else None,
        pockets=things(Pocket, "pockets"),
        segments=things(Segment, "segments"),
        arcs=[Arc(full="x0" not in row, **of) for row, of in zip(scene.get("arcs", ()), rows("arcs"), strict=True)],
        capture=scene.get("capture", False),
        restitution=exact_text(scene.get("restitution", "1"), roots),
        gravity=[exact_text(part, roots) for part in scene["gravity"]] if "gravity" in scene else None,
        settle=scene.get("settle", False),
    )
    until = exact_text(end["until"], roots) if end["reason"] == "horizon" else None
    count = sum(bool(rounds(part)) for part in told["instants"])
    events = {"events": count, "stopped": count, "quiet": count + 1}.get(end["reason"])
    return certificate_of(ExactEngine().run(built, until=until, events=events))


def rounds(part: Told) -> list[list[Any]]:
    """The rounds of an instant, those that go without saying included."""
    return [[push[:2] for push in one] for one in part.get("rounds", ())]


def shown_true(told: Told) -> bool:
    """Whether the engine's own run of the scene is the run that a certificate tells."""
    if told["end"]["reason"] == "stopped" and not any(map(rounds, told["instants"])):
        return True  # it tells of nothing
    ours = run_again(told)

    def history(of: Told) -> list[Any]:
        entries = of["instants"]
        return [
            (
                sorted(p.get("met", ())),
                [sorted(r) for r in rounds(p)],
                *(sorted(p.get(k, ())) for k in ("enter", "settle")),
            )
            for p in entries
            if rounds(p) or p.get("enter") or p.get("met")
        ]

    def near(mine: str, theirs: str) -> bool:
        unit = Decimal(10) ** -min(len(x.partition(".")[2]) for x in (mine, theirs))
        return abs(Decimal(mine) - Decimal(theirs)) <= 2 * unit

    if told["end"]["reason"] == "stopped":
        return history(ours)[: len(history(told))] == history(told)
    numbers = [[of["final"]["time"], *(x for row in of["final"]["circles"] for x in row)] for of in (told, ours)]
    return history(ours) == history(told) and all(map(near, *numbers))


@needs_node
@pytest.mark.parametrize("count", [90, pytest.param(1000, marks=pytest.mark.slow)])
def test_altered_certificates_are_refused_or_shown_to_be_true(count: int, tmp_path: Path) -> None:
    assert refused(altered(count), tmp_path) > count * 2 // 3


def refused(tried: list[tuple[str, Told]], folder: Path) -> int:
    """How many certificates both checkers refuse; the others are shown to be true."""
    assert NODE is not None
    paths: list[Path] = []
    for number, (_, told) in enumerate(tried):
        paths.append(folder / f"{number}.json")
        paths[-1].write_text(certificate_json(told), encoding="utf-8")
    count = 0
    for (name, told), path, (second, other) in zip(tried, paths, by_node(paths), strict=True):
        first, sentence = by_python(path)
        assert first == second or {first, second} in ({1, 4}, {0, 4}), f"{name}: {sentence}; {other}"
        if first and second:
            count += 1
            continue
        try:
            assert shown_true(told), f"{name}: {sentence}, but it is false"
        except (SceneError, CertificateError) as error:
            raise AssertionError(f"{name}: {sentence}, but {error}") from error
    return count
