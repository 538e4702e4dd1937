"""What the page asks and what it is answered: plain data both ways, the same from a server and within a browser.

A message has a `kind`, one of `KINDS`, and the answers are said one after the other: `progress` as often as wanted,
then one last. Needs python-flint and nothing else for what is asked of `exact` and `double`.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from importlib import util
from typing import TYPE_CHECKING, Any, TypeAlias

from ...exact import ExactEngine
from ...floating import DoubleEngine
from ...scenarios import catalogue
from ...scenarios.errors import SceneError, cut
from ...scenarios.files import JSON_LIST, dump_toml, scene_from_table
from ...scenarios.numbers.quantity import Quantity
from ...scenarios.pictures import scene_picture
from ...scenarios.scene import Scene
from ...scenarios.things import Circle
from ...scenarios.trajectory import StopReason
from ..alignment.align import Span, align, return_miss, separation
from ..comparison import compare
from ..deadline import OutOfTime, time_limit
from ..report.answers import answers, scene_word, verdict_line
from ..report.player import recording

if TYPE_CHECKING:
    from ...scenarios.trajectory import Progress, Trajectory
    from ..comparison import Comparison

Message: TypeAlias = Mapping[str, Any]
Say: TypeAlias = Callable[[dict[str, Any]], None]

ENGINES_PLAYED = ("double", "quad", "single", "rounded", "interval", "pymunk")
"""What may be asked to run beside the exact engine: names alone, since a path to a class would run anybody's code."""

WITHOUT_NUMPY = ("double", "quad")
"""Those of them that run where there is no NumPy: in a browser."""

MOST_CIRCLES, MOST_OTHERS = 400, 400
"""Circles, and walls, segments, polygons, arcs and pockets, of a scene that is played: more can hardly be seen."""

MOST_CORNERS = 100
"""Corners of one polygon that is played."""

MOST_NUMBERS = 400
"""Characters of one number: a page is there to type in, not to load into."""

MOST_EVENTS, DEFAULT_EVENTS = 5_000, 300
MOST_SECONDS, DEFAULT_SECONDS = 60.0, 10.0

READING_SHARE = 0.15
"""Share of the seconds that is kept for what follows the comparison: its recording, and the words."""

SAID_EVERY = 0.1
"""Seconds between two reports of progress."""


def answer(message: object, say: Say) -> None:
    """Answers one message; whatever is wrong with it is said as `refused`, with the reason.

    >>> told = []
    >>> answer({"kind": "scene", "name": "lee"}, told.append)
    >>> told[0]["kind"], len(told[0]["scene"]["circle"])
    ('scene', 3)
    >>> answer({"kind": "sing"}, told.append)
    >>> told[1]["error"]
    "kind = 'sing' is not known; one of names, scene, run, texts, certificate"
    """
    try:
        if not isinstance(message, dict):
            raise SceneError("a message is an object with a kind")
        kind = message.get("kind")
        if not isinstance(kind, str) or kind not in KINDS:
            raise SceneError(f"kind = {cut(kind)} is not known; one of {', '.join(KINDS)}")
        KINDS[kind](message, say)
    except SceneError as error:
        say({"kind": "refused", "error": str(error)})
    except OutOfTime as error:
        say(
            {
                "kind": "refused",
                "error": f"nothing came of it in time: {error}; ask for more seconds, or a smaller scene",
            }
        )
    except RecursionError:
        say({"kind": "refused", "error": "the scene is nested too deep; write its numbers shorter"})


def engines_here() -> tuple[str, ...]:
    """The engines that can be asked for where this runs."""
    return ENGINES_PLAYED if util.find_spec("numpy") is not None else WITHOUT_NUMPY


# -- The catalogue.


def names(message: Message, say: Say) -> None:
    """Every scene of the catalogue that can be played (name, what it shows, data, picture), and the engines."""
    del message
    rows = [
        {
            "name": name,
            "about": catalogue.entry(name).summary,
            "scene": scene.data(),
            "picture": scene_picture(scene, standalone=True, across=PICTURE),
        }
        for name in catalogue.names()
        if len((scene := catalogue.build(name)).circles) <= MOST_CIRCLES
    ]
    say({"kind": "names", "names": rows, "engines": list(engines_here())})


PICTURE = 320.0
"""Pixels across of a scene's picture."""


def one_scene(message: Message, say: Say) -> None:
    """One scene of the catalogue by its name, perhaps with parameters."""
    name = message.get("name")
    if not isinstance(name, str) or len(name) > 200:
        raise SceneError(f"name = {cut(name)} is no name of a scene")
    scene = _small(catalogue.build(name))
    say({"kind": "scene", "scene": scene.data(), "picture": scene_picture(scene, standalone=True, across=PICTURE)})


# -- A run: exact, and others beside it.


def scene_of(message: Message) -> Scene:
    """The scene in a message.

    Raises:
        SceneError: for what is no scene, and for one that is too large to be played.
    """
    data = message.get("scene")
    if not isinstance(data, dict):
        raise SceneError("scene: an object with circles is missing")
    for kind, most in (
        ("circle", MOST_CIRCLES),
        ("wall", MOST_OTHERS),
        ("segment", MOST_OTHERS),
        ("polygon", MOST_OTHERS),
        ("arc", MOST_OTHERS),
        ("pocket", MOST_OTHERS),
    ):
        rows: Any = data.get(kind, [])
        if isinstance(rows, list) and len(rows) > most:
            raise SceneError(
                f"the page plays at most {most} {kind}s, and here are {len(rows):,}; run truebreak compare"
            )
        for row in rows if isinstance(rows, list) else []:
            for key, value in _numbers(row) if isinstance(row, dict) else []:
                if len(str(value)[: MOST_NUMBERS + 1]) > MOST_NUMBERS:
                    raise SceneError(
                        f"{kind} {cut(row.get('id'))}: {key} has over {MOST_NUMBERS} characters; shorten it"
                    )
    return scene_from_table(data, "scene", JSON_LIST)


def _numbers(row: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """What a thing has by its names: of a polygon each number of each corner.

    Raises:
        SceneError: for more corners than a polygon that is played has.
    """
    for key, value in row.items():
        if key != "points" or not isinstance(value, list):
            yield key, value
            continue
        if len(value) > MOST_CORNERS:
            raise SceneError(
                f"the page plays polygons of at most {MOST_CORNERS} corners, and {cut(row.get('id'))} has "
                f"{len(value):,}; run truebreak compare"
            )
        for k, point in enumerate(value, start=1):
            yield from ((f"corner {k}", part) for part in (point if isinstance(point, list) else [point]))


def _small(scene: Scene) -> Scene:
    if len(scene.circles) > MOST_CIRCLES:
        raise SceneError(f"the page plays at most {MOST_CIRCLES} circles, and {scene.name} has {len(scene.circles):,}")
    return scene


def _whole(message: Message, key: str, default: int, most: int) -> int:
    value = message.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= most:
        raise SceneError(f"{key} = {cut(value)}: must be a whole number from 1 to {most:,}")
    return value


def _seconds(message: Message) -> float:
    value = message.get("seconds", DEFAULT_SECONDS)
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 < value <= MOST_SECONDS:
        raise SceneError(f"seconds = {cut(value)}: must be a number up to {MOST_SECONDS:g}")
    return float(value)


def _engines(message: Message) -> list[str]:
    """Names alone, at most three, each once."""
    asked = message.get("engines", ["double"])
    here = engines_here()
    if not isinstance(asked, list) or not 0 < len(asked) <= 3 or len({str(name) for name in asked}) < len(asked):
        raise SceneError(f"engines = {cut(asked)}: must be a list of one to three names")
    for name in asked:
        if name not in here:
            raise SceneError(f"engine {cut(name)} does not run here; one of {', '.join(here)}")
    return asked


def run(message: Message, say: Say) -> None:
    """Runs a scene exactly and in other engines, and says where they part: `ran`, or, with `why`, that and the reasons.

    The seconds are for all of it: both runs, what is read off them, and the words. There is no `recording` where all
    that happens happens at the start.
    """
    began = clock.perf_counter()
    scene, seconds, engines = scene_of(message), _seconds(message), _engines(message)
    events = _whole(message, "events", scene.events or DEFAULT_EVENTS, MOST_EVENTS)
    why, last = message.get("why") is True, 0.0
    back = message.get("back")
    if back is not None:
        scene, events = turned(scene, _whole(message, "back", 1, MOST_EVENTS // 2), seconds / 4), MOST_EVENTS

    def progress(state: Progress) -> None:
        nonlocal last
        now = clock.perf_counter()
        if now - last >= SAID_EVERY:
            last = now
            say({"kind": "progress", "events": state.events, "note": state.note})

    found = compare(
        scene,
        engines,
        events=events,
        until=None if back is None else scene.until,
        causes=why,
        audited=why,
        alternatives=False,
        max_seconds=max((1 - READING_SHARE) * seconds - (clock.perf_counter() - began), 0.1),
        progress=progress,
    )
    if message.get("ulp") is True:
        left = max((1 - READING_SHARE) * seconds - (clock.perf_counter() - began), 0.1)
        found = beside(found, left)
    data = recording(found)
    if data is None and not found.reference.events:
        stop = found.reference.stop
        if stop.reason is StopReason.UNDECIDED:
            raise SceneError(stop.message)
        raise SceneError(f"nothing happens: {stop.message}; throw a disc, or add one in its way")
    say(
        {
            "kind": "ran",
            "recording": data,
            "engines": engines,
            "verdict": verdict_line(found),
            "tone": found.verdict,
            "exact": {
                **_told(found.reference),
                "proved": found.certain and found.reference.certified,
                "ties": _ties(found.reference),
            },
            "others": [
                {**_told(c.trajectory), "name": c.engine, "home": c.return_miss, "agreed": c.alignment.agreed}
                for c in found.candidates
            ],
            "turned": back is not None,
            "home": found.return_miss,
            "cut": list(found.cut),
            "why": _why(found) if why else None,
            "seconds": clock.perf_counter() - began,
        }
    )


def turned(scene: Scene, events: int, seconds: float) -> Scene:
    """The scene with every velocity turned round half-way to the event after so many, and an end at twice that time.

    Raises:
        SceneError: for a scene that has a reversal of its own, for one that loses energy, and for one in which so many
            events are not reached.
    """
    if scene.reverse_at is not None or scene.reverse_after is not None:
        raise SceneError("the scene turns back by itself; leave its reversal out")
    if not scene.elastic:
        raise SceneError(
            f"restitution = {scene.restitution.text()}: each hit loses energy, which turning back does not return; "
            "set it to 1"
        )
    with time_limit(seconds) as watch:
        ran = ExactEngine().run(scene, events=events + 1, progress=watch.watched(None))
    if len(ran.events) < events:
        count = len(ran.events)
        remedy = f"ask for {2 * count:,} at most" if count else ran.stop.message
        raise SceneError(f"turning back comes after event {events:,}, and the run has {count:,}; {remedy}")
    before = float(ran.events[events - 1].time)
    after = float(ran.events[events].time) if len(ran.events) > events else before + max(1.0, before / 8)
    at = Quantity.of(before + (after - before) / 2)
    return scene.with_changes(reverse_at=at, until=2 * at, events=None)


def beside(found: Comparison, seconds: float) -> Comparison:
    """The comparison with a second run in doubles, from a start that differs by one bit of one number.

    It goes as far as the first of the others, and ends after so many seconds.

    Raises:
        SceneError: if no start is to be had beside it.
    """
    first = found.candidates[0]
    last = float(first.trajectory.final_time)
    with time_limit(seconds) as watch:
        twin = DoubleEngine().run(one_bit_off(found.scene), until=last or None, progress=watch.watched(None))
    aligned = align(found.reference, twin, span=Span.of(found.reference), bits=53)
    end = min(found.span, float(found.reference.final_time)) or last
    changed = replace(
        first,
        engine=ONE_BIT_OFF,
        trajectory=twin,
        alignment=aligned,
        separation=separation(found.reference, twin, end),
        return_miss=return_miss(twin, found.reference),
        diagnosis=None,
        laws=None,
    )
    return replace(found, candidates=(*found.candidates, changed))


ONE_BIT_OFF = "double (one bit off)"
"""What the run from the other start is called."""


def one_bit_off(scene: Scene) -> Scene:
    """The scene with the first moving circle's x the next double up, or its y, or those of the next circle.

    Raises:
        SceneError: if every one of them runs into something.

    >>> from truebreak.scenarios import Scene
    >>> float(one_bit_off(Scene([Circle(1, 0, vx=1)])).circles[0].x)
    1.0000000000000002
    """
    for k, circle in enumerate(scene.circles):
        for key in () if circle.fixed else ("x", "y"):
            for way in (math.inf, -math.inf):
                place = Quantity.of(math.nextafter(float(getattr(circle, key)), way))
                values = {name: getattr(circle, name) for name in ("x", "y", "r", "vx", "vy", "m", "id", "point")}
                moved = Circle(**{**values, key: place})
                try:
                    return scene.with_changes(circles=(*scene.circles[:k], moved, *scene.circles[k + 1 :]))
                except SceneError:
                    continue
    raise SceneError("no disc can be moved by one bit: each is fixed, or touches on all sides")


def _told(ran: Trajectory) -> dict[str, Any]:
    """What is said of one run beside its recording."""
    return {"events": len(ran.events), "end": float(ran.final_time), "stop": ran.stop.message}


def _ties(ran: Trajectory) -> int:
    """Instants at which some body has more than one push: what they do is the policy's choice."""
    return sum(
        len({name for pair in event.impulses for name in pair}) < 2 * len(event.impulses) for event in ran.events
    )


def _why(found: Comparison) -> dict[str, Any]:
    """The four answers of a report, in its own words."""
    told = answers(found)
    return {
        "engine": told.engine,
        "where": told.where,
        "why": told.why,
        "so_what": told.so_what,
        "what_now": told.what_now,
        "command": told.command,
        "read": told.read,
    }


# -- The scene, and the proof of its run, to take away.


def texts(message: Message, say: Say) -> None:
    """The scene as TOML, as Python, and the command that compares it."""
    scene = scene_of(message)
    events = _whole(message, "events", scene.events or DEFAULT_EVENTS, MOST_EVENTS)
    engines = _engines(message)
    toml = dump_toml(scene)
    command = f"truebreak compare {scene_word(scene)} --engines {','.join(engines)} --events {events}"
    say({"kind": "texts", "toml": toml, "python": python_of(scene, engines, events), "command": command})


def python_of(scene: Scene, engines: Sequence[str], events: int) -> str:
    """A program that makes the scene and compares it.

    >>> from truebreak.scenarios import Scene
    >>> print(python_of(Scene([Circle(0, "1/2", vx=1)]), ["double"], 5))
    from truebreak.compare import compare
    from truebreak.scenarios import Circle, Scene
    <BLANKLINE>
    scene = Scene(
        circles=[
            Circle(id='c1', x='0', y='1/2', r='1', vx='1', vy='0', m='1'),
        ],
        name='scene',
    )
    print(compare(scene, ['double'], events=5))
    """
    data = scene.data()
    kinds = {"circle": ("Circle", "circles"), "wall": ("Wall", "walls"), "segment": ("Segment", "segments")}
    kinds |= {"pocket": ("Pocket", "pockets"), "polygon": ("Polygon", "polygons"), "arc": ("Arc", "arcs")}
    used = [kind for kind in kinds if data.get(kind)]
    lines = ["from truebreak.compare import compare"]
    lines += [f"from truebreak.scenarios import {', '.join(sorted([*(kinds[kind][0] for kind in used), 'Scene']))}", ""]
    lines.append("scene = Scene(")
    for kind in used:
        made, key = kinds[kind]
        rows = [
            f"        {made}({', '.join(f'{name}={value!r}' for name, value in row.items())})," for row in data[kind]
        ]
        lines += [f"    {key}=[", *rows, "    ],"]
    others = {key: value for key, value in data.items() if key not in kinds and key not in ("description", "source")}
    lines += [
        f"    {key}={value!r}," for key, value in others.items() if (key, value) != ("tie_policy", "simultaneous")
    ]
    return "\n".join([*lines, ")", f"print(compare(scene, {list(engines)!r}, events={events}))"])


def certificate(message: Message, say: Say) -> None:
    """The certificate of the exact run: a text that a checker proves again, and shares nothing with the engine."""
    from ..certificate.writer import certificate_json, certificate_of

    scene, seconds = scene_of(message), _seconds(message)
    events = _whole(message, "events", scene.events or DEFAULT_EVENTS, MOST_EVENTS)
    with time_limit(seconds) as watch:
        ran = ExactEngine().run(scene, events=events, progress=watch.watched(None))
    say({"kind": "certificate", "text": certificate_json(certificate_of(ran)), "events": len(ran.events)})


KINDS: Mapping[str, Callable[[Message, Say], None]] = {
    "names": names,
    "scene": one_scene,
    "run": run,
    "texts": texts,
    "certificate": certificate,
}
"""What can be asked; `stop` is the business of whoever carries the messages, who ends the run."""
