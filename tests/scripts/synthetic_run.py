"""Writes results folders with the columns of `raymeter run` and made-up, reproducible values."""

import csv
import json
import math
import random
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
from raymeter_report.records import EVENTS, FILE_COLUMNS, KEY_COLUMNS

SCENES = {"spd:tetra:6": 4096, "spd:balls:4": 7382, "spd:gears:4": 9345, "gen:terrain:512": 524288}
STRUCTURES = {"list": "volume=none", "bvh": "volume=aabb,builder=binned_sah", "grid": "density=4"}
RAYS = {"primary": 1.0, "shadow": 0.8, "diffuse": 2.6}
WIDTH = {"scalar": 1, "sse42": 4, "avx2": 8, "avx512": 16}


def cell_values(scene: str, structure: str, rays: str, isa: str, packet: int, threads: int) -> dict[str, float]:
    """Tests, visits and time of one cell from a simple cost model."""
    prims = SCENES[scene]
    tests = {"list": float(prims), "bvh": 2.2 + 0.4 * math.log2(prims), "grid": 3.5 + 0.02 * math.sqrt(prims)}[structure]
    visits = {"list": 0.0, "bvh": 3.1 * math.log2(prims), "grid": 0.9 * prims ** (1 / 3)}[structure]
    width = WIDTH[isa]
    coherent = 1.0 if rays == "primary" else 0.75 if rays == "shadow" else 0.3
    speed_up = 1 + (min(width, packet) - 1) * coherent * 0.8
    time = (9.0 * tests + 6.0 * visits + 20.0) * RAYS[rays] / speed_up / (1 + 0.9 * (threads - 1))
    return {"tests": tests, "visits": visits, "ns": time, "utilization": coherent}


def rows(isas: list[str], packets: list[int], threads: list[int], structures: dict[str, str], scenes: list[str]) -> dict[str, list[dict[str, Any]]]:
    """All tables for the product of the arguments; AVX-512 is skipped, gears with grid and diffuse rays has wrong hits."""
    generator = random.Random(7)
    tables: dict[str, list[dict[str, Any]]] = {kind: [] for kind in FILE_COLUMNS}
    order = 0
    product = [(s, t, p, i, k, r) for s in scenes for t in structures for r in RAYS for i in isas for k in packets for p in threads]
    for number, (scene, structure, thread, isa, packet, ray) in enumerate(product):
        key = dict(cell_id=f"c{number:04d}-5ce9e", scene=scene, num_prims=SCENES[scene], needs="sphere;polygon", rays=ray)
        key |= dict(phase="any" if ray == "shadow" else "closest", structure=structure.split("#")[0], params=structures[structure], first_hit="cast")
        key |= dict(occlusion="none", max_depth=5, min_weight=0, isa=isa, simd_width=WIDTH[isa], packet=packet, threads=thread)
        if isa == "avx512":
            tables["summary"].append(key | {"status": "skipped"})
            continue
        value = cell_values(scene, structure.split("#")[0], ray, isa, packet, thread)
        value["ns"] *= 1 + 0.3 * (len(structures[structure]) % 5)
        wrong = scene == "spd:gears:4" and structure == "grid" and ray == "diffuse"
        accuracy = dict(rays_checked=10000, false_miss=3 if wrong else 0, false_hit=0, wrong_prim=1 if wrong else 0, self_hits=0)
        tables["accuracy"].append(key | accuracy | dict(t_ulp_p50=0.5, t_ulp_p99=2, t_ulp_max=7.5, image_psnr=math.inf))
        build_ms = SCENES[scene] * {"list": 1e-5, "bvh": 4e-4, "grid": 1.1e-4}[structure.split("#")[0]]
        memory = SCENES[scene] * {"list": 4, "bvh": 71, "grid": 38}[structure.split("#")[0]]
        tables["builds"].append(
            key | dict(build_ms=build_ms, mprims_per_s=1e-3 * SCENES[scene] / build_ms, nodes=SCENES[scene] // 2, interior_nodes=SCENES[scene] // 4)
            | dict(leaves=SCENES[scene] // 4, empty_leaves=0, references=SCENES[scene], tree_depth=21, mem_bytes=memory)
            | dict(bytes_per_prim=memory / SCENES[scene], break_even_rays=math.inf if structure == "list" else 5123)
        )
        if wrong:
            tables["summary"].append(key | dict(build_ms=build_ms, mem_bytes=memory, hit_mismatch=4, status="wrong"))
            continue
        events = dict(zip(EVENTS, [value["visits"], value["visits"] / 3, 0, 0, value["tests"], 0.8, 0, 0]))
        counts = {event: round(262144 * amount) for event, amount in events.items()}
        counts |= {f"{event}_packets": round(amount / packet / value["utilization"]) for event, amount in list(counts.items())}
        per_ray = dict(node_visits_per_ray=value["visits"], prim_tests_per_ray=value["tests"], simd_utilization=value["utilization"])
        tables["counters"].append(key | dict(ray_count=262144) | counts | per_ray)
        samples = [value["ns"] * (1 + abs(generator.gauss(0, 0.012)) + (0.08 if generator.random() < 0.03 else 0)) for _ in range(15)]
        for place, sample in enumerate(samples):
            order += 1
            tables["samples"].append(
                key | dict(sample=place, order_index=place * len(product) + number, trace_ms=sample * 0.262144, rays_traced=262144)
                | dict(mrays_per_s=1e3 / sample, ns_per_ray=sample, status="ok")
            )
        samples.sort()
        timing = dict(n=15, median_ns_per_ray=samples[7], ci_lo=samples[3], ci_hi=samples[11], mad=samples[9] - samples[7], mrays_per_s=1e3 / samples[7])
        tables["summary"].append(key | timing | dict(build_ms=build_ms, mem_bytes=memory, hit_mismatch=0, status="ok") | per_ray)
    return tables


def write_run(
    folder: Path, isas: list[str] = ["avx2", "avx512"], packets: list[int] = [8], threads: list[int] = [1],
    structures: dict[str, str] = STRUCTURES, scenes: list[str] = list(SCENES), kinds: list[str] = list(FILE_COLUMNS),
) -> dict[str, list[dict[str, Any]]]:
    """Writes the folder and returns the tables as they were before formatting."""
    folder.mkdir(parents=True, exist_ok=True)
    tables = rows(isas, packets, threads, structures, scenes)
    for kind in kinds:
        extra = ["tree_depth" if column == "max_depth" else column for column in FILE_COLUMNS[kind]]
        with (folder / f"{kind}.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(KEY_COLUMNS + FILE_COLUMNS[kind])
            for row in tables[kind]:
                writer.writerow([row.get(column, "") for column in KEY_COLUMNS + extra])
    with (folder / "break_even.csv").open("w", encoding="utf-8") as file:
        file.write("cell_id,against,break_even_rays\n")
        timed = [row for row in tables["summary"] if row["status"] == "ok"]
        for row, other in ((row, other) for row in timed for other in timed if row is not other):
            if all(row[column] == other[column] for column in ("scene", "rays", "isa", "packet", "threads")):
                words = {("list", "bvh"): "never", ("grid", "bvh"): "always"}
                file.write(f"{row['cell_id']},{other['cell_id']},{words.get((row['structure'], other['structure']), 51234)}\n")
    skipped = [row["cell_id"] for row in tables["summary"] if row["status"] == "skipped"]
    log = [{"type": "check", "cell": cell_id.split("-")[0], "status": "skipped", "reason": "the CPU lacks avx512"} for cell_id in skipped]
    (folder / "samples.jsonl").write_text("".join(json.dumps(one) + "\n" for one in log), encoding="utf-8")
    manifest = {"name": "synthetic", "state": "complete", "config": "configs/synthetic.json", "config_text": {"name": "synthetic", "seed": 42}}
    manifest |= {"command": "raymeter run configs/synthetic.json", "begun_utc": "20261122T170000Z", "host": "testbench", "cpu": "Example CPU"}
    manifest |= {"git_sha": "1a2b3c4", "git_dirty": False, "cells": len(tables["summary"])}
    (folder / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    environment = {"host": "testbench", "cpu": {"model": "Example CPU", "cores": 2, "virtual_machine": True}, "frequency": {"governor": None, "turbo": None}}
    (folder / "environment.json").write_text(json.dumps(environment), encoding="utf-8")
    return tables
