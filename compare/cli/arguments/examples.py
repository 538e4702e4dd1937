"""The ends of the commands' help: what SCENE is, and examples to copy."""

from __future__ import annotations

from .options import SCENE_HELP

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

WITHOUT_SCENE = ("scenes", "verify")
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
