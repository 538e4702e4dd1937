"""`truebreak verify`: a certificate, checked."""

from __future__ import annotations

import click

from ..arguments import completion
from ..arguments.examples import examples
from ..exit_codes import ExitCode


@click.command(epilog=examples("verify"))
@click.argument("file", metavar="FILE", shell_complete=completion.files)
def verify(file: str) -> int:
    """Check a certificate by a program of its own.

    It shares nothing with the engines. `truebreak run --certificate FILE` writes certificates.

    Exit codes: 0 verified, 1 refuted, 2 no certificate, 4 not decided with the bits that it allows.
    """
    from ...certificate.certified import verdict_on

    code, sentence = verdict_on(file)
    click.echo(sentence, err=code == ExitCode.USAGE)
    return code
