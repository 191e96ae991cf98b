"""Speed against error: what an image gains by being wrong."""

import math
from collections.abc import Sequence

from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from .figure_dots import COLUMNS, add_legend
from .frames import Cut
from .numbers import axis_number, shortened
from .style import INK, PAGE_WIDTH, Look, new_figure, scale_axis

DASHES = ("-", (0, (4, 2)), (0, (1, 1.5)))  # the deepest images first


def error_figure(cuts: Sequence[Cut], looks: dict[str, Look]) -> Figure:
    """One panel a scene: RMSE on a logarithmic axis with a place of its own for 0, speed-up over the image that is cut nowhere. A line for each technique and
    depth, from the least weight to the largest."""
    scenes = list(dict.fromkeys(cut.cell.scene for cut in cuts))
    columns = min(COLUMNS, len(scenes))
    rows = math.ceil(len(scenes) / columns)
    figure = new_figure(PAGE_WIDTH if columns > 1 else PAGE_WIDTH * 0.62, 2.3 * rows + 0.35)
    grid = figure.subplots(rows, columns, sharex=True, squeeze=False)
    labels = [label for label in looks if any(cut.cell.label == label for cut in cuts)]
    depths = sorted({cut.cell.summary["max_depth"] for cut in cuts}, reverse=True)
    errors = [math.log10(cut.error) for cut in cuts if cut.error]
    low, high = (math.floor(min(errors)), math.ceil(max(errors))) if errors else (-1, 0)
    zero = low - 1.0
    for axes, scene in zip(grid.flat, scenes):
        axes.set_title(shortened(scene), loc="left")
        axes.grid(True)
        axes.set_axisbelow(True)
        axes.axhline(1.0, color=INK, linewidth=0.6, alpha=0.5)
        speeds = [1.0]
        for label in labels:
            for place, depth in enumerate(depths):
                line = sorted((cut for cut in cuts if (cut.cell.scene, cut.cell.label, cut.cell.summary["max_depth"]) == (scene, label, depth)), key=lambda c: c.weight)
                points = [(math.log10(cut.error) if cut.error else zero, cut.speed_up) for cut in line if cut.error is not None and cut.speed_up]
                if points:
                    look = looks[label]
                    axes.plot(*zip(*points), color=look.colour, marker=look.marker, markersize=4, linewidth=1.2, linestyle=DASHES[min(place, len(DASHES) - 1)])
                    speeds += [speed for _, speed in points]
        scale_axis(axes, "y", speeds)
        axes.set_xlim(zero - 0.3, high + 0.3)
        stride = max(1, math.ceil((high - low) / 4))
        decades = list(range(high, low - 1, -stride))[::-1]
        axes.xaxis.set_major_locator(FixedLocator([zero, *decades]))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.set_xticklabels(["0", *(axis_number(10.0**decade) for decade in decades)])
    for axes in list(grid.flat)[len(scenes) :]:
        axes.set_visible(False)
    for axes in grid[-1, :]:
        axes.set_xlabel("error (RMSE)")
    for axes in grid[:, 0]:
        axes.set_ylabel("speed-up")
    add_legend(figure, labels, looks)
    return figure
