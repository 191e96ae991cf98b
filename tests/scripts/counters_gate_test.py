#!/usr/bin/python3
"""The counters gate notices what changed and nothing else. Usage: counters_gate_test.py"""
import sys
import unittest
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parent.parent.parent
loader = SourceFileLoader("counters_gate", str(ROOT / "scripts" / "counters_gate"))  # its name has no .py
gate = module_from_spec(spec_from_loader("counters_gate", loader))
loader.exec_module(gate)

GOLDEN = {"spd:balls:2 bvh avx2 packet 16 primary": {"node_visits": 5, "prim_tests": 7}, "spd:balls:2 bvh avx512 packet 16 primary": {"node_visits": 6}}


class CountersGateTest(unittest.TestCase):
    def test_equal_counters_pass(self) -> None:
        self.assertEqual(gate.differences(GOLDEN, GOLDEN, {"avx2", "avx512"}), [])

    def test_names_cell_and_counter(self) -> None:
        counted = {**GOLDEN, "spd:balls:2 bvh avx2 packet 16 primary": {"node_visits": 5, "prim_tests": 8}}
        self.assertEqual(gate.differences(GOLDEN, counted, {"avx2", "avx512"}), ["spd:balls:2 bvh avx2 packet 16 primary: prim_tests is 8, was 7"])

    def test_a_missing_instruction_set_is_not_compared(self) -> None:
        counted = {cell: value for cell, value in GOLDEN.items() if "avx512" not in cell}
        self.assertEqual(gate.differences(GOLDEN, counted, {"avx2"}), [])
        self.assertEqual(len(gate.differences(GOLDEN, counted, {"avx2", "avx512"})), 1)

    def test_a_new_cell_has_to_be_accepted(self) -> None:
        counted = {**GOLDEN, "spd:balls:2 grid avx2 packet 16 primary": {"node_visits": 1}}
        self.assertEqual(gate.differences(GOLDEN, counted, {"avx2", "avx512"}), ["spd:balls:2 grid avx2 packet 16 primary: is not in the golden file"])

    def test_defaults_do_not_name_a_cell(self) -> None:
        row = {"scene": "s", "structure": "bvh", "params": "bins=32,max_leaf_size=4", "isa": "avx2", "packet": "1", "rays": "primary",
               "first_hit": "cast", "occlusion": "none"}
        self.assertEqual(gate.cell_name(row, {"bvh": {"bins": "32", "max_leaf_size": "8"}}), "s bvh:max_leaf_size=4 avx2 packet 1 primary")


if __name__ == "__main__":
    unittest.main()
