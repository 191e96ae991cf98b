"""How costs grow with the number of primitives: power laws fitted to families of scenes that differ in size alone."""

import math
import re
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field

from .cells import Cell, at_setting, finite, main_setting, rank, rays_of, techniques_of
from .numbers import integer, significant
from .records import Value
from .table import Column, Field, Table, number_field, setting_field

LEAST_SIZES = 3
BUILD, MEMORY = "build time", "memory"
# Student's t for 95 %, by degrees of freedom; beyond them the normal distribution's is close.
STUDENT = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228)
NORMAL = 1.96


@dataclass(frozen=True)
class Growth:
    """A cost of one technique over a family's sizes: what is traced, or build time or memory."""

    family: str
    what: str
    technique: str
    threads: Value
    points: list[tuple[float, float]] = field(default_factory=list)  # primitives, cost


@dataclass(frozen=True)
class Power:
    """cost ~ primitives ^ exponent, by least squares on logarithms."""

    exponent: float
    half_width: float | None  # of the 95 % interval; None where two points leave nothing to judge by


def family_of(scene: str) -> tuple[str, str]:
    """A scene's name without the size at its end, and that size."""
    match = re.fullmatch(r"((?:gen|spd):\w+):(\d+)", scene)
    return (match[1], match[2]) if match else (scene, "")


def growths(cells: Sequence[Cell]) -> list[Growth]:
    """All at the setting at which figures compare, but on every number of threads; families of three sizes and more."""
    values: dict[tuple[str, str, str, Value], dict[float, float]] = defaultdict(dict)
    setting = main_setting(cells)
    for cell in at_setting(cells, setting, free="threads"):
        family, size = family_of(cell.scene)
        prims = cell.number("num_prims")
        if not size or not prims:
            continue
        for what, cost in (
            (cell.rays, cell.number("median_ns_per_ray")), (BUILD, finite(cell.build.get("build_ms"))), (MEMORY, finite(cell.build.get("bytes_per_prim")))
        ):
            if cost and (what != MEMORY or cell.summary["threads"] == setting["threads"]):
                values[family, what, cell.label, cell.summary["threads"]][prims] = cost
    kinds, labels = [*rays_of(cells), BUILD, MEMORY], techniques_of(cells)
    found = [Growth(*key, sorted(points.items())) for key, points in values.items() if len(points) >= LEAST_SIZES]
    return sorted(found, key=lambda one: (one.family, rank(kinds, one.what), labels.index(one.technique), one.threads if isinstance(one.threads, float) else 0.0))


def fitted(points: Sequence[tuple[float, float]]) -> Power:
    """From at least two sizes."""
    xs, ys = [math.log(x) for x, _ in points], [math.log(y) for _, y in points]
    count = len(points)
    x_mean, y_mean = sum(xs) / count, sum(ys) / count
    spread = sum((x - x_mean) ** 2 for x in xs)
    slope = sum((x - x_mean) * (y - y_mean) for x, y in zip(xs, ys)) / spread
    freedom = count - 2
    if freedom < 1:
        return Power(slope, None)
    rest = sum((y - y_mean - slope * (x - x_mean)) ** 2 for x, y in zip(xs, ys))
    student = STUDENT[freedom - 1] if freedom <= len(STUDENT) else NORMAL
    return Power(slope, student * math.sqrt(rest / freedom / spread))


def scaling_table(cells: Sequence[Cell]) -> Table:
    """The exponents."""
    rows = []
    for one in growths(cells):
        power = fitted(one.points)
        low, high = one.points[0], one.points[-1]
        unit = "ms" if one.what == BUILD else "bytes a primitive" if one.what == MEMORY else "ns a ray"
        rows.append([
            Field(one.family), Field(one.what), Field(one.technique), setting_field(one.threads), number_field(float(len(one.points)), integer),
            number_field(low[0]), number_field(high[0]), number_field(low[1]), number_field(high[1]), Field(unit), Field(f"{power.exponent:.3f}", power.exponent),
            Field("" if power.half_width is None else f"±{significant(power.half_width, 2)}", power.half_width),
        ])
    columns = [
        Column("scenes", number=False), Column("cost", number=False), Column("technique", number=False), Column("threads"), Column("sizes"),
        Column("primitives, from"), Column("to"), Column("cost, from"), Column("to"), Column("unit", number=False), Column("exponent"), Column("95 % interval"),
    ]
    caption = (
        "Costs as powers of the number of primitives: exponents fitted by least squares on the logarithms, with their 95 % interval (Student). A hierarchy whose cost "
        "grows with the logarithm has a small exponent that falls with size, a list has 1. Builds in linear time have 1."
    )
    return Table("scaling", caption, columns, rows, 2)
