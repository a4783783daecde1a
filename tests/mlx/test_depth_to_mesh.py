# SPDX-License-Identifier: GPL-3.0-or-later
"""Depth Map to Textured Mesh through meshlabserver: shape, tears, texture, camera, solids."""
import os
import unittest
import xml.etree.ElementTree as xml

import numpy as np

import lib
import rasters
from lib import host_filter, run, template


def project_onto_current():
    """MeshLab's own: the image of the current raster onto the vertices of the current layer."""
    step = host_filter("Project current raster color to current mesh", usedepth=("RichBool", "false"),
                       deptheta=("RichFloat", "0.5"), onselection=("RichBool", "false"))
    xml.SubElement(step, "Param", type="RichColor", name="blankColor", r="0", g="0", b="0", a="0")
    return step


class DepthToMesh(lib.MeshCase):
    def setUp(self):
        self.folder = lib.work_folder()
        self.front, self.back = rasters.sphere()
        self.depth = rasters.save_tif(self.folder / "depth.tif", self.front)
        self.image = rasters.save_image(self.folder / "image.png", rasters.picture())

    def result(self, saved=None, **values):
        values = dict(dict(Depth=self.depth), **values)
        result = run([], [template("depth_to_mesh", **values)], saved)
        self.assertSucceeded(result)
        return result

    def fails(self, *words, **values):
        self.assertFailed(run([], [template("depth_to_mesh", **dict(dict(Depth=self.depth), **values))]), *words)

    def test_the_surface_is_where_it_was(self):
        for save, name in ((rasters.save_tif, "d.tif"), (rasters.save_pfm, "d.pfm")):
            result = self.result(Depth=save(self.folder / name, self.front))
            mesh = result.mesh()
            self.assertManifold(mesh, None)
            distance = np.linalg.norm(mesh.v - [0, 0, -100], axis=1)
            self.assertLess(abs(distance - 25).max(), 1e-3)
            a, b, c = (mesh.v[mesh.f[:, k]] for k in range(3))
            self.assertTrue((np.cross(b - a, c - a)[:, 2] > 0).all(), "towards the camera")
            self.assertEqual(int(result.figures()["faces"]), len(mesh.f))

    def test_scale_and_pixel_size(self):
        file = rasters.save_png16(self.folder / "d.png", self.front, 0.002)
        mesh = self.result(Depth=file, DepthScale=0.0004, PixelSize=0.2).mesh()
        distance = np.linalg.norm(mesh.v - [0, 0, -20], axis=1)
        self.assertLess(abs(distance - 5).max(), 1e-3)

    def test_pinhole(self):
        flat = rasters.save_tif(self.folder / "flat.tif", np.full((40, 60), 10.0))
        mesh = self.result(Depth=flat, FocalLength=50).mesh()
        np.testing.assert_allclose(mesh.v.max(axis=0), [29.5 / 5, 19.5 / 5, -10], rtol=1e-5)
        self.fails("pinhole", Depth=flat, FocalLength=50, DepthScale=-1)

    def test_torn_at_jumps(self):
        depth = np.full((40, 60), 50.0)
        depth[10:30, 20:40] = 20
        file = rasters.save_tif(self.folder / "jump.tif", depth)
        torn, whole = self.result(Depth=file), self.result(Depth=file, MaxJump=31)
        self.assertEqual(lib.components(torn.mesh().f), 2)
        self.assertGreater(int(torn.figures()["torn_pixels"]), 100)
        self.assertOneComponent(whole.mesh())
        self.assertEqual(float(whole.figures()["max_jump"]), 31)

    def test_the_image_is_the_texture(self):
        """Nothing is written, and each vertex has the middle of its pixel."""
        before = sorted(p.name for p in self.folder.iterdir())
        result = self.result(Image=self.image)
        mesh = result.mesh()
        self.assertEqual(mesh.textures, [self.image.name if lib.TEXTURES_IN_MEMORY else str(self.image)])
        corners = mesh.v[mesh.f]
        np.testing.assert_allclose(mesh.wedge[:, :, 0], (corners[:, :, 0] + 30) / 60, atol=1e-5)
        np.testing.assert_allclose(mesh.wedge[:, :, 1], (corners[:, :, 1] + 40) / 80, atol=1e-5)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), before)

    @unittest.skipUnless(lib.SERVER.name == "meshlabserver", "MeshLab's own filter draws, and has nothing to draw on")
    def test_the_image_projects_back_onto_it(self):
        """With the camera of the raster layer, by MeshLab's own filter; also an image of twice the size."""
        large = rasters.save_image(self.folder / "large.png", rasters.picture().repeat(2, 0).repeat(2, 1))
        for focal in (0, 90):
            for image in (self.image, large):
                step = template("depth_to_mesh", Depth=self.depth, Image=image, FocalLength=focal)
                result = run([], [step, project_onto_current()])
                self.assertSucceeded(result)
                mesh = result.mesh()
                if focal:
                    x, y = mesh.v[:, 0] * focal / -mesh.v[:, 2] + 30, 40 - mesh.v[:, 1] * focal / -mesh.v[:, 2]
                else:
                    x, y = mesh.v[:, 0] + 30, 40 - mesh.v[:, 1]
                expected = rasters.picture()[y.astype(int), x.astype(int)].astype(int)
                self.assertGreater(len(mesh.v), 1500)
                wrong = (abs(mesh.color[:, :3].astype(int) - expected).max(axis=1) > 3).mean()
                self.assertLess(wrong, 0.01, f"focal {focal}, {image.name}")

    def test_the_camera_stays_with_the_project(self):
        result = run([], [template("depth_to_mesh", Depth=self.depth, Image=self.image)], save_project=True)
        self.assertSucceeded(result)
        raster = xml.parse(result.folder / "out.mlp").getroot().find("RasterGroup/MLRaster")
        self.assertEqual(raster.get("label"), "image.png")
        camera = raster.find("VCGCamera")
        self.assertEqual((camera.get("CameraType"), camera.get("ViewportPx")), ("1", "60 80"))
        self.assertTrue(raster.find("Plane").get("fileName").endswith("image.png"))

    def test_images_that_meshlab_cannot_show_are_written_anew(self):
        alpha = np.dstack([rasters.picture(), np.where(np.isfinite(self.front), 255, 0)])
        images = {"alpha.png": rasters.save_image(self.folder / "alpha.png", alpha),
                  "deep.tif": rasters.save_image(self.folder / "deep.tif", rasters.picture())}
        for name, image in images.items():
            before = image.read_bytes()
            texture = self.result(Image=image).figures()["texture"]
            self.assertEqual(texture, str(self.folder / ("depth_texture.png" if name == "alpha.png" else
                                                         "depth_texture_2.png")))
            seen = np.isfinite(self.front)
            np.testing.assert_array_equal(rasters.read(texture)[seen], rasters.picture()[seen])
            self.assertEqual(image.read_bytes(), before)
            again = self.result(Image=image).figures()["texture"]
            self.assertEqual(again, texture, "the same picture is not written twice")
        extended = rasters.read(self.folder / "depth_texture.png")
        self.assertTrue((extended[0, 0] != rasters.picture()[0, 0]).any(), "no background at silhouettes")

    def test_background_of_any_number(self):
        """The same mesh as with NaN; the log says so; the user may say otherwise."""
        expected = self.result(BackDepth=rasters.save_tif(self.folder / "b.tif", self.back)).mesh()
        for far in (1e10, 65504, 65535, 100, 3.4e38):
            front, back = (rasters.save_tif(self.folder / f"{name}.tif", np.nan_to_num(raster, nan=far))
                           for name, raster in (("front", self.front), ("behind", self.back)))
            result = self.result(Depth=front, BackDepth=back)
            np.testing.assert_array_equal(result.mesh().v, expected.v, str(far))
            np.testing.assert_array_equal(result.mesh().f, expected.f)
            self.assertAlmostEqual(float(result.figures()["background"]) / far, 1, places=4)
            self.assertEqual(int(result.figures()["background_pixels"]), int(np.isnan(self.front).sum()))
        file = rasters.save_tif(self.folder / "wall.tif", np.nan_to_num(self.front, nan=300))
        kept = self.result(Depth=file, Background="none")
        self.assertEqual(lib.components(kept.mesh().f), 2)
        self.assertNotIn("background", kept.figures())
        named = self.result(Depth=file, Background="300")
        self.assertEqual(lib.components(named.mesh().f), 1)
        millimetres = rasters.save_png16(self.folder / "mm.png", np.nan_to_num(self.front, nan=655.35), 0.01)
        self.assertEqual(lib.components(self.result(Depth=millimetres, DepthScale=0.01).mesh().f), 1)
        self.fails("auto or none", Background="far")

    def test_the_colour_camera_of_the_same_device(self):
        """Other sensors cut the same view a little differently."""
        depth = rasters.save_tif(self.folder / "wide.tif", np.full((96, 170), 5.0))
        image = np.zeros((180, 320, 3))
        image[80:100, 140:180] = 255  # the middle
        result = self.result(Depth=depth, Image=rasters.save_image(self.folder / "wide.png", image))
        mesh = result.mesh()
        self.assertIn("image_proportions", result.figures())
        corners = mesh.v[mesh.f].reshape(-1, 3)
        uv = mesh.wedge[:, :, :2].reshape(-1, 2)
        np.testing.assert_allclose(uv[:, 0], (corners[:, 0] + 85) / 170, atol=1e-5)
        inside = abs(corners[:, 1]) < 40
        np.testing.assert_allclose(uv[inside, 1], 0.5 + corners[inside, 1] * (320 / 170) / 180, atol=1e-5)

    def test_orientation_tags(self):
        """A camera's own pair: the tag turns the image for the eye, and the depth has none."""
        from PIL import Image
        exif = Image.Exif()
        exif[0x0112] = 3
        image = rasters.save_image(self.folder / "held.jpg", rasters.picture(), quality=95, exif=exif)
        result = self.result(Image=image)
        self.assertIn("as it is stored", result.figures()["image_orientation"])
        texture = rasters.read(result.figures()["texture"])
        self.assertLess(abs(texture[:, :, :3].astype(int) - rasters.picture()).mean(), 4)

    def test_a_texture_file_of_ones_own(self):
        target = self.folder / "mine.png"
        result = self.result(Image=self.image, TextureFile=target)
        self.assertEqual(result.mesh().textures, [target.name if lib.TEXTURES_IN_MEMORY else str(target)])
        np.testing.assert_array_equal(rasters.read(target), rasters.picture())
        before = self.image.read_bytes()
        self.fails("would replace the input", Image=self.image, TextureFile=self.image)
        self.assertEqual(self.image.read_bytes(), before)

    def test_front_and_back_are_one_solid(self):
        back = rasters.save_tif(self.folder / "back.tif", self.back)
        for focal in (0, 90):
            result = self.result(BackDepth=back, Image=self.image, FocalLength=focal)
            mesh = result.mesh()
            self.assertManifold(mesh)
            self.assertOneComponent(mesh)
            self.assertManifold(lib.welded(mesh))
            if not focal:
                self.assertAlmostEqual(lib.volume(mesh) / (4 / 3 * np.pi * 25 ** 3), 0.96, delta=0.04)
            self.assertEqual(len(mesh.wedge), len(mesh.f))
            self.assertGreater(int(result.figures()["wall_faces"]), 0)

    def test_same_result_for_any_number_of_threads(self):
        back = rasters.save_tif(self.folder / "back.tif", self.back)
        found = set()
        for cores in (1, os.cpu_count()):
            result = run([], [template("depth_to_mesh", Depth=self.depth, BackDepth=back)], cores=cores)
            self.assertSucceeded(result)
            found.add((result.folder / "out.ply").read_bytes())
        self.assertEqual(len(found), 1)

    def test_a_layer_that_is_there_stays(self):
        import shapes
        ball = shapes.sphere()
        result = run([ball], [template("depth_to_mesh", Depth=self.depth)], {"before": 0, "out": 1})
        self.assertSucceeded(result)
        self.assertEqual(len(result.mesh("before").f), len(ball.f))
        self.assertGreater(len(result.mesh("out").f), 1000)

    def test_what_cannot_be_used_is_said(self):
        other = rasters.save_image(self.folder / "other.png", rasters.picture(60, 60))
        small = rasters.save_tif(self.folder / "small.tif", self.back[:-1])
        self.fails("no depth raster", Depth="")
        self.fails("does not exist", Depth="nowhere.tif")
        self.fails("8 bits", Depth=self.image.parent / rasters.save_image(self.folder / "g.png", np.full((9, 9), 7)))
        self.fails("Z channel", Depth=rasters.save_tif(self.folder / "zero.tif", np.zeros((9, 9))))
        self.fails("background everywhere", Depth=rasters.save_tif(self.folder / "n.tif", np.full((9, 9), np.nan)))
        self.fails("60 x 60", Image=other)
        self.fails("60 x 79", BackDepth=small)
        self.fails("DepthScale", DepthScale=0)
        self.fails("PixelSize", PixelSize=0)
        self.fails("FocalLength", FocalLength=-1)
        self.fails("MaxJump", MaxJump=1e-6)


if __name__ == "__main__":
    lib.main()
