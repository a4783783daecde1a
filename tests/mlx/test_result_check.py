# SPDX-License-Identifier: GPL-3.0-or-later
"""Results beside their inputs, through meshlabserver: figures, warnings, AllowFlaws."""
import lib
import shapes
from lib import run, template


def trunk():
    return shapes.capsule((-1.5, 0, 0), (0.8, 0, 0), 0.5, 24, 36).select_faces(lambda c: c[:, 0] < -1.2)


def branch():
    return shapes.capsule((-0.4, 0, 0), (1.6, 0, 0.7), 0.45, 24, 36).select_faces(lambda c: c[:, 0] > 1.4)


class ResultCheck(lib.MeshCase):
    def figures(self, result, of):
        found = result.figures()
        return [int(found[f"{of}_{name}"]) for name in ("pieces", "borders", "nonmanifold", "crossings")]

    def test_a_sound_result_beside_its_inputs(self):
        result = run([trunk(), branch()], [template("compose", AllowFlaws=False)])
        self.assertSucceeded(result)
        self.assertEqual(self.figures(result, "result"), [1, 0, 0, 0])
        self.assertEqual(self.figures(result, "input"), [2, 0, 0, 0])
        self.assertFalse(result.warnings)

    def test_what_was_asked_for_is_no_flaw(self):
        result = run([trunk(), branch()], [template("compose", Stitch=False)])
        self.assertFalse(result.warnings, "open borders and two pieces are what was asked for")
        hole = shapes.merged(trunk(), shapes.sphere((0, 0, 3), 0.2))
        result = run([hole.select_faces(lambda c: (c[:, 0] < -1.2) | (c[:, 2] > 2)), branch()], [template("compose")])
        self.assertSucceeded(result)
        self.assertEqual(self.figures(result, "result")[0], 2)
        self.assertEqual(self.figures(result, "input")[0], 3)
        self.assertFalse(result.warnings, "one piece fewer than the inputs have")

    def test_without_allow_flaws_it_fails_and_changes_nothing(self):
        # Two sheets of a plane, cut along each other's border: nothing joins them.
        left, right = shapes.grid(2, 10), shapes.grid(2, 10)
        right.v[:, 0] += 1
        models = [left.select_faces(lambda c: c[:, 0] < left.v[:, 0].min() + 0.5),
                  right.select_faces(lambda c: c[:, 0] > right.v[:, 0].max() - 0.5)]
        allowed = run(models, [template("compose")])
        self.assertSucceeded(allowed)
        self.assertIn("2 pieces where 1 would do", allowed.warnings[-1])
        self.assertEqual(allowed.logs[-1][-1][0], "warning", "the last line")
        refused = run(models, [template("compose", AllowFlaws=False)])
        self.assertFailed(refused, "2 pieces where 1 would do", "AllowFlaws")
        self.assertFalse((refused.folder / "out.ply").exists())

    def test_a_scan_in_utm_coordinates_is_refused_in_words(self):
        away = shapes.sphere((455812, 5423377, 118), 0.12).select_faces(lambda c: c[:, 2] > 118)
        near = shapes.sphere((0, 0, 0), 0.12).select_faces(lambda c: c[:, 2] > 0)
        self.assertFailed(run([away, near], [template("compose")]), "rounded to 0.5", "move it to the origin")
        self.assertFailed(run([away, near], [template("align_part_in_whole")]), "rounded to 0.5")


if __name__ == "__main__":
    lib.main()
