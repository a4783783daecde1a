# SPDX-License-Identifier: GPL-3.0-or-later
"""tools/mlx: every template by its defaults, and no value of a wrong type."""
import subprocess
import unittest
import xml.etree.ElementTree as xml

import lib


def mlx(*words):
    return subprocess.run([lib.ROOT / "tools" / "mlx", *words], capture_output=True, text=True)


class MlxTool(unittest.TestCase):
    def test_a_script_by_defaults_is_the_template(self):
        names = mlx("--list").stdout
        for path in (lib.ROOT / "scripts").glob("*.mlx"):
            made = xml.fromstring(mlx(path.stem).stdout.split("\n", 1)[1])
            as_given = [(p.get("name"), p.attrib) for p in xml.parse(path).getroot().iter("Param")]
            self.assertEqual([(p.get("name"), p.attrib) for p in made.iter("Param")], as_given)
            explained = mlx("--help", path.stem).stdout
            self.assertTrue(all(name in explained for name, _ in as_given))
            self.assertIn(path.stem, names)

    def test_values_of_a_wrong_type_are_refused_in_a_sentence(self):
        for value in ("Levels=x", "Candidates=3.5", "Region=Nowhere", "Region=9", "RegionMin=1,2", "RegionMin=1,2,nan",
                      "RegionMin=1,2,3,4", "Refine=yes", "Mesh=-1", "Margin=inf", "Margin=", "NoSuch=1"):
            run = mlx("fill_hole", value)
            self.assertEqual((run.returncode, run.stdout), (1, ""), value)
            self.assertRegex(run.stderr, rf"{value.split('=')[0]}.*\.\n$")

    def test_values_of_the_right_type_are_taken(self):
        made = mlx("fill_hole", "Region=Box", "RegionMin=1,-2e3,.5", "Margin=0.25", "Refine=false", "Database=a b=c")
        params = {p.get("name"): p for p in xml.fromstring(made.stdout.split("\n", 1)[1]).iter("Param")}
        self.assertEqual(params["Region"].get("value"), "2")
        self.assertEqual([params["RegionMin"].get(axis) for axis in "xyz"], ["1", "-2e3", ".5"])
        self.assertEqual([params[n].get("value") for n in ("Margin", "Refine", "Database")], ["0.25", "false", "a b=c"])


if __name__ == "__main__":
    lib.main()
