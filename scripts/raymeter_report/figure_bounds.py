"""What boxes in whole steps cost: more visits of nodes, and speed against them, by the bits of a plane."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .cells import Cell, at_setting, finite, main_setting, parse_params, rank, RAY_ORDER
from .figure_dots import add_legend
from .numbers import geometric_mean
from .peer import Ratio, ratio_of
from .style import INK, MARKERS, PAGE_WIDTH, STRUCTURE_COLOURS, Look, new_figure

FLOATS = 32  # bits of a plane that is not quantised
TRAVERSALS = ("stream", "single")
LOOKS = {name: Look(colour, marker) for name, colour, marker in zip(TRAVERSALS, (STRUCTURE_COLOURS["bvh"], STRUCTURE_COLOURS["grid"]), MARKERS)}


@dataclass(frozen=True)
class Quantised:
    """A scene by boxes of `bits`, beside the same boxes in floats; bytes are those of a primitive."""

    cell: Cell
    traversal: str
    bits: int
    visits: float  # of nodes, relative
    speed: Ratio | None
    bytes: float | None


def quantised_boxes(cells: Sequence[Cell]) -> dict[str, list[Quantised]]:
    """By kind of rays, at the main setting. Nothing where only floats were measured."""
    having = [cell for cell in cells if "plane_bits" in parse_params(cell.technique[1]) and cell.state == "ok"]
    groups: dict[tuple[str, str, str], dict[int, Cell]] = defaultdict(dict)
    for cell in at_setting(having, main_setting(having)) if having else []:
        params = parse_params(cell.technique[1])
        groups[cell.rays, params.get("traversal", ""), cell.scene].setdefault(int(params["plane_bits"]), cell)
    panels: dict[str, list[Quantised]] = defaultdict(list)
    for (rays, traversal, _), of_scene in groups.items():
        floats = of_scene.get(FLOATS)
        usual = finite(floats.counters.get("node_visits")) if floats else None
        if floats is None or not usual or traversal not in LOOKS or len(of_scene) < 2:
            continue
        for bits, cell in of_scene.items():
            visits = finite(cell.counters.get("node_visits"))
            if visits is not None:
                panels[rays].append(Quantised(cell, traversal, bits, visits / usual, ratio_of(cell, floats), bytes_of(cell)))
    return dict(sorted(panels.items(), key=lambda item: rank(RAY_ORDER, item[0])))


def bytes_of(cell: Cell) -> float | None:
    """Nodes and leaves, of a primitive."""
    size, prims = finite(cell.build.get("mem_bytes")), finite(cell.build.get("num_prims"))
    return size / prims if size and prims else None


def mean_of(of_panel: Sequence[Quantised], traversal: str, bits: int) -> tuple[float, float | None]:
    """Geometric means over scenes of relative visits and speed."""
    some = [one for one in of_panel if one.traversal == traversal and one.bits == bits]
    speeds = [one.speed.value for one in some if one.speed]
    return geometric_mean([one.visits for one in some]), geometric_mean(speeds) if len(speeds) == len(some) else None


def bounds_figure(panels: dict[str, list[Quantised]]) -> Figure:
    """A column for each kind of rays. Above, visits by bits, with the bytes of a primitive; below, where timed, speed against the boxes that are met in excess."""
    everything = [one for of_panel in panels.values() for one in of_panel]
    timed = any(one.speed for one in everything)
    figure = new_figure(PAGE_WIDTH, 4.8 if timed else 2.8)
    grid = figure.subplots(2 if timed else 1, len(panels), sharey="row", squeeze=False)
    traversals = [name for name in TRAVERSALS if any(one.traversal == name for one in everything)]
    for column, (rays, of_panel) in enumerate(panels.items()):
        draw_visits(grid[0, column], of_panel, traversals)
        grid[0, column].set_title(rays.replace("_", " "), loc="left")
        if timed:
            draw_speeds(grid[1, column], of_panel, traversals)
    grid[0, 0].set_ylabel("visits of nodes, floats = 1")
    if timed:
        grid[1, 0].set_ylabel("speed, floats = 1")
        speeds = [one.speed.value for one in everything if one.speed]  # intervals of noisy runs may reach out of sight
        room = 0.15 * (max(speeds) - min(speeds)) or 0.1
        grid[1, 0].set_ylim(min(speeds) - room, max(speeds) + room)
    add_legend(figure, traversals, LOOKS)
    return figure


def draw_visits(axes: Axes, of_panel: Sequence[Quantised], traversals: Sequence[str]) -> None:
    bits = sorted({one.bits for one in of_panel})
    axes.grid(True)
    axes.set_axisbelow(True)
    for place, traversal in enumerate(traversals):
        look, shift = LOOKS[traversal], 0.16 * (place - 0.5 * (len(traversals) - 1))
        own = [b for b in bits if any(one.traversal == traversal and one.bits == b for one in of_panel)]
        axes.plot([bits.index(b) + shift for b in own], [mean_of(of_panel, traversal, b)[0] for b in own], color=look.colour, linewidth=1.1)
        for one in of_panel:
            if one.traversal == traversal:
                axes.plot([bits.index(one.bits) + shift], [one.visits], linestyle="none", alpha=0.8, **look.mark(4))
    axes.set_yscale("log")
    highest = max(one.visits for one in of_panel)
    steps = [step for step in (1, 1.2, 1.5, 2, 3, 5, 10, 20, 50, 100) if step <= 1.1 * highest]
    axes.set_yticks(steps, [f"{step:g}" for step in steps])
    axes.set_yticks([], minor=True)
    axes.set_xticks(range(len(bits)), [bits_label(of_panel, b) for b in bits])
    axes.set_xlabel("bits of a plane, bytes a primitive")


def bits_label(of_panel: Sequence[Quantised], bits: int) -> str:
    sizes = [one.bytes for one in of_panel if one.bits == bits and one.bytes]
    name = "float" if bits == FLOATS else str(bits)
    return name + (f"\n{geometric_mean(sizes):.0f} B" if sizes else "")


def draw_speeds(axes: Axes, of_panel: Sequence[Quantised], traversals: Sequence[str]) -> None:
    axes.grid(True)
    axes.set_axisbelow(True)
    axes.axhline(1.0, color=INK, linewidth=0.8, alpha=0.5)
    for place, traversal in enumerate(traversals):
        look = LOOKS[traversal]
        bits = sorted({one.bits for one in of_panel if one.traversal == traversal})
        means = [mean_of(of_panel, traversal, b) for b in bits]
        points = [(100 * (visits - 1), speed, b) for (visits, speed), b in zip(means, bits) if speed]
        axes.plot([x for x, _, _ in points], [y for _, y, _ in points], color=look.colour, linewidth=0.9, alpha=0.7)
        for x, y, b in points:
            axes.plot([x], [y], linestyle="none", **look.mark(6))
            if b != FLOATS:
                axes.annotate(str(b), (x, y), textcoords="offset points", xytext=(0, -11 if place else 5), fontsize=7, ha="center")
        for one in of_panel:
            if one.traversal == traversal and one.speed and one.bits != FLOATS:
                middle, low, high = one.speed.value, one.speed.low, one.speed.high
                bar = [[max(0.0, middle - (low or middle))], [max(0.0, (high or middle) - middle)]]
                axes.errorbar(100 * (one.visits - 1), middle, yerr=bar, color=look.colour, marker=look.marker, markersize=2.5, linewidth=0.6, alpha=0.5)
    axes.set_xscale("symlog", linthresh=1)
    most = 100 * (max(one.visits for one in of_panel) - 1)
    steps = [step for step in (0, 1, 10, 100, 1000, 10000) if step <= max(1.0, 2 * most)]
    axes.set_xticks(steps, [f"{step:g} %" for step in steps])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("nodes visited in excess")
