"""Comparisons in files: the report for any reader, and all that they are made of."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Annotated, Any, TypedDict

from ..scenarios.disk import InSchema, Seal, text_of
from .writing import write_whole

if TYPE_CHECKING:
    from .comparison import Comparison


class SavedComparison(TypedDict):
    """A comparison: as people are shown it, and all that it is made of."""

    schema: str
    version: str
    comparison: Annotated[dict[str, Any], InSchema(title="What --json prints: comparison-5")]
    objects: Annotated[
        dict[str, Any],
        InSchema(
            required=["is", "has"],
            properties={"is": {"const": "compare.comparison:Comparison"}, "has": {"type": "object"}},
        ),
    ]
    roots: list[list[str]]
    digest: Annotated[str, InSchema(pattern="^[0-9a-f]{64}$")]


COMPARISON = Seal("truebreak/saved-comparison-1", "comparison", "truebreak compare SCENE --save FILE")


def save_comparison(comparison: Comparison, path: str | os.PathLike[str]) -> None:
    """Writes a comparison to a file that `load_comparison` reads: all of it, or nothing.

    Raises:
        SceneError: if it holds what no file can, such as settings or outcomes of classes of your own, or if the place
            cannot be written to.
    """
    write_whole(os.fspath(path), saved_comparison(comparison))


def saved_comparison(comparison: Comparison) -> str:
    """The text of such a file.

    >>> from truebreak.compare import compare
    >>> from truebreak.scenarios import catalogue
    >>> found = compare(catalogue.build("near-tie:k=40"), ["double"], events=2)
    >>> again = comparison_of(saved_comparison(found))
    >>> again.verdict, again.reference.events[1].time.text() == found.reference.events[1].time.text()
    ('diverged', True)
    """
    from .files.codec import Writer
    from .report.documents import comparison_json

    writer = Writer()
    data = {"comparison": comparison_json(comparison), "objects": writer(comparison)}
    data = json.loads(json.dumps({**data, "roots": writer.roots}))
    return json.dumps(COMPARISON.sealed(data)) + "\n"


def load_comparison(path: str | os.PathLike[str]) -> Comparison:
    """The comparison in a file that `truebreak compare --save FILE` wrote, exact values and logs included.

    The digest in the file tells damage, not forgery; only objects of truebreak's own are made of it.

    Raises:
        SceneError: one line, for a file that is not there, is none of these, is damaged or is of another version.
    """
    where = os.fspath(path)
    return comparison_of(text_of(where, remedy="give the path of a saved comparison", strict=False), where)


def comparison_of(text: str, where: str = "the text") -> Comparison:
    """The comparison in the text of such a file; `where` names it in errors.

    Raises:
        SceneError: as `load_comparison`.
    """
    from .comparison import Comparison
    from .files.codec import Reader

    known = COMPARISON.opened(text, where)
    try:
        found = Reader(known["roots"])(known["objects"])
    except (ArithmeticError, AssertionError, AttributeError, LookupError, RecursionError, TypeError, ValueError):
        raise COMPARISON.damaged(where) from None
    if not isinstance(found, Comparison):
        raise COMPARISON.damaged(where)
    return found
