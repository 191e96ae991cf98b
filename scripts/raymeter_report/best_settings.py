"""Each structure at the setting in which it is fastest, per scene and ray kind, and what it then needs: tests, steps, time, building, memory."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from .cells import STRUCTURE_ORDER, Cell, finite, rank, rays_of, scenes_of, setting_key, varying_settings
from .numbers import axis_number, integer, plain, significant
from .table import SETTING_TITLES, Column, Field, Table, number_field
from .tables import per_ray


@dataclass(frozen=True)
class Measure:
    """One of the quantities that techniques are compared by; `more` where larger values are better."""

    title: str
    unit: str
    value: Callable[[Cell], float | None]
    more: bool = False


def steps_per_ray(cell: Cell) -> float | None:
    """Inner nodes and leaves or cells entered. Grids and octrees count leaf visits among their node visits."""
    nodes, leaves = (per_ray(cell.counters, event) for event in ("node_visits", "leaf_visits"))
    if nodes is None or leaves is None:
        return None
    return nodes if cell.technique[0] in ("grid", "recursive_grid", "octree") else nodes + leaves


def build_time(cell: Cell) -> float | None:
    """Milliseconds before the first ray; with those in which the first pass makes what is made on demand."""
    build = finite(cell.build.get("build_ms"))
    return None if build is None else build + (finite(cell.counters.get("first_prepare_ms")) or 0.0)


def bytes_per_prim(cell: Cell) -> float | None:
    """Of structure, scene and what was made on demand."""
    built, prims = finite(cell.build.get("bytes_per_prim")), cell.number("num_prims")
    return None if built is None or not prims else built + (finite(cell.counters.get("cell_bytes")) or 0.0) / prims


MEASURES = (
    Measure("tests", "per ray", lambda cell: cell.number("prim_tests_per_ray")),
    Measure("steps", "per ray", steps_per_ray),
    Measure("speed", "Mrays/s", lambda cell: cell.number("mrays_per_s"), more=True),
    Measure("build", "ms", build_time),
    Measure("memory", "bytes a primitive", bytes_per_prim),
)


def best_settings(cells: Sequence[Cell]) -> dict[tuple[str, str], list[Cell]]:
    """Per ray kind and scene the cell of least median time of each structure, on the fewest threads that were measured. Empty unless some structure was
    measured with several settings of its own, and stands beside two others."""
    timed = [cell for cell in cells if cell.state == "ok" and cell.number("median_ns_per_ray")]
    structures = sorted({cell.technique[0] for cell in timed}, key=lambda name: rank(STRUCTURE_ORDER, name))
    if len(structures) < 3 or len({cell.label for cell in timed}) == len(structures):
        return {}
    threads = min((cell.summary["threads"] for cell in timed), key=setting_key("threads"))
    result: dict[tuple[str, str], list[Cell]] = {}
    for rays in rays_of(timed):
        for scene in scenes_of(timed):
            here = [cell for cell in timed if (cell.rays, cell.scene, cell.summary["threads"]) == (rays, scene, threads)]
            groups = ([cell for cell in here if cell.technique[0] == name] for name in structures)
            result[rays, scene] = [min(group, key=lambda cell: cell.number("median_ns_per_ray") or 0.0) for group in groups if group]
    return {key: chosen for key, chosen in result.items() if chosen}


def winners(cells: Sequence[Cell], measure: Measure) -> list[Cell]:
    """Those of best value, all that tie."""
    values = [value for cell in cells if (value := measure.value(cell)) is not None]
    best = max(values, default=None) if measure.more else min(values, default=None)
    return [cell for cell in cells if best is not None and measure.value(cell) == best]


def setting_of(cell: Cell, varying: Sequence[str]) -> str:
    """What tells this setting from the others of its structure: `density=4, packet 16`."""
    parts = cell.label.partition(":")[2].split(",") + [f"{SETTING_TITLES[name]} {plain(cell.summary[name])}" for name in varying]
    return ", ".join(part for part in parts if part)


def best_settings_table(cells: Sequence[Cell]) -> Table:
    """The figure's values."""
    best = best_settings(cells)
    varying = varying_settings([cell for cell in cells if cell.state == "ok"])
    columns = [Column(title, number=False) for title in ("rays", "scene", "technique", "setting")] + [Column(one.title, one.unit) for one in MEASURES]
    rows = []
    for (rays, scene), chosen in best.items():
        bold = {id(cell) for cell in winners(chosen, MEASURES[2])}
        for cell in chosen:
            names = [Field(rays), Field(scene), Field(cell.technique[0], tone="best" if id(cell) in bold else ""), Field(setting_of(cell, varying))]
            rows.append(names + [number_field(one.value(cell), significant if one.unit != "bytes a primitive" else integer) for one in MEASURES])
    caption = (
        "Each technique at the setting in which its median time is least; bold: the fastest. Steps are inner nodes opened and leaves or cells entered. Build times and "
        "memory include what is made on demand, memory the scene." if rows else ""
    )
    return Table("at-their-best", caption, columns, rows, 2)


# What stands in one field of a summary: tests, steps and time trace a ray; time and memory build the structure.
Part = tuple[Callable[[Cell], float | None], Callable[[float | None], str]]
SUMMARIES: dict[str, tuple[Part, ...]] = {
    "tracing": ((MEASURES[0].value, significant), (MEASURES[1].value, significant), (lambda cell: cell.number("median_ns_per_ray"), significant)),
    "building": ((MEASURES[3].value, significant), (MEASURES[4].value, integer)),
}


def summary_tables(cells: Sequence[Cell]) -> list[Table]:
    """The figure's values by technique and scene, for each ray kind: `side_by_side_primary_tracing` has tests / steps / nanoseconds a ray,
    `side_by_side_primary_building` milliseconds / bytes a primitive."""
    best = best_settings(cells)
    result = []
    for rays in dict.fromkeys(kind for kind, _ in best):
        scenes = {scene: chosen for (kind, scene), chosen in best.items() if kind == rays}
        for name, parts in SUMMARIES.items():
            result.append(summary_table(f"side_by_side_{rays.split(' ')[0]}_{name}", scenes, parts))
    return result


def summary_table(name: str, best: dict[str, list[Cell]], parts: Sequence[Part]) -> Table:
    """A row for each technique and a column for each scene; set off: the fastest."""
    columns = [Column("technique", number=False)] + [scene_column(scene, chosen[0]) for scene, chosen in best.items()]
    bold = {id(cell) for chosen in best.values() for cell in winners(chosen, MEASURES[2])}
    rows = []
    for technique in sorted({cell.technique[0] for chosen in best.values() for cell in chosen}, key=lambda one: rank(STRUCTURE_ORDER, one)):
        row = [Field(technique)]
        for chosen in best.values():
            cell = next((one for one in chosen if one.technique[0] == technique), None)
            text = " / ".join(form(value(cell)) or "–" for value, form in parts) if cell else "–"
            row.append(Field(text, tone="best" if id(cell) in bold else ""))
        rows.append(row)
    return Table(name, "", columns, rows)


def scene_column(scene: str, cell: Cell) -> Column:
    """Headed by the scene without its family, and the number of its primitives."""
    count = cell.number("num_prims")
    return Column(scene.removeprefix("spd:").removeprefix("gen:"), f"{axis_number(float(f'{count:.3g}'))} primitives" if count else "")
