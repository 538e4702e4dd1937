"""Fish's script of completion, as click has it but for one thing."""

from __future__ import annotations

from click.shell_completion import FishComplete, add_completion_class


@add_completion_class
class Fish(FishComplete):
    """Fish's script, which would cut a list of engines, or of settings, at its first comma."""

    source_template = FishComplete.source_template.replace('string split ","', 'string split --max 1 ","')
