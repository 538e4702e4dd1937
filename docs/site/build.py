"""Builds the documentation as a site that needs no network: `python docs/site/build.py [--short] [--out FOLDER]`.

The pages of `docs/` and of the project's top go in as they are. The pages of the catalogue with their pictures and
reports, the derivations and the API are made here, by running the program. Warnings are errors, and every link is
checked.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from api import api_pages
from catalogue import VERDICTS, Told, catalogue_page, gallery, moving_picture, picture, report, scene_page, verdicts
from laws import laws_page
from links import broken, same_titles
from playground import NotToBeHad, write_playground

from truebreak.scenarios import catalogue

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
TOP = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md", "LICENSE")

SHORT = ("lee", "near-tie")
"""Scenes that have a report in a short build."""

INDEX = """\
# Did floating point change what happened?

```{include} README.md
:start-after: "what happened?**"
:end-before: "![A report"
```

```{include} README.md
:start-after: "docs/report.png)"
:end-before: "And this sets up"
```

New here? [Ten minutes](docs/tutorial.md) lead from an installation to a report of a scene of your own.

{play}

## Three ways in

- **I have a report to read.** [How to read the report](README.md#how-to-read-the-report), then
  [Comparison](docs/comparison.md) for what each line means.
- **I have an engine to test.** [Your engine](docs/your-engine.md), then
  [Is it floating point, or my bug?](docs/floating-point-or-bug.md) and [in pytest](docs/pytest.md).
- **I have a question about chaos.** [Chaos, measured](docs/chaos.md), then [Sweeps](docs/sweep.md) over many scenes and
  [Shadowing](docs/shadowing.md).

```{include} README.md
:start-after: "change came first](docs/desync.md)."
:end-before: "On a machine with only Python"
```

## Every scene of the catalogue

Each is compared in doubles and in pymunk with the exact run, over its first events.
A name leads to its page, with the report; a picture, which shows the exact run, opens it to play with.

{gallery}
"""

PLAY = """\
<p><b><a href="play/index.html">Play with it, here</a></b>: draw discs, throw, and watch the exact run and the one in
doubles part. All of it runs in this page.</p>"""
"""On the home page, where the page to play with could be built."""

TREES = {
    "Tutorials": ("README", "docs/tutorial"),
    "How-to": (
        "docs/play",
        "docs/how-to",
        "docs/floating-point-or-bug",
        "docs/desync",
        "docs/your-engine",
        "docs/pytest",
        "docs/python",
        "docs/suites",
        "docs/sweep",
        "docs/advice",
    ),
    "Reference": (
        "catalogue/index",
        "docs/scenes",
        "docs/engines",
        "docs/command-line",
        "docs/json",
        "docs/log-format",
        "docs/policies",
        "docs/survey",
        "docs/tradeoffs",
        "docs/stress",
        "docs/statistics",
        "docs/truths",
        "docs/desync-trials",
        "docs/other-engines",
        "docs/figures",
        "api/index",
    ),
    "Explanation": (
        "docs/comparison",
        "docs/audit",
        "docs/chaos",
        "docs/shadowing",
        "docs/how-it-is-exact",
        "docs/symmetry-and-ties",
        "docs/touching",
        "docs/error-bound",
        "docs/certificates",
        "docs/fuzz",
        "docs/architecture",
        "laws/index",
    ),
    "The project": ("CONTRIBUTING", "CHANGELOG", "SECURITY", "docs/index"),
}
"""The pages in order; those of docs/ that are not named here follow under `How-to`."""


def assemble(source: Path, *, short: bool, jobs: int) -> list[str]:
    """Writes everything that Sphinx reads into a folder; what is not current, line by line."""
    for folder in ("docs", "catalogue", "api", "laws", "static", "extra/reports", "extra/pictures/still"):
        (source / folder).mkdir(parents=True)
    for name in TOP:
        shutil.copy(ROOT / name, source / name)
    for path in sorted((ROOT / "docs").iterdir()):
        if path.is_file():
            shutil.copy(path, source / "docs" / path.name)
    _copy_linked(source)
    shutil.copy(HERE / "conf.py", source / "conf.py")
    shutil.copy(HERE / "site.css", source / "static" / "site.css")
    _write(source / "laws" / "index.md", laws_page(solved=not short))
    for name, text in api_pages():
        _write(source / "api" / f"{name}.md", text)
    names = list(catalogue.names())
    told = _reports([n for n in names if not short or n in SHORT], source / "extra" / "reports", jobs)
    for name in names:
        _write(source / "catalogue" / f"{name}.md", scene_page(name, told.get(name)))
        for folder in ("catalogue", "extra/pictures/still"):
            _write(source / folder / f"{name}.svg", picture(name))
        _write(source / "extra" / "pictures" / f"{name}.svg", moving_picture(name))
    _write(source / "catalogue" / "index.md", catalogue_page(names))
    playable = _playground(source / "extra" / "play")
    shown = INDEX.replace("{gallery}", gallery(names, playable)).replace("{play}", PLAY if playable else "")
    _write(source / "index.md", shown + _trees(source))
    kept = verdicts()
    return [
        f"{VERDICTS.name}: the verdict of {name} is another one by now: run python docs/site/catalogue.py {name}"
        for name, one in told.items()
        if kept[name] != [one.verdict, one.tone]
    ]


def _playground(folder: Path) -> bool:
    """The page to play with; whether there is one. Where its engines cannot be fetched, that is said."""
    try:
        write_playground(folder, ROOT / "build" / "play-parts")
    except NotToBeHad as error:
        print(f"the site has no page to play with: {error}", file=sys.stderr)
        return False
    return True


def _copy_linked(source: Path) -> None:
    """Files of the project that a page of docs/ links to, schemas and notebooks, at the same place in the site."""
    for page in sorted((source / "docs").glob("*.md")):
        text = page.read_text("utf-8")
        linked = re.findall(r"\]\(\.\./([\w./-]+)\)", text)
        linked += [f"docs/{name}" for name in re.findall(r"\]\(([\w./-]+\.ipynb)\)", text)]
        for name in linked:
            if (ROOT / name).is_file() and not (source / name).exists():
                (source / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / name, source / name)


def _reports(names: list[str], folder: Path, jobs: int) -> dict[str, Told]:
    """The report of each scene, by several processes; how far it is goes to stderr."""
    found: dict[str, Told] = {}
    with ProcessPoolExecutor(jobs) as pool:
        tasks = {name: pool.submit(report, name, str(folder)) for name in names}
        for place, (name, task) in enumerate(tasks.items(), 1):
            found[name] = task.result()
            print(f"report {place} of {len(names)}: {name}", file=sys.stderr)
    return found


def _trees(source: Path) -> str:
    listed = {name for names in TREES.values() for name in names}
    others = [
        f"docs/{path.stem}" for path in sorted((source / "docs").glob("*.md")) if f"docs/{path.stem}" not in listed
    ]
    blocks = []
    for caption, names in TREES.items():
        every = [*names, *(others if caption == "How-to" else [])]
        blocks.append("\n".join(["", "```{toctree}", f":caption: {caption}", ":hidden:", "", *every, "```", ""]))
    return "".join(blocks)


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")


def build(out: Path, *, short: bool = False, jobs: int = 2) -> list[str]:
    """Builds the site into `out/html`; what is wrong with it, line by line.

    The pages go to a new folder first, and take the place of those before when all is done.
    """
    source, made, ready = out / "source", out / "new", out / "html"
    for folder in (source, made):
        shutil.rmtree(folder, ignore_errors=True)
    stale = assemble(source, short=short, jobs=jobs)
    if stale:
        return stale
    command = [
        sys.executable,
        "-m",
        "sphinx",
        "-b",
        "html",
        "-j",
        str(jobs),
        "-W",
        "--keep-going",
        "-q",
        str(source),
        str(made),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        return done.stderr.splitlines() or [f"sphinx ended with {done.returncode}"]
    wrong = broken(made) + same_titles(made)
    if not wrong:
        shutil.rmtree(ready, ignore_errors=True)
        made.rename(ready)
    return wrong


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--short", action="store_true", help="only a few reports, and laws without their solutions")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "site", help="where to (build/site)")
    parser.add_argument("--jobs", type=int, default=2, help="processes that make reports (2)")
    options = parser.parse_args()
    wrong = build(options.out.resolve(), short=options.short, jobs=options.jobs)
    for line in wrong:
        print(line, file=sys.stderr)
    if not wrong:
        print(options.out / "html" / "index.html")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
