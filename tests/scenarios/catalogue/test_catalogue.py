"""The catalogue: every scene can be built, written and read, and has the properties that it claims."""

from __future__ import annotations

import subprocess
import sys
from fractions import Fraction
from itertools import pairwise
from math import isqrt

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from truebreak.scenarios import Circle, Quantity, Scene, SceneError, catalogue
from truebreak.scenarios.catalogue.scene_entry import COSINES, cosine, sine
from truebreak.scenarios.files import dump_json, dump_toml, loads_json, loads_toml

SPECS = (
    *catalogue.names(),
    *(f"article:figure={figure}" for figure in ("approach", "apart", "head-on", "giant", "floor", "slope")),
    "cradle:gap=0",
    "cradle:gap=0,r=3/10,n=9,tie=sequential:order=scene",
    "cradle:gap=sqrt(2),n=1",
    "tennis:big=2",
    "tennis:big=sqrt(5)",
    "sizes:n=5,ratio=7/2",
    "galperin:n=0",
    "galperin:n=5",
    "lee:tie=sequential:seed=7",
    "near-tie:k=1000,first=right",
    *(f"inscribed:n={n},corners={corners}" for n in (3, 4, 5, 6, 8, 10, 12) for corners in ("no", "yes")),
    "inscribed:n=5,ring=3,wall=6,r=1/2,speed=-1,spin=0",
    *(f"rack:rows={rows}" for rows in range(1, 6)),
    "rack:gap=1/100,offset=1/7,speed=30,pockets=no",
    "rack:jitter=10**-3,seed=5,tie=sequential:seed=1",
    "rack:rows=5,jitter=1/10",
    "gas:n=1",
    "gas:n=100,seed=12",
    "gas:n=20,mixed=yes,size=40",
    "reversal:n=4,after=9,mixed=yes",
    "echo:rows=3,after=7,seed=2",
    "pinball:r=0",
    "pinball:offset=10**-30",
    "pinball:discs=3",
    "pinball:discs=3,r=0,offset=-10**-9",
    "lorentz:rows=2,r=0,vy=sqrt(2)",
    "point:disc=sqrt(2),vx=3",
    *(f"grazing:angle={angle}" for angle in (0, 30, 36, 45, 60, 72, 90)),
    "grazing:miss=-10**-40",
    *(f"corner:angle={angle}" for angle in (36, 45, 60, 72, 90)),
    "corner:angle=90,skew=1/3,tie=sequential",
    "siam:t=3",
    "hexagon:d=2*sqrt(3),vx=1,vy=0",
    "two-in-a-box:r=1/5,seed=7",
    "three-disc:distance=5/2,seed=9",
    "free-discs:n=4",
    "free-discs:n=5",
    "magic-masses:a=1/2,start=one,tie=sequential",
    "cross:angle=45",
    "barrier:height=1/3,vx=3",
    "wind-tree:rows=1,side=2/3",
    "bumper:rows=5,offset=0,tie=sequential",
    "funnel:discs=3,width=5/2",
    "breakout:columns=2,rows=10",
    "ghost:segments=1",
    "corner-hit:off=0",
    "bounce:e=1/2,h=sqrt(2)",
    "drop-pair:big=2,gap=1/3",
    "falling-line:n=5,g=2",
    "wedge:slope=2,vx=0",
    "landing:h=sqrt(2),v=1/3,m=1/7",
    "struck:n=1,vx=7",
    "paddle:u=sqrt(2),h=1/2,vx=3",
    "collapse:e=1/3",
    "gas-under-gravity:n=12,seed=7",
    "stadium:straight=3,r=1/2",
    "mushroom:stem=2,y=1/2",
    "lemon:d=sqrt(2),y=1/5",
    "round-table:n=12,speed=2",
    "galton:rows=3,e=1,seed=9",
    "plinko:slot=9,off=0",
    "peg-mirror:rows=8,x=1/2,e=1/2",
    "axis:k=0,h=1/3",
    "ramp:h=sqrt(2),length=20",
    "ski-jump:v=sqrt(3),e=1",
    "platforms:vx=-100,e=1/2",
    "bowl:h=sqrt(2),off=-1/3",
    "pinball-table:v=25,e=1",
)


@pytest.mark.parametrize("spec", SPECS)
def test_every_scene_builds_and_survives_writing_and_reading(spec: str) -> None:
    scene = catalogue.build(spec)
    assert scene == catalogue.build(spec)
    assert len(set(scene.ids)) == len(scene.ids)
    assert any(limit is not None for limit in (scene.events, scene.until, scene.reverse_after))
    assert scene.description
    assert scene.source
    for again in (loads_toml(dump_toml(scene)), loads_json(dump_json(scene))):
        assert again == scene
        assert again.digest == scene.digest


@pytest.mark.parametrize("name", catalogue.names())
def test_every_entry_says_what_it_is(name: str) -> None:
    entry = catalogue.entry(name)
    assert entry.name == name
    assert entry.summary.endswith(".")
    assert entry.known.endswith(".")
    assert entry.source
    scene = catalogue.build(name)
    assert scene.name == name
    for parameter in entry.parameters:
        assert parameter.help
        assert catalogue.build(f"{name}:{parameter.name}={parameter.default}") == scene


def test_settings_are_given_as_text_or_by_name() -> None:
    assert catalogue.build("gas:n=5,seed=2") == catalogue.build("gas", n=5, seed=2)
    assert catalogue.build(" gas : n = 5 ") == catalogue.build("gas:n=5")
    assert catalogue.build("rack", pockets=False) == catalogue.build("rack:pockets=no")
    tiny = Quantity.of("10**-5")
    assert catalogue.build("pinball", offset=tiny) == catalogue.build("pinball:offset=1/100000")
    assert catalogue.build("gas:seed=2,n=5").name == "gas:n=5,seed=2"


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        (
            "craddle",
            "no scene 'craddle' in the catalogue; did you mean 'cradle'? it has: " + ", ".join(catalogue.names()),
        ),
        ("", "no scene '' in the catalogue; it has: " + ", ".join(catalogue.names())),
        (
            "galperin:m=2",
            "catalogue scene 'galperin' has no parameter 'm'; it has: n",
        ),
        (
            "cradle:gaps=2",
            "catalogue scene 'cradle' has no parameter 'gaps'; did you mean 'gap'? it has: n, r, gap, tie, e",
        ),
        ("gas:n", "catalogue scene 'gas': 'n' is not a setting; write key=value"),
        ("gas:n=1,n=2", "catalogue scene 'gas': n is set twice; keep one"),
        ("gas:n=x", "catalogue scene 'gas': n = 'x': must be a whole number from 1 to 100000"),
        ("gas:n=100001", "catalogue scene 'gas': n = '100001': must be a whole number from 1 to 100000"),
        ("gas:n=-3", "catalogue scene 'gas': n = '-3': must be a whole number from 1 to 100000"),
        ("gas:mixed=maybe", "catalogue scene 'gas': mixed = 'maybe': must be yes or no"),
        (
            "gas:n=50,size=10",
            "catalogue scene 'gas': no room for disc 15 in a box of size 10; raise size, or lower n",
        ),
        ("cradle:gap=-1", "catalogue scene 'cradle': gap = '-1': must be at least 0"),
        ("cradle:r=0", "catalogue scene 'cradle': r = '0': must be above 0"),
        (
            "cradle:r=1/0",
            "catalogue scene 'cradle': r = '1/0': '1/0' is not an exact number: division by zero",
        ),
        (
            "lee:tie=fair",
            "catalogue scene 'lee': tie = 'fair': tie_policy 'fair' is not known; "
            "choose simultaneous, sequential:order=scene or sequential:seed=N",
        ),
        ("inscribed:n=7", "catalogue scene 'inscribed': n = '7': must be one of: 3, 4, 5, 6, 8, 10, 12"),
        (
            "inscribed:ring=7",
            "catalogue scene 'inscribed': ring = 7 with r = 1 reaches the walls at 8; raise wall, or lower ring",
        ),
        (
            "inscribed:r=3",
            "catalogue scene 'inscribed': circle 'c2': overlaps 'c1' by about 2 at time 0; move it, or reduce r",
        ),
        (
            "rack:offset=21",
            "catalogue scene 'rack': ball 'cue' is not on the table; lower rows, gap, jitter or offset",
        ),
        (
            "point:disc=3",
            "catalogue scene 'point': disc = 3 fills the square of size 6; lower disc, or raise size",
        ),
    ],
)
def test_a_bad_name_or_setting_is_refused(spec: str, message: str) -> None:
    with pytest.raises(SceneError) as error:
        catalogue.build(spec)
    assert str(error.value) == message


@given(st.integers(1, 40), st.integers(0, 10**9), st.booleans())
@settings(max_examples=25)
def test_a_gas_never_overlaps_and_never_touches(n: int, seed: int, mixed: bool) -> None:
    scene = catalogue.build("gas", n=n, seed=seed, mixed=mixed)
    discs = scene.circles
    for i, a in enumerate(discs):
        for b in discs[:i]:
            assert (a.x - b.x) ** 2 + (a.y - b.y) ** 2 > (a.r + b.r) ** 2
    assert all(Fraction(1000) * (c.x.fraction or 0) % 1 == 0 for c in discs)
    assert all(c.m == c.r * c.r for c in discs)


def test_a_gas_is_the_same_everywhere() -> None:
    first = catalogue.build("gas").circles[0]
    assert (str(first.x), str(first.y), str(first.vx), str(first.vy)) == GAS_1
    assert catalogue.build("gas:seed=2") != catalogue.build("gas")


GAS_1 = ("2013/200", "3233/250", "471/500", "-111/1000")


# -- symmetry, exactly


@pytest.mark.parametrize("half_degrees", [-45, 0, 72, 300, 420, 675, 720])
def test_cosine_and_sine_are_on_the_unit_circle(half_degrees: int) -> None:
    c, s = cosine(half_degrees), sine(half_degrees)
    assert c * c + s * s == 1
    assert cosine(2 * half_degrees) == 2 * c * c - 1 if _known(2 * half_degrees) else True


def _known(half_degrees: int) -> bool:
    angle = abs((half_degrees + 360) % 720 - 360)
    return min(angle, 360 - angle) in COSINES


def test_the_table_of_cosines_is_right() -> None:
    import mpmath

    for angle, text in COSINES.items():
        with mpmath.workprec(300):
            exact = mpmath.cos(angle * mpmath.pi / 360)
            with mpmath.workprec(53):
                assert float(Quantity.of(text)) == float(+exact) or angle == 180


@pytest.mark.parametrize("corners", ["no", "yes"])
@pytest.mark.parametrize("n", [3, 4, 5, 6, 8, 10, 12])
def test_a_rotation_maps_the_inscribed_scene_to_itself(n: int, corners: str) -> None:
    scene = catalogue.build(f"inscribed:n={n},corners={corners}")
    c, s = cosine(720 // n), sine(720 // n)

    def turned(x: Quantity, y: Quantity) -> tuple[Quantity, Quantity]:
        return c * x - s * y, s * x + c * y

    for k, circle in enumerate(scene.circles):
        image = scene.circles[(k + 1) % n]
        assert turned(circle.x, circle.y) == (image.x, image.y)
        assert turned(circle.vx, circle.vy) == (image.vx, image.vy)
    for k, wall in enumerate(scene.walls):
        image = scene.walls[(k + 1) % n]
        assert turned(wall.x0, wall.y0) == (image.x0, image.y0)
        assert turned(wall.x1, wall.y1) == (image.x1, image.y1)


@pytest.mark.parametrize("n", [3, 4, 5, 6, 8, 10, 12])
def test_without_spin_a_mirror_maps_the_inscribed_scene_to_itself(n: int) -> None:
    circles = catalogue.build(f"inscribed:n={n},spin=0").circles
    for k, circle in enumerate(circles):
        image = circles[-k % n]
        assert (circle.x, -circle.y, circle.vx, -circle.vy) == (image.x, image.y, image.vx, image.vy)


@pytest.mark.parametrize("rows", range(1, 6))
@pytest.mark.parametrize("gap", ["0", "1/50"])
def test_a_mirror_maps_the_rack_to_itself(rows: int, gap: str) -> None:
    scene = catalogue.build(f"rack:rows={rows},gap={gap}")
    balls = {(c.x, c.y) for c in scene.circles}
    assert len(balls) == 1 + rows * (rows + 1) // 2
    assert {(x, 42 - y) for x, y in balls} == balls
    pockets = {(p.x, p.y, p.r) for p in scene.pockets}
    assert len(pockets) == 6
    assert {(x, 42 - y, r) for x, y, r in pockets} == pockets


def _touching(scene: Scene) -> int:
    return sum(
        (a.x - b.x) ** 2 + (a.y - b.y) ** 2 == (a.r + b.r) ** 2
        for i, a in enumerate(scene.circles)
        for b in scene.circles[:i]
    )


@pytest.mark.parametrize("rows", range(1, 6))
def test_the_balls_of_a_rack_touch_their_neighbours(rows: int) -> None:
    assert _touching(catalogue.build(f"rack:rows={rows}")) == 3 * rows * (rows - 1) // 2
    assert _touching(catalogue.build(f"rack:rows={rows},gap=10**-30")) == 0
    assert _touching(catalogue.build(f"rack:rows={rows},jitter=10**-6")) == 0


def test_the_apex_of_the_rack_is_where_the_article_has_it() -> None:
    scene = catalogue.build("rack:rows=2")
    assert [(c.x, c.y) for c in scene.circles[:2]] == [(23, 21), (69, 21)]
    assert scene.circles[2].x == Quantity.of("9*sqrt(3)/8 + 69")


def test_a_pocket_can_be_entered() -> None:
    scene = catalogue.build("rack")
    nearest = Quantity.of("9/8") * Quantity.of("sqrt(2)")
    assert all(pocket.r > nearest for pocket in scene.pockets)
    assert not scene.capture


@pytest.mark.parametrize("row", ["0", "1/10"])
def test_the_row_of_a_cradle_is_spaced_by_its_gap(row: str) -> None:
    xs = [c.x for c in catalogue.build(f"cradle:gap={row},r=7/10").circles[1:]]
    assert {b - a for a, b in pairwise(xs)} == {Quantity.of("7/5") + Quantity.of(row)}


# -- decisions on the edge, exactly


def _discriminant(a: Circle, b: Circle) -> Quantity:
    dx, dy, vx, vy = b.x - a.x, b.y - a.y, b.vx - a.vx, b.vy - a.vy
    return (vx * vx + vy * vy) * (a.r + b.r) ** 2 - (dx * vy - dy * vx) ** 2


@pytest.mark.parametrize("angle", [0, 30, 36, 45, 60, 72, 90])
def test_the_grazing_ball_grazes_exactly(angle: int) -> None:
    for miss, sign in (("0", 0), ("10**-40", -1), ("-10**-40", 1)):
        assert _discriminant(*catalogue.build(f"grazing:angle={angle},miss={miss}").circles).sign() == sign


@pytest.mark.parametrize("angle", [36, 45, 60, 72, 90])
@pytest.mark.parametrize("skew", ["0", "1/3"])
def test_the_ball_reaches_both_walls_of_the_corner_at_once(angle: int, skew: str) -> None:
    scene = catalogue.build(f"corner:angle={angle},skew={skew}")
    (ball,) = scene.circles
    for wall in scene.walls[:2]:
        nx, ny = wall.normal
        height = wall.height(ball.x + 8 * ball.vx, ball.y + 8 * ball.vy)
        assert height * height == ball.r * ball.r * (nx * nx + ny * ny)


def test_the_pinball_starts_on_its_orbit() -> None:
    ball, first, second = catalogue.build("pinball").circles
    for disc in (first, second):
        assert (disc.x - ball.x) * ball.vy == (disc.y - ball.y) * ball.vx
    ball, _, right, top = catalogue.build("pinball:discs=3").circles
    reach = ball.r + 1
    side = reach * cosine(60)
    x, y = right.x - side, right.y + reach / 2  # where the ball meets the disc on its right
    assert y == ball.y
    assert (x - right.x) ** 2 + (y - right.y) ** 2 == reach * reach
    assert (top.x, top.y - reach) == (3, Quantity.of("3*sqrt(3)") - reach)


def test_a_near_tie_is_as_near_as_it_says() -> None:
    for k in (1, 20, 1000):
        left, middle, right = catalogue.build(f"near-tie:k={k}").circles
        hit_left = middle.x - left.x - 2
        hit_right = right.x - middle.x - 3
        assert hit_right - hit_left == Quantity.of(10) ** -k


def test_the_mass_of_galperin_is_a_power_of_a_hundred() -> None:
    for n in range(6):
        scene = catalogue.build(f"galperin:n={n}")
        assert scene.circles[1].m == 100**n
        assert scene.events is not None
        assert scene.events > isqrt(10 * 100**n)  # more than pi * 10**n, as pi < sqrt(10)


def test_the_catalogue_needs_no_sympy() -> None:
    code = (
        "import sys\nfrom truebreak.scenarios import catalogue\n"
        "families = [m for m in sys.modules if m.endswith(('.rack', '.gas', '.polygon'))]\n"
        "[catalogue.build(name) for name in catalogue.names()]\n"
        "print(families, 'sympy' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[] False"
