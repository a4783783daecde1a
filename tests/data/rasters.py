# SPDX-License-Identifier: GPL-3.0-or-later
"""Depth rasters and images of simple things, and the files that they travel in."""
import numpy as np
from PIL import Image

NAN = float("nan")


def grid(width, height):
    """Pixel centres from the middle of the image, y upwards."""
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, height / 2 - np.arange(height) - 0.5)
    return x, y


def sphere(width=60, height=80, radius=25.0, depth=100.0):
    """Front and back depth of a sphere, orthographic, a pixel a world unit; NaN around it."""
    x, y = grid(width, height)
    with np.errstate(invalid="ignore"):
        half = np.sqrt(radius ** 2 - x ** 2 - y ** 2)
    return (depth - half).astype(np.float32), (depth + half).astype(np.float32)


def picture(width=60, height=80):
    """Every pixel another colour: red grows to the right, green downwards."""
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    return np.stack([40 + 3 * x, 10 + 3 * y, np.full_like(x, 90)], -1).clip(0, 255).astype(np.uint8)


def save_tif(path, depth):
    Image.fromarray(np.asarray(depth, np.float32)).save(path)
    return path


def save_pfm(path, depth):
    depth = np.asarray(depth, "<f4")
    with open(path, "wb") as out:
        out.write(b"Pf\n%d %d\n-1.0\n" % (depth.shape[1], depth.shape[0]) + depth[::-1].tobytes())
    return path


def save_png16(path, depth, scale):
    """In units of scale; 0 where there is no depth."""
    Image.fromarray(np.nan_to_num(depth / scale, nan=0).round().astype(np.uint16)).save(path)
    return path


def save_image(path, pixels, **options):
    Image.fromarray(np.asarray(pixels, np.uint8)).save(path, **options)
    return path


def read(path):
    return np.array(Image.open(path))
