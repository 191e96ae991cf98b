"""What bounding volumes before the objects of a list cost, and what they spare."""

from collections.abc import Sequence

from .cells import Cell, at_setting, describe_setting, finite, main_setting, parse_params
from .numbers import significant
from .table import Column, Field, Table, number_field
from .tables import per_ray


def volumes_table(cells: Sequence[Cell]) -> Table:
    """Each kind of volume of `list`, per scene and ray kind, at the setting at which figures compare techniques."""
    setting = main_setting(cells)
    rows = []
    for cell in at_setting(cells, setting):
        structure, params = cell.technique[0], parse_params(cell.technique[1])
        if structure != "list" or params.get("volume", "none") == "none" or not cell.counters:
            continue
        tests, met, prim_hits = (per_ray(cell.counters, event) for event in ("volume_tests", "leaf_visits", "prim_hits"))
        time = cell.number("median_ns_per_ray")
        single = params.get("around") == "primitive" and met is not None and prim_hits is not None
        values = (
            finite(cell.build.get("volume_area")), finite(cell.build.get("void_area")), tests, met, met - prim_hits if single else None,
            time, time / tests if time is not None and tests else None,
        )
        rows.append([Field(cell.scene), Field(cell.rays), Field(cell.label), *(number_field(value, significant) for value in values)])
    columns = [
        Column("scene", number=False), Column("rays", number=False), Column("technique", number=False), Column("surface area", hint="volume_area"),
        Column("void area", hint="void_area"), Column("volume tests per ray", hint="volume_tests"), Column("volumes met per ray", hint="leaf_visits"),
        Column("of these, object missed"), Column("time per ray", "ns", hint="median_ns_per_ray"), Column("time per volume test", "ns"),
    ]
    caption = (
        "Bounding volumes before the objects of a list. Void area: mean projected area of the volumes less that of the objects. A volume that is met before the "
        "ray's nearest hit so far leads to its object's tests; where it holds one primitive, those that find nothing are counted. The time per volume test holds "
        f"the primitives' tests that follow from it. At {describe_setting(setting)}." if rows else ""
    )
    return Table("volumes", caption, columns, rows, 3).without_empty()
