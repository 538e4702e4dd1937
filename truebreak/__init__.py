"""Says, provably, whether and where floating-point error changed what happened in a world of circles and walls.

>>> import truebreak as tb
>>> cradle = tb.scene("cradle:n=3")
>>> len(tb.run(cradle, events=4).events)
4
>>> tb.comparison(tb.Scene([tb.Circle(0, 0, vx=1), tb.Circle(4, 0)]), ["double"], until=5).verdict
'agree'
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .compare.audit.audit import audit_run as audit
    from .compare.comparison import compare as comparison
    from .compare.files.saved import load_run, resume, save_run
    from .compare.foreign.guard import run
    from .compare.logdiff.desync import diff
    from .compare.report.tables import table
    from .compare.saved_comparisons import load_comparison, save_comparison
    from .compare.scene_argument import scene_from as scene
    from .compare.testing.check import check
    from .compare.testing.golden import same
    from .scenarios.files import load_scene as load
    from .scenarios.scene import Scene
    from .scenarios.things import Circle, Pocket, Wall

    __version__: str

__all__ = [
    "Circle",
    "Pocket",
    "Scene",
    "Wall",
    "__version__",
    "audit",
    "check",
    "comparison",
    "diff",
    "load",
    "load_comparison",
    "load_run",
    "resume",
    "run",
    "same",
    "save_comparison",
    "save_run",
    "scene",
    "table",
]

_HERE = Path(__file__).parent
if not (_HERE / "scenarios").is_dir() and (_HERE.parent / "scenarios" / "scene.py").is_file():
    # In a checkout the packages lie beside this folder, which Python finds there before anything that is installed.
    __path__.append(str(_HERE.parent))

_HOMES = {
    "Circle": ("scenarios.things", "Circle"),
    "Pocket": ("scenarios.things", "Pocket"),
    "Scene": ("scenarios.scene", "Scene"),
    "Wall": ("scenarios.things", "Wall"),
    "audit": ("compare.audit.audit", "audit_run"),
    "check": ("compare.testing.check", "check"),
    "comparison": ("compare.comparison", "compare"),
    "diff": ("compare.logdiff.desync", "diff"),
    "load": ("scenarios.files", "load_scene"),
    "load_comparison": ("compare.saved_comparisons", "load_comparison"),
    "load_run": ("compare.files.saved", "load_run"),
    "resume": ("compare.files.saved", "resume"),
    "run": ("compare.foreign.guard", "run"),
    "same": ("compare.testing.golden", "same"),
    "save_comparison": ("compare.saved_comparisons", "save_comparison"),
    "save_run": ("compare.files.saved", "save_run"),
    "scene": ("compare.scene_argument", "scene_from"),
    "table": ("compare.report.tables", "table"),
}
"""The module of each name, and what it is called there: imported when it is asked for."""


def __getattr__(name: str) -> Any:
    if name == "__version__":
        value: Any = import_module(".scenarios.lazy", __name__).VERSION
    elif name in _HOMES:
        module, attribute = _HOMES[name]
        value = getattr(import_module(f".{module}", __name__), attribute)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
