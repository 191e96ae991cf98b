#!/usr/bin/python3
"""Tests of scripts/report.py on synthetic results folders: whole reports, partial runs, bad folders."""

import csv
import json
import re
import shutil
import sys
import tempfile
import unittest
import xml.etree.ElementTree
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

import synthetic_run
from raymeter_report import glossary, numbers, records
from report_support import Page, TemporaryFolder, run_cli


SECTIONS = "overview best problems left-out techniques results plots counters builds break-even accuracy images reproduce configuration environment glossary".split()
PLOTS = "tests_per_ray node_visits_per_ray mrays_per_s tests_vs_time build wrong_answers run_order".split()
# A 1 x 1 PNG.
PIXEL = bytes.fromhex(
    "89504e470d0a1a0a0000000d4948445200000001000000010802000000907753de0000000c4944415408d763f8cfc000000301010018dd8db00000000049454e44ae426082"
)


class FullReport(unittest.TestCase):
    """One report of a run with failed and skipped cells, looked at from all sides."""

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = Path(tempfile.mkdtemp(prefix="raymeter_report_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.data = synthetic_run.write_run(cls.folder)
        (cls.folder / "images").mkdir()
        (cls.folder / "images" / "balls <nodes>.png").write_bytes(PIXEL)
        (cls.folder / "images" / "tetra.png").write_bytes(PIXEL)
        stats = {"scene": "spd:tetra:6", "structure": "grid", "width": 1, "height": 1, "heatmap": {"event": "node_visits", "most": 12345, "mean": 3.14159}}
        (cls.folder / "images" / "tetra.json").write_text(json.dumps(stats), encoding="utf-8")
        cls.code, cls.printed, cls.complaints = run_cli(cls.folder)
        cls.html = (cls.folder / "report.html").read_text(encoding="utf-8")
        cls.markdown = (cls.folder / "report.md").read_text(encoding="utf-8")
        cls.page = Page(cls.html)

    def row(self, table: str, *start: str) -> list[str]:
        rows = [row for row in self.page.tables[table] if row[: len(start)] == list(start)]
        self.assertEqual(len(rows), 1, f"{table}: {start}")
        return rows[0]

    def test_succeeds_and_prints_what_it_wrote(self) -> None:
        self.assertEqual((self.code, self.complaints), (0, ""))
        paths = [Path(line) for line in self.printed.splitlines()]
        self.assertEqual(paths[:2], [self.folder / "report.md", self.folder / "report.html"])
        self.assertEqual({path.name for path in paths[2:]}, {f"{name}.{kind}" for name in PLOTS for kind in ("svg", "png", "pdf")})
        for path in paths:
            self.assertGreater(path.stat().st_size, 500, path)

    def test_every_section_is_present_and_linked(self) -> None:
        for anchor in SECTIONS + [f"plot-{name}" for name in PLOTS]:
            self.assertIn(anchor, self.page.ids)
        for reference in self.page.references:
            if reference.startswith("#"):
                self.assertIn(reference[1:], self.page.ids)
        for heading in ("Overview", "Results", "Plots", "Counters", "Builds", "Accuracy", "Images and heat maps", "Reproduce", "Glossary"):
            self.assertIn(f"## {heading}\n", self.markdown)

    def test_page_is_well_formed_with_unique_ids(self) -> None:
        self.assertEqual(self.page.errors, [])
        self.assertEqual(self.page.open, [])
        repeated = {one for one in self.page.ids if self.page.ids.count(one) > 1}
        self.assertEqual(repeated, set())

    def test_page_needs_no_network(self) -> None:
        self.assertEqual([one for one in self.page.references if re.match(r"(?i)\s*(https?:)?//", one)], [])
        self.assertNotRegex(self.html, r"(?i)@import|url\(\s*['\"]?(https?:)?//|<script|<link")

    def test_page_holds_figures_and_pictures(self) -> None:
        self.assertEqual(self.html.count("<svg"), len(PLOTS))
        self.assertIn("data:image/png;base64,iVBORw0KGgo", self.html)
        self.assertIn("balls &lt;nodes&gt;", self.html)
        heat = f"Node visits of each eye ray, from 0 (violet) to 12{numbers.THIN_SPACE}345 (yellow), mean 3.14: grid, 1 × 1 pixels."
        self.assertIn(f"<strong>spd:tetra:6</strong> {heat}", self.html)
        self.assertIn(heat, self.markdown)

    def test_overview_names_machine_and_doubts(self) -> None:
        self.assertIn("Example CPU · host testbench · commit 1a2b3c4 · begun 20261122T170000Z", self.html)
        self.assertIn("Mind when comparing times: the machine is virtual.", self.html)
        for text in (self.html, self.markdown):
            self.assertIn("git checkout 1a2b3c4\nraymeter run configs/synthetic.json\n", text)

    def test_results_hold_the_medians(self) -> None:
        columns = self.page.titles["table-results"]
        self.assertEqual([title for title in columns if title in ("ISA", "packet", "threads")], [])  # only one of each was timed
        for summary in self.data["summary"]:
            if summary["status"] == "ok":
                row = self.row("table-results", summary["scene"], summary["rays"], summary["structure"])
                shown = float(row[columns.index("time per rayns")].replace(numbers.THIN_SPACE, ""))
                # At least three significant digits are shown: half a unit of the third is 0.5 %.
                self.assertAlmostEqual(shown / summary["median_ns_per_ray"], 1.0, delta=0.005)
                self.assertEqual(row[columns.index("samples")], "15")

    def test_best_is_the_lowest_median(self) -> None:
        for row in self.page.tables["table-best"]:
            if row:
                timed = [one for one in self.data["summary"] if (one["scene"], one["rays"]) == (row[0], row[2]) and one["status"] == "ok"]
                self.assertEqual(row[3], min(timed, key=lambda one: one["median_ns_per_ray"])["structure"])

    def test_counters_are_shown_as_counted(self) -> None:
        row = self.row("table-counters", "spd:tetra:6", "primary", "list")
        self.assertIn("4096", row)  # the list tests every primitive
        self.assertEqual(row[3], f"262{numbers.THIN_SPACE}144")

    def test_break_even_is_the_runs_own(self) -> None:
        self.assertEqual(self.row("table-break-even", "spd:balls:4", "primary", "list")[-3:], ["", "never", "51\u202f200"])
        self.assertEqual(self.row("table-break-even", "spd:balls:4", "primary", "grid")[-3:], ["51\u202f200", "always", ""])

    def test_failed_cell_is_listed_without_timing(self) -> None:
        problem = self.row("table-problems", "spd:gears:4", "diffuse", "grid")
        self.assertEqual(problem[-5:], ["wrong", "4", "3", "0", "1"])
        result = self.row("table-results", "spd:gears:4", "diffuse", "grid")
        self.assertEqual(result[3:], ["", "", "", "", "wrong"])
        self.assertIn("1 cell failed", self.html)
        self.assertIn("4 wrong answers", self.html)

    def test_skipped_cells_are_counted_with_their_reason(self) -> None:
        row = self.row("table-left-out", "skipped", "avx512")
        self.assertEqual(row[2:], ["36", "spd:tetra:6, spd:balls:4, spd:gears:4, gen:terrain:512", "list, bvh, grid", "the CPU lacks avx512"])

    def test_empty_stays_empty(self) -> None:
        # The synthetic builds have no SAH cost and the images no RMSE: the columns go, and the caption says so.
        self.assertNotIn("SAH cost", self.page.titles["table-builds"])
        self.assertRegex(self.html, r"Not measured in this run: [^<]*sah_cost")
        self.assertIn("image PSNRdB", self.page.titles["table-accuracy"])
        self.assertIn("∞", self.row("table-accuracy", "spd:tetra:6", "primary", "bvh"))

    def test_markdown_tables_are_regular_and_link_the_figures(self) -> None:
        blocks = re.findall(r"(?:^\|.*\n)+", self.markdown, flags=re.MULTILINE)
        self.assertGreater(len(blocks), 10)
        for block in blocks:
            self.assertEqual(len({len(re.findall(r"(?<!\\)\|", line)) for line in block.splitlines()}), 1, block[:200])
        for name in PLOTS:
            self.assertIn(f"(plots/{name}.svg)", self.markdown)
        self.assertIn("(images/balls%20<nodes>.png)", self.markdown)

    def test_figures_are_xml_with_text_as_text(self) -> None:
        for name in PLOTS:
            root = xml.etree.ElementTree.parse(self.folder / "plots" / f"{name}.svg").getroot()
            words = "".join("".join(text.itertext()) for text in root.iter("{http://www.w3.org/2000/svg}text"))
            self.assertIn("bvh", words)

    def test_glossary_explains_every_column(self) -> None:
        explained = " ".join(term.name for terms in glossary.GLOSSARY.values() for term in terms)
        for column in {*records.KEY_COLUMNS, *(name for names in records.FILE_COLUMNS.values() for name in names)}:
            if not column.endswith(("_packets", "_per_ray")):
                self.assertIn(column, explained)


class PartialRuns(TemporaryFolder):
    """Interrupted runs and folders that are none."""

    def test_no_results_folder(self) -> None:
        code, printed, complaint = run_cli(self.folder)
        self.assertEqual((code, printed, complaint.count("\n")), (2, "", 1))
        self.assertIn("not a results folder", complaint)
        self.assertEqual(list(self.folder.iterdir()), [])
        self.assertEqual(run_cli(self.folder / "absent")[0], 2)

    def test_missing_column_is_named_with_its_file(self) -> None:
        synthetic_run.write_run(self.folder)
        path = self.folder / "counters.csv"
        path.write_text(path.read_text(encoding="utf-8").replace("prim_hits,", "", 1), encoding="utf-8")
        code, _, complaint = run_cli(self.folder)
        self.assertEqual((code, complaint), (2, f"{path}: column 'prim_hits' is missing\n"))

    def test_text_in_a_number_is_named_with_its_line(self) -> None:
        synthetic_run.write_run(self.folder)
        path = self.folder / "builds.csv"
        lines = path.read_text(encoding="utf-8").splitlines()
        lines[3] = lines[3].replace("4096", "many", 1)
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        code, _, complaint = run_cli(self.folder)
        self.assertEqual((code, complaint), (2, f"{path}:4: column 'num_prims': 'many' is not a number\n"))

    def test_empty_run(self) -> None:
        (self.folder / "manifest.json").write_text('{"name": "nothing"}', encoding="utf-8")
        code, _, complaint = run_cli(self.folder)
        self.assertEqual((code, complaint), (0, ""))
        text = (self.folder / "report.html").read_text(encoding="utf-8")
        self.assertIn("Empty: this run holds no results", text)
        self.assertEqual((Page(text).errors, Page(text).open), ([], []))
        self.assertIn("Empty", (self.folder / "report.md").read_text(encoding="utf-8"))

    def test_header_only_tables(self) -> None:
        synthetic_run.write_run(self.folder, scenes=[])
        self.assertEqual(run_cli(self.folder)[0], 0)
        self.assertIn("Empty", (self.folder / "report.html").read_text(encoding="utf-8"))

    def test_interrupted_run_says_so(self) -> None:
        synthetic_run.write_run(self.folder, kinds=["summary", "samples"], scenes=["spd:tetra:6"])
        path = self.folder / "summary.csv"
        lines = path.read_text(encoding="utf-8").splitlines()
        lines[3] = lines[3].replace(",8,8,1,", ",8,8,all,").replace(",ok", ",unfinished")  # stopped before the number of threads was known
        cut = lines[:4] + [lines[4][:40]]  # the last line was being written
        path.write_text("\n".join(cut), encoding="utf-8")
        (self.folder / "manifest.json").write_text('{"name": "cut", "state": "interrupted", "cells": 18}', encoding="utf-8")
        self.assertEqual(run_cli(self.folder)[0], 0)
        page = (self.folder / "report.html").read_text(encoding="utf-8")
        self.assertIn("Incomplete: 16 of 18 planned cells", page)
        self.assertEqual([row[:2] for row in Page(page).tables["table-left-out"] if row], [["skipped", "avx512"], ["unfinished", "avx2"]])

    def test_infinite_and_undefined_numbers(self) -> None:
        synthetic_run.write_run(self.folder, scenes=["spd:tetra:6"])
        path = self.folder / "summary.csv"
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        rows[0] |= {"median_ns_per_ray": "nan", "mrays_per_s": "inf", "ci_lo": "-inf", "prim_tests_per_ray": "inf"}
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(rows[0]))
            writer.writeheader()
            writer.writerows(rows)
        self.assertEqual(run_cli(self.folder)[0], 0)
        self.assertNotRegex((self.folder / "report.html").read_text(encoding="utf-8"), r"(?i)>(nan|inf)<")

    def test_hostile_names_are_text(self) -> None:
        name = "${HOME}/a $cene/<b>&|_*/with a path far too long for a figure.obj"
        synthetic_run.SCENES[name] = 1000
        self.addCleanup(synthetic_run.SCENES.pop, name)
        synthetic_run.write_run(self.folder, scenes=[name])
        self.assertEqual(run_cli(self.folder)[0], 0)
        page = Page((self.folder / "report.html").read_text(encoding="utf-8"))
        self.assertEqual((page.errors, page.open), ([], []))
        self.assertEqual({row[0] for row in page.tables["table-results"] if row}, {name})
        self.assertIn(r"<b>&\|\_\*/".replace("<", r"\<"), (self.folder / "report.md").read_text(encoding="utf-8"))

    def test_unwritable_output(self) -> None:
        synthetic_run.write_run(self.folder, scenes=["spd:tetra:6"])
        (self.folder / "report").write_text("a file", encoding="utf-8")
        code, _, complaint = run_cli(self.folder, "--out", self.folder / "report")
        self.assertEqual((code, complaint.count("\n")), (1, 1))


if __name__ == "__main__":
    unittest.main()
