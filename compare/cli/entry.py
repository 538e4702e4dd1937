"""The command line: its commands by name, one line for what goes wrong, and the exit code."""

from __future__ import annotations

import errno
import math
import os
import signal
import sys
import threading
import time as clock
import warnings
from collections.abc import Iterator, MutableMapping
from contextlib import contextmanager
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, TextIO

import click

from .progress import DONE, ExitCode

EXAMPLES = """
\b
Examples:
  truebreak scenes                           what there is to play with
  truebreak compare cradle --engines double  did floats change what happened?
  truebreak compare gas:n=10,seed=1 --events 200 --html report.html
  truebreak run galperin:n=2 --json          314 collisions: the digits of pi
  truebreak run tennis --exact               every number as an expression
  truebreak run gas --save gas-run.json      keeps the run, with its log
  truebreak run --resume gas-run.json        go on from what --save wrote
  truebreak run lee --certificate lee.json   then: truebreak verify lee.json
  truebreak judge gas log.jsonl              the log of any engine
  truebreak diff pc.jsonl phone.jsonl        where do two runs part, and why?
  truebreak export gas --floats              the scene for such an engine
  truebreak orders lee                       what orders of impulses lead to
  truebreak chaos gas --events 400           how long to trust each engine
  truebreak sweep gas --vary seed=1..20      the same for a family of scenes
  truebreak minimise gas --engine double     the smallest scene that shows it
  truebreak advise gas:n=5 --events 12       the cheapest right setting
  truebreak stress near-ties                 how near a tie may be
  truebreak vectors --out .                  first meetings, to score your own
  truebreak play                             draw and throw, in a browser
  truebreak show rack:rows=3 --plot rack.svg

\b
Exit codes:
  0 agree, or done   1 diverged   2 usage or bad scene   3 internal error
  4 not settled, undecided, or budget spent
  130 interrupted   143 by SIGTERM   129 by SIGHUP: what is there is kept
"""

PLACES = {
    "advise": "advise",
    "bench": "bench",
    "chaos": "chaos",
    "compare": "compare",
    "diff": "diff",
    "export": "foreign",
    "judge": "foreign",
    "minimise": "minimise",
    "orders": "orders",
    "play": "play",
    "run": "run",
    "scenes": "catalogue",
    "shadow": "shadow",
    "show": "catalogue",
    "stress": "stress",
    "suite": "suite",
    "survey": "suite",
    "sweep": "sweep",
    "vectors": "vectors",
    "verify": "run",
}
"""The module of each command in `commands`, where it is called as here. A new command adds its file and one line."""


class Commands(MutableMapping[str, click.Command]):
    """The commands of a table such as `PLACES`.

    >>> sorted(Commands({"show": "catalogue"}))
    ['show']
    >>> Commands({"show": "catalogue"})["show"].name
    'show'
    """

    def __init__(self, places: dict[str, str]) -> None:
        self._places, self._loaded = dict(places), dict[str, click.Command]()

    def __getitem__(self, name: str) -> click.Command:
        if name not in self._loaded:
            self._loaded[name] = getattr(import_module(f".commands.{self._places[name]}", __package__), name)
        return self._loaded[name]

    def __setitem__(self, name: str, command: click.Command) -> None:
        self._places[name], self._loaded[name] = name, command

    def __delitem__(self, name: str) -> None:
        del self._places[name]
        self._loaded.pop(name, None)

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)


def _version(context: click.Context, parameter: click.Parameter, asked: bool) -> None:
    """One line: the version, and what is compiled."""
    if not asked or context.resilient_parsing:
        return
    from ...scenarios.lazy import VERSION

    click.echo(f"truebreak {VERSION} ({_compiled_parts()})")
    context.exit()


def _compiled_parts() -> str:
    """Whether compiled parts are in use, in words."""
    import os

    from ...exact.compiled import PURE, cells, predictions, steps
    from ...floating.flat.flat_meetings import compiled

    parts = {"predictions": predictions, "cells": cells, "steps": steps, "double": compiled}
    missing = [name for name, part in parts.items() if part is None]
    if not missing:
        return "compiled parts in use"
    if len(missing) < len(parts):
        return f"compiled parts in use, but for {', '.join(missing)}"
    return f"pure Python: {f'{PURE} is set' if os.environ.get(PURE) else 'no compiled parts are installed'}"


@click.group(
    commands=Commands(PLACES),
    epilog=EXAMPLES,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110},
)
@click.option("--debug", is_flag=True, help="Show the traceback of an internal error.")
@click.option("--version", is_flag=True, is_eager=True, expose_value=False, callback=_version,
              help="Show the version, and whether compiled parts are in use, and exit.")  # fmt: skip
def cli(debug: bool) -> None:
    """Says, provably, whether and where floating-point error changed what happened.

    truebreak runs one scene of colliding circles and walls through engines with different arithmetic, takes the
    exact one as the truth, and reports the first event where another engine's history leaves it, why, and
    what that did to the outcome.
    """


# ----------------------------------------
# Runs the command line: one line for what went wrong, and the exit code.


def main(arguments: list[str] | None = None) -> None:
    """Runs the command line and exits with its code; see `ExitCode`.

    Bad input is one line on stderr. Other errors are one line too, and a traceback with `--debug`.
    """
    given = list(sys.argv[1:] if arguments is None else arguments)
    if "_TRUEBREAK_COMPLETE" in os.environ:
        from .completion import mended_scripts

        mended_scripts()
        cli.main(given, prog_name="truebreak")
    _open_streams()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # for small matrices threads cost more
    debug = "--debug" in given
    words = [word for word in given if word != "--debug"]
    ended = Ended()
    try:
        with ended.by_signals():
            code = _run(words)
            sys.stdout.flush()
    except KeyboardInterrupt:
        _say(f"truebreak: {ended.told}")
        code = ExitCode.INTERRUPTED
    except BrokenPipeError:
        _drop_stdout()
        code = ExitCode.PIPE_CLOSED
    except OSError as error:
        if error.errno not in (errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EFBIG) or error.filename is not None:
            code = _internal(error, debug)
        else:
            _drop_stdout()
            _say(f"truebreak: error: standard output: {error.strerror}; write to another place")
            code = ExitCode.USAGE
    except Exception as error:
        code = _internal(error, debug)
    sys.exit(ended.code(code))


ONE_SECONDS = 5.0
"""Signals to end that come within so many seconds are one: to stop a service, or close a terminal, sends several."""


class Ended:
    """SIGTERM and SIGHUP end a command as Ctrl-C does, so that it keeps and shows what is there.

    Who has them ignored, as `nohup` does with SIGHUP, is not bothered.
    """

    def __init__(self) -> None:
        self._number: int | None = None
        self._since = -math.inf

    @contextmanager
    def by_signals(self) -> Iterator[None]:
        """Takes them as that in its body, in the main thread."""
        before = {}
        if threading.current_thread() is threading.main_thread():
            for name in ("SIGTERM", "SIGHUP"):
                number = getattr(signal, name, None)  # Windows has no SIGHUP
                if number is not None and signal.getsignal(number) is signal.SIG_DFL:
                    before[number] = signal.signal(number, self._raise)
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    def _raise(self, number: int, frame: object) -> None:
        now = clock.monotonic()
        if now >= self._since + ONE_SECONDS:
            self._number, self._since = number, now
            raise KeyboardInterrupt

    @property
    def told(self) -> str:
        """What happened, in a word or two."""
        return "interrupted" if self._number is None else f"ended by {signal.Signals(self._number).name}"

    def code(self, code: int) -> int:
        """The exit code: 128 and the signal's number, where it ended the command, or took its terminal away."""
        if self._number is not None and code in (ExitCode.INTERRUPTED, ExitCode.PIPE_CLOSED, ExitCode.USAGE):
            return 128 + self._number
        return int(code)


def _internal(error: Exception, debug: bool) -> ExitCode:
    """One line about an error that should not have come about, or its traceback."""
    if debug:
        import traceback

        traceback.print_exc()
    reason = " ".join(str(error).split())
    _say(f"truebreak: internal error: {type(error).__name__}: {reason} (add --debug for the traceback)")
    return ExitCode.INTERNAL


def _open_streams() -> None:
    """Gives a stream that the caller has closed a place that forgets: the exit code is still to be had."""
    sys.stdout, sys.stderr = sys.stdout or _nowhere(), sys.stderr or _nowhere()


def _nowhere() -> TextIO:
    """A place that forgets what is written to it, open to the end of the program."""
    return Path(os.devnull).open("w", encoding="utf-8")


def _drop_stdout() -> None:
    """Has what is still to be written to stdout forgotten, so that nothing fails a second time at the end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _run(words: list[str]) -> int:
    """One command; click's own errors and bad scenes become one line and a code."""
    warnings.showwarning = partial(_warned, warnings.showwarning)
    if not words:  # which versions of click answer in different ways
        click.echo(cli.get_help(click.Context(cli, info_name="truebreak", **cli.context_settings)), err=True)
        return ExitCode.USAGE
    try:
        with cli.make_context("truebreak", words) as context:
            code = cli.invoke(context)
        return code if isinstance(code, int) else DONE
    except click.exceptions.Exit as stop:
        return stop.exit_code
    except click.UsageError as error:
        command = error.ctx.command_path if error.ctx else Path("truebreak").name
        _say(f"truebreak: error: {_in_short(error.format_message())} (see {command} --help)")
        return ExitCode.USAGE
    except Exception as error:
        from ...scenarios.errors import SceneError
        from ..deadline import OutOfTime

        if isinstance(error, OutOfTime):
            _say(f"truebreak: out of time, with nothing to show yet: {error}")
            return ExitCode.UNDECIDED
        if not isinstance(error, SceneError):
            raise
        _say(f"truebreak: error: {_in_short(str(error))}")
        return ExitCode.USAGE


def _warned(others: Any, message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
    """Shows a warning that is meant for the user as one line, others as Python does."""
    if getattr(category, "in_one_line", False):
        _say(f"truebreak: warning: {_in_short(str(message))}")
    else:
        others(message, category, *place, **more)


LONGEST_WORD, LONGEST_ERROR = 240, 900
"""Characters of one word, and of a whole error, that are repeated: a path is whole, a pasted file is not."""


def _in_short(text: str) -> str:
    """An error on one line, with what is too long to be read cut out of its middle.

    >>> _in_short("one\\n two"), len(_in_short("x" * 5000)) < 300
    ('one two', True)
    """
    words = [_cut(word, LONGEST_WORD) for word in text.split()]
    return _cut(" ".join(words), LONGEST_ERROR)


def _cut(text: str, longest: int) -> str:
    if len(text) <= longest:
        return text
    half = longest // 2
    return f"{text[:half]}... ({len(text):,} characters) ...{text[-half:]}"


def _say(line: str) -> None:
    """One line on stderr, which may be closed; of what a file or an engine says, nothing that a terminal acts on."""
    from ...scenarios.errors import printable

    try:
        click.echo(printable(line), err=True)
    except OSError:
        return
