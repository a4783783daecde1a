# SPDX-License-Identifier: GPL-3.0-or-later
"""Restore Surface through meshlabserver: a box, a selection, failures."""
import lib
import mend
from lib import run, select_faces, template

BUSTS = mend.Busts()


class Restore(lib.MeshCase):
    def check(self, result, region):
        self.assertSucceeded(result)
        scan, mesh = BUSTS.mesh("scar"), result.mesh()
        self.assertManifold(mesh)
        self.assertOneComponent(mesh)
        outside = ~mend.inside(scan.v, region)[scan.f].all(axis=1)
        self.assertHasFaces(mesh, scan, outside)
        self.assertGreater(int(result.figures()["faces_replaced"]), 20)
        return mesh

    def test_box(self):
        step = template("restore", Database=BUSTS.database, **BUSTS.region("cheek"), **mend.MEND)
        mesh = self.check(run([BUSTS.file("scar")], [step]), BUSTS.boxes["cheek"])
        # Nearer to the unharmed bust than the scar was.
        whole, scar = BUSTS.mesh("whole"), BUSTS.mesh("scar")
        damaged = whole.v[mend.nearest(whole.v, scar.v) > 0.005]
        damaged = damaged[mend.inside(damaged, BUSTS.boxes["cheek"])]
        self.assertGreater(len(damaged), 5)
        self.assertLess(mend.nearest(damaged, mesh.v).mean(), mend.nearest(damaged, scar.v).mean())

    def test_selection(self):
        low, high = BUSTS.boxes["cheek"]
        middle = [(a + b) / 2 for a, b in zip(low, high)]
        near = " + ".join(f"({a}0-({m}))^2" for a, m in zip("xyz", middle))
        steps = [select_faces(f"({near} < 0.01)"),
                 template("restore", Database=BUSTS.database, **mend.MEND)]
        self.check(run([BUSTS.file("scar")], steps), BUSTS.boxes["cheek"])

    def test_nothing_selected(self):
        step = template("restore", Database=BUSTS.database, **mend.MEND)
        self.assertFailed(run([BUSTS.file("scar")], [step]), "no face is selected")

    def test_no_surface_in_the_box(self):
        step = template("restore", Database=BUSTS.database, Region="Box", RegionMin=(5, 5, 5), RegionMax=(6, 6, 6))
        self.assertFailed(run([BUSTS.file("scar")], [step]), "no surface")

    def test_inverted_box(self):
        step = template("restore", Database=BUSTS.database, Region="Box", RegionMin=(1, 1, 1), RegionMax=(0, 0, 0))
        self.assertFailed(run([BUSTS.file("scar")], [step]), "no thickness")


if __name__ == "__main__":
    lib.main()
