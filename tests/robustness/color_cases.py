# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of the table for filters that find colours."""
import copy
import itertools

import numpy as np

import lib
import nasty
import rasters
import shapes
from lib import template

FINE, OK, SENTENCE = {"ok", "flawed", "untrusted", "sentence"}, {"ok", "untrusted"}, {"sentence"}


def colorize_depth(case, folder):
    models = folder / "examples"
    models.mkdir()
    for i in range(3):
        shapes.write_ply(models / f"m{i}.ply", shapes.sphere().scaled(1 + i / 10))
    front, _ = rasters.sphere()
    plain = dict(Depth=rasters.save_tif(folder / "query.tif", front), Database=models / "m0.ply", PatchSizes="5")
    number = itertools.count()

    def row(name, allowed=FINE, **values):
        values = dict(dict(ImageFile=folder / f"colors{next(number)}.png"), **values)  # rows run side by side
        return case("colorize_depth", name, [], [template("colorize_depth", **dict(plain, **values))], allowed, False,
                    "made")

    def depth(name, array, allowed=FINE):
        return row(name, allowed, Depth=rasters.save_tif(folder / (name.replace(" ", "_") + ".tif"), array))

    yield row("models without colours", OK)
    yield row("one level of each size", OK, PatchSizes="3,5,7,9")
    yield row("more examples than there are", OK, Examples=1000)
    yield row("all weights 0", FINE, WeightDepth=0, WeightHighFrequency=0, WeightY=0, WeightCb=0, WeightCr=0,
              WeightPosition=0)
    for name, values in (("an even patch", dict(PatchSizes="4")), ("a patch larger than the image", dict(PatchSizes="99")),
                         ("patches that are none", dict(PatchSizes="5;x")), ("no patch", dict(PatchSizes="")),
                         ("no example of that name", dict(Choose="nobody")), ("Examples 0", dict(Examples=0)),
                         ("Weight NaN", dict(WeightY="nan")), ("a negative weight", dict(WeightY=-1)),
                         ("no depth", dict(Depth="")), ("no database", dict(Database="")),
                         ("a database that is not there", dict(Database=folder / "nowhere.mlp")),
                         ("the depth as database", dict(Database=plain["Depth"])),
                         ("the image over the depth", dict(ImageFile=plain["Depth"])),
                         ("the image in a folder that is not there", dict(ImageFile=folder / "no" / "c.png")),
                         ("nothing asked for", dict(ImageFile="", AddMesh=False))):
        yield row(name, SENTENCE, **values)
    yield depth("colors of nothing", np.zeros((80, 60)), SENTENCE)
    yield depth("colors of one pixel", np.eye(1), SENTENCE)
    yield depth("colors of a plane", np.full((80, 60), 5.0))
    yield depth("colors of a line", np.where(np.arange(60)[None, :] == 30, 5.0, np.zeros((80, 1))))
    yield depth("colors of noise", np.random.default_rng(1).random((80, 60)) + 1)


def painted(mesh):
    """Vertex colours by position."""
    low, high = mesh.v.min(axis=0), mesh.v.max(axis=0)
    rgb = 255 * (mesh.v - low) / (high - low)
    mesh.color = np.concatenate([rgb, np.full((len(rgb), 1), 255)], 1).astype(np.uint8)
    return mesh


def egg(stretch=1.0):
    m = shapes.sphere(level=3)
    m.v = m.v * (0.8, 1.1 * stretch, 1)
    return m


def unfolded(mesh, scale=1.0, textures=1):
    """Seen from the front: what is behind lies on it."""
    mesh.wedge = (scale * (mesh.v[mesh.f][:, :, :2] / 4 + 0.5)).astype(np.float32)
    mesh.textures = [f"missing{i}.png" for i in range(textures)]
    mesh.texnumber = np.arange(len(mesh.f)) % textures
    return mesh


def colorize_mesh(case, folder):
    for name in ("eggs", "grey", "empty", "broken"):
        (folder / name).mkdir()
    for i in range(3):
        shapes.write_ply(folder / "eggs" / f"egg{i}.ply", painted(egg(1 + i / 10)))
    shapes.write_ply(folder / "grey" / "grey.ply", egg())
    (folder / "broken" / "broken.ply").write_bytes(b"ply\nformat ascii 1.0\nelement vertex 3\n")
    plain = dict(Database=folder / "eggs", PatchSizes="5", Width=40, Height=50, TextureSize=128)
    number = itertools.count()

    def row(name, mesh=None, allowed=FINE, **values):
        values = dict(dict(TextureFile=folder / f"texture{next(number)}.png"), **values)
        return case("colorize_mesh", name, [mesh or egg(1.05)],
                    [template("colorize_mesh", **dict(plain, **values))], allowed, False, "made")

    yield row("a texture", allowed=OK)
    yield row("vertex colours", allowed=OK, Target="Vertex colour")
    yield row("one view", allowed=OK, Views="0,0")
    yield row("one example, a seed", allowed=OK, Examples=1, Seed=7)
    yield row("more examples than there are", allowed=OK, Examples=1000)
    yield row("a texture of 16 texels", TextureSize=16)
    yield row("views of 8 pixels", PatchSizes="3", Width=8, Height=8)
    yield row("all weights 0", WeightDepth=0, WeightHighFrequency=0, WeightY=0, WeightCb=0, WeightCr=0,
              WeightPosition=0)
    yield row("models from another side", Up=(0, 0, 1), Front=(1, 0, 0))
    for name, values in (("an even patch", dict(PatchSizes="4")), ("no patch", dict(PatchSizes="")),
                         ("no database", dict(Database="")), ("a database that is not there", dict(Database=folder / "no")),
                         ("a database without colours", dict(Database=folder / "grey")),
                         ("an empty database", dict(Database=folder / "empty")),
                         ("a broken database", dict(Database=folder / "broken")),
                         ("no view", dict(Views="")), ("views that are none", dict(Views="left; right")),
                         ("Up and Front alike", dict(Up=(0, 0, 1))), ("Up NaN", dict(Up=(float("nan"), 0, 1))),
                         ("no example of that name", dict(Choose="nobody")), ("Examples 0", dict(Examples=0)),
                         ("Width 0", dict(Width=0)), ("TextureSize 0", dict(TextureSize=0)),
                         ("Weight NaN", dict(WeightY="nan")), ("target number 5", dict(Target=5)),
                         ("the texture over a model", dict(TextureFile=folder / "eggs" / "egg0.ply")),
                         ("a texture of unknown format", dict(TextureFile=folder / "texture.xyz")),
                         ("a texture in a folder that is not there", dict(TextureFile=folder / "no" / "t.png"))):
        yield row(name, allowed=SENTENCE, **values)
    yield row("kept colours, nothing selected", painted(egg()), SENTENCE, Keep="Selected faces")
    yield row("kept colours of a grey mesh", egg().select_faces(lambda c: c[:, 2] > 0), SENTENCE, Keep="Selected faces")
    yield row("kept colours", painted(egg(1.05)).select_faces(lambda c: c[:, 2] > 0), OK, Keep="Selected faces")
    yield row("all colours kept", painted(egg(1.05)).select_faces(lambda c: c[:, 2] > -9), OK, Keep="Selected faces")
    yield row("a huge texture in 1 GB", allowed=SENTENCE, TextureSize=16384)._replace(memory=1 << 30)
    for factor in (1e6, 1e-6, 1e30, 1e-30):
        yield row(f"size {factor:g}", egg(1.05).scaled(factor))
    yield row("far away", egg(1.05).moved((1e4, 1e4, 1e4)))
    yield row("texture coordinates that overlap", unfolded(egg()), OK)
    yield row("texture coordinates beyond the texture", unfolded(egg(), 5), OK)
    yield row("texture coordinates that are not finite", unfolded(egg(), float("nan")), OK)
    yield row("several textures that are missing", unfolded(egg(), 1, 3), OK)
    yield row("a flat sheet", shapes.grid())
    yield row("another class", shapes.torus())
    for damage in nasty.DAMAGES:
        name = damage.__name__.replace("_", " ")
        yield row(f"mesh: {name}", damage(copy.deepcopy(egg(1.05))))
        yield row(f"mesh: {name}, vertex colours", damage(copy.deepcopy(egg(1.05))), Target="Vertex colour")


def all_cases(case):
    for part in (colorize_depth, colorize_mesh):
        yield from part(case, lib.work_folder())
