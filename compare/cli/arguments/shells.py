"""Scripts of completion, as click has them but for one thing each."""

from __future__ import annotations

from typing import TYPE_CHECKING

from click.shell_completion import FishComplete, ZshComplete, add_completion_class

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem


@add_completion_class
class Fish(FishComplete):
    """Fish's script, which would cut a list of engines, or of settings, at its first comma."""

    source_template = FishComplete.source_template.replace('string split ","', 'string split --max 1 ","')


@add_completion_class
class Zsh(ZshComplete):
    """Zsh's answers, in which click 8.1 escapes no colon, so that scenes would be cut before their parameters."""

    def format_completion(self, item: CompletionItem) -> str:
        """One word, with what it is; where that is told, zsh takes the first colon for the end of the word."""
        word = item.value.replace(":", "\\:") if item.help else item.value
        return f"{item.type}\n{word}\n{item.help or '_'}"
