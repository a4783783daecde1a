# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of the table for filters that mend a scan from a database of models."""
import copy

import numpy as np

import lib
import nasty
import shapes
from lib import template

FINE, OK, SENTENCE = {"ok", "flawed", "untrusted", "sentence"}, {"ok"}, {"sentence"}


def bean(seed):
    """Closed, with a bump on its +z side; another one for another seed."""
    m = shapes.sphere(level=4)
    r = np.random.default_rng(seed)
    v = m.v.astype(float) * (1, 1 + 0.1 * r.random(), 0.9)
    bump = np.exp(-12 * ((v[:, 0] - 0.1) ** 2 + (v[:, 1] - 0.1) ** 2)) * (v[:, 2] > 0)
    m.v = v * (1 + (0.25 + 0.1 * r.random()) * bump)[:, None]
    return m


def opened(m, where):
    return shapes.Mesh(m.v, m.f[~where(m.v[m.f].mean(axis=1))])


def cap(c):
    return c[:, 2] > 0.7


def all_cases(case):
    folder = lib.work_folder()
    (folder / "beans").mkdir()
    for seed in range(3):
        shapes.write_ply(folder / "beans" / f"bean{seed}.ply", bean(seed))
    (folder / "empty").mkdir()
    (folder / "open").mkdir()
    shapes.write_ply(folder / "open" / "open.ply", opened(bean(1), cap))
    (folder / "broken").mkdir()
    (folder / "broken" / "broken.ply").write_bytes(b"ply\nformat ascii 1.0\nelement vertex 3\n")
    scan = opened(bean(7), cap)

    def fill(name, mesh=scan, allowed=FINE, closed=False, **values):
        values = dict(dict(Database=folder / "beans", Candidates=2), **values)
        return case("fill_hole", name, [mesh], [template("fill_hole", **values)], allowed, closed, "filled")

    def restore(name, mesh, allowed=FINE, closed=False, **values):
        values = dict(dict(Database=folder / "beans", Candidates=2), **values)
        return case("restore", name, [mesh], [template("restore", **values)], allowed, closed, "restored")

    def find(name, mesh=scan, allowed=FINE, **values):
        values = dict(dict(Database=folder / "beans", Region="Around all holes"), **values)
        return case("find_similar", name, [mesh], [template("find_similar", **values)], allowed, False, "found")

    selected = bean(7).select_faces(cap)
    yield fill("a hole", allowed=OK, closed=True)
    yield fill("a hole, as in the thesis", FitToRim=False, Refine=False)
    yield fill("a hole, the thesis' cut", Cut="Thesis")
    yield fill("three models blended", allowed=OK, closed=True, Candidates=3, Blend=3)
    yield restore("a selected flaw", selected, OK, True)
    yield restore("a selected flaw, the thesis' cut", selected, Cut="Thesis")
    yield find("around the holes", allowed=OK)
    yield fill("no hole", bean(7), SENTENCE)
    yield restore("everything selected", bean(7).select_faces(lambda c: c[:, 2] > -9), SENTENCE)
    yield fill("a hole with a loose piece", shapes.merged(scan, opened(bean(7), lambda c: c[:, 2] < 0.95)))
    yield fill("two holes", opened(bean(7), lambda c: abs(c[:, 2]) > 0.7), OK, True)
    yield fill("a gap through a handle", opened(shapes.torus(), lambda c: (c[:, 0] > 0.7) & (abs(c[:, 1]) < 0.3)))
    yield fill("a flat sheet", shapes.grid())
    for name in ("empty", "open", "broken", "nowhere"):
        yield fill(f"database {name}", allowed=SENTENCE, Database=folder / name)
    for name, box in (("misses the scan", ((5, 5, 5), (6, 6, 6))), ("inverted", ((1, 1, 1), (0, 0, 0))),
                      ("not a number", ((float("nan"), 0, 0), (1, 1, 1))), ("without a hole", ((-1, -1, -1), (1, 1, 0)))):
        where = dict(Region="Box", RegionMin=box[0], RegionMax=box[1])
        yield fill(f"a box {name}", allowed=SENTENCE, **where)
        if name != "without a hole":
            yield restore(f"a box {name}", bean(7), SENTENCE, **where)
    for factor in (1e6, 1e-6):
        yield fill(f"size {factor:g}", copy.deepcopy(scan).scaled(factor), FINE)
    yield fill("ConstraintDistance 2", allowed=SENTENCE, ConstraintDistance=2)
    yield fill("no candidate", allowed=SENTENCE, Candidates=0)
    for damage in nasty.DAMAGES:
        yield fill(f"scan: {damage.__name__.replace('_', ' ')}", damage(copy.deepcopy(scan)))
        yield restore(f"scan: {damage.__name__.replace('_', ' ')}", damage(bean(7).select_faces(cap)))
