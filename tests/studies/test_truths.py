"""Published numbers are reproduced, and the page that says so is current."""

from __future__ import annotations

import math
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
import truths
from averages import Record, estimate, exponent, rate, recorded, rows, two_disc_rate
from truths import (
    COLUMNS,
    EXACT,
    PARTS,
    SIAM_DIGITS,
    STATISTICAL,
    TAIL,
    NotReproduced,
    Truth,
    line,
    main,
    near,
    put_together,
    same,
    siam,
    within,
)

from truebreak.exact import ExactEngine
from truebreak.floating import DoubleEngine
from truebreak.scenarios import Circle, Quantity, Scene, Wall, catalogue
from truebreak.scenarios.trajectory import StopReason

ALL = (*EXACT, *STATISTICAL)


def name(truth: Truth) -> str:
    return truth.title


@pytest.mark.parametrize("truth", [truth for truth in ALL if not truth.long], ids=name)
def test_a_truth_is_reproduced_as_the_page_says(truth: Truth, root: Path) -> None:
    assert line(truth) in (root / "docs" / "truths.md").read_text("utf-8")


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("truth", [truth for truth in ALL if truth.long], ids=name)
def test_a_long_truth_is_reproduced_as_the_page_says(truth: Truth, root: Path) -> None:
    assert line(truth) in (root / "docs" / "truths.md").read_text("utf-8").splitlines()


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("part", PARTS)
def test_what_stands_below_the_table_is_what_comes_out(part: str, root: Path) -> None:
    text = (root / "docs" / "truths.md").read_text("utf-8")
    assert cut_up(text)[1][part] == PARTS[part]()


def test_the_page_is_put_together_of_what_is_measured(root: Path) -> None:
    """Of nothing else: so it is current where each of its rows and parts is."""
    text = (root / "docs" / "truths.md").read_text("utf-8")
    rows, parts = cut_up(text)
    assert [row.split(" | ")[0] for row in rows] == [f"| {truth.title}" for truth in ALL]
    assert put_together(rows, parts) == text


def test_the_command_measures_rows_and_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    short = Truth("two and two", "4", "nobody", "expr 2 + 2", lambda: same("4", "4"))
    monkeypatch.setattr(truths, "EXACT", (short,))
    monkeypatch.setattr(truths, "STATISTICAL", ())
    monkeypatch.setattr(truths, "PARTS", {part: part.upper for part in PARTS})
    rows, parts = cut_up(truths.page())
    assert rows == ["| two and two | 4 | 4 | none | nobody | `expr 2 + 2` |"]
    assert parts == {part: part.upper() for part in PARTS}


def cut_up(text: str) -> tuple[list[str], dict[str, str]]:
    """The rows of the page's first table, and its parts by name."""
    table = text.split(f"{COLUMNS}\n", 1)[1].split("\n\n", 1)[0]
    pattern = re.escape(TAIL)
    for part in PARTS:
        pattern = pattern.replace(re.escape(f"{{{part}}}"), f"(?P<{part}>.*?)")
    found = re.search(f"{pattern}\\Z", text, re.DOTALL)
    assert found is not None
    return table.splitlines(), found.groupdict()


@pytest.mark.parametrize("truth", ALL, ids=name)
def test_the_page_names_every_truth(truth: Truth, root: Path) -> None:
    text = (root / "docs" / "truths.md").read_text("utf-8")
    (row,) = [row for row in text.splitlines() if row.startswith(f"| {truth.title} |")]
    assert f"| {truth.published} |" in row
    assert f"`{truth.command}`" in row


@pytest.mark.parametrize("truth", ALL, ids=name)
def test_a_command_is_of_words_that_a_shell_takes_and_measures_this_truth_alone(truth: Truth) -> None:
    words = shlex.split(truth.command)
    bare = re.sub(r'"[^"$]*"', "", truth.command)
    assert re.fullmatch(r"[\w\s.:,=/-]*", bare), bare
    if "--only" in words:
        assert [other.title for other in ALL if words[-1] in other.title] == [truth.title]


def test_what_is_not_reproduced_stops_the_command(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    wrong = Truth("two and two", "5", "nobody", "expr 2 + 2", lambda: same("4", "5"))
    monkeypatch.setattr(truths, "EXACT", (wrong,))
    assert main([str(tmp_path / "t.md")]) == 1
    assert "not reproduced: two and two: 4 is not 5" in capsys.readouterr().err
    assert not (tmp_path / "t.md").exists()
    with pytest.raises(NotReproduced):
        near(1.1, 1.0, 0.05)


def test_an_estimate_is_within_three_errors_and_says_something() -> None:
    assert within(2.0, 0.1, 1.75, 0.1)[0] == "2.000 +- 0.100"
    with pytest.raises(NotReproduced, match=r"-3\.5 standard errors off"):
        within(1.93, 0.02, 2.0, 0.05)
    with pytest.raises(NotReproduced, match=r"is more than 5\.0%"):
        within(2.0, 0.2, 2.0, 0.05)
    assert within(1.93, 0.02, 2.0, 0.05, stated=0.01)[1].endswith("errors)")


def test_the_jackknife_has_the_error_of_a_mean() -> None:
    """Where all runs are as long, a rate is a mean, and its error the scatter over the square root of how many."""
    counts = np.random.default_rng(5).poisson(30, 40)
    none = np.zeros(0)
    runs = [Record(10.0, np.linspace(0.1, 9.9, count), none, none, none) for count in counts]
    told = estimate(runs, rate)
    assert told.value == pytest.approx(counts.mean() / 10)
    assert told.error == pytest.approx(counts.std(ddof=1) / 10 / math.sqrt(40))


def test_a_record_cut_off_is_that_of_a_shorter_run() -> None:
    whole, short = (recorded(["hexagon"], until, growth=True)[0] for until in (12, 5))
    part = whole.cut(5)
    assert part.hits.tolist() == short.hits.tolist() and part.times.tolist() == short.times.tolist()
    assert part.ends.tolist() == short.ends.tolist()
    assert part.growth() == pytest.approx(short.growth())
    assert exponent([part]) == pytest.approx(short.growth()[0] / short.growth()[1])


def test_ever_longer_beginnings_are_told() -> None:
    records = recorded([f"two-in-a-box:seed={seed}" for seed in (1, 2, 3)], 16)
    told = rows("meetings", records, rate, two_disc_rate(1.0, 0.1, 0.98))
    assert [row.split(" | ")[1] for row in told] == ["0.0625", "0.25", "1", "4", "16"][-len(told) :]
    assert told[-1].split(" | ")[2] == str(sum(len(mine.hits) for mine in records))


def test_the_command_prints_those_asked_for(capsys: pytest.CaptureFixture[str], root: Path) -> None:
    assert main(["--only", "onto TWO"]) == 0
    *_, row = capsys.readouterr().out.strip().splitlines()
    assert row in (root / "docs" / "truths.md").read_text("utf-8")
    assert main(["--only", "perpetual motion"]) == 2
    assert "is in no title" in capsys.readouterr().err
    for arguments in ([], ["--only", "pi", "page.md"]):
        with pytest.raises(SystemExit) as stop:
            main(arguments)
        assert stop.value.code == 2


def test_no_folder_is_told_before_anything_is_measured(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["/nowhere/truths.md"]) == 2
    assert "there is no folder" in capsys.readouterr().err


# -- the scenes behind them


@pytest.mark.parametrize(("n", "collisions"), [(3, 4), (4, 10), (5, 15)])
def test_free_discs_collide_so_often_and_never_again(n: int, collisions: int) -> None:
    run = ExactEngine().run(catalogue.build("free-discs", n=n))
    assert (run.collisions, run.certified, run.stop.reason) == (collisions, True, StopReason.QUIET)


def test_the_photon_has_14_hits_and_doubles_have_five_digits() -> None:
    scene = catalogue.build("siam")
    run = ExactEngine().run(scene)
    assert (len(run.events), run.certified) == (14, True)
    rounded = DoubleEngine().run(scene)
    assert [event.contacts for event in rounded.events] == [event.contacts for event in run.events]
    photon = rounded.final["photon"]
    error = abs(math.hypot(float(photon.x), float(photon.y)) - float(SIAM_DIGITS))
    assert 1e-8 < error < 1e-4
    assert siam(digits=150).startswith(SIAM_DIGITS)


def test_no_mirror_within_reach_of_the_photon_is_left_out() -> None:
    """Twice as many mirrors, the same path."""
    near_run, far = catalogue.build("siam:t=4"), catalogue.build("siam:t=9")
    mine, theirs = (ExactEngine().run(scene, until=4) for scene in (near_run, far))
    assert [event.contacts for event in mine.events] == [event.contacts for event in theirs.events]
    assert mine.final["photon"].x.digits(40) == theirs.final["photon"].x.digits(40)


def test_the_walls_fold_the_triangular_lattice() -> None:
    """The time between hits of a disc is that in the lattice itself, wherever no copy of the start is needed."""
    spec = "d=3,vx=1,vy=1/7"
    cell = catalogue.build(f"hexagon:{spec}")
    ball = cell.circles[0]
    across, up = Quantity.of("3/2"), Quantity.of("3*sqrt(3)/2")
    discs = [Circle(across * (2 * i + j), up * j, m="oo", id=f"{i},{j}") for j in range(-4, 5) for i in range(-8, 9)]
    open_scene = Scene([ball, *discs])
    times = []
    for scene in (cell, open_scene):
        run = ExactEngine().run(scene, until=6)
        times.append([e.time.digits(30) for e in run.events if not isinstance(partner(scene, e.contacts[0]), Wall)])
    assert times[0] == times[1]
    assert len(times[0]) >= 2


def partner(scene: Scene, contact: tuple[str, str]) -> Circle | Wall:
    things = {str(thing.id): thing for thing in (*scene.circles, *scene.walls)}
    return things[contact[1]]


def test_the_closed_form_of_two_discs_is_the_published_figure() -> None:
    assert two_disc_rate(1.0, 0.1, 0.98) == pytest.approx(0.485268, abs=5e-7)


@pytest.mark.parametrize("policy", ["simultaneous", "sequential:order=scene", "sequential:seed=3"])
def test_a_ball_onto_one_of_two_gives_what_it_gives_by_hand(policy: str) -> None:
    run = ExactEngine().run(catalogue.build(f"cross:tie={policy}"))
    ends = [(c.vx.text(), c.vy.text()) for c in run.final.circles]
    assert ends == [("0", "0"), ("0", "1/2*sqrt(3)"), ("1/2", "0")]


def test_a_ratio_of_masses_has_the_collisions_of_its_angle() -> None:
    """ceil(pi / arctan(sqrt(m / M))) - 1, for ratios that are no squares."""
    for ratio in (2, 3, 5, 7, 10, 50):
        circles = [Circle(2, 0, id="small"), Circle(6, 0, r=2, vx=-1, m=ratio, id="big")]
        run = ExactEngine().run(Scene(circles, [Wall(0, 0, 0, 1)]))
        assert run.collisions == math.ceil(math.pi / math.atan(math.sqrt(1 / ratio)) - 1e-9) - 1
