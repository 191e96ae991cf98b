"""After how many rays one technique has made good what it costs more to build than another."""

from collections import defaultdict
from collections.abc import Sequence

from .cells import Cell, at_setting, describe_setting, main_setting, rays_of, scenes_of, techniques_of
from .numbers import significant
from .table import Column, Field, Table, number_field


def break_even(cell: Cell, other: Cell) -> Field:
    """As the run's break_even.csv has it."""
    text = cell.break_even.get(str(other.summary["cell_id"]), "")
    if text in ("", "always", "never"):
        return Field(text)
    return Field(significant(float(text)), float(text))


def break_even_table(cells: Sequence[Cell]) -> Table:
    """Each technique against each other one of its scene and ray kind, at the setting at which figures compare them."""
    setting = main_setting(cells)
    groups: dict[tuple[str, str], list[Cell]] = defaultdict(list)
    for cell in at_setting(cells, setting):
        if cell.number("median_ns_per_ray") is not None and cell.build:
            groups[cell.scene, cell.rays].append(cell)
    compared = [cell for group in groups.values() if len(group) > 1 for cell in group]
    names = techniques_of(compared)
    columns = [
        Column("scene", number=False), Column("rays", number=False), Column("technique", number=False),
        Column("build time", "ms", hint="build_ms"), Column("time per ray", "ns", hint="median_ns_per_ray"),
        *(Column(f"against {name}", "rays", hint=name) for name in names),
    ]
    rows = []
    for scene in scenes_of(compared):
        for rays in rays_of(compared):
            group = {cell.label: cell for cell in groups.get((scene, rays), [])}
            for name in (name for name in names if name in group):
                cell = group[name]
                fields = [break_even(cell, group[other]) if other in group else Field("") for other in names]
                rows.append([
                    Field(scene), Field(rays), Field(name), number_field(cell.build.get("build_ms")), number_field(cell.summary["median_ns_per_ray"]), *fields
                ])
    caption = (
        "The number of rays from which on a technique costs less than another, build and rays together: n = (B1 − B2) / (c2 − c1) with build times B and times "
        "per ray c. “always”: its build takes no longer and it traces no slower; “never”: what its build takes longer is not made good. "
        f"At {describe_setting(setting)}." if rows else ""
    )
    return Table("break-even", caption, columns, rows, 2)
