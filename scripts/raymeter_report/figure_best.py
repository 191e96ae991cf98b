"""Side by side: every technique at its best setting, all measures in one figure."""

import textwrap
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .best_settings import MEASURES, Measure, setting_of, winners
from .cells import Cell
from .figure_dots import scene_label
from .style import INK, PAGE_WIDTH, STRUCTURE_COLOURS, Look, new_figure, scale_axis

ROW, SETTING_LINE = 0.118, 0.08  # inches a technique at least, and a line of its setting
HEAD = 0.24  # inches a scene
FOOT = 0.5  # inches for the axes' names
NAMES, SETTINGS = 0.125, 0.3  # of the width
LINE = 46  # characters of a setting that stand in SETTINGS


def best_figure(best: dict[str, list[Cell]], varying: Sequence[str], looks: dict[str, Look]) -> Figure:
    """A row of panels for each scene of `best`, a panel for each measure, a line for each technique; its setting stands behind the last panel."""
    most = max(len(cells) for cells in best.values())
    settings = {scene: [in_lines(setting_of(cell, varying)) for cell in cells] for scene, cells in best.items()}
    lines = max(len(setting.splitlines()) for chosen in settings.values() for setting in chosen)
    technique_height = max(ROW, SETTING_LINE * lines)
    row_height = technique_height * most + HEAD
    height = row_height * len(best) + FOOT
    figure = new_figure(PAGE_WIDTH, height, layout=None)  # names and settings stand outside of the panels
    grid = figure.subplots(len(best), len(MEASURES), squeeze=False, sharex="col")
    figure.subplots_adjust(NAMES, FOOT / height, 1 - SETTINGS, 1 - HEAD / height, wspace=0.38, hspace=HEAD / (technique_height * most))
    for row, (scene, cells) in zip(grid, best.items()):
        for axes, measure in zip(row, MEASURES):
            draw_measure(axes, measure, cells, looks)
            axes.set_ylim(most - 0.4, -0.6)
        row[0].set_yticks(range(len(cells)), [cell.technique[0] for cell in cells], fontsize=6)
        row[0].set_title(scene_label(scene, cells[0].number("num_prims")).replace("\n", ", "), loc="left", fontsize=7, pad=2)
        for i, setting in enumerate(settings[scene]):
            row[-1].annotate(setting, (1, i), (5, 0), xycoords=("axes fraction", "data"), textcoords="offset points", fontsize=5, va="center", linespacing=1.1)
    for column, measure in enumerate(MEASURES):
        values = [value for cells in best.values() for cell in cells if (value := measure.value(cell)) is not None]
        scale_axis(grid[0, column], "x", [value for value in values if value > 0], max_ticks=4)
        grid[-1, column].set_xlabel(f"{measure.title}\n{measure.unit}", fontsize=6.5)
        for axes in grid[:, column]:
            axes.tick_params(axis="x", labelsize=6, pad=2)
            if axes is not grid[-1, column]:
                axes.spines["bottom"].set_visible(False)
                axes.tick_params(axis="x", which="both", length=0)
    return figure


def in_lines(setting: str) -> str:
    """Broken after a comma where it is longer than a line."""
    return textwrap.fill(setting.replace(" ", "\N{NO-BREAK SPACE}").replace(",\N{NO-BREAK SPACE}", ", "), LINE, break_long_words=False)


def draw_measure(axes: Axes, measure: Measure, cells: Sequence[Cell], looks: dict[str, Look]) -> None:
    """One mark a technique, filled where it is best; none where the value is 0 or was not measured."""
    axes.set_yticks([])
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    axes.grid(axis="x")
    axes.set_axisbelow(True)
    for i in range(0, len(cells), 2):
        axes.axhspan(i - 0.5, i + 0.5, color=INK, alpha=0.05, linewidth=0)
    best = {id(cell) for cell in winners(cells, measure)}
    for i, cell in enumerate(cells):
        value = measure.value(cell)
        if value is None or value <= 0:
            continue
        colour = STRUCTURE_COLOURS.get(cell.technique[0], looks[cell.label].colour)
        fill = colour if id(cell) in best else "none"
        axes.plot([value], [i], linestyle="none", marker="o", markersize=4 if id(cell) in best else 3.4, color=colour, markerfacecolor=fill, markeredgewidth=0.9)
