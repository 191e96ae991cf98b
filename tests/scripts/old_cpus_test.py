#!/usr/bin/python3
"""The binary starts and traces on CPUs without wide instructions, which QEMU imitates. Usage: old_cpus_test.py RAYMETER. Exit code 77: no QEMU here."""
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

QEMU = shutil.which("qemu-x86_64")
RAYMETER = sys.argv.pop()
# CPU model of QEMU -> the instruction sets that it has.
CPUS = {"core2duo": ["scalar"], "Nehalem": ["scalar", "sse42"], "Haswell": ["scalar", "sse42", "avx2"]}


def on_cpu(cpu: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([QEMU, "-cpu", cpu, RAYMETER, *arguments], capture_output=True, text=True, check=False)


class OldCpus(unittest.TestCase):
    def test_lists_the_missing_instruction_sets_as_such(self) -> None:
        for cpu, has in CPUS.items():
            with self.subTest(cpu):
                result = on_cpu(cpu, "list", "isas")
                self.assertEqual(result.returncode, 0, result.stderr)
                lines = result.stdout.splitlines()
                self.assertEqual(len(lines), 4, lines)
                self.assertEqual([line.split()[0] for line in lines if "not on this machine" not in line], has)

    def test_traces_with_the_best_that_there_is_and_refuses_the_rest(self) -> None:
        rays = np.array([[0, 0, 5, 0, 0, 0, -1, np.inf], [9, 0, 5, 0, 0, 0, -1, np.inf]] * 9, dtype=np.float32)
        for cpu, has in CPUS.items():
            with self.subTest(cpu), tempfile.TemporaryDirectory() as name:
                folder = Path(name)
                np.save(folder / "rays.npy", rays)
                (folder / "scene.nff").write_text("s 0 0 0 1\n")
                trace = ["trace", "--scene", f"{folder}/scene.nff", "--technique", "bvh", "--rays", f"{folder}/rays.npy", "--query", "closest",
                         "--out", f"{folder}/hits.npy"]  # fmt: skip
                for isa in [[], *(["--isa", isa] for isa in has)]:
                    result = on_cpu(cpu, *trace, *isa)
                    self.assertEqual(result.returncode, 0, result.stderr)
                    self.assertEqual(np.load(folder / "hits.npy")["prim"].tolist(), [0, -1] * 9)
                refused = on_cpu(cpu, *trace, "--isa", "avx512")
                self.assertEqual(refused.returncode, 2)
                self.assertIn("avx512", refused.stderr)


if __name__ == "__main__":
    if QEMU is None:
        print("skipped: qemu-x86_64 is not installed")
        sys.exit(77)
    unittest.main()
