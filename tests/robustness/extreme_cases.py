# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of the table: every length, box and direction of every filter at its extremes."""
import copy

import lib
import mend_cases
import rasters
import shapes
from lib import template

FINE, SENTENCE, HOST = {"ok", "flawed", "untrusted", "sentence"}, {"sentence"}, {"host"}
NAN = float("nan")


def points_and_lengths(slug):
    """Names of its points, of its boxes, and of its lengths, from the template."""
    params = [(p.get("type"), p.get("name")) for p in template(slug)]
    points = [name for kind, name in params if kind == "RichPoint3f"]
    boxes = [name[:-3] for name in points if name.endswith("Min")]
    return ([n for n in points if n[:-3] not in boxes], boxes, [n for kind, n in params if kind == "RichAbsPerc"])


def values_of(slug):
    """Name of the row, what must come of it, values."""
    choices = {p.get("name") for p in template(slug) if p.get("type") == "RichEnum"}
    points, boxes, lengths = points_and_lengths(slug)
    for name in lengths:
        for value, allowed in (("1e12", FINE), ("1e22", SENTENCE), ("1e30", SENTENCE), ("-1", SENTENCE),
                               ("nan", SENTENCE), ("many", HOST), ("1e-30", FINE)):
            yield f"{name} {value}", allowed, {name: value}
    for name in boxes:
        used = {name: "Box"} if name in choices else {}
        for size, allowed in ((1e12, FINE), (1e22, SENTENCE), (3e38, SENTENCE), (NAN, SENTENCE)):
            yield f"{name} of size {size:g}", allowed, {**used, name + "Min": (-size,) * 3, name + "Max": (size,) * 3}
    for name in points:
        for value, allowed in ((1e12, FINE), (1e22, SENTENCE), (NAN, SENTENCE)):
            yield f"{name} {value:g}", allowed, {name: (0, 0, value)}


def mend(case, folder):
    beans = folder / "beans"
    beans.mkdir()
    shapes.write_ply(beans / "bean.ply", mend_cases.bean(1))
    scan = mend_cases.opened(mend_cases.bean(7), mend_cases.cap)
    for slug in ("fill_hole", "restore", "find_similar"):
        mesh = scan if slug == "fill_hole" else mend_cases.bean(7).select_faces(mend_cases.cap)
        for name, allowed, values in values_of(slug):
            values = dict(dict(Database=beans, Candidates=1, **({} if slug == "find_similar" else {"Blend": 1})), **values)
            yield case(slug, name, [mesh], [template(slug, **values)], allowed, False, "filled")
        for size in (1e13, 1e21, 1e-13):
            yield case(slug, f"a scan of size {size:g}", [copy.deepcopy(mesh).scaled(size)],
                       [template(slug, Database=beans, Candidates=1)], FINE, False, "filled")


def images(case, folder):
    front, _ = rasters.sphere()
    depth = rasters.save_tif(folder / "front.tif", front)
    for name, allowed, values in values_of("depth_to_mesh"):
        yield case("depth_to_mesh", name, [], [template("depth_to_mesh", Depth=depth, **values)], allowed, False, "made")
    models = folder / "models"
    models.mkdir()
    shapes.write_ply(models / "m.ply", shapes.sphere().painted(200, 120, 90))
    for i, (name, allowed, values) in enumerate(values_of("build_mappings")):
        values = dict(values, Models=models, Output=folder / f"out{i}.mlp", Width=30, Height=40)
        yield case("build_mappings", name, [], [template("build_mappings", **values)], allowed, False, "database")
    for i, (name, allowed, values) in enumerate(values_of("colorize_mesh")):
        values = dict(values, Database=models, TextureFile=folder / f"texture{i}.png", PatchSizes="5", Width=40,
                      Height=50, TextureSize=128)
        yield case("colorize_mesh", name, [shapes.sphere()], [template("colorize_mesh", **values)], allowed, False,
                   "made")


def far_away(case):
    """A scan as a survey has it: half a metre between one coordinate and the next."""
    away = shapes.sphere(radius=0.12).moved((455812, 5423377, 118)).select_faces(lambda c: c[:, 2] > 118)
    near = shapes.sphere(radius=0.12).select_faces(lambda c: c[:, 2] > 0)
    yield case("compose", "a model at UTM coordinates", [away, near], [template("compose")], SENTENCE, False, "composed")
    yield case("deform", "a model at UTM coordinates", [away], [template("deform")], SENTENCE, False, "composed")
    yield case("align_part_in_whole", "a model at UTM coordinates", [away, near], [template("align_part_in_whole")],
               SENTENCE, False, "placed")


def all_cases(case, meshes):
    for slug in ("compose", "deform"):
        for name, allowed, values in values_of(slug):
            yield meshes[slug](name, None, allowed, **values)
    yield from far_away(case)
    yield from mend(case, lib.work_folder())
    yield from images(case, lib.work_folder())
