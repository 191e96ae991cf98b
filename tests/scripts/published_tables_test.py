#!/usr/bin/python3
"""Tests scripts/published_tables on a made-up run and reference."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "published_tables"
COUNTERS = """cell_id,scene,structure,params,ray_count,rays_hit,prim_tests,node_visits,leaf_visits,empty_leaf_visits
1,spd:balls:4,octree,"max_depth=4,growth=3e-04,tracking=parametric",100,50,1000,700,400,100
2,spd:balls:4,octree,"max_depth=4,growth=0,tracking=parametric",100,50,500,700,400,100
3,gen:other_balls:4,octree,"max_depth=4,growth=3e-04,tracking=parametric",100,50,800,700,400,100
"""
BUILDS = """cell_id,interior_nodes,leaves,empty_leaves,references
1,10,71,30,500
2,10,71,30,525
3,10,71,30,600
"""
HYPOTHESES = "hypothesis,settings,scenes,params,counting\n"
HEADER = "# somebody, 1999\nsetting,scene,structure,params,counting,symbol,value\n"


class PublishedTables(unittest.TestCase):
    def table(self, lines: str, code: int = 0, hypotheses: str = "") -> str:
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            (root / "counters.csv").write_text(COUNTERS, encoding="utf-8")
            (root / "builds.csv").write_text(BUILDS, encoding="utf-8")
            (root / "reference.csv").write_text(HEADER + lines, encoding="utf-8")
            if hypotheses:
                (root / "reference_hypotheses.csv").write_text(HYPOTHESES + hypotheses, encoding="utf-8")
            done = subprocess.run([sys.executable, SCRIPT, root, root / "reference.csv"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout if code == 0 else done.stderr

    def row(self, counting: str, symbol: str, value: str) -> str:
        return f"some octree,spd:balls:4,octree,max_depth=4,{counting},{symbol},{value}\n"

    def test_counts_are_given_per_ray(self) -> None:
        self.assertIn("| spd:balls:4 | 500 / 500 (+0.0 %) | 10.00 / 10.00 (+0.0 %) |", self.table(self.row("", "N_OIV", "500") + self.row("", "N_IT", "10")))

    def test_differences_above_a_tenth_are_bold(self) -> None:
        self.assertIn("**5.00 / 10.00 (+100.0 %)**", self.table(self.row("", "N_IT", "5")))

    def test_per_hit_divides_tests_by_the_rays_that_hit(self) -> None:
        self.assertIn("20.00 / 20.00 (+0.0 %)", self.table(self.row("per_hit", "N_IT", "20")))

    def test_unhit_twice_counts_full_leaves_without_a_hit_again_as_empty(self) -> None:
        # Four leaves a ray, one of them empty; half of the rays end in one: 2.5 full leaves are crossed in vain.
        text = self.table(self.row("unhit_twice", "N_ETS", "6.5") + self.row("unhit_twice", "N_EETS", "3.5"))
        self.assertIn("6.50 / 6.50 (+0.0 %) | 3.50 / 3.50 (+0.0 %)", text)

    def test_scenes_may_come_from_several_runs(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            header, *lines = COUNTERS.splitlines(keepends=True)
            unmeasured = '1,spd:balls:4,octree,"max_depth=4,growth=3e-04,tracking=parametric",,,,,,\n'
            for run, text, references in (("a", unmeasured + lines[2], "500"), ("b", lines[0], "510")):
                (root / run).mkdir()
                (root / run / "counters.csv").write_text(header + text, encoding="utf-8")
                (root / run / "builds.csv").write_text(BUILDS.replace(",500\n", f",{references}\n"), encoding="utf-8")
            (root / "reference.csv").write_text(HEADER + self.row("", "N_OIV", "510") + self.row("", "N_IT", "10"), encoding="utf-8")
            command = [sys.executable, SCRIPT, root / "a", root / "b", root / "reference.csv", root / "out.md"]
            subprocess.run(command, check=True)
            text = (root / "out.md").read_text(encoding="utf-8")
            self.assertIn("| spd:balls:4 | 510 / 510 (+0.0 %) | 10.00 / 10.00 (+0.0 %) |", text)
            self.assertIn("from 2 runs of", text)

    def test_an_unknown_counting_is_an_error(self) -> None:
        self.assertIn("unknown counting 'by_guess'; expected some of per_hit, unhit_twice", self.table(self.row("by_guess", "N_IT", "5"), code=2))

    def test_rows_of_one_scene_are_told_apart_by_their_parameters(self) -> None:
        text = self.table(self.row("", "N_IT", "10") + "some octree,spd:balls:4,octree,max_depth=4;tracking=neighbour,,N_IT,10\n")
        self.assertIn("| spd:balls:4 | 10.00 / 10.00 (+0.0 %) |", text)
        self.assertIn("| spd:balls:4, tracking=neighbour | not measured |", text)

    def test_an_unknown_symbol_is_an_error(self) -> None:
        self.assertIn("unknown symbol 'N_XY'", self.table(self.row("", "N_XY", "5"), code=2))

    def test_numbers_are_equal_however_they_are_written(self) -> None:
        self.assertIn("10.00 / 10.00", self.table("some octree,spd:balls:4,octree,growth=0.0003,,N_IT,10\n"))
        self.assertIn("not measured", self.table("some octree,spd:balls:4,octree,growth=0.0004,,N_IT,10\n"))

    def test_what_was_not_measured_is_said(self) -> None:
        self.assertIn("not measured", self.table("some octree,spd:gears:4,octree,max_depth=4,,N_IT,5\n"))

    def test_hypotheses_follow_under_the_settings_and_scenes_that_they_name(self) -> None:
        lines = self.row("", "N_IT", "5") + self.row("", "N_OIV", "500") + "another octree,spd:balls:4,octree,max_depth=4,,N_IT,10\n"
        text = self.table(lines, hypotheses="no growth,some*,spd:*,growth=0,\nother balls,some*,*;spd:*,scene=gen:other_balls:4,\nno balls,*,spd:gears:*,,\n")
        self.assertIn("| spd:balls:4: no growth | 500 / 525 (+5.0 %) | 5.00 / 5.00 (+0.0 %) |", text)
        self.assertIn("| spd:balls:4: other balls | **500 / 600 (+20.0 %)** | **5.00 / 8.00 (+60.0 %)** |", text)
        self.assertEqual(text.count("no growth"), 1)
        self.assertNotIn("no balls", text)

    def test_a_hypothesis_may_be_about_what_is_counted(self) -> None:
        text = self.table(self.row("per_hit", "N_IT", "20"), hypotheses="per ray,*,*,,none\n")
        self.assertIn("| spd:balls:4: per ray | **20.00 / 10.00 (-50.0 %)** |", text)
        self.assertIn("unknown counting 'by_guess'", self.table(self.row("", "N_IT", "5"), code=2, hypotheses="a guess,*,*,,by_guess\n"))

    def test_the_end_says_which_figures_are_off_and_have_no_hypothesis(self) -> None:
        lines = self.row("", "N_IT", "5") + self.row("", "N_TS", "2") + self.row("", "N_OIV", "500")
        text = self.table(lines, hypotheses="no growth,*,*,growth=0,\n")
        self.assertIn("2 of 3 figures are off by more than 10 %. 1 of these have rows of hypotheses that change them, 1 are within 10 % by one of them; 1 have none: "
                      "some octree, spd:balls:4: N_TS.", text)
        self.assertNotIn("How many", self.table(lines))


if __name__ == "__main__":
    unittest.main()
