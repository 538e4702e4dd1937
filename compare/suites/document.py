"""A report of a suite as the JSON object `truebreak/suite-1`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from .running import SuiteReport
    from .survey import Survey

SUITE_SCHEMA = "truebreak/suite-1"


class Told(Protocol):
    """What has a form in JSON."""

    def data(self) -> dict[str, Any]:
        """As JSON."""
        ...


def suite_json(report: SuiteReport, changes: Sequence[Told] | None = None) -> dict[str, Any]:
    """The object that `truebreak suite --json` prints.

    Args:
        changes: what changed since an earlier report; None if none was given.
    """
    return {
        "schema": SUITE_SCHEMA,
        "suite": report.suite,
        "verdict": report.verdict,
        "max_seconds": report.max_seconds,
        "cells": [cell.data() for cell in report.cells],
        "changes": None if changes is None else [change.data() for change in changes],
    }


def survey_json(found: Survey) -> dict[str, Any]:
    """The object that `truebreak survey --json` prints: that of a suite, with versions and advice."""
    return {
        **suite_json(found.report),
        "versions": found.versions,
        "missing": list(found.missing),
        "advice": [entry.advice.data() for entry in found.entries if entry.advice is not None],
    }
