"""`truebreak bench`: speed, in figures; its words are read by a reader of its own."""

from __future__ import annotations

import click

from ..exit_codes import DONE


@click.command(context_settings={"ignore_unknown_options": True, "help_option_names": []}, add_help_option=False)
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED)
def bench(arguments: tuple[str, ...]) -> int:
    """Measure speed, and print the figures."""
    from ...bench.command import main as bench_main

    return bench_main(list(arguments)) or DONE
