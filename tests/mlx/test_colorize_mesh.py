# SPDX-License-Identifier: GPL-3.0-or-later
"""Colorize Mesh through meshlabserver: textures, vertex colours, sources, a script for many, what is refused."""
import shutil
import subprocess

import numpy as np
from PIL import Image

import lib
import shapes
from lib import current, run, template


class ColorizeMesh(lib.MeshCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = lib.work_folder()
        cls.busts = cls.folder / "busts"
        subprocess.run([lib.STAGE.parent / "tools" / "make_busts", cls.busts, "5"], check=True,
                       stdout=subprocess.DEVNULL)
        cls.query = cls.folder / "bust_00.ply"  # no model
        for file in cls.busts.glob("bust_00*"):
            shutil.move(file, cls.folder)
        result = run([cls.query], [])
        cls.mesh = result.mesh()
        cls.plain = dict(Database=cls.busts / "bust_01.ply", PatchSizes="5,7", Width=60, Height=80, TextureSize=256)

    def step(self, **values):
        return template("colorize_mesh", **dict(self.plain, **values))

    def colored(self, mesh=None, **values):
        result = run([mesh or self.query], [self.step(**values)])
        self.assertSucceeded(result)
        return result

    def fails(self, *words, **values):
        self.assertFailed(run([self.query], [self.step(**values)]), *words)

    def test_a_mesh_that_lies_gets_the_colours_of_one_that_stands(self):
        """Found by itself, or said: Up and Front turn the mesh, and not the models as well."""
        standing = self.colored(Target="Vertex colour").mesh().color[:, :3].astype(int)
        x, y, z = self.mesh.v.T
        lying = shapes.Mesh(np.stack([x, -z, y], 1), self.mesh.f)
        found = self.colored(lying, Target="Vertex colour")
        self.assertEqual((found.figures()["up"], found.figures()["front"]), ("0 0 1", "0 -1 0"))
        said = self.colored(lying, Target="Vertex colour", Up=(0, 0, 1), Front=(0, -1, 0))
        self.assertNotIn("up", said.figures())
        for result in (found, said):
            self.assertLess(abs(result.mesh().color[:, :3].astype(int) - standing).mean(), 6)

    def test_an_atlas_and_then_these_coordinates(self):
        bare = shapes.Mesh(self.mesh.v, self.mesh.f)
        texture = self.folder / "atlas.png"
        result = self.colored(bare, TextureFile=texture, TextureSize=512)
        unfolded, figures = result.mesh(), result.figures()
        self.assertGreater(int(figures["charts"]), 1)
        self.assertGreaterEqual(unfolded.wedge.min(), 0)
        self.assertLessEqual(unfolded.wedge.max(), 1)
        self.assertGreater(float(figures["seen"]), 0.8)
        examples = [value.split() for name, value in result.logs[0] if name == "example"]
        self.assertAlmostEqual(sum(float(share) for _, share in examples), 1, 3)
        self.assertEqual(np.asarray(Image.open(texture)).shape[:2], (512, 512))

        again = self.folder / "again.png"
        result = self.colored(result.folder / "out.ply", TextureFile=again, TextureSize=512)
        mesh = result.mesh()
        self.assertNotIn("charts", result.figures())
        np.testing.assert_array_equal(mesh.v, self.mesh.v)
        np.testing.assert_array_equal(mesh.f, self.mesh.f)
        np.testing.assert_allclose(mesh.wedge, unfolded.wedge, atol=1e-6)
        self.assertLess(abs(self.texels(texture, mesh) - self.texels(again, mesh)).mean(), 2)

        self.assertEqual(self.colored(Target="Vertex colour").mesh().wedge, None)
        own = self.colored(bare, Target="Vertex colour").mesh().color[:, :3].astype(float)[mesh.f].mean(axis=1)
        self.assertLess(abs(self.texels(texture, mesh) - own).mean(), 8)

    @staticmethod
    def texels(texture, mesh):
        """Colours at the faces' centres, 0 to 255."""
        pixels = np.asarray(Image.open(texture).convert("RGB")).astype(float)
        uv = mesh.wedge.mean(axis=1)
        return pixels[((1 - uv[:, 1]) * len(pixels)).astype(int), (uv[:, 0] * len(pixels[0])).astype(int)]

    def test_everything_is_in_its_place(self):
        """One example's colours for skin, hair and shirt: but for these, the bust's own colours."""
        own = next(self.folder.glob("bust_00*.png"))
        truth = self.texels(own, self.mesh)
        mesh = self.colored(Target="Vertex colour", Width=120, Height=160, Examples=1).mesh()
        found = mesh.color[:, :3].astype(float)[mesh.f].mean(axis=1)
        given = np.concatenate([found, np.ones((len(found), 1))], axis=1)
        rest = truth - given @ np.linalg.lstsq(given, truth, rcond=None)[0]
        self.assertLess(rest.var() / truth.var(axis=0).mean(), 0.3)

    def test_a_name_for_the_texture_is_found(self):
        result = self.colored()
        self.assertEqual(result.figures()["texture"], str(result.folder / "bust_00_texture.png"))

    def test_sources_and_one_example(self):
        usage = self.folder / "usage.png"
        result = self.colored(Examples=1, Choose="bust_03", UsageFile=usage)
        self.assertEqual(result.figures()["example"], "bust_03.ply 1")
        self.assertGreater(np.asarray(Image.open(usage)).max(), 0)

    def test_many_in_one_script(self):
        """The second filter finds the models read; its result is that of a script of its own."""
        steps = [current(i) for i in range(2)]
        names = [self.folder / f"many{i}.png" for i in range(2)]
        script = [step for i in range(2) for step in (steps[i], self.step(Mesh=i, TextureFile=names[i], Seed=i))]
        both = run([self.query, self.busts / "bust_02.ply"], script, {})
        self.assertSucceeded(both)
        alone = self.folder / "alone.png"
        self.colored(self.busts / "bust_02.ply", TextureFile=alone, Seed=1)
        self.assertEqual(names[1].read_bytes(), alone.read_bytes())
        self.assertNotEqual(names[0].read_bytes(), names[1].read_bytes())

    def test_sentences(self):
        self.fails("No database", Database="")
        self.fails("PatchSizes", PatchSizes="5,six")
        self.fails("Choose", Choose="nobody")
        self.fails("view", Views="")
        self.fails("TextureSize", TextureSize=3)
        model = next(self.busts.glob("bust_01*.png"))
        before = model.read_bytes()
        self.fails("input", TextureFile=model)
        own = next(self.folder.glob("bust_00*.png"))
        self.fails("input", TextureFile=own)
        self.fails("input", UsageFile=model)
        self.assertEqual(model.read_bytes(), before)


if __name__ == "__main__":
    lib.main()
