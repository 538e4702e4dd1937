"""Builds the reference set: 100 exact histories of hard discs, with certificates, for testing any engine.

python tests/compare/certificate/reference_set.py   # writes docs/reference-set-1.zip, always the same bytes
"""

from __future__ import annotations

import hashlib
import io
import json
import sys
import zipfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[3]
ARCHIVE = ROOT / "docs" / "reference-set-1.zip"
DIGITS = 30
SAME_DATE = (1980, 1, 1, 0, 0, 0)

CATALOGUE = (
    *((f"article:figure={figure}", 10) for figure in ("apart", "head-on", "diagonal", "giant", "floor", "slope")),
    ("cradle", 30), ("cradle:gap=0", 30), ("cradle:n=3,r=3/10", 30), ("tennis", 60), ("tennis:big=3", 60),
    ("sizes", 40), ("sizes:n=4,ratio=10", 40), ("galperin:n=0", 5), ("galperin:n=1", 31), ("galperin:n=2", 314),
    ("lee", 5), ("lee:tie=sequential", 5), ("near-tie", 5), ("near-tie:k=40", 5), ("near-tie:k=100,first=right", 5),
    *((f"inscribed:n={n}", 12) for n in (3, 4, 5, 6, 8)), ("inscribed:n=4,spin=0", 24),
    ("inscribed:n=3,corners=yes", 9), *((f"rack:rows={rows},gap=0", 16) for rows in (2, 3, 4, 5)),
    ("rack:rows=3,gap=1/50", 20), ("rack:rows=4,gap=1/50", 20),
    ("rack:rows=3,tie=sequential", 12), ("rack:rows=3,tie=sequential:seed=7", 12), ("rack:rows=3,offset=1/10", 20),
    *((f"rack:rows=3,gap=1/50,jitter=1/1000,seed={seed}", 20) for seed in range(6)),
    *((f"gas:n={n},seed={seed}", events) for n, seed, events in (
        (2, 1, 100), (3, 1, 100), (4, 1, 100), (5, 1, 100), (6, 1, 80), (8, 1, 80), (10, 1, 200), (10, 2, 60),
        (10, 3, 60), (15, 1, 60), (12, 1, 60), (20, 1, 60), (30, 1, 60), (40, 1, 60),
    )),
    *((f"gas:n=6,mixed=yes,seed={seed}", 60) for seed in range(1, 7)),
    ("reversal", None), ("pinball", 30), ("lorentz", 60), ("point", 60), ("grazing", 20), ("corner", 20),
    ("corner:angle=60", 12), ("corner:angle=45", 12), ("corner:angle=36", 12),
)  # fmt: skip
"""Scenes of the catalogue, each with the number of events told of it; None: as many as it has."""

COINCIDENCES = (
    "instant", "graze_blow", "raft", "slide", "corner", "near_ties", "points", "obstacles", "rim_instant", "entry_ties",
    "on_rim", "pocket_rafts", "holes", "pressed", "mirrored", "neighbours", "ring", "onto_pair", "twins", "ends",
    "returns", "hairs", "couples", "apart", "pits", "home", "grid", "gas",
)  # fmt: skip
"""Kinds of the fuzz: scenes made of coincidences, one of each."""

README = """# Hard-disc reference histories, version 1

{count} scenes of hard discs, straight walls, fixed discs and pockets, each with its exact history. The initial data
are exact numbers; every event, its partners and its order are proved; times and the final state are given to {digits}
decimals, each off by less than one unit of the last. `index.json` lists them: name, file, SHA-256 of the file, digest
of the scene (SHA-256 of `scene` in canonical JSON, RFC 8785), circles, walls, pockets, events, what ends it.

To test an engine, in any language, read a file (JSON):

1. `scene.circles`: `x`, `y`, `r`, `vx`, `vy`, `w` (one over the mass; 0: fixed); `scene.walls`: two points of an
   infinite line. A number is a sum of terms like `3/4*r1`; r1 is the square root of the first entry of
   `scene.roots`, and so on. Round it as you do.
2. Run to `final.time`. The collisions are perfectly elastic and without friction; at an instant
   with `turn` every velocity is negated once.
3. Hold your events against `instants`, in order: `met` are the pairs at gap zero at `time` (two circles by
   index; with n circles, n + k is wall k; a negative one a pocket); `rounds` are the impulses, pair by pair.
4. Hold your state against `final.circles`: x, y, vx, vy.

Where several pairs meet at one instant, the outcome follows `scene.tie_policy`. Many of the histories are chaotic:
after some 150 collisions no engine in doubles can be expected to follow; the first event at which yours parts tells.

Each file is a certificate: `tools/verify.py` or `tools/verify.mjs` of truebreak, or a checker of your own
(docs/certificates.md), proves it again. Please cite the set by name and version, and a history by its SHA-256.
"""


def entries() -> list[tuple[str, Any]]:
    """Names, and what makes the run of each."""
    found: list[tuple[str, Any]] = [(spec, ("catalogue", spec, events)) for spec, events in CATALOGUE]
    return found + [(kind, ("coincidence", kind, 3)) for kind in COINCIDENCES]


def certificate(maker: tuple[str, str, int | None]) -> str:
    """The certificate of one entry, as text."""
    from certificate.samples import built, coincidence
    from truebreak.compare.certificate import certificate_json, certificate_of

    kind, name, number = maker
    run = built(name, number) if kind == "catalogue" else coincidence(name, number or 0)
    return certificate_json(certificate_of(run, digits=DIGITS))


def digest(scene: dict[str, Any]) -> str:
    """The digest of a scene block: SHA-256 of its canonical form, as the checkers print it."""
    text = json.dumps(scene, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def archive() -> bytes:
    """The set, as the bytes of a zip file."""
    rows, files = [], {}
    for number, (name, maker) in enumerate(entries(), start=1):
        text = certificate(maker)
        told, file = json.loads(text), f"{number:03d}.json"
        scene, files[file] = told["scene"], text
        events = sum("rounds" in instant for instant in told["instants"])
        sizes = {kind: len(scene.get(kind, ())) for kind in ("circles", "walls", "pockets")}
        row = {
            "name": name,
            "file": file,
            "sha256": hashlib.sha256(text.encode()).hexdigest(),
            "digest": digest(scene),
        }
        rows.append({**row, **sizes, "events": events, "end": told["end"]["reason"]})
    index = json.dumps({"version": 1, "digits": DIGITS, "histories": rows}, indent=1) + "\n"
    readme = README.format(count=len(rows), digits=DIGITS)
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as packed:
        for file, text in {"README.md": readme, "index.json": index, **files}.items():
            info = zipfile.ZipInfo(f"reference-set-1/{file}", SAME_DATE)
            info.compress_type = zipfile.ZIP_DEFLATED
            packed.writestr(info, text)
    return buffer.getvalue()


if __name__ == "__main__":
    sys.path[:1] = [str(ROOT / "tests"), str(ROOT / "tests" / "compare")]
    ARCHIVE.write_bytes(archive())
    print(f"{ARCHIVE.relative_to(ROOT)}: {len(entries())} histories, {ARCHIVE.stat().st_size} bytes")
