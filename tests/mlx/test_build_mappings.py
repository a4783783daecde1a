# SPDX-License-Identifier: GPL-3.0-or-later
"""Build Mapping Database through meshlabserver: what is stored, and that MeshLab opens it."""
import json
import os
import xml.etree.ElementTree as xml

import numpy as np

import lib
import rasters
import shapes
from lib import run, template


def models(folder):
    """Three painted eggs of about one size; the last one in millimetres."""
    folder.mkdir()
    for i in range(3):
        m = shapes.sphere(level=4).painted(200 - 60 * i, 60 * i, 90)
        m.v = m.v * [1, 1.3 + 0.1 * i, 0.8] * (1.2 + 0.2 * m.v[:, 1:2])
        shapes.write_ply(folder / f"thing_{i}.ply", m.scaled(1000 if i == 2 else 1))
    return folder


class BuildMappings(lib.MeshCase):
    def setUp(self):
        self.folder = lib.work_folder()
        self.models = models(self.folder / "models")
        self.output = self.folder / "things.mlp"

    def step(self, **values):
        return template("build_mappings", **dict(dict(Models=self.models, Output=self.output, Width=60, Height=80,
                                                      Views="0,0; 40,-10"), **values))

    def built(self, **values):
        result = run([], [self.step(**values)], {})
        self.assertSucceeded(result)
        return result

    def fails(self, *words, **values):
        self.assertFailed(run([], [self.step(**values)], {}), *words)

    def planes(self, raster):
        """Images by semantic; files are beside the project, none is absolute."""
        files = {int(p.get("semantic")): p.get("fileName") for p in raster.iter("Plane")}
        self.assertFalse(any(name.startswith("/") for name in files.values()))
        return {semantic: rasters.read(self.folder / name) for semantic, name in files.items()}

    def test_what_is_stored(self):
        result = self.built()
        figures = result.figures()
        self.assertEqual((figures["objects"], figures["views"], figures["examples"]), ("3", "2", "6"))
        root = xml.parse(self.output).getroot()
        found = list(root.iter("MLRaster"))
        self.assertEqual([r.get("label") for r in found][:3],
                         ["thing_0.ply 0,0", "thing_0.ply 40,-10", "thing_1.ply 0,0"])
        areas = []
        for raster in found:
            planes = self.planes(raster)
            self.assertEqual(list(planes), [1, 2, 8, 256])
            colour, mask, depth, back = planes[1], planes[2], planes[8], planes[256]
            self.assertEqual(colour.shape, (80, 60, 4))
            seen = np.isfinite(depth)
            np.testing.assert_array_equal(mask, np.where(seen, 255, 0))
            np.testing.assert_array_equal(colour[..., 3], mask)
            np.testing.assert_array_equal(np.isfinite(back), seen)
            self.assertTrue((back[seen] >= depth[seen]).all())
            self.assertFalse(seen[0].any() or seen[-1].any() or seen[:, 0].any() or seen[:, -1].any(), "cut off")
            areas.append(seen.sum())
        self.assertLess(max(areas), 1.6 * min(areas), "framed alike")
        preset = json.loads((self.folder / "things.class.json").read_text())
        self.assertEqual(preset["Up"], [0, 1, 0])

    def test_cameras_see_the_models(self):
        """A depth through its camera is on the model; vcglib's conventions."""
        self.built()
        for number, raster in enumerate(xml.parse(self.output).getroot().iter("MLRaster")):
            camera = {k: np.array(v.split(), float) for k, v in raster.find("VCGCamera").attrib.items()}
            depth = self.planes(raster)[8]
            y, x = np.nonzero(np.isfinite(depth))
            local = (np.stack([x + 0.5, 80 - (y + 0.5)], 1) - camera["CenterPx"]) * camera["PixelSizeMm"]
            turn = camera["RotationMatrix"].reshape(4, 4)[:3, :3]
            points = np.column_stack([local, -depth[y, x]]) @ turn - camera["TranslationVector"][:3]
            model = shapes.read_ply(self.models / f"thing_{number // 2}.ply")
            size = np.ptp(model.v, axis=0).max()
            nearest = np.array([np.linalg.norm(model.v - p, axis=1).min() for p in points[::97]])
            self.assertLess(nearest.max(), 0.05 * size)

    def test_meshlab_opens_it(self):
        self.built()
        result = run([], [], {"surface": 0}, project=self.output, save_project=True)
        self.assertSucceeded(result)
        saved = list(xml.parse(result.folder / "out.mlp").getroot().iter("MLRaster"))
        self.assertEqual(len(saved), 6)
        self.assertGreater(len(result.mesh("surface").f), 1000)
        original = list(xml.parse(self.output).getroot().iter("MLRaster"))
        for a, b in zip(saved, original):
            self.assertEqual(a.get("label"), b.get("label"))
            self.assertTrue(a.find("Plane").get("fileName").endswith(b.find("Plane").get("fileName")))
            for key in ("RotationMatrix", "TranslationVector", "PixelSizeMm", "CenterPx"):
                np.testing.assert_allclose(np.array(a.find("VCGCamera").get(key).split(), float),
                                           np.array(b.find("VCGCamera").get(key).split(), float), rtol=1e-4, atol=1e-4)

    def test_a_stored_example_becomes_a_mesh(self):
        self.built(Views="20,10")
        depth = next(self.folder.glob("things_mappings/000*_depth.tif"))
        result = run([], [template("depth_to_mesh", Depth=depth, BackDepth=str(depth).replace("_depth", "_back"),
                                   Image=str(depth).replace("_depth.tif", ".png"), PixelSize=0.03)])
        self.assertSucceeded(result)
        self.assertManifold(result.mesh())

    def test_without_back_side(self):
        self.built(BackSide=False)
        for raster in xml.parse(self.output).getroot().iter("MLRaster"):
            self.assertEqual(list(self.planes(raster)), [1, 2, 8])

    def test_a_project_of_models(self):
        """With matrices: the same as models in place."""
        turn = np.eye(4)
        turn[:3, :3] = shapes.rotation((0, 1, 0), 30)
        lib.write_project(self.folder / "models.mlp", [(f"models/thing_{i}.ply", turn) for i in range(3)])
        self.built(Models=self.folder / "models.mlp", Views="30,0", Output=self.folder / "turned.mlp")
        self.built(Views="0,0")
        turned = sorted(self.folder.glob("turned_mappings/*_depth.tif"))
        for a, b in zip(turned, sorted(self.folder.glob("things_mappings/*_depth.tif"))):
            a, b = rasters.read(a), rasters.read(b)
            both = np.isfinite(a) & np.isfinite(b)
            self.assertGreater(both.sum(), 0.97 * np.isfinite(a).sum())
            self.assertLess(np.median(abs(a - b)[both]) / np.ptp(b[both]), 0.01)

    def test_the_preset_of_the_class_goes_along(self):
        (self.models / "class.json").write_text('{ "Up": [0, 0, 1], "Front": [0, -1, 0], '
                                                '"reconstruct_depth": { "PatchSizes": "5,7", "WeightPosition": 9.5 } }')
        self.built()
        preset = json.loads((self.folder / "things.class.json").read_text())
        self.assertEqual((preset["Up"], preset["Front"]), ([0, 0, 1], [0, -1, 0]))
        self.assertEqual(preset["reconstruct_depth"], {"PatchSizes": "5,7", "WeightPosition": 9.5})

    def test_same_result_for_any_number_of_threads(self):
        found = set()
        for cores in (1, os.cpu_count()):
            result = run([], [self.step()], {}, cores=cores)
            self.assertSucceeded(result)
            files = sorted(self.folder.glob("things*/*")) + [self.output]
            found.add(b"".join(p.read_bytes() for p in files))
        self.assertEqual(len(found), 1)

    def test_what_cannot_be_used_is_said(self):
        before = sorted(p.name for p in self.folder.iterdir())
        self.fails("no model database", Models="")
        self.fails("does not exist", Models=self.folder / "nowhere")
        self.fails("no output", Output="")
        self.fails(".mlp", Output=self.folder / "things.txt")
        self.fails("yaw,pitch", Views="front")
        self.fails("no view", Views="")
        self.fails("Up and Front", Up=(0, 0, 1))
        self.fails("Width", Width=0)
        self.fails("Ambient", Ambient=2)
        (self.models / "class.json").write_text("{ broken")
        self.fails("JSON")
        (self.models / "class.json").unlink()
        lib.write_project(self.folder / "models.mlp", [("models/thing_0.ply", np.eye(4))])
        whole = (self.folder / "models.mlp").read_bytes()
        self.fails("is the model database", Models=self.folder / "models.mlp", Output=self.folder / "models.mlp")
        self.fails("another name", Output=self.folder / "models.mlp")
        self.assertEqual((self.folder / "models.mlp").read_bytes(), whole)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), sorted(before + ["models.mlp"]))

    def test_models_that_cannot_be_read_are_left_out(self):
        (self.models / "broken.obj").write_text("no mesh")
        result = self.built()
        self.assertEqual(result.figures()["objects"], "3")
        self.assertIn("skipped: broken.obj", result.text)


if __name__ == "__main__":
    lib.main()
