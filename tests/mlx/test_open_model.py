# SPDX-License-Identifier: GPL-3.0-or-later
"""Open Model as Layer: what the host's own reader of .obj, which aborts on Debian 12, is to give."""
import numpy as np

import lib
import shapes
from lib import run, template


class OpenModel(lib.MeshCase):
    def setUp(self):
        self.folder = lib.work_folder()

    def open(self, file, steps=()):
        result = run([], [template("open_model", File=file), *steps])
        self.assertSucceeded(result)
        return result

    def textured(self):
        """A square of two faces with a texture beside it."""
        shapes.write_png(self.folder / "skin.png", (200, 30, 30))
        (self.folder / "square.mtl").write_text("newmtl skin\nmap_Kd skin.png\n")
        (self.folder / "square.obj").write_text(
            "mtllib square.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl skin\n"
            "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n")
        return self.folder / "square.obj"

    def test_an_obj_with_its_texture(self):
        result = self.open(self.textured())
        mesh = result.mesh()
        self.assertEqual(len(mesh.f), 2)
        self.assertEqual(result.figures()["faces"], "2")
        np.testing.assert_allclose(mesh.wedge[0], [[0, 0], [1, 0], [1, 1]], atol=1e-6)
        from PIL import Image
        [texture] = result.texture_files()
        self.assertEqual(np.asarray(Image.open(texture).convert("RGB"))[0, 0].tolist(), [200, 30, 30])
        self.assertEqual(result.warnings, [])

    def test_it_becomes_the_current_layer(self):
        """The next filter works on it."""
        result = self.open(self.textured(), [lib.select_faces("fi == 0"), lib.host_filter("Delete Selected Faces")])
        self.assertEqual(len(result.mesh().f), 1)

    def test_what_is_missing_is_said(self):
        file = self.textured()
        (self.folder / "skin.png").unlink()
        self.assertIn("skin.png", self.open(file).warnings[0])

    def test_off_stl_and_ply(self):
        ball = shapes.capsule((-1, 0, 0), (1, 0, 0), 0.5, 12, 16)
        shapes.write_ply(self.folder / "a.ply", ball)
        rows = [f"{len(ball.v)} {len(ball.f)} 0"] + [" ".join(map(repr, map(float, v))) for v in ball.v]
        rows += ["3 " + " ".join(map(str, map(int, f))) for f in ball.f]
        (self.folder / "b.off").write_text("OFF\n" + "\n".join(rows) + "\n")
        facets = "".join("facet normal 0 0 0\nouter loop\n" + "".join(
            "vertex " + " ".join(map(repr, map(float, ball.v[i]))) + "\n" for i in face) + "endloop\nendfacet\n"
            for face in ball.f)
        (self.folder / "c.stl").write_text("solid c\n" + facets + "endsolid c\n")
        for name in ("a.ply", "b.off", "c.stl"):
            mesh = self.open(self.folder / name).mesh()
            self.assertEqual(len(mesh.f), len(ball.f), name)
            self.assertAlmostEqual(lib.volume(mesh), lib.volume(ball), 4, name)

    def test_sentences(self):
        for words, values in ((("No model",), {}), (("missing",), dict(File=self.folder / "missing.obj")),
                              ((".txt",), dict(File=__file__ + ".txt"))):
            self.assertFailed(run([], [template("open_model", **values)], {}), *words)


if __name__ == "__main__":
    lib.main()
