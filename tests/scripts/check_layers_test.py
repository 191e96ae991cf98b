#!/usr/bin/python3
"""scripts/check_layers finds every kind of planted violation, and nothing in a tree without any."""
import subprocess
import tempfile
import unittest
from pathlib import Path

CHECK = Path(__file__).resolve().parents[2] / "scripts" / "check_layers"

CLEAN = {
    "core/base/error.h": "#include <string>\n",
    "core/simd/isa_enum.h": "#include <cstdint>\n",
    "core/simd/lanes.h": '#include <xsimd/xsimd.hpp>\n#include "core/simd/isa_enum.h"\n',
    "core/ray/ray_packet.h": '#include "core/simd/lanes.h"\n',
    "core/scene/scene.h": '#include <vector>\n#include <glm/vec3.hpp>\n#include "core/base/error.h"\n',
    "core/trace/trace.cpp": "#include <tbb/parallel_for.h>\n",
    "accel/registry.cpp": '#include "accel/list/list.h"\n#include "accel/grid/grid.h"\n',
    "accel/list/list.h": '#include "core/scene/scene.h"\n',
    "accel/grid/grid.h": '#include "core/scene/scene.h"\n',
    "accel/grid/grid_kernel.h": '#include "core/simd/isa_enum.h"\n',
    "accel/grid/grid_kernel.cpp": '#include "accel/grid/grid_kernel.h"\n#include <cstdint>\n#include "core/ray/ray_packet.h"\n',
    "accel/grid/grid_technique.cpp": '#include "accel/grid/grid_kernel.h"\n',
    "experiments/config/parse.cpp": '#include <nlohmann/json.hpp>\n#include "accel/list/list.h"\n',
    "experiments/main.cpp": "#include <iostream>\n",
    "experiments/verify/oracle.cpp": '#include "core/scene/scene.h"\n',
    "core/geometry/sphere_kernel.h": '#include "core/ray/ray_packet.h"\n',
    "core/geometry/primitive_run.h": "",
}

VIOLATIONS = {
    "core includes accel": ("core/scene/scene.cpp", '#include "accel/list/list.h"'),
    "accel includes experiments": ("accel/list/list.cpp", '#include "experiments/config/parse.h"'),
    "scene includes trace": ("core/scene/scene.cpp", '#include "core/trace/trace.h"'),
    "a technique includes another": ("accel/list/list.cpp", '#include "accel/grid/grid.h"'),
    "a baseline file uses xsimd": ("accel/grid/grid_build.cpp", "#include <xsimd/xsimd.hpp>"),
    "a baseline file uses intrinsics": ("core/scene/scene.cpp", "#include <immintrin.h>"),
    "a baseline file reaches the registers": ("accel/grid/grid_build.cpp", '#include "core/geometry/sphere_kernel.h"'),
    "a kernel uses std": ("accel/grid/walk_kernel.cpp", "#include <algorithm>"),
    "a kernel header uses GLM": ("core/bounds/slab_kernel.h", "#include <glm/vec3.hpp>"),
    "a kernel uses TBB": ("accel/grid/walk_kernel.cpp", "#include <tbb/parallel_for.h>"),
    "a kernel includes a build-side header": ("accel/grid/walk_kernel.cpp", '#include "core/scene/scene.h"'),
    "a kernel-cone header includes a build-side header": ("core/ray/views.h", '#include "core/base/error.h"'),
    "core uses TBB outside trace and render": ("core/scene/scene.cpp", "#include <tbb/parallel_for.h>"),
    "a technique uses TBB outside its build": ("accel/grid/grid_technique.cpp", "#include <tbb/parallel_for.h>"),
    "core knows JSON": ("core/scene/scene.cpp", "#include <nlohmann/json.hpp>"),
    "accel knows JSON": ("accel/list/list.cpp", "#include <nlohmann/json.hpp>"),
    "the runner knows JSON": ("experiments/run/run.cpp", "#include <nlohmann/json_fwd.hpp>"),
    "core prints": ("core/scene/scene.cpp", "#include <iostream>"),
    "the oracle looks at the kernels' side": ("experiments/verify/oracle.cpp", '#include "core/geometry/primitive_run.h"'),
    "a library prints": ("experiments/run/run.cpp", 'void f() { std::fputs("done", stdout); }'),
    "a path not from the root": ("accel/list/list.cpp", '#include "list.h"'),
}  # fmt: skip


MISPLACED = {
    "a header that may not be included twice": ("core/scene/scene.h", "#include <vector>\n"),
    "a source that includes its header later": ("core/scene/scene.cpp", '#include <vector>\n#include "core/scene/scene.h"\n'),
    "a source that defines what its header sees": ("core/scene/scene.cpp", '#define A\n#include "core/scene/scene.h"\n'),
    "a source that does not include its header": ("core/scene/scene.cpp", ""),
}


def whole(files: dict[str, str]) -> dict[str, str]:
    """Headers, and sources that have one, begun as they are to begin."""
    begun = {}
    for path, text in files.items():
        own = path.removesuffix(".cpp") + ".h"
        first = "#pragma once\n" if path.endswith(".h") else f'#include "{own}"\n' if own in files else ""
        begun[path] = text if text.startswith(first) else first + text
    return begun


def check(files: dict[str, str]) -> subprocess.CompletedProcess[str]:
    with tempfile.TemporaryDirectory() as root:
        for path, text in files.items():
            target = Path(root) / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text)
        return subprocess.run([CHECK, root], capture_output=True, text=True, check=False)


class CheckLayers(unittest.TestCase):
    def test_passes_a_clean_tree(self) -> None:
        result = check(whole(CLEAN))
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def test_finds_each_planted_violation(self) -> None:
        for what, (path, include) in VIOLATIONS.items():
            with self.subTest(what):
                # Everything that is included exists, so that only the rule in question can speak.
                others = {"experiments/config/parse.h": "", "core/trace/trace.h": ""}
                if "from the root" in what:
                    others["accel/list/list.h"] = ""
                result = check(whole({**CLEAN, **others, path: f"{include}\n"}))
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn(path, result.stdout)
                self.assertEqual(len({line.split(":")[0] for line in result.stdout.splitlines()}), 1, result.stdout)

    def test_finds_headers_that_may_not_stand_alone(self) -> None:
        for what, (path, text) in MISPLACED.items():
            with self.subTest(what):
                result = check({**whole(CLEAN), path: text})
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertEqual(len(result.stdout.splitlines()), 1, result.stdout)
                self.assertIn(path, result.stdout)


if __name__ == "__main__":
    unittest.main()
