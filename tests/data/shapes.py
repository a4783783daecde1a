# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed test surfaces, and the mesh files that they travel in."""
from dataclasses import dataclass, field
import struct

import numpy as np

SELECTED = 0x20  # MeshLab's flag, of vertices and of faces


@dataclass
class Mesh:
    v: np.ndarray                 # n x 3 positions
    f: np.ndarray                 # m x 3 vertex indices, counter-clockwise from outside
    color: np.ndarray = None      # n x 4 bytes
    quality: np.ndarray = None    # n
    wedge: np.ndarray = None      # m x 3 x 2 texture coordinates
    texnumber: np.ndarray = None  # m
    textures: list = field(default_factory=list)
    vertex_selected: np.ndarray = None  # n
    face_selected: np.ndarray = None    # m

    def centroids(self):
        return self.v[self.f].mean(axis=1)

    def select_faces(self, where):
        """where: a function of the faces' centroids, or a mask."""
        self.face_selected = where(self.centroids()) if callable(where) else where
        return self

    def select_vertices(self, where):
        self.vertex_selected = where(self.v) if callable(where) else where
        return self

    def painted(self, r, g, b):
        self.color = np.tile(np.array([r, g, b, 255], np.uint8), (len(self.v), 1))
        return self

    def moved(self, offset):
        self.v = self.v + np.asarray(offset, float)
        return self

    def scaled(self, factor):
        self.v = self.v * factor
        return self

    def turned(self, axis, degrees):
        self.v = self.v @ rotation(axis, degrees).T
        return self


def rotation(axis, degrees):
    a = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
    t = np.radians(degrees)
    return np.eye(3) + np.sin(t) * k + (1 - np.cos(t)) * k @ k


def sphere(center=(0, 0, 0), radius=1.0, level=3):
    """An icosahedron, each face split into four `level` times: 20 * 4^level faces."""
    g = (1 + 5 ** 0.5) / 2
    v = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
         (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    f = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
         (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7),
         (9, 8, 1)]
    v, f = np.array(v, float), np.array(f)
    for _ in range(level):
        edges = np.sort(np.concatenate([f[:, [0, 1]], f[:, [1, 2]], f[:, [2, 0]]]), axis=1)
        unique, back = np.unique(edges, axis=0, return_inverse=True)
        middle = len(v) + back.reshape(3, -1)
        v = np.concatenate([v, v[unique].mean(axis=1)])
        a, b, c = f.T
        ab, bc, ca = middle
        f = np.concatenate([np.stack(t, 1) for t in [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]])
    v *= radius / np.linalg.norm(v, axis=1, keepdims=True)
    return Mesh(v + np.asarray(center, float), f)


def torus(center=(0, 0, 0), radius=1.0, thickness=0.35, around=48, across=24):
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = 2 * np.pi * i / around, 2 * np.pi * j / across
    r = radius + thickness * np.cos(b)
    v = np.stack([r * np.cos(a), r * np.sin(a), thickness * np.sin(b)], -1).reshape(-1, 3)
    def at(di, dj): return ((i + di) % around * across + (j + dj) % across).ravel()
    f = np.concatenate([np.stack([at(0, 0), at(1, 0), at(1, 1)], 1), np.stack([at(0, 0), at(1, 1), at(0, 1)], 1)])
    return Mesh(v + np.asarray(center, float), f)


def tube(points, radii, sides=24):
    """A closed surface around a polyline, with a radius at each of its points."""
    p, radii = np.asarray(points, float), np.asarray(radii, float)
    t = np.gradient(p, axis=0)
    t /= np.linalg.norm(t, axis=1, keepdims=True)
    x = np.cross(t[0], [1, 0, 0] if abs(t[0][0]) < 0.7 else [0, 1, 0])
    angle = 2 * np.pi * np.arange(sides) / sides
    rings = []
    for k in range(len(p)):
        x = x - t[k] * (x @ t[k])
        x /= np.linalg.norm(x)
        y = np.cross(t[k], x)
        rings.append(p[k] + radii[k] * (np.cos(angle)[:, None] * x + np.sin(angle)[:, None] * y))
    v = np.concatenate(rings + [[p[0] - t[0] * radii[0], p[-1] + t[-1] * radii[-1]]])
    n, j = len(p), np.arange(sides)
    nxt = (j + 1) % sides
    f = []
    for k in range(n - 1):
        a, b, c, d = k * sides + j, k * sides + nxt, (k + 1) * sides + nxt, (k + 1) * sides + j
        f += [np.stack([a, b, c], 1), np.stack([a, c, d], 1)]
    first, last = np.full(sides, n * sides), np.full(sides, n * sides + 1)
    f += [np.stack([first, nxt, j], 1), np.stack([last, (n - 1) * sides + j, (n - 1) * sides + nxt], 1)]
    return Mesh(v, np.concatenate(f))


def capsule(start, end, radius, sides=24, rings=24):
    s = np.linspace(0, 1, rings)
    return tube(np.outer(1 - s, start) + np.outer(s, end), np.full(rings, float(radius)), sides)


def neck_with_head(start, end, neck=0.18, head=0.4, sides=24, rings=40):
    """A tube from start that swells to a ball around end."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    length = np.linalg.norm(end - start) + head
    s = np.linspace(0, 1, rings) * length * 0.995
    ball = np.sqrt(np.maximum(head ** 2 - (s - (length - head)) ** 2, 0))
    d = (end - start) / np.linalg.norm(end - start)
    return tube(start + np.outer(s, d), np.maximum(ball, np.where(s < length - head, neck, 0.02)), sides)


def grid(size=1.0, n=20, z=0.0):
    """An open square in the plane of height z."""
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    v = np.stack([size * (i / n - 0.5), size * (j / n - 0.5), np.full(i.shape, z)], -1).reshape(-1, 3)
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    return Mesh(v, np.concatenate([np.stack([a, a + n + 1, a + n + 2], 1), np.stack([a, a + n + 2, a + 1], 1)]))


def merged(*meshes):
    """Several components in one mesh; positions and faces only."""
    f, n = [], 0
    for m in meshes:
        f.append(m.f + n)
        n += len(m.v)
    return Mesh(np.concatenate([m.v for m in meshes]), np.concatenate(f))


def write_ply(path, m):
    """Binary, in the layout that MeshLab itself writes."""
    head = ["ply", "format binary_little_endian 1.0"] + [f"comment TextureFile {t}" for t in m.textures]
    head += [f"element vertex {len(m.v)}"] + [f"property float {c}" for c in "xyz"]
    dtype = [("p", "<f4", 3)]
    if m.vertex_selected is not None:
        head.append("property int flags")
        dtype.append(("flags", "<i4"))
    if m.color is not None:
        head += [f"property uchar {c}" for c in ("red", "green", "blue", "alpha")]
        dtype.append(("color", "u1", 4))
    if m.quality is not None:
        head.append("property float quality")
        dtype.append(("quality", "<f4"))
    vertex = np.zeros(len(m.v), dtype)
    vertex["p"] = m.v
    if m.vertex_selected is not None:
        vertex["flags"] = np.where(m.vertex_selected, SELECTED, 0)
    if m.color is not None:
        vertex["color"] = m.color
    if m.quality is not None:
        vertex["quality"] = m.quality
    head += [f"element face {len(m.f)}", "property list uchar int vertex_indices"]
    dtype = [("count", "u1"), ("f", "<i4", 3)]
    if m.face_selected is not None:
        head.append("property int flags")
        dtype.append(("flags", "<i4"))
    if m.wedge is not None:
        head.append("property list uchar float texcoord")
        dtype += [("uvs", "u1"), ("uv", "<f4", 6)]
        if len(m.textures) > 1:
            head.append("property int texnumber")
            dtype.append(("texnumber", "<i4"))
    face = np.zeros(len(m.f), dtype)
    face["count"] = 3
    face["f"] = np.asarray(m.f).reshape(-1, 3)
    if m.face_selected is not None:
        face["flags"] = np.where(m.face_selected, SELECTED, 0)
    if m.wedge is not None:
        face["uvs"] = 6
        face["uv"] = m.wedge.reshape(-1, 6)
        if len(m.textures) > 1:
            face["texnumber"] = m.texnumber
    with open(path, "wb") as out:
        out.write(("\n".join(head) + "\nend_header\n").encode() + vertex.tobytes() + face.tobytes())


NUMBERS = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4", "float": "<f4",
           "double": "<f8", "int8": "i1", "uint8": "u1", "int32": "<i4", "uint32": "<u4", "float32": "<f4"}


def read_ply(path):
    """Binary files of triangles, as MeshLab writes them; positions stay 32-bit."""
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    elements, textures = [], []
    for line in data[:end].decode().splitlines():
        words = line.split()
        if words[:2] == ["comment", "TextureFile"]:
            textures.append(line.split(None, 2)[2])
        elif words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property" and words[1] == "list":
            size = {"vertex_indices": 3, "vertex_index": 3, "texcoord": 6}[words[4]]
            elements[-1][2].extend([(words[4] + "_count", NUMBERS[words[2]]), (words[4], NUMBERS[words[3]], size)])
        elif words[0] == "property":
            elements[-1][2].append((words[2], NUMBERS[words[1]]))
    tables, at = {}, end
    for name, count, dtype in elements:
        tables[name] = np.frombuffer(data, dtype, count, at)
        at += tables[name].nbytes
    vertex, face = tables["vertex"], tables.get("face", np.zeros(0, [("vertex_indices", "<i4", 3)]))
    names, m = vertex.dtype.names, Mesh(np.stack([vertex[c] for c in "xyz"], 1), face["vertex_indices"])
    m.textures = textures
    if "red" in names:
        m.color = np.stack([vertex[c] for c in ("red", "green", "blue", "alpha")], 1)
    if "quality" in names:
        m.quality = vertex["quality"]
    if "texcoord" in face.dtype.names:
        m.wedge = face["texcoord"].reshape(-1, 3, 2)
    if "texnumber" in face.dtype.names:
        m.texnumber = face["texnumber"]
    if "flags" in face.dtype.names:
        m.face_selected = (face["flags"] & SELECTED) != 0
    return m


def write_png(path, rgb, size=8):
    """A picture of one colour."""
    import zlib
    rows = b"".join(b"\0" + bytes(rgb) * size for _ in range(size))
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    with open(path, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)) +
                  chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
