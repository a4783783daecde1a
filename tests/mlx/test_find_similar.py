# SPDX-License-Identifier: GPL-3.0-or-later
"""Find Similar Surfaces through meshlabserver."""
import numpy as np

import lib
import mend
from lib import run, template

BUSTS = mend.Busts()


class FindSimilar(lib.MeshCase):
    def test_candidates_lie_on_the_scan(self):
        step = template("find_similar", Database=BUSTS.database, Candidates=2, **BUSTS.region("hole"))
        result = run([BUSTS.file("hole")], [step], {"first": 1, "second": 2})
        self.assertSucceeded(result)
        scan = BUSTS.mesh("hole")
        around = scan.v[mend.inside(scan.v, BUSTS.boxes["hole"])]
        for name in ("first", "second"):
            self.assertLess(mend.nearest(around, result.mesh(name).v).mean(), 0.05)
        scores = [float(result.figures()[f"candidate_{i}"].split()[-1]) for i in (1, 2)]
        self.assertLessEqual(scores[0], scores[1])

    def test_around_the_holes(self):
        step = template("find_similar", Database=BUSTS.database, Region="Around all holes", Candidates=1)
        result = run([BUSTS.file("crown")], [step])
        self.assertSucceeded(result)
        self.assertGreater(np.ptp(result.mesh().v[:, 1]), 1)

    def test_nothing_selected(self):
        result = run([BUSTS.file("hole")], [template("find_similar", Database=BUSTS.database)])
        self.assertFailed(result, "no face is selected")


if __name__ == "__main__":
    lib.main()
