"""The commands, by name: each is imported when it is asked for. Data on stdout, progress on stderr."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from importlib import import_module

import click

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
  truebreak chaos gas --events 400           when each engine will be lost
  truebreak sweep gas --vary seed=1..20      the same for a family of scenes
  truebreak minimise gas --engine double     the smallest scene that shows it
  truebreak advise gas:n=5 --events 12       the cheapest right setting
  truebreak stress near-ties                 how near a tie may be
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
    "run": "run",
    "scenes": "catalogue",
    "shadow": "shadow",
    "show": "catalogue",
    "stress": "stress",
    "suite": "suite",
    "survey": "suite",
    "sweep": "sweep",
    "verify": "verify",
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

    truebreak runs one scene of colliding circles and walls through engines that count differently, takes the
    exact one as the truth, and reports the first event where another engine's history leaves it, why, and
    what that did to the outcome.
    """
