"""`truebreak verify`: a certificate, checked."""

from __future__ import annotations

import click

from .. import completion
from ..options import Whole, examples
from ..progress import ExitCode


@click.command(epilog=examples("verify"))
@click.argument("file", metavar="FILE", shell_complete=completion.files)
@click.option(
    "--scene",
    metavar="SCENE",
    shell_complete=completion.scenes,
    help="The scene that it should be of: a name, or a file.",
)
@click.option("--work", type=Whole(), metavar="N", help="Units of work that checking may cost (by the size of FILE).")
def verify(file: str, scene: str | None, work: int | None) -> int:
    """Check a certificate by a program of its own.

    It shares nothing with the engines. `truebreak run --certificate FILE` writes certificates. With --scene the scene
    in the certificate is compared with SCENE, number by number.

    Exit codes: 0 verified, 1 refuted, 2 no certificate, 4 not decided with the bits that it allows, or declined as it
    costs more than --work.
    """
    from ...certificate.certified import verdict_of_scene

    code, sentence = verdict_of_scene(file, scene, work)
    click.echo(sentence, err=code == ExitCode.USAGE)
    return code
