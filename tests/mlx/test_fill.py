# SPDX-License-Identifier: GPL-3.0-or-later
"""Fill Hole through meshlabserver: each way of giving the region, and failures."""
import numpy as np

import lib
import mend
import shapes
from lib import host_filter, run, select_faces, template

BUSTS = mend.Busts()


class Fill(lib.MeshCase):
    def fill(self, mesh, **values):
        return run([mesh], [template("fill_hole", **{"Database": BUSTS.database, **mend.MEND, **values})])

    def check(self, result, scan):
        self.assertSucceeded(result)
        mesh = result.mesh()
        self.assertManifold(mesh)
        self.assertHasFaces(mesh, scan)
        self.assertOneComponent(mesh)
        return mesh

    def test_all_holes(self):
        scan = BUSTS.mesh("hole")
        result = self.fill(BUSTS.file("hole"))
        mesh = self.check(result, scan)
        figures = result.figures()
        self.assertEqual(figures["regions"], "1")
        self.assertEqual(figures["mended"], "1")
        self.assertEqual(int(figures["faces"]), len(mesh.f))
        self.assertEqual(figures["left_open"], "0")
        self.assertIn("1 of 1 hole filled.", result.text)
        self.assertIn("bust_", figures["model"])
        # A nose, not a lid: nearer to what was there than the hole's rim is.
        whole = BUSTS.mesh("whole")
        lost = whole.v[mend.inside(whole.v, BUSTS.boxes["hole"])]
        lost = lost[mend.nearest(lost, scan.v) > 0.02]
        self.assertGreater(len(lost), 20)
        self.assertLess(mend.nearest(lost, mesh.v).mean(), 0.5 * mend.nearest(lost, scan.v).mean())

    def test_crown_in_a_box(self):
        self.check(self.fill(BUSTS.file("crown"), **BUSTS.region("crown")), BUSTS.mesh("crown"))

    def test_beside_the_selection(self):
        scan = BUSTS.mesh("hole")
        low, high = BUSTS.boxes["hole"]
        beside = " && ".join(f"({a}0 > {lo}) && ({a}0 < {hi})" for a, lo, hi in zip("xyz", low, high))
        steps = [select_faces("(" + beside + ")"),
                 template("fill_hole", Database=BUSTS.database, Region="Around the selection", **mend.MEND)]
        self.check(run([BUSTS.file("hole")], steps), scan)

    def test_the_selected_hole_else_all(self):
        """A second hole, at the crown; faces beside the nose are selected."""
        def inside(box):
            return " && ".join(f"({a}0 > {lo}) && ({a}0 < {hi})" for a, lo, hi in zip("xyz", *BUSTS.boxes[box]))
        open_crown = [select_faces("(" + inside("crown") + ")"), host_filter("Delete Selected Faces")]
        fill = template("fill_hole", Database=BUSTS.database, **mend.MEND)
        selected = run([BUSTS.file("hole")], open_crown + [select_faces("(" + inside("hole") + ")"), fill])
        self.assertSucceeded(selected)
        self.assertEqual(selected.figures()["regions"], "1")
        self.assertTrue((lib.edge_counts(selected.mesh().f)[2] == 1).any(), "the crown stays open")
        both = run([BUSTS.file("hole")], open_crown + [fill])
        self.assertGreater(int(both.figures()["regions"]), 1)

    def test_new_faces_are_selected(self):
        steps = [template("fill_hole", Database=BUSTS.database, **mend.MEND), host_filter("Delete Selected Faces")]
        result = run([BUSTS.file("hole")], steps)
        scan = BUSTS.mesh("hole")
        self.assertHasFaces(result.mesh(), scan)
        self.assertEqual(len(result.mesh().f), len(scan.f))

    def test_as_in_the_thesis(self):
        """Neither refined, fitted nor blended."""
        result = self.fill(BUSTS.file("crown"), FitToRim=False, Refine=False, Blend=1)
        self.assertSucceeded(result)
        self.assertManifold(result.mesh())

    def test_candidate_layer(self):
        step = template("fill_hole", Database=BUSTS.database, AddCandidate=True, **mend.MEND)
        result = run([BUSTS.file("hole")], [step], {"out": 1, "candidate": 2})
        self.assertSucceeded(result)
        self.assertGreater(len(result.mesh("candidate").f), 1000)

    def test_holes_left_out(self):
        self.assertFailed(self.fill(BUSTS.file("hole"), LongestRim=0.1), "left out")

    def test_no_hole(self):
        self.assertFailed(self.fill(BUSTS.file("whole")), "no hole")

    def test_no_hole_in_the_box(self):
        low, high = BUSTS.boxes["crown"]
        self.assertFailed(self.fill(BUSTS.file("hole"), Region="Box", RegionMin=low, RegionMax=high), "no hole")

    def test_no_database(self):
        scan = BUSTS.file("hole")
        self.assertFailed(self.fill(scan, Database="nowhere/at_all"), "nowhere/at_all")

    def test_the_scan_itself_is_the_database(self):
        """An ear comes back from the other one; a nose does not, and the sentence says what to do."""
        whole = BUSTS.mesh("whole")
        x = whole.v[:, 0] * (whole.v[:, 1] > -0.2)
        ear = whole.v[np.argmax(x)]
        lost = np.linalg.norm(whole.v - ear, axis=1) < 0.15
        scan = shapes.Mesh(whole.v, whole.f[~lost[whole.f].any(axis=1)])
        shapes.write_ply(BUSTS.folder / "ear.ply", scan)
        result = self.fill(BUSTS.folder / "ear.ply", Database="")
        mesh = self.check(result, scan)
        figures = result.figures()
        self.assertIn("mirror image", figures["model"])
        self.assertLess(float(figures["symmetry_residual"]), 0.03)
        self.assertLess(mend.nearest(whole.v[lost], mesh.v).mean(), 0.02)
        self.assertFailed(self.fill(BUSTS.file("hole"), Database=""), "Database")

    def test_matrix_counts(self):
        """A layer's matrix places the scan, here in other units and turned."""
        matrix = np.eye(4)
        matrix[:3, :3] = 100 * shapes.rotation((0, 1, 0), 20)
        scan = BUSTS.mesh("hole")
        result = run([BUSTS.file("hole")], [template("fill_hole", Database=BUSTS.database, **mend.MEND)],
                     matrices={0: matrix})
        self.assertSucceeded(result)
        mesh = result.mesh()
        self.assertManifold(mesh)
        self.assertAlmostEqual(np.ptp(mesh.v[:, 1]) / np.ptp(scan.v[:, 1]), 100, delta=1)


if __name__ == "__main__":
    lib.main()
