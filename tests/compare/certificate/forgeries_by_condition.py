"""Forgeries of certificates, each of which one condition alone keeps out (test_conditions.py)."""

from __future__ import annotations

from math import isqrt
from random import Random
from typing import Any

from certificate.forging import SAME, UPSIDE_DOWN, Told, added, told
from truebreak.scenarios import Circle, Pocket, Scene, Wall

PAIR = [Circle(0, 0, vx=1), Circle(9, 0)]
STOPPED = {"reason": "stopped"}
MEET = {"met": [[0, 1]], "rounds": [[[0, 1]]]}
TURN = ({"exact": "12"}, {"turn": True})


def of(scene: Scene, *instants: Told, end: Told | None = None, **values: Any) -> Told:
    """A scene's certificate with other instants after time 0, another end and other values of the scene."""
    cert = told(scene)
    if instants:
        cert["instants"][1:] = [{"time": "0", **instant} for instant in instants]
    cert["end"] = end or cert["end"]
    cert["scene"] |= values
    return cert


def into_two_points() -> Told:
    """A disc that touches two points, of which the one alone pushes: with both, the other would pull."""
    points = [Circle(x, y, r=0, point=True, m="oo") for x, y in ((10, 0), (8, 6))]
    cert = of(Scene([Circle(0, 0, r=10, vx=1, vy="-1/2"), *points]))
    assert [[push[:2] for push in one] for one in cert["instants"][0]["rounds"]] == [[[0, 1]]]
    cert["instants"][0]["rounds"] = [[[0, 1], [0, 2]]]
    return cert


def held_to_a_floor() -> Told:
    """A disc flies into a floor, by very little; that it is mapped to itself is no sign that it does not."""
    cert = told(Scene([Circle(0, 0, vx=1)], [Wall(0, -1, 1, -1)]))
    cert["scene"]["roots"] = ["2"]
    cert["scene"]["circles"][0]["vy"] = f"{isqrt(2 * 10**140)}/{10**70}-1*r1"
    cert["isometries"] = [{**SAME, "map": [[0, 0]]}]
    cert["instants"][0]["zeros"] = [["closing", [0, 1], 0]]
    return cert


def nearly_turned() -> Told:
    """Two that touch, the one's velocity the other's turned by very little: no shift maps the one to the other."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(1, "sqrt(3)", vx=1)]))
    large = 10**70
    a, b = f"{large * large - 1}/{large * large + 1}", f"{2 * large}/{large * large + 1}"
    cert["scene"]["circles"][1] |= {"vx": a, "vy": f"-{b}"}
    cert["isometries"] = [{"matrix": [a, b, f"-{b}", a], "shift": ["1", "1*r1"], "map": [[0, 1]]}]
    cert["instants"][0]["zeros"] = [["closing", [0, 1], 0], ["speed", [0, 1], 0]]
    cert["end"] = {"reason": "stopped"}
    return cert


def taken_and_yet_there() -> Told:
    """What a pocket has taken is met by another later on."""
    scene = Scene([Circle(0, 0, vx=1), Circle(-9, 0, vx=1)], pockets=[Pocket(9, 0, 1)], capture=True)
    entry = {"met": [[0, -1]], "enter": [[0, -1]]}
    return of(scene, entry, {"met": [[0, 1]], "rounds": [[[0, 1]]]}, end={"reason": "stopped"})


def through_each_other() -> Told:
    """Two meet and are reversed at once: on the way back they meet again, which is not told."""
    cert = told(Scene(PAIR, reverse_after=1))
    del cert["instants"][2]["rounds"]
    return cert


def later_than_it_touches() -> Told:
    """Two that touch from the start, and rest, are said to come to it at 1; of time 0 nothing is told."""
    cert = touching_all_along()
    cert["instants"][0] = {"time": "0"}
    return cert


def touching_all_along() -> Told:
    """As before; what is said of time 0 is true: two that touch, and rest. That they meet again is not."""
    cert = told(Scene([Circle(0, 0), Circle(2, 0)]))
    cert["instants"].append({"time": "0", "exact": "1", "met": [[0, 1]]})
    cert["end"] = STOPPED
    return cert


def sooner() -> Told:
    """The instant after the first is not after it."""
    return of(
        Scene([*PAIR, Circle(0, 50, vx=1), Circle(9, 50)]),
        {"exact": "7", **MEET},
        {"exact": "7", "met": [[2, 3]], "rounds": [[[2, 3]]]},
        end=STOPPED,
    )


def no_gap_zero() -> Told:
    """Two are said to meet which are apart."""
    return of(
        Scene([*PAIR, Circle(50, 50, vx=1, vy=1), Circle(60, 60)]),
        {"met": [[0, 1], [2, 3]], "rounds": [[[0, 1]], [[2, 3]]]},
        end=STOPPED,
    )


def one_by_one() -> Told:
    """Of three in a line, the middle one is struck from one side, then from the other, where both push at once."""
    cert = of(Scene([Circle(-3, 0, vx=1), Circle(0, 0), Circle(3, 0, vx=-1)]), end=STOPPED)
    cert["instants"][1]["rounds"] = [[[0, 1]], [[1, 2]], [[0, 1]]]
    return cert


def nobody_enters() -> Told:
    """A circle that enters a pocket is not said to."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(50, 50)], pockets=[Pocket(9, 0, 1)]))
    del cert["instants"][1]["enter"]
    return cert


def no_isometry(**values: Any) -> Told:
    """An isometry that nothing needs is none."""
    cert = told(Scene(PAIR))
    cert["isometries"] = [{**SAME, "map": [[0, 0]], **values}]
    return cert


def events(limit: int) -> Told:
    """There are not so many events."""
    return of(Scene(PAIR), end={"reason": "events", "limit": limit})


def shifted(**values: Any) -> Told:
    """One circle is said to be another shifted, from which it differs."""
    cert = told(Scene([Circle(0, 0, vx=1, **values), Circle(9, 0, vx=1)]))
    cert["isometries"] = [{**SAME, "shift": ["9", "0"], "map": [[0, 1]]}]
    return cert


def beside_a_wall(**values: Any) -> Told:
    """A wall is said to be its own image, and is not."""
    cert = told(Scene([Circle(0, 0)], [Wall(9, 0, 9, 1)]))
    cert["isometries"] = [{**SAME, "map": [[1, 1]], **values}]
    return cert


def two_to_one() -> Told:
    """Two fixed circles at one place are said to be mapped to the one of them."""
    cert = told(Scene([Circle(0, 0), Circle(9, 0, m="oo"), Circle(19, 0, m="oo")]))
    cert["scene"]["circles"][2]["x"] = "9"
    cert["isometries"] = [{**SAME, "map": [[1, 1], [2, 1]]}]
    return cert


def centre_on_a_wall() -> Told:
    """A point starts on a wall, and so on neither side of it; it is said to leave."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(50, 50)], [Wall(-9, -1, -9, 1)]))
    cert["scene"]["walls"][0] |= {"x0": "0", "x1": "0"}
    cert["scene"]["circles"][0]["r"] = "0"
    cert["instants"] = [{"time": "0", "met": [[0, 2]]}]
    return cert


def circle_to_pocket() -> Told:
    """A fixed circle is said to be mapped to a pocket of its size where it is."""
    cert = told(Scene([Circle(0, 0), Circle(9, 0, m="oo")], pockets=[Pocket(20, 0, 1)]))
    cert["scene"]["pockets"][0]["x"] = "9"
    cert["isometries"] = [{**SAME, "map": [[1, -1]]}]
    return cert


def a_blow_that_is_not_mapped() -> Told:
    """Two heavy pairs alike, but that something light has struck one of them: they do not meet at the same time."""
    heavy = [Circle(x, y, vx=int(m > 1), m=m) for y in (0, 50) for x, m in ((0, 10**60), (9, 1))]
    discs = [*heavy, Circle(-3, 50, vx=5)]
    both = {"met": [[0, 1], [2, 3]], "rounds": [[[0, 1]], [[2, 3]]], "zeros": [["gap", [2, 3], 0]]}
    cert = of(Scene(discs), {"met": [[2, 4]], "rounds": [[[2, 4]]]}, both, end=STOPPED)
    cert["isometries"] = [{**SAME, "shift": ["0", "-50"], "map": [[2, 0], [3, 1]]}]
    return {**cert, "bits": 160}


def nothing_told(*circles: Circle, end: Told | None = None, **values: Any) -> Told:
    """Nothing is said to happen."""
    cert = of(Scene(circles or PAIR), end=end or {"reason": "quiet"}, **values)
    return {**cert, "instants": [{"time": "0"}]}


def with_data(index: int, kind: str = "circles", **values: str) -> Told:
    """Circles at rest, and a wall, whose data are otherwise."""
    cert = told(Scene([Circle(0, 0), Circle(9, 0, m="oo")], [Wall(-9, 0, -9, 1)]))
    cert["scene"][kind][index] |= values
    return cert


def a_time_at_the_start() -> Told:
    """Time 0 is said to be another."""
    cert = told(Scene(PAIR))
    cert["instants"][0]["exact"] = "5"
    return cert


def listed_twice() -> Told:
    """Two that touch are listed twice."""
    cert = told(Scene([Circle(0, 0), Circle(2, 0)]))
    cert["instants"][0]["met"] *= 2
    return cert


def an_overlap_that_ends() -> Told:
    """Two that overlap are said to meet where they part."""
    cert = told(Scene([Circle(0, 0), Circle(9, 0, vx=1)]))
    cert["scene"]["circles"][1]["x"] = "1"
    cert["instants"].append({"time": "0", "exact": "1", "met": [[0, 1]]})
    return cert


def a_round_too_many() -> Told:
    """A blow is told twice."""
    cert = told(Scene(PAIR))
    cert["instants"][1]["rounds"] *= 2
    return cert


def what_does_not_approach_pushes() -> Told:
    """Of three in a row, of which two touch, both contacts are said to push at once: only the one approaches."""
    cert = of(Scene([*PAIR, Circle(11, 0)]), end=STOPPED)
    cert["instants"][1] |= {"exact": "7", "rounds": [[[0, 1, "2/3"], [1, 2, "1/3"]]]}
    return cert


def pushed_by_halves() -> Told:
    """An impulse is told in two halves."""
    return of(Scene(PAIR), {"met": [[0, 1]], "rounds": [[[0, 1, "1/4"], [0, 1, "1/4"]]]}, end=STOPPED)


def another_draw() -> Told:
    """The first of two contacts pushes where the seed takes the second."""
    seed = next(k for k in range(99) if Random(k).randrange(2))
    scene = Scene([Circle(-3, 0, vx=1), Circle(0, 0), Circle(3, 0, vx=-1)], tie_policy="sequential")
    return of(scene, tie_policy=f"sequential:seed={seed}", end=STOPPED)


def through_a_third() -> Told:
    """A third circle is in the way of two that meet."""
    cert = of(Scene([*PAIR, Circle("9/2", 50)]), MEET, end=STOPPED)
    cert["scene"]["circles"][2]["y"] = "0"
    return cert


def nearly_alike() -> Told:
    """Of two pairs, one meets a little later; the identity is said to take it to the other."""
    cert = of(
        Scene([Circle(0, 0, vx=1), Circle(4, 1), Circle(0, 9, vx=1), Circle(4, 10)]),
        {"met": [[0, 1], [2, 3]], "rounds": [[[0, 1]], [[2, 3]]], "zeros": [["gap", [2, 3], 0]]},
        end=STOPPED,
    )
    added(cert, 3, "x")
    cert["isometries"] = [{**SAME, "map": [[k, k] for k in range(4)]}]
    return cert


def beyond_the_end_of_a_horizon() -> Told:
    """A horizon at which two overlap."""
    return nothing_told(end={"reason": "horizon", "until": "8"})


# -- of bare parts, which no run of the engine has


def bare(*rows: tuple[str | int, ...], bits: int = 160, **values: Any) -> Told:
    """A certificate of which nothing is told; a circle is x, y, vx, vy and perhaps r and one over its mass."""
    keys = ("x", "y", "vx", "vy", "r", "w")
    numbers = (dict(zip(keys, map(str, (*row, 1, 1)[:6]), strict=True)) for row in rows)
    circles = [{"id": str(k), **row} for k, row in enumerate(numbers)]
    scene = {"tie_policy": "simultaneous", "circles": circles, **values.pop("scene", {})}
    final = {"time": "0", "circles": [["0"] * 4 for _ in rows]}
    parts = {"roots": [], "isometries": [], "end": STOPPED, "final": final, "bits": bits}
    return {
        "format": "truebreak/certificate-3",
        "writer": "forger",
        "scene": scene,
        "instants": [{"time": "0"}],
        **parts,
        **values,
    }


def entries(cert: Told, first: Told | None = None, *later: Told) -> Told:
    """The same with other instants."""
    cert["instants"] = [{"time": "0", **entry} for entry in (first or {}, *later)]
    return cert


def root_of_less_than_nothing() -> Told:
    """A sum of rounded roots is a little more than their sum is, from which it is taken away."""
    primes, scale = (2, 3, 5, 7, 11, 13, 17, 19), 1 << 160
    least = sum(isqrt(k << 320) for k in primes)
    assert sum(isqrt(k << 640) for k in primes) >> 160 > least + 1
    roots = [*map(str, primes), f"{least + 1}/{scale}" + "".join(f"-1*r{k + 1}" for k in range(len(primes)))]
    return bare((0, 0, 0, 0), roots=roots)


def small(bits: int) -> str:
    """One over a power of two."""
    return f"1/{1 << bits}"


def hardly_closing_by_its_image() -> Told:
    """Of two pairs alike that approach by very little, one is said not to; the other's velocity is told exactly."""
    e, half, v = small(150), "1/2*r1", 1 << 22
    late = f"{7}/{1 << 151}*r1"
    cert = bare(
        ("50*r1", "50*r1", f"{v // 2}*r1", f"{v // 2}*r1"),
        (f"109/2*r1+{late}", f"95/2*r1+{late}", f"{v - 1}/2*r1-{small(151)}*r1", f"{v + 1}/2*r1-{small(151)}*r1"),
        (100, 0, v, 0), (f"102+7/{1 << 150}", -7, f"{v}-{e}", 1), (0, -1000, 1, 0), (9, -1000, 0, 0),
        scene={"roots": ["2"]},
    )  # fmt: skip
    motion = {"matrix": [half, half, f"-{half}", half], "shift": ["0", "0"], "map": [[0, 2], [1, 3]]}
    zeros = [[question, [0, 1], 0, [2, 3]] for question in ("gap", "closing")]
    met = {"met": [[4, 5], [2, 3], [0, 1]], "rounds": [[[2, 3]], [[4, 5]]], "zeros": zeros}
    return entries({**cert, "isometries": [motion]}, None, met)


def not_closing_as_before_the_round() -> Told:
    """A blow sends two circles, mirror images, at one more each, by very little; before it those were at rest."""
    t = 10**70
    c, s = f"{t * t - 1}/{t * t + 1}", f"{2 * t}/{t * t + 1}"
    third = (f"6/5-{mul(c, 8, 5)}+{mul(s, 6, 5)}", f"8/5+{mul(c, 6, 5)}+{mul(s, 8, 5)}")
    below = (third[0], negative(third[1]))
    cert = bare((0, 0, 1, 0), ("6/5", "8/5", 0, 0), ("6/5", "-8/5", 0, 0), (*third, 0, 0), (*below, 0, 0))
    cert["isometries"] = [{**UPSIDE_DOWN, "map": [[0, 0], [1, 2], [2, 1], [3, 4], [4, 3]]}]
    zeros = [["closing", [1, 3], 0, [2, 4]], ["closing", [2, 4], 0, [1, 3]]]
    met = [[0, 1], [0, 2], [1, 3], [2, 4]]
    return entries(cert, {"met": met, "rounds": [[[0, 1], [0, 2]]], "zeros": zeros})


def mul(fraction: str, by: int, over: int) -> str:
    """A fraction times another one."""
    top, bottom = map(int, fraction.split("/"))
    return f"{top * by}/{bottom * over}"


def negative(number: str) -> str:
    """Minus a number."""
    turned = number.translate({ord("+"): "-", ord("-"): "+"})
    return turned[1:] if turned[0] == "+" else turned if turned[0] == "-" else f"-{turned}"


def together_after_a_graze() -> Told:
    """Two graze; later on each is struck, at one time. That is two rounds, not one: they do not hang together."""
    circles = [Circle(-6, 1, vx=3), Circle(0, 1, vx=1), Circle(0, -1, vx=-1), Circle(-2, -5, vy=1)]
    both = {"exact": "2", "met": [[0, 1], [2, 3]], "rounds": [[[0, 1], [2, 3]]]}
    return of(Scene(circles), both, end=STOPPED)


def apart_at_a_shared_one() -> Told:
    """Two hit a fixed one at once: that is one round, not two."""
    cert = of(Scene([Circle(-9, 0, vx=1), Circle(0, 0, m="oo"), Circle(9, 0, vx=-1)]), end=STOPPED)
    cert["instants"][1]["rounds"] = [[[0, 1]], [[1, 2]]]
    return cert


TWO = [Circle(0, 0, vx=1), Circle(9, 0), Circle(0, 50, vx=1), Circle(9, 50)]


def groups(*rounds: list[list[int]]) -> Told:
    """Two pairs meet at once, each by itself; their rounds are others."""
    cert = of(Scene(TWO), end=STOPPED)
    cert["instants"][1]["rounds"] = list(rounds)
    return cert


def the_last_first() -> Told:
    """Of three in a row struck from both sides, one after the other, the last contact is taken first."""
    scene = Scene([Circle(-3, 0, vx=1), Circle(0, 0), Circle(3, 0, vx=-1)], tie_policy="sequential")
    cert = of(scene, end=STOPPED)
    assert cert["instants"][1]["rounds"] == [[[0, 1]], [[1, 2]], [[0, 1]]]
    cert["instants"][1]["rounds"] = [[[1, 2]], [[0, 1]], [[1, 2]]]
    return cert


def a_blow_that_is_not_passed_on() -> Told:
    """Of three in a row that touch, the first is struck; that the others push each other is not told."""
    cert = of(Scene([Circle(-2, 0, vx=1), Circle(0, 0), Circle(2, 0)], tie_policy="sequential"), end=STOPPED)
    cert["instants"][0]["rounds"] = cert["instants"][0]["rounds"][:1]
    return cert


def met_again_after_a_wall() -> Told:
    """What has parted comes back from a wall, and meets again, which is not told."""
    cert = of(Scene([*PAIR, Circle(20, 50)], [Wall(15, 0, 15, 1)]))
    assert [entry.get("met") for entry in cert["instants"][:4]] == [None, [[0, 1]], [[1, 3]], [[0, 1]]]
    return {**cert, "instants": cert["instants"][:3], "end": {"reason": "horizon", "until": "20"}}


def beyond_a_horizon() -> Told:
    """A meeting after the end of the run."""
    return of(Scene(PAIR), MEET, end={"reason": "horizon", "until": "5"})


def lasting_though_pushed() -> Told:
    """Two rest side by side; one is struck, and leaves; that both are struck at one time later on is not one round."""
    circles = [Circle(0, 0), Circle(2, 0), Circle(2, -9, vy=1), Circle(-60, 0, vx=1), Circle(-58, 51, vx=1)]
    both = {"exact": "58", "met": [[0, 3], [1, 4]], "rounds": [[[0, 3], [1, 4]]]}
    return of(Scene(circles), {"exact": "7", "met": [[1, 2]], "rounds": [[[1, 2]]]}, both, end=STOPPED)


def fixed_ones_meet() -> Told:
    """Two fixed circles that touch are listed."""
    cert = of(Scene([Circle(0, 0, m="oo"), Circle(9, 0, m="oo"), Circle(50, 50)]), end=STOPPED)
    cert["scene"]["circles"][1]["x"] = "2"
    return entries(cert, {"met": [[0, 1]]})


def two_points_meet() -> Told:
    """Two points at one place are listed."""
    return entries(bare((0, 0, 0, 0, 0), (0, 0, 1, 0, 0), (9, 9, 0, 0)), {"met": [[0, 1]]})


def struck_out_with_what_it_hit() -> Told:
    """Of two rows alike, the striker of one is struck from behind at the time at which it strikes, and so strikes a
    little harder; what it has struck is said to meet the next when its copy does."""
    v, d = f"{1 << 40}*r1", small(140)
    start = f"12+{1 << 43}*r1"
    row = [(0, 1), (9, 0), (start, f"-{v}")]
    first = (f"-2-7/{1 << 140}", 0, f"1+{d}", 0, 1, 1024)
    cert = bare(first, *((x, y, u, 0) for y in (0, 50) for x, u in row))
    cert["scene"] |= {"roots": ["2"], "tie_policy": "sequential"}
    cert["isometries"] = [{**SAME, "shift": ["0", "50"], "map": [[1, 4], [2, 5], [3, 6]]}]
    struck = {"exact": "7", "met": [[0, 1], [1, 2], [4, 5]], "rounds": [[[0, 1]], [[1, 2]], [[0, 1]], [[4, 5]]]}
    zeros = [["gap", [2, 3], 0]]
    return entries(cert, None, struck, {"met": [[5, 6], [2, 3]], "rounds": [[[2, 3]], [[5, 6]]], "zeros": zeros})


def a_mirror_of_another() -> Told:
    """A disc flies into a floor, by very little; a mirror along the floor maps it to another one, not to itself."""
    down = f"{isqrt(2 * 10**140)}/{10**70}-1*r1"
    cert = bare((0, 0, 1, down), (10, 20, 1, negative(down)), scene={"roots": ["2"]})
    floor = {"id": "w", "x0": "0", "y0": "-1", "x1": "1", "y1": "-1", "length": "1"}
    cert["scene"]["walls"], cert["isometries"] = [floor], [{**UPSIDE_DOWN, "shift": ["10", "20"], "map": [[0, 1]]}]
    return entries(cert, {"met": [[0, 2]], "zeros": [["closing", [0, 2], 0]]})


def with_a_pocket(radius: str) -> Told:
    """A pocket's radius is another."""
    cert = told(Scene([Circle(0, 0), Circle(9, 0)], pockets=[Pocket(20, 0, 1)]))
    cert["scene"]["pockets"][0]["r"] = radius
    return cert


def of_no_sense(**values: Any) -> Told:
    """Circles at rest, and something in the file that has no sense."""
    cert = bare((0, 0, 0, 0), (9, 0, 0, 0))
    cert["scene"] |= values.pop("scene", {})
    return {**cert, **values}


# -- the way back

SLOW, E = 1 << 20, small(150)


def back(*rows: tuple[str | int, ...], gap: str = "", other: Told | None = None, **values: Any) -> Told:
    """Two pairs that touch and part; one slowly and aslant, so that intervals tell the time of its return badly."""
    first = (f"6/5{gap}", "8/5", f"1/{SLOW}", 0)
    cert = bare((0, 0, 0, 0), first, *rows, scene={"reverse_at": "5"}, **values)
    met = [[0, 1]] * (not gap) + [[2, 3]] * (len(rows) > 1)
    last = {"met": [[0, 1], [2, 3]], "zeros": [["gap", [2, 3], "back"]], "rounds": [[[0, 1]], [[2, 3]]]}
    start = {"met": met} if met else {}
    return entries(cert, start, {"exact": "5"}, {"turn": True}, {**last, **(other or {})})


def hardly_closing_on_the_way_back() -> Told:
    """One pair comes back by very little; that it does not is said to be shown by the way back."""
    zeros = [[question, [2, 3], "back"] for question in ("gap", "closing")]
    return back((0, 50, 0, 0), (2, 50, E, 1), other={"zeros": zeros, "rounds": [[[0, 1]]]})


def what_was_hardly_apart() -> Told:
    """One pair was apart at time 0, by very little."""
    cert = back((0, 50, 0, 0), (f"2+{E}", 50, 1, 0))
    cert["instants"][0]["met"] = [[0, 1]]
    return cert


def by_what_was_hardly_apart() -> Told:
    """The other way round: what comes back at its time was apart at time 0."""
    return back((0, 50, 0, 0), (2, 50, 1, 1), gap=f"+{E}")


def after_a_horizon_by_the_way_back() -> Told:
    """What touched at time 0 comes back, a little after the end of the run."""
    last = {"met": [[0, 1]], "zeros": [["until", [0, 1], "back"]], "rounds": [[[0, 1]]]}
    return back(other=last, end={"reason": "horizon", "until": f"10-{E}"})


def by_a_rim_that_is_crossed_twice() -> Told:
    """A centre crosses a rim twice within a very short time; what touched when it entered is said to come when
    it enters on the way back, which is when it left."""
    fast = f"{1 << 300}*r1"
    pocket = {"id": "p", "x": "0", "y": "49", "r": "1"}
    cert = bare((0, 50, 1, f"-{E}"), (0, 0, fast, 0), (2, 0, f"{fast}+1", 0), bits=400)
    cert["scene"] |= {"roots": ["2"], "reverse_at": "5", "pockets": [pocket]}
    start = {"met": [[0, -1], [1, 2]], "enter": [[0, -1]]}
    last = {**start, "zeros": [["gap", [1, 2], "back"]], "rounds": [[[1, 2]]]}
    return entries(cert, start, {"exact": "5"}, {"turn": True}, last)


def the_same_order_back() -> Told:
    """Two copies of a heavy disc struck from both sides, the left one first; on the way back it is so again,
    which does not undo it. What comes then is no way back, though the copies stay tied."""

    def copy(y: int) -> list[Circle]:
        return [Circle(-3, y, vx=-1), Circle(0, y, m=1000), Circle(19, y, vx=-1)]

    scene = Scene([*copy(0), *copy(50)], [Wall(-12, 0, -12, 1)], reverse_at=18, tie_policy="sequential:order=scene")
    cert = told(scene, events=4)
    rounds = [entry.get("rounds") for entry in cert["instants"]]
    assert rounds[2] == rounds[5] == [[[0, 1]], [[1, 2]], [[3, 4]], [[4, 5]]] and len(rounds) == 7
    cert["end"], last = STOPPED, cert["instants"][-1]
    assert last["met"] == [[0, 6], [3, 6]]
    last["zeros"] = [["gap", [3, 6], "back"]]
    return cert


def met_at_a_reversal() -> Told:
    """A centre comes to a rim just when the run is reversed; it is said to meet it at the reversal too."""
    scene = Scene([Circle(0, 0, vx=1), Circle(50, 50)], pockets=[Pocket(9, 0, 1)], reverse_at=8)
    rim = {"met": [[0, -1]]}
    return of(scene, {"exact": "8", **rim, "enter": [[0, -1]]}, {"turn": True, **rim}, end=STOPPED)


def unshown(cert: Told) -> Told:
    """A certificate without witnesses."""
    for part in (*cert["instants"], cert["end"]):
        part.pop("zeros", None)
    return cert


def hardly_a_hit() -> Told:
    """Two that hit by very little are not said to."""
    cert = told(Scene([Circle(0, 0, vx=1), Circle(9, 3), Circle(40, 0)]), events=1)
    cert["scene"] |= {"roots": ["2"]}
    cert["scene"]["circles"][1]["y"] = f"2+1*r1-{isqrt(2 * 10**140) + 1}/{10**70}"
    return unshown({**cert, "bits": 160})
