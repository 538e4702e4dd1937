"""Bits fall along a run: numbers of unlike bits never meet, and a long run's bits are told by its first part."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from truebreak.compare.certificate import certificate_json, certificate_of, writer
from truebreak.exact import ExactEngine
from truebreak.scenarios import catalogue
from truebreak.tools.verify import Ball, Checker, verdict

Law = Callable[[Ball, Ball], Ball]


@pytest.mark.parametrize("spec", ["gas", "gas:n=3,seed=2"])
def test_numbers_of_unlike_bits_never_meet(spec: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def alike(law: Law) -> Law:
        def checked(a: Ball, b: Ball) -> Ball:
            assert a.bits == b.bits
            return law(a, b)

        return checked

    least: list[int] = []
    instant = Checker.instant

    def watched(self: Checker, entry: dict[str, object]) -> None:
        instant(self, entry)
        least.append(self.ball.bits)

    for name in ("__add__", "__sub__", "__mul__", "__truediv__"):
        monkeypatch.setattr(Ball, name, alike(getattr(Ball, name)))
    monkeypatch.setattr(Checker, "instant", watched)
    told = certificate_of(ExactEngine().run(catalogue.build(spec), events=400))
    path = tmp_path / "run.json"
    path.write_text(certificate_json(told), encoding="utf-8")
    assert verdict(path)[0] == 0
    assert least[-1] < told["bits"] - 100, "the bits do not fall"


def test_a_long_run_is_followed_once_with_the_bits_that_its_first_part_tells(monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[tuple[int, int]] = []
    run = writer.Prover.run

    def watched(self: writer.Prover) -> None:
        tried.append((len(self.told["instants"]), self.told["bits"]))
        run(self)

    monkeypatch.setattr(writer.Prover, "run", watched)
    monkeypatch.setattr(writer, "LONG", 200)
    told = certificate_of(ExactEngine().run(catalogue.build("gas"), events=400))
    assert [instants for instants, _ in tried] == [25, 401]
    assert told["bits"] == tried[-1][1] + writer.MARGIN < 900
