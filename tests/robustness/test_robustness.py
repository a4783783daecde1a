#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every filter x every input that nobody prepared, through meshlabserver.

Prints a table and writes it as Markdown to the argument that ends in .md, or
to robustness.md in the current folder. Other arguments are parts of the rows
to run; "write" records the outcomes in tests/data/robustness_outcomes.csv:
a row that once was ok must stay so. Outcomes:
  ok        a result that passes the checks, and inputs that are as they were
  flawed    such a result that is worse than its inputs, which the log's last line says
  untrusted such a result that the filter itself does not trust, and says so
  sentence  no result; one sentence says what is wrong and what to do
  host      MeshLab itself refuses or aborts before the filter runs
and those that fail the test: crash, hang (over a minute), silent (no result
and no sentence), changed (an input layer or file is not as it was, a file was
written without a result, or one that nobody asked for), bad (a result whose
flaws are not the log's).
"""
import collections
import concurrent.futures
import copy
import csv
import hashlib
import os
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "mlx"))
import depth_cases  # noqa: E402
import lib  # noqa: E402
import color_cases  # noqa: E402
import extreme_cases  # noqa: E402
import nasty  # noqa: E402
import mend_cases  # noqa: E402
import raster_cases  # noqa: E402
import shapes  # noqa: E402
from lib import box, template  # noqa: E402

TIMEOUT = float(os.environ.get("PARTS_TIMEOUT", 60))  # seconds; more where the machine is shared
MEMORY = 16 << 30  # of address space: a runaway ends here, not in the machine's swap
FINE = {"ok", "flawed", "untrusted", "sentence"}
RECORD = lib.ROOT / "tests" / "data" / "robustness_outcomes.csv"
Case = collections.namedtuple("Case", "filter input layers steps allowed closed result memory", defaults=[MEMORY])

NAN, INF = float("nan"), float("inf")


# --- The inputs that are damaged.

def models():
    """Two capsules that continue each other, the far ends kept."""
    a = shapes.capsule((-1.5, 0, 0), (0.8, 0, 0), 0.5, 24, 36).select_faces(lambda c: c[:, 0] < -1.2)
    b = shapes.capsule((-0.4, 0, 0), (1.6, 0, 0.7), 0.45, 24, 36).select_faces(lambda c: c[:, 0] > 1.4)
    return [a.select_vertices(lambda v: v[:, 0] < -1.2), b.select_vertices(lambda v: v[:, 0] > 1.4)]


def arm():
    m = shapes.neck_with_head((-2, 0, 0), (1.8, 0, 0), 0.35, 0.5, 24, 60)
    return m.select_faces(lambda c: c[:, 0] < -1.3).select_vertices(lambda v: v[:, 0] > 1.5)


def bones():
    t = np.linspace(0, 1, 40)
    path = np.stack([3 * t, 0.8 * np.sin(3 * t), 0.4 * t ** 3], 1)
    m = shapes.tube(path, 0.25 + 0.2 * (t > 0.8) * np.sin((t - 0.8) * 5 * np.pi) + 0.1 * (t < 0.15), 16)
    return [copy.deepcopy(m).turned((1, 2, 0.5), 40).moved((1, -1, 1)), m]


def each(function, layers):
    """A damage done to all layers."""
    return [function(layer) for layer in layers]


def first(function, layers):
    return [function(layers[0])] + layers[1:]


def second(function, layers):
    return [layers[0], function(layers[1])]


def scaled(factor):
    return lambda m: copy.deepcopy(m).scaled(factor)


def moved(offset):
    return lambda m: copy.deepcopy(m).moved(offset)


# --- The table.

def compose(name, layers=None, allowed=FINE, closed=False, **values):
    return Case("compose", name, models() if layers is None else layers, [template("compose", **values)], allowed,
                closed, "composed")


def align(name, layers=None, allowed=FINE, **values):
    return Case("align_part_in_whole", name, bones() if layers is None else layers,
                [template("align_part_in_whole", **values)], allowed, False, "placed")


def deform(name, layers=None, allowed=FINE, closed=False, result="composed", **values):
    values = dict(dict(Pivot=(0, 0, 0), Axis=(0, 1, 0), Angle=-40), **values)
    return Case("deform", name, [arm()] if layers is None else layers, [template("deform", **values)], allowed, closed,
                result)


# What is closed once it has been cleaned.
STILL_CLOSED = {"several_components", "loose_vertices", "duplicate_vertices", "zero_area_faces", "doubled_faces",
                "flipped_faces"}


def damaged():
    for damage in nasty.DAMAGES:
        name, closed = damage.__name__.replace("_", " "), damage.__name__ in STILL_CLOSED
        yield compose(f"A: {name}", first(damage, models()), closed=closed)
        yield compose(f"B: {name}", second(damage, models()), closed=closed)
        yield compose(f"both: {name}", each(damage, models()), closed=closed)
        yield compose(f"both: {name}, Thesis", each(damage, models()), closed=closed, Cut="Thesis", Resolution=60)
        yield align(f"moving: {name}", first(damage, bones()))
        yield align(f"fixed: {name}", second(damage, bones()))
        # It keeps the faces of the model, and so what is wrong with them.
        yield deform(name, [damage(arm())], closed=closed and name not in ("doubled faces", "flipped faces"))


def sizes():
    for name, change in (("size 1e6", scaled(1e6)), ("size 1e-6", scaled(1e-6)), ("size 1e-30", scaled(1e-30)),
                         ("size 1e30", scaled(1e30)), ("size 1, 1e4 away", moved((1e4, 1e4, 1e4))),
                         ("size 1, 1e6 away", moved((1e6, 1e6, 1e6)))):
        sane = name in ("size 1e6", "size 1e-6")
        yield compose(name, each(change, models()), {"ok"} if sane else FINE, closed=sane)
        yield align(name, each(change, bones()), {"ok"} if sane else FINE)
        pivot = (1e4,) * 3 if "1e4" in name else (1e6,) * 3 if "away" in name else (0, 0, 0)
        yield deform(name, each(change, [arm()]), {"ok"} if sane else FINE, closed=sane, Pivot=pivot)
    yield compose("one model a thousand times the other", second(scaled(1e-3), models()))
    yield align("one model a thousand times the other", second(scaled(1e-3), bones()))


def documents():
    for case, two in ((compose, "MeshB"), (align, "FixedMesh")):
        yield case("no layer", [], {"host"})
        yield case("the same layer twice", None, {"sentence"}, **{two: 0})
        yield case("a layer that does not exist", None, {"host"}, **{two: 7})
        yield case("coincident copies", [models()[0], models()[0]] if case is compose else [bones()[1], bones()[1]])
    yield deform("no layer", [], {"host"})
    yield deform("a layer that does not exist", None, {"host"}, Mesh=5)
    missing = compose("a parameter left out of the script", None, {"host"})
    step = missing.steps[0]
    step.remove(next(p for p in step if p.get("name") == "Resolution"))
    yield missing
    wrong = compose("a parameter of another type", None, {"sentence"})
    param = next(p for p in wrong.steps[0] if p.get("name") == "SmoothWeight")
    param.set("type", "RichInt")
    param.set("value", "1")
    yield wrong


def placements():
    yield compose("models that do not touch", second(moved((20, 0, 0)), models()), {"sentence"})
    yield compose("models a voxel apart", second(moved((2.05, 0, 0)), models()))
    yield compose("one inside the other", second(scaled(0.2), models()), FINE)
    yield compose("coincident copies, the same faces kept", [models()[0]] * 2)
    yield compose("coincident copies, other ends kept",
                  [models()[0], models()[0].select_faces(lambda c: c[:, 0] > 0.7)])
    yield align("models far apart", second(moved((1e5, 0, 0)), bones()))
    yield align("coincident copies, no first guess", [bones()[1], bones()[1]], {"ok"}, Coarse="None")
    yield align("a sphere on a sphere", [shapes.sphere(), shapes.sphere((3, 0, 0))], {"ok"})


def constraints():
    yield compose("nothing selected", [shapes.sphere(), shapes.sphere((1, 0, 0))], {"sentence"})
    yield compose("no vertex selected", [shapes.sphere(), shapes.sphere((1, 0, 0))], {"sentence"},
                  KeepA="Selected vertices", KeepB="Selected vertices")
    yield compose("everything selected", each(lambda m: m.select_faces(np.ones(len(m.f), bool)), models()))
    yield compose("a box that touches nothing", None, {"sentence"}, **box("KeepA", (50, 50, 50), (51, 51, 51)))
    yield compose("an inverted box", None, {"sentence"}, **box("KeepA", (1, 1, 1), (-1, -1, -1)))
    yield compose("a box that is not a number", None, {"sentence"}, **box("KeepA", (NAN, 0, 0), (1, 1, 1)))
    yield compose("a point far away", None, FINE, **box("KeepA", (500, 0, 0)))
    yield compose("both constraints in one place", None, {"sentence", "flawed"}, **box("KeepA", (0.1, 0, 0.5)),
                  **box("KeepB", (0.1, 0, 0.5)), Resolution=16)
    yield deform("one part selected for both", None, FINE, Fixed="Selected faces", Moving="Selected faces")
    yield deform("nothing selected", [shapes.sphere()], {"sentence"})
    yield deform("an inverted box", None, {"sentence"}, **box("Fixed", (1, 1, 1), (-1, -1, -1)))


def volumes():
    def inside(low, high): return dict(Volume="Box", VolumeMin=low, VolumeMax=high)
    yield compose("a volume of no thickness", None, {"sentence"}, **inside((-1, -1, 0), (1, 1, 0)))
    yield compose("an inverted volume", None, {"sentence"}, **inside((1, 1, 1), (-1, -1, -1)))
    yield compose("a volume that misses both models", None, {"sentence"}, **inside((50, 50, 50), (60, 60, 60)))
    yield compose("a volume that misses B", None, {"sentence"}, **inside((-3, -1, -1), (-1.3, 1, 1)))
    yield compose("a constraint outside the volume", None, FINE, **inside((-0.9, -1, -1), (1, 1, 1)))
    yield compose("a volume that is not a number", None, {"sentence"}, **inside((NAN, 0, 0), (1, 1, 1)))
    yield compose("an infinite volume", None, {"sentence"}, **inside((-INF, -INF, -INF), (INF, INF, INF)))
    yield compose("a huge volume", None, FINE, **inside((-1e9, -1e9, -1e9), (1e9, 1e9, 1e9)))
    yield compose("a volume as thin as a hair", None, FINE, **inside((-1, -1, 0), (1, 1, 1e-7)))


def numbers():
    for resolution, allowed in ((1, FINE), (2, FINE), (3, FINE), (-1, {"sentence"}), (100000, {"sentence"}),
                                (2000000000, {"sentence"})):
        yield compose(f"resolution {resolution}, Thesis", None, allowed, Resolution=resolution, Cut="Thesis")
        yield deform(f"resolution {resolution}, Thesis", None, allowed, Resolution=resolution, Cut="Thesis")
        unused = {"ok"} if 0 < resolution <= 100000 else {"sentence"}  # the cut on the meshes has no voxels
        yield compose(f"resolution {resolution}", None, unused, unused == {"ok"}, Resolution=resolution)
        yield deform(f"resolution {resolution}", None, unused, unused == {"ok"}, Resolution=resolution)
    for name, values in (("negative iterations", dict(SmoothIterations=-1)), ("weight NaN", dict(SmoothWeight="nan")),
                         ("weight 5", dict(SmoothWeight=5)), ("weight -1", dict(SmoothWeight=-1)),
                         ("distance NaN", dict(SmoothDistance="nan")), ("distance inf", dict(SmoothDistance="inf")),
                         ("distance -1", dict(SmoothDistance=-1)), ("cut number 7", dict(Cut=7))):
        yield compose(name, None, {"sentence"}, **values)
        yield deform(name, None, {"sentence"}, **values)
    yield compose("resolution 1500 in 1.5 GB", None, FINE, Resolution=1500)._replace(memory=3 << 29)
    yield compose("keep number -1", None, {"sentence"}, KeepA=-1)
    yield compose("a thousand iterations over everything", None, {"ok", "flawed"}, True, SmoothIterations=1000,
                  SmoothDistance=1e9)
    for name, values in (("negative iterations", dict(MaxIterations=-1)), ("overlap 0", dict(Overlap=0)),
                         ("overlap 2", dict(Overlap=2)), ("overlap NaN", dict(Overlap="nan")),
                         ("first guess number 9", dict(Coarse=9))):
        yield align(name, None, {"sentence"}, **values)
    yield align("no iteration", None, {"ok"}, MaxIterations=0)
    yield align("overlap 0.01", None, FINE, Overlap=0.01)
    for name, values in (("axis 0", dict(Axis=(0, 0, 0))), ("axis NaN", dict(Axis=(NAN, 0, 0))),
                         ("scale 0", dict(Scale=0)), ("scale -1", dict(Scale=-1)), ("scale NaN", dict(Scale="nan")),
                         ("angle inf", dict(Angle="inf")), ("frames 0", dict(Frames=0)), ("frames -3", dict(Frames=-3)),
                         ("pivot inf", dict(Pivot=(INF, 0, 0)))):
        yield deform(name, None, {"sentence"}, **values)
    yield deform("a pose that moves nothing", None, FINE, Angle=0)
    yield deform("a pose that moves all away", None, {"ok"}, True, "warned", Translation=(100, 0, 0))
    yield deform("angle 1e9", None, FINE, Angle=1e9)
    yield deform("axis 1e-20", None, {"ok"}, closed=True, Axis=(0, 1e-20, 0))
    yield deform("scale 1e6", None, FINE, Scale=1e6)
    yield deform("pivot far away", None, FINE, Pivot=(1e6, 0, 0), Angle=1e-3)


def all_cases():
    for part in (documents, damaged, sizes, placements, constraints, volumes, numbers):
        yield from part()
    yield from raster_cases.all_cases(Case)
    yield from color_cases.all_cases(Case)
    yield from depth_cases.all_cases(Case)
    yield from mend_cases.all_cases(Case)
    yield from extreme_cases.all_cases(Case, {"compose": compose, "deform": deform, "align_part_in_whole": align})


# --- One case.

def same(saved, layer):
    """Bit for bit, where the host has read all of it."""
    v = layer.v.astype(np.float32)
    return saved.v.shape == v.shape and saved.v.tobytes() == v.tobytes() and np.array_equal(saved.f, layer.f)


def closed(mesh):
    try:
        lib.MeshCase().assertManifold(mesh)
        return True
    except AssertionError:
        return False


def untold(mesh, figures):
    """What is wrong with the log's figures of a result: counted here once more, in another way."""
    if len(mesh.f) > 300000:
        return ""  # minutes in Python
    mesh = lib.welded(mesh)
    counted = dict(pieces=lib.edge_pieces(mesh.f), nonmanifold=int((lib.edge_counts(mesh.f)[2] > 2).sum()))
    wrong = [f"{n} {name}, logged {figures.get('result_' + name)}" for name, n in counted.items()
             if figures.get("result_" + name) != str(n)]
    is_open = bool((lib.edge_counts(mesh.f)[2] == 1).any())
    if is_open != (figures.get("result_borders") != "0"):
        wrong.append(f"{'open' if is_open else 'closed'}, logged {figures.get('result_borders')} borders")
    return ", ".join(wrong)


def checked(case, result):
    """The outcome of a run that ended well, and what is to be said about it."""
    for i, layer in enumerate(case.layers):
        moving = case.result == "placed" and i == 0
        if not moving and not same(result.mesh(f"in{i}_after"), layer):
            return "changed", f"layer {i} is not as it was"
    if case.result == "database":
        files = [p.get("value") for p in case.steps[0] if p.get("name") == "Output"]
        return ("ok", f"{result.figures()['examples']} examples") if pathlib.Path(files[0]).exists() else ("bad", "")
    mesh = result.mesh("out")
    if case.result == "placed":
        matrix = np.array(result.figures()["matrix"].split(), float)
        return ("ok", f"rms {result.figures()['rms_after']}") if np.isfinite(matrix).all() else ("bad", "not finite")
    if case.result == "untrusted" and result.figures()["trusted"] != "no":
        return "bad", "trusted"
    used = mesh.v[np.unique(mesh.f)]
    if len(mesh.f) == 0 or not np.isfinite(used).all():
        return "bad", "no faces" if len(mesh.f) == 0 else "coordinates that are not finite"
    wrong = untold(mesh, result.figures())
    if wrong:
        return "bad", wrong
    flawed = [w for w in result.warnings if w.startswith('The result "')]
    if flawed:
        return "flawed", flawed[-1]
    if case.result == "warned" and not result.warnings:
        return "bad", "no warning"
    if case.closed and not (closed(mesh) or closed(lib.welded(mesh))):
        return "bad", "not a closed manifold, and no warning"
    untrusted = [w for w in result.warnings if "not to be trusted" in w]
    return ("untrusted", untrusted[-1]) if untrusted else ("ok", f"{len(mesh.f)} faces")


def digest(file):
    return hashlib.sha256(file.read_bytes()).hexdigest()


def input_files(case):
    """The files that a case reads, and what is in them; a file of a database stands for its folder."""
    names = [p.get("value") for step in case.steps for p in step if p.get("type") == "RichOpenFile"]
    found = set()
    for name in filter(None, names):
        path = pathlib.Path(name)
        folder = path if path.is_dir() else path.parent
        if path.is_file() and path.suffix not in (".ply", ".mlp", ".obj", ".off", ".stl"):
            found.add(path)
        elif path.is_file() and path.suffix == ".mlp":  # its images; beside it other cases write
            found.add(path)
            found.update(f for f in (folder / f"{path.stem}_mappings").rglob("*") if f.is_file())
        elif folder.is_dir() and str(folder).startswith(str(pathlib.Path.cwd())):
            found.update(f for f in folder.rglob("*") if f.is_file() and ".model-cache" not in f.parts)
    return {f: digest(f) for f in found if f.stat().st_size < 1 << 28}


def litter(result):
    """Files in the folder of a run that nobody asked for."""
    known = {"script.mlx", "in.mlp", "out.ply"}
    return sorted(f.name for f in result.folder.iterdir()
                  if f.name not in known and not f.name.startswith("in") and f.suffix != ".png")


def files_of(case):
    """The files that a case is to write and that are there, with what is in them."""
    names = [p.get("value") for step in case.steps for p in step if p.get("type") == "RichSaveFile"]
    return {name: digest(pathlib.Path(name)) for name in names if name and pathlib.Path(name).is_file()}


def outcome(case):
    written, read = files_of(case), input_files(case)
    saved = {} if case.result == "database" else {"out": None, **{f"in{i}_after": i for i in range(len(case.layers))}}
    result = lib.run(case.layers, case.steps, saved, timeout=TIMEOUT, memory=case.memory)
    found = ended(case, result, saved)
    if any(not f.is_file() or digest(f) != was for f, was in read.items()):
        return "changed", "an input file is not as it was"
    if found[0] not in ("ok", "flawed", "untrusted", "crash", "hang") and files_of(case) != written:
        return "changed", "failed, but wrote " + ", ".join(set(files_of(case)) - set(written) or {"over a file"})
    if found[0] != "hang" and litter(result):
        return "changed", "left " + ", ".join(litter(result))
    return found


def ended(case, result, saved):
    """How a run ended, by what it said and saved."""
    if result.code is None:
        return "hang", ""
    started = "more meshes than you have loaded" not in result.text
    if not started or "parameterSet.size() == required.size()" in result.errors:
        return "host", "asks for more meshes" if not started else "aborts: the script must list every parameter"
    if result.code == 0:
        if saved and not (result.folder / "out.ply").exists():
            return "silent", "nothing saved"
        return checked(case, result)
    if result.code != 255:
        return "crash", f"exit code {result.code}: " + (result.errors.strip().splitlines() or [""])[-1][-150:]
    sentence = result.sentence.strip()
    good = sentence.endswith(".") and " " in sentence and "internal error" not in sentence
    return ("sentence" if good else "silent"), sentence


def recorded():
    with open(RECORD, newline="") as file:
        return {(slug, name): was for slug, name, was in csv.reader(file)}


def record(rows):
    """The new outcomes; of rows that were not run the old ones."""
    known = recorded() if RECORD.exists() else {}
    known.update({(row[0], row[1]): row[2] for row in rows})
    with open(RECORD, "w", newline="") as out:
        csv.writer(out, lineterminator="\n").writerows([*key, was] for key, was in sorted(known.items()))


def main():
    only = [a for a in sys.argv[1:] if not a.endswith(".md") and a != "write"]
    before = recorded() if RECORD.exists() else {}
    page = next((a for a in sys.argv[1:] if a.endswith(".md")), "robustness.md")
    cases = [c for c in all_cases() if all(word in f"{c.filter}: {c.input}" for word in only)]
    rows, failed = [], []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for case, (found, note) in zip(cases, pool.map(outcome, cases)):
            was_ok = before.get((case.filter, case.input)) == "ok" and "write" not in sys.argv
            fine = found in case.allowed and (found == "ok" or not was_ok)
            rows.append((case.filter, case.input, found if fine else found.upper(), note))
            line = "{:4} {:20} {:45} {:9} {}".format("" if fine else "FAIL", *rows[-1])
            failed += [] if fine else [line]
            print(line, flush=True)
    if "write" in sys.argv and not failed:
        record(rows)
    counts = collections.Counter(row[2] for row in rows)
    summary = ", ".join(f"{n} {what}" for what, n in counts.most_common())
    with open(page, "w") as out:
        out.write(f"# Inputs that nobody prepared\n\nWritten by `tests/robustness/test_robustness.py`: {len(rows)} runs "
                  f"of `meshlabserver`, {summary}.\n\n- **ok**: a result that passes the checks; the inputs are as "
                  "they were\n- **flawed**: a result with a warning that says what its inputs do not have\n"
                  "- **untrusted**: a result with a warning that it is not to be trusted\n- **sentence**: no result, "
                  "and one sentence that says why and what to do; the document is as it was\n"
                  "- **host**: MeshLab itself stops before the filter runs\n\n"
                  "| filter | input | outcome | |\n|---|---|---|---|\n")
        for row in rows:
            out.write("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |\n")
    print(f"{len(rows)} cases: {summary}; {len(failed)} that must not be. {page} has the table.")
    print("\n".join(failed))  # again, as a long log is seldom read from its beginning
    return 1 if failed or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
