#!/usr/bin/python3
"""`raymeter run` and its records, through the executable. Usage: run_test.py RAYMETER [UNITTEST ARGUMENTS]"""
import csv
import json
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

RAYMETER = ""
KEY = "cell_id,scene,num_prims,needs,rays,phase,structure,params,first_hit,occlusion,max_depth,min_weight,isa,simd_width,packet,threads"
EVENTS = "node_visits,leaf_visits,empty_leaf_visits,volume_tests,prim_tests,prim_hits,cache_tests,cache_hits"
COLUMNS = {  # the contract
    "samples": "sample,order_index,trace_ms,rays_traced,mrays_per_s,ns_per_ray,status",
    "builds": "build_ms,mprims_per_s,nodes,interior_nodes,leaves,empty_leaves,references,max_depth,sah_cost,epo,mem_bytes,bytes_per_prim,break_even_rays,"
              "scene_bytes",
    "counters": "ray_count," + EVENTS + "," + ",".join(f"{event}_packets" for event in EVENTS.split(",")) +
                ",node_visits_per_ray,prim_tests_per_ray,simd_utilization",
    "accuracy": "rays_checked,false_miss,false_hit,wrong_prim,self_hits,t_ulp_p50,t_ulp_p99,t_ulp_max,image_rmse,image_psnr,image_ssim",
    "summary": "n,median_ns_per_ray,ci_lo,ci_hi,mad,mrays_per_s,build_ms,time_to_image_ms,mem_bytes,node_visits_per_ray,prim_tests_per_ray,simd_utilization,"
               "ratio_vs_ref,ratio_lo,ratio_hi,hit_mismatch,status",
}
EMPTY_SCENE = "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 4 4\n"


def config(**changes) -> dict:
    document = {"name": "t", "matrix": {"scene": ["spd:balls:1", "spd:tetra:2"], "structure": [{"name": "list"}, {"name": "bvh"}], "isa": ["scalar"],
                                        "packet": [1, 16], "rays": ["primary", "shadow"]},
                "image": {"width": 32, "height": 32}, "measure": {"warmup": 1, "samples": 7}}
    for key, value in changes.items():
        if isinstance(value, dict):
            document.setdefault(key, {}).update(value)
        else:
            document[key] = value
    return document


class RunTest(unittest.TestCase):
    def setUp(self) -> None:
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)

    def command(self, *words: str) -> list[str]:
        return [RAYMETER, *words]

    def raymeter(self, *words: str, **more) -> subprocess.CompletedProcess:
        return subprocess.run(self.command(*words), capture_output=True, text=True, cwd=self.folder, **more)

    def write(self, document: dict, name: str = "c.json") -> str:
        (self.folder / name).write_text(json.dumps(document))
        return name

    def rows(self, folder: Path, table: str) -> list[dict[str, str]]:
        with open(folder / f"{table}.csv", newline="") as file:
            return list(csv.DictReader(file))

    def samples(self, folder: Path) -> list[dict]:
        return [record for record in map(json.loads, (folder / "samples.jsonl").read_text().splitlines()) if record["type"] == "sample"]

    def test_writes_the_columns_of_the_contract(self) -> None:
        result = self.raymeter("run", self.write(config()), "--progress", "none")
        self.assertEqual(result.returncode, 0, result.stderr)
        folder = self.folder / result.stdout.strip()
        self.assertRegex(str(folder.relative_to(self.folder)), r"^results/t/\d{8}T\d{6}Z_[0-9a-z]+_.+$")
        for table, columns in COLUMNS.items():
            header = (folder / f"{table}.csv").read_text().splitlines()[0]
            self.assertEqual(header, KEY + "," + columns, table)
        for name in ("manifest.json", "environment.json", "benchmark.json"):
            json.loads((folder / name).read_text())
        for name in ("samples.jsonl", "plan.jsonl"):
            for line in (folder / name).read_text().splitlines():
                json.loads(line)
        self.assertEqual(sorted(path.name for path in folder.iterdir()),
                         sorted(["manifest.json", "environment.json", "samples.jsonl", "plan.jsonl", "benchmark.json"] + [f"{t}.csv" for t in COLUMNS]))

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

    def test_an_unwritable_folder_is_found_before_any_work(self) -> None:
        (self.folder / "file").write_text("")
        result = self.raymeter("run", self.write(config()), "--out", "file/r", "--progress", "none")
        self.assertEqual((result.returncode, len(result.stderr.splitlines())), (2, 1), result)
        self.assertEqual((self.folder / "file").read_text(), "")

    def test_a_full_disk_keeps_what_was_measured(self) -> None:
        document = config(measure={"samples": 50})

        def limit() -> None:  # a file that cannot grow further, as on a full disk
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (40000, 40000))

        result = self.raymeter("run", self.write(document), "--out", "r", "--progress", "none", preexec_fn=limit)
        self.assertEqual(result.returncode, 1, result)
        self.assertIn("samples.jsonl: write failed", result.stderr)
        text = (self.folder / "r" / "samples.jsonl").read_text()
        self.assertTrue(text.endswith("\n"))
        before = self.samples(self.folder / "r")
        self.assertGreater(len(before), 10)
        result = self.raymeter("run", "c.json", "--out", "r", "--resume", "--progress", "none")
        self.assertEqual(result.returncode, 0, result)
        after = self.samples(self.folder / "r")
        self.assertEqual(after[:len(before)], before)
        self.assert_complete(after, 16, 50)

    def assert_complete(self, samples: list[dict], cells: int, wanted: int) -> None:
        taken = [(sample["cell"], sample["sample"]) for sample in samples]
        self.assertEqual(len(taken), len(set(taken)), "no sample twice")
        self.assertEqual(len(taken), cells * wanted, "no sample lost")
        self.assertEqual(len({cell for cell, _ in taken}), cells)
        self.assertEqual(sorted(sample["order_index"] for sample in samples), list(range(len(samples))))

    def test_killed_at_random_moments_and_resumed(self) -> None:
        path = self.write(config(measure={"samples": 12}))
        whole = time.monotonic()
        self.assertEqual(self.raymeter("run", path, "--out", "whole", "--progress", "none").returncode, 0)
        whole = time.monotonic() - whole
        cells = {record["cell"] for record in self.samples(self.folder / "whole")}
        seed = random.randrange(1 << 30)
        print(f"seed {seed}")
        moments = random.Random(seed)
        killed = 0
        for trial in range(20):
            out = self.folder / f"r{trial}"
            how = signal.SIGKILL if trial % 2 == 0 else signal.SIGINT
            for attempt in range(200):
                words = self.command("run", path, "--out", out.name, "--progress", "none", *(["--resume"] if attempt > 0 else []))
                process = subprocess.Popen(words, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
                if attempt < 3:
                    time.sleep(moments.uniform(0, whole))
                    process.send_signal(how)
                output, errors = process.communicate()
                if process.returncode == 0:
                    break
                killed += 1
                self.assertIn(process.returncode, (-how, 130), errors)
                if process.returncode == 130:
                    self.assertIn("--resume", errors)
                if out.exists() and trial % 4 == 0 and (out / "samples.jsonl").exists():  # as a kill in the middle of a write leaves it
                    with open(out / "samples.jsonl", "a") as file:
                        file.write('{"type":"sample","cell":"0')
            self.assertEqual(process.returncode, 0, errors)
            samples = self.samples(out)
            self.assert_complete(samples, len(cells), 12)
            self.assertEqual({sample["cell"] for sample in samples}, cells)
            self.assertEqual({row["status"] for row in self.rows(out, "summary")}, {"ok"})
            self.assertEqual(json.loads((out / "manifest.json").read_text())["state"], "complete")
        self.assertGreater(killed, 10, "the kills came too late to prove anything")

    def test_interrupt_prints_the_command_that_continues(self) -> None:
        path = self.write(config(measure={"samples": 100000}))
        process = subprocess.Popen(self.command("run", path, "--progress", "none", "--filter", "structure=bvh*"), cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        while not list(self.folder.glob("results/t/*/samples.jsonl")):
            time.sleep(0.02)
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        output, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, errors)
        command = errors.splitlines()[-1].strip()
        folder = self.folder / output.strip()
        self.assertEqual(json.loads((folder / "manifest.json").read_text())["state"], "interrupted")
        before = len(self.samples(folder))
        process = subprocess.Popen(["/bin/sh", "-c", "exec " + command + " --progress none"], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True)
        time.sleep(1.0)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, errors)
        self.assertGreaterEqual(len(self.samples(folder)), before)
        self.assertEqual(len(list(self.folder.glob("results/t/*"))), 1)

    def test_resume_without_out_takes_the_newest_run_of_the_config(self) -> None:
        path = self.write(config())
        first = self.raymeter("run", path, "--progress", "none", "--resume")
        self.assertEqual(first.returncode, 0, first.stderr)
        again = self.raymeter("run", path, "--progress", "none", "--resume")
        self.assertEqual((again.returncode, again.stdout), (0, first.stdout))
        self.assertIn("nothing to do", again.stderr)
        other = self.raymeter("run", path, "--progress", "none", "--resume", "--set", "seed=7")
        self.assertNotEqual(other.stdout, first.stdout)
        refused = self.raymeter("run", path, "--out", first.stdout.strip(), "--progress", "none")
        self.assertEqual(refused.returncode, 2)
        refused = self.raymeter("run", path, "--out", first.stdout.strip(), "--progress", "none", "--resume", "--set", "seed=7")
        self.assertIn("another config", refused.stderr)
        fresh = self.raymeter("run", path, "--out", first.stdout.strip(), "--progress", "none", "--fresh", "--set", "seed=7")
        self.assertEqual(fresh.returncode, 0, fresh.stderr)

    def test_two_processes_do_not_share_a_folder(self) -> None:
        path = self.write(config(measure={"samples": 100000}))
        first = subprocess.Popen(self.command("run", path, "--out", "r", "--progress", "none"), cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while not (self.folder / "r" / "samples.jsonl").exists():
            time.sleep(0.02)
        second = self.raymeter("run", path, "--out", "r", "--resume", "--progress", "none")
        first.kill()
        first.wait()
        self.assertEqual(second.returncode, 2, second)
        self.assertIn("another process", second.stderr)

    def test_an_empty_scene_runs(self) -> None:
        (self.folder / "empty.nff").write_text(EMPTY_SCENE)
        result = self.raymeter("run", self.write(config(matrix={"scene": ["empty.nff"]})), "--out", "r", "--progress", "none")
        self.assertEqual(result.returncode, 0, result.stderr)
        for row in self.rows(self.folder / "r", "summary"):
            self.assertEqual(row["status"], "ok" if row["rays"] == "primary" else "skipped", row)

    def test_a_machine_without_sys_is_no_complaint(self) -> None:
        bare = {**os.environ, "HWLOC_FSROOT": str(self.folder)}
        self.assertEqual(self.raymeter("env", env=bare).stderr, "")
        result = self.raymeter("run", self.write(config()), "--progress", "none", env=bare)
        self.assertEqual((result.returncode, result.stderr), (0, "16 cells: 16 ok\n"))

    def test_a_damaged_scene_leaves_nothing_or_what_came_before(self) -> None:
        (self.folder / "bad.nff").write_text("v\nfrom 0 0\n")
        result = self.raymeter("run", self.write(config(matrix={"scene": ["bad.nff"]})), "--progress", "none")
        self.assertEqual((result.returncode, len(result.stderr.splitlines())), (2, 1), result)
        self.assertEqual(list(self.folder.glob("results/*")), [])
        result = self.raymeter("run", self.write(config(matrix={"scene": ["spd:balls:1", "bad.nff"]})), "--out", "r", "--progress", "none")
        self.assertEqual(result.returncode, 2, result)
        self.assertEqual(sorted(row["status"] for row in self.rows(self.folder / "r", "summary")), ["ok"] * 8 + ["unfinished"] * 8)
        (self.folder / "bad.nff").write_text(EMPTY_SCENE)
        result = self.raymeter("run", "c.json", "--out", "r", "--resume", "--progress", "none")
        self.assertEqual(result.returncode, 0, result)

    def test_a_cell_that_takes_too_long_times_out(self) -> None:
        result = self.raymeter("run", self.write(config(measure={"timeout_s": 0})), "--out", "r", "--progress", "none")
        self.assertEqual(result.returncode, 7, result.stderr)
        rows = self.rows(self.folder / "r", "summary")
        self.assertEqual({row["status"] for row in rows}, {"timeout"})
        self.assertEqual({row["median_ns_per_ray"] for row in rows}, {""})

    def test_time_that_is_over_can_be_resumed(self) -> None:
        path = self.write(config())
        result = self.raymeter("run", path, "--out", "r", "--progress", "none", "--set", "measure.max_time_s=0")
        self.assertEqual(result.returncode, 7, result.stderr)
        self.assertIn("--resume", result.stderr)
        result = self.raymeter("run", path, "--out", "r", "--resume", "--progress", "none")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assert_complete(self.samples(self.folder / "r"), 16, 7)

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

    def test_progress_is_one_json_object_a_line(self) -> None:
        result = self.raymeter("run", self.write(config()), "--out", "r", "--progress", "json")
        lines = [json.loads(line) for line in result.stderr.splitlines() if line.startswith("{")]
        self.assertGreater(len(lines), 3)
        for line in lines:
            self.assertEqual(set(line), {"what", "cells_done", "cells", "percent", "seconds_left"})


if __name__ == "__main__":
    RAYMETER = str(Path(sys.argv[1]).resolve())
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
