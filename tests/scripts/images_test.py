#!/usr/bin/python3
"""scripts/images makes the pictures that a report shows. Usage: images_test.py RAYMETER [UNITTEST ARGUMENTS]"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import matplotlib.image

RAYMETER = ""
ROOT = Path(__file__).resolve().parent.parent.parent
CONFIG = {
    "name": "t",
    "matrix": {"scene": ["spd:tetra:2", "scene one.nff", "scene-one.nff"], "structure": [{"name": "list"}, {"name": "bvh", "max_leaf_size": [1, 4]}, {"name": "grid"}],
               "isa": ["scalar"], "packet": [1, 4], "rays": ["primary", "shadow"]},
    "exclude": [{"scene": "scene-one.nff", "structure.name": "bvh"}, {"scene": "scene-one.nff", "structure.name": "grid"}],
    "image": {"width": 20, "height": 10}, "measure": {"samples": 0},
}
BALL = "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 4 4\nl 0 5 5\nf 1 0 0 1 0 0 0 0\ns 0 0 0 1\n"


class ImagesTest(unittest.TestCase):
    def setUp(self) -> None:
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)

    def run_in_folder(self, *words: str | Path) -> subprocess.CompletedProcess:
        return subprocess.run([str(word) for word in words], capture_output=True, text=True, cwd=self.folder)

    def measure(self) -> Path:
        for name in CONFIG["matrix"]["scene"][1:]:
            (self.folder / name).write_text(BALL)
        (self.folder / "c.json").write_text(json.dumps(CONFIG))
        result = self.run_in_folder(RAYMETER, "run", "c.json", "--out", "r", "--progress", "none")
        self.assertEqual(result.returncode, 0, result.stderr)
        return self.folder / "r"

    def images(self, *words: str | Path) -> subprocess.CompletedProcess:
        return self.run_in_folder(ROOT / "scripts" / "images", *words)

    def test_a_picture_a_scene_and_two_heat_maps_a_technique(self) -> None:
        run = self.measure()
        result = self.images(RAYMETER, run)
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))
        heat = ["bvh-nodes", "bvh-nodes-2", "bvh-tests", "bvh-tests-2", "grid-nodes", "grid-tests"]
        wanted = ["spd-tetra-2", *(f"spd-tetra-2-{one}" for one in heat), "scene-one-nff", *(f"scene-one-nff-{one}" for one in heat), "scene-one-nff-2"]
        self.assertEqual(sorted(path.name for path in (run / "images").iterdir()), sorted(f"{name}.{kind}" for name in wanted for kind in ("png", "json")))
        for name in wanted:
            self.assertEqual(matplotlib.image.imread(run / "images" / f"{name}.png").shape[:2], (10, 20))
        stats = {name: json.loads((run / "images" / f"{name}.json").read_text()) for name in wanted}
        self.assertEqual([stats[f"spd-tetra-2-bvh-{one}"]["params"]["max_leaf_size"] for one in ("nodes", "nodes-2")], [1, 4])
        self.assertEqual([stats[f"spd-tetra-2-bvh-{one}"]["heatmap"]["event"] for one in ("nodes", "tests")], ["node_visits", "prim_tests"])
        self.assertEqual((stats["spd-tetra-2"]["structure"], "heatmap" in stats["spd-tetra-2"]), ("bvh", False))
        self.assertEqual((stats["scene-one-nff-2"]["scene"], stats["scene-one-nff-2"]["structure"]), ("scene-one.nff", "list"))

        self.assertEqual(self.run_in_folder(RAYMETER, "report", run).returncode, 0)
        page = (run / "report.html").read_text(encoding="utf-8")
        self.assertEqual(page.count("data:image/png;base64,"), len(wanted))
        for shown in ("bvh:max_leaf_size=1, 20 × 10 pixels.", "bvh:max_leaf_size=4, 20 × 10 pixels.", "grid, 20 × 10 pixels.", "list, 20 × 10 pixels; rays:"):
            self.assertIn(shown, page)

    def test_what_cannot_be_made_is_said(self) -> None:
        run = self.measure()
        (self.folder / "scene one.nff").unlink()
        result = self.images(RAYMETER, run)
        self.assertEqual((result.returncode, result.stdout, len(result.stderr.splitlines())), (1, "", 7), result)
        self.assertIn("scene one.nff: no such file", result.stderr)
        self.assertEqual(len(list((run / "images").iterdir())), 16)

    def test_scenes_that_the_name_does_not_give(self) -> None:
        (self.folder / "a.nff").write_text(BALL)
        scenes = [{"file": "gone.nff", "optional": True}, {"name": "named", "file": "a.nff"}, {"name": "seen", "file": "a.nff", "view": {"eye": [0, 0, 9], "look_at": [0, 0, 0]}}]
        matrix = {**CONFIG["matrix"], "scene": scenes, "structure": [{"name": "list"}]}
        (self.folder / "c.json").write_text(json.dumps({**CONFIG, "matrix": matrix, "exclude": []}))
        self.assertEqual(self.run_in_folder(RAYMETER, "run", "c.json", "--out", "r", "--progress", "none").returncode, 0)
        result = self.images(RAYMETER, self.folder / "r")
        self.assertEqual((result.returncode, len(result.stderr.splitlines())), (0, 2), result.stderr)
        self.assertIn("no pictures of gone.nff: it was not there", result.stderr)
        self.assertEqual(sorted(path.name for path in (self.folder / "r" / "images").iterdir()), ["named.json", "named.png"])

    def test_no_run(self) -> None:
        for words in ([], [RAYMETER], ["--fly"], [RAYMETER, "absent"]):
            result = self.images(*words)
            self.assertEqual((result.returncode, result.stdout), (2, ""), result)
        self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    RAYMETER = str(Path(sys.argv.pop(1)).resolve())
    unittest.main()
