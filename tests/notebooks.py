"""Runs the notebooks of docs/notebooks cell by cell; `python tests/notebooks.py` writes what they print into them."""

from __future__ import annotations

import contextlib
import io
import json
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


def played(path: Path) -> dict[str, Any]:
    """The notebook with what each code cell prints now."""
    book = json.loads(path.read_text("utf-8"))
    names: dict[str, Any] = {"__name__": "notebook"}
    count = 0
    for number, cell in enumerate(book["cells"]):
        if cell["cell_type"] != "code":
            continue
        count += 1
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile("".join(cell["source"]), f"{path.name}, cell {number}", "exec", dont_inherit=True), names)
        text = printed.getvalue()
        cell["execution_count"] = count
        cell["outputs"] = [{"name": "stdout", "output_type": "stream", "text": text.splitlines(True)}] if text else []
    return book


def text_of(book: dict[str, Any]) -> str:
    """A notebook as its file has it."""
    return json.dumps(book, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    for notebook in NOTEBOOKS:
        notebook.write_text(text_of(played(notebook)), "utf-8")
