"""Puts certificates tampered with to both checkers, a line of JSON for each in a file; what it has is not done again.

From the project's root, the first 20,000:

    PYTHONPATH=tests:tests/compare python -m certificate.campaign FILE --count 20000

With `--moving` they are of random scenes in which segments and polygons move: of three numbers the first is the
certificate as it is, which both have to verify, and the other two are altered in one way:

    PYTHONPATH=tests:tests/compare python -m certificate.campaign FILE --moving --first 0 --scenes 600

A line has `number`, `made` (how, and of what), the exit codes `python` and `node`, what the first said, and `fault`.
That is empty unless the two contradict each other, or verify what the engine's own run of the scene does not show. The
exit status is 1 if a line has a fault.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from copy import deepcopy
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from random import Random

from certificate.checkers import by_python, node_verdicts, started_node
from certificate.kinds import KINDS, Told
from certificate.peg_samples import EVENTS, carried_scene_of
from certificate.samples import samples
from certificate.test_segment_tampering import CARRIED_WAYS
from certificate.test_tampering import WAYS, shown_true
from truebreak.compare.certificate import CertificateError, certificate_json, certificate_of
from truebreak.exact import ExactEngine
from truebreak.scenarios.errors import SceneError

VERIFIED, REFUTED, NO_CERTIFICATE, UNDECIDED = 0, 1, 2, 4

AS_IT_IS = "as it is"
MOVING_WAYS = (*CARRIED_WAYS, *WAYS)

AT_ONCE = 200
"""Files handed to the second checker at once: it is one process for them, which works while the first one does."""


@dataclass(frozen=True)
class Result:
    """What both checkers said of one certificate."""

    number: int
    made: str
    python: int
    node: int
    words: str
    fault: str


def tampered(number: int) -> tuple[str, Told]:
    """A certificate tampered with in one kind or in two, the same one each time; and how it was made."""
    names, kinds = sorted(samples()), sorted(KINDS)
    draw = Random(f"kinds {number}")
    kind = kinds[number % len(kinds)]
    for name in draw.sample(names, len(names)) * 3:
        told = deepcopy(samples()[name])
        if KINDS[kind](told, draw) is False:
            continue
        more = draw.choice(kinds) if draw.random() < 0.2 else None
        try:
            changed = more is not None and KINDS[more](told, draw) is not False
        except (TypeError, KeyError, IndexError, ValueError, AttributeError):
            continue  # what the first made senseless
        return f"{kind}{f', {more}' if changed else ''}, of {name}", told
    raise AssertionError(f"{kind} fits nothing")


@lru_cache(maxsize=4)
def _moving(seed: int) -> Told | None:
    """The certificate of a random scene in which something moves; None where there is none of it."""
    scene = carried_scene_of(seed)
    try:
        return None if scene is None else certificate_of(ExactEngine().run(scene, events=EVENTS))
    except CertificateError as error:
        if "nothing to certify" in str(error):
            return None
        raise


def moving(number: int) -> tuple[str, Told] | None:
    """How a certificate of a scene in which something moves was made, as it is or altered; and what it is."""
    told, draw = deepcopy(_moving(number // 3)), Random(f"moving {number}")
    if told is None or number % 3 == 0:
        return told and (f"{AS_IT_IS}, of carried {number // 3}", told)
    for way in draw.sample(MOVING_WAYS, len(MOVING_WAYS)):
        before = deepcopy(told)
        with suppress(IndexError):  # there is nothing of its kind
            way(told, draw)
        if told != before:
            return f"{way.__name__}, of carried {number // 3}", told
    raise AssertionError(f"nothing alters {number}")


def campaign(
    numbers: Iterable[int], folder: Path, make: Callable[[int], tuple[str, Told] | None] = tampered
) -> Iterator[Result]:
    """What both checkers say of the certificates with these numbers."""
    todo = list(numbers)
    for start in range(0, len(todo), AT_ONCE):
        yield from _batch(todo[start : start + AT_ONCE], folder, make)


def _batch(numbers: list[int], folder: Path, make: Callable[[int], tuple[str, Told] | None]) -> Iterator[Result]:
    made = [(number, *one) for number in numbers if (one := make(number)) is not None]
    numbers = [number for number, *_ in made]
    paths = [folder / f"{number}.json" for number in numbers]
    for path, (_, _, told) in zip(paths, made, strict=True):
        path.write_text(certificate_json(told), encoding="utf-8")
    node = started_node(paths)
    ours = [by_python(path) for path in paths]
    theirs = node_verdicts(node, len(paths))
    for path in paths:
        path.unlink()
    for (number, name, told), (first, words), (second, others) in zip(made, ours, theirs, strict=True):
        fault = fault_in(told, (first, words), (second, others))
        if name.startswith(AS_IT_IS) and (first or second):
            fault = f"it is a run of the engine: {words}; {others}"
        yield Result(number, name, first, second, words, fault)


def fault_in(told: Told, first: tuple[int, str], second: tuple[int, str]) -> str:
    """What is wrong with two verdicts on a certificate: nothing, if they are the same, or one is not decided."""
    said = f"{first[1]}; {second[1]}"
    if first[0] != second[0] and UNDECIDED not in (first[0], second[0]):
        return f"they contradict each other: {said}"
    if VERIFIED not in (first[0], second[0]):
        return ""
    if first[0] == second[0] and first[1] != second[1]:
        return f"they verify different things: {said}"
    try:
        return "" if shown_true(told) else f"it is false: {said}"
    except (SceneError, CertificateError) as error:
        return f"the engine has no such run ({error}): {said}"


def main(arguments: list[str] | None = None) -> int:
    """Adds to the file what it lacks, and counts what it has; the exit status."""
    parser = argparse.ArgumentParser(prog="python -m certificate.campaign", description=__doc__)
    parser.add_argument("file", type=Path)
    parser.add_argument("--start", type=int, default=0, help="the first number (0)")
    parser.add_argument("--count", type=int, default=20_000, help="how many from there on (20000)")
    parser.add_argument("--moving", action="store_true", help="of random scenes in which segments and polygons move")
    parser.add_argument("--first", type=int, default=0, help="with --moving: the first scene (0)")
    parser.add_argument("--scenes", type=int, default=600, help="with --moving: how many scenes from there on (600)")
    options = parser.parse_args(arguments)
    numbers = range(options.start, options.start + options.count)
    if options.moving:
        numbers = range(3 * options.first, 3 * (options.first + options.scenes))
    have = [json.loads(line) for line in _lines(options.file)]
    done = {row["number"] for row in have}
    todo = [number for number in numbers if number not in done]
    with tempfile.TemporaryDirectory() as folder, options.file.open("a", encoding="utf-8") as out:
        for result in campaign(todo, Path(folder), moving if options.moving else tampered):
            have.append(asdict(result))
            print(json.dumps(have[-1]), file=out, flush=True)
    codes = Counter(f"{row['python']} {row['node']}" for row in have)
    print(f"{len(have)} certificates; exit codes of verify.py and verify.mjs: {dict(sorted(codes.items()))}")
    faults = [row for row in have if row["fault"]]
    for row in faults:
        print(f"{row['number']}: {row['made']}: {row['fault']}")
    return 1 if faults else 0


def _lines(file: Path) -> list[str]:
    """The whole lines of a file; one that a killed run left unfinished is cut off."""
    text = file.read_text(encoding="utf-8") if file.exists() else ""
    whole = text[: text.rfind("\n") + 1]
    if whole != text:
        file.write_text(whole, encoding="utf-8")
    return whole.splitlines()


if __name__ == "__main__":
    sys.exit(main())
