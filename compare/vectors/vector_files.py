"""Vectors as JSON and as arrays in C, with a program in C that scores anybody's function by them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from ...scenarios.lazy import VERSION
from ..writing import check_folder, write_whole
from .first_meetings import KINDS, THINGS, Vector

FORMAT = "truebreak-vectors-2"
"""What the JSON says that it is."""

SOURCES = ("score.c", "formulas.c")
"""Programs in C that are written beside the arrays: the scorer, and three formulas to be scored."""

MOST_NUMBERS = 7
"""How many numbers the largest thing has; the others are filled up with 0 in C."""

ABOUT = "single first meetings with certified answers: every number of a question is a double, to be taken as it is"


def vectors_json(vectors: Iterable[Vector], command: str) -> Iterator[str]:
    """The JSON form in parts, one vector a line; see docs/vectors.md.

    >>> from .first_meetings import vectors
    >>> text = "".join(vectors_json(vectors(1), "truebreak vectors --count 1"))
    >>> json.loads(text)["vectors"][0]["kind"]
    'hit'
    """
    yield f'{{"format": "{FORMAT}",\n'
    yield f' "made_by": {json.dumps(command)},\n'
    yield f' "version": "{VERSION}",\n'
    yield f' "about": "{ABOUT}",\n'
    yield ' "vectors": [\n'
    before = ""
    for vector in vectors:
        asked = vector.question
        disc, other = (", ".join(map(repr, numbers)) for numbers in (asked.disc, asked.other))
        answer = f'"meets": {"true" if vector.meets else "false"}'
        if vector.meets:
            answer += f', "time": {vector.time!r}, "rest": {vector.rest!r}, "digits": "{vector.digits}"'
        if vector.part:
            answer += f', "part": "{vector.part}"'
        level = "null" if asked.level is None else asked.level
        yield before
        yield f'  {{"thing": "{asked.thing}", "kind": "{asked.kind}", "level": {level}, "disc": [{disc}], '
        yield f'"other": [{other}], {answer}}}'
        before = ",\n"
    yield "\n ]}\n"


def vectors_header(vectors: Sequence[Vector], command: str) -> Iterator[str]:
    """`vectors.h` in parts: an array of structs; all numbers are hexadecimal, which C reads without rounding."""
    yield f"/* Made by `{command}` (truebreak {VERSION}): {ABOUT}. */\n"
    yield "#ifndef TRUEBREAK_VECTORS_H\n#define TRUEBREAK_VECTORS_H\n\n"
    yield "/* thing: what is met. a: the disc's x, y, r, vx, vy. b: a disc's x, y, r, vx, vy; a wall's x0, y0, x1,\n"
    yield " * y1; a segment's x0, y0, x1, y1, r; an arc's x, y, r, x0, y0, x1, y1: what lies, counter-clockwise,\n"
    yield " * from the direction of (x0, y0) to that of (x1, y1), seen from its middle; all, where both are that.\n"
    yield " * time: the double nearest to when they meet; rest: beyond it. */\n"
    yield f"struct truebreak_vector {{ int thing, kind, meets; double a[5], b[{MOST_NUMBERS}], time, rest; }};\n\n"
    yield f"enum {{ {', '.join(f'TRUEBREAK_{name.upper()}' for name in THINGS)}, TRUEBREAK_THINGS }};\n"
    yield f"enum {{ TRUEBREAK_KINDS = {len(KINDS)}, TRUEBREAK_VECTORS = {len(vectors)} }};\n"
    for name, words in (("things", THINGS), ("kinds", KINDS)):
        listed = ", ".join(f'"{word}"' for word in words)
        yield f"static const char *const truebreak_{name}[] = {{{listed}}};\n"
    yield "static const struct truebreak_vector truebreak_vectors[TRUEBREAK_VECTORS] = {\n"
    for vector in vectors:
        asked = vector.question
        padded = *asked.other, *[0.0] * (MOST_NUMBERS - len(asked.other))
        disc, other = (", ".join(float(n).hex() for n in numbers) for numbers in (asked.disc, padded))
        head = f"{THINGS.index(asked.thing)}, {KINDS.index(asked.kind)}, {int(vector.meets)}"
        yield f"  {{{head}, {{{disc}}}, {{{other}}}, {vector.time.hex()}, {vector.rest.hex()}}},\n"
    yield "};\n\n#endif\n"


def write_vectors(folder: str | Path, vectors: Sequence[Vector], command: str) -> list[Path]:
    """Writes `vectors.json`, `vectors.h`, and the sources in C; each whole or not at all.

    Returns:
        What was written.

    Raises:
        SceneError: where the folder cannot be written to.
    """
    check_folder(folder)
    texts: dict[str, Iterable[str]] = {
        "vectors.json": vectors_json(vectors, command),
        "vectors.h": vectors_header(vectors, command),
        **{name: [Path(__file__).with_name(name).read_text("utf-8")] for name in SOURCES},
    }
    for name, text in texts.items():
        write_whole(Path(folder) / name, text)
    return [Path(folder) / name for name in texts]
