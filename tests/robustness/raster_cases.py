# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of the table for filters that read images, depth rasters and databases."""
import struct

import numpy as np

import lib
import nasty
import rasters
import shapes
from lib import template

FINE, OK, SENTENCE = {"ok", "flawed", "untrusted", "sentence"}, {"ok"}, {"sentence"}


def depth_to_mesh(case, folder):
    front, back = rasters.sphere()
    plain = dict(Depth=rasters.save_tif(folder / "front.tif", front),
                 BackDepth=rasters.save_tif(folder / "back.tif", back),
                 Image=rasters.save_image(folder / "image.png", rasters.picture()))

    def row(name, allowed=FINE, closed=False, **values):
        values = dict(plain, **values)
        return case("depth_to_mesh", name, [], [template("depth_to_mesh", **values)], allowed, closed, "made")

    def depth(name, array, allowed=FINE, **values):
        file = rasters.save_tif(folder / (name.replace(" ", "_") + ".tif"), array)
        return row(name, allowed, Depth=file, **dict(dict(BackDepth="", Image=""), **values))

    def bytes_as(name, content, which="Depth", allowed=SENTENCE):
        file = folder / name.replace(" ", "_")
        file.write_bytes(content)
        return row(f"{which}: {name}", allowed, **{which: file})

    yield row("front, back and image", OK, True)
    tif, png = plain["Depth"].read_bytes(), plain["Image"].read_bytes()
    head = struct.pack(">IIBBBBB", 2000000000, 2000000000, 16, 6, 0, 0, 0)
    for which, ending, whole in (("Depth", ".tif", tif), ("BackDepth", ".tif", tif), ("Image", ".png", png)):
        yield row(f"{which}: a missing file", SENTENCE, **{which: folder / "nowhere.tif"})
        yield row(f"{which}: a folder", SENTENCE, **{which: folder})
        yield row(f"{which}: a device", SENTENCE, **{which: "/dev/zero"})
        yield bytes_as(f"empty{ending}", b"", which)
        yield bytes_as(f"words{ending}", b"this is no image", which)
        yield bytes_as(f"half{which}{ending}", whole[:len(whole) // 2], which, FINE)
        yield bytes_as(f"noise{which}{ending}", whole[:60] + bytes(range(256)) * 8, which, FINE)
        yield bytes_as("says that it is huge.png", png[:16] + head + png[29:], which)
    yield bytes_as("huge.pfm", b"Pf\n2000000000 2000000000\n-1\n")
    yield bytes_as("no size.pfm", b"Pf\nx y\n-1\n")
    yield bytes_as("a PFM that ends early.pfm", b"Pf\n60 80\n-1\n" + b"\0\0\x80\x3f" * 100, "Depth", FINE)
    yield row("the image as depth", SENTENCE, Depth=plain["Image"])
    yield row("the depth as image", SENTENCE, Image=plain["Depth"])
    yield row("one file for front and back", OK, BackDepth=plain["Depth"])
    yield row("back before front", OK, Depth=plain["BackDepth"], BackDepth=plain["Depth"])
    yield row("the texture over the depth", SENTENCE, TextureFile=plain["Depth"])
    yield row("the texture in a folder that is not there", SENTENCE, TextureFile=folder / "no" / "t.png")
    for size in ((1, 1), (1, 80), (60, 1), (2, 2), (3, 3)):
        yield depth(f"a raster of {size[0]} x {size[1]}", np.full(size[::-1], 5.0), Image=plain["Image"])
    yield depth("nothing but zeros", np.zeros((80, 60)), SENTENCE)
    yield depth("nothing but NaN", np.full((80, 60), np.nan), SENTENCE)
    yield depth("nothing but infinity", np.full((80, 60), np.inf), SENTENCE)
    one = np.full((80, 60), np.nan)
    one[40, 30] = 5
    yield depth("one pixel", one, SENTENCE)
    yield depth("a checkerboard", np.where(np.indices((80, 60)).sum(0) % 2, 5.0, np.nan), SENTENCE)
    random = np.random.default_rng(1)
    yield depth("noise", random.uniform(1, 1000, (80, 60)))
    yield depth("noise with holes", np.where(random.uniform(size=(80, 60)) < 0.5, random.uniform(9, 11, (80, 60)), 0))
    yield depth("depths of 1e30", np.full((80, 60), 1e30))
    yield depth("depths of 1e-30", np.full((80, 60), 1e-30))
    yield depth("a few depths of 1e30", np.where(np.arange(60) % 20 == 0, 1e30, front))
    yield depth("negative depths", -front, OK)
    yield depth("negative depths, pinhole", -front, SENTENCE, FocalLength=80)
    yield depth("twelve million pixels", np.full((3000, 4000), 7.0), FINE)._replace(memory=3 << 30)
    for name, values in (("DepthScale 0", dict(DepthScale=0)), ("DepthScale NaN", dict(DepthScale="nan")),
                         ("PixelSize 0", dict(PixelSize=0)), ("PixelSize -1", dict(PixelSize=-1)),
                         ("PixelSize NaN", dict(PixelSize="nan")), ("FocalLength -5", dict(FocalLength=-5)),
                         ("FocalLength inf", dict(FocalLength="inf")), ("MaxJump -1", dict(MaxJump=-1)),
                         ("MaxJump NaN", dict(MaxJump="nan"))):
        yield row(name, SENTENCE, **values)
    yield row("DepthScale 1e9", FINE, DepthScale=1e9)
    yield row("DepthScale 1e-9", FINE, DepthScale=1e-9)
    yield row("DepthScale -1", OK, DepthScale=-1)
    yield row("PixelSize 1e9", FINE, PixelSize=1e9)
    yield row("PixelSize 1e-9", FINE, PixelSize=1e-9)
    yield row("FocalLength 1e-6", FINE, FocalLength=1e-6)
    yield row("MaxJump 1e-6", SENTENCE, MaxJump=1e-6, BackDepth="")


def build_mappings(case, folder):
    models = folder / "models"
    models.mkdir()
    for i in range(2):
        shapes.write_ply(models / f"m{i}.ply", shapes.sphere().scaled(1 + i / 10))
    number = [0]

    def row(name, allowed=FINE, **values):
        number[0] += 1
        values = dict(dict(Models=models, Output=folder / f"out{number[0]}.mlp", Width=40, Height=50), **values)
        return case("build_mappings", name, [], [template("build_mappings", **values)], allowed, False, "database")

    def of(name, mesh, allowed=FINE):
        where = folder / name.replace(" ", "_")
        where.mkdir()
        shapes.write_ply(where / "m.ply", mesh)
        return row(f"a model: {name}", allowed, Models=where)

    def project(name, text, allowed=SENTENCE):
        file = folder / (name.replace(" ", "_") + ".mlp")
        file.write_text(text)
        return row(f"a project: {name}", allowed, Models=file)

    yield row("two models", OK)
    for damage in nasty.DAMAGES:
        fine = damage.__name__ in ("loose_vertices", "holes", "duplicate_vertices", "several_components", "inside_out")
        yield of(damage.__name__.replace("_", " "), damage(shapes.sphere()), OK if fine else FINE)
    for size in (1e-30, 1e-6, 1e6, 1e18, 1e30):
        yield of(f"size {size:g}", shapes.sphere().scaled(size), OK if 1e-6 <= size <= 1e6 else FINE)
    flat = shapes.sphere()
    flat.v = flat.v * [1, 1, 0]
    yield of("flat as a disc", flat, OK)
    flat = shapes.sphere()
    flat.v = flat.v * [0, 1, 1]
    yield of("flat and seen edge on", flat)
    empty = folder / "an_empty_folder"
    empty.mkdir()
    yield row("an empty folder", SENTENCE, Models=empty)
    yield row("a folder that is not there", SENTENCE, Models=folder / "nowhere")
    yield row("a mesh file, for its folder", OK, Models=models / "m0.ply")
    yield project("empty", "")
    yield project("words", "these are words")
    yield project("cut", '<!DOCTYPE MeshLabDocument><MeshLabProject><MeshGroup><MLMesh filename="models/m0.ply"')
    yield project("no meshes", "<MeshLabProject/>")
    yield project("a mesh that is missing", '<MeshLabProject><MeshGroup><MLMesh filename="x.ply"/></MeshGroup>'
                  "</MeshLabProject>")
    for name, values in (("a view that is none", dict(Views="0,0; here")), ("no view", dict(Views=" ;")),
                         ("a view of three angles", dict(Views="1,2,3")), ("Up is zero", dict(Up=(0, 0, 0))),
                         ("Up is Front", dict(Up=(0, 0, 1))), ("Width 0", dict(Width=0)),
                         ("Width 2000000000", dict(Width=2000000000)), ("Ambient NaN", dict(Ambient="nan")),
                         ("Ambient 2", dict(Ambient=2)), ("no output", dict(Output="")),
                         ("an output without ending", dict(Output=folder / "out")),
                         ("an output in a folder that is not there", dict(Output="/proc/no/out.mlp"))):
        yield row(name, SENTENCE, **values)
    yield row("Light is zero", FINE, Light=(0, 0, 0))
    yield row("angles of 1e6 degrees", FINE, Views="1000000,-1000000")
    yield row("images of 8 x 8192", FINE, Width=8, Height=8192)
    yield row("a thousand views", OK, Views=";".join(f"{i % 360},{i // 36}" for i in range(1000)), Width=8, Height=8)


def all_cases(case):
    for part in (depth_to_mesh, build_mappings):
        yield from part(case, lib.work_folder())
