"""The options and arguments that several commands share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

from . import completion
from .numbers import Seconds, Whole

if TYPE_CHECKING:
    from ....scenarios.engine import Engine
    from ....scenarios.scene import Scene

Option = Callable[[Callable[..., int]], Callable[..., int]]
"""What gives a command an option."""


class WithDefault(click.Option):
    """An option whose help ends with its default, which is loaded when that is read.

    Args:
        told: gives the default as text.
    """

    def __init__(self, *names: Any, told: Callable[[], str], **settings: Any) -> None:
        super().__init__(*names, **settings)
        self._told = told

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        names, text = super().get_help_record(ctx) or ("", "")
        return names, f"{text} ({self._told()})."


def _default_work() -> str:
    from ....exact.exact_engine import DEFAULT_WORK

    return f"{DEFAULT_WORK:,}"


def one_engine(help: str, default: str | None = "exact", name: str = "engine_text", option: str = "--engine") -> Option:
    """An option that names an engine; without a default, one that has to be given."""
    given: dict[str, Any] = {"required": True} if default is None else {"default": default, "show_default": True}
    return click.option(option, name, metavar="E", shell_complete=completion.engine, help=help, **given)


def some_engines(help: str, default: str | None, **settings: Any) -> Option:
    """The option `--engines`, which names several; its default is shown, if there is one."""
    if default:
        settings |= {"show_default": True}
    return click.option(
        "--engines", default=default, metavar="A,B,...", shell_complete=completion.engines, help=help, **settings
    )


def a_file(*names: str, help: str, **settings: Any) -> Option:
    """An option that names a file."""
    return click.option(*names, metavar="FILE", shell_complete=completion.files, help=help, **settings)


SCENE_HELP = (
    "SCENE is a name from `truebreak scenes`, perhaps with parameters (galperin:n=2), or a .toml or .json file."
)


SCENE = click.argument("scene", metavar="SCENE", shell_complete=completion.scenes)
OPTIONAL_SCENE = click.argument("scene", metavar="SCENE", required=False, shell_complete=completion.scenes)
UNTIL = click.option("--until", metavar="T", help='Stop at this time: exact text such as 12, 9/4 or "10*sqrt(2)".')
EVENTS = click.option("--events", type=Whole(1), metavar="N", help="Stop after N instants of collision.")
REVERSE = click.option(
    "--reverse-after",
    type=Whole(1),
    metavar="N",
    help="Negate every velocity once, after N instants.",
)
POLICY = click.option(
    "--tie-policy",
    metavar="P",
    help="simultaneous, sequential:order=scene or sequential:seed=N; else the scene's own.",
)
TIES = click.option(
    "--ties",
    metavar="RULE",
    help="What the exact engine takes for a tie: proved (default), or assume:BITS where proof fails.",
)
WORK = click.option(
    "--work",
    type=Whole(1),
    metavar="N",
    cls=WithDefault,
    told=_default_work,
    help="What one question may cost the exact engine before it is undecided, in counted units of about a microsecond",
)
SECONDS = click.option(
    "--max-seconds",
    type=Seconds(),
    metavar="S",
    help="End a run after S seconds, show what it has by then, and exit with 4.",
)


def _isolated(context: click.Context, parameter: click.Parameter, given: bool | int | None) -> None:
    """Isolates what is run until the command ends."""
    if not given or context.resilient_parsing:
        return
    from ...foreign.isolation import isolated

    context.with_resource(isolated(max_memory=None if given is True else int(given)))


def isolating(command: Callable[..., int]) -> Callable[..., int]:
    """Gives a command that runs engines the options that isolate those which are not truebreak's own."""
    isolate = click.option(
        "--isolate",
        is_flag=True,
        expose_value=False,
        callback=_isolated,
        help="Run engines that are not truebreak's own in a process of their own, which is ended if it does not end, "
        "forks, or takes too much memory. A limit of seconds does so too.",
    )
    memory = click.option(
        "--max-memory",
        type=Whole(1),
        expose_value=False,
        callback=_isolated,
        metavar="MB",
        help="--isolate, and let such a process take so many megabytes more than truebreak has; "
        "else half of the machine's memory.",
    )
    return isolate(memory(command))


SYMMETRIC = click.option(
    "--symmetric",
    is_flag=True,
    help="Refuse a scene that no mirror and no rotation maps to itself: its ties could not be proved by symmetry.",
)
NO_CACHE = click.option(
    "--no-cache",
    is_flag=True,
    help="Make every certified run anew: use none that was kept by an earlier call, and keep none.",
)
JSON = click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of text.")
REFERENCE = one_engine("The engine taken as the truth.", name="reference", option="--reference")
HTML = a_file("--html", help="Also write the report as one offline HTML file.")
CERTIFY = click.option(
    "--certify", "certified", is_flag=True, help="Attach a certificate of the reference's run, independently checked."
)

HELD_AGAINST = (
    REFERENCE,
    UNTIL,
    EVENTS,
    REVERSE,
    POLICY,
    TIES,
    WORK,
    SECONDS,
    SYMMETRIC,
    NO_CACHE,
    isolating,
    JSON,
    HTML,
    CERTIFY,
)


@dataclass(frozen=True)
class HeldAgainst:
    """What the command line says, in options that all commands have that hold runs against a reference."""

    reference: str
    until: str | None
    events: int | None
    reverse_after: int | None
    tie_policy: str | None
    ties: str | None
    work: int | None
    max_seconds: float | None
    symmetric: bool
    no_cache: bool
    as_json: bool
    html: str | None
    certified: bool

    def scene(self, name: str) -> Scene:
        """The scene of that name, as the options change it."""
        from ...scene_argument import changed

        limited = bool(self.until or self.events)
        return changed(name, self.reverse_after, self.tie_policy, limited=limited, symmetric=self.symmetric)

    def engine(self) -> Engine:
        """The reference."""
        from ...saved.cache import reference_named
        from ...scene_argument import with_settings

        return reference_named(with_settings(self.reference, ties=self.ties, work=self.work), cache=not self.no_cache)


def held_against(command: Callable[..., int]) -> Callable[..., int]:
    """Gives a command the options of `HeldAgainst`, as `--help` lists them, in one argument `held`."""

    @wraps(command)
    def gathered(**given: Any) -> int:
        return command(
            held=HeldAgainst(**{field.name: given.pop(field.name) for field in fields(HeldAgainst)}), **given
        )

    whole: Callable[..., int] = gathered
    for option in reversed(HELD_AGAINST):
        whole = option(whole)
    return whole


def required(scene: str | None) -> str:
    """The scene of the command line.

    Raises:
        click.UsageError: if there is none.
    """
    if scene is None:
        raise click.UsageError("Missing argument 'SCENE'.", click.get_current_context())
    return scene


def refuse_beside(option: str, names: tuple[str, ...]) -> None:
    """Refuses what an option has of its own already.

    Raises:
        click.UsageError: naming what was given beside it.
    """
    context = click.get_current_context()
    for parameter in context.command.params:
        given = context.get_parameter_source(parameter.name or "")
        if parameter.name in names and given is not click.core.ParameterSource.DEFAULT:
            shown = parameter.opts[0] if isinstance(parameter, click.Option) else "SCENE"
            raise click.UsageError(f"{shown} is in the file that {option} reads; leave it out", context)
