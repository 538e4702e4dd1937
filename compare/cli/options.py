"""The options and arguments that several commands share, numbers among them, and the examples at the end of help."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

from ...scenarios.errors import shortened
from ...scenarios.lazy import frozen
from . import completion

if TYPE_CHECKING:
    from ...scenarios.engine import Engine
    from ...scenarios.scene import Scene


class Whole(click.ParamType):
    """A whole number, perhaps no less than some other.

    >>> Whole(1).convert("12", None, None)
    12
    >>> Whole(1).convert("1e3", None, None)
    Traceback (most recent call last):
      ...
    click.exceptions.BadParameter: '1e3' is not a whole number; write digits alone: 1000
    >>> Whole(1).convert("0", None, None)
    Traceback (most recent call last):
      ...
    click.exceptions.BadParameter: '0' is too small; write a whole number from 1
    """

    name = "whole number"

    def __init__(self, least: int | None = None) -> None:
        self.least = least

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int:
        text = str(value).strip()
        if text.isascii() and text.isdecimal() and len(text.lstrip("0")) > MOST_DIGITS:
            told = f"{shortened(text)!r} is too large; write a whole number of at most {MOST_DIGITS} digits"
            raise click.BadParameter(told, ctx=ctx, param=param)
        if not text.removeprefix("-").isdecimal() or not text.isascii() or len(text) > MOST_DIGITS:
            meant = _meant(text)
            wish = f"digits alone: {meant}" if meant is not None else "digits alone, such as 1000"
            raise click.BadParameter(f"{shortened(text)!r} is not a whole number; write {wish}", ctx=ctx, param=param)
        if self.least is not None and int(text) < self.least:
            told = f"{text!r} is too small; write a whole number from {self.least}"
            raise click.BadParameter(told, ctx=ctx, param=param)
        return int(text)


MOST_DIGITS = 18
"""Longest number taken: counts beyond it are never reached."""


def _meant(text: str) -> int | None:
    """The whole number that a text such as 1e3, 2.0 or 1_000 means; None if it means none."""
    try:
        value = float(text.replace(",", ""))
    except (ValueError, OverflowError):
        return None
    return int(value) if abs(value) < 10.0**MOST_DIGITS and value == int(value) else None


class Seconds(click.ParamType):
    """A number of seconds above zero.

    >>> Seconds().convert("2.5", None, None)
    2.5
    >>> Seconds().convert("soon", None, None)
    Traceback (most recent call last):
      ...
    click.exceptions.BadParameter: 'soon' is not a number of seconds above 0; write one such as 2.5
    """

    name = "seconds"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        try:
            seconds = float(value)
        except (ValueError, OverflowError):
            seconds = 0.0
        if not 0 < seconds < float("inf"):
            told = f"{shortened(str(value))!r} is not a number of seconds above 0; write one such as 2.5"
            raise click.BadParameter(told, ctx=ctx, param=param)
        return seconds


# ----------------------------------------
# The options and arguments that several commands share.

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
    from ...exact.exact_engine import DEFAULT_WORK

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
    from ..foreign.isolation import isolated

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
VERBOSE = click.option("-v", "--verbose", is_flag=True, help="Show everything: the default is the answer alone.")
JSON = click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of text.")
REFERENCE = one_engine("The engine taken as the truth.", name="reference", option="--reference")
HTML = a_file("--html", help="Also write the report as one offline HTML file.")
JOBS = click.option("--jobs", type=Whole(1), metavar="N", help="Worker processes; else one for each processor.")
STORE = a_file("--store", help="Keep the rows in this SQLite file, and make none that it has: it resumes.")
GRID_HTML = a_file("--html", help="Write one page: scenes by engines, to filter and sort.")
REPORTS = click.option(
    "--reports", is_flag=True, help="With --html: a report of each row that does not agree, beside it."
)
AGAINST = a_file(
    "--against",
    help="With --html: what changed since the rows of this file, which an earlier --store wrote, as a column.",
)


def exit_zero(help: str) -> Option:
    """The option `--exit-zero`."""
    return click.option("--exit-zero", is_flag=True, help=help)


CERTIFY = click.option(
    "--certify", "certified", is_flag=True, help="Attach a certificate of the reference's run, independently checked."
)

REFERENCE_OPTIONS = (
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
    VERBOSE,
    JSON,
    HTML,
    CERTIFY,
)


@frozen
class ReferenceOptions:
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
    verbose: bool
    as_json: bool
    html: str | None
    certified: bool

    def scene(self, name: str) -> Scene:
        """The scene of that name, as the options change it."""
        from ..scene_argument import changed

        limited = bool(self.until or self.events)
        return changed(name, self.reverse_after, self.tie_policy, limited=limited, symmetric=self.symmetric)

    def engine(self) -> Engine:
        """The reference."""
        from ..files.cache import reference_named
        from ..scene_argument import with_settings

        return reference_named(with_settings(self.reference, ties=self.ties, work=self.work), cache=not self.no_cache)


def reference_options(command: Callable[..., int]) -> Callable[..., int]:
    """Gives a command the options of `ReferenceOptions`, as `--help` lists them, in one argument `asked`."""

    @wraps(command)
    def gathered(**given: Any) -> int:
        return command(
            asked=ReferenceOptions(**{field.name: given.pop(field.name) for field in fields(ReferenceOptions)}), **given
        )

    whole: Callable[..., int] = gathered
    for option in reversed(REFERENCE_OPTIONS):
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


# ----------------------------------------
# The ends of the commands' help: what SCENE is, and examples to copy.

LINES = {
    "scenes": ("truebreak scenes", "truebreak scenes --json"),
    "show": (
        "truebreak show lee",
        "truebreak show rack:rows=3 --plot rack.svg",
        "truebreak show gas:n=20,seed=7 --json > gas.json",
    ),
    "run": (
        "truebreak run galperin:n=2 --json",
        "truebreak run tennis --exact",
        "truebreak run gas --engine pymunk:dt=1/1000,iterations=30 --events 100",
        "truebreak run lee --certificate lee.json",
        "truebreak run gas --events 200 --save gas-run.json",
        "truebreak run --resume gas-run.json --events 400 --save gas-run.json",
    ),
    "verify": ("truebreak run lee --certificate lee.json", "truebreak verify lee.json --scene lee"),
    "compare": (
        "truebreak compare cradle --engines double",
        "truebreak compare gas --events 200 --html report.html",
        "truebreak compare galperin:n=2 --engines single,double,pymunk:dt=1/1000",
        "truebreak compare gas --reverse-after 50 --engines double",
    ),
    "vectors": (
        "truebreak vectors",
        "truebreak vectors --count 100 --engines double,pymunk.segment_query -v",
        "truebreak vectors --count 100000 --seed 7 --out .",
    ),
    "export": (
        "truebreak export gas:n=3 > gas.json",
        "truebreak export gas --floats --out gas-floats.json",
        "truebreak export gas --floats --csv > gas.csv",
    ),
    "orders": (
        "truebreak orders lee",
        "truebreak orders rack:rows=2 --events 3 --html orders.html",
        "truebreak orders lee --json",
    ),
}
"""Examples of each command; a test runs what they say through the command line's own reader."""

CODES = {
    "run": ("0 done   2 usage, or bad scene", "4 undecided, or a budget spent   130 interrupted"),
    "compare": (
        "0 all agree, or --exit-zero   1 an engine diverged   2 usage, or bad scene",
        "4 none diverged, but something is not settled or undecided   130 interrupted",
    ),
    "orders": (
        "0 done, or cut by --cap   2 usage, or bad scene",
        "4 --max-seconds came first   130 interrupted",
    ),
}
"""What the exit codes say, of commands that tell it below their examples."""

WITHOUT_SCENE = ("scenes", "verify", "vectors")
"""Commands that take no scene."""


def examples(command: str) -> str:
    """The end of a command's help.

    >>> examples("verify").splitlines()[1:]
    ['Examples:', '  truebreak run lee --certificate lee.json', '  truebreak verify lee.json --scene lee']
    """
    shown = "\n".join(["\b", "Examples:", *(f"  {line}" for line in LINES[command])])
    if command in CODES:
        shown += "\n\n" + "\n".join(["\b", "Exit codes:", *(f"  {line}" for line in CODES[command])])
    return shown if command in WITHOUT_SCENE else f"{SCENE_HELP}\n\n{shown}"


# ----------------------------------------
# The command line told again, so that a report can name what made it.


def command_of(context: click.Context) -> str:
    """The command line of a context: what was given, in the order of the command's options, without the defaults."""
    import shlex

    words = [context.command_path]
    for parameter in context.command.params:
        if parameter.name is None or context.get_parameter_source(parameter.name) is not GIVEN:
            continue
        value = context.params[parameter.name]
        if isinstance(parameter, click.Argument):
            words += [shlex.quote(str(one)) for one in (value if isinstance(value, tuple) else (value,))]
        elif isinstance(parameter, click.Option) and parameter.is_flag:
            words.append(parameter.opts[0])
        else:
            words += [parameter.opts[0], shlex.quote(str(value))]
    return " ".join(words)


GIVEN = click.core.ParameterSource.COMMANDLINE
"""Where a value comes from that the user has typed."""
