# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of the table for the filter that reconstructs depth from an image."""
import shutil
import struct

import numpy as np
from PIL import Image

import lib
import rasters
import shapes
from lib import template

# Of so few examples a result may be said to be not trusted.
FINE, OK, SENTENCE = {"ok", "flawed", "untrusted", "sentence"}, {"ok", "untrusted"}, {"sentence"}
WIDTH, HEIGHT = 60, 80


def models(folder, count=5):
    """Painted eggs of one class; the last one is no member of the database."""
    (folder / "models").mkdir()
    for k in range(count):
        m = shapes.sphere(level=4).painted(230, 200, 170)
        m.v = m.v * [1, 1.2 + 0.05 * k, 0.8] * (1.1 + 0.05 * k * m.v[:, 1])[:, None]
        shapes.write_ply(folder / "models" / f"egg_{k}.ply", m)
    return folder / "models"


def egg_image():
    """What a camera may see of such an egg, and where it is."""
    x, y = rasters.grid(WIDTH, HEIGHT)
    with np.errstate(invalid="ignore"):
        z = np.sqrt(1 - (x / 24) ** 2 - (y / 31) ** 2)
    light = np.nan_to_num(0.35 + 0.65 * np.clip(0.3 * x / 24 + 0.4 * y / 31 + 0.85 * z, 0, 1))
    return np.where(np.isfinite(z)[..., None], light[..., None] * [230, 200, 170], 0), np.isfinite(z)


def mapping_database(folder, name, size=(WIDTH, HEIGHT), depth=None, count=3, skip=()):
    """Written by hand, as users may: spheres, or rasters of the depth given."""
    where = folder / name
    where.mkdir()
    rows = []
    for k in range(count):
        width, height = size[k % len(size)] if isinstance(size, list) else size
        front, _ = rasters.sphere(width, height, 20 + 2 * k)
        grey = np.nan_to_num(80 + 2 * (100 - front)).clip(0, 255)
        seen = np.where(np.isfinite(front), 255, 0)
        files = {1: rasters.save_image(where / f"{k}.png", np.stack([grey, grey, grey, seen], -1)),
                 8: rasters.save_tif(where / f"{k}.tif", front if depth is None else np.full_like(front, depth))}
        planes = "".join(f'<Plane semantic="{s}" fileName="{name}/{f.name}"/>' for s, f in files.items()
                         if (k, s) not in skip)
        for key in skip:
            if key == (k, "missing"):
                files[8].unlink()
        rows.append(f'<MLRaster label="ball {k}"><VCGCamera CameraType="1" FocalMm="10" PixelSizeMm="1 1" '
                    f'CenterPx="{width // 2} {height // 2}" ViewportPx="{width} {height}" TranslationVector="0 0 -100 1" '
                    f'LensDistortion="0 0" RotationMatrix="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 "/>{planes}</MLRaster>')
    file = folder / f"{name}.mlp"
    file.write_text("<!DOCTYPE MeshLabDocument>\n<MeshLabProject><MeshGroup/><RasterGroup>" + "".join(rows) +
                    "</RasterGroup></MeshLabProject>\n")
    return file


def images(row, folder, color, seen):
    def image(name, pixels, allowed=FINE, result="made", **values):
        file = rasters.save_image(folder / (name.replace(" ", "_") + ".png"), pixels)
        return row(f"Image: {name}", allowed, result, Image=file, **values)

    def bytes_as(which, name, content, allowed=SENTENCE):
        file = folder / name.replace(" ", "_")
        file.write_bytes(content)
        return row(f"{which}: {name}", allowed, **{which: file})

    plain = rasters.save_image(folder / "plain.png", color)
    png = plain.read_bytes()
    head = struct.pack(">IIBBBBB", 2000000000, 2000000000, 16, 6, 0, 0, 0)
    for which in ("Image", "Mask"):
        yield row(f"{which}: a missing file", SENTENCE, **{which: folder / "nowhere.png"})
        yield row(f"{which}: a folder", SENTENCE, **{which: folder})
        yield bytes_as(which, "empty.png", b"")
        yield bytes_as(which, "words.png", b"this is no image")
        yield bytes_as(which, "says that it is huge.png", png[:16] + head + png[29:])
    yield row("Image: none, and no raster layer", SENTENCE, Image="")
    yield bytes_as("Image", "cut.png", png[:len(png) // 2], FINE)
    yield image("grey, one channel", color.mean(axis=2), OK)
    yield image("grey and alpha", np.stack([color.mean(axis=2), 255 * seen], -1), OK, Mask="")
    deep = folder / "deep.png"
    Image.fromarray((color.mean(axis=2) * 257).astype(np.uint16)).save(deep)
    yield row("Image: 16 bits", OK, Image=deep)
    yield image("all alpha", np.dstack([color, np.zeros(seen.shape)]), SENTENCE, Mask="")
    yield image("one colour, no mask", np.full(color.shape, 128), SENTENCE, Mask="")
    yield image("one colour, masked", np.full(color.shape, 128), FINE)
    yield image("of 1 x 1", color[:1, :1], SENTENCE, Mask="")
    yield image("of 15 x 200", np.full((200, 15, 3), 99), SENTENCE, Mask="")
    yield image("of 2000 x 20", np.full((20, 2000, 3), 99), FINE, Mask="", Segment=True)
    large = rasters.save_image(folder / "large.png", np.kron(color, np.ones((30, 30, 1))))
    yield row("Image: of 1800 x 2400", OK, Image=large,
              Mask=rasters.save_image(folder / "large_mask.png", np.kron(255 * seen, np.ones((30, 30)))))
    noise = np.random.default_rng(1).integers(0, 255, (HEIGHT, WIDTH, 3))
    yield image("noise", noise, {"untrusted"}, "untrusted", Mask=rasters.save_image(folder / "box.png", box(5, 5, 50, 70)))
    yield image("noise, no mask, segmented", noise, FINE, Mask="", Segment=True)
    yield row("Image: the database", SENTENCE, Image=folder / "models" / "egg_0.ply")
    yield row("Mask: of another size", SENTENCE, Mask=rasters.save_image(folder / "m.png", np.full((20, 20), 255)))
    yield row("Mask: empty", SENTENCE, Mask=rasters.save_image(folder / "black.png", np.zeros(seen.shape)))
    yield row("Mask: one pixel", SENTENCE, Mask=rasters.save_image(folder / "dot.png", box(30, 40, 1, 1)))
    yield row("Mask: a line", FINE, Mask=rasters.save_image(folder / "line.png", box(30, 2, 1, 76)))
    yield row("Mask: all", FINE, Mask=rasters.save_image(folder / "white.png", np.full(seen.shape, 255)))
    yield row("Mask: specks", FINE, Mask=rasters.save_image(
        folder / "specks.png", np.where(np.indices(seen.shape).sum(0) % 7 == 0, 255, 0)))
    yield row("Mask: a colour image", FINE, Mask=plain)


def box(x, y, width, height):
    mask = np.zeros((HEIGHT, WIDTH))
    mask[y:y + height, x:x + width] = 255
    return mask


def databases(row, folder):
    def base(name, allowed=SENTENCE, **values):
        file = mapping_database(folder, name.replace(" ", "_"), **values)
        return row(f"Database: {name}", allowed, Database=file, BackSide=False)

    def text(name, content):
        file = folder / (name.replace(" ", "_") + ".mlp")
        file.write_text(content)
        return row(f"Database: {name}", SENTENCE, Database=file)

    yield base("stored", OK)
    yield base("a depth file is missing", skip={(1, "missing")})
    yield base("rasters without depth", skip={(0, 8), (1, 8), (2, 8)})
    yield base("one raster without depth", FINE, skip={(0, 8)})
    yield base("mixed sizes", size=[(WIDTH, HEIGHT), (40, 50)])
    yield base("all background", depth=np.nan)
    yield base("all zero", depth=0)
    yield base("one example", OK, count=1)
    yield base("of 9 x 9 pixels", FINE, size=(9, 9))
    yield row("Database: none named", SENTENCE, Database="")
    yield row("Database: not there", SENTENCE, Database=folder / "nowhere.mlp")
    yield row("Database: an image", SENTENCE, Database=folder / "plain.png")
    yield text("empty", "")
    yield text("no rasters", "<MeshLabProject><MeshGroup/><RasterGroup/></MeshLabProject>")
    yield row("Database: stored, without back depth", SENTENCE,
              Database=mapping_database(folder, "no_backs"), BackSide=True)
    broken = folder / "broken_preset"
    shutil.copytree(folder / "models", broken)
    (broken / "class.json").write_text('{ "reconstruct_depth": { "PatchSizes": ')
    yield row("Database: a preset that is cut off", SENTENCE, Database=broken / "egg_0.ply")
    odd = folder / "odd_preset"
    shutil.copytree(folder / "models", odd)
    (odd / "class.json").write_text('{ "reconstruct_depth": { "PatchSizes": "4", "WeightDepth": -3 } }')
    yield row("Database: a preset of values that are none", SENTENCE, Database=odd / "egg_0.ply")


def values_and_files(row, folder):
    for name, values in (("an even patch", dict(PatchSizes="5,6")), ("a patch of 1", dict(PatchSizes="1")),
                         ("a patch larger than the image", dict(PatchSizes="31,31,31")),
                         ("a patch of 99", dict(PatchSizes="99")), ("patches that are words", dict(PatchSizes="5;x")),
                         ("no patch size", dict(PatchSizes="")), ("Examples 0", dict(Examples=0)),
                         ("MaxIterations 0", dict(MaxIterations=0)), ("a negative weight", dict(WeightDepth=-1)),
                         ("a weight that is NaN", dict(WeightPosition="nan")),
                         ("views that are words", dict(Views="here")), ("no view", dict(Views=""))):
        yield row(name, SENTENCE, **values)
    yield row("all weights 0", FINE, WeightIntensity=0, WeightHighFrequency=0, WeightDepth=0, WeightPosition=0)
    yield row("weights of 1e6", FINE, WeightIntensity=1e6, WeightDepth=1e6, WeightPosition=1e6)
    yield row("more examples than there are", OK, Examples=1000)
    yield row("a view from behind", FINE, Views="180,0", UpdateViews=False)
    yield row("a view from below", FINE, Views="0,-90")
    for which in ("DepthFile", "BackDepthFile", "UsageFile", "MaskFile", "TextureFile"):
        ending = "tif" if "Depth" in which else "png"
        files = {other: folder / f"beside_{which}_{other}.png" for other in ("UsageFile", "MaskFile")}
        yield row(f"{which} in a folder that is not there", SENTENCE, BackSide=True,
                  **dict(files, **{which: folder / "no" / f"o.{ending}"}))
    yield row("BackDepthFile without BackSide", SENTENCE, BackDepthFile=folder / "b.tif")
    copy = rasters.save_image(folder / "query_copy.png", egg_image()[0])
    for which in ("DepthFile", "UsageFile", "MaskFile", "TextureFile"):
        yield row(f"{which} over the image", SENTENCE, Image=copy, **{which: copy})
    stored = mapping_database(folder, "over")
    yield row("DepthFile over the database", SENTENCE, Database=stored, DepthFile=stored)
    yield row("DepthFile over a raster of the database", SENTENCE, Database=stored, DepthFile=folder / "over" / "0.tif")
    yield row("one name for two files", SENTENCE, UsageFile=folder / "same.png", MaskFile=folder / "same.png")
    yield row("DepthFile as a PNG", FINE, DepthFile=folder / "d.png")
    yield row("DepthFile without an ending", SENTENCE, DepthFile=folder / "d")


def all_cases(case):
    folder = lib.work_folder()
    color, seen = egg_image()
    plain = dict(Image=rasters.save_image(folder / "egg.png", color), Database=models(folder) / "egg_0.ply",
                 Mask=rasters.save_image(folder / "mask.png", 255 * seen), PatchSizes="5,5", UpdateViews=False)

    def row(name, allowed=FINE, result="made", **values):
        return case("reconstruct_depth", name, [], [template("reconstruct_depth", **dict(plain, **values))], allowed,
                    False, result)

    yield row("as it should be", OK, BackSide=True)
    yield row("with the view searched", OK, UpdateViews=True)
    yield from images(row, folder, color, seen)
    yield from databases(row, folder)
    yield from values_and_files(row, folder)
