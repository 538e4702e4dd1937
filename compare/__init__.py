"""Runs one scene in several engines and says where, and why, their histories part.

>>> from truebreak.compare import compare
>>> from truebreak.scenarios import Circle, Scene
>>> compare(Scene([Circle(0, 0, vx=1), Circle(4, 0)]), ["double"], until=5).verdict
'agree'
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..scenarios.lazy import handed_on

if TYPE_CHECKING:
    from .alignment.align import Alignment
    from .alignment.instants import Divergence
    from .candidate import Candidate
    from .comparison import Comparison, compare
    from .engines import ENGINES, engine
    from .outcomes.outcome import OUTCOMES, Outcome
    from .reduction.minimal_scene import minimise
    from .reduction.smallest import Smallest
    from .report.documents import comparison_json, trajectory_json
    from .report.html import html_report

__all__ = [
    "ENGINES",
    "OUTCOMES",
    "Alignment",
    "Candidate",
    "Comparison",
    "Divergence",
    "Outcome",
    "Smallest",
    "compare",
    "comparison_json",
    "engine",
    "html_report",
    "minimise",
    "trajectory_json",
]

_HOMES = {
    "ENGINES": "engines",
    "OUTCOMES": "outcomes.outcome",
    "Alignment": "alignment.align",
    "Candidate": "candidate",
    "Comparison": "comparison",
    "Divergence": "alignment.instants",
    "Outcome": "outcomes.outcome",
    "Smallest": "reduction.smallest",
    "compare": "comparison",
    "comparison_json": "report.documents",
    "engine": "engines",
    "html_report": "report.html",
    "minimise": "reduction.minimal_scene",
    "trajectory_json": "report.documents",
}
"""The module of each name: imported when it is asked for, so that `truebreak --help` loads no engine."""

__getattr__, __dir__ = handed_on(__name__, _HOMES)
