#!/usr/bin/python3
"""`raymeter trace` reads what NumPy wrote, and NumPy reads what it wrote. Usage: trace_npy_test.py RAYMETER"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

SCENE = """v
from 0 0 5
at 0 0 0
up 0 1 0
angle 45
hither 1
resolution 4 4
f 1 1 1 1 0 0 0 1
s 0 0 0 1
p 3
4 -1 0
6 -1 0
5 1 0
"""


def trace(raymeter: str, folder: Path, rays: np.ndarray, query: str, *more: str) -> subprocess.CompletedProcess:
    np.save(folder / "rays.npy", rays)
    (folder / "scene.nff").write_text(SCENE)
    return subprocess.run([raymeter, "trace", "--scene", str(folder / "scene.nff"), "--technique", "bvh", "--rays", str(folder / "rays.npy"), "--query",
                           query, "--out", str(folder / "hits.npy"), *more], capture_output=True, text=True)


def rays_towards(x: np.ndarray) -> np.ndarray:
    rays = np.zeros((len(x), 8), dtype=np.float32)
    rays[:, 0] = x
    rays[:, 2] = 5
    rays[:, 6] = -1
    rays[:, 7] = np.inf
    return rays


def main(argv: list[str]) -> int:
    raymeter = argv[1]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rays = rays_towards(np.array([0, 5, 20], dtype=np.float32))

        result = trace(raymeter, folder, rays, "closest", "--stats", str(folder / "stats.json"))
        assert result.returncode == 0, result.stderr
        hits = np.load(folder / "hits.npy")
        assert hits.dtype == np.dtype([("t", "<f4"), ("prim", "<i4"), ("u", "<f4"), ("v", "<f4")]), hits.dtype
        assert hits.shape == (3,)
        assert hits["prim"].tolist() == [0, 1, -1], hits
        assert hits["t"].tolist() == [4, 5, np.inf], hits
        assert (hits["u"][1], hits["v"][1]) == (0.25, 0.5), hits  # the ray meets the triangle half way up, in the middle
        assert hits["u"][[0, 2]].tolist() == [0, 0]
        stats = json.loads((folder / "stats.json").read_text())
        assert stats["rays"] == 3 and stats["hits"] == 2 and stats["num_prims"] == 2, stats
        assert stats["counters"]["ray_count"] == 3 and stats["counters"]["prim_hits"] >= 2, stats

        result = trace(raymeter, folder, rays, "any", "--isa", "scalar", "--threads", "1")
        assert result.returncode == 0, result.stderr
        blocked = np.load(folder / "hits.npy")
        assert blocked.dtype == np.uint8 and blocked.tolist() == [1, 1, 0], blocked

        result = trace(raymeter, folder, np.zeros((0, 8), dtype=np.float32), "closest")
        assert result.returncode == 0 and np.load(folder / "hits.npy").shape == (0,), result.stderr

        (folder / "hits.npy").unlink()
        for bad in (rays.astype(np.float64), rays[:, :7], np.asfortranarray(rays), rays.ravel()):
            result = trace(raymeter, folder, bad, "closest")
            assert result.returncode == 2 and len(result.stderr.splitlines()) == 1, result
            assert not list(folder.glob("hits*")), "nothing may be left half-written"
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
