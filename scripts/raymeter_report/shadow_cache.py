"""What a cache of blockers answers, what it costs and what it saves."""

from collections.abc import Sequence

from .cells import Cell, comparison_key, finite, varying_settings
from .numbers import integer
from .table import Column, Table, fixed_settings, key_columns, key_fields, number_field


def shadow_ns(cell: Cell) -> float | None:
    """Median time of a shadow ray: of the set, or of the phase of an image."""
    summary = cell.phases.get("shadow", {}) if cell.frame else cell.summary
    return finite(summary.get("median_ns_per_ray"))


def ratio(part: float | None, whole: float | None, factor: float = 1.0) -> float | None:
    return None if part is None or not whole else factor * part / whole


def saved_share(cached: Cell, plain: Cell) -> float | None:
    """Primitive tests that the cache spares, its own counted in, per cent of those without it; negative where it costs more than it spares."""
    before, after, own = finite(plain.shadow.get("prim_tests")), finite(cached.shadow.get("prim_tests")), finite(cached.shadow.get("cache_tests"))
    return None if before is None or after is None or own is None else ratio(before - after - own, before, 100.0)


def shadow_cache_table(cells: Sequence[Cell]) -> Table:
    """Hit rates of each scene and variant, beside the cell that is the same but has no cache."""
    plain = {comparison_key(cell): cell for cell in cells if cell.technique[3] == "none"}
    cached = [cell for cell in cells if cell.technique[3].startswith("shadow_cache") and cell.shadow]
    varying = varying_settings(cached)
    columns = [
        *key_columns(varying), Column("shadow rays", hint="ray_count"), Column("blocked", hint="rays_hit"), Column("cache tests", hint="cache_tests"),
        Column("cache hits", hint="cache_hits"), Column("hits of all", "%", hint="cache_hit_rate"), Column("hits of blocked", "%", hint="cache_hit_rate_blocked"),
        Column("tests saved", "%"), Column("shadow ray", "ns"), Column("time without", "×"),
    ]
    rows = []
    for cell in cached:
        key = comparison_key(cell)
        other = plain.get(tuple("none" if value == cell.technique[3] else value for value in key))
        rows.append([
            *key_fields(cell, varying), *(number_field(cell.shadow.get(name), integer) for name in ("ray_count", "rays_hit", "cache_tests", "cache_hits")),
            *(number_field(cell.shadow.get(name), factor=100.0) for name in ("cache_hit_rate", "cache_hit_rate_blocked")),
            number_field(saved_share(cell, other) if other else None), number_field(shadow_ns(cell)),
            number_field(ratio(shadow_ns(cell), shadow_ns(other)) if other else None),
        ])
    caption = (
        "Shadow rays whose cached blocker was tested, and those that it blocks: as a share of all, and of those that anything blocks. Tests saved: primitive "
        "tests that the cache spares less its own, of those without it. Time is against the same technique without it; above 1 the cache costs more than it "
        "spares." + fixed_settings(cached)
    )
    return Table("shadow-cache", caption if rows else "", columns, rows, 2).without_empty()
