"""Kinds of tampering with a certificate, each a small change: of its scene, log, witnesses, end, or how it is written.

Some leave it true: what matters is that two checkers say the same.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from copy import deepcopy
from random import Random
from typing import Any

Told = dict[str, Any]
Kind = Callable[[Told, Random], bool | None]
"""Changes a certificate in place; False where there is nothing to change."""


def circle(told: Told, draw: Random) -> Told:
    """One of the circles."""
    return draw.choice(told["scene"]["circles"])


def later(told: Told, draw: Random, *keys: str) -> Told | None:
    """An instant that has one of these keys, filled."""
    found = [entry for entry in told["instants"] if any(entry.get(key) for key in keys)]
    return draw.choice(found) if found else None


def contact(told: Told, draw: Random) -> list[int]:
    """Two indices, the first of a circle."""
    scene, n = told["scene"], len(told["scene"]["circles"])
    size = n + len(scene.get("walls", ()))
    i, j = draw.randrange(n), draw.randrange(-len(scene.get("pockets", ())), size)
    return sorted([i, j]) if 0 <= j < n else [i, j]


def little(draw: Random) -> str:
    """A term that is not zero, of any size."""
    return f"{draw.choice('+-')}{draw.choice(['1', '1/2', '1/1000', f'1/{10 ** draw.randrange(1, 90)}'])}"


def digit(text: str, draw: Random) -> str:
    """The text with one digit changed that is no root's."""
    places = [m.start() for m in re.finditer(r"\d", text) if not re.search(r"r\d*$", text[: m.start()])]
    place = draw.choice(places)
    return text[:place] + draw.choice([d for d in "0123456789" if d != text[place]]) + text[place + 1 :]


def nudged(key: str) -> Kind:
    """A number of a circle is off."""

    def kind(told: Told, draw: Random) -> None:
        circle(told, draw)[key] += little(draw)

    return kind


def turned(key: str) -> Kind:
    """A number of a circle changes its sign."""

    def kind(told: Told, draw: Random) -> bool:
        row = circle(told, draw)
        if not re.fullmatch(r"-?[\d/]+", row[key]) or row[key] == "0":
            return False
        row[key] = row[key][1:] if row[key][0] == "-" else f"-{row[key]}"
        return True

    return kind


def put(key: str, *values: str) -> Kind:
    """A number of a circle is another."""

    def kind(told: Told, draw: Random) -> None:
        circle(told, draw)[key] = draw.choice(values)

    return kind


def of_thing(name: str, key: str) -> Kind:
    """A number of a wall or a pocket is off."""

    def kind(told: Told, draw: Random) -> bool:
        things = told["scene"].get(name)
        if things:
            draw.choice(things)[key] += little(draw)
        return bool(things)

    return kind


def written(form: str) -> Kind:
    """A number of the scene is written otherwise, and is what it was."""

    def kind(told: Told, draw: Random) -> None:
        circle(told, draw)[draw.choice(["x", "y", "vx", "vy"])] += form

    return kind


def rooted(told: Told, draw: Random) -> bool:
    """A number of the scene takes roots that it does not need: the second is half of the first."""
    roots = told["scene"].setdefault("roots", [])
    if told["roots"]:  # their names would be others
        return False
    roots += ["8", "2"]
    circle(told, draw)[draw.choice(["x", "y", "vx", "vy"])] += f"+1*r{len(roots) - 1}-2*r{len(roots)}"
    return True


def exchanged(told: Told, draw: Random) -> bool:
    """Two circles change places in the list."""
    rows = told["scene"]["circles"]
    i, j = draw.randrange(len(rows)), draw.randrange(len(rows))
    rows[i], rows[j] = rows[j], rows[i]
    return i != j


def alike(told: Told, draw: Random) -> None:
    """A circle takes on a number of another."""
    one, other = circle(told, draw), circle(told, draw)
    key = draw.choice(["x", "y", "vx", "vy", "r", "w"])
    one[key] = other[key]


def far_away(told: Told, draw: Random) -> None:
    """There is a circle more, far away, at rest; or flying."""
    speed = draw.choice(["0", "0", "1"])
    told["scene"]["circles"].append(
        {"id": "more", "x": "1000000", "y": "0", "r": "1", "vx": speed, "vy": "0", "w": "1"}
    )
    told["final"]["circles"].append(["1000000.0", "0.0", f"{speed}.0", "0.0"])
    n = len(told["scene"]["circles"]) - 1
    for row in indices(told):
        row[:] = [k + 1 if isinstance(k, int) and k >= n else k for k in row]


def indices(told: Told) -> Iterator[list[Any]]:
    """All pairs of indices of a certificate."""
    for motion in told["isometries"]:
        yield from motion["map"]
    for part in (*told["instants"], told["end"]):
        yield from part.get("met", ())
        yield from part.get("enter", ())
        yield from (push for one in part.get("rounds", ()) for push in one)
        for zero in part.get("zeros", ()):
            yield zero[1]
            yield from zero[3:]


def one_less(told: Told, draw: Random) -> bool:
    """The last circle goes."""
    told["final"]["circles"].pop()
    told["scene"]["circles"].pop()
    return bool(told["scene"]["circles"])


def a_wall_more(told: Told, draw: Random) -> None:
    """There is a wall more, perhaps beyond all."""
    x = draw.choice(["5", "1000000", "-1000000"])
    told["scene"].setdefault("walls", []).append({"id": "more", "x0": x, "y0": "0", "x1": x, "y1": "1", "length": "1"})


def a_pocket_more(told: Told, draw: Random) -> None:
    """There is a pocket more, perhaps far away."""
    x, y = draw.choice(["3", "1000000"]), draw.choice(["0", "1"])
    told["scene"].setdefault("pockets", []).append({"id": "more", "x": x, "y": y, "r": "1"})


def less(name: str) -> Kind:
    """The last wall, or pocket, goes."""

    def kind(told: Told, draw: Random) -> bool:
        things = told["scene"].get(name)
        if things:
            things.pop()
        return things is not None

    return kind


def other_way_round(told: Told, draw: Random) -> bool:
    """A wall is told by its points the other way round."""
    for wall in told["scene"].get("walls", ())[:1]:
        wall["x0"], wall["x1"], wall["y0"], wall["y1"] = wall["x1"], wall["x0"], wall["y1"], wall["y0"]
    return "walls" in told["scene"]


def renamed(told: Told, draw: Random) -> None:
    """A circle has another name."""
    circle(told, draw)["id"] = draw.choice(["another", "\u00e9", "c1"])


def setting(key: str, *values: Any) -> Kind:
    """A setting of the scene is another, or goes."""

    def kind(told: Told, draw: Random) -> None:
        value = draw.choice(values)
        if value is None:
            told["scene"].pop(key, None)
        else:
            told["scene"][key] = value

    return kind


def time_digit(told: Told, draw: Random) -> None:
    """A digit of a time is another."""
    entry = draw.choice(told["instants"])
    entry["time"] = digit(entry["time"], draw)


def shorter(told: Told, draw: Random) -> None:
    """A decimal has fewer digits, or more."""
    row = draw.choice([*told["final"]["circles"], told["final"], draw.choice(told["instants"])])
    key = draw.randrange(4) if isinstance(row, list) else "time"
    row[key] = row[key][: -draw.randrange(1, 9)] if draw.random() < 0.7 else row[key] + "0"


def by_one(told: Told, draw: Random) -> None:
    """The last digit of a decimal is one more, or two."""
    row = draw.choice([*told["final"]["circles"], told["final"], draw.choice(told["instants"])])
    key = draw.randrange(4) if isinstance(row, list) else "time"
    row[key] = row[key][:-1] + str((int(row[key][-1]) + draw.choice([1, 2])) % 10)


def exact_of(change: Callable[[str, Random], str | None]) -> Kind:
    """The exact time of an instant is another, or goes."""

    def kind(told: Told, draw: Random) -> bool:
        entry = later(told, draw, "exact")
        if entry is None:
            return False
        text = change(entry["exact"], draw)
        if text is None:
            del entry["exact"]
        else:
            entry["exact"] = text
        return True

    return kind


def exact_told(told: Told, draw: Random) -> None:
    """An instant is told a time of its own: as its decimal has it, or another."""
    entry = draw.choice(told["instants"])
    whole, _, part = entry["time"].partition(".")
    entry["exact"] = draw.choice([f"{whole}{part}/{10 ** len(part)}", "1", "0"])


def turn(told: Told, draw: Random) -> None:
    """An instant becomes a reversal, or a reversal an instant."""
    entry = draw.choice(told["instants"])
    if not entry.pop("turn", False):
        entry["turn"] = True


def in_list(key: str, change: str) -> Kind:
    """A list of an instant is another."""

    def kind(told: Told, draw: Random) -> bool:
        entry = later(told, draw, key)
        if change == "more":
            entry = draw.choice(told["instants"])
            entry.setdefault(key, []).append(contact(told, draw) if key != "rounds" else [contact(told, draw)])
            return True
        if entry is None:
            return False
        rows = entry[key]
        place = draw.randrange(len(rows))
        if change == "less":
            rows.pop(place)
        elif change == "twice":
            rows.insert(draw.randrange(len(rows) + 1), deepcopy(rows[place]))
        elif change == "order":
            draw.shuffle(rows)
        elif change == "moved":
            draw.choice(told["instants"]).setdefault(key, []).append(rows.pop(place))
        elif change == "another":
            rows[place] = contact(told, draw) if key != "rounds" else [contact(told, draw)]
        else:
            del entry[key]
        if not entry.get(key):
            entry.pop(key, None)
        return True

    return kind


def pushes(change: str) -> Kind:
    """A round is another."""

    def kind(told: Told, draw: Random) -> bool:
        entry = later(told, draw, "rounds")
        if entry is None:
            return False
        rounds = entry["rounds"]
        place = draw.randrange(len(rounds))
        one = rounds[place]
        if change == "merged":
            entry["rounds"] = [[push for one in rounds for push in one]]
        elif change == "split":
            rounds[place : place + 1] = [[push] for push in one]
        elif change == "less":
            one.pop(draw.randrange(len(one)))
        elif change == "more":
            one.append(contact(told, draw) + one[0][2:])
        elif change == "backwards":
            one.reverse()
        elif change == "told":
            for push in one:
                push[2:] = ["1"] if draw.random() < 0.9 else []
        elif change == "untold":
            for push in one:
                del push[2:]
        elif change == "other":
            for push in one:
                push[2:] = [digit(text, draw) for text in push[2:]]
        return True

    return kind


def instants(change: str) -> Kind:
    """The list of instants is another."""

    def kind(told: Told, draw: Random) -> None:
        rows = told["instants"]
        place = draw.randrange(len(rows))
        if change == "less":
            rows.pop(place)
        elif change == "twice":
            rows.insert(place, deepcopy(rows[place]))
        elif change == "exchanged":
            other = draw.randrange(len(rows))
            rows[place], rows[other] = rows[other], rows[place]
        elif change == "empty":
            rows.insert(place + 1, {"time": rows[place]["time"], "exact": draw.choice(["1", "3", "10"])})
        else:
            del rows[place + 1 :]

    return kind


def from_the_start(told: Told, draw: Random) -> bool:
    """What touches at time 0 is said to meet later, at a time that is told."""
    first = told["instants"][0]
    if not first.get("met"):
        return False
    kept = first.pop("met")
    first.pop("rounds", None)
    first.pop("zeros", None)
    time = draw.choice(["1", "1/2", "3"])
    told["instants"][1:] = [{"time": f"{eval_decimal(time)}", "exact": time, "met": kept}]
    told["end"] = {"reason": "stopped"}
    told["final"]["time"] = eval_decimal(time)
    for row, state in zip(told["scene"]["circles"], told["final"]["circles"], strict=True):
        if all(re.fullmatch(r"-?\d+", row[key]) for key in ("x", "y", "vx", "vy")):
            x, y, vx, vy = (int(row[key]) for key in ("x", "y", "vx", "vy"))
            at = float(eval_decimal(time))
            state[:] = [f"{x + vx * at:.6f}", f"{y + vy * at:.6f}", f"{vx}.0", f"{vy}.0"]
    return True


def eval_decimal(text: str) -> str:
    """A fraction as a decimal."""
    top, _, bottom = text.partition("/")
    return f"{int(top) / int(bottom or 1):.6f}"


def witnesses(change: str) -> Kind:
    """A witness is another."""

    def kind(told: Told, draw: Random) -> bool:
        holding = [part for part in (*told["instants"], told["end"]) if part.get("zeros")]
        if change == "more":
            question = draw.choice(["gap", "closing", "disc", "speed", "slack", "until", "reverse"])
            how = draw.choice(["back", *range(len(told["isometries"]) + 1)])
            part = draw.choice([*told["instants"], told["end"]])
            part.setdefault("zeros", []).insert(0, [question, contact(told, draw), how])
            return True
        if not holding:
            return False
        part = draw.choice(holding)
        zero = draw.choice(part["zeros"])
        if change == "less":
            part["zeros"].remove(zero)
        elif change == "question":
            zero[0] = draw.choice(["gap", "closing", "disc", "speed", "slack", "until", "reverse"])
        elif change == "contact":
            zero[1] = contact(told, draw)
        elif change == "how":
            zero[2] = draw.choice(["back", *range(len(told["isometries"]) + 1)])
        elif change == "other":
            zero[3:] = [contact(told, draw)] if draw.random() < 0.7 else []
        else:
            part["zeros"].remove(zero)
            draw.choice([*told["instants"], told["end"]]).setdefault("zeros", []).append(zero)
        return True

    return kind


def motions(change: str) -> Kind:
    """An isometry is another."""

    def kind(told: Told, draw: Random) -> bool:
        if not told["isometries"]:
            return False
        motion = draw.choice(told["isometries"])
        place = draw.randrange(len(motion["map"])) if motion["map"] else 0
        if change == "matrix":
            motion["matrix"][draw.randrange(4)] = draw.choice(["0", "1", "-1", "3/5"])
        elif change == "shift":
            motion["shift"][draw.randrange(2)] += little(draw)
        elif change == "other":
            motion["matrix"] = draw.choice(
                [["1", "0", "0", "1"], ["-1", "0", "0", "-1"], ["3/5", "4/5", "-4/5", "3/5"]]
            )
        elif change == "transposed":
            motion["matrix"][1], motion["matrix"][2] = motion["matrix"][2], motion["matrix"][1]
        elif not motion["map"]:
            return False
        elif change == "less":
            motion["map"].pop(place)
        elif change == "image":
            motion["map"][place][1] = draw.choice(contact(told, draw))
        elif change == "more":
            motion["map"].append(contact(told, draw))
        else:
            told["isometries"].insert(0, deepcopy(motion))
        return True

    return kind


def ends(*values: Told) -> Kind:
    """Another end."""

    def kind(told: Told, draw: Random) -> None:
        told["end"] = deepcopy(draw.choice(values))

    return kind


def limit(told: Told, draw: Random) -> bool:
    """A limit of events is off by one."""
    if "limit" in told["end"]:
        told["end"]["limit"] += draw.choice([-1, 1])
    return "limit" in told["end"]


def until(told: Told, draw: Random) -> bool:
    """The end comes a little sooner, or later."""
    if "until" in told["end"]:
        told["end"]["until"] += little(draw)
    return "until" in told["end"]


def final_digit(told: Told, draw: Random) -> None:
    """A digit of the final state is another."""
    row = draw.choice(told["final"]["circles"])
    k = draw.randrange(4)
    row[k] = digit(row[k], draw)


def final_exchanged(told: Told, draw: Random) -> None:
    """Two circles change places in the final state."""
    draw.shuffle(told["final"]["circles"])


def bits(*values: int) -> Kind:
    """Other bits."""

    def kind(told: Told, draw: Random) -> None:
        told["bits"] = draw.choice(values)

    return kind


def no_sense(told: Told, draw: Random) -> None:
    """A value of another sort stands somewhere."""
    part = draw.choice([told, told["scene"], told["end"], told["final"], *told["instants"], *told["scene"]["circles"]])
    part[draw.choice(sorted(part))] = draw.choice([None, 7, -1, "1.5", "1/0", [], {}, True, "1*r9", [[0]]])


KINDS: dict[str, Kind] = {
    **{f"{key} of a circle": nudged(key) for key in ("x", "y", "vx", "vy", "r", "w")},
    **{f"{key} of a circle, turned": turned(key) for key in ("x", "y", "vx", "vy", "r", "w")},
    "at rest": put("vx", "0"), "fixed": put("w", "0"), "a point": put("r", "0"), "heavy": put("w", "1/1000", "1000"),
    **{f"{key} of a wall": of_thing("walls", key) for key in ("x0", "y0", "x1", "y1", "length")},
    **{f"{key} of a pocket": of_thing("pockets", key) for key in ("x", "y", "r")},
    "plus nothing": written("+0"), "plus and minus": written("+7/3-7/3"), "roots that it does not need": rooted,
    "circles exchanged": exchanged, "a number of another": alike, "a circle more": far_away, "a circle less": one_less,
    "a wall more": a_wall_more, "a pocket more": a_pocket_more, "a wall less": less("walls"),
    "a pocket less": less("pockets"), "a wall the other way round": other_way_round, "another name": renamed,
    "capture": setting("capture", True, False, None), "reverse_after": setting("reverse_after", 1, 2, 3, None),
    "reverse_at": setting("reverse_at", "1", "5", "20", "1000", None),
    "policy": setting("tie_policy", "simultaneous", "sequential", "sequential:seed=1", "sequential:order=scene"),
    "a digit of a time": time_digit, "other digits": shorter, "the last digit": by_one,
    "exact, off": exact_of(lambda text, draw: text + little(draw)), "exact, gone": exact_of(lambda text, draw: None),
    "exact, a digit": exact_of(digit), "exact, told": exact_told, "a turn": turn,
    **{f"{key}, {change}": in_list(key, change)
       for key in ("met", "enter") for change in ("less", "more", "twice", "order", "moved", "another", "none")},
    **{f"rounds, {change}": in_list("rounds", change)
       for change in ("less", "more", "twice", "order", "moved", "none")},
    **{f"a round, {change}": pushes(change)
       for change in ("merged", "split", "less", "more", "backwards", "told", "untold", "other")},
    **{f"instants, {change}": instants(change) for change in ("less", "twice", "exchanged", "empty", "cut")},
    "touching from the start": from_the_start,
    **{f"a witness, {change}": witnesses(change)
       for change in ("less", "more", "question", "contact", "how", "other", "moved")},
    **{f"an isometry, {change}": motions(change)
       for change in ("matrix", "shift", "other", "transposed", "less", "image", "more", "twice")},
    "quiet": ends({"reason": "quiet"}), "stopped": ends({"reason": "stopped"}), "a return": ends({"reason": "return"}),
    "a horizon": ends(*({"reason": "horizon", "until": text} for text in ("1", "10", "1000"))),
    "events": ends(*({"reason": "events", "limit": k} for k in (1, 2, 5))),
    "another limit": limit, "another horizon": until,
    "a digit of the final state": final_digit, "the final state exchanged": final_exchanged,
    "few bits": bits(1, 8, 40, 100), "many bits": bits(1000, 4000), "no sense": no_sense,
}  # fmt: skip
