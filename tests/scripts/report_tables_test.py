#!/usr/bin/python3
"""Tests of what tables and figures of the report compute: of caches, peers, growth, ingredients, hard cases, other rays, packets."""

import json
import math
import sys
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

import synthetic_run
from raymeter_report import cells, drafts, figure_cases, figure_peer, figure_reference, figure_simd, hard_cases, numbers, peer, price_list, records, scaling, shadow_cache, style
from report_support import TemporaryFolder, run_cli


class ShadowCache(unittest.TestCase):
    """What the cache answers and saves."""

    def cell(self, occlusion: str, nanoseconds: float, **counts: float) -> cells.Cell:
        summary = dict(scene="s", rays="shadow", phase="any", structure="bvh", params="", first_hit="cast", occlusion=occlusion, isa="avx2", packet=16.0)
        summary |= dict(threads=1.0, max_depth=5.0, min_weight=0.0, status="ok", median_ns_per_ray=nanoseconds)
        return cells.Cell("run", summary, {}, {}, {}, shadow=dict(ray_count=100.0, rays_hit=50.0, **counts))

    def test_tests_saved_and_time_are_against_the_same_cell_without_it(self) -> None:
        plain = self.cell("none", 40.0, prim_tests=200.0)
        cached = self.cell("shadow_cache:key=light", 50.0, prim_tests=120.0, cache_tests=60.0, cache_hits=25.0, cache_hit_rate=0.25, cache_hit_rate_blocked=0.5)
        table = shadow_cache.shadow_cache_table([plain, cached])
        self.assertEqual(len(table.rows), 1)
        values = {column.title: field.value for column, field in zip(table.columns, table.rows[0])}
        self.assertEqual((values["hits of all"], values["hits of blocked"]), (25.0, 50.0))
        self.assertAlmostEqual(values["tests saved"], 10.0)
        self.assertEqual((values["shadow ray"], values["time without"]), (50.0, 1.25))

    def test_there_is_no_table_without_a_cache(self) -> None:
        self.assertFalse(shadow_cache.shadow_cache_table([self.cell("none", 40.0, prim_tests=200.0)]).rows)

    def test_labels_hold_what_varies_in_every_slot(self) -> None:
        of_keys = [self.cell(f"shadow_cache:key={key},batch=4096", 1.0) for key in ("light", "light_object")] + [self.cell("none", 1.0)]
        cells._label(of_keys)
        self.assertEqual([cell.label for cell in of_keys], ["bvh+shadow_cache:key=light", "bvh+shadow_cache:key=light_object", "bvh"])


class Peer(unittest.TestCase):
    """Ratios to the peer's best setting, and its time without conversion."""

    def cell(self, scene: str, params: str, times: list[float], prepare: float = 0.0, needs: str = "triangle lights", rays: str = "primary") -> cells.Cell:
        structure = "embree" if "mode" in params else "bvh"
        summary = dict(scene=scene, rays=rays, phase="closest", structure=structure, params=params, first_hit="cast", occlusion="none", isa="avx2", packet=16.0)
        summary |= dict(threads=1.0, max_depth=5.0, min_weight=0.0, status="ok", median_ns_per_ray=sorted(times)[len(times) // 2], needs=needs, num_prims=9.0, hit_mismatch=3.0)
        samples = {float(i): dict(ns_per_ray=time, trace_ms=time, prepare_ms=prepare, rays_traced=1e6) for i, time in enumerate(times)}
        return cells.Cell("run", summary, {}, {}, {}, samples=samples)

    def run_of(self, scene: str, own: float, needs: str = "triangle lights") -> list[cells.Cell]:
        return [
            self.cell(scene, "traversal=beam", [own] * 7, needs=needs),
            self.cell(scene, "mode=best,robust=false,quality=medium,layout=slice; mode=packet16,coherence=coherent", [20.0] * 6 + [40.0], needs=needs),
            self.cell(scene, "mode=best,robust=false,quality=medium,layout=ahead; mode=stream,coherence=coherent", [30.0] * 7, prepare=14.0, needs=needs),
            self.cell(scene, "mode=best,robust=true,quality=medium,layout=slice; mode=packet8,coherence=coherent", [25.0] * 7, needs=needs),
        ]

    def test_labels_leave_out_what_a_structure_chose(self) -> None:
        both = [self.cell("s", f"mode=best,robust=false; mode={mode}", [1.0]) for mode in ("packet16", "stream")]
        cells._label(both)
        self.assertEqual([(cell.label, cell.choice) for cell in both], [("embree", "mode=packet16"), ("embree", "mode=stream")])

    def test_ratios_are_to_the_best_setting_round_by_round(self) -> None:
        found = peer.duels(self.run_of("s", 10.0))
        self.assertEqual([len(found[kind]) for kind in peer.KINDS], [1, 1])
        fast, robust = found["fast"][0], found["robust"][0]
        self.assertEqual((fast.rival.choice, fast.ratio), ("mode=packet16,coherence=coherent", peer.Ratio(2.0, 2.0, 4.0)))
        self.assertEqual((robust.ratio.value, robust.unconverted), (2.5, None))
        self.assertEqual(fast.unconverted, 16.0)

    def test_means_are_over_scenes_of_triangles_alone(self) -> None:
        all_of = self.run_of("a", 10.0) + self.run_of("b", 40.0) + self.run_of("c", 1.0, needs="sphere triangle")
        cells._label(all_of)
        found = peer.duels(all_of)
        self.assertAlmostEqual(peer.means(found["fast"])["primary", "avx2", "bvh"], 1.0)
        table = peer.peer_table(all_of)
        self.assertEqual([row[0].text for row in table.rows], ["a", "b", "c", peer.MEAN])
        drawn = figure_peer.peer_figure(figure_peer.peer_duels(all_of), {}, style.looks(all_of))
        self.assertEqual([text.get_text() for text in drawn.axes[0].get_yticklabels()], ["a", "b", "c", peer.MEAN])

    def test_there_is_none_without_a_peer(self) -> None:
        self.assertFalse(peer.peer_table(self.run_of("s", 10.0)[:1]).rows)

    def test_interval_of_the_median(self) -> None:
        self.assertIsNone(numbers.median_interval([1.0] * 5))
        self.assertEqual(numbers.median_interval([6.0, 5.0, 4.0, 3.0, 2.0, 1.0]), (1.0, 6.0))
        self.assertEqual(numbers.median_interval([float(i) for i in range(1, 10)]), (2.0, 8.0))


class Growths(unittest.TestCase):
    """Costs against the number of primitives."""

    def cell(self, size: int, nanoseconds: float, threads: float = 1.0) -> cells.Cell:
        summary = dict(scene=f"gen:cloud:{size}", rays="primary", phase="closest", structure="bvh", params="", first_hit="cast", occlusion="none", isa="avx2", packet=16.0)
        summary |= dict(threads=threads, max_depth=5.0, min_weight=0.0, status="ok", median_ns_per_ray=nanoseconds, num_prims=float(size))
        return cells.Cell("run", summary, dict(build_ms=size * 1e-3, bytes_per_prim=80.0), {}, {})

    def test_exponents_of_known_powers(self) -> None:
        table = scaling.scaling_table(self.labelled([self.cell(10**d, 5.0 * 10 ** (0.5 * d), threads) for d in (3, 4, 5, 6) for threads in (1.0, 2.0)]))
        exponents = {(row[1].text, row[3].text): (row[-2].value, row[-1].value) for row in table.rows}
        self.assertEqual(set(exponents), {("primary", "1"), ("primary", "2"), (scaling.BUILD, "1"), (scaling.BUILD, "2"), (scaling.MEMORY, "1")})
        for key, exponent in ((("primary", "1"), 0.5), ((scaling.BUILD, "2"), 1.0), ((scaling.MEMORY, "1"), 0.0)):
            self.assertAlmostEqual(exponents[key][0], exponent)
            self.assertAlmostEqual(exponents[key][1], 0.0)

    def test_interval_is_students(self) -> None:
        power = scaling.fitted([(1.0, 1.0), (math.e, math.e**2), (math.e**2, math.e)])  # logarithms (0, 0), (1, 2), (2, 1): slope 1/2, residuals 1/2, -1, 1/2
        self.assertAlmostEqual(power.exponent, 0.5)
        self.assertAlmostEqual(power.half_width, 12.706 * math.sqrt(1.5 / 2))
        self.assertIsNone(scaling.fitted([(1.0, 1.0), (2.0, 2.0)]).half_width)

    def test_two_sizes_are_no_family(self) -> None:
        self.assertEqual(scaling.growths(self.labelled([self.cell(1000, 1.0), self.cell(10000, 1.0)])), [])

    def labelled(self, all_of: list[cells.Cell]) -> list[cells.Cell]:
        cells._label(all_of)
        return all_of


class PriceList(TemporaryFolder):
    """Ingredients that a config names."""

    def test_an_ingredient_is_the_ratio_of_the_fastest_cells_that_its_patterns_fit(self) -> None:
        synthetic_run.write_run(self.folder, isas=["sse42", "avx2"])
        manifest = self.folder / "manifest.json"
        document = json.loads(manifest.read_text())
        trees = {"name": "trees", "with": {"structure.builder": "binned_sah", "isa": ["avx2"]}, "without": {"structure.name": "list", "isa": "avx2"}}
        lanes = {"name": "lanes", "with": {"isa": "avx2"}, "without": {"isa": "sse42"}}
        nothing = {"name": "nothing", "with": {"structure.density": 5}, "without": {"isa": "sse42"}}
        for ingredients in ([], [trees, lanes, nothing]):
            document["config_text"] = {"report": {"ingredients": ingredients}}
            manifest.write_text(json.dumps(document))
            runs = [records.read_run(self.folder)]
            all_of = cells.load_cells(runs)
            found = price_list.price_list(runs, all_of)
            self.assertEqual(price_list.names_in_order(found), ["trees", "lanes"] if ingredients else [])

        def price(name: str) -> float:
            return next(one for one in found if (one.scene, one.rays, one.ingredient) == ("spd:balls:4", "primary", name)).ratio.value

        here = [cell for cell in all_of if (cell.scene, cell.rays) == ("spd:balls:4", "primary")]
        time = {(cell.label, cell.summary["isa"]): cell.number("median_ns_per_ray") or 0.0 for cell in here}
        self.assertAlmostEqual(price("trees") / (time["list", "avx2"] / time["bvh", "avx2"]), 1.0, delta=0.05)
        least = {isa: min(value for (_, of), value in time.items() if of == isa) for isa in ("sse42", "avx2")}
        self.assertAlmostEqual(price("lanes") / (least["sse42"] / least["avx2"]), 1.0, delta=0.05)
        self.assertEqual(run_cli(self.folder)[0], 0)
        self.assertTrue((self.folder / "plots" / "price_list.svg").is_file())


class HardCases(unittest.TestCase):
    """Case by technique."""

    def cell(self, scene: str, structure: str, isa: str, status: str = "ok", **accuracy: float) -> cells.Cell:
        summary = dict(scene=scene, rays="case", phase="closest", structure=structure, params="", first_hit="cast", occlusion="none", isa=isa, packet=16.0)
        summary |= dict(threads=1.0, max_depth=5.0, min_weight=0.0, status=status)
        return cells.Cell("run", summary, {}, {}, dict(rays_checked=100.0, false_miss=0.0, false_hit=0.0, wrong_prim=0.0, **accuracy), label=structure)

    def test_a_field_holds_the_worst_of_its_settings(self) -> None:
        some = [self.cell("hard:ties", "bvh", "avx2", t_ulp_max=0.5), self.cell("hard:ties", "bvh", "sse42", t_ulp_max=2.0),
                self.cell("hard:ties", "grid", "avx2", status="wrong", self_hits=3.0), self.cell("hard:cones", "bvh", "avx2")]
        some[2].accuracy["false_miss"] = 7.0
        table = hard_cases.hard_cases_table(some)
        self.assertEqual([column.title for column in table.columns], ["case", "rays", "bvh", "grid"])
        self.assertEqual([field.text for field in table.rows[0]], ["ties", "100", "0; 2.00 ulp", "7 / 0 / 0, 3 self-hits"])
        self.assertEqual([field.tone for field in table.rows[0]], ["", "", "", "bad"])
        self.assertEqual([field.text for field in table.rows[1]], ["cones", "100", "0", ""])

    def test_the_figure_sets_excused_answers_off(self) -> None:
        some = [self.cell("hard:garbage", "bvh", "avx2"), self.cell("hard:garbage", "grid", "avx2", status="wrong"), self.cell("hard:garbage", "embree", "avx2"),
                self.cell("hard:ties", "bvh", "avx2")]
        for cell, wrong in zip(some, (13.0, 7.0, 5.0)):
            cell.accuracy["false_hit"] = wrong
        with style.styled():
            axes = figure_cases.cases_figure(some).axes[0]
        self.assertEqual([text.get_text() for text in axes.texts], ["(13)", "7", "5", "0"])
        self.assertEqual([label.get_text() for label in axes.get_yticklabels()], ["garbage", "ties"])


class OtherRays(unittest.TestCase):
    """Time against that of the same technique on other rays."""

    def test_only_where_the_reference_differs_in_its_rays_alone(self) -> None:
        def cell(rays: str, **more: float) -> cells.Cell:
            summary = dict(scene="spd:balls:4", rays=rays, phase="closest", structure="bvh", params="", first_hit="cast", occlusion="none", isa="avx2", packet=16.0, status="ok", ratio_vs_ref=None, ratio_lo=None, ratio_hi=None)
            return cells.Cell("run", summary | more, {}, {}, {}, label="bvh", rays=rays)

        some = [cell("primary", ratio_vs_ref=1.0), cell("invalid", ratio_vs_ref=1.2, ratio_lo=1.1, ratio_hi=1.3), cell("invalid")]
        for reference, expected in (({"rays": "primary"}, [some[1]]), ({"rays": "primary", "isa": "scalar"}, []), (None, [])):
            run = records.Run(Path("run"), {"config_text": {"measure": {"reference": reference}}})
            self.assertEqual(figure_reference.against_other_rays([run], some), expected)
        with style.styled():
            self.assertEqual(len(figure_reference.reference_figure([some[1]]).axes), 1)


class OneRay(unittest.TestCase):
    """Speed against one ray at a time."""

    def test_the_largest_packets_on_as_many_threads(self) -> None:
        def cell(isa: str, packet: float, threads: float, ratio: float | None, **more: str) -> cells.Cell:
            summary = dict(scene="spd:balls:4", num_prims=7.0, rays="primary", phase="closest", structure="octree", params="", first_hit="cast", occlusion="none", isa=isa, packet=packet,
                           threads=threads, status="ok", ratio_vs_ref=ratio, ratio_lo=0.2, ratio_hi=0.5)
            return cells.Cell("run", summary | more, {}, {}, {}, label="octree:leaf_size=32", rays="primary")

        wide, wrong = cell("avx2", 64.0, 1.0, 0.25), cell("avx512", 64.0, 1.0, None, status="wrong")
        some = [cell("scalar", 1.0, 1.0, 1.0), cell("scalar", 16.0, 1.0, 0.9), wide, cell("avx2", 64.0, 2.0, 0.13), cell("avx512", 64.0, 1.0, None), wrong]
        for reference, expected in (
            ({"isa": "scalar", "packet": 1, "threads": 1}, [wide, wrong]), ({"isa": "scalar", "packet": 16, "threads": 1}, []), ({"isa": "scalar", "packet": 1}, []), (None, [])
        ):
            run = records.Run(Path("run"), {"config_text": {"measure": {"reference": reference}}})
            self.assertEqual(figure_simd.against_one_ray([run], some), expected)
        dot = figure_simd.speed_up(wide)
        self.assertEqual((dot.scene, dot.technique, dot.value, dot.low, dot.high), ("octree\nleaf_size=32", "avx2", 4.0, 2.0, 5.0))
        run = records.Run(Path("run"), {"config_text": {"measure": {"reference": {"isa": "scalar", "packet": 1, "threads": 1}}}})
        with style.styled():
            draft = drafts.simd_draft([run], some)
        assert draft is not None
        (axes,) = draft.figure.axes
        self.assertEqual([label.get_text() for label in axes.get_yticklabels()], ["octree\nleaf_size=32"])
        self.assertEqual([text.get_text() for text in draft.figure.legends[0].get_texts()], ["avx2", "failed: no value"])
        self.assertIn("packets of 64 rays are on each instruction set as one ray at a time on the scalar one", draft.caption)

    def test_each_run_has_its_own_largest_packets(self) -> None:
        runs = [records.Run(Path(name), {"config_text": {"measure": {"reference": {"isa": "scalar", "packet": 1, "threads": 1}}}}) for name in ("a", "b")]
        summary = dict(scene="s", threads=1.0, status="ok", ratio_vs_ref=0.5)
        some = [cells.Cell(run, summary | dict(packet=packet), {}, {}, {}) for run, packet in (("a", 64.0), ("a", 16.0), ("b", 16.0), ("b", 1.0))]
        self.assertEqual(figure_simd.against_one_ray(runs, some), [some[0], some[2]])

    def test_without_packets_there_is_nothing_to_show(self) -> None:
        self.assertEqual(figure_simd.against_one_ray([], []), [])


if __name__ == "__main__":
    unittest.main()
