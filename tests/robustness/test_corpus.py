#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""One in ten of the corpus, chosen by hash: no grade is worse than the recorded one.

"test_corpus.py write" records the grades in tests/data/corpus_grades.csv anew.
"""
import csv
import os
import pathlib
import subprocess
import sys

import corpus
import lib

RECORD = lib.ROOT / "tests" / "data" / "corpus_grades.csv"
RANK = {grade: rank for rank, grades in enumerate((("clean",), ("flaw", "sentence", "host"), ("untold", "unclear"),
                                                   ("changed", "signal", "time-out"))) for grade in grades}


def main():
    unpacked = subprocess.run([lib.ROOT / "tools" / "cgal-mesh", "--all"], capture_output=True, text=True)
    if unpacked.returncode:
        print(unpacked.stderr + "Skipped: the meshes of libcgal-demo are not at hand.")
        return 77
    files = corpus.meshes(pathlib.Path(unpacked.stdout.strip()), one_in=10)
    rows = corpus.over(files, float(os.environ.get("PARTS_TIMEOUT", 120)), lambda r: print(*r[:4], flush=True))
    if sys.argv[1:] == ["write"]:
        with open(RECORD, "w", newline="") as out:
            csv.writer(out, lineterminator="\n").writerows([r.mesh, r.filter, r.grade] for r in rows)
        return 0
    with open(RECORD, newline="") as file:
        recorded = {(mesh, slug): grade for mesh, slug, grade in csv.reader(file)}
    before = {r: recorded.get((r.mesh, r.filter)) for r in rows}
    worse = [r for r in rows if RANK[r.grade] > (RANK[before[r]] if before[r] else 1)]
    better = [r for r in rows if before[r] and RANK[r.grade] < RANK[before[r]]]
    new = [r for r in rows if not before[r]]
    missing = set(recorded) - {(r.mesh, r.filter) for r in rows}
    for what, found in (("worse", worse), ("better, so record it", better), ("new, so record it", new)):
        for r in found:
            print(f"{what}: {r.mesh} {r.filter}: {before[r]} -> {r.grade} {r.note}")
    for mesh, slug in sorted(missing):
        print(f"no longer run: {mesh} {slug}")
    print(f"{len(rows)} runs, {len(worse)} worse, {len(better)} better, {len(new)} new, {len(missing)} missing")
    return 1 if worse or missing or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
