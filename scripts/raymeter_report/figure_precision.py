"""Speed against error of tests and settings that may be wrong: a panel for each scene and ray kind."""

import math
from collections import defaultdict
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from .cells import rays_of, scenes_of
from .figure_dots import Dot, Panel, add_legend, dot_figure
from .numbers import axis_number, shortened
from .style import INK, MARKERS, NEUTRAL_INK, PAGE_WIDTH, STRUCTURE_COLOURS, Look, new_figure, shade
from .work_precision import DEFAULT, PACKETS, Point, Price, front

WIDE = 3  # so many panels a row leave room for one line of title and three decades
KNOB_COLOURS = [colour for name, colour in STRUCTURE_COLOURS.items() if name != "list"]


def looks_of(points: Sequence[Point]) -> dict[str, Look]:
    """A colour for each knob, a mark for each of its values; the usual setting is black. Where knobs go along numbers, these have a mark each."""
    steps = list(dict.fromkeys(point.step for point in sorted(points, key=lambda point: step_number(point.step)) if point.step))
    step_of = {point.label: point.step for point in points}
    values: dict[str, list[str]] = defaultdict(list)
    for point in points:
        if point.knob and point.label not in values[point.knob]:
            values[point.knob].append(point.label)
    looks = {DEFAULT: Look(INK, "*")}
    for place, (_, labels) in enumerate(values.items()):
        colour = KNOB_COLOURS[place % len(KNOB_COLOURS)]
        for i, label in enumerate(labels):
            if step_of[label]:
                looks[label] = Look(colour, MARKERS[steps.index(step_of[label]) % len(MARKERS)])
            else:
                looks[label] = Look(shade(colour, 0.45 * i / max(1, len(labels) - 1)), MARKERS[(place + i) % len(MARKERS)])
    return looks


def step_number(step: str) -> float:
    return float(step.rpartition("=")[2]) if step else 0.0


def legend_of(points: Sequence[Point], looks: dict[str, Look]) -> dict[str, Look]:
    """Of settings along lines, the lines by their colour and the steps by their marks."""
    legend = {label: look for label, look in looks.items() if label == DEFAULT}
    for point in sorted(points, key=lambda point: step_number(point.step)):
        look = looks[point.label]
        legend |= {f"{point.knob}:": Look(look.colour, "s"), point.step: Look(NEUTRAL_INK, look.marker, filled=False)} if point.step else {point.label: look}
    return {label: look for wanted in (True, False) for label, look in legend.items() if (label.endswith(":") or label == DEFAULT) == wanted}


def precision_figure(panels: dict[tuple[str, str], list[Point]]) -> Figure:
    """Wrong answers a ray on a logarithmic axis with a place of its own for none; Mrays/s with 95 % intervals. A line for each knob, through the usual setting or along its numbers;
    the step line is the front: right of it or below, another setting is faster and errs less."""
    everything = [point for points in panels.values() for point in points]
    cells = [point.cell for point in everything]
    scenes, kinds = scenes_of(cells), rays_of(cells)
    looks = looks_of(everything)
    figure = new_figure(PAGE_WIDTH if len(kinds) > 1 else PAGE_WIDTH * 0.62, 1.75 * len(scenes) + 0.5)
    grid = figure.subplots(len(scenes), len(kinds), sharex=True, squeeze=False)
    errors = [math.log10(point.error) for point in everything if point.error]
    low, high = math.floor(min(errors)), max(math.ceil(max(errors)), math.floor(min(errors)) + 1)
    zero = low - 1.0
    # The robust answers, which all others are held against, are checked by sample: the number is that of the others.
    rays = max(float(point.cell.accuracy["rays_checked"]) for point in everything)  # type: ignore[arg-type]
    for row, scene in enumerate(scenes):
        for column, kind in enumerate(kinds):
            draw_panel(grid[row, column], panels.get((scene, kind), []), looks, zero)
            where, rays_there = shortened(scene.removeprefix("hard:")), "its own rays" if kind == "case" else kind
            grid[row, column].set_title(f"{where}\n{rays_there}" if len(kinds) > WIDE else f"{where}, {rays_there}", loc="left")
    for axes in grid.flat:
        axes.set_xlim(zero - 0.4, high + 0.2)
        decades = list(range(high, low - 1, -max(1, math.ceil((high - low) / 3))))[::-1]
        if len(kinds) > WIDE:
            decades = [decade for decade in decades if decade > low]  # whose label would meet that of zero
        axes.xaxis.set_major_locator(FixedLocator([zero, *decades]))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.set_xticklabels([f"0\n(< {float(f'{3 / rays:.0e}'):g})", *(axis_number(10.0**decade) for decade in decades)])
    for axes in grid[-1, :]:
        axes.set_xlabel("wrong answers per ray")
    for axes in grid[:, 0]:
        axes.set_ylabel("million rays per second")
    legend = legend_of(everything, looks)
    add_legend(figure, list(legend), legend)
    return figure


def draw_panel(axes: Axes, points: Sequence[Point], looks: dict[str, Look], zero: float) -> None:
    axes.grid(True)
    axes.set_axisbelow(True)
    if not points:
        return axes.set_visible(False)

    def place(point: Point) -> float:
        return math.log10(point.error) if point.error else zero

    best = front(points)
    ends = [(place(point), point.speed) for point in best]
    ends = [(ends[0][0], min(point.slow or point.speed for point in points) * 0.9), *ends, (axes.get_xlim()[1] + 10, ends[-1][1])]
    axes.plot(*zip(*ends), color=INK, alpha=0.35, linewidth=3, drawstyle="steps-post", solid_joinstyle="miter", zorder=1)
    usual = [point for point in points if not point.knob]
    for knob in dict.fromkeys(point.knob for point in points if point.knob):
        line = line_of([point for point in points if point.knob == knob], usual)
        colour = next(looks[point.label].colour for point in points if point.knob == knob)
        axes.plot([place(point) for point in line], [point.speed for point in line], color=colour, linewidth=0.9, alpha=0.7, zorder=2)
    for point in points:
        look = looks[point.label]
        bar = [[max(0.0, point.speed - (point.slow or point.speed))], [max(0.0, (point.fast or point.speed) - point.speed)]]
        axes.errorbar(place(point), point.speed, yerr=bar, color=look.colour, marker=look.marker, markersize=7 if not point.knob else 4.5, linewidth=0.8, zorder=3)
    speeds = [speed for point in points for speed in (point.slow, point.speed, point.fast) if speed]
    axes.set_yscale("log")
    axes.set_ylim(min(speeds) * 0.95, max(speeds) * 1.05)
    axes.yaxis.set_major_locator(MaxNLocator(nbins=4, steps=[1, 2, 2.5, 5, 10]))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: axis_number(value)))


def line_of(turned: Sequence[Point], usual: Sequence[Point]) -> list[Point]:
    """A knob's points in the order of its values where these are numbers, else, with the usual setting, by rising error."""
    texts = [point.label.rpartition("=")[2] for point in turned]
    try:
        values = [float(text) for text in texts]
    except ValueError:
        return sorted([*usual, *turned], key=lambda point: (point.error, point.speed))
    return [point for _, point in sorted(zip(values, turned), key=lambda pair: pair[0])]


def price_figure(found: Sequence[Price], sizes: dict[str, float | None]) -> Figure:
    """A panel for each ray kind and instruction set, a row for each scene."""
    panels = []
    packets = sorted({float(price.robust.summary["packet"]) for price in found})  # type: ignore[arg-type]
    names = {packet: f"packets of {packet:g}" if packet > 1 else "rays one by one" for packet in packets}
    traversals = sorted({price.traversal for price in found}, key=lambda traversal: (traversal != PACKETS, traversal))

    def name(packet: float, traversal: str) -> str:
        return names[packet] if traversal == PACKETS else f"traversal={traversal}, {names[packet]}"

    kinds = rays_of([price.robust for price in found])
    isas = list(dict.fromkeys(price.robust.summary["isa"] for price in found))
    for isa in isas:
        for kind in kinds:
            dots = [
                Dot(price.robust.scene, name(float(price.robust.summary["packet"]), price.traversal), price.ratio.value, price.ratio.low, price.ratio.high)  # type: ignore[arg-type]
                for price in found
                if (price.robust.rays, price.robust.summary["isa"]) == (kind, isa)
            ]
            panels.append(Panel(f"{kind}, {isa}", "robust / fastest weak time", dots, line=1.0))
    rows = [name(packet, traversal) for traversal in traversals for packet in packets]
    looks = {label: Look(KNOB_COLOURS[i], MARKERS[i]) for i, label in enumerate(rows)}
    return dot_figure(panels, sizes, looks, columns=len(kinds))
