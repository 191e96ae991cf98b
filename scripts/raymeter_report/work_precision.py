"""Speed against error of settings that may give wrong answers, and what the robust tests cost beside the weak ones."""

import math
from collections import Counter, defaultdict
from collections.abc import Container, Sequence
from dataclasses import dataclass, replace

from .cells import Cell, at_setting, finite, main_setting, parse_params, slots_of
from .peer import Ratio, ratio_of
from .records import Value
from .table import SETTING_TITLES, Column, Field, Table, number_field, setting_field

ROBUST = {"box_test": "padded", "box_bounds": "padded", "reciprocal": "divide", "triangle_test": "woop_kahan", "sphere_test": "robust"}
OF_WEAK_TESTS = ("box_padding", "precision", "triangle_epsilon")  # parameters that mean something beside a weak test alone
PACKETS = "packet"  # the traversal that weak tests have
DEFAULT = "usual setting"

Setting = dict[tuple[str, str], str]  # (what stands in a slot, its parameter) -> value


@dataclass(frozen=True)
class Point:
    """A cell by its error and speed; `knob` is what was turned, `label` to which value."""

    cell: Cell
    knob: str
    label: str
    step: str  # the number that the knob's line goes along, where there is one
    error: float  # wrong answers a ray
    speed: float  # Mrays/s
    slow: float | None
    fast: float | None


def error_rate(cell: Cell) -> float | None:
    """Misses, false hits and wrong primitives, per ray that was checked; None where nothing was checked."""
    checked = finite(cell.accuracy.get("rays_checked"))
    wrong = [finite(cell.accuracy.get(name)) for name in ("false_miss", "false_hit", "wrong_prim")]
    return sum(value or 0.0 for value in wrong) / checked if checked else None


def is_weak(cell: Cell) -> bool:
    """Whether one of its tests of boxes or primitives promises nothing."""
    params = parse_params(cell.technique[1])
    return any(params.get(key, robust) != robust for key, robust in ROBUST.items())


def setting_of(cell: Cell) -> Setting:
    return {(name, key): value for name, params in slots_of(cell) for key, value in parse_params(params).items()}


def usual(cells: Sequence[Cell]) -> Setting:
    """The value that most cells have of each parameter that most cells have, of tests the robust one where some cell has only those; of what stands before a
    structure, that all have: without it is usual, too."""
    structures = {cell.technique[0] for cell in cells}
    values: dict[tuple[str, str], Counter[str]] = defaultdict(Counter)
    for cell in cells:
        for key, value in setting_of(cell).items():
            values[key][value] += 1
    least = {key: len(cells) // 2 + 1 if key[0] in structures else len(cells) for key in values}
    found = {key: count.most_common(1)[0][0] for key, count in values.items() if count.total() >= least[key]}
    robust = {key for cell in cells if not is_weak(cell) for key in setting_of(cell)}
    return {key: ROBUST.get(key[1], value) if robust else value for key, value in found.items() if not robust or key in robust}


def is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def turned(setting: Setting, base: Setting, varying: Container[tuple[str, str]]) -> tuple[str, str, str]:
    """The knob that tells a setting from the usual one, and its value; all of them where several do, but for what has no other value anywhere. Of several the one
    number, as it is told, is the step along the line that the others are."""
    changed = [(key, value) for key, value in setting.items() if base.get(key) != value]
    if not changed:
        return "", DEFAULT, ""
    changed = [(key, value) for key, value in changed if key in varying] or changed
    numbers = [pair for pair in changed if is_number(pair[1])]
    if len(changed) > 1 and len(numbers) == 1:
        line = ", ".join(f"{key[1]}={value}" for key, value in changed if not is_number(value))
        (_, key), value = numbers[0]
        return line, f"{line}, {key}={value}", f"{key}={value}"
    slot, key = changed[0][0]
    knob = key if (slot, key) in base else slot
    return knob, ", ".join(f"{key[1]}={value}" for key, value in changed), ""


def work_precision(cells: Sequence[Cell]) -> dict[tuple[str, str], list[Point]]:
    """By scene and ray kind, at the main setting; scenes in which nothing errs are left out where others do, and nothing is left where none does."""
    timed = [cell for cell in cells if not cell.frame and ":offset=" not in cell.rays and not cell.is_peer and cell.number("mrays_per_s") is not None]
    timed = [cell for cell in at_setting(timed, main_setting(timed)) if error_rate(cell) is not None]
    if not any(error_rate(cell) for cell in timed):
        return {}
    base = usual(timed)
    values: dict[tuple[str, str], set[str]] = defaultdict(set)
    for cell in timed:
        for key, value in setting_of(cell).items():
            values[key].add(value)
    varying = {key for key, of_key in values.items() if len(of_key) > 1}
    panels: dict[tuple[str, str], list[Point]] = defaultdict(list)
    for cell in timed:
        knob, label, step = turned(setting_of(cell), base, varying)
        ends = [1e3 / time if time else None for time in (cell.number("ci_hi"), cell.number("ci_lo"))]
        panels[cell.scene, cell.rays].append(Point(cell, knob, label, step, error_rate(cell) or 0.0, cell.number("mrays_per_s") or 0.0, *ends))
    return lines_told_apart(panels)


def stepped(panels: dict[tuple[str, str], list[Point]]) -> list[Setting]:
    return [setting_of(point.cell) for of_panel in panels.values() for point in of_panel if point.step]


def lines_told_apart(panels: dict[tuple[str, str], list[Point]]) -> dict[tuple[str, str], list[Point]]:
    """The same points; lines along numbers are named by what tells them from each other alone."""
    settings = stepped(panels)
    values: dict[tuple[str, str], set[str | None]] = {key: {setting.get(key) for setting in settings} for setting in settings for key in setting}
    differing = {key for key, of_key in values.items() if len(of_key) > 1}

    def named(point: Point) -> Point:
        line = ", ".join(f"{key[1]}={value}" for key, value in setting_of(point.cell).items() if key in differing and f"{key[1]}={value}" != point.step)
        return replace(point, knob=line, label=f"{line}, {point.step}") if point.step and line else point

    return {key: [named(point) for point in of_panel] for key, of_panel in panels.items()}


def shared_by_lines(panels: dict[tuple[str, str], list[Point]]) -> str:
    """What all settings along lines have that is not robust; empty without such lines."""
    settings = stepped(panels)
    shared = set.intersection(*(set(setting.items()) for setting in settings)) if settings else set()
    return ", ".join(f"{key}={value}" for (_, key), value in sorted(shared) if ROBUST.get(key, value) != value)


def front(points: Sequence[Point]) -> list[Point]:
    """Those that no other point beats in error and speed, by rising error."""
    best: list[Point] = []
    for point in sorted(points, key=lambda p: (p.error, -p.speed)):
        if not best or point.speed > best[-1].speed:
            best.append(point)
    return best


@dataclass(frozen=True)
class Price:
    """The robust tests, by whatever traversal, beside the fastest weak ones on the same rays."""

    robust: Cell
    weak: Cell
    ratio: Ratio  # time of the robust ones by that of the weak ones, over rounds


    @property
    def traversal(self) -> str:
        return parse_params(self.robust.technique[1]).get("traversal", PACKETS)


def same_but_for_tests(robust: Cell, weak: Cell) -> bool:
    """Whether all other parameters that mean something to both, but the traversal, are the same."""
    theirs = setting_of(weak)
    return all(theirs.get(key, value) == value for key, value in setting_of(robust).items() if key[1] not in (*ROBUST, *OF_WEAK_TESTS, "traversal"))


def prices(cells: Sequence[Cell]) -> list[Price]:
    groups: dict[tuple[Value, ...], list[Cell]] = defaultdict(list)
    for cell in cells:
        if cell.state == "ok" and not cell.frame and not cell.is_peer and cell.number("median_ns_per_ray"):
            groups[(cell.run, cell.scene, cell.rays, cell.technique[0], *cell.setting)].append(cell)
    found = []
    for group in groups.values():
        for robust in (cell for cell in group if not is_weak(cell)):
            weak = [cell for cell in group if is_weak(cell) and same_but_for_tests(robust, cell)]
            fastest = min(weak, key=lambda cell: cell.number("median_ns_per_ray") or 0.0, default=None)
            ratio = ratio_of(fastest, robust) if fastest else None
            if fastest and ratio:
                found.append(Price(robust, fastest, ratio))
    return found


def tests_of(cell: Cell) -> str:
    params = parse_params(cell.technique[1])
    return ", ".join(f"{key}={params[key]}" for key in (*ROBUST, *OF_WEAK_TESTS) if params.get(key, ROBUST.get(key)) != ROBUST.get(key))


def price_table(cells: Sequence[Cell]) -> Table:
    """A row for each scene, ray kind and setting."""
    found = prices(cells)
    columns = [
        Column("scene", number=False), Column("rays", number=False), Column("ISA", number=False), Column(SETTING_TITLES["packet"]),
        Column("robust traversal", number=False), Column("fastest weak tests", number=False), Column("robust", "ns"), Column("weak", "ns"), Column("price", "%"), Column("from", "%"), Column("to", "%"),
        Column("wrong answers, weak", "per million"), Column("wrong answers, robust", "per million"),
    ]
    rows = []
    for price in found:
        robust, weak = price.robust, price.weak
        percent = [None if value is None else 100.0 * (value - 1.0) for value in (price.ratio.value, price.ratio.low, price.ratio.high)]
        rows.append([
            Field(robust.scene), Field(robust.rays), setting_field(robust.summary["isa"]), setting_field(robust.summary["packet"]),
            Field(price.traversal), Field(tests_of(weak)),
            number_field(robust.number("median_ns_per_ray")), number_field(weak.number("median_ns_per_ray")), *map(number_field, percent),
            number_field(error_rate(weak), factor=1e6), number_field(error_rate(robust), factor=1e6),
        ])
    caption = (
        "What right answers cost: time of the robust tests, by packets or the traversal named, over that of the fastest weak ones, which go in packets, the median over rounds of one run with its 95 % interval, and how "
        "many answers of each were wrong. A negative price: the robust tests were faster than all weak ones."
    )
    return Table("price", caption if rows else "", columns, rows, 2).without_empty()
