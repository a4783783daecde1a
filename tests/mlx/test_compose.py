# SPDX-License-Identifier: GPL-3.0-or-later
"""Compose through meshlabserver: constraints, volume, layers, stitch, attributes."""
import os

import numpy as np
from PIL import Image

import lib
import shapes
from lib import box, current, run, select_faces, select_vertices, template


def trunk():
    """A lying capsule; its left end is to be kept."""
    return shapes.capsule((-1.5, 0, 0), (0.8, 0, 0), 0.5, 32, 48)


def branch():
    """Another one, that goes on from it to the right and up."""
    return shapes.capsule((-0.4, 0, 0), (1.6, 0, 0.7), 0.45, 32, 48)


def left(c): return c[:, 0] < -1.2
def right(c): return c[:, 0] > 1.4


class Compose(lib.MeshCase):
    def check(self, result, a=None, b=None, name="out"):
        """One closed surface with the kept faces of both."""
        self.assertSucceeded(result)
        mesh = result.mesh(name)
        self.assertManifold(mesh)
        self.assertOneComponent(mesh)
        for model in (a, b):
            if model is not None:
                self.assertHasFaces(mesh, model, model.face_selected)
        return mesh

    def setUp(self):
        self.a, self.b = trunk().select_faces(left), branch().select_faces(right)

    def test_selected_faces(self):
        result = run([self.a, self.b], [template("compose")])
        mesh = self.check(result, self.a, self.b)
        self.assertGreater(lib.volume(mesh), max(lib.volume(self.a), lib.volume(self.b)))
        figures = result.figures()
        self.assertEqual(figures["loops_joined"], "1")
        self.assertGreater(float(figures["seam_length"]), 1.5)
        self.assertEqual(int(figures["faces"]), len(mesh.f))
        self.assertLess(float(figures["objective"]), 20)
        self.assertEqual(figures["broken_ties"], "0")

    def test_faces_selected_by_filters_in_the_script(self):
        steps = [current(0), select_faces("(x0 < -1.2)"), current(1), select_faces("(x0 > 1.5)"), template("compose")]
        self.check(run([trunk(), branch()], steps), self.a)

    def test_selected_vertices(self):
        steps = [current(0), select_vertices("(x < -1.2)"), current(1), select_vertices("(x > 1.5)"),
                 template("compose", KeepA="Selected vertices", KeepB="Selected vertices")]
        self.check(run([trunk(), branch()], steps), self.a)

    def test_boxes(self):
        step = template("compose", **box("KeepA", (-3, -1, -1), (-1.2, 1, 1)), **box("KeepB", (1.4, -1, -1), (3, 1, 2)))
        self.check(run([trunk(), branch()], [step]), self.a, self.b)

    def test_points(self):
        step = template("compose", **box("KeepA", (-2, 0, 0)), **box("KeepB", (2, 0, 1)))
        self.check(run([trunk(), branch()], [step]))

    def test_thesis_cut(self):
        self.check(run([self.a, self.b], [template("compose", Cut="Thesis", Resolution=64)]), self.a, self.b)

    def test_resolution_is_for_the_thesis_cut(self):
        plain, other = (run([self.a, self.b], [template("compose", Resolution=r)]) for r in (0, 24))
        self.assertSucceeded(other)
        self.assertEqual((plain.folder / "out.ply").read_bytes(), (other.folder / "out.ply").read_bytes())
        figures = run([self.a, self.b], [template("compose", Cut="Thesis", Resolution=48)]).figures()
        self.assertEqual(max(map(int, figures["grid"].split())), 50)

    def test_volume_box(self):
        keep = dict(**box("KeepA", (-0.8, -1, -1), (-0.6, 1, 1)), **box("KeepB", (1, -1, -1), (1.1, 1, 1)))
        step = template("compose", Volume="Box", VolumeMin=(-0.9, -1, -1), VolumeMax=(1.2, 1, 1.2), **keep)
        mesh = self.check(run([trunk(), branch()], [step]))
        self.assertHasFaces(mesh, trunk(), left(trunk().centroids()))
        self.assertHasFaces(mesh, branch(), right(branch().centroids()))

    def test_stitch_off_gives_both_clipped_models(self):
        result = run([self.a, self.b], [template("compose", Stitch=False, AddClippedLayers=True)],
                     {"out": None, "a": 3, "b": 4})
        self.assertSucceeded(result)
        both, a, b = result.mesh("out"), result.mesh("a"), result.mesh("b")
        self.assertEqual(len(both.f), len(a.f) + len(b.f))
        self.assertEqual(lib.components(both.f), 2)
        for part, model in ((a, self.a), (b, self.b)):
            self.assertManifold(part, None)
            self.assertHasFaces(part, model, model.face_selected)
            self.assertHasFaces(both, part)
            self.assertLess(len(lib.face_keys(part.v, part.f) & lib.face_keys(model.v, model.f)), len(model.f))

    def test_extra_layers(self):
        result = run([self.a, self.b], [template("compose", AddClippedLayers=True, AddTransitionSurface=True)],
                     {"out": 2, "a": 3, "b": 4, "surface": 5, "current": None})
        self.check(result, self.a, self.b)
        self.assertEqual(lib.face_keys(*vf(result.mesh("out"))), lib.face_keys(*vf(result.mesh("current"))))
        self.assertGreater(len(result.mesh("surface").f), 0)

    def test_inputs_stay(self):
        result = run([self.a, self.b], [template("compose")], {"a": 0, "b": 1})
        self.assertSucceeded(result)
        for name, model in (("a", self.a), ("b", self.b)):
            mesh = result.mesh(name)
            self.assertTrue((mesh.v == model.v.astype(np.float32)).all())
            self.assertTrue((mesh.f == model.f).all())
            self.assertTrue((mesh.face_selected == model.face_selected).all())

    def test_constraints_reversed(self):
        """Fig. 11: the other ends kept give the other half of each model."""
        a, b = trunk().select_faces(lambda c: c[:, 0] > 0.85), branch().select_faces(lambda c: c[:, 0] < -0.45)
        forward = self.check(run([self.a, self.b], [template("compose")]), self.a, self.b)
        backward = run([a, b], [template("compose")])
        self.assertSucceeded(backward)
        mesh = backward.mesh()
        self.assertManifold(mesh)
        self.assertHasFaces(mesh, a, a.face_selected)
        self.assertHasFaces(mesh, b, b.face_selected)
        self.assertLess(lib.volume(mesh), lib.volume(forward))

    def test_layer_matrices(self):
        """Models that are placed by their layers' matrices give what moved models give."""
        turn = np.eye(4)
        turn[:3, :3] = shapes.rotation((0, 0, 1), 90)
        turn[:3, 3] = (5, -2, 1)
        away = branch()
        away.v = (away.v - turn[:3, 3]) @ turn[:3, :3]
        away.select_faces(self.b.face_selected)
        mesh = self.check(run([self.a, away], [template("compose")], matrices={1: turn}), self.a)
        plain = self.check(run([self.a, self.b], [template("compose")]), self.a, self.b)
        self.assertAlmostEqual(lib.volume(mesh), lib.volume(plain), 3)

    def test_mirroring_matrix(self):
        mirror = np.diag([-1.0, 1, 1, 1])
        flipped = branch()
        flipped.v = flipped.v * [-1, 1, 1]
        flipped.f = flipped.f[:, ::-1]
        flipped.select_faces(self.b.face_selected)
        mesh = self.check(run([self.a, flipped], [template("compose")], matrices={1: mirror}), self.a, self.b)
        self.assertGreater(lib.volume(mesh), 0)

    def test_no_smoothing(self):
        self.check(run([self.a, self.b], [template("compose", SmoothIterations=0)]), self.a, self.b)

    def test_smoothing_far(self):
        self.check(run([self.a, self.b], [template("compose", SmoothIterations=20, SmoothDistance=0.4, SmoothWeight=1)]))

    def test_same_result_for_any_number_of_threads(self):
        found = set()
        for cores in (1, os.cpu_count()):
            result = run([self.a, self.b], [template("compose")], cores=cores)
            self.assertSucceeded(result)
            found.add((result.folder / "out.ply").read_bytes())
        self.assertEqual(len(found), 1)

    def test_a_cut_of_older_scripts_means_the_default(self):
        new, old = (run([self.a, self.b], [template("compose", Cut=cut)]) for cut in (0, 2))
        self.assertSucceeded(old)
        self.assertEqual((new.folder / "out.ply").read_bytes(), (old.folder / "out.ply").read_bytes())

    def test_what_must_go(self):
        step = template("compose", **box("DropB", (-9, -9, -9), (-8, -8, -8)))
        self.assertFailed(run([self.a, self.b], [step]), "box to drop of model B")


class Attributes(lib.MeshCase):
    def test_colours_and_quality(self):
        a, b = trunk().painted(200, 30, 30).select_faces(left), branch().painted(30, 30, 200).select_faces(right)
        a.quality, b.quality = np.full(len(a.v), 1.0), np.full(len(b.v), 2.0)
        result = run([a, b], [template("compose")])
        self.assertSucceeded(result)
        mesh = result.mesh()
        colours = {tuple(c[:3]) for c in mesh.color[np.unique(mesh.f[left(mesh.centroids())])]}
        self.assertEqual(colours, {(200, 30, 30)})
        colours = {tuple(c[:3]) for c in mesh.color[np.unique(mesh.f[right(mesh.centroids())])]}
        self.assertEqual(colours, {(30, 30, 200)})
        self.assertEqual(set(mesh.quality[np.unique(mesh.f[left(mesh.centroids())])]), {1.0})

    def test_textures_of_both(self):
        """Two models with a texture each, from different folders under one name."""
        models = []
        folder = lib.work_folder()
        for name, shape, where in (("a", trunk(), left), ("b", branch(), right)):
            (folder / name).mkdir()
            shapes.write_png(folder / name / "skin.png", (200, 30, 30) if name == "a" else (30, 30, 200))
            shape.wedge = np.stack([shape.v[shape.f][:, :, 0] / 8 + 0.5, shape.v[shape.f][:, :, 1] / 8 + 0.5], -1)
            shape.textures = ["skin.png"]
            shape.select_faces(where)
            shapes.write_ply(folder / name / "model.ply", shape)
            models.append(shape)
        result = run([folder / "a" / "model.ply", folder / "b" / "model.ply"], [template("compose")])
        self.assertSucceeded(result)
        mesh = result.mesh()
        files = result.texture_files()
        if lib.TEXTURES_IN_MEMORY:
            self.assertEqual(sorted(mesh.textures), ["skin.png", "skin_2.png"])
        else:
            self.assertEqual(sorted(files), [folder / "a" / "skin.png", folder / "b" / "skin.png"])
        images = [np.asarray(Image.open(file).convert("RGB"))[0, 0].tolist() for file in files]
        for which, (model, where) in enumerate(zip(models, (left, right))):
            mine = where(mesh.centroids())
            number = images.index([[200, 30, 30], [30, 30, 200]][which])
            self.assertEqual(set(mesh.texnumber[mine]), {number})
            expected = mesh.v[mesh.f[mine]][:, :, :2] / 8 + 0.5
            self.assertLess(abs(mesh.wedge[mine] - expected).max(), 1e-5)


def vf(mesh):
    return mesh.v, mesh.f


if __name__ == "__main__":
    lib.main()
