# SPDX-License-Identifier: GPL-3.0-or-later
"""A database of busts and damaged ones, for the tests of what needs one."""
import os
import pathlib
import re
import subprocess

import numpy as np

import lib
import shapes

TOOL = pathlib.Path(os.environ.get("BINARY_DIR", lib.ROOT / "build")) / "tools" / "make_busts"
MEND = dict(Candidates=3)


class Busts:
    """Four busts, and one more with a nose hole, without its crown, with scars, and whole."""

    def __init__(self):
        self.folder = lib.work_folder()
        self.database = self.folder / "busts"
        out = subprocess.run([TOOL, self.database, "4", "--cells", "40", "--hole", self.folder / "hole.ply",
                              "--crown-hole", self.folder / "crown.ply", "--scar", self.folder / "scar.ply",
                              "--whole", self.folder / "whole.ply"], check=True, capture_output=True, text=True)
        self.boxes = {}
        for name, numbers in re.findall(r"^(\w+): (.*)$", out.stdout, re.M):
            values = [float(x) for x in numbers.split()]
            self.boxes[name] = (values[:3], values[3:])

    def mesh(self, name):
        return shapes.read_ply(self.folder / f"{name}.ply")

    def file(self, name):
        return self.folder / f"{name}.ply"

    def region(self, name):
        return dict(Region="Box", RegionMin=self.boxes[name][0], RegionMax=self.boxes[name][1])


def inside(vertices, region):
    low, high = region
    return ((vertices > low) & (vertices < high)).all(axis=1)


def nearest(points, vertices):
    return np.sqrt(((points[:, None] - vertices[None]) ** 2).sum(axis=2).min(axis=1))
