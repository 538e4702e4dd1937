"""`truebreak bench`: speed, in figures; its words are read by a reader of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from ..progress import DONE

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem


def _of_its_reader(context: click.Context, incomplete: str) -> list[CompletionItem]:
    """What that reader offers a shell after the words so far."""
    from click.shell_completion import ShellComplete

    from ...bench.command import command

    words = context.params.get("arguments") or ()
    return ShellComplete(command, {}, "truebreak bench", "").get_completions(list(words), incomplete)


class Bench(click.Command):
    """A command whose options are those of its reader, where a shell asks for them."""

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        """The reader's options that begin so."""
        return _of_its_reader(ctx, incomplete)


@click.command(
    cls=Bench, context_settings={"ignore_unknown_options": True, "help_option_names": []}, add_help_option=False
)
@click.argument(
    "arguments",
    nargs=-1,
    type=click.UNPROCESSED,
    shell_complete=lambda context, _, incomplete: _of_its_reader(context, incomplete),
)
def bench(arguments: tuple[str, ...]) -> int:
    """Measure speed, and print the figures."""
    from ...bench.command import main as bench_main

    return bench_main(list(arguments)) or DONE
