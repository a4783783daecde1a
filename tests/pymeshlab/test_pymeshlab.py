#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The plugins in PyMeshLab: composing, filling and colouring on a MeshSet.

./run pymeshlab runs it by the Python of a fresh virtual environment. PYTHONPATH
has the folder of the built plugins, TOOLS is that of make_busts.
"""
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np
import shapes_from_parts  # noqa: F401, before pymeshlab
import pymeshlab

TOOLS = pathlib.Path(os.environ["TOOLS"])


def open_edges(mesh):
    faces = mesh.face_matrix()
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return int((np.unique(edges, axis=0, return_counts=True)[1] == 1).sum())


class PyMeshLab(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        subprocess.run([TOOLS / "make_busts", cls.folder, "4", "--hole", cls.folder / "hole.ply"], check=True,
                       stdout=subprocess.DEVNULL)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_compose(self):
        """Two balls, of which the far sides are kept, become one closed surface; the figures come back."""
        meshes = pymeshlab.MeshSet()
        meshes.create_sphere(radius=1, subdiv=4)
        meshes.create_sphere(radius=1, subdiv=4)
        meshes.apply_filter("compute_matrix_from_translation", axisx=1.2, freeze=True)
        meshes.set_current_mesh(0)
        figures = meshes.apply_filter("min_cut_compose_two_meshes", mesha=0, meshb=1,
                                      keepa="Box", keepamin=[-2, -2, -2], keepamax=[-0.3, 2, 2],
                                      keepb="Box", keepbmin=[1.5, -2, -2], keepbmax=[3, 2, 2])
        result = meshes.current_mesh()
        self.assertEqual(meshes.mesh_number(), 3)
        self.assertEqual(open_edges(result), 0)
        self.assertEqual(figures["result_pieces"], 1)
        self.assertEqual(figures["result_crossings"], 0)
        vertices = result.vertex_matrix()
        np.testing.assert_allclose([vertices[:, 0].min(), vertices[:, 0].max()], [-1, 2.2], atol=0.01)
        # Double precision: what is kept is what was given, to the last bit.
        kept = meshes.mesh(0).vertex_matrix()
        kept = kept[kept[:, 0] < -0.5]
        self.assertTrue({tuple(v) for v in kept} <= {tuple(v) for v in vertices})

    def test_fill(self):
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(str(self.folder / "hole.ply"))
        self.assertGreater(open_edges(meshes.current_mesh()), 0)
        figures = meshes.apply_filter("database_fill_hole", database=str(self.folder / "busts.mlp"))
        self.assertEqual(open_edges(meshes.current_mesh()), 0)
        self.assertEqual(figures["mended"], 1)

    def test_color(self):
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(str(self.folder / "bust_00.ply"))
        texture = self.folder / "painted.png"
        meshes.apply_filter("examples_colorize_mesh", database=str(self.folder / "busts.mlp"), texturefile=str(texture),
                            texturesize=256)
        self.assertTrue(texture.exists())
        self.assertTrue(meshes.current_mesh().has_wedge_tex_coord())
        (self.folder / "saved").mkdir()
        meshes.save_current_mesh(str(self.folder / "saved" / "painted.obj"))
        self.assertTrue((self.folder / "saved" / "painted.png").exists(), "the texture goes with the mesh")

    def test_what_is_wrong_is_said(self):
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(str(self.folder / "hole.ply"))
        with self.assertRaisesRegex(pymeshlab.PyMeshLabException, "No model database is given"):
            meshes.apply_filter("database_fill_hole")
        self.assertEqual(meshes.mesh_number(), 1)


if __name__ == "__main__":
    unittest.main(verbosity=2)
