# SPDX-License-Identifier: GPL-3.0-or-later
"""Several filters in one script: each works on what the one before has left."""
import numpy as np

import lib
import shapes
from lib import box, current, run, select_faces, template


class Chain(lib.MeshCase):
    def test_three_headed_animal(self):
        """A body gets three heads, one after another; the last step starts from all before."""
        body = shapes.tube([(x, 0, 0) for x in np.linspace(-2, 2, 50)], 0.75 * np.sqrt(1.02 - np.linspace(-1, 1, 50) ** 2),
                           40)
        roots, tips = [(1.3, 0, 0), (1.2, 0.25, 0.1), (1.2, -0.25, 0.1)], [(3, 0, 0.6), (2, 1.7, 0.6), (2, -1.7, 0.6)]
        heads = [shapes.neck_with_head(root, tip, 0.2, 0.4) for root, tip in zip(roots, tips)]
        tail = dict(box("KeepA", (-2, 0, 0)))
        steps = [template("compose", MeshA=0, MeshB=1, **tail, **box("KeepB", tips[0])),
                 template("compose", MeshA=4, MeshB=2, **tail, **box("KeepB", tips[1])),
                 template("compose", MeshA=5, MeshB=3, **tail, **box("KeepB", tips[2]))]
        result = run([body] + heads, steps, {"one": 4, "two": 5, "three": 6})
        self.assertSucceeded(result)
        volumes = [lib.volume(body)]
        for step, name in enumerate(("one", "two", "three")):
            mesh = result.mesh(name)
            self.assertManifold(mesh)
            self.assertOneComponent(mesh)
            volumes.append(lib.volume(mesh))
            self.assertEqual(int(result.figures(step)["faces"]), len(mesh.f))
        self.assertTrue((np.diff(volumes) > 0.2).all(), volumes)
        final = result.mesh("three")
        for head, tip in zip(heads, tips):
            near = np.linalg.norm(head.centroids() - tip, axis=1) < 0.45
            self.assertHasFaces(final, head, near & (np.linalg.norm(head.centroids()[:, :2], axis=1) > 2.4))

    def test_align_then_compose(self):
        """A head that lies elsewhere is brought to its place and joined, in one script."""
        body = shapes.neck_with_head((0, 0, -2), (0, 0, 0), 0.3, 0.6).select_faces(lambda c: c[:, 2] > -0.3)
        other = shapes.neck_with_head((0, 0, -2), (0, 0, 0), 0.3, 0.6)
        other.v[:, 0] *= 1 + 0.3 * (other.v[:, 2] > 0.3)  # tells the two apart
        other.select_faces(lambda c: c[:, 2] > -0.3).turned((0, 1, 0), 20).moved((4, 1, 0))
        keep = dict(**box("KeepA", (0, 0, -2.3), (0, 0, -2)), **box("KeepB", (0, 0, 0.6)))
        steps = [template("align_part_in_whole", MovingMesh=1, FixedMesh=0, Overlap=0.8),
                 template("compose", MeshA=0, MeshB=1, **keep)]
        result = run([body, other], steps)
        self.assertSucceeded(result)
        self.assertManifold(result.mesh())
        self.assertLess(float(result.figures(0)["rms_after"]), 0.1)

    def test_a_new_selection_on_a_result(self):
        """Compose, select on the result, compose again with the selection."""
        bar = shapes.capsule((-1.5, 0, 0), (0.5, 0, 0), 0.5, 32, 40).select_faces(lambda c: c[:, 0] < -1.2)
        up = shapes.capsule((-0.3, 0, 0), (1.5, 0, 0.6), 0.45, 32, 40).select_faces(lambda c: c[:, 0] > 1.4)
        on = shapes.capsule((1, 0, 0.45), (3, 0, 0), 0.4, 32, 40).select_faces(lambda c: c[:, 0] > 2.6)
        steps = [template("compose", MeshA=0, MeshB=1), select_faces("(x0 < -1)"), template("compose", MeshA=3, MeshB=2)]
        result = run([bar, up, on], steps)
        self.assertSucceeded(result)
        mesh = result.mesh()
        self.assertManifold(mesh)
        self.assertOneComponent(mesh)
        for model in (bar, on):
            self.assertHasFaces(mesh, model, model.face_selected)
        self.assertGreater(mesh.v[:, 0].max(), 3)

    def test_a_failing_step_stops_the_script(self):
        a, b = shapes.sphere(), shapes.sphere((9, 0, 0))
        keep = dict(**box("KeepA", (-1, 0, 0)), **box("KeepB", (10, 0, 0)))
        result = run([a, b], [current(0), template("compose", **keep), template("compose", **keep)])
        self.assertFailed(result, "touch")


if __name__ == "__main__":
    lib.main()
