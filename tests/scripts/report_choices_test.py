#!/usr/bin/python3
"""Tests of what the report chooses: labels, settings, sweeps, combined runs, rounding."""

import math
import sys
import unittest
import xml.etree.ElementTree
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

import synthetic_run
from raymeter_report import best_settings, cells, drafts, figure_best, figure_sweep, numbers, records, style, tables
from report_support import TemporaryFolder, run_cli


class SeveralRuns(TemporaryFolder):
    """Combined reports."""

    def test_shards_merge_and_repeats_are_told_apart(self) -> None:
        first, second = self.folder / "one", self.folder / "two"
        synthetic_run.write_run(first, scenes=["spd:tetra:6"])
        synthetic_run.write_run(second, scenes=["spd:balls:4"])
        merged = cells.load_cells([records.read_run(first), records.read_run(second)])
        self.assertEqual(cells.techniques_of(merged), ["list", "bvh", "grid"])
        self.assertEqual(cells.scenes_of(merged), ["spd:tetra:6", "spd:balls:4"])
        repeated = cells.load_cells([records.read_run(first), records.read_run(first.rename(self.folder / "again"))])
        self.assertEqual({cell.label for cell in repeated if cell.run == "again"}, {"list @again", "bvh @again", "grid @again"})

    def test_combined_report_leaves_the_runs_alone(self) -> None:
        first, second = self.folder / "one", self.folder / "two"
        synthetic_run.write_run(first, scenes=["spd:tetra:6"])
        synthetic_run.write_run(second, scenes=["spd:balls:4"])
        self.assertEqual(run_cli(first, second)[0], 0)
        self.assertTrue((first / "combined" / "report.html").is_file())
        self.assertFalse((first / "report.html").exists())


class Choices(TemporaryFolder):
    """Labels, settings and sweeps of larger matrices."""

    def matrix(self, **arguments: object) -> list[cells.Cell]:
        synthetic_run.write_run(self.folder, **arguments)  # type: ignore[arg-type]
        return cells.load_cells([records.read_run(self.folder)])

    def test_labels_hold_what_varies(self) -> None:
        variants = {"list": "volume=none", "grid": "density=2,max_resolution=256", "grid#8": "density=8,max_resolution=256"}
        matrix = self.matrix(structures=variants, scenes=["spd:tetra:6"])
        self.assertEqual(cells.techniques_of(matrix), ["list", "grid:density=2", "grid:density=8"])
        looks = style.looks(matrix)
        self.assertEqual(len({look.colour for look in looks.values()}), 3)

    def test_main_setting_is_the_widest_isa_on_one_thread(self) -> None:
        matrix = self.matrix(isas=["scalar", "avx2", "avx512"], packets=[1, 8], threads=[1, 2], scenes=["spd:tetra:6"])
        self.assertEqual(cells.main_setting(matrix), {"isa": "avx2", "threads": 1.0, "max_depth": 5.0, "min_weight": 0.0, "packet": 8.0})

    def test_sweep_is_relative_to_its_first_value(self) -> None:
        matrix = self.matrix(isas=["scalar", "avx2"], packets=[8], threads=[1, 2], scenes=["spd:tetra:6", "spd:balls:4"])
        sweep = figure_sweep.sweep(matrix, "threads")
        assert sweep is not None
        mean = sweep.mean("primary", "bvh")
        self.assertEqual((list(mean), mean[1.0]), ([1.0, 2.0], 1.0))
        chosen = [cell for cell in matrix if (cell.label, cell.rays, cell.summary["isa"]) == ("bvh", "primary", "avx2")]
        speeds = {(cell.scene, cell.summary["threads"]): cell.number("mrays_per_s") or 0 for cell in chosen}
        expected = math.sqrt(math.prod(speeds[scene, 2.0] / speeds[scene, 1.0] for scene in ("spd:tetra:6", "spd:balls:4")))
        self.assertAlmostEqual(mean[2.0], expected, places=12)  # the same doubles in another order
        self.assertIsNone(figure_sweep.sweep(matrix, "packet"))

    def test_sweep_figures_follow_the_data(self) -> None:
        matrix = self.matrix(isas=["scalar", "avx2"], packets=[1, 8], threads=[1, 2], scenes=["spd:tetra:6"])
        with style.styled():
            names = [draft.name for draft in drafts.sweep_drafts(matrix, style.looks(matrix))]
        self.assertEqual(names, ["isa_speedup", "packet_speedup", "thread_scaling"])
        table = tables.simd_table(matrix)
        assert table is not None
        self.assertEqual([column.title for column in table.columns][3:], ["scalar", "avx2"])

    def test_side_by_side_takes_each_structure_at_its_fastest(self) -> None:
        variants = {"list": "volume=none", "bvh": "volume=aabb,builder=binned_sah", "grid": "density=2,max_resolution=256", "grid#8": "density=8,max_resolution=1024"}
        matrix = self.matrix(packets=[1, 8], threads=[1, 2], structures=variants, scenes=["spd:tetra:6", "spd:balls:4"])
        best = best_settings.best_settings(matrix)
        self.assertEqual(list(best)[:2], [("primary", "spd:tetra:6"), ("primary", "spd:balls:4")])
        for (rays, scene), chosen in best.items():
            self.assertEqual([cell.technique[0] for cell in chosen], ["list", "bvh", "grid"])
            for cell in chosen:
                others = [one for one in matrix if (one.rays, one.scene, one.technique[0], one.summary["threads"]) == (rays, scene, cell.technique[0], 1.0)]
                self.assertEqual(cell.number("median_ns_per_ray"), min(one.number("median_ns_per_ray") for one in others if one.state == "ok"))
        bvh, grid = best["primary", "spd:tetra:6"][1:]
        # A grid's cells are counted as nodes already; a hierarchy's leaves come on top.
        self.assertAlmostEqual(best_settings.steps_per_ray(bvh) or 0, (bvh.number("node_visits_per_ray") or 0) * 4 / 3, places=3)
        self.assertAlmostEqual(best_settings.steps_per_ray(grid) or 0, grid.number("node_visits_per_ray") or 0, places=3)
        self.assertEqual(best_settings.setting_of(bvh, ["packet"]), "packet 8")
        with style.styled():
            names = [draft.name for draft in drafts.best_drafts(matrix, style.looks(matrix))]
        self.assertEqual(names, ["side_by_side_primary", "side_by_side_shadow", "side_by_side_diffuse"])
        self.assertEqual(len(best_settings.best_settings_table(matrix).rows), 18)

    def test_side_by_side_shows_long_settings_whole(self) -> None:
        structures = {"list": "volume=none", "grid": "density=1,top_density=1,rule=cubic,levels=2,max_leaf_size=16,mailbox=true"}
        structures |= {f"grid#{density}": f"density={density},top_density=0.125,rule=square,levels=3,max_leaf_size=1024,mailbox=false" for density in (2, 4)}
        matrix = self.matrix(packets=[64], structures=structures, scenes=["spd:tetra:6"])
        best = [cell for cell in matrix if (cell.rays, cell.state) == ("primary", "ok")]
        with style.styled():
            figure = figure_best.best_figure({"spd:tetra:6": best}, ["packet"], style.looks(matrix))
            page = figure.bbox
            shown = [text for axes in figure.axes for text in axes.texts]
            for text in shown:
                extent = text.get_window_extent(figure.canvas.get_renderer())
                self.assertTrue(page.x0 <= extent.x0 and extent.x1 <= page.x1, text.get_text())
        settings = [text.get_text().replace("\n", " ").replace("\N{NO-BREAK SPACE}", " ") for text in shown]
        self.assertEqual(settings, [best_settings.setting_of(cell, ["packet"]) for cell in best])
        self.assertGreater(max(map(len, settings)), 80)

    def test_side_by_side_needs_a_choice_of_settings(self) -> None:
        self.assertEqual(best_settings.best_settings(self.matrix()), {})

    def test_a_page_gets_tables_and_figures_and_keeps_its_words(self) -> None:
        variants = {"list": "volume=none", "bvh": "volume=aabb", "grid": "density=2,max_resolution=256", "grid#8": "density=8,max_resolution=1024"}
        matrix = self.matrix(structures=variants, scenes=["spd:tetra:6", "spd:gears:4"])
        page = self.folder / "page.md"
        name = "side_by_side_diffuse_tracing"
        page.write_text(f"Before.\n\n![Rays](side_by_side_diffuse.svg)\n\n<!-- table {name} -->\nold\n<!-- end -->\n\nAfter.\n", encoding="utf-8")
        self.assertEqual(run_cli("--page", page, self.folder)[0], 0)
        code, printed, _ = run_cli("--page", page, self.folder)  # what it wrote it finds again
        self.assertEqual((code, printed.split()), (0, [str(page), str(self.folder / "side_by_side_diffuse.svg")]))
        text = page.read_text(encoding="utf-8")
        lines = text.splitlines()
        self.assertEqual((lines[0], lines[-1], "old" in text), ("Before.", "After.", False))
        self.assertIn("| technique | tetra:6 [4.1k primitives] | gears:4 [9.34k primitives] |", lines)
        grids = [cell for cell in matrix if (cell.technique[0], cell.rays, cell.scene, cell.state) == ("grid", "diffuse", "spd:tetra:6", "ok")]
        best = min(grids, key=lambda cell: cell.number("median_ns_per_ray") or 0)
        values = [best.number("prim_tests_per_ray"), best_settings.steps_per_ray(best), best.number("median_ns_per_ray")]
        shown = " / ".join(numbers.significant(value) for value in values)
        grid = next(line for line in lines if line.startswith("| grid |")).split(" | ")
        self.assertEqual(grid[1].strip("*"), shown)

    def test_a_page_that_asks_for_what_was_not_timed_stays_as_it_is(self) -> None:
        self.matrix()
        page = self.folder / "page.md"
        for text, lacking in (
            ("<!-- table side_by_side_primary_tracing -->\n<!-- end -->\n", "what was timed gives no table side_by_side_primary_tracing"),
            ("![Peer](speed_vs_peer.svg)\n", "what was timed gives no figure speed_vs_peer"),
            ("Words.\n", "has neither tables nor figures of a run"),
        ):
            page.write_text(text, encoding="utf-8")
            code, _, message = run_cli("--page", page, self.folder)
            self.assertEqual((code, message.strip(), page.read_text(encoding="utf-8")), (2, f"{page}: {lacking}", text))

    def test_readme_figure(self) -> None:
        self.matrix()
        path = self.folder / "figure.svg"
        code, printed, _ = run_cli("--readme-figure", path, self.folder)
        self.assertEqual((code, printed), (0, f"{path}\n"))
        text = path.read_text(encoding="utf-8")
        xml.etree.ElementTree.fromstring(text)
        self.assertNotIn(style.INK, text)
        self.assertIn("time per ray [ns]", text)
        self.assertEqual(run_cli("--readme-figure", path, "--figure", "mrays_per_s", self.folder)[0], 0)
        self.assertIn("million rays per second", path.read_text(encoding="utf-8"))
        code, _, message = run_cli("--readme-figure", path, "--figure", "speed_vs_peer", self.folder)
        self.assertEqual((code, message.strip()), (2, f"{self.folder}: what was timed gives no figure speed_vs_peer"))


class Numbers(unittest.TestCase):
    """Rounding."""

    def test_significant_digits(self) -> None:
        shown = {12345.678: f"12{numbers.THIN_SPACE}300", 1234.5: "1230", 9.996: "10.0", 0.012345: "0.0123", 1e-7: "1.00e-7", 0.0: "0"}
        for value, text in {**shown, math.inf: "∞", math.nan: ""}.items():
            self.assertEqual(numbers.significant(value), text)
        self.assertEqual(numbers.significant(None), "")

    def test_interval_sets_the_digits(self) -> None:
        self.assertEqual(numbers.with_interval(105.2345, 104.6123, 106.1), ("105.2", "[104.6, 106.1]"))
        self.assertEqual(numbers.with_interval(96.77, 95.0, 550.4), ("96.8", "[95.0, 550.4]"))
        thin = numbers.THIN_SPACE
        self.assertEqual(numbers.with_interval(84860.0, 84247.0, 85636.0), (f"84{thin}900", f"[84{thin}200, 85{thin}600]"))
        self.assertEqual(numbers.with_interval(105.2345, None, None), ("105.2", ""))
        self.assertEqual(numbers.with_interval(None, 1.0, 2.0), ("", ""))

    def test_axis_ticks_are_few_and_inside(self) -> None:
        for low, high in ((1e-4, 50.0), (3.0, 8.0), (1.0, 1e9), (0.9, 1.1e3)):
            ticks = style.log_ticks(low, high, 5)
            self.assertTrue(1 <= len(ticks) <= 5 and all(low <= tick <= high for tick in ticks), (low, high, ticks))


if __name__ == "__main__":
    unittest.main()
