"""Tests per ray against memory: what cells that are made on demand, under a budget, save."""

import math
from collections import defaultdict
from collections.abc import Sequence

from matplotlib.figure import Figure

from .cells import Cell, finite, parse_params, scenes_of
from .figure_dots import COLUMNS
from .numbers import shortened
from .style import PAGE_WIDTH, Look, new_figure, scale_axis

DASHES = ("-", (0, (4, 2)), (0, (1, 1.5)))  # the ray kinds in their order
BUDGET = "memory_mb"


def budget_lines(cells: Sequence[Cell]) -> list[list[Cell]]:
    """Cells that differ in their budget alone, three or more of them, the least first."""
    groups: dict[tuple[object, ...], list[Cell]] = defaultdict(list)
    for cell in cells:
        params = parse_params(str(cell.summary["params"]))
        if cell.state == "ok" and BUDGET in params and finite(cell.counters.get("cell_bytes")):
            rest = tuple(item for item in params.items() if item[0] != BUDGET)
            groups[(cell.run, cell.scene, cell.rays, str(cell.summary["structure"]), rest, *cell.setting)].append(cell)
    lines = [sorted(group, key=lambda cell: float(parse_params(str(cell.summary["params"]))[BUDGET])) for group in groups.values() if len(group) > 2]
    # With packets of one, where there are some: the counts of the literature.
    least = min((line[0].number("packet") or 0.0 for line in lines), default=0.0)
    return [line for line in lines if line[0].number("packet") == least]


def memory_figure(lines: Sequence[Sequence[Cell]], looks: dict[str, Look]) -> Figure:
    """One panel a scene, a line for each ray kind."""
    scenes = scenes_of([line[0] for line in lines])
    kinds = list(dict.fromkeys(line[0].rays for line in lines))
    columns = min(COLUMNS, len(scenes))
    rows = math.ceil(len(scenes) / columns)
    figure = new_figure(PAGE_WIDTH if columns > 1 else PAGE_WIDTH * 0.62, 2.3 * rows + 0.35)
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes, scene in zip(grid.flat, scenes):
        axes.set_title(shortened(scene), loc="left")
        axes.grid(True)
        axes.set_axisbelow(True)
        memory, tests = [], []
        for line in lines:
            if line[0].scene != scene:
                continue
            points = [((finite(cell.counters["cell_bytes"]) or 0.0) / 2**20, cell.number("prim_tests_per_ray") or 0.0) for cell in line]
            look = looks[line[0].label]
            dash = DASHES[min(kinds.index(line[0].rays), len(DASHES) - 1)]
            axes.plot(*zip(*points), color=look.colour, marker=look.marker, markersize=4, linewidth=1.2, linestyle=dash, label=line[0].rays)
            memory += [x for x, _ in points]
            tests += [y for _, y in points]
        scale_axis(axes, "x", memory)
        scale_axis(axes, "y", tests)
        axes.legend(frameon=False, fontsize="small")
    for axes in list(grid.flat)[len(scenes) :]:
        axes.set_visible(False)
    for axes in grid[-1, :]:
        axes.set_xlabel("memory of cells (MiB)")
    for axes in grid[:, 0]:
        axes.set_ylabel("tests per ray")
    return figure
