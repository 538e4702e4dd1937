"""The options and arguments that several commands share."""

from __future__ import annotations

from collections.abc import Callable

import click

from . import completion
from .numbers import Seconds, Whole


class WithDefaultWork(click.Option):
    """An option whose help ends with the exact engine's default of `work`; the engine is loaded when that is read."""

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        from ...exact.engine import DEFAULT_WORK

        names, text = super().get_help_record(ctx) or ("", "")
        return names, f"{text} ({DEFAULT_WORK:,})."


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
    cls=WithDefaultWork,
    help="What one question may cost the exact engine before it is undecided, in counted units of about a microsecond",
)
SECONDS = click.option(
    "--max-seconds",
    type=Seconds(),
    metavar="S",
    help="End a run after S seconds, show what it has by then, and exit with 4.",
)
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
REFERENCE = click.option(
    "--reference",
    default="exact",
    show_default=True,
    metavar="E",
    shell_complete=completion.engine,
    help="The engine taken as the truth.",
)
HTML = click.option(
    "--html", metavar="FILE", shell_complete=completion.files, help="Also write the report as one offline HTML file."
)
CERTIFY = click.option(
    "--certify", is_flag=True, help="Attach a certificate of the reference's run, independently checked."
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
    JSON,
    HTML,
    CERTIFY,
)


def held_against(command: Callable[..., int]) -> Callable[..., int]:
    """Gives a command the options of all that hold runs against a reference, as `--help` lists them."""
    for option in reversed(HELD_AGAINST):
        command = option(command)
    return command


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
