# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs that nobody prepared: each function damages a copy of a mesh."""
import copy

import numpy as np

from shapes import Mesh, merged, sphere


def with_faces(m, f, index=None):
    """Other faces; index: of the old face that each of them continues."""
    out = copy.copy(m)
    out.f = np.asarray(f).reshape(-1, 3)
    if m.face_selected is not None:
        index = np.minimum(np.arange(len(out.f)), len(m.f) - 1) if index is None else index
        out.face_selected = m.face_selected[index]
    return out


def several_components(m):
    """A ball inside and a ball beside the model."""
    low, high = m.v.min(axis=0), m.v.max(axis=0)
    size = (high - low).min()
    out = merged(m, sphere((low + high) / 2, 0.1 * size, 1), sphere(high + 0.3 * size, 0.2 * size, 2))
    if m.face_selected is not None:
        out.face_selected = np.zeros(len(out.f), bool)
        out.face_selected[:len(m.f)] = m.face_selected
    if m.vertex_selected is not None:
        out.vertex_selected = np.zeros(len(out.v), bool)
        out.vertex_selected[:len(m.v)] = m.vertex_selected
    return out


def duplicate_vertices(m):
    """Every face has corners of its own, as STL files have them."""
    out = copy.copy(m)
    out.v = m.v[m.f].reshape(-1, 3)
    out.f = np.arange(len(out.v)).reshape(-1, 3)
    if m.vertex_selected is not None:
        out.vertex_selected = m.vertex_selected[m.f].ravel()
    return out


def zero_area_faces(m):
    """Faces with the same corner twice, and slivers along an edge."""
    a, b, c = m.f[::7].T
    out = with_faces(m, np.concatenate([m.f, np.stack([a, a, b], 1), np.stack([a, b, a], 1), np.stack([b, b, b], 1)]))
    out.v = out.v.copy()
    out.v[m.f[3, 2]] = (out.v[m.f[3, 0]] + out.v[m.f[3, 1]]) / 2
    return out


def non_manifold_edges(m):
    """A fin on every eleventh face."""
    out = copy.copy(m)
    f = m.f[::11]
    tips = m.v[f].mean(axis=1) * 1.05
    out.v = np.concatenate([m.v, tips])
    fins = np.stack([f[:, 0], f[:, 1], len(m.v) + np.arange(len(f))], 1)
    if m.vertex_selected is not None:
        out.vertex_selected = np.concatenate([m.vertex_selected, np.zeros(len(tips), bool)])
    if m.face_selected is not None:
        out.face_selected = np.concatenate([m.face_selected, np.zeros(len(fins), bool)])
    out.f = np.concatenate([m.f, fins])
    return out


def doubled_faces(m):
    """A third of the faces twice."""
    return with_faces(m, np.concatenate([m.f, m.f[::3]]), np.concatenate([np.arange(len(m.f)), np.arange(len(m.f))[::3]]))


def flipped_faces(m):
    """Every third face the other way round."""
    f = m.f.copy()
    f[::3] = f[::3, ::-1]
    return with_faces(m, f, np.arange(len(f)))


def inside_out(m):
    return with_faces(m, m.f[:, ::-1], np.arange(len(m.f)))


def holes(m):
    """A tenth of the faces missing, by a fixed draw."""
    keep = np.flatnonzero(np.random.default_rng(1).random(len(m.f)) > 0.1)
    return with_faces(m, m.f[keep], keep)


def nan_coordinates(m):
    out = copy.copy(m)
    out.v = out.v.astype(float)
    out.v[::97] = np.nan
    return out


def infinite_coordinates(m):
    out = copy.copy(m)
    out.v = out.v.astype(float)
    out.v[5] = np.inf
    return out


def loose_vertices(m):
    """Vertices without faces, far away."""
    out = copy.copy(m)
    out.v = np.concatenate([m.v, m.v[:5] + 1000])
    if m.vertex_selected is not None:
        out.vertex_selected = np.concatenate([m.vertex_selected, np.ones(5, bool)])
    return out


def point_cloud(m):
    return Mesh(m.v, np.zeros((0, 3), int))


def empty(_):
    return Mesh(np.zeros((0, 3)), np.zeros((0, 3), int))


def one_face(m):
    return with_faces(m, m.f[:1], np.zeros(1, int))


def flat(m):
    """Pressed into the plane z = 0."""
    out = copy.copy(m)
    out.v = out.v * [1, 1, 0]
    return out


def collapsed(m):
    """Every vertex in one place."""
    out = copy.copy(m)
    out.v = np.zeros_like(out.v, float)
    return out


DAMAGES = [several_components, duplicate_vertices, zero_area_faces, non_manifold_edges, doubled_faces, flipped_faces,
           inside_out, holes, nan_coordinates, infinite_coordinates, loose_vertices, point_cloud, empty, one_face, flat,
           collapsed]
