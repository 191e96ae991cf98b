#!/usr/bin/python3
"""`raymeter image` writes the picture, its counts and heat maps, or one line and nothing. Usage: image_test.py RAYMETER"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.image
import numpy as np

COUNTS = "primary primary_hit reflection reflection_hit refraction refraction_hit tir shadow shadow_blocked".split()


def image(raymeter: str, out: Path, *more: str, scene: str = "spd:balls:2") -> subprocess.CompletedProcess:
    return subprocess.run([raymeter, "image", "--scene", scene, "--technique", "bvh", "--out", str(out), *more], capture_output=True, text=True)


def pixels(path: Path) -> np.ndarray:
    return np.rint(matplotlib.image.imread(path)[:, :, :3] * 255).astype(int)


def check_picture(raymeter: str, folder: Path) -> None:
    out, stats_path = folder / "balls.png", folder / "stats.json"
    result = image(raymeter, out, "--size", "60x40", "--stats", str(stats_path), "--threads", "1")
    assert result.returncode == 0 and result.stdout == result.stderr == "", result
    assert pixels(out).shape == (40, 60, 3)
    stats = json.loads(stats_path.read_text())
    assert all(isinstance(stats[key], int) for key in COUNTS), stats
    assert stats["primary"] == 2400 and stats["reflection"] >= stats["reflection_hit"] > 0 and stats["refraction"] == stats["tir"] == 0, stats
    assert stats["counters"]["ray_count"] == stats["primary"] + stats["reflection"] + stats["shadow"], stats

    first = out.read_bytes()
    for more in (["--threads", "2"], ["--threads", "7", "--packet", "1"]):
        assert image(raymeter, out, "--size", "60x40", "--stats", str(stats_path), *more).returncode == 0
        assert out.read_bytes() == first, "the same picture on any number of threads"
        assert {key: json.loads(stats_path.read_text())[key] for key in COUNTS} == {key: stats[key] for key in COUNTS}

    image(raymeter, out, "--size", "9", "--depth", "1", "--stats", str(stats_path), "--camera", "spd")
    stats = json.loads(stats_path.read_text())
    assert pixels(out).shape == (9, 9, 3) and stats["camera"] == "spd" and stats["max_depth"] == 1 and stats["reflection"] == 0, stats


def check_heat_maps(raymeter: str, folder: Path) -> None:
    out, stats_path = folder / "heat.png", folder / "stats.json"
    for what, event in (("nodes", "node_visits"), ("tests", "prim_tests")):
        result = image(raymeter, out, "--size", "32", "--heatmap", what, "--stats", str(stats_path))
        scale = json.loads(stats_path.read_text())["heatmap"]
        assert result.returncode == 0 and result.stdout == "" and event in result.stderr and str(scale["most"]) in result.stderr, result
        assert scale["event"] == event and 0 < scale["mean"] <= scale["most"], scale
        heat = pixels(out)
        assert heat.shape == (32, 32, 3) and (heat == [253, 231, 37]).all(axis=2).any(), "some pixel is the hottest"


def check_empty_scene(raymeter: str, folder: Path) -> None:
    scene = folder / "empty.nff"
    scene.write_text("b 0.2 0.4 0.6\nv\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 8 6\nl 0 5 5\n")
    for more in ([], ["--heatmap", "tests"]):
        result = image(raymeter, folder / "empty.png", *more, scene=str(scene))
        assert result.returncode == 0, result.stderr
        expected = [68, 1, 84] if more else [51, 102, 153]
        assert (pixels(folder / "empty.png") == expected).all() and pixels(folder / "empty.png").shape == (6, 8, 3)


def check_errors(raymeter: str, folder: Path) -> None:
    out = folder / "bad.png"
    for more in (["--size", "0"], ["--size", "10x"], ["--size", "10x10x10"], ["--size", "99999999999"], ["--size", "65536"], ["--camera", "fisheye"], ["--depth", "-1"],
                 ["--min-weight", "-1"], ["--min-weight", "nan"], ["--heatmap", "rays"], ["--isa", "mmx"], ["--threads", "0"], ["--packet", "65"],
                 ["--stats", str(folder / "nowhere" / "stats.json")]):
        result = image(raymeter, out, *more)
        assert result.returncode == 2 and result.stdout == "" and result.stderr, (more, result)
        assert more[0] in result.stderr or "nowhere" in result.stderr, (more, result)
        assert not list(folder.glob("bad*")), "nothing may be left half-written"
    for scene in ("spd:ballz", str(folder / "none.nff")):
        result = image(raymeter, out, scene=scene)
        assert result.returncode == 2 and len(result.stderr.splitlines()) == 1 and not list(folder.glob("bad*")), result


def main(argv: list[str]) -> int:
    with tempfile.TemporaryDirectory() as name:
        for check in (check_picture, check_heat_maps, check_empty_scene, check_errors):
            check(argv[1], Path(name))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
