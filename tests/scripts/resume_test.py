#!/usr/bin/python3
"""Runs that are killed, interrupted or out of room, and continued. Usage: resume_test.py RAYMETER [UNITTEST ARGUMENTS]"""
import json
import random
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

from run_support import EMPTY_SCENE, RunInFolder, config, run_tests


class ResumeTest(RunInFolder):
    def assert_complete(self, samples: list[dict], cells: int, wanted: int) -> None:
        taken = [(sample["cell"], sample["sample"]) for sample in samples]
        self.assertEqual(len(taken), len(set(taken)), "no sample twice")
        self.assertEqual(len(taken), cells * wanted, "no sample lost")
        self.assertEqual(len({cell for cell, _ in taken}), cells)
        self.assertEqual(sorted(sample["order_index"] for sample in samples), list(range(len(samples))))

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

    def test_time_that_is_over_can_be_resumed(self) -> None:
        path = self.write(config())
        result = self.raymeter("run", path, "--out", "r", "--progress", "none", "--set", "measure.max_time_s=0")
        self.assertEqual(result.returncode, 7, result.stderr)
        self.assertIn("--resume", result.stderr)
        result = self.raymeter("run", path, "--out", "r", "--resume", "--progress", "none")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assert_complete(self.samples(self.folder / "r"), 16, 7)


if __name__ == "__main__":
    run_tests()
