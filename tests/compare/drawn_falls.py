"""Scenes drawn from a seed, most under gravity: in boxes, among pegs and edges, with rests and pockets."""

from __future__ import annotations

from random import Random

from truebreak.scenarios import Arc, Circle, Pocket, Polygon, Scene, Segment, Wall


def fallen(seed: int) -> Scene:
    """Three discs in a box with gravity or without, of some restitution, whose right wall may move."""
    draw = Random(f"fallen {seed}")
    discs = [
        Circle(
            f"{2 * k + 1} + {draw.randint(0, 60)}/100", f"{2 + 2 * k} + {draw.randint(0, 90)}/100", "1/2",
            f"{draw.randint(-100, 100)}/100", f"{draw.randint(-100, 100)}/100",
        )
        for k in range(3)
    ]  # fmt: skip
    right = Wall(8, 0, 8, 1, id="right", vx="-1/8" if draw.random() < 0.3 else 0)
    walls = [Wall(0, 0, 1, 0, id="floor"), Wall(0, 0, 0, 1, id="left"), right]
    pull = None if draw.random() < 0.2 else draw.choice(((0, -1), (0, "-1/3"), ("1/7", -3)))
    return Scene(discs, walls, gravity=pull, restitution=draw.choice((1, "9/10", "3/4")), name=f"fallen {seed}")


def pegged(seed: int) -> Scene:
    """Two discs that fall among pegs in a box, of some restitution."""
    draw = Random(f"pegged {seed}")
    discs = [
        Circle(
            f"{2 + 2 * k} + {draw.randint(0, 90)}/100", f"7 + {draw.randint(0, 90)}/100", "2/5",
            f"{draw.randint(-50, 50)}/100", f"{draw.randint(-50, 50)}/100", id=f"disc {k}",
        )
        for k in range(2)
    ]  # fmt: skip
    pegs = [
        Circle(f"{2 * k + 1 + j} + {draw.randint(0, 30)}/100", 2 + 2 * j, "1/5", m="oo", id=f"peg {k},{j}")
        for j in range(2)
        for k in range(3)
    ]
    walls = [Wall(0, 0, 1, 0, id="floor"), Wall(0, 0, 0, 1, id="left"), Wall(7, 0, 7, 1, id="right")]
    pull = draw.choice(((0, -1), (0, "-1/3"), ("1/7", -3)))
    restitution = draw.choice((1, "9/10", "3/4"))
    return Scene([*discs, *pegs], walls, gravity=pull, restitution=restitution, name=f"pegged {seed}")


def edged(seed: int) -> Scene:
    """Two discs that fall onto a ramp, a thick bar, a polygon that may have a notch, and a bow, in a box."""
    draw = Random(f"edged {seed}")

    def some(low: int, high: int) -> str:
        return f"{draw.randint(100 * low, 100 * high)}/100"

    discs = [
        Circle(f"{2 + 3 * k} + {some(0, 1)}", f"8 + {some(0, 1)}", "2/5", some(-1, 1), some(-1, 1), id=f"disc {k}")
        for k in range(2)
    ]
    ramp = Segment("1/2", f"4 + {some(0, 1)}", "5/2", f"3 + {some(0, 1)}", id="ramp", r=draw.choice((0, "1/8")))
    bar = Segment(
        f"4 + {some(0, 1)}", "5", f"6 + {some(0, 1)}", f"5 + {some(0, 1)}", id="bar", r=draw.choice((0, "1/7"))
    )
    notch = [("3/2", "3/2")] if draw.random() < 0.5 else []
    block = Polygon([("1/2", "1/2"), ("5/2", "1/2"), ("5/2", f"1 + {some(0, 1)}"), *notch, ("1/2", 2)], id="block")
    bow = Arc(5, 3, "3/2", id="bow", x0="7/2", y0=f"2 + {some(0, 1)}", x1="13/2", y1=3)
    walls = [Wall(0, 0, 1, 0, id="floor"), Wall(0, 0, 0, 1, id="left"), Wall(8, 0, 8, 1, id="right")]
    return Scene(
        discs, walls, segments=[ramp, bar], polygons=[block], arcs=[bow] if draw.random() < 0.7 else [],
        gravity=draw.choice(((0, -1), (0, "-1/3"), ("1/7", -3))), restitution=draw.choice((1, "9/10", "3/4")),
        name=f"edged {seed}",
    )  # fmt: skip


def pocketed(seed: int) -> Scene:
    """Four discs in a box, with gravity or without, and two pockets near its floor that take them out of play."""
    draw = Random(f"pocketed {seed}")
    discs = [
        Circle(
            f"{2 + 5 * k}", f"{draw.randint(12, 18)}", f"{draw.randint(10, 90)}/200",
            f"{draw.randint(-9, 9)}/3", f"{draw.randint(-9, 9)}/4", m=draw.randint(1, 3),
        )
        for k in range(4)
    ]  # fmt: skip
    pockets = [Pocket(draw.randint(3, 17), draw.randint(1, 8), f"{draw.randint(20, 60)}/40") for _ in range(2)]
    walls = [Wall(0, 0, 20, 0), Wall(0, 0, 0, 20), Wall(20, 0, 20, 20), Wall(0, 20, 20, 20)]
    pull = draw.choice((None, None, (0, -2)))
    e = 1 if pull is None else draw.choice((1, 1, "9/10"))
    return Scene(discs, walls, pockets=pockets, capture=True, gravity=pull, restitution=e, name=f"pocketed {seed}")


def shifting(seed: int) -> Scene:
    """Two discs in a box, with gravity or without, among a bar and a block that move, each its own way."""
    draw = Random(f"shifting {seed}")

    def some(low: int, high: int) -> str:
        return f"{draw.randint(100 * low, 100 * high)}/100"

    discs = [
        Circle(f"{2 + 5 * k} + {some(0, 1)}", f"7 + {some(0, 1)}", "2/5", some(-1, 1), some(-1, 1), id=f"disc {k}")
        for k in range(2)
    ]
    bar = Segment(
        f"1 + {some(0, 1)}", f"4 + {some(0, 1)}", f"4 + {some(0, 1)}", f"4 + {some(0, 1)}", id="bar",
        r=draw.choice((0, "1/8")), vx=f"{draw.randint(-9, 9)}/60", vy=f"{draw.randint(-9, 9)}/60",
    )  # fmt: skip
    block = Polygon(
        [(6, 2), ("15/2", 2), ("15/2", f"2 + {some(1, 2)}"), (6, f"2 + {some(1, 2)}")], id="block",
        vx=f"{draw.randint(-9, 9)}/60", vy=f"{draw.randint(-9, 9)}/90",
    )  # fmt: skip
    walls = [Wall(0, 0, 1, 0, id="floor"), Wall(-1, 0, -1, 1, id="left"), Wall(10, 0, 10, 1, id="right"),
             Wall(0, 10, 1, 10, id="top")]  # fmt: skip
    e = draw.choice((1, 1, "9/10"))
    pull = draw.choice((None, None, (0, "-1/3"), ("1/7", -1)))
    return Scene(discs, walls, segments=[bar], polygons=[block], gravity=pull, restitution=e, until=9,
                 name=f"shifting {seed}")  # fmt: skip


def settled(seed: int) -> Scene:
    """Discs that lie on a floor between two walls, or slide along it, and some that fall onto them."""
    draw = Random(f"settled {seed}")

    def some(low: int, high: int) -> str:
        return f"{draw.randint(100 * low, 100 * high)}/100"

    lying = [
        Circle(f"{3 * k} + {some(0, 1)}/2", r := draw.choice(("1", "3/4", "sqrt(2)/2")), r,
               draw.choice(("0", "0", some(-2, 2))), 0, draw.choice(("1", "2", "1/3")), id=f"lies {k}")
        for k in range(draw.randint(1, 3))
    ]  # fmt: skip
    high = [
        Circle(
            f"{4 * k - 2} + {some(0, 1)}",
            f"{4 + 3 * k} + {some(0, 1)}",
            "1/2",
            some(0, 2),
            some(-1, 1),
            id=f"falls {k}",
        )
        for k in range(draw.randint(1, 3))
    ]
    walls = [Wall(0, 0, 1, 0, id="floor"), Wall(-4, 0, -4, 1, id="left"), Wall(11, 0, 11, 1, id="right")]
    e, pull = draw.choice((0, 0, "1/2", 1)), draw.choice(((0, -10), (0, "-1"), (0, "-sqrt(3)")))
    return Scene(lying + high, walls, gravity=pull, restitution=e, settle=True, until=40, name=f"settled {seed}")


def sticking(seed: int) -> Scene:
    """Three discs at restitution 0 without gravity, and a peg, a thick bar, or nothing else; a wall may move."""
    draw = Random(f"sticking {seed}")
    discs = [
        Circle(
            f"{2 * k + 1} + {draw.randint(0, 60)}/100", f"{1 + 2 * k} + {draw.randint(0, 90)}/100", "1/2",
            f"{draw.randint(-200, 200)}/100", f"{draw.randint(-200, 200)}/100",
        )
        for k in range(3)
    ]  # fmt: skip
    beside = draw.choice(("", "peg", "bar"))
    pegs = [Circle(f"6 + {draw.randint(0, 90)}/100", 2, "1/4", m="oo", id="peg")] if beside == "peg" else []
    bar = Segment("1/2", f"5 + {draw.randint(0, 90)}/100", 3, f"6 + {draw.randint(0, 90)}/100", id="bar", r="1/8")
    right = Wall(9, 0, 9, 1, id="right", vx="-1/8" if draw.random() < 0.3 else 0)
    walls = [Wall(0, 0, 1, 0, id="floor"), Wall(0, 8, 1, 8, id="top"), Wall(0, 0, 0, 1, id="left"), right]
    bars = [bar] if beside == "bar" else []
    return Scene([*discs, *pegs], walls, segments=bars, restitution=0, name=f"sticking {seed}")
