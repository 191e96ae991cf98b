"""Techniques beside the peer from outside: how many times as fast as its best mode, and what its conversion of rays costs."""

import statistics
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

from .cells import Cell, finite, parse_params, rays_of, techniques_of, varying_settings
from .numbers import geometric_mean, integer, median_interval, with_interval
from .records import Record, Value
from .table import SETTING_TITLES, Column, Field, Table, number_field, setting_field

MEAN = "geometric mean"  # over the scenes of triangles alone
KINDS = ("fast", "robust")  # the peer without and with its watertight tests


@dataclass(frozen=True)
class Ratio:
    """How many times as fast as a rival: the median over rounds of one run, with its 95 % interval."""

    value: float
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True)
class Duel:
    """A cell beside the fastest setting of the peer on the same rays and instruction set, robust or not."""

    cell: Cell
    rival: Cell
    ratio: Ratio
    unconverted: float | None  # ns a ray of the peer where its conversion of rays is left out


def is_robust(cell: Cell) -> bool:
    return parse_params(cell.technique[1]).get("robust") == "true"


def unconverted_ns(cell: Cell) -> float | None:
    """Time per ray of a peer that brings rays into its layout ahead of tracing, without that; None for others."""
    if parse_params(cell.technique[1]).get("layout") != "ahead":
        return None
    times = [without_prepare(sample) for sample in cell.samples.values()]
    known = [time for time in times if time is not None]
    return statistics.median(known) if known else None


def without_prepare(sample: Record) -> float | None:
    trace, prepare, rays = (finite(sample.get(name)) for name in ("trace_ms", "prepare_ms", "rays_traced"))
    return None if trace is None or prepare is None or not rays else (trace - prepare) * 1e6 / rays


def ratio_of(cell: Cell, rival: Cell) -> Ratio | None:
    """From the samples of the same rounds."""
    pairs = [(finite(sample["ns_per_ray"]), finite(rival.samples[place]["ns_per_ray"])) for place, sample in cell.samples.items() if place in rival.samples]
    ratios = [other / own for own, other in pairs if own and other]
    if not ratios:
        return None
    low, high = median_interval(ratios) or (None, None)
    return Ratio(statistics.median(ratios), low, high)


def duels(cells: Sequence[Cell]) -> dict[str, list[Duel]]:
    """By kind of the peer; both lists are empty where no peer was timed. Packet sizes mean nothing to a peer."""
    rivals: dict[tuple[Value, ...], list[Cell]] = defaultdict(list)
    timed = [cell for cell in cells if cell.state == "ok" and cell.number("median_ns_per_ray")]

    def place(cell: Cell) -> tuple[Value, ...]:
        return cell.run, cell.scene, cell.rays, cell.summary["isa"], cell.summary["threads"]

    for cell in timed:
        if cell.is_peer:
            rivals[(*place(cell), is_robust(cell))].append(cell)
    found: dict[str, list[Duel]] = {kind: [] for kind in KINDS}
    for cell in timed:
        for kind in KINDS if not cell.is_peer else ():
            group = rivals.get((*place(cell), kind == "robust"), [])
            if not group:
                continue
            best = min(group, key=lambda rival: rival.number("median_ns_per_ray") or 0.0)
            ratio = ratio_of(cell, best)
            if ratio:
                times = [time for time in map(unconverted_ns, group) if time is not None]
                found[kind].append(Duel(cell, best, ratio, min(times, default=None)))
    return found


def of_triangles(cell: Cell) -> bool:
    return "triangle" in str(cell.summary["needs"]) and not any(kind in str(cell.summary["needs"]) for kind in ("sphere", "polygon", "cone"))


def means(all_of: Sequence[Duel]) -> dict[tuple[str, Value, str], float]:
    """Geometric means over the scenes of triangles alone, by ray kind, instruction set and technique; only over all of them, and from two on."""
    groups: dict[tuple[str, Value, str], dict[str, float]] = defaultdict(dict)
    for duel in all_of:
        if of_triangles(duel.cell):
            groups[duel.cell.rays, duel.cell.summary["isa"], duel.cell.label][duel.cell.scene] = duel.ratio.value
    scenes = {scene for group in groups.values() for scene in group}
    return {key: geometric_mean(list(group.values())) for key, group in groups.items() if set(group) == scenes and len(scenes) > 1}


def misses(cell: Cell) -> float | None:
    return finite(cell.summary["hit_mismatch"])


def peer_table(cells: Sequence[Cell]) -> Table:
    """Each technique beside the peer's best mode and best robust mode."""
    found = duels(cells)
    robust = {id(duel.cell): duel for duel in found["robust"]}
    varying = varying_settings([duel.cell for duel in found["fast"]])
    keys = [Column("scene", number=False), Column("rays", number=False), Column("technique", number=False)]
    columns = [*keys, *(Column(SETTING_TITLES[name], number=name != "isa") for name in varying), Column("time per ray", "ns")]
    for kind in ("best mode", "best robust mode"):
        columns += [
            Column(f"the peer’s {kind}", number=False), Column("its time", "ns"), Column("without conversion", "ns"), Column("its wrong rays"),
            Column("speed against it", "×"), Column("95 % interval", "×"),
        ]

    def side(duel: Duel | None) -> list[Field]:
        if duel is None:
            return [Field("")] * 6
        ratio, interval = with_interval(duel.ratio.value, duel.ratio.low, duel.ratio.high)
        rival = duel.rival
        mode = rival.choice or parse_params(rival.technique[1]).get("mode", "")
        return [
            Field(f"{rival.label}: {mode}"), number_field(rival.number("median_ns_per_ray")), number_field(duel.unconverted), number_field(misses(rival), integer),
            Field(ratio, duel.ratio.value), Field(interval),
        ]

    rows = [
        [
            Field(duel.cell.scene), Field(duel.cell.rays), Field(duel.cell.label), *(setting_field(duel.cell.summary[name]) for name in varying),
            number_field(duel.cell.number("median_ns_per_ray")), *side(duel), *side(robust.get(id(duel.cell))),
        ]
        for duel in found["fast"]
    ]
    rows += mean_rows(cells, found, varying)
    caption = (
        "Techniques of one run beside the peer in the mode, and with the tree, that is fastest on these rays and this instruction set. Its time holds the conversion of rays to "
        "its layout; “without conversion” is its time where they were converted ahead, less that. Wrong rays are its misses, false hits and other primitives, all rays looked "
        f"at. Ratios are medians over the rounds of the run; “{MEAN}” is over the scenes of triangles alone."
    )
    return Table("peer", caption, columns, rows, 2).without_empty(named=False)


def mean_rows(cells: Sequence[Cell], found: dict[str, list[Duel]], varying: Sequence[str]) -> list[list[Field]]:
    averages = {kind: means(found[kind]) for kind in KINDS}
    rows = []
    for rays in rays_of(cells):
        for label in techniques_of(cells):
            for key in [key for key in averages["fast"] if (key[0], key[2]) == (rays, label)]:
                sides = [[Field("")] * 4 + [number_field(averages[kind].get(key)), Field("")] for kind in KINDS]
                settings = [Field(str(key[1]) if name == "isa" else "") for name in varying]
                rows.append([Field(MEAN), Field(rays), Field(label), *settings, Field(""), *sides[0], *sides[1]])
    return rows
