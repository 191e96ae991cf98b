"""The figures of a report, each with its title and caption; none where the data do not give it."""

import statistics
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from .best_settings import best_settings
from .cells import SETTING, Cell, describe_setting, finite, main_setting, rays_of, scenes_of, varying_settings
from .figure_best import best_figure
from .figure_dots import Dot, Panel, dot_figure
from .figure_error import error_figure
from .figure_scaling import scaling_figure
from .figure_precision import precision_figure, price_figure
from .figure_scatter import Point, run_order_figure, scatter_figure
from .figure_peer import peer_duels, peer_figure
from .figure_memory import budget_lines, memory_figure
from .figure_price_list import price_list_figure
from .figure_simd import against_one_ray, simd_figure
from .figure_sweep import sweep, sweep_figure
from .figure_wrong import wrong_answers, wrong_figure
from .frames import cuts
from .price_list import price_list
from .records import Record, Run, whole
from .scaling import growths
from .style import Look
from .work_precision import prices, shared_by_lines, work_precision


@dataclass(frozen=True)
class Draft:
    """A figure before it is written."""

    name: str
    title: str
    caption: str
    figure: Figure


def scene_sizes(cells: Sequence[Cell]) -> dict[str, float | None]:
    sizes = {cell.scene: cell.number("num_prims") for cell in cells if cell.number("num_prims") is not None}
    return {scene: sizes.get(scene) for scene in scenes_of(cells)}


def counter_draft(name: str, title: str, column: str, cells: Sequence[Cell], look_of: dict[str, Look], caption: str) -> Draft | None:
    """A dot plot of one counter; None where it was not measured or is zero throughout."""
    having = [cell for cell in cells if cell.number(column)]
    if not having:
        return None
    panels = [
        Panel(rays, title.lower(), [Dot(cell.scene, cell.label, cell.number(column) or 0.0) for cell in having if cell.rays == rays])
        for rays in rays_of(having)
    ]
    return Draft(name, title, caption, dot_figure(panels, scene_sizes(having), look_of))


def speed_draft(cells: Sequence[Cell], chosen: Sequence[Cell], look_of: dict[str, Look], where: str) -> Draft | None:
    """Mrays/s with intervals; those of the time per ray are turned into speeds."""
    timed = [cell for cell in chosen if cell.number("mrays_per_s") is not None]
    if not timed:
        return None
    measured = {(cell.scene, cell.rays, cell.label) for cell in timed}
    failed = {(cell.scene, cell.rays, cell.label) for cell in cells if cell.state == "failed"} - measured
    panels = []
    for rays in rays_of(timed):
        dots = [
            Dot(cell.scene, cell.label, cell.number("mrays_per_s") or 0.0, speed_of(cell.number("ci_hi")), speed_of(cell.number("ci_lo")))
            for cell in timed
            if cell.rays == rays
        ]
        panels.append(Panel(rays, "million rays per second", dots, sorted((scene, label) for scene, kind, label in failed if kind == rays)))
    scenes = {scene: size for scene, size in scene_sizes(cells).items() if scene in {cell.scene for cell in timed} | {key[0] for key in failed}}
    caption = (
        f"Rays per second at {where}. Further right is better. Bars are 95 % confidence intervals of the median; where none is visible it is "
        "narrower than the mark, and where two overlap the order of the two techniques is not settled by this run."
    )
    return Draft("mrays_per_s", "Speed", caption, dot_figure(panels, scenes, look_of))


def speed_of(nanoseconds: float | None) -> float | None:
    """Time per ray [ns] as million rays per second."""
    return 1e3 / nanoseconds if nanoseconds else None


def points_of(cells: Sequence[Cell]) -> list[Point]:
    """The cells that have both tests and time, as points of a logarithmic plane."""
    points = []
    for cell in cells:
        tests, time = cell.number("prim_tests_per_ray"), cell.number("median_ns_per_ray")
        if tests and time and tests > 0 and time > 0:
            points.append(Point(cell.rays, cell.label, cell.scene, tests, time))
    return points


def scatter_draft(cells: Sequence[Cell], look_of: dict[str, Look], where: str) -> Draft | None:
    """Tests per ray against time per ray."""
    points = points_of(cells)
    if not points:
        return None
    caption = (
        f"Does saving tests save time? Each mark is one technique on one scene at {where}. Down and left is better. On a dotted diagonal all "
        "time divided by all primitive tests is constant: a technique far above the lower diagonals spends its time elsewhere, in traversal."
    )
    kinds = [rays for rays in rays_of(cells) if any(point.rays == rays for point in points)]
    return Draft("tests_vs_time", "Tests per ray against time per ray", caption, scatter_figure(points, kinds, look_of))


def build_draft(cells: Sequence[Cell], look_of: dict[str, Look]) -> Draft | None:
    """Build time and memory, one value per scene and technique: one build serves all its ray kinds."""
    panels = []
    for title, axis, column, factor in (
        ("build time", "milliseconds", "build_ms", 1.0), ("memory", "MiB", "mem_bytes", 2.0**-20), ("memory per primitive", "bytes", "bytes_per_prim", 1.0)
    ):
        values: dict[tuple[str, str], list[float]] = defaultdict(list)
        for cell in cells:
            value = finite(cell.build.get(column))
            if value is not None and value > 0:
                values[cell.scene, cell.label].append(value * factor)
        dots = [Dot(scene, label, statistics.median(all_of)) for (scene, label), all_of in values.items()]
        if dots:
            panels.append(Panel(title, axis, dots))
    if not panels:
        return None
    caption = (
        "What a structure costs before the first ray: its build time (T_B), its memory without the scene, and the memory of structure and scene "
        "together per primitive. Further left is better."
    )
    return Draft("build", "Build time and memory", caption, dot_figure(panels, scene_sizes(cells), look_of, shared_scale=False))


def peer_draft(cells: Sequence[Cell], look_of: dict[str, Look]) -> Draft | None:
    """Speed against the peer from outside; None where none was timed."""
    found = peer_duels(cells)
    compared = [duel for of_kind in found.values() for duel in of_kind]
    if not compared:
        return None
    peer = compared[0].rival.technique[0]
    where = describe_setting(main_setting([duel.cell for duel in compared]), without="isa")
    caption = (
        f"Speed relative to {peer} on the same rays of the same run at {where}, {peer} in the mode and with the tree that is fastest there, limited to the same "
        "instruction set, its conversion of rays included. Right of the line raymeter is faster. Open marks: against its watertight mode. Bars are 95 % confidence intervals of "
        "the median ratio; the geometric mean is over the scenes of triangles alone."
    )
    return Draft("speed_vs_peer", f"Speed against {peer}", caption, peer_figure(found, scene_sizes(cells), look_of))


def best_drafts(cells: Sequence[Cell], look_of: dict[str, Look]) -> list[Draft]:
    """A figure for each ray kind; none where structures were not measured at several settings."""
    best = best_settings(cells)
    varying = varying_settings([cell for cell in cells if cell.state == "ok"])
    result = []
    for rays in dict.fromkeys(kind for kind, _ in best):
        figure = best_figure({scene: chosen for (kind, scene), chosen in best.items() if kind == rays}, varying, look_of)
        caption = (
            f"Each technique at its best, {rays} rays: at the setting, named on the right, in which its median time is least. Filled: the best of the scene in that measure. "
            "Left is better but for speed; a technique without a mark has none of it. Steps are inner nodes opened and leaves or cells entered; build and memory include "
            "what is made on demand, memory the scene."
        )
        result.append(Draft(f"side_by_side_{rays.split(' ')[0]}", f"Side by side: {rays} rays", caption, figure))
    return result


def sweep_drafts(cells: Sequence[Cell], look_of: dict[str, Look]) -> list[Draft]:
    """Speed-up over ISA, packet size and threads, each where the run varied it."""
    result = []
    for column, name, title, axis, baseline in (
        ("isa", "isa_speedup", "Speed-up of the instruction sets", "instruction set", "the first one"),
        ("packet", "packet_speedup", "Speed-up of packets", "rays per packet", "the smallest size"),
        ("threads", "thread_scaling", "Thread scaling", "threads", "the fewest threads"),
    ):
        data = sweep(cells, column)
        if data is None:
            continue
        caption = (
            f"Speed relative to {baseline} ({data.values[0]:g}) at {describe_setting(data.setting)}. " if isinstance(data.values[0], float)
            else f"Speed relative to {data.values[0]} at {describe_setting(data.setting)}. "
        ) + "Lines are geometric means over scenes, faint marks the single scenes."
        if column == "threads":
            caption += " The dashed line is perfect scaling."
        result.append(Draft(name, title, caption, sweep_figure(data, cells, look_of, axis, ideal=column == "threads")))
    return result


def simd_draft(runs: Sequence[Run], cells: Sequence[Cell]) -> Draft | None:
    """Speed of packets against one ray at a time; None where no config asks for it."""
    found = against_one_ray(runs, cells)
    if not found:
        return None
    packets = " or ".join(dict.fromkeys(f"{cell.summary['packet']:g}" for cell in found))
    scalar = " or ".join(dict.fromkeys(str(run.reference["isa"]) for run in runs if any(cell.run == run.name for cell in found)))
    caption = (
        f"How many times as fast packets of {packets} rays are on each instruction set as one ray at a time on the {scalar} one: the same technique with the same parameters on the same rays and as "
        f"many threads, in the same run. At the line both are as fast; {scalar} packets beyond it gain by what their rays share, the others by their registers besides. Bars are 95 % confidence intervals of the median ratio."
    )
    return Draft("simd_speedup", "What packets and instruction sets give", caption, simd_figure(found))


def scaling_draft(cells: Sequence[Cell], look_of: dict[str, Look]) -> Draft | None:
    """Costs against the number of primitives; None where no family of scenes has three sizes."""
    found = growths(cells)
    if not found:
        return None
    caption = (
        f"Costs against the number of primitives, at {describe_setting(main_setting(cells), without='threads')}: scenes of a panel differ in size alone. Solid lines: on the fewest "
        "threads; dashed: on more. In brackets the exponents of the power laws that fit the times per ray; the table has them one by one, with their intervals."
    )
    return Draft("scaling", "Cost against primitives", caption, scaling_figure(found, look_of))


def price_list_draft(runs: Sequence[Run], cells: Sequence[Cell]) -> Draft | None:
    """What each ingredient brings; None where no config names any."""
    found = price_list(runs, cells)
    if not found:
        return None
    caption = (
        "What each ingredient brings: how many times as fast rays are with it as without. Bars are geometric means over scenes, marks the single scenes with the 95 % "
        "confidence interval of the median ratio over the rounds of the run. The table says which settings stand behind an ingredient."
    )
    return Draft("price_list", "Price list", caption, price_list_figure(found))


def memory_draft(cells: Sequence[Cell], look_of: dict[str, Look]) -> Draft | None:
    """Tests per ray against the memory of cells that are made on demand; None where no budget was swept."""
    lines = budget_lines(cells)
    if not lines:
        return None
    caption = (
        "What memory buys a technique that makes its cells when rays fall into them: primitive tests per ray (N_IT) against the memory that the cells hold, along a "
        f"line at rising budgets, at {describe_setting(dict(zip(SETTING, lines[0][0].setting)))}. Down and left is better."
    )
    return Draft("tests_vs_memory", "Tests per ray against memory", caption, memory_figure(lines, look_of))


def error_draft(cells: Sequence[Cell], look_of: dict[str, Look]) -> Draft | None:
    """Speed against error of images whose rays were cut; None where none was."""
    compared = cuts(cells)
    if not compared:
        return None
    depths = sorted({finite(cut.cell.summary["max_depth"]) or 0.0 for cut in compared}, reverse=True)
    lines = f" Solid: depth {depths[0]:g}; dashed: {', '.join(f'{depth:g}' for depth in depths[1:])}." if len(depths) > 1 else f" All images: depth {depths[0]:g}."
    weights = sorted({cut.weight for cut in compared if cut.weight > 0})
    caption = (
        "What adaptive depth control gains and what it costs: speed-up of a frame over the one that is cut nowhere, against the error of the image (root mean square "
        f"over pixels and channels, white being 1). Along a line the least weight rises from 0 through {weights[0]:g} to {weights[-1]:g}. Up and left is better; marks "
        f"above 0 are faster at the same image." + lines
    )
    return Draft("speed_vs_error", "Speed against error", caption, error_figure(compared, look_of))


def precision_draft(cells: Sequence[Cell]) -> Draft | None:
    """Speed against wrong answers; None where no answer was wrong."""
    panels = work_precision(cells)
    if not panels:
        return None
    points = [point for of_panel in panels.values() for point in of_panel]
    shared = shared_by_lines(panels)
    where = describe_setting(main_setting([point.cell for point in points]))
    caption = (
        f"What wrong answers buy, at {where}: rays per second against the share of rays with a false miss, a false hit or a wrong primitive, against verified answers. "
        "Up and left is better; what stands at 0 had none, so that its rate is below 3 in the number of rays at 95 % confidence. The star is the robust default, or else the setting that most cells share; a line is one "
        "knob, the grey step the front: nothing below or right of it is worth its error. Bars are 95 % confidence intervals of the median." + (f" All along the lines: {shared}." if shared else "")
    )
    return Draft("speed_vs_wrong_answers", "Speed against wrong answers", caption, precision_figure(panels))


def price_draft(cells: Sequence[Cell]) -> Draft | None:
    """The robust tests against the fastest weak ones; None where no weak ones were timed."""
    found = prices(cells)
    if not found:
        return None
    caption = (
        "The price of right answers: time of the robust tests, in packets as the weak ones are or by the traversal named, relative to the fastest of the weak ones on the same rays of the same run. At 1 robustness is free, at "
        "1.1 it costs 10 %. Bars are 95 % confidence intervals of the median ratio; which tests were fastest, and how often they were wrong, stands in the table."
    )
    return Draft("price_of_robustness", "The price of robustness", caption, price_figure(found, scene_sizes([price.robust for price in found])))


def wrong_draft(cells: Sequence[Cell], look_of: dict[str, Look]) -> Draft | None:
    """Wrong answers by technique; None where none erred, or where speed against error shows it."""
    panels = wrong_answers(cells) if not work_precision(cells) else {}
    if not panels:
        return None
    caption = (
        "Wrong answers of each technique on the same rays: false misses, false hits and wrong primitives per ray, the worst of all instruction sets and packet sizes, on a logarithmic axis. "
        "What stands at 0 had none among the rays that were held against what is known of them, so that its rate is below 3 in their number at 95 % confidence."
    )
    return Draft("wrong_answers", "Wrong answers", caption, wrong_figure(panels, cells, look_of))


def run_order_draft(runs: Sequence[Run], cells: Sequence[Cell], look_of: dict[str, Look]) -> Draft | None:
    """Samples in their order, for a single run."""
    if len(runs) != 1:
        return None
    label_of = {cell.summary["cell_id"]: cell.label for cell in cells}
    times: dict[str, list[Record]] = defaultdict(list)
    for sample in whole(runs[0].tables["samples"]):
        if sample["status"] == "ok" and finite(sample["ns_per_ray"]) and finite(sample["order_index"]) is not None and sample["cell_id"] in label_of:
            times[str(sample["cell_id"])].append(sample)
    relative = []
    for cell_id, samples in times.items():
        middle = statistics.median(finite(sample["ns_per_ray"]) or 0.0 for sample in samples)
        relative += [(finite(s["order_index"]) or 0.0, (finite(s["ns_per_ray"]) or 0.0) / middle, label_of[cell_id]) for s in samples if len(samples) > 2]
    if not relative:
        return None
    caption = (
        "Every timed sample relative to the median of its cell, in the order of the run. A level band around 1 is what a quiet machine gives; "
        "a slope is drift, a step or a cluster of high marks is another load on the machine. No sample is dropped."
    )
    return Draft("run_order", "Samples in the order of the run", caption, run_order_figure(relative, look_of))
