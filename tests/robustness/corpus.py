#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every filter over a folder of meshes: corpus.py FOLDER [--one-in N] [--csv FILE] [--page FILE]

Outcomes are graded as CGAL's benchmark of Alpha_wrap_3 does it, an unreadable
input being an outcome of its own and never a success:
  clean     a result without a flaw that its inputs do not have
  flaw      a result with one, and the log's last line says which
  sentence  no result; one sentence says why and what to do
  host      MeshLab cannot read the mesh
and those that must not be:
  untold    a result whose flaws are not the log's
  unclear   no result and no sentence
  signal    the program was stopped by one
  time-out  it did not end within the time
  changed   an input is not as it was
"""
import argparse
import collections
import concurrent.futures
import csv
import hashlib
import os
import pathlib
import sys
import time

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "mlx"))
import lib  # noqa: E402
import mend_cases  # noqa: E402
import shapes  # noqa: E402
from lib import template  # noqa: E402
from test_robustness import litter, untold  # noqa: E402

FINE = ("clean", "flaw", "sentence", "host")
GRADES = FINE + ("untold", "unclear", "signal", "time-out", "changed")
Graded = collections.namedtuple("Graded", "mesh filter grade note seconds")


class Databases:
    """Small classes for the filters that want one."""

    def __init__(self):
        self.folder = lib.work_folder()
        for name in ("beans", "painted"):
            (self.folder / name).mkdir()
        for seed in range(2):
            shapes.write_ply(self.folder / "beans" / f"bean{seed}.ply", mend_cases.bean(seed))
            shapes.write_ply(self.folder / "painted" / f"bean{seed}.ply", mend_cases.bean(seed).painted(220, 180, 150))
        self.beans, self.painted = self.folder / "beans", self.folder / "painted"


class Placed:
    """A mesh of the corpus as MeshLab reads it, and boxes about it."""

    def __init__(self, file):
        self.file = file
        self.mesh = shapes.read_ply(file)
        used = self.mesh.v[np.unique(self.mesh.f)].astype(float) if len(self.mesh.f) else np.zeros((1, 3))
        used = used[np.isfinite(used).all(axis=1)] if np.isfinite(used).any() else np.zeros((1, 3))
        self.low, self.high = used.min(axis=0), used.max(axis=0)
        self.axis = int(np.argmax(self.high - self.low))

    def slab(self, name, begin, end):
        """Corners of the box between two shares of the longest axis."""
        size = self.high - self.low
        low, high = self.low - 0.01 * size - 1e-9, self.high + 0.01 * size + 1e-9
        low[self.axis] = self.low[self.axis] + begin * size[self.axis] - (0.01 * size[self.axis] if begin == 0 else 0)
        high[self.axis] = self.low[self.axis] + end * size[self.axis] + (0.01 * size[self.axis] if end >= 1 else 0)
        return {name + "Min": tuple(low), name + "Max": tuple(high)}

    def copy(self, share, degrees=0):
        """The mesh moved by a share of its length, after a turn about its middle."""
        offset = np.zeros(3)
        offset[self.axis] = share * (self.high - self.low)[self.axis]
        middle = (self.low + self.high) / 2
        moved = shapes.Mesh(self.mesh.v.astype(float) - middle, self.mesh.f)
        if degrees:
            moved = moved.turned((1, 2, 3), degrees)
        return moved.moved(middle + offset)


def runs(placed, databases, folder):
    """Of each filter: its name, layers, script, whether a layer is saved."""
    bent = np.roll((0.0, 1.0, 0.0), placed.axis)
    models, images = folder / "models", folder / "seen_mappings"
    models.mkdir()
    (models / "m.ply").write_bytes(placed.file.read_bytes())
    region = dict(Region="Box", **placed.slab("Region", 0.85, 1), Database=databases.beans, Candidates=1)
    further = placed.copy(0.4)
    yield "compose", [placed.file, further], template(
        "compose", KeepA="Box", KeepB="Box", **placed.slab("KeepA", 0, 0.2), **placed.slab("KeepB", 1.2, 1.4)), True
    yield "align_part_in_whole", [placed.copy(0.1, 25), placed.file], template("align_part_in_whole"), False
    yield "deform", [placed.file], template(
        "deform", Fixed="Box", Moving="Box", **placed.slab("Fixed", 0, 0.2), **placed.slab("Moving", 0.8, 1),
        Pivot=tuple((placed.low + placed.high) / 2), Axis=tuple(bent), Angle=20), True
    yield "find_similar", [placed.file], template("find_similar", **region), True
    yield "restore", [placed.file], template("restore", Blend=1, **region), True
    yield "fill_hole", [placed.file], template("fill_hole", Database=databases.beans, Candidates=1, Blend=1), True
    yield "colorize_mesh", [placed.file], template(
        "colorize_mesh", Database=databases.painted, Target="Vertex colour", PatchSizes="5", Width=40, Height=50), True
    yield "build_mappings", [], template("build_mappings", Models=models, Output=folder / "seen.mlp", Width=60, Height=80), False
    made = sorted(images.iterdir()) if images.is_dir() else []
    backs = [f for f in made if "back" in f.name]
    depth = next((f for f in made if f.suffix == ".tif" and f not in backs), None)
    color = next((f for f in made if f.suffix == ".png" and "mask" not in f.name), None)
    if not depth or not color:
        return
    yield "depth_to_mesh", [], template("depth_to_mesh", Depth=depth, BackDepth=backs[0] if backs else ""), True
    yield "colorize_depth", [], template("colorize_depth", Depth=depth, Database=databases.painted, PatchSizes="5"), True
    yield "reconstruct_depth", [], template(
        "reconstruct_depth", Image=color, Database=folder / "seen.mlp", PatchSizes="5,5", UpdateViews=False), True


def digests(folder):
    return {f: hashlib.sha256(f.read_bytes()).hexdigest() for f in folder.rglob("*")
            if f.is_file() and ".model-cache" not in f.parts}


def graded(layers, step, saved, inputs, timeout):
    """Grade and note of one run; inputs: folders whose files are to stay as they are."""
    before = {f: d for folder in inputs for f, d in digests(folder).items()}
    result = lib.run(layers, [step], {"out": None} if saved else {}, timeout=timeout, memory=8 << 30)
    if result.code is None:
        return "time-out", ""
    after = {f: d for folder in inputs for f, d in digests(folder).items()}
    changed = [f.name for f, d in before.items() if after.get(f) != d]
    if changed:
        return "changed", ", ".join(changed)
    if result.code not in (0, 255):
        return "signal", f"exit code {result.code}: " + (result.errors.strip().splitlines() or [""])[-1][-100:]
    if result.code == 255:
        sentence = result.sentence.strip()
        clear = sentence.endswith(".") and " " in sentence and "internal error" not in sentence
        return ("sentence" if clear else "unclear"), sentence
    if litter(result):
        return "changed", "left " + ", ".join(litter(result))
    if saved:
        if not (result.folder / "out.ply").exists():
            return "unclear", "nothing saved"
        wrong = untold(result.mesh("out"), result.figures())
        if wrong:
            return "untold", wrong
    told = [w for w in result.warnings if w.startswith("The result ")]
    return ("flaw", told[-1]) if told else ("clean", "")


def read_by_the_host(file, timeout):
    """The mesh as a PLY file, or nothing."""
    result = lib.run([file], [lib.host_filter("Invert Selection", InvFaces=("RichBool", "false"),
                                              InvVerts=("RichBool", "false"))], timeout=timeout)
    out = result.folder / "out.ply"
    if result.code != 0 or not out.exists():
        return None
    return out if len(shapes.read_ply(out).f) else None


def over_mesh(file, databases, timeout, tell):
    """All filters over one mesh."""
    start = time.monotonic()
    placed = read_by_the_host(file, timeout)
    rows = []
    if placed is None:
        rows.append(Graded(file.name, "(reading)", "host", "no faces that MeshLab reads", time.monotonic() - start))
        tell(rows[-1])
        return rows
    placed, folder = Placed(placed), lib.work_folder()
    for slug, layers, step, saved in runs(placed, databases, folder):
        start = time.monotonic()
        inputs = [placed.file.parent, databases.folder] + ([] if slug == "build_mappings" else [folder])
        grade, note = graded(layers, step, saved, inputs, timeout)
        rows.append(Graded(file.name, slug, grade, note, time.monotonic() - start))
        tell(rows[-1])
    return rows


def meshes(folder, one_in=1):
    """The folder's meshes; of so many one: those whose names' hashes it divides."""
    files = sorted(f for f in pathlib.Path(folder).iterdir() if f.suffix.lower() in (".off", ".ply", ".obj", ".stl"))
    return [f for f in files if int(hashlib.sha256(f.name.encode()).hexdigest(), 16) % one_in == 0]


def over(files, timeout, tell=lambda row: None):
    databases, rows = Databases(), []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for found in pool.map(lambda f: over_mesh(f, databases, timeout, tell), files):
            rows += found
    return rows


def page_of(rows, name):
    """The table as Markdown: filters and their grades, then what needs eyes."""
    seen = [g for g in GRADES if any(r.grade == g for r in rows)]
    count = collections.Counter((r.filter, r.grade) for r in rows)
    filters = list(dict.fromkeys(r.filter for r in rows))
    lines = [f"# Every filter over {name}", "",
             f"Written by `./run corpus`: {len({r.mesh for r in rows})} meshes, {len(rows)} runs of `meshlabserver`.", "",
             "| filter | " + " | ".join(seen) + " |", "|---" * (len(seen) + 1) + "|"]
    lines += ["| " + " | ".join([f] + [str(count[f, g] or "") for g in seen]) + " |" for f in filters]
    lines += ["| all | " + " | ".join(str(sum(count[f, g] for f in filters)) for g in seen) + " |", ""]
    legend = [line.strip().split(None, 1) for line in __doc__.splitlines() if line.startswith("  ")]
    lines += [f"- **{grade}**: {text.strip()}" for grade, text in legend]
    eyes = [r for r in rows if r.grade not in ("clean", "sentence")]
    lines += ["", "| mesh | filter | grade | |", "|---|---|---|---|"]
    lines += [f"| {r.mesh} | {r.filter} | {r.grade} | " + r.note.replace("|", "\\|") + " |" for r in eyes]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--one-in", type=int, default=1, help="of so many meshes one, chosen by their names' hashes")
    parser.add_argument("--timeout", type=float, default=120, help="seconds a run")
    parser.add_argument("--name", help="of the folder, for the page")
    parser.add_argument("--csv", default="corpus.csv")
    parser.add_argument("--page", default="corpus.md")
    asked = parser.parse_args()
    if not pathlib.Path(asked.folder).is_dir():
        print(f"There is no folder {asked.folder}; give one that holds meshes.", file=sys.stderr)
        return 1
    files = meshes(asked.folder, asked.one_in)
    rows = over(files, asked.timeout, lambda r: print(f"{r.mesh:32} {r.filter:20} {r.grade:9} {r.note}", flush=True))
    with open(asked.csv, "w", newline="") as out:
        table = csv.writer(out, lineterminator="\n")
        table.writerow(Graded._fields)
        table.writerows(r._replace(seconds=f"{r.seconds:.1f}") for r in rows)
    pathlib.Path(asked.page).write_text(page_of(rows, f"the meshes of {asked.name or pathlib.Path(asked.folder).resolve().name}"))
    bad = [r for r in rows if r.grade not in FINE]
    print(f"{len(rows)} runs over {len(files)} meshes, {len(bad)} that must not be. {asked.page} and {asked.csv} have them.")
    return 1 if bad or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
