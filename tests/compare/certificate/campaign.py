"""Puts certificates tampered with to both checkers, a line of JSON for each in a file; what it has is not done again.

From the project's root, the first 20,000:

    PYTHONPATH=tests:tests/compare python -m certificate.campaign FILE --count 20000

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
from collections.abc import Iterable, Iterator
from copy import deepcopy
from dataclasses import asdict, dataclass
from pathlib import Path
from random import Random

from certificate.checkers import by_python, node_verdicts, started_node
from certificate.kinds import KINDS, Told
from certificate.samples import samples
from certificate.test_tampering import shown_true
from truebreak.compare.certificate import CertificateError, certificate_json
from truebreak.scenarios.errors import SceneError

VERIFIED, REFUTED, NO_CERTIFICATE, UNDECIDED = 0, 1, 2, 4

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


def campaign(numbers: Iterable[int], folder: Path) -> Iterator[Result]:
    """What both checkers say of the certificates with these numbers."""
    todo = list(numbers)
    for start in range(0, len(todo), AT_ONCE):
        yield from _batch(todo[start : start + AT_ONCE], folder)


def _batch(numbers: list[int], folder: Path) -> Iterator[Result]:
    made = [(number, *tampered(number)) for number in numbers]
    paths = [folder / f"{number}.json" for number in numbers]
    for path, (_, _, told) in zip(paths, made, strict=True):
        path.write_text(certificate_json(told), encoding="utf-8")
    node = started_node(paths)
    ours = [by_python(path) for path in paths]
    theirs = node_verdicts(node, len(paths))
    for path in paths:
        path.unlink()
    for (number, name, told), (first, words), (second, others) in zip(made, ours, theirs, strict=True):
        yield Result(number, name, first, second, words, fault_in(told, (first, words), (second, others)))


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
    options = parser.parse_args(arguments)
    have = [json.loads(line) for line in _lines(options.file)]
    done = {row["number"] for row in have}
    todo = [number for number in range(options.start, options.start + options.count) if number not in done]
    with tempfile.TemporaryDirectory() as folder, options.file.open("a", encoding="utf-8") as out:
        for result in campaign(todo, Path(folder)):
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
