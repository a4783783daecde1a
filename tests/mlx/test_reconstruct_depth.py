# SPDX-License-Identifier: GPL-3.0-or-later
"""Reconstruct Depth from Image through meshlabserver: stored and rendered examples, an image file, a raster layer."""
import shutil

import numpy as np
from PIL import Image

import lib
import rasters
import shapes
from lib import run, template


def creature(k):
    """An egg with a nose, another one for another k; light and dark halves."""
    m = shapes.sphere(level=5).painted(230, 200, 170)
    up = m.v[:, 1]
    nose = np.exp(-((m.v - [0, 0.1, 1]) ** 2).sum(axis=1) / (0.06 + 0.01 * (k % 3)))
    m.v = m.v * [1, 1.25 + 0.04 * k, 0.8] * (1.1 + (0.1 + 0.03 * (k % 4)) * up)[:, None]
    m.v = m.v + nose[:, None] * [0, 0, 0.25 + 0.04 * (k % 5)]
    return m


def error(depth, truth):
    """Standard deviation of the difference as a share of the range."""
    seen = np.isfinite(truth)
    return (depth - truth)[seen].std() / np.ptp(truth[seen])


class ReconstructDepth(lib.MeshCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = lib.work_folder()
        models, one = cls.folder / "models", cls.folder / "one"
        models.mkdir(), one.mkdir()
        for k in range(7):
            shapes.write_ply((one if k == 3 else models) / f"thing_{k}.ply", creature(k))
        cls.models, cls.stored, cls.query = models, cls.folder / "things.mlp", cls.folder / "query.mlp"
        result = run([], [template("build_mappings", Models=models, Output=cls.stored, Width=75, Height=100),
                          template("build_mappings", Models=one, Output=cls.query, Width=75, Height=100)], {})
        assert result.code == 0, result.text
        pictures = [p for p in cls.folder.glob("query_mappings/*.png") if np.array(Image.open(p)).ndim == 3]
        cls.image = pictures[0]
        cls.truth = rasters.read(next(cls.folder.glob("query_mappings/*_depth.tif")))
        cls.examples = [rasters.read(p) for p in sorted(cls.folder.glob("things_mappings/*_depth.tif"))]

    def step(self, **values):
        return template("reconstruct_depth", **dict(dict(Image=self.image, Database=self.stored), **values))

    def result(self, **values):
        self.out = lib.work_folder()
        names = dict(DepthFile=self.out / "d.tif", UsageFile=self.out / "u.png", MaskFile=self.out / "m.png")
        result = run([], [self.step(**dict(names, **values))])
        self.assertSucceeded(result)
        return result

    def fails(self, *words, **values):
        self.assertFailed(run([], [self.step(**values)], {}), *words)

    def check_depth(self, result, most):
        depth = rasters.read(self.out / "d.tif")
        self.assertEqual(depth.shape, self.truth.shape)
        np.testing.assert_array_equal(np.isfinite(depth), np.isfinite(self.truth))
        self.assertLess(error(depth, self.truth), most)
        mesh = result.mesh()
        self.assertManifold(mesh, None)
        self.assertEqual(int(result.figures()["faces"]), len(mesh.f))

    def test_stored_examples(self):
        result = self.result()
        self.check_depth(result, 0.06)
        figures = result.figures()
        self.assertEqual(figures["trusted"], "yes")
        np.testing.assert_array_equal(rasters.read(self.out / "m.png") > 0, np.isfinite(self.truth))
        usage = rasters.read(self.out / "u.png")
        self.assertTrue((usage[~np.isfinite(self.truth)] == 255).all())
        self.assertGreater(len(np.unique(usage[np.isfinite(self.truth)], axis=0)), 1)
        levels = [[float(x) for x in level.split()] for level in figures["plausibility"].split(";")]
        self.assertEqual(len(levels), 3)
        for values in levels:
            for before, after in zip(values, values[1:]):
                self.assertGreaterEqual(after, before - 1e-5)
        patches = sum(int(e.split()[-1]) for e in figures["examples_used"].split(";"))
        in_frame = int(figures["foreground_pixels"]) * float(figures["scale"]) ** 2
        self.assertLess(abs(patches - in_frame), 0.05 * in_frame)

    def test_better_than_the_mean(self):
        self.result()
        ours = error(rasters.read(self.out / "d.tif"), self.truth)
        mean = np.nanmean(np.array(self.examples), axis=0)
        both = np.isfinite(mean) & np.isfinite(self.truth)
        self.assertLess(ours, (mean - self.truth)[both].std() / np.ptp(self.truth[both]))

    def test_rendered_examples_and_the_view(self):
        result = self.result(Database=self.models, UpdateViews=True, Views="0,0")
        self.check_depth(result, 0.1)
        self.assertLess(abs(float(result.figures()["view_yaw"])), 12)

    def test_back_side_closes_a_solid(self):
        result = self.result(BackSide=True, BackDepthFile=self.folder / "b.tif")
        self.assertManifold(result.mesh())
        back = rasters.read(self.folder / "b.tif")
        seen = np.isfinite(self.truth)
        self.assertTrue((back >= rasters.read(self.out / "d.tif"))[seen].all())
        truth = rasters.read(next(self.folder.glob("query_mappings/*_back.tif")))
        self.assertLess(error(back, truth), 0.2)

    def test_the_preset_of_the_class(self):
        preset = '{ "reconstruct_depth": { "PatchSizes": "7,7", "WeightPosition": 2.5, "WeightDepth": 3 } }'
        folder = self.folder / "preset"
        shutil.copytree(self.models, folder)
        (folder / "class.json").write_text(preset)
        stored = self.folder / "preset.mlp"
        built = run([], [template("build_mappings", Models=folder, Output=stored, Width=75, Height=100)], {})
        self.assertSucceeded(built)
        for database in (folder, stored):  # the database that is built passes it on
            figures = self.result(Database=database, UpdateViews=False).figures()
            self.assertEqual((figures["patch_sizes"], figures["levels"]), ("7,7", "2"))
            self.assertEqual(figures["weights"], "1 0.5 3 2.5")
            preset_depth = (self.out / "d.tif").read_bytes()
        given = dict(PatchSizes="7,7", WeightPosition=2.5, WeightDepth=3, UpdateViews=False)
        self.assertEqual(self.result(**given).figures()["weights"], "1 0.5 3 2.5")
        self.assertEqual((self.out / "d.tif").read_bytes(), preset_depth)
        figures = self.result(Database=folder, PatchSizes="5,5", WeightDepth=0.5, UpdateViews=False).figures()
        self.assertEqual((figures["patch_sizes"], figures["weights"]), ("5,5", "1 0.5 0.5 2.5"))
        self.assertNotEqual((self.out / "d.tif").read_bytes(), preset_depth)

    def test_the_current_raster_layer(self):
        out = lib.work_folder()
        result = run([], [self.step(Image="", DepthFile=out / "d.tif")], project=self.query)
        self.assertSucceeded(result)
        self.assertLess(error(rasters.read(out / "d.tif"), self.truth), 0.1)

    def test_same_twice(self):
        self.result()
        first = (self.out / "d.tif").read_bytes(), (self.out / "u.png").read_bytes()
        self.result()
        self.assertEqual(first, ((self.out / "d.tif").read_bytes(), (self.out / "u.png").read_bytes()))

    def test_without_a_mask(self):
        pixels = np.array(Image.open(self.image).convert("RGBA"))
        seen = pixels[..., 3] > 127
        plain = np.where(seen[..., None], pixels[..., :3], 255)
        self.check_depth(self.result(Image=rasters.save_image(self.folder / "plain.png", plain)), 0.1)
        y, x = np.mgrid[:seen.shape[0], :seen.shape[1]]
        rough = np.where(seen[..., None], pixels[..., :3], np.stack([0 * x, 40 + y // 2, 60 + x], -1))
        rough = rasters.save_image(self.folder / "rough.png", rough)
        self.fails("mask", Image=rough)
        result = self.result(Image=rough, Segment=True)
        found = rasters.read(self.out / "m.png") > 0
        self.assertGreater((found & seen).sum() / (found | seen).sum(), 0.8)
        self.assertManifold(result.mesh(), None)

    def test_what_is_wrong(self):
        self.fails("missing", Image="missing.png")
        self.fails("database", Database="")
        self.fails("patch", PatchSizes="5,6,9")
        self.fails("patch", PatchSizes="five")
        self.fails("patch", PatchSizes="31,31,31")
        self.fails("BackSide", BackDepthFile=self.folder / "no.tif")
        self.fails("inputs", MaskFile=self.image)
        small = rasters.save_image(self.folder / "small.png", np.full((20, 20), 255))
        self.fails("mask", Mask=small)
        black = rasters.save_image(self.folder / "black.png", np.zeros(self.truth.shape))
        self.fails("mask", Mask=black)
        self.assertFalse((self.folder / "no.tif").exists())


if __name__ == "__main__":
    lib.main()
