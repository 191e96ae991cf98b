"""One bar a step: how many times as fast as the step before it."""

import math
from collections.abc import Sequence

from matplotlib.figure import Figure

from .cells import RAY_ORDER, rank
from .figure_dots import COLUMNS
from .numbers import shortened
from .steps import FIRST, Step, mean_of, techniques_in_order
from .style import INK, PAGE_WIDTH, Look, new_figure, scale_axis


def steps_figure(all_of: Sequence[Step], looks: dict[str, Look]) -> Figure:
    """A panel for each ray kind. Bars are geometric means over scenes; each scene has a mark with its interval."""
    labels = techniques_in_order(all_of)[1:]
    kinds = sorted({one.rays for one in all_of}, key=lambda rays: rank(RAY_ORDER, rays.split(" ")[0]))
    columns = min(COLUMNS - 1, len(kinds))
    rows = math.ceil(len(kinds) / columns)
    figure = new_figure(PAGE_WIDTH, rows * (0.34 * len(labels) + 0.8))
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
    scenes = list(dict.fromkeys(one.scene for one in all_of))
    every = [one.ratio.value for one in all_of]  # an interval that a busy machine has made wide may end at the panel's
    for axes, rays in zip(grid.flat, kinds):
        axes.set_title(shortened(rays), loc="left")
        axes.set_xlabel("times as fast as the step before")
        axes.set_ylim(len(labels) - 0.5, -0.5)
        axes.grid(axis="x")
        axes.set_axisbelow(True)
        axes.axvline(FIRST, color=INK, linewidth=0.8)
        for y, label in enumerate(labels):
            mean = mean_of(all_of, rays, label)
            if mean is not None:
                axes.barh([y], [mean.value - FIRST], left=FIRST, height=0.74, color=looks[label].colour, alpha=0.55, linewidth=0)
        for one in all_of:
            if one.rays != rays:
                continue
            y = labels.index(one.technique) + 0.6 * ((scenes.index(one.scene) + 0.5) / len(scenes) - 0.5)
            if one.ratio.low is not None and one.ratio.high is not None:
                axes.plot([one.ratio.low, one.ratio.high], [y, y], color=INK, linewidth=0.8, alpha=0.7, solid_capstyle="butt")
            axes.plot([one.ratio.value], [y], linestyle="none", **looks[one.technique].mark(3.2))
        scale_axis(axes, "x", every, ratio=math.inf)
    for axes in list(grid.flat)[len(kinds) :]:
        axes.set_visible(False)
    for axes in grid[:, 0]:
        axes.set_yticks(range(len(labels)), [label.replace(",", ",\n", 1) if len(label) > 28 else label for label in labels])
    return figure
