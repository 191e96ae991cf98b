"""What each ingredient brings: pairs of settings that a config names, one with it, one without."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from .cells import Cell, parse_params, rays_of, scenes_of
from .numbers import geometric_mean, with_interval
from .peer import Ratio, ratio_of
from .records import Run
from .table import Column, Field, Table

Pattern = Mapping[str, object]  # fields of a cell and the value, or list of values, that they have


@dataclass(frozen=True)
class Price:
    """An ingredient on one scene and ray kind: how many times as fast rays are with it."""

    scene: str
    rays: str
    ingredient: str
    without: str
    having: str
    ratio: Ratio


def ingredients_of(runs: Iterable[Run]) -> list[tuple[str, Pattern, Pattern]]:
    """Name, what cells with it are like, and what those without it are."""
    reports = [(run.manifest.get("config_text") or {}).get("report", {}) for run in runs]
    return [(one["name"], one["with"], one["without"]) for report in reports for one in report.get("ingredients", [])]


def field_of(cell: Cell, key: str) -> object:
    """A field by the name that a config's patterns have for it."""
    slot, _, name = key.partition(".")
    if not name:
        return cell.summary.get(key)
    structure, params = cell.technique[:2]
    return structure if name == "name" else parse_params(params).get(name) if slot == "structure" else None


def matches(cell: Cell, pattern: Pattern) -> bool:
    def is_value(found: object, wanted: object) -> bool:
        if isinstance(wanted, bool):
            return str(found).lower() == str(wanted).lower()
        if isinstance(wanted, (int, float)):
            try:
                return float(str(found)) == float(wanted)
            except ValueError:
                return False
        return found == wanted

    return all(any(is_value(field_of(cell, key), one) for one in (value if isinstance(value, list) else [value])) for key, value in pattern.items())


def price_list(runs: Sequence[Run], cells: Sequence[Cell]) -> list[Price]:
    """In the order of the config. Of several cells that a pattern fits the fastest counts; what a scene lacks is passed over."""
    timed = [cell for cell in cells if cell.state == "ok" and cell.number("median_ns_per_ray")]
    found = []
    for name, having, without in ingredients_of(runs):
        for scene in scenes_of(timed):
            for rays in rays_of(timed):
                here = [cell for cell in timed if (cell.scene, cell.rays) == (scene, rays)]
                pair = [fastest(cell for cell in here if matches(cell, pattern)) for pattern in (having, without)]
                ratio = ratio_of(pair[0], pair[1]) if pair[0] and pair[1] else None
                if ratio and pair[0] and pair[1]:
                    found.append(Price(scene, rays, name, setting_of(pair[1]), setting_of(pair[0]), ratio))
    return found


def fastest(cells: Iterable[Cell]) -> Cell | None:
    return min(cells, key=lambda cell: cell.number("median_ns_per_ray") or 0.0, default=None)


def setting_of(cell: Cell) -> str:
    return f"{cell.label} {cell.summary['isa']} packet {cell.number('packet') or 0:g}"


def names_in_order(all_of: Sequence[Price]) -> list[str]:
    return list(dict.fromkeys(one.ingredient for one in all_of))


def mean_of(all_of: Sequence[Price], rays: str, ingredient: str) -> Ratio | None:
    """Geometric mean over scenes, with the range of the single scenes."""
    values = [one.ratio.value for one in all_of if (one.rays, one.ingredient) == (rays, ingredient)]
    return Ratio(geometric_mean(values), min(values), max(values)) if values else None


def price_list_table(runs: Sequence[Run], cells: Sequence[Cell]) -> Table:
    """Each ingredient on each scene."""
    rows = []
    for one in price_list(runs, cells):
        ratio, interval = with_interval(one.ratio.value, one.ratio.low, one.ratio.high)
        rows.append([Field(one.ingredient), Field(one.scene), Field(one.rays), Field(ratio, one.ratio.value), Field(interval), Field(one.having), Field(one.without)])
    columns = [
        Column("ingredient", number=False), Column("scene", number=False), Column("rays", number=False), Column("times as fast", "×"),
        Column("95 % interval", "×"), Column("with", number=False), Column("without", number=False),
    ]
    return Table("price-list", "What each ingredient brings: how many times as fast rays are with it as without, medians over the rounds of the run.", columns, rows, 3)
