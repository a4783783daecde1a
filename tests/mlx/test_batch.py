# SPDX-License-Identifier: GPL-3.0-or-later
"""tools/batch: any names, a row each, what is done stays done, nothing of others' is overwritten."""
import csv
import os
import pathlib
import subprocess
import unittest

import numpy as np

import lib
import shapes

BATCH = lib.ROOT / "tools" / "batch"


def bean(seed):
    """A smooth body with a bump of its own."""
    ball = shapes.sphere(level=3)
    v = ball.v.astype(float)
    bump = np.array([np.cos(seed), np.sin(seed), 1.0]) / np.sqrt(2)
    return shapes.Mesh(v * (1 + 0.3 * np.exp(-4 * ((v - bump) ** 2).sum(axis=1)))[:, None], ball.f)


def holed(mesh, at):
    middle = mesh.v[mesh.f].mean(axis=1)
    return shapes.Mesh(mesh.v, mesh.f[np.linalg.norm(middle - at, axis=1) > 0.35])


class Batch(unittest.TestCase):
    def setUp(self):
        self.folder = lib.work_folder()
        self.out = self.folder / "out"
        (self.folder / "class").mkdir()
        for seed in range(2):
            shapes.write_ply(self.folder / "class" / f"{seed}.ply", bean(seed))
        self.scans = []
        for k, name in enumerate(("first scan", "größe", "third")):
            self.scans.append(self.folder / f"{name}.ply")
            shapes.write_ply(self.scans[-1], holed(bean(0.5 + k), (0, 0, 1)))

    def batch(self, *words):
        environment = {**os.environ, "MESHLABSERVER": str(lib.SERVER)}
        run = subprocess.run([BATCH, "fill_hole", "--database", self.folder / "class", "--out", self.out, "Blend=1", *words],
                             capture_output=True, text=True, env=environment)
        rows = []
        if (self.out / "batch.csv").exists():
            with open(self.out / "batch.csv", newline="") as file:
                rows = list(csv.DictReader(file))
        return run, rows

    def test_each_scan_has_a_result_and_a_row(self):
        run, rows = self.batch("--jobs", "2", "--together", "2", *self.scans)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        self.assertEqual([r["scan"] for r in rows], [str(s) for s in self.scans])
        for row, scan in zip(rows, self.scans):
            self.assertEqual((row["status"], row["mended"], row["left_open"]), ("good", "1", "0"))
            mended = shapes.read_ply(pathlib.Path(row["result"]))
            self.assertGreater(len(mended.f), len(shapes.read_ply(scan).f))
            # Its own scan, not another's: all vertices of the scan's faces are in it.
            own = {tuple(v) for v in np.round(shapes.read_ply(scan).v[np.unique(shapes.read_ply(scan).f)], 5).tolist()}
            self.assertLessEqual(own, {tuple(v) for v in np.round(mended.v, 5).tolist()})
        self.assertFalse([f for f in self.out.iterdir() if f.name.startswith(".")])

    def test_what_is_done_stays_done_and_what_changed_is_done_again(self):
        self.batch(*self.scans)
        times = {f: f.stat().st_mtime_ns for f in self.out.glob("*.ply")}
        shapes.write_ply(self.scans[1], holed(bean(7), (0, 0, 1)))
        run, rows = self.batch(*self.scans)
        self.assertEqual((run.returncode, len(rows)), (0, 3), run.stdout + run.stderr)
        self.assertEqual([f.stem for f, t in times.items() if f.stat().st_mtime_ns != t], ["größe"])

    def test_one_that_cannot_be_mended_spoils_no_other(self):
        whole = self.folder / "whole.ply"
        shapes.write_ply(whole, bean(3))
        run, rows = self.batch(self.scans[0], whole, self.scans[2])
        self.assertEqual(run.returncode, 2)
        self.assertEqual([r["status"] for r in rows], ["good", "failed", "good"])
        self.assertIn("no hole", rows[1]["warnings"])
        self.assertFalse((self.out / "whole.ply").exists())

    def test_files_of_others_are_not_overwritten(self):
        self.out = self.folder
        before = self.scans[0].read_bytes()
        run, _ = self.batch(*self.scans)
        self.assertEqual(run.returncode, 1)
        self.assertIn("--out", run.stderr)
        self.assertEqual(self.scans[0].read_bytes(), before)

    def test_neither_are_tables_sheets_and_textures(self):
        self.out.mkdir()
        for name in ("batch.csv", "sheet_1.png", "third.png"):
            (self.out / name).write_text("mine")
            run, _ = self.batch(self.scans[2])
            self.assertEqual((run.returncode, (self.out / name).read_text()), (1, "mine"), name)
            self.assertIn(name, run.stderr)
            (self.out / name).unlink()

    def test_bad_words_are_named(self):
        for words, part in ((["no_such.ply"], "does not exist"), ([self.scans[0], "Blend2=3"], "Blend2")):
            run, _ = self.batch(*words)
            self.assertEqual(run.returncode, 1)
            self.assertIn(part, run.stderr)


if __name__ == "__main__":
    lib.main()
