"""One bar an ingredient: how many times as fast rays are with it as without."""

import math
from collections.abc import Sequence

from matplotlib.figure import Figure

from .cells import RAY_ORDER, STRUCTURE_ORDER, rank
from .figure_dots import COLUMNS, add_legend
from .numbers import shortened
from .price_list import Price, mean_of, names_in_order
from .style import INK, PAGE_WIDTH, STRUCTURE_COLOURS, Look, new_figure, scale_axis

NOTHING = 1.0  # the ratio of an ingredient that brings nothing
MARKERS = "osD^vP*X"  # of scenes


def price_list_figure(all_of: Sequence[Price]) -> Figure:
    """A panel for each ray kind. Bars are geometric means over scenes; each scene has a mark with its interval."""
    names = names_in_order(all_of)
    kinds = sorted({one.rays for one in all_of}, key=lambda rays: rank(RAY_ORDER, rays.split(" ")[0]))
    columns = min(COLUMNS - 1, len(kinds))
    rows = math.ceil(len(kinds) / columns)
    figure = new_figure(PAGE_WIDTH, rows * (0.3 * len(names) + 0.8))
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
    scenes = list(dict.fromkeys(one.scene for one in all_of))
    colour = STRUCTURE_COLOURS[STRUCTURE_ORDER[1]]
    look_of = {scene: Look(colour, MARKERS[i % len(MARKERS)]) for i, scene in enumerate(scenes)}
    every = [one.ratio.value for one in all_of]  # an interval that a busy machine has made wide may end at the panel's
    for axes, rays in zip(grid.flat, kinds):
        axes.set_title(shortened(rays), loc="left")
        axes.set_xlabel("times as fast as without")
        axes.set_ylim(len(names) - 0.5, -0.5)
        axes.grid(axis="x")
        axes.set_axisbelow(True)
        axes.axvline(NOTHING, color=INK, linewidth=0.8)
        for y, name in enumerate(names):
            mean = mean_of(all_of, rays, name)
            if mean is not None:
                axes.barh([y], [mean.value - NOTHING], left=NOTHING, height=0.74, color=colour, alpha=0.55, linewidth=0)
        for one in all_of:
            if one.rays != rays:
                continue
            y = names.index(one.ingredient) + 0.6 * ((scenes.index(one.scene) + 0.5) / len(scenes) - 0.5)
            if one.ratio.low is not None and one.ratio.high is not None:
                axes.plot([one.ratio.low, one.ratio.high], [y, y], color=INK, linewidth=0.8, alpha=0.7, solid_capstyle="butt")
            axes.plot([one.ratio.value], [y], linestyle="none", **look_of[one.scene].mark(3.2))
        scale_axis(axes, "x", every, ratio=3.0)
    for axes in list(grid.flat)[len(kinds) :]:
        axes.set_visible(False)
    for axes in grid[:, 0]:
        axes.set_yticks(range(len(names)), names)
    add_legend(figure, scenes, look_of)
    return figure
