#!/usr/bin/python3
"""Tests of what the report makes of settings that may be wrong: points, front, price."""

import sys
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

import synthetic_run  # noqa: F401: puts the report on the path
from raymeter_report import cells, drafts, drafts_numerics, figure_bounds, figure_offsets, figure_precision, figure_walks, figure_wrong, style, work_precision

USUAL = "volume=aabb,box_test=padded,triangle_test=woop_kahan,sphere_test=robust"


def cell(params: str, times: list[float], wrong: float = 0.0, scene: str = "s", rays: str = "vertices", first_hit: str = "cast") -> cells.Cell:
    """Timed once a round; the middle of `times` is the median."""
    middle = sorted(times)[len(times) // 2]
    summary = dict(scene=scene, rays=rays, phase="closest", structure="bvh", params=params, first_hit=first_hit, occlusion="none", isa="avx2", packet=16.0, num_prims=9.0)
    summary |= dict(threads=1.0, max_depth=5.0, min_weight=0.0, status="ok", median_ns_per_ray=middle, ci_lo=min(times), ci_hi=max(times), mrays_per_s=1e3 / middle)
    samples = {float(i): dict(ns_per_ray=time) for i, time in enumerate(times)}
    accuracy = dict(rays_checked=1e6, false_miss=wrong, false_hit=0.0, wrong_prim=0.0)
    return cells.Cell("run", summary, {}, {}, accuracy, samples=samples, rays=rays)


def some_cells() -> list[cells.Cell]:
    return [
        cell(USUAL, [50.0, 51.0, 52.0]),
        cell(USUAL.replace("padded", "unpadded"), [48.0, 49.0, 51.0], 300.0),
        cell(USUAL.replace("padded", "fma"), [60.0, 61.0, 62.0], 900.0),
        cell(USUAL.replace("woop_kahan", "moeller_trumbore,precision=float"), [45.0, 46.0, 47.0], 130000.0),
    ]


class WorkPrecision(unittest.TestCase):
    def test_points_are_told_by_what_was_turned(self) -> None:
        points = work_precision.work_precision(some_cells())["s", "vertices"]
        self.assertEqual([point.knob for point in points], ["", "box_test", "box_test", "triangle_test"])
        self.assertEqual(points[1].label, "box_test=unpadded")
        self.assertEqual([point.error for point in points], [0.0, 3e-4, 9e-4, 0.13])

    def test_the_number_among_several_is_the_step_along_a_line(self) -> None:
        unpadded = USUAL.replace("box_test=padded", "box_test=unpadded,box_padding={},reciprocal={}")
        turned = (("0", "newton", 300.0), ("2", "newton", 40.0), ("12", "newton", 0.0), ("0", "divide", 90.0))
        found = [cell(USUAL, [50.0]), *(cell(unpadded.format(padding, reciprocal), [48.0], wrong) for padding, reciprocal, wrong in turned)]
        panels = work_precision.work_precision(found)
        points = panels["s", "vertices"]
        self.assertEqual([point.step for point in points], ["", "box_padding=0", "box_padding=2", "box_padding=12", "box_padding=0"])
        self.assertEqual([point.knob for point in points[1:]], ["reciprocal=newton"] * 3 + ["reciprocal=divide"])
        self.assertEqual(work_precision.shared_by_lines(panels), "box_test=unpadded")
        with style.styled():
            figure = figure_precision.precision_figure(panels)
        texts = [text.get_text() for text in figure.legends[0].get_texts()]
        steps = ["box_padding=0", "box_padding=2", "box_padding=12"]
        self.assertEqual(texts, [work_precision.DEFAULT, "reciprocal=newton:", "reciprocal=divide:", *steps])

    def test_what_has_no_other_value_is_not_told(self) -> None:
        found = [*some_cells(), cell(USUAL.replace("box_test=padded", "box_test=unpadded,box_padding=0"), [47.0], 3.0)]
        self.assertEqual([(point.knob, point.label, point.step) for point in work_precision.work_precision(found)["s", "vertices"]][-1], ("box_test", "box_test=unpadded", ""))

    def test_a_slot_that_most_cells_lack_is_a_knob(self) -> None:
        found = [*some_cells(), cell(USUAL, [30.0], 9.0, first_hit="zbuffer:mode=final")]
        self.assertEqual([(p.knob, p.label) for p in work_precision.work_precision(found)["s", "vertices"]][-1], ("zbuffer", "mode=final"))

    def test_a_first_hit_that_one_cell_lacks_is_a_knob(self) -> None:
        found = [cell(USUAL, [50.0]), *(cell(USUAL, [30.0], 9.0, first_hit=f"zbuffer:resolution={step}") for step in (0.5, 1, 2))]
        points = work_precision.work_precision(found)["s", "vertices"]
        self.assertEqual([(p.knob, p.label) for p in points], [("", work_precision.DEFAULT), *(("zbuffer", f"resolution={step}") for step in (0.5, 1, 2))])

    def test_front_holds_what_nothing_beats(self) -> None:
        points = work_precision.work_precision(some_cells())["s", "vertices"]
        self.assertEqual([point.error for point in work_precision.front(points)], [0.0, 3e-4, 0.13])

    def test_nothing_is_drawn_where_nothing_errs(self) -> None:
        self.assertEqual(work_precision.work_precision([cell(USUAL, [50.0])]), {})
        self.assertIsNone(drafts.precision_draft([cell(USUAL, [50.0])]))
        self.assertIsNone(drafts.price_draft([cell(USUAL, [50.0])]))

    def test_rules_of_origins_are_drawn_by_what_goes_wrong(self) -> None:
        found = [cell(USUAL, [50.0, 51.0], wrong, rays=f"diffuse:offset={rule}") for rule, wrong in (("bound", 0.0), ("0.01", 90.0), ("1e-06", 40.0), ("16ulp", 0.0))]
        found[2].accuracy["self_hits"] = 30.0
        self.assertEqual(work_precision.work_precision(found), {})
        lifted = figure_offsets.lifted_rays(found)["s", "diffuse"]
        self.assertEqual([one.rule for one in lifted], ["1e-06", "0.01", "16ulp", "bound"])
        self.assertAlmostEqual(lifted[0].self_hits, 3e-5)
        self.assertAlmostEqual(lifted[0].others or 0.0, 1e-5)
        self.assertIsNone(lifted[3].others)
        with style.styled():
            draft = drafts_numerics.offsets_draft(found)
        assert draft is not None
        self.assertEqual([label.get_text() for label in draft.figure.axes[0].get_yticklabels()], ["fixed 1e-6", "fixed 0.01", "16 ulp", "proven bound"])
        self.assertIsNone(drafts_numerics.offsets_draft(found[:1]))

    def test_walks_are_drawn_by_form_along_resolutions(self) -> None:
        found = []
        for form, missing, longest in (("recompute", 0.0, 0.0), ("accumulate", 900.0, 0.02)):
            for side in (64, 1024):
                one = cell(f"resolution={side}x{side}x4,dda={form}", [50.0, 51.0])
                one.accuracy |= dict(cell_rays_checked=1e4, cell_rays_missing=missing * side / 64, cell_rays_at_risk=missing if side > 64 else 0.0, cells_missed=missing, longest_missed=longest)
                found.append(one)
        drawn = figure_walks.walks(found)["s", "vertices"]
        self.assertEqual([(one.form, one.side) for one in drawn], [("recompute", 64), ("accumulate", 64), ("recompute", 1024), ("accumulate", 1024)])
        self.assertAlmostEqual(drawn[1].missing, 0.09)
        self.assertEqual([one.form for one in figure_walks.front(drawn[:2])], ["recompute"], "as fast, and errs less")
        with style.styled():
            draft = drafts_numerics.walks_draft(found)
        assert draft is not None
        growth, speeds = draft.figure.axes
        self.assertEqual(growth.get_yticklabels()[0].get_text(), "none")
        self.assertIn("(< 0.0003)", speeds.get_xticklabels()[0].get_text())
        self.assertEqual([text.get_text() for text in draft.figure.legends[0].get_texts()], ["recompute", "accumulate"])
        self.assertIsNone(drafts_numerics.walks_draft(found[:2]))

    def test_boxes_in_whole_steps_are_drawn_beside_floats(self) -> None:
        found = []
        for traversal in ("stream", "single"):
            for bits, visits, times in ((32, 100.0, [50.0, 52.0]), (8, 110.0, [40.0, 42.0]), (4, 200.0, [100.0, 104.0])):
                one = cell(f"traversal={traversal},plane_bits={bits}", times)
                one.counters |= dict(node_visits=visits)
                one.build |= dict(mem_bytes=400.0 * bits, num_prims=100.0)
                found.append(one)
        boxes = figure_bounds.quantised_boxes(found)["vertices"]
        self.assertEqual([(one.bits, one.visits) for one in boxes[:3]], [(32, 1.0), (8, 1.1), (4, 2.0)])
        self.assertAlmostEqual(boxes[2].speed.value if boxes[2].speed else 0.0, 0.5)
        with style.styled():
            draft = drafts_numerics.bounds_draft(found)
        assert draft is not None
        visits, speeds = draft.figure.axes
        self.assertEqual([label.get_text() for label in visits.get_xticklabels()], ["4\n16 B", "8\n32 B", "float\n128 B"])
        self.assertEqual([text.get_text() for text in speeds.texts], ["4", "8", "4", "8"])
        self.assertIsNone(drafts_numerics.bounds_draft(found[1:2]))

    def test_wrong_answers_are_the_worst_of_each_technique(self) -> None:
        found = [cell(USUAL, [50.0]), cell(USUAL, [50.0], 30.0), cell(USUAL.replace("aabb", "kdop"), [50.0])]
        for each, label in zip(found, ("bvh", "bvh", "other")):
            each.label = label
            each.summary["mrays_per_s"] = None
        wrong = figure_wrong.wrong_answers(found)["s", "vertices"]
        self.assertEqual({label: one.error for label, one in wrong.items()}, {"bvh": 3e-5, "other": 0.0})
        self.assertEqual(figure_wrong.wrong_answers(found[:1]), {})
        with style.styled():
            draft = drafts.wrong_draft(found, style.looks(found))
        assert draft is not None
        self.assertIn("(< 3e-06)", draft.figure.axes[0].get_xticklabels()[0].get_text())

    def test_price_is_against_the_fastest_weak_tests_round_by_round(self) -> None:
        price, = work_precision.prices(some_cells())
        self.assertEqual(work_precision.tests_of(price.weak), "triangle_test=moeller_trumbore, precision=float")
        self.assertAlmostEqual(price.ratio.value, 51 / 46)
        row, = work_precision.price_table(some_cells()).rows
        self.assertIn("triangle_test=moeller_trumbore", row[5].text)

    def test_another_traversal_has_a_price_of_its_own(self) -> None:
        packets = [cell(f"traversal=packet,width=0,{one.technique[1]}", [sample["ns_per_ray"] for sample in one.samples.values()]) for one in some_cells()]  # type: ignore[misc]
        found = work_precision.prices([*packets, cell("traversal=auto,group=256,volume=aabb", [23.0, 23.0, 23.5]), cell("traversal=auto,volume=kdop", [9.0])])
        self.assertEqual([price.traversal for price in found], ["packet", "auto"])
        self.assertAlmostEqual(found[1].ratio.value, 0.5)
        with style.styled():
            draft = drafts.price_draft([*packets, found[1].robust])
        assert draft is not None
        self.assertEqual([text.get_text() for text in draft.figure.legends[0].get_texts()], ["packets of 16", "traversal=auto, packets of 16"])

    def test_figures_hold_a_panel_for_each_scene_and_ray_kind(self) -> None:
        panels = work_precision.work_precision([*some_cells(), cell(USUAL, [9.0], rays="random")])
        with style.styled():
            figure = figure_precision.precision_figure(panels)
        self.assertEqual(sorted(axes.get_title("left") for axes in figure.axes), ["s, random", "s, vertices"])
        self.assertIn("(< 3e", figure.axes[0].get_xticklabels()[0].get_text().replace("3\u2009", "3"))


if __name__ == "__main__":
    unittest.main()
