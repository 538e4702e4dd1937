"""Both checkers say the same of certificates tampered with in many kinds; what either verifies is true."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path
from random import Random

import pytest

from certificate.checkers import by_node, by_python, needs_node
from certificate.kinds import KINDS, Told
from certificate.samples import samples
from certificate.test_tampering import shown_true
from truebreak.compare.certificate import CertificateError, certificate_json
from truebreak.scenarios.errors import SceneError

VERIFIED, REFUTED, NO_CERTIFICATE, UNDECIDED = 0, 1, 2, 4
AT_ONCE = 400
"""Files handed to the second checker at once."""


def tampered(count: int) -> Iterator[tuple[str, Told]]:
    """Certificates, each tampered with in one kind or in two, every kind in turn; the same ones each time."""
    names, kinds = sorted(samples()), sorted(KINDS)
    for number in range(count):
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
            yield f"{number}: {kind}{f', {more}' if changed else ''}, of {name}", told
            break
        else:
            raise AssertionError(f"{kind} fits nothing")


def test_there_are_many_kinds() -> None:
    assert len(KINDS) >= 60


@needs_node
@pytest.mark.parametrize("count", [len(KINDS), pytest.param(20_000, marks=pytest.mark.slow)])
@pytest.mark.timeout(7200)
def test_both_checkers_say_the_same_of_what_is_tampered_with(count: int, tmp_path: Path) -> None:
    codes: Counter[tuple[int, int]] = Counter()
    batch: list[tuple[str, Told]] = []
    for number, one in enumerate(tampered(count), start=1):
        batch.append(one)
        if len(batch) == AT_ONCE or number == count:
            codes += told_alike(batch, tmp_path)
            batch = []
    assert sum(codes.values()) == count
    alike = sum(many for (one, other), many in codes.items() if one == other)
    assert alike > 0.95 * count, codes
    for code in (VERIFIED, REFUTED, NO_CERTIFICATE, UNDECIDED):
        assert codes[code, code] > count // 100, codes


def told_alike(batch: list[tuple[str, Told]], folder: Path) -> Counter[tuple[int, int]]:
    """How often the checkers said what of a batch; neither contradicts the other, or the engine."""
    paths = [folder / f"{k}.json" for k in range(len(batch))]
    for path, (_, told) in zip(paths, batch, strict=True):
        path.write_text(certificate_json(told), encoding="utf-8")
    codes: Counter[tuple[int, int]] = Counter()
    for (name, told), path, (second, words) in zip(batch, paths, by_node(paths), strict=True):
        first, sentence = by_python(path)
        assert first == second or UNDECIDED in (first, second), f"{name}: {sentence}; {words}"
        if VERIFIED in (first, second):
            if first == second:
                assert sentence == words, name
            try:
                assert shown_true(told), f"{name}: {sentence}; {words}; but it is false"
            except (SceneError, CertificateError) as error:
                raise AssertionError(f"{name}: {sentence}; {words}; but {error}") from error
        codes[first, second] += 1
    return codes
