# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs .mlx scripts through a program of the stage tree and checks what comes out.

The environment (tests/run_script.sh) gives STAGE, the stage tree, a display
and, as the current one, a folder to work in; and RUNNER, the program, which
otherwise is meshlabserver or, where the host has none, our own meshlab-script.
"""
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "data"))
import shapes  # noqa: E402

STAGE = pathlib.Path(os.environ.get("STAGE", ROOT / "build" / "stage"))
SERVERS = [os.environ["RUNNER"]] if os.environ.get("RUNNER") else ["meshlabserver", "meshlab-script"]
SERVER = next((STAGE / "bin" / name for name in SERVERS if (STAGE / "bin" / name).exists()), STAGE / "bin" / SERVERS[0])
# Hosts after 2020 have textures as images in memory and write them beside a saved mesh, under plain names.
TEXTURES_IN_MEMORY = not (STAGE / "bin" / "meshlabserver").exists()


def template(slug, **values):
    """The filter of scripts/<slug>.mlx with some values changed, by name."""
    step = xml.parse(ROOT / "scripts" / f"{slug}.mlx").getroot().find("filter")
    for name, value in values.items():
        param = next((p for p in step.iter("Param") if p.get("name") == name), None)
        if param is None:
            raise KeyError(f"{slug}.mlx has no parameter {name}")
        if param.get("type") == "RichPoint3f":
            for axis, number in zip("xyz", value):
                param.set(axis, repr(float(number)))
        elif param.get("type") == "RichEnum" and isinstance(value, str):
            choices = [param.get(f"enum_val{i}") for i in range(int(param.get("enum_cardinality")))]
            param.set("value", str(choices.index(value)))
        else:
            param.set("value", str(value).lower() if isinstance(value, bool) else str(value))
    return step


def box(name, low, high=None):
    """Values that give a constraint or the volume as a box; one corner: a point."""
    return {name: "Box", name + "Min": low, name + "Max": low if high is None else high}


def host_filter(name, **params):
    """A filter of the host; a parameter is (type, value)."""
    step = xml.Element("filter", name=name)
    for key, (kind, value) in params.items():
        xml.SubElement(step, "Param", type=kind, name=key, value=str(value))
    return step


def select_faces(condition):
    return host_filter("Conditional Face Selection", condSelect=("RichString", condition))


def select_vertices(condition):
    return host_filter("Conditional Vertex Selection", condSelect=("RichString", condition))


def current(layer):
    return host_filter("Change the current layer", layer=("RichMesh", layer))


class Run:
    """What a run left: exit code, text, figures, meshes."""

    def __init__(self, code, text, errors, folder, filters):
        self.code, self.text, self.errors, self.folder = code, text, errors, folder
        self.logs, seen = [], 0
        for part in text.split("filter: ")[1:filters + 1]:
            lines = [line.split(": ", 1) for line in part.splitlines() if re.match(r"[a-z_0-9]+: ", line)]
            self.logs.append(lines[seen:])
            if SERVER.name == "meshlabserver":  # prints its whole log again after each filter
                seen = len(lines)

    def figures(self, step=-1):
        """The "name: value" lines of one filter."""
        return dict(self.logs[step])

    @property
    def warnings(self):
        """The sentences of the lines "warning: ..."."""
        return [value for log in self.logs for name, value in map(tuple, log) if name == "warning"]

    @property
    def sentence(self):
        """What the filter said when it failed."""
        lines = self.text.split("Problem with filter")[0].splitlines()
        return lines[-1] if lines and "Problem with filter" in self.text else ""

    def mesh(self, name="out"):
        return shapes.read_ply(self.folder / f"{name}.ply")

    def texture_files(self, name="out"):
        """Of a saved mesh, absolute."""
        return [self.folder / texture for texture in self.mesh(name).textures]


def write_project(path, layers):
    """A MeshLab project; layers are (file name, 4x4 matrix)."""
    rows = ["<!DOCTYPE MeshLabDocument>", "<MeshLabProject>", " <MeshGroup>"]
    for name, matrix in layers:
        numbers = "\n".join(" ".join(repr(float(x)) for x in row) + " " for row in np.asarray(matrix))
        rows.append(f'  <MLMesh label="{name}" filename="{name}" visible="1">\n   <MLMatrix44>\n{numbers}\n'
                    "</MLMatrix44>\n  </MLMesh>")
    path.write_text("\n".join(rows + [" </MeshGroup>", " <RasterGroup/>", "</MeshLabProject>"]) + "\n")


def work_folder():
    return pathlib.Path(tempfile.mkdtemp(prefix="run-", dir=os.environ.get("WORK")))


def run(meshes, steps, outputs=None, matrices=None, timeout=120, cores=None, memory=None, project=None,
        save_project=False):
    """Loads meshes (Mesh objects or files), runs the steps, saves layers.

    outputs: {name: layer index, or None for the current one}; the default
    saves the current layer as "out". matrices: of the layers, by index.
    cores, memory (bytes of address space): the program gets no more.
    project: a project to load instead of meshes; save_project: as out.mlp.
    """
    folder = work_folder()
    files = []
    for i, mesh in enumerate(meshes):
        if isinstance(mesh, shapes.Mesh):
            shapes.write_ply(folder / f"in{i}.ply", mesh)
            mesh = folder / f"in{i}.ply"
        files.append(pathlib.Path(mesh))
    command = [str(SERVER)]
    if project:
        command += ["-p", str(project)]
    elif matrices:
        write_project(folder / "in.mlp", [(str(f), matrices.get(i, np.eye(4))) for i, f in enumerate(files)])
        command += ["-p", str(folder / "in.mlp")]
    else:
        for f in files:
            command += ["-i", str(f)]
    script = xml.Element("FilterScript")
    script.extend(steps)
    (folder / "script.mlx").write_text("<!DOCTYPE FilterScript>\n" + xml.tostring(script, encoding="unicode"))
    command += ["-s", str(folder / "script.mlx")]
    if save_project:
        command += ["-w", str(folder / "out.mlp")]
    for name, layer in ({"out": None} if outputs is None else outputs).items():
        command += ["-o", str(folder / f"{name}.ply")] + ([] if layer is None else ["-l", str(layer)])
        command += ["-m", "vc", "vq", "vf", "ff", "wt"]
    if cores:
        command = ["taskset", "-c", f"0-{cores - 1}"] + command
    if memory:
        command = ["prlimit", f"--as={memory}"] + command
    code, text, errors = execute(command, folder, timeout)
    return Run(code, text, errors, folder, len(steps))


def execute(command, folder, timeout):
    """Exit code (None: it had to be stopped), standard output and error."""
    if "DISPLAY" not in os.environ:
        command = [str(ROOT / "tools" / "headless")] + command
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=folder, text=True,
                               errors="replace", start_new_session=True)
    try:
        text, errors = process.communicate(timeout=timeout)
        return process.returncode, text, errors
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        text, errors = process.communicate()
        return None, text, errors


def edge_counts(f):
    edges = np.concatenate([f[:, [0, 1]], f[:, [1, 2]], f[:, [2, 0]]])
    _, back, counts = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    return edges, back.ravel(), counts


def components(f):
    """Of faces joined by vertices."""
    used, index = np.unique(f, return_inverse=True)
    f = index.reshape(-1, 3)
    label = np.arange(len(used))
    while True:
        low = label.copy()
        np.minimum.at(low, f.ravel(), np.repeat(label[f].min(axis=1), 3))
        low = low[low]
        if (low == label).all():
            return len(np.unique(label))
        label = low


def edge_pieces(f):
    """How many of faces joined by edges."""
    _, back, _ = edge_counts(f)
    edge_of = back.reshape(3, -1).T  # of each face its three
    label = np.arange(len(f))
    while True:
        low = np.full(edge_of.max() + 1 if len(f) else 0, len(f))
        np.minimum.at(low, edge_of.ravel(), np.repeat(label, 3))
        new = low[edge_of].min(axis=1) if len(f) else label
        new = new[new]
        if (new == label).all():
            return len(np.unique(label))
        label = new


class MeshCase(unittest.TestCase):
    """Checks that results must pass."""

    def assertSucceeded(self, result):
        self.assertEqual(result.code, 0, result.text[-2000:] + result.errors[-500:])

    def assertFailed(self, result, *words):
        """One sentence that holds these words, and nothing saved."""
        self.assertEqual(result.code, 255, result.text[-2000:])
        self.assertIn("Problem with filter", result.text)
        for word in words:
            self.assertIn(word.lower(), result.sentence.lower())

    def assertManifold(self, mesh, boundary=0):
        """Oriented, at most two faces an edge, one fan a vertex, so many boundary edges (None: any)."""
        edges, back, counts = edge_counts(mesh.f)
        self.assertLessEqual(counts.max(), 2, "non-manifold edges")
        _, directed = np.unique(edges, axis=0, return_counts=True)
        self.assertEqual(directed.max(), 1, "faces of opposite orientation")
        if boundary is not None:
            self.assertEqual(int((counts == 1).sum()), boundary, "boundary edges")
        # In a fan of k faces around a vertex there are k edges, k + 1 on a boundary.
        corners = np.bincount(mesh.f.ravel(), minlength=len(mesh.v))
        rim = np.bincount(edges[counts[back] == 1].ravel(), minlength=len(mesh.v))
        self.assertTrue((rim <= 2).all(), "vertices with several boundaries")
        spokes = np.zeros(len(mesh.v), int)
        unique = np.unique(np.sort(edges, axis=1), axis=0)
        np.add.at(spokes, unique.ravel(), 1)
        self.assertTrue((spokes[corners > 0] == (corners + (rim == 2))[corners > 0]).all(), "vertices with several fans")

    def assertHasFaces(self, result, mesh, mask=None):
        """Every face of the mesh (where the mask is true) is in the result, bit for bit."""
        have = face_keys(result.v, result.f)
        f = mesh.f if mask is None else mesh.f[mask]
        missing = face_keys(mesh.v.astype(np.float32), f) - have
        self.assertFalse(missing, f"{len(missing)} of {len(f)} faces are missing")

    def assertOneComponent(self, mesh):
        self.assertEqual(components(mesh.f), 1)


def face_keys(v, f):
    """Faces by the bits of their corners, the smallest corner first."""
    keys = set()
    for corners in np.ascontiguousarray(v, np.float32)[f]:
        c = [corner.tobytes() for corner in corners]
        k = c.index(min(c))
        keys.add((c[k], c[(k + 1) % 3], c[(k + 2) % 3]))
    return keys


def welded(mesh):
    """Vertices in the same place made one, faces without area dropped."""
    v, index = np.unique(mesh.v, axis=0, return_inverse=True)
    f = index.ravel()[mesh.f]
    return shapes.Mesh(v, f[(f[:, 0] != f[:, 1]) & (f[:, 1] != f[:, 2]) & (f[:, 2] != f[:, 0])])


def volume(mesh):
    a, b, c = (mesh.v[mesh.f[:, k]].astype(float) for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6)


def main():
    unittest.main(verbosity=2)
