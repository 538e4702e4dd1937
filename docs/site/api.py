"""The pages of the API: every name that a package hands on, from its docstring."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import re
from collections.abc import Iterator
from types import ModuleType
from typing import Any

PACKAGES = {
    "truebreak": "The face: what `import truebreak as tb` has.",
    "truebreak.testing": "For tests of engines.",
    "truebreak.scenarios": "The shared words: numbers, circle, wall, scene, event, trajectory.",
    "truebreak.exact": "The exact engine.",
    "truebreak.floating": "Engines of finite precision.",
    "truebreak.compare": "Comparisons and their reports.",
}

SECTIONS = ("Args:", "Returns:", "Raises:", "Attributes:", "Yields:")


def api_pages() -> Iterator[tuple[str, str]]:
    """Name and MyST text of each page, the list of them first."""
    names = [name.replace(".", "-") for name in PACKAGES]
    rows = [
        f"| [`{package}`]({page}.md) | {told} |" for (package, told), page in zip(PACKAGES.items(), names, strict=True)
    ]
    tree = "\n".join(["```{toctree}", ":hidden:", "", *names, "```"])
    head = "# API\n\nEvery example below runs as a test."
    yield "index", "\n".join([head, "", "| package | what it has |", "|---|---|", *rows, "", tree, ""])
    seen: dict[int, str] = {}
    for package, page in zip(PACKAGES, names, strict=True):
        yield page, _package(importlib.import_module(package), seen)


def _package(module: ModuleType, seen: dict[int, str]) -> str:
    """One package; a name that an earlier page has described is named there, not told again."""
    parts = [f"# Package {module.__name__}", markdown(inspect.getdoc(module) or "")]
    told = []
    for name in sorted(n for n in module.__all__ if not n.startswith("__")):
        thing = getattr(module, name)
        if isinstance(thing, ModuleType):
            continue
        if id(thing) in seen and (inspect.isclass(thing) or callable(thing)):
            told.append(f"`{name}` is {{py:obj}}`{seen[id(thing)]}.{name}`.")
            continue
        seen[id(thing)] = module.__name__
        parts.append(_described(module.__name__, name, thing))
    return "\n\n".join([*parts, *told]) + "\n"


def _described(module: str, name: str, thing: Any) -> str:
    if inspect.isclass(thing):
        body = [markdown(inspect.getdoc(thing) or "")]
        body += [_member(name, member, value) for member, value in _members(thing)]
        fence = "`" * 5
        return (
            f"{fence}{{py:class}} {name}{_signature(thing)}\n:module: {module}\n\n" + "\n\n".join(body) + f"\n{fence}"
        )
    if callable(thing):
        return _entry("py:function", f"{name}{_signature(thing)}", inspect.getdoc(thing) or "", f":module: {module}\n")
    return f"`````{{py:data}} {name}\n:module: {module}\n\n`{_short(repr(thing))}`\n`````"


def _short(text: str) -> str:
    return text if len(text) <= 80 else f"{text[:77]}..."


def _members(thing: type) -> Iterator[tuple[str, Any]]:
    """Public methods and properties that the class itself defines, with a docstring."""
    fields = {field.name for field in dataclasses.fields(thing)} if dataclasses.is_dataclass(thing) else set()
    for name, value in vars(thing).items():
        if name.startswith("_") or name in fields or not inspect.getdoc(value):
            continue
        if inspect.isfunction(value) or isinstance(value, (property, classmethod, staticmethod)):
            yield name, value


def _member(owner: str, name: str, value: Any) -> str:
    doc = inspect.getdoc(value) or ""
    if isinstance(value, property):
        return _entry("py:property", f"{owner}.{name}", doc)
    plain = value.__func__ if isinstance(value, (classmethod, staticmethod)) else value
    kind = ":classmethod:\n" if isinstance(value, classmethod) else ":staticmethod:\n" if plain is not value else ""
    return _entry(
        "py:method", f"{owner}.{name}{_signature(plain, bound=not isinstance(value, staticmethod))}", doc, kind
    )


def _entry(kind: str, signature: str, doc: str, options: str = "") -> str:
    return f"````{{{kind}}} {signature}\n{options}\n{markdown(doc)}\n````"


def _signature(thing: Any, *, bound: bool = False) -> str:
    """The signature on one line, without the first parameter of a method."""
    try:
        signature = inspect.signature(thing)
    except (TypeError, ValueError):
        return ""
    parameters = list(signature.parameters.values())[1 if bound else 0 :]
    shown = [p.replace(default=_default(p.default), annotation=_unquoted(p.annotation)) for p in parameters]
    return str(signature.replace(parameters=shown, return_annotation=_unquoted(signature.return_annotation)))


class _Shown:
    """A text that is shown without quotes."""

    def __init__(self, text: str) -> None:
        self._text = text

    def __repr__(self) -> str:
        return self._text


def _default(value: Any) -> Any:
    """A default value as it is shown."""
    text = repr(value)
    return value if value is inspect.Parameter.empty else _Shown("..." if len(text) > 40 or text[0] == "<" else text)


def _unquoted(annotation: Any) -> Any:
    """An annotation that is text, without its quotes."""
    return _Shown(annotation) if isinstance(annotation, str) else annotation


def markdown(doc: str) -> str:
    """A docstring as MyST: its sections as bold words and lists, its examples as sessions.

    >>> print(markdown("Does it.\\n\\nArgs:\\n    x: how far,\\n        in metres.\\n\\n>>> 1 + 1\\n2"))
    Does it.
    <BLANKLINE>
    **Args:**
    <BLANKLINE>
    - `x`: how far, in metres.
    <BLANKLINE>
    ```pycon
    >>> 1 + 1
    2
    ```
    """
    parts: list[str] = []
    for block in re.split(r"\n\s*\n", doc.strip()):
        lines = block.splitlines()
        if lines[0].strip() in SECTIONS:
            parts += [f"**{lines[0].strip()}**", _listed(lines[1:])]
        elif lines[0].lstrip().startswith(">>>"):
            parts.append("```pycon\n" + "\n".join(lines) + "\n```")
        elif lines[0].startswith("    "):
            parts.append("```text\n" + "\n".join(lines) + "\n```")
        else:
            parts.append(_safe("\n".join(line.strip() for line in lines)))
    return "\n\n".join(parts)


def _listed(lines: list[str]) -> str:
    """Entries `name: text` as a list; deeper lines go on with the entry before."""
    entries: list[str] = []
    indent = min((len(line) - len(line.lstrip()) for line in lines), default=0)
    for line in lines:
        if entries and len(line) - len(line.lstrip()) > indent:
            entries[-1] += f" {line.strip()}"
        else:
            entries.append(line.strip())
    found = []
    for entry in entries:
        match = re.match(r"([\w, .*]{1,60}): (.*)", entry, re.DOTALL)
        found.append(f"- `{match[1]}`: {_safe(match[2])}" if match else f"- {_safe(entry)}")
    return "\n".join(found)


def _safe(text: str) -> str:
    """Text outside of code, with what Markdown would take for its own made harmless."""
    pieces = re.split(r"(`[^`]*`)", text)
    for place in range(0, len(pieces), 2):
        for mark in ("*", "_", "<", "[", "|", "{", "#"):
            pieces[place] = pieces[place].replace(mark, f"\\{mark}")
    return "".join(pieces)
