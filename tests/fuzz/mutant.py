"""A fault to plant: an edit of one text, or of a few, in a private copy of the packages."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Mutant:
    """One fault that a programmer could make.

    Attributes:
        name: what it is called.
        file: where it is planted, from the project's top folder.
        old: text that occurs there exactly once.
        new: what stands there instead.
        breaks: what is wrong then.
        more: further edits, (file, old, new), where one does not do.
        why_it_survives: why no scene can show it; empty where the fuzz must find it.
    """

    name: str
    file: str
    old: str
    new: str
    breaks: str
    more: tuple[tuple[str, str, str], ...] = ()
    why_it_survives: str = ""

    @property
    def edits(self) -> tuple[tuple[str, str, str], ...]:
        """All edits, (file, old, new)."""
        return ((self.file, self.old, self.new), *self.more)

    def misplaced(self, top: Path) -> list[str]:
        """The edits that no longer apply: whose old text does not occur exactly once, or whose file is gone."""
        files = {file: top / file for file, _, _ in self.edits}
        texts = {file: path.read_text() if path.exists() else "" for file, path in files.items()}
        counts = [(file, old, texts[file].count(old)) for file, old, _ in self.edits]
        return [f"{self.name}: {file} has {old!r} {n} times, not once" for file, old, n in counts if n != 1]

    def plant(self, top: Path) -> None:
        """Makes the edits in a copy."""
        for file, old, new in self.edits:
            path = top / file
            path.write_text(path.read_text().replace(old, new))
