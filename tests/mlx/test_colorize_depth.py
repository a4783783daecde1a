# SPDX-License-Identifier: GPL-3.0-or-later
"""Colorize Depth Map through meshlabserver: the image, its sources, the mesh, what is refused."""
import subprocess

import numpy as np
from PIL import Image

import lib
import rasters
from lib import run, template


class ColorizeDepth(lib.MeshCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = lib.work_folder()
        busts = cls.folder / "busts"
        subprocess.run([lib.STAGE.parent / "tools" / "make_busts", busts, "5"], check=True, stdout=subprocess.DEVNULL)
        result = run([], [template("build_mappings", Models=busts / "busts.mlp", Output=cls.folder / "all.mlp",
                                   Width=60, Height=80, Ambient=1)], outputs={})
        assert result.code == 0, result.text
        cls.stored = cls.folder / "all.mlp"
        first = sorted((cls.folder / "all_mappings").glob("000_*_depth.tif"))[0]
        cls.truth = np.asarray(Image.open(str(first).replace("_depth.tif", ".png")).convert("RGB"), float)
        cls.depth = first
        for file in busts.glob("bust_00*"):  # the query is no example
            file.unlink()
        cls.models = busts / "bust_01.ply"

    def colored(self, saved=None, **values):
        values = dict(dict(Depth=self.depth, Database=self.models, PatchSizes="5,7"), **values)
        result = run([], [template("colorize_depth", **values)], saved)
        self.assertSucceeded(result)
        return result

    def fails(self, *words, **values):
        values = dict(dict(Depth=self.depth, Database=self.models, PatchSizes="5,7"), **values)
        self.assertFailed(run([], [template("colorize_depth", **values)]), *words)

    def test_image_sources_and_mesh(self):
        image, usage = self.folder / "image.png", self.folder / "usage.png"
        result = self.colored(ImageFile=image, UsageFile=usage)
        pixels = np.asarray(Image.open(image))
        foreground = np.nan_to_num(np.asarray(Image.open(self.depth))) > 0
        self.assertEqual(pixels.shape, (80, 60, 4))
        np.testing.assert_array_equal(pixels[..., 3] == 255, foreground)
        np.testing.assert_array_equal(np.asarray(Image.open(usage)).max(axis=2) > 0, foreground)
        examples = [value.split() for name, value in result.logs[0] if name == "example"]
        self.assertEqual(len(examples) + int(result.figures().get("left_out", 0)), 2)
        self.assertAlmostEqual(sum(float(share) for _, share in examples), 1, 3)
        mesh = result.mesh()
        self.assertManifold(mesh, None)
        self.assertEqual(int(foreground.sum()), len(mesh.v))

    def test_one_example_by_name(self):
        result = self.colored(Choose="bust_03")
        self.assertEqual(result.figures()["example"], "bust_03.ply 1")

    def test_stored_examples_give_back_what_they_hold(self):
        """The query itself among the examples: its own colours."""
        image = self.folder / "again.png"
        self.colored(Database=self.stored, ImageFile=image, Examples=1)
        pixels = np.asarray(Image.open(image)).astype(float)
        inside = pixels[..., 3] == 255
        self.assertLess(abs(pixels[inside][:, :3] - self.truth[inside]).mean(), 6)

    def test_same_bytes_again(self):
        names = [self.folder / f"same{k}.png" for k in range(2)]
        for name in names:
            self.colored({}, ImageFile=name, AddMesh=False)
        self.assertEqual(names[0].read_bytes(), names[1].read_bytes())

    def test_sentences(self):
        self.fails("PatchSizes", PatchSizes="5,six")
        self.fails("PatchSizes", PatchSizes="")
        self.fails("odd", PatchSizes="4,7")
        self.fails("Choose", Choose="nobody")
        self.fails("No depth", Depth="")
        self.fails("No database", Database="")
        self.fails("AddMesh", AddMesh=False)
        before = self.depth.read_bytes()
        self.fails("input", ImageFile=self.depth)
        self.assertEqual(self.depth.read_bytes(), before)
        empty = rasters.save_tif(self.folder / "empty.tif", np.zeros((20, 20)))
        self.fails("zeros", Depth=empty)


if __name__ == "__main__":
    lib.main()
