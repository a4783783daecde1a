# SPDX-License-Identifier: GPL-3.0-or-later
"""Align through meshlabserver: whole models, selected parts, matrix or vertices."""
import numpy as np

import lib
import shapes
from lib import current, run, template


def bone(size=1.0):
    """A shape that no rotation or reflection takes to itself."""
    t = np.linspace(0, 1, 60)
    path = np.stack([3 * t, 0.8 * np.sin(3 * t), 0.4 * t ** 3], 1)
    m = shapes.tube(path, 0.25 + 0.2 * (t > 0.8) * np.sin((t - 0.8) * 5 * np.pi) + 0.1 * (t < 0.15), 24)
    return m.scaled(size)


AXIS, ANGLE, OFFSET = (1, 2, 0.5), 70, (3, -4, 1)


def placed(m):
    return m.turned(AXIS, ANGLE).moved(OFFSET)


class Align(lib.MeshCase):
    def error(self, mesh):
        """Of a model that should lie on bone(), the largest distance of a vertex from its place."""
        return np.linalg.norm(mesh.v - bone().v, axis=1).max()

    def test_vertex_coordinates(self):
        step = template("align_part_in_whole", ApplyTo="Vertex coordinates", Overlap=1)
        result = run([placed(bone()), bone()], [current(0), step], {"moved": 0, "fixed": 1})
        self.assertSucceeded(result)
        self.assertLess(self.error(result.mesh("moved")), 0.02)
        self.assertTrue((result.mesh("fixed").v == bone().v.astype(np.float32)).all())
        figures = result.figures()
        self.assertLess(float(figures["rms_after"]), 0.01)
        self.assertGreater(float(figures["rms_before"]), float(figures["rms_after"]))
        self.assertGreater(float(figures["inlier_share"]), 0.9)
        matrix = np.array(figures["matrix"].split(), float).reshape(4, 4)
        self.assertLess(np.abs(matrix[:3, :3] - shapes.rotation(AXIS, ANGLE).T).max(), 0.01)

    def test_layer_matrix(self):
        """The coordinates stay; a filter that honours the matrix sees the move."""
        steps = [template("align_part_in_whole", Overlap=1), current(0),
                 lib.host_filter("Matrix: Freeze Current Matrix", allLayers=("RichBool", "false"))]
        before = run([placed(bone()), bone()], steps[:1], {"moved": 0})
        self.assertSucceeded(before)
        self.assertTrue((before.mesh("moved").v == placed(bone()).v.astype(np.float32)).all())
        after = run([placed(bone()), bone()], steps, {"moved": 0})
        self.assertSucceeded(after)
        self.assertLess(self.error(after.mesh("moved")), 0.02)

    def test_scale(self):
        step = template("align_part_in_whole", ApplyTo="Vertex coordinates", AllowScale=True, Overlap=1)
        result = run([placed(bone(2.5)), bone()], [step], {"moved": 0})
        self.assertSucceeded(result)
        self.assertLess(self.error(result.mesh("moved")), 0.03)

    def test_mirror(self):
        mirrored = bone()
        mirrored.v, mirrored.f = mirrored.v * [1, 1, -1], mirrored.f[:, ::-1]
        step = template("align_part_in_whole", ApplyTo="Vertex coordinates", AllowMirror=True, Overlap=1)
        result = run([placed(mirrored), bone()], [step], {"moved": 0})
        self.assertSucceeded(result)
        mesh = result.mesh("moved")
        self.assertLess(self.error(mesh), 0.02)
        self.assertGreater(lib.volume(mesh), 0)

    def test_selected_parts(self):
        """Only the ends match; the rest of each model is different."""
        end = [c[:, 0] > 2 for c in (bone().centroids(), bone().centroids())]
        moving, fixed = bone(), bone()
        moving.v[:, 2] += np.where(moving.v[:, 0] < 1.5, (1.5 - moving.v[:, 0]) ** 2, 0)
        moving.select_faces(end[0])
        fixed.select_faces(end[1])
        step = template("align_part_in_whole", ApplyTo="Vertex coordinates", Overlap=1)
        result = run([placed(moving), fixed], [step], {"moved": 0})
        self.assertSucceeded(result)
        mine = bone().v[:, 0] > 2.1
        distance = np.linalg.norm(result.mesh("moved").v - bone().v, axis=1)[mine].max()
        self.assertLess(distance, 0.05)

    def test_from_where_the_models_are(self):
        step = template("align_part_in_whole", ApplyTo="Vertex coordinates", Coarse="None", Overlap=1)
        near = bone().turned((0, 0, 1), 5).moved((0.05, 0.05, 0))
        result = run([near, bone()], [step], {"moved": 0})
        self.assertSucceeded(result)
        self.assertLess(self.error(result.mesh("moved")), 0.02)

    def test_a_matrix_of_the_moving_layer_is_kept_in(self):
        turn = np.eye(4)
        turn[:3, :3], turn[:3, 3] = shapes.rotation(AXIS, ANGLE), OFFSET
        step = template("align_part_in_whole", ApplyTo="Vertex coordinates", Overlap=1)
        result = run([bone(), bone()], [step], {"moved": 0}, matrices={0: turn})
        self.assertSucceeded(result)
        self.assertLess(self.error(result.mesh("moved")), 0.02)


if __name__ == "__main__":
    lib.main()
