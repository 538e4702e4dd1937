"""The rows of a sweep for other tools: plots by matplotlib (`.[plots]`), tables of pandas and Parquet (`.[tables]`)."""

from __future__ import annotations

import contextlib
import json
import os
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ....scenarios.errors import SceneError
from ...grids.family_sweep import COLUMNS
from ...grids.survival import summaries
from .sweep_plots import law_points

if TYPE_CHECKING:
    from ...grids.row import Row


def plot_survival(rows: Sequence[Row], ax: Any = None) -> Any:
    """Kaplan and Meier's share of scenes whose history still agrees, over events, with Greenwood's intervals.

    Args:
        rows: of `sweep`.
        ax: matplotlib axes to draw on; by default those of a new figure.

    Returns:
        The axes.

    Raises:
        SceneError: without matplotlib.
    """
    ax = _axes(ax)
    for told in summaries(rows):
        events = [0, *(step.event for step in told.survival)]
        (line,) = ax.step(events, [1.0, *(s.share for s in told.survival)], where="post", label=told.engine)
        lows, highs = ([1.0, *values] for values in zip(*((s.low, s.high) for s in told.survival), strict=True)) if (
            told.survival) else ([1.0], [1.0])  # fmt: skip
        ax.fill_between(events, lows, highs, step="post", alpha=0.2, color=line.get_color())
    ax.set(xlabel="event", ylabel="share that agrees", ylim=(0, 1.02))
    ax.legend()
    return ax


def plot_law(rows: Sequence[Row], ax: Any = None) -> Any:
    """The time of each divergence over ln(1/eps)/lambda, with the least-squares line of each engine.

    Args, Returns, Raises: as `plot_survival`.
    """
    ax = _axes(ax)
    clouds = law_points(rows)
    for told in summaries(rows):
        points = clouds.get(told.engine)
        if not points:
            continue
        xs = [x for x, _ in points]
        marks = ax.scatter(xs, [y for _, y in points], s=12, label=told.engine)
        if told.law is not None:
            ends = [min(xs), max(xs)]
            law = told.law
            ax.plot(ends, [law.slope * x + law.intercept for x in ends], color=marks.get_facecolor()[0])
    ax.set(xlabel="ln(1/eps)/lambda", ylabel="time of divergence")
    ax.legend()
    return ax


def plot_changed(rows: Sequence[Row], ax: Any = None) -> Any:
    """The share of scenes of which each engine changed an outcome, with the exact 95 % intervals.

    Args, Returns, Raises: as `plot_survival`.
    """
    ax = _axes(ax)
    told = [(s.engine, s.changed) for s in summaries(rows) if s.changed is not None]
    for place, (_, (count, total, low, high)) in enumerate(told):
        share = count / total
        ax.errorbar([place], [share], yerr=[[max(0.0, share - low)], [max(0.0, high - share)]], fmt="o", capsize=4)
    ax.set_xticks(range(len(told)), [engine for engine, _ in told])
    ax.set(ylabel="share of scenes with an outcome changed", ylim=(-0.02, 1.02))
    return ax


def _axes(ax: Any) -> Any:
    if ax is not None:
        return ax
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise SceneError(
            "plots need matplotlib; pip install '.[plots]', or use compare.report.pictures.sweep_plots"
        ) from None
    return Figure().add_subplot()


# -- tables

TEXTS = ("margin", "changed", "laws", "work")
"""Columns of lists and of dicts: as JSON text, which every reader of tables takes."""


def to_pandas(rows: Iterable[Row]) -> Any:
    """The rows as a `pandas.DataFrame`, each varied parameter in a column of its own.

    Raises:
        SceneError: without pandas.
    """
    try:
        import pandas
    except ImportError:
        raise SceneError("a table in pandas needs pandas; pip install '.[tables]', or write CSV") from None
    flat: list[dict[str, Any]] = []
    for row in rows:
        told: dict[str, Any] = {}
        for column in COLUMNS:
            value = getattr(row, column)
            if column == "parameters":
                told |= value or {}
            else:
                told[column] = json.dumps(value) if column in TEXTS and value is not None else value
        flat.append(told)
    return pandas.DataFrame(flat)


def write_parquet(rows: Iterable[Row], path: str | Path) -> None:
    """Writes the rows as a Parquet file, whole or not at all.

    Raises:
        SceneError: without pandas and pyarrow, and if the place cannot be written to.
    """
    frame, target = to_pandas(rows), Path(path)
    try:
        import pyarrow  # noqa: F401
    except ImportError:
        raise SceneError("Parquet needs pyarrow; pip install '.[tables]', or write CSV") from None
    try:
        descriptor, name = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
        os.close(descriptor)
        try:
            frame.to_parquet(name)
            Path(name).replace(target)
        except BaseException:
            with contextlib.suppress(OSError):
                Path(name).unlink()
            raise
    except OSError as error:
        raise SceneError(f"file {str(path)!r}: {error.strerror or error}; choose another place to write to") from None
