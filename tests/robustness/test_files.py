#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""No file is lost: pipes, links, names that collide, two filters at once, disks
that are full or may not be written, and a filter that is killed while it writes.
"""
import contextlib
import hashlib
import os
import pathlib
import signal
import subprocess
import sys
import time
import unittest
import xml.etree.ElementTree as xml

from PIL import Image

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "mlx"))
import lib  # noqa: E402
import mend_cases  # noqa: E402
import rasters  # noqa: E402
import shapes  # noqa: E402
from lib import template  # noqa: E402

TIMEOUT = float(os.environ.get("PARTS_TIMEOUT", 60))
PRECIOUS = b"OLD GOOD FILE"


def digests(folder):
    """Of all regular files; links and pipes by what they are."""
    found = {}
    for f in sorted(folder.rglob("*")):
        if ".model-cache" in f.parts or f.is_dir():
            continue
        if f.is_symlink():
            found[f] = "-> " + os.readlink(f)
        else:
            found[f] = hashlib.sha256(f.read_bytes()).hexdigest() if f.is_file() else "special"
    return found


def script(file, *steps):
    root = xml.Element("FilterScript")
    root.extend(steps)
    file.write_text("<!DOCTYPE FilterScript>\n" + xml.tostring(root, encoding="unicode"))
    return file


class Files(lib.MeshCase):
    def setUp(self):
        self.folder = lib.work_folder()
        front, _ = rasters.sphere()
        self.depth = rasters.save_tif(self.folder / "front.tif", front)
        self.image = rasters.save_image(self.folder / "photo.png", rasters.picture())
        self.models = self.folder / "models"
        self.models.mkdir()
        for i in range(2):
            shapes.write_ply(self.models / f"m{i}.ply", shapes.sphere().scaled(1 + i).painted(200, 100 + 50 * i, 90))

    def run_filter(self, slug, meshes=(), **values):
        return lib.run(list(meshes), [template(slug, **values)], {} if not meshes else {"out": None}, timeout=TIMEOUT)

    def assertEnded(self, result, codes=(0, 255)):
        self.assertIn(result.code, codes, result.text[-800:] + result.errors[-300:])
        self.assertNotIn("internal error", result.text)

    def assertKept(self, before, besides=()):
        """What was there is as it was; only these names may be new."""
        after = digests(self.folder)
        self.assertEqual({f: after.get(f) for f in before}, before)
        new = [f.relative_to(self.folder).as_posix() for f in after if f not in before and "run-" not in str(f)]
        self.assertFalse([f for f in new if not f.startswith(tuple(besides))], "files that nobody asked for")

    def mapped(self, output="out.mlp", **values):
        return self.run_filter("build_mappings", Models=self.models, Output=self.folder / output,
                               **dict(dict(Width=40, Height=50), **values))

    # --- What is no regular file.

    def test_a_pipe_as_each_kind_of_input(self):
        for name in ("pipe.tif", "pipe.png", "pipe.mlp"):
            os.mkfifo(self.folder / name)
        os.mkfifo(self.models / "x.ply")
        bean = mend_cases.opened(mend_cases.bean(7), mend_cases.cap)
        self.assertEnded(self.run_filter("depth_to_mesh", Depth=self.folder / "pipe.tif"), (255,))
        self.assertEnded(self.run_filter("depth_to_mesh", Depth=self.depth, Image=self.folder / "pipe.png"), (255,))
        self.assertEnded(self.run_filter("fill_hole", [bean], Database=self.folder / "pipe.mlp"), (255,))
        self.assertEnded(self.mapped())  # the pipe is skipped and named, or refused

    def test_a_pipe_as_the_class_preset(self):
        os.mkfifo(self.models / "class.json")
        self.assertEnded(self.mapped())

    # --- Names that collide, links.

    def test_links_are_never_written_through(self):
        victim = self.folder / "victim.txt"
        victim.write_bytes(PRECIOUS)
        for name in ("skin.part.png", "skin.png.part", "skin.tmp", ".skin.png"):
            (self.folder / name).symlink_to(victim)
        result = self.run_filter("depth_to_mesh", Depth=self.depth, Image=self.image,
                                 TextureFile=self.folder / "skin.png")
        self.assertEnded(result)
        self.assertEqual(victim.read_bytes(), PRECIOUS)

    def test_a_file_named_like_a_draft(self):
        for name in ("skin.part.png", "skin.png.part", "out.part.mlp", "out.mlp.part"):
            (self.folder / name).write_bytes(PRECIOUS)
        before = digests(self.folder)
        self.assertEnded(self.run_filter("depth_to_mesh", Depth=self.depth, Image=self.image,
                                         TextureFile=self.folder / "skin.png"))
        self.assertEnded(self.mapped())
        self.assertKept(before, ("skin.png", "out.mlp", "out_mappings", "out.class.json"))

    def test_an_input_named_like_a_draft(self):
        photo = rasters.save_image(self.folder / "skin.part.png", rasters.picture())
        before = digests(self.folder)
        self.assertEnded(self.run_filter("depth_to_mesh", Depth=self.depth, Image=photo,
                                         TextureFile=self.folder / "skin.png"))
        self.assertEnded(self.run_filter("reconstruct_depth", Image=photo, Database=self.folder / "nowhere",
                                         UsageFile=self.folder / "skin.png"), (255,))
        self.assertKept(before, ("skin.png",))

    def test_models_in_the_folder_of_the_output_stay(self):
        where = self.folder / "out_mappings"
        where.mkdir()
        for i in range(2):
            shapes.write_ply(where / f"m{i}.ply", shapes.sphere())
        before = digests(where)
        for _ in range(2):
            self.assertEnded(self.run_filter("build_mappings", Models=where, Output=self.folder / "out.mlp", Width=40,
                                             Height=50))
        after = digests(where)
        self.assertEqual({f: after.get(f) for f in before}, before)

    # --- Two at once.

    def test_two_databases_at_once_under_one_name(self):
        sizes = (40, 60)
        scripts = [script(self.folder / f"s{w}.mlx", template("build_mappings", Models=self.models, Width=w, Height=50,
                                                              Output=self.folder / "out.mlp")) for w in sizes]
        runs = [subprocess.Popen([lib.SERVER, "-s", s], cwd=self.folder, stdout=subprocess.DEVNULL,
                                 stderr=subprocess.DEVNULL) for s in scripts]
        codes = [run.wait(TIMEOUT * 2) for run in runs]
        self.assertTrue(set(codes) <= {0, 255} and 0 in codes, codes)
        seen = {Image.open(f).size for f in (self.folder / "out_mappings").glob("*.png")}
        self.assertEqual(len(seen), 1, "images of one run, not of both")

    def test_two_textures_at_once_beside_one_depth(self):
        colors = {"red": (250, 0, 0), "green": (0, 250, 0)}
        runs = {}
        for name, color in colors.items():
            pixels = rasters.picture()
            pixels[..., :3] = color
            image = rasters.save_image(self.folder / f"{name}.bmp", pixels[..., :3])
            s = script(self.folder / f"{name}.mlx", template("depth_to_mesh", Depth=self.depth, Image=image))
            runs[name] = subprocess.Popen([lib.SERVER, "-s", s], cwd=self.folder, stdout=subprocess.PIPE, text=True,
                                          stderr=subprocess.DEVNULL)
        for name, run in runs.items():
            text = run.communicate(timeout=TIMEOUT)[0]
            self.assertEqual(run.returncode, 0, text[-500:])
            texture = next(line.split(": ", 1)[1] for line in text.splitlines() if line.startswith("texture: "))
            pixel = Image.open(texture).convert("RGB").getpixel((30, 40))
            self.assertEqual(max(range(3), key=lambda k: pixel[k]), list(colors).index(name), f"{name} got {texture}")

    # --- Disks.

    def small_disk(self, kilobytes):
        disk = self.folder / "tiny"
        disk.mkdir()
        if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", disk],
                                               capture_output=True).returncode:
            self.skipTest("mounting a small disk needs root")
        self.addCleanup(subprocess.run, ["umount", disk])
        return disk

    def test_a_full_disk_leaves_the_old_file(self):
        for ending in ("png", "bmp", "tif", "jpg"):
            with self.subTest(ending):
                disk = self.small_disk(64)
                old = disk / f"skin.{ending}"
                old.write_bytes(PRECIOUS)
                with open(disk / "fill", "wb", buffering=0) as fill, contextlib.suppress(OSError):
                    while True:
                        fill.write(bytes(4096))
                result = self.run_filter("depth_to_mesh", Depth=self.depth, Image=self.image, TextureFile=old)
                left = sorted(f.name for f in disk.iterdir())
                content = old.read_bytes()
                self.doCleanups()
                disk.rmdir()
                self.assertFailed(result, "cannot be written")
                self.assertEqual(content, PRECIOUS)
                self.assertEqual(left, ["fill", old.name], "a draft was left")

    def test_a_full_disk_and_a_database(self):
        disk = self.small_disk(64)
        result = self.mapped(output="tiny/out.mlp", Width=300, Height=400)
        self.assertFailed(result)
        self.assertFalse(list(disk.rglob("*")), "left behind")

    def test_a_folder_that_may_not_be_written(self):
        disk = self.small_disk(256)
        subprocess.run(["mount", "-o", "remount,ro", disk], check=True)
        before = digests(self.folder)
        for result in (self.run_filter("depth_to_mesh", Depth=self.depth, Image=self.image,
                                       TextureFile=disk / "skin.png"),
                       self.mapped(output="tiny/out.mlp")):
            self.assertFailed(result, "cannot")
        self.assertKept(before)

    # --- Killed while it writes.

    def test_killed_at_any_time(self):
        self.assertEnded(self.mapped(Width=200, Height=250), (0,))
        before = {f: d for f, d in digests(self.folder).items() if "out" not in f.name and "out_" not in str(f)}
        s = script(self.folder / "again.mlx", template("build_mappings", Models=self.models, Width=210, Height=250,
                                                       Views="0,0;30,0;60,0;90,0", Output=self.folder / "out.mlp"))
        for share in range(1, 9):
            run = subprocess.Popen([lib.SERVER, "-s", s], cwd=self.folder, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
            try:
                run.wait(0.15 * share)
            except subprocess.TimeoutExpired:
                run.send_signal(signal.SIGKILL)
                run.wait()
            time.sleep(0.01)
            after = digests(self.folder)
            self.assertEqual({f: after.get(f) for f in before}, before, "an input was changed")
            project = self.folder / "out.mlp"
            self.assertTrue(project.exists(), "the old database is gone")
            xml.fromstring(project.read_text().split("<!DOCTYPE MeshLabDocument>")[-1])  # whole
            for name in {p.get("fileName") for p in xml.parse(project).iter("Plane")}:
                self.assertTrue((self.folder / name).exists(), f"{name} is named and not there")


if __name__ == "__main__":
    unittest.main(verbosity=2)
