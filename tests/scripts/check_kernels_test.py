#!/usr/bin/python3
"""scripts/check_kernels finds planted violations in small objects, and nothing in clean ones. CXX names the compiler (default g++)."""
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

CHECK = Path(__file__).resolve().parents[2] / "scripts" / "check_kernels"
AVX512 = "-mavx512f -DRAYMETER_KERNEL_ISA=avx512"
ISA = "namespace raymeter { enum class Isa : unsigned char { scalar, sse42, avx2, avx512 }; }\n"
SUM = "template <raymeter::Isa I> __attribute__((noinline)) float sum(const float* p) { float s = 0; for (int i = 0; i < 64; ++i) s += p[i]; return s; }\n"


def check(source: str, flags: str) -> str:
    """What scripts/check_kernels says of an object compiled from `source`."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "planted.cpp"
        file.write_text(source)
        command = f"{os.environ.get('CXX', 'g++')} -std=c++20 -O3 {flags} -o planted.o -c {file}"
        subprocess.run(command, shell=True, check=True, cwd=folder)
        database = [{"directory": folder, "command": command, "file": str(file)}]
        (Path(folder) / "compile_commands.json").write_text(json.dumps(database))
        result = subprocess.run([CHECK, folder], capture_output=True, text=True, check=False)
        assert result.stderr == "" and (result.returncode == 0) == (result.stdout == ""), result
        return result.stdout


class CheckKernels(unittest.TestCase):
    def test_passes_a_kernel_that_carries_its_instruction_set(self) -> None:
        self.assertEqual(check(ISA + SUM + "template float sum<raymeter::Isa::avx512>(const float*);", AVX512), "")

    def test_finds_a_std_algorithm_in_a_kernel(self) -> None:
        source = "#include <algorithm>\nvoid f(int* a, int* b) { std::stable_sort(a, b); }"
        self.assertIn("weak function without its instruction set (avx512)", check(source, AVX512))

    def test_finds_a_kernel_of_another_instruction_set(self) -> None:
        self.assertIn("Isa)0", check(ISA + SUM + "template float sum<raymeter::Isa::scalar>(const float*);", AVX512))

    def test_finds_an_inline_function_in_a_kernel(self) -> None:
        source = "inline __attribute__((noinline)) int twice(int i) { return 2 * i; }\nint f(int i) { return twice(i) + 1; }"
        self.assertIn("twice", check(source, AVX512))

    def test_finds_code_that_a_kernel_object_runs_before_main(self) -> None:
        self.assertIn("before main", check("int f();\nint value = f();", AVX512))

    def test_passes_a_baseline_object(self) -> None:
        self.assertEqual(check("void f(float* a) { for (int i = 0; i < 64; ++i) a[i] *= 2; }", ""), "")

    def test_finds_wide_instructions_in_a_baseline_object(self) -> None:
        for flags in ("-mavx", "-mavx2", "-mavx512f"):
            self.assertIn("beyond x86-64", check("void f(float* a) { for (int i = 0; i < 64; ++i) a[i] *= 2; }", flags))

    def test_finds_a_missing_object(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "compile_commands.json").write_text(json.dumps([{"directory": folder, "command": "g++ -o a.o -c a.cpp", "file": "/a.cpp"}]))
            self.assertEqual(subprocess.run([CHECK, folder], capture_output=True, check=False).returncode, 1)


if __name__ == "__main__":
    unittest.main()
