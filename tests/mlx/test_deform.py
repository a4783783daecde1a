# SPDX-License-Identifier: GPL-3.0-or-later
"""Deform through meshlabserver: an arm bent, frames, scale, mirror."""
import numpy as np

import lib
import shapes
from lib import box, current, run, select_faces, select_vertices, template


def arm():
    """Along x, with the elbow at the origin and a fist at the right end."""
    m = shapes.neck_with_head((-2, 0, 0), (1.8, 0, 0), 0.35, 0.5, 32, 80)
    return m.select_faces(lambda c: c[:, 0] < -1.3).select_vertices(lambda v: v[:, 0] > 1.5)


BEND = dict(Pivot=(0, 0, 0), Axis=(0, 1, 0), Angle=-50)


class Deform(lib.MeshCase):
    def check(self, mesh, model):
        self.assertManifold(mesh)
        self.assertOneComponent(mesh)
        self.assertHasFaces(mesh, model, model.face_selected)

    def test_selections(self):
        """Default: selected faces stay, selected vertices move."""
        model = arm()
        result = run([model], [template("deform", **BEND)])
        self.assertSucceeded(result)
        mesh = result.mesh()
        self.check(mesh, model)
        fist = arm().turned(BEND["Axis"], BEND["Angle"])
        distance = np.linalg.norm(mesh.v[None] - fist.v[fist.vertex_selected][::9, None], axis=2).min(axis=1)
        self.assertLess(distance.max(), 1e-5)
        self.assertAlmostEqual(lib.volume(mesh) / lib.volume(model), 1, delta=0.1)
        self.assertEqual(int(result.figures()["faces"]), len(mesh.f))

    def test_boxes_and_points(self):
        step = template("deform", **BEND, **box("Fixed", (-3, -1, -1), (-1.3, 1, 1)), **box("Moving", (2.5, 0, 0)))
        result = run([arm()], [step])
        self.assertSucceeded(result)
        self.check(result.mesh(), arm())

    def test_selected_by_filters_in_the_script(self):
        model = arm()
        model.face_selected = model.vertex_selected = None
        steps = [current(0), select_faces("(x0 < -1.3)"), select_vertices("(x > 1.5)"), template("deform", **BEND)]
        result = run([model], steps)
        self.assertSucceeded(result)
        self.assertManifold(result.mesh())

    def test_frames(self):
        model = arm()
        names = {f"frame{i}": i for i in (1, 2, 3, 4)}
        result = run([model], [template("deform", **BEND, Frames=4)], {**names, "current": None})
        self.assertSucceeded(result)
        rest = result.mesh("frame1")
        self.assertEqual(lib.face_keys(rest.v, rest.f), lib.face_keys(model.v, model.f))
        heights = []
        for name in list(names)[1:]:
            self.check(result.mesh(name), model)
            heights.append(result.mesh(name).v[:, 2].max())
        self.assertTrue((np.diff(heights) > 0.1).all(), heights)
        last, shown = result.mesh("frame4"), result.mesh("current")
        self.assertTrue((last.v == shown.v).all())

    def test_the_input_stays(self):
        model = arm()
        result = run([model], [template("deform", **BEND)], {"in": 0})
        mesh = result.mesh("in")
        self.assertTrue((mesh.v == model.v.astype(np.float32)).all() and (mesh.f == model.f).all())

    def test_scale_and_shift(self):
        result = run([arm()], [template("deform", Angle=0, Scale=1.2, Translation=(0.2, 0, 0), Pivot=(0, 0, 0))])
        self.assertSucceeded(result)
        self.check(result.mesh(), arm())
        self.assertAlmostEqual(result.mesh().v[:, 0].max(), 1.2 * arm().v[:, 0].max() + 0.2, 4)

    def test_mirror(self):
        """Through the plane y = 0, which the arm is symmetric to: the arm again."""
        result = run([arm()], [template("deform", Mirror=True, Angle=0, Axis=(0, 1, 0), Pivot=(0, 0, 0))])
        self.assertSucceeded(result)
        self.check(result.mesh(), arm())
        self.assertAlmostEqual(lib.volume(result.mesh()) / lib.volume(arm()), 1, delta=0.02)

    def test_a_layer_matrix_is_honoured(self):
        matrix = np.diag([2.0, 2, 2, 1])
        result = run([arm()], [template("deform", **BEND)], matrices={0: matrix})
        self.assertSucceeded(result)
        self.check(result.mesh(), arm().scaled(2))

    def test_parts_torn_apart_are_said(self):
        self.assertFalse(run([arm()], [template("deform", **BEND)]).warnings)
        torn = run([arm()], [template("deform", Translation=(100, 0, 0))])
        self.assertSucceeded(torn)
        self.assertIn("drawn out", torn.warnings[-1])


if __name__ == "__main__":
    lib.main()
