"""What runs and comparisons hold, as tables: columns of plain numbers and text, CSV, numpy or pandas."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...scenarios.errors import SceneError
from ...scenarios.trajectory import Trajectory
from ..alignment.align import Separation
from ..comparison import Comparison
from ..files.amounts import no_formula

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ...scenarios.trajectory import Contact


@dataclass(frozen=True)
class Table(Mapping[str, list[Any]]):
    """Columns of equal length by name.

    >>> told = Table({"event": [0, 1], "time": [0.5, 2.0]})
    >>> told["time"], print(told.csv(), end="")
    event,time
    0,0.5
    1,2.0
    ([0.5, 2.0], None)
    """

    columns: Mapping[str, list[Any]]

    def __getitem__(self, name: str) -> list[Any]:
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    @property
    def rows(self) -> list[tuple[Any, ...]]:
        """Row by row."""
        return list(zip(*self.columns.values(), strict=True))

    def csv(self) -> str:
        """Comma-separated values with a line of headings; doubles so that they are read back to the bit.

        Text that a spreadsheet would take for a formula, as an id may be, has an apostrophe before it.
        """
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows([no_formula(cell) for cell in row] for row in self.rows)
        return out.getvalue()

    def numpy(self) -> NDArray[np.void]:
        """A structured array: a field a column."""
        import numpy as np

        arrays = {name: np.asarray(values) for name, values in self.columns.items()}
        found = np.empty(len(self.rows), dtype=[(name, array.dtype) for name, array in arrays.items()])
        for name, array in arrays.items():
            found[name] = array
        return found

    def pandas(self) -> Any:
        """A pandas DataFrame.

        Raises:
            SceneError: if pandas is not installed.
        """
        try:
            from pandas import DataFrame
        except ImportError:
            raise SceneError("pandas is not installed; pip install pandas, or take csv() or numpy()") from None
        return DataFrame(dict(self.columns))


def table(of: Trajectory | Comparison | Separation, what: str | None = None) -> Table:
    """A run, a comparison or a separation as a table.

    Args:
        of: of a run its `events` (default) or the `states` after each; of a comparison its `verdicts`; of a
            candidate's separation how far circles are apart, at its times.
        what: which of them.

    Raises:
        SceneError: for a table that it does not have.

    >>> from truebreak.exact import ExactEngine
    >>> from truebreak.scenarios import catalogue
    >>> run = ExactEngine().run(catalogue.build("lee"), events=1)
    >>> print(table(run).csv(), end="")
    event,time,contacts,impulses,coupled
    0,1.0,left+middle middle+right,left+middle middle+right,True
    >>> table(run, "states")["vx"]
    [-2.0, -1.0, 0.0]
    """
    kinds = {Trajectory: ("events", "states"), Comparison: ("verdicts",), Separation: ("separation",)}
    known = next((names for kind, names in kinds.items() if isinstance(of, kind)), ())
    chosen = what if what is not None else next(iter(known), None)
    if chosen not in known:
        raise SceneError(f"a {type(of).__name__} has no table {chosen!r}; it has {', '.join(known) or 'none'}")
    if isinstance(of, Trajectory):
        return _events(of) if chosen == "events" else _states(of)
    return _verdicts(of) if isinstance(of, Comparison) else _separation(of)


def _events(run: Trajectory) -> Table:
    return Table(
        {
            "event": [event.index for event in run.events],
            "time": [float(event.time) for event in run.events],
            "contacts": [_pairs(event.contacts) for event in run.events],
            "impulses": [_pairs(event.impulses) for event in run.events],
            "coupled": [event.coupled for event in run.events],
        }
    )


def _pairs(contacts: Iterable[Contact]) -> str:
    return " ".join(f"{first}+{second}" for first, second in contacts)


def _states(run: Trajectory) -> Table:
    """The state after each event, a row a circle; of a run without events its final one."""
    states = [(event.index, run.after(event.index)) for event in run.events] or [(0, run.final)]
    rows = [(index, float(state.time), circle) for index, state in states for circle in state.circles]
    columns: dict[str, list[Any]] = {
        "event": [index for index, _, _ in rows],
        "time": [time for _, time, _ in rows],
        "circle": [circle.id for _, _, circle in rows],
    }
    return Table(columns | {key: [float(getattr(c, key)) for _, _, c in rows] for key in ("x", "y", "vx", "vy")})


def _verdicts(comparison: Comparison) -> Table:
    found = comparison.candidates
    parted = [candidate.alignment.divergence for candidate in found]
    return Table(
        {
            "engine": [candidate.engine for candidate in found],
            "verdict": [str(candidate.verdict) for candidate in found],
            "agreed": [candidate.alignment.agreed for candidate in found],
            "differs_at": [None if divergence is None else divergence.event for divergence in parted],
            "cause": [None if c.diagnosis is None else c.diagnosis.name.value for c in found],
        }
    )


def _separation(separation: Separation) -> Table:
    return Table({"time": list(separation.times), "largest": list(separation.largest)})
