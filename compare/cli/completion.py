"""What a shell completes: scenes with their parameters, files of scenes, engines with their settings."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    import click
    from click.shell_completion import CompletionItem


def scenes(context: click.Context, parameter: click.Parameter, typed: str) -> list[CompletionItem]:
    """Scenes of the catalogue; after `NAME:`, its parameters with their defaults; files besides.

    Files stand first: bash's script forgets what came before them, and looks for them where nothing comes after.

    >>> [item.value for item in scenes(None, None, "galp") if item.type == "plain"]
    ['galperin']
    >>> [item.value for item in scenes(None, None, "galperin:")]
    ['galperin:n=2']
    """
    from ...scenarios import catalogue

    name, colon, rest = typed.partition(":")
    if not colon:
        found = [_offer(n, told=catalogue.entry(n).summary) for n in catalogue.names() if n.startswith(name)]
        return [_offer(typed, "file"), *found]
    if name not in catalogue.names():
        return []
    parameters = [(p.name, p.default, p.help) for p in catalogue.entry(name).parameters]
    return _settings(f"{name}:", rest, parameters)


def engine(context: click.Context, parameter: click.Parameter, typed: str) -> list[CompletionItem]:
    """Engines; after `NAME:`, their settings with their defaults.

    >>> [item.value for item in engine(None, None, "pymunk:it")]
    ['pymunk:iterations=64']
    """
    import dataclasses

    from ..engines import ENGINES

    name, colon, rest = typed.partition(":")
    if not colon:
        return [_offer(n, told=e.summary) for n, e in ENGINES.items() if n.startswith(name)]
    if name not in ENGINES:
        return []
    fields = dataclasses.fields(ENGINES[name].load())
    known = [(f.name, str(f.default), "") for f in fields if f.init and f.default is not dataclasses.MISSING]
    return _settings(f"{name}:", rest, known)


def engines(context: click.Context, parameter: click.Parameter, typed: str) -> list[CompletionItem]:
    """A list of engines: the last of them.

    >>> [item.value for item in engines(None, None, "double,sin")]
    ['double,single']
    """
    before, comma, last = typed.rpartition(",")
    whole = f"{before}{comma}"
    return [_offer(f"{whole}{item.value}", told=item.help) for item in engine(context, parameter, last)]


def among(names: Iterable[str]) -> Callable[[click.Context, click.Parameter, str], list[CompletionItem]]:
    """Completes a list of some names: the last of them.

    >>> [item.value for item in among(["gas", "gap", "rack"])(None, None, "rack,ga")]
    ['rack,gas', 'rack,gap']
    """

    def offered(context: click.Context, parameter: click.Parameter, typed: str) -> list[CompletionItem]:
        before, comma, last = typed.rpartition(",")
        return [_offer(f"{before}{comma}{name}") for name in names if name.startswith(last)]

    return offered


def files(context: click.Context, parameter: click.Parameter, typed: str) -> list[CompletionItem]:
    """Files; the shell looks them up."""
    return [_offer(typed, "file")]


def folders(context: click.Context, parameter: click.Parameter, typed: str) -> list[CompletionItem]:
    """Folders; the shell looks them up."""
    return [_offer(typed, "dir")]


def _settings(start: str, rest: str, known: list[tuple[str, str, str]]) -> list[CompletionItem]:
    """The settings that fit after those given."""
    before, comma, last = rest.rpartition(",")
    given = {part.partition("=")[0] for part in before.split(",")}
    start = f"{start}{before}{comma}"
    return [
        _offer(f"{start}{key}={value}", told=told or None)
        for key, value, told in known
        if key not in given and key.startswith(last)
    ]


def _offer(value: str, kind: str = "plain", told: str | None = None) -> CompletionItem:
    """One thing to choose; click's module for it is imported when a shell asks."""
    from click.shell_completion import CompletionItem

    return CompletionItem(value, type=kind, help=told)


def mended_scripts() -> None:
    """Registers the scripts of shells as click has them but for one thing each."""
    from click.shell_completion import FishComplete, ZshComplete, add_completion_class

    @add_completion_class
    class Fish(FishComplete):  # pyright: ignore[reportUnusedClass]
        """Fish's script, which would cut a list of engines, or of settings, at its first comma."""

        source_template = FishComplete.source_template.replace('string split ","', 'string split --max 1 ","')

    @add_completion_class
    class Zsh(ZshComplete):  # pyright: ignore[reportUnusedClass]
        """Zsh's answers, in which click 8.1 escapes no colon, so that scenes would be cut before their parameters."""

        def format_completion(self, item: CompletionItem) -> str:
            """One word, with what it is; where that is told, zsh takes the first colon for the end of the word."""
            word = item.value.replace(":", "\\:") if item.help else item.value
            return f"{item.type}\n{word}\n{item.help or '_'}"
