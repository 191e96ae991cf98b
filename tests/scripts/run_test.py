#!/usr/bin/python3
"""What `raymeter run` measures and records, through the executable. Usage: run_test.py RAYMETER [UNITTEST ARGUMENTS]"""
import json
import os
import struct
import subprocess
import sys
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

from run_support import EMPTY_SCENE, RunInFolder, config, run_tests

KEY = "cell_id,scene,num_prims,needs,rays,phase,structure,params,first_hit,occlusion,max_depth,min_weight,isa,simd_width,packet,threads"
EVENTS = "node_visits,leaf_visits,empty_leaf_visits,volume_tests,prim_tests,prim_hits,cache_tests,cache_hits"
COLUMNS = {  # the contract
    "samples": "sample,order_index,trace_ms,rays_traced,mrays_per_s,ns_per_ray,status,prepare_ms",
    "builds": "build_ms,mprims_per_s,nodes,interior_nodes,leaves,empty_leaves,references,max_depth,sah_cost,epo,mem_bytes,bytes_per_prim,break_even_rays,"
              "scene_bytes,sibling_distance,node_volume,total_volume,cost_depth,cost_depth_p90,epo_se,volume_area,void_area,builds,build_ci_lo,build_ci_hi",
    "counters": "ray_count," + EVENTS + "," + ",".join(f"{event}_packets" for event in EVENTS.split(",")) +
                ",node_visits_per_ray,prim_tests_per_ray,simd_utilization,rays_hit,cache_hit_rate,cache_hit_rate_blocked,first_prepare_ms,cells,candidates_per_cell,cell_bytes,full_table_bytes",
    "accuracy": "rays_checked,false_miss,false_hit,wrong_prim,self_hits,t_ulp_p50,t_ulp_p99,t_ulp_max,image_rmse,image_psnr,image_ssim,"
    "cell_rays_checked,cell_rays_missing,cell_rays_at_risk,cells_missed,longest_missed",
    "frames": "rays_traced,primary,primary_hit,reflection,reflection_hit,refraction,refraction_hit,tir,shadow,shadow_blocked,rays_saved,mean_depth,deepest,"
              "generations,error_mean,error_max,bound_mean,bound_max,bound_exceeded",
    "summary": "n,median_ns_per_ray,ci_lo,ci_hi,mad,mrays_per_s,build_ms,time_to_image_ms,mem_bytes,node_visits_per_ray,prim_tests_per_ray,simd_utilization,"
               "ratio_vs_ref,ratio_lo,ratio_hi,hit_mismatch,status",
}


class RunTest(RunInFolder):
    def test_writes_the_columns_of_the_contract(self) -> None:
        result = self.raymeter("run", self.write(config()), "--progress", "none")
        self.assertEqual(result.returncode, 0, result.stderr)
        folder = self.folder / result.stdout.strip()
        self.assertRegex(str(folder.relative_to(self.folder)), r"^results/t/\d{8}T\d{6}Z_[0-9a-z]+_.+$")
        for table, columns in COLUMNS.items():
            header = (folder / f"{table}.csv").read_text().splitlines()[0]
            self.assertEqual(header, KEY + "," + columns, table)
        self.assertEqual((folder / "break_even.csv").read_text().splitlines()[0], "cell_id,against,break_even_rays")
        for name in ("manifest.json", "environment.json", "benchmark.json"):
            json.loads((folder / name).read_text())
        for name in ("samples.jsonl", "plan.jsonl"):
            for line in (folder / name).read_text().splitlines():
                json.loads(line)
        self.assertEqual(sorted(path.name for path in folder.iterdir()),
                         sorted(["manifest.json", "environment.json", "samples.jsonl", "plan.jsonl", "benchmark.json"] + [f"{t}.csv" for t in [*COLUMNS, "break_even"]]))

    def test_builds_hold_what_their_definitions_say(self) -> None:
        listed = self.raymeter("list", "techniques", "--json")
        self.assertEqual(listed.returncode, 0, listed.stderr)
        structures = [{"name": entry["name"]} for entry in json.loads(listed.stdout) if entry["slot"] == "structure" and entry["name"] != "embree"]
        self.assertGreaterEqual({structure["name"] for structure in structures},
                                {"list", "bvh", "grid", "recursive_grid", "octree", "kdtree", "bsp", "ray_classification"})
        document = config(matrix={"structure": structures, "packet": [16], "rays": ["primary"]}, measure={"samples": 0})
        result = self.raymeter("run", self.write(document), "--out", "r", "--progress", "none")
        self.assertEqual(result.returncode, 0, result.stderr)
        builds = self.rows(self.folder / "r", "builds")
        scenes = {}
        for line in (self.folder / "r" / "samples.jsonl").read_text().splitlines():
            record = json.loads(line)
            if record["type"] == "scene":
                scenes[record["scene"]] = record
        self.assertEqual({(row["scene"], row["structure"]) for row in builds}, {(scene, structure["name"]) for scene in scenes for structure in structures})
        for row in builds:
            with self.subTest(scene=row["scene"], structure=row["structure"]):
                prims, memory, scene_bytes, build_ms = int(row["num_prims"]), int(row["mem_bytes"]), int(row["scene_bytes"]), float(row["build_ms"])
                self.assertGreater(memory, 0)
                self.assertGreater(build_ms, 0)
                self.assertEqual(scene_bytes, scenes[row["scene"]]["scene_bytes"])
                self.assertGreater(scene_bytes, prims * 16, "a sphere alone is four floats")
                self.assertAlmostEqual(float(row["bytes_per_prim"]) * prims / (memory + scene_bytes), 1, delta=1e-8)  # nine digits
                self.assertAlmostEqual(float(row["mprims_per_s"]) * build_ms * 1e3 / prims, 1, delta=2e-8)
                if row["structure"] != "list":
                    self.assertGreater(memory, 4 * prims, "it refers to each")
        for row in self.rows(self.folder / "r", "summary"):
            of_build = next(build for build in builds if build["cell_id"] == row["cell_id"])
            self.assertEqual((row["mem_bytes"], row["build_ms"]), (of_build["mem_bytes"], of_build["build_ms"]))

    def test_keeps_no_lists_of_cells_that_are_not_timed(self) -> None:
        def peak_and_lists(packets: list[int]) -> tuple[int, int]:
            """Bytes: the most that the run holds at once, and the lists of its first cell."""
            document = config(matrix={"scene": ["gen:terrain:5000"], "structure": [{"name": "ray_classification", "min_rays": 1}], "packet": packets,
                                      "rays": ["diffuse"]}, image={"width": 32, "height": 32}, measure={"warmup": 0, "samples": 0})
            run = subprocess.Popen(self.command("run", self.write(document), "--out", f"r{len(packets)}", "--progress", "none"), cwd=self.folder,
                                   stdout=subprocess.DEVNULL, env=os.environ | {"ASAN_OPTIONS": "quarantine_size_mb=1"})  # else it keeps what is freed
            _, status, usage = os.wait4(run.pid, 0)
            run.returncode = os.waitstatus_to_exitcode(status)
            self.assertEqual(run.returncode, 0)
            return usage.ru_maxrss * 1024, int(self.rows(self.folder / f"r{len(packets)}", "counters")[0]["cell_bytes"])

        one, lists = peak_and_lists([16])
        six, _ = peak_and_lists([1, 2, 4, 8, 16, 32])
        self.assertGreater(lists, 20 << 20)
        self.assertLess(six, one + 2 * lists)

    def test_measures_every_cell(self) -> None:
        result = self.raymeter("run", self.write(config()), "--out", "r", "--progress", "none")
        self.assertEqual(result.returncode, 0, result.stderr)
        summary = self.rows(self.folder / "r", "summary")
        self.assertEqual(len(summary), 2 * 2 * 2 * 2)
        for row in summary:
            self.assertEqual((row["n"], row["status"], row["hit_mismatch"]), ("7", "ok", "0"), row)
            self.assertLessEqual(float(row["ci_lo"]), float(row["median_ns_per_ray"]))
            self.assertLessEqual(float(row["median_ns_per_ray"]), float(row["ci_hi"]))
            self.assertEqual(row["time_to_image_ms"], "")
            if row["structure"] == "list":
                self.assertEqual((row["ratio_vs_ref"], row["ratio_lo"], row["ratio_hi"]), ("1", "1", "1"))
        samples = self.rows(self.folder / "r", "samples")
        self.assertEqual(len(samples), 16 * 7)
        self.assertEqual(sorted(int(row["order_index"]) for row in samples), list(range(16 * 7)))
        # Interleaved: the first eight samples are of the eight cells of the first scene.
        first = sorted(samples, key=lambda row: int(row["order_index"]))[:8]
        self.assertEqual(len({row["cell_id"] for row in first}), 8)
        benchmark = json.loads((self.folder / "r" / "benchmark.json").read_text())
        self.assertEqual(len(benchmark["benchmarks"]), 16 * 7)
        for key in ("name", "run_type", "iterations", "real_time", "cpu_time", "time_unit"):
            self.assertIn(key, benchmark["benchmarks"][0])

    def test_counts_without_samples(self) -> None:
        document = config(measure={"samples": 0})
        result = self.raymeter("run", self.write(document), "--out", "r", "--progress", "none")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(len(self.rows(self.folder / "r", "counters")), 16)
        for row in self.rows(self.folder / "r", "summary"):
            self.assertEqual((row["n"], row["median_ns_per_ray"], row["ci_lo"], row["status"]), ("0", "", "", "ok"))

    def test_few_samples_have_no_interval(self) -> None:
        self.assertEqual(self.raymeter("run", self.write(config(measure={"samples": 5})), "--out", "r", "--progress", "none").returncode, 0)
        for row in self.rows(self.folder / "r", "summary"):
            self.assertNotEqual(row["median_ns_per_ray"], "")
            self.assertEqual((row["ci_lo"], row["ci_hi"], row["ratio_lo"]), ("", "", ""))

    def test_builds_are_timed_in_rounds(self) -> None:
        document = config(measure={"samples": 0, "builds": 6}, matrix={"threads": [1, 2]})
        self.assertEqual(self.raymeter("run", self.write(document), "--out", "r", "--progress", "none").returncode, 0)
        lines = [json.loads(line) for line in (self.folder / "r" / "samples.jsonl").read_text().splitlines()]
        builds = [(line["scene"], line["build"], line["threads"]) for line in lines if line["type"] == "build"]
        self.assertEqual(len(builds), 6 * len(set(builds)))
        self.assertEqual(len(set(builds)), 2 * 2 * 2)
        of_a_scene = [build for build in builds if build[0] == builds[0][0]]
        for first in range(0, len(of_a_scene), 4):
            self.assertEqual(len(set(of_a_scene[first:first + 4])), 4, "builds take turns")
        for row in self.rows(self.folder / "r", "builds"):
            self.assertEqual(row["builds"], "6")
            self.assertLessEqual(float(row["build_ci_lo"]), float(row["build_ms"]))
            self.assertLessEqual(float(row["build_ms"]), float(row["build_ci_hi"]))
        # What a run was cut off from is built when it goes on, and no more.
        kept = [line for line in (self.folder / "r" / "samples.jsonl").read_text().splitlines(keepends=True) if json.loads(line)["type"] in ("scene", "build")][:8]
        (self.folder / "r" / "samples.jsonl").write_text("".join(kept))
        self.assertEqual(self.raymeter("run", "c.json", "--out", "r", "--resume", "--progress", "none").returncode, 0)
        self.assertEqual({row["builds"] for row in self.rows(self.folder / "r", "builds")}, {"6"})

    def test_exit_codes_of_usage(self) -> None:
        good = self.write(config())
        self.write(config(sed=3), "bad.json")
        for words in (["run"], ["run", "absent.json"], ["run", "bad.json"], ["run", good, "--shard", "3/2"], ["run", good, "--filter", "x=1"],
                      ["run", good, "--resume", "--fresh"], ["run", good, "--progress", "loud"], ["run", good, "--pin", "x"], ["run", good, "--pin", "99999"],
                      ["run", good, "--set", "sed=1"], ["run", good, "--filter", "structure=grid*"], ["validate", "bad.json"], ["fly"], ["merge"], ["track"],
                      ["describe", "bwh"], ["plan", "bad.json"], ["compare", "a", "b"], ["report", "a"], ["list", "things"], []):
            result = self.raymeter(*words)
            self.assertEqual(result.returncode, 2, (words, result))
            self.assertEqual(result.stdout, "", words)
            self.assertFalse((self.folder / "results").exists(), words)
        for words in (["--help"], ["run", "--help"], ["validate", good], ["plan", good], ["plan", good, "--format", "json"], ["run", good, "--dry-run"], ["schema"],
                      ["env"], ["env", "--check", "--json"], ["list", "techniques"], ["list", "metrics", "--json"], ["describe", "bvh", "--json"]):
            result = self.raymeter(*words)
            self.assertEqual(result.returncode, 0, (words, result))
            self.assertFalse((self.folder / "results").exists(), words)
            if words[-1].endswith("json") and words[0] != "validate":
                json.loads(result.stdout) if "--json" in words or "json" in words else None
        for command in ("run", "validate", "plan", "list", "describe", "schema", "env", "trace", "report", "compare"):
            self.assertTrue(self.raymeter(command, "--help").stdout.startswith("Example: raymeter " + command), command)

    def test_describe_says_which_values_need_a_build(self) -> None:
        text = self.raymeter("describe", "bvh").stdout
        for line in ("plane_bits             (32) 2 to 16 or 32; query for 32, else a build of its own\n", "group                  (256) 16 to 256; query\n",
                     "box_bounds             (padded) padded, tight; query for padded, else a build of its own\n",
                     "; packet, heap share a build; beam, stream, single, auto share a build\n"):
            self.assertIn(line, text)

    def test_an_empty_scene_runs(self) -> None:
        (self.folder / "empty.nff").write_text(EMPTY_SCENE)
        result = self.raymeter("run", self.write(config(matrix={"scene": ["empty.nff"]})), "--out", "r", "--progress", "none")
        self.assertEqual(result.returncode, 0, result.stderr)
        for row in self.rows(self.folder / "r", "summary"):
            self.assertEqual(row["status"], "ok" if row["rays"] == "primary" else "skipped", row)

    def test_an_optional_scene_is_skipped_where_absent_and_seen_by_its_view(self) -> None:
        (self.folder / "near.nff").write_text("v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 4 4\nf 1 0 0 1 0 0 0 0\ns 0 0 0 1\n")
        scenes = [{"file": "gone.ply", "optional": True}, {"name": "far", "file": "near.nff", "view": {"eye": [0, 0, 500], "look_at": [0, 0, 0], "light": [9, 9, 9]}},
                  {"name": "inside", "file": "near.nff", "view": {"eye": [0, 0, 0], "look_at": [0, 0, 1]}}]
        result = self.raymeter("run", self.write(config(matrix={"scene": scenes, "rays": ["primary"], "packet": [16]})), "--out", "r", "--progress", "none")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("gone.ply is not there", result.stderr + result.stdout)
        rows = {row["scene"]: row for row in self.rows(self.folder / "r", "summary")}
        self.assertEqual({name: row["status"] for name, row in rows.items()}, {"gone.ply": "skipped", "far": "ok", "inside": "ok"})
        hits = {row["scene"]: float(row["prim_hits"]) for row in self.rows(self.folder / "r", "counters") if row["structure"] == "list"}
        self.assertEqual(hits["inside"], 32 * 32)
        self.assertLess(hits["far"], 32)

    def test_a_machine_without_sys_is_no_complaint(self) -> None:
        bare = {**os.environ, "HWLOC_FSROOT": str(self.folder)}
        self.assertEqual(self.raymeter("env", env=bare).stderr, "")
        result = self.raymeter("run", self.write(config()), "--progress", "none", env=bare)
        self.assertEqual((result.returncode, result.stderr), (0, "16 cells: 16 ok\n"))

    def test_parameters_that_do_not_suit_the_scene_are_a_config_error(self) -> None:
        cells = {"scene": ["spd:balls:4"], "structure": [{"name": "ray_classification", "memory_mb": [0.0625, 16]}]}
        result = self.raymeter("run", self.write(config(matrix=cells)), "--out", "r", "--progress", "none")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("memory_mb: 0.0625 is too little for the lists of 7382 primitives; expected at least", result.stderr)
        status = {"0.0625": {"refused"}, "16": {"ok"}}
        for row in self.rows(self.folder / "r", "summary"):
            self.assertIn(row["status"], status[row["params"].rsplit("memory_mb=")[1]], row)
        header = b"{'descr': '<f4', 'fortran_order': False, 'shape': (1, 8), }".ljust(117) + b"\n"
        (self.folder / "rays.npy").write_bytes(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + struct.pack("<8f", 0, 0, 5, 0, 0, 0, -1, 9))
        technique = ["--scene", "spd:balls:4", "--technique", "ray_classification:memory_mb=0.0625"]
        image = self.raymeter("image", *technique, "--size", "16", "--out", "i.png")
        trace = self.raymeter("trace", *technique, "--rays", "rays.npy", "--query", "closest", "--out", "h.npy")
        for result in (image, trace):
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn("memory_mb: 0.0625 is too little", result.stderr)

    def test_a_cell_that_takes_too_long_times_out(self) -> None:
        result = self.raymeter("run", self.write(config(measure={"timeout_s": 0})), "--out", "r", "--progress", "none")
        self.assertEqual(result.returncode, 7, result.stderr)
        rows = self.rows(self.folder / "r", "summary")
        self.assertEqual({row["status"] for row in rows}, {"timeout"})
        self.assertEqual({row["median_ns_per_ray"] for row in rows}, {""})

    def test_compare(self) -> None:
        path = self.write(config(matrix={"packet": [16]}))
        for out in ("a", "b"):
            self.assertEqual(self.raymeter("run", path, "--out", out, "--progress", "none").returncode, 0)

        def scaled(factor: float, counters: int = 0) -> None:
            """Makes b a copy of a whose times and counters are changed."""
            lines = []
            for record in map(json.loads, (self.folder / "a" / "samples.jsonl").read_text().splitlines()):
                if record["type"] == "sample":
                    record["trace_ms"] = factor * (1 + 0.001 * record["sample"])
                if record["type"] == "check":
                    record["counters"]["prim_tests"] += counters
                lines.append(json.dumps(record) + "\n")
            (self.folder / "b" / "samples.jsonl").write_text("".join(lines))

        scaled(1)
        os.replace(self.folder / "b" / "samples.jsonl", self.folder / "a" / "samples.jsonl")
        for factor, counters, code in ((1, 0, 0), (0.5, 0, 0), (1.2, 0, 3), (1.2, 1, 4), (0.5, 1, 4), (1.01, 0, 0)):
            scaled(factor, counters)
            result = self.raymeter("compare", "a", "b")
            self.assertEqual(result.returncode, code, (factor, counters, result))
        scaled(1.2)
        self.assertIn("1.200 geometric mean", self.raymeter("compare", "a", "b").stdout)
        scaled(1.0495)
        self.assertEqual(self.raymeter("compare", "a", "b").returncode, 0)
        self.assertEqual(self.raymeter("compare", "--strict", "a", "b").returncode, 5)
        self.write(config(matrix={**config()["matrix"], "packet": [3]}), "other.json")
        self.raymeter("run", "other.json", "--out", "other")
        self.assertEqual(self.raymeter("compare", "a", "other").returncode, 0)
        self.assertEqual(self.raymeter("compare", "--strict", "a", "other").returncode, 5)

    def test_progress_is_one_json_object_a_line(self) -> None:
        result = self.raymeter("run", self.write(config()), "--out", "r", "--progress", "json")
        lines = [json.loads(line) for line in result.stderr.splitlines() if line.startswith("{")]
        self.assertGreater(len(lines), 3)
        for line in lines:
            self.assertEqual(set(line), {"what", "cells_done", "cells", "percent", "seconds_left"})


if __name__ == "__main__":
    run_tests()
