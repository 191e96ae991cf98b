"""The tables of the report as data, the same for Markdown and HTML."""

from collections.abc import Callable, Sequence

from .cells import SETTING, Best, Cell, best_cells, finite, isa_rank, rays_of, setting_key, techniques_of, varying_settings
from .figure_sweep import sweep
from .numbers import integer, precise, significant, with_interval
from .records import Record, Value
from .table import SETTING_TITLES, Column, Field, Table, fixed_settings, key_columns, key_fields, number_field, setting_field


WRONG = ("false_miss", "false_hit", "wrong_prim")


def best_table(cells: Sequence[Cell]) -> Table:
    """The fastest technique per scene and ray kind."""
    best = best_cells(cells)
    varying = varying_settings([one.winner for one in best.values()])
    columns = [
        Column("scene", number=False), Column("primitives"), Column("rays", number=False), Column("fastest", number=False),
        *(Column(SETTING_TITLES[name], number=name != "isa") for name in varying),
        Column("time per ray", "ns"), Column("95 % interval", "ns"), Column("speed", "Mrays/s"),
        Column("next", number=False), Column("its time", "×"),
        Column("intervals", number=False),
    ]
    rows = [best_row(one, varying) for one in best.values()]
    caption = (
        "Fastest technique per scene and ray kind, each technique at its own best instruction set and packet size, on the fewest threads "
        "measured. “overlap” means that the confidence intervals of the two overlap: the order is not settled."
    )
    return Table("best", caption, columns, rows, 1)


def best_row(best: Best, varying: Sequence[str]) -> list[Field]:
    cell, other = best.winner, best.runner_up
    median, interval = with_interval(cell.number("median_ns_per_ray"), cell.number("ci_lo"), cell.number("ci_hi"))
    slower = None
    if other is not None:
        slower = (other.number("median_ns_per_ray") or 0.0) / (cell.number("median_ns_per_ray") or 1.0)
    return [
        Field(cell.scene), number_field(cell.summary["num_prims"], integer), Field(cell.rays), Field(cell.label, tone="best"),
        *(setting_field(cell.summary[name]) for name in varying),
        Field(median, cell.number("median_ns_per_ray")), Field(interval), number_field(cell.summary["mrays_per_s"]),
        Field(other.label if other else ""), number_field(slower), Field("" if other is None else "apart" if best.clear else "overlap"),
    ]


def results_table(cells: Sequence[Cell]) -> Table:
    """Every cell that was measured, with its timing, and every one that failed; the others stand in `left_out_table`."""
    cells = [cell for cell in cells if cell.state in ("ok", "failed") or cell.number("median_ns_per_ray") is not None]
    varying = varying_settings(cells)
    winners = {id(one.winner) for one in best_cells(cells).values()}
    columns = [
        *key_columns(varying),
        Column("samples"),
        Column("time per ray", "ns", hint="median_ns_per_ray"),
        Column("95 % interval", "ns", hint="ci_lo, ci_hi"),
        Column("speed", "Mrays/s", hint="mrays_per_s"),
        Column("time vs reference", "×", hint="ratio_vs_ref"),
        Column("95 % interval", "×", hint="ratio_lo, ratio_hi"),
        Column("build + frame", "ms", hint="time_to_image_ms"),
        Column("chose", number=False),
        Column("status", number=False),
    ]
    rows = []
    for cell in cells:
        median, interval = with_interval(cell.number("median_ns_per_ray"), cell.number("ci_lo"), cell.number("ci_hi"))
        ratio, ratio_interval = with_interval(cell.number("ratio_vs_ref"), cell.number("ratio_lo"), cell.number("ratio_hi"))
        tone = "best" if id(cell) in winners else ""
        rows.append([
            *key_fields(cell, varying),
            number_field(cell.summary["n"], integer), Field(median, cell.number("median_ns_per_ray"), tone), Field(interval),
            number_field(cell.summary["mrays_per_s"]), Field(ratio, cell.number("ratio_vs_ref")), Field(ratio_interval),
            number_field(cell.summary["time_to_image_ms"]), Field(cell.choice), Field(str(cell.summary["status"]), tone="bad" if cell.state == "failed" else ""),
        ])
    caption = "Medians over all timed samples; bold: the fastest of its scene and ray kind. Empty fields were not measured." + fixed_settings(cells)
    return Table("results", caption, columns, rows, 2).without_empty()


def problem_table(cells: Sequence[Cell], reasons: dict[str, str]) -> Table:
    """Cells that failed: wrong hits, time-outs, errors."""
    rows = []
    for cell in (cell for cell in cells if cell.state == "failed"):
        accuracy = cell.accuracy
        reason = reasons.get(str(cell.summary["cell_id"]), "")
        rows.append([
            *key_fields(cell, SETTING[:3]),
            Field(str(cell.summary["status"]), tone="bad" if cell.state == "failed" else ""), Field(reason),
            number_field(cell.summary["hit_mismatch"], integer),
            *(number_field(accuracy.get(name), integer) for name in WRONG),
        ])
    columns = [
        *key_columns(SETTING[:3]), Column("status", number=False), Column("reason", number=False), Column("mismatches", "rays"), Column("false misses", "rays"),
        Column("false hits", "rays"), Column("wrong primitive", "rays"),
    ]
    caption = "Wrong hits, a time-out or an error: these cells have no timing, for a technique with wrong answers has no speed."
    return Table("problems", caption, columns, rows).without_empty(named=False)


def left_out_table(cells: Sequence[Cell], reasons: dict[str, str]) -> Table:
    """Skipped and unfinished cells, counted by instruction set and reason."""
    groups: dict[tuple[str, str, str], list[Cell]] = {}
    for cell in (cell for cell in cells if cell.state in ("skipped", "unfinished")):
        groups.setdefault((cell.state, str(cell.summary["isa"]), reasons.get(str(cell.summary["cell_id"]), "")), []).append(cell)
    columns = [Column(title, number=title == "cells") for title in ("status", "ISA", "cells", "scenes", "techniques", "reason")]
    rows = []
    for (state, isa, reason), group in groups.items():
        scenes, techniques = (", ".join(dict.fromkeys(names)) for names in ([cell.scene for cell in group], [cell.label for cell in group]))
        rows.append([Field(state), Field(isa), number_field(float(len(group)), integer), Field(scenes), Field(techniques), Field(reason)])
    caption = "Planned cells that were not measured: skipped where the machine cannot run them, unfinished where the run was interrupted."
    return Table("left-out", caption, columns, rows).without_empty(named=False)


def per_ray(counters: Record, event: str) -> float | None:
    """An event's count divided by the rays; None where it was not counted."""
    count, rays = finite(counters.get(event)), finite(counters.get("ray_count"))
    return None if count is None or not rays else count / rays


def counters_table(cells: Sequence[Cell]) -> Table:
    """Counts per ray; they do not depend on the number of threads, so that each is shown once."""
    cells = [cell for cell in cells if cell.counters]
    varying = [name for name in varying_settings(cells) if name != "threads"]
    events = (
        ("node_visits", "node visits"), ("leaf_visits", "leaf visits"), ("empty_leaf_visits", "empty leaf visits"), ("volume_tests", "volume tests"),
        ("prim_tests", "primitive tests"), ("prim_hits", "primitive hits"),
    )
    columns = [
        *key_columns(varying), Column("rays counted"), *(Column(title, "per ray", hint=name) for name, title in events),
        Column("node visits", "times reached / ray", hint="node_visits_packets"), Column("primitive tests", "times reached / ray", hint="prim_tests_packets"),
        Column("SIMD utilisation", "%", hint="simd_utilization"),
    ]
    rows: list[list[Field]] = []
    seen: set[tuple] = set()
    for cell in cells:
        fields = [
            *key_fields(cell, varying), number_field(cell.counters.get("ray_count"), integer),
            *(number_field(per_ray(cell.counters, name), precise) for name, _ in events),
            number_field(per_ray(cell.counters, "node_visits_packets"), precise), number_field(per_ray(cell.counters, "prim_tests_packets"), precise),
            number_field(cell.counters.get("simd_utilization"), factor=100.0),
        ]
        key = tuple((one.text, one.value) for one in fields)
        if key not in seen:
            seen.add(key)
            rows.append(fields)
    caption = (
        "Counts over live lanes, per ray. “Times reached” counts each execution of the code once, however many lanes were live: "
        "the ratio of the two views is what packets save. Counts do not depend on the number of threads." + fixed_settings(cells)
    )
    return Table("counters", caption, columns, rows, 2).without_empty()


def builds_table(cells: Sequence[Cell]) -> Table:
    """One row per distinct build."""
    cells = [cell for cell in cells if cell.build]
    varying = [name for name in ("threads",) if name in varying_settings(cells)]
    measures: tuple[tuple[str, str, str, Callable[[Value], str], float], ...] = (
        ("build_ms", "build time", "ms", significant, 1.0), ("build_ci_lo", "95 % from", "ms", significant, 1.0),
        ("build_ci_hi", "95 % to", "ms", significant, 1.0), ("mprims_per_s", "build speed", "Mprims/s", significant, 1.0),
        ("nodes", "nodes", "", integer, 1.0), ("interior_nodes", "interior", "", integer, 1.0), ("leaves", "leaves", "", integer, 1.0),
        ("empty_leaves", "empty leaves", "", integer, 1.0), ("references", "references", "", integer, 1.0), ("tree_depth", "depth", "", integer, 1.0),
        ("sah_cost", "SAH cost", "", significant, 1.0), ("epo", "EPO", "", significant, 1.0), ("mem_bytes", "memory", "MiB", significant, 2.0**-20),
        ("bytes_per_prim", "memory per primitive", "bytes", significant, 1.0), ("epo_se", "EPO, standard error", "", significant, 1.0),
        ("sibling_distance", "sibling distance", "", significant, 1.0), ("node_volume", "volume per node", "", significant, 1.0),
        ("total_volume", "total volume", "", significant, 1.0), ("cost_depth", "depth of cost, mean", "", significant, 1.0),
        ("cost_depth_p90", "depth of cost, 90 %", "", integer, 1.0), ("volume_area", "area of volumes", "", significant, 1.0),
    )
    columns = [*key_columns(varying, with_rays=False), *(Column(title, unit, hint=name) for name, title, unit, _, _ in measures)]
    rows: list[list[Field]] = []
    seen: set[tuple] = set()
    for cell in cells:
        key = (cell.run, cell.scene, cell.technique[:2], cell.summary["threads"] if varying else None)
        if key not in seen:
            seen.add(key)
            values = [number_field(cell.build.get(name), form, factor) for name, _, _, form, factor in measures]
            rows.append([*key_fields(cell, varying, with_rays=False), *values])
    caption = "What was built, once per scene and technique: one build serves all its ray kinds. Empty fields do not apply or were not measured."
    return Table("builds", caption, columns, rows, 1).without_empty()


def accuracy_table(cells: Sequence[Cell]) -> Table:
    """How the hits compare with the exact oracle."""
    cells = [cell for cell in cells if cell.accuracy]
    varying = varying_settings(cells)
    counts = (
        ("rays_checked", "rays checked"), ("false_miss", "false misses"), ("false_hit", "false hits"), ("wrong_prim", "wrong primitive"),
        ("self_hits", "self hits"),
    )
    errors = (("t_ulp_p50", "median", "ulp"), ("t_ulp_p99", "99 %", "ulp"), ("t_ulp_max", "largest", "ulp"))
    images = (("image_rmse", "image RMSE", ""), ("image_psnr", "image PSNR", "dB"), ("image_ssim", "image SSIM", ""))
    walks = (
        ("cell_rays_checked", "walks checked", "rays"), ("cell_rays_missing", "miss a cell", "rays"), ("cell_rays_at_risk", "at risk", "rays"),
        ("cells_missed", "cells missed", ""), ("longest_missed", "longest way in one", "cells"),
    )
    columns = [
        *key_columns(varying), *(Column(title, "rays", hint=name) for name, title in counts),
        *(Column(f"error of t, {title}", unit, hint=name) for name, title, unit in errors), *(Column(title, unit, hint=name) for name, title, unit in (*images, *walks)),
    ]
    rows = []
    for cell in cells:
        checks = []
        for name, _ in counts:
            count = number_field(cell.accuracy.get(name), integer)
            checks.append(Field(count.text, count.value, "bad") if name in WRONG and count.value else count)
        rows.append([*key_fields(cell, varying), *checks, *(number_field(cell.accuracy.get(name)) for name, _, _ in (*errors, *images, *walks))])
    caption = (
        "Hits held against the exact oracle, error of the distance t in units in the last place (ulp) of a float. Any miss, false hit or wrong "
        "primitive makes a cell fail, but for a peer from outside." + fixed_settings(cells)
    )
    return Table("accuracy", caption, columns, rows, 2).without_empty()


def simd_table(cells: Sequence[Cell]) -> Table | None:
    """Speed-up over ISA and packet size together; None unless both vary."""
    timed = [cell for cell in cells if cell.state == "ok" and cell.number("mrays_per_s")]
    if {"isa", "packet"} - set(varying_settings(timed)):
        return None
    isas = sorted({cell.summary["isa"] for cell in timed}, key=isa_rank)
    columns = [Column("rays", number=False), Column("technique", number=False), Column("rays per packet"), *(Column(str(isa), "×") for isa in isas)]
    rows: list[list[Field]] = []
    for rays in rays_of(timed):
        for technique in techniques_of(timed):
            for packet in sorted({cell.summary["packet"] for cell in timed}, key=setting_key("packet")):
                data = sweep([cell for cell in timed if (cell.rays, cell.label, cell.summary["packet"]) == (rays, technique, packet)], "isa")
                if data:
                    mean = {str(value): speed for value, speed in data.mean(rays, technique).items()}
                    rows.append([Field(rays), Field(technique), setting_field(packet), *(number_field(mean.get(str(isa))) for isa in isas)])
    caption = f"Speed of each instruction set relative to {isas[0]} at the same packet size, geometric means over scenes."
    return Table("simd", caption, columns, rows, 2)


def technique_table(cells: Sequence[Cell]) -> Table:
    """Short labels and what they stand for."""
    full: dict[str, Cell] = {}
    for cell in cells:
        full.setdefault(cell.label, cell)
    rows = [[Field(label), *(Field(part) for part in cell.technique)] for label, cell in full.items()]
    columns = [Column(title, number=False) for title in ("label", "structure", "parameters", "first hit", "occlusion")]
    return Table("techniques", "The techniques of this report. A label holds only the parameters that tell it from others of its structure.", columns, rows)
